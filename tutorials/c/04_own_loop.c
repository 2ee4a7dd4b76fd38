/* Two bars with meshes, springs and a time loop of this program; only the contact is the library's.
 * The left bar has 3 x 3 faces at its end, the right one 2 x 2. With L = 10 and E = rho = A = 1 the
 * bars meet at the velocities 0.1 and -0.1, press each other with rho c v = 0.1 for 2 L / c = 20,
 * and part with exchanged velocities. */
#include <libcontact/contact.h>
#include <stdio.h>

enum { LAYERS = 101, MOST = 16 * LAYERS };
static const double h = 10.0 / (LAYERS - 1);

/* Node (n + 1)² l + (n + 1) j + i is node i, j of layer l. Nodes move along x only. Springs join
 * the neighbours along x, and resist the sliding of neighbours in a layer. */
typedef struct bar {
  int n, nodes;
  double X[MOST][3], x[MOST][3], v[MOST][3], f[MOST][3], area[MOST], inverse_mass[MOST][3];
  int32_t face[9][4];
} bar;

static void make(bar *b, int n, double start, double velocity, int left)
{
  int layer = (n + 1) * (n + 1), end = left ? layer * (LAYERS - 1) : 0;
  b->n = n, b->nodes = layer * LAYERS;
  for (int a = 0; a < b->nodes; a++) {
    int i = a % (n + 1), j = a / (n + 1) % (n + 1), l = a / layer;
    b->X[a][0] = start + l * h, b->X[a][1] = (double)i / n, b->X[a][2] = (double)j / n;
    b->v[a][0] = velocity;
    b->area[a] = (i % n ? 1.0 : 0.5) * (j % n ? 1.0 : 0.5) / (n * n);
    for (int c = 0; c < 3; c++) b->x[a][c] = b->X[a][c];
    b->inverse_mass[a][0] = 1.0 / (b->area[a] * h * (l % (LAYERS - 1) ? 1.0 : 0.5));
  }
  /* Counter-clockwise from outside: seen along -x on the left bar, along x on the right one. */
  for (int k = 0; k < n * n; k++) {
    int first = end + (n + 1) * (k / n) + k % n;
    b->face[k][0] = first, b->face[k][2] = first + n + 2;
    b->face[k][left ? 1 : 3] = first + 1, b->face[k][left ? 3 : 1] = first + n + 1;
  }
}

static ct_surface surface(const bar *b)
{
  ct_surface s = {CT_Q4, b->nodes, b->n * b->n, &b->face[0][0], &b->X[0][0]};
  return s;
}

static void springs(bar *b)
{
  int layer = (b->n + 1) * (b->n + 1);
  for (int a = 0; a < b->nodes; a++) b->f[a][0] = b->f[a][1] = b->f[a][2] = 0.0;
  for (int a = 0; a + layer < b->nodes; a++) {
    double force = b->area[a] / h * (b->x[a + layer][0] - b->x[a][0] - h);
    b->f[a][0] += force, b->f[a + layer][0] -= force;
  }
  for (int a = 0; a < b->nodes; a++) {
    int beside[2] = {a % (b->n + 1) < b->n ? a + 1 : a,
                     a % layer < layer - b->n - 1 ? a + b->n + 1 : a};
    for (int k = 0; k < 2; k++) {
      double force = 0.25 * h * (b->x[beside[k]][0] - b->x[a][0]);
      b->f[a][0] += force, b->f[beside[k]][0] -= force;
    }
  }
}

static double advance(bar *b, double dt, double kick)
{
  double momentum = 0.0;
  for (int a = 0; a < b->nodes; a++) {
    b->v[a][0] += kick * b->f[a][0] * b->inverse_mass[a][0];
    b->x[a][0] += dt * b->v[a][0];
    momentum += b->v[a][0] / b->inverse_mass[a][0];
  }
  return momentum;
}

int main(void)
{
  static bar left, right;
  const double dt = 0.9 * h;
  make(&left, 3, -10.0, 0.1, 1);
  make(&right, 2, 0.0, -0.1, 0);
  ct_surface a = surface(&left), b = surface(&right);
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = ct_contact_penalty_default(options.enforcement, 1.0, h);
  options.travel_time = h; /* h / c1, c1 = 1 */
  ct_contact *contact = NULL;
  ct_error e;
  int failed = ct_contact_create(&a, &b, &options, &contact, &e) != CT_OK;
  ct_contact_prediction p = {.x_a = left.x[0], .x_b = right.x[0], .dt = dt};
  p.velocity_a = left.v[0], p.velocity_b = right.v[0];
  p.force_a = left.f[0], p.force_b = right.f[0];
  p.inverse_mass_a = left.inverse_mass[0], p.inverse_mass_b = right.inverse_mass[0];
  for (int step = 0; step * dt < 25.0 && !failed; step++) {
    double force[2][3], moment[2][3], momentum;
    springs(&left), springs(&right);
    p.force_time = step == 0 ? 0.5 * dt : dt; /* the first step begins with v_0 */
    failed = ct_contact_step(contact, &p, &e) != CT_OK ||
             ct_contact_add_force(contact, left.f[0], right.f[0], NULL) != CT_OK ||
             ct_contact_resultant(contact, force[0], moment[0], force[1], moment[1], NULL) != CT_OK;
    advance(&left, dt, p.force_time);
    momentum = advance(&right, dt, p.force_time);
    if (step % 55 == 25)
      printf("t = %5.2f: force %.3f, momentum of the right bar %6.3f\n", step * dt, force[1][0],
             momentum);
  }
  if (failed) puts(e.text);
  ct_contact_balance balance;
  if (!failed && ct_contact_balance_of(contact, &balance, NULL) == CT_OK)
    printf("the contact has taken %.4f of the energy 0.1\n", -balance.work);
  ct_contact_free(contact);
  return failed;
}
