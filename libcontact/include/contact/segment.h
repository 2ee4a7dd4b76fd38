#ifndef CONTACT_SEGMENT_H
#define CONTACT_SEGMENT_H

#include <contact/status.h>

CT_BEGIN_DECLS

/**
 * Kind of a contact face. Quadrilaterals live on -1 <= xi_1, xi_2 <= 1 with the corners (-1,-1),
 * (1,-1), (1,1), (-1,1) and, for Q8, the mid-sides (0,-1), (1,0), (0,1), (-1,0). Triangles live on
 * xi_1, xi_2 >= 0, xi_1 + xi_2 <= 1 with the corners (0,0), (1,0), (0,1) and, for T6, the mid-sides
 * 1-2, 2-3, 3-1.
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
  /** Which shape functions the face has. */
  ct_face_kind kind;
  /** Node coordinates, shape (nodes, 3). */
  double node[8][3];
} ct_face;

/** Number of nodes of a face kind: 4, 8, 3 or 6, and 0 for a kind that does not exist. */
CT_API int ct_face_node_count(ct_face_kind kind);

/**
 * Shape functions N_i(xi) of :eq:`segment-point`, written to ``N``. Entries beyond the node count
 * are 0; an unknown kind gives NaN everywhere, a null pointer writes nothing (so in all functions
 * of this header).
 */
CT_API void ct_segment_shape(ct_face_kind kind, const double xi[2], double N[8]);

/** First derivatives ``dN[i][a]`` = dN_i/dxi_a. */
CT_API void ct_segment_gradient(ct_face_kind kind, const double xi[2], double dN[8][2]);

/** Second derivatives ``ddN[i]`` = (N_i,11  N_i,22  N_i,12). */
CT_API void ct_segment_hessian(ct_face_kind kind, const double xi[2], double ddN[8][3]);

/** The point y(xi) of the face [length], :eq:`segment-point`. */
CT_API void ct_segment_point(const ct_face *face, const double xi[2], double y[3]);

/** The tangents t_a = dy/dxi_a [length], :eq:`segment-tangents`. */
CT_API void ct_segment_tangents(const ct_face *face, const double xi[2], double t1[3],
                                double t2[3]);

/**
 * The unit normal t_1 x t_2 / ``|t_1 x t_2|``, :eq:`segment-normal`. Where the tangents are
 * parallel, zero or not finite there is none: then ``n`` is NaN and the answer is
 * CT_ERROR_GEOMETRY. A null pointer or unknown kind gives CT_ERROR_ARGUMENT.
 */
CT_API ct_status ct_segment_normal(const ct_face *face, const double xi[2], double n[3]);

/** The area element J = ``|t_1 x t_2|`` [length^2] of :eq:`segment-area`; NaN for a null pointer or
 * unknown kind. */
CT_API double ct_segment_area_element(const ct_face *face, const double xi[2]);

CT_END_DECLS

#endif
