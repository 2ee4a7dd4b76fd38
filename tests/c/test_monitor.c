/* Faults of a run: each is named with time, body and element or node before the numbers are lost,
 * the last good state is kept, and nothing else changes. */
#include "../../libcontact/src/step/monitor.c"

#include "bodies.h"

static const double PI = 3.14159265358979323846;
static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR};
static const ct_scene_time HALF = {.end = 1.0, .fraction = 0.5};

static ct_monitor *new_watch(const ct_problem *problem, ct_state *state, ct_monitor_options options)
{
  ct_monitor *monitor = NULL;
  must(ct_monitor_create, problem, state, &options, &monitor);
  return later_monitor(monitor);
}

static int finite(const ct_problem *p, const ct_state *s)
{
  for (int64_t d = 0; d < 3 * (int64_t)p->node_count; d++)
    if (!isfinite(s->displacement[d]) || !isfinite(s->velocity[d])) return 0;
  return 1;
}

static ct_monitor_options every(int64_t steps)
{
  ct_monitor_options options = ct_monitor_options_default();
  options.every = steps;
  return options;
}

/* A bar of St. Venant-Kirchhoff's material, ν = 0, is stretched evenly: P'(λ) = E (3 λ² - 1) / 2,
 * and the largest frequency of ten elements between held ends is 2 c / h sin(9 π / 20): Courant
 * number f of the start is too much from λ² = (2 / (f sin)² + 1) / 3 on
 * (eq:step-quotient). */
static void stiffening(void)
{
  static const ct_material bar = {2.0, 0.0, 2.0, CT_ST_VENANT_KIRCHHOFF};
  double f = 0.9, rate = 0.0002, critical = sqrt((2.0 / pow(f * sin(0.45 * PI), 2.0) + 1.0) / 3.0);
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 10, 1, 1, 10, 1, 1),
          *other = box_mesh(CT_HEX8, 0, 5, 0, 2, 2, 2, 1, 1, 1);
  ct_scene *scene = new_scene_with("other", other, &bar, CT_KERNEL_AUTO, 0, 0, 0);
  double *v = numbers(3 * m->node_count);
  for (int n = 0; n < m->node_count; n++) v[3 * n] = rate * m->nodes[3 * n];
  ct_error e = {0};
  add_moving_body(scene, "bar", m, &bar, CT_KERNEL_AUTO, v);
  add_support(scene, 1, m, 0, 0.0, "x", 0.0);
  add_support(scene, 1, m, 0, 10.0, "x", 10.0 * rate);
  add_support(scene, 1, m, -1, 0.0, "yz", 0.0);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1000.0, .courant = f}, &steps, NULL);
  ct_state *state = new_state(p);
  ct_monitor *monitor = new_watch(p, state, every(4));
  ct_status status =
      ct_run(state->problem, state, steps, (ct_observer[]){ct_monitor_observer(monitor)}, 1, &e);
  double stretch = 1.0 + rate * state->time;
  tap_ok(status == CT_ERROR_STEP && e.code == status && e.body == 1 && e.element >= 0 &&
             e.element < 10 && strstr(e.text, "bar") && strstr(e.text, "step "),
         "a solid that stiffens ends the run: %s", e.text);
  tap_ok(stretch > critical && stretch < critical + 0.01, "at the stretch %.5f, in theory %.5f",
         stretch, critical);
  tap_ok(finite(p, state) && ct_monitor_good(monitor)->step < state->step &&
             ct_monitor_good(monitor)->step >= state->step - 4,
         "before the motion has grown");
}

/* A step above the limit of a linear body: the total of the ledger stays as it was, the motion
 * explodes (eq:energy-grows). */
