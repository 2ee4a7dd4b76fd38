/* Quiet regions in a lattice: what rows of bits say is what the elements say one by one; nodes that
 * are adrift, and the order of numbers, change no bit. */
#include "../../libcontact/src/base/bits.h"
#include "../../libcontact/src/base/memory.h"
#include "../../libcontact/src/solid/lattice.h"
#include "../../libcontact/src/solid/quiet.h"
#include "../../libcontact/src/step/workspace.h"
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* One element as the theory has it, without rows and words. */
typedef struct cell {
  int moving, fresh, asleep, led;
} cell;

/* A lattice somewhere in a problem, and what is expected of it. */
typedef struct model {
  ct_mesh *mesh;
  ct_solid_part part;
  int32_t node_count; /* of the problem */
  double *u, *v;
  uint64_t *drifted;
  cell *cells;
  int known;
} model;

static int node_of(const model *m, int e, int a)
{
  return m->part.first_node + m->mesh->elements[8 * e + a];
}

static int alike(const model *m, int e, const double *values)
{
  const double *first = &values[3 * node_of(m, e, 0)];
  for (int a = 1; a < 8; a++)
    if (memcmp(&values[3 * node_of(m, e, a)], first, 24) != 0) return 0;
  return isfinite(first[0]) && isfinite(first[1]) && isfinite(first[2]);
}

/* What a call has to find at one element. */
static void step_cell(const model *m, int e, int call, int in_series, const ct_leader *leader)
{
  cell *c = &m->cells[e];
  int woken = !in_series;
  for (int a = 0; in_series && a < 8; a++) woken |= !ct_bits_get(m->drifted, node_of(m, e, a));
  if (woken) c->asleep = c->led = 0;
  if (c->asleep || (c->moving && !c->fresh && m->known && e % m->part.cells[0] % 8 != call % 8))
    return;
  int same = alike(m, e, m->u), calm = same && (!c->moving || c->fresh);
  c->fresh = same && !calm;
  c->moving = !calm;
  if (!calm || woken || !in_series || !alike(m, e, m->v)) return;
  const double *u = &m->u[3 * node_of(m, e, 0)], *v = &m->v[3 * node_of(m, e, 0)];
  c->asleep = 1;
  c->led = leader != NULL && memcmp(u, leader->displacement, 24) == 0 &&
           memcmp(v, leader->velocity, 24) == 0;
}

/* Answers how many entries of what was found are not what the elements say. */
static int faults(const model *m, const ct_found *found)
{
  int wrong = 0, elements = m->mesh->element_count;
  char *changed = room(m->node_count, 1), *drifts = room(m->node_count, 1),
       *computed = room(m->part.batch_count, 1), *read = room(m->part.batch_count, 1),
       *alone = room(m->part.batch_count, 1);
  for (int e = 0; e < elements; e++)
    for (int a = 0; a < 8; a++) changed[node_of(m, e, a)] |= (char)m->cells[e].moving;
  memset(alone, 1, (size_t)m->part.batch_count);
  for (int n = 0; n < m->mesh->node_count; n++) drifts[m->part.first_node + n] = 1;
  for (int e = 0; e < elements; e++) {
    int reached = 0;
    for (int a = 0; a < 8; a++) reached |= changed[node_of(m, e, a)];
    computed[e / 8] |= (char)m->cells[e].moving;
    read[e / 8] |= (char)reached;
    alone[e / 8] &= (char)(m->cells[e].led && !reached);
  }
  for (int e = 0; e < elements; e++)
    for (int a = 0; a < 8; a++) drifts[node_of(m, e, a)] &= alone[e / 8];
  for (int b = 0; b < m->part.batch_count; b++)
    wrong += (found->computed[b] != 0) != computed[b] || (found->read[b] != 0) != read[b];
  for (int n = m->part.first_node; n < m->part.first_node + m->mesh->node_count; n++)
    wrong +=
        ct_bits_get(found->changed, n) != changed[n] || ct_bits_get(found->adrift, n) != drifts[n];
  // What belongs to other bodies stays.
  for (int n = 0; n < m->part.first_node; n++)
    wrong += !ct_bits_get(found->changed, n) || !ct_bits_get(found->adrift, n);
  for (int n = m->part.first_node + m->mesh->node_count; n < m->node_count; n++)
    wrong += !ct_bits_get(found->changed, n) || !ct_bits_get(found->adrift, n);
  char *rooms[] = {changed, drifts, computed, read, alone};
  for (int i = 0; i < 5; i++) free(rooms[i]);
  return wrong;
}

