/* Hard geometry of contact: history of a point, thin plates, corners and edges, folds, sliding over
 * borders, meshes that do not match. */
#include "patches.h"

#include "../../libcontact/src/contact/contact_internal.h"

#include <libcontact/shape.h>

static void lift(patch *p, double z)
{
  for (int n = 0; n < p->surface.node_count; n++) p->x[3 * n + 2] = z;
}

/* A patch that is pressed through another one, to five times the depth, in small steps: force and
 * energy of the gap all the way, and back. (eq:point-status, eq:held) */
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
  tap_ok(force < 1e-12 && energy < 1e-12 && apart == 0.0,
         "%s: a patch pressed to five times the depth and back keeps its force and energy (off by "
         "%.2g, %.2g)",
         KIND[kind], force, energy);
}

/* Points that are deeper than the depth at the first update are not in contact until they have been
 * outside, also if they come nearer. (eq:point-status) */
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
    wrong += ct_contact_penetration(contact, CT_AT_POINTS, &found, NULL) != CT_OK ||
             found.buried != (i < 4 ? 32 : 0) || found.inside != (i == 4 ? 0 : 32);
    wrong += !(fabs(found.deepest - (i > 4 ? -z[i] : 0.0)) < 1e-15);
  }
  tap_ok(
      wrong == 0,
      "points deep inside at the first update are not in contact until they have been outside (%d "
      "wrong)",
      wrong);
}

static void shift(patch *p, double x, double y, double z)
{
  for (int n = 0; n < p->surface.node_count; n++)
    p->x[3 * n] += x, p->x[3 * n + 1] += y, p->x[3 * n + 2] += z;
}

/* Depth of a point under the surface of a box that may only be left by its lower or upper side
 * (`way` -1 or 1) or by the sides around. */
static double depth_in(const double p[3], const double low[3], const double high[3], int way)
{
  double depth = way > 0 ? high[2] - p[2] : p[2] - low[2];
  for (int c = 0; c < 2; c++) depth = fmin(depth, fmin(p[c] - low[c], high[c] - p[c]));
  return depth;
}

/* A thin closed plate is pressed through a larger one, to 1.6 thicknesses: each point belongs to
 * the side through which it came in, or to the side faces if these are nearer. Up to one thickness
 * the energy has a closed form; beyond, points have left below, and are still pushed back.
 * (eq:far-side, eq:held) */
static void thin_plates(void)
{
  const double t = 0.1, low_a[3] = {0, 0, 0}, size_a[3] = {2, 2, 0.1},
               low_b[3] = {0.63, 0.59, 0.1001}, size_b[3] = {0.8, 0.8, 0.1};
  const int cells_a[3] = {10, 10, 1}, cells_b[3] = {5, 5, 1};
  patch a = new_box(low_a, size_a, cells_a), b = new_box(low_b, size_b, cells_b);
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  double off = 0.0, jump = 0.0, last = 0.0, *fa = numbers(3 * a.surface.node_count),
         *fb = numbers(3 * b.surface.node_count), step = 0.002;
  int downward = 0;
  for (int i = 1; i <= 80; i++) {
    double energy = 0.0, high_a[3] = {2, 2, t}, low[3], high[3];
    shift(&b, 0, 0, -step);
    for (int c = 0; c < 3; c++) low[c] = b.x[c], high[c] = b.x[c] + size_b[c];
    update(contact, &a, &b);
    forces(contact, &a, &b, fa, fb);
    ct_contact_points(contact, point, NULL);
    for (int k = 0; k < count; k++) {
      const double *y = point[k].position;
      // Points of b that look up do not come in by a's top, nor those of a that look down by b's
      // bottom.
      double depth =
          point[k].side == 1 ? depth_in(y, low_a, high_a, 1) : depth_in(y, low, high, -1);
      int out = point[k].side == 1 ? fabs(y[2] - high[2]) < 1e-9 : y[2] == 0.0;
      if (depth > 0.0 && !out) energy += 0.25 * EPSILON * depth * depth * point[k].weight;
    }
    if (i <= 50) off = worst(off, (ct_contact_energy(contact) - energy) / (energy + 1e-6));
    if (i <= 50) jump = fmax(jump, fabs(total(fb, b.surface.node_count, 2) - last));
    last = total(fb, b.surface.node_count, 2);
    downward += !(last > (i <= 50 ? 0.0 : 0.7 * EPSILON * t * 0.64));
  }
  tap_ok(off < 1e-12,
         "thin plates, pressed to their thickness: the energy is that of each point under the side "
         "through which it came in, off by %.2g",
         off);
  tap_ok(downward == 0 && jump < 1.5 * EPSILON * step * 0.8 * 0.8,
         "thin plates: no jump (at most %.3g of a step's stiffness), and pushed apart to 1.6 "
         "thicknesses, with %.3g of eps t A there",
         jump / (EPSILON * step * 0.64), last / (EPSILON * t * 0.64));
}

