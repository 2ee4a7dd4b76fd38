/* A host with its own mesh, arrays and time loop, that takes only the contact from the library: in
 * one call per step with its prediction, so that no step adds energy; or as an explicit penalty.
 *
 * Two equal bars, each a chain of square layers with springs along x between them, meet at v = ±0.1
 * (L = 10, E = ρ = A = 1). Closed form: they stay in contact for 2 L / c = 20 with the pressure ρ c
 * v = 0.1 and part with exchanged velocities. */
#include "tap.h"

#include <libcontact/contact.h>

#include <stdlib.h>
#include <string.h>

enum { LAYERS = 101, NODES = 4 * LAYERS };

typedef struct bar {
  double x[NODES][3], v[NODES][3], f[NODES][3], X[NODES][3], mass[NODES], inverse_mass[NODES][3];
  double h, stiffness;
} bar;

/* Layers at x = start + i h; node 4 i + k stands at corner k of the unit square in y, z. */
static void bar_make(bar *b, double start, double velocity)
{
  static const double corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  memset(b, 0, sizeof *b);
  b->h = 10.0 / (LAYERS - 1);
  b->stiffness = 0.25 / b->h;
  for (int i = 0; i < LAYERS; i++)
    for (int k = 0; k < 4; k++) {
      int n = 4 * i + k;
      b->X[n][0] = start + i * b->h;
      b->X[n][1] = corner[k][0];
      b->X[n][2] = corner[k][1];
      b->v[n][0] = velocity;
      b->mass[n] = 0.25 * b->h * (i == 0 || i == LAYERS - 1 ? 0.5 : 1.0);
      for (int c = 0; c < 3; c++) b->inverse_mass[n][c] = 1.0 / b->mass[n];
    }
  memcpy(b->x, b->X, sizeof b->x);
}

static void bar_forces(bar *b)
{
  memset(b->f, 0, sizeof b->f);
  for (int n = 0; n + 4 < NODES; n++) {
    double force = b->stiffness * ((b->x[n + 4][0] - b->x[n][0]) - b->h);
    b->f[n][0] += force;
    b->f[n + 4][0] -= force;
  }
}

static void bar_step(bar *b, double dt)
{
  for (int n = 0; n < NODES; n++)
    for (int c = 0; c < 3; c++) {
      b->v[n][c] += dt * b->f[n][c] / b->mass[n];
      b->x[n][c] += dt * b->v[n][c];
    }
}

static double momentum(const bar *b)
{
  double p = 0.0;
  for (int n = 0; n < NODES; n++) p += b->mass[n] * b->v[n][0];
  return p;
}

/* Energy in the form that the leapfrog keeps, up to the contact: the springs at x_n, v at n + 1/2.
 */
static double energy(const bar *b)
{
  double e = 0.0;
  for (int n = 0; n < NODES; n++) e += 0.5 * b->mass[n] * b->v[n][0] * b->v[n][0];
  for (int n = 0; n + 4 < NODES; n++) {
    double stretch = b->x[n + 4][0] - b->x[n][0] - b->h;
    e += 0.5 * b->stiffness * stretch * stretch;
  }
  return e;
}

/* A step in which the forces change the velocity for the time `kick`; answers the energy of the bar
 * at its beginning: springs, and the product of both velocities, or in the first step v_0 alone. */
static double bar_advance(bar *b, double dt, double kick, int first)
{
  double e = 0.0;
  for (int n = 0; n + 4 < NODES; n++) {
    double stretch = b->x[n + 4][0] - b->x[n][0] - b->h;
    e += 0.5 * b->stiffness * stretch * stretch;
  }
  for (int n = 0; n < NODES; n++)
    for (int c = 0; c < 3; c++) {
      double before = b->v[n][c];
      b->v[n][c] += kick * b->f[n][c] / b->mass[n];
      e += 0.5 * b->mass[n] * before * (first ? before : b->v[n][c]);
      b->x[n][c] += dt * b->v[n][c];
    }
  return e;
}

