/* Surfaces that are not searched while they are apart, shared element data, and the order of
 * numbers change no result; test_sleep.c is about sleeping elements. */
#include "../../libcontact/src/contact/contact_internal.h"
#include "../../libcontact/src/step/workspace.h"
#include "bodies.h"
#include "springs.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
static const ct_optimisations NONE = {0, 0, 0};

/* Two plates that approach, wobble, touch and part: the coordinates of the second one at a time
 * from 0 to 1. */
static void fly(const double *reference, int32_t node_count, double time, double *x)
{
  for (int32_t n = 0; n < node_count; n++) {
    const double *X = &reference[3 * n];
    double wobble = 0.2 * sin(9.0 * time) * sin(5.0 * X[1] + 3.0 * X[2] + 20.0 * time),
           right = X[0] > 0.5;
    x[3 * n] = X[0] + 0.5 * wobble - right * 5.1 * sin(3.14159265358979 * time);
    x[3 * n + 1] = X[1] + 0.3 * time;
    x[3 * n + 2] = X[2] + wobble;
  }
}

/* Contact points of a contact that skips searches, and of one that always searches; the searches of
 * the first one are counted (eq:contact-clear). */
static void flight(ct_brick_kind kind, int self)
{
  enum { STEPS = 800 };
  // Of a surface with itself, all faces of a plate share a node: nothing on the same side is near.
  ct_mesh *m[2] = {box_mesh(kind, -1, 0, 0, 1, 1, 1, 1, self ? 2 : 4, self ? 2 : 4),
                   box_mesh(kind, 5, 0.03, -0.02, 1, 1, 1, 1, self ? 2 : 3, 2)};
  int per = ct_face_node_count(ct_brick_face_kind(kind));
  int32_t nodes = m[0]->node_count + m[1]->node_count, faces[8 * 25], count[2];
  double *X = numbers(3 * nodes), *x = numbers(3 * nodes), *mass = numbers(nodes),
         *f[2] = {numbers(3 * nodes), numbers(3 * nodes)};
  memcpy(X, m[0]->nodes, 24 * (size_t)m[0]->node_count);
  memcpy(X + 3 * m[0]->node_count, m[1]->nodes, 24 * (size_t)m[1]->node_count);
  count[0] = ct_mesh_plane_faces(m[0], 0, 0.0, faces, NULL);
  count[1] = ct_mesh_plane_faces(m[1], 0, 5.0, faces + per * count[0], NULL);
  for (int i = per * count[0]; i < per * (count[0] + count[1]); i++) faces[i] += m[0]->node_count;
  for (int n = 0; n < nodes; n++) mass[n] = 1.0;
  ct_surface both = {ct_brick_face_kind(kind), nodes, count[0] + count[1], faces, X}, a = both,
             b = both;
  a.face_count = count[0];
  b.face_count = count[1];
  b.faces = faces + per * count[0];
  ct_contact *c[2];
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 10.0;
  ct_error e;
  for (int k = 0; k < 2; k++) {
    need(self ? ct_contact_create(&both, &both, &options, &c[k], &e)
              : ct_contact_create(&a, &b, &options, &c[k], &e),
         &e);
  }
  int64_t points = ct_contact_point_count(c[0]);
  ct_contact_point *p[2] = {room(points, sizeof **p), room(points, sizeof **p)};
  int same = 0, skipped = 0, touching = 0, looks = 0;
  double last = NAN;
  for (int step = 0; step <= STEPS; step++) {
    double omega[2] = {0.0, 0.0};
    fly(X, nodes, step / (double)STEPS, x);
    c[1]->gaps.side[0].points[0].row.gap = 42.0; // stands only when nobody has searched
    c[0]->gaps.clear = 0.0;                      // the first contact searches in every call
    for (int k = 0; k < 2; k++) {
      c[k]->gaps.side[0].points[1].other = 0; // as an older state may say
      memset(f[k], 0, 24 * (size_t)nodes);
      memset(p[k], 0, (size_t)points * sizeof **p);
      need(ct_contact_update(c[k], x, x, &e), &e);
      if (k == 1 && c[1]->gaps.side[0].points[0].row.gap == 42.0)
        c[1]->gaps.side[0].points[0].row.gap = NAN, skipped++;
      ct_contact_add_force(c[k], f[k], f[k], NULL);
      ct_contact_points(c[k], p[k], NULL);
      if (step % 7 == 0) springs_of(c[k], mass, mass, &omega[k]);
    }
    looks += last != c[1]->gaps.side[0].x_built[0];
    last = c[1]->gaps.side[0].x_built[0];
    touching += ct_contact_energy(c[0]) > 0.0;
    same += memcmp(f[0], f[1], 24 * (size_t)nodes) == 0 &&
            memcmp(p[0], p[1], (size_t)points * sizeof **p) == 0 && omega[0] == omega[1] &&
            ct_contact_energy(c[0]) == ct_contact_energy(c[1]);
  }
  tap_ok(same == STEPS + 1 && touching > 20 && skipped > STEPS / 4,
         "%s plates fly, touch and part, %s: the same bits in %d states, %d of them touching, no "
         "search in %d, %d looks",
         kind == CT_HEX8 ? "linear" : "quadratic", self ? "one surface" : "two surfaces", same,
         touching, skipped, looks);
  fly(X, nodes, 0.0, x);
  need(ct_contact_update(c[1], x, x, &e), &e);
  x[3 * (nodes - 1)] = NAN;
  x[3 * faces[0]] = NAN;
  tap_ok(ct_contact_update(c[1], x, x, &e) == CT_INVALID && e.point == faces[0],
         "a NaN far from all contact is an error");
  for (int k = 0; k < 2; k++) {
    ct_contact_free(c[k]);
    free(p[k]);
    free(f[k]);
    ct_mesh_free(m[k]);
  }
  free(X);
  free(x);
  free(mass);
}

