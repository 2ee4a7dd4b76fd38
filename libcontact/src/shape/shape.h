#ifndef CT_SRC_SHAPE_H
#define CT_SRC_SHAPE_H

#include "../base/lanes.h"

#include <libcontact/shape.h>

static const double CT_SHAPE_CORNER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/* Shape function of corner i of a quadrilateral with `per` (4 or 8) nodes. */
CT_INLINE double ct_shape_corner(int per, int i, double xi, double eta)
{
  double x = CT_SHAPE_CORNER[i][0] * xi, y = CT_SHAPE_CORNER[i][1] * eta;
  double four = 0.25 * ((1 + x) * (1 + y)); // (eq:segment-q4)
  if (per == 4) return four;
  return four * ((x + y) - 1); // (eq:segment-q8)
}

/* Shape function of the mid-side that follows corner i: even ones run along ξ. */
CT_INLINE double ct_shape_middle(int i, double xi, double eta)
{
  double along = i % 2 == 0 ? xi : eta;
  double across = i % 2 == 0 ? CT_SHAPE_CORNER[i][1] * eta : CT_SHAPE_CORNER[i][0] * xi;
  return 0.5 * (((1 - along) * (1 + along)) * (1 + across)); // (eq:segment-q8)
}

/* All of them, each `stride` behind the last. For a known `per` and lanes side by side the compiler
 * vectorises this. */
CT_INLINE void ct_shape_quadrilateral(int per, double xi, double eta, double *N, int stride)
{
  for (int i = 0; i < 4; i++) {
    N[stride * i] = ct_shape_corner(per, i, xi, eta);
    if (per == 8) N[stride * (4 + i)] = ct_shape_middle(i, xi, eta);
  }
}

/* First derivatives of a quadrilateral with four nodes at one place; a number of them is `stride`
 * behind the last. */
static inline void ct_shape_gradient_q4(double xi, double eta, double *dN, int stride)
{
  for (int i = 0; i < 4; i++) {
    const double *corner = CT_SHAPE_CORNER[i];
    dN[stride * (2 * i)] = 0.25 * corner[0] * (1 + corner[1] * eta);
    dN[stride * (2 * i + 1)] = 0.25 * corner[1] * (1 + corner[0] * xi);
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
