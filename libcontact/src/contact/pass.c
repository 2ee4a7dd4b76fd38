/* One pass of the contact: the Gauss points of one side against the faces of the other. */
#include "side.h"

#include "../vector.h"

#include <contact/batch.h>

#include <float.h>
#include <math.h>
#include <string.h>

/* The nearest face of the other side that a point has found so far. */
typedef struct nearest {
  int32_t face;
  double distance;
  ct_projection foot;
  double origin[3], y[3]; /* the middle of the face's box, and the point relative to it */
  double own[3];          /* unit normal at the point, of a surface with itself and where `same_side` is set */
  int same_side;          /* whether far sides are left out: faces that look away from `last` */
  double last[3];         /* unit normal of the other side where the point was in the last step */
} nearest;

/* Where a point is, seen from the place that it has found: nothing near, beyond the border, outside, inside, inside beneath a far side. */
typedef enum verdict { NOWHERE, BEYOND, OUTSIDE, INSIDE, FAR } verdict;

/* What one pass needs everywhere. */
typedef struct pass {
  ct_side *side;
  const ct_side *other;
  ct_project_options project;
  double epsilon, depth;
  double listed; /* candidates are complete to this distance */
  int self;  /* whether the other side is the same surface */
  int first; /* whether no point has a history yet */
} pass;

/* Position of a Gauss point, relative to `origin`. */
static void position(const ct_side *side, int32_t face, int q, const double origin[3], double y[3])
{
  ct_side_interpolate(side, face, side->N[q], origin, y);
}

/* Middle of a face's box: subtracted from the face and the point before they meet, so that far from the origin no digits are lost. */
static void middle(const ct_bounds *box, double origin[3])
{
  for (int c = 0; c < 3; c++) origin[c] = 0.5 * (box->low[c] + box->high[c]);
}

/* How deep a point of a surface may be under a foot on another part of it: half as deep as it was under that place in the reference shape, if it was
 * under it, for then the foot is on the far side of the body; else as deep as any (eq:self-depth). */
static double deepest(const pass *p, int32_t face, int q, int32_t target, const double xi[2])
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  const ct_search *search = p->other->search;
  double N[8], X[3], d[3], normal[3];
  ct_face reference = {.kind = search->kind};
  ct_segment_shape(search->kind, xi, N);
  ct_side_interpolate_reference(p->side, face, p->side->N[q], zero, X);
  ct_side_interpolate_reference(p->other, target, N, X, d);
  for (int a = 0; a < search->per; a++)
    memcpy(reference.node[a], &p->other->reference[3 * (int64_t)search->faces[(int64_t)target * search->per + a]], sizeof reference.node[a]);
  if (ct_segment_normal(&reference, xi, normal) != CT_OK || !(ct_vector_dot(d, normal) > 0.0)) return p->depth;
  return fmin(p->depth, 0.5 * sqrt(ct_vector_dot(d, d)));
}

/* In a contact of a surface with itself, whether a foot is one to be pushed from: the faces look at each other, no face at the foot is nearer (one
 * that shares a node with the point's own would not have been tried, eq:local-minimum), and the point is not deeper under it than it may be. `own` is
 * the normal at the point. */
static int may_push(const pass *p, int32_t face, int q, const double own[3], const double y[3], int32_t target, const ct_projection *foot)
{
  double normal[3], d[3];
  (void)ct_search_normal(p->other->search, target, foot->where, foot->index, foot->xi, foot->normal, normal);
  for (int c = 0; c < 3; c++) d[c] = foot->point[c] - y[c];
  // -- The sides of an edge look across, not at each other, however the body bends (eq:self-adjacent)
  if (!(ct_vector_dot(own, normal) < -0.25 * sqrt(ct_vector_dot(normal, normal)))) return 0;
  if (!ct_search_is_minimum(p->other->search, target, foot->where, foot->index, foot->xi, d)) return 0;
  return !(ct_vector_dot(d, normal) > 0.0) || foot->distance <= deepest(p, face, q, target, foot->xi);
}

