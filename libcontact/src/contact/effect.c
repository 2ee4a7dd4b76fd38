/* The contact as an effect of a problem. */
#include <libcontact/contact.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"
#include "../step/effect_internal.h"
#include "../step/workspace.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* What all states share. Surfaces number the problem's nodes; `place` tells where each node of a
 * surface stands in the effect's list. */
typedef struct contact_data {
  ct_contact_fixed *fixed;
  int32_t *nodes, *place[2];
  int64_t point_count;
  const double *mass; /* of the problem's nodes */
} contact_data;

/* What the effect remembers after the records of the points. After it: the coordinates of the nodes
 * of each surface, shape (node_count, 3). */
typedef struct tail_record {
  double begun;  /* whether there was a step before */
  double stored; /* what all rows stored in the middle of that step */
  double time;   /* of that step */
  double work;   /* since t = 0 of start gaps that fade */
} tail_record;
enum { TAIL = sizeof(tail_record) / sizeof(double) };

static int is_penalty(const contact_data *data)
{
  return data->fixed->options.enforcement == CT_ENFORCE_PENALTY;
}

static tail_record load_tail(const contact_data *data, const double *memory)
{
  tail_record tail;
  memcpy(&tail, &memory[CT_RECORD * data->point_count], sizeof tail);
  return tail;
}

/* What the points were in the last step; their start gaps stand already in the first one. */
static void load_points(ct_contact *contact, const double *memory)
{
  for (int s = 0; s < contact->fixed->sides; s++) {
    double most = (double)contact->fixed->side[contact->fixed->sides - 1 - s].search->face_count;
    for (int64_t i = 0; i < contact->fixed->side[s].point_count; i++, memory += CT_RECORD) {
      ct_point *point = &contact->side[s].points[i];
      const ct_point_record record = ct_record_load(memory);
      int buried = record.status == CT_POINT_BURIED,
          met = !buried && record.other >= 1.0 && record.other <= most;
      point->other = met ? (int32_t)record.other - 1 : -1;
      point->status = buried                             ? CT_POINT_BURIED
                      : !met                             ? CT_POINT_NEW
                      : record.status == CT_POINT_INSIDE ? CT_POINT_INSIDE
                                                         : CT_POINT_OUTSIDE;
      memcpy(point->xi, record.xi, sizeof point->xi);
      point->known = contact->begun ? record.known : NAN;
      point->row.force = record.force;
      if (contact->begun) point->start = record.start;
    }
  }
}

static void store(const ct_contact *contact, const tail_record *tail, double *memory)
{
  int fades = ct_start_gap_fades(&contact->fixed->options);
  for (int s = 0; s < contact->fixed->sides; s++)
    for (int64_t i = 0; i < contact->fixed->side[s].point_count; i++, memory += CT_RECORD) {
      const ct_point *point = &contact->side[s].points[i];
      const ct_point_record record = {
          .other = (double)point->other + 1.0,
          .status = point->status,
          .xi = {point->xi[0], point->xi[1]},
          .known = point->known,
          .force = point->row.force,
          .start = point->start,
          .pressed = fades ? sqrt(ct_vector_dot(point->force, point->force)) : 0.0};
      memcpy(memory, &record, sizeof record);
    }
  memcpy(memory, tail, sizeof *tail);
  memory += TAIL;
  for (int s = 0; s < contact->fixed->sides; s++) {
    size_t count = 3 * (size_t)contact->side[s].search->node_count;
    memcpy(memory, contact->side[s].search->x, count * sizeof *memory);
    memory += count;
  }
}

/* Nodes move from where the last step saw them, and at the first look from the reference shape, to
 * the current coordinates, or with the displacement null to the reference shape (eq:gap-bound). */
