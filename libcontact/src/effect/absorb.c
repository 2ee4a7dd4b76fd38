/* A boundary that absorbs waves: dashpots on faces. */
#include <libcontact/effect.h>
#include <libcontact/base.h>

#include "../step/effect_internal.h"
#include "../base/error.h"
#include "../shape/facets.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>

typedef struct absorb_data {
  ct_facets *facets;
  double (*dashpot)[6]; /* of each node: xx yy zz xy yz zx of a symmetric matrix [mass / time] */
  double rate;
} absorb_data;

static void free_data(void *data)
{
  absorb_data *absorb = data;
  ct_facets_free(absorb->facets);
  ct_release(absorb->dashpot);
  ct_release(absorb);
}

static ct_status absorb_force(const ct_effect *effect, const ct_view *view, double *force,
                              ct_error *error)
{
  const absorb_data *absorb = effect->data;
  (void)error;
  for (int32_t i = 0; i < effect->node_count; i++) {
    const double *v = &view->velocity[3 * (int64_t)effect->nodes[i]], *C = absorb->dashpot[i];
    double *f = &force[3 * (int64_t)i];
    // -- Against the velocity half a step back (eq:absorb-force)
    f[0] = -((C[0] * v[0] + C[3] * v[1]) + C[5] * v[2]);
    f[1] = -((C[3] * v[0] + C[1] * v[1]) + C[4] * v[2]);
    f[2] = -((C[5] * v[0] + C[4] * v[1]) + C[2] * v[2]);
  }
  return CT_OK;
}

static ct_status absorb_rate(const ct_effect *effect, const ct_view *view, double *rate,
                             ct_error *error)
{
  (void)view, (void)error;
  *rate = ((const absorb_data *)effect->data)->rate;
  return CT_OK;
}

/* Dashpots of the nodes of one face, ρ c₂ A I + ρ (c₁ - c₂) ∫ n n dA, with a share of the face for
 * each node that is never negative (eq:absorb-share). */
static void face_dashpots(const ct_facets *facets, const ct_face *face, double normal,
                          double tangential, double (*C)[6])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  double n[25][3], dA[25], square[8], terms[25], all;
  for (int q = 0; q < facets->rule.count; q++) {
    double t1[3], t2[3];
    ct_segment_tangents(face, facets->rule.xi[q], t1, t2);
    ct_vector_cross(t1, t2, n[q]);
    double J = sqrt(ct_vector_dot(n[q], n[q]));
    for (int c = 0; c < 3; c++) n[q][c] /= J;
    dA[q] = facets->rule.weight[q] * J;
  }
  for (int a = 0; a < facets->per; a++) {
    for (int q = 0; q < facets->rule.count; q++)
      terms[q] = facets->N[q][a] * facets->N[q][a] * dA[q];
    square[a] = ct_sum(terms, facets->rule.count);
  }
  all = ct_sum(square, facets->per);
  for (int k = 0; k < 6; k++) {
    for (int q = 0; q < facets->rule.count; q++)
      terms[q] =
          ((normal - tangential) * (n[q][row[k]] * n[q][column[k]]) + (k < 3 ? tangential : 0.0)) *
          dA[q];
    double whole = ct_sum(terms, facets->rule.count);
    for (int a = 0; a < facets->per; a++) C[a][k] = square[a] / all * whole;
  }
}

/* Dashpots of all nodes, and the largest rate (eq:absorb-rate). */
static ct_status prepare(absorb_data *absorb, const ct_problem *problem,
                         const ct_material *material)
{
  const ct_facets *facets = absorb->facets;
  double c1, c2, (*C)[6] = ct_allocate((size_t)facets->face_count * (size_t)facets->per, sizeof *C);
  double *terms = ct_allocate((size_t)facets->incidence.most, sizeof *terms);
  absorb->dashpot = ct_allocate((size_t)facets->node_count, sizeof *absorb->dashpot);
  ct_status status = C && terms && absorb->dashpot ? CT_OK : CT_ERROR_MEMORY;
  ct_material_speeds(material, &c1, &c2);
  for (int32_t f = 0; status == CT_OK && f < facets->face_count; f++) {
    ct_face face;
    ct_facets_face(facets, f, problem->reference, NULL, &face);
    face_dashpots(facets, &face, material->density * c1, material->density * c2,
                  &C[(int64_t)f * facets->per]);
  }
  for (int32_t i = 0; status == CT_OK && i < facets->node_count; i++) {
    double *own = absorb->dashpot[i];
    for (int k = 0; k < 6; k++) {
      int32_t count = facets->incidence.first[i + 1] - facets->incidence.first[i];
      for (int32_t j = 0; j < count; j++)
        terms[j] = C[facets->incidence.place[facets->incidence.first[i] + j]][k];
      own[k] = ct_sum(terms, count);
    }
    // -- The largest row of a symmetric matrix is not below its largest eigenvalue (eq:absorb-rate)
    double x = own[0] + fabs(own[3]) + fabs(own[5]), y = own[1] + fabs(own[3]) + fabs(own[4]),
           z = own[2] + fabs(own[4]) + fabs(own[5]);
    absorb->rate = fmax(absorb->rate, fmax(x, fmax(y, z)) / problem->mass[facets->nodes[i]]);
  }
  ct_release(C);
  ct_release(terms);
  return status;
}

ct_absorb_def ct_absorb_def_default(void) { return (ct_absorb_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_absorb_create_effect(const ct_absorb_def *def, const ct_problem *problem,
                                  ct_effect **effect, ct_error *error)
{
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, effect, "absorb", error);
  if (status != CT_OK) return status;
  absorb_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "absorb: no memory");
  status = ct_facets_create(def->kind, def->face_count, def->faces, problem->node_count,
                            problem->reference, "absorb", &data->facets, error);
  int32_t body = 0;
  if (status == CT_OK) {
    const ct_facets *facets = data->facets;
    body = ct_effect_body_of(problem, facets->nodes[0]);
    if (ct_effect_body_of(problem, facets->nodes[facets->node_count - 1]) != body)
      status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                       "absorb: the faces belong to several bodies; give each body its own");
  }
  if (status == CT_OK && prepare(data, problem, &problem->bodies[body].material) != CT_OK)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "absorb: no memory");
  if (status == CT_OK) {
    int32_t count = data->facets->node_count;
    ct_effect filled = {.kind = CT_EFFECT_ABSORB,
                        .label = "absorb",
                        .data = data,
                        .nodes = data->facets->nodes,
                        .node_count = count,
                        .flops = 18.0 * count,
                        .bytes = 96.0 * count,
                        .force = absorb_force,
                        .rate_bound = absorb_rate,
                        .free_data = free_data};
    status = ct_effect_copy(&filled, effect, error);
  }
  if (status != CT_OK) free_data(data);
  return status;
}
