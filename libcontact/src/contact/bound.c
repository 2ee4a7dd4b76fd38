/* The contact's part of the largest ω²: every point taken as active at its nearest face. */
#include "../base/memory.h"
#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* The points of one pass. */
typedef struct pass {
  const ct_contact_fixed *fixed;
  const ct_side *side, *other;
  const ct_search *now; /* the other side with a tree for its present shape */
  const double *places; /* of the points in the last update */
} pass;

/* One point whose partner is searched for. */
typedef struct seeker {
  const pass *pass;
  int32_t face; /* its own */
} seeker;

/* Whether a face cannot be the partner: it shares a node with the point's own. */
static int is_no_partner(void *user, int32_t face)
{
  const seeker *s = user;
  return s->pass->side == s->pass->other && ct_search_adjacent(s->pass->now, s->face, face);
}

/* Where all points were in the last update: the number of the face, from 1, or 0, and ξ. Each piece
 * writes its own points. */
enum { PLACE = 3 };
static void list_places(const ct_side *side, double *places)
{
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++) {
      const ct_point *point = &side->points[i];
      const double place[PLACE] = {(double)point->other + 1.0, point->xi[0], point->xi[1]};
      memcpy(&places[PLACE * i], place, sizeof place);
    }
  ct_pieces_sum(side->pieces, places, PLACE * side->fixed->point_count);
}

/* Face and shape functions on which a point would act: those of the last update, or of the nearest
 * face; -1: there is none. */
static int32_t partner(const pass *p, int64_t i, double N[8])
{
  const double *place = &p->places[PLACE * i];
  if (place[0] >= 1.0) {
    ct_segment_shape(p->now->kind, &place[1], N);
    return (int32_t)place[0] - 1;
  }
  double y[3];
  ct_nearest nearest;
  seeker s = {.pass = p, .face = (int32_t)(i / p->side->fixed->rule.count)};
  ct_side_position(p->side, i, NULL, y);
  ct_search_point(p->now, y, -1, HUGE_VAL, CT_SEARCH_TOLERANCE, is_no_partner, &s, &nearest);
  if (nearest.face < 0) return -1;
  ct_segment_shape(p->now->kind, nearest.xi, N);
  return nearest.face;
}

/* Row sums Σ_gp k |b_i| Σ_j |b_j| of the penalty stiffness of one pass (eq:contact-bound). */
static void add_rows(const pass *p, double *rows, double *other_rows)
{
  const ct_side *side = p->side, *other = p->other;
  for (int64_t i = 0; i < side->fixed->point_count; i++) {
    double N[8], k = p->fixed->law.stiffness * side->fixed->weight[i], sum = 0.0;
    const double *own = side->fixed->N[i % side->fixed->rule.count];
    int32_t face = partner(p, i, N);
    if (face < 0) continue;
    const int per = side->search->per, other_per = other->search->per;
    const int32_t *node = &side->search->faces[i / side->fixed->rule.count * per],
                  *other_node = &other->search->faces[(int64_t)face * other_per];
    for (int a = 0; a < per; a++) sum += fabs(own[a]);
    for (int a = 0; a < other_per; a++) sum += fabs(N[a]);
    // -- k |b_i| Σ |b_j| of one point (eq:contact-bound)
    for (int a = 0; a < per; a++) rows[node[a]] += k * sum * fabs(own[a]);
    for (int a = 0; a < other_per; a++) other_rows[other_node[a]] += k * sum * fabs(N[a]);
  }
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

/* Row sums of both passes, and their largest value over the mass. */
static ct_status find_rows(const ct_contact *contact, ct_masses mass, double *rows[2],
                           double *const places[2], ct_search *const now[2], double *omega2)
{
  const ct_contact_fixed *fixed = contact->fixed;
  const int sides = fixed->gaps.sides;
  for (int s = 0, t = sides - 1; !fixed->gaps.alone && s < sides; s++, t--) {
    const pass p = {fixed, &contact->gaps.side[s], &contact->gaps.side[t], now[t], places[s]};
    add_rows(&p, rows[s], rows[t]);
  }
  if (sides == 2 && fixed->one_array)
    join_rows(&contact->gaps.side[0], &contact->gaps.side[1], rows[0], rows[1]);
  *omega2 = 0.0;
  for (int s = 0; s < sides; s++)
    for (int32_t n = 0; n < now[s]->node_count; n++) {
      double m = ct_mass_at(mass, fixed->gaps.place[s][n]);
      if (!(m > 0.0)) return CT_ERROR_ARGUMENT;
      *omega2 = fmax(*omega2, rows[s][n] / m);
    }
  return CT_OK;
}

ct_status ct_contact_find_springs(const ct_contact *contact, ct_masses mass, double *omega2)
{
  double *rows[2] = {NULL, NULL}, *places[2] = {NULL, NULL};
  ct_search *now[2] = {NULL, NULL};
  ct_status status = CT_OK;
  // Trees are built for the current shape, so that this also works before the first update.
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_search *search = contact->gaps.side[s].search;
    rows[s] = ct_allocate((size_t)search->node_count, sizeof *rows[s]);
    places[s] =
        ct_allocate((size_t)contact->gaps.side[s].fixed->point_count, PLACE * sizeof *places[s]);
    if (places[s] != NULL && contact->filled) list_places(&contact->gaps.side[s], places[s]);
    if (rows[s] == NULL || places[s] == NULL || ct_search_snapshot(search, &now[s]) != CT_OK)
      status = CT_ERROR_MEMORY;
  }
  if (status == CT_OK) status = find_rows(contact, mass, rows, places, now, omega2);
  for (int s = 0; s < 2; s++) {
    ct_release(rows[s]);
    ct_release(places[s]);
    ct_search_free(now[s]);
  }
  return status;
}
