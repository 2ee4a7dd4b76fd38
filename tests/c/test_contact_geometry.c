/* Hard geometry of contact: history of a point, thin plates, corners and edges, folds, sliding over borders, meshes that do not match. */
#include "patches.h"

#include <contact/quadrature.h>

static void lift(patch *p, double z)
{
  for (int n = 0; n < p->surface.node_count; n++) p->x[3 * n + 2] = z;
}

/* A patch that is pressed through another one, to five times the depth, in small steps: force and energy of the gap all the way, and back. */
static void held(ct_face_kind kind)
{
  patch a = new_patch(kind, 2, 2, 0, 0, 2, 2, 1), b = new_patch(kind, 2, 2, 0, 0, 2, 2, 0);
  ct_contact_options options = ct_contact_options_default();
  options.depth = 0.3;
  ct_contact *contact = open_contact(&a, &b, options);
  double *fa = numbers(75), *fb = numbers(75), force = 0.0, energy = 0.0, apart = 0.0;
  for (int i = 0; i <= 200; i++) {
    double g = 0.05 - 0.0155 * (i <= 100 ? i : 200 - i);
    lift(&b, g);
    update(contact, &a, &b);
    forces(contact, &a, &b, fa, fb);
    if (g < 0.0) {
      force = worst(force, total(fb, 25, 2) / (-EPSILON * g * 4.0) - 1.0);
      energy = worst(energy, ct_contact_energy(contact) / (0.5 * EPSILON * g * g * 4.0) - 1.0);
    } else {
      apart = worst(apart, largest(fb, 75));
    }
  }
  tap_ok(force < 1e-12 && energy < 1e-12 && apart == 0.0, "%s: a patch pressed to five times the depth and back keeps its force and energy (off by %.2g, %.2g)", KIND[kind], force, energy);
  ct_contact_free(contact);
  free(fa);
  free(fb);
  free_patch(&a);
  free_patch(&b);
}

/* Points that are deeper than the depth at the first look are in no contact, not when they come nearer either, but once they have been outside. */
static void buried(void)
{
  static const double z[7] = {-1.0, -0.5, -0.2, -0.01, 0.01, -0.01, -0.2};
  patch a = new_patch(CT_Q4, 2, 2, 0, 0, 2, 2, 1), b = new_patch(CT_Q4, 2, 2, 0, 0, 2, 2, 0);
  ct_contact_options options = ct_contact_options_default();
  options.depth = 0.3;
  ct_contact *contact = open_contact(&a, &b, options);
  ct_penetration found;
  int wrong = 0;
  for (int i = 0; i < 7; i++) {
    lift(&b, z[i]);
    update(contact, &a, &b);
    wrong += (ct_contact_energy(contact) > 0.0) != (i > 4);
    wrong += ct_contact_penetration(contact, CT_AT_POINTS, &found) != CT_OK || found.buried != (i < 4 ? 32 : 0) || found.inside != (i == 4 ? 0 : 32);
    wrong += !(fabs(found.deepest - (i > 4 ? -z[i] : 0.0)) < 1e-15);
  }
  tap_ok(wrong == 0, "points deep inside at the first look are in no contact before they have been outside (%d wrong)", wrong);
  ct_contact_free(contact);
  free_patch(&a);
  free_patch(&b);
}

/* A closed box as a surface over nodes of its own. */
static patch new_box(const double low[3], const double size[3], const int cells[3])
{
  ct_mesh *m = box_mesh(CT_HEX8, low[0], low[1], low[2], size[0], size[1], size[2], cells[0], cells[1], cells[2]);
  patch p = {{CT_Q4, m->node_count, 0, NULL, NULL}, integers(4 * 6 * m->element_count), numbers(3 * m->node_count)};
  p.surface.face_count = ct_mesh_outer_faces(m, p.faces, NULL);
  memcpy(p.x, m->nodes, 3 * (size_t)m->node_count * sizeof *p.x);
  p.surface.faces = p.faces;
  p.surface.reference = p.x;
  ct_mesh_free(m);
  return p;
}

