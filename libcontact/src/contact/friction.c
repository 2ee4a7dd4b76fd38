/* Coulomb friction with stick on the points of a contact or of an obstacle. */
#include <libcontact/contact.h>
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "obstacle_internal.h"
#include "../base/vector.h"
#include "../step/workspace.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* What rubs, and how many points and nodes its sides have. */
typedef struct friction_data {
  const ct_effect *on;
  double mu, rho;
  int rigid; /* whether it rubs on an obstacle */
  int64_t points;
  int32_t side_nodes[2];
} friction_data;

/* One point: its tangential traction, and the couple that balances its moment. */
typedef struct slip_point {
  double k;         /* tangential stiffness ρ k; 0 where nothing touches */
  double s[3];      /* elastic slip */
  double force[3];  /* -k s, on the point's own face */
  double couple[3]; /* k d, which acts on the other face with the weights q */
  double q[8];      /* Σ_α c^α dN_b/dξ_α */
  double lost;      /* dissipated so far */
} slip_point;

typedef struct friction_scratch {
  slip_point *points;
  double *coarse[2], *fine[2]; /* sums at the nodes of each side */
  double *terms;
} friction_scratch;

/* What the points of one call share: the effect, its view, and the time since the call before (0:
 * there was none). */
typedef struct call {
  const ct_effect *effect;
  const friction_data *data;
  const ct_view *view;
  double dt;
  double moved[3]; /* motion of the obstacle in that time */
} call;

/* After the points' memory: whether there was a call before, its time, the place of the obstacle
 * then. */
enum { TAIL_BEGUN = 0, TAIL_TIME = 1, TAIL_PLACE = 2, TAIL = 5 };

/* Doubles of memory of a point: the partner (face plus one, 0: none), then for a contact its
 * parameters and the slip along the face's tangents and normal, for an obstacle the place of the
 * foot relative to it and the slip; last the dissipation. */
enum {
  PARTNER = 0,
  FOOT = 1,
  SLIP = 3,
  LOST = 6,
  MEMORY = 7,
  RIGID_SLIP = 4,
  RIGID_LOST = 7,
  RIGID_MEMORY = 8
};

double ct_friction_return(double limit, double slip[3])
{
  double length = sqrt(ct_vector_dot(slip, slip));
  if (!(length > limit)) return 0.0;
  // -- Shorten the slip to what friction can hold (eq:friction-return)
  for (int c = 0; c < 3; c++) slip[c] *= limit / length;
  return length - limit;
}

/* Tangents and unit normal of a face at ξ. Answers 0 where there is no normal. */
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
  double g11 = ct_vector_dot(t1, t1), g22 = ct_vector_dot(t2, t2), g12 = ct_vector_dot(t1, t2);
  double b1 = ct_vector_dot(v, t1), b2 = ct_vector_dot(v, t2);
  double det = g11 * g22 - g12 * g12;
  c[0] = (g22 * b1 - g12 * b2) / det;
  c[1] = (g11 * b2 - g12 * b1) / det;
}

/* Whether parameters lie inside a face and not on its edges. */
static int is_inside(ct_face_kind kind, const double xi[2])
{
  if (kind == CT_T3 || kind == CT_T6) return xi[0] > 0.0 && xi[1] > 0.0 && xi[0] + xi[1] < 1.0;
  return fabs(xi[0]) < 1.0 && fabs(xi[1]) < 1.0;
}

/* Way of a material point of a face since the call before: the leapfrog's Δt v_{n-1/2}. */
static void way(const call *now, const ct_search *search, int64_t face, const double N[8],
                double out[3])
{
  const int32_t *node = &search->faces[face * search->per];
  for (int c = 0; c < 3; c++) {
    double t[8] = {0.0};
    for (int a = 0; a < search->per; a++) {
      int64_t host = search->nodes[node[a]];
      t[a] = N[a] *
             now->view
                 ->velocity[3 * (now->data->rigid ? host : (int64_t)now->effect->nodes[host]) + c];
    }
    out[c] = now->dt * ct_side_sum(search->per, t);
  }
}

/* The slip of a point that touched nothing before: the way of this step against the foot. */
static void first_slip(const call *now, const ct_side *side, const ct_side *other, int64_t i,
                       double v[3])
{
  double foot[3];
  way(now, side->search, i / side->rule.count, side->N[i % side->rule.count], v);
  way(now, other->search, side->points[i].other, side->points[i].N, foot);
  for (int c = 0; c < 3; c++) v[c] -= foot[c];
}

