/* Rigid planes, spheres and cylinders against the surface of a body. */
#include <libcontact/contact.h>
#include <libcontact/base.h>

#include "press.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "obstacle_internal.h"
#include "../base/vector.h"
#include "../step/workspace.h"

#include <math.h>
#include <string.h>

/* The obstacle with arrays of our own and an axis of length 1. */
typedef struct obstacle_data {
  ct_obstacle given;
  double *time, *value; /* of the history */
  int32_t *faces, *nodes;
  double *mass; /* of the effect's nodes */
  const double *reference;
  int32_t node_count;
} obstacle_data;

/* Doubles of memory: whether there was a step before, place, reaction, work, what the constraints
 * stored in the middle of the last step. Then the force of each constraint. */
enum { BEGUN = 0, PLACE = 1, REACTION = 4, WORK = 7, STORED = 8, MEMORY = 9 };

/* Signed distance and normal of a point given relative to the obstacle's place; `a` is the axis, of
 * length 1. */
static double gap_of(const ct_obstacle *o, const double a[3], const double r[3], double n[3])
{
  double along = o->shape == CT_OBSTACLE_SPHERE ? 0.0 : ct_vector_dot(r, a), from[3];
  if (o->shape == CT_OBSTACLE_PLANE) {
    memcpy(n, a, 3 * sizeof *n);
    return along;
  }
  // -- Away from the centre or the axis (eq:obstacle-gap)
  for (int c = 0; c < 3; c++) from[c] = o->shape == CT_OBSTACLE_SPHERE ? r[c] : r[c] - along * a[c];
  double distance = sqrt(ct_vector_dot(from, from));
  for (int c = 0; c < 3; c++) n[c] = from[c] / distance;
  return distance - o->radius;
}

/* Answers 0 where there is no direction. */
static int unit(const double axis[3], double a[3])
{
  double length = sqrt(ct_vector_dot(axis, axis));
  for (int c = 0; c < 3; c++) a[c] = axis[c] / length;
  return length > 0.0 && isfinite(length);
}

double ct_obstacle_gap(const ct_obstacle *obstacle, const double point[3], double n[3])
{
  double a[3] = {0.0, 0.0, 0.0}, r[3];
  if (obstacle->shape != CT_OBSTACLE_SPHERE) (void)unit(obstacle->axis, a);
  for (int c = 0; c < 3; c++) r[c] = point[c] - obstacle->point[c];
  return gap_of(obstacle, a, r, n);
}

void ct_obstacle_motion(const ct_obstacle *obstacle, double time, double motion[3])
{
  // -- Velocity and history (eq:obstacle-motion)
  double factor = obstacle->history.count > 0 ? ct_history_value(&obstacle->history, time) : 0.0;
  for (int c = 0; c < 3; c++)
    motion[c] = time * obstacle->velocity[c] + factor * obstacle->travel[c];
}

static void free_data(void *data)
{
  obstacle_data *d = data;
  if (d == NULL) return;
  void *blocks[] = {d->time, d->value, d->faces, d->nodes, d->mass};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
  ct_release(d);
}

static void free_scratch(void *scratch)
{
  ct_obstacle_points *s = scratch;
  if (s == NULL) return;
  if (s->side.search != NULL) ct_side_clear(&s->side);
  ct_release(s->terms);
  ct_release(s);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const obstacle_data *data = effect->data;
  ct_obstacle_points *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for an obstacle");
  ct_surface surface = {data->given.kind, data->node_count, data->given.face_count, data->faces,
                        data->reference};
  ct_status status = ct_side_init(&s->side, &surface, 0, 0, error);
  s->epsilon = data->given.epsilon;
  if (status == CT_OK)
    s->terms = ct_allocate((size_t)ct_side_point_count(&s->side), sizeof *s->terms);
  if (status == CT_OK && s->terms == NULL)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for an obstacle");
  if (status != CT_OK) {
    free_scratch(s);
    return status;
  }
  *scratch = s;
  return CT_OK;
}