static ct_status move_nodes(const contact_data *data, const ct_view *view,
                            const double *displacement, ct_contact *contact, ct_error *error)
{
  const double *last = &view->memory[CT_RECORD * data->point_count + TAIL];
  for (int s = 0; s < contact->fixed->sides; s++) {
    ct_side *side = &contact->side[s];
    ct_search *search = side->search;
    size_t count = 3 * (size_t)search->node_count;
    const double *from = contact->begun ? last : side->fixed->search->x;
    ct_status status = ct_search_check(search, NULL, from, s, error);
    if (status != CT_OK) return status;
    memcpy(search->x, from, count * sizeof *from);
    last += count;
    for (size_t d = 0; d < count; d++) {
      int64_t dof = 3 * (int64_t)search->nodes[d / 3] + (int64_t)(d % 3);
      side->moved[d] = view->reference[dof] + (displacement != NULL ? displacement[dof] : 0.0);
    }
  }
  return CT_OK;
}

/* True distances of the points at the current coordinates, or on the undeformed shape. */
static ct_status find_distances(const contact_data *data, const ct_view *view,
                                const double *displacement, ct_error *error)
{
  ct_contact *contact = view->scratch;
  contact->threads = view->threads;
  contact->start = !(view->time > 0.0);
  contact->begun = load_tail(data, view->memory).begun != 0.0;
  load_points(contact, view->memory);
  ct_status status = move_nodes(data, view, displacement, contact, error);
  return status == CT_OK ? ct_contact_measure(contact, error) : status;
}

/* Gaps of the points at the time of the view, counted from their start gaps. */
static ct_status measure(const ct_effect *effect, const ct_view *view, ct_error *error)
{
  const contact_data *data = effect->data;
  const ct_contact_options *options = &data->fixed->options;
  ct_contact *contact = view->scratch;
  const tail_record last = load_tail(data, view->memory);
  int first = last.begun == 0.0, counts = ct_start_gap_counts(options);
  ct_status status = CT_OK;
  // -- Start gaps are those of the undeformed shape (eq:initial-adjust)
  if (first && counts) status = find_distances(data, view, NULL, error);
  if (status == CT_OK && first && counts) ct_start_gap_begin(contact);
  if (status == CT_OK) status = find_distances(data, view, view->displacement, error);
  if (status == CT_OK && view->dt > 0.0 && view->time > 0.0)
    status = ct_tunnelling_check(contact, view->velocity, view->dt, view->time, error);
  if (status == CT_OK && counts)
    ct_start_gap_shift(contact, first ? view->time : last.time, view->time, view->dt,
                       first ? NULL : view->memory);
  if (status == CT_OK && first && options->initial_penetration == CT_INITIAL_REFUSE)
    status = ct_start_gap_refuse(contact, error);
  return status;
}

static ct_status contact_constrain(const ct_effect *effect, const ct_view *view,
                                   ct_constraint **rows, int64_t *count, ct_error *error)
{
  static const double at_rest[3] = {0.0, 0.0, 0.0};
  ct_contact *contact = view->scratch;
  ct_status status = measure(effect, view, error);
  for (int s = 0; status == CT_OK && s < contact->fixed->sides; s++)
    *count += ct_side_list_rows(&contact->side[s], ct_contact_other(contact, s), HUGE_VAL, at_rest,
                                at_rest, &rows[*count]);
  return status;
}

static const ct_effect_constraints CONSTRAINTS = {.list = contact_constrain};

