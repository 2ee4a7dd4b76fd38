/* Contact of two surfaces: forces against the energy, conservation, closed forms, folds and
 * borders, the bound on the step. */
#include "patches.h"
#include "springs.h"

#include <float.h>

/* Two warped patches that do not match, the upper one turned by 0.3, tilted and partly inside the
 * lower one. */
static void warped_pair(ct_face_kind ka, ct_face_kind kb, patch *a, patch *b)
{
  *a = new_patch(ka, 3, 2, -1, -1, 2, 2, 1);
  *b = new_patch(kb, 2, 2, -0.5, -0.5, 1, 1, 0);
  for (int n = 0; n < a->surface.node_count; n++) {
    double *x = &a->x[3 * n];
    x[2] = 0.05 * sin(2.0 * x[0] + 1.0) * cos(1.5 * x[1]) + uniform(0.01);
    x[0] += uniform(0.03);
    x[1] += uniform(0.03);
  }
  for (int n = 0; n < b->surface.node_count; n++) {
    double *x = &b->x[3 * n], s = x[0], t = x[1];
    x[0] = 0.955 * s - 0.296 * t + uniform(0.02);
    x[1] = 0.296 * s + 0.955 * t + uniform(0.02);
    x[2] = 0.03 * s - 0.02 * t + 0.02 * s * t + uniform(0.015);
  }
}

/* eq:contact-potential, eq:contact-force, eq:gap, eq:gap-variation. */
static void force_is_gradient(ct_face_kind ka, ct_face_kind kb)
{
  patch a, b;
  warped_pair(ka, kb, &a, &b);
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  double *fa = numbers(3 * a.surface.node_count), *fb = numbers(3 * b.surface.node_count),
         off = 0.0, top, h = 1e-6;
  update(contact, &a, &b);
  forces(contact, &a, &b, fa, fb);
  int64_t points = ct_contact_point_count(contact);
  ct_contact_point *point = room(points, sizeof *point);
  int pressed[2] = {0, 0};
  ct_contact_points(contact, point, NULL);
  for (int i = 0; i < points; i++) pressed[point[i].side] += point[i].raw_pressure > 0.0;
  top = worst(largest(fa, 3 * a.surface.node_count), largest(fb, 3 * b.surface.node_count));
  for (int s = 0; s < 2; s++) {
    patch *p = s == 0 ? &a : &b;
    for (int i = 0; i < 3 * p->surface.node_count; i++) {
      double keep = p->x[i], up, down;
      p->x[i] = keep + h;
      update(contact, &a, &b);
      up = ct_contact_energy(contact);
      p->x[i] = keep - h;
      update(contact, &a, &b);
      down = ct_contact_energy(contact);
      p->x[i] = keep;
      off = worst(off, (s == 0 ? fa : fb)[i] + (up - down) / (2.0 * h));
    }
  }
  tap_ok(off < 1e-9 * top && pressed[0] > 3 && pressed[1] > 3,
         "%s on %s, warped (%d and %d points inside): force is minus the gradient of the energy, "
         "off by %.2g",
         KIND[kb], KIND[ka], pressed[0], pressed[1], off / top);

  // Linear and angular momentum: the forces of both sides and their moments cancel.
  double sum[3] = {0}, moment[3] = {0}, size = 0.0, arm = 0.0, fx[2][3], mx[2][3], resultant = 0.0;
  for (int s = 0; s < 2; s++) {
    const patch *p = s == 0 ? &a : &b;
    const double *f = s == 0 ? fa : fb;
    for (int n = 0; n < p->surface.node_count; n++)
      for (int c = 0; c < 3; c++) {
        sum[c] += f[3 * n + c];
        moment[c] += p->x[3 * n + (c + 1) % 3] * f[3 * n + (c + 2) % 3] -
                     p->x[3 * n + (c + 2) % 3] * f[3 * n + (c + 1) % 3];
        size += fabs(f[3 * n + c]);
        arm = worst(arm, p->x[3 * n + c]);
      }
  }
  tap_ok(largest(sum, 3) < 1e-13 * size, "%s on %s: linear momentum, %.2g of the forces", KIND[kb],
         KIND[ka], largest(sum, 3) / size);
  tap_ok(largest(moment, 3) < 1e-13 * size * arm, "%s on %s: angular momentum, %.2g", KIND[kb],
         KIND[ka], largest(moment, 3) / (size * arm));
  update(contact, &a, &b);
  ct_contact_resultant(contact, fx[0], mx[0], fx[1], mx[1], NULL);
  for (int c = 0; c < 3; c++) {
    resultant = worst(resultant, fx[0][c] - total(fa, a.surface.node_count, c));
    resultant = worst(resultant, fx[1][c] - total(fb, b.surface.node_count, c));
    resultant = worst(resultant, mx[0][c] + mx[1][c]);
  }
  tap_ok(resultant < 1e-13 * size,
         "%s on %s: the resultants are those of the nodal forces, off by %.2g", KIND[kb], KIND[ka],
         resultant / size);
}

/* Force of a point: half of ε w J_ref times the way to the closest point, where it is inside. */
static void force_of_point(const ct_contact_point *p, double F[3])
{
  for (int c = 0; c < 3; c++) {
    F[c] = 0.0;
    if (p->gap < 0.0) F[c] = 0.5 * EPSILON * p->weight * (p->closest[c] - p->position[c]);
  }
}

/* Add N_a F to the nodes of the face on which the point lies, at xi. */
static void spread_force(const double F[3], const ct_surface *s, int face, const double xi[2],
                         double *f)
{
  const int per = ct_face_node_count(s->kind);
  double N[8];
  ct_segment_shape(s->kind, xi, N);
  for (int a = 0; a < per; a++)
    for (int c = 0; c < 3; c++) f[3 * s->faces[face * per + a] + c] += N[a] * F[c];
}

/* The same, point by point and in this order, as the fast form of the library: it sums at many
 * points at once and in any order. (eq:contact-force) */
static void plain_form(ct_face_kind ka, ct_face_kind kb)
{
  patch a, b;
  warped_pair(ka, kb, &a, &b);
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  const ct_surface *surface[2] = {&a.surface, &b.surface};
  double *found[2], *plain[2], top = 0.0, off = 0.0;
  for (int s = 0; s < 2; s++) {
    found[s] = numbers(3 * surface[s]->node_count);
    plain[s] = numbers(3 * surface[s]->node_count);
  }
  update(contact, &a, &b);
  forces(contact, &a, &b, found[0], found[1]);
  const int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  ct_contact_points(contact, point, NULL);
  for (int64_t i = 0; i < count; i++) {
    const ct_contact_point *p = &point[i];
    const int own = p->side, other = 1 - own;
    ct_rule rule;
    double F[3], against[3];
    if (p->other < 0) continue;
    ct_rule_face(surface[own]->kind, &rule, NULL);
    force_of_point(p, F);
    for (int c = 0; c < 3; c++) against[c] = -F[c];
    spread_force(F, surface[own], p->face, rule.xi[p->point], plain[own]);
    spread_force(against, surface[other], p->other, p->xi, plain[other]);
  }
  for (int s = 0; s < 2; s++)
    for (int i = 0; i < 3 * surface[s]->node_count; i++) {
      top = worst(top, plain[s][i]);
      off = worst(off, found[s][i] - plain[s][i]);
    }
  tap_ok(top > 0.0 && off < 1e-13 * top, "%s on %s: the plain form of the forces, off by %.2g",
         KIND[kb], KIND[ka], off / top);
}

