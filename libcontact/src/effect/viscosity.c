/* Bulk viscosity of hex8 elements. */
#include <libcontact/mesh.h>
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../solid/call.h"
#include "../solid/element.h"
#include "../solid/mean.h"
#include "../solid/part.h"

#include <math.h>
#include <string.h>

/* Constant data of the 8 elements of a batch: b[j][m] = ∂V/∂X_jm, 1 / V, and the length l. */
typedef struct viscous_lanes {
  ct_lanes b[3][CT_MEAN_MODES], inverse_volume, length;
} viscous_lanes;

typedef struct ct_viscous_body {
  const ct_mesh *mesh; /* the user's */
  double density, c1, linear, quadratic;
  viscous_lanes *lanes; /* in the order of the part */
  double most;          /* largest l / V Σ b² / m over the elements, for the bound on the step */
} viscous_body;

/* The quadratic part is limited to the slope of a linear part with this coefficient
 * (eq:bulk-viscosity). */
static const double STEEPEST = 0.06;

typedef struct viscous_data {
  ct_pool pool;
  double linear, quadratic;
  int32_t body_count;
  viscous_body *bodies;
  ct_solid_part *parts; /* the bodies as parts whose displacements are velocities */
  int32_t *nodes;
  int64_t value_count, ring_stride;
} viscous_data;

/* Operations of the kernel for one element. */
static const double FLOPS = 249.0;

static void free_data(void *data)
{
  viscous_data *d = data;
  for (int32_t i = 0; d != NULL && i < d->body_count; i++) ct_part_release(&d->parts[i]);
  ct_pool_free(d);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  *scratch = ct_allocate((size_t)((const viscous_data *)effect->data)->value_count, sizeof(double));
  return *scratch != NULL ? CT_OK : CT_NO_MEMORY(error, "the viscous forces");
}

/* l = √(3/2) / g from the mean gradients per volume; the edge of a cube (eq:element-length). */
static double length_of(double g2) { return sqrt(1.5 / g2); }

/* Forces of the batches first ... last - 1 of a body. */
CT_CLONES
static void viscous_batches(const ct_solid_part *part, int32_t first, int32_t last,
                            const double *velocity, double *values)
{
  const viscous_body *body = part->viscous;
  double slow = body->density * body->linear * body->c1,
         fast = body->density * body->quadratic * body->quadratic,
         steep = body->density * STEEPEST * body->c1,
         knee = body->quadratic > 0.0 ? 0.5 * steep / fast : INFINITY;
  for (int32_t b = first; b < last; b++) {
    int64_t stride;
    double *out = ct_batch_values(part->ring, 8, values, b, &stride);
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      const viscous_lanes *e = &body->lanes[(b * CT_BATCH + lane) / CT_LANES_COUNT];
      ct_lanes v[3 * 8], U[CT_MODES], D[3], F[CT_MODES], q, low;
      double speed[CT_LANES_COUNT], below[CT_LANES_COUNT];
      ct_load_lanes(part->mesh, part->rows, b, 8, velocity, lane, v);
      // -- The closing speed l D of the rate at which the volume changes
      for (int j = 0; j < 3; j++) {
        ct_brick_modes(&v[8 * j], U);
        ct_mean_sum(e->b[j], U, &D[j]);
      }
      // (eq:volume-rate)
      q = ((D[0] + D[1]) + D[2]) * (e->length * e->inverse_volume);
      // -- A pressure against compression only
      memcpy(speed, &q, sizeof speed);
      for (int l = 0; l < CT_LANES_COUNT; l++) {
        speed[l] = speed[l] < 0.0 ? -speed[l] : 0.0;
        below[l] = speed[l] < knee ? speed[l] : knee;
      }
      memcpy(&q, speed, sizeof speed);
      memcpy(&low, below, sizeof below);
      q = slow * q + (fast * low * low + steep * (q - low)); // (eq:bulk-viscosity)
      // -- Nodal forces of the pressure (eq:viscous-force)
      for (int j = 0; j < 3; j++) {
        for (int m = 0; m < CT_MEAN_MODES; m++) F[m] = -(q * e->b[j][m]);
        F[CT_XI_ETA_ZETA] = q - q;
        ct_brick_nodal(F, v);
        ct_store_lanes(v, 8, j, lane, stride, out);
      }
    }
  }
}

static ct_status viscous_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const viscous_data *d = effect->data;
  double *values = view->scratch;
  (void)error;
  for (int32_t i = 0; i < d->body_count; i++) {
    const ct_solid_part *part = &d->parts[i];
    const int64_t flops = (int64_t)FLOPS * part->mesh->element_count;
    ct_part_call call = ct_part_task(part, view->velocity + 3 * (int64_t)part->first_node, values,
                                     d->ring_stride, force);
    ct_part_forces(&call, 1, ct_threads_for(ct_threads_of(view->settings), flops, CT_LEAST_FLOPS));
    force += 3 * (int64_t)part->mesh->node_count;
  }
  return CT_OK;
}

