/* The solid effect: internal forces of all bodies. */
#include <contact/quadrature.h>
#include <contact/solid.h>

#include "../bits.h"
#include "../error.h"
#include "../memory.h"
#include "../stream.h"
#include "../tree.h"
#include "blocks.h"
#include "lattice.h"
#include "plane.h"
#include "quiet.h"
#include "reduced.h"

#include <math.h>
#include <string.h>

/* Which function computes a block, and the operations of one element counted in it. The first row that fits is taken. */
static const struct kernel_row {
  ct_solid_kernel kernel;
  ct_brick_kind kind;
  ct_law law;
  ct_solid_batches *batches;
  ct_solid_energies *energies;
  double flops;
} KERNELS[] = {
  {CT_KERNEL_PLANE, CT_HEX8, CT_LINEAR, ct_solid_box_batches, NULL, 75.0},
  {CT_KERNEL_BOX, CT_HEX8, CT_LINEAR, ct_solid_box_batches, NULL, 393.0},
  {CT_KERNEL_BOX, CT_HEX20, CT_LINEAR, ct_solid_box20_batches, NULL, 882.0},
  {CT_KERNEL_REDUCED, CT_HEX8, CT_LINEAR, ct_solid_reduced_batches, NULL, 538.0},
  {CT_KERNEL_GENERAL, CT_HEX8, CT_LINEAR, ct_solid_hex8_batches, NULL, 2154.0},
  {CT_KERNEL_GENERAL, CT_HEX20, CT_LINEAR, ct_solid_hex20_batches, NULL, 37434.0},
  {CT_KERNEL_GENERAL, CT_HEX8, CT_ST_VENANT_KIRCHHOFF, ct_solid_large_hex8_batches, ct_solid_large_hex8_energies, 3250.0},
  {CT_KERNEL_GENERAL, CT_HEX8, CT_NEO_HOOKEAN, ct_solid_large_hex8_batches, ct_solid_large_hex8_energies, 3594.0},
  {CT_KERNEL_GENERAL, CT_HEX20, CT_ST_VENANT_KIRCHHOFF, ct_solid_large_hex20_batches, ct_solid_large_hex20_energies, 41133.0},
  {CT_KERNEL_GENERAL, CT_HEX20, CT_NEO_HOOKEAN, ct_solid_large_hex20_batches, ct_solid_large_hex20_energies, 42294.0},
};

typedef struct solid_data {
  int32_t part_count;
  ct_solid_part *parts;
  int64_t value_count;
  int64_t batch_count;
  int32_t node_count;
  int quiet; /* whether some part leaves out its quiet batches */
} solid_data;

/* Element forces of all parts, and what is known of quiet batches. */
typedef struct solid_scratch {
  double *values;
  ct_quiet quiet;
} solid_scratch;

static void free_data(void *data)
{
  solid_data *solid = data;
  if (solid == NULL) return;
  for (int32_t i = 0; solid->parts != NULL && i < solid->part_count; i++) {
    ct_release(solid->parts[i].batch_nodes);
    ct_release(solid->parts[i].gradients);
    ct_release(solid->parts[i].ready);
    ct_release(solid->parts[i].range_first);
    ct_release(solid->parts[i].ranges);
    ct_release(solid->parts[i].mean);
    ct_release(solid->parts[i].box20);
    ct_plane_free(solid->parts[i].plane);
    ct_assembly_free(solid->parts[i].assembly);
  }
  ct_release(solid->parts);
  ct_release(solid);
}

static void free_scratch(void *scratch)
{
  solid_scratch *s = scratch;
  if (s == NULL) return;
  ct_release(s->values);
  ct_quiet_free(&s->quiet);
  ct_release(s);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const solid_data *solid = effect->data;
  solid_scratch *s = ct_allocate(1, sizeof *s);
  if (s != NULL) s->values = ct_allocate((size_t)solid->value_count, sizeof *s->values);
  if (s == NULL || s->values == NULL ||
      (solid->quiet && ct_quiet_create(solid->parts, solid->part_count, solid->batch_count, solid->node_count, &s->quiet) != CT_OK)) {
    free_scratch(s);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the element forces");
  }
  // Batches that no kernel has computed are undeformed.
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part *part = &solid->parts[i];
    if (part->energies == NULL) continue;
    double *lowest = s->values + part->first_value + part->assembly->value_count;
    for (int32_t b = 0; b < part->batch_count; b++) lowest[b] = 1.0;
  }
  *scratch = s;
  return CT_OK;
}

