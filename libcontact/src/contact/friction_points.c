/* What friction stores of its points from step to step, and what it gives the solver. */
#include "friction_internal.h"

#include "../base/lanes.h"
#include "../base/vector.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Faces of eight points side by side, lane by lane, tangents and unit normal at the points; all 0
 * where there is none. If all faces have four nodes, `x` are their edges, x₁ - x₀ and x₂ - x₃ along
 * ξ, and x₃ - x₀ and x₂ - x₁ along η; else their nodes, with the derivatives of their shape
 * functions. */
typedef struct frames {
  double xi[2][CT_BATCH], ends[2][2][CT_BATCH]; /* ¼ (1 - ξ) and ¼ (1 + ξ), the same for η */
  double x[8][3][CT_BATCH], dN[8][2][CT_BATCH], t[3][3][CT_BATCH];
} frames;

/* The edges of a face with four nodes, in some lanes. */
CT_INLINE void load_edges(const ct_search *search, int32_t face, int lane, int lanes, frames *f)
{
  static const int ENDS[4][2] = {{0, 1}, {3, 2}, {0, 3}, {1, 2}};
  const int32_t *node = &search->faces[4 * (int64_t)face];
  for (int e = 0; e < 4; e++) {
    const double *from = &search->x[3 * (int64_t)node[ENDS[e][0]]],
                 *to = &search->x[3 * (int64_t)node[ENDS[e][1]]];
    for (int c = 0; c < 3; c++) {
      const double edge = to[c] - from[c];
      for (int l = lane; l < lane + lanes; l++) f->x[e][c][l] = edge;
    }
  }
}

/* The face of one lane. */
CT_INLINE void load_face(int quads, const ct_search *search, int32_t face, const double xi[2],
                         int lane, frames *f)
{
  double dN[8][2];
  for (int i = 0; i < 2; i++) f->xi[i][lane] = xi[i];
  if (quads) {
    load_edges(search, face, lane, 1, f);
    return;
  }
  ct_segment_gradient(search->kind, xi, dN);
  for (int b = 0; b < search->per; b++) {
    const double *x = &search->x[3 * (int64_t)search->faces[(int64_t)face * search->per + b]];
    for (int c = 0; c < 3; c++) f->x[b][c][lane] = x[c];
    for (int i = 0; i < 2; i++) f->dN[b][i][lane] = dN[b][i];
  }
}

/* Tangents t_i = Σ ∂_i N̄_b x_b of faces with four nodes, along ξ between the edges at both ends of
 * η, and the reverse. Sets `ends`. */
CT_INLINE void find_quad_tangents(frames *f)
{
#pragma omp simd
  for (int l = 0; l < CT_BATCH; l++) {
    const double xi = f->xi[0][l], eta = f->xi[1][l], left = 0.25 * (1.0 - xi),
                 right = 0.25 * (1.0 + xi), low = 0.25 * (1.0 - eta), high = 0.25 * (1.0 + eta);
    f->ends[0][0][l] = left, f->ends[0][1][l] = right;
    f->ends[1][0][l] = low, f->ends[1][1][l] = high;
    for (int c = 0; c < 3; c++) {
      f->t[0][c][l] = low * f->x[0][c][l] + high * f->x[1][c][l];
      f->t[1][c][l] = left * f->x[2][c][l] + right * f->x[3][c][l];
    }
  }
}

/* The same for other faces, paired so that a flipped face gives the same bits (eq:tree-sum). */
CT_INLINE void find_tangents(frames *f)
{
  for (int i = 0; i < 2; i++)
    for (int c = 0; c < 3; c++)
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++) {
        double v[8];
        for (int b = 0; b < 8; b++) v[b] = f->dN[b][i][l] * f->x[b][c][l];
        f->t[i][c][l] = ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[6]) + (v[5] + v[7]));
      }
}

