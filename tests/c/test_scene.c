/* Objects that a scene builds, and definitions that it refuses. */
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* Two plates that touch at x = 0; the meshes are kept for more. */
typedef struct plates {
  ct_scene *scene;
  ct_mesh *left, *right;
} plates;

static plates two_plates(double beta)
{
  plates p = {new_scene(), box_mesh(CT_HEX8, -1, 0, 0, 1, 0.25, 1, 4, 1, 4),
              box_mesh(CT_HEX8, 0, 0, 0, 1, 0.25, 1, 4, 1, 4)};
  add_body(p.scene, "left", p.left, &STEEL, CT_KERNEL_AUTO, 1000, 0, 0);
  add_body(p.scene, "right", p.right, &STEEL, CT_KERNEL_AUTO, -1000, 0, 0);
  if (beta > 0.0) add_contact(p.scene, 0, p.left, 0.0, 1, p.right, 0.0, 0, beta);
  return p;
}

static void not_built(ct_scene *scene, ct_scene_time time, ct_status want, const char *word,
                      const char *what)
{
  const ct_problem *problem = NULL;
  int64_t steps = -1;
  ct_stable_step stable;
  ct_error e = {0};
  ct_status status = ct_scene_build(scene, &time, &problem, &steps, &stable, &e);
  tap_ok(status == want && e.code == want && strstr(e.text, word) != NULL && problem == NULL,
         "%s: refused, %s", what, e.text);
}

static void times(void)
{
  plates p = two_plates(4.0);
  ct_scene_time t = {.end = 1e-6, .courant = 0.125}, bad;
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *problem = build(p.scene, t, &steps, &stable);
  double asked = 0.125 * stable.dt_courant, c1, c2;
  ct_material_speeds(&STEEL, &c1, &c2);
  tap_close(stable.dt_courant / (0.25 / c1), 1.0, 1e-13,
            "Courant number 1 is the shortest edge over c1");
  // The fewest whole steps that end with the scene (eq:whole-steps).
  tap_close((double)steps * problem->dt, 1e-6, 1e-20, "%d steps end where the scene ends",
            (int)steps);
  tap_ok(problem->dt <= asked * (1 + 1e-8) && 1e-6 / (double)(steps - 1) > asked,
         "%d steps are the fewest: dt is %.6f of the requested one", (int)steps,
         problem->dt / asked);
  tap_ok(stable.dt < stable.dt_without_contact && stable.dt_without_contact < stable.dt_courant,
         "the contact lowers the stable step, and it is below Courant number 1");
  double eps = 0.0;
  tap_ok(ct_scene_contact_epsilon(p.scene, 0, &eps, NULL) == CT_OK &&
             fabs(eps / (4.0 * 2.1e5 / 0.25) - 1.0) < 1e-13,
         "eps = beta E / h");
  tap_ok(ct_scene_contact_epsilon(p.scene, 1, &eps, NULL) == CT_ERROR_ARGUMENT &&
             ct_scene_contact_epsilon(p.scene, -1, &eps, NULL) == CT_ERROR_ARGUMENT,
         "there is no second contact");

  t.courant = 0.0, t.fraction = 1.0;
  problem = build(p.scene, t, &steps, &stable);
  tap_ok(problem->dt <= stable.dt && problem->dt > 0.5 * stable.dt,
         "the whole stable step is accepted");
  t.fraction = 0.0, t.dt = stable.dt / 3.0, t.end = stable.dt / 3.0 * 17.0;
  problem = build(p.scene, t, &steps, &stable);
  tap_ok(steps == 17, "17 times dt are 17 steps, not 18 (%d)", (int)steps);

  t = (ct_scene_time){.end = 1e-6, .courant = 0.125};
  bad = t, bad.courant = 0.99;
  not_built(p.scene, bad, CT_ERROR_STEP, "above the stable step",
            "a Courant number above the stable one");
  bad = t, bad.courant = 0.0, bad.fraction = 1.01;
  not_built(p.scene, bad, CT_ERROR_STEP, "above the stable step", "1.01 of the stable step");
  bad = t, bad.courant = 0.0, bad.dt = INFINITY;
  not_built(p.scene, bad, CT_ERROR_STEP, "above the stable step", "an infinite step");
  bad = t, bad.courant = 0.0;
  not_built(p.scene, bad, CT_ERROR_ARGUMENT, "exactly one", "no step");
  bad = t, bad.fraction = 0.5;
  not_built(p.scene, bad, CT_ERROR_ARGUMENT, "exactly one", "two steps");
  bad = t, bad.courant = NAN;
  not_built(p.scene, bad, CT_ERROR_ARGUMENT, "exactly one", "a Courant number that is NaN");
  bad = t, bad.end = 0.0;
  not_built(p.scene, bad, CT_ERROR_ARGUMENT, "end", "no end");
  bad = t, bad.end = INFINITY;
  not_built(p.scene, bad, CT_ERROR_ARGUMENT, "end", "an end at infinity");
  ct_error e = {0};
  tap_ok(ct_scene_set_run_settings(p.scene, &(ct_run_settings){.threads = -1}, &e) ==
                 CT_ERROR_ARGUMENT &&
             ct_scene_set_run_settings(p.scene, &(ct_run_settings){.threads = 1025}, &e) ==
                 CT_ERROR_ARGUMENT,
         "-1 threads and 1025 are refused: %s", e.text);
  bad = t, bad.courant = 1e-20;
  not_built(p.scene, bad, CT_ERROR_ARGUMENT, "steps", "more steps than can be counted");
  tap_ok(build(p.scene, t, &steps, &stable) != NULL,
         "after all these errors the scene still builds");
  tap_ok(ct_scene_build(NULL, &t, &problem, &steps, &stable, NULL) == CT_ERROR_ARGUMENT &&
             ct_scene_build(p.scene, NULL, &problem, &steps, &stable, NULL) == CT_ERROR_ARGUMENT,
         "null arguments are refused");

  ct_scene *empty = new_scene();
  not_built(empty, t, CT_ERROR_ARGUMENT, "no bodies", "a scene without bodies");
  ct_scene_free(NULL);
}

