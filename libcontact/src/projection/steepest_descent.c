#include "projection_internal.h"

#include <math.h>

/* The step along -g to the lowest point of the parabola that approximates f along it; if f bends
 * downwards, a half-width. */
static int steepest_step(const ct_patch *patch, const ct_iterate *at, double s[2], void *memory)
{
  const double *H = at->H;
  double half_width = ct_patch_half_width(patch->kind),
         slope = sqrt(at->g[0] * at->g[0] + at->g[1] * at->g[1]),
         e[2] = {at->g[0] / slope, at->g[1] / slope};
  double bend = H[0] * (e[0] * e[0]) + 2 * H[2] * (e[0] * e[1]) + H[1] * (e[1] * e[1]);
  (void)memory;
  // -- Length of the step, along a unit vector so that no product leaves the range of numbers
  // (eq:steepest-length)
  double length = bend > 0 ? fmin(slope / bend, half_width) : half_width;
  for (int a = 0; a < 2; a++) s[a] = -length * e[a];
  return at->g[0] != 0 || at->g[1] != 0;
}

ct_status ct_project_steepest_descent(const ct_patch *patch, const ct_project_options *options,
                                      ct_closest *closest)
{
  return ct_iterate_walk(patch, options, 2000, 1, steepest_step, NULL, closest);
}
