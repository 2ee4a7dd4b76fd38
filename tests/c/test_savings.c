/* What is left out changes nothing: runs with and without each saving have the same bits, and
 * something was left out. */
#include "../../libcontact/src/base/bits.h"
#include "../../libcontact/src/contact/contact_internal.h"
#include "../../libcontact/src/base/memory.h"
#include "../../libcontact/src/solid/lattice.h"
#include "../../libcontact/src/solid/quiet.h"
#include "../../libcontact/src/step/workspace.h"
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
static const ct_savings NONE = {0, 0, 0, 0};

/* A scene of two bars that meet, in many forms. */
typedef struct form {
  const char *name;
  ct_brick_kind kind;
  ct_solid_kernel kernel;
  ct_law law;
  double distort;   /* of the nodes inside, in edges */
  int unlike;       /* the second bar has another mesh */
  int turned;       /* elements with axes along any edge: octants are no lattice */
  int mirrored;     /* x -> -x */
  double v[2], gap; /* velocities along x, gap in edges */
  double held;      /* velocity of a support at the far end, NaN: none */
  int sheared;      /* the nodes of the face y = 0 of the first bar are pulled along x, all alike */
  int pushed; /* 1: an effect that acts on some nodes; 2: on all; 3: one that begins to act later */
  double beta;
  int64_t steps;
  ct_enforcement enforcement;
} form;

typedef struct push {
  double force, begin;
} push;

static ct_status push_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  const push *p = effect->data;
  (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++)
    force[i] = view->time < p->begin ? 0.0 : (i % 3 == 0 ? p->force : 0.0);
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
    for (int n = 0; n < m->node_count;
         n++) // one layer has no inside: shear the edges along y a little
      m->nodes[3 * n] += m->nodes[3 * n] > a + 1e-6 && m->nodes[3 * n] < a + 2.4 - 1e-6
                             ? 0.1 * f->distort * sin(40.0 * m->nodes[3 * n + 1] + 3.0 * n)
                             : 0.0;
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
  ct_material steel = STEEL;
  steel.law = f->law;
  for (int b = 0; b < 2; b++)
    add_body(r.scene, b ? "right" : "left", m[b], &steel, f->kernel, sign * f->v[b], 0, 0);
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = f->enforcement;
  add_contact_with(r.scene, 0, m[0], 0, 1, m[1], sign * 0.1 * f->gap, 0, f->beta, options, 0.0,
                   0.0);
  if (!isnan(f->held))
    add_support(r.scene, 1, m[1], 0, sign * (0.1 * f->gap + 2.4), "x", sign * f->held);
  add_support(r.scene, 0, m[0], 2, 0.0, "z", 0.0);
  for (int b = 0; b < 2; b++)
    add_support(r.scene, b, m[b], 1, 0.0, "y", 0.0); // their nodes have gaps
  if (f->sheared) add_support(r.scene, 0, m[0], 1, 0.0, "x", sign * 100.0);
  need(ct_scene_set_savings(r.scene, &savings, &e), &e);
  if (f->pushed) {
    static push data[3] = {{.force = 1e-3}, {.force = 1e-18}, {.force = 1e-2, .begin = 1e-7}};
    push *p = &data[f->pushed - 1];
    const ct_problem *joined;
    ct_effect *effect;
    need(ct_scene_join(r.scene, &joined, &e), &e);
    ct_effect own = {.label = "push",
                     .data = p,
                     .force = push_force,
                     .nodes = f->pushed == 2 ? NULL : NODES,
                     .node_count = f->pushed == 2 ? joined->node_count : 4};
    need(ct_effect_create(&own, &effect, &e), &e);
    need(ct_scene_add_effect(r.scene, effect, &e), &e);
  }
  ct_stable_step stable;
  r.problem = build(r.scene, (ct_scene_time){.end = 1e-6, .fraction = 0.99, .threads = threads},
                    &r.steps, &stable);
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
  return s->step == t->step && memcmp(s->displacement, t->displacement, n) == 0 &&
         memcmp(s->velocity, t->velocity, n) == 0 &&
         memcmp(s->work, t->work, (size_t)s->work_count * 8) == 0 &&
         memcmp(s->impulse, t->impulse, (size_t)s->impulse_count * 8) == 0 &&
         memcmp(s->memory, t->memory, (size_t)s->memory_count * 8) == 0 &&
         memcmp(&ea, &eb, sizeof ea) == 0 && memcmp(&pa.p, &pb.p, sizeof pa.p) == 0 &&
         memcmp(&pa.L, &pb.L, sizeof pa.L) == 0;
}

