/* What friction stores of its points from step to step, and what it gives the solver. */
#include "friction_internal.h"

#include "../base/lanes.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* Faces of eight points side by side, lane by lane: their nodes, the derivatives of their shape
 * functions at a point, tangents, unit normal and the vectors a^i; all 0 where there is none. */
typedef struct frames {
  int quads; /* whether all have four nodes: then the derivatives follow from `xi` */
  double xi[2][CT_BATCH];
  double x[8][3][CT_BATCH], dN[8][2][CT_BATCH], t[3][3][CT_BATCH];
  ct_face_axes axes;
  double w[8][3][CT_BATCH]; /* weights of the couple */
} frames;

/* The nodes of a face, in some lanes. */
CT_INLINE void load_nodes(const ct_search *search, int per, int32_t face, int lane, int lanes,
                          frames *f)
{
  const int32_t *node = &search->faces[(int64_t)face * per];
  for (int b = 0; b < per; b++) {
    const double *x = &search->x[3 * (int64_t)node[b]];
    for (int c = 0; c < 3; c++)
      for (int l = lane; l < lane + lanes; l++) f->x[b][c][l] = x[c];
  }
}

/* Nodes and derivatives of one lane. */
static void load_face(const ct_search *search, int32_t face, const double xi[2], int lane,
                      frames *f)
{
  double dN[8][2];
  load_nodes(search, search->per, face, lane, 1, f);
  for (int i = 0; i < 2; i++) f->xi[i][lane] = xi[i];
  if (f->quads) return;
  ct_segment_gradient(search->kind, xi, dN);
  for (int b = 0; b < search->per; b++)
    for (int i = 0; i < 2; i++) f->dN[b][i][lane] = dN[b][i];
}

/* Tangents t_i = Σ ∂_i N̄_b x_b, paired so that a flipped face gives the same bits (eq:tree-sum);
 * `count` is 4, or 8 with zeros behind the nodes. */
CT_INLINE void find_tangents(int count, frames *f)
{
  for (int i = 0; i < 2; i++)
    for (int c = 0; c < 3; c++)
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++) {
        double v[8];
        for (int b = 0; b < count; b++) v[b] = f->dN[b][i][l] * f->x[b][c][l];
        const double corners = (v[0] + v[1]) + (v[2] + v[3]);
        f->t[i][c][l] = count == 4 ? corners : corners + ((v[4] + v[6]) + (v[5] + v[7]));
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
                        (*n)[CT_BATCH] = f->t[2], (*dual)[3][CT_BATCH] = f->axes.a;
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
      dual[0][c][l] = (m22 * t0[c][l] - m12 * t1[c][l]) / det;
      dual[1][c][l] = (m11 * t1[c][l] - m12 * t0[c][l]) / det;
    }
  }
  for (int l = 0; l < CT_BATCH; l++)
    for (int c = 0; c < 3 && has[l] == 0.0; c++)
      n[c][l] = t0[c][l] = t1[c][l] = dual[0][c][l] = dual[1][c][l] = 0.0;
  memcpy(dual[2], n, sizeof dual[2]);
}

/* The weights of the couple (eq:slip-row). */
CT_INLINE void weigh(int count, frames *f)
{
  for (int b = 0; b < count; b++)
    for (int c = 0; c < 3; c++)
#pragma omp simd
      for (int l = 0; l < CT_BATCH; l++)
        // -- w_b = Σ_i ∂_i N̄_b a^i (eq:slip-row)
        f->w[b][c][l] = f->dN[b][0][l] * f->axes.a[0][c][l] + f->dN[b][1][l] * f->axes.a[1][c][l];
}

/* Elastic slips of eight points, side by side: as they were stored, and afterwards along the axes
 * of space. */
typedef struct slips {
  double part[3][CT_BATCH], length[CT_BATCH];
} slips;

static void load_slip(const ct_slip_memory *from, int lane, slips *to)
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
  ct_friction_place at[CT_BATCH];
  ct_point *point[CT_BATCH];
  ct_slip_record last[CT_BATCH]; /* with `other` 0 where nothing is recalled */
  double n[3][CT_BATCH];         /* normals of the rows */
  frames now, then;              /* of the partners now; and where slips were stored */
  slips e, before;
} batch;

