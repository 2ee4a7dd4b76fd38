/* The kernels for hex20 elements of any shape, 3 x 3 x 3 Gauss points, ξ fastest: forces for small
 * and for large deformation, with the smallest J = det F of each batch, and energies. */
#include "kernel.h"
#include "point.h"

/* Of the points on a line. */
static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};

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

CT_INLINE void load_nodes(const ct_solid_part *part, int32_t b, int lane,
                          const double *displacement, ct_lanes x[60], ct_lanes u[60])
{
  ct_load_lanes(part->mesh, b, 20, part->mesh->nodes, lane, x);
  ct_load_lanes(part->mesh, b, 20, displacement, lane, u);
  for (int i = 0; i < 3; i++) {
    centre(&x[20 * i]);
    centre(&u[20 * i]);
  }
}

/* Forces of one batch, and for large deformation its smallest J. */
CT_INLINE void batch_forces(const ct_solid_part *part, int32_t b, const double *displacement,
                            double *values, double *lowest, int large)
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    ct_lanes x[3 * 20], u[3 * 20], P[27][3][3], J[3][3], H[3][3], volume[27];
    load_nodes(part, b, lane, displacement, x, u);
    for (int q = 0; q < 27; q++) {
      reference_gradient(part->gradients[q], x, J);
      reference_gradient(part->gradients[q], u, H);
      if (large) ct_large_point(part->material.law, J, H, part->lambda, part->mu, P[q], &volume[q]);
      else ct_point_stress(J, H, part->lambda, part->mu, P[q]);
    }
    for (int i = 0; i < 3; i++)
      for (int a = 0; a < 20; a++) nodal_force(P, part->gradients, a, i, &u[20 * i + a]);
    for (int q = 0; large && q < 27; q++) ct_lanes_lowest(&volume[q], lowest);
    ct_store_lanes(u, 20, lane, 8, &values[480 * (int64_t)b]);
  }
}

CT_CLONES
void ct_solid_hex20_batches(const ct_solid_part *part, int32_t first, int32_t last,
                            const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) batch_forces(part, b, displacement, values, NULL, 0);
}

CT_CLONES
void ct_solid_large_hex20_batches(const ct_solid_part *part, int32_t first, int32_t last,
                                  const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) {
    double lowest = 1.0;
    batch_forces(part, b, displacement, values, &lowest, 1);
    values[part->assembly->value_count + b] = lowest;
  }
}

CT_CLONES
void ct_solid_large_hex20_energies(const ct_solid_part *part, int32_t batch,
                                   const double *displacement, double energies[8])
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    ct_lanes x[3 * 20], u[3 * 20], J[3][3], H[3][3], W[27], line[9], plane[3];
    load_nodes(part, batch, lane, displacement, x, u);
    for (int q = 0; q < 27; q++) {
      reference_gradient(part->gradients[q], x, J);
      reference_gradient(part->gradients[q], u, H);
      ct_large_point_energy(part->material.law, J, H, part->lambda, part->mu, &W[q]);
      W[q] = ((weight[q % 3] * weight[q / 3 % 3]) * weight[q / 9]) * W[q];
    }
    for (int k = 0; k < 9; k++) line[k] = (W[3 * k] + W[3 * k + 2]) + W[3 * k + 1];
    for (int k = 0; k < 3; k++) plane[k] = (line[3 * k] + line[3 * k + 2]) + line[3 * k + 1];
    ct_lanes sum = (plane[0] + plane[2]) + plane[1];
    memcpy(&energies[lane], &sum, sizeof sum);
  }
}
