/* What is left out changes nothing: runs with and without each saving have the same bits, and something was left out. */
#include "../../libcontact/src/bits.h"
#include "../../libcontact/src/contact/contact_internal.h"
#include "../../libcontact/src/memory.h"
#include "../../libcontact/src/solid/quiet.h"
#include "../../libcontact/src/workspace.h"
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9};
static const ct_savings NONE = {0, 0, 0, 0};

/* A scene of two bars that meet, in many forms. */
typedef struct form {
  const char *name;
  ct_brick_kind kind;
  ct_solid_kernel kernel;
  double distort;      /* of the nodes inside, in edges */
  int unlike;          /* the second bar has another mesh */
  int turned;          /* elements with axes along any edge: octants are no lattice */
  int mirrored;        /* x -> -x */
  double v[2], gap;    /* velocities along x, gap in edges */
  double held;         /* velocity of a support at the far end, NaN: none */
  int sheared;         /* the nodes of the face y = 0 of the first bar are pulled along x, all alike */
  int pushed;          /* 1: an effect that acts on some nodes; 2: on all; 3: one that begins to act later */
  double beta;
  int64_t steps;
} form;

typedef struct push {
  double force, begin;
} push;

static ct_status push_force(const ct_effect *effect, const ct_view *view, double *force, ct_error *error)
{
  const push *p = effect->data;
  (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++) force[i] = view->time < p->begin ? 0.0 : (i % 3 == 0 ? p->force : 0.0);
  return CT_OK;
}

typedef struct run {
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
  int64_t steps;
} run;

static ct_mesh *bar(const form *f, int which)
{
  double a = which == 0 ? -2.4 : 0.1 * f->gap;
  int ny = f->unlike && which == 1 ? 3 : 2;
  if (f->mirrored) a = -(a + 2.4);
  ct_mesh *m = box_mesh(f->kind, a, 0, 0, 2.4, 0.1 * ny, 0.1, 24, ny, 1);
  if (f->distort > 0.0) distort_inside(m, 0.1 * f->distort);
  if (f->distort > 0.0)
    for (int n = 0; n < m->node_count; n++) // one layer has no inside: shear the edges along y a little
      m->nodes[3 * n] += m->nodes[3 * n] > a + 1e-6 && m->nodes[3 * n] < a + 2.4 - 1e-6 ? 0.1 * f->distort * sin(40.0 * m->nodes[3 * n + 1] + 3.0 * n) : 0.0;
  if (f->turned) turn_elements(m);
  return m;
}

static run open_run(const form *f, ct_savings savings, int threads)
{
  static const int32_t NODES[4] = {0, 5, 113, 152};
  run r = {.scene = new_scene()};
  ct_error e;
  unsigned long long seed = bodies_seed;
  ct_mesh *m[2] = {bar(f, 0), bar(f, 1)};
  bodies_seed = seed;
  double sign = f->mirrored ? -1.0 : 1.0;
  for (int b = 0; b < 2; b++) add_body(r.scene, b ? "right" : "left", m[b], &STEEL, f->kernel, sign * f->v[b], 0, 0);
  add_contact(r.scene, 0, m[0], 0, 1, m[1], sign * 0.1 * f->gap, 0, f->beta);
  if (!isnan(f->held)) add_support(r.scene, 1, m[1], 0, sign * (0.1 * f->gap + 2.4), "x", sign * f->held);
  add_support(r.scene, 0, m[0], 2, 0.0, "z", 0.0);
  for (int b = 0; b < 2; b++) add_support(r.scene, b, m[b], 1, 0.0, "y", 0.0); // their nodes have gaps
  if (f->sheared) add_support(r.scene, 0, m[0], 1, 0.0, "x", sign * 100.0);
  need(ct_scene_set_savings(r.scene, &savings, &e), &e);
  if (f->pushed) {
    static push data[3] = {{.force = 1e-3}, {.force = 1e-18}, {.force = 1e-2, .begin = 1e-7}};
    push *p = &data[f->pushed - 1];
    const ct_problem *joined;
    ct_effect *effect;
    need(ct_scene_join(r.scene, &joined, &e), &e);
    ct_effect own = {.name = "push", .data = p, .force = push_force, .nodes = f->pushed == 2 ? NULL : NODES, .node_count = f->pushed == 2 ? joined->node_count : 4};
    need(ct_effect_create(&own, &effect, &e), &e);
    need(ct_scene_add_effect(r.scene, effect, &e), &e);
  }
  ct_stable_step stable;
  r.problem = build(r.scene, (ct_scene_time){.end = 1e-6, .fraction = 0.99, .threads = threads}, &r.steps, &stable);
  r.state = new_state(r.problem);
  for (int b = 0; b < 2; b++) ct_mesh_free(m[b]);
  return r;
}

