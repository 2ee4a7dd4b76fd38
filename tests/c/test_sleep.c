/* Sleeping elements change no value: runs with and without sleeping side by side, split, copied and
 * changed by a host in between, with any number of threads. test_sleep_random.c does the same with
 * random scenes. */
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* Two bars of 23 elements that meet end to end, in many forms. */
typedef struct form {
  const char *name;
  ct_brick_kind kind;
  ct_solid_kernel kernel;
  ct_law law;
  ct_scheme scheme;
  ct_enforcement enforcement;
  double distort; /* of the nodes inside, in edges */
  int turned;     /* elements with axes along any edge: octants are no lattice */
  double v[2];    /* velocities along x */
  double gap;     /* in edges */
  double held;    /* velocity of a support at the far end */
  int pushed;     /* a host's effect: on no node, on few, on few but later, on all */
  int along;      /* which axis */
} form;

static const form FORMS[] = {
    {.name = "bars that fly together", .v = {1000, -1000}},
    {.name = "a bar at rest", .v = {1000, 0}, .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
    {.name = "to the left", .v = {0, -1000}, .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
    {.name = "general kernel", .kernel = CT_KERNEL_GENERAL, .v = {1000, -1000}},
    {.name = "reduced kernel", .kernel = CT_KERNEL_REDUCED, .v = {1000, 0}},
    {.name = "distorted", .distort = 0.1, .v = {1000, -700}, .held = 300.0},
    {.name = "rotated elements", .turned = 1, .v = {1000, -1000}},
    {.name = "hex20", .kind = CT_HEX20, .v = {1000, -1000}},
    {.name = "hex20, distorted", .kind = CT_HEX20, .distort = 0.02, .v = {1000, 0}},
    {.name = "St. Venant-Kirchhoff", .law = CT_ST_VENANT_KIRCHHOFF, .v = {1000, -1000}},
    {.name = "neo-Hookean", .law = CT_NEO_HOOKEAN, .distort = 0.1, .v = {1000, 0}},
    {.name = "neo-Hookean hex20", .kind = CT_HEX20, .law = CT_NEO_HOOKEAN, .v = {1000, 0}},
    {.name = "a push", .gap = 1.0, .pushed = 1},
    {.name = "a force along y", .gap = 1.0, .pushed = 1, .along = 1},
    {.name = "a push later", .gap = 1.0, .pushed = 2, .along = 2},
    {.name = "a force on all nodes", .v = {0, -1000}, .pushed = 3},
    {.name = "minus zero", .v = {-0.0, -0.0}, .held = -0.0, .pushed = 1},
    {.name = "Chung and Lee", .scheme = CT_CHUNG_LEE, .v = {1000, 0}, .pushed = 2},
    {.name = "Noh and Bathe", .scheme = CT_NOH_BATHE, .v = {1000, 0}, .pushed = 2},
    {.name = "Tchamwa and Wielgosz", .scheme = CT_TCHAMWA_WIELGOSZ, .v = {1000, 0}, .gap = 1.5},
};
enum { FORM_COUNT = sizeof FORMS / sizeof *FORMS, STEPS = 28, TRIALS = 30 };

/* A force on all nodes: it grows slightly with their mean displacement. */
static ct_status push_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  const form *f = effect->data;
  double mean = 0.0;
  (void)error;
  for (int n = 0; n < 144; n++) mean += view->displacement[3 * n] / 144.0;
  for (int i = 0; i < 3 * effect->node_count; i++)
    force[i] = i % 3 != f->along || (f->pushed == 2 && view->time < 1e-7) ? 0.0 : 1e-3 + 0.1 * mean;
  return CT_OK;
}

static const ct_effect_calls PUSH = {.force = push_force};

typedef struct bars {
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
  int elements;
} bars;

static bars open_bars(const form *f, int sleep, int threads)
{
  static int32_t nodes[4] = {0, 25, 60, 0}; // and one that is held along x
  bars r = {.scene = new_scene()};
  ct_error e;
  ct_mesh *m[2];
  ct_material steel = STEEL;
  unsigned long long seed = bodies_seed;
  steel.law = f->law;
  for (int b = 0; b < 2; b++) {
    m[b] = box_mesh(f->kind, b == 0 ? -2.3 : 0.1 * f->gap, 0, 0, 2.3, 0.2, 0.1, 23, 2, 1);
    if (f->distort > 0.0) shake(m[b], 0.1 * f->distort, 0);
    if (f->turned) turn_elements(m[b]);
    add_body(r.scene, b ? "right" : "left", m[b], &steel, f->kernel, f->v[b], 0, 0);
    r.elements += m[b]->element_count;
  }
  bodies_seed = seed;
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = f->enforcement;
  if (f->distort == 0.0)
    add_contact_with(r.scene, 0, m[0], 0, 1, m[1], 0.1 * f->gap, 0, 0.5, options, 0.0, 0.0);
  if (f->distort == 0.0)
    add_support(r.scene, 1, m[1], 0, 0.1 * f->gap + 2.3, "x", f->held + f->v[1]);
  ct_optimisations optimisations = (ct_optimisations){1, 1, 1};
  optimisations.sleep = sleep;
  need(ct_scene_set_optimisations(r.scene, &optimisations, &e), &e);
  int32_t count = m[0]->node_count + m[1]->node_count;
  nodes[3] = count - 1;
  if (f->pushed || f->distort > 0.0)
    add_effect(r.scene, &(ct_effect){.label = "push",
                                     .calls = &PUSH,
                                     .data = (void *)f,
                                     .nodes = f->pushed == 3 ? NULL : nodes,
                                     .node_count = f->pushed == 3 ? count : 4});
  ct_scene_time time = {
      .end = 1e-6, .fraction = 0.9, .integrator = ct_integrator_default(f->scheme)};
  set_threads(r.scene, threads);
  r.problem = build(r.scene, time, NULL, NULL);
  r.state = new_state(r.problem);
  for (int b = 0; b < 2; b++) ct_mesh_free(m[b]);
  return r;
}

static void close_bars(bars *r)
{
  ct_state_free(r->state);
  ct_scene_free(r->scene);
}

/* Equal values; a contact marks values without memory with NaN. */
static int equal(const double *a, const double *b, int64_t count)
{
  int64_t i = 0;
  while (i < count && (a[i] == b[i] || (isnan(a[i]) && isnan(b[i])))) i++;
  return i == count;
}

/* Whether all that a restart needs has the same values. */
static int same_values(const bars *a, const bars *b)
{
  const ct_state *s = a->state, *t = b->state;
  int64_t dofs = 3 * (int64_t)s->node_count;
  return s->step == t->step && equal(s->displacement, t->displacement, dofs) &&
         equal(s->velocity, t->velocity, dofs) && equal(s->work, t->work, s->work_count) &&
         equal(s->impulse, t->impulse, s->impulse_count) &&
         equal(s->memory, t->memory, s->memory_count);
}

static int same_energy(bars *a, bars *b)
{
  ct_energy x = energy_of(a->problem, a->state), y = energy_of(b->problem, b->state);
  return equal((const double *)&x, (const double *)&y, sizeof x / sizeof(double));
}

/* Changes of a state by a host: move or push a node at the far end, lift a whole bar, set its
 * velocities to -0, also while the forces are known. */
static void disturb(bars *r, int how)
{
  int64_t last = 3 * (int64_t)r->problem->node_count, half = last / 2;
  if (how % 2) energy_of(r->problem, r->state);
  if (how / 2 == 0) r->state->displacement[last - 3] += 1e-9;
  if (how / 2 == 1) r->state->velocity[last - 3] += 1.0;
  for (int64_t d = half; d < last; d++) {
    if (how / 2 == 2) r->state->displacement[d] = 0.25;
    if (how / 2 == 3) r->state->velocity[d] = d % 3 ? -0.0 : 5.0;
  }
}

/* Continue in a new state, or in one that was ahead and is full of NaN. */
static void change_place(bars *r, int spoilt)
{
  ct_error e;
  ct_state *other = new_state(r->problem);
  for (int64_t d = 0; spoilt && d < 3 * (int64_t)other->node_count; d++) other->velocity[d] = NAN;
  if (spoilt) (void)ct_run(r->problem, other, 3, NULL, 0, &e);
  need(ct_state_copy(r->problem, r->state, other, &e), &e);
  other->element_updates[0] += r->state->element_updates[0];
  other->element_updates[1] += r->state->element_updates[1];
  ct_state_free(r->state);
  r->state = other;
}

/* One thread and one series without sleeping, compared with threads, splits, copies and energies in
 * between; a host disturbs both runs twice. */
static void forms(void)
{
  for (int i = 0; i < FORM_COUNT; i++) {
    int same = 1, energies = 1;
    int64_t left_out = 0, all_out = 0;
    for (int how = -1; how < 8; how += 1 + (how < 0 ? i % 4 : 3)) {
      bars all = open_bars(&FORMS[i], 0, 1), some = open_bars(&FORMS[i], 1, 1 + (how + 1) % 3);
      for (int piece = 0; piece < 3; piece++) {
        if (piece > 0 && how >= 0) disturb(&all, how), disturb(&some, how);
        advance(all.problem, all.state, STEPS / 2);
        for (int64_t left = STEPS / 2, cut; left > 0; left -= cut) {
          cut = piece == 0 && how < 2 ? left : 1 + pick((int)left);
          if (cut == 1) advance(some.problem, some.state, 1);
          else advance(some.problem, some.state, cut);
          if (left > cut && pick(3) == 0) energy_of(some.problem, some.state);
          if (pick(4) == 0) change_place(&some, pick(2));
        }
        same &= same_values(&all, &some);
        if (how < 0 || piece == 2) energies &= same_energy(&all, &some);
      }
      left_out += some.state->element_updates[1];
      all_out += all.state->element_updates[1];
      close_bars(&all);
      close_bars(&some);
    }
    tap_ok(same && energies && left_out > 0 && all_out == 0,
           "%s: equal values, %lld element forces were skipped", FORMS[i].name,
           (long long)left_out);
  }
}

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
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1e-5, .fraction = 0.9}, NULL, NULL);
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
    ct_state_free(state);
  }
  tap_ok(right == 5, "a flight ends with an error: all nodes are at their last positions, %d of 5",
         right);
  ct_scene_free(scene);
  ct_mesh_free(m);
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
    ct_state_free(state);
  }
  tap_ok(right == 39, "kernel %d: the front passes one element per step, %d of 39 series",
         (int)kernel, right);
  ct_scene_free(scene);
  ct_mesh_free(m);
}