static void load_batch(const ct_friction_call *now, const ct_friction_memory *s, int64_t first,
                       batch *b)
{
  for (int l = 0; l < CT_BATCH; l++) {
    const int64_t n = first + l < s->listed_count ? first + l : s->listed_count - 1;
    const ct_friction_place at = b->at[l] = ct_friction_place_of(now, s->listed[n]);
    ct_slip_record *last = &b->last[l];
    b->point[l] = &now->side[at.s]->points[at.i];
    memcpy(last, &now->at->memory[CT_FRICTION_RECORD * at.j], sizeof *last);
    const double most = now->data->rigid ? 1.0 : (double)ct_friction_other(now, at.s)->face_count;
    // -- At t = 0 forces are solved for twice: the second time from those of the first
    if (!(last->other >= 1.0 && last->other <= most) || now->at->before == 0.0) {
      last->other = 0.0;
      last->e = last->before = (ct_slip_memory){.length = 0.0};
      last->reserve = last->stuck = 0.0;
    }
    for (int c = 0; c < 3; c++) b->n[c][l] = b->point[l]->row.normal[c];
    load_slip(&last->e, l, &b->e), load_slip(&last->before, l, &b->before);
  }
}

/* Whether four lanes from `l` on are points of one side that meet one face. */
static int meet_one_face(const batch *b, int l)
{
  for (int i = l + 1; i < l + 4; i++)
    if (b->at[i].s != b->at[l].s || b->point[i]->other != b->point[l]->other) return 0;
  return 1;
}

/* The faces of the partners of four lanes with one face, which has four nodes. */
static void load_four(const ct_search *search, const batch *b, int l, frames *f)
{
  load_nodes(search, 4, b->point[l]->other, l, 4, f);
  for (int k = l; k < l + 4; k++)
    for (int i = 0; i < 2; i++) f->xi[i][k] = b->point[k]->xi[i];
}

/* The faces of the partners; and faces that are no longer partners, where their point was. Returns
 * whether there are such. */
