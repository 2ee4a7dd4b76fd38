/* The leapfrog against closed forms: free flight and a vibration; the start; and equal bits. */
#include "bodies.h"

static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR};
static const double PI = 3.14159265358979323846;

static ct_scene *one_body(const ct_mesh *m, const ct_material *material, ct_solid_kernel kernel,
                          double vx, double vy, double vz)
{
  ct_scene *scene = new_scene_with("body", m, material, kernel, vx, vy, vz);
  return scene;
}

/* A problem with its own step and velocities: a host may fill the struct. */
static ct_problem changed(const ct_problem *p, double dt, const double *velocity)
{
  ct_problem q = *p;
  q.dt = dt;
  if (velocity != NULL) q.initial_velocity = velocity;
  return q;
}

static void free_flight(ct_brick_kind kind, ct_solid_kernel kernel, const char *name)
{
  ct_mesh *m = box_mesh(kind, -1, 0, 0, 1, 1, 1, 3, 2, 2),
          *other = box_mesh(kind, 40, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = one_body(m, &SOFT, kernel, 0.5, -0.25, 1.0);
  add_body(scene, "other", other, &SOFT, kernel, 0.0, 0.0, 0.0);
  add_contact(scene, 0, m, 0.0, 1, other, 40.0, 0, 1.0);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, &steps, NULL);
  // dt and the velocity are powers of 2, so n dt v is exact.
  ct_problem q = changed(p, 0x1p-9, NULL);
  ct_state *state = new_state(&q);
  int wrong = 0;
  for (int k = 0; k < 10; k++) {
    advance(&q, state, 100);
    for (int n = 0; n < q.node_count; n++)
      for (int c = 0; c < 3; c++) {
        double v = n < m->node_count ? (c == 0 ? 0.5 : c == 1 ? -0.25 : 1.0) : 0.0;
        wrong += state->velocity[3 * n + c] != v ||
                 state->displacement[3 * n + c] != v * (double)state->step * 0x1p-9;
      }
  }
  ct_energy e = energy_of(&q, state);
  tap_ok(wrong == 0 && state->step == 1000 && state->time == 1000 * 0x1p-9,
         "%s, free flight: 1000 steps with the exact velocity and displacement (%d off)", name,
         wrong);
  tap_ok(e.strain == 0.0 && e.contact == 0.0 && e.external == 0.0 && e.balance == 0.0,
         "%s, free flight: no strain energy, no contact, balance exactly 0", name);
  close_run(state, scene, m);
}

/* The discrete oscillator (eq:leapfrog, eq:leapfrog-start, eq:step-oscillator). The dilatation of a
 * cube has omega^2 = 12 K / (rho h^2); the leapfrog makes of it q_n = dt v0 sin(n phi) / sin(phi),
 * phi = 2 asin(omega dt / 2). */
static void vibration(double fraction)
{
  const double h = 0.5, bulk = SOFT.young / (3.0 * (1.0 - 2.0 * SOFT.poisson)),
               omega = sqrt(12.0 * bulk / (SOFT.density * h * h));
  ct_mesh *m = box_mesh(CT_HEX8, -h / 2, -h / 2, -h / 2, h, h, h, 1, 1, 1);
  ct_scene *scene = one_body(m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, &steps, &stable);
  double dt = fraction * 2.0 / omega, phi = 2.0 * asin(0.5 * omega * dt), off = 0.0, top = 0.0,
         drift = 0.0;
  ct_problem q = changed(p, dt, m->nodes);
  ct_state *state = new_state(&q);
  double first = energy_of(&q, state).total;
  for (int n = 1; n <= 500; n++) {
    advance(&q, state, 1);
    double want = dt * sin(n * phi) / sin(phi);
    for (int i = 0; i < 24; i++) off = worst(off, state->displacement[i] - want * m->nodes[i]);
    top = worst(top, want * h / 2);
    drift = worst(drift, energy_of(&q, state).total / first - 1.0);
  }
  tap_ok(off < 1e-10 * top,
         "vibration of a cube, omega dt = %.2f: 500 steps of the discrete frequency, off by %.2g",
         omega * dt, off / top);
  tap_ok(drift < 1e-12, "vibration of a cube, omega dt = %.2f: energy constant to %.2g", omega * dt,
         drift);
  tap_close(stable.dt * omega, 2.0, 1e-9, "the reported step is 2 / omega");
  close_run(state, scene, m);
}