/* Project a point on one face of the other side, both seen from `origin`. Answers 0 when it has no foot there. */
static int project(const pass *p, int32_t face, int q, int32_t target, const double *start, double origin[3], double y[3], ct_projection *foot)
{
  ct_project_options options = p->project;
  ct_face shifted;
  middle(&p->other->search->boxes[target], origin);
  position(p->side, face, q, origin, y);
  ct_search_face(p->other->search, target, &shifted);
  for (int a = 0; a < p->other->search->per; a++)
    for (int c = 0; c < 3; c++) shifted.node[a][c] -= origin[c];
  if (start != NULL) {
    options.use_start = 1;
    options.start[0] = start[0];
    options.start[1] = start[1];
  }
  ct_status status = ct_project(&shifted, y, &options, foot);
  return (status == CT_OK || status == CT_NOT_CERTIFIED || status == CT_ITERATION_LIMIT) && foot->where != CT_OUTSIDE;
}

/* Whether a surface with the normal `normal` (of any length) looks at one with the unit normal `own`, or across; not the same way (eq:far-side). */
static int looks_across(const double own[3], const double normal[3])
{
  return ct_vector_dot(own, normal) < 0.5 * sqrt(ct_vector_dot(normal, normal));
}

/* Whether a place with the normal `normal` (of any length) is on the far side, seen from where a point was, with the unit normal `last` (eq:far-side):
 * it looks away from that, or the same way as the point, and is not the side where the point was. */
static int is_far(const double own[3], const double last[3], const double normal[3])
{
  double along = ct_vector_dot(last, normal), half = 0.5 * sqrt(ct_vector_dot(normal, normal));
  return along < -half || (along < half && !looks_across(own, normal));
}

/* Unit normal of a point's own face. */
static int own_normal(const pass *p, int32_t face, int q, double own[3])
{
  ct_side_area(p->side, face, q, own);
  double length = sqrt(ct_vector_dot(own, own));
  for (int c = 0; c < 3; c++) own[c] /= length;
  return length > 0.0;
}

/* Unit normal, now, of the other side where a point was in the last step. Answers 0 when it was nowhere. */
static int last_normal(const pass *p, const ct_gauss_point *point, double normal[3])
{
  ct_face face;
  if (p->self || point->other < 0) return 0;
  ct_search_face(p->other->search, point->other, &face);
  return ct_segment_normal(&face, point->xi, normal) == CT_OK;
}

/* Whether a foot is on the far side of where the point was. */
static int is_foot_far(const pass *p, const nearest *best, int32_t target, const ct_projection *foot)
{
  double normal[3];
  (void)ct_search_normal(p->other->search, target, foot->where, foot->index, foot->xi, foot->normal, normal);
  return is_far(best->own, best->last, normal);
}

/* Try one face of the other side and keep the answer if it is the nearest. */
static void try_face(const pass *p, int32_t face, int q, int32_t target, const double *start, nearest *best)
{
  ct_projection foot;
  double origin[3], y[3];
  if (!project(p, face, q, target, start, origin, y, &foot) || (p->self && !may_push(p, face, q, best->own, y, target, &foot))) return;
  if (best->same_side && is_foot_far(p, best, target, &foot)) return;
  if (foot.distance < best->distance || (foot.distance == best->distance && target < best->face)) {
    best->face = target;
    best->distance = foot.distance;
    best->foot = foot;
    memcpy(best->origin, origin, sizeof origin);
    memcpy(best->y, y, sizeof y);
  }
}

/* On the border of an open surface: whether the point is above the face and not beyond it, to rounding; for points that lie on edges themselves. */
static int above_border(const ct_projection *foot, const double d[3])
{
  double along = ct_vector_dot(d, foot->normal);
  return ct_vector_dot(d, d) - along * along <= 1e-12 * ct_vector_dot(d, d);
}

