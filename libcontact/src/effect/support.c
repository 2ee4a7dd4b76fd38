#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../base/error.h"
#include "../base/memory.h"

#include <math.h>
#include <string.h>

/* What a node is held to: for each component whether it is prescribed, and its velocity. */
typedef struct hold {
  int fixed[3];
  double velocity[3];
} hold;

/* From the i-th node of the effect on, the nodes have a hold. */
typedef struct hold_run {
  int32_t i, hold;
} hold_run;

/* The nodes of the effect (null: all), and runs of equal holds. Many nodes share a hold: supports
 * are few. */
typedef struct support_data {
  int32_t *nodes;
  int32_t node_count, hold_count, run_count;
  hold *holds;
  hold_run *runs;
} support_data;

static void free_data(void *data)
{
  support_data *d = data;
  if (d == NULL) return;
  ct_release(d->nodes);
  ct_release(d->holds);
  ct_release(d->runs);
  ct_release(d);
}

static ct_status check_support(const ct_support *support, int32_t number, int32_t node_count,
                               ct_error *error)
{
  if (support->nodes == NULL || support->node_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "support %d has no nodes", (int)number);
  if (!support->fixed[0] && !support->fixed[1] && !support->fixed[2])
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "support %d holds no component",
                   (int)number);
  for (int c = 0; c < 3; c++)
    if (support->fixed[c] && !isfinite(support->velocity[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "support %d: velocity %c is not finite",
                     (int)number, "xyz"[c]);
  for (int32_t i = 0; i < support->node_count; i++)
    if (support->nodes[i] < 0 || support->nodes[i] >= node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, support->nodes[i]},
                     "support %d names node %d, there are nodes 0 to %d", (int)number,
                     (int)support->nodes[i], (int)node_count - 1);
  return CT_OK;
}

/* Enter one support into tables over all nodes of the problem. */
static ct_status enter(const ct_support *support, int32_t number, int *fixed, double *velocity,
                       ct_error *error)
{
  for (int32_t i = 0; i < support->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)support->nodes[i] + c;
      if (!support->fixed[c]) continue;
      if (fixed[dof] && velocity[dof] != support->velocity[c])
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, support->nodes[i]},
                       "support %d: %c of node %d has the velocity %g already, not %g", (int)number,
                       "xyz"[c], (int)support->nodes[i], velocity[dof], support->velocity[c]);
      fixed[dof] = 1;
      velocity[dof] = support->velocity[c];
    }
  return CT_OK;
}

/* Number of a hold among the last ones of a list; a new one goes to the end. */
static int32_t number_of(const hold *own, hold *list, int32_t *count)
{
  enum { LOOK_BACK = 64 };
  for (int32_t i = *count - 1; i >= 0 && i >= *count - LOOK_BACK; i--)
    if (memcmp(&list[i], own, sizeof *own) == 0) return i;
  list[*count] = *own;
  return (*count)++;
}

/* Which of the components of node `n` are prescribed, and how; answers whether any is. */
static int hold_at(const int *fixed, const double *velocity, int32_t n, hold *own)
{
  memset(own, 0, sizeof *own);
  memcpy(own->fixed, &fixed[3 * (int64_t)n], sizeof own->fixed);
  memcpy(own->velocity, &velocity[3 * (int64_t)n], sizeof own->velocity);
  return own->fixed[0] || own->fixed[1] || own->fixed[2];
}

/* Keep the nodes with a prescribed component; first in room for as many holds and runs as there are
 * nodes. */
static ct_status compress(support_data *data, int32_t node_count, const int *fixed,
                          const double *velocity)
{
  hold own;
  int32_t count = 0;
  for (int32_t n = 0; n < node_count; n++) count += hold_at(fixed, velocity, n, &own);
  hold *holds = ct_allocate((size_t)count, sizeof *holds);
  hold_run *runs = ct_allocate((size_t)count, sizeof *runs);
  if (count < node_count) data->nodes = ct_allocate((size_t)count, sizeof *data->nodes);
  int whole = holds != NULL && runs != NULL && (count == node_count || data->nodes != NULL);
  for (int32_t n = 0; whole && n < node_count; n++) {
    if (!hold_at(fixed, velocity, n, &own)) continue;
    int32_t number = number_of(&own, holds, &data->hold_count);
    if (data->run_count == 0 || runs[data->run_count - 1].hold != number)
      runs[data->run_count++] = (hold_run){data->node_count, number};
    if (data->nodes != NULL) data->nodes[data->node_count] = n;
    data->node_count++;
  }
  if (whole) data->holds = ct_duplicate(holds, (size_t)data->hold_count * sizeof *holds);
  if (whole) data->runs = ct_duplicate(runs, (size_t)data->run_count * sizeof *runs);
  ct_release(holds);
  ct_release(runs);
  return data->holds != NULL && data->runs != NULL ? CT_OK : CT_ERROR_MEMORY;
}

ct_support_def ct_support_def_default(void) { return (ct_support_def){.cookie = CT_DEF_COOKIE}; }

/* Enter all supports, and keep what they hold in `data`. */
static ct_status prepare(support_data *data, const ct_support_def *def, int32_t node_count,
                         ct_error *error)
{
  int *fixed = ct_allocate((size_t)node_count, 3 * sizeof *fixed);
  double *velocity = ct_allocate((size_t)node_count, 3 * sizeof *velocity);
  ct_status status = fixed != NULL && velocity != NULL ? CT_OK : CT_ERROR_MEMORY;
  for (int32_t i = 0; status == CT_OK && i < def->support_count; i++) {
    status = check_support(&def->supports[i], i, node_count, error);
    if (status == CT_OK) status = enter(&def->supports[i], i, fixed, velocity, error);
    ct_blame(error, status, CT_PART_SUPPORT, i);
  }
  if (status == CT_OK) status = compress(data, node_count, fixed, velocity);
  if (status == CT_ERROR_MEMORY)
    ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the supports");
  ct_release(fixed);
  ct_release(velocity);
  return status;
}

ct_status ct_support_create_effect(const ct_support_def *def, const ct_problem *problem,
                                   ct_effect **effect, ct_error *error)
{
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, effect, "support", error);
  if (status != CT_OK) return status;
  if (def->supports == NULL || def->support_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "support: nothing to hold");
  support_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the supports");
  status = prepare(data, def, problem->node_count, error);
  ct_effect filled = {.kind = CT_EFFECT_SUPPORT,
                      .label = "support",
                      .phase = CT_PHASE_REACTION,
                      .data = data,
                      .free_data = free_data,
                      .nodes = data->nodes,
                      .node_count = data->node_count};
  return ct_effect_finish(status, &filled, effect, error);
}

ct_status ct_support_apply(const ct_effect *effect, double *inverse_mass, double *velocity)
{
  if (effect == NULL || effect->kind != CT_EFFECT_SUPPORT || inverse_mass == NULL ||
      velocity == NULL)
    return CT_ERROR_ARGUMENT;
  const support_data *data = effect->data;
  for (int32_t i = 0, r = 0; i < data->node_count; i++) {
    if (r + 1 < data->run_count && data->runs[r + 1].i == i) r++;
    const hold *own = &data->holds[data->runs[r].hold];
    for (int c = 0; c < 3; c++) {
      if (!own->fixed[c]) continue;
      int64_t dof = 3 * (int64_t)(data->nodes == NULL ? i : data->nodes[i]) + c;
      inverse_mass[dof] = 0.0;
      velocity[dof] = own->velocity[c];
    }
  }
  return CT_OK;
}
