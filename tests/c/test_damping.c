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
  ct_damping damping = {.rate = 2.0};
  need(ct_damping_create_effect(&damping, joined, &effect, &e), &e);
  need(ct_scene_add_effect(scene, effect, &e), &e);
  const ct_problem *problem = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.2, .threads = 1}, &steps, &stable);
  double W = 4.0 / (free_step.dt * free_step.dt);
  tap_close(stable.dt / (4.0 / (2.0 + sqrt(4.0 + 4.0 * W))), 1.0, 1e-12, "the stable step knows the rate (%g of the undamped one)", stable.dt / free_step.dt);
  ct_state *state = NULL;
  need(ct_state_create(problem, &state, &e), &e);
  // v at -1/2 is chosen so that the mean of both halves is the given velocity.
  double start = state->velocity[0], off = 0.0;
  ct_energy now, first;
  need(ct_energy_of(problem, state, &first, &e), &e);
  for (int64_t n = 1; n <= steps; n++) {
    need(ct_step(problem, state, &e), &e);
    off = worst(off, state->velocity[0] / (start * pow(1.0 - 2.0 * problem->dt, (double)n)) - 1.0);
  }
  need(ct_energy_of(problem, state, &now, &e), &e);
  tap_close(off, 0.0, 1e-12, "velocity falls by 1 - alpha dt in every step (%d steps)", (int)steps);
  tap_close(state->velocity[0] / 3.0, exp(-2.0), 0.05 * exp(-2.0), "that is near exp(-alpha t)");
  tap_close(now.total / first.total, 1.0, 1e-12, "what is lost stands as work in the ledger");
  tap_close(now.balance / first.kinetic, 0.0, 1e-13, "the work balance closes");
  double work;
  need(ct_energy_work(problem, state, 1, &work, &e), &e);
  tap_ok(work < 0.0 && fabs(work + first.kinetic - now.kinetic) < 1e-12 * first.kinetic, "the work is the loss of kinetic energy (%g)", work);
  ct_state_free(state);
  damping.rate = -1.0;
  tap_ok(ct_damping_create_effect(&damping, joined, &effect, &e) == CT_INVALID, "a negative rate: %s", e.text);
  ct_scene_free(scene);
  ct_mesh_free(mesh);
}

int main(void)
{
  decay();
  return tap_done();
}
