/* The tangential forces of a step: projected Chebyshev steps, and then an accelerated projected
 * gradient, within the discs of all points (eq:slip-problem, eq:slip-iteration). */
#include "tangent.h"

#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "matrix.h"
#include "tangent_laws.h"
#include "tangent_matrix.h"
#include "tangent_settle.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, MOST_ROUNDS = 1000, MOST_CHEBYSHEV = 40 };

/* The iteration ends when the largest change of a force is below this fraction of the largest
 * force, or, while energy appears, a smaller one. */
static const double TOLERANCE = 1e-4, TIGHT = 1e-8;

/* Smallest eigenvalue of D⁻¹ (W + C) that Chebyshev steps count on; the largest is at most 1. */
static const double LOWEST = 0.08;

/* The limits are computed again once if a normal force has changed by more than this fraction of
 * the largest. And the smallest limit that counts as a force, as a fraction of the largest. */
static const double LIMIT_CHANGE = 0.01, LEAST = 1e-6;

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
  t->cut = ct_pool_take(pool, nodes, CT_SLIP_SUMS * sizeof *t->cut);
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

/* The set of a row. */
static ct_slip_set set_of(const ct_tangent *t, int64_t j)
{
  ct_slip_set set = {.limit = t->limit[j], .most = t->most[j]};
  ct_columns_get(&t->c, j, set.c);
  return set;
}

/* `to` = forces without the parts beyond their discs, and `beyond` = 1 where they are still beyond
 * the chord; writes the largest component, and returns whether any is beyond. */
CT_CLONES
static int shorten_all(const ct_tangent *t, const ct_columns *from, const ct_columns *to,
                       double *restrict beyond, double *largest)
{
  const double *limit = t->limit, *most = t->most, *cx = t->c.x[0], *cy = t->c.x[1],
               *cz = t->c.x[2], *x = from->x[0], *y = from->x[1], *z = from->x[2];
  double *X = to->x[0], *Y = to->x[1], *Z = to->x[2], any = 0.0, top = 0.0;
#pragma omp simd reduction(max : any, top)
  for (int64_t j = 0; j < t->count; j++) {
    // -- The disc alone (eq:slip-projection)
    const double part = ct_slip_part(limit[j], (x[j] * x[j] + y[j] * y[j]) + z[j] * z[j]);
    X[j] = x[j] * part, Y[j] = y[j] * part, Z[j] = z[j] * part;
    const double along = (X[j] * cx[j] + Y[j] * cy[j]) + Z[j] * cz[j],
                 over = along > most[j] ? 1.0 : 0.0;
    beyond[j] = over;
    any = ct_larger(over, any);
    top = ct_larger(ct_larger(ct_larger(fabs(X[j]), fabs(Y[j])), fabs(Z[j])), top);
  }
  *largest = top;
  return any > 0.0;
}

/* `to` = forces projected on the sets of all rows. Returns the largest component. */
static double project(const ct_tangent *t, const ct_columns *from, const ct_columns *to)
{
  double top;
  if (!shorten_all(t, from, to, t->terms, &top)) return top;
  for (int64_t j = 0; j < t->count; j++) {
    if (t->terms[j] == 0.0) continue;
    const ct_slip_set set = set_of(t, j);
    double T[3];
    ct_columns_get(from, j, T);
    ct_slip_project(&set, T);
    ct_columns_set(to, j, T);
    for (int c = 0; c < 3; c++) top = ct_larger(fabs(T[c]), top);
  }
  return top;
}

/* Largest change of a force from one vector to another, and largest force there; NaN if one is. */
CT_CLONES
static void compare(int64_t count, const double *from, const double *to, double size[2])
{
  double most = 0.0, top = 0.0, sum = 0.0;
#pragma omp simd reduction(max : most, top) reduction(+ : sum)
  for (int64_t j = 0; j < count; j++) {
    const double change = fabs(to[j] - from[j]), force = fabs(to[j]);
    most = change > most ? change : most;
    top = force > top ? force : top;
    sum += change;
  }
  if (isnan(sum)) most = NAN;
  size[0] = most > size[0] || isnan(most) ? most : size[0];
  size[1] = top > size[1] ? top : size[1];
}

