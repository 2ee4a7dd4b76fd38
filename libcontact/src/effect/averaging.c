/* Averaged mass: accelerations that are averaged over neighbouring nodes. */
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../solid/kernel.h"
#include "../solid/modes.h"

#include <math.h>
#include <string.h>

/* Points of tangency for the stable step, as fractions of the largest γ d: near those of the modes
 * that change along one, two and three axes, 0.69, 0.92 and 1. */
static const double TANGENT = 0.8;

/* A body of equal bricks. */
typedef struct averaged_body {
  const ct_mesh *mesh;
  int32_t first_node, batch_count;
  double rate[3]; /* c₁ / h along x, y, z */
  double whole;   /* m / 64 */
  double *weight; /* the same of each element, 0 if it is excluded, shape (batch_count, 8) */
  ct_assembly *assembly;
} averaged_body;

typedef struct averaging_data {
  ct_pool pool;
  const ct_problem *problem;
  int32_t body_count;
  averaged_body *bodies;
  int32_t *nodes;
  int64_t value_count;
} averaging_data;

/* Of one state: element values, and three numbers per node of the effect. */
typedef struct averaging_scratch {
  ct_pool pool;
  double *values, *in, *out, *before, *after, *force;
} averaging_scratch;

static void free_data(void *data)
{
  averaging_data *d = data;
  for (int32_t i = 0; d != NULL && i < d->body_count; i++) ct_assembly_free(d->bodies[i].assembly);
  ct_pool_free(d);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const averaging_data *d = effect->data;
  averaging_scratch *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_NO_MEMORY(error, "the averaging");
  size_t dofs = 3 * (size_t)effect->node_count;
  double **arrays[] = {&s->in, &s->out, &s->before, &s->after, &s->force};
  for (int i = 0; i < 5; i++) *arrays[i] = ct_pool_take(&s->pool, dofs, sizeof(double));
  s->values = ct_pool_take(&s->pool, (size_t)d->value_count, sizeof(double));
  *scratch = s;
  if (!s->pool.failed) return CT_OK;
  ct_pool_free(s);
  *scratch = NULL;
  return CT_NO_MEMORY(error, "the averaging");
}

/* η d of each mode of an element at a step: (1 - 3^-n) times the mean of η = (1 - Co²) / 2 over the
 * n axes along which the mode changes. */
static void mode_shares(const averaged_body *body, double dt, double share[CT_MODES])
{
  double g[3];
  for (int c = 0; c < 3; c++) {
    double courant = body->rate[c] * dt;
    g[c] = courant < 1.0 ? 0.5 * (1.0 - courant * courant) : 0.0; // (eq:averaged-gamma)
  }
  share[CT_XI] = 2.0 / 3.0 * g[0]; // (eq:averaged-modes)
  share[CT_ETA] = 2.0 / 3.0 * g[1];
  share[CT_ZETA] = 2.0 / 3.0 * g[2];
  share[CT_XI_ETA] = 4.0 / 9.0 * (g[0] + g[1]);
  share[CT_ETA_ZETA] = 4.0 / 9.0 * (g[1] + g[2]);
  share[CT_ZETA_XI] = 4.0 / 9.0 * (g[2] + g[0]);
  share[CT_XI_ETA_ZETA] = 26.0 / 81.0 * ((g[0] + g[1]) + g[2]);
}

/* Values of all elements of one body, from three numbers per node of the body. */
CT_CLONES
static void body_batches(const averaged_body *body, const double share[CT_MODES], const double *in,
                         double *values)
{
  for (int32_t b = 0; b < body->batch_count; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes v[3 * 8], U[CT_MODES], weight;
      ct_load_lanes(body->mesh, NULL, b, 8, in, lane, v);
      memcpy(&weight, &body->weight[CT_BATCH * (int64_t)b + lane], sizeof weight);
      // -- η (M_L - M_C) of an element is diagonal in its modes
      for (int j = 0; j < 3; j++) {
        ct_brick_modes(&v[8 * j], U);
        // (eq:averaged-element)
        for (int m = 0; m < CT_MODES; m++) U[m] = -(weight * (share[m] * U[m]));
        ct_brick_nodal(U, v);
        ct_store_lanes(v, 8, j, lane, 8, &values[192 * (int64_t)b]);
      }
    }
}

/* out = η (M_L - M_C) in, both on the nodes of the effect. */
static void average(const averaging_data *d, double *values, const double *in, double *out)
{
  for (int32_t i = 0; i < d->body_count; i++) {
    const averaged_body *body = &d->bodies[i];
    double share[CT_MODES];
    mode_shares(body, d->problem->dt, share);
    body_batches(body, share, in, values);
    ct_assembly_fold(body->assembly, values);
    ct_assembly_gather(body->assembly, values, 0, body->mesh->node_count, out);
    values += body->assembly->value_count;
    in += 3 * (int64_t)body->mesh->node_count;
    out += 3 * (int64_t)body->mesh->node_count;
  }
}

