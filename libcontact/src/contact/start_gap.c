/* Surfaces that overlap or have gaps at the start: gaps are measured from their initial values. */
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* Cosine of the largest angle between the normals of two surfaces that face each other, and between
 * these and the gap. */
static const double FACING = 0.70710678118654752;

static int keeps(const ct_start_rule *rule)
{
  return rule->initial_penetration == CT_INITIAL_KEEP ||
         rule->initial_penetration == CT_INITIAL_REMOVE;
}

int ct_start_gap_counts(const ct_start_rule *rule) { return keeps(rule) || rule->adjust != 0.0; }

ct_status ct_start_gap_check(const ct_start_rule *rule, const char *label, ct_error *error)
{
  const ct_initial initial = rule->initial_penetration;
  if (initial < CT_INITIAL_FORCE || initial > CT_INITIAL_REMOVE)
    return CT_REFUSE(error, "%s: there is no initial penetration %d", label, (int)initial);
  if (initial == CT_INITIAL_REMOVE && !(rule->removal_time > 0.0 && isfinite(rule->removal_time)))
    return CT_REFUSE(error,
                     "%s: to remove the initial penetration, removal_time must be positive and "
                     "finite, not %g",
                     label, rule->removal_time);
  if (!(rule->adjust >= 0.0) || !isfinite(rule->adjust))
    return CT_REFUSE(error, "%s: adjust must be 0 or positive and finite, not %g", label,
                     rule->adjust);
  return CT_OK;
}

/* Fraction of the start gaps that remains at a time (eq:initial-fade). */
static double left(const ct_start_rule *rule, double time)
{
  if (!ct_start_gap_fades(rule) || time <= 0.0) return 1.0;
  // -- φ = ½ (1 + cos(π t / T)) (eq:initial-fade)
  return time < rule->removal_time
             ? 0.5 * (1.0 + cos(3.14159265358979323846 * time / rule->removal_time))
             : 0.0;
}

ct_status ct_start_gap_refuse(const ct_start_rule *rule, const ct_penetration *found,
                              const char *label, int sides, ct_error *error)
{
  if (found->buried == 0 && found->deepest <= fmax(found->touching, rule->adjust)) return CT_OK;
  return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE,
                 "%s: %ld points of its surface%s are inside at the start, the deepest by %g "
                 "at (%g, %g, %g), face %d of the %ssurface; %ld more are inside that did not come "
                 "from outside",
                 label, (long)(found->inside - found->buried), sides == 1 ? "" : "s",
                 found->deepest, found->position[0], found->position[1], found->position[2],
                 (int)found->face,
                 sides == 1         ? ""
                 : found->side == 1 ? "second "
                                    : "first ",
                 (long)found->buried);
}

/* Whether an outside point and the face over it face each other along the gap (eq:initial-facing).
 */
static int is_facing(const ct_side *side, int64_t i)
{
  const ct_point *point = &side->points[i];
  const double *n = point->outward, *d = point->d;
  double own[3];
  ct_side_area(side, i, own);
  double least = FACING * sqrt(ct_vector_dot(own, own));
  // -- The normals point at each other, and along the gap (eq:initial-facing)
  return -ct_vector_dot(own, n) >= least * sqrt(ct_vector_dot(n, n)) &&
         ct_vector_dot(own, d) >= least * sqrt(ct_vector_dot(d, d));
}

/* Distance of a touching point along the normal: the error of its closest point is tangential. */
static double touching_gap(const ct_side *side, const ct_point *point)
{
  double length = sqrt(ct_vector_dot(point->outward, point->outward));
  if (fabs(point->row.gap) > CT_CLOSEST_POINT_ERROR * side->search->size || !(length > 0.0))
    return point->row.gap;
  return -ct_vector_dot(point->d, point->outward) / length;
}

/* Start gap of a point over another face, from its distance on the undeformed shape
 * (eq:initial-adjust). */
