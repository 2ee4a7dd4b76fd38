/* A fuzz target for the whole library: any bytes are a scene of small bodies and a sequence of
 * calls, or calls of the functions below it. It aborts where a promise is broken; memory, leaks and
 * undefined behaviour are the sanitizers' to find.
 *
 * With libFuzzer it is a target; FUZZ_MAIN makes it a program: fuzz_api SECONDS FIRST_SEED [FOLDER
 * [INPUTS]]. */
#include <libcontact.h>
#if defined(FUZZ_HDF5) && defined(FUZZ_MAIN)
#include <libcontact/output.h>
#endif

#include "../c/defs.h"
#include "dice.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Counts of the campaign. */
static long long total_calls, total_scenes, total_built, total_steps;
#ifdef FUZZ_MAIN
static const char *folder; /* for files; null: none are written */
#endif

enum { MOST_BODIES = 3, MOST_STATES = 3, MOST_MEMORY = 1024 };

typedef struct play {
  dice *d;
  ct_scene *scene;
  int body_count, added;
  ct_mesh *mesh[MOST_BODIES];
  const ct_problem *joined, *problem;
  int64_t steps;
  ct_state *state[MOST_STATES];
  ct_monitor *monitor;
  ct_state *monitored;
  void *kept[MOST_MEMORY]; /* arrays that effects look at, freed at the end */
  int kept_count;
} play;

static void *keep(play *p, size_t count, size_t size)
{
  demand(p->kept_count < MOST_MEMORY, "room in the test");
  return p->kept[p->kept_count++] = room(count, size);
}

#define TRY(call) checked(p->d, (call), &e)

/* -- Bodies -- */

/* A mesh, which only where `may_be_bad` has not been checked. */
static ct_mesh *any_mesh(play *p, int number, int may_be_bad)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_mesh *mesh = NULL;
  ct_brick_kind kind = (ct_brick_kind)(chance(d, 4) ? CT_HEX20 : CT_HEX8);
  if (d->wild && chance(d, 20)) kind = (ct_brick_kind)(below(d, 5) - 1);
  if (chance(d, 6)) {
    ct_ring ring = {{between(d, -1, 1), 0.0, 0.0},
                    {between(d, 0.3, 0.6), between(d, 0.7, 1.2)},
                    between(d, 0.1, 0.5),
                    {1, 3 + below(d, 4), 1}};
    if (d->wild) ring.cells[below(d, 3)] = below(d, 6) - 1;
    if (TRY(ct_mesh_create_ring(kind, &ring, &mesh, &e)) != CT_OK) return NULL;
  } else {
    ct_box box = {.origin = {number * (1.0 + (chance(d, 2) ? 0.0 : 0.01 * real(d))),
                             chance(d, 3) ? 0.3 * real(d) : 0.0, 0.0},
                  .size = {1.0, 1.0, 1.0},
                  .cells = {1 + below(d, 3), 1 + below(d, 2), 1 + below(d, 2)},
                  .layers = (ct_layers)below(d, d->wild ? 5 : 3)};
    for (int c = 0; c < 3; c++)
      if (chance(d, 4)) box.size[c] = between(d, 0.2, 2.0);
    if (d->wild && chance(d, 8)) box.cells[below(d, 3)] = below(d, 5) - 1;
    if (TRY(ct_mesh_create_box(kind, &box, &mesh, &e)) != CT_OK) return NULL;
  }
  double amount = chance(d, 2) ? 0.0 : 0.25 * between(d, 0.0, 1.0) * ct_mesh_shortest_edge(mesh);
  for (int i = 0; i < 3 * mesh->node_count && amount != 0.0; i++)
    mesh->nodes[i] += amount * 0.5 * real(d);
  if (d->wild && chance(d, 20)) mesh->elements[below(d, mesh->element_count)] = below(d, 400) - 100;
  ct_status status = TRY(ct_mesh_check(mesh, &e));
  if (status == CT_OK || (may_be_bad && chance(d, 2))) return mesh;
  ct_mesh_free(mesh);
  return NULL;
}

static ct_material any_material(dice *d)
{
  ct_material m = {between(d, 0.5, 4.0), between(d, 0.0, 0.45), between(d, 0.5, 2.0),
                   (ct_law)below(d, CT_LAW_COUNT)};
  if (d->wild && chance(d, 10)) m.law = (ct_law)(below(d, 9) - 3);
  return m;
}

static void add_body(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_mesh *mesh = any_mesh(p, p->body_count, 1);
  if (mesh == NULL) return;
  ct_material material = any_material(d);
  double velocity[3] = {0.3 * real(d), 0.05 * real(d), 0.05 * real(d)};
  int32_t number = -1;
  ct_solid_kernel kernel = (ct_solid_kernel)(chance(d, 3) ? below(d, 6) : CT_KERNEL_AUTO);
  ct_lumping lumping = (ct_lumping)(chance(d, 4) ? below(d, 4) : CT_LUMP_DEFAULT);
  double *each = NULL;
  if (chance(d, 4)) {
    each = room((size_t)mesh->node_count, 3 * sizeof *each);
    for (int i = 0; i < 3 * mesh->node_count; i++) each[i] = 0.1 * real(d);
  }
  const char *name = chance(d, 9) ? "a name that is so long that it does not fit into the place "
                                    "that a body has for it"
                                  : "body";
  ct_scene_body body = {.name = name,
                        .mesh = mesh,
                        .material = material,
                        .lumping = lumping,
                        .kernel = kernel,
                        .velocity = {velocity[0], velocity[1], velocity[2]},
                        .velocities = each,
                        .hourglass = chance(d, 5) ? between(d, 0.1, 2.0) : 0.0,
                        .stiffness_damping = chance(d, 6) ? between(d, 0.0, 0.1) : 0.0,
                        .displacements = chance(d, 8) ? each : NULL,
                        .initial_stress = {chance(d, 8) ? real(d) : 0.0}};
  if (p->body_count < MOST_BODIES &&
      TRY(ct_scene_add_body(p->scene, &body, chance(d, 3) ? NULL : &number, &e)) == CT_OK) {
    demand(number == -1 || number == p->body_count, "bodies are numbered");
    p->mesh[p->body_count++] = mesh;
    mesh = NULL;
  }
  free(each);
  ct_mesh_free(mesh);
}