/* One call of the force for one part. */
typedef struct part_call {
  const ct_solid_part *part;
  const double *displacement; /* of the problem */
  double *values, *f;         /* of the part */
  ct_quiet *quiet;            /* null: compute every batch, sum every node */
} part_call;

/* Let all nodes of a part be summed. */
static void sum_all(ct_quiet *quiet, const ct_solid_part *part, int32_t number)
{
  ct_bits_put(quiet->changed, part->first_node, part->first_node + part->mesh->node_count, 1);
  quiet->kept[number] &= (uint8_t)~CT_KEPT_READ;
}

/* Find which batches of part `number` are quiet, and mark the nodes of the others. */
static void find_quiet(const part_call *call, int32_t number, const ct_view *view, int32_t node_count)
{
  enum { AT_ONCE = 64 };
  const ct_solid_part *part = call->part;
  ct_quiet *quiet = call->quiet;
  if (part->cells[0] > 0) {
    int64_t b = part->first_batch;
    ct_leader *leader = view->adrift != NULL && number < view->leader_count ? &view->leaders[number] : NULL;
    ct_rows_find(&quiet->rows[number], part, view, quiet->call, leader,
                 &(ct_found){&quiet->batch[b], &quiet->read[b], &quiet->woken[b], quiet->changed, quiet->adrift, node_count});
    return;
  }
  const double *velocity = view->drifted != NULL ? view->velocity : NULL;
  int threads = view->threads, crossed = 0;
  (void)threads;
  ct_quiet_wake(quiet, part, number, view->drifted);
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static) reduction(| : crossed) if (threads > 1)
#endif
  for (int32_t b = 0; b < part->batch_count; b += AT_ONCE)
    crossed |= ct_quiet_look(quiet, part, b, b + AT_ONCE < part->batch_count ? b + AT_ONCE : part->batch_count, call->displacement, velocity);
  if (view->still == NULL) {
    // Nothing stands from before: all nodes are to be summed.
    sum_all(quiet, part, number);
    memset(&quiet->read[part->first_batch], 1, (size_t)part->batch_count);
  } else if (crossed || !(quiet->kept[number] & CT_KEPT_READ)) {
    ct_quiet_mark(quiet, part);
    quiet->kept[number] |= CT_KEPT_READ;
  }
}

/* Compute those of the batches first ... last - 1 that are not quiet. */
static void call_batches(const part_call *call, int32_t first, int32_t last)
{
  const ct_solid_part *part = call->part;
  const double *u = call->displacement + 3 * (int64_t)part->first_node;
  int32_t begin = first;
  for (int32_t b = first; call->quiet != NULL && b < last; b++) {
    if (ct_quiet_computes(call->quiet, part, b)) continue;
    if (!call->quiet->read[part->first_batch + b]) {
      // Nobody reads its forces.
    } else if (part->ring > 0)
      ct_lattice_zeros(part, b, call->values);
    else if (part->plane != NULL) // what stands there may be older than the plane
      memset(&call->values[192 * (int64_t)b], 0, 192 * sizeof(double));
    if (begin < b) part->batches(part, begin, b, u, call->values);
    begin = b + 1;
  }
  if (begin < last) part->batches(part, begin, last, u, call->values);
  // A lattice or a plane has a kernel which gives zeros; and two threads may compute one batch.
  if (call->quiet != NULL && part->cells[0] == 0 && part->plane == NULL) ct_quiet_confirm(call->quiet, part, first, last, call->values);
}

static void part_gather(const part_call *call, int32_t first, int32_t last)
{
  const ct_solid_part *part = call->part;
  if (part->ring > 0)
    ct_lattice_gather(part, call->values, first, last, call->f);
  else
    ct_assembly_gather(part->assembly, call->values, first, last, call->f);
}

