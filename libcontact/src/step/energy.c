#include <libcontact/ledger.h>
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "../solid/sleep.h"
#include "piece.h"
#include "sums.h"

#include <math.h>
#include <string.h>

/* Time from v_{n-1/2} to v_{n+1/2}, twice that from v_{n-1/2} to v_n (eq:stage-velocity). */
static double kick_time(const ct_problem *problem)
{
  return 2.0 * ct_integrator_share(&problem->integrator) * problem->dt;
}

/* v_{n+1/2} of one degree of freedom: v_n is the mean of v_{n-1/2} and v_{n+1/2}
 * (eq:stage-velocity). */
static double velocity_after(const ct_problem *problem, const ct_state *state, double kick,
                             int64_t dof)
{
  return ct_kick(state->velocity[dof], kick, problem->inverse_mass[dof],
                 state->workspace->total[dof]);
}

/* Check the arguments of a query about an effect, and compute the forces. */
static ct_status begin(const ct_problem *problem, ct_state *state, int32_t effect, const void *out,
                       ct_error *error)
{
  if (problem == NULL || state == NULL || out == NULL)
    return CT_REFUSE(error, "energy: a required argument is null");
  if (effect < 0 || effect >= problem->effect_count)
    return CT_REFUSE(error, "energy: there is no effect %d", (int)effect);
  ct_status status = ct_stage_check(state, error);
  if (status == CT_OK) status = ct_piece_refuse(state, error);
  return status == CT_OK ? ct_workspace_forces(problem, state, error) : status;
}

/* Work of the first effect since t = 0, the kinetic energy, and for each body its momentum (or
 * null); the energy stored by linear forces is written to `half_work`. */
static double first_sums(const ct_problem *problem, const ct_state *state, double *kinetic,
                         ct_momentum *momentum, int *is_far)
{
  int32_t bodies = problem->body_count;
  double *work = state->workspace->addends, *moving = work + bodies, *half_work = moving + bodies;
  for (int32_t b = 0; b < bodies; b++) {
    ct_body_sums sums;
    ct_sum_body(problem, state, b, &sums);
    work[b] = sums.work;
    moving[b] = sums.kinetic;
    half_work[b] = sums.half_work;
    *is_far |= !(sums.largest <= CT_LARGEST_LENGTH);
    if (momentum == NULL) continue;
    momentum[b] = (ct_momentum){.time = state->time, .body = b};
    memcpy(momentum[b].p, sums.p, sizeof sums.p);
    memcpy(momentum[b].L, sums.L, sizeof sums.L);
  }
  *kinetic = ct_sum(moving, bodies);
  return state->step == 0 ? 0.0 : 0.5 * problem->dt * ct_sum(work, bodies);
}

/* Add the impulse of an effect on a body to the impulses of its kind (eq:impulse-balance). */
static void add_impulse(const ct_problem *problem, int32_t k, const double impulse[3],
                        ct_momentum *momentum)
{
  ct_effect_kind kind = problem->effects[k]->kind;
  double *to = kind == CT_EFFECT_CONTACT || kind == CT_EFFECT_TIE ? momentum->contact_impulse
               : kind == CT_EFFECT_OBSTACLE                       ? momentum->obstacle_impulse
               : kind == CT_EFFECT_SUPPORT || kind == CT_EFFECT_MOTION || kind == CT_EFFECT_RIGID
                   ? momentum->support_impulse
                   : NULL;
  for (int c = 0; to != NULL && c < 3; c++) to[c] += problem->dt * impulse[c];
}

/* Work of another effect since t = 0; its impulses are added to the momenta of the bodies (or
 * null). At t = 0 the work is 0 (eq:work-start). */
static double effect_work(const ct_problem *problem, const ct_state *state, int32_t k,
                          ct_momentum *momentum)
{
  double *work = state->workspace->addends;
  for (int32_t b = 0; b < problem->body_count; b++) {
    ct_effect_sums sums;
    ct_sum_effect(problem, state, k, b, &sums);
    work[b] = sums.work;
    if (momentum != NULL) add_impulse(problem, k, sums.impulse, &momentum[b]);
  }
  return state->step == 0 ? 0.0 : 0.5 * problem->dt * ct_sum(work, problem->body_count);
}

/* Stored energy of an effect; that of the solid follows partly from its forces. */
static ct_status stored_by(const ct_problem *problem, ct_state *state, int32_t k, double *energy,
                           ct_error *error)
{
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, state, k);
  *energy = 0.0;
  if (effect->calls->energy == NULL) return CT_OK;
  ct_solid_scratch *solid = k == 0 && effect->kind == CT_EFFECT_SOLID ? view.scratch : NULL;
  if (solid != NULL) {
    solid->half_work = state->workspace->addends + 2 * (int64_t)problem->body_count;
    solid->body_count = problem->body_count;
  }
  ct_status status = effect->calls->energy(effect, &view, energy, error);
  if (solid != NULL) solid->half_work = NULL;
  return status;
}

