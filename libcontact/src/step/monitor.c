/* Checks of a state between steps: finite motion, spurious energy, and a solid that has become too
 * stiff for the step. */
#include <libcontact/observe.h>
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/random.h"
#include "../base/stream.h"
#include "effect_internal.h"
#include "workspace.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rounds of the power iteration when a monitor is created, and of a check; and the fraction of
 * noise that keeps all directions in it. */
enum { FIRST_ROUNDS = 12, ROUNDS = 4 };
static const double NOISE = 0.01, SMALL = 1e-6;
/* The limit of growth after a loss, over that of growth (eq:growth-again). */
static const double AGAIN = 5.0;

struct ct_monitor {
  ct_pool pool; /* the arrays below */
  const ct_problem *problem;
  ct_monitor_options options;
  ct_state *good;
  ct_ledger ledger, next; /* the row of the good state, and that of the state being checked */
  double start;           /* total of the energy balance at the start */
  double jump;            /* from the total of a run's beginning to it (eq:divided-energy) */
  double *gave;           /* contribution of each effect with stored energy to that total by then */
  double *low, lowest;    /* the same when those that do not touch gave least, and their sum then */
  double least;           /* lowest total since the start */
  double floor;           /* energy that round-off can cause (eq:energy-floor) */
  ct_growth growth;
  double largest;  /* largest kinetic, stored or external energy of the good states */
  double expected; /* largest energy of motion and strain that the good states should have had */
  double swing;    /* 1 - (Δt / stable Δt)² */
  double edge;     /* shortest edge of all bodies */
  double omega_squared; /* of the last check */
  double *mode; /* direction of the power iteration, shape (node_count, 3), or null if no body can
                   stiffen */
  double *moved, *force;
  void *scratch; /* of the first effect */
  uint64_t seed;
};

ct_monitor_options ct_monitor_options_default(void)
{
  return (ct_monitor_options){.cookie = CT_DEF_COOKIE,
                              .every = 1024,
                              .energy_limit = 1.0,
                              .omega_limit = 2.0,
                              .growth_limit = 0.002,
                              .first_total = NAN};
}

/* m x · x at the nodes first ... end - 1; a null x: m v_n · v_n. */
static void square_terms(const ct_problem *problem, const ct_state *state, const double *x,
                         int32_t first, int32_t end, double *terms)
{
  double velocity[3 * CT_PIECE];
  if (x == NULL) ct_mean_velocity(problem, state, first, end, velocity);
  const double *own = x == NULL ? velocity : &x[3 * (int64_t)first];
  ct_product_terms(end - first, &problem->mass[first], own, own, terms);
}

/* The node with the largest kinetic energy. */
static int32_t largest_node(const ct_problem *problem, const ct_state *state, const double *x)
{
  int32_t best = 0;
  double most = -1.0, terms[1];
  for (int32_t n = 0; n < problem->node_count; n++) {
    square_terms(problem, state, x, n, n + 1, terms);
    if (terms[0] > most) best = n, most = terms[0];
  }
  return best;
}

/* An element of a body with this node, numbered in the body. */
static int64_t element_with(const ct_mesh *mesh, int32_t node)
{
  int64_t per = ct_brick_node_count(mesh->kind);
  for (int64_t i = 0; i < per * mesh->element_count; i++)
    if (mesh->elements[i] == node) return i / per;
  return -1;
}

/* Energies of one check: stored by bodies and by explicit penalties, which oscillate with them;
 * spurious energy, without what contacts store, and that of the bodies alone; energy that motion
 * and strain should have, and its largest value so far (eq:energy-appears); the largest energy of
 * all, and the limit below which nothing is reported. */
typedef struct energies {
  double elastic, appeared, alone, expected, most_expected, scale, least;
} energies;

static int is_alone(const ct_effect *effect)
{
  return !ct_effect_touches(effect) && effect->kind != CT_EFFECT_FRICTION;
}

/* Energy that a contact, a tie or an obstacle stores by rows. Only what the bodies get back of it
 * counts as growth: it depends on the square of a gap, which a stiff penalty multiplies
 * (eq:energy-lent).
 */
static double lent_to(const ct_monitor *w, int32_t k)
{
  const ct_effect *effect = w->problem->effects[k];
  return ct_effect_touches(effect) && effect->phase == CT_PHASE_CONSTRAINT
             ? fmax(w->next.effects[k].stored, 0.0)
             : 0.0;
}

