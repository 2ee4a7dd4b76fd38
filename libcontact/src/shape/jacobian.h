#ifndef CT_SRC_JACOBIAN_H
#define CT_SRC_JACOBIAN_H

#include "../base/tree.h"

/* J[i][j] = Σ_a x_i,a ∂N_a/∂ξ_j over the 8 or 20 nodes of a brick: the Jacobian of the map when `x`
 * are coordinates, the displacement gradient in the reference directions when `x` are
 * displacements. */
static inline void ct_reference_gradient(int count, double (*dN)[3], double (*x)[3], double J[3][3])
{
  for (int i = 0; i < 3; i++) {
    double t[20];
    for (int a = 0; a < 8; a++) t[a] = x[a][i];
    double middle = ct_tree_corners(t, 1) / 8.0; // Σ ∂N_a = 0: a common translation cancels exactly
    for (int j = 0; j < 3; j++) {
      // Σ_a x_i ∂N_a/∂ξ_j (eq:jacobian)
      for (int a = 0; a < count; a++) t[a] = dN[a][j] * (x[a][i] - middle);
      J[i][j] = ct_tree_nodes(count, t, 1);
    }
  }
}

/* Cofactors C[i][j] of J, so that J⁻¹ = Cᵀ / det J; returns det J. */
static inline double ct_cofactors(double J[3][3], double C[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
      C[i][j] = J[p][r] * J[q][s] - J[p][s] * J[q][r];
    }
  return (J[0][0] * C[0][0] + J[0][1] * C[0][1]) + J[0][2] * C[0][2];
}

#endif
