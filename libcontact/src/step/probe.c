/* Histories of points, surfaces and resultants, one row per step, recorded in the time loop. */
#include <libcontact/base.h>
#include <libcontact/observe.h>

#include "../base/error.h"
#include "../base/list.h"
#include "../base/memory.h"
#include "../solid/element.h"
#include "../solid/sleep.h"
#include "workspace.h"

#include <math.h>
#include <string.h>

enum { QUANTITIES = 8, LONGEST_NAME = 63, FIRST_ROWS = 64 };
static const int WIDTH[QUANTITIES] = {1, 3, 3, 3, 6, 1, 3, 3};

/* The i-th node of an effect of the problem. */
typedef struct place {
  int32_t effect, i;
} place;

typedef struct probe {
  ct_probe_def def;
  char name[LONGEST_NAME + 1];
  int32_t column[QUANTITIES], width;
  place *places; /* nodes at which forces are summed */
  int32_t place_count;
  double mass; /* of its nodes */
  double *rows;
  int64_t row_count, capacity;
} probe;

struct ct_probes {
  ct_pool pool;
  const ct_problem *problem;
  int32_t count;
  probe *list;
  double *terms; /* of a sum, for x, then y, then z */
};

ct_probe_def ct_probe_def_default(void)
{
  return (ct_probe_def){.cookie = CT_DEF_COOKIE, .every = 1, .element = -1, .axes = {1, 1, 1}};
}

static int takes_motion(const probe *p)
{
  return p->def.take[CT_QUANTITY_DISPLACEMENT] || p->def.take[CT_QUANTITY_VELOCITY] ||
         p->def.take[CT_QUANTITY_ACCELERATION];
}

static int takes_stress(const probe *p)
{
  return p->def.take[CT_QUANTITY_STRESS] || p->def.take[CT_QUANTITY_PRESSURE];
}

static int takes_force(const probe *p)
{
  return p->def.take[CT_QUANTITY_FORCE] || p->def.take[CT_QUANTITY_MOMENT];
}

/* -- Create -- */

static ct_status check_nodes(const ct_problem *problem, const probe *p, ct_error *error)
{
  const ct_probe_def *def = &p->def;
  for (int32_t i = 0; i < def->node_count; i++)
    if (def->nodes[i] < 0 || def->nodes[i] >= problem->node_count)
      return CT_REFUSE(error, "probe %s: there is no node %d; there are nodes 0 to %d", p->name,
                       (int)def->nodes[i], (int)problem->node_count - 1);
    else if (i > 0 && def->nodes[i] <= def->nodes[i - 1])
      return CT_REFUSE(error, "probe %s: its nodes must ascend, but %d stands after %d", p->name,
                       (int)def->nodes[i], (int)def->nodes[i - 1]);
  return CT_OK;
}

static ct_status check(const ct_problem *problem, const probe *p, ct_error *error)
{
  const ct_probe_def *def = &p->def;
  int taken = takes_motion(p) + takes_stress(p) + takes_force(p);
  if (taken == 0)
    return CT_REFUSE(error, "probe %s: it takes nothing; choose at least one quantity", p->name);
  if (def->every < 1)
    return CT_REFUSE(error, "probe %s: every must be at least 1 step, not %lld", p->name,
                     (long long)def->every);
  if (takes_motion(p) && (def->nodes == NULL || def->node_count < 1))
    return CT_REFUSE(error, "probe %s: its list of nodes is empty; motion is taken of nodes",
                     p->name);
  if (takes_force(p) && (def->effects == NULL || def->effect_count < 1))
    return CT_REFUSE(error, "probe %s: its list of effects is empty; force is taken of effects",
                     p->name);
  if (takes_stress(p) && (def->body < 0 || def->body >= problem->body_count || def->element < 0 ||
                          def->element >= problem->bodies[def->body].mesh->element_count))
    return CT_REFUSE(error, "probe %s: body %d has no element %d", p->name, (int)def->body,
                     (int)def->element);
  for (int32_t k = 0; takes_force(p) && k < def->effect_count; k++)
    if (def->effects[k] < 0 || def->effects[k] >= problem->effect_count)
      return CT_REFUSE(error, "probe %s: there is no effect %d", p->name, (int)def->effects[k]);
  return check_nodes(problem, p, error);
}

