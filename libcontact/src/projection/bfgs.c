#include "projection_internal.h"

#include <math.h>

/* Update D with the change y of the gradient over the step s. */
static void bfgs_update(double D[3], const double s[2], const double y[2], int first)
{
  double sy = s[0] * y[0] + s[1] * y[1], yy = y[0] * y[0] + y[1] * y[1];
  // -- Use only a step along which f bends upwards
  if (!(sy > 0 && sy < HUGE_VAL && yy > 0)) return;
  // -- Before the first update, give D the observed size (eq:bfgs-scale)
  if (first) D[0] = D[1] = sy / yy, D[2] = 0;
  double z[2] = {D[0] * y[0] + D[2] * y[1], D[2] * y[0] + D[1] * y[1]},
         factor = 1 + (y[0] * z[0] + y[1] * z[1]) / sy;
  // -- Update of the inverse (eq:bfgs-update)
  D[0] += (factor * (s[0] * s[0]) - 2 * (s[0] * z[0])) / sy;
  D[1] += (factor * (s[1] * s[1]) - 2 * (s[1] * z[1])) / sy;
  D[2] += (factor * (s[0] * s[1]) - (s[0] * z[1] + s[1] * z[0])) / sy;
}

/* State: D approximates the inverse of the Hessian, (D11 D22 D12); and the last iterate. */
typedef struct lessons {
  double D[3];
  ct_iterate last;
  int count;
} lessons;

static int bfgs_step(const ct_patch *patch, const ct_iterate *at, double s[2], void *memory)
{
  lessons *l = memory;
  double *D = l->D, y[2];
  const double *g = at->g;
  if (l->count == 0)
    D[0] = D[1] = 0.5 * ct_patch_half_width(patch->kind) / sqrt(g[0] * g[0] + g[1] * g[1]);
  for (int a = 0; a < 2 && l->count > 0; a++)
    s[a] = at->xi[a] - l->last.xi[a], y[a] = g[a] - l->last.g[a];
  if (l->count > 0) bfgs_update(D, s, y, l->count == 1);
  l->count++;
  l->last = *at;
  // -- Step with the approximate inverse (eq:bfgs-step)
  s[0] = -(D[0] * g[0] + D[2] * g[1]);
  s[1] = -(D[2] * g[0] + D[1] * g[1]);
  return 1;
}

ct_status ct_project_bfgs(const ct_patch *patch, const ct_project_options *options,
                          ct_closest *closest)
{
  lessons none = {.count = 0};
  return ct_iterate_walk(patch, options, 200, 1, bfgs_step, &none, closest);
}
