/* Surfaces that lie in each other at the start: refused, kept, or parted gently. */
#include <contact/contact.h>
#include <contact/sum.h>

#include "../error.h"
#include "contact_internal.h"
#include "initial.h"

#include <math.h>
#include <string.h>

/* Doubles of memory of a point: the start gap, the gap and the force of the last step; and behind all points: the time of the
 * last step and the work. */
enum { START = 0, GAP = 1, PRESSED = 2, TIME = 0, WORK = 1 };

int ct_initial_shifts(const ct_contact_options *options) { return options->initial == CT_INITIAL_KEEP || options->initial == CT_INITIAL_REMOVE; }

/* Share of the start gap that is left at a time (eq:initial-fade). */
static double left(const ct_contact_options *options, double time)
{
  if (options->initial == CT_INITIAL_KEEP || time <= 0.0) return 1.0;
  return time < options->removal ? 0.5 * (1.0 + cos(3.14159265358979323846 * time / options->removal)) : 0.0;
}

ct_status ct_initial_refuse(const ct_contact *contact, ct_error *error)
{
  ct_penetration found;
  ct_status status = ct_contact_penetration(contact, CT_AT_POINTS, &found);
  if (status != CT_OK || found.inside == 0) return status;
  return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE,
                 "contact: %ld points of its surfaces are inside at the start, the deepest by %g at (%g, %g, %g), face %d of the %s surface; %ld are deeper than the depth %g",
                 (long)found.inside, found.deepest, found.position[0], found.position[1], found.position[2], (int)found.face, found.side == 1 ? "second" : "first",
                 (long)found.buried, contact->depth);
}

/* The start gap of a point: that of the first step; never deeper than where the point has come out to, and 0 once it was outside
 * (eq:initial-shift). */
static double start_gap(const ct_gauss_point *point, const double *memory, double share, int first)
{
  if (point->other < 0 || share == 0.0) return 0.0;
  if (first) return fmin(point->gap, 0.0);
  double s = memory[START];
  // -- Where the point has opened in this step and the one before it stays open (eq:initial-shift)
  double open = fmin(point->gap, memory[GAP]);
  return s < 0.0 && open > s * share ? fmin(open, 0.0) / share : s;
}

void ct_initial_shift(ct_contact *contact, const ct_initial_view *view)
{
  double share = left(&contact->options, view->time), next_share = left(&contact->options, view->time + view->dt);
  const double *memory = view->memory;
  double *next = view->next;
  for (int s = 0; s < contact->sides; s++)
    for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]); i++, memory += view->stride, next += view->stride) {
      ct_gauss_point *point = &contact->side[s].points[i];
      double start = start_gap(point, memory, share, view->first), gap = point->gap;
      next[START] = start;
      next[GAP] = point->other < 0 ? 0.0 : gap;
      point->shift = start * share;
      point->closing = start * (next_share - share);
      if (point->shift == 0.0) continue;
      // -- The gap counts from the start gap, and the force with it (eq:initial-shift)
      point->gap = gap - point->shift;
      for (int c = 0; c < 3; c++) point->force[c] *= point->gap < 0.0 ? point->gap / gap : 0.0;
    }
}

double ct_initial_work(const ct_contact *contact, const ct_initial_view *view)
{
  double share = left(&contact->options, view->time), last = left(&contact->options, view->memory_end[TIME]);
  const double *memory = view->memory;
  double *next = view->next;
  int64_t count = 0;
  for (int s = 0; s < contact->sides; s++)
    for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]); i++, memory += view->stride, next += view->stride) {
      const double *f = contact->side[s].points[i].force;
      next[PRESSED] = sqrt((f[0] * f[0] + f[1] * f[1]) + f[2] * f[2]);
      // -- Work of the shift that fades (eq:initial-work)
      contact->terms[count++] = view->first ? 0.0 : 0.5 * (memory[PRESSED] + next[PRESSED]) * (memory[START] * (share - last));
    }
  view->next_end[TIME] = view->time;
  view->next_end[WORK] = view->memory_end[WORK] + ct_sum(contact->terms, count);
  return view->next_end[WORK];
}
