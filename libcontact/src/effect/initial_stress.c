/* Forces of a stress that bodies have without displacement. */
#include <libcontact/effect.h>

#include "../base/error.h"
#include "../base/stream.h"
#include "../solid/call.h"
#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "solid.h"

#include <math.h>
#include <string.h>

typedef struct stress_data {
  ct_pool pool;
  int32_t *nodes;
  double *force; /* at each of these nodes */
} stress_data;

static ct_status stress_force(const ct_effect *effect, const ct_view *view, double *force,
                              ct_error *error)
{
  (void)view, (void)error;
  memcpy(force, ((const stress_data *)effect->data)->force,
         3 * (size_t)effect->node_count * sizeof *force);
  return CT_OK;
}

static ct_status stress_energy(const ct_effect *effect, const ct_view *view, double *energy,
                               ct_error *error)
{
  const stress_data *data = effect->data;
  double terms[CT_PIECE];
  ct_stream sum = {0};
  (void)error;
  for (int32_t first, end; ct_stream_piece(&sum, 1, effect->node_count, &first, &end);) {
    for (int32_t i = first; i < end; i++) {
      const double *u = &view->displacement[3 * (int64_t)data->nodes[i]],
                   *f = &data->force[3 * (int64_t)i];
      // -- Work that the forces can do on the way back (eq:initial-stress-potential)
      terms[i - first] = -((f[0] * u[0] + f[1] * u[1]) + f[2] * u[2]);
    }
    ct_stream_add(&sum, terms, end - first);
  }
  *energy = ct_stream_sum(&sum);
  return CT_OK;
}

static int has_stress(const ct_body *body)
{
  for (int k = 0; k < 6; k++)
    if (body->initial_stress[k] != 0.0) return 1;
  return 0;
}

static ct_status check(const ct_initial_stress_def *def, const ct_problem *problem, int32_t *bodies,
                       int32_t *count, ct_error *error)
{
  if (def->solid == NULL) return CT_REFUSE_NULL(error);
  if (def->solid->kind != CT_EFFECT_SOLID)
    return CT_REFUSE(error, "initial stress: the effect is %s, not the solid", def->solid->label);
  for (int32_t i = 0; i < problem->body_count; i++) {
    const ct_body *body = &problem->bodies[i];
    const ct_place place = {i, -1, -1};
    for (int k = 0; k < 6; k++)
      if (!isfinite(body->initial_stress[k]))
        return ct_fail(error, CT_INVALID, place, "body %s: its initial stress is not finite",
                       body->name);
    if (!has_stress(body)) continue;
    if (body->material.law != CT_LINEAR)
      return ct_fail(error, CT_ERROR_UNSUPPORTED, place,
                     "body %s: an initial stress is for the law \"linear\"; give the displacement "
                     "that causes it instead",
                     body->name);
    if (body->materials != NULL)
      return ct_fail(error, CT_ERROR_UNSUPPORTED, place,
                     "body %s: an initial stress is for a body of one material", body->name);
    bodies[(*count)++] = i;
  }
  return *count > 0 ? CT_OK : CT_REFUSE(error, "initial stress: no body has one");
}

/* Displacements of a body that cause its initial stress by Hooke's law. */
static void strain_body(const ct_body *body, double *u)
{
  const double E = body->material.young, nu = body->material.poisson, *s = body->initial_stress;
  double low[3], high[3], strain[3][3];
  ct_mesh_bounds(body->mesh, low, high);
  // -- The strain of the stress (eq:initial-strain)
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    strain[i][i] = (s[i] - nu * (s[j] + s[k])) / E;
    strain[i][j] = strain[j][i] = (1.0 + nu) / E * s[3 + i];
  }
  for (int64_t n = 0; n < body->mesh->node_count; n++) {
    const double *X = &body->mesh->nodes[3 * n];
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = X[c] - 0.5 * (low[c] + high[c]);
    for (int c = 0; c < 3; c++)
      u[3 * n + c] = (strain[c][0] * x[0] + strain[c][1] * x[1]) + strain[c][2] * x[2];
  }
}

/* The forces of the bodies, one after another. */
static ct_status prepare(stress_data *data, const ct_solid_data *solid, const ct_problem *problem,
                         const int32_t *bodies, int32_t count, int32_t node_count, ct_error *error)
{
  const size_t dofs = 3 * (size_t)node_count;
  data->force = ct_pool_take(&data->pool, dofs, sizeof *data->force);
  double *u = ct_allocate(dofs, sizeof *u), *f = data->force,
         *values = ct_allocate((size_t)solid->value_count, sizeof *values);
  const int has_memory = !data->pool.failed && u != NULL && values != NULL;
  for (int32_t i = 0; has_memory && i < count; i++) {
    const ct_body *body = &problem->bodies[bodies[i]];
    strain_body(body, u);
    // -- The kernel's force of this displacement (eq:initial-stress-force)
    ct_part_call call = ct_part_task(&solid->parts[bodies[i]], u, values, solid->ring_stride, f);
    ct_part_forces(&call, 1, 1);
    f += 3 * (int64_t)body->mesh->node_count;
  }
  ct_release(u);
  ct_release(values);
  return has_memory ? CT_OK : CT_NO_MEMORY(error, "the initial stress");
}

static const ct_effect_calls CALLS = {.force = stress_force,
                                      .energy = stress_energy,
                                      .free_data = ct_pool_free,
                                      .pieces = {.cut = ct_piece_local}};

ct_initial_stress_def ct_initial_stress_def_default(void)
{
  return (ct_initial_stress_def){.cookie = CT_DEF_COOKIE};
}

ct_status ct_initial_stress_create_effect(const ct_initial_stress_def *def,
                                          const ct_problem *problem, ct_effect **effect,
                                          ct_error *error)
{
  ct_status status;
  stress_data *d =
      ct_effect_begin(def, problem, effect, "initial stress", sizeof *d, &status, error);
  if (d == NULL) return status;
  ct_effect filled = {
      .kind = CT_EFFECT_INITIAL_STRESS, .label = "initial_stress", .calls = &CALLS, .data = d};
  int32_t count = 0, *bodies = ct_pool_take(&d->pool, (size_t)problem->body_count, sizeof *bodies);
  status = bodies != NULL ? check(def, problem, bodies, &count, error)
                          : CT_NO_MEMORY(error, "the initial stress");
  if (status == CT_OK)
    status = ct_effect_body_nodes(problem, bodies, count, "initial stress", &d->pool, &d->nodes,
                                  &filled.node_count, error);
  if (status == CT_OK)
    status = prepare(d, def->solid->data, problem, bodies, count, filled.node_count, error);
  filled.nodes = d->nodes;
  filled.cost.bytes = 48.0 * filled.node_count;
  return ct_effect_finish(status, &filled, effect, error);
}
