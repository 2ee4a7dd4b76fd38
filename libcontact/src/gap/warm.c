/* Eight points of a contact side by side, each with its face of the last step. */
#include "pass.h"

#include "../base/lanes.h"
#include "../shape/shape.h"

#include <libcontact/batch.h>

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

/* Eight points with all their results. Numbers of one kind lie side by side, one lane per point;
 * the longer ones come first, so that all are aligned. */
typedef struct block {
  double origin[3 * CT_WARM]; /* middle of the face's box: subtracted from the positions and the
                                 nodes */
  double nodes[24 * CT_WARM]; /* of the face of the last step, shape (per, 3, lanes) */
  double points[3 * CT_WARM], start[2 * CT_WARM], known[CT_WARM], unused[CT_WARM];
  double xi[2 * CT_WARM], normal[3 * CT_WARM];
  double N[8 * CT_WARM], d[3 * CT_WARM], gap[CT_WARM], /* as in ct_point */
      direction[3 * CT_WARM];                          /* gap vector over minus the gap */
  double own[3 * CT_WARM], back[3 * CT_WARM], /* motion of the points and of their closest points
                                                 since the last update, ... */
      along[CT_WARM];                         /* ... and of one relative to the other */
  int64_t last[CT_WARM];                      /* its status and jump */
  int32_t face[CT_WARM], target[CT_WARM], q[CT_WARM];
  int rival[CT_WARM]; /* whether another face may be as near, or its own has no closest point */
  int64_t number;     /* of the first point */
  int count;          /* of points; the other lanes repeat one of them */
  int one[2];         /* whether four lanes meet one face */
  int rivals;         /* whether a lane has one */
} block;

/* Σ_a N_a x_a of eight faces, shape (per, 3, lanes) of x, in the order of ct_side_sum. */
CT_INLINE void sum_lanes(int per, const double *N, const double *x, double *out)
{
  for (int c = 0; c < 3; c++) {
    const double *t = &x[CT_WARM * c];
#pragma omp simd
    for (int l = 0; l < CT_WARM; l++) {
      double sum =
          (N[l] * t[l] + N[8 + l] * t[24 + l]) + (N[16 + l] * t[48 + l] + N[24 + l] * t[72 + l]);
      if (per == 8)
        sum += (N[32 + l] * t[96 + l] + N[48 + l] * t[144 + l]) +
               (N[40 + l] * t[120 + l] + N[56 + l] * t[168 + l]);
      out[CT_WARM * c + l] = sum;
    }
  }
}

/* Middle of a box; a fourth number has no meaning. */
CT_INLINE void middle_of(const ct_bounds *box, double middle[4])
{
#if CT_ROWS
  const double *low = (const double *)(const void *)box;
  const ct_quad last = *(const ct_quad *)(low + 2);
  *(ct_quad *)middle = 0.5 * (*(const ct_quad *)low + CT_PICK(last, last, 1, 2, 3, 3));
#else
  for (int c = 0; c < 3; c++) middle[c] = 0.5 * (box->low[c] + box->high[c]);
#endif
}

/* Σ_a N_a (x_a - origin) of four lanes on one face, in the order of ct_side_sum; null: of 0.
 * Inlined with a known `per`, as below. */
CT_INLINE void sum_one(int per, const int64_t *node, const double *x, const double *N, int stride,
                       const double *origin, double *out)
{
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 4; k += 4 / CT_QUAD_PARTS) {
      const ct_quad none = {0.0}, from = origin ? *(const ct_quad *)&origin[CT_WARM * c + k] : none;
      ct_quad t[8];
      for (int a = 0; a < per; a++)
        t[a] = *(const ct_quad *)&N[stride * a + k] * ((&x[node[a]])[c] - from);
      ct_sum_face(per, t, (ct_quad *)&out[CT_WARM * c + k]);
    }
}

