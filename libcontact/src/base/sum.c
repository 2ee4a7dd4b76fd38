#include <libcontact/base.h>

#include "lanes.h"
#include "stream.h"

#include <float.h>
#include <math.h>

CT_CLONES
double ct_largest(const double *values, int64_t count)
{
  double top = 0.0;
  int odd = 0;
#ifndef __clang__ // which knows no vector maximum that minds NaN, and says so
#pragma omp simd reduction(max : top) reduction(| : odd)
#endif
  for (int64_t i = 0; i < count; i++) {
    double a = fabs(values[i]);
    odd |= !(a <= DBL_MAX);
    top = a > top ? a : top;
  }
  return odd ? INFINITY : top;
}

/* Whether one sum needs its terms in the round that begins now: in the first, and in the second if
 * there is something to add. */
static int stream_again(ct_stream *s)
{
  s->round++;
  if (s->round != 2) return s->round == 1;
  if (s->top == 0.0) return 0;
  // -- Choose two grids that the largest number and the count fix (eq:order-free-sum)
  if (ct_grid_init(&s->grid, s->top, s->count)) return 1;
  s->coarse = NAN;
  return 0;
}

int ct_stream_again(ct_stream *sums, int count)
{
  int again = 0;
  for (int i = 0; i < count; i++) {
    int own = stream_again(&sums[i]);
    if (!own) sums[i].round = 3;
    again |= own;
  }
  return again;
}

/* Cut each number into its parts on the two grids; both sums are exact (eq:order-free-sum). */
CT_CLONES
static void add_parts(const ct_grid *of, const double *terms, int64_t count, double sum[2])
{
  ct_grid grid = *of;
  double coarse = 0.0, fine = 0.0;
#pragma omp simd reduction(+ : coarse, fine)
  for (int64_t i = 0; i < count; i++) ct_grid_add(&grid, terms[i], &coarse, &fine);
  sum[0] += coarse;
  sum[1] += fine;
}

int ct_stream_piece(ct_stream *sums, int sum_count, int32_t count, int32_t *first, int32_t *end)
{
  if (sums->round == 0 || *end == count) {
    if (!ct_stream_again(sums, sum_count)) return 0;
    *end = 0;
  }
  *first = *end;
  *end = ct_piece_end(*first, count);
  return 1;
}

void ct_stream_add(ct_stream *s, const double *terms, int64_t count)
{
  // -- In the first round only look: the largest number and the count fix the grids
  if (s->round == 1) {
    s->count += count;
    s->top = fmax(s->top, ct_largest(terms, count));
  }
  if (s->round != 2) return;
  double sum[2] = {s->coarse, s->fine};
  add_parts(&s->grid, terms, count, sum);
  s->coarse = sum[0];
  s->fine = sum[1];
}

double ct_stream_sum(const ct_stream *s) { return s->coarse + s->fine; }

double ct_sum(const double *values, int64_t count)
{
  ct_stream sum = {0};
  while (ct_stream_again(&sum, 1)) ct_stream_add(&sum, values, count);
  return ct_stream_sum(&sum);
}

void ct_product_terms(int32_t count, const double *mass, const double *x, const double *y,
                      double *terms)
{
  for (int32_t n = 0; n < count; n++, x += 3, y += 3)
    terms[n] = (mass != NULL ? mass[n] : 1.0) * ((x[0] * y[0] + x[1] * y[1]) + x[2] * y[2]);
}

double ct_sum_product(int32_t count, const double *mass, const double *x, const double *y)
{
  ct_stream sum = {0};
  double terms[CT_PIECE];
  for (int32_t first, end; ct_stream_piece(&sum, 1, count, &first, &end);) {
    ct_product_terms(end - first, mass != NULL ? mass + first : NULL, x + 3 * (int64_t)first,
                     y + 3 * (int64_t)first, terms);
    ct_stream_add(&sum, terms, end - first);
  }
  return ct_stream_sum(&sum);
}
