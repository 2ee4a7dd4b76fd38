/* Eight points of a contact side by side, each with its face of the last step. */
#include "pass.h"

#include "../base/lanes.h"
#include "../shape/shape.h"

#include <libcontact/batch.h>

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

/* Eight points with all their results. Numbers of one kind lie side by side, one lane per point. */
typedef struct block {
  int32_t face[CT_WARM], target[CT_WARM], q[CT_WARM];
  int64_t number;             /* of the first point */
  int count;                  /* of points; the other lanes repeat one of them */
  double origin[3 * CT_WARM]; /* middle of the face's box: subtracted from the positions and the
                                 nodes */
  double nodes[24 * CT_WARM]; /* of the face of the last step, shape (per, 3, lanes) */
  double points[3 * CT_WARM], start[2 * CT_WARM], known[CT_WARM], unused[CT_WARM];
  double xi[2 * CT_WARM], distance[CT_WARM], normal[3 * CT_WARM];
  int32_t status[CT_WARM];
  double N[8 * CT_WARM], d[3 * CT_WARM], gap[CT_WARM], /* as in ct_point */
      direction[3 * CT_WARM];                          /* gap vector over minus the gap */
  double along[CT_WARM];
  int four[2]; /* whether four lanes each are loaded together (are_four) */
  ct_point_status last[CT_WARM],
      next[CT_WARM];   /* its status, and if its last face is the nearest */
  int rival[CT_WARM];  /* whether another face may be as near */
  int inside[CT_WARM]; /* whether its last face is the nearest one */
  int enters[CT_WARM]; /* whether it comes into contact */
  int sure;            /* whether all lanes are inside, and none enters */
  int touches;         /* whether a point coincides with its closest point */
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

/* Whether four lanes from a multiple of four on have one face: then its numbers are loaded once. */
CT_INLINE int are_one(const int32_t face[CT_WARM], int l)
{
  return l % 4 == 0 && face[l] == face[l + 1] && face[l] == face[l + 2] && face[l] == face[l + 3];
}

/* Write a number to the first `count` lanes from `row` on. */
CT_INLINE void put(int count, double x, double *row)
{
  for (int l = 0; l < count; l++) row[l] = x;
}

/* Numbers of the nodes of a face, to the first `count` lanes from `nodes` on. */
CT_INLINE void load_face(const ct_search *search, int per, int count, int32_t face, double *nodes)
{
  const int32_t *node = &search->faces[(int64_t)face * per];
  for (int a = 0; a < per; a++)
    for (int c = 0; c < 3; c++)
      put(count, search->x[3 * (int64_t)node[a] + c], &nodes[CT_WARM * (3 * a + c)]);
}

/* Nodes of eight faces, relative to eight origins. */
CT_INLINE void load_faces(const ct_search *search, int per, const int32_t face[CT_WARM],
                          const double *origin, double *nodes)
{
  for (int l = 0, next; l < CT_WARM; l = next) {
    next = are_one(face, l) ? l + 4 : l + 1;
    if (next == l + 4) load_face(search, per, 4, face[l], &nodes[l]);
    else load_face(search, per, 1, face[l], &nodes[l]);
  }
  for (int i = 0; i < 3 * per; i++)
#pragma omp simd
    for (int l = 0; l < CT_WARM; l++) nodes[CT_WARM * i + l] -= origin[CT_WARM * (i % 3) + l];
}

/* Whether four lanes from a multiple of four on, of those in `warm`, are the points of one face
 * with four nodes and a 2 x 2 rule, and have one target. */
CT_INLINE int are_four(const ct_pass *p, const block *b, unsigned warm, int l)
{
  return p->side->fixed->rule.count == 4 && p->side->search->per == 4 && (warm >> l & 15) == 15 &&
         are_one(b->target, l);
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

/* The four nodes of a face relative to a place, each with a number behind it. */
CT_INLINE void take_nodes(const ct_search *search, int32_t face, const double middle[4],
                          double x[4][4])
{
  const int32_t *node = &search->faces[4 * (int64_t)face];
  for (int a = 0; a < 4; a++)
#pragma omp simd
    for (int c = 0; c < 4; c++) x[a][c] = search->x[3 * (int64_t)node[a] + c] - middle[c];
}

/* Positions of such points and of their last face, relative to the middle of its box. */
CT_INLINE void load_four(const ct_pass *p, int l, block *b)
{
  const double (*N)[32] = p->side->fixed->across;
  double middle[4] = {0.0}, theirs[4][4], own[4][4];
  middle_of(&p->other->search->boxes[b->target[l]], middle);
  take_nodes(p->other->search, b->target[l], middle, theirs);
  take_nodes(p->side->search, b->face[l], middle, own);
  for (int c = 0; c < 3; c++) {
    put(4, middle[c], &b->origin[CT_WARM * c + l]);
    for (int a = 0; a < 4; a++) put(4, theirs[a][c], &b->nodes[CT_WARM * (3 * a + c) + l]);
#pragma omp simd
    for (int k = 0; k < 4; k++)
      b->points[CT_WARM * c + l + k] =
          (N[0][k] * own[0][c] + N[1][k] * own[1][c]) + (N[2][k] * own[2][c] + N[3][k] * own[3][c]);
  }
}

/* Positions of the points and of their last faces, both relative to the middle of the face's box.
 * Inlined with a known `per`. */
CT_INLINE void load(const ct_pass *p, int per, block *b)
{
  double own[24 * CT_WARM], N[8 * CT_WARM];
  for (int l = 0, next; l < CT_WARM; l = next) {
    const ct_bounds *box = &p->other->search->boxes[b->target[l]];
    next = are_one(b->target, l) ? l + 4 : l + 1;
    for (int c = 0; c < 3; c++) {
      const double middle = 0.5 * (box->low[c] + box->high[c]);
      if (next == l + 4) put(4, middle, &b->origin[CT_WARM * c + l]);
      else put(1, middle, &b->origin[CT_WARM * c + l]);
    }
  }
  for (int l = 0; l < CT_WARM; l++)
    for (int a = 0; a < per; a++) N[CT_WARM * a + l] = p->side->fixed->N[b->q[l]][a];
  load_faces(p->other->search, per, b->target, b->origin, b->nodes);
  load_faces(p->side->search, per, b->face, b->origin, own);
  sum_lanes(per, N, own, b->points);
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
CT_INLINE unsigned take_points(const ct_pass *p, int64_t first, int count, block *b)
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
    b->last[l] = point[l].status;
    signs |= point[l].other;
  }
  for (int l = 0, next; l < count; l = next) {
    double *const to[4] = {&b->start[l], &b->start[CT_WARM + l], &b->known[l], &b->unused[l]};
    next = l % 4 == 0 && l + 4 <= count ? l + 4 : l + 1;
    if (next == l + 4) read_numbers(offsetof(ct_point, xi), 4, &point[l], to);
    else read_numbers(offsetof(ct_point, xi), 1, &point[l], to);
  }
  return signs >= 0 && count == CT_WARM ? (1u << CT_WARM) - 1 : repeat_points(count, b);
}

CT_CLONES
static unsigned load_block(const ct_pass *p, int64_t first, int count, block *b)
{
  const unsigned warm =
      count == CT_WARM ? take_points(p, first, CT_WARM, b) : take_points(p, first, count, b);
  if (warm == 0) return 0;
  b->four[0] = are_four(p, b, warm, 0), b->four[1] = are_four(p, b, warm, 4);
  if (b->four[0] && b->four[1]) {
    load_four(p, 0, b);
    load_four(p, 4, b);
  } else if (p->side->search->per == 4) load(p, 4, b);
  else load(p, 8, b);
  return warm;
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
           z = closest[16 + l] - b->points[16 + l], distance = sqrt((x * x + y * y) + z * z);
    b->gap[l] = (x * n[0] + y * n[8]) + z * n[16] > 0.0 ? -distance : distance;
    const double back = -b->gap[l];
    b->d[l] = x, b->d[8 + l] = y, b->d[16 + l] = z;
    b->direction[l] = x / back, b->direction[8 + l] = y / back, b->direction[16 + l] = z / back;
  }
}