static int64_t still_nodes(const run *r)
{
  int64_t count = 0;
  for (int32_t n = 0; n < r->problem->node_count; n++)
    count += ct_bits_get(r->state->workspace->still, n);
  return count;
}

static const form FORMS[] = {
    {.name = "bars that fly together", .v = {1000, -1000}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "a bar at rest is hit",
     .v = {1000, 0},
     .held = 0.0,
     .beta = 1.0,
     .steps = 60,
     .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
    {.name = "mirrored",
     .mirrored = 1,
     .v = {1000, 0},
     .held = 0.0,
     .beta = 1.0,
     .steps = 60,
     .enforcement = CT_ENFORCE_LAGRANGE},
    {.name = "general kernel",
     .kernel = CT_KERNEL_GENERAL,
     .v = {1000, -1000},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "distorted, unlike meshes, one bar pulled away",
     .distort = 0.1,
     .unlike = 1,
     .v = {1000, -700},
     .held = 300.0,
     .beta = 0.5,
     .steps = 60,
     .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
    {.name = "turned elements",
     .turned = 1,
     .v = {1000, -1000},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "hex20", .kind = CT_HEX20, .v = {1000, -1000}, .held = NAN, .beta = 0.5, .steps = 40},
    {.name = "hex20, general kernel",
     .kind = CT_HEX20,
     .kernel = CT_KERNEL_GENERAL,
     .v = {1000, -1000},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "hex20, distorted",
     .kind = CT_HEX20,
     .distort = 0.02,
     .v = {1000, 0},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "St. Venant-Kirchhoff",
     .law = CT_ST_VENANT_KIRCHHOFF,
     .v = {1000, -1000},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "neo-Hookean, distorted",
     .law = CT_NEO_HOOKEAN,
     .distort = 0.1,
     .v = {1000, 0},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "neo-Hookean hex20",
     .kind = CT_HEX20,
     .law = CT_NEO_HOOKEAN,
     .v = {1000, 0},
     .held = NAN,
     .beta = 0.5,
     .steps = 40},
    {.name = "an effect on four nodes",
     .v = {1000, -1000},
     .held = NAN,
     .pushed = 1,
     .beta = 0.5,
     .steps = 40},
    {.name = "an effect on all nodes",
     .v = {0, -1000},
     .held = NAN,
     .pushed = 2,
     .beta = 0.5,
     .steps = 40},
    {.name = "an effect that begins later",
     .v = {0, 0},
     .held = NAN,
     .gap = 1.0,
     .pushed = 3,
     .beta = 0.5,
     .steps = 60},
    {.name = "rows that move each by itself",
     .v = {0, 0},
     .held = NAN,
     .gap = 1.0,
     .sheared = 1,
     .beta = 0.5,
     .steps = 20},
    {.name = "minus zero", .v = {-0.0, -0.0}, .held = -0.0, .gap = 1.0, .beta = 0.5, .steps = 5},
    {.name = "a gap to fly first",
     .v = {1000, -1000},
     .held = NAN,
     .gap = 1.5,
     .beta = 0.5,
     .steps = 60,
     .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
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
        same += k % 5 == 0 ? 0
                           : memcmp(all.state->velocity, some.state->velocity,
                                    24 * (size_t)all.problem->node_count) == 0;
        left_out += still_nodes(&some);
      }
      tap_ok(same == f->steps && same_state(&all, &some) && still_nodes(&all) == 0 &&
                 (left_out > 0) == (savings.quiet && f->pushed != 2),
             "%s, %s, %d threads: the same bits, %.0f %% of the nodes still", f->name, what,
             threads,
             100.0 * (double)left_out / ((double)f->steps * (double)all.problem->node_count));
      close_run(&all);
      close_run(&some);
    }
  }
}

