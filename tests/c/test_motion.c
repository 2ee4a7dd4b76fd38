/* Amplitudes, displacements that follow one, the forces for that, and refused definitions. */
#include "../../libcontact/src/base/amplitude.h"
#include "bodies.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};

static const ct_problem *moved(ct_scene *scene, const ct_motion *motions, int32_t count, double end,
                               double fraction, int64_t *steps)
{
  ct_effect *effect = NULL;
  const ct_problem *joined = join_scene(scene);
  must(create_motion, motions, count, joined, &effect);
  must(ct_scene_add_effect, scene, effect);
  return build(scene, (ct_scene_time){.end = end, .fraction = fraction}, steps, NULL);
}

/* A distorted block whose base follows a motion, waits and comes back, while the rest is free
 * (eq:motion-velocity, eq:motion-force). */
static void there_and_back(ct_brick_kind kind)
{
  static const double time[4] = {0.0, 0.3, 0.5, 0.9}, value[4] = {0.0, 1.0, 1.0, -0.5};
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 2, 2, 2, 4);
  distort_inside(m, 0.04);
  ct_scene *scene = new_scene();
  int32_t body = add_body(scene, "block", m, &SOFT, CT_KERNEL_AUTO, 0.1, -0.2, 0.3), base[64],
          count = ct_mesh_plane_nodes(m, 2, 0.0, base);
  add_support(scene, body, m, 2, 0.0, "x", 0.0);
  ct_motion motion = {.nodes = base,
                      .node_count = count,
                      .fixed = {0, 0, 1},
                      .displacement = {0, 0, 0.2},
                      .amplitude = {4, time, value}};
  int64_t steps;
  const ct_problem *p = moved(scene, &motion, 1, 1.0, 0.5, &steps);
  ct_state *state = new_state(p), *other = new_state(p);
  ct_energy energy, first = energy_of(p, state);
  ct_momentum start = momentum_of(p, state, body), now;
  double *force = numbers(3 * p->node_count), path = 0.0, work = 0.0, total = 0.0, balance = 0.0,
         impulse = 0.0, own, scale = 0.0;
  for (int64_t n = 0; n < steps; n++) {
    if (n == steps / 2) must(ct_state_copy, p, state, other);
    must(ct_state_force, p, state, 1, force);
    double before[64];
    for (int i = 0; i < count; i++) before[i] = state->velocity[3 * base[i] + 2];
    advance(p, state, 1);
    // The work of a force at t_n goes over half the way before and half the way after; before t = 0
    // there is none.
    for (int i = 0; i < count; i++)
      work += 0.5 * p->dt * force[3 * base[i] + 2] *
              (state->velocity[3 * base[i] + 2] + (n == 0 ? 0.0 : before[i]));
    double at = ct_amplitude_value(&motion.amplitude, state->time) * 0.2;
    for (int i = 0; i < count; i++) path = worst(path, state->displacement[3 * base[i] + 2] - at);
    energy = energy_of(p, state);
    now = momentum_of(p, state, body);
    for (int c = 0; c < 3; c++)
      impulse = worst(impulse, now.p[c] - start.p[c] - now.support_impulse[c]);
    scale = fmax(scale, energy.strain);
    total = worst(total, energy.total - first.total);
    balance = worst(balance, energy.balance);
  }
  must(ct_state_force, p, state, 1, force);
  for (int i = 0; i < count; i++)
    work += 0.5 * p->dt * force[3 * base[i] + 2] * state->velocity[3 * base[i] + 2];
  must(ct_energy_work, p, state, 1, &own);
  tap_ok(path < 1e-13, "kind %d: the base is where the amplitude has it, off by %.2g", kind, path);
  tap_close((own - work) / scale, 0.0, 1e-12,
            "kind %d: the energy balance has the work of the reaction", kind);
  tap_ok(total < 1e-12 * scale && balance < 1e-12 * scale,
         "kind %d: total energy constant to %.2g, balance %.2g of the strain energy", kind,
         total / scale, balance / scale);
  tap_ok(impulse < 1e-11,
         "kind %d: change of momentum is the impulse of support and motion, off by %.2g", kind,
         impulse);
  while (other->step < state->step) advance(p, other, 1);
  tap_ok(memcmp(other->displacement, state->displacement,
                3 * (size_t)p->node_count * sizeof(double)) == 0,
         "kind %d: a restart has the same bits", kind);
}

