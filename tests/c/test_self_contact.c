/* Contact of a surface with itself: a folded strip, a ring cut open, closed thin bodies, and bodies
 * without contact. */
#include "../../libcontact/src/contact/contact_internal.h"
#include "bodies.h"
#include "springs.h"

static const char *KIND[4] = {"Q4", "Q8", "T3", "T6"};
static const double EPSILON = 1000.0;

/* A surface with its own arrays; the faces of its lower and its upper layer separately. */
typedef struct fold {
  ct_surface surface, lower, upper;
  int32_t *faces, *layer[2];
  double *reference, *x;
} fold;

enum { ALONG = 14, ACROSS = 2 };

/* A hairpin: a layer of length 1 at z = 0, half a circle, a layer of length 1 at z = 0.3, normals
 * inwards. */
static void hairpin(double s, double y, double x[3])
{
  const double r = 0.15, arc = 3.14159265358979324 * r;
  double angle = (s - 1.0) / r;
  x[1] = y;
  if (s <= 1.0) x[0] = s, x[2] = 0.0;
  else if (s < 1.0 + arc) x[0] = 1.0 + r * sin(angle), x[2] = r - r * cos(angle);
  else x[0] = 2.0 + arc - s, x[2] = 2.0 * r;
}

static fold new_fold(ct_face_kind kind)
{
  static const int square[8][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}};
  static const int triangle[2][6][2] = {{{0, 0}, {2, 0}, {0, 2}, {1, 0}, {1, 1}, {0, 1}},
                                        {{2, 2}, {0, 2}, {2, 0}, {1, 2}, {1, 1}, {2, 1}}};
  int three = kind == CT_T3 || kind == CT_T6, per = ct_face_node_count(kind), row = 2 * ALONG + 1,
      nodes = row * (2 * ACROSS + 1);
  int count = ALONG * ACROSS * (three ? 2 : 1), in[2] = {0, 0};
  fold p = {.faces = integers(count * per),
            .layer = {integers(count * per), integers(count * per)},
            .reference = numbers(3 * nodes),
            .x = numbers(3 * nodes)};
  for (int n = 0; n < nodes; n++)
    hairpin((2.0 + 0.15 * 3.14159265358979324) * (n % row) / (2 * ALONG),
            0.4 * (n / row) / (2 * ACROSS), &p.reference[3 * n]);
  for (int f = 0; f < count; f++) {
    int cell = three ? f / 2 : f, i = 2 * (cell % ALONG), j = 2 * (cell / ALONG),
        side = cell % ALONG < ALONG / 2 ? 0 : 1;
    for (int a = 0; a < per; a++) {
      const int *at = three ? triangle[f % 2][a] : square[a];
      p.faces[f * per + a] = p.layer[side][per * in[side] + a] = i + at[0] + row * (j + at[1]);
    }
    in[side]++;
  }
  memcpy(p.x, p.reference, 3 * (size_t)nodes * sizeof *p.x);
  p.surface = (ct_surface){kind, nodes, count, p.faces, p.reference};
  p.lower = (ct_surface){kind, nodes, in[0], p.layer[0], p.reference};
  p.upper = (ct_surface){kind, nodes, in[1], p.layer[1], p.reference};
  return p;
}

/* Press the end of the upper layer through the lower one, to z = -0.1 of where it was; shift it by
 * `slide`, warp both at random. */
static void press(fold *p, double slide, double noise)
{
  for (int n = 0; n < p->surface.node_count; n++) {
    const double *X = &p->reference[3 * n];
    double t = fmin(fmax((1.0 - X[0]) / 0.6, 0.0), 1.0), w = t * t * (3.0 - 2.0 * t);
    p->x[3 * n] = X[0] + (X[2] > 0.29 ? slide : 0.0) + uniform(noise);
    p->x[3 * n + 1] = X[1] + uniform(noise);
    p->x[3 * n + 2] = X[2] * (1.0 - 1.1 * w) + uniform(0.3 * noise);
  }
}

static ct_contact *open_self(const ct_surface *surface)
{
  ct_contact *contact = NULL;
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = EPSILON;
  must(ct_contact_create, surface, surface, &options, &contact);
  return later_contact(contact);
}

static double energy_at(ct_contact *contact, const double *x)
{
  must(ct_contact_update, contact, x, NULL);
  return ct_contact_energy(contact);
}

