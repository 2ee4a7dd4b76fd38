/* One call of the force for one body: compute what is active, sum at the nodes while the forces
 * are in the cache. */
#include "call.h"

#include "lattice.h"

#include <string.h>

/* Let the forces of a batch that is left out be the zeros that they are. */
static void clear_batch(const ct_solid_part *part, int32_t b, double *values)
{
  int rows = 3 * ct_brick_node_count(part->mesh->kind);
  int64_t stride;
  double *v = ct_batch_values(part, values, b, &stride);
  for (int i = 0; i < rows; i++) memset(&v[i * stride], 0, 8 * sizeof *v);
  if (part->energies != NULL) values[part->assembly->value_count + b] = 1.0;
}

/* Compute those of the batches first ... last - 1 that are active. */
static void call_batches(const ct_part_call *call, int32_t first, int32_t last)
{
  for (int32_t b = first, end; b < last; b = end) {
    end = ct_call_run(call, b, last);
    if (ct_call_computes(call, b))
      call->part->batches(call->part, b, end, call->displacement, call->values);
    else
      for (int32_t i = b; i < end; i++)
        if (ct_call_clears(call, i)) clear_batch(call->part, i, call->values);
  }
}

static void part_gather(const ct_part_call *call, int32_t first, int32_t last)
{
  const ct_solid_part *part = call->part;
  if (part->ring > 0) ct_lattice_gather(part, call->values, first, last, call->f);
  else ct_assembly_gather(part->assembly, call->values, first, last, call->f);
}

/* Sum at those of the part's nodes first ... last - 1 that have an active element. */
static void call_gather(const ct_part_call *call, int32_t first, int32_t last)
{
  for (int32_t n = first, end; n < last; n = end) {
    end = ct_call_nodes(call, &n, last);
    part_gather(call, n, end);
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
