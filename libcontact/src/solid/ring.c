/* Which nodes can be summed from a ring of element forces, and their sums. */
#include "ring.h"

#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../mesh/mesh_internal.h"
#include "kernel.h"

#include <string.h>

/* Largest number of zeros with which nodes that lack an element are summed. */
enum { ZEROS = 256 };

/* Largest number of threads with a ring each. */
enum { MOST_RINGS = 64 };

/* Average number of nodes in a run below which tables are faster: rows of 8 bricks. */
enum { SHORTEST_RUN = 3 };

/* Nodes of a piece if corners are listed. */
enum { PIECE = 64 };

/* Distance of a run from the expected one in most lattices. */
enum { NEAR = 4 };

void ct_force_ring_free(ct_force_ring *ring)
{
  if (ring == NULL) return;
  ct_release(ring->runs);
  ct_release(ring->begin);
  ct_release(ring->list);
  ct_release(ring);
}

/* Enter for each of the nodes begin ... end - 1, in a plane for all nodes, its elements by octant
 * or quadrant, -1 if there is none, and its partner in the other layer (of bricks: itself); for the
 * upper layer, a partner below -1. Returns 0 if a node is in both layers or has two elements in one
 * place. */
static int enter_nodes(const ct_mesh *mesh, const ct_force_ring *ring, int32_t begin, int32_t end,
                       int32_t *twin, int32_t (*around)[8])
{
  int corners = ring->corners, plane = corners == 4;
  for (int32_t n = begin; n < end; n++) {
    twin[n] = -1;
    for (int k = 0; k < corners; k++) around[n][k] = -1;
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < corners; k++) {
      const int32_t *node = &mesh->elements[8 * (size_t)e];
      int32_t low = node[ring->local[k]], high = plane ? node[ring->local[k + 4]] : low,
              *slot = &around[low][corners - 1 - k];
      if (low < begin || low >= end) continue;
      if (*slot >= 0 || (twin[low] != -1 && twin[low] != high) ||
          (plane && twin[high] != -1 && twin[high] != -2 - low))
        return 0;
      *slot = e;
      twin[low] = high;
      if (plane) twin[high] = -2 - low;
    }
  return 1;
}

/* The same for all nodes. */
static int enter_elements(const ct_mesh *mesh, const ct_force_ring *ring, int32_t *twin,
                          int32_t (*around)[8])
{
  int32_t count = mesh->node_count;
  int fits = 1, threads = ring->corners == 4 ? 1
                                             : ct_threads_for(ct_threads_of(mesh->settings), count,
                                                              CT_LEAST_OF_MESH);
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) \
    reduction(&& : fits) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++)
    fits = enter_nodes(mesh, ring, ct_share(count, share, threads),
                       ct_share(count, share + 1, threads), twin, around) &&
           fits;
  return fits;
}

/* Whether a node, its partner and its elements continue a run. */
static int goes_on(int corners, const ct_ring_run *run, int32_t node, int32_t twin,
                   const int32_t *around)
{
  int32_t i = run->count;
  if (node != run->low + i || twin != run->high + i) return 0;
  for (int k = 0; k < corners; k++)
    if (run->element[k] < 0 ? around[k] >= 0 || i >= ZEROS : around[k] != run->element[k] + i)
      return 0;
  return 1;
}

/* Allocate `count` runs, more than there are; returns whether this succeeded. */
static int allocate_runs(ct_force_ring *ring, size_t count)
{
  ct_ring_run *larger = ct_allocate(count, sizeof *larger);
  if (larger == NULL) return 0;
  if (ring->runs != NULL)
    memcpy(larger, ring->runs, (size_t)(ring->run_count - 1) * sizeof *larger);
  ct_release(ring->runs);
  ring->runs = larger;
  return 1;
}

