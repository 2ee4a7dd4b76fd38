#ifndef CT_SRC_SHAPE_H
#define CT_SRC_SHAPE_H

#include "../base/lanes.h"

/* Shape functions of a quadrilateral of `per` (4 or 8) nodes, each `stride` numbers after the one
 * before; those beyond `per` are 0 (eq:segment-q4, eq:segment-q8). For a `per` that is known and
 * lanes side by side the compiler makes lanes of it. */
CT_INLINE void ct_shape_quadrilateral(int per, double xi, double eta, double *N, int stride)
{
  static const double CORNER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int i = 0; i < 4; i++) {
    // -- Corners of the quadrilaterals (eq:segment-q4, eq:segment-q8)
    double x = CORNER[i][0] * xi, y = CORNER[i][1] * eta, corner = 0.25 * ((1 + x) * (1 + y));
    N[stride * i] = per == 8 ? corner * ((x + y) - 1) : corner;
    // -- Mid-side that follows the corner: even ones run along ξ (eq:segment-q8)
    double r = i % 2 == 0 ? xi : eta, s = i % 2 == 0 ? CORNER[i][1] * eta : CORNER[i][0] * xi;
    N[stride * (4 + i)] = per == 8 ? 0.5 * (((1 - r) * (1 + r)) * (1 + s)) : 0.0;
  }
}

#endif
