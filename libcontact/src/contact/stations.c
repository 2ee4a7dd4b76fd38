/* Obstacles that are smaller than the faces of a surface: the closest places of the surface to the
 * obstacle's centre or axis, as points beside those of the faces. */
#include "contact_internal.h"

#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* Largest number of stations on an axis. */
enum { MOST_STATIONS = 1024 };

void ct_stations_clear(ct_stations *stations) { ct_side_fixed_clear(&stations->fixed); }

ct_status ct_stations_init(ct_stations *stations, const ct_obstacle_def *o,
                           const ct_side_fixed *surface, ct_error *error)
{
  const ct_search *search = surface->search;
  double narrowest, area = 0.0, diagonal = 0.0;
  memset(stations, 0, sizeof *stations);
  stations->approach = o->shape == CT_OBSTACLE_PLANE ? INFINITY : 0.75 * o->radius;
  // -- A large obstacle can't pass between the points of the faces (eq:station-needed)
  if (!(o->radius < 1.5 * sqrt(0.5) * search->size) || o->shape == CT_OBSTACLE_PLANE) return CT_OK;
  if (ct_tunnelling_surface(search, &narrowest, &stations->approach) != CT_OK)
    return CT_NO_MEMORY(error, "an obstacle");
  ct_bounds box;
  ct_tunnelling_box(search, NULL, search->x, &box);
  for (int c = 0; c < 3; c++) diagonal = hypot(diagonal, box.high[c] - box.low[c]);
  for (int64_t i = 0; i < surface->point_count; i++) area += surface->weight[i];
  stations->area = area / search->face_count;
  stations->fixed.point_count = 1;
  if (o->shape == CT_OBSTACLE_SPHERE) return CT_OK;
  // -- Half a width apart, over one and a half times the size of the surface (eq:station-axis)
  stations->spacing = fmax(0.5 * narrowest, 1.5 * diagonal / MOST_STATIONS);
  stations->fixed.point_count = 1 + (int64_t)ceil(1.5 * diagonal / stations->spacing);
  return CT_OK;
}

double ct_stations_springs(const ct_stations *stations, const ct_search *search, double epsilon)
{
  const double near = stations->spacing > 0.0 ? 2.0 + search->size / stations->spacing : 1.0;
  const double shares = search->per > search->edges ? 3.0 : 1.0;
  // -- All stations near one node (eq:station-bound)
  return shares * epsilon * stations->area * fmin(near, (double)stations->fixed.point_count);
}

ct_status ct_stations_open(ct_obstacle_state *s, const ct_stations *stations,
                           const ct_constraint *law)
{
  ct_side *surface = &s->side[0], *own = &s->side[1];
  s->stations = stations;
  s->sides = stations->fixed.point_count > 0 ? 2 : 1;
  if (s->given->shape == CT_OBSTACLE_PLANE) return CT_OK;
  surface->moved = ct_allocate((size_t)surface->search->node_count, 3 * sizeof *surface->moved);
  if (surface->moved == NULL) return CT_ERROR_MEMORY;
  if (s->sides == 1) return CT_OK;
  own->fixed = &stations->fixed;
  own->search = surface->search;
  own->points = ct_allocate((size_t)own->fixed->point_count, sizeof *own->points);
  if (own->points == NULL || ct_search_equip(surface->search) != CT_OK) return CT_ERROR_MEMORY;
  for (ct_point *p = own->points; p < own->points + own->fixed->point_count; p++) {
    p->row = *law;
    p->row.own_count = surface->search->per;
    p->row.own_shape = p->N;
    p->row.stiffness = law->stiffness * stations->area;
  }
  ct_stations_forget(s);
  return CT_OK;
}

void ct_stations_forget(ct_obstacle_state *s)
{
  for (int64_t i = 0; s->sides == 2 && i < s->stations->fixed.point_count; i++) {
    ct_point *p = &s->side[1].points[i];
    p->other = -1;
    p->status = CT_POINT_NEW;
    p->known = NAN;
    p->row.force = p->force_size = p->admitted = p->stored = 0.0;
  }
}

