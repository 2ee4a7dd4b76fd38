/* The contact as an effect of a problem. */
#include <libcontact/contact.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "contact_internal.h"
#include "initial.h"
#include "press.h"

#include <math.h>
#include <string.h>

typedef struct contact_data {
  /* Both surfaces over one list of nodes, those of the effect; reference coordinates and masses of
   * that list. */
  int sides; /* 1: of a surface with itself */
  ct_surface surface[2];
  int32_t *faces[2];
  double *reference;
  double *mass;
  int32_t *nodes;
  ct_contact_options options;
} contact_data;

/* The contact of one state, and current coordinates of the effect's nodes. */
typedef struct contact_scratch {
  ct_contact *contact;
  double *x;
  double held; /* energy of the constraints */
  double work; /* of start gaps that fade */
} contact_scratch;

static void free_data(void *data)
{
  contact_data *d = data;
  if (d == NULL) return;
  ct_release(d->faces[0]);
  ct_release(d->faces[1]);
  ct_release(d->reference);
  ct_release(d->mass);
  ct_release(d->nodes);
  ct_release(d);
}

static void free_scratch(void *scratch)
{
  contact_scratch *s = scratch;
  if (s == NULL) return;
  ct_contact_free(s->contact);
  ct_release(s->x);
  ct_release(s);
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const contact_data *data = effect->data;
  contact_scratch *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  s->x = ct_allocate((size_t)effect->node_count, 3 * sizeof *s->x);
  ct_status status =
      s->x != NULL ? CT_OK : ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  if (status == CT_OK)
    status = data->sides == 1
                 ? ct_contact_create_self(&data->surface[0], &data->options, &s->contact, error)
                 : ct_contact_create(&data->surface[0], &data->surface[1], &data->options,
                                     &s->contact, error);
  if (status != CT_OK) {
    free_scratch(s);
    return status;
  }
  *scratch = s;
  return CT_OK;
}

/* A point's memory: number of its other face plus one, negative while it is in contact, or 0: none,
 * or BURIED; the parameters there; the signed distance, NaN where none is known; and where a step's
 * gaps give the force this force. After the points: whether there was a step before, and what all
 * constraints stored in the middle of that step; what start gaps need; and the coordinates of the
 * effect's nodes, shape (node_count, 3). */
enum { OTHER = 0, XI = 1, KNOWN = 3, FORCE = 4 };
enum { BEGUN = 0, STORED = 1, TAIL = 2 };
static const double BURIED = -4294967296.0;

static int is_penalty(const contact_data *data)
{
  return data->options.enforcement == CT_ENFORCE_PENALTY;
}
/* Where the memory of start gaps begins, of each point; and how far apart the memory of two points
 * is. */
static int shifts_at(const contact_data *data) { return is_penalty(data) ? FORCE : FORCE + 1; }
static int stride(const contact_data *data)
{
  return shifts_at(data) + ct_initial_point_memory(&data->options);
}
/* Where the memory after the points begins. */
static int64_t tail_at(const contact_data *data, const ct_contact *contact)
{
  return stride(data) * ct_contact_point_count(contact);
}

/* Where the memory of the nodes' coordinates begins. */
static int64_t places_at(const contact_data *data, const ct_contact *contact)
{
  return tail_at(data, contact) + TAIL + ct_initial_end_memory(&data->options);
}

static void recall(ct_contact *contact, const double *memory, int size)
{
  contact->begun = memory[size * ct_contact_point_count(contact) + BEGUN] != 0.0;
  for (int s = 0; s < contact->sides; s++)
    for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]); i++, memory += size) {
      ct_gauss_point *point = &contact->side[s].points[i];
      double last = (double)contact->side[contact->sides - 1 - s].search->face_count,
             number = fabs(memory[OTHER]);
      point->other = number >= 1.0 && number <= last ? (int32_t)number - 1 : -1;
      point->history = memory[OTHER] == BURIED ? CT_POINT_BURIED
                       : point->other < 0      ? CT_POINT_NEW
                       : memory[OTHER] < 0.0   ? CT_POINT_INSIDE
                                               : CT_POINT_OUTSIDE;
      memcpy(point->xi, &memory[XI], sizeof point->xi);
      point->known = contact->begun ? memory[KNOWN] : NAN;
    }
}