/* A block with all nodes prescribed that accelerates: the reaction is its mass times the
 * acceleration (eq:motion-force). */
static void inertia(void)
{
  enum { POINTS = 400 };
  double time[POINTS], value[POINTS];
  for (int i = 0; i < POINTS; i++) time[i] = 0.01 * i, value[i] = 0.5 * time[i] * time[i];
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 2, 1, 2, 2, 2);
  ct_scene *scene = new_scene();
  int32_t nodes[27];
  for (int i = 0; i < 27; i++) nodes[i] = i;
  add_body(scene, "block", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  ct_motion motion = {.nodes = nodes,
                      .node_count = 27,
                      .fixed = {1, 1, 1},
                      .displacement = {3, -2, 0},
                      .amplitude = {POINTS, time, value}};
  const ct_problem *joined = NULL, *p = NULL;
  ct_effect *effect = NULL;
  must(ct_scene_join, scene, &joined);
  must(create_motion, &motion, 1, joined, &effect);
  must(ct_scene_add_effect, scene, effect);
  p = build(scene, (ct_scene_time){.end = 1.0, .dt = 0.01}, NULL, NULL);
  ct_state *state = new_state(p);
  double force[81], sum[3] = {0, 0, 0};
  advance(p, state, 50);
  must(ct_state_force, p, state, 1, force);
  for (int i = 0; i < 81; i++) sum[i % 3] += force[i];
  tap_close(sum[0], 2.0 * 2.0 * 3.0, 1e-9, "the reaction is mass times acceleration");
  tap_close(sum[1], 2.0 * 2.0 * -2.0, 1e-11, "along each axis");
}

