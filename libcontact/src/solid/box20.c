/* The kernel for rectangular hex20 elements of one size: every integral over the element in closed
 * form. */
#include "../base/memory.h"
#include "kernel.h"
#include "modes.h"

/* Modes of one component (eq:box20-modes): those of the corners, and for each axis d a square along
 * it, from BEND + 4 d on: alone, times the coordinate along d + 1, along d + 2, and along both. */
enum { BEND = CT_MODES, MODES = BEND + 12 };

/* Kinds of terms in which two components meet (eq:box20-couplings): constant, linear or square
 * along the third axis, linear along one of their own two, along one and the third, along both,
 * along all three. */
enum { FLAT, THIRD, THIRD2, ONE, ONE_THIRD, BOTH, ALL, TERMS };

/* What all elements of one shape and material share: the stiffness of each mode of each component
 * with itself, and of the two components beside axis d with each other, for Λ and for μ. */
struct ct_box20 {
  double own[3][MODES], lambda[3][TERMS], mu[3][TERMS];
};

typedef struct ct_box20 box20;

/* Mean squares of 1, ξ, ξ² - 1/3 and of their derivatives, and the mean of a derivative times the
 * function of one degree less (eq:box20-moments). */
static const double SQUARE[3] = {1.0, 1.0 / 3.0, 4.0 / 45.0}, SLOPE[3] = {0.0, 1.0, 4.0 / 3.0},
                    MIXED[2] = {1.0, 2.0 / 3.0};

/* Stiffness of a mode with itself, by its degrees along the axes; G[d] is what the gradient along d
 * is worth (eq:box20-own). */
static double own_stiffness(const int degree[3], const double G[3])
{
  double sum[3];
  for (int d = 0; d < 3; d++) {
    int p = degree[d], q = degree[(d + 1) % 3], r = degree[(d + 2) % 3];
    sum[d] = G[d] * (SLOPE[p] * (SQUARE[q] * SQUARE[r]));
  }
  return (sum[0] + sum[1]) + sum[2];
}

ct_status ct_box20_prepare(ct_solid_part *part)
{
  box20 *B = part->box20 = ct_allocate(1, sizeof *B);
  if (B == NULL) return CT_ERROR_MEMORY;
  double volume = part->edge[0] * part->edge[1] * part->edge[2], k[3];
  for (int d = 0; d < 3; d++) k[d] = 0.25 / part->edge[d];
  // -- Degrees of the modes along each axis (eq:box20-modes)
  int degree[MODES][3] = {{0}};
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, f = (d + 2) % 3;
    degree[CT_XI + d][d] = degree[CT_XI_ETA + d][d] = degree[CT_XI_ETA + d][e] =
        degree[CT_XI_ETA_ZETA][d] = 1;
    for (int m = 0; m < 4; m++) {
      degree[BEND + 4 * d + m][d] = 2;
      degree[BEND + 4 * d + m][e] = m % 2;
      degree[BEND + 4 * d + m][f] = m / 2;
    }
  }
  // -- Each mode with itself (eq:box20-own)
  for (int i = 0; i < 3; i++) {
    double G[3];
    for (int d = 0; d < 3; d++)
      G[d] = (d == i ? part->lambda + 2.0 * part->mu : part->mu) * (volume * (k[d] * k[d]));
    for (int m = 0; m < MODES; m++) B->own[i][m] = own_stiffness(degree[m], G);
  }
  // -- Two components, by the degrees of their term along the three axes (eq:box20-couplings)
  for (int t = 0; t < TERMS; t++) {
    static const int met[TERMS][3] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 1, 0},
                                      {0, 1, 1}, {1, 1, 0}, {1, 1, 1}};
    double mean = (MIXED[met[t][0]] * MIXED[met[t][1]]) * SQUARE[met[t][2]];
    for (int d = 0; d < 3; d++) {
      double both = (volume * (k[(d + 1) % 3] * k[(d + 2) % 3])) * mean;
      B->lambda[d][t] = part->lambda * both;
      B->mu[d][t] = part->mu * both;
    }
  }
  return CT_OK;
}

