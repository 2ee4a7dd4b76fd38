/* The moving part of a problem: making, copying and freeing a state, and the forces that belong to
 * it. */
#include <libcontact/step.h>

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/threads.h"
#include "../solid/sleep.h"
#include "constraints.h"
#include "effect_internal.h"
#include "workspace.h"

#include <float.h>
#include <math.h>
#include <string.h>

int64_t ct_state_work_start(const ct_problem *problem, int32_t k)
{
  int64_t start = 0;
  for (int32_t i = 0; i < k; i++)
    if (problem->effects[i]->phase != CT_PHASE_REACTION)
      start += 3 * (int64_t)problem->effects[i]->node_count;
  return start;
}

int64_t ct_state_impulse_start(const ct_problem *problem, int32_t k)
{
  int64_t start = 0;
  for (int32_t i = 1; i < k; i++) start += 3 * (int64_t)problem->effects[i]->node_count;
  return start;
}

int64_t ct_state_memory_start(const ct_problem *problem, int32_t k)
{
  int64_t start = 0;
  for (int32_t i = 0; i < k; i++) start += problem->effects[i]->memory_count;
  return start;
}

double *ct_stage_past(const ct_problem *problem, const ct_state *state)
{
  return problem->integrator.scheme == CT_CHUNG_LEE
             ? state->memory + ct_state_memory_start(problem, problem->effect_count)
             : state->workspace->past;
}

ct_status ct_stage_check(const ct_state *state, ct_error *error)
{
  if (state->workspace->stage == 0) return CT_OK;
  return CT_REFUSE(error, "the state stands within step %lld, whose second stage failed",
                   (long long)state->step);
}

/* Whether the effect that effect `k` reads has its force first: it stands before it, and its phase
 * is no later one. */
static int reads_earlier(const ct_problem *problem, int32_t k)
{
  const ct_effect *effect = problem->effects[k], *other = effect->reads;
  for (int32_t i = 0; i < k; i++)
    if (problem->effects[i] == other) return other->phase <= effect->phase;
  return other == NULL;
}

/* Whether an effect that needs all other forces is not the only one. */
static int is_second_of_its_phase(const ct_problem *problem, int32_t k)
{
  ct_phase phase = problem->effects[k]->phase;
  if (phase != CT_PHASE_TOTAL && phase != CT_PHASE_PRESCRIBED) return 0;
  for (int32_t i = 0; i < k; i++)
    if (problem->effects[i]->phase == phase) return 1;
  return 0;
}

static ct_status check_problem(const ct_problem *p, ct_error *error)
{
  if (p == NULL || p->bodies == NULL || p->reference == NULL || p->mass == NULL ||
      p->inverse_mass == NULL || p->initial_velocity == NULL || p->effects == NULL ||
      p->node_count < 1 || p->body_count < 1 || p->effect_count < 1)
    return CT_REFUSE(error, "problem: something is missing");
  if (p->effects[0] == NULL || p->effects[0]->nodes != NULL ||
      p->effects[0]->node_count != p->node_count || p->effects[0]->phase != CT_PHASE_STATE)
    return CT_REFUSE(error, "problem: the first effect must act on all nodes");
  for (int32_t k = 0; k < p->effect_count; k++) {
    if (p->effects[k] == NULL) return CT_REFUSE(error, "problem: effect %d is null", (int)k);
    ct_status status = ct_effect_check(p->effects[k], error);
    if (status == CT_OK) status = ct_effect_check_nodes(p->effects[k], p->node_count, error);
    if (status != CT_OK) return status;
  }
  for (int32_t k = 1; k < p->effect_count; k++)
    if (is_second_of_its_phase(p, k))
      return CT_REFUSE(error,
                       "problem: effect %s needs the forces of all others, as another one does",
                       p->effects[k]->label);
  for (int32_t k = 1; k < p->effect_count; k++)
    if (!reads_earlier(p, k))
      return CT_REFUSE(error,
                       "problem: effect %s reads one whose force does not come before its own",
                       p->effects[k]->label);
  if (!(p->dt > 0.0) || !isfinite(p->dt) || p->threads < 1 || p->threads > CT_MOST_THREADS)
    return CT_REFUSE(error, "problem: a step of %g with %d threads", p->dt, p->threads);
  return ct_integrator_check(&p->integrator, error);
}

