/* Tractions and pressures on faces. */
#include <libcontact/effect.h>
#include <libcontact/base.h>

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/amplitude.h"
#include "../base/error.h"
#include "../shape/facets.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

typedef struct load_data {
  ct_pool pool;
  ct_load_def given; /* the amplitude's arrays are ours */
  ct_facets facets;
  const double *mass; /* of the problem */
  double
      *dead; /* nodal forces that keep their direction, for a factor of 1, shape (node_count, 3) */
} load_data;

/* Memory for the values of the faces before they are added at the nodes. */
static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const load_data *load = effect->data;
  *scratch = ct_allocate(ct_facets_value_count(&load->facets, 3), sizeof(double));
  return *scratch != NULL ? CT_OK : CT_NO_MEMORY(error, "the effect load");
}

/* Nodal forces of one face: traction times area, and pressure against the area vector t1 x t2
 * (eq:load-force). */
static void face_force(const ct_facets *facets, const ct_face *face, const double traction[3],
                       double pressure, double *values)
{
  double area[25][3], J[25], terms[25];
  ct_facets_areas(facets, face, area, J);
  // -- Integrate N_a (t J - p y,1 x y,2) over the face (eq:load-force)
  for (int a = 0; a < facets->per; a++)
    for (int c = 0; c < 3; c++) {
      for (int q = 0; q < facets->rule.count; q++)
        terms[q] = facets->N[q][a] *
                   (facets->rule.weight[q] * (traction[c] * J[q] - pressure * area[q][c]));
      values[3 * a + c] = ct_sum(terms, facets->rule.count);
    }
}

/* Nodal forces of all faces at the positions x + u. */
static void all_faces(const ct_facets *facets, const double *x, const double *u,
                      const double traction[3], double pressure, double *values, double *force)
{
  for (int32_t f = 0; f < facets->face_count; f++) {
    ct_face face;
    ct_facets_face(facets, f, x, u, &face);
    face_force(facets, &face, traction, pressure, &values[3 * (int64_t)f * facets->per]);
  }
  ct_facets_sum(facets, 3, values, force);
}

static ct_status load_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  static const double none[3] = {0.0, 0.0, 0.0};
  const load_data *load = effect->data;
  double factor = ct_amplitude_value(&load->given.amplitude, view->time);
  (void)error;
  if (load->given.following && load->given.pressure != 0.0)
    all_faces(&load->facets, view->reference, view->displacement, none,
              factor * load->given.pressure, view->scratch, force);
  else memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  for (int64_t d = 0; d < 3 * (int64_t)effect->node_count; d++) force[d] += factor * load->dead[d];
  return CT_OK;
}

/* A pressure that follows the surface acts like a spring: the largest row of M⁻¹ |∂f/∂u|
 * (eq:load-bound). */
static ct_status load_omega2_bound(const ct_effect *effect, const ct_view *view,
                                   double *omega_squared, ct_error *error)
{
  const load_data *load = effect->data;
  const ct_facets *facets = &load->facets;
  double *values = view->scratch; // of each node of each face
  double largest = load->given.amplitude.count == 0 ? 1.0 : 0.0;
  (void)error;
  *omega_squared = 0.0;
  if (!load->given.following || load->given.pressure == 0.0) return CT_OK;
  for (int32_t i = 0; i < load->given.amplitude.count; i++)
    largest = fmax(largest, fabs(load->given.amplitude.value[i]));
  // -- Rows of |∂f/∂u| of each face
  for (int32_t f = 0; f < facets->face_count; f++) {
    ct_face face;
    double *row = &values[(int64_t)f * facets->per];
    memset(row, 0, (size_t)facets->per * sizeof *row);
    ct_facets_face(facets, f, view->reference, view->displacement, &face);
    for (int q = 0; q < facets->rule.count; q++) {
      double t1[3], t2[3], change = 0.0;
      ct_segment_tangents(&face, facets->rule.xi[q], t1, t2);
      double l1 = sqrt(ct_vector_dot(t1, t1)), l2 = sqrt(ct_vector_dot(t2, t2));
      for (int b = 0; b < facets->per; b++)
        change += fabs(facets->dN[q][b][0]) * l2 + fabs(facets->dN[q][b][1]) * l1;
      for (int a = 0; a < facets->per; a++)
        row[a] += facets->rule.weight[q] * fabs(facets->N[q][a]) * change; // (eq:load-bound)
    }
  }
  // -- The largest row over its mass
  for (int32_t i = 0; i < facets->node_count; i++) {
    double sum = 0.0;
    for (int32_t k = facets->incidence.first[i]; k < facets->incidence.first[i + 1]; k++)
      sum += values[facets->incidence.place[k]];
    *omega_squared = fmax(*omega_squared, fabs(load->given.pressure) * largest * sum /
                                              load->mass[facets->nodes[i]] * (1.0 + 1e-12));
  }
  return CT_OK;
}

/* Copy the amplitude and integrate the forces of constant direction. */
static ct_status prepare(load_data *load, const ct_problem *problem, ct_error *error)
{
  ct_load_def *given = &load->given;
  for (int c = 0; c < 3; c++)
    if (!isfinite(given->traction[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "load: traction %c is not finite", "xyz"[c]);
  if (!isfinite(given->pressure))
    return ct_fail(error, CT_INVALID, CT_NOWHERE, "load: the pressure must be finite, not %g",
                   given->pressure);
  ct_status status = ct_amplitude_copy(&load->pool, &given->amplitude, error);
  if (status == CT_OK)
    status = ct_facets_create(given->kind, given->face_count, given->faces, problem->node_count,
                              problem->reference, "load", &load->pool, &load->facets, error);
  if (status != CT_OK) return status;
  double *values = ct_allocate(ct_facets_value_count(&load->facets, 3), sizeof *values);
  load->dead = ct_pool_take(&load->pool, (size_t)load->facets.node_count, 3 * sizeof(double));
  load->pool.failed |= values == NULL;
  if (!load->pool.failed)
    all_faces(&load->facets, problem->reference, NULL, given->traction,
              given->following ? 0.0 : given->pressure, values, load->dead);
  ct_release(values);
  return load->pool.failed ? CT_NO_MEMORY(error, "the effect load") : CT_OK;
}

static const ct_effect_calls CALLS = {.force = load_force,
                                      .create_scratch = create_scratch,
                                      .free_scratch = ct_release,
                                      .free_data = ct_pool_free,
                                      .bounds = {.omega2 = load_omega2_bound},
                                      .pieces = {.cut = ct_piece_local}};

ct_load_def ct_load_def_default(void) { return (ct_load_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_load_create_effect(const ct_load_def *def, const ct_problem *problem,
                                ct_effect **effect, ct_error *error)
{
  ct_status status;
  load_data *data = ct_effect_begin(def, problem, effect, "load", sizeof *data, &status, error);
  if (data == NULL) return status;
  data->given = *def;
  data->mass = problem->mass;
  status = prepare(data, problem, error);
  int32_t count = data->facets.node_count;
  double points = def->following ? (double)def->face_count * data->facets.rule.count : 0.0;
  ct_effect filled = {.kind = CT_EFFECT_LOAD,
                      .label = "load",
                      .calls = &CALLS,
                      .data = data,
                      .nodes = data->facets.nodes,
                      .node_count = count,
                      .cost = {.flops = 6.0 * count + 130.0 * points, .bytes = 48.0 * count}};
  return ct_effect_finish(status, &filled, effect, error);
}