ct_status ct_energy_work(const ct_problem *problem, ct_state *state, int32_t k, double *work,
                         ct_error *error)
{
  double kinetic;
  int is_far = 0;
  ct_status status = begin(problem, state, k, work, error);
  if (status != CT_OK) return status;
  *work = k == 0 ? first_sums(problem, state, &kinetic, NULL, &is_far)
                 : effect_work(problem, state, k, NULL);
  return CT_OK;
}

ct_status ct_energy_stored(const ct_problem *problem, ct_state *state, int32_t k, double *energy,
                           ct_error *error)
{
  double kinetic;
  int is_far = 0;
  ct_status status = begin(problem, state, k, energy, error);
  if (status != CT_OK) return status;
  if (k == 0) first_sums(problem, state, &kinetic, NULL, &is_far);
  return stored_by(problem, state, k, energy, error);
}

/* The row of a state whose forces are known. */
static ct_status make_row(const ct_problem *problem, ct_state *state, ct_ledger *row,
                          ct_error *error)
{
  ct_energy *e = &row->energy;
  double stored_total = 0.0, work_total = 0.0;
  int is_far = 0;
  *e = (ct_energy){.time = state->time};
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double external = 0.0, stored,
           work = k == 0 ? first_sums(problem, state, &e->kinetic, row->momentum, &is_far)
                         : effect_work(problem, state, k, row->momentum);
    ct_status status = stored_by(problem, state, k, &stored, error);
    if (status != CT_OK) return status;
    ct_view view = ct_workspace_view(problem, state, k);
    if (effect->calls->constraints.external != NULL)
      status = effect->calls->constraints.external(effect, &view, &external, error);
    double reserve = 0.0;
    if (status == CT_OK && effect->calls->constraints.reserve != NULL)
      status = effect->calls->constraints.reserve(effect, &view, &reserve, error);
    if (status != CT_OK) return status;
    if (row->effects != NULL) row->effects[k] = (ct_effect_energy){work, stored, external};
    work_total += work;
    stored_total += stored;
    e->external += effect->calls->energy == NULL ? work + external : external;
    if (effect->kind == CT_EFFECT_SOLID) e->strain += stored;
    if (effect->kind == CT_EFFECT_CONTACT) e->contact += stored;
    e->reserve += reserve;
  }
  e->total = e->kinetic + stored_total - e->external;
  e->balance = e->kinetic - state->kinetic_start - work_total;
  if (!is_far && isfinite(e->total + e->balance)) return CT_OK;
  return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                 "the energy stopped being finite by t = %g (step %lld)", state->time,
                 (long long)state->step);
}

ct_status ct_ledger_of(const ct_problem *problem, ct_state *state, ct_ledger *ledger,
                       ct_error *error)
{
  if (problem == NULL || state == NULL || ledger == NULL) return CT_REFUSE_NULL(error);
  ct_ledger row = *ledger;
  ct_status status = ct_stage_check(state, error);
  if (status == CT_OK) status = ct_piece_refuse(state, error);
  if (status != CT_OK) return status;
  status = ct_workspace_forces(problem, state, error);
  if (status == CT_OK) status = make_row(problem, state, &row, error);
  if (status == CT_OK) {
    *ledger = row;
    return CT_OK;
  }
  // -- Where the motion is not finite, the node is named that is not
  ct_status finite = ct_check_finite(problem, state, error);
  return finite == CT_OK ? status : finite;
}