/* The product of two vectors in a lane. */
CT_INLINE double dot(double (*const a)[CT_BATCH], double (*const b)[CT_BATCH], int l)
{
  return (a[0][l] * b[0][l] + a[1][l] * b[1][l]) + a[2][l] * b[2][l];
}

/* Unit normal, and the vectors a^i with a^i · t_j = δ_ij in the plane of the tangents
 * (eq:friction-components). */
CT_INLINE void find_dual(frames *f, ct_face_axes *axes)
{
  static const double PARALLEL = 1e-14;
  double has[CT_BATCH], all = 1.0, (*t0)[CT_BATCH] = f->t[0], (*t1)[CT_BATCH] = f->t[1];
#pragma omp simd reduction(min : all)
  for (int l = 0; l < CT_BATCH; l++) {
    double n[3];
    for (int c = 0; c < 3; c++) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      n[c] = t0[d][l] * t1[e][l] - t0[e][l] * t1[d][l];
    }
    const double m11 = dot(t0, t0, l), m22 = dot(t1, t1, l), m12 = dot(t0, t1, l),
                 det = m11 * m22 - m12 * m12,
                 size = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]),
                 finite = size < HUGE_VAL ? 1.0 : 0.0,
                 own = size > PARALLEL * sqrt(m11 * m22) ? finite : 0.0;
    has[l] = own;
    all = own < all ? own : all;
    for (int c = 0; c < 3; c++) {
      // -- a^i = m^{ij} t_j, with the inverse of a matrix of two rows (eq:friction-components)
      axes->a[0][c][l] = (m22 * t0[c][l] - m12 * t1[c][l]) / det;
      axes->a[1][c][l] = (m11 * t1[c][l] - m12 * t0[c][l]) / det;
      axes->a[2][c][l] = f->t[2][c][l] = n[c] / size;
    }
  }
  for (int l = 0; l < CT_BATCH && all == 0.0; l++)
    for (int c = 0; c < 9 && has[l] == 0.0; c++)
      f->t[c / 3][c % 3][l] = axes->a[c / 3][c % 3][l] = 0.0;
}

/* The frames of all lanes. */
CT_INLINE void find_frames(int quads, frames *f, ct_face_axes *axes)
{
  if (quads) find_quad_tangents(f);
  else find_tangents(f);
  find_dual(f, axes);
}

/* The weights of the couple (eq:slip-row), `stride` numbers apart. */
CT_INLINE void weigh(const frames *f, const ct_face_axes *axes, int64_t stride, double *w)
{
  for (int b = 0; b < 8; b++)
    for (int c = 0; c < 3; c++)
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++)
        // -- w_b = Σ_i ∂_i N̄_b a^i (eq:slip-row)
        w[stride * (3 * b + c) + l] =
            f->dN[b][0][l] * axes->a[0][c][l] + f->dN[b][1][l] * axes->a[1][c][l];
}

/* The same for faces with four nodes. */
CT_INLINE void weigh_quads(const frames *f, const ct_face_axes *axes, int64_t stride, double *w)
{
#pragma omp simd
  for (int l = 0; l < CT_BATCH; l++)
    for (int c = 0; c < 3; c++) {
      const double a = axes->a[0][c][l], b = axes->a[1][c][l], low = f->ends[1][0][l] * a,
                   high = f->ends[1][1][l] * a, left = f->ends[0][0][l] * b,
                   right = f->ends[0][1][l] * b;
      // -- w_b = Σ_i ∂_i N̄_b a^i (eq:slip-row)
      w[stride * c + l] = -(low + left), w[stride * (3 + c) + l] = low - right;
      w[stride * (6 + c) + l] = high + right, w[stride * (9 + c) + l] = left - high;
    }
}