/* One point: its gap, its way to the obstacle, its force. */
static void meet(const ct_obstacle *o, ct_obstacle_points *s, int32_t face, int q)
{
  ct_side *side = &s->side;
  int64_t number = (int64_t)face * side->rule.count + q;
  ct_gauss_point *point = &side->points[number];
  double r[3], *n = point->normal;
  ct_side_interpolate(side, face, side->N[q], s->place, r);
  point->gap = gap_of(o, o->axis, r, n);
  point->other = point->gap < 0.0 ? 0 : -1;
  for (int c = 0; c < 3; c++) {
    // -- Force of the point, ε w J d where it is inside (eq:obstacle-force)
    point->d[c] = -point->gap * n[c];
    point->force[c] = point->gap < 0.0 ? s->epsilon * side->weight[number] * point->d[c] : 0.0;
  }
}

/* Current coordinates of the surface's nodes. */
static ct_status place_nodes(const ct_effect *effect, const ct_view *view, ct_side *side,
                             ct_error *error)
{
  for (int64_t i = 0; i < effect->node_count; i++)
    for (int64_t c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)effect->nodes[i] + c;
      side->search->x[3 * i + c] = view->reference[dof] + view->displacement[dof];
      if (!isfinite(side->search->x[3 * i + c]))
        return ct_fail(error, CT_INVALID, (ct_place){-1, -1, effect->nodes[i]},
                       "obstacle: node %d is not at a finite place", (int)effect->nodes[i]);
    }
  return CT_OK;
}

/* Nodal forces from those of the points. */
static ct_status gather(ct_obstacle_points *s, double *force, ct_error *error)
{
  ct_side *side = &s->side;
  size_t count = 3 * (size_t)side->search->node_count;
  int64_t points = ct_side_point_count(side);
  ct_grid grid;
  double top = 0.0;
  memset(side->force, 0, count * sizeof *force);
  memset(side->force_fine, 0, count * sizeof *force);
  for (int64_t i = 0; i < points; i++) {
    if (isnan(side->points[i].d[0]))
      return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE,
                     "obstacle: a point of the surface stands in its centre");
    for (int c = 0; c < 3; c++) top = fmax(top, fabs(side->points[i].force[c]));
  }
  // Shape functions of quadratic faces stay below 1 in size; a factor 2 is room enough.
  if (top > 0.0 && !ct_grid_init(&grid, 2.0 * top, 8 * points))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE, "obstacle: a force of %g", top);
  for (int64_t i = 0; top > 0.0 && i < points; i++)
    if (ct_point_presses(&side->points[i]))
      ct_side_push(&grid, side->search, i / side->rule.count, side->N[i % side->rule.count],
                   side->points[i].force, side->force, side->force_fine);
  for (size_t d = 0; d < count; d++) force[d] = side->force[d] + side->force_fine[d];
  return CT_OK;
}

/* Force on the obstacle, and the work of its motion since the step before (eq:obstacle-work). */
static void count_motion(ct_obstacle_points *s, const double *memory, double *next)
{
  int64_t points = ct_side_point_count(&s->side);
  s->work = memory[WORK];
  for (int c = 0; c < 3; c++) {
    for (int64_t i = 0; i < points; i++) s->terms[i] = -s->side.points[i].force[c];
    s->reaction[c] = ct_sum(s->terms, points);
    if (memory[BEGUN] != 0.0)
      s->work -= 0.5 * (s->reaction[c] + memory[REACTION + c]) * (s->place[c] - memory[PLACE + c]);
  }
  next[BEGUN] = 1.0;
  memcpy(&next[PLACE], s->place, sizeof s->place);
  memcpy(&next[REACTION], s->reaction, sizeof s->reaction);
  next[WORK] = s->work;
}

/* Gaps of the points at the time of the view. */
static ct_status measure(const ct_effect *effect, const ct_view *view, ct_error *error)
{
  const obstacle_data *data = effect->data;
  ct_obstacle_points *s = view->scratch;
  ct_status status = place_nodes(effect, view, &s->side, error);
  if (status != CT_OK) return status;
  ct_obstacle_motion(&data->given, view->time, s->place);
  for (int c = 0; c < 3; c++) s->place[c] += data->given.point[c];
  for (int32_t f = 0; f < s->side.search->face_count; f++)
    for (int q = 0; q < s->side.rule.count; q++) meet(&data->given, s, f, q);
  return CT_OK;
}

