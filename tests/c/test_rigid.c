/* Rigid bodies. */
#include "bodies.h"

#include "../../libcontact/src/constraint/bodies.h"
#include "../../libcontact/src/effect/rotation.h"

static const ct_material STEEL = {.young = 900.0, .poisson = 0.3, .density = 2.0};

static const ct_integrator LEAPFROG = {CT_CENTRAL_DIFFERENCE, 0.0};

/* Make one body of a scene rigid. */
static void add_rigid(ct_scene *scene, const ct_rigid *rigid)
{
  ct_rigid_def def = {COOKIE, .bodies = rigid, .body_count = 1};
  add_made(scene, ct_rigid_create_effect, &def);
}

/* Velocities of a mesh, v + ω × (X - c). */
static double *turning(const ct_mesh *mesh, const double v[3], const double w[3], const double c[3])
{
  double *out = numbers(3 * mesh->node_count);
  for (int32_t n = 0; n < mesh->node_count; n++)
    for (int k = 0; k < 3; k++) {
      int p = (k + 1) % 3, q = (k + 2) % 3;
      const double *X = &mesh->nodes[3 * n];
      out[3 * n + k] = v[k] + (w[p] * (X[q] - c[q]) - w[q] * (X[p] - c[p]));
    }
  return out;
}

/* A turn by a quaternion is Rodrigues' formula with cos φ and sin φ; Newton's method solves its
 * equation for turns up to a quarter, and says so where there is no solution
 * (eq:rigid-quaternion, eq:rigid-rotation, eq:rigid-newton, eq:rigid-inertia). */
static void rotations(void)
{
  double turn = 0.0, left = 0.0;
  int found = 0, most = tap_times(1000);
  for (int i = 0; i < most; i++) {
    const double angle = uniform(0.5 * acos(-1.0));
    double R[3][3], n[3], r[3], b[3], a, got[3], once[3], twice[3], h[3], turned[3], g[3];
    random_rotation(R);
    ct_inertia inertia = {.moment = {0}};
    for (int k = 0; k < 3; k++) {
      n[k] = R[k][0], r[k] = uniform(1.0), b[k] = n[k] * sin(0.5 * angle);
      // A second moment m r rᵀ along each of three axes.
      const double m = 1.5 + uniform(1.0), *e = R[k];
      for (int c = 0; c < 3; c++) {
        inertia.moment[c] += m * e[c] * e[c];
        inertia.moment[3 + c] += m * e[c] * e[(c + 1) % 3];
      }
    }
    ct_rotation_increment(b, cos(0.5 * angle), r, got);
    ct_vector_cross(n, r, once);
    ct_vector_cross(n, once, twice);
    for (int k = 0; k < 3; k++)
      turn = worst(turn, got[k] - (sin(angle) * once[k] + (1.0 - cos(angle)) * twice[k]));
    ct_inertia_times(&inertia, b, h);
    ct_vector_cross(b, h, turned);
    for (int k = 0; k < 3; k++) g[k] = 2.0 * (cos(0.5 * angle) * h[k] + turned[k]);
    const double wanted[3] = {b[0], b[1], b[2]};
    found += ct_rotation_find(&inertia, g, b, &a);
    for (int k = 0; k < 3; k++) left = worst(left, b[k] - wanted[k]);
  }
  tap_close(turn, 0.0, 1e-14, "turns by a quaternion");
  tap_ok(found == most && left < 1e-13, "%d of %d turns are found again, off by %.3g", found, most,
         left);
}

/* The rate of a quaternion and of ω in the axes of a body with the moments of inertia I. */
static void euler(const double I[3], const double y[7], double rate[7])
{
  const double *q = y, *w = y + 4;
  rate[0] = -0.5 * (q[1] * w[0] + q[2] * w[1] + q[3] * w[2]);
  rate[1] = 0.5 * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]);
  rate[2] = 0.5 * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]);
  rate[3] = 0.5 * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]);
  for (int c = 0; c < 3; c++) {
    int p = (c + 1) % 3, r = (c + 2) % 3;
    rate[4 + c] = (I[p] - I[r]) / I[c] * w[p] * w[r];
  }
}

/* Euler's equations by Runge and Kutta's method of order 4 with `steps` steps. */
static void tumble(const double I[3], double time, int steps, double y[7])
{
  double h = time / steps, k[4][7], z[7];
  static const double at[4] = {0.0, 0.5, 0.5, 1.0}, part[4] = {1 / 6.0, 1 / 3.0, 1 / 3.0, 1 / 6.0};
  for (int i = 0; i < steps; i++) {
    for (int s = 0; s < 4; s++) {
      for (int c = 0; c < 7; c++) z[c] = y[c] + (s == 0 ? 0.0 : h * at[s] * k[s - 1][c]);
      euler(I, z, k[s]);
    }
    for (int s = 0; s < 4; s++)
      for (int c = 0; c < 7; c++) y[c] += h * part[s] * k[s][c];
  }
}

/* Largest distance of the nodes from where a rotation y about the moving centre puts them. */
static double off_by(const ct_problem *p, const ct_state *state, const double centre[3],
                     const double v[3], const double y[7])
{
  double most = 0.0, b[3] = {y[1], y[2], y[3]};
  for (int32_t n = 0; n < p->node_count; n++) {
    double r[3], turned[3];
    for (int c = 0; c < 3; c++) r[c] = p->reference[3 * n + c] - centre[c];
    ct_rotation_increment(b, y[0], r, turned);
    for (int c = 0; c < 3; c++)
      most = worst(most, state->displacement[3 * n + c] - turned[c] - v[c] * state->time);
  }
  return most;
}

/* A box 3 : 2 : 1 of 3 x 2 x 2 bricks, turning mainly about its middle axis. */
typedef struct tumbler {
  ct_mesh *mesh;
  ct_scene *scene;
  const ct_problem *problem;
  double centre[3], v[3], w[3], I[3];
} tumbler;