/* Forces of the pass of b on nodes of the flat patch a, n x n cells over 1 by 0.75: half of
 * pressure times weight times shape function, summed over the Gauss points of b. The cell of a
 * point follows from its coordinates. */
static void add_pass_of_b(const patch *a, int n, const patch *b, double pressure, double *f)
{
  ct_rule rule;
  ct_rule_face(b->surface.kind, &rule, NULL);
  int triangle = a->surface.kind == CT_T3 || a->surface.kind == CT_T6,
      per = ct_face_node_count(b->surface.kind), own = ct_face_node_count(a->surface.kind);
  for (int i = 0; i < b->surface.face_count * rule.count; i++) {
    ct_face face = {.kind = b->surface.kind};
    double y[3], N[8];
    for (int k = 0; k < per; k++)
      memcpy(face.node[k], &b->x[3 * b->faces[i / rule.count * per + k]], sizeof face.node[k]);
    ct_segment_point(&face, rule.xi[i % rule.count], y);
    double s = y[0] * n, t = y[1] / 0.75 * n, u = s - floor(s), v = t - floor(t);
    int cell = (int)t * n + (int)s, upper = u + v > 1.0;
    double lower[2] = {u, v}, beyond[2] = {1.0 - u, 1.0 - v},
           square[2] = {2.0 * u - 1.0, 2.0 * v - 1.0};
    ct_segment_shape(a->surface.kind, !triangle ? square : upper ? beyond : lower, N);
    double area =
        rule.weight[i % rule.count] * ct_segment_area_element(&face, rule.xi[i % rule.count]);
    for (int k = 0; k < own; k++)
      f[a->faces[(triangle ? 2 * cell + upper : cell) * own + k]] -= 0.5 * pressure * area * N[k];
  }
}

/* Two squares of area 0.75, pressed into each other by delta: force eps delta A, energy eps delta^2
 * A / 2, on any meshes. (eq:contact-potential, eq:contact-force) */
static void flat_overlap(ct_face_kind ka, ct_face_kind kb, int na, int nb)
{
  patch a = new_patch(ka, na, na, 0, 0, 1, 0.75, 1), b = new_patch(kb, nb, nb, 0, 0, 1, 0.75, 0);
  double delta = 0.01, *fa = numbers(3 * a.surface.node_count),
         *fb = numbers(3 * b.surface.node_count);
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = -delta;
  ct_contact *contact = updated_contact(&a, &b);
  forces(contact, &a, &b, fa, fb);
  double want = EPSILON * delta * 0.75, nodal = 0.0;
  tap_ok(fabs(total(fa, a.surface.node_count, 2) / want + 1.0) < 1e-13 &&
             fabs(total(fb, b.surface.node_count, 2) / want - 1.0) < 1e-13,
         "%s %d on %s %d, flat: total force eps delta A, off by %.2g", KIND[kb], nb, KIND[ka], na,
         fabs(total(fb, b.surface.node_count, 2) / want - 1.0));
  tap_close(ct_contact_energy(contact) / (0.5 * want * delta), 1.0, 1e-13,
            "%s %d on %s %d, flat: energy eps delta^2 A / 2", KIND[kb], nb, KIND[ka], na);

  // Nodal forces of a uniform pressure are the integrals of the shape functions; matching meshes
  // give them exactly.
  double *uniform_force = numbers(a.surface.node_count);
  for (int f = 0; f < a.surface.face_count; f++) {
    static const double share[4][8] = {
        {0.25, 0.25, 0.25, 0.25},
        {-1.0 / 12, -1.0 / 12, -1.0 / 12, -1.0 / 12, 1.0 / 3, 1.0 / 3, 1.0 / 3, 1.0 / 3},
        {1.0 / 3, 1.0 / 3, 1.0 / 3},
        {0, 0, 0, 1.0 / 3, 1.0 / 3, 1.0 / 3}};
    int per = ct_face_node_count(ka);
    for (int i = 0; i < per; i++)
      uniform_force[a.faces[f * per + i]] -= want / a.surface.face_count * share[ka][i];
  }
  for (int n = 0; n < a.surface.node_count; n++)
    nodal = worst(nodal, fa[3 * n + 2] - uniform_force[n]);
  nodal /= largest(uniform_force, a.surface.node_count);
  if (ka == kb && na == nb)
    tap_ok(nodal < 1e-13, "%s, matching meshes: nodal forces of a uniform pressure, off by %.2g",
           KIND[ka], nodal);
  else {
    double *by_hand = numbers(a.surface.node_count), off = 0.0;
    for (int n = 0; n < a.surface.node_count; n++) by_hand[n] = 0.5 * uniform_force[n];
    add_pass_of_b(&a, na, &b, EPSILON * delta, by_hand);
    for (int n = 0; n < a.surface.node_count; n++) off = worst(off, fa[3 * n + 2] - by_hand[n]);
    off /= largest(by_hand, a.surface.node_count);
    tap_ok(
        off < 1e-13 && nodal > 0.01,
        "%s %d on %s %d, unlike meshes: nodal forces are half those of a uniform pressure and half "
        "those of the other side's points, off by %.2g; so the patch test fails by %.2g",
        KIND[kb], nb, KIND[ka], na, off, nodal);
  }
}

/* One pair of Q8 faces: corners -1/12, mid-sides 1/3 of the force. */
static void one_q8(void)
{
  patch a = new_patch(CT_Q8, 1, 1, 0, 0, 2, 1, 1), b = new_patch(CT_Q8, 1, 1, 0, 0, 2, 1, 0);
  double fa[27], fb[27], off = 0.0;
  for (int n = 0; n < 9; n++) b.x[3 * n + 2] = -0.25;
  ct_contact *contact = updated_contact(&a, &b);
  forces(contact, &a, &b, fa, fb);
  for (int i = 0; i < 8; i++) {
    double want = EPSILON * 0.25 * 2.0 * (i < 4 ? -1.0 / 12.0 : 1.0 / 3.0);
    off =
        worst(worst(off, fa[3 * a.faces[i] + 2] / want + 1.0), fb[3 * b.faces[i] + 2] / want - 1.0);
  }
  tap_ok(off < 1e-13,
         "uniform pressure on a Q8 face: -1/12 at corners, 1/3 at mid-sides, off by %.2g", off);
}

/* The bound of one pair of Q8 faces of area 1 with masses 1: shape functions of both signs count by
 * their sizes, Σ k |b_i| Σ_j |b_j| of both passes (eq:contact-bound). */
static void bound_of_q8(void)
{
  patch a = new_patch(CT_Q8, 1, 1, 0, 0, 1, 1, 1), b = new_patch(CT_Q8, 1, 1, 0, 0, 1, 1, 0);
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = EPSILON;
  ct_contact *contact = open_contact(&a, &b, options);
  update(contact, &a, &b);
  double mass[9], row[8] = {0}, omega2;
  ct_rule rule;
  ct_error e;
  ct_rule_face(CT_Q8, &rule, NULL);
  for (int q = 0; q < rule.count; q++) {
    double N[8], sum = 0.0;
    ct_segment_shape(CT_Q8, rule.xi[q], N);
    for (int i = 0; i < 8; i++) sum += 2.0 * fabs(N[i]);
    for (int i = 0; i < 8; i++) row[i] += EPSILON * 0.25 * rule.weight[q] * fabs(N[i]) * sum;
  }
  for (int i = 0; i < 9; i++) mass[i] = 1.0;
  need(springs_of(contact, mass, mass, &omega2), &e);
  tap_close(omega2 / largest(row, 8), 1.0, 1e-12, "a pair of Q8 faces: the bound by hand");
}

