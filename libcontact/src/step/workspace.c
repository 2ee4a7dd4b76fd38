/* What the other files of the room read of a problem and a state: sizes, views, forces that are
 * known. */
#include "../base/error.h"
#include "../base/list.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "constraints.h"
#include "workspace.h"

#include <float.h>
#include <math.h>
#include <string.h>

int ct_problem_is_linear(const ct_problem *problem)
{
  for (int32_t i = 0; i < problem->body_count; i++)
    if (problem->bodies[i].material.law != CT_LINEAR && !ct_problem_is_rigid(problem, i)) return 0;
  return 1;
}

const ct_material *ct_body_material(const ct_body *body, int32_t element)
{
  return body->materials != NULL ? &body->materials[element] : &body->material;
}

double ct_problem_edge(const ct_problem *problem)
{
  double edge = INFINITY;
  for (int32_t i = 0; i < problem->body_count; i++)
    edge = fmin(edge, ct_mesh_shortest_edge(problem->bodies[i].mesh));
  return edge;
}

ct_starts ct_state_starts(const ct_problem *problem, int32_t k)
{
  ct_starts start = {0, 0, 0};
  for (int32_t i = 0; i < k; i++) {
    int64_t dofs = 3 * (int64_t)problem->effects[i]->node_count;
    start.work += problem->effects[i]->phase == CT_PHASE_REACTION ? 0 : dofs;
    start.impulse += i == 0 ? 0 : dofs;
    start.memory += problem->effects[i]->memory_count;
  }
  return start;
}

double *ct_stage_last_acceleration(const ct_problem *problem, const ct_state *state)
{
  return ct_scheme_of(problem)->stores
             ? state->memory + ct_state_starts(problem, problem->effect_count).memory
             : state->workspace->last_acceleration;
}

ct_status ct_stage_check(const ct_state *state, ct_error *error)
{
  if (state->workspace->stage == 0) return CT_OK;
  return CT_REFUSE(error, "the state is within step %lld, whose second stage failed",
                   (long long)state->step);
}

const uint64_t *ct_workspace_begun(const ct_state *state)
{
  return state->step > 0 || state->workspace->constraints == NULL
             ? NULL
             : state->workspace->constraints->begun;
}

int32_t ct_workspace_read_by(const ct_problem *problem, int32_t k)
{
  int32_t i = problem->effects[k]->reads == NULL ? -1 : k - 1;
  while (i >= 0 && problem->effects[i] != problem->effects[k]->reads) i--;
  return i;
}

ct_view ct_workspace_view(const ct_problem *problem, const ct_state *state, int32_t k)
{
  int64_t memory = ct_state_starts(problem, k).memory;
  int32_t read = ct_workspace_read_by(problem, k);
  ct_stage stage =
      state->workspace->starting ? (ct_stage){0.0, 0.0, 0.0, 0.0} : ct_stage_now(problem, state);
  return (ct_view){.time = state->time,
                   .settings = &problem->settings,
                   .reference = problem->reference,
                   .displacement = state->displacement,
                   .velocity = state->velocity,
                   .memory = state->workspace->memory + memory,
                   .next_memory = state->workspace->next_memory + memory,
                   .continued = state->workspace->continued,
                   .scratch = state->workspace->scratch[k],
                   .read = read < 0 ? NULL : state->workspace->scratch[read],
                   .dt = stage.tau,
                   .c_dt = stage.c,
                   .r_dt = stage.r,
                   .l_dt = stage.l,
                   .acceleration_before = ct_stage_last_acceleration(problem, state),
                   .total = state->workspace->total};
}

ct_status ct_check_finite(const ct_problem *problem, const ct_state *state, ct_error *error)
{
  int64_t count = 3 * (int64_t)problem->node_count, d = 0;
  if (ct_largest(state->velocity, count) <= DBL_MAX &&
      ct_largest(state->displacement, count) <= CT_LARGEST_LENGTH)
    return CT_OK;
  while (isfinite(state->velocity[d]) && fabs(state->displacement[d]) <= CT_LARGEST_LENGTH) d++;
  ct_place at = ct_effect_place(problem, (int32_t)(d / 3));
  return ct_fail(error, CT_ERROR_BLOWUP, at,
                 "the motion stopped being finite by t = %g (step %lld): body %s, node %d",
                 state->time, (long long)state->step, problem->bodies[at.body].name, (int)at.point);
}

void ct_workspace_force_at(const ct_problem *problem, const ct_state *state, int32_t k, int32_t i,
                           double force[3])
{
  const ct_workspace *w = state->workspace;
  int32_t node = ct_effect_node(problem->effects[k], i);
  const double *total = &w->total[3 * (int64_t)node], *own = total;
  if (problem->effects[k]->phase == CT_PHASE_REACTION) {
    const double *inverse_mass = &problem->inverse_mass[3 * (int64_t)node];
    // -- The reaction balances all other forces (eq:reaction)
    for (int c = 0; c < 3; c++) force[c] = inverse_mass[c] == 0.0 ? -total[c] : 0.0;
    return;
  }
  if (k > 0) own = &w->force[k][3 * (int64_t)i];
  else {
    // `total` is the first effect's force except at nodes where others were added.
    int32_t place = ct_lower_bound(w->shared, w->shared_count, node);
    if (place < w->shared_count && w->shared[place] == node)
      own = &w->shared_first[3 * (int64_t)place];
  }
  memcpy(force, own, 3 * sizeof *force);
}