static void growth(double over)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2),
          *still = box_mesh(CT_HEX8, 5, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("still", still, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  double *v = numbers(3 * m->node_count);
  for (int i = 0; i < 3 * m->node_count; i++) v[i] = uniform(1.0);
  ct_error e = {0};
  add_moving_body(scene, "moving", m, &SOFT, CT_KERNEL_AUTO, v);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, HALF, &steps, &stable);
  ct_problem q = *p;
  double *rest = numbers(3 * p->node_count);
  q.dt = over * 2.0 / sqrt(true_frequency(p, rest, 1e-3, -1, 400));
  ct_state *state = new_state(&q);
  ct_monitor_options options = every(16);
  options.stable = stable.dt;
  ct_monitor *monitor = new_watch(&q, state, options);
  ct_status status =
      ct_run(state->problem, state, 20000, (ct_observer[]){ct_monitor_observer(monitor)}, 1, &e);
  if (over > 1.0)
    tap_ok(status == CT_ERROR_ENERGY && e.body == 1 && e.point >= 0 && e.point < m->node_count &&
               finite(&q, state) && finite(&q, ct_monitor_good(monitor)),
           "a step %.4f of the limit: %s", over, e.text);
  else
    tap_ok(status == CT_OK && state->step == 20000,
           "a step %.4f of the limit: no error in 20000 steps", over);
  free_monitor(monitor);
  close_run(state, scene, m);
}

/* A force c m v that declares a stored energy and stores none: kinetic energy grows as exp(2 c t).
 */
static ct_status pump_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  const double *c = effect->data;
  (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++) force[i] = c[0] * c[1] * view->velocity[i];
  return CT_OK;
}

static ct_status pump_energy(const ct_effect *effect, const ct_view *view, double *energy,
                             ct_error *error)
{
  (void)effect, (void)view, (void)error;
  *energy = 0.0;
  return CT_OK;
}

/* Its growth is a fault from the limit on (eq:energy-appears). */
static void pump(double limit, int stores)
{
  static const ct_effect_calls calls[2] = {{.force = pump_force},
                                           {.force = pump_force, .energy = pump_energy}};
  double c[2] = {0.01, SOFT.density / 8.0}, when = log(1.0 + limit) / (2.0 * c[0]);
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("flying", m, &SOFT, CT_KERNEL_AUTO, 1.0, 0, 0);
  ct_effect filled = {.label = "pump", .calls = &calls[stores], .data = c, .node_count = 8};
  ct_error e = {0};
  add_effect(scene, &filled);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 100.0, .fraction = 0.2}, &steps, NULL);
  ct_state *state = new_state(p);
  ct_monitor_options options = every(2);
  options.energy_limit = limit;
  ct_monitor *monitor = new_watch(p, state, options);
  ct_status status =
      ct_run(state->problem, state, steps, (ct_observer[]){ct_monitor_observer(monitor)}, 1, &e);
  if (stores)
    tap_ok(status == CT_ERROR_ENERGY && e.body == 0 && state->time > when &&
               state->time < when + 2.5 * p->dt,
           "a spurious fraction of %.2f at t = %.4g, in theory %.4g: %s", limit, state->time, when,
           e.text);
  else tap_ok(status == CT_OK, "the same work by an external force is no error");
}

/* The same force on some nodes; from t = 10 on it removes more than it gave before. */
static ct_status pump_and_brake(const ct_effect *effect, const ct_view *view, double *force,
                                ct_error *error)
{
  const double *c = effect->data;
  (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++)
    force[i] =
        (view->time < 10.0 ? c[0] : -3.0 * c[0]) * c[1] * view->velocity[3 * effect->nodes[0] + i];
  return CT_OK;
}

/* Growth below the limit of a fault, which is gone at the end, is reported: its size, time and
 * place. `unit` is the unit of energy (eq:energy-growth). An effect that brakes first and pumps
 * then is told before it has given back what it took (eq:growth-again). */
