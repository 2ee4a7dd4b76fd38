#include "projection_internal.h"

/* Least-squares step: to the closest point on the tangent plane. */
static int least_squares_step(const ct_patch *patch, const ct_iterate *at, double s[2],
                              void *memory)
{
  const double *A = at->square;
  double determinant = A[0] * A[1] - A[2] * A[2];
  (void)patch, (void)memory;
  // -- Normal equations of the tangent plane (eq:projection-gauss-newton)
  s[0] = 0.5 * (A[2] * at->g[1] - A[1] * at->g[0]) / determinant;
  s[1] = 0.5 * (A[2] * at->g[0] - A[0] * at->g[1]) / determinant;
  return determinant > 0;
}

ct_status ct_project_least_squares(const ct_patch *patch, const ct_project_options *options,
                                   ct_closest *closest)
{
  return ct_iterate_walk(patch, options, 200, 0, least_squares_step, NULL, closest);
}