static tumbler new_tumbler(double end, double dt, ct_integrator integrator)
{
  tumbler t = {.centre = {6.5, 1.0, -0.5}, .v = {0.1, -0.2, 0.3}, .w = {0.02, 1.0, 0.03}};
  static const double size[3] = {3, 2, 1}, cells[3] = {3, 2, 2};
  double second[3];
  t.mesh = box_mesh(CT_HEX8, 5, 0, -1, 3, 2, 1, 3, 2, 2);
  double *velocities = turning(t.mesh, t.v, t.w, t.centre);
  t.scene = new_scene();
  add_moving_body(t.scene, "box", t.mesh, &STEEL, CT_KERNEL_AUTO, velocities);
  add_rigid(t.scene, &(ct_rigid){.body = 0});
  t.problem =
      build(t.scene, (ct_scene_time){.end = end, .dt = dt, .integrator = integrator}, NULL, NULL);
  // Lumped by rows, n bricks along an edge a have the second moment m a² / 12 (1 + 2 / n²).
  for (int c = 0; c < 3; c++)
    second[c] = 12.0 * size[c] * size[c] / 12.0 * (1.0 + 2.0 / (cells[c] * cells[c]));
  for (int c = 0; c < 3; c++) t.I[c] = second[(c + 1) % 3] + second[(c + 2) % 3];
  return t;
}

/* Euler's equations, which the steps follow with order 2 (eq:rigid-rotation, eq:rigid-inertia,
 * eq:rigid-step, eq:rigid-start). */
static void tumbling(void)
{
  double error[3];
  for (int i = 0; i < 3; i++) {
    const double end = 20.0;
    tumbler t = new_tumbler(end, 0.04 / (1 << i), LEAPFROG);
    ct_state *state = new_state(t.problem);
    double y[7] = {1, 0, 0, 0, t.w[0], t.w[1], t.w[2]};
    advance(t.problem, state, (int64_t)lround(end / t.problem->dt));
    tumble(t.I, end, 20000, y);
    error[i] = off_by(t.problem, state, t.centre, t.v, y);
  }
  tap_ok(error[2] < 0.02, "a box tumbles as Euler's equations say: %.3g off after it has flipped",
         error[2]);
  for (int i = 0; i < 2; i++)
    tap_close(log2(error[i] / error[i + 1]), 2.0, 0.1, "order 2, errors %.3g and %.3g", error[i],
              error[i + 1]);
}

/* Over 10^5 steps momentum and angular momentum are constant to round-off, the energy does not
 * drift, and the body keeps its shape (eq:rigid-momentum, eq:rigid-force). */
static void many_steps(void)
{
  const int64_t steps = 100000;
  tumbler t = new_tumbler((double)steps * 0.04, 0.04, LEAPFROG);
  ct_state *state = new_state(t.problem);
  ct_energy first = energy_of(t.problem, state);
  ct_momentum start = momentum_of(t.problem, state, 0);
  double p = 0.0, L = 0.0, kinetic[2] = {0.0, 0.0}, balance = 0.0, shape = 0.0;
  for (int64_t i = 0; i < 1000; i++) {
    advance(t.problem, state, steps / 1000);
    ct_momentum now = momentum_of(t.problem, state, 0);
    ct_energy energy = energy_of(t.problem, state);
    for (int c = 0; c < 3; c++) {
      p = worst(p, now.p[c] - start.p[c]);
      L = worst(L, now.L[c] - start.L[c]);
    }
    double *most = &kinetic[i >= 500];
    *most = worst(*most, energy.kinetic / first.kinetic - 1.0);
    balance = worst(balance, energy.balance);
  }
  for (int32_t a = 0; a < t.problem->node_count; a++) {
    double before = 0.0, after = 0.0;
    for (int c = 0; c < 3; c++) {
      double X = t.problem->reference[3 * a + c] - t.problem->reference[c],
             x = X + state->displacement[3 * a + c] - state->displacement[c];
      before += X * X, after += x * x;
    }
    shape = worst(shape, sqrt(after) - sqrt(before));
  }
  // Sums of 10^5 rounded steps of numbers up to 10^4 (the box flies 1500 far).
  double scale = largest(start.p, 3);
  tap_close(p / scale, 0.0, 1e-12, "momentum after 10^5 steps");
  tap_close(L / largest(start.L, 3), 0.0, 1e-11, "angular momentum after 10^5 steps");
  tap_close(balance / first.kinetic, 0.0, 1e-11, "the work balance closes");
  tap_ok(kinetic[1] < 1e-6 && kinetic[1] < 1.01 * kinetic[0],
         "kinetic energy: off by %.3g in the first half, %.3g in the second", kinetic[0],
         kinetic[1]);
  tap_close(shape, 0.0, 1e-9, "the distances of the nodes");
}

/* Other integrators: their order is that of the table (eq:rigid-force). */
static void tumbling_otherwise(void)
{
  for (int scheme = CT_CHUNG_LEE; scheme < CT_SCHEME_COUNT; scheme++) {
    const ct_integrator integrator = ct_integrator_default((ct_scheme)scheme);
    const double order = ct_integrator_facts((ct_scheme)scheme)->order, end = 10.0;
    double error[2], L = 0.0;
    for (int i = 0; i < 2; i++) {
      tumbler t = new_tumbler(end, 0.01 / (1 << i), integrator);
      ct_state *state = new_state(t.problem);
      ct_momentum start = momentum_of(t.problem, state, 0);
      double y[7] = {1, 0, 0, 0, t.w[0], t.w[1], t.w[2]};
      advance(t.problem, state, (int64_t)lround(end / t.problem->dt));
      tumble(t.I, end, 10000, y);
      error[i] = off_by(t.problem, state, t.centre, t.v, y);
      ct_momentum now = momentum_of(t.problem, state, 0);
      for (int c = 0; c < 3; c++) L = worst(L, now.p[c] - start.p[c]);
    }
    tap_close(log2(error[0] / error[1]), order, 0.1, "%s: order, errors %.3g and %.3g",
              SCHEME(scheme), error[0], error[1]);
    tap_close(L, 0.0, 1e-12, "%s: momentum", SCHEME(scheme));
  }
}

/* Complete elliptic integral K(k) by the arithmetic and the geometric mean. */
static double elliptic(double k)
{
  double a = 1.0, b = sqrt(1.0 - k * k);
  for (int i = 0; i < 10; i++) {
    double mean = 0.5 * (a + b);
    b = sqrt(a * b);
    a = mean;
  }
  return acos(-1.0) / (2.0 * a);
}