/* The loop with the contact of a scene, at 0.9 of the step of the bars alone. */
static void controlled(const ct_surface *a, const ct_surface *b, double beta)
{
  static bar left, right;
  ct_contact_options options = ct_contact_options_default();
  ct_contact_prediction p;
  ct_contact_balance balance;
  ct_contact *contact = NULL;
  ct_error error;
  double dt, start = 0.0, lowest = 0.0, rise = 0.0, work = 0.0, force = 0.0, end = 0.0, bodies;
  int samples = 0;
  bar_make(&left, -10.0, 0.1);
  bar_make(&right, 0.0, -0.1);
  options.epsilon = ct_contact_penalty(beta, 1.0, left.h);
  options.travel_time = left.h; /* h / c */
  if (!tap_ok(ct_contact_create(a, b, &options, &contact, &error) == CT_OK, "beta %g", beta))
    return;
  dt = 0.9 * left.h;
  memset(&p, 0, sizeof p);
  p.x_a = &left.x[0][0], p.x_b = &right.x[0][0];
  p.velocity_a = &left.v[0][0], p.velocity_b = &right.v[0][0];
  p.force_a = &left.f[0][0], p.force_b = &right.f[0][0];
  p.inverse_mass_a = &left.inverse_mass[0][0], p.inverse_mass_b = &right.inverse_mass[0][0];
  p.dt = dt;
  for (int n = 0; n * dt < 30.0; n++) {
    double fa[3], fb[3], ma[3], mb[3];
    bar_forces(&left);
    bar_forces(&right);
    /* The first step begins with v_0 and not half a step before. */
    p.force_time = n == 0 ? 0.5 * dt : dt;
    if (ct_contact_step(contact, &p, &error) != CT_OK ||
        ct_contact_add_force(contact, &left.f[0][0], &right.f[0][0], NULL) != CT_OK ||
        ct_contact_balance_of(contact, &balance, NULL) != CT_OK ||
        ct_contact_resultant(contact, fa, ma, fb, mb, NULL) != CT_OK) {
      tap_ok(0, "step %d: %s", n, error.text);
      break;
    }
    bodies = bar_advance(&left, dt, p.force_time, n == 0) +
             bar_advance(&right, dt, p.force_time, n == 0);
    if (n == 0) start = lowest = bodies + balance.energy;
    rise = fmax(rise, bodies + balance.energy - lowest);
    lowest = fmin(lowest, bodies + balance.energy);
    work = fmax(work, fabs(bodies - start - balance.work));
    if (n * dt > 5.0 && n * dt < 15.0) force += fb[0], samples++;
    if (fb[0] > 0.01 * 0.1)
      end = n * dt; /* below it, points give back the rest of what they held */
  }
  tap_close(rise / start, 0.0, 1e-12, "at 0.9 of the step of the bars alone no energy is added");
  tap_close(work / start, 0.0, 1e-11, "what the bars gain is the work of the contact");
  tap_ok(lowest > 0.999 * start && balance.unconverged == 0, "%.4f of the energy stays",
         lowest / start);
  tap_close(force / samples, 0.1, 0.001, "pressure rho c v");
  tap_close(end, 20.0, 0.3, "the bars part after 2 L / c");
  tap_close(momentum(&right), 1.0, 0.01, "the right bar leaves with the velocity of the left one");
  ct_contact_free(contact);
}

/* A plate of mass 2 slides on a plane: it stops after v² / (2 μ g), and what friction has
 * dissipated is ½ m v²; another contact goes on from the memory of the first. */
