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
  face_axes *axes;         /* of each point, from the list of rows to the forces */
  const ct_pieces *pieces; /* those of the sides */
  double *coarse, *fine;   /* sums at the nodes */
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

/* Tangents and unit normal of a face at ξ. Returns 0 if there is no normal. */
static int frame(const ct_search *search, int32_t face, const double xi[2], double t[3][3])
{
  ct_face nodes;
  ct_search_face(search, face, &nodes);
  ct_segment_tangents(&nodes, xi, t[0], t[1]);
  return ct_vector_unit_normal(t[0], t[1], t[2]);
}

/* Vectors a^i with a^i · t_j = δ_ij in the plane of two tangents (eq:friction-components). */
static void dual_frame(double (*const t)[3], double dual[2][3])
{
  const double m11 = ct_vector_dot(t[0], t[0]), m22 = ct_vector_dot(t[1], t[1]),
               m12 = ct_vector_dot(t[0], t[1]), det = m11 * m22 - m12 * m12;
  for (int k = 0; k < 3; k++) {
    // -- a^i = m^{ij} t_j, with the inverse of a matrix of two rows (eq:friction-components)
    dual[0][k] = (m22 * t[0][k] - m12 * t[1][k]) / det;
    dual[1][k] = (m11 * t[1][k] - m12 * t[0][k]) / det;
  }
}

/* The stored slip along the present frame of the old partner's face, turned into the present plane
 * of contact with its length (eq:friction-turn). */
static void recall(const slip_memory *from, double (*const t)[3], const double n[3], double e[3])
{
  for (int c = 0; c < 3; c++)
    e[c] = t == NULL
               ? from->part[c]
               : (from->part[0] * t[0][c] + from->part[1] * t[1][c]) + from->part[2] * t[2][c];
  ct_vector_make_tangential(n, e);
  const double length = sqrt(ct_vector_dot(e, e));
  // -- The length stays (eq:friction-turn)
  for (int c = 0; c < 3; c++) e[c] *= length > 0.0 ? from->length / length : 0.0;
}

/* The elastic slips, the reserve and the stick of a point in the last step. */
static void recall_point(const call *now, int s, const slip_record *last, const double n[3],
                         ct_slip *p)
{
  const ct_search *other = now->side[now->data->sides - 1 - s]->search;
  const int rigid = now->data->rigid;
  double t[3][3];
  int met = last->other >= 1.0 && last->other <= (rigid ? 1.0 : (double)other->face_count);
  if (met && !rigid) met = frame(other, (int32_t)last->other - 1, last->place, t);
  if (!met) return;
  recall(&last->e, rigid ? NULL : t, n, p->e);
  recall(&last->before, rigid ? NULL : t, n, p->before);
  p->reserve = last->reserve;
  p->stuck = last->stuck != 0.0;
}

/* The weights of the couple on the partner's face (eq:slip-row). */
static void weigh(const call *now, int s, const ct_point *point, face_axes *axes, ct_slip *p)
{
  const ct_search *other = now->side[now->data->sides - 1 - s]->search;
  double t[3][3], dN[8][2], (*const dual)[3] = axes->dual;
  memset(axes, 0, sizeof *axes);
  if (!frame(other, point->other, point->xi, t)) return;
  dual_frame(t, dual);
  memcpy(axes->n, t[2], sizeof axes->n);
  ct_segment_gradient(other->kind, point->xi, dN);
  for (int b = 0; b < other->per; b++)
    for (int c = 0; c < 3; c++)
      // -- w_b = Σ_i ∂_i N̄_b a^i (eq:slip-row)
      p->weight[b][c] = dN[b][0] * dual[0][c] + dN[b][1] * dual[1][c];
  memcpy(p->lever, point->d, 3 * sizeof *p->lever);
}

