#include <libcontact/step.h>
#include <libcontact/base.h>

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/stream.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

/* Time from v_{n-1/2} to v_{n+1/2}, twice that from v_{n-1/2} to v_n (eq:stage-velocity). */
static double kick_time(const ct_problem *problem)
{
  return 2.0 * ct_integrator_share(&problem->integrator) * problem->dt;
}

/* v_{n+1/2} of one degree of freedom: as far beyond v_n as v_{n-1/2} is behind (eq:stage-velocity).
 */
static double velocity_after(const ct_problem *problem, const ct_state *state, double kick,
                             int64_t dof)
{
  return ct_kick(state->velocity[dof], kick, problem->inverse_mass[dof],
                 state->workspace->total[dof]);
}

/* v_{n-1/2} v_{n+1/2} of one degree of freedom; where a force begins at t = 0, v_0²
 * (eq:energy-start). */
static double velocity_product(const ct_problem *problem, const ct_state *state,
                               const uint64_t *begun, double kick, int64_t dof)
{
  double before = state->velocity[dof], after = velocity_after(problem, state, kick, dof),
         middle = 0.5 * (before + after);
  return begun != NULL && ct_bits_get(begun, (int32_t)(dof / 3)) ? middle * middle : before * after;
}

/* ½ v_{n-1/2} · M v_{n+1/2} (eq:discrete-energy). */
static double kinetic_energy(const ct_problem *problem, const ct_state *state)
{
  const uint64_t *begun = ct_workspace_begun(state);
  ct_stream sum = {0};
  double product[3 * CT_PIECE], terms[CT_PIECE], kick = kick_time(problem);
  for (int32_t first, end; ct_stream_piece(&sum, 1, problem->node_count, &first, &end);) {
    for (int64_t i = 0, d = 3 * (int64_t)first; d < 3 * (int64_t)end; i++, d++)
      product[i] = velocity_product(problem, state, begun, kick, d);
    for (int32_t n = first, i = 0; n < end; n++, i += 3)
      terms[n - first] = 0.5 * problem->mass[n] * ((product[i] + product[i + 1]) + product[i + 2]);
    ct_stream_add(&sum, terms, end - first);
  }
  return ct_stream_sum(&sum);
}

/* Check the arguments of a question about an effect, and make the forces. */
static ct_status begin(const ct_problem *problem, ct_state *state, int32_t effect, const void *out,
                       ct_error *error)
{
  if (problem == NULL || state == NULL || out == NULL || effect < 0 ||
      effect >= problem->effect_count)
    return CT_REFUSE(error, "energy: null argument or no effect %d", (int)effect);
  ct_status status = ct_stage_check(state, error);
  return status == CT_OK ? ct_workspace_forces(problem, state, error) : status;
}

/* Twice the work of one effect over Δt at its nodes first ... end - 1. */
static void work_terms(const ct_problem *problem, const ct_state *state, int32_t k, int32_t first,
                       int32_t end, double *terms)
{
  const ct_effect *effect = problem->effects[k];
  ct_starts start = ct_state_starts(problem, k);
  int reaction = effect->phase == CT_PHASE_REACTION;
  const double *past = reaction ? state->impulse + start.impulse : state->work + start.work,
               *earlier = reaction ? past + state->impulse_count / 2 : NULL;
  double force[3], t[3], share = ct_integrator_share(&problem->integrator);
  // -- Δt / 2 (Σ f (v⁻ + v⁺) + f_n v_{n-1/2}); a reaction's velocity is constant (eq:work-balance,
  // eq:stage-work)
  for (int32_t i = first; i < end; i++) {
    const double *v = &state->velocity[3 * (int64_t)ct_effect_node(effect, i)];
    ct_workspace_force_at(problem, state, k, i, force);
    for (int64_t c = 0, d = 3 * (int64_t)i; c < 3; c++, d++)
      t[c] = reaction ? 2.0 * (earlier[d] + (past[d] + share * force[c])) * v[c]
                      : past[d] + 2.0 * share * force[c] * v[c];
    terms[i - first] = (t[0] + t[1]) + t[2];
  }
}

ct_status ct_energy_work(const ct_problem *problem, ct_state *state, int32_t k, double *work,
                         ct_error *error)
{
  ct_status status = begin(problem, state, k, work, error);
  if (status != CT_OK) return status;
  // -- By t = 0 nothing has done work (eq:work-start)
  *work = 0.0;
  if (state->step == 0) return CT_OK;
  ct_stream sum = {0};
  double terms[CT_PIECE];
  int32_t count = problem->effects[k]->node_count;
  for (int32_t first, end; ct_stream_piece(&sum, 1, count, &first, &end);) {
    work_terms(problem, state, k, first, end, terms);
    ct_stream_add(&sum, terms, end - first);
  }
  *work = 0.5 * problem->dt * ct_stream_sum(&sum);
  return CT_OK;
}

