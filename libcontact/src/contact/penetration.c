/* Depth of two surfaces inside each other. */
#include <libcontact/contact_result.h>
#include "../base/error.h"

#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* A place of one surface, and the other surface. */
typedef struct seeker {
  const ct_search *search;
  double own[3]; /* unit normal at the place */
} seeker;

/* Faces that point in the same direction as the place are far sides (eq:far-side). */
static int points_away(void *user, int32_t face)
{
  const seeker *s = user;
  double normal[3];
  return !ct_search_middle_normal(s->search, face, normal) ||
         !(ct_vector_dot(s->own, normal) < 0.5);
}

/* Depth of a place of a side under the other one; negative or NaN if it is not inside. */
static double depth_at(const ct_side *side, const ct_search *other, int32_t face,
                       const double xi[2], double y[3])
{
  double N[8], normal[3];
  seeker s = {.search = other};
  ct_face mine;
  ct_nearest nearest;
  ct_segment_shape(side->search->kind, xi, N);
  ct_side_interpolate(side->search, side->search->x, face, N, NULL, y);
  ct_search_face(side->search, face, &mine);
  if (ct_segment_normal(&mine, xi, s.own) != CT_OK) return NAN;
  // The nearest face tells whether the place is inside; if it is a far side, the nearest other face
  // gives the depth.
  for (int k = 0; k < 2; k++) {
    ct_search_point(other, y, -1, HUGE_VAL, CT_SEARCH_TOLERANCE, k == 0 ? NULL : points_away, &s,
                    &nearest);
    if (nearest.face < 0 || !(nearest.signed_distance < 0.0)) return NAN;
    if (ct_vector_dot(s.own, nearest.normal) < 0.5) break;
  }
  if (!ct_search_normal(other, nearest.face, nearest.where, nearest.index, nearest.xi,
                        nearest.normal, normal))
    return NAN;
  return -nearest.signed_distance;
}

static void take(ct_penetration *out, double depth, int32_t side, int32_t face, const double y[3])
{
  out->inside++;
  if (!(depth > out->deepest)) return;
  out->deepest = depth;
  out->side = side;
  out->face = face;
  memcpy(out->position, y, sizeof out->position);
}