/* Move a node at the far end of the second bar by hand, or push it, when the forces are asked for
 * next by a step, or by the ledger, or were so just before; or turn zeros of its velocity into -0.
 */
static void meddle(run *r, int how)
{
  int64_t d = 3 * (int64_t)r->problem->node_count - 3;
  if (how / 2 == 1) energy_of(r->problem, r->state);
  r->state->displacement[d] += how % 2 || how == 6 ? 0.0 : 1e-7;
  r->state->velocity[d] += how % 2 ? 1.0 : 0.0;
  for (int c = 1; how == 6 && c < 3; c++) r->state->velocity[d + c] = -0.0;
  if (how / 2 == 2) energy_of(r->problem, r->state);
}

/* Also where many steps are taken in one call, and a host changes the state in between. */
static void many_steps(void)
{
  for (int i = 0; i < FORM_COUNT; i++) {
    const form *f = &FORMS[i];
    for (int how = -1; how < 7; how++) {
      run all = open_run(f, NONE, 1), some = open_run(f, ct_savings_default(), 2 + how % 2);
      int same = 1;
      for (int64_t k = 0, steps; k < f->steps; k += steps) {
        steps = k + 7 < f->steps ? 7 : f->steps - k;
        if (k == 7 && how >= 0) {
          meddle(&all, how);
          meddle(&some, how);
        }
        advance(all.problem, all.state, steps);
        advance(some.problem, some.state, steps);
        same = same && memcmp(all.state->displacement, some.state->displacement,
                              24 * (size_t)all.problem->node_count) == 0;
      }
      tap_ok(same && same_state(&all, &some),
             "%s, seven steps a call, a host meddles in way %d: the same bits", f->name, how);
      close_run(&all);
      close_run(&some);
    }
  }
}

/* A body whose ring holds a tenth of its elements, pushed at a few nodes: what stands in the ring
 * of a batch that is skipped is not taken for its own. */
static void long_ring(void)
{
  static const int32_t NODES[4] = {8, 3000, 3001, 5800};
  static push data = {.force = 1e-3};
  const ct_savings savings[2] = {NONE, ct_savings_default()};
  ct_error e;
  run r[2];
  for (int k = 0; k < 2; k++) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1.6, 0.8, 4, 16, 8, 40);
    r[k] = (run){.scene = new_scene()};
    add_body(r[k].scene, "block", m, &STEEL, CT_KERNEL_AUTO, 1000, 0, 0);
    need(ct_scene_set_savings(r[k].scene, &savings[k], &e), &e);
    ct_effect own = {.label = "push",
                     .data = &data,
                     .force = push_force,
                     .nodes = NODES,
                     .node_count = 4},
              *effect;
    const ct_problem *joined;
    need(ct_scene_join(r[k].scene, &joined, &e), &e);
    need(ct_effect_create(&own, &effect, &e), &e);
    need(ct_scene_add_effect(r[k].scene, effect, &e), &e);
    ct_stable_step stable;
    r[k].problem = build(r[k].scene, (ct_scene_time){.end = 1e-6, .fraction = 0.99, .threads = 1},
                         &r[k].steps, &stable);
    r[k].state = new_state(r[k].problem);
    advance(r[k].problem, r[k].state, 6);
    ct_mesh_free(m);
  }
  tap_ok(same_state(&r[0], &r[1]) && still_nodes(&r[1]) > 0,
         "a block pushed at a few nodes: the same bits, %d nodes still", (int)still_nodes(&r[1]));
  for (int k = 0; k < 2; k++) close_run(&r[k]);
}

/* A state that is copied in the middle of a run goes on with the same bits: into a new state, into
 * one that was before and one that was behind. */
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
    tap_ok(same_state(&straight, &other[0]) && same_state(&straight, &other[1]) &&
               same_state(&straight, &other[2]),
           "%s: the same bits after a restart", f->name);
    for (int k = 0; k < 3; k++) close_run(&other[k]);
    close_run(&straight);
  }
}