static ct_contact_options with_points(ct_contact_rule rule)
{
  ct_contact_options options = ct_contact_options_default();
  options.points = rule;
  return options;
}

static int triangular(ct_face_kind kind) { return kind == CT_T3 || kind == CT_T6; }

/* Lobatto's rule: its points are the corners, middles of edges and the centre, all weights are
 * positive, and it is exact to degree 3. */
static void lobatto(ct_face_kind kind)
{
  ct_rule rule;
  double off = 0.0, low = 1.0;
  int corners = 0, three = triangular(kind);
  need(ct_rule_lobatto(kind, &rule), &(ct_error){0});
  for (int i = 0; i <= 3; i++)
    for (int j = 0; i + j <= 3; j++) {
      // ∫ x^i y^j is i! j! / (i + j + 2)! on the triangle, and the product of 2 / (i + 1) for even
      // i on the square.
      static const double factorial[6] = {1, 1, 2, 6, 24, 120};
      double sum = 0.0, want = three            ? factorial[i] * factorial[j] / factorial[i + j + 2]
                               : i % 2 || j % 2 ? 0.0
                                                : 4.0 / ((i + 1) * (j + 1));
      for (int q = 0; q < rule.count; q++)
        sum += rule.weight[q] * pow(rule.xi[q][0], i) * pow(rule.xi[q][1], j);
      off = worst(off, sum - want);
    }
  for (int q = 0; q < rule.count; q++) {
    low = fmin(low, rule.weight[q]);
    corners += three ? (rule.xi[q][0] == 1.0 || rule.xi[q][1] == 1.0 ||
                        rule.xi[q][0] + rule.xi[q][1] == 0.0)
                     : fabs(rule.xi[q][0]) == 1.0 && fabs(rule.xi[q][1]) == 1.0;
  }
  tap_ok(off < 1e-15 && low > 0.0 && corners == (three ? 3 : 4),
         "%s: Lobatto's rule has all corners, positive weights, and degree 3 (off by %.2g)",
         KIND[kind], off);
}

/* Matching flat meshes with points at nodes: uniform pressure, so nodal forces eps delta ∫N
 * exactly, also at the border of the open surfaces. */
static void patch_test(ct_face_kind kind)
{
  const double delta = 0.01;
  patch a = new_patch(kind, 3, 2, 0, 0, 3, 2, 1), b = new_patch(kind, 3, 2, 0, 0, 3, 2, 0);
  int nodes = a.surface.node_count, per = ct_face_node_count(kind);
  double *fa = numbers(3 * nodes), *fb = numbers(3 * nodes), *want = numbers(3 * nodes), off = 0.0;
  ct_rule gauss;
  ct_rule_face(kind, &gauss, NULL);
  for (int f = 0; f < a.surface.face_count; f++)
    for (int q = 0; q < gauss.count; q++) {
      double N[8], J = triangular(kind) ? 1.0 : 0.25;
      ct_segment_shape(kind, gauss.xi[q], N);
      for (int n = 0; n < per; n++)
        want[3 * a.faces[f * per + n] + 2] -= EPSILON * delta * gauss.weight[q] * J * N[n];
    }
  lift(&b, -delta);
  ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_LOBATTO));
  update(contact, &a, &b);
  forces(contact, &a, &b, fa, fb);
  for (int i = 0; i < 3 * nodes; i++) off = worst(worst(off, fa[i] - want[i]), fb[i] + want[i]);
  // The patch that faces down numbers its faces from below, over the same nodes.
  tap_ok(off < 1e-13 * EPSILON * delta,
         "%s: points at nodes pass the patch test on matching meshes, off by %.2g of eps delta",
         KIND[kind], off / (EPSILON * delta));
}

/* Two warped patches with points at nodes: forces are the gradient of the energy, and both momenta
 * are kept. */
