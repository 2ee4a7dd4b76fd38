/* Lumped masses against volumes, closed forms and the mirror. */
#include "bodies.h"

static const char *KIND[2] = {"hex8", "hex20"};

static double *masses(const ct_mesh *m, double density, ct_lumping lumping)
{
  double *mass = numbers(m->node_count);
  must(ct_mass_lumped, m, density, lumping, mass);
  return mass;
}

static double total(const double *v, int n)
{
  double sum = 0.0;
  for (int i = 0; i < n; i++) sum += v[i];
  return sum;
}

static void total_mass(ct_brick_kind kind, ct_lumping lumping)
{
  // Inner nodes move, the box stays, so the volume is 2 * 1 * 1.5; afterwards an affine map
  // multiplies it by its determinant.
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 2, 1, 1.5, 4, 3, 3);
  distort_inside(m, 0.05);
  double *mass = masses(m, 7.8, lumping), least = INFINITY;
  for (int n = 0; n < m->node_count; n++) least = fmin(least, mass[n]);
  tap_close(total(mass, m->node_count), 7.8 * 3.0, 1e-12,
            "%s, lumping %d: mass of a distorted box is rho V", KIND[kind], lumping);
  tap_ok(least > 0.0, "%s, lumping %d: all masses are positive (least %.3g)", KIND[kind], lumping,
         least);

  const double A[3][3] = {{1.1, 0.2, -0.3}, {0.1, 0.9, 0.4}, {-0.2, 0.3, 1.3}};
  double det = 1.1 * (0.9 * 1.3 - 0.4 * 0.3) - 0.2 * (0.1 * 1.3 - 0.4 * -0.2) +
               -0.3 * (0.1 * 0.3 - 0.9 * -0.2);
  for (int n = 0; n < m->node_count; n++) {
    double x[3], *y = &m->nodes[3 * n];
    memcpy(x, y, sizeof x);
    for (int i = 0; i < 3; i++) y[i] = A[i][0] * x[0] + A[i][1] * x[1] + A[i][2] * x[2];
  }
  mass = masses(m, 7.8, lumping);
  tap_close(total(mass, m->node_count), 7.8 * 3.0 * det, 1e-12,
            "%s, lumping %d: mass of the sheared box", KIND[kind], lumping);
}

static void mirrored(ct_brick_kind kind)
{
  for (int axis = 0; axis < 3; axis++) {
    ct_mesh *m = box_mesh(kind, 0.1, -0.3, 0.2, 1, 1, 1, 3, 3, 3);
    distort(m, 0.03);
    ct_mesh *image = mirror_mesh(m, axis);
    double *mass = masses(m, 1.7, CT_LUMP_DEFAULT), *other = masses(image, 1.7, CT_LUMP_DEFAULT);
    tap_ok(memcmp(mass, other, (size_t)m->node_count * sizeof *mass) == 0,
           "%s: mirrored in %c, the same bits", KIND[kind], "xyz"[axis]);
  }
}

