/* Memory of a run, byte by byte, by an allocator that counts. */
#include "../../libcontact/src/solid/kernel.h"
#include "bodies.h"
#include "counting.h"

#include <libcontact/effect.h>
#include <libcontact/step.h>

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR},
                         RUBBER = {2.1e5, 0.3, 7.8e-9, CT_NEO_HOOKEAN};
static const ct_optimisations NONE = {0, 0, 0};

/* A block of 16 x 24 x 24 cells in free flight, and its options. */
typedef struct kind {
  const char *name;
  ct_brick_kind brick;
  const ct_material *material;
  ct_solid_kernel kernel;
  int lattice; /* nothing is stored of an element */
  int held, monitored, falls, relaxes;
  double node, element; /* expected bytes of each in addition to `held`, ... */
} kind;

/* Numbers a node: of the problem 10 (X, m, 1/m, v_0), of the state 12 (u, v, work, force). */
enum { NODE = 22 * 8 };

static const kind KINDS[] = {
    {"a lattice", CT_HEX8, &STEEL, CT_KERNEL_BOX, 1, 0, 0, 0, 0, NODE, 32},
    {"a lattice whose nodes are all held along y", CT_HEX8, &STEEL, CT_KERNEL_BOX, 1, 1, 0, 0, 0,
     NODE + 6 * 8 + 4 * 4, 32},
    {"a lattice with a monitor", CT_HEX8, &STEEL, CT_KERNEL_BOX, 1, 0, 1, 0, 0, NODE + 9 * 8, 32},
    {"a lattice with gravity: 15 numbers and two node numbers more", CT_HEX8, &STEEL, CT_KERNEL_BOX,
     1, 0, 0, 1, 0, NODE + 15 * 8 + 2 * 4, 32},
    {"a lattice that comes to rest: two samples more", CT_HEX8, &STEEL, CT_KERNEL_BOX, 1, 0, 0, 0,
     1, NODE + 27 * 8 + 2 * 4, 32},
    {"tables: places of forces, forces", CT_HEX8, &STEEL, CT_KERNEL_BOX, 0, 0, 0, 0, 0, NODE + 32,
     32 + 192},
    {"hex20", CT_HEX20, &STEEL, CT_KERNEL_GENERAL, 0, 0, 0, 0, 0, NODE + 32, 80 + 480},
    {"reduced integration: as full", CT_HEX8, &STEEL, CT_KERNEL_REDUCED, 0, 0, 0, 0, 0, NODE + 32,
     32 + 192},
    {"large deformation: smallest J, energies", CT_HEX8, &RUBBER, CT_KERNEL_GENERAL, 0, 0, 0, 0, 0,
     NODE + 32, 32 + 192 + 9},
    {"large deformation with a monitor: mode, moved, force, and scratch space of its own", CT_HEX8,
     &RUBBER, CT_KERNEL_GENERAL, 0, 0, 1, 0, 0, NODE + 18 * 8 + 32, 32 + 2 * (192 + 9)},
};

static ct_scene *scene_of(const kind *k, const ct_mesh *mesh)
{
  ct_scene *scene = new_scene();
  ct_optimisations optimisations = NONE;
  ct_effect *effect;
  optimisations.shared_stiffness = k->lattice;
  must(ct_scene_set_optimisations, scene, &optimisations);
  add_body(scene, "block", mesh, k->material, k->kernel, 1, 0, 0);
  if (k->held) add_support(scene, 0, mesh, -1, 0.0, "y", 0.0);
  const ct_problem *joined = join_scene(scene);
  if (k->falls) {
    must(ct_gravity_create_effect, &(ct_gravity_def){COOKIE, .acceleration = {0, 0, -9810}}, joined,
         &effect);
    must(ct_scene_add_effect, scene, effect);
  }
  if (k->relaxes) {
    must(ct_damping_create_effect, &(ct_damping_def){COOKIE, .relaxation = 1}, joined, &effect);
    must(ct_scene_add_effect, scene, effect);
  }
  return scene;
}