static void lobatto_gradient(ct_face_kind kind)
{
  patch a = new_patch(kind, 3, 3, -1.5, -1.5, 3, 3, 1),
        b = new_patch(kind, 2, 2, -0.53, -0.51, 1, 1, 0);
  for (int n = 0; n < a.surface.node_count; n++)
    a.x[3 * n + 2] = 0.05 * sin(1.3 * a.x[3 * n]) + uniform(0.01);
  for (int n = 0; n < b.surface.node_count; n++)
    b.x[3 * n + 2] = -0.09 + 0.03 * b.x[3 * n] + uniform(0.01);
  int na = a.surface.node_count, nb = b.surface.node_count;
  double *fa = numbers(3 * na), *fb = numbers(3 * nb), off = 0.0, h = 1e-6, F[2][3], M[2][3], top;
  ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_LOBATTO));
  update(contact, &a, &b);
  forces(contact, &a, &b, fa, fb);
  top = largest(fb, 3 * nb);
  need(ct_contact_resultant(contact, F[0], M[0], F[1], M[1], NULL), &(ct_error){0});
  for (int i = 0; i < 3 * (na + nb); i++) {
    double *x = i < 3 * na ? &a.x[i] : &b.x[i - 3 * na], keep = *x,
           f = i < 3 * na ? fa[i] : fb[i - 3 * na], up;
    *x = keep + h;
    update(contact, &a, &b);
    up = ct_contact_energy(contact);
    *x = keep - h;
    update(contact, &a, &b);
    off = worst(off, f + (up - ct_contact_energy(contact)) / (2.0 * h));
    *x = keep;
  }
  double momentum = 0.0;
  for (int c = 0; c < 3; c++)
    momentum = fmax(momentum, fmax(fabs(F[0][c] + F[1][c]), fabs(M[0][c] + M[1][c])));
  tap_ok(
      top > 0.0 && off < 1e-8 * top && momentum < 1e-12 * top,
      "%s: with points at nodes the force is the gradient (off by %.2g), momentum is kept (%.2g)",
      KIND[kind], off / top, momentum / top);
}

/* Height of the lowest of the highest positions: largest depth of `top` in `base` before any
 * contact point is inside, by bisection; and the deepest corner at this height. */
static double unseen(const patch *base, const patch *top, ct_contact_rule rule, double high,
                     double low)
{
  patch moved = *top;
  moved.x = numbers(3 * top->surface.node_count);
  moved.surface.reference = moved.x;
  for (int i = 0; i < 34; i++) {
    double z = 0.5 * (high + low);
    memcpy(moved.x, top->x, 3 * (size_t)top->surface.node_count * sizeof *moved.x);
    shift(&moved, 0, 0, z);
    ct_contact *contact = open_contact(base, &moved, with_points(rule));
    update(contact, base, &moved);
    if (ct_contact_energy(contact) > 0.0) low = z;
    else high = z;
  }
  return high;
}

/* A cube of one face a side on a floor of faces of the same size, in random orientations: how deep
 * its lowest corner is before a point sees it. And two cubes that meet edge on edge. (eq:unseen) */
static void corners_and_edges(void)
{
  const double floor_low[3] = {-4, -4, -1}, floor_size[3] = {8, 8, 1},
               cube_low[3] = {-0.5, -0.5, -0.5}, cube_size[3] = {1, 1, 1};
  const int floor_cells[3] = {8, 8, 1}, one[3] = {1, 1, 1};
  patch base = new_box(floor_low, floor_size, floor_cells);
  const int cubes = tap_times(8);
  double corner[2] = {0, 0}, edge[2] = {0, 0};
  for (int k = 0; k < cubes; k++) {
    patch cube = new_box(cube_low, cube_size, one);
    double R[3][3], lowest = 0.0;
    random_rotation(R);
    turn(&cube, R);
    shift(&cube, uniform(0.5), uniform(0.5), 0.0);
    for (int n = 0; n < cube.surface.node_count; n++) lowest = fmin(lowest, cube.x[3 * n + 2]);
    for (int r = 0; r < 2; r++)
      corner[r] =
          fmax(corner[r], -lowest - unseen(&base, &cube, r ? CT_POINTS_LOBATTO : CT_POINTS_GAUSS,
                                           -lowest + 0.1, -lowest - 0.45));
  }
  tap_ok(
      corner[0] > 0.05 && corner[0] < 0.5 * (1.0 - 1.0 / sqrt(3.0)) * sqrt(2.0),
      "cubes on a floor: with Gauss points a corner penetrates by up to %.3f h, less than 0.299 h",
      corner[0]);
  tap_ok(corner[1] < 1e-14,
         "cubes on a floor: with points at corners no corner penetrates (%.2g h)", corner[1]);
  // Two cubes on edge, crossed: their edges meet at a random place of both.
  for (int k = 0; k < 24; k++) {
    patch lower = new_box(cube_low, cube_size, one), upper = new_box(cube_low, cube_size, one);
    const double c = sqrt(0.5);
    double about_x[3][3] = {{1, 0, 0}, {0, c, -c}, {0, c, c}},
           about_y[3][3] = {{c, 0, c}, {0, 1, 0}, {-c, 0, c}};
    turn(&lower, about_x);
    turn(&upper, about_y);
    shift(&upper, uniform(0.4), uniform(0.4), 0.0);
    for (int r = 0; r < 2; r++)
      edge[r] =
          fmax(edge[r], 2.0 * c - unseen(&lower, &upper, r ? CT_POINTS_LOBATTO : CT_POINTS_GAUSS,
                                         2.0 * c + 0.1, 2.0 * c - 0.5));
  }
  tap_ok(edge[1] <= 0.25,
         "crossed edges: with points on edges they penetrate by up to %.3f h, at most 0.25 h; with "
         "Gauss points "
         "by %.3f h",
         edge[1], edge[0]);
}

