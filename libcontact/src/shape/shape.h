#ifndef CT_SRC_SHAPE_H
#define CT_SRC_SHAPE_H

#include "../base/lanes.h"

#include <libcontact/shape.h>

/* Shape functions of a quadrilateral of `per` (4 or 8) nodes, with the stride `stride` between
 * nodes; those beyond `per` are 0 (eq:segment-q4, eq:segment-q8). For a known `per` and lanes side
 * by side the compiler vectorises them. */
CT_INLINE void ct_shape_quadrilateral(int per, double xi, double eta, double *N, int stride)
{
  static const double CORNER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int i = 0; i < 4; i++) {
    // -- Corners of the quadrilaterals (eq:segment-q4, eq:segment-q8)
    double x = CORNER[i][0] * xi, y = CORNER[i][1] * eta, corner = 0.25 * ((1 + x) * (1 + y));
    N[stride * i] = per == 8 ? corner * ((x + y) - 1) : corner;
    // -- Mid-side that follows the corner: even ones run along ξ (eq:segment-q8)
    double along = i % 2 == 0 ? xi : eta,
           across = i % 2 == 0 ? CORNER[i][1] * eta : CORNER[i][0] * xi;
    N[stride * (4 + i)] = per == 8 ? 0.5 * (((1 - along) * (1 + along)) * (1 + across)) : 0.0;
  }
}

/* First derivatives of a quadrilateral with four nodes at one place; a number of them is `stride`
 * behind the last. */
static inline void ct_shape_gradient_q4(double xi, double eta, double *dN, int stride)
{
  static const double CORNER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int i = 0; i < 4; i++) {
    dN[stride * (2 * i)] = 0.25 * CORNER[i][0] * (1 + CORNER[i][1] * eta);
    dN[stride * (2 * i + 1)] = 0.25 * CORNER[i][1] * (1 + CORNER[i][0] * xi);
  }
}

/* First derivatives dN[i][a] = dN_i/dxi_a. */
void ct_segment_gradient(ct_face_kind kind, const double xi[2], double dN[8][2]);

/* The tangents t_a = dy/dxi_a [length], eq:segment-tangents. */
void ct_segment_tangents(const ct_face *face, const double xi[2], double t1[3], double t2[3]);

/* The unit normal t_1 x t_2 / |t_1 x t_2|, eq:segment-normal. If the tangents are parallel, zero or
 * not finite there is none: then n is NaN and the call returns CT_ERROR_GEOMETRY. */
ct_status ct_segment_normal(const ct_face *face, const double xi[2], double n[3]);

/* The area element J = |t_1 x t_2| [length^2] of eq:segment-area. */
double ct_segment_area_element(const ct_face *face, const double xi[2]);

/* Reference coordinates (each -1, 0 or 1) of node 0 to 19, written to xi; NaN for a node that
 * the kind does not have. */
void ct_brick_reference(ct_brick_kind kind, int node, double xi[3]);

/* Nodes of one side as a face: side 0 to 5 is x_min, x_max, y_min, y_max, z_min, z_max (xi_1 =
 * -1, xi_1 = +1, xi_2 = -1, ...). They are in the order of ct_face_kind, counter-clockwise seen
 * from outside, so that the face normal points out of a brick that is not inverted. Opposite sides
 * have the same second axis and the first one flipped (eq:brick-sides): a mirrored brick has
 * mirrored faces. nodes entries beyond the node count of the face are -1. */
void ct_brick_face(ct_brick_kind kind, int side, int nodes[8]);

/* Rule for a face with points at its corners, at the middles of its edges and at its centre,
 * eq:quadrature-lobatto: 3 x 3 points of Lobatto on a quadrilateral, 7 points on a triangle, all
 * weights positive, exact for degree 3. CT_ERROR_ARGUMENT for an unknown kind or a null pointer. */
ct_status ct_rule_lobatto(ct_face_kind kind, ct_rule *rule);

/* Rule for the full integration of a brick: 2 x 2 x 2 for hex8, 3 x 3 x 3 for hex20. Errors as in
 * ct_rule_face. */
ct_status ct_rule_brick(ct_brick_kind kind, ct_rule *rule);

#endif
