#ifndef CT_SRC_CONTACT_INITIAL_H
#define CT_SRC_CONTACT_INITIAL_H

#include <libcontact/contact.h>

/* What the start gaps are shown: the time t_n and Δt, whether this is the first step, the memory of
 * the first point and how far apart those of two points are, the signed distance of the first point
 * in the last step, and what stands behind all points; to read and to write. */
typedef struct ct_initial_view {
  double time, dt;
  int first;
  int stride;
  const double *memory, *known, *memory_end;
  double *next, *next_end;
} ct_initial_view;

/* Doubles of memory that a contact with these options needs for the start gap of each point, and
 * behind all points; 0 for both if no gap counts from a start gap. */
int ct_initial_point_memory(const ct_contact_options *options);
int ct_initial_end_memory(const ct_contact_options *options);

/* Fail if a point is inside by more than is adjusted (eq:initial-shift). */
ct_status ct_initial_refuse(const ct_contact *contact, ct_error *error);

/* Start gaps of all points, from their distances on the undeformed shape, for the first
 * ct_initial_shift (eq:initial-adjust). */
void ct_initial_begin(const ct_contact *contact, const ct_initial_view *view);

/* Count the gaps of all points from their start gaps, and their penalty forces with them. */
void ct_initial_shift(ct_contact *contact, const ct_initial_view *view);

/* Work that has come in since t = 0 because start gaps fade, once the forces of the points are
 * known (eq:initial-work). */
double ct_initial_work(const ct_contact *contact, const ct_initial_view *view);

#endif
