/* Damping in proportion to mass. */
#include <contact/damping.h>

#include "effect_internal.h"
#include "error.h"
#include "memory.h"

#include <math.h>

typedef struct damping_data {
  double rate;
  int32_t *nodes;
  const double *mass; /* of the problem */
} damping_data;

static void free_data(void *data)
{
  ct_release(((damping_data *)data)->nodes);
  ct_release(data);
}

static ct_status damping_force(const ct_effect *effect, const ct_view *view, double *force, ct_error *error)
{
  const damping_data *data = effect->data;
  (void)error;
  for (int32_t i = 0; i < effect->node_count; i++) {
    int64_t node = data->nodes[i];
    double c = data->rate * data->mass[node];
    // -- Against the velocity half a step back (eq:damping-force)
    for (int k = 0; k < 3; k++) force[3 * (int64_t)i + k] = -c * view->velocity[3 * node + k];
  }
  return CT_OK;
}

static ct_status damping_rate(const ct_effect *effect, const ct_view *view, double *rate, ct_error *error)
{
  (void)view, (void)error;
  *rate = ((const damping_data *)effect->data)->rate;
  return CT_OK;
}

ct_status ct_damping_create_effect(const ct_damping *damping, const ct_problem *problem, ct_effect **effect, ct_error *error)
{
  if (damping == NULL || problem == NULL || effect == NULL) return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "damping: null argument");
  if (!(damping->rate >= 0.0) || !isfinite(damping->rate)) return ct_fail(error, CT_INVALID, CT_NOWHERE, "damping: the rate is %g", damping->rate);
  damping_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "damping: no memory");
  int32_t count = 0;
  ct_status status = ct_effect_body_nodes(problem, damping->bodies, damping->body_count, "damping", &data->nodes, &count, error);
  data->rate = damping->rate;
  data->mass = problem->mass;
  ct_effect filled = {.name = "damping", .data = data, .nodes = data->nodes, .node_count = count, .flops = 4.0 * count, .bytes = 60.0 * count,
                      .force = damping_force, .damping = damping_rate, .free_data = free_data};
  if (status == CT_OK) status = ct_effect_create(&filled, effect, error);
  if (status != CT_OK) free_data(data);
  return status;
}