/* Where the numbers of a point's record stand (ct_slip_record). */
enum {
  OTHER = offsetof(ct_slip_record, other) / sizeof(double),
  PLACE = offsetof(ct_slip_record, place) / sizeof(double),
  E = offsetof(ct_slip_record, e) / sizeof(double),
  BEFORE = offsetof(ct_slip_record, before) / sizeof(double),
  RESERVE = offsetof(ct_slip_record, reserve) / sizeof(double), // and the next five, as of a slip
  FORCE = offsetof(ct_slip_record, force) / sizeof(double),
  QUADS = CT_FRICTION_RECORD / 4,
  NORMAL = offsetof(ct_point, row.normal), /* of a point, in bytes, as the next one */
  LEVER = offsetof(ct_point, d)
};

/* The stored slips of eight points along the present frames of their faces, or null: those of
 * space, turned into the present plane of contact with their lengths (eq:friction-turn). Their
 * components are `stride` apart. */
CT_INLINE void recall(double (*const t)[3][CT_BATCH], double (*const n)[CT_BATCH],
                      double (*const of)[CT_BATCH], int64_t stride, double *slip)
{
#pragma omp simd
  for (int l = 0; l < CT_BATCH; l++) {
    double e[3];
    for (int c = 0; c < 3; c++)
      e[c] = t == NULL ? of[c][l]
                       : (of[0][l] * t[0][c][l] + of[1][l] * t[1][c][l]) + of[2][l] * t[2][c][l];
    const double along = (n[0][l] * e[0] + n[1][l] * e[1]) + n[2][l] * e[2];
    for (int c = 0; c < 3; c++) e[c] -= along * n[c][l];
    const double length = sqrt((e[0] * e[0] + e[1] * e[1]) + e[2] * e[2]),
                 some = length > 0.0 ? length : 1.0, part = of[3][l] / some;
    // -- The length stays (eq:friction-turn)
    for (int c = 0; c < 3; c++) slip[stride * c + l] = e[c] * part;
  }
}

/* Eight points that are prepared together; the last of fewer fills all other lanes. Numbers first:
 * so all of them are aligned. */
typedef struct batch {
  double other[CT_BATCH];                    /* faces of the partners, as in a record */
  double last[CT_FRICTION_RECORD][CT_BATCH]; /* records, with OTHER 0 where nothing is recalled */
  double n[4][CT_BATCH], d[4][CT_BATCH]; /* normals of the rows, from the points to their partners,
                                            and what stands behind these */
  frames now, then;                      /* of the partners now; and where slips were stored */
  const ct_friction_point *at;
  int count; /* of these points */
} batch;

/* Forget what is not of a partner, lane by lane. */
CT_INLINE void forget(const ct_friction_call *now, batch *b)
{
  const double *other = b->last[OTHER],
               least = fmin(now->most_face[b->at[0].s], now->most_face[b->at[CT_BATCH - 1].s]);
  double all = 1.0;
#pragma omp simd reduction(min : all)
  for (int l = 0; l < CT_BATCH; l++) {
    const double own = other[l] >= 1.0 ? 1.0 : 0.0, met = other[l] <= least ? own : 0.0;
    all = met < all ? met : all;
  }
  for (int l = 0; l < CT_BATCH && all == 0.0; l++)
    if (!(other[l] >= 1.0 && other[l] <= now->most_face[b->at[l].s]))
      for (int i = OTHER; i < CT_FRICTION_RECORD; i++) b->last[i][l] = 0.0;
}

/* Four numbers of four lanes, side by side. */
CT_INLINE void turn_lanes(const double *const from[4], int l, double (*to)[CT_BATCH])
{
  double *const lanes[4] = {&to[0][l], &to[1][l], &to[2][l], &to[3][l]};
  ct_turn(from, lanes);
}

