/* One pass of the contact: the Gauss points of one side against the faces of the other. */
#include "pass.h"

#include "../base/lanes.h"
#include "../base/threads.h"

#include <math.h>
#include <string.h>

/* Which faces a search tries: all, those on no far side, or those that face the point. */
typedef enum search_over { ALL_FACES, SAME_SIDE, FACING } search_over;

/* The nearest face of the other side found so far for a point. */
typedef struct nearest {
  int32_t face;
  double distance;
  ct_projection closest;
  double most;            /* search distance */
  double clear;           /* if no face is found: a lower bound of the distance of all candidates */
  double origin[3], y[3]; /* middle of the face's box, and the point relative to it */
  double own[3];          /* unit normal at the point, for a surface in contact with itself and
                             unless all faces are tried */
  search_over over;       /* far sides are faces that point away from `last` */
  double last[3];         /* unit normal of the other side at the point's place in the last step */
} nearest;

/* The class of a point relative to the closest point found: nothing near, beyond the border,
 * outside, inside, inside beneath a far side. */
typedef enum point_class { NOWHERE, BEYOND, OUTSIDE, INSIDE, FAR } point_class;

/* The face of a point. */
static int32_t face_of(const ct_pass *p, int64_t i)
{
  return (int32_t)(i / p->side->fixed->rule.count);
}

/* Direction outwards at a closest point on a face, as ct_search_normal. */
static int outward_at(const ct_pass *p, int32_t target, const ct_projection *closest,
                      double normal[3])
{
  return ct_search_normal(p->other->search, target, closest->where, closest->index, closest->xi,
                          closest->normal, normal);
}

/* Middle of a face's box: subtracted from the face and the point before they are combined, so that
 * no digits are lost far from the origin. */
static void middle(const ct_bounds *box, double origin[3])
{
  for (int c = 0; c < 3; c++) origin[c] = 0.5 * (box->low[c] + box->high[c]);
}

/* Largest depth of a point of a surface under its closest point on another part of the same
 * surface. If it was under that place in the reference shape, the closest point is on the far side
 * of the body, and the limit is half of that depth; otherwise there is no limit (eq:self-depth). */
static double deepest(const ct_pass *p, int64_t i, int32_t target, const ct_projection *closest)
{
  const ct_search *body = p->other->fixed->search;
  double N[8], X[3], d[3], own[3], normal[3];
  ct_face reference;
  ct_segment_shape(body->kind, closest->xi, N);
  ct_side_interpolate(body, body->x, face_of(p, i), p->side->points[i].row.own_shape, NULL, X);
  ct_side_interpolate(body, body->x, target, N, X, d);
  ct_search_face(body, target, &reference);
  if (ct_segment_normal(&reference, closest->xi, own) != CT_OK) return p->deep;
  // -- On an edge or a corner, beneath all faces there (eq:pseudo-normal)
  (void)ct_search_normal(body, target, closest->where, closest->index, closest->xi, own, normal);
  // -- Half of the reference distance if there was material between them (eq:self-depth)
  return ct_vector_dot(d, normal) > 0.0 ? fmin(p->deep, 0.5 * sqrt(ct_vector_dot(d, d))) : p->deep;
}

/* Bound on the change of the distance between a point and a place on a face by the motion since the
 * last update (eq:gap-bound). */
static double motion_over(const ct_pass *p, int64_t i, int32_t target)
{
  const ct_search *search = p->other->search;
  double own[3], top = 0.0;
  ct_side_interpolate(p->side->search, p->side->moved, face_of(p, i),
                      p->side->points[i].row.own_shape, NULL, own);
  for (int a = 0; a < search->per; a++) {
    const double *theirs =
        &p->other->moved[3 * (int64_t)search->faces[(int64_t)target * search->per + a]];
    const double d[3] = {own[0] - theirs[0], own[1] - theirs[1], own[2] - theirs[2]};
    top = fmax(top, ct_vector_dot(d, d));
  }
  // -- m = S max |Δy - Δu_b|, with S = 3 on quadratic faces (eq:gap-bound)
  return ct_side_stretch(p->other) * sqrt(top) + CT_CLOSEST_POINT_ERROR * search->size;
}

