#ifndef CONTACT_OBSTACLE_H
#define CONTACT_OBSTACLE_H

#include <contact/history.h>
#include <contact/segment.h>
#include <contact/step.h>

CT_BEGIN_DECLS

/** Shape of a rigid obstacle. */
typedef enum ct_obstacle_shape {
  /** half-space behind a plane; any depth below the plane is inside */
  CT_OBSTACLE_PLANE = 0,
  /** solid sphere */
  CT_OBSTACLE_SPHERE = 1,
  /** solid cylinder without ends */
  CT_OBSTACLE_CYLINDER = 2
} ct_obstacle_shape;

/** A rigid obstacle against a surface of a body, :eq:`obstacle-potential`. It may move, but does
 * not turn. */
typedef struct ct_obstacle {
  /** Plane, sphere or cylinder. */
  ct_obstacle_shape shape;
  /** A point of the plane, the centre of the sphere, a point of the cylinder's axis, at t = 0
   * [length]. */
  double point[3];
  /** Normal of the plane out of the obstacle, or direction of the cylinder's axis, of any length;
   * not read for a sphere. */
  double axis[3];
  /** Radius of sphere or cylinder [length], > 0; not read for a plane. */
  double radius;
  /** Penalty ε [stress / length], > 0; see `ct_contact_penalty`. */
  double epsilon;
  /** How gaps give forces. */
  ct_enforcement enforcement;
  /**
   * Share of the stiffness that acts at the end of the step, 0 ... 1, :eq:`energy-controlled`; for
   * the energy-controlled penalty.
   */
  double dissipation;
  /** Constant velocity [length / time]. */
  double velocity[3];
  /** What the history's factor multiplies [length]; zero without a history. */
  double travel[3];
  /** Its displacement is velocity times time plus `travel` times this factor,
   * :eq:`obstacle-motion`; no points: no travel. */
  ct_history history;
  /** Kind of the surface's faces. */
  ct_face_kind kind;
  /** Number of faces of the surface. */
  int32_t face_count;
  /** Node numbers of the problem, counter-clockwise from outside, shape (face_count, nodes of a
   * face). */
  const int32_t *faces;
} ct_obstacle;

/**
 * Signed distance of a point from an obstacle at its place of t = 0 [length], negative inside, and
 * the unit normal `n` out of the obstacle there, :eq:`obstacle-gap`. The normal is NaN in the
 * centre of a sphere and on the axis of a cylinder.
 */
CT_API double ct_obstacle_gap(const ct_obstacle *obstacle, const double point[3], double n[3]);

/** Where the obstacle is at a time, relative to t = 0's `point` [length], :eq:`obstacle-motion`. */
CT_API void ct_obstacle_motion(const ct_obstacle *obstacle, double time, double motion[3]);

/**
 * The effect of one obstacle, named "obstacle". It stores the penalty's energy; work of its motion
 * is external.
 * ``CT_ERROR_ARGUMENT``: penalty or radius not positive, no axis, no faces, node out of range,
 * history not ascending, travel without a history.
 */
CT_API ct_status ct_obstacle_create_effect(const ct_obstacle *obstacle, const ct_problem *problem,
                                           ct_effect **effect, ct_error *error);

/**
 * Force of the bodies on an obstacle at the state's time [force] and the work that its motion has
 * put into the bodies since t = 0 [energy], :eq:`obstacle-work`. ``CT_ERROR_ARGUMENT``: effect
 * number `effect` is no obstacle.
 */
CT_API ct_status ct_obstacle_reaction(const ct_problem *problem, ct_state *state, int32_t effect,
                                      double force[3], double *work, ct_error *error);

CT_END_DECLS

#endif