/* The gap from far apart to far inside, in units of the face; at the first update there is no
 * contact beyond the depth (the face's diagonal). (eq:gap) */
static void gap_sweep(double h)
{
  static const double size[14] = {10,   3,    1.5,  1.41, 1,     0.1,   1e-2,
                                  1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0};
  patch a = new_patch(CT_Q4, 2, 2, 0, 0, 2 * h, 2 * h, 1),
        b = new_patch(CT_Q4, 2, 2, 0, 0, 2 * h, 2 * h, 0);
  ct_contact_point point[32];
  int wrong_pair = 0, wrong_force = 0;
  double gap = 0.0, energy = 0.0, *fa = numbers(75), *fb = numbers(75);
  for (int i = 0; i < 28; i++) {
    double g = (i < 14 ? -size[i] : size[27 - i]) * h, A = 4.0 * h * h;
    ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
    for (int n = 0; n < 25; n++) b.x[3 * n + 2] = g;
    update(contact, &a, &b);
    forces(contact, &a, &b, fa, fb);
    ct_contact_points(contact, point, NULL);
    int near = fabs(g) < sqrt(2.0) * h, pressed = near && g < 0.0;
    for (int k = 0; k < 32; k++) {
      wrong_pair += (point[k].other >= 0) != near || isnan(point[k].gap) == near;
      if (near) gap = worst(gap, fabs(g) > 0.0 ? point[k].gap / g - 1.0 : point[k].gap);
    }
    energy = worst(energy, pressed ? ct_contact_energy(contact) / (0.5 * EPSILON * g * g * A) - 1.0
                                   : ct_contact_energy(contact));
    double want = pressed ? -EPSILON * g * A : 0.0, got = total(fb, 25, 2);
    wrong_force += pressed ? !(fabs(got / want - 1.0) < 1e-12)
                           : !(largest(fa, 75) == 0.0 && largest(fb, 75) == 0.0);
  }
  tap_ok(wrong_pair == 0,
         "gap from -10 to 10 faces of %g: points have a partner within the depth and only there "
         "(%d wrong)",
         h, wrong_pair);
  tap_ok(gap < 1e-12, "the gap of each point is the given one, off by %.2g", gap);
  tap_ok(energy < 1e-12 && wrong_force == 0,
         "energy and force are those of the gap, exactly none when apart (off by %.2g, %d wrong)",
         energy, wrong_force);
}

/* A plate of thickness 0.1, closed all around, and a patch that is pressed into its top: no force
 * may act on the plate's far side. (eq:far-side) */
static void far_side(double inside)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 0.1, 4, 4, 1);
  int32_t *outer = integers(4 * 6 * m->element_count);
  patch a = {
      {CT_Q4, m->node_count, ct_mesh_outer_faces(m, outer, NULL), outer, m->nodes}, NULL, m->nodes};
  patch b = new_patch(CT_Q4, 2, 2, 0.3, 0.3, 0.4, 0.4, 0);
  for (int n = 0; n < 25; n++) b.x[3 * n + 2] = 0.1 - inside;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  double *fa = numbers(3 * m->node_count), fb[75], bottom = 0.0,
         slave = EPSILON * inside * 0.16 * 0.5;
  update(contact, &a, &b);
  forces(contact, &a, &b, fa, fb);
  for (int n = 0; n < m->node_count; n++)
    if (m->nodes[3 * n + 2] == 0.0) bottom = worst(bottom, largest(&fa[3 * n], 3));
  // The patch's own points give half of eps g A; the plate's points above the patch, the other
  // half, depend on where they lie.
  tap_ok(
      bottom == 0.0 && total(fb, 25, 2) >= slave * (1.0 - 1e-12),
      "a patch %g inside the top of a closed plate: no force on its bottom, %.3g >= %.3g upwards",
      inside, total(fb, 25, 2), slave);

  // From below, facing up: the bottom is pressed and the top is left alone.
  patch up = new_patch(CT_Q4, 2, 2, 0.3, 0.3, 0.4, 0.4, 1);
  for (int n = 0; n < 25; n++) up.x[3 * n + 2] = inside;
  ct_contact *below = open_contact(&a, &up, ct_contact_options_default());
  double top = 0.0;
  update(below, &a, &up);
  forces(below, &a, &up, fa, fb);
  for (int n = 0; n < m->node_count; n++)
    if (m->nodes[3 * n + 2] != 0.0) top = worst(top, largest(&fa[3 * n], 3));
  tap_ok(top == 0.0 && total(fb, 25, 2) <= -slave * (1.0 - 1e-12),
         "the same from below: no force on its top");

  // Above the top and facing up, back to back with the plate: both normals agree, so there is
  // nothing to press on.
  for (int n = 0; n < 25; n++) up.x[3 * n + 2] = 0.1 - inside;
  update(below, &a, &up);
  ct_contact_point *point = room(ct_contact_point_count(below), sizeof *point);
  int same_way = 0;
  ct_contact_points(below, point, NULL);
  for (int i = 0; i < ct_contact_point_count(below); i++)
    same_way += point[i].raw_pressure > 0.0 && point[i].side == 1 && point[i].closest[2] > 0.05;
  tap_ok(same_way == 0,
         "a patch that points in the same direction as the top has no contact force");
}

/* A point beyond the border of the other surface is not in contact; the others are, with full
 * weight. */
static void border(void)
{
  patch a = new_patch(CT_Q4, 4, 4, 0, 0, 1, 1, 1), b = new_patch(CT_Q4, 5, 3, 0.37, -0.41, 1, 1, 0);
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = -0.01;
  ct_contact *contact = updated_contact(&a, &b);
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  int wrong = 0, in = 0;
  ct_contact_points(contact, point, NULL);
  for (int i = 0; i < count; i++) {
    double x = point[i].position[0], y = point[i].position[1];
    int over = point[i].side == 1 ? x < 1.0 && y > 0.0 : x > 0.37 && y < 0.59;
    in += over;
    wrong += over ? !(fabs(point[i].gap + 0.01) < 1e-15)
                  : point[i].other != -1 || point[i].raw_pressure != 0.0;
  }
  tap_ok(wrong == 0 && in > 20 && in < count,
         "%d of %d points lie over the other surface: they are in contact, the others are not (%d "
         "wrong)",
         in, (int)count, wrong);
}

/* Distance of a point from z = z0 + c (|x| + q |y|), four quarter planes: the closest point on
 * each, or on its two edges. */
static double roof_distance(double z0, double c, double q, const double p[3], double closest[3])
{
  double best = INFINITY;
  for (int k = 0; k < 4; k++) {
    double sx = k & 1 ? 1 : -1, sy = k & 2 ? 1 : -1, y[3] = {p[0], p[1], p[2] - z0},
           n[3] = {-sx * c, -sy * c * q, 1.0};
    double height = (n[0] * y[0] + n[1] * y[1] + n[2] * y[2]) / (n[0] * n[0] + n[1] * n[1] + 1.0),
           at[3][3];
    const double edge[2][3] = {{sx, 0, c}, {0, sy, c * q}};
    for (int i = 0; i < 3; i++) at[0][i] = y[i] - height * n[i];
    for (int j = 0; j < 2; j++) {
      double t = (edge[j][0] * y[0] + edge[j][1] * y[1] + edge[j][2] * y[2]) /
                 (edge[j][0] * edge[j][0] + edge[j][1] * edge[j][1] + edge[j][2] * edge[j][2]);
      for (int i = 0; i < 3; i++) at[1 + j][i] = fmax(t, 0.0) * edge[j][i];
    }
    for (int j = 0; j < 3; j++) {
      double d =
          sqrt((at[j][0] - y[0]) * (at[j][0] - y[0]) + (at[j][1] - y[1]) * (at[j][1] - y[1]) +
               (at[j][2] - y[2]) * (at[j][2] - y[2]));
      if (j == 0 && (sx * at[0][0] < 0.0 || sy * at[0][1] < 0.0)) continue;
      if (d >= best) continue;
      best = d;
      for (int i = 0; i < 3; i++) closest[i] = at[j][i] + (i == 2 ? z0 : 0.0);
    }
  }
  return best;
}