/* Q with the steepest slope of the law. */
static double coefficient_of(const viscous_data *d)
{
  return d->linear + (d->quadratic > 0.0 ? STEEPEST : 0.0);
}

/* Bound of the slope of M⁻¹f over all motions (eq:viscous-bound). */
static ct_status viscous_damping(const ct_effect *effect, const ct_view *view, double *rate,
                                 ct_error *error)
{
  const viscous_data *d = effect->data;
  double coefficient = coefficient_of(d);
  (void)view, (void)error;
  *rate = 0.0;
  for (int32_t i = 0; i < d->body_count; i++) {
    const viscous_body *body = &d->bodies[i];
    *rate = fmax(*rate, body->density * body->c1 * coefficient * body->most);
  }
  return CT_OK;
}

/* 2 Δt C of a brick, C = ρ l c₁ Q V B Bᵀ with the steepest slope. */
static void viscous_element(const ct_effect *effect, int32_t first_node, const double edge[3],
                            double dt, double *matrix)
{
  const viscous_data *d = effect->data;
  double B[24], volume = (edge[0] * edge[1]) * edge[2], g2 = 0.0;
  for (int i = 0; i < 24; i++) {
    B[i] = 0.25 * ct_corner_sign(i / 3, i % 3) / edge[i % 3];
    g2 += B[i] * B[i];
  }
  for (int32_t k = 0; k < d->body_count; k++) {
    const viscous_body *body = &d->bodies[k];
    if (d->parts[k].first_node != first_node) continue;
    // (eq:joint-bound)
    double most = 2.0 * dt * body->density * body->c1 * coefficient_of(d) * length_of(g2) * volume;
    for (int i = 0; i < 24; i++)
      for (int j = 0; j < 24; j++) matrix[24 * i + j] += most * B[i] * B[j];
  }
}

/* Largest l / V Σ b² / m, where each element has a fraction of its nodes' masses: its volume over
 * that of all elements at the node (eq:viscous-bound). */
static ct_status bound_body(viscous_body *body, const double *mass, ct_error *error)
{
  const ct_mesh *mesh = body->mesh;
  double *around = ct_allocate((size_t)mesh->node_count, sizeof *around), B[20][3], x[20][3], V, g2;
  if (around == NULL) return CT_NO_MEMORY(error, "the viscosity");
  ct_status status = CT_OK;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t e = 0; status == CT_OK && e < mesh->element_count; e++) {
      const int32_t *node = &mesh->elements[8 * (size_t)e];
      double sum = 0.0;
      ct_solid_load_element(mesh, e, mesh->nodes, x);
      status = ct_element_mean_gradients(&x[0][0], B, &V, &g2, error);
      for (int a = 0; status == CT_OK && a < 8; a++) {
        if (pass == 0) around[node[a]] += V;
        if (pass == 1)
          // (eq:viscous-bound)
          sum += (B[a][0] * B[a][0] + B[a][1] * B[a][1] + B[a][2] * B[a][2]) *
                 (around[node[a]] / mass[node[a]]);
      }
      // The volumes cancel: V² from b = V B, 1 / V from the force, 1 / V from the mass.
      if (status == CT_OK && pass == 1) body->most = fmax(body->most, length_of(g2) * sum);
    }
  ct_release(around);
  return status;
}

CT_CLONES_RARE
static void lay_down(const ct_solid_part *part, viscous_lanes *lanes)
{
  for (int32_t b = 0; b < part->batch_count; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      viscous_lanes *e = &lanes[(b * CT_BATCH + lane) / CT_LANES_COUNT];
      ct_lanes x[3 * 8], X[3][CT_MODES], V, g[3];
      double length[CT_LANES_COUNT];
      ct_load_lanes(part->mesh, part->rows, b, 8, part->mesh->nodes, lane, x);
      for (int j = 0; j < 3; j++) ct_brick_modes(&x[8 * j], X[j]);
      ct_mean_gradient(X, e->b, &V);
      e->inverse_volume = 1.0 / V;
      for (int j = 0; j < 3; j++) ct_mean_sum(e->b[j], e->b[j], &g[j]);
      g[0] = (8.0 * ((g[0] + g[1]) + g[2])) * (e->inverse_volume * e->inverse_volume);
      memcpy(length, &g[0], sizeof length);
      for (int l = 0; l < CT_LANES_COUNT; l++) length[l] = length_of(length[l]);
      memcpy(&e->length, length, sizeof length);
    }
}