/* The middle of a quadratic face moves three times as far as its nodes if corners and mid-sides
 * move apart: it must not be missed. */
static void bulge(void)
{
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  int32_t faces[16], nodes = m->node_count, count = ct_mesh_plane_faces(m, 0, 1.0, faces, NULL);
  double *X = numbers(6 * nodes), *x = numbers(6 * nodes);
  for (int n = 0; n < nodes; n++)
    for (int c = 0; c < 3; c++)
      X[3 * n + c] = m->nodes[3 * n + c],
                X[3 * (nodes + n) + c] =
                    c == 2 ? m->nodes[3 * n + c] : (c == 0 ? 12.0 : 1.0) - m->nodes[3 * n + c];
  ct_surface a = {CT_Q8, 2 * nodes, count, faces, X}, b = a;
  int32_t turned[8];
  for (int i = 0; i < 8; i++) turned[i] = faces[i] + nodes;
  b.faces = turned;
  ct_contact *c[2];
  ct_contact_options options = ct_contact_options_default();
  ct_error e;
  options.epsilon = 1.0;
  int same = 0, touching = 0;
  for (int k = 0; k < 2; k++) {
    need(ct_contact_create(&a, &b, &options, &c[k], &e), &e);
  }
  for (int step = 0; step <= 60; step++) {
    memcpy(x, X, 48 * (size_t)nodes);
    for (int i = 0; i < 8; i++) {
      x[3 * faces[i]] += (i < 4 ? -1.0 : 1.0) * 0.04 * step;
      x[3 * turned[i]] += (i < 4 ? 1.0 : -1.0) * 0.04 * step;
    }
    c[0]->gaps.clear = 0.0; // the first contact searches in every call
    for (int k = 0; k < 2; k++) need(ct_contact_update(c[k], x, x, &e), &e);
    same += ct_contact_energy(c[0]) == ct_contact_energy(c[1]);
    touching += ct_contact_energy(c[0]) > 0.0;
  }
  tap_ok(same == 61 && touching > 10,
         "two quadratic faces that bulge toward each other touch in %d of 61 states", touching);
  for (int k = 0; k < 2; k++) ct_contact_free(c[k]);
  free(X);
  free(x);
  ct_mesh_free(m);
}