static void forces(const ct_contact *contact, int nodes, double *f)
{
  ct_error e = {0};
  memset(f, 0, 3 * (size_t)nodes * sizeof *f);
  need(ct_contact_add_force(contact, f, NULL, NULL), &e);
}

/* Forces of a folded strip: minus the gradient of the energy; momentum; no point meets its
 * neighbourhood. (eq:self-adjacent, eq:gap-bound) */
static void folded(ct_face_kind kind)
{
  fold p = new_fold(kind);
  int nodes = p.surface.node_count, pressed[2] = {0, 0}, across = 0;
  ct_contact *contact = open_self(&p.surface);
  double *f = numbers(3 * nodes), off = 0.0, h = 1e-6, sum[3] = {0}, moment[3] = {0}, size = 0.0,
         F[3], M[3];
  press(&p, 0.013, 0.01);
  energy_at(contact, p.x);
  forces(contact, nodes, f);
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  ct_contact_points(contact, point, NULL);
  for (int i = 0; i < count; i++) {
    if (!(point[i].raw_pressure > 0.0)) continue;
    int cells = kind == CT_T3 || kind == CT_T6 ? 2 : 1,
        mine = point[i].face / cells % ALONG < ALONG / 2,
        theirs = point[i].other / cells % ALONG < ALONG / 2;
    pressed[mine]++;
    across += mine != theirs;
  }
  tap_ok(pressed[0] > 5 && pressed[1] > 5 && across == pressed[0] + pressed[1],
         "%s strip: %d points of one layer and %d of the other are in contact, each with the other "
         "layer",
         KIND[kind], pressed[0], pressed[1]);
  for (int i = 0; i < 3 * nodes; i++) {
    double keep = p.x[i], up;
    p.x[i] = keep + h;
    up = energy_at(contact, p.x);
    p.x[i] = keep - h;
    off = worst(off, f[i] + (up - energy_at(contact, p.x)) / (2.0 * h));
    p.x[i] = keep;
  }
  tap_ok(off < 1e-8 * largest(f, 3 * nodes),
         "%s strip: force is minus the gradient of the energy, off by %.2g", KIND[kind],
         off / largest(f, 3 * nodes));
  for (int n = 0; n < nodes; n++)
    for (int c = 0; c < 3; c++) {
      sum[c] += f[3 * n + c];
      moment[c] += p.x[3 * n + (c + 1) % 3] * f[3 * n + (c + 2) % 3] -
                   p.x[3 * n + (c + 2) % 3] * f[3 * n + (c + 1) % 3];
      size += fabs(f[3 * n + c]);
    }
  tap_ok(largest(sum, 3) < 1e-13 * size && largest(moment, 3) < 1e-13 * size,
         "%s strip: linear and angular momentum, %.2g and %.2g of the forces", KIND[kind],
         largest(sum, 3) / size, largest(moment, 3) / size);
  energy_at(contact, p.x);
  tap_ok(ct_contact_resultant(contact, F, M, NULL, NULL, NULL) == CT_OK &&
             largest(F, 3) < 1e-13 * size && largest(M, 3) < 1e-13 * size,
         "%s strip: no resultant", KIND[kind]);
}

/* The layers as two separate surfaces must give the same result, as the bend between them touches
 * nothing; also if a small depth leaves the lists of the reference shape empty. (eq:local-minimum,
 * eq:self-adjacent) */
static void like_two(ct_face_kind kind)
{
  fold p = new_fold(kind);
  int nodes = p.surface.node_count;
  ct_contact *one = NULL, *two = NULL;
  ct_contact_options options = ct_contact_options_default();
  ct_error e;
  double *f = numbers(3 * nodes), *g = numbers(3 * nodes), *area = numbers(nodes), a, b;
  options.epsilon = EPSILON;
  options.depth = 0.05;
  must(ct_contact_create, &p.surface, &p.surface, &options, &one);
  must(ct_contact_create, &p.lower, &p.upper, &options, &two);
  press(&p, 0.02, 0.01);
  a = energy_at(one, p.x);
  must(ct_contact_update, two, p.x, p.x);
  b = ct_contact_energy(two);
  forces(one, nodes, f);
  need(ct_contact_add_force(two, g, g, NULL), &e);
  tap_ok(a > 0.0 && fabs(a / b - 1.0) < 1e-12,
         "%s strip: the energy is that of its two layers as two surfaces, off by %.2g", KIND[kind],
         a / b - 1.0);
  tap_ok(largest_difference(f, g, 3 * nodes) < 1e-12 * largest(g, 3 * nodes),
         "%s strip: the forces are, too", KIND[kind]);
  must(ct_contact_traction, one, 0, f, area);
  for (int s = 0; s < 2; s++) must(ct_contact_traction, two, s, g, area);
  tap_ok(largest_difference(f, g, 3 * nodes) < 1e-12 * largest(g, 3 * nodes),
         "%s strip: the tractions at the nodes are, too", KIND[kind]);
  free_contact(one);
  free_contact(two);
}

