/* The law of friction at a point. */
#include "slip.h"

#include "../base/lanes.h"
#include "../base/vector.h"

#include <math.h>

void ct_slip_open(const ct_slip *s)
{
  for (int i = CT_SLIP_E; i <= CT_SLIP_LAG; i++) *ct_slip_number(s, i) = 0.0;
}

/* Shorten a vector to a length. */
static void shorten(double length, double v[3])
{
  const double part = ct_slip_part(length, ct_vector_dot(v, v));
  for (int i = 0; i < 3; i++) v[i] *= part;
}

void ct_slip_project(const ct_slip_set *set, double T[3])
{
  const double *c = set->c, c2 = ct_vector_dot(c, c), given[3] = {T[0], T[1], T[2]};
  // -- The disc alone
  shorten(set->limit, T);
  if (!(c2 > 0.0) || !(ct_vector_dot(T, c) > set->most)) return;
  // -- The chord T · c = most: its middle, and the way from there, as far as the disc goes
  // (eq:slip-projection)
  const double along = ct_vector_dot(given, c) / c2, middle = set->most / c2,
               half = set->limit * set->limit - set->most * middle;
  for (int i = 0; i < 3; i++) T[i] = given[i] - along * c[i];
  shorten(sqrt(fmax(half, 0.0)), T);
  for (int i = 0; i < 3; i++) T[i] += middle * c[i];
}

CT_CLONES
void ct_slip_stored(const ct_slips *of, int64_t count, double *restrict stored)
{
  const int64_t to = of->stride;
  const double *k = &of->numbers[to * CT_SLIP_K], *e = &of->numbers[to * CT_SLIP_E],
               *before = &of->numbers[to * CT_SLIP_BEFORE],
               *reserve = &of->numbers[to * CT_SLIP_RESERVE];
#pragma omp simd
  for (int64_t n = 0; n < count; n++) {
    const double first = (before[n] * before[n] + before[to + n] * before[to + n]) +
                         before[2 * to + n] * before[2 * to + n],
                 last = (e[n] * e[n] + e[to + n] * e[to + n]) + e[2 * to + n] * e[2 * to + n];
    // -- ½ (Π(e_n) + Π(e_{n+1})) + R (eq:slip-store)
    stored[n] = 0.25 * k[n] * (first + last) + reserve[n];
  }
}