static void workspace_free(const ct_problem *problem, ct_workspace *w)
{
  if (w == NULL) return;
  ct_constraints_free(problem, w->constraints);
  for (int32_t k = 0; k < problem->effect_count; k++) {
    if (w->force != NULL) ct_release(w->force[k]);
    if (w->scratch != NULL && w->scratch[k] != NULL)
      problem->effects[k]->free_scratch(w->scratch[k]);
  }
  void *blocks[] = {w->total,        w->force,           w->scratch,     w->next_memory, w->shared,
                    w->shared_first, w->shared_velocity, w->shared_work, w->past};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
  ct_release(w);
}

/* List the nodes on which several effects act. */
static ct_status list_shared(const ct_problem *problem, ct_workspace *w)
{
  char *mark = ct_allocate((size_t)problem->node_count, 1);
  if (mark == NULL) return CT_ERROR_MEMORY;
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    for (int32_t i = 0; effect->phase != CT_PHASE_REACTION && i < effect->node_count; i++)
      mark[ct_effect_node(effect, i)] = 1;
  }
  for (int32_t n = 0; n < problem->node_count; n++) w->shared_count += mark[n];
  size_t count = (size_t)w->shared_count;
  w->shared = ct_allocate(count, sizeof *w->shared);
  w->shared_first = ct_allocate(count, 3 * sizeof(double));
  w->shared_velocity = ct_allocate(count, 3 * sizeof(double));
  w->shared_work = ct_allocate(count, 3 * sizeof(double));
  ct_status status = w->shared && w->shared_first && w->shared_velocity && w->shared_work
                         ? CT_OK
                         : CT_ERROR_MEMORY;
  int32_t next = 0;
  for (int32_t n = 0; status == CT_OK && n < problem->node_count; n++)
    if (mark[n]) w->shared[next++] = n;
  ct_release(mark);
  return status;
}

static ct_status workspace_create(const ct_problem *problem, ct_workspace **out, ct_error *error)
{
  size_t n = (size_t)problem->node_count, effects = (size_t)problem->effect_count;
  ct_workspace *w = ct_allocate(1, sizeof *w);
  *out = w;
  if (w == NULL) return CT_ERROR_MEMORY;
  w->forces_at = -1;
  w->total = ct_allocate(n, 3 * sizeof(double));
  for (int32_t k = 1; k < problem->effect_count; k++)
    w->seen |= problem->effects[k]->kind == CT_EFFECT_USER &&
               problem->effects[k]->phase != CT_PHASE_REACTION;
  w->force = ct_allocate(effects, sizeof *w->force);
  w->scratch = ct_allocate(effects, sizeof *w->scratch);
  w->next_memory =
      ct_allocate((size_t)ct_state_memory_start(problem, problem->effect_count), sizeof(double));
  if (!w->total || !w->force || !w->scratch || !w->next_memory ||
      list_shared(problem, w) != CT_OK || ct_constraints_create(problem, &w->constraints) != CT_OK)
    return CT_ERROR_MEMORY;
  ct_scheme scheme = problem->integrator.scheme;
  if ((scheme == CT_NOH_BATHE || scheme == CT_TCHAMWA_WIELGOSZ) &&
      (w->past = ct_allocate(n, 3 * sizeof(double))) == NULL)
    return CT_ERROR_MEMORY;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (k > 0 && effect->phase != CT_PHASE_REACTION) {
      w->force[k] = ct_allocate((size_t)effect->node_count, 3 * sizeof(double));
      if (w->force[k] == NULL) return CT_ERROR_MEMORY;
    }
    ct_status status = effect->create_scratch == NULL
                           ? CT_OK
                           : effect->create_scratch(effect, &w->scratch[k], error);
    if (status != CT_OK) return status;
  }
  if (problem->effects[0]->kind == CT_EFFECT_SOLID)
    w->sleep = ((ct_solid_scratch *)w->scratch[0])->sleep;
  ct_sleep_share(w->sleep, w->shared_count, w->shared);
  return CT_OK;
}

void ct_state_free(ct_state *state)
{
  if (state == NULL) return;
  if (state->workspace != NULL) workspace_free(state->problem, state->workspace);
  ct_release(state->displacement);
  ct_release(state->velocity);
  ct_release(state->work);
  ct_release(state->impulse);
  ct_release(state->memory);
  ct_release(state->effect_seconds);
  ct_release(state);
}

static ct_status no_memory(const ct_problem *problem, ct_error *error)
{
  return CT_NO_MEMORY(error, "a state of %d nodes", (int)problem->node_count);
}

