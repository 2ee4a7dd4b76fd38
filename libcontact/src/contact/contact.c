/* The contact of two surfaces: both are slave once and master once (eq:contact-potential). Shared
 * by a host's contact and the effect. */
#include <libcontact/contact_result.h>

#include "../constraint/law.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"
#include "../projection/projection_internal.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

ct_contact_options ct_contact_options_default(void)
{
  return (ct_contact_options){.cookie = CT_DEF_COOKIE,
                              .epsilon = 0.0,
                              .method = CT_ROBUST,
                              .tolerance = 1e-10,
                              .depth = 0.0,
                              .threads = 1,
                              .separated = 1,
                              .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                              .dissipation = 0.15,
                              .initial_penetration = CT_INITIAL_KEEP};
}

double ct_contact_penalty(double beta, double young, double h)
{
  // -- ε = β E / h (eq:penalty-factor)
  return beta * young / h;
}

double ct_contact_penalty_default(ct_enforcement enforcement, double modulus, double h)
{
  // -- 40 ρ c₁² / h, or 4 where a stiff penalty costs steps (eq:penalty-default)
  return (enforcement == CT_ENFORCE_ENERGY_CONTROLLED ? 40.0 : 4.0) * modulus / h;
}

/* The law of all points; both sides share the penalty. */
static ct_constraint law_of(const ct_contact_options *options)
{
  return (ct_constraint){.enforcement = options->enforcement,
                         .stiffness = 0.5 * options->epsilon,
                         .dissipation = options->dissipation};
}

static ct_start_rule start_rule_of(const ct_contact_options *options)
{
  return (ct_start_rule){options->initial_penetration, options->removal_time, options->adjust};
}

static ct_status check_options(const ct_contact_options *options, ct_error *error)
{
  ct_status known = ct_check_options(options->cookie, "ct_contact_options_default", error);
  if (known != CT_OK) return known;
  if (!(options->epsilon > 0.0) || !isfinite(options->epsilon))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: the penalty must be positive, not %g", options->epsilon);
  if (!(options->tolerance > 0.0 && options->tolerance < 1.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: a tolerance of %g",
                   options->tolerance);
  if (!(options->depth >= 0.0) || !isfinite(options->depth) || options->threads < 1 ||
      options->threads > CT_MOST_THREADS)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: depth %g, %d threads",
                   options->depth, options->threads);
  const ct_start_rule start = start_rule_of(options);
  ct_status status = ct_start_gap_check(&start, "contact", error);
  if (status != CT_OK) return status;
  if (options->points != CT_POINTS_GAUSS && options->points != CT_POINTS_LOBATTO)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: there is no rule of points %d",
                   (int)options->points);
  if (!ct_method_exists(options->method))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: there is no search method %d",
                   (int)options->method);
  const ct_constraint law = law_of(options);
  return ct_law_check(&law, "contact", error);
}

void ct_contact_fixed_free(ct_contact_fixed *fixed)
{
  if (fixed == NULL) return;
  for (int s = 0; s < fixed->gaps.sides; s++) ct_side_fixed_clear(&fixed->gaps.side[s]);
  ct_release(fixed->gaps.place[0]);
  ct_release(fixed->gaps.place[1]);
  ct_release(fixed->nodes);
  ct_release(fixed);
}

/* List the nodes of all surfaces, each in ascending order; those of the second have numbers beyond
 * `offset`. */
