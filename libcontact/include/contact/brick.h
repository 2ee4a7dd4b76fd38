#ifndef CONTACT_BRICK_H
#define CONTACT_BRICK_H

#include <contact/segment.h>

CT_BEGIN_DECLS

/**
 * Kind of a brick element on -1 <= xi_1, xi_2, xi_3 <= 1, nodes in the order of VTK: the corners
 * (-,-,-), (+,-,-), (+,+,-),
 * (-,+,-), then the same four at xi_3 = +1; for hex20 then the middles of the 4 bottom edges, of
 * the 4 top edges and of the 4 upright edges.
 */
typedef enum ct_brick_kind {
  /** trilinear brick, 8 nodes */
  CT_HEX8 = 0,
  /** serendipity brick, 20 nodes */
  CT_HEX20 = 1
} ct_brick_kind;

/** Number of nodes of a brick kind: 8 or 20, and 0 for a kind that does not exist. */
CT_API int ct_brick_node_count(ct_brick_kind kind);

/** Kind of the six faces: CT_Q4 for hex8, CT_Q8 for hex20. */
CT_API ct_face_kind ct_brick_face_kind(ct_brick_kind kind);

/**
 * Reference coordinates (each -1, 0 or 1) of node 0 to 19, written to ``xi``; NaN for a node that
 * the kind does not have. Here and below a null pointer writes nothing.
 */
CT_API void ct_brick_reference(ct_brick_kind kind, int node, double xi[3]);

/**
 * Shape functions N_i(xi), :eq:`brick-hex8` and :eq:`brick-hex20`; entries beyond the node count
 * are 0, an unknown kind gives NaN.
 */
CT_API void ct_brick_shape(ct_brick_kind kind, const double xi[3], double N[20]);

/** First derivatives ``dN[i][a]`` = dN_i/dxi_a. */
CT_API void ct_brick_gradient(ct_brick_kind kind, const double xi[3], double dN[20][3]);

/**
 * Nodes of one side as a face: ``side`` 0 to 5 is x_min, x_max, y_min, y_max, z_min, z_max (xi_1 =
 * -1, xi_1 = +1, xi_2 = -1,
 * ...). They are in the order of ct_face_kind, counter-clockwise seen from outside, so that the
 * face normal points out of a brick that is not inverted. Opposite sides have the same second axis
 * and the first one flipped (:eq:`brick-sides`): a mirrored brick has mirrored faces. ``nodes``
 * entries beyond the node count of the face, and all for an impossible side, are -1.
 */
CT_API void ct_brick_face(ct_brick_kind kind, int side, int nodes[8]);

CT_END_DECLS

#endif