/* Σ_a N_a u_a of four lanes from one number u for each node. */
CT_INLINE void sum_nodes(const double *N, int stride, const double *const u[4], int c, double *out)
{
  for (int k = 0; k < 4; k += 4 / CT_QUAD_PARTS)
    *(ct_quad *)&out[k] =
        (*(const ct_quad *)&N[k] * u[0][c] + *(const ct_quad *)&N[stride + k] * u[1][c]) +
        (*(const ct_quad *)&N[2 * stride + k] * u[2][c] +
         *(const ct_quad *)&N[3 * stride + k] * u[3][c]);
}

/* Motion of the points of four lanes that are loaded together, relative to their closest points,
 * along the direction of the gap. */
CT_INLINE void move_four(const ct_pass *p, int l, block *b)
{
  const int32_t *theirs = &p->other->search->faces[4 * (int64_t)b->target[l]],
                *mine = &p->side->search->faces[4 * (int64_t)b->face[l]];
  const double *const own[4] = {
      &p->side->moved[3 * (int64_t)mine[0]], &p->side->moved[3 * (int64_t)mine[1]],
      &p->side->moved[3 * (int64_t)mine[2]], &p->side->moved[3 * (int64_t)mine[3]]};
  const double *const other[4] = {
      &p->other->moved[3 * (int64_t)theirs[0]], &p->other->moved[3 * (int64_t)theirs[1]],
      &p->other->moved[3 * (int64_t)theirs[2]], &p->other->moved[3 * (int64_t)theirs[3]]};
  double u[3][4], v[3][4];
  for (int c = 0; c < 3; c++) {
    sum_nodes(p->side->fixed->across[0], 32, own, c, u[c]);
    sum_nodes(&b->N[l], CT_WARM, other, c, v[c]);
  }
  const double *n = &b->direction[l];
#pragma omp simd
  for (int k = 0; k < 4; k++)
    // -- n·(Σ_a N_a u_a - Σ_b N̄_b u_b) (eq:admitted-store)
    b->along[l + k] = (n[k] * (u[0][k] - v[0][k]) + n[8 + k] * (u[1][k] - v[1][k])) +
                      n[16 + k] * (u[2][k] - v[2][k]);
}