/* How far a point may be from the obstacle and yet reach it in this step: the size of a face and
 * twice the way of the fastest node. */
static double reach_of(const ct_effect *effect, const ct_view *view, const ct_side *side,
                       const double moved[3])
{
  double top = 0.0;
  for (int64_t i = 0; i < effect->node_count; i++) {
    const double *v = &view->velocity[3 * (int64_t)effect->nodes[i]];
    top = fmax(top, ct_vector_dot(v, v));
  }
  return side->search->size + 2.0 * (view->dt * sqrt(top) + sqrt(ct_vector_dot(moved, moved)));
}

static ct_status obstacle_constrain(const ct_effect *effect, const ct_view *view,
                                    ct_constraint *list, int64_t *count, ct_error *error)
{
  const obstacle_data *data = effect->data;
  const ct_obstacle_points *s = view->scratch;
  double moved[3];
  ct_status status = measure(effect, view, error);
  if (status != CT_OK) return status;
  ct_obstacle_motion(&data->given, view->time + view->dt, moved);
  for (int c = 0; c < 3; c++) moved[c] = (data->given.point[c] + moved[c]) - s->place[c];
  double reach = reach_of(effect, view, &s->side, moved);
  ct_press press = {&s->side,
                    NULL,
                    s->epsilon,
                    data->given.enforcement,
                    data->given.dissipation,
                    reach,
                    0,
                    &view->memory[MEMORY],
                    1,
                    0};
  *count = ct_press_list(&press, moved, list);
  return CT_OK;
}

static const ct_effect_constraints CONSTRAINTS = {.list = obstacle_constrain};

/* Forces of the constraints on the points, and into the memory; the energy that they hold. */
static void take_constraints(const ct_view *view, ct_obstacle_points *s)
{
  ct_press_apply(&s->side, 0, view->constraints, view->constraint_count);
  ct_press_remember(view->constraints, view->constraint_count, ct_side_point_count(&s->side),
                    &view->next_memory[MEMORY], 1);
  s->held = ct_press_energy(view->constraints, view->constraint_count, view->time,
                            view->memory[STORED], &view->next_memory[STORED], s->terms);
}

static int is_penalty(const ct_effect *effect)
{
  return ((const obstacle_data *)effect->data)->given.enforcement == CT_ENFORCE_PENALTY;
}

static ct_status obstacle_force(const ct_effect *effect, const ct_view *view, double *force,
                                ct_error *error)
{
  ct_obstacle_points *s = view->scratch;
  ct_status status = is_penalty(effect) ? measure(effect, view, error) : CT_OK;
  if (status == CT_OK && !is_penalty(effect)) take_constraints(view, s);
  if (status == CT_OK) status = gather(s, force, error);
  if (status == CT_OK) count_motion(s, view->memory, view->next_memory);
  return status;
}

static ct_status obstacle_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                 ct_error *error)
{
  ct_obstacle_points *s = view->scratch;
  int64_t points = ct_side_point_count(&s->side);
  (void)error;
  // -- Π = Σ ½ ε g² w J over the points inside, = ½ force · d (eq:obstacle-potential)
  for (int64_t i = 0; i < points; i++)
    s->terms[i] = 0.5 * ct_vector_dot(s->side.points[i].force, s->side.points[i].d);
  *energy = is_penalty(effect) ? ct_sum(s->terms, points) : s->held;
  return CT_OK;
}

static ct_status obstacle_external(const ct_effect *effect, const ct_view *view, double *work,
                                   ct_error *error)
{
  (void)effect;
  (void)error;
  *work = ct_obstacle_of_scratch(view->scratch)->work;
  return CT_OK;
}

