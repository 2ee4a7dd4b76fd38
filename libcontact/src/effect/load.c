/* Tractions and pressures on faces. */
#include <libcontact/effect.h>
#include <libcontact/base.h>

#include "../step/effect_internal.h"
#include "amplitude.h"
#include "../base/error.h"
#include "../shape/facets.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

typedef struct load_data {
  ct_load_def given; /* the amplitude's arrays are ours */
  double *time, *value;
  ct_facets *facets;
  const double *mass; /* of the problem */
  double
      *dead; /* nodal forces that keep their direction, for a factor of 1, shape (node_count, 3) */
} load_data;

/* Values of the faces on their way to the nodes, and room for the sum at one. */
typedef struct load_scratch {
  double *values, *terms;
} load_scratch;

static void free_data(void *data)
{
  load_data *load = data;
  ct_release(load->time);
  ct_release(load->value);
  ct_release(load->dead);
  ct_facets_free(load->facets);
  ct_release(load);
}

static void free_scratch(void *scratch)
{
  load_scratch *s = scratch;
  ct_release(s->values);
  ct_release(s->terms);
  ct_release(s);
}

static load_scratch *new_scratch(const ct_facets *facets)
{
  load_scratch *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return NULL;
  s->values = ct_allocate((size_t)facets->face_count * (size_t)facets->per, 3 * sizeof(double));
  s->terms = ct_allocate((size_t)facets->incidence.most + 25, sizeof(double));
  if (s->values != NULL && s->terms != NULL) return s;
  free_scratch(s);
  return NULL;
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  *scratch = new_scratch(((const load_data *)effect->data)->facets);
  return *scratch != NULL ? CT_OK : ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "load: no memory");
}

/* Nodal forces of one face: traction times area, and pressure against the area vector t1 x t2
 * (eq:load-force). */
static void face_force(const ct_facets *facets, const ct_face *face, const double traction[3],
                       double pressure, double *values)
{
  double density[25][3], terms[25];
  for (int q = 0; q < facets->rule.count; q++) {
    double t1[3], t2[3], area[3];
    ct_segment_tangents(face, facets->rule.xi[q], t1, t2);
    ct_vector_cross(t1, t2, area);
    double J = sqrt(ct_vector_dot(area, area));
    for (int c = 0; c < 3; c++)
      density[q][c] = facets->rule.weight[q] * (traction[c] * J - pressure * area[c]);
  }
  for (int a = 0; a < facets->per; a++)
    for (int c = 0; c < 3; c++) {
      for (int q = 0; q < facets->rule.count; q++) terms[q] = facets->N[q][a] * density[q][c];
      values[3 * a + c] = ct_sum(terms, facets->rule.count);
    }
}

/* Nodal forces of all faces at the positions x + u. */
static void all_faces(const ct_facets *facets, const double *x, const double *u,
                      const double traction[3], double pressure, const load_scratch *s,
                      double *force)
{
  for (int32_t f = 0; f < facets->face_count; f++) {
    ct_face face;
    ct_facets_face(facets, f, x, u, &face);
    face_force(facets, &face, traction, pressure, &s->values[3 * (int64_t)f * facets->per]);
  }
  ct_facets_sum(facets, s->values, s->terms, force);
}

static ct_status load_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  static const double none[3] = {0.0, 0.0, 0.0};
  const load_data *load = effect->data;
  double factor = ct_amplitude_value(&load->given.amplitude, view->time);
  (void)error;
  if (load->given.following && load->given.pressure != 0.0)
    all_faces(load->facets, view->reference, view->displacement, none,
              factor * load->given.pressure, view->scratch, force);
  else memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  for (int64_t d = 0; d < 3 * (int64_t)effect->node_count; d++) force[d] += factor * load->dead[d];
  return CT_OK;
}

/* A pressure that follows is a spring of its own: the largest row of M⁻¹ |∂f/∂u| (eq:load-bound).
 */
