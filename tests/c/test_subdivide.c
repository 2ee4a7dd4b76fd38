/* Continuing with a smaller step: no quantity of a body may change by it, and the order of the
 * method is kept. */
#include "bodies.h"

static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR}, PLAIN = {1.0, 0.0, 1.0, CT_LINEAR};

static ct_state *refined(const ct_problem *fine, ct_state *from)
{
  ct_state *state = new_state(fine);
  must(ct_state_subdivide_step, fine, from, state);
  return state;
}

static ct_problem with_step(const ct_problem *p, double dt)
{
  ct_problem q = *p;
  q.dt = dt;
  return q;
}

/* A body falls v t + g t² / 2 exactly, with any steps one after another, and the impulse and work
 * of its weight are m g t and m g (v t + g t² / 2) (eq:step-change). */
static void falling(void)
{
  static const int parts[4] = {3, 1, 2, 5};
  const double v = 0.5, g = -2.0;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  ct_scene *scene = new_scene_with("body", mesh, &SOFT, CT_KERNEL_AUTO, 0, 0, v);
  add_weight(scene, (weight){.g = {0, 0, g}});
  ct_problem problem[5] = {*build_until(scene, 1.0, 0.8)};
  ct_state *state = new_state(&problem[0]);
  double off = 0.0, mass = SOFT.density, impulse[3], work;
  for (int k = 0; k < 4; k++) {
    advance(&problem[k], state, 7 + 300 * (k == 2)); // through a fold of the impulses, too
    problem[k + 1] = with_step(&problem[k], problem[k].dt / parts[k]);
    ct_state *next = refined(&problem[k + 1], state);
    off = worst(off, (next->time - state->time) / state->time);
    ct_state_free(state);
    state = next;
    advance(&problem[k + 1], state, 2);
    double t = state->time, way = v * t + 0.5 * g * t * t, unit = 1.0 + t * t;
    for (int n = 0; n < mesh->node_count; n++)
      off = worst(off, (state->displacement[3 * n + 2] - way) / unit);
    must(ct_energy_impulse, &problem[k + 1], state, 1, impulse);
    must(ct_energy_work, &problem[k + 1], state, 1, &work);
    off = worst(worst(off, (impulse[2] - mass * g * t) / unit), (work - mass * g * way) / unit);
    off = worst(off, energy_of(&problem[k + 1], state).balance / unit);
    off = worst(off, (momentum_of(&problem[k + 1], state, 0).p[2] - mass * (v + g * t)) / unit);
  }
  tap_ok(off < 1e-13,
         "a body falls v t + g t^2 / 2 through four changes of the step, with impulse and work of "
         "its weight (off by %.2g)",
         off);
  close_run(state, scene, mesh);
}

/* Velocity at t = 1 and displacement there of a body that vibrates, with `count` steps of which the
 * second half are divided by `parts`. */
static void vibrate(const ct_problem *p, int64_t count, int parts, double *u, double *v)
{
  ct_problem coarse = with_step(p, 1.0 / (double)count),
             fine = with_step(&coarse, coarse.dt / parts);
  ct_state *state = new_state(&coarse);
  advance(&coarse, state, count / 2);
  ct_state *rest = refined(&fine, state);
  advance(&fine, rest, parts * (count / 2));
  memcpy(u, rest->displacement, 3 * (size_t)p->node_count * sizeof *u);
  must(ct_state_velocity, &fine, rest, v);
  ct_state_free(state);
  ct_state_free(rest);
}

/* A change of the step keeps the order of the method, also of methods with an earlier acceleration.
 */