/* Limits of normal forces; returns the largest. */
CT_CLONES
static double find_limits(int64_t count, const double *mu, const double *force,
                          double *restrict limit)
{
  double top = 0.0;
#pragma omp simd reduction(max : top)
  for (int64_t j = 0; j < count; j++) {
    const double own = mu[j] * force[j];
    limit[j] = own;
    top = own > top ? own : top;
  }
  return top;
}

/* The limits of the present normal forces. The last forces may lie outside the new sets. */
static void fix_limits(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const int alone = t->active && s->count == s->point_count; // no point has a second force
  for (int64_t j = 0; !alone && j < t->count; j++) t->terms[j] = t->rows[j]->force;
  t->top = find_limits(t->count, t->mu, alone ? s->force : t->terms, t->limit);
  ct_pieces_largest(s->pieces, &t->top, 1);
}

/* Whether all forces are in their sets. */
static int are_allowed(const ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  double size[2] = {0.0, 0.0};
  project(t, &t->T, &t->next);
  for (int c = 0; c < 3; c++) compare(t->count, t->T.x[c], t->next.x[c], size);
  ct_pieces_largest(s->pieces, size, 1);
  return size[0] == 0.0;
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

/* The slips of the step, and the forces `aim` to which a unit step down them leads, before their
 * projection. Writes the largest change of a force by this after a projection on discs alone, and
 * the largest force then, at least the given one; NaN if one is. Returns whether a force is beyond
 * its chord. */
CT_CLONES
static int measure(const ct_tangent *t, double size[2])
{
  const ct_columns image = t->image, T = t->T, q = t->q, slip = t->slip, aim = t->aim, c = t->c;
  const double *limit = t->limit, *chord = t->most, *C = t->C, *scale = t->scale;
  double most = 0.0, top = 0.0, sum = 0.0, any = 0.0;
#pragma omp simd reduction(max : most, top, any) reduction(+ : sum)
  for (int64_t j = 0; j < t->count; j++) {
    double to[3], change = 0.0, force = 0.0;
    for (int k = 0; k < 3; k++) {
      // -- (W + C) T + q (eq:slip-residual)
      const double own = (image.x[k][j] + C[j] * T.x[k][j]) + q.x[k][j];
      slip.x[k][j] = own;
      aim.x[k][j] = to[k] = T.x[k][j] - scale[j] * own;
    }
    const double part = ct_slip_part(limit[j], (to[0] * to[0] + to[1] * to[1]) + to[2] * to[2]);
    for (int k = 0; k < 3; k++) {
      to[k] *= part;
      change = ct_larger(fabs(to[k] - T.x[k][j]), change);
      force = ct_larger(fabs(to[k]), force);
    }
    any = ct_larger(((to[0] * c.x[0][j] + to[1] * c.x[1][j]) + to[2] * c.x[2][j]) - chord[j], any);
    most = ct_larger(change, most), top = ct_larger(force, top);
    sum += (to[0] + to[1]) + to[2];
  }
  size[0] = isnan(sum) ? NAN : most, size[1] = ct_larger(top, size[1]);
  return any > 0.0;
}

/* The slips of the step, the largest change of a force in a unit step down them, and the largest
 * force then, at least the given one. */
static void find_slips(const ct_tangent *t, double size[2])
{
  const double least = size[1];
  if (!measure(t, size)) return;
  project(t, &t->aim, &t->next);
  size[0] = 0.0, size[1] = least;
  for (int c = 0; c < 3; c++) compare(t->count, t->T.x[c], t->next.x[c], size);
}

/* A step of the iteration: share of the last change of a force, length, and share of the last
 * change of the slip (eq:slip-iteration). */
typedef struct step {
  double momentum, length, slope;
} step;

/* One component of the forces that follow, before their projection; those of this round become the
 * last ones. */
CT_CLONES
static void aim_at(int64_t count, step by, const double *T, const double *slip, const double *scale,
                   double *restrict T0, double *restrict slip0, double *restrict aim)
{
#pragma omp simd
  for (int64_t j = 0; j < count; j++) {
    const double down = scale[j] * (slip[j] + by.slope * (slip[j] - slip0[j]));
    // -- T + β (T - T₀) - λ D⁻¹ (Δs + γ (Δs - Δs₀)) (eq:slip-iteration)
    aim[j] = (T[j] + by.momentum * (T[j] - T0[j])) - by.length * down;
    T0[j] = T[j], slip0[j] = slip[j];
  }
}

/* The coefficients of round `k` (eq:slip-iteration). */
static step step_of(const ct_tangent *t, int k, double *rho)
{
  const double lowest = fmin(fmax(t->lowest, LOWEST), 0.999), middle = 0.5 * (1.0 + lowest),
               half = 0.5 * (1.0 - lowest), root = sqrt(t->lowest),
               rate = (1.0 - root) / (1.0 + root);
  if (k == 0) {
    // -- β_0 = 0, λ_0 = 1/θ, ρ_0 = δ/θ (eq:slip-chebyshev)
    *rho = half / middle;
    return (step){0.0, 1.0 / middle, 0.0};
  }
  if (k >= MOST_CHEBYSHEV) return (step){rate, 1.0, rate};
  // -- ρ_i = 1 / (2 θ/δ - ρ_{i-1}), β_i = ρ_i ρ_{i-1}, λ_i = 2 ρ_i / δ (eq:slip-chebyshev)
  const double next = 1.0 / (2.0 * middle / half - *rho), last = *rho;
  *rho = next;
  return (step){next * last, 2.0 * next / half, 0.0};
}

/* Take the forces `aim` after their projection. */
static void take_aim(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  t->most_force = project(t, &t->aim, &t->T);
  ct_pieces_largest(s->pieces, &t->most_force, 1);
  t->pushed = t->current = t->shifted = 0;
}

/* Take the forces of a step. */
static void take_step(ct_solver *s, step by)
{
  ct_tangent *t = s->tangent;
  for (int c = 0; c < 3; c++)
    aim_at(t->count, by, t->T.x[c], t->slip.x[c], t->scale, t->T0.x[c], t->slip0.x[c], t->aim.x[c]);
  take_aim(s);
}

/* The forces with which the iteration begins, before their projection: those without slip if the
 * forces T₋ of the last step and their image changed by one factor at each point. */
CT_CLONES
static void start_at(const ct_tangent *t)
{
  const ct_columns T = t->T, image = t->was_image, q = t->q, aim = t->aim;
  const double *C = t->C, *scale = t->scale;
#pragma omp simd
  for (int64_t j = 0; j < t->count; j++) {
    const double square = ct_columns_dot(&T, &T, j), most = 1.0 / scale[j] - C[j],
                 // -- w = T₋ · (W T)₋ / T₋ · T₋, from 0 to D - C (eq:slip-start)
        own = ct_columns_dot(&T, &image, j) / square, positive = own > 0.0 ? own : 0.0,
                 least = positive < most ? positive : most, w = square > 0.0 ? least : most,
                 divisor = w + C[j];
    for (int c = 0; c < 3; c++)
      // -- -(q + (W T)₋ - w T₋) / (w + C) (eq:slip-start)
      aim.x[c][j] = -((q.x[c][j] + image.x[c][j]) - w * T.x[c][j]) / divisor;
  }
}

/* Take the forces with which the iteration begins; at t = 0 they are given. */
static void take_start(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (s->starts) return;
  start_at(t);
  take_aim(s);
}

/* Solve for the tangential forces with the present normal ones. Allowed forces that already meet
 * twice the tolerance are not changed. Returns the number of rounds that changed them; -1 if they
 * are not finite. */
static int iterate(ct_solver *s, double least)
{
  ct_tangent *t = s->tangent;
  double rho = 0.0, tolerance = 2.0 * least;
  for (int k = 0;; k++, tolerance = least) {
    double size[2] = {0.0, LEAST * t->top};
    if (!ct_tangent_apply(s)) return -1;
    find_slips(t, size);
    ct_pieces_largest(s->pieces, size, 2);
    if (!isfinite(size[0])) return -1;
    t->size_of_force = size[1];
    const int is_solved = size[0] <= tolerance * size[1] && (k > 0 || are_allowed(s));
    if (is_solved || k == t->most_rounds) return k;
    take_step(s, step_of(t, k, &rho));
  }
}

/* Let the gaps `free` and the gradient follow the tangential forces, from `shift` on. Writes the
 * largest change of a normal force that this causes, and the largest of these forces. */
CT_CLONES
static void follow(const ct_solver *s, double *restrict shift, double *restrict free,
                   double *restrict gradient, double size[2])
{
  const double *scale = s->scale, *force = s->force, *next = s->terms;
  double most = 0.0, top = 0.0;
#pragma omp simd reduction(max : most, top)
  for (int64_t r = 0; r < s->count; r++) {
    const double more = next[r] - shift[r], change = fabs(more) * scale[r];
    shift[r] = next[r];
    free[r] += more;
    gradient[r] += more;
    most = change > most ? change : most;
    top = force[r] > top ? force[r] : top;
  }
  size[0] = most, size[1] = top;
}

/* The numbers of the points of all active rows, into `terms`. */
static void spread_points(ct_solver *s, const double *numbers)
{
  ct_copy(s->terms, numbers, (size_t)s->point_count * sizeof *s->terms);
  for (int64_t r = s->point_count; r < s->count; r++)
    s->terms[r] = numbers[s->opened[r - s->point_count]];
}

/* The gaps of all active rows that the tangential forces open, into `terms`. Returns 0 if they are
 * not finite. */
static int find_opened(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  if (!t->active) {
    if (!ct_tangent_push(s)) return 0;
    ct_matrix_times(s, s->count, t->moved, s->terms);
    return 1;
  }
  if (!ct_tangent_apply(s)) return 0;
  spread_points(s, t->opened);
  return 1;
}

/* Let the gaps of all active rows follow the tangential forces. Writes the largest change of a
 * normal force that this causes, as a fraction of the largest. Returns 0 if it is not finite. */
static int shift_gaps(ct_solver *s, double *change)
{
  ct_tangent *t = s->tangent;
  double most[2];
  *change = 0.0;
  if (t->shifted || !t->coupled) return 1;
  if (!find_opened(s)) return 0;
  t->shifted = 1;
  follow(s, t->shift, s->free, s->gradient, most);
  ct_pieces_largest(s->pieces, most, 2);
  *change = most[0] > 0.0 ? most[0] / most[1] : 0.0;
  return 1;
}

/* Let the gaps follow the tangential forces of the last step, as far as these opened them. */
static void shift_first(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  double unused[2];
  if (!t->coupled) return;
  if (t->active) spread_points(s, t->was_opened);
  for (int64_t r = 0; r < s->count && !t->active; r++) {
    const ct_slip *slip = s->active[r]->slip;
    s->terms[r] = slip == NULL ? 0.0 : *ct_slip_number(slip, CT_SLIP_OPENED);
  }
  for (int64_t r = 0; r < s->count && s->fraction != 1.0; r++) s->terms[r] *= s->fraction;
  follow(s, t->shift, s->free, s->gradient, unused);
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
  shift_first(s);
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
    const int rounds = iterate(s, least), converged = rounds < t->most_rounds;
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
  if (pass == 0) ct_tangent_fix_chords(t);
  if (pass == 0 || (pass == 1 && has_new_limits(s))) fix_limits(s);
  if (!find_drift(s)) return 0;
  if (pass == 0) take_start(s);
  const int converged = find_forces(s);
  s->converged = s->converged && converged;
  return converged >= 0 && shift_gaps(s, change);
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
  return shift_gaps(s, &change);
}
