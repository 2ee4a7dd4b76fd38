/* Coulomb friction with stick on the points of a contact or of an obstacle. */
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../base/vector.h"
#include "contact_internal.h"
#include "heap.h"

#include <math.h>
#include <string.h>

/* Constant data: friction acts on a contact or, if `rigid`, on an obstacle, with one or two sides.
 */
typedef struct friction {
  ct_interaction is;
  double mu, rho;
  int rigid, sides;
  const ct_side_fixed *side[2];
  int64_t points;
  const double *mass; /* in the numbering of the surfaces; null without a limit */
  ct_friction_room room;
} friction;

/* One point: its tangential traction, and the couple that balances its moment. */
typedef struct slip_point {
  double k;         /* tangential stiffness ρ k; 0 if the point is open */
  double s[3];      /* elastic slip */
  double force[3];  /* -k s, on the point's own face */
  double couple[3]; /* k d, which acts on the other face with the weights q */
  double q[8];      /* Σ_i c^i dN_b/dξ_i */
  double lost;      /* dissipated so far */
} slip_point;

/* Memory of friction for one point. */
typedef struct slip_record {
  double other;    /* face of the other side plus one, 1 at an obstacle; 0: open */
  double place[3]; /* of the closest point: its parameters; at an obstacle, relative to that */
  double slip[3];  /* along the face's tangents and normal; at an obstacle, along the axes */
  double lost;     /* dissipated so far */
} slip_record;

/* And behind all points: whether there was an earlier call, and its time; force of friction on an
 * obstacle then, and the work of its motion against it. */
typedef struct tail_record {
  double begun, time, reaction[3], motion;
} tail_record;
enum { RECORD = sizeof(slip_record) / sizeof(double), TAIL = sizeof(tail_record) / sizeof(double) };

typedef struct friction_state {
  ct_pool pool;
  const friction *data;
  slip_point *points;
  const ct_pieces *pieces; /* those of the sides */
  double *coarse, *fine;   /* sums at the nodes */
  double *rows;            /* row sums of the stiffness there */
  double *terms;           /* one number per point or node */
  tail_record tail;
} friction_state;

/* Data shared by the points of one call: the sides now, and the time since the last call (0: there
 * was none). */
typedef struct call {
  const friction *data;
  const ct_surface_motion *at;
  const ct_side *side[2];
  double dt;
} call;

double ct_friction_return(double limit, double slip[3])
{
  double length = sqrt(ct_vector_dot(slip, slip));
  if (!(length > limit)) return 0.0;
  // -- Shorten the slip to what friction can hold (eq:friction-return)
  for (int c = 0; c < 3; c++) slip[c] *= limit / length;
  return length - limit;
}

/* Tangents and unit normal of a face at ξ. Returns 0 if there is no normal. */
static int frame(const ct_search *search, int32_t face, const double xi[2], double t1[3],
                 double t2[3], double n[3])
{
  ct_face nodes;
  ct_search_face(search, face, &nodes);
  ct_segment_tangents(&nodes, xi, t1, t2);
  return ct_vector_unit_normal(t1, t2, n);
}

/* Contravariant components of the part of v in the plane of two tangents (eq:friction-components).
 */
static void components(const double t1[3], const double t2[3], const double v[3], double c[2])
{
  double m11 = ct_vector_dot(t1, t1), m22 = ct_vector_dot(t2, t2), m12 = ct_vector_dot(t1, t2);
  double b1 = ct_vector_dot(v, t1), b2 = ct_vector_dot(v, t2);
  double det = m11 * m22 - m12 * m12;
  // -- c^i = m^{ij} (v · t_j), the inverse of a matrix of two rows (eq:friction-components)
  c[0] = (m22 * b1 - m12 * b2) / det;
  c[1] = (m11 * b2 - m12 * b1) / det;
}

