/* Where each member of the structs of the Fortran module stands in C, for host.f90 to compare. */
#include <libcontact.h>

#define PLACE(type, member) (int64_t)offsetof(type, member)

void host_layout(int64_t *place);

void host_layout(int64_t *place)
{
  static const int64_t rows[] = {PLACE(ct_error, body),
                                 PLACE(ct_error, element),
                                 PLACE(ct_error, point),
                                 PLACE(ct_error, text),
                                 PLACE(ct_error, part),
                                 PLACE(ct_error, number),
                                 (int64_t)sizeof(ct_error),
                                 PLACE(ct_face, node),
                                 (int64_t)sizeof(ct_face),
                                 PLACE(ct_project_options, tolerance),
                                 PLACE(ct_project_options, use_start),
                                 PLACE(ct_project_options, start),
                                 PLACE(ct_project_options, iteration_limit),
                                 PLACE(ct_project_options, trace),
                                 PLACE(ct_project_options, user),
                                 (int64_t)sizeof(ct_project_options),
                                 PLACE(ct_projection, where),
                                 PLACE(ct_projection, index),
                                 PLACE(ct_projection, evaluations),
                                 PLACE(ct_projection, iterations),
                                 PLACE(ct_projection, certified),
                                 PLACE(ct_projection, xi),
                                 PLACE(ct_projection, point),
                                 PLACE(ct_projection, distance),
                                 PLACE(ct_projection, signed_distance),
                                 PLACE(ct_projection, normal),
                                 (int64_t)sizeof(ct_projection),
                                 PLACE(ct_surface, node_count),
                                 PLACE(ct_surface, face_count),
                                 PLACE(ct_surface, faces),
                                 PLACE(ct_surface, reference),
                                 (int64_t)sizeof(ct_surface),
                                 PLACE(ct_contact_options, method),
                                 PLACE(ct_contact_options, tolerance),
                                 PLACE(ct_contact_options, depth),
                                 PLACE(ct_contact_options, threads),
                                 PLACE(ct_contact_options, separated),
                                 PLACE(ct_contact_options, enforcement),
                                 PLACE(ct_contact_options, dissipation),
                                 PLACE(ct_contact_options, points),
                                 PLACE(ct_contact_options, initial_penetration),
                                 PLACE(ct_contact_options, removal_time),
                                 PLACE(ct_contact_options, adjust),
                                 (int64_t)sizeof(ct_contact_options)};
  for (int i = 0; i < (int)(sizeof rows / sizeof rows[0]); i++) place[i] = rows[i];
}
