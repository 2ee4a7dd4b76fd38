/* Damping proportional to stiffness. */
#include <libcontact/effect.h>

#include "../base/error.h"
#include "../base/threads.h"
#include "../solid/call.h"
#include "../solid/plane.h"
#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "solid.h"

#include <math.h>

typedef struct damping_data {
  ct_pool pool;
  int32_t part_count;
  ct_solid_part *parts; /* of the solid effect, which owns what they point to */
  double *coefficient;  /* of each part */
  int32_t *nodes;
  int64_t value_count, ring_stride, flops;
} damping_data;

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const damping_data *d = effect->data;
  *scratch = ct_allocate((size_t)d->value_count, sizeof(double));
  return *scratch != NULL ? CT_OK : CT_NO_MEMORY(error, "the damping forces");
}

/* Multiply the forces of a part by its coefficient. */
CT_CLONES
static void scale(int64_t count, double coefficient, double *restrict force)
{
#pragma omp simd
  // -- β times -K v, from the kernel that computes -K u (eq:stiffness-damping-force)
  for (int64_t d = 0; d < count; d++) force[d] = coefficient * force[d];
}

static ct_status damping_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const damping_data *d = effect->data;
  const int threads = ct_threads_for(ct_threads_of(view->settings), d->flops, CT_LEAST_FLOPS);
  (void)error;
  for (int32_t i = 0; i < d->part_count; i++) {
    const ct_solid_part *part = &d->parts[i];
    const int64_t dofs = 3 * (int64_t)part->mesh->node_count;
    ct_part_call call = ct_part_task(part, view->velocity + 3 * (int64_t)part->first_node,
                                     view->scratch, d->ring_stride, force);
    ct_plane_take(&call, view->scratch);
    ct_part_forces(&call, 1, threads);
    scale(dofs, d->coefficient[i], force);
    force += dofs;
  }
  return CT_OK;
}

/* The largest rate of a mode. */
static ct_status damping_rate(const ct_effect *effect, const ct_view *view, double *rate,
                              ct_error *error)
{
  const damping_data *d = effect->data;
  (void)view, (void)error;
  *rate = 0.0;
  // -- β times the largest ω² of each body (eq:stiffness-damping-bound)
  for (int32_t i = 0; i < d->part_count; i++)
    *rate = fmax(*rate, d->coefficient[i] * d->parts[i].omega_squared);
  return CT_OK;
}

static ct_status check(const ct_stiffness_damping_def *def, const ct_problem *problem,
                       ct_error *error)
{
  double most = 0.0;
  if (def->solid == NULL || def->coefficients == NULL) return CT_REFUSE_NULL(error);
  if (def->solid->kind != CT_EFFECT_SOLID)
    return CT_REFUSE(error, "damping: the effect is %s, not the solid", def->solid->label);
  for (int32_t i = 0; i < problem->body_count; i++) {
    const double coefficient = def->coefficients[i];
    const ct_place place = {i, -1, -1};
    if (!(coefficient >= 0.0) || !isfinite(coefficient))
      return ct_fail(error, CT_INVALID, place,
                     "damping: stiffness must be 0 or positive and finite, not %g", coefficient);
    if (coefficient > 0.0 && problem->bodies[i].material.law != CT_LINEAR)
      return ct_fail(error, CT_ERROR_UNSUPPORTED, place,
                     "damping: body %s is not linear; damping in proportion to stiffness is for "
                     "the law \"linear\", so give a rate, or bodies without this one",
                     problem->bodies[i].name);
    most = fmax(most, coefficient);
  }
  return most > 0.0 ? CT_OK : CT_REFUSE(error, "damping: stiffness is 0 for all bodies");
}

/* The damped bodies in the order of their nodes. */
static ct_status prepare(damping_data *d, const ct_stiffness_damping_def *def,
                         const ct_problem *problem, int32_t *node_count, ct_error *error)
{
  const ct_solid_data *solid = def->solid->data;
  const size_t count = (size_t)problem->body_count;
  d->parts = ct_pool_take(&d->pool, count, sizeof *d->parts);
  d->coefficient = ct_pool_take(&d->pool, count, sizeof *d->coefficient);
  int32_t *bodies = ct_pool_take(&d->pool, count, sizeof *bodies);
  if (d->pool.failed) return CT_NO_MEMORY(error, "the damping");
  for (int32_t i = 0; i < problem->body_count; i++) {
    if (def->coefficients[i] == 0.0) continue;
    bodies[d->part_count] = i;
    d->coefficient[d->part_count] = def->coefficients[i];
    d->parts[d->part_count++] = solid->parts[i];
    d->flops += (int64_t)(solid->parts[i].flops * solid->parts[i].mesh->element_count);
  }
  d->value_count = ct_parts_place(d->parts, d->part_count, &d->ring_stride);
  return ct_effect_body_nodes(problem, bodies, d->part_count, "damping", &d->pool, &d->nodes,
                              node_count, error);
}

static const ct_effect_calls CALLS = {.force = damping_force,
                                      .create_scratch = create_scratch,
                                      .free_scratch = ct_release,
                                      .free_data = ct_pool_free,
                                      .bounds = {.rate = damping_rate},
                                      .pieces = {.cut = ct_piece_local}};

ct_stiffness_damping_def ct_stiffness_damping_def_default(void)
{
  return (ct_stiffness_damping_def){.cookie = CT_DEF_COOKIE};
}

ct_status ct_stiffness_damping_create_effect(const ct_stiffness_damping_def *def,
                                             const ct_problem *problem, ct_effect **effect,
                                             ct_error *error)
{
  ct_status status;
  damping_data *d = ct_effect_begin(def, problem, effect, "damping", sizeof *d, &status, error);
  if (d == NULL) return status;
  ct_effect filled = {
      .kind = CT_EFFECT_STIFFNESS_DAMPING, .label = "damping", .calls = &CALLS, .data = d};
  status = check(def, problem, error);
  if (status == CT_OK) status = prepare(d, def, problem, &filled.node_count, error);
  filled.nodes = d->nodes;
  filled.cost.flops = (double)d->flops + 3.0 * filled.node_count;
  // Bytes of velocities, read, and of forces, read and written; those of the elements are those of
  // the solid.
  filled.cost.bytes = 72.0 * filled.node_count;
  return ct_effect_finish(status, &filled, effect, error);
}