/* The same of four lanes, each on its face; N_a of lane k is N[k][stride a]. */
CT_INLINE void sum_four(int per, const ct_search *search, const double *x, const int32_t *face,
                        const double *const N[4], int stride, const double *origin, double *out)
{
  double rows[4][4], unused[4];
  for (int k = 0; k < 4; k++) {
    double from[4] = {0.0};
    for (int c = 0; origin && c < 3; c++) from[c] = origin[CT_WARM * c + k];
    const int32_t *node = &search->faces[(int64_t)face[k] * per];
    for (int c = 0; c < 4; c += 4 / CT_QUAD_PARTS) {
      ct_quad t[8];
      for (int a = 0; a < per; a++)
        t[a] = N[k][stride * a] *
               (*(const ct_quad *)&x[3 * (int64_t)node[a] + c] - *(const ct_quad *)&from[c]);
      ct_sum_face(per, t, (ct_quad *)&rows[k][c]);
    }
  }
  ct_turn((const double *const[4]){rows[0], rows[1], rows[2], rows[3]},
          (double *const[4]){out, out + CT_WARM, out + 2 * CT_WARM, unused});
}

/* Places of the coordinates of a face's nodes. */
CT_INLINE void list_nodes(const ct_search *search, int per, int32_t face, int64_t node[8])
{
  for (int a = 0; a < per; a++) node[a] = 3 * (int64_t)search->faces[(int64_t)face * per + a];
}

/* The middle of the box of each of four lanes' faces, and the face's nodes relative to it. */
CT_INLINE void load_four(const ct_search *search, int per, int l, block *b)
{
  double middle[4][4] = {{0.0}}, x[4][4], unused[4];
  const int32_t *node[4];
  for (int k = 0; k < 4; k++) {
    node[k] = &search->faces[(int64_t)b->target[l + k] * per];
    middle_of(&search->boxes[b->target[l + k]], middle[k]);
    for (int c = 0; c < 3; c++) b->origin[CT_WARM * c + l + k] = middle[k][c];
  }
  for (int a = 0; a < per; a++) {
    double *to = &b->nodes[3 * CT_WARM * a + l];
    for (int k = 0; k < 4; k++)
#pragma omp simd
      for (int c = 0; c < 4; c++) x[k][c] = search->x[3 * (int64_t)node[k][a] + c] - middle[k][c];
    ct_turn((const double *const[4]){x[0], x[1], x[2], x[3]},
            (double *const[4]){to, to + CT_WARM, to + 2 * CT_WARM, unused});
  }
}

/* The same if all have one face. */
CT_INLINE void load_one(const ct_search *search, int per, int l, block *b)
{
  const double *x = search->x;
  int64_t node[8];
  double middle[4] = {0.0};
  list_nodes(search, per, b->target[l], node);
  middle_of(&search->boxes[b->target[l]], middle);
  for (int c = 0; c < 3; c++)
    for (int k = l; k < l + 4; k += 4 / CT_QUAD_PARTS) {
      const ct_quad none = {0.0}, from = middle[c] - none;
      *(ct_quad *)&b->origin[CT_WARM * c + k] = from;
      for (int a = 0; a < per; a++)
        *(ct_quad *)&b->nodes[CT_WARM * (3 * a + c) + k] = (&x[node[a]])[c] - from;
    }
}

/* Positions of four points relative to the middle of the box, and their motions; `whole`: they are
 * consecutive points of a face. */
CT_INLINE void load_own(const ct_pass *p, int per, int whole, int l, block *b)
{
  const ct_search *search = p->side->search;
  const double *N = p->side->fixed->across[0], *x = search->x, *moved = p->side->moved;
  const int32_t *q = &b->q[l];
  if (whole) {
    int64_t node[8];
    list_nodes(search, per, b->face[l], node);
    N += q[0];
    sum_one(per, node, x, N, 32, &b->origin[l], &b->points[l]);
    sum_one(per, node, moved, N, 32, NULL, &b->own[l]);
  } else {
    const double *const of[4] = {&N[q[0]], &N[q[1]], &N[q[2]], &N[q[3]]};
    sum_four(per, search, x, &b->face[l], of, 32, &b->origin[l], &b->points[l]);
    sum_four(per, search, moved, &b->face[l], of, 32, NULL, &b->own[l]);
  }
}

