#include "projection_internal.h"

#include <float.h>
#include <math.h>

/* A triangle in the plane of xi that changes its shape, with vertices sorted from the lowest to the
 * highest. */
typedef struct triangle {
  double x[3][2], f[3];
} triangle;

static void move(triangle *t, int i, const double x[2], double f)
{
  t->x[i][0] = x[0], t->x[i][1] = x[1], t->f[i] = f;
}

/* Sort the vertices, the lowest first. */
static void sort(triangle *t)
{
  for (int i = 1; i < 3; i++)
    for (int j = i; j > 0 && t->f[j] < t->f[j - 1]; j--) {
      triangle old = *t;
      for (int k = 0; k < 2; k++) move(t, j - k, old.x[j - 1 + k], old.f[j - 1 + k]);
    }
}

/* The point on the line from the highest vertex through the centre of the others, beyond this
 * centre by `alpha` times their distance; returns f there. */
static double along(const triangle *t, const ct_patch *patch, double alpha, double image[2],
                    ct_closest *closest)
{
  for (int a = 0; a < 2; a++) {
    double centre = 0.5 * (t->x[0][a] + t->x[1][a]);
    // -- On the line through the highest vertex and the centre of the others (eq:nelder-line)
    image[a] = centre + alpha * (centre - t->x[2][a]);
  }
  return ct_iterate_value(patch, image, closest);
}

static void shrink(triangle *t, const ct_patch *patch, ct_closest *closest)
{
  // -- Shrink towards the lowest vertex (eq:nelder-shrink)
  for (int i = 1; i < 3; i++) {
    for (int a = 0; a < 2; a++) t->x[i][a] = t->x[0][a] + 0.5 * (t->x[i][a] - t->x[0][a]);
    t->f[i] = ct_iterate_value(patch, t->x[i], closest);
  }
}

/* One iteration on a sorted triangle. */
static void nelder_mead_step(triangle *t, const ct_patch *patch, ct_closest *closest)
{
  double image[2], other[2];
  // -- Reflection
  double f = along(t, patch, 1, image, closest); // (eq:nelder-reflection)
  if (f < t->f[0]) {
    // -- Expansion
    double further = along(t, patch, 2, other, closest); // (eq:nelder-expansion)
    if (further < t->f[0]) move(t, 2, other, further);
    else move(t, 2, image, f);
    return;
  }
  if (f <= t->f[1]) {
    move(t, 2, image, f);
    return;
  }
  if (f < t->f[2]) move(t, 2, image, f);
  // -- Contraction
  double nearer = along(t, patch, -0.5, other, closest); // (eq:nelder-contraction)
  if (nearer <= t->f[2]) move(t, 2, other, nearer);
  else shrink(t, patch, closest);
}

static double extent(const triangle *t)
{
  double most = 0;
  for (int i = 1; i < 3; i++)
    for (int a = 0; a < 2; a++) most = fmax(most, fabs(t->x[i][a] - t->x[0][a]));
  return most;
}

ct_status ct_project_nelder_mead(const ct_patch *patch, const ct_project_options *options,
                                 ct_closest *closest)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 2000;
  double half_width = ct_patch_half_width(patch->kind), tolerance = options->tolerance * half_width;
  triangle t;
  ct_regular_simplex(patch, options, t.x, t.f, closest);
  ct_status status = CT_ITERATION_LIMIT;
  sort(&t);
  for (; closest->iterations < limit; closest->iterations++) {
    if (options->trace != NULL) options->trace(t.x[0], t.f[0], options->user);
    double size = extent(&t);
    if (size <= tolerance) {
      status = CT_OK;
      break;
    }
    // -- Values that differ by rounding only: shrink while the triangle is large, else stop
    // (eq:simplex-floor)
    int level = t.f[2] - t.f[0] <= 4 * DBL_EPSILON * t.f[0];
    if (level && size <= 1e-4 * half_width) break;
    if (level) shrink(&t, patch, closest);
    else nelder_mead_step(&t, patch, closest);
    sort(&t);
  }
  for (int a = 0; a < 2; a++) closest->xi[a] = t.x[0][a];
  ct_patch_value(patch, closest->xi, closest->d);
  return status;
}
