#include "projection_internal.h"

#include <math.h>

/* The principal curvatures, kappa[0] the larger one in size, and the direction (cosine, sine) of
 * kappa[0] in the frame. */
static void principal(const ct_local *at, double kappa[2], double direction[2])
{
  const double *k = at->kappa;
  double mean = 0.5 * (k[0] + k[1]), half = 0.5 * (k[0] - k[1]), twist = k[2];
  double root = sqrt(half * half + twist * twist), sign = mean < 0 ? -1 : 1;
  // -- Principal curvatures and directions (eq:torus-principal)
  kappa[0] = mean + sign * root;
  kappa[1] = mean - sign * root;
  double x = sign * half >= 0 ? root + sign * half : sign * twist,
         y = sign * half >= 0 ? sign * twist : root - sign * half;
  double length = sqrt(x * x + y * y);
  direction[0] = length > 0 ? x / length : 1;
  direction[1] = length > 0 ? y / length : 0;
}

/* Tangential vector from the touching point to the closest point on the torus. */
static void torus_closest(const ct_local *at, double w[2])
{
  double kappa[2], e[2], r_n = at->r[2];
  principal(at, kappa, e);
  double r_I = at->r[0] * e[0] + at->r[1] * e[1], r_II = at->r[1] * e[0] - at->r[0] * e[1];
  // -- Turn the point about the axis into the plane of the small circle (eq:torus-turn)
  double m =
      sqrt((1 - kappa[1] * r_n) * (1 - kappa[1] * r_n) + (kappa[1] * r_II) * (kappa[1] * r_II));
  double height = (2 * r_n - kappa[1] * (r_II * r_II + r_n * r_n)) / (1 + m);
  // -- Closest point on the small circle (eq:torus-closest)
  double q = sqrt((1 - kappa[0] * height) * (1 - kappa[0] * height) +
                  (kappa[0] * r_I) * (kappa[0] * r_I)),
         w_I = r_I != 0 ? r_I / q : 0, w_II = r_II != 0 ? r_II / m : 0;
  w[0] = w_I * e[0] - w_II * e[1];
  w[1] = w_I * e[1] + w_II * e[0];
}

ct_status ct_project_torus(const ct_patch *patch, const ct_project_options *options,
                           ct_closest *closest)
{
  return ct_local_walk(patch, options, torus_closest, closest);
}
