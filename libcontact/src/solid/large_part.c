/* Further queries for a body of large deformation: inverted elements, and the eigenvalues of the
 * tangent. */
#include "../base/error.h"
#include "element.h"
#include "kernel.h"

#include <math.h>
#include <string.h>

/* Refuse a batch whose smallest J is not positive, with the message of the readable form. */
ct_status ct_solid_check_volume(const ct_solid_part *part, int32_t body, const double *u,
                                const double *values, ct_error *error)
{
  const double *lowest = values + part->assembly->value_count;
  for (int32_t b = 0; part->energies != NULL && b < part->batch_count; b++) {
    if (lowest[b] > 0.0) continue;
    for (int32_t e = 8 * b; e < 8 * b + 8 && e < part->mesh->element_count; e++) {
      double x[20][3], v[20][3], f[60];
      ct_solid_load_element(part->mesh, e, part->mesh->nodes, x);
      ct_solid_load_element(part->mesh, e, u, v);
      ct_status status = ct_solid_element_force(part->mesh->kind, &x[0][0], &v[0][0],
                                                ct_part_material(part, e), f, NULL, error);
      if (status == CT_OK) continue;
      if (error != NULL) error->body = body, error->element = e;
      return status;
    }
    return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){body, 8 * (int64_t)b, -1},
                   "one of the elements %d to %d is inverted", (int)(8 * b), (int)(8 * b + 7));
  }
  return CT_OK;
}

/* Largest eigenvalue of the tangents of the elements of one part; undeformed elements keep that of
 * the part. */
ct_status ct_solid_tangent_omega2_bound(const ct_solid_part *part, const double *u,
                                        double *omega_squared, ct_error *error)
{
  const ct_mesh *mesh = part->mesh;
  int per = ct_brick_node_count(mesh->kind);
  *omega_squared = 0.0;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double x[20][3], v[20][3], m[20], w = part->omega_squared;
    int deformed = 0;
    ct_solid_load_element(mesh, e, u, v);
    for (int a = 1; a < per; a++) deformed |= memcmp(v[a], v[0], sizeof v[a]) != 0;
    if (deformed) {
      ct_solid_load_element(mesh, e, mesh->nodes, x);
      const ct_material *material = ct_part_material(part, e);
      ct_status status =
          ct_mass_element(mesh->kind, &x[0][0], material->density, part->lumping, m, error);
      if (status == CT_OK)
        status =
            ct_solid_element_omega2_bound(mesh->kind, &x[0][0], &v[0][0], material, m, &w, error);
      if (status != CT_OK) {
        if (error != NULL) error->element = e;
        return status;
      }
    }
    // -- No eigenvalue of the body is above the largest of its elements (eq:tangent-bound)
    *omega_squared = fmax(*omega_squared, w);
  }
  return CT_OK;
}