/* Four numbers of each of `count` points, one or four, from a member on, as lanes; and back. */
CT_INLINE void read_numbers(size_t member, int count, const ct_point *point, double *const to[4])
{
  const double *from[4];
  for (int i = 0; i < count; i++)
    from[i] = (const double *)(const void *)((const char *)&point[i] + member);
  if (count == 4) ct_turn(from, to);
  for (int k = 0; count == 1 && k < 4; k++) *to[k] = from[0][k];
}

CT_INLINE void write_numbers(const double *const from[4], int count, size_t member, ct_point *point)
{
  double *to[4];
  for (int i = 0; i < count; i++) to[i] = (double *)(void *)((char *)&point[i] + member);
  if (count == 4) ct_turn(from, to);
  for (int k = 0; count == 1 && k < 4; k++) to[0][k] = *from[k];
}

/* The lanes without a face repeat one of the others; returns one bit for each of these. */
CT_INLINE unsigned repeat_points(int count, block *b)
{
  unsigned warm = 0;
  int some = -1;
  for (int l = 0; l < count; l++)
    if (b->target[l] >= 0) warm |= 1u << l, some = l;
  for (int l = 0; l < CT_WARM && some >= 0; l++) {
    if (warm >> l & 1) continue;
    b->face[l] = b->face[some], b->q[l] = b->q[some], b->target[l] = b->target[some];
    b->last[l] = b->last[some];
    for (int a = 0; a < 2; a++) b->start[8 * a + l] = b->start[8 * a + some];
  }
  return warm;
}

/* Load the points into lanes. Returns one bit for each point with a face. */
CT_INLINE unsigned take_points(const ct_pass *p, int64_t first, int count, block *restrict b)
{
  const int32_t points = p->side->fixed->rule.count, q = (int32_t)(first % points);
  const int32_t face = (int32_t)(first / points);
  const ct_point *point = &p->side->points[first];
  int32_t signs = 0;
  b->number = first, b->count = count;
  for (int l = 0; l < CT_WARM; l++) {
    // A face of four nodes or more has four points at least.
    const int32_t more = (q + l >= points) + (q + l >= 2 * points);
    b->face[l] = face + more, b->q[l] = q + l - more * points;
  }
  for (int l = 0; l < count; l++) {
    b->target[l] = point[l].other;
    memcpy(&b->last[l], &point[l].status, sizeof b->last[l]);
    signs |= point[l].other;
  }
  for (int l = 0; l < count; l += l + 4 <= count ? 4 : 1) {
    double *const to[4] = {&b->start[l], &b->start[CT_WARM + l], &b->known[l], &b->unused[l]};
    if (l + 4 <= count) read_numbers(offsetof(ct_point, xi), 4, &point[l], to);
    else read_numbers(offsetof(ct_point, xi), 1, &point[l], to);
  }
  return signs >= 0 && count == CT_WARM ? (1u << CT_WARM) - 1 : repeat_points(count, b);
}

/* The last faces of the points of `warm`, their positions and motions. Inlined with a known `per`.
 */
CT_INLINE void load_block(const ct_pass *p, int per, unsigned warm, block *b)
{
  for (int h = 0, l = 0; h < 2; h++, l += 4) {
    const int32_t *face = &b->face[l], *to = &b->target[l];
    b->one[h] = to[0] == to[1] && to[0] == to[2] && to[0] == to[3];
    if (b->one[h]) load_one(p->other->search, per, l, b);
    else load_four(p->other->search, per, l, b);
    load_own(p, per, face[0] == face[3] && (warm >> l & 15) == 15, l, b);
  }
}

/* Gap vectors d = ȳ - y and signed gaps of the points at their closest points (eq:gap). Inlined
 * with a known `per`. */
