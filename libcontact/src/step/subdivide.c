/* Continuing with a smaller step. */
#include <libcontact/ledger.h>

#include "../base/error.h"
#include "workspace.h"

#include <math.h>

/* Number of parts into which a problem divides the step of another one that is otherwise equal, as
 * far as can be checked; 0 if it is not. */
static int64_t parts_of(const ct_problem *coarse, const ct_problem *fine)
{
  double parts = floor(coarse->dt / fine->dt + 0.5);
  int same = coarse->node_count == fine->node_count && coarse->effect_count == fine->effect_count &&
             coarse->integrator.scheme == fine->integrator.scheme &&
             coarse->integrator.parameter == fine->integrator.parameter;
  return same && parts >= 1.0 && parts <= 1e9 && coarse->dt / parts == fine->dt ? (int64_t)parts
                                                                                : 0;
}

/* The velocity before the kick of the smaller step, with v_n as it is. */
static void move_velocities(const ct_problem *problem, const ct_state *from, ct_state *to)
{
  double less = ct_integrator_share(&problem->integrator) * (from->problem->dt - problem->dt);
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++)
    // v + ½ (Δt - Δt') f / m (eq:step-change)
    to->velocity[d] =
        ct_kick(from->velocity[d], less, problem->inverse_mass[d], from->workspace->total[d]);
}

/* The work of constraints on the change of velocity, in their memory. */
static void move_memory(const ct_problem *problem, const ct_state *from, ct_state *to)
{
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->calls->constraints.divide == NULL || from->step == 0) continue;
    const ct_view view = ct_workspace_view(from->problem, from, k);
    effect->calls->constraints.divide(effect, &view, problem->dt,
                                      to->memory + ct_state_starts(problem, k).memory);
  }
}

/* Sums from which the smaller step computes the same work and impulse as the larger one. */
static void move_ledgers(const ct_problem *problem, const ct_state *from, ct_state *to,
                         int64_t parts)
{
  double share = ct_integrator_share(&problem->integrator), r = (double)parts;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    ct_starts start = ct_state_starts(problem, k);
    double *work = to->work + start.work, *impulse = to->impulse + start.impulse,
           *earlier = impulse + to->impulse_count / 2;
    for (int32_t i = 0; i < effect->node_count; i++) {
      double force[3];
      ct_workspace_force_at(from->problem, from, k, i, force);
      for (int64_t c = 0, d = 3 * (int64_t)i; c < 3; c++, d++) {
        int64_t dof = 3 * (int64_t)ct_effect_node(effect, i) + c;
        double f = share * force[c];
        // -- r (W + f v) - f v', r (I + ½ f) - ½ f (eq:step-change)
        if (effect->phase != CT_PHASE_REACTION)
          work[d] = r * (work[d] + 2.0 * f * from->velocity[dof]) - 2.0 * f * to->velocity[dof];
        if (k == 0) continue;
        impulse[d] = r * (impulse[d] + f) - f;
        earlier[d] *= r;
      }
    }
  }
}

/* The sums of the smaller step; at t = 0 they begin with its own first kick (eq:work-start). */
static ct_status convert_sums(const ct_problem *problem, const ct_state *from, ct_state *to,
                              int64_t parts, ct_error *error)
{
  if (from->step > 0) {
    move_ledgers(problem, from, to, parts);
    return CT_OK;
  }
  ct_status status = ct_workspace_forces(problem, to, error);
  if (status == CT_OK) ct_state_start_ledgers(problem, to);
  return status;
}

ct_status ct_state_subdivide_step(const ct_problem *problem, ct_state *from, ct_state *to,
                                  ct_error *error)
{
  ct_energy before, after;
  if (problem == NULL || from == NULL || to == NULL) return CT_REFUSE_NULL(error);
  if (from == to || to->problem != problem)
    return CT_REFUSE(error, "smaller step: to must be another state, of the problem that is given");
  int64_t parts = parts_of(from->problem, problem);
  if (parts == 0 || from->step > INT64_MAX / parts)
    return CT_REFUSE(
        error, "smaller step: dt = %g must be a whole part of %g, and the problems else alike",
        problem->dt, from->problem->dt);
  ct_status status = ct_energy_of(from->problem, from, &before, error);
  if (status == CT_OK) status = ct_state_copy(problem, from, to, error);
  if (status != CT_OK || parts == 1) return status;
  to->step = parts * from->step;
  to->time = (double)to->step * problem->dt;
  move_velocities(problem, from, to);
  move_memory(problem, from, to);
  // -- The kinetic energy of the scheme depends on the step; the balance continues from its last
  // value (eq:step-change)
  to->kinetic_start = 0.0;
  status = convert_sums(problem, from, to, parts, error);
  if (status == CT_OK) status = ct_energy_of(problem, to, &after, error);
  if (status == CT_OK) to->kinetic_start = after.balance - before.balance;
  return status;
}
