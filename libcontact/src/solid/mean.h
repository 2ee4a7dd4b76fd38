#ifndef CT_SRC_SOLID_MEAN_H
#define CT_SRC_SOLID_MEAN_H

#include "modes.h"

/* Number of modes in the mean gradient: all but ξηζ (eq:mean-gradient-modes). */
enum { CT_MEAN_MODES = CT_XI_ETA_ZETA };

/* Σ_m b_m U_m over the modes of the mean gradient. */
static inline void ct_mean_sum(const ct_lanes b[CT_MEAN_MODES], const ct_lanes U[CT_MEAN_MODES],
                               ct_lanes *sum)
{
  *sum = ((b[CT_XI] * U[CT_XI] + b[CT_ETA] * U[CT_ETA]) + b[CT_ZETA] * U[CT_ZETA]) +
         ((b[CT_XI_ETA] * U[CT_XI_ETA] + b[CT_ETA_ZETA] * U[CT_ETA_ZETA]) +
          b[CT_ZETA_XI] * U[CT_ZETA_XI]);
}

/* b[j][m] = ∂V/∂X_jm of the volume V of a hex8 of any shape, from the modes X[j] of its coordinates
 * (eq:mean-gradient-modes). The mean of ∂u_i/∂x_j over the element is Σ_m b[j][m] U_im / V. */
static inline void ct_mean_gradient(ct_lanes X[3][CT_MODES], ct_lanes b[3][CT_MEAN_MODES],
                                    ct_lanes *V)
{
  // Along ξ, η, ζ in turn: the mode itself, the two modes that contain it, and the third.
  static const int along[3] = {CT_XI, CT_ETA, CT_ZETA},
                   with[3] = {CT_XI_ETA, CT_ETA_ZETA, CT_ZETA_XI};
  // -- ∂V/∂X from products of the modes of the other two coordinates
  for (int j = 0; j < 3; j++) {
    const ct_lanes *Y = X[(j + 1) % 3], *Z = X[(j + 2) % 3];
    for (int d = 0; d < 3; d++) {
      int p = along[(d + 1) % 3], q = along[(d + 2) % 3], pd = with[d], qd = with[(d + 2) % 3],
          pq = with[(d + 1) % 3];
      // (eq:mean-gradient-modes)
      b[j][along[d]] = (1.0 / 64.0) * ((Y[p] * Z[q] - Y[q] * Z[p]) +
                                       (1.0 / 3.0) * (Y[pd] * Z[qd] - Y[qd] * Z[pd]));
      b[j][pd] = (1.0 / 192.0) *
                 ((Y[p] * Z[pq] - Y[pq] * Z[p]) + (Y[qd] * Z[along[d]] - Y[along[d]] * Z[qd]));
    }
  }
  ct_mean_sum(b[0], X[0], V);
}

#endif
