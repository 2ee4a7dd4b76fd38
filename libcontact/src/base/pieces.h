#ifndef CT_SRC_PIECES_H
#define CT_SRC_PIECES_H

#include <libcontact/base.h>

#include <math.h>

/* Replace numbers by their sums over all pieces, or by the largest of each; null: one piece, which
 * changes nothing. All pieces call at the same time with the same count. If they cannot be joined,
 * the numbers become NaN, so that the step fails. */
static inline void ct_pieces_sum(const ct_pieces *pieces, double *values, int64_t count)
{
  if (pieces == NULL || pieces->sum(pieces->data, values, count) == 0) return;
  for (int64_t i = 0; i < count; i++) values[i] = NAN;
}

static inline void ct_pieces_largest(const ct_pieces *pieces, double *values, int64_t count)
{
  if (pieces == NULL || pieces->largest(pieces->data, values, count) == 0) return;
  for (int64_t i = 0; i < count; i++) values[i] = NAN;
}

/* ct_sum of the numbers of all pieces. */
double ct_sum_over(const ct_pieces *pieces, const double *values, int64_t count);

#endif