/* Also where a state holds a velocity of -0, which a force of +0 turns into +0. */
static void copied_zeros(void)
{
  ct_error e;
  run from = open_run(&FORMS[1], NONE, 1), fresh = open_run(&FORMS[1], NONE, 1),
      used = open_run(&FORMS[1], ct_savings_default(), 1);
  advance(used.problem, used.state, 5);
  for (int64_t d = 0; d < 3 * (int64_t)from.state->node_count; d++)
    from.state->velocity[d] = from.state->work[d] = -0.0;
  need(ct_state_copy(fresh.problem, from.state, fresh.state, &e), &e);
  need(ct_state_copy(used.problem, from.state, used.state, &e), &e);
  advance(fresh.problem, fresh.state, 3);
  advance(used.problem, used.state, 3);
  tap_ok(same_state(&fresh, &used), "a state with velocities of -0 goes on with the same bits");
  close_run(&from);
  close_run(&fresh);
  close_run(&used);
}

/* A batch is skipped only when it was computed before with nodes that had moved alike, and had no
 * force. */
static int skipped(ct_quiet *quiet, const ct_solid_part *part, const double *u)
{
  static const double different[3 * 39] = {[20] = 1.0};
  ct_quiet_look(quiet, part, 0, 1, u, different);
  return quiet->batch[part->first_batch] == CT_BATCH_QUIET;
}

/* One whose nodes have one velocity is not looked at until one of its nodes does more than drift;
 * one that moves is looked at every eighth call. */
static void sleeping_batches(ct_quiet *quiet, const ct_solid_part *part)
{
  double same[3 * 39], u[3 * 39] = {0.0};
  uint8_t *found = &quiet->batch[part->first_batch], *woken = &quiet->woken[part->first_batch];
  for (int i = 0; i < 3 * 39; i++) same[i] = i % 3 + 1.0;
  *found = CT_BATCH_UNKNOWN;
  *woken = 1;
  for (int i = 0; i < 2; i++) ct_quiet_look(quiet, part, 0, 1, u, same);
  tap_ok(*found == CT_BATCH_QUIET, "one that is woken does not fall asleep again in that call");
  *found = CT_BATCH_UNKNOWN;
  *woken = 0;
  for (int i = 0; i < 2; i++) ct_quiet_look(quiet, part, 0, 1, u, same);
  tap_ok(*found == CT_BATCH_ASLEEP,
         "nodes with one displacement and one velocity put a batch to sleep");
  same[9] = nextafter(same[9], 0.0);
  *found = CT_BATCH_QUIET;
  ct_quiet_look(quiet, part, 0, 1, u, same);
  tap_ok(*found == CT_BATCH_QUIET, "the last bit of a velocity does not");
  same[9] = 1.0;
  ct_quiet_look(quiet, part, 0, 1, u, same);
  u[3 * 38] = 1.0;
  ct_quiet_look(quiet, part, 0, 1, u, same);
  tap_ok(*found == CT_BATCH_ASLEEP, "while its nodes drift it is not looked at");
  *woken = 1;
  ct_quiet_look(quiet, part, 0, 1, u, same);
  tap_ok(*found == CT_BATCH_MOVING, "then it is");
  u[3 * 38] = 0.0;
  int calls = 0;
  for (quiet->call = 1; *found == CT_BATCH_MOVING; quiet->call = (quiet->call + 1) % 8, calls++)
    ct_quiet_look(quiet, part, 0, 1, u, same);
  tap_ok(*found == CT_BATCH_FRESH && calls == 8,
         "one that moves is seen to have stopped in the eighth call");
}

/* Which of eight batches are looked at together, beside one by one: all of them asleep, all of them
 * moving, or some of each. */