/* Move some nodes of a box of nodes each by itself, or let all move alike again. */
static void disturb(model *m, int call)
{
  double low[3], high[3];
  for (int c = 0; c < 3; c++) {
    double a = pick(12) / 11.0, b = pick(12) / 11.0;
    low[c] = fmin(a, b), high[c] = pick(3) ? fmax(a, b) : 1.0;
  }
  // Sometimes one node is only said to have done more than drift.
  int together = pick(3) > 0,
      one = pick(3) == 0 ? m->part.first_node + pick(m->mesh->node_count) : -1;
  for (int n = 0; n < m->node_count; n++) {
    const double *x = &m->mesh->nodes[3 * (n - m->part.first_node)];
    int own = n >= m->part.first_node && n < m->part.first_node + m->mesh->node_count;
    int inside = own && x[0] >= low[0] && x[0] <= high[0] && x[1] >= low[1] && x[1] <= high[1] &&
                 x[2] >= low[2] && x[2] <= high[2];
    ct_bits_put(m->drifted, n, n + 1, one < 0 ? !inside : n != one);
    if (one >= 0) continue;
    for (int c = 0; inside && c < 3; c++)
      m->u[3 * n + c] = together ? 7.0 * c + call % 2 : uniform(1.0);
    for (int c = 0; inside && c < 3; c++)
      m->v[3 * n + c] = together && pick(50) ? 1.0 : uniform(1.0);
  }
}

/* Random histories of a lattice: whatever order its numbers have, however long its rows, and
 * wherever it begins. */
static void rows_beside_elements(int nx, int ny, int nz, ct_layers layers, int first_node)
{
  model m = {.mesh = mesh_of(CT_HEX8, (ct_box){{0, 0, 0}, {1, 1, 1}, {nx, ny, nz}, layers})};
  m.part = (ct_solid_part){
      .mesh = m.mesh, .batch_count = (m.mesh->element_count + 7) / 8, .first_node = first_node};
  m.node_count = first_node + m.mesh->node_count + 70;
  int64_t words = ct_bits_words(m.node_count);
  m.u = numbers(3 * m.node_count), m.v = numbers(3 * m.node_count);
  m.drifted = room(words, 8);
  m.cells = room(m.mesh->element_count, sizeof *m.cells);
  for (int e = 0; e < m.mesh->element_count; e++) m.cells[e].moving = 1;
  ct_found found = {room(m.part.batch_count + 9, 1),
                    room(m.part.batch_count + 9, 1),
                    room(m.part.batch_count + 9, 1),
                    room(words, 8),
                    room(words, 8),
                    m.node_count};
  memset(found.changed, 0xff, (size_t)words * 8);
  memset(found.adrift, 0xff, (size_t)words * 8);
  ct_rows rows = {0};
  ct_leader leader = {0};
  uint64_t still[1];
  int wrong = 0, adrift = 0, quiet = 0;
  int is_lattice = ct_lattice_find(m.mesh, &m.part) && ct_rows_create(&m.part, &rows) == CT_OK;
  for (int call = 0; is_lattice && call < 1000; call++) {
    // Series of some steps; once in a while nothing stands from before, or no leader is wanted.
    int in_series = call % 23 > 0, led = call / 23 % 4 != 3;
    if (pick(3) == 0) disturb(&m, call);
    else memset(m.drifted, 0xff, (size_t)words * 8);
    ct_view view = {.threads = 1 + pick(2),
                    .displacement = m.u,
                    .velocity = m.v,
                    .drifted = in_series ? m.drifted : NULL,
                    .still = call % 46 > 0 ? still : NULL};
    ct_rows_find(&rows, &m.part, &view, call, led ? &leader : NULL, &found);
    for (int e = 0; e < m.mesh->element_count; e++)
      step_cell(&m, e, call, in_series, rows.leading ? &leader : NULL);
    m.known = 1;
    if (view.still != NULL) wrong += faults(&m, &found);
    for (int n = first_node; n < first_node + m.mesh->node_count; n++)
      adrift += ct_bits_get(found.adrift, n);
    for (int e = 0; e < m.mesh->element_count; e++) quiet += !m.cells[e].moving;
  }
  tap_ok(is_lattice && wrong == 0 && adrift > 300 && quiet > 10000,
         "%d x %d x %d cells, order %d, from node %d: 1000 calls are right; %d elements quiet, %d "
         "nodes adrift",
         nx, ny, nz, (int)layers, first_node, quiet, adrift);
  void *rooms[] = {m.u,        m.v,         m.drifted,     m.cells,     found.computed,
                   found.read, found.awake, found.changed, found.adrift};
  for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) free(rooms[i]);
  ct_rows_free(&rows);
  ct_mesh_free(m.mesh);
}

