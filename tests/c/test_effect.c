/* A host's own effect, filled by hand: a spring at each node of a body, compared with its closed
 * form. */
#include "bodies.h"

static const ct_material STIFF = {.young = 1e5, .poisson = 0.3, .density = 2.0};

static ct_status spring_force(const ct_effect *effect, const ct_view *view, double *force,
                              ct_error *error)
{
  (void)error;
  for (int i = 0; i < 3 * effect->node_count; i++)
    force[i] =
        -*(const double *)effect->data * view->displacement[3 * effect->nodes[i / 3] + i % 3];
  return CT_OK;
}

static ct_status spring_energy(const ct_effect *effect, const ct_view *view, double *energy,
                               ct_error *error)
{
  (void)error;
  *energy = 0.0;
  for (int i = 0; i < 3 * effect->node_count; i++) {
    double u = view->displacement[3 * effect->nodes[i / 3] + i % 3];
    *energy += 0.5 * *(const double *)effect->data * u * u;
  }
  return CT_OK;
}

static ct_status spring_frequency(const ct_effect *effect, const ct_view *view,
                                  double *omega_squared, ct_error *error)
{
  (void)view, (void)error;
  *omega_squared =
      *(const double *)effect->data / 0.25; // each node of the block has the mass 2 / 8
  return CT_OK;
}

static const ct_effect_calls SPRINGS = {
    .force = spring_force, .energy = spring_energy, .bounds = {.omega2 = spring_frequency}};

/* A host's effect may have any name: the library never identifies its own effects by name. */
static void named(const char *name)
{
  static const int32_t nodes[2] = {0, 3};
  double k = 1.0, held, lost, force[3], stored;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("block", mesh, &STIFF, CT_KERNEL_AUTO, 0.3, 0, 0);
  ct_effect filled = {.label = name,
                      .calls = &SPRINGS,
                      .data = &k,
                      .nodes = nodes,
                      .node_count = 2},
            *effect = NULL, *friction = NULL;
  ct_error e;
  const ct_problem *joined = join_scene(scene);
  must(ct_effect_create, &filled, &effect);
  ct_friction_def rub = {COOKIE, .tangent = 1.0, .on = effect, .coefficient = 0.3};
  tap_ok(ct_friction_create_effect(&rub, joined, &friction, &e) == CT_ERROR_ARGUMENT &&
             friction == NULL,
         "a host's effect \"%s\" has no friction points: %s", name, e.text);
  must(ct_scene_add_effect, scene, effect);
  ct_state *state = new_state(build_until(scene, 1.0, 0.5));
  const ct_problem *problem = state->problem;
  advance(problem, state, 3);
  ct_energy energy = energy_of(problem, state);
  ct_momentum momentum = momentum_of(problem, state, 0);
  must(ct_energy_stored, problem, state, 1, &stored);
  tap_ok(stored > 0.0 && energy.contact == 0.0 && momentum.contact_impulse[0] == 0.0 &&
             momentum.support_impulse[0] == 0.0,
         "\"%s\": its energy is in the total, not in the contacts'", name);
  tap_ok(ct_state_contact(problem, state, 1, &e) == NULL && e.code == CT_ERROR_ARGUMENT &&
             ct_obstacle_reaction(problem, state, 1, force, &held, &e) == CT_ERROR_ARGUMENT &&
             ct_friction_energy(problem, state, 1, &held, &lost, &e) == CT_ERROR_ARGUMENT,
         "\"%s\": no contact, no obstacle and no friction", name);
}

/* A copy of an effect of the library would have data that two effects free. */
static void copied(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("block", mesh, &STIFF, CT_KERNEL_AUTO, 0.3, 0, 0);
  ct_effect *gravity = NULL, *copy = NULL;
  ct_error e;
  const ct_problem *joined = join_scene(scene);
  must(ct_gravity_create_effect, &(ct_gravity_def){COOKIE, .acceleration = {0, 0, -9.81}}, joined,
       &gravity);
  tap_ok(ct_effect_create(gravity, &copy, &e) == CT_ERROR_ARGUMENT && copy == NULL,
         "a copy of an effect of the library is refused: %s", e.text);
  must(ct_scene_add_effect, scene, gravity);
  tap_ok(ct_scene_add_effect(scene, gravity, &e) == CT_ERROR_ARGUMENT,
         "an effect that the scene has already is refused: %s", e.text);
}