/* Largest row sum of the penalty's stiffness, every point taken as inside (eq:obstacle-bound). */
ct_status ct_obstacle_spring_frequency(const ct_effect *effect, const void *scratch,
                                       double *omega_squared, ct_error *error)
{
  const obstacle_data *data = effect->data;
  ct_side *side = &((ct_obstacle_points *)(uintptr_t)scratch)->side;
  double *rows = side->force_fine; // free between two calls of `force`, which clears it
  (void)error;
  memset(rows, 0, (size_t)effect->node_count * sizeof *rows);
  for (int64_t i = 0; i < ct_side_point_count(side); i++) {
    const double *N = side->N[i % side->rule.count];
    const int32_t *node = &side->search->faces[i / side->rule.count * side->search->per];
    double sum = 0.0;
    for (int a = 0; a < side->search->per; a++) sum += fabs(N[a]);
    for (int a = 0; a < side->search->per; a++)
      rows[node[a]] += data->given.epsilon * side->weight[i] * sum * fabs(N[a]);
  }
  *omega_squared = 0.0;
  for (int32_t i = 0; i < effect->node_count; i++)
    *omega_squared = fmax(*omega_squared, rows[i] / data->mass[i]);
  return CT_OK;
}

static ct_status obstacle_frequency(const ct_effect *effect, const ct_view *view,
                                    double *omega_squared, ct_error *error)
{
  // -- Other enforcements leave the step as it is (eq:controlled-energy)
  return is_penalty(effect)
             ? ct_obstacle_spring_frequency(effect, view->scratch, omega_squared, error)
             : CT_OK;
}

static ct_status check(const ct_obstacle *o, const ct_problem *problem, ct_error *error)
{
  double a[3];
  int per = ct_face_node_count(o->kind), finite = 1;
  for (int c = 0; c < 3; c++)
    finite = finite && isfinite(o->point[c]) && isfinite(o->velocity[c]) && isfinite(o->travel[c]);
  if (!finite)
    return ct_fail(error, CT_INVALID, CT_NOWHERE,
                   "obstacle: its point, velocity or travel is not finite");
  if ((int)o->shape < CT_OBSTACLE_PLANE || (int)o->shape > CT_OBSTACLE_CYLINDER)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "obstacle: there is no shape %d",
                   (int)o->shape);
  if (!(o->epsilon > 0.0) || !isfinite(o->epsilon))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "obstacle: the penalty must be positive, not %g", o->epsilon);
  if (ct_enforcement_name(o->enforcement) == NULL ||
      !(o->dissipation >= 0.0 && o->dissipation <= 1.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "obstacle: enforcement %d with dissipation %g", (int)o->enforcement,
                   o->dissipation);
  if (o->shape != CT_OBSTACLE_SPHERE && !unit(o->axis, a))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "obstacle: the %s has no length",
                   o->shape == CT_OBSTACLE_PLANE ? "normal" : "axis");
  if (o->shape != CT_OBSTACLE_PLANE && (!(o->radius > 0.0) || !isfinite(o->radius)))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "obstacle: the radius must be positive, not %g", o->radius);
  if (o->history.count == 0 && (o->travel[0] != 0.0 || o->travel[1] != 0.0 || o->travel[2] != 0.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "obstacle: it has a way to travel, but no history says when");
  if (per == 0 || o->face_count < 1 || o->faces == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "obstacle: the surface has no faces");
  for (int64_t i = 0; i < (int64_t)o->face_count * per; i++)
    if (o->faces[i] < 0 || o->faces[i] >= problem->node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, i / per, o->faces[i]},
                     "obstacle: there is no node %d", (int)o->faces[i]);
  return CT_OK;
}

/* Operations and bytes of a call with all points pressing, without the rounds in which their forces
 * are found: counted at a plane (eq:round-flops). */
static void count_costs(ct_effect *effect, int64_t points)
{
  double listed = is_penalty(effect) ? 0.0 : 1.0;
  effect->flops =
      (164.0 + 250.0 * listed) * (double)points + (6.0 + 20.0 * listed) * effect->node_count;
  double bytes = 2.0 * sizeof(ct_gauss_point) + listed * (16.0 + 4.0 * sizeof(ct_constraint));
  effect->bytes = bytes * (double)points + 250.0 * effect->node_count;
}

