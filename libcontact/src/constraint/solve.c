/* The forces of all constraints of a step, found together. */
#include "solve.h"
#include "law.h"

#include <libcontact/base.h>

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../step/workspace.h"

#include <math.h>
#include <string.h>

/* Vectors at nodes have a fourth component, 0, so that they fill a register. */
enum { MOST_ITERATIONS = 500, FACE_NODES = 8, WIDE = 4 };

/* The iteration ends when no force changes by more than this part of the largest. */
static const double TOLERANCE = 1e-10;

void ct_solver_free(const ct_problem *problem, ct_solver *s)
{
  if (s == NULL) return;
  for (int32_t k = 0; s->place != NULL && k < problem->effect_count; k++) ct_release(s->place[k]);
  void *blocks[] = {s->list,  s->sizes, s->first,   s->place,  s->nodes, s->way,   s->mobility,
                    s->push,  s->past,  s->entries, s->active, s->slot,  s->law,   s->free,
                    s->bound, s->guess, s->force,   s->terms,  s->path,  s->begun, s};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
}

/* Number the nodes on which constraints can act. */
static ct_status number_nodes(const ct_problem *problem, ct_solver *s)
{
  int32_t *number = ct_allocate((size_t)problem->node_count, sizeof *number);
  if (number == NULL) return CT_ERROR_MEMORY;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    for (int32_t i = 0; effect->phase == CT_PHASE_CONSTRAINT && i < effect->node_count; i++)
      number[ct_effect_node(effect, i)] = 1;
  }
  for (int32_t n = 0; n < problem->node_count; n++) s->node_count += number[n];
  int32_t longest = 0;
  ct_status status = (s->nodes = ct_allocate((size_t)s->node_count, sizeof *s->nodes)) != NULL
                         ? CT_OK
                         : CT_ERROR_MEMORY;
  for (int32_t n = 0, next = 0; status == CT_OK && n < problem->node_count; n++)
    if (number[n]) {
      s->nodes[next] = n;
      number[n] = next++;
    } else number[n] = -1;
  for (int32_t k = 0; status == CT_OK && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->constraints == NULL) continue;
    if (effect->constraints->increment != NULL && effect->node_count > longest)
      longest = effect->node_count;
    s->place[k] = ct_allocate((size_t)effect->node_count, sizeof *s->place[k]);
    if (s->place[k] == NULL) status = CT_ERROR_MEMORY;
    for (int32_t i = 0; status == CT_OK && i < effect->node_count; i++)
      s->place[k][i] = number[ct_effect_node(effect, i)];
  }
  if (status == CT_OK && longest > 0 &&
      (s->path = ct_allocate((size_t)longest, 3 * sizeof *s->path)) == NULL)
    status = CT_ERROR_MEMORY;
  ct_release(number);
  return status;
}

ct_status ct_solver_create(const ct_problem *problem, ct_solver **out)
{
  int64_t room = 0;
  for (int32_t k = 0; k < problem->effect_count; k++)
    if (problem->effects[k]->phase == CT_PHASE_CONSTRAINT)
      room += problem->effects[k]->constraint_count;
  if (room == 0) return CT_OK;
  ct_solver *s = ct_allocate(1, sizeof *s);
  *out = s;
  if (s == NULL) return CT_ERROR_MEMORY;
  size_t rows = (size_t)room;
  s->room = room;
  s->list = ct_allocate(rows, sizeof *s->list);
  s->sizes = ct_allocate(rows, sizeof *s->sizes);
  s->first = ct_allocate((size_t)problem->effect_count + 1, sizeof *s->first);
  s->place = ct_allocate((size_t)problem->effect_count, sizeof *s->place);
  if (!s->list || !s->sizes || !s->first || !s->place || number_nodes(problem, s) != CT_OK)
    return CT_ERROR_MEMORY;
  double **per_dof[] = {&s->way, &s->mobility, &s->push, &s->past},
         **per_row[] = {&s->free, &s->bound, &s->guess, &s->force};
  for (size_t i = 0; i < sizeof per_dof / sizeof per_dof[0]; i++)
    if ((*per_dof[i] = ct_allocate((size_t)s->node_count, WIDE * sizeof(double))) == NULL)
      return CT_ERROR_MEMORY;
  for (size_t i = 0; i < sizeof per_row / sizeof per_row[0]; i++)
    if ((*per_row[i] = ct_allocate(rows, sizeof(double))) == NULL) return CT_ERROR_MEMORY;
  s->entries = ct_allocate((size_t)s->node_count, sizeof *s->entries);
  s->terms = ct_allocate(2 * rows, sizeof *s->terms);
  s->law = ct_allocate(3 * rows, sizeof *s->law);
  s->begun = ct_allocate((size_t)ct_bits_words(problem->node_count), sizeof *s->begun);
  s->active = ct_allocate(rows, sizeof *s->active);
  s->slot = ct_allocate(rows, 2 * FACE_NODES * sizeof *s->slot);
  return s->entries && s->terms && s->law && s->begun && s->active && s->slot ? CT_OK
                                                                              : CT_ERROR_MEMORY;
}

