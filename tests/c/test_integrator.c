/* Integrators compared with the algorithms of their authors; amplification, orders, and energy
 * balances. */
#include "../../libcontact/src/base/amplitude.h"
#include "../../libcontact/src/step/workspace.h"
#include "bodies.h"

static const ct_material SOFT = {2.0, 0.3, 1.5, CT_LINEAR};
enum { SCHEMES = CT_SCHEME_COUNT, MOST = 9 };

static const ct_scheme_facts *facts(int scheme) { return ct_integrator_facts((ct_scheme)scheme); }

/* Each row of the table is whole, and its stages need no more than it says (eq:stage). */
static void rows(void)
{
  for (int s = 0; s < SCHEMES; s++) {
    const ct_scheme_facts *f = facts(s);
    tap_ok(f->name != NULL && f->parameter != NULL, "scheme %d has a row", s);
    tap_ok(f->least <= f->usual && f->usual <= f->most && f->order >= 1, "%s: range and order",
           SCHEME(s));
    int leapfrogs = 0, stored = 0, whole = 1;
    for (int k = 0; k <= 10; k++) {
      ct_integrator g = {(ct_scheme)s, f->least + 0.1 * k * (f->most - f->least)};
      ct_stage stage[2];
      double tau = 0.0, c = 0.0;
      int count = ct_integrator_stages(&g, stage);
      for (int i = 0; i < count; i++) tau += stage[i].tau, c += stage[i].c;
      whole &= fabs(tau - 1.0) < 1e-15 && fabs(c - 1.0) < 1e-15;
      stored |= stage[0].l != 0.0;
      leapfrogs += ct_integrator_is_leapfrog(&g);
      whole &= ct_integrator_evaluations(&g) == count;
    }
    tap_ok(whole, "%s: its stages add up to a step", SCHEME(s));
    tap_ok(f->stores == stored, "%s stores an acceleration if its first stage uses one", SCHEME(s));
    tap_ok(s == CT_CENTRAL_DIFFERENCE ? leapfrogs == 11 : leapfrogs < 2, "%s: another drift",
           SCHEME(s));
  }
  tap_ok(facts(-1) == NULL && facts(SCHEMES) == NULL, "no other scheme has a row");
}

/* -- Amplification of K and C (Δt² M⁻¹K, Δt M⁻¹C), n degrees of freedom: rows u, Δt v, Δt² a -- */

typedef struct matrix {
  int n;
  double a[MOST][MOST];
} matrix;

static matrix product(const matrix *x, const matrix *y)
{
  matrix z = {x->n, {{0.0}}};
  for (int i = 0; i < x->n; i++)
    for (int j = 0; j < x->n; j++)
      for (int k = 0; k < x->n; k++) z.a[i][j] += x->a[i][k] * y->a[k][j];
  return z;
}

static matrix amplification(const ct_integrator *integrator, int n, double K[3][3], double C[3][3])
{
  ct_stage stages[2];
  int count = ct_integrator_stages(integrator, stages);
  matrix all = {3 * n, {{0.0}}};
  for (int i = 0; i < 3 * n; i++) all.a[i][i] = 1.0;
  for (int s = 0; s < count; s++) {
    matrix one = {3 * n, {{0.0}}};
    ct_stage g = stages[s];
    for (int i = 0; i < n; i++) {
      one.a[i][i] = one.a[n + i][n + i] = 1.0;
      one.a[i][n + i] = g.tau;
      one.a[i][2 * n + i] = g.tau * g.l;
      for (int j = 0; j < n; j++) {
        const double stiff = -K[i][j], slow = -C[i][j];
        one.a[2 * n + i][j] = stiff, one.a[2 * n + i][n + j] = slow;
        one.a[n + i][j] += g.c * stiff, one.a[n + i][n + j] += g.c * slow;
        one.a[i][j] += g.tau * g.r * stiff, one.a[i][n + j] += g.tau * g.r * slow;
      }
    }
    all = product(&one, &all);
  }
  return all;
}

/* lim |A^m|^(1/m), by squaring 40 times. */
static double spectral_radius(matrix A)
{
  double logarithm = 0.0, power = 1.0;
  for (int k = 0; k < 40; k++) {
    double top = 0.0;
    for (int i = 0; i < A.n; i++)
      for (int j = 0; j < A.n; j++) top = worst(top, A.a[i][j]);
    if (top == 0.0) return 0.0;
    for (int i = 0; i < A.n; i++)
      for (int j = 0; j < A.n; j++) A.a[i][j] /= top;
    logarithm += log(top) / power;
    power *= 2.0;
    A = product(&A, &A);
  }
  return exp(logarithm);
}

