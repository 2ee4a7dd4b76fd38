/* The box kernel of hex20: comparison with the general one, exact translations, exchanged axes, and
 * its range of bodies. */
#include "blocks.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* Both kernels at one displacement, for edges of 1 : 2 : 7 in any order and the whole range of
 * materials (eq:box20-own, eq:box20-couplings, eq:box20-force, eq:box20-amplitudes). */
static void beside_the_general_kernel(void)
{
  static const double edge[6][3] = {{1, 2, 7}, {2, 7, 1}, {7, 1, 2},
                                    {7, 2, 1}, {1, 7, 2}, {2, 1, 7}};
  static const double poisson[4] = {0.0, 0.3, 0.49, -0.5};
  for (int p = 0; p < 4; p++) {
    double off = 0.0, energy_off = 0.0, bound_off = 0.0;
    for (int k = 0; k < 6; k++) {
      ct_material material = {2.1e5, poisson[p], 7.8e-9, CT_LINEAR};
      ct_mesh *m =
          box_mesh(CT_HEX20, 0.2, -3, 1, 3 * edge[k][0], 4 * edge[k][1], 2 * edge[k][2], 3, 4, 2);
      block box = open_block(m, &material, CT_KERNEL_BOX),
            general = open_block(m, &material, CT_KERNEL_GENERAL);
      double *u = random_displacement(m, 1e-3), *f = numbers(3 * m->node_count),
             *g = numbers(3 * m->node_count);
      double energy = block_force(&box, u, f), want = block_force(&general, u, g);
      off = worst(off, largest_difference(f, g, 3 * m->node_count) / largest(g, 3 * m->node_count));
      energy_off = worst(energy_off, energy / want - 1.0);
      bound_off = worst(bound_off, block_frequency(&box) - block_frequency(&general));
    }
    tap_ok(off < 1e-13 && energy_off < 1e-13,
           "nu = %g, edges 1 : 2 : 7: the general kernel's forces to %.2g, its energy to %.2g",
           poisson[p], off, energy_off);
    tap_ok(bound_off == 0.0, "nu = %g: the bound of omega^2 is that of the elements", poisson[p]);
  }
}

/* Differences come first: a translation that rounds no displacement (here one displacement takes
 * all 53 bits) changes no bit of any force, and alone gives exact zeros. */
static void translations(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 2, 7, 3, 2, 2);
  int n = 3 * m->node_count, zeros = 1;
  block box = open_block(m, &STEEL, CT_KERNEL_BOX);
  double *u = numbers(n), *f = numbers(n), *g = numbers(n);
  for (int i = 0; i < n; i++) u[i] = ldexp(floor(uniform(1024.0)), -20);
  block_force(&box, u, f);
  for (int i = 0; i < n; i++) u[i] += (double[]){-6e9, 5e9, 8e9}[i % 3];
  block_force(&box, u, g);
  tap_ok(memcmp(f, g, (size_t)n * sizeof *f) == 0 && largest(f, n) > 0.0,
         "far from the origin the forces of a deformation have the same bits");
  for (int trial = 0; trial < 6; trial++) {
    double t[3] = {pow(10.0, 60 * trial), -0.0, uniform(1.0)};
    for (int i = 0; i < n; i++) u[i] = t[i % 3];
    zeros &= block_force(&box, u, f) == 0.0 && largest(f, n) == 0.0;
  }
  tap_ok(zeros, "a translation, also one of 1e300, gives exactly no force and no energy");
}

/* A body whose axes are exchanged, x to y to z to x, has the exchanged forces, to round-off: no
 * axis is treated differently. */