static ct_status no_force(const ct_effect *effect, const ct_view *view, double *force,
                          ct_error *error)
{
  (void)view, (void)error;
  memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  return CT_OK;
}

static ct_status bound_of_data(const ct_effect *effect, const ct_view *view, double *bound,
                               ct_error *error)
{
  (void)view, (void)error;
  *bound = *(const double *)effect->data;
  return CT_OK;
}

/* Results of a wrong list of constraints: a number of copies of one row. */
typedef struct listing {
  ct_constraint *row;
  int64_t count;
} listing;

static ct_status list_wrongly(const ct_effect *effect, const ct_view *view, ct_constraint **rows,
                              int64_t *count, ct_error *error)
{
  const listing *wrong = effect->data;
  (void)view, (void)error;
  if (wrong->count > 0) rows[0] = wrong->row;
  *count = wrong->count;
  return CT_OK;
}

/* The effects of a problem that a host fills itself are checked when a state is created. */
static void refused(const char *name, ct_effect *first, ct_effect *second)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("block", mesh, &STIFF, CT_KERNEL_AUTO, 0.3, 0, 0);
  ct_stable_step stable;
  ct_problem problem = *build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, &stable);
  const ct_effect *list[] = {problem.effects[0], first, second};
  ct_state *state = NULL;
  ct_error e = {0};
  problem.effects = list;
  problem.effect_count = 3;
  ct_status status = ct_state_create(&problem, &state, &e);
  if (status == CT_OK) status = ct_stable(&problem, state, &stable, &e);
  tap_ok(status == CT_ERROR_ARGUMENT, "%s: %s", name, e.text);
  close_run(state, scene, mesh);
}

static void refusals(void)
{
  static const int32_t nodes[2] = {0, 3}, outside[2] = {0, 8}, mixed[2] = {3, 0}, place[1] = {2},
                       both[2] = {0, 1};
  static const double shape[1] = {1.0}, halves[2] = {0.5, 0.5};
  static const ct_effect_calls only_force = {.force = no_force},
                               lists = {.force = no_force, .constraints = {.list = list_wrongly}},
                               stiff = {.force = no_force, .bounds = {.omega2 = bound_of_data}},
                               damps = {.force = no_force, .bounds = {.rate = bound_of_data}};
  const ct_effect plain = {.label = "host", .calls = &only_force, .nodes = nodes, .node_count = 2};
  ct_effect a = plain, b = plain;
  refused("no effect at all", &a, NULL);
  b.nodes = outside;
  refused("a node that is not in the problem", &a, &b);
  b.nodes = mixed;
  refused("nodes that do not ascend", &a, &b);
  b = plain, b.nodes = NULL, b.node_count = 9;
  refused("more nodes than there are", &a, &b);
  b = plain, a.reads = &b;
  refused("reads a later effect", &a, &b);
  a = plain, a.phase = CT_PHASE_FOLLOWING, b.reads = &a;
  refused("reads an earlier effect of a later phase", &a, &b);

  ct_constraint row = {.own_count = 1, .own = place, .own_shape = shape, .stiffness = 1.0};
  const listing wrong[] = {{NULL, -1}, {NULL, 3}, {NULL, 1}, {&row, 1}};
  a = b = plain;
  b.phase = CT_PHASE_CONSTRAINT, b.calls = &lists, b.constraint_count = 2;
  static const char *const how[] = {"a negative number of rows", "more rows than its capacity",
                                    "a row that is null", "a row with an unknown node"};
  for (int i = 0; i < 4; i++) {
    listing one = wrong[i];
    b.data = &one;
    refused(how[i], &a, &b);
  }
  ct_constraint wide = {.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                        .own_count = 2,
                        .own = both,
                        .own_shape = halves,
                        .stiffness = 1.0};
  listing one = {&wide, 1};
  b.data = &one, b.constraint_nodes = 1;
  refused("a row with more nodes than its capacity", &a, &b);
  b.constraint_nodes = 17;
  refused("more nodes per row than allowed", &a, &b);
  const double bounds[] = {NAN, -1.0};
  for (int i = 0; i < 2; i++) {
    double bound = bounds[i];
    b = plain, b.data = &bound, b.calls = &stiff;
    refused("an invalid bound", &a, &b);
    b.calls = &damps;
    refused("an invalid rate", &a, &b);
  }
}