static void no_body(const ct_mesh *m, ct_material material, ct_lumping lumping,
                    ct_solid_kernel kernel, double vx, ct_status want, const char *word,
                    const char *what)
{
  ct_scene *scene = new_scene();
  ct_scene_body def = {.name = "plate",
                       .mesh = m,
                       .material = material,
                       .lumping = lumping,
                       .kernel = kernel,
                       .velocity = {vx, 0, 0}};
  ct_error e = {0};
  ct_status status = ct_scene_add_body(scene, &def, NULL, &e);
  if (status == CT_OK) {
    // Errors that only show when masses and forces are computed.
    const ct_problem *problem = NULL;
    int64_t steps;
    ct_stable_step stable;
    ct_scene_time t = {.end = 1e-9, .courant = 0.1};
    status = ct_scene_build(scene, &t, &problem, &steps, &stable, &e);
  }
  tap_ok(status == want && e.code == want && e.body == 0 && strstr(e.text, word) != NULL,
         "%s: refused, %s", what, e.text);
}

static void bodies(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 1, 1),
          *q = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  ct_material bad = STEEL;
  bad.density = -7.8e-9;
  no_body(m, bad, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_ERROR_ARGUMENT, "density",
          "a negative density");
  bad = STEEL, bad.poisson = 0.5;
  no_body(m, bad, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_ERROR_ARGUMENT, "Poisson", "nu = 1/2");
  bad = STEEL, bad.young = 0.0;
  no_body(m, bad, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_ERROR_ARGUMENT, "Young", "no stiffness");
  no_body(m, STEEL, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, NAN, CT_INVALID, "velocity",
          "a velocity that is NaN");
  no_body(q, STEEL, CT_LUMP_ROW_SUM, CT_KERNEL_AUTO, 0, CT_ERROR_UNSUPPORTED, "negative mass",
          "row sum of hex20");
  q->nodes[3 * q->elements[8]] += 1e-3;
  no_body(q, STEEL, CT_LUMP_DEFAULT, CT_KERNEL_BOX, 0, CT_ERROR_UNSUPPORTED, "box kernel",
          "the box kernel for a curved edge");
  double keep = m->nodes[3];
  m->nodes[3] = 0.6 + 2.0;
  no_body(m, STEEL, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_ERROR_GEOMETRY, "element 1 is inverted",
          "an inverted element");
  m->nodes[3] = NAN;
  no_body(m, STEEL, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_INVALID, "node 1", "a NaN in the nodes");
  m->nodes[3] = keep;
  m->elements[3] = 900;
  no_body(m, STEEL, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_ERROR_ARGUMENT, "node 900",
          "a node that does not exist");

  // A node that no element uses has no mass.
  ct_mesh *loose = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  loose->element_count = 1;
  no_body(loose, STEEL, CT_LUMP_DEFAULT, CT_KERNEL_AUTO, 0, CT_ERROR_GEOMETRY, "no element",
          "a node without element");

  ct_scene *scene = new_scene();
  tap_ok(ct_scene_add_body(scene, &(ct_scene_body){.material = STEEL}, NULL, NULL) ==
                 CT_ERROR_ARGUMENT &&
             ct_scene_add_body(scene, NULL, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_scene_create(NULL, NULL) == CT_ERROR_ARGUMENT,
         "null arguments are refused");
}

static void contact_refused(plates *p, ct_scene_contact c, int at_build, ct_status want,
                            const char *word, const char *what)
{
  ct_error e = {0};
  ct_status status = ct_scene_add_contact(p->scene, &c, &e);
  if (at_build && status == CT_OK) {
    const ct_problem *problem = NULL;
    int64_t steps;
    ct_stable_step stable;
    ct_scene_time t = {.end = 1e-9, .courant = 0.1};
    status = ct_scene_build(p->scene, &t, &problem, &steps, &stable, &e);
  }
  tap_ok(status == want && e.code == want && strstr(e.text, word) != NULL, "%s: refused, %s", what,
         e.text);
}

