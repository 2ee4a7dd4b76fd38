/* The face of a surface that is closest to a point, by a tree of boxes.
 * Threads: ct_search_move must be alone with its search; queries of one search may run at once.
 */
#ifndef LIBCONTACT_SEARCH_H
#define LIBCONTACT_SEARCH_H

#include <libcontact/shape.h>
#include <libcontact/projection.h>

CT_BEGIN_DECLS

/**
 * A surface: faces over somebody's nodes. Node numbers refer to the arrays of coordinates, forces
 * and masses that the host passes to the calls of a search or a contact; they may be the nodes of a
 * whole mesh.
 */
typedef struct ct_surface {
  /** All faces are of one kind. */
  ct_face_kind kind;
  /** Rows of the host's arrays. */
  int32_t node_count;
  /** Number of faces. */
  int32_t face_count;
  /** Node numbers, counter-clockwise from outside, shape (face_count, nodes of a face). */
  const int32_t *faces;
  /**
   * Reference coordinates [length], shape (node_count, 3): the shape that a search begins with;
   * they give a contact the weights w J_ref of its Gauss points.
   */
  const double *reference;
} ct_surface;

/** A surface that can be asked for its nearest face; opaque, as it holds the tree of boxes
 * :eq:`bounding-tree`. */
typedef struct ct_search ct_search;

/**
 * Prepare a surface for queries. Its arrays are copied. ``CT_ERROR_ARGUMENT``: empty surface,
 * unknown kind, node number out of range; ``CT_INVALID``: a coordinate is not finite or beyond
 * 1e70; ``CT_ERROR_GEOMETRY``: a face without area (`error` names the face).
 */
CT_API ct_status ct_search_create(const ct_surface *surface, ct_search **out, ct_error *error);

/**
 * Move the nodes to `x` [length], shape (node_count, 3). The tree is refitted, or built anew when
 * it has become poor, :eq:`tree-cost`; answers do not depend on which. ``CT_INVALID``: a coordinate
 * is not finite or beyond 1e70 (`error` names the node); nothing has moved then.
 */
CT_API ct_status ct_search_move(ct_search *search, const double *x, ct_error *error);

/** How often the tree was built: 1 after ct_search_create, one more for each move that made it
 * poor; 0 for a null pointer. */
CT_API int64_t ct_search_builds(const ct_search *search);

/** Cost of a query in the refitted tree over that in the tree as it was built, :eq:`tree-cost`; NaN
 * for a null pointer. */
CT_API double ct_search_cost(const ct_search *search);

/** The nearest place of a surface; everything is written by ct_search_nearest. */
typedef struct ct_nearest {
  /**
   * As of ct_project for the face: CT_OK or CT_NOT_CERTIFIED. CT_INVALID: the point is not finite
   * or beyond 1e70, or no face has an answer; then all floating-point members are NaN.
   */
  ct_status status;
  /** Number of the face, of equally near ones the first; -1 with CT_INVALID. */
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
  /** The distance with a sign: positive outside, where ``normal`` points. Right at folds too,
   * :eq:`pseudo-normal`. */
  double signed_distance;
  /** Unit vector outwards: the normal inside a face; on edges and corners the mean over the faces
   * that meet there. */
  double normal[3];
} ct_nearest;

/** Choices of a query. */
typedef struct ct_search_options {
  /** Bound on the error of xi in half-widths of the face, as of ct_project, > 0. */
  double tolerance;
  /** Threads; >= 1; results do not depend on it. */
  int threads;
} ct_search_options;

/**
 * Nearest face of the surface for each of ``count`` points, shape (count, 3), into ``out[count]``.
 * Null ``options`` are a tolerance of 1e-10 and one thread. ``start`` is null, or has a face for
 * each point, shape (count), that is probably near (that of the last step, say); -1 means none.
 * Without it each point begins with the face of the point before it. Points that follow each other
 * closely and good starts save time; no bit of the answer depends on them. ``CT_ERROR_ARGUMENT``:
 * null pointer, impossible option, a start that is no face; then nothing is written. Else CT_OK;
 * see the status of each point.
 */
CT_API ct_status ct_search_nearest(const ct_search *search, size_t count, const double *points,
                                   const int32_t *start, const ct_search_options *options,
                                   ct_nearest *out);

/** Free a search; null is allowed. */
CT_API void ct_search_free(ct_search *search);

CT_END_DECLS

#endif