CT_INLINE void gaps(int per, block *b)
{
  double closest[3 * CT_WARM];
#pragma omp simd
  for (int l = 0; l < CT_WARM; l++)
    ct_shape_quadrilateral(per, b->xi[l], b->xi[CT_WARM + l], &b->N[l], CT_WARM);
  sum_lanes(per, b->N, b->nodes, closest);
#pragma omp simd
  for (int l = 0; l < CT_WARM; l++) {
    const double *n = &b->normal[l];
    double x = closest[l] - b->points[l], y = closest[8 + l] - b->points[8 + l],
           z = closest[16 + l] - b->points[16 + l], distance = sqrt((x * x + y * y) + z * z),
           back = (x * n[0] + y * n[8]) + z * n[16] > 0.0 ? distance : -distance;
    b->gap[l] = -back;
    b->d[l] = x, b->d[8 + l] = y, b->d[16 + l] = z;
    b->direction[l] = x / back, b->direction[8 + l] = y / back, b->direction[16 + l] = z / back;
  }
}

/* Motion of the points relative to their closest points along the direction of the gap. Inlined
 * with a known `per`. */
CT_INLINE void find_motion(const ct_pass *p, int per, block *b)
{
  const ct_search *search = p->other->search;
  for (int h = 0, l = 0; h < 2; h++, l += 4) {
    const double *N = &b->N[l];
    if (b->one[h]) {
      int64_t node[8];
      list_nodes(search, per, b->target[l], node);
      sum_one(per, node, p->other->moved, N, CT_WARM, NULL, &b->back[l]);
    } else
      sum_four(per, search, p->other->moved, &b->target[l],
               (const double *const[4]){N, N + 1, N + 2, N + 3}, CT_WARM, NULL, &b->back[l]);
  }
#pragma omp simd
  for (int l = 0; l < CT_WARM; l++) {
    const double *n = &b->direction[l], *u = &b->own[l], *v = &b->back[l];
    // -- n·(Σ_a N_a u_a - Σ_b N̄_b u_b) (eq:admitted-store)
    b->along[l] = (n[0] * (u[0] - v[0]) + n[8] * (u[8] - v[8])) + n[16] * (u[16] - v[16]);
  }
}

/* Twice the distance of a coordinate outside a box, without a branch: it cannot be on both sides.
 */
CT_INLINE double twice_outside(double low, double high, double x)
{
  double under = low - x, over = x - high;
  return (under + fabs(under)) + (over + fabs(over));
}

/* Some consecutive lanes with one face, and the largest distance to which one of them searches;
 * negative: none does. */
typedef struct lane_group {
  int first, end;
  double most;
} lane_group;

/* The group that begins with a lane; four times the square of the distance to which each searches
 * is at most `most`, and negative for lanes that do not search. */
CT_INLINE lane_group group_from(const block *b, int first, const double *most)
{
  lane_group g = {.first = first, .end = first, .most = -1.0};
  double top = -1.0;
  for (; g.end < CT_WARM && b->face[g.end] == b->face[first]; g.end++)
    top = most[g.end] > top ? most[g.end] : top;
  // Slightly more than the reach of any lane, so that the test of a box excludes no rival.
  if (top >= 0.0) g.most = (0.5 + 1e-12) * sqrt(top);
  return g;
}

/* The box of the places within the reach of a group. */
CT_INLINE ct_bounds reach_box(const lane_group *g, const double *at)
{
  ct_bounds box;
  for (int c = 0; c < 3; c++) {
    const double *x = &at[CT_WARM * c];
    box.low[c] = box.high[c] = x[g->first];
    for (int l = g->first + 1; l < g->end; l++) {
      box.low[c] = x[l] < box.low[c] ? x[l] : box.low[c];
      box.high[c] = x[l] > box.high[c] ? x[l] : box.high[c];
    }
  }
  return ct_bounds_grown(&box, g->most);
}

