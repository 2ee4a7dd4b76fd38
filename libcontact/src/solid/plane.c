/* The kernel for one layer of equal boxes in plane strain: that of the box, with all that vanishes left out. */
#include "plane.h"

#include "../memory.h"

#include <math.h>
#include <string.h>

void ct_plane_free(ct_plane *plane)
{
  if (plane == NULL) return;
  ct_release(plane->batch_nodes);
  ct_release(plane->twin);
  ct_release(plane->place);
  ct_release(plane->upper);
  ct_release(plane->runs);
  ct_release(plane);
}

/* Local nodes of a hex8 by layer and corner. */
static void corners(const ct_plane *plane, int local[2][4])
{
  for (int a = 0; a < 8; a++) {
    double xi[3];
    ct_brick_reference(CT_HEX8, a, xi);
    local[xi[plane->axis] > 0.0][(xi[plane->p] > 0.0) + 2 * (xi[plane->q] > 0.0)] = a;
  }
}

/* Enter partners and places; answers 0 when a node is in both layers or has two elements in one quadrant. */
static int enter_elements(const ct_mesh *mesh, ct_plane *plane)
{
  int local[2][4];
  int32_t zero = (mesh->element_count + 7) / 8 * 96;
  corners(plane, local);
  for (int32_t n = 0; n < mesh->node_count; n++) plane->twin[n] = -1;
  for (int64_t i = 0; i < 4 * (int64_t)mesh->node_count; i++) plane->place[i] = zero;
  plane->batch_step = 96;
  plane->row_step = 8;
  plane->value_count = zero + 24;
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      int32_t node[2], place = ((e / 8 * 4 + k) * 3) * 8 + e % 8;
      for (int layer = 0; layer < 2; layer++) node[layer] = mesh->elements[8 * (size_t)e + (size_t)local[layer][k]];
      for (int layer = 0; layer < 2; layer++) {
        int32_t n = node[layer], other = node[1 - layer], *slot = &plane->place[4 * (int64_t)n + 3 - k];
        if (*slot != zero || (plane->twin[n] >= 0 && (plane->twin[n] != other || plane->upper[n] != layer))) return 0;
        plane->twin[n] = other;
        plane->upper[n] = (int8_t)layer;
        *slot = place;
      }
      plane->batch_nodes[(e / 8 * 4 + k) * 8 + e % 8] = node[0];
    }
  // The last batch repeats its last element.
  for (int32_t e = mesh->element_count; e % 8 != 0; e++)
    for (int k = 0; k < 4; k++) plane->batch_nodes[(e / 8 * 4 + k) * 8 + e % 8] = plane->batch_nodes[(e / 8 * 4 + k) * 8 + e % 8 - 1];
  return 1;
}

/* List the runs of the lower layer. */
static ct_status enter_runs(const ct_mesh *mesh, ct_plane *plane)
{
  for (int pass = 0; pass < 2; pass++) {
    int32_t count = 0, next = -1, next_twin = -1;
    for (int32_t n = 0; n < mesh->node_count; n++) {
      if (plane->upper[n]) continue;
      if (n != next || plane->twin[n] != next_twin) {
        if (pass == 1) memcpy(plane->runs[count], (int32_t[3]){n, plane->twin[n], 0}, sizeof plane->runs[0]);
        count++;
      }
      if (pass == 1) plane->runs[count - 1][2]++;
      next = n + 1;
      next_twin = plane->twin[n] + 1;
    }
    plane->run_count = count;
    if (pass == 0) plane->runs = ct_allocate((size_t)count, sizeof plane->runs[0]);
    if (plane->runs == NULL) return CT_ERROR_MEMORY;
  }
  return CT_OK;
}

/* A lattice needs no places: in rows of its elements they follow from the numbers of its nodes. */
static void drop_places(const ct_solid_part *part, ct_plane *plane)
{
  ct_release(plane->twin);
  ct_release(plane->place);
  ct_release(plane->upper);
  plane->twin = plane->place = NULL;
  plane->upper = NULL;
  plane->batch_step = 8;
  plane->row_step = 8 * (int64_t)part->batch_count + 8; // rows would fight for the same place in the cache
  plane->value_count = 12 * plane->row_step;
}