static void contacts(void)
{
  plates p = two_plates(0.0);
  int32_t fa[64], fb[64], wrong[64];
  ct_scene_contact good = {.body_b = 1,
                           .face_count_a = ct_mesh_plane_faces(p.left, 0, 0.0, fa, NULL),
                           .face_count_b = ct_mesh_plane_faces(p.right, 0, 0.0, fb, NULL),
                           .faces_a = fa,
                           .faces_b = fb,
                           .beta = 4.0,
                           .options = ct_contact_options_default()},
                   c;
  c = good, c.options.epsilon = 1.0;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "beta or epsilon, not both",
                  "both beta and epsilon");
  c = good, c.beta = -4.0;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "beta must be 0", "a negative beta");
  c = good, c.beta = NAN;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "beta must be 0", "a beta that is NaN");
  c = good, c.face_count_a = 0;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "list of faces", "a surface without faces");
  c = good, c.faces_b = NULL;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "list of faces", "a face list that does not exist");
  c = good, c.side_a = CT_X_MAX;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "either a list of faces or a side",
                  "a list and a side");
  c = good, c.faces_b = NULL, c.side_b = (ct_box_side)7;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "list of faces", "a side that does not exist");
  c = good, c.body_b = 2;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "no body 2", "a body that does not exist");
  c = good, c.body_a = -1;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "no body -1", "body -1");
  memcpy(wrong, fa, sizeof wrong);
  wrong[5] = p.left->node_count; // of the other body, once the bodies stand one after another
  c = good, c.faces_a = wrong;
  contact_refused(&p, c, 1, CT_ERROR_ARGUMENT, "node", "a face with a node of the other body");

  p = two_plates(0.0);
  memcpy(wrong, fb, sizeof wrong);
  wrong[5] = -1; // the last node of the body before
  c = good, c.faces_b = wrong;
  contact_refused(&p, c, 1, CT_ERROR_ARGUMENT, "node", "a face with a negative node number");

  p = two_plates(0.0);
  c = good, c.options.method = (ct_method)77;
  contact_refused(&p, c, 1, CT_ERROR_ARGUMENT, "77", "an unknown search");

  p = two_plates(0.0);
  c = good, c.beta = INFINITY;
  contact_refused(&p, c, 1, CT_ERROR_ARGUMENT, "penalty", "an infinite beta");

  // Two contacts with a common face on each side are one too many; a face may meet several others.
  p = two_plates(0.0);
  ct_error e = {0};
  c = good, c.face_count_a--;
  must(ct_scene_add_contact, p.scene, &c);
  for (int k = 0; k < 4; k++) wrong[k] = fa[(k + 1) % 4];
  c = good, c.faces_a = wrong, c.face_count_a = 1;
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "contact[0] has faces of both", "a second contact");
  c = (ct_scene_contact){1, 0, good.face_count_b, 1, fb, wrong, .options = good.options};
  contact_refused(&p, c, 0, CT_ERROR_ARGUMENT, "contact[0] has faces of both",
                  "the other way round");
  c = good, c.faces_a = &fa[4 * (good.face_count_a - 1)], c.face_count_a = 1;
  tap_ok(ct_scene_add_contact(p.scene, &c, &e) == CT_OK,
         "another face of the first surface may meet the same second surface");
}

/* The points of a contact of a small box with one of a larger one: their number, and where their
 * area is. */
