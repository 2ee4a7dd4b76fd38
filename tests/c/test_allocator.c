/* The allocator of a host: a scene with all kinds of effects takes all its memory from it and
 * returns it, also if any one of its requests fails. */
#include "bodies.h"
#include "counting.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 1.0},
                         RUBBER = {900.0, 0.3, 1.0, CT_NEO_HOOKEAN};

/* All objects, so that they can be freed wherever their creation has ended. */
typedef struct world {
  ct_mesh *mesh[2];
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state, *copy;
  ct_monitor *monitor;
} world;

static void end(world *w)
{
  ct_monitor_free(w->monitor);
  ct_state_free(w->copy);
  close_run(w->state, w->scene, NULL);
  for (int b = 0; b < 2; b++) ct_mesh_free(w->mesh[b]);
}

/* Two cubes of 2 x 2 x 2 cells, one 0.01 above the other, the upper one of rubber. */
static ct_status add_bodies(world *w, ct_error *e)
{
  static const double velocity[2][3] = {{0, 0, 0}, {0, 0.5, -4}};
  static const char *names[2] = {"below", "above"};
  const ct_material *material[2] = {&SOFT, &RUBBER};
  ct_status status = ct_scene_create(&w->scene, e);
  for (int b = 0; status == CT_OK && b < 2; b++) {
    ct_box box = {.origin = {0, 0, 1.01 * b}, .size = {1, 1, 1}, .cells = {2, 2, 2}};
    status = ct_mesh_create_box(CT_HEX8, &box, &w->mesh[b], e);
    ct_scene_body body = {.name = names[b], .mesh = w->mesh[b], .material = *material[b]};
    memcpy(body.velocity, velocity[b], sizeof velocity[b]);
    if (status == CT_OK) status = ct_scene_add_body(w->scene, &body, NULL, e);
  }
  return status;
}

/* Faces of a body in z = `at`: node numbers of its own mesh; negative counts are statuses. */
static ct_status faces_at(const ct_mesh *mesh, double at, int32_t *faces, int32_t *count)
{
  *count = ct_mesh_plane_faces(mesh, 2, at, faces, NULL);
  return *count < 0 ? (ct_status) - *count : CT_OK;
}

/* A contact with friction between the two, and supports below. */
static ct_status join_bodies(world *w, ct_error *e)
{
  int32_t top[96], bottom[96], nodes[27];
  ct_scene_contact contact = {.body_a = 0, .body_b = 1, .faces_a = top, .faces_b = bottom};
  contact.beta = 1.0;
  contact.friction = 0.3;
  contact.options = ct_contact_options_default();
  ct_status status = faces_at(w->mesh[0], 1.0, top, &contact.face_count_a);
  if (status == CT_OK) status = faces_at(w->mesh[1], 1.01, bottom, &contact.face_count_b);
  if (status == CT_OK) status = ct_scene_add_contact(w->scene, &contact, e);
  ct_scene_support support = {.body = 0, .nodes = nodes, .fixed = {0, 1, 0}};
  support.node_count = ct_mesh_plane_nodes(w->mesh[0], 0, 0.0, nodes);
  if (status == CT_OK) status = ct_scene_add_support(w->scene, &support, e);
  if (status == CT_OK) status = ct_scene_join(w->scene, &w->problem, e);
  return status;
}

/* A factory has returned `status`: add its effect to the scene. */
static ct_status take(world *w, ct_status status, ct_effect **effect, ct_error *e)
{
  return status == CT_OK ? ct_scene_add_effect(w->scene, *effect, e) : status;
}

/* Effects on faces or nodes below: an obstacle, a prescribed motion, absorbing faces, a tie, a
 * load.
 */
