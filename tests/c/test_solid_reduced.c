/* Reduced hex8: the kernel against the readable form, patch test, hourglass modes, bending against
 * beam theory, bound on the step. */
#include "blocks.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
static const ct_material SOFT = {1.0, 0.2, 1.0, CT_LINEAR};

/* Energy of the hourglass control at u, from the effect with this name. */
static double hourglass_energy(const block *solid, const double *u)
{
  ct_effect *effect = NULL;
  double energy = NAN;
  must(ct_solid_create_hourglass, solid->effect, &effect);
  ct_view view = {.displacement = u};
  must(effect->calls->energy, effect, &view, &energy);
  ct_effect_free(effect);
  return energy;
}

/* Forces and energies of all elements by the readable form. */
static void readable(const ct_mesh *m, const ct_material *material, const double *u, double *f,
                     double energy[2])
{
  memset(f, 0, 3 * (size_t)m->node_count * sizeof *f);
  energy[0] = energy[1] = 0.0;
  for (int el = 0; el < m->element_count; el++) {
    double x[60], v[60], g[24], own[2];
    take_element(m, el, m->nodes, x);
    take_element(m, el, u, v);
    must(ct_solid_reduced_force, x, v, material, 1.0, g, own);
    for (int a = 0; a < 8; a++)
      for (int c = 0; c < 3; c++) f[3 * m->elements[el * 8 + a] + c] += g[3 * a + c];
    for (int i = 0; i < 2; i++) energy[i] += own[i];
  }
}

/* The kernel, by modes, against the readable form, by Gauss points (eq:mean-gradient,
 * eq:mean-gradient-modes, eq:reduced-force). */
static void kernel(void)
{
  for (int turned = 0; turned < 2; turned++) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 5, 4, 7, 5, 4, 7);
    distort(m, 0.15);
    if (turned) turn_elements(m);
    int n = 3 * m->node_count;
    double *u = random_displacement(m, 1e-3), *f = numbers(n), *g = numbers(n), want[2];
    block solid = open_block(m, &STEEL, CT_KERNEL_REDUCED);
    double strain = block_force(&solid, u, f), hourglass = hourglass_energy(&solid, u);
    readable(m, &STEEL, u, g, want);
    double off = largest_difference(f, g, n) / largest(g, n);
    tap_ok(off < 1e-13, "kernel against the readable form%s: force off by %.2g",
           turned ? ", rotated elements" : "", off);
    tap_ok(fabs(strain / want[0] - 1.0) < 1e-13 && fabs(hourglass / want[1] - 1.0) < 1e-13,
           "its energies: off by %.2g and %.2g", strain / want[0] - 1.0, hourglass / want[1] - 1.0);
    // The force is linear: energy is half its work.
    double work = 0.0;
    for (int i = 0; i < n; i++) work -= 0.5 * f[i] * u[i];
    tap_close((strain + hourglass) / work, 1.0, 1e-12,
              "both energies are half the work of the force");
    ct_view view = {.settings = &TWO, .displacement = u, .scratch = solid.scratch};
    must(solid.effect->calls->force, solid.effect, &view, g);
    tap_ok(memcmp(f, g, (size_t)n * sizeof *f) == 0, "two threads: the same bits");
  }
}

/* The force is minus the gradient of both energies, by differences (eq:reduced-force,
 * eq:reduced-energy). */
static void gradient(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  distort(m, 0.15);
  double x[60], u[24], f[24], energy[2][2], off = 0.0;
  take_element(m, 0, m->nodes, x);
  for (int i = 0; i < 24; i++) u[i] = uniform(1e-3);
  must(ct_solid_reduced_force, x, u, &SOFT, 0.7, f, NULL);
  for (int i = 0; i < 24; i++) {
    double at = u[i], g[24];
    for (int s = 0; s < 2; s++) {
      u[i] = at + (s == 0 ? -1e-4 : 1e-4);
      must(ct_solid_reduced_force, x, u, &SOFT, 0.7, g, energy[s]);
    }
    u[i] = at;
    off = worst(off, f[i] + ((energy[1][0] - energy[0][0]) + (energy[1][1] - energy[0][1])) / 2e-4);
  }
  tap_ok(off < 1e-13 * largest(f, 24),
         "the force is minus the gradient of both energies, off by %.2g", off / largest(f, 24));
}

