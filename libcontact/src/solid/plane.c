/* The kernel for one layer of equal boxes in plane strain: that of the box, without all terms that
 * vanish. */
#include "call.h"
#include "plane.h"

/* Count numbers that differ between `count` nodes of two layers, and numbers along `axis` that are
 * not zero. */
CT_CLONES
static int differences(const double *low, const double *high, int32_t count, int axis)
{
  int64_t found = 0;
#pragma omp simd reduction(| : found)
  for (int64_t d = 0; d < 3 * (int64_t)count; d++) found |= low[d] != high[d];
#pragma omp simd reduction(| : found)
  for (int64_t n = 0; n < count; n++) found |= low[3 * n + axis] != 0.0;
  return found != 0;
}

/* Whether both layers have the same displacements, and none along their axis, at the nodes that are
 * summed. */
static int is_plane(const ct_part_call *call)
{
  const ct_force_ring *plane = call->part->plane;
  for (int32_t r = 0; r < plane->run_count; r++) {
    int32_t low = plane->runs[r].low, apart = plane->runs[r].high - low,
            last = low + plane->runs[r].count;
    for (int32_t n = low, end; n < last; n = end) {
      end = ct_call_nodes(call, &n, last);
      const double *u = &call->displacement[3 * (int64_t)n];
      if (differences(u, u + 3 * (int64_t)apart, end - n, plane->axis)) return 0;
    }
  }
  return 1;
}

/* Constants of all elements: 1 / (4 edge) and V / (4 edge) times the mean squares 1, 1/3, along p,
 * q and the fixed axis. */
typedef struct constants {
  double k[2], K1[3], K3[3], lambda, mu, stiff;
} constants;

static constants open_constants(const ct_solid_part *part)
{
  const int axis[3] = {part->plane->p, part->plane->q, part->plane->axis};
  double volume = part->edge[0] * part->edge[1] * part->edge[2];
  constants c = {.lambda = part->lambda, .mu = part->mu, .stiff = part->lambda + 2.0 * part->mu};
  for (int d = 0; d < 3; d++) {
    double k = 0.25 / part->edge[axis[d]];
    if (d < 2) c.k[d] = k;
    c.K1[d] = volume * k;
    c.K3[d] = c.K1[d] / 3.0;
  }
  return c;
}

/* The displacement gradient of one component: constant along p and q, and along each the part
 * proportional to the other coordinate. */
typedef struct slope {
  ct_lanes p, q, p_by_q, q_by_p;
} slope;

/* From the four corners of a layer; the sum includes both layers. */
static inline slope slopes(const ct_lanes u[4], const double k[2])
{
  ct_lanes low = u[1] - u[0], high = u[3] - u[2], both = 2.0 * (high - low);
  // k_p U_p, k_q U_q, k_p U_pq, k_q U_pq (eq:plane-modes)
  return (slope){k[0] * (2.0 * (low + high)), k[1] * (2.0 * ((u[2] - u[0]) + (u[3] - u[1]))),
                 k[0] * both, k[1] * both};
}

/* Nodal forces of one component in the plane from its modal forces F along p, q and pq. The sums
 * have the order of the brick's. */
static inline void spread(int axis, const ct_lanes F[3], ct_lanes f[4])
{
  for (int k = 0; k < 2; k++) {
    double s = k == 0 ? -1.0 : 1.0;
    ct_lanes even = s * F[1], odd = F[0] + s * F[2];
    // The same in both layers (eq:plane-force)
    f[2 * k] = axis == 0 ? -((even - F[0]) - s * F[2]) : odd - even;
    f[2 * k + 1] = axis == 0 ? -((F[0] + even) + s * F[2]) : -(even + odd);
  }
}

/* Forces along the fixed axis on the lower layer, from the modal forces F of a constant stress and
 * of stresses proportional to p and q. */
static inline void hold(int axis, const ct_lanes F[3], ct_lanes f[4])
{
  for (int k = 0; k < 2; k++) {
    double s = k == 0 ? -1.0 : 1.0;
    ct_lanes even = F[0] + s * F[2];
    f[2 * k] = axis == 0 ? (F[0] - F[1]) + s * F[2] : even - F[1];
    f[2 * k + 1] = axis == 0 ? (F[0] + F[1]) + s * F[2] : even + F[1];
  }
}

/* Read the components p and q at the four corners of the lower layer of 8 elements. */
CT_INLINE void load(const ct_solid_part *part, int32_t b, const double *array, int lane,
                    ct_lanes u[2][4])
{
  const ct_force_ring *plane = part->plane;
  int32_t buffer[8 * 20];
  const int32_t *nodes = ct_batch_nodes(part->mesh, b, 8, buffer);
  for (int k = 0; k < 4; k++) {
    const int32_t *n = &nodes[8 * lane + plane->local[k]];
    const double *at[8];
    for (int l = 0; l < CT_LANES_COUNT; l++) at[l] = array + 3 * (int64_t)n[8 * l];
    for (int i = 0; i < 2; i++) {
      int c = i == 0 ? plane->p : plane->q;
#if CT_LANES_WIDE
      u[i][k] = (ct_lanes){at[0][c], at[1][c], at[2][c], at[3][c],
                           at[4][c], at[5][c], at[6][c], at[7][c]};
#else
      u[i][k] = at[0][c];
#endif
    }
  }
}

/* Forces of the lower layer by the batches first ... last - 1, into a ring. */
CT_CLONES
static void plane_batches(const ct_solid_part *part, int32_t first, int32_t last,
                          const double *displacement, double *values)
{
  const ct_force_ring *plane = part->plane;
  const constants c = open_constants(part);
  const int component[3] = {plane->p, plane->q, plane->axis};
  for (int32_t b = first; b < last; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes u[2][4], f[3][4];
      load(part, b, displacement, lane, u);
      slope P = slopes(u[0], c.k), Q = slopes(u[1], c.k);
      // -- Stress: constant, and what grows with the other coordinate (eq:plane-stress)
      ct_lanes pp = c.stiff * P.p + c.lambda * Q.q, qq = c.stiff * Q.q + c.lambda * P.p,
               pq = c.mu * (P.q + Q.p), held = c.lambda * (P.p + Q.q);
      ct_lanes F[3] = {c.K1[0] * pp, c.K1[1] * pq,
                       c.K3[0] * (c.stiff * P.p_by_q) + c.K3[1] * (c.mu * P.q_by_p)};
      ct_lanes G[3] = {c.K1[0] * pq, c.K1[1] * qq,
                       c.K3[0] * (c.mu * Q.p_by_q) + c.K3[1] * (c.stiff * Q.q_by_p)};
      ct_lanes H[3] = {c.K1[2] * held, c.K3[2] * (c.lambda * Q.q_by_p),
                       c.K3[2] * (c.lambda * P.p_by_q)};
      spread(plane->axis, F, f[0]);
      spread(plane->axis, G, f[1]);
      hold(plane->axis, H, f[2]);
      int64_t stride;
      double *to = ct_batch_values(plane, 4, values, b, &stride) + lane;
      for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
          *(ct_lanes *)(void *)&to[stride * (3 * k + component[i])] = f[i][k];
    }
}

void ct_plane_take(ct_part_call *call, double *values)
{
  if (call->part->plane == NULL || !is_plane(call)) return;
  call->ring = call->part->plane;
  call->batches = plane_batches;
  call->values = values;
}