static ct_status list_nodes(ct_contact_fixed *fixed, int32_t offset)
{
  const ct_search *search[2] = {fixed->gaps.side[0].search, fixed->gaps.side[1].search};
  int32_t end[2] = {search[0]->node_count, fixed->gaps.sides == 1 ? 0 : search[1]->node_count};
  fixed->nodes = ct_allocate((size_t)end[0] + (size_t)end[1], sizeof *fixed->nodes);
  for (int s = 0; s < 2; s++)
    fixed->gaps.place[s] = ct_allocate((size_t)end[s], sizeof *fixed->gaps.place[s]);
  if (!fixed->nodes || !fixed->gaps.place[0] || !fixed->gaps.place[1]) return CT_ERROR_MEMORY;
  for (int32_t at[2] = {0, 0}; at[0] < end[0] || at[1] < end[1]; fixed->node_count++) {
    int32_t next = INT32_MAX;
    for (int s = 0; s < 2; s++)
      if (at[s] < end[s] && search[s]->nodes[at[s]] + s * offset < next)
        next = search[s]->nodes[at[s]] + s * offset;
    for (int s = 0; s < 2; s++)
      if (at[s] < end[s] && search[s]->nodes[at[s]] + s * offset == next)
        fixed->gaps.place[s][at[s]++] = fixed->node_count;
    fixed->nodes[fixed->node_count] = next;
  }
  for (int s = 0; s < fixed->gaps.sides; s++) {
    ct_side_fixed *side = &fixed->gaps.side[s];
    size_t entries = (size_t)search[s]->face_count * (size_t)search[s]->per;
    side->row_faces = ct_allocate(entries, sizeof *side->row_faces);
    if (side->row_faces == NULL) return CT_ERROR_MEMORY;
    for (size_t i = 0; i < entries; i++)
      side->row_faces[i] = fixed->gaps.place[s][search[s]->faces[i]];
  }
  return CT_OK;
}

/* The contact as an interaction. Flops and bytes were counted in a contact of two plane surfaces
 * (eq:round-flops). */
static void describe(ct_contact_fixed *fixed)
{
  const double points = (double)fixed->gaps.point_count;
  const int penalty = ct_contact_is_penalty(fixed);
  double bytes = 2.0 * sizeof(ct_point) + 2.0 * sizeof(ct_point_record);
  fixed->is = (ct_interaction){.calls = &ct_contact_calls,
                               .nodes = fixed->nodes,
                               .node_count = fixed->node_count,
                               .explicit = penalty,
                               .row_count = penalty ? 0 : fixed->gaps.point_count,
                               .row_nodes = ct_contact_row_nodes(fixed),
                               .memory_count = ct_contact_fixed_memory(fixed),
                               .end_record = CT_RECORD * fixed->gaps.point_count,
                               .stiffness = 1.0,
                               .flops = (penalty ? 800.0 : 1200.0) * points,
                               .bytes = bytes * points + 250.0 * fixed->node_count};
}

ct_status ct_contact_fixed_create(const ct_surface *const surface[2], int sides,
                                  const ct_contact_options *options, ct_contact_fixed **out,
                                  ct_error *error)
{
  ct_status status = check_options(options, error);
  if (status != CT_OK) return status;
  ct_contact_fixed *fixed = ct_allocate(1, sizeof *fixed);
  if (fixed == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  double size = 0.0;
  fixed->options = *options;
  fixed->start_rule = start_rule_of(options);
  fixed->gaps.project = ct_project_options_default();
  fixed->gaps.project.method = options->method;
  fixed->gaps.project.tolerance = options->tolerance;
  fixed->gaps.separated = options->separated;
  fixed->one_array = surface[0]->reference == surface[1]->reference;
  for (int s = 0; s < sides && status == CT_OK; s++) {
    status = ct_side_fixed_init(&fixed->gaps.side[s], surface[s], s,
                                options->points == CT_POINTS_LOBATTO, error);
    if (status != CT_OK) break;
    fixed->gaps.sides = s + 1;
    fixed->gaps.point_count += fixed->gaps.side[s].point_count;
    size = fmax(size, fixed->gaps.side[s].search->size);
  }
  const int32_t offset = fixed->one_array ? 0 : surface[0]->node_count;
  if (status == CT_OK && offset > INT32_MAX - surface[sides - 1]->node_count)
    status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: too many nodes");
  if (status == CT_OK && list_nodes(fixed, offset) != CT_OK)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  fixed->gaps.depth = options->depth > 0.0 ? options->depth : size;
  if (status == CT_OK && options->adjust > fixed->gaps.depth)
    status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                     "contact: surfaces are searched for each other up to the depth %g only, so "
                     "adjust = %g is too much",
                     fixed->gaps.depth, options->adjust);
  if (status == CT_OK &&
      ct_tunnelling_init(&fixed->gaps, options->depth > 0.0, options->adjust) != CT_OK)
    status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  if (status == CT_OK) describe(fixed), *out = fixed;
  else ct_contact_fixed_free(fixed);
  return status;
}

