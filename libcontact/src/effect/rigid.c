/* Rigid bodies: forces that keep the nodes of a body at their distances, while it moves by the sum
 * of all other forces. */
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../base/error.h"
#include "../base/stream.h"
#include "rotation.h"

#include <math.h>
#include <string.h>

/* Initial velocities may differ from those of a rigid motion by this share of the fastest one. */
static const double ALIKE = 1e-9;

/* Sums over the nodes of a body: displacement of the centre; what rounding has left of Σ m r,
 * momentum, angular momentum and moments of mass about it. */
enum {
  CENTRE,
  ARM = CENTRE + 3,
  MOMENTUM = ARM + 3,
  SPIN = MOMENTUM + 3,
  MOMENT = SPIN + 3,
  SUMS = MOMENT + 6
};

typedef struct rigid_body {
  int32_t number, count; /* of the body, and of its nodes that are rigid */
  const int32_t *nodes;
  int fixed[6];     /* x, y, z, and rotations about them */
  int pivoted;      /* whether the centre is a fixed point, not that of mass */
  double centre[3]; /* reference position */
  double mass;
} rigid_body;

typedef struct rigid_data {
  ct_pool pool;
  rigid_body *bodies;
  int32_t body_count, node_count, *nodes;
  const ct_problem *problem;
} rigid_data;

/* The sums of a body, and the motion that follows from them. */
typedef struct rigid_motion {
  double sum[SUMS];
  ct_inertia inertia;
  double off[3];      /* from the rounded centre to the true one */
  double velocity[3]; /* of the centre */
  double b[3], a;     /* quaternion of the turn until the next evaluation */
} rigid_motion;

/* Grids of the sums of the last step: if they fit, the terms are computed once. And the motions
 * without the forces of constraints. */
typedef struct rigid_scratch {
  ct_pool pool;
  ct_grid (*grids)[SUMS];
  rigid_motion *motions;
} rigid_scratch;

static ct_grid *grids_of(const ct_view *view, int32_t b)
{
  return ((rigid_scratch *)view->scratch)->grids[b];
}

static rigid_motion *motion_of(const ct_view *view, int32_t b)
{
  return &((rigid_scratch *)view->scratch)->motions[b];
}

/* Factors of m v, and of the forces so far, in a momentum. */
typedef struct share {
  double mass, force;
} share;

/* r = x - c of a node. */
static void arm_of(const rigid_data *data, const rigid_body *body, const ct_view *view,
                   const double moved[3], int32_t node, double r[3])
{
  const double *X = &data->problem->reference[3 * (int64_t)node],
               *u = &view->displacement[3 * (int64_t)node];
  for (int c = 0; c < 3; c++) r[c] = (X[c] - body->centre[c]) + (u[c] - moved[c]);
}

/* The velocity that forces change, v + l Δt a⁻ (eq:stage). */
static double velocity_of(const ct_view *view, int64_t dof)
{
  const double *before = view->acceleration_before;
  return view->velocity[dof] + (before == NULL ? 0.0 : view->l_dt * before[dof]);
}

/* Terms of one node: the i-th ones of the sums from ARM on. */
static void node_terms(const rigid_data *data, const rigid_body *body, const ct_view *view,
                       share of, const double moved[3], int32_t node, double (*term)[CT_PIECE],
                       int32_t i)
{
  const double m = data->problem->mass[node];
  double r[3], q[3], spin[3];
  arm_of(data, body, view, moved, node, r);
  for (int c = 0; c < 3; c++) {
    const int64_t dof = 3 * (int64_t)node + c;
    // -- Momentum of the node after the forces so far (eq:rigid-momentum)
    q[c] = of.mass * (m * velocity_of(view, dof)) + of.force * view->total[dof];
  }
  ct_vector_cross(r, q, spin);
  for (int c = 0; c < 3; c++) {
    const int next = (c + 1) % 3;
    term[ARM + c][i] = m * r[c];
    term[MOMENTUM + c][i] = q[c];
    term[SPIN + c][i] = spin[c];
    // -- Σ m r rᵀ (eq:rigid-inertia)
    term[MOMENT + c][i] = m * (r[c] * r[c]);
    term[MOMENT + 3 + c][i] = m * (r[c] * r[next]);
  }
}