/* Let every effect list what may press. */
static ct_status list_constraints(const ct_problem *problem, ct_state *state, ct_solver *s,
                                  ct_error *error)
{
  s->first[0] = 0;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    int64_t count = 0;
    if (effect->phase == CT_PHASE_CONSTRAINT) {
      ct_view view = ct_workspace_view(problem, state, k);
      double begin = problem->clock == NULL ? 0.0 : problem->clock();
      ct_status status =
          effect->constraints->list(effect, &view, s->list + s->first[k], &count, error);
      if (status != CT_OK) return status;
      if (problem->clock != NULL) state->effect_seconds[k] += problem->clock() - begin;
    }
    s->first[k + 1] = s->first[k] + count;
  }
  return CT_OK;
}

/* Way of each node until t_{n+1} without the constraints, how far a force moves it, and its way
 * since t_{n-1} (eq:constraint-problem). */
static void predict(const ct_problem *problem, const ct_state *state, ct_solver *s)
{
  // The last evaluation was in the other stage, where there are two.
  ct_stage stages[2];
  int count = ct_integrator_stages(&problem->integrator, stages);
  double before = stages[count - 1 - state->workspace->stage].drift * problem->dt;
  ct_integrator_predict(problem, state, s->node_count, s->nodes, WIDE, s->way, s->mobility);
  for (int32_t i = 0; i < s->node_count; i++)
    for (int64_t c = 0; c < 3; c++)
      s->past[WIDE * (int64_t)i + c] = before * state->velocity[3 * (int64_t)s->nodes[i] + c];
}

/* Degrees of freedom that follow a path: no force moves them. */
static ct_status follow_paths(const ct_problem *problem, const ct_state *state, ct_solver *s,
                              ct_error *error)
{
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->constraints == NULL || effect->constraints->increment == NULL) continue;
    ct_view view = ct_workspace_view(problem, state, k);
    ct_status status = effect->constraints->increment(effect, &view, s->path, error);
    if (status != CT_OK) return status;
    for (int64_t d = 0; d < 3 * (int64_t)effect->node_count; d++) {
      int32_t place = s->place[k][d / 3];
      if (place < 0 || isnan(s->path[d])) continue;
      s->way[WIDE * (int64_t)place + d % 3] = s->path[d];
      s->mobility[WIDE * (int64_t)place + d % 3] = 0.0;
    }
  }
  return CT_OK;
}

/* Σ_a b_a x_a over the nodes of one face, paired so that a flipped face gives the same bits
 * (ct_side_sum, four components side by side). */
static inline void sum_face(int32_t count, const int32_t *slot, const double *b, const double *x,
                            double out[WIDE])
{
  double t[FACE_NODES][WIDE];
  for (int32_t a = 0; a < count; a++) {
    const double *at = &x[WIDE * (int64_t)slot[a]];
#pragma omp simd
    for (int i = 0; i < WIDE; i++) t[a][i] = b[a] * at[i];
  }
  if (count == 3 || count == 6)
    for (int i = 0; i < WIDE; i++) t[count == 3 ? 3 : 6][i] = t[count == 3 ? 3 : 7][i] = 0.0;
#pragma omp simd
  for (int i = 0; i < WIDE; i++) out[i] = (t[0][i] + t[1][i]) + (t[2][i] + t[3][i]);
  if (count <= 4) return;
#pragma omp simd
  for (int i = 0; i < WIDE; i++) out[i] += (t[4][i] + t[6][i]) + (t[5][i] + t[7][i]);
}

/* Σ_a b_a n·x_a for a constraint whose nodes stand at `slot` of x. */
static inline double along(const ct_constraint *c, const int32_t *slot, const double *x)
{
  double own[WIDE], other[WIDE] = {0.0};
  sum_face(c->own, slot, c->b, x, own);
  if (c->other > 0) sum_face(c->other, slot + FACE_NODES, c->b + FACE_NODES, x, other);
  return (c->normal[0] * (own[0] + other[0]) + c->normal[1] * (own[1] + other[1])) +
         c->normal[2] * (own[2] + other[2]);
}