void ct_contact_close(void *state)
{
  ct_contact *contact = state;
  if (contact == NULL) return;
  for (int s = 0; s < 2; s++) ct_side_clear(&contact->gaps.side[s]);
  ct_release(contact->terms);
  ct_release(contact);
}

ct_status ct_contact_open(const ct_contact_fixed *fixed, ct_contact **out, ct_error *error)
{
  ct_contact *contact = ct_allocate(1, sizeof *contact);
  const ct_constraint law = law_of(&fixed->options);
  ct_status status = contact != NULL ? CT_OK : CT_ERROR_MEMORY;
  for (int s = 0; status == CT_OK && s < fixed->gaps.sides; s++) {
    status = ct_side_init(&contact->gaps.side[s], &fixed->gaps.side[s], &law);
    if (status == CT_OK) status = ct_side_equip(&contact->gaps.side[s]);
  }
  if (status == CT_OK) {
    contact->fixed = fixed;
    contact->gaps.fixed = &fixed->gaps;
    contact->gaps.threads = fixed->options.threads;
    contact->terms = ct_allocate((size_t)fixed->gaps.point_count, sizeof *contact->terms);
  }
  if (status != CT_OK || contact->terms == NULL) {
    ct_contact_close(contact);
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  }
  *out = contact;
  return CT_OK;
}

/* No point has touched anything, and the nodes are at the reference shape. */
static void forget(ct_contact *contact)
{
  contact->gaps.begun = 0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    ct_side *side = &contact->gaps.side[s];
    memcpy(side->search->x, side->fixed->search->x,
           3 * (size_t)side->search->node_count * sizeof *side->search->x);
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
      p->other = -1;
      p->status = CT_POINT_NEW;
      p->xi[0] = p->xi[1] = p->row.force = p->force_size = 0.0;
      p->admitted = p->stored = 0.0;
      p->known = NAN;
    }
  }
}

/* No point has touched anything, the nodes are at the reference shape, and start gaps are those of
 * this shape (eq:initial-adjust). */
static ct_status begin(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  contact->gaps.start = !(now->time > 0.0);
  contact->stored = contact->time = contact->work = 0.0;
  contact->admission = (ct_admission){.late = 0};
  forget(contact);
  if (!ct_start_gap_counts(&contact->fixed->start_rule)) return CT_OK;
  for (int s = 0; s < contact->fixed->gaps.sides; s++)
    memcpy(contact->gaps.side[s].moved, contact->gaps.side[s].search->x,
           3 * (size_t)contact->gaps.side[s].search->node_count * sizeof(double));
  ct_status status = ct_gaps_measure(&contact->gaps, error);
  if (status == CT_OK)
    ct_start_gap_begin(&contact->fixed->start_rule, contact->gaps.side, contact->fixed->gaps.sides);
  forget(contact);
  return status;
}