/* Two folded surfaces, z = c (|x| + q |y|) below and z = z0 + C (|x| + q |y|) above: every point
 * that is inside the other body must meet it once, at the distance of the exact surface, whether
 * its closest point lies on a face, an edge or the corner. (eq:pseudo-normal, eq:gap) */
static void fold(double c, double C, double z0, double q, const char *what)
{
  patch a = new_patch(CT_Q4, 8, 8, -1, -1, 2, 2, 1),
        b = new_patch(CT_Q4, 10, 6, -0.6, -0.6, 1.2, 1.2, 0);
  for (int n = 0; n < a.surface.node_count; n++)
    a.x[3 * n + 2] = c * (fabs(a.x[3 * n]) + q * fabs(a.x[3 * n + 1]));
  for (int n = 0; n < b.surface.node_count; n++)
    b.x[3 * n + 2] = z0 + C * (fabs(b.x[3 * n]) + q * fabs(b.x[3 * n + 1]));
  ct_contact *contact = updated_contact(&a, &b);
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  int lost = 0, inside = 0, on_edge = 0, invented = 0;
  double off = 0.0, energy = 0.0;
  ct_contact_points(contact, point, NULL);
  for (int i = 0; i < count; i++) {
    const double *p = point[i].position;
    double r = fabs(p[0]) + q * fabs(p[1]), closest[3] = {0};
    int above = point[i].side == 1, in = above ? p[2] < c * r : p[2] > z0 + C * r;
    double d = above ? roof_distance(0.0, c, q, p, closest) : roof_distance(z0, C, q, p, closest),
           edge = above ? 1.0 : 0.6;
    if (fabs(closest[0]) > edge - 1e-9 || fabs(closest[1]) > edge - 1e-9)
      in = 0; // beyond the border
    if (!in) {
      invented += point[i].raw_pressure != 0.0;
      continue;
    }
    inside++;
    on_edge += fabs(closest[0]) < 1e-9 || (q > 0.0 && fabs(closest[1]) < 1e-9);
    lost += !(point[i].gap < 0.0);
    off = worst(off, point[i].gap + d);
    energy += 0.25 * EPSILON * d * d * point[i].weight;
  }
  tap_ok(lost == 0 && invented == 0 && inside > 10 && off < 1e-12,
         "%s: %d points inside, %d with the closest point on an edge or corner, %d lost, %d "
         "invented, gap "
         "off by %.2g",
         what, inside, on_edge, lost, invented, off);
  tap_close(ct_contact_energy(contact) / energy, 1.0, 1e-12,
            "%s: the energy counts each of them once", what);
}

/* The bound of the contact's omega^2 against the largest eigenvalue of its own stiffness, by
 * differences of forces. (eq:contact-stiffness, eq:contact-bound) */
static void frequency_bound(ct_face_kind ka, ct_face_kind kb)
{
  patch a, b;
  warped_pair(ka, kb, &a, &b);
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] -= 0.1; // all points active
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  int na = a.surface.node_count, n = na + b.surface.node_count, dofs = 3 * n;
  double *K = numbers((int64_t)dofs * dofs), *mass = numbers(n), *up = numbers(dofs),
         *down = numbers(dofs), h = 1e-6, bound;
  for (int i = 0; i < n; i++) mass[i] = exp(uniform(1.0));
  for (int j = 0; j < dofs; j++) {
    double *x = j < 3 * na ? &a.x[j] : &b.x[j - 3 * na], keep = *x;
    *x = keep + h;
    update(contact, &a, &b);
    forces(contact, &a, &b, up, up + 3 * na);
    *x = keep - h;
    update(contact, &a, &b);
    forces(contact, &a, &b, down, down + 3 * na);
    *x = keep;
    for (int i = 0; i < dofs; i++) K[(int64_t)i * dofs + j] = (down[i] - up[i]) / (2.0 * h);
  }
  update(contact, &a, &b);
  double skew = 0.0, top = largest(K, (int64_t)dofs * dofs);
  for (int i = 0; i < dofs; i++)
    for (int j = 0; j < dofs; j++)
      skew = worst(skew, K[(int64_t)i * dofs + j] - K[(int64_t)j * dofs + i]);
  // Power iteration on M^-1 K + bound, whose largest eigenvalue belongs to the largest positive one
  // of M^-1 K.
  ct_status status = springs_of(contact, mass, mass + na, &bound);
  double value = 0.0, *v = numbers(dofs), *w = numbers(dofs);
  for (int i = 0; i < dofs; i++) v[i] = uniform(1.0);
  for (int k = 0; k < 2000; k++) {
    double work = 0.0, kinetic = 0.0, size = largest(v, dofs);
    for (int i = 0; i < dofs; i++) v[i] /= size;
    for (int i = 0; i < dofs; i++) {
      w[i] = 0.0;
      for (int j = 0; j < dofs; j++)
        w[i] += 0.5 * (K[(int64_t)i * dofs + j] + K[(int64_t)j * dofs + i]) * v[j];
      work += v[i] * w[i];
      kinetic += mass[i / 3] * v[i] * v[i];
    }
    for (int i = 0; i < dofs; i++) v[i] = w[i] / mass[i / 3] + bound * v[i];
    value = work / kinetic;
  }
  tap_ok(skew < 1e-8 * top, "%s on %s: the stiffness is symmetric, off by %.2g", KIND[kb], KIND[ka],
         skew / top);
  tap_ok(status == CT_OK && bound >= value * (1.0 - 1e-6) && bound < 10.0 * value,
         "%s on %s: bound of omega^2 is %.3f of the true largest eigenvalue", KIND[kb], KIND[ka],
         bound / value);
}

/* Two equal Q4 squares: the uniform mode is the highest, omega^2 = eps A / 2 m, and the bound is
 * sharp, near or far apart. (eq:contact-bound) */
static void sharp_bound(void)
{
  patch a = new_patch(CT_Q4, 1, 1, 0, 0, 1, 1, 1), b = new_patch(CT_Q4, 1, 1, 0, 0, 1, 1, 0);
  double mass[9] = {2, 2, 2, 2, 2, 2, 2, 2, 2}, bound = 0.0, dt = 0.0;
  for (int n = 0; n < 9; n++) b.x[3 * n + 2] = 0.125;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  ct_status status = springs_of(contact, mass, mass, &bound);
  tap_ok(status == CT_OK && fabs(bound / (EPSILON / 4.0) - 1.0) < 1e-13,
         "two squares before the first update: omega^2 = eps A / 2 m");
  for (int n = 0; n < 9; n++) b.x[3 * n + 2] = 50.0;
  update(contact, &a, &b);
  status = springs_of(contact, mass, mass, &bound);
  tap_ok(status == CT_OK && fabs(bound / (EPSILON / 4.0) - 1.0) < 1e-13,
         "fifty faces apart: the same bound");
  tap_ok(ct_contact_update_stable_step(contact, mass, mass, &dt, NULL) == CT_OK &&
             fabs(dt * sqrt(bound) - 2.0) < 1e-13,
         "the stable step of updates is 2 / omega");
  tap_ok(ct_contact_stable_step(contact, mass, mass, &dt, NULL) == CT_OK && dt == INFINITY,
         "steps with the default law have no limit");
  mass[0] = 0.0;
  tap_ok(springs_of(contact, mass, mass, &bound) == CT_ERROR_ARGUMENT &&
             ct_contact_stable_step(contact, mass, mass, &dt, NULL) == CT_ERROR_ARGUMENT,
         "a node without mass is refused");
}

