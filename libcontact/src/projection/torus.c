#include "projection_internal.h"

#include <math.h>

/* The principal curvatures, k[0] the one of the larger size, and the direction (cosine, sine) of
 * k[0] in the frame. */
static void principal(const ct_local *at, double k[2], double direction[2])
{
  double mean = 0.5 * (at->k[0] + at->k[1]), half = 0.5 * (at->k[0] - at->k[1]), twist = at->k[2];
  double r = sqrt(half * half + twist * twist), sign = mean < 0 ? -1 : 1;
  // -- Principal curvatures and directions (eq:torus-principal)
  k[0] = mean + sign * r;
  k[1] = mean - sign * r;
  double x = sign * half >= 0 ? r + sign * half : sign * twist,
         y = sign * half >= 0 ? sign * twist : r - sign * half;
  double length = sqrt(x * x + y * y);
  direction[0] = length > 0 ? x / length : 1;
  direction[1] = length > 0 ? y / length : 0;
}

/* Tangential way from the touching point to the closest point on the torus. */
static void torus_closest(const ct_local *at, double w[2])
{
  double k[2], e[2], h = at->p[2];
  principal(at, k, e);
  double a = at->p[0] * e[0] + at->p[1] * e[1], b = at->p[1] * e[0] - at->p[0] * e[1];
  // -- Turn the point about the axis into the plane of the small circle (eq:torus-turn)
  double m = sqrt((1 - k[1] * h) * (1 - k[1] * h) + (k[1] * b) * (k[1] * b));
  double height = (2 * h - k[1] * (b * b + h * h)) / (1 + m), along = b != 0 ? b / m : 0;
  // -- Closest point on the small circle (eq:torus-closest point)
  double q = sqrt((1 - k[0] * height) * (1 - k[0] * height) + (k[0] * a) * (k[0] * a)),
         across = a != 0 ? a / q : 0;
  w[0] = across * e[0] - along * e[1];
  w[1] = across * e[1] + along * e[0];
}

ct_status ct_project_torus(const ct_patch *patch, const ct_project_options *options,
                           ct_closest *closest)
{
  return ct_local_walk(patch, options, torus_closest, closest);
}
