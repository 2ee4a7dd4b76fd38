/* The tangential forces of a step, within the discs of all points (eq:slip-problem). */
#include "tangent.h"

#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "matrix.h"
#include "tangent_follow.h"
#include "tangent_iterate.h"
#include "tangent_laws.h"
#include "tangent_matrix.h"
#include "tangent_settle.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, MOST_ROUNDS = 1000 };

/* The iteration ends when the largest change of a force is below this fraction of the largest
 * force, or, while energy appears, a smaller one. */
static const double TOLERANCE = 1e-4, TIGHT = 1e-8;

/* The limits are computed again once if a normal force has changed by more than this fraction of
 * the largest. */
static const double LIMIT_CHANGE = 0.01;

void ct_tangent_create(ct_solver *s, int64_t most)
{
  ct_pool *pool = &s->pool;
  const size_t nodes = (size_t)s->node_count, rows = (size_t)most;
  ct_tangent *t = s->tangent = ct_pool_take(pool, 1, sizeof *t);
  if (t == NULL) return;
  t->most_rounds = MOST_ROUNDS;
  t->rows = ct_pool_take(pool, rows, sizeof *t->rows);
  t->groups = ct_pool_take(pool, rows, sizeof *t->groups);
  t->nodes = ct_pool_take(pool, nodes, sizeof *t->nodes);
  t->cut = ct_pool_take(pool, nodes, CT_TANGENT_CUT * sizeof *t->cut);
  double **vectors[] = {&t->sums, &t->moved, &t->pressed, &t->drift};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    *vectors[i] = ct_pool_take(pool, nodes, WIDE * sizeof(double));
  for (int i = 0; i < CT_SLIP_GIVEN; i++) t->own[i] = ct_pool_take(pool, rows, sizeof(double));
  ct_columns *columns[] = {&t->last,  &t->q,   &t->image, &t->slip, &t->T0,
                           &t->slip0, &t->aim, &t->next,  &t->c,    &t->end};
  for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++)
    for (int c = 0; c < 3; c++) columns[i]->x[c] = ct_pool_take(pool, rows, sizeof(double));
  double **numbers[] = {&t->limit, &t->most, &t->C,  &t->kappa,  &t->scale, &t->terms, &t->work,
                        &t->lag,   &t->loss, &t->mu, &t->wanted, &t->zeta,  &t->opened};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    *numbers[i] = ct_pool_take(pool, rows, sizeof(double));
  t->lanes = ct_pool_take(pool, rows, CT_TANGENT_LANES * sizeof(double));
  t->size = ct_pool_take(pool, rows, CT_ROW_NODES * sizeof(double));
  t->shift = ct_pool_take(pool, 2 * (size_t)s->most, sizeof *t->shift);
}

/* Limits of normal forces; returns the largest, and whether all are above 0. */
CT_CLONES
static double find_limits(int64_t count, const double *mu, const double *force,
                          double *restrict limit, int *all)
{
  double top = 0.0, least = HUGE_VAL;
#pragma omp simd reduction(max : top) reduction(min : least)
  for (int64_t j = 0; j < count; j++) {
    const double own = mu[j] * force[j];
    limit[j] = own;
    top = own > top ? own : top;
    least = own < least ? own : least;
  }
  *all = least > 0.0;
  return top;
}

/* The sets of the present normal forces. The last forces may lie outside of them; those of groups
 * that do not press are 0. */
static void fix_sets(ct_solver *s, int pass)
{
  ct_tangent *t = s->tangent;
  const int alone = t->active && s->count == s->point_count; // no point has a second force
  int all;
  for (int64_t j = 0; !alone && j < t->count; j++) t->terms[j] = t->rows[j]->force;
  t->top = find_limits(t->count, t->mu, alone ? s->force : t->terms, t->limit, &all);
  ct_pieces_largest(s->pieces, &t->top, 1);
  for (int64_t i = 0; i < t->group_count && !(all && pass == 0); i++) {
    ct_tangent_group *g = &t->groups[i];
    if (pass == 0) g->presses = 0;
    for (int32_t r = 0; r < g->rows; r++)
      if (t->limit[g->first + r] > 0.0) g->presses = 1;
  }
  ct_tangent_find_last(s);
  ct_tangent_fix_chords(t);
  t->allowed = 0;
}

/* One component of q = D + e_n + κ e_{n-1} without friction (eq:slip-residual), from D. */
CT_CLONES
static void add_slips(int64_t count, const double *e, const double *kappa, const double *e0,
                      double *restrict q)
{
#pragma omp simd
  for (int64_t j = 0; j < count; j++) q[j] += e[j] + kappa[j] * e0[j];
}

/* Motion of the nodes without friction, with the present normal forces, and what follows for the
 * rows. Returns 0 if the forces are not finite. */
