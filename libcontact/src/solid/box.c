/* Which bodies have rectangular elements of one size, and the kernel for those of hex8: every
 * integral in closed form. */
#include "../base/threads.h"
#include "../mesh/mesh_internal.h"
#include "kernel.h"
#include "modes.h"

#include <math.h>

/* Whether the nodes of the elements from `e` on, one per lane, are at the expected places relative
 * to the first one of each. */
CT_CLONES_RARE
static int are_alike(const ct_mesh *mesh, int32_t e, double place[20][3], double tolerance)
{
  int per = ct_brick_node_count(mesh->kind), off = 0;
  ct_lanes x[3 * 20];
  ct_load_lanes(mesh, NULL, e / 8, per, mesh->nodes, e % 8, x);
  for (int d = 0; d < 3; d++)
    for (int a = 1; a < per; a++) {
      ct_lanes beside = (x[per * d + a] - x[per * d]) - place[a][d];
      double difference[CT_LANES_COUNT];
      memcpy(difference, &beside, sizeof beside);
      for (int l = 0; l < CT_LANES_COUNT; l++) off |= !(fabs(difference[l]) <= tolerance);
    }
  return !off;
}

int ct_solid_is_box(const ct_mesh *mesh, double edge[3])
{
  double low[3], high[3], place[20][3];
  int per = ct_brick_node_count(mesh->kind);
  ct_mesh_bounds(mesh, low, high);
  for (int d = 0; d < 3; d++) {
    // The size of the body over a whole number of cells: the same bits for a mirrored body.
    const int32_t *n = mesh->elements;
    double cell =
        mesh->nodes[3 * (size_t)n[6] + (size_t)d] - mesh->nodes[3 * (size_t)n[0] + (size_t)d];
    if (!(cell > 0.0)) return 0;
    edge[d] = (high[d] - low[d]) / floor((high[d] - low[d]) / cell + 0.5);
  }
  for (int a = 0; a < per; a++) {
    ct_brick_reference(mesh->kind, a, place[a]);
    for (int d = 0; d < 3; d++) place[a][d] = 0.5 * (place[a][d] + 1.0) * edge[d];
  }
  double size = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
  int off = 0;
#ifdef _OPENMP
  int threads =
      ct_threads_for(ct_threads_of(mesh->settings), mesh->element_count, CT_LEAST_OF_MESH);
#pragma omp parallel for num_threads(threads) reduction(| : off) if (threads > 1)
#endif
  for (int32_t e = 0; e < mesh->element_count; e += CT_LANES_COUNT)
    if (!off) off = !are_alike(mesh, e, place, 1e-12 * size);
  return !off;
}

/* Coefficients of the displacement gradient of one component along one axis: constant, and the
 * three bilinear terms. */
typedef struct slope {
  ct_lanes one, p, q, pq;
} slope;

/* Displacement gradients of a component from its modes: along x the bilinear terms are η, ζ, ηζ;
 * along y ξ, ζ, ζξ; along z ξ, η, ξη. c = 1 / (4 edge). */
static inline void slopes(const ct_lanes U[CT_MODES], const double c[3], slope D[3])
{
  // (eq:box-gradient)
  D[0] =
      (slope){c[0] * U[CT_XI], c[0] * U[CT_XI_ETA], c[0] * U[CT_ZETA_XI], c[0] * U[CT_XI_ETA_ZETA]};
  D[1] = (slope){c[1] * U[CT_ETA], c[1] * U[CT_XI_ETA], c[1] * U[CT_ETA_ZETA],
                 c[1] * U[CT_XI_ETA_ZETA]};
  D[2] = (slope){c[2] * U[CT_ZETA], c[2] * U[CT_ZETA_XI], c[2] * U[CT_ETA_ZETA],
                 c[2] * U[CT_XI_ETA_ZETA]};
}

/* Modal forces of one component from the stress coefficients that belong to its gradients along x,
 * y, z. K1, K3, K9 = V / (4 edge) times the mean squares 1, 1/3, 1/9 of the terms. */