ct_status ct_contact_find_gaps(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  const ct_start_rule *rule = &contact->fixed->start_rule;
  contact->gaps.start = !(now->time > 0.0);
  contact->gaps.threads = now->threads;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    ct_side *side = &contact->gaps.side[s];
    const int32_t *place = contact->fixed->gaps.place[s];
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++)
      p->last_known = p->known;
    for (int32_t n = 0; n < side->search->node_count; n++)
      memcpy(&side->moved[3 * (int64_t)n], &now->x[3 * (int64_t)place[n]], 3 * sizeof *now->x);
  }
  ct_status status = ct_gaps_measure(&contact->gaps, error);
  if (status == CT_OK && now->before > 0.0 && !contact->fixed->gaps.alone)
    status = ct_tunnelling_check(&contact->gaps, now->velocity, now->before, now->time, error);
  if (status == CT_OK && ct_start_gap_counts(rule))
    ct_start_gap_shift(rule, contact->gaps.side, contact->fixed->gaps.sides, now, contact->time);
  if (status == CT_OK)
    ct_admission_shift(contact->gaps.side, contact->fixed->gaps.sides, ct_start_gap_counts(rule));
  if (status == CT_OK && !now->first && now->before > 0.0) ct_admission_limit(contact);
  if (status != CT_OK || !now->first || rule->initial_penetration != CT_INITIAL_REFUSE)
    return status;
  ct_penetration found;
  status = ct_contact_penetration(contact, CT_AT_POINTS, &found, error);
  if (status != CT_OK) return status;
  return ct_start_gap_refuse(rule, &found, "contact", contact->fixed->gaps.sides, error);
}

/* Nodes move from their places in the last step, in the first one from the reference shape, to the
 * current coordinates (eq:gap-bound). */
static ct_status place(void *state, const ct_surface_motion *now, ct_error *error)
{
  ct_contact *contact = state;
  ct_surface_motion at = *now;
  at.first = !ct_contact_memory_begun(contact->fixed, now->memory);
  ct_status status =
      at.first ? begin(contact, &at, error) : ct_contact_load(contact, now->memory, error);
  return status == CT_OK ? ct_contact_find_gaps(contact, &at, error) : status;
}

static int64_t list_rows(void *state, const ct_surface_motion *now, ct_constraint **rows)
{
  static const double at_rest[3] = {0.0, 0.0, 0.0};
  ct_contact *contact = state;
  int64_t count = 0;
  (void)now;
  for (int s = 0; s < contact->fixed->gaps.sides; s++)
    count += ct_side_list_rows(&contact->gaps.side[s], ct_contact_other(contact, s), HUGE_VAL,
                               at_rest, at_rest, &rows[count]);
  return count;
}

/* Sum of the forces of both sides on each node. */
static void add_sides(const ct_contact *contact, double *force)
{
  const ct_contact_fixed *fixed = contact->fixed;
  memset(force, 0, 3 * (size_t)fixed->node_count * sizeof *force);
  for (int s = 0; s < fixed->gaps.sides; s++)
    for (int32_t n = 0; n < contact->gaps.side[s].search->node_count; n++)
      for (int c = 0; c < 3; c++)
        force[3 * (int64_t)fixed->gaps.place[s][n] + c] +=
            ct_side_force(&contact->gaps.side[s], n, c);
}

static ct_status find_forces(void *state, const ct_surface_motion *now, double *force,
                             ct_error *error)
{
  ct_contact *contact = state;
  const int sides = contact->fixed->gaps.sides,
            first = !ct_contact_memory_begun(contact->fixed, now->memory);
  contact->solved = !ct_contact_is_penalty(contact->fixed);
  for (int s = 0; s < sides; s++)
    if (contact->solved) ct_side_take_rows(&contact->gaps.side[s]);
    else ct_side_apply_penalty(&contact->gaps.side[s]);
  if (contact->solved)
    contact->held = ct_side_rows_energy(contact->gaps.side, sides, now->time, contact->stored,
                                        &contact->stored, contact->terms);
  ct_admission_count(contact->gaps.side, sides, &contact->admission, contact->solved,
                     first || now->before == 0.0, contact->terms);
  if (ct_start_gap_fades(&contact->fixed->start_rule))
    contact->work +=
        ct_start_gap_work(&contact->fixed->start_rule, contact->gaps.side, sides, now->time,
                          first ? now->time : contact->time, contact->terms);
  contact->time = now->time;
  ct_status status = ct_side_collect(contact->gaps.side, sides, 0, error);
  if (status != CT_OK) return status;
  add_sides(contact, force);
  ct_contact_store(contact, now->next_memory);
  return CT_OK;
}