static ct_status prepare_body(viscous_data *d, const ct_body *from, const double *mass,
                              ct_error *error)
{
  double c2;
  const ct_brick_facts *facts = ct_brick_facts_of(from->mesh->kind);
  viscous_body *body = &d->bodies[d->body_count];
  ct_solid_part *part = &d->parts[d->body_count++];
  if (!facts->trilinear)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "viscosity: body %s has elements %s; bulk viscosity is for hex8 only",
                   from->name, facts->name);
  if (from->materials != NULL)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "viscosity: body %s has several materials; bulk viscosity needs one",
                   from->name);
  // The rate of the volume is that of the reference shape: there a
  // rotation by a finite angle seems to be a compression.
  if (from->material.law != CT_LINEAR)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "viscosity: body %s has a law for large strain; bulk viscosity is for small "
                   "strain and rotation",
                   from->name);
  *body = (viscous_body){.mesh = from->mesh,
                         .density = from->material.density,
                         .linear = d->linear,
                         .quadratic = d->quadratic};
  ct_material_speeds(&from->material, &body->c1, &c2);
  *part = (ct_solid_part){.mesh = from->mesh,
                          .first_node = from->first_node,
                          .batches = viscous_batches,
                          .viscous = body};
  ct_status status = ct_mesh_check(body->mesh, error);
  if (status == CT_OK) status = ct_part_lay_out(part, error);
  if (status != CT_OK) return status;
  body->lanes = ct_pool_take(&d->pool, (size_t)part->batch_count * (CT_BATCH / CT_LANES_COUNT),
                             sizeof *body->lanes);
  if (body->lanes == NULL) return CT_NO_MEMORY(error, "the viscosity");
  lay_down(part, body->lanes);
  return bound_body(body, mass + part->first_node, error);
}

static ct_status check(const ct_viscosity_def *options, ct_error *error)
{
  const double coefficient[2] = {options->linear, options->quadratic};
  for (int i = 0; i < 2; i++)
    if (!(coefficient[i] >= 0.0) || !isfinite(coefficient[i]))
      return CT_REFUSE(error, "viscosity: %s must be 0 or positive and finite, not %g",
                       i == 0 ? "linear" : "quadratic", coefficient[i]);
  if (coefficient[0] == 0.0 && coefficient[1] == 0.0)
    return CT_REFUSE(error, "viscosity: linear and quadratic are both 0; one must be positive");
  for (int32_t i = 0; options->bodies != NULL && i < options->body_count; i++)
    for (int32_t k = 0; k < i; k++)
      if (options->bodies[k] == options->bodies[i])
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){options->bodies[i], -1, -1},
                       "viscosity: body %d is named twice", (int)options->bodies[i]);
  return CT_OK;
}

/* The bodies in the order of their nodes. */
static ct_status prepare(viscous_data *d, const ct_viscosity_def *options,
                         const ct_problem *problem, int32_t *node_count, ct_error *error)
{
  d->linear = options->linear;
  d->quadratic = options->quadratic;
  d->bodies = ct_pool_take(&d->pool, (size_t)problem->body_count, sizeof *d->bodies);
  d->parts = ct_pool_take(&d->pool, (size_t)problem->body_count, sizeof *d->parts);
  if (d->bodies == NULL || d->parts == NULL) return CT_NO_MEMORY(error, "the viscosity");
  ct_status status = ct_effect_body_nodes(problem, options->bodies, options->body_count,
                                          "viscosity", &d->pool, &d->nodes, node_count, error);
  for (int32_t n = 0; status == CT_OK && n < *node_count;) {
    int32_t i = ct_effect_body_of(problem, d->nodes[n]);
    status = prepare_body(d, &problem->bodies[i], problem->mass, error);
    if (status != CT_OK && error != NULL) error->body = i;
    n += problem->bodies[i].mesh->node_count;
  }
  d->value_count = ct_parts_place(d->parts, d->body_count, &d->ring_stride);
  return status;
}

static const ct_effect_calls CALLS = {
    .force = viscous_force,
    .create_scratch = create_scratch,
    .free_scratch = ct_release,
    .free_data = free_data,
    .bounds = {.rate = viscous_damping, .add_element = viscous_element},
    .pieces = {.cut = ct_piece_local}};

ct_viscosity_def ct_viscosity_def_default(void)
{
  return (ct_viscosity_def){.cookie = CT_DEF_COOKIE};
}

ct_status ct_viscosity_create_effect(const ct_viscosity_def *def, const ct_problem *problem,
                                     ct_effect **effect, ct_error *error)
{
  ct_status status;
  viscous_data *d = ct_effect_begin(def, problem, effect, "viscosity", sizeof *d, &status, error);
  if (d == NULL) return status;
  ct_effect filled = {
      .kind = CT_EFFECT_VISCOSITY, .label = "viscosity", .calls = &CALLS, .data = d};
  status = check(def, error);
  if (status == CT_OK) status = prepare(d, def, problem, &filled.node_count, error);
  filled.nodes = d->nodes;
  for (int32_t i = 0; status == CT_OK && i < d->body_count; i++) {
    // Operations counted in the kernel and the sums at the nodes; bytes of node numbers, of
    // constant data, without a ring of forces (written and read), and of nodes.
    const ct_solid_part *part = &d->parts[i];
    double forces = part->ring != NULL ? 0.0 : 384.0;
    filled.cost.flops += FLOPS * part->mesh->element_count + 21.0 * part->mesh->node_count;
    filled.cost.bytes +=
        (32.0 + 160.0 + forces) * part->mesh->element_count + 80.0 * part->mesh->node_count;
  }
  return ct_effect_finish(status, &filled, effect, error);
}