static void order(ct_scheme scheme)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene();
  distort(m, 0.04);
  add_body(scene, "body", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  int64_t steps;
  ct_problem p = *build_by(scheme, scene, 1.0, 0.5, &steps);
  int n = 3 * p.node_count;
  double *v0 = numbers(n), *u[2] = {numbers(n), numbers(n)}, *v[2] = {numbers(n), numbers(n)},
         error[2][2];
  for (int i = 0; i < p.node_count; i++)
    v0[3 * i] = sin(3.0 * p.reference[3 * i]),
           v0[3 * i + 1] = 0.3 * cos(3.0 * p.reference[3 * i + 1]) + p.reference[3 * i + 2];
  p.initial_velocity = v0;
  steps += steps % 2;
  vibrate(&p, 64 * steps, 1, u[0], v[0]);
  for (int k = 0; k < 2; k++) {
    vibrate(&p, (4 * steps) << k, 3, u[1], v[1]);
    error[0][k] = largest_difference(u[0], u[1], n),
    error[1][k] = largest_difference(v[0], v[1], n);
  }
  double got[2] = {log(error[0][0] / error[0][1]) / log(2.0),
                   log(error[1][0] / error[1][1]) / log(2.0)},
         least = ct_integrator_facts(scheme)->order - 0.1;
  tap_ok(got[0] > least && got[1] > least,
         "%s: a third of the step in the second half keeps the order, %.3f and %.3f",
         SCHEME(scheme), got[0], got[1]);
  double *all[] = {v0, u[0], u[1], v[0], v[1]};
  for (int i = 0; i < 5; i++) free(all[i]);
  ct_scene_free(scene);
  ct_mesh_free(m);
}

/* Two bodies that meet askew with friction, a weight with damping, a moving support; their motion
 * and sums. */
typedef struct books {
  double momentum[3], impulse[3], work, balance, external, strain;
} books;

static books read_books(const ct_problem *p, ct_state *state)
{
  books b = {.balance = energy_of(p, state).balance,
             .external = energy_of(p, state).external,
             .strain = energy_of(p, state).strain};
  for (int k = 0; k < p->effect_count; k++) {
    double work, impulse[3] = {0.0, 0.0, 0.0};
    must(ct_energy_work, p, state, k, &work);
    b.work += work;
    if (k > 0) must(ct_energy_impulse, p, state, k, impulse);
    for (int c = 0; c < 3; c++) b.impulse[c] += impulse[c];
  }
  for (int body = 0; body < p->body_count; body++)
    for (int c = 0; c < 3; c++) b.momentum[c] += momentum_of(p, state, body).p[c];
  return b;
}

static void meeting(ct_scheme scheme, ct_enforcement enforcement)
{
  ct_mesh *a = box_mesh(CT_HEX8, -1, 0, 0, 1, 1, 1, 3, 2, 3),
          *b = box_mesh(CT_HEX8, 0, 0.125, 0.25, 1.25, 0.75, 1, 4, 3, 2);
  ct_scene *scene = new_scene_with("a", a, &SOFT, CT_KERNEL_AUTO, 0.5, 0.0625, -0.125);
  add_body(scene, "b", b, &SOFT, CT_KERNEL_AUTO, -0.25, 0, 0.25);
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = enforcement;
  add_contact_with(scene, 0, a, 0.0, 1, b, 0.0, 0, 2.0, options, 0.3, 0.25);
  add_support(scene, 0, a, 0, -1.0, "y", 0.05);
  add_weight(scene, (weight){.g = {0.1, 0.2, -0.3}, .damping = 0.2, .pull = 0.5, .period = 0.4});
  ct_problem coarse = *build_by(scheme, scene, 1.0, 0.7, NULL);
  ct_problem fine = with_step(&coarse, coarse.dt / 3.0);
  ct_state *state = new_state(&coarse);
  books start = read_books(&coarse, state), before, after, end;
  double size = energy_of(&coarse, state).kinetic, change = 0.0, closes = 0.0;
  advance(&coarse, state, 40);
  state->kinetic_start -= size; // a balance that is off stays off
  before = read_books(&coarse, state);
  ct_state *rest = refined(&fine, state);
  after = read_books(&fine, rest);
  change = worst(worst(change, after.balance - before.balance),
                 memcmp(rest->displacement, state->displacement,
                        3 * (size_t)coarse.node_count * sizeof(double)) != 0);
  change = worst(change, after.strain - before.strain);
  // Momentum less impulse: contact forces that depend on the coming step change a little, and their
  // impulse with them.
  for (int c = 0; c < 3; c++)
    change = worst(change, (after.momentum[c] - after.impulse[c]) -
                               (before.momentum[c] - before.impulse[c]));
  advance(&fine, rest, 150);
  end = read_books(&fine, rest);
  closes = worst(closes, end.balance - size);
  for (int c = 0; c < 3; c++)
    closes =
        worst(closes, (end.momentum[c] - end.impulse[c]) - (start.momentum[c] - start.impulse[c]));
  tap_ok(change < 1e-13 * size && closes < 1e-12 * size &&
             fabs(after.work - before.work) < 2e-3 * size,
         "%s, %s: balance and momentum do not change at the new step (%.2g) and close after it "
         "(%.2g); "
         "the work of all effects moves by %.2g",
         SCHEME(scheme), ENFORCEMENT[enforcement], change / size, closes / size,
         (after.work - before.work) / size);
  ct_state_free(state);
  close_run(rest, scene, a);
  ct_mesh_free(b);
}