/* Give point `i` of side `s` its friction in the next step, if its row is listed. */
static void prepare(const call *now, int s, int64_t i, int64_t at, face_axes *axes, ct_slip *p)
{
  const friction *data = now->data;
  const ct_contact *contact = now->at->on;
  ct_point *point = &now->side[s]->points[i];
  slip_record last;
  memset(p, 0, sizeof *p);
  point->row.slip = point->listed ? p : NULL;
  if (!point->listed) return;
  memcpy(&last, &now->at->memory[at], sizeof last);
  p->mu = data->mu;
  p->k = data->rho * point->row.stiffness;
  // -- At t = 0 forces are solved for twice: the second time from those of the first
  if (now->at->before > 0.0) recall_point(now, s, &last, point->row.normal, p);
  for (int c = 0; c < 3; c++) p->force[c] = now->at->before > 0.0 ? -p->k * p->e[c] : last.force[c];
  if (!data->rigid) weigh(now, s, point, axes, p);
  for (int c = 0; c < 3 && data->rigid; c++)
    p->came[c] = contact->came[c], p->coming[c] = contact->coming[c];
  // -- The force of the explicit penalty is known: k ⟨-g⟩
  if (data->explicit) point->row.force = point->row.stiffness * fmax(-point->row.gap, 0.0);
}

/* Components of a slip along the axes of a face, or null: those of space. */
static void keep(const double e[3], const face_axes *axes, slip_memory *to)
{
  for (int c = 0; c < 3; c++)
    to->part[c] = axes == NULL ? e[c] : ct_vector_dot(e, c < 2 ? axes->dual[c] : axes->n);
  to->length = sqrt(ct_vector_dot(e, e));
}

/* Store what the next step needs of point `i` of side `s`. */
static void store(const call *now, int s, int64_t i, int64_t at, const face_axes *axes,
                  const ct_slip *p)
{
  const ct_point *point = &now->side[s]->points[i];
  const int rigid = now->data->rigid;
  slip_record next = {.other = 0.0};
  if (rigid) axes = NULL;
  if (point->listed && point->row.force > 0.0 && (rigid || ct_vector_dot(axes->n, axes->n) > 0.0)) {
    next.other = rigid ? 1.0 : (double)point->other + 1.0;
    if (!rigid) memcpy(next.place, point->xi, sizeof next.place);
    keep(p->e, axes, &next.e);
    keep(p->before, axes, &next.before);
    next.reserve = p->reserve;
    next.stuck = p->stuck;
    memcpy(next.force, p->force, sizeof next.force);
  }
  memcpy(&now->at->next_memory[at], &next, sizeof next);
}

/* Largest force at a node of a point. */
static double largest(const friction_state *s, int64_t count)
{
  double top = 0.0;
  for (const ct_slip *p = s->points; p < s->points + count; p++) {
    double turn = 0.0;
    for (int b = 0; b < s->data->other_nodes; b++) {
      const double size = fabs(ct_vector_dot(p->weight[b], p->force));
      turn = size > turn ? size : turn;
    }
    for (int c = 0; c < 3; c++) {
      const double size = fabs(p->force[c]), couple = turn * fabs(p->lever[c]);
      top = size > top ? size : top;
      top = couple > top ? couple : top;
    }
  }
  return top;
}

/* Add the tractions and couples of the points of side `k` to the sums at the nodes. */
CT_INLINE void add_side(int stride, const call *now, int k, const ct_grid *grid, const ct_slip *p,
                        friction_state *s)
{
  const ct_side_fixed *side = now->data->side[k],
                      *other = now->data->side[now->data->sides - 1 - k];
  ct_heap own = {s->coarse, s->fine, side->search->per, NULL, {0}, {0}},
          theirs = {s->coarse, s->fine, other->search->per, NULL, {0}, {0}};
  for (int64_t i = 0; i < side->point_count; i++, p++) {
    const ct_point *point = &now->side[k]->points[i];
    const double back[3] = {-p->force[0], -p->force[1], -p->force[2]},
                 lever[3] = {-p->lever[0], -p->lever[1], -p->lever[2]};
    double turn[8];
    if (ct_vector_dot(p->force, p->force) == 0.0) continue;
    // -- N_a T on the own face; -N̄_b T - (w_b · T) d on the other (eq:slip-row)
    ct_heap_add(stride, grid, point->row.own, point->row.own_shape, p->force, &own);
    if (now->data->rigid) continue;
    const int32_t *node = ct_side_row_nodes(other, point->other);
    ct_heap_add(stride, grid, node, point->N, back, &theirs);
    for (int b = 0; b < 8; b++) turn[b] = ct_vector_dot(p->weight[b], p->force);
    ct_heap_add(stride, grid, node, turn, lever, &theirs);
  }
  ct_heap_bring(stride, &own, NULL);
  ct_heap_bring(stride, &theirs, NULL);
}

