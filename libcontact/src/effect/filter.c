/* Zero-phase filter of recorded fields; the state does not change. */
#include <libcontact/effect.h>

#include "solid.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"
#include "../step/effect_internal.h"
#include "../step/workspace.h"

#include <math.h>
#include <string.h>

enum { MOST_PASSES = 8 };

struct ct_filter {
  ct_pool pool;
  const ct_problem *problem;
  int passes;
  double *weight;  /* D of each node, shape (node_count) [time²] */
  double *outside; /* sum of the forces from outside, shape (node_count, 3) */
  double *force;   /* shape (node_count, 3) */
  void *scratch;   /* of the solid effect */
};

/* Whether the forces of an effect act from outside through a surface, so that the stress there is
 * not zero. */
static int is_outside(const ct_effect *effect)
{
  switch (effect->kind) {
  case CT_EFFECT_CONTACT:
  case CT_EFFECT_FRICTION:
  case CT_EFFECT_OBSTACLE:
  case CT_EFFECT_MOTION:
  case CT_EFFECT_LOAD:
  case CT_EFFECT_ABSORB:
  case CT_EFFECT_TIE:
    return 1;
  case CT_EFFECT_USER:
    return effect->nodes != NULL;
  default:
    return 0;
  }
}

/* Sum of the forces from outside at each node. */
static void sum_outside(const ct_filter *filter, const ct_state *state)
{
  const ct_problem *problem = filter->problem;
  memset(filter->outside, 0, 3 * (size_t)problem->node_count * sizeof *filter->outside);
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    for (int32_t i = 0; is_outside(effect) && i < effect->node_count; i++) {
      double force[3], *sum = &filter->outside[3 * (int64_t)ct_effect_node(effect, i)];
      ct_workspace_force_at(problem, state, k, i, force);
      for (int c = 0; c < 3; c++) sum[c] += force[c];
    }
  }
}

/* Remove the component of a change along a force. */
static void hold_along(const double force[3], double change[3])
{
  double length = sqrt(ct_vector_dot(force, force)), along = 0.0;
  if (!(length > 0.0)) return;
  for (int c = 0; c < 3; c++) along += force[c] / length * change[c];
  for (int c = 0; c < 3; c++) change[c] -= along * (force[c] / length); // (eq:filter-held)
}

/* All passes over a field of the nodes, shape (node_count, 3). */
static ct_status pass(const ct_filter *filter, const ct_state *state, double *field,
                      ct_error *error)
{
  const ct_problem *problem = filter->problem;
  const ct_effect *solid = problem->effects[0];
  ct_view view = ct_workspace_view(problem, state, 0);
  view.displacement = field;
  view.scratch = filter->scratch;
  for (int i = 0; i < filter->passes; i++) {
    ct_status status = solid->calls->force(solid, &view, filter->force, error);
    if (status != CT_OK) return status;
    // -- u ← u - D Q M_L⁻¹ K u: zero for fixed components and along a force from outside
    // (eq:filter-pass)
    for (int32_t n = 0; n < problem->node_count; n++) {
      const int64_t at = 3 * (int64_t)n;
      double change[3];
      for (int c = 0; c < 3; c++)
        change[c] = filter->weight[n] * (problem->inverse_mass[at + c] * filter->force[at + c]);
      hold_along(&filter->outside[at], change);
      for (int c = 0; c < 3; c++) field[at + c] += change[c];
    }
  }
  return CT_OK;
}

ct_status ct_filter_apply(ct_filter *filter, ct_state *state, double *displacement,
                          double *velocity, ct_error *error)
{
  if (filter == NULL || state == NULL) return CT_REFUSE_NULL(error);
  if (state->node_count != filter->problem->node_count)
    return CT_REFUSE(error, "filter: the state belongs to another problem");
  // The state's own problem may have a smaller step.
  ct_status status = ct_workspace_forces(state->problem, state, error);
  if (status == CT_OK && velocity != NULL)
    status = ct_state_velocity(state->problem, state, velocity, error);
  if (status != CT_OK) return status;
  sum_outside(filter, state);
  if (velocity != NULL) status = pass(filter, state, velocity, error);
  if (status != CT_OK || displacement == NULL) return status;
  memcpy(displacement, state->displacement, 3 * (size_t)state->node_count * sizeof *displacement);
  return pass(filter, state, displacement, error);
}

void ct_filter_free(ct_filter *filter)
{
  if (filter == NULL) return;
  if (filter->scratch != NULL) filter->problem->effects[0]->calls->free_scratch(filter->scratch);
  ct_pool_free(filter);
}

static ct_status prepare(ct_filter *filter, ct_error *error)
{
  const ct_problem *problem = filter->problem;
  const ct_effect *solid = problem->effects[0];
  size_t nodes = (size_t)problem->node_count;
  filter->weight = ct_pool_take(&filter->pool, nodes, sizeof(double));
  filter->outside = ct_pool_take(&filter->pool, 3 * nodes, sizeof(double));
  filter->force = ct_pool_take(&filter->pool, 3 * nodes, sizeof(double));
  if (filter->pool.failed) return CT_NO_MEMORY(error, "the filter");
  ct_status status = ct_solid_nodes_omega2(solid, filter->weight, error);
  if (status != CT_OK) return status;
  // -- D = 1 / the largest ω² of the elements around a node (eq:filter-weight)
  for (size_t n = 0; n < nodes; n++) filter->weight[n] = 1.0 / filter->weight[n];
  return solid->calls->create_scratch(solid, &filter->scratch, error);
}

ct_status ct_filter_create(const ct_problem *problem, int passes, ct_filter **out, ct_error *error)
{
  if (out != NULL) *out = NULL;
  if (problem == NULL || out == NULL) return CT_REFUSE_NULL(error);
  if (passes < 1 || passes > MOST_PASSES)
    return CT_REFUSE(error, "filter: passes must be 1 to %d, not %d", (int)MOST_PASSES, passes);
  if (!ct_problem_is_linear(problem) || problem->effects[0]->kind != CT_EFFECT_SOLID)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "filter: all bodies must have the law \"linear\"; leave the filter out");
  ct_filter *filter = ct_allocate(1, sizeof *filter);
  if (filter == NULL) return CT_NO_MEMORY(error, "the filter");
  filter->problem = problem;
  filter->passes = passes;
  ct_status status = prepare(filter, error);
  if (status == CT_OK) *out = filter;
  else ct_filter_free(filter);
  return status;
}
