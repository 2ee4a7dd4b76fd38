/* The kernel for one layer of equal boxes in plane strain: that of the box, with all that vanishes
 * left out. */
#include "plane.h"

#include "../base/memory.h"

#include <string.h>

/* Nodes that lack an element are summed with as many zeros at most. */
enum { ZEROS = 64 };

void ct_plane_free(ct_plane *plane)
{
  if (plane == NULL) return;
  ct_release(plane->batch_nodes);
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

/* Enter for each node its partner in the other layer and its elements by quadrant, -1 where there
 * is none; of the upper layer, a partner below -1. Answers 0 when a node is in both layers or has
 * two elements in one quadrant. */
static int enter_elements(const ct_mesh *mesh, ct_plane *plane, int32_t *twin, int32_t (*around)[4])
{
  int local[2][4];
  corners(plane, local);
  for (int32_t n = 0; n < mesh->node_count; n++) {
    twin[n] = -1;
    for (int k = 0; k < 4; k++) around[n][k] = -1;
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++) {
      int32_t low = mesh->elements[8 * (size_t)e + (size_t)local[0][k]],
              high = mesh->elements[8 * (size_t)e + (size_t)local[1][k]],
              *slot = &around[low][3 - k];
      if (*slot >= 0 || (twin[low] != -1 && twin[low] != high) ||
          (twin[high] != -1 && twin[high] != -2 - low))
        return 0;
      *slot = e;
      twin[low] = high;
      twin[high] = -2 - low;
      plane->batch_nodes[(e / 8 * 4 + k) * 8 + e % 8] = low;
    }
  // The last batch repeats its last element.
  for (int32_t e = mesh->element_count; e % 8 != 0; e++)
    for (int k = 0; k < 4; k++)
      plane->batch_nodes[(e / 8 * 4 + k) * 8 + e % 8] =
          plane->batch_nodes[(e / 8 * 4 + k) * 8 + e % 8 - 1];
  return 1;
}

/* Whether a node, its partner and its elements come next in a run. */
static int goes_on(const ct_plane_run *run, int32_t node, int32_t twin, const int32_t around[4])
{
  int32_t i = run->count;
  int wide = i < ZEROS, alike = node == run->low + i && twin == run->high + i;
  for (int k = 0; k < 4; k++)
    alike =
        alike && (run->element[k] < 0 ? around[k] < 0 && wide : around[k] == run->element[k] + i);
  return alike;
}

/* List the runs of the lower layer. */
static ct_status enter_runs(const ct_mesh *mesh, ct_plane *plane, const int32_t *twin,
                            int32_t (*around)[4])
{
  for (int pass = 0; pass < 2; pass++) {
    ct_plane_run run = {.count = 0};
    int32_t count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
      if (twin[n] < 0) continue;
      if (run.count == 0 || !goes_on(&run, n, twin[n], around[n])) {
        run = (ct_plane_run){.low = n, .high = twin[n]};
        memcpy(run.element, around[n], sizeof run.element);
        count++;
      }
      run.count++;
      if (pass == 1) plane->runs[count - 1] = run;
    }
    plane->run_count = count;
    if (pass == 0) plane->runs = ct_allocate((size_t)count, sizeof *plane->runs);
    if (plane->runs == NULL) return CT_ERROR_MEMORY;
  }
  return CT_OK;
}

/* First and last element of a run. */
static void span(const ct_plane_run *run, int32_t *first, int32_t *last)
{
  *first = INT32_MAX;
  *last = -1;
  for (int k = 0; k < 4; k++) {
    if (run->element[k] < 0) continue;
    if (run->element[k] < *first) *first = run->element[k];
    if (run->element[k] + run->count - 1 > *last) *last = run->element[k] + run->count - 1;
  }
}

/* A ring that holds what runs still wait for and what is computed at once (eq:lattice-ring). */
static void size_ring(const ct_solid_part *part, ct_plane *plane)
{
  int64_t need = 0, all = 8 * (int64_t)part->batch_count;
  int32_t top = -1;
  for (int32_t r = 0; r < plane->run_count; r++) {
    int32_t first, last;
    span(&plane->runs[r], &first, &last);
    top = last > top ? last : top;
    need = top - first > need ? top - first : need;
  }
  need += 8 * (CT_BLOCK + 2);
  plane->ring = 8;
  while (plane->ring < (need < all ? need : all)) plane->ring *= 2;
  plane->stride = plane->ring + 8; // rows of the ring would fight for the same place in the cache
  plane->value_count = 12 * plane->stride * plane->rings;
}