/* Sum at those of the part's nodes first ... last - 1 that have an element which was computed. */
static void call_gather(const part_call *call, int32_t first, int32_t last)
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
static void part_force(const part_call *call)
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

/* The same for a range of the nodes of a body whose forces go through a ring: begin with the first element that a node of the range may have. */
static void ring_force(const part_call *call, int32_t first, int32_t last)
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

/* Each thread sums its share of the nodes with a ring of its own. Elements between two shares are computed twice. */
static void ring_force_threads(const part_call *call, int threads)
{
  int32_t nodes = call->part->mesh->node_count, shares = threads < call->part->rings ? threads : call->part->rings;
#ifdef _OPENMP
#pragma omp parallel for num_threads(shares) schedule(static, 1) if (shares > 1)
#endif
  for (int32_t i = 0; i < shares; i++) {
    part_call own = *call;
    own.values += 24 * call->part->stride * i;
    ring_force(&own, (int32_t)((int64_t)nodes * i / shares), (int32_t)((int64_t)nodes * (i + 1) / shares));
  }
}

#ifdef _OPENMP
enum { NODES_AT_ONCE = 1024 };

/* Several threads: all elements, then all nodes. The sums are the same. */
static void part_force_threads(const part_call *call, int threads)
{
  const ct_solid_part *part = call->part;
  int32_t batches = part->batch_count, nodes = part->mesh->node_count;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int32_t b = 0; b < batches; b += CT_BLOCK) call_batches(call, b, b + CT_BLOCK < batches ? b + CT_BLOCK : batches);
  ct_assembly_fold(part->assembly, call->values);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int32_t n = 0; n < nodes; n += NODES_AT_ONCE) call_gather(call, n, n + NODES_AT_ONCE < nodes ? n + NODES_AT_ONCE : nodes);
}
#endif

/* Count the elements of part number `number` that a call computes, and those that it leaves out. */
static void count_updates(const part_call *call, int32_t number, int64_t updates[2])
{
  const ct_solid_part *part = call->part;
  int64_t all = part->mesh->element_count, computed = all;
  if (call->quiet != NULL && part->cells[0] > 0) computed = call->quiet->rows[number].computed;
  if (call->quiet != NULL && part->cells[0] == 0) {
    computed = 0;
    for (int32_t b = 0; b < part->batch_count; b++) computed += 8 * ct_quiet_computes(call->quiet, part, b);
  }
  if (computed > all) computed = all; // the last batch may have fewer than eight
  updates[0] += computed;
  updates[1] += all - computed;
}

static ct_status solid_force(const ct_effect *effect, const ct_view *view, double *force, ct_error *error)
{
  const solid_data *solid = effect->data;
  solid_scratch *scratch = view->scratch;
  ct_status status = CT_OK;
  scratch->quiet.call = (scratch->quiet.call + 1) % 8;
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part *part = &solid->parts[i];
    part_call call = {part, view->displacement, scratch->values + part->first_value, force + 3 * (int64_t)part->first_node,
                      part->savings.quiet ? &scratch->quiet : NULL};
    const double *u = view->displacement + 3 * (int64_t)part->first_node;
    int plane = part->plane != NULL && ct_plane_holds(part, u, solid->quiet && view->adrift != NULL ? scratch->quiet.adrift : NULL);
    // In a plane this costs less than to find batches that are quiet, but more than to find rows.
    if (plane && part->cells[0] == 0) call.quiet = NULL;
    if (solid->quiet && call.quiet == NULL) sum_all(&scratch->quiet, part, i);
    if (call.quiet != NULL) find_quiet(&call, i, view, solid->node_count);
    if (view->element_updates != NULL) count_updates(&call, i, view->element_updates);
    if (plane) {
      ct_plane_force(part, u, view->threads, call.quiet, scratch->values, call.f);
      continue;
    }
    if (part->ring > 0) {
      ring_force_threads(&call, view->threads);
      continue;
    }
#ifdef _OPENMP
    if (view->threads > 1)
      part_force_threads(&call, view->threads);
    else
#endif
      part_force(&call);
    if (status == CT_OK && part->energies != NULL) status = ct_solid_check_volume(part, i, u, call.values, error);
  }
  for (int64_t w = 0; view->adrift != NULL && solid->quiet && w < ct_bits_words(solid->node_count); w++) view->adrift[w] = scratch->quiet.adrift[w];
  // -- A node whose elements were all skipped has the same zero force as before (eq:still-node)
  for (int64_t w = 0; solid->quiet && view->still != NULL && w < ct_bits_words(solid->node_count); w++) view->still[w] = ~scratch->quiet.changed[w];
  return status;
}