static void slide(void)
{
  static const int32_t face[4] = {0, 3, 2, 1};
  static const double start[12] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};
  static const double point[3] = {0, 0, 0}, normal[3] = {0, 0, 1};
  double x[12], v[12], f[12], free_mass[12], force[3], motion, memory[400];
  const double dt = 1e-3;
  ct_surface plate;
  ct_contact_options options = ct_contact_options_default();
  ct_obstacle_def plane = ct_obstacle_def_plane(point, normal);
  ct_contact_prediction p;
  ct_contact_balance balance;
  ct_contact *contact[2] = {NULL, NULL};
  ct_error error;
  int bad = 0, now = 0;
  memset(&plate, 0, sizeof plate);
  plate.kind = CT_Q4, plate.node_count = 4, plate.face_count = 1;
  plate.faces = face, plate.reference = start;
  options.epsilon = 1.0, options.restitution = plane.restitution = 0.0;
  plane.epsilon = 2e5;
  for (int k = 0; k < 2; k++)
    bad += ct_contact_create(&plate, NULL, &options, &contact[k], &error) != CT_OK ||
           ct_contact_add_obstacle(contact[k], 0, &plane, &error) != CT_OK ||
           ct_contact_add_friction(contact[k], 0, 0.4, 1.0, &error) != CT_OK;
  for (int d = 0; d < 12; d++) {
    x[d] = start[d] - (d % 3 == 2 ? 10.0 / (2.0 * plane.epsilon) : 0.0);
    v[d] = d % 3 == 0 ? 0.5 : 0.0;
    free_mass[d] = 2.0;
  }
  memset(&p, 0, sizeof p);
  p.x_a = x, p.velocity_a = v, p.force_a = f, p.inverse_mass_a = free_mass, p.dt = dt;
  for (int n = 0; n < 1500 && bad == 0; n++) {
    for (int d = 0; d < 12; d++) f[d] = d % 3 == 2 ? -2.5 : 0.0;
    p.force_time = n == 0 ? 0.5 * dt : dt;
    bad += ct_contact_step(contact[now], &p, &error) != CT_OK ||
           ct_contact_add_force(contact[now], f, NULL, NULL) != CT_OK;
    for (int d = 0; d < 12; d++) v[d] += p.force_time * free_mass[d] * f[d], x[d] += dt * v[d];
    if (n != 100) continue;
    int64_t count = ct_contact_save(contact[0], NULL);
    now = 1;
    bad += count > 400 || ct_contact_save(contact[0], memory) != count ||
           ct_contact_restore(contact[1], memory, count, &error) != CT_OK;
  }
  bad += ct_contact_balance_of(contact[now], &balance, NULL) != CT_OK ||
         ct_contact_reaction(contact[now], 0, force, &motion, NULL) != CT_OK;
  if (!tap_ok(bad == 0, "a plate slides on a plane, with another contact from step 101 on")) return;
  tap_close(x[0], 0.0625, 5e-3 * 0.0625, "and stops after v^2 / (2 mu g)");
  tap_close(balance.friction, 0.25, 1e-3, "what friction has dissipated");
  tap_close(force[2], -10.0, 1e-8, "the plane bears the weight");
  ct_contact_free(contact[0]);
  ct_contact_free(contact[1]);
}

/* What the time loop watched. */
typedef struct watch {
  double first_contact, last_contact, pressure, imbalance, drift;
  int samples;
} watch;

static int loop(bar *left, bar *right, ct_contact *contact, double dt, double end, watch *w)
{
  ct_error error;
  double p0 = momentum(left) + momentum(right), scale = momentum(left);
  memset(w, 0, sizeof *w);
  w->first_contact = -1.0;
  for (double t = 0.0; t < end; t += dt) {
    double fa[3], fb[3], ma[3], mb[3];
    bar_forces(left);
    bar_forces(right);
    if (ct_contact_update(contact, &left->x[0][0], &right->x[0][0], &error) != CT_OK) return 0;
    if (ct_contact_add_force(contact, &left->f[0][0], &right->f[0][0], NULL) != CT_OK) return 0;
    if (ct_contact_resultant(contact, fa, ma, fb, mb, NULL) != CT_OK) return 0;
    if (fa[0] != 0.0) {
      if (w->first_contact < 0.0) w->first_contact = t;
      w->last_contact = t;
    }
    if (t > 5.0 && t < 15.0) {
      w->pressure += fb[0];
      w->samples++;
    }
    w->imbalance = fmax(w->imbalance, fabs(fa[0] + fb[0]));
    bar_step(left, dt);
    bar_step(right, dt);
    w->drift = fmax(w->drift, fabs(momentum(left) + momentum(right) - p0) / scale);
  }
  w->pressure /= w->samples;
  return 1;
}