/* Force and energy of a box, many cells long or thin, for random displacements that are equal in
 * parts of it: with and without tables, any number of threads. */
static void lattices(void)
{
  // The ring of the last two has room for half a block beside what nodes wait for.
  static const int CELLS[][3] = {{1, 1, 1},  {1, 1, 300}, {300, 1, 1},  {1, 300, 1},
                                 {30, 7, 9}, {7, 40, 2},  {100, 1, 13}, {3, 3, 200},
                                 {13, 1, 1}, {1, 9, 70},  {20, 18, 6},  {8, 110, 3}};
  ct_error e;
  for (int i = 0; i < (int)(sizeof CELLS / sizeof *CELLS); i++) {
    const int *n = CELLS[i];
    ct_mesh *m = box_mesh(CT_HEX8, -1, 2, 3, 0.1 * n[0], 0.2 * n[1], 0.3 * n[2], n[0], n[1], n[2]);
    ct_optimisations on = (ct_optimisations){1, 1, 1};
    double *u = numbers(3 * m->node_count),
           *f[2] = {numbers(3 * m->node_count), numbers(3 * m->node_count)}, energy[2] = {0, 0};
    int same = 0, tried = 0;
    for (int threads = 1; threads <= 5; threads += 2) {
      const ct_run_settings prepared = {.threads = threads == 5 ? 2 : threads},
                            settings = {.threads = threads};
      m->settings = &prepared;
      ct_solid_body block = {.mesh = m, .material = STEEL, .optimisations = &NONE};
      ct_effect *effect[2];
      void *scratch[2];
      for (int k = 0; k < 2; k++, block.optimisations = &on) {
        need(create_solid(&block, 1, &effect[k], &e), &e);
        need(effect[k]->calls->create_scratch(effect[k], &scratch[k], &e), &e);
      }
      for (int turn = 0; turn < 6; turn++, tried++) {
        // From the first moving node on, until a last one.
        int first = pick(m->node_count),
            last = turn == 0 ? m->node_count : first + pick(m->node_count - first);
        for (int d = 0; d < 3 * m->node_count; d++)
          u[d] = d >= 3 * first && d < 3 * last ? uniform(1e-3) : 0.3 * (d % 3) + turn;
        for (int k = 0; k < 2; k++) {
          ct_view view = {.settings = &settings, .displacement = u, .scratch = scratch[k]};
          need(effect[k]->calls->force(effect[k], &view, f[k], &e), &e);
          need(effect[k]->calls->energy(effect[k], &view, &energy[k], &e), &e);
        }
        same += memcmp(f[0], f[1], 24 * (size_t)m->node_count) == 0 && energy[0] == energy[1];
      }
      for (int k = 0; k < 2; k++) {
        effect[k]->calls->free_scratch(scratch[k]);
        ct_effect_free(effect[k]);
      }
    }
    tap_ok(same == tried, "%d x %d x %d cells: the same force and energy without tables", n[0],
           n[1], n[2]);
    free(u);
    free(f[0]);
    free(f[1]);
    ct_mesh_free(m);
  }
}

/* A distorted box with shuffled numbers: its forces and energies are those of the tables, and those
 * of the box in its order. `turned`: the reference axes of its elements differ, so that octants of
 * nodes have several elements, in the order of their numbers (eq:order-rows). */
