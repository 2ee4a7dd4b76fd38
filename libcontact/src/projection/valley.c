/* Descent along the floor of a narrow valley of f, where the steps of the robust search are too
 * short: a long thin face has a curved valley, a thousand or a million times steeper across than
 * along. */
#include "projection_internal.h"

#include <math.h>

void ct_principal(const double H[3], double q[2], double curvature[2])
{
  double half = 0.5 * (H[0] - H[1]), mean = 0.5 * (H[0] + H[1]), radius = hypot(half, H[2]);
  curvature[0] = mean + radius;
  // -- The product of both is the determinant (eq:valley-curvatures)
  curvature[1] = curvature[0] != 0 ? (H[0] * H[1] - H[2] * H[2]) / curvature[0] : 0;
  double x = half >= 0 ? half + radius : H[2], y = half >= 0 ? H[2] : radius - half,
         length = hypot(x, y);
  q[0] = length > 0 ? x / length : 1;
  q[1] = length > 0 ? y / length : 0;
}

/* Largest fraction of the step that stays on the face. */
static double share_on_face(int triangular, const double xi[2], const double s[2])
{
  double low = triangular ? 0 : -1, share = 1;
  for (int a = 0; a < 2; a++) {
    if (s[a] > 0) share = fmin(share, (1 - xi[a]) / s[a]);
    if (s[a] < 0) share = fmin(share, (low - xi[a]) / s[a]);
  }
  double sum = s[0] + s[1];
  if (triangular && sum > 0) share = fmin(share, (1 - (xi[0] + xi[1])) / sum);
  return fmax(share, 0);
}

static void walk(int triangular, ct_iterate *at, const double s[2])
{
  double share = share_on_face(triangular, at->xi, s);
  for (int a = 0; a < 2; a++) at->xi[a] += share * s[a];
}

/* Back to the floor: Newton's steps across the valley only. */
static void to_the_floor(const ct_patch *patch, int triangular, ct_iterate *at, ct_closest *closest)
{
  for (int i = 0; i < 3; i++) {
    double q[2], curvature[2];
    ct_principal(at->H, q, curvature);
    if (!(curvature[0] > 0)) return;
    // -- One step across (eq:valley-across)
    double across = -(at->g[0] * q[0] + at->g[1] * q[1]) / curvature[0],
           s[2] = {across * q[0], across * q[1]};
    walk(triangular, at, s);
    ct_iterate_evaluate(patch, at, closest);
  }
}

int ct_follow_valley(const ct_patch *patch, double xi[2], ct_closest *closest)
{
  int triangular = ct_is_triangular(patch->kind);
  double half_width = ct_patch_half_width(patch->kind), radius = 0.5 * half_width;
  ct_iterate at = {.xi = {xi[0], xi[1]}};
  ct_iterate_evaluate(patch, &at, closest);
  double start = at.f;
  for (int i = 0; i < 200 && radius > 1e-12 * half_width; i++) {
    double q[2], curvature[2];
    ct_principal(at.H, q, curvature);
    // -- A step along, at most as long as the radius (eq:valley-along)
    double slope = at.g[1] * q[0] - at.g[0] * q[1], along = -slope / curvature[1];
    if (!(curvature[1] > 0 && fabs(along) <= radius)) along = slope > 0 ? -radius : radius;
    double s[2] = {-along * q[1], along * q[0]};
    ct_iterate trial = at;
    walk(triangular, &trial, s);
    ct_iterate_evaluate(patch, &trial, closest);
    to_the_floor(patch, triangular, &trial, closest);
    if (!(trial.f < at.f)) {
      radius = 0.25 * fmin(radius, fabs(along));
      continue;
    }
    if (fabs(along) >= radius) radius = fmin(2 * radius, half_width);
    at = trial;
  }
  xi[0] = at.xi[0];
  xi[1] = at.xi[1];
  return at.f < start;
}
