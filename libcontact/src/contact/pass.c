/* One pass of the contact: the Gauss points of one side against the faces of the other. */
#include "pass.h"

#include "../base/threads.h"

#include <math.h>
#include <string.h>

/* The nearest face of the other side that a point has found so far. */
typedef struct nearest {
  int32_t face;
  double distance;
  ct_projection foot;
  double most;            /* how far it looks */
  double origin[3], y[3]; /* the middle of the face's box, and the point relative to it */
  double
      own[3]; /* unit normal at the point, of a surface with itself and where `same_side` is set */
  int same_side;  /* whether far sides are left out: faces that look away from `last` */
  double last[3]; /* unit normal of the other side where the point was in the last step */
} nearest;

/* Where a point is, seen from the place that it has found: nothing near, beyond the border,
 * outside, inside, inside beneath a far side. */
typedef enum verdict { NOWHERE, BEYOND, OUTSIDE, INSIDE, FAR } verdict;

/* Position of a Gauss point, relative to `origin`. */
static void position(const ct_side *side, int32_t face, int q, const double origin[3], double y[3])
{
  ct_side_interpolate(side, face, side->N[q], origin, y);
}

/* Middle of a face's box: subtracted from the face and the point before they meet, so that far from
 * the origin no digits are lost. */
static void middle(const ct_bounds *box, double origin[3])
{
  for (int c = 0; c < 3; c++) origin[c] = 0.5 * (box->low[c] + box->high[c]);
}

/* How deep a point of a surface may be under a foot on another part of it: half as deep as it was
 * under that place in the reference shape, if it was under it, for then the foot is on the far side
 * of the body; else as deep as any (eq:self-depth). */
static double deepest(const ct_pass *p, int32_t face, int q, int32_t target,
                      const ct_projection *foot)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  double N[8], X[3], d[3], own[3], normal[3];
  ct_face reference;
  ct_segment_shape(p->reference.kind, foot->xi, N);
  ct_side_interpolate_reference(p->side, face, p->side->N[q], zero, X);
  ct_side_interpolate_reference(p->other, target, N, X, d);
  ct_search_face(&p->reference, target, &reference);
  if (ct_segment_normal(&reference, foot->xi, own) != CT_OK) return p->deep;
  // -- On an edge or a corner, beneath all faces there (eq:pseudo-normal)
  (void)ct_search_normal(&p->reference, target, foot->where, foot->index, foot->xi, own, normal);
  return ct_vector_dot(d, normal) > 0.0 ? fmin(p->deep, 0.5 * sqrt(ct_vector_dot(d, d))) : p->deep;
}

/* Bound of what the motion since the last update can have changed of the distance between a point
 * and a place of a face (eq:gap-bound). */
static double motion_over(const ct_pass *p, int32_t face, int q, int32_t target)
{
  const ct_search *search = p->other->search;
  const double most = search->per > search->edges ? 3.0 : 1.0;
  double own[3], top = 0.0;
  ct_side_moved(p->side, face, p->side->N[q], own);
  for (int a = 0; a < search->per; a++) {
    const double *theirs =
        &p->other->moved[3 * (int64_t)search->faces[(int64_t)target * search->per + a]];
    const double d[3] = {own[0] - theirs[0], own[1] - theirs[1], own[2] - theirs[2]};
    top = fmax(top, ct_vector_dot(d, d));
  }
  return most * sqrt(top) + CT_CLOSEST_POINT_ERROR * search->size;
}

/* The same for the face found and for the one that the point was over before. */
static double motion_of(const ct_pass *p, int32_t face, int q, int32_t target)
{
  int32_t last = p->side->points[(int64_t)face * p->side->rule.count + q].other;
  double motion = motion_over(p, face, q, target);
  return last < 0 || last == target ? motion : fmax(motion, motion_over(p, face, q, last));
}

/* Unit normal, now, of the other side where a point was in the last step. Answers 0 when it was
 * nowhere. */
static int last_normal(const ct_pass *p, const ct_gauss_point *point, double normal[3])
{
  ct_face face;
  if (point->other < 0) return 0;
  ct_search_face(p->other->search, point->other, &face);
  return ct_segment_normal(&face, point->xi, normal) == CT_OK;
}