/* List the runs. */
static ct_status enter_runs(const ct_mesh *mesh, ct_force_ring *ring, const int32_t *twin,
                            int32_t (*around)[8])
{
  ct_ring_run *run = NULL;
  for (int32_t n = 0; n < mesh->node_count; n++) {
    if (twin[n] < 0) continue;
    if (run == NULL || !goes_on(ring->corners, run, n, twin[n], around[n])) {
      // The capacity doubles at powers of two.
      int32_t count = ring->run_count++;
      if ((count & (count - 1)) == 0 && !allocate_runs(ring, 2 * (size_t)count + 1))
        return CT_ERROR_MEMORY;
      run = &ring->runs[count];
      *run = (ct_ring_run){.low = n, .high = twin[n]};
      memcpy(run->element, around[n], sizeof run->element);
    }
    run->count++;
  }
  return CT_OK;
}

/* List the corners at each node, and pieces of the nodes in place of runs. */
static ct_status enter_lists(const ct_mesh *mesh, const int32_t *sequence, ct_force_ring *ring)
{
  int32_t nodes = mesh->node_count, count = mesh->element_count;
  int64_t corners = 8 * (int64_t)count;
  ring->begin = ct_allocate((size_t)nodes + 2, sizeof *ring->begin);
  ring->list = ct_allocate((size_t)corners, sizeof *ring->list);
  ring->run_count = (nodes + PIECE - 1) / PIECE;
  ring->runs = ct_allocate((size_t)ring->run_count, sizeof *ring->runs);
  if (ring->begin == NULL || ring->list == NULL || ring->runs == NULL) return CT_ERROR_MEMORY;
  // Count, then list: begin[n + 2] is first the count of node n, and finally the end of its list.
  for (int64_t i = 0; i < corners; i++) ring->begin[mesh->elements[i] + 2]++;
  for (int32_t n = 0; n < nodes; n++) ring->begin[n + 2] += ring->begin[n + 1];
  for (int32_t i = 0; i < count; i++)
    for (int a = 0; a < 8; a++) {
      int32_t at = 8 * sequence[i] + a;
      ring->list[ring->begin[mesh->elements[at] + 1]++] = at;
    }
  for (int32_t r = 0; r < ring->run_count; r++) {
    int32_t low = PIECE * r, left = nodes - low;
    ct_ring_run *run = &ring->runs[r];
    *run = (ct_ring_run){
        .low = low, .high = low, .count = left < PIECE ? left : PIECE, .first = count};
    memset(run->element, -1, sizeof run->element);
    for (int32_t i = ring->begin[low]; i < ring->begin[low + run->count]; i++) {
      int32_t e = ring->list[i] / 8;
      run->first = e < run->first ? e : run->first;
      run->last = e > run->last ? e : run->last;
    }
  }
  return CT_OK;
}

/* The first and last elements of the runs, and a ring that holds the pending elements and those
 * that are computed together (eq:lattice-ring). */
static void size_ring(ct_force_ring *ring, const ct_mesh *mesh)
{
  int64_t need = 0, all = ((int64_t)mesh->element_count + 7) / 8 * 8;
  int32_t top = -1;
  for (int32_t r = 0; r < ring->run_count; r++) {
    ct_ring_run *run = &ring->runs[r];
    if (ring->list == NULL) run->first = INT32_MAX;
    for (int k = 0; k < ring->corners; k++) {
      int32_t first = run->element[k], last = first + run->count - 1;
      if (first < 0) continue;
      run->first = first < run->first ? first : run->first;
      run->last = last > run->last ? last : run->last;
    }
    top = run->last > top ? run->last : top;
    need = top - run->first > need ? top - run->first : need;
  }
  need += 8 * (CT_BLOCK + 2);
  ring->size = 8;
  while (ring->size < (need < all ? need : all)) ring->size *= 2;
  // Lists read whole batches; rows of the ring would map to the same place in the cache.
  ring->stride = ring->list != NULL ? 8 : ring->size + 8;
  ring->step = ring->list != NULL ? 24 : 1;
  ring->value_count = 3 * ring->corners * (ring->size + 8);
  ring->ring_count = ct_threads_of(mesh->settings);
  if (ring->ring_count > MOST_RINGS) ring->ring_count = MOST_RINGS;
}