static int64_t surface_of(const ct_mesh *small, const ct_mesh *large, ct_scene_contact c,
                          double centre[3])
{
  ct_scene *scene = new_scene();
  ct_error e = {0};
  add_body(scene, "small", small, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "large", large, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  must(ct_scene_add_contact, scene, &c);
  const ct_problem *p = build_until(scene, 1e-9, 0.5);
  ct_state *state = new_state(p);
  const ct_contact *contact = ct_state_contact(p, state, 1, &e);
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *points = room(count, sizeof *points);
  double area = 0.0;
  need(ct_contact_points(contact, points, NULL), &e);
  memset(centre, 0, 3 * sizeof *centre);
  for (int64_t q = 0; q < count; q++) {
    if (points[q].side == 0) continue;
    area += points[q].weight;
    for (int a = 0; a < 3; a++) centre[a] += points[q].weight * points[q].position[a];
  }
  for (int a = 0; a < 3; a++) centre[a] /= area;
  return count;
}

/* Each named side of a box of 2 x 3 x 4 cells has its number of faces, with 4 points each, and its
 * area is centred where the side is. */
static void sides(void)
{
  static const double low[3] = {-1, -3, -5}, high[3] = {2, 4, 6};
  static const int faces[3] = {12, 8, 6};
  ct_mesh *small = box_mesh(CT_HEX8, 20, 0, 0, 1, 1, 1, 1, 1, 1),
          *large = box_mesh(CT_HEX8, -1, -3, -5, 3, 7, 11, 2, 3, 4);
  for (int i = 0; i < 6; i++) {
    double centre[3], off = 0.0;
    ct_scene_contact c = {.body_b = 1,
                          .beta = 1.0,
                          .options = ct_contact_options_default(),
                          .side_a = CT_Y_MIN,
                          .side_b = (ct_box_side)(CT_X_MIN + i)};
    int64_t count = surface_of(small, large, c, centre);
    for (int a = 0; a < 3; a++) {
      double want = a != i / 2 ? 0.5 * (low[a] + high[a]) : i % 2 ? high[a] : low[a];
      off = worst(off, centre[a] - want);
    }
    tap_ok(count == 4 + 4 * faces[i / 2] && off < 1e-13, "side %c_%s: %d faces in its plane",
           "xyz"[i / 2], i % 2 ? "max" : "min", faces[i / 2]);
  }
}

static void supports(void)
{
  plates p = two_plates(0.0);
  static const int32_t nodes[2] = {0, 3}, negative[1] = {-1}, beyond[1] = {50};
  ct_scene_support good = {1, nodes, 2, {1, 0, 0}, {0, 0, 0}}, s;
  ct_error e = {0};
  ct_scene_time t = {.end = 1e-9, .courant = 0.1};
  tap_ok(p.right->node_count == 50, "each plate has 50 nodes");
  s = good, s.body = 7;
  tap_ok(ct_scene_add_support(p.scene, &s, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "no body 7") != NULL,
         "a body that does not exist: refused, %s", e.text);
  s = good, s.node_count = 0;
  tap_ok(ct_scene_add_support(p.scene, &s, &e) == CT_ERROR_ARGUMENT, "no nodes: refused, %s",
         e.text);
  for (int k = 0; k < 2; k++) {
    s = good, s.body = k == 0 ? 1 : 0, s.nodes = k == 0 ? negative : beyond, s.node_count = 1;
    ct_status status = ct_scene_add_support(p.scene, &s, &e);
    tap_ok(status == CT_ERROR_ARGUMENT && strstr(e.text, "node") != NULL,
           "node %d of a body with nodes 0 to 49: refused, %s", (int)s.nodes[0], e.text);
    if (status == CT_OK) break;
  }

  p = two_plates(0.0);
  must(ct_scene_add_support, p.scene, &good);
  s = good, s.velocity[0] = 1.0;
  must(ct_scene_add_support, p.scene, &s);
  not_built(p.scene, t, CT_ERROR_ARGUMENT, "velocity", "two velocities for one node");

  p = two_plates(0.0);
  s = good, s.fixed[0] = 0;
  must(ct_scene_add_support, p.scene, &s);
  not_built(p.scene, t, CT_ERROR_ARGUMENT, "component", "a support without components");
}

/* Adding to a scene after it was built, and building again. */
static void built_twice(void)
{
  plates p = two_plates(4.0);
  ct_scene_time t = {.end = 1e-9, .courant = 0.1};
  ct_stable_step before, after;
  build(p.scene, t, NULL, &before);
  for (int k = 0; k < 3; k++)
    add_contact(p.scene, 0, p.left, -(k != 2), 1, p.right, k != 0, 0, 4.0);
  const ct_problem *problem = build(p.scene, t, NULL, &after);
  tap_ok(problem->effect_count == 5 && after.dt < before.dt,
         "three more contacts after a build: five effects and a smaller stable step");
  add_support(p.scene, 0, p.left, 0, -1.0, "xyz", 0.0);
  problem = build(p.scene, t, NULL, &after);
  tap_ok(problem->effect_count == 6 && problem->inverse_mass[0] == 0.0, "and a support after that");
  for (int k = 0; k < 40; k++) add_support(p.scene, 0, p.left, 0, -1.0, "xyz", 0.0);
  for (int k = 0; k < 8; k++)
    add_contact(p.scene, 0, p.left,
                k % 2   ? 0.0
                : k / 4 ? 1.0
                        : 0.25,
                1, p.right,
                k / 2 % 2 ? 0.0
                : k / 4   ? 1.0
                          : 0.25,
                1 + k / 4, 4.0);
}

/* Two plates with an effect that acts at t = 0, a different one in each trial. */
static plates acted_on(int trial)
{
  // The default law solves for the end of the first step, so for the step itself.
  plates p = two_plates(trial % 4 == 2 ? 4.0 : 0.0);
  if (trial % 4 < 2)
    add_contact_with(p.scene, 0, p.left, 0.0, 1, p.right, 0.0, 0, 4.0, ct_contact_options_default(),
                     trial % 4 ? 0.3 : 0.0, 0.0);
  if (trial % 3 == 0) add_weight(p.scene, (weight){.first = 7, .g = {3e8, -1e8, 2e7}});
  if (trial % 3 == 1) add_weight(p.scene, (weight){.g = {-1e8, 0.0, 0.0}, .damping = 1e3});
  if (trial % 5 == 0) add_support(p.scene, 0, p.left, 0, -1.0, "xz", 0.0);
  return p;
}

/* The state that comes with the problem equals one created from it: no bit differs, now or 30 steps
 * later; if the problem is refused there is none. */
static void started(void)
{
  int differ = 0, moved = 0;
  for (int trial = 0; trial < 24; trial++) {
    plates p = acted_on(trial), q = acted_on(trial);
    ct_scene_time t = {.end = 1e-5, .fraction = 0.5};
    set_threads(p.scene, 1 + trial % 3);
    set_threads(q.scene, 1 + trial % 3);
    const ct_problem *later, *problem;
    int64_t steps, count;
    ct_stable_step stable, alone;
    ct_state *made, *state = NULL;
    t.integrator = ct_integrator_default((ct_scheme)(trial / 4 % 4));
    later = build(p.scene, t, &count, &alone);
    made = new_state(later);
    must(ct_scene_start, q.scene, &t, &problem, &steps, &stable, &state);
    advance(later, made, trial % 2 ? 0 : 30);
    advance(problem, state, trial % 2 ? 0 : 30);
    differ += !same_state(made, state) || steps != count || later->dt != problem->dt ||
              memcmp(&stable, &alone, sizeof stable) != 0;
    moved += state->velocity[2] != 0.0 || state->velocity[0] != 1000.0;
    free_state(state);
  }
  tap_ok(differ == 0 && moved > 12,
         "24 scenes with the state of their stable step: the bits of one made later (%d differ)",
         differ);
  plates p = two_plates(4.0);
  ct_scene_time t = {.end = 1e-6, .fraction = 1.5};
  const ct_problem *problem = NULL;
  ct_state *state = NULL;
  int64_t steps = -1;
  tap_ok(ct_scene_start(p.scene, &t, &problem, &steps, NULL, &state, NULL) == CT_ERROR_STEP &&
             problem == NULL && state == NULL && steps == -1,
         "a refused step does not change problem, state and count");
}

/* The problem as requested: nodes one body after another, masses, velocities, names. */
static void contents(void)
{
  plates p = two_plates(4.0);
  ct_scene_time t = {.end = 1e-9, .courant = 0.1};
  char name[100];
  memset(name, 'n', sizeof name - 1);
  name[99] = '\0';
  ct_mesh *far = box_mesh(CT_HEX20, 5, 5, 5, 1, 1, 1, 1, 1, 1);
  add_body(p.scene, name, far, &STEEL, CT_KERNEL_AUTO, 1, 2, 3);
  const ct_problem *problem = build(p.scene, t, NULL, NULL);
  double mass = 0.0;
  int right = problem->node_count == 120 && problem->body_count == 3 &&
              problem->bodies[1].first_node == 50 && problem->bodies[2].first_node == 100;
  for (int n = 0; n < 120; n++) {
    const double *v = &problem->initial_velocity[3 * n], *x = n < 50 ? &p.left->nodes[3 * n]
                                                              : n < 100
                                                                  ? &p.right->nodes[3 * (n - 50)]
                                                                  : &far->nodes[3 * (n - 100)];
    right &= v[0] == (n < 50    ? 1000
                      : n < 100 ? -1000
                                : 1) &&
             v[2] == (n < 100 ? 0 : 3) && memcmp(x, &problem->reference[3 * n], 24) == 0;
    mass += problem->mass[n];
  }
  tap_ok(right, "nodes, coordinates and velocities of three bodies are consecutive");
  tap_close(mass / (7.8e-9 * (0.25 + 0.25 + 1.0)), 1.0, 1e-13, "their masses add up");
  tap_ok(strcmp(problem->bodies[0].name, "left") == 0 && strlen(problem->bodies[2].name) == 63,
         "names are kept, long ones cut");
  tap_ok(strcmp(problem->effects[0]->label, "solid") == 0 &&
             strcmp(problem->effects[1]->label, "contact") == 0 && problem->effect_count == 2,
         "two effects, and none that was not requested");
}

/* A spring on all nodes or a dashpot on some, as a host's effect: force -c times displacement or
 * velocity. */
typedef struct own_data {
  double c, bound;
  int *freed;
} own_data;

static ct_status spring_force(const ct_effect *effect, const ct_view *view, double *force,
                              ct_error *error)
{
  (void)error;
  for (int d = 0; d < 3 * effect->node_count; d++)
    force[d] = -((own_data *)effect->data)->c * view->displacement[d];
  return CT_OK;
}

static ct_status dashpot_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  (void)error;
  for (int i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++)
      force[3 * i + c] = -((own_data *)effect->data)->c * view->velocity[3 * effect->nodes[i] + c];
  return CT_OK;
}