/* The slip before the return: what was held, carried along by the old partner's face, and the way
 * of the point from that partner (eq:friction-trial). */
static void trial_slip(const call *now, const ct_side *side, const ct_side *other, int64_t i,
                       const double *memory, double v[3])
{
  int32_t face = (int32_t)memory[PARTNER] - 1;
  const double *a = &memory[SLIP];
  double t1[3], t2[3], n[3], N[8], origin[3], y[3], foot[3];
  if (!(memory[PARTNER] >= 1.0) || face >= other->search->face_count ||
      !frame(other->search, face, &memory[FOOT], t1, t2, n)) {
    first_slip(now, side, other, i, v);
    return;
  }
  for (int c = 0; c < 3; c++)
    origin[c] = 0.5 * (other->search->boxes[face].low[c] + other->search->boxes[face].high[c]);
  ct_segment_shape(other->search->kind, &memory[FOOT], N);
  ct_side_interpolate(other, face, N, origin, foot);
  ct_side_interpolate(side, (int32_t)(i / side->rule.count), side->N[i % side->rule.count], origin,
                      y);
  for (int c = 0; c < 3; c++)
    v[c] = ((y[c] - foot[c]) + (a[0] * t1[c] + a[1] * t2[c])) + a[2] * n[c];
}

/* Take away the part of v along d. */
static void make_tangential(const double d[3], double v[3])
{
  double along = ct_vector_dot(v, d) / ct_vector_dot(d, d);
  for (int c = 0; c < 3; c++) v[c] -= along * d[c];
}

/* Traction of a point whose trial slip is known; `k` is the normal stiffness, and the normal force
 * k times the depth below the foot. */
static void rub(const friction_data *data, double k, const double normal[3], slip_point *p)
{
  double limit = data->mu / data->rho * (sqrt(ct_vector_dot(normal, normal)) / k);
  p->k = data->rho * k;
  double slid = ct_friction_return(limit, p->s);
  // -- What sliding has taken (eq:friction-dissipation)
  p->lost += p->k * limit * slid;
  for (int c = 0; c < 3; c++) p->force[c] = -p->k * p->s[c];
}

/* Nothing touches: nothing is held any more. */
static void release(slip_point *p, const double *memory, double *next, int size)
{
  *p = (slip_point){.lost = memory[size - 1]};
  memset(next, 0, (size_t)size * sizeof *next);
  next[size - 1] = p->lost;
}

/* One point of a contact. */
static void rub_contact(const call *now, int s, int64_t i, const double *memory, double *next,
                        slip_point *p)
{
  const ct_contact *contact = ct_contact_of_scratch(now->view->read);
  const ct_side *side = &contact->side[s], *other = &contact->side[contact->sides - 1 - s];
  const ct_gauss_point *point = &side->points[i];
  double t1[3], t2[3], n[3], c[2], dN[8][2];
  release(p, memory, next, MEMORY);
  if (!ct_point_presses(point) || !frame(other->search, point->other, point->xi, t1, t2, n)) return;

  // -- Tangential part of the trial slip, in the plane of the face or across the way to an edge
  // (eq:friction-trial)
  trial_slip(now, side, other, i, memory, p->s);
  int inside = is_inside(other->search->kind, point->xi);
  if (!inside) make_tangential(point->force, p->s);
  components(t1, t2, p->s, c);
  for (int k = 0; inside && k < 3; k++) p->s[k] = c[0] * t1[k] + c[1] * t2[k];
  rub(now->data, 0.5 * contact->options.epsilon * side->weight[i], point->force, p);

  // -- The couple on the other face that balances the moment of the tractions (eq:friction-couple)
  components(t1, t2, p->s, c);
  ct_face nodes = {.kind = other->search->kind};
  ct_segment_gradient(nodes.kind, point->xi, dN);
  for (int b = 0; b < other->search->per; b++) p->q[b] = c[0] * dN[b][0] + c[1] * dN[b][1];
  for (int k = 0; k < 3; k++) p->couple[k] = p->k * point->d[k];
  next[PARTNER] = (double)point->other + 1.0;
  memcpy(&next[FOOT], point->xi, sizeof point->xi);
  next[SLIP] = c[0];
  next[SLIP + 1] = c[1];
  next[SLIP + 2] = ct_vector_dot(p->s, n);
  next[LOST] = p->lost;
}