/* A smooth bowl, one quadratic face, that slides over the borders of 20 faces of a base with the
 * profile z(x) = -sign x² / 2 R between its nodes: the largest change of the force in a step of the
 * slide, as a part of the force. */
static double slide(ct_face_kind kind, double bend, double step)
{
  patch base = new_patch(kind, 24, 4, 0, -2, 24, 4, 1),
        bowl = new_patch(CT_Q8, 1, 1, -1.5, -1.5, 3, 3, 0);
  for (int n = 0; n < base.surface.node_count; n++)
    base.x[3 * n + 2] = -0.5 * bend * pow(base.x[3 * n] - 12.0, 2.0);
  for (int n = 0; n < bowl.surface.node_count; n++)
    bowl.x[3 * n + 2] =
        (bowl.x[3 * n] * bowl.x[3 * n] + bowl.x[3 * n + 1] * bowl.x[3 * n + 1]) / 12.0 - 0.15;
  double *start = numbers(3 * bowl.surface.node_count), *fa = numbers(3 * base.surface.node_count),
         *fb = numbers(3 * bowl.surface.node_count), last[3] = {0}, jump = 0.0, size = 0.0;
  memcpy(start, bowl.x, 3 * (size_t)bowl.surface.node_count * sizeof *start);
  ct_contact *contact = open_contact(&base, &bowl, ct_contact_options_default());
  int steps = (int)(20.0 / step + 0.5);
  for (int i = 0; i <= steps; i++) {
    double s = 2.013 + step * i, change = 0.0, tilt = atan(bend * (s - 12.0)),
           R[3][3] = {{cos(tilt), 0, sin(tilt)}, {0, 1, 0}, {-sin(tilt), 0, cos(tilt)}};
    memcpy(bowl.x, start, 3 * (size_t)bowl.surface.node_count * sizeof *start);
    turn(&bowl, R);
    shift(&bowl, s, 0.0071, -0.5 * bend * pow(s - 12.0, 2.0));
    update(contact, &base, &bowl);
    forces(contact, &base, &bowl, fa, fb);
    for (int c = 0; c < 3; c++) {
      double f = total(fb, bowl.surface.node_count, c);
      change += (f - last[c]) * (f - last[c]);
      last[c] = f;
    }
    size = fmax(size, fabs(last[2]));
    if (i > 0) jump = fmax(jump, sqrt(change));
  }
  return jump / size;
}

/* On a flat base the change of the force is proportional to the step of the slide. On a base with
 * folds a point that changes faces changes its direction by the angle of the fold, so the total
 * never jumps by more than that. */
static void sliding(ct_face_kind kind)
{
  double coarse = slide(kind, 0.0, 0.02), fine = slide(kind, 0.0, 0.01);
  tap_ok(fine > 0.0 && fine < 0.6 * coarse && coarse < 0.02,
         "%s: over 20 borders, flat: the force changes by %.2g of itself in a step of 0.02 h, %.2g "
         "in 0.01 h",
         KIND[kind], coarse, fine);
  for (int way = -1; way <= 1; way += 2) {
    double bend = way * 0.03, jump = slide(kind, bend, 0.01);
    tap_ok(jump < fabs(bend) + 2.0 * coarse,
           "%s: over 20 %s folds of %.2g: at most %.2g of the force in 0.01 h", KIND[kind],
           way > 0 ? "convex" : "concave", fabs(bend), jump);
  }
}