static inline void modal_force(const slope s[3], const double K1[3], const double K3[3],
                               const double K9[3], ct_lanes F[CT_MODES])
{
  // (eq:box-force)
  F[CT_XI] = K1[0] * s[0].one;
  F[CT_ETA] = K1[1] * s[1].one;
  F[CT_ZETA] = K1[2] * s[2].one;
  F[CT_XI_ETA] = K3[0] * s[0].p + K3[1] * s[1].p;
  F[CT_ZETA_XI] = K3[0] * s[0].q + K3[2] * s[2].p;
  F[CT_ETA_ZETA] = K3[1] * s[1].q + K3[2] * s[2].q;
  F[CT_XI_ETA_ZETA] = (K9[0] * s[0].pq + K9[1] * s[1].pq) + K9[2] * s[2].pq;
}

/* Stress coefficients from the slopes D[i][j] of u_i along x_j: s[i][j] holds the terms of σ_ij
 * that the slope of u_i along x_j has. */
static inline void box_stress(slope D[3][3], double lambda, double mu, slope s[3][3])
{
  double stiff = lambda + 2.0 * mu;
  slope X = D[0][0], Y = D[1][1], Z = D[2][2];
  // (eq:box-stress)
  s[0][0] = (slope){stiff * X.one + lambda * (Y.one + Z.one), stiff * X.p + lambda * Z.q,
                    stiff * X.q + lambda * Y.q, stiff * X.pq};
  s[1][1] = (slope){stiff * Y.one + lambda * (X.one + Z.one), stiff * Y.p + lambda * Z.p,
                    stiff * Y.q + lambda * X.q, stiff * Y.pq};
  s[2][2] = (slope){stiff * Z.one + lambda * (X.one + Y.one), stiff * Z.p + lambda * Y.p,
                    stiff * Z.q + lambda * X.p, stiff * Z.pq};
  // Shear: each slope keeps its own terms, and shares the constant and the term along the third
  // axis with its partner.
  ct_lanes xy = mu * (D[0][1].one + D[1][0].one), xy_zeta = mu * (D[0][1].q + D[1][0].q);
  s[0][1] = (slope){xy, mu * D[0][1].p, xy_zeta, mu * D[0][1].pq};
  s[1][0] = (slope){xy, mu * D[1][0].p, xy_zeta, mu * D[1][0].pq};
  ct_lanes yz = mu * (D[1][2].one + D[2][1].one), yz_xi = mu * (D[1][2].p + D[2][1].p);
  s[1][2] = (slope){yz, yz_xi, mu * D[1][2].q, mu * D[1][2].pq};
  s[2][1] = (slope){yz, yz_xi, mu * D[2][1].q, mu * D[2][1].pq};
  ct_lanes zx = mu * (D[2][0].one + D[0][2].one), zx_eta = mu * (D[2][0].p + D[0][2].q);
  s[2][0] = (slope){zx, zx_eta, mu * D[2][0].q, mu * D[2][0].pq};
  s[0][2] = (slope){zx, mu * D[0][2].p, zx_eta, mu * D[0][2].pq};
}

CT_CLONES
void ct_solid_box_batches(const ct_solid_part *part, int32_t first, int32_t last,
                          const double *displacement, double *values)
{
  double volume = part->edge[0] * part->edge[1] * part->edge[2], c[3], K1[3], K3[3], K9[3];
  for (int d = 0; d < 3; d++) {
    // -- V / (4 edge) times the mean squares
    c[d] = 0.25 / part->edge[d];
    // ⟨1⟩, ⟨ξ²⟩ = 1/3, ⟨ξ²η²⟩ = 1/9 (eq:box-moments)
    K1[d] = volume * c[d];
    K3[d] = K1[d] / 3.0;
    K9[d] = K1[d] / 9.0;
  }
  for (int32_t b = first; b < last; b++) {
    int64_t stride;
    double *out = ct_batch_values(part->ring, 8, values, b, &stride);
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes u[3 * 8], f[8], U[CT_MODES], F[CT_MODES];
      slope D[3][3], s[3][3];
      ct_load_lanes(part->mesh, part->rows, b, 8, displacement, lane, u);
      for (int i = 0; i < 3; i++) {
        ct_brick_modes(&u[8 * i], U);
        slopes(U, c, D[i]);
      }
      box_stress(D, part->lambda, part->mu, s);
      for (int i = 0; i < 3; i++) {
        modal_force(s[i], K1, K3, K9, F);
        ct_brick_nodal(F, f);
        ct_store_lanes(f, 8, i, lane, stride, out);
      }
    }
  }
}