static void close_run(run *r)
{
  ct_state_free(r->state);
  ct_scene_free(r->scene);
}

/* Whether all that a restart needs, and the ledger, have the same bits. */
static int same_state(run *a, run *b)
{
  ct_state *s = a->state, *t = b->state;
  size_t n = 3 * (size_t)s->node_count * sizeof(double);
  ct_energy ea = energy_of(a->problem, s), eb = energy_of(b->problem, t);
  ct_momentum pa = momentum_of(a->problem, s, 0), pb = momentum_of(b->problem, t, 0);
  return s->step == t->step && memcmp(s->displacement, t->displacement, n) == 0 && memcmp(s->velocity, t->velocity, n) == 0 &&
         memcmp(s->work, t->work, (size_t)s->work_count * 8) == 0 && memcmp(s->impulse, t->impulse, (size_t)s->impulse_count * 8) == 0 &&
         memcmp(s->memory, t->memory, (size_t)s->memory_count * 8) == 0 && memcmp(&ea, &eb, sizeof ea) == 0 && memcmp(&pa.p, &pb.p, sizeof pa.p) == 0 &&
         memcmp(&pa.L, &pb.L, sizeof pa.L) == 0;
}

static int64_t still_nodes(const run *r)
{
  int64_t count = 0;
  for (int32_t n = 0; n < r->problem->node_count; n++) count += ct_bits_get(r->state->workspace->still, n);
  return count;
}

static const form FORMS[] = {
    {.name = "bars that fly together", .v = {1000, -1000}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "a bar at rest is hit", .v = {1000, 0}, .held = 0.0, .beta = 1.0, .steps = 60},
    {.name = "mirrored", .mirrored = 1, .v = {1000, 0}, .held = 0.0, .beta = 1.0, .steps = 60},
    {.name = "general kernel", .kernel = CT_KERNEL_GENERAL, .v = {1000, -1000}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "distorted, unlike meshes, one bar pulled away", .distort = 0.1, .unlike = 1, .v = {1000, -700}, .held = 300.0, .beta = 0.5, .steps = 60},
    {.name = "turned elements", .turned = 1, .v = {1000, -1000}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "hex20", .kind = CT_HEX20, .v = {1000, -1000}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "hex20, distorted", .kind = CT_HEX20, .distort = 0.02, .v = {1000, 0}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "an effect on four nodes", .v = {1000, -1000}, .held = NAN, .pushed = 1, .beta = 0.5, .steps = 40},
    {.name = "an effect on all nodes", .v = {0, -1000}, .held = NAN, .pushed = 2, .beta = 0.5, .steps = 40},
    {.name = "an effect that begins later", .v = {0, 0}, .held = NAN, .gap = 1.0, .pushed = 3, .beta = 0.5, .steps = 60},
    {.name = "rows that move each by itself", .v = {0, 0}, .held = NAN, .gap = 1.0, .sheared = 1, .beta = 0.5, .steps = 20},
    {.name = "minus zero", .v = {-0.0, -0.0}, .held = -0.0, .gap = 1.0, .beta = 0.5, .steps = 5},
    {.name = "a gap to fly first", .v = {1000, -1000}, .held = NAN, .gap = 1.5, .beta = 0.5, .steps = 60},
};
enum { FORM_COUNT = sizeof FORMS / sizeof *FORMS };

