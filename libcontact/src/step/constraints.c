/* The constraints of a step: listed by their effects, solved together. */
#include "constraints.h"

#include "../constraint/bodies.h"

#include "../base/bits.h"
#include "../constraint/law.h"
#include "../constraint/problem.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "layers.h"
#include "piece.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

/* Largest number of nodes of a row of an effect. */
static int32_t row_nodes(const ct_effect *effect)
{
  return effect->constraint_nodes > 0 ? effect->constraint_nodes : CT_ROW_NODES;
}

/* The rows of an effect. Friction adds its law to rows that another effect lists, but for those of
 * an explicit penalty, which it lists itself. */
static ct_row_set set_of(const ct_effect *effect)
{
  const int rubs = effect->kind == CT_EFFECT_FRICTION,
            added = rubs && effect->reads->phase == CT_PHASE_CONSTRAINT;
  return (ct_row_set){.most = added ? 0 : effect->constraint_count,
                      .node_count = effect->node_count,
                      .nodes = effect->nodes,
                      .row_nodes = row_nodes(effect),
                      .slips = rubs ? effect->constraint_count : 0,
                      .foreign = effect->kind == CT_EFFECT_USER};
}

/* Places of the nodes of effects that prescribe motion among the solver's nodes. */
static void find_places(const ct_problem *problem, const int32_t *number, ct_constraints *c,
                        ct_pool *pool)
{
  int32_t longest = 0;
  for (int32_t k = 0; !pool->failed && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    const int moves = effect->calls->constraints.increment != NULL;
    if (!moves && effect->calls->constraints.slow == NULL) continue;
    if (moves && effect->node_count > longest) longest = effect->node_count;
    c->place[k] = ct_pool_take(pool, (size_t)effect->node_count, sizeof *c->place[k]);
    for (int32_t i = 0; c->place[k] != NULL && i < effect->node_count; i++)
      c->place[k][i] = number[ct_effect_node(effect, i)];
  }
  if (longest > 0) c->increment = ct_pool_take(pool, (size_t)longest, 3 * sizeof *c->increment);
}

/* The rigid bodies among the solver's nodes. */
static void find_bodies(const ct_problem *problem, ct_constraints *c, ct_pool *pool)
{
  int32_t count = 0, *of = ct_allocate((size_t)c->solver->node_count, sizeof *of);
  c->rigid = -1;
  for (int32_t k = 0; k < problem->effect_count; k++)
    if (problem->effects[k]->calls->constraints.mobility != NULL) c->rigid = k;
  pool->failed |= of == NULL;
  if (c->rigid < 0 || pool->failed) {
    ct_release(of);
    return;
  }
  const ct_effect *effect = problem->effects[c->rigid];
  for (int32_t n = 0; n < c->solver->node_count; n++) of[n] = -1;
  for (int32_t i = 0, last = -1; i < effect->node_count; i++) {
    const int32_t body = ct_effect_body_of(problem, ct_effect_node(effect, i));
    if (body != last) count++;
    if (c->place[c->rigid][i] >= 0) of[c->place[c->rigid][i]] = count - 1;
    last = body;
  }
  c->bodies = ct_pool_take(pool, (size_t)count, sizeof *c->bodies);
  c->arms = ct_pool_take(pool, (size_t)effect->node_count, 3 * sizeof *c->arms);
  c->solver->bodies = ct_bodies_create(c->solver, count, of);
  pool->failed |= c->solver->pool.failed;
  ct_release(of);
}

void ct_constraints_create(const ct_problem *problem, ct_workspace *w)
{
  size_t effects = (size_t)problem->effect_count;
  ct_row_set *sets = ct_allocate(effects, sizeof *sets);
  int32_t count = 0, *number = ct_allocate((size_t)problem->node_count, sizeof *number);
  w->pool.failed |= sets == NULL || number == NULL;
  for (int32_t k = 0; sets != NULL && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->phase == CT_PHASE_CONSTRAINT) sets[count++] = set_of(effect);
  }
  if (count > 0 && !w->pool.failed) {
    ct_constraints *c = w->constraints = ct_pool_take(&w->pool, 1, sizeof *c);
    int32_t **place = ct_pool_take(&w->pool, effects, sizeof *place);
    uint64_t *begun =
        ct_pool_take(&w->pool, (size_t)ct_bits_words(problem->node_count), sizeof *begun);
    int32_t *listing = ct_pool_take(&w->pool, (size_t)count, sizeof *listing);
    if (!w->pool.failed) {
      c->place = place, c->begun = begun, c->effects = listing;
      for (int32_t k = 0; k < problem->effect_count; k++)
        if (problem->effects[k]->phase == CT_PHASE_CONSTRAINT) *listing++ = k;
      w->pool.failed =
          ct_solver_create(sets, count, problem->node_count, number, &c->solver) != CT_OK;
      find_places(problem, number, c, &w->pool);
      if (!w->pool.failed) {
        ct_layers_find(problem, sets, count, c->solver);
        w->pool.failed = c->solver->pool.failed;
      }
      if (!w->pool.failed) find_bodies(problem, c, &w->pool);
    }
  }
  ct_release(number);
  ct_release(sets);
}

