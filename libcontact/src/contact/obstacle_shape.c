/* The kinds of obstacles: planes, spheres and cylinders; and their motion. */
#include "../base/amplitude.h"
#include "../base/vector.h"
#include "obstacle.h"

#include <math.h>
#include <string.h>

static double plane_gap(double radius, const double axis[3], const double r[3], double n[3])
{
  (void)radius;
  // -- A plane: g = r · a, n = a (eq:obstacle-gap)
  memcpy(n, axis, 3 * sizeof *axis);
  return ct_vector_dot(r, axis);
}

static double sphere_gap(double radius, const double axis[3], const double r[3], double n[3])
{
  (void)axis;
  const double distance = sqrt(ct_vector_dot(r, r));
  // -- Away from the centre or the axis
  for (int c = 0; c < 3; c++) n[c] = r[c] / distance;
  return distance - radius; // (eq:obstacle-gap)
}

static double cylinder_gap(double radius, const double axis[3], const double r[3], double n[3])
{
  const double along = ct_vector_dot(r, axis);
  double from[3];
  for (int c = 0; c < 3; c++) from[c] = r[c] - along * axis[c];
  return sphere_gap(radius, axis, from, n);
}

const ct_obstacle_kind *ct_obstacle_kind_of(ct_obstacle_shape shape)
{
  static const ct_obstacle_kind KINDS[] = {
      [CT_OBSTACLE_PLANE] = {"plane", "normal", 0, plane_gap},
      [CT_OBSTACLE_SPHERE] = {"sphere", NULL, 1, sphere_gap},
      [CT_OBSTACLE_CYLINDER] = {"cylinder", "axis", 1, cylinder_gap},
  };
  const size_t number = (size_t)shape;
  return number < sizeof KINDS / sizeof KINDS[0] ? &KINDS[number] : NULL;
}

int ct_obstacle_axis(const double axis[3], double a[3])
{
  double length = sqrt(ct_vector_dot(axis, axis));
  for (int c = 0; c < 3; c++) a[c] = axis[c] / length;
  return length > 0.0 && isfinite(length);
}

void ct_obstacle_motion(const ct_obstacle_def *obstacle, double time, double motion[3])
{
  double factor =
      obstacle->amplitude.count > 0 ? ct_amplitude_value(&obstacle->amplitude, time) : 0.0;
  // -- Velocity and amplitude (eq:obstacle-motion)
  for (int c = 0; c < 3; c++)
    motion[c] = time * obstacle->velocity[c] + factor * obstacle->travel[c];
}
