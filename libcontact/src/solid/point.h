#ifndef CT_SRC_SOLID_POINT_H
#define CT_SRC_SOLID_POINT_H

#include "../base/lanes.h"

/* The stress of one Gauss point as it works on the reference gradients, P[i][j] = det J σ_ik
 * ∂ξ_j/∂x_k, from the reference gradients J of the coordinates and H of the displacements
 * (eq:reference-stress). */
static inline void ct_point_stress(ct_lanes J[3][3], ct_lanes H[3][3], double lambda, double mu,
                                   ct_lanes P[3][3])
{
  ct_lanes C[3][3], D[3][3], s[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, t = (j + 2) % 3;
      C[i][j] = J[p][r] * J[q][t] - J[p][t] * J[q][r];
    }
  ct_lanes det = (J[0][0] * C[0][0] + J[0][1] * C[0][1]) + J[0][2] * C[0][2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      D[i][j] = (H[i][0] * C[j][0] + H[i][1] * C[j][1]) + H[i][2] * C[j][2];
  ct_lanes scale = mu / det, trace = (lambda / det) * ((D[0][0] + D[1][1]) + D[2][2]);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j <= i; j++) {
      s[i][j] = scale * (D[i][j] + D[j][i]);
      if (i == j) s[i][i] = s[i][i] + trace;
      s[j][i] = s[i][j];
    }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      P[i][j] = (s[i][0] * C[0][j] + s[i][1] * C[1][j]) + s[i][2] * C[2][j];
}

#endif