/* The bound on the step against the largest eigenvalue of the contact's own stiffness, by power
 * iteration over differences of forces. */
static void bound(ct_face_kind kind)
{
  fold p = new_fold(kind);
  int n = 3 * p.surface.node_count;
  ct_contact *contact = open_self(&p.surface);
  double *f0 = numbers(n), *f = numbers(n), *v = numbers(n), *mass = numbers(n), *x = numbers(n),
         quotient = 0.0, square = 0.0, dt = 0.0, h = 1e-7;
  ct_error e = {0};
  press(&p, 0.01, 0.005);
  energy_at(contact, p.x);
  forces(contact, n / 3, f0);
  for (int i = 0; i < n; i++) v[i] = uniform(1.0), mass[i] = 0.5 + 0.01 * (i % 7);
  need(springs_of(contact, mass, NULL, &square), &e);
  need(ct_contact_update_stable_step(contact, mass, NULL, &dt, NULL), &e);
  for (int k = 0; k < 60; k++) {
    double work = 0.0, kinetic = 0.0, top = largest(v, n);
    for (int i = 0; i < n; i++) x[i] = p.x[i] + h * (v[i] /= top);
    energy_at(contact, x);
    forces(contact, n / 3, f);
    for (int i = 0; i < n; i++) {
      double Kv = -(f[i] - f0[i]) / h;
      work += v[i] * Kv;
      kinetic += mass[i / 3] * v[i] * v[i];
      v[i] = Kv / mass[i / 3];
    }
    quotient = work / kinetic;
  }
  tap_ok(quotient > 0.05 * square && quotient <= square,
         "%s strip: the bound %.4g is above the true frequency %.4g", KIND[kind], square, quotient);
  tap_close(dt * sqrt(square), 2.0, 1e-14, "%s strip: the step is that of the bound", KIND[kind]);
}

/* A layer that moves over the straight part of the other one: the forces at the end are the bits of
 * a contact created at the end, on any number of threads. (eq:local-minimum) */
static void history(ct_face_kind kind)
{
  fold p = new_fold(kind);
  int nodes = p.surface.node_count;
  ct_contact *travelled = open_self(&p.surface), *fresh = open_self(&p.surface), *threads = NULL;
  ct_contact_options options = ct_contact_options_default();
  double *f = numbers(3 * nodes), *g = numbers(3 * nodes), *h = numbers(3 * nodes);
  options.epsilon = EPSILON;
  options.threads = 3;
  must(ct_contact_create, &p.surface, &p.surface, &options, &threads);
  for (int step = 0; step <= 60; step++) {
    press(&p, 0.00225 * step, 0.0);
    energy_at(travelled, p.x);
  }
  energy_at(fresh, p.x);
  energy_at(threads, p.x);
  forces(travelled, nodes, f);
  forces(fresh, nodes, g);
  forces(threads, nodes, h);
  tap_ok(largest(f, 3 * nodes) > 0.0 &&
             largest_difference(f, g, 3 * nodes) <= 1e-13 * largest(g, 3 * nodes),
         "%s strip: the forces do not depend on the motion (%.2g)", KIND[kind],
         largest_difference(f, g, 3 * nodes) / largest(g, 3 * nodes));
  tap_ok(memcmp(g, h, 3 * (size_t)nodes * sizeof *g) == 0,
         "%s strip: the same bits from three threads", KIND[kind]);
  free_contact(threads);
}

/* The skin of a box, closed all around, at a given thickness: squeezed, sheared and bent it must
 * not touch itself. (eq:self-depth) */
