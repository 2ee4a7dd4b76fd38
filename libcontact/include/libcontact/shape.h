/* Faces, surfaces and bricks: shape functions, tangents and quadrature rules.
 * Threads: every call is safe at any time; a call writes only its output arguments. */
#ifndef LIBCONTACT_SHAPE_H
#define LIBCONTACT_SHAPE_H

#include <libcontact/base.h>

CT_BEGIN_DECLS

/**
 * Kind of a contact face. The reference domain of quadrilaterals is -1 <= xi_1, xi_2 <= 1, with the
 * corners (-1,-1), (1,-1), (1,1), (-1,1) and, for Q8, the mid-sides (0,-1), (1,0), (0,1), (-1,0).
 * That of triangles is xi_1, xi_2 >= 0, xi_1 + xi_2 <= 1, with the corners (0,0), (1,0), (0,1) and,
 * for T6, the mid-sides 1-2, 2-3, 3-1.
 */
typedef enum ct_face_kind {
  /** bilinear quadrilateral, 4 nodes */
  CT_Q4 = 0,
  /** serendipity quadrilateral, 8 nodes */
  CT_Q8 = 1,
  /** linear triangle, 3 nodes */
  CT_T3 = 2,
  /** quadratic triangle, 6 nodes */
  CT_T6 = 3
} ct_face_kind;

/** One face with the coordinates of its nodes [length]; rows beyond the node count of the kind are
 * never read. */
typedef struct ct_face {
  /** Selects the shape functions. */
  ct_face_kind kind;
  /** Node coordinates, shape (nodes, 3). */
  double node[8][3];
} ct_face;

/**
 * A surface: faces given by node numbers. The numbers are rows of the arrays of coordinates, forces
 * and masses that the host passes to a search or a contact; these arrays may contain the nodes of a
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
   * Reference coordinates [length], shape (node_count, 3). A search starts with this shape; a
   * contact computes the weights w J_ref of its Gauss points from it.
   */
  const double *reference;
} ct_surface;

/** Number of nodes of a face kind: 4, 8, 3 or 6, and 0 for an unknown kind. */
CT_API int ct_face_node_count(ct_face_kind kind);

/**
 * Shape functions N_i(xi) of :eq:`segment-point`, written to ``N``. Entries beyond the node count
 * are 0. For an unknown kind all outputs are NaN; with a null pointer the call has no effect. Both
 * hold for all functions of this header.
 */
CT_API void ct_segment_shape(ct_face_kind kind, const double xi[2], double N[8]);

/** The point y(xi) of the face [length], :eq:`segment-point`. */
CT_API void ct_segment_point(const ct_face *face, const double xi[2], double y[3]);

/**
 * Kind of a brick element on -1 <= xi_1, xi_2, xi_3 <= 1. Nodes are in the order of VTK: the
 * corners (-,-,-), (+,-,-), (+,+,-), (-,+,-), then the same four at xi_3 = +1; for hex20 then the
 * midpoints of the 4 bottom edges, the 4 top edges and the 4 vertical edges.
 */
typedef enum ct_brick_kind {
  /** trilinear brick, 8 nodes */
  CT_HEX8 = 0,
  /** serendipity brick, 20 nodes */
  CT_HEX20 = 1,
  /** Number of kinds; it grows with later versions. */
  CT_BRICK_COUNT
} ct_brick_kind;

/** What a kind of brick is: its row in the table of `libcontact/src/shape/brick.c`. */
typedef struct ct_brick_facts {
  /** Its word in a scene. */
  const char *name;
  /** Number of nodes, at most 20; the first 8 are the corners. */
  int node_count;
  /** Kind of its six faces. */
  ct_face_kind face_kind;
  /** Gauss points along each axis of the full rule, :eq:`quadrature-product`: 2 or 3. */
  int points;
  /** Number of the cell type in VTK. */
  int vtk;
  /** Nodes per brick of an infinite mesh: 1, or 4 with nodes in the middles of edges. */
  int cell_nodes;
  /** 1 if the sums of the rows of its mass matrix are positive and it is lumped by them,
   * :eq:`row-sum`; 0: by :eq:`hrz`. */
  int row_sum;
  /** 1 for the trilinear brick, which alone has the kernels `CT_KERNEL_PLANE` and
   * `CT_KERNEL_REDUCED`, bounds by blocks and bulk viscosity. */
  int trilinear;
} ct_brick_facts;

/** The facts of a kind; null for an unknown one. */
CT_API const ct_brick_facts *ct_brick_facts_of(ct_brick_kind kind);

/** Number of nodes of a brick kind, and 0 for an unknown kind. */
CT_API int ct_brick_node_count(ct_brick_kind kind);

/** Kind of the six faces of a known kind. */
CT_API ct_face_kind ct_brick_face_kind(ct_brick_kind kind);

/**
 * Shape functions N_i(xi), :eq:`brick-hex8` and :eq:`brick-hex20`; entries beyond the node count
 * are 0, an unknown kind gives NaN.
 */
CT_API void ct_brick_shape(ct_brick_kind kind, const double xi[3], double N[20]);

/** First derivatives ``dN[i][a]`` = dN_i/dxi_a. */
CT_API void ct_brick_gradient(ct_brick_kind kind, const double xi[3], double dN[20][3]);

/**
 * A quadrature rule on the reference face or brick, :eq:`quadrature-rule`. On quadrilaterals and
 * bricks xi_1 varies fastest, then xi_2, then xi_3, each in ascending order, so that point p and
 * its mirror image are easy to pair.
 */
typedef struct ct_rule {
  /** Number of points, at most 27. */
  int count;
  /** Reference coordinates, shape (count, 3); the third is 0 on a face. */
  double xi[27][3];
  /** Weights, shape (count,); they add up to the size of the reference domain: 4, 1/2 or 8. */
  double weight[27];
} ct_rule;

/**
 * The Gauss rule that contact uses on a face: 2 x 2 points for Q4, 3 x 3 for Q8, 3 for T3, 6 for
 * T6. CT_ERROR_ARGUMENT: unknown kind or null pointer; ``rule`` then has no points.
 */
CT_API ct_status ct_rule_face(ct_face_kind kind, ct_rule *rule, ct_error *error);

CT_END_DECLS

#endif