/* A station: its place on the axis, and the place of the surface where it was in the last step. */
typedef struct station {
  const ct_obstacle_state *obstacle;
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
  p->status = status;
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
  p->row.own = ct_side_row_nodes(s->obstacle->side[0].fixed, found->face);
  p->row.gap = p->known = gap;
  for (int c = 0; c < 3; c++) p->outward[c] = n[c], p->d[c] = -gap * n[c];
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
  const double gap = distance - s->obstacle->given->radius;
  keep(s, p, &found, gap, n);
  p->status = distance < 0.0 ? CT_POINT_INSIDE : CT_POINT_OUTSIDE;
  // -- A gap that the motion does not explain (eq:admitted)
  p->jumped = !first && gap < 0.0 && (!was || !(fabs(gap - known) <= motion));
}

/* Positions along the axis: about the mean of the surface's nodes (eq:station-axis). */
static double middle_of(const ct_obstacle_state *s)
{
  const ct_search *search = s->side[0].search;
  double r[3];
  for (int64_t i = 0; i < search->node_count; i++) {
    for (int c = 0; c < 3; c++) r[c] = search->x[3 * i + c] - s->place[c];
    s->terms[i] = ct_vector_dot(r, s->given->axis);
  }
  return ct_sum(s->terms, search->node_count) / search->node_count;
}

void ct_stations_meet(ct_obstacle_state *s, double reach, double motion, int first)
{
  if (s->sides == 1) return;
  const int64_t count = s->stations->fixed.point_count;
  const int sphere = s->given->shape == CT_OBSTACLE_SPHERE;
  const double middle = sphere ? 0.0 : middle_of(s);
  ct_search *search = s->side[0].search;
  ct_bounds box;
  int fitted = 0;
  ct_tunnelling_box(search, NULL, search->x, &box);
  for (int64_t i = 0; i < count; i++) {
    ct_point *p = &s->side[1].points[i];
    station now = {.obstacle = s, .search = search};
    const double along =
        sphere ? 0.0 : middle + ((double)i - 0.5 * (double)(count - 1)) * s->stations->spacing;
    for (int c = 0; c < 3; c++) now.c[c] = s->place[c] + along * s->given->axis[c];
    p->jumped = 0;
    if (ct_bounds_distance(&box, now.c) > s->given->radius + search->size + reach) {
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

/* The largest motion of a node relative to the obstacle since the last step. */
static double relative_motion(const ct_obstacle_state *s, const double *moved,
                              const ct_search *search, int32_t *node)
{
  double top = -1.0;
  for (int32_t i = 0; i < search->node_count; i++) {
    double d[3];
    for (int c = 0; c < 3; c++) d[c] = moved[3 * (int64_t)i + c] - s->came[c];
    if (!(ct_vector_dot(d, d) > top)) continue;
    top = ct_vector_dot(d, d);
    *node = search->nodes[i];
  }
  return sqrt(top);
}

ct_status ct_stations_check(const ct_obstacle_state *s, double time, ct_error *error)
{
  const ct_search *search = s->side[0].search;
  const double approach = s->stations->approach;
  int32_t node = 0;
  if (s->side[0].moved == NULL) return CT_OK;
  const double nearer = relative_motion(s, s->side[0].moved, search, &node);
  if (!(nearer > approach)) return CT_OK;
  // -- An obstacle that is farther away cannot have passed through the surface (eq:tunnelling)
  ct_bounds box;
  double middle[3], n[3], half = 0.0;
  ct_tunnelling_box(search, NULL, search->x, &box);
  for (int c = 0; c < 3; c++) {
    middle[c] = 0.5 * (box.low[c] + box.high[c]);
    half = hypot(half, 0.5 * (box.high[c] - box.low[c]));
  }
  if (ct_obstacle_distance(s, middle, n) - half > nearer + search->size) return CT_OK;
  return ct_fail(error, CT_ERROR_STEP, (ct_place){-1, -1, node},
                 "obstacle: in the step to t = %g a node of its surface has moved by %g relative "
                 "to it, and the two may have passed through each other; not more than %g is safe. "
                 "Take a smaller step",
                 time, nearer, approach);
}
