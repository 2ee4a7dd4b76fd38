/* Coulomb friction with stick on the points of a contact or of an obstacle: it adds a tangential
 * law to their rows, and applies the forces that the solver finds. */
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../base/vector.h"
#include "../constraint/law.h"
#include "../constraint/slip.h"
#include "contact_internal.h"
#include "heap.h"

#include <math.h>
#include <string.h>

/* Constant data: friction acts on a contact or, if `rigid`, on an obstacle, with one or two sides.
 */
typedef struct friction {
  ct_interaction is;
  double mu, rho;
  int rigid, sides, explicit;
  int other_nodes; /* largest number of nodes of a partner's face */
  const ct_side_fixed *side[2];
  int64_t points;
} friction;

/* Memory of an elastic slip: its components along the tangents and the normal of the partner's
 * face, or at an obstacle along the axes, and its length (eq:friction-components). */
typedef struct slip_memory {
  double part[3], length;
} slip_memory;

/* Memory of friction for one point. */
typedef struct slip_record {
  double other;    /* face of the other side plus one, 1 at an obstacle; 0: open */
  double place[2]; /* parameters of the closest point on that face */
  slip_memory e, before;
  double reserve, stuck;
  double force[3];
} slip_record;

/* And behind all points: whether there was an earlier call, and what they stored at the middle of
 * its step and had dissipated by then; force of friction on an obstacle in it, and the work of its
 * motion against it. */
typedef struct tail_record {
  double begun, stored, lost, reaction[3], motion;
} tail_record;
enum { RECORD = sizeof(slip_record) / sizeof(double), TAIL = sizeof(tail_record) / sizeof(double) };

/* Axes of the partner's face at the closest point: the vectors a^i (eq:friction-components) and the
 * unit normal; all 0 where the face has none. */
typedef struct face_axes {
  double dual[2][3], n[3];
} face_axes;

typedef struct friction_state {
  ct_pool pool;
  const friction *data;
  ct_slip *points;
  int64_t listed_count;
  int64_t *listed;         /* the points whose rows are listed in this step */
  face_axes *axes;         /* of each point, from the list of rows to the forces */
  double (*turn)[8];       /* w_b · T of each point, for the nodes of the other face */
  const ct_pieces *pieces; /* those of the sides */
  double *coarse, *fine;   /* sums at the nodes, and one number more, 0 */
  double *terms;           /* one number per point or node */
  tail_record tail;
  double held, dissipated; /* at t_n */
} friction_state;

/* Data shared by the points of one call: the sides now. */
typedef struct call {
  const friction *data;
  const ct_surface_motion *at;
  const ct_side *side[2];
} call;

/* One listed point: point `i` of side `s`, the number `j` of all. */
typedef struct place {
  int s;
  int64_t i, j;
} place;

static place place_of(const call *now, int64_t j)
{
  const int64_t first = now->data->side[0]->point_count;
  return j < first ? (place){0, j, j} : (place){1, j - first, j};
}

static const ct_search *search_of_other(const call *now, int s)
{
  return now->side[now->data->sides - 1 - s]->search;
}

/* Faces of eight points side by side, lane by lane: their nodes, the derivatives of their shape
 * functions at a point, tangents, unit normal and the vectors a^i; all 0 where there is none. */
typedef struct frames {
  int per; /* the largest number of nodes */
  double x[8][3][CT_BATCH], dN[8][2][CT_BATCH], t[3][3][CT_BATCH], dual[2][3][CT_BATCH];
  double w[8][3][CT_BATCH]; /* weights of the couple */
} frames;

/* Nodes and derivatives of one lane. */
static void load_face(const ct_search *search, int32_t face, const double xi[2], int lane,
                      frames *f)
{
  const int32_t *node = &search->faces[(int64_t)face * search->per];
  double dN[8][2];
  ct_segment_gradient(search->kind, xi, dN);
  f->per = search->per > f->per ? search->per : f->per;
  for (int b = 0; b < search->per; b++) {
    const double *x = &search->x[3 * (int64_t)node[b]];
    for (int c = 0; c < 3; c++) f->x[b][c][lane] = x[c];
    for (int i = 0; i < 2; i++) f->dN[b][i][lane] = dN[b][i];
  }
}

