#include <libcontact/step.h>

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/threads.h"
#include "../solid/sleep.h"
#include "constraints.h"
#include "ledger.h"
#include "piece.h"

#include <string.h>

enum {
  LEAST_NODES = 32768, /* per thread: a fraction of a millisecond */
  STEPS_BETWEEN_CHECKS = 64,
  STEPS_BETWEEN_FOLDS = 256
};

/* Kick and drift degrees of freedom, and add the work of the forces `own` of the first effect.
 * Unless it is null, `sum` gets v_{n-1/2} + v_{n+1/2} for the work of the others. */
CT_INLINE void advance(int64_t count, double dt, const double *restrict inverse_mass,
                       const double *restrict force, const double *restrict own,
                       double *restrict displacement, double *restrict velocity,
                       double *restrict work, double *restrict sum)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++) {
    // -- v_{n+1/2} = v_{n-1/2} + Δt f / m, u_{n+1} = u_n + Δt v_{n+1/2} (eq:leapfrog)
    double before = velocity[d], after = ct_kick(before, dt, inverse_mass[d], force[d]);
    velocity[d] = after;
    displacement[d] += dt * after;
    work[d] += own[d] * (before + after);
    if (sum != NULL) sum[d] = before + after;
  }
}

/* Nodes on which the first effect alone acts. */
CT_CLONES
static void advance_alone(int64_t count, double dt, const double *inverse_mass, const double *force,
                          double *displacement, double *velocity, double *work)
{
  advance(count, dt, inverse_mass, force, force, displacement, velocity, work, NULL);
}

/* Nodes on which others act, too. */
CT_CLONES
static void advance_shared(int64_t count, double dt, const double *inverse_mass,
                           const double *force, const double *own, double *displacement,
                           double *velocity, double *work, double *sum)
{
  advance(count, dt, inverse_mass, force, own, displacement, velocity, work, sum);
}

/* The same for integrators whose drift is not the velocity after the kick; the times of the stage
 * are τΔt, cΔt, rΔt, lΔt. */
CT_CLONES
static void advance_stage(int64_t count, const ct_stage *stage, double share,
                          const double *restrict inverse_mass, const double *restrict force,
                          const double *restrict own, double *restrict last_acceleration,
                          double *restrict displacement, double *restrict velocity,
                          double *restrict work, double *restrict sum)
{
  const double tau = stage->tau, c = stage->c, r = stage->r, l = stage->l;
#pragma omp simd
  for (int64_t d = 0; d < count; d++) {
    // -- v⁺ = v + c Δt a, u⁺ = u + τ Δt (v + r Δt a + l Δt a⁻) with a = f / m (eq:stage)
    double before = velocity[d], after = ct_kick(before, c, inverse_mass[d], force[d]);
    velocity[d] = after;
    displacement[d] +=
        tau * (ct_kick(before, r, inverse_mass[d], force[d]) + l * last_acceleration[d]);
    last_acceleration[d] = inverse_mass[d] * force[d];
    // Half of this is the work of the stage (eq:stage-work).
    work[d] += share * own[d] * (before + after);
    sum[d] = before + after;
  }
}

/* Move the nodes first ... last - 1 by a stage, whose kick is `share` of the step. `own` are the
 * forces of the first effect where others act on all these nodes; null: its work is that of all
 * forces. */
static void advance_nodes(const ct_problem *problem, ct_state *state, const ct_stage *stage,
                          double share, int32_t first, int32_t last, const double *own, double *sum)
{
  const ct_workspace *w = state->workspace;
  const int64_t d = 3 * (int64_t)first, count = 3 * (int64_t)(last - first);
  const double *total = &w->total[d], *inverse_mass = &problem->inverse_mass[d];
  double *u = &state->displacement[d], *v = &state->velocity[d], *work = &state->work[d];
  if (!w->leapfrog)
    advance_stage(count, stage, share, inverse_mass, total, own != NULL ? own : total,
                  ct_stage_last_acceleration(problem, state) + d, u, v, work, sum);
  else if (own == NULL) advance_alone(count, problem->dt, inverse_mass, total, u, v, work);
  else advance_shared(count, problem->dt, inverse_mass, total, own, u, v, work, sum);
  ct_ledger_reactions(problem, state, share, first, last);
}

/* Move the active nodes of a piece (null: all of them are), of which some are shared. Shared nodes
 * are always active. `counts`: whether the work on these is needed. */
static void advance_some(const ct_problem *problem, ct_state *state, const ct_stage *stage,
                         double share, ct_moved piece, const uint64_t *active, int counts,
                         double *sum)
{
  double unused[3 * CT_MOVED], work[3 * CT_MOVED];
  if (counts) ct_ledger_keep(state, piece, sum, work);
  for (int32_t n = piece.first, end; n < piece.last; n = end) {
    end = ct_bits_run(active, &n, piece.last);
    if (n < end) advance_nodes(problem, state, stage, share, n, end, NULL, unused);
  }
  if (counts) ct_ledger_correct(state, share, piece, work, sum);
}

/* Move all nodes by a stage: individually if they are active (null: all of them are), as a whole if
 * they sleep. */
