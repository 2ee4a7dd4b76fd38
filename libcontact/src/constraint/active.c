/* The active rows of a step, their laws and bounds. */
#include "active.h"
#include "law.h"
#include "law_rows.h"
#include "matrix.h"
#include "tangent_matrix.h"

#include "../base/lanes.h"
#include "../base/stream.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* At t = 0 there was no step before: g_{-1} = g_0 (eq:energy-start), and the rows remember none. */
static void forget(ct_solver *s)
{
  for (int64_t j = 0; j < s->first[s->set_count]; j++) {
    ct_constraint *c = s->rows[j];
    c->before = c->gap;
    c->impact = (ct_impact){.stored = ct_law_claim(c)};
  }
}

/* Gaps at t_{n-1} and t_{n+1}, given the motions of the nodes along the rows. Returns the largest
 * motion or depth (eq:near-constraints); `distance` becomes that of the row farthest away, now or
 * at t_{n+1}. */
CT_CLONES
static double move_gaps(const ct_law_rows *rows, const double *last, const double *next,
                        double *distance)
{
  const ct_law_rows of = *rows; // whose arrays are not read again after each number
  double most = 0.0, away = -DBL_MAX;
#pragma omp simd reduction(max : most, away)
  for (int64_t j = 0; j < of.count; j++) {
    const double gap = of.gap[j], after = gap + (next[j] + of.moved[j]), motion = fabs(after - gap),
                 depth = -gap, far = motion > depth ? motion : depth,
                 least = after < gap ? after : gap;
    of.before[j] = gap - (last[j] + of.came[j]);
    of.after[j] = after;
    most = far > most ? far : most;
    away = least > away ? least : away;
  }
  *distance = away;
  return most;
}

/* Gaps of all listed rows at t_{n-1} and t_{n+1} without the constraints; returns as move_gaps. */
static double predict_gaps(ct_solver *s, double *distance)
{
  ct_law_rows *of = &s->laws;
  const int64_t count = s->first[s->set_count];
  ct_matrix_motion(s, count, s->last_increment, s->terms);
  ct_matrix_motion(s, count, s->increment, s->free);
  const double most = move_gaps(of, s->terms, s->free, distance);
  if (s->starts) memcpy(of->before, of->gap, (size_t)count * sizeof *of->gap);
  return most;
}

/* A row that takes no part in this step. */
static void drop(ct_solver *s, int64_t j)
{
  ct_constraint *c = s->laws.row[j];
  c->before = s->laws.before[j];
  c->after = s->laws.after[j];
  // The force of a row without a law is given; it has friction.
  if (ct_law_has_rows(c->enforcement)) s->dropped[s->dropped_count++] = j;
}

void ct_active_leave(const ct_solver *s)
{
  for (int64_t i = 0; i < s->dropped_count; i++) {
    ct_constraint *c = s->rows[s->dropped[i]];
    c->force = 0.0;
    if (s->again) c->impact = (ct_impact){.reserve = 0.0};
    else ct_law_leave(c, s->dt);
  }
}

/* Forces of the last step. */
CT_CLONES
static void begin_rows(const ct_law_rows *of, double *restrict force)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++) force[r] = of->force[r] - of->release[r];
}

/* Whether all listed rows have a law; only friction lists others. */
static int have_laws(const ct_solver *s)
{
  const ct_law_rows *of = &s->laws;
  return s->tangent == NULL || of->count == 0 ||
         (of->one_law && ct_law_has_rows(of->row[0]->enforcement));
}

/* Drop the rows without a law, and those that have no force in this step. */
static void drop_rows(ct_solver *s, double near)
{
  ct_law_rows *of = &s->laws;
  const ct_group *g = s->listed, *end = g + s->group_count;
  int64_t count = 0, j = 0;
  int32_t set = 0;
  memcpy(s->listed, s->groups, (size_t)s->group_count * sizeof *s->groups);
  s->every = s->listed;
  s->group_count = s->counted = 0;
  for (; g < end; g++)
    for (int32_t i = 0; i < g->rows; i++, j++) {
      const ct_constraint *c = of->row[j];
      while (s->first[set] <= j) s->first_point[set++] = count;
      // -- Inside before, or now, or without the force (eq:near-constraints), or held, or tied
      const int is_near = ct_law_least(c->enforcement) < 0.0 || of->before[j] < 0.0 ||
                          of->gap[j] <= near || of->after[j] <= near || ct_law_may_release(c),
                has_law = s->tangent == NULL || ct_law_has_rows(c->enforcement);
      if (is_near && has_law) {
        ct_matrix_add(s, g, i);
        if (count < j) ct_law_rows_move(of, j, count);
        count++;
      } else drop(s, j);
    }
  while (set <= s->set_count) s->first_point[set++] = count;
  of->count = count;
}