CT_INLINE void load_batch(const ct_friction_call *now, const ct_friction_memory *s, int64_t first,
                          batch *b)
{
  const int64_t left = s->listed_count - first;
  const int rigid = now->data->rigid;
  b->count = left < CT_BATCH ? (int)left : CT_BATCH;
  b->at = &s->listed[first];
  for (int l = 0; l < CT_BATCH; l++) b->other[l] = rigid ? 1.0 : b->at[l].point->other + 1.0;
  for (int l = 0; l < CT_BATCH; l += 4) {
    const double *normal[4], *d[4], *record[4];
    for (int k = 0; k < 4; k++) {
      const ct_friction_point *at = &b->at[l + k];
      normal[k] = (const double *)(const void *)((const char *)at->point + NORMAL);
      d[k] = (const double *)(const void *)((const char *)at->point + LEVER);
      record[k] = &now->at->memory[CT_FRICTION_RECORD * at->j];
    }
    turn_lanes(normal, l, b->n);
    if (!rigid) turn_lanes(d, l, b->d);
    for (int i = 0; i < QUADS; i++) {
      const double *const from[4] = {record[0] + 4 * i, record[1] + 4 * i, record[2] + 4 * i,
                                     record[3] + 4 * i};
      turn_lanes(from, l, &b->last[4 * i]);
    }
  }
  forget(now, b);
}

/* Whether four lanes from `l` on are points of one side that meet one face. */
CT_INLINE int meet_one_face(const batch *b, int l)
{
  for (int i = l + 1; i < l + 4; i++)
    if (b->at[i].s != b->at[l].s || b->other[i] != b->other[l]) return 0;
  return 1;
}

/* The faces of the partners of four lanes with one face, which has four nodes. */
CT_INLINE void load_four(const ct_search *search, const batch *b, int l, frames *f)
{
  load_edges(search, b->at[l].point->other, l, 4, f);
  for (int k = l; k < l + 4; k++)
    for (int i = 0; i < 2; i++) f->xi[i][k] = b->at[k].point->xi[i];
}

/* Whether points have met other faces than now, as eight lanes. */
CT_INLINE int have_changed(const batch *b)
{
  const double *last = b->last[OTHER], *other = b->other;
  double changed = 0.0;
#pragma omp simd reduction(max : changed)
  for (int l = 0; l < CT_BATCH; l++) {
    const double other_face = last[l] != other[l] ? 1.0 : 0.0,
                 own = last[l] != 0.0 ? other_face : 0.0;
    changed = own > changed ? own : changed;
  }
  return changed > 0.0;
}

/* The faces of the partners; and faces that are no longer partners, where their point was. Returns
 * whether there are such. */
CT_INLINE int load_frames(const ct_friction_call *now, batch *b)
{
  const int quads = now->data->quads;
  // Other faces may have fewer nodes than there are places.
  if (!quads) memset(&b->now, 0, sizeof b->now);
  for (int l = 0; l < CT_BATCH; l++) {
    const ct_search *other = ct_friction_other(now, b->at[l].s);
    if (quads && l % 4 == 0 && meet_one_face(b, l)) {
      load_four(other, b, l, &b->now);
      l += 3;
    } else {
      load_face(quads, other, b->at[l].point->other, b->at[l].point->xi, l, &b->now);
    }
  }
  if (!have_changed(b)) return 0;
  b->then = b->now;
  for (int l = 0; l < CT_BATCH; l++) {
    const int32_t face = (int32_t)b->last[OTHER][l] - 1;
    const double place[2] = {b->last[PLACE][l], b->last[PLACE + 1][l]};
    if (face >= 0 && face != b->at[l].point->other)
      load_face(quads, ct_friction_other(now, b->at[l].s), face, place, l, &b->then);
  }
  return 1;
}

/* Frames of all lanes, now and where slips were stored, and weights of the couples. */
CT_INLINE void find_all_frames(int quads, int changed, const ct_friction_memory *s, int64_t first,
                               batch *b)
{
  ct_face_axes *axes = &s->axes[first / CT_BATCH], unused;
  double *w = ct_friction_numbers(s, CT_SLIP_WEIGHT, first);
  find_frames(quads, &b->now, axes);
  if (quads) weigh_quads(&b->now, axes, s->slips.stride, w);
  else weigh(&b->now, axes, s->slips.stride, w);
  if (changed) find_frames(quads, &b->then, &unused);
}