/* Energies of the elements of a batch, -½ f · (u - mean of u): the force is linear in u and blind to a translation. */
CT_INLINE void force_energies(const ct_solid_part *part, int per, int32_t b, const double *u, double *values, double energies[8])
{
  int64_t stride, last = part->mesh->element_count - 1;
  const double *f = ct_batch_values(part, values, b, &stride);
  double t[3][20][8], mean[8], work[3][8];
  for (int64_t l = 0, e = 8 * (int64_t)b; l < 8; l++, e += e < last)
    for (int a = 0; a < per; a++)
      for (int c = 0; c < 3; c++) t[c][a][l] = u[3 * (int64_t)part->mesh->elements[per * e + a] + c];
  for (int c = 0; c < 3; c++) {
#pragma omp simd
    for (int l = 0; l < 8; l++) mean[l] = ct_tree_corners(&t[c][0][l], 8) / 8.0;
    for (int a = 0; a < per; a++)
#pragma omp simd
      for (int l = 0; l < 8; l++) t[c][a][l] = f[(3 * a + c) * stride + l] * (t[c][a][l] - mean[l]);
#pragma omp simd
    for (int l = 0; l < 8; l++) work[c][l] = ct_tree_nodes(per, &t[c][0][l], 8);
  }
#pragma omp simd
  for (int l = 0; l < 8; l++) energies[l] = -0.5 * ((work[0][l] + work[1][l]) + work[2][l]);
}

CT_CLONES
static void hex8_energies(const ct_solid_part *part, int32_t b, const double *u, double *values, double energies[8])
{
  force_energies(part, 8, b, u, values, energies);
}

CT_CLONES
static void hex20_energies(const ct_solid_part *part, int32_t b, const double *u, double *values, double energies[8])
{
  force_energies(part, 20, b, u, values, energies);
}

/* Energies of the elements of the batches first ... last - 1, no more than a block, after begin_energies. */
static void block_energies(const ct_solid_part *part, int32_t first, int32_t last, const double *u, double *values,
                           double *energies)
{
  double hourglass[8], *kept = &values[part->energy_value];
  // Forces that went through a ring are made once more.
  if (part->ring > 0) part->batches(part, first, last, u, values);
  if (part->energies != NULL) memcpy(energies, &kept[8 * (int64_t)first], 8 * (size_t)(last - first) * sizeof *energies);
  for (int32_t b = first; part->energies == NULL && b < last; b++, energies += 8)
    if (part->mean != NULL) ct_solid_reduced_energies(part, b, u, energies, hourglass);
    else if (part->mesh->kind == CT_HEX8) hex8_energies(part, b, u, values, energies);
    else hex20_energies(part, b, u, values, energies);
}

/* What would cost too much to be made twice: the energies of large deformation. And the forces of the bricks of a plane, whose own stand
 * elsewhere. */
static void begin_energies(const ct_solid_part *part, const double *u, double *values)
{
  if (part->plane != NULL && part->ring == 0) part->batches(part, 0, part->batch_count, u, values);
  for (int32_t b = 0; part->energies != NULL && b < part->batch_count; b++)
    part->energies(part, b, u, &values[part->energy_value + 8 * (int64_t)b]);
}