/* Copy what the caller gave, and the masses of the surface's nodes. */
static ct_status fill(obstacle_data *data, const ct_obstacle *o, const ct_problem *problem,
                      ct_effect *effect, ct_error *error)
{
  size_t entries = (size_t)o->face_count * (size_t)ct_face_node_count(o->kind),
         points = (size_t)o->history.count;
  void *trial = NULL;
  data->given = *o;
  if (o->shape != CT_OBSTACLE_SPHERE) (void)unit(o->axis, data->given.axis);
  data->reference = problem->reference;
  data->node_count = problem->node_count;
  data->faces = ct_duplicate(o->faces, entries * sizeof *o->faces);
  data->time = ct_duplicate(o->history.time, points * sizeof *data->time);
  data->value = ct_duplicate(o->history.value, points * sizeof *data->value);
  if (!data->faces || !data->time || !data->value)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for an obstacle");
  data->given.faces = data->faces;
  data->given.history.time = data->time;
  data->given.history.value = data->value;
  ct_status status = create_scratch(effect, &trial, error);
  if (status != CT_OK) return status;
  const ct_search *search = ct_obstacle_of_scratch(trial)->side.search;
  effect->node_count = search->node_count;
  data->nodes = ct_duplicate(search->nodes, (size_t)search->node_count * sizeof *search->nodes);
  data->mass = ct_allocate((size_t)search->node_count, sizeof *data->mass);
  effect->nodes = data->nodes;
  if (!data->nodes || !data->mass)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for an obstacle");
  for (int32_t i = 0; status == CT_OK && i < effect->node_count; i++)
    data->mass[i] = problem->mass[data->nodes[i]];
  if (o->enforcement != CT_ENFORCE_PENALTY) {
    effect->phase = CT_PHASE_CONSTRAINT;
    effect->constraints = &CONSTRAINTS;
    effect->constraint_count = ct_side_point_count(&ct_obstacle_of_scratch(trial)->side);
    effect->memory_count += effect->constraint_count;
  }
  count_costs(effect, ct_side_point_count(&ct_obstacle_of_scratch(trial)->side));
  free_scratch(trial);
  return status;
}

ct_status ct_obstacle_create_effect(const ct_obstacle *obstacle, const ct_problem *problem,
                                    ct_effect **out, ct_error *error)
{
  if (obstacle == NULL || problem == NULL || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "obstacle: null argument");
  ct_status status = ct_history_check(&obstacle->history, error);
  if (status == CT_OK) status = check(obstacle, problem, error);
  if (status != CT_OK) return status;
  ct_effect *effect = ct_allocate(1, sizeof *effect);
  obstacle_data *data = ct_allocate(1, sizeof *data);
  if (effect == NULL || data == NULL) {
    ct_release(effect);
    ct_release(data);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for an obstacle");
  }
  *effect = (ct_effect){.kind = CT_EFFECT_OBSTACLE,
                        .label = "obstacle",
                        .data = data,
                        .memory_count = MEMORY,
                        .create_scratch = create_scratch,
                        .free_scratch = free_scratch,
                        .force = obstacle_force,
                        .energy = obstacle_energy,
                        .omega2_bound = obstacle_frequency,
                        .external = obstacle_external,
                        .free_data = free_data};
  status = fill(data, obstacle, problem, effect, error);
  if (status != CT_OK) {
    ct_effect_free(effect);
    return status;
  }
  *out = effect;
  return CT_OK;
}

const ct_obstacle_points *ct_obstacle_of_scratch(const void *scratch) { return scratch; }

ct_status ct_obstacle_reaction(const ct_problem *problem, ct_state *state, int32_t effect,
                               double force[3], double *work, ct_error *error)
{
  if (problem == NULL || state == NULL || force == NULL || work == NULL || effect < 0 ||
      effect >= problem->effect_count || problem->effects[effect]->kind != CT_EFFECT_OBSTACLE)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect %d is no obstacle", (int)effect);
  ct_status status = ct_workspace_forces(problem, state, error);
  if (status != CT_OK) return status;
  const ct_obstacle_points *points = ct_obstacle_of_scratch(state->workspace->scratch[effect]);
  memcpy(force, points->reaction, sizeof points->reaction);
  *work = points->work;
  return CT_OK;
}