static ct_status averaging_force(const ct_effect *effect, const ct_view *view, double *force,
                                 ct_error *error)
{
  const averaging_data *d = effect->data;
  const averaging_scratch *s = view->scratch;
  (void)error;
  // -- η (M_L - M_C) M_L⁻¹ f; fixed components do not accelerate (eq:averaging-force)
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int64_t c = 0, dof = 3 * (int64_t)d->nodes[i]; c < 3; c++)
      s->in[3 * (int64_t)i + c] = d->problem->inverse_mass[dof + c] * view->total[dof + c];
  average(d, s->values, s->in, force);
  memcpy(s->force, force, 3 * (size_t)effect->node_count * sizeof *force);
  return CT_OK;
}

/* y of (1 + M_L⁻¹ η (M_L - M_C)) y = v on the free components, and η (M_L - M_C) y in `out`
 * (eq:averaged-solve). */
static void solve(const ct_effect *effect, const averaging_scratch *s, const double *v)
{
  const averaging_data *d = effect->data;
  double q = effect->calls->bounds.amplification(effect, d->problem->dt) - 1.0,
         relax = 2.0 / (2.0 + q);
  // Each round reduces the error to q / (2 + q) < 1/5; after the last one it is negligible.
  int rounds = q > 0.0 ? 1 + (int)ceil(-38.0 / log(q / (2.0 + q))) : 0;
  memcpy(s->in, v, 3 * (size_t)effect->node_count * sizeof *v);
  for (int round = 0; round < rounds; round++) {
    average(d, s->values, s->in, s->out);
    for (int64_t k = 0; k < 3 * (int64_t)effect->node_count; k++) {
      double push = d->problem->inverse_mass[3 * (int64_t)d->nodes[k / 3] + k % 3] * s->out[k];
      s->in[k] += relax * ((v[k] - s->in[k]) - push); // (eq:averaged-solve)
    }
  }
  average(d, s->values, s->in, s->out);
}

static ct_status averaging_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                  ct_error *error)
{
  const averaging_data *d = effect->data;
  const averaging_scratch *s = view->scratch;
  (void)error;
  for (int64_t k = 0; k < 3 * (int64_t)effect->node_count; k++) {
    int64_t dof = 3 * (int64_t)d->nodes[k / 3] + k % 3;
    double inverse = d->problem->inverse_mass[dof], v = view->velocity[dof];
    s->before[k] = inverse > 0.0 ? v : 2.0 * v;
    s->after[k] = inverse > 0.0 ? v + view->c_dt * inverse * view->total[dof] : 0.0;
  }
  // -- ½ v_{n-1/2} · (P⁻¹ - M_L) v_{n+1/2}, and the work of moving supports
  solve(effect, s, s->after);
  for (int64_t k = 0; k < 3 * (int64_t)effect->node_count; k++)
    if (d->problem->inverse_mass[3 * (int64_t)d->nodes[k / 3] + k % 3] == 0.0)
      s->out[k] -= 0.5 * view->c_dt * s->force[k]; // (eq:averaged-support)
  // (eq:averaged-energy)
  *energy = -0.5 * ct_sum_product(effect->node_count, NULL, s->before, s->out);
  return CT_OK;
}

static double averaging_amplification(const ct_effect *effect, double dt)
{
  const averaging_data *d = effect->data;
  double most = 0.0, share[CT_MODES];
  for (int32_t i = 0; i < d->body_count; i++) {
    mode_shares(&d->bodies[i], dt, share);
    for (int m = 0; m < CT_MODES; m++) most = fmax(most, share[m]);
  }
  return 1.0 + most;
}

/* 4 (M - a M + b Γ) of a brick, where a M - b Γ is the tangent at g₀ of P⁻¹, a convex function of
 * M⁻¹Γ (eq:averaged-tangent). For an excluded element it is smaller. */
static void averaging_element(const ct_effect *effect, int32_t first_node, const double edge[3],
                              double dt, double *matrix)
{
  static const int AXES[CT_MODES][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0},
                                        {0, 1, 1}, {1, 0, 1}, {1, 1, 1}};
  const averaging_data *d = effect->data;
  (void)edge;
  for (int32_t k = 0; k < d->body_count; k++) {
    const averaged_body *body = &d->bodies[k];
    double share[CT_MODES], most = 0.0;
    if (body->first_node != first_node) continue;
    mode_shares(body, dt, share);
    for (int m = 0; m < CT_MODES; m++) most = fmax(most, share[m]);
    // -- The tangent in the modes, as a matrix of the nodes (eq:averaged-tangent)
    double at = TANGENT * most, b = 1.0 / ((1.0 + at) * (1.0 + at)), rest = at * at * b;
    for (int i = 0; i < 24; i++) {
      matrix[25 * i] += 4.0 * rest * 8.0 * body->whole;
      for (int j = i % 3; j < 24; j += 3)
        for (int m = 0; m < CT_MODES; m++) {
          double sign = 1.0;
          for (int c = 0; c < 3; c++)
            if (AXES[m][c]) sign *= ct_corner_sign(i / 3, c) * ct_corner_sign(j / 3, c);
          matrix[24 * i + j] += 4.0 * b * body->whole * share[m] * sign;
        }
    }
  }
}