/* Whether the nodes of a row are in the list of its effect. */
static int has_places(const ct_effect *effect, int32_t count, const int32_t *place,
                      const double *shape)
{
  int fine = count >= 0 && count <= 8 && (count == 0 || (place != NULL && shape != NULL));
  for (int32_t a = 0; fine && a < count; a++) fine = place[a] >= 0 && place[a] < effect->node_count;
  return fine;
}

/* Check the rows that an effect has listed; those of the library need no check. */
static ct_status check_rows(const ct_effect *effect, ct_constraint *const *rows, int64_t count,
                            ct_error *error)
{
  int fine = count >= 0 && count <= effect->constraint_count;
  for (int64_t r = 0; fine && effect->kind == CT_EFFECT_USER && r < count; r++) {
    const ct_constraint *row = rows[r];
    fine = row != NULL && row->slip == NULL && ct_law_check(row, effect->label, NULL) == CT_OK &&
           ct_law_has_rows(row->enforcement) &&
           has_places(effect, row->own_count, row->own, row->own_shape) &&
           has_places(effect, row->other_count, row->other, row->other_shape) &&
           row->own_count + row->other_count <= row_nodes(effect);
  }
  if (fine) return CT_OK;
  return CT_REFUSE(error,
                   "effect %s: of its %lld rows, at most %lld, one is null or has a law, nodes or "
                   "weights that are not valid",
                   effect->label, (long long)count, (long long)effect->constraint_count);
}

/* A state whose effects list their rows. */
typedef struct lister {
  const ct_problem *problem;
  ct_state *state;
} lister;

/* Let an effect list the rows that may be active. */
static ct_status list_rows(void *user, int32_t set, ct_constraint **rows, int64_t *count,
                           ct_error *error)
{
  const lister *from = user;
  const ct_problem *problem = from->problem;
  const int32_t k = from->state->workspace->constraints->effects[set];
  const ct_effect *effect = problem->effects[k];
  ct_view view = ct_workspace_view(problem, from->state, k);
  double begin = ct_run_seconds(problem);
  ct_status status = effect->calls->constraints.list(effect, &view, rows, count, error);
  if (status == CT_OK) status = check_rows(effect, rows, *count, error);
  from->state->effect_seconds[k] += ct_run_seconds(problem) - begin;
  return status;
}

/* The motion of the present stage without the constraints (eq:stage). */
static ct_prediction predict(const ct_problem *problem, const ct_state *state)
{
  // With two stages the last evaluation was in the other one.
  ct_stage stages[2], stage = ct_stage_now(problem, state);
  int count = ct_integrator_stages(&problem->integrator, stages);
  ct_prediction p = {.tau = stage.tau,
                     .force_time = stage.r,
                     .l = stage.l,
                     .whole = stage.r,
                     .before = stages[count - 1 - state->workspace->stage].tau * problem->dt,
                     .velocity = state->velocity,
                     .inverse_mass = problem->inverse_mass,
                     .force = state->workspace->total,
                     .acceleration = ct_stage_last_acceleration(problem, state)};
  // -- Before t = 0 there was no step: g_{-1} = g_0 (eq:energy-start)
  if (state->step == 0 && state->workspace->stage == 0) p.before = 0.0;
  // -- At the start the last acceleration is that of t = 0, and the velocity already contains its
  // part of it (eq:stage-start)
  if (state->workspace->starting) {
    p.force_time = stage.r + stage.l - ct_integrator_share(&problem->integrator) * problem->dt;
    p.acceleration = NULL;
  }
  p.again = p.before == 0.0 && !state->workspace->starting;
  return p;
}