static double radius(const ct_integrator *integrator, double x, double y)
{
  double K[3][3] = {{x}}, C[3][3] = {{y}};
  return spectral_radius(amplification(integrator, 1, K, C));
}

/* The spectral radius of the stages up to the limit and beyond (eq:integrator-limits). */
static void limits(void)
{
  for (int s = 0; s < SCHEMES; s++) {
    const ct_scheme_facts *f = facts(s);
    const double value[4] = {f->usual, f->least, f->most, f->least + 0.3 * (f->most - f->least)};
    ct_integrator all[4];
    for (int i = 0; i < 4; i++) {
      all[i] = (ct_integrator){(ct_scheme)s, value[i]};
      double top = ct_integrator_limit(&all[i]), highest = 0.0;
      for (int k = 1; k < 1000; k++)
        highest = fmax(highest, radius(&all[i], top * top * k * k * 1e-6, 0.0));
      tap_ok(highest < 1.0 + 1e-9, "%s %.3g: spectral radius below Omega = %.4f is %.10f at most",
             SCHEME(all[i].scheme), all[i].parameter, top, highest);
      double beyond = radius(&all[i], top * top * 1.002, 0.0);
      tap_ok(beyond > 1.001, "%s %.3g: spectral radius at 1.001 of the limit is %.4f",
             SCHEME(all[i].scheme), all[i].parameter, beyond);
    }
  }
  tap_close(ct_integrator_limit(&(ct_integrator){CT_NOH_BATHE, 0.54}), 3.745, 5e-4,
            "Noh and Bathe, p = 0.54: the limit of their paper");
}

/* With damping: any symmetric K and C, commuting or not, at the bound that is reported
 * (eq:integrator-damped-bound). */
static void damped_bounds(void)
{
  for (int s = 0; s < SCHEMES; s++) {
    ct_integrator g = ct_integrator_default((ct_scheme)s);
    double highest = 0.0, loosest = 0.0;
    for (int trial = 0; trial < 4000; trial++) {
      double K[3][3] = {{0.0}}, C[3][3] = {{0.0}};
      // Projections on random directions: their largest eigenvalue is 1.
      for (int m = 0; m < 2; m++) {
        double d[3] = {uniform(1.0), uniform(1.0), trial % 2 ? uniform(1.0) : 0.0},
               length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int i = 0; i < 3; i++)
          for (int j = 0; j < 3; j++)
            (m == 0 ? K : C)[i][j] = trial % 5 == 0 ? (i == j) - d[i] * d[j] / (length * length)
                                                    : d[i] * d[j] / (length * length);
      }
      double damping = 4.0 * fabs(uniform(1.0)), dt = ct_integrator_step(&g, 1.0, damping);
      for (int i = 0; i < 9; i++) K[i / 3][i % 3] *= dt * dt, C[i / 3][i % 3] *= damping * dt;
      highest = fmax(highest, spectral_radius(amplification(&g, 3, K, C)));
      loosest = fmax(loosest, radius(&g, 1.02 * 1.02 * dt * dt, 1.02 * damping * dt));
    }
    tap_ok(highest < 1.0 + 1e-6,
           "%s: with damping the spectral radius at the bound is %.9f at most", SCHEME(g.scheme),
           highest);
    tap_ok(loosest > 1.0 + 1e-4, "%s: 2 %% above the bound it is up to %.4f", SCHEME(g.scheme),
           loosest);
  }
}

/* -- The algorithms as their authors write them, for u'' = -w u -- */

typedef struct point {
  double u, v, a;
} point;

static point chung_lee(point x, double w, double dt, double beta)
{
  point y = {0.0, 0.0, -w * x.u};
  y.u = x.u + dt * x.v + dt * dt * ((0.5 - beta) * x.a + beta * y.a);
  y.v = x.v + dt * (-0.5 * x.a + 1.5 * y.a);
  return y;
}

