/* The solid effect: internal forces of all bodies. */
#include "solid.h"

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/threads.h"
#include "../base/tree.h"
#include "../solid/blocks.h"
#include "../solid/call.h"
#include "../solid/part.h"
#include "../solid/plane.h"
#include "../solid/reduced.h"

#include <math.h>
#include <string.h>

typedef struct ct_solid_data solid_data;

static void free_parts(ct_solid_part *parts, int32_t count)
{
  for (int32_t i = 0; parts != NULL && i < count; i++) ct_part_release(&parts[i]);
  ct_release(parts);
}

static void free_data(void *data)
{
  solid_data *solid = data;
  if (solid == NULL) return;
  free_parts(solid->parts, solid->part_count);
  ct_release(solid);
}

static void free_scratch(void *scratch)
{
  ct_solid_scratch *s = scratch;
  if (s == NULL) return;
  free_parts(s->parts, s->body_count);
  ct_release(s->values);
  ct_release(s->calls);
  ct_sleep_free(s->sleep);
  ct_release(s);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const solid_data *solid = effect->data;
  ct_solid_scratch *s = ct_allocate(1, sizeof *s);
  if (s != NULL) s->values = ct_allocate((size_t)solid->value_count, sizeof *s->values);
  if (s != NULL) s->calls = ct_allocate((size_t)solid->part_count, sizeof *s->calls);
  if (s == NULL || s->values == NULL || s->calls == NULL ||
      (solid->sleeps && ct_sleep_create(solid->parts, solid->part_count, &s->sleep) != CT_OK)) {
    free_scratch(s);
    return CT_NO_MEMORY(error, "the element forces");
  }
  *scratch = s;
  return CT_OK;
}

/* Compute the elements of a piece only; nothing sleeps there. */
static ct_status cut(const ct_effect *effect, const struct ct_piece *piece, void *scratch,
                     ct_error *error)
{
  const solid_data *solid = effect->data;
  ct_solid_scratch *s = scratch;
  ct_sleep_free(s->sleep);
  s->sleep = NULL;
  s->body_count = solid->part_count;
  s->touched = piece->touched;
  s->parts = ct_allocate((size_t)solid->part_count, sizeof *s->parts);
  ct_status status = s->parts == NULL ? CT_NO_MEMORY(error, "a piece") : CT_OK;
  for (int32_t i = 0; status == CT_OK && i < solid->part_count; i++)
    status = ct_part_cut(&solid->parts[i], piece->mine[i], &s->parts[i], error);
  if (status != CT_OK) return status;
  const int64_t count = ct_parts_place(s->parts, solid->part_count, &s->ring_stride);
  ct_release(s->values);
  s->values = ct_allocate((size_t)count, sizeof *s->values);
  return s->values == NULL ? CT_NO_MEMORY(error, "a piece") : CT_OK;
}

/* The task of part `i`: elements, kernel, input and output. */
static ct_part_call call_of(const solid_data *solid, int32_t i, const ct_view *view, double *force)
{
  const ct_solid_scratch *scratch = view->scratch;
  const int whole = scratch->parts == NULL;
  const ct_solid_part *part = whole ? &solid->parts[i] : &scratch->parts[i];
  const int64_t first = 3 * (int64_t)part->first_node;
  ct_part_call call =
      ct_part_task(part, view->displacement + first, scratch->values,
                   whole ? solid->ring_stride : scratch->ring_stride, force + first);
  call.batch = ct_sleep_batches(scratch->sleep, i);
  if (call.batch != NULL) call.summed = ct_sleep_summed(scratch->sleep);
  if (!whole) call.summed = scratch->touched;
  ct_plane_take(&call, scratch->values);
  call.examined = call.ring == NULL && ct_sleep_examined(scratch->sleep);
  return call;
}

static ct_status solid_force(const ct_effect *effect, const ct_view *view, double *force,
                             ct_error *error)
{
  const solid_data *solid = effect->data;
  ct_part_call *calls = ((const ct_solid_scratch *)view->scratch)->calls;
  for (int32_t i = 0; i < solid->part_count; i++) calls[i] = call_of(solid, i, view, force);
  ct_part_forces(calls, solid->part_count,
                 ct_threads_for(ct_threads_of(view->settings), solid->flops, CT_LEAST_FLOPS));
  ct_status status = CT_OK;
  for (int32_t i = 0; status == CT_OK && i < solid->part_count; i++)
    if (calls[i].part->energies != NULL)
      status = ct_solid_check_volume(calls[i].part, i, calls[i].given, calls[i].values, error);
  return status;
}

/* Energies of the elements of a batch, -½ f · (u - mean of u): the force is linear in u and not
 * changed by a translation. */
