/* Damped motion. */
#include "bodies.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};

/* Each step takes the share alpha dt of the velocity: (1 - alpha dt)^n, near exp(-alpha t)
 * (eq:damping-force, eq:damping-decay). */
static void decay(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene();
  const ct_problem *joined = NULL;
  ct_effect *effect = NULL;
  ct_error e = {0};
  int64_t steps;
  ct_stable_step stable, free_step;
  add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, 3, -4, 0);
  build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.2}, &steps, &free_step);
  need(ct_scene_join(scene, &joined, &e), &e);
  ct_damping_def damping = {COOKIE, .rate = 2.0};
  add_made(scene, ct_damping_create_effect, &damping);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.2}, &steps, &stable);
  double W = 4.0 / (free_step.dt * free_step.dt);
  tap_close(stable.dt / (4.0 / (2.0 + sqrt(4.0 + 4.0 * W))), 1.0, 1e-12,
            "the stable step includes the rate (%g of the undamped one)", stable.dt / free_step.dt);
  ct_state *state = new_state(problem);
  // v at -1/2 is chosen so that the mean of both halves is the given velocity.
  double start = state->velocity[0], off = 0.0;
  ct_energy now, first;
  first = energy_of(problem, state);
  for (int64_t n = 1; n <= steps; n++) {
    advance(problem, state, 1);
    off = worst(off, state->velocity[0] / (start * pow(1.0 - 2.0 * problem->dt, (double)n)) - 1.0);
  }
  now = energy_of(problem, state);
  tap_close(off, 0.0, 1e-12,
            "velocity decreases by the factor 1 - alpha dt in each step (%d steps)", (int)steps);
  tap_close(state->velocity[0] / 3.0, exp(-2.0), 0.05 * exp(-2.0),
            "this is close to exp(-alpha t)");
  tap_close(now.total / first.total, 1.0, 1e-12, "the lost energy is work in the energy balance");
  tap_close(now.balance / first.kinetic, 0.0, 1e-13, "the work balance closes");
  double work;
  need(ct_energy_work(problem, state, 1, &work, &e), &e);
  tap_ok(work < 0.0 && fabs(work + first.kinetic - now.kinetic) < 1e-12 * first.kinetic,
         "the work is the loss of kinetic energy (%g)", work);
  ct_state_free(state);
  damping.rate = -1.0;
  tap_ok(ct_damping_create_effect(&damping, joined, &effect, &e) == CT_INVALID,
         "a negative rate: %s", e.text);
  ct_scene_free(scene);
  ct_mesh_free(mesh);
}

/* A rate above the highest frequency: the stable step is 1 / alpha, where a free mass stops in one
 * step; a longer one, with which the kinetic energy would be negative, is refused by the scene and
 * by the effect. (eq:damping-sign) */
static void strong(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  const double rate = 1000.0;
  const ct_problem *problem = NULL;
  ct_stable_step stable;
  ct_error e = {0};
  int64_t steps;
  add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, 3, -4, 0);
  ct_damping_def damping = {COOKIE, .rate = rate};
  add_made(scene, ct_damping_create_effect, &damping);
  tap_ok(ct_scene_build(scene, &(ct_scene_time){.end = 1.0, .dt = 1.2 / rate}, &problem, &steps,
                        NULL, &e) == CT_ERROR_STEP,
         "strong damping: %s", e.text);
  problem = build(scene, (ct_scene_time){.end = 1.0, .fraction = 1.0}, &steps, &stable);
  tap_close(stable.dt * rate, 1.0, 1e-14, "the stable step is 1 / alpha");
  ct_state *state = new_state(problem);
  double least = 0.0;
  for (int n = 0; n < 20; n++) {
    advance(problem, state, 1);
    least = fmin(least, energy_of(problem, state).kinetic);
  }
  tap_ok(least > -1e-12, "the kinetic energy is not negative (%g)", least);
  ct_state_free(state);
  ct_problem longer = *problem;
  longer.dt = 1.2 / rate;
  tap_ok(ct_state_create(&longer, &state, &e) == CT_ERROR_STEP, "a host's own problem: %s", e.text);
  ct_scene_free(scene);
  ct_mesh_free(mesh);
}