/* Gaps of the steps before and after without the constraints. Those that the motions of this step
 * cannot close are left out (eq:near-constraints). */
static void choose_active(const ct_problem *problem, ct_solver *s)
{
  double most = 0.0;
  for (int32_t k = 0; k < problem->effect_count; k++)
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j++) {
      ct_constraint *c = &s->list[j];
      int32_t *slot = &s->slot[2 * FACE_NODES * j];
      for (int32_t a = 0; a < c->own; a++) slot[a] = s->place[k][c->node[a]];
      for (int32_t a = FACE_NODES; a < FACE_NODES + c->other; a++)
        slot[a] = s->place[k][c->node[a]];
      c->before = c->gap - (along(c, slot, s->past) + c->moved);
      c->after = c->gap + (along(c, slot, s->way) + c->moved);
      most = fmax(most, fmax(fabs(c->after - c->gap), -c->gap));
    }
  s->count = 0;
  s->controlled = 1;
  for (int64_t j = 0; j < s->first[problem->effect_count]; j++) {
    const ct_constraint *c = &s->list[j];
    if (!(fmin(c->gap, c->after) <= 2.0 * most)) continue;
    s->controlled = s->controlled && c->enforcement == CT_ENFORCE_ENERGY_CONTROLLED;
    s->law[s->count] = c->stiffness;
    s->law[s->room + s->count] = c->dissipation;
    s->law[2 * s->room + s->count] = c->gap;
    s->free[s->count] = c->after;
    s->active[s->count++] = j;
  }
}

/* Add b_a times a vector to the sums at the nodes of one face, as multiples of the spacing of the
 * coarse grid: these sums are exact in any order (eq:order-free-sum). */
static inline void add_nodes(const ct_grid *grid, int32_t count, const int32_t *slot,
                             const double *b, const double v[WIDE], double *push)
{
  for (int32_t a = 0; a < count; a++) {
    double *sum = &push[WIDE * (int64_t)slot[a]];
#pragma omp simd
    for (int i = 0; i < WIDE; i++) sum[i] += (b[a] * v[i] + grid->coarse) - grid->coarse;
  }
}

/* The same; with four nodes, as most faces have, the loop is unrolled. */
static inline void add_face(const ct_grid *grid, int32_t count, const int32_t *slot,
                            const double *b, const double v[WIDE], double *push)
{
  if (count == 4) add_nodes(grid, 4, slot, b, v, push);
  else add_nodes(grid, count, slot, b, v, push);
}

CT_CLONES
static void add_rows(const ct_grid *grid, int64_t count, const ct_constraint *list,
                     const int64_t *active, const int32_t *slot, const double *values,
                     double *restrict push)
{
  for (int64_t r = 0; r < count; r++) {
    const ct_constraint *c = &list[active[r]];
    const int32_t *at = &slot[2 * FACE_NODES * active[r]];
    const double v[WIDE] = {values[r] * c->normal[0], values[r] * c->normal[1],
                            values[r] * c->normal[2], 0.0};
    if (values[r] == 0.0) continue;
    add_face(grid, c->own, at, c->b, v, push);
    add_face(grid, c->other, at + FACE_NODES, c->b + FACE_NODES, v, push);
  }
}

/* What forces of the constraints do to nodes, in sums that do not depend on their order: `push`
 * becomes the way A Gᵀ values. */
static int add_up(ct_solver *s, const ct_constraint *list, const double *values)
{
  ct_grid grid;
  double top = 0.0;
  size_t size = WIDE * (size_t)s->node_count * sizeof(double);
  for (int64_t r = 0; r < s->count; r++) top = ct_law_larger(top, fabs(values[r]));
  memset(s->push, 0, size);
  // Shape functions of quadratic faces stay below 1 in size; a factor 2 is room enough.
  if (top == 0.0) return 1;
  if (!ct_grid_init(&grid, 2.0 * top, s->crowd)) return 0;
  add_rows(&grid, s->count, list, s->active, s->slot, values, s->push);
  for (int64_t d = 0; d < WIDE * (int64_t)s->node_count; d++) s->push[d] *= s->mobility[d];
  return 1;
}