/* The name, which becomes that of a dataset in a results file. */
static ct_status take_name(ct_probes *probes, int32_t i, const char *name, ct_error *error)
{
  probe *p = &probes->list[i];
  size_t length = name == NULL ? 0 : strlen(name);
  if (length == 0 || length > LONGEST_NAME || strchr(name, '/') != NULL || strcmp(name, ".") == 0)
    return CT_REFUSE(error, "probe %d needs a name of 1 to 63 bytes without a slash", (int)i);
  memcpy(p->name, name, length);
  for (int32_t k = 0; k < i; k++)
    if (strcmp(probes->list[k].name, p->name) == 0)
      return CT_REFUSE(error, "two probes are called %s", p->name);
  return CT_OK;
}

/* List the places of the effects' forces at the nodes of the probe. */
static void list_places(ct_probes *probes, probe *p)
{
  const ct_probe_def *def = &p->def;
  size_t most = 0;
  for (int32_t k = 0; k < def->effect_count; k++)
    most += (size_t)probes->problem->effects[def->effects[k]]->node_count;
  p->places = ct_pool_take(&probes->pool, most, sizeof *p->places);
  for (int32_t k = 0; p->places != NULL && k < def->effect_count; k++) {
    const ct_effect *effect = probes->problem->effects[def->effects[k]];
    for (int32_t i = 0; i < effect->node_count; i++) {
      int32_t node = ct_effect_node(effect, i),
              at = ct_lower_bound(def->nodes, def->node_count, node);
      if (def->nodes == NULL || (at < def->node_count && def->nodes[at] == node))
        p->places[p->place_count++] = (place){def->effects[k], i};
    }
  }
}

static ct_status create_probe(ct_probes *probes, int32_t i, const ct_probe_def *def,
                              ct_error *error)
{
  probe *p = &probes->list[i];
  if (def->cookie != CT_DEF_COOKIE)
    return CT_REFUSE(error, "probe %d: its definition does not start from its default", (int)i);
  p->def = *def;
  p->def.take[CT_QUANTITY_TIME] = 1;
  ct_status status = take_name(probes, i, def->name, error);
  if (status == CT_OK) status = check(probes->problem, p, error);
  if (status != CT_OK) return status;
  for (int q = 0; q < QUANTITIES; q++) {
    p->column[q] = p->def.take[q] ? p->width : -1;
    p->width += p->def.take[q] ? WIDTH[q] : 0;
  }
  size_t nodes = def->nodes == NULL ? 0 : (size_t)def->node_count;
  p->def.nodes =
      nodes == 0 ? NULL : ct_pool_copy(&probes->pool, def->nodes, nodes * sizeof(int32_t));
  if (takes_force(p)) list_places(probes, p);
  p->def.effects = NULL;
  return CT_OK;
}

/* Memory for the terms of the longest sum, and the masses of the nodes. */
static void finish(ct_probes *probes)
{
  int32_t most = 0;
  for (int32_t i = 0; i < probes->count; i++) {
    const probe *p = &probes->list[i];
    int32_t own = p->place_count > p->def.node_count ? p->place_count : p->def.node_count;
    most = own > most ? own : most;
  }
  probes->terms = ct_pool_take(&probes->pool, (size_t)most, 3 * sizeof *probes->terms);
  for (int32_t i = 0; !probes->pool.failed && i < probes->count; i++) {
    probe *p = &probes->list[i];
    int32_t count = p->def.nodes == NULL ? 0 : p->def.node_count;
    for (int32_t n = 0; n < count; n++) probes->terms[n] = probes->problem->mass[p->def.nodes[n]];
    p->mass = ct_sum(probes->terms, count);
  }
}

