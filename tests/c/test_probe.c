/* Probes: rows are the values that a host would see step by step, the state's bits do not change,
 * nothing is allocated in a step, and invalid definitions are refused. */
#include "bodies.h"
#include "counting.h"

static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR};
enum { STEPS = 40, PROBES = 4 };

/* Two bars that meet; the far end of the left one flies asleep, and is fixed there. */
typedef struct rig {
  ct_mesh *mesh[2];
  ct_scene *scene;
  const ct_problem *problem;
  int32_t contact, support;
} rig;

static rig make(ct_scheme scheme, int threads, int mirrored)
{
  rig r = {.contact = -1, .support = -1};
  double side = mirrored ? -1.0 : 1.0;
  ct_mesh *left = box_mesh(CT_HEX8, -6, 0, 0, 6, 1, 1, 24, 2, 2),
          *right = box_mesh(CT_HEX8, 0.01, 0.1, 0, 2, 1, 1, 6, 3, 2);
  r.mesh[0] = mirrored ? mirror_mesh(left, 0) : left;
  r.mesh[1] = mirrored ? mirror_mesh(right, 0) : right;
  r.scene = new_scene_with("left", r.mesh[0], &SOFT, CT_KERNEL_AUTO, 0.05 * side, 0, 0);
  add_body(r.scene, "right", r.mesh[1], &SOFT, CT_KERNEL_AUTO, -0.1 * side, 0, 0);
  add_rough_contact(r.scene, 0, r.mesh[0], 0.0, 1, r.mesh[1], 0.01 * side, 0, 10.0, 0.3, 0.0);
  add_support(r.scene, 0, r.mesh[0], 0, -6.0 * side, "x", 0.05 * side);
  set_threads(r.scene, threads);
  r.problem = build_by(scheme, r.scene, 8.0, 0.4, NULL);
  for (int32_t k = 0; k < r.problem->effect_count; k++) {
    if (r.problem->effects[k]->kind == CT_EFFECT_CONTACT) r.contact = k;
    if (r.problem->effects[k]->kind == CT_EFFECT_SUPPORT) r.support = k;
  }
  return r;
}

static int32_t node_at(const rig *r, double x, double y, double z)
{
  const double *X = r->problem->reference, at[3] = {x, y, z};
  for (int32_t n = 0; n < r->problem->node_count; n++)
    if (largest_difference(&X[3 * (int64_t)n], at, 3) < 1e-12) return n;
  printf("Bail out! no node at %g %g %g\n", x, y, z);
  exit(1);
}

/* A node far away, a face, contact with friction on the left body, and the support. */
static ct_probes *probe_all(const rig *r, double side, int64_t every)
{
  static int32_t body[75 * 3], face[9];
  static int32_t far;
  int32_t count = r->mesh[0]->node_count, effects[2] = {r->contact, r->contact + 1}, on = 0;
  ct_probe_def def[PROBES];
  ct_probes *probes = NULL;
  for (int i = 0; i < PROBES; i++) def[i] = ct_probe_def_default();
  far = node_at(r, -2.0 * side, 0.5, 0.5);
  def[0].name = "far";
  def[0].nodes = &far;
  def[0].node_count = 1;
  def[0].element = 4;
  for (int q = CT_QUANTITY_DISPLACEMENT; q <= CT_QUANTITY_PRESSURE; q++) def[0].take[q] = 1;
  for (int32_t n = 0; n < count; n++) {
    if (n < 225) body[n] = n;
    if (fabs(r->problem->reference[3 * (int64_t)n]) < 1e-12) face[on++] = n;
  }
  def[1].name = "face";
  def[1].nodes = face;
  def[1].node_count = on;
  def[1].take[CT_QUANTITY_DISPLACEMENT] = def[1].take[CT_QUANTITY_ACCELERATION] = 1;
  def[1].every = every;
  def[2].name = "contact";
  def[2].nodes = body;
  def[2].node_count = count;
  def[2].effects = effects;
  def[2].effect_count = 2;
  def[2].take[CT_QUANTITY_FORCE] = def[2].take[CT_QUANTITY_MOMENT] = 1;
  def[3].name = "support";
  def[3].effects = &r->support;
  def[3].effect_count = 1;
  def[3].take[CT_QUANTITY_FORCE] = 1;
  must(ct_probes_create, r->problem, def, PROBES, &probes);
  return later_probes(probes);
}