/* Tractions and couples of the points of side `k`, of faces with at most four nodes or with more.
 */
CT_CLONES
static void push(const call *now, int k, const ct_grid *grid, const ct_slip *p, friction_state *s)
{
  if (now->data->side[0]->search->per <= 4 &&
      now->data->side[now->data->sides - 1]->search->per <= 4)
    add_side(4, now, k, grid, p, s);
  else add_side(8, now, k, grid, p, s);
}

/* Tractions and couples of all points at the nodes, in sums that do not depend on their order
 * (eq:slip-row). */
static ct_status gather(const call *now, friction_state *s, int32_t nodes, double *force,
                        ct_error *error)
{
  const friction *data = now->data;
  const size_t size = 3 * (size_t)nodes * sizeof *force;
  double top = largest(s, data->points);
  ct_grid grid;
  ct_pieces_largest(s->pieces, &top, 1);
  memset(s->coarse, 0, size);
  memset(s->fine, 0, size);
  if (top > 0.0 && !ct_grid_init(&grid, 2.0 * top, 24 * data->points))
    return ct_fail(
        error, CT_ERROR_BLOWUP, CT_NOWHERE,
        "friction: the largest force, %g, is too large or not finite; the motion has diverged",
        top);
  const ct_slip *p = s->points;
  for (int k = 0; top > 0.0 && k < data->sides; k++) {
    push(now, k, &grid, p, s);
    p += data->side[k]->point_count;
  }
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

/* Prepare all points for the solver, or afterwards store what it found. */
static void treat(friction_state *s, const call *now, int solved)
{
  int64_t first = 0;
  for (int k = 0; k < s->data->sides; k++) {
    const int64_t count = s->data->side[k]->point_count;
#ifdef _OPENMP
    const int threads = ct_threads_for(now->at->threads, count, LEAST_POINTS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
    for (int64_t i = 0; i < count; i++) {
      const int64_t j = first + i, at = RECORD * j;
      if (solved) store(now, k, i, at, &s->axes[j], &s->points[j]);
      else prepare(now, k, i, at, &s->axes[j], &s->points[j]);
    }
    first += count;
  }
}

/* The rows of the explicit penalty are listed here, because its contact lists none. */
static int64_t list_rows(void *state, const ct_surface_motion *at, ct_constraint **rows)
{
  friction_state *s = state;
  const int64_t count = s->data->explicit ? ct_contact_list_rows(at->on, at->dt, rows) : 0;
  const call now = begin(s, at);
  treat(s, &now, 0);
  return count;
}

/* Σ of one number of each point. */
static double sum_points(friction_state *s, double (*of)(const ct_slip *p))
{
  for (int64_t i = 0; i < s->data->points; i++) s->terms[i] = of(&s->points[i]);
  return ct_sum_over(s->pieces, s->terms, s->data->points);
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
  count_energy(s);
  ct_status status = gather(&now, s, data->is.node_count, force, error);
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
  s->axes = ct_pool_take(&s->pool, (size_t)data->points, sizeof *s->axes);
  s->terms = ct_pool_take(&s->pool, (size_t)data->points + nodes, sizeof *s->terms);
  s->coarse = ct_pool_take(&s->pool, nodes, 3 * sizeof(double));
  s->fine = ct_pool_take(&s->pool, nodes, 3 * sizeof(double));
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
