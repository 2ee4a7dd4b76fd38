/* Contacts, obstacles and friction as effects: what an interaction sees of a state. */
#include "contact.h"

#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/list.h"
#include "../base/vector.h"
#include "../constraint/law.h"
#include "../base/threads.h"
#include "../step/effect_internal.h"
#include "../step/piece.h"

#include <math.h>
#include <string.h>

static const ct_interaction *interaction_of(const ct_effect *effect)
{
  return ((const ct_touch *)effect->data)->is;
}

/* Coordinates and velocities of the interaction's nodes. */
CT_CLONES_NODES
static void gather(const ct_effect *effect, const ct_view *view)
{
  ct_touch_scratch *s = view->scratch;
  // Nodes with consecutive numbers are read together.
  for (int32_t i = 0, row; i < effect->node_count; i += row) {
    const int64_t from = 3 * (int64_t)effect->nodes[i];
    double *restrict x = &s->x[3 * (int64_t)i], *restrict v = &s->velocity[3 * (int64_t)i];
    row = ct_row_length(&effect->nodes[i], effect->node_count - i);
#pragma omp simd
    for (int64_t d = 0; d < 3 * (int64_t)row; d++) {
      x[d] = view->reference[from + d] + view->displacement[from + d];
      v[d] = view->velocity[from + d];
    }
  }
}

static ct_surface_motion motion_of(const ct_view *view)
{
  const ct_touch_scratch *s = view->scratch;
  return (ct_surface_motion){.time = view->time,
                             .before = view->time > 0.0 ? view->dt : 0.0,
                             .dt = view->dt,
                             .threads = ct_threads_of(view->settings),
                             .x = s->x,
                             .velocity = s->velocity,
                             .memory = view->memory,
                             .next_memory = view->next_memory,
                             .continued = view->continued,
                             .on = view->read == NULL ? NULL : ct_touch_state(view->read)};
}

/* A status after which all pieces go on, or none: some calls of an interaction exchange numbers. */
static ct_status agree(const ct_view *view, ct_status own, ct_error *error)
{
  return ct_piece_agree(((const ct_touch_scratch *)view->scratch)->piece, own, error);
}

static ct_status touch_constrain(const ct_effect *effect, const ct_view *view, ct_constraint **rows,
                                 int64_t *count, ct_error *error)
{
  const ct_interaction *is = interaction_of(effect);
  void *state = ct_touch_state(view->scratch);
  if (is->on == NULL) gather(effect, view);
  const ct_surface_motion now = motion_of(view);
  if (is->on != NULL && now.on == NULL)
    return CT_REFUSE(
        error,
        "friction: the contact or obstacle that it acts on must be an effect of the problem, too");
  ct_status status = CT_OK;
  if (is->on == NULL) status = agree(view, is->calls->place(state, &now, error), error);
  if (status == CT_OK) *count = is->calls->list_rows(state, &now, rows);
  return status;
}

static ct_status touch_force(const ct_effect *effect, const ct_view *view, double *force,
                             ct_error *error)
{
  const ct_interaction *is = interaction_of(effect);
  void *state = ct_touch_state(view->scratch);
  const ct_surface_motion now = motion_of(view);
  if (effect->phase != CT_PHASE_CONSTRAINT) gather(effect, view);
  ct_status status = CT_OK;
  if (is->explicit) status = agree(view, is->calls->place(state, &now, error), error);
  return status == CT_OK ? is->calls->find_forces(state, &now, force, error) : status;
}

static ct_interaction_energy energy_of(const ct_view *view)
{
  ct_interaction_energy energy;
  const ct_touch_scratch *s = view->scratch;
  s->is->calls->find_energy(s->state, &energy);
  return energy;
}

static ct_status touch_energy(const ct_effect *effect, const ct_view *view, double *energy,
                              ct_error *error)
{
  (void)effect;
  (void)error;
  *energy = energy_of(view).stored;
  return CT_OK;
}

static ct_status touch_external(const ct_effect *effect, const ct_view *view, double *work,
                                ct_error *error)
{
  (void)effect;
  (void)error;
  const ct_interaction_energy energy = energy_of(view);
  *work = energy.motion + energy.removal;
  return CT_OK;
}