/* Whether a face may be as near to the place of a lane as its closest point. */
static int is_near(const ct_search *search, int32_t face, const double *at, double most)
{
  const double y[3] = {at[0], at[CT_WARM], at[2 * CT_WARM]};
  ct_face nodes;
  ct_search_face(search, face, &nodes);
  return !ct_face_is_beyond(&nodes, y, 0.5 * sqrt(most));
}

/* Mark the lanes of a group that may be as near to a face as to their closest point on another. */
CT_INLINE void mark_rivals(const lane_group *g, const ct_search *search, int32_t face,
                           const double *at, const double *most, block *b)
{
  const ct_bounds *box = &search->boxes[face];
  int near[CT_WARM];
#pragma omp simd
  for (int l = 0; l < CT_WARM; l++) {
    double x = twice_outside(box->low[0], box->high[0], at[l]),
           y = twice_outside(box->low[1], box->high[1], at[8 + l]),
           z = twice_outside(box->low[2], box->high[2], at[16 + l]);
    near[l] = ((x * x + y * y) + z * z <= most[l]) & (face != b->target[l]) & !b->rival[l];
  }
  for (int l = g->first; l < g->end; l++)
    if (near[l]) b->rivals |= b->rival[l] = is_near(search, face, &at[l], most[l]);
}

/* The distance to which a lane searches for other faces, with a margin for rounding. */
CT_INLINE double lane_reach(const ct_pass *p, const block *b, int l)
{
  const double x = b->points[l] + b->origin[l], y = b->points[8 + l] + b->origin[8 + l],
               z = b->points[16 + l] + b->origin[16 + l], distance = fabs(b->gap[l]),
               reach = distance < p->depth ? distance : p->depth;
  return reach + 16.0 * DBL_EPSILON * ((fabs(x) + fabs(y)) + (fabs(z) + reach));
}

/* Mark the points of a block to which a face other than the last one may be nearer than the closest
 * point, by all candidates of their faces. */
CT_CLONES_NODES
static void search_rivals(const ct_pass *p, const int32_t *met, const double *distant, block *b)
{
  double at[3 * CT_WARM], most[CT_WARM];
  for (int l = 0; l < CT_WARM; l++) {
    const double reach = lane_reach(p, b, l);
    const int alone = met[l] == b->target[l] && distant[l] - ct_pass_reached(p, reach) > 0.0;
    // Lanes beyond `count` repeat others.
    most[l] = alone || l >= b->count ? -1.0 : 4.0 * (reach * reach);
    for (int c = 0; c < 24; c += 8) at[c + l] = b->points[c + l] + b->origin[c + l];
  }
  for (lane_group g = {0}; g.end < CT_WARM;) {
    g = group_from(b, g.end, most);
    if (g.most < 0.0) continue;
    const int32_t face = b->face[g.first];
    const ct_bounds reach = reach_box(&g, at);
    // A face within a quarter of the skin was within the skin when the lists were made (eq:skin).
    const int32_t end =
        g.most <= 0.25 * p->skin ? p->side->near_end[face] : p->side->candidate_first[face + 1];
    for (int32_t i = p->side->candidate_first[face]; i < end; i++) {
      const int32_t rival = p->side->candidates[i];
      // Most candidates are beyond the reach of the whole group.
      if (!ct_bounds_apart(&p->other->search->boxes[rival], &reach))
        mark_rivals(&g, p->other->search, rival, at, most, b);
    }
  }
}

/* Find the points to which a face other than the last one may be nearer than the closest point.
 * With a margin for the rounding of positions, so some points are found unnecessarily. */
CT_INLINE void find_rivals(const ct_pass *p, block *b)
{
  const int32_t *met = &p->side->met[b->number];
  const double *distant = &p->side->distant[b->number];
  int64_t few = 0;
#pragma omp simd reduction(| : few)
  for (int l = 0; l < CT_WARM; l++)
    // -- What is left of the distance of all other faces when they were listed (eq:rival-distance)
    few |= !(distant[l] - ct_pass_reached(p, lane_reach(p, b, l)) > 0.0);
  if (few != 0 || memcmp(met, b->target, sizeof b->target) != 0) search_rivals(p, met, distant, b);
}