/* One point at an obstacle, which moves but does not turn. */
static void rub_obstacle(const call *now, int64_t i, const double *memory, double *next,
                         slip_point *p)
{
  const ct_obstacle_points *points = ct_obstacle_of_scratch(now->view->read);
  const ct_side *side = &points->side;
  const ct_gauss_point *point = &side->points[i];
  double y[3], first[3];
  release(p, memory, next, RIGID_MEMORY);
  if (!ct_point_presses(point)) return;
  ct_side_interpolate(side, (int32_t)(i / side->rule.count), side->N[i % side->rule.count],
                      points->place, y);
  way(now, side->search, i / side->rule.count, side->N[i % side->rule.count], first);
  for (int c = 0; c < 3; c++) {
    p->s[c] = memory[PARTNER] != 0.0 ? (y[c] - memory[FOOT + c]) + memory[RIGID_SLIP + c]
                                     : first[c] - now->moved[c];
    next[FOOT + c] = y[c] + point->d[c];
  }
  make_tangential(point->force, p->s);
  rub(now->data, points->epsilon * side->weight[i], point->force, p);
  next[PARTNER] = 1.0;
  memcpy(&next[RIGID_SLIP], p->s, sizeof p->s);
  next[RIGID_LOST] = p->lost;
}

/* Largest force at a node of a point. */
static double largest(const friction_scratch *s, int64_t count)
{
  double top = 0.0;
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < 3; c++) {
      top = fmax(top, fabs(s->points[i].force[c]));
      for (int b = 0; b < 8; b++) top = fmax(top, fabs(s->points[i].q[b] * s->points[i].couple[c]));
    }
  return top;
}

/* Add the tractions and couples of one side's points to the nodes of both sides
 * (eq:friction-force). */
static void spread(const ct_grid *grid, const ct_side *side, const ct_side *other,
                   const slip_point *points, double *const own[2], double *const others[2])
{
  for (int64_t i = 0; i < ct_side_point_count(side); i++) {
    const slip_point *p = &points[i];
    if (!(p->k > 0.0)) continue;
    ct_side_push(grid, side->search, i / side->rule.count, side->N[i % side->rule.count], p->force,
                 own[0], own[1]);
    if (other == NULL) continue;
    const double back[3] = {-p->force[0], -p->force[1], -p->force[2]};
    ct_side_push(grid, other->search, side->points[i].other, side->points[i].N, back, others[0],
                 others[1]);
    ct_side_push(grid, other->search, side->points[i].other, p->q, p->couple, others[0], others[1]);
  }
}

/* The sides of what is rubbed on: one or two. */
static int sides_of(const friction_data *data, const void *read, const ct_side *side[2])
{
  if (data->rigid) {
    side[0] = side[1] = &ct_obstacle_of_scratch(read)->side;
    return 1;
  }
  const ct_contact *contact = ct_contact_of_scratch(read);
  for (int s = 0; s < 2; s++) side[s] = &contact->side[s < contact->sides ? s : 0];
  return contact->sides;
}

static ct_status gather(const friction_data *data, const void *read, friction_scratch *s,
                        const ct_effect *effect, double *force, ct_error *error)
{
  const ct_side *side[2];
  int sides = sides_of(data, read, side);
  double top = largest(s, data->points);
  ct_grid grid;
  memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  if (top == 0.0) return CT_OK;
  if (!ct_grid_init(&grid, 2.0 * top, 24 * data->points))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE, "friction: a force of %g", top);
  for (int k = 0; k < sides; k++) {
    memset(s->coarse[k], 0, 3 * (size_t)data->side_nodes[k] * sizeof(double));
    memset(s->fine[k], 0, 3 * (size_t)data->side_nodes[k] * sizeof(double));
  }
  const slip_point *points = s->points;
  for (int k = 0; k < sides; k++) {
    int o = sides - 1 - k;
    double *own[2] = {s->coarse[k], s->fine[k]}, *others[2] = {s->coarse[o], s->fine[o]};
    spread(&grid, side[k], data->rigid ? NULL : side[o], points, own, others);
    points += ct_side_point_count(side[k]);
  }
  for (int k = 0; k < sides; k++)
    for (int64_t n = 0; n < data->side_nodes[k]; n++)
      for (int64_t c = 0; c < 3; c++) {
        int64_t node = data->rigid ? n : side[k]->search->nodes[n];
        force[3 * node + c] += s->coarse[k][3 * n + c] + s->fine[k][3 * n + c];
      }
  return CT_OK;
}