/* Sums `first` ... `last` - 1 over the nodes of a body. */
static void sum_nodes(const rigid_data *data, const rigid_body *body, const ct_view *view, share of,
                      int first, int last, ct_grid *grids, double *out)
{
  ct_stream sums[SUMS];
  double term[SUMS][CT_PIECE];
  for (int k = first; k < last; k++) sums[k] = (ct_stream){.grid = grids[k]};
  for (int32_t i, end; ct_stream_piece(&sums[first], last - first, body->count, &i, &end);) {
    for (int32_t n = i; n < end; n++) {
      const int32_t node = body->nodes[n];
      const double *u = &view->displacement[3 * (int64_t)node];
      for (int c = 0; first == CENTRE && c < 3; c++)
        term[CENTRE + c][n - i] = data->problem->mass[node] * u[c];
      if (first != CENTRE) node_terms(data, body, view, of, &out[CENTRE], node, term, n - i);
    }
    for (int k = first; k < last; k++) ct_stream_add(&sums[k], term[k], end - i);
  }
  for (int k = first; k < last; k++) out[k] = ct_stream_sum(&sums[k]), grids[k] = sums[k].grid;
}

/* Far from its start the centre is known only to the rounding of the displacements; refer the
 * angular momentum to where Σ m r is 0. */
static void correct_centre(const rigid_body *body, rigid_motion *motion)
{
  double spin[3];
  for (int c = 0; c < 3; c++) motion->off[c] = motion->sum[ARM + c] / body->mass;
  ct_vector_cross(motion->off, &motion->sum[MOMENTUM], spin);
  for (int c = 0; c < 3; c++) motion->sum[SPIN + c] -= spin[c];
}

/* All sums of a body, and its inertia. */
static void sum_body(const rigid_data *data, const rigid_body *body, const ct_view *view, share of,
                     ct_grid *grids, rigid_motion *motion)
{
  memset(motion, 0, sizeof *motion);
  if (!body->pivoted) sum_nodes(data, body, view, of, CENTRE, ARM, grids, motion->sum);
  // -- The centre moves by Σ m u / M (eq:rigid-momentum)
  for (int c = 0; c < 3; c++) motion->sum[CENTRE + c] /= body->mass;
  sum_nodes(data, body, view, of, ARM, SUMS, grids, motion->sum);
  if (!body->pivoted) correct_centre(body, motion);
  memcpy(motion->inertia.moment, &motion->sum[MOMENT], sizeof motion->inertia.moment);
  memcpy(motion->inertia.fixed, &body->fixed[3], sizeof motion->inertia.fixed);
  for (int c = 0; c < 3; c++)
    motion->velocity[c] =
        body->fixed[c] || body->pivoted ? 0.0 : motion->sum[MOMENTUM + c] / body->mass;
}

/* The motion of a body until the next evaluation, by the forces so far. */
static ct_status find_motion(const rigid_data *data, int32_t b, const ct_view *view,
                             rigid_motion *motion, ct_error *error)
{
  const rigid_body *body = &data->bodies[b];
  double g[3], rate[3];
  sum_body(data, body, view, (share){1.0, view->r_dt}, grids_of(view, b), motion);
  // -- The displacement of each node gives back the angular momentum (eq:rigid-rotation)
  for (int c = 0; c < 3; c++) g[c] = view->dt * motion->sum[SPIN + c];
  if (ct_rotation_find(&motion->inertia, g, motion->b, &motion->a)) return CT_OK;
  ct_inertia_solve(&motion->inertia, &motion->sum[SPIN], rate);
  const double size = sqrt(ct_vector_dot(rate, rate));
  if (!isfinite(size)) return CT_OK; // the step is refused, with the node (ct_check_finite)
  return ct_fail(error, CT_ERROR_STEP, (ct_place){body->number, -1, -1},
                 "the rigid body %s turns by %.3g in a step, which is too much for one; give a "
                 "step of at most %.3g",
                 data->problem->bodies[body->number].name, size * view->dt, 0.5 / size);
}