static void closed(ct_brick_kind kind, double thickness, int layers)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 2, 1, thickness, 8, 4, layers);
  int32_t *outer = integers(8 * 6 * m->element_count);
  ct_surface surface = {ct_brick_face_kind(kind), m->node_count,
                        ct_mesh_outer_faces(m, outer, NULL), outer, m->nodes};
  ct_contact *contact = open_self(&surface);
  double *x = numbers(3 * m->node_count), *f = numbers(3 * m->node_count), top = 0.0, energy = 0.0;
  for (int shape = 0; shape < 4; shape++) {
    for (int n = 0; n < m->node_count; n++) {
      const double *X = &m->nodes[3 * n];
      double bend = 0.8 * X[0], r = 1.25 + X[2];
      x[3 * n] = shape == 3 ? r * sin(bend) : X[0] + (shape == 2 ? 0.5 * X[2] : 0.0);
      x[3 * n + 1] = X[1];
      x[3 * n + 2] = shape == 3 ? r * cos(bend) : X[2] * (shape == 1 ? 0.7 : 1.0);
    }
    energy = worst(energy, energy_at(contact, x));
    forces(contact, m->node_count, f);
    top = worst(top, largest(f, 3 * m->node_count));
  }
  tap_ok(top == 0.0 && energy == 0.0,
         "%s skin of a plate of thickness %g in %d layers: as it is, squeezed, sheared and bent, "
         "it does not touch itself",
         KIND[surface.kind], thickness, layers);
}

/* A hairpin whose lower jaw opens by `angle`: the body between two legs of length 0.6 and thickness
 * 0.1 that are 0.08 apart. */
static void jaws(const ct_mesh *m, double angle, double *x)
{
  const double leg = 0.6, thick = 0.1, middle = 0.09, arc = middle * 3.14159265358979324;
  for (int n = 0; n < m->node_count; n++) {
    const double *X = &m->nodes[3 * n];
    double s = (2.0 * leg + arc) * X[0],
           turn = fmin(fmax((s - leg) / middle, 0.0), 3.14159265358979324),
           r = middle - thick * (X[2] - 0.5);
    double a = (s < leg         ? s
                : s > leg + arc ? 2.0 * leg + arc - s
                                : leg) +
               r * sin(turn) - leg,
           b = -r * cos(turn), open = angle * fmin(fmax((leg - s) / 0.3, 0.0), 1.0);
    x[3 * n] = a * cos(open) - b * sin(open);
    x[3 * n + 1] = X[1];
    x[3 * n + 2] = a * sin(open) + b * cos(open);
  }
}

/* Jaws that open touch nothing, although the end of one comes to face the underside of the other,
 * through the other (eq:self-status). */
static void open_jaws(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 0.2, 1, 18, 2, 2);
  int32_t *outer = integers(8 * 6 * m->element_count);
  double *reference = numbers(3 * m->node_count), *x = numbers(3 * m->node_count), energy = 0.0;
  jaws(m, 0.0, reference);
  ct_surface skin = {ct_brick_face_kind(kind), m->node_count, ct_mesh_outer_faces(m, outer, NULL),
                     outer, reference};
  ct_contact *contact = NULL;
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = EPSILON;
  options.depth = 0.3;
  must(ct_contact_create, &skin, &skin, &options, &contact);
  for (int step = 0; step <= 8; step++) {
    jaws(m, 0.1 * step, x);
    energy = worst(energy, energy_at(contact, x));
  }
  tap_ok(energy == 0.0, "%s jaws that open do not touch: energy %g", KIND[skin.kind], energy);
  jaws(m, -0.16, x);
  tap_ok(energy_at(contact, x) > 0.0, "%s jaws that close are in contact", KIND[skin.kind]);
  free_contact(contact);
}

/* A bar bent to a ring that is almost closed: the body between angle 0 and `angle`, of thickness
 * 0.2. */
static void ring(const ct_mesh *m, double angle, double *x)
{
  for (int n = 0; n < m->node_count; n++) {
    const double *X = &m->nodes[3 * n];
    double r = 1.0 + X[2];
    x[3 * n] = r * cos(X[0] * angle);
    x[3 * n + 1] = -X[1];
    x[3 * n + 2] = r * sin(X[0] * angle);
  }
}

/* A C whose ends are pushed into each other: the ends meet as two surfaces would, and there is no
 * other contact. (eq:self-adjacent) */