ct_status ct_state_allocate(const ct_problem *problem, ct_state **out, ct_error *error)
{
  ct_state *s = ct_allocate(1, sizeof *s);
  *out = s;
  if (s == NULL) return no_memory(problem, error);
  size_t n = (size_t)problem->node_count;
  s->problem = problem;
  s->node_count = problem->node_count;
  s->work_count = ct_state_work_start(problem, problem->effect_count);
  s->impulse_count = 2 * ct_state_impulse_start(problem, problem->effect_count);
  s->memory_count = ct_state_memory_start(problem, problem->effect_count) +
                    (problem->integrator.scheme == CT_CHUNG_LEE ? 3 * (int64_t)n : 0);
  s->displacement = ct_allocate(n, 3 * sizeof(double));
  s->velocity = ct_allocate(n, 3 * sizeof(double));
  s->work = ct_allocate((size_t)s->work_count, sizeof(double));
  s->impulse = ct_allocate((size_t)s->impulse_count, sizeof(double));
  s->memory = ct_allocate((size_t)s->memory_count, sizeof(double));
  s->effect_seconds = ct_allocate((size_t)problem->effect_count + 1, sizeof(double));
  int whole =
      s->displacement && s->velocity && s->work && s->impulse && s->memory && s->effect_seconds;
  return whole ? CT_OK : no_memory(problem, error);
}

ct_status ct_state_equip(ct_state *state, ct_error *error)
{
  if (state->workspace != NULL) return CT_OK;
  ct_status status = workspace_create(state->problem, &state->workspace, error);
  if (status == CT_OK) return CT_OK;
  workspace_free(state->problem, state->workspace);
  state->workspace = NULL;
  return status == CT_ERROR_MEMORY ? no_memory(state->problem, error) : status;
}

/* Half a step back from t = 0 (eq:leapfrog-start, eq:stage-start). */
static void step_back(const ct_problem *problem, ct_state *state)
{
  double back = -ct_integrator_share(&problem->integrator) * problem->dt,
         *past = ct_stage_past(problem, state);
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++) {
    state->velocity[d] = ct_kick(problem->initial_velocity[d], back, problem->inverse_mass[d],
                                 state->workspace->total[d]);
    if (past != NULL) past[d] = problem->inverse_mass[d] * state->workspace->total[d];
  }
  // A force that goes with velocity has seen another one so far; a restart from here would see this
  // one.
  for (int32_t k = 0; k < problem->effect_count; k++)
    if (problem->effects[k]->rate_bound != NULL ||
        (problem->effects[k]->phase != CT_PHASE_STATE &&
         problem->effects[k]->phase != CT_PHASE_REACTION))
      state->workspace->forces_at = -1;
  // Constraints that are solved once more begin with the forces that they have found.
  for (int32_t k = 0; k < problem->effect_count; k++) {
    int64_t memory = ct_state_memory_start(problem, k);
    if (problem->effects[k]->phase == CT_PHASE_CONSTRAINT)
      memcpy(state->memory + memory, state->workspace->next_memory + memory,
             (size_t)problem->effects[k]->memory_count * sizeof(double));
  }
  // With the smallest of all steps a scene asks for the stable one, and no step is chosen yet.
  state->workspace->starting = problem->dt <= DBL_MIN;
}

const uint64_t *ct_workspace_begun(const ct_state *state)
{
  return state->step > 0 || state->workspace->constraints == NULL
             ? NULL
             : state->workspace->constraints->begun;
}

/* The velocity whose product with a force is what the work up to t = 0 must be short of
 * (eq:work-start). */
static double start_velocity(const ct_problem *problem, const ct_state *state,
                             const uint64_t *begun, int64_t dof)
{
  double kick = ct_integrator_share(&problem->integrator) * problem->dt;
  if (begun == NULL || !ct_bits_get(begun, (int32_t)(dof / 3))) return state->velocity[dof];
  return ct_kick(state->velocity[dof], 0.5 * kick, problem->inverse_mass[dof],
                 state->workspace->total[dof]);
}

void ct_state_start_ledgers(const ct_problem *problem, ct_state *state)
{
  double share = ct_integrator_share(&problem->integrator);
  const uint64_t *begun = ct_workspace_begun(state);
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    double *work = state->work + ct_state_work_start(problem, k),
           *impulse = state->impulse + ct_state_impulse_start(problem, k);
    double room[3 * CT_PIECE];
    for (int32_t first = 0, end; first < effect->node_count; first = end) {
      end = ct_piece_end(first, effect->node_count);
      const double *force = ct_workspace_force_of(problem, state, k, first, end, room);
      for (int32_t i = first; i < end; i++)
        for (int c = 0; c < 3; c++) {
          int64_t d = 3 * (int64_t)i + c;
          double f = force[d - 3 * (int64_t)first];
          if (effect->phase != CT_PHASE_REACTION)
            work[d] =
                -2.0 * share * f *
                start_velocity(problem, state, begun, 3 * (int64_t)ct_effect_node(effect, i) + c);
          if (k > 0) impulse[d] = -share * f;
        }
    }
  }
}

