/* Candidate faces of the other surface for each face: lists with a skin. */
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "gaps.h"

#include <math.h>
#include <string.h>

/* The box of the motions of the nodes of a side since the last build of the lists. */
static ct_bounds motions_of(const ct_side *side)
{
  ct_bounds box;
  ct_extent(side->search->node_count, side->search->x, side->x_built, box.low, box.high);
  return box;
}

/* Bound of the motion of two surfaces relative to each other since the last build of the lists; a
 * closer one if it exceeds `most`. A motion that both share, about the middle of the motions of one
 * of them, brings no faces together (eq:skin). */
static double relative_motion(const ct_side *a, const ct_side *b, double most)
{
  const ct_bounds own = motions_of(a), other = a == b ? own : motions_of(b);
  const double bound = ct_bounds_farthest(&own, &other);
  double shared[3];
  if (bound <= most) return bound;
  for (int c = 0; c < 3; c++) shared[c] = 0.5 * (own.low[c] + own.high[c]);
  return fmin(bound, ct_farthest(a->search->node_count, a->search->x, a->x_built, shared) +
                         ct_farthest(b->search->node_count, b->search->x, b->x_built, shared));
}

/* Remove from a list of faces those that share a node with `face`, including itself; returns the
 * remaining number (eq:self-adjacent). */
static int32_t drop_adjacent(const ct_side *side, int32_t face, int32_t *list, int32_t count)
{
  int32_t kept = 0;
  for (int32_t i = 0; i < count; i++)
    if (!ct_search_adjacent(side->search, face, list[i])) list[kept++] = list[i];
  return kept;
}

/* Normal of a linear face, of any length: the product of its diagonals, or of two edges of a
 * triangle. */
CT_INLINE void normal_of(const ct_search *search, int64_t face, double normal[3])
{
  const int32_t *node = &search->faces[face * search->per];
  const double *a = &search->x[3 * (int64_t)node[0]], *b = &search->x[3 * (int64_t)node[1]],
               *c = &search->x[3 * (int64_t)node[2]],
               *d = &search->x[3 * (int64_t)node[search->per - 1]];
  const double u[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]},
               v[3] = {d[0] - b[0], d[1] - b[1], d[2] - b[2]};
  ct_vector_cross(u, v, normal);
}

int ct_gaps_mark_creases(ct_gaps *gaps)
{
  ct_side *side = &gaps->side[0];
  const ct_search *search = side->search;
  int some = 0;
  if (side->creased == NULL) return 0;
  memset(side->creased, 0, (size_t)search->face_count);
  for (ct_span run = {0}; ct_side_next_faces(side, &run);)
    for (int64_t f = run.first; f < run.end; f++) {
      double own[3], other[3];
      normal_of(search, f, own);
      for (int e = 0; e < search->edges; e++) {
        const int32_t across = search->neighbour[f * search->edges + e];
        // The face before this one has seen it.
        if (across < 0 || (across < f && across >= run.first)) continue;
        normal_of(search, across, other);
        const double cosine = ct_vector_dot(own, other);
        // (eq:self-adjacent)
        if (!(cosine < 0.0) ||
            16.0 * cosine * cosine < ct_vector_dot(own, own) * ct_vector_dot(other, other))
          continue;
        some = side->creased[f] = side->creased[across] = 1;
      }
    }
  return some;
}

/* Move the faces whose boxes meet a box to the front of a list; returns their number. */
static int32_t put_first(const ct_search *search, const ct_bounds *box, int32_t *list,
                         int32_t count)
{
  int32_t first = 0;
  for (int32_t i = 0; i < count; i++) {
    const int32_t face = list[i];
    if (ct_bounds_apart(&search->boxes[face], box)) continue;
    list[i] = list[first];
    list[first++] = face;
  }
  return first;
}

/* How far each point of a face is from the boxes of all faces but the one that it met. A face that
 * is not listed is farther than the skin from the whole face (eq:rival-distance). */
