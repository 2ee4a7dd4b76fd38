/* Two surfaces that meet each other, or one that meets itself: all are slave once and master once
 * (eq:contact-potential). */
#include <libcontact/contact_result.h>

#include "../constraint/law.h"
#include "../constraint/solve.h"
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
                              .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                              .dissipation = 0.15,
                              .restitution = 1.0,
                              .initial_penetration = CT_INITIAL_KEEP,
                              .force_tolerance = CT_SOLVER_USUAL};
}

double ct_contact_penalty(double beta, double young, double h)
{
  // -- ε = β E / h (eq:penalty-factor)
  return beta * young / h;
}

double ct_contact_penalty_default(ct_enforcement enforcement, double modulus, double h)
{
  // -- 40 ρ c₁² / h, or 4 where a stiff penalty costs steps (eq:penalty-default)
  return ct_law_usual(enforcement) * modulus / h;
}

/* The law of all points; both sides share the penalty. */
static ct_constraint law_of(const ct_contact_options *options)
{
  return (ct_constraint){.enforcement = options->enforcement,
                         .stiffness = 0.5 * options->epsilon,
                         .dissipation = options->dissipation,
                         .restitution = options->restitution,
                         .travel_time = options->travel_time};
}

static ct_status check_options(const ct_contact_fixed *fixed, const ct_contact_options *options,
                               ct_error *error)
{
  if (!(options->tolerance > 0.0 && options->tolerance < 1.0))
    return CT_REFUSE(error, "contact: tolerance must be above 0 and below 1, not %g",
                     options->tolerance);
  if (!(options->depth >= 0.0) || !isfinite(options->depth))
    return CT_REFUSE(error, "contact: depth must be 0 or positive and finite, not %g",
                     options->depth);
  if (options->threads < 1 || options->threads > CT_MOST_THREADS)
    return CT_REFUSE(error, "contact: threads must be 1 to %d, not %d", CT_MOST_THREADS,
                     options->threads);
  if (!ct_solver_accepts(options->force_tolerance))
    return CT_REFUSE(error, "contact: force_tolerance must be 0 or 1e-12 to 0.1, not %g",
                     options->force_tolerance);
  if (!ct_method_exists(options->method))
    return CT_REFUSE(error, "contact: there is no search method %d", (int)options->method);
  return ct_contact_check(fixed, options->epsilon, options->points, error);
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
  for (int32_t at[2] = {0, 0}; at[0] < end[0] || at[1] < end[1]; fixed->is.node_count++) {
    int32_t next = INT32_MAX;
    for (int s = 0; s < 2; s++)
      if (at[s] < end[s] && search[s]->nodes[at[s]] + s * offset < next)
        next = search[s]->nodes[at[s]] + s * offset;
    for (int s = 0; s < 2; s++)
      if (at[s] < end[s] && search[s]->nodes[at[s]] + s * offset == next)
        fixed->gaps.place[s][at[s]++] = fixed->is.node_count;
    fixed->nodes[fixed->is.node_count] = next;
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

static ct_status open_state(ct_contact *contact)
{
  ct_status status = CT_OK;
  const ct_gaps_fixed *fixed = contact->gaps.fixed;
  for (int s = 0; status == CT_OK && s < fixed->sides; s++)
    status = ct_side_equip(&contact->gaps.side[s]);
  const ct_side_fixed *side = &fixed->side[0];
  // Points on an edge lie on the face across it, and a quadratic face can fold within itself.
  if (status != CT_OK || fixed->sides == 2 || fixed->alone || side->on_edges ||
      side->search->per > side->search->edges)
    return status;
  uint8_t *creased = ct_allocate((size_t)side->search->face_count, sizeof *creased);
  contact->gaps.side[0].creased = creased;
  return creased == NULL ? CT_ERROR_MEMORY : CT_OK;
}

static ct_status measure(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  contact->gaps.start = !(now->time > 0.0);
  return ct_gaps_measure(&contact->gaps, now->threads, error);
}

static ct_status check(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  return contact->gaps.fixed->alone
             ? CT_OK
             : ct_tunnelling_check(&contact->gaps, now->velocity, now->before, now->time, error);
}

static const ct_partner_calls SURFACES = {.label = "contact",
                                          .open = open_state,
                                          .measure = measure,
                                          .check = check,
                                          .find_springs = ct_contact_find_springs};

ct_status ct_contact_fixed_create(const ct_surface *const surface[2], int sides,
                                  const ct_contact_options *options, ct_contact_fixed **out,
                                  ct_error *error)
{
  ct_status status = ct_check_options(options->cookie, "ct_contact_options_default", error);
  if (status != CT_OK) return status;
  ct_contact_fixed *fixed = ct_allocate(1, sizeof *fixed);
  if (fixed == NULL) return CT_NO_MEMORY(error, "a contact");
  double size = 0.0;
  fixed->partner = &SURFACES;
  fixed->law = law_of(options);
  fixed->admits = 1;
  fixed->threads = options->threads;
  fixed->force_tolerance = options->force_tolerance;
  fixed->start_rule =
      (ct_start_rule){options->initial_penetration, options->removal_time, options->adjust};
  status = check_options(fixed, options, error);
  fixed->gaps.project = ct_project_options_default();
  fixed->gaps.project.method = options->method;
  fixed->gaps.project.tolerance = options->tolerance;
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
    status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                     "contact: the two surfaces have more than 2147483647 nodes");
  if (status == CT_OK && list_nodes(fixed, offset) != CT_OK)
    status = CT_NO_MEMORY(error, "a contact");
  fixed->gaps.depth = options->depth > 0.0 ? options->depth : size;
  if (status == CT_OK && options->adjust > fixed->gaps.depth)
    status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                     "contact: adjust must be at most the depth of the search, %g, not %g",
                     fixed->gaps.depth, options->adjust);
  if (status == CT_OK &&
      ct_tunnelling_init(&fixed->gaps, options->depth > 0.0, options->adjust) != CT_OK)
    status = CT_NO_MEMORY(error, "a contact");
  if (status != CT_OK) {
    ct_contact_fixed_free(fixed);
    return status;
  }
  const int penalty = !ct_law_has_rows(options->enforcement);
  // -- Counted in a contact of two plane surfaces (eq:round-flops)
  ct_contact_describe(fixed, penalty ? 800.0 : 1200.0, 0.0);
  *out = fixed;
  return CT_OK;
}
