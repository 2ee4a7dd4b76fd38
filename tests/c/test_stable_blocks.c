/* The bound on the step of a box of bricks by blocks of its elements: above the largest eigenvalue
 * of the whole, and close to it. */
#include "blocks.h"

static const ct_material SOFT = {1.0, 0.3, 1.0, CT_LINEAR};

/* The effect of one body with fixed components. */
static block open_held(const ct_mesh *m, const ct_material *material, ct_solid_kernel kernel,
                       const int held[3])
{
  return open_body((ct_solid_body){
      .mesh = m, .material = *material, .kernel = kernel, .fixed = {held[0], held[1], held[2]}});
}

/* Reported over true step of boxes of many sizes and shapes (eq:block-bound, eq:block-fold). */
static void sharpness(ct_solid_kernel kernel, const char *name)
{
  static const int CELLS[][3] = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {5, 3, 2},
                                 {1, 1, 7}, {6, 1, 1}, {1, 5, 4}, {2, 7, 2}, {3, 1, 9}};
  static const double EDGE[][3] = {{1, 1, 1}, {1, 2, 3}, {1, 0.2, 0.2}},
                      POISSON[] = {0.0, 0.3, 0.49};
  double least = INFINITY, most = 0.0;
  for (size_t k = 0; k < sizeof CELLS / sizeof CELLS[0]; k++)
    for (int s = 0; s < 3; s++) {
      const int *n = CELLS[k], held[3] = {0, 0, 0};
      ct_material material = {1.0, POISSON[(k + (size_t)s) % 3], 1.0, CT_LINEAR};
      ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, n[0] * EDGE[s][0], n[1] * EDGE[s][1],
                            n[2] * EDGE[s][2], n[0], n[1], n[2]);
      block solid = open_held(m, &material, kernel, held);
      double share =
          sqrt(block_quotient(&solid, m, material.density, held, 1500) / block_frequency(&solid));
      least = fmin(least, share);
      most = fmax(most, share);
    }
  tap_ok(most <= 1.0 + 1e-12 && least >= 0.9,
         "%s, 30 boxes: reported over true step between %.4f and %.4f", name, least, most);
}

/* Fixed components do not bound the step: plates in plane strain, bars in one dimension, a body
 * that cannot move at all. */
static void held_components(void)
{
  ct_material material = {1.0, 0.3, 1.0, CT_LINEAR};
  double least = INFINITY, most = 0.0, c1, c2;
  for (int axis = 0; axis < 3; axis++) {
    int n[3] = {8, 8, 8}, held[3] = {axis == 0, axis == 1, axis == 2};
    n[axis] = 1;
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, n[0], n[1], n[2], n[0], n[1], n[2]);
    block solid = open_held(m, &material, CT_KERNEL_AUTO, held);
    double share =
        sqrt(block_quotient(&solid, m, material.density, held, 1500) / block_frequency(&solid));
    least = fmin(least, share);
    most = fmax(most, share);
  }
  tap_ok(most <= 1.0 + 1e-12 && least >= 0.97, "plates in plane strain: between %.4f and %.4f",
         least, most);

  // A bar whose sections stay as they are: 2 c1 / h.
  int bar[3] = {0, 1, 1}, all[3] = {1, 1, 1};
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 8, 2, 1, 8, 2, 1);
  block solid = open_held(m, &material, CT_KERNEL_AUTO, bar);
  ct_material_speeds(&material, &c1, &c2);
  double got = sqrt(block_frequency(&solid)) / (2.0 * c1);
  tap_ok(got >= 1.0 && got < 1.2, "a bar fixed on its sides: omega h / 2 c1 = %.4f", got);
  solid = open_held(m, &material, CT_KERNEL_AUTO, all);
  tap_ok(block_frequency(&solid) == 0.0, "a body with all nodes fixed has no bound");
  // The same for a mesh that is no box.
  distort(m, 0.1);
  solid = open_held(m, &material, CT_KERNEL_AUTO, all);
  tap_ok(block_frequency(&solid) == 0.0, "also if it is not a box");
  int none[3] = {0, 0, 0};
  block unheld = open_held(m, &material, CT_KERNEL_AUTO, none);
  solid = open_held(m, &material, CT_KERNEL_AUTO, bar);
  double share =
      sqrt(block_quotient(&solid, m, material.density, bar, 1500) / block_frequency(&solid));
  tap_ok(block_frequency(&solid) < 0.9 * block_frequency(&unheld) && share <= 1.0,
         "a distorted one, by its elements, fixed on its sides: %.4f", share);
}

