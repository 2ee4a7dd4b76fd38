#include "projection_internal.h"

#include <math.h>

/* Tangential vector from the touching point to the closest point on the sphere. */
static void sphere_closest(const ct_local *at, double w[2])
{
  const double *r = at->r, *k = at->kappa;
  double square = r[0] * r[0] + r[1] * r[1];
  // -- Curvature of the face in the direction of the point (eq:sphere-curvature)
  double bend = k[0] * (r[0] * r[0]) + 2 * k[2] * (r[0] * r[1]) + k[1] * (r[1] * r[1]),
         kappa = square > 0 ? bend / square : 0;
  // -- Closest point on the sphere (eq:sphere-closest)
  double m = sqrt((1 - kappa * r[2]) * (1 - kappa * r[2]) + kappa * kappa * square);
  w[0] = square > 0 ? r[0] / m : 0;
  w[1] = square > 0 ? r[1] / m : 0;
}

ct_status ct_project_sphere(const ct_patch *patch, const ct_project_options *options,
                            ct_closest *closest)
{
  return ct_local_walk(patch, options, sphere_closest, closest);
}