CT_CLONES
static void force_energies(const ct_solid_part *part, int32_t b, const double *u, double *values,
                           double energies[8])
{
  int per = ct_brick_node_count(part->mesh->kind);
  int64_t stride, last = part->mesh->element_count - 1;
  const double *f = ct_batch_values(part->ring, per, values, b, &stride);
  double t[3][20][8], mean[8], work[3][8];
  for (int64_t l = 0, e = 8 * (int64_t)b; l < 8; l++, e += e < last)
    for (int a = 0; a < per; a++)
      for (int c = 0; c < 3; c++)
        t[c][a][l] = u[3 * (int64_t)part->mesh->elements[per * e + a] + c];
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

/* Energies of the elements of the batches first ... last - 1, at most a block, after
 * begin_energies. */
static void block_energies(const ct_solid_part *part, int32_t first, int32_t last, const double *u,
                           double *values, double *energies)
{
  double hourglass[8], *kept = &values[part->energy_value];
  // Forces of parts with a ring were not stored and are computed once more.
  if (part->ring != NULL || part->plane != NULL) part->batches(part, first, last, u, values);
  if (part->energies != NULL)
    memcpy(energies, &kept[8 * (int64_t)first], 8 * (size_t)(last - first) * sizeof *energies);
  for (int32_t b = first; part->energies == NULL && b < last; b++, energies += 8)
    if (part->kernel == CT_KERNEL_REDUCED)
      ct_solid_reduced_energies(part, b, u, energies, hourglass);
    else force_energies(part, b, u, values, energies);
}

/* Compute the energies of large deformation once, because they are expensive. */
static void begin_energies(const ct_solid_part *part, const double *u, double *values)
{
  for (int32_t b = 0; part->energies != NULL && b < part->batch_count; b++)
    part->energies(part, b, u, &values[part->energy_value + 8 * (int64_t)b]);
}

static ct_status solid_energy(const ct_effect *effect, const ct_view *view, double *energy,
                              ct_error *error)
{
  const solid_data *solid = effect->data;
  const ct_solid_scratch *scratch = view->scratch;
  double terms[8 * CT_BLOCK];
  ct_stream sum = {0};
  int is_known = scratch->half_work != NULL && scratch->body_count == solid->part_count;
  (void)error;
  while (ct_stream_again(&sum, 1))
    for (int32_t i = 0; i < solid->part_count; i++) {
      const ct_solid_part *part = &solid->parts[i];
      const double *u = view->displacement + 3 * (int64_t)part->first_node;
      double *values = scratch->values + part->first_value;
      // -- The energy of a linear body is known from its nodal forces (eq:stored-by-forces)
      if (is_known && part->energies == NULL && part->kernel != CT_KERNEL_REDUCED) {
        ct_stream_add(&sum, &scratch->half_work[i], 1);
        continue;
      }
      ct_part_call call = {
          .part = part, .given = u, .ordered = ct_part_ordered(part, scratch->values)};
      ct_part_arrange(&call, 1, 1);
      if (call.ordered != NULL) u = call.ordered;
      if (sum.round == 1) begin_energies(part, u, values);
      for (int32_t b = 0; b < part->batch_count; b += CT_BLOCK) {
        int32_t end = b + CT_BLOCK < part->batch_count ? b + CT_BLOCK : part->batch_count;
        block_energies(part, b, end, u, values, terms);
        ct_stream_add(&sum, terms,
                      (8 * end < part->mesh->element_count ? 8 * end : part->mesh->element_count) -
                          8 * b);
      }
    }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

static ct_status solid_omega2_bound(const ct_effect *effect, const ct_view *view,
                                    double *omega_squared, ct_error *error)
{
  const solid_data *solid = effect->data;
  double largest = 0.0;
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part *part = &solid->parts[i];
    double own = part->omega_squared;
    if (part->energies != NULL && view->displacement != NULL) {
      ct_status status = ct_solid_tangent_omega2_bound(
          part, view->displacement + 3 * (int64_t)part->first_node, &own, error);
      if (status != CT_OK && error != NULL) error->body = i;
      if (status != CT_OK) return status;
    }
    largest = fmax(largest, own);
  }
  *omega_squared = largest;
  return CT_OK;
}

static ct_status solid_joint_bound(const ct_effect *effect, const struct ct_problem *problem,
                                   double dt, double stiffness, double mass, double *largest,
                                   ct_error *error)
{
  const solid_data *solid = effect->data;
  *largest = 0.0;
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part *part = &solid->parts[i];
    if (part->kernel == CT_KERNEL_RIGID) continue;
    double added[24 * 24] = {0.0}, own = INFINITY;
    ct_status status = CT_OK;
    for (int32_t k = 1; k < problem->effect_count; k++)
      if (problem->effects[k]->calls->bounds.add_element != NULL)
        problem->effects[k]->calls->bounds.add_element(problem->effects[k], part->first_node,
                                                       part->blocks.edge, dt, added);
    if (part->blocks.cells[0] > 0)
      status = ct_solid_joint_bound(part, stiffness, mass, added, &own, error);
    if (status != CT_OK) return status;
    *largest = fmax(*largest, own);
  }
  return CT_OK;
}