/* A box that hangs from a pivot. */
static ct_scene *hanging(ct_mesh *mesh, const double *velocities, const ct_rigid *rigid, double g)
{
  ct_scene *scene = new_scene();
  if (velocities == NULL) add_body(scene, "box", mesh, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  else add_moving_body(scene, "box", mesh, &STEEL, CT_KERNEL_AUTO, velocities);
  add_rigid(scene, rigid);
  ct_gravity_def gravity = {COOKIE, .acceleration = {0, 0, -g}};
  add_made(scene, ct_gravity_create_effect, &gravity);
  return scene;
}

/* A physical pendulum is below its pivot after a quarter of its period, K(sin θ/2) / ω. */
static void pendulum(void)
{
  // It hangs 2 from the pivot, 2 rad from below, and turns about y.
  const double pivot[3] = {0.3, 0.7, -0.2}, angle = 2.0, g = 10.0, d = 2.0;
  const double c = cos(angle), s = sin(angle), mass = 2.0 * 0.5 * 0.4 * 1.0;
  // Lumped moments of 2 and 3 bricks along z and x.
  const double inertia = mass * (1.0 * (1 + 2 / 4.0) + 0.25 * (1 + 2 / 9.0)) / 12 + mass * d * d;
  const double quarter = elliptic(sin(0.5 * angle)) / sqrt(mass * g * d / inertia);
  ct_mesh *mesh = box_mesh(CT_HEX8, -0.25, -0.2, -d - 0.5, 0.5, 0.4, 1.0, 3, 2, 2);
  double error[2], energy = 0.0;
  for (int32_t n = 0; n < mesh->node_count; n++) {
    double *X = &mesh->nodes[3 * n], x = X[0], z = X[2];
    X[0] = pivot[0] + c * x - s * z, X[1] += pivot[1], X[2] = pivot[2] + s * x + c * z;
  }
  for (int i = 0; i < 2; i++) {
    ct_rigid rigid = {.fixed = {0, 0, 0, 1, 0, 1}, .pivoted = 1};
    memcpy(rigid.pivot, pivot, sizeof pivot);
    ct_scene *scene = hanging(mesh, NULL, &rigid, g);
    const ct_problem *p =
        build(scene, (ct_scene_time){.end = quarter, .dt = quarter / (200 << i)}, NULL, NULL);
    ct_state *state = new_state(p);
    advance(p, state, 200 << i);
    ct_energy last = energy_of(p, state);
    double x = 0.0, all = 0.0;
    for (int32_t n = 0; n < p->node_count; n++) {
      x += p->mass[n] * (p->reference[3 * n] + state->displacement[3 * n]), all += p->mass[n];
      energy = worst(energy, state->displacement[3 * n + 1]);
    }
    error[i] = x / all - pivot[0];
    if (i == 1) energy = worst(energy, last.kinetic / (mass * g * d * (1.0 - c)) - 1.0);
  }
  tap_close(error[1], 0.0, 1e-4, "a pendulum is below its pivot after a quarter of its period");
  tap_close(log2(error[0] / error[1]), 2.0, 0.1, "order 2, errors %.3g and %.3g", error[0],
            error[1]);
  tap_close(energy, 0.0, 1e-4, "its kinetic energy there, and no motion along its axis");
}

/* A symmetric top that precesses steadily about the vertical through its pivot:
 * I₁ Ω² cos θ - I₃ ω₃ Ω + M g d = 0. */
static void top(void)
{
  const double pivot[3] = {0.3, 0.7, -0.2}, angle = 1.0, g = 10.0, d = 1.0, rate = 0.8;
  const double c = cos(angle), s = sin(angle), mass = 2.0 * 1.0 * 1.0 * 0.5, end = 5.0;
  const double across = mass * 1.0 * (1 + 2 / 4.0) / 12, along = mass * 0.25 * (1 + 2 / 4.0) / 12;
  const double I3 = 2.0 * across, I1 = across + along + mass * d * d;
  const double spin = (I1 * rate * rate * c + mass * g * d) / (I3 * rate); // ω₃
  // ω = Ω z + (ω₃ - Ω cos θ) e, where e leans from z towards x.
  const double rest = spin - rate * c, w[3] = {rest * s, 0.0, rate + rest * c};
  const double none[3] = {0.0, 0.0, 0.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, -0.5, -0.5, d - 0.25, 1, 1, 0.5, 2, 2, 2);
  double error[2];
  for (int32_t n = 0; n < mesh->node_count; n++) {
    double *X = &mesh->nodes[3 * n], x = X[0], z = X[2];
    X[0] = pivot[0] + c * x + s * z, X[1] += pivot[1], X[2] = pivot[2] + c * z - s * x;
  }
  double *velocities = turning(mesh, none, w, pivot);
  for (int i = 0; i < 2; i++) {
    ct_rigid rigid = {.pivoted = 1};
    memcpy(rigid.pivot, pivot, sizeof pivot);
    ct_scene *scene = hanging(mesh, velocities, &rigid, g);
    const ct_problem *p =
        build(scene, (ct_scene_time){.end = end, .dt = 0.002 / (1 << i)}, NULL, NULL);
    ct_state *state = new_state(p);
    advance(p, state, (int64_t)lround(end / p->dt));
    double x[3] = {0.0, 0.0, 0.0}, all = 0.0;
    for (int32_t n = 0; n < p->node_count; n++) {
      all += p->mass[n];
      for (int k = 0; k < 3; k++)
        x[k] += p->mass[n] * (p->reference[3 * n + k] + state->displacement[3 * n + k] - pivot[k]);
    }
    const double to[3] = {d * s * cos(rate * end), d * s * sin(rate * end), d * c};
    error[i] = 0.0;
    for (int k = 0; k < 3; k++) error[i] = worst(error[i], x[k] / all - to[k]);
  }
  tap_close(error[1], 0.0, 1e-3, "a top precesses steadily");
  tap_close(log2(error[0] / error[1]), 2.0, 0.1, "order 2, errors %.3g and %.3g", error[0],
            error[1]);
}

/* Weight and a load that grows with time: the leapfrog's own closed form, to round-off. With fixed
 * freedoms the body only falls, and turns about the free axis at a constant rate. */
static void falling(void)
{
  static const double time[2] = {0.0, 2.0}, value[2] = {0.0, 2.0};
  static const double v[3] = {3.0, 0.0, 5.0}, none[3] = {0, 0, 0}, w[3] = {0, 0, 0.5};
  static const double middle[3] = {0.5, 1.0, 1.5};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 2, 3, 2, 2, 3);
  for (int kind = 0; kind < 2; kind++) {
    int32_t faces[4 * 4];
    double *velocities = turning(mesh, kind == 0 ? v : none, kind == 0 ? none : w, middle);
    ct_scene *scene = new_scene();
    add_moving_body(scene, "box", mesh, &STEEL, CT_KERNEL_AUTO, velocities);
    add_rigid(scene, &(ct_rigid){.fixed = {kind, kind, 0, kind, kind, 0}});
    ct_gravity_def gravity = {COOKIE, .acceleration = {kind, 0, -10}};
    add_made(scene, ct_gravity_create_effect, &gravity);
    ct_load_def load = {COOKIE,         .kind = CT_Q4,           .face_count = 4,
                        .faces = faces, .traction = {0, 0, 4.0}, .amplitude = {2, time, value}};
    ct_mesh_plane_faces(mesh, 2, 3.0, faces, NULL);
    add_made(scene, ct_load_create_effect, &load);
    const ct_problem *p = build(scene, (ct_scene_time){.end = 2.0, .dt = 0.01}, NULL, NULL);
    ct_state *state = new_state(p);
    advance(p, state, 200);
    // 4 t on an area of 2 moves a mass of 12 by a Δt³ (n - 1) n (n + 1) / 6 with a = 8 / 12.
    const double t = state->time, ramp = 8.0 / 12.0 * 1e-6 * 199.0 * 200.0 * 201.0 / 6.0,
                 fall = (kind == 0 ? 5.0 * t : 0.0) - 5.0 * t * t + ramp;
    double off = 0.0, turned = 0.0;
    for (int32_t n = 0; n < p->node_count; n++) {
      const double *u = &state->displacement[3 * n];
      off = worst(off, u[2] - fall);
      if (kind == 0) off = worst(off, u[0] - 3.0 * t), off = worst(off, u[1]);
      // About a fixed axis 2 a b = sin φ is Δt ω: the angle of a step.
      const double angle = 200.0 * asin(0.01 * 0.5), C = cos(angle) - 1.0, S = sin(angle);
      double r[2];
      for (int c = 0; c < 2; c++) r[c] = p->reference[3 * n + c] - middle[c];
      turned = worst(turned, u[0] - (C * r[0] - S * r[1]));
      turned = worst(turned, u[1] - (S * r[0] + C * r[1]));
    }
    tap_close(off, 0.0, 1e-11, "weight and a growing load (%s)", kind == 0 ? "free" : "guided");
    if (kind == 1) tap_close(turned, 0.0, 1e-12, "a guided body turns at a constant rate");
  }
}