/* The time since the call before and the motion of the obstacle in it, from the tail of the memory;
 * and the tail for the next call. */
static call begin(const ct_effect *effect, const ct_view *view, int64_t size)
{
  const friction_data *data = effect->data;
  const double *tail = &view->memory[size * data->points];
  double *next = &view->next_memory[size * data->points];
  call now = {effect,
              data,
              view,
              tail[TAIL_BEGUN] != 0.0 ? view->time - tail[TAIL_TIME] : 0.0,
              {0.0, 0.0, 0.0}};
  next[TAIL_BEGUN] = 1.0;
  next[TAIL_TIME] = view->time;
  for (int c = 0; c < 3; c++) {
    next[TAIL_PLACE + c] = data->rigid ? ct_obstacle_of_scratch(view->read)->place[c] : 0.0;
    now.moved[c] = tail[TAIL_BEGUN] != 0.0 ? next[TAIL_PLACE + c] - tail[TAIL_PLACE + c] : 0.0;
  }
  return now;
}

static ct_status friction_force(const ct_effect *effect, const ct_view *view, double *force,
                                ct_error *error)
{
  const friction_data *data = effect->data;
  friction_scratch *s = view->scratch;
  const ct_side *side[2];
  if (view->read == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "friction: what it rubs on is not in the problem");
  int sides = sides_of(data, view->read, side), size = data->rigid ? RIGID_MEMORY : MEMORY;
  int64_t first = 0;
  call now = begin(effect, view, size);
  for (int k = 0; k < sides; k++) {
    int64_t count = ct_side_point_count(side[k]);
#ifdef _OPENMP
#pragma omp parallel for num_threads(view->threads) schedule(static) if (view->threads > 1)
#endif
    for (int64_t i = 0; i < count; i++) {
      const double *memory = &view->memory[size * (first + i)];
      double *next = &view->next_memory[size * (first + i)];
      if (data->rigid) rub_obstacle(&now, i, memory, next, &s->points[i]);
      else rub_contact(&now, k, i, memory, next, &s->points[first + i]);
    }
    first += count;
  }
  return gather(data, view->read, s, effect, force, error);
}

/* max(ρ, μ) times the bound of what is rubbed on (eq:friction-bound). */
static ct_status friction_frequency(const ct_effect *effect, const ct_view *view,
                                    double *omega_squared, ct_error *error)
{
  const friction_data *data = effect->data;
  ct_status status = data->rigid
                         ? ct_obstacle_spring_frequency(data->on, view->read, omega_squared, error)
                         : ct_contact_spring_frequency(data->on, view->read, omega_squared, error);
  *omega_squared *= fmax(data->rho, data->mu);
  return status;
}

static void free_scratch(void *scratch)
{
  friction_scratch *s = scratch;
  if (s == NULL) return;
  ct_release(s->points);
  ct_release(s->terms);
  for (int k = 0; k < 2; k++) {
    ct_release(s->coarse[k]);
    ct_release(s->fine[k]);
  }
  ct_release(s);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const friction_data *data = effect->data;
  friction_scratch *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for friction");
  s->points = ct_allocate((size_t)data->points, sizeof *s->points);
  s->terms = ct_allocate((size_t)data->points, sizeof *s->terms);
  int whole = s->points != NULL && s->terms != NULL;
  for (int k = 0; k < 2; k++) {
    s->coarse[k] = ct_allocate((size_t)data->side_nodes[k], 3 * sizeof(double));
    s->fine[k] = ct_allocate((size_t)data->side_nodes[k], 3 * sizeof(double));
    whole = whole && s->coarse[k] != NULL && s->fine[k] != NULL;
  }
  if (!whole) {
    free_scratch(s);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for friction");
  }
  *scratch = s;
  return CT_OK;
}

