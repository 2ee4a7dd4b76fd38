/* The kernel for rectangular hex20 elements of one size: all integrals over the element in closed
 * form. */
#include "../base/memory.h"
#include "kernel.h"
#include "modes20.h"

/* The modes are Legendre's, ξ² - 1/3 for the squares (eq:box20-modes). */
static const double ENDS = 2.0 / 3.0;

/* Kinds of terms that couple two components (eq:box20-couplings): constant, linear or square along
 * the third axis, linear along one of their own two, along one and the third, along both, along all
 * three. */
enum { FLAT, THIRD, THIRD2, ONE, ONE_THIRD, BOTH, ALL, TERMS };

/* Data shared by all elements of one shape and material: the stiffness of each mode of each
 * component with itself, and of the two components other than axis d with each other, for Λ and for
 * μ. */
struct ct_box20 {
  double own[3][CT_MODES20], lambda[3][TERMS], mu[3][TERMS];
};

typedef struct ct_box20 box20;

/* Mean squares of 1, ξ, ξ² - 1/3 and of their derivatives, and the mean of a derivative times the
 * function of one degree less (eq:box20-moments). */
static const double SQUARE[3] = {1.0, 1.0 / 3.0, 4.0 / 45.0}, SLOPE[3] = {0.0, 1.0, 4.0 / 3.0},
                    MIXED[2] = {1.0, 2.0 / 3.0};

/* Stiffness of a mode with itself, by its degrees along the axes; G[d] is the modulus of the
 * gradient along d, with its factors. */
static double own_stiffness(const int degree[3], const double G[3])
{
  double sum[3];
  for (int d = 0; d < 3; d++) {
    int p = degree[d], q = degree[(d + 1) % 3], r = degree[(d + 2) % 3];
    // G c² d_p n_q n_r (eq:box20-own)
    sum[d] = G[d] * (SLOPE[p] * (SQUARE[q] * SQUARE[r]));
  }
  return (sum[0] + sum[1]) + sum[2];
}

ct_status ct_box20_prepare(ct_solid_part *part)
{
  box20 *B = part->box20 = ct_allocate(1, sizeof *B);
  if (B == NULL) return CT_ERROR_MEMORY;
  double volume = part->edge[0] * part->edge[1] * part->edge[2], c[3];
  for (int d = 0; d < 3; d++) c[d] = 0.25 / part->edge[d];
  // -- Degrees of the modes along each axis (eq:box20-modes)
  int degree[CT_MODES20][3] = {{0}};
  for (int d = 0; d < 3; d++) {
    int e = (d + 1) % 3, f = (d + 2) % 3;
    degree[CT_XI + d][d] = degree[CT_XI_ETA + d][d] = degree[CT_XI_ETA + d][e] =
        degree[CT_XI_ETA_ZETA][d] = 1;
    for (int m = 0; m < 4; m++) {
      degree[CT_BEND + 4 * d + m][d] = 2;
      degree[CT_BEND + 4 * d + m][e] = m % 2;
      degree[CT_BEND + 4 * d + m][f] = m / 2;
    }
  }
  // -- Each mode with itself
  for (int i = 0; i < 3; i++) {
    double G[3];
    for (int d = 0; d < 3; d++)
      G[d] = (d == i ? part->lambda + 2.0 * part->mu : part->mu) * (volume * (c[d] * c[d]));
    for (int m = 0; m < CT_MODES20; m++) B->own[i][m] = own_stiffness(degree[m], G);
  }
  // -- Two components, by the degrees of their term along the three axes
  for (int t = 0; t < TERMS; t++) {
    static const int met[TERMS][3] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 1, 0},
                                      {0, 1, 1}, {1, 1, 0}, {1, 1, 1}};
    double mean = (MIXED[met[t][0]] * MIXED[met[t][1]]) * SQUARE[met[t][2]];
    for (int d = 0; d < 3; d++) {
      // V c_i c_j m m n (eq:box20-couplings)
      double both = (volume * (c[(d + 1) % 3] * c[(d + 2) % 3])) * mean;
      B->lambda[d][t] = part->lambda * both;
      B->mu[d][t] = part->mu * both;
    }
  }
  return CT_OK;
}

/* Modal forces of component i. A mode is coupled to itself and, of each other component, to at most
 * the two modes that are one degree lower along one of the two axes and one higher along the other.
 * Here x is axis i, and u, v, w are the components along x, y, z. */
CT_INLINE void modal_forces(const box20 *B, int i, ct_lanes U[3][CT_MODES20],
                            ct_lanes F[CT_MODES20])
{
  const int j = (i + 1) % 3, k = (i + 2) % 3, x = i, y = j, z = k;
  const int xy = CT_XI_ETA + i, yz = CT_XI_ETA + j, zx = CT_XI_ETA + k, xyz = CT_XI_ETA_ZETA;
  const int xx = CT_BEND + 4 * i, xxy = xx + 1, xxz = xx + 2, xxyz = xx + 3;
  const int yy = CT_BEND + 4 * j, yyz = yy + 1, yyx = yy + 2, yyzx = yy + 3;
  const int zz = CT_BEND + 4 * k, zzx = zz + 1, zzy = zz + 2, zzxy = zz + 3;
  const ct_lanes *u = U[i], *v = U[j], *w = U[k];
  const double *K = B->own[i], *Lv = B->lambda[k], *Lw = B->lambda[j], *Mv = B->mu[k],
               *Mw = B->mu[j];
  // -- K U + Λ C U + μ C U (eq:box20-force)
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
      ct_lanes u[3 * 20], U[3][CT_MODES20], F[3][CT_MODES20];
      ct_load_lanes(part->mesh, part->rows, b, 20, displacement, lane, u);
      // Unrolled by hand, so that the compiler keeps the values in registers.
      ct_brick20_modes(ENDS, &u[0], U[0]);
      ct_brick20_modes(ENDS, &u[20], U[1]);
      ct_brick20_modes(ENDS, &u[40], U[2]);
      modal_forces(part->box20, 0, U, F[0]);
      modal_forces(part->box20, 1, U, F[1]);
      modal_forces(part->box20, 2, U, F[2]);
      ct_brick20_nodal(ENDS, F[0], &u[0]);
      ct_brick20_nodal(ENDS, F[1], &u[20]);
      ct_brick20_nodal(ENDS, F[2], &u[40]);
      for (int i = 0; i < 3; i++)
        ct_store_lanes(&u[20 * i], 20, i, lane, 8, &values[480 * (int64_t)b]);
    }
}