/* Compute all quantities of a record. */
static void ask(const ct_problem *problem, ct_state *state, ct_monitor *monitor)
{
  double unrest;
  energy_of(problem, state);
  momentum_of(problem, state, 0);
  must(ct_energy_residual, problem, state, &unrest);
  if (monitor != NULL) must(ct_monitor_check, monitor, state);
}

/* The block of a kind of scene. */
static ct_mesh *block_of(const kind *k)
{
  return box_mesh(k->brick, 0, 0, 0, 1, 1.5, 1.5, 16, 24, 24);
}

static const ct_problem *problem_of(ct_scene *scene, ct_stable_step *stable)
{
  return build(scene, (ct_scene_time){.end = 1e-6, .fraction = 0.5}, NULL, stable);
}

/* Build, step, compute records; nothing is allocated after the start, and the memory is no more
 * than computed above. */
static void budget(const kind *k)
{
  size_t before = counted.held;
  ct_mesh *m = block_of(k);
  ct_scene *scene = scene_of(k, m);
  double nodes = m->node_count, elements = m->element_count;
  ct_mesh_free(m);
  ct_stable_step stable;
  ct_monitor *monitor = NULL;
  const ct_problem *problem = problem_of(scene, &stable);
  ct_state *state = new_state(problem);
  ct_monitor_options options = ct_monitor_options_default();
  options.every = 2;
  options.stable = stable.dt;
  if (k->monitored) must(ct_monitor_create, problem, state, &options, &monitor);

  // Per node some bits; a ring of 1 + 16 + 16 * 24 elements and what is computed at once, a power
  // of two; three runs for each of 25 x 25 rows of nodes; and what does not grow.
  double held = (double)(counted.held - before), want = k->node * nodes + k->element * elements,
         ring = k->lattice ? 1032 * 192 + 3 * 25 * 25 * (double)sizeof(ct_ring_run) : 0;
  double peak = (double)(counted.peak - before) / held;
  tap_ok(held <= want + ring + 0.5 * nodes + 40000 && held >= want,
         "%s: %.1f bytes per node, expected %.1f", k->name, held / nodes, (want + ring) / nodes);
  tap_ok(peak <= 1.05, "%s: at most %.3f times as much while it was built", k->name, peak);

  long calls_before = counted.calls;
  if (monitor != NULL)
    must(ct_run, state->problem, state, 4, (ct_observer[]){ct_monitor_observer(monitor)}, 1);
  else advance(problem, state, 4);
  ask(problem, state, monitor);
  tap_ok(counted.calls == calls_before,
         "%s: neither steps nor the energy balance allocate (%ld calls)", k->name,
         counted.calls - calls_before);
  ct_monitor_free(monitor);
  close_run(state, scene, NULL);
  tap_ok(counted.held == before, "%s: all memory is freed", k->name);
  counted.peak = counted.held;
}

/* The good state of a monitor gets its forces on request, and not before. */
static void good_state(void)
{
  const kind *k = &KINDS[2];
  ct_mesh *m = block_of(k);
  ct_scene *scene = scene_of(k, m);
  ct_stable_step stable;
  ct_monitor *monitor = NULL;
  const ct_problem *problem = problem_of(scene, &stable);
  ct_state *state = new_state(problem);
  ct_monitor_options options = ct_monitor_options_default();
  must(ct_monitor_create, problem, state, &options, &monitor);
  advance(problem, state, 3);
  must(ct_monitor_check, monitor, state);
  size_t before = counted.held;
  ct_state *good = ct_monitor_good(monitor);
  size_t asked = counted.held;
  ct_energy a = energy_of(problem, state), b = energy_of(problem, good);
  tap_ok(asked - before > 24 * (size_t)m->node_count && ct_monitor_good(monitor) == good &&
             counted.held == asked,
         "a good state allocates its forces once");
  tap_ok(memcmp(&a, &b, sizeof a) == 0, "and has the energy balance of that state");
  advance(problem, state, 2);
  must(ct_monitor_check, monitor, state);
  a = energy_of(problem, state), b = energy_of(problem, good);
  tap_ok(memcmp(&a, &b, sizeof a) == 0, "also after the next check");
  ct_monitor_free(monitor);
  close_run(state, scene, m);
}

