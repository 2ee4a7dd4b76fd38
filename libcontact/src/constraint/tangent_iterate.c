/* The iteration for the tangential forces: projected Chebyshev steps, and then an accelerated
 * projected gradient (eq:slip-iteration). */
#include "tangent_iterate.h"

#include "../base/lanes.h"
#include "tangent_matrix.h"

#include <math.h>

enum { MOST_CHEBYSHEV = 40 };

/* Smallest eigenvalue of D⁻¹ (W + C) that Chebyshev steps count on; the largest is at most 1. */
static const double LOWEST = 0.08;

/* The smallest limit that counts as a force, as a fraction of the largest. */
static const double LEAST = 1e-6;

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
  t->allowed = 1;
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

void ct_tangent_start(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!s->starts) start_at(t);
  for (int c = 0; c < 3 && s->starts; c++)
    ct_copy(t->aim.x[c], t->T.x[c], (size_t)t->count * sizeof(double));
  take_aim(s);
}

int ct_tangent_iterate(ct_solver *s, double least)
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
    const int is_solved = size[0] <= tolerance * size[1] && t->allowed;
    if (is_solved || k == t->most_rounds) {
      ct_tangent_apply_rest(t);
      return k;
    }
    take_step(s, step_of(t, k, &rho));
  }
}