static void c_shape(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 0.3, 0.2, 40, 3, 2);
  int32_t *outer = integers(4 * 6 * m->element_count), *first = integers(4 * 100),
          *last = integers(4 * 100);
  double *reference = numbers(3 * m->node_count), *x = numbers(3 * m->node_count),
         *f = numbers(3 * m->node_count), *g = numbers(3 * m->node_count);
  ct_error e;
  ct_contact_options options = ct_contact_options_default();
  ring(m, 6.1, reference);
  ct_surface skin = {CT_Q4, m->node_count, ct_mesh_outer_faces(m, outer, NULL), outer, reference};
  ct_surface a = {CT_Q4, m->node_count, ct_mesh_plane_faces(m, 0, 0.0, first, NULL), first,
                  reference};
  ct_surface b = {CT_Q4, m->node_count, ct_mesh_plane_faces(m, 0, 1.0, last, NULL), last,
                  reference};
  ct_contact *self = open_self(&skin), *pair = NULL;
  options.epsilon = EPSILON;
  must(ct_contact_create, &a, &b, &options, &pair);
  tap_ok(energy_at(self, reference) == 0.0, "a C with open ends does not touch itself");
  ring(m, 6.2832 + 0.02, x);
  double got = energy_at(self, x);
  must(ct_contact_update, pair, x, x);
  forces(self, m->node_count, f);
  need(ct_contact_add_force(pair, g, g, NULL), &e);
  double want = ct_contact_energy(pair);
  tap_ok(want > 0.0 && fabs(got / want - 1.0) < 1e-12,
         "a C whose ends are pushed into each other has the energy of its two ends, off by %.2g",
         got / want - 1.0);
  tap_ok(largest_difference(f, g, 3 * m->node_count) < 1e-12 * largest(g, 3 * m->node_count),
         "and their forces");
  free_contact(pair);
}

/* A scene in which the ends of a C fly at each other: the faces of the skin are given twice, and
 * energy and momentum are kept. */
static void scene_of_a_c(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 0.3, 0.2, 40, 2, 2), *bent = copy_mesh(m);
  int32_t *outer = integers(4 * 6 * m->element_count);
  ct_material material = {1000.0, 0.3, 1e-3, CT_LINEAR};
  ct_scene *scene = new_scene();
  int64_t steps;
  double touched = 0.0, balance = 0.0, p = 0.0, size = 0.0;
  ring(m, 6.25, bent->nodes);
  int32_t body = add_body(scene, "c", bent, &material, (ct_solid_kernel)0, 0, 0, 0),
          faces = ct_mesh_outer_faces(bent, outer, NULL);
  ct_scene_contact contact = scene_contact(body, outer, faces, body, outer, faces);
  contact.beta = 1.0;
  contact.options.dissipation = 0.0;
  must(ct_scene_add_contact, scene, &contact);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 2e-3, .fraction = 0.4}, &steps, NULL);
  ct_state *state = new_state(problem);
  for (int n = 0; n < m->node_count; n++)
    state->velocity[3 * n + 2] = 40.0 * (m->nodes[3 * n] - 0.5);
  ct_energy first = energy_of(problem, state), now = first;
  for (int64_t i = 0; i < steps; i += 10) {
    advance(problem, state, 10);
    now = energy_of(problem, state);
    touched = fmax(touched, now.contact / first.total);
    balance = worst(balance, now.total / first.total - 1.0);
  }
  ct_momentum momentum = momentum_of(problem, state, body);
  for (int n = 0; n < m->node_count; n++)
    size += fabs(state->velocity[3 * n + 2]) / problem->inverse_mass[3 * n];
  for (int c = 0; c < 3; c++) p = worst(p, momentum.p[c]);
  tap_ok(touched > 1e-4 && balance < 0.01,
         "a scene of a C whose ends collide: contact takes %.2g of the energy, the total strays by "
         "%.2g",
         touched, balance);
  tap_close(p / size, 0.0, 1e-14, "and its momentum stays");
}

/* Keep the elements of a box that form a shape: an L, stairs, or all but one at the last corner. */
static int in_shape(int shape, int i, int j, int k)
{
  return shape == 0 ? i == 0 || j == 0 : shape == 1 ? i + j < 4 : !(i == 3 && j == 3 && k == 3);
}

