/* Sleeping elements: why they have no force, how far a front has come, and an error on the way.
 * That they change no value is tested with random scenes: test_optimisations_fuzz.c. */
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* Forms of elements. */
typedef struct form {
  const char *name;
  ct_brick_kind kind;
  ct_solid_kernel kernel;
  ct_law law;
  double distort; /* of the nodes, in edges */
} form;

static const form FORMS[] = {
    {.name = "box"},
    {.name = "general kernel", .kernel = CT_KERNEL_GENERAL},
    {.name = "reduced kernel", .kernel = CT_KERNEL_REDUCED},
    {.name = "distorted", .distort = 0.1},
    {.name = "hex20", .kind = CT_HEX20},
    {.name = "hex20, distorted", .kind = CT_HEX20, .distort = 0.02},
    {.name = "St. Venant-Kirchhoff", .law = CT_ST_VENANT_KIRCHHOFF},
    {.name = "neo-Hookean", .law = CT_NEO_HOOKEAN, .distort = 0.1},
    {.name = "neo-Hookean hex20", .kind = CT_HEX20, .law = CT_NEO_HOOKEAN},
};
enum { FORM_COUNT = sizeof FORMS / sizeof *FORMS, TRIALS = 30 };

static double fail_at = INFINITY;

static ct_status failing_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  (void)effect, (void)error;
  for (int i = 0; i < 3; i++) force[i] = 0.0;
  return view->time >= fail_at ? CT_ERROR_UNSUPPORTED : CT_OK;
}

/* If an effect fails during a call, all nodes have the displacement of the last whole step. */
static void failure(void)
{
  ct_error e;
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 2, 0.2, 0.2, 20, 2, 2);
  ct_scene *scene = new_scene();
  static const ct_effect_calls calls = {.force = failing_force};
  int32_t node = 7;
  int right = 0;
  add_body(scene, "bar", m, &STEEL, CT_KERNEL_AUTO, 1000, 0, 0);
  add_effect(scene,
             &(ct_effect){.label = "fails", .nodes = &node, .node_count = 1, .calls = &calls});
  const ct_problem *problem = build_until(scene, 1e-5, 0.9);
  for (int k = 1; k < 6; k++) {
    fail_at = INFINITY;
    ct_state *state = new_state(problem);
    fail_at = (k - 0.5) * problem->dt;
    ct_status status = ct_run(problem, state, 10, NULL, 0, &e);
    double u = 0.0, off = 0.0;
    for (int i = 0; i < k; i++) u += problem->dt * 1000.0;
    for (int32_t n = 0; n < problem->node_count; n++)
      off = worst(off, fabs(state->displacement[3 * n] - u));
    right += status == CT_ERROR_UNSUPPORTED && state->step == k && off == 0.0 &&
             state->element_updates[0] == 0;
  }
  tap_ok(right == 5, "a flight ends with an error: all nodes are at their last positions, %d of 5",
         right);
}

static ct_status pull_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  (void)view, (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++) force[i] = i % 3 ? 0.0 : 1e-3;
  return CT_OK;
}

/* An end of a bar of 64 x 2 x 2 elements is pulled: after k steps the front has passed k elements
 * of each of the four rows, and batches have eight of them, so 32 ceil(k / 8) are computed. */
static void front(ct_solid_kernel kernel)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 6.4, 0.2, 0.2, 64, 2, 2);
  ct_scene *scene = new_scene();
  static const ct_effect_calls calls = {.force = pull_force};
  int32_t nodes[9];
  int64_t all, expected = 0;
  int right = 0;
  ct_mesh_plane_nodes(m, 0, 0.0, nodes);
  add_body(scene, "bar", m, &STEEL, kernel, 0, 0, 0);
  add_effect(scene,
             &(ct_effect){.label = "pull", .nodes = nodes, .node_count = 9, .calls = &calls});
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1e-5, .fraction = 0.9}, &all, NULL);
  for (int k = 1; k < 40; k++) {
    ct_state *state = new_state(problem);
    advance(problem, state, k);
    right +=
        state->element_updates[0] == expected && state->element_updates[1] == 256 * k - expected;
    expected += 32 * ((k + 7) / 8);
  }
  tap_ok(right == 39, "kernel %d: the front passes one element per step, %d of 39 series",
         (int)kernel, right);
}

/* Elements whose nodes all have one displacement have no force: the basis of sleeping. */
static void no_force(const form *f)
{
  ct_mesh *m = box_mesh(f->kind, -1.3, 0.7, 0.1, 1.1, 0.9, 1.7, 3, 3, 3);
  ct_optimisations none = {0, 0, 0};
  ct_solid_body block = {.mesh = m, .material = STEEL, .kernel = f->kernel, .optimisations = &none};
  ct_effect *effect;
  void *scratch;
  int64_t zeros = 0, dofs = 3 * (int64_t)m->node_count;
  double *u = numbers(dofs), *force = numbers(dofs);
  block.material.law = f->law;
  if (f->distort > 0.0) shake(m, 0.3 * f->distort, 0);
  must(create_solid, &block, 1, &effect);
  must(effect->calls->create_scratch, effect, &scratch);
  for (int trial = 0; trial < TRIALS; trial++) {
    double shift[3];
    for (int c = 0; c < 3; c++) shift[c] = uniform(1.0) * pow(10.0, uniform(12.0));
    for (int64_t d = 0; d < dofs; d++) u[d] = shift[d % 3], force[d] = 1.0;
    ct_view view = {.displacement = u, .scratch = scratch};
    must(effect->calls->force, effect, &view, force);
    for (int64_t d = 0; d < dofs; d++) zeros += force[d] == 0.0;
  }
  tap_ok(zeros == TRIALS * dofs, "%s: no force in %d translations", f->name, TRIALS);
  effect->calls->free_scratch(scratch);
  ct_effect_free(effect);
}

int main(void)
{
  free_at_end();
  for (int i = 0; i < FORM_COUNT; i++) no_force(&FORMS[i]);
  front(CT_KERNEL_BOX);
  front(CT_KERNEL_GENERAL);
  failure();
  return tap_done();
}