static void eight_batches(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 64, 1, 1);
  int32_t number[8 * 64];
  ct_solid_batch_nodes(m, number);
  ct_solid_part part = {.mesh = m, .batch_count = 8, .batch_nodes = number};
  double *u = numbers(3 * m->node_count);
  int wrong = 0, answers = 0;
  tap_ok(ct_quiet_prepare(&part) == CT_OK, "a row of eight batches");
  for (int trial = 0; trial < 4000; trial++) {
    uint8_t one[8], all[8], woken[8];
    int uniform_state = pick(3), crossed = 0;
    ct_quiet quiet = {.batch = one, .woken = woken, .call = pick(8)};
    u[3 * pick(m->node_count)] = pick(2);
    for (int b = 0; b < 8; b++) {
      one[b] = all[b] = (uint8_t)(uniform_state == 0   ? CT_BATCH_ASLEEP
                                  : uniform_state == 1 ? CT_BATCH_MOVING
                                                       : pick(5));
      woken[b] = pick(8) == 0;
    }
    for (int b = 0; b < 8; b++) crossed |= ct_quiet_look(&quiet, &part, b, b + 1, u, u);
    quiet.batch = all;
    int together = ct_quiet_look(&quiet, &part, 0, 8, u, u);
    wrong += memcmp(one, all, sizeof all) != 0 || together != crossed;
    answers += crossed;
  }
  tap_ok(wrong == 0 && answers > 100,
         "eight batches are looked at as they would be one by one; %d trials of 4000 began or "
         "ended a quiet one",
         answers);
  ct_release(part.range_first);
  ct_release(part.ranges);
  free(u);
  ct_mesh_free(m);
}

static void batches(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 8, 1, 1);
  int32_t number[64];
  for (int a = 0; a < 8; a++)
    for (int l = 0; l < 8; l++) number[8 * a + l] = m->elements[8 * l + a];
  ct_solid_part part = {
      .mesh = m, .batch_count = 1, .batch_nodes = number, .first_batch = 2, .first_node = 3};
  uint8_t found[3] = {0}, woken[3] = {1, 1, 1}, read[3] = {0};
  uint64_t changed[1] = {0};
  ct_quiet quiet = {.batch = found, .woken = woken, .read = read, .changed = changed};
  double u[3 * 39], values[192] = {0.0};
  for (int i = 0; i < 3 * 39; i++) u[i] = i < 9 ? 7.0 : 0.1 * (i % 3 + 1);
  tap_ok(ct_quiet_prepare(&part) == CT_OK && part.range_first[1] == 1 &&
             part.ranges[0].first == 3 && part.ranges[0].last == 38,
         "a batch of a row has one range of nodes");
  tap_ok(!skipped(&quiet, &part, u) && found[2] == CT_BATCH_FRESH,
         "a batch that moves alike is computed once");
  values[191] = -1e-300;
  ct_quiet_confirm(&quiet, &part, 0, 1, values);
  tap_ok(!skipped(&quiet, &part, u), "one with a force is computed again");
  values[191] = -0.0;
  ct_quiet_confirm(&quiet, &part, 0, 1, values);
  ct_quiet_mark(&quiet, &part);
  tap_ok(changed[0] == ((1ull << 39) - 1 - 7), "what was computed marks its nodes");
  changed[0] = 0;
  tap_ok(skipped(&quiet, &part, u), "one without is skipped");
  ct_quiet_mark(&quiet, &part);
  tap_ok(changed[0] == 0, "what was skipped marks none");
  for (int i = 9; i < 3 * 39; i++) u[i] = 1e3 * (i % 3 - 1);
  tap_ok(skipped(&quiet, &part, u), "also elsewhere");
  for (int n = 3; n < 39; n++)
    for (int c = 0; c < 3; c++) {
      double keep = u[3 * n + c];
      u[3 * n + c] += keep == 0.0 ? 5e-324 : 1e-12;
      if (skipped(&quiet, &part, u)) changed[0] = 1;
      u[3 * n + c] = keep;
      skipped(&quiet, &part, u); // computed again
      if (!skipped(&quiet, &part, u)) changed[0] = 2;
    }
  tap_ok(changed[0] == 0, "the last bit of any node wakes it");
  u[9] = -0.0;
  for (int i = 12; i < 3 * 39; i += 3) u[i] = 0.0;
  tap_ok(!skipped(&quiet, &part, u), "and so does the sign of zero");
  for (int i = 9; i < 3 * 39; i++) u[i] = INFINITY;
  skipped(&quiet, &part, u);
  tap_ok(!skipped(&quiet, &part, u), "what is not finite is never quiet");
  sleeping_batches(&quiet, &part);
  ct_release(part.range_first);
  ct_release(part.ranges);
  ct_mesh_free(m);
}