static void carve(ct_mesh *m, int shape, int layers)
{
  int per = ct_brick_node_count(m->kind), kept = 0;
  for (int e = 0; e < m->element_count; e++)
    if (in_shape(shape, e % 4, e / 4 % 4, layers == 1 ? 0 : e / 16))
      memmove(&m->elements[per * kept++], &m->elements[per * e], (size_t)per * sizeof *m->elements);
  m->element_count = kept;
}

/* Concave bodies of cubes with nodes moved at random: an undeformed body does not touch itself, and
 * after a small motion only slightly (eq:gap-bound). (eq:self-adjacent, eq:self-status) */
static void concave(ct_brick_kind kind, int shape, ct_contact_rule points)
{
  double at_rest = 0.0, shaken = 0.0;
  for (int trial = 0; trial < 12; trial++) {
    ct_mesh *m = box_mesh(kind, 0, 0, 0, 4, 4, shape == 2 ? 4 : 1, 4, 4, shape == 2 ? 4 : 1);
    ct_contact *contact = NULL;
    ct_contact_options options = ct_contact_options_default();
    ct_error e;
    carve(m, shape, shape == 2 ? 4 : 1);
    shake(m, 0.1 * (trial % 4), 0);
    int32_t *outer = integers(8 * 6 * m->element_count);
    ct_surface skin = {ct_brick_face_kind(kind), m->node_count, ct_mesh_outer_faces(m, outer, NULL),
                       outer, m->nodes};
    double *x = numbers(3 * m->node_count);
    options.epsilon = EPSILON;
    options.points = points;
    if (ct_contact_create(&skin, &skin, &options, &contact, &e) == CT_OK) {
      at_rest = worst(at_rest, energy_at(contact, m->nodes));
      memcpy(x, m->nodes, 3 * (size_t)m->node_count * sizeof *x);
      for (int i = 0; i < 3 * m->node_count; i++) x[i] += uniform(1e-5);
      shaken = worst(shaken, energy_at(contact, x));
    }
    free_contact(contact);
  }
  // A motion of 1e-5 at most, relative to a point, three times that with quadratic faces, on an
  // area below 100.
  tap_ok(at_rest == 0.0 && shaken <= 100.0 * EPSILON * 1e-8,
         "%s, concave shape %d, rule %d: energy %g at rest, %g with nodes moved at random",
         KIND[ct_brick_face_kind(kind)], shape, (int)points, at_rest, shaken);
}

/* Layers that overlap in the reference shape are not in contact until they have come apart. */
static void made_in_each_other(ct_face_kind kind)
{
  fold p = new_fold(kind);
  size_t size = 3 * (size_t)p.surface.node_count * sizeof(double);
  double *apart = room(1, size);
  memcpy(apart, p.reference, size);
  press(&p, 0.0, 0.0);
  double *pressed = room(1, size);
  memcpy(pressed, p.x, size);
  memcpy(p.reference, pressed, size);
  ct_contact *contact = open_self(&p.surface);
  double before = energy_at(contact, pressed), after = 0.0, parted = energy_at(contact, apart);
  for (int step = 0; step <= 400; step++) {
    for (int i = 0; i < 3 * p.surface.node_count; i++)
      p.x[i] = apart[i] + step / 400.0 * (pressed[i] - apart[i]);
    after = fmax(after, energy_at(contact, p.x));
  }
  tap_ok(before == 0.0 && parted == 0.0 && after > 0.01,
         "%s strip created with an overlap: energy %g, apart %g, and up to %g when its layers come "
         "together "
         "again",
         KIND[kind], before, parted, after);
}

/* The tunnelling check of a hairpin whose upper layer is at the height `z`, for the velocities
 * (0, 0, -down) of the end of the upper layer and (rate x, 0, 0) of all nodes; returns the status.
 */