static void remember(const ct_contact *contact, double *memory, int size)
{
  for (int s = 0; s < contact->sides; s++)
    for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]); i++, memory += size) {
      const ct_gauss_point *point = &contact->side[s].points[i];
      double number = (double)point->other + 1.0;
      memory[OTHER] = point->history == CT_POINT_BURIED   ? BURIED
                      : point->history == CT_POINT_INSIDE ? -number
                                                          : number;
      memcpy(&memory[XI], point->xi, sizeof point->xi);
      memory[KNOWN] = point->known;
    }
  memory[BEGUN] = 1.0;
}

static ct_initial_view initial_view(const contact_data *data, const ct_view *view,
                                    const ct_contact *contact)
{
  int64_t tail = tail_at(data, contact);
  return (ct_initial_view){view->time,
                           view->dt,
                           view->memory[tail + BEGUN] == 0.0,
                           stride(data),
                           view->memory + shifts_at(data),
                           view->memory + KNOWN,
                           view->memory + tail + TAIL,
                           view->next_memory + shifts_at(data),
                           view->next_memory + tail + TAIL};
}

/* True distances of the points at the current coordinates, or with the displacement null on the
 * undeformed shape. */
static ct_status look(const ct_effect *effect, const ct_view *view, const double *displacement,
                      ct_error *error)
{
  const contact_data *data = effect->data;
  contact_scratch *s = view->scratch;
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)effect->nodes[i] + c;
      s->x[3 * (int64_t)i + c] =
          view->reference[dof] + (displacement != NULL ? displacement[dof] : 0.0);
    }
  s->contact->options.threads = view->threads;
  s->contact->start = !(view->time > 0.0);
  recall(s->contact, view->memory, stride(data));
  // -- Nodes move from where the last step saw them, and at the first look from the reference shape
  // (eq:gap-bound)
  const int64_t places = places_at(data, s->contact);
  const double *last = s->contact->begun ? view->memory + places : data->reference;
  ct_status status = CT_OK;
  for (int i = 0; i < s->contact->sides && status == CT_OK; i++) {
    status = ct_search_check(s->contact->side[i].search, last, i, error);
    if (status == CT_OK) ct_search_place(s->contact->side[i].search, last);
  }
  if (status == CT_OK) status = ct_contact_measure(s->contact, s->x, s->x, error);
  memcpy(view->next_memory + places, s->x, 3 * (size_t)effect->node_count * sizeof *s->x);
  if (status != CT_OK && error != NULL && error->point >= 0)
    error->point = effect->nodes[error->point];
  return status;
}

/* Gaps of the points at the time of the view, counted from their start gaps. */
static ct_status measure(const ct_effect *effect, const ct_view *view, ct_error *error)
{
  const contact_data *data = effect->data;
  ct_contact *contact = ((const contact_scratch *)view->scratch)->contact;
  ct_initial_view shown = initial_view(data, view, contact);
  int shifts = ct_initial_point_memory(&data->options) > 0;
  ct_status status = CT_OK;
  // -- Start gaps are those of the undeformed shape (eq:initial-adjust)
  if (shown.first && shifts) status = look(effect, view, NULL, error);
  if (status == CT_OK && shown.first && shifts) ct_initial_begin(contact, &shown);
  if (status == CT_OK) status = look(effect, view, view->displacement, error);
  if (status == CT_OK && view->dt > 0.0 && view->time > 0.0)
    status = ct_passage_check(contact, effect->nodes, view->velocity, view->dt, view->time, error);
  if (status == CT_OK && shifts) ct_initial_shift(contact, &shown);
  if (status == CT_OK && shown.first && data->options.initial == CT_INITIAL_REFUSE)
    status = ct_initial_refuse(contact, error);
  if (status == CT_OK) remember(contact, view->next_memory, stride(data));
  return status;
}

static ct_status contact_constrain(const ct_effect *effect, const ct_view *view,
                                   ct_constraint *list, int64_t *count, ct_error *error)
{
  static const double at_rest[3] = {0.0, 0.0, 0.0};
  const contact_data *data = effect->data;
  ct_status status = measure(effect, view, error);
  if (status != CT_OK) return status;
  const ct_contact *contact = ((const contact_scratch *)view->scratch)->contact;
  int64_t first = 0;
  for (int s = 0; s < contact->sides; s++) {
    const ct_side *side = &contact->side[s];
    ct_press press = {side,
                      &contact->side[contact->sides - 1 - s],
                      0.5 * data->options.epsilon,
                      data->options.enforcement,
                      data->options.dissipation,
                      HUGE_VAL,
                      first,
                      &view->memory[stride(data) * first + FORCE],
                      stride(data),
                      1};
    *count += ct_press_list(&press, at_rest, &list[*count]);
    first += ct_side_point_count(side);
  }
  return CT_OK;
}