/* Contribution of an effect to the energy of the bodies since t = 0: its work and stored energy,
 * minus energy from outside (eq:energy-growth). */
static double given_by(const ct_monitor *w, int32_t k)
{
  const ct_effect_energy *own = &w->next.effects[k];
  return w->problem->effects[k]->calls->energy == NULL
             ? 0.0
             : (own->work + (own->stored - lent_to(w, k))) - own->external;
}

static ct_status measure(ct_monitor *w, ct_state *state, energies *e, ct_error *error)
{
  ct_status status = ct_ledger_of(w->problem, state, &w->next, error);
  if (status != CT_OK) return status;
  ct_energy ledger = w->next.energy;
  double stored = ledger.total - ledger.kinetic + ledger.external,
         elastic = ledger.strain + ledger.contact;
  *e = (energies){.elastic = elastic, .appeared = ledger.total - w->start};
  for (int32_t k = 0; k < w->problem->effect_count; k++) {
    const ct_effect *effect = w->problem->effects[k];
    double lent = lent_to(w, k);
    e->appeared -= lent;
    if (effect->kind == CT_EFFECT_CONTACT) e->elastic -= lent;
    if (is_alone(effect)) e->alone += given_by(w, k);
  }
  // Initial energy and external work, minus the energy stored by other effects.
  e->expected = w->start + ledger.external - (stored - elastic);
  e->most_expected = fmax(fmax(e->expected, w->expected), 0.0);
  e->scale = fmax(fabs(ledger.kinetic), fmax(fabs(stored), fabs(ledger.external)));
  e->least = fmax(w->floor, 1e-9 * fmax(w->largest, e->scale));
  return CT_OK;
}

/* Energy that round-off can cause: a fraction ε of the energy that the material could store, Σ m
 * c₁² (eq:energy-floor). */
static double floor_of(const ct_problem *problem)
{
  double sum = 0.0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_body *body = &problem->bodies[b];
    double c1, c2, mass = ct_sum(&problem->mass[body->first_node], body->mesh->node_count);
    ct_material_speeds(&body->material, &c1, &c2);
    sum += mass * c1 * c1;
  }
  return DBL_EPSILON * sum;
}

/* What the effects have given, when the bodies alone have been given least (eq:growth-again). */
static void keep_lowest(ct_monitor *w, const energies *e)
{
  w->lowest = e->alone;
  for (int32_t k = 0; k < w->problem->effect_count; k++) w->low[k] = given_by(w, k);
}

/* Store the first growth above the reporting limits, and the largest so far (eq:energy-growth,
 * eq:growth-again). */
static void note_growth(ct_monitor *w, const ct_state *state, const energies *e)
{
  const double appeared = e->appeared + w->jump, expected = e->most_expected - w->jump,
               total = w->next.energy.total, limit = w->options.growth_limit * expected,
               again = fmin(e->alone - w->lowest, total - w->least); // (eq:growth-again)
  const int above = appeared > fmax(limit, e->least),
            regained = again > fmax(AGAIN * limit, e->least);
  // That of a divided step was in the solid.
  double most = above && w->jump > 0.0 ? w->jump : -INFINITY;
  if (e->alone < w->lowest) keep_lowest(w, e);
  w->least = fmin(w->least, total);
  if (!above && !regained) return;
  const double grown = regained ? fmax(appeared, again) : appeared,
               ratio = expected > 0.0 ? grown / expected : INFINITY;
  w->growth.largest = fmax(w->growth.largest, ratio);
  if (w->growth.ratio > 0.0) return;
  w->growth.ratio = ratio;
  w->growth.time = state->time;
  w->growth.step = state->step;
  for (int32_t k = 0; k < w->problem->effect_count; k++) {
    double gave = given_by(w, k) - (above ? w->gave : w->low)[k];
    if (gave > most && (above || is_alone(w->problem->effects[k])))
      most = gave, w->growth.effect = k;
  }
  w->growth.body = ct_effect_body_of(w->problem, largest_node(w->problem, state, NULL));
}