ct_status ct_energy_stored(const ct_problem *problem, ct_state *state, int32_t k, double *energy,
                           ct_error *error)
{
  ct_status status = begin(problem, state, k, energy, error);
  if (status != CT_OK) return status;
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, state, k);
  *energy = 0.0;
  return effect->energy == NULL ? CT_OK : effect->energy(effect, &view, energy, error);
}

ct_status ct_energy_parts(const ct_problem *problem, ct_state *state, int32_t k, double *work,
                          double *stored, double *external, ct_error *error)
{
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, state, k);
  *external = 0.0;
  ct_status status = ct_energy_work(problem, state, k, work, error);
  if (status == CT_OK) status = ct_energy_stored(problem, state, k, stored, error);
  if (status == CT_OK && effect->external != NULL)
    status = effect->external(effect, &view, external, error);
  return status;
}

ct_status ct_energy_of(const ct_problem *problem, ct_state *state, ct_energy *energy,
                       ct_error *error)
{
  ct_status status = begin(problem, state, 0, energy, error);
  if (status != CT_OK) return status;
  ct_energy e = {.time = state->time, .kinetic = kinetic_energy(problem, state)};
  double stored_total = 0.0, work_total = 0.0;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double work = 0.0, stored = 0.0, external = 0.0;
    status = ct_energy_parts(problem, state, k, &work, &stored, &external, error);
    work_total += work;
    stored_total += stored;
    if (effect->energy == NULL) e.external += work;
    e.external += external;
    if (effect->kind == CT_EFFECT_SOLID) e.strain += stored;
    if (effect->kind == CT_EFFECT_CONTACT) e.contact += stored;
  }
  e.total = e.kinetic + stored_total - e.external;
  e.balance = e.kinetic - state->kinetic_start - work_total;
  if (status == CT_OK && !isfinite(e.total + e.balance))
    status = ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                     "the energy stopped being finite by t = %g (step %lld)", state->time,
                     (long long)state->step);
  if (status == CT_OK) *energy = e;
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

ct_status ct_energy_residual(const ct_problem *problem, ct_state *state, double *unrest,
                             ct_error *error)
{
  ct_status status = begin(problem, state, 0, unrest, error);
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
  // The kinetic energy half a step back is never negative, unlike that of the ledger.
  double kinetic =
      0.5 * ct_sum_product(problem->node_count, problem->mass, state->velocity, state->velocity);
  // -- The larger of the two shares (eq:residual)
  double forces = left == 0.0 ? 0.0 : left / acting;
  *unrest = fmax(forces, kinetic == 0.0 ? 0.0 : sqrt(kinetic / stored));
  return CT_OK;
}

/* Impulses of one effect over Δt at its nodes i ... end - 1 as far as they are in a range of the
 * problem's nodes, side by side for each component; answers how many there are. */
static int64_t impulse_terms(const ct_problem *problem, const ct_state *state, int32_t k,
                             const int32_t range[2], int32_t i, int32_t end,
                             double terms[3][CT_PIECE])
{
  const ct_effect *effect = problem->effects[k];
  const double *past = state->impulse + ct_state_starts(problem, k).impulse,
               *earlier = past + state->impulse_count / 2;
  double force[3], share = ct_integrator_share(&problem->integrator);
  int64_t count = 0;
  for (; i < end; i++) {
    int32_t node = ct_effect_node(effect, i);
    if (node < range[0] || node >= range[1]) continue;
    ct_workspace_force_at(problem, state, k, i, force);
    for (int64_t c = 0, d = 3 * (int64_t)i; c < 3; c++, d++)
      terms[c][count] = earlier[d] + (past[d] + share * force[c]);
    count++;
  }
  return count;
}

/* Add the impulse of one effect on a range of nodes since t = 0 (eq:impulse-balance). */
static void add_impulse(const ct_problem *problem, const ct_state *state, int32_t k,
                        const int32_t range[2], double impulse[3])
{
  int32_t nodes = problem->effects[k]->node_count;
  ct_stream sums[3] = {{0}};
  double terms[3][CT_PIECE];
  for (int32_t i, end; ct_stream_piece(sums, 3, nodes, &i, &end);) {
    int64_t count = impulse_terms(problem, state, k, range, i, end, terms);
    for (int c = 0; c < 3; c++) ct_stream_add(&sums[c], terms[c], count);
  }
  for (int c = 0; c < 3; c++) impulse[c] += problem->dt * ct_stream_sum(&sums[c]);
}