static void move(const ct_problem *problem, ct_state *state, double share, const uint64_t *active)
{
  const ct_workspace *w = state->workspace;
  ct_stage stage = ct_stage_now(problem, state);
  int32_t pieces = ct_moved_count(problem);
#ifdef _OPENMP
  int threads = ct_threads_for(problem->settings.threads, problem->node_count, LEAST_NODES);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int32_t p = 0; p < pieces; p++) {
    double sum[3 * CT_MOVED];
    ct_moved piece = ct_moved_piece(problem, w, p);
    if (w->piece != NULL && ct_bits_next(active, piece.first, piece.last, 1) == piece.last)
      continue;
    // Of all processes the one that has a node counts the work on it.
    const int counts = w->piece == NULL ||
                       ct_bits_next(w->piece->touched, piece.first, piece.last, 1) < piece.last;
    if (counts && piece.shared_last - piece.shared_first == piece.last - piece.first)
      advance_nodes(problem, state, &stage, share, piece.first, piece.last,
                    &w->shared_first[3 * (int64_t)piece.shared_first], sum);
    else advance_some(problem, state, &stage, share, piece, active, counts, sum);
    if (counts && piece.shared_first < piece.shared_last)
      ct_ledger_count(problem, state, share, p, sum);
  }
  if (w->sleep != NULL && active != NULL) ct_sleep_drift(w->sleep, stage.tau);
  state->time += stage.tau;
}

/* Let the observers sample a state whose forces are known. */
static void sample(const ct_observers *samplers, const ct_state *state)
{
  for (int32_t i = 0; i < samplers->count; i++) {
    const ct_observer *o = &samplers->list[i];
    if (o->calls->sample != NULL && state->step % o->every == 0) o->calls->sample(o->data, state);
  }
}

/* What the effects have written is what they read next. An effect of the user may write a part of
 * its memory only, so the other block gets the rest. */
static void turn_memory(const ct_problem *problem, ct_workspace *w)
{
  double *read = w->memory;
  w->memory = w->next_memory;
  w->next_memory = read;
  w->continued = 1;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const int64_t begin = ct_state_starts(problem, k).memory;
    if (problem->effects[k]->kind == CT_EFFECT_USER)
      memcpy(w->next_memory + begin, w->memory + begin,
             (size_t)problem->effects[k]->memory_count * sizeof *w->memory);
  }
}

/* At the end of a series of steps the state holds what the effects read next. */
static void return_memory(const ct_problem *problem, ct_state *state)
{
  ct_workspace *w = state->workspace;
  w->continued = 0;
  if (w->memory == state->memory) return;
  memcpy(state->memory, w->memory,
         (size_t)ct_state_starts(problem, problem->effect_count).memory * sizeof *w->memory);
  w->next_memory = w->memory;
  w->memory = state->memory;
}

/* Take one stage of a step. Known forces, and the set of sleeping elements, may be older than the
 * last change of the state by its host. If `samplers` is null the inlined code has no sampling,
 * so that steps without probes do not pay for it. */
CT_INLINE ct_status take_stage(const ct_problem *problem, ct_state *state, double share,
                               const ct_observers *samplers, ct_error *error)
{
  ct_workspace *w = state->workspace;
  ct_status status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  if (samplers != NULL && w->stage == 0) sample(samplers, state);
  double begin = ct_run_seconds(problem);
  move(problem, state, share,
       w->piece != NULL ? w->piece->held
       : w->known       ? ct_sleep_active(w->sleep)
                        : NULL);
  ct_constraints_share(problem, state, share);
  turn_memory(problem, w);
  w->forces_at = -1;
  w->followed = w->known;
  state->effect_seconds[problem->effect_count] += ct_run_seconds(problem) - begin;
  return CT_OK;
}

/* Take a step: its stages in order (eq:stage). */
CT_INLINE ct_status take_step(const ct_problem *problem, ct_state *state,
                              const ct_observers *samplers, ct_error *error)
{
  ct_workspace *w = state->workspace;
  ct_stage stages[2];
  int count = ct_integrator_stages(&problem->integrator, stages);
  ct_status status = ct_stage_check(state, error);
  for (int i = 0; status == CT_OK && i < count; i++) {
    w->stage = i;
    status = take_stage(problem, state, stages[i].c, samplers, error);
  }
  if (status != CT_OK) return status;
  w->stage = 0;
  state->step++;
  state->time = (double)state->step * problem->dt;
  if (state->step % STEPS_BETWEEN_FOLDS == 0) ct_ledger_fold(state);
  return CT_OK;
}

/* Set the displacement of sleeping nodes. */
static void settle(ct_state *state)
{
  if (state->workspace->followed) ct_sleep_settle(state->workspace->sleep, state->displacement);
}

void ct_series_begin(ct_state *state, int unchanged)
{
  if (!unchanged) state->workspace->known = 0;
}

void ct_series_end(ct_state *state)
{
  settle(state);
  state->workspace->followed = 0;
}

ct_status ct_step(const ct_problem *problem, ct_state *state, ct_error *error)
{
  if (problem == NULL || state == NULL) return CT_REFUSE_NULL(error);
  ct_series_begin(state, 0);
  ct_status status = take_step(problem, state, NULL, error);
  return_memory(problem, state);
  ct_series_end(state);
  return status;
}

CT_INLINE ct_status take_steps(const ct_problem *problem, ct_state *state, int64_t count,
                               const ct_observers *samplers, ct_error *error)
{
  ct_status status = CT_OK;
  for (int64_t i = 1; status == CT_OK && i <= count; i++) {
    status = take_step(problem, state, samplers, error);
    // An effect may be the first to detect a number that is not finite (CT_INVALID); the status is
    // the same as without it.
    if (status == CT_INVALID ||
        (status == CT_OK && (i % STEPS_BETWEEN_CHECKS == 0 || i == count))) {
      settle(state);
      ct_status finite = ct_check_finite(problem, state, error);
      if (finite != CT_OK) status = finite;
      status = ct_piece_agree(state->workspace->piece, status, error);
    }
  }
  return status;
}

ct_status ct_series_steps(const ct_problem *problem, ct_state *state, int64_t count,
                          const ct_observers *samplers, ct_error *error)
{
  ct_status status = samplers == NULL ? take_steps(problem, state, count, NULL, error)
                                      : take_steps(problem, state, count, samplers, error);
  return_memory(problem, state);
  return status;
}