static void shuffled(ct_solid_kernel kernel, int turned, const int cells[3])
{
  ct_error e;
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 0.1 * cells[0], 0.1 * cells[1], 0.1 * cells[2], cells[0],
                        cells[1], cells[2]);
  distort(m, 0.01);
  if (turned) turn_elements(m);
  int32_t nodes = m->node_count, *to = integers(nodes);
  ct_mesh *s = shuffle_mesh(m, to);
  double *u = numbers(3 * nodes), *moved = numbers(3 * nodes), energy[3], control[3] = {0.0},
         *f[3] = {numbers(3 * nodes), numbers(3 * nodes), numbers(3 * nodes)};
  ct_optimisations on = {1, 1, 1};
  int same = 0, alike = 0, tried = 0;
  for (int threads = 1; threads <= 3; threads++) {
    const ct_run_settings settings = {.threads = threads};
    m->settings = s->settings = &settings;
    ct_effect *effect[3], *hourglass;
    void *scratch[3];
    for (int k = 0; k < 3; k++) {
      ct_solid_body block = {.mesh = k == 0 ? m : s,
                             .material = STEEL,
                             .kernel = kernel,
                             .optimisations = k == 2 ? &on : &NONE};
      need(create_solid(&block, 1, &effect[k], &e), &e);
      need(effect[k]->calls->create_scratch(effect[k], &scratch[k], &e), &e);
    }
    for (int turn = 0; turn < 4; turn++, tried++) {
      for (int d = 0; d < 3 * nodes; d++) u[d] = uniform(1e-3) + 0.3 * (d % 3) * turn;
      for (int32_t n = 0; n < nodes; n++) memcpy(&moved[3 * to[n]], &u[3 * n], 24);
      for (int k = 0; k < 3; k++) {
        ct_view view = {
            .settings = &settings, .displacement = k == 0 ? u : moved, .scratch = scratch[k]};
        need(effect[k]->calls->force(effect[k], &view, f[k], &e), &e);
        need(effect[k]->calls->energy(effect[k], &view, &energy[k], &e), &e);
        if (kernel != CT_KERNEL_REDUCED) continue;
        need(ct_solid_create_hourglass(effect[k], &hourglass, &e), &e);
        need(hourglass->calls->energy(hourglass, &view, &control[k], &e), &e);
        ct_effect_free(hourglass);
      }
      double round = turned ? 1e-13 : 0.0, size = largest(f[0], 3 * nodes);
      same += apart(f[1], f[2], NULL, nodes) == 0.0 && energy[1] == energy[2] &&
              control[1] == control[2];
      alike += size > 0.0 && apart(f[0], f[2], to, nodes) <= round * size &&
               fabs(energy[0] - energy[2]) <= round * energy[0];
    }
    for (int k = 0; k < 3; k++) {
      effect[k]->calls->free_scratch(scratch[k]);
      ct_effect_free(effect[k]);
    }
  }
  tap_ok(same == tried && alike == tried,
         "%d x %d x %d cells, shuffled%s%s: forces and energies of tables in %d of %d, of the "
         "order of the box in %d",
         cells[0], cells[1], cells[2], turned ? " and turned" : "",
         kernel == CT_KERNEL_REDUCED ? ", reduced" : "", same, tried, alike);
  for (int k = 0; k < 3; k++) free(f[k]);
  free(u);
  free(moved);
  free(to);
  ct_mesh_free(s);
  ct_mesh_free(m);
}

/* A shuffled bar whose end is pulled: most of it sleeps, and the motion is that without sleep. */
static void shuffled_bar(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 6, 0.2, 0.2, 60, 2, 2);
  int32_t *to = integers(m->node_count);
  ct_mesh *s = shuffle_mesh(m, to);
  double *v = numbers(3 * s->node_count);
  ct_state *state[2];
  ct_scene *scene[2];
  ct_error e;
  for (int32_t n = 0; n < s->node_count; n++) v[3 * n] = s->nodes[3 * n] < 0.01 ? -100.0 : 0.0;
  for (int k = 0; k < 2; k++) {
    scene[k] = new_scene();
    ct_optimisations o = {.sleep = k, .shared_stiffness = 1};
    add_moving_body(scene[k], "bar", s, &STEEL, CT_KERNEL_AUTO, v);
    need(ct_scene_set_optimisations(scene[k], &o, &e), &e);
    const ct_problem *problem =
        build(scene[k], (ct_scene_time){.end = 1e-3, .fraction = 0.9}, NULL, NULL);
    state[k] = new_state(problem);
    advance(problem, state[k], 20);
  }
  int64_t slept = state[1]->element_updates[1], all = 20 * (int64_t)s->element_count;
  tap_ok(apart(state[0]->displacement, state[1]->displacement, NULL, s->node_count) == 0.0 &&
             slept > all / 2 && slept < all,
         "a shuffled bar, pulled for 20 steps: the same values, although %d of %d updates are left "
         "out",
         (int)slept, (int)all);
  for (int k = 0; k < 2; k++) {
    ct_state_free(state[k]);
    ct_scene_free(scene[k]);
  }
  free(v);
  free(to);
  ct_mesh_free(s);
  ct_mesh_free(m);
}