/* Tangents t_i = Σ ∂_i N̄_b x_b, paired so that a flipped face gives the same bits (eq:tree-sum). */
CT_INLINE void find_tangents(frames *f)
{
  for (int i = 0; i < 2; i++)
    for (int c = 0; c < 3; c++) {
      double v[8][CT_BATCH] = {{0.0}}, *t = f->t[i][c];
      for (int b = 0; b < f->per; b++)
#pragma omp simd
        for (int l = 0; l < CT_BATCH; l++) v[b][l] = f->dN[b][i][l] * f->x[b][c][l];
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++) t[l] = (v[0][l] + v[1][l]) + (v[2][l] + v[3][l]);
      if (f->per <= 4) continue;
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++) t[l] += (v[4][l] + v[6][l]) + (v[5][l] + v[7][l]);
    }
}

/* The product of two vectors in a lane. */
CT_INLINE double dot(double (*const a)[CT_BATCH], double (*const b)[CT_BATCH], int l)
{
  return (a[0][l] * b[0][l] + a[1][l] * b[1][l]) + a[2][l] * b[2][l];
}

/* Unit normal, and the vectors a^i with a^i · t_j = δ_ij in the plane of the tangents
 * (eq:friction-components). */
CT_INLINE void find_dual(frames *f)
{
  static const double PARALLEL = 1e-14;
  double has[CT_BATCH], (*t0)[CT_BATCH] = f->t[0], (*t1)[CT_BATCH] = f->t[1],
                        (*n)[CT_BATCH] = f->t[2];
  for (int c = 0; c < 3; c++) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
#pragma omp simd
    for (int l = 0; l < CT_BATCH; l++) n[c][l] = t0[d][l] * t1[e][l] - t0[e][l] * t1[d][l];
  }
#pragma omp simd
  for (int l = 0; l < CT_BATCH; l++) {
    const double m11 = dot(t0, t0, l), m22 = dot(t1, t1, l), m12 = dot(t0, t1, l),
                 det = m11 * m22 - m12 * m12, size = sqrt(dot(n, n, l));
    has[l] = size > PARALLEL * sqrt(m11 * m22) && size < HUGE_VAL ? 1.0 : 0.0;
    for (int c = 0; c < 3; c++) {
      n[c][l] = n[c][l] / size;
      // -- a^i = m^{ij} t_j, with the inverse of a matrix of two rows (eq:friction-components)
      f->dual[0][c][l] = (m22 * t0[c][l] - m12 * t1[c][l]) / det;
      f->dual[1][c][l] = (m11 * t1[c][l] - m12 * t0[c][l]) / det;
    }
  }
  for (int l = 0; l < CT_BATCH; l++)
    for (int c = 0; c < 3 && has[l] == 0.0; c++)
      n[c][l] = t0[c][l] = t1[c][l] = f->dual[0][c][l] = f->dual[1][c][l] = 0.0;
}

/* The weights of the couple (eq:slip-row). */
CT_INLINE void weigh(frames *f)
{
  for (int b = 0; b < f->per; b++)
    for (int c = 0; c < 3; c++)
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++)
        // -- w_b = Σ_i ∂_i N̄_b a^i (eq:slip-row)
        f->w[b][c][l] = f->dN[b][0][l] * f->dual[0][c][l] + f->dN[b][1][l] * f->dual[1][c][l];
}

/* Elastic slips of eight points, side by side: as they were stored, and afterwards along the axes
 * of space. */
typedef struct slips {
  double part[3][CT_BATCH], length[CT_BATCH];
} slips;

static void load_slip(const slip_memory *from, int lane, slips *to)
{
  for (int c = 0; c < 3; c++) to->part[c][lane] = from->part[c];
  to->length[lane] = from->length;
}