/* Area of the points of a patch of nx x ny unit faces at x0, y0 that lie over the rectangle from
 * `low` to `high`. */
static double area_over(int nx, int ny, double x0, double y0, const double low[2],
                        const double high[2])
{
  const double at[2] = {0.5 * (1.0 - 1.0 / sqrt(3.0)), 0.5 * (1.0 + 1.0 / sqrt(3.0))};
  double area = 0.0;
  for (int i = 0; i < 2 * nx; i++)
    for (int j = 0; j < 2 * ny; j++) {
      double x = x0 + i / 2 + at[i % 2], y = y0 + j / 2 + at[j % 2];
      area += x > low[0] && x < high[0] && y > low[1] && y < high[1] ? 0.25 : 0.0;
    }
  return area;
}

/* An open patch slides off another one at a depth, and back on: each point counts in full while it
 * is over the other surface, and not at all beyond the border, whichever way it goes
 * (eq:border-jump). So energy and force change by the columns of points that the two borders pass.
 * (eq:warm-lanes) */
static void open_border(void)
{
  const double delta = 0.05, y0 = 0.513;
  patch a = new_patch(CT_Q4, 4, 2, 0, 0, 4, 2, 1), b = new_patch(CT_Q4, 1, 1, 0, y0, 1, 1, 0);
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  double fa[3 * 45], fb[3 * 9], off = 0.0, along = 0.0, jump = 0.0, last = NAN;
  for (int i = 0; i <= 240; i++) {
    double x0 = 2.5031 + 0.0151 * (i <= 120 ? i : 240 - i), low_b[2] = {x0, y0},
           high_b[2] = {x0 + 1.0, y0 + 1.0}, low_a[2] = {0, 0}, high_a[2] = {4, 2};
    double area = area_over(4, 2, 0, 0, low_b, high_b) + area_over(1, 1, x0, y0, low_a, high_a),
           energy;
    for (int n = 0; n < 9; n++) b.x[3 * n] = x0 + 0.5 * (n % 3), b.x[3 * n + 2] = -delta;
    update(contact, &a, &b);
    forces(contact, &a, &b, fa, fb);
    energy = ct_contact_energy(contact);
    off = worst(worst(off, energy / (0.25 * EPSILON * delta * delta) - area),
                total(fb, 9, 2) / (0.5 * EPSILON * delta) - area);
    along = worst(worst(along, total(fb, 9, 0)), total(fb, 9, 1));
    jump = worst(jump, i == 0 ? 0.0 : energy - last);
    last = energy;
  }
  jump /= 0.25 * EPSILON * delta * delta;
  tap_ok(off < 1e-12 && along < 1e-13,
         "sliding off an open border and back: energy and force are those of the points over the "
         "other surface (off by %.2g), none along it (%.2g)",
         off, along);
  tap_ok(jump > 0.49 && jump < 1.01,
         "at an open border energy jumps by a column of points, %.3g of epsilon delta^2 / 4", jump);
}

/* Largest change of the energy in a step of a block that slides off a plate at a depth, both
 * closed, in parts of the largest energy. */
static double slide_off(double step, double *left)
{
  const double low_a[3] = {0, 0, -1}, size_a[3] = {4, 2, 1}, low_b[3] = {2.5031, 0.513, -0.05},
               size_b[3] = {1, 1, 1};
  const int cells_a[3] = {4, 2, 1}, cells_b[3] = {1, 1, 1};
  patch a = new_box(low_a, size_a, cells_a), b = new_box(low_b, size_b, cells_b);
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  double jump = 0.0, top = 0.0, last = NAN;
  int steps = (int)(1.8 / step + 0.5);
  for (int i = 0; i <= steps; i++) {
    update(contact, &a, &b);
    double energy = ct_contact_energy(contact);
    top = fmax(top, energy);
    jump = worst(jump, i == 0 ? 0.0 : energy - last);
    last = energy;
    shift(&b, step, 0, 0);
  }
  *left = last;
  return jump / top;
}

/* The same with closed surfaces: the points go to the sides, and the energy is continuous. */
static void closed_border(void)
{
  double left[2], coarse = slide_off(0.002, &left[0]), fine = slide_off(0.001, &left[1]);
  tap_ok(fine > 0.0 && fine < 0.55 * coarse && coarse < 0.1 && left[0] == 0.0 && left[1] == 0.0,
         "sliding off with closed surfaces: energy changes by %.2g of itself in a step of 0.002 h, "
         "%.2g in 0.001 h, to none",
         coarse, fine);
}

