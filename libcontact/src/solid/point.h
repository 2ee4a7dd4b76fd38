#ifndef CT_SRC_SOLID_POINT_H
#define CT_SRC_SOLID_POINT_H

#include "large.h"

#include "../base/lanes.h"

/* One Gauss point of 8 elements. `element.c` and `large.c` have the same formulas in readable form.
 */

/* Cofactors and determinant of A. */
CT_INLINE void ct_lanes_cofactors(ct_lanes A[3][3], ct_lanes C[3][3], ct_lanes *det)
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, t = (j + 2) % 3;
      C[i][j] = A[p][r] * A[q][t] - A[p][t] * A[q][r];
    }
  *det = (A[0][0] * C[0][0] + A[0][1] * C[0][1]) + A[0][2] * C[0][2];
}

/* The stress of one Gauss point conjugate to the reference gradients, P[i][j] = det J σ_ik
 * ∂ξ_j/∂x_k, from the reference gradients J of the coordinates and H of the displacements. */
CT_INLINE void ct_point_stress(ct_lanes J[3][3], ct_lanes H[3][3], const ct_lanes *lambda,
                               const ct_lanes *mu, ct_lanes P[3][3])
{
  ct_lanes C[3][3], D[3][3], s[3][3], det;
  ct_lanes_cofactors(J, C, &det);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      D[i][j] = (H[i][0] * C[j][0] + H[i][1] * C[j][1]) + H[i][2] * C[j][2];
  ct_lanes scale = *mu / det, trace = (*lambda / det) * ((D[0][0] + D[1][1]) + D[2][2]);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j <= i; j++) {
      s[i][j] = scale * (D[i][j] + D[j][i]);
      if (i == j) s[i][i] = s[i][i] + trace;
      s[j][i] = s[i][j];
    }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      // Σ_k σ_ik C_kj (eq:reference-stress)
      P[i][j] = (s[i][0] * C[0][j] + s[i][1] * C[1][j]) + s[i][2] * C[2][j];
}

/* Displacement gradient G = ∂u/∂X from the reference gradients J of the coordinates, with their
 * cofactors C, and H of the displacements. */
CT_INLINE void ct_large_gradient(ct_lanes J[3][3], ct_lanes H[3][3], ct_lanes C[3][3],
                                 ct_lanes *det, ct_lanes G[3][3])
{
  ct_lanes_cofactors(J, C, det);
  ct_lanes inverse = 1.0 / *det;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      G[i][j] = inverse * ((H[i][0] * C[j][0] + H[i][1] * C[j][1]) + H[i][2] * C[j][2]);
}

/* B = FᵀF - 1 as xx yy zz xy yz zx (eq:green-lagrange). */
CT_INLINE void ct_large_strain(ct_lanes G[3][3], ct_lanes B[6])
{
  for (int k = 0; k < 6; k++) {
    int i = k % 3, j = k < 3 ? i : (i + 1) % 3;
    B[k] = (G[i][j] + G[j][i]) + ((G[0][i] * G[0][j] + G[1][i] * G[1][j]) + G[2][i] * G[2][j]);
  }
}

/* Cofactors of B in the same order, and the invariants tr B, sum of principal minors, det B. */
CT_INLINE void ct_large_invariants(const ct_lanes B[6], ct_lanes A[6], ct_lanes I[3])
{
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3, xy = 3 + k, yz = 3 + i,
        zx = 3 + j; // the shear of k with i, of i with j, of j with k
    A[k] = B[i] * B[j] - B[yz] * B[yz];
    A[xy] = B[yz] * B[zx] - B[xy] * B[j];
  }
  I[0] = (B[0] + B[1]) + B[2];
  I[1] = (A[0] + A[1]) + A[2];
  I[2] = (B[0] * A[0] + B[3] * A[3]) + B[5] * A[5];
}

/* Second Piola-Kirchhoff stress from B and the change of volume J - 1 (eq:st-venant-kirchhoff,
 * eq:neo-hookean-stress). The compiler warns of a law without a case. */