ct_status ct_state_create(const ct_problem *problem, ct_state **out, ct_error *error)
{
  ct_energy energy;
  ct_state *state = NULL;
  if (out == NULL) return CT_REFUSE(error, "state: null argument");
  ct_status status = check_problem(problem, error);
  if (status != CT_OK) return status;
  status = ct_state_allocate(problem, &state, error);
  if (status == CT_OK) status = ct_state_equip(state, error);
  if (status == CT_OK) {
    memcpy(state->velocity, problem->initial_velocity,
           3 * (size_t)problem->node_count * sizeof(double));
    state->workspace->starting = 1;
    status = ct_workspace_forces(problem, state, error);
  }
  if (status == CT_OK) {
    step_back(problem, state);
    status = ct_workspace_forces(problem, state, error);
  }
  if (status == CT_OK) {
    ct_state_start_ledgers(problem, state);
    status = ct_energy_of(problem, state, &energy, error);
  }
  if (status != CT_OK) {
    ct_state_free(state);
    return status;
  }
  state->kinetic_start = energy.kinetic;
  *out = state;
  return CT_OK;
}

ct_status ct_state_copy(const ct_problem *problem, const ct_state *from, ct_state *to,
                        ct_error *error)
{
  if (problem == NULL || from == NULL || to == NULL || from->node_count != to->node_count ||
      from->work_count != to->work_count || from->impulse_count != to->impulse_count ||
      from->memory_count != to->memory_count)
    return CT_REFUSE(error, "state: the two states are of different problems");
  // One that was read from a file, or is kept by a watch, has no workspace, and stands between two
  // steps.
  ct_status status = from->workspace == NULL ? CT_OK : ct_stage_check(from, error);
  if (status != CT_OK) return status;
  size_t n = 3 * (size_t)problem->node_count;
  memcpy(to->displacement, from->displacement, n * sizeof(double));
  memcpy(to->velocity, from->velocity, n * sizeof(double));
  memcpy(to->work, from->work, (size_t)from->work_count * sizeof(double));
  memcpy(to->impulse, from->impulse, (size_t)from->impulse_count * sizeof(double));
  memcpy(to->memory, from->memory, (size_t)from->memory_count * sizeof(double));
  to->step = from->step;
  to->time = from->time;
  to->kinetic_start = from->kinetic_start;
  if (to->workspace == NULL) return CT_OK;
  to->workspace->forces_at = -1;
  to->workspace->stage = 0;
  // Between two steps the acceleration before counts for nothing, but nothing times what is not
  // finite is not nothing.
  if (to->workspace->past != NULL) memset(to->workspace->past, 0, n * sizeof(double));
  return CT_OK;
}

void ct_integrator_predict(const ct_problem *problem, const ct_state *state, int32_t count,
                           const int32_t *nodes, int stride, double *way, double *mobility)
{
  ct_stage stage = ct_stage_now(problem, state);
  const double *past = ct_stage_past(problem, state);
  double push = stage.r;
  // -- At the start the acceleration before is that of t = 0, and the velocity has its share of it
  // already (eq:stage-start)
  if (state->workspace->starting) {
    push = stage.r + stage.l - ct_integrator_share(&problem->integrator) * problem->dt;
    past = NULL;
  }
  for (int32_t i = 0; i < count; i++)
    for (int64_t c = 0; c < 3; c++) {
      int64_t own = stride * (int64_t)i + c, dof = 3 * (int64_t)nodes[i] + c;
      double velocity = ct_kick(state->velocity[dof], push, problem->inverse_mass[dof],
                                state->workspace->total[dof]);
      if (past != NULL) velocity += stage.l * past[dof];
      way[own] = stage.tau * velocity;
      mobility[own] = stage.tau * push * problem->inverse_mass[dof];
    }
}

/* Scratch space of the effect that effect `k` reads. */
static const void *scratch_read(const ct_problem *problem, const ct_state *state, int32_t k)
{
  const ct_effect *other = problem->effects[k]->reads;
  for (int32_t i = 0; other != NULL && i < k; i++)
    if (problem->effects[i] == other) return state->workspace->scratch[i];
  return NULL;
}