/* Whether a place with the normal `normal` (of any length) looks at a point with the normal `own`,
 * or looks across and the same way as the place where the point was in the last step
 * (eq:self-adjacent). */
static int looks_at(const ct_pass *p, const ct_gauss_point *point, const double own[3],
                    const double normal[3])
{
  double last[3], length = sqrt(ct_vector_dot(normal, normal)), along = ct_vector_dot(own, normal);
  if (along < -0.25 * length) return 1;
  return along < 0.5 * length && last_normal(p, point, last) &&
         ct_vector_dot(last, normal) > 0.5 * length;
}

/* In a contact of a surface with itself, whether a foot is one to be pushed from: the faces look at
 * each other, no face at the foot is nearer (one that shares a node with the point's own would not
 * have been tried, eq:local-minimum), and the point is not deeper under it than it may be. `own` is
 * the normal at the point. */
static int may_push(const ct_pass *p, int32_t face, int q, const double own[3], const double y[3],
                    int32_t target, const ct_projection *foot)
{
  double normal[3], d[3];
  (void)ct_search_normal(p->other->search, target, foot->where, foot->index, foot->xi, foot->normal,
                         normal);
  for (int c = 0; c < 3; c++) d[c] = foot->point[c] - y[c];
  if (!ct_pass_looks_across(own, normal)) return 0;
  if (!ct_search_is_minimum(p->other->search, target, foot->where, foot->index, foot->xi, d))
    return 0;
  if (!(ct_vector_dot(d, normal) > 0.0)) return 1;
  const ct_gauss_point *point = &p->side->points[(int64_t)face * p->side->rule.count + q];
  if (!looks_at(p, point, own, normal)) return 0;
  // -- No deeper than it was and than the motion since then can have brought it (eq:self-history)
  double known = point->known, came = (known < 0.0 ? -known : 0.0) + motion_of(p, face, q, target);
  return foot->distance <= fmin(came, deepest(p, face, q, target, foot));
}

/* Project a point on one face of the other side, both seen from `origin`. Answers 0 when it has no
 * foot there. */
static int project(const ct_pass *p, int32_t face, int q, int32_t target, const double *start,
                   double origin[3], double y[3], ct_projection *foot)
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
  return (status == CT_OK || status == CT_NOT_CERTIFIED || status == CT_ITERATION_LIMIT) &&
         foot->where != CT_OUTSIDE;
}

/* Whether a place with the normal `normal` (of any length) is on the far side, seen from where a
 * point was, with the unit normal `last` (eq:far-side): it looks away from that, or the same way as
 * the point, and is not the side where the point was. */
static int is_far(const double own[3], const double last[3], const double normal[3])
{
  double along = ct_vector_dot(last, normal), half = 0.5 * sqrt(ct_vector_dot(normal, normal));
  return along < -half || (along < half && !ct_pass_looks_across(own, normal));
}

/* Whether a foot is on the far side of where the point was. */
static int is_foot_far(const ct_pass *p, const nearest *best, int32_t target,
                       const ct_projection *foot)
{
  double normal[3];
  (void)ct_search_normal(p->other->search, target, foot->where, foot->index, foot->xi, foot->normal,
                         normal);
  return is_far(best->own, best->last, normal);
}

/* Try one face of the other side and keep the answer if it is the nearest. */
static void try_face(const ct_pass *p, int32_t face, int q, int32_t target, const double *start,
                     nearest *best)
{
  ct_projection foot;
  double origin[3], y[3];
  if (!project(p, face, q, target, start, origin, y, &foot) || foot.distance > best->most ||
      (p->self && !may_push(p, face, q, best->own, y, target, &foot)))
    return;
  if (best->same_side && is_foot_far(p, best, target, &foot)) return;
  if (foot.distance < best->distance || (foot.distance == best->distance && target < best->face)) {
    best->face = target;
    best->distance = foot.distance;
    best->foot = foot;
    memcpy(best->origin, origin, sizeof origin);
    memcpy(best->y, y, sizeof y);
  }
}

/* On the border of an open surface: whether the point is above the face and not beyond it, to
 * rounding; for points that lie on edges themselves. */
static int above_border(const ct_projection *foot, const double d[3])
{
  double along = ct_vector_dot(d, foot->normal);
  return ct_vector_dot(d, d) - along * along <= 1e-12 * ct_vector_dot(d, d);
}