static int find_drift(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (t->coupled && (s->count > 0 || s->pieces != NULL)) {
    const double *moved = s->along ? s->moved : t->pressed;
    if (s->along && !ct_matrix_push(s, s->force)) return 0;
    for (int32_t k = 0; k < s->active_node_count; k++)
      for (int32_t c = 0, at = s->active_nodes[k]; c < 3; c++)
        t->drift[at + c] = s->increment[at + c] + moved[at + c];
  }
  ct_tangent_motion(t, t->drift, &t->q);
  ct_tangent_take_off(t, 1, &t->q);
  for (int c = 0; c < 3; c++) add_slips(t->count, t->e.x[c], t->kappa, t->e0.x[c], t->q.x[c]);
  return 1;
}

/* a · b of all rows. */
CT_CLONES
static void find_products(int64_t count, const ct_columns *a, const ct_columns *b,
                          double *restrict out)
{
  const ct_columns A = *a, B = *b;
#pragma omp simd
  for (int64_t j = 0; j < count; j++) out[j] = ct_columns_dot(&A, &B, j);
}

/* Their sum, independent of the order. */
static double product(ct_solver *s, const ct_columns *a, const ct_columns *b)
{
  const ct_tangent *t = s->tangent;
  find_products(t->count, a, b, t->terms);
  return ct_sum_over(s->pieces, t->terms, t->count);
}

/* The factor of all forces with which friction dissipates whatever the iteration did
 * (eq:slip-guard). `image` and `slip` are those of the forces. */
static double guard(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  const double slip = product(s, &t->T, &t->slip);
  if (!(slip > 0.0)) return 1.0;
  const double free = product(s, &t->T, &t->q);
  // -- θ = min(1, max(0, -T·q / T·(W + C) T)) (eq:slip-guard)
  return slip - free > 0.0 ? fmin(fmax(-free / (slip - free), 0.0), 1.0) : 1.0;
}

/* Multiply all forces by the guard's factor, and what follows from them. */
static void shorten_forces(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const double theta = guard(s);
  if (theta == 1.0) return;
  for (int c = 0; c < 3; c++)
    for (int64_t j = 0; j < t->count; j++) {
      t->T.x[c][j] *= theta, t->image.x[c][j] *= theta;
      // -- (W + C) T + q (eq:slip-residual)
      t->slip.x[c][j] = (t->image.x[c][j] + t->C[j] * t->T.x[c][j]) + t->q.x[c][j];
    }
  for (int64_t j = 0; j < t->count; j++) t->opened[j] *= theta;
  t->pushed = t->shifted = 0;
}

/* Whether a normal force has changed so much that the limits must follow it. */
static int has_new_limits(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  double change = 0.0;
  for (int64_t j = 0; j < t->count; j++)
    change = fmax(change, fabs(t->mu[j] * t->rows[j]->force - t->limit[j]));
  ct_pieces_largest(s->pieces, &change, 1);
  return change > LIMIT_CHANGE * t->top;
}

int ct_tangent_begin(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  t->tolerance = fmax(TOLERANCE, s->tolerance);
  t->pushed = t->current = t->shifted = 0;
  ct_tangent_list(s);
  if (!t->some) return 1;
  ct_clear(t->shift, (size_t)s->count);
  if (!t->coupled) ct_clear(t->opened, (size_t)t->count);
  ct_copy(t->drift, s->increment, WIDE * (size_t)s->node_count * sizeof *t->drift);
  ct_tangent_shift_first(s);
  return ct_tangent_fix_laws(s);
}

/* Iterate until the points together lose energy (eq:slip-loss). Points that stick follow the
 * motion, so an iteration that ends early may gain some; if it still does so at a tight tolerance,
 * their springs pay it. Returns whether the last iteration converged, or -1 if forces are not
 * finite. */
static int find_forces(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  for (double least = t->tolerance;; least *= 0.1) {
    const int rounds = ct_tangent_iterate(s, least), converged = rounds < t->most_rounds;
    if (rounds < 0) return -1;
    shorten_forces(s);
    const double loss = ct_tangent_settle(s, 1.0);
    if (loss >= 0.0) return converged;
    if (converged && least > TIGHT) continue;
    if (!ct_tangent_shorten_slips(s, -loss)) ct_tangent_settle(s, 0.0);
    return converged;
  }
}

int ct_tangent_solve(ct_solver *s, int pass, double *change)
{
  ct_tangent *t = s->tangent;
  if (!t->some) return 1;
  if (pass == 0 || (pass == 1 && has_new_limits(s))) fix_sets(s, pass);
  if (!find_drift(s)) return 0;
  if (pass == 0) ct_tangent_start(s);
  const int converged = find_forces(s);
  s->converged = s->converged && converged;
  return converged >= 0 && ct_tangent_shift(s, change);
}

int ct_tangent_drop(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const size_t size = (size_t)t->count * sizeof(double);
  double change;
  if (!t->some) return 1;
  for (int c = 0; c < 3; c++) memset(t->T.x[c], 0, size), memset(t->image.x[c], 0, size);
  memset(t->opened, 0, size);
  t->pushed = t->shifted = 0;
  ct_tangent_settle(s, 0.0);
  return ct_tangent_shift(s, &change);
}