/* One cube along its length, an oscillator with k = E h and m = rho h^3 / 2, relaxes like a loop
 * that is written here: the same rates and the same motion (eq:relaxation-rate,
 * eq:relaxation-force). */
static void relaxation_by_hand(void)
{
  static const ct_material bar = {.young = 9.0, .poisson = 0.0, .density = 2.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  int32_t body = add_body(scene, "cube", mesh, &bar, CT_KERNEL_AUTO, 0.1, 0, 0);
  add_support(scene, body, mesh, 0, 0.0, "xyz", 0.0);
  ct_damping_def damping = {COOKIE, .relaxation = 1};
  add_made(scene, ct_damping_create_effect, &damping);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 10.0, .fraction = 0.1}, NULL, NULL);
  ct_state *state = new_state(problem);
  double k = 9.0, m = 1.0, dt = problem->dt, u = 0.0, v = 0.1, rate = 0.0, off = 0.0;
  double u0 = 0.0, f0 = 0.0, age = 0.0;
  for (int n = 1; n <= 80; n++) {
    double f = -k * u;
    if (age == 0.0 || 0.5 * rate * dt * age >= 1.0 || rate == 0.0) {
      double square = -(u - u0) * (f - f0) / ((u - u0) * m * (u - u0));
      if (age > 0.0 && square > 0.0) rate = 2.0 * sqrt(square);
      u0 = u, f0 = f, age = 0.0;
    }
    age += 1.0;
    double a = 0.5 * rate * dt;
    v = ((1.0 - a) * v + dt * f / m) / (1.0 + a);
    u += dt * v;
    advance(problem, state, 1);
    off = worst(off, state->displacement[3 * (mesh->node_count - 1)] - u);
  }
  tap_close(rate, 2.0 * 3.0, 1e-12, "one oscillator: the rate is twice its frequency");
  tap_close(off, 0.0, 1e-14, "and its motion is that of a loop by hand");
  close_run(state, scene, mesh);
}

/* The residual of a bar that swings, from forces and velocities: the larger of two ratios
 * (eq:residual). */
static void residual_by_hand(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 4, 1, 1, 4, 1, 1);
  ct_scene *scene = new_scene();
  int32_t body = add_body(scene, "bar", mesh, &SOFT, CT_KERNEL_AUTO, 0.3, 0, 0);
  add_support(scene, body, mesh, 0, 0.0, "xyz", 0.0);
  ct_gravity_def gravity = {COOKIE, .acceleration = {20, 0, 0}};
  add_made(scene, ct_gravity_create_effect, &gravity);
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, NULL);
  ct_state *state = new_state(p);
  ct_error e;
  double off = 0.0, *force = numbers(3 * p->node_count), *total = numbers(3 * p->node_count);
  int by_forces = 0, by_energy = 0;
  for (int n = 0; n < 60; n++) {
    double residual, sum = 0.0, most = 0.0, kinetic = 0.0, stored = 0.0;
    advance(p, state, 1);
    need(ct_energy_residual(p, state, &residual, &e), &e);
    memset(total, 0, 3 * (size_t)p->node_count * sizeof *total);
    for (int32_t k = 0; k < p->effect_count; k++) {
      double own;
      need(ct_energy_stored(p, state, k, &own, &e), &e);
      need(ct_state_force(p, state, k, force, &e), &e);
      stored += fabs(own);
      for (int d = 0; d < 3 * p->node_count; d++)
        total[d] += force[d], most = fmax(most, fabs(force[d]));
    }
    for (int d = 0; d < 3 * p->node_count; d++) {
      sum = fmax(sum, p->inverse_mass[d] == 0.0 ? 0.0 : fabs(total[d]));
      kinetic += 0.5 * p->mass[d / 3] * state->velocity[d] * state->velocity[d];
    }
    off = worst(off, residual - fmax(sum / most, sqrt(kinetic / stored)));
    by_forces += sum / most > sqrt(kinetic / stored), by_energy += residual > 1.01 * sum / most;
  }
  tap_ok(by_forces > 3 && by_energy > 3, "forces decide in %d states, energies in %d", by_forces,
         by_energy);
  tap_close(off, 0.0, 1e-12, "the residual is the larger ratio");
  free(force), free(total);
  close_run(state, scene, mesh);
}