/* Faces of a body in the body's own numbers, and how many; in the problem's numbers with `joined`.
 */
static int32_t *any_faces(play *p, int body, int joined, int32_t *count, ct_face_kind *kind)
{
  dice *d = p->d;
  const ct_mesh *mesh = p->mesh[body];
  int32_t *faces = keep(p, 8 * 6 * (size_t)mesh->element_count, sizeof *faces);
  double low[3], high[3];
  int axis = below(d, 3), per = ct_face_node_count(ct_brick_face_kind(mesh->kind));
  extent(mesh, low, high);
  *count = chance(d, 3) ? ct_mesh_outer_faces(mesh, faces, NULL)
                        : ct_mesh_plane_faces(mesh, axis, chance(d, 2) ? low[axis] : high[axis],
                                              faces, NULL);
  *kind = ct_brick_face_kind(mesh->kind);
  for (int32_t i = 0; joined && i < *count * per; i++)
    faces[i] += p->joined->bodies[body].first_node;
  if (d->wild && chance(d, 30) && *count > 0) faces[below(d, *count * per)] = below(d, 300) - 50;
  p->d->calls += 3;
  return faces;
}

static int32_t *any_nodes(play *p, int body, int joined, int32_t *count)
{
  dice *d = p->d;
  const ct_mesh *mesh = p->mesh[body];
  int32_t *nodes = keep(p, (size_t)mesh->node_count, sizeof *nodes);
  double low[3], high[3];
  int axis = below(d, 3);
  extent(mesh, low, high);
  if (chance(d, 4)) {
    *count = mesh->node_count;
    for (int32_t i = 0; i < *count; i++) nodes[i] = i;
  } else *count = ct_mesh_plane_nodes(mesh, axis, chance(d, 2) ? low[axis] : high[axis], nodes);
  for (int32_t i = 0; joined && i < *count; i++) nodes[i] += p->joined->bodies[body].first_node;
  if (d->wild && chance(d, 30) && *count > 0) nodes[below(d, *count)] = below(d, 300) - 50;
  p->d->calls += 2;
  return nodes;
}

/* All, none or a part of what an impact loses comes back. */
static double any_restitution(dice *d)
{
  return chance(d, 2) ? 1.0 : chance(d, 2) ? 0.0 : between(d, 0.0, d->wild ? 1.5 : 1.0);
}

/* Rarely none, which a step refuses where something comes back. */
static double any_travel_time(dice *d) { return chance(d, 12) ? 0.0 : between(d, 0.01, 1.0); }

static void add_contact(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_scene_contact c = {.body_a = below(d, p->body_count),
                        .body_b = below(d, p->body_count),
                        .beta = between(d, 0.1, 5.0),
                        .options = ct_contact_options_default()};
  ct_face_kind kind;
  c.faces_a = any_faces(p, c.body_a, 0, &c.face_count_a, &kind);
  c.faces_b = any_faces(p, c.body_b, 0, &c.face_count_b, &kind);
  if (c.body_a == c.body_b && chance(d, 2)) c.faces_b = c.faces_a, c.face_count_b = c.face_count_a;
  if (chance(d, 5)) c.beta = 0.0, c.options.epsilon = between(d, 0.1, 10.0);
  if (chance(d, 3)) c.options.enforcement = (ct_enforcement)below(d, CT_ENFORCE_COUNT + 1);
  if (chance(d, 5)) c.options.dissipation = between(d, 0.0, 1.0);
  if (chance(d, 3)) c.options.restitution = any_restitution(d);
  if (chance(d, 6)) c.options.depth = between(d, 0.01, 2.0);
  if (chance(d, 8)) c.options.method = (ct_method)below(d, 13);
  if (chance(d, 3)) c.options.points = (ct_contact_rule)below(d, 2 + d->wild);
  if (chance(d, 3)) c.options.initial_penetration = (ct_initial)below(d, 4 + d->wild);
  if (chance(d, 5)) c.options.adjust = between(d, 0.0, 0.3);
  if (c.options.initial_penetration == CT_INITIAL_REMOVE || (d->wild && chance(d, 6)))
    c.options.removal_time = between(d, 0.01, 1.0);
  if (chance(d, 3)) c.friction = between(d, 0.0, 0.8);
  if (chance(d, 6)) c.tangent = between(d, 0.0, 2.0);
  if (d->wild && chance(d, 10)) c.body_a = below(d, 9) - 4;
  (void)TRY(ct_scene_add_contact(p->scene, &c, &e));
}

static void add_support(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_scene_support s = {.body = below(d, p->body_count)};
  s.nodes = any_nodes(p, s.body, 0, &s.node_count);
  for (int c = 0; c < 3; c++) {
    s.fixed[c] = below(d, 2);
    s.velocity[c] = chance(d, 3) ? 0.1 * real(d) : 0.0;
  }
  if (d->wild && chance(d, 10)) s.body = below(d, 9) - 4;
  (void)TRY(ct_scene_add_support(p->scene, &s, &e));
}

