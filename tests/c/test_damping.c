/* Motion that dies away. */
#include "bodies.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};

/* Each step takes the share alpha dt of the velocity: (1 - alpha dt)^n, near exp(-alpha t). */
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
  build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.2, .threads = 1}, &steps, &free_step);
  need(ct_scene_join(scene, &joined, &e), &e);
  ct_damping_def damping = {COOKIE, .rate = 2.0};
  add_made(scene, ct_damping_create_effect, &damping);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.2, .threads = 1}, &steps, &stable);
  double W = 4.0 / (free_step.dt * free_step.dt);
  tap_close(stable.dt / (4.0 / (2.0 + sqrt(4.0 + 4.0 * W))), 1.0, 1e-12,
            "the stable step knows the rate (%g of the undamped one)", stable.dt / free_step.dt);
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
  tap_close(off, 0.0, 1e-12, "velocity falls by 1 - alpha dt in every step (%d steps)", (int)steps);
  tap_close(state->velocity[0] / 3.0, exp(-2.0), 0.05 * exp(-2.0), "that is near exp(-alpha t)");
  tap_close(now.total / first.total, 1.0, 1e-12, "what is lost stands as work in the ledger");
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
      build(scene, (ct_scene_time){.end = 40.0, .fraction = 0.9, .threads = 1}, &steps, NULL);
  ct_state *state = new_state(problem), *other = new_state(problem);
  double unrest = 0.0, work = 0.0, balance = 0.0, off = 0.0;
  need(ct_energy_residual(problem, state, &unrest, &e), &e);
  tap_ok(unrest > 0.9, "at the start nothing balances the weight: unrest %g", unrest);
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
            "damping has taken half the work of the weight, the other half is strain (%g)",
            energy.strain);
  while (other->step < state->step) advance(problem, other, 1);
  tap_ok(memcmp(other->displacement, state->displacement,
                3 * (size_t)problem->node_count * sizeof(double)) == 0,
         "a restart has the same bits");
  ct_state_free(state);
  close_run(other, scene, mesh);
}

/* Unrest without anything that resists: 0 where nothing happens, infinite where a body flies. */
static void unrest_of_free_bodies(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_error e;
  for (int flies = 0; flies < 2; flies++) {
    ct_scene *scene = new_scene();
    double unrest;
    add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, flies, 0, 0);
    const ct_problem *problem =
        build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5, .threads = 1}, NULL, NULL);
    ct_state *state = new_state(problem);
    need(ct_energy_residual(problem, state, &unrest, &e), &e);
    tap_ok(flies ? unrest > 1e300 : unrest == 0.0, "a body that %s: unrest %g",
           flies ? "flies" : "lies there", unrest);
    ct_state_free(state);
    ct_scene_free(scene);
  }
  ct_mesh_free(mesh);
}

int main(void)
{
  decay();
  relaxation();
  unrest_of_free_bodies();
  return tap_done();
}