/* A state of nodes that are all displaced and move, whose forces are not made yet. */
static ct_state *shaken(const ct_problem *problem)
{
  ct_state *from = new_state(problem), *state = new_state(problem);
  advance(problem, from, 1);
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++) {
    from->displacement[d] += uniform(1e-5);
    from->velocity[d] += problem->inverse_mass[d] > 0.0 ? uniform(10.0) : 0.0;
  }
  must(ct_state_copy, problem, from, state);
  ct_state_free(from);
  return state;
}

/* Sum over the nodes of m x · y in more digits than a double has. */
static double by_hand(const ct_problem *problem, const double *mass, const double *x,
                      const double *y)
{
  long double sum = 0.0L;
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++)
    sum += (mass == NULL ? 1.0L : (long double)mass[d / 3]) * x[d] * y[d];
  return (double)sum;
}

static double close_to(double got, double want) { return fabs(got - want) / fabs(want); }

/* Sums and largest values over more nodes than a piece has: potential of the weight, residual, rate
 * of a relaxation. */
static void many_nodes(const kind *k)
{
  ct_mesh *m = box_mesh(k->brick, 0, 0, 0, 1, 0.7, 0.7, 10, 7, 7);
  ct_scene *scene = scene_of(k, m);
  int64_t dofs = 3 * (int64_t)m->node_count;
  ct_stable_step stable;
  const ct_problem *problem = problem_of(scene, &stable);
  ct_state *state = shaken(problem);
  double *total = numbers(dofs), *force = numbers(dofs), acting = 0.0, left = 0.0, stored = 0.0,
         kinetic = 0.0, unrest = NAN;
  for (int32_t i = 0; i < problem->effect_count; i++) {
    double energy = 0.0;
    must(ct_state_force, problem, state, i, force);
    must(ct_energy_stored, problem, state, i, &energy);
    acting = fmax(acting, largest(force, dofs));
    for (int64_t d = 0; d < dofs; d++) total[d] += force[d];
    stored += fabs(energy);
    if (strcmp(problem->effects[i]->label, "gravity") == 0)
      tap_ok(close_to(energy, -by_hand(problem, NULL, force, state->displacement)) < 1e-14,
             "the potential is minus weight times displacement");
  }
  for (int64_t d = 0; d < dofs; d++)
    left = fmax(left, problem->inverse_mass[d] > 0.0 ? fabs(total[d]) : 0.0);
  kinetic = 0.5 * by_hand(problem, problem->mass, state->velocity, state->velocity);
  must(ct_energy_residual, problem, state, &unrest);
  double want = fmax(left / acting, sqrt(kinetic / stored));
  tap_ok(close_to(unrest, want) < 1e-14, "%s: the residual is that of all its nodes", k->name);
  if (k->relaxes) {
    const double *sample = state->memory + 2;
    double *way = numbers(dofs), *change = numbers(dofs);
    must(ct_state_force, problem, state, 0, force);
    for (int64_t d = 0; d < dofs; d++)
      way[d] = state->displacement[d] - sample[d], change[d] = sample[dofs + d] - force[d];
    double omega =
        sqrt(by_hand(problem, NULL, way, change) / by_hand(problem, problem->mass, way, way));
    advance(problem, state, 1);
    tap_ok(close_to(state->memory[0], 2.0 * omega) < 1e-13,
           "the rate is that of the change at all nodes");
    free_all(way, change);
  }
  free_all(total, force);
  close_run(state, scene, m);
}

/* One bar, two, and two that meet: the second one needs no ring, and steps and energy balance
 * allocate nothing. */