/* -- Effects -- */

static ct_amplitude any_history(play *p)
{
  dice *d = p->d;
  int count = below(d, 4);
  double *time = keep(p, 4, sizeof *time), *value = keep(p, 4, sizeof *value);
  for (int i = 0; i < count; i++) {
    time[i] = i > 0 ? time[i - 1] + between(d, 0.01, 1.0) : 0.3 * between(d, 0.0, 1.0);
    value[i] = real(d);
  }
  return (ct_amplitude){count, time, value};
}

/* Springs on all nodes of the problem, as an effect of a host's own; some fail on purpose. */
typedef struct springs {
  const ct_problem *problem;
  double k, fails;
} springs;

static ct_status springs_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const springs *s = effect->data;
  if (view->time > s->fails) {
    if (error != NULL)
      *error = (ct_error){.code = CT_ERROR_UNSUPPORTED, .text = "the springs fail"};
    return CT_ERROR_UNSUPPORTED;
  }
  for (int64_t i = 0; i < effect->node_count; i++)
    for (int64_t c = 0; c < 3; c++) {
      int64_t node = effect->nodes == NULL ? i : effect->nodes[i];
      force[3 * i + c] = -s->k * s->problem->mass[node] * view->displacement[3 * node + c];
    }
  for (int64_t i = 0; i < effect->memory_count; i++) view->next_memory[i] = view->memory[i] + 1.0;
  return CT_OK;
}

static ct_status springs_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                ct_error *error)
{
  (void)effect, (void)view, (void)error;
  *energy = 0.0;
  return CT_OK;
}

static ct_effect *own_effect(play *p, int body)
{
  static const ct_effect_calls calls = {.force = springs_force},
                               storing = {.force = springs_force, .energy = springs_energy},
                               forceless = {.energy = springs_energy};
  dice *d = p->d;
  ct_error e = {0};
  springs *data = keep(p, 1, sizeof *data);
  *data = (springs){p->joined, between(d, 0.0, 1.0), chance(d, 8) ? between(d, 0.0, 0.5) : 1e300};
  ct_effect filled = {.label = "springs",
                      .calls = &calls,
                      .data = data,
                      .node_count = p->joined->node_count},
            *effect = NULL;
  if (chance(d, 2)) filled.nodes = any_nodes(p, body, 1, &filled.node_count);
  if (chance(d, 3)) filled.memory_count = below(d, 4);
  if (chance(d, 3)) filled.calls = &storing;
  if (d->wild && chance(d, 3)) filled.phase = (ct_phase)(below(d, 9) - 1);
  if (d->wild && chance(d, 6)) filled.calls = chance(d, 2) ? &forceless : NULL;
  (void)TRY(ct_effect_create(&filled, &effect, &e));
  return effect;
}

static ct_obstacle_def any_obstacle(play *p)
{
  dice *d = p->d;
  ct_obstacle_def o = {.cookie = ct_obstacle_def_default().cookie,
                       .shape = (ct_obstacle_shape)below(d, 3 + d->wild),
                       .point = {real(d), real(d), real(d)},
                       .axis = {real(d), real(d), real(d)},
                       .radius = between(d, -1.0, 1.0),
                       .epsilon = between(d, 0.1, 5.0),
                       .enforcement = (ct_enforcement)below(d, CT_ENFORCE_COUNT + d->wild),
                       .dissipation = chance(d, 2) ? 0.0 : between(d, 0.0, 1.0),
                       .restitution = any_restitution(d),
                       .travel_time = any_travel_time(d)};
  if (chance(d, 3)) o.velocity[0] = 0.1 * real(d);
  if (chance(d, 3)) o.amplitude = any_history(p), o.travel[1] = 0.1 * real(d);
  return o;
}

static ct_effect *surface_effect(play *p, int body)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_effect *effect = NULL;
  ct_face_kind kind;
  int32_t count, *faces = any_faces(p, body, 1, &count, &kind);
  switch (below(d, 4)) {
  case 0: {
    ct_load_def load = {COOKIE,
                        .kind = kind,
                        .face_count = count,
                        .faces = faces,
                        .traction = {real(d), real(d), real(d)},
                        .pressure = real(d),
                        .following = below(d, 2),
                        .amplitude = any_history(p)};
    (void)TRY(ct_load_create_effect(&load, p->joined, &effect, &e));
    break;
  }
  case 1: {
    ct_absorb_def absorb = {COOKIE, kind, count, faces};
    (void)TRY(ct_absorb_create_effect(&absorb, p->joined, &effect, &e));
    break;
  }
  case 2: {
    ct_face_kind of;
    int32_t others, *other = any_faces(p, below(d, p->body_count), 1, &others, &of);
    ct_tie_def tie = {COOKIE,
                      {kind, of},
                      {count, others},
                      {faces, other},
                      between(d, 0.1, 50.0),
                      between(d, 0.1, 5.0)};
    (void)TRY(ct_tie_create_effect(&tie, p->joined, &effect, &e));
    break;
  }
  default: {
    ct_obstacle_def o = any_obstacle(p);
    o.kind = kind, o.face_count = count, o.faces = faces;
    (void)TRY(ct_obstacle_create_effect(&o, p->joined, &effect, &e));
  }
  }
  return effect;
}