static ct_probe_history history_of(const ct_probes *probes, int32_t i)
{
  ct_probe_history history = {.rows = NULL};
  ct_probes_history(probes, i, &history, NULL);
  return history;
}

/* Position of a quantity in the row of a step, whose number is given. */
static const double *entry(const ct_probes *probes, int32_t i, int64_t row, ct_quantity quantity)
{
  ct_probe_history h = history_of(probes, i);
  return row < h.row_count && h.column[quantity] >= 0 ? &h.rows[row * h.width + h.column[quantity]]
                                                      : NULL;
}

static int same(const double *x, const double *y, int64_t count)
{
  return x != NULL && y != NULL && memcmp(x, y, (size_t)count * sizeof *x) == 0;
}

/* A host that takes single steps and computes the values after each. */
static void rows_are_what_a_host_sees(ct_scheme scheme)
{
  rig r = make(scheme, 1, 0);
  const ct_problem *p = r.problem;
  ct_state *probed = new_state(p), *plain = new_state(p), *hand = new_state(p);
  ct_probes *probes = probe_all(&r, 1.0, 3);
  int32_t far = node_at(&r, -2, 0.5, 0.5);
  int64_t count = 3 * (int64_t)p->node_count, bad = 0;
  double *v = numbers(count), *force[3] = {numbers(count), numbers(count), numbers(count)},
         *stress = numbers(6 * (int64_t)r.mesh[0]->element_count), off = 0.0, top = 0.0;
  must(ct_run, probed->problem, probed, STEPS, (ct_observer[]){ct_probes_observer(probes)}, 1);
  must(ct_run, p, plain, STEPS, NULL, 0);
  tap_ok(same_state(probed, plain) && probed->element_updates[0] == plain->element_updates[0] &&
             (scheme != CT_CENTRAL_DIFFERENCE || plain->element_updates[1] > 0),
         "%s: the state has the bits of %d steps without probes, and as many elements slept",
         SCHEME(scheme), STEPS);
  must(ct_probes_sample, probes, probed);
  must(ct_probes_sample, probes, probed);
  tap_ok(history_of(probes, 0).row_count == STEPS + 1 &&
             history_of(probes, 1).row_count == STEPS / 3 + 1,
         "a row of every step and of the last state, once; or of every third");
  for (int n = 0; n <= STEPS; n++) {
    must(ct_state_velocity, p, hand, v);
    must(ct_solid_stress, r.mesh[0], &SOFT, hand->displacement, stress);
    for (int k = 0; k < 3; k++)
      must(ct_state_force, p, hand, k < 2 ? r.contact + k : r.support, force[k]);
    double sum[3] = {0}, held[3] = {0}, moment[3] = {0};
    for (int32_t i = 0; i < p->node_count; i++)
      for (int c = 0; c < 3; c++) {
        int64_t d = 3 * (int64_t)i, a = d + (c + 1) % 3, b = d + (c + 2) % 3;
        held[c] += force[2][d + c];
        if (i >= r.mesh[0]->node_count) continue;
        for (int k = 0; k < 2; k++) {
          sum[c] += force[k][d + c];
          moment[c] += (p->reference[a] + hand->displacement[a]) * force[k][b] -
                       (p->reference[b] + hand->displacement[b]) * force[k][a];
        }
      }
    bad += entry(probes, 0, n, CT_QUANTITY_TIME)[0] != hand->time;
    bad += !same(entry(probes, 0, n, CT_QUANTITY_DISPLACEMENT), &hand->displacement[3 * far], 3);
    bad += !same(entry(probes, 0, n, CT_QUANTITY_VELOCITY), &v[3 * far], 3);
    bad += !same(entry(probes, 0, n, CT_QUANTITY_STRESS), &stress[6 * 4], 6);
    off = fmax(off, largest_difference(entry(probes, 2, n, CT_QUANTITY_FORCE), sum, 3));
    off = fmax(off, largest_difference(entry(probes, 2, n, CT_QUANTITY_MOMENT), moment, 3));
    off = fmax(off, largest_difference(entry(probes, 3, n, CT_QUANTITY_FORCE), held, 3));
    top = fmax(top, largest(sum, 3));
    if (n < STEPS) must(ct_step, p, hand);
  }
  tap_ok(bad == 0, "motion and stress have the bits of the state at every step");
  tap_ok(top > 1e-3, "and there is contact (force up to %g)", top);
  tap_close(off, 0.0, 1e-13 * top, "resultants are the sums of the forces, added by hand");
}