static void bars(void)
{
  ct_mesh *m[2] = {box_mesh(CT_HEX8, -2, 0, 0, 2, 0.6, 0.6, 20, 6, 6),
                   box_mesh(CT_HEX8, 0.001, 0, 0, 2, 0.6, 0.6, 20, 6, 6)};
  size_t held[3], before = counted.held;
  for (int i = 0; i < 3; i++) {
    ct_scene *scene = new_scene();
    for (int b = 0; b < (i == 0 ? 1 : 2); b++)
      add_body(scene, "bar", m[b], &STEEL, CT_KERNEL_BOX, b == 0 ? 1e3 : -1e3, 0, 0);
    if (i == 2) add_contact(scene, 0, m[0], 0.0, 1, m[1], 0.001, 0, 0.5);
    int64_t steps;
    const ct_problem *problem =
        build(scene, (ct_scene_time){.end = 2e-6, .fraction = 0.9}, &steps, NULL);
    ct_state *state = new_state(problem);
    held[i] = counted.held - before;
    long calls_before = counted.calls;
    advance(problem, state, steps);
    ask(problem, state, NULL);
    tap_ok(counted.calls == calls_before, "%s: %ld allocations in %d steps and after",
           i == 0   ? "a bar"
           : i == 1 ? "two bars"
                    : "two that meet",
           counted.calls - calls_before, (int)steps);
    if (i == 2)
      tap_ok(momentum_of(problem, state, 0).contact_impulse[0] < 0.0, "they are in contact");
    close_run(state, scene, NULL);
  }
  // 1 + 20 + 120 elements wait for their nodes and 256 are computed at once, in a ring of 512.
  double alone = (double)held[0] - (512 + 8) * 192;
  tap_ok(fabs((double)(held[1] - held[0]) - alone) <= 0.02 * alone,
         "a second bar changes %zu bytes to %zu, without a ring", held[1] - held[0], held[0]);
  for (int b = 0; b < 2; b++) ct_mesh_free(m[b]);
}

/* The number of faces distinguishes lack of memory, and an invalid mesh, from a surface without
 * faces. */
static void no_room(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  int32_t faces[96], owners[24], wrong[2] = {-1, m->node_count};
  counted.last_call = counted.calls;
  tap_ok(ct_mesh_outer_faces(m, faces, owners) == -CT_ERROR_MEMORY &&
             ct_mesh_plane_faces(m, 0, 0.0, faces, owners) == -CT_ERROR_MEMORY,
         "no memory for the faces of a mesh: reported as such, not as no faces");
  counted.last_call = -1;
  tap_ok(ct_mesh_outer_faces(m, faces, owners) == 24 &&
             ct_mesh_plane_faces(m, 0, 0.0, faces, owners) == 4,
         "and with memory they are there");
  for (int i = 0; i < 2; i++) {
    int32_t keep = m->elements[9];
    m->elements[9] = wrong[i];
    tap_ok(ct_mesh_outer_faces(m, faces, owners) == -CT_ERROR_ARGUMENT &&
               ct_mesh_plane_faces(m, 0, 0.0, faces, owners) == -CT_ERROR_ARGUMENT,
           "an element with node %d is refused", (int)wrong[i]);
    m->elements[9] = keep;
  }
  tap_ok(ct_mesh_outer_faces(NULL, faces, owners) == -CT_ERROR_ARGUMENT &&
             ct_mesh_plane_faces(&(ct_mesh){0}, 0, 0.0, NULL, NULL) == -CT_ERROR_ARGUMENT,
         "no mesh, an empty one");
  ct_mesh_free(m);
}

int main(void)
{
  ct_set_allocator(&COUNTING, NULL);
  no_room();
  for (size_t k = 0; k < sizeof KINDS / sizeof KINDS[0]; k++) budget(&KINDS[k]);
  for (int k = 0; k < 5; k++) many_nodes(&KINDS[k]);
  good_state();
  bars();
  return tap_done();
}
