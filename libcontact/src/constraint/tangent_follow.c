/* The gaps follow the tangential forces. */
#include "tangent_follow.h"

#include "../base/lanes.h"
#include "matrix.h"
#include "tangent_matrix.h"

#include <math.h>

/* Let the gaps `free` and the gradient follow the tangential forces, from `shift` on. Writes the
 * largest change of a normal force that this causes, and the largest of these forces. */
CT_CLONES
static void follow(const ct_solver *s, double *restrict shift, double *restrict free,
                   double *restrict gradient, double size[2])
{
  const double *scale = s->scale, *force = s->force, *next = s->terms;
  double most = 0.0, top = 0.0;
#pragma omp simd reduction(max : most, top)
  for (int64_t r = 0; r < s->count; r++) {
    const double more = next[r] - shift[r], change = fabs(more) * scale[r];
    shift[r] = next[r];
    free[r] += more;
    gradient[r] += more;
    most = change > most ? change : most;
    top = force[r] > top ? force[r] : top;
  }
  size[0] = most, size[1] = top;
}

/* The numbers of the points of all active rows, into `terms`. */
static void spread_points(ct_solver *s, const double *numbers)
{
  ct_copy(s->terms, numbers, (size_t)s->point_count * sizeof *s->terms);
  for (int64_t r = s->point_count; r < s->count; r++)
    s->terms[r] = numbers[s->opened[r - s->point_count]];
}

/* The gaps of all active rows that the tangential forces open, into `terms`. Returns 0 if they are
 * not finite. */
static int find_opened(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  if (!t->active) {
    if (!ct_tangent_push(s)) return 0;
    ct_matrix_times(s, s->count, t->moved, s->terms);
    return 1;
  }
  if (!ct_tangent_apply(s)) return 0;
  spread_points(s, t->opened);
  return 1;
}

int ct_tangent_shift(ct_solver *s, double *change)
{
  ct_tangent *t = s->tangent;
  double most[2];
  *change = 0.0;
  if (t->shifted || !t->coupled) return 1;
  if (!find_opened(s)) return 0;
  t->shifted = 1;
  follow(s, t->shift, s->free, s->gradient, most);
  ct_pieces_largest(s->pieces, most, 2);
  *change = most[0] > 0.0 ? most[0] / most[1] : 0.0;
  return 1;
}

void ct_tangent_shift_first(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  double unused[2];
  if (!t->coupled) return;
  if (t->active) spread_points(s, t->was_opened);
  for (int64_t r = 0; r < s->count && !t->active; r++) {
    const ct_slip *slip = s->active[r]->slip;
    s->terms[r] = slip == NULL ? 0.0 : *ct_slip_number(slip, CT_SLIP_OPENED);
  }
  for (int64_t r = 0; r < s->count && s->fraction != 1.0; r++) s->terms[r] *= s->fraction;
  follow(s, t->shift, s->free, s->gradient, unused);
}