static ct_status check_energy(ct_monitor *w, const ct_state *state, const energies *e,
                              ct_error *error)
{
  // -- What motion and strain should have at most, and what they have too much
  double limit = w->options.energy_limit, expected = e->most_expected;
  // -- A growing oscillation, which the total of the energy balance does not show (eq:energy-grows)
  double grown = w->swing * e->elastic - expected;
  // (eq:energy-appears)
  if (isinf(limit) || !(fmax(e->appeared, grown) > fmax(limit * expected, e->least))) return CT_OK;
  ct_place at = ct_effect_place(w->problem, largest_node(w->problem, state, NULL));
  return ct_fail(
      error, CT_ERROR_ENERGY, at,
      "spurious energy: %.3g more than the %.3g that the bodies should have by t = %g (step "
      "%lld); most of it moves at body %s, node %d",
      fmax(e->appeared, grown), expected, state->time, (long long)state->step,
      w->problem->bodies[at.body].name, (int)at.point);
}

/* Uniform on (-1, 1), the same for each run. */
static double noise(uint64_t *seed) { return ct_random_bits(seed) / 4503599627370496.0 - 1.0; }

/* Scale the direction to p · M p = 1, with some noise, so that no direction is lost; fixed
 * components are 0. */
static void normalise(ct_monitor *w)
{
  const ct_problem *problem = w->problem;
  double norm = sqrt(ct_sum_product(problem->node_count, problem->mass, w->mode, w->mode));
  double share = NOISE / sqrt(3.0 * (double)problem->node_count);
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count; d++) {
    double old = norm > 0.0 ? w->mode[d] / norm : 0.0, root = sqrt(problem->inverse_mass[d]);
    w->mode[d] = problem->inverse_mass[d] > 0.0 ? old + share * root * noise(&w->seed) : 0.0;
  }
  norm = sqrt(ct_sum_product(problem->node_count, problem->mass, w->mode, w->mode));
  for (int64_t d = 0; d < 3 * (int64_t)problem->node_count && norm > 0.0; d++) w->mode[d] /= norm;
}

/* One round of the power iteration about the state, whose forces are known: one further evaluation
 * of the solid's force (eq:step-quotient). */
static ct_status iterate(ct_monitor *w, ct_state *state, ct_error *error)
{
  const ct_problem *problem = w->problem;
  const ct_effect *solid = problem->effects[0];
  int64_t count = 3 * (int64_t)problem->node_count;
  double top = 0.0;
  normalise(w);
  for (int64_t d = 0; d < count; d++) top = fmax(top, fabs(w->mode[d]));
  if (!(top > 0.0)) return CT_OK;
  double small = SMALL * w->edge / top;
  for (int64_t d = 0; d < count; d++) w->moved[d] = state->displacement[d] + small * w->mode[d];
  ct_view view = ct_workspace_view(problem, state, 0);
  view.displacement = w->moved;
  view.scratch = w->scratch;
  ct_status status = solid->calls->force(solid, &view, w->force, error);
  if (status != CT_OK) return status;
  // -- ω² = p · K p over p · M p = 1, then p becomes M⁻¹ K p
  for (int32_t n = 0; n < problem->node_count; n++) {
    double before[3], *change = &w->force[3 * (int64_t)n];
    ct_workspace_force_at(problem, state, 0, n, before);
    for (int c = 0; c < 3; c++) change[c] = (before[c] - change[c]) / small; // (eq:step-quotient)
  }
  w->omega_squared = ct_sum_product(problem->node_count, NULL, w->mode, w->force);
  memcpy(w->moved, w->mode, (size_t)count * sizeof *w->moved);
  for (int64_t d = 0; d < count; d++) w->mode[d] = problem->inverse_mass[d] * w->force[d];
  // Numbers too large or too small for a quotient give no result; the next round begins again.
  if (!isfinite(w->omega_squared) ||
      !isfinite(ct_sum_product(problem->node_count, problem->mass, w->mode, w->mode))) {
    memset(w->mode, 0, (size_t)count * sizeof *w->mode);
    w->omega_squared = 0.0;
  }
  return CT_OK;
}

static ct_status check_stiffness(ct_monitor *w, ct_state *state, ct_error *error)
{
  const ct_problem *problem = w->problem;
  if (w->mode == NULL) return CT_OK;
  ct_status status = CT_OK;
  for (int i = 0; status == CT_OK && i < ROUNDS; i++) status = iterate(w, state, error);
  double limit = 0.5 * w->options.omega_limit * ct_integrator_limit(&problem->integrator),
         omega = sqrt(fmax(w->omega_squared, 0.0));
  if (status != CT_OK || !(omega * problem->dt > limit * (1.0 + 1e-4))) return status;
  ct_place at = ct_effect_place(problem, largest_node(problem, state, w->moved));
  at.element = element_with(problem->bodies[at.body].mesh, (int32_t)at.point);
  return ct_fail(error, CT_ERROR_STEP, at,
                 "by t = %g (step %lld) the solid is too stiff for the time step %g, which may be "
                 "%g at most: body %s, element %lld",
                 state->time, (long long)state->step, problem->dt, limit / omega,
                 problem->bodies[at.body].name, (long long)at.element);
}

