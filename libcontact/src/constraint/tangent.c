/* The tangential forces of a step: an accelerated projected gradient within the discs of all points
 * (eq:slip-problem, eq:slip-iteration). */
#include "tangent.h"

#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "law.h"
#include "matrix.h"
#include "tangent_rows.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, MOST_ROUNDS = 1000 };

/* The iteration ends when the largest change of a force is below this fraction of the largest
 * force; a point sticks when its slip is below this many times that change. */
static const double TOLERANCE = 1e-4, STICK = 10.0;

/* The limits are computed again once if a normal force has changed by more than this fraction of
 * the largest. And the smallest limit that counts as a force, as a fraction of the largest. */
static const double LIMIT_CHANGE = 0.01, LEAST = 1e-6;

void ct_tangent_create(ct_solver *s, int64_t most)
{
  ct_pool *pool = &s->pool;
  const size_t nodes = (size_t)s->node_count, rows = 2 * (size_t)s->most;
  ct_tangent *t = s->tangent = ct_pool_take(pool, 1, sizeof *t);
  if (t == NULL) return;
  t->most_rounds = MOST_ROUNDS;
  t->rows = ct_pool_take(pool, (size_t)most, sizeof *t->rows);
  t->nodes = ct_pool_take(pool, nodes, sizeof *t->nodes);
  double **vectors[] = {&t->sums, &t->moved, &t->drift};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    *vectors[i] = ct_pool_take(pool, nodes, WIDE * sizeof(double));
  t->terms = ct_pool_take(pool, (size_t)most, sizeof *t->terms);
  t->shift = ct_pool_take(pool, rows, sizeof *t->shift);
}

/* The laws of the listed rows. Returns 0 if they are not finite. */
static int fix_laws(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double slowest = -1.0;
  if (!ct_tangent_bound(s)) return 0;
  for (int64_t j = 0; j < t->count; j++) {
    ct_tangent_row *r = &t->rows[j];
    const ct_constraint as_spring = {.stiffness = r->slip->k, .dissipation = r->row->dissipation};
    r->law = ct_slip_law_of(r->slip, ct_law_dashpot(&as_spring, r->scale / s->fraction));
    // -- 1 / D, with the compliance
    r->scale = 1.0 / (r->scale + r->law.C);
    const double ratio = -r->law.C * r->scale;
    slowest = ratio > slowest ? ratio : slowest;
  }
  // -- The smallest eigenvalue of D⁻¹ (W + C) is at least that of D⁻¹ C (eq:slip-iteration)
  ct_pieces_largest(s->pieces, &slowest, 1);
  const double root = sqrt(-slowest);
  t->rate = (1.0 - root) / (1.0 + root);
  return 1;
}

/* Project the forces on the sets of the present normal forces; of the first pass, the whole sets.
 */
static void fix_limits(ct_solver *s, int whole)
{
  ct_tangent *t = s->tangent;
  double measures[2] = {0.0, 0.0}; // the largest limit, and whether a force has changed
  for (int64_t j = 0; j < t->count; j++) {
    ct_tangent_row *r = &t->rows[j];
    const double T[3] = {r->T[0], r->T[1], r->T[2]};
    if (whole) r->set = ct_slip_set_of(r->slip, r->row->force, r->last);
    r->set.limit = r->slip->mu * r->row->force;
    ct_slip_project(&r->set, r->T);
    if (memcmp(T, r->T, sizeof T) != 0) measures[1] = 1.0;
    measures[0] = r->set.limit > measures[0] ? r->set.limit : measures[0];
  }
  ct_pieces_largest(s->pieces, measures, 2);
  t->top = measures[0];
  t->current = t->current && measures[1] == 0.0;
}

/* Motion of the nodes without friction, with the present normal forces, and what follows for the
 * rows. Returns 0 if the forces are not finite. */
static int find_drift(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (s->count > 0 || s->pieces != NULL) {
    if (!ct_matrix_push(s, s->force)) return 0;
    for (int32_t k = 0; k < s->active_node_count; k++)
      for (int32_t c = 0, at = s->active_nodes[k]; c < 3; c++)
        t->drift[at + c] = s->increment[at + c] + s->moved[at + c];
  }
  ct_tangent_motion(t, t->drift);
  for (int64_t j = 0; j < t->count; j++) {
    ct_tangent_row *r = &t->rows[j];
    const ct_slip *p = r->slip;
    for (int i = 0; i < 3; i++) r->q[i] -= p->coming[i];
    if (r->row->other_count == 0) ct_vector_make_tangential(r->row->normal, r->q);
    // -- q = D + e_n + κ e_{n-1} without friction (eq:slip-residual)
    for (int i = 0; i < 3; i++) r->q[i] += p->e[i] + r->law.kappa * p->before[i];
  }
  return 1;
}