static point noh_bathe(point x, double w, double dt, double p)
{
  double q1 = (1.0 - 2.0 * p) / (2.0 * p * (1.0 - p)), q2 = 0.5 - p * q1, q0 = -q1 - q2 + 0.5,
         s = (1.0 - p) * dt;
  point m = {x.u + p * dt * x.v + 0.5 * p * p * dt * dt * x.a, 0.0, 0.0}, y;
  m.a = -w * m.u;
  m.v = x.v + 0.5 * p * dt * (x.a + m.a);
  y.u = m.u + s * m.v + 0.5 * s * s * m.a;
  y.a = -w * y.u;
  y.v = m.v + 0.5 * s * m.a + s * (q0 * x.a + q1 * m.a + q2 * y.a);
  return y;
}

static point tchamwa_wielgosz(point x, double w, double dt, double rho)
{
  double phi = 2.0 / (1.0 + rho), a = -w * x.u;
  return (point){x.u + dt * x.v + phi * dt * dt * a, x.v + dt * a, a};
}

/* The methods as published, and whether the velocity of the formula is that at t_n; the leapfrog
 * has a program of its own, test_step. */
static const struct {
  point (*step)(point x, double w, double dt, double parameter);
  int at_steps;
} PUBLISHED[SCHEMES] = {[CT_CHUNG_LEE] = {chung_lee, 0},
                        [CT_NOH_BATHE] = {noh_bathe, 1},
                        [CT_TCHAMWA_WIELGOSZ] = {tchamwa_wielgosz, 0}};

/* The dilatation of a cube is an oscillator with omega^2 = 12 K / (rho h^2); its runs against the
 * formulas of the papers (eq:stage, eq:chung-lee-drift, eq:tchamwa-wielgosz-drift,
 * eq:noh-bathe-stages, eq:stage-velocity). The work of the
 * solid is the kinetic energy that it gives (eq:stage-work). */
static void textbook(ct_scheme scheme, double share)
{
  const double h = 0.5, bulk = SOFT.young / (3.0 * (1.0 - 2.0 * SOFT.poisson)),
               w = 12.0 * bulk / (SOFT.density * h * h);
  ct_mesh *m = box_mesh(CT_HEX8, -h / 2, -h / 2, -h / 2, h, h, h, 1, 1, 1);
  ct_scene *scene = new_scene();
  ct_integrator g = ct_integrator_default(scheme);
  add_body(scene, "body", m, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  int64_t steps;
  ct_stable_step stable;
  ct_problem q =
      *build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5, .integrator = g}, &steps, &stable);
  tap_close(stable.dt * sqrt(w), ct_integrator_limit(&g), 1e-9,
            "%s: the reported step is the limit over omega", SCHEME(scheme));
  q.initial_velocity = m->nodes;
  q.dt = share * stable.dt;
  ct_state *state = new_state(&q);
  point x = {0.0, 1.0, 0.0};
  double off = 0.0, top = 0.0, *v = numbers(24), wrong = 0.0, balance = 0.0,
         kinetic = energy_of(&q, state).kinetic;
  for (int n = 1; n <= 300; n++) {
    advance(&q, state, 1);
    balance = worst(balance, energy_of(&q, state).balance / kinetic);
    must(ct_state_velocity, &q, state, v);
    x = PUBLISHED[scheme].step(x, w, q.dt, g.parameter);
    for (int i = 0; i < 24; i++) off = worst(off, state->displacement[i] - x.u * m->nodes[i]);
    for (int i = 0; i < 24 && PUBLISHED[scheme].at_steps; i++)
      wrong = worst(wrong, v[i] - x.v * m->nodes[i]);
    top = worst(top, x.u * h / 2);
  }
  tap_ok(off < 1e-11 * top,
         "%s at %.2f of its limit: 300 steps as its authors write them, off by %.2g",
         SCHEME(scheme), share, off / top);
  tap_ok(wrong < 1e-11 * top * sqrt(w), "%s: the velocities, too, off by %.2g", SCHEME(scheme),
         wrong);
  tap_close(balance, 0.0, 1e-11, "%s: and the work balance closes", SCHEME(scheme));
  close_run(state, scene, m);
}

/* A stone that is thrown: methods of second order have its parabola exactly, from the first step
 * on (eq:stage-start, eq:stage-velocity). */