ct_status ct_probes_create(const ct_problem *problem, const ct_probe_def *defs, int32_t count,
                           ct_probes **out, ct_error *error)
{
  if (problem == NULL || out == NULL || count < 0 || (count > 0 && defs == NULL))
    return CT_REFUSE(error, "probes: defs is null, or their number is %d", (int)count);
  ct_probes *probes = ct_allocate(1, sizeof *probes);
  if (probes == NULL) return CT_NO_MEMORY(error, "probes");
  probes->problem = problem;
  probes->list = ct_pool_take(&probes->pool, (size_t)count, sizeof *probes->list);
  ct_status status = CT_OK;
  for (int32_t i = 0; status == CT_OK && !probes->pool.failed && i < count; i++) {
    probes->count++;
    status = create_probe(probes, i, &defs[i], error);
  }
  if (status == CT_OK) finish(probes);
  if (status == CT_OK && probes->pool.failed) status = CT_NO_MEMORY(error, "probes");
  if (status == CT_OK) *out = probes;
  else ct_probes_free(probes);
  return status;
}

void ct_probes_free(ct_probes *probes)
{
  for (int32_t i = 0; probes != NULL && i < probes->count; i++) ct_release(probes->list[i].rows);
  ct_pool_free(probes);
}

/* -- Take a row -- */

/* One of three vectors of a node at t_n, as in records. */
static void motion_of(const ct_problem *problem, const ct_state *state, int quantity, int32_t node,
                      double out[3])
{
  int64_t dof = 3 * (int64_t)node;
  if (quantity == CT_QUANTITY_DISPLACEMENT) memcpy(out, &state->displacement[dof], 3 * sizeof *out);
  else if (quantity == CT_QUANTITY_VELOCITY) ct_mean_velocity(problem, state, node, node + 1, out);
  else
    for (int c = 0; c < 3; c++)
      out[c] = problem->inverse_mass[dof + c] * state->workspace->total[dof + c];
}

/* Σ m u / Σ m; of a single node its own bits (eq:probe-mean). */
static void take_motion(ct_probes *probes, const probe *p, const ct_state *state, int quantity,
                        double *out)
{
  const ct_problem *problem = probes->problem;
  int32_t count = p->def.node_count;
  if (count == 1) {
    motion_of(problem, state, quantity, p->def.nodes[0], out);
    return;
  }
  for (int32_t i = 0; i < count; i++) {
    int32_t node = p->def.nodes[i];
    double own[3];
    motion_of(problem, state, quantity, node, own);
    for (int c = 0; c < 3; c++)
      probes->terms[(int64_t)c * count + i] = problem->mass[node] * own[c];
  }
  // (eq:probe-mean)
  for (int c = 0; c < 3; c++) out[c] = ct_sum(&probes->terms[(int64_t)c * count], count) / p->mass;
}

/* Stress at the centre of the element; NaN if the element is inverted, because a probe must not end
 * a run. */
static void take_stress(const ct_probes *probes, const probe *p, const ct_state *state, double *row)
{
  static const double centre[3] = {0.0, 0.0, 0.0};
  const ct_body *body = &probes->problem->bodies[p->def.body];
  const double *displacement = &state->displacement[3 * (int64_t)body->first_node];
  double x[20][3], u[20][3], stress[6];
  int32_t per = ct_brick_node_count(body->mesh->kind);
  const int32_t *nodes = &body->mesh->elements[(int64_t)per * p->def.element];
  for (int32_t a = 0; a < per; a++) {
    memcpy(x[a], &body->mesh->nodes[3 * (int64_t)nodes[a]], sizeof x[a]);
    memcpy(u[a], &displacement[3 * (int64_t)nodes[a]], sizeof u[a]);
  }
  if (ct_solid_element_stress(body->mesh->kind, &x[0][0], &u[0][0],
                              ct_body_material(body, p->def.element), centre, stress,
                              NULL) != CT_OK)
    for (int i = 0; i < 6; i++) stress[i] = NAN;
  for (int i = 0; i < 6; i++) stress[i] += body->initial_stress[i];
  int32_t all = p->column[CT_QUANTITY_STRESS], mean = p->column[CT_QUANTITY_PRESSURE];
  if (all >= 0) memcpy(&row[all], stress, sizeof stress);
  if (mean >= 0) row[mean] = (0.0 - ((stress[0] + stress[1]) + stress[2])) / 3.0;
}