static ct_status pass_in_a_step(const fold *p, double z, double down, double rate, ct_error *e)
{
  ct_contact *contact = open_self(&p->surface);
  double *v = numbers(3 * contact->fixed->is.node_count);
  for (int n = 0; n < p->surface.node_count; n++) {
    const double *X = &p->reference[3 * n];
    memcpy(&p->x[3 * n], X, 3 * sizeof *X);
    p->x[3 * n + 2] = z * X[2] / 0.3;
  }
  for (int i = 0; i < contact->fixed->is.node_count; i++) {
    const double *X = &p->reference[3 * contact->fixed->nodes[i]];
    double end = fmin(fmax((1.0 - X[0]) / 0.6, 0.0), 1.0);
    v[3 * i] = rate * X[0];
    v[3 * i + 2] = X[2] > 0.29 ? -down * end : 0.0;
  }
  need(ct_contact_update(contact, p->x, NULL, e), e);
  ct_status status = ct_tunnelling_check(&contact->gaps, v, 1.0, 0.0, e);
  return status;
}

/* A step is refused if two faces may pass through each other, and not because two distant parts of
 * the surface have different velocities (eq:tunnelling). */
static void passes_in_a_step(ct_face_kind kind)
{
  fold p = new_fold(kind);
  ct_contact *contact = open_self(&p.surface);
  const double safe = contact->fixed->gaps.approach;
  ct_error e = {0};
  int first = -1, second = -1;
  tap_ok(
      pass_in_a_step(&p, 0.3, 0.0, 1.4 * safe, &e) == CT_OK,
      "%s: a hairpin that stretches by %.2g in a step, of which %.2g are safe, cannot meet itself",
      KIND[kind], 1.4 * safe, safe);
  tap_ok(pass_in_a_step(&p, 1.4 * safe, 1.2 * safe, 0.0, &e) == CT_OK &&
             pass_in_a_step(&p, 0.8 * safe, 0.99 * safe, 0.0, &e) == CT_OK,
         "%s: nor if its layers are farther apart, or approach by a safe length", KIND[kind]);
  ct_status status = pass_in_a_step(&p, 0.8 * safe, 1.2 * safe, 0.0, &e);
  const char *faces = strstr(e.text, "(face ");
  if (faces != NULL) sscanf(faces, "(face %d of the first, %d of the second)", &first, &second);
  int apart = first >= 0 && second >= 0 && first != second;
  tap_ok(status == CT_ERROR_STEP && apart && strstr(e.text, "have come nearer by") != NULL,
         "%s: but if they may pass through each other: %s", KIND[kind], e.text);
}

/* Two faces that share the edge x = 0: the second one is folded about it, until it is at the angle
 * `fold` from the first one. */
static void fold_page(double fold, double *x)
{
  for (int n = 0; n < 15; n++) {
    const double t = n % 5 * 0.5 - 1.0;
    x[3 * n] = t > 0.0 ? -t * cos(fold) : t;
    x[3 * n + 1] = 0.5 * (n / 5);
    x[3 * n + 2] = t > 0.0 ? t * sin(fold) : 0.0;
  }
}

/* The largest difference of the gaps at a fold from s sin φ, at the distances s of the points from
 * the edge; infinite if a point has no partner. */
static double off_book(const ct_contact *contact, const ct_rule *rule, double fold)
{
  ct_contact_point point[18];
  double off = 0.0;
  ct_contact_points(contact, point, NULL);
  for (int i = 0; i < 2 * rule->count; i++) {
    const double xi = rule->xi[i % rule->count][0], s = 0.5 + (i < rule->count ? -0.5 : 0.5) * xi;
    off = point[i].other < 0 ? INFINITY : worst(off, point[i].gap - s * sin(fold));
  }
  return off;
}

/* Two faces at an edge close like a book: they meet from a quarter turn on, and are then held apart
 * by Σ ½ k g²; as the two sides of a ridge they never meet (eq:self-adjacent). */