/* Flat meshes that do not match: resultant and momentum are exact; the error of single nodal forces
 * is that of the analogue on a line. */
static void ratios(void)
{
  static const int cells[5][2] = {{1, 1}, {2, 3}, {4, 5}, {4, 11}, {10, 73}};
  static const double most[5] = {1e-12, 0.0125, 0.0425, 1.0, 1.26};
  const double delta = 1e-3;
  for (int k = 0; k < 5; k++) {
    patch p[2] = {new_patch(CT_Q4, cells[k][0], 1, 0, 0, 1, 1, 1),
                  new_patch(CT_Q4, cells[k][1], 1, 0, 0, 1, 1, 0)};
    double error[2] = {0, 0}, *f[2], sum = 0.0, F[2][3], M[2][3], momentum = 0.0;
    lift(&p[1], -delta);
    ct_contact *contact = open_contact(&p[0], &p[1], ct_contact_options_default());
    for (int s = 0; s < 2; s++) f[s] = numbers(3 * p[s].surface.node_count);
    update(contact, &p[0], &p[1]);
    forces(contact, &p[0], &p[1], f[0], f[1]);
    for (int s = 0; s < 2; s++) {
      int n = cells[k][s], row = 2 * n + 1;
      for (int i = 0; i <= n; i++)
        for (int j = 0; j < 2; j++) {
          double want = EPSILON * delta * (i == 0 || i == n ? 0.25 : 0.5) / n;
          error[s] = worst(error[s], fabs(f[s][3 * (2 * i + 2 * j * row) + 2]) / want - 1.0);
        }
    }
    sum = total(f[1], p[1].surface.node_count, 2);
    need(ct_contact_resultant(contact, F[0], M[0], F[1], M[1], NULL), &(ct_error){0});
    for (int c = 0; c < 3; c++)
      momentum = fmax(momentum, fmax(fabs(F[0][c] + F[1][c]), fabs(M[0][c] + M[1][c])));
    tap_ok(momentum < 1e-14 * EPSILON * delta * cells[k][1] &&
               fabs(sum / (EPSILON * delta) - 1.0) < 1e-12 && fmax(error[0], error[1]) < most[k],
           "%d faces on %d: resultant exact (%.2g), momentum %.2g; nodal forces off by %.3g %% and "
           "%.3g %%",
           cells[k][0], cells[k][1], sum / (EPSILON * delta) - 1.0, momentum, 100.0 * error[0],
           100.0 * error[1]);
  }
}

/* Faces listed as candidates, of a face on the mean. */
static double listed(const ct_contact *contact)
{
  double count = 0.0, faces = 0.0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_search *search = contact->gaps.side[s].search;
    count += contact->gaps.side[s].candidate_first[search->face_count];
    faces += search->face_count;
  }
  return count / faces;
}

/* A ring of long faces in contact with itself: the candidates of each face are those around it, not
 * the whole ring. */
static void local_search(void)
{
  ct_ring shape = {{0, 0, 0}, {40, 50}, 60, {2, 48, 2}};
  ct_mesh *m = NULL;
  must(ct_mesh_create_ring, CT_HEX8, &shape, &m);
  later_mesh(m);
  int count = ct_mesh_outer_faces(m, NULL, NULL);
  int32_t *faces = integers(4 * count);
  ct_mesh_outer_faces(m, faces, NULL);
  ct_surface surface = {CT_Q4, m->node_count, count, faces, m->nodes};
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 1.0;
  ct_contact *contact = NULL;
  must(ct_contact_create, &surface, &surface, &options, &contact);
  later_contact(contact);
  must(ct_contact_update, contact, m->nodes, NULL);
  must(ct_contact_update, contact, m->nodes, NULL);
  tap_ok(count == 384 && listed(contact) < 20.0,
         "a ring of %d faces: %.1f are candidates of a face", count, listed(contact));
}

/* Steps as large as the tunnelling check allows: every point has a partner before it comes in,
 * though the search is local. */
