/* The kernels for hex20 elements of any shape, 3 x 3 x 3 Gauss points, ξ fastest: forces for small
 * and for large deformation, with the smallest J = det F of each batch, and energies. */
#include "kernel.h"
#include "modes20.h"
#include "point.h"

/* Number of points on a line. */
static const double WEIGHT[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};

/* The Gauss points of a line are at -g, 0, g with g² = 3/5. */
static const double GAUSS = 0.77459666924148337704, GAUSS2 = 0.6, GAUSS3 = 0.46475800154489002622;

/* Strides between points along the axes. */
static const int STEP[3] = {1, 3, 9};

/* Reference gradients of one component at the 27 points, or the stresses conjugate to them. */
typedef ct_lanes field[3][27];

/* A polynomial of the coordinates p and q of a square: constant, p, q, pq, p², p² q, q², q² p, each
 * times its value at the points, g, g² or g³. */
typedef struct square {
  ct_lanes one, p, q, pq, pp, ppq, qq, qqp;
} square;

/* Values at the nine points of a square, p fastest. `even`: at the middle, at the ends of p, of q,
 * and at the corners; then the parts that are odd in p and in q, at the ends and at the corners;
 * then the part that is odd in both. */
CT_INLINE void nine_points(const ct_lanes even[4], const ct_lanes p[2], const ct_lanes q[2],
                           const ct_lanes *pq, ct_lanes v[9])
{
  ct_lanes low = even[3] - p[1], high = even[3] + p[1], slope_low = q[1] - *pq,
           slope_high = q[1] + *pq;
  v[0] = low - slope_low;
  v[1] = even[2] - q[0];
  v[2] = high - slope_high;
  v[3] = even[1] - p[0];
  v[4] = even[0];
  v[5] = even[1] + p[0];
  v[6] = low + slope_low;
  v[7] = even[2] + q[0];
  v[8] = high + slope_high;
}

/* The values of a polynomial without squares. */
CT_INLINE void bilinear_points(const ct_lanes *one, const ct_lanes *p, const ct_lanes *q,
                               const ct_lanes *pq, ct_lanes v[9])
{
  ct_lanes even[4] = {*one, *one, *one, *one}, odd[2][2] = {{*p, *p}, {*q, *q}};
  nine_points(even, odd[0], odd[1], pq, v);
}

CT_INLINE void square_points(const square *s, ct_lanes v[9])
{
  ct_lanes end = s->one + s->pp, even[4] = {s->one, end, s->one + s->qq, end + s->qq},
           p[2] = {s->p, s->p + s->qqp}, q[2] = {s->q, s->q + s->ppq};
  nine_points(even, p, q, &s->pq, v);
}

/* The transpose: the sums of nine values times the value of each term at the points. */
CT_INLINE void square_sums(const ct_lanes v[9], square *s)
{
  ct_lanes t[4] = {v[0], v[2], v[6], v[8]}, corner, p_end = v[3] + v[5], q_end = v[1] + v[7];
  ct_square_modes(t, &corner, &s->qqp, &s->ppq, &s->pq);
  s->one = ((v[4] + p_end) + q_end) + corner;
  s->p = (v[5] - v[3]) + s->qqp;
  s->q = (v[7] - v[1]) + s->ppq;
  s->pp = p_end + corner;
  s->qq = q_end + corner;
}

/* Each mode, with squares ξ², times the values of its other factors in a term of a gradient: a pair
 * of coordinates times g, a square alone times g, and so on; in both directions. */
CT_INLINE void scale_modes(ct_lanes U[CT_MODES20])
{
  for (int d = 0; d < 3; d++) {
    ct_lanes *bend = &U[CT_BEND + 4 * d];
    U[CT_XI_ETA + d] = GAUSS * U[CT_XI_ETA + d];
    bend[0] = GAUSS * bend[0];
    bend[1] = GAUSS2 * bend[1];
    bend[2] = GAUSS2 * bend[2];
    bend[3] = GAUSS3 * bend[3];
  }
  U[CT_XI_ETA_ZETA] = GAUSS2 * U[CT_XI_ETA_ZETA];
}

/* 8 ∂u/∂ξ_d at the 27 points from the scaled modes: a mode that is linear along d does not depend
 * on ξ_d, and a square one has the factor 2 ξ_d. */
CT_INLINE void point_gradients(const ct_lanes U[CT_MODES20], int d, ct_lanes G[27])
{
  const int e = (d + 1) % 3, f = (d + 2) % 3;
  const ct_lanes *along = &U[CT_BEND + 4 * d], *p = &U[CT_BEND + 4 * e], *q = &U[CT_BEND + 4 * f];
  const square linear = {
      U[CT_XI + d], U[CT_XI_ETA + d], U[CT_XI_ETA + f], U[CT_XI_ETA_ZETA], p[2], p[3], q[1], q[3]};
  ct_lanes a[9], b[9], slope[4];
  for (int k = 0; k < 4; k++) slope[k] = 2.0 * along[k];
  square_points(&linear, a);
  bilinear_points(&slope[0], &slope[1], &slope[2], &slope[3], b);
  for (int k = 0; k < 9; k++) {
    ct_lanes *at = &G[STEP[e] * (k % 3) + STEP[f] * (k / 3)];
    // a(η, ζ) + 2 ξ b(η, ζ) at ξ = -g, 0, g (eq:brick20-gradient)
    at[0] = a[k] - b[k];
    at[STEP[d]] = a[k];
    at[2 * STEP[d]] = a[k] + b[k];
  }
}