/* Choose the rows that take part (eq:near-constraints). */
void ct_active_choose(ct_solver *s, int all)
{
  ct_law_rows *of = &s->laws;
  double distance, most = predict_gaps(s, &distance);
  ct_pieces_largest(s->pieces, &most, 1);
  const double near = all ? HUGE_VAL : 2.0 * most;
  s->dropped_count = 0;
  memcpy(s->first_point, s->first, ((size_t)s->set_count + 1) * sizeof *s->first);
  s->every = s->groups;
  if (!have_laws(s) || !(distance <= near)) drop_rows(s, near);
  s->count = s->point_count = of->count;
  begin_rows(of, s->force);
  s->applied = 0;
  ct_copy(s->free, of->after, (size_t)s->count * sizeof *s->free);
  if (!s->again) return;
  // Nothing opens at t = 0, so the place is free; the points close now.
  memcpy(of->release, of->force, (size_t)s->count * sizeof *of->force);
  memset(of->pressed, 0, (size_t)s->count * sizeof *of->pressed);
}

/* Motion of all nodes by all forces. Returns 0 if it is not finite. */
static int push_all(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  const int both = t != NULL && t->some && t->coupled;
  if ((both && !ct_tangent_push_all(s)) || !ct_matrix_push_all(s, s->force)) return 0;
  for (int32_t k = 0; both && k < s->node_count; k++)
    for (int c = 0; c < 3; c++) s->moved[s->all_nodes[k] + c] += t->drift[s->all_nodes[k] + c];
  return 1;
}

/* The largest depth after the step of a row that takes no part, or 0. */
static double deepest(ct_solver *s)
{
  const ct_group *g = s->listed;
  double most = 0.0;
  for (int64_t i = 0, r = 0; i < s->dropped_count; r += g->rows, g++) {
    if (s->dropped[i] >= r + g->rows) continue;
    const int moved = ct_matrix_times_group(s, g, s->moved, s->terms);
    for (; i < s->dropped_count && s->dropped[i] < r + g->rows; i++)
      // -- g_free + W λ of a row that takes no part (eq:thrown-constraints)
      if (moved) most = fmax(most, -(s->rows[s->dropped[i]]->after + s->terms[s->dropped[i] - r]));
  }
  return most;
}

int ct_active_throws(ct_solver *s)
{
  if (s->pieces == NULL && s->dropped_count == 0) return 0;
  double most[2] = {(double)s->dropped_count, ct_largest(s->force, s->count)};
  ct_pieces_largest(s->pieces, most, 2);
  if (most[0] == 0.0 || most[1] == 0.0) return 0;
  if (!push_all(s)) return -1;
  most[0] = deepest(s);
  ct_pieces_largest(s->pieces, most, 1);
  return most[0] > 0.0;
}

CT_CLONES
static void set_all(double *numbers, int64_t first, int64_t end, double value)
{
  for (int64_t r = first; r < end; r++) numbers[r] = value;
}

/* The bound of each row: that of the last step if neither G nor the mobilities have changed. */
static int find_bound(ct_solver *s)
{
  const size_t rows = (size_t)s->count * sizeof *s->bound,
               nodes = (size_t)s->node_count * CT_SOLVER_WIDE * sizeof *s->mobility;
  if (s->kept == 2 && memcmp(s->mobility, s->bound_mobility, nodes) == 0) {
    ct_copy(s->scale, s->bound, rows);
    return 1;
  }
  if (!ct_matrix_bound(s, 0, s->after, s->scale)) return 0;
  // With one normal the product has a loop of its own.
  s->applied = s->bodies == NULL && !s->along;
  s->iterations += s->applied;
  if (ct_matrix_stays(s)) memcpy(s->bound_mobility, s->mobility, nodes);
  ct_copy(s->bound, s->scale, rows);
  return 1;
}

