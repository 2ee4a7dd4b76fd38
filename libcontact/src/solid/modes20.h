#ifndef CT_SRC_SOLID_MODES20_H
#define CT_SRC_SOLID_MODES20_H

#include "modes.h"

/* Modes of one component of a hex20 (eq:box20-modes): those of the corners, and for each axis d a
 * square along it, from CT_BEND + 4 d on: alone, times the coordinate along d + 1, along d + 2, and
 * along both. `ends` is the value of the square at ±1: 2/3 for ξ² - 1/3, 1 for ξ². */
enum { CT_BEND = CT_MODES, CT_MODES20 = CT_BEND + 12 };

/* The edges along axis d: two corners and the node between them, in the order (-,-), (+,-), (-,+),
 * (+,+) along d + 1, d + 2. */
static const int CT_EDGE20[3][4][3] = {{{0, 1, 8}, {3, 2, 10}, {4, 5, 12}, {7, 6, 14}},
                                       {{0, 3, 11}, {4, 7, 15}, {1, 2, 9}, {5, 6, 13}},
                                       {{0, 4, 16}, {1, 5, 17}, {3, 7, 19}, {2, 6, 18}}};

/* Modes that are square along an axis, from the second differences along its four edges. */
CT_INLINE void ct_bend_modes(const int edge[4][3], const ct_lanes u[20], ct_lanes U[4])
{
  ct_lanes bend[4];
  for (int e = 0; e < 4; e++)
    // (u₋ - u₀) + (u₊ - u₀) (eq:box20-amplitudes)
    bend[e] = (u[edge[e][0]] - u[edge[e][2]]) + (u[edge[e][1]] - u[edge[e][2]]);
  ct_square_modes(bend, &U[0], &U[1], &U[2], &U[3]);
}

/* Nodal values of one component to modes. */
CT_INLINE void ct_brick20_modes(double ends, const ct_lanes u[20], ct_lanes U[CT_MODES20])
{
  ct_brick_modes(u, U);
  ct_bend_modes(CT_EDGE20[0], u, &U[CT_BEND]);
  ct_bend_modes(CT_EDGE20[1], u, &U[CT_BEND + 4]);
  ct_bend_modes(CT_EDGE20[2], u, &U[CT_BEND + 8]);
  // -- Subtract the modes with a square at the corners (eq:box20-amplitudes)
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, f = (d + 2) % 3;
    U[CT_XI + d] = U[CT_XI + d] - ends * (U[CT_BEND + 4 * e + 2] + U[CT_BEND + 4 * f + 1]);
    U[CT_XI_ETA + d] = U[CT_XI_ETA + d] - ends * U[CT_BEND + 4 * f + 3];
  }
}

/* Subtract the forces F of the second differences at the ends of the four edges along an axis; the
 * nodes between get them twice. */
CT_INLINE void ct_bend_nodal(const int edge[4][3], const ct_lanes F[4], ct_lanes f[20],
                             ct_lanes corner[8])
{
  ct_lanes low = F[0] - F[2], high = F[0] + F[2], slope_low = F[1] - F[3], slope_high = F[1] + F[3];
  ct_lanes bend[4] = {low - slope_low, low + slope_low, high - slope_high, high + slope_high};
  for (int e = 0; e < 4; e++) {
    f[edge[e][2]] = 2.0 * bend[e];
    corner[edge[e][0]] = bend[e];
    corner[edge[e][1]] = bend[e];
  }
}

/* Nodal forces with the work of the modal forces F, which are overwritten: the transpose of
 * ct_brick20_modes, with a minus. */
CT_INLINE void ct_brick20_nodal(double ends, ct_lanes F[CT_MODES20], ct_lanes f[20])
{
  ct_lanes x[8], y[8], z[8];
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, g = (d + 2) % 3;
    ct_lanes share = ends * F[CT_XI + d];
    F[CT_BEND + 4 * e + 2] = F[CT_BEND + 4 * e + 2] - share;
    F[CT_BEND + 4 * g + 1] = F[CT_BEND + 4 * g + 1] - share;
    F[CT_BEND + 4 * g + 3] = F[CT_BEND + 4 * g + 3] - ends * F[CT_XI_ETA + d];
  }
  ct_brick_nodal(F, f);
  ct_bend_nodal(CT_EDGE20[0], &F[CT_BEND], f, x);
  ct_bend_nodal(CT_EDGE20[1], &F[CT_BEND + 4], f, y);
  ct_bend_nodal(CT_EDGE20[2], &F[CT_BEND + 8], f, z);
  for (int a = 0; a < 8; a++) f[a] = f[a] - ((x[a] + y[a]) + z[a]);
}

#endif