static void refusals(void)
{
  static const double time[2] = {0, 1}, value[2] = {0, 1};
  static const int32_t nodes[2] = {0, 1}, more[2] = {1, 2}, beyond[1] = {8};
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("one", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *joined = NULL, *problem = NULL;
  ct_effect *effect = NULL;
  ct_error e;
  must(ct_scene_join, scene, &joined);
  ct_motion two[2] = {{nodes, 2, {1, 0, 0}, {1, 0, 0}, {2, time, value}},
                      {more, 2, {1, 1, 0}, {1, 0, 0}, {2, time, value}}};
  tap_ok(create_motion(two, 2, joined, &effect, &e) == CT_OK, "two equal motions of one component");
  ct_effect_free(effect);
  effect = NULL;
  static const double late[2] = {0, 2};
  for (int k = 0; k < 2; k++) {
    two[1].displacement[0] = k == 0 ? 2.0 : 1.0;
    two[1].amplitude.value = k == 0 ? value : late;
    tap_ok(create_motion(two, 2, joined, &effect, &e) == CT_ERROR_ARGUMENT &&
               strstr(e.text, "node 1"),
           "two motions of one component: %s", e.text);
  }
  two[1].amplitude.value = value;
  two[1].nodes = beyond, two[1].node_count = 1;
  tap_ok(create_motion(two, 2, joined, &effect, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "node 8"),
         "a node number too large: %s", e.text);
  two[0].displacement[0] = NAN;
  tap_ok(create_motion(two, 1, joined, &effect, &e) == CT_INVALID, "a displacement that is NaN: %s",
         e.text);
  two[0].displacement[0] = 1, two[0].amplitude.count = 0;
  tap_ok(create_motion(two, 1, joined, &effect, &e) == CT_ERROR_ARGUMENT, "no amplitude: %s",
         e.text);
  two[0].amplitude.count = 2, two[0].fixed[0] = 0;
  tap_ok(create_motion(two, 1, joined, &effect, &e) == CT_ERROR_ARGUMENT, "no component: %s",
         e.text);
  two[0].fixed[0] = 1;
  tap_ok(create_motion(two, 0, joined, &effect, &e) == CT_ERROR_ARGUMENT, "no motions: %s", e.text);
  must(create_motion, two, 1, joined, &effect);
  must(ct_scene_add_effect, scene, effect);
  int64_t steps;
  ct_stable_step stable;
  ct_scene_time run = {.end = 1.0, .fraction = 0.5};
  ct_gravity_def gravity = {COOKIE, .acceleration = {0, 0, -1}};
  add_made(scene, ct_gravity_create_effect, &gravity);
  tap_ok(ct_scene_build(scene, &run, &problem, &steps, &stable, &e) == CT_OK,
         "another effect may come after it in the list");
  must(create_motion, two, 1, joined, &effect);
  must(ct_scene_add_effect, scene, effect);
  tap_ok(ct_scene_build(scene, &run, &problem, &steps, &stable, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "as another one does"),
         "a second effect of motions: %s", e.text);
  scene = new_scene();
  add_body(scene, "one", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_support(scene, 0, m, -1, 0.0, "x", 0.0);
  must(ct_scene_join, scene, &joined);
  must(create_motion, two, 1, joined, &effect);
  must(ct_scene_add_effect, scene, effect);
  tap_ok(ct_scene_build(scene, &run, &problem, &steps, &stable, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "support"),
         "a support on it: %s", e.text);
}

/* Before, on and after its points, and at a jump (eq:amplitude). */
static void factors(void)
{
  static const double time[5] = {0.0, 1.0, 1.0, 3.0, 4.0}, value[5] = {0.0, 2.0, 5.0, 5.0, -1.0};
  static const double at[][2] = {{-1.0, 0.0}, {0.0, 0.0}, {0.25, 0.5}, {1.0, 5.0},
                                 {2.0, 5.0},  {3.5, 2.0}, {4.0, -1.0}, {100.0, -1.0}};
  ct_amplitude amplitude = {5, time, value}, none = {0, NULL, NULL}, bad = {5, value, time};
  ct_error e = {0};
  tap_ok(ct_amplitude_check(&amplitude, &e) == CT_OK && ct_amplitude_check(&none, &e) == CT_OK,
         "an amplitude with a jump, and none, are accepted");
  for (size_t i = 0; i < sizeof at / sizeof at[0]; i++)
    tap_close(ct_amplitude_value(&amplitude, at[i][0]), at[i][1], 1e-15, "at t = %g", at[i][0]);
  tap_close(nextafter(ct_amplitude_value(&amplitude, nextafter(1.0, 0.0)), 3.0), 2.0, 1e-14,
            "just before the jump the value is on the line");
  tap_ok(ct_amplitude_value(&none, 7.0) == 1.0, "without points the factor is 1");
  tap_ok(ct_amplitude_check(&bad, &e) == CT_ERROR_ARGUMENT && e.point == 4,
         "times that descend: %s", e.text);
  static const double nan_time[2] = {0.0, NAN};
  bad = (ct_amplitude){2, nan_time, value};
  tap_ok(ct_amplitude_check(&bad, &e) == CT_INVALID && e.point == 1, "NaN: %s", e.text);
  bad = (ct_amplitude){2, NULL, value};
  tap_ok(ct_amplitude_check(&bad, &e) == CT_ERROR_ARGUMENT &&
             ct_amplitude_check(NULL, &e) == CT_ERROR_ARGUMENT,
         "missing: %s", e.text);
}

int main(void)
{
  free_at_end();
  factors();
  there_and_back(CT_HEX8);
  there_and_back(CT_HEX20);
  inertia();
  refusals();
  return tap_done();
}
