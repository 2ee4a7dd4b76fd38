/* The contact's part of the largest ω²: every point taken as active at its nearest face, or for
 * friction the points that face the other surface where the two touch. */
#include "../base/memory.h"
#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* The points that are taken as active: those within the search distance that face the other
 * surface; all that face it; or all. */
typedef enum reach { NEAR, FACING, EVERY } reach;

/* The points of one pass. */
typedef struct pass {
  const ct_contact_fixed *fixed;
  const ct_side *side, *other;
  const ct_search *now; /* the other side with a tree for its present shape */
  reach reach;
  const double *places; /* of the points in the last update */
  double shift[3];      /* motion of the points that brings the surfaces into touch */
} pass;

/* One point whose partner is searched for: its face, and the normal there, of any length. */
typedef struct seeker {
  const pass *pass;
  int32_t face;
  double own[3];
} seeker;

/* Cosine of the angle between two vectors; NaN if one of them is zero. */
static double cosine(const double a[3], const double b[3])
{
  return ct_vector_dot(a, b) / sqrt(ct_vector_dot(a, a) * ct_vector_dot(b, b));
}

/* Whether a face cannot be the partner: it shares a node with the point's own, or does not face it.
 */
static int is_no_partner(void *user, int32_t face)
{
  const seeker *s = user;
  const ct_search *now = s->pass->now;
  double normal[3];
  if (s->pass->side == s->pass->other && ct_search_adjacent(now, s->face, face)) return 1;
  if (s->pass->reach == EVERY) return 0;
  return !ct_search_middle_normal(now, face, normal) || !ct_friction_facing(s->own, normal);
}

/* Whether the closest point lies within 60° of the normal of the point's face, in front of it or,
 * for two surfaces, behind it: not beside it, as for points beyond the rim of the other surface. */
static int is_across(const seeker *s, const double d[3])
{
  double along = cosine(s->own, d);
  if (s->pass->side != s->pass->other) along = fabs(along);
  return ct_vector_dot(d, d) == 0.0 || along >= 0.5; // (eq:friction-facing)
}

/* Where all points were in the last update: the number of the face, from 1, or 0; the status; and
 * ξ. Each piece writes its own points. */
enum { PLACE = 4 };
static void list_places(const ct_side *side, double *places)
{
  for (int64_t i = 0; i < side->fixed->point_count; i++) {
    const ct_point *point = &side->points[i];
    const double place[PLACE] = {(double)point->other + 1.0, point->status, point->xi[0],
                                 point->xi[1]};
    if (ct_side_owns(side, i)) memcpy(&places[PLACE * i], place, sizeof place);
  }
  ct_pieces_sum(side->pieces, places, PLACE * side->fixed->point_count);
}

/* Face and shape functions on which a point would act: those of the last update, or of the nearest
 * face; -1 if it is not taken as active. */
static int32_t partner(const pass *p, int64_t i, double N[8])
{
  const double *place = &p->places[PLACE * i];
  if (place[0] >= 1.0 && (p->reach == EVERY || place[1] == (double)CT_POINT_INSIDE)) {
    ct_segment_shape(p->now->kind, &place[2], N);
    return (int32_t)place[0] - 1;
  }
  double y[3], d[3], most = p->reach == NEAR ? p->fixed->gaps.near : HUGE_VAL;
  ct_nearest nearest;
  seeker s = {.pass = p, .face = (int32_t)(i / p->side->fixed->rule.count)};
  ct_side_area(p->side, i, s.own);
  ct_side_position(p->side, i, NULL, y);
  for (int c = 0; c < 3; c++) y[c] += p->shift[c];
  ct_search_point(p->now, y, -1, most * most, CT_SEARCH_TOLERANCE, is_no_partner, &s, &nearest);
  if (nearest.face < 0 || nearest.distance > most) return -1;
  for (int c = 0; c < 3; c++) d[c] = nearest.point[c] - y[c];
  if (p->reach != EVERY && !is_across(&s, d)) return -1;
  ct_segment_shape(p->now->kind, nearest.xi, N);
  return nearest.face;
}

/* Row sums Σ_gp k |b_i| Σ_j |b_j| of the penalty stiffness of one pass (eq:contact-bound). Returns
 * whether any point counts. */
static int add_rows(const pass *p, double *rows, double *other_rows)
{
  const ct_side *side = p->side, *other = p->other;
  int found = 0;
  for (int64_t i = 0; i < side->fixed->point_count; i++) {
    double N[8], k = side->points[i].row.stiffness, sum = 0.0;
    const double *own = side->fixed->N[i % side->fixed->rule.count];
    int32_t face = partner(p, i, N);
    if (face < 0) continue;
    found = 1;
    const int per = side->search->per, other_per = other->search->per;
    const int32_t *node = &side->search->faces[i / side->fixed->rule.count * per],
                  *other_node = &other->search->faces[(int64_t)face * other_per];
    for (int a = 0; a < per; a++) sum += fabs(own[a]);
    for (int a = 0; a < other_per; a++) sum += fabs(N[a]);
    // -- k |b_i| Σ |b_j| of one point (eq:contact-bound)
    for (int a = 0; a < per; a++) rows[node[a]] += k * sum * fabs(own[a]);
    for (int a = 0; a < other_per; a++) other_rows[other_node[a]] += k * sum * fabs(N[a]);
  }
  return found;
}