/* A distorted body that turns and falls, whose mesh is mirrored or shuffled: the bits stay. */
static void images(void)
{
  const double v[3] = {0.1, -0.2, 0.3}, w[3] = {0.5, -1.0, 0.7}, middle[3] = {0.5, 0.5, 1.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 2, 2, 2, 4), *image[4];
  int32_t *to = integers(mesh->node_count);
  shake_regular(mesh, 0.1, 0);
  image[0] = mesh;
  for (int axis = 1; axis < 3; axis++) image[axis] = mirror_mesh(mesh, axis);
  image[3] = shuffle_mesh(mesh, to);
  double *first = NULL;
  for (int i = 0; i < 4; i++) {
    double *velocities = turning(mesh, v, w, middle), *moved = numbers(3 * mesh->node_count);
    for (int32_t n = 0; n < mesh->node_count; n++)
      for (int c = 0; c < 3; c++) {
        const double own = velocities[3 * n + c];
        moved[3 * (i == 3 ? to[n] : n) + c] = i > 0 && i < 3 && c == i ? -own : own;
      }
    ct_scene *scene = new_scene();
    add_moving_body(scene, "box", image[i], &STEEL, CT_KERNEL_AUTO, moved);
    add_rigid(scene, &(ct_rigid){.body = 0});
    ct_gravity_def gravity = {COOKIE, .acceleration = {0, 0, -10}};
    if (i == 2) gravity.acceleration[2] = 10;
    add_made(scene, ct_gravity_create_effect, &gravity);
    const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .dt = 0.01}, NULL, NULL);
    ct_state *state = new_state(p);
    advance(p, state, 100);
    int64_t faults = 0;
    for (int32_t n = 0; i == 3 && n < p->node_count; n++)
      for (int c = 0; c < 3; c++) faults += first[3 * n + c] != state->displacement[3 * to[n] + c];
    if (i > 0 && i < 3) faults = mirror_faults(first, state->displacement, p->node_count, i);
    if (i > 0)
      tap_ok(faults == 0, "%s: the same bits", i == 3 ? "a shuffled mesh" : "a mirrored mesh");
    if (i == 0) {
      first = numbers(3 * p->node_count);
      memcpy(first, state->displacement, 3 * (size_t)p->node_count * sizeof *first);
    }
  }
}

/* A rigid body has no elements to compute, bounds no step, has no stress, and may stand beside a
 * prescribed motion of another body. */