/* (Δt² - Δt'²) / 8 a · M a at the division: the energy of the leapfrog with the smaller step, less
 * that with the larger one, of the same v_n, displacement and acceleration (eq:divided-energy). */
static double jump_of(const ct_state *coarse, const ct_state *fine)
{
  const double dt = coarse->problem->dt, part = fine->problem->dt;
  double sum = 0.0;
  for (int d = 0; d < 3 * fine->problem->node_count; d++) {
    const double a = 2.0 * (fine->velocity[d] - coarse->velocity[d]) / (dt - part);
    sum += fine->problem->mass[d / 3] * a * a;
  }
  return (dt * dt - part * part) / 8.0 * sum;
}

/* What is off at a division after some steps, over a unit of energy: the change of the total at the
 * division, and what the total loses and gains after it. */
typedef struct change {
  double jump, lost, gained;
} change;

static change halved(ct_scene *scene, ct_scene_time time, int64_t after, double unit,
                     int64_t *steps)
{
  const ct_problem coarse = *build(scene, time, steps, NULL),
                   fine = with_step(&coarse, 0.5 * coarse.dt);
  ct_state *state = new_state(&coarse);
  advance(&coarse, state, after);
  const double before = energy_of(&coarse, state).total;
  ct_state *rest = refined(&fine, state);
  const double divided = energy_of(&fine, rest).total, jump = jump_of(state, rest);
  advance(&fine, rest, 2 * (*steps - after));
  const double more = (energy_of(&fine, rest).total - divided) / unit;
  ct_state_free(state);
  close_run(rest, scene, NULL);
  return (change){fabs(divided - before - jump) / unit, fmax(-more, 0.0), fmax(more, 0.0)};
}

/* Two plates of two layers collide, and are apart at the end; the step is a part of ten of the
 * stable one. */
static change divided_impact(int tenths, int64_t after, int64_t *steps)
{
  ct_mesh *a = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2),
          *b = box_mesh(CT_HEX8, 0, 0, 1.015, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene_with("a", a, &PLAIN, CT_KERNEL_AUTO, 0, 0, 0.1);
  add_body(scene, "b", b, &PLAIN, CT_KERNEL_AUTO, 0, 0, -0.1);
  add_contact_with(scene, 0, a, 1.0, 1, b, 1.015, 2, 40.0, ct_contact_options_default(), 0.0, 0.0);
  const change found =
      halved(scene, (ct_scene_time){.end = 4.4, .fraction = 0.1 * tenths}, after, 0.01, steps);
  ct_mesh_free(a);
  ct_mesh_free(b);
  return found;
}

/* A plane hits a block and pushes it; it gathers speed twice. */
static change divided_push(int enforcement, int64_t after, int64_t *steps)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 1, 1, 1, 2, 2, 2, 3);
  ct_scene *scene = new_scene_with("block", m, &PLAIN, CT_KERNEL_AUTO, 0, 0, 0);
  int32_t *faces = integers(8 * 6 * m->element_count);
  ct_obstacle_def o = ct_obstacle_def_default();
  o.shape = CT_OBSTACLE_PLANE, o.enforcement = (ct_enforcement)enforcement;
  o.epsilon = enforcement == CT_ENFORCE_PENALTY ? 2.0 : 80.0;
  const double time[] = {0.0, 1.3, 2.6, 5.0}, way[] = {0.0, 0.0, 0.05, 0.25};
  o.axis[2] = 1.0, o.point[2] = 0.99, o.velocity[2] = 0.1, o.travel_time = 1.0 / 3;
  o.travel[2] = 1.0, o.amplitude = (ct_amplitude){4, time, way};
  o.kind = CT_Q4, o.face_count = ct_mesh_plane_faces(m, 2, 1.0, faces, NULL), o.faces = faces;
  add_made(scene, ct_obstacle_create_effect, &o);
  const change found =
      halved(scene, (ct_scene_time){.end = 5.0, .fraction = 0.6}, after, 0.01, steps);
  free(faces);
  ct_mesh_free(m);
  return found;
}