static ct_effect *body_effect(play *p, int body)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_effect *effect = NULL;
  int32_t *bodies = keep(p, 2, sizeof *bodies), count = below(d, 2);
  bodies[0] = d->wild && chance(d, 10) ? 9 : body;
  switch (below(d, 5)) {
  case 0: {
    ct_gravity_def gravity = {COOKIE, {real(d), real(d), real(d)}, bodies, count, {0}};
    if (chance(d, 3)) gravity.amplitude = any_history(p);
    (void)TRY(ct_gravity_create_effect(&gravity, p->joined, &effect, &e));
    break;
  }
  case 1: {
    ct_damping_def damping = {COOKIE, between(d, 0.0, 1.0), chance(d, 3), bodies, count};
    (void)TRY(ct_damping_create_effect(&damping, p->joined, &effect, &e));
    break;
  }
  case 2: {
    ct_viscosity_def viscosity = {COOKIE, between(d, 0.0, 0.2), between(d, 0.0, 1.5), bodies,
                                  count};
    (void)TRY(ct_viscosity_create_effect(&viscosity, p->joined, &effect, &e));
    break;
  }
  case 3: {
    ct_rigid *rigid = keep(p, 1, sizeof *rigid);
    rigid->body = bodies[0];
    rigid->pivoted = chance(d, 3);
    for (int c = 0; c < 3; c++) rigid->pivot[c] = rigid->pivoted ? real(d) : 0.0;
    for (int c = 0; c < 6; c++) rigid->fixed[c] = chance(d, 5);
    ct_rigid_def def = {COOKIE, rigid, 1};
    (void)TRY(ct_rigid_create_effect(&def, p->joined, &effect, &e));
    break;
  }
  default: {
    ct_motion *motion = keep(p, 1, sizeof *motion);
    motion->nodes = any_nodes(p, body, 1, &motion->node_count);
    motion->amplitude = any_history(p);
    for (int c = 0; c < 3; c++)
      motion->fixed[c] = below(d, 2), motion->displacement[c] = 0.1 * real(d);
    (void)TRY(create_motion(motion, 1, p->joined, &effect, &e));
  }
  }
  return effect;
}

static void add_effect(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  if (TRY(ct_scene_join(p->scene, &p->joined, &e)) != CT_OK) return;
  int body = below(d, p->body_count);
  ct_effect *effect = chance(d, 3)   ? own_effect(p, body)
                      : chance(d, 2) ? surface_effect(p, body)
                                     : body_effect(p, body);
  if (effect == NULL) return;
  if (chance(d, 12)) ct_effect_free(effect);
  else (void)TRY(ct_scene_add_effect(p->scene, effect, &e));
}

/* -- A built problem -- */

static void drop_states(play *p)
{
  ct_monitor_free(p->monitor);
  p->monitor = NULL;
  for (int i = 0; i < MOST_STATES; i++) {
    ct_state_free(p->state[i]);
    p->state[i] = NULL;
  }
}

static void build(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_stable_step stable;
  ct_scene_time time = {.end = between(d, 0.05, 3.0)};
  double value = between(d, 0.1, 1.0);
  *(chance(d, 3) ? &time.courant : chance(d, 6) ? &time.dt : &time.fraction) = value;
  if (d->wild && chance(d, 10)) time.courant = real(d);
  if (chance(d, 10)) time.keep_dt = 1;
  if (chance(d, 2)) time.integrator = ct_integrator_default((ct_scheme)below(d, CT_SCHEME_COUNT));
  if (chance(d, 6)) time.integrator.parameter = between(d, 0.0, 1.1);
  if (d->wild && chance(d, 10))
    time.integrator.scheme = (ct_scheme)(below(d, CT_SCHEME_COUNT + 3) - 2);
  if (chance(d, 3)) time.assembled = 1;
  if (chance(d, 3)) time.force_tolerance = d->wild && chance(d, 3) ? real(d) : 1e-3;
  drop_states(p);
  p->problem = NULL;
  if (d->wild && chance(d, 10)) {
    ct_run_settings settings = {.threads = below(d, 5) - 1};
    (void)TRY(ct_scene_set_run_settings(p->scene, &settings, &e));
  }
  if (chance(d, 5)) {
    ct_optimisations optimisations = {below(d, 2), below(d, 2), below(d, 2)};
    (void)TRY(ct_scene_set_optimisations(p->scene, &optimisations, &e));
  }
  if (TRY(ct_scene_build(p->scene, &time, &p->problem, &p->steps, &stable, &e)) != CT_OK) {
    p->problem = NULL;
    return;
  }
  demand(p->problem->dt > 0.0 && p->steps >= 1 && stable.dt > 0.0, "a problem has a step");
  total_built++;
}

static int all_finite(const double *values, int64_t count)
{
  for (int64_t i = 0; i < count; i++)
    if (!isfinite(values[i])) return 0;
  return 1;
}

