/* What the tangential forces of a step store and lose: elastic slips, works and reserves of all
 * points (eq:slip-store, eq:slip-loss). */
#include "tangent_settle.h"

#include "../base/lanes.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "tangent.h"
#include "tangent_matrix.h"

#include <float.h>
#include <math.h>

/* A point sticks when its slip is below this many times the tolerated change of its force. The
 * share of a disc's radius that counts as its edge; and the share of the springs' energy above
 * which points that pay with it have slipped. */
static const double STICK = 10.0, ON_EDGE = 1e-9, SLIPPED = 0.01;

/* The reserves that the points want for the next step; -1 for points that stick: the iteration does
 * not resolve their slips, and their forces are within the discs or not against the slips
 * (eq:slip-stick). Computed without branches; `may_stick` is 1 or 0. */
CT_CLONES
static void find_wanted(const ct_tangent *t, double may_stick, double *restrict wanted)
{
  const double reach = may_stick * STICK * t->tolerance * t->size_of_force;
  const double *limit = t->limit, *scale = t->scale, *x = t->T.x[0], *y = t->T.x[1], *z = t->T.x[2],
               *X = t->slip.x[0], *Y = t->slip.x[1], *Z = t->slip.x[2];
#pragma omp simd
  for (int64_t j = 0; j < t->count; j++) {
    // -- λ > 0, |Δs| <= 10 ε D max |T|, and |T| < μ λ or T · Δs >= 0 (eq:slip-stick)
    const double most = reach / scale[j], edge = (1.0 - ON_EDGE) * limit[j],
                 slow = most * most - ((X[j] * X[j] + Y[j] * Y[j]) + Z[j] * Z[j]),
                 within = edge * edge - ((x[j] * x[j] + y[j] * y[j]) + z[j] * z[j]),
                 along = (x[j] * X[j] + y[j] * Y[j]) + z[j] * Z[j],
                 held = within > along ? within : along, sticks = slow < held ? slow : held;
    // -- R = -½ T · slip (eq:slip-store)
    const double R = -0.5 * along, next = R > 0.0 ? R : 0.0;
    wanted[j] = ((sticks >= 0.0) & (limit[j] > 0.0)) ? -1.0 : next;
  }
}

/* The elastic slips at the end of the step, and the energies of all rows. */
CT_CLONES
static void find_works(const ct_tangent *t)
{
  const ct_columns T = t->T, e = t->e, e0 = t->e0, slip = t->slip, last = t->last, end = t->end;
  const double *C = t->C, *kappa = t->kappa, *k = t->k, *reserve = t->reserve, *wanted = t->wanted;
  double *work = t->work, *lag = t->lag, *loss = t->loss;
#pragma omp simd
  for (int64_t j = 0; j < t->count; j++) {
    double own[3];
    for (int c = 0; c < 3; c++) {
      const double law = -C[j] * T.x[c][j] - kappa[j] * e0.x[c][j],
                   stays = wanted[j] < 0.0 ? slip.x[c][j] : 0.0;
      // -- e_n + D₊ where it sticks, D₊ being Δs - C T - e_n - κ e_{n-1} (eq:slip-residual)
      end.x[c][j] = own[c] = law + stays;
    }
    const double spring = C[j] * ct_columns_dot(&T, &T, j) +
                          (ct_columns_dot(&T, &e, j) + kappa[j] * ct_columns_dot(&T, &e0, j)),
                 after = ct_columns_dot(&T, &slip, j) - spring,
                 earlier = ct_columns_dot(&T, &last, j),
                 ended = (own[0] * own[0] + own[1] * own[1]) + own[2] * own[2];
    // -- ½ T · (D₊ + D₋) (eq:slip-work)
    work[j] = 0.5 * (after + earlier);
    // -- ¼ T · (D₊ - D₋) (eq:slip-held)
    lag[j] = 0.25 * (after - earlier);
    // -- ½ (Π(e_{n-1}) - Π(e_{n+1})) + R₋ - W (eq:slip-loss)
    loss[j] = 0.25 * k[j] * (ct_columns_dot(&e0, &e0, j) - ended) + (reserve[j] - work[j]);
  }
}

/* Energy that all rows lose together (eq:slip-loss), 0 where it is rounding. */
static double find_loss(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const double loss = t->lost = ct_sum_over(s->pieces, t->loss, t->count);
  if (loss >= 0.0) return loss;
  for (int64_t j = 0; j < t->count; j++)
    t->terms[j] =
        0.25 * t->k[j] * (ct_columns_dot(&t->e, &t->e, j) + ct_columns_dot(&t->e0, &t->e0, j)) +
        fabs(t->work[j]) + 2.0 * fabs(t->lag[j]);
  const double size = ct_sum_over(s->pieces, t->terms, t->count);
  return loss >= -8.0 * DBL_EPSILON * size ? 0.0 : loss;
}

double ct_tangent_settle(ct_solver *s, double may_stick)
{
  ct_tangent *t = s->tangent;
  find_wanted(t, may_stick, t->wanted);
  find_works(t);
  return find_loss(s);
}