/* Whether parameters lie inside a face and not on its edges. */
static int is_inside(ct_face_kind kind, const double xi[2])
{
  if (kind == CT_T3 || kind == CT_T6) return xi[0] > 0.0 && xi[1] > 0.0 && xi[0] + xi[1] < 1.0;
  return fabs(xi[0]) < 1.0 && fabs(xi[1]) < 1.0;
}

/* Displacement increment of a material point of a face since the last call: the leapfrog's Δt
 * v_{n-1/2}. */
static void increment_of(const call *now, int s, int64_t face, const double N[8], double out[3])
{
  const int per = now->side[s]->search->per;
  const int32_t *node = ct_side_row_nodes(now->side[s]->fixed, face);
  for (int c = 0; c < 3; c++) {
    double t[8] = {0.0};
    for (int a = 0; a < per; a++) t[a] = N[a] * now->at->velocity[3 * (int64_t)node[a] + c];
    out[c] = now->dt * ct_side_sum(per, t);
  }
}

/* The same of point `i` of a side. */
static void increment_at(const call *now, int s, int64_t i, double out[3])
{
  const ct_side_fixed *fixed = now->side[s]->fixed;
  increment_of(now, s, i / fixed->rule.count, fixed->N[i % fixed->rule.count], out);
}

/* The slip before the return: the stored slip, rotated with the old partner's face, and the motion
 * of the point from that partner (eq:friction-trial). For a point that was open it is the increment
 * of this step relative to the closest point. */
static void trial_slip(const call *now, int s, int64_t i, const slip_record *last, double v[3])
{
  const int t = now->data->sides - 1 - s;
  const ct_side *side = now->side[s], *other = now->side[t];
  int met = last->other >= 1.0 && last->other <= (double)other->search->face_count;
  int32_t face = met ? (int32_t)last->other - 1 : -1;
  const double *a = last->slip;
  double t1[3], t2[3], n[3], N[8], origin[3], y[3], closest[3];
  if (!met || !frame(other->search, face, last->place, t1, t2, n)) {
    increment_at(now, s, i, v);
    increment_of(now, t, side->points[i].other, side->points[i].N, closest);
    for (int c = 0; c < 3; c++) v[c] -= closest[c];
    return;
  }
  for (int c = 0; c < 3; c++)
    origin[c] = 0.5 * (other->search->boxes[face].low[c] + other->search->boxes[face].high[c]);
  ct_segment_shape(other->search->kind, last->place, N);
  ct_side_interpolate(other->search, other->search->x, face, N, origin, closest);
  ct_side_position(side, i, origin, y);
  // -- Displacement from the old partner, and the stored slip (eq:friction-trial)
  for (int c = 0; c < 3; c++)
    v[c] = ((y[c] - closest[c]) + (a[0] * t1[c] + a[1] * t2[c])) + a[2] * n[c];
}

/* Remove the component of v along d. */
static void make_tangential(const double d[3], double v[3])
{
  double along = ct_vector_dot(v, d) / ct_vector_dot(d, d);
  for (int c = 0; c < 3; c++) v[c] -= along * d[c];
}

/* Traction of a point whose trial slip is known; `k` is the normal stiffness, and the normal force
 * k times the depth below the closest point. */
static void rub(const friction *data, double k, const double normal[3], slip_point *p)
{
  double limit = data->mu / data->rho * (sqrt(ct_vector_dot(normal, normal)) / k);
  p->k = data->rho * k;
  double slid = ct_friction_return(limit, p->s);
  // -- Energy dissipated by sliding (eq:friction-dissipation)
  p->lost += p->k * limit * slid;
  // -- T = -ϱ k s (eq:friction-law)
  for (int c = 0; c < 3; c++) p->force[c] = -p->k * p->s[c];
}