static void seen_before_it_comes_in(void)
{
  ct_mesh *below = box_mesh(CT_HEX8, 0, 0, -6, 60, 12, 6, 3, 12, 2),
          *above = box_mesh(CT_HEX8, 7, 3, 0, 40, 6, 6, 2, 6, 2);
  ct_mesh *mesh[2] = {below, above};
  ct_surface surface[2];
  int32_t *faces[2];
  for (int s = 0; s < 2; s++) {
    int count = ct_mesh_outer_faces(mesh[s], NULL, NULL);
    faces[s] = integers(4 * count);
    ct_mesh_outer_faces(mesh[s], faces[s], NULL);
    surface[s] = (ct_surface){CT_Q4, mesh[s]->node_count, count, faces[s], mesh[s]->nodes};
  }
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 1.0;
  ct_contact *contact = NULL;
  must(ct_contact_create, &surface[0], &surface[1], &options, &contact);
  later_contact(contact);
  double *x = numbers(3 * above->node_count), height = 20.25 + 0.3 * contact->fixed->gaps.approach;
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *now = room(count, sizeof *now), *before = room(count, sizeof *before);
  int wrong = 0, inside = 0, unseen = 0;
  for (; height > -1.2; height -= contact->fixed->gaps.approach) {
    for (int n = 0; n < above->node_count; n++)
      for (int c = 0; c < 3; c++) x[3 * n + c] = above->nodes[3 * n + c] + (c == 2 ? height : 0.0);
    must(ct_contact_update, contact, below->nodes, x);
    ct_contact_points(contact, now, NULL);
    for (int64_t i = 0; i < count; i++) {
      int facing = fabs(now[i].position[2] - (now[i].side == 1 ? height : 0.0)) < 1e-9 &&
                   now[i].position[0] > 7.5 && now[i].position[0] < 46.5 &&
                   now[i].position[1] > 3.5 && now[i].position[1] < 8.5;
      if (!facing || height >= 0.0) continue;
      inside++;
      unseen += before[i].other < 0;
      wrong += fabs(now[i].gap - height) > 1e-12;
    }
    memcpy(before, now, (size_t)count * sizeof *now);
  }
  tap_ok(inside > 50 && unseen == 0 && wrong == 0,
         "steps of %g, as large as allowed: %d points came in, %d of them undetected, %d with a "
         "wrong gap",
         contact->fixed->gaps.approach, inside, unseen, wrong);
}

/* How far surfaces may come nearer in a step: the width of the narrowest face, which is its area
 * over the longest edge and of a triangle twice that, or three quarters of the thinnest place
 * (eq:contact-near); and a step of the surfaces' velocities is refused from there on
 * (eq:tunnelling). */
static void safe_approach(void)
{
  static const double low[3] = {0, 0, 0}, far[3] = {0, 0, 5}, size[3] = {4, 2, 9},
                      thin[3] = {4, 2, 0.4};
  static const int cells[3] = {2, 4, 4}, flat[3] = {2, 4, 1};
  static const char *const name[] = {"thick boxes", "a thin box", "triangles"};
  static const double want[] = {0.5, 0.3, 0.0};
  for (int k = 0; k < 3; k++) {
    patch a = k == 2 ? new_patch(CT_T3, 2, 2, 0, 0, 2, 2, 1)
                     : new_box(low, k ? thin : size, k ? flat : cells),
          b = k == 2 ? new_patch(CT_T3, 2, 2, 0, 0, 2, 2, 0) : new_box(far, size, cells);
    if (k == 2) lift(&b, 5.0);
    ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_GAUSS));
    update(contact, &a, &b);
    double approach = contact->fixed->gaps.approach, expected = want[k];
    if (k == 2) expected = 1.0 / sqrt(2.0); // legs of 1: area ½, longest edge √2
    tap_close(approach, expected, 1e-12, "%s: the largest safe approach", name[k]);
  }
  patch a = new_patch(CT_Q4, 2, 2, 0, 0, 2, 2, 1), b = new_patch(CT_Q4, 2, 2, 0, 0, 2, 2, 0);
  lift(&b, 0.1);
  ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_GAUSS));
  update(contact, &a, &b);
  // The nodes of the second surface follow those of the first.
  double *v = numbers(3 * contact->fixed->is.node_count);
  for (int n = 0; n < contact->fixed->is.node_count; n++)
    v[3 * n + 2] = n < contact->fixed->gaps.side[0].search->node_count ? 3.0 : -2.0;
  const double limit = contact->fixed->gaps.approach / 5.0;
  ct_error e;
  tap_ok(ct_tunnelling_check(&contact->gaps, v, 0.999 * limit, 0.0, &e) == CT_OK &&
             ct_tunnelling_check(&contact->gaps, v, 1.001 * limit, 0.0, &e) == CT_ERROR_STEP,
         "a larger approach in a step is refused");
}

/* The centre of a quadratic face moves three times as far as its nodes if corners and mid-sides
 * move apart. So it comes within the search distance 1 of a point that was clear of it by more than
 * the motion of any node (eq:gap-bound, eq:clear-distance). */