/* The largest number of constraints that act on one node. */
static void count_crowd(ct_solver *s)
{
  memset(s->entries, 0, (size_t)s->node_count * sizeof *s->entries);
  s->crowd = 0;
  for (int64_t r = 0; r < s->count; r++) {
    const ct_constraint *c = &s->list[s->active[r]];
    const int32_t *slot = &s->slot[2 * FACE_NODES * s->active[r]];
    for (int32_t a = 0; a < c->own; a++) s->entries[slot[a]]++;
    for (int32_t a = FACE_NODES; a < FACE_NODES + c->other; a++) s->entries[slot[a]]++;
  }
  for (int32_t n = 0; n < s->node_count; n++)
    s->crowd = s->entries[n] > s->crowd ? s->entries[n] : s->crowd;
}

/* Σ_k |W_jk| for each row of W = G (mobility) Gᵀ, or more (eq:constraint-bound). */
static int bound_rows(ct_solver *s)
{
  for (int64_t r = 0; r < s->count; r++) {
    ct_constraint *size = &s->sizes[s->active[r]];
    *size = s->list[s->active[r]];
    for (int32_t a = 0; a < 2 * FACE_NODES; a++) size->b[a] = fabs(size->b[a]);
    for (int i = 0; i < 3; i++) size->normal[i] = fabs(size->normal[i]);
    s->guess[r] = 1.0;
  }
  if (!add_up(s, s->sizes, s->guess)) return 0;
  for (int64_t r = 0; r < s->count; r++)
    s->bound[r] = along(&s->sizes[s->active[r]], &s->slot[2 * FACE_NODES * s->active[r]], s->push);
  return 1;
}

/* The same between two faces of four nodes each, as most are: the numbers stay in registers. */
static inline double along_quadrilaterals(const ct_constraint *c, const int32_t *slot,
                                          const double *x)
{
  double own[WIDE], other[WIDE];
  const double *p[4], *q[4], *b = c->b, *d = c->b + FACE_NODES;
  for (int a = 0; a < 4; a++)
    p[a] = &x[WIDE * (int64_t)slot[a]], q[a] = &x[WIDE * (int64_t)slot[FACE_NODES + a]];
#pragma omp simd
  for (int i = 0; i < WIDE; i++)
    own[i] = (b[0] * p[0][i] + b[1] * p[1][i]) + (b[2] * p[2][i] + b[3] * p[3][i]);
#pragma omp simd
  for (int i = 0; i < WIDE; i++)
    other[i] = (d[0] * q[0][i] + d[1] * q[1][i]) + (d[2] * q[2][i] + d[3] * q[3][i]);
  return (c->normal[0] * (own[0] + other[0]) + c->normal[1] * (own[1] + other[1])) +
         c->normal[2] * (own[2] + other[2]);
}

/* Gaps of the active constraints at t_{n+1} with the way in `push`. */
CT_CLONES
static void find_gaps(int64_t count, const ct_constraint *list, const int64_t *active,
                      const int32_t *slot, const double *free, const double *push, double *gap)
{
  for (int64_t r = 0; r < count; r++) {
    const ct_constraint *c = &list[active[r]];
    const int32_t *at = &slot[2 * FACE_NODES * active[r]];
    gap[r] = free[r] + (c->own == 4 && c->other == 4 ? along_quadrilaterals(c, at, push)
                                                     : along(c, at, push));
  }
}

/* Forces of constraints that are all energy-controlled, several side by side: ct_enforcement_solve
 * of each. */
CT_CLONES
static void solve_controlled(int64_t count, const double *k, const double *s, const double *g,
                             const double *gap, const double *bound, const double *guess,
                             double *next)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++)
    next[r] = ct_law_controlled(k[r], s[r], g[r], gap[r] - bound[r] * guess[r], bound[r]);
}

/* One round: the force of each constraint as if the others stayed as guessed and its own row of W
 * were diagonal. Answers the largest change over the largest force (eq:constraint-iteration). */
static double improve(ct_solver *s, double *next)
{
  double change = 0.0, top = 0.0, *gap = s->terms;
  find_gaps(s->count, s->list, s->active, s->slot, s->free, s->push, gap);
  if (s->controlled)
    solve_controlled(s->count, s->law, s->law + s->room, s->law + 2 * s->room, gap, s->bound,
                     s->guess, next);
  else
    for (int64_t r = 0; r < s->count; r++)
      next[r] = ct_enforcement_solve(&s->list[s->active[r]], gap[r] - s->bound[r] * s->guess[r],
                                     s->bound[r]);
  for (int64_t r = 0; r < s->count; r++) {
    change = ct_law_larger(change, fabs(next[r] - s->guess[r]));
    top = ct_law_larger(top, ct_law_larger(fabs(next[r]), fabs(s->guess[r])));
  }
  return top > 0.0 ? change / top : 0.0;
}

