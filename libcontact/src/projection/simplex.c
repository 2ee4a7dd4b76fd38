#include "projection_internal.h"

#include <float.h>
#include <math.h>

/* A regular simplex in the plane of xi: its vertices, their values of f, and the number of
 * iterations for which each has stayed. */
typedef struct simplex {
  double x[3][2], f[3];
  int age[3];
  double edge;
} simplex;

void ct_regular_simplex(const ct_patch *patch, const ct_project_options *options, double x[3][2],
                        double f[3], ct_closest *closest)
{
  // -- Regular simplex about the start (eq:simplex-start)
  double corner[3][2] = {{-0.5, -sqrt(3) / 6}, {0.5, -sqrt(3) / 6}, {0, sqrt(3) / 3}}, start[2];
  ct_iterate_start(patch, options, start);
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < 2; a++)
      x[i][a] = start[a] + ct_patch_half_width(patch->kind) * corner[i][a];
    f[i] = ct_iterate_value(patch, x[i], closest);
  }
}

/* Find the lowest vertex, the second highest and the highest. */
static void simplex_order(const simplex *s, int *low, int *second, int *high)
{
  // -- Highest and lowest vertex
  *high = s->f[0] > s->f[1] ? 0 : 1;
  *low = 1 - *high;
  if (s->f[2] > s->f[*high]) *high = 2;    // (eq:simplex-high)
  else if (s->f[2] < s->f[*low]) *low = 2; // (eq:simplex-low)
  *second = 3 - *low - *high;
}

/* Reflect vertex i in the middle of the others; writes the image and returns f there. */
static double simplex_reflect(const simplex *s, const ct_patch *patch, int i, double image[2],
                              ct_closest *closest)
{
  const double *p = s->x[(i + 1) % 3], *q = s->x[(i + 2) % 3];
  for (int a = 0; a < 2; a++) {
    // -- Centre of the others (eq:simplex-centre)
    double centre = 0.5 * (p[a] + q[a]);
    // -- Reflection in it, with alpha = 1 (eq:simplex-reflection)
    image[a] = centre + (centre - s->x[i][a]);
  }
  return ct_iterate_value(patch, image, closest);
}

static void simplex_move(simplex *s, int i, const double image[2], double f)
{
  for (int k = 0; k < 3; k++) s->age[k]++;
  s->x[i][0] = image[0];
  s->x[i][1] = image[1];
  s->f[i] = f;
  s->age[i] = 0;
}

static void simplex_halve(simplex *s, const ct_patch *patch, int low, ct_closest *closest)
{
  // -- Halve the edge about the lowest vertex
  s->edge *= 0.5;
  for (int i = 0; i < 3; i++) {
    s->age[i] = 0;
    if (i == low) continue;
    // (eq:simplex-halving)
    for (int a = 0; a < 2; a++) s->x[i][a] = s->x[low][a] + 0.5 * (s->x[i][a] - s->x[low][a]);
    s->f[i] = ct_iterate_value(patch, s->x[i], closest);
  }
}

/* One iteration; returns the larger of the highest vertex and its image, which reveals rounding
 * noise. */
static double simplex_step(simplex *s, const ct_patch *patch, ct_closest *closest)
{
  double image[2];
  int low, second, high;
  simplex_order(s, &low, &second, &high);
  double f = simplex_reflect(s, patch, high, image, closest), top = fmax(f, s->f[high]);
  int moved = high;
  if (f >= s->f[high]) {
    // -- The worst does not improve: reflect the second highest instead
    f = simplex_reflect(s, patch, second, image, closest);
    moved = second;
  }
  simplex_move(s, moved, image, f);
  return top;
}

ct_status ct_project_simplex(const ct_patch *patch, const ct_project_options *options,
                             ct_closest *closest)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 2000, low, second, high;
  double half_width = ct_patch_half_width(patch->kind), tolerance = options->tolerance * half_width;
  // -- Age at which a vertex is the centre of rotation, 3.5
  const double m = ct_simplex_age(2);
  simplex s = {.edge = half_width};
  ct_regular_simplex(patch, options, s.x, s.f, closest);
  ct_status status = CT_ITERATION_LIMIT;
  for (closest->iterations = 0; closest->iterations < limit; closest->iterations++) {
    double top = simplex_step(&s, patch, closest);
    simplex_order(&s, &low, &second, &high);
    if (options->trace != NULL) options->trace(s.x[low], s.f[low], options->user);
    if (s.age[low] < m) continue;
    if (s.edge <= tolerance) {
      status = CT_OK;
      break;
    }
    // -- Stop where values differ by rounding only (eq:simplex-floor)
    if (fmax(top, s.f[high]) - s.f[low] <= 4 * DBL_EPSILON * s.f[low]) break;
    simplex_halve(&s, patch, low, closest);
  }
  simplex_order(&s, &low, &second, &high);
  for (int a = 0; a < 2; a++) closest->xi[a] = s.x[low][a];
  ct_patch_value(patch, closest->xi, closest->d);
  return status;
}
