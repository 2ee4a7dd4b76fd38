/* Faults of a run: each is named with time, body and element or node before the numbers are lost, the last good state is kept,
 * and nothing else changes. */
#include "bodies.h"

static const double PI = 3.14159265358979323846;
static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR};
static const ct_scene_time HALF = {.end = 1.0, .fraction = 0.5, .threads = 1};

static ct_watch *new_watch(const ct_problem *problem, ct_state *state, ct_watch_options options)
{
  ct_watch *watch = NULL;
  ct_error e;
  need(ct_watch_create(problem, state, &options, &watch, &e), &e);
  return watch;
}

static int finite(const ct_problem *p, const ct_state *s)
{
  for (int64_t d = 0; d < 3 * (int64_t)p->node_count; d++)
    if (!isfinite(s->displacement[d]) || !isfinite(s->velocity[d])) return 0;
  return 1;
}

static ct_watch_options every(int64_t steps)
{
  ct_watch_options options = ct_watch_options_default();
  options.every = steps;
  return options;
}

/* Two blocks of large deformation that collide: looked at after every third step, or not at all. */
static void same_bits(void)
{
  static const ct_material large = {2.0, 0.3, 1.5, CT_NEO_HOOKEAN};
  ct_mesh *left = box_mesh(CT_HEX8, -1, 0, 0, 1, 1, 1, 2, 2, 2), *right = box_mesh(CT_HEX8, 0.01, 0, 0, 1, 1, 1, 3, 2, 2);
  ct_scene *scene = new_scene();
  add_body(scene, "left", left, &large, CT_KERNEL_AUTO, 0.1, 0, 0);
  add_body(scene, "right", right, &large, CT_KERNEL_AUTO, -0.1, 0, 0);
  add_rough_contact(scene, 0, left, 0.0, 1, right, 0.01, 0, 1.0, 0.3, 0.0);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 3.0, .fraction = 0.5, .threads = 1}, &steps, &stable);
  ct_state *plain = new_state(p), *watched = new_state(p);
  ct_watch *watch = new_watch(p, watched, every(3));
  ct_error e;
  advance(p, plain, steps);
  ct_status status = ct_watch_steps(watch, watched, steps / 2, &e);
  if (status == CT_OK) status = ct_watch_steps(watch, watched, steps - steps / 2, &e);
  size_t n = 3 * (size_t)p->node_count * sizeof(double);
  tap_ok(status == CT_OK && watched->step == steps && memcmp(plain->displacement, watched->displacement, n) == 0 && memcmp(plain->velocity, watched->velocity, n) == 0 &&
             memcmp(plain->memory, watched->memory, (size_t)plain->memory_count * sizeof(double)) == 0 &&
             memcmp(plain->work, watched->work, (size_t)plain->work_count * sizeof(double)) == 0,
         "looks change no bit of %d steps", (int)steps);
  const ct_state *good = ct_watch_good(watch);
  tap_ok(good != NULL && good->step == steps / 3 * 3, "the last good state is that of the last look, step %d", good == NULL ? -1 : (int)good->step);
  double real = true_frequency(p, good->displacement, 1e-6, -1, 300), found = ct_watch_omega_squared(watch);
  // Contact stands in the true one; the quotient never exceeds it, and 170 looks bring it near.
  tap_ok(found <= real * (1.0 + 1e-4) && found > 0.9 * real, "its quotient is %.4f of the largest eigenvalue", found / real);
  ct_watch_free(watch);
  ct_state_free(plain);
  ct_state_free(watched);
  ct_scene_free(scene);
  ct_mesh_free(left);
  ct_mesh_free(right);
}

/* A bar of St. Venant-Kirchhoff's material, ν = 0, is stretched evenly: P'(λ) = E (3 λ² - 1) / 2, and the largest frequency of
 * ten elements between held ends is 2 c / h sin(9 π / 20): Courant number f of the start is too much from λ² = (2 / (f sin)² + 1)
 * / 3 on. */