static double *smooth_velocity(const ct_problem *p)
{
  double *v = numbers(3 * p->node_count);
  for (int n = 0; n < p->node_count; n++) {
    const double *x = &p->reference[3 * n];
    v[3 * n] = sin(PI * x[0]) * cos(x[1]);
    v[3 * n + 1] = 0.3 * cos(PI * x[1]) + x[2];
    v[3 * n + 2] = 0.2 * x[0] * x[1] - sin(2.0 * x[2]);
  }
  return v;
}

/* Two distorted bodies with unlike meshes that collide askew; `axis` 0 ... 2 mirrors everything in
 * that plane, -1 nothing. */
typedef struct collision {
  ct_scene *scene;
  const ct_problem *problem;
  ct_problem own; /* with the step that all images share */
} collision;

static collision collide(ct_brick_kind kind, ct_solid_kernel kernel, int axis, int threads)
{
  collision c = {new_scene(), NULL, {0}};
  ct_mesh *flat[2] = {box_mesh(kind, -1, 0, 0, 1, 1, 1, 3, 2, 3),
                      box_mesh(kind, 0, 0.125, 0.25, 1.25, 0.75, 1, 4, 3, 2)},
          *shape[2];
  double velocity[2][3] = {{0.5, 0.0625, -0.125}, {-0.25, 0, 0.25}};
  random_seed = 4711;
  for (int s = 0; s < 2; s++) {
    shape[s] = copy_mesh(flat[s]);
    if (kernel == CT_KERNEL_GENERAL) distort(shape[s], 0.02);
    for (int k = 0; axis >= 0 && k < 2; k++) {
      ct_mesh **m = k == 0 ? &flat[s] : &shape[s], *image = mirror_mesh(*m, axis);
      *m = image;
    }
    if (axis >= 0) velocity[s][axis] = -velocity[s][axis];
    add_body(c.scene, s == 0 ? "a" : "b", shape[s], &SOFT, kernel, velocity[s][0], velocity[s][1],
             velocity[s][2]);
  }
  add_contact(c.scene, 0, flat[0], 0.0, 1, flat[1], 0.0, 0, 2.0);
  add_support(c.scene, 0, flat[0], 0, axis == 0 ? 1.0 : -1.0, "y", 0.0);
  ct_stable_step stable;
  c.problem = build(c.scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, &stable);
  c.own = *c.problem;
  c.own.dt = floor(stable.dt * 0.7 * 1048576.0) / 1048576.0;
  c.own.settings.threads = threads;
  return c;
}

static int same_ledger(const ct_problem *p, ct_state *x, const ct_problem *q, ct_state *y)
{
  ct_energy a = energy_of(p, x), b = energy_of(q, y);
  int same = a.kinetic == b.kinetic && a.strain == b.strain && a.contact == b.contact &&
             a.external == b.external && a.total == b.total && a.balance == b.balance;
  for (int body = 0; body < p->body_count; body++) {
    ct_momentum m = momentum_of(p, x, body), n = momentum_of(q, y, body);
    for (int c = 0; c < 3; c++) {
      // A mirrored vector changes the sign of one component, a mirrored moment that of the two
      // others.
      same &= fabs(m.p[c]) == fabs(n.p[c]) && fabs(m.L[c]) == fabs(n.L[c]);
      same &= fabs(m.contact_impulse[c]) == fabs(n.contact_impulse[c]) &&
              fabs(m.support_impulse[c]) == fabs(n.support_impulse[c]);
    }
  }
  return same;
}

enum { RUN = 250, THREADED = 80 };

