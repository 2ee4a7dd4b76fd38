/* The moving part of a problem: creating, copying and freeing a state. */
#include <libcontact/ledger.h>

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../solid/sleep.h"
#include "constraints.h"
#include "effect_internal.h"
#include "sums.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

/* Whether two effects have a node in common. */
static int meet(const ct_effect *a, const ct_effect *b)
{
  for (int32_t i = 0; i < a->node_count; i++) {
    const int32_t node = ct_effect_node(a, i), j = ct_effect_below(b, node);
    if (j < b->node_count && ct_effect_node(b, j) == node) return 1;
  }
  return 0;
}

/* Whether an effect that needs all other forces is not the only one on its nodes. */
static int is_second_of_its_phase(const ct_problem *problem, int32_t k)
{
  const ct_effect *effect = problem->effects[k];
  if (effect->phase != CT_PHASE_TOTAL && effect->phase != CT_PHASE_PRESCRIBED) return 0;
  for (int32_t i = 0; i < k; i++)
    if (problem->effects[i]->phase == effect->phase &&
        (effect->phase == CT_PHASE_TOTAL || meet(problem->effects[i], effect)))
      return 1;
  return 0;
}

/* Refuse effects that need the strain of rigid bodies. */
static ct_status check_rigid(const ct_problem *p, ct_error *error)
{
  for (int32_t k = 0; k < p->effect_count; k++)
    for (int32_t i = 1; p->effects[k]->kind == CT_EFFECT_RIGID && i < p->effect_count; i++) {
      const ct_effect *other = p->effects[i];
      const int strains = other->kind == CT_EFFECT_VISCOSITY ||
                          other->kind == CT_EFFECT_STIFFNESS_DAMPING ||
                          other->kind == CT_EFFECT_INITIAL_STRESS;
      if (strains && meet(other, p->effects[k]))
        return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                       "problem: the effect %s acts on a rigid body, which has no strain",
                       other->label);
    }
  return CT_OK;
}

static ct_status check_problem(const ct_problem *p, ct_error *error)
{
  if (p == NULL || p->bodies == NULL || p->reference == NULL || p->mass == NULL ||
      p->inverse_mass == NULL || p->initial_velocity == NULL || p->effects == NULL ||
      p->node_count < 1 || p->body_count < 1 || p->effect_count < 1)
    return CT_REFUSE(error, "problem: bodies, effects, an array or a count is null or 0");
  if (p->effects[0] == NULL || p->effects[0]->nodes != NULL ||
      p->effects[0]->node_count != p->node_count || p->effects[0]->phase != CT_PHASE_STATE)
    return CT_REFUSE(error, "problem: effect 0 must be the solid, which acts on all nodes");
  ct_status known = ct_integrator_check(&p->integrator, error);
  if (known != CT_OK) return known;
  for (int32_t k = 0; k < p->effect_count; k++) {
    if (p->effects[k] == NULL) return CT_REFUSE(error, "problem: effect %d is null", (int)k);
    ct_status status = ct_effect_check(p->effects[k], error);
    if (status == CT_OK) status = ct_effect_check_nodes(p->effects[k], p->node_count, error);
    if (status != CT_OK) return status;
  }
  for (int32_t k = 1; k < p->effect_count; k++) {
    const ct_effect *effect = p->effects[k];
    int32_t read = ct_workspace_read_by(p, k);
    if (is_second_of_its_phase(p, k))
      return CT_REFUSE(error,
                       "problem: effect %s needs the forces of all others, as another one does",
                       effect->label);
    if (effect->reads != NULL && (read < 0 || p->effects[read]->phase > effect->phase))
      return CT_REFUSE(error,
                       "problem: effect %s reads one whose force does not come before its own",
                       effect->label);
  }
  if (!(p->dt > 0.0) || !isfinite(p->dt))
    return CT_REFUSE(error, "problem: dt must be positive and finite, not %g", p->dt);
  if (p->settings.threads < 0 || p->settings.threads > CT_MOST_THREADS)
    return CT_REFUSE(error, "problem: threads must be 0 to %d, not %d", CT_MOST_THREADS,
                     p->settings.threads);
  const double tolerance = p->force_tolerance;
  if (!ct_solver_accepts(tolerance))
    return CT_REFUSE(error, "problem: force_tolerance must be 0 or 1e-12 to 0.1, not %g",
                     tolerance);
  return check_rigid(p, error);
}

