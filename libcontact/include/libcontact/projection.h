/* Closest points of one face: one point at a time, many points at once, along a line.
 * Threads: every call at any time, also on one face; they write only what they are given. */
#ifndef LIBCONTACT_PROJECTION_H
#define LIBCONTACT_PROJECTION_H

#include <libcontact/shape.h>

CT_BEGIN_DECLS

/** How the closest point is looked for. */
typedef enum ct_method {
  /** the paper's search: a regular simplex that is only reflected and halved; unconstrained */
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
  /** the default: samples, then Newton in a trust region, on the closed face */
  CT_ROBUST = 7,
  /** robust, with a proof that no other point is closer */
  CT_CERTIFIED = 8,
  /** the simplex to get near, Newton-Raphson to finish; unconstrained */
  CT_SIMPLEX_NEWTON = 9,
  /** projection on a sphere that touches the face at the iterate; unconstrained */
  CT_SPHERE = 10,
  /** projection on a torus that has both curvatures of the face at the iterate; unconstrained */
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
  /** beyond the face; only the unconstrained methods end there */
  CT_OUTSIDE = 3
} ct_where;

/** Called with every iterate: its reference coordinates, f there [length^2], and the pointer of the
 * options. */
typedef void (*ct_project_trace)(const double xi[2], double f, void *user);

/** What a caller may choose; start from ct_project_options_default. */
typedef struct ct_project_options {
  /** The method; CT_ROBUST. */
  ct_method method;
  /** Bound on the error of xi, in half-widths of the face (1 on quadrilaterals, 1/2 on triangles);
   * 1e-10. Must be positive. */
  double tolerance;
  /**
   * Not zero: begin at ``start`` (the last answer, say). Zero: begin at the centre of the face, and
   * for CT_ROBUST and CT_CERTIFIED at the best of a few samples.
   */
  int use_start;
  double start[2];
  /**
   * Iterations before giving up with CT_ITERATION_LIMIT; 0 takes the limit of the method (simplex,
   * nelder_mead and steepest_descent 2000, newton, robust and certified 100, the others 200).
   */
  int iteration_limit;
  /** Null, or called with every iterate. */
  ct_project_trace trace;
  /** Handed to ``trace``. */
  void *user;
} ct_project_options;

/** The closest point that was found; everything is written by ct_project. */
typedef struct ct_projection {
  /**
   * CT_OK: xi is within the tolerance of a minimum of f (with CT_SIMPLEX: the edge is, which on
   * long thin faces can be far from it). CT_NOT_CERTIFIED: f is at its minimum as far as double
   * precision shows, yet xi may be off by more than the tolerance (a far point, a face that is
   * nearly a sphere about the point). CT_ITERATION_LIMIT: the budget is used up, or simplex or
   * nelder_mead compares nothing but rounding. CT_NO_CONVERGENCE: no minimum was found. CT_INVALID:
   * the input is not finite, the face has no area or no normal where the method has ended, the
   * start is so far out that f overflows, or a length is not between 1e-70 and 1e70; then all
   * floating-point members are NaN.
   */
  ct_status status;
  /** Interior, edge, vertex or outside. */
  ct_where where;
  /** Number of the edge (edge i joins corners i and i + 1) or of the corner; -1 where there is
   * none. */
  int index;
  /** Calls of f (with or without gradient and Hessian), samples included. */
  int evaluations;
  int iterations;
  /**
   * Not zero when a proof says that no point of the face is closer by more than half of
   * max(distance, size) times the tolerance, taken between 1e-12 and 1e-6; size is the largest
   * coefficient of :eq:`projection-patch`, but the constant one. Rounding is counted. The nodes and
   * the point are taken as exact. Only CT_CERTIFIED sets it, and its CT_OK means this and no more:
   * xi may be undetermined where many points are as near.
   */
  int certified;
  /** Reference coordinates of the closest point. */
  double xi[2];
  /** The closest point y(xi) [length]. */
  double point[3];
  /** Distance of the given point from the closest point [length], not negative. */
  double distance;
  /** The distance with a sign: positive when the given point lies on the side of the normal. */
  double signed_distance;
  /** Unit normal of the face at the closest point, along y,1 x y,2. */
  double normal[3];
} ct_projection;

/** Default options: CT_ROBUST, tolerance 1e-10, no start, the method's own iteration limit, no
 * trace. */
