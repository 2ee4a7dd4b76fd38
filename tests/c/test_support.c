/* Prescribed velocities, their reactions and refused definitions. */
#include "bodies.h"

static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR};

/* A distorted block whose base moves at a constant velocity while the rest has another one
 * (eq:support-mass, eq:reaction). */
static void moving_base(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 2, 2, 2, 4);
  distort_inside(m, 0.04);
  ct_scene *scene = new_scene();
  int32_t body = add_body(scene, "block", m, &SOFT, CT_KERNEL_AUTO, 0.1, -0.2, 0.3);
  int32_t base[64], count = ct_mesh_plane_nodes(m, 2, 0.0, base);
  add_support(scene, body, m, 2, 0.0, "z", 0.7);
  add_support(scene, body, m, 2, 0.0, "x", 0.0);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 20.0, .fraction = 0.5}, &steps, NULL);
  ct_state *state = new_state(p);
  ct_momentum start = momentum_of(p, state, body), now;
  ct_energy energy, first = energy_of(p, state);
  int wrong = 0;
  double path = 0.0, impulse = 0.0, total = 0.0, balance = 0.0, work = 0.0, size = 0.0;
  for (int n = 0; n < p->node_count; n++)
    for (int c = 0; c < 3; c++) size += p->mass[n] * 0.3;
  for (int64_t k = 0; k < 10; k++) {
    advance(p, state, steps / 10);
    now = momentum_of(p, state, body);
    energy = energy_of(p, state);
    double t = state->time;
    for (int i = 0; i < count; i++) {
      const double *v = &state->velocity[3 * base[i]], *u = &state->displacement[3 * base[i]];
      wrong += v[2] != 0.7 || v[0] != 0.0 || u[0] != 0.0;
      path = worst(path, u[2] / (0.7 * t) - 1.0);
    }
    for (int c = 0; c < 3; c++)
      impulse = worst(impulse, now.p[c] - start.p[c] - now.support_impulse[c]);
    total = worst(total, energy.total / first.kinetic - first.total / first.kinetic);
    balance = worst(balance, energy.balance / first.kinetic);
    // All held velocities are 0 or 0.7 along z, so the work is 0.7 times the impulse along z.
    work = worst(work, (energy.external - 0.7 * now.support_impulse[2]) / first.kinetic);
  }
  tap_ok(wrong == 0, "kind %d: fixed nodes keep their velocity to the last bit (%d do not)", kind,
         wrong);
  tap_ok(path < 1e-12, "kind %d: and go v t, off by %.2g", kind, path);
  tap_ok(impulse < 1e-12 * size,
         "kind %d: change of momentum is the support's impulse, off by %.2g", kind, impulse / size);
  tap_ok(fabs(now.support_impulse[1]) < 1e-13 * size && fabs(now.support_impulse[2]) > 0.01 * size,
         "kind %d: no impulse along y, which is free", kind);
  tap_ok(work < 1e-12, "kind %d: work of the support is velocity times impulse, off by %.2g", kind,
         work);
  tap_ok(total < 1e-12 && balance < 1e-12,
         "kind %d: total energy constant to %.2g, balance %.2g of the kinetic energy", kind, total,
         balance);

  double *force = numbers(3 * p->node_count), *solid = numbers(3 * p->node_count), off = 0.0;
  must(ct_state_force, p, state, 0, solid);
  must(ct_state_force, p, state, 1, force);
  for (int i = 0; i < 3 * p->node_count; i++)
    off = worst(off, p->inverse_mass[i] == 0.0 ? force[i] + solid[i] : force[i]);
  tap_ok(off == 0.0,
         "kind %d: the reaction is minus the force on the fixed components, and zero elsewhere",
         kind);
}

static void refused(const ct_support *s, int32_t count, ct_status want, const char *word,
                    const char *what)
{
  ct_effect *effect = NULL;
  ct_error e = {0};
  ct_status status = create_support(s, count, 10, &effect, &e);
  tap_ok(status == want && e.code == want && effect == NULL && strstr(e.text, word) != NULL,
         "%s: refused, %s", what, e.text);
}

