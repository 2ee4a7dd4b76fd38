/* Intersections of lines with one face.
 * Threads: every call is safe at any time, also on the same face; a call writes only its output
 * arguments. */
#ifndef LIBCONTACT_RAY_H
#define LIBCONTACT_RAY_H

#include <libcontact/projection.h>

CT_BEGIN_DECLS

/** The intersection of a line and a face; ct_project_rays writes all members. */
typedef struct ct_ray_hit {
  /**
   * CT_OK: the line meets the face; of all intersections this one is nearest to the given point,
   * along the line in either sense. CT_NO_CONVERGENCE: the line misses the face; the method proves
   * it. CT_NOT_CERTIFIED: the line touches the face or lies in it, and xi is one point where it
   * does. CT_ITERATION_LIMIT: the limit was reached and no intersection was found. CT_INVALID: as
   * in ct_projection, or the direction is zero or not finite. All floating-point members are NaN
   * unless the status is CT_OK or CT_NOT_CERTIFIED.
   */
  ct_status status;
  /** Interior, edge or vertex; outside where there is no hit. */
  ct_where where;
  /** Number of the edge or of the corner; -1 where there is none. */
  int index;
  /** Number of points of the face that were evaluated. */
  int evaluations;
  /** Reference coordinates of the hit. */
  double xi[2];
  /** The hit [length]. */
  double point[3];
  /** Distance from the given point to the hit along the direction [length]; negative behind the
   * point. */
  double distance;
  /** Unit normal of the face at the hit. */
  double normal[3];
} ct_ray_hit;

/**
 * Distance from each of ``count`` points to a face along a direction, both of shape (count, 3),
 * into ``out[count]``, :eq:`ray-hit`: the gap measured along a normal of the other surface. A
 * direction may have any length except 0. ``tolerance`` is how far beyond the face a hit may lie,
 * in half-widths; 1e-10 is a good choice.
 *
 * Returns CT_OK if all lines were processed (see the status of each). CT_ERROR_ARGUMENT, with all
 * outputs NaN: a null pointer, an unknown kind, or a tolerance that is not positive and below 1.
 */
CT_API ct_status ct_project_rays(const ct_face *face, size_t count, const double *points,
                                 const double *directions, double tolerance, ct_ray_hit *out,
                                 ct_error *error);

CT_END_DECLS

#endif