/* The rows of a run that is split into series of steps, as by a monitor. */
static void monitor_takes_the_same_rows(void)
{
  rig r = make(CT_CENTRAL_DIFFERENCE, 1, 0);
  ct_state *one = new_state(r.problem), *other = new_state(r.problem);
  ct_probes *probes[2] = {probe_all(&r, 1.0, 1), probe_all(&r, 1.0, 1)};
  ct_monitor_options options = ct_monitor_options_default();
  ct_monitor *monitor = NULL;
  options.every = 7;
  must(ct_monitor_create, r.problem, other, &options, &monitor);
  later_monitor(monitor);
  const ct_observer both[] = {ct_monitor_observer(monitor), ct_probes_observer(probes[1])};
  must(ct_run, one->problem, one, STEPS, (ct_observer[]){ct_probes_observer(probes[0])}, 1);
  must(ct_run, other->problem, other, STEPS / 2, both, 2);
  must(ct_run, other->problem, other, STEPS - STEPS / 2, both, 2);
  int good = 1;
  for (int32_t i = 0; i < PROBES; i++) {
    ct_probe_history a = history_of(probes[0], i), b = history_of(probes[1], i);
    good = good && a.row_count == STEPS && b.row_count == STEPS &&
           largest_difference(a.rows, b.rows, STEPS * a.width) == 0.0;
  }
  tap_ok(good, "a monitor that checks every 7 steps: the same rows");
  // Back to where the monitor's good state is, and again: what was later is taken anew.
  must(ct_state_copy, r.problem, ct_monitor_good(monitor), other);
  int64_t back = other->step;
  must(ct_run, other->problem, other, 1, both, 2);
  ct_probe_history b = history_of(probes[1], 0), a = history_of(probes[0], 0);
  tap_ok(back == 35 && b.row_count == back + 1 &&
             largest_difference(a.rows, b.rows, b.row_count * b.width) == 0.0,
         "from a copy of an earlier state: the later rows are dropped and recorded again");
}

/* Probes that begin when the sleeping elements are known already, as after a restart. */
static void late_probes_take_the_same_rows(void)
{
  rig r = make(CT_CENTRAL_DIFFERENCE, 1, 0);
  ct_state *one = new_state(r.problem), *other = new_state(r.problem);
  int32_t asleep = node_at(&r, -5, 0.5, 0.5);
  ct_probe_def def = ct_probe_def_default();
  ct_probes *probes[2];
  ct_monitor_options options = ct_monitor_options_default();
  ct_monitor *monitor = NULL;
  const int64_t begin = 3, more = STEPS - begin;
  def.name = "asleep", def.nodes = &asleep, def.node_count = 1;
  def.take[CT_QUANTITY_DISPLACEMENT] = 1;
  for (int i = 0; i < 2; i++) {
    must(ct_probes_create, r.problem, &def, 1, &probes[i]);
    later_probes(probes[i]);
  }
  must(ct_run, r.problem, one, STEPS, (ct_observer[]){ct_probes_observer(probes[0])}, 1);
  must(ct_run, r.problem, other, begin, NULL, 0);
  must(ct_monitor_create, r.problem, other, &options, &monitor);
  later_monitor(monitor);
  const ct_observer both[] = {ct_monitor_observer(monitor), ct_probes_observer(probes[1])};
  must(ct_monitor_check, monitor, other);
  must(ct_run, r.problem, other, more, both, 2);
  const ct_probe_history a = history_of(probes[0], 0), b = history_of(probes[1], 0);
  tap_ok(b.row_count == more && same(&a.rows[begin * a.width], b.rows, more * a.width),
         "probes that begin after %d steps: the rows of those that began at once", (int)begin);
}