/* Whether the state is the one of the last check. */
static int is_good(const ct_monitor *w, const ct_state *state)
{
  size_t bytes = 3 * (size_t)w->problem->node_count * sizeof(double);
  return w->good->step == state->step &&
         memcmp(w->good->displacement, state->displacement, bytes) == 0 &&
         memcmp(w->good->velocity, state->velocity, bytes) == 0;
}

/* The measured row becomes that of the good state. */
static void keep_ledger(ct_monitor *w)
{
  ct_ledger before = w->ledger;
  w->ledger = w->next;
  w->next = before;
}

/* Check within a series of steps; this does not wake sleeping elements. */
static ct_status examine(void *data, ct_state *state, ct_error *error)
{
  ct_monitor *monitor = data;
  energies e;
  ct_status status = measure(monitor, state, &e, error);
  if (status == CT_OK) status = check_energy(monitor, state, &e, error);
  if (status == CT_OK) status = check_stiffness(monitor, state, error);
  if (status == CT_OK) status = ct_state_copy(monitor->problem, state, monitor->good, error);
  if (status != CT_OK) return status;
  note_growth(monitor, state, &e);
  keep_ledger(monitor);
  monitor->largest = fmax(monitor->largest, e.scale);
  monitor->expected = fmax(monitor->expected, e.expected);
  return CT_OK;
}

ct_status ct_monitor_check(ct_monitor *monitor, ct_state *state, ct_error *error)
{
  if (monitor == NULL || state == NULL) return CT_REFUSE_NULL(error);
  if (is_good(monitor, state)) return CT_OK;
  // Known forces may be older than the last change of the state by its host.
  ct_series_begin(state, 0);
  ct_error own = {.body = -1, .element = -1, .point = -1};
  const ct_status status = examine(monitor, state, &own);
  return ct_run_complete(monitor->problem, state, status, &own, error);
}

/* Whether the state is that of the last check, with all inputs of its forces. */
static ct_status prepare_steps(void *data, const ct_problem *problem, ct_state *state,
                               int64_t count, ct_error *error)
{
  const ct_monitor *w = data;
  (void)count;
  if (w == NULL || problem != w->problem)
    return CT_REFUSE(error, "run: the monitor belongs to another problem");
  size_t bytes = (size_t)state->memory_count * sizeof *state->memory;
  if (state->problem == w->problem && is_good(w, state) &&
      memcmp(w->good->memory, state->memory, bytes) == 0)
    state->workspace->unchanged = 1;
  return CT_OK;
}

ct_observer ct_monitor_observer(ct_monitor *monitor)
{
  static const ct_observer_calls CALLS = {.prepare = prepare_steps, .check = examine};
  return (ct_observer){
      .calls = &CALLS, .data = monitor, .every = monitor != NULL ? monitor->options.every : 1};
}

/* First rounds of the power iteration. The stiffness of a linear solid does not change, so it is
 * not checked again. */
static ct_status prepare_iteration(ct_monitor *w, ct_state *state, ct_error *error)
{
  const ct_effect *solid = w->problem->effects[0];
  if (ct_problem_is_linear(w->problem) || isinf(w->options.omega_limit)) return CT_OK;
  double **arrays[] = {&w->mode, &w->moved, &w->force};
  for (int i = 0; i < 3; i++)
    *arrays[i] = ct_pool_take(&w->pool, (size_t)w->problem->node_count, 3 * sizeof(double));
  if (w->pool.failed) return CT_NO_MEMORY(error, "a monitor");
  w->edge = ct_problem_edge(w->problem);
  ct_status status = solid->calls->create_scratch == NULL
                         ? CT_OK
                         : solid->calls->create_scratch(solid, &w->scratch, error);
  for (int i = 0; status == CT_OK && i < FIRST_ROUNDS; i++) status = iterate(w, state, error);
  return status;
}