/* One point of a contact. */
static void rub_contact(const call *now, int s, int64_t i, const slip_record *last,
                        slip_record *next, slip_point *p)
{
  const ct_side *side = now->side[s], *other = now->side[now->data->sides - 1 - s];
  const ct_point *point = &side->points[i];
  double t1[3], t2[3], n[3], c[2], dN[8][2];
  if (!frame(other->search, point->other, point->xi, t1, t2, n)) return;

  // -- Tangential part of the trial slip, in the plane of the face or at right angles to the line
  // to an edge (eq:friction-trial)
  trial_slip(now, s, i, last, p->s);
  int inside = is_inside(other->search->kind, point->xi);
  if (!inside) make_tangential(point->force, p->s);
  components(t1, t2, p->s, c);
  for (int k = 0; inside && k < 3; k++) p->s[k] = c[0] * t1[k] + c[1] * t2[k];
  rub(now->data, point->row.stiffness, point->force, p);

  // -- The couple on the other face that balances the moment of the tractions (eq:friction-couple)
  components(t1, t2, p->s, c);
  ct_segment_gradient(other->search->kind, point->xi, dN);
  for (int b = 0; b < other->search->per; b++) p->q[b] = c[0] * dN[b][0] + c[1] * dN[b][1];
  for (int k = 0; k < 3; k++) p->couple[k] = p->k * point->d[k];
  *next = (slip_record){.other = (double)point->other + 1.0,
                        .place = {point->xi[0], point->xi[1]},
                        .slip = {c[0], c[1], ct_vector_dot(p->s, n)}};
}

/* One point at an obstacle, which translates but does not rotate. */
static void rub_obstacle(const call *now, int64_t i, const slip_record *last, slip_record *next,
                         slip_point *p)
{
  const ct_contact *obstacle = now->at->on;
  const ct_side *side = now->side[0];
  const ct_point *point = &side->points[i];
  double y[3], first[3];
  ct_side_position(side, i, obstacle->place, y);
  increment_at(now, 0, i, first);
  for (int c = 0; c < 3; c++) {
    p->s[c] =
        last->other != 0.0 ? (y[c] - last->place[c]) + last->slip[c] : first[c] - obstacle->came[c];
    next->place[c] = y[c] + point->d[c];
  }
  make_tangential(point->force, p->s);
  rub(now->data, point->row.stiffness, point->force, p);
  next->other = 1.0;
  memcpy(next->slip, p->s, sizeof p->s);
}

/* Traction of point `i` of side `s`, whose memory begins at `at`; an open point loses its slip. */
static void rub_point(const call *now, int s, int64_t i, int64_t at, slip_point *p)
{
  slip_record last, next = {.other = 0.0};
  memcpy(&last, &now->at->memory[at], sizeof last);
  *p = (slip_point){.lost = last.lost};
  if (ct_point_has_force(&now->side[s]->points[i])) {
    if (now->data->rigid) rub_obstacle(now, i, &last, &next, p);
    else rub_contact(now, s, i, &last, &next, p);
  }
  next.lost = p->lost;
  memcpy(&now->at->next_memory[at], &next, sizeof next);
}

/* Largest force at a node of a point. */
static double largest(const friction_state *s, int64_t count)
{
  double top = 0.0;
  for (const slip_point *p = s->points; p < s->points + count; p++) {
    double weight = 0.0;
    for (int b = 0; b < 8; b++) weight = fabs(p->q[b]) > weight ? fabs(p->q[b]) : weight;
    for (int c = 0; c < 3; c++) {
      double size = fabs(p->force[c]), back = weight * fabs(p->couple[c]);
      top = size > top ? size : top;
      top = back > top ? back : top;
    }
  }
  return top;
}

