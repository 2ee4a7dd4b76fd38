#ifndef CT_SRC_SOLID_HEX8_POINTS_H
#define CT_SRC_SOLID_HEX8_POINTS_H

#include "modes.h"

/* The 2 x 2 x 2 Gauss points of hex8, ξ fastest: gradients at all of them, and the way back to the
 * nodes. */

/* Values of a gradient on the four lines of Gauss points along one direction: the factor g = 1/√3
 * of the Gauss points belongs to each sign, and N = 1/8 Σ modes. Line k has the signs (k & 1, k >>
 * 1) of the two other directions. */
static inline void line_values(const ct_lanes *one, const ct_lanes *p, const ct_lanes *q,
                               const ct_lanes *pq, ct_lanes v[4])
{
  const double g = 0.57735026918962576451;
  for (int k = 0; k < 4; k++) {
    double sp = k & 1 ? g : -g, sq = k >> 1 ? g : -g;
    v[k] = 0.125 * ((*one + sp * *p) + (sq * *q + (sp * sq) * *pq));
  }
}

/* ∂/∂ξ, ∂/∂η, ∂/∂ζ of one component on the lines of Gauss points. */
static inline void line_gradients(const ct_lanes U[CT_MODES], ct_lanes G[3][4])
{
  line_values(&U[CT_XI], &U[CT_XI_ETA], &U[CT_ZETA_XI], &U[CT_XI_ETA_ZETA], G[0]);
  line_values(&U[CT_ETA], &U[CT_XI_ETA], &U[CT_ETA_ZETA], &U[CT_XI_ETA_ZETA], G[1]);
  line_values(&U[CT_ZETA], &U[CT_ZETA_XI], &U[CT_ETA_ZETA], &U[CT_XI_ETA_ZETA], G[2]);
}

/* Modal forces of one component from P at the eight points: the transpose of `line_gradients`. */
static inline void collect_modes(ct_lanes P[8][3][3], int i, ct_lanes F[CT_MODES])
{
  static const int pair[3][4][2] = {{{0, 1}, {2, 3}, {4, 5}, {6, 7}},
                                    {{0, 2}, {1, 3}, {4, 6}, {5, 7}},
                                    {{0, 4}, {1, 5}, {2, 6}, {3, 7}}};
  const double g = 0.57735026918962576451;
  ct_lanes sum[3], p[3], q[3], pq[3];
  for (int j = 0; j < 3; j++) {
    ct_lanes t[4];
    for (int k = 0; k < 4; k++) t[k] = P[pair[j][k][0]][i][j] + P[pair[j][k][1]][i][j];
    ct_square_modes(t, &sum[j], &p[j], &q[j], &pq[j]);
  }
  F[CT_XI] = 0.125 * sum[0];
  F[CT_ETA] = 0.125 * sum[1];
  F[CT_ZETA] = 0.125 * sum[2];
  F[CT_XI_ETA] = (0.125 * g) * (p[0] + p[1]);
  F[CT_ZETA_XI] = (0.125 * g) * (q[0] + p[2]);
  F[CT_ETA_ZETA] = (0.125 * g) * (q[1] + q[2]);
  F[CT_XI_ETA_ZETA] = (0.125 * g * g) * ((pq[0] + pq[1]) + pq[2]);
}

#endif
