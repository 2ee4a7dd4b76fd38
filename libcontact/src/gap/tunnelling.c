/* Tunnelling: no surface may pass through another one within a step. */
#include "../base/error.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "gaps.h"

#include <math.h>
#include <string.h>

/* A face whose far side is searched for: its middle and unit normal. */
typedef struct skin {
  const ct_search *search;
  double middle[3], normal[3];
} skin;

static int middle_of(const ct_search *search, int32_t face, double middle[3], double normal[3])
{
  const double *xi = ct_search_middle(search);
  ct_face nodes;
  ct_search_face(search, face, &nodes);
  ct_segment_point(&nodes, xi, middle);
  return ct_segment_normal(&nodes, xi, normal) == CT_OK;
}

/* A face that is not beneath, or does not point in the opposite direction, is not a far side. */
static int is_no_far_side(void *user, int32_t face)
{
  const skin *s = user;
  double middle[3], normal[3], down[3];
  if (!middle_of(s->search, face, middle, normal)) return 1;
  for (int c = 0; c < 3; c++) down[c] = middle[c] - s->middle[c];
  return !(ct_vector_dot(down, s->normal) < 0.0) || !(ct_vector_dot(normal, s->normal) < -0.5);
}

/* Smallest distance of the middle of a face from a far side beneath it, if it is less than `*thin`
 * (eq:tunnelling). */
static ct_status find_thickness(const ct_search *reference, double *thin)
{
  ct_search *search = NULL;
  ct_status status = ct_search_snapshot(reference, &search);
  for (int32_t f = 0; status == CT_OK && f < search->face_count; f++) {
    skin s = {.search = search};
    ct_nearest nearest;
    if (!middle_of(search, f, s.middle, s.normal)) continue;
    ct_search_point(search, s.middle, -1, *thin * *thin, CT_SEARCH_TOLERANCE, is_no_far_side, &s,
                    &nearest);
    if (nearest.face >= 0) *thin = fmin(*thin, nearest.distance);
  }
  ct_search_free(search);
  return status;
}

/* Width of a face: its area over its longest edge, for a triangle its smallest height
 * (eq:contact-near). */