/* Add the tractions and couples of the points of side `k` to the sums at the nodes. */
CT_INLINE void add_side(int stride, const call *now, int k, const ct_grid *grid,
                        const slip_point *p, friction_state *s)
{
  const ct_side_fixed *side = now->data->side[k],
                      *other = now->data->side[now->data->sides - 1 - k];
  ct_heap own = {s->coarse, s->fine, side->search->per, NULL, {0}, {0}},
          theirs = {s->coarse, s->fine, other->search->per, NULL, {0}, {0}};
  for (int64_t i = 0; i < side->point_count; i++, p++) {
    const ct_point *point = &now->side[k]->points[i];
    const double back[3] = {-p->force[0], -p->force[1], -p->force[2]};
    if (!(p->k > 0.0)) continue;
    // -- N_a T on the own face; -N̄_b T and the couple on the other (eq:friction-force)
    ct_heap_add(stride, grid, point->row.own, point->row.own_shape, p->force, &own);
    if (now->data->rigid) continue;
    const int32_t *node = ct_side_row_nodes(other, point->other);
    ct_heap_add(stride, grid, node, point->N, back, &theirs);
    ct_heap_add(stride, grid, node, p->q, p->couple, &theirs);
  }
  ct_heap_bring(stride, &own, NULL);
  ct_heap_bring(stride, &theirs, NULL);
}

/* Tractions and couples of the points of side `k`, of faces with at most four nodes or with more.
 */
CT_CLONES
static void push(const call *now, int k, const ct_grid *grid, const slip_point *p,
                 friction_state *s)
{
  if (now->data->side[0]->search->per <= 4 &&
      now->data->side[now->data->sides - 1]->search->per <= 4)
    add_side(4, now, k, grid, p, s);
  else add_side(8, now, k, grid, p, s);
}

/* Tractions and couples of all points at the nodes, in sums that do not depend on their order
 * (eq:friction-force). */
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
  const slip_point *p = s->points;
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

