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

/* Move the nodes for Δt_c by the known forces, and store the resulting change of acceleration in
 * the bodies as the last acceleration of the drift. */
static ct_status push_and_pull(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  const ct_effect *solid = problem->effects[0];
  ct_stage stages[2];
  ct_integrator_stages(&problem->integrator, stages);
  // A contact at t = 0 has changed the velocity at half a step by forces that are unknown here, so
  // the first step is a central difference.
  if (!ct_scheme_of(problem)->pushforward || stages[0].l == 0.0 || state->step == 0) return CT_OK;
  double begin = ct_run_seconds(problem),
         pushforward = problem->integrator.pushforward_ratio * problem->dt,
         share = ct_integrator_share(&problem->integrator) * problem->dt;
  // -- u* - u_n = Δt_c v_n + ½ Δt_c² a_n, and M⁻¹ f(u* - u_n) = a* - a_n (eq:pullback-push)
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++)
    w->pushed[d] = pushforward * ct_kick(state->velocity[d], share + 0.5 * pushforward,
                                         problem->inverse_mass[d], w->total[d]);
  ct_view view = ct_workspace_view(problem, state, 0);
  view.displacement = w->pushed;
  view.scratch = w->pushed_scratch;
  ct_status status = solid->calls->force(solid, &view, w->pushed_force, error);
  // -- In the place of the acceleration before: a_n - a* (eq:pullback-drift)
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++)
    w->last_acceleration[d] = -(problem->inverse_mass[d] * w->pushed_force[d]);
  count_updates(problem, state);
  state->effect_seconds[0] += ct_run_seconds(problem) - begin;
  return status;
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
    if (status == CT_OK && phase == CT_PHASE_STATE) status = push_and_pull(problem, state, error);
    if (status != CT_OK) return status;
  }
  w->forces_at = state->step;
  w->known = 1;
  return CT_OK;
}
