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
  frequencies();
  refusals();
  cost();
  return tap_done();
}