/* Points at exactly the same distance from two faces with a common edge: the bound must use one
 * face and its shape functions. */
static void bound_on_ties(void)
{
  patch a = new_patch(CT_Q4, 4, 1, -2, -0.5, 4, 1, 1),
        b = new_patch(CT_Q4, 1, 1, -0.5, -0.5, 1, 1, 0),
        swapped = new_patch(CT_Q4, 4, 1, -2, -0.5, 4, 1, 1);
  int32_t order[4] = {0, 2, 1, 3};
  double mass_a[27], mass_b[9], bound[2];
  for (int n = 0; n < 9; n++) {
    // The upper face stands upright over the edge x = 0, so all its points see that edge.
    double x = b.x[3 * n];
    b.x[3 * n] = 0.0;
    b.x[3 * n + 2] = 0.6 + x;
    mass_b[n] = 1.0;
  }
  for (int n = 0; n < 27; n++)
    mass_a[n] = a.x[3 * n] < -1.5 || a.x[3 * n] > 1.5 || fabs(a.x[3 * n]) < 0.1 ? 1.0 : 1e-4;
  for (int f = 0; f < 4; f++)
    memcpy(&swapped.faces[4 * f], &a.faces[4 * order[f]], 4 * sizeof(int32_t));
  for (int k = 0; k < 2; k++) {
    ct_contact *contact = open_contact(k == 0 ? &a : &swapped, &b, ct_contact_options_default());
    ct_error e = {0};
    need(springs_of(contact, mass_a, mass_b, &bound[k]), &e);
  }
  tap_close(
      bound[1] / bound[0], 1.0, 1e-12,
      "points over an edge between two faces: the bound does not depend on the order of the faces");
}

/* Critical Courant number of two equal bars, and of a bar on a wall, with the penalty beta E A / h.
 * (eq:penalty-factor, eq:contact-bound) */
static void bars(double beta, int wall)
{
  const double h = 0.5;
  ct_material m = {4.0, 0.0, 1.0, CT_LINEAR};
  ct_scene *scene = new_scene();
  ct_mesh *left = box_mesh(CT_HEX8, -20 * h, 0, 0, 20 * h, 2, 2, 20, 1, 1),
          *right = box_mesh(CT_HEX8, 0, 0, 0, 20 * h, 2, 2, 20, 1, 1);
  int32_t a = add_body(scene, "left", left, &m, CT_KERNEL_AUTO, 0, 0, 0),
          b = add_body(scene, "right", right, &m, CT_KERNEL_AUTO, 0, 0, 0);
  add_contact(scene, a, left, 0.0, b, right, 0.0, 0, beta);
  if (wall) add_support(scene, b, right, -1, 0.0, "xyz", 0.0);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 1.0}, &steps, &stable);
  double *u = numbers(3 * p->node_count);
  for (int n = 0; n < p->node_count; n++)
    u[3 * n] = n < p->node_count / 2 ? 1e-3 : 0.0; // pressed, so that the springs act
  double omega = sqrt(true_frequency(p, u, 1e-6, 0, 3000)),
         courant = 2.0 / omega / stable.dt_courant;
  double b2 = wall ? beta * beta : 4.0 * beta * beta, want = sqrt(2.0 / (1.0 + sqrt(1.0 + b2)));
  tap_close(courant, want, 1e-10 * want, "%s, beta = %g: critical Courant number",
            wall ? "bar on a wall" : "two equal bars", beta);
  tap_close(stable.dt / stable.dt_courant, 1.0 / sqrt(1.0 + beta), 1e-11,
            "%s, beta = %g: reported 1 / sqrt(1 + beta), %.3f of the true one",
            wall ? "bar on a wall" : "two equal bars", beta,
            stable.dt / stable.dt_courant / courant);
  tap_ok(stable.dt <= 2.0 / omega, "the reported step is below the true limit");
}

/* A million faces from the origin the forces are the same to 1e-9: coordinates are multiples of
 * 2^-30, so the shift is exact. */
static void translation(ct_face_kind kind)
{
  patch a, b;
  warped_pair(kind, kind, &a, &b);
  double shift[3] = {1048576.0, -2097152.0, 524288.0}, *f[2][2], energy[2], off = 0.0, top = 0.0;
  for (int k = 0; k < 2; k++) {
    for (int s = 0; s < 2; s++) {
      patch *p = s == 0 ? &a : &b;
      f[k][s] = numbers(3 * p->surface.node_count);
      for (int i = 0; i < 3 * p->surface.node_count; i++)
        p->x[i] = k == 0 ? floor(p->x[i] * 1073741824.0) / 1073741824.0 : p->x[i] + shift[i % 3];
    }
    ct_contact *contact = updated_contact(&a, &b);
    forces(contact, &a, &b, f[k][0], f[k][1]);
    energy[k] = ct_contact_energy(contact);
  }
  for (int s = 0; s < 2; s++) {
    int n = 3 * (s == 0 ? &a : &b)->surface.node_count;
    off = worst(off, largest_difference(f[0][s], f[1][s], n));
    top = worst(top, largest(f[0][s], n));
  }
  tap_ok(off < 1e-9 * top && fabs(energy[1] / energy[0] - 1.0) < 1e-9 && top > 0.0,
         "%s, moved by a million faces: forces off by %.2g", KIND[kind], off / top);
}

/* Forces of a pair, in one list: all of a, then all of b, then the energy. */
static double *all_forces(const patch *a, const patch *b, ct_contact_options options)
{
  int na = 3 * a->surface.node_count, nb = 3 * b->surface.node_count;
  double *f = numbers(na + nb + 1);
  ct_contact *contact = open_contact(a, b, options);
  update(contact, a, b);
  forces(contact, a, b, f, f + na);
  f[na + nb] = ct_contact_energy(contact);
  return f;
}