/* Elements whose nodes all have one displacement have no force: the basis of sleeping. */
static void no_force(const form *f)
{
  ct_error e;
  ct_mesh *m = box_mesh(f->kind, -1.3, 0.7, 0.1, 1.1, 0.9, 1.7, 3, 3, 3);
  ct_optimisations none = {0, 0, 0};
  ct_solid_body block = {.mesh = m, .material = STEEL, .kernel = f->kernel, .optimisations = &none};
  ct_effect *effect;
  void *scratch;
  int64_t zeros = 0, dofs = 3 * (int64_t)m->node_count;
  double *u = numbers(dofs), *force = numbers(dofs);
  block.material.law = f->law;
  if (f->distort > 0.0) shake(m, 0.3 * f->distort, 0);
  need(create_solid(&block, 1, &effect, &e), &e);
  need(effect->calls->create_scratch(effect, &scratch, &e), &e);
  for (int trial = 0; trial < TRIALS; trial++) {
    double shift[3];
    for (int c = 0; c < 3; c++) shift[c] = uniform(1.0) * pow(10.0, uniform(12.0));
    for (int64_t d = 0; d < dofs; d++) u[d] = shift[d % 3], force[d] = 1.0;
    ct_view view = {.displacement = u, .scratch = scratch};
    need(effect->calls->force(effect, &view, force, &e), &e);
    for (int64_t d = 0; d < dofs; d++) zeros += force[d] == 0.0;
  }
  tap_ok(zeros == TRIALS * dofs, "%s: no force in %d translations", f->name, TRIALS);
  effect->calls->free_scratch(scratch);
  ct_effect_free(effect);
  free(u);
  free(force);
  ct_mesh_free(m);
}

int main(void)
{
  for (int i = 0; i < FORM_COUNT; i++)
    if (FORMS[i].kind || FORMS[i].kernel || FORMS[i].law || i == 0) no_force(&FORMS[i]);
  front(CT_KERNEL_BOX);
  front(CT_KERNEL_GENERAL);
  failure();
  forms();
  return tap_done();
}