static void free_fall(ct_scheme scheme)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("stone", m, &SOFT, CT_KERNEL_AUTO, 0.5, 0, 2);
  add_weight(scene, (weight){.g = {0, 0, -3}});
  const ct_problem *p = build_by(scheme, scene, 1.0, 0.9, NULL);
  ct_state *state = new_state(p);
  double off = 0.0, fast = 0.0, v[24];
  for (int64_t n = 0; n < 20; n++) {
    advance(p, state, 1);
    must(ct_state_velocity, p, state, v);
    double t = state->time;
    for (int i = 0; i < 24; i += 3)
      off = worst(off, state->displacement[i + 2] - (2.0 * t - 1.5 * t * t)),
      fast = worst(fast, v[i + 2] - (2.0 - 3.0 * t));
  }
  tap_ok(off < 1e-14 * 20 && fast < 1e-14 * 20,
         "%s: a thrown stone, position off by %.2g and velocity by %.2g", SCHEME(scheme), off,
         fast);
}

/* Two cubes that touch and collide: the forces at the start must be those of the first displacement
 * increment, and the velocity the given one. */
static void pressed_start(ct_scheme scheme, double beta)
{
  ct_mesh *a = box_mesh(CT_HEX8, -1, 0, 0, 1, 1, 1, 1, 1, 1),
          *b = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("a", a, &SOFT, CT_KERNEL_AUTO, 0.5, 0, 0);
  add_body(scene, "b", b, &SOFT, CT_KERNEL_AUTO, -0.5, 0, 0);
  ct_contact_options options = ct_contact_options_default();
  add_contact_with(scene, 0, a, 0.0, 1, b, 0.0, 0, beta, options, 0.0, 1.0);
  const ct_problem *p = build_by(scheme, scene, 1.0, 0.9, NULL);
  ct_state *state = new_state(p);
  double *v = numbers(3 * p->node_count), *force = numbers(3 * p->node_count);
  must(ct_state_velocity, p, state, v);
  must(ct_state_force, p, state, 1, force);
  double off = largest_difference(v, p->initial_velocity, 3 * p->node_count),
         push = largest(force, 3 * p->node_count);
  tap_ok(off < 1e-13 && push > 0.0, "%s, beta %g: pressed from the start, velocity off by %.2g",
         SCHEME(scheme), beta, off);
}

/* A loaded, held, moving body: against a very fine run of the central difference method. */
static void order_of(ct_scheme scheme)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  distort(m, 0.04);
  ct_scene *scene = new_scene_with("body", m, &SOFT, CT_KERNEL_AUTO, 0.3, -0.1, 0.2);
  add_weight(scene, (weight){.g = {0.5, -1.0, 0.25}});
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.6}, &steps, NULL);
  int n = 3 * p->node_count;
  double *v0 = numbers(n), *fine = numbers(2 * n), *now = numbers(2 * n), error[2][3];
  for (int i = 0; i < n; i++) v0[i] = sin(2.0 * p->reference[i] + p->reference[3 * (i / 3)]);
  for (int k = -1; k < 3; k++) {
    int64_t count = k < 0 ? 512 * steps : 4 * steps << k;
    ct_problem q = *p;
    q.dt = 1.0 / (double)count;
    q.initial_velocity = v0;
    if (k >= 0) q.integrator = ct_integrator_default(scheme);
    ct_state *state = new_state(&q);
    advance(&q, state, count);
    memcpy(now, state->displacement, (size_t)n * sizeof *now);
    must(ct_state_velocity, &q, state, now + n);
    if (k < 0) memcpy(fine, now, 2 * (size_t)n * sizeof *now);
    for (int i = 0; k >= 0 && i < 2; i++)
      error[i][k] = largest_difference(now + i * n, fine + i * n, n);
    free_state(state);
  }
  for (int i = 0; i < 2; i++) {
    double order = log(error[i][1] / error[i][2]) / log(2.0);
    tap_ok(fabs(order - facts(scheme)->order) < 0.15,
           "%s: %s has order %.3f in dt (errors %.2g %.2g %.2g)", SCHEME(scheme),
           i ? "velocity" : "displacement", order, error[i][0], error[i][1], error[i][2]);
  }
}

/* -- Two different bodies that meet askew, with a weight, damping, a moving support and a
 * prescribed motion -- */

typedef struct meeting {
  ct_scene *scene;
  ct_problem own;
} meeting;