static void symmetries(ct_face_kind kind)
{
  patch a, b;
  warped_pair(kind, kind, &a, &b);
  int na = 3 * a.surface.node_count, nb = 3 * b.surface.node_count, faults = 0;
  ct_contact_options options = ct_contact_options_default();
  double *f = all_forces(&a, &b, options), *g = all_forces(&b, &a, options);
  tap_ok(memcmp(f, g + nb, (size_t)na * sizeof *f) == 0 &&
             memcmp(f + na, g, (size_t)nb * sizeof *f) == 0 && f[na + nb] == g[na + nb],
         "%s: the surfaces swapped, the same bits", KIND[kind]);

  options.threads = 2;
  g = all_forces(&a, &b, options);
  tap_ok(memcmp(f, g, (size_t)(na + nb + 1) * sizeof *f) == 0, "%s: two threads, the same bits",
         KIND[kind]);
  options.threads = 1;

  // Faces in another order: the sums do not depend on it.
  int per = ct_face_node_count(kind), count = a.surface.face_count;
  int32_t *order = integers(count * per), *keep = a.faces;
  for (int i = 0; i < count; i++)
    memcpy(&order[i * per], &keep[(count - 1 - i) * per], (size_t)per * sizeof *order);
  a.surface.faces = order;
  g = all_forces(&a, &b, options);
  tap_ok(memcmp(f, g, (size_t)(na + nb + 1) * sizeof *f) == 0,
         "%s: faces in the opposite order, the same bits", KIND[kind]);
  a.surface.faces = keep;

  // Lengths times 2^k: eps w J d grows as 2^3k, eps w J d^2 as 2^4k.
  for (int k = -20; k <= 20; k += 40) {
    for (int i = 0; i < na; i++) a.x[i] = ldexp(a.x[i], k);
    for (int i = 0; i < nb; i++) b.x[i] = ldexp(b.x[i], k);
    g = all_forces(&a, &b, options);
    for (int i = 0; i < na + nb + 1; i++)
      faults += !(g[i] == ldexp(f[i], i < na + nb ? 3 * k : 4 * k));
    for (int i = 0; i < na; i++) a.x[i] = ldexp(a.x[i], -k);
    for (int i = 0; i < nb; i++) b.x[i] = ldexp(b.x[i], -k);
  }
  tap_ok(faults == 0, "%s: lengths scaled by 2^-20 and 2^20 scale the bits (%d do not)", KIND[kind],
         faults);

  // Mirrored in x, y, z, with the faces listed the other way round: (xi, eta) -> (-xi, eta).
  static const int back4[8] = {1, 0, 3, 2, 4, 7, 6, 5};
  if (kind == CT_Q4 || kind == CT_Q8) {
    int64_t wrong = 0;
    for (int s = 0; s < 2; s++) {
      patch *p = s == 0 ? &a : &b;
      for (int i = 0; i < p->surface.face_count; i++) {
        int32_t old[8];
        memcpy(old, &p->faces[i * per], (size_t)per * sizeof *old);
        for (int j = 0; j < per; j++) p->faces[i * per + j] = old[back4[j]];
      }
    }
    for (int axis = 0; axis < 3; axis++) {
      for (int s = 0; s < 2; s++)
        for (int n = 0; n < (s == 0 ? na : nb) / 3; n++)
          (s == 0 ? &a : &b)->x[3 * n + axis] *= -1.0;
      g = all_forces(&a, &b, options);
      wrong += mirror_faults(f, g, (na + nb) / 3, axis) + !(f[na + nb] == g[na + nb]);
      for (int s = 0; s < 2; s++)
        for (int n = 0; n < (s == 0 ? na : nb) / 3; n++)
          (s == 0 ? &a : &b)->x[3 * n + axis] *= -1.0;
    }
    tap_ok(wrong == 0, "%s: mirrored in x, y and z, the mirrored bits (%d are not)", KIND[kind],
           (int)wrong);
  }
}

static ct_contact_point *all_points(const patch *a, const patch *b, ct_contact_options options,
                                    int64_t *count)
{
  ct_contact *contact = open_contact(a, b, options);
  update(contact, a, b);
  *count = ct_contact_point_count(contact);
  ct_contact_point *point = room(*count, sizeof *point);
  ct_contact_points(contact, point, NULL);
  return point;
}

/* Newton and the simplex do not know borders, so they may miss a closest point on an edge between
 * two faces; they must find all other points. */
static void methods(ct_face_kind kind)
{
  patch a, b;
  int64_t count;
  warped_pair(kind, kind, &a, &b);
  ct_contact_options options = ct_contact_options_default();
  ct_contact_point *want = all_points(&a, &b, options, &count);
  for (int k = 0; k < 2; k++) {
    int differ = 0, edge = 0, pressed = 0;
    double off = 0.0;
    options.method = k == 0 ? CT_NEWTON : CT_SIMPLEX;
    ct_contact_point *got = all_points(&a, &b, options, &count);
    for (int64_t i = 0; i < count; i++) {
      double r = want[i].xi[0], s = want[i].xi[1];
      int square = kind == CT_Q4 || kind == CT_Q8,
          on_edge = want[i].other >= 0 && (square ? fabs(r) > 1 - 1e-6 || fabs(s) > 1 - 1e-6
                                                  : r < 1e-6 || s < 1e-6 || r + s > 1 - 1e-6);
      edge += on_edge;
      if (on_edge || want[i].other < 0) continue;
      pressed += want[i].raw_pressure > 0.0;
      differ += got[i].other != want[i].other;
      off = worst(off, got[i].gap - want[i].gap);
    }
    tap_ok(differ == 0 && off < 1e-13 && pressed > 10,
           "%s, warped: %s finds the %d pressed points of the robust search, gaps off by %.2g (%d "
           "others on edges)",
           KIND[kind], k == 0 ? "Newton" : "the simplex", pressed, off, edge);
  }
}

/* A face between a floor and a ceiling of one surface: as it rises, its points go from the floor to
 * the ceiling, each when that is nearer, though their closest points on the floor stay inside it.
 * The same for a face that slides from one cell to the next. (eq:closest-face, eq:warm-lanes) */
static void between(ct_face_kind kind)
{
  patch a = new_patch(kind, 3, 1, 0, 0, 3, 1, 1), b = new_patch(kind, 1, 1, 0.1, 0.1, 0.8, 0.8, 1);
  int per = ct_face_node_count(kind), wrong = 0, floor = 0, ceiling = 0;
  memcpy(&a.faces[per], &a.faces[2 * per], (size_t)per * sizeof *a.faces);
  a.surface.face_count = 2;
  for (int n = 0; n < a.surface.node_count; n++)
    if (a.x[3 * n] > 1.9)
      a.x[3 * n] = 3.0 - a.x[3 * n], a.x[3 * n + 2] = 0.5 + 0.01 * a.x[3 * n + 1];
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = 0.05 + 0.02 * b.x[3 * n];
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = EPSILON;
  ct_contact *contact = open_contact(&a, &b, options);
  for (int k = 0; k < 40; k++) {
    int64_t count;
    ct_contact_point got[32];
    update(contact, &a, &b);
    ct_contact_points(contact, got, NULL);
    ct_contact_point *want = all_points(&a, &b, options, &count);
    for (int64_t i = 0; i < count; i++) {
      wrong += got[i].other != want[i].other ||
               (want[i].other >= 0 && !(fabs(got[i].gap - want[i].gap) < 1e-13 &&
                                        fabs(got[i].xi[0] - want[i].xi[0]) < 1e-9));
      floor += got[i].side == 1 && got[i].other == 0;
      ceiling += got[i].side == 1 && got[i].other == 1;
    }
    for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] += 0.01;
  }
  tap_ok(wrong == 0 && floor > 20 && ceiling > 20,
         "%s between a floor and a ceiling: nearest to the floor %d times, to the ceiling %d "
         "times, %d wrong",
         KIND[kind], floor, ceiling, wrong);
}