ct_status ct_plane_create(const ct_solid_part *part, int axis, int rings, ct_plane **out)
{
  const ct_mesh *mesh = part->mesh;
  double low[3], high[3];
  *out = NULL;
  ct_mesh_bounds(mesh, low, high);
  if (high[axis] - low[axis] > 1.5 * part->edge[axis]) return CT_OK;
  ct_plane *plane = ct_allocate(1, sizeof *plane);
  if (plane == NULL) return CT_ERROR_MEMORY;
  *plane = (ct_plane){.axis = axis, .p = axis == 0 ? 1 : 0, .q = axis == 2 ? 1 : 2, .rings = rings};
  plane->batch_nodes = ct_allocate((size_t)part->batch_count * 32, sizeof *plane->batch_nodes);
  int32_t *twin = ct_allocate((size_t)mesh->node_count, sizeof *twin),
          (*around)[4] = ct_allocate((size_t)mesh->node_count, sizeof *around);
  ct_status status = plane->batch_nodes && twin && around ? CT_OK : CT_ERROR_MEMORY;
  int fits = status == CT_OK && enter_elements(mesh, plane, twin, around);
  if (fits) status = enter_runs(mesh, plane, twin, around);
  ct_release(twin);
  ct_release(around);
  if (fits && status == CT_OK) {
    size_ring(part, plane);
    *out = plane;
  } else {
    ct_plane_free(plane);
  }
  return status;
}

/* Numbers that differ between `count` nodes of two layers, and numbers along `axis` that are not
 * zero. */
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

