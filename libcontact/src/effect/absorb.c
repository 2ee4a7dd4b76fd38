/* A boundary that absorbs waves: dashpots on faces. */
#include <libcontact/effect.h>
#include <libcontact/base.h>

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/error.h"
#include "../shape/facets.h"
#include "../base/memory.h"
#include "../mesh/mesh_internal.h"

#include <math.h>

typedef struct absorb_data {
  ct_pool pool;
  ct_facets facets;
  double (*dashpot)[6]; /* of each node: xx yy zz xy yz zx of a symmetric matrix [mass / time] */
  double rate;
} absorb_data;

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

/* Dashpots of the nodes of one face, ρ c₂ A I + ρ (c₁ - c₂) ∫ n n dA, distributed to its nodes with
 * fractions that are never negative (eq:absorb-share). */
static void face_dashpots(const ct_facets *facets, const ct_face *face, double normal,
                          double tangential, double *C)
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  double n[25][3], dA[25], square[8], terms[25], all;
  ct_facets_areas(facets, face, n, dA);
  // -- Share of each node: ∫ N_a² dA over the sum of all
  for (int q = 0; q < facets->rule.count; q++) {
    for (int c = 0; c < 3; c++) n[q][c] /= dA[q];
    dA[q] *= facets->rule.weight[q];
  }
  for (int a = 0; a < facets->per; a++) {
    for (int q = 0; q < facets->rule.count; q++)
      terms[q] = facets->N[q][a] * facets->N[q][a] * dA[q];
    square[a] = ct_sum(terms, facets->rule.count);
  }
  all = ct_sum(square, facets->per);
  // -- ρ c₂ A I + ρ (c₁ - c₂) ∫ n n dA, times this share (eq:absorb-traction, eq:absorb-force)
  for (int k = 0; k < 6; k++) {
    for (int q = 0; q < facets->rule.count; q++)
      terms[q] =
          ((normal - tangential) * (n[q][row[k]] * n[q][column[k]]) + (k < 3 ? tangential : 0.0)) *
          dA[q];
    double whole = ct_sum(terms, facets->rule.count);
    // (eq:absorb-share)
    for (int a = 0; a < facets->per; a++) C[6 * a + k] = square[a] / all * whole;
  }
}

/* The elements behind the faces, if the body has several materials; else `owner` stays null. */
static ct_status find_owners(const ct_facets *facets, const ct_body *body, int32_t **owner,
                             ct_error *error)
{
  if (body->materials == NULL) return CT_OK;
  const size_t entries = (size_t)facets->face_count * (size_t)facets->per;
  int32_t *own = ct_allocate(entries, sizeof *own);
  *owner = ct_allocate((size_t)facets->face_count, sizeof **owner);
  ct_status status =
      own != NULL && *owner != NULL ? CT_OK : CT_NO_MEMORY(error, "the effect absorb");
  for (size_t i = 0; status == CT_OK && i < entries; i++)
    own[i] = facets->faces[i] - body->first_node;
  if (status == CT_OK)
    status = ct_mesh_face_owners(body->mesh, facets->face_count, own, *owner, error);
  for (int32_t f = 0; status == CT_OK && f < facets->face_count; f++)
    if ((*owner)[f] < 0)
      status = CT_REFUSE(error, "absorb: face %d is no face of an element of body %s", (int)f,
                         body->name);
  ct_release(own);
  return status;
}

/* Dashpots of all nodes, and the largest rate (eq:absorb-rate). */
static ct_status prepare(absorb_data *absorb, const ct_problem *problem, ct_error *error)
{
  const ct_facets *facets = &absorb->facets;
  int32_t body = ct_effect_body_of(problem, facets->nodes[0]);
  if (ct_effect_body_of(problem, facets->nodes[facets->node_count - 1]) != body)
    return CT_REFUSE(error, "absorb: the faces belong to several bodies; give each body its own");
  double c1, c2, *C = ct_allocate(ct_facets_value_count(facets, 6), sizeof *C);
  int32_t *owner = NULL;
  ct_status status = find_owners(facets, &problem->bodies[body], &owner, error);
  absorb->dashpot =
      ct_pool_take(&absorb->pool, (size_t)facets->node_count, sizeof *absorb->dashpot);
  absorb->pool.failed |= C == NULL || status != CT_OK;
  for (int32_t f = 0; !absorb->pool.failed && f < facets->face_count; f++) {
    ct_face face;
    const ct_material *material =
        ct_body_material(&problem->bodies[body], owner != NULL ? owner[f] : 0);
    ct_material_speeds(material, &c1, &c2);
    ct_facets_face(facets, f, problem->reference, NULL, &face);
    face_dashpots(facets, &face, material->density * c1, material->density * c2,
                  &C[6 * (int64_t)f * facets->per]);
  }
  if (!absorb->pool.failed) ct_facets_sum(facets, 6, C, &absorb->dashpot[0][0]);
  for (int32_t i = 0; !absorb->pool.failed && i < facets->node_count; i++) {
    const double *own = absorb->dashpot[i];
    // -- The largest row of a symmetric matrix is not below its largest eigenvalue (eq:absorb-rate)
    double x = own[0] + fabs(own[3]) + fabs(own[5]), y = own[1] + fabs(own[3]) + fabs(own[4]),
           z = own[2] + fabs(own[4]) + fabs(own[5]);
    absorb->rate = fmax(absorb->rate, fmax(x, fmax(y, z)) / problem->mass[facets->nodes[i]]);
  }
  ct_release(C);
  ct_release(owner);
  if (status != CT_OK) return status;
  return absorb->pool.failed ? CT_NO_MEMORY(error, "the effect absorb") : CT_OK;
}

static const ct_effect_calls CALLS = {.force = absorb_force,
                                      .free_data = ct_pool_free,
                                      .bounds = {.rate = absorb_rate},
                                      .pieces = {.cut = ct_piece_local}};

ct_absorb_def ct_absorb_def_default(void) { return (ct_absorb_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_absorb_create_effect(const ct_absorb_def *def, const ct_problem *problem,
                                  ct_effect **effect, ct_error *error)
{
  ct_status status;
  absorb_data *data = ct_effect_begin(def, problem, effect, "absorb", sizeof *data, &status, error);
  if (data == NULL) return status;
  status = ct_facets_create(def->kind, def->face_count, def->faces, problem->node_count,
                            problem->reference, "absorb", &data->pool, &data->facets, error);
  if (status == CT_OK) status = prepare(data, problem, error);
  int32_t count = data->facets.node_count;
  ct_effect filled = {.kind = CT_EFFECT_ABSORB,
                      .label = "absorb",
                      .calls = &CALLS,
                      .data = data,
                      .nodes = data->facets.nodes,
                      .node_count = count,
                      .cost = {.flops = 18.0 * count, .bytes = 96.0 * count}};
  return ct_effect_finish(status, &filled, effect, error);
}
