#include <libcontact/step.h>

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/threads.h"
#include "../base/vector.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

enum { NODES_AT_ONCE = 256, STEPS_BETWEEN_CHECKS = 64, STEPS_BETWEEN_FOLDS = 256 };

/* Kick and drift the degrees of freedom first ... last - 1, and count the work of the first effect.
 */
CT_CLONES
static void advance(int64_t first, int64_t last, double dt, const double *restrict inverse_mass,
                    const double *restrict force, double *restrict displacement,
                    double *restrict velocity, double *restrict work)
{
#pragma omp simd
  for (int64_t d = first; d < last; d++) {
    // -- v_{n+1/2} = v_{n-1/2} + Δt f / m, u_{n+1} = u_n + Δt v_{n+1/2} (eq:leapfrog)
    double before = velocity[d], after = ct_kick(before, dt, inverse_mass[d], force[d]);
    velocity[d] = after;
    displacement[d] += dt * after;
    work[d] += force[d] * (before + after);
  }
}

/* The same where the force is zero as it was in the last step: velocity and work then stay as they
 * are (eq:still-node). */
CT_CLONES
static void drift(int64_t first, int64_t last, double dt, const double *restrict velocity,
                  double *restrict displacement)
{
#pragma omp simd
  for (int64_t d = first; d < last; d++) displacement[d] += dt * velocity[d];
}

/* Whether one of some numbers is -0. */
CT_CLONES
static int has_minus_zero(int64_t first, int64_t last, const double *restrict values)
{
  uint64_t found = 0;
  for (int64_t d = first; d < last; d++) {
    uint64_t bits;
    memcpy(&bits, &values[d], sizeof bits);
    found |= bits == (uint64_t)1 << 63;
  }
  return found != 0;
}

/* The same for integrators whose drift is not the velocity after the kick; the times of the stage
 * are τΔt, cΔt, rΔt, lΔt. */
CT_CLONES
static void advance_stage(int64_t first, int64_t last, const ct_stage *stage, double share,
                          const double *restrict inverse_mass, const double *restrict force,
                          double *restrict past, double *restrict displacement,
                          double *restrict velocity, double *restrict work)
{
  const double tau = stage->drift, c = stage->kick, r = stage->push, l = stage->carry;
#pragma omp simd
  for (int64_t d = first; d < last; d++) {
    // -- v⁺ = v + c Δt a, u⁺ = u + τ Δt (v + r Δt a + l Δt a⁻) with a = f / m (eq:stage)
    double before = velocity[d], after = ct_kick(before, c, inverse_mass[d], force[d]);
    velocity[d] = after;
    displacement[d] += tau * (ct_kick(before, r, inverse_mass[d], force[d]) + l * past[d]);
    past[d] = inverse_mass[d] * force[d];
    work[d] += share * force[d] * (before + after);
  }
}

/* Move the nodes first ... last - 1 by the stage, whose kick is `share` of the step; `fresh`: for
 * the first time in a series. */
static void advance_nodes(const ct_problem *problem, ct_state *state, const ct_stage *stage,
                          double share, int fresh, int32_t first, int32_t last)
{
  const ct_workspace *w = state->workspace;
  double *past = ct_stage_past(problem, state);
  for (int32_t n = first, end; n < last; n = end) {
    int still = ct_bits_get(w->still, n);
    end = ct_bits_next(w->still, n, last, !still);
    int adrift = ct_bits_get(w->adrift, n);
    if (still) end = ct_bits_next(w->adrift, n, end, !adrift);
    if (adrift) continue;
    // Before a series a host may have made a velocity -0, which a force of +0 turns into +0.
    if (still && !(fresh && has_minus_zero(3 * (int64_t)n, 3 * (int64_t)end, state->velocity)))
      drift(3 * (int64_t)n, 3 * (int64_t)end, stage->drift, state->velocity, state->displacement);
    else if (past != NULL)
      advance_stage(3 * (int64_t)n, 3 * (int64_t)end, stage, share, problem->inverse_mass, w->total,
                    past, state->displacement, state->velocity, state->work);
    else
      advance(3 * (int64_t)n, 3 * (int64_t)end, problem->dt, problem->inverse_mass, w->total,
              state->displacement, state->velocity, state->work);
  }
}

/* Before the step: keep what the correction at the nodes with several effects needs. */
static void keep_touched(ct_state *state)
{
  ct_workspace *w = state->workspace;
  for (int32_t i = 0; i < w->touched_count; i++) {
    int64_t dof = 3 * (int64_t)w->touched[i];
    memcpy(&w->touched_velocity[3 * (int64_t)i], &state->velocity[dof], 3 * sizeof(double));
    memcpy(&w->touched_work[3 * (int64_t)i], &state->work[dof], 3 * sizeof(double));
  }
}