static const ct_effect_constraints CONSTRAINTS = {.list = contact_constrain};

/* Forces of the constraints on the points, and into the memory; the energy that they hold. */
static void take_constraints(const contact_data *data, const ct_view *view,
                             contact_scratch *scratch)
{
  ct_contact *contact = scratch->contact;
  int64_t first = 0;
  for (int s = 0; s < contact->sides; s++) {
    ct_press_apply(&contact->side[s], first, view->constraints, view->constraint_count);
    first += ct_side_point_count(&contact->side[s]);
  }
  int64_t stored = tail_at(data, contact) + STORED;
  ct_press_remember(view->constraints, view->constraint_count, ct_contact_point_count(contact),
                    &view->next_memory[FORCE], stride(data));
  scratch->held = ct_press_energy(view->constraints, view->constraint_count, view->time,
                                  view->memory[stored], &view->next_memory[stored], contact->terms);
}

static ct_status contact_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const contact_data *data = effect->data;
  contact_scratch *s = view->scratch;
  ct_status status = is_penalty(data) ? measure(effect, view, error) : CT_OK;
  if (status == CT_OK && !is_penalty(data)) take_constraints(data, view, s);
  if (status == CT_OK && ct_initial_end_memory(&data->options) > 0) {
    ct_initial_view shown = initial_view(data, view, s->contact);
    s->work = ct_initial_work(s->contact, &shown);
  }
  if (status == CT_OK) status = ct_contact_collect(s->contact, error);
  if (status != CT_OK) return status;
  memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  return ct_contact_add_force(s->contact, force, force);
}

static ct_status contact_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                ct_error *error)
{
  const contact_scratch *s = view->scratch;
  (void)error;
  *energy = is_penalty(effect->data) ? ct_contact_energy(s->contact) : s->held;
  return CT_OK;
}

static ct_status contact_external(const ct_effect *effect, const ct_view *view, double *work,
                                  ct_error *error)
{
  (void)effect;
  (void)error;
  *work = ((const contact_scratch *)view->scratch)->work;
  return CT_OK;
}

ct_status ct_contact_spring_frequency(const ct_effect *effect, const void *scratch,
                                      double *omega_squared, ct_error *error)
{
  const contact_data *data = effect->data;
  ct_status status = ct_contact_frequency(((const contact_scratch *)scratch)->contact, data->mass,
                                          data->mass, omega_squared);
  return status == CT_OK ? CT_OK
                         : ct_fail(error, status, CT_NOWHERE, "contact: no bound on the time step");
}

static ct_status contact_frequency(const ct_effect *effect, const ct_view *view,
                                   double *omega_squared, ct_error *error)
{
  // -- Other enforcements leave the step as it is (eq:controlled-energy)
  return is_penalty(effect->data)
             ? ct_contact_spring_frequency(effect, view->scratch, omega_squared, error)
             : CT_OK;
}