static void workspace_free(const ct_problem *problem, ct_workspace *w)
{
  if (w == NULL) return;
  if (w->constraints != NULL) ct_pool_free(w->constraints->solver);
  for (int32_t k = 0; w->scratch != NULL && k < problem->effect_count; k++)
    if (w->scratch[k] != NULL) problem->effects[k]->calls->free_scratch(w->scratch[k]);
  ct_pool_free(w->piece);
  ct_pool_free(w);
}

/* List the nodes on which several effects act. */
static void list_shared(const ct_problem *problem, ct_workspace *w)
{
  char *mark = ct_allocate((size_t)problem->node_count, 1);
  for (int32_t k = 1; mark != NULL && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    for (int32_t i = 0; effect->phase != CT_PHASE_REACTION && i < effect->node_count; i++)
      mark[ct_effect_node(effect, i)] = 1;
  }
  for (int32_t n = 0; mark != NULL && n < problem->node_count; n++) w->shared_count += mark[n];
  size_t count = (size_t)w->shared_count;
  w->shared = ct_pool_take(&w->pool, count, sizeof *w->shared);
  w->shared_first = ct_pool_take(&w->pool, count, 3 * sizeof(double));
  w->pool.failed |= mark == NULL;
  for (int32_t n = 0, next = 0; !w->pool.failed && n < problem->node_count; n++)
    if (mark[n]) w->shared[next++] = n;
  ct_release(mark);
}

/* For each piece of nodes, the places of ascending nodes in it; null: all nodes. */
static int32_t *places_of(const ct_problem *problem, ct_workspace *w, const int32_t *nodes,
                          int32_t count)
{
  int32_t pieces = ct_moved_count(problem),
          *place = ct_pool_take(&w->pool, (size_t)pieces + 1, sizeof *place);
  for (int32_t p = 0, i = 0; place != NULL && p <= pieces; p++) {
    int64_t first = (int64_t)CT_MOVED * p;
    if (nodes == NULL) i = first < count ? (int32_t)first : count;
    while (nodes != NULL && i < count && nodes[i] < first) i++;
    place[p] = i;
  }
  return place;
}

/* The places of all effects' nodes, and of the shared ones. */
static void list_places(const ct_problem *problem, ct_workspace *w)
{
  w->places = ct_pool_take(&w->pool, (size_t)problem->effect_count, sizeof *w->places);
  for (int32_t k = 0; w->places != NULL && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (k == 0) w->places[k] = places_of(problem, w, w->shared, w->shared_count);
    else if (effect->phase != CT_PHASE_REACTION)
      w->places[k] = places_of(problem, w, effect->nodes, effect->node_count);
  }
}

