/* One force evaluation of one body: compute the active elements, and sum at the nodes. */
#include "call.h"

#include "../base/memory.h"
#include "../base/threads.h"
#include "part.h"

#include <string.h>

ct_part_call ct_part_task(const ct_solid_part *part, const double *given, double *values,
                          int64_t ring_stride, double *f)
{
  ct_part_call call = {.part = part,
                       .ring = part->ring,
                       .batches = part->batches,
                       .given = given,
                       .ordered = ct_part_ordered(part, values),
                       .values = values + part->first_value,
                       .f = f,
                       .ring_stride = ring_stride};
  call.displacement = call.ordered != NULL ? call.ordered : given;
  return call;
}

/* Set the forces of a skipped batch to zero. */
static void clear_batch(const ct_part_call *call, int32_t b, double *values)
{
  const ct_solid_part *part = call->part;
  int nodes = call->ring != NULL ? call->ring->corners : ct_brick_node_count(part->mesh->kind);
  int64_t stride;
  double *v = ct_batch_values(call->ring, nodes, values, b, &stride);
  for (int i = 0; i < 3 * nodes; i++) memset(&v[i * stride], 0, 8 * sizeof *v);
  if (part->energies != NULL) values[part->assembly->value_count + b] = 1.0;
}

/* Whether a batch is computed. */
static int computes(const ct_part_call *call, int32_t b)
{
  return call->batch == NULL || call->batch[b] == CT_ACTIVE;
}

/* Compute the active ones of the batches first ... last - 1; the forces of others are set to zero
 * if they are read and may not be zero yet. */
static void call_batches(const ct_part_call *call, int32_t first, int32_t last, double *values)
{
  for (int32_t b = first, end; b < last; b = end) {
    int active = computes(call, b);
    for (end = call->batch == NULL ? last : b + 1; end < last && computes(call, end) == active;)
      end++;
    if (active) call->batches(call->part, b, end, call->displacement, values);
    for (int32_t i = b; !active && i < end; i++)
      if (call->examined || call->batch[i] == CT_BORDER) clear_batch(call, i, values);
  }
}

/* The first of the nodes n, n + 1, ... that is summed. */
static int32_t next_node(const ct_part_call *call, int32_t n)
{
  int32_t shift = call->part->first_node, last = shift + call->part->mesh->node_count;
  return call->summed == NULL || call->part->order != NULL
             ? n
             : ct_bits_next(call->summed, shift + n, last, 1) - shift;
}

enum { NODES_HANDED_ON = 64 };

/* Whether a node, in the numbering of the part, is summed. */
static int is_summed(const ct_part_call *call, int32_t node)
{
  const ct_solid_part *part = call->part;
  return call->summed == NULL ||
         ct_bits_get(call->summed, part->first_node + part->order->user[node]);
}

/* For a part with its own order: sum at those of the nodes first ... last - 1 of a run that are
 * summed, in pieces, and copy the sums to the user's order. */
static void gather_ordered(const ct_part_call *call, const double *values, const ct_ring_run *run,
                           int32_t first, int32_t last)
{
  double sums[3 * NODES_HANDED_ON];
  for (int32_t n = first, end; n < last; n = end) {
    end = last - n < NODES_HANDED_ON ? last : n + NODES_HANDED_ON;
    int32_t some = n;
    while (some < end && !is_summed(call, some)) some++;
    if (some == end) continue;
    ct_force_ring_gather(call->ring, values, run, n - run->low, end - run->low, sums, NULL);
    for (int32_t i = some; i < end; i++)
      if (is_summed(call, i))
        memcpy(&call->f[3 * (int64_t)call->part->order->user[i]], &sums[3 * (i - n)],
               3 * sizeof(double));
  }
}

/* Sum at the nodes of a run from one with an active element on; returns the first node behind them.
 */
static int32_t gather_run(const ct_part_call *call, const double *values, const ct_ring_run *run)
{
  int32_t n = run->low, last = n + run->count;
  for (int32_t end; n < last; n = end) {
    end = ct_call_nodes(call, &n, last);
    if (call->part->order != NULL) gather_ordered(call, values, run, n, end);
    else
      ct_force_ring_gather(call->ring, values, run, n - run->low, end - run->low,
                           &call->f[3 * (int64_t)n],
                           &call->f[3 * (int64_t)(n + run->high - run->low)]);
  }
  return next_node(call, last);
}