/* The axes of an obstacle that a body carries turn with it. */
static void turn_axes(const ct_contact *obstacle, ct_face_axes *axes)
{
  for (int i = 0; i < 3; i++)
    for (int c = 0; c < 3; c++)
      for (int l = 0; l < CT_BATCH; l++) axes->a[i][c][l] = obstacle->carried.turn[c][i];
}

/* Elastic slips of all lanes. */
CT_INLINE void find_slips(double (*const t)[3][CT_BATCH], const ct_friction_memory *s,
                          int64_t first, batch *b)
{
  const int64_t stride = s->slips.stride;
  recall(t, b->n, &b->last[E], stride, ct_friction_numbers(s, CT_SLIP_E, first));
  recall(t, b->n, &b->last[BEFORE], stride, ct_friction_numbers(s, CT_SLIP_BEFORE, first));
}

/* Copy numbers of eight points, of which those of `from` and `to` are so many places apart. */
CT_INLINE void copy_numbers(int count, const double *from, int64_t apart, double *to,
                            int64_t stride)
{
  for (; count > 0; count--, from += apart, to += stride)
    for (int i = 0; i < CT_BATCH / 4 * CT_QUAD_PARTS; i++)
      ((ct_quad *)to)[i] = ((const ct_quad *)from)[i];
}

/* Give eight listed points what does not hang on their faces. */
CT_INLINE void give_points(const ct_friction_call *now, ct_friction_memory *s, int64_t first,
                           const batch *b)
{
  const ct_friction *data = now->data;
  double *normal = ct_friction_numbers(s, CT_SLIP_NORMAL, first);
  const int64_t to = s->slips.stride;
  copy_numbers(3, b->n[0], CT_BATCH, normal, to);
  copy_numbers(6, b->last[RESERVE], CT_BATCH, normal + to * CT_SLIP_RESERVE, to);
  copy_numbers(3, b->last[FORCE], CT_BATCH, normal + to * CT_SLIP_FORCE, to);
  if (!data->rigid) copy_numbers(3, b->d[0], CT_BATCH, normal + to * CT_SLIP_LEVER, to);
  for (int l = 0; l < CT_BATCH; l++)
    normal[to * CT_SLIP_K + l] = data->rho * b->at[l].point->row.stiffness;
  for (int l = 0; l < b->count; l++) {
    ct_slip *slip = &s->points[b->at[l].j];
    slip->at = first + l;
    b->at[l].point->row.slip = slip;
  }
  // -- The force of the explicit penalty is known: k ⟨-g⟩
  for (int l = 0; l < b->count && data->explicit; l++) {
    ct_constraint *row = &b->at[l].point->row;
    row->force = row->stiffness * fmax(-row->gap, 0.0);
  }
}

CT_CLONES
void ct_friction_prepare(const ct_friction_call *now, ct_friction_memory *s, int64_t first)
{
  batch b;
  load_batch(now, s, first, &b);
  give_points(now, s, first, &b);
  ct_face_axes *axes = &s->axes[first / CT_BATCH];
  if (now->data->rigid) {
    if (s->has_axes) turn_axes(now->at->on, axes);
    if (s->has_axes) find_slips(axes->a, s, first, &b);
    else find_slips(NULL, s, first, &b);
  } else {
    const int changed = load_frames(now, &b);
    if (now->data->quads) find_all_frames(1, changed, s, first, &b);
    else find_all_frames(0, changed, s, first, &b);
    find_slips(changed ? b.then.t : b.now.t, s, first, &b);
  }
}

/* Components of eight slips along the axes of their faces, or if `turned` is 0 those of space; and
 * their lengths. */
CT_INLINE void keep(int turned, const double *e, int64_t stride, const ct_face_axes *axes,
                    double (*restrict to)[CT_BATCH])
{
#pragma omp simd
  for (int l = 0; l < CT_BATCH; l++) {
    const double x = e[l], y = e[stride + l], z = e[2 * stride + l];
    to[0][l] = turned ? (x * axes->a[0][0][l] + y * axes->a[0][1][l]) + z * axes->a[0][2][l] : x;
    to[1][l] = turned ? (x * axes->a[1][0][l] + y * axes->a[1][1][l]) + z * axes->a[1][2][l] : y;
    to[2][l] = turned ? (x * axes->a[2][0][l] + y * axes->a[2][1][l]) + z * axes->a[2][2][l] : z;
    to[3][l] = sqrt((x * x + y * y) + z * z);
  }
}

