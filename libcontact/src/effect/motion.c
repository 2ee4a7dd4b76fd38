/* Displacements that follow an amplitude. */
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../base/error.h"
#include "../base/memory.h"

#include <math.h>
#include <string.h>

/* For each node of the effect and component: the number of its motion plus 1, or 0 where the
 * component is free. */
typedef struct motion_data {
  int32_t *nodes, *holder;
  int32_t node_count;
  ct_motion *motions; /* their amplitudes stand in `points` */
  double *points;
  const double *mass, *inverse_mass; /* of the problem */
} motion_data;

static void free_data(void *data)
{
  motion_data *d = data;
  void *blocks[] = {d->nodes, d->holder, d->motions, d->points, d};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) ct_release(blocks[i]);
}

/* The force that takes one component to where it has to be at the next evaluation, with the
 * velocity `v` before the kick and what is `carried` on. */
static double force_to(double target, double u, double v, double carried, double mass,
                       double others, const ct_view *view)
{
  // While the start is made nothing has been prescribed yet: the node keeps its velocity.
  if (view->dt == 0.0) return -others;
  // -- r = m (v_{n+1/2} - v_{n-1/2}) / Δt - Σ f with v_{n+1/2} = (s(t_{n+1}) - u_n) / Δt
  // (eq:motion-force, eq:stage-motion)
  return mass * (((target - u) / view->dt - v - carried) / view->r_dt) - others;
}

static ct_status motion_force(const ct_effect *effect, const ct_view *view, double *force,
                              ct_error *error)
{
  const motion_data *data = effect->data;
  int32_t known = 0;
  double factor = 0.0, next = view->time + view->dt;
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t own = 3 * (int64_t)i + c, dof = 3 * (int64_t)data->nodes[i] + c;
      int32_t holder = data->holder[own];
      force[own] = 0.0;
      if (holder == 0) continue;
      if (data->inverse_mass[dof] == 0.0)
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, data->nodes[i]},
                       "motion %d: %c of node %d is held by a support too", (int)holder - 1,
                       "xyz"[c], (int)data->nodes[i]);
      const ct_motion *motion = &data->motions[holder - 1];
      if (holder != known) factor = ct_amplitude_value(&motion->amplitude, next);
      known = holder;
      double carried =
          view->acceleration_before == NULL ? 0.0 : view->l_dt * view->acceleration_before[dof];
      force[own] =
          force_to(factor * motion->displacement[c], view->displacement[dof], view->velocity[dof],
                   carried, data->mass[data->nodes[i]], view->total[dof], view);
    }
  return CT_OK;
}

static ct_status motion_increment(const ct_effect *effect, const ct_view *view, double *increment,
                                  ct_error *error)
{
  const motion_data *data = effect->data;
  (void)error;
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t own = 3 * (int64_t)i + c, dof = 3 * (int64_t)data->nodes[i] + c;
      int32_t holder = data->holder[own];
      increment[own] = NAN;
      if (holder == 0 || view->dt == 0.0) continue;
      const ct_motion *motion = &data->motions[holder - 1];
      increment[own] =
          ct_amplitude_value(&motion->amplitude, view->time + view->dt) * motion->displacement[c] -
          view->displacement[dof];
    }
  return CT_OK;
}

static const ct_effect_constraints CONSTRAINTS = {.increment = motion_increment};

static ct_status check_motion(const ct_motion *motion, int32_t number, int32_t node_count,
                              ct_error *error)
{
  if (motion->nodes == NULL || motion->node_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "motion %d has no nodes", (int)number);
  if (!motion->fixed[0] && !motion->fixed[1] && !motion->fixed[2])
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "motion %d holds no component",
                   (int)number);
  if (motion->amplitude.count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "motion %d has no amplitude", (int)number);
  for (int c = 0; c < 3; c++)
    if (motion->fixed[c] && !isfinite(motion->displacement[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "motion %d: displacement %c is not finite",
                     (int)number, "xyz"[c]);
  for (int32_t i = 0; i < motion->node_count; i++)
    if (motion->nodes[i] < 0 || motion->nodes[i] >= node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, motion->nodes[i]},
                     "motion %d names node %d, there are nodes 0 to %d", (int)number,
                     (int)motion->nodes[i], (int)node_count - 1);
  return ct_amplitude_check(&motion->amplitude, error);
}