/* Gap vector d = ȳ - y and the signed gap of a point over a place of a face (eq:gap), whose normal
 * is known. `origin` was subtracted from y. */
static void gap_over(const ct_pass *p, int32_t target, const double xi[2], const double origin[3],
                     const double y[3], ct_gauss_point *point)
{
  double foot[3];
  ct_segment_shape(p->other->search->kind, xi, point->N);
  ct_side_interpolate(p->other, target, point->N, origin, foot);
  for (int c = 0; c < 3; c++) point->d[c] = foot[c] - y[c];
  double distance = sqrt(ct_vector_dot(point->d, point->d));
  point->gap = ct_vector_dot(point->d, point->normal) > 0.0 ? -distance : distance;
}

/* Whether the gap of the last update and the one over the place found are distances from the same
 * side: a point in contact may have been held under a side that is not the nearest (eq:held). */
static int is_same_side(const ct_pass *p, const ct_gauss_point *point)
{
  double last[3];
  if (point->history != CT_POINT_INSIDE) return 1;
  return last_normal(p, point, last) && ct_vector_dot(last, point->normal) >
                                            0.5 * sqrt(ct_vector_dot(point->normal, point->normal));
}

/* The side of the surface that a point is on cannot change while the motion is smaller than its
 * distance (eq:gap-bound). */
static void keep_side(const ct_pass *p, int32_t face, int q, int32_t target, ct_gauss_point *point)
{
  if (isnan(point->known) || fabs(point->gap - point->known) <= fabs(point->gap + point->known) ||
      !is_same_side(p, point))
    return;
  double motion = motion_of(p, face, q, target);
  if (fabs(point->gap - point->known) > motion && fabs(point->gap + point->known) <= motion)
    point->gap = -point->gap;
}

/* Whether a point in contact with a place that it looks at comes to another one that is as near, so
 * that its gap does not leap (eq:gap-bound), and that does not look away from the first: then it is
 * handed over, whichever way the place looks (eq:far-side). */
static int is_handed_over(const ct_pass *p, int32_t face, int q, int32_t target,
                          const double own[3], const double last[3], const ct_gauss_point *point)
{
  const double *normal = point->normal;
  if (point->history != CT_POINT_INSIDE || isnan(point->known) ||
      !(ct_vector_dot(own, last) < -0.25))
    return 0;
  return ct_vector_dot(last, normal) >= -0.5 * sqrt(ct_vector_dot(normal, normal)) &&
         fabs(point->gap - point->known) <= motion_of(p, face, q, target);
}

/* The gap of a point over the face it has found, and what it says of the point. */
static verdict measure(const ct_pass *p, int32_t face, int q, const nearest *best,
                       ct_gauss_point *point)
{
  double own[3], last[3], *normal = point->normal;
  int within = ct_search_normal(p->other->search, best->face, best->foot.where, best->foot.index,
                                best->foot.xi, best->foot.normal, normal);
  gap_over(p, best->face, best->foot.xi, best->origin, best->y, point);
  if (within) keep_side(p, face, q, best->face, point);
  if (!within && !(p->side->on_edges && above_border(&best->foot, point->d))) return BEYOND;
  int held = point->history == CT_POINT_INSIDE && !p->self;
  if (point->gap >= 0.0 && !held) return OUTSIDE;
  // -- Far sides: what looks away from where the point was, or the same way as a point that comes
  // in (eq:far-side)
  if (!ct_pass_own_normal(p, face, q, own)) return FAR;
  if (!p->self && last_normal(p, point, last) && is_far(own, last, normal) &&
      !is_handed_over(p, face, q, best->face, own, last, point))
    return FAR;
  if (held) return point->gap >= 0.0 ? OUTSIDE : INSIDE;
  return ct_pass_looks_across(own, normal) ? INSIDE : FAR;
}

/* The gap that the next update may go by: beyond a border there are no sides, so a point of a
 * surface with itself may come in from there at any depth, and the side of another point is not
 * known; nor is that of a point under a place that was not taken. */