/* Elements with arbitrary axes may meet a node in the same octant; the masses are the same. */
static void turned(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 1, 4, 4, 4);
  distort(m, 0.02);
  double *straight = masses(m, 1.7, CT_LUMP_DEFAULT);
  turn_elements(m);
  double *mass = masses(m, 1.7, CT_LUMP_DEFAULT),
         off = largest_difference(mass, straight, m->node_count) / largest(straight, m->node_count);
  tap_ok(off < 1e-14, "%s: turned elements have the same masses, off by %.2g", KIND[kind], off);
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 2, 1, 1, 2, 1, 1);
  double *mass = numbers(m->node_count);
  ct_error e = {0};
  tap_ok(ct_mass_lumped(m, 1.0, CT_LUMP_ROW_SUM, mass, &e) == CT_ERROR_UNSUPPORTED &&
             strstr(e.text, "negative") != NULL,
         "row sum of hex20 is refused: %s", e.text);
  tap_ok(ct_mass_lumped(m, -1.0, CT_LUMP_DEFAULT, mass, &e) == CT_ERROR_GEOMETRY && e.element == 0,
         "a negative density is refused: %s", e.text);
  m->nodes[0] = NAN;
  tap_ok(ct_mass_lumped(m, 1.0, CT_LUMP_DEFAULT, mass, &e) != CT_OK,
         "a NaN in the nodes is refused: %s", e.text);
  tap_ok(ct_mass_lumped(NULL, 1.0, CT_LUMP_DEFAULT, mass, NULL) == CT_ERROR_ARGUMENT &&
             ct_mass_lumped(m, 1.0, CT_LUMP_DEFAULT, NULL, NULL) == CT_ERROR_ARGUMENT,
         "null arguments are refused");
  tap_ok(ct_mass_element((ct_brick_kind)9, m->nodes, 1.0, CT_LUMP_DEFAULT, mass, NULL) ==
             CT_ERROR_ARGUMENT,
         "an unknown element is refused");
}

/* Boxes of any shape, place and unit: their quick masses against those of their elements one by
 * one, which are integrated, and against closed forms. */
static void any_box(ct_lumping lumping)
{
  double off = 0.0, from_closed = 0.0;
  for (int trial = 0; trial < 60; trial++) {
    double unit = pow(10.0, uniform(8.0)), size[3], place[3], x[60], one[20];
    int cells[3];
    for (int d = 0; d < 3; d++) {
      cells[d] = 1 + pick(7);
      size[d] = unit * pow(10.0, pick(3) == 0 ? uniform(6.0) : uniform(0.5));
      place[d] = trial % 2 ? size[d] * uniform(3.0) : 0.0;
    }
    ct_mesh *m = box_mesh(CT_HEX8, place[0], place[1], place[2], size[0], size[1], size[2],
                          cells[0], cells[1], cells[2]);
    double *mass = masses(m, 7.8, lumping), *sum = numbers(m->node_count);
    double least = 7.8 * size[0] * size[1] * size[2] / (8.0 * m->element_count);
    for (int e = 0; e < m->element_count; e++) {
      take_element(m, e, m->nodes, x);
      need(ct_mass_element(CT_HEX8, x, 7.8, lumping, one, NULL), NULL);
      for (int a = 0; a < 8; a++) sum[m->elements[8 * e + a]] += one[a];
    }
    for (int n = 0; n < m->node_count; n++) {
      int at[3] = {n % (cells[0] + 1), n / (cells[0] + 1) % (cells[1] + 1),
                   n / ((cells[0] + 1) * (cells[1] + 1))};
      double want = least;
      for (int d = 0; d < 3; d++) want *= at[d] == 0 || at[d] == cells[d] ? 1.0 : 2.0;
      off = worst(off, mass[n] / sum[n] - 1.0);
      from_closed = worst(from_closed, mass[n] / want - 1.0);
    }
  }
  // Coordinates are rounded to 1e-16 of the largest one, so edges to some 1e-15 of themselves.
  tap_ok(off < 4e-15 && from_closed < 4e-14,
         "lumping %d: 60 boxes, flat, tiny, huge, have the masses of their elements (off by %.2g) "
         "and those of the closed form (%.2g)",
         lumping, off, from_closed);
}

int main(void)
{
  free_at_end();
  total_mass(CT_HEX8, CT_LUMP_ROW_SUM);
  total_mass(CT_HEX8, CT_LUMP_HRZ);
  total_mass(CT_HEX20, CT_LUMP_DEFAULT);
  any_box(CT_LUMP_ROW_SUM);
  any_box(CT_LUMP_HRZ);
  turned(CT_HEX8);
  turned(CT_HEX20);
  mirrored(CT_HEX8);
  mirrored(CT_HEX20);
  refusals();
  return tap_done();
}