/* The same for the face found and for the face of the last update. */
static double motion_of(const ct_pass *p, int64_t i, int32_t target)
{
  int32_t last = p->side->points[i].other;
  double motion = motion_over(p, i, target);
  return last < 0 || last == target ? motion : fmax(motion, motion_over(p, i, last));
}

/* Present unit normal of the other side at the point's place in the last step. Returns 0 if it had
 * none. */
static int last_normal(const ct_pass *p, const ct_point *point, double normal[3])
{
  ct_face face;
  if (point->other < 0) return 0;
  ct_search_face(p->other->search, point->other, &face);
  return ct_segment_normal(&face, point->xi, normal) == CT_OK;
}

/* Whether a place with the normal `normal` (of any length) faces a point with the normal `own`, or
 * is perpendicular and points in the same direction as the point's place in the last step. */
static int faces_point(const ct_pass *p, const ct_point *point, const double own[3],
                       const double normal[3])
{
  double last[3];
  // -- It faces the point, or its normal is within 60° of the last one
  if (ct_pass_opposes(own, normal)) return 1;
  return ct_pass_faces_across(own, normal) && last_normal(p, point, last) &&
         ct_vector_dot(last, normal) > 0.5 * sqrt(ct_vector_dot(normal, normal));
}

/* For a surface in contact with itself: whether a closest point is admissible. The faces must face
 * each other, no face at the closest point may be nearer (faces that share a node with the
 * point's own were excluded, eq:local-minimum), and the depth must be within its limit. `own` is
 * the normal at the point. */
static int is_admissible(const ct_pass *p, int64_t i, const double own[3], const double y[3],
                         int32_t target, const ct_projection *closest)
{
  double normal[3], d[3];
  (void)outward_at(p, target, closest, normal);
  for (int c = 0; c < 3; c++) d[c] = closest->point[c] - y[c];
  const ct_point *point = &p->side->points[i];
  const int beside = ct_search_adjacent(p->other->search, face_of(p, i), target);
  // -- A face across an edge must face the point (eq:self-adjacent)
  if (!(beside ? ct_pass_opposes(own, normal) : ct_pass_faces_across(own, normal))) return 0;
  if (!ct_search_is_minimum(p->other->search, target, closest->where, closest->index, closest->xi,
                            d))
    return 0;
  if (!(ct_vector_dot(d, normal) > 0.0)) return 1;
  if ((beside && point->other < 0) || !faces_point(p, point, own, normal)) return 0;
  // -- No deeper than its last depth plus the motion since (eq:self-status)
  double known = point->known, came = (known < 0.0 ? -known : 0.0) + motion_of(p, i, target);
  return closest->distance <= fmin(came, deepest(p, i, target, closest));
}

/* Project a point on one face of the other side, both relative to `origin`. Returns 0 if it has no
 * closest point there. */
static int project(const ct_pass *p, int64_t i, int32_t target, const double *start,
                   double origin[3], double y[3], ct_projection *closest)
{
  ct_project_options options = p->project;
  ct_face shifted;
  middle(&p->other->search->boxes[target], origin);
  ct_side_position(p->side, i, origin, y);
  ct_search_face(p->other->search, target, &shifted);
  for (int a = 0; a < p->other->search->per; a++)
    for (int c = 0; c < 3; c++) shifted.node[a][c] -= origin[c];
  if (start != NULL) {
    options.use_start = 1;
    options.start[0] = start[0];
    options.start[1] = start[1];
  }
  ct_status status = ct_project(&shifted, y, &options, closest, NULL);
  return (status == CT_OK || status == CT_NOT_CERTIFIED || status == CT_ITERATION_LIMIT) &&
         closest->where != CT_OUTSIDE;
}

