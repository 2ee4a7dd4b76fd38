/* Two blocks that fly on top of each other, filled by hand as a host would, with one effect beside
 * the solid, or none: EFFECT, given to the compiler, names it, so that the program is linked with
 * the code of this effect alone. Prints steps, bytes and a hash, as one line of JSON. */
#include <libcontact.h>

#include "../tests/c/counting.h"

#include <stdint.h>
#include <stdio.h>

#define NONE 0
#define SUPPORT 1
#define MOTION 2
#define GRAVITY 3
#define LOAD 4
#define DAMPING 5
#define VISCOSITY 6
#define ABSORB 7
#define OBSTACLE 8
#define CONTACT 9
#define FRICTION 10
#define PROBE 11
#define PAIR_FRICTION 12
#ifndef EFFECT
#define EFFECT NONE
#endif
enum { CELLS = 12, NODES = (CELLS + 1) * (CELLS + 1) * (CELLS + 1), FACES = CELLS * CELLS };

static ct_error error;

static void need(ct_status status)
{
  if (status == CT_OK) return;
  fprintf(stderr, "%s: %s\n", ct_status_name(status), error.text);
  exit(1);
}

static double mass[2 * NODES], inverse[6 * NODES], velocity[6 * NODES], reference[6 * NODES];
static int32_t top[4 * FACES], bottom[4 * FACES], nodes[NODES];

/* The faces of a block in a plane z = value, as nodes of the problem. */
static void faces_of(const ct_mesh *mesh, double z, int32_t first, int32_t *faces)
{
  ct_mesh_plane_faces(mesh, 2, z, faces, NULL);
  for (int i = 0; i < 4 * FACES; i++) faces[i] += first;
}

#if EFFECT == OBSTACLE || EFFECT == FRICTION || EFFECT == CONTACT || EFFECT == PAIR_FRICTION
/* The time in which a wave crosses an element. */
static double travel_time(const ct_problem *problem)
{
  double c1, c2;
  ct_material_speeds(&problem->bodies[0].material, &c1, &c2);
  return 1.0 / CELLS / c1;
}
#endif

/* The effects of this program; their number. */
static int32_t make(const ct_problem *problem, ct_mesh *const *mesh, ct_effect **effect)
{
  faces_of(mesh[0], EFFECT == CONTACT || EFFECT == PAIR_FRICTION ? 1.0 : 0.0, 0, bottom);
  faces_of(mesh[1], 1.0, NODES, top);
#if EFFECT == SUPPORT
  ct_support hold = {nodes, ct_mesh_plane_nodes(mesh[0], 2, 0.0, nodes), {0, 0, 1}, {0, 0, 0}};
  ct_support_def def = ct_support_def_default();
  def.supports = &hold, def.support_count = 1;
  need(ct_support_create_effect(&def, problem, effect, &error));
  need(ct_support_apply(*effect, inverse, velocity, NULL));
#elif EFFECT == MOTION
  static const double at[2] = {0, 1}, value[2] = {0, 1};
  ct_motion hold = {
      nodes, ct_mesh_plane_nodes(mesh[0], 2, 0.0, nodes), {0, 0, 1}, {0, 0, 1e-3}, {2, at, value}};
  ct_motion_def def = ct_motion_def_default();
  def.motions = &hold, def.motion_count = 1;
  need(ct_motion_create_effect(&def, problem, effect, &error));
#elif EFFECT == GRAVITY
  ct_gravity_def def = ct_gravity_def_default();
  def.acceleration[2] = -1.0;
  need(ct_gravity_create_effect(&def, problem, effect, &error));
#elif EFFECT == LOAD
  ct_load_def def = ct_load_def_default();
  def.kind = CT_Q4, def.face_count = FACES, def.faces = bottom, def.pressure = 1.0;
  need(ct_load_create_effect(&def, problem, effect, &error));
#elif EFFECT == DAMPING
  ct_damping_def def = ct_damping_def_default();
  def.rate = 0.1;
  need(ct_damping_create_effect(&def, problem, effect, &error));
#elif EFFECT == VISCOSITY
  ct_viscosity_def def = ct_viscosity_def_default();
  def.linear = 0.06, def.quadratic = 1.2;
  need(ct_viscosity_create_effect(&def, problem, effect, &error));
#elif EFFECT == ABSORB
  ct_absorb_def def = ct_absorb_def_default();
  def.kind = CT_Q4, def.face_count = FACES, def.faces = bottom;
  need(ct_absorb_create_effect(&def, problem, effect, &error));
#elif EFFECT == OBSTACLE || EFFECT == FRICTION
  ct_obstacle_def def = ct_obstacle_def_default();
  def.axis[2] = 1.0, def.epsilon = 1e4, def.travel_time = travel_time(problem);
  def.kind = CT_Q4, def.face_count = FACES, def.faces = bottom;
  need(ct_obstacle_create_effect(&def, problem, effect, &error));
#elif EFFECT == CONTACT || EFFECT == PAIR_FRICTION
  ct_surface side[2] = {{CT_Q4, 2 * NODES, FACES, bottom, reference},
                        {CT_Q4, 2 * NODES, FACES, top, reference}};
  ct_contact_def def = ct_contact_def_default();
  def.a = &side[0], def.b = &side[1];
  def.options.epsilon = 1e4, def.options.travel_time = travel_time(problem);
  need(ct_contact_create_effect(&def, problem, effect, &error));
#endif
#if EFFECT == FRICTION || EFFECT == PAIR_FRICTION
  ct_friction_def rub = ct_friction_def_default();
  rub.on = effect[0], rub.coefficient = 0.3;
  need(ct_friction_create_effect(&rub, problem, &effect[1], &error));
#endif
  (void)problem, (void)effect, (void)nodes;
  return EFFECT == FRICTION || EFFECT == PAIR_FRICTION ? 2 : EFFECT != NONE && EFFECT != PROBE;
}