/* A box with nodes and elements in any order has the same bound, with the same bits; bodies that
 * only resemble a box have the bound of their elements. */
static void looks(void)
{
  const int held[3] = {0, 0, 0};
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 4, 4, 4, 4, 4, 4);
  block solid = open_held(m, &SOFT, CT_KERNEL_BOX, held);
  double box = block_frequency(&solid), x[60], mass[20], one;
  take_element(m, 0, m->nodes, x);
  must(ct_mass_element, CT_HEX8, x, SOFT.density, CT_LUMP_DEFAULT, mass);
  must(ct_solid_element_omega2_bound, CT_HEX8, x, NULL, &SOFT, mass, &one);
  tap_ok(box < 0.7 * one, "the bound of blocks is %.3f of that of one element", box / one);

  // Numbers of nodes and elements backward.
  int last = m->node_count - 1;
  for (int n = 0; 2 * n < last; n++)
    for (int c = 0; c < 3; c++) {
      double keep = m->nodes[3 * n + c];
      m->nodes[3 * n + c] = m->nodes[3 * (last - n) + c];
      m->nodes[3 * (last - n) + c] = keep;
    }
  for (int i = 0; i < 8 * m->element_count; i++) m->elements[i] = last - m->elements[i];
  solid = open_held(m, &SOFT, CT_KERNEL_BOX, held);
  tap_ok(block_frequency(&solid) == box,
         "a box whose nodes are numbered backward has the same bits");

  // A corner is missing.
  m = box_mesh(CT_HEX8, 0, 0, 0, 4, 4, 4, 4, 4, 4);
  m->element_count--;
  solid = open_held(m, &SOFT, CT_KERNEL_BOX, held);
  tap_close(block_frequency(&solid) / one, 1.0, 1e-13, "a box without one corner has it, too");
  m->element_count++;
}

/* A rotated box has the bound of the box; one with sheared bricks that of its elements. */
static void turned(void)
{
  const int held[3] = {0, 0, 0}, along[3] = {0, 1, 0};
  double worst_off = 0.0;
  ct_mesh *m = box_mesh(CT_HEX8, -0.4, 0.3, 0.2, 2, 3, 1, 5, 4, 3);
  block solid = open_held(m, &SOFT, CT_KERNEL_AUTO, held);
  double straight = block_frequency(&solid);
  for (int trial = 0; trial < 20; trial++) {
    ct_mesh *t = box_mesh(CT_HEX8, -0.4, 0.3, 0.2, 2, 3, 1, 5, 4, 3);
    double a = uniform(3.0), b = uniform(3.0);
    for (int n = 0; n < t->node_count; n++) {
      double *x = &t->nodes[3 * n], p = cos(a) * x[0] - sin(a) * x[1],
             q = sin(a) * x[0] + cos(a) * x[1];
      x[0] = cos(b) * p - sin(b) * x[2], x[2] = sin(b) * p + cos(b) * x[2], x[1] = q;
    }
    // What is held along y is not held along an edge.
    solid = open_held(t, &SOFT, CT_KERNEL_AUTO, trial % 2 ? along : held);
    worst_off = worst(worst_off, block_frequency(&solid) / straight - 1.0);
  }
  tap_ok(worst_off < 2e-9, "20 rotated boxes: off by %.2g", worst_off);
  double lean = 0.0, x[60], mass[20], one;
  for (int n = 0; n < m->node_count; n++) m->nodes[3 * n] += 1e-3 * m->nodes[3 * n + 1];
  solid = open_held(m, &SOFT, CT_KERNEL_AUTO, held);
  lean = block_frequency(&solid);
  take_element(m, 0, m->nodes, x);
  must(ct_mass_element, CT_HEX8, x, SOFT.density, CT_LUMP_DEFAULT, mass);
  must(ct_solid_element_omega2_bound, CT_HEX8, x, NULL, &SOFT, mass, &one);
  tap_close(lean / one, 1.0, 1e-13, "sheared bricks have the bound of their elements");
}

int main(void)
{
  free_at_end();
  sharpness(CT_KERNEL_AUTO, "box kernel");
  sharpness(CT_KERNEL_REDUCED, "one-point kernel");
  held_components();
  looks();
  turned();
  return tap_done();
}