/* What may be asked of a state; numbers that come with CT_OK are numbers. */
static void ask(play *p, ct_state *s)
{
  dice *d = p->d;
  ct_error e = {0};
  const ct_problem *q = p->problem;
  int k = below(d, q->effect_count + (d->wild ? 2 : 0));
  double number[8] = {0.0}, *field = room((size_t)q->node_count, 3 * sizeof *field),
         *area = room((size_t)q->node_count, sizeof *area);
  ct_energy energy;
  ct_momentum momentum;
  ct_stable_step stable;
  switch (below(d, 14)) {
  case 0:
    if (TRY(ct_energy_of(q, s, &energy, &e)) == CT_OK)
      demand(isfinite(energy.total) && isfinite(energy.balance), "energies are numbers");
    break;
  case 1:
    (void)TRY(ct_energy_work(q, s, k, number, &e));
    break;
  case 2:
    (void)TRY(ct_energy_stored(q, s, k, number, &e));
    break;
  case 3:
    (void)TRY(ct_energy_residual(q, s, number, &e));
    break;
  case 4:
    (void)TRY(ct_energy_impulse(q, s, k, number, &e));
    break;
  case 5:
    (void)TRY(ct_momentum_of(q, s, below(d, q->body_count + (d->wild ? 1 : 0)), &momentum, &e));
    break;
  case 6:
    (void)TRY(ct_state_velocity(q, s, field, &e));
    break;
  case 7:
    (void)TRY(ct_state_force(q, s, k, field, &e));
    break;
  case 8:
    (void)TRY(ct_stable_contribution(q, s, k, number, number + 1, &e));
    break;
  case 9:
    (void)TRY(ct_stable(q, chance(d, 2) ? s : NULL, &stable, &e));
    break;
  case 10:
    (void)TRY(ct_friction_energy(q, s, k, number, number + 1, &e));
    break;
  case 11:
    (void)TRY(ct_obstacle_traction(q, s, k, field, area, &e));
    break;
  case 12:
    if (TRY(ct_state_pressure(q, s, area, &e)) == CT_OK)
      demand(all_finite(area, q->node_count), "contact pressures are numbers");
    break;
  default:
    (void)TRY(ct_obstacle_reaction(q, s, k, number, number + 3, &e));
  }
  free(area);
  free(field);
}

static void look_at_contact(play *p, ct_state *s)
{
  ct_error e = {0};
  const ct_contact *contact =
      ct_state_contact(p->problem, s, below(p->d, p->problem->effect_count), &e);
  p->d->calls++;
  if (contact == NULL) return;
  int64_t count = ct_contact_point_count(contact);
  double r[12];
  ct_contact_point *points = room((size_t)count, sizeof *points);
  demand(ct_contact_points(contact, points, NULL) == CT_OK, "points of a contact");
  demand(ct_contact_resultant(contact, r, r + 3, r + 6, r + 9, NULL) == CT_OK,
         "resultant of a contact");
  p->d->calls += 3;
  free(points);
}

static void stresses(play *p, const ct_state *s)
{
  ct_error e = {0};
  const ct_body *body = &p->problem->bodies[below(p->d, p->problem->body_count)];
  double *stress = room((size_t)body->mesh->element_count, 6 * sizeof *stress);
  (void)TRY(ct_solid_stress(body->mesh, &body->material,
                            s->displacement + 3 * (int64_t)body->first_node, stress, &e));
  free(stress);
}

static void step(play *p, ct_state *s)
{
  dice *d = p->d;
  ct_error e = {0};
  int count = below(d, 6);
  if (d->wild && chance(d, 30))
    s->velocity[below(d, 3 * s->node_count)] = chance(d, 2) ? (double)NAN : 1e3 * real(d);
  int64_t before = s->step;
  ct_status status =
      TRY(chance(d, 2) ? ct_step(p->problem, s, &e) : ct_run(p->problem, s, count, NULL, 0, &e));
  total_steps += s->step - before;
  if (status == CT_OK && !d->wild)
    demand(all_finite(s->displacement, 3 * (int64_t)s->node_count), "motions are numbers");
}

static void monitor(play *p, ct_state *s)
{
  dice *d = p->d;
  ct_error e = {0};
  if (p->monitor == NULL) {
    ct_monitor_options options = ct_monitor_options_default();
    options.every = 1 + below(d, 5);
    if (chance(d, 3)) options.energy_limit = between(d, 0.01, 2.0);
    if (d->wild && chance(d, 6)) options.every = 0;
    p->monitored = s;
    if (TRY(ct_monitor_create(p->problem, s, &options, &p->monitor, &e)) != CT_OK)
      p->monitor = NULL;
  } else if (TRY(chance(d, 3)
                     ? ct_monitor_check(p->monitor, p->monitored, &e)
                     : ct_run(p->monitored->problem, p->monitored, below(d, 8),
                              (ct_observer[]){ct_monitor_observer(p->monitor)}, 1, &e)) == CT_OK)
    demand(ct_monitor_good(p->monitor) != NULL, "a monitor has a good state");
  if (chance(d, 12)) {
    ct_monitor_free(p->monitor);
    p->monitor = NULL;
  }
}

/* Copies go on to the same bits. */
static void copy(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_state *from = p->state[below(d, MOST_STATES)], *to = p->state[below(d, MOST_STATES)];
  if (from == NULL || to == NULL || from == to ||
      TRY(ct_state_copy(p->problem, from, to, &e)) != CT_OK)
    return;
  ct_status one = TRY(ct_run(p->problem, from, 2, NULL, 0, &e)),
            other = TRY(ct_run(p->problem, to, 2, NULL, 0, &e));
  demand(one == other && memcmp(from->displacement, to->displacement,
                                3 * (size_t)to->node_count * sizeof(double)) == 0,
         "a copy goes on to the same bits");
}

/* Go on with a part of the step. */
static void refine(play *p, ct_state *from)
{
  dice *d = p->d;
  ct_error e = {0};
  ct_problem fine = *p->problem;
  ct_state *to = NULL;
  fine.dt /= d->wild ? between(d, 0.5, 4.0) : 1 + below(d, 4);
  if (TRY(ct_state_create(&fine, &to, &e)) == CT_OK) {
    ct_status status = TRY(ct_state_subdivide_step(&fine, from, to, &e));
    if (status == CT_OK)
      demand(memcmp(from->displacement, to->displacement,
                    3 * (size_t)to->node_count * sizeof(double)) == 0,
             "a smaller step moves nothing");
    if (status == CT_OK) (void)TRY(ct_run(&fine, to, 2, NULL, 0, &e));
  }
  ct_state_free(to);
}