/* A linear displacement on a distorted mesh: constant stress, no force inside, no hourglass energy
 * (eq:mean-gradient, eq:hourglass-vector, eq:hourglass-amplitude). */
static void patch(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 3, 3);
  distort(m, 0.08);
  turn_elements(m);
  double G[9], lambda, mu, inner = 0.0, volume = 0.0, density = 0.0,
                           *u = numbers(3 * m->node_count), *f = numbers(3 * m->node_count);
  for (int i = 0; i < 9; i++) G[i] = uniform(1e-3);
  for (int n = 0; n < m->node_count; n++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) u[3 * n + i] += G[3 * i + j] * m->nodes[3 * n + j];
  ct_material_lame(&STEEL, &lambda, &mu);
  double trace = G[0] + G[4] + G[8];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      density += 0.5 * (mu * (G[3 * i + j] + G[3 * j + i]) + (i == j ? lambda * trace : 0.0)) *
                 G[3 * i + j];
  for (int el = 0; el < m->element_count; el++) {
    double x[60], mass[8];
    take_element(m, el, m->nodes, x);
    must(ct_mass_element, CT_HEX8, x, 1.0, CT_LUMP_ROW_SUM, mass);
    for (int a = 0; a < 8; a++) volume += mass[a];
  }
  block solid = open_block(m, &STEEL, CT_KERNEL_REDUCED);
  double strain = block_force(&solid, u, f), hourglass = hourglass_energy(&solid, u),
         top = largest(f, 3 * m->node_count);
  int32_t *outer = integers(48 * m->element_count), *is_outer = integers(m->node_count);
  int faces = ct_mesh_outer_faces(m, outer, NULL);
  for (int i = 0; i < 4 * faces; i++) is_outer[outer[i]] = 1;
  for (int n = 0; n < m->node_count; n++)
    for (int c = 0; c < 3; c++)
      if (!is_outer[n]) inner = worst(inner, f[3 * n + c]);
  tap_ok(inner < 1e-13 * top, "patch: no force at inner nodes, at most %.2g of the largest",
         inner / top);
  tap_close(strain / (density * volume), 1.0, 1e-12,
            "patch: the energy is that of the constant strain");
  tap_ok(hourglass < 1e-24 * strain, "patch: no hourglass energy, %.2g of the strain's",
         hourglass / strain);
}

/* Translations and small rotations: no force; and no other mechanism: six zero eigenvalues of
 * the 24. */
static void rigid(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  distort(m, 0.15);
  static double A[24 * 24];
  double x[60], u[24], f[24], top = 0.0;
  int zero = 0;
  take_element(m, 0, m->nodes, x);
  for (int j = 0; j < 24; j++) {
    for (int i = 0; i < 24; i++) u[i] = i == j;
    must(ct_solid_reduced_force, x, u, &SOFT, 0.3, f, NULL);
    for (int i = 0; i < 24; i++) A[24 * i + j] = -f[i];
  }
  top = jacobi_largest(24, A);
  double least = top;
  for (int i = 0; i < 24; i++) {
    if (fabs(A[25 * i]) < 1e-13 * top) zero++;
    else least = fmin(least, A[25 * i]);
  }
  tap_ok(zero == 6 && least > 1e-3 * top,
         "six rigid motions and no other mechanism: %d zero eigenvalues, the next is %.3g of the "
         "largest",
         zero, least / top);
  double motion = 0.0;
  for (int r = 0; r < 6; r++) {
    for (int a = 0; a < 8; a++)
      for (int c = 0; c < 3; c++) {
        int p = (r + 1) % 3, q = (r + 2) % 3;
        u[3 * a + c] = r < 3 ? (c == r) : c == p ? -x[3 * a + q] : c == q ? x[3 * a + p] : 0.0;
      }
    must(ct_solid_reduced_force, x, u, &SOFT, 0.3, f, NULL);
    motion = worst(motion, largest(f, 24));
  }
  tap_ok(motion < 1e-14, "rigid motions: forces of at most %.2g", motion);
}

/* The amplitude a of ηζ on a cube of edge h costs (2/3) Q E h a², with Q = 1 what the beam with the
 * linear strain stores (eq:hourglass-stiffness, eq:hourglass-amplitude, eq:reduced-energy). */