static ct_status workspace_create(const ct_problem *problem, ct_workspace *w, ct_error *error)
{
  size_t n = (size_t)problem->node_count, effects = (size_t)problem->effect_count;
  ct_status status = CT_OK;
  w->forces_at = -1;
  w->total = ct_pool_take(&w->pool, n, 3 * sizeof(double));
  w->force = ct_pool_take(&w->pool, effects, sizeof *w->force);
  w->scratch = ct_pool_take(&w->pool, effects, sizeof *w->scratch);
  w->next_memory = ct_pool_take(
      &w->pool, (size_t)ct_state_starts(problem, problem->effect_count).memory, sizeof(double));
  w->grids = ct_pool_take(&w->pool, ct_sum_grids(problem), sizeof *w->grids);
  w->addends = ct_pool_take(&w->pool, (size_t)problem->body_count, 3 * sizeof *w->addends);
  w->leapfrog = ct_integrator_is_leapfrog(&problem->integrator);
  if (!w->leapfrog && !ct_scheme_of(problem)->stores)
    w->last_acceleration = ct_pool_take(&w->pool, n, 3 * sizeof(double));
  list_shared(problem, w);
  list_places(problem, w);
  ct_constraints_create(problem, w);
  for (int32_t k = 0; status == CT_OK && !w->pool.failed && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (k > 0 && effect->phase != CT_PHASE_REACTION) {
      w->seen |= effect->kind == CT_EFFECT_USER;
      w->force[k] = ct_pool_take(&w->pool, (size_t)effect->node_count, 3 * sizeof(double));
    }
    if (effect->calls->create_scratch != NULL)
      status = effect->calls->create_scratch(effect, &w->scratch[k], error);
  }
  if (status != CT_OK || w->pool.failed) return status == CT_OK ? CT_ERROR_MEMORY : status;
  if (problem->effects[0]->kind == CT_EFFECT_SOLID)
    w->sleep = ((ct_solid_scratch *)w->scratch[0])->sleep;
  ct_sleep_share(w->sleep, w->shared_count, w->shared);
  return CT_OK;
}

void ct_state_free(ct_state *state)
{
  if (state == NULL) return;
  workspace_free(state->problem, state->workspace);
  ct_release(state->displacement);
  ct_release(state);
}

static ct_status no_memory(const ct_problem *problem, ct_error *error)
{
  return CT_NO_MEMORY(error, "a state of %d nodes", (int)problem->node_count);
}

/* The arrays are in one block, those of a restart first, so that a copy takes them at once. */
ct_status ct_state_allocate(const ct_problem *problem, ct_state **out, ct_error *error)
{
  ct_state *s = *out = ct_allocate(1, sizeof *s);
  if (s == NULL) return no_memory(problem, error);
  int64_t dofs = 3 * (int64_t)problem->node_count, all = 0;
  ct_starts end = ct_state_starts(problem, problem->effect_count);
  s->problem = problem;
  s->node_count = problem->node_count;
  s->work_count = end.work;
  s->impulse_count = 2 * end.impulse;
  s->memory_count = end.memory + (ct_scheme_of(problem)->stores ? dofs : 0);
  double **array[] = {&s->displacement, &s->velocity, &s->work,
                      &s->impulse,      &s->memory,   &s->effect_seconds};
  int64_t start[6],
      count[6] = {
          dofs, dofs, s->work_count, s->impulse_count, s->memory_count, problem->effect_count + 1};
  for (int i = 0; i < 6; i++) start[i] = all, all += (count[i] + 7) / 8 * 8;
  double *block = ct_allocate((size_t)all, sizeof *block);
  if (block == NULL) return no_memory(problem, error);
  for (int i = 0; i < 6; i++) *array[i] = block + start[i];
  return CT_OK;
}

ct_status ct_state_equip(ct_state *state, ct_error *error)
{
  if (state->workspace != NULL) return CT_OK;
  ct_workspace *w = ct_allocate(1, sizeof *w);
  ct_status status = w == NULL ? CT_ERROR_MEMORY : workspace_create(state->problem, w, error);
  if (status == CT_OK) state->workspace = w, w->memory = state->memory;
  else workspace_free(state->problem, w);
  return status == CT_ERROR_MEMORY ? no_memory(state->problem, error) : status;
}

/* Fewest degrees of freedom of a thread. */
enum { LEAST_DOFS = 65536 };