/* Displacement of a node until the next evaluation. */
static void increment_of(const rigid_data *data, int32_t b, const ct_view *view,
                         const rigid_motion *motion, int32_t node, double out[3])
{
  double r[3];
  arm_of(data, &data->bodies[b], view, &motion->sum[CENTRE], node, r);
  for (int c = 0; c < 3; c++) r[c] -= motion->off[c];
  ct_rotation_increment(motion->b, motion->a, r, out);
  // -- Δt V + (R - I) r (eq:rigid-step)
  for (int c = 0; c < 3; c++) out[c] += view->dt * motion->velocity[c];
}

/* While the state is created: the acceleration of a body that has a velocity and turns. */
static void accelerate(const rigid_data *data, int32_t b, const ct_view *view, double *force)
{
  const rigid_body *body = &data->bodies[b];
  rigid_motion motion;
  double turn[3], h[3], twist[3], alpha[3];
  sum_body(data, body, view, (share){1.0, 0.0}, grids_of(view, b), &motion);
  ct_inertia_solve(&motion.inertia, &motion.sum[SPIN], turn);
  sum_body(data, body, view, (share){0.0, 1.0}, grids_of(view, b), &motion);
  ct_inertia_times(&motion.inertia, turn, h);
  ct_vector_cross(turn, h, twist);
  for (int c = 0; c < 3; c++) twist[c] = motion.sum[SPIN + c] - twist[c];
  ct_inertia_solve(&motion.inertia, twist, alpha);
  for (int32_t n = 0; n < body->count; n++, force += 3) {
    const int32_t node = body->nodes[n];
    double r[3], once[3], twice[3], along[3];
    arm_of(data, body, view, &motion.sum[CENTRE], node, r);
    ct_vector_cross(turn, r, once);
    ct_vector_cross(turn, once, twice);
    ct_vector_cross(alpha, r, along);
    // -- a = A + α × r + ω × (ω × r) with Θ α = τ - ω × Θ ω (eq:rigid-start)
    for (int c = 0; c < 3; c++)
      force[c] = data->problem->mass[node] * (motion.velocity[c] + (along[c] + twice[c])) -
                 view->total[3 * (int64_t)node + c];
  }
}

/* Refuse a support on a node of a rigid body, once, while the state is created. */
static ct_status check_free(const rigid_data *data, const rigid_body *body, ct_error *error)
{
  const double *inverse_mass = data->problem->inverse_mass;
  for (int32_t n = 0; n < body->count; n++)
    for (int c = 0; c < 3; c++) {
      const ct_place place = ct_effect_place(data->problem, body->nodes[n]);
      if (inverse_mass[3 * (int64_t)body->nodes[n] + c] == 0.0)
        return ct_fail(error, CT_ERROR_ARGUMENT, place,
                       "a support holds %c of node %d of the rigid body %s; fix freedoms of the "
                       "whole body instead",
                       "xyz"[c], (int)place.point, data->problem->bodies[body->number].name);
    }
  return CT_OK;
}