ct_status ct_force_ring_create(const ct_mesh *mesh, int axis, ct_force_ring **out)
{
  ct_force_ring *ring = ct_allocate(1, sizeof *ring);
  int32_t *twin = ct_allocate((size_t)mesh->node_count, sizeof *twin),
          (*around)[8] = ct_allocate((size_t)mesh->node_count, sizeof *around);
  ct_status status = ring && twin && around ? CT_OK : CT_ERROR_MEMORY;
  int fits = 0;
  *out = NULL;
  if (status == CT_OK) {
    *ring = (ct_force_ring){.corners = axis < 0 ? 8 : 4,
                            .axis = axis < 0 ? 2 : axis,
                            .p = axis == 0 ? 1 : 0,
                            .q = axis == 2 || axis < 0 ? 1 : 2};
    for (int a = 0; a < 8; a++) {
      double xi[3];
      ct_brick_reference(CT_HEX8, a, xi);
      ring->local[(xi[ring->p] > 0.0) + 2 * (xi[ring->q] > 0.0) + 4 * (xi[ring->axis] > 0.0)] = a;
    }
    fits = enter_elements(mesh, ring, twin, around);
    if (fits) status = enter_runs(mesh, ring, twin, around);
    fits = fits && status == CT_OK &&
           (axis >= 0 || (int64_t)SHORTEST_RUN * ring->run_count <= mesh->node_count);
  }
  ct_release(twin);
  ct_release(around);
  if (fits) {
    size_ring(ring, mesh);
    *out = ring;
  } else {
    ct_force_ring_free(ring);
  }
  return status;
}

ct_status ct_force_ring_create_listed(const ct_mesh *mesh, const int32_t *sequence,
                                      ct_force_ring **out)
{
  ct_force_ring *ring = *out = ct_allocate(1, sizeof *ring);
  if (ring == NULL) return CT_ERROR_MEMORY;
  *ring = (ct_force_ring){.corners = 8};
  for (int a = 0; a < 8; a++) ring->local[a] = ct_brick_octant(CT_HEX8, a);
  ct_status status = enter_lists(mesh, sequence, ring);
  if (status == CT_OK) size_ring(ring, mesh);
  return status;
}

const ct_ring_run *ct_force_ring_run(const ct_force_ring *ring, int32_t node)
{
  const ct_ring_run *runs = ring->runs;
  int32_t first = 0, last = ring->run_count - 1;
  // Rows of a lattice follow one another regularly: search near the expected run.
  int32_t guess = (int32_t)((int64_t)node * last / (runs[last].low + runs[last].count));
  if (guess >= NEAR && guess <= last && runs[guess - NEAR].low <= node) first = guess - NEAR;
  if (guess <= last - NEAR && runs[guess + NEAR].low > node) last = guess + NEAR;
  while (first < last) {
    int32_t middle = first + (last - first + 1) / 2;
    if (runs[middle].low <= node) first = middle;
    else last = middle - 1;
  }
  return &runs[first];
}

/* Sum eight runs of element forces that lie side by side; `step`: the stride between components. */
CT_CLONES
static void gather_bricks(const double *const v[8], const int64_t step[8], int32_t count, double *f)
{
  int32_t rows = CT_ROWS && count >= 8 ? count : 0;
  for (int32_t begin = 0; begin < rows; begin += 8) {
    // The last eight may overlap those before.
    int32_t n = begin + 8 <= count ? begin : count - 8;
    ct_lanes sum[3];
    for (int c = 0; c < 3; c++) {
      ct_lanes t[8];
      for (int k = 0; k < 8; k++) t[k] = *(const ct_loose *)(const void *)&v[k][c * step[k] + n];
      // -- Pair the octants along ξ, then η, then ζ (eq:tree-sum)
      sum[c] = ((t[0] + t[1]) + (t[2] + t[3])) + ((t[4] + t[5]) + (t[6] + t[7]));
    }
    ct_store_row(sum, &f[3 * n]);
  }
  for (int32_t n = rows; n < count; n++)
    for (int c = 0; c < 3; c++) {
      double t[8];
      for (int k = 0; k < 8; k++) t[k] = v[k][c * step[k] + n];
      f[3 * n + c] = ((t[0] + t[1]) + (t[2] + t[3])) + ((t[4] + t[5]) + (t[6] + t[7]));
    }
}