/* After the step: the first effect's work at nodes with several effects is that of its own force
 * (eq:work-balance, eq:stage-work). */
static void correct_touched(ct_state *state, double share)
{
  ct_workspace *w = state->workspace;
  for (int32_t i = 0; i < w->touched_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)w->touched[i] + c, own = 3 * (int64_t)i + c;
      state->work[dof] =
          w->touched_work[own] +
          share * w->touched_first[own] * (w->touched_velocity[own] + state->velocity[dof]);
    }
}

/* A number, or +0 where it is not wanted; by its bits, as compilers make a branch of a choice. */
CT_INLINE double only_where(int wanted, double x)
{
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  bits &= -(uint64_t)wanted;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* Take the forces on held degrees of freedom from an impulse. */
CT_CLONES
static void react(int64_t count, double share, const double *restrict inverse_mass,
                  const double *restrict force, double *restrict impulse)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++)
    impulse[d] -= only_where(inverse_mass[d] == 0.0, share * force[d]);
}

/* How many of the nodes i, i + 1, ... of an effect, of `left` that are asked for, have numbers that
 * follow each other. They ascend, so the last one tells. */
static int32_t run_of(const ct_effect *effect, int32_t i, int32_t left)
{
  int32_t count = 1;
  if (effect->nodes == NULL) return left;
  for (int32_t more = 1; more > 0;) {
    int32_t longer = count + more;
    int follows = longer <= left && effect->nodes[i + longer - 1] - effect->nodes[i] == longer - 1;
    count = follows ? longer : count;
    more = follows ? 2 * more : more / 2;
  }
  return count;
}

/* The first of an effect's nodes that is `node` or a later one; it has some. */
static int32_t entry_from(const ct_effect *effect, int32_t node)
{
  int32_t first = 0, last = effect->node_count, start = ct_effect_node(effect, 0);
  // Where the numbers follow each other there is nothing to look for.
  if (effect->nodes == NULL || effect->nodes[last - 1] - start == last - 1)
    return node <= start ? 0 : node - start < last ? node - start : last;
  while (first < last) {
    int32_t middle = first + (last - first) / 2;
    if (effect->nodes[middle] < node) first = middle + 1;
    else last = middle;
  }
  return first;
}

/* The impulse of a reaction at the nodes begin ... end - 1: minus all other forces on the degrees
 * of freedom that it holds (eq:impulse-balance). */
static void count_reaction(const ct_problem *problem, const ct_workspace *w,
                           const ct_effect *effect, double share, int32_t begin, int32_t end,
                           double *impulse)
{
  int32_t stop = entry_from(effect, end);
  for (int32_t i = entry_from(effect, begin), run; i < stop; i += run) {
    int32_t first = ct_effect_node(effect, i);
    run = run_of(effect, i, stop - i);
    for (int32_t n = first, next; n < first + run; n = next) {
      n = ct_bits_next(w->still, n, first + run, 0);
      next = ct_bits_next(w->still, n, first + run, 1);
      int64_t dof = 3 * (int64_t)n;
      react(3 * (int64_t)(next - n), share, &problem->inverse_mass[dof], &w->total[dof],
            &impulse[3 * (int64_t)(i + n - first)]);
    }
  }
}

/* The impulses of all reactions at the nodes begin ... end - 1, whose forces the motion has just
 * read. */
static void count_reactions(const ct_problem *problem, ct_state *state, double share, int32_t begin,
                            int32_t end)
{
  for (int32_t k = 1; k < problem->effect_count; k++)
    if (problem->effects[k]->phase == CT_PHASE_REACTION && problem->effects[k]->node_count > 0)
      count_reaction(problem, state->workspace, problem->effects[k], share, begin, end,
                     state->impulse + ct_state_impulse_start(problem, k));
}

/* Work and impulse of the effects beside the first and the reactions (eq:work-balance,
 * eq:impulse-balance), of a stage whose kick is `share` of the step (eq:stage-work). */
static void count_work(const ct_problem *problem, ct_state *state, double share)
{
  ct_workspace *w = state->workspace;
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double *impulse = state->impulse + ct_state_impulse_start(problem, k),
           *work = state->work + ct_state_work_start(problem, k);
    for (int32_t i = 0, at = 0; effect->phase != CT_PHASE_REACTION && i < effect->node_count; i++) {
      int32_t node = ct_effect_node(effect, i);
      const double *after = &state->velocity[3 * (int64_t)node];
      // Both lists ascend, so a walk finds the velocity before the step.
      while (w->touched[at] < node) at++;
      const double *before = &w->touched_velocity[3 * (int64_t)at],
                   *force = &w->force[k][3 * (int64_t)i];
      for (int64_t c = 0; c < 3; c++) {
        double f = share * force[c];
        work[3 * (int64_t)i + c] += f * (before[c] + after[c]);
        impulse[3 * (int64_t)i + c] += f;
      }
    }
  }
}

