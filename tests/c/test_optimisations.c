/* Skipped searches of surfaces that are apart, and the order of numbers, change no result. The
 * optimisations of a scene are compared in random scenes: test_optimisations_fuzz.c. */
#include "../../libcontact/src/contact/contact_internal.h"
#include "bodies.h"
#include "springs.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* Coordinates of two surfaces over one array at a time from 0 to 1. */
typedef void motion(const ct_surface *a, const ct_surface *b, double time, double *x);

/* Two plates that approach, wobble, touch and part. */
static void fly(const ct_surface *a, const ct_surface *b, double time, double *x)
{
  (void)b;
  for (int32_t n = 0; n < a->node_count; n++) {
    const double *X = &a->reference[3 * n];
    double wobble = 0.2 * sin(9.0 * time) * sin(5.0 * X[1] + 3.0 * X[2] + 20.0 * time),
           right = X[0] > 0.5;
    x[3 * n] = X[0] + 0.5 * wobble - right * 5.1 * sin(3.14159265358979 * time);
    x[3 * n + 1] = X[1] + 0.3 * time;
    x[3 * n + 2] = X[2] + wobble;
  }
}

/* Corners and mid-sides of two quadratic faces move apart, so the middle of a face moves three
 * times as far as its nodes. */
static void bulge(const ct_surface *a, const ct_surface *b, double time, double *x)
{
  memcpy(x, a->reference, 24 * (size_t)a->node_count);
  for (int i = 0; i < 8; i++) {
    x[3 * a->faces[i]] += (i < 4 ? -2.4 : 2.4) * time;
    x[3 * b->faces[i]] += (i < 4 ? 2.4 : -2.4) * time;
  }
}

/* Contact points, forces and bounds of a contact that skips searches, and of one that always
 * searches; the searches of the first one are counted (eq:contact-clear). */
static void flight(const char *name, const ct_surface *a, const ct_surface *b, motion *move,
                   int steps, int least, int fewest)
{
  const int32_t nodes = a->node_count;
  double *x = numbers(3 * nodes), *mass = numbers(nodes),
         *f[2] = {numbers(3 * nodes), numbers(3 * nodes)};
  for (int n = 0; n < nodes; n++) mass[n] = 1.0;
  ct_contact *c[2];
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 10.0;
  ct_error e;
  for (int k = 0; k < 2; k++) must(ct_contact_create, a, b, &options, &c[k]);
  int64_t points = ct_contact_point_count(c[0]);
  ct_contact_point *p[2] = {room(points, sizeof **p), room(points, sizeof **p)};
  int same = 0, skipped = 0, touching = 0;
  double *low = c[1]->gaps.side[0].search->boxes[0].low;
  for (int step = 0; step <= steps; step++) {
    double omega[2] = {0.0, 0.0};
    move(a, b, step / (double)steps, x);
    *low = 42.0;            // stands only when nobody has searched
    c[0]->gaps.clear = 0.0; // the first contact searches in every call
    for (int k = 0; k < 2; k++) {
      c[k]->gaps.side[0].points[1].other = 0; // as an older state may say
      memset(f[k], 0, 24 * (size_t)nodes);
      memset(p[k], 0, (size_t)points * sizeof **p);
      must(ct_contact_update, c[k], x, x);
      skipped += k == 1 && *low == 42.0;
      ct_contact_add_force(c[k], f[k], f[k], NULL);
      ct_contact_points(c[k], p[k], NULL);
      if (step % 7 == 0) springs_of(c[k], mass, mass, &omega[k]);
    }
    touching += ct_contact_energy(c[0]) > 0.0;
    same += memcmp(f[0], f[1], 24 * (size_t)nodes) == 0 &&
            memcmp(p[0], p[1], (size_t)points * sizeof **p) == 0 && omega[0] == omega[1] &&
            ct_contact_energy(c[0]) == ct_contact_energy(c[1]);
  }
  tap_ok(same == steps + 1 && touching > least && skipped > fewest,
         "%s: the same bits in %d states, %d of them touching, no search in %d", name, same,
         touching, skipped);
  move(a, b, 0.0, x);
  must(ct_contact_update, c[1], x, x);
  x[3 * (nodes - 1)] = NAN;
  x[3 * a->faces[0]] = NAN;
  tap_ok(ct_contact_update(c[1], x, x, &e) == CT_INVALID && e.point == a->faces[0],
         "a NaN far from all contact is an error");
  for (int k = 0; k < 2; k++) {
    free_contact(c[k]);
  }
}