CT_API ct_project_options ct_project_options_default(void);

/**
 * Closest point of a face to ``point``, :eq:`projection-minimum`. Null ``options`` are the
 * defaults.
 *
 * The answer is ``out->status``, or, with all floating-point members NaN: CT_ERROR_ARGUMENT for a
 * null pointer, an unknown face kind or method, a tolerance that is not positive, a start that is
 * not finite or a negative limit. A mirrored face and point give the mirrored bits with CT_ROBUST
 * and CT_NEWTON, as does a scaling by a power of two.
 */
CT_API ct_status ct_project(const ct_face *face, const double point[3],
                            const ct_project_options *options, ct_projection *out);

/**
 * Closest point of one face to each of ``count`` points, shape (count, 3), into ``out[count]``.
 * ``start`` is null, or has a start for each point, shape (count, 2), which replaces the start of
 * the options. Answers CT_OK when every point was looked at (see the status of each), else the
 * first error
 */
CT_API ct_status ct_project_points(const ct_face *face, size_t count, const double *points,
                                   const ct_project_options *options, const double *start,
                                   ct_projection *out);

/** Where a line meets a face; everything is written by ct_project_rays. */
typedef struct ct_ray_hit {
  /**
   * CT_OK: the line meets the face, and of all such points this is the one nearest to the given
   * point, along the line in either sense. CT_NO_CONVERGENCE: the line misses the face; that is
   * shown, not guessed. CT_NOT_CERTIFIED: the line touches the face, or lies in it, and xi is a
   * point where it does. CT_ITERATION_LIMIT: the budget is used up with nothing found. CT_INVALID:
   * as in ct_projection, or a direction that has no length or is not finite. All but CT_OK and
   * CT_NOT_CERTIFIED come with NaN in all floating-point members.
   */
  ct_status status;
  /** Interior, edge or vertex; outside where there is no hit. */
  ct_where where;
  /** Number of the edge or of the corner; -1 where there is none. */
  int index;
  /** Points of the face that were looked at. */
  int evaluations;
  /** Reference coordinates of the hit. */
  double xi[2];
  /** The hit [length]. */
  double point[3];
  /** The way from the given point to the hit along the direction [length]; negative behind the
   * point. */
  double distance;
  /** Unit normal of the face at the hit. */
  double normal[3];
} ct_ray_hit;

/**
 * Distance from each of ``count`` points to a face along a direction, both of shape (count, 3),
 * into
 * ``out[count]``, :eq:`ray-hit`: the gap as it is measured along a normal of the other surface. A
 * direction may have any length. ``tolerance`` is how far beyond the face a hit may lie, in
 * half-widths; 1e-10 is a good choice.
 *
 * Answers CT_OK when every line was looked at (see the status of each), else CT_ERROR_ARGUMENT,
 * with NaN, for a null pointer, an unknown kind, or a tolerance that is not positive and below 1.
 */
CT_API ct_status ct_project_rays(const ct_face *face, size_t count, const double *points,
                                 const double *directions, double tolerance, ct_ray_hit *out);

/**
 * Where ct_project_batch writes the closest points of a batch; arrays in lanes, of
 * (count + 7) / 8 blocks. A null pointer is not written. A pair that ct_project answers with
 * CT_INVALID has NaN here too.
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
 * The closest points of ``count`` pairs of a face and a point, eight side by side; the answers are
 * those of CT_ROBUST. All faces are of one kind. Pair p stands in lane p % 8 of block p / 8,
 * :eq:`batch-lanes`: ``nodes``, shape (blocks, nodes of the kind, 3, 8), ``points``, shape (blocks,
 * 3, 8), and ``start``, null or of shape (blocks, 2, 8); fill the last block up with any pair. A
 * start that is not finite is none. Null ``options`` are the defaults; method, use_start, start and
 * trace of them are not read.
 *
 * Eight pairs are computed at a time with AVX-512, four with AVX2, one on other machines; the bits
 * are the same. CT_ERROR_ARGUMENT, with nothing written: a null pointer, an unknown kind, a
 * tolerance that is not positive or a negative limit. CT_OK otherwise; see the status of each pair.
 */
CT_API ct_status ct_project_batch(ct_face_kind kind, size_t count, const double *nodes,
                                  const double *points, const double *start,
                                  const ct_project_options *options,
                                  const ct_batch_closest *closest);

CT_END_DECLS

#endif