static void shift(patch *p, double x, double y, double z)
{
  for (int n = 0; n < p->surface.node_count; n++) p->x[3 * n] += x, p->x[3 * n + 1] += y, p->x[3 * n + 2] += z;
}

/* Depth of a point under the surface of a box that may only be left by its lower or upper side (`way` -1 or 1) or by the sides around. */
static double depth_in(const double p[3], const double low[3], const double high[3], int way)
{
  double depth = way > 0 ? high[2] - p[2] : p[2] - low[2];
  for (int c = 0; c < 2; c++) depth = fmin(depth, fmin(p[c] - low[c], high[c] - p[c]));
  return depth;
}

/* A thin closed plate is pressed through a larger one, to 1.6 thicknesses: each point belongs to the side by which it came in, or to the side faces around
 * when these are nearer. Up to one thickness the energy has a closed form; beyond, points have come out below, and still they are pushed back. */
static void thin_plates(void)
{
  const double t = 0.1, low_a[3] = {0, 0, 0}, size_a[3] = {2, 2, 0.1}, low_b[3] = {0.63, 0.59, 0.1001}, size_b[3] = {0.8, 0.8, 0.1};
  const int cells_a[3] = {10, 10, 1}, cells_b[3] = {5, 5, 1};
  patch a = new_box(low_a, size_a, cells_a), b = new_box(low_b, size_b, cells_b);
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  double off = 0.0, jump = 0.0, last = 0.0, *fa = numbers(3 * a.surface.node_count), *fb = numbers(3 * b.surface.node_count), step = 0.002;
  int downward = 0;
  for (int i = 1; i <= 80; i++) {
    double energy = 0.0, high_a[3] = {2, 2, t}, low[3], high[3];
    shift(&b, 0, 0, -step);
    for (int c = 0; c < 3; c++) low[c] = b.x[c], high[c] = b.x[c] + size_b[c];
    update(contact, &a, &b);
    forces(contact, &a, &b, fa, fb);
    ct_contact_points(contact, point);
    for (int k = 0; k < count; k++) {
      const double *y = point[k].position;
      // Points of b that look up do not come in by a's top, nor those of a that look down by b's bottom.
      double depth = point[k].side == 1 ? depth_in(y, low_a, high_a, 1) : depth_in(y, low, high, -1);
      int out = point[k].side == 1 ? fabs(y[2] - high[2]) < 1e-9 : y[2] == 0.0;
      if (depth > 0.0 && !out) energy += 0.25 * EPSILON * depth * depth * point[k].weight;
    }
    if (i <= 50) off = worst(off, (ct_contact_energy(contact) - energy) / (energy + 1e-6));
    if (i <= 50) jump = fmax(jump, fabs(total(fb, b.surface.node_count, 2) - last));
    last = total(fb, b.surface.node_count, 2);
    downward += !(last > (i <= 50 ? 0.0 : 0.7 * EPSILON * t * 0.64));
  }
  tap_ok(off < 1e-9, "thin plates, pressed to their thickness: the energy is that of each point under the side it came in by, off by %.2g", off);
  tap_ok(downward == 0 && jump < 1.5 * EPSILON * step * 0.8 * 0.8, "thin plates: no jump (at most %.3g of a step's stiffness), and pushed apart to 1.6 thicknesses, with %.3g of eps t A there",
         jump / (EPSILON * step * 0.64), last / (EPSILON * t * 0.64));
  ct_contact_free(contact);
  free(point);
  free(fa);
  free(fb);
  free_patch(&a);
  free_patch(&b);
}

int main(void)
{
  for (int kind = 0; kind < 4; kind++) held((ct_face_kind)kind);
  buried();
  thin_plates();
  return tap_done();
}