static void plates(ct_brick_kind kind, int self)
{
  // Of a surface with itself, all faces of a plate share a node: nothing on the same side is near.
  ct_mesh *m[2] = {box_mesh(kind, -1, 0, 0, 1, 1, 1, 1, self ? 2 : 4, self ? 2 : 4),
                   box_mesh(kind, 5, 0.03, -0.02, 1, 1, 1, 1, self ? 2 : 3, 2)};
  int per = ct_face_node_count(ct_brick_face_kind(kind));
  int32_t first = m[0]->node_count, nodes = first + m[1]->node_count, faces[8 * 25], count[2];
  double *X = numbers(3 * nodes);
  memcpy(X, m[0]->nodes, 24 * (size_t)first);
  memcpy(X + 3 * first, m[1]->nodes, 24 * (size_t)m[1]->node_count);
  count[0] = ct_mesh_plane_faces(m[0], 0, 0.0, faces, NULL);
  count[1] = ct_mesh_plane_faces(m[1], 0, 5.0, faces + per * count[0], NULL);
  for (int i = per * count[0]; i < per * (count[0] + count[1]); i++) faces[i] += first;
  ct_surface both = {ct_brick_face_kind(kind), nodes, count[0] + count[1], faces, X}, a = both,
             b = both;
  a.face_count = count[0];
  b.face_count = count[1];
  b.faces = faces + per * count[0];
  char name[80];
  snprintf(name, sizeof name, "%s plates fly, touch and part, %s",
           kind == CT_HEX8 ? "linear" : "quadratic", self ? "one surface" : "two surfaces");
  flight(name, self ? &both : &a, self ? &both : &b, fly, 800, 20, 200);
}

static void quadratic_faces(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  int32_t faces[16], nodes = m->node_count, count = ct_mesh_plane_faces(m, 0, 1.0, faces, NULL);
  double *X = numbers(6 * nodes);
  for (int d = 0; d < 3 * nodes; d++)
    X[d] = m->nodes[d], X[3 * nodes + d] = (d % 3 == 0   ? 12.0
                                            : d % 3 == 1 ? 1.0
                                                         : 0.0) +
                                           (d % 3 == 2 ? m->nodes[d] : -m->nodes[d]);
  ct_surface a = {CT_Q8, 2 * nodes, count, faces, X}, b = a;
  b.faces = faces + 8;
  for (int i = 0; i < 8; i++) faces[8 + i] = faces[i] + nodes;
  flight("two quadratic faces that bulge toward each other", &a, &b, bulge, 60, 10, 7);
}

typedef struct body {
  const char *name;
  ct_brick_kind kind;
  ct_solid_kernel kernel;
  double bent;  /* largest displacement of a node along y */
  int32_t rows; /* elements along z, each .1 high */
} body;

/* A result of two bodies in an order that does not depend on their numbers. */
typedef struct place {
  double x[3], u[3], v[3];
} place;

static int compare_places(const void *a, const void *b)
{
  const double *x = ((const place *)a)->x, *y = ((const place *)b)->x;
  for (int c = 2; c >= 0; c--)
    if (x[c] != y[c]) return x[c] < y[c] ? -1 : 1;
  return 0;
}

/* Two boxes, one of which hits the other, numbered in one of three ways or shuffled: the results at
 * each place. */