static ct_status own_bound(const ct_effect *effect, const ct_view *view, double *bound,
                           ct_error *error)
{
  (void)view, (void)error;
  *bound = ((own_data *)effect->data)->bound;
  return CT_OK;
}

static void own_freed(void *data) { ++*((own_data *)data)->freed; }

static const ct_effect_calls DASHPOT = {
    .force = dashpot_force, .free_data = own_freed, .bounds = {.rate = own_bound}};

/* A clock that counts its calls. */
static double ticks(void)
{
  static double count;
  return ++count;
}

/* A host's effects: taken over, run, freed once, and refused with the reason. */
static void own_effects(void)
{
  int freed = 0;
  static const int32_t nodes[2] = {0, 7}, outside[2] = {0, 100}, unsorted[2] = {7, 7};
  plates p = two_plates(4.0);
  own_data data = {3.0, 5e7, &freed};
  ct_effect filled = {
      .label = "dashpot", .calls = &DASHPOT, .data = &data, .nodes = nodes, .node_count = 2};
  ct_effect *effect = NULL;
  ct_error e = {0};
  const ct_problem *joined = NULL;
  ct_scene_time t = {.end = 1e-7, .courant = 0.1};
  int64_t steps;
  ct_stable_step without, with;
  build(p.scene, t, &steps, &without);
  must(ct_scene_join, p.scene, &joined);
  tap_ok(joined->node_count == 100 && joined->mass[0] > 0.0,
         "a joined scene has its nodes and masses");
  ct_scene_body late = {.name = "late", .mesh = p.left, .material = STEEL};
  tap_ok(ct_scene_add_body(p.scene, &late, NULL, &e) == CT_ERROR_ARGUMENT, "no further body: %s",
         e.text);
  must(ct_effect_create, &filled, &effect);
  tap_ok(ct_scene_add_effect(p.scene, effect, &e) == CT_OK, "a host's effect is accepted");
  const ct_problem *problem = build(p.scene, t, &steps, &with);
  tap_ok(problem->effect_count == 3 && strcmp(problem->effects[2]->label, "dashpot") == 0,
         "it comes after the contacts");
  double W = 4.0 / (without.dt * without.dt), D = 5e7;
  tap_close(with.dt / ((sqrt(D * D + 4 * W) - D) / W), 1.0, 1e-12,
            "its damping lowers the stable step to the root of 4 - 2 D dt - W dt^2 (%g of it)",
            with.dt / without.dt);
  double omega_squared[3], rate[3], sum = 0.0;
  ct_state *state = new_state(problem);
  for (int k = 0; k < 3; k++) {
    must(ct_stable_contribution, problem, state, k, &omega_squared[k], &rate[k]);
    sum += omega_squared[k];
  }
  tap_close(sum / W, 1.0, 1e-12, "the effects' contributions to the bound add up");
  tap_ok(rate[0] == 0.0 && rate[1] == 0.0 && rate[2] == D && omega_squared[2] == 0.0,
         "the dashpot alone damps, and has no stiffness");
  tap_ok(ct_stable_contribution(problem, state, 3, omega_squared, rate, &e) == CT_ERROR_ARGUMENT,
         "there is no fourth contribution: %s", e.text);
  advance(problem, state, 1);
  tap_ok(state->effect_seconds[0] == 0.0, "without a clock nothing is measured");
  free_state(state);
  must(ct_scene_set_run_settings, p.scene, &(ct_run_settings){.clock = ticks});
  problem = build(p.scene, t, &steps, &with);
  state = new_state(problem);
  advance(problem, state, 5);
  int each_once = state->effect_seconds[3] == 5.0;
  for (int k = 0; k < 3; k++) each_once &= state->effect_seconds[k] == 6.0;
  tap_ok(each_once,
         "a clock that counts its calls finds 5 in the rest of 5 steps and 6 in each "
         "effect, because the first forces are computed twice if one depends on velocity");
  free_state(state);
  tap_ok(freed == 0, "building twice keeps it");
  filled.nodes = outside;
  must(ct_effect_create, &filled, &effect);
  tap_ok(ct_scene_add_effect(p.scene, effect, &e) == CT_ERROR_ARGUMENT && freed == 1,
         "nodes outside: refused and freed, %s", e.text);
  filled.nodes = unsorted;
  tap_ok(ct_effect_create(&filled, &effect, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "must ascend"),
         "nodes not ascending: %s", e.text);
  static const ct_effect_calls forceless = {.free_data = own_freed};
  filled.nodes = nodes, filled.calls = &forceless;
  tap_ok(ct_effect_create(&filled, &effect, &e) == CT_ERROR_ARGUMENT && strstr(e.text, "force"),
         "no force: %s", e.text);
  free_scene(p.scene);
  tap_ok(freed == 2, "the scene frees it once");
}