/* Add the impulse of all effects of one kind on a range of nodes. */
static void add_impulses(const ct_problem *problem, const ct_state *state, ct_effect_kind kind,
                         const int32_t range[2], double impulse[3])
{
  for (int32_t k = 1; k < problem->effect_count; k++)
    if (problem->effects[k]->kind == kind) add_impulse(problem, state, k, range, impulse);
}

ct_status ct_energy_impulse(const ct_problem *problem, ct_state *state, int32_t k,
                            double impulse[3], ct_error *error)
{
  if (k == 0) return CT_REFUSE(error, "energy: no impulse of the first effect is kept");
  ct_status status = begin(problem, state, k, impulse, error);
  if (status != CT_OK) return status;
  for (int c = 0; c < 3; c++) impulse[c] = 0.0;
  add_impulse(problem, state, k, (int32_t[2]){0, problem->node_count}, impulse);
  return CT_OK;
}

/* Momenta of the nodes first ... end - 1, those about the origin after the others, side by side for
 * each component. */
static void momentum_terms(const ct_problem *problem, const ct_state *state, int32_t first,
                           int32_t end, double terms[6][CT_PIECE])
{
  double velocity[3 * CT_PIECE];
  ct_mean_velocity(problem, state, first, end, velocity);
  for (int32_t n = first; n < end; n++) {
    double m = problem->mass[n], x[3];
    const double *v = &velocity[3 * (int64_t)(n - first)];
    for (int c = 0; c < 3; c++) {
      int64_t d = 3 * (int64_t)n + c;
      x[c] = problem->reference[d] + state->displacement[d];
    }
    for (int c = 0; c < 3; c++) {
      int p = (c + 1) % 3, q = (c + 2) % 3;
      terms[c][n - first] = m * v[c];
      terms[3 + c][n - first] = m * (x[p] * v[q] - x[q] * v[p]);
    }
  }
}

ct_status ct_momentum_of(const ct_problem *problem, ct_state *state, int32_t body,
                         ct_momentum *momentum, ct_error *error)
{
  ct_status status = begin(problem, state, 0, momentum, error);
  if (status == CT_OK && (body < 0 || body >= problem->body_count))
    status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body, -1, -1},
                     "momentum: there is no body %d", (int)body);
  if (status != CT_OK) return status;
  const ct_body *own = &problem->bodies[body];
  int32_t range[2] = {own->first_node, own->first_node + own->mesh->node_count};
  ct_stream sums[6] = {{0}};
  double terms[6][CT_PIECE];
  for (int32_t i, end; ct_stream_piece(sums, 6, own->mesh->node_count, &i, &end);) {
    momentum_terms(problem, state, range[0] + i, range[0] + end, terms);
    for (int c = 0; c < 6; c++) ct_stream_add(&sums[c], terms[c], end - i);
  }
  *momentum = (ct_momentum){.time = state->time, .body = body};
  for (int c = 0; c < 3; c++) {
    momentum->p[c] = ct_stream_sum(&sums[c]);
    momentum->L[c] = ct_stream_sum(&sums[3 + c]);
  }
  add_impulses(problem, state, CT_EFFECT_CONTACT, range, momentum->contact_impulse);
  add_impulses(problem, state, CT_EFFECT_OBSTACLE, range, momentum->obstacle_impulse);
  add_impulses(problem, state, CT_EFFECT_SUPPORT, range, momentum->support_impulse);
  add_impulses(problem, state, CT_EFFECT_MOTION, range, momentum->support_impulse);
  return CT_OK;
}

void ct_mean_velocity(const ct_problem *problem, const ct_state *state, int32_t first, int32_t end,
                      double *velocity)
{
  double kick = kick_time(problem);
  for (int64_t d = 3 * (int64_t)first; d < 3 * (int64_t)end; d++)
    *velocity++ = 0.5 * (state->velocity[d] + velocity_after(problem, state, kick, d));
}

ct_status ct_state_velocity(const ct_problem *problem, ct_state *state, double *velocity,
                            ct_error *error)
{
  ct_status status = begin(problem, state, 0, velocity, error);
  if (status == CT_OK) ct_mean_velocity(problem, state, 0, problem->node_count, velocity);
  return status;
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