/* The stored slips along the present frames of their faces, turned into the present plane of
 * contact with their lengths (eq:friction-turn). */
CT_INLINE void recall(double (*const t)[3][CT_BATCH], double (*const n)[CT_BATCH], slips *of)
{
  double e[3][CT_BATCH];
  for (int c = 0; c < 3; c++)
#pragma omp simd
    for (int l = 0; l < CT_BATCH; l++)
      e[c][l] =
          (of->part[0][l] * t[0][c][l] + of->part[1][l] * t[1][c][l]) + of->part[2][l] * t[2][c][l];
#pragma omp simd
  for (int l = 0; l < CT_BATCH; l++) {
    const double along = dot(n, e, l);
    for (int c = 0; c < 3; c++) e[c][l] -= along * n[c][l];
    const double length = sqrt(dot(e, e, l)), some = length > 0.0 ? length : 1.0,
                 part = of->length[l] / some;
    // -- The length stays (eq:friction-turn)
    for (int c = 0; c < 3; c++) of->part[c][l] = e[c][l] * part;
  }
}

/* Eight points that are prepared together; the last of fewer fills all other lanes. */
typedef struct batch {
  place at[CT_BATCH];
  ct_point *point[CT_BATCH];
  slip_record last[CT_BATCH]; /* with `other` 0 where nothing is recalled */
  double n[3][CT_BATCH];      /* normals of the rows */
  frames now, then;           /* of the partners now; and where slips were stored */
  slips e, before;
} batch;

static void load_batch(const call *now, const friction_state *s, int64_t first, batch *b)
{
  for (int l = 0; l < CT_BATCH; l++) {
    const int64_t n = first + l < s->listed_count ? first + l : s->listed_count - 1;
    const place at = b->at[l] = place_of(now, s->listed[n]);
    slip_record *last = &b->last[l];
    b->point[l] = &now->side[at.s]->points[at.i];
    memcpy(last, &now->at->memory[RECORD * at.j], sizeof *last);
    const double most = now->data->rigid ? 1.0 : (double)search_of_other(now, at.s)->face_count;
    // -- At t = 0 forces are solved for twice: the second time from those of the first
    if (!(last->other >= 1.0 && last->other <= most) || now->at->before == 0.0) {
      last->other = 0.0;
      last->e = last->before = (slip_memory){.length = 0.0};
      last->reserve = last->stuck = 0.0;
    }
    for (int c = 0; c < 3; c++) b->n[c][l] = b->point[l]->row.normal[c];
    load_slip(&last->e, l, &b->e), load_slip(&last->before, l, &b->before);
  }
}

/* The frames of the partners; and of faces that are no longer partners, where their point was.
 * Returns whether there are such. */
static int load_frames(const call *now, batch *b)
{
  int changed = 0;
  b->now.per = 0;
  // The faces of the two sides may have different numbers of nodes.
  if (now->data->other_nodes > 4) memset(&b->now, 0, sizeof b->now);
  for (int l = 0; l < CT_BATCH; l++) {
    const ct_point *point = b->point[l];
    load_face(search_of_other(now, b->at[l].s), point->other, point->xi, l, &b->now);
    changed |= b->last[l].other > 0.0 && (int32_t)b->last[l].other - 1 != point->other;
  }
  if (!changed) return 0;
  b->then = b->now;
  for (int l = 0; l < CT_BATCH; l++) {
    const int32_t face = (int32_t)b->last[l].other - 1;
    if (face >= 0 && face != b->point[l]->other)
      load_face(search_of_other(now, b->at[l].s), face, b->last[l].place, l, &b->then);
  }
  return 1;
}

/* The axes of space in all lanes. */
static void take_axes_of_space(frames *f)
{
  memset(f->t, 0, sizeof f->t);
  for (int c = 0; c < 3; c++)
    for (int l = 0; l < CT_BATCH; l++) f->t[c][c][l] = 1.0;
}