double ct_contact_own_energy(const ct_contact *contact)
{
  return contact->solved ? contact->held
                         : ct_side_potential(contact->gaps.side, contact->fixed->gaps.sides);
}

static void find_energy(const void *state, ct_interaction_energy *energy)
{
  const ct_contact *contact = state;
  *energy =
      (ct_interaction_energy){.stored = ct_contact_own_energy(contact), .removal = contact->work};
}

static ct_status open_state(const ct_interaction *interaction, void **state, ct_error *error)
{
  ct_contact *contact = NULL;
  ct_status status = ct_contact_open((const ct_contact_fixed *)interaction, &contact, error);
  *state = contact;
  return status;
}

static void free_fixed(ct_interaction *interaction)
{
  ct_contact_fixed_free((ct_contact_fixed *)interaction);
}

const ct_interaction_calls ct_contact_calls = {.free = free_fixed,
                                               .open = open_state,
                                               .close = ct_contact_close,
                                               .place = place,
                                               .list_rows = list_rows,
                                               .find_forces = find_forces,
                                               .find_energy = find_energy,
                                               .find_springs = ct_contact_find_springs};

ct_status ct_contact_resultant(const ct_contact *contact, double force_a[3], double moment_a[3],
                               double force_b[3], double moment_b[3], ct_error *error)
{
  if (contact == NULL || force_a == NULL || moment_a == NULL ||
      (contact->fixed->gaps.sides == 2 && (force_b == NULL || moment_b == NULL)))
    return CT_REFUSE(error, "contact: null argument");
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    double *force = s == 0 ? force_a : force_b, *moment = s == 0 ? moment_a : moment_b;
    for (int c = 0; c < 3; c++) force[c] = moment[c] = 0.0;
    for (int64_t n = 0; n < side->search->node_count; n++) {
      double f[3], m[3];
      for (int c = 0; c < 3; c++) f[c] = ct_side_force(side, n, c);
      ct_vector_cross(&side->search->x[3 * n], f, m);
      for (int c = 0; c < 3; c++) {
        force[c] += f[c];
        moment[c] += m[c];
      }
    }
  }
  return CT_OK;
}

int64_t ct_contact_point_count(const ct_contact *contact)
{
  int64_t count = 0;
  for (int s = 0; contact != NULL && s < contact->fixed->gaps.sides; s++)
    count += contact->fixed->gaps.side[s].point_count;
  return count;
}

ct_status ct_contact_points(const ct_contact *contact, ct_contact_point *points, ct_error *error)
{
  if (contact == NULL || points == NULL) return CT_REFUSE(error, "contact: null argument");
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (int64_t i = 0; i < side->fixed->point_count; i++, points++) {
      const ct_point *from = &side->points[i];
      int met = from->other >= 0;
      *points = (ct_contact_point){.side = s,
                                   .face = (int32_t)(i / side->fixed->rule.count),
                                   .point = (int32_t)(i % side->fixed->rule.count),
                                   .other = from->other,
                                   .gap = from->row.gap,
                                   .weight = side->fixed->weight[i],
                                   .start_gap = met ? from->shift : 0.0};
      ct_side_position(side, i, NULL, points->position);
      // No law has tension, so the pressure is the size of the force.
      points->pressure =
          sqrt(ct_vector_dot(from->force, from->force)) / (0.5 * side->fixed->weight[i]);
      for (int c = 0; c < 3; c++) points->closest[c] = met ? points->position[c] + from->d[c] : NAN;
      for (int c = 0; c < 2; c++) points->xi[c] = met ? from->xi[c] : NAN;
    }
  }
  return CT_OK;
}