/* Step by step the same bits with and without a saving, for any number of threads. */
static void same_bits(ct_savings savings, const char *what)
{
  for (int i = 0; i < FORM_COUNT; i++) {
    const form *f = &FORMS[i];
    for (int threads = 1; threads <= 3; threads += 2) {
      run all = open_run(f, NONE, 1), some = open_run(f, savings, threads);
      int64_t same = 0, left_out = 0;
      for (int64_t k = 0; k < f->steps; k++) {
        if (k % 5 == 0) same += same_state(&all, &some); // asks for the ledger in between, too
        advance(all.problem, all.state, 1);
        advance(some.problem, some.state, 1);
        same += k % 5 == 0 ? 0 : memcmp(all.state->velocity, some.state->velocity, 24 * (size_t)all.problem->node_count) == 0;
        left_out += still_nodes(&some);
      }
      tap_ok(same == f->steps && same_state(&all, &some) && still_nodes(&all) == 0 && (left_out > 0) == (savings.quiet && f->pushed != 2),
             "%s, %s, %d threads: the same bits, %.0f %% of the nodes still", f->name, what, threads,
             100.0 * (double)left_out / ((double)f->steps * (double)all.problem->node_count));
      close_run(&all);
      close_run(&some);
    }
  }
}

/* A state that is copied in the middle of a run goes on with the same bits: into a new state, into one that was before and one that was behind. */
static void restarts(void)
{
  ct_error e;
  for (int i = 0; i < FORM_COUNT; i++) {
    const form *f = &FORMS[i];
    run straight = open_run(f, ct_savings_default(), 1), other[3];
    advance(straight.problem, straight.state, f->steps / 3);
    for (int k = 0; k < 3; k++) {
      other[k] = open_run(f, ct_savings_default(), 1);
      advance(other[k].problem, other[k].state, k * (f->steps / 2 - 1));
      need(ct_state_copy(other[k].problem, straight.state, other[k].state, &e), &e);
      advance(other[k].problem, other[k].state, f->steps - f->steps / 3);
    }
    advance(straight.problem, straight.state, f->steps - f->steps / 3);
    tap_ok(same_state(&straight, &other[0]) && same_state(&straight, &other[1]) && same_state(&straight, &other[2]), "%s: the same bits after a restart", f->name);
    for (int k = 0; k < 3; k++) close_run(&other[k]);
    close_run(&straight);
  }
}

/* Also where a state holds a velocity of -0, which a force of +0 turns into +0. */
static void copied_zeros(void)
{
  ct_error e;
  run from = open_run(&FORMS[1], NONE, 1), fresh = open_run(&FORMS[1], NONE, 1), used = open_run(&FORMS[1], ct_savings_default(), 1);
  advance(used.problem, used.state, 5);
  for (int64_t d = 0; d < 3 * (int64_t)from.state->node_count; d++) from.state->velocity[d] = from.state->work[d] = -0.0;
  need(ct_state_copy(fresh.problem, from.state, fresh.state, &e), &e);
  need(ct_state_copy(used.problem, from.state, used.state, &e), &e);
  advance(fresh.problem, fresh.state, 3);
  advance(used.problem, used.state, 3);
  tap_ok(same_state(&fresh, &used), "a state with velocities of -0 goes on with the same bits");
  close_run(&from);
  close_run(&fresh);
  close_run(&used);
}