/* Two surfaces over one array of nodes: a node of both has one row, the sum of both passes. Both
 * lists of nodes ascend. */
static void join_rows(const ct_side *a, const ct_side *b, double *rows_a, double *rows_b)
{
  for (int32_t i = 0, j = 0; i < a->search->node_count && j < b->search->node_count;) {
    int32_t p = a->search->nodes[i], q = b->search->nodes[j];
    if (p == q) rows_a[i] = rows_b[j] = rows_a[i] + rows_b[j];
    i += p <= q;
    j += q <= p;
  }
}

/* Bounding box of a surface. */
static ct_bounds box_of(const ct_search *search)
{
  ct_bounds box = search->boxes[0];
  for (int32_t f = 1; f < search->face_count; f++)
    for (int c = 0; c < 3; c++) {
      box.low[c] = fmin(box.low[c], search->boxes[f].low[c]);
      box.high[c] = fmax(box.high[c], search->boxes[f].high[c]);
    }
  return box;
}

/* Motion of the first surface, along the axis on which the boxes of the two are farthest apart,
 * until they touch; 0 if they overlap (eq:friction-facing). */
static void find_shift(ct_search *const now[2], double shift[3])
{
  const ct_bounds a = box_of(now[0]), b = box_of(now[1]);
  double most = 0.0;
  for (int c = 0; c < 3; c++) {
    double up = b.low[c] - a.high[c], down = a.low[c] - b.high[c];
    if (!(fmax(up, down) > most)) continue;
    most = fmax(up, down);
    shift[0] = shift[1] = shift[2] = 0.0;
    shift[c] = up > down ? up : -down;
  }
}

/* Row sums of both passes, and their largest value over the mass. Returns whether a point counts;
 * -1: a mass is not positive. */
static int find_rows(const ct_contact *contact, ct_masses mass, reach which, double *rows[2],
                     double *const places[2], ct_search *const now[2], double *omega2)
{
  const ct_contact_fixed *fixed = contact->fixed;
  const int sides = fixed->gaps.sides;
  double shift[3] = {0.0, 0.0, 0.0};
  int found = 0;
  if (which == NEAR && sides == 2) find_shift(now, shift);
  for (int s = 0; s < sides; s++) memset(rows[s], 0, (size_t)now[s]->node_count * sizeof *rows[s]);
  for (int s = 0, t = sides - 1; !fixed->gaps.alone && s < sides; s++, t--) {
    pass p = {fixed, &contact->gaps.side[s], &contact->gaps.side[t], now[t], which, places[s],
              {0.0}};
    for (int c = 0; c < 3; c++) p.shift[c] = s == 0 ? shift[c] : -shift[c];
    found |= add_rows(&p, rows[s], rows[t]);
  }
  if (sides == 2 && fixed->one_array)
    join_rows(&contact->gaps.side[0], &contact->gaps.side[1], rows[0], rows[1]);
  *omega2 = 0.0;
  for (int s = 0; s < sides; s++)
    for (int32_t n = 0; n < now[s]->node_count; n++) {
      double m = ct_mass_at(mass, fixed->gaps.place[s][n]);
      if (!(m > 0.0)) return -1;
      *omega2 = fmax(*omega2, rows[s][n] / m);
    }
  return found;
}

ct_status ct_contact_find_springs(const ct_contact *contact, int facing, ct_masses mass,
                                  double *omega2)
{
  // The points of the first reach that has any, up to the last one; a surface without parts that
  // face each other does not touch itself yet.
  const reach first = facing ? NEAR : EVERY,
              last = facing && contact->fixed->gaps.sides == 1 ? FACING : EVERY;
  double *rows[2] = {NULL, NULL}, *places[2] = {NULL, NULL};
  ct_search *now[2] = {NULL, NULL};
  ct_status status = CT_OK;
  // Trees are built for the current shape, so that this also works before the first update.
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_search *search = contact->gaps.side[s].search;
    rows[s] = ct_allocate((size_t)search->node_count, sizeof *rows[s]);
    places[s] =
        ct_allocate((size_t)contact->gaps.side[s].fixed->point_count, PLACE * sizeof *places[s]);
    if (places[s] != NULL) list_places(&contact->gaps.side[s], places[s]);
    if (rows[s] == NULL || places[s] == NULL || ct_search_snapshot(search, &now[s]) != CT_OK)
      status = CT_ERROR_MEMORY;
  }
  int found = 0;
  for (int r = (int)first; status == CT_OK && found == 0 && r <= (int)last; r++) {
    found = find_rows(contact, mass, (reach)r, rows, places, now, omega2);
    if (found < 0) status = CT_ERROR_ARGUMENT;
  }
  for (int s = 0; s < 2; s++) {
    ct_release(rows[s]);
    ct_release(places[s]);
    ct_search_free(now[s]);
  }
  return status;
}
