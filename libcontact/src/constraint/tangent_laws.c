/* The laws of the tangential forces in a step. */
#include "tangent_laws.h"

#include "../base/lanes.h"
#include "law.h"
#include "tangent_matrix.h"

#include <math.h>

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
  ct_law_dampings(t->count, t->zeta, t->k, t->scale, s->fraction, t->terms);
  double slowest = fix_springs(t->count, t->widening, t->k, t->terms, t->C, t->kappa, t->scale);
  // -- The smallest eigenvalue of D⁻¹ (W + C) is at least that of D⁻¹ C (eq:slip-iteration)
  ct_pieces_largest(s->pieces, &slowest, 1);
  t->lowest = -slowest;
  return 1;
}

/* One component of the slips of the last step, the sizes of their terms, and theirs; `keep` is 0
 * for the first component, and then 1. */
CT_CLONES
static void find_chords(int64_t count, double keep, const double *last, const double *e,
                        const double *e0, double *restrict c, double *restrict size,
                        double *restrict length)
{
#pragma omp simd
  for (int64_t j = 0; j < count; j++) {
    // -- c = D₋ - (e_n - e_{n-1}), the slip of the last step (eq:slip-set)
    c[j] = last[j] - (e[j] - e0[j]);
    size[j] = ct_larger(fabs(last[j]) + fabs(e[j]) + fabs(e0[j]), keep * size[j]);
    length[j] = ct_larger(fabs(c[j]), keep * length[j]);
  }
}

/* A point that moved by rounding has not slipped; nor has one that stuck. The length is at most
 * the size. */
CT_CLONES
static void drop_chords(int64_t count, const double *stuck, const double *size,
                        const double *length, double *restrict c)
{
  static const double ROUNDING = 1e-13;
#pragma omp simd
  for (int64_t j = 0; j < count; j++) {
    const double own = c[j];
    c[j] = length[j] > (ROUNDING + 2.0 * stuck[j]) * size[j] ? own : 0.0;
  }
}

/* Twice the reserves (eq:slip-set). */
CT_CLONES
CT_CHOICES
static void find_most(int64_t count, const double *reserve, double *restrict most)
{
#pragma omp simd
  for (int64_t j = 0; j < count; j++) most[j] = 2.0 * ct_larger(reserve[j], 0.0);
}

void ct_tangent_fix_chords(const ct_tangent *t)
{
  double *size = t->terms, *length = t->wanted;
  for (int c = 0; c < 3; c++)
    find_chords(t->count, c > 0, t->last.x[c], t->e.x[c], t->e0.x[c], t->c.x[c], size, length);
  for (int c = 0; c < 3; c++) drop_chords(t->count, t->stuck, size, length, t->c.x[c]);
  find_most(t->count, t->reserve, t->most);
}
