/* The forces of a state: all effects in the order of their phases. */
#include "../solid/sleep.h"
#include "constraints.h"
#include "workspace.h"

#include <string.h>

/* Count the elements whose forces the solid effect has computed and skipped. */
static void count_updates(const ct_problem *problem, ct_state *state)
{
  if (state->workspace->sleep != NULL)
    ct_sleep_count(state->workspace->sleep, state->element_updates);
  else if (problem->effects[0]->kind == CT_EFFECT_SOLID)
    for (int32_t i = 0; i < problem->body_count; i++)
      state->element_updates[0] += problem->bodies[i].mesh->element_count;
}

/* Force of one effect, added to the total. */
static ct_status add_effect(const ct_problem *problem, ct_state *state, int32_t k, ct_error *error)
{
  ct_workspace *w = state->workspace;
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, state, k);
  double *force = k == 0 ? w->total : w->force[k], begin = ct_run_seconds(problem);
  ct_status status = effect->calls->force(effect, &view, force, error);
  if (status != CT_OK) return status;
  state->effect_seconds[k] += ct_run_seconds(problem) - begin;
  if (k == 0) count_updates(problem, state);
  for (int32_t i = 0; k == 0 && i < w->shared_count; i++)
    memcpy(&w->shared_first[3 * (int64_t)i], &w->total[3 * (int64_t)w->shared[i]],
           3 * sizeof(double));
  for (int32_t i = 0; k > 0 && i < effect->node_count; i++)
    for (int c = 0; c < 3; c++)
      w->total[3 * (int64_t)ct_effect_node(effect, i) + c] += force[3 * (int64_t)i + c];
  return CT_OK;
}

/* Find the sleeping elements. The force is zero at nodes without active elements (eq:sleep). */
static void find_sleep(const ct_problem *problem, ct_state *state)
{
  ct_workspace *w = state->workspace;
  if (w->sleep == NULL) return;
  if (w->followed) {
    ct_sleep_wake(w->sleep, state->displacement);
    for (int32_t i = 0; i < w->shared_count; i++)
      memset(&w->total[3 * (int64_t)w->shared[i]], 0, 3 * sizeof(double));
  } else {
    ct_sleep_examine(w->sleep, state->displacement, state->velocity,
                     ct_stage_last_acceleration(problem, state));
    memset(w->total, 0, 3 * (size_t)problem->node_count * sizeof(double));
  }
  if (w->seen) ct_sleep_settle(w->sleep, state->displacement);
}

ct_status ct_workspace_forces(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  if (w->forces_at == state->step) return CT_OK;
  w->forces_at = -1;
  w->known = 0;
  find_sleep(problem, state);
  for (int phase = CT_PHASE_STATE; phase < CT_PHASE_REACTION; phase++) {
    ct_status status = phase == CT_PHASE_CONSTRAINT && w->constraints != NULL
                           ? ct_constraints_solve(problem, state, error)
                           : CT_OK;
    for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++)
      if ((int)problem->effects[k]->phase == phase) status = add_effect(problem, state, k, error);
    if (status != CT_OK) return status;
  }
  w->forces_at = state->step;
  w->known = 1;
  return CT_OK;
}
