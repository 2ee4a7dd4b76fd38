/* The kernels for hex8 elements of any shape, 2 x 2 x 2 Gauss points, ξ fastest: forces for small
 * and for large deformation, with the smallest J = det F of each batch, and energies. */
#include "kernel.h"
#include "modes.h"
#include "point.h"

/* The Gauss points are at ± this. */
static const double GAUSS = 0.57735026918962576451;

/* Values of one + s p + t (q + s pq) for the signs (s, t) = (-,-), (+,-), (-,+), (+,+). */
CT_INLINE void square_values(const ct_lanes *one, const ct_lanes *p, const ct_lanes *q,
                             const ct_lanes *pq, ct_lanes v[4])
{
  ct_lanes low = *one - *p, high = *one + *p, slope_low = *q - *pq, slope_high = *q + *pq;
  v[0] = low - slope_low;
  v[1] = high - slope_high;
  v[2] = low + slope_low;
  v[3] = high + slope_high;
}

/* 8 ∂/∂ξ, 8 ∂/∂η, 8 ∂/∂ζ of one component on the four lines of Gauss points along each. Line k has
 * the signs (k & 1, k >> 1) of the two other directions, each of which contributes the factor 1/√3
 * of the points. */
CT_INLINE void line_gradients(const ct_lanes U[CT_MODES], ct_lanes G[3][4])
{
  ct_lanes xy = GAUSS * U[CT_XI_ETA], yz = GAUSS * U[CT_ETA_ZETA], zx = GAUSS * U[CT_ZETA_XI],
           xyz = (GAUSS * GAUSS) * U[CT_XI_ETA_ZETA];
  square_values(&U[CT_XI], &xy, &zx, &xyz, G[0]);
  square_values(&U[CT_ETA], &xy, &yz, &xyz, G[1]);
  square_values(&U[CT_ZETA], &zx, &yz, &xyz, G[2]);
}

/* Modal forces of one component from P at the eight points: the transpose of `line_gradients`. */
CT_INLINE void collect_modes(ct_lanes P[8][3][3], int i, ct_lanes F[CT_MODES])
{
  static const int pair[3][4][2] = {{{0, 1}, {2, 3}, {4, 5}, {6, 7}},
                                    {{0, 2}, {1, 3}, {4, 6}, {5, 7}},
                                    {{0, 4}, {1, 5}, {2, 6}, {3, 7}}};
  ct_lanes sum[3], p[3], q[3], pq[3];
  for (int j = 0; j < 3; j++) {
    ct_lanes t[4];
    for (int k = 0; k < 4; k++) t[k] = P[pair[j][k][0]][i][j] + P[pair[j][k][1]][i][j];
    ct_square_modes(t, &sum[j], &p[j], &q[j], &pq[j]);
  }
  F[CT_XI] = sum[0];
  F[CT_ETA] = sum[1];
  F[CT_ZETA] = sum[2];
  F[CT_XI_ETA] = GAUSS * (p[0] + p[1]);
  F[CT_ZETA_XI] = GAUSS * (q[0] + p[2]);
  F[CT_ETA_ZETA] = GAUSS * (q[1] + q[2]);
  F[CT_XI_ETA_ZETA] = (GAUSS * GAUSS) * ((pq[0] + pq[1]) + pq[2]);
}

/* Write the nodal forces of one component. */
CT_INLINE void store_forces(ct_lanes P[8][3][3], int i, int lane, int64_t stride, double *to)
{
  ct_lanes F[CT_MODES], f[8];
  collect_modes(P, i, F);
  ct_brick_nodal(F, f);
  ct_store_lanes(f, 8, i, lane, stride, to);
}

/* Reference gradients of coordinates and displacements of 8 elements on the lines of Gauss points.
 */
typedef struct lines {
  ct_lanes X[3][3][4], U[3][3][4];
} lines;

CT_INLINE void component_lines(const ct_lanes v[8], ct_lanes G[3][4])
{
  ct_lanes V[CT_MODES];
  ct_brick_modes(v, V);
  line_gradients(V, G);
}

