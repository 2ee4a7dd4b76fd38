/* Closest points on one face: for one point, for many points, and along a line.
 * Threads: every call is safe at any time, also on the same face; a call writes only its output
 * arguments. */
#ifndef LIBCONTACT_PROJECTION_H
#define LIBCONTACT_PROJECTION_H

#include <libcontact/shape.h>

CT_BEGIN_DECLS

/** Methods that find the closest point. */
typedef enum ct_method {
  /** the simplex search of the paper, which reflects and halves a regular simplex; unconstrained */
  CT_SIMPLEX = 0,
  /** the full Nelder-Mead search, with expansion and contraction; unconstrained */
  CT_NELDER_MEAD = 1,
  /** Newton-Raphson on :eq:`projection-stationary`; unconstrained */
  CT_NEWTON = 2,
  /** Gauss-Newton, the least-square projection; unconstrained */
  CT_LEAST_SQUARES = 3,
  /** steepest descent; unconstrained */
  CT_STEEPEST_DESCENT = 4,
  /** Broyden's method; unconstrained */
  CT_BROYDEN = 5,
  /** the BFGS method; unconstrained */
  CT_BFGS = 6,
  /** the default: samples, then Newton's method in a trust region, on the closed face */
  CT_ROBUST = 7,
  /** robust, with a proof that no other point is closer */
  CT_CERTIFIED = 8,
  /** simplex for a first approximation, then Newton-Raphson; unconstrained */
  CT_SIMPLEX_NEWTON = 9,
  /** projection onto a sphere tangent to the face at the iterate; unconstrained */
  CT_SPHERE = 10,
  /** projection onto a torus with both curvatures of the face at the iterate; unconstrained */
  CT_TORUS = 11
} ct_method;

/** On which part of the face a closest point lies. */
typedef enum ct_where {
  /** inside */
  CT_INTERIOR = 0,
  /** on an edge, within the tolerance */
  CT_EDGE = 1,
  /** on a corner, within the tolerance */
  CT_VERTEX = 2,
  /** outside the face; only the unconstrained methods end there */
  CT_OUTSIDE = 3
} ct_where;

/** Called with every iterate: its reference coordinates, f there [length^2], and the pointer of the
 * options. */
typedef void (*ct_project_trace)(const double xi[2], double f, void *user);

/** Options of a projection. Start from ct_project_options_default. */
typedef struct ct_project_options {
  /** The method; default CT_ROBUST. */
  ct_method method;
  /** Bound on the error of xi, in half-widths of the face (1 on quadrilaterals, 1/2 on triangles),
   * > 0; default 1e-10. */
  double tolerance;
  /**
   * Not zero: begin at ``start``, for example the previous result. Zero: begin at the centre of the
   * face, or for CT_ROBUST and CT_CERTIFIED at the best of a few samples.
   */
  int use_start;
  double start[2];
  /**
   * Number of iterations after which the method stops with CT_ITERATION_LIMIT. 0 selects the limit
   * of the method: 2000 for simplex, nelder_mead and steepest_descent, 100 for newton, robust and
   * certified, 200 for the others.
   */
  int iteration_limit;
  /** Null, or a function called with every iterate. */
  ct_project_trace trace;
  /** Passed to ``trace``. */
  void *user;
} ct_project_options;

/** The closest point; ct_project writes all members. */
typedef struct ct_projection {
  /**
   * CT_OK: xi is within the tolerance of a minimum of f. (CT_SIMPLEX guarantees only that the edge
   * of its simplex is below the tolerance; on long thin faces xi can be far from the minimum.)
   * CT_NOT_CERTIFIED: f is at its minimum to double precision, but the error of xi may exceed the
   * tolerance, as for a distant point or a face that is almost a sphere around the point.
   * CT_ITERATION_LIMIT: the iteration limit was reached, or the values that simplex or nelder_mead
   * compares differ by rounding only. CT_NO_CONVERGENCE: no minimum was found. CT_INVALID: the
   * input is not finite, the face has no area or no normal where the method ended, f overflows at
   * the start, or a length is not between 1e-70 and 1e70; all floating-point members are then NaN.
   */
  ct_status status;
  /** Interior, edge, vertex or outside. */
  ct_where where;
  /** Number of the edge (edge i joins corners i and i + 1) or of the corner; -1 otherwise. */
  int index;
  /** Calls of f (with or without gradient and Hessian), samples included. */
  int evaluations;
  int iterations;
  /**
   * Not zero if it is proved that no point of the face is closer by more than half of max(distance,
   * size) times the tolerance, limited to 1e-12 ... 1e-6. Here size is the largest coefficient of
   * :eq:`projection-patch` except the constant one. The proof includes rounding errors and takes
   * the nodes and the point as exact. Only CT_CERTIFIED sets it, and returns CT_OK for this proof
   * alone: xi may be undetermined if many points are equally close.
   */
  int certified;
  /** Reference coordinates of the closest point. */
  double xi[2];
  /** The closest point y(xi) [length]. */
  double point[3];
  /** Distance of the given point from the closest point [length], not negative. */
  double distance;
  /** The distance with a sign: positive if the given point lies on the side to which the normal
   * points. */
  double signed_distance;
  /** Unit normal of the face at the closest point, along y,1 x y,2. */
  double normal[3];
} ct_projection;

