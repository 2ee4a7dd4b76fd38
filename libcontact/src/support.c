#include <contact/support.h>

#include "error.h"
#include "memory.h"

#include <math.h>
#include <string.h>

/* What a node is held to: for each component whether it is prescribed, and its velocity. */
typedef struct hold {
  int fixed[3];
  double velocity[3];
} hold;

/* The nodes of the effect, each with its hold. Many nodes share a hold: supports are few. */
typedef struct support_data {
  int32_t *nodes, *hold_of;
  int32_t node_count, hold_count;
  hold *holds;
} support_data;

static void free_data(void *data)
{
  support_data *d = data;
  if (d == NULL) return;
  ct_release(d->nodes);
  ct_release(d->hold_of);
  ct_release(d->holds);
  ct_release(d);
}

static ct_status check_support(const ct_support *support, int32_t number, int32_t node_count, ct_error *error)
{
  if (support->nodes == NULL || support->node_count < 1)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "support %d has no nodes", (int)number);
  if (!support->fixed[0] && !support->fixed[1] && !support->fixed[2])
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "support %d holds no component", (int)number);
  for (int c = 0; c < 3; c++)
    if (support->fixed[c] && !isfinite(support->velocity[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "support %d: velocity %c is not finite", (int)number, "xyz"[c]);
  for (int32_t i = 0; i < support->node_count; i++)
    if (support->nodes[i] < 0 || support->nodes[i] >= node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, support->nodes[i]}, "support %d names node %d, there are nodes 0 to %d",
                     (int)number, (int)support->nodes[i], (int)node_count - 1);
  return CT_OK;
}

/* Enter one support into tables over all nodes of the problem. */
static ct_status enter(const ct_support *support, int32_t number, int *fixed, double *velocity, ct_error *error)
{
  for (int32_t i = 0; i < support->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)support->nodes[i] + c;
      if (!support->fixed[c]) continue;
      if (fixed[dof] && velocity[dof] != support->velocity[c])
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, support->nodes[i]},
                       "support %d: %c of node %d has the velocity %g already, not %g", (int)number, "xyz"[c],
                       (int)support->nodes[i], velocity[dof], support->velocity[c]);
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

/* Keep the nodes with a prescribed component. */
static ct_status compress(support_data *data, int32_t node_count, const int *fixed, const double *velocity)
{
  int32_t count = 0;
  for (int32_t n = 0; n < node_count; n++) count += fixed[3 * (int64_t)n] || fixed[3 * (int64_t)n + 1] || fixed[3 * (int64_t)n + 2];
  data->nodes = ct_allocate((size_t)count, sizeof *data->nodes);
  data->hold_of = ct_allocate((size_t)count, sizeof *data->hold_of);
  hold *all = ct_allocate((size_t)count, sizeof *all);
  for (int32_t n = 0; data->nodes != NULL && data->hold_of != NULL && all != NULL && n < node_count; n++) {
    const int *f = &fixed[3 * (int64_t)n];
    if (!f[0] && !f[1] && !f[2]) continue;
    hold own;
    memset(&own, 0, sizeof own);
    memcpy(own.fixed, f, sizeof own.fixed);
    memcpy(own.velocity, &velocity[3 * (int64_t)n], sizeof own.velocity);
    data->hold_of[data->node_count] = number_of(&own, all, &data->hold_count);
    data->nodes[data->node_count++] = n;
  }
  data->holds = all == NULL ? NULL : ct_allocate((size_t)data->hold_count, sizeof *data->holds);
  ct_status status = data->nodes != NULL && data->hold_of != NULL && data->holds != NULL ? CT_OK : CT_ERROR_MEMORY;
  if (status == CT_OK) memcpy(data->holds, all, (size_t)data->hold_count * sizeof *all);
  ct_release(all);
  return status;
}

ct_status ct_support_create_effect(const ct_support *supports, int32_t support_count, int32_t node_count, ct_effect **out, ct_error *error)
{
  if (supports == NULL || support_count < 1 || node_count < 1 || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "support: nothing to hold");
  ct_effect *effect = ct_allocate(1, sizeof *effect);
  support_data *data = ct_allocate(1, sizeof *data);
  int *fixed = ct_allocate((size_t)node_count, 3 * sizeof *fixed);
  double *velocity = ct_allocate((size_t)node_count, 3 * sizeof *velocity);
  ct_status status = CT_OK;
  if (!effect || !data || !fixed || !velocity) status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the supports");
  for (int32_t i = 0; status == CT_OK && i < support_count; i++) {
    status = check_support(&supports[i], i, node_count, error);
    if (status == CT_OK) status = enter(&supports[i], i, fixed, velocity, error);
  }
  if (status == CT_OK && compress(data, node_count, fixed, velocity) != CT_OK)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the supports");
  ct_release(fixed);
  ct_release(velocity);
  if (status != CT_OK) {
    free_data(data);
    ct_release(effect);
    return status;
  }
  *effect = (ct_effect){.name = "support", .data = data, .nodes = data->nodes, .node_count = data->node_count, .reaction = 1,
                        .free_data = free_data};
  *out = effect;
  return CT_OK;
}

ct_status ct_support_apply(const ct_effect *effect, double *inverse_mass, double *velocity)
{
  if (effect == NULL || effect->free_data != free_data || inverse_mass == NULL || velocity == NULL) return CT_ERROR_ARGUMENT;
  const support_data *data = effect->data;
  for (int32_t i = 0; i < data->node_count; i++) {
    const hold *own = &data->holds[data->hold_of[i]];
    for (int c = 0; c < 3; c++) {
      if (!own->fixed[c]) continue;
      inverse_mass[3 * (int64_t)data->nodes[i] + c] = 0.0;
      velocity[3 * (int64_t)data->nodes[i] + c] = own->velocity[c];
    }
  }
  return CT_OK;
}