/* Whether the closest point of a lane is inside its last face, within the allowed depth. */
CT_INLINE int is_inside(const ct_pass *p, const block *b, int l)
{
  const double inside = 1.0 - p->project.tolerance;
  return (fabs(b->xi[l]) < inside) & (fabs(b->xi[8 + l]) < inside) &
         (fabs(b->gap[l]) < (1.0 - 1e-9) * p->depth);
}

/* Status and jump of a point with a gap at its last face, as one number. */
CT_INLINE int64_t state_of(double gap)
{
  const int32_t inside[2] = {CT_POINT_INSIDE, CT_POINT_NO_JUMP},
                outside[2] = {CT_POINT_OUTSIDE, CT_POINT_NO_JUMP};
  int64_t in, out;
  memcpy(&in, inside, sizeof in);
  memcpy(&out, outside, sizeof out);
  return gap < 0.0 ? in : out;
}

/* Whether all closest points are inside their last faces with no other face as near, none coincides
 * with its point, and no point changes its state. */
CT_INLINE int is_steady(const ct_pass *p, const block *b)
{
  const double coincident = ct_side_coincident(p->side);
  int64_t change = 0;
#pragma omp simd reduction(| : change)
  for (int l = 0; l < CT_WARM; l++)
    change |=
        (b->last[l] ^ state_of(b->gap[l])) | !is_inside(p, b, l) | !(fabs(b->gap[l]) > coincident);
  return change == 0 && !b->rivals;
}

/* Whether the point of a lane comes in from a side that does not face its face: then the search
 * must classify it, and may prefer another one (eq:beside-edge). */
static int is_strange(const ct_pass *p, const block *b, int l, int64_t number)
{
  const double normal[3] = {b->normal[l], b->normal[8 + l], b->normal[16 + l]};
  double own[3];
  return b->gap[l] < 0.0 && p->side->points[number].status != CT_POINT_INSIDE &&
         !(ct_pass_own_normal(p, number, own) && ct_pass_opposes(own, normal));
}

/* A member between these does not compile. */
typedef char members_follow_on_each_other
    [offsetof(ct_point, row.gap) == offsetof(ct_point, row.normal) + 3 * sizeof(double) &&
             offsetof(ct_point, along) == offsetof(ct_point, d) + 3 * sizeof(double) &&
             offsetof(ct_point, xi) == offsetof(ct_point, last_known) + sizeof(double) &&
             offsetof(ct_point, known) == offsetof(ct_point, xi) + 2 * sizeof(double) &&
             offsetof(ct_point, jumped) == offsetof(ct_point, status) + sizeof(int32_t)
         ? 1
         : -1];

/* Store the results of `count` points from a lane on, one or four. Inlined with known numbers. */
CT_INLINE void write_lanes(const block *b, int per, int count, int l, ct_point *point)
{
  const double *n = &b->direction[l], *d = &b->d[l], *gap = &b->gap[l], *N = &b->N[l];
  write_numbers((const double *const[4]){n, n + CT_WARM, n + 2 * CT_WARM, gap}, count,
                offsetof(ct_point, row.normal), point);
  write_numbers((const double *const[4]){d, d + CT_WARM, d + 2 * CT_WARM, &b->along[l]}, count,
                offsetof(ct_point, d), point);
  for (size_t a = 0; a < (size_t)per; a += 4, N += 4 * CT_WARM)
    write_numbers((const double *const[4]){N, N + CT_WARM, N + 2 * CT_WARM, N + 3 * CT_WARM}, count,
                  offsetof(ct_point, N) + a * sizeof *N, point);
  write_numbers((const double *const[4]){&b->known[l], &b->xi[l], &b->xi[CT_WARM + l], gap}, count,
                offsetof(ct_point, last_known), point);
}

