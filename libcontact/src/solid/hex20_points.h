#ifndef CT_SRC_SOLID_HEX20_POINTS_H
#define CT_SRC_SOLID_HEX20_POINTS_H

#include "../base/lanes.h"

/* The 3 x 3 x 3 Gauss points of hex20, ξ fastest: gradients at one of them, and the force of all on
 * a node. */

/* Sum over the 20 nodes, paired along ξ, η, ζ (eq:tree-sum). */
static inline void tree_nodes(const ct_lanes t[20], ct_lanes *sum)
{
  ct_lanes corners = ((t[0] + t[1]) + (t[3] + t[2])) + ((t[4] + t[5]) + (t[7] + t[6]));
  ct_lanes along_xi = (t[8] + t[10]) + (t[12] + t[14]);
  ct_lanes along_eta = (t[11] + t[9]) + (t[15] + t[13]);
  ct_lanes along_zeta = (t[16] + t[17]) + (t[19] + t[18]);
  *sum = ((corners + along_xi) + along_eta) + along_zeta;
}

/* Take away the mean of the corners, so that a common translation gives exactly zero. */
static inline void centre(ct_lanes v[20])
{
  ct_lanes mean = 0.125 * (((v[0] + v[1]) + (v[3] + v[2])) + ((v[4] + v[5]) + (v[7] + v[6])));
  for (int a = 0; a < 20; a++) v[a] = v[a] - mean;
}

static inline void reference_gradient(double dN[20][3], const ct_lanes v[60], ct_lanes G[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      ct_lanes t[20];
      for (int a = 0; a < 20; a++) t[a] = dN[a][j] * v[20 * i + a];
      tree_nodes(t, &G[i][j]);
    }
}

/* Force of the 27 points on component i of node a; the weights of the rule are products of 5/9,
 * 8/9, 5/9. */
static inline void nodal_force(ct_lanes P[27][3][3], double (*gradients)[20][3], int a, int i,
                               ct_lanes *f)
{
  static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  ct_lanes plane[3], line[3], t[3];
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 3; j++) {
      for (int l = 0; l < 3; l++) {
        int q = l + 3 * (j + 3 * k);
        double *d = gradients[q][a], w = (weight[l] * weight[j]) * weight[k];
        t[l] = w * ((d[0] * P[q][i][0] + d[1] * P[q][i][1]) + d[2] * P[q][i][2]);
      }
      line[j] = (t[0] + t[2]) + t[1];
    }
    plane[k] = (line[0] + line[2]) + line[1];
  }
  *f = -((plane[0] + plane[2]) + plane[1]);
}

#endif