static ct_status add_boundaries(world *w, ct_error *e)
{
  static const double time[2] = {0, 1}, factor[2] = {0, 1};
  const ct_amplitude ramp = {2, time, factor};
  int32_t bottom[96], count, nodes[27];
  ct_effect *effect = NULL;
  ct_status status = faces_at(w->mesh[0], 0.0, bottom, &count);
  if (status != CT_OK) return status;
  ct_obstacle_def obstacle = {COOKIE,
                              .shape = CT_OBSTACLE_PLANE,
                              .axis = {0, 0, 1},
                              .epsilon = 900.0,
                              .enforcement = ct_contact_options_default().enforcement,
                              .kind = CT_Q4,
                              .face_count = count,
                              .faces = bottom};
  status = take(w, ct_obstacle_create_effect(&obstacle, w->problem, &effect, e), &effect, e);
  if (status != CT_OK) return status;
  ct_absorb_def absorb = {COOKIE, .kind = CT_Q4, .face_count = count, .faces = bottom};
  status = take(w, ct_absorb_create_effect(&absorb, w->problem, &effect, e), &effect, e);
  if (status != CT_OK) return status;
  ct_tie_def tie = {COOKIE,           {CT_Q4, CT_Q4}, {count, count},
                    {bottom, bottom}, .epsilon = 1.0, .reach = 1.0};
  status = take(w, ct_tie_create_effect(&tie, w->problem, &effect, e), &effect, e);
  if (status != CT_OK) return status;
  ct_load_def load = {COOKIE, .kind = CT_Q4, .face_count = count, .faces = bottom};
  load.pressure = 1.0;
  load.amplitude = ramp;
  status = take(w, ct_load_create_effect(&load, w->problem, &effect, e), &effect, e);
  if (status != CT_OK) return status;
  ct_motion motion = {.nodes = nodes, .fixed = {1, 0, 0}, .displacement = {0.01, 0, 0}};
  motion.node_count = ct_mesh_plane_nodes(w->mesh[0], 0, 1.0, nodes);
  motion.amplitude = ramp;
  ct_motion_def path = {COOKIE, .motions = &motion, .motion_count = 1};
  return take(w, ct_motion_create_effect(&path, w->problem, &effect, e), &effect, e);
}

/* Effects on all nodes, gravity and damping, and viscosity of the body with small strain. */
static ct_status add_fields(world *w, ct_error *e)
{
  static const int32_t below = 0;
  ct_effect *effect = NULL;
  ct_gravity_def gravity = {COOKIE, .acceleration = {0, 0, -10}};
  ct_damping_def damping = {COOKIE, .rate = 0.1};
  ct_viscosity_def viscosity = {COOKIE, .linear = 0.06, .quadratic = 1.2, .bodies = &below,
                                .body_count = 1};
  ct_status status =
      take(w, ct_gravity_create_effect(&gravity, w->problem, &effect, e), &effect, e);
  if (status == CT_OK)
    status = take(w, ct_damping_create_effect(&damping, w->problem, &effect, e), &effect, e);
  if (status == CT_OK)
    status = take(w, ct_viscosity_create_effect(&viscosity, w->problem, &effect, e), &effect, e);
  return status;
}

/* Build, step until the bodies touch, compute what a record needs, continue on a copy. */
static ct_status run(world *w, ct_error *e)
{
  const ct_scene_time time = {.end = 0.02, .fraction = 0.5};
  ct_monitor_options options = ct_monitor_options_default();
  ct_stable_step stable;
  ct_energy energy;
  int64_t steps = 0;
  ct_status status = ct_scene_build(w->scene, &time, &w->problem, &steps, &stable, e);
  if (status == CT_OK) status = ct_state_create(w->problem, &w->state, e);
  options.stable = stable.dt;
  if (status == CT_OK) status = ct_monitor_create(w->problem, w->state, &options, &w->monitor, e);
  if (status == CT_OK)
    status = ct_run(w->state->problem, w->state, steps,
                    (ct_observer[]){ct_monitor_observer(w->monitor)}, 1, e);
  if (status == CT_OK) status = ct_energy_of(w->problem, w->state, &energy, e);
  if (status == CT_OK) status = ct_state_create(w->problem, &w->copy, e);
  if (status == CT_OK) status = ct_state_copy(w->problem, w->state, w->copy, e);
  if (status == CT_OK) status = ct_run(w->problem, w->copy, 2, NULL, 0, e);
  return status;
}