/* Go on from beyond the new forces, farther each time, until that leads uphill
 * (eq:constraint-momentum). `next` becomes the forces. */
static double extrapolate(ct_solver *s, const double *next, double pace)
{
  for (int64_t r = 0; r < s->count; r++)
    s->terms[r] = s->bound[r] * (s->guess[r] - next[r]) * (next[r] - s->force[r]);
  int uphill = ct_sum(s->terms, s->count) > 0.0;
  double faster = uphill ? 1.0 : 0.5 * (1.0 + sqrt(1.0 + 4.0 * pace * pace)),
         share = uphill ? 0.0 : (pace - 1.0) / faster;
  for (int64_t r = 0; r < s->count; r++) {
    double way = next[r] - s->force[r];
    s->guess[r] = next[r] + share * way;
    s->force[r] = next[r];
  }
  return faster;
}

/* Accelerated projected iteration from the forces of the last step. */
static int iterate(ct_solver *s)
{
  double pace = 1.0, *next = s->terms + s->room;
  for (int64_t r = 0; r < s->count; r++) s->guess[r] = s->force[r] = s->list[s->active[r]].force;
  s->converged = 0;
  for (s->iterations = 0; s->iterations < MOST_ITERATIONS && !s->converged; s->iterations++) {
    if (!add_up(s, s->list, s->guess)) return 0;
    double change = improve(s, next);
    s->converged = change <= TOLERANCE;
    // Forces that hold already stay as they are: a start that is made twice gives the same bits.
    if (s->iterations == 0 && change <= 10.0 * TOLERANCE) {
      s->converged = 1;
      break;
    }
    pace = extrapolate(s, next, pace);
  }
  return 1;
}

/* Forces and gaps of the solution into the list. */
static int hand_out(const ct_problem *problem, ct_solver *s)
{
  for (int64_t j = 0; j < s->first[problem->effect_count]; j++) s->list[j].force = 0.0;
  if (!add_up(s, s->list, s->force)) return 0;
  for (int64_t r = 0; r < s->count; r++) s->list[s->active[r]].force = s->force[r];
  for (int64_t j = 0; j < s->first[problem->effect_count]; j++)
    s->list[j].after += along(&s->list[j], &s->slot[2 * FACE_NODES * j], s->push);
  return 1;
}

/* Mark the nodes on which forces begin at t = 0 (eq:energy-start). */
static void mark_start(ct_solver *s)
{
  for (int64_t r = 0; r < s->count; r++) {
    const ct_constraint *c = &s->list[s->active[r]];
    const int32_t *slot = &s->slot[2 * FACE_NODES * s->active[r]];
    for (int32_t a = 0; c->force > 0.0 && ct_law_begins(c) && a < FACE_NODES + c->other; a++)
      if (a < c->own || a >= FACE_NODES)
        ct_bits_put(s->begun, s->nodes[slot[a]], s->nodes[slot[a]] + 1, 1);
  }
}

ct_status ct_solver_solve(const ct_problem *problem, ct_state *state, ct_error *error)
{
  ct_solver *s = state->workspace->solver;
  ct_status status = list_constraints(problem, state, s, error);
  if (state->step == 0)
    memset(s->begun, 0, (size_t)ct_bits_words(problem->node_count) * sizeof *s->begun);
  if (status != CT_OK || s->first[problem->effect_count] == 0) return status;
  double begin = problem->clock == NULL ? 0.0 : problem->clock();
  predict(problem, state, s);
  status = follow_paths(problem, state, s, error);
  if (status != CT_OK) return status;
  choose_active(problem, s);
  count_crowd(s);
  s->iterations = 0;
  s->converged = 1;
  if (!bound_rows(s) || !iterate(s) || !hand_out(problem, s))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                   "the contact forces stopped being finite at t = %g", state->time);
  if (state->step == 0) mark_start(s);
  state->unsettled += !s->converged;
  state->constraint_rounds += s->iterations * s->count;
  // Each effect pays for its part of the list.
  for (int32_t k = 0; problem->clock != NULL && k < problem->effect_count; k++)
    if (problem->effects[k]->phase == CT_PHASE_CONSTRAINT)
      state->effect_seconds[k] += (problem->clock() - begin) *
                                  (double)(s->first[k + 1] - s->first[k]) /
                                  (double)s->first[problem->effect_count];
  return CT_OK;
}