/* The good state, and the arrays of all monitors. */
static ct_status allocate(ct_monitor *w, ct_error *error)
{
  size_t bodies = (size_t)w->problem->body_count, effects = (size_t)w->problem->effect_count;
  ct_ledger *row[] = {&w->ledger, &w->next};
  w->gave = ct_pool_take(&w->pool, effects, sizeof *w->gave);
  w->low = ct_pool_take(&w->pool, effects, sizeof *w->low);
  for (int i = 0; i < 2; i++) {
    row[i]->momentum = ct_pool_take(&w->pool, bodies, sizeof *row[i]->momentum);
    row[i]->effects = ct_pool_take(&w->pool, effects, sizeof *row[i]->effects);
  }
  if (w->pool.failed) return CT_NO_MEMORY(error, "a monitor");
  return ct_state_allocate(w->problem, &w->good, error);
}

static ct_status prepare(ct_monitor *w, ct_state *state, ct_error *error)
{
  const ct_problem *problem = w->problem;
  ct_stable_step stable = {.dt = w->options.stable};
  energies e;
  ct_status status = allocate(w, error);
  ct_series_begin(state, 0);
  if (status == CT_OK && stable.dt == 0.0) status = ct_stable(problem, NULL, &stable, error);
  if (status == CT_OK) status = measure(w, state, &e, error);
  if (status != CT_OK) return status;
  // Before the start no energy was known: all of it counts as new, also what contacts store.
  w->start = w->least = w->next.energy.total;
  if (isfinite(w->options.first_total)) w->jump = w->start - w->options.first_total;
  w->floor = floor_of(problem);
  w->largest = e.scale;
  w->expected = w->start + e.expected;
  w->swing = fmax(1.0 - problem->dt * problem->dt / (stable.dt * stable.dt), 0.02);
  for (int32_t k = 0; k < problem->effect_count; k++) w->gave[k] = given_by(w, k) + lent_to(w, k);
  keep_lowest(w, &e);
  keep_ledger(w);
  status = prepare_iteration(w, state, error);
  return status == CT_OK ? ct_state_copy(problem, state, w->good, error) : status;
}

ct_status ct_monitor_create(const ct_problem *problem, ct_state *state,
                            const ct_monitor_options *options, ct_monitor **out, ct_error *error)
{
  if (problem == NULL || state == NULL || options == NULL || out == NULL)
    return CT_REFUSE_NULL(error);
  if (state->problem != problem)
    return CT_REFUSE(error, "monitor: the state belongs to another problem");
  ct_status status = ct_check_options(options->cookie, "ct_monitor_options_default", error);
  if (status != CT_OK) return status;
  if (options->every < 1)
    return CT_REFUSE(error, "monitor: every must be at least 1 step, not %lld",
                     (long long)options->every);
  const double limit[4] = {options->energy_limit, options->omega_limit, options->stable,
                           options->growth_limit};
  static const char *const NAME[4] = {"energy_limit", "omega_limit", "stable", "growth_limit"};
  for (int i = 0; i < 4; i++)
    if (!(i < 2 ? limit[i] > 0.0 : limit[i] >= 0.0))
      return CT_REFUSE(error, "monitor: %s must %s, not %g", NAME[i],
                       i < 2 ? "be positive" : "be 0 or positive", limit[i]);
  ct_monitor *w = ct_allocate(1, sizeof *w);
  if (w == NULL) return CT_NO_MEMORY(error, "a monitor");
  w->problem = problem;
  w->options = *options;
  w->seed = 88172645463325252u;
  status = prepare(w, state, error);
  if (status != CT_OK) ct_monitor_free(w);
  else *out = w;
  return status;
}

void ct_monitor_free(ct_monitor *w)
{
  if (w == NULL) return;
  if (w->scratch != NULL) w->problem->effects[0]->calls->free_scratch(w->scratch);
  ct_state_free(w->good);
  ct_pool_free(w);
}

ct_state *ct_monitor_good(const ct_monitor *monitor)
{
  // The forces of good states are computed on demand, because most runs have no fault.
  return monitor == NULL || ct_state_equip(monitor->good, NULL) != CT_OK ? NULL : monitor->good;
}

const ct_ledger *ct_monitor_ledger(const ct_monitor *monitor)
{
  return monitor == NULL ? NULL : &monitor->ledger;
}

ct_growth ct_monitor_growth(const ct_monitor *monitor)
{
  return monitor == NULL ? (ct_growth){0} : monitor->growth;
}