static ct_status solid_energy(const ct_effect *effect, const ct_view *view, double *energy, ct_error *error)
{
  const solid_data *solid = effect->data;
  double terms[8 * CT_BLOCK];
  ct_stream sum = {0};
  (void)error;
  while (ct_stream_again(&sum, 1))
    for (int32_t i = 0; i < solid->part_count; i++) {
      const ct_solid_part *part = &solid->parts[i];
      const double *u = view->displacement + 3 * (int64_t)part->first_node;
      double *values = ((const solid_scratch *)view->scratch)->values + part->first_value;
      if (sum.round == 1) begin_energies(part, u, values);
      for (int32_t b = 0; b < part->batch_count; b += CT_BLOCK) {
        int32_t end = b + CT_BLOCK < part->batch_count ? b + CT_BLOCK : part->batch_count;
        block_energies(part, b, end, u, values, terms);
        ct_stream_add(&sum, terms, (8 * end < part->mesh->element_count ? 8 * end : part->mesh->element_count) - 8 * b);
      }
    }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

static ct_status solid_frequency(const ct_effect *effect, const ct_view *view, double *omega_squared, ct_error *error)
{
  const solid_data *solid = effect->data;
  double largest = 0.0;
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part *part = &solid->parts[i];
    double own = part->omega_squared;
    if (part->energies != NULL && view->displacement != NULL) {
      ct_status status = ct_solid_tangent_frequency(part, view->displacement + 3 * (int64_t)part->first_node, &own, error);
      if (status != CT_OK && error != NULL) error->body = i;
      if (status != CT_OK) return status;
    }
    largest = fmax(largest, own);
  }
  *omega_squared = largest;
  return CT_OK;
}

static ct_status prepare_gradients(ct_solid_part *part)
{
  ct_rule rule;
  part->gradients = ct_allocate(27, sizeof *part->gradients);
  if (part->gradients == NULL) return CT_ERROR_MEMORY;
  ct_rule_brick(part->mesh->kind, &rule);
  for (int q = 0; q < rule.count; q++) ct_brick_gradient(part->mesh->kind, rule.xi[q], part->gradients[q]);
  return CT_OK;
}

/* Families of nodes whose numbers each follow the elements: corners, and the mid-sides along ξ, η, ζ where these stand apart, one
 * after another, as ct_mesh_create_box numbers them; else all nodes are one. */
static void find_families(ct_solid_part *part)
{
  const ct_mesh *mesh = part->mesh;
  int32_t high[CT_FAMILIES] = {-1, -1, -1, -1};
  int64_t per = ct_brick_node_count(mesh->kind);
  int apart = mesh->kind == CT_HEX20;
  for (int k = 0; k < CT_FAMILIES; k++) part->family[k] = mesh->node_count;
  for (int64_t i = 0; apart && i < per * mesh->element_count; i++) {
    int32_t n = mesh->elements[i];
    int a = (int)(i % per), k = a < 8 ? 0 : a < 16 ? 1 + a % 2 : 3;
    part->family[k] = n < part->family[k] ? n : part->family[k];
    high[k] = n > high[k] ? n : high[k];
  }
  for (int k = 0; k + 1 < CT_FAMILIES; k++) apart = apart && high[k] < part->family[k + 1];
  part->families = apart ? CT_FAMILIES : 1;
  part->family[0] = 0;
  part->family[part->families] = mesh->node_count;
}

/* What hex20 elements share: the constants of a box, or the gradients at the Gauss points. */
static ct_status prepare_hex20(ct_solid_part *part)
{
  return part->kernel == CT_KERNEL_BOX ? ct_box20_prepare(part) : prepare_gradients(part);
}