/* Gap vector d = ȳ - y and the signed gap of a point over a place of a face (eq:gap), whose normal is known. `origin` was subtracted from y. */
static void gap_over(const pass *p, int32_t target, const double xi[2], const double origin[3], const double y[3], ct_gauss_point *point)
{
  double foot[3];
  ct_segment_shape(p->other->search->kind, xi, point->N);
  ct_side_interpolate(p->other, target, point->N, origin, foot);
  for (int c = 0; c < 3; c++) point->d[c] = foot[c] - y[c];
  double distance = sqrt(ct_vector_dot(point->d, point->d));
  point->gap = ct_vector_dot(point->d, point->normal) > 0.0 ? -distance : distance;
}

/* The gap of a point over the face it has found, and what it says of the point. */
static verdict measure(const pass *p, int32_t face, int q, const nearest *best, ct_gauss_point *point)
{
  double own[3], last[3], *normal = point->normal;
  int within = ct_search_normal(p->other->search, best->face, best->foot.where, best->foot.index, best->foot.xi, best->foot.normal, normal);
  gap_over(p, best->face, best->foot.xi, best->origin, best->y, point);
  if (!within && !(p->side->on_edges && above_border(&best->foot, point->d))) return BEYOND;
  int held = point->history == CT_POINT_INSIDE && !p->self;
  if (point->gap >= 0.0 && !held) return OUTSIDE;
  // -- Far sides: what looks away from where the point was, or the same way as a point that comes in (eq:far-side)
  if (!own_normal(p, face, q, own)) return FAR;
  if (last_normal(p, point, last) && is_far(own, last, normal)) return FAR;
  if (held) return point->gap >= 0.0 ? OUTSIDE : INSIDE;
  return looks_across(own, normal) ? INSIDE : FAR;
}

/* Write what has become of a point, and its force. */
static void close_point(const pass *p, int64_t number, verdict found, int32_t target, const double xi[2])
{
  ct_gauss_point *point = &p->side->points[number];
  int met = found == INSIDE || found == OUTSIDE;
  // -- Force of the point, ½ ε w J d where it is inside (eq:contact-force)
  int inside = met && point->gap < 0.0;
  double stiff = inside ? 0.5 * p->epsilon * p->side->weight[number] : 0.0;
  for (int c = 0; c < 3; c++) point->force[c] = inside ? stiff * point->d[c] : 0.0;
  point->history = found == INSIDE ? CT_POINT_INSIDE : found == OUTSIDE ? CT_POINT_OUTSIDE : found == FAR ? CT_POINT_BURIED : CT_POINT_NEW;
  point->other = met ? target : -1;
  if (!met) point->gap = NAN;
  else memcpy(point->xi, xi, sizeof point->xi);
}

/* Whether the way from a point to its foot, `d`, first enters through another face, one that the point is outside of: then the foot is on the far
 * side of something that the point is not in (eq:self-way). */
static int enters(const pass *p, int32_t face, int q, int32_t target, const double d[3])
{
  ct_projection foot;
  double origin[3], y[3], way[3], normal[3];
  if (!project(p, face, q, target, NULL, origin, y, &foot)) return 0;
  for (int c = 0; c < 3; c++) way[c] = foot.point[c] - y[c];
  (void)ct_search_normal(p->other->search, target, foot.where, foot.index, foot.xi, foot.normal, normal);
  return ct_vector_dot(way, normal) < 0.0 && ct_vector_dot(d, way) >= ct_vector_dot(way, way) &&
         ct_search_is_minimum(p->other->search, target, foot.where, foot.index, foot.xi, way);
}

/* Begin with nothing found; a surface in contact with itself needs its own normal first, a search on one side that of the last step too. Answers 0
 * when there is none. */