/* No node is still before anything is known of it, and each is once the front has not come yet: the
 * front moves at most an element a step. */
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

/* Two plates that fly toward each other, wobble, touch and part: the coordinates of the second one
 * at a time from 0 to 1. */
static void fly(const double *reference, int32_t node_count, double time, double *x)
{
  for (int32_t n = 0; n < node_count; n++) {
    const double *X = &reference[3 * n];
    double wobble = 0.2 * sin(9.0 * time) * sin(5.0 * X[1] + 3.0 * X[2] + 20.0 * time),
           right = X[0] > 0.5;
    x[3 * n] = X[0] + 0.5 * wobble - right * 5.1 * sin(3.14159265358979 * time);
    x[3 * n + 1] = X[1] + 0.3 * time;
    x[3 * n + 2] = X[2] + wobble;
  }
}

/* Contact points of a contact that need not look, and of one that always does; on the way the first
 * one counts its looks. */
static void flight(ct_brick_kind kind, int self)
{
  enum { STEPS = 800 };
  // Of a surface with itself, all faces of a plate share a node: nothing on the same side is near.
  ct_mesh *m[2] = {box_mesh(kind, -1, 0, 0, 1, 1, 1, 1, self ? 2 : 4, self ? 2 : 4),
                   box_mesh(kind, 5, 0.03, -0.02, 1, 1, 1, 1, self ? 2 : 3, 2)};
  int per = ct_face_node_count(ct_brick_face_kind(kind));
  int32_t nodes = m[0]->node_count + m[1]->node_count, faces[8 * 25], count[2];
  double *X = numbers(3 * nodes), *x = numbers(3 * nodes), *mass = numbers(nodes),
         *f[2] = {numbers(3 * nodes), numbers(3 * nodes)};
  memcpy(X, m[0]->nodes, 24 * (size_t)m[0]->node_count);
  memcpy(X + 3 * m[0]->node_count, m[1]->nodes, 24 * (size_t)m[1]->node_count);
  count[0] = ct_mesh_plane_faces(m[0], 0, 0.0, faces, NULL);
  count[1] = ct_mesh_plane_faces(m[1], 0, 5.0, faces + per * count[0], NULL);
  for (int i = per * count[0]; i < per * (count[0] + count[1]); i++) faces[i] += m[0]->node_count;
  for (int n = 0; n < nodes; n++) mass[n] = 1.0;
  ct_surface both = {ct_brick_face_kind(kind), nodes, count[0] + count[1], faces, X}, a = both,
             b = both;
  a.face_count = count[0];
  b.face_count = count[1];
  b.faces = faces + per * count[0];
  ct_contact *c[2];
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 10.0;
  ct_error e;
  for (int k = 0; k < 2; k++) {
    options.distant = k;
    need(self ? ct_contact_create_self(&both, &options, &c[k], &e)
              : ct_contact_create(&a, &b, &options, &c[k], &e),
         &e);
  }
  int64_t points = ct_contact_point_count(c[0]);
  ct_contact_point *p[2] = {room(points, sizeof **p), room(points, sizeof **p)};
  int same = 0, skipped = 0, touching = 0, looks = 0;
  double last = NAN;
  for (int step = 0; step <= STEPS; step++) {
    double omega[2] = {0.0, 0.0};
    fly(X, nodes, step / (double)STEPS, x);
    c[1]->side[0].points[0].gap = 42.0; // stands only when nobody has searched
    for (int k = 0; k < 2; k++) {
      c[k]->side[0].points[1].other = 0; // as an older state may say
      memset(f[k], 0, 24 * (size_t)nodes);
      memset(p[k], 0, (size_t)points * sizeof **p);
      need(ct_contact_update(c[k], x, x, &e), &e);
      if (k == 1 && c[1]->side[0].points[0].gap == 42.0)
        c[1]->side[0].points[0].gap = NAN, skipped++;
      ct_contact_add_force(c[k], f[k], f[k]);
      ct_contact_points(c[k], p[k]);
      if (step % 7 == 0) ct_contact_frequency(c[k], mass, mass, &omega[k]);
    }
    looks += last != c[1]->side[0].x_built[0];
    last = c[1]->side[0].x_built[0];
    touching += ct_contact_energy(c[0]) > 0.0;
    same += memcmp(f[0], f[1], 24 * (size_t)nodes) == 0 &&
            memcmp(p[0], p[1], (size_t)points * sizeof **p) == 0 && omega[0] == omega[1] &&
            ct_contact_energy(c[0]) == ct_contact_energy(c[1]);
  }
  tap_ok(same == STEPS + 1 && touching > 20 && skipped > STEPS / 4,
         "%s plates fly, touch and part, %s: the same bits in %d states, %d of them touching, no "
         "search in %d, %d looks",
         kind == CT_HEX8 ? "linear" : "quadratic", self ? "one surface" : "two surfaces", same,
         touching, skipped, looks);
  fly(X, nodes, 0.0, x);
  need(ct_contact_update(c[1], x, x, &e), &e);
  x[3 * (nodes - 1)] = NAN;
  x[3 * faces[0]] = NAN;
  tap_ok(ct_contact_update(c[1], x, x, &e) == CT_INVALID && e.point == faces[0],
         "a NaN far from all contact is an error");
  for (int k = 0; k < 2; k++) {
    ct_contact_free(c[k]);
    free(p[k]);
    free(f[k]);
    ct_mesh_free(m[k]);
  }
  free(X);
  free(x);
  free(mass);
}