/* One step factor: amplitude of a spring with a dashpot after 20000 steps of `factor` times the
 * bound of eq. damped-step-bound. */
static double swing(double factor, double w, double d)
{
  static const int32_t nodes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  int freed = 0;
  double mass[8], inverse[24], velocity[24] = {1.0};
  for (int i = 0; i < 8; i++) mass[i] = 2.0;
  for (int i = 0; i < 24; i++) inverse[i] = 0.5;
  own_data spring = {2.0 * w, w, &freed}, dashpot = {2.0 * d, d, &freed};
  static const ct_effect_calls calls = {.force = spring_force, .bounds = {.omega2 = own_bound}};
  ct_effect one = {.label = "spring", .calls = &calls, .data = &spring, .node_count = 8};
  ct_effect two = {
      .label = "dashpot", .calls = &DASHPOT, .data = &dashpot, .nodes = nodes, .node_count = 8};
  const ct_effect *effects[2] = {&one, &two};
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_body body = {.name = "mass", .mesh = mesh, .material = STEEL};
  ct_problem problem = {.node_count = 8,
                        .body_count = 1,
                        .bodies = &body,
                        .reference = mesh->nodes,
                        .mass = mass,
                        .inverse_mass = inverse,
                        .initial_velocity = velocity,
                        .effect_count = 2,
                        .effects = effects,
                        .dt = 1.0};
  ct_stable_step stable;
  must(ct_stable, &problem, NULL, &stable);
  problem.dt = factor * stable.dt;
  ct_state *state = new_state(&problem);
  double top = 0.0;
  for (int i = 0; i < 20000 && top < 1e30; i++) {
    advance(&problem, state, 1);
    top = fmax(top, fabs(state->displacement[0]) * sqrt(w + d * d));
  }
  free_state(state);
  return top;
}