static double width_of(const ct_search *search, int32_t face)
{
  ct_face nodes;
  double longest = 0.0;
  ct_search_face(search, face, &nodes);
  for (int e = 0; e < search->edges; e++) {
    const double *a = nodes.node[e], *b = nodes.node[(e + 1) % search->edges];
    double along[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    longest = fmax(longest, sqrt(ct_vector_dot(along, along)));
  }
  double J = ct_segment_area_element(&nodes, ct_search_middle(search));
  // -- Area over the longest edge; of a triangle, twice that (eq:contact-near)
  return (search->edges == 4 ? 4.0 : 1.0) * J / longest;
}

ct_status ct_tunnelling_surface(const ct_search *search, double *narrowest, double *approach)
{
  *narrowest = INFINITY;
  for (int32_t f = 0; f < search->face_count; f++)
    *narrowest = fmin(*narrowest, width_of(search, f));
  // -- Three quarters of a body's thickness, if that is less (eq:tunnelling)
  double thin = *narrowest / 0.75;
  ct_status status = find_thickness(search, &thin);
  *approach = 0.75 * thin;
  return status;
}

ct_status ct_tunnelling_init(ct_gaps_fixed *fixed, int given, double adjust)
{
  ct_status status = CT_OK;
  double sum = 0.0, count = 0.0;
  fixed->approach = fixed->depth;
  for (int s = 0; s < fixed->sides; s++) {
    const ct_search *search = fixed->side[s].search;
    for (int32_t f = 0; f < search->face_count; f++, count++) {
      double width = width_of(search, f);
      if (!given) fixed->approach = fmin(fixed->approach, width);
      sum += log(width);
    }
  }
  // -- Three quarters of a body's thickness, if that is less (eq:contact-near, eq:tunnelling)
  for (int s = 0; status == CT_OK && s < fixed->sides; s++) {
    double thin = fixed->approach / 0.75;
    status = find_thickness(fixed->side[s].search, &thin);
    fixed->approach = fmin(fixed->approach, 0.75 * thin);
  }
  // Gaps that are closed at the start are found until they have opened by as much again
  // (eq:initial-adjust).
  fixed->near = given ? fixed->depth : fmax(fixed->approach, 2.0 * adjust);
  // -- Half a mean width of the faces (eq:skin-mean)
  fixed->skin = 0.5 * exp(sum / count);
  return status;
}

void ct_tunnelling_box(const ct_search *search, const int32_t *nodes, const double *values,
                       ct_bounds *box)
{
  const int32_t count = search->node_count;
  *box = (ct_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  // Nodes with consecutive numbers are read together.
  for (int32_t n = 0, row; n < count; n += row) {
    ct_bounds some;
    row = nodes == NULL ? count : ct_row_length(&nodes[n], count - n);
    ct_extent(row, &values[3 * (int64_t)(nodes == NULL ? 0 : nodes[n])], NULL, some.low, some.high);
    ct_bounds_join(box, &some);
  }
}

/* Smallest distance of the points of one box from those of the other. */
static double closest(const ct_bounds *a, const ct_bounds *b)
{
  double d[3];
  for (int c = 0; c < 3; c++)
    d[c] = fmax(fmax(a->low[c] - b->high[c], b->low[c] - a->high[c]), 0.0);
  return sqrt(ct_vector_dot(d, d));
}

/* Two surfaces in a step, and the largest approach of two of their faces found so far. */
typedef struct approach {
  const ct_search *search[2];
  const ct_side_fixed *side[2];
  const double *velocity; /* at the nodes of the contact */
  double dt, length;
  double deepest;  /* depth of the deepest point before the step */
  ct_bounds speed; /* box of all velocities of the second surface */
  int self;        /* whether the two are one surface */
  int32_t face[2], node;
} approach;

/* Box of the velocities of a face. */
static ct_bounds speed_of(const approach *p, int s, int32_t face)
{
  const int32_t *node = ct_side_row_nodes(p->side[s], face);
  ct_bounds box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int a = 0; a < p->search[s]->per; a++) {
    for (int c = 0; c < 3; c++) {
      double v = p->velocity[3 * (int64_t)node[a] + c];
      box.low[c] = v < box.low[c] ? v : box.low[c];
      box.high[c] = v > box.high[c] ? v : box.high[c];
    }
  }
  return box;
}

/* Largest relative motion of a node of face `f` and one of face `g`, and the first of the two
 * nodes. */
static double motion_of(const approach *p, int32_t f, int32_t g, int32_t *node)
{
  const ct_search *a = p->search[0], *b = p->search[1];
  const int32_t *n = ct_side_row_nodes(p->side[0], f), *m = ct_side_row_nodes(p->side[1], g);
  double top = -1.0;
  for (int i = 0; i < a->per; i++)
    for (int k = 0; k < b->per; k++) {
      double v[3];
      for (int c = 0; c < 3; c++)
        v[c] = p->velocity[3 * (int64_t)n[i] + c] - p->velocity[3 * (int64_t)m[k] + c];
      double square = ct_vector_dot(v, v);
      if (square > top) top = square, *node = a->nodes[a->faces[(int64_t)f * a->per + i]];
    }
  return p->dt * sqrt(top);
}

/* Two faces, the first with velocities in the box `own`. */
static void compare_faces(approach *p, int32_t f, int32_t g, const ct_bounds *own)
{
  ct_bounds other = speed_of(p, 1, g);
  int32_t node = -1;
  if (!(p->dt * ct_bounds_farthest(own, &other) > p->length) ||
      (p->self && ct_search_adjacent(p->search[0], f, g)))
    return;
  double length = motion_of(p, f, g, &node);
  // -- Faces that are farther apart cannot have passed through each other (eq:tunnelling)
  if (!(length > p->length) || closest(&p->search[0]->boxes[f], &p->search[1]->boxes[g]) >
                                   (length + p->deepest) * (1.0 + 1e-12))
    return;
  p->length = length;
  p->face[0] = f;
  p->face[1] = g;
  p->node = node;
}

/* Find the pair of faces with the largest approach, if it is more than `length`; of equal pairs the
 * one with the lowest numbers. */
static void compare_surfaces(approach *p)
{
  enum { CAPACITY = 512 };
  int32_t list[CAPACITY];
  for (int32_t f = 0; f < p->search[0]->face_count; f++) {
    ct_bounds own = speed_of(p, 0, f);
    double most = p->dt * ct_bounds_farthest(&own, &p->speed);
    if (!(most > p->length)) continue;
    ct_bounds reach = ct_bounds_grown(&p->search[0]->boxes[f], (most + p->deepest) * (1.0 + 1e-12));
    int32_t found = ct_box_tree_overlaps(p->search[1]->tree, p->search[1]->boxes, &reach, list,
                                         CAPACITY),
            count = found > CAPACITY ? p->search[1]->face_count : found;
    for (int32_t i = 0; i < count; i++) compare_faces(p, f, found > CAPACITY ? i : list[i], &own);
  }
}

/* Depth of the deepest point before the step. */
static double deepest(const ct_gaps *gaps)
{
  double depth = 0.0;
  for (int s = 0; s < gaps->fixed->sides; s++)
    for (ct_span run = {0}; ct_side_next(&gaps->side[s], &run);)
      for (int64_t i = run.first; i < run.end; i++)
        depth = fmax(depth, -gaps->side[s].points[i].last_known);
  ct_pieces_largest(gaps->side[0].pieces, &depth, 1);
  return depth;
}

ct_status ct_tunnelling_check(ct_gaps *gaps, const double *velocity, double dt, double time,
                              ct_error *error)
{
  const ct_gaps_fixed *fixed = gaps->fixed;
  const int last = fixed->sides - 1;
  ct_bounds speed[2], place[2];
  ct_search *search[2] = {gaps->side[0].search, gaps->side[last].search};
  for (int s = 0; s < 2; s++)
    ct_tunnelling_box(search[s], fixed->place[s == 0 ? 0 : last], velocity, &speed[s]);
  // -- The largest approach in the step, and how much of it is safe: first of the whole surfaces
  // (eq:tunnelling)
  double most = dt * ct_bounds_farthest(&speed[0], &speed[1]);
  if (!(most > fixed->approach)) return CT_OK;
  for (int s = 0; s < 2; s++) ct_tunnelling_box(search[s], NULL, search[s]->x, &place[s]);
  double deep = deepest(gaps);
  if (closest(&place[0], &place[1]) > (most + deep) * (1.0 + 1e-12)) return CT_OK;
  for (int s = 0; s <= last; s++) {
    ct_search_box(search[s]);
    ct_search_refit(search[s]);
  }
  approach p = {.search = {search[0], search[1]},
                .side = {&fixed->side[0], &fixed->side[last]},
                .velocity = velocity,
                .dt = dt,
                .length = fixed->approach,
                .deepest = deep,
                .speed = speed[1],
                .self = last == 0,
                .node = -1};
  compare_surfaces(&p);
  if (p.node < 0) return CT_OK;
  return ct_fail(
      error, CT_ERROR_STEP, (ct_place){-1, -1, p.node},
      "contact: in the step to t = %g its surfaces (face %d of the first, %d of the second) may "
      "have come nearer by %g and passed through each other; "
      "not more than %g is safe. Take a smaller step",
      time, (int)p.face[0], (int)p.face[1], p.length, fixed->approach);
}