/* A contact that has followed a motion gives the same forces as a new one at its end. */
static void history(void)
{
  patch a, b;
  warped_pair(CT_Q4, CT_Q8, &a, &b);
  int na = 3 * a.surface.node_count, nb = 3 * b.surface.node_count;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  for (int k = 0; k < 60; k++) {
    for (int n = 0; n < b.surface.node_count; n++) {
      b.x[3 * n] += k < 30 ? 0.05 : -0.05;
      b.x[3 * n + 2] += k < 30 ? 0.03 : -0.03;
    }
    update(contact, &a, &b);
  }
  double *f = numbers(na + nb), *g = all_forces(&a, &b, ct_contact_options_default());
  forces(contact, &a, &b, f, f + na);
  double off = largest_difference(f, g, na + nb) / largest(g, na + nb);
  tap_ok(off < 1e-13, "after 60 updates of a motion: forces differ by %.2g from a new contact's",
         off);
}

/* A point exactly over the edge between two faces belongs to the first of them, wherever it came
 * from. (eq:closest-face) */
static void tie(void)
{
  patch a = new_patch(CT_Q4, 2, 1, -1, -1, 2, 2, 1),
        b = new_patch(CT_Q8, 1, 1, -0.5, -0.5, 1, 1, 0);
  for (int n = 0; n < 9; n++) b.x[3 * n + 2] = -0.0625;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  ct_contact_point point[17];
  int other[2];
  for (int k = 0; k < 2; k++) {
    for (int n = 0; n < 9; n++) b.x[3 * n] += k == 0 ? 0.25 : -0.25;
    update(contact, &a, &b);
    ct_contact_points(contact, point, NULL);
    other[k] = point[8 + 4].other;
  }
  tap_ok(point[8 + 4].position[0] == 0.0 && other[0] == 1 && other[1] == 0,
         "a point that comes from face %d to the edge is on face %d", other[0], other[1]);
}

static void not_finite(void)
{
  patch a, b;
  warped_pair(CT_Q4, CT_Q4, &a, &b);
  int na = 3 * a.surface.node_count, nb = 3 * b.surface.node_count;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  double *f = numbers(na + nb), *g = numbers(na + nb), keep;
  ct_error e = {0};
  update(contact, &a, &b);
  forces(contact, &a, &b, f, f + na);
  int node = b.faces[2];
  keep = b.x[3 * node + 1];
  b.x[3 * node + 1] = NAN;
  ct_status status = ct_contact_update(contact, a.x, b.x, &e);
  forces(contact, &a, &b, g, g + na);
  tap_ok(status == CT_INVALID && e.code == CT_INVALID && e.body == 1 && e.point == node,
         "a NaN coordinate: %s", e.text);
  tap_ok(memcmp(f, g, (size_t)(na + nb) * sizeof *f) == 0,
         "the forces are still those of the last good update");
  b.x[3 * node + 1] = keep;
  a.x[3 * a.faces[0]] = -INFINITY;
  tap_ok(ct_contact_update(contact, a.x, b.x, &e) == CT_INVALID && e.body == 0 &&
             e.point == a.faces[0],
         "an infinite coordinate: %s", e.text);
}

static void refused(const ct_surface *a, const ct_surface *b, const ct_contact_options *options,
                    ct_status want, int64_t body, int64_t element, const char *what)
{
  ct_contact *contact = NULL;
  ct_error e = {0};
  ct_status status = ct_contact_create(a, b, options, &contact, &e);
  tap_ok(status == want && contact == NULL && e.code == want && (body < 0 || e.body == body) &&
             (element < 0 || e.element == element) && strlen(e.text) > 8,
         "%s: refused, %s", what, e.text);
}

/* Two unit squares that look at each other, the lower one at z = 0 and the upper one at 0.1:
 * outside, and over each other exactly. The energy, both passes and where the gap g is negative, is
 * half of ε g² with an area of 1. */
static ct_contact *two_squares(ct_face_kind kind, patch *a, patch *b)
{
  *a = new_patch(kind, 1, 1, 0, 0, 1, 1, 1), *b = new_patch(kind, 1, 1, 0, 0, 1, 1, 0);
  for (int n = 0; n < b->surface.node_count; n++) b->x[3 * n + 2] = 0.1;
  ct_contact *contact = open_contact(a, b, ct_contact_options_default());
  update(contact, a, b);
  return contact;
}

/* A refused call leaves no trace: motion counts from the last good call, whichever surface was
 * refused. */
static void after_a_refusal(void)
{
  for (int bad = 0; bad < 2; bad++) {
    patch a, b;
    ct_contact *contact = two_squares(CT_T3, &a, &b);
    ct_error e;
    int node = (bad ? b : a).faces[0];
    double *x[2] = {a.x, b.x}, keep = x[bad][3 * node];
    for (int n = 0; n < 9; n++) x[1 - bad][3 * n + 2] += bad ? 0.2 : -0.2;
    x[bad][3 * node] = NAN;
    ct_status status = ct_contact_update(contact, a.x, b.x, &e);
    x[bad][3 * node] = keep;
    update(contact, &a, &b);
    double energy = ct_contact_energy(contact), want = 0.5 * EPSILON * 0.01;
    tap_ok(status == CT_INVALID && fabs(energy - want) < 1e-12 * want,
           "after a NaN of surface %d surfaces that came in press: energy %g of %g", bad, energy,
           want);
  }
}

/* A point in contact that jumps deeper than the lists reach stays in contact. */
static void jump_while_in_contact(void)
{
  static const double by_hand[] = {-0.05, -20.0, -20.0, -20.1, -0.05, 0.05};
  patch a, b;
  ct_contact *contact = two_squares(CT_Q4, &a, &b);
  double off = 0.0;
  for (size_t i = 0; i < sizeof by_hand / sizeof by_hand[0]; i++) {
    for (int n = 0; n < 9; n++) b.x[3 * n + 2] = by_hand[i];
    update(contact, &a, &b);
    double depth = fmax(-by_hand[i], 0.0), want = 0.5 * EPSILON * depth * depth;
    off = worst(off, (ct_contact_energy(contact) - want) / (want > 0.0 ? want : 1.0));
  }
  tap_ok(off < 1e-12, "a jump to twenty widths deep and back: energy of the gap, off by %.2g", off);
}

