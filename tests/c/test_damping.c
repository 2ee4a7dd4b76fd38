/* Damped motion. */
#include "bodies.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};

/* Each step takes the share alpha dt of the velocity: (1 - alpha dt)^n, near exp(-alpha t)
 * (eq:damping-force, eq:damping-decay). */
static void decay(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene();
  ct_effect *effect = NULL;
  ct_error e = {0};
  int64_t steps;
  ct_stable_step stable, free_step;
  add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, 3, -4, 0);
  build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.2}, &steps, &free_step);
  const ct_problem *joined = join_scene(scene);
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
  must(ct_energy_work, problem, state, 1, &work);
  tap_ok(work < 0.0 && fabs(work + first.kinetic - now.kinetic) < 1e-12 * first.kinetic,
         "the work is the loss of kinetic energy (%g)", work);
  damping.rate = -1.0;
  tap_ok(ct_damping_create_effect(&damping, joined, &effect, &e) == CT_INVALID,
         "a negative rate: %s", e.text);
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
  free_state(state);
  ct_problem longer = *problem;
  longer.dt = 1.2 / rate;
  tap_ok(ct_state_create(&longer, &state, &e) == CT_ERROR_STEP, "a host's own problem: %s", e.text);
}

/* One cube along its length, an oscillator with k = E h and m = rho h^3 / 2, relaxes like a loop
 * that is written here: the same rates and the same motion (eq:relaxation-rate,
 * eq:relaxation-force). */