static ct_status contact_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const contact_data *data = effect->data;
  ct_contact *contact = view->scratch;
  const int sides = data->fixed->sides;
  ct_status status = is_penalty(data) ? measure(effect, view, error) : CT_OK;
  if (status != CT_OK) return status;
  const tail_record last = load_tail(data, view->memory);
  tail_record tail = {.begun = 1.0, .time = view->time, .work = last.work};
  for (int s = 0; s < sides; s++)
    if (is_penalty(data)) ct_side_apply_penalty(&contact->side[s]);
    else ct_side_take_rows(&contact->side[s]);
  if (!is_penalty(data))
    contact->held = ct_side_rows_energy(contact->side, sides, view->time, last.stored, &tail.stored,
                                        contact->terms);
  if (last.begun != 0.0 && ct_start_gap_fades(&data->fixed->options))
    tail.work += ct_start_gap_work(contact, view->time, last.time, view->memory);
  contact->work = tail.work;
  store(contact, &tail, view->next_memory);
  status = ct_side_collect(contact->side, sides, 0, error);
  if (status != CT_OK) return status;
  memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  for (int s = 0; s < sides; s++)
    for (int32_t n = 0; n < contact->side[s].search->node_count; n++)
      for (int64_t c = 0; c < 3; c++)
        force[3 * (int64_t)data->place[s][n] + c] +=
            contact->side[s].force[3 * (int64_t)n + c] +
            contact->side[s].force_fine[3 * (int64_t)n + c];
  return CT_OK;
}

static ct_status contact_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                ct_error *error)
{
  const ct_contact *contact = view->scratch;
  (void)error;
  *energy = is_penalty(effect->data) ? ct_contact_energy(contact) : contact->held;
  return CT_OK;
}

static ct_status contact_external(const ct_effect *effect, const ct_view *view, double *work,
                                  ct_error *error)
{
  (void)effect;
  (void)error;
  *work = ((const ct_contact *)view->scratch)->work;
  return CT_OK;
}

ct_status ct_contact_springs(const ct_effect *effect, const void *scratch, double *omega2,
                             ct_error *error)
{
  const contact_data *data = effect->data;
  ct_status status = ct_contact_omega2_bound(scratch, data->mass, data->mass, omega2);
  return status == CT_OK ? CT_OK
                         : ct_fail(error, status, CT_NOWHERE, "contact: no bound on the time step");
}

static ct_status contact_omega2_bound(const ct_effect *effect, const ct_view *view, double *omega2,
                                      ct_error *error)
{
  // -- Other enforcements leave the step as it is (eq:controlled-energy)
  return is_penalty(effect->data) ? ct_contact_springs(effect, view->scratch, omega2, error)
                                  : CT_OK;
}

static void free_data(void *data)
{
  contact_data *d = data;
  if (d == NULL) return;
  ct_contact_fixed_free(d->fixed);
  ct_release(d->place[0]);
  ct_release(d->place[1]);
  ct_release(d->nodes);
  ct_release(d);
}

static void free_scratch(void *scratch) { ct_contact_free(scratch); }

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  ct_contact *contact = NULL;
  ct_status status = ct_contact_open(((const contact_data *)effect->data)->fixed, &contact, error);
  *scratch = contact;
  return status;
}

/* Merge the nodes of the surfaces, which ascend, into the effect's list. */
static ct_status list_nodes(contact_data *data, int32_t *count)
{
  const ct_search *search[2] = {data->fixed->side[0].search, data->fixed->side[1].search};
  int32_t end[2] = {search[0]->node_count, search[1] == NULL ? 0 : search[1]->node_count};
  data->nodes = ct_allocate((size_t)end[0] + (size_t)end[1], sizeof *data->nodes);
  for (int s = 0; s < 2; s++) data->place[s] = ct_allocate((size_t)end[s], sizeof *data->place[s]);
  if (!data->nodes || !data->place[0] || !data->place[1]) return CT_ERROR_MEMORY;
  for (int32_t at[2] = {0, 0}; at[0] < end[0] || at[1] < end[1]; (*count)++) {
    int32_t next = INT32_MAX;
    for (int s = 0; s < 2; s++)
      if (at[s] < end[s] && search[s]->nodes[at[s]] < next) next = search[s]->nodes[at[s]];
    for (int s = 0; s < 2; s++)
      if (at[s] < end[s] && search[s]->nodes[at[s]] == next) data->place[s][at[s]++] = *count;
    data->nodes[*count] = next;
  }
  for (int s = 0; s < data->fixed->sides; s++) {
    ct_side_fixed *side = &data->fixed->side[s];
    size_t entries = (size_t)search[s]->face_count * (size_t)search[s]->per;
    side->row_faces = ct_allocate(entries, sizeof *side->row_faces);
    if (side->row_faces == NULL) return CT_ERROR_MEMORY;
    for (size_t i = 0; i < entries; i++) side->row_faces[i] = data->place[s][search[s]->faces[i]];
  }
  return CT_OK;
}