static void book(ct_face_kind kind)
{
  int32_t faces[16] = {0, 2, 12, 10, 1, 7, 11, 5, 2, 4, 14, 12, 3, 9, 13, 7};
  double flat[45], x[45], f[45], off = 0.0, ridge = 0.0, sum[3] = {0}, h = 1e-6;
  const double PI = 3.14159265358979324, degree = PI / 180.0, closed = -0.5 * degree;
  ct_rule rule;
  ct_rule_face(kind, &rule, NULL);
  if (kind == CT_Q4) memmove(&faces[4], &faces[8], 4 * sizeof *faces);
  fold_page(PI, flat);
  const ct_surface surface = {kind, 15, 2, faces, flat};
  ct_contact *contact = open_self(&surface);
  fold_page(80.0 * degree, x);
  energy_at(contact, x);
  const int open = isinf(off_book(contact, &rule, 80.0 * degree));
  for (double fold = 70.0 * degree; fold > closed; fold -= 0.5 * degree) {
    fold_page(fold, x);
    energy_at(contact, x);
    off = worst(off, off_book(contact, &rule, fold));
  }
  fold_page(closed, x);
  const double energy = energy_at(contact, x), exact = EPSILON * pow(sin(closed), 2.0) / 6.0;
  tap_ok(open && off < 1e-9 && off_book(contact, &rule, closed) < 1e-9 &&
             fabs(energy / exact - 1.0) < 1e-7,
         "%s faces close like a book: gaps off by %.2g, energy by %.2g", KIND[kind], off,
         energy / exact - 1.0);
  forces(contact, 15, f);
  off = 0.0;
  for (int i = 0; i < 45; i++) {
    const double keep = x[i];
    x[i] = keep + h;
    const double up = energy_at(contact, x);
    x[i] = keep - h;
    off = worst(off, f[i] + (up - energy_at(contact, x)) / (2.0 * h));
    x[i] = keep;
    sum[i % 3] += f[i];
  }
  tap_ok(largest(f, 45) > 0.0 && off < 1e-6 * largest(f, 45) &&
             largest(sum, 3) < 1e-13 * largest(f, 45),
         "%s book: force is minus the gradient of the energy, off by %.2g", KIND[kind],
         off / largest(f, 45));
  contact = open_self(&surface);
  for (double fold = -180.0 * degree; fold < -5.0 * degree; fold += 0.5 * degree) {
    fold_page(fold, x);
    ridge = worst(ridge, energy_at(contact, x));
    if (!isinf(off_book(contact, &rule, fold))) ridge = 1.0;
  }
  tap_ok(ridge == 0.0, "%s faces at a ridge do not meet", KIND[kind]);
}

static void refusals(void)
{
  fold p = new_fold(CT_Q4);
  ct_contact_options options = ct_contact_options_default();
  ct_contact *contact = NULL;
  ct_error e;
  double F[3];
  tap_ok(ct_contact_create(NULL, NULL, &options, &contact, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_create(&p.surface, &p.surface, NULL, &contact, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_create(&p.surface, &p.surface, &options, NULL, NULL) == CT_ERROR_ARGUMENT,
         "null pointers are refused");
  tap_ok(ct_contact_create(&p.surface, &p.surface, &options, &contact, &e) == CT_ERROR_ARGUMENT,
         "no penalty: %s", e.text);
  p.surface.face_count = 0;
  options.epsilon = 1.0;
  tap_ok(ct_contact_create(&p.surface, &p.surface, &options, &contact, &e) == CT_ERROR_ARGUMENT &&
             contact == NULL,
         "no faces: %s", e.text);
  p.surface.face_count = 1;
  must(ct_contact_create, &p.surface, &p.surface, &options, &contact);
  tap_ok(energy_at(contact, p.reference) == 0.0 &&
             ct_contact_resultant(contact, F, F, NULL, NULL, NULL) == CT_OK,
         "one face alone touches nothing");
  tap_ok(springs_of(contact, F, NULL, NULL) == CT_ERROR_ARGUMENT, "nowhere to write: refused");
  free_contact(contact);
}

int main(void)
{
  free_at_end();
  for (int k = 0; k < 4; k++) {
    folded((ct_face_kind)k);
    like_two((ct_face_kind)k);
    bound((ct_face_kind)k);
    history((ct_face_kind)k);
    passes_in_a_step((ct_face_kind)k);
  }
  closed(CT_HEX8, 0.05, 1);
  closed(CT_HEX8, 0.3, 1);
  closed(CT_HEX8, 0.3, 3);
  closed(CT_HEX20, 0.05, 1);
  closed(CT_HEX20, 0.3, 1);
  closed(CT_HEX20, 0.3, 3);
  open_jaws(CT_HEX8);
  open_jaws(CT_HEX20);
  for (int i = 0; i < 12; i++)
    concave(i % 2 ? CT_HEX20 : CT_HEX8, i / 2 % 3, i < 6 ? CT_POINTS_GAUSS : CT_POINTS_LOBATTO);
  for (int k = 0; k < 4; k++) made_in_each_other((ct_face_kind)k);
  book(CT_Q4);
  c_shape();
  scene_of_a_c();
  refusals();
  return tap_done();
}
