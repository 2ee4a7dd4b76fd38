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

/* Tangents and unit normal of a face with the derivatives dN of its shape functions. Returns 0 if
 * there is no normal. */
static int frame(const ct_search *search, int32_t face, double (*dN)[2], double t[3][3])
{
  for (int i = 0; i < 2; i++) {
    double weight[8];
    for (int b = 0; b < 8; b++) weight[b] = dN[b][i];
    ct_side_interpolate(search, search->x, face, weight, NULL, t[i]);
  }
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
  const double length = sqrt(ct_vector_dot(e, e)),
               part = length > 0.0 ? from->length / length : 0.0;
  // -- The length stays (eq:friction-turn)
  for (int c = 0; c < 3; c++) e[c] *= part;
}

/* The elastic slips, the reserve and the stick of a point in the last step. `t` is the frame of its
 * partner at the closest point, or null; a face that is its partner no longer has its own one. */
static void recall_point(const call *now, place at, const ct_point *point, double (*t)[3],
                         const slip_record *last, ct_slip *p)
{
  const int rigid = now->data->rigid;
  const ct_search *other = rigid ? NULL : search_of_other(now, at.s);
  double old[3][3], dN[8][2];
  int met = last->other >= 1.0 && last->other <= (rigid ? 1.0 : (double)other->face_count);
  if (met && !rigid && ((int32_t)last->other - 1 != point->other || t == NULL)) {
    t = old;
    ct_segment_gradient(other->kind, last->place, dN);
    met = frame(other, (int32_t)last->other - 1, dN, t);
  }
  if (!met) return;
  recall(&last->e, t, point->row.normal, p->e);
  recall(&last->before, t, point->row.normal, p->before);
  p->reserve = last->reserve;
  p->stuck = last->stuck != 0.0;
}

/* The weights of the couple on the partner's face, and its frame (eq:slip-row). Returns 0 if there
 * is none. */
static int weigh(const call *now, place at, const ct_point *point, face_axes *axes, double t[3][3],
                 ct_slip *p)
{
  const ct_search *other = search_of_other(now, at.s);
  double dN[8][2], (*const dual)[3] = axes->dual;
  memset(axes, 0, sizeof *axes);
  ct_segment_gradient(other->kind, point->xi, dN);
  const int has = frame(other, point->other, dN, t);
  if (has) dual_frame(t, dual);
  if (has) memcpy(axes->n, t[2], sizeof axes->n);
  for (int b = 0; b < other->per; b++)
    for (int c = 0; c < 3; c++)
      // -- w_b = Σ_i ∂_i N̄_b a^i (eq:slip-row)
      p->weight[b][c] = dN[b][0] * dual[0][c] + dN[b][1] * dual[1][c];
  memcpy(p->lever, point->d, 3 * sizeof *p->lever);
  return has;
}

/* A point that was not listed before: of the weights only those of its partner's nodes are ever
 * written. */
static void clear(ct_slip *p)
{
  ct_slip_open(p);
  for (int c = 0; c < 3; c++) p->came[c] = p->coming[c] = p->lever[c] = 0.0;
}

/* Give a listed point its friction in the next step. */
static void prepare(const call *now, friction_state *s, place at)
{
  const friction *data = now->data;
  const ct_contact *contact = now->at->on;
  ct_point *point = &now->side[at.s]->points[at.i];
  ct_slip *p = &s->points[at.j];
  slip_record last;
  double t[3][3];
  clear(p);
  point->row.slip = p;
  memcpy(&last, &now->at->memory[RECORD * at.j], sizeof last);
  p->mu = data->mu;
  p->k = data->rho * point->row.stiffness;
  const int has = !data->rigid && weigh(now, at, point, &s->axes[at.j], t, p);
  // -- At t = 0 forces are solved for twice: the second time from those of the first
  if (now->at->before > 0.0) recall_point(now, at, point, has ? t : NULL, &last, p);
  for (int c = 0; c < 3; c++) p->force[c] = now->at->before > 0.0 ? -p->k * p->e[c] : last.force[c];
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

/* The weights of a point's couple, for the nodes of the other face; returns its largest force at a
 * node. */
static double turn_of(const friction_state *s, int64_t j)
{
  const ct_slip *p = &s->points[j];
  double turn = 0.0, arm = 0.0, top = 0.0;
  for (int b = 0; b < s->data->other_nodes; b++) {
    const double w = s->turn[j][b] = ct_vector_dot(p->weight[b], p->force), size = fabs(w);
    turn = size > turn ? size : turn;
  }
  for (int c = 0; c < 3; c++) {
    const double size = fabs(p->force[c]), length = fabs(p->lever[c]);
    top = size > top ? size : top;
    arm = length > arm ? length : arm;
  }
  return turn * arm > top ? turn * arm : top;
}

/* Store what the next step needs of a listed point. */
static void store(const call *now, friction_state *s, place at)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const ct_slip *p = &s->points[at.j];
  const int rigid = now->data->rigid;
  const face_axes *axes = rigid ? NULL : &s->axes[at.j];
  slip_record next = {.other = 0.0};
  s->terms[at.j] = turn_of(s, at.j);
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
CT_INLINE void add_four(int stride, const call *now, const ct_grid *grid, place at,
                        const friction_state *s, const heaps *to)
{
  const ct_point *point = &now->side[at.s]->points[at.i];
  const double *N[4], *N_bar[4], *turn[4], *force[4], *against[4], *arm[4];
  double back[4][3], lever[4][3];
  for (int q = 0; q < 4; q++) {
    const ct_slip *p = &s->points[at.j + q];
    for (int c = 0; c < 3; c++) back[q][c] = -p->force[c], lever[q][c] = -p->lever[c];
    N[q] = point[q].row.own_shape, N_bar[q] = point[q].N, turn[q] = s->turn[at.j + q];
    force[q] = p->force, against[q] = back[q], arm[q] = lever[q];
  }
  // -- N_a T on the own face; -N̄_b T - (w_b · T) d on the other (eq:slip-row)
  ct_heap_add_four(stride, grid, point->row.own, N, force, &to->own);
  if (now->data->rigid) return;
  const int32_t *node = ct_side_row_nodes(to->other, point->other);
  ct_heap_add_four(stride, grid, node, N_bar, against, &to->theirs);
  ct_heap_add_four(stride, grid, node, turn, arm, &to->theirs);
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
    if (four) add_four(stride, now, grid, at, s, &to);
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
  for (int64_t n = 0; n < s->listed_count; n++) {
    const place at = place_of(now, s->listed[n]);
    if (solved) store(now, s, at);
    else prepare(now, s, at);
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