/* The middle of a quadratic face moves three times as far as its nodes when corners and mid-sides
 * part: it is not missed. */
static void bulge(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  int32_t faces[16], nodes = m->node_count, count = ct_mesh_plane_faces(m, 0, 1.0, faces, NULL);
  double *X = numbers(6 * nodes), *x = numbers(6 * nodes);
  for (int n = 0; n < nodes; n++)
    for (int c = 0; c < 3; c++)
      X[3 * n + c] = m->nodes[3 * n + c],
                X[3 * (nodes + n) + c] =
                    c == 2 ? m->nodes[3 * n + c] : (c == 0 ? 12.0 : 1.0) - m->nodes[3 * n + c];
  ct_surface a = {CT_Q8, 2 * nodes, count, faces, X}, b = a;
  int32_t turned[8];
  for (int i = 0; i < 8; i++) turned[i] = faces[i] + nodes;
  b.faces = turned;
  ct_contact *c[2];
  ct_contact_options options = ct_contact_options_default();
  ct_error e;
  options.epsilon = 1.0;
  int same = 0, touching = 0;
  for (int k = 0; k < 2; k++) {
    options.distant = k;
    need(ct_contact_create(&a, &b, &options, &c[k], &e), &e);
  }
  for (int step = 0; step <= 60; step++) {
    memcpy(x, X, 48 * (size_t)nodes);
    for (int i = 0; i < 8; i++) {
      x[3 * faces[i]] += (i < 4 ? -1.0 : 1.0) * 0.04 * step;
      x[3 * turned[i]] += (i < 4 ? 1.0 : -1.0) * 0.04 * step;
    }
    for (int k = 0; k < 2; k++) need(ct_contact_update(c[k], x, x, &e), &e);
    same += ct_contact_energy(c[0]) == ct_contact_energy(c[1]);
    touching += ct_contact_energy(c[0]) > 0.0;
  }
  tap_ok(same == 61 && touching > 10,
         "two quadratic faces that bulge toward each other touch in %d of 61 states", touching);
  for (int k = 0; k < 2; k++) ct_contact_free(c[k]);
  free(X);
  free(x);
  ct_mesh_free(m);
}

/* Force and energy of a box, many cells long or thin, for random displacements that are alike in
 * parts of it: tables or none, any number of threads. */
