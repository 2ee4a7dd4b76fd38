/* Displacements that follow an amplitude. */
#include <libcontact/effect.h>

#include "../base/amplitude.h"
#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/error.h"
#include "held.h"

#include <math.h>

/* The force that moves one component to its prescribed place at the next evaluation, from the
 * velocity `v` before the kick and the further displacement `carried`. */
static double force_to(double target, double u, double v, double carried, double mass,
                       double others, const ct_view *view)
{
  // While the state is created nothing is prescribed yet: the node keeps its velocity.
  if (view->dt == 0.0) return -others;
  // -- r = m (v_{n+1/2} - v_{n-1/2}) / Δt - Σ f with v_{n+1/2} = (s(t_{n+1}) - u_n) / Δt
  // (eq:motion-velocity, eq:motion-force, eq:stage-motion)
  return mass * (((target - u) / view->dt - v - carried) / view->r_dt) - others;
}

static ct_status motion_force(const ct_effect *effect, const ct_view *view, double *force,
                              ct_error *error)
{
  const ct_held *data = effect->data;
  int32_t known = 0;
  double factor = 0.0, next = view->time + view->dt;
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int32_t node = ct_effect_node(effect, i);
      int64_t own = 3 * (int64_t)i + c, dof = 3 * (int64_t)node + c;
      int32_t holder = data->holder[own];
      force[own] = 0.0;
      if (holder == 0) continue;
      const ct_motion *motion = &data->motions[holder - 1];
      if (data->inverse_mass[dof] == 0.0) {
        // A support that holds still what does not move.
        if (motion->displacement[c] == 0.0 && view->velocity[dof] == 0.0) continue;
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, node},
                       "motion %d: %c of node %d is prescribed by a support, too, and moves "
                       "otherwise there",
                       (int)holder - 1, "xyz"[c], (int)node);
      }
      if (holder != known) factor = ct_amplitude_value(&motion->amplitude, next);
      known = holder;
      double carried =
          view->acceleration_before == NULL ? 0.0 : view->l_dt * view->acceleration_before[dof];
      force[own] = force_to(factor * motion->displacement[c], view->displacement[dof],
                            view->velocity[dof], carried, data->mass[node], view->total[dof], view);
    }
  return CT_OK;
}

static ct_status motion_increment(const ct_effect *effect, const ct_view *view, double *increment,
                                  ct_error *error)
{
  const ct_held *data = effect->data;
  (void)error;
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t own = 3 * (int64_t)i + c, dof = 3 * (int64_t)ct_effect_node(effect, i) + c;
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

static const ct_effect_calls CALLS = {.force = motion_force,
                                      .free_data = ct_pool_free,
                                      .constraints = {.increment = motion_increment},
                                      .pieces = {.cut = ct_piece_local}};

ct_motion_def ct_motion_def_default(void) { return (ct_motion_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_motion_create_effect(const ct_motion_def *def, const ct_problem *problem,
                                  ct_effect **effect, ct_error *error)
{
  ct_status status;
  ct_held *data = ct_effect_begin(def, problem, effect, "motion", sizeof *data, &status, error);
  if (data == NULL) return status;
  status = ct_held_fill(data, CT_PART_NONE, problem, def->motions, def->motion_count, error);
  for (int32_t i = 0; status == CT_OK && i < def->motion_count; i++)
    if (def->motions[i].amplitude.count < 1)
      status = CT_REFUSE(error, "motion %d has no amplitude, which says when it moves", (int)i);
  ct_effect filled = {
      .kind = CT_EFFECT_MOTION,
      .label = "support",
      .phase = CT_PHASE_PRESCRIBED,
      .calls = &CALLS,
      .data = data,
      .nodes = data->nodes,
      .node_count = data->node_count,
      .cost = {.flops = 18.0 * data->node_count, .bytes = 130.0 * data->node_count}};
  return ct_effect_finish(status, &filled, effect, error);
}
