/* Run one scene with chosen optimisations and tell steps, seconds, bytes held and at most on the
 * way there, and a hash of the state, as one line of JSON: scene_loop SCENE SAVINGS STEPS SCENE:
 * plates, plates200, platesz, block, bar, flight; SAVINGS: some of the letters q c p, or -, and h
 * for the histories of ten probes in a scene with contact; STEPS 0: to the end. */
#define _POSIX_C_SOURCE 200809L
#include <libcontact.h>

#include "../tests/c/counting.h"

#include <stdio.h>
#include <time.h>

static double seconds(void)
{
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now); // not the time of others on the same machine
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static ct_error error;

static void need(ct_status status)
{
  if (status == CT_OK) return;
  fprintf(stderr, "%s: %s\n", ct_status_name(status), error.text);
  exit(1);
}

static const ct_material STEEL = {.young = 2.1e5, .poisson = 0.3, .density = 7.8e-9};

/* One box of a scene; its mesh is freed once the scene has its copy. */
typedef struct part {
  ct_box box;
  double speed; /* along x */
} part;

static void add_part(ct_scene *scene, const part *p)
{
  ct_mesh *mesh;
  need(ct_mesh_create_box(CT_HEX8, &p->box, &mesh, &error));
  need(ct_scene_add_body(
      scene, &(ct_scene_body){.mesh = mesh, .material = STEEL, .velocity = {p->speed, 0, 0}}, NULL,
      &error));
  ct_mesh_free(mesh);
}

/* Contact of the face x_max of the first part with x_min of the second. */
static void add_contact(ct_scene *scene, const part *p, double beta)
{
  ct_scene_contact contact = {.body_b = 1, .beta = beta, .options = ct_contact_options_default()};
  int32_t *faces[2], *count[2] = {&contact.face_count_a, &contact.face_count_b};
  for (int b = 0; b < 2; b++) {
    ct_mesh *mesh;
    need(ct_mesh_create_box(CT_HEX8, &p[b].box, &mesh, &error));
    double at = p[b].box.origin[0] + (b == 0 ? p[b].box.size[0] : 0.0);
    *count[b] = ct_mesh_plane_faces(mesh, 0, at, NULL, NULL);
    faces[b] = malloc(4 * (size_t)*count[b] * sizeof(int32_t));
    ct_mesh_plane_faces(mesh, 0, at, faces[b], NULL);
    ct_mesh_free(mesh);
  }
  contact.faces_a = faces[0];
  contact.faces_b = faces[1];
  contact.options.enforcement = CT_ENFORCE_PENALTY;
  need(ct_scene_add_contact(scene, &contact, &error));
  free(faces[0]);
  free(faces[1]);
}

static void add_support(ct_scene *scene, int32_t body, const part *p, int axis, double at)
{
  ct_mesh *mesh;
  need(ct_mesh_create_box(CT_HEX8, &p->box, &mesh, &error));
  int32_t count = ct_mesh_plane_nodes(mesh, axis, at, NULL),
          *nodes = malloc((size_t)count * sizeof *nodes);
  ct_mesh_plane_nodes(mesh, axis, at, nodes);
  ct_scene_support support = {.body = body,
                              .nodes = nodes,
                              .node_count = count,
                              .fixed = {axis == 0, axis == 1, axis == 2}};
  need(ct_scene_add_support(scene, &support, &error));
  free(nodes);
  ct_mesh_free(mesh);
}

/* Fill the scene of a name; answers its end, or 0 when there is none of that name. */
static double fill(ct_scene *scene, const char *name)
{
  double c1, c2;
  ct_material_speeds(&STEEL, &c1, &c2);
  if (strncmp(name, "plates", 6) == 0) {
    // tutorials/scenes/plates.toml, with a softer penalty, as a run near the stable step wants it;
    // numbered in layers along x, across the wave, or along z, with the wave.
    int32_t n = atoi(name + 6) > 0 ? atoi(name + 6) : 100;
    double h = 2.5 / n;
    ct_layers layers = strchr(name, 'z') != NULL ? CT_LAYERS_Z : CT_LAYERS_X;
    part p[2] = {{{{-2.5, 0, 0}, {2.5, h, 2.5}, {n, 1, n}, layers}, 1000.0},
                 {{{0, 0, 0}, {2.5, h, 2.5}, {n, 1, n}, layers}, -1000.0}};
    for (int b = 0; b < 2; b++) add_part(scene, &p[b]);
    add_contact(scene, p, 0.5);
    for (int32_t b = 0; b < 2; b++) {
      add_support(scene, b, &p[b], 2, 0.0);
      add_support(scene, b, &p[b], 1, 0.0);
      add_support(scene, b, &p[b], 1, h);
    }
    return 0.56 * 2.5 / c1;
  }
  if (strcmp(name, "block") == 0) {
    // No contact, no support: a block that is hit nowhere flies.
    part p = {{{0, 0, 0}, {1, 1, 1}, {40, 40, 40}, CT_LAYERS_Z}, 1000.0};
    add_part(scene, &p);
    return 1.0 / c1;
  }
  if (strcmp(name, "bar") == 0) {
    // A bar is hit at its end by another one.
    part p[2] = {{{{-5, 0, 0}, {5, 0.2, 0.2}, {200, 8, 8}, CT_LAYERS_Z}, 1000.0},
                 {{{0, 0, 0}, {5, 0.2, 0.2}, {200, 8, 8}, CT_LAYERS_Z}, 0.0}};
    for (int b = 0; b < 2; b++) add_part(scene, &p[b]);
    add_contact(scene, p, 0.5);
    return 2.5 / c1;
  }
  if (strcmp(name, "flight") == 0) {
    // A bar flies half its length before it meets a plate.
    part p[2] = {{{{-15, 0, 0}, {10, 1, 1}, {40, 8, 8}, CT_LAYERS_Z}, 1e6},
                 {{{0, -2, -2}, {0.5, 5, 5}, {2, 40, 40}, CT_LAYERS_X}, 0.0}};
    for (int b = 0; b < 2; b++) add_part(scene, &p[b]);
    add_contact(scene, p, 0.5);
    return 5.2 / 1e6;
  }
  return 0.0;
}