static void exchanged_axes(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 2, 7, 1, 1, 1),
          *t = box_mesh(CT_HEX20, 0, 0, 0, 7, 1, 2, 1, 1, 1);
  block box = open_block(m, &STEEL, CT_KERNEL_BOX), turned = open_block(t, &STEEL, CT_KERNEL_BOX);
  double u[60], v[60], f[60], g[60], off = 0.0;
  int32_t image[20];
  for (int i = 0; i < 60; i++) u[i] = uniform(1.0);
  for (int a = 0; a < 20; a++) {
    double xi[3], at[3];
    ct_brick_reference(CT_HEX20, a, xi);
    for (int c = 0; c < 3; c++) at[(c + 1) % 3] = xi[c];
    image[m->elements[a]] = t->elements[local_node(CT_HEX20, at)];
  }
  for (int i = 0; i < 60; i++) v[3 * image[i / 3] + (i + 1) % 3] = u[i];
  block_force(&box, u, f);
  block_force(&turned, v, g);
  for (int i = 0; i < 60; i++) off = worst(off, f[i] - g[3 * image[i / 3] + (i + 1) % 3]);
  tap_ok(off < 1e-14 * largest(f, 60), "exchanged axes: exchanged forces, off by %.2g",
         off / largest(f, 60));
}

/* The kernel of a body, or -1 with the status UNSUPPORTED. */
static int kernel_for(const ct_mesh *m, ct_solid_kernel asked, ct_law law, int held, ct_error *e)
{
  ct_solid_body b = {.mesh = m, .material = STEEL, .kernel = asked, .fixed = {0, held, 0}};
  ct_effect *effect = NULL;
  ct_solid_kernel chosen = CT_KERNEL_AUTO;
  b.material.law = law;
  ct_status status = create_solid(&b, 1, &effect, e);
  if (status == CT_ERROR_UNSUPPORTED) return -1;
  need(status, e);
  ct_solid_body_plan(effect, 0, &chosen, NULL, NULL, NULL);
  ct_effect_free(effect);
  return (int)chosen;
}

static void choice(void)
{
  ct_error e = {0};
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 3, 1, 2, 3, 1, 2);
  tap_ok(kernel_for(m, CT_KERNEL_AUTO, CT_LINEAR, 0, &e) == CT_KERNEL_BOX,
         "equal boxes get the box kernel");
  tap_ok(kernel_for(m, CT_KERNEL_AUTO, CT_LINEAR, 1, &e) == CT_KERNEL_BOX,
         "one layer that is fixed, too: the plane kernel is for hex8");
  tap_ok(kernel_for(m, CT_KERNEL_PLANE, CT_LINEAR, 1, &e) == -1 && strstr(e.text, "hex20") != NULL,
         "a request for that kernel is refused: %s", e.text);
  tap_ok(kernel_for(m, CT_KERNEL_AUTO, CT_NEO_HOOKEAN, 0, &e) == CT_KERNEL_GENERAL &&
             kernel_for(m, CT_KERNEL_BOX, CT_NEO_HOOKEAN, 0, &e) == -1,
         "large deformation gets the general one");
  int missed = 0, refused = 0, taken = 0;
  for (int a = 0; a < 20; a++)
    for (int c = 0; c < 3; c++) {
      double *x = &m->nodes[3 * m->elements[20 * 4 + a] + c], keep = *x;
      *x = keep + 1e-9;
      missed += kernel_for(m, CT_KERNEL_AUTO, CT_LINEAR, 0, &e) != CT_KERNEL_GENERAL;
      refused += kernel_for(m, CT_KERNEL_BOX, CT_LINEAR, 0, &e) == -1;
      *x = keep + 1e-13;
      taken += kernel_for(m, CT_KERNEL_AUTO, CT_LINEAR, 0, &e) == CT_KERNEL_BOX;
      *x = keep;
    }
  tap_ok(missed == 0 && refused == 60 && taken == 60,
         "a node that is moved by 1e-9 is detected, corner or not, and a rounded one is not: %s",
         e.text);
  ct_ring ring = {{0, 0, 0}, {1.0, 2.0}, 1.0, {1, 8, 1}};
  ct_mesh *round;
  must(ct_mesh_create_ring, CT_HEX20, &ring, &round);
  tap_ok(kernel_for(round, CT_KERNEL_AUTO, CT_LINEAR, 0, &e) == CT_KERNEL_GENERAL,
         "a ring gets the general one");
  free_mesh(round);
}

int main(void)
{
  free_at_end();
  beside_the_general_kernel();
  translations();
  exchanged_axes();
  choice();
  return tap_done();
}
