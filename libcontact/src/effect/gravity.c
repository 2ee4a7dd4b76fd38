/* Weight: a force m g at every node. */
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"

#include <math.h>

typedef struct gravity_data {
  double acceleration[3];
  int32_t *nodes;
  const double *mass; /* of the problem */
} gravity_data;

static void free_data(void *data)
{
  ct_release(((gravity_data *)data)->nodes);
  ct_release(data);
}

static ct_status gravity_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const gravity_data *data = effect->data;
  (void)view, (void)error;
  for (int32_t i = 0; i < effect->node_count; i++) {
    double m = data->mass[data->nodes[i]];
    // -- Weight of a node (eq:gravity-force)
    for (int c = 0; c < 3; c++) force[3 * (int64_t)i + c] = m * data->acceleration[c];
  }
  return CT_OK;
}

static ct_status gravity_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                ct_error *error)
{
  const gravity_data *data = effect->data;
  const double *g = data->acceleration;
  double terms[CT_PIECE];
  ct_stream sum = {0};
  (void)error;
  while (ct_stream_again(&sum, 1))
    for (int32_t first = 0, end; first < effect->node_count; first = end) {
      end = ct_piece_end(first, effect->node_count);
      for (int32_t i = first; i < end; i++) {
        const double *u = &view->displacement[3 * (int64_t)data->nodes[i]];
        // -- Potential, zero at the reference position (eq:gravity-potential)
        terms[i - first] =
            -data->mass[data->nodes[i]] * ((g[0] * u[0] + g[1] * u[1]) + g[2] * u[2]);
      }
      ct_stream_add(&sum, terms, end - first);
    }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

ct_gravity_def ct_gravity_def_default(void) { return (ct_gravity_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_gravity_create_effect(const ct_gravity_def *def, const ct_problem *problem,
                                   ct_effect **effect, ct_error *error)
{
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, effect, "gravity", error);
  if (status != CT_OK) return status;
  for (int c = 0; c < 3; c++)
    if (!isfinite(def->acceleration[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "gravity: acceleration %c is not finite",
                     "xyz"[c]);
  gravity_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "gravity: no memory");
  int32_t count = 0;
  status = ct_effect_body_nodes(problem, def->bodies, def->body_count, "gravity", &data->nodes,
                                &count, error);
  for (int c = 0; c < 3; c++) data->acceleration[c] = def->acceleration[c];
  data->mass = problem->mass;
  ct_effect filled = {.kind = CT_EFFECT_GRAVITY,
                      .label = "gravity",
                      .data = data,
                      .nodes = data->nodes,
                      .node_count = count,
                      .flops = 3.0 * count,
                      .bytes = 36.0 * count,
                      .force = gravity_force,
                      .energy = gravity_energy,
                      .free_data = free_data};
  return ct_effect_finish(status, &filled, effect, error);
}
