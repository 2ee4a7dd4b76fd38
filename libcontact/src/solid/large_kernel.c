/* The kernels of hex8 and hex20 for large deformation: forces, with the smallest J = det F of each
 * batch, and energies. */
#include "hex20_points.h"
#include "hex8_points.h"
#include "kernel.h"
#include "large_point.h"

/* Reference gradients of coordinates and displacements of 8 elements on the lines of Gauss points.
 */
typedef struct lines {
  ct_lanes X[3][3][4], U[3][3][4];
} lines;

static inline void hex8_lines(const ct_solid_part *part, int32_t b, int lane,
                              const double *displacement, lines *g)
{
  ct_lanes x[3 * 8], u[3 * 8], M[CT_MODES];
  ct_load_lanes(part->mesh, b, 8, part->mesh->nodes, lane, x);
  ct_load_lanes(part->mesh, b, 8, displacement, lane, u);
  for (int i = 0; i < 3; i++) {
    ct_brick_modes(&x[8 * i], M);
    line_gradients(M, g->X[i]);
    ct_brick_modes(&u[8 * i], M);
    line_gradients(M, g->U[i]);
  }
}

static inline void hex8_point(const lines *g, int q, ct_lanes J[3][3], ct_lanes H[3][3])
{
  int line[3] = {q >> 1, (q & 1) + 2 * (q >> 2), q & 3};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      J[i][j] = g->X[i][j][line[j]];
      H[i][j] = g->U[i][j][line[j]];
    }
}

CT_CLONES
void ct_solid_large_hex8_batches(const ct_solid_part *part, int32_t first, int32_t last,
                                 const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) {
    double lowest = 1.0;
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      lines g;
      ct_lanes P[8][3][3], J[3][3], H[3][3], f[3 * 8], volume[8], F[CT_MODES];
      hex8_lines(part, b, lane, displacement, &g);
      for (int q = 0; q < 8; q++) {
        hex8_point(&g, q, J, H);
        ct_large_point(part->material.law, J, H, part->lambda, part->mu, P[q], &volume[q]);
      }
      for (int i = 0; i < 3; i++) {
        collect_modes(P, i, F);
        ct_brick_nodal(F, &f[8 * i]);
      }
      for (int q = 0; q < 8; q++) ct_lanes_lowest(&volume[q], &lowest);
      ct_store_lanes(f, 8, lane, 8, &values[192 * (int64_t)b]);
    }
    values[part->assembly->value_count + b] = lowest;
  }
}

CT_CLONES
void ct_solid_large_hex8_energies(const ct_solid_part *part, int32_t batch,
                                  const double *displacement, double energies[8])
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    lines g;
    ct_lanes W[8], J[3][3], H[3][3];
    hex8_lines(part, batch, lane, displacement, &g);
    for (int q = 0; q < 8; q++) {
      hex8_point(&g, q, J, H);
      ct_large_point_energy(part->material.law, J, H, part->lambda, part->mu, &W[q]);
    }
    ct_lanes sum = ((W[0] + W[1]) + (W[2] + W[3])) + ((W[4] + W[5]) + (W[6] + W[7]));
    memcpy(&energies[lane], &sum, sizeof sum);
  }
}

static inline void hex20_nodes(const ct_solid_part *part, int32_t b, int lane,
                               const double *displacement, ct_lanes x[60], ct_lanes u[60])
{
  ct_load_lanes(part->mesh, b, 20, part->mesh->nodes, lane, x);
  ct_load_lanes(part->mesh, b, 20, displacement, lane, u);
  for (int i = 0; i < 3; i++) {
    centre(&x[20 * i]);
    centre(&u[20 * i]);
  }
}

CT_CLONES
void ct_solid_large_hex20_batches(const ct_solid_part *part, int32_t first, int32_t last,
                                  const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) {
    double lowest = 1.0;
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes x[3 * 20], u[3 * 20], P[27][3][3], J[3][3], H[3][3], volume[27];
      hex20_nodes(part, b, lane, displacement, x, u);
      for (int q = 0; q < 27; q++) {
        reference_gradient(part->gradients[q], x, J);
        reference_gradient(part->gradients[q], u, H);
        ct_large_point(part->material.law, J, H, part->lambda, part->mu, P[q], &volume[q]);
      }
      for (int i = 0; i < 3; i++)
        for (int a = 0; a < 20; a++) nodal_force(P, part->gradients, a, i, &u[20 * i + a]);
      for (int q = 0; q < 27; q++) ct_lanes_lowest(&volume[q], &lowest);
      ct_store_lanes(u, 20, lane, 8, &values[480 * (int64_t)b]);
    }
    values[part->assembly->value_count + b] = lowest;
  }
}

CT_CLONES
void ct_solid_large_hex20_energies(const ct_solid_part *part, int32_t batch,
                                   const double *displacement, double energies[8])
{
  static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    ct_lanes x[3 * 20], u[3 * 20], J[3][3], H[3][3], W[27], line[9], plane[3];
    hex20_nodes(part, batch, lane, displacement, x, u);
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