static void relaxation_by_hand(void)
{
  static const ct_material bar = {.young = 9.0, .poisson = 0.0, .density = 2.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("cube", mesh, &bar, CT_KERNEL_AUTO, 0.1, 0, 0);
  add_support(scene, 0, mesh, 0, 0.0, "xyz", 0.0);
  ct_damping_def damping = {COOKIE, .relaxation = 1};
  add_made(scene, ct_damping_create_effect, &damping);
  const ct_problem *problem = build_until(scene, 10.0, 0.1);
  ct_state *state = new_state(problem);
  double k = 9.0, m = 1.0, dt = problem->dt, u = 0.0, v = 0.1, rate = 0.0, off = 0.0;
  double u0 = 0.0, f0 = 0.0, age = 0.0;
  for (int n = 1; n <= 80; n++) {
    double f = -k * u, a = 0.5 * rate * dt;
    if (age == 0.0 || 0.5 * rate * dt * age >= 1.0 || rate == 0.0) {
      double square = -(u - u0) * (f - f0) / ((u - u0) * m * (u - u0));
      if (age > 0.0 && square > 0.0) rate = 2.0 * sqrt(square);
      u0 = u, f0 = f, age = 0.0;
    }
    age += 1.0;
    v = ((1.0 - a) * v + dt * f / m) / (1.0 + a);
    u += dt * v;
    advance(problem, state, 1);
    off = worst(off, state->displacement[3 * (mesh->node_count - 1)] - u);
  }
  tap_close(rate, 2.0 * 3.0, 1e-12, "one oscillator: the rate is twice its frequency");
  tap_close(off, 0.0, 1e-14, "and its motion is that of a loop by hand");
}

/* The residual of a bar that swings, from forces and velocities: the larger of two ratios
 * (eq:residual). */
static void residual_by_hand(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 4, 1, 1, 4, 1, 1);
  ct_scene *scene = new_scene_with("bar", mesh, &SOFT, CT_KERNEL_AUTO, 0.3, 0, 0);
  add_support(scene, 0, mesh, 0, 0.0, "xyz", 0.0);
  ct_gravity_def gravity = {COOKIE, .acceleration = {20, 0, 0}};
  add_made(scene, ct_gravity_create_effect, &gravity);
  const ct_problem *p = build_until(scene, 1.0, 0.5);
  ct_state *state = new_state(p);
  double off = 0.0, *force = numbers(3 * p->node_count), *total = numbers(3 * p->node_count);
  int by_forces = 0, by_energy = 0;
  for (int n = 0; n < 60; n++) {
    double residual, sum = 0.0, most = 0.0, kinetic = 0.0, stored = 0.0;
    advance(p, state, 1);
    must(ct_energy_residual, p, state, &residual);
    memset(total, 0, 3 * (size_t)p->node_count * sizeof *total);
    for (int32_t k = 0; k < p->effect_count; k++) {
      double own;
      must(ct_energy_stored, p, state, k, &own);
      must(ct_state_force, p, state, k, force);
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
}

/* A bar that hangs on one end comes to rest with u(x) = rho g (L x - x² / 2) / E, which linear
 * elements have exactly at their nodes. */
static void relaxation(void)
{
  static const ct_material bar = {.young = 900.0, .poisson = 0.0, .density = 1.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 10, 0.5, 0.5, 20, 1, 1);
  ct_scene *scene = new_scene_with("bar", mesh, &bar, CT_KERNEL_AUTO, 0, 0, 0);
  add_support(scene, 0, mesh, 0, 0.0, "xyz", 0.0);
  ct_effect *effect = NULL;
  ct_error e = {0};
  const ct_problem *joined = join_scene(scene);
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
  must(ct_energy_residual, problem, state, &unrest);
  tap_ok(unrest > 0.9, "at the start no force balances the weight: residual %g", unrest);
  ct_energy energy = {0}, first = energy_of(problem, state);
  for (unrest = 1.0; state->step < steps && unrest > 1e-9;) {
    if (state->step == 200) must(ct_state_copy, problem, state, other);
    advance(problem, state, 1);
    must(ct_energy_residual, problem, state, &unrest);
    must(ct_energy_work, problem, state, 2, &work);
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
}

/* The residual without any stiffness: 0 at rest, infinite in free flight. */
static void unrest_of_free_bodies(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  for (int flies = 0; flies < 2; flies++) {
    ct_scene *scene = new_scene();
    double unrest;
    add_body(scene, "one", mesh, &SOFT, CT_KERNEL_AUTO, flies, 0, 0);
    const ct_problem *problem = build_until(scene, 1.0, 0.5);
    ct_state *state = new_state(problem);
    must(ct_energy_residual, problem, state, &unrest);
    tap_ok(flies ? unrest > 1e300 : unrest == 0.0, "a body that %s: residual %g",
           flies ? "flies" : "lies there", unrest);
  }
}

/* A scene of one body with damping in proportion to stiffness, and a velocity at each node. */
static ct_scene *damped_scene(const ct_mesh *mesh, ct_solid_kernel kernel, double coefficient,
                              const double *velocities)
{
  ct_scene_body def = {.name = "damped",
                       .mesh = mesh,
                       .material = SOFT,
                       .kernel = kernel,
                       .velocities = velocities,
                       .stiffness_damping = coefficient};
  ct_scene *scene = new_scene();
  must(ct_scene_add_body, scene, &def, NULL);
  return scene;
}

/* The damping forces at the start of a run, and the velocity that they belong to. */
static void start_forces(const ct_mesh *mesh, int threads, double coefficient, const double *v0,
                         double *force, double *v)
{
  ct_scene *scene = damped_scene(mesh, CT_KERNEL_AUTO, coefficient, v0);
  set_threads(scene, threads);
  const ct_problem *problem = build_until(scene, 1.0, 0.01);
  ct_state *state = new_state(problem);
  must(ct_state_force, problem, state, 1, force);
  memcpy(v, state->velocity, 3 * (size_t)mesh->node_count * sizeof *v);
}

/* Add the forces of all elements in their readable form, times a factor. */
static void add_element_forces(const ct_mesh *mesh, double factor, const double *v, double *sum)
{
  const int per = ct_brick_node_count(mesh->kind);
  for (int e = 0; e < mesh->element_count; e++) {
    double x[60], u[60], f[60];
    take_element(mesh, e, mesh->nodes, x);
    take_element(mesh, e, v, u);
    must(ct_solid_element_force, mesh->kind, x, u, &SOFT, f, NULL);
    for (int a = 0; a < 3 * per; a++)
      sum[3 * mesh->elements[e * per + a / 3] + a % 3] += factor * f[a];
  }
}

/* The force is beta times that of the elements in their readable form at a displacement equal to
 * the velocity, for any shape of both bricks and for boxes (eq:stiffness-damping-force). */
static void stiffness_force(void)
{
  const double beta = 0.03;
  for (int k = 0; k < 4; k++) {
    ct_mesh *mesh = box_mesh(k < 2 ? CT_HEX8 : CT_HEX20, 0, 0, 0, 2, 1, 3, 9, 2, 3);
    if (k % 2 == 0) distort(mesh, 0.1);
    const int32_t dofs = 3 * mesh->node_count;
    double *v0 = numbers(dofs), *v = numbers(dofs), *want = numbers(dofs), *one = numbers(dofs),
           *two = numbers(dofs);
    for (int d = 0; d < dofs; d++) v0[d] = uniform(1.0);
    start_forces(mesh, 1, beta, v0, one, v);
    start_forces(mesh, 2, beta, v0, two, v);
    add_element_forces(mesh, beta, v, want);
    tap_ok(memcmp(one, two, (size_t)dofs * sizeof *one) == 0,
           "damping in proportion to stiffness: 1 and 2 threads have the same bits");
    tap_close(largest_difference(one, want, dofs) / largest(want, dofs), 0.0, 1e-13,
              "its force is -beta K v (%s, %s)", ct_brick_facts_of(mesh->kind)->name,
              k % 2 == 0 ? "distorted" : "boxes");
  }
}

/* One layer in plane strain: the same motion as with the kernel for boxes. */
static void stiffness_in_plane_strain(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 3, 2, 0.5, 12, 8, 1);
  const int32_t dofs = 3 * mesh->node_count;
  double *v = numbers(dofs), *u = numbers(dofs), off = 0.0;
  for (int n = 0; n < dofs / 3; n++)
    for (int c = 0; c < 2; c++)
      v[3 * n + c] = sin(2.0 * mesh->nodes[3 * n] + c) * cos(mesh->nodes[3 * n + 1]);
  for (int plane = 0; plane < 2; plane++) {
    ct_scene *scene = damped_scene(mesh, plane ? CT_KERNEL_PLANE : CT_KERNEL_BOX, 0.01, v);
    add_support(scene, 0, mesh, -1, 0.0, "z", 0.0);
    const ct_problem *problem = build(scene, (ct_scene_time){.end = 1.0, .dt = 1e-3}, NULL, NULL);
    ct_state *state = new_state(problem);
    advance(problem, state, 200);
    if (plane) off = largest_difference(u, state->displacement, dofs) / largest(u, dofs);
    else memcpy(u, state->displacement, (size_t)dofs * sizeof *u);
  }
  tap_close(off, 0.0, 1e-12, "in plane strain the motion is that of the boxes");
}

/* A run of 3000 steps of one free brick, at a part of its stable step: the strain energy at the end
 * over the largest one in the first 20 steps, and the growth of the total energy in these. */
static double grown(double beta, double fraction, double *stable, double *gain)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 0.7, 0.8, 1, 1, 1);
  double v[24], strain = 0.0;
  ct_stable_step step;
  for (int d = 0; d < 24; d++) v[d] = uniform(1.0);
  ct_scene *scene = damped_scene(mesh, CT_KERNEL_AUTO, beta, v);
  ct_problem p = *build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, &step);
  p.dt = fraction * step.dt;
  ct_state *state = new_state(&p);
  const ct_energy first = energy_of(&p, state);
  *stable = step.dt;
  *gain = 0.0;
  for (int n = 0; n < 20; n++) {
    must(ct_step, &p, state);
    const ct_energy now = energy_of(&p, state);
    strain = fmax(strain, now.strain);
    *gain = fmax(*gain, now.total / first.total - 1.0);
  }
  for (int n = 20; n < 3000; n++) must(ct_step, &p, state);
  strain =
      largest(state->displacement, 24) < 1e100 ? energy_of(&p, state).strain / strain : INFINITY;
  close_run(state, scene, mesh);
  return strain;
}