/* Frames and elastic slips of all lanes. */
CT_CLONES
static void find_slips(int rigid, int changed, batch *b)
{
  if (rigid) {
    take_axes_of_space(&b->now);
  } else {
    find_tangents(&b->now);
    find_dual(&b->now);
    weigh(&b->now);
  }
  if (changed) {
    find_tangents(&b->then);
    find_dual(&b->then);
  }
  recall(changed ? b->then.t : b->now.t, b->n, &b->e);
  recall(changed ? b->then.t : b->now.t, b->n, &b->before);
}

/* The frame of one lane, and the weights of its couple, with `per` nodes. */
CT_INLINE void store_frame(const frames *f, int l, int per, const double d[3], face_axes *axes,
                           ct_slip *p)
{
  for (int c = 0; c < 3; c++) {
    for (int i = 0; i < 2; i++) axes->dual[i][c] = f->dual[i][c][l];
    axes->n[c] = f->t[2][c][l];
    p->lever[c] = d[c];
  }
  for (int b = 0; b < per; b++)
    for (int c = 0; c < 3; c++) p->weight[b][c] = f->w[b][c][l];
}

/* Give one listed point its friction in the next step. */
static void store_point(const call *now, friction_state *s, const batch *b, int l)
{
  const friction *data = now->data;
  const ct_contact *contact = now->at->on;
  ct_point *point = b->point[l];
  const slip_record *last = &b->last[l];
  const int64_t j = b->at[l].j;
  ct_slip *p = &s->points[j];
  ct_slip_open(p);
  point->row.slip = p;
  p->mu = data->mu;
  p->k = data->rho * point->row.stiffness;
  p->reserve = last->reserve, p->stuck = last->stuck != 0.0;
  for (int c = 0; c < 3; c++) {
    p->e[c] = b->e.part[c][l], p->before[c] = b->before.part[c][l];
    p->force[c] = now->at->before > 0.0 ? -p->k * p->e[c] : last->force[c];
    p->came[c] = data->rigid ? contact->part * contact->came[c] : 0.0;
    p->coming[c] = data->rigid ? contact->coming[c] : 0.0;
  }
  if (data->other_nodes == 4) store_frame(&b->now, l, 4, point->d, &s->axes[j], p);
  else if (!data->rigid)
    store_frame(&b->now, l, search_of_other(now, b->at[l].s)->per, point->d, &s->axes[j], p);
  // -- The force of the explicit penalty is known: k ⟨-g⟩
  if (data->explicit) point->row.force = point->row.stiffness * fmax(-point->row.gap, 0.0);
}

/* Prepare eight listed points, from one on. */
static void prepare(const call *now, friction_state *s, int64_t first)
{
  const int rigid = now->data->rigid;
  batch b;
  load_batch(now, s, first, &b);
  find_slips(rigid, !rigid && load_frames(now, &b), &b);
  for (int l = 0; l < CT_BATCH && first + l < s->listed_count; l++) store_point(now, s, &b, l);
}

/* Components of a slip along the axes of a face, or null: those of space. */
static inline void keep(const double e[3], const face_axes *axes, slip_memory *to)
{
  if (axes == NULL) {
    memcpy(to->part, e, sizeof to->part);
  } else {
    to->part[0] = ct_vector_dot(e, axes->dual[0]);
    to->part[1] = ct_vector_dot(e, axes->dual[1]);
    to->part[2] = ct_vector_dot(e, axes->n);
  }
  to->length = sqrt(ct_vector_dot(e, e));
}

/* The weights of a point's couple, for the nodes of the other face; returns its largest force at a
 * node. */
CT_INLINE double turn_of(int nodes, const ct_slip *p, double *turn)
{
  double top = 0.0, arm = 0.0, force = 0.0;
  for (int b = 0; b < nodes; b++) {
    const double w = turn[b] = ct_vector_dot(p->weight[b], p->force), size = fabs(w);
    top = size > top ? size : top;
  }
  for (int c = 0; c < 3; c++) {
    const double size = fabs(p->force[c]), length = fabs(p->lever[c]);
    force = size > force ? size : force;
    arm = length > arm ? length : arm;
  }
  return top * arm > force ? top * arm : force;
}