/* Find for each block of batches and each family how many of its nodes, from the first on, have all their elements by then. */
static ct_status prepare_ready(ct_solid_part *part)
{
  const ct_mesh *mesh = part->mesh;
  int32_t blocks = (part->batch_count + CT_BLOCK - 1) / CT_BLOCK, node[CT_FAMILIES];
  size_t per = (size_t)ct_brick_node_count(mesh->kind), count = 0;
  find_families(part);
  int32_t *last = ct_allocate((size_t)mesh->node_count, sizeof *last);
  part->ready = ct_allocate((size_t)blocks * (size_t)part->families, sizeof *part->ready);
  if (last == NULL || part->ready == NULL) {
    ct_release(last);
    return CT_ERROR_MEMORY;
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (size_t a = 0; a < per; a++) last[mesh->elements[(size_t)e * per + a]] = e;
  memcpy(node, part->family, sizeof node);
  for (int32_t block = 0; block < blocks; block++)
    for (int k = 0; k < part->families; k++) {
      while (node[k] < part->family[k + 1] && last[node[k]] / (8 * CT_BLOCK) <= block) node[k]++;
      part->ready[count++] = node[k];
    }
  ct_release(last);
  return CT_OK;
}

/* Take the kernel of the plane where it fits: one layer of boxes held along its thickness. */
static ct_status choose_plane(ct_solid_part *part, const ct_solid_block *block, int box, ct_error *error)
{
  int wanted = block->kernel == CT_KERNEL_PLANE || (block->kernel == CT_KERNEL_AUTO && part->savings.plane_strain);
  for (int axis = 0; wanted && box && part->mesh->kind == CT_HEX8 && part->plane == NULL && axis < 3; axis++)
    if (block->held[axis] && ct_plane_create(part, axis, part->rings, &part->plane) != CT_OK) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  if (part->plane != NULL) part->kernel = CT_KERNEL_PLANE;
  if (block->kernel == CT_KERNEL_PLANE && part->plane == NULL)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the plane kernel needs one layer of hex8 boxes whose nodes are all held along its thickness");
  return CT_OK;
}

/* The kernel that is asked for, or the cheapest that fits. */
static ct_status choose_kernel(ct_solid_part *part, const ct_solid_block *block, ct_error *error)
{
  ct_solid_kernel asked = block->kernel;
  int large = part->material.law != CT_LINEAR, box = !large && ct_solid_is_box(part->mesh, part->edge);
  if (asked == CT_KERNEL_BOX && large)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the box kernel is for small strain; large deformation has the general one");
  if (asked == CT_KERNEL_BOX && !box)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "the box kernel needs rectangular elements of one size, with nodes in the middle of straight edges");
  if (asked == CT_KERNEL_REDUCED && (large || part->mesh->kind != CT_HEX8))
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE, "reduced integration with hourglass control is for hex8 and small strain");
  if (!(part->hourglass > 0.0) || !isfinite(part->hourglass))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "the hourglass coefficient must be positive, not %g", part->hourglass);
  part->kernel = asked == CT_KERNEL_AUTO ? (box ? CT_KERNEL_BOX : CT_KERNEL_GENERAL) : asked;
  int boxes = part->kernel == CT_KERNEL_BOX || part->kernel == CT_KERNEL_PLANE;
  if (boxes && (part->savings.congruent || part->savings.quiet)) ct_lattice_find(part->mesh, part);
  ct_status status = choose_plane(part, block, box, error);
  for (size_t k = 0; part->batches == NULL && k < sizeof KERNELS / sizeof KERNELS[0]; k++) {
    const struct kernel_row *row = &KERNELS[k];
    if (row->kernel != part->kernel || row->kind != part->mesh->kind || row->law != part->material.law) continue;
    part->batches = row->batches;
    part->energies = row->energies;
    part->flops = row->flops;
  }
  return status;
}

void ct_solid_batch_nodes(const ct_mesh *mesh, int32_t *batch_nodes)
{
  int32_t per = ct_brick_node_count(mesh->kind);
  for (int32_t b = 0; b < (mesh->element_count + 7) / 8; b++)
    for (int32_t a = 0; a < per; a++)
      for (int32_t l = 0; l < 8; l++) {
        int32_t e = 8 * b + l < mesh->element_count ? 8 * b + l : mesh->element_count - 1;
        batch_nodes[(b * per + a) * 8 + l] = mesh->elements[e * per + a];
      }
}