static void measure_rivals(ct_side *side, const ct_side *other, int32_t face, double skin)
{
  const int points = side->fixed->rule.count;
  for (int64_t p = (int64_t)face * points; p < (int64_t)(face + 1) * points; p++) {
    double y[3], least = skin * skin;
    side->met[p] = side != other ? side->points[p].other : -1;
    side->distant[p] = 0.0;
    if (side->met[p] < 0) continue;
    ct_side_position(side, p, NULL, y);
    for (int32_t i = side->candidate_first[face]; i < side->near_end[face]; i++) {
      const int32_t rival = side->candidates[i];
      if (rival == side->met[p]) continue;
      least = fmin(least, ct_bounds_square(&other->search->boxes[rival], y));
    }
    side->distant[p] = sqrt(least);
  }
}

/* The faces of `other` whose boxes overlap one are listed behind the first `count` candidates;
 * returns their number, or -1 if there is no memory. */
static int32_t list_overlaps(ct_side *side, const ct_side *other, const ct_bounds *box,
                             int32_t count)
{
  for (;;) {
    const int32_t left = side->candidate_capacity - count,
                  found = ct_box_tree_overlaps(other->search->tree, other->search->boxes, box,
                                               side->candidates + count, left);
    if (found <= left) return found;
    // Once more, with more memory.
    const int32_t capacity = 2 * (count + found) + 8 * side->search->face_count;
    int32_t *larger = ct_allocate((size_t)capacity, sizeof *larger);
    if (larger == NULL) return -1;
    if (count > 0) memcpy(larger, side->candidates, (size_t)count * sizeof *larger);
    ct_release(side->candidates);
    side->candidates = larger;
    side->candidate_capacity = capacity;
  }
}

/* List for each face of `side` the faces of `other` within the distance to which its list must be
 * complete, and the skin; in pieces, for each face with points of this one. */
static ct_status list_candidates(ct_side *side, const ct_side *other, double skin, ct_error *error)
{
  int32_t count = 0;
  for (ct_span run = {0}; ct_side_next_faces(side, &run);)
    for (int32_t f = (int32_t)run.first; f < run.end; f++) {
      ct_bounds box = ct_bounds_grown(&side->search->boxes[f], side->listed[f] + skin);
      int32_t found = list_overlaps(side, other, &box, count), *list = side->candidates + count;
      if (found < 0) return CT_NO_MEMORY(error, "contact candidates");
      if (side == other) found = drop_adjacent(side, f, list, found);
      box = ct_bounds_grown(&side->search->boxes[f], skin);
      side->candidate_first[f] = count;
      side->near_end[f] = count + put_first(other->search, &box, list, found);
      measure_rivals(side, other, f, skin);
      side->candidate_first[f + 1] = count += found;
    }
  side->candidate_first[side->search->face_count] = count;
  return CT_OK;
}

/* Whether the box of some face of `side` is within `reach` of one of `other`; faces that share a
 * node do not count. */
static int anything_within(const ct_side *side, const ct_side *other, double reach)
{
  enum { CAPACITY = 64 };
  int32_t list[CAPACITY];
  for (int32_t f = 0; f < side->search->face_count; f++) {
    ct_bounds box = ct_bounds_grown(&side->search->boxes[f], reach);
    int32_t found =
        ct_box_tree_overlaps(other->search->tree, other->search->boxes, &box, list, CAPACITY);
    if (found > CAPACITY || (side == other ? drop_adjacent(side, f, list, found) : found) > 0)
      return 1;
  }
  return 0;
}

/* Find a distance between the surfaces: the free distance beyond the depth, tried as twice the
 * skin, four times, ... */
static void measure_clear(ct_gaps *gaps)
{
  enum { DOUBLINGS = 40 };
  const ct_side *a = &gaps->side[0], *b = &gaps->side[gaps->fixed->sides - 1];
  gaps->clear = 0.0;
  if (a->candidate_first[a->search->face_count] + b->candidate_first[b->search->face_count] > 0)
    return;
  gaps->clear = gaps->fixed->skin;
  for (int i = 0; i < DOUBLINGS && !anything_within(a, b, gaps->fixed->near + 2.0 * gaps->clear);
       i++)
    gaps->clear *= 2.0;
}