static void stiffening(void)
{
  static const ct_material bar = {2.0, 0.0, 2.0, CT_ST_VENANT_KIRCHHOFF};
  double f = 0.9, rate = 0.0002, critical = sqrt((2.0 / pow(f * sin(0.45 * PI), 2.0) + 1.0) / 3.0);
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 10, 1, 1, 10, 1, 1), *other = box_mesh(CT_HEX8, 0, 5, 0, 2, 2, 2, 1, 1, 1);
  ct_scene *scene = new_scene();
  add_body(scene, "other", other, &bar, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "bar", m, &bar, CT_KERNEL_AUTO, 0, 0, 0);
  double *v = numbers(3 * m->node_count);
  for (int n = 0; n < m->node_count; n++) v[3 * n] = rate * m->nodes[3 * n];
  ct_error e = {0};
  need(ct_scene_set_velocity(scene, 1, v, &e), &e);
  add_support(scene, 1, m, 0, 0.0, "x", 0.0);
  add_support(scene, 1, m, 0, 10.0, "x", 10.0 * rate);
  add_support(scene, 1, m, -1, 0.0, "yz", 0.0);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1000.0, .courant = f, .threads = 1}, &steps, &stable);
  ct_state *state = new_state(p);
  ct_watch *watch = new_watch(p, state, every(4));
  tap_close(ct_watch_omega_squared(watch) * 0.25, pow(sin(0.45 * PI), 2.0), 0.1, "12 rounds find the frequency of the start");
  ct_status status = ct_watch_steps(watch, state, steps, &e);
  double stretch = 1.0 + rate * state->time;
  tap_ok(status == CT_ERROR_STEP && e.code == status && e.body == 1 && e.element >= 0 && e.element < 10 && strstr(e.text, "bar") && strstr(e.text, "step "),
         "a solid that stiffens ends the run: %s", e.text);
  tap_ok(stretch > critical && stretch < critical + 0.01, "at the stretch %.5f, in theory %.5f", stretch, critical);
  tap_ok(finite(p, state) && ct_watch_good(watch)->step < state->step && ct_watch_good(watch)->step >= state->step - 4, "before anything has grown");
  ct_watch_free(watch);
  ct_state_free(state);
  ct_scene_free(scene);
  ct_mesh_free(m);
  ct_mesh_free(other);
  free(v);
}

/* A step above the limit of a linear body: the total of the ledger stays as it was, the motion explodes. */
static void growth(double over)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2), *still = box_mesh(CT_HEX8, 5, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  add_body(scene, "still", still, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "moving", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  double *v = numbers(3 * m->node_count);
  for (int i = 0; i < 3 * m->node_count; i++) v[i] = uniform(1.0);
  ct_error e = {0};
  need(ct_scene_set_velocity(scene, 1, v, &e), &e);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, HALF, &steps, &stable);
  ct_problem q = *p;
  double *rest = numbers(3 * p->node_count);
  q.dt = over * 2.0 / sqrt(true_frequency(p, rest, 1e-3, -1, 400));
  ct_state *state = new_state(&q);
  ct_watch_options options = every(16);
  options.stable = stable.dt;
  ct_watch *watch = new_watch(&q, state, options);
  ct_status status = ct_watch_steps(watch, state, 20000, &e);
  if (over > 1.0)
    tap_ok(status == CT_ERROR_ENERGY && e.body == 1 && e.point >= 0 && e.point < m->node_count && finite(&q, state) && finite(&q, ct_watch_good(watch)),
           "a step %.4f of the limit: %s", over, e.text);
  else
    tap_ok(status == CT_OK && state->step == 20000, "a step %.4f of the limit: no word in 20000 steps", over);
  ct_watch_free(watch);
  ct_state_free(state);
  ct_scene_free(scene);
  ct_mesh_free(m);
  ct_mesh_free(still);
  free(v);
  free(rest);
}

/* A force c m v that claims to store energy and stores none: kinetic energy grows as exp(2 c t). */
static ct_status pump_force(const ct_effect *effect, const ct_view *view, double *force, ct_error *error)
{
  const double *c = effect->data;
  (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++) force[i] = c[0] * c[1] * view->velocity[i];
  return CT_OK;
}

static ct_status pump_energy(const ct_effect *effect, const ct_view *view, double *energy, ct_error *error)
{
  (void)effect, (void)view, (void)error;
  *energy = 0.0;
  return CT_OK;
}