/* The sides now, and the time since the last call, from the tail of the memory. */
static call begin(friction_state *s, const ct_surface_motion *at)
{
  call now = {.data = s->data, .at = at};
  memcpy(&s->tail, &at->memory[RECORD * s->data->points], sizeof s->tail);
  for (int k = 0; k < s->data->sides; k++)
    now.side[k] = &((const ct_contact *)at->on)->gaps.side[k];
  if (s->tail.begun != 0.0) now.dt = at->time - s->tail.time;
  s->tail.begun = 1.0;
  s->tail.time = at->time;
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

/* Row sums Σ ρ k |b_i| Σ_j |b_j| of the points of side `k` that are active now, as if all stuck
 * (eq:friction-room). */
static void add_rows(const call *now, int k, const slip_point *p, double *rows)
{
  const ct_side_fixed *side = now->data->side[k],
                      *other = now->data->side[now->data->sides - 1 - k];
  const int per = side->search->per, other_per = now->data->rigid ? 0 : other->search->per;
  for (int64_t i = 0; i < side->point_count; i++, p++) {
    const ct_point *point = &now->side[k]->points[i];
    double sum = 0.0;
    if (!(p->k > 0.0)) continue;
    const int32_t *node = point->row.own, *other_node = ct_side_row_nodes(other, point->other);
    for (int a = 0; a < per; a++) sum += fabs(point->row.own_shape[a]);
    for (int a = 0; a < other_per; a++) sum += fabs(point->N[a]);
    // -- k |b_i| Σ |b_j| of one point (eq:friction-room)
    sum *= p->k;
    for (int a = 0; a < per; a++) rows[node[a]] += sum * fabs(point->row.own_shape[a]);
    for (int a = 0; a < other_per; a++) rows[other_node[a]] += sum * fabs(point->N[a]);
  }
}

/* Refuse a step for which the active points are too stiff (eq:friction-room). */
static ct_status check_room(const call *now, friction_state *s, ct_error *error)
{
  const friction *data = now->data;
  const slip_point *p = s->points;
  if (data->room.bound == HUGE_VAL || !(now->at->dt > 0.0)) return CT_OK;
  memset(s->rows, 0, (size_t)data->is.node_count * sizeof *s->rows);
  for (int k = 0; k < data->sides; p += data->side[k++]->point_count) add_rows(now, k, p, s->rows);
  return ct_friction_check_rows(&data->is, &data->room, data->mass, s->rows, now->at->dt, error);
}

/* Fewest points of a thread: a fraction of a millisecond. */
enum { LEAST_POINTS = 1024 };

static ct_status find_forces(void *state, const ct_surface_motion *at, double *force,
                             ct_error *error)
{
  friction_state *s = state;
  const friction *data = s->data;
  if (at->on == NULL)
    return CT_REFUSE(
        error,
        "friction: the contact or obstacle that it acts on must be an effect of the problem, too");
  int64_t first = 0;
  call now = begin(s, at);
  s->pieces = now.side[0]->pieces;
  for (int k = 0; k < data->sides; k++) {
    int64_t count = data->side[k]->point_count;
#ifdef _OPENMP
    int threads = ct_threads_for(at->threads, count, LEAST_POINTS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
    for (int64_t i = 0; i < count; i++)
      rub_point(&now, k, i, RECORD * (first + i), &s->points[first + i]);
    first += count;
  }
  ct_status status = check_room(&now, s, error);
  if (status == CT_OK) status = gather(&now, s, data->is.node_count, force, error);
  if (status == CT_OK && data->rigid) count_motion(&now, force, s);
  memcpy(&at->next_memory[RECORD * data->points], &s->tail, sizeof s->tail);
  return status;
}

/* Elastic and dissipated energy of all points (eq:friction-dissipation), and the reaction. */
static void find_energy(const void *state, ct_interaction_energy *energy)
{
  const friction_state *s = state;
  const int64_t count = s->data->points;
  *energy = (ct_interaction_energy){.motion = s->tail.motion};
  memcpy(energy->reaction, s->tail.reaction, sizeof energy->reaction);
  for (int64_t i = 0; i < count; i++)
    s->terms[i] = 0.5 * s->points[i].k * ct_vector_dot(s->points[i].s, s->points[i].s);
  energy->stored = ct_sum_over(s->pieces, s->terms, count);
  for (int64_t i = 0; i < count; i++) s->terms[i] = s->points[i].lost;
  energy->dissipated = ct_sum_over(s->pieces, s->terms, count);
}

void ct_friction_limit(ct_interaction *interaction, const double *mass, ct_friction_room room)
{
  friction *data = (friction *)interaction;
  data->mass = mass;
  data->room = room;
}

static ct_status open_state(const ct_interaction *interaction, void **state, ct_error *error)
{
  const friction *data = (const friction *)interaction;
  friction_state *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_NO_MEMORY(error, "friction");
  const size_t nodes = (size_t)interaction->node_count;
  s->data = data;
  s->points = ct_pool_take(&s->pool, (size_t)data->points, sizeof *s->points);
  s->terms = ct_pool_take(&s->pool, (size_t)data->points + nodes, sizeof *s->terms);
  s->coarse = ct_pool_take(&s->pool, nodes, 3 * sizeof(double));
  s->fine = ct_pool_take(&s->pool, nodes, 3 * sizeof(double));
  s->rows = ct_pool_take(&s->pool, nodes, sizeof *s->rows);
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
  double bytes = 2.0 * sizeof(slip_point) + sizeof(ct_point) + 2.0 * sizeof(slip_record),
         points = (double)data->points;
  return (ct_interaction){.calls = &CALLS,
                          .nodes = on->nodes,
                          .node_count = on->node_count,
                          .on = on,
                          // -- The factor on the bound of the contact (eq:friction-bound)
                          .stiffness = fmax(data->rho, data->mu),
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
  data->room.bound = HUGE_VAL;
  const ct_contact_fixed *fixed = (const ct_contact_fixed *)on;
  data->rigid = ct_contact_is_rigid(fixed);
  data->sides = ct_gaps_surfaces(&fixed->gaps);
  for (int k = 0; k < data->sides; k++) {
    data->side[k] = &fixed->gaps.side[k];
    data->points += data->side[k]->point_count;
  }
  data->is = describe(data, on);
  *out = &data->is;
  return CT_OK;
}