ct_status ct_plane_create(const ct_solid_part *part, int axis, ct_plane **out)
{
  const ct_mesh *mesh = part->mesh;
  double low[3], high[3];
  *out = NULL;
  ct_mesh_bounds(mesh, low, high);
  if (high[axis] - low[axis] > 1.5 * part->edge[axis] || part->batch_count > INT32_MAX / 400) return CT_OK;
  ct_plane *plane = ct_allocate(1, sizeof *plane);
  if (plane == NULL) return CT_ERROR_MEMORY;
  plane->axis = axis;
  plane->p = axis == 0 ? 1 : 0;
  plane->q = axis == 2 ? 1 : 2;
  plane->batch_nodes = ct_allocate((size_t)part->batch_count * 32, sizeof *plane->batch_nodes);
  plane->twin = ct_allocate((size_t)mesh->node_count, sizeof *plane->twin);
  plane->place = ct_allocate((size_t)mesh->node_count * 4, sizeof *plane->place);
  plane->upper = ct_allocate((size_t)mesh->node_count, sizeof *plane->upper);
  ct_status status = plane->batch_nodes && plane->twin && plane->place && plane->upper ? CT_OK : CT_ERROR_MEMORY;
  int fits = status == CT_OK && enter_elements(mesh, plane);
  if (fits) status = enter_runs(mesh, plane);
  if (fits && status == CT_OK && part->cells[0] > 0) drop_places(part, plane);
  if (fits && status == CT_OK)
    *out = plane;
  else
    ct_plane_free(plane);
  return status;
}

int ct_plane_holds(const ct_plane *plane, const double *displacement)
{
  for (int32_t i = 0; i < plane->run_count; i++) {
    const double *low = &displacement[3 * (int64_t)plane->runs[i][0]], *high = &displacement[3 * (int64_t)plane->runs[i][1]];
    size_t count = (size_t)plane->runs[i][2];
    int moved = 0;
    if (memcmp(low, high, 3 * count * sizeof *low) != 0) return 0;
    for (size_t n = 0; n < count; n++) moved |= low[3 * n + (size_t)plane->axis] != 0.0;
    if (moved) return 0;
  }
  return 1;
}

/* What stays the same for all elements: 1 / (4 edge) and V / (4 edge) times the mean squares 1, 1/3, along p, q and the held axis. */
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

/* The displacement gradient of one component: constant along p and q, and along each the part that grows with the other. */
typedef struct slope {
  ct_lanes p, q, p_by_q, q_by_p;
} slope;

/* From the four corners of a layer; both layers count (eq:plane-modes). */
static inline slope slopes(const ct_lanes u[4], const double k[2])
{
  ct_lanes low = u[1] - u[0], high = u[3] - u[2], both = 2.0 * (high - low);
  return (slope){k[0] * (2.0 * (low + high)), k[1] * (2.0 * ((u[2] - u[0]) + (u[3] - u[1]))), k[0] * both, k[1] * both};
}

/* Nodal forces of one component in the plane from its modal forces F along p, q and pq (eq:plane-force). The order of the sums is that of the brick. */
static inline void spread(int axis, const ct_lanes F[3], ct_lanes f[4])
{
  for (int k = 0; k < 2; k++) {
    double s = k == 0 ? -1.0 : 1.0;
    ct_lanes even = s * F[1], odd = F[0] + s * F[2];
    f[2 * k] = axis == 0 ? -((even - F[0]) - s * F[2]) : odd - even;
    f[2 * k + 1] = axis == 0 ? -((F[0] + even) + s * F[2]) : -(even + odd);
  }
}

/* Forces along the held axis on the lower layer, F of a constant stress and of what grows with p and q. */
static inline void hold(int axis, const ct_lanes F[3], ct_lanes f[4])
{
  for (int k = 0; k < 2; k++) {
    double s = k == 0 ? -1.0 : 1.0;
    ct_lanes even = F[0] + s * F[2];
    f[2 * k] = axis == 0 ? (F[0] - F[1]) + s * F[2] : even - F[1];
    f[2 * k + 1] = axis == 0 ? (F[0] + F[1]) + s * F[2] : even + F[1];
  }
}

/* Read the components p and q at the four corners of 8 elements. */
static inline void load(const int32_t *nodes, const double *array, int lane, int p, int q, ct_lanes a[4], ct_lanes b[4])
{
  for (int k = 0; k < 4; k++) {
    const int32_t *n = &nodes[8 * k + lane];
#if CT_LANES_WIDE
    const double *at[8];
    for (int l = 0; l < 8; l++) at[l] = array + 3 * (int64_t)n[l];
    a[k] = (ct_lanes){at[0][p], at[1][p], at[2][p], at[3][p], at[4][p], at[5][p], at[6][p], at[7][p]};
    b[k] = (ct_lanes){at[0][q], at[1][q], at[2][q], at[3][q], at[4][q], at[5][q], at[6][q], at[7][q]};
#else
    a[k] = array[3 * (int64_t)n[0] + p];
    b[k] = array[3 * (int64_t)n[0] + q];
#endif
  }
}