/* The view of an effect that moves nodes. The first step of a rigid body is known while the state
 * is created, too. */
static ct_view view_of(const ct_problem *problem, const ct_state *state, const ct_prediction *p,
                       int32_t k)
{
  ct_view view = ct_workspace_view(problem, state, k);
  if (k != state->workspace->constraints->rigid || !state->workspace->starting) return view;
  view.dt = p->tau;
  view.r_dt = p->force_time;
  view.l_dt = 0.0;
  return view;
}

/* How forces move the rigid bodies (eq:rigid-mobility). */
static ct_status move_bodies(const ct_problem *problem, const ct_state *state,
                             const ct_prediction *p, ct_error *error)
{
  ct_constraints *c = state->workspace->constraints;
  if (c->rigid < 0) return CT_OK;
  const ct_effect *effect = problem->effects[c->rigid];
  const ct_view view = view_of(problem, state, p, c->rigid);
  ct_bodies *bodies = c->solver->bodies;
  ct_status status = effect->calls->constraints.mobility(effect, &view, c->bodies, c->arms, error);
  for (int32_t b = 0; b < bodies->count; b++) {
    memcpy(bodies->translation[b], c->bodies[b].translation, sizeof bodies->translation[b]);
    memcpy(bodies->rotation[b], c->bodies[b].rotation, sizeof bodies->rotation[b]);
  }
  for (int32_t i = 0; i < effect->node_count; i++)
    if (c->place[c->rigid][i] >= 0)
      memcpy(&bodies->arm[3 * (int64_t)c->place[c->rigid][i]], &c->arms[3 * (int64_t)i],
             3 * sizeof *c->arms);
  return status;
}

/* Degrees of freedom with prescribed motion, which no force moves, and those of rigid bodies. */
static ct_status prescribe(const ct_problem *problem, const ct_state *state, const ct_prediction *p,
                           ct_error *error)
{
  ct_constraints *c = state->workspace->constraints;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->calls->constraints.increment == NULL) continue;
    ct_view view = view_of(problem, state, p, k);
    ct_status status = effect->calls->constraints.increment(effect, &view, c->increment, error);
    if (status != CT_OK) return status;
    for (int64_t d = 0; d < 3 * (int64_t)effect->node_count; d++) {
      int64_t place = c->place[k][d / 3], dof = CT_SOLVER_WIDE * place + d % 3;
      if (place < 0 || isnan(c->increment[d])) continue;
      c->solver->increment[dof] = c->increment[d];
      c->solver->mobility[dof] = 0.0;
    }
  }
  return CT_OK;
}

/* Slow a rigid body down, and all motion that forces cause of it. */
static void slow_body(ct_bodies *bodies, int32_t b, double a)
{
  for (int k = 0; k < 3; k++) bodies->translation[b][k] /= 1.0 + a;
  for (int k = 0; k < 6; k++) bodies->rotation[b][k] /= 1.0 + a;
}

/* What dynamic relaxation slows down, whatever forces act on it (eq:relaxation-force): all but
 * prescribed motion. */
static ct_status slow_down(const ct_problem *problem, const ct_state *state, const ct_prediction *p,
                           ct_error *error)
{
  ct_constraints *c = state->workspace->constraints;
  ct_solver *s = c->solver;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->calls->constraints.slow == NULL) continue;
    const ct_view view = ct_workspace_view(problem, state, k);
    double a = 0.0;
    ct_status status = effect->calls->constraints.slow(effect, &view, &a, error);
    if (status != CT_OK) return status;
    for (int32_t i = 0, last = -1; a != 0.0 && i < effect->node_count; i++) {
      const int32_t place = c->place[k][i];
      const int32_t body = place < 0 || s->bodies == NULL ? -1 : s->bodies->of[place];
      if (body >= 0 && body != last) slow_body(s->bodies, last = body, a);
      const double *v = &p->velocity[3 * (int64_t)ct_effect_node(effect, i)];
      for (int64_t j = 0, dof = CT_SOLVER_WIDE * (int64_t)place; place >= 0 && j < 3; j++, dof++) {
        if (body < 0 && s->mobility[dof] == 0.0) continue;
        s->increment[dof] = (s->increment[dof] - a * p->tau * v[j]) / (1.0 + a);
        s->mobility[dof] /= 1.0 + a;
      }
    }
  }
  return CT_OK;
}