/* Whether a place with the normal `normal` (of any length) is on the far side, relative to the
 * point's last place with the unit normal `last` (eq:far-side): it points in the opposite
 * direction, or in that of the point's own normal and is not the side of the last place. */
static int is_far(const double own[3], const double last[3], const double normal[3])
{
  double along = ct_vector_dot(last, normal), half = 0.5 * sqrt(ct_vector_dot(normal, normal));
  // -- Opposite to the last place, or not beside it and as the point's own face (eq:far-side)
  return along < -half || (along < half && !ct_pass_faces_across(own, normal));
}

/* Try one face of the other side and keep the result if it is the nearest. */
static void try_face(const ct_pass *p, int64_t i, int32_t target, const double *start,
                     nearest *best)
{
  ct_projection closest;
  double origin[3], y[3], normal[3];
  const int found = project(p, i, target, start, origin, y, &closest),
            beyond = found && closest.distance > best->most;
  best->clear = fmin(best->clear, beyond ? closest.distance : 0.0);
  if (!found || beyond || (p->self && !is_admissible(p, i, best->own, y, target, &closest))) return;
  if (best->over != ALL_FACES) (void)outward_at(p, target, &closest, normal);
  // -- The search on one side skips far sides (eq:held)
  if (best->over == SAME_SIDE && is_far(best->own, best->last, normal)) return;
  if (best->over == FACING && !ct_pass_opposes(best->own, normal)) return;
  // -- The nearest face; of two as near, the one with the lower number (eq:closest-face)
  if (closest.distance < best->distance ||
      (closest.distance == best->distance && target < best->face)) {
    best->face = target;
    best->distance = closest.distance;
    best->closest = closest;
    memcpy(best->origin, origin, sizeof origin);
    memcpy(best->y, y, sizeof y);
  }
}

/* On the border of an open surface: whether the point is above the face and not beyond it, to
 * rounding; for points that themselves lie on edges. */
static int above_border(const ct_projection *closest, const double d[3])
{
  double along = ct_vector_dot(d, closest->normal);
  return ct_vector_dot(d, d) - along * along <= 1e-12 * ct_vector_dot(d, d);
}

/* Gap vector d = ȳ - y and signed gap of a point at a place on a face (eq:gap), whose normal is
 * known. `origin` was subtracted from y. */
static void gap_over(const ct_pass *p, int32_t target, const double xi[2], const double origin[3],
                     const double y[3], ct_point *point)
{
  double closest[3];
  ct_segment_shape(p->other->search->kind, xi, point->N);
  ct_side_interpolate(p->other->search, p->other->search->x, target, point->N, origin, closest);
  // -- d = ȳ - y; inside, where d points outwards, the gap is negative (eq:gap)
  for (int c = 0; c < 3; c++) point->d[c] = closest[c] - y[c];
  double distance = sqrt(ct_vector_dot(point->d, point->d));
  point->row.gap = ct_vector_dot(point->d, point->outward) > 0.0 ? -distance : distance;
}

/* Whether the gap of the last update and the one at the place found are distances from the same
 * side: a point in contact may belong to a side that is not the nearest (eq:held). */
static int is_same_side(const ct_pass *p, const ct_point *point)
{
  double last[3];
  if (point->status != CT_POINT_INSIDE) return 1;
  return last_normal(p, point, last) &&
         ct_vector_dot(last, point->outward) >
             0.5 * sqrt(ct_vector_dot(point->outward, point->outward));
}

/* The point stays on its side of the surface while the motion is smaller than its distance
 * (eq:gap-bound). */
static void keep_side(const ct_pass *p, int64_t i, int32_t target, ct_point *point)
{
  if (isnan(point->known) ||
      fabs(point->row.gap - point->known) <= fabs(point->row.gap + point->known) ||
      !is_same_side(p, point))
    return;
  double motion = motion_of(p, i, target);
  if (fabs(point->row.gap - point->known) > motion && fabs(point->row.gap + point->known) <= motion)
    point->row.gap = -point->row.gap;
}