/* An effect that pushes a few nodes and looks at all: it keeps a hash of all displacements that it
 * sees, and counts the nodes that are adrift then. */
typedef struct witness {
  const ct_problem *problem;
  ct_state *state;
  uint64_t seen;
  int64_t adrift;
  int64_t fail_at;
} witness;

static ct_status witness_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  witness *w = effect->data;
  for (int i = 0; i < 3 * effect->node_count; i++) force[i] = i % 3 == 0 ? 1e-3 : 0.0;
  if (w->state == NULL) return CT_OK;
  const unsigned char *bytes = (const void *)view->displacement;
  for (int64_t i = 0; i < 24 * (int64_t)w->problem->node_count; i++)
    w->seen = (w->seen ^ bytes[i]) * 1099511628211ull;
  for (int32_t n = 0; n < w->problem->node_count; n++)
    w->adrift += ct_bits_get(w->state->workspace->adrift, n);
  if (w->state->step == w->fail_at) {
    error->code = CT_ERROR_UNSUPPORTED;
    return CT_ERROR_UNSUPPORTED;
  }
  return CT_OK;
}

typedef struct flight {
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
  witness own;
} flight;

/* Two blocks that fly each its way, pushed at some nodes of the first, with an integrator. */
static void open_flight(flight *f, int quiet, int local, ct_scheme scheme, ct_layers layers)
{
  static const int32_t NODES[3] = {0, 1, 40};
  ct_error e;
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *joined;
  ct_effect *effect;
  *f = (flight){.scene = new_scene(), .own = {.fail_at = -1}};
  for (int b = 0; b < 2; b++) {
    ct_mesh *m = mesh_of(CT_HEX8, (ct_box){{0.1, 3.0 * b, 0}, {4, 1, 2}, {40, 2, 9}, layers});
    add_body(f->scene, b ? "second" : "first", m, &STEEL, CT_KERNEL_AUTO, 1000.0 - 300.0 * b, 17.0,
             0.3);
    ct_mesh_free(m);
  }
  ct_savings savings = ct_savings_default();
  savings.quiet = quiet;
  need(ct_scene_set_savings(f->scene, &savings, &e), &e);
  need(ct_scene_join(f->scene, &joined, &e), &e);
  ct_effect own = {.label = "witness",
                   .local = local,
                   .data = &f->own,
                   .force = witness_force,
                   .nodes = NODES,
                   .node_count = 3};
  need(ct_effect_create(&own, &effect, &e), &e);
  need(ct_scene_add_effect(f->scene, effect, &e), &e);
  f->problem = build(
      f->scene,
      (ct_scene_time){
          .end = 1e-5, .fraction = 0.9, .threads = 1, .integrator = ct_integrator_default(scheme)},
      &steps, &stable);
  f->state = new_state(f->problem);
  f->own.problem = f->problem;
  f->own.state = f->state;
}