static void told(int stores, double unit, int again)
{
  static const ct_effect_calls calls[2] = {{.force = pump_and_brake},
                                           {.force = pump_and_brake, .energy = pump_energy}};
  double c[2] = {again ? -0.01 : 0.01, unit * SOFT.density / 8.0}, least = again ? exp(-0.2) : 1.0,
         limit = again ? 0.01 : 0.002, most = again ? exp(0.4) : exp(0.2),
         when = again ? 10.0 + log(1.0 + limit / least) / 0.06 : log(1.0 + limit) / 0.02;
  ct_material soft = SOFT;
  soft.young *= unit, soft.density *= unit;
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("still", m, &soft, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "flying", m, &soft, CT_KERNEL_AUTO, 1.0, 0, 0);
  int32_t nodes[8];
  for (int i = 0; i < 8; i++) nodes[i] = 8 + i;
  ct_effect filled = {
      .label = "pump", .calls = &calls[stores], .data = c, .nodes = nodes, .node_count = 8};
  ct_error e = {0};
  add_effect(scene, &filled);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 20.0, .fraction = 0.05}, &steps, NULL);
  ct_state *state = new_state(p);
  ct_monitor *monitor = new_watch(p, state, every(2));
  ct_status status =
      ct_run(state->problem, state, 2, (ct_observer[]){ct_monitor_observer(monitor)}, 1, &e);
  int silent = ct_monitor_growth(monitor).ratio == 0.0;
  if (status == CT_OK)
    status = ct_run(state->problem, state, steps - 2, (ct_observer[]){ct_monitor_observer(monitor)},
                    1, &e);
  ct_growth found = ct_monitor_growth(monitor);
  double left = energy_of(p, state).kinetic / (0.5 * unit * SOFT.density);
  if (stores)
    tap_ok(status == CT_OK && silent && (again || left < 0.9) && found.ratio > limit &&
               found.ratio < limit + 0.008 && found.time > when &&
               found.time < when + 2.5 * p->dt && found.effect == 1 && found.body == 1 &&
               found.step > 0 && fabs(found.largest - (most - least)) < 0.02,
           "unit %g: %.4f spurious at t = %.4g, in theory %.4g, by effect %d on body %d; %.4f at "
           "most, "
           "%.2f left at the end",
           unit, found.ratio, found.time, when, (int)found.effect, (int)found.body, found.largest,
           left);
  else
    tap_ok(status == CT_OK && found.ratio == 0.0,
           "unit %g: the same work by an external force is no growth", unit);
}

/* Two blocks of 6 and 4 units of volume: ε Σ V (Λ + 2μ) = ε Σ V E (1 - ν) / ((1 + ν) (1 - 2ν))
 * (eq:energy-floor). And from which energies on a run fails (eq:energy-appears, eq:energy-grows) or
 * a growth is reported (eq:energy-growth). */