ct_status ct_solid_nodes_omega2(const ct_effect *effect, double *omega2, ct_error *error)
{
  const solid_data *solid = effect->data;
  for (int32_t i = 0; i < solid->part_count; i++) {
    const ct_solid_part part = ct_part_given(&solid->parts[i]);
    for (int32_t n = 0; part.kernel == CT_KERNEL_RIGID && n < part.mesh->node_count; n++)
      omega2[part.first_node + n] = INFINITY;
    if (part.kernel == CT_KERNEL_RIGID) continue;
    ct_status status = ct_solid_part_nodes_omega2(&part, &omega2[part.first_node], error);
    if (status != CT_OK && error != NULL) error->body = i;
    if (status != CT_OK) return status;
  }
  return CT_OK;
}

static ct_status prepare(solid_data *solid, const ct_solid_body *bodies, ct_error *error)
{
  solid->parts = ct_allocate((size_t)solid->part_count, sizeof *solid->parts);
  if (solid->parts == NULL) return CT_NO_MEMORY(error, "the bodies");
  int32_t next_node = 0;
  for (int32_t i = 0; i < solid->part_count; i++) {
    ct_solid_part *part = &solid->parts[i];
    ct_status status = ct_material_check(&bodies[i].material, error);
    if (status == CT_OK && bodies[i].first_node != next_node)
      status = CT_REFUSE(error, "the body begins at node %d, not %d", (int)bodies[i].first_node,
                         (int)next_node);
    if (status == CT_OK) status = ct_part_prepare(part, &bodies[i], error);
    ct_solid_part given = ct_part_given(part);
    if (status == CT_OK && part->kernel != CT_KERNEL_RIGID)
      status = ct_solid_part_omega2_bound(&given, bodies[i].fixed, &part->blocks,
                                          &part->omega_squared, error);
    if (status != CT_OK) {
      if (error != NULL) error->body = i;
      return status;
    }
    part->first_batch = solid->batch_count;
    solid->batch_count += part->batch_count;
    solid->flops += (int64_t)(part->flops * (double)part->mesh->element_count);
    solid->sleeps = solid->sleeps || part->optimisations.sleep;
    next_node += part->mesh->node_count;
  }
  solid->value_count = ct_parts_place(solid->parts, solid->part_count, &solid->ring_stride);
  return CT_OK;
}

static const ct_effect_calls CALLS = {
    .force = solid_force,
    .energy = solid_energy,
    .create_scratch = create_scratch,
    .free_scratch = free_scratch,
    .free_data = free_data,
    .bounds = {.omega2 = solid_omega2_bound, .joint = solid_joint_bound},
    .pieces = {.cut = cut}};