/* Store what the next step needs of a listed point. */
static void store(const call *now, friction_state *s, place at)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const ct_slip *p = &s->points[at.j];
  const int rigid = now->data->rigid;
  const face_axes *axes = rigid ? NULL : &s->axes[at.j];
  slip_record next = {.other = 0.0};
  const int nodes = s->data->other_nodes;
  s->terms[at.j] = nodes == 4 ? turn_of(4, p, s->turn[at.j]) : turn_of(nodes, p, s->turn[at.j]);
  if (point->row.force > 0.0 && (rigid || ct_vector_dot(axes->n, axes->n) > 0.0)) {
    next.other = rigid ? 1.0 : (double)point->other + 1.0;
    if (!rigid) memcpy(next.place, point->xi, sizeof next.place);
    keep(p->e, axes, &next.e);
    keep(p->before, axes, &next.before);
    next.reserve = p->reserve;
    next.stuck = p->stuck;
    memcpy(next.force, p->force, sizeof next.force);
  }
  memcpy(&now->at->next_memory[RECORD * at.j], &next, sizeof next);
}

/* The sums of two sides before they are added to those of all nodes. */
typedef struct heaps {
  const ct_side_fixed *other;
  ct_heap own, theirs;
} heaps;

/* Add the traction and the couple of a listed point of side `k`. */
CT_INLINE void add_point(int stride, const call *now, const ct_grid *grid, place at,
                         const friction_state *s, heaps *to)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const ct_slip *p = &s->points[at.j];
  const double back[3] = {-p->force[0], -p->force[1], -p->force[2]},
               lever[3] = {-p->lever[0], -p->lever[1], -p->lever[2]};
  if (ct_vector_dot(p->force, p->force) == 0.0) return;
  // -- N_a T on the own face; -N̄_b T - (w_b · T) d on the other (eq:slip-row)
  ct_heap_add(stride, grid, point->row.own, point->row.own_shape, p->force, &to->own);
  if (now->data->rigid) return;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  ct_heap_add(stride, grid, node, point->N, back, &to->theirs);
  ct_heap_add(stride, grid, node, s->turn[at.j], lever, &to->theirs);
}

/* Whether four listed points from the given one on are those of one face, with forces, and meet one
 * face. */
static int are_four(const call *now, const friction_state *s, const int64_t *listed, int64_t left)
{
  const place first = place_of(now, *listed);
  const ct_point *point = &now->side[first.s]->points[first.i];
  if (left < 4 || listed[3] != *listed + 3 || now->data->side[first.s]->point_count <= first.i + 3)
    return 0;
  for (int q = 0; q < 4; q++) {
    const double *T = s->points[first.j + q].force;
    if (point[q].row.own != point->row.own || point[q].other != point->other ||
        ct_vector_dot(T, T) == 0.0)
      return 0;
  }
  return now->data->side[first.s]->rule.count == 4;
}

/* As `add_point`, of four such points together. */
CT_INLINE void add_four(const call *now, const ct_grid *grid, place at, const friction_state *s,
                        const heaps *to)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const double *N[4], *N_bar[4], *turn[4];
  double force[4][4] = {{0.0}}, lever[4][4] = {{0.0}};
  for (int q = 0; q < 4; q++) {
    const ct_slip *p = &s->points[at.j + q];
    for (int c = 0; c < 3; c++) force[q][c] = p->force[c], lever[q][c] = p->lever[c];
    N[q] = point[q].row.own_shape, N_bar[q] = point[q].N, turn[q] = s->turn[at.j + q];
  }
  // -- N_a T on the own face; -N̄_b T - (w_b · T) d on the other (eq:slip-row)
  ct_heap_add_four(to->own.count, grid, point->row.own, N, 1.0, force, &to->own);
  if (now->data->rigid) return;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  ct_heap_add_four(to->theirs.count, grid, node, N_bar, -1.0, force, &to->theirs);
  ct_heap_add_four(to->theirs.count, grid, node, turn, -1.0, lever, &to->theirs);
}

