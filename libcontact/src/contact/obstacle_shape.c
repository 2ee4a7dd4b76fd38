/* Distance of a point from a plane, a sphere or a cylinder, and the motion of an obstacle. */
#include "../base/amplitude.h"
#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

double ct_obstacle_gap_of(const ct_obstacle_def *o, const double a[3], const double r[3],
                          double n[3])
{
  double along = o->shape == CT_OBSTACLE_SPHERE ? 0.0 : ct_vector_dot(r, a), from[3];
  // -- A plane: g = r · a, n = a
  if (o->shape == CT_OBSTACLE_PLANE) {
    memcpy(n, a, 3 * sizeof *n);
    return along;
  }
  // -- Sphere and cylinder: away from the centre or the axis
  for (int c = 0; c < 3; c++) from[c] = o->shape == CT_OBSTACLE_SPHERE ? r[c] : r[c] - along * a[c];
  double distance = sqrt(ct_vector_dot(from, from));
  for (int c = 0; c < 3; c++) n[c] = from[c] / distance;
  return distance - o->radius; // (eq:obstacle-gap)
}

int ct_obstacle_axis(const double axis[3], double a[3])
{
  double length = sqrt(ct_vector_dot(axis, axis));
  for (int c = 0; c < 3; c++) a[c] = axis[c] / length;
  return length > 0.0 && isfinite(length);
}

double ct_obstacle_gap(const ct_obstacle_def *obstacle, const double point[3], double n[3])
{
  double a[3] = {0.0, 0.0, 0.0}, r[3];
  if (obstacle->shape != CT_OBSTACLE_SPHERE) (void)ct_obstacle_axis(obstacle->axis, a);
  for (int c = 0; c < 3; c++) r[c] = point[c] - obstacle->point[c];
  return ct_obstacle_gap_of(obstacle, a, r, n);
}

void ct_obstacle_motion(const ct_obstacle_def *obstacle, double time, double motion[3])
{
  double factor =
      obstacle->amplitude.count > 0 ? ct_amplitude_value(&obstacle->amplitude, time) : 0.0;
  // -- Velocity and amplitude (eq:obstacle-motion)
  for (int c = 0; c < 3; c++)
    motion[c] = time * obstacle->velocity[c] + factor * obstacle->travel[c];
}

double ct_obstacle_distance(const ct_obstacle_state *obstacle, const double y[3], double n[3])
{
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = y[c] - obstacle->place[c];
  return ct_obstacle_gap_of(obstacle->given, obstacle->given->axis, r, n);
}