/* Two blocks with orders of their own collide: the state after some steps, from a state or from the
 * start. */
static ct_state *collision(ct_scene **scene, ct_mesh *const m[2], double side, int threads,
                           int64_t steps, const ct_state *from)
{
  ct_error e;
  *scene = new_scene();
  for (int b = 0; b < 2; b++)
    add_body(*scene, b ? "right" : "left", m[b], &STEEL, CT_KERNEL_AUTO, b ? 0.0 : 1000.0,
             b ? side : 0.0, 0.0);
  add_contact_with(*scene, 0, m[0], 0.0, 1, m[1], 0.0, 0, 1.0, ct_contact_options_default(), 0.0,
                   0.0);
  set_threads(*scene, threads);
  const ct_problem *problem = build(*scene, (ct_scene_time){.end = 1.0, .dt = 2e-9}, NULL, NULL);
  ct_state *state = new_state(problem);
  if (from != NULL) need(ct_state_copy(problem, from, state, &e), &e);
  advance(problem, state, steps);
  return state;
}

/* Threads that share several such blocks, a restart and a mirror. */
static void shuffled_collision(void)
{
  enum { STEPS = 30 };
  ct_mesh *m[2], *image[2];
  for (int b = 0; b < 2; b++) {
    // Each is enough work for two threads.
    ct_mesh *box = box_mesh(CT_HEX8, b - 1, 0.1 * b, 0.1 * b, 1, 1 - 0.2 * b, 1, 20, 11 - b, 12);
    int32_t *to = integers(box->node_count);
    distort_inside(box, 0.005);
    m[b] = shuffle_mesh(box, to);
    image[b] = mirror_mesh(m[b], 1);
    free(to);
    ct_mesh_free(box);
  }
  ct_scene *scene[5];
  ct_state *one = collision(&scene[0], m, 300.0, 1, STEPS, NULL),
           *three = collision(&scene[1], m, 300.0, 3, STEPS, NULL),
           *half = collision(&scene[2], m, 300.0, 1, STEPS / 3, NULL),
           *rest = collision(&scene[3], m, 300.0, 2, STEPS - STEPS / 3, half),
           *mirrored = collision(&scene[4], image, -300.0, 2, STEPS, NULL);
  double pushed = 0.0;
  for (int32_t n = m[0]->node_count; n < one->node_count; n++)
    pushed = fmax(pushed, one->velocity[3 * n]);
  tap_ok(pushed > 100.0 && same_state(one, three) && same_state(one, rest),
         "two shuffled blocks collide (%.0f): three threads and a restart have the same bits",
         pushed);
  int64_t faults = mirror_faults(one->displacement, mirrored->displacement, one->node_count, 1);
  tap_ok(faults == 0, "the mirror image has them, too, except for %d", (int)faults);
  ct_state *states[5] = {one, three, half, rest, mirrored};
  for (int i = 0; i < 5; i++) ct_state_free(states[i]), ct_scene_free(scene[i]);
  for (int b = 0; b < 2; b++) ct_mesh_free(m[b]), ct_mesh_free(image[b]);
}