/* Add the tractions and couples of the listed points of side `k` to the sums at the nodes. */
CT_INLINE void add_side(int stride, const call *now, int k, const ct_grid *grid, friction_state *s)
{
  const ct_side_fixed *side = now->data->side[k],
                      *other = now->data->side[now->data->sides - 1 - k];
  heaps to = {other,
              {s->coarse, s->fine, side->search->per, NULL, {0}, {0}},
              {s->coarse, s->fine, other->search->per, NULL, {0}, {0}}};
  for (int64_t n = 0; n < s->listed_count;) {
    const place at = place_of(now, s->listed[n]);
    const int four = at.s == k && are_four(now, s, &s->listed[n], s->listed_count - n);
    if (four) add_four(now, grid, at, s, &to);
    else if (at.s == k) add_point(stride, now, grid, at, s, &to);
    n += four ? 4 : 1;
  }
  ct_heap_bring(stride, &to.own, NULL);
  ct_heap_bring(stride, &to.theirs, NULL);
}

/* Tractions and couples of the points of side `k`, of faces with at most four nodes or with more.
 */
CT_CLONES
static void push(const call *now, int k, const ct_grid *grid, friction_state *s)
{
  if (now->data->side[0]->search->per <= 4 &&
      now->data->side[now->data->sides - 1]->search->per <= 4)
    add_side(4, now, k, grid, s);
  else add_side(8, now, k, grid, s);
}

/* Tractions and couples of all points at the nodes, in sums that do not depend on their order
 * (eq:slip-row). */
static ct_status gather(const call *now, friction_state *s, int32_t nodes, double *force,
                        ct_error *error)
{
  const friction *data = now->data;
  const size_t size = 3 * (size_t)nodes * sizeof *force;
  double top = 0.0;
  ct_grid grid;
  for (int64_t n = 0; n < s->listed_count; n++) {
    const double own = s->terms[s->listed[n]];
    top = own > top || isnan(own) ? own : top;
  }
  ct_pieces_largest(s->pieces, &top, 1);
  memset(s->coarse, 0, size);
  memset(s->fine, 0, size);
  if (top > 0.0 && !ct_grid_init(&grid, 2.0 * top, 24 * data->points))
    return ct_fail(
        error, CT_ERROR_BLOWUP, CT_NOWHERE,
        "friction: the largest force, %g, is too large or not finite; the motion has diverged",
        top);
  for (int k = 0; top > 0.0 && k < data->sides; k++) push(now, k, &grid, s);
  if (top > 0.0) {
    ct_pieces_sum(s->pieces, s->coarse, 3 * (int64_t)nodes);
    ct_pieces_sum(s->pieces, s->fine, 3 * (int64_t)nodes);
  }
  for (int64_t d = 0; d < 3 * (int64_t)nodes; d++) force[d] = s->coarse[d] + s->fine[d];
  return CT_OK;
}

/* The sides now, and the tail of the memory. */
static call begin(friction_state *s, const ct_surface_motion *at)
{
  call now = {.data = s->data, .at = at};
  memcpy(&s->tail, &at->memory[RECORD * s->data->points], sizeof s->tail);
  if (at->before == 0.0) s->tail = (tail_record){.begun = 0.0};
  for (int k = 0; k < s->data->sides; k++)
    now.side[k] = &((const ct_contact *)at->on)->gaps.side[k];
  s->pieces = now.side[0]->pieces;
  return now;
}

/* Force on an obstacle, and the work of its motion since the last call (eq:obstacle-work). */
static void count_motion(const call *now, const double *force, friction_state *s)
{
  const ct_contact *obstacle = now->at->on;
  const int32_t nodes = now->data->is.node_count;
  for (int c = 0; c < 3; c++) {
    const double last = s->tail.reaction[c];
    for (int32_t n = 0; n < nodes; n++) s->terms[n] = -force[3 * (int64_t)n + c];
    s->tail.reaction[c] = ct_sum(s->terms, nodes);
    s->tail.motion -= 0.5 * (s->tail.reaction[c] + last) * obstacle->came[c];
  }
}