static meeting meet(ct_integrator integrator, ct_enforcement enforcement, double friction)
{
  meeting c = {new_scene(), {0}};
  ct_mesh *a = box_mesh(CT_HEX8, -1, 0, 0, 1, 1, 1, 3, 2, 3),
          *b = box_mesh(CT_HEX8, 0, 0.125, 0.25, 1.25, 0.75, 1, 4, 3, 2);
  random_seed = 4711;
  add_body(c.scene, "a", a, &SOFT, CT_KERNEL_AUTO, 0.5, 0.0625, -0.125);
  add_body(c.scene, "b", b, &SOFT, CT_KERNEL_AUTO, -0.25, 0, 0.25);
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = enforcement;
  add_contact_with(c.scene, 0, a, 0.0, 1, b, 0.0, 0, 2.0, options, friction, 1.0);
  add_support(c.scene, 0, a, 0, -1.0, "y", 0.05);
  add_weight(c.scene, (weight){.g = {0.1, 0.2, -0.3}, .damping = 0.2, .pull = 0.5, .period = 0.4});
  const ct_problem *joined;
  int32_t held[2] = {a->node_count, a->node_count + 3};
  double times[3] = {0.0, 0.3, 1.0}, values[3] = {0.0, 1.0, -0.5};
  ct_motion motion = {held, 2, {0, 1, 0}, {0, 0.02, 0}, {3, times, values}};
  ct_effect *effect;
  must(ct_scene_join, c.scene, &joined);
  must(create_motion, &motion, 1, joined, &effect);
  must(ct_scene_add_effect, c.scene, effect);
  c.own = *build(c.scene, (ct_scene_time){.end = 1.0, .fraction = 0.7, .integrator = integrator},
                 NULL, NULL);
  return c;
}

/* Work balance, momenta and a prescribed motion in each method (eq:stage-work, eq:stage-motion,
 * eq:motion-velocity, eq:motion-force). */
static void ledger(ct_scheme scheme, ct_enforcement enforcement)
{
  meeting c = meet(ct_integrator_default(scheme), enforcement, 0.3);
  ct_problem *p = &c.own;
  ct_state *state = new_state(p);
  ct_momentum first[2] = {momentum_of(p, state, 0), momentum_of(p, state, 1)};
  double balance = 0.0, momentum = 0.0, size = energy_of(p, state).kinetic, path = 0.0,
         touched = 0.0, times[3] = {0.0, 0.3, 1.0}, values[3] = {0.0, 1.0, -0.5};
  int32_t held = p->bodies[1].first_node;
  for (int n = 0; n < 100; n++) {
    advance(p, state, 1);
    ct_energy now = energy_of(p, state);
    balance = worst(balance, now.balance / size);
    touched = worst(touched, momentum_of(p, state, 0).contact_impulse[0]);
    double want = 0.02 * ct_amplitude_value(&(ct_amplitude){3, times, values}, state->time);
    path = worst(path, state->displacement[3 * held + 1] - want);
    double sum[3] = {0, 0, 0}, all = 0.0;
    for (int k = 1; k < p->effect_count; k++) {
      double impulse[3];
      must(ct_energy_impulse, p, state, k, impulse);
      for (int i = 0; i < 3; i++) sum[i] += impulse[i];
    }
    for (int body = 0; body < 2; body++) {
      ct_momentum m = momentum_of(p, state, body);
      for (int i = 0; i < 3; i++) sum[i] -= m.p[i] - first[body].p[i], all += fabs(m.p[i]);
    }
    for (int i = 0; i < 3; i++) momentum = worst(momentum, sum[i] / all);
  }
  tap_ok(touched > 0.1 * fabs(first[0].p[0]), "%s, %s: the bodies have met", SCHEME(scheme),
         ENFORCEMENT[enforcement]);
  tap_ok(balance < 1e-12, "%s, %s: work balance %.2g", SCHEME(scheme), ENFORCEMENT[enforcement],
         balance);
  tap_ok(momentum < 1e-12, "%s, %s: momentum against impulses %.2g", SCHEME(scheme),
         ENFORCEMENT[enforcement], momentum);
  tap_ok(path < 1e-15, "%s, %s: a prescribed motion is followed to %.2g", SCHEME(scheme),
         ENFORCEMENT[enforcement], path);
  free_state(state);
}

