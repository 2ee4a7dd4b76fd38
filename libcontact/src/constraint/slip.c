/* The law of friction at a point. */
#include "slip.h"

#include "../base/vector.h"

#include <math.h>

void ct_slip_open(ct_slip *s)
{
  s->stuck = 0;
  s->reserve = s->work = s->lag = 0.0;
  for (int i = 0; i < 3; i++) s->e[i] = s->before[i] = s->force[i] = 0.0;
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

double ct_slip_stored(const ct_slip *s)
{
  // -- ½ (Π(e_n) + Π(e_{n+1})) + R (eq:slip-store)
  return 0.25 * s->k * (ct_vector_dot(s->before, s->before) + ct_vector_dot(s->e, s->e)) +
         s->reserve;
}