/* The steps, with the history of a node and of a face where the effect is a probe. */
static void run(const ct_problem *problem, ct_mesh *const *mesh, ct_state *state, int32_t steps)
{
#if EFFECT == PROBE
  static const int32_t corner = 0;
  ct_probe_def def[2] = {ct_probe_def_default(), ct_probe_def_default()};
  ct_probes *probes;
  int32_t count = ct_mesh_plane_nodes(mesh[0], 2, 0.0, nodes);
  def[0].name = "corner", def[0].nodes = &corner, def[0].node_count = 1;
  def[1].name = "face", def[1].nodes = nodes, def[1].node_count = count;
  for (int i = 0; i < 2; i++) def[i].take[CT_QUANTITY_DISPLACEMENT] = 1;
  need(ct_probes_create(problem, def, 2, &probes, &error));
  need(
      ct_run(state->problem, state, steps, (ct_observer[]){ct_probes_observer(probes)}, 1, &error));
  ct_probes_free(probes);
#else
  (void)mesh;
  need(ct_run(problem, state, steps, NULL, 0, &error));
#endif
}

int main(int count, char **argument)
{
  need(ct_set_allocator(&COUNTING, NULL));
  ct_material material = {.young = 1e3, .poisson = 0.3, .density = 1.0};
  ct_mesh *mesh[2];
  ct_body body[2];
  ct_solid_body solid[2];
  int32_t steps = count > 1 ? atoi(argument[1]) : 10, made = 1;
  for (int b = 0; b < 2; b++) {
    ct_box box = {.origin = {0, 0, b}, .size = {1, 1, 1}, .cells = {CELLS, CELLS, CELLS}};
    need(ct_mesh_create_box(CT_HEX8, &box, &mesh[b], &error));
    body[b] = (ct_body){.mesh = mesh[b], .material = material, .first_node = b * NODES};
    solid[b] = (ct_solid_body){.mesh = mesh[b], .material = material, .first_node = b * NODES};
    need(ct_mass_lumped(mesh[b], 1.0, CT_LUMP_DEFAULT, &mass[b * NODES], &error));
    memcpy(&reference[3 * b * NODES], mesh[b]->nodes, 3 * NODES * sizeof(double));
  }
  for (int d = 0; d < 6 * NODES; d++) {
    inverse[d] = 1.0 / mass[d / 3];
    velocity[d] = d % 3 == 2 ? -0.1 * reference[d] : 0.01 * reference[d];
  }
  ct_effect *effect[3] = {NULL};
  ct_solid_def def = ct_solid_def_default();
  def.bodies = solid, def.body_count = 2;
  need(ct_solid_create_effect(&def, NULL, &effect[0], &error));
  ct_problem problem = {.node_count = 2 * NODES,
                        .body_count = 2,
                        .bodies = body,
                        .reference = reference,
                        .mass = mass,
                        .inverse_mass = inverse,
                        .initial_velocity = velocity,
                        .effects = (const ct_effect *const *)effect,
                        .dt = 5e-4};
  made += make(&problem, mesh, &effect[1]);
  problem.effect_count = made;
  ct_state *state;
  need(ct_state_create(&problem, &state, &error));
  size_t held = counted.held;
  run(&problem, mesh, state, steps);
  uint64_t hash = 14695981039346656037ull;
  const unsigned char *byte = (const unsigned char *)state->displacement;
  for (size_t i = 0; i < 48 * (size_t)NODES; i++) hash = (hash ^ byte[i]) * 1099511628211ull;
  printf("{\"steps\": %d, \"bytes\": %zu, \"hash\": \"%016llx\"}\n", (int)steps, held,
         (unsigned long long)hash);
  ct_state_free(state);
  while (made > 0) ct_effect_free(effect[--made]);
  ct_mesh_free(mesh[0]);
  ct_mesh_free(mesh[1]);
  return 0;
}