/** Default options: CT_ROBUST, tolerance 1e-10, no start, the method's own iteration limit, no
 * trace. */
CT_API ct_project_options ct_project_options_default(void);

/**
 * Find the point of a face that is closest to ``point``, :eq:`projection-minimum`. Null ``options``
 * select the defaults.
 *
 * Returns ``out->status``. CT_ERROR_ARGUMENT, with all floating-point members NaN: a null pointer,
 * an unknown face kind or method, a tolerance that is not positive, a start that is not finite, or
 * a negative limit. With CT_ROBUST and CT_NEWTON a mirrored face and point give the mirrored result
 * bit by bit, and a scaling by a power of two gives the scaled result.
 */
CT_API ct_status ct_project(const ct_face *face, const double point[3],
                            const ct_project_options *options, ct_projection *out);

/**
 * Closest point of one face to each of ``count`` points, shape (count, 3), into ``out[count]``.
 * ``start`` is null, or has a start for each point, shape (count, 2), which replaces the start of
 * the options. Returns CT_OK if all points were processed (see the status of each), otherwise the
 * first error.
 */
CT_API ct_status ct_project_points(const ct_face *face, size_t count, const double *points,
                                   const ct_project_options *options, const double *start,
                                   ct_projection *out);

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
                                 const double *directions, double tolerance, ct_ray_hit *out);

/**
 * Where ct_project_batch writes the closest points of a batch: arrays of (count + 7) / 8 blocks of
 * eight lanes. Outputs with a null pointer are not written. Where ct_project returns CT_INVALID for
 * a pair, the batch has NaN, too.
 */
typedef struct ct_batch_closest {
  /** Reference coordinates, shape (blocks, 2, 8). */
  double *xi;
  /** Distance of each point from its closest point [length], shape (blocks, 8). */
  double *distance;
  /** The distance with its sign, shape (blocks, 8). */
  double *signed_distance;
  /** Unit normals at the closest points, shape (blocks, 3, 8). */
  double *normal;
  /** The ct_status of each pair, shape (blocks, 8). */
  int32_t *status;
  /** Calls of f, shape (blocks, 8). */
  int32_t *evaluations;
} ct_batch_closest;

/**
 * Find the closest points of ``count`` pairs of a face and a point, eight pairs at a time, with the
 * results of CT_ROBUST. All faces are of one kind. Pair p is in lane p % 8 of block p / 8,
 * :eq:`batch-lanes`. ``nodes`` has the shape (blocks, nodes of the kind, 3, 8), ``points`` (blocks,
 * 3, 8), and ``start`` is null or has the shape (blocks, 2, 8). Fill the last block with copies of
 * any pair. A start that is not finite is ignored. Null ``options`` select the defaults; their
 * method, use_start, start and trace are not read.
 *
 * The processor computes eight pairs at once with AVX-512, four with AVX2, otherwise one; the
 * results are the same bit by bit. CT_ERROR_ARGUMENT: a null pointer, an unknown kind, a tolerance
 * that is not positive, or a negative limit; then no output is written. CT_OK otherwise; see the
 * status of each pair.
 */
CT_API ct_status ct_project_batch(ct_face_kind kind, size_t count, const double *nodes,
                                  const double *points, const double *start,
                                  const ct_project_options *options,
                                  const ct_batch_closest *closest);

CT_END_DECLS

#endif