static ct_status touch_reserve(const ct_effect *effect, const ct_view *view, double *reserve,
                               ct_error *error)
{
  (void)effect;
  (void)error;
  *reserve = energy_of(view).reserve;
  return CT_OK;
}

static void touch_divide(const ct_effect *effect, const ct_view *view, double dt, double *memory)
{
  interaction_of(effect)->calls->divide(ct_touch_state(view->scratch), dt / view->dt, memory);
}

static ct_status touch_bound(const ct_effect *effect, const ct_view *view, double *omega2,
                             ct_error *error)
{
  const ct_touch *touch = effect->data;
  const ct_touch_scratch *s = view->scratch;
  ct_status status = ct_interaction_bound(touch->is, s->state,
                                          (ct_masses){touch->problem->mass, effect->nodes}, omega2);
  return status == CT_OK
             ? CT_OK
             : ct_fail(error, status, CT_NOWHERE, "%s: no bound on the time step", effect->label);
}

static void free_data(void *data)
{
  ct_touch *touch = data;
  if (touch->is != NULL) touch->is->calls->free(touch->is);
  ct_release(touch);
}

static void free_scratch(void *scratch)
{
  ct_touch_scratch *s = scratch;
  if (s == NULL) return;
  if (s->state != NULL) s->is->calls->close(s->state);
  ct_pool_free(s);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const ct_touch *touch = effect->data;
  if (touch->carrier >= 0 && !ct_problem_is_rigid(touch->problem, touch->carrier))
    return CT_REFUSE(error, "obstacle: body %s, which carries it, must be rigid",
                     touch->problem->bodies[touch->carrier].name);
  ct_touch_scratch *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_NO_MEMORY(error, "effect %s", effect->label);
  const size_t nodes = (size_t)effect->node_count;
  s->is = touch->is;
  s->x = ct_pool_take(&s->pool, nodes, 3 * sizeof *s->x);
  s->velocity = ct_pool_take(&s->pool, nodes, 3 * sizeof *s->velocity);
  ct_status status = s->pool.failed ? CT_NO_MEMORY(error, "effect %s", effect->label)
                                    : s->is->calls->open(s->is, &s->state, error);
  if (status == CT_OK) *scratch = s;
  else free_scratch(s);
  return status;
}

/* The nodes of a face of a side as nodes of the problem; returns their number. */
static int32_t face_nodes(const ct_side_fixed *side, int64_t face, const int32_t *nodes,
                          int32_t *out)
{
  const int32_t *own = ct_side_row_nodes(side, face);
  for (int32_t a = 0; a < side->search->per; a++) out[a] = nodes[own[a]];
  return side->search->per;
}

/* The piece of a face of surface `s` (ct_gaps_surface). */
static int32_t piece_of(const ct_interaction *is, int s, int64_t face, const ct_piece *piece)
{
  const ct_contact_fixed *fixed = (const ct_contact_fixed *)(is->on != NULL ? is->on : is);
  int32_t nodes[8];
  return ct_piece_of_face(piece, face_nodes(&fixed->gaps.side[s], face, is->nodes, nodes), nodes);
}

/* The points of a face belong to its piece; friction has those of its contact. */
static ct_status touch_cut(const ct_effect *effect, const struct ct_piece *piece, void *scratch,
                           ct_error *error)
{
  ct_touch_scratch *s = scratch;
  const ct_interaction *is = interaction_of(effect);
  ct_contact *contact = s->state;
  ct_status status = CT_OK;
  s->piece = piece;
  if (is->on != NULL) return CT_OK;
  const ct_gaps_fixed *gaps = contact->gaps.fixed;
  for (int k = 0; status == CT_OK && k < gaps->sides; k++) {
    ct_side *side = &contact->gaps.side[k];
    side->pieces = &piece->join;
    const int32_t count = ct_gaps_surface(gaps, k) == k ? side->search->face_count : 1;
    uint8_t *owned = ct_allocate((size_t)count, sizeof *owned);
    for (int32_t f = 0; owned != NULL && f < count; f++)
      owned[f] = piece_of(is, ct_gaps_surface(gaps, k), f, piece) == piece->def.number;
    status = owned == NULL ? CT_ERROR_MEMORY : ct_side_divide(side, owned);
    ct_release(owned);
  }
  return status == CT_OK ? CT_OK : CT_NO_MEMORY(error, "a piece");
}