/* β = 1 and ρ∞ = 1 are the central difference method. */
static void is_central(ct_integrator integrator)
{
  meeting c = meet(integrator, CT_ENFORCE_ENERGY_CONTROLLED, 0.3),
          d = meet((ct_integrator){CT_CENTRAL_DIFFERENCE, 0.0}, CT_ENFORCE_ENERGY_CONTROLLED, 0.3);
  ct_state *x = new_state(&c.own), *y = new_state(&d.own);
  advance(&c.own, x, 80);
  advance(&d.own, y, 80);
  size_t n = 3 * (size_t)x->node_count * sizeof(double);
  tap_ok(c.own.dt == d.own.dt && !memcmp(x->displacement, y->displacement, n) &&
             !memcmp(x->velocity, y->velocity, n) &&
             energy_of(&c.own, x).balance == energy_of(&d.own, y).balance,
         "%s %g: the bits of the central difference method", SCHEME(integrator.scheme),
         integrator.parameter);
  free_state(x);
  close_run(y, c.scene, NULL);
}

/* A bar on a rigid wall with the explicit penalty, beta = 1, at 0.9 of the true limit of bar and
 * penalty: the error of the force while the wave runs. */
static void bar_on_wall(ct_scheme scheme, double least, double most)
{
  ct_material stuff = {900.0, 0.0, 1.0, CT_LINEAR};
  ct_mesh *bar = box_mesh(CT_HEX8, 5, 0, 0, 10, 0.5, 0.5, 100, 1, 1);
  ct_scene *scene = new_scene_with("bar", bar, &stuff, CT_KERNEL_AUTO, -10, 0, 0);
  int32_t faces[8];
  ct_obstacle_def wall = {COOKIE,
                          .shape = CT_OBSTACLE_PLANE,
                          .axis = {1, 0, 0},
                          .epsilon = 900.0 / 0.1,
                          .enforcement = CT_ENFORCE_PENALTY,
                          .kind = CT_Q4,
                          .face_count = ct_mesh_plane_faces(bar, 0, 5.0, faces, NULL),
                          .faces = faces};
  add_made(scene, ct_obstacle_create_effect, &wall);
  ct_problem q = *build_by(scheme, scene, 1.4, 0.5, NULL);
  // Omega of a bar with a penalty of one element's stiffness at its end (eq:step-bar with half of
  // it), c = 30, h = 0.1.
  q.dt = 0.9 * ct_integrator_limit(&q.integrator) / (300.0 * sqrt(2.0 + 2.0 * sqrt(2.0)));
  ct_state *state = new_state(&q);
  double *force = numbers(3 * q.node_count), sum = 0.0, start = energy_of(&q, state).kinetic;
  int count = 0;
  while (state->time < 1.4) {
    advance(&q, state, 1);
    if (state->time < 0.55 || state->time > 1.12) continue;
    must(ct_state_force, &q, state, 1, force);
    double pressure = 0.0;
    for (int n = 0; n < bar->node_count; n++) pressure += force[3 * n] / 0.25;
    sum += (pressure / 300.0 - 1.0) * (pressure / 300.0 - 1.0);
    count++;
  }
  double rms = sqrt(sum / count), kept = energy_of(&q, state).total / start;
  tap_ok(rms > least && rms < most, "%s: bar on a wall, force %.4f %% rms, energy kept %.4f",
         SCHEME(scheme), 100.0 * rms, kept);
  tap_ok(kept < 1.001, "%s: bar on a wall, no spurious energy", SCHEME(scheme));
  close_run(state, scene, bar);
}

static void refusals(void)
{
  const ct_integrator bad[] = {{(ct_scheme)4, 0.0},          {(ct_scheme)-1, 0.0},
                               {CT_CENTRAL_DIFFERENCE, 1.0}, {CT_CHUNG_LEE, 0.99},
                               {CT_CHUNG_LEE, 1.04},         {CT_NOH_BATHE, 0.49},
                               {CT_NOH_BATHE, 0.6},          {CT_TCHAMWA_WIELGOSZ, -0.1},
                               {CT_TCHAMWA_WIELGOSZ, 1.1},   {CT_TCHAMWA_WIELGOSZ, NAN}};
  ct_error e;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    tap_ok(ct_integrator_check(&bad[i], &e) == CT_ERROR_ARGUMENT,
           "scheme %d with %g is refused: %s", (int)bad[i].scheme, bad[i].parameter, e.text);
  tap_ok(ct_integrator_check(NULL, &e) == CT_ERROR_ARGUMENT, "no integrator");
  tap_ok(ct_integrator_facts((ct_scheme)7) == NULL && ct_integrator_limit(&bad[0]) == 2.0 &&
             ct_integrator_limit(&bad[1]) == 2.0,
         "an unknown scheme reads nothing behind the table");
  meeting c = meet(ct_integrator_default(CT_NOH_BATHE), CT_ENFORCE_PENALTY, 0.0);
  ct_problem other = c.own;
  ct_state *state = NULL;
  other.integrator.parameter = 2.0;
  tap_ok(ct_state_create(&other, &state, &e) == CT_ERROR_ARGUMENT && state == NULL,
         "no state with a parameter out of range: %s", e.text);
}