static void modes(void)
{
  static const int factor[4][3] = {{1, 1, 0}, {0, 1, 1}, {1, 0, 1}, {1, 1, 1}};
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1);
  double x[60], u[24], f[24], energy[2], wrong = 0.0, strain = 0.0;
  take_element(m, 0, m->nodes, x);
  for (int k = 0; k < 12; k++) {
    for (int a = 0; a < 8; a++) {
      double xi[3], h = 1e-3;
      ct_brick_reference(CT_HEX8, a, xi);
      for (int c = 0; c < 3; c++) h *= factor[k / 3][c] ? xi[c] : 1.0;
      for (int c = 0; c < 3; c++) u[3 * a + c] = c == k % 3 ? h : 0.0;
    }
    must(ct_solid_reduced_force, x, u, &STEEL, 0.4, f, energy);
    wrong = worst(wrong, energy[1] / (2.0 / 3.0 * 0.4 * STEEL.young * 0.5 * 1e-6) - 1.0);
    strain = worst(strain, energy[0]);
  }
  tap_ok(wrong < 1e-13 && strain < 1e-25,
         "the twelve hourglass modes of a cube cost 2/3 Q E h a^2, off by %.2g, and strain "
         "nothing",
         wrong);
}

/* Uniform curvature of a beam with n cubes through its height, no Poisson effect: the energy over
 * that of the beam is 1 - (1 - Q) / n² (eq:reduced-bending). */
static void curvature(void)
{
  ct_material m = {1.0, 0.0, 1.0, CT_LINEAR};
  double off = 0.0;
  for (int n = 1; n <= 4; n++) {
    ct_mesh *beam = box_mesh(CT_HEX8, 0, -0.5 * n, 0, 6, n, 1, 6, n, 1);
    double *u = numbers(3 * beam->node_count), *f = numbers(3 * beam->node_count), c = 1e-3;
    for (int k = 0; k < beam->node_count; k++) {
      const double *x = &beam->nodes[3 * k];
      u[3 * k] = -c * x[0] * x[1];
      u[3 * k + 1] = 0.5 * c * x[0] * x[0];
    }
    ct_solid_body b = {.mesh = beam, .material = m, .kernel = CT_KERNEL_REDUCED, .hourglass = 0.3};
    block solid = open_body(b);
    double energy = block_force(&solid, u, f) + hourglass_energy(&solid, u),
           exact = 0.5 * (n * n * n / 12.0) * c * c * 6.0;
    off = worst(off, energy / exact - (1.0 - (1.0 - 0.3) / (n * n)));
  }
  tap_ok(off < 1e-13,
         "bent beams of 1 to 4 cubes: the energy is 1 - (1 - Q) / n^2 of the beam's, off by %.2g",
         off);
}

/* The mean displacement at the end of a cantilever that is fixed at x = 0 and pulled up at x =
 * length, by conjugate gradients. */
static double tip(const ct_mesh *m, const ct_material *material, ct_solid_kernel kernel,
                  double hourglass, double length, double load)
{
  int n = 3 * m->node_count;
  double *u = numbers(n), *r = numbers(n), *d = numbers(n), *q = numbers(n), rr = 0.0, mean = 0.0;
  int32_t *end = integers(m->node_count), *root = integers(m->node_count), *fixed = integers(n);
  int ends = ct_mesh_plane_nodes(m, 0, length, end), roots = ct_mesh_plane_nodes(m, 0, 0.0, root);
  ct_solid_body b = {.mesh = m, .material = *material, .kernel = kernel, .hourglass = hourglass};
  block solid = open_body(b);
  // The root is held along the beam, and against rigid motion; it may swell.
  for (int i = 0; i < roots; i++) {
    fixed[3 * root[i]] = 1;
    if (fabs(m->nodes[3 * root[i] + 1]) < 1e-9) fixed[3 * root[i] + 1] = 1;
    if (m->nodes[3 * root[i] + 2] == 0.0) fixed[3 * root[i] + 2] = 1;
  }
  int32_t *faces = integers(48 * m->element_count),
          count = ct_mesh_plane_faces(m, 0, length, faces, NULL);
  for (int i = 0; i < 4 * count; i++) r[3 * faces[i] + 1] += load / (4 * count);
  for (int i = 0; i < n; i++) rr += r[i] * r[i], d[i] = r[i];
  double first = rr;
  for (int k = 0; k < 20 * n && rr > 1e-22 * first; k++) {
    double dq = 0.0, next = 0.0;
    ct_view view = {.displacement = d, .scratch = solid.scratch};
    must(solid.effect->calls->force, solid.effect, &view, q);
    for (int i = 0; i < n; i++) dq -= d[i] * (fixed[i] ? 0.0 : q[i]);
    for (int i = 0; i < n; i++) {
      u[i] += rr / dq * d[i];
      r[i] += fixed[i] ? 0.0 : rr / dq * q[i];
      next += r[i] * r[i];
    }
    for (int i = 0; i < n; i++) d[i] = r[i] + next / rr * d[i];
    rr = next;
  }
  for (int i = 0; i < ends; i++) mean += u[3 * end[i] + 1] / ends;
  return mean;
}

