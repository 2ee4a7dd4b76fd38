/* The kernel for hex8 elements of any shape with one point and hourglass control. */
#include "reduced.h"
#include "mean.h"

enum { HOURGLASS = 4, FIRST_HOURGLASS = CT_XI_ETA };

/* Data of 8 elements: β[j][m] = b[j][m] / V, the hourglass modes X[j][k] of the coordinates, the
 * volume, the stiffness c of the hourglass modes, and Lamé's constants. */
typedef struct reduced_lanes {
  ct_lanes beta[3][CT_MEAN_MODES], X[3][HOURGLASS], V, c, lambda, mu;
} reduced_lanes;

CT_INLINE void find_shape(const ct_solid_part *part, int32_t b, int lane, reduced_lanes *r)
{
  ct_lanes x[3 * 8], X[3][CT_MODES], B[3][CT_MEAN_MODES], g[3], young;
  ct_part_constant(part, CT_YOUNG, part->material.young, b, lane, &young);
  ct_part_constant(part, CT_LAMBDA, part->lambda, b, lane, &r->lambda);
  ct_part_constant(part, CT_MU, part->mu, b, lane, &r->mu);
  const ct_lanes scale = part->hourglass * young / 72.0;
  ct_load_lanes(part->mesh, part->rows, b, 8, part->mesh->nodes, lane, x);
  ct_brick_modes(&x[0], X[0]);
  ct_brick_modes(&x[8], X[1]);
  ct_brick_modes(&x[16], X[2]);
  // -- Mean gradients per displacement (eq:mean-gradient), and the scale g² of their size
  // (eq:hourglass-stiffness)
  ct_mean_gradient(X, B, &r->V);
  for (int j = 0; j < 3; j++) {
    for (int m = 0; m < CT_MEAN_MODES; m++) r->beta[j][m] = B[j][m] / r->V;
    for (int k = 0; k < HOURGLASS; k++) r->X[j][k] = X[j][FIRST_HOURGLASS + k];
    ct_mean_sum(r->beta[j], r->beta[j], &g[j]);
  }
  r->c = (scale * r->V) * (8.0 * ((g[0] + g[1]) + g[2]));
}

/* From one component of the displacements of the eight nodes: its mean gradient, and the hourglass
 * amplitudes without the part of the mean gradient. */
static inline void gradient_and_hourglass(const reduced_lanes *r, const ct_lanes u[8],
                                          ct_lanes G[3], ct_lanes q[HOURGLASS])
{
  ct_lanes U[CT_MODES];
  ct_brick_modes(u, U);
  // -- Take the mean displacement gradient
  for (int j = 0; j < 3; j++) ct_mean_sum(r->beta[j], U, &G[j]);
  // -- Take off the linear part of the hourglass amplitudes (eq:hourglass-amplitude)
  for (int k = 0; k < HOURGLASS; k++)
    q[k] = U[FIRST_HOURGLASS + k] - ((G[0] * r->X[0][k] + G[1] * r->X[1][k]) + G[2] * r->X[2][k]);
}

/* All components, and V times the stress of the mean gradient. Unrolled by hand, so that the
 * compiler keeps the values in registers. */
static inline void strain_and_hourglass(const reduced_lanes *r, const ct_lanes u[3 * 8],
                                        ct_lanes G[3][3], ct_lanes S[3][3],
                                        ct_lanes q[3][HOURGLASS])
{
  gradient_and_hourglass(r, &u[0], G[0], q[0]);
  gradient_and_hourglass(r, &u[8], G[1], q[1]);
  gradient_and_hourglass(r, &u[16], G[2], q[2]);
  ct_lanes trace = (r->lambda * r->V) * ((G[0][0] + G[1][1]) + G[2][2]), stiff = r->mu * r->V;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j <= i; j++) {
      S[i][j] = stiff * (G[i][j] + G[j][i]);
      if (i == j) S[i][i] = S[i][i] + trace;
      S[j][i] = S[i][j];
    }
}

/* Nodal forces of one component from V times its stresses P and its hourglass amplitudes
 * (eq:reduced-force). */
static inline void collect(const reduced_lanes *r, ct_lanes P[3], const ct_lanes q[HOURGLASS],
                           ct_lanes f[8])
{
  ct_lanes F[CT_MODES], Q[HOURGLASS];
  for (int k = 0; k < HOURGLASS; k++) F[FIRST_HOURGLASS + k] = Q[k] = r->c * q[k];
  for (int j = 0; j < 3; j++)
    P[j] =
        P[j] - ((Q[0] * r->X[j][0] + Q[1] * r->X[j][1]) + (Q[2] * r->X[j][2] + Q[3] * r->X[j][3]));
  for (int m = 0; m < CT_MEAN_MODES; m++) {
    ct_lanes mean = (P[0] * r->beta[0][m] + P[1] * r->beta[1][m]) + P[2] * r->beta[2][m];
    if (m >= FIRST_HOURGLASS) mean = mean + F[m];
    F[m] = mean;
  }
  ct_brick_nodal(F, f);
}

CT_CLONES
void ct_solid_reduced_batches(const ct_solid_part *part, int32_t first, int32_t last,
                              const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++) {
    int64_t stride;
    double *to = ct_batch_values(part->ring, 8, values, b, &stride);
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes u[3 * 8], G[3][3], P[3][3], q[3][HOURGLASS];
      reduced_lanes r;
      find_shape(part, b, lane, &r);
      ct_load_lanes(part->mesh, part->rows, b, 8, displacement, lane, u);
      strain_and_hourglass(&r, u, G, P, q);
      collect(&r, P[0], q[0], &u[0]);
      collect(&r, P[1], q[1], &u[8]);
      collect(&r, P[2], q[2], &u[16]);
      for (int i = 0; i < 3; i++) ct_store_lanes(&u[8 * i], 8, i, lane, stride, to);
    }
  }
}

CT_CLONES_RARE
void ct_solid_reduced_energies(const ct_solid_part *part, int32_t batch, const double *displacement,
                               double strain[8], double hourglass[8])
{
  for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
    ct_lanes u[3 * 8], G[3][3], S[3][3], q[3][HOURGLASS], W[3], H[3], half;
    reduced_lanes r;
    find_shape(part, batch, lane, &r);
    ct_load_lanes(part->mesh, part->rows, batch, 8, displacement, lane, u);
    strain_and_hourglass(&r, u, G, S, q);
    // -- ½ V σ : G and ½ c Σ q² (eq:reduced-energy)
    for (int i = 0; i < 3; i++) {
      W[i] = (S[i][0] * G[i][0] + S[i][1] * G[i][1]) + S[i][2] * G[i][2];
      H[i] = (q[i][0] * q[i][0] + q[i][1] * q[i][1]) + (q[i][2] * q[i][2] + q[i][3] * q[i][3]);
    }
    // The caller's arrays need not be aligned.
    half = 0.5 * ((W[0] + W[1]) + W[2]);
    memcpy(&strain[lane], &half, sizeof half);
    half = (0.5 * r.c) * ((H[0] + H[1]) + H[2]);
    memcpy(&hourglass[lane], &half, sizeof half);
  }
}