/* Forces at the nodes of the runs first ... last - 1, each run as soon as its last element is
 * computed. */
static void sum_runs(const ct_part_call *call, int32_t first, int32_t last, double *values)
{
  const ct_ring_run *runs = call->ring->runs;
  int32_t begin = INT32_MAX, next = next_node(call, 0);
  for (int32_t r = first; r < last; r++) begin = runs[r].first < begin ? runs[r].first : begin;
  for (int32_t b = begin / 8, end, r = first; r < last; b = end) {
    end = b + CT_BLOCK < call->part->batch_count ? b + CT_BLOCK : call->part->batch_count;
    call_batches(call, b, end, values);
    for (; r < last; r++) {
      if (runs[r].low + runs[r].count <= next) continue;
      if (runs[r].last >= 8 * end) break;
      next = gather_run(call, values, &runs[r]);
    }
  }
}

/* One thread's part of the nodes, with a ring of its own. Elements between two parts are computed
 * twice. */
static void ring_share(const ct_part_call *call, int share, int shares)
{
  int32_t runs = call->ring->run_count;
  if (shares > call->ring->ring_count) shares = call->ring->ring_count;
  if (share < shares)
    sum_runs(call, ct_share(runs, share, shares), ct_share(runs, share + 1, shares),
             call->values + call->ring_stride * share);
}

/* One thread's part of the elements. */
static void element_share(const ct_part_call *call, int share, int shares)
{
  int32_t batches = call->part->batch_count, blocks = (batches + CT_BLOCK - 1) / CT_BLOCK,
          last = ct_share(blocks, share + 1, shares);
  for (int32_t k = ct_share(blocks, share, shares); k < last; k++) {
    int32_t b = k * CT_BLOCK;
    call_batches(call, b, b + CT_BLOCK < batches ? b + CT_BLOCK : batches, call->values);
  }
}

/* After all elements: one thread's part of the nodes with an active element. */
static void node_share(const ct_part_call *call, int share, int shares)
{
  int32_t nodes = call->part->mesh->node_count, last = ct_share(nodes, share + 1, shares);
  for (int32_t n = ct_share(nodes, share, shares), end; n < last; n = end) {
    end = ct_call_nodes(call, &n, last);
    if (call->part->kernel == CT_KERNEL_RIGID)
      ct_clear(&call->f[3 * (int64_t)n], 3 * (size_t)(end - n));
    else ct_assembly_gather(call->part->assembly, call->values, n, end, call->f);
  }
}

/* One thread's part of the displacements of a part with its own order. */
static void arrange_share(const ct_part_call *call, int share, int shares)
{
  const int32_t *user = call->part->order->user, nodes = call->part->mesh->node_count,
                last = ct_share(nodes, share + 1, shares);
  for (int32_t n = ct_share(nodes, share, shares); n < last; n++)
    if (is_summed(call, n))
      memcpy(&call->ordered[3 * (int64_t)n], &call->given[3 * (int64_t)user[n]],
             3 * sizeof *call->ordered);
}

void ct_part_arrange(const ct_part_call *calls, int32_t count, int threads)
{
  int ordered = 0;
  for (int32_t i = 0; i < count; i++) ordered |= calls[i].ordered != NULL;
  if (!ordered) return;
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++)
    for (int32_t i = 0; i < count; i++)
      if (calls[i].ordered != NULL) arrange_share(&calls[i], share, threads);
}

void ct_part_forces(const ct_part_call *calls, int32_t count, int threads)
{
  int tables = 0;
  ct_part_arrange(calls, count, threads); // elements of one thread have nodes of another
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++)
    for (int32_t i = 0; i < count; i++)
      (calls[i].ring != NULL ? ring_share : element_share)(&calls[i], share, threads);
  for (int32_t i = 0; i < count; i++) {
    if (calls[i].ring != NULL) continue;
    if (calls[i].part->kernel != CT_KERNEL_RIGID)
      ct_assembly_fold(calls[i].part->assembly, calls[i].values);
    tables = 1;
  }
  if (!tables) return;
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++)
    for (int32_t i = 0; i < count; i++)
      if (calls[i].ring == NULL) node_share(&calls[i], share, threads);
}