static void equal_bits(ct_brick_kind kind, ct_solid_kernel kernel, const char *name)
{
  collision one = collide(kind, kernel, -1, 1), two = collide(kind, kernel, -1, 2);
  ct_state *whole = new_state(&one.own), *threads = new_state(&two.own),
           *half = new_state(&one.own), *rest = new_state(&one.own);
  double pressed = 0.0;
  advance(&one.own, half, RUN / 2);
  must(ct_state_copy, &one.own, half, rest);
  advance(&one.own, rest, RUN - RUN / 2);
  advance(&two.own, threads, THREADED);
  int alike = 0;
  for (int k = 0; k < RUN; k++) {
    advance(&one.own, whole, 1);
    if (k + 1 == THREADED)
      alike = same_state(whole, threads) && same_ledger(&one.own, whole, &two.own, threads);
    if (k % 10 == 0) pressed = worst(pressed, energy_of(&one.own, whole).contact);
  }
  double start = whole->kinetic_start;
  tap_ok(pressed > 1e-3 * start,
         "%s: the bodies press on each other (contact energy up to %.3f of the kinetic)", name,
         pressed / start);
  tap_ok(
      same_state(whole, rest),
      "%s: a run that was copied and continued has the same bits, with and without energy balance",
      name);
  tap_ok(same_ledger(&one.own, whole, &one.own, rest), "%s: its energy balance, too", name);
  tap_ok(alike, "%s: two threads have the same bits", name);
  for (int axis = 0; axis < 3; axis++) {
    collision image = collide(kind, kernel, axis, 1);
    ct_state *mirrored = new_state(&image.own);
    image.own.dt = one.own.dt;
    free_state(mirrored);
    mirrored = new_state(&image.own);
    advance(&image.own, mirrored, RUN);
    int64_t faults =
        mirror_faults(whole->displacement, mirrored->displacement, whole->node_count, axis) +
        mirror_faults(whole->velocity, mirrored->velocity, whole->node_count, axis);
    tap_ok(faults == 0 && same_ledger(&one.own, whole, &image.own, mirrored),
           "%s: mirrored in %c, the mirrored bits (%d of %d are not)", name, "xyz"[axis],
           (int)faults, 6 * whole->node_count);
    close_run(mirrored, image.scene, NULL);
  }
  free_state(whole);
  free_state(threads);
  free_state(half);
  close_run(rest, one.scene, NULL);
}

/* A body against its own mirror image: both halves of one run are images of each other. */
static void symmetric_impact(ct_brick_kind kind, ct_solid_kernel kernel, const char *name)
{
  ct_mesh *flat = box_mesh(kind, 0, 0, 0, 1, 1, 1, 4, 2, 3), *right = copy_mesh(flat);
  if (kernel == CT_KERNEL_GENERAL) distort_inside(right, 0.04);
  ct_mesh *left = mirror_mesh(right, 0), *flat_left = mirror_mesh(flat, 0);
  ct_scene *scene = one_body(right, &SOFT, kernel, -0.5, 0.01, -0.02);
  add_body(scene, "left", left, &SOFT, kernel, 0.5, 0.01, -0.02);
  add_contact(scene, 0, flat, 0.0, 1, flat_left, 0.0, 0, 4.0);
  add_support(scene, 0, flat, 2, 0.0, "z", 0.0);
  add_support(scene, 1, flat_left, 2, 0.0, "z", 0.0);
  int64_t steps, faults = 0;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.5, .fraction = 0.5}, &steps, NULL);
  ct_state *state = new_state(p);
  double pressed = 0.0;
  int n = right->node_count;
  for (int k = 0; k < 20; k++) {
    advance(p, state, steps / 20);
    faults += mirror_faults(state->displacement, state->displacement + 3 * n, n, 0) +
              mirror_faults(state->velocity, state->velocity + 3 * n, n, 0);
    pressed = worst(pressed, energy_of(p, state).contact);
  }
  ct_momentum a = momentum_of(p, state, 0), b = momentum_of(p, state, 1);
  tap_ok(faults == 0 && pressed > 0.0,
         "%s, impact on the mirror image: both halves have the mirrored bits (%d do not)", name,
         (int)faults);
  tap_ok(a.p[0] == -b.p[0] && a.p[1] == b.p[1] && a.contact_impulse[0] == -b.contact_impulse[0] &&
             a.L[0] == b.L[0] && a.L[1] == -b.L[1],
         "%s, impact on the mirror image: so have their momenta", name);
}

/* Bodies that overlap at t = 0 have a force then: the first half kick goes back from the given
 * velocity, and the energy balance includes it (eq:leapfrog-start). */