/* The laws of the points in this step, and the bound of each row, into `scale`
 * (eq:constraint-bound). */
static int fix_laws(ct_solver *s)
{
  if (!find_bound(s)) return 0;
  for (int64_t r = 0, end; r < s->count; r = end) {
    end = ct_law_end(&s->laws, r);
    set_all(s->least, r, end, ct_law_least(s->active[r]->enforcement));
  }
  ct_law_fix(&s->laws, s->scale, s->fraction, s->C, s->b);
  return 1;
}

/* The force of each row without those of its neighbours (eq:release-time). */
CT_CLONES
static void find_alone(int64_t count, const double *free, const double *b, const double *C,
                       const double *bound, double *restrict alone)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) alone[r] = -(free[r] + b[r]) / (C[r] + bound[r]);
}

/* Find the time t_b of each row, in `direction`: that of a layer which passes waves to another set
 * that is pressed, or 0 (eq:release-passed). */
static void find_passing(ct_solver *s)
{
  for (int32_t k = 0; k < s->set_count; k++) {
    const int64_t first = s->first_point[k];
    s->pressed[k] = ct_largest(&s->force[first], s->first_point[k + 1] - first);
    s->back[k] = 0.0;
  }
  ct_pieces_largest(s->pieces, s->pressed, s->set_count);
  for (const ct_layer *layer = s->layers; layer < s->layers + s->layer_count; layer++)
    for (int one = 0; one < 2; one++)
      if (s->pressed[layer->sets[1 - one]] > 0.0)
        s->back[layer->sets[one]] = ct_larger(s->back[layer->sets[one]], layer->back);
  for (int32_t k = 0; k < s->set_count; k++)
    set_all(s->direction, s->first_point[k], s->first_point[k + 1], s->back[k]);
}

/* Clear `opens` in the sets whose forces do not fall together (eq:release-together), or rise too
 * much (eq:release-passed). */
static void keep_falling(ct_solver *s, ct_opening how, const double *alone, double *opens)
{
  ct_law_find_falls(&s->laws, how, alone, s->force, s->gradient);
  for (int32_t k = 0; k < s->set_count; k++) {
    const int64_t first = s->first_point[k], count = s->first_point[k + 1] - first;
    // -- Σ (⟨λ_u⟩ - 0.7 λ_{n-1}) < 0 (eq:release-together)
    if (!(ct_sum_over(s->pieces, &s->gradient[first], count) < 0.0))
      ct_clear(&opens[first], (size_t)count);
  }
}

/* The points that open in a way; in `all` sets, or where the forces of a set allow it. */
static void open_so(ct_solver *s, ct_opening how, const double *alone, int all, double *opens)
{
  ct_law_find_releases(&s->laws, s->scale, s->dt, alone, how, s->direction, opens);
  if (!all && how != CT_OPENS_ALONE) keep_falling(s, how, alone, opens);
}

/* The same, with those that open otherwise. */
static void open_more(ct_solver *s, ct_opening how, const double *alone, int all, double *opens)
{
  double *more = s->guide;
  open_so(s, how, alone, all, more);
  for (int64_t r = 0; r < s->count; r++) opens[r] = ct_larger(opens[r], more[r]);
}

/* The points that open in any way. */
static void find_openings(ct_solver *s, const double *alone, int all, double *opens)
{
  open_so(s, CT_OPENS_TOGETHER, alone, all, opens);
  if (s->layer_count > 0) open_more(s, CT_OPENS_PASSED, alone, all, opens);
  // Alone a point opens later than together: where all sets may, it adds none.
  if (!all) open_more(s, CT_OPENS_ALONE, alone, all, opens);
}

/* Σ ⟨sign K⟩ over some rows. */
static double sum_reserves(const ct_solver *s, int64_t first, int64_t count, double sign)
{
  for (int64_t r = 0; r < count; r++)
    s->gradient[r] = ct_larger(sign * s->laws.reserve[first + r], 0.0);
  return ct_sum_over(s->pieces, s->gradient, count);
}