/* At the points of some sides. */
static void at_points(const ct_side *sides, int count, ct_penetration *out)
{
  for (int s = 0; s < count; s++) {
    const ct_side *side = &sides[s];
    for (int64_t i = 0; i < side->fixed->point_count; i++) {
      const int faceless = side->fixed->rule.count == 0; // a station
      int32_t face = faceless ? side->points[i].other : (int32_t)(i / side->fixed->rule.count);
      double y[3];
      out->buried += side->points[i].status == CT_POINT_BURIED;
      out->inside += side->points[i].status == CT_POINT_BURIED;
      double distance = ct_point_distance(&side->points[i]);
      if (side->points[i].other < 0 || !(distance < 0.0)) continue;
      if (faceless)
        ct_side_interpolate(side->search, side->search->x, face, side->points[i].N, NULL, y);
      else ct_side_position(side, i, NULL, y);
      take(out, -distance, faceless ? 0 : s, face, y);
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

/* What the depth of a place of a side is measured under: another surface, or an obstacle. */
typedef struct under {
  const ct_search *surface;
  const ct_obstacle_state *obstacle; /* or null */
} under;

static double depth_in(const under *what, const ct_side *side, int32_t face, const double xi[2],
                       double y[3])
{
  double N[8], normal[3];
  if (what->obstacle == NULL) return depth_at(side, what->surface, face, xi, y);
  ct_segment_shape(side->search->kind, xi, N);
  ct_side_interpolate(side->search, side->search->x, face, N, NULL, y);
  return -ct_obstacle_distance(what->obstacle, y, normal);
}

/* At corners or on edges of side `s`: `edges` is 2 or 1. A place deeper than `limit` is on a far
 * side. */
static void at_edges(const ct_side *side, int s, const under *what, int edges, double limit,
                     ct_penetration *out)
{
  ct_rule rule;
  (void)ct_rule_lobatto(side->search->kind, &rule);
  for (int32_t face = 0; face < side->search->face_count; face++)
    for (int q = 0; q < rule.count; q++) {
      double y[3];
      if (edges_at(side->search->kind, rule.xi[q]) != edges) continue;
      double depth = depth_in(what, side, face, rule.xi[q], y);
      if (depth > 0.0 && depth <= limit) take(out, depth, s, face, y);
    }
}

/* Depth up to which surfaces count as touching: the rounding of coordinates, and 1e-9 of a face. */
static double touching(const ct_side *sides, int count)
{
  double size = fmax(sides[0].search->size, sides[count - 1].search->size);
  return fmax(1e-9 * size, ct_side_rounding(sides, count));
}

/* Penetration at the points of some sides, or none yet at other places. Returns 0 for an unknown
 * place. */
static int begin(const ct_side *sides, int count, ct_penetration_at at, ct_penetration *out)
{
  *out = (ct_penetration){0, 0, 0.0, -1, -1, {NAN, NAN, NAN}, touching(sides, count), 0, 0.0};
  if (at == CT_AT_POINTS) at_points(sides, count, out);
  return at == CT_AT_POINTS || at == CT_AT_CORNERS || at == CT_AT_EDGES;
}

static ct_status no_place(ct_penetration_at at, ct_error *error)
{
  return CT_REFUSE(error, "penetration: unknown place %d", (int)at);
}

ct_status ct_contact_penetration(const ct_contact *contact, ct_penetration_at at,
                                 ct_penetration *out, ct_error *error)
{
  ct_penetration points;
  if (contact == NULL || out == NULL) return CT_REFUSE(error, "contact: null argument");
  if (!begin(contact->gaps.side, contact->fixed->gaps.sides, at, out)) return no_place(at, error);
  const int sides = contact->fixed->gaps.sides;
  if (at == CT_AT_POINTS) {
    out->late = contact->admission.late;
    out->late_depth = contact->admission.late_depth;
    return CT_OK;
  }
  if (sides == 1)
    return ct_fail(
        error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
        "contact: a surface in contact with itself has no penetration at corners or edges");
  // A place deeper than any point in contact and than the search distance is on a far side.
  (void)begin(contact->gaps.side, sides, CT_AT_POINTS, &points);
  double limit = fmax(contact->fixed->gaps.depth, 2.0 * points.deepest);
  ct_search *now[2] = {NULL, NULL};
  ct_status status = CT_OK;
  for (int s = 0; status == CT_OK && s < sides; s++)
    status = ct_search_snapshot(contact->gaps.side[s].search, &now[s]);
  for (int s = 0; status == CT_OK && s < sides; s++)
    at_edges(&contact->gaps.side[s], s, &(under){now[sides - 1 - s], NULL},
             at == CT_AT_CORNERS ? 2 : 1, limit, out);
  ct_search_free(now[0]);
  ct_search_free(now[1]);
  return status == CT_OK ? CT_OK : CT_NO_MEMORY(error, "the search for penetration");
}

ct_status ct_obstacle_depth(const ct_obstacle_state *obstacle, ct_penetration_at at,
                            ct_penetration *out, ct_error *error)
{
  if (out == NULL) return CT_REFUSE(error, "obstacle: null argument");
  if (!begin(obstacle->side, obstacle->sides, at, out)) return no_place(at, error);
  if (at == CT_AT_POINTS) {
    out->late = obstacle->admission.late;
    out->late_depth = obstacle->admission.late_depth;
  } else
    at_edges(obstacle->side, 0, &(under){NULL, obstacle}, at == CT_AT_CORNERS ? 2 : 1, HUGE_VAL,
             out);
  return CT_OK;
}
