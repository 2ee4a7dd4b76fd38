/* Search for the face of a surface that is closest to a point, with a tree of bounding boxes.
 * Threads: no other call may use a search while ct_search_move changes it; queries of one search
 * may run at the same time. */
#ifndef LIBCONTACT_SEARCH_H
#define LIBCONTACT_SEARCH_H

#include <libcontact/projection.h>

CT_BEGIN_DECLS

/** A surface with its tree of bounding boxes, :eq:`bounding-tree`; opaque. */
typedef struct ct_search ct_search;

/**
 * Prepare a surface for queries. Its arrays are copied. ``CT_ERROR_ARGUMENT``: empty surface,
 * unknown kind, node number out of range; ``CT_INVALID``: a coordinate is not finite or above 1e70;
 * ``CT_ERROR_GEOMETRY``: a face without area (`error` names the face).
 */
CT_API ct_status ct_search_create(const ct_surface *surface, ct_search **out, ct_error *error);

/**
 * Move the nodes to `x` [length], shape (node_count, 3). The tree is refitted, or rebuilt if its
 * queries have become too expensive, :eq:`tree-cost`; results do not depend on this choice.
 * ``CT_INVALID``: a coordinate is not finite or above 1e70 (`error` names the node); the nodes then
 * stay where they were.
 */
CT_API ct_status ct_search_move(ct_search *search, const double *x, ct_error *error);

/** Number of times that the tree was built: 1 after ct_search_create, plus one for each move that
 * made a rebuild necessary; 0 for a null pointer. */
CT_API int64_t ct_search_builds(const ct_search *search);

/** Estimated cost of a query in the refitted tree divided by the cost in the tree when it was built
 * [-], :eq:`tree-cost`; NaN for a null pointer. */
CT_API double ct_search_cost(const ct_search *search);

/** The closest point of a surface; ct_search_nearest writes all members. */
typedef struct ct_nearest {
  /**
   * CT_OK or CT_NOT_CERTIFIED, as ct_project returns it for the face. CT_INVALID: the point is not
   * finite or above 1e70, or the projection is invalid on every face; all floating-point members
   * are then NaN.
   */
  ct_status status;
  /** Number of the face, the lowest one if several are equally close; -1 with CT_INVALID. */
  int32_t face;
  /** Interior, edge or vertex of the face. */
  ct_where where;
  /** Number of the edge (edge i joins corners i and i + 1) or of the corner; -1 inside. */
  int32_t index;
  /** Reference coordinates of the closest point. */
  double xi[2];
  /** The closest point [length]. */
  double point[3];
  /** Distance of the given point from the closest point [length], not negative. */
  double distance;
  /** The distance with a sign: positive outside, where ``normal`` points. The sign is correct at
   * edges and corners of the surface, too, :eq:`pseudo-normal`. */
  double signed_distance;
  /** Unit vector that points outwards: the normal inside a face; on edges and corners the mean of
   * the normals of the faces that meet there. */
  double normal[3];
} ct_nearest;

/** Options of a query. Start from `ct_search_options_default`. */
typedef struct ct_search_options {
  /** Set by `ct_search_options_default`. */
  int32_t cookie;
  /** Bound on the error of xi in half-widths of the face, as of ct_project, > 0. */
  double tolerance;
  /** Number of threads, >= 1; results do not depend on it. */
  int threads;
} ct_search_options;

/** A tolerance of 1e-10 and one thread. */
CT_API ct_search_options ct_search_options_default(void);

/**
 * Find the closest face of the surface for each of ``count`` points, shape (count, 3), and write it
 * to ``out[count]``. Null ``options`` select the
 * defaults. ``start`` is
 * null, or has for each point a face that is probably close, for example that of the last step,
 * shape (count); -1 means none. Without ``start`` the search of each point begins with the face of
 * the previous point. Good starts, and consecutive points that are close to each other, save time
 * and do not change the results. ``CT_ERROR_ARGUMENT``: null pointer, invalid option, a start that
 * is not a face number; no output is written then. Otherwise CT_OK; see the status of each point.
 */
CT_API ct_status ct_search_nearest(const ct_search *search, size_t count, const double *points,
                                   const int32_t *start, const ct_search_options *options,
                                   ct_nearest *out, ct_error *error);

/**
 * Find a closed part of the surface whose faces point inwards, at the present coordinates: it
 * encloses a negative volume, :eq:`enclosed-volume`, and does not lie within another closed part,
 * as the wall of a cavity does. Write its first face, or -1 if there is none. In a contact such a
 * body lets others through without a force, so a host should ask this once for each surface. The
 * wall of a cavity that is a surface of its own is reported, too. ``CT_ERROR_ARGUMENT``: null
 * argument; ``CT_ERROR_MEMORY``.
 */
CT_API ct_status ct_search_inside_out(const ct_search *search, int32_t *face, ct_error *error);

/** Free a search; null is allowed. */
CT_API void ct_search_free(ct_search *search);

CT_END_DECLS

#endif