static ct_status prepare_part(ct_solid_part *part, const ct_solid_block *block, ct_error *error)
{
  int32_t per = ct_brick_node_count(block->mesh->kind);
  part->mesh = block->mesh;
  part->material = block->material;
  part->lumping = block->lumping;
  part->savings = block->savings == NULL ? ct_savings_default() : *block->savings;
  part->first_node = block->first_node;
  ct_material_lame(&part->material, &part->lambda, &part->mu);
  part->hourglass = block->hourglass == 0.0 ? ct_solid_hourglass_default() : block->hourglass;
  part->batch_count = (part->mesh->element_count + 7) / 8;
  part->rings = block->threads < 1 ? 1 : block->threads < CT_MOST_RINGS ? block->threads : CT_MOST_RINGS;
  ct_status status = choose_kernel(part, block, error);
  if (status != CT_OK) return status;
  if (part->cells[0] > 0 && part->savings.congruent) {
    part->value_count = ct_lattice_prepare(part);
    return CT_OK;
  }
  part->batch_nodes = ct_allocate((size_t)part->batch_count * 8 * (size_t)per, sizeof *part->batch_nodes);
  if (part->batch_nodes == NULL || prepare_ready(part) != CT_OK || (part->mesh->kind == CT_HEX20 && prepare_hex20(part) != CT_OK))
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  ct_solid_batch_nodes(part->mesh, part->batch_nodes);
  if ((part->savings.quiet && part->cells[0] == 0 && ct_quiet_prepare(part) != CT_OK) || (part->kernel == CT_KERNEL_REDUCED && ct_reduced_prepare(part) != CT_OK))
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the elements");
  status = ct_assembly_create(part->mesh, 3, &part->assembly, error);
  if (status != CT_OK) return status;
  part->energy_value = part->assembly->value_count + (part->batch_count + 7) / 8 * 8;
  part->value_count = part->energies != NULL ? part->energy_value + 8 * (int64_t)part->batch_count : part->assembly->value_count;
  return status;
}

/* Find where the values of each part begin. What goes through a ring is read before the next part is computed: all rings are one. */
static void place_values(solid_data *solid)
{
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part *part = &solid->parts[i];
    int64_t bricks = part->ring > 0 ? part->value_count : 0, plane = part->plane != NULL ? part->plane->value_count : 0;
    if (bricks > solid->value_count) solid->value_count = bricks;
    if (plane > solid->value_count) solid->value_count = plane;
  }
  for (int32_t i = 0; i < solid->part_count; i++) {
    ct_solid_part *part = &solid->parts[i];
    if (part->ring > 0) continue;
    part->first_value = solid->value_count;
    solid->value_count += part->value_count;
  }
}

static ct_status prepare(solid_data *solid, const ct_solid_block *blocks, ct_error *error)
{
  solid->parts = ct_allocate((size_t)solid->part_count, sizeof *solid->parts);
  if (solid->parts == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the bodies");
  int32_t next_node = 0;
  for (int32_t i = 0; i < solid->part_count; i++) {
    ct_solid_part *part = &solid->parts[i];
    ct_status status = ct_material_check(&blocks[i].material, error);
    if (status == CT_OK) status = ct_mesh_check(blocks[i].mesh, error);
    if (status == CT_OK && blocks[i].first_node != next_node)
      status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "the body begins at node %d, not %d", (int)blocks[i].first_node, (int)next_node);
    if (status == CT_OK) status = prepare_part(part, &blocks[i], error);
    if (status == CT_OK) status = ct_solid_part_frequency(part, blocks[i].held, &part->omega_squared, error);
    if (status != CT_OK) {
      if (error != NULL) error->body = i;
      return status;
    }
    part->first_batch = solid->batch_count;
    solid->batch_count += part->batch_count;
    solid->quiet = solid->quiet || part->savings.quiet;
    next_node += part->mesh->node_count;
  }
  solid->node_count = next_node;
  place_values(solid);
  return CT_OK;
}

