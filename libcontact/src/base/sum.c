#include <libcontact/base.h>

#include "lanes.h"
#include "stream.h"

#include <math.h>
#include <string.h>

CT_CLONES
double ct_largest(const double *values, int64_t count)
{
  double top = 0.0, all = 0.0;
#ifndef __clang__ // clang has no vector maximum that propagates NaN, and warns
#pragma omp simd reduction(max : top) reduction(+ : all)
#endif
  for (int64_t i = 0; i < count; i++) {
    double a = fabs(values[i]);
    all += a; // not finite if a number is not
    top = a > top ? a : top;
  }
  return isfinite(all) ? top : INFINITY;
}

/* Inlined with a known null pointer `from`, or without. */
CT_INLINE void extent(int64_t count, const double *rows, const double *from, double low[3],
                      double high[3])
{
  enum { SOME = 12 }; // four rows side by side
  double least[SOME], most[SOME];
  for (int i = 0; i < SOME; i++) least[i] = INFINITY, most[i] = -INFINITY;
  int64_t d = 0;
  for (; d + SOME <= 3 * count; d += SOME)
#pragma omp simd
    for (int i = 0; i < SOME; i++) {
      const double x = from == NULL ? rows[d + i] : rows[d + i] - from[d + i];
      least[i] = x < least[i] ? x : least[i];
      most[i] = x > most[i] ? x : most[i];
    }
  for (int i = 0; d < 3 * count; d++, i++) {
    const double x = from == NULL ? rows[d] : rows[d] - from[d];
    least[i] = x < least[i] ? x : least[i];
    most[i] = x > most[i] ? x : most[i];
  }
  for (int c = 0; c < 3; c++) low[c] = least[c], high[c] = most[c];
  for (int i = 3; i < SOME; i++) {
    low[i % 3] = least[i] < low[i % 3] ? least[i] : low[i % 3];
    high[i % 3] = most[i] > high[i % 3] ? most[i] : high[i % 3];
  }
}

CT_CLONES
void ct_extent(int64_t count, const double *rows, const double *from, double low[3], double high[3])
{
  if (from == NULL) extent(count, rows, NULL, low, high);
  else extent(count, rows, from, low, high);
}

CT_INLINE double farthest(int64_t count, const double *rows, const double *from,
                          const double origin[3])
{
  const double a = origin[0], b = origin[1], c = origin[2];
  double top = 0.0;
#ifndef __clang__ // as in ct_largest
#pragma omp simd reduction(max : top)
#endif
  for (int64_t d = 0; d < 3 * count; d += 3) {
    double x = rows[d], y = rows[d + 1], z = rows[d + 2];
    if (from != NULL) x -= from[d], y -= from[d + 1], z -= from[d + 2];
    x -= a, y -= b, z -= c;
    const double square = x * x + y * y + z * z;
    top = square > top ? square : top;
  }
  return sqrt(top);
}

CT_CLONES_NODES
double ct_farthest(int64_t count, const double *rows, const double *from, const double origin[3])
{
  return from == NULL ? farthest(count, rows, NULL, origin) : farthest(count, rows, from, origin);
}

/* Whether all of some numbers are zero: only their signs may be set. */
CT_CLONES
static int all_zero(const double *values, int64_t count)
{
  uint64_t bits = 0;
#pragma omp simd reduction(| : bits)
  for (int64_t i = 0; i < count; i++) {
    uint64_t own;
    memcpy(&own, &values[i], sizeof own);
    bits |= own;
  }
  return bits << 1 == 0;
}

int ct_is_zero(const double *values, int64_t count)
{
  // The first and the last one suffice for most arrays that are not zero.
  return count == 0 || (values[0] == 0.0 && values[count - 1] == 0.0 && all_zero(values, count));
}

/* The largest number and the count of all pieces, after the first round. */
static void join_terms(ct_stream *s)
{
  double count = (double)s->count;
  ct_pieces_largest(s->pieces, &s->top, 1);
  ct_pieces_sum(s->pieces, &count, 1);
  s->count = isfinite(count) ? (int64_t)count : 0;
}

/* The sums of all pieces, after the last round. Multiples of one spacing have exact sums in any
 * order (eq:order-free-sum). */
static int join_sums(ct_stream *s)
{
  double sum[2] = {s->coarse, s->fine};
  ct_pieces_sum(s->pieces, sum, 2);
  s->coarse = sum[0];
  s->fine = sum[1];
  return 0;
}

/* Whether one sum needs its terms in the round that begins now: in the first round, and in the
 * second if there are terms that were not added on the same grids yet. */
static int stream_again(ct_stream *s)
{
  ct_grid before = s->grid;
  s->round++;
  if (s->round == 3) return join_sums(s);
  if (s->round != 2) return s->round == 1;
  if (s->pieces != NULL) join_terms(s);
  if (s->top == 0.0) return 0;
  // -- Choose two grids that the largest number and the count fix (eq:order-free-sum)
  int fits = ct_grid_init(&s->grid, s->top, s->count);
  if (fits && s->grid.coarse == before.coarse && s->grid.fine == before.fine) return join_sums(s);
  s->coarse = fits ? 0.0 : NAN;
  s->fine = 0.0;
  return fits;
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

/* Split each number into its parts on the two grids; both sums are exact (eq:order-free-sum).
 * Returns the largest size; infinite if a number is not finite, because then the sum is not. */
CT_CLONES
static double add_parts(const ct_grid *of, const double *terms, int64_t count, double sum[2])
{
  ct_grid grid = *of;
  double coarse = 0.0, fine = 0.0, top = 0.0;
#ifndef __clang__ // as in ct_largest
#pragma omp simd reduction(+ : coarse, fine) reduction(max : top)
#endif
  for (int64_t i = 0; i < count; i++) {
    double a = fabs(terms[i]);
    top = a > top ? a : top;
    ct_grid_add(&grid, terms[i], &coarse, &fine);
  }
  sum[0] += coarse;
  sum[1] += fine;
  return isfinite(coarse + fine) ? top : INFINITY;
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
  // -- Add in the second round, and in the first on the grids of the sum before, which may be the
  // same
  double sum[2] = {s->coarse, s->fine}, top = 0.0;
  int is_added = s->round == 2 || (s->round == 1 && s->grid.coarse != 0.0);
  // At rest the terms of whole pieces are zero and do not change a sum.
  int is_zero = terms == NULL || ct_is_zero(terms, count);
  if (is_added && !is_zero) top = add_parts(&s->grid, terms, count, sum);
  s->coarse = sum[0];
  s->fine = sum[1];
  // -- In the first find the largest number and the count, which fix the grids
  if (s->round != 1) return;
  if (!is_added && !is_zero) top = ct_largest(terms, count);
  s->count += count;
  s->top = top > s->top ? top : s->top;
}

double ct_stream_sum(const ct_stream *s) { return s->coarse + s->fine; }

double ct_sum_over(const ct_pieces *pieces, const double *values, int64_t count)
{
  ct_stream sum = {.pieces = pieces};
  while (ct_stream_again(&sum, 1)) ct_stream_add(&sum, values, count);
  return ct_stream_sum(&sum);
}

double ct_sum(const double *values, int64_t count) { return ct_sum_over(NULL, values, count); }

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
  for (int32_t first, end = 0; ct_stream_piece(&sum, 1, count, &first, &end);) {
    ct_product_terms(end - first, mass != NULL ? mass + first : NULL, x + 3 * (int64_t)first,
                     y + 3 * (int64_t)first, terms);
    ct_stream_add(&sum, terms, end - first);
  }
  return ct_stream_sum(&sum);
}