ct_view ct_workspace_view(const ct_problem *problem, const ct_state *state, int32_t k)
{
  int64_t memory = ct_state_memory_start(problem, k);
  ct_stage stage =
      state->workspace->starting ? (ct_stage){0.0, 0.0, 0.0, 0.0} : ct_stage_now(problem, state);
  return (ct_view){.time = state->time,
                   .threads = ct_threads(problem->threads),
                   .reference = problem->reference,
                   .displacement = state->displacement,
                   .velocity = state->velocity,
                   .memory = state->memory + memory,
                   .next_memory = state->workspace->next_memory + memory,
                   .scratch = state->workspace->scratch[k],
                   .read = scratch_read(problem, state, k),
                   .dt = stage.tau,
                   .c_dt = stage.c,
                   .r_dt = stage.r,
                   .l_dt = stage.l,
                   .acceleration_before = ct_stage_past(problem, state),
                   .total = state->workspace->total};
}

/* The first of the shared nodes that is `node` or a later one. */
static int32_t shared_from(const ct_workspace *w, int32_t node)
{
  int32_t first = 0, last = w->shared_count;
  while (first < last) {
    int32_t middle = first + (last - first) / 2;
    if (w->shared[middle] < node) first = middle + 1;
    else last = middle;
  }
  return first;
}

const double *ct_workspace_force_of(const ct_problem *problem, const ct_state *state, int32_t k,
                                    int32_t first, int32_t last, double *room)
{
  const ct_workspace *w = state->workspace;
  const ct_effect *effect = problem->effects[k];
  if (k > 0 && effect->phase != CT_PHASE_REACTION) return &w->force[k][3 * (int64_t)first];
  if (k == 0) {
    // The first effect's force stands in `total`, but for the nodes where others were added.
    int32_t i = shared_from(w, first), end = shared_from(w, last);
    if (i == end) return &w->total[3 * (int64_t)first];
    memcpy(room, &w->total[3 * (int64_t)first], 3 * (size_t)(last - first) * sizeof *room);
    for (; i < end; i++)
      memcpy(&room[3 * (int64_t)(w->shared[i] - first)], &w->shared_first[3 * (int64_t)i],
             3 * sizeof *room);
    return room;
  }
  for (int32_t i = first; i < last; i++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)ct_effect_node(effect, i) + c;
      room[3 * (int64_t)(i - first) + c] = problem->inverse_mass[dof] == 0.0 ? -w->total[dof] : 0.0;
    }
  return room;
}

/* Count the elements whose forces the solid effect has computed, and those that it has left out. */
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
  double *force = k == 0 ? w->total : w->force[k],
         begin = problem->clock == NULL ? 0.0 : problem->clock();
  ct_status status = effect->force(effect, &view, force, error);
  if (status != CT_OK) return status;
  if (problem->clock != NULL) state->effect_seconds[k] += problem->clock() - begin;
  if (k == 0) count_updates(problem, state);
  for (int32_t i = 0; k == 0 && i < w->shared_count; i++)
    memcpy(&w->shared_first[3 * (int64_t)i], &w->total[3 * (int64_t)w->shared[i]],
           3 * sizeof(double));
  for (int32_t i = 0; k > 0 && i < effect->node_count; i++)
    for (int c = 0; c < 3; c++)
      w->total[3 * (int64_t)ct_effect_node(effect, i) + c] += force[3 * (int64_t)i + c];
  return CT_OK;
}

/* Find out what sleeps. The force is zero at nodes that no active element has (eq:sleep). */
static void find_sleep(const ct_problem *problem, ct_state *state)
{
  ct_workspace *w = state->workspace;
  if (w->sleep == NULL) return;
  if (w->followed) {
    ct_sleep_wake(w->sleep, state->displacement);
    for (int32_t i = 0; i < w->shared_count; i++)
      memset(&w->total[3 * (int64_t)w->shared[i]], 0, 3 * sizeof(double));
  } else {
    ct_sleep_examine(w->sleep, state->displacement, state->velocity, ct_stage_past(problem, state));
    memset(w->total, 0, 3 * (size_t)problem->node_count * sizeof(double));
  }
  if (w->seen) ct_sleep_settle(w->sleep, state->displacement);
}

ct_status ct_workspace_forces(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_workspace *w = state->workspace;
  if (w->forces_at == state->step) return CT_OK;
  w->forces_at = -1;
  find_sleep(problem, state);
  for (int phase = CT_PHASE_STATE; phase < CT_PHASE_REACTION; phase++) {
    ct_status status = phase == CT_PHASE_CONSTRAINT && w->constraints != NULL
                           ? ct_constraints_solve(problem, state, error)
                           : CT_OK;
    for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++)
      if ((int)problem->effects[k]->phase == phase) status = add_effect(problem, state, k, error);
    if (status != CT_OK) return status;
  }
  w->forces_at = state->step;
  return CT_OK;
}
