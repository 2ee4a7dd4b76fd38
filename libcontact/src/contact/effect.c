/* The contact as an effect of a problem. */
#include <libcontact/contact_effect.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../step/effect_internal.h"
#include "../step/workspace.h"
#include "contact_internal.h"

#include <string.h>

/* Data shared by all states. */
typedef struct contact_data {
  ct_contact_fixed *fixed;
  const double *mass; /* of the problem's nodes */
} contact_data;

static int is_penalty(const contact_data *data) { return ct_contact_is_penalty(data->fixed); }

static ct_moment moment_of(const contact_data *data, const ct_view *view)
{
  return (ct_moment){.time = view->time,
                     .before = view->time > 0.0 ? view->dt : 0.0,
                     .dt = view->dt,
                     .velocity = {view->velocity, view->velocity},
                     .first = !ct_contact_memory_begun(data->fixed, view->memory)};
}

/* Gaps of the points at the time of the view. Nodes move from their places in the last step, in the
 * first call from the reference shape, to the current coordinates (eq:gap-bound). */
static ct_status measure(const ct_effect *effect, const ct_view *view, ct_error *error)
{
  const contact_data *data = effect->data;
  ct_contact *contact = view->scratch;
  const ct_moment now = moment_of(data, view);
  contact->threads = view->threads;
  ct_status status = now.first ? ct_contact_begin(contact, &now, error)
                               : ct_contact_load(contact, view->memory, error);
  if (status != CT_OK) return status;
  for (int s = 0; s < contact->fixed->sides; s++) {
    const ct_search *search = contact->side[s].search;
    for (int64_t d = 0; d < 3 * (int64_t)search->node_count; d++) {
      int64_t dof = 3 * (int64_t)search->nodes[d / 3] + d % 3;
      contact->side[s].moved[d] = view->reference[dof] + view->displacement[dof];
    }
  }
  return ct_contact_find_gaps(contact, &now, error);
}

static ct_status contact_constrain(const ct_effect *effect, const ct_view *view,
                                   ct_constraint **rows, int64_t *count, ct_error *error)
{
  ct_status status = measure(effect, view, error);
  if (status == CT_OK) *count = ct_contact_list_rows(view->scratch, rows);
  return status;
}

static const ct_effect_constraints CONSTRAINTS = {.list = contact_constrain};

static ct_status contact_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const contact_data *data = effect->data;
  ct_contact *contact = view->scratch;
  const ct_moment now = moment_of(data, view);
  ct_status status = is_penalty(data) ? measure(effect, view, error) : CT_OK;
  if (status == CT_OK) status = ct_contact_find_forces(contact, &now, error);
  if (status != CT_OK) return status;
  ct_contact_store(contact, view->next_memory);
  memset(force, 0, 3 * (size_t)effect->node_count * sizeof *force);
  for (int s = 0; s < data->fixed->sides; s++)
    for (int32_t n = 0; n < contact->side[s].search->node_count; n++)
      for (int c = 0; c < 3; c++)
        force[3 * (int64_t)data->fixed->place[s][n] + c] += ct_side_force(&contact->side[s], n, c);
  return CT_OK;
}

static ct_status contact_energy(const ct_effect *effect, const ct_view *view, double *energy,
                                ct_error *error)
{
  (void)effect;
  (void)error;
  *energy = ct_contact_energy(view->scratch);
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

ct_status ct_contact_springs(const ct_effect *effect, const void *scratch, int facing,
                             double *omega2, ct_error *error)
{
  const contact_data *data = effect->data;
  ct_status status = (facing ? ct_contact_facing_bound
                             : ct_contact_omega2_bound)(scratch, data->mass, data->mass, omega2);
  return status == CT_OK ? CT_OK
                         : ct_fail(error, status, CT_NOWHERE, "contact: no bound on the time step");
}

static ct_status contact_omega2_bound(const ct_effect *effect, const ct_view *view, double *omega2,
                                      ct_error *error)
{
  // -- Other enforcements leave the step as it is (eq:controlled-energy)
  return is_penalty(effect->data) ? ct_contact_springs(effect, view->scratch, 0, omega2, error)
                                  : CT_OK;
}

static void free_data(void *data)
{
  contact_data *d = data;
  if (d == NULL) return;
  ct_contact_fixed_free(d->fixed);
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

/* Operations and bytes of a call with all points active, without the iterations of the solver:
 * counted in a contact of two plane surfaces (eq:round-flops). */
static void count_costs(ct_effect *effect, const contact_data *data)
{
  double points = (double)data->fixed->point_count, listed = is_penalty(data) ? 0.0 : 1.0;
  effect->flops = (800.0 + 400.0 * listed) * points;
  double bytes = 2.0 * sizeof(ct_point) + 2.0 * sizeof(ct_point_record);
  effect->bytes = bytes * points + 250.0 * effect->node_count;
}

/* Constant data of the effect. */
static ct_status fill(contact_data *data, const ct_contact_def *def, const ct_problem *problem,
                      ct_effect *effect, ct_error *error)
{
  const ct_surface *surface[2] = {def->a, def->b};
  data->mass = problem->mass;
  ct_status status = ct_contact_fixed_create(surface, def->a == def->b ? 1 : 2, &def->options,
                                             &data->fixed, error);
  if (status != CT_OK) return status;
  effect->nodes = data->fixed->nodes;
  effect->node_count = data->fixed->node_count;
  effect->memory_count = ct_contact_fixed_memory(data->fixed);
  count_costs(effect, data);
  if (ct_start_gap_fades(&data->fixed->start_rule)) effect->external = contact_external;
  if (is_penalty(data)) return CT_OK;
  effect->phase = CT_PHASE_CONSTRAINT;
  effect->constraints = &CONSTRAINTS;
  effect->constraint_count = data->fixed->point_count;
  effect->constraint_nodes = ct_contact_row_nodes(data->fixed);
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

const ct_contact_fixed *ct_contact_fixed_of(const ct_effect *effect)
{
  return ((const contact_data *)effect->data)->fixed;
}

const ct_contact *ct_state_contact(const ct_problem *problem, ct_state *state, int32_t effect,
                                   ct_error *error)
{
  if (problem == NULL || state == NULL || effect < 0 || effect >= problem->effect_count ||
      problem->effects[effect]->kind != CT_EFFECT_CONTACT) {
    ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "effect %d is not a contact", (int)effect);
    return NULL;
  }
  return ct_workspace_forces(problem, state, error) == CT_OK ? state->workspace->scratch[effect]
                                                             : NULL;
}