int ct_plane_holds(const ct_part_call *call)
{
  const ct_plane *plane = call->part->plane;
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

/* What stays the same for all elements: 1 / (4 edge) and V / (4 edge) times the mean squares 1,
 * 1/3, along p, q and the held axis. */
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

/* The displacement gradient of one component: constant along p and q, and along each the part that
 * grows with the other. */
typedef struct slope {
  ct_lanes p, q, p_by_q, q_by_p;
} slope;

/* From the four corners of a layer; both layers count (eq:plane-modes). */
static inline slope slopes(const ct_lanes u[4], const double k[2])
{
  ct_lanes low = u[1] - u[0], high = u[3] - u[2], both = 2.0 * (high - low);
  return (slope){k[0] * (2.0 * (low + high)), k[1] * (2.0 * ((u[2] - u[0]) + (u[3] - u[1]))),
                 k[0] * both, k[1] * both};
}

/* Nodal forces of one component in the plane from its modal forces F along p, q and pq
 * (eq:plane-force). The order of the sums is that of the brick. */
static inline void spread(int axis, const ct_lanes F[3], ct_lanes f[4])
{
  for (int k = 0; k < 2; k++) {
    double s = k == 0 ? -1.0 : 1.0;
    ct_lanes even = s * F[1], odd = F[0] + s * F[2];
    f[2 * k] = axis == 0 ? -((even - F[0]) - s * F[2]) : odd - even;
    f[2 * k + 1] = axis == 0 ? -((F[0] + even) + s * F[2]) : -(even + odd);
  }
}

/* Forces along the held axis on the lower layer, F of a constant stress and of what grows with p
 * and q. */
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
static inline void load(const int32_t *nodes, const double *array, int lane, int p, int q,
                        ct_lanes a[4], ct_lanes b[4])
{
  for (int k = 0; k < 4; k++) {
    const int32_t *n = &nodes[8 * k + lane];
#if CT_LANES_WIDE
    const double *at[8];
    for (int l = 0; l < 8; l++) at[l] = array + 3 * (int64_t)n[l];
    a[k] =
        (ct_lanes){at[0][p], at[1][p], at[2][p], at[3][p], at[4][p], at[5][p], at[6][p], at[7][p]};
    b[k] =
        (ct_lanes){at[0][q], at[1][q], at[2][q], at[3][q], at[4][q], at[5][q], at[6][q], at[7][q]};
#else
    a[k] = array[3 * (int64_t)n[0] + p];
    b[k] = array[3 * (int64_t)n[0] + q];
#endif
  }
}

/* Forces of the lower layer by the batches first ... last - 1, into a ring. */
CT_CLONES
static void batches(const ct_solid_part *part, int32_t first, int32_t last,
                    const double *displacement, double *values)
{
  const ct_plane *plane = part->plane;
  const constants c = open_constants(part);
  const int component[3] = {plane->p, plane->q, plane->axis};
  for (int32_t b = first; b < last; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes u[2][4], f[3][4];
      load(&plane->batch_nodes[32 * (int64_t)b], displacement, lane, plane->p, plane->q, u[0],
           u[1]);
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
      double *to = &values[(8 * (int64_t)b & (plane->ring - 1)) + lane];
      for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
          *(ct_lanes *)(void *)&to[plane->stride * (3 * k + component[i])] = f[i][k];
    }
}

/* Sum four runs of forces that lie side by side, for both layers; `step`: from one component to the
 * next. A sum that is zero has no minus, as that of the bricks, which begins with the zeros of the
 * side where no element is, and as that of elements that sleep. */
CT_CLONES
static void gather_run(const double *const v[4], const int64_t step[4], const double sign[3],
                       int32_t count, double *restrict low, double *restrict high)
{
  const double *a = v[0], *b = v[1], *d = v[2], *e = v[3];
#pragma omp simd
  for (int32_t n = 0; n < count; n++)
    for (int c = 0; c < 3; c++) {
      double f =
          (a[c * step[0] + n] + b[c * step[1] + n]) + (d[c * step[2] + n] + e[c * step[3] + n]);
      low[3 * n + c] = f + 0.0;
      high[3 * n + c] = sign[c] * f + 0.0;
    }
}

/* Sum at the nodes first ... last - 1 of a run, in pieces that are whole in the ring. */
static void gather(const ct_plane *plane, const double *values, const ct_plane_run *run,
                   int32_t first, int32_t last, double *sums)
{
  static const double zeros[ZEROS] = {0.0};
  double apart[3] = {1.0, 1.0, 1.0};
  // -- The upper layer is pulled as the lower one, but apart from it (eq:plane-force)
  apart[plane->axis] = -1.0;
  for (int32_t i = first, piece; i < last; i += piece) {
    const double *v[4];
    int64_t step[4];
    piece = last - i;
    for (int k = 0; k < 4; k++) {
      int64_t place = run->element[k] < 0 ? 0 : (run->element[k] + i) & (plane->ring - 1);
      v[k] = run->element[k] < 0 ? zeros : values + 3 * (3 - k) * plane->stride + place;
      step[k] = run->element[k] < 0 ? 0 : plane->stride;
      if (piece > plane->ring - place) piece = (int32_t)(plane->ring - place);
    }
    gather_run(v, step, apart, piece, &sums[3 * (int64_t)(run->low + i)],
               &sums[3 * (int64_t)(run->high + i)]);
  }
}

/* Compute those of the batches first ... last - 1 that are active; the others get zeros where
 * somebody reads them. */
static void call_batches(const ct_part_call *call, int32_t first, int32_t last, double *values)
{
  const ct_plane *plane = call->part->plane;
  for (int32_t b = first, end; b < last; b = end) {
    end = ct_call_run(call, b, last);
    if (ct_call_computes(call, b)) {
      batches(call->part, b, end, call->displacement, values);
      continue;
    }
    for (int32_t i = b; i < end; i++) {
      double *to = &values[8 * (int64_t)i & (plane->ring - 1)];
      for (int k = 0; call->batch[i] == CT_BORDER && k < 12; k++)
        memset(&to[plane->stride * k], 0, 8 * sizeof *to);
    }
  }
}

/* Sum at those nodes of a run that have an active element. */
static void call_gather(const ct_part_call *call, const double *values, const ct_plane_run *run)
{
  int32_t last = run->low + run->count;
  for (int32_t n = run->low, end; n < last; n = end) {
    end = ct_call_nodes(call, &n, last);
    gather(call->part->plane, values, run, n - run->low, end - run->low, call->f);
  }
}

/* Forces at the nodes of the runs first ... last - 1, each run as soon as its last element is
 * there. */
static void sum_runs(const ct_part_call *call, int32_t first, int32_t last, double *values)
{
  const ct_plane_run *runs = call->part->plane->runs;
  int32_t begin = INT32_MAX, from, to;
  for (int32_t r = first; r < last; r++) {
    span(&runs[r], &from, &to);
    begin = from < begin ? from : begin;
  }
  for (int32_t b = begin / 8, end, r = first; r < last; b = end) {
    end = b + CT_BLOCK < call->part->batch_count ? b + CT_BLOCK : call->part->batch_count;
    call_batches(call, b, end, values);
    for (; r < last; r++) {
      span(&runs[r], &from, &to);
      if (to >= 8 * end) break;
      call_gather(call, values, &runs[r]);
    }
  }
}

void ct_plane_force(const ct_part_call *call, int threads)
{
  const ct_plane *plane = call->part->plane;
  int64_t runs = plane->run_count;
  int shares = threads < plane->rings ? threads : plane->rings;
#ifdef _OPENMP
#pragma omp parallel for num_threads(shares) schedule(static, 1) if (shares > 1)
#endif
  for (int i = 0; i < shares; i++)
    sum_runs(call, (int32_t)(runs * i / shares), (int32_t)(runs * (i + 1) / shares),
             call->values + 12 * plane->stride * i);
}