static ct_status make(world *w, ct_error *e)
{
  ct_status status = add_bodies(w, e);
  if (status == CT_OK) status = join_bodies(w, e);
  if (status == CT_OK) status = add_boundaries(w, e);
  if (status == CT_OK) status = add_fields(w, e);
  return status == CT_OK ? run(w, e) : status;
}

/* Returns the number of requests. */
static long all_given_back(double *moved)
{
  world w = {0};
  ct_error error = {0};
  tap_ok(make(&w, &error) == CT_OK, "a scene with all effects runs: %s", error.text);
  tap_ok(momentum_of(w.problem, w.state, 0).contact_impulse[2] < 0.0, "the bodies have met");
  tap_ok(counted.calls > 0 && counted.blocks > 0, "in the host's memory: %zu bytes", counted.held);
  *moved = w.copy->displacement[3 * w.problem->node_count - 1];
  end(&w);
  tap_ok(counted.blocks == 0 && counted.held == 0, "all %ld blocks are freed", counted.calls);
  return counted.calls;
}

static void each_request_fails(long requests)
{
  long wrong = 0, passed = 0, leaked = 0, unnamed = 0;
  for (long n = 0; n < requests; n++) {
    world w = {0};
    ct_error error = {0};
    counted = (counting){.last_call = n};
    ct_status status = make(&w, &error);
    end(&w);
    passed += status == CT_OK;
    wrong += status != CT_OK && status != CT_ERROR_MEMORY;
    unnamed += status != CT_OK && error.code != CT_OK && error.code != status;
    leaked += counted.blocks != 0;
    if (status != CT_OK && status != CT_ERROR_MEMORY)
      printf("# request %ld: %s: %s\n", n, ct_status_name(status), error.text);
    if (status == CT_OK) printf("# request %ld: went through\n", n);
  }
  tap_ok(wrong == 0, "each call without memory returns that status: %ld return another one", wrong);
  tap_ok(passed == 0, "and reports it: %ld of %ld succeed", passed, requests);
  tap_ok(unnamed == 0, "the error has the code of the call: %ld have another", unnamed);
  tap_ok(leaked == 0, "earlier objects are freed: %ld leak", leaked);
  counted = (counting){.last_call = -1};
}

static void arguments(void)
{
  ct_allocator half = COUNTING;
  half.release = NULL;
  tap_ok(ct_set_allocator(&half, NULL) == CT_ERROR_ARGUMENT,
         "an allocator without release is refused");
  half = COUNTING;
  half.allocate = NULL;
  tap_ok(ct_set_allocator(&half, NULL) == CT_ERROR_ARGUMENT,
         "an allocator without allocate is refused");
  long before = counted.calls;
  ct_mesh_free(box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1));
  tap_ok(counted.calls > before && counted.blocks == 0, "and the previous one stays");
}

/* An allocator that gives zeros, and says so. */
static void *clean_allocate(size_t size, void *context)
{
  void *memory = counting_allocate(size, context);
  return memory == NULL ? NULL : memset(memory, 0, size);
}

int main(void)
{
  double moved[3];
  ct_allocator clean = COUNTING;
  world w = {0};
  ct_error error = {0};
  tap_ok(ct_set_allocator(&COUNTING, NULL) == CT_OK, "a host sets its allocator");
  long requests = all_given_back(&moved[0]);
  each_request_fails(requests);
  arguments();
  clean.allocate = clean_allocate, clean.zeroes = 1;
  tap_ok(ct_set_allocator(&clean, NULL) == CT_OK, "one that gives zeros");
  all_given_back(&moved[2]);
  counted.calls = 0;
  tap_ok(ct_set_allocator(NULL, NULL) == CT_OK && make(&w, &error) == CT_OK && counted.calls == 0,
         "null: the C library's allocator again");
  moved[1] = w.copy->displacement[3 * w.problem->node_count - 1];
  tap_ok(moved[0] == moved[1] && moved[2] == moved[1], "and the same bits");
  end(&w);
  return tap_done();
}