static place *impact(const body *form, ct_layers layers, int shuffle_it,
                     ct_optimisations optimisations, int32_t *count)
{
  ct_scene *scene = new_scene();
  ct_mesh *m[2];
  int64_t steps;
  for (int b = 0; b < 2; b++) {
    m[b] = mesh_of(form->kind, (ct_box){.origin = {b == 0 ? -1.0 : 1e-4, 0.013, -0.2},
                                        .size = {1, 0.2, 0.1 * form->rows},
                                        .cells = {10, 2, form->rows},
                                        .layers = layers});
    for (double *x = m[b]->nodes; x < m[b]->nodes + 3 * m[b]->node_count; x += 3)
      x[1] += form->bent * sin(4.0 * x[0] + 3.0 * x[2]);
    if (shuffle_it) {
      ct_mesh *regular = m[b];
      int32_t *to = integers(regular->node_count);
      m[b] = shuffle_mesh(regular, to);
    }
    add_body(scene, b ? "right" : "left", m[b], &STEEL, form->kernel, b ? 0.0 : 1000.0, 0.0, 0.0);
  }
  add_contact_with(scene, 0, m[0], 0, 1, m[1], 1e-4, 0, 1.0, ct_contact_options_default(), 0.0,
                   0.0);
  add_support(scene, 0, m[0], 2, -0.2, "z", 0.0);
  must(ct_scene_set_optimisations, scene, &optimisations);
  set_threads(scene, 2);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 4e-7, .fraction = 0.9}, &steps, NULL);
  ct_state *state = new_state(problem);
  advance(problem, state, steps);
  *count = problem->node_count;
  place *places = room(*count, sizeof *places);
  for (int32_t n = 0; n < *count; n++) {
    memcpy(places[n].x, &problem->reference[3 * n], 24);
    memcpy(places[n].u, &state->displacement[3 * n], 24);
    memcpy(places[n].v, &state->velocity[3 * n], 24);
  }
  qsort(places, (size_t)*count, sizeof *places, compare_places);
  return places;
}

/* The order of numbers changes no result at any place, with and without optimisations. */
static void orders(const body *form)
{
  int32_t count, other;
  place *first = impact(form, CT_LAYERS_Z, 0, (ct_optimisations){1, 1, 1}, &count);
  int moved = 0;
  for (int32_t n = 0; n < count; n++) moved += first[n].x[0] > 0.0 && first[n].v[0] > 500.0;
  tap_ok(moved > 20, "%s: %d nodes of the body that was hit are fast", form->name, moved);
  for (int k = 0; k < 7; k++) {
    ct_optimisations none = {0, 0, 0};
    static const char *names[] = {
        "z, no element skipped", "x",           "x, no element skipped",          "y",
        "y, no element skipped", "z, shuffled", "z, shuffled, no element skipped"};
    place *places = impact(form,
                           k == 0 || k > 4 ? CT_LAYERS_Z
                           : k < 3         ? CT_LAYERS_X
                                           : CT_LAYERS_Y,
                           k > 4, k % 2 == 0 ? none : (ct_optimisations){1, 1, 1}, &other);
    tap_ok(other == count && memcmp(first, places, (size_t)count * sizeof *places) == 0,
           "layers along %s: the same bits at each place", names[k]);
  }
}

int main(void)
{
  free_at_end();
  static const body BODIES[] = {{"hex8", CT_HEX8, CT_KERNEL_AUTO, 0.0, 12},
                                // More nodes in a line than the zeros that a border reads
                                {"hex8, long", CT_HEX8, CT_KERNEL_AUTO, 0.0, 260},
                                {"hex8, bent", CT_HEX8, CT_KERNEL_AUTO, 0.03, 12},
                                {"hex8, reduced", CT_HEX8, CT_KERNEL_REDUCED, 0.03, 12},
                                {"hex20", CT_HEX20, CT_KERNEL_AUTO, 0.0, 12}};
  for (int self = 0; self < 2; self++) {
    plates(CT_HEX8, self);
    plates(CT_HEX20, self);
  }
  quadratic_faces();
  for (int i = 0; i < (int)(sizeof BODIES / sizeof *BODIES); i++) orders(&BODIES[i]);
  return tap_done();
}