static void shuffles(void)
{
  static const int CELLS[][3] = {{9, 7, 16}, {1, 1, 1}, {3, 1, 2}, {30, 2, 3}, {11, 12, 13}};
  for (int i = 0; i < (int)(sizeof CELLS / sizeof *CELLS); i++)
    for (int k = 0; k < 4; k++)
      shuffled(k < 2 ? CT_KERNEL_AUTO : CT_KERNEL_REDUCED, k % 2, CELLS[i]);
  shuffled_bar();
  shuffled_collision();
}

/* A scene without contact has no memory, no work and no nodes of a contact. */
static void without_contact(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene_with("block", m, &STEEL, CT_KERNEL_AUTO, 1, 0, 0);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1e-6, .fraction = 0.9}, NULL, NULL);
  ct_state *state = new_state(problem);
  tap_ok(problem->effect_count == 1 && state->memory_count == 0 && state->impulse_count == 0 &&
             state->work_count == 3 * m->node_count && state->workspace->shared_count == 0,
         "a scene without contact stores nothing for it");
  close_run(state, scene, m);
}

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
static place *impact(ct_brick_kind kind, ct_layers layers, int shuffle_it,
                     ct_optimisations optimisations, int32_t *count)
{
  ct_error e;
  ct_scene *scene = new_scene();
  ct_mesh *m[2];
  int64_t steps;
  for (int b = 0; b < 2; b++) {
    m[b] = mesh_of(
        kind, (ct_box){{b == 0 ? -1.0 : 1e-4, 0.013, -0.2}, {1, 0.2, 1.2}, {10, 2, 12}, layers});
    if (shuffle_it) {
      ct_mesh *regular = m[b];
      int32_t *to = integers(regular->node_count);
      m[b] = shuffle_mesh(regular, to);
      free(to);
      ct_mesh_free(regular);
    }
    add_body(scene, b ? "right" : "left", m[b], &STEEL, CT_KERNEL_AUTO, b ? 0.0 : 1000.0, 0.0, 0.0);
  }
  add_contact_with(scene, 0, m[0], 0, 1, m[1], 1e-4, 0, 1.0, ct_contact_options_default(), 0.0,
                   0.0);
  add_support(scene, 0, m[0], 2, -0.2, "z", 0.0);
  need(ct_scene_set_optimisations(scene, &optimisations, &e), &e);
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
  ct_state_free(state);
  ct_scene_free(scene);
  for (int b = 0; b < 2; b++) ct_mesh_free(m[b]);
  return places;
}

/* The order of numbers changes no result at any place, with and without optimisations. */
static void orders(ct_brick_kind kind)
{
  int32_t count, other;
  place *first = impact(kind, CT_LAYERS_Z, 0, (ct_optimisations){1, 1, 1}, &count);
  int moved = 0;
  for (int32_t n = 0; n < count; n++) moved += first[n].x[0] > 0.0 && first[n].v[0] > 500.0;
  tap_ok(moved > 20, "%s: %d nodes of the body that was hit are fast",
         kind == CT_HEX8 ? "hex8" : "hex20", moved);
  for (int k = 0; k < 7; k++) {
    ct_optimisations none = {0, 0, 0};
    static const char *names[] = {
        "z, no element skipped", "x",           "x, no element skipped",          "y",
        "y, no element skipped", "z, shuffled", "z, shuffled, no element skipped"};
    place *places = impact(kind,
                           k == 0 || k > 4 ? CT_LAYERS_Z
                           : k < 3         ? CT_LAYERS_X
                                           : CT_LAYERS_Y,
                           k > 4, k % 2 == 0 ? none : (ct_optimisations){1, 1, 1}, &other);
    tap_ok(other == count && memcmp(first, places, (size_t)count * sizeof *places) == 0,
           "layers along %s: the same bits at each place", names[k]);
    free(places);
  }
  free(first);
}

int main(void)
{
  for (int self = 0; self < 2; self++) {
    flight(CT_HEX8, self);
    flight(CT_HEX20, self);
  }
  bulge();
  lattices();
  shuffles();
  orders(CT_HEX8);
  orders(CT_HEX20);
  without_contact();
  return tap_done();
}
