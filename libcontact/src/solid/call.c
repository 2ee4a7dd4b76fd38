/* One call of the force for one body: compute what is not quiet, sum at the nodes while the forces
 * are in the cache. */
#include "call.h"

#include "../base/bits.h"
#include "lattice.h"
#include "plane.h"

#include <string.h>

void ct_part_sum_all(ct_quiet *quiet, const ct_solid_part *part, int32_t number)
{
  ct_bits_put(quiet->changed, part->first_node, part->first_node + part->mesh->node_count, 1);
  quiet->kept[number] &= (uint8_t)~CT_KEPT_READ;
}

void ct_part_find_quiet(const ct_part_call *call, int32_t number, const ct_view *view,
                        int32_t node_count)
{
  enum { AT_ONCE = 64 };
  const ct_solid_part *part = call->part;
  ct_quiet *quiet = call->quiet;
  if (part->cells[0] > 0) {
    int64_t b = part->first_batch;
    ct_leader *leader =
        view->adrift != NULL && number < view->leader_count ? &view->leaders[number] : NULL;
    ct_rows_find(&quiet->rows[number], part, view, quiet->call, leader,
                 &(ct_found){&quiet->batch[b], &quiet->read[b], &quiet->woken[b], quiet->changed,
                             quiet->adrift, node_count});
    return;
  }
  const double *velocity = view->drifted != NULL ? view->velocity : NULL;
  int threads = view->threads, crossed = 0;
  (void)threads;
  ct_quiet_wake(quiet, part, number, view->drifted);
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static) \
    reduction(| : crossed) if (threads > 1)
#endif
  for (int32_t b = 0; b < part->batch_count; b += AT_ONCE)
    crossed |= ct_quiet_look(quiet, part, b,
                             b + AT_ONCE < part->batch_count ? b + AT_ONCE : part->batch_count,
                             call->displacement, velocity);
  if (view->still == NULL) {
    // Nothing stands from before: all nodes are to be summed.
    ct_part_sum_all(quiet, part, number);
    memset(&quiet->read[part->first_batch], 1, (size_t)part->batch_count);
  } else if (crossed || !(quiet->kept[number] & CT_KEPT_READ)) {
    ct_quiet_mark(quiet, part);
    quiet->kept[number] |= CT_KEPT_READ;
  }
}

/* Let the forces of a batch that is left out be the zeros that they are, where they do not stand
 * from before. */
static void give_zeros(const ct_solid_part *part, int32_t b, double *values)
{
  if (part->ring > 0) ct_lattice_zeros(part, b, values);
  else if (part->plane != NULL) // what stands there may be older than the plane
    memset(&values[192 * (int64_t)b], 0, 192 * sizeof(double));
}

/* Compute those of the batches first ... last - 1 that are not quiet. */
static void call_batches(const ct_part_call *call, int32_t first, int32_t last)
{
  const ct_solid_part *part = call->part;
  const double *u = call->displacement + 3 * (int64_t)part->first_node;
  for (int32_t b = first, end; b < last; b = end) {
    end = ct_quiet_run(call->quiet, part, b, last);
    if (call->quiet == NULL || ct_quiet_computes(call->quiet, part, b))
      part->batches(part, b, end, u, call->values);
    else
      for (int32_t i = b; i < end; i++)
        if (call->quiet->read[part->first_batch + i]) give_zeros(part, i, call->values);
  }
  // A lattice or a plane has a kernel which gives zeros; and two threads may compute one batch.
  if (call->quiet != NULL && part->cells[0] == 0 && part->plane == NULL)
    ct_quiet_confirm(call->quiet, part, first, last, call->values);
}

static void part_gather(const ct_part_call *call, int32_t first, int32_t last)
{
  const ct_solid_part *part = call->part;
  if (part->ring > 0) ct_lattice_gather(part, call->values, first, last, call->f);
  else ct_assembly_gather(part->assembly, call->values, first, last, call->f);
}

/* Sum at those of the part's nodes first ... last - 1 that have an element which was computed. */
static void call_gather(const ct_part_call *call, int32_t first, int32_t last)
{
  int32_t shift = call->part->first_node;
  if (call->quiet == NULL) {
    part_gather(call, first, last);
    return;
  }
  for (int32_t n = shift + first, end; n < shift + last; n = end) {
    n = ct_bits_next(call->quiet->changed, n, shift + last, 1);
    end = ct_bits_next(call->quiet->changed, n, shift + last, 0);
    part_gather(call, n - shift, end - shift);
  }
}

