/* Falling bodies. */
#include "bodies.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};

static const ct_problem *falling(ct_scene *scene, const ct_gravity_def *gravity, double end)
{
  add_made(scene, ct_gravity_create_effect, gravity);
  return build_until(scene, end, 0.5);
}

/* Gravity and damping on the first and the last of three bodies, whose nodes begin and end within
 * the pieces that the time loop moves: forces node by node, and work and impulse summed by hand.
 * (eq:gravity-force, eq:damping-force, eq:work-sum, eq:impulse-balance) */
static void rows_of_nodes(void)
{
  enum { STEPS = 7 };
  static const int32_t two[2] = {0, 2};
  const double g[3] = {1.0, 2.0, -10.0}, rate = 3.0;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 2, 3, 6, 6, 5);
  ct_scene *scene = new_scene_with("one", mesh, &SOFT, CT_KERNEL_AUTO, 1, 0, 5);
  add_body(scene, "two", mesh, &SOFT, CT_KERNEL_AUTO, 0, 3, 5);
  add_body(scene, "three", mesh, &SOFT, CT_KERNEL_AUTO, 2, 0, 5);
  ct_damping_def damping = {COOKIE, .rate = rate, .bodies = two, .body_count = 2};
  ct_gravity_def gravity = {COOKIE, .acceleration = {1.0, 2.0, -10.0}, .bodies = two,
                            .body_count = 2};
  add_made(scene, ct_damping_create_effect, &damping);
  const ct_problem *p = falling(scene, &gravity, 1.0);
  const int32_t nodes = p->node_count / 3, dofs = 3 * p->node_count;
  ct_state *state = new_state(p);
  double *force = numbers(dofs), *before = numbers(dofs), work[3] = {0.0}, impulse[3][3] = {{0.0}};
  int64_t faults = 0;
  for (int n = 0; n <= STEPS; n++) {
    memcpy(before, state->velocity, (size_t)dofs * sizeof *before);
    for (int k = 1; k < 3; k++) {
      must(ct_state_force, p, state, k, force);
      for (int32_t d = 0; d < dofs; d++) {
        double m = d / 3 / nodes == 1 ? 0.0 : p->mass[d / 3], v = before[d],
               want = k == 1 ? -(rate * m) * v : m * g[d % 3];
        faults += force[d] != want;
        // The first force of a run and the last one act for half a step.
        work[k] += force[d] * (n == 0 ? -v : n == STEPS ? v : 0.0);
        impulse[k][d % 3] += (n == 0 || n == STEPS ? 0.5 : 1.0) * force[d];
      }
    }
    if (n == STEPS) break;
    advance(p, state, 1);
    for (int32_t d = 0; d < dofs; d++) {
      double m = d / 3 / nodes == 1 ? 0.0 : p->mass[d / 3], both = before[d] + state->velocity[d];
      work[1] += -rate * m * before[d] * both;
      work[2] += m * g[d % 3] * both;
    }
  }
  tap_ok(faults == 0, "two of three bodies: gravity and damping of %d nodes (%d differ)",
         (int)p->node_count, (int)faults);
  for (int k = 1; k < 3; k++) {
    double found, got[3];
    must(ct_energy_work, p, state, k, &found);
    must(ct_energy_impulse, p, state, k, got);
    double off = found / (0.5 * p->dt * work[k]) - 1.0, apart = 0.0;
    for (int c = 0; c < 3; c++) apart = worst(apart, got[c] / (p->dt * impulse[k][c]) - 1.0);
    tap_ok(fabs(off) < 1e-13 && fabs(apart) < 1e-13, "%s: work off by %.2g, impulse by %.2g",
           p->effects[k]->label, off, apart);
  }
}

/* Weight that grows from 0 in a time T: a free body falls g (t³ - dt² t) / (6 T), the sum of its
 * steps, and the force at each node is m g t / T; the work of the weight is what the motion has
 * (eq:gravity-amplitude). */
static void growing(void)
{
  const double T = 2.0, g = -10.0, time[2] = {0.0, T}, value[2] = {0.0, 1.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 2, 3, 2, 2, 3);
  ct_scene *scene = new_scene_with("one", mesh, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  ct_gravity_def gravity = {COOKIE, .acceleration = {0.0, 0.0, g},
                            .amplitude = {.count = 2, .time = time, .value = value}};
  const ct_problem *p = falling(scene, &gravity, 1.0);
  ct_error e;
  ct_state *state = new_state(p);
  const ct_energy first = energy_of(p, state);
  double off = 0.0, apart = 0.0, lost = 0.0, work, *force = numbers(3 * p->node_count);
  while (state->time < 0.999) {
    advance(p, state, 1);
    const double t = state->time, want = g * (t * t * t - p->dt * p->dt * t) / (6.0 * T);
    must(ct_state_force, p, state, 1, force);
    must(ct_energy_work, p, state, 1, &work);
    for (int32_t n = 0; n < p->node_count; n++) {
      off = worst(off, state->displacement[3 * n + 2] - want);
      apart = worst(apart, force[3 * n + 2] - p->mass[n] * g * t / T);
    }
    const ct_energy now = energy_of(p, state);
    lost = worst(lost, now.total - first.total);
    lost = worst(lost, now.kinetic - first.kinetic - work);
  }
  tap_close(off, 0.0, 1e-12, "weight that grows: the fall is g (t^3 - dt^2 t) / 6 T");
  tap_close(apart, 0.0, 1e-12, "and the force m g t / T");
  tap_ok(work > 1.0, "the weight has done work (%g)", work);
  tap_close(lost / work, 0.0, 1e-12, "which the motion has");
  const double back[2] = {1.0, 0.0};
  gravity.amplitude.time = back;
  ct_effect *effect = NULL;
  tap_ok(ct_gravity_create_effect(&gravity, p, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "%s", e.text);
}

static void refusals(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  ct_effect *effect = NULL;
  ct_error e = {0};
  static const int32_t none = 3;
  add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *joined = join_scene(scene);
  ct_gravity_def bad = {COOKIE, .acceleration = {0.0, NAN, 0.0}};
  tap_ok(ct_gravity_create_effect(&bad, joined, &effect, &e) == CT_INVALID, "NaN: %s", e.text);
  bad = (ct_gravity_def){COOKIE, .acceleration = {0.0, 1.0, 0.0}, .bodies = &none, .body_count = 1};
  tap_ok(ct_gravity_create_effect(&bad, joined, &effect, &e) == CT_ERROR_ARGUMENT && e.body == 3,
         "no such body: %s", e.text);
  bad.body_count = 0;
  tap_ok(ct_gravity_create_effect(&bad, joined, &effect, &e) == CT_ERROR_ARGUMENT, "no bodies: %s",
         e.text);
  ct_gravity_def zeros = {.acceleration = {0, 0, -1}};
  tap_ok(ct_gravity_create_effect(&zeros, joined, &effect, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "ct_gravity_def_default"),
         "a definition without its default: %s", e.text);
  tap_ok(ct_gravity_create_effect(NULL, joined, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "nothing: %s", e.text);
}

int main(void)
{
  free_at_end();
  rows_of_nodes();
  growing();
  refusals();
  return tap_done();
}