/* The records of eight points but for their partners. */
CT_INLINE void find_records(const ct_friction_memory *s, int64_t first, double (*record)[CT_BATCH])
{
  const int64_t stride = s->slips.stride;
  const double *of = ct_friction_numbers(s, 0, first);
  const ct_face_axes *axes = &s->axes[first / CT_BATCH];
  if (!s->has_axes) {
    keep(0, of + stride * CT_SLIP_E, stride, axes, &record[E]);
    keep(0, of + stride * CT_SLIP_BEFORE, stride, axes, &record[BEFORE]);
  } else {
    keep(1, of + stride * CT_SLIP_E, stride, axes, &record[E]);
    keep(1, of + stride * CT_SLIP_BEFORE, stride, axes, &record[BEFORE]);
  }
  copy_numbers(6, of + stride * CT_SLIP_RESERVE, stride, record[RESERVE], CT_BATCH);
  copy_numbers(3, of + stride * CT_SLIP_FORCE, stride, record[FORCE], CT_BATCH);
}

/* The partners of eight points in their records; a record without a partner is 0. */
CT_INLINE void find_partners(int rigid, const ct_friction_point *at, const ct_face_axes *axes,
                             double (*record)[CT_BATCH])
{
  double force[CT_BATCH], some[CT_BATCH], all = 1.0;
  for (int l = 0; l < CT_BATCH; l++) {
    const ct_point *point = at[l].point;
    force[l] = point->row.force;
    record[OTHER][l] = rigid ? 1.0 : (double)point->other + 1.0;
    for (int i = 0; i < 2; i++) record[PLACE + i][l] = rigid ? 0.0 : point->xi[i];
  }
#pragma omp simd reduction(min : all)
  for (int l = 0; l < CT_BATCH; l++) {
    const double size = (fabs(axes->a[2][0][l]) + fabs(axes->a[2][1][l])) + fabs(axes->a[2][2][l]),
                 face = rigid || size > 0.0 ? 1.0 : 0.0, own = force[l] > 0.0 ? face : 0.0;
    some[l] = own;
    all = own < all ? own : all;
  }
  for (int l = 0; l < CT_BATCH && all == 0.0; l++)
    for (int i = 0; i < CT_FRICTION_RECORD && some[l] == 0.0; i++) record[i][l] = 0.0;
}

/* Write four records, number after number. */
CT_INLINE void write_four(double (*const record)[CT_BATCH], int l, double *const next[4])
{
  for (int i = 0; i < QUADS; i++) {
    const double *from[4];
    double *to[4];
    for (int k = 0; k < 4; k++) from[k] = &record[4 * i + k][l], to[k] = next[k] + 4 * i;
    ct_turn(from, to);
  }
}

CT_CLONES
void ct_friction_store(const ct_friction_call *now, ct_friction_memory *s, int64_t first)
{
  double record[CT_FRICTION_RECORD][CT_BATCH], unused[CT_FRICTION_RECORD];
  const ct_friction_point *at = &s->listed[first];
  const ct_face_axes *axes = &s->axes[first / CT_BATCH];
  find_records(s, first, record);
  if (now->data->rigid) find_partners(1, at, axes, record);
  else find_partners(0, at, axes, record);
  for (int l = 0; l < CT_BATCH; l += 4) {
    double *next[4];
    for (int k = 0; k < 4; k++)
      next[k] = first + l + k < s->listed_count
                    ? &now->at->next_memory[CT_FRICTION_RECORD * at[l + k].j]
                    : unused;
    write_four(record, l, next);
  }
}