CT_INLINE void ct_large_law(ct_law law, const ct_lanes B[6], const ct_lanes *change,
                            const ct_lanes *lambda, const ct_lanes *mu, ct_lanes S[6])
{
  ct_lanes A[6], I[3], trace;
  switch (law) {
  case CT_ST_VENANT_KIRCHHOFF:
    trace = (0.5 * *lambda) * ((B[0] + B[1]) + B[2]);
    for (int k = 0; k < 6; k++) S[k] = k < 3 ? *mu * B[k] + trace : *mu * B[k];
    return;
  case CT_NEO_HOOKEAN:
  case CT_LINEAR: // has no such kernel
  case CT_LAW_COUNT:
    break;
  }
  ct_large_invariants(B, A, I);
  ct_lanes inverse = 1.0 / (1.0 + *change), p = (*mu * inverse) * inverse,
           q = (*lambda * *change) * inverse;
  ct_lanes diagonal = p * (I[1] + I[2]) + q * (1.0 + I[0]), rest = p - q;
  for (int k = 0; k < 6; k++) S[k] = k < 3 ? rest * (B[k] - A[k]) + diagonal : rest * (B[k] - A[k]);
}

/* The stress conjugate to the reference gradients, P = F S C, and det F
 * (eq:large-reference-stress). */
CT_INLINE void ct_large_point(ct_law law, ct_lanes J[3][3], ct_lanes H[3][3],
                              const ct_lanes *lambda, const ct_lanes *mu, ct_lanes P[3][3],
                              ct_lanes *volume)
{
  static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  ct_lanes C[3][3], G[3][3], minor[3][3], B[6], S[6], T[3], det, three;
  ct_large_gradient(J, H, C, &det, G);
  ct_large_strain(G, B);
  ct_lanes_cofactors(G, minor, &three);
  ct_lanes two = (minor[0][0] + minor[1][1]) + minor[2][2];
  ct_lanes change = ((G[0][0] + G[1][1]) + G[2][2]) + (two + three);
  ct_large_law(law, B, &change, lambda, mu, S);
  for (int i = 0; i < 3; i++) {
    // (eq:large-reference-stress)
    for (int j = 0; j < 3; j++)
      T[j] =
          S[at[i][j]] + ((G[i][0] * S[at[0][j]] + G[i][1] * S[at[1][j]]) + G[i][2] * S[at[2][j]]);
    for (int j = 0; j < 3; j++) P[i][j] = (T[0] * C[0][j] + T[1] * C[1][j]) + T[2] * C[2][j];
  }
  *volume = 1.0 + change;
}

/* Stored energy of one point times det J, for its weight (eq:large-energy). */
CT_INLINE void ct_large_point_energy(ct_law law, ct_lanes J[3][3], ct_lanes H[3][3],
                                     const ct_lanes *lambda, const ct_lanes *mu, ct_lanes *energy)
{
  ct_lanes C[3][3], G[3][3], B[6], A[6], I[3], det, trace, normal, shear;
  ct_large_gradient(J, H, C, &det, G);
  ct_large_strain(G, B);
  switch (law) {
  case CT_ST_VENANT_KIRCHHOFF:
    trace = (B[0] + B[1]) + B[2], normal = (B[0] * B[0] + B[1] * B[1]) + B[2] * B[2];
    shear = (B[3] * B[3] + B[4] * B[4]) + B[5] * B[5];
    *energy = det * ((0.125 * *lambda) * (trace * trace) + (0.25 * *mu) * (normal + 2.0 * shear));
    return;
  case CT_NEO_HOOKEAN:
  case CT_LINEAR: // has no such kernel
  case CT_LAW_COUNT:
    break;
  }
  ct_large_invariants(B, A, I);
  ct_lanes t = I[0] + (I[1] + I[2]), volume;
  for (int l = 0; l < CT_LANES_COUNT; l++)
    ((double *)&volume)[l] = ct_large_volume_energy(
        ((const double *)lambda)[l], ((const double *)mu)[l], ((const double *)&t)[l]);
  *energy = det * (volume - (0.5 * *mu) * (I[1] + I[2]));
}

/* Smallest of the given values, one lane after another; NaN stays. */
CT_INLINE void ct_lanes_lowest(const ct_lanes *value, double *lowest)
{
  const double *v = (const double *)value;
  for (int l = 0; l < CT_LANES_COUNT; l++)
    if (!(v[l] >= *lowest)) *lowest = v[l];
}

#endif