/* Whether a point in contact moves to another place that is as near, so that its gap does not jump
 * (eq:gap-bound), and does not point away from the first place: then it belongs to the new place,
 * whatever its direction (eq:far-side). */
static int is_handed_over(const ct_pass *p, int64_t i, int32_t target, const double own[3],
                          const double last[3], const ct_point *point)
{
  const double *normal = point->outward;
  if (point->status != CT_POINT_INSIDE || isnan(point->known) ||
      !(ct_vector_dot(own, last) < -0.25))
    return 0;
  return ct_vector_dot(last, normal) >= -0.5 * sqrt(ct_vector_dot(normal, normal)) &&
         fabs(point->row.gap - point->known) <= motion_of(p, i, target);
}

/* The gap of a point at the face found, and the class that follows. */
static point_class measure(const ct_pass *p, int64_t i, const nearest *best, ct_point *point)
{
  double own[3], last[3], *normal = point->outward;
  int within = outward_at(p, best->face, &best->closest, normal);
  gap_over(p, best->face, best->closest.xi, best->origin, best->y, point);
  if (within) keep_side(p, i, best->face, point);
  if (!within && !(p->side->fixed->on_edges && above_border(&best->closest, point->d)))
    return BEYOND;
  int held = point->status == CT_POINT_INSIDE && !p->self;
  if (point->row.gap >= 0.0 && !held) return OUTSIDE;
  // -- Far sides: places that point away from the point's last place, or in the same direction as a
  // point that comes in (eq:far-side)
  if (!ct_pass_own_normal(p, i, own)) return FAR;
  if (!p->self && last_normal(p, point, last) && is_far(own, last, normal) &&
      !is_handed_over(p, i, best->face, own, last, point))
    return FAR;
  if (held) return point->row.gap >= 0.0 ? OUTSIDE : INSIDE;
  return ct_pass_faces_across(own, normal) ? INSIDE : FAR;
}

/* The gap for the next update. Beyond a border there are no sides, so a point of a surface in
 * contact with itself may come in from there at any depth, and the side of other points is unknown;
 * the same holds for a point under a rejected place. */
static double known_gap(const ct_pass *p, point_class found, int32_t target, const ct_point *point)
{
  if (target < 0) return NAN;
  if (found == BEYOND) return p->self ? -fabs(point->row.gap) : NAN;
  return p->self && found != INSIDE && found != OUTSIDE ? NAN : point->row.gap;
}

/* Whether a point is inside that was not over a face in the last step, or at another gap than the
 * motion since then explains (eq:admitted). */
static int has_jumped(const ct_pass *p, int64_t i, point_class found, int32_t target)
{
  const ct_point *point = &p->side->points[i];
  if (found != INSIDE || p->first) return 0;
  return point->other < 0 || isnan(point->known) ||
         fabs(point->row.gap - point->known) > motion_of(p, i, target);
}

/* Store the result for a point. */
static void close_point(const ct_pass *p, ct_point *point, point_class found, int32_t target,
                        const double xi[2])
{
  int met = found == INSIDE || found == OUTSIDE;
  // -- The status for the next step (eq:point-status)
  point->status = found == INSIDE    ? CT_POINT_INSIDE
                  : found == OUTSIDE ? CT_POINT_OUTSIDE
                  : found == FAR     ? CT_POINT_BURIED
                                     : CT_POINT_NEW;
  point->other = met ? target : -1;
  point->along = NAN;
  point->last_known = point->known;
  point->known = known_gap(p, found, target, point);
  if (!met) {
    point->row.gap = NAN;
    point->xi[0] = point->xi[1] = 0.0;
    return;
  }
  memcpy(point->xi, xi, sizeof point->xi);
  ct_side_meet(p->other, point);
  ct_side_direct(p->side, point);
}

/* Begin with nothing found. A surface in contact with itself and a search over some faces need the
 * point's own normal, and a search on one side also that of the last step. Returns 0 if there is
 * none. */