static void pump(double limit, int stores)
{
  double c[2] = {0.01, SOFT.density / 8.0}, when = log(1.0 + limit) / (2.0 * c[0]);
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  add_body(scene, "flying", m, &SOFT, CT_KERNEL_AUTO, 1.0, 0, 0);
  ct_effect filled = {.name = "pump", .data = c, .node_count = 8, .force = pump_force, .energy = stores ? pump_energy : NULL}, *effect = NULL;
  const ct_problem *joined = NULL;
  ct_error e = {0};
  need(ct_scene_join(scene, &joined, &e), &e);
  need(ct_effect_create(&filled, &effect, &e), &e);
  need(ct_scene_add_effect(scene, effect, &e), &e);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 100.0, .fraction = 0.2, .threads = 1}, &steps, &stable);
  ct_state *state = new_state(p);
  ct_watch_options options = every(2);
  options.energy_limit = limit;
  ct_watch *watch = new_watch(p, state, options);
  ct_status status = ct_watch_steps(watch, state, steps, &e);
  if (stores)
    tap_ok(status == CT_ERROR_ENERGY && e.body == 0 && state->time > when && state->time < when + 2.5 * p->dt, "a share of %.2f from nothing at t = %.4g, in theory %.4g: %s", limit,
           state->time, when, e.text);
  else
    tap_ok(status == CT_OK, "the same work by a force from outside is no fault");
  ct_watch_free(watch);
  ct_state_free(state);
  ct_scene_free(scene);
  ct_mesh_free(m);
}

/* An element that is turned inside out, and a number that is none, in mid-run. */
static void named(int bad)
{
  static const ct_material large = {2.0, 0.3, 1.5, CT_NEO_HOOKEAN};
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 4, 1, 1, 4, 1, 1);
  ct_scene *scene = new_scene();
  add_body(scene, "first", m, &large, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "second", m, &large, CT_KERNEL_AUTO, 0, 0, 0);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, HALF, &steps, &stable);
  ct_state *state = new_state(p);
  ct_watch *watch = new_watch(p, state, every(2));
  ct_error e = {0};
  need(ct_watch_steps(watch, state, 5, &e), &e);
  for (int n = 0; n < m->node_count; n++)
    if (m->nodes[3 * n] > 3.9) state->velocity[3 * (m->node_count + n)] = bad ? NAN : -1.5 / p->dt;
  ct_status status = ct_watch_steps(watch, state, 4, &e);
  if (bad)
    tap_ok((status == CT_ERROR_BLOWUP || status == CT_INVALID) && e.body == 1 && e.point >= 0 && strstr(e.text, "second") && strstr(e.text, "(step "), "no number: %s", e.text);
  else
    tap_ok(status == CT_ERROR_GEOMETRY && e.body == 1 && e.element == 3 && strstr(e.text, "second") && strstr(e.text, "element 3") && strstr(e.text, "(step "),
           "inside out: %s", e.text);
  tap_ok(ct_watch_good(watch)->step == 4 && finite(p, ct_watch_good(watch)), "the state of step 4 was good");
  // It goes on from there to the same bits as a run in which nothing happened.
  ct_state *straight = new_state(p);
  need(ct_state_copy(p, ct_watch_good(watch), state, &e), &e);
  advance(p, state, 6);
  advance(p, straight, 10);
  tap_ok(memcmp(straight->displacement, state->displacement, 3 * (size_t)p->node_count * sizeof(double)) == 0, "and goes on to the same bits");
  ct_watch_free(watch);
  ct_state_free(straight);
  ct_state_free(state);
  ct_scene_free(scene);
  ct_mesh_free(m);
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  add_body(scene, "one", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, HALF, &steps, &stable);
  ct_state *state = new_state(p);
  ct_watch *watch = NULL;
  ct_watch_options good = ct_watch_options_default(), bad[4] = {good, good, good, good};
  ct_error e;
  bad[0].every = 0, bad[1].energy_limit = NAN, bad[2].omega_limit = 0.0, bad[3].stable = -1.0;
  int refused = 0;
  for (int i = 0; i < 4; i++) refused += ct_watch_create(p, state, &bad[i], &watch, &e) == CT_ERROR_ARGUMENT;
  tap_ok(refused == 4 && watch == NULL, "options out of range are refused");
  tap_ok(ct_watch_create(p, NULL, &good, &watch, &e) == CT_ERROR_ARGUMENT && ct_watch_create(NULL, state, &good, &watch, NULL) == CT_ERROR_ARGUMENT &&
             ct_watch_steps(NULL, state, 1, &e) == CT_ERROR_ARGUMENT && ct_watch_look(NULL, state, &e) == CT_ERROR_ARGUMENT && ct_watch_good(NULL) == NULL &&
             ct_watch_omega_squared(NULL) == 0.0,
         "and so is nothing at all");
  ct_watch_free(NULL);
  ct_state_free(state);
  ct_scene_free(scene);
  ct_mesh_free(m);
}

int main(void)
{
  same_bits();
  stiffening();
  growth(1.0005);
  growth(1.2);
  growth(0.9995);
  pump(0.1, 1);
  pump(0.5, 1);
  pump(0.1, 0);
  named(0);
  named(1);
  refusals();
  return tap_done();
}