static void refusals(void)
{
  static const int32_t nodes[3] = {2, 5, 9}, more[2] = {5, 6}, beyond[2] = {3, 10},
                       below[2] = {-1, 3};
  ct_support s[2] = {{nodes, 3, {1, 0, 0}, {1.0, 0, 0}}, {more, 2, {1, 0, 0}, {2.0, 0, 0}}};
  refused(s, 2, CT_ERROR_ARGUMENT, "node 5", "two velocities for one node");
  s[1].velocity[0] = 1.0;
  ct_effect *effect = NULL;
  must(create_support, s, 2, 10, &effect);
  tap_ok(effect->node_count == 4 && effect->nodes[0] == 2 && effect->nodes[1] == 5 &&
             effect->nodes[2] == 6 && effect->nodes[3] == 9,
         "the same velocity twice is one support: nodes 2 5 6 9");
  double inverse[30], velocity[30];
  for (int i = 0; i < 30; i++) inverse[i] = 4.0, velocity[i] = 3.0;
  int right = ct_support_apply(effect, inverse, velocity, NULL) == CT_OK;
  for (int i = 0; i < 30; i++) {
    int held = i == 6 || i == 15 || i == 18 || i == 27;
    right &= inverse[i] == (held ? 0.0 : 4.0) && velocity[i] == (held ? 1.0 : 3.0);
  }
  tap_ok(
      right,
      "fixed degrees of freedom get inverse mass 0 and their velocity, the others do not change");
  tap_ok(ct_support_apply(NULL, inverse, velocity, NULL) == CT_ERROR_ARGUMENT &&
             ct_support_apply(effect, NULL, velocity, NULL) == CT_ERROR_ARGUMENT,
         "null arguments are refused");
  ct_effect_free(effect);

  s[0].nodes = beyond, s[0].node_count = 2;
  refused(s, 1, CT_ERROR_ARGUMENT, "node 10", "a node number too large");
  s[0].nodes = below;
  refused(s, 1, CT_ERROR_ARGUMENT, "node -1", "a negative node number");
  s[0].nodes = nodes, s[0].node_count = 0;
  refused(s, 1, CT_ERROR_ARGUMENT, "no nodes", "a support without nodes");
  s[0].node_count = 3, s[0].fixed[0] = 0;
  refused(s, 1, CT_ERROR_ARGUMENT, "no component", "a support without components");
  s[0].fixed[0] = 1, s[0].velocity[0] = NAN;
  refused(s, 1, CT_INVALID, "not finite", "a velocity that is NaN");
  s[0].velocity[0] = 0.0;
  refused(s, 0, CT_ERROR_ARGUMENT, "is empty", "no supports");
  refused(NULL, 1, CT_ERROR_ARGUMENT, "is empty", "a null list");
}

/* Fixed components that differ from node to node, at some nodes or at all; an effect on all nodes
 * has no list. */
static void holds(void)
{
  for (int missing = 0; missing < 2; missing++) {
    int32_t nodes[10], single[3][4], count[3] = {0, 0, 0}, all = 0;
    // Component n % 3 of node n is held at the velocity n / 3; with one node missing, z of all
    // others at 7.
    for (int n = 0; n < 10; n++) {
      if (missing && n == 4) continue;
      nodes[all++] = n;
      single[n % 3][count[n % 3]++] = n;
    }
    ct_support s[11];
    int supports = 0;
    for (int c = 0; c < 2; c++)
      for (int i = 0; i < count[c]; i++) {
        s[supports] = (ct_support){.nodes = &single[c][i], .node_count = 1};
        s[supports].fixed[c] = 1, s[supports++].velocity[c] = single[c][i] / 3;
      }
    s[supports++] = (ct_support){nodes, all, {0, 0, 1}, {0.0, 0.0, 7.0}};
    ct_effect *effect = NULL;
    must(create_support, s, supports, 10, &effect);
    tap_ok(effect->node_count == all && (effect->nodes == NULL) == !missing,
           "a support on %d of 10 nodes %s", (int)all, missing ? "lists them" : "needs no list");
    double inverse[30], velocity[30];
    for (int i = 0; i < 30; i++) inverse[i] = 4.0, velocity[i] = 3.0;
    int right = ct_support_apply(effect, inverse, velocity, NULL) == CT_OK;
    for (int n = 0; n < 10; n++)
      for (int c = 0; c < 3; c++) {
        int there = !missing || n != 4, held = there && (c == 2 || c == n % 3);
        right &=
            inverse[3 * n + c] == (held ? 0.0 : 4.0) && velocity[3 * n + c] == (!held    ? 3.0
                                                                                : c == 2 ? 7.0
                                                                                         : n / 3);
      }
    tap_ok(right, "and fixes the requested components of each node");
    ct_effect_free(effect);
  }
}

/* Nodes of a scene's support in any order, one of them twice, on the second body: the same as in
 * order. */
static void any_order(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 2, 2, 2, 2, 2, 2);
  static const int32_t lists[3][7] = {
      {0, 1, 2, 9, 10, 11, 26}, {26, 11, 9, 0, 10, 2, 1}, {0, 1, 2, 2, 11, 10, 9}};
  double inverse[3][162];
  for (int i = 0; i < 3; i++) {
    ct_scene *scene = new_scene();
    static const ct_material soft = {1.0, 0.2, 1.0, CT_LINEAR};
    for (int b = 0; b < 2; b++) add_body(scene, "block", m, &soft, CT_KERNEL_AUTO, 0, 0, 0);
    ct_scene_support support = {.body = 1, .nodes = lists[i], .node_count = 7, .fixed = {1, 0, 0}};
    must(ct_scene_add_support, scene, &support);
    if (i == 2) {
      support.nodes = &lists[0][6], support.node_count = 1;
      must(ct_scene_add_support, scene, &support);
    }
    const ct_problem *p = build_until(scene, 0.1, 0.5);
    memcpy(inverse[i], p->inverse_mass, sizeof inverse[i]);
  }
  int held = 0, right = 1;
  for (int d = 0; d < 162; d++) held += inverse[0][d] == 0.0;
  for (int k = 0; k < 7; k++) right &= inverse[0][3 * (27 + lists[0][k])] == 0.0;
  int alike = memcmp(inverse[0], inverse[1], sizeof inverse[0]) == 0 &&
              memcmp(inverse[0], inverse[2], sizeof inverse[0]) == 0;
  tap_ok(right && held == 7 && alike, "nodes in any order, some twice, are fixed alike");
}

int main(void)
{
  free_at_end();
  holds();
  any_order();
  moving_base(CT_HEX8);
  moving_base(CT_HEX20);
  refusals();
  return tap_done();
}