/* Elements with a node that is excluded have no weight. */
static ct_status weigh(averaged_body *body, const ct_averaging_def *def, ct_error *error)
{
  const ct_mesh *mesh = body->mesh;
  char *apart = ct_allocate((size_t)mesh->node_count, 1);
  if (apart == NULL) return CT_NO_MEMORY(error, "the averaging");
  for (int32_t i = 0; i < def->apart_count; i++) {
    int32_t n = def->apart[i] - body->first_node;
    if (n >= 0 && n < mesh->node_count) apart[n] = 1;
  }
  for (int32_t e = 0; e < mesh->element_count; e++) {
    int alone = 0;
    for (int a = 0; a < 8; a++) alone |= apart[mesh->elements[8 * (size_t)e + (size_t)a]];
    body->weight[e] = alone ? 0.0 : body->whole;
  }
  ct_release(apart);
  return CT_OK;
}

static ct_status prepare_body(averaged_body *body, const ct_averaging_def *def, const ct_body *from,
                              ct_pool *pool, ct_error *error)
{
  double edge[3], c1, c2;
  ct_status status = ct_mesh_check(from->mesh, error);
  if (status != CT_OK) return status;
  if (!ct_brick_facts_of(from->mesh->kind)->trilinear || from->material.law != CT_LINEAR ||
      !ct_solid_is_box(from->mesh, edge))
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "averaging: body %s is not of linear hex8 elements that are equal bricks along "
                   "x, y, z",
                   from->name);
  body->mesh = from->mesh;
  body->first_node = from->first_node;
  ct_material_speeds(&from->material, &c1, &c2);
  for (int c = 0; c < 3; c++) body->rate[c] = c1 / edge[c];
  body->batch_count = (body->mesh->element_count + 7) / 8;
  body->weight = ct_pool_take(pool, CT_BATCH * (size_t)body->batch_count, sizeof(double));
  if (body->weight == NULL) return CT_NO_MEMORY(error, "the averaging");
  status = ct_assembly_create(body->mesh, 3, &body->assembly, error);
  if (status != CT_OK) return status;
  double mass = from->material.density * ((edge[0] * edge[1]) * edge[2]);
  body->whole = mass / 64.0;
  return weigh(body, def, error);
}

/* The bodies in the order of their nodes. */
static ct_status prepare(averaging_data *d, const ct_averaging_def *def, const ct_problem *problem,
                         int32_t *node_count, ct_error *error)
{
  d->problem = problem;
  if (def->apart_count < 0 || (def->apart_count > 0 && def->apart == NULL))
    return CT_REFUSE(error, "averaging: apart_count is %d, but apart is null",
                     (int)def->apart_count);
  d->bodies = ct_pool_take(&d->pool, (size_t)problem->body_count, sizeof *d->bodies);
  if (d->bodies == NULL) return CT_NO_MEMORY(error, "the averaging");
  ct_status status = ct_effect_body_nodes(problem, def->bodies, def->body_count, "averaging",
                                          &d->pool, &d->nodes, node_count, error);
  for (int32_t n = 0; status == CT_OK && n < *node_count;) {
    int32_t i = ct_effect_body_of(problem, d->nodes[n]);
    averaged_body *body = &d->bodies[d->body_count++];
    status = prepare_body(body, def, &problem->bodies[i], &d->pool, error);
    if (status != CT_OK && error != NULL) error->body = i;
    if (status != CT_OK) return status;
    d->value_count += body->assembly->value_count;
    n += body->mesh->node_count;
  }
  return status;
}

static const ct_effect_calls CALLS = {
    .force = averaging_force,
    .energy = averaging_energy,
    .create_scratch = create_scratch,
    .free_scratch = ct_pool_free,
    .free_data = free_data,
    .bounds = {.amplification = averaging_amplification, .add_element = averaging_element}};

ct_averaging_def ct_averaging_def_default(void)
{
  return (ct_averaging_def){.cookie = CT_DEF_COOKIE};
}

ct_status ct_averaging_create_effect(const ct_averaging_def *def, const ct_problem *problem,
                                     ct_effect **effect, ct_error *error)
{
  ct_status status;
  averaging_data *d = ct_effect_begin(def, problem, effect, "averaging", sizeof *d, &status, error);
  if (d == NULL) return status;
  ct_effect filled = {
      .kind = CT_EFFECT_AVERAGING, .label = "averaging", .calls = &CALLS, .data = d};
  status = prepare(d, def, problem, &filled.node_count, error);
  filled.nodes = d->nodes;
  for (int32_t i = 0; status == CT_OK && i < d->body_count; i++) {
    // Operations of the kernel, the sums at the nodes and the accelerations; bytes of node numbers,
    // of forces (written and read) and of nodes.
    const ct_mesh *mesh = d->bodies[i].mesh;
    filled.cost.flops += 210.0 * mesh->element_count + 24.0 * mesh->node_count;
    filled.cost.bytes += (32.0 + 8.0 + 384.0) * mesh->element_count + 128.0 * mesh->node_count;
  }
  return ct_effect_finish(status, &filled, effect, error);
}