/* A bar that hangs on one end comes to rest with u(x) = rho g (L x - x² / 2) / E, which linear
 * elements have exactly at their nodes. */
static void relaxation(void)
{
  static const ct_material bar = {.young = 900.0, .poisson = 0.0, .density = 1.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 10, 0.5, 0.5, 20, 1, 1);
  ct_scene *scene = new_scene();
  int32_t body = add_body(scene, "bar", mesh, &bar, CT_KERNEL_AUTO, 0, 0, 0);
  add_support(scene, body, mesh, 0, 0.0, "xyz", 0.0);
  const ct_problem *joined = NULL;
  ct_effect *effect = NULL;
  ct_error e = {0};
  need(ct_scene_join(scene, &joined, &e), &e);
  ct_gravity_def gravity = {COOKIE, .acceleration = {10, 0, 0}};
  add_made(scene, ct_gravity_create_effect, &gravity);
  ct_damping_def damping = {COOKIE, .relaxation = 1, .rate = 3.0};
  tap_ok(ct_damping_create_effect(&damping, joined, &effect, &e) == CT_ERROR_ARGUMENT,
         "relaxation and a rate: %s", e.text);
  damping.rate = 0.0;
  add_made(scene, ct_damping_create_effect, &damping);
  int64_t steps;
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 40.0, .fraction = 0.9}, &steps, NULL);
  ct_state *state = new_state(problem), *other = new_state(problem);
  double unrest = 0.0, work = 0.0, balance = 0.0, off = 0.0;
  need(ct_energy_residual(problem, state, &unrest, &e), &e);
  tap_ok(unrest > 0.9, "at the start no force balances the weight: residual %g", unrest);
  ct_energy energy = {0}, first = energy_of(problem, state);
  for (unrest = 1.0; state->step < steps && unrest > 1e-9;) {
    if (state->step == 200) need(ct_state_copy(problem, state, other, &e), &e);
    advance(problem, state, 1);
    need(ct_energy_residual(problem, state, &unrest, &e), &e);
    need(ct_energy_work(problem, state, 2, &work, &e), &e);
    energy = energy_of(problem, state);
    balance = worst(balance, energy.balance / energy.strain);
  }
  for (int n = 0; n < problem->node_count; n++) {
    double x = problem->reference[3 * n];
    off = worst(off, state->displacement[3 * n] - 10.0 * (10.0 * x - 0.5 * x * x) / 900.0);
  }
  tap_ok(unrest <= 1e-9 && state->step < 600,
         "relaxation comes to rest in %d steps, 4 L / c is %.1f steps", (int)state->step,
         40.0 / 30.0 / problem->dt);
  tap_ok(off < 1e-8, "in the static solution, off by %.2g of %.2g", off, 500.0 / 900.0);
  tap_ok(balance < 1e-12, "the work balance closes (%.2g)", balance);
  // The weight does the work 2 E_strain, and the motion began with the discrete kinetic energy of
  // -dt/2 and dt/2, which is below 0.
  tap_close((work + first.kinetic) / energy.strain, -1.0, 1e-8,
            "damping has dissipated half the work of the weight, the other half is strain (%g)",
            energy.strain);
  while (other->step < state->step) advance(problem, other, 1);
  tap_ok(memcmp(other->displacement, state->displacement,
                3 * (size_t)problem->node_count * sizeof(double)) == 0,
         "a restart has the same bits");
  ct_state_free(state);
  close_run(other, scene, mesh);
}

/* The residual without any stiffness: 0 at rest, infinite in free flight. */
static void unrest_of_free_bodies(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_error e;
  for (int flies = 0; flies < 2; flies++) {
    ct_scene *scene = new_scene();
    double unrest;
    add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, flies, 0, 0);
    const ct_problem *problem =
        build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, NULL);
    ct_state *state = new_state(problem);
    need(ct_energy_residual(problem, state, &unrest, &e), &e);
    tap_ok(flies ? unrest > 1e300 : unrest == 0.0, "a body that %s: residual %g",
           flies ? "flies" : "lies there", unrest);
    ct_state_free(state);
    ct_scene_free(scene);
  }
  ct_mesh_free(mesh);
}

int main(void)
{
  decay();
  strong();
  relaxation_by_hand();
  residual_by_hand();
  relaxation();
  unrest_of_free_bodies();
  return tap_done();
}