/* Displacement and velocity of six nodes and of the face in contact, twice, and the force of the
 * contact on both parts. */
static ct_probes *ten_probes(const ct_problem *problem)
{
  enum { POINTS = 6, FACES = 2, ALL = 10 };
  static const int32_t effect = 1;
  char name[ALL][8];
  ct_probe_def def[ALL];
  ct_probes *probes;
  int32_t count = problem->node_count, first = problem->bodies[1].first_node, face_count = 0,
          *all = malloc((size_t)count * sizeof *all), *face = malloc((size_t)count * sizeof *face);
  for (int32_t n = 0; n < count; n++) {
    all[n] = n;
    if (n < first && problem->reference[3 * (size_t)n] == 0.0) face[face_count++] = n;
  }
  for (int i = 0; i < ALL; i++) {
    def[i] = ct_probe_def_default();
    snprintf(name[i], sizeof name[i], "%d", i);
    def[i].name = name[i];
    def[i].take[i < POINTS + FACES ? CT_QUANTITY_DISPLACEMENT : CT_QUANTITY_FORCE] = 1;
    def[i].take[CT_QUANTITY_VELOCITY] = i < POINTS + FACES;
    def[i].nodes = i < POINTS ? &all[i * (count / POINTS)] : i < POINTS + FACES ? face : all;
    def[i].node_count = i < POINTS ? 1 : i < POINTS + FACES ? face_count : first;
    def[i].effects = &effect;
    def[i].effect_count = 1;
  }
  def[ALL - 1].nodes = &all[first];
  def[ALL - 1].node_count = count - first;
  need(ct_probes_create(problem, def, ALL, &probes, &error));
  free(all);
  free(face);
  return probes;
}

/* Of values: the sign of a zero counts for nothing. */
static uint64_t hash(uint64_t h, const double *values, int64_t count)
{
  for (int64_t i = 0; i < count; i++) {
    double value = values[i] + 0.0;
    unsigned char byte[sizeof value];
    memcpy(byte, &value, sizeof value);
    for (size_t k = 0; k < sizeof value; k++) h = (h ^ byte[k]) * 1099511628211ull;
  }
  return h;
}

int main(int count, char **argument)
{
  if (count != 4) return 2;
  ct_scene *scene;
  need(ct_set_allocator(&COUNTING, NULL));
  need(ct_scene_create(&scene, &error));
  ct_scene_time time = {.end = fill(scene, argument[1]), .fraction = 0.99};
  need(ct_scene_set_run_settings(scene, &(ct_run_settings){.clock = seconds}, &error));
  ct_optimisations optimisations = {.sleep = strchr(argument[2], 'q') != NULL,
                                    .shared_stiffness = strchr(argument[2], 'c') != NULL,
                                    .plane_strain = strchr(argument[2], 'p') != NULL};
  const ct_problem *problem;
  int64_t steps;
  ct_stable_step stable;
  ct_state *state;
  need(ct_scene_set_optimisations(scene, &optimisations, &error));
  need(ct_scene_build(scene, &time, &problem, &steps, &stable, &error));
  need(ct_state_create(problem, &state, &error));
  if (atoi(argument[3]) > 0) steps = atoi(argument[3]);
  int64_t elements = 0;
  for (int32_t b = 0; b < problem->body_count; b++)
    elements += problem->bodies[b].mesh->element_count;
  size_t held = counted.held, peak = counted.peak;
  ct_probes *probes = strchr(argument[2], 'h') != NULL ? ten_probes(problem) : NULL;
  double start = seconds();
  need(probes == NULL ? ct_run(problem, state, steps, NULL, 0, &error)
                      : ct_run(state->problem, state, steps,
                               (ct_observer[]){ct_probes_observer(probes)}, 1, &error));
  double loop = seconds() - start;
  uint64_t h = 14695981039346656037ull;
  h = hash(h, state->displacement, 3 * (int64_t)state->node_count);
  h = hash(h, state->velocity, 3 * (int64_t)state->node_count);
  h = hash(h, state->work, state->work_count);
  h = hash(h, state->impulse, state->impulse_count);
  h = hash(h, state->memory, state->memory_count);
  printf("{\"elements\": %lld, \"nodes\": %d, \"steps\": %lld, \"courant\": %.6g, \"seconds\": "
         "%.6g, \"solid\": %.6g, \"contact\": %.6g, \"rest\": %.6g, "
         "\"bytes\": %zu, \"peak\": %zu, \"hash\": \"%016llx\"}\n",
         (long long)elements, (int)problem->node_count, (long long)steps,
         problem->dt / stable.dt_courant, loop, state->effect_seconds[0],
         problem->effect_count > 1 ? state->effect_seconds[1] : 0.0,
         state->effect_seconds[problem->effect_count], held, peak, (unsigned long long)h);
  ct_probes_free(probes);
  ct_state_free(state);
  ct_scene_free(scene);
  return 0;
}