/* Unrolled by hand, here and below, so that the compiler keeps the values in registers. */
CT_INLINE void find_lines(const ct_solid_part *part, int32_t b, int lane,
                          const double *displacement, lines *g)
{
  ct_lanes x[3 * 8], u[3 * 8];
  ct_load_lanes(part->mesh, part->rows, b, 8, part->mesh->nodes, lane, x);
  ct_load_lanes(part->mesh, part->rows, b, 8, displacement, lane, u);
  component_lines(&x[0], g->X[0]);
  component_lines(&u[0], g->U[0]);
  component_lines(&x[8], g->X[1]);
  component_lines(&u[8], g->U[1]);
  component_lines(&x[16], g->X[2]);
  component_lines(&u[16], g->U[2]);
}

CT_INLINE void take_point(const lines *g, int q, ct_lanes J[3][3], ct_lanes H[3][3])
{
  int line[3] = {q >> 1, (q & 1) + 2 * (q >> 2), q & 3};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      J[i][j] = g->X[i][j][line[j]];
      H[i][j] = g->U[i][j][line[j]];
    }
}

/* Lamé's constants times the factor that converts stresses to forces from 8 times the gradients. */
CT_INLINE void find_constants(const ct_solid_part *part, int32_t b, int lane, ct_lanes *lambda,
                              ct_lanes *mu)
{
  ct_part_constant(part, CT_LAMBDA, part->lambda, b, lane, lambda);
  ct_part_constant(part, CT_MU, part->mu, b, lane, mu);
  *lambda = *lambda / 512.0;
  *mu = *mu / 512.0;
}

/* Forces of one batch, and for large deformation its smallest J. */
CT_INLINE void batch_forces(const ct_solid_part *part, int32_t b, const double *displacement,
                            double *values, double *lowest, int large)
{
  int64_t stride;
  double *to = ct_batch_values(part->ring, 8, values, b, &stride);
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    lines g;
    ct_lanes P[8][3][3], J[3][3], H[3][3], volume[8], lambda, mu;
    find_constants(part, b, lane, &lambda, &mu);
    find_lines(part, b, lane, displacement, &g);
    for (int q = 0; q < 8; q++) {
      take_point(&g, q, J, H);
      if (large) ct_large_point(part->material.law, J, H, &lambda, &mu, P[q], &volume[q]);
      else ct_point_stress(J, H, &lambda, &mu, P[q]);
    }
    store_forces(P, 0, lane, stride, to);
    store_forces(P, 1, lane, stride, to);
    store_forces(P, 2, lane, stride, to);
    for (int q = 0; large && q < 8; q++) ct_lanes_lowest(&volume[q], lowest);
  }
}

CT_CLONES
void ct_solid_hex8_batches(const ct_solid_part *part, int32_t first, int32_t last,
                           const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) batch_forces(part, b, displacement, values, NULL, 0);
}

CT_CLONES
void ct_solid_large_hex8_batches(const ct_solid_part *part, int32_t first, int32_t last,
                                 const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) {
    double lowest = 1.0;
    batch_forces(part, b, displacement, values, &lowest, 1);
    values[part->assembly->value_count + b] = lowest;
  }
}

CT_CLONES_RARE
void ct_solid_large_hex8_energies(const ct_solid_part *part, int32_t batch,
                                  const double *displacement, double energies[8])
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    lines g;
    ct_lanes W[8], J[3][3], H[3][3], lambda, mu;
    find_constants(part, batch, lane, &lambda, &mu);
    find_lines(part, batch, lane, displacement, &g);
    for (int q = 0; q < 8; q++) {
      take_point(&g, q, J, H);
      ct_large_point_energy(part->material.law, J, H, &lambda, &mu, &W[q]);
    }
    ct_lanes sum = ((W[0] + W[1]) + (W[2] + W[3])) + ((W[4] + W[5]) + (W[6] + W[7]));
    memcpy(&energies[lane], &sum, sizeof sum);
  }
}