static double known_gap(const ct_pass *p, verdict found, int32_t target,
                        const ct_gauss_point *point)
{
  if (target < 0) return NAN;
  if (found == BEYOND) return p->self ? -fabs(point->gap) : NAN;
  return p->self && found != INSIDE && found != OUTSIDE ? NAN : point->gap;
}

/* Write what has become of a point, and its force. */
static void close_point(const ct_pass *p, int64_t number, verdict found, int32_t target,
                        const double xi[2])
{
  ct_gauss_point *point = &p->side->points[number];
  int met = found == INSIDE || found == OUTSIDE;
  // -- Force of the point, ½ ε w J d where it is inside (eq:contact-force)
  int inside = met && point->gap < 0.0;
  double stiff = inside ? 0.5 * p->epsilon * p->side->weight[number] : 0.0;
  for (int c = 0; c < 3; c++) point->force[c] = inside ? stiff * point->d[c] : 0.0;
  point->history = found == INSIDE    ? CT_POINT_INSIDE
                   : found == OUTSIDE ? CT_POINT_OUTSIDE
                   : found == FAR     ? CT_POINT_BURIED
                                      : CT_POINT_NEW;
  point->other = met ? target : -1;
  point->known = known_gap(p, found, target, point);
  if (!met) point->gap = NAN;
  else memcpy(point->xi, xi, sizeof point->xi);
}

/* Begin with nothing found; a surface in contact with itself needs its own normal first, a search
 * on one side that of the last step too. Answers 0 when there is none. */
static int begin(const ct_pass *p, int32_t face, int q, int same_side, double most, nearest *best)
{
  *best = (nearest){.face = INT32_MAX, .distance = INFINITY, .most = most, .same_side = same_side};
  if (!p->self && !same_side) return 1;
  if (same_side &&
      !last_normal(p, &p->side->points[(int64_t)face * p->side->rule.count + q], best->last))
    return 0;
  return ct_pass_own_normal(p, face, q, best->own);
}

/* The nearest face of a point, or the nearest that is on no far side. A point that is in contact
 * looks as far as it takes, but not on its own surface (eq:held). */
static void find_nearest(const ct_pass *p, int32_t face, int q, const double y[3], int same_side,
                         nearest *best)
{
  const ct_side *side = p->side, *other = p->other;
  const ct_gauss_point *point = &side->points[(int64_t)face * side->rule.count + q];
  int held = point->history == CT_POINT_INSIDE && !p->self;
  double most = held                                ? HUGE_VAL
                : point->history == CT_POINT_INSIDE ? p->depth - point->known
                                                    : p->depth;
  if (!begin(p, face, q, same_side, most, best)) return;

  // -- Try the face of the last step, then every candidate that may be nearer (eq:closest-face)
  int32_t warm = point->other;
  if (warm >= 0 && ct_bounds_distance(&other->search->boxes[warm], y) <= most)
    try_face(p, face, q, warm, point->xi, best);
  for (int32_t i = side->candidate_first[face]; i < side->candidate_first[face + 1]; i++) {
    int32_t target = side->candidates[i];
    double reach = best->distance < most ? best->distance : most;
    if (target != warm && ct_bounds_distance(&other->search->boxes[target], y) <= reach)
      try_face(p, face, q, target, NULL, best);
  }
  // -- Deeper than the lists reach: try all faces (eq:held)
  for (int32_t target = 0;
       held && best->distance > side->listed[face] && target < other->search->face_count; target++)
    if (target != warm && ct_bounds_distance(&other->search->boxes[target], y) <= best->distance)
      try_face(p, face, q, target, NULL, best);
}

/* Whether the point was in contact, or outside over a face that it looks at, in the last step. */
static int came_in(const ct_pass *p, int32_t face, int q, const ct_gauss_point *point)
{
  double own[3], last[3];
  if (point->history == CT_POINT_INSIDE) return 1;
  return last_normal(p, point, last) && ct_pass_own_normal(p, face, q, own) &&
         ct_pass_looks_across(own, last);
}

/* The nearest place is a far side. A point that came in by another side belongs to that one still,
 * unless it has left the body (eq:held). */