/* The edges along axis d: two corners and the node between them, in the order (-,-), (+,-), (-,+),
 * (+,+) along d + 1, d + 2. */
static const int EDGE[3][4][3] = {{{0, 1, 8}, {3, 2, 10}, {4, 5, 12}, {7, 6, 14}},
                                  {{0, 3, 11}, {4, 7, 15}, {1, 2, 9}, {5, 6, 13}},
                                  {{0, 4, 16}, {1, 5, 17}, {3, 7, 19}, {2, 6, 18}}};

/* Modes that are square along an axis, from the second differences along its four edges. */
CT_INLINE void bend_modes(const int edge[4][3], const ct_lanes u[20], ct_lanes U[4])
{
  ct_lanes bend[4];
  for (int e = 0; e < 4; e++)
    bend[e] = (u[edge[e][0]] - u[edge[e][2]]) + (u[edge[e][1]] - u[edge[e][2]]);
  ct_square_modes(bend, &U[0], &U[1], &U[2], &U[3]);
}

/* Nodal values of one component to modes (eq:box20-amplitudes). */
CT_INLINE void nodes_to_modes(const ct_lanes u[20], ct_lanes U[MODES])
{
  ct_brick_modes(u, U);
  bend_modes(EDGE[0], u, &U[BEND]);
  bend_modes(EDGE[1], u, &U[BEND + 4]);
  bend_modes(EDGE[2], u, &U[BEND + 8]);
  // -- At the corners the modes with a square are there, too: take them off (eq:box20-amplitudes)
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, f = (d + 2) % 3;
    U[CT_XI + d] = U[CT_XI + d] - (2.0 / 3.0) * (U[BEND + 4 * e + 2] + U[BEND + 4 * f + 1]);
    U[CT_XI_ETA + d] = U[CT_XI_ETA + d] - (2.0 / 3.0) * U[BEND + 4 * f + 3];
  }
}

/* Take the forces F of the second differences off the ends of the four edges along an axis; the
 * nodes between get them twice. */
CT_INLINE void bend_nodal(const int edge[4][3], const ct_lanes F[4], ct_lanes f[20],
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

/* Nodal forces that do the work of the modal forces F, which are lost: the transpose of
 * nodes_to_modes, with a minus. */
CT_INLINE void modes_to_nodes(ct_lanes F[MODES], ct_lanes f[20])
{
  ct_lanes x[8], y[8], z[8];
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, g = (d + 2) % 3;
    ct_lanes share = (2.0 / 3.0) * F[CT_XI + d];
    F[BEND + 4 * e + 2] = F[BEND + 4 * e + 2] - share;
    F[BEND + 4 * g + 1] = F[BEND + 4 * g + 1] - share;
    F[BEND + 4 * g + 3] = F[BEND + 4 * g + 3] - (2.0 / 3.0) * F[CT_XI_ETA + d];
  }
  ct_brick_nodal(F, f);
  bend_nodal(EDGE[0], &F[BEND], f, x);
  bend_nodal(EDGE[1], &F[BEND + 4], f, y);
  bend_nodal(EDGE[2], &F[BEND + 8], f, z);
  for (int a = 0; a < 8; a++) f[a] = f[a] - ((x[a] + y[a]) + z[a]);
}

/* Modal forces of component i. A mode feels itself and, of each other component, at most the two
 * modes that are one degree lower along one of the two axes and one higher along the other
 * (eq:box20-force). Here x is axis i, and u, v, w are the components along x, y, z. */
