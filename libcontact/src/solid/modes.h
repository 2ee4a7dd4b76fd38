#ifndef CT_SRC_SOLID_MODES_H
#define CT_SRC_SOLID_MODES_H

#include "../base/lanes.h"

/* The nodal values of a hex8 as amplitudes of ξ, η, ζ, ξη, ηζ, ζξ, ξηζ: U_m = Σ_a
 * m(ξ_a) u_a. Differences are taken first, so equal nodal values give exactly zero, and the sums
 * pair along ξ, η, ζ (eq:tree-sum). */
enum { CT_XI, CT_ETA, CT_ZETA, CT_XI_ETA, CT_ETA_ZETA, CT_ZETA_XI, CT_XI_ETA_ZETA, CT_MODES };

/* Position of corner a of a hex8 along an axis, -1 or 1. */
static inline double ct_corner_sign(int a, int axis)
{
  return (axis == 0 ? (a + 1) % 4 >= 2 : axis == 1 ? a % 4 >= 2 : a >= 4) ? 1.0 : -1.0;
}

/* Over a square of four values t(-,-), t(+,-), t(-,+), t(+,+): sum, and sums with the signs of the
 * first, second, both. */
static inline void ct_square_modes(const ct_lanes t[4], ct_lanes *sum, ct_lanes *first,
                                   ct_lanes *second, ct_lanes *both)
{
  ct_lanes low = t[0] + t[1], high = t[2] + t[3];
  ct_lanes slope_low = t[1] - t[0], slope_high = t[3] - t[2];
  *sum = low + high;
  *first = slope_low + slope_high;
  *second = high - low;
  *both = slope_high - slope_low;
}

static inline void ct_brick_modes(const ct_lanes u[8], ct_lanes U[CT_MODES])
{
  // Σ_a m(ξ_a) u_a, along ξ, η, ζ (eq:brick-modes)
  ct_lanes along_xi[4] = {u[1] - u[0], u[2] - u[3], u[5] - u[4], u[6] - u[7]};
  ct_lanes along_eta[4] = {u[3] - u[0], u[2] - u[1], u[7] - u[4], u[6] - u[5]};
  ct_lanes along_zeta[4] = {u[4] - u[0], u[5] - u[1], u[7] - u[3], u[6] - u[2]};
  ct_square_modes(along_xi, &U[CT_XI], &U[CT_XI_ETA], &U[CT_ZETA_XI], &U[CT_XI_ETA_ZETA]);
  ct_lanes low = along_eta[0] + along_eta[1], high = along_eta[2] + along_eta[3];
  U[CT_ETA] = low + high;
  U[CT_ETA_ZETA] = high - low;
  U[CT_ZETA] = (along_zeta[0] + along_zeta[1]) + (along_zeta[2] + along_zeta[3]);
}

/* Nodal forces with the work of the modal forces F: f_a = -Σ_m m(ξ_a) F_m. */
static inline void ct_brick_nodal(const ct_lanes F[CT_MODES], ct_lanes f[8])
{
  static const int corner[4][2] = {{0, 1}, {3, 2}, {4, 5}, {7, 6}};
  for (int k = 0; k < 4; k++) {
    double eta = k % 2 ? 1.0 : -1.0, zeta = k / 2 ? 1.0 : -1.0;
    ct_lanes even = (eta * F[CT_ETA] + zeta * F[CT_ZETA]) + (eta * zeta) * F[CT_ETA_ZETA];
    ct_lanes odd =
        (F[CT_XI] + eta * F[CT_XI_ETA]) + (zeta * F[CT_ZETA_XI] + (eta * zeta) * F[CT_XI_ETA_ZETA]);
    f[corner[k][0]] = odd - even;
    f[corner[k][1]] = -(even + odd);
  }
}

#endif
