/* One pass of the contact: the Gauss points of one side against the faces of the other. */
#include "side.h"

#include "../vector.h"

#include <math.h>
#include <string.h>

/* The nearest face of the other side that a point has found so far. */
typedef struct nearest {
  int32_t face;
  double distance;
  ct_projection foot;
  double origin[3], y[3]; /* the middle of the face's box, and the point relative to it */
  double own[3];          /* unit normal at the point, and how deep it may be: of a surface with itself */
  double depth;
} nearest;

/* What one pass needs everywhere. */
typedef struct pass {
  ct_side *side;
  const ct_side *other;
  ct_project_options project;
  double epsilon, depth;
  int self; /* whether the other side is the same surface */
  ct_pass_purpose purpose;
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

/* In a contact of a surface with itself, whether a foot is one to be pushed from: the faces look at each other, no face at the foot is nearer (one
 * that shares a node with the point's own would not have been tried, eq:local-minimum), and the point is not deeper under it than half the
 * thickness of the body, for then the foot is on the far side (eq:self-depth). The thickness is measured by feet that it is under. */
static int may_push(const pass *p, const nearest *best, const double y[3], int32_t target, const ct_projection *foot)
{
  double normal[3], d[3];
  (void)ct_search_normal(p->other->search, target, foot->where, foot->index, foot->xi, foot->normal, normal);
  for (int c = 0; c < 3; c++) d[c] = foot->point[c] - y[c];
  int under = ct_vector_dot(d, normal) > 0.0;
  // -- The sides of an edge look across, not at each other, however the body bends (eq:self-adjacent)
  double length = sqrt(ct_vector_dot(normal, normal)), facing = p->purpose == CT_PASS_THICKNESS ? 0.0 : -0.25;
  if (!(ct_vector_dot(best->own, normal) < facing * length)) return 0;
  if (!ct_search_is_minimum(p->other->search, target, foot->where, foot->index, foot->xi, d)) return 0;
  return p->purpose == CT_PASS_THICKNESS ? under : !under || foot->distance <= best->depth;
}

/* Project a point on one face of the other side and keep the answer if it is the nearest. */
static void try_face(const pass *p, int32_t face, int q, int32_t target, const double *start, nearest *best)
{
  ct_project_options options = p->project;
  ct_projection foot;
  ct_face shifted;
  double origin[3], y[3];
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
  ct_status status = ct_project(&shifted, y, &options, &foot);
  int found = status == CT_OK || status == CT_NOT_CERTIFIED || status == CT_ITERATION_LIMIT;
  if (!found || foot.where == CT_OUTSIDE || (p->self && !may_push(p, best, y, target, &foot))) return;
  if (foot.distance < best->distance || (foot.distance == best->distance && target < best->face)) {
    best->face = target;
    best->distance = foot.distance;
    best->foot = foot;
    memcpy(best->origin, origin, sizeof origin);
    memcpy(best->y, y, sizeof y);
  }
}

/* Gap vector d = ȳ - y and the signed gap of a point over the face it has found (eq:gap). Returns 0 when the foot lies on the
 * border of the surface, or when the two surfaces do not face each other. */
static int measure(const pass *p, int32_t face, int q, const nearest *best, ct_gauss_point *point)
{
  double foot[3], normal[3], own[3];
  ct_face mine;
  if (!ct_search_normal(p->other->search, best->face, best->foot.where, best->foot.index, best->foot.xi, best->foot.normal, normal)) return 0;
  ct_segment_shape(p->other->search->kind, best->foot.xi, point->N);
  ct_side_interpolate(p->other, best->face, point->N, best->origin, foot);
  for (int c = 0; c < 3; c++) point->d[c] = foot[c] - best->y[c];
  double distance = sqrt(ct_vector_dot(point->d, point->d));
  point->gap = ct_vector_dot(point->d, normal) > 0.0 ? -distance : distance;
  if (point->gap >= 0.0) return 1;
  ct_search_face(p->side->search, face, &mine);
  return ct_segment_normal(&mine, p->side->rule.xi[q], own) == CT_OK && ct_vector_dot(own, normal) < 0.0 && point->gap >= -p->depth;
}

/* Begin with nothing found; a surface in contact with itself needs its own normal first. Answers 0 when there is none. */
static int begin(const pass *p, int32_t face, int q, nearest *best)
{
  ct_face mine;
  *best = (nearest){.face = INT32_MAX, .distance = INFINITY, .depth = p->depth};
  if (!p->self) return 1;
  if (p->purpose == CT_PASS_CONTACT) best->depth = p->side->depth[(int64_t)face * p->side->rule.count + q];
  ct_search_face(p->side->search, face, &mine);
  return ct_segment_normal(&mine, p->side->rule.xi[q], best->own) == CT_OK;
}

static void search_point(const pass *p, int32_t face, int q)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  const ct_side *side = p->side, *other = p->other;
  int64_t number = (int64_t)face * side->rule.count + q;
  ct_gauss_point *point = &p->side->points[number];
  nearest best;
  double y[3];
  int able = begin(p, face, q, &best);
  position(side, face, q, zero, y);

  // -- Try the face of the last step, then every candidate that may be nearer (eq:closest-face)
  int32_t warm = point->other;
  if (able && warm >= 0 && ct_bounds_distance(&other->search->boxes[warm], y) <= p->depth) try_face(p, face, q, warm, point->xi, &best);
  for (int32_t i = side->candidate_first[face]; able && i < side->candidate_first[face + 1]; i++) {
    int32_t target = side->candidates[i];
    double reach = best.distance < p->depth ? best.distance : p->depth;
    if (target != warm && ct_bounds_distance(&other->search->boxes[target], y) <= reach) try_face(p, face, q, target, NULL, &best);
  }

  // -- Force of the point, ½ ε w J d where it is inside (eq:contact-force)
  point->other = -1;
  point->gap = NAN;
  memset(point->force, 0, sizeof point->force);
  if (best.face == INT32_MAX) return;
  if (!measure(p, face, q, &best, point)) {
    point->gap = NAN;
    return;
  }
  point->other = best.face;
  memcpy(point->xi, best.foot.xi, sizeof point->xi);
  if (point->gap < 0.0)
    for (int c = 0; c < 3; c++) point->force[c] = 0.5 * p->epsilon * side->weight[number] * point->d[c];
}

void ct_pass_search(ct_side *side, const ct_side *other, const ct_contact_options *options, double depth, ct_pass_purpose purpose)
{
  pass p = {side, other, ct_project_options_default(), options->epsilon, depth, side == other, purpose};
  p.project.method = options->method;
  p.project.tolerance = options->tolerance;
#ifdef _OPENMP
#pragma omp parallel for num_threads(options->threads) schedule(static) if (options->threads > 1)
#endif
  for (int32_t f = 0; f < side->search->face_count; f++)
    for (int q = 0; q < side->rule.count; q++) search_point(&p, f, q);
}
