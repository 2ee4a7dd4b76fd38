/* The largest stable time step of a problem, and the effects that bound it. */
#include <libcontact/step.h>

#include "../base/error.h"
#include "piece.h"
#include "workspace.h"

#include <math.h>

enum { FIXED_POINT_ROUNDS = 64 };

/* Two steps are equal if they differ by at most this fraction. */
static const double ALIKE = 1e-6;

ct_status ct_stable_contribution(const ct_problem *problem, ct_state *state, int32_t k,
                                 double *omega_squared, double *rate, ct_error *error)
{
  if (problem == NULL || state == NULL || omega_squared == NULL || rate == NULL)
    return CT_REFUSE_NULL(error);
  if (k < 0 || k >= problem->effect_count)
    return CT_REFUSE(error, "stable step: there is no effect %d", (int)k);
  const ct_effect *effect = problem->effects[k];
  *omega_squared = *rate = 0.0;
  ct_status status = ct_stage_check(state, error);
  if (status == CT_OK) status = ct_piece_refuse(state, error);
  if (status == CT_OK) status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  // -- The bounds of one effect in this state
  ct_view view = ct_workspace_view(problem, state, k);
  if (effect->calls->bounds.omega2 != NULL)
    status = effect->calls->bounds.omega2(effect, &view, omega_squared, error);
  if (status == CT_OK && effect->calls->bounds.rate != NULL)
    status = effect->calls->bounds.rate(effect, &view, rate, error);
  if (status == CT_OK && !(*omega_squared >= 0.0 && *rate >= 0.0))
    return CT_REFUSE(
        error, "stable step: effect %s bounds omega2 by %g and rate by %g; neither may be negative",
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

/* Whether an effect of this kind acts only during contact. */
static int is_contact(ct_effect_kind kind)
{
  return kind == CT_EFFECT_CONTACT || kind == CT_EFFECT_FRICTION || kind == CT_EFFECT_OBSTACLE;
}

/* Sums of the bounds of ω² and of damping rates, and the same for effects without an element
 * matrix. */
typedef struct bounds {
  double omega_squared, rate, other_omega_squared, other_rate;
  double damping; /* rates of dampings proportional to mass */
} bounds;

/* Bounds on the step from all effects, and from all but the contacts. */
static ct_status sum_bounds(const ct_problem *problem, ct_state *state, bounds sum[2],
                            ct_error *error)
{
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double own, own_rate;
    ct_status status = ct_stable_contribution(problem, state, k, &own, &own_rate, error);
    if (status != CT_OK) return status;
    for (int without = 0; without < (is_contact(effect->kind) ? 1 : 2); without++) {
      // Σ ω̂² and Σ of the rates (eq:step-bound)
      sum[without].omega_squared += own;
      sum[without].rate += own_rate;
      if (effect->kind == CT_EFFECT_DAMPING) sum[without].damping += own_rate;
      if (effect->calls->bounds.add_element != NULL || effect->calls->bounds.joint != NULL)
        continue;
      sum[without].other_omega_squared += own;
      sum[without].other_rate += own_rate;
    }
  }
  return CT_OK;
}

/* Increase a stable step by the bound of the sum if some effect has an element matrix. The bound
 * grows more slowly than Δt², so each round is stable (eq:joint-step). */
static ct_status raise_step(const ct_problem *problem, const bounds *sum, double *dt,
                            ct_error *error)
{
  const ct_effect *solid = problem->effects[0];
  const double limit = ct_integrator_limit(&problem->integrator);
  int adding = 0;
  ct_stage stages[2];
  for (int32_t k = 1; k < problem->effect_count; k++)
    adding |= problem->effects[k]->calls->bounds.add_element != NULL;
  // For two stages the sums are tested, not proved.
  if (!adding || solid->calls->bounds.joint == NULL ||
      ct_integrator_stages(&problem->integrator, stages) > 1)
    return CT_OK;
  for (int round = 0; round < FIXED_POINT_ROUNDS; round++) {
    double stiffness = 4.0 / (limit * limit) * *dt * *dt, largest;
    double mass = stiffness * sum->other_omega_squared + 2.0 * *dt * sum->other_rate;
    ct_status status =
        solid->calls->bounds.joint(solid, problem, *dt, stiffness, mass, &largest, error);
    // -- The largest eigenvalue may be 4 (eq:joint-step)
    double factor = sqrt(4.0 / largest);
    if (status != CT_OK || !(factor > 1.0 + ALIKE)) return status;
    *dt *= factor;
  }
  return CT_OK;
}

ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                    ct_error *error)
{
  bounds sum[2] = {{.rate = 0.0}, {.rate = 0.0}};
  double *dt[2];
  ct_state *own = NULL;
  if (problem == NULL || out == NULL) return CT_REFUSE_NULL(error);
  ct_status status = state == NULL ? ct_state_create(problem, &own, error) : CT_OK;
  if (status == CT_OK) status = sum_bounds(problem, state == NULL ? own : state, sum, error);
  ct_state_free(own);
  dt[0] = &out->dt;
  dt[1] = &out->dt_without_contact;
  for (int i = 0; status == CT_OK && i < 2; i++) {
    *dt[i] = ct_integrator_step(&problem->integrator, sum[i].omega_squared, sum[i].rate);
    status = raise_step(problem, &sum[i], dt[i], error);
    // -- No damping may reverse a velocity (eq:damping-sign)
    if (sum[i].damping > 0.0) *dt[i] = fmin(*dt[i], 1.0 / sum[i].damping);
  }
  if (status != CT_OK) return status;
  out->dt_courant = INFINITY;
  for (int32_t i = 0; i < problem->body_count; i++) {
    double c1, c2;
    if (ct_problem_is_rigid(problem, i)) continue;
    ct_material_speeds(&problem->bodies[i].material, &c1, &c2);
    out->dt_courant = fmin(out->dt_courant, ct_mesh_shortest_edge(problem->bodies[i].mesh) / c1);
  }
  return CT_OK;
}
