#include <contact/energy.h>
#include <contact/sum.h>

#include "error.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

/* v_{n+1/2} of one degree of freedom: as far beyond v_n as v_{n-1/2} is behind (eq:stage-velocity). */
static double velocity_after(const ct_problem *problem, const ct_state *state, int64_t dof)
{
  return ct_kick(state->velocity[dof], 2.0 * ct_integrator_share(&problem->integrator) * problem->dt, problem->inverse_mass[dof], state->workspace->total[dof]);
}

/* ½ v_{n-1/2} · M v_{n+1/2} (eq:discrete-energy). */
static double kinetic_energy(const ct_problem *problem, ct_state *state)
{
  double *terms = state->workspace->terms;
  for (int64_t n = 0; n < problem->node_count; n++) {
    const double *v = &state->velocity[3 * n];
    terms[n] = 0.5 * problem->mass[n] *
               ((v[0] * velocity_after(problem, state, 3 * n) + v[1] * velocity_after(problem, state, 3 * n + 1)) +
                v[2] * velocity_after(problem, state, 3 * n + 2));
  }
  return ct_sum(terms, problem->node_count);
}

static ct_status check_effect(const ct_problem *problem, const ct_state *state, int32_t effect, const void *out, ct_error *error)
{
  if (problem == NULL || state == NULL || out == NULL || effect < 0 || effect >= problem->effect_count)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "energy: null argument or no effect %d", (int)effect);
  return ct_stage_check(state, error);
}

ct_status ct_energy_work(const ct_problem *problem, ct_state *state, int32_t k, double *work, ct_error *error)
{
  ct_status status = check_effect(problem, state, k, work, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  const ct_effect *effect = problem->effects[k];
  const double *past = effect->reaction ? state->impulse + ct_state_impulse_start(problem, k) : state->work + ct_state_work_start(problem, k);
  const double *force = ct_workspace_force_of(problem, state, k), *earlier = effect->reaction ? past + state->impulse_count / 2 : NULL;
  double *terms = state->workspace->terms, share = ct_integrator_share(&problem->integrator);
  for (int32_t i = 0; i < effect->node_count; i++) {
    const double *v = &state->velocity[3 * (int64_t)ct_effect_node(effect, i)];
    double t[3];
    // -- Δt / 2 (Σ f (v⁻ + v⁺) + f_n v_{n-1/2}); a reaction's velocity is constant (eq:work-balance, eq:stage-work)
    for (int c = 0; c < 3; c++) {
      int64_t d = 3 * (int64_t)i + c;
      t[c] = effect->reaction ? 2.0 * (earlier[d] + (past[d] + share * force[d])) * v[c] : past[d] + 2.0 * share * force[d] * v[c];
    }
    terms[i] = (t[0] + t[1]) + t[2];
  }
  *work = 0.5 * problem->dt * ct_sum(terms, effect->node_count);
  return CT_OK;
}

ct_status ct_energy_stored(const ct_problem *problem, ct_state *state, int32_t k, double *energy, ct_error *error)
{
  ct_status status = check_effect(problem, state, k, energy, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, state, k);
  *energy = 0.0;
  return effect->energy == NULL ? CT_OK : effect->energy(effect, &view, energy, error);
}

/* Add what comes in from outside through an effect that stores energy. */
static ct_status add_external(const ct_problem *problem, const ct_state *state, int32_t k, double *external, ct_error *error)
{
  double work = 0.0;
  ct_view view = ct_workspace_view(problem, state, k);
  ct_status status = problem->effects[k]->external(problem->effects[k], &view, &work, error);
  *external += work;
  return status;
}

ct_status ct_energy_of(const ct_problem *problem, ct_state *state, ct_energy *energy, ct_error *error)
{
  ct_status status = check_effect(problem, state, 0, energy, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  ct_energy e = {.time = state->time, .kinetic = kinetic_energy(problem, state)};
  double stored_total = 0.0, work_total = 0.0;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double work = 0.0, stored = 0.0;
    status = ct_energy_work(problem, state, k, &work, error);
    if (status == CT_OK) status = ct_energy_stored(problem, state, k, &stored, error);
    work_total += work;
    stored_total += stored;
    if (effect->energy == NULL) e.external += work;
    if (status == CT_OK && effect->external != NULL) status = add_external(problem, state, k, &e.external, error);
    if (strcmp(effect->name, "solid") == 0) e.strain += stored;
    if (strcmp(effect->name, "contact") == 0) e.contact += stored;
  }
  e.total = e.kinetic + stored_total - e.external;
  e.balance = e.kinetic - state->kinetic_start - work_total;
  if (status == CT_OK && !isfinite(e.total + e.balance))
    status = ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE, "the energy stopped being finite by t = %g (step %lld)", state->time,
                     (long long)state->step);
  if (status == CT_OK) *energy = e;
  return status;
}

/* Largest component of a force on the nodes of an effect. */
static double largest_force(const double *force, int64_t count)
{
  double top = 0.0;
  for (int64_t i = 0; i < count; i++) top = fmax(top, fabs(force[i]));
  return top;
}