/* Fewest points of a thread: a fraction of a millisecond. */
enum { LEAST_POINTS = 1024 };

/* List the points that have rows in this step. */
static void list_points(friction_state *s, const call *now)
{
  int64_t j = 0;
  s->listed_count = 0;
  for (int k = 0; k < s->data->sides; k++)
    for (int64_t i = 0; i < s->data->side[k]->point_count; i++, j++) {
      ct_point *point = &now->side[k]->points[i];
      if (point->listed) s->listed[s->listed_count++] = j;
      else point->row.slip = NULL;
    }
}

/* Prepare the listed points for the solver, or afterwards store what it found. */
static void treat(friction_state *s, const call *now, int solved)
{
#ifdef _OPENMP
  const int threads = ct_threads_for(now->at->threads, s->listed_count, LEAST_POINTS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int64_t first = 0; first < s->listed_count; first += CT_BATCH) {
    if (!solved) prepare(now, s, first);
    for (int64_t n = first; solved && n < first + CT_BATCH && n < s->listed_count; n++)
      store(now, s, place_of(now, s->listed[n]));
  }
}

/* Points that are not listed store nothing. */
static void clear_memory(const friction_state *s, const ct_surface_motion *at)
{
  static const slip_record none = {.other = 0.0};
  for (int64_t j = 0, n = 0; j < s->data->points; j++)
    if (n < s->listed_count && s->listed[n] == j) n++;
    else memcpy(&at->next_memory[RECORD * j], &none, sizeof none);
}

/* The rows of the explicit penalty are listed here, because its contact lists none. */
static int64_t list_rows(void *state, const ct_surface_motion *at, ct_constraint **rows)
{
  friction_state *s = state;
  const int64_t count = s->data->explicit ? ct_contact_list_rows(at->on, at->dt, rows) : 0;
  const call now = begin(s, at);
  list_points(s, &now);
  treat(s, &now, 0);
  return count;
}

/* Σ of one number of each listed point. */
static double sum_points(friction_state *s, double (*of)(const ct_slip *p))
{
  for (int64_t n = 0; n < s->listed_count; n++) s->terms[n] = of(&s->points[s->listed[n]]);
  return ct_sum_over(s->pieces, s->terms, s->listed_count);
}

static double work_of(const ct_slip *p) { return p->work; }
static double lag_of(const ct_slip *p) { return p->lag; }

/* What friction stores and has dissipated at t_n (eq:slip-held, eq:friction-dissipation). */
static void count_energy(friction_state *s)
{
  tail_record *tail = &s->tail;
  const double before = tail->stored, after = sum_points(s, ct_slip_stored),
               lost = (before - after) - sum_points(s, work_of);
  const int begun = tail->begun != 0.0;
  // -- The mean of the stores of two half steps (eq:slip-held)
  s->held = begun ? 0.5 * (before + after) + sum_points(s, lag_of) : 0.0;
  s->dissipated = begun ? tail->lost + 0.5 * lost : 0.0;
  tail->begun = 1.0;
  tail->stored = after;
  // -- S₋ - S₊ - W (eq:friction-dissipation)
  tail->lost += lost;
}

static ct_status find_forces(void *state, const ct_surface_motion *at, double *force,
                             ct_error *error)
{
  friction_state *s = state;
  const friction *data = s->data;
  const call now = begin(s, at);
  treat(s, &now, 1);
  clear_memory(s, at);
  ct_status status = gather(&now, s, data->is.node_count, force, error);
  count_energy(s);
  if (status == CT_OK && data->rigid) count_motion(&now, force, s);
  memcpy(&at->next_memory[RECORD * data->points], &s->tail, sizeof s->tail);
  return status;
}