/* Σ f, or Σ x × f about the origin (eq:probe-resultant). */
static void take_force(ct_probes *probes, const probe *p, const ct_state *state, int quantity,
                       double *out)
{
  const ct_problem *problem = probes->problem;
  int32_t count = p->place_count;
  for (int32_t i = 0; i < count; i++) {
    place at = p->places[i];
    int64_t dof = 3 * (int64_t)ct_effect_node(problem->effects[at.effect], at.i);
    double f[3], x[3];
    ct_workspace_force_at(problem, state, at.effect, at.i, f);
    for (int c = 0; c < 3; c++) {
      if (!p->def.axes[c]) f[c] = 0.0;
      x[c] = problem->reference[dof + c] + state->displacement[dof + c];
    }
    for (int c = 0; c < 3; c++) {
      int a = (c + 1) % 3, b = (c + 2) % 3;
      // (eq:probe-resultant)
      probes->terms[(int64_t)c * count + i] =
          quantity == CT_QUANTITY_FORCE ? f[c] : x[a] * f[b] - x[b] * f[a];
    }
  }
  for (int c = 0; c < 3; c++) out[c] = ct_sum(&probes->terms[(int64_t)c * count], count);
}

/* The rows of a state whose forces are known, within the capacity. The time of a restart may equal
 * that of a row up to round-off. */
static void take(void *data, const ct_state *state)
{
  ct_probes *probes = data;
  for (int32_t i = 0; i < probes->count; i++) {
    probe *p = &probes->list[i];
    double *row = &p->rows[p->row_count * p->width];
    if (state->step % p->def.every != 0 ||
        (p->row_count > 0 && row[-p->width] > state->time - 0.5 * probes->problem->dt))
      continue;
    row[0] = state->time;
    for (int q = CT_QUANTITY_DISPLACEMENT; q <= CT_QUANTITY_ACCELERATION; q++)
      if (p->column[q] >= 0) take_motion(probes, p, state, q, &row[p->column[q]]);
    if (takes_stress(p)) take_stress(probes, p, state, row);
    for (int q = CT_QUANTITY_FORCE; q <= CT_QUANTITY_MOMENT; q++)
      if (p->column[q] >= 0) take_force(probes, p, state, q, &row[p->column[q]]);
    p->row_count++;
  }
}

/* -- The time loop -- */

/* Enlarge the capacity for some more rows. */
static ct_status grow(probe *p, int64_t more, ct_error *error)
{
  if (p->row_count + more <= p->capacity) return CT_OK;
  int64_t capacity = 2 * p->capacity > p->row_count + more ? 2 * p->capacity : p->row_count + more;
  double *rows = ct_allocate((size_t)capacity, (size_t)p->width * sizeof *rows);
  if (rows == NULL)
    return CT_NO_MEMORY(error, "%lld rows of probe %s", (long long)capacity, p->name);
  if (p->row_count > 0) memcpy(rows, p->rows, (size_t)(p->row_count * p->width) * sizeof *rows);
  ct_release(p->rows);
  p->rows = rows;
  p->capacity = capacity;
  return CT_OK;
}