static void loaded_start(void)
{
  ct_mesh *left = box_mesh(CT_HEX8, -1, 0, 0, 1, 1, 1, 2, 2, 2),
          *right = box_mesh(CT_HEX8, -0.03125, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = one_body(left, &SOFT, CT_KERNEL_AUTO, 0.25, 0, 0);
  add_body(scene, "right", right, &SOFT, CT_KERNEL_AUTO, -0.5, 0, 0);
  add_contact(scene, 0, left, 0.0, 1, right, -0.03125, 0, 1.0);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 0.5, .fraction = 0.5}, &steps, NULL);
  // eps = E / h = 4, area 1: the force is 4 * 0.03125, and each face's nodes share it as 1 : 2 : 4.
  ct_state *state = new_state(p);
  double *f = numbers(3 * p->node_count), *v = numbers(3 * p->node_count), sum = 0.0, kick = 0.0,
         mean = 0.0, error[2] = {0}, order;
  must(ct_state_force, p, state, 1, f);
  must(ct_state_velocity, p, state, v);
  for (int n = 0; n < p->node_count; n++) {
    double v0 = n < left->node_count ? 0.25 : -0.5;
    sum += n < left->node_count ? f[3 * n] : 0.0;
    kick = worst(kick, state->velocity[3 * n] - (v0 - 0.5 * p->dt * f[3 * n] / p->mass[n]));
    mean = worst(mean, v[3 * n] - v0);
  }
  tap_close(sum, -0.125, 1e-14, "bodies that overlap at the start press with eps g A");
  tap_ok(kick < 1e-15 && mean < 1e-15,
         "half a step before the start half a kick is missing in the velocity (%.2g), at the start "
         "it is "
         "the given one (%.2g)",
         kick, mean);
  ct_energy first = energy_of(p, state), now;
  tap_close(first.contact, 0.5 * 4.0 * 0.03125 * 0.03125, 1e-16, "and store eps g^2 A / 2");
  advance(p, state, steps);
  now = energy_of(p, state);
  ct_momentum a = momentum_of(p, state, 0);
  tap_ok(fabs(now.balance) < 1e-13 * first.kinetic, "loaded start: work balance %.2g",
         now.balance / first.kinetic);
  tap_close(a.p[0] - 0.25 * 1.5, a.contact_impulse[0], 1e-14,
            "loaded start: change of momentum is the contact's impulse");
  free_state(state);
  // Errors of the displacement at t = 1/16, while all points stay in contact: order 2 only with the
  // half kick.
  double *fine = numbers(3 * p->node_count);
  for (int k = 0; k < 3; k++) {
    int64_t count = k == 0 ? 4096 : k == 1 ? 16 : 32;
    ct_problem q = changed(p, 0.0625 / (double)count, NULL);
    state = new_state(&q);
    advance(&q, state, count);
    if (k == 0) memcpy(fine, state->displacement, 3 * (size_t)p->node_count * sizeof *fine);
    else error[k - 1] = largest_difference(state->displacement, fine, 3 * p->node_count);
    free_state(state);
  }
  order = log(error[0] / error[1]) / log(2.0);
  tap_ok(order > 1.9 && order < 2.1, "loaded start: order %.3f in dt (errors %.2g %.2g)", order,
         error[0], error[1]);
}

/* A step that is much too long: the run ends with an error that names body, node and time, not with
 * NaN. */