/* One round: the forces that follow from the gradient (eq:slip-iteration). Writes the largest
 * change of a force, and the largest force. */
static void take_round(ct_tangent *t, double size[2])
{
  double most = 0.0, top = LEAST * t->top;
  for (int64_t j = 0; j < t->count; j++) {
    ct_tangent_row *r = &t->rows[j];
    for (int i = 0; i < 3; i++)
      // -- y - D⁻¹ ((W + C) y + q) (eq:slip-iteration)
      r->next[i] = r->at[i] - r->scale * ((r->image[i] + r->law.C * r->at[i]) + r->q[i]);
    ct_slip_project(&r->set, r->next);
    for (int i = 0; i < 3; i++) {
      const double change = fabs(r->next[i] - r->at[i]), force = fabs(r->next[i]);
      most = change > most || isnan(change) ? change : most;
      top = force > top ? force : top;
    }
  }
  size[0] = most, size[1] = top;
}

/* Take the forces of a round, and extrapolate. */
static void extrapolate(ct_tangent *t)
{
  for (int64_t j = 0; j < t->count; j++)
    for (int i = 0; i < 3; i++) {
      ct_tangent_row *r = &t->rows[j];
      // -- T + β (T - T of the last round) (eq:slip-iteration)
      r->at[i] = r->next[i] + t->rate * (r->next[i] - r->T[i]);
      r->T[i] = r->next[i];
    }
  t->current = 0;
}

/* Solve for the tangential forces with the present normal ones. Forces that already meet twice
 * the tolerance are not changed. Returns the number of rounds that changed them; -1 if they are not
 * finite. */
static int iterate(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double tolerance = 2.0 * t->tolerance;
  for (int64_t j = 0; j < t->count; j++) memcpy(t->rows[j].at, t->rows[j].T, sizeof t->rows[j].at);
  for (int k = 0;; k++, tolerance = t->tolerance) {
    if (!t->current && !ct_tangent_apply(s, 1)) return -1;
    double size[2];
    take_round(t, size);
    ct_pieces_largest(s->pieces, size, 2);
    if (!isfinite(size[0])) return -1;
    const int enough = size[0] <= tolerance * size[1];
    t->size = size[1];
    if (k == 0 && enough) return 0;
    extrapolate(t);
    if (enough || k == t->most_rounds) return k + 1;
  }
}

/* Let the gaps of all active rows follow the tangential forces. Writes the largest change of a
 * normal force that this causes, as a fraction of the largest. Returns 0 if it is not finite. */
static int shift_gaps(ct_solver *s, double *change)
{
  ct_tangent *t = s->tangent;
  double most[2] = {0.0, 0.0};
  *change = 0.0;
  if (t->current) return 1;
  if (!ct_tangent_apply(s, 0)) return 0;
  t->current = 1;
  ct_matrix_times(s, s->count, t->moved, s->terms);
  for (int64_t r = 0; r < s->count; r++) {
    const double more = s->terms[r] - t->shift[r], force = fabs(more) * s->scale[r];
    t->shift[r] = s->terms[r];
    s->free[r] += more;
    s->gradient[r] += more;
    most[0] = force > most[0] ? force : most[0];
    most[1] = s->force[r] > most[1] ? s->force[r] : most[1];
  }
  ct_pieces_largest(s->pieces, most, 2);
  *change = most[0] > 0.0 ? most[0] / most[1] : 0.0;
  return 1;
}

/* Σ of one number of each row, independent of the order. */
static double sum_terms(ct_solver *s)
{
  return ct_sum_over(s->pieces, s->tangent->terms, s->tangent->count);
}

/* The factor of all forces with which friction dissipates whatever the iteration did
 * (eq:slip-guard). `image` is that of the forces. */
static double guard(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double sum[2];
  for (int k = 0; k < 2; k++) {
    for (int64_t j = 0; j < t->count; j++) {
      const ct_tangent_row *r = &t->rows[j];
      t->terms[j] = k == 0 ? ct_vector_dot(r->T, r->image) + r->law.C * ct_vector_dot(r->T, r->T)
                           : ct_vector_dot(r->T, r->q);
    }
    sum[k] = sum_terms(s);
  }
  // -- θ = min(1, max(0, -T·q / T·(W + C) T)) (eq:slip-guard)
  return sum[0] + sum[1] > 0.0 && sum[0] > 0.0 ? fmax(-sum[1] / sum[0], 0.0) : 1.0;
}