ct_solid_def ct_solid_def_default(void) { return (ct_solid_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_solid_create_effect(const ct_solid_def *def, const ct_problem *problem,
                                 ct_effect **effect, ct_error *error)
{
  (void)problem;
  int known = def != NULL && def->cookie == CT_DEF_COOKIE && def->bodies != NULL;
  for (int32_t i = 0; known && i < def->body_count; i++) {
    ct_status status = ct_mesh_check(def->bodies[i].mesh, error);
    if (status != CT_OK && error != NULL) error->body = i;
    if (status != CT_OK) return status;
  }
  return ct_solid_create_checked(def, effect, error);
}

ct_status ct_solid_create_checked(const ct_solid_def *def, ct_effect **effect, ct_error *error)
{
  if (def == NULL || effect == NULL || def->cookie != CT_DEF_COOKIE || def->bodies == NULL ||
      def->body_count < 1)
    return CT_REFUSE(error, "solid: no bodies, or a definition without its default");
  solid_data *solid = ct_allocate(1, sizeof *solid);
  if (solid == NULL) return CT_NO_MEMORY(error, "the solid effect");
  solid->part_count = def->body_count;
  ct_effect filled = {.kind = CT_EFFECT_SOLID, .label = "solid", .calls = &CALLS, .data = solid};
  ct_status status = prepare(solid, def->bodies, error);
  for (int32_t i = 0; status == CT_OK && i < def->body_count; i++)
    filled.node_count += def->bodies[i].mesh->node_count;
  return ct_effect_finish(status, &filled, effect, error);
}

/* Energy of the hourglass control of all parts that have one; `effect` is the solid effect. */
static ct_status hourglass_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                  ct_error *error)
{
  const solid_data *solid = effect->data;
  ct_stream sum = {0};
  (void)error;
  while (ct_stream_again(&sum, 1))
    for (int32_t i = 0; i < solid->part_count; i++) {
      const ct_solid_part part = ct_part_given(&solid->parts[i]);
      double strain[8], hourglass[8];
      for (int32_t b = 0; part.kernel == CT_KERNEL_REDUCED && b < part.batch_count; b++) {
        ct_solid_reduced_energies(&part, b, view->displacement + 3 * (int64_t)part.first_node,
                                  strain, hourglass);
        ct_stream_add(&sum, hourglass,
                      part.mesh->element_count - 8 * b < 8 ? part.mesh->element_count - 8 * b : 8);
      }
    }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

static ct_status no_force(const ct_effect *effect, const ct_view *view, double *force,
                          ct_error *error)
{
  (void)effect;
  (void)view;
  (void)force;
  (void)error;
  return CT_OK;
}

static const ct_effect_calls HOURGLASS = {
    .force = no_force, .energy = hourglass_energy, .pieces = {.cut = ct_piece_local}};

ct_status ct_solid_create_hourglass(const ct_effect *solid, ct_effect **out, ct_error *error)
{
  if (solid == NULL || out == NULL) return CT_REFUSE_NULL(error);
  if (solid->kind != CT_EFFECT_SOLID)
    return CT_REFUSE(error, "hourglass: the effect is %s, not the solid", solid->label);
  const solid_data *data = solid->data;
  int reduced = 0;
  for (int32_t i = 0; i < data->part_count; i++)
    reduced |= data->parts[i].kernel == CT_KERNEL_REDUCED;
  *out = NULL;
  if (!reduced) return CT_OK;
  ct_effect filled = {
      .kind = CT_EFFECT_HOURGLASS, .label = "hourglass", .calls = &HOURGLASS, .data = solid->data};
  return ct_effect_copy(&filled, out, error);
}

ct_status ct_solid_body_plan(const ct_effect *effect, int32_t body, ct_solid_kernel *kernel,
                             double *flops, double *bytes, ct_error *error)
{
  if (effect == NULL) return CT_REFUSE_NULL(error);
  if (effect->kind != CT_EFFECT_SOLID)
    return CT_REFUSE(error, "solid: the effect is %s, not the solid", effect->label);
  const solid_data *solid = effect->data;
  if (body < 0 || body >= solid->part_count)
    return CT_REFUSE(error, "solid: there is no body %d", (int)body);
  const ct_solid_part *part = &solid->parts[body];
  if (part->kernel == CT_KERNEL_RIGID) {
    // Its nodes are set to zero.
    if (kernel != NULL) *kernel = part->kernel;
    if (flops != NULL) *flops = 0.0;
    if (bytes != NULL) *bytes = 24.0 * part->mesh->node_count / part->mesh->element_count;
    return CT_OK;
  }
  double elements = part->mesh->element_count, per = ct_brick_node_count(part->mesh->kind);
  if (kernel != NULL) *kernel = part->kernel;
  int plane = part->kernel == CT_KERNEL_PLANE;
  double nodes = part->mesh->node_count / elements;
  // The sum at a node adds 7 numbers per component, in a plane 3 for two nodes.
  if (flops != NULL) *flops = part->flops + (plane ? 4.5 : 21.0) * nodes;
  // Bytes: node numbers of a batch, or of its first element alone if it is a row, in a plane those
  // of the lower layer; coordinates except for boxes, displacements and forces of the nodes; and
  // without a ring element forces, written once and read once, with their places.
  double rows = 0.0, numbers = plane ? 16.0 : 4.0 * per;
  for (int32_t b = 0; b < part->batch_count; b++) rows += part->rows[b];
  if (!plane) numbers *= 1.0 - 7.0 / 8.0 * rows / part->batch_count;
  // A part with its own order reads the user's numbers twice and writes displacements again; lists
  // have one number per corner.
  double order = part->order != NULL ? 32.0 * nodes : 0.0;
  if (part->ring != NULL && part->ring->list != NULL) order += 32.0 + 4.0 * nodes;
  double shape = plane || part->kernel == CT_KERNEL_BOX ? 0.0 : 24.0 * nodes,
         forces = plane || part->ring != NULL ? 0.0 : 48.0 * per + 32.0 * nodes;
  if (bytes != NULL) *bytes = numbers + shape + 48.0 * nodes + forces + order;
  return CT_OK;
}