static void lattices(void)
{
  // The ring of the last two has room for half a block beside what nodes wait for.
  static const int CELLS[][3] = {{1, 1, 1},  {1, 1, 300}, {300, 1, 1},  {1, 300, 1},
                                 {30, 7, 9}, {7, 40, 2},  {100, 1, 13}, {3, 3, 200},
                                 {13, 1, 1}, {1, 9, 70},  {20, 18, 6},  {8, 110, 3}};
  ct_error e;
  for (int i = 0; i < (int)(sizeof CELLS / sizeof *CELLS); i++) {
    const int *n = CELLS[i];
    ct_mesh *m = box_mesh(CT_HEX8, -1, 2, 3, 0.1 * n[0], 0.2 * n[1], 0.3 * n[2], n[0], n[1], n[2]);
    ct_savings on = ct_savings_default();
    double *u = numbers(3 * m->node_count),
           *f[2] = {numbers(3 * m->node_count), numbers(3 * m->node_count)}, energy[2] = {0, 0};
    int same = 0, tried = 0;
    for (int threads = 1; threads <= 5; threads += 2) {
      ct_solid_block block = {
          .mesh = m, .material = STEEL, .savings = &NONE, .threads = threads == 5 ? 2 : threads};
      ct_effect *effect[2];
      void *scratch[2];
      for (int k = 0; k < 2; k++, block.savings = &on) {
        need(create_solid(&block, 1, &effect[k], &e), &e);
        need(effect[k]->create_scratch(effect[k], &scratch[k], &e), &e);
      }
      for (int turn = 0; turn < 6; turn++, tried++) {
        // From the first moving node on, until a last one.
        int first = pick(m->node_count),
            last = turn == 0 ? m->node_count : first + pick(m->node_count - first);
        for (int d = 0; d < 3 * m->node_count; d++)
          u[d] = d >= 3 * first && d < 3 * last ? uniform(1e-3) : 0.3 * (d % 3) + turn;
        for (int k = 0; k < 2; k++) {
          ct_view view = {.threads = threads, .displacement = u, .scratch = scratch[k]};
          need(effect[k]->force(effect[k], &view, f[k], &e), &e);
          need(effect[k]->energy(effect[k], &view, &energy[k], &e), &e);
        }
        same += memcmp(f[0], f[1], 24 * (size_t)m->node_count) == 0 && energy[0] == energy[1];
      }
      for (int k = 0; k < 2; k++) {
        effect[k]->free_scratch(scratch[k]);
        ct_effect_free(effect[k]);
      }
    }
    tap_ok(same == tried, "%d x %d x %d cells: the same force and energy without tables", n[0],
           n[1], n[2]);
    free(u);
    free(f[0]);
    free(f[1]);
    ct_mesh_free(m);
  }
}

/* A scene without contact has no memory, no work and no nodes of one. */
static void without_contact(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene();
  int64_t steps;
  ct_stable_step stable;
  add_body(scene, "block", m, &STEEL, CT_KERNEL_AUTO, 1, 0, 0);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1e-6, .fraction = 0.9, .threads = 1}, &steps, &stable);
  ct_state *state = new_state(problem);
  tap_ok(problem->effect_count == 1 && state->memory_count == 0 && state->impulse_count == 0 &&
             state->work_count == 3 * m->node_count && state->workspace->touched_count == 0,
         "a scene without contact keeps nothing for it");
  ct_state_free(state);
  ct_scene_free(scene);
  ct_mesh_free(m);
}

int main(void)
{
  same_bits((ct_savings){.quiet = 1}, "quiet");
  same_bits((ct_savings){.congruent = 1}, "congruent");
  same_bits((ct_savings){.distant = 1}, "distant");
  same_bits((ct_savings){.quiet = 1, .congruent = 1, .distant = 1}, "all three");
  for (int self = 0; self < 2; self++) {
    flight(CT_HEX8, self);
    flight(CT_HEX20, self);
  }
  bulge();
  lattices();
  without_contact();
  restarts();
  copied_zeros();
  batches();
  eight_batches();
  many_steps();
  long_ring();
  front();
  return tap_done();
}