/* Enter one motion into a table over all nodes of the problem. */
static ct_status enter(const ct_motion *motion, int32_t number, int32_t *holder, ct_error *error)
{
  for (int32_t i = 0; i < motion->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int32_t *own = &holder[3 * (int64_t)motion->nodes[i] + c];
      if (motion->fixed[c] && *own != 0 && *own != number + 1)
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, motion->nodes[i]},
                       "motion %d: %c of node %d follows motion %d already", (int)number, "xyz"[c],
                       (int)motion->nodes[i], (int)*own - 1);
      if (motion->fixed[c]) *own = number + 1;
    }
  return CT_OK;
}

/* Copy the motions with their amplitudes. */
static ct_status copy_motions(motion_data *data, const ct_motion *motions, int32_t count)
{
  size_t points = 0;
  for (int32_t i = 0; i < count; i++) points += 2 * (size_t)motions[i].amplitude.count;
  data->motions = ct_allocate((size_t)count, sizeof *data->motions);
  data->points = ct_allocate(points, sizeof *data->points);
  if (data->motions == NULL || data->points == NULL) return CT_ERROR_MEMORY;
  double *room = data->points;
  for (int32_t i = 0; i < count; i++) {
    size_t n = (size_t)motions[i].amplitude.count;
    memcpy(room, motions[i].amplitude.time, n * sizeof *room);
    memcpy(room + n, motions[i].amplitude.value, n * sizeof *room);
    data->motions[i] = motions[i];
    data->motions[i].nodes = NULL;
    data->motions[i].amplitude = (ct_amplitude){(int32_t)n, room, room + n};
    room += 2 * n;
  }
  return CT_OK;
}

/* Keep the rows of nodes with a prescribed component. */
static ct_status compress(motion_data *data, int32_t node_count, const int32_t *holder)
{
  int32_t count = 0;
  for (int32_t n = 0; n < node_count; n++)
    count += holder[3 * (int64_t)n] || holder[3 * (int64_t)n + 1] || holder[3 * (int64_t)n + 2];
  data->nodes = ct_allocate((size_t)count, sizeof *data->nodes);
  data->holder = ct_allocate((size_t)count, 3 * sizeof *data->holder);
  if (data->nodes == NULL || data->holder == NULL) return CT_ERROR_MEMORY;
  for (int32_t n = 0; n < node_count; n++) {
    const int32_t *own = &holder[3 * (int64_t)n];
    if (own[0] == 0 && own[1] == 0 && own[2] == 0) continue;
    memcpy(&data->holder[3 * (int64_t)data->node_count], own, 3 * sizeof *own);
    data->nodes[data->node_count++] = n;
  }
  return CT_OK;
}

ct_motion_def ct_motion_def_default(void) { return (ct_motion_def){.cookie = CT_DEF_COOKIE}; }

/* Enter all motions, and keep copies of them in `data`. */
static ct_status prepare(motion_data *data, const ct_motion_def *def, int32_t node_count,
                         ct_error *error)
{
  int32_t *holder = ct_allocate((size_t)node_count, 3 * sizeof *holder);
  ct_status status = holder != NULL ? CT_OK : CT_ERROR_MEMORY;
  for (int32_t i = 0; status == CT_OK && i < def->motion_count; i++) {
    status = check_motion(&def->motions[i], i, node_count, error);
    if (status == CT_OK) status = enter(&def->motions[i], i, holder, error);
  }
  if (status == CT_OK) status = copy_motions(data, def->motions, def->motion_count);
  if (status == CT_OK) status = compress(data, node_count, holder);
  if (status == CT_ERROR_MEMORY)
    ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the motions");
  ct_release(holder);
  return status;
}

ct_status ct_motion_create_effect(const ct_motion_def *def, const ct_problem *problem,
                                  ct_effect **effect, ct_error *error)
{
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, effect, "motion", error);
  if (status != CT_OK) return status;
  if (def->motions == NULL || def->motion_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "motion: nothing to move");
  motion_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the motions");
  status = prepare(data, def, problem->node_count, error);
  data->mass = problem->mass;
  data->inverse_mass = problem->inverse_mass;
  ct_effect filled = {.kind = CT_EFFECT_MOTION,
                      .label = "support",
                      .phase = CT_PHASE_PRESCRIBED,
                      .data = data,
                      .free_data = free_data,
                      .nodes = data->nodes,
                      .node_count = data->node_count,
                      .flops = 18.0 * data->node_count,
                      .bytes = 130.0 * data->node_count,
                      .force = motion_force,
                      .constraints = &CONSTRAINTS};
  return ct_effect_finish(status, &filled, effect, error);
}