static int load_frames(const ct_friction_call *now, batch *b)
{
  int changed = 0;
  b->now.quads = now->data->quads;
  // Other faces may have fewer nodes than there are places.
  if (!b->now.quads) memset(&b->now, 0, sizeof b->now);
  for (int l = 0; l < CT_BATCH; l++) {
    const ct_search *other = ct_friction_other(now, b->at[l].s);
    if (b->now.quads && l % 4 == 0 && meet_one_face(b, l)) {
      load_four(other, b, l, &b->now);
      l += 3;
    } else {
      load_face(other, b->point[l]->other, b->point[l]->xi, l, &b->now);
    }
  }
  for (int l = 0; l < CT_BATCH; l++)
    changed |= b->last[l].other != 0.0 && b->last[l].other != b->point[l]->other + 1.0;
  if (!changed) return 0;
  b->then = b->now;
  for (int l = 0; l < CT_BATCH; l++) {
    const int32_t face = (int32_t)b->last[l].other - 1;
    if (face >= 0 && face != b->point[l]->other)
      load_face(ct_friction_other(now, b->at[l].s), face, b->last[l].place, l, &b->then);
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

/* The frames of all lanes. */
CT_INLINE void find_frames(int count, frames *f)
{
  if (count == 4) {
#pragma omp simd
    for (int l = 0; l < CT_BATCH; l++)
      ct_shape_gradient_q4(f->xi[0][l], f->xi[1][l], &f->dN[0][0][l], CT_BATCH);
  }
  find_tangents(count, f);
  find_dual(f);
}

/* Frames, weights of the couples and elastic slips of all lanes. */
CT_CLONES
static void find_slips(int rigid, int changed, batch *b)
{
  if (rigid) {
    take_axes_of_space(&b->now);
  } else if (b->now.quads) {
    find_frames(4, &b->now);
    weigh(4, &b->now);
  } else {
    find_frames(8, &b->now);
    weigh(8, &b->now);
  }
  if (changed && b->now.quads) find_frames(4, &b->then);
  else if (changed) find_frames(8, &b->then);
  recall(changed ? b->then.t : b->now.t, b->n, &b->e);
  recall(changed ? b->then.t : b->now.t, b->n, &b->before);
}

/* The weights of the couple of one lane, with `per` nodes. */
CT_INLINE void store_weights(const frames *f, int l, int per, const double d[3], ct_slip *p)
{
  for (int c = 0; c < 3; c++) p->lever[c] = d[c];
  for (int b = 0; b < per; b++)
    for (int c = 0; c < 3; c++) p->weight[b][c] = f->w[b][c][l];
}

/* Give one listed point its friction in the next step. */
static void store_point(const ct_friction_call *now, ct_friction_memory *s, const batch *b, int l)
{
  const ct_friction *data = now->data;
  const ct_contact *contact = now->at->on;
  ct_point *point = b->point[l];
  const ct_slip_record *last = &b->last[l];
  const int64_t j = b->at[l].j;
  ct_slip *p = &s->points[j];
  point->row.slip = p;
  p->work = p->lag = 0.0;
  p->mu = data->mu;
  p->moves = data->rigid && contact->fixed->moves;
  p->k = data->rho * point->row.stiffness;
  p->reserve = last->reserve, p->stuck = last->stuck != 0.0;
  for (int c = 0; c < 3; c++) {
    p->e[c] = b->e.part[c][l], p->before[c] = b->before.part[c][l];
    p->force[c] = now->at->before > 0.0 ? -p->k * p->e[c] : last->force[c];
    if (!p->moves) continue;
    p->came[c] = contact->part * contact->came[c];
    p->coming[c] = contact->coming[c];
  }
  if (data->quads) store_weights(&b->now, l, 4, point->d, p);
  else if (!data->rigid)
    store_weights(&b->now, l, ct_friction_other(now, b->at[l].s)->per, point->d, p);
  // -- The force of the explicit penalty is known: k ⟨-g⟩
  if (data->explicit) point->row.force = point->row.stiffness * fmax(-point->row.gap, 0.0);
}

void ct_friction_prepare(const ct_friction_call *now, ct_friction_memory *s, int64_t first)
{
  const int rigid = now->data->rigid;
  batch b;
  load_batch(now, s, first, &b);
  find_slips(rigid, !rigid && load_frames(now, &b), &b);
  if (!rigid) s->axes[first / CT_BATCH] = b.now.axes;
  for (int l = 0; l < CT_BATCH && first + l < s->listed_count; l++) store_point(now, s, &b, l);
}

/* Components of a slip along the axes of a face in lane `l`, or null: those of space. */
static inline void keep(const double e[3], const ct_face_axes *axes, int l, ct_slip_memory *to)
{
  if (axes == NULL) {
    memcpy(to->part, e, sizeof to->part);
  } else {
    for (int i = 0; i < 3; i++)
      to->part[i] = (e[0] * axes->a[i][0][l] + e[1] * axes->a[i][1][l]) + e[2] * axes->a[i][2][l];
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

/* Whether a face has axes in lane `l`. */
static int has_axes(const ct_face_axes *axes, int l)
{
  return axes->a[2][0][l] != 0.0 || axes->a[2][1][l] != 0.0 || axes->a[2][2][l] != 0.0;
}

void ct_friction_store(const ct_friction_call *now, ct_friction_memory *s, int64_t n)
{
  const ct_friction_place at = ct_friction_place_of(now, s->listed[n]);
  const ct_point *point = &now->side[at.s]->points[at.i];
  const ct_slip *p = &s->points[at.j];
  const int rigid = now->data->rigid, l = (int)(n % CT_BATCH);
  const ct_face_axes *axes = rigid ? NULL : &s->axes[n / CT_BATCH];
  const int nodes = now->data->other_nodes;
  ct_slip_record *next = (ct_slip_record *)&now->at->next_memory[CT_FRICTION_RECORD * at.j];
  s->terms[at.j] = nodes == 4 ? turn_of(4, p, s->turn[at.j]) : turn_of(nodes, p, s->turn[at.j]);
  s->stored[n] = ct_slip_stored(p), s->work[n] = p->work, s->lag[n] = p->lag;
  if (!(point->row.force > 0.0 && (rigid || has_axes(axes, l)))) {
    *next = (ct_slip_record){.other = 0.0};
    return;
  }
  next->other = rigid ? 1.0 : (double)point->other + 1.0;
  for (int i = 0; i < 2; i++) next->place[i] = rigid ? 0.0 : point->xi[i];
  keep(p->e, axes, l, &next->e);
  keep(p->before, axes, l, &next->before);
  next->reserve = p->reserve;
  next->stuck = p->stuck;
  memcpy(next->force, p->force, sizeof next->force);
}