/* The worst of all divisions of a case. */
static change worst_of(change (*divided)(int kind, int64_t after, int64_t *steps), int kind)
{
  change most = {0.0, 0.0, 0.0};
  for (int64_t after = 1, steps = 2; after < steps; after++) {
    const change found = divided(kind, after, &steps);
    most.jump = fmax(most.jump, found.jump);
    most.lost = fmax(most.lost, found.lost);
    most.gained = fmax(most.gained, found.gained);
  }
  return most;
}

/* A division in an impact changes the total only by the energy of the leapfrog, and the contact
 * gives back what it holds after it (eq:divided-energy, eq:divided-work). The explicit penalty may
 * gain and lose later. */
static void impacts(void)
{
  for (int tenths = 5; tenths <= 9; tenths += 4) {
    const change most = worst_of(divided_impact, tenths);
    tap_ok(most.jump < 1e-12 && most.lost < 1e-12 && most.gained < 1e-12,
           "two plates whose step of .%d is divided after any step of their impact: the total is "
           "off by %.1e, and %.1e of the energy is lost and %.1e gained",
           tenths, most.jump, most.lost, most.gained);
  }
  const change pushed = worst_of(divided_push, CT_ENFORCE_ENERGY_CONTROLLED),
               explicit = worst_of(divided_push, CT_ENFORCE_PENALTY);
  tap_ok(pushed.jump < 1e-12 && pushed.lost < 1e-12 && pushed.gained < 1e-12 &&
             explicit.jump < 1e-12,
         "a plane that gathers speed pushes a block: the total is off by %.1e, with the explicit "
         "penalty by %.1e, and %.1e is lost and %.1e gained",
         pushed.jump, explicit.jump, pushed.lost, pushed.gained);
}

static void refusals(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  ct_scene *scene = new_scene_with("body", mesh, &SOFT, CT_KERNEL_AUTO, 0.1, 0, 0);
  int64_t steps;
  ct_problem p = *build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, &steps, NULL);
  ct_problem larger = with_step(&p, 2.0 * p.dt), odd = with_step(&p, p.dt / 1.5),
             other = with_step(&p, 0.5 * p.dt);
  other.integrator = ct_integrator_default(CT_CHUNG_LEE);
  ct_state *state = new_state(&p),
           *to[3] = {new_state(&larger), new_state(&odd), new_state(&other)}, *same = new_state(&p);
  ct_error e = {0};
  const ct_problem *problem[3] = {&larger, &odd, &other};
  int refused = 0;
  for (int i = 0; i < 3; i++)
    refused += ct_state_subdivide_step(problem[i], state, to[i], &e) == CT_ERROR_ARGUMENT &&
               e.text[0] != 0;
  refused += ct_state_subdivide_step(&p, state, state, &e) == CT_ERROR_ARGUMENT;
  refused += ct_state_subdivide_step(&p, NULL, same, &e) == CT_ERROR_ARGUMENT &&
             ct_state_subdivide_step(&p, state, to[0], NULL) == CT_ERROR_ARGUMENT;
  tap_ok(refused == 5,
         "larger steps, odd parts, another integrator, null and another problem's state are "
         "refused: %s",
         e.text);
  advance(&p, state, 9);
  must(ct_state_subdivide_step, &p, state, same);
  advance(&p, state, 9);
  advance(&p, same, 9);
  tap_ok(memcmp(state->velocity, same->velocity, 3 * (size_t)p.node_count * sizeof(double)) == 0 &&
             state->step == same->step,
         "with the same step it is a copy");
  for (int i = 0; i < 3; i++) ct_state_free(to[i]);
  ct_state_free(state);
  close_run(same, scene, mesh);
}

int main(void)
{
  falling();
  for (int scheme = 0; scheme < CT_SCHEME_COUNT; scheme++) order((ct_scheme)scheme);
  for (int scheme = 0; scheme < CT_SCHEME_COUNT; scheme++)
    for (int enforcement = 0; enforcement < ENFORCEMENTS; enforcement++)
      meeting((ct_scheme)scheme, (ct_enforcement)enforcement);
  impacts();
  refusals();
  return tap_done();
}