static double first_gap(const ct_start_rule *rule, double rounding, const ct_side *side, int64_t i)
{
  double gap = touching_gap(side, &side->points[i]);
  if (fabs(gap) <= rounding) return gap;
  // -- Kept, adjusted, or none (eq:initial-adjust)
  if (fabs(gap) > rule->adjust) return gap < 0.0 && keeps(rule) ? gap : 0.0;
  return gap < 0.0 || is_facing(side, i) ? gap : 0.0;
}

/* Start gap of a point after the first step: it changes only if the point has no force and no
 * energy, that is, is open in this step and the last one (eq:initial-release). */
static double later_gap(const ct_start_rule *rule, const ct_side *side, double s, double last,
                        double gap, double share)
{
  // -- Released once it has opened for two steps (eq:initial-release)
  double open = fmin(gap, last) - rule->adjust;
  if (s == 0.0 || !(open > s * share + ct_side_unsure(side))) return s;
  return s < 0.0 ? fmin(open, 0.0) / share : 0.0;
}

void ct_start_gap_begin(const ct_start_rule *rule, ct_side *sides, int count)
{
  double rounding = ct_side_rounding(sides, count);
  for (int s = 0; s < count; s++) {
    sides[s].shifted = 1;
    for (ct_span run = {0}; ct_side_next(&sides[s], &run);)
      for (int64_t i = run.first; i < run.end; i++) {
        ct_point *point = &sides[s].points[i];
        point->start = isnan(point->row.gap) ? 0.0 : first_gap(rule, rounding, &sides[s], i);
      }
  }
}

/* The present start gap of a point, and its growth in the last step, of which the shares `at` and
 * `last` are left. */
static void shift_point(const ct_start_rule *rule, const ct_side *side, int first, double at,
                        double last, ct_point *p)
{
  if (p->other < 0 || !(at > 0.0)) p->start = 0.0;
  else if (!first) p->start = later_gap(rule, side, p->start, p->last_known, p->row.gap, at);
  p->shift = p->start * at;
  // The last part of what fades goes with the start gap itself.
  p->closed = (at > 0.0 ? p->start : p->last_start) * (at - last);
  // -- The gap of a point counts from its start gap; at rest it is 0 (eq:initial-shift)
  p->row.gap -= p->shift;
}

void ct_start_gap_shift(const ct_start_rule *rule, ct_side *sides, int count,
                        const ct_surface_motion *now, double last)
{
  double share = left(rule, now->time), last_share = left(rule, now->first ? now->time : last),
         next_share = left(rule, now->time + now->dt);
  for (ct_side *side = sides; side < sides + count; side++) {
    if (!side->shifted) continue;
    const double nothing = ct_side_unsure(side);
    side->shifted = 0;
    side->closing = next_share - share;
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
        side->shifted |= p->start != 0.0 || p->shift != 0.0 || p->admitted != 0.0;
        p->last_start = p->start;
        // Most points have none, and keep none.
        if (p->start != 0.0) shift_point(rule, side, now->first, share, last_share, p);
        else p->shift = p->closed = 0.0;
        if (fabs(p->row.gap) <= nothing) p->row.gap = 0.0;
      }
  }
}

double ct_start_gap_work(const ct_start_rule *rule, ct_side *sides, int count, double time,
                         double last, double *terms)
{
  double change = left(rule, time) - left(rule, last);
  int64_t some = 0;
  for (int s = 0; s < count; s++)
    for (ct_span run = {0}; ct_side_next(&sides[s], &run);)
      for (int64_t i = run.first; i < run.end; i++) {
        ct_point *p = &sides[s].points[i];
        double force_size = sqrt(ct_vector_dot(p->force, p->force));
        // -- Work of the start gap that fades (eq:initial-work)
        terms[some++] = 0.5 * (p->force_size + force_size) * (p->last_start * change);
        p->force_size = force_size;
      }
  return ct_sum_over(sides[0].pieces, terms, some);
}