/* Length 10, height 1, n cubes through the height, one through the width; the deflection over
 * Timoshenko's. */
static void cantilever(void)
{
  static const double Q[3] = {0.1, 0.3, 1.0};
  ct_material m = {1.0, 0.3, 1.0, CT_LINEAR};
  double shear = m.young / (2.0 * (1.0 + m.poisson)),
         factor = 10.0 * (1.0 + m.poisson) / (12.0 + 11.0 * m.poisson), worst_off = 0.0, full[3];
  for (int k = 0; k < 3; k++) {
    int n = 1 << k;
    double h = 1.0 / n, I = h / 12.0, load = 1e-6,
           exact = load * 1000.0 / (3.0 * m.young * I) + load * 10.0 / (factor * shear * h);
    ct_mesh *beam = box_mesh(CT_HEX8, 0, -0.5, 0, 10, 1, h, 10 * n, n, 1);
    if (n == 1)
      for (int i = 0; i < beam->node_count; i++) beam->nodes[3 * i + 1] += 0.5;
    full[k] = tip(beam, &m, CT_KERNEL_GENERAL, 0.0, 10.0, load) / exact;
    for (int c = 0; c < 3; c++) {
      double ratio = tip(beam, &m, CT_KERNEL_REDUCED, Q[c], 10.0, load) / exact,
             simple = 1.0 / (1.0 - (1.0 - Q[c]) / (n * n));
      printf("# n = %d, Q = %.1f: deflection %.4f of Timoshenko's (1 / (1 - (1 - Q) / n^2) "
             "= %.4f); full integration %.4f\n",
             n, Q[c], ratio, simple, full[k]);
      worst_off = worst(worst_off, ratio / simple - 1.0);
    }
  }
  tap_ok(worst_off < 0.03,
         "cantilevers of 1, 2, 4 cubes: the stated error of the coefficient, and at most %.3f "
         "beside it",
         worst_off);
  tap_ok(fabs(full[0] - 1.0) > 0.25,
         "full integration is %.3f of the deflection with one element: shear locks it", full[0]);
}

static void frequencies(void)
{
  double low = INFINITY, high = 0.0;
  for (int trial = 0; trial < 20; trial++) {
    static double A[24 * 24];
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, exp(uniform(1.5)), 1, exp(uniform(1.5)), 1, 1, 1);
    distort(m, 0.05);
    double K[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE], spread[CT_ELEMENT_SIZE];
    double x[60], u[24] = {0}, f[24], mass[20], w, Q = exp(uniform(4.0));
    take_element(m, 0, m->nodes, x);
    must(ct_mass_element, CT_HEX8, x, STEEL.density, CT_LUMP_DEFAULT, mass);
    ct_spread_mass(8, mass, NULL, spread);
    must(ct_reduced_stiffness, x, &STEEL, Q, K);
    must(ct_largest_eigenvalue, 24, spread, K, &w);
    for (int j = 0; j < 24; j++) {
      u[j] = 1.0;
      must(ct_solid_reduced_force, x, u, &STEEL, Q, f, NULL);
      u[j] = 0.0;
      for (int i = 0; i < 24; i++) A[24 * i + j] = -f[i] / sqrt(mass[i / 3] * mass[j / 3]);
    }
    double ratio = w / jacobi_largest(24, A);
    low = fmin(low, ratio);
    high = fmax(high, ratio);
  }
  tap_ok(low >= 1.0 - 1e-13 && high < 1.0 + 1e-11,
         "20 distorted elements: bound over Jacobi's eigenvalue in 1%+.2g ... 1%+.2g", low - 1.0,
         high - 1.0);
}