static ct_status no_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  (void)effect, (void)scratch, (void)error;
  return CT_OK;
}

/* A table that lacks a call is refused; the message names the effect and the call. */
static void lacking(void)
{
  static const ct_effect_calls forceless = {.energy = spring_energy},
                               unfreed = {.force = no_force, .create_scratch = no_scratch},
                               freed = {.force = no_force, .free_scratch = free},
                               listless = {.force = no_force};
  static const struct {
    const ct_effect_calls *calls;
    ct_phase phase;
    const char *names;
  } wrong[] = {{NULL, CT_PHASE_STATE, "effect host: its table of calls is null"},
               {&forceless, CT_PHASE_STATE, "effect host: its calls lack force"},
               {&unfreed, CT_PHASE_STATE, "effect host: its calls lack free_scratch"},
               {&freed, CT_PHASE_STATE, "effect host: its calls lack create_scratch"},
               {&listless, CT_PHASE_CONSTRAINT, "effect host: its calls lack constraints.list"},
               {&listless, CT_PHASE_REACTION, "effect host: a reaction has no force of its own"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    ct_effect filled = {.label = "host",
                        .phase = wrong[i].phase,
                        .calls = wrong[i].calls,
                        .node_count = 1},
              *effect = NULL;
    ct_error e = {0};
    tap_ok(ct_effect_create(&filled, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL &&
               strcmp(e.text, wrong[i].names) == 0,
           "refused: %s", e.text);
  }
}

/* Mass 2 on springs of 8 altogether: omega = 2. */
int main(void)
{
  free_at_end();
  static const char *const name[] = {"contact", "obstacle", "friction", "solid", "support"};
  for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) named(name[i]);
  copied();
  refusals();
  lacking();
  static const int32_t nodes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  double k = 1.0, off = 0.0, exchange = 0.0, total = 0.0, stored;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("block", mesh, &STIFF, CT_KERNEL_AUTO, 0.3, 0, 0);
  ct_effect filled = {
      .label = "spring", .calls = &SPRINGS, .data = &k, .nodes = nodes, .node_count = 8};
  int64_t steps;
  ct_stable_step free_step, stable;
  ct_scene_time run = {.end = 3.0, .fraction = 0.5};
  build(scene, run, &steps, &free_step);
  add_effect(scene, &filled);
  const ct_problem *problem = build(scene, run, &steps, &stable);
  tap_close(4.0 / (stable.dt * stable.dt) - 4.0 / (free_step.dt * free_step.dt), 4.0,
            1e-13 / (stable.dt * stable.dt), "its frequency counts in the stable step");
  ct_state *state = new_state(problem);
  ct_energy energy, first = energy_of(problem, state);
  while (state->step < steps) {
    advance(problem, state, 1);
    energy = energy_of(problem, state);
    must(ct_energy_stored, problem, state, 1, &stored);
    double u = 0.15 * sin(2.0 * state->time);
    off = worst(off, state->displacement[3] - u);
    exchange = worst(exchange, stored - 4.0 * u * u);
    total = worst(total, energy.total - first.total);
  }
  tap_close(off, 0.0, 1e-5 * 0.15, "a block on springs swings as v / omega sin omega t");
  tap_close(exchange, 0.0, 1e-5 * first.total, "its stored energy is k u^2 / 2");
  tap_close(total / first.total, 0.0, 1e-12, "and is part of the total");
  return tap_done();
}
