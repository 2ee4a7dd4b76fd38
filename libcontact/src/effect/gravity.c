/* Weight: a force m g at every node. */
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/amplitude.h"
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"

#include <math.h>
#include <string.h>

typedef struct gravity_data {
  ct_pool pool;
  double acceleration[3];
  int32_t *nodes;
  const double *mass; /* of the problem */
  ct_amplitude amplitude;
} gravity_data;

/* Forces of consecutive nodes, of four at a time. */
CT_CLONES
static void weigh(int32_t count, const double *restrict mass, const double *restrict g,
                  double *restrict force)
{
  int32_t rows = CT_ROWS ? count / 4 * 4 : 0;
#if CT_ROWS
  const double x = g[0], y = g[1], z = g[2];
  const ct_quad pattern[3] = {{x, y, z, x}, {y, z, x, y}, {z, x, y, z}};
  for (int32_t i = 0; i < rows; i += 4) {
    ct_quad m[3];
    ct_thrice(&mass[i], m);
    for (int k = 0; k < 3; k++) *(ct_quad *)(void *)&force[3 * i + 4 * k] = m[k] * pattern[k];
  }
#endif
  for (int32_t i = rows; i < count; i++)
    // -- Weight of a node (eq:gravity-force)
    for (int c = 0; c < 3; c++) force[3 * i + c] = mass[i] * g[c];
}

static ct_status gravity_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const gravity_data *data = effect->data;
  // -- The acceleration at this time (eq:gravity-amplitude)
  const double factor = ct_amplitude_value(&data->amplitude, view->time),
               g[3] = {factor * data->acceleration[0], factor * data->acceleration[1],
                       factor * data->acceleration[2]};
  (void)error;
  for (int32_t i = 0, end; i < effect->node_count; i = end) {
    end = i + ct_row_length(&data->nodes[i], effect->node_count - i);
    weigh(end - i, &data->mass[data->nodes[i]], g, &force[3 * (int64_t)i]);
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
  for (int32_t first, end; ct_stream_piece(&sum, 1, effect->node_count, &first, &end);) {
    for (int32_t i = first; i < end; i++) {
      const double *u = &view->displacement[3 * (int64_t)data->nodes[i]];
      // -- Potential, zero at the reference position (eq:gravity-potential)
      terms[i - first] = -data->mass[data->nodes[i]] * ((g[0] * u[0] + g[1] * u[1]) + g[2] * u[2]);
    }
    ct_stream_add(&sum, terms, end - first);
  }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

/* Constant weight has a potential, weight that changes in time has none. */
static const ct_effect_calls CONSTANT = {.force = gravity_force,
                                         .energy = gravity_energy,
                                         .free_data = ct_pool_free,
                                         .pieces = {.cut = ct_piece_local}},
                             CHANGING = {.force = gravity_force,
                                         .free_data = ct_pool_free,
                                         .pieces = {.cut = ct_piece_local}};

ct_gravity_def ct_gravity_def_default(void) { return (ct_gravity_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_gravity_create_effect(const ct_gravity_def *def, const ct_problem *problem,
                                   ct_effect **effect, ct_error *error)
{
  ct_status status;
  gravity_data *data =
      ct_effect_begin(def, problem, effect, "gravity", sizeof *data, &status, error);
  if (data == NULL) return status;
  data->mass = problem->mass;
  data->amplitude = def->amplitude;
  memcpy(data->acceleration, def->acceleration, sizeof data->acceleration);
  int32_t count = 0;
  status = ct_effect_body_nodes(problem, def->bodies, def->body_count, "gravity", &data->pool,
                                &data->nodes, &count, error);
  if (status == CT_OK) status = ct_amplitude_copy(&data->pool, &data->amplitude, error);
  if (status == CT_OK && data->pool.failed) status = CT_NO_MEMORY(error, "gravity");
  for (int c = 0; c < 3; c++)
    if (!isfinite(def->acceleration[c]))
      status = ct_fail(error, CT_INVALID, CT_NOWHERE, "gravity: acceleration %c is not finite",
                       "xyz"[c]);
  ct_effect filled = {.kind = CT_EFFECT_GRAVITY,
                      .label = "gravity",
                      .calls = def->amplitude.count == 0 ? &CONSTANT : &CHANGING,
                      .data = data,
                      .nodes = data->nodes,
                      .node_count = count,
                      .cost = {.flops = 3.0 * count, .bytes = 36.0 * count}};
  return ct_effect_finish(status, &filled, effect, error);
}