static void close_flight(flight *f)
{
  ct_state_free(f->state);
  ct_scene_free(f->scene);
}

static int same(const flight *a, const flight *b)
{
  size_t size = 24 * (size_t)a->problem->node_count;
  return a->state->step == b->state->step &&
         memcmp(a->state->displacement, b->state->displacement, size) == 0 &&
         memcmp(a->state->velocity, b->state->velocity, size) == 0 &&
         memcmp(a->state->work, b->state->work, (size_t)a->state->work_count * 8) == 0;
}

/* Nodes that are adrift have their displacement whenever the loop ends, also with an error, and
 * whenever an effect may look. */
static void nodes_adrift(ct_scheme scheme, const char *name)
{
  flight all, some, shy;
  ct_error e;
  open_flight(&all, 0, 1, scheme, CT_LAYERS_Z);
  open_flight(&some, 1, 1, scheme, CT_LAYERS_Z);
  open_flight(&shy, 1, 0, scheme, CT_LAYERS_Z);
  int equal = 1;
  static const int64_t SERIES[] = {1, 2, 3, 7, 1, 70, 20};
  for (size_t i = 0; i < sizeof SERIES / sizeof *SERIES; i++) {
    flight *each[] = {&all, &some, &shy};
    for (int k = 0; k < 3; k++) advance(each[k]->problem, each[k]->state, SERIES[i]);
    equal &= same(&all, &some) && same(&all, &shy);
  }
  tap_ok(equal, "%s: the same bits after series of 1 to 70 steps", name);
  int64_t *every = all.state->element_updates, *few = some.state->element_updates,
          evaluations = every[0] / 1440;
  tap_ok(every[1] == 0 && every[0] == 1440 * evaluations && few[0] + few[1] == every[0] &&
             few[1] > few[0] / 4,
         "of %lld forces of elements in %lld evaluations %lld were left out", (long long)every[0],
         (long long)evaluations, (long long)few[1]);
  tap_ok(some.own.adrift > 1000 && some.own.seen != all.own.seen,
         "a leader has moved for %lld nodes, whose own displacement was older then",
         (long long)some.own.adrift);
  tap_ok(shy.own.adrift == 0 && shy.own.seen == all.own.seen,
         "never beside an effect that may look at all nodes");
  int failed = 0, landed = 0;
  for (int last = 3; last < 20; last++) {
    flight each[2];
    for (int k = 0; k < 2; k++) {
      open_flight(&each[k], k, 1, scheme, CT_LAYERS_Z);
      each[k].own.fail_at = last;
      failed += ct_step_many(each[k].problem, each[k].state, 40, &e) == CT_ERROR_UNSUPPORTED;
    }
    landed += same(&each[0], &each[1]) && each[1].own.adrift > 0;
    for (int k = 0; k < 2; k++) close_flight(&each[k]);
  }
  tap_ok(failed == 34 && landed == 17, "where an effect fails in the midst of a series all nodes "
                                       "have the displacement of the last whole step");
  close_flight(&all);
  close_flight(&some);
  close_flight(&shy);
}

/* A result of two bodies in an order that does not depend on their numbers. */
typedef struct place {
  double x[3], u[3], v[3];
} place;

static int compare_places(const void *a, const void *b)
{
  const double *x = ((const place *)a)->x, *y = ((const place *)b)->x;
  for (int c = 2; c >= 0; c--)
    if (x[c] != y[c]) return x[c] < y[c] ? -1 : 1;
  return 0;
}

/* Two boxes of which one flies at the other, numbered in one of three ways: what happens at each
 * place. */
