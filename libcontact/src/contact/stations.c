/* Obstacles that are smaller than the faces of a surface: the closest places of the surface to the
 * obstacle's centre or axis, as points beside those of the faces. */
#include "obstacle.h"

#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* Largest number of stations on an axis. */
enum { MOST_STATIONS = 1024 };

ct_status ct_stations_init(ct_obstacle *obstacle, ct_error *error)
{
  const ct_obstacle_def *o = &obstacle->given;
  const ct_obstacle_kind *kind = obstacle->kind;
  ct_gaps_fixed *gaps = &obstacle->contact.gaps;
  const ct_side_fixed *surface = &gaps->side[0];
  const ct_search *search = surface->search;
  double narrowest, diagonal = 0.0;
  gaps->approach = kind->is_round ? 0.75 * o->radius : INFINITY;
  // -- A large obstacle can't pass between the points of the faces (eq:station-needed)
  if (!kind->is_round || !(o->radius < 1.5 * sqrt(0.5) * search->size)) return CT_OK;
  if (ct_tunnelling_surface(search, &narrowest, &gaps->approach) != CT_OK)
    return CT_NO_MEMORY(error, "an obstacle");
  ct_bounds box;
  ct_tunnelling_box(search, NULL, search->x, &box);
  for (int c = 0; c < 3; c++) diagonal = hypot(diagonal, box.high[c] - box.low[c]);
  // The same bits however the faces are numbered.
  obstacle->station_area = ct_sum(surface->weight, surface->point_count) / search->face_count;
  gaps->side[1] = (ct_side_fixed){.kind = CT_SIDE_STATIONS, .point_count = 1};
  gaps->sides = 2;
  // -- Half a width apart, over one and a half times the size of the surface (eq:station-axis)
  if (kind->direction != NULL) {
    obstacle->station_spacing = fmax(0.5 * narrowest, 1.5 * diagonal / (MOST_STATIONS - 4));
    // An odd number: one is at the mean, whatever the diagonal, which depends on how all is turned.
    gaps->side[1].point_count = 1 + 2 * (int64_t)ceil(0.75 * diagonal / obstacle->station_spacing);
  }
  gaps->point_count += gaps->side[1].point_count;
  return CT_OK;
}

double ct_stations_springs(const ct_obstacle *obstacle)
{
  const ct_gaps_fixed *gaps = &obstacle->contact.gaps;
  const ct_search *search = gaps->side[0].search;
  const double spacing = obstacle->station_spacing,
               near = spacing > 0.0 ? 2.0 + search->size / spacing : 1.0;
  const double shares = search->per > search->edges ? 3.0 : 1.0;
  if (gaps->sides == 1) return 0.0;
  // -- All stations near one node (eq:station-bound)
  return shares * obstacle->given.epsilon * obstacle->station_area *
         fmin(near, (double)gaps->side[1].point_count);
}

ct_status ct_stations_open(ct_contact *contact)
{
  const ct_gaps_fixed *gaps = contact->gaps.fixed;
  ct_side *own = &contact->gaps.side[1];
  if (gaps->sides == 1) return CT_OK;
  own->fixed = &gaps->side[1];
  own->search = contact->gaps.side[0].search;
  own->points = ct_allocate((size_t)own->fixed->point_count, sizeof *own->points);
  if (own->points == NULL || ct_search_equip(own->search) != CT_OK) return CT_ERROR_MEMORY;
  for (ct_point *p = own->points; p < own->points + own->fixed->point_count; p++) {
    p->row = contact->fixed->law;
    p->row.own_count = own->search->per;
    p->row.own_shape = p->N;
    p->row.stiffness = p->row.stiffness * ct_obstacle_of(contact)->station_area;
  }
  return CT_OK;
}

/* A station: its place on the axis, and the place of the surface where it was in the last step. */
typedef struct station {
  const ct_contact *contact;
  const ct_search *search;
  double c[3];
  int has_last;
  double last[3]; /* unit normal */
} station;

/* Faces on the far side, relative to the last place (eq:far-side). */
static int is_far(void *user, int32_t face)
{
  const station *s = user;
  double normal[3];
  return !ct_search_middle_normal(s->search, face, normal) || ct_vector_dot(s->last, normal) < -0.5;
}

/* The closest place of the surface to a station, the vector r to it, and the outward normal there.
 * Returns 0 if it has no side. */
static int find(const station *s, ct_search_skip *skip, ct_nearest *found, double r[3],
                double normal[3])
{
  ct_search_point(s->search, s->c, -1, HUGE_VAL, CT_SEARCH_TOLERANCE, skip, (void *)s, found);
  if (found->face < 0 || !ct_search_normal(s->search, found->face, found->where, found->index,
                                           found->xi, found->normal, normal))
    return 0;
  double length = sqrt(ct_vector_dot(normal, normal));
  for (int c = 0; c < 3; c++) normal[c] /= length, r[c] = found->point[c] - s->c[c];
  return length > 0.0;
}

/* The signed distance of a station from its closest place, positive outside, and the direction of
 * the force there: out of the obstacle. */