/* The damped bound from both sides. */
static void damped_limit(void)
{
  const double cases[][2] = {{1.0, 0.0}, {1.0, 0.1}, {1.0, 2.0}, {4.0, 30.0}, {1e-6, 1.0}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    double w = cases[i][0], d = cases[i][1], below = swing(0.999, w, d), above = swing(1.002, w, d);
    tap_ok(below < 100.0 && above > 1e20,
           "spring %g and dashpot %g: bounded at 0.999 of the limit (%.3g), not at 1.002 (%.3g)", w,
           d, below, above);
  }
}

/* A body, a box of bricks or a copy of it whose inner nodes were moved. */
static ct_scene *prepared(ct_brick_kind kind, const ct_mesh *mesh, const ct_box *box, int threads,
                          const ct_problem **problem, ct_stable_step *stable, ct_error *e)
{
  ct_scene *scene = new_scene();
  ct_scene_body def = {.mesh = mesh, .kind = kind, .material = STEEL};
  set_threads(scene, threads);
  if (mesh == NULL) def.box = *box;
  int64_t steps;
  ct_scene_time time = {.end = 1e-7, .fraction = 0.5};
  ct_status status = ct_scene_add_body(scene, &def, NULL, e);
  if (status == CT_OK) status = ct_scene_build(scene, &time, problem, &steps, stable, e);
  return status == CT_OK ? scene : NULL;
}

/* Move the nodes inside of a box, by up to a part of an edge. */
static ct_mesh *moved_box(ct_brick_kind kind, const ct_box *box)
{
  ct_mesh *mesh = NULL;
  ct_mesh_create_box(kind, box, &mesh, NULL);
  for (int32_t n = 0; n < mesh->node_count; n++)
    for (int c = 0; c < 3; c++) {
      double *x = &mesh->nodes[3 * n + c], size = box->size[c] / box->cells[c];
      if (*x > box->origin[c] + 0.4 * size && *x < box->origin[c] + box->size[c] - 0.4 * size)
        *x += (kind == CT_HEX8 ? 0.1 : 0.02) * size * sin(1.0 + 7.0 * n + c);
    }
  return later_mesh(mesh);
}