int ct_tangent_shorten_slips(ct_solver *s, double gain)
{
  ct_tangent *t = s->tangent;
  for (int64_t j = 0; j < t->count; j++)
    t->terms[j] = t->wanted[j] < 0.0 ? 0.25 * t->k[j] * ct_columns_dot(&t->end, &t->end, j) : 0.0;
  const double stored = ct_sum_over(s->pieces, t->terms, t->count), share = gain / stored;
  if (!(gain < stored)) return 0;
  // -- e_{n+1} √(1 - gain / stored) (eq:slip-paid)
  const double factor = sqrt(1.0 - share);
  for (int64_t j = 0; j < t->count; j++) {
    if (t->wanted[j] >= 0.0) continue;
    for (int c = 0; c < 3; c++) t->end.x[c][j] *= factor;
    if (share > SLIPPED) t->wanted[j] = 0.0;
  }
  return 1;
}

/* Numbers above 0. */
CT_CLONES
static void find_positive(int64_t count, const double *x, double *restrict out)
{
#pragma omp simd
  for (int64_t j = 0; j < count; j++) out[j] = ct_larger(x[j], 0.0);
}

/* The part of the wanted reserves that the losses of the step pay (eq:slip-stick). */
static double part_of_reserves(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  find_positive(t->count, t->wanted, t->terms);
  const double wanted = ct_sum_over(s->pieces, t->terms, t->count);
  return wanted > t->lost ? fmax(t->lost, 0.0) / wanted : 1.0;
}

/* What the points store of the rows: for those without a force nothing, as for new points. Returns
 * whether all have one. */
CT_CLONES
CT_CHOICES
static int find_stored(const ct_tangent *t, double part)
{
  const double *x = t->T.x[0], *y = t->T.x[1], *z = t->T.x[2], *limit = t->limit,
               *wanted = t->wanted;
  double *reserve = t->reserve, *stuck = t->stuck, *acts = t->terms, all = 1.0;
#pragma omp simd reduction(min : all)
  for (int64_t j = 0; j < t->count; j++) {
    const double size = (fabs(x[j]) + fabs(y[j])) + fabs(z[j]), R = wanted[j],
                 own = limit[j] + size > 0.0 ? 1.0 : 0.0; // without a branch
    acts[j] = own;
    all = own < all ? own : all;
    reserve[j] = R > 0.0 ? part * R : 0.0;
    stuck[j] = R < 0.0 ? 1.0 : 0.0;
  }
  return all > 0.0;
}

/* Write one number of the points of some rows, 0 where they do not act; in place, too. */
CT_INLINE void write_number(int64_t count, int all, const double *acts, const double *from,
                            double *to)
{
  if (all) {
    if (from != to) ct_copy(to, from, (size_t)count * sizeof *to);
    return;
  }
#pragma omp simd
  for (int64_t n = 0; n < count; n++) {
    const double own = from[n];
    to[n] = acts[n] != 0.0 ? own : 0.0;
  }
}

/* Write the forces of the rows from `j` on, the elastic slips and the reserves of their points;
 * `all`: whether all rows act. */
CT_INLINE void write_points(const ct_tangent *t, int64_t j, int64_t count, int all)
{
  enum { FIRST = CT_SLIP_E, COUNT = CT_SLIP_LAG + 1 - FIRST };
  const double *from[COUNT];
  for (int c = 0; c < 3; c++) {
    from[CT_SLIP_E - FIRST + c] = t->end.x[c], from[CT_SLIP_BEFORE - FIRST + c] = t->e.x[c];
    from[CT_SLIP_FORCE - FIRST + c] = t->T.x[c], from[CT_SLIP_IMAGE - FIRST + c] = t->image.x[c];
  }
  from[CT_SLIP_RESERVE - FIRST] = t->reserve, from[CT_SLIP_STUCK - FIRST] = t->stuck;
  from[CT_SLIP_OPENED - FIRST] = t->opened;
  from[CT_SLIP_WORK - FIRST] = t->work, from[CT_SLIP_LAG - FIRST] = t->lag;
  for (int i = COUNT - 1; i >= 0; i--) // e_n, before e_{n+1} takes its place
    write_number(count, all, &t->terms[j], &from[i][j],
                 ct_slip_number(t->rows[j]->slip, FIRST + i));
}

/* The same of all rows. */
CT_CLONES
static void write_all(const ct_tangent *t, int all)
{
  for (int64_t j = 0, count; j < t->count; j += count) {
    count = ct_tangent_run(t, j);
    write_points(t, j, count, all);
  }
}

void ct_tangent_store(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!t->some) return;
  const double part = part_of_reserves(s);
  // At t = 0 forces act for half a step.
  const double steps = 1.0 / s->fraction;
  for (int64_t j = 0; j < t->count && steps != 1.0; j++) {
    t->opened[j] *= steps;
    for (int c = 0; c < 3; c++) t->image.x[c][j] *= steps;
  }
  write_all(t, find_stored(t, part));
  ct_tangent_give(s);
}