static ct_status load_omega2_bound(const ct_effect *effect, const ct_view *view,
                                   double *omega_squared, ct_error *error)
{
  const load_data *load = effect->data;
  const ct_facets *facets = load->facets;
  const load_scratch *s = view->scratch;
  double largest = load->given.amplitude.count == 0 ? 1.0 : 0.0;
  (void)error;
  *omega_squared = 0.0;
  if (!load->given.following || load->given.pressure == 0.0) return CT_OK;
  for (int32_t i = 0; i < load->given.amplitude.count; i++)
    largest = fmax(largest, fabs(load->value[i]));
  for (int32_t f = 0; f < facets->face_count; f++) {
    ct_face face;
    double row[8] = {0.0};
    ct_facets_face(facets, f, view->reference, view->displacement, &face);
    for (int q = 0; q < facets->rule.count; q++) {
      double t1[3], t2[3], change = 0.0;
      ct_segment_tangents(&face, facets->rule.xi[q], t1, t2);
      double l1 = sqrt(ct_vector_dot(t1, t1)), l2 = sqrt(ct_vector_dot(t2, t2));
      for (int b = 0; b < facets->per; b++)
        change += fabs(facets->dN[q][b][0]) * l2 + fabs(facets->dN[q][b][1]) * l1;
      for (int a = 0; a < facets->per; a++)
        row[a] += facets->rule.weight[q] * fabs(facets->N[q][a]) * change;
    }
    for (int a = 0; a < facets->per; a++)
      for (int c = 0; c < 3; c++)
        s->values[3 * ((int64_t)f * facets->per + a) + c] = c == 0 ? row[a] : 0.0;
  }
  for (int32_t i = 0; i < facets->node_count; i++) {
    double sum = 0.0;
    for (int32_t k = facets->incidence.first[i]; k < facets->incidence.first[i + 1]; k++)
      sum += s->values[3 * (int64_t)facets->incidence.place[k]];
    *omega_squared = fmax(*omega_squared, fabs(load->given.pressure) * largest * sum /
                                              load->mass[facets->nodes[i]] * (1.0 + 1e-12));
  }
  return CT_OK;
}

static ct_status check_load(const ct_load_def *load, ct_error *error)
{
  for (int c = 0; c < 3; c++)
    if (!isfinite(load->traction[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "load: traction %c is not finite", "xyz"[c]);
  if (!isfinite(load->pressure))
    return ct_fail(error, CT_INVALID, CT_NOWHERE, "load: the pressure is not finite");
  return ct_amplitude_check(&load->amplitude, error);
}

/* Copy the amplitude and integrate what keeps its direction. */
static ct_status prepare(load_data *load, const ct_problem *problem)
{
  const ct_amplitude *amplitude = &load->given.amplitude;
  size_t count = (size_t)amplitude->count, nodes = (size_t)load->facets->node_count;
  load->time = ct_allocate(count, sizeof(double));
  load->value = ct_allocate(count, sizeof(double));
  load->dead = ct_allocate(nodes, 3 * sizeof(double));
  load_scratch *s = new_scratch(load->facets);
  ct_status status = load->time && load->value && load->dead && s ? CT_OK : CT_ERROR_MEMORY;
  if (status == CT_OK) {
    if (count > 0) memcpy(load->time, amplitude->time, count * sizeof(double));
    if (count > 0) memcpy(load->value, amplitude->value, count * sizeof(double));
    load->given.amplitude = (ct_amplitude){amplitude->count, load->time, load->value};
    all_faces(load->facets, problem->reference, NULL, load->given.traction,
              load->given.following ? 0.0 : load->given.pressure, s, load->dead);
  }
  if (s != NULL) free_scratch(s);
  return status;
}

ct_load_def ct_load_def_default(void) { return (ct_load_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_load_create_effect(const ct_load_def *def, const ct_problem *problem,
                                ct_effect **effect, ct_error *error)
{
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, effect, "load", error);
  if (status != CT_OK) return status;
  load_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "load: no memory");
  data->given = *def;
  data->mass = problem->mass;
  status = check_load(def, error);
  if (status == CT_OK)
    status = ct_facets_create(def->kind, def->face_count, def->faces, problem->node_count,
                              problem->reference, "load", &data->facets, error);
  if (status == CT_OK && prepare(data, problem) != CT_OK)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "load: no memory");
  if (status == CT_OK) {
    int32_t count = data->facets->node_count;
    double points = def->following ? (double)def->face_count * data->facets->rule.count : 0.0;
    ct_effect filled = {.kind = CT_EFFECT_LOAD,
                        .label = "load",
                        .data = data,
                        .nodes = data->facets->nodes,
                        .node_count = count,
                        .flops = 6.0 * count + 130.0 * points,
                        .bytes = 48.0 * count,
                        .create_scratch = create_scratch,
                        .free_scratch = free_scratch,
                        .force = load_force,
                        .omega2_bound = load_omega2_bound,
                        .free_data = free_data};
    status = ct_effect_copy(&filled, effect, error);
  }
  if (status != CT_OK) free_data(data);
  return status;
}