/* Another number of threads, and the mirror image. */
static void same_bits_elsewhere(void)
{
  rig r = make(CT_CENTRAL_DIFFERENCE, 1, 0), threads = make(CT_CENTRAL_DIFFERENCE, 2, 0),
      image = make(CT_CENTRAL_DIFFERENCE, 1, 1);
  rig *all[3] = {&r, &threads, &image};
  ct_probes *probes[3];
  for (int i = 0; i < 3; i++) {
    ct_state *state = new_state(all[i]->problem);
    probes[i] = probe_all(all[i], i == 2 ? -1.0 : 1.0, 1);
    must(ct_run, state->problem, state, STEPS, (ct_observer[]){ct_probes_observer(probes[i])}, 1);
  }
  ct_probe_history a = history_of(probes[0], 2), b = history_of(probes[1], 2),
                   c = history_of(probes[2], 2);
  tap_ok(same(a.rows, b.rows, STEPS * a.width), "two threads: the same bits of force and moment");
  // A force turns its x, a moment its y and z.
  int bad = 0;
  for (int64_t n = 0; n < STEPS; n++)
    for (int k = 1; k < 7; k++)
      bad += a.rows[n * 7 + k] != (k == 1 || k > 4 ? -1.0 : 1.0) * c.rows[n * 7 + k];
  tap_ok(bad == 0, "the mirror image: the mirrored numbers, all bits");
}

/* Memory for the rows is allocated before the steps, one block per probe. */
static void nothing_is_allocated_in_a_step(void)
{
  rig r = make(CT_CENTRAL_DIFFERENCE, 1, 0);
  ct_state *state = new_state(r.problem);
  ct_probes *probes = probe_all(&r, 1.0, 1);
  ct_error e;
  long before = counted.calls;
  must(ct_run, r.problem, state, STEPS, NULL, 0);
  long plain = counted.calls - before;
  before = counted.calls;
  must(ct_run, state->problem, state, STEPS, (ct_observer[]){ct_probes_observer(probes)}, 1);
  long probed = counted.calls - before;
  tap_ok(plain == 0 && probed == PROBES, "%ld blocks of memory in %d steps, %ld with %d probes",
         plain, STEPS, probed, PROBES);
  int64_t rows = history_of(probes, 0).row_count;
  counted.last_call = counted.calls;
  ct_status status =
      ct_run(state->problem, state, 100000, (ct_observer[]){ct_probes_observer(probes)}, 1, &e);
  counted.last_call = -1;
  tap_ok(status == CT_ERROR_MEMORY && state->step == 2 * STEPS &&
             history_of(probes, 0).row_count == rows,
         "no memory for rows: no step is taken (%s)", e.text);
}