/* Kinetic energy half a step back: never negative, unlike that of eq:discrete-energy. */
static double kinetic_before(const ct_problem *problem, ct_state *state)
{
  double *terms = state->workspace->terms;
  for (int64_t n = 0; n < problem->node_count; n++) {
    const double *v = &state->velocity[3 * n];
    terms[n] = 0.5 * problem->mass[n] * ((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
  }
  return ct_sum(terms, problem->node_count);
}

ct_status ct_energy_unrest(const ct_problem *problem, ct_state *state, double *unrest, ct_error *error)
{
  ct_status status = check_effect(problem, state, 0, unrest, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  double acting = 0.0, left = 0.0, stored = 0.0;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    double own;
    status = ct_energy_stored(problem, state, k, &own, error);
    stored += fabs(own);
    acting = fmax(acting, largest_force(ct_workspace_force_of(problem, state, k), 3 * (int64_t)problem->effects[k]->node_count));
  }
  if (status != CT_OK) return status;
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++)
    if (problem->inverse_mass[d] != 0.0) left = fmax(left, fabs(state->workspace->total[d]));
  // -- The larger of the two shares (eq:unrest)
  double kinetic = kinetic_before(problem, state), forces = left == 0.0 ? 0.0 : left / acting;
  *unrest = fmax(forces, kinetic == 0.0 ? 0.0 : sqrt(kinetic / stored));
  return CT_OK;
}

/* Add the impulse of one effect on a range of nodes since t = 0 (eq:impulse-balance). */
static void add_impulse(const ct_problem *problem, ct_state *state, int32_t k, int32_t first, int32_t last, double impulse[3])
{
  const ct_effect *effect = problem->effects[k];
  const double *past = state->impulse + ct_state_impulse_start(problem, k), *earlier = past + state->impulse_count / 2;
  const double *force = ct_workspace_force_of(problem, state, k), share = ct_integrator_share(&problem->integrator);
  for (int c = 0; c < 3; c++) {
    int64_t count = 0;
    for (int32_t i = 0; i < effect->node_count; i++) {
      int32_t node = ct_effect_node(effect, i);
      if (node < first || node >= last) continue;
      int64_t d = 3 * (int64_t)i + c;
      state->workspace->terms[count++] = earlier[d] + (past[d] + share * force[d]);
    }
    impulse[c] += problem->dt * ct_sum(state->workspace->terms, count);
  }
}

/* Impulse of all effects of one name on a range of nodes. */
static void impulse_of(const ct_problem *problem, ct_state *state, const char *name, int32_t first, int32_t last, double impulse[3])
{
  for (int c = 0; c < 3; c++) impulse[c] = 0.0;
  for (int32_t k = 1; k < problem->effect_count; k++)
    if (strcmp(problem->effects[k]->name, name) == 0) add_impulse(problem, state, k, first, last, impulse);
}

ct_status ct_energy_impulse(const ct_problem *problem, ct_state *state, int32_t k, double impulse[3], ct_error *error)
{
  ct_status status = check_effect(problem, state, k, impulse, error);
  if (status == CT_OK && k == 0) status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "energy: no impulse of the first effect is kept");
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  for (int c = 0; c < 3; c++) impulse[c] = 0.0;
  add_impulse(problem, state, k, 0, problem->node_count, impulse);
  return CT_OK;
}

ct_status ct_momentum_of(const ct_problem *problem, ct_state *state, int32_t body, ct_momentum *momentum, ct_error *error)
{
  ct_status status = check_effect(problem, state, 0, momentum, error);
  if (status == CT_OK && (body < 0 || body >= problem->body_count))
    status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body, -1, -1}, "momentum: there is no body %d", (int)body);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  int32_t first = problem->bodies[body].first_node, last = first + problem->bodies[body].mesh->node_count;
  double *terms = state->workspace->terms;
  *momentum = (ct_momentum){.time = state->time, .body = body};
  for (int c = 0; c < 3; c++) {
    int p = (c + 1) % 3, q = (c + 2) % 3;
    for (int32_t n = first; n < last; n++)
      terms[n - first] = problem->mass[n] * (0.5 * (state->velocity[3 * (int64_t)n + c] + velocity_after(problem, state, 3 * (int64_t)n + c)));
    momentum->p[c] = ct_sum(terms, last - first);
    for (int32_t n = first; n < last; n++) {
      int64_t d = 3 * (int64_t)n;
      double vp = 0.5 * (state->velocity[d + p] + velocity_after(problem, state, d + p));
      double vq = 0.5 * (state->velocity[d + q] + velocity_after(problem, state, d + q));
      terms[n - first] = problem->mass[n] * ((problem->reference[d + p] + state->displacement[d + p]) * vq -
                                             (problem->reference[d + q] + state->displacement[d + q]) * vp);
    }
    momentum->L[c] = ct_sum(terms, last - first);
  }
  impulse_of(problem, state, "contact", first, last, momentum->contact_impulse);
  impulse_of(problem, state, "support", first, last, momentum->support_impulse);
  return CT_OK;
}

ct_status ct_state_velocity(const ct_problem *problem, ct_state *state, double *velocity, ct_error *error)
{
  ct_status status = check_effect(problem, state, 0, velocity, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  for (int64_t d = 0; status == CT_OK && d < 3 * (int64_t)problem->node_count; d++)
    velocity[d] = 0.5 * (state->velocity[d] + velocity_after(problem, state, d));
  return status;
}

ct_status ct_state_force(const ct_problem *problem, ct_state *state, int32_t k, double *force, ct_error *error)
{
  ct_status status = check_effect(problem, state, k, force, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  const double *own = ct_workspace_force_of(problem, state, k);
  memset(force, 0, 3 * (size_t)problem->node_count * sizeof *force);
  for (int32_t i = 0; i < problem->effects[k]->node_count; i++)
    for (int c = 0; c < 3; c++)
      force[3 * (int64_t)ct_effect_node(problem->effects[k], i) + c] = own[3 * (int64_t)i + c];
  return CT_OK;
}
