#include "projection_internal.h"

#include <math.h>

/* Tangential way from the touching point to the closest point on the sphere. */
static void sphere_closest(const ct_local *at, double w[2])
{
  double a = at->p[0], b = at->p[1], h = at->p[2], square = a * a + b * b;
  // -- Curvature of the face in the direction of the point (eq:sphere-curvature)
  double k =
      square > 0 ? (at->k[0] * (a * a) + 2 * at->k[2] * (a * b) + at->k[1] * (b * b)) / square : 0;
  // -- Closest point on the sphere (eq:sphere-closest point)
  double m = sqrt((1 - k * h) * (1 - k * h) + k * k * square);
  w[0] = square > 0 ? a / m : 0;
  w[1] = square > 0 ? b / m : 0;
}

ct_status ct_project_sphere(const ct_patch *patch, const ct_project_options *options,
                            ct_closest *closest)
{
  return ct_local_walk(patch, options, sphere_closest, closest);
}