static void find_energy(void *state, ct_interaction_energy *energy)
{
  const friction_state *s = state;
  *energy = (ct_interaction_energy){
      .stored = s->held, .dissipated = s->dissipated, .motion = s->tail.motion};
  memcpy(energy->reaction, s->tail.reaction, sizeof energy->reaction);
}

static ct_status open_state(const ct_interaction *interaction, void **state, ct_error *error)
{
  const friction *data = (const friction *)interaction;
  friction_state *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_NO_MEMORY(error, "friction");
  const size_t nodes = (size_t)interaction->node_count;
  s->data = data;
  s->points = ct_pool_take(&s->pool, (size_t)data->points, sizeof *s->points);
  s->listed = ct_pool_take(&s->pool, (size_t)data->points, sizeof *s->listed);
  s->turn = ct_pool_take(&s->pool, (size_t)data->points, sizeof *s->turn);
  s->axes = ct_pool_take(&s->pool, (size_t)data->points, sizeof *s->axes);
  s->terms = ct_pool_take(&s->pool, (size_t)data->points + nodes, sizeof *s->terms);
  s->coarse = ct_pool_take(&s->pool, 3 * nodes + 1, sizeof(double));
  s->fine = ct_pool_take(&s->pool, 3 * nodes + 1, sizeof(double));
  if (!s->pool.failed) {
    *state = s;
    return CT_OK;
  }
  ct_pool_free(s);
  return CT_NO_MEMORY(error, "friction");
}

static void free_friction(ct_interaction *interaction) { ct_release(interaction); }

static const ct_interaction_calls CALLS = {.free = free_friction,
                                           .open = open_state,
                                           .close = ct_pool_free,
                                           .list_rows = list_rows,
                                           .find_forces = find_forces,
                                           .find_energy = find_energy};

static ct_status check(double coefficient, double tangent, ct_error *error)
{
  if (!(coefficient > 0.0) || !isfinite(coefficient))
    return CT_REFUSE(error, "friction: the coefficient must be positive, not %g", coefficient);
  if (!(tangent > 0.0) || !isfinite(tangent))
    return CT_REFUSE(
        error,
        "friction: the ratio of the tangential to the normal penalty must be positive, not %g",
        tangent);
  return CT_OK;
}

/* Friction as an interaction. Flops and bytes were counted on two plane surfaces and on a plane. */
static ct_interaction describe(const friction *data, const ct_interaction *on)
{
  double bytes = 2.0 * sizeof(ct_slip) + sizeof(ct_point) + 2.0 * sizeof(slip_record),
         points = (double)data->points;
  return (ct_interaction){.calls = &CALLS,
                          .nodes = on->nodes,
                          .node_count = on->node_count,
                          .on = on,
                          .row_count = data->explicit ? data->points : 0,
                          .row_nodes = on->row_nodes,
                          .slip_count = data->points,
                          .memory_count = RECORD * data->points + TAIL,
                          .flops = (data->rigid ? 225.0 : 750.0) * points,
                          .bytes = bytes * points + 250.0 * on->node_count};
}

ct_status ct_friction_create(double coefficient, double tangent, const ct_interaction *on,
                             ct_interaction **out, ct_error *error)
{
  ct_status status = check(coefficient, tangent, error);
  if (status != CT_OK) return status;
  friction *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return CT_NO_MEMORY(error, "friction");
  data->mu = coefficient;
  data->rho = tangent;
  const ct_contact_fixed *fixed = (const ct_contact_fixed *)on;
  data->rigid = ct_contact_is_rigid(fixed);
  data->explicit = on->explicit;
  data->sides = ct_gaps_surfaces(&fixed->gaps);
  for (int k = 0; k < data->sides; k++) {
    data->side[k] = &fixed->gaps.side[k];
    data->points += data->side[k]->point_count;
    if (!data->rigid && data->side[k]->search->per > data->other_nodes)
      data->other_nodes = data->side[k]->search->per;
  }
  data->is = describe(data, on);
  *out = &data->is;
  return CT_OK;
}