CT_INLINE void modal_forces(const box20 *B, int i, ct_lanes U[3][MODES], ct_lanes F[MODES])
{
  const int j = (i + 1) % 3, k = (i + 2) % 3, x = i, y = j, z = k;
  const int xy = CT_XI_ETA + i, yz = CT_XI_ETA + j, zx = CT_XI_ETA + k, xyz = CT_XI_ETA_ZETA;
  const int xx = BEND + 4 * i, xxy = xx + 1, xxz = xx + 2, xxyz = xx + 3;
  const int yy = BEND + 4 * j, yyz = yy + 1, yyx = yy + 2, yyzx = yy + 3;
  const int zz = BEND + 4 * k, zzx = zz + 1, zzy = zz + 2, zzxy = zz + 3;
  const ct_lanes *u = U[i], *v = U[j], *w = U[k];
  const double *K = B->own[i], *Lv = B->lambda[k], *Lw = B->lambda[j], *Mv = B->mu[k],
               *Mw = B->mu[j];
  F[x] = K[x] * u[x] + (Lv[FLAT] * v[y] + Lw[FLAT] * w[z]);
  F[y] = K[y] * u[y] + Mv[FLAT] * v[x];
  F[z] = K[z] * u[z] + Mw[FLAT] * w[x];
  F[xy] = (K[xy] * u[xy] + Lv[ONE] * v[yy]) + (Lw[THIRD] * w[yz] + Mv[ONE] * v[xx]);
  F[zx] = (K[zx] * u[zx] + Lw[ONE] * w[zz]) + (Lv[THIRD] * v[yz] + Mw[ONE] * w[xx]);
  F[yz] = K[yz] * u[yz] + (Mv[THIRD] * v[zx] + Mw[THIRD] * w[xy]);
  F[xyz] = K[xyz] * u[xyz] + ((Lv[ONE_THIRD] * v[yyz] + Mv[ONE_THIRD] * v[xxz]) +
                              (Lw[ONE_THIRD] * w[zzy] + Mw[ONE_THIRD] * w[xxy]));
  F[xx] = K[xx] * u[xx] + (Lv[ONE] * v[xy] + Lw[ONE] * w[zx]);
  F[xxy] = K[xxy] * u[xxy] + (Lv[BOTH] * v[yyx] + Lw[ONE_THIRD] * w[xyz]);
  F[xxz] = K[xxz] * u[xxz] + (Lv[ONE_THIRD] * v[xyz] + Lw[BOTH] * w[zzx]);
  F[xxyz] = K[xxyz] * u[xxyz] + (Lv[ALL] * v[yyzx] + Lw[ALL] * w[zzxy]);
  F[yy] = K[yy] * u[yy] + Mv[ONE] * v[xy];
  F[yyx] = K[yyx] * u[yyx] + (Mv[BOTH] * v[xxy] + Lw[THIRD2] * w[yyz]);
  F[yyz] = K[yyz] * u[yyz] + (Mv[ONE_THIRD] * v[xyz] + Mw[THIRD2] * w[yyx]);
  F[yyzx] = K[yyzx] * u[yyzx] + Mv[ALL] * v[xxyz];
  F[zz] = K[zz] * u[zz] + Mw[ONE] * w[zx];
  F[zzx] = K[zzx] * u[zzx] + (Mw[BOTH] * w[xxz] + Lv[THIRD2] * v[zzy]);
  F[zzy] = K[zzy] * u[zzy] + (Mw[ONE_THIRD] * w[xyz] + Mv[THIRD2] * v[zzx]);
  F[zzxy] = K[zzxy] * u[zzxy] + Mw[ALL] * w[xxyz];
}

CT_CLONES
void ct_solid_box20_batches(const ct_solid_part *part, int32_t first, int32_t last,
                            const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes u[3 * 20], U[3][MODES], F[3][MODES];
      ct_load_lanes(part->mesh, b, 20, displacement, lane, u);
      // Written out: the compiler keeps what it unrolls in registers.
      nodes_to_modes(&u[0], U[0]);
      nodes_to_modes(&u[20], U[1]);
      nodes_to_modes(&u[40], U[2]);
      modal_forces(part->box20, 0, U, F[0]);
      modal_forces(part->box20, 1, U, F[1]);
      modal_forces(part->box20, 2, U, F[2]);
      modes_to_nodes(F[0], &u[0]);
      modes_to_nodes(F[1], &u[20]);
      modes_to_nodes(F[2], &u[40]);
      ct_store_lanes(u, 20, lane, 8, &values[480 * (int64_t)b]);
    }
}