/* Count the points and nodes of what is rubbed on. */
static ct_status count(friction_data *data, ct_error *error)
{
  const ct_side *side[2];
  void *trial = NULL;
  ct_status status = data->on->create_scratch(data->on, &trial, error);
  if (status != CT_OK) return status;
  int sides = sides_of(data, trial, side);
  for (int k = 0; k < sides; k++) {
    data->points += ct_side_point_count(side[k]);
    data->side_nodes[k] = side[k]->search->node_count;
  }
  data->on->free_scratch(trial);
  return CT_OK;
}

static ct_status check(const ct_friction *f, const ct_problem *problem, ct_error *error)
{
  if (f == NULL || problem == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "friction: null argument");
  if (f->on == NULL || (f->on->kind != CT_EFFECT_CONTACT && f->on->kind != CT_EFFECT_OBSTACLE))
    return ct_fail(
        error, CT_ERROR_ARGUMENT, CT_NOWHERE,
        "friction: needs a contact or an obstacle, for there is no friction without a pressure");
  if (!(f->coefficient > 0.0) || !isfinite(f->coefficient))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "friction: the coefficient must be positive, not %g", f->coefficient);
  if (!(f->tangent >= 0.0) || !isfinite(f->tangent))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "friction: a tangential penalty of %g times the normal one", f->tangent);
  return CT_OK;
}

ct_status ct_friction_create_effect(const ct_friction *friction, const ct_problem *problem,
                                    ct_effect **out, ct_error *error)
{
  if (out == NULL) return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "friction: null argument");
  ct_status status = check(friction, problem, error);
  if (status != CT_OK) return status;
  ct_effect *effect = ct_allocate(1, sizeof *effect);
  friction_data *data = ct_allocate(1, sizeof *data);
  if (effect == NULL || data == NULL) {
    ct_release(effect);
    ct_release(data);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for friction");
  }
  *data = (friction_data){.on = friction->on,
                          .mu = friction->coefficient,
                          .rho = friction->tangent > 0.0 ? friction->tangent : 1.0,
                          .rigid = friction->on->kind == CT_EFFECT_OBSTACLE};
  *effect = (ct_effect){.kind = CT_EFFECT_FRICTION,
                        .label = "friction",
                        .data = data,
                        .nodes = friction->on->nodes,
                        .node_count = friction->on->node_count,
                        .phase = friction->on->phase == CT_PHASE_CONSTRAINT ? CT_PHASE_FOLLOWING
                                                                            : CT_PHASE_STATE,
                        .reads = friction->on,
                        .create_scratch = create_scratch,
                        .free_scratch = free_scratch,
                        .force = friction_force,
                        .omega2_bound = friction_frequency,
                        .free_data = ct_release};
  status = count(data, error);
  if (status != CT_OK) {
    ct_effect_free(effect);
    return status;
  }
  // With all points pressing, counted on two plane surfaces and on a plane.
  effect->flops = (data->rigid ? 225.0 : 750.0) * (double)data->points;
  double memory = 16.0 * (data->rigid ? RIGID_MEMORY : MEMORY);
  effect->bytes =
      (2.0 * sizeof(slip_point) + sizeof(ct_gauss_point) + memory) * (double)data->points +
      250.0 * effect->node_count;
  effect->memory_count = (data->rigid ? RIGID_MEMORY : MEMORY) * data->points + TAIL;
  *out = effect;
  return CT_OK;
}

ct_status ct_friction_energy(const ct_problem *problem, ct_state *state, int32_t k, double *held,
                             double *dissipated, ct_error *error)
{
  if (problem == NULL || state == NULL || held == NULL || dissipated == NULL || k < 0 ||
      k >= problem->effect_count || problem->effects[k]->kind != CT_EFFECT_FRICTION)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect %d is no friction", (int)k);
  ct_status status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  const friction_data *data = problem->effects[k]->data;
  friction_scratch *s = state->workspace->scratch[k];
  for (int64_t i = 0; i < data->points; i++)
    s->terms[i] = 0.5 * s->points[i].k * ct_vector_dot(s->points[i].s, s->points[i].s);
  *held = ct_sum(s->terms, data->points);
  for (int64_t i = 0; i < data->points; i++) s->terms[i] = s->points[i].lost;
  *dissipated = ct_sum(s->terms, data->points);
  return CT_OK;
}