/* A block released from an hourglass mode: the energy balance has its energy as a separate part,
 * and closes. */
static void ledger(void)
{
  ct_scene *scene = new_scene();
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 3, 3);
  distort(m, 0.05);
  double *v = random_displacement(m, 1e-3);
  ct_error e;
  ct_scene_body block = {.mesh = m, .material = SOFT, .kernel = CT_KERNEL_REDUCED};
  block.velocities = v;
  block.hourglass = -1.0;
  tap_ok(ct_scene_add_body(scene, &block, NULL, &e) == CT_ERROR_ARGUMENT,
         "a negative coefficient is refused: %s", e.text);
  block.hourglass = 0.5;
  must(ct_scene_add_body, scene, &block, NULL);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 20.0, .fraction = 0.9}, &steps, NULL);
  ct_state *state = new_state(p);
  double total = energy_of(p, state).total, spread = 0.0, balance = 0.0, most = 0.0, hourglass;
  for (int64_t k = 0; k < steps; k++) {
    advance(p, state, 1);
    ct_energy energy = energy_of(p, state);
    must(ct_energy_stored, p, state, 1, &hourglass);
    spread = worst(spread, energy.total / total - 1.0);
    balance = worst(balance, energy.balance / total);
    most = fmax(most, hourglass);
  }
  tap_ok(p->effect_count == 2 && strcmp(p->effects[1]->label, "hourglass") == 0 &&
             most > 0.01 * total,
         "the energy balance has an hourglass energy, up to %.2g of the whole", most / total);
  tap_ok(spread < 1e-12 && balance < 1e-12,
         "energy is conserved to %.2g and the work balance closes to %.2g over %d steps", spread,
         balance, (int)steps);
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2),
          *q = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_solid_body b = {.mesh = q, .material = STEEL, .kernel = CT_KERNEL_REDUCED};
  ct_effect *effect = NULL, *hourglass = NULL;
  ct_error e = {0};
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_UNSUPPORTED && e.body == 0,
         "hex20 is refused: %s", e.text);
  b.mesh = m;
  b.material.law = CT_NEO_HOOKEAN;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_UNSUPPORTED,
         "large deformation is refused: %s", e.text);
  double x[60], u[24] = {0}, f[24];
  take_element(m, 0, m->nodes, x);
  tap_ok(ct_solid_reduced_force(x, u, &b.material, 0.3, f, NULL, &e) == CT_ERROR_UNSUPPORTED,
         "of one element: refused");
  b.material = STEEL;
  b.hourglass = -0.1;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "a negative coefficient is refused: %s", e.text);
  tap_ok(ct_solid_reduced_force(x, u, &STEEL, 0.0, f, NULL, &e) == CT_ERROR_ARGUMENT,
         "a zero coefficient is refused: %s", e.text);
  b.hourglass = 0.0;
  b.kernel = CT_KERNEL_AUTO;
  must(create_solid, &b, 1, &effect);
  tap_ok(ct_solid_create_hourglass(effect, &hourglass, &e) == CT_OK && hourglass == NULL,
         "without a reduced body there is no hourglass effect");
  ct_effect_free(effect);
  for (int c = 0; c < 3; c++) {
    double t = x[c];
    x[c] = x[12 + c];
    x[12 + c] = t;
  }
  tap_ok(ct_solid_reduced_force(x, u, &STEEL, 0.3, f, NULL, &e) == CT_ERROR_GEOMETRY,
         "a folded element is refused: %s", e.text);
}

/* Operations of the reduced kernel over those of full integration. */
static void cost(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 4, 4, 4);
  distort(m, 0.02);
  double flops[2], bytes;
  for (int k = 0; k < 2; k++) {
    block solid = open_block(m, &STEEL, k == 0 ? CT_KERNEL_GENERAL : CT_KERNEL_REDUCED);
    ct_solid_kernel kernel;
    ct_solid_body_plan(solid.effect, 0, &kernel, &flops[k], &bytes, NULL);
  }
  tap_ok(flops[0] / flops[1] > 1.5, "full integration takes %.2f times the operations",
         flops[0] / flops[1]);
}

int main(void)
{
  free_at_end();
  kernel();
  gradient();
  patch();
  rigid();
  modes();
  curvature();
  cantilever();
  frequencies();
  ledger();
  refusals();
  cost();
  return tap_done();
}