static ct_status rigid_force(const ct_effect *effect, const ct_view *view, double *force,
                             ct_error *error)
{
  const rigid_data *data = effect->data;
  for (int32_t b = 0; b < data->body_count; force += 3 * (int64_t)data->bodies[b++].count) {
    const rigid_body *body = &data->bodies[b];
    rigid_motion motion;
    if (view->dt == 0.0) {
      ct_status status = check_free(data, body, error);
      if (status != CT_OK) return status;
      accelerate(data, b, view, force);
      continue;
    }
    ct_status status = find_motion(data, b, view, &motion, error);
    if (status != CT_OK) return status;
    for (int32_t n = 0; n < body->count; n++) {
      const int32_t node = body->nodes[n];
      double moved[3];
      increment_of(data, b, view, &motion, node, moved);
      for (int c = 0; c < 3; c++) {
        const int64_t dof = 3 * (int64_t)node + c;
        // -- The force that moves the node so against all others (eq:rigid-force)
        force[3 * (int64_t)n + c] =
            data->problem->mass[node] *
                ((moved[c] / view->dt - velocity_of(view, dof)) / view->r_dt) -
            view->total[dof];
      }
    }
  }
  return CT_OK;
}

static ct_status rigid_increment(const ct_effect *effect, const ct_view *view, double *increment,
                                 ct_error *error)
{
  const rigid_data *data = effect->data;
  for (int32_t b = 0; b < data->body_count; b++) {
    const rigid_body *body = &data->bodies[b];
    rigid_motion *motion = motion_of(view, b);
    ct_status status = find_motion(data, b, view, motion, error);
    if (status != CT_OK) return status;
    for (int32_t n = 0; n < body->count; n++, increment += 3)
      increment_of(data, b, view, motion, body->nodes[n], increment);
  }
  return CT_OK;
}

static ct_status rigid_mobility(const ct_effect *effect, const ct_view *view,
                                ct_body_mobility *bodies, double *arms, ct_error *error)
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  const rigid_data *data = effect->data;
  const double time = view->dt * view->r_dt;
  (void)error;
  for (int32_t b = 0; b < data->body_count; b++) {
    const rigid_body *body = &data->bodies[b];
    const rigid_motion *motion = motion_of(view, b);
    // -- Displacement by a unit force, and turn by a unit moment (eq:rigid-mobility)
    for (int c = 0; c < 3; c++)
      bodies[b].translation[c] = body->fixed[c] || body->pivoted ? 0.0 : time / body->mass;
    for (int k = 0; k < 6; k++) {
      const double unit[3] = {column[k] == 0, column[k] == 1, column[k] == 2};
      double turn[3];
      ct_inertia_solve(&motion->inertia, unit, turn);
      bodies[b].rotation[k] = body->fixed[3 + column[k]] ? 0.0 : time * turn[row[k]];
    }
    for (int32_t n = 0; n < body->count; n++, arms += 3) {
      arm_of(data, body, view, &motion->sum[CENTRE], body->nodes[n], arms);
      for (int c = 0; c < 3; c++) arms[c] -= motion->off[c];
    }
  }
  return CT_OK;
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const rigid_data *data = effect->data;
  rigid_scratch *s = ct_allocate(1, sizeof *s);
  const size_t count = (size_t)data->body_count;
  if (s != NULL) s->grids = ct_pool_take(&s->pool, count, sizeof *s->grids);
  if (s != NULL) s->motions = ct_pool_take(&s->pool, count, sizeof *s->motions);
  if (s == NULL || s->pool.failed) {
    ct_pool_free(s);
    return CT_NO_MEMORY(error, "the rigid bodies");
  }
  *scratch = s;
  return CT_OK;
}

static const ct_effect_calls CALLS = {
    .force = rigid_force,
    .create_scratch = create_scratch,
    .free_scratch = ct_pool_free,
    .free_data = ct_pool_free,
    .constraints = {.increment = rigid_increment, .mobility = rigid_mobility},
    .pieces = {.common = 1}};

ct_rigid_def ct_rigid_def_default(void) { return (ct_rigid_def){.cookie = CT_DEF_COOKIE}; }