static void stretches(void)
{
  patch a = new_patch(CT_Q8, 1, 1, 0, 0, 1, 1, 1), b = new_patch(CT_Q8, 1, 1, 0, 0, 1, 1, 0);
  ct_contact_point point[18];
  lift(&b, 1.2);
  ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_GAUSS));
  for (int i = 0; i < 2; i++) update(contact, &a, &b);
  ct_contact_points(contact, point, NULL);
  tap_ok(point[4].other < 0 && point[13].other < 0, "centres beyond the search distance");
  for (int n = 0; n < 9; n++)
    b.x[3 * n + 2] += b.x[3 * n] == 0.5 || b.x[3 * n + 1] == 0.5 ? -0.12 : 0.12;
  update(contact, &a, &b);
  ct_contact_points(contact, point, NULL);
  for (int i = 4; i < 18; i += 9)
    tap_close(point[i].gap, 1.2 - 3.0 * 0.12, 1e-12, "centre of side %d within it", i / 9);
}

/* Two blocks with the same outline press on each other and slide slightly, so that points of side
 * walls come beside the other block: two queries at one position must have the same result. */
static void asked_twice(void)
{
  const double low_a[3] = {0, 0, 0}, low_b[3] = {0, 0, 1.0 - 2e-3}, size[3] = {1, 1, 1};
  const int cells[3] = {2, 2, 1};
  double off = 0.0;
  int touched = 0;
  for (int trial = 0; trial < 20; trial++) {
    patch a = new_box(low_a, size, cells), b = new_box(low_b, size, cells);
    ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_LOBATTO));
    for (int step = 0; step < 40; step++) {
      shift(&b, uniform(2e-3), uniform(2e-3), uniform(1e-3));
      update(contact, &a, &b);
      double energy = ct_contact_energy(contact);
      update(contact, &a, &b);
      if (energy > 0.0) off = worst(off, ct_contact_energy(contact) / energy - 1.0), touched++;
    }
  }
  tap_ok(touched > 200 && off < 1e-14,
         "a repeated query gives the same energy (%d times, off by %.2g at most)", touched, off);
}

/* A box slides on a slope whose points its side reaches first: the slope begins at the height of
 * its bottom, so a point belongs to the bottom as soon as it is inside, and its force is normal to
 * that (eq:beside-edge). A step of the same height has no such slope: there the side takes the
 * point. */
static void beside_an_edge(int slope)
{
  const double low[3] = {0, 0, 0}, size[3] = {1.2, 1, 1};
  const int cells[3] = {1, 1, 1};
  patch a = new_patch(CT_Q4, 2, 1, 0, 0, 2, 1, 1), b = new_box(low, size, cells);
  ct_contact *contact = open_contact(&a, &b, with_points(CT_POINTS_GAUSS));
  ct_contact_point point[64];
  double sideways = 0.0, upwards = 0.0;
  lift(&a, 0.01);
  for (int n = 0; n < 6; n++)
    if (slope) a.x[3 * n + 2] = a.x[3 * n] > 1.5 ? 0.05 : 0.0;
  for (int i = 0; i < 20; i++) {
    update(contact, &a, &b);
    shift(&b, 0.001, 0, 0);
    // Points 0 and 2 of the second face at x = 1.211
    ct_contact_points(contact, point, NULL);
    for (int k = 4; k < 8; k++) {
      if (!(point[k].gap < 0.0)) continue;
      sideways = worst(sideways, point[k].closest[0] - point[k].position[0]);
      upwards = worst(upwards, point[k].closest[2] - point[k].position[2]);
    }
  }
  tap_ok(slope ? upwards > 0.01 && sideways < 1e-12 : upwards < 1e-12 && sideways > 0.005,
         "a point beside the edge of a box, on a %s: pushed down %.2g, sideways %.2g",
         slope ? "slope" : "step", upwards, sideways);
}

int main(void)
{
  free_at_end();
  local_search();
  seen_before_it_comes_in();
  for (int kind = 0; kind < 4; kind++) {
    held((ct_face_kind)kind);
    lobatto((ct_face_kind)kind);
    patch_test((ct_face_kind)kind);
    lobatto_gradient((ct_face_kind)kind);
  }
  buried();
  thin_plates();
  corners_and_edges();
  sliding(CT_Q4);
  sliding(CT_T3);
  open_border();
  closed_border();
  ratios();
  safe_approach();
  stretches();
  asked_twice();
  beside_an_edge(1);
  beside_an_edge(0);
  return tap_done();
}