static void blowup(int with_contact)
{
  ct_mesh *left = box_mesh(CT_HEX8, -1, 0, 0, 1, 1, 1, 2, 2, 2),
          *right = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = one_body(left, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "right", right, &SOFT, CT_KERNEL_AUTO, with_contact ? -1.0 : 0.0, 0, 0);
  if (with_contact) add_contact(scene, 0, left, 0.0, 1, right, 0.0, 0, 4.0);
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 1.0}, NULL, &stable);
  double *v = smooth_velocity(p);
  for (int i = 0; i < 3 * left->node_count; i++) v[i] = 0.0;
  ct_problem q = changed(p, 50.0 * stable.dt_without_contact, v);
  ct_state *state = new_state(&q);
  ct_error e = {0};
  ct_status status = ct_run(&q, state, 100000, NULL, 0, &e);
  // With contact the surfaces come nearer by more than the depth before any number overflows.
  int named = with_contact ? status == CT_ERROR_STEP : status == CT_ERROR_BLOWUP && e.body >= 0;
  tap_ok(named && e.code == status && e.point >= 0 && e.point < 27 &&
             strstr(e.text, "step") != NULL,
         "%s: %s (body %d, node %d)", with_contact ? "blow-up with contact" : "blow-up", e.text,
         (int)e.body, (int)e.point);
  if (!with_contact) tap_ok(e.body == 1, "the error names the body that moved");
  close_run(state, scene, NULL);
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1),
          *two = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  ct_scene *scene = one_body(m, &SOFT, CT_KERNEL_AUTO, 1, 0, 0),
           *other = one_body(two, &SOFT, CT_KERNEL_AUTO, 1, 0, 0);
  ct_stable_step stable;
  ct_scene_time t = {.end = 1.0, .fraction = 0.5};
  const ct_problem *p = build(scene, t, NULL, &stable), *q = build(other, t, NULL, &stable);
  ct_state *state = new_state(p), *unlike = new_state(q), *none = NULL;
  ct_error e = {0};
  tap_ok(ct_state_copy(p, state, unlike, &e) == CT_ERROR_ARGUMENT,
         "copying to a state of another problem is refused: %s", e.text);
  tap_ok(ct_step(NULL, state, NULL) == CT_ERROR_ARGUMENT &&
             ct_step(p, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_stable(NULL, NULL, &stable, NULL) == CT_ERROR_ARGUMENT &&
             ct_state_create(p, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_state_create(NULL, &none, NULL) == CT_ERROR_ARGUMENT,
         "null arguments are refused");
  const double step[4] = {0.0, -1.0, NAN, INFINITY};
  int refused = 1;
  for (int i = 0; i < 4; i++) {
    ct_problem bad = changed(p, step[i], NULL);
    refused &= ct_state_create(&bad, &none, &e) == CT_ERROR_ARGUMENT && none == NULL;
  }
  tap_ok(refused, "a step of 0, -1, NaN, infinity is refused: %s", e.text);
  ct_problem bad = *p;
  bad.effects = NULL;
  tap_ok(ct_state_create(&bad, &none, &e) == CT_ERROR_ARGUMENT,
         "a problem without effects is refused: %s", e.text);
  bad = *p, bad.node_count = 4;
  tap_ok(ct_state_create(&bad, &none, &e) == CT_ERROR_ARGUMENT,
         "effects for another number of nodes are refused: %s", e.text);
  bad = *p, bad.settings.threads = -1;
  tap_ok(ct_state_create(&bad, &none, &e) == CT_ERROR_ARGUMENT && none == NULL,
         "-1 threads are refused: %s", e.text);

  ct_stable_step at_start, later;
  must(ct_stable, p, NULL, &at_start);
  advance(p, state, 10);
  must(ct_stable, p, state, &later);
  tap_ok(memcmp(&at_start, &later, sizeof later) == 0,
         "a linear body has the same stable step at any time");
}

int main(void)
{
  free_at_end();
  free_flight(CT_HEX8, CT_KERNEL_BOX, "box kernel");
  free_flight(CT_HEX8, CT_KERNEL_GENERAL, "hex8 kernel");
  free_flight(CT_HEX20, CT_KERNEL_GENERAL, "hex20 kernel");
  free_flight(CT_HEX20, CT_KERNEL_BOX, "hex20 box kernel");
  vibration(0.1);
  vibration(0.5);
  vibration(0.95);
  equal_bits(CT_HEX8, CT_KERNEL_BOX, "box kernel");
  equal_bits(CT_HEX8, CT_KERNEL_GENERAL, "hex8 kernel");
  equal_bits(CT_HEX20, CT_KERNEL_GENERAL, "hex20 kernel");
  equal_bits(CT_HEX20, CT_KERNEL_BOX, "hex20 box kernel");
  symmetric_impact(CT_HEX8, CT_KERNEL_BOX, "box kernel");
  symmetric_impact(CT_HEX8, CT_KERNEL_GENERAL, "hex8 kernel");
  symmetric_impact(CT_HEX20, CT_KERNEL_GENERAL, "hex20 kernel");
  symmetric_impact(CT_HEX20, CT_KERNEL_BOX, "hex20 box kernel");
  loaded_start();
  blowup(0);
  blowup(1);
  refusals();
  return tap_done();
}