static int begin(const ct_pass *p, int64_t i, search_over over, double most, nearest *best)
{
  *best = (nearest){
      .face = INT32_MAX, .distance = INFINITY, .most = most, .clear = INFINITY, .over = over};
  if (!p->self && over == ALL_FACES) return 1;
  if (over == SAME_SIDE && !last_normal(p, &p->side->points[i], best->last)) return 0;
  return ct_pass_own_normal(p, i, best->own);
}

/* Try a face if its box is as near as the nearest one. */
CT_INLINE void try_box(const ct_pass *p, int64_t i, int32_t target, const double *start,
                       const double y[3], nearest *best)
{
  const double reach = best->distance < best->most ? best->distance : best->most,
               distance = ct_bounds_distance(&p->other->search->boxes[target], y);
  if (distance <= reach) try_face(p, i, target, start, best);
  else if (distance < best->clear) best->clear = distance;
}

/* Whether a face across an edge faces this one, on a surface in contact with itself. */
static int is_creased(const ct_pass *p, int32_t face)
{
  return p->side->creased != NULL && p->side->creased[face];
}

/* The nearest face of a point, the nearest one that is not on a far side, or the nearest one that
 * faces it, close by (eq:beside-edge). A point in contact searches to any depth for the others,
 * except on its own surface (eq:held). */
static void find_nearest(const ct_pass *p, int64_t i, const double y[3], search_over over,
                         nearest *best)
{
  const ct_side *side = p->side, *other = p->other;
  const ct_point *point = &side->points[i];
  const int32_t face = face_of(p, i);
  int held = point->status == CT_POINT_INSIDE && !p->self && over != FACING;
  double most = p->depth;
  if (point->status == CT_POINT_INSIDE) most -= point->known;
  if (held) most = HUGE_VAL;
  if (over == FACING) most = p->beside;
  if (!begin(p, i, over, most, best)) return;

  // -- Try the face of the last step, then every candidate that may be nearer (eq:closest-face)
  int32_t warm = point->other;
  if (warm >= 0) try_box(p, i, warm, point->xi, y, best);
  for (int32_t k = side->candidate_first[face]; k < side->candidate_first[face + 1]; k++)
    if (side->candidates[k] != warm) try_box(p, i, side->candidates[k], NULL, y, best);
  // -- At a crease the faces across the edges count, too (eq:self-adjacent)
  for (int e = 0; is_creased(p, face) && e < other->search->edges; e++) {
    const int32_t target = other->search->neighbour[(int64_t)face * other->search->edges + e];
    if (target >= 0 && target != warm) try_box(p, i, target, NULL, y, best);
  }
  // -- Deeper than the lists reach: try all faces (eq:held)
  for (int32_t target = 0;
       held && best->distance > side->listed[face] && target < other->search->face_count; target++)
    if (target != warm) try_box(p, i, target, NULL, y, best);
}

/* Whether the point was in contact, or outside over a face that it faces, in the last step. */
static int came_in(const ct_pass *p, int64_t i, const ct_point *point)
{
  double own[3], last[3];
  if (point->status == CT_POINT_INSIDE) return 1;
  return last_normal(p, point, last) && ct_pass_own_normal(p, i, own) &&
         ct_pass_faces_across(own, last);
}

/* The nearest place is on a far side. A point that came in through another side still belongs to
 * that one, unless it has left the body (eq:held). */
static point_class classify_far(const ct_pass *p, int64_t i, const double y[3], nearest *best,
                                ct_point *point)
{
  int has_left = point->row.gap >= 0.0;
  if (p->self || !came_in(p, i, point)) return FAR;
  find_nearest(p, i, y, SAME_SIDE, best);
  if (best->face == INT32_MAX || measure(p, i, best, point) != INSIDE)
    return has_left ? NOWHERE : FAR;
  double along = ct_vector_dot(point->d, best->closest.normal);
  return has_left && along * along < 0.5 * ct_vector_dot(point->d, point->d) ? NOWHERE : INSIDE;
}

