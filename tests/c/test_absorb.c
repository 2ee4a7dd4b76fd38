/* Absorbing boundaries. */
#include "bodies.h"

static const ct_material ROCK = {.young = 900.0, .poisson = 0.25, .density = 2.0};

static void add_faces(ct_scene *scene, const ct_mesh *mesh, double x, const ct_load_def *load)
{
  ct_effect *effect = NULL;
  int32_t *faces = integers(8 * 6 * mesh->element_count),
          count = ct_mesh_plane_faces(mesh, 0, x, faces, NULL);
  const ct_problem *joined = join_scene(scene);
  if (load != NULL) {
    ct_load_def own = *load;
    own.kind = ct_brick_face_kind(mesh->kind), own.faces = faces, own.face_count = count;
    must(ct_load_create_effect, &own, joined, &effect);
  } else {
    ct_absorb_def absorb = {COOKIE, ct_brick_face_kind(mesh->kind), count, faces};
    must(ct_absorb_create_effect, &absorb, joined, &effect);
  }
  must(ct_scene_add_effect, scene, effect);
}

/* Send a smooth pulse down a column, fixed so that it is a plane P wave (axis 0) or S wave (axis
 * 2), and measure the reflection at the other end (eq:absorb-traction, eq:absorb-force,
 * eq:absorb-share, eq:absorb-rate). */
static void pulse(ct_brick_kind kind, int axis, const char *name)
{
  ct_mesh *mesh = box_mesh(kind, 0, 0, 0, 10, 0.1, 0.1, kind == CT_HEX8 ? 100 : 50, 1, 1);
  ct_scene *scene = new_scene_with("column", mesh, &ROCK, CT_KERNEL_AUTO, 0, 0, 0);
  add_support(scene, 0, mesh, -1, 0.0, axis == 0 ? "yz" : "xy", 0.0);
  double c[2], time[41], value[41];
  ct_material_speeds(&ROCK, &c[0], &c[1]);
  double speed = c[axis != 0], width = 4.0 / speed;
  for (int i = 0; i <= 40; i++)
    time[i] = width * i / 40, value[i] = pow(sin(3.14159265358979 * i / 40), 2);
  ct_load_def push = {COOKIE, .amplitude = {41, time, value}};
  push.traction[axis] = 1.0;
  add_faces(scene, mesh, 0.0, &push);
  add_faces(scene, mesh, 10.0, NULL);
  int64_t steps;
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 16.0 / speed, .fraction = 0.9}, &steps, NULL);
  ct_state *state = new_state(problem);
  advance(problem, state, (int64_t)(6.0 / speed / problem->dt));
  ct_energy before = energy_of(problem, state);
  advance(problem, state, steps - state->step);
  ct_energy after = energy_of(problem, state);
  double share = (after.kinetic + after.strain) / (before.kinetic + before.strain), work;
  tap_ok(share < 0.01 && share >= 0.0, "%s: %.2g of the energy is reflected", name, share);
  must(ct_energy_work, problem, state, 2, &work);
  tap_close(work / -(before.kinetic + before.strain), 1.0, 0.01,
            "%s: the dashpots absorbed the rest", name);
  tap_close(after.balance / before.kinetic, 0.0, 1e-12, "%s: the work balance closes", name);
  double rate = 0.0, unused;
  must(ct_stable_contribution, problem, state, 2, &unused, &rate);
  // The end nodes of a linear column have half an element of mass: rho c A / (rho A h / 2).
  if (kind == CT_HEX8)
    tap_close(rate / (2 * c[0] / 0.1), 1.0, 1e-12, "%s: the rate is that of the end nodes", name);
  // A mid-side has 16/76 of a Q8 face (∫N² = 32/45 there, 2/15 at a corner), and 2/31 of a brick.
  if (kind == CT_HEX20)
    tap_close(rate / (16.0 / 76.0 / (2.0 / 31.0) * c[0] / 0.2), 1.0, 1e-12,
              "%s: the rate is that of the mid-sides", name);
}

static void refusals(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  ct_effect *effect = NULL;
  ct_error e = {0};
  static const int32_t both[8] = {0, 1, 3, 2, 8, 9, 11, 10};
  add_body(scene, "one", mesh, &ROCK, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "two", mesh, &ROCK, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *joined = join_scene(scene);
  ct_absorb_def bad = {COOKIE, CT_Q4, 2, both};
  tap_ok(ct_absorb_create_effect(&bad, joined, &effect, &e) == CT_ERROR_ARGUMENT,
         "faces of two bodies: %s", e.text);
  bad.face_count = 0;
  tap_ok(ct_absorb_create_effect(&bad, joined, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "no faces: %s", e.text);
}

int main(void)
{
  free_at_end();
  pulse(CT_HEX8, 0, "hex8, P wave");
  pulse(CT_HEX8, 2, "hex8, S wave");
  pulse(CT_HEX20, 0, "hex20, P wave");
  pulse(CT_HEX20, 2, "hex20, S wave");
  refusals();
  return tap_done();
}