/* Whether a point was in contact in the last update: it is searched for at any depth (eq:held). */
static int holds(const ct_side *side)
{
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++)
      if (side->points[i].status == CT_POINT_INSIDE) return 1;
  return 0;
}

/* Whether no point is in contact or can have come within the depth of a face since the lists were
 * built: the box of a linear face moves at most as far as its nodes, that of a quadratic one seven
 * times as far (eq:contact-clear). */
int ct_gaps_are_separated(const ct_gaps *gaps)
{
  if (gaps->fixed->alone) return 1;
  if (!gaps->built || !gaps->begun || gaps->clear == 0.0) return 0;
  const ct_side *a = &gaps->side[0], *b = &gaps->side[gaps->fixed->sides - 1];
  double part =
      a->search->per > a->search->edges || b->search->per > b->search->edges ? 0.125 : 0.9;
  // (eq:contact-clear)
  const double most = part * gaps->clear;
  return relative_motion(a, b, most) <= most && !holds(a) && !holds(b);
}

/* Whether the lists reach as deep as each point in contact can have come since the last update, one
 * step of `near` deeper (eq:tunnelling). */
static int reaches_deepest(const ct_side *side, double near)
{
  const int points = side->fixed->rule.count;
  for (ct_span run = {0}; ct_side_next_faces(side, &run);)
    for (int64_t f = run.first; f < run.end; f++) {
      const double deepest = near - side->listed[f];
      for (const ct_point *p = &side->points[f * points], *end = p + points; p < end; p++)
        if (p->known < deepest && p->status == CT_POINT_INSIDE) return 0;
    }
  return 1;
}

/* Distance to which the list of each face is complete (eq:skin-mean): a little more than the search
 * distance of points, so that a face that comes into contact keeps its list, and more if its own
 * points in contact may become deeper. */
static void set_reach(ct_side *side, double depth, double near)
{
  for (int32_t f = 0; f < side->search->face_count; f++) side->listed[f] = 1.1 * depth;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++) {
      double *listed = &side->listed[i / side->fixed->rule.count];
      const ct_point *p = &side->points[i];
      if (p->status == CT_POINT_INSIDE) *listed = fmax(*listed, 1.5 * (near - p->known));
    }
}

double ct_gaps_reach(const ct_gaps *gaps)
{
  return gaps->start || (!gaps->begun && gaps->fixed->sides == 2) ? gaps->fixed->depth
                                                                  : gaps->fixed->near;
}

/* Refit trees and list candidates when the surfaces have moved by a fraction of the skin. */
ct_status ct_gaps_list_candidates(ct_gaps *gaps, ct_error *error)
{
  ct_side *a = &gaps->side[0], *b = &gaps->side[gaps->fixed->sides - 1];
  // -- The lists still hold all that can come near (eq:skin)
  const double reach = ct_gaps_reach(gaps), near = gaps->fixed->near,
               most = 0.25 * gaps->fixed->skin;
  gaps->since = gaps->built ? relative_motion(a, b, most) : 0.0;
  if (gaps->built && reach <= gaps->reach && gaps->since <= most && reaches_deepest(a, near) &&
      reaches_deepest(b, near))
    return CT_OK;
  gaps->since = 0.0;
  for (int s = 0; s < gaps->fixed->sides; s++) {
    ct_side *side = &gaps->side[s];
    ct_search_refit(side->search);
    memcpy(side->x_built, side->search->x,
           3 * (size_t)side->search->node_count * sizeof *side->search->x);
    set_reach(side, reach, near);
  }
  ct_status status = list_candidates(a, b, gaps->fixed->skin, error);
  if (status == CT_OK && a != b) status = list_candidates(b, a, gaps->fixed->skin, error);
  gaps->built = status == CT_OK && gaps->begun; // before that no point has a face
  gaps->reach = reach;
  if (gaps->built) measure_clear(gaps);
  return status;
}
