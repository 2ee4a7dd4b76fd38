/* The largest stable time step of a problem, and what bounds it. */
#include <libcontact/step.h>

#include "../base/error.h"
#include "workspace.h"

#include <math.h>

enum { FIXED_POINT_ROUNDS = 64 };

double ct_problem_edge(const ct_problem *problem)
{
  double edge = INFINITY;
  for (int32_t i = 0; i < problem->body_count; i++)
    edge = fmin(edge, ct_mesh_shortest_edge(problem->bodies[i].mesh));
  return edge;
}

int ct_problem_is_linear(const ct_problem *problem)
{
  for (int32_t i = 0; i < problem->body_count; i++)
    if (problem->bodies[i].material.law != CT_LINEAR) return 0;
  return 1;
}

ct_status ct_stable_share(const ct_problem *problem, ct_state *state, int32_t k,
                          double *omega_squared, double *rate, ct_error *error)
{
  if (problem == NULL || state == NULL || omega_squared == NULL || rate == NULL || k < 0 ||
      k >= problem->effect_count)
    return CT_REFUSE(error, "stable step: null argument or no effect %d", (int)k);
  const ct_effect *effect = problem->effects[k];
  *omega_squared = *rate = 0.0;
  ct_status status = ct_stage_check(state, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  ct_view view = ct_workspace_view(problem, state, k);
  if (effect->omega2_bound != NULL)
    status = effect->omega2_bound(effect, &view, omega_squared, error);
  if (status == CT_OK && effect->rate_bound != NULL)
    status = effect->rate_bound(effect, &view, rate, error);
  if (status == CT_OK && !(*omega_squared >= 0.0 && *rate >= 0.0))
    return CT_REFUSE(error, "stable step: effect %s has the bounds %g and %g, which are none",
                     effect->label, *omega_squared, *rate);
  // -- The bound of the elements may be far above the whole (eq:assembled-bound)
  if (status == CT_OK && k == 0 && problem->assembled) {
    double whole = INFINITY;
    status = ct_stable_assembled(problem, state, &whole, error);
    if (status == CT_ERROR_UNSUPPORTED) status = CT_OK;
    *omega_squared = fmin(*omega_squared, whole);
  }
  return status;
}

/* Whether an effect of this kind acts only where something touches. */
static int is_contact(ct_effect_kind kind)
{
  return kind == CT_EFFECT_CONTACT || kind == CT_EFFECT_FRICTION || kind == CT_EFFECT_OBSTACLE;
}

/* What bounds the step of all effects, and of all but the contacts: sums of ω² and of the damping
 * rate. */
static ct_status sum_bounds(const ct_problem *problem, ct_state *state, double omega_squared[2],
                            double rate[2], ct_error *error)
{
  for (int32_t k = 0; k < problem->effect_count; k++) {
    double own, own_rate;
    ct_status status = ct_stable_share(problem, state, k, &own, &own_rate, error);
    if (status != CT_OK) return status;
    for (int without = 0; without < (is_contact(problem->effects[k]->kind) ? 1 : 2); without++) {
      // Σ ω̂² and Σ of the rates (eq:step-bound)
      omega_squared[without] += own;
      rate[without] += own_rate;
    }
  }
  return CT_OK;
}

/* The stable step of these bounds. An effect that enlarges them does so the less the larger the
 * step; the fixed point is approached from below, so every round is stable (eq:averaged-bound). */
static double step_of(const ct_problem *problem, double omega_squared, double rate)
{
  const ct_effect *enlarging = NULL;
  for (int32_t k = 0; k < problem->effect_count; k++)
    if (problem->effects[k]->amplification != NULL) enlarging = problem->effects[k];
  double dt = 0.0;
  for (int round = 0; round < (enlarging == NULL ? 1 : FIXED_POINT_ROUNDS); round++) {
    double factor = enlarging == NULL ? 1.0 : enlarging->amplification(enlarging, dt);
    dt = ct_integrator_step(&problem->integrator, factor * omega_squared, factor * rate);
  }
  return dt;
}

ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                    ct_error *error)
{
  double omega_squared[2] = {0.0, 0.0}, rate[2] = {0.0, 0.0};
  ct_state *own = NULL;
  if (problem == NULL || out == NULL) return CT_REFUSE(error, "stable step: null argument");
  ct_status status = state == NULL ? ct_state_create(problem, &own, error) : CT_OK;
  if (status == CT_OK)
    status = sum_bounds(problem, state == NULL ? own : state, omega_squared, rate, error);
  ct_state_free(own);
  if (status != CT_OK) return status;
  out->dt = step_of(problem, omega_squared[0], rate[0]);
  out->dt_without_contact = step_of(problem, omega_squared[1], rate[1]);
  out->dt_courant = INFINITY;
  for (int32_t i = 0; i < problem->body_count; i++) {
    double c1, c2;
    ct_material_speeds(&problem->bodies[i].material, &c1, &c2);
    out->dt_courant = fmin(out->dt_courant, ct_mesh_shortest_edge(problem->bodies[i].mesh) / c1);
  }
  return CT_OK;
}