/* Check the freedoms and the number of a body, and that it is not listed twice. */
static ct_status check_rigid(const ct_problem *problem, const ct_rigid *rigid, int32_t number,
                             const int32_t *taken, ct_error *error)
{
  if (rigid->body < 0 || rigid->body >= problem->body_count)
    return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){rigid->body, -1, -1},
                   "rigid %d: there is no body %d", (int)number, (int)rigid->body);
  const char *name = problem->bodies[rigid->body].name;
  if (taken[rigid->body] != 0)
    return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){rigid->body, -1, -1},
                   "rigid %d: body %s is rigid already (rigid %d)", (int)number, name,
                   (int)taken[rigid->body] - 1);
  for (int c = 0; rigid->pivoted && c < 3; c++)
    if (!isfinite(rigid->pivot[c]))
      return ct_fail(error, CT_INVALID, (ct_place){rigid->body, -1, -1},
                     "rigid %d: pivot %c is not finite", (int)number, "xyz"[c]);
  return CT_OK;
}

/* Check that the initial velocities of a body are those of a rigid motion in its free freedoms. */
static ct_status check_velocity(const rigid_data *data, const rigid_body *body,
                                const rigid_motion *motion, const ct_view *start, ct_error *error)
{
  double spin[3], fastest = 0.0, worst = 0.0;
  int32_t at = 0;
  ct_inertia_solve(&motion->inertia, &motion->sum[SPIN], spin);
  for (int32_t n = 0; n < body->count; n++) {
    const double *v = &start->velocity[3 * (int64_t)(body->nodes[n])];
    double r[3], turned[3];
    arm_of(data, body, start, &motion->sum[CENTRE], body->nodes[n], r);
    ct_vector_cross(spin, r, turned);
    for (int c = 0; c < 3; c++) {
      const double apart = fabs(v[c] - (motion->velocity[c] + turned[c]));
      fastest = fmax(fastest, fabs(v[c]));
      if (apart > worst) worst = apart, at = n;
    }
  }
  if (worst <= ALIKE * fastest) return CT_OK;
  return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body->number, -1, at},
                 "rigid: the initial velocity of node %d of body %s differs by %.3g from a rigid "
                 "motion in which the fixed freedoms are at rest",
                 (int)at, data->problem->bodies[body->number].name, worst);
}

static double mass_of(const rigid_data *data, const rigid_body *body)
{
  ct_stream sum = {0};
  double term[CT_PIECE];
  for (int32_t i, end; ct_stream_piece(&sum, 1, body->count, &i, &end);) {
    for (int32_t n = i; n < end; n++) term[n - i] = data->problem->mass[body->nodes[n]];
    ct_stream_add(&sum, term, end - i);
  }
  return ct_stream_sum(&sum);
}

/* List the nodes of a body: all of them, or those that are given. */
static ct_status list_nodes(rigid_data *data, const ct_rigid *rigid, rigid_body *body,
                            ct_error *error)
{
  const ct_body *of = &data->problem->bodies[rigid->body];
  const int32_t first = of->first_node, end = first + of->mesh->node_count;
  int32_t *nodes = &data->nodes[data->node_count], below = first - 1;
  body->nodes = nodes;
  body->count = rigid->nodes == NULL ? of->mesh->node_count : rigid->node_count;
  for (int32_t n = 0; n < body->count; n++) {
    nodes[n] = rigid->nodes == NULL ? first + n : rigid->nodes[n];
    if (nodes[n] <= below || nodes[n] >= end)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){rigid->body, -1, n},
                     "rigid: the nodes of body %s must be ascending, %d to %d; node %d is %d",
                     of->name, (int)first, (int)end - 1, (int)n, (int)nodes[n]);
    below = nodes[n];
  }
  if (body->count < 3) return CT_REFUSE(error, "rigid: body %s has no three nodes", of->name);
  data->node_count += body->count;
  return CT_OK;
}