/* The same for all lanes; NaN where they are not loaded together. */
CT_INLINE void find_motion(const ct_pass *p, block *b)
{
  for (int h = 0; h < 2; h++)
    if (b->four[h]) move_four(p, 4 * h, b);
    else put(4, NAN, &b->along[4 * h]);
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
    if (near[l]) b->rival[l] = is_near(search, face, &at[l], most[l]);
}

/* Find the points to which a face other than the last one may be nearer than the closest point.
 * With a margin for the rounding of positions, so some points are found unnecessarily. */
CT_INLINE void find_rivals(const ct_pass *p, block *b)
{
  const int32_t *met = &p->side->met[b->number];
  const double *distant = &p->side->distant[b->number];
  double at[3 * CT_WARM], most[CT_WARM], beyond[CT_WARM], least = HUGE_VAL;
  int32_t others = 0;
#pragma omp simd reduction(min : least) reduction(| : others)
  for (int l = 0; l < CT_WARM; l++) {
    double x = b->points[l] + b->origin[l], y = b->points[8 + l] + b->origin[8 + l],
           z = b->points[16 + l] + b->origin[16 + l];
    double reach = b->distance[l] < p->depth ? b->distance[l] : p->depth;
    reach += 16.0 * DBL_EPSILON * ((fabs(x) + fabs(y)) + (fabs(z) + reach));
    most[l] = 4.0 * (reach * reach);
    b->rival[l] = 0;
    at[l] = x, at[8 + l] = y, at[16 + l] = z;
    // -- What is left of the distance of all other faces when they were listed (eq:rival-distance)
    beyond[l] = distant[l] - ct_pass_reached(p, reach);
    least = beyond[l] < least ? beyond[l] : least;
    others |= met[l] ^ b->target[l];
  }
  if (others == 0 && least > 0.0) return;
  // Lanes beyond `count` repeat others.
  for (int l = 0; l < CT_WARM; l++)
    if (l >= b->count || ((met[l] == b->target[l]) & (beyond[l] > 0.0))) most[l] = -1.0;
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

/* Whether the closest points are inside their last faces, within the allowed depth, with no other
 * face as near; and whether they come into contact. */
CT_INLINE void settle(const ct_pass *p, block *b)
{
  const double inside = 1.0 - p->project.tolerance, depth = p->depth,
               coincident = ct_side_coincident(p->side);
  int doubt = 0, touches = 0;
#pragma omp simd reduction(| : doubt, touches)
  for (int l = 0; l < CT_WARM; l++) {
    const int32_t status = b->status[l];
    // -- Inside its face, and no other face is as near (eq:warm-lanes)
    const int in =
        (fabs(b->xi[l]) < inside) & (fabs(b->xi[8 + l]) < inside) & (b->distance[l] < depth) &
        !b->rival[l] &
        ((status == CT_OK) | (status == CT_NOT_CERTIFIED) | (status == CT_ITERATION_LIMIT));
    const int32_t next = CT_POINT_OUTSIDE + (b->gap[l] < 0.0); // or inside, the next one
    const int enters = (next == CT_POINT_INSIDE) & (b->last[l] != CT_POINT_INSIDE);
    b->inside[l] = in, b->enters[l] = enters, b->next[l] = (ct_point_status)next;
    doubt |= (!in) | enters;
    touches |= !(fabs(b->gap[l]) > coincident);
  }
  b->sure = !doubt, b->touches = touches;
}

CT_CLONES
static void measure_block(const ct_pass *p, block *b)
{
  if (p->side->search->per == 4) gaps(4, b);
  else gaps(8, b);
  find_rivals(p, b);
  find_motion(p, b);
  settle(p, b);
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
             offsetof(ct_point, known) == offsetof(ct_point, xi) + 2 * sizeof(double)
         ? 1
         : -1];

/* Store the results of `count` points from a lane on, one or four. Inlined with known numbers. */
CT_INLINE void write_lanes(const ct_pass *p, const block *b, int per, int count, int l,
                           ct_point *point)
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
  for (int i = 0; i < count; i++) point[i].jumped = 0, point[i].status = b->next[l + i];
  for (int i = 0; b->touches && i < count; i++) {
    if (fabs(gap[i]) > ct_side_coincident(p->side)) continue;
    for (int c = 0; c < 3; c++) point[i].outward[c] = b->normal[CT_WARM * c + l + i];
    ct_side_direct(p->side, &point[i]);
    point[i].along = NAN; // of another direction
  }
}