static verdict judge_far(const ct_pass *p, int32_t face, int q, const double y[3], nearest *best,
                         ct_gauss_point *point)
{
  int has_left = point->gap >= 0.0;
  if (p->self || !came_in(p, face, q, point)) return FAR;
  find_nearest(p, face, q, y, 1, best);
  if (best->face == INT32_MAX || measure(p, face, q, best, point) != INSIDE)
    return has_left ? NOWHERE : FAR;
  double along = ct_vector_dot(point->d, best->foot.normal);
  return has_left && along * along < 0.5 * ct_vector_dot(point->d, point->d) ? NOWHERE : INSIDE;
}

/* Whether a point with nothing near lies deep in the other body, at the very first look
 * (eq:point-history). */
static int is_buried(const ct_pass *p, const double y[3])
{
  ct_nearest foot;
  double normal[3];
  if (p->self || !p->first) return 0;
  ct_search_point(p->other->search, y, -1, HUGE_VAL, p->project.tolerance, NULL, NULL, &foot);
  return foot.face >= 0 && foot.signed_distance < 0.0 &&
         ct_search_normal(p->other->search, foot.face, foot.where, foot.index, foot.xi, foot.normal,
                          normal);
}

/* What the place that a point has found and its history say together (eq:point-history). */
static verdict judge(const ct_pass *p, int32_t face, int q, const double y[3], nearest *best,
                     ct_gauss_point *point)
{
  int buried = point->history == CT_POINT_BURIED;
  if (best->face == INT32_MAX) return buried || is_buried(p, y) ? FAR : NOWHERE;
  verdict found = measure(p, face, q, best, point);
  if (found == FAR) found = judge_far(p, face, q, y, best, point);
  if (found == INSIDE && (p->self || point->history != CT_POINT_INSIDE) &&
      (buried || point->gap < -(p->self ? p->deep : p->depth)))
    found = FAR;
  if (found == FAR && p->self) return NOWHERE;
  if (found == BEYOND && buried) return FAR;
  return found;
}

/* Whether nothing can be near a point: it was over no face, and no face is listed for its own; at
 * the very first look it may be deep inside (eq:point-history). */
static int is_alone(const ct_pass *p, int32_t face, const ct_gauss_point *point)
{
  const int32_t *list = &p->side->candidate_first[face];
  return list[0] == list[1] && point->other < 0 && point->history != CT_POINT_INSIDE && !p->first;
}

static void search_point(const ct_pass *p, int32_t face, int q)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  int64_t number = (int64_t)face * p->side->rule.count + q;
  ct_gauss_point *point = &p->side->points[number];
  nearest best;
  double y[3];
  if (is_alone(p, face, point)) {
    close_point(p, number, point->history == CT_POINT_BURIED ? FAR : NOWHERE, -1, point->xi);
    return;
  }
  position(p->side, face, q, zero, y);
  find_nearest(p, face, q, y, 0, &best);
  verdict found = judge(p, face, q, y, &best, point);
  close_point(p, number, found, best.face == INT32_MAX ? -1 : best.face, best.foot.xi);
}

/* Search for the points first ... first + count - 1, eight at most. */
static void search_block(const ct_pass *p, int lanes, int64_t first, int count)
{
  unsigned settled = lanes ? ct_pass_warm(p, first, count) : 0;
  int32_t points = p->side->rule.count;
  for (int i = 0; i < count; i++)
    if (!(settled >> i & 1))
      search_point(p, (int32_t)((first + i) / points), (int)((first + i) % points));
}

void ct_pass_search(ct_side *side, const ct_side *other, const ct_contact_options *options,
                    double depth, double deep, int first)
{
  ct_pass p = {side,
               other,
               ct_project_options_default(),
               options->epsilon,
               depth,
               deep,
               side == other,
               first,
               *other->search};
  p.reference.x = other->reference;
  p.project.method = options->method;
  p.project.tolerance = options->tolerance;
  // A surface with itself judges feet by more than their distance, other methods have no lanes, and
  // lanes take faces of one kind.
  int lanes = !p.self && options->method == CT_ROBUST &&
              side->search->kind == other->search->kind &&
              (other->search->kind == CT_Q4 || other->search->kind == CT_Q8);
  int64_t count = ct_side_point_count(side);
#ifdef _OPENMP
  int threads = ct_threads(options->threads);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int64_t i = 0; i < count; i += CT_WARM)
    search_block(&p, lanes, i, count - i < CT_WARM ? (int)(count - i) : CT_WARM);
}