/* Put the impulses since the last fold to those before, so that few numbers are added to a large
 * one (eq:impulse-parts). */
static void fold_impulses(ct_state *state)
{
  int64_t count = state->impulse_count / 2;
  for (int64_t i = 0; i < count; i++) {
    state->impulse[count + i] += state->impulse[i];
    state->impulse[i] = 0.0;
  }
}

/* Give nodes the displacement of their leader whose bit is set in word `i` of a table. */
static void follow_leader(const ct_workspace *w, int64_t i, uint64_t bits, double *displacement)
{
  for (const ct_leader *l = w->leaders; bits != 0; bits &= bits - 1) {
    int64_t n = 64 * i + ct_bits_low_zeros(bits);
    while (n < l->first || n >= l->last) l++; // each node that is adrift has one
    memcpy(&displacement[3 * n], l->displacement, sizeof l->displacement);
  }
}

/* Give nodes that are adrift no longer the displacement that their leader has moved to, and move
 * the leaders by the stage (eq:adrift-node). */
static void move_leaders(const ct_problem *problem, ct_state *state, const ct_stage *stage)
{
  const ct_workspace *w = state->workspace;
  int64_t words = ct_bits_words(problem->node_count);
  for (int64_t i = 0; i < words; i++)
    follow_leader(w, i, w->adrift_before[i] & ~w->adrift[i], state->displacement);
  for (int32_t i = 0; i < problem->body_count; i++)
    drift(0, 3, stage->drift, w->leaders[i].velocity, w->leaders[i].displacement);
}

/* Give all nodes that are adrift their displacement. Those that were so before the last evaluation
 * still are if it has failed; otherwise they have drifted like the leader by themselves. */
static void land_all(const ct_problem *problem, ct_state *state)
{
  const ct_workspace *w = state->workspace;
  int64_t words = ct_bits_words(problem->node_count);
  for (int64_t i = 0; i < words; i++)
    follow_leader(w, i, w->adrift_before[i] | w->adrift[i], state->displacement);
}

/* End a series of steps: what stands outside of the time loop is for all to read and to change. */
static void end_series(const ct_problem *problem, ct_state *state)
{
  ct_workspace *w = state->workspace;
  size_t size = (size_t)ct_bits_words(problem->node_count) * sizeof *w->adrift;
  land_all(problem, state);
  memset(w->adrift, 0, size);
  memset(w->adrift_before, 0, size);
  w->watched = 0;
}

/* Take one stage of a step. Forces that stood already may be older than the last change of the
 * state by its host. */
static ct_status take_stage(const ct_problem *problem, ct_state *state, const ct_stage *shares,
                            ct_error *error)
{
  ct_workspace *w = state->workspace;
  int made = w->forces_at != state->step;
  ct_status status = ct_workspace_forces(problem, state, error);
  int fresh = !w->watched;
  w->watched = 0;
  if (status != CT_OK) return status;
  int32_t count = problem->node_count;
  double begin = problem->clock == NULL ? 0.0 : problem->clock();
  keep_touched(state);
  ct_stage stage = ct_stage_now(problem, state);
  move_leaders(problem, state, &stage);
#ifdef _OPENMP
  int threads = ct_threads(problem->threads);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int32_t n = 0; n < count; n += NODES_AT_ONCE) {
    int32_t end = count - n > NODES_AT_ONCE ? n + NODES_AT_ONCE : count;
    advance_nodes(problem, state, &stage, shares->kick, fresh, n, end);
    count_reactions(problem, state, shares->kick, n, end);
  }
  correct_touched(state, shares->kick);
  count_work(problem, state, shares->kick);
  memcpy(state->memory, w->next_memory,
         (size_t)ct_state_memory_start(problem, problem->effect_count) * sizeof(double));
  state->time += stage.drift;
  w->forces_at = -1;
  w->watched = made;
  if (problem->clock != NULL)
    state->effect_seconds[problem->effect_count] += problem->clock() - begin;
  return CT_OK;
}

/* Take a step: its stages one after another (eq:stage). */
static ct_status take_step(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  ct_stage stages[2];
  int count = ct_integrator_stages(&problem->integrator, stages);
  ct_status status = ct_stage_check(state, error);
  for (int i = 0; status == CT_OK && i < count; i++) {
    w->stage = i;
    status = take_stage(problem, state, &stages[i], error);
  }
  if (status != CT_OK) return status;
  w->stage = 0;
  state->step++;
  state->time = (double)state->step * problem->dt;
  if (state->step % STEPS_BETWEEN_FOLDS == 0) fold_impulses(state);
  return CT_OK;
}

