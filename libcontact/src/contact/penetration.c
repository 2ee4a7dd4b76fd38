/* Depth of two surfaces inside each other. */
#include <libcontact/contact_result.h>
#include "../base/error.h"

#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

static void take(ct_penetration *out, double depth, int32_t side, int32_t face, const double y[3])
{
  out->inside++;
  if (!(depth > out->deepest)) return;
  out->deepest = depth;
  out->side = side;
  out->face = face;
  memcpy(out->position, y, sizeof out->position);
}

/* At the points of all sides. */
static void at_points(const ct_gaps *gaps, ct_penetration *out)
{
  for (int s = 0; s < gaps->fixed->sides; s++) {
    const ct_side *side = &gaps->side[s];
    for (int64_t i = 0; i < side->fixed->point_count; i++) {
      const ct_point *point = &side->points[i];
      double y[3], distance = ct_point_distance(point);
      out->buried += point->status == CT_POINT_BURIED;
      out->inside += point->status == CT_POINT_BURIED;
      if (point->other < 0 || !(distance < 0.0)) continue;
      const int32_t face = ct_side_face(side, i);
      ct_side_interpolate(side->search, side->search->x, face, point->row.own_shape, NULL, y);
      take(out, -distance, ct_gaps_surface(gaps->fixed, s), face, y);
    }
  }
}

/* Number of edges of its face on which a point of the Lobatto rule lies: 2 at a corner, 1 on an
 * edge, 0 at the centre. */
static int edges_at(ct_face_kind kind, const double xi[2])
{
  if (kind == CT_T3 || kind == CT_T6)
    return (xi[0] == 0.0) + (xi[1] == 0.0) + (xi[0] + xi[1] == 1.0);
  return (fabs(xi[0]) == 1.0) + (fabs(xi[1]) == 1.0);
}

/* Depth of a place of side `s` under the partner; `now` are the surfaces with trees for their
 * present shapes. */
static double depth_in(const ct_contact *contact, ct_search *const now[2], int s, int32_t face,
                       const double xi[2], double y[3])
{
  const ct_side *side = &contact->gaps.side[s];
  double N[8], r[3], normal[3];
  if (!ct_contact_is_rigid(contact->fixed)) return ct_side_depth(side, now[1 - s], face, xi, y);
  ct_segment_shape(side->search->kind, xi, N);
  ct_side_interpolate(side->search, side->search->x, face, N, NULL, y);
  for (int c = 0; c < 3; c++) r[c] = y[c] - contact->place[c];
  return -contact->fixed->partner->distance(contact, r, normal);
}

/* At corners or on edges of surface `s`: `edges` is 2 or 1. A place deeper than `limit` is on a far
 * side. */
static void at_edges(const ct_contact *contact, ct_search *const now[2], int s, int edges,
                     double limit, ct_penetration *out)
{
  const ct_search *search = contact->gaps.side[s].search;
  ct_rule rule;
  (void)ct_rule_lobatto(search->kind, &rule);
  for (int32_t face = 0; face < search->face_count; face++)
    for (int q = 0; q < rule.count; q++) {
      double y[3];
      if (edges_at(search->kind, rule.xi[q]) != edges) continue;
      double depth = depth_in(contact, now, s, face, rule.xi[q], y);
      if (depth > 0.0 && depth <= limit) take(out, depth, s, face, y);
    }
}

/* Depth up to which surfaces count as touching: the rounding of coordinates, and 1e-9 of a face. */
static double touching(const ct_gaps *gaps)
{
  const ct_side *sides = gaps->side;
  const int count = gaps->fixed->sides;
  double size = fmax(sides[0].search->size, sides[count - 1].search->size);
  return fmax(1e-9 * size, ct_side_rounding(sides, count));
}

ct_status ct_contact_penetration(const ct_contact *contact, ct_penetration_at at,
                                 ct_penetration *out, ct_error *error)
{
  ct_penetration points = {0, 0, 0.0, -1, -1, {NAN, NAN, NAN}, 0.0, 0, 0.0};
  if (contact == NULL || out == NULL) return CT_REFUSE_NULL(error);
  const ct_gaps_fixed *fixed = contact->gaps.fixed;
  const int rigid = ct_contact_is_rigid(contact->fixed), surfaces = ct_gaps_surfaces(fixed);
  if (at != CT_AT_POINTS && at != CT_AT_CORNERS && at != CT_AT_EDGES)
    return CT_REFUSE(error, "penetration: unknown place %d", (int)at);
  points.touching = touching(&contact->gaps);
  *out = points;
  if (at == CT_AT_POINTS) {
    at_points(&contact->gaps, out);
    out->late = (int64_t)contact->record.admission.late;
    out->late_depth = contact->record.admission.late_depth;
    return CT_OK;
  }
  if (surfaces == 1 && !rigid)
    return ct_fail(
        error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
        "contact: a surface in contact with itself has no penetration at corners or edges");
  // A place deeper than any point in contact and than the search distance is on a far side.
  at_points(&contact->gaps, &points);
  double limit = rigid ? HUGE_VAL : fmax(fixed->depth, 2.0 * points.deepest);
  ct_search *now[2] = {NULL, NULL};
  ct_status status = CT_OK;
  for (int s = 0; status == CT_OK && !rigid && s < surfaces; s++)
    status = ct_search_snapshot(contact->gaps.side[s].search, &now[s]);
  for (int s = 0; status == CT_OK && s < surfaces; s++)
    at_edges(contact, now, s, at == CT_AT_CORNERS ? 2 : 1, limit, out);
  ct_search_free(now[0]);
  ct_search_free(now[1]);
  return status == CT_OK ? CT_OK : CT_NO_MEMORY(error, "the search for penetration");
}