static void refusals(void)
{
  rig r = make(CT_CENTRAL_DIFFERENCE, 1, 0);
  ct_probe_def good = ct_probe_def_default(), bad[11];
  static const int32_t nodes[2] = {3, 5}, turned[2] = {5, 3}, effect = 99;
  ct_probes *probes = NULL;
  ct_error e;
  good.name = "p";
  good.nodes = nodes;
  good.node_count = 2;
  good.take[CT_QUANTITY_VELOCITY] = 1;
  for (int i = 0; i < 11; i++) bad[i] = good;
  bad[0].cookie = 0;
  bad[1].name = NULL;
  bad[2].name = "a/b";
  bad[3].take[CT_QUANTITY_VELOCITY] = 0;
  bad[4].every = 0;
  bad[5].nodes = turned;
  bad[6].nodes = NULL;
  bad[7].take[CT_QUANTITY_STRESS] = 1;
  bad[8].take[CT_QUANTITY_FORCE] = 1;
  bad[9] = bad[8], bad[9].effects = &effect, bad[9].effect_count = 1;
  bad[10].node_count = -1;
  for (int i = 0; i < 11; i++) {
    ct_status status = ct_probes_create(r.problem, &bad[i], 1, &probes, &e);
    tap_ok(status == CT_ERROR_ARGUMENT && probes == NULL, "refused: %s", e.text);
  }
  ct_probe_def two[2] = {good, good};
  tap_ok(ct_probes_create(r.problem, two, 2, &probes, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "two probes are called p") != NULL,
         "refused: %s", e.text);
  rig other = make(CT_CENTRAL_DIFFERENCE, 1, 0);
  ct_state *foreign = new_state(other.problem);
  ct_probe_history history;
  must(ct_probes_create, r.problem, &good, 1, &probes);
  tap_ok(ct_run(foreign->problem, foreign, 1, (ct_observer[]){ct_probes_observer(probes)}, 1, &e) ==
                 CT_ERROR_ARGUMENT &&
             foreign->step == 0,
         "a state of another problem: %s", e.text);
  tap_ok(ct_probes_history(probes, 1, &history, NULL) == CT_ERROR_ARGUMENT &&
             ct_probes_restore(probes, 1, NULL, 0, &e) == CT_ERROR_ARGUMENT,
         "there is no second probe");
  ct_probes_free(probes);
  ct_probes_free(NULL);
}

/* Rows continue at the same times when the step is divided (eq:step-change). */
static void a_divided_step_keeps_the_times(void)
{
  rig r = make(CT_CENTRAL_DIFFERENCE, 1, 0);
  static const int32_t nodes[2] = {2, 5};
  ct_probe_def def = ct_probe_def_default();
  ct_probes *probes;
  ct_error e;
  def.name = "p";
  def.nodes = nodes;
  def.node_count = 2;
  def.every = 2;
  def.take[CT_QUANTITY_DISPLACEMENT] = 1;
  ct_problem fine = *r.problem;
  fine.dt = r.problem->dt / 3;
  ct_state *state = new_state(r.problem), *next = new_state(&fine);
  must(ct_probes_create, r.problem, &def, 1, &probes);
  must(ct_run, state->problem, state, 5, (ct_observer[]){ct_probes_observer(probes)}, 1);
  must(ct_state_subdivide_step, &fine, state, next);
  tap_ok(ct_probes_subdivide_step(probes, &fine, 0, &e) == CT_ERROR_ARGUMENT &&
             ct_probes_subdivide_step(probes, NULL, 3, &e) == CT_ERROR_ARGUMENT,
         "refused: %s", e.text);
  must(ct_probes_subdivide_step, probes, &fine, 3);
  must(ct_run, next->problem, next, 16, (ct_observer[]){ct_probes_observer(probes)}, 1);
  ct_probe_history history;
  need(ct_probes_history(probes, 0, &history, NULL), &e);
  double off = 0.0;
  for (int64_t i = 0; i < history.row_count; i++)
    off = worst(off, history.rows[i * history.width] / (2.0 * r.problem->dt) - (double)i);
  tap_ok(history.row_count == 6 && off < 1e-14, "a row every second of the first steps (%g)", off);
  ct_probes_free(probes);
  free_state(next); // its problem ends here
}

int main(void)
{
  ct_set_allocator(&COUNTING, NULL);
  free_at_end();
  a_divided_step_keeps_the_times();
  for (int s = 0; s < CT_SCHEME_COUNT; s++) rows_are_what_a_host_sees((ct_scheme)s);
  monitor_takes_the_same_rows();
  late_probes_take_the_same_rows();
  same_bits_elsewhere();
  nothing_is_allocated_in_a_step();
  refusals();
  free_pending();
  tap_ok(counted.blocks == 0, "all memory is given back (%ld blocks)", counted.blocks);
  return tap_done();
}