ct_status ct_step(const ct_problem *problem, ct_state *state, ct_error *error)
{
  if (problem == NULL || state == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "step: null argument");
  ct_status status = take_step(problem, state, error);
  end_series(problem, state);
  return status;
}

ct_status ct_check_finite(const ct_problem *problem, const ct_state *state, ct_error *error)
{
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++) {
    if (isfinite(state->velocity[d]) && fabs(state->displacement[d]) <= CT_LARGEST_LENGTH) continue;
    int32_t node = (int32_t)(d / 3), body = 0;
    while (body + 1 < problem->body_count && problem->bodies[body + 1].first_node <= node) body++;
    return ct_fail(error, CT_ERROR_BLOWUP,
                   (ct_place){body, -1, node - problem->bodies[body].first_node},
                   "the motion stopped being finite by t = %g (step %lld): body %s, node %d",
                   state->time, (long long)state->step, problem->bodies[body].name,
                   (int)(node - problem->bodies[body].first_node));
  }
  return CT_OK;
}

ct_status ct_step_many(const ct_problem *problem, ct_state *state, int64_t count, ct_error *error)
{
  if (problem == NULL || state == NULL || count < 0)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "step: null argument, or %lld steps",
                   (long long)count);
  ct_status status = CT_OK;
  for (int64_t i = 1; status == CT_OK && i <= count; i++) {
    status = take_step(problem, state, error);
    // An effect may be the first to meet a number that is not finite (CT_INVALID); the answer is
    // the same as without it.
    if (status == CT_INVALID ||
        (status == CT_OK && (i % STEPS_BETWEEN_CHECKS == 0 || i == count))) {
      land_all(problem, state);
      ct_status finite = ct_check_finite(problem, state, error);
      if (finite != CT_OK) status = finite;
    }
  }
  end_series(problem, state);
  return status;
}

ct_status ct_stable_share(const ct_problem *problem, ct_state *state, int32_t k,
                          double *omega_squared, double *rate, ct_error *error)
{
  if (problem == NULL || state == NULL || omega_squared == NULL || rate == NULL || k < 0 ||
      k >= problem->effect_count)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "stable step: null argument or no effect %d", (int)k);
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
  // -- The bound of the elements may be far above the whole (eq:assembled-bound)
  if (status == CT_OK && k == 0 && problem->assembled) {
    double whole = INFINITY;
    status = ct_stable_assembled(problem, state, &whole, error);
    if (status == CT_ERROR_UNSUPPORTED) status = CT_OK;
    *omega_squared = fmin(*omega_squared, whole);
  }
  return status;
}

/* What bounds the step: sums over the effects of ω² and of the damping rate (eq:step-bound,
 * eq:damped-step-bound). */
typedef struct bounds {
  double omega_squared, rate;
} bounds;

/* Whether an effect of this kind acts only where something touches. */
static int is_contact(ct_effect_kind kind)
{
  return kind == CT_EFFECT_CONTACT || kind == CT_EFFECT_FRICTION || kind == CT_EFFECT_OBSTACLE;
}

/* Ask all effects, once with and once without the contacts. */
static ct_status sum_bounds(const ct_problem *problem, ct_state *state, bounds *all,
                            bounds *without_contact, ct_error *error)
{
  *all = *without_contact = (bounds){0.0, 0.0};
  ct_status status = CT_OK;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    bounds own;
    status = ct_stable_share(problem, state, k, &own.omega_squared, &own.rate, error);
    if (status != CT_OK) return status;
    all->omega_squared += own.omega_squared;
    all->rate += own.rate;
    if (is_contact(problem->effects[k]->kind)) continue;
    without_contact->omega_squared += own.omega_squared;
    without_contact->rate += own.rate;
  }
  return status;
}

ct_status ct_stable(const ct_problem *problem, ct_state *state, ct_stable_step *out,
                    ct_error *error)
{
  bounds all, without;
  ct_state *own = NULL;
  if (problem == NULL || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "stable step: null argument");
  ct_status status = state == NULL ? ct_state_create(problem, &own, error) : CT_OK;
  if (status == CT_OK)
    status = sum_bounds(problem, state == NULL ? own : state, &all, &without, error);
  ct_state_free(own);
  if (status != CT_OK) return status;
  out->dt = ct_integrator_step(&problem->integrator, all.omega_squared, all.rate);
  out->dt_without_contact =
      ct_integrator_step(&problem->integrator, without.omega_squared, without.rate);
  out->dt_courant = INFINITY;
  for (int32_t i = 0; i < problem->body_count; i++) {
    double c1, c2;
    ct_material_speeds(&problem->bodies[i].material, &c1, &c2);
    out->dt_courant = fmin(out->dt_courant, ct_mesh_shortest_edge(problem->bodies[i].mesh) / c1);
  }
  return CT_OK;
}