/* What rows owe is paid by those of their set that hold, before any of them opens. */
static void pay_debts(ct_solver *s)
{
  double *reserve = s->laws.reserve;
  for (int32_t k = 0; k < s->set_count; k++) {
    const int64_t first = s->first_point[k], end = s->first_point[k + 1];
    const double held = sum_reserves(s, first, end - first, 1.0),
                 debt = sum_reserves(s, first, end - first, -1.0);
    if (!(held > 0.0 && debt > 0.0)) continue;
    for (int64_t r = first; r < end; r++) reserve[r] = ct_law_paid(reserve[r], held, debt);
  }
}

/* The points that open in this step, into `terms`: alone, or together with their contact
 * (eq:release-time). Returns whether there are any in this piece. */
static int find_releases(ct_solver *s)
{
  double *opens = s->terms, *alone = s->image;
  find_alone(s->count, s->free, s->b, s->C, s->scale, alone);
  if (s->layer_count > 0) find_passing(s);
  double some = s->layer_count > 0 || ct_law_fall(&s->laws, alone);
  if (some != 0.0) {
    find_openings(s, alone, 1, opens);
    some = !ct_is_zero(opens, s->count);
  }
  ct_pieces_largest(s->pieces, &some, 1);
  if (some == 0.0) return 0;
  ct_law_take_debts(&s->laws);
  pay_debts(s);
  find_openings(s, alone, 0, opens);
  return !ct_is_zero(opens, s->count);
}

/* A second row for each point that opens in this step. */
static void list_releases(ct_solver *s)
{
  if (s->starts || !find_releases(s)) return;
  const int64_t groups = s->group_count;
  for (int64_t k = 0, r = 0; k < groups; k++)
    for (int32_t i = 0; i < s->groups[k].rows; i++, r++)
      if (s->terms[r] != 0.0) {
        ct_matrix_add(s, &s->groups[k], i);
        s->opened[s->count - s->point_count] = r;
        s->free[s->count] = s->free[r];
        s->scale[s->count] = s->scale[r];
        s->least[s->count] = 0.0;
        s->active[s->count++] = s->active[r];
      }
}

/* The second rows of each set: their points are in order. */
static void split_releases(ct_solver *s)
{
  int64_t r = s->point_count;
  for (int32_t k = 0; k < s->set_count; k++) {
    s->first_release[k] = r;
    while (r < s->count && s->opened[r - s->point_count] < s->first_point[k + 1]) r++;
  }
  s->first_release[s->set_count] = r;
}

/* Add a second row for each point that opens in this step and gives back what it holds
 * (eq:release-ramp). */
static int add_releases(ct_solver *s)
{
  const int64_t points = s->point_count, groups = s->group_count;
  list_releases(s);
  split_releases(s);
  double all[2] = {(double)s->count, (double)points};
  ct_pieces_sum(s->pieces, all, 2);
  s->all_count = isfinite(all[0]) ? (int64_t)all[0] : 0;
  if (all[0] == all[1]) return 1;
  ct_matrix_choose(s);
  if (!ct_matrix_bound(s, groups, s->after, s->terms)) return 0;
  s->applied = 0;
  for (int64_t r = points; r < s->count; r++) {
    const int64_t own = s->opened[r - points];
    const ct_constraint c = {.before = s->laws.before[own], .impact.reserve = s->laws.reserve[own]};
    const ct_ramp ramp = ct_law_release(&c, s->free[r], s->terms[r], &s->force[r]);
    s->C[r] = ramp.C;
    s->b[r] = ramp.b;
  }
  for (int64_t r = 0; r < s->count; r++) s->scale[r] += s->terms[r];
  return 1;
}

/* -- 1 / D from the bounds (eq:constraint-bound) */
CT_CLONES
static void invert(int64_t count, const double *C, double *restrict scale)
{
#pragma omp simd
  for (int64_t r = 0; r < count; r++) scale[r] = 1.0 / (scale[r] + C[r]);
}

void ct_active_read(ct_solver *s)
{
  if (s->starts && !s->again) forget(s);
  ct_matrix_fill(s);
  s->read = 1, s->written = 0;
}

/* The rows of the problem, their laws, and the scale of each. */
int ct_active_set_up(ct_solver *s, int all)
{
  if (!s->read) ct_active_read(s);
  s->read = 0;
  ct_active_choose(s, all);
  ct_matrix_choose(s);
  if (!fix_laws(s) || !add_releases(s)) return 0;
  invert(s->count, s->C, s->scale);
  return 1;
}