static void refusals(void)
{
  patch a, b;
  warped_pair(CT_Q4, CT_Q8, &a, &b);
  ct_contact_options good = ct_contact_options_default(), o;
  good.epsilon = 1.0;
  const double penalty[4] = {0.0, -1.0, NAN, INFINITY}, tolerance[4] = {0.0, -1.0, 1.0, NAN};
  for (int i = 0; i < 4; i++) {
    o = good, o.epsilon = penalty[i];
    refused(&a.surface, &b.surface, &o, CT_ERROR_ARGUMENT, -1, -1,
            "a penalty that is not positive");
    o = good, o.tolerance = tolerance[i];
    refused(&a.surface, &b.surface, &o, CT_ERROR_ARGUMENT, -1, -1, "a tolerance out of range");
  }
  o = good, o.depth = -0.1;
  refused(&a.surface, &b.surface, &o, CT_ERROR_ARGUMENT, -1, -1, "a negative depth");
  o = good, o.threads = 0;
  refused(&a.surface, &b.surface, &o, CT_ERROR_ARGUMENT, -1, -1, "no threads");
  o = good, o.threads = 1025;
  refused(&a.surface, &b.surface, &o, CT_ERROR_ARGUMENT, -1, -1, "more threads than allowed");
  o = good, o.method = (ct_method)77;
  refused(&a.surface, &b.surface, &o, CT_ERROR_ARGUMENT, -1, -1, "an unknown method");
  ct_surface s = b.surface;
  s.face_count = 0;
  refused(&a.surface, &s, &good, CT_ERROR_ARGUMENT, 1, -1, "a surface without faces");
  refused(&s, &a.surface, &good, CT_ERROR_ARGUMENT, 0, -1, "a first surface without faces");
  s = b.surface, s.kind = (ct_face_kind)9;
  refused(&a.surface, &s, &good, CT_ERROR_ARGUMENT, 1, -1, "an unknown kind of face");
  s = b.surface, s.faces = NULL;
  refused(&a.surface, &s, &good, CT_ERROR_ARGUMENT, 1, -1, "no face list");
  refused(NULL, &s, &good, CT_ERROR_ARGUMENT, -1, -1, "no surface");
  tap_ok(ct_contact_create(&a.surface, &b.surface, NULL, NULL, NULL) == CT_ERROR_ARGUMENT,
         "null options, output and error: refused");

  int32_t keep = b.faces[8 + 3];
  b.faces[8 + 3] = b.surface.node_count;
  refused(&a.surface, &b.surface, &good, CT_ERROR_ARGUMENT, 1, 1, "a node number too large");
  b.faces[8 + 3] = -5;
  refused(&a.surface, &b.surface, &good, CT_ERROR_ARGUMENT, 1, 1, "a negative node number");
  b.faces[8 + 3] = keep;
  double x = b.x[3 * keep];
  b.x[3 * keep] = NAN;
  refused(&a.surface, &b.surface, &good, CT_INVALID, 1, -1, "a reference coordinate that is NaN");
  b.x[3 * keep] = x;
  for (int i = 0; i < 8; i++)
    memcpy(&b.x[3 * b.faces[8 * 2 + i]], &b.x[3 * b.faces[8 * 2]], 3 * sizeof(double));
  refused(&a.surface, &b.surface, &good, CT_ERROR_GEOMETRY, 1, 2, "a face without area");

  tap_ok(ct_contact_update(NULL, a.x, b.x, NULL) == CT_ERROR_ARGUMENT &&
             ct_contact_add_force(NULL, a.x, b.x, NULL) == CT_ERROR_ARGUMENT &&
             isnan(ct_contact_energy(NULL)) && ct_contact_point_count(NULL) == 0 &&
             ct_contact_points(NULL, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_contact_stable_step(NULL, a.x, b.x, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_contact_update_stable_step(NULL, a.x, b.x, NULL, NULL) == CT_ERROR_ARGUMENT,
         "calls without a contact are refused");
  ct_contact_free(NULL);
  tap_close(ct_contact_penalty(4.0, 2.1e5, 0.025), 3.36e7, 1e-6,
            "beta = 4, E = 2.1e5, h = 0.025: eps = 3.36e7");
}

/* Two surfaces of one array of nodes that share an edge, an open book: a node of both gets the sum
 * of both rows (eq:contact-bound), here put together once more from the points of an update. */
static void shared_nodes(void)
{
  double x[18] = {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0.5, 0, 0.8, 0.5, 1, 0.8},
         mass[6] = {0.1, 0.1, 1, 1, 1, 1}, copy[18], row[6] = {0}, want = 0, got[2], zero[18] = {0};
  int32_t lower[4] = {0, 2, 3, 1}, upper[4] = {0, 1, 5, 4};
  ct_surface a = {CT_Q4, 6, 1, lower, x}, b = {CT_Q4, 6, 1, upper, x};
  const int32_t *faces[2] = {lower, upper};
  ct_contact_options options = ct_contact_options_default();
  ct_contact *contact = NULL;
  ct_error e = {0};
  ct_rule rule;
  options.epsilon = EPSILON;
  must(ct_contact_create, &a, &b, &options, &contact);
  later_contact(contact);
  must(ct_contact_update, contact, x, x);
  ct_rule_face(CT_Q4, &rule, NULL);
  int64_t count = ct_contact_point_count(contact), met = 0;
  ct_contact_point *point = room(count, sizeof *point);
  ct_contact_points(contact, point, NULL);
  for (int i = 0; i < count; i++) {
    double N[8], M[8];
    if (point[i].other < 0) continue;
    met++;
    ct_segment_shape(CT_Q4, rule.xi[point[i].point], N);
    ct_segment_shape(CT_Q4, point[i].xi, M);
    for (int k = 0; k < 4; k++) {
      row[faces[point[i].side][k]] += 0.5 * EPSILON * point[i].weight * 2.0 * N[k];
      row[faces[1 - point[i].side][k]] += 0.5 * EPSILON * point[i].weight * 2.0 * M[k];
    }
  }
  for (int n = 0; n < 6; n++) want = fmax(want, row[n] / mass[n]);
  need(springs_of(contact, mass, mass, &got[0]), &e);
  tap_ok(met == count, "each point of an open book faces the other page");
  tap_close(got[0] / want, 1.0, 1e-13, "nodes of both pages have the sum of both rows");
  need(ct_contact_add_force(contact, zero, zero, NULL), &e);
  tap_ok(largest(zero, 18) == 0.0, "an open book has no contact force");
  memcpy(copy, x, sizeof copy);
  b.reference = copy;
  must(ct_contact_create, &a, &b, &options, &contact);
  later_contact(contact);
  need(springs_of(contact, mass, mass, &got[1]), &e);
  tap_ok(got[1] < 0.9 * got[0], "with two arrays they are separate nodes");
}

int main(void)
{
  free_at_end();
  static const int pair[7][2] = {{CT_Q4, CT_Q4}, {CT_Q8, CT_Q8}, {CT_T3, CT_T3}, {CT_T6, CT_T6},
                                 {CT_Q4, CT_T6}, {CT_Q8, CT_T3}, {CT_Q8, CT_Q4}};
  for (int i = 0; i < 7; i++) force_is_gradient((ct_face_kind)pair[i][0], (ct_face_kind)pair[i][1]);
  for (int i = 0; i < 7; i++) plain_form((ct_face_kind)pair[i][0], (ct_face_kind)pair[i][1]);
  for (int k = 0; k < 4; k++) flat_overlap((ct_face_kind)k, (ct_face_kind)k, 3, 3);
  flat_overlap(CT_Q4, CT_Q4, 2, 3);
  flat_overlap(CT_Q4, CT_Q4, 4, 5);
  flat_overlap(CT_Q4, CT_Q4, 22, 3);
  flat_overlap(CT_Q8, CT_Q8, 2, 3);
  flat_overlap(CT_T6, CT_Q4, 3, 4);
  one_q8();
  bound_of_q8();
  gap_sweep(1.0);
  gap_sweep(0x1p-13);
  far_side(0.02);
  border();
  fold(-0.2, 0.0, -0.05, 0.0, "a ridge into a plane");
  fold(1.0, 1.3, -0.1, 0.0, "a ridge into a valley");
  fold(-0.2, 0.0, -0.1, 1.0, "a pyramid into a plane");
  fold(1.0, 1.3, -0.1, 1.0, "a pyramid into a pit");
  for (int i = 0; i < 4; i++) frequency_bound((ct_face_kind)i, (ct_face_kind)i);
  frequency_bound(CT_Q8, CT_Q4);
  sharp_bound();
  bound_on_ties();
  shared_nodes();
  bars(1.0, 0);
  bars(10.0, 0);
  bars(1.0, 1);
  bars(10.0, 1);
  for (int k = 0; k < 4; k++) {
    translation((ct_face_kind)k);
    symmetries((ct_face_kind)k);
    methods((ct_face_kind)k);
  }
  history();
  between(CT_Q4);
  between(CT_Q8);
  tie();
  not_finite();
  after_a_refusal();
  jump_while_in_contact();
  refusals();
  return tap_done();
}
