/* A host's own observer, written from docs/develop/observers.rst: when it is called, what it may
 * read, its errors, and that it changes neither bits nor memory. */
#include "bodies.h"
#include "counting.h"

/* -- The observer of the page: the largest energy of motion, and how often it was asked for */
typedef struct peak {
  const ct_problem *problem;
  double largest;
  int64_t steps, samples, checks, limit;
} peak;

static ct_status peak_prepare(void *data, const ct_problem *problem, ct_state *state, int64_t count,
                              ct_error *error)
{
  peak *own = data;
  (void)state, (void)error;
  own->problem = problem;
  own->steps += count;
  return CT_OK;
}

static void peak_sample(void *data, const ct_state *state)
{
  peak *own = data;
  own->samples += state->step % 5 == 0;
}

static ct_status peak_check(void *data, ct_state *state, ct_error *error)
{
  peak *own = data;
  ct_energy energy;
  ct_status status = ct_energy_of(own->problem, state, &energy, error);
  if (status == CT_OK) own->largest = fmax(own->largest, energy.kinetic);
  if (++own->checks == own->limit) return CT_ERROR_ENERGY;
  return status;
}

static const ct_observer_calls PEAK = {peak_prepare, peak_sample, peak_check};

static ct_observer peak_observer(peak *own, int64_t every)
{
  return (ct_observer){.calls = &PEAK, .data = own, .every = every};
}
/* -- Its tests */

typedef struct rig {
  ct_mesh *mesh[2];
  ct_scene *scene;
  const ct_problem *problem;
} rig;

/* Two bars that meet; the first one sleeps until then. */
static rig make(void)
{
  rig r = {.mesh = {box_mesh(CT_HEX8, -6, 0, 0, 6, 1, 1, 24, 2, 2),
                    box_mesh(CT_HEX8, 0.01, 0.1, 0, 2, 1, 1, 6, 3, 2)}};
  const ct_material soft = {2.0, 0.3, 1.5, CT_LINEAR};
  r.scene = new_scene_with("left", r.mesh[0], &soft, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(r.scene, "right", r.mesh[1], &soft, CT_KERNEL_AUTO, -0.1, 0, 0);
  add_contact(r.scene, 0, r.mesh[0], 0.0, 1, r.mesh[1], 0.01, 0, 10.0);
  r.problem = build_until(r.scene, 8.0, 0.4);
  return r;
}

static void when_it_is_called(void)
{
  rig r = make();
  ct_state *plain = new_state(r.problem), *state = new_state(r.problem);
  peak own = {0}, rare = {0};
  ct_observer by[] = {peak_observer(&own, 5), peak_observer(&rare, 1000)};
  by[1].last = 1;
  must(ct_run, r.problem, plain, 33, NULL, 0);
  must(ct_run, r.problem, state, 3, by, 1);
  tap_ok(own.samples == 1 && own.checks == 0 && own.steps == 3,
         "3 steps: sampled at step 0, no check");
  must(ct_run, r.problem, state, 30, by, 2);
  tap_ok(own.samples == 7 && own.checks == 6,
         "33 steps: sampled at 0, 5, ... 30 and checked after 5, 10, ... 30");
  tap_ok(rare.checks == 1 && rare.samples == 0, "the other one once, after the last step");
  tap_ok(own.largest > 0.0 && rare.largest > 0.0, "a check may ask for the energy: %g",
         own.largest);
  tap_ok(largest_difference(plain->displacement, state->displacement, 3 * plain->node_count) == 0 &&
             largest_difference(plain->velocity, state->velocity, 3 * plain->node_count) == 0 &&
             largest_difference(plain->work, state->work, plain->work_count) == 0,
         "with elements that sleep and wake: the same bits as without observers");
}

static void with_the_others(void)
{
  rig r = make();
  ct_state *state = new_state(r.problem);
  peak own = {.limit = 3};
  ct_monitor_options options = ct_monitor_options_default();
  ct_monitor *monitor = NULL;
  ct_probes *probes = NULL;
  ct_probe_def def = ct_probe_def_default();
  const int32_t node = 0;
  ct_error e;
  options.every = 4;
  def.name = "tip", def.nodes = &node, def.node_count = 1, def.take[CT_QUANTITY_VELOCITY] = 1;
  must(ct_monitor_create, r.problem, state, &options, &monitor);
  must(ct_probes_create, r.problem, &def, 1, &probes);
  const ct_observer by[] = {ct_monitor_observer(monitor), peak_observer(&own, 6),
                            ct_probes_observer(probes)};
  ct_status status = ct_run(r.problem, state, 40, by, 3, &e);
  ct_probe_history rows;
  need(ct_probes_history(probes, 0, &rows, NULL), NULL);
  tap_ok(status == CT_ERROR_ENERGY && state->step == 18 && rows.row_count == 18 &&
             ct_monitor_good(monitor)->step == 16 && strstr(e.text, "(step 18)") != NULL,
         "monitor, own observer and probes; an error of a check ends the run: %s", e.text);
  own.limit = 0;
  must(ct_run, r.problem, state, 22, by, 3);
  need(ct_probes_history(probes, 0, &rows, NULL), NULL);
  tap_ok(state->step == 40 && rows.row_count == 40 && ct_monitor_good(monitor)->step == 40,
         "and the run goes on from there");
  later_monitor(monitor);
  later_probes(probes);
}

static ct_status refuse(void *data, const ct_problem *problem, ct_state *state, int64_t count,
                        ct_error *error)
{
  (void)data, (void)problem, (void)state, (void)count, (void)error;
  return CT_ERROR_MEMORY;
}

static void arguments(void)
{
  rig r = make();
  ct_state *state = new_state(r.problem);
  static const ct_observer_calls NONE = {NULL, NULL, NULL}, NEVER = {.prepare = refuse};
  const ct_observer none = {.calls = &NONE, .every = 1}, never = {.calls = &NEVER, .every = 1},
                    empty = {.every = 1}, zero = {.calls = &NONE};
  ct_error e;
  tap_ok(ct_run(r.problem, state, 2, &empty, 1, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  tap_ok(ct_run(r.problem, state, 2, &zero, 1, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  tap_ok(ct_run(r.problem, state, 2, NULL, 1, &e) == CT_ERROR_ARGUMENT &&
             ct_run(r.problem, state, 2, &none, -1, &e) == CT_ERROR_ARGUMENT,
         "%s", e.text);
  memset(&e, 1, sizeof e);
  tap_ok(ct_run(r.problem, state, 2, &never, 1, &e) == CT_ERROR_MEMORY && state->step == 0 &&
             e.code == CT_ERROR_MEMORY && e.body == -1 && e.text[0] == 0,
         "an error of prepare without a text: no step is taken, and none is made up");
  tap_ok(ct_run(r.problem, state, 2, &none, 1, &e) == CT_OK && state->step == 2,
         "an observer may have no call that applies");
}

static void no_memory(void)
{
  rig r = make();
  ct_state *state = new_state(r.problem);
  peak own = {0};
  const ct_observer by = peak_observer(&own, 2);
  must(ct_run, r.problem, state, 40, &by, 1);
  long calls = counted.calls;
  must(ct_run, r.problem, state, 40, &by, 1);
  tap_ok(counted.calls == calls && own.checks == 40, "40 steps with 20 checks allocate nothing");
}

int main(void)
{
  ct_set_allocator(&COUNTING, NULL);
  free_at_end();
  when_it_is_called();
  with_the_others();
  arguments();
  no_memory();
  free_pending();
  tap_ok(counted.blocks == 0, "all memory is freed");
  return tap_done();
}