/* The stable step is (2 / omega)(sqrt(1 + xi^2) - xi) with xi = beta omega / 2, from the undamped
 * one: just below it the fastest mode decays, above it grows (eq:stiffness-damping-bound). */
static void stiffness_bound(void)
{
  double free_step, gain;
  (void)grown(0.0, 0.5, &free_step, &gain);
  const double omega = 2.0 / free_step;
  for (int k = 0; k < 3; k++) {
    const double xi = k == 0 ? 0.1 : k == 1 ? 1.0 : 10.0, beta = 2.0 * xi / omega;
    double step, low = grown(beta, 0.999, &step, &gain), same, lost,
                 high = grown(beta, 1.02, &same, &lost);
    tap_close(step / (free_step * (sqrt(1.0 + xi * xi) - xi)), 1.0, 1e-12,
              "the stable step at xi = %g is %.3f of the undamped one", xi, step / free_step);
    tap_ok(low < 1e-3 && gain < 1e-12,
           "at .999 of it the motion decays (%.2g), without gain (%.1e)", low, gain);
    tap_ok(!(high < 1e10), "at 1.02 of it it grows (%.2g)", high);
  }
}

/* A standing wave of a bar with nu = 0: u = a(t) cos(k x), with the loop of one oscillator of
 * omega = (2 c / h) sin(k h / 2) and damping beta omega^2 written here; and its decay is near
 * exp(-beta omega^2 t / 2) (eq:stiffness-damping-ratio). The work of the damping is the loss. */