ct_status ct_solid_create_effect(const ct_solid_block *blocks, int32_t block_count, ct_effect **out, ct_error *error)
{
  if (blocks == NULL || block_count < 1 || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "solid: no bodies");
  ct_effect *effect = ct_allocate(1, sizeof *effect);
  solid_data *solid = ct_allocate(1, sizeof *solid);
  if (effect == NULL || solid == NULL) {
    ct_release(effect);
    ct_release(solid);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the solid effect");
  }
  solid->part_count = block_count;
  *effect = (ct_effect){.name = "solid", .data = solid, .create_scratch = create_scratch, .free_scratch = free_scratch,
                        .force = solid_force, .energy = solid_energy, .frequency = solid_frequency, .free_data = free_data};
  ct_status status = prepare(solid, blocks, error);
  if (status != CT_OK) {
    ct_effect_free(effect);
    return status;
  }
  for (int32_t i = 0; i < block_count; i++) effect->node_count += blocks[i].mesh->node_count;
  *out = effect;
  return CT_OK;
}

/* Energy of the hourglass control of all parts that have one; `effect` looks at the data of the solid effect. */
static ct_status hourglass_energy(const ct_effect *effect, const ct_view *view, double *energy, ct_error *error)
{
  const solid_data *solid = effect->data;
  ct_stream sum = {0};
  (void)error;
  while (ct_stream_again(&sum, 1))
    for (int32_t i = 0; i < solid->part_count; i++) {
      const ct_solid_part *part = &solid->parts[i];
      double strain[8], hourglass[8];
      for (int32_t b = 0; part->mean != NULL && b < part->batch_count; b++) {
        ct_solid_reduced_energies(part, b, view->displacement + 3 * (int64_t)part->first_node, strain, hourglass);
        ct_stream_add(&sum, hourglass, part->mesh->element_count - 8 * b < 8 ? part->mesh->element_count - 8 * b : 8);
      }
    }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

static ct_status no_force(const ct_effect *effect, const ct_view *view, double *force, ct_error *error)
{
  (void)effect;
  (void)view;
  (void)force;
  (void)error;
  return CT_OK;
}

ct_status ct_solid_create_hourglass(const ct_effect *solid, ct_effect **out, ct_error *error)
{
  if (solid == NULL || solid->force != solid_force || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "hourglass: null argument or no solid effect");
  const solid_data *data = solid->data;
  int reduced = 0;
  for (int32_t i = 0; i < data->part_count; i++) reduced |= data->parts[i].mean != NULL;
  *out = NULL;
  if (!reduced) return CT_OK;
  ct_effect *effect = ct_allocate(1, sizeof *effect);
  if (effect == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the hourglass effect");
  *effect = (ct_effect){.name = "hourglass", .local = 1, .data = solid->data, .force = no_force, .energy = hourglass_energy};
  *out = effect;
  return CT_OK;
}

double ct_solid_hourglass_default(void) { return 1.0; }

ct_status ct_solid_block_plan(const ct_effect *effect, int32_t block, ct_solid_kernel *kernel, double *flops, double *bytes)
{
  if (effect == NULL || effect->force != solid_force || block < 0) return CT_ERROR_ARGUMENT;
  const solid_data *solid = effect->data;
  if (block >= solid->part_count) return CT_ERROR_ARGUMENT;
  const ct_solid_part *part = &solid->parts[block];
  double elements = part->mesh->element_count, per = ct_brick_node_count(part->mesh->kind);
  if (kernel != NULL) *kernel = part->kernel;
  int plane = part->kernel == CT_KERNEL_PLANE;
  double nodes = part->mesh->node_count / elements;
  // The gather adds 7 sums a component and node, in a plane 3 for two nodes.
  if (flops != NULL) *flops = part->flops + (plane ? 4.5 : 21.0) * nodes;
  // Node numbers and element forces written once and read once; what is laid down; displacements and forces of the nodes, and the gather's places.
  // A lattice has no node numbers and no places, and its forces stay in the cache; a plane has the numbers of its lower layer.
  double laid_down = part->mean != NULL ? 256.0 : 0.0;
  if (bytes != NULL) *bytes = plane ? 16.0 + 48.0 * nodes : part->ring > 0 ? 48.0 * nodes : 52.0 * per + laid_down + 80.0 * nodes;
  return CT_OK;
}
