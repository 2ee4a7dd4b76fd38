#ifndef CONTACT_QUADRATURE_H
#define CONTACT_QUADRATURE_H

#include <contact/brick.h>
#include <contact/segment.h>

CT_BEGIN_DECLS

/**
 * A quadrature rule on the reference face or brick, :eq:`quadrature-rule`. Points of quadrilaterals
 * and bricks run with xi_1 fastest, then xi_2, then xi_3, each ascending, so that point p and its
 * mirror image are easy to pair.
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
 * Gauss-Legendre rule with ``n`` = 1 to 10 points on [-1, 1], exact for polynomials of degree 2 n -
 * 1, :eq:`quadrature-gauss`. Writes the nodes, ascending and exactly antisymmetric, to ``x[n]`` and
 * the weights, exactly symmetric, to ``w[n]``. CT_ERROR_ARGUMENT for another ``n`` or a null
 * pointer.
 */
CT_API ct_status ct_gauss_legendre(int n, double *x, double *w);

/**
 * Rule for a face. ``points`` is the number of Gauss points along each direction of a quadrilateral
 * (1 to 5), or the number of all points of a triangle (1, 3, 6 or 7, exact for degree 1, 2, 4 and
 * 5); 0 takes what contact uses: 2 x 2 for Q4, 3 x 3 for Q8, 3 for T3, 6 for T6. CT_ERROR_ARGUMENT
 * for anything else or a null pointer, and then ``rule`` has no points.
 */
CT_API ct_status ct_rule_face(ct_face_kind kind, int points, ct_rule *rule);

/**
 * Rule for a face with points at its corners, at the middles of its edges and at its centre,
 * :eq:`quadrature-lobatto`: 3 x 3 points of Lobatto on a quadrilateral, 7 points on a triangle, all
 * weights positive, exact for degree 3. CT_ERROR_ARGUMENT for an unknown kind or a null pointer.
 */
CT_API ct_status ct_rule_lobatto(ct_face_kind kind, ct_rule *rule);

/** Rule for the full integration of a brick: 2 x 2 x 2 for hex8, 3 x 3 x 3 for hex20. Errors as in
 * ct_rule_face. */
CT_API ct_status ct_rule_brick(ct_brick_kind kind, ct_rule *rule);

CT_END_DECLS

#endif