#if defined(FUZZ_HDF5) && defined(FUZZ_MAIN)
/* Write a state, read it into another one, sometimes with bytes of the file changed before. */
static void files(play *p, ct_state *s)
{
  dice *d = p->d;
  ct_error e = {0};
  char path[300];
  ct_output *out = NULL;
  ct_output_options options = ct_output_options_default();
  options.displacement = below(d, 2);
  options.velocity = below(d, 2);
  options.stress = below(d, 2);
  options.scene = chance(d, 2) ? "a scene" : NULL;
  options.contact_pressure = below(d, 2);
  options.filter = chance(d, 4) ? below(d, 10) : 0;
  if (folder == NULL) return;
  snprintf(path, sizeof path, "%s/fuzz.vtkhdf", folder);
  if (TRY(ct_output_create(path, p->problem, &options, &out, &e)) != CT_OK) return;
  ct_status written = CT_OK;
  for (int i = below(d, 3); i >= 0 && written == CT_OK; i--) {
    written = TRY(ct_output_append(out, p->problem, s, &e));
    if (written == CT_OK && i > 0 && TRY(ct_run(p->problem, s, 1, NULL, 0, &e)) != CT_OK) break;
  }
  (void)TRY(ct_output_close(out, &e));
  int spoilt = chance(d, 2);
  FILE *file = spoilt ? fopen(path, "r+b") : NULL;
  if (file != NULL) {
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    for (int i = below(d, 8); i >= 0; i--) {
      fseek(file,
            (long)(roll(d) * 65536u + roll(d) * 256u + roll(d)) % (chance(d, 2) ? 4096 : size),
            SEEK_SET);
      fputc((int)roll(d), file);
    }
    fclose(file);
  }
  ct_state *to = NULL;
  if (TRY(ct_state_create(p->problem, &to, &e)) == CT_OK) {
    ct_status read = TRY(ct_output_restart(path, p->problem, to, &e));
    // A step whose second stage failed has moved the state, without an end.
    if (!spoilt && written == CT_OK && read == CT_OK && to->step == s->step && to->time == s->time)
      demand(memcmp(to->displacement, s->displacement,
                    3 * (size_t)s->node_count * sizeof(double)) == 0,
             "a restart has the same bits");
    demand(spoilt || written != CT_OK || read == CT_OK, "what was written can be read");
    if (read == CT_OK) (void)TRY(ct_run(p->problem, to, 1, NULL, 0, &e));
  }
  ct_state_free(to);
  remove(path);
}
#endif

static void play_on(play *p)
{
  dice *d = p->d;
  ct_error e = {0};
  int i = below(d, MOST_STATES);
  if (p->state[i] == NULL) {
    if (TRY(ct_state_create(p->problem, &p->state[i], &e)) != CT_OK) p->state[i] = NULL;
    return;
  }
  switch (below(d, 12)) {
  case 0:
  case 1:
  case 2:
  case 3:
    step(p, p->state[i]);
    break;
  case 4:
  case 5:
  case 6:
    ask(p, p->state[i]);
    break;
  case 7:
    look_at_contact(p, p->state[i]);
    break;
  case 8:
    stresses(p, p->state[i]);
    break;
  case 9:
    monitor(p, p->state[i]);
    break;
  case 10:
    chance(d, 3) ? refine(p, p->state[i]) : copy(p);
    break;
  default:
#if defined(FUZZ_HDF5) && defined(FUZZ_MAIN)
    if (chance(d, 6)) files(p, p->state[i]);
    else
#endif
        if (p->state[i] != p->monitored || p->monitor == NULL) {
      ct_state_free(p->state[i]);
      p->state[i] = NULL;
    }
  }
}

static void play_scene(dice *d)
{
  play p = {.d = d};
  ct_error e = {0};
  demand(checked(d, ct_scene_create(&p.scene, &e), &e) == CT_OK, "an empty scene");
  total_scenes++;
  for (int i = 1 + below(d, MOST_BODIES); i > 0; i--) add_body(&p);
  for (int i = below(d, 3); i > 0 && p.body_count > 0; i--) add_contact(&p);
  for (int i = below(d, 3); i > 0 && p.body_count > 0; i--) add_support(&p);
  for (int i = below(d, 3); i > 0 && p.body_count > 0; i--) add_effect(&p);
  for (int rounds = 1 + below(d, 2); rounds > 0; rounds--) {
    build(&p);
    for (int i = below(d, 24); i > 0 && p.problem != NULL; i--) play_on(&p);
    if (chance(d, 3) && p.body_count > 0) chance(d, 2) ? add_support(&p) : add_contact(&p);
  }
  drop_states(&p);
  ct_scene_free(p.scene);
  for (int i = 0; i < p.body_count; i++) ct_mesh_free(p.mesh[i]);
  for (int i = 0; i < p.kept_count; i++) free(p.kept[i]);
}

/* -- Functions below a scene -- */

static void play_element(dice *d)
{
  ct_brick_kind kind = (ct_brick_kind)below(d, 3);
  double xi[3] = {real(d), real(d), real(d)}, N[20], dN[20][3];
  ct_rule rule;
  ct_brick_shape(kind, xi, N);
  ct_brick_gradient(kind, xi, dN);
  (void)ct_rule_face((ct_face_kind)below(d, 5), &rule, NULL);
  d->calls += 3;
}