/* The set-up is the same for any number of threads, and so are its errors. */
static void test_threads(void)
{
  static const struct {
    ct_brick_kind kind;
    int cells, moved;
  } bodies[] = {{CT_HEX8, 34, 0}, {CT_HEX8, 34, 1}, {CT_HEX20, 12, 1}, {CT_HEX20, 12, 0}};
  for (int b = 0; b < 4; b++) {
    ct_brick_kind kind = bodies[b].kind;
    int k = bodies[b].cells;
    ct_box box = {.origin = {0, 0, 0}, .size = {1, 1, 1}, .cells = {k, k, k}};
    ct_mesh *mesh = bodies[b].moved ? moved_box(kind, &box) : NULL;
    const ct_problem *one, *other;
    ct_stable_step s = {0}, t = {0};
    ct_error e = {0};
    ct_scene *alone = prepared(kind, mesh, &box, 1, &one, &s, &e);
    for (int threads = 2; alone != NULL && threads <= 8; threads += threads == 2 ? 1 : 5) {
      ct_scene *scene = prepared(kind, mesh, &box, threads, &other, &t, &e);
      const ct_mesh *m = one->bodies[0].mesh;
      size_t n = (size_t)one->node_count, per = (size_t)ct_brick_node_count(kind);
      tap_ok(scene != NULL && other->node_count == one->node_count &&
                 !memcmp(one->reference, other->reference, 3 * n * sizeof(double)) &&
                 !memcmp(m->elements, other->bodies[0].mesh->elements,
                         per * (size_t)m->element_count * sizeof(int32_t)),
             "hex%d, moved %d: %d threads, the same mesh", (int)per, bodies[b].moved, threads);
      tap_ok(scene != NULL && !memcmp(one->mass, other->mass, n * sizeof(double)) &&
                 !memcmp(one->inverse_mass, other->inverse_mass, 3 * n * sizeof(double)) &&
                 s.dt == t.dt && s.dt_courant == t.dt_courant,
             "... the same masses and the same step");
    }
    tap_ok(alone != NULL, "hex%d, moved %d: built", kind == CT_HEX8 ? 8 : 20, bodies[b].moved);
    // Two elements in different shares are turned inside out: the first one is named, and both.
    for (int bad = 0; mesh != NULL && bad < 2; bad++) {
      int32_t *node = &mesh->elements[ct_brick_node_count(kind) *
                                      (bad ? mesh->element_count / 3 : mesh->element_count - 2)];
      for (int a = 0; a < 4; a++) {
        int32_t swap = node[a];
        node[a] = node[a + 4], node[a + 4] = swap;
      }
    }
    ct_error first = {0}, second = {0};
    if (mesh == NULL) continue;
    ct_scene *none[2] = {prepared(kind, mesh, NULL, 1, &one, &s, &first),
                         prepared(kind, mesh, NULL, 3, &one, &s, &second)};
    tap_ok(none[0] == NULL && none[1] == NULL && first.element == mesh->element_count / 3 &&
               second.element == first.element && !strcmp(first.text, second.text),
           "three threads give the same error as one: %s", second.text);
  }
}

/* A mesh of a scene may be copied and outlive it: the copy has no settings of the scene's run. */
static void test_copied_mesh(void)
{
  plates p = two_plates(4.0);
  ct_error e = {0};
  set_threads(p.scene, 2);
  const ct_problem *problem =
      build(p.scene, (ct_scene_time){.end = 1e-9, .courant = 0.1}, NULL, NULL);
  ct_mesh *copy = copy_mesh(problem->bodies[0].mesh);
  tap_ok(problem->bodies[0].mesh->settings == &problem->settings &&
             problem->settings.threads == 2 && copy->settings == NULL,
         "the settings of a run are in its problem, and a body's mesh has them; a copy has none");
  free_scene(p.scene);
  tap_ok(ct_mesh_check(copy, &e) == CT_OK, "a copy is checked without the scene");
}

/* Forces of a small and a larger body go through the same rings, one a thread. */
static void test_rings(void)
{
  ct_state *state[2] = {NULL, NULL};
  ct_scene *scene[2];
  for (int i = 0; i < 2; i++) {
    ct_scene_body def = {.kind = CT_HEX8, .material = STEEL};
    ct_scene_time time = {.end = 1e-7, .fraction = 0.5};
    ct_stable_step stable;
    const ct_problem *problem = NULL;
    int64_t steps;
    scene[i] = new_scene();
    set_threads(scene[i], i == 0 ? 1 : 8);
    for (int b = 0; b < 2; b++) {
      int k = b == 0 ? 10 : 20;
      def.box = (ct_box){.origin = {2.0 * b, 0, 0}, .size = {1, 1, 1}, .cells = {k, k, k}};
      ct_scene_add_body(scene[i], &def, NULL, NULL);
    }
    ct_scene_build(scene[i], &time, &problem, &steps, &stable, NULL);
    ct_state_create(problem, &state[i], NULL);
    for (int64_t d = 0; state[i] != NULL && d < 3 * (int64_t)problem->node_count; d++)
      state[i]->displacement[d] = 1e-3 * sin(1.0 + 7.0 * (double)d);
    if (state[i] != NULL) ct_run(problem, state[i], 3, NULL, 0, NULL);
  }
  tap_ok(state[0] != NULL && state[1] != NULL &&
             !memcmp(state[0]->displacement, state[1]->displacement,
                     3 * (size_t)state[0]->node_count * sizeof(double)) &&
             !memcmp(state[0]->velocity, state[1]->velocity,
                     3 * (size_t)state[0]->node_count * sizeof(double)),
         "a small and a larger box: eight threads give the same motion as one");
  for (int i = 0; i < 2; i++) free_state(state[i]), free_scene(scene[i]);
}

int main(void)
{
  free_at_end();
  times();
  bodies();
  contacts();
  sides();
  supports();
  built_twice();
  started();
  contents();
  own_effects();
  damped_limit();
  test_threads();
  test_copied_mesh();
  test_rings();
  return tap_done();
}
