/* Surfaces that overlap or gape at the start: gaps count from where they begin. */
#include <libcontact/contact.h>
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/vector.h"
#include "contact_internal.h"
#include "initial.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Doubles of memory of a point: the start gap and, where start gaps fade, the force of the last
 * step; then behind all points: the time of the last step and the work. */
enum { START = 0, PRESSED = 1, TIME = 0, WORK = 1 };

/* Cosine of the largest angle between the normals of two surfaces that face each other, and between
 * these and the gap. */
static const double FACING = 0.70710678118654752;

static int keeps(const ct_contact_options *options)
{
  return options->initial == CT_INITIAL_KEEP || options->initial == CT_INITIAL_REMOVE;
}

static int fades(const ct_contact_options *options)
{
  return options->initial == CT_INITIAL_REMOVE;
}

int ct_initial_point_memory(const ct_contact_options *options)
{
  if (!keeps(options) && options->adjust == 0.0) return 0;
  return fades(options) ? 2 : 1;
}

int ct_initial_end_memory(const ct_contact_options *options) { return fades(options) ? 2 : 0; }

/* Fraction of the start gaps that is left at a time (eq:initial-fade). */
static double left(const ct_contact_options *options, double time)
{
  if (!fades(options) || time <= 0.0) return 1.0;
  return time < options->removal
             ? 0.5 * (1.0 + cos(3.14159265358979323846 * time / options->removal))
             : 0.0;
}

ct_status ct_initial_refuse(const ct_contact *contact, ct_error *error)
{
  ct_penetration found;
  ct_status status = ct_contact_penetration(contact, CT_AT_POINTS, &found);
  if (status != CT_OK ||
      (found.buried == 0 && found.deepest <= fmax(found.touching, contact->options.adjust)))
    return status;
  return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE,
                 "contact: %ld points of its surfaces are inside at the start, the deepest by %g "
                 "at (%g, %g, %g), face %d of the %s surface; %ld are deeper than the depth %g",
                 (long)found.inside, found.deepest, found.position[0], found.position[1],
                 found.position[2], (int)found.face, found.side == 1 ? "second" : "first",
                 (long)found.buried, contact->depth);
}

/* Whether a point outside and the face over it look at each other along the gap
 * (eq:initial-facing). */
static int is_facing(const ct_side *side, int64_t i)
{
  const ct_gauss_point *point = &side->points[i];
  const double *n = point->normal, *d = point->d;
  double own[3];
  ct_side_area(side, (int32_t)(i / side->rule.count), (int)(i % side->rule.count), own);
  double least = FACING * sqrt(ct_vector_dot(own, own));
  return -ct_vector_dot(own, n) >= least * sqrt(ct_vector_dot(n, n)) &&
         ct_vector_dot(own, d) >= least * sqrt(ct_vector_dot(d, d));
}

/* How far the distance of a point that rests is off from one step to the next, as its closest point
 * comes from another iteration. */
static double unsure(const ct_side *side) { return 16.0 * DBL_EPSILON * side->search->size; }

/* Distance of a point that touches, along the normal: the error of its closest point is across. */
static double touching_gap(const ct_side *side, const ct_gauss_point *point)
{
  double length = sqrt(ct_vector_dot(point->normal, point->normal));
  if (fabs(point->gap) > CT_CLOSEST_POINT_ERROR * side->search->size || !(length > 0.0))
    return point->gap;
  return -ct_vector_dot(point->d, point->normal) / length;
}

/* Start gap of a point over another face, from its distance on the undeformed shape
 * (eq:initial-adjust). */
static double first_gap(const ct_contact_options *options, double rounding, const ct_side *side,
                        int64_t i)
{
  double gap = touching_gap(side, &side->points[i]);
  if (fabs(gap) <= rounding) return gap;
  if (fabs(gap) > options->adjust) return gap < 0.0 && keeps(options) ? gap : 0.0;
  return gap < 0.0 || is_facing(side, i) ? gap : 0.0;
}

/* Start gap of a point after the first step: it changes only where the point has no force and no
 * energy, open in this step and the one before (eq:initial-release). */
static double later_gap(const ct_contact_options *options, const ct_side *side, double s,
                        double last, double gap, double share)
{
  double open = fmin(gap, last) - options->adjust;
  if (s == 0.0 || !(open > s * share + unsure(side))) return s;
  return s < 0.0 ? fmin(open, 0.0) / share : 0.0;
}

/* Count the gap of a point from its start gap, and its penalty force with it (eq:initial-shift). At
 * rest it is 0. */
static void count_from_start(const ct_contact *contact, const ct_side *side, int64_t i,
                             ct_gauss_point *point)
{
  double n[3], k = 0.5 * contact->options.epsilon * side->weight[i];
  point->gap -= point->shift;
  if (fabs(point->gap) <= unsure(side)) point->gap = 0.0;
  int pressed = point->gap < 0.0 && ct_side_direction(side, point, n);
  for (int c = 0; c < 3; c++) point->force[c] = pressed ? -k * point->gap * n[c] : 0.0;
}

void ct_initial_begin(const ct_contact *contact, const ct_initial_view *view)
{
  double *next = view->next, rounding = ct_contact_rounding(contact);
  for (int s = 0; s < contact->sides; s++)
    for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]); i++, next += view->stride)
      next[START] = contact->side[s].points[i].other < 0
                        ? 0.0
                        : first_gap(&contact->options, rounding, &contact->side[s], i);
}

void ct_initial_shift(ct_contact *contact, const ct_initial_view *view)
{
  double share = left(&contact->options, view->time),
         next_share = left(&contact->options, view->time + view->dt);
  const double *memory = view->memory, *known = view->known;
  double *next = view->next;
  for (int s = 0; s < contact->sides; s++) {
    const ct_side *side = &contact->side[s];
    for (int64_t i = 0; i < ct_side_point_count(side);
         i++, memory += view->stride, known += view->stride, next += view->stride) {
      ct_gauss_point *point = &side->points[i];
      double start = 0.0;
      if (point->other >= 0 && share > 0.0)
        start = view->first
                    ? next[START]
                    : later_gap(&contact->options, side, memory[START], *known, point->gap, share);
      next[START] = start;
      point->shift = start * share;
      point->closing = start * (next_share - share);
      if (point->shift != 0.0 || fabs(point->gap) <= unsure(side))
        count_from_start(contact, side, i, point);
    }
  }
}

double ct_initial_work(const ct_contact *contact, const ct_initial_view *view)
{
  double share = left(&contact->options, view->time),
         last = left(&contact->options, view->memory_end[TIME]);
  const double *memory = view->memory;
  double *next = view->next;
  int64_t count = 0;
  for (int s = 0; s < contact->sides; s++)
    for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]);
         i++, memory += view->stride, next += view->stride) {
      const double *f = contact->side[s].points[i].force;
      next[PRESSED] = sqrt(ct_vector_dot(f, f));
      // -- Work of the start gap that fades (eq:initial-work)
      contact->terms[count++] =
          view->first ? 0.0
                      : 0.5 * (memory[PRESSED] + next[PRESSED]) * (memory[START] * (share - last));
    }
  view->next_end[TIME] = view->time;
  view->next_end[WORK] = view->memory_end[WORK] + ct_sum(contact->terms, count);
  return view->next_end[WORK];
}