static int begin(const pass *p, int32_t face, int q, int same_side, nearest *best)
{
  *best = (nearest){.face = INT32_MAX, .distance = INFINITY, .same_side = same_side};
  if (!p->self && !same_side) return 1;
  if (same_side && !last_normal(p, &p->side->points[(int64_t)face * p->side->rule.count + q], best->last)) return 0;
  return own_normal(p, face, q, best->own);
}

/* The nearest face of a point, or the nearest that is on no far side. A point that is in contact looks as far as it takes, but not on its own
 * surface (eq:held). */
static void find_nearest(const pass *p, int32_t face, int q, const double y[3], int same_side, nearest *best)
{
  const ct_side *side = p->side, *other = p->other;
  const ct_gauss_point *point = &side->points[(int64_t)face * side->rule.count + q];
  int held = point->history == CT_POINT_INSIDE && !p->self;
  double most = held ? HUGE_VAL : p->depth;
  if (!begin(p, face, q, same_side, best)) return;

  // -- Try the face of the last step, then every candidate that may be nearer (eq:closest-face)
  int32_t warm = point->other;
  if (warm >= 0 && ct_bounds_distance(&other->search->boxes[warm], y) <= most) try_face(p, face, q, warm, point->xi, best);
  for (int32_t i = side->candidate_first[face]; i < side->candidate_first[face + 1]; i++) {
    int32_t target = side->candidates[i];
    double reach = best->distance < most ? best->distance : most;
    if (target != warm && ct_bounds_distance(&other->search->boxes[target], y) <= reach) try_face(p, face, q, target, NULL, best);
  }
  // -- Deeper than the lists reach: try all faces (eq:held)
  for (int32_t target = 0; held && best->distance > p->listed && target < other->search->face_count; target++)
    if (target != warm && ct_bounds_distance(&other->search->boxes[target], y) <= best->distance) try_face(p, face, q, target, NULL, best);
}

/* Whether the point was in contact, or outside over a face that it looks at, in the last step. */
static int came_in(const pass *p, int32_t face, int q, const ct_gauss_point *point)
{
  double own[3], last[3];
  if (point->history == CT_POINT_INSIDE) return 1;
  return last_normal(p, point, last) && own_normal(p, face, q, own) && looks_across(own, last);
}

/* The nearest place is a far side. A point that came in by another side belongs to that one still, unless it has left the body (eq:held). */
static verdict judge_far(const pass *p, int32_t face, int q, const double y[3], nearest *best, ct_gauss_point *point)
{
  int has_left = point->gap >= 0.0;
  if (p->self || !came_in(p, face, q, point)) return FAR;
  find_nearest(p, face, q, y, 1, best);
  if (best->face == INT32_MAX || measure(p, face, q, best, point) != INSIDE) return has_left ? NOWHERE : FAR;
  double along = ct_vector_dot(point->d, best->foot.normal);
  return has_left && along * along < 0.5 * ct_vector_dot(point->d, point->d) ? NOWHERE : INSIDE;
}

/* Whether a point with nothing near lies deep in the other body, at the very first look (eq:point-history). */
static int is_buried(const pass *p, const double y[3])
{
  ct_nearest foot;
  double normal[3];
  if (p->self || !p->first) return 0;
  ct_search_point(p->other->search, y, -1, HUGE_VAL, p->project.tolerance, NULL, NULL, &foot);
  return foot.face >= 0 && foot.signed_distance < 0.0 &&
         ct_search_normal(p->other->search, foot.face, foot.where, foot.index, foot.xi, foot.normal, normal);
}

