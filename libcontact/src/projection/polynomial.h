#ifndef CT_SRC_POLYNOMIAL_H
#define CT_SRC_POLYNOMIAL_H

#include "projection_internal.h"

#include "../base/vector.h"

/* The polynomial of a face and its derivatives, in a form to be built into the functions that need
 * them often. The loops run over three coordinates and a zero, so that they fill vectors. */

/* d at xi, with a zero that fills the vector; answers f = d.d. */
static inline double ct_polynomial_value(const ct_patch *patch, const double xi[2], double d[4])
{
  const double (*c)[4] = patch->c;
  double x = xi[0], y = xi[1], xx = x * x, yy = y * y, xy = x * y;
  for (int k = 0; k < 4; k++) {
    // -- Point of the patch (eq:projection-patch)
    double a = c[4][k] + c[6][k] * y, b = c[5][k] + c[7][k] * x;
    d[k] = ((c[0][k] + c[3][k] * xy) + (c[1][k] * x + c[2][k] * y)) + (a * xx + b * yy);
  }
  return ct_vector_dot(d, d);
}

/* Tangents at xi, likewise. */
static inline void ct_polynomial_tangents(const ct_patch *patch, const double xi[2], double t1[4],
                                          double t2[4])
{
  const double (*c)[4] = patch->c;
  double x = xi[0], y = xi[1], xx = x * x, yy = y * y, two_x = 2 * x, two_y = 2 * y;
  for (int k = 0; k < 4; k++) {
    // -- Tangents of the patch (eq:projection-patch-derivatives)
    double a = c[4][k] + c[6][k] * y, b = c[5][k] + c[7][k] * x;
    t1[k] = (c[1][k] + c[3][k] * y) + (a * two_x + c[7][k] * yy);
    t2[k] = (c[2][k] + c[3][k] * x) + (b * two_y + c[6][k] * xx);
  }
}

/* f and its derivatives at at->xi, all in one. */
static inline void ct_polynomial_look(const ct_patch *patch, ct_iterate *at)
{
  const double (*c)[4] = patch->c;
  double x = at->xi[0], y = at->xi[1], xx = x * x, yy = y * y, xy = x * y, two_x = 2 * x,
         two_y = 2 * y;
  double d[4], t1[4], t2[4], a[4], b[4], t12[4];
  for (int k = 0; k < 4; k++) {
    // -- Point, tangents, second derivatives 2 a, 2 b, t12 (eq:projection-patch,
    // eq:projection-patch-derivatives)
    a[k] = c[4][k] + c[6][k] * y, b[k] = c[5][k] + c[7][k] * x;
    d[k] = ((c[0][k] + c[3][k] * xy) + (c[1][k] * x + c[2][k] * y)) + (a[k] * xx + b[k] * yy);
    t1[k] = (c[1][k] + c[3][k] * y) + (a[k] * two_x + c[7][k] * yy);
    t2[k] = (c[2][k] + c[3][k] * x) + (b[k] * two_y + c[6][k] * xx);
    t12[k] = c[3][k] + (c[6][k] * two_x + c[7][k] * two_y);
  }
  for (int k = 0; k < 3; k++) at->d[k] = d[k];
  at->f = ct_vector_dot(d, d);
  // -- Gradient (eq:projection-gradient)
  at->g[0] = 2 * ct_vector_dot(d, t1);
  at->g[1] = 2 * ct_vector_dot(d, t2);
  // -- Hessian (eq:projection-hessian)
  at->square[0] = ct_vector_dot(t1, t1);
  at->square[1] = ct_vector_dot(t2, t2);
  at->square[2] = ct_vector_dot(t1, t2);
  at->H[0] = 2 * (at->square[0] + 2 * ct_vector_dot(d, a));
  at->H[1] = 2 * (at->square[1] + 2 * ct_vector_dot(d, b));
  at->H[2] = 2 * (at->square[2] + ct_vector_dot(d, t12));
}

#endif