/* Mass and centre of a body; its motion at the start is checked. `rest` is 0 at all nodes. */
static ct_status prepare(const rigid_data *data, const ct_rigid *rigid, const double *rest,
                         rigid_body *body, ct_error *error)
{
  const ct_problem *problem = data->problem;
  ct_view view = {.displacement = problem->reference, .total = rest};
  ct_grid grids[SUMS] = {{0.0, 0.0}};
  rigid_motion motion;
  body->number = rigid->body;
  body->pivoted = rigid->pivoted;
  body->mass = mass_of(data, body);
  for (int c = 0; c < 6; c++) body->fixed[c] = rigid->fixed[c] != 0;
  memcpy(body->centre, rigid->pivot, sizeof body->centre);
  if (!body->pivoted) {
    sum_nodes(data, body, &view, (share){0.0, 0.0}, CENTRE, ARM, grids, motion.sum);
    // -- The centre of the lumped masses (eq:rigid-momentum)
    for (int c = 0; c < 3; c++) body->centre[c] = motion.sum[CENTRE + c] / body->mass;
  }
  view.displacement = problem->initial_displacement == NULL ? rest : problem->initial_displacement;
  view.velocity = problem->initial_velocity;
  sum_body(data, body, &view, (share){1.0, 0.0}, grids, &motion);
  return check_velocity(data, body, &motion, &view, error);
}

/* Fill the table of the bodies, in the order of their nodes. `number` has a place for each body of
 * the problem. */
static ct_status fill(rigid_data *data, const ct_rigid_def *def, int32_t *number,
                      const double *rest, ct_error *error)
{
  const ct_problem *problem = data->problem;
  for (int32_t i = 0; i < def->body_count; i++) {
    ct_status status = check_rigid(problem, &def->bodies[i], i, number, error);
    if (status != CT_OK) return status;
    number[def->bodies[i].body] = i + 1;
  }
  for (int32_t b = 0; b < problem->body_count; b++) {
    if (number[b] == 0) continue;
    rigid_body *body = &data->bodies[data->body_count];
    const ct_rigid *rigid = &def->bodies[number[b] - 1];
    ct_status status = list_nodes(data, rigid, body, error);
    if (status == CT_OK) status = prepare(data, rigid, rest, body, error);
    if (status != CT_OK) return status;
    data->body_count++;
  }
  return CT_OK;
}

static ct_status make(rigid_data *data, const ct_rigid_def *def, ct_error *error)
{
  const size_t bodies = (size_t)data->problem->body_count,
               nodes = (size_t)data->problem->node_count;
  if (def->bodies == NULL || def->body_count < 1)
    return CT_REFUSE(error, "rigid: the list of bodies is empty");
  int32_t *number = ct_allocate(bodies, sizeof *number);
  double *rest = ct_allocate(nodes, 3 * sizeof *rest);
  data->bodies = ct_pool_take(&data->pool, bodies, sizeof *data->bodies);
  data->nodes = ct_pool_take(&data->pool, nodes, sizeof *data->nodes);
  ct_status status = number == NULL || rest == NULL || data->pool.failed
                         ? CT_NO_MEMORY(error, "the rigid bodies")
                         : fill(data, def, number, rest, error);
  ct_release(number);
  ct_release(rest);
  return status;
}

ct_status ct_rigid_create_effect(const ct_rigid_def *def, const ct_problem *problem,
                                 ct_effect **effect, ct_error *error)
{
  ct_status status;
  rigid_data *data = ct_effect_begin(def, problem, effect, "rigid", sizeof *data, &status, error);
  if (data == NULL) return status;
  data->problem = problem;
  status = make(data, def, error);
  // Two rounds of the sums over positions, and one over the rest, of which a node has 15.
  ct_effect filled = {
      .kind = CT_EFFECT_RIGID,
      .label = "rigid",
      .phase = CT_PHASE_PRESCRIBED,
      .calls = &CALLS,
      .data = data,
      .nodes = data->nodes,
      .node_count = data->node_count,
      .cost = {.flops = 200.0 * data->node_count, .bytes = 200.0 * data->node_count}};
  return ct_effect_finish(status, &filled, effect, error);
}