/* What the place that a point has found and its history say together (eq:point-history). */
static verdict judge(const pass *p, int32_t face, int q, const double y[3], nearest *best, ct_gauss_point *point)
{
  int buried = point->history == CT_POINT_BURIED;
  if (best->face == INT32_MAX) return buried || is_buried(p, y) ? FAR : NOWHERE;
  verdict found = measure(p, face, q, best, point);
  if (found == FAR) found = judge_far(p, face, q, y, best, point);
  if (found == INSIDE && (p->self || point->history != CT_POINT_INSIDE) && (buried || point->gap < -p->depth)) found = FAR;
  if (found == FAR && p->self) return NOWHERE;
  if (found == BEYOND && buried) return FAR;
  // -- A surface with itself: no other face is on the way to the foot (eq:self-way)
  for (int32_t i = p->side->candidate_first[face]; p->self && found == INSIDE && i < p->side->candidate_first[face + 1]; i++) {
    int32_t target = p->side->candidates[i];
    if (target != best->face && ct_bounds_distance(&p->other->search->boxes[target], y) <= best->distance && enters(p, face, q, target, point->d))
      return NOWHERE;
  }
  return found;
}

static void search_point(const pass *p, int32_t face, int q)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  int64_t number = (int64_t)face * p->side->rule.count + q;
  nearest best;
  double y[3];
  position(p->side, face, q, zero, y);
  find_nearest(p, face, q, y, 0, &best);
  verdict found = judge(p, face, q, y, &best, &p->side->points[number]);
  close_point(p, number, found, best.face, best.foot.xi);
}

/* Eight points side by side, as ct_project_batch takes them, each with the face of the last step. */
typedef struct block {
  double nodes[8 * 3 * 8], points[3 * 8], start[2 * 8];
  double origin[8][3]; /* what was subtracted of the positions and of the nodes */
} block;

/* Whether some face but the last one may be nearer to a point than `distance`; with rounding of its position y, so a little too often rather than not. */
static int rivals(const pass *p, int32_t face, int32_t last, const double y[3], double distance)
{
  const ct_side *side = p->side;
  double reach = distance < p->depth ? distance : p->depth, rounding = 16.0 * DBL_EPSILON * ((fabs(y[0]) + fabs(y[1])) + (fabs(y[2]) + reach));
  double square = (reach + rounding) * (reach + rounding);
  for (int32_t i = side->candidate_first[face]; i < side->candidate_first[face + 1]; i++)
    if (side->candidates[i] != last && ct_bounds_square(&p->other->search->boxes[side->candidates[i]], y) <= square) return 1;
  return 0;
}

/* Load a point into a lane. Answers 0 when it has no last face. */
static int load_lane(const pass *p, int32_t face, int q, int lane, block *b)
{
  const ct_gauss_point *point = &p->side->points[(int64_t)face * p->side->rule.count + q];
  const ct_search *search = p->other->search;
  double *origin = b->origin[lane], y[3];
  if (point->other < 0) return 0;
  middle(&search->boxes[point->other], origin);
  position(p->side, face, q, origin, y);
  for (int c = 0; c < 3; c++) b->points[8 * c + lane] = y[c];
  for (int a = 0; a < 2; a++) b->start[8 * a + lane] = point->xi[a];
  const int32_t *node = &search->faces[(int64_t)point->other * search->per];
  for (int a = 0; a < search->per; a++)
    for (int c = 0; c < 3; c++) b->nodes[8 * (3 * a + c) + lane] = search->x[3 * (int64_t)node[a] + c] - origin[c];
  return 1;
}

/* Fill a lane that is not needed with another one. */
static void repeat_lane(block *b, int from, int lane)
{
  for (int k = 0; k < 24; k++) b->nodes[8 * k + lane] = b->nodes[8 * k + from];
  for (int c = 0; c < 3; c++) b->points[8 * c + lane] = b->points[8 * c + from];
  for (int a = 0; a < 2; a++) b->start[8 * a + lane] = b->start[8 * a + from];
}

/* Where a lane's point is. */
typedef struct place {
  int32_t face;
  int q;
} place;