/* Mark the nodes on which forces begin at t = 0 (eq:energy-start). */
static void mark_start(const ct_solver *s, uint64_t *begun)
{
  const double *force = s->force;
  for (const ct_group *g = s->groups; g < s->groups + s->group_count; force += g->rows, g++) {
    int some = 0;
    for (int32_t r = 0; r < g->rows; r++) some |= force[r] != 0.0;
    for (int64_t i = g->place; some && i < g->place + g->own + g->other; i++) {
      const int32_t node = s->nodes[s->entry_place[i] / CT_SOLVER_WIDE];
      ct_bits_put(begun, node, node + 1, 1);
    }
  }
}

ct_status ct_constraints_solve(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_constraints *c = state->workspace->constraints;
  ct_solver *s = c->solver;
  ct_status status = ct_rows_list_all(s, list_rows, &(lister){problem, state}, error);
  if (state->step == 0)
    memset(c->begun, 0, (size_t)ct_bits_words(problem->node_count) * sizeof *c->begun);
  int64_t rows = status == CT_OK ? s->first[s->set_count] : 0;
  status = ct_piece_agree_on(state->workspace->piece, status, &rows, error);
  c->solved = 0;
  if (status != CT_OK || rows == 0) return status;
  double begin = ct_run_seconds(problem);
  const ct_prediction p = predict(problem, state);
  s->tolerance = ct_solver_tolerance(problem->force_tolerance);
  ct_rows_predict(s, &p);
  status = prescribe(problem, state, &p, error);
  if (status == CT_OK) status = move_bodies(problem, state, &p, error);
  if (status == CT_OK) status = slow_down(problem, state, &p, error);
  if (s->bodies != NULL) ct_bodies_bound(s->bodies);
  if (status == CT_OK) status = ct_rows_solve(s, state->time, error);
  if (status == CT_OK && s->bodies != NULL) c->solved = ct_solver_follow(s);
  if (status != CT_OK) return status;
  if (state->step == 0) mark_start(s, c->begun);
  state->unconverged += !s->converged;
  state->constraint_rounds += s->iterations * s->count;
  // The time is charged to each effect in proportion to its rows.
  for (int32_t set = 0; set < s->set_count; set++) {
    double share = (double)(s->first[set + 1] - s->first[set]) / (double)rows;
    state->effect_seconds[c->effects[set]] += (ct_run_seconds(problem) - begin) * share;
  }
  return CT_OK;
}

/* Let the rigid bodies do the work that the rows of one set do on the part of their motion that the
 * solver does not know. */
static void share_work(const ct_problem *problem, ct_state *state, int32_t set, double share)
{
  const ct_workspace *w = state->workspace;
  const ct_constraints *c = w->constraints;
  const ct_solver *s = c->solver;
  const int32_t k = c->effects[set];
  const ct_effect *effect = problem->effects[k], *rigid = problem->effects[c->rigid];
  double *own = state->work + ct_state_starts(problem, k).work,
         *theirs = state->work + ct_state_starts(problem, c->rigid).work;
  for (int32_t i = 0; i < effect->node_count; i++) {
    const int32_t node = ct_effect_node(effect, i), at = s->place[s->first_node[set] + i];
    if (s->bodies->of[at] < 0 || s->row_counts[at] == 0) continue;
    const int64_t to = 3 * (int64_t)ct_effect_below(rigid, node);
    for (int j = 0; j < 3; j++) {
      const int64_t place = CT_SOLVER_WIDE * (int64_t)at + j;
      const double linear = (s->increment[place] + s->moved[place]) / problem->dt;
      // -- f (v - w) of the true velocity and the linear one (eq:rigid-turned)
      const double work = share * w->force[k][3 * (int64_t)i + j] *
                          (state->velocity[3 * (int64_t)node + j] - linear);
      own[3 * (int64_t)i + j] -= work;
      theirs[to + j] += work;
    }
  }
}

void ct_constraints_share(const ct_problem *problem, ct_state *state, double share)
{
  const ct_constraints *c = state->workspace->constraints;
  if (c == NULL || !c->solved || !state->workspace->leapfrog) return;
  for (int32_t set = 0; set < c->solver->set_count; set++) share_work(problem, state, set, share);
}