/* Whether a corner of the point's own face is less than half as deep under the plane of the point's
 * place as the point itself, so that the face comes out there (eq:beside-edge). */
static int comes_out(const ct_pass *p, int64_t i, const double y[3], const ct_point *point)
{
  const ct_search *search = p->side->search;
  const int32_t *node = &search->faces[(int64_t)face_of(p, i) * search->per];
  const double *d = point->d, *n = point->outward, depth = ct_vector_dot(d, n);
  double least = depth;
  for (int a = 0; a < search->edges; a++) {
    const double *x = &search->x[3 * (int64_t)node[a]];
    const double to[3] = {d[0] - (x[0] - y[0]), d[1] - (x[1] - y[1]), d[2] - (x[2] - y[2])};
    least = fmin(least, ct_vector_dot(to, n));
  }
  return least < 0.5 * depth;
}

/* A point inside, beside the edge of a face that faces it, belongs to that face, and not to the
 * nearest one, which does not face it (eq:beside-edge). */
static void prefer_facing(const ct_pass *p, int64_t i, const double y[3], nearest *best,
                          ct_point *point)
{
  const int held = point->status == CT_POINT_INSIDE;
  double own[3], last[3];
  if (!ct_pass_own_normal(p, i, own) || ct_pass_opposes(own, point->outward)) return;
  if (held && !(last_normal(p, point, last) && ct_pass_opposes(own, last))) return;
  nearest facing;
  ct_point there = *point;
  find_nearest(p, i, y, FACING, &facing);
  if (facing.face == INT32_MAX || measure(p, i, &facing, &there) != INSIDE) return;
  // -- It was there, or its own face comes out through that one (eq:beside-edge)
  if (!held && !comes_out(p, i, y, &there)) return;
  there.jumped = CT_POINT_BESIDE;
  facing.distance = best->distance;
  *best = facing, *point = there;
}

/* Whether a point with nothing near is deep inside the other body in the first call
 * (eq:point-status). */
static int is_buried(const ct_pass *p, const double y[3])
{
  ct_nearest found;
  double normal[3];
  if (p->self || !p->first) return 0;
  ct_search_point(p->other->search, y, -1, HUGE_VAL, p->project.tolerance, NULL, NULL, &found);
  return found.face >= 0 && found.signed_distance < 0.0 &&
         ct_search_normal(p->other->search, found.face, found.where, found.index, found.xi,
                          found.normal, normal);
}

/* The class of a point from its closest point and its status (eq:point-status). */
static point_class classify(const ct_pass *p, int64_t i, const double y[3], nearest *best,
                            ct_point *point)
{
  int buried = point->status == CT_POINT_BURIED;
  if (best->face == INT32_MAX) return buried || is_buried(p, y) ? FAR : NOWHERE;
  point_class found = measure(p, i, best, point);
  if (found == INSIDE && !p->self && !buried) prefer_facing(p, i, y, best, point);
  if (found == FAR) found = classify_far(p, i, y, best, point);
  if (found == INSIDE && (p->self || point->status != CT_POINT_INSIDE) &&
      (buried || point->row.gap < -(p->self ? p->deep : p->depth)))
    found = FAR;
  if (found == FAR && p->self) return NOWHERE;
  if (found == BEYOND && buried) return FAR;
  return found;
}

/* Whether nothing can be near a point: it was over no face, and no face is listed for its own, or
 * since all of these were clear of it they can't have come near (eq:clear-distance); at the very
 * first look it may be deep inside (eq:point-status). */
static int is_alone(const ct_pass *p, int64_t i)
{
  const int32_t *list = &p->side->candidate_first[face_of(p, i)];
  const ct_point *point = &p->side->points[i];
  if (point->other >= 0 || point->status == CT_POINT_INSIDE || p->first ||
      is_creased(p, face_of(p, i)))
    return 0;
  return list[0] == list[1] ||
         (p->side->met[i] < 0 && ct_pass_reached(p, p->depth) < p->side->distant[i]);
}