static place *impact(ct_brick_kind kind, ct_layers layers, ct_savings savings, int32_t *count)
{
  ct_error e;
  ct_scene *scene = new_scene();
  ct_mesh *m[2];
  int64_t steps;
  ct_stable_step stable;
  for (int b = 0; b < 2; b++) {
    m[b] = mesh_of(
        kind, (ct_box){{b == 0 ? -1.0 : 1e-4, 0.013, -0.2}, {1, 0.2, 1.2}, {10, 2, 12}, layers});
    add_body(scene, b ? "right" : "left", m[b], &STEEL, CT_KERNEL_AUTO, b ? 0.0 : 1000.0, 0.0, 0.0);
  }
  add_contact_with(scene, 0, m[0], 0, 1, m[1], 1e-4, 0, 1.0, ct_contact_options_default(), 0.0,
                   0.0);
  add_support(scene, 0, m[0], 2, -0.2, "z", 0.0);
  need(ct_scene_set_savings(scene, &savings, &e), &e);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 4e-7, .fraction = 0.9, .threads = 2}, &steps, &stable);
  ct_state *state = new_state(problem);
  advance(problem, state, steps);
  *count = problem->node_count;
  place *places = room(*count, sizeof *places);
  for (int32_t n = 0; n < *count; n++) {
    memcpy(places[n].x, &problem->reference[3 * n], 24);
    memcpy(places[n].u, &state->displacement[3 * n], 24);
    memcpy(places[n].v, &state->velocity[3 * n], 24);
  }
  qsort(places, (size_t)*count, sizeof *places, compare_places);
  ct_state_free(state);
  ct_scene_free(scene);
  for (int b = 0; b < 2; b++) ct_mesh_free(m[b]);
  return places;
}

/* The order of numbers changes nothing that happens anywhere, with and without savings. */
static void orders(ct_brick_kind kind)
{
  int32_t count, other;
  place *first = impact(kind, CT_LAYERS_Z, ct_savings_default(), &count);
  int moved = 0;
  for (int32_t n = 0; n < count; n++) moved += first[n].x[0] > 0.0 && first[n].v[0] > 500.0;
  tap_ok(moved > 20, "%s: %d nodes of the body that was hit are fast",
         kind == CT_HEX8 ? "hex8" : "hex20", moved);
  for (int k = 0; k < 5; k++) {
    ct_savings none = {0, 0, 0, 0};
    static const char *names[] = {"z, nothing left out", "x", "x, nothing left out", "y",
                                  "y, nothing left out"};
    place *places = impact(kind,
                           k == 0  ? CT_LAYERS_Z
                           : k < 3 ? CT_LAYERS_X
                                   : CT_LAYERS_Y,
                           k % 2 == 0 ? none : ct_savings_default(), &other);
    tap_ok(other == count && memcmp(first, places, (size_t)count * sizeof *places) == 0,
           "layers along %s: the same bits at each place", names[k]);
    free(places);
  }
  free(first);
}

int main(void)
{
  rows_beside_elements(53, 3, 2, CT_LAYERS_Z, 5);
  rows_beside_elements(64, 2, 3, CT_LAYERS_Z, 63);
  rows_beside_elements(65, 1, 4, CT_LAYERS_Z, 64);
  rows_beside_elements(9, 5, 6, CT_LAYERS_Z, 0);
  rows_beside_elements(128, 4, 1, CT_LAYERS_Z, 1);
  rows_beside_elements(7, 1, 30, CT_LAYERS_X, 11);
  rows_beside_elements(8, 9, 4, CT_LAYERS_Y, 100);
  nodes_adrift(CT_CENTRAL_DIFFERENCE, "central differences");
  nodes_adrift(CT_CHUNG_LEE, "Chung and Lee");
  nodes_adrift(CT_NOH_BATHE, "Noh and Bathe");
  orders(CT_HEX8);
  orders(CT_HEX20);
  return tap_done();
}