static void play_faces(dice *d)
{
  enum { COUNT = 11 };
  ct_face face = {(ct_face_kind)below(d, 4), {{0.0}}};
  static const double corner[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                      {0, -1},  {1, 0},  {0, 1}, {-1, 0}};
  double points[COUNT * 3], start[COUNT * 2], xi[2] = {real(d), real(d)}, y[3];
  for (int a = 0; a < 8; a++)
    for (int c = 0; c < 3; c++) face.node[a][c] = (c < 2 ? corner[a][c] : 0.0) + 0.3 * real(d);
  for (int i = 0; i < COUNT * 3; i++) points[i] = 2.0 * real(d);
  for (int i = 0; i < COUNT * 2; i++) start[i] = real(d);
  ct_project_options options = ct_project_options_default();
  options.method = (ct_method)below(d, 13);
  if (chance(d, 3)) options.use_start = 1;
  ct_projection out[COUNT];
  ct_ray_hit hit[COUNT];
  (void)ct_project_points(&face, COUNT, points, &options, chance(d, 2) ? start : NULL, out, NULL);
  (void)ct_project_rays(&face, COUNT - 1, points, points + 3, 1e-10, hit, NULL);
  ct_segment_point(&face, xi, y);
  d->calls += 3;
  double values[40];
  for (int i = 0; i < 40; i++) values[i] = real(d);
  (void)ct_sum(values, below(d, 41));
  d->calls++;
}

static void play_exact(dice *d)
{
  double c2, c_r, x[4], z[4], t[4], fields[20];
  for (int i = 0; i < 4; i++) x[i] = 2.0 * real(d), z[i] = real(d), t[i] = between(d, 0.0, 2.0);
  (void)ct_exact_plates(4, x, z, t, between(d, 0.05, 0.45), 4.0, fields, NULL, NULL);
  (void)ct_exact_speeds(between(d, 0.0, 0.49), &c2, &c_r, NULL);
  for (int i = -1; i < 14; i++) (void)ct_status_name((ct_status)i);
  d->calls += 20;
}

/* Obstacles and friction of a host, which may be refused. */
static void add_parts(play *p, ct_contact *contact)
{
  dice *d = p->d;
  ct_error e = {0};
  for (int k = below(d, 4); k > 0; k--) {
    ct_obstacle_def wall = any_obstacle(p);
    if (chance(d, 3))
      (void)TRY(ct_contact_add_friction(contact, below(d, 3) - 1, between(d, -0.1, 1.0), 1.0, &e));
    else (void)TRY(ct_contact_add_obstacle(contact, below(d, 2 + d->wild), &wall, &e));
  }
}

/* Save, perhaps spoil, and restore. */
static void save(play *p, ct_contact *contact)
{
  dice *d = p->d;
  ct_error e = {0};
  const int64_t count = ct_contact_save(contact, NULL);
  double *memory = room((size_t)count, sizeof *memory), *later = room((size_t)count, sizeof *later);
  demand(ct_contact_save(contact, memory) == count, "as many numbers as before");
  if (d->wild) memory[below(d, (int)count)] = chance(d, 2) ? NAN : 1e3 * real(d);
  if (TRY(ct_contact_restore(contact, memory, count, &e)) == CT_OK) {
    (void)ct_contact_save(contact, later);
    demand(memcmp(memory, later, (size_t)count * sizeof *memory) == 0, "what was restored");
  } else demand(d->wild, "what was saved can be restored");
  free(memory);
  free(later);
  d->calls += 3;
}

/* A host's own loop over two surfaces, or one, without forces of its own. */
static void play_steps(play *p, ct_contact *contact, int two)
{
  dice *d = p->d;
  ct_error e = {0};
  double *x[2], *v[2], *f[2], *w[2], dt = between(d, 1e-3, 0.05), force[3], work;
  add_parts(p, contact);
  for (int b = 0; b < 2; b++) {
    const size_t n = 3 * (size_t)p->mesh[b]->node_count;
    double **arrays[] = {&x[b], &v[b], &f[b], &w[b]};
    for (int i = 0; i < 4; i++) *arrays[i] = keep(p, n, sizeof(double));
    for (size_t i = 0; i < n; i++)
      x[b][i] = p->mesh[b]->nodes[i], v[b][i] = real(d), w[b][i] = chance(d, 9) ? 0.0 : 1.0;
  }
  if (d->wild && chance(d, 4)) v[0][below(d, 3 * p->mesh[0]->node_count)] = NAN;
  for (int n = 0; n < 12; n++) {
    if (d->wild && chance(d, 6)) dt *= between(d, -0.1, 2.0);
    ct_contact_prediction q = {.x_a = x[0],
                               .x_b = x[1],
                               .velocity_a = v[0],
                               .velocity_b = v[1],
                               .inverse_mass_a = w[0],
                               .inverse_mass_b = w[1],
                               .dt = dt,
                               .force_time = n == 0 ? 0.5 * dt : dt};
    ct_contact_balance balance;
    for (int b = 0; b < 2; b++)
      memset(f[b], 0, 3 * (size_t)p->mesh[b]->node_count * sizeof(double));
    if (TRY(ct_contact_step(contact, &q, &e)) != CT_OK) return;
    demand(ct_contact_add_force(contact, f[0], f[1], NULL) == CT_OK &&
               ct_contact_balance_of(contact, &balance, NULL) == CT_OK,
           "forces and balance of a step");
    demand(all_finite(&balance.energy, 3) && all_finite(&balance.friction, 2), "a finite balance");
    (void)ct_contact_reaction(contact, below(d, 3), force, &work, NULL);
    d->calls += 3;
    for (int b = 0; b <= two; b++) {
      const int64_t dofs = 3 * (int64_t)p->mesh[b]->node_count;
      demand(all_finite(f[b], dofs), "finite forces");
      for (int64_t i = 0; i < dofs; i++) v[b][i] += q.force_time * w[b][i] * f[b][i];
      for (int64_t i = 0; i < dofs; i++) x[b][i] += dt * v[b][i];
    }
    if (chance(d, 6)) save(p, contact);
  }
}