/* A host's effect that fails at one time. */
static ct_status fail_force(const ct_effect *effect, const ct_view *view, double *force,
                            ct_error *error)
{
  (void)error;
  memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  return view->time > *(const double *)effect->data ? CT_INVALID : CT_OK;
}

static void within_a_step(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("body", m, &SOFT, CT_KERNEL_AUTO, 1, 0, 0);
  double when = INFINITY;
  static const ct_effect_calls calls = {.force = fail_force};
  ct_effect filled = {
      .label = "moody", .calls = &calls, .data = &when, .node_count = m->node_count};
  ct_error e;
  ct_energy energy;
  add_effect(scene, &filled);
  const ct_problem *p =
      build(scene,
            (ct_scene_time){
                .end = 1.0, .fraction = 0.5, .integrator = ct_integrator_default(CT_NOH_BATHE)},
            NULL, NULL);
  ct_state *state = new_state(p), *good = new_state(p);
  advance(p, state, 3);
  must(ct_state_copy, p, state, good);
  when = 3.3 * p->dt;
  tap_ok(ct_step(p, state, &e) == CT_INVALID, "a second stage fails, and so does its step");
  tap_ok(ct_step(p, state, &e) == CT_ERROR_ARGUMENT &&
             ct_energy_of(p, state, &energy, &e) == CT_ERROR_ARGUMENT,
         "a state between two stages is refused: %s", e.text);
  tap_ok(ct_state_copy(p, state, good, &e) == CT_ERROR_ARGUMENT && good->step == 3 &&
             good->time == 3.0 * p->dt,
         "it cannot be copied, and the other state does not change: %s", e.text);
  when = INFINITY;
  must(ct_state_copy, p, good, state);
  advance(p, state, 2);
  advance(p, good, 2);
  tap_ok(same_state(state, good), "a copy of the last good state continues");
  state->velocity[0] = NAN;
  tap_ok(ct_run(p, state, 4, NULL, 0, &e) != CT_OK, "a velocity that is NaN is refused: %s",
         e.text);
  must(ct_state_copy, p, good, state);
  advance(p, state, 2);
  advance(p, good, 2);
  tap_ok(same_state(state, good), "no trace of it remains in the destination of a copy");
}

int main(void)
{
  free_at_end();
  limits();
  damped_bounds();
  rows();
  for (int s = 1; s < SCHEMES; s++) {
    tap_ok(PUBLISHED[s].step != NULL, "%s: its published formula is here", SCHEME(s));
    if (PUBLISHED[s].step == NULL) continue;
    textbook((ct_scheme)s, 0.2);
    textbook((ct_scheme)s, 0.95);
  }
  for (int s = 0; s < SCHEMES; s++)
    if (facts(s)->order > 1) free_fall((ct_scheme)s);
  for (int s = 0; s < SCHEMES; s++)
    for (int k = 0; k < 2; k++) pressed_start((ct_scheme)s, k ? 1e4 : 2.0);
  for (int s = 0; s < SCHEMES; s++) order_of((ct_scheme)s);
  for (int s = 0; s < SCHEMES; s++)
    for (int e = 0; e < ENFORCEMENTS; e++) ledger((ct_scheme)s, (ct_enforcement)e);
  is_central((ct_integrator){CT_CHUNG_LEE, 1.0});
  is_central((ct_integrator){CT_TCHAMWA_WIELGOSZ, 1.0});
  bar_on_wall(CT_CENTRAL_DIFFERENCE, 0.15, 0.2);
  bar_on_wall(CT_CHUNG_LEE, 0.0001, 0.0005);
  bar_on_wall(CT_NOH_BATHE, 0.0001, 0.0005);
  bar_on_wall(CT_TCHAMWA_WIELGOSZ, 0.003, 0.004);
  within_a_step();
  refusals();
  return tap_done();
}
