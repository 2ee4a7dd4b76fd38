/* A host with its own mesh, arrays and time loop, that takes only the contact from the library.
 *
 * Two equal bars, each a chain of square layers with springs along x between them, meet at v = ±0.1
 * (L = 10, E = ρ = A = 1). Closed form: they stay in contact for 2 L / c = 20 with the pressure ρ c
 * v = 0.1 and part with exchanged velocities. */
#include "tap.h"

#include <contact.h>

#include <stdlib.h>
#include <string.h>

enum { LAYERS = 101, NODES = 4 * LAYERS };

typedef struct bar {
  double x[NODES][3], v[NODES][3], f[NODES][3], X[NODES][3], mass[NODES];
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
    if (ct_contact_add_force(contact, &left->f[0][0], &right->f[0][0]) != CT_OK) return 0;
    if (ct_contact_resultant(contact, fa, ma, fb, mb) != CT_OK) return 0;
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
  options.epsilon = ct_contact_penalty(1.0, 1.0, left.h);
  options.depth = 1.0;

  tap_ok(ct_contact_create(&a, &b, &options, &contact, &error) == CT_OK,
         "a contact of two surfaces over the host's arrays");
  if (contact == NULL) return tap_done();
  tap_ok(ct_contact_stable_step(contact, left.mass, right.mass, &dt_contact) == CT_OK,
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