/* Store the results of the lanes whose points are settled, of those in `warm`; returns their bits.
 * Inlined with a known `per`. */
CT_INLINE unsigned write_points(const ct_pass *p, const block *b, int per, int64_t first,
                                unsigned warm)
{
  ct_point *points = &p->side->points[first];
  unsigned settled = b->sure ? warm : 0;
  for (int l = 0; l < CT_WARM && !b->sure; l++)
    if ((warm >> l & 1) && b->inside[l] && !(b->enters[l] && is_strange(p, b, l, first + l)))
      settled |= 1u << l;
  for (int h = 0; h < CT_WARM; h += 4)
    if ((settled >> h & 15) == 15) write_lanes(p, b, per, 4, h, &points[h]);
    else
      for (int l = h; l < h + 4; l++)
        if (settled >> l & 1) write_lanes(p, b, per, 1, l, &points[l]);
  return settled;
}

CT_CLONES
static unsigned write_block(const ct_pass *p, const block *b, int64_t first, unsigned warm)
{
  return p->other->search->per == 4 ? write_points(p, b, 4, first, warm)
                                    : write_points(p, b, 8, first, warm);
}

/* Closest points of all lanes; returns 0 if there are none. Most are near their starts. */
static int project_block(const ct_pass *p, block *b)
{
  const ct_face_kind kind = p->other->search->kind;
  const ct_batch_closest closest = {
      .xi = b->xi, .distance = b->distance, .normal = b->normal, .status = b->status};
  if (kind == CT_Q4 && p->project.iteration_limit == 0 &&
      p->near(b->nodes, b->points, b->start, &p->project, &closest) == (1u << CT_WARM) - 1) {
    for (int l = 0; l < CT_WARM; l++) b->status[l] = CT_OK;
    return 1;
  }
  return ct_project_batch(kind, CT_WARM, b->nodes, b->points, b->start, &p->project, &closest,
                          NULL) == CT_OK;
}

unsigned ct_pass_warm(const ct_pass *p, int64_t first, int count)
{
  block b;
  const unsigned warm = load_block(p, first, count, &b);
  if (warm == 0 || !project_block(p, &b)) return 0;
  measure_block(p, &b);
  return write_block(p, &b, first, warm);
}