/* Each point has its record in the piece of its face, stations in that of the first face; the rest
 * of the memory is the same in all pieces. */
static void touch_keep(const ct_effect *effect, const struct ct_piece *piece, int common,
                       double *memory)
{
  const ct_interaction *is = interaction_of(effect);
  const ct_gaps_fixed *gaps = &((const ct_contact_fixed *)(is->on != NULL ? is->on : is))->gaps;
  const int sides = is->on != NULL ? ct_gaps_surfaces(gaps) : gaps->sides;
  double *end = memory + is->memory_count;
  for (int k = 0; k < sides; k++) {
    const int64_t per = ct_gaps_surface(gaps, k) == k ? gaps->side[k].rule.count : 0;
    for (int64_t i = 0; i < gaps->side[k].point_count; i++, memory += is->point_memory)
      if (piece_of(is, ct_gaps_surface(gaps, k), per == 0 ? 0 : i / per, piece) !=
          piece->def.number)
        memset(memory, 0, (size_t)is->point_memory * sizeof *memory);
  }
  if (!common) memset(memory, 0, (size_t)(end - memory) * sizeof *memory);
}

/* Of contacts and obstacles; friction stores no energy that a result shows apart. */
static const ct_effect_calls TOUCH = {
    .force = touch_force,
    .energy = touch_energy,
    .create_scratch = create_scratch,
    .free_scratch = free_scratch,
    .free_data = free_data,
    .bounds = {.omega2 = touch_bound},
    .constraints = {.list = touch_constrain,
                    .external = touch_external,
                    .reserve = touch_reserve,
                    .divide = touch_divide},
    .pieces = {.cut = touch_cut, .keep = touch_keep, .common = 1}};
static const ct_effect_calls FRICTION = {
    .force = touch_force,
    .create_scratch = create_scratch,
    .free_scratch = free_scratch,
    .free_data = free_data,
    .constraints = {.list = touch_constrain},
    .pieces = {.cut = touch_cut, .keep = touch_keep, .common = 1}};

/* The effect of a new interaction, which it takes over; `filled` has what differs by its kind. */
static ct_status create(ct_interaction *is, const ct_problem *problem, int32_t carrier,
                        ct_effect filled, ct_effect **out, ct_error *error)
{
  ct_touch *touch = ct_allocate(1, sizeof *touch);
  ct_status status = touch == NULL ? CT_NO_MEMORY(error, "effect %s", filled.label) : CT_OK;
  if (status == CT_OK && is->on == NULL)
    status = ct_law_check_time(&((const ct_contact_fixed *)is)->law, filled.label, error);
  if (status != CT_OK) {
    is->calls->free(is);
    ct_release(touch);
    return status;
  }
  *touch = (ct_touch){is, problem, carrier};
  filled.data = touch;
  filled.nodes = is->nodes;
  filled.node_count = is->node_count;
  filled.memory_count = is->memory_count;
  filled.cost = (ct_effect_cost){is->flops, is->bytes};
  if (is->row_count > 0 || is->on != NULL) {
    filled.phase = CT_PHASE_CONSTRAINT;
    filled.constraint_count = is->on == NULL ? is->row_count : is->slip_count;
    filled.constraint_nodes = is->row_nodes;
  }
  return ct_effect_finish(CT_OK, &filled, out, error);
}

ct_contact_def ct_contact_def_default(void)
{
  return (ct_contact_def){.cookie = CT_DEF_COOKIE, .options = ct_contact_options_default()};
}

static int has_nodes_of(const ct_surface *surface, const ct_problem *problem)
{
  return surface != NULL && surface->node_count == problem->node_count &&
         surface->reference == problem->reference;
}