/* Store the force of a row, and its elastic slip at the end of the step. */
static void store_row(const ct_tangent *t, ct_tangent_row *r, double theta)
{
  ct_slip *p = r->slip;
  const double before = ct_slip_stored(p), most = STICK * t->tolerance * t->size / r->scale;
  double slip[3], motion[3];
  for (int i = 0; i < 3; i++) {
    p->force[i] = theta * r->T[i];
    // -- The slip of the step, and D₊ (eq:slip-residual)
    slip[i] = (theta * r->image[i] + r->law.C * p->force[i]) + r->q[i];
    motion[i] = theta * r->image[i] + (r->q[i] - (p->e[i] + r->law.kappa * p->before[i]));
  }
  // -- A point that slips less than the iteration resolves sticks (eq:slip-stick)
  p->stuck = ct_vector_dot(slip, slip) <= most * most;
  // -- R = -½ T · slip (eq:slip-store), and what is owed
  p->reserve = p->stuck ? 0.0 : fmin(p->reserve, 0.0) - 0.5 * ct_vector_dot(p->force, slip);
  for (int i = 0; i < 3; i++) {
    const double e = p->e[i];
    p->e[i] = p->stuck ? e + motion[i] : -r->law.C * p->force[i] - r->law.kappa * p->before[i];
    p->before[i] = e;
  }
  const double after = ct_vector_dot(p->force, motion), last = ct_vector_dot(p->force, r->last);
  // -- ½ T · (D₊ + D₋) (eq:slip-work)
  p->work = 0.5 * (after + last);
  // -- ¼ T · (D₊ - D₋) (eq:slip-held)
  p->lag = 0.25 * (after - last);
  // What a point gains that does not stick exactly is taken from the reserves (eq:slip-stick)
  if (p->stuck) p->reserve = fmin((before - ct_slip_stored(p)) - p->work, 0.0);
}

/* Share the reserves, with the same sum: none of them is negative, or, where the sum is, none is
 * positive (eq:slip-stick). */
static void share_reserves(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double sum[2], debt = 0.0;
  for (int64_t j = 0; j < t->count; j++) debt = fmax(debt, -t->rows[j].slip->reserve);
  ct_pieces_largest(s->pieces, &debt, 1);
  if (debt == 0.0) return;
  for (int owed = 0; owed < 2; owed++) {
    for (int64_t j = 0; j < t->count; j++) {
      const double R = t->rows[j].slip->reserve;
      t->terms[j] = owed ? fmin(R, 0.0) : fmax(R, 0.0);
    }
    sum[owed] = sum_terms(s);
  }
  const double rest = sum[0] + sum[1], sign = rest < 0.0 ? -1.0 : 1.0,
               part = rest / (rest < 0.0 ? sum[1] : sum[0]);
  for (int64_t j = 0; j < t->count; j++) {
    double *R = &t->rows[j].slip->reserve;
    *R = rest != 0.0 && *R * sign > 0.0 ? part * *R : 0.0;
  }
}

/* Whether a normal force has changed so much that the limits must follow it. */
static int has_new_limits(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  double change = 0.0;
  for (int64_t j = 0; j < t->count; j++) {
    const ct_tangent_row *r = &t->rows[j];
    change = fmax(change, fabs(r->slip->mu * r->row->force - r->set.limit));
  }
  ct_pieces_largest(s->pieces, &change, 1);
  return change > LIMIT_CHANGE * t->top;
}

int ct_tangent_begin(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double change;
  t->tolerance = fmax(TOLERANCE, 0.1 * s->tolerance);
  t->current = 0;
  ct_tangent_list(s);
  if (!t->some) return 1;
  memset(t->shift, 0, (size_t)s->count * sizeof *t->shift);
  memcpy(t->drift, s->increment, WIDE * (size_t)s->node_count * sizeof *t->drift);
  return fix_laws(s) && shift_gaps(s, &change);
}

int ct_tangent_solve(ct_solver *s, int pass, double *change)
{
  ct_tangent *t = s->tangent;
  if (!t->some) return 1;
  if (pass == 0 || (pass == 1 && has_new_limits(s))) fix_limits(s, pass == 0);
  if (!find_drift(s)) return 0;
  const int rounds = iterate(s);
  s->converged = s->converged && rounds <= t->most_rounds;
  return rounds >= 0 && shift_gaps(s, change);
}

void ct_tangent_store(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!t->some) return;
  const double theta = guard(s);
  for (int64_t j = 0; j < t->count; j++) {
    ct_tangent_row *r = &t->rows[j];
    const int acts = r->row->force > 0.0 || ct_vector_dot(r->T, r->T) > 0.0;
    if (acts) store_row(t, r, theta);
    else ct_slip_open(r->slip);
  }
  share_reserves(s);
  for (int64_t r = 0; theta != 1.0 && r < s->count; r++)
    s->gradient[r] += (theta - 1.0) * t->shift[r];
}