static ct_status renumber(contact_data *data, const ct_surface *surface[2],
                          const double *nodal_mass, int32_t *count, ct_error *error)
{
  int32_t total = surface[0]->node_count;
  int32_t *own = ct_allocate((size_t)total, sizeof *own);
  ct_status status = own != NULL ? CT_OK : CT_ERROR_MEMORY;
  for (int s = 0; status == CT_OK && s < data->sides; s++) {
    size_t entries = (size_t)surface[s]->face_count * (size_t)ct_face_node_count(surface[s]->kind);
    data->faces[s] = ct_allocate(entries, sizeof *data->faces[s]);
    if (data->faces[s] == NULL) status = CT_ERROR_MEMORY;
    for (size_t i = 0; status == CT_OK && i < entries; i++) {
      int32_t node = surface[s]->faces[i];
      if (node < 0 || node >= total)
        status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){s, (int64_t)i, node},
                         "surface %d names node %d of %d", s, (int)node, (int)total);
      else own[node] = 1;
    }
  }
  size_t marked = 0;
  for (int32_t n = 0; status == CT_OK && n < total; n++) marked += own[n] != 0;
  data->nodes = ct_allocate(marked, sizeof *data->nodes);
  data->reference = ct_allocate(marked, 3 * sizeof *data->reference);
  data->mass = ct_allocate(marked, sizeof *data->mass);
  if (status == CT_OK && !(data->nodes && data->reference && data->mass)) status = CT_ERROR_MEMORY;
  for (int32_t n = 0; status == CT_OK && n < total; n++)
    if (own[n]) {
      data->nodes[*count] = n;
      memcpy(&data->reference[3 * (size_t)*count], &surface[0]->reference[3 * (size_t)n],
             3 * sizeof(double));
      data->mass[*count] = nodal_mass[n];
      own[n] = (*count)++;
    }
  for (int s = 0; status == CT_OK && s < data->sides; s++) {
    size_t entries = (size_t)surface[s]->face_count * (size_t)ct_face_node_count(surface[s]->kind);
    for (size_t i = 0; i < entries; i++) data->faces[s][i] = own[surface[s]->faces[i]];
    data->surface[s] = (ct_surface){surface[s]->kind, *count, surface[s]->face_count,
                                    data->faces[s], data->reference};
  }
  ct_release(own);
  return status == CT_ERROR_MEMORY ? ct_fail(error, status, CT_NOWHERE, "no memory for a contact")
                                   : status;
}

/* Operations and bytes of a call with all points pressing, without the rounds in which their forces
 * are found: counted in a contact of two plane surfaces (eq:round-flops). */
static void count_costs(ct_effect *effect, const contact_data *data, int64_t points)
{
  double listed = is_penalty(data) ? 0.0 : 1.0, memory = 2.0 * stride(data) * sizeof(double);
  effect->flops = (800.0 + 400.0 * listed) * (double)points;
  double bytes = 2.0 * sizeof(ct_gauss_point) + memory + 4.0 * listed * sizeof(ct_constraint);
  effect->bytes = bytes * (double)points + 250.0 * effect->node_count;
}

ct_status ct_contact_create_effect(const ct_surface *a, const ct_surface *b,
                                   const ct_contact_options *options, const double *nodal_mass,
                                   ct_effect **out, ct_error *error)
{
  if (a == NULL || b == NULL || options == NULL || nodal_mass == NULL || out == NULL ||
      a->node_count != b->node_count || a->reference != b->reference || a->faces == NULL ||
      b->faces == NULL || a->reference == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: null argument, or surfaces of different problems");
  const ct_surface *surface[2] = {a, b};
  ct_effect *effect = ct_allocate(1, sizeof *effect);
  contact_data *data = ct_allocate(1, sizeof *data);
  if (effect == NULL || data == NULL) {
    ct_release(effect);
    ct_release(data);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  }
  data->options = *options;
  data->sides = a == b ? 1 : 2;
  *effect = (ct_effect){.kind = CT_EFFECT_CONTACT,
                        .label = "contact",
                        .data = data,
                        .create_scratch = create_scratch,
                        .free_scratch = free_scratch,
                        .force = contact_force,
                        .energy = contact_energy,
                        .omega2_bound = contact_frequency,
                        .free_data = free_data};
  void *trial = NULL;
  ct_status status = renumber(data, surface, nodal_mass, &effect->node_count, error);
  effect->nodes = data->nodes;
  if (status == CT_OK) status = create_scratch(effect, &trial, error);
  if (status != CT_OK) {
    ct_effect_free(effect);
    return status;
  }
  int64_t points = ct_contact_point_count(((contact_scratch *)trial)->contact);
  effect->memory_count =
      places_at(data, ((contact_scratch *)trial)->contact) + 3 * (int64_t)effect->node_count;
  count_costs(effect, data, points);
  if (options->initial == CT_INITIAL_REMOVE) effect->external = contact_external;
  if (!is_penalty(data)) {
    effect->phase = CT_PHASE_CONSTRAINT;
    effect->constraints = &CONSTRAINTS;
    effect->constraint_count = points;
  }
  free_scratch(trial);
  *out = effect;
  return CT_OK;
}

const ct_contact *ct_contact_of_scratch(const void *scratch)
{
  return scratch == NULL ? NULL : ((const contact_scratch *)scratch)->contact;
}