CT_CLONES
void ct_plane_batches(const ct_solid_part *part, int32_t first, int32_t last, const double *displacement, double *values)
{
  const ct_plane *plane = part->plane;
  const constants c = open_constants(part);
  const int component[3] = {plane->p, plane->q, plane->axis};
  for (int32_t b = first; b < last; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes u[2][4], f[3][4];
      load(&plane->batch_nodes[32 * (int64_t)b], displacement, lane, plane->p, plane->q, u[0], u[1]);
      slope P = slopes(u[0], c.k), Q = slopes(u[1], c.k);
      // -- Stress: constant, and what grows with the other coordinate (eq:plane-stress)
      ct_lanes pp = c.stiff * P.p + c.lambda * Q.q, qq = c.stiff * Q.q + c.lambda * P.p, pq = c.mu * (P.q + Q.p), held = c.lambda * (P.p + Q.q);
      ct_lanes F[3] = {c.K1[0] * pp, c.K1[1] * pq, c.K3[0] * (c.stiff * P.p_by_q) + c.K3[1] * (c.mu * P.q_by_p)};
      ct_lanes G[3] = {c.K1[0] * pq, c.K1[1] * qq, c.K3[0] * (c.mu * Q.p_by_q) + c.K3[1] * (c.stiff * Q.q_by_p)};
      ct_lanes H[3] = {c.K1[2] * held, c.K3[2] * (c.lambda * Q.q_by_p), c.K3[2] * (c.lambda * P.p_by_q)};
      spread(plane->axis, F, f[0]);
      spread(plane->axis, G, f[1]);
      hold(plane->axis, H, f[2]);
      double *to = &values[plane->batch_step * b + lane];
      for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) *(ct_lanes *)(void *)&to[plane->row_step * (3 * k + component[i])] = f[i][k];
    }
}

/* Sum four runs of forces that lie side by side; `step`: from one component to the next. */
CT_CLONES
static void gather_run(const double *const v[4], const int64_t step[4], const double sign[3], int32_t count, double *f)
{
  for (int c = 0; c < 3; c++) {
    const double *a = v[0] + c * step[0], *b = v[1] + c * step[1], *d = v[2] + c * step[2], *e = v[3] + c * step[3], s = sign[c];
#pragma omp simd
    for (int32_t n = 0; n < count; n++) f[3 * n + c] = s * ((a[n] + b[n]) + (d[n] + e[n]));
  }
}

/* Where the four elements around a node have their force on it, the i-th node of row r; answers for how many nodes along x this goes on. */
static int32_t quadrants(const ct_solid_part *part, const double *values, int32_t i, int32_t r, int32_t count, const double *v[4], int64_t step[4])
{
  enum { ZEROS = 64 };
  static const double zeros[ZEROS] = {0.0};
  int32_t nx = part->cells[0], rows = part->mesh->element_count / nx;
  int32_t inside = i > 0 && i < nx ? nx - i : 1, run = count < inside ? count : inside;
  for (int o = 0; o < 4; o++) {
    int32_t along = i - 1 + (o & 1), row = r - 1 + (o >> 1);
    int there = along >= 0 && along < nx && row >= 0 && row < rows;
    v[o] = there ? values + 3 * (3 - o) * part->plane->row_step + along + (int64_t)nx * row : zeros;
    step[o] = there ? part->plane->row_step : 0;
  }
  return run < ZEROS ? run : ZEROS;
}

/* The gather of a lattice, in runs of nodes along x. */
static void gather_lattice(const ct_solid_part *part, const double *values, int32_t first, int32_t last, const double apart[2][3], double *sums)
{
  int32_t row = part->cells[0] + 1, rows = part->cells[1] + 1;
  for (int32_t n = first, run; n < last; n += run) {
    const double *v[4];
    int64_t step[4];
    int32_t line = n / row, upper = part->plane->axis == 1 ? line % 2 : line / rows, r = part->plane->axis == 1 ? line / 2 : line % rows;
    run = quadrants(part, values, n % row, r, last - n, v, step);
    gather_run(v, step, apart[upper], run, &sums[3 * (int64_t)n]);
  }
}

void ct_plane_gather(const ct_solid_part *part, const double *values, int32_t first, int32_t last, double *sums)
{
  const ct_plane *plane = part->plane;
  const int32_t *twins = plane->twin, *places = plane->place;
  const int8_t *upper = plane->upper;
  double apart[2][3] = {{1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}};
  // -- The upper layer is pulled as the lower one, but apart from it (eq:plane-force)
  apart[1][plane->axis] = -1.0;
  if (part->cells[0] > 0) {
    gather_lattice(part, values, first, last, (const double(*)[3])apart, sums);
    return;
  }
  for (int32_t n = first; n < last; n++) {
    const double *sign = apart[upper[n]];
    double *restrict f = &sums[3 * (int64_t)n];
    if (twins[n] >= first && twins[n] < n) {
      const double *g = &sums[3 * (int64_t)twins[n]];
      sign = apart[1];
      f[0] = sign[0] * g[0];
      f[1] = sign[1] * g[1];
      f[2] = sign[2] * g[2];
      continue;
    }
    const int32_t *at = &places[4 * (int64_t)n];
    const double *v0 = &values[at[0]], *v1 = &values[at[1]], *v2 = &values[at[2]], *v3 = &values[at[3]];
    for (int i = 0; i < 3; i++) f[i] = sign[i] * ((v0[8 * i] + v1[8 * i]) + (v2[8 * i] + v3[8 * i]));
  }
}