/* Forces on the scaled modes from the stresses of one component, the transpose of
 * `point_gradients` for all three axes. */
CT_INLINE void collect_modes(field P, ct_lanes F[CT_MODES20])
{
  square linear[3], slope[3];
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    ct_lanes a[9], b[9];
    for (int k = 0; k < 9; k++) {
      const ct_lanes *at = &P[d][STEP[e] * (k % 3) + STEP[f] * (k / 3)];
      a[k] = (at[0] + at[2 * STEP[d]]) + at[STEP[d]];
      b[k] = at[2 * STEP[d]] - at[0];
    }
    square_sums(a, &linear[d]);
    square_sums(b, &slope[d]);
  }
  for (int d = 0; d < 3; d++) {
    const square *next = &linear[(d + 1) % 3], *last = &linear[(d + 2) % 3];
    ct_lanes *bend = &F[CT_BEND + 4 * d];
    F[CT_XI + d] = linear[d].one;
    F[CT_XI_ETA + d] = linear[d].p + next->q;
    bend[0] = 2.0 * slope[d].one;
    bend[1] = 2.0 * slope[d].p + next->qq;
    bend[2] = 2.0 * slope[d].q + last->pp;
    bend[3] = (2.0 * slope[d].pq + next->qqp) + last->ppq;
  }
  F[CT_XI_ETA_ZETA] = (linear[0].pq + linear[1].pq) + linear[2].pq;
}

/* 8 times the reference gradients of coordinates and displacements of 8 elements. */
CT_INLINE void find_gradients(const ct_solid_part *part, int32_t b, int lane, const double *array,
                              field G[3])
{
  ct_lanes v[3 * 20], M[CT_MODES20];
  ct_load_lanes(part->mesh, part->rows, b, 20, array, lane, v);
  for (int i = 0; i < 3; i++) {
    ct_brick20_modes(1.0, &v[20 * i], M);
    scale_modes(M);
    for (int d = 0; d < 3; d++) point_gradients(M, d, G[i][d]);
  }
}

/* The gradients at one point, and its weight times the factor that converts stresses to forces from
 * 8 times the gradients. */
CT_INLINE double take_point(field X[3], field U[3], int q, ct_lanes J[3][3], ct_lanes H[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      J[i][j] = X[i][j][q];
      H[i][j] = U[i][j][q];
    }
  return ((WEIGHT[q % 3] * WEIGHT[q / 3 % 3]) * WEIGHT[q / 9]) / 512.0;
}

/* Forces of one batch, and for large deformation its smallest J. */
CT_INLINE void batch_forces(const ct_solid_part *part, int32_t b, const double *displacement,
                            double *values, double *lowest, int large)
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    field X[3], U[3];
    ct_lanes P[3][3], J[3][3], H[3][3], volume, F[CT_MODES20], f[20], lambda_of, mu_of;
    ct_part_constant(part, CT_LAMBDA, part->lambda, b, lane, &lambda_of);
    ct_part_constant(part, CT_MU, part->mu, b, lane, &mu_of);
    find_gradients(part, b, lane, part->mesh->nodes, X);
    find_gradients(part, b, lane, displacement, U);
    for (int q = 0; q < 27; q++) {
      double w = take_point(X, U, q, J, H);
      ct_lanes lambda = w * lambda_of, mu = w * mu_of;
      if (large) ct_large_point(part->material.law, J, H, &lambda, &mu, P, &volume);
      else ct_point_stress(J, H, &lambda, &mu, P);
      if (large) ct_lanes_lowest(&volume, lowest);
      // The stresses replace the gradients.
      for (int i = 0; i < 9; i++) U[i / 3][i % 3][q] = P[i / 3][i % 3];
    }
    for (int i = 0; i < 3; i++) {
      collect_modes(U[i], F);
      scale_modes(F);
      ct_brick20_nodal(1.0, F, f);
      ct_store_lanes(f, 20, i, lane, 8, &values[480 * (int64_t)b]);
    }
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

CT_CLONES_RARE
void ct_solid_large_hex20_energies(const ct_solid_part *part, int32_t batch,
                                   const double *displacement, double energies[8])
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    field X[3], U[3];
    ct_lanes J[3][3], H[3][3], W[27], line[9], plane[3], lambda_of, mu_of;
    ct_part_constant(part, CT_LAMBDA, part->lambda, batch, lane, &lambda_of);
    ct_part_constant(part, CT_MU, part->mu, batch, lane, &mu_of);
    find_gradients(part, batch, lane, part->mesh->nodes, X);
    find_gradients(part, batch, lane, displacement, U);
    for (int q = 0; q < 27; q++) {
      double w = take_point(X, U, q, J, H);
      ct_lanes lambda = w * lambda_of, mu = w * mu_of;
      ct_large_point_energy(part->material.law, J, H, &lambda, &mu, &W[q]);
    }
    for (int k = 0; k < 9; k++) line[k] = (W[3 * k] + W[3 * k + 2]) + W[3 * k + 1];
    for (int k = 0; k < 3; k++) plane[k] = (line[3 * k] + line[3 * k + 2]) + line[3 * k + 1];
    ct_lanes sum = (plane[0] + plane[2]) + plane[1];
    memcpy(&energies[lane], &sum, sizeof sum);
  }
}