static void least_energy(void)
{
  static const ct_material STIFF = {30.0, 0.25, 5.0, CT_LINEAR};
  ct_mesh *lower = box_mesh(CT_HEX8, 0, 0, 0, 1, 2, 3, 2, 2, 2),
          *upper = box_mesh(CT_HEX8, 0, 0, 5, 2, 2, 1, 2, 2, 2);
  ct_scene *scene = new_scene_with("lower", lower, &STIFF, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "upper", upper, &STIFF, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *p = build_until(scene, 1.0, 0.5);
  tap_close(floor_of(p) / DBL_EPSILON, 10.0 * 30.0 * 0.75 / (1.25 * 0.5), 1e-9,
            "the energy that counts as rounding");

  ct_state *state = new_state(p);
  ct_monitor_options options = every(1);
  options.energy_limit = 0.1;
  ct_monitor *monitor = new_watch(p, state, options);
  monitor->swing = 0.7;
  for (int more = 0; more < 2; more++) {
    double part = more ? 1.0 + 1e-9 : 1.0 - 1e-9;
    ct_error e;
    energies of = {.appeared = part * 0.1 * 3.0, .most_expected = 3.0};
    tap_ok((check_energy(monitor, state, &of, &e) != CT_OK) == more, "energy from nothing, %s",
           more ? "too much" : "not yet");
    of = (energies){.elastic = part * 1.1 * 3.0 / 0.7, .most_expected = 3.0};
    tap_ok((check_energy(monitor, state, &of, &e) != CT_OK) == more, "a growing oscillation, %s",
           more ? "too much" : "not yet");
    of = (energies){.appeared = part * 0.002 * 3.0, .most_expected = 3.0};
    note_growth(monitor, state, &of);
    tap_close(monitor->growth.ratio, more * part * 0.002, 1e-12, "the growth that is reported");
  }
}

/* An inverted element, and a NaN, during a run. */
static void named(int bad)
{
  static const ct_material large = {2.0, 0.3, 1.5, CT_NEO_HOOKEAN};
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 4, 1, 1, 4, 1, 1);
  ct_scene *scene = new_scene_with("first", m, &large, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "second", m, &large, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *p = build(scene, HALF, NULL, NULL);
  ct_state *state = new_state(p);
  ct_monitor *monitor = new_watch(p, state, every(2));
  ct_error e = {0};
  must(ct_run, state->problem, state, 5, (ct_observer[]){ct_monitor_observer(monitor)}, 1);
  for (int n = 0; n < m->node_count; n++)
    if (m->nodes[3 * n] > 3.9) state->velocity[3 * (m->node_count + n)] = bad ? NAN : -1.5 / p->dt;
  // A host that steps by itself, as several processes do, is told the same by the check.
  ct_state *alone = new_state(p);
  must(ct_state_copy, p, state, alone);
  if (!bad) advance(p, alone, 1);
  ct_status status = ct_monitor_check(monitor, alone, &e);
  tap_ok(status != CT_OK && e.body == 1 && strstr(e.text, "second") && strstr(e.text, "(step ") &&
             (bad || strstr(e.text, "element 3")),
         "the check: %s", e.text);
  status = ct_run(state->problem, state, 4, (ct_observer[]){ct_monitor_observer(monitor)}, 1, &e);
  if (bad)
    tap_ok((status == CT_ERROR_BLOWUP || status == CT_INVALID) && e.body == 1 && e.point >= 0 &&
               strstr(e.text, "second") && strstr(e.text, "(step "),
           "not a number: %s", e.text);
  else
    tap_ok(status == CT_ERROR_GEOMETRY && e.body == 1 && e.element == 3 &&
               strstr(e.text, "second") && strstr(e.text, "element 3") && strstr(e.text, "(step "),
           "an inverted element: %s", e.text);
  tap_ok(ct_monitor_good(monitor)->step == 4 && finite(p, ct_monitor_good(monitor)),
         "the state of step 4 was good");
  // It goes on from there to the same bits as a run in which nothing happened.
  ct_state *straight = new_state(p);
  must(ct_state_copy, p, ct_monitor_good(monitor), state);
  advance(p, state, 6);
  advance(p, straight, 10);
  tap_ok(memcmp(straight->displacement, state->displacement,
                3 * (size_t)p->node_count * sizeof(double)) == 0,
         "and continues with the same bits");
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("one", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  ct_stable_step stable;
  const ct_problem *p = build(scene, HALF, NULL, &stable);
  ct_state *state = new_state(p);
  ct_monitor *monitor = NULL;
  ct_monitor_options good = ct_monitor_options_default(), bad[5] = {good, good, good, good, good};
  ct_error e;
  bad[0].every = 0, bad[1].energy_limit = NAN, bad[2].omega_limit = 0.0, bad[3].stable = -1.0,
  bad[4].growth_limit = -0.1;
  int refused = 0;
  for (int i = 0; i < 5; i++)
    refused += ct_monitor_create(p, state, &bad[i], &monitor, &e) == CT_ERROR_ARGUMENT;
  tap_ok(refused == 5 && monitor == NULL, "options out of range are refused");
  tap_ok(ct_monitor_create(p, NULL, &good, &monitor, &e) == CT_ERROR_ARGUMENT &&
             ct_monitor_create(NULL, state, &good, &monitor, NULL) == CT_ERROR_ARGUMENT &&
             ct_run(p, state, 1, (ct_observer[]){ct_monitor_observer(NULL)}, 1, &e) ==
                 CT_ERROR_ARGUMENT &&
             ct_monitor_check(NULL, state, &e) == CT_ERROR_ARGUMENT &&
             ct_monitor_good(NULL) == NULL && ct_monitor_growth(NULL).ratio == 0.0,
         "null arguments are refused");
  ct_monitor_free(NULL);
}

int main(void)
{
  free_at_end();
  stiffening();
  growth(1.0005);
  growth(1.2);
  growth(0.9995);
  pump(0.1, 1);
  pump(0.5, 1);
  pump(0.1, 0);
  told(1, 1.0, 0);
  told(1, 1e-12, 0);
  told(1, 1e12, 0);
  told(1, 1.0, 1);
  told(0, 1.0, 0);
  least_energy();
  named(0);
  named(1);
  refusals();
  return tap_done();
}