ct_status ct_energy_of(const ct_problem *problem, ct_state *state, ct_energy *energy,
                       ct_error *error)
{
  ct_ledger row = {.momentum = NULL, .effects = NULL};
  if (energy == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_ledger_of(problem, state, &row, error);
  if (status == CT_OK) *energy = row.energy;
  return status;
}

/* Largest component of the force of one effect. */
static double largest_force(const ct_problem *problem, const ct_state *state, int32_t k)
{
  double top = 0.0, force[3];
  for (int32_t i = 0; i < problem->effects[k]->node_count; i++) {
    ct_workspace_force_at(problem, state, k, i, force);
    top = fmax(fmax(top, fabs(force[0])), fmax(fabs(force[1]), fabs(force[2])));
  }
  return top;
}

ct_status ct_energy_residual(const ct_problem *problem, ct_state *state, double *residual,
                             ct_error *error)
{
  ct_status status = begin(problem, state, 0, residual, error);
  double acting = 0.0, left = 0.0, stored = 0.0;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    double own;
    status = ct_energy_stored(problem, state, k, &own, error);
    stored += fabs(own);
    acting = fmax(acting, largest_force(problem, state, k));
  }
  if (status != CT_OK) return status;
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++)
    if (problem->inverse_mass[d] != 0.0) left = fmax(left, fabs(state->workspace->total[d]));
  // The kinetic energy at t_{n-1/2} is never negative, unlike that of the energy balance.
  double kinetic =
      0.5 * ct_sum_product(problem->node_count, problem->mass, state->velocity, state->velocity);
  // -- The larger of the two shares
  double forces = left == 0.0 ? 0.0 : left / acting;
  *residual = fmax(forces, kinetic == 0.0 ? 0.0 : sqrt(kinetic / stored)); // (eq:residual)
  return CT_OK;
}

ct_status ct_energy_impulse(const ct_problem *problem, ct_state *state, int32_t k,
                            double impulse[3], ct_error *error)
{
  if (k == 0)
    return CT_REFUSE(error, "energy: effect 0, the solid, has no impulse; give 1 or more");
  ct_status status = begin(problem, state, k, impulse, error);
  if (status != CT_OK) return status;
  int32_t bodies = problem->body_count;
  double *addends = state->workspace->addends;
  for (int32_t b = 0; b < bodies; b++) {
    ct_effect_sums sums;
    ct_sum_effect(problem, state, k, b, &sums);
    for (int c = 0; c < 3; c++) addends[c * bodies + b] = sums.impulse[c];
  }
  for (int c = 0; c < 3; c++) impulse[c] = problem->dt * ct_sum(&addends[c * bodies], bodies);
  return CT_OK;
}

ct_status ct_momentum_of(const ct_problem *problem, ct_state *state, int32_t body,
                         ct_momentum *momentum, ct_error *error)
{
  ct_status status = begin(problem, state, 0, momentum, error);
  if (status == CT_OK && (body < 0 || body >= problem->body_count))
    status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body, -1, -1},
                     "momentum: there is no body %d", (int)body);
  if (status != CT_OK) return status;
  ct_body_sums own;
  ct_sum_body(problem, state, body, &own);
  *momentum = (ct_momentum){.time = state->time, .body = body};
  memcpy(momentum->p, own.p, sizeof own.p);
  memcpy(momentum->L, own.L, sizeof own.L);
  for (int32_t k = 1; k < problem->effect_count; k++) {
    ct_effect_sums sums;
    ct_sum_effect(problem, state, k, body, &sums);
    add_impulse(problem, k, sums.impulse, momentum);
  }
  return CT_OK;
}

void ct_mean_velocity(const ct_problem *problem, const ct_state *state, int32_t first, int32_t end,
                      double *velocity)
{
  double kick = kick_time(problem);
  for (int64_t d = 3 * (int64_t)first; d < 3 * (int64_t)end; d++)
    *velocity++ = 0.5 * (state->velocity[d] + velocity_after(problem, state, kick, d));
}

ct_status ct_state_velocity_at(const ct_problem *problem, ct_state *state, int32_t first,
                               int32_t count, double *velocity, ct_error *error)
{
  ct_status status = begin(problem, state, 0, velocity, error);
  if (status != CT_OK) return status;
  if (first < 0 || count < 0 || first > problem->node_count - count)
    return CT_REFUSE(error,
                     "velocity: %d nodes from node %d on are not among the %d of the problem",
                     (int)count, (int)first, (int)problem->node_count);
  ct_mean_velocity(problem, state, first, first + count, velocity);
  return CT_OK;
}

ct_status ct_state_velocity(const ct_problem *problem, ct_state *state, double *velocity,
                            ct_error *error)
{
  int32_t all = problem == NULL ? 0 : problem->node_count;
  return ct_state_velocity_at(problem, state, 0, all, velocity, error);
}

ct_status ct_state_force(const ct_problem *problem, ct_state *state, int32_t k, double *force,
                         ct_error *error)
{
  ct_status status = begin(problem, state, k, force, error);
  if (status != CT_OK) return status;
  const ct_effect *effect = problem->effects[k];
  memset(force, 0, 3 * (size_t)problem->node_count * sizeof *force);
  for (int32_t i = 0; i < effect->node_count; i++)
    ct_workspace_force_at(problem, state, k, i, &force[3 * (int64_t)ct_effect_node(effect, i)]);
  return CT_OK;
}