/* Store the state of a point, and its direction if it coincides with its closest point. */
static void write_state(const ct_pass *p, const block *b, int l, ct_point *point)
{
  const int64_t state = state_of(b->gap[l]);
  memcpy((char *)point + offsetof(ct_point, status), &state, sizeof state);
  if (fabs(b->gap[l]) > ct_side_coincident(p->side)) return;
  double motion[3];
  for (int c = 0, k = l; c < 3; c++, k += CT_WARM)
    motion[c] = b->own[k] - b->back[k], point->outward[c] = b->normal[k];
  ct_side_direct(p->side, point);
  point->along = ct_vector_dot(point->row.normal, motion);
}

/* The lanes of `warm` whose points are settled, one by one. */
static unsigned find_settled(const ct_pass *p, const block *b, unsigned warm)
{
  unsigned settled = 0;
  for (int l = 0; l < CT_WARM; l++)
    // -- Inside its face, and no other face is as near (eq:warm-lanes)
    if ((warm >> l & 1) && is_inside(p, b, l) && !b->rival[l] &&
        !is_strange(p, b, l, b->number + l))
      settled |= 1u << l;
  return settled;
}

/* Store the results of the lanes whose points are settled, of those in `warm`; returns their bits.
 * Inlined with a known `per`. */
CT_INLINE unsigned write_points(const ct_pass *p, const block *b, int per, unsigned warm)
{
  const int steady = is_steady(p, b);
  const unsigned settled = steady ? warm : find_settled(p, b, warm);
  ct_point *points = &p->side->points[b->number];
  for (int h = 0; h < CT_WARM; h += 4)
    if ((settled >> h & 15) == 15) write_lanes(b, per, 4, h, &points[h]);
    else
      for (int l = h; l < h + 4; l++)
        if (settled >> l & 1) write_lanes(b, per, 1, l, &points[l]);
  for (int l = 0; l < CT_WARM && !steady; l++)
    if (settled >> l & 1) write_state(p, b, l, &points[l]);
  return settled;
}

/* Closest points of all lanes by the search; returns 0 if there are none. */
static int project_all(const ct_pass *p, block *b)
{
  int32_t status[CT_WARM];
  const ct_batch_closest closest = {.xi = b->xi, .normal = b->normal, .status = status};
  if (ct_project_batch(p->other->search->kind, CT_WARM, b->nodes, b->points, b->start, &p->project,
                       &closest, NULL) != CT_OK)
    return 0;
  for (int l = 0; l < CT_WARM; l++)
    b->rivals |= b->rival[l] =
        status[l] != CT_OK && status[l] != CT_NOT_CERTIFIED && status[l] != CT_ITERATION_LIMIT;
  return 1;
}

/* The same; most are near their starts. Inlined with a known `per`. */
CT_INLINE int project_block(const ct_pass *p, int per, block *b)
{
  memset(b->rival, 0, sizeof b->rival);
  b->rivals = 0;
  return (per == 4 && p->project.iteration_limit == 0 &&
          p->near(b->nodes, b->points, b->start, &p->project, b->xi, b->normal) ==
              (1u << CT_WARM) - 1) ||
         project_all(p, b);
}

/* Complete the points of `warm`; returns the bits of those that are settled. Inlined with a known
 * `per`. */
CT_INLINE unsigned complete(const ct_pass *p, int per, unsigned warm, block *b)
{
  load_block(p, per, warm, b);
  if (!project_block(p, per, b)) return 0;
  gaps(per, b);
  find_rivals(p, b);
  find_motion(p, per, b);
  return write_points(p, b, per, warm);
}

CT_CLONES
unsigned ct_pass_warm(const ct_pass *p, int64_t first, int count)
{
  block b;
  const unsigned warm =
      count == CT_WARM ? take_points(p, first, CT_WARM, &b) : take_points(p, first, count, &b);
  if (warm == 0) return 0;
  return p->side->search->per == 4 ? complete(p, 4, warm, &b) : complete(p, 8, warm, &b);
}