/* Velocity half a step before t = 0. */
static void step_back(const ct_problem *problem, ct_state *state)
{
  double back = -ct_integrator_share(&problem->integrator) * problem->dt,
         *last_acceleration = ct_stage_last_acceleration(problem, state);
  int64_t dofs = 3 * (int64_t)problem->node_count;
#ifdef _OPENMP
  int threads = ct_threads_for(problem->settings.threads, dofs, LEAST_DOFS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  // -- v = v_0 - f Δt a_0, a⁻ = a_0 (eq:stage-start)
  for (int64_t d = 0; d < dofs; d++) {
    // -- Half a step back from the initial velocity (eq:stage-start)
    state->velocity[d] = // (eq:leapfrog-start)
        ct_kick(problem->initial_velocity[d], back, problem->inverse_mass[d],
                state->workspace->total[d]);
    if (last_acceleration != NULL)
      last_acceleration[d] = problem->inverse_mass[d] * state->workspace->total[d];
  }
  // A force that depends on velocity was computed with another one; a restart would use this one.
  for (int32_t k = 0; k < problem->effect_count; k++)
    if (problem->effects[k]->calls->bounds.rate != NULL ||
        (problem->effects[k]->phase != CT_PHASE_STATE &&
         problem->effects[k]->phase != CT_PHASE_REACTION))
      state->workspace->forces_at = -1;
  // Constraints that are solved once more begin with their present forces.
  for (int32_t k = 0; k < problem->effect_count; k++) {
    int64_t memory = ct_state_starts(problem, k).memory;
    if (problem->effects[k]->phase == CT_PHASE_CONSTRAINT)
      memcpy(state->memory + memory, state->workspace->next_memory + memory,
             (size_t)problem->effects[k]->memory_count * sizeof(double));
  }
  state->workspace->starting = 0;
}

/* The velocity whose product with a force gives the work to be subtracted at t = 0; `has_begun`: a
 * force begins at the node. */
static inline double start_velocity(const ct_problem *problem, const ct_state *state, double share,
                                    int has_begun, int64_t dof)
{
  if (!has_begun) return state->velocity[dof];
  // v₋ + ¼ Δt a for the leapfrog, whose share is ½ (eq:work-start)
  return ct_kick(state->velocity[dof], 0.5 * share * problem->dt, problem->inverse_mass[dof],
                 state->workspace->total[dof]);
}

/* Initialise the sums of an effect at one node (of the problem), at its place in `work` and
 * `impulse`, or null. */
static inline void start_node(const ct_problem *problem, const ct_state *state, int32_t node,
                              double share, const uint64_t *begun, const double force[3],
                              double *work, double *impulse)
{
  int has_begun = begun != NULL && ct_bits_get(begun, node);
  for (int c = 0; c < 3; c++) {
    if (work != NULL)
      work[c] = -2.0 * share * force[c] *
                start_velocity(problem, state, share, has_begun, 3 * (int64_t)node + c);
    if (impulse != NULL) impulse[c] = -share * force[c];
  }
}

void ct_state_start_ledgers(const ct_problem *problem, ct_state *state)
{
  const ct_workspace *w = state->workspace;
  double share = ct_integrator_share(&problem->integrator);
  const uint64_t *begun = ct_workspace_begun(state);
  // `total` is the first effect's force except at nodes where others were added.
#ifdef _OPENMP
  int threads =
      ct_threads_for(problem->settings.threads, 3 * (int64_t)problem->node_count, LEAST_DOFS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int32_t n = 0; n < problem->node_count; n++)
    start_node(problem, state, n, share, begun, &w->total[3 * (int64_t)n],
               &state->work[3 * (int64_t)n], NULL);
  for (int32_t i = 0; i < w->shared_count; i++)
    start_node(problem, state, w->shared[i], share, begun, &w->shared_first[3 * (int64_t)i],
               &state->work[3 * (int64_t)w->shared[i]], NULL);
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    ct_starts start = ct_state_starts(problem, k);
#ifdef _OPENMP
    threads =
        ct_threads_for(problem->settings.threads, 3 * (int64_t)effect->node_count, LEAST_DOFS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
    for (int32_t i = 0; i < effect->node_count; i++) {
      int64_t d = 3 * (int64_t)i;
      double force[3];
      ct_workspace_force_at(problem, state, k, i, force);
      start_node(problem, state, ct_effect_node(effect, i), share, begun, force,
                 effect->phase == CT_PHASE_REACTION ? NULL : state->work + start.work + d,
                 state->impulse + start.impulse + d);
    }
  }
}

/* The initial motion; each thread is the first to write the nodes that it will move. */
static void start_motion(const ct_problem *problem, ct_state *state)
{
  int64_t dofs = 3 * (int64_t)problem->node_count;
#ifdef _OPENMP
  int threads = ct_threads_for(problem->settings.threads, dofs, LEAST_DOFS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int64_t d = 0; d < dofs; d++) {
    state->velocity[d] = problem->initial_velocity[d];
    if (problem->initial_displacement != NULL)
      state->displacement[d] = problem->initial_displacement[d];
  }
}

ct_status ct_state_begin(const ct_problem *problem, ct_state **out, ct_error *error)
{
  ct_state *state = NULL;
  ct_status status = check_problem(problem, error);
  if (status != CT_OK) return status;
  status = ct_state_allocate(problem, &state, error);
  if (status == CT_OK) status = ct_state_equip(state, error);
  if (status == CT_OK) {
    start_motion(problem, state);
    state->workspace->starting = 1;
    state->workspace->start_dt = problem->dt;
    status = ct_workspace_forces(problem, state, error);
  }
  if (status == CT_OK) *out = state;
  else ct_state_free(state);
  return status;
}

/* Kinetic energy at t = 0, as in a row of the energy balance. */
static ct_status start_kinetic(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_energy energy;
  double *moving = state->workspace->addends;
  for (int32_t b = 0; b < problem->body_count; b++) {
    ct_body_sums sums;
    ct_sum_body(problem, state, b, &sums);
    moving[b] = sums.kinetic;
  }
  state->kinetic_start = ct_sum(moving, problem->body_count);
  // If it is NaN, the error of the whole row gives the reason.
  return isfinite(state->kinetic_start) ? CT_OK : ct_energy_of(problem, state, &energy, error);
}

ct_status ct_state_finish(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  ct_status status = CT_OK;
  // Constraints depend on the next step, and may have been solved for another one; the sleeping
  // elements are known.
  if (w->constraints != NULL && w->start_dt != problem->dt) {
    w->forces_at = -1;
    w->followed = w->known;
    status = ct_workspace_forces(problem, state, error);
    w->followed = 0;
  }
  if (status != CT_OK) return status;
  step_back(problem, state);
  status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  ct_state_start_ledgers(problem, state);
  return start_kinetic(problem, state, error);
}

ct_status ct_state_create(const ct_problem *problem, ct_state **out, ct_error *error)
{
  ct_state *state = NULL;
  if (out == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_state_begin(problem, &state, error);
  if (status == CT_OK) status = ct_state_finish(problem, state, error);
  if (status == CT_OK) *out = state;
  else ct_state_free(state);
  return status;
}

ct_status ct_state_copy(const ct_problem *problem, const ct_state *from, ct_state *to,
                        ct_error *error)
{
  if (problem == NULL || from == NULL || to == NULL || from->node_count != to->node_count ||
      from->work_count != to->work_count || from->impulse_count != to->impulse_count ||
      from->memory_count != to->memory_count)
    return CT_REFUSE(error, "state: the two states are of different problems");
  // A state from a file, or one of a watch, has no workspace, and is between two steps.
  ct_status status = from->workspace == NULL ? CT_OK : ct_stage_check(from, error);
  if (status != CT_OK) return status;
  memcpy(to->displacement, from->displacement,
         (size_t)(from->effect_seconds - from->displacement) * sizeof(double));
  to->step = from->step;
  to->time = from->time;
  to->kinetic_start = from->kinetic_start;
  if (to->workspace == NULL) return CT_OK;
  to->workspace->forces_at = -1;
  to->workspace->stage = 0;
  // Between two steps the last acceleration has no influence; it is cleared because 0 · inf is NaN.
  if (to->workspace->last_acceleration != NULL)
    memset(to->workspace->last_acceleration, 0, 3 * (size_t)problem->node_count * sizeof(double));
  return CT_OK;
}