/* Settle the point of a lane if its foot is inside its last face, no deeper than allowed, with no other face as near. */
static int settle_lane(const pass *p, place at, const block *b, int lane, const ct_batch_feet *feet)
{
  int64_t number = (int64_t)at.face * p->side->rule.count + at.q;
  ct_gauss_point *point = &p->side->points[number];
  ct_status status = (ct_status)feet->status[lane];
  double xi[2] = {feet->xi[lane], feet->xi[8 + lane]}, inside = 1.0 - p->project.tolerance, local[3], y[3];
  int32_t target = point->other;
  if (status != CT_OK && status != CT_NOT_CERTIFIED && status != CT_ITERATION_LIMIT) return 0;
  for (int c = 0; c < 3; c++) {
    local[c] = b->points[8 * c + lane];
    y[c] = local[c] + b->origin[lane][c];
  }
  if (!(fabs(xi[0]) < inside && fabs(xi[1]) < inside && feet->distance[lane] < p->depth) || rivals(p, at.face, target, y, feet->distance[lane])) return 0;
  for (int c = 0; c < 3; c++) point->normal[c] = feet->normal[8 * c + lane];
  gap_over(p, target, xi, b->origin[lane], local, point);
  // A point that comes in has to look at the face, or the search must say what it is in.
  double own[3];
  if (point->gap < 0.0 && point->history != CT_POINT_INSIDE && !(own_normal(p, at.face, at.q, own) && looks_across(own, point->normal))) return 0;
  close_point(p, number, point->gap < 0.0 ? INSIDE : OUTSIDE, target, xi);
  return 1;
}

/* Project eight points at most on the faces of the last step, side by side, and settle those for which the search would find the same
 * (eq:warm-lanes). Answers with a bit for each. */
static unsigned settle_block(const pass *p, const place at[8], int count)
{
  block b;
  double xi[16], distance[8], normal[24];
  int32_t status[8];
  unsigned warm = 0, settled = 0;
  int some = 0;
  for (int lane = 0; lane < count; lane++)
    if (load_lane(p, at[lane].face, at[lane].q, lane, &b)) warm |= 1u << lane, some = lane;
  if (warm == 0) return 0;
  for (int lane = 0; lane < 8; lane++)
    if (!(warm >> lane & 1)) repeat_lane(&b, some, lane);
  const ct_batch_feet feet = {.xi = xi, .distance = distance, .normal = normal, .status = status};
  if (ct_project_batch(p->other->search->kind, 8, b.nodes, b.points, b.start, &p->project, &feet) != CT_OK) return 0;
  for (int lane = 0; lane < count; lane++)
    if (warm >> lane & 1 && settle_lane(p, at[lane], &b, lane, &feet)) settled |= 1u << lane;
  return settled;
}

/* Search for the points first ... first + count - 1, eight at most. */
static void search_block(const pass *p, int lanes, int64_t first, int count)
{
  place at[8] = {{(int32_t)(first / p->side->rule.count), (int)(first % p->side->rule.count)}};
  for (int i = 1; i < count; i++) {
    int full = at[i - 1].q + 1 == p->side->rule.count;
    at[i] = (place){at[i - 1].face + full, full ? 0 : at[i - 1].q + 1};
  }
  unsigned settled = lanes ? settle_block(p, at, count) : 0;
  for (int i = 0; i < count; i++)
    if (!(settled >> i & 1)) search_point(p, at[i].face, at[i].q);
}

void ct_pass_search(ct_side *side, const ct_side *other, const ct_contact_options *options, double depth, double listed, int first)
{
  pass p = {side, other, ct_project_options_default(), options->epsilon, depth, listed, side == other, first};
  p.project.method = options->method;
  p.project.tolerance = options->tolerance;
  // A surface with itself judges feet by more than their distance, and other methods have no lanes.
  int lanes = !p.self && options->method == CT_ROBUST && (other->search->kind == CT_Q4 || other->search->kind == CT_Q8);
  int64_t count = ct_side_point_count(side);
#ifdef _OPENMP
#pragma omp parallel for num_threads(options->threads) schedule(static) if (options->threads > 1)
#endif
  for (int64_t i = 0; i < count; i += 8) search_block(&p, lanes, i, i + 8 < count ? 8 : (int)(count - i));
}
