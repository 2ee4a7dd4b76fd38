/* Energy that rows lose with the present forces, and whether a set of them makes any. */
#include "losses.h"
#include "law.h"

#include "../base/lanes.h"
#include "../base/stream.h"

#include <float.h>
#include <math.h>

CT_CLONES
void ct_find_after(int64_t count, const double *gradient, const double *b, const double *C,
                   const double *force, double *restrict after)
{
#pragma omp simd
  // -- g_{n+1}, of the slope g_{n+1} + b + C λ
  for (int64_t r = 0; r < count; r++) after[r] = gradient[r] - b[r] - C[r] * force[r];
}

/* Energy that each row loses. The second row of a point that opens takes from what the point holds
 * (eq:release-ramp). */
static void find_losses(ct_solver *s)
{
  const ct_law_rows *of = &s->laws;
  ct_law_losses(of, s->force, s->after, s->terms);
  for (int64_t r = s->point_count; r < s->count; r++) {
    const int64_t own = s->opened[r - s->point_count];
    s->terms[r] = fmin(of->reserve[own] - 0.5 * s->force[r] * (s->after[r] - of->before[own]), 0.0);
  }
}

/* Size of the terms of each loss. */
CT_CLONES
static void find_point_sizes(const ct_law_rows *of, const double *force, const double *after,
                             double *restrict sizes)
{
#pragma omp simd
  for (int64_t r = 0; r < of->count; r++)
    sizes[r] = fabs(force[r]) * (fabs(after[r]) + fabs(of->before[r]));
}

static void find_sizes(ct_solver *s)
{
  find_point_sizes(&s->laws, s->force, s->after, s->terms);
  for (int64_t r = s->point_count; r < s->count; r++) {
    const double before = s->laws.before[s->opened[r - s->point_count]];
    s->terms[r] = s->force[r] * (fabs(s->after[r]) + fabs(before));
  }
}

/* Add numbers and their sizes in any order. */
CT_CLONES
static void add_roughly(int64_t count, const double *terms, double sums[2])
{
  double sum = 0.0, size = 0.0;
#pragma omp simd reduction(+ : sum, size)
  for (int64_t r = 0; r < count; r++) sum += terms[r], size += fabs(terms[r]);
  sums[0] += sum, sums[1] += size;
}

/* Σ of the terms of a set's rows, independent of their order. */
static double sum_set(const ct_solver *s, int32_t k)
{
  const int64_t *points = &s->first_point[k], *opening = &s->first_release[k];
  ct_stream sum = {.pieces = s->pieces};
  while (ct_stream_again(&sum, 1)) {
    ct_stream_add(&sum, &s->terms[points[0]], points[1] - points[0]);
    ct_stream_add(&sum, &s->terms[opening[0]], opening[1] - opening[0]);
  }
  return ct_stream_sum(&sum);
}

/* Whether the terms of a set's rows have a sum that no rounding makes negative, in whatever order
 * they are added. */
static int is_positive(const ct_solver *s, int32_t k)
{
  const int64_t *points = &s->first_point[k], *opening = &s->first_release[k];
  double sums[2] = {0.0, 0.0};
  add_roughly(points[1] - points[0], &s->terms[points[0]], sums);
  add_roughly(opening[1] - opening[0], &s->terms[opening[0]], sums);
  ct_pieces_sum(s->pieces, sums, 2);
  // n terms are added to within n ε / 2 of their sizes.
  return sums[0] > (double)s->all_count * DBL_EPSILON * sums[1];
}

int ct_loses_energy(ct_solver *s)
{
  ct_find_after(s->count, s->gradient, s->b, s->C, s->force, s->after);
  find_losses(s);
  for (int32_t k = 0; k < s->set_count; k++) {
    if (is_positive(s, k)) continue;
    const double sum = sum_set(s, k);
    if (sum >= 0.0) continue;
    // Round-off counts only where the losses are not positive.
    find_sizes(s);
    if (!(sum >= -4.0 * DBL_EPSILON * sum_set(s, k))) return 0;
    find_losses(s);
  }
  return 1;
}