/* Operations and bytes of a call with all points active, without the iterations in which their
 * forces are found: counted in a contact of two plane surfaces (eq:round-flops). */
static void count_costs(ct_effect *effect, const contact_data *data)
{
  double points = (double)data->point_count, listed = is_penalty(data) ? 0.0 : 1.0;
  effect->flops = (800.0 + 400.0 * listed) * points;
  double bytes = 2.0 * sizeof(ct_point) + 2.0 * sizeof(ct_point_record);
  effect->bytes = bytes * points + 250.0 * effect->node_count;
}

/* What never changes of the effect. */
static ct_status fill(contact_data *data, const ct_contact_def *def, const ct_problem *problem,
                      ct_effect *effect, ct_error *error)
{
  const ct_surface *surface[2] = {def->a, def->b};
  data->mass = problem->mass;
  ct_status status = ct_contact_fixed_create(surface, def->a == def->b ? 1 : 2, &def->options,
                                             &data->fixed, error);
  if (status != CT_OK) return status;
  if (list_nodes(data, &effect->node_count) != CT_OK)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  effect->nodes = data->nodes;
  effect->memory_count = TAIL;
  for (int s = 0; s < data->fixed->sides; s++) {
    data->point_count += data->fixed->side[s].point_count;
    effect->memory_count += 3 * (int64_t)data->fixed->side[s].search->node_count;
  }
  effect->memory_count += CT_RECORD * data->point_count;
  count_costs(effect, data);
  if (ct_start_gap_fades(&def->options)) effect->external = contact_external;
  if (is_penalty(data)) return CT_OK;
  effect->phase = CT_PHASE_CONSTRAINT;
  effect->constraints = &CONSTRAINTS;
  effect->constraint_count = data->point_count;
  return CT_OK;
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
  ct_status status =
      ct_effect_check_def(def == NULL ? NULL : &def->cookie, problem, out, "contact", error);
  if (status != CT_OK) return status;
  if (!has_nodes_of(def->a, problem) || !has_nodes_of(def->b, problem))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: a surface is missing, or is not one of the problem");
  contact_data *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  ct_effect filled = {.kind = CT_EFFECT_CONTACT,
                      .label = "contact",
                      .data = data,
                      .create_scratch = create_scratch,
                      .free_scratch = free_scratch,
                      .force = contact_force,
                      .energy = contact_energy,
                      .omega2_bound = contact_omega2_bound,
                      .free_data = free_data};
  status = fill(data, def, problem, &filled, error);
  return ct_effect_finish(status, &filled, out, error);
}

int ct_contact_fixed_sides(const ct_effect *effect, const ct_side_fixed *side[2])
{
  const ct_contact_fixed *fixed = ((const contact_data *)effect->data)->fixed;
  for (int s = 0; s < fixed->sides; s++) side[s] = &fixed->side[s];
  return fixed->sides;
}

const ct_contact *ct_state_contact(const ct_problem *problem, ct_state *state, int32_t effect,
                                   ct_error *error)
{
  if (problem == NULL || state == NULL || effect < 0 || effect >= problem->effect_count ||
      problem->effects[effect]->kind != CT_EFFECT_CONTACT) {
    ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect %d is no contact", (int)effect);
    return NULL;
  }
  return ct_workspace_forces(problem, state, error) == CT_OK ? state->workspace->scratch[effect]
                                                             : NULL;
}