static double measure(const station *s, const double r[3], const double normal[3], double n[3])
{
  const double length = sqrt(ct_vector_dot(r, r));
  const int inside = ct_vector_dot(r, normal) > 0.0;
  for (int c = 0; c < 3; c++)
    // -- To the place, or away from it if the station is inside; on the surface against its normal,
    // which is the limit from both sides (eq:station-gap)
    n[c] = !(length > 1e-9 * s->search->size) ? -normal[c]
           : inside                           ? -r[c] / length
                                              : r[c] / length;
  return inside ? -length : length;
}

/* No row in this step, and no place. */
static void lose(ct_point *p, ct_point_status status)
{
  p->other = -1;
  p->xi[0] = p->xi[1] = 0.0;
  p->status = status;
  p->last_known = p->known;
  p->row.gap = p->known = NAN;
}

/* Store the place found. */
static void keep(const station *s, ct_point *p, const ct_nearest *found, double gap,
                 const double n[3])
{
  p->other = found->face;
  memcpy(p->xi, found->xi, sizeof p->xi);
  memset(p->N, 0, sizeof p->N);
  ct_segment_shape(s->search->kind, found->xi, p->N);
  p->row.own = ct_side_row_nodes(s->contact->gaps.side[0].fixed, found->face);
  p->along = NAN;
  p->last_known = p->known;
  p->known = gap;
  p->row.gap = ct_side_gap(&s->contact->gaps.side[1], gap);
  for (int c = 0; c < 3; c++) p->outward[c] = p->row.normal[c] = n[c], p->d[c] = -gap * n[c];
}

/* Gap of one station. A gap changes at most by `motion` in a step. */
static void meet(station *s, double motion, int first, ct_point *p)
{
  ct_nearest found;
  double r[3], normal[3], n[3];
  const double known = p->known;
  const int held = p->status == CT_POINT_INSIDE, was = p->other >= 0;
  int there = find(s, held && s->has_last ? is_far : NULL, &found, r, normal);
  // A station that came from outside is not under the far side of a thin body (eq:far-side)
  if (there && !held && s->has_last && ct_vector_dot(r, normal) > 0.0 &&
      ct_vector_dot(s->last, normal) < -0.5)
    there = find(s, is_far, &found, r, normal);
  if (!there) {
    lose(p, p->status == CT_POINT_BURIED ? CT_POINT_BURIED : CT_POINT_NEW);
    return;
  }
  const double distance = measure(s, r, normal, n);
  if (distance < 0.0 && !first && !was) {
    lose(p, CT_POINT_BURIED);
    return;
  }
  const double gap = distance - ct_obstacle_of(s->contact)->given.radius;
  keep(s, p, &found, gap, n);
  p->status = distance < 0.0 ? CT_POINT_INSIDE : CT_POINT_OUTSIDE;
  // -- A gap that the motion does not explain (eq:admitted)
  if (!first && gap < 0.0 && (!was || !(fabs(gap - known) <= motion))) p->jumped = CT_POINT_JUMPED;
}

/* Positions along the axis: about the mean of the surface's nodes (eq:station-axis). */
static double middle_of(const ct_contact *contact)
{
  const ct_search *search = contact->gaps.side[0].search;
  double r[3];
  for (int64_t i = 0; i < search->node_count; i++) {
    for (int c = 0; c < 3; c++) r[c] = search->x[3 * i + c] - contact->place[c];
    contact->terms[i] = ct_vector_dot(r, contact->direction);
  }
  return ct_sum(contact->terms, search->node_count) / search->node_count;
}

void ct_stations_meet(ct_contact *contact, double motion, int first)
{
  const ct_obstacle *data = ct_obstacle_of(contact);
  ct_side *own = &contact->gaps.side[1];
  ct_search *search = own->search;
  const int64_t count = own->fixed->point_count;
  const double middle = data->station_spacing > 0.0 ? middle_of(contact) : 0.0;
  ct_bounds box;
  ct_span run = {0};
  int fitted = 0;
  if (!ct_side_next(own, &run)) return;
  ct_tunnelling_box(search, NULL, search->x, &box);
  for (int64_t i = 0; i < count; i++) {
    ct_point *p = &own->points[i];
    station now = {.contact = contact, .search = search};
    const double along = middle + ((double)i - 0.5 * (double)(count - 1)) * data->station_spacing;
    for (int c = 0; c < 3; c++) now.c[c] = contact->place[c] + along * contact->direction[c];
    p->jumped = CT_POINT_NO_JUMP;
    if (ct_bounds_distance(&box, now.c) > data->given.radius + search->size + contact->reach) {
      lose(p, CT_POINT_NEW);
      continue;
    }
    if (!fitted) ct_search_box(search), ct_search_refit(search), fitted = 1;
    ct_face face;
    if (p->other >= 0) {
      ct_search_face(search, p->other, &face);
      now.has_last = ct_segment_normal(&face, p->xi, now.last) == CT_OK;
    }
    meet(&now, motion, first, p);
  }
}