/* Nodes of a probe are moved individually even if the rest of a body sleeps. */
static void keep_moving(const ct_probes *probes, const probe *p, ct_state *state)
{
  struct ct_sleep *sleep = state->workspace->sleep;
  if (takes_motion(p)) ct_sleep_share(sleep, p->def.node_count, p->def.nodes);
  for (int32_t i = 0; p->def.take[CT_QUANTITY_MOMENT] && i < p->place_count; i++) {
    int32_t node = ct_effect_node(probes->problem->effects[p->places[i].effect], p->places[i].i);
    ct_sleep_share(sleep, 1, &node);
  }
  if (!takes_stress(p)) return;
  const ct_body *body = &probes->problem->bodies[p->def.body];
  int32_t per = ct_brick_node_count(body->mesh->kind);
  for (int32_t a = 0; a < per; a++) {
    int32_t node = body->first_node + body->mesh->elements[(int64_t)per * p->def.element + a];
    ct_sleep_share(sleep, 1, &node);
  }
}

/* Drop rows that are later than the state, and allocate the rows of some steps. */
static ct_status prepare(void *data, const ct_problem *problem, ct_state *state, int64_t count,
                         ct_error *error)
{
  ct_probes *probes = data;
  (void)problem;
  if (probes == NULL || state == NULL || state->problem != probes->problem)
    return CT_REFUSE(error, "probes: the state belongs to another problem");
  double last = state->time + 0.5 * probes->problem->dt;
  for (int32_t i = 0; i < probes->count; i++) {
    probe *p = &probes->list[i];
    while (p->row_count > 0 && p->rows[(p->row_count - 1) * p->width] > last) p->row_count--;
    ct_status status = grow(p, count / p->def.every + 2, error);
    if (status != CT_OK) return status;
    keep_moving(probes, p, state);
  }
  return CT_OK;
}

ct_observer ct_probes_observer(ct_probes *probes)
{
  static const ct_observer_calls CALLS = {.prepare = prepare, .sample = take};
  return (ct_observer){.calls = &CALLS, .data = probes, .every = 1};
}

ct_status ct_probes_sample(ct_probes *probes, ct_state *state, ct_error *error)
{
  ct_status status = prepare(probes, NULL, state, 0, error);
  if (status == CT_OK) status = ct_stage_check(state, error);
  if (status == CT_OK) status = ct_workspace_forces(probes->problem, state, error);
  if (status == CT_OK) take(probes, state);
  return status;
}

/* -- What was taken -- */

ct_status ct_probes_history(const ct_probes *probes, int32_t i, ct_probe_history *history,
                            ct_error *error)
{
  if (probes == NULL || history == NULL) return CT_REFUSE_NULL(error);
  if (i < 0 || i >= probes->count) return CT_REFUSE(error, "probes: there is no probe %d", (int)i);
  const probe *p = &probes->list[i];
  *history = (ct_probe_history){
      .name = p->name, .width = p->width, .row_count = p->row_count, .rows = p->rows};
  memcpy(history->column, p->column, sizeof p->column);
  return CT_OK;
}

ct_status ct_probes_subdivide_step(ct_probes *probes, const ct_problem *problem, int64_t parts,
                                   ct_error *error)
{
  if (probes == NULL || problem == NULL) return CT_REFUSE_NULL(error);
  if (parts < 1)
    return CT_REFUSE(error, "probes: parts must be at least 1, not %lld", (long long)parts);
  if (problem->node_count != probes->problem->node_count ||
      problem->effect_count != probes->problem->effect_count)
    return CT_REFUSE(error, "probes: the problem has other nodes or effects than theirs");
  probes->problem = problem;
  for (int32_t i = 0; i < probes->count; i++) probes->list[i].def.every *= parts;
  return CT_OK;
}

ct_status ct_probes_restore(ct_probes *probes, int32_t i, const double *rows, int64_t count,
                            ct_error *error)
{
  if (probes == NULL || count < 0 || (rows == NULL && count > 0)) return CT_REFUSE_NULL(error);
  if (i < 0 || i >= probes->count) return CT_REFUSE(error, "probes: there is no probe %d", (int)i);
  probe *p = &probes->list[i];
  p->row_count = 0;
  ct_status status = grow(p, count, error);
  if (status != CT_OK) return status;
  if (count > 0) memcpy(p->rows, rows, (size_t)(count * p->width) * sizeof *rows);
  p->row_count = count;
  return CT_OK;
}