static void standing_wave(void)
{
  enum { CELLS = 20, WAVES = 3 };
  static const ct_material bar = {.young = 900.0, .poisson = 0.0, .density = 1.0};
  const double h = 0.5, k = acos(-1.0) * WAVES / (CELLS * h),
               omega = 2.0 * 30.0 / h * sin(0.5 * k * h), beta = 0.1 / omega;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, CELLS * h, h, h, CELLS, 1, 1);
  const int32_t dofs = 3 * mesh->node_count;
  double *v = numbers(dofs), off = 0.0, a = 0.0;
  for (int n = 0; n < dofs / 3; n++) v[3 * n] = cos(k * mesh->nodes[3 * n]);
  ct_scene_body def = {.mesh = mesh, .material = bar, .velocities = v, .stiffness_damping = beta};
  ct_scene *scene = new_scene();
  must(ct_scene_add_body, scene, &def, NULL);
  const ct_problem *p = build_until(scene, 40.0 / omega, 0.3);
  ct_state *state = new_state(p);
  ct_energy first = energy_of(p, state), now;
  // The first kick goes half a step back with the damping of the velocity at t = 0.
  double s = 1.0 + 0.5 * p->dt * beta * omega * omega, peak = 0.0;
  while (state->time < 39.9 / omega) {
    advance(p, state, 1);
    s -= p->dt * (omega * omega * a + beta * omega * omega * s);
    a += p->dt * s;
    off = worst(off, state->displacement[0] - a);
    if (state->time > 35.0 / omega) peak = fmax(peak, fabs(a));
  }
  now = energy_of(p, state);
  double work;
  must(ct_energy_work, p, state, 1, &work);
  tap_close(off * omega, 0.0, 1e-11, "a standing wave moves like one damped oscillator");
  // The last peak is at most half a period before 39.9 / omega.
  tap_ok(peak * omega < exp(-0.05 * 35.0) && peak * omega > exp(-0.05 * 39.9) * 0.9,
         "and decays like exp(-beta omega^2 t / 2), to %.3f", peak * omega);
  tap_ok(work < 0.0 && strcmp(p->effects[1]->label, "damping") == 0, "damping takes energy (%g)",
         work);
  tap_close((first.total - now.total) / first.total, 0.0, 1e-12, "its work is the loss of energy");
  tap_close(now.balance / first.kinetic, 0.0, 1e-13, "and the work balance closes");
}

/* Free flight and a body without damping feel nothing, and wrong coefficients are refused. */
static void stiffness_leaves(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene_body def = {.name = "one",
                       .mesh = mesh,
                       .material = SOFT,
                       .velocity = {3, -4, 1},
                       .stiffness_damping = 0.1};
  ct_scene *scene = new_scene();
  ct_error e = {0};
  must(ct_scene_add_body, scene, &def, NULL);
  add_body(scene, "two", mesh, &SOFT, CT_KERNEL_AUTO, 0, 1, 0);
  const ct_problem *p = build_until(scene, 1.0, 0.5);
  ct_state *state = new_state(p);
  advance(p, state, 20);
  tap_ok(p->effects[1]->node_count == mesh->node_count, "damping acts on one of two bodies");
  tap_ok(state->velocity[0] == 3.0 && state->velocity[1] == -4.0, "free flight is not damped");
  scene = new_scene();
  for (int k = 0; k < 2; k++) {
    def.stiffness_damping = k == 0 ? -1.0 : INFINITY;
    tap_ok(ct_scene_add_body(scene, &def, NULL, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  }
  def.stiffness_damping = 0.1;
  def.material.law = CT_NEO_HOOKEAN;
  const ct_scene_time time = {.end = 1.0, .fraction = 0.5};
  must(ct_scene_add_body, scene, &def, NULL);
  tap_ok(ct_scene_build(scene, &time, &p, &(int64_t){0}, NULL, &e) == CT_ERROR_UNSUPPORTED, "%s",
         e.text);
}

int main(void)
{
  free_at_end();
  decay();
  strong();
  relaxation_by_hand();
  residual_by_hand();
  relaxation();
  unrest_of_free_bodies();
  stiffness_force();
  stiffness_in_plane_strain();
  stiffness_bound();
  standing_wave();
  stiffness_leaves();
  return tap_done();
}
