#include "projection_internal.h"

#include "../base/vector.h"

/* Least-square step: to the closest point of the tangent plane. */
static int least_squares_step(const ct_patch *patch, const ct_iterate *at, double s[2])
{
  double t1[4], t2[4];
  ct_patch_tangents(patch, at->xi, t1, t2);
  double A11 = ct_vector_dot(t1, t1), A22 = ct_vector_dot(t2, t2), A12 = ct_vector_dot(t1, t2),
         determinant = A11 * A22 - A12 * A12;
  // -- Normal equations of the tangent plane (eq:projection-gauss-newton)
  s[0] = 0.5 * (A12 * at->g[1] - A22 * at->g[0]) / determinant;
  s[1] = 0.5 * (A12 * at->g[0] - A11 * at->g[1]) / determinant;
  return determinant > 0;
}

ct_status ct_project_least_squares(const ct_patch *patch, const ct_project_options *options,
                                   ct_foot *foot)
{
  return ct_iterate_walk(patch, options, least_squares_step, foot);
}