ct_status ct_contact_create_effect(const ct_contact_def *def, const ct_problem *problem,
                                   ct_effect **out, ct_error *error)
{
  ct_contact_fixed *fixed = NULL;
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, out, "contact", error);
  if (status != CT_OK) return status;
  if (!has_nodes_of(def->a, problem) || !has_nodes_of(def->b, problem))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: a surface is missing, or is not one of the problem");
  const ct_surface *surface[2] = {def->a, def->b};
  status = ct_contact_fixed_create(surface, def->a == def->b ? 1 : 2, &def->options, &fixed, error);
  if (status != CT_OK) return status;
  const ct_effect filled = {.kind = CT_EFFECT_CONTACT, .label = "contact", .calls = &TOUCH};
  return create(&fixed->is, problem, -1, filled, out, error);
}

/* The node of a body that is farthest along a direction. */
static int32_t farthest(const ct_body *body, const double direction[3])
{
  double top = -HUGE_VAL;
  int32_t node = 0;
  for (int32_t n = 0; n < body->mesh->node_count; n++) {
    const double along = ct_vector_dot(&body->mesh->nodes[3 * (int64_t)n], direction);
    if (along > top) top = along, node = n;
  }
  return body->first_node + node;
}

/* Nodes of the body that carries an obstacle, ascending: the farthest one in each octant. */
static ct_status find_carrier(const ct_obstacle_def *def, const ct_problem *problem,
                              int32_t nodes[CT_CARRIER_NODES], ct_error *error)
{
  if (*def->carrier < 0 || *def->carrier >= problem->body_count)
    return CT_REFUSE(error, "obstacle: there is no body %d to carry it", (int)*def->carrier);
  const ct_body *body = &problem->bodies[*def->carrier];
  const int32_t end = body->first_node + body->mesh->node_count;
  for (int64_t i = 0; i < (int64_t)def->face_count * ct_face_node_count(def->kind); i++)
    if (def->faces[i] >= body->first_node && def->faces[i] < end)
      return CT_REFUSE(error, "obstacle: body %s carries it and can't touch it, too", body->name);
  for (int k = 0; k < CT_CARRIER_NODES; k++) {
    const int32_t node = farthest(
        body, (const double[3]){k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
    int at = k;
    for (; at > 0 && nodes[at - 1] > node; at--) nodes[at] = nodes[at - 1];
    nodes[at] = node;
  }
  return CT_OK;
}

ct_status ct_obstacle_create_effect(const ct_obstacle_def *def, const ct_problem *problem,
                                    ct_effect **out, ct_error *error)
{
  ct_interaction *is = NULL;
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, out, "obstacle", error);
  if (status != CT_OK) return status;
  const ct_surface surface = {def->kind, problem->node_count, def->face_count, def->faces,
                              problem->reference};
  int32_t carrier[CT_CARRIER_NODES];
  if (def->carrier != NULL) status = find_carrier(def, problem, carrier, error);
  if (status == CT_OK)
    status = ct_obstacle_create(def, &surface, def->carrier == NULL ? NULL : carrier, &is, error);
  const ct_effect filled = {.kind = CT_EFFECT_OBSTACLE, .label = "obstacle", .calls = &TOUCH};
  return status == CT_OK
             ? create(is, problem, def->carrier == NULL ? -1 : *def->carrier, filled, out, error)
             : status;
}

ct_friction_def ct_friction_def_default(void)
{
  return (ct_friction_def){.cookie = CT_DEF_COOKIE, .tangent = 1.0};
}

ct_status ct_friction_create_effect(const ct_friction_def *def, const ct_problem *problem,
                                    ct_effect **out, ct_error *error)
{
  ct_interaction *is = NULL;
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, out, "friction", error);
  if (status != CT_OK) return status;
  const ct_effect *on = def->on;
  if (on == NULL || (on->kind != CT_EFFECT_CONTACT && on->kind != CT_EFFECT_OBSTACLE))
    return CT_REFUSE(
        error,
        "friction: add a contact or an obstacle first; friction acts where there is a pressure");
  status = ct_friction_create(def->coefficient, def->tangent, interaction_of(on), &is, error);
  const ct_effect filled = {
      .kind = CT_EFFECT_FRICTION, .label = "friction", .calls = &FRICTION, .reads = on};
  return status == CT_OK ? create(is, problem, -1, filled, out, error) : status;
}