static void beside_others(void)
{
  static const double time[2] = {0.0, 1.0}, value[2] = {0.0, 1.0};
  static const int32_t base[4] = {0, 1, 2, 3};
  const ct_material stiff = {.young = 1e9, .poisson = 0.3, .density = 1.0};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("soft", mesh, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "rigid", mesh, &stiff, CT_KERNEL_AUTO, 0, 0, 1);
  add_rigid(scene, &(ct_rigid){.body = 1});
  ct_motion motion = {.nodes = base,
                      .node_count = 4,
                      .fixed = {0, 0, 1},
                      .displacement = {0, 0, 0.1},
                      .amplitude = {2, time, value}};
  ct_motion_def def = {COOKIE, .motions = &motion, .motion_count = 1};
  add_made(scene, ct_motion_create_effect, &def);
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, &stable);
  double c1, c2, flops = 1.0;
  ct_material_speeds(&STEEL, &c1, &c2);
  tap_close(stable.dt_courant * c1, 1.0, 1e-14, "the Courant step is that of the soft body");
  tap_ok(stable.dt * c1 > 0.3, "the stiff material of a rigid body does not bound the step");
  ct_solid_kernel kernel;
  must(ct_solid_body_plan, p->effects[0], 1, &kernel, &flops, NULL);
  tap_ok(kernel == CT_KERNEL_RIGID && flops == 0.0, "it has no kernel");
  tap_ok(!ct_problem_is_rigid(p, 0) && ct_problem_is_rigid(p, 1), "one of two bodies is rigid");
  ct_state *state = new_state(p);
  advance(p, state, 10);
  // The soft one may sleep for some steps.
  const int64_t *updates = state->element_updates;
  tap_ok(updates[0] > 0 && updates[0] <= updates[1] && (updates[0] + updates[1]) % 2 == 0,
         "of two elements at most one is computed (%d, not %d)", (int)updates[0], (int)updates[1]);
  tap_close(state->displacement[3 * 8 + 2], state->time, 1e-14, "it flies on");
}

/* The definition of a body, what the message must contain, and the status. */
typedef struct refusal {
  ct_rigid rigid;
  ct_status status;
  const char *text;
} refusal;

