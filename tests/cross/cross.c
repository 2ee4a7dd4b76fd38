/* Runs whose bits must not depend on the compiler, the machine or the number of threads: one line
 * for each, "name hash", then "speed element updates in a second" of the first one and "seconds" of
 * contact. `cross STEPS THREADS`. Only + - * / and roots are computed, so even the mathematics
 * library has no say. */
#include <libcontact.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static ct_error error;
static int threads = 1;

static void need(ct_status status)
{
  if (status == CT_OK) return;
  printf("%s: %s\n", ct_status_name(status), error.text);
  exit(1);
}

/* FNV-1a over the bytes of the numbers. */
static uint64_t hash(uint64_t h, const double *values, int64_t count)
{
  for (int64_t i = 0; i < count; i++) {
    uint64_t bits;
    memcpy(&bits, &values[i], sizeof bits);
    for (int k = 0; k < 64; k += 8) h = (h ^ (bits >> k & 255)) * 1099511628211u;
  }
  return h;
}

static void report(const char *name, uint64_t h)
{
  printf("%s %08lx%08lx\n", name, (unsigned long)(h >> 32), (unsigned long)(h & 0xffffffffu));
}

static int32_t *outer_faces(const ct_mesh *mesh, int32_t *count)
{
  *count = ct_mesh_outer_faces(mesh, NULL, NULL);
  int32_t *faces = malloc(8 * (size_t)*count * sizeof *faces);
  if (faces != NULL) ct_mesh_outer_faces(mesh, faces, NULL);
  return faces;
}

/* Run a scene with one contact of the outer faces of `mesh` (of body 0; null: its side x_max) and
 * side x_min of body 1, for some steps; returns the seconds. */
static double run(const char *name, ct_scene *scene, const ct_mesh *mesh, double friction,
                  int64_t steps)
{
  ct_scene_contact contact = {.body_b = 1, .side_b = CT_X_MIN, .friction = friction};
  ct_scene_time time = {.end = 1.0, .fraction = 0.9};
  const ct_problem *problem;
  ct_state *state;
  int64_t all;
  int32_t *faces = NULL;
  contact.options = ct_contact_options_default();
  if (mesh == NULL) contact.side_a = CT_X_MAX;
  else contact.faces_a = faces = outer_faces(mesh, &contact.face_count_a);
  need(ct_scene_add_contact(scene, &contact, &error));
  need(ct_scene_build(scene, &time, &problem, &all, NULL, &error));
  need(ct_state_create(problem, &state, &error));
  clock_t start = clock();
  need(ct_run(problem, state, steps, NULL, 0, &error));
  double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
  int64_t n = 3 * (int64_t)problem->node_count;
  report(name, hash(hash(14695981039346656037u, state->displacement, n), state->velocity, n));
  ct_state_free(state);
  ct_scene_free(scene);
  free(faces);
  return seconds;
}

static const ct_material STEEL = {.young = 2.1e5, .poisson = 0.3, .density = 7.8e-9};

static ct_scene *new_scene(void)
{
  ct_scene *scene;
  ct_run_settings settings = {.threads = threads};
  need(ct_scene_create(&scene, &error));
  need(ct_scene_set_run_settings(scene, &settings, &error));
  return scene;
}

/* Two plates of the paper, 2 n^2 elements; returns element updates in a second. */
static double plates(int n, int64_t steps)
{
  ct_scene *scene = new_scene();
  ct_scene_body body = {.material = STEEL, .velocity = {1000}};
  body.box = (ct_box){{-2.5, 0, 0}, {2.5, 2.5 / n, 2.5}, {n, 1, n}, CT_LAYERS_X};
  need(ct_scene_add_body(scene, &body, NULL, &error));
  body.box.origin[0] = 0.0;
  body.velocity[0] = -1000;
  need(ct_scene_add_body(scene, &body, NULL, &error));
  double seconds = run("plates", scene, NULL, 0.0, steps);
  return 2.0 * n * n * (double)steps / (seconds > 0.0 ? seconds : 1.0);
}

/* A mesh with a velocity strikes the side x_min of a block. */
static double strike(const char *name, ct_mesh *mesh, double vx, double vy, double friction,
                     int64_t steps)
{
  ct_scene *scene = new_scene();
  ct_scene_body block = {.material = STEEL};
  block.box = (ct_box){{0, -1.5, -0.75}, {1, 3, 1.5}, {8, 24, 12}, CT_LAYERS_X};
  need(ct_scene_add_body(scene,
                         &(ct_scene_body){.mesh = mesh, .material = STEEL, .velocity = {vx, vy}},
                         NULL, &error));
  need(ct_scene_add_body(scene, &block, NULL, &error));
  double seconds = run(name, scene, mesh, friction, steps);
  ct_mesh_free(mesh);
  return seconds;
}

/* 10^4 closest points of curved faces. */
static void projections(void)
{
  uint64_t h = 14695981039346656037u, seed = 1;
  ct_face face = {CT_Q8,
                  {{-1, -1, 0},
                   {1, -1, 0},
                   {1, 1, 0},
                   {-1, 1, 0.5},
                   {0, -1, 0.25},
                   {1, 0, 0.125},
                   {0, 1, 0.5},
                   {-1, 0, 0}}};
  for (int i = 0; i < 10000; i++) {
    double point[3], out[3];
    for (int c = 0; c < 3; c++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      point[c] = 3.0 * ((double)(seed >> 40) / 16777216.0 - 0.5);
    }
    ct_projection closest;
    (void)ct_project(&face, point, NULL, &closest, NULL);
    out[0] = closest.xi[0], out[1] = closest.xi[1], out[2] = closest.distance;
    h = hash(h, out, 3);
  }
  report("projections", h);
}

int main(int argc, char **argv)
{
  int steps = argc > 1 ? atoi(argv[1]) : 60;
  ct_mesh *mesh;
  if (argc > 2) threads = atoi(argv[2]);
  double speed = plates(90, 18 * steps);
  ct_ring ring = {{-1.002, 0, 0}, {0.8, 1.0}, 0.5, {3, 48, 3}};
  need(ct_mesh_create_ring(CT_HEX8, &ring, &mesh, &error));
  double seconds = strike("ring", mesh, 2e5, 1e5, 0.3, 4 * steps);
  ct_ball ball = {{-1.002, 0, 0}, {0, 1.0}, {4, 24}};
  need(ct_mesh_create_ball(CT_HEX8, &ball, &mesh, &error));
  seconds += strike("hertz", mesh, 1e5, 0, 0.0, 4 * steps);
  projections();
  printf("speed %.0f\nseconds %.3f\n", speed, seconds);
  return 0;
}
