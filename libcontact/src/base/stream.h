#ifndef CT_SRC_STREAM_H
#define CT_SRC_STREAM_H

#include <stdint.h>

#include "grid.h"

/* ct_sum of numbers that never stand side by side: they are made twice, in pieces of any size,
 * first to find the largest one and how many there are, then to be added (eq:order-free-sum). Zero
 * it, and
 *
 *   for (int32_t first, end; ct_stream_piece(&sum, 1, count, &first, &end);)
 *     make the terms first ... end - 1; ct_stream_add(&sum, terms, end - first);
 *
 * then ct_stream_sum gives the bits of ct_sum of all the terms. A sum that begins with the grids of
 * one before, {.grid = ...}, makes its terms once if they turn out to be its own, with the same
 * bits. */
typedef struct ct_stream {
  int round; /* 0: not begun, 1: the largest is sought, 2: terms are added, 3: done */
  int64_t count;
  double top, coarse, fine;
  ct_grid grid;
} ct_stream;

/* Terms that are made at once, and the end of the piece that begins at `first` of terms that end at
 * `last`. */
enum { CT_PIECE = 256 };
static inline int32_t ct_piece_end(int32_t first, int32_t last)
{
  return last - first < CT_PIECE ? last : first + CT_PIECE;
}

/* Whether the terms of one of some sums, which go together, must be made once more. */
int ct_stream_again(ct_stream *sums, int count);

/* The next piece of `count` terms of some sums, which go together; answers 0 after the last one. */
int ct_stream_piece(ct_stream *sums, int sum_count, int32_t count, int32_t *first, int32_t *end);

/* Show or add the next terms; null: all of them are zero. */
void ct_stream_add(ct_stream *sum, const double *terms, int64_t count);

/* The sum, at the end. */
double ct_stream_sum(const ct_stream *sum);

/* Largest size of some numbers; infinite if one is not finite. */
double ct_largest(const double *values, int64_t count);

/* Smallest and largest of each column of an array (count, 3), leaving NaN out; infinite, the wrong
 * way round, without rows. */
void ct_extent(int64_t count, const double *rows, double low[3], double high[3]);

/* Whether all of some numbers are zero, of either sign. */
int ct_is_zero(const double *values, int64_t count);

/* m x · y of `count` nodes, shapes (count) and (count, 3); `mass` null: m = 1. */
void ct_product_terms(int32_t count, const double *mass, const double *x, const double *y,
                      double *terms);

/* The sum of them. */
double ct_sum_product(int32_t count, const double *mass, const double *x, const double *y);

#endif