/* One thread: sum each node as soon as its last element is there. */
static void part_force(const ct_part_call *call)
{
  const ct_solid_part *part = call->part;
  const int32_t *ready = part->ready;
  int32_t node[CT_FAMILIES];
  memcpy(node, part->family, sizeof node);
  for (int32_t b = 0; b < part->batch_count; b += CT_BLOCK) {
    call_batches(call, b, b + CT_BLOCK < part->batch_count ? b + CT_BLOCK : part->batch_count);
    if (part->assembly->extra_count > 0) continue;
    for (int k = 0; k < part->families; k++, ready++) {
      call_gather(call, node[k], *ready);
      node[k] = *ready;
    }
  }
  ct_assembly_fold(part->assembly, call->values);
  for (int k = 0; k < part->families; k++) call_gather(call, node[k], part->family[k + 1]);
}

/* The same for a range of the nodes of a body whose forces go through a ring: begin with the first
 * element that a node of the range may have. */
static void ring_force(const ct_part_call *call, int32_t first, int32_t last)
{
  const ct_solid_part *part = call->part;
  int32_t node = first;
  for (int32_t b = ct_lattice_begin(part, first) / 8, end; node < last; b = end) {
    end = b + part->block < part->batch_count ? b + part->block : part->batch_count;
    call_batches(call, b, end);
    int32_t ready = ct_lattice_ready(part, 8 * end);
    ready = ready < last ? ready : last;
    if (ready <= node) continue;
    call_gather(call, node, ready);
    node = ready;
  }
}

/* Each thread sums its share of the nodes with a ring of its own. Elements between two shares are
 * computed twice. */
static void ring_force_threads(const ct_part_call *call, int threads)
{
  int32_t nodes = call->part->mesh->node_count,
          shares = threads < call->part->rings ? threads : call->part->rings;
#ifdef _OPENMP
#pragma omp parallel for num_threads(shares) schedule(static, 1) if (shares > 1)
#endif
  for (int32_t i = 0; i < shares; i++) {
    ct_part_call own = *call;
    own.values += 24 * call->part->stride * i;
    ring_force(&own, (int32_t)((int64_t)nodes * i / shares),
               (int32_t)((int64_t)nodes * (i + 1) / shares));
  }
}

#ifdef _OPENMP
enum { NODES_AT_ONCE = 1024 };

/* Several threads: all elements, then all nodes. The sums are the same. */
static void part_force_threads(const ct_part_call *call, int threads)
{
  const ct_solid_part *part = call->part;
  int32_t batches = part->batch_count, nodes = part->mesh->node_count;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int32_t b = 0; b < batches; b += CT_BLOCK)
    call_batches(call, b, b + CT_BLOCK < batches ? b + CT_BLOCK : batches);
  ct_assembly_fold(part->assembly, call->values);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int32_t n = 0; n < nodes; n += NODES_AT_ONCE)
    call_gather(call, n, n + NODES_AT_ONCE < nodes ? n + NODES_AT_ONCE : nodes);
}
#endif

void ct_part_force(const ct_part_call *call, int threads)
{
  if (call->part->ring > 0) {
    ring_force_threads(call, threads);
    return;
  }
#ifdef _OPENMP
  if (threads > 1) {
    part_force_threads(call, threads);
    return;
  }
#endif
  part_force(call);
}

void ct_part_count_updates(const ct_part_call *call, int32_t number, int64_t updates[2])
{
  const ct_solid_part *part = call->part;
  int64_t all = part->mesh->element_count, computed = all;
  if (call->quiet != NULL && part->cells[0] > 0) computed = call->quiet->rows[number].computed;
  if (call->quiet != NULL && part->cells[0] == 0) {
    computed = 0;
    for (int32_t b = 0; b < part->batch_count; b++)
      computed += 8 * ct_quiet_computes(call->quiet, part, b);
  }
  if (computed > all) computed = all; // the last batch may have fewer than eight
  updates[0] += computed;
  updates[1] += all - computed;
}
