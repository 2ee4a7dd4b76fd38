/* The laws of the tangential forces in a step. */
#include "tangent_laws.h"

#include "../base/lanes.h"
#include "law.h"
#include "tangent_matrix.h"

#include <math.h>

/* The compliance C of a point that opens, over its bound of W: so small that its force follows the
 * motion of one step, and not so small that the iteration takes many rounds. */
static const double FOLLOWS = 0.1;

/* Let the elastic slip have been the same one step ago, with the same energy: then all of the last
 * motion was slip. What it does not store becomes reserve, and a larger slip is shortened. */
static void forget_motion(const ct_tangent *t, int64_t j)
{
  const double k4 = 0.25 * t->k[j], e2 = ct_columns_dot(&t->e, &t->e, j),
               S = k4 * (e2 + ct_columns_dot(&t->e0, &t->e0, j)) + t->reserve[j],
               // -- e ← min(1, √(S₋ / ½ k e²)) e_n, R ← ⟨S₋ - ½ k e²⟩ (eq:slip-opens)
      left = S - 2.0 * k4 * e2, part = left < 0.0 ? sqrt(S / (2.0 * k4 * e2)) : 1.0;
  for (int c = 0; c < 3; c++) t->e0.x[c][j] = t->e.x[c][j] *= part;
  t->reserve[j] = ct_larger(left, 0.0);
  t->stuck[j] = 0.0;
}

/* The springs of points that open and cannot follow the motion: their dashpots `a` grow. Then the
 * force is μ times the whole normal force where they slip (eq:slip-opens). */
static void follow_releases(const ct_solver *s, double *a)
{
  const ct_tangent *t = s->tangent;
  for (int64_t r = s->point_count, j = 0; r < s->count; r++) {
    if (s->active[r]->slip == NULL) continue;
    while (t->rows[j] != s->active[r]) j++;
    // -- C = 2 / (k (1 + a)) = B / 10 (eq:slip-opens)
    const double least = 2.0 / (FOLLOWS * t->k[j] * t->widening * t->scale[j]) - 1.0;
    if (!(least > a[j])) continue;
    a[j] = least;
    forget_motion(t, j);
  }
}

/* The springs of all rows with the dashpots `a`, and 1 / D with their compliances. Returns the
 * largest -D⁻¹ C. */
CT_CLONES
static double fix_springs(int64_t count, double widening, const double *k, const double *a,
                          double *restrict C, double *restrict kappa, double *restrict scale)
{
  double slowest = -1.0;
#pragma omp simd reduction(max : slowest)
  for (int64_t j = 0; j < count; j++) {
    // -- C = 2 / (k (1 + a)), κ = (1 - a) / (1 + a) (eq:slip-residual)
    C[j] = 2.0 / (k[j] * (1.0 + a[j]));
    kappa[j] = (1.0 - a[j]) / (1.0 + a[j]);
    // -- D = C + (1 + η)² B (eq:slip-bound-couples)
    scale[j] = 1.0 / (widening * scale[j] + C[j]);
    const double ratio = -C[j] * scale[j];
    slowest = ratio > slowest ? ratio : slowest;
  }
  return slowest;
}

int ct_tangent_fix_laws(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (!ct_tangent_bound(s)) return 0;
  for (int64_t j = 0; j < t->count && !t->active; j++) t->zeta[j] = t->rows[j]->dissipation;
  const double *zeta = t->active ? s->laws.dissipation : t->zeta;
  ct_law_dampings(t->count, zeta, t->k, t->scale, s->fraction, t->terms);
  follow_releases(s, t->terms);
  double slowest = fix_springs(t->count, t->widening, t->k, t->terms, t->C, t->kappa, t->scale);
  // -- The smallest eigenvalue of D⁻¹ (W + C) is at least that of D⁻¹ C (eq:slip-iteration)
  ct_pieces_largest(s->pieces, &slowest, 1);
  t->lowest = -slowest;
  return 1;
}

/* The slips of the last step and twice the reserves. A point that moved by rounding has not
 * slipped, that of its own motion or of what the allowed force may move; nor has one that stuck, as
 * the length of a slip is at most the size of its terms. */
CT_CLONES
CT_CHOICES
void ct_tangent_fix_chords(const ct_tangent *t)
{
  static const double ROUNDING = 1e-13;
  const ct_columns last = t->last, e = t->e, e0 = t->e0, chord = t->c;
  const double *stuck = t->stuck, *reserve = t->reserve, *limit = t->limit, *scale = t->scale;
  double *most = t->most;
#pragma omp simd
  for (int64_t j = 0; j < t->count; j++) {
    double c[3], size = 0.0, length = 0.0;
    for (int k = 0; k < 3; k++) {
      // -- c = D₋ - (e_n - e_{n-1}), the slip of the last step (eq:slip-set)
      c[k] = last.x[k][j] - (e.x[k][j] - e0.x[k][j]);
      size = ct_larger(fabs(last.x[k][j]) + fabs(e.x[k][j]) + fabs(e0.x[k][j]), size);
      length = ct_larger(fabs(c[k]), length);
    }
    const double least =
                     ct_larger((ROUNDING + 2.0 * stuck[j]) * size, ROUNDING * limit[j] / scale[j]),
                 has = length > least ? 1.0 : 0.0;
    for (int k = 0; k < 3; k++) chord.x[k][j] = has == 0.0 ? 0.0 : c[k];
    most[j] = 2.0 * ct_larger(reserve[j], 0.0);
  }
}