/* A batch is skipped only when it was computed before with nodes that had moved alike, and had no force. */
static void batches(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 8, 1, 1);
  int32_t number[64];
  for (int a = 0; a < 8; a++)
    for (int l = 0; l < 8; l++) number[8 * a + l] = m->elements[8 * l + a];
  ct_solid_part part = {.mesh = m, .batch_count = 1, .batch_nodes = number, .first_batch = 2, .first_node = 3};
  uint8_t found[3] = {0};
  uint64_t changed[1] = {0};
  ct_quiet quiet = {found, changed};
  double u[3 * 39], values[192] = {0.0};
  for (int i = 0; i < 3 * 39; i++) u[i] = i < 9 ? 7.0 : 0.1 * (i % 3 + 1);
  tap_ok(ct_quiet_prepare(&part) == CT_OK && part.range_first[1] == 1 && part.ranges[0].first == 3 && part.ranges[0].last == 38, "a batch of a row has one range of nodes");
  tap_ok(!ct_quiet_skip(&quiet, &part, 0, u) && found[2] == CT_BATCH_FRESH, "a batch that moves alike is computed once");
  values[191] = -1e-300;
  ct_quiet_confirm(&quiet, &part, 0, 1, values);
  tap_ok(!ct_quiet_skip(&quiet, &part, 0, u), "one with a force is computed again");
  values[191] = -0.0;
  ct_quiet_confirm(&quiet, &part, 0, 1, values);
  ct_quiet_mark(&quiet, &part, 0, 1);
  tap_ok(changed[0] == ((1ull << 39) - 1 - 7), "what was computed marks its nodes");
  changed[0] = 0;
  tap_ok(ct_quiet_skip(&quiet, &part, 0, u), "one without is skipped");
  ct_quiet_mark(&quiet, &part, 0, 1);
  tap_ok(changed[0] == 0, "what was skipped marks none");
  for (int i = 9; i < 3 * 39; i++) u[i] = 1e3 * (i % 3 - 1);
  tap_ok(ct_quiet_skip(&quiet, &part, 0, u), "also elsewhere");
  for (int n = 3; n < 39; n++)
    for (int c = 0; c < 3; c++) {
      double keep = u[3 * n + c];
      u[3 * n + c] += keep == 0.0 ? 5e-324 : 1e-12;
      if (ct_quiet_skip(&quiet, &part, 0, u)) changed[0] = 1;
      u[3 * n + c] = keep;
      ct_quiet_skip(&quiet, &part, 0, u); // computed again
      if (!ct_quiet_skip(&quiet, &part, 0, u)) changed[0] = 2;
    }
  tap_ok(changed[0] == 0, "the last bit of any node wakes it");
  u[9] = -0.0;
  for (int i = 12; i < 3 * 39; i += 3) u[i] = 0.0;
  tap_ok(!ct_quiet_skip(&quiet, &part, 0, u), "and so does the sign of zero");
  for (int i = 9; i < 3 * 39; i++) u[i] = INFINITY;
  ct_quiet_skip(&quiet, &part, 0, u);
  tap_ok(!ct_quiet_skip(&quiet, &part, 0, u), "what is not finite is never quiet");
  ct_release(part.range_first);
  ct_release(part.ranges);
  ct_mesh_free(m);
}

/* No node is still before anything is known of it, and each is once the front has not come yet: the front moves at most an element a step. */
static void front(void)
{
  form f = FORMS[1];
  run r = open_run(&f, ct_savings_default(), 1);
  int ahead = 1;
  advance(r.problem, r.state, 1);
  tap_ok(still_nodes(&r) == 0, "the first step computes everything");
  for (int k = 1; k < 12; k++) {
    advance(r.problem, r.state, 1);
    for (int32_t n = 0; n < r.problem->node_count; n++) {
      double x = r.problem->reference[3 * n];
      // Batches have 8 elements along x, which a front that is k + 1 elements on may have reached.
      if (x > 0.1 * (k + 1 + 8) + 1e-9) ahead &= ct_bits_get(r.state->workspace->still, n);
    }
  }
  tap_ok(ahead, "nodes ahead of the front and of its batch are still");
  close_run(&r);
}

int main(void)
{
  ct_savings quiet = {.quiet = 1};
  same_bits(quiet, "quiet");
  restarts();
  copied_zeros();
  batches();
  front();
  return tap_done();
}