/* Sum four such runs of a plane, for both layers; the forces of the upper one have the signs
 * `sign`. A zero sum has no minus sign, like that of the bricks, which begins with the zeros of
 * missing elements, and like that of sleeping elements. */
CT_CLONES
static void gather_plane(const double *const v[4], const int64_t step[4], const double sign[3],
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

/* Sum at the nodes first ... last - 1 by their lists, the elements of an octant in order. */
static void gather_lists(const ct_force_ring *ring, const double *values, int32_t first,
                         int32_t last, double *sums)
{
  uint32_t mask = (uint32_t)(ring->size - 1);
  for (int32_t n = first; n < last; n++, sums += 3) {
    double t[8][4] = {{0.0}};
    for (int32_t i = ring->begin[n]; i < ring->begin[n + 1]; i++) {
      int a = ring->list[i] & 7;
      uint32_t e = (uint32_t)ring->list[i] / 8 & mask;
      const double *v = &values[24 * (int64_t)(e & ~7u) + 24 * a + (e & 7u)];
      double *sum = t[ring->local[a]];
      for (int c = 0; c < 3; c++) sum[c] += v[8 * c];
    }
    for (int c = 0; c < 3; c++)
      sums[c] =
          ((t[0][c] + t[1][c]) + (t[2][c] + t[3][c])) + ((t[4][c] + t[5][c]) + (t[6][c] + t[7][c]));
  }
}

/* Forces from the i-th node of a run on, of its corners in a row: for each where they begin, and
 * the stride between components; a missing element has zeros. Returns how many nodes follow without
 * a gap in the ring. */
CT_INLINE int64_t find_rows(const ct_force_ring *ring, int corners, const double *values,
                            const int32_t element[8], int32_t i, const double *v[8],
                            int64_t step[8])
{
  static const double zeros[ZEROS] = {0.0};
  const int64_t size = ring->size, stride = ring->stride;
  int64_t top = 0;
  for (int k = 0; k < corners; k++) {
    v[k] = zeros;
    step[k] = 0;
    if (element[k] < 0) continue;
    int64_t place = (element[k] + i) & (size - 1),
            corner = corners == 4 ? 3 - k : ring->local[7 - k];
    v[k] = values + 3 * corner * stride + place;
    step[k] = stride;
    top = place > top ? place : top;
  }
  return size - top;
}

/* In pieces that are contiguous in the ring. */
void ct_force_ring_gather(const ct_force_ring *ring, const double *values, const ct_ring_run *run,
                          int32_t first, int32_t last, double *low, double *high)
{
  if (ring->list != NULL) {
    gather_lists(ring, values, run->low + first, run->low + last, low);
    return;
  }
  int plane = ring->corners == 4;
  double apart[3] = {1.0, 1.0, 1.0};
  // -- The upper layer has equal forces in the plane, and opposite ones across (eq:plane-force)
  apart[ring->axis] = -1.0;
  for (int32_t i = first, piece; i < last; i += piece) {
    const double *v[8];
    int64_t step[8], at = 3 * (int64_t)(i - first),
                     most = plane ? find_rows(ring, 4, values, run->element, i, v, step)
                                  : find_rows(ring, 8, values, run->element, i, v, step);
    piece = last - i < most ? last - i : (int32_t)most;
    if (plane) gather_plane(v, step, apart, piece, &low[at], &high[at]);
    else gather_bricks(v, step, piece, &low[at]);
  }
}