static void refusals(void)
{
  static const int32_t part[] = {2, 5, 8};
  static const refusal cases[] = {
      {{.body = 2}, CT_ERROR_ARGUMENT, "no body 2"},
      {{.body = 1}, CT_ERROR_ARGUMENT, "the initial velocity of node"},
      {{.body = 0, .fixed = {0, 0, 1}}, CT_ERROR_ARGUMENT, "fixed freedoms are at rest"},
      {{.body = 0, .pivoted = 1}, CT_ERROR_ARGUMENT, "fixed freedoms are at rest"},
      {{.body = 0, .pivoted = 1, .pivot = {0, NAN, 0}}, CT_INVALID, "pivot y is not finite"},
      {{.body = 0, .nodes = part, .node_count = 3}, CT_ERROR_ARGUMENT, "0 to 7; node 2 is 8"},
      {{.body = 1, .nodes = part, .node_count = 1}, CT_ERROR_ARGUMENT, "8 to 15; node 0 is 2"},
      {{.body = 0, .nodes = part, .node_count = 2}, CT_ERROR_ARGUMENT, "no three nodes"}};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("one", mesh, &STEEL, CT_KERNEL_AUTO, 0, 0, 1);
  ct_effect *effect = NULL;
  const ct_problem *joined, *problem;
  ct_error e = {0};
  int64_t steps;
  double *velocities = numbers(3 * mesh->node_count);
  velocities[4] = 1.0;
  add_moving_body(scene, "two", mesh, &STEEL, CT_KERNEL_AUTO, velocities);
  must(ct_scene_join, scene, &joined);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    ct_rigid_def def = {COOKIE, .bodies = &cases[i].rigid, .body_count = 1};
    ct_status status = ct_rigid_create_effect(&def, joined, &effect, &e);
    tap_ok(status == cases[i].status && strstr(e.text, cases[i].text), "%s", e.text);
  }
  const ct_rigid twice[2] = {{.body = 0}, {.body = 0}};
  ct_rigid_def def = {COOKIE, .bodies = twice, .body_count = 2};
  tap_ok(ct_rigid_create_effect(&def, joined, &effect, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "rigid already"),
         "%s", e.text);
  def.body_count = 0;
  tap_ok(ct_rigid_create_effect(&def, joined, &effect, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  def.body_count = 1;
  add_support(scene, 0, mesh, 2, 0.0, "z", 1.0);
  add_made(scene, ct_rigid_create_effect, &def);
  ct_scene_time at = {.end = 1.0, .dt = 0.001};
  tap_ok(ct_scene_build(scene, &at, &problem, &steps, NULL, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "a support holds z of node 0 of the rigid body one"),
         "%s", e.text);
}

/* A body that turns by more than half a turn in a step (eq:rigid-rotation). */
static void too_fast(void)
{
  tumbler t = new_tumbler(100.0, 4.0, LEAPFROG);
  ct_state *state = NULL;
  ct_error e = {0};
  ct_status status = ct_state_create(t.problem, &state, &e);
  tap_ok(status == CT_ERROR_STEP && strstr(e.text, "give a step of at most 0.5"), "%s", e.text);
}

/* Two rigid bodies that hit each other: a bar at rest, hit near its end by a small hammer that
 * cannot turn. Frictionless, and with restitution 1: the impulse is 2 v / (1/m + 1/M + d²/I). */
enum { PLAIN, SWAPPED, MIRRORED, SHUFFLED, THREADS, HITS };
static const char *const HIT[] = {"", "swapped surfaces", "a mirrored scene", "shuffled meshes",
                                  "two threads"};

typedef struct hit {
  ct_mesh *mesh[2];
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
} hit;

static hit new_hit(int kind, int32_t *to[2])
{
  const double v = kind == MIRRORED ? 1.0 : -1.0;
  hit h = {.mesh = {box_mesh(CT_HEX8, -1, 0, 0, 2, 0.2, 0.2, 9, 3, 3),
                    box_mesh(CT_HEX8, 0.78, 0.08, 0.21, 0.04, 0.04, 0.4, 2, 2, 2)}};
  double top[2] = {0.2, 0.21};
  for (int i = 0; i < 2; i++) {
    ct_mesh *image = kind == MIRRORED   ? mirror_mesh(h.mesh[i], 2)
                     : kind == SHUFFLED ? shuffle_mesh(h.mesh[i], to[i])
                                        : NULL;
    if (image != NULL) h.mesh[i] = image;
    if (kind == MIRRORED) top[i] = -top[i];
  }
  h.scene = new_scene();
  set_threads(h.scene, kind == THREADS ? 2 : 1);
  add_body(h.scene, "bar", h.mesh[0], &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(h.scene, "hammer", h.mesh[1], &STEEL, CT_KERNEL_AUTO, 0, 0, v);
  const ct_rigid both[2] = {{.body = 0}, {.body = 1, .fixed = {1, 1, 0, 1, 1, 1}}};
  ct_rigid_def def = {COOKIE, .bodies = both, .body_count = 2};
  add_made(h.scene, ct_rigid_create_effect, &def);
  const int a = kind == SWAPPED, b = !a;
  add_contact_with(h.scene, a, h.mesh[a], top[a], b, h.mesh[b], top[b], 2, 0.0,
                   ct_contact_options_default(), 0.0, 0.0);
  h.problem = build(h.scene, (ct_scene_time){.end = 0.1, .dt = 0.0005}, NULL, NULL);
  h.state = new_state(h.problem);
  return h;
}

/* The velocity of the hammer and the bar after it, and what is conserved
 * (eq:rigid-mobility, eq:rigid-mobility-bound, eq:rigid-turned). */
static void hammer(void)
{
  hit h = new_hit(PLAIN, NULL);
  ct_momentum start[2], end[2];
  ct_energy first = energy_of(h.problem, h.state);
  for (int i = 0; i < 2; i++) start[i] = momentum_of(h.problem, h.state, i);
  advance(h.problem, h.state, 200);
  ct_energy last = energy_of(h.problem, h.state);
  double p = 0.0, L = 0.0;
  for (int i = 0; i < 2; i++) end[i] = momentum_of(h.problem, h.state, i);
  // Supports hold the hammer along x and y and against turning.
  p = start[0].p[2] + start[1].p[2] - end[0].p[2] - end[1].p[2];
  const double m = 0.04 * 0.04 * 0.4 * 2.0, M = 2.0 * 0.2 * 0.2 * 2.0, d = 0.8;
  const double I = M * (4.0 * (1 + 2 / 81.0) + 0.04 * (1 + 2 / 9.0)) / 12.0;
  const double impulse = 2.0 / (1 / m + 1 / M + d * d / I);
  L = end[0].L[1] / (impulse * d) - 1.0;
  tap_close(p / start[1].p[2], 0.0, 1e-13, "momentum along the blow");
  tap_close(end[0].p[2] / impulse, -1.0, 1e-5, "the impulse of a hammer on a bar");
  tap_close(L, 0.0, 1e-3, "its moment");
  tap_close(last.kinetic / first.kinetic, 1.0, 1e-9, "kinetic energy before and after");
  // The bar turns by 1e-3 in a step.
  tap_close(last.total / first.total, 1.0, 1e-13, "total energy before and after");
}

/* The bits of an impact do not depend on the order of surfaces, numbers and threads. */
static void hit_images(void)
{
  hit h = new_hit(PLAIN, NULL), other;
  int32_t *to[2] = {integers(h.mesh[0]->node_count), integers(h.mesh[1]->node_count)};
  const int32_t half = h.mesh[0]->node_count, nodes = h.problem->node_count;
  advance(h.problem, h.state, 120);
  for (int kind = SWAPPED; kind < HITS; kind++) {
    other = new_hit(kind, to);
    advance(other.problem, other.state, 120);
    const double *u = h.state->displacement, *w = other.state->displacement;
    int64_t faults = kind == MIRRORED ? mirror_faults(u, w, nodes, 2) : 0;
    for (int32_t n = 0; kind != MIRRORED && n < nodes; n++) {
      const int32_t at = kind != SHUFFLED ? n : n < half ? to[0][n] : half + to[1][n - half];
      for (int c = 0; c < 3; c++) faults += u[3 * n + c] != w[3 * at + c];
    }
    tap_ok(faults == 0, "%s: the same bits (%d differ)", HIT[kind], (int)faults);
  }
  other = new_hit(PLAIN, NULL);
  advance(other.problem, other.state, 50);
  hit again = new_hit(PLAIN, NULL);
  must(ct_state_copy, other.problem, other.state, again.state);
  advance(again.problem, again.state, 70);
  tap_ok(same_state(h.state, again.state), "a copy of the state within the impact goes on alike");
}

/* An elastic block of any rotation, hit by a turning obstacle with mass and friction. */
static hit new_carried(ct_obstacle_shape shape, double mu, int kind)
{
  static const int32_t carrier = 1;
  const ct_material soft = {.law = CT_NEO_HOOKEAN, .young = 900.0, .poisson = 0.3, .density = 1.0};
  const double flip = kind == MIRRORED ? -1.0 : 1.0, edge = 2.0 / sqrt(5.0),
               at[3] = {0.13, 0.21, 1.001 * flip}, w[3] = {0.1 * flip, 0.3 * flip, 0.1};
  hit h = {.mesh = {box_mesh(CT_HEX8, -1, -1, -1, 2, 2, 1, 6, 6, 3),
                    box_mesh(CT_HEX8, at[0] - 0.5 * edge, at[1] - 0.5 * edge, 1.001 - 0.5 * edge,
                             edge, edge, edge, 1, 1, 1)}};
  for (int i = 0; i < 2 && kind == MIRRORED; i++) {
    ct_mesh *image = mirror_mesh(h.mesh[i], 2);
    h.mesh[i] = image;
  }
  h.scene = new_scene();
  set_threads(h.scene, kind == THREADS ? 2 : 1);
  add_body(h.scene, "block", h.mesh[0], &soft, CT_KERNEL_AUTO, 0, 0, 0);
  double *v = turning(h.mesh[1], (double[3]){0.03, 0.01, -0.05 * flip}, w, at);
  const ct_material heavy = {.young = 900.0, .density = 20.0 / (edge * edge * edge)};
  add_moving_body(h.scene, "ball", h.mesh[1], &heavy, CT_KERNEL_AUTO, v);
  add_rigid(h.scene, &(ct_rigid){.body = carrier});
  const int flat = shape == CT_OBSTACLE_PLANE;
  int32_t *faces = integers(4 * 36);
  ct_obstacle_def o = {COOKIE,
                       .shape = shape,
                       .axis = {0.1, !flat, flat ? -flip : 0.0},
                       .point = {at[0], at[1], flat ? 1e-3 * flip : at[2]},
                       .radius = 1.0,
                       .epsilon = 2e5,
                       .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                       .restitution = 1.0,
                       .initial_penetration = CT_INITIAL_KEEP,
                       .travel_time = 0.01,
                       .kind = CT_Q4,
                       .faces = faces,
                       .carrier = &carrier};
  o.face_count = ct_mesh_plane_faces(h.mesh[0], 2, 0.0, faces, NULL);
  ct_effect *effect = NULL, *friction = NULL;
  const ct_problem *joined;
  must(ct_scene_join, h.scene, &joined);
  must(ct_obstacle_create_effect, &o, joined, &effect);
  must(ct_scene_add_effect, h.scene, effect);
  ct_friction_def f = {COOKIE, .tangent = 1.0, .on = effect, .coefficient = mu};
  if (mu > 0.0) must(ct_friction_create_effect, &f, joined, &friction);
  if (mu > 0.0) must(ct_scene_add_effect, h.scene, friction);
  ct_scene_time time = {.end = 1.0, .dt = 0.002, .force_tolerance = 1e-12};
  h.problem = build(h.scene, time, NULL, NULL);
  h.state = new_state(h.problem);
  return h;
}

/* Momentum, angular momentum and energy of both bodies (eq:carrier-weights, eq:carrier-row,
 * eq:carrier-force, eq:carrier-motion). */
static void obstacles_with_mass(void)
{
  static const char *const NAME[] = {"plane", "sphere", "cylinder"};
  for (int i = 0; i < 6; i++) {
    const double mu = i < 3 ? 0.0 : 0.3;
    hit h = new_carried((ct_obstacle_shape)(i % 3), mu, PLAIN);
    double p = 0.0, L = 0.0, given = 0.0, rise = 0.0;
    ct_momentum start[2], now[2];
    for (int k = 0; k < 2; k++) start[k] = momentum_of(h.problem, h.state, k);
    const ct_energy first = energy_of(h.problem, h.state);
    for (int step = 0; step < 50; step++) {
      advance(h.problem, h.state, 10);
      for (int k = 0; k < 2; k++) now[k] = momentum_of(h.problem, h.state, k);
      for (int c = 0; c < 3; c++) {
        p = worst(p, now[0].p[c] + now[1].p[c] - start[0].p[c] - start[1].p[c]);
        L = worst(L, now[0].L[c] + now[1].L[c] - start[0].L[c] - start[1].L[c]);
        given = worst(given, now[1].L[c] - start[1].L[c]);
      }
      rise = fmax(rise, energy_of(h.problem, h.state).total / first.total - 1.0);
    }
    tap_ok(p < 1e-13 && L < 1e-13 && given > 1e-3,
           "%s with mass, mu = %g: momentum %.3g, angular momentum %.3g of %.3g", NAME[i % 3], mu,
           p, L, given);
    // The leapfrog of a block at large strain is not exact.
    tap_ok(rise < 1e-6, "and no energy appears (%.3g)", rise);
  }
}

/* What can't carry an obstacle, or be carried, is refused by name. */
static void carriers_refused(void)
{
  hit h = new_carried(CT_OBSTACLE_SPHERE, 0.0, PLAIN);
  int32_t *faces = integers(4 * 36);
  static const int32_t BODY[] = {1, -1, 2, 0};
  ct_obstacle_def good = ct_obstacle_def_sphere((double[3]){0.13, 0.21, 1.001}, 1.0);
  good.epsilon = 2e5, good.travel_time = 0.01, good.kind = CT_Q4, good.faces = faces;
  good.face_count = ct_mesh_plane_faces(h.mesh[0], 2, 0.0, faces, NULL), good.carrier = BODY;
  ct_obstacle_def moving = good, explicit = good, other[3] = {good, good, good};
  moving.velocity[1] = 0.1, explicit.enforcement = CT_ENFORCE_PENALTY;
  for (int k = 0; k < 3; k++) other[k].carrier = &BODY[k + 1];
  const struct {
    const ct_obstacle_def *def;
    const char *why;
  } wrong[] = {{&moving, "leave velocity and travel out"},
               {&explicit, "explicit penalty"},
               {&other[0], "no body -1"},
               {&other[1], "no body 2"},
               {&other[2], "body block carries it and can't touch it"}};
  ct_error e;
  ct_effect *effect = NULL;
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    const ct_status status = ct_obstacle_create_effect(wrong[i].def, h.problem, &effect, &e);
    tap_ok(status == CT_ERROR_ARGUMENT && effect == NULL && strstr(e.text, wrong[i].why) != NULL,
           "%s", e.text);
  }
  must(ct_obstacle_create_effect, &good, h.problem, &effect);
  ct_effect_free(effect);
}

/* The same bits in a mirrored scene, with two threads and after a copy of the state. */
static void carried_images(void)
{
  for (int i = 0; i < 3; i++) {
    hit h = new_carried((ct_obstacle_shape)i, 0.3, PLAIN);
    const int32_t nodes = h.problem->node_count;
    advance(h.problem, h.state, 200);
    for (int kind = MIRRORED; kind < HITS; kind++) {
      if (kind == SHUFFLED) continue;
      hit other = new_carried((ct_obstacle_shape)i, 0.3, kind);
      advance(other.problem, other.state, 200);
      const double *u = h.state->displacement, *w = other.state->displacement;
      tap_ok(kind == MIRRORED ? mirror_faults(u, w, nodes, 2) == 0
                              : same_state(h.state, other.state),
             "an obstacle with mass in %s: the same bits", HIT[kind]);
    }
    hit half = new_carried((ct_obstacle_shape)i, 0.3, PLAIN),
        rest = new_carried((ct_obstacle_shape)i, 0.3, PLAIN);
    advance(half.problem, half.state, 90);
    must(ct_state_copy, half.problem, half.state, rest.state);
    advance(rest.problem, rest.state, 110);
    tap_ok(same_state(h.state, rest.state), "a copy of the state goes on alike");
  }
}

/* Motions of the nodes of two bodies by random forces, by hand, and their bounds
 * (eq:rigid-mobility, eq:rigid-mobility-bound). */
static void mobilities(void)
{
  enum { NODES = 9, WIDE = CT_SOLVER_WIDE };
  static const int32_t of[NODES] = {0, -1, 1, 1, 0, 0, -1, 1, 0};
  double off = 0.0, over = 0.0, sums[WIDE * NODES], moved[WIDE * NODES], sizes[WIDE * NODES];
  int32_t place[NODES];
  ct_solver s = {.node_count = NODES};
  ct_bodies *b = ct_bodies_create(&s, 2, of);
  for (int i = 0; i < 100; i++) {
    for (int k = 0; k < 2; k++) {
      double R[3][3];
      random_rotation(R);
      for (int c = 0; c < 3; c++) b->translation[k][c] = 1.0 + uniform(1.0);
      for (int c = 0; c < 6; c++) b->rotation[k][c] = 0.0;
      for (int a = 0; a < 3; a++) {
        const double m = 1.5 + uniform(1.0);
        for (int c = 0; c < 3; c++) b->rotation[k][c] += m * R[a][c] * R[a][c];
        for (int c = 0; c < 3; c++) b->rotation[k][3 + c] += m * R[a][c] * R[a][(c + 1) % 3];
      }
    }
    ct_bodies_bound(b);
    for (int n = 0; n < NODES; n++) {
      place[n] = WIDE * n;
      for (int c = 0; c < 3; c++) sums[WIDE * n + c] = uniform(1.0), b->arm[3 * n + c] = uniform(1);
      sums[WIDE * n + 3] = sqrt(ct_vector_dot(&sums[WIDE * n], &sums[WIDE * n]));
    }
    ct_bodies_push(b, NODES, place, NULL, sums);
    ct_bodies_move(b, NODES, place, NULL, moved);
    ct_bodies_push_sizes(b, NODES, place, sums);
    ct_bodies_move_sizes(b, NODES, place, sizes);
    for (int n = 0; n < NODES; n++) {
      const int k = of[n];
      double f[3] = {0}, m[3] = {0}, turn[3], u[3], moment[3];
      for (int j = 0; k >= 0 && j < NODES; j++) {
        if (of[j] != k) continue;
        ct_vector_cross(&b->arm[3 * j], &sums[WIDE * j], moment);
        for (int c = 0; c < 3; c++) f[c] += sums[WIDE * j + c], m[c] += moment[c];
      }
      if (k < 0) continue;
      const double *q = b->rotation[k];
      const double full[3][3] = {{q[0], q[3], q[5]}, {q[3], q[1], q[4]}, {q[5], q[4], q[2]}};
      for (int c = 0; c < 3; c++) turn[c] = ct_vector_dot(full[c], m);
      ct_vector_cross(turn, &b->arm[3 * n], u);
      for (int c = 0; c < 3; c++) {
        u[c] += b->translation[k][c] * f[c];
        off = worst(off, u[c] - moved[WIDE * n + c]);
      }
      over = fmax(over, sqrt(ct_vector_dot(u, u)) / sizes[WIDE * n + 3]);
      double bound = 0.0, eta[NODES] = {0.0};
      for (int j = 0; j < NODES; j++) {
        for (int e = 0; e < 3; e++) {
          const double unit[3] = {e == 0, e == 1, e == 2};
          ct_vector_cross(&b->arm[3 * j], unit, moment);
          for (int c = 0; c < 3; c++) eta[j] += moment[c] * ct_vector_dot(full[c], moment);
        }
        if (of[j] == k) bound += sqrt(eta[j]) * sums[WIDE * j + 3];
      }
      bound *= sqrt(eta[n]);
      for (int j = 0; j < NODES; j++)
        if (of[j] == k) bound += b->most[k] * sums[WIDE * j + 3];
      off = worst(off, bound - sizes[WIDE * n + 3]);
    }
  }
  tap_close(off, 0.0, 1e-13, "forces move the nodes of rigid bodies, and their bound");
  tap_ok(over <= 1.0 && over > 0.2, "and no farther than %.3g of their bound", over);
  ct_pool_empty(&s.pool);
}

/* A rigid block that stands on an elastic one at t = 0: its first forces are those of a rigid body,
 * so that it has no momentum, and the penalty is that of the soft block (eq:rigid-start,
 * eq:rigid-penalty). */
static void standing(void)
{
  const ct_material stiff = {.young = 1e6, .poisson = 0.3, .density = 2.0};
  ct_mesh *low = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2),
          *high = box_mesh(CT_HEX8, 0.2, 0.2, 1, 0.6, 0.6, 1, 5, 5, 5);
  ct_scene *scene = new_scene_with("soft", low, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "rigid", high, &stiff, CT_KERNEL_AUTO, 0, 0, 0);
  add_rigid(scene, &(ct_rigid){.body = 1});
  static const int32_t second = 1;
  ct_gravity_def gravity = {COOKIE, .acceleration = {0, 0, -10}, .bodies = &second,
                            .body_count = 1};
  add_made(scene, ct_gravity_create_effect, &gravity);
  add_contact_with(scene, 0, low, 1.0, 1, high, 1.0, 2, 0.0, ct_contact_options_default(), 0.0,
                   0.0);
  const ct_problem *p = build_until(scene, 0.1, 0.5);
  ct_state *state = new_state(p);
  double epsilon, c1, c2;
  ct_material_speeds(&STEEL, &c1, &c2);
  must(ct_scene_contact_epsilon, scene, 0, &epsilon);
  const double usual =
      ct_contact_penalty_default(ct_contact_options_default().enforcement, 2.0 * c1 * c1, 0.5);
  tap_close(epsilon / usual, 1.0, 1e-14, "the penalty is that of the body that deforms");
  const ct_momentum start = momentum_of(p, state, 1);
  tap_close(start.p[2] / (0.72 * 10.0 * p->dt), 0.0, 1e-12,
            "a standing body has no momentum at t = 0");
}

int main(void)
{
  free_at_end();
  mobilities();
  standing();
  hammer();
  hit_images();
  obstacles_with_mass();
  carried_images();
  carriers_refused();
  rotations();
  images();
  beside_others();
  refusals();
  too_fast();
  pendulum();
  top();
  falling();
  tumbling();
  tumbling_otherwise();
  many_steps();
  return tap_done();
}