/* Two surfaces that move through each other, apart from any scene. */
static void play_surfaces(dice *d)
{
  play whole = {.d = d}, *p = &whole;
  ct_error e = {0};
  whole.mesh[0] = any_mesh(p, 0, 0), whole.mesh[1] = any_mesh(p, 1, 0);
  ct_surface s[2];
  ct_search *search = NULL;
  ct_contact *contact = NULL;
  if (whole.mesh[0] == NULL || whole.mesh[1] == NULL) goto end;
  for (int b = 0; b < 2; b++) {
    s[b] = (ct_surface){.node_count = whole.mesh[b]->node_count, .reference = whole.mesh[b]->nodes};
    s[b].faces = any_faces(p, b, 0, &s[b].face_count, &s[b].kind);
  }
  if (TRY(ct_search_create(&s[0], &search, &e)) == CT_OK) {
    ct_nearest near[5];
    double points[15];
    int32_t start[5] = {-1, 0, 0, -1, 0};
    ct_search_options options = ct_search_options_default();
    for (int i = 0; i < 15; i++) points[i] = 2.0 * real(d);
    (void)ct_search_nearest(search, 5, points, chance(d, 2) ? start : NULL, &options, near, NULL);
    if (TRY(ct_search_move(search, whole.mesh[0]->nodes, &e)) == CT_OK)
      (void)ct_search_nearest(search, 5, points, NULL, &options, near, NULL);
    (void)ct_search_builds(search), (void)ct_search_cost(search);
    d->calls += 4;
  }
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = between(d, 0.1, 3.0);
  options.restitution = any_restitution(d), options.travel_time = any_travel_time(d);
  options.points = (ct_contact_rule)below(d, 2);
  options.enforcement =
      (ct_enforcement)(chance(d, 2) ? (int)options.enforcement : below(d, CT_ENFORCE_COUNT));
  const ct_surface *second = chance(d, 4) ? &s[0] : chance(d, 4) ? NULL : &s[1];
  ct_status made = TRY(ct_contact_create(&s[0], second, &options, &contact, &e));
  if (made == CT_OK && chance(d, 2)) play_steps(p, contact, second == &s[1]);
  for (int round = below(d, 3); made == CT_OK && round >= 0; round--) {
    double *x[2], *f[2], omega;
    for (int b = 0; b < 2; b++) {
      size_t n = 3 * (size_t)whole.mesh[b]->node_count;
      x[b] = keep(p, n, sizeof(double)), f[b] = keep(p, n, sizeof(double));
      for (size_t i = 0; i < n; i++) x[b][i] = whole.mesh[b]->nodes[i] + 0.05 * real(d);
    }
    if (TRY(ct_contact_update(contact, x[0], x[1], &e)) != CT_OK) continue;
    demand(ct_contact_add_force(contact, f[0], f[1], NULL) == CT_OK, "forces of a contact");
    (void)ct_contact_energy(contact);
    double *mass = keep(p, (size_t)whole.mesh[0]->node_count + (size_t)whole.mesh[1]->node_count,
                        sizeof *mass);
    for (int i = 0; i < whole.mesh[0]->node_count + whole.mesh[1]->node_count; i++) mass[i] = 1.0;
    (void)ct_contact_stable_step(contact, mass, mass, &omega, NULL);
    (void)ct_contact_update_stable_step(contact, mass, mass, &omega, NULL);
    ct_penetration depth;
    (void)ct_contact_penetration(contact, (ct_penetration_at)below(d, 3), &depth, NULL);
    d->calls += 5;
  }
end:
  ct_contact_free(contact);
  ct_search_free(search);
  for (int b = 0; b < 2; b++) ct_mesh_free(whole.mesh[b]);
  for (int i = 0; i < whole.kept_count; i++) free(whole.kept[i]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  dice d = dice_open(data, size);
  d.wild = chance(&d, 4);
  switch (below(&d, 8)) {
  case 0:
    play_element(&d);
    break;
  case 1:
    play_faces(&d);
    break;
  case 2:
    play_exact(&d);
    break;
  case 3:
    play_surfaces(&d);
    break;
  default:
    play_scene(&d);
  }
  total_calls += d.calls;
  return 0;
}

#ifdef FUZZ_MAIN
#include "seeds.h"

/* Inputs of consecutive seeds; prints the counts, or the seed of the input that failed. */
int main(int count, char **argument)
{
  unsigned long long first = count > 2 ? strtoull(argument[2], NULL, 10) : 1;
  folder = count > 3 && argument[3][0] != 0 ? argument[3] : NULL;
  long long inputs =
      run_seeds(count > 1 ? atof(argument[1]) : 10.0, first, count > 4 ? atoll(argument[4]) : -1);
  printf("seeds %llu to %llu: inputs %lld calls %lld scenes %lld built %lld steps %lld\n", first,
         now_seed - 1, inputs, total_calls, total_scenes, total_built, total_steps);
  return 0;
}
#endif