int main(void)
{
  static bar left, right;
  static const int32_t left_face[4] = {4 * LAYERS - 4, 4 * LAYERS - 3, 4 * LAYERS - 2,
                                       4 * LAYERS - 1},
                       right_face[4] = {3, 2, 1, 0};
  ct_surface a, b;
  ct_contact_options options = ct_contact_options_default();
  ct_contact *contact = NULL;
  ct_error error;
  watch w;
  double dt_contact = 0.0, dt_host, dt, before;
  bar_make(&left, -10.0, 0.1);
  bar_make(&right, 0.0, -0.1);
  memset(&a, 0, sizeof a);
  a.kind = CT_Q4;
  a.node_count = NODES;
  a.face_count = 1;
  a.faces = left_face;
  a.reference = &left.X[0][0];
  b = a;
  b.faces = right_face;
  b.reference = &right.X[0][0];
  options.epsilon = ct_contact_penalty(1.0, 1.0, left.h), options.travel_time = left.h;
  options.depth = 1.0;

  tap_ok(ct_contact_create(&a, &b, &options, &contact, &error) == CT_OK,
         "a contact of two surfaces over the host's arrays");
  if (contact == NULL) return tap_done();
  tap_ok(ct_contact_update_stable_step(contact, left.mass, right.mass, &dt_contact, NULL) == CT_OK,
         "its stable step");
  /* Chain with lumped masses: h / c = h. With the contact: 1 / dt² = 1 / dt_contact² + 1 /
   * dt_host². */
  dt_host = left.h;
  dt = 0.5 / sqrt(1.0 / (dt_contact * dt_contact) + 1.0 / (dt_host * dt_host));
  /* One pair of end nodes: k = 1 / (4 h), m = h / 8 each, so ω² = 2 k / m = 4 / h² and dt = h. The
   * bound of both together is h / √2, below the true limit sqrt(2 / (1 + √5)) h = 0.786 h. */
  tap_close(dt_contact / left.h, 1.0, 1e-12,
            "stable step of the contact of two end layers at beta = 1");
  before = energy(&left) + energy(&right);
  tap_ok(loop(&left, &right, contact, dt, 25.0, &w), "the host's time loop");
  tap_close(w.pressure, 0.1, 0.001, "pressure rho c v");
  tap_close(w.last_contact - w.first_contact, 20.0, 0.3, "the bars part after 2 L / c");
  tap_close(w.drift, 0.0, 1e-12, "momentum of both bars");
  tap_close(w.imbalance, 0.0, 1e-15, "the two resultants");
  tap_close(momentum(&right), 1.0, 0.03, "the right bar leaves with the velocity of the left one");
  tap_close((energy(&left) + energy(&right)) / before, 1.0, 0.01, "energy after the impact");
  tap_ok(ct_contact_energy(contact) == 0.0, "no energy is left in the contact");

  bar_make(&left, -10.0, 0.1);
  bar_make(&right, 0.0, -0.1);
  for (double beta = 1.0; beta < 200.0; beta *= 10.0) controlled(&a, &b, beta);
  slide();

  right.x[0][1] = sqrt(-1.0);
  tap_ok(ct_contact_update(contact, &left.x[0][0], &right.x[0][0], &error) == CT_INVALID &&
             error.body == 1 && error.point == 0,
         "NaN is refused by surface and node: %s", error.text);
  ct_contact_free(contact);
  options.epsilon = -1.0;
  tap_ok(ct_contact_create(&a, &b, &options, &contact, &error) == CT_ERROR_ARGUMENT,
         "a negative penalty is refused: %s", error.text);
  return tap_done();
}