/* How far all candidates of a point without a face were when the lists were made
 * (eq:clear-distance). */
static void keep_clear(const ct_pass *p, int64_t i, double clear)
{
  p->side->met[i] = -1;
  p->side->distant[i] =
      p->self ? 0.0 : clear - p->since - CT_CLOSEST_POINT_ERROR * p->other->search->size;
}

static void search_point(const ct_pass *p, int64_t i)
{
  ct_point *point = &p->side->points[i];
  nearest best;
  double y[3];
  point->jumped = CT_POINT_NO_JUMP;
  if (is_alone(p, i)) {
    close_point(p, point, point->status == CT_POINT_BURIED ? FAR : NOWHERE, -1, point->xi);
    return;
  }
  ct_side_position(p->side, i, NULL, y);
  find_nearest(p, i, y, ALL_FACES, &best);
  if (best.face == INT32_MAX) keep_clear(p, i, best.clear);
  point_class found = classify(p, i, y, &best, point);
  if (point->jumped == CT_POINT_NO_JUMP && has_jumped(p, i, found, best.face))
    point->jumped = CT_POINT_JUMPED;
  close_point(p, point, found, best.face == INT32_MAX ? -1 : best.face, best.closest.xi);
  // -- Its distance is still that of the nearest place (eq:beside-gap)
  if (point->jumped == CT_POINT_BESIDE) point->known = -best.distance;
}

/* Search for the point `first` and those after it before `end`, at most eight. */
static void search_block(const ct_pass *p, int lanes, int64_t first, int64_t end)
{
  const int count = end - first < CT_WARM ? (int)(end - first) : CT_WARM;
  unsigned settled = lanes ? ct_pass_warm(p, first, count) : 0;
  if (settled == (1u << CT_WARM) - 1) return;
  for (int l = 0; l < count; l++)
    if (!(settled >> l & 1)) search_point(p, first + l);
}

/* Fewest points of a thread: a fraction of a millisecond. */
enum { LEAST_POINTS = 1024 };

/* The points of a run, by several threads. */
static void search_points(const ct_pass *p, int lanes, const ct_span *run, int threads)
{
  (void)threads; // without OpenMP
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static)
#endif
  for (int64_t i = run->first; i < run->end; i += CT_WARM) search_block(p, lanes, i, run->end);
}

void ct_pass_search(ct_gaps *gaps, int s, int wanted)
{
  ct_pass p = {.side = &gaps->side[s],
               .other = &gaps->side[gaps->fixed->sides - 1 - s],
               .project = gaps->fixed->project,
               .near = ct_widest_near_kernel(),
               .depth = ct_gaps_reach(gaps),
               .skin = gaps->fixed->skin,
               .deep = gaps->fixed->depth,
               .beside = gaps->fixed->near / 32.0, // (eq:beside-edge)
               .self = gaps->fixed->sides == 1,
               .first = !gaps->begun};
  p.since = fmax(ct_side_stretch(p.side), ct_side_stretch(p.other)) * gaps->since;
  // On a surface with itself the distance alone does not determine the closest point; other methods
  // have no lanes; and lanes need faces of one kind.
  int lanes = !p.self && p.project.method == CT_ROBUST &&
              p.side->search->kind == p.other->search->kind &&
              (p.other->search->kind == CT_Q4 || p.other->search->kind == CT_Q8);
  for (ct_span run = {0}; ct_side_next(p.side, &run);) {
    const int64_t first = run.first, end = run.end;
    const int threads = ct_threads_for(wanted, end - first, LEAST_POINTS);
    // A region of one thread costs more than the points of a short run.
    if (threads > 1) search_points(&p, lanes, &run, threads);
    else
      for (int64_t i = first; i < end; i += CT_WARM) search_block(&p, lanes, i, end);
  }
}
