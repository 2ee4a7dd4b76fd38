#ifndef CT_SRC_STREAM_H
#define CT_SRC_STREAM_H

#include <stdint.h>

#include "grid.h"
#include "pieces.h"

/* ct_sum of numbers that are never stored together. They are computed twice, in pieces of any size:
 * first to find the largest one and their count, then to be added (eq:order-free-sum). Zero it, and
 *
 *   for (int32_t first, end; ct_stream_piece(&sum, 1, count, &first, &end);)
 *     compute the terms first ... end - 1; ct_stream_add(&sum, terms, end - first);
 *
 * then ct_stream_sum gives the bits of ct_sum of all the terms. A sum that begins with the grids of
 * an earlier one, {.grid = ...}, computes its terms only once if these grids are its own, with the
 * same bits. With `pieces`, the terms of all pieces are added, with the bits of one piece that has
 * all of them. */
typedef struct ct_stream {
  const ct_pieces *pieces; /* null: one piece */
  int round;               /* 0: not begun, 1: finding the largest, 2: adding, 3: done */
  int64_t count;
  double top, coarse, fine;
  ct_grid grid;
} ct_stream;

/* Number of terms in one piece, and end of the piece that begins at `first` of terms up to `last`.
 */
enum { CT_PIECE = 256 };
static inline int32_t ct_piece_end(int32_t first, int32_t last)
{
  return last - first < CT_PIECE ? last : first + CT_PIECE;
}

/* Whether the terms of one of several sums, computed together, are needed once more. */
int ct_stream_again(ct_stream *sums, int count);

/* The next piece of `count` terms of several sums, computed together; returns 0 after the last one.
 */
int ct_stream_piece(ct_stream *sums, int sum_count, int32_t count, int32_t *first, int32_t *end);

/* Inspect or add the next terms; null: all of them are zero. */
void ct_stream_add(ct_stream *sum, const double *terms, int64_t count);

/* The result. */
double ct_stream_sum(const ct_stream *sum);

/* Largest size of some numbers; infinite if the sum of their sizes is not finite. */
double ct_largest(const double *values, int64_t count);

/* Smallest and largest value of each column of an array (count, 3), less another one unless that is
 * null, without NaN; infinite and exchanged if there are no rows. */
void ct_extent(int64_t count, const double *rows, const double *from, double low[3],
               double high[3]);

/* Largest distance of these rows from a point; 0 if there are none. */
double ct_farthest(int64_t count, const double *rows, const double *from, const double origin[3]);

/* Whether all of some numbers are zero, of either sign. */
int ct_is_zero(const double *values, int64_t count);

/* m x · y of `count` nodes, shapes (count) and (count, 3); `mass` null: m = 1. */
void ct_product_terms(int32_t count, const double *mass, const double *x, const double *y,
                      double *terms);

/* Their sum. */
double ct_sum_product(int32_t count, const double *mass, const double *x, const double *y);

#endif
