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
  /** Set by `ct_project_options_default`. */
  int32_t cookie;
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
 * Returns ``out->status``. CT_ERROR_ARGUMENT, which alone writes `error`, with all floating-point
 * members NaN: a null pointer, an unknown face kind or method, a tolerance that is not positive, a
 * start that is not finite, or a negative limit. With CT_ROBUST and CT_NEWTON a mirrored face and
 * point give the mirrored result bit by bit, and a scaling by a power of two gives the scaled
 * result.
 */
CT_API ct_status ct_project(const ct_face *face, const double point[3],
                            const ct_project_options *options, ct_projection *out, ct_error *error);

/**
 * Closest point of one face to each of ``count`` points, shape (count, 3), into ``out[count]``.
 * ``start`` is null, or has a start for each point, shape (count, 2), which replaces the start of
 * the options. Returns CT_OK if all points were processed (see the status of each), otherwise the
 * first error.
 */
CT_API ct_status ct_project_points(const ct_face *face, size_t count, const double *points,
                                   const ct_project_options *options, const double *start,
                                   ct_projection *out, ct_error *error);

CT_END_DECLS

#endif
