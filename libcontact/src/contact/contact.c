/* Surfaces whose points meet other surfaces or an obstacle: what both have in common, from gaps and
 * start gaps to rows, forces and energies. */
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../constraint/law.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

ct_status ct_contact_check(const ct_contact_fixed *fixed, double epsilon, ct_contact_rule points,
                           ct_error *error)
{
  const char *label = fixed->partner->label;
  if (!(epsilon > 0.0) || !isfinite(epsilon))
    return CT_REFUSE(error, "%s: the penalty epsilon must be positive, not %g", label, epsilon);
  if (points != CT_POINTS_GAUSS && points != CT_POINTS_LOBATTO)
    return CT_REFUSE(error, "%s: there is no rule of points %d", label, (int)points);
  ct_status status = ct_law_check(&fixed->law, label, error);
  return status == CT_OK ? ct_start_gap_check(&fixed->start_rule, label, error) : status;
}

void ct_contact_describe(ct_contact_fixed *fixed, double points, double nodes)
{
  const ct_side_fixed *side = fixed->gaps.side;
  const int rigid = ct_contact_is_rigid(fixed), surfaces = ct_gaps_surfaces(&fixed->gaps);
  const int penalty = !ct_law_has_rows(fixed->law.enforcement);
  int64_t count = 0;
  for (int s = 0; s < surfaces; s++) count += side[s].point_count;
  fixed->is.calls = &ct_contact_calls;
  if (fixed->nodes == NULL) fixed->is.node_count = side[0].search->node_count;
  fixed->is.nodes = fixed->nodes == NULL ? side[0].search->nodes : fixed->nodes;
  fixed->is.explicit = penalty;
  fixed->is.row_count = penalty ? 0 : fixed->gaps.point_count;
  fixed->is.row_nodes = side[0].search->per + (fixed->carrier != NULL ? CT_CARRIER_NODES
                                               : rigid ? 0
                                                       : side[surfaces - 1].search->per);
  fixed->is.memory_count = ct_contact_fixed_memory(fixed);
  fixed->is.point_memory = CT_RECORD;
  fixed->is.end_record = CT_RECORD * fixed->gaps.point_count;
  fixed->is.flops = points * (double)count + nodes * fixed->is.node_count;
  fixed->is.bytes = (2.0 * sizeof(ct_point) + 2.0 * sizeof(ct_point_record)) * (double)count +
                    250.0 * fixed->is.node_count;
}

void ct_contact_fixed_free(ct_contact_fixed *fixed)
{
  if (fixed == NULL) return;
  for (int s = 0; s < fixed->gaps.sides; s++) ct_side_fixed_clear(&fixed->gaps.side[s]);
  ct_release(fixed->gaps.place[0]);
  ct_release(fixed->gaps.place[1]);
  ct_release(fixed->nodes);
  if (fixed->partner->free != NULL) fixed->partner->free(fixed);
  ct_release(fixed);
}

void ct_contact_close(void *state)
{
  ct_contact *contact = state;
  if (contact == NULL) return;
  for (int s = 0; s < 2; s++) ct_side_clear(&contact->gaps.side[s]);
  ct_release(contact->terms);
  ct_release(contact->carried.weights);
  ct_release(contact);
}

ct_status ct_contact_open(const ct_contact_fixed *fixed, ct_contact **out, ct_error *error)
{
  ct_contact *contact = ct_allocate(1, sizeof *contact);
  ct_status status = contact != NULL ? CT_OK : CT_ERROR_MEMORY;
  for (int s = 0; status == CT_OK && s < ct_gaps_surfaces(&fixed->gaps); s++)
    status = ct_side_init(&contact->gaps.side[s], &fixed->gaps.side[s]);
  if (status == CT_OK) {
    contact->fixed = fixed;
    contact->gaps.fixed = &fixed->gaps;
    contact->reach = HUGE_VAL, contact->part = 1.0;
    contact->terms = ct_allocate((size_t)(fixed->gaps.point_count + fixed->is.node_count),
                                 sizeof *contact->terms);
    status = contact->terms != NULL ? fixed->partner->open(contact) : CT_ERROR_MEMORY;
  }
  if (status != CT_OK) {
    ct_contact_close(contact);
    return CT_NO_MEMORY(error, "the points of the %s", fixed->partner->label);
  }
  *out = contact;
  return CT_OK;
}

/* No point has touched anything, and the nodes are at the reference shape. */
static void forget(ct_contact *contact)
{
  contact->gaps.begun = 0;
  for (int s = 0; s < ct_gaps_surfaces(contact->gaps.fixed); s++) {
    ct_search *search = contact->gaps.side[s].search;
    memcpy(search->x, contact->gaps.side[s].fixed->search->x,
           3 * (size_t)search->node_count * sizeof *search->x);
  }
  for (int s = 0; s < contact->gaps.fixed->sides; s++) {
    ct_side *side = &contact->gaps.side[s];
    side->nothing = -1.0;
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (ct_point *p = &side->points[run.first]; p < &side->points[run.end]; p++) {
        p->other = -1;
        p->status = CT_POINT_NEW;
        p->xi[0] = p->xi[1] = p->row.force = p->force_size = 0.0;
        p->admitted = 0.0;
        p->row.impact = (ct_impact){.reserve = 0.0};
        p->known = NAN;
      }
  }
}

/* No point has touched anything, the nodes are at the reference shape, and start gaps are those of
 * this shape (eq:initial-adjust). */
static ct_status begin(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  const ct_contact_fixed *fixed = contact->fixed;
  contact->record = (ct_contact_record){.begun = 0.0};
  contact->changed = 1;
  forget(contact);
  if (!ct_start_gap_counts(&fixed->start_rule)) return CT_OK;
  for (int s = 0; s < ct_gaps_surfaces(&fixed->gaps); s++)
    memcpy(contact->gaps.side[s].moved, contact->gaps.side[s].search->x,
           3 * (size_t)contact->gaps.side[s].search->node_count * sizeof(double));
  ct_surface_motion start = *now;
  start.x = NULL;
  ct_status status = fixed->partner->measure(contact, &start, error);
  if (status == CT_OK)
    ct_start_gap_begin(&fixed->start_rule, contact->gaps.side, fixed->gaps.sides);
  forget(contact);
  return status;
}

/* Refuse an overlap at the start if that is asked for. */
static ct_status refuse(const ct_contact *contact, ct_error *error)
{
  const ct_start_rule *rule = &contact->fixed->start_rule;
  ct_penetration found;
  if (rule->initial_penetration != CT_INITIAL_REFUSE) return CT_OK;
  ct_status status = ct_contact_penetration(contact, CT_AT_POINTS, &found, error);
  return status == CT_OK ? ct_start_gap_refuse(rule, &found, contact->fixed->partner->label,
                                               ct_gaps_surfaces(contact->gaps.fixed), error)
                         : status;
}

/* The coordinates of the nodes of side `s`, from those of the interaction at their places. */
CT_CLONES_NODES
static void take_places(ct_contact *contact, int s, const double *x)
{
  const ct_gaps_fixed *fixed = contact->gaps.fixed;
  // Nodes with consecutive places are read together.
  for (int32_t n = 0, row; n < fixed->side[s].search->node_count; n += row) {
    const double *from = &x[3 * (int64_t)ct_gaps_node(fixed, s, n)];
    double *restrict to = &contact->gaps.side[s].moved[3 * (int64_t)n];
    row = ct_gaps_row(fixed, s, n);
#pragma omp simd
    for (int64_t d = 0; d < 3 * (int64_t)row; d++) to[d] = from[d];
  }
}

ct_status ct_contact_find_gaps(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  const ct_contact_fixed *fixed = contact->fixed;
  const ct_start_rule *rule = &fixed->start_rule;
  ct_side *sides = contact->gaps.side;
  const int count = fixed->gaps.sides;
  for (int s = 0; s < ct_gaps_surfaces(&fixed->gaps); s++) take_places(contact, s, now->x);
  for (int s = 0; s < count; s++)
    sides[s].nothing =
        ct_start_gap_counts(rule) && !sides[s].shifted ? ct_side_unsure(&sides[s]) : -1.0;
  ct_status status = fixed->partner->measure(contact, now, error);
  if (status == CT_OK && now->before > 0.0 && !now->first)
    status = fixed->partner->check(contact, now, error);
  if (status != CT_OK) return status;
  if (ct_start_gap_counts(rule)) ct_start_gap_shift(rule, sides, count, now, contact->record.time);
  if (fixed->admits) ct_admission_shift(sides, count, ct_start_gap_counts(rule));
  if (fixed->admits && !now->first && now->before > 0.0) ct_admission_limit(contact);
  return now->first ? refuse(contact, error) : CT_OK;
}

/* After a step that was divided, obstacles and start gaps have moved for longer than the step
 * before counts now. */
static void find_part(ct_contact *contact, const ct_surface_motion *now)
{
  const double since = now->time - contact->record.time;
  const int divided = !now->first && now->before > 0.0 && since > 1.5 * now->before;
  contact->part = divided ? now->before / since : 1.0;
}

void ct_contact_direct(ct_contact *contact)
{
  const ct_side *side = contact->gaps.side;
  for (ct_span run = {0}; contact->axis != NULL && ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++)
      for (int c = 0; c < 3; c++)
        side->points[i].outward[c] = side->points[i].row.normal[c] = contact->axis[c];
}

void ct_contact_fill(ct_contact *contact)
{
  if (contact->filled) return;
  for (int s = 0; s < ct_gaps_surfaces(contact->gaps.fixed); s++)
    ct_side_fill(&contact->gaps.side[s], &contact->fixed->law);
  ct_contact_direct(contact);
  contact->filled = 1;
}

/* Nodes move from their places in the last step, in the first one from the reference shape, to the
 * current coordinates (eq:gap-bound). */
static ct_status place(void *state, const ct_surface_motion *now, ct_error *error)
{
  ct_contact *contact = state;
  ct_surface_motion at = *now;
  at.first = !ct_contact_memory_begun(contact->fixed, now->memory);
  ct_status status = CT_OK;
  ct_contact_fill(contact);
  if (at.first) status = begin(contact, &at, error);
  else if (!now->continued || contact->fixed->is.explicit)
    status = ct_contact_load(contact, now->memory, error);
  find_part(contact, &at);
  return status == CT_OK ? ct_contact_find_gaps(contact, &at, error) : status;
}

static int64_t list_rows(void *state, const ct_surface_motion *now, ct_constraint **rows)
{
  return ct_contact_list_rows(state, now->dt, rows);
}

/* Sum of the forces of all surfaces on each node. */
CT_CLONES_NODES
static void add_sides(const ct_contact *contact, double *force)
{
  const ct_gaps_fixed *fixed = contact->gaps.fixed;
  ct_clear(force, 3 * (size_t)contact->fixed->is.node_count);
  for (int s = 0; s < ct_gaps_surfaces(fixed); s++) {
    const ct_side *side = &contact->gaps.side[s];
    // Nodes with consecutive places are read together.
    for (int32_t n = 0, row; n < side->search->node_count; n += row) {
      const double *coarse = &side->force[3 * (int64_t)n],
                   *fine = &side->force_fine[3 * (int64_t)n];
      double *restrict to = &force[3 * (int64_t)ct_gaps_node(fixed, s, n)];
      row = ct_gaps_row(fixed, s, n);
#pragma omp simd
      for (int64_t d = 0; d < 3 * (int64_t)row; d++) to[d] += coarse[d] + fine[d];
    }
  }
}

/* The work of an obstacle's motion since the last step, with its reaction (eq:obstacle-work). */
static void count_motion(ct_contact *contact)
{
  ct_contact_record *record = &contact->record;
  ct_contact_react(contact);
  for (int c = 0; c < 3; c++) {
    // -- Minus the mean force on the obstacle times its motion (eq:obstacle-work)
    record->motion -=
        0.5 * (contact->part * contact->reaction[c] + record->reaction[c]) * contact->came[c];
    record->reaction[c] = contact->reaction[c];
  }
}

/* Whether a step needs the forces of single points of solved rows. */
static int needs_forces(const ct_contact *contact)
{
  return ct_start_gap_fades(&contact->fixed->start_rule) ||
         (contact->fixed->moves && contact->axis == NULL);
}

/* Forces of the points of all sides; returns the size of the largest component. */
static double take_forces(ct_contact *contact)
{
  double top = 0.0;
  for (int s = 0; s < contact->gaps.fixed->sides; s++) {
    ct_side *side = &contact->gaps.side[s];
    top = fmax(top, contact->solved ? ct_side_take_rows(side) : ct_side_apply_penalty(side));
  }
  return top;
}

static ct_status find_forces(void *state, const ct_surface_motion *now, double *force,
                             ct_error *error)
{
  ct_contact *contact = state;
  const ct_contact_fixed *fixed = contact->fixed;
  ct_contact_record *record = &contact->record;
  ct_side *sides = contact->gaps.side;
  const int count = fixed->gaps.sides, first = !ct_contact_memory_begun(fixed, now->memory);
  const int solved = contact->solved = !fixed->is.explicit;
  ct_largest_row largest = {0.0, 0.0};
  // Solved points are stored at once, and again if something changes.
  if (solved) largest = ct_contact_store_points(contact, now->next_memory);
  const double top = solved && !needs_forces(contact) ? largest.force : take_forces(contact);
  const int paid = solved && ct_contact_pay_debts(contact, largest.debt);
  contact->changed = paid;
  if (fixed->admits) ct_admission_count(contact, first || now->before == 0.0);
  if (ct_start_gap_fades(&fixed->start_rule))
    record->removal += ct_start_gap_work(&fixed->start_rule, sides, count, now->time,
                                         first ? now->time : record->time, contact->terms);
  record->begun = 1.0;
  record->time = now->time;
  contact->memory = now->memory;
  contact->complete = 0;
  ct_status status = ct_contact_collect(contact, top, error);
  if (status != CT_OK) return status;
  if (ct_contact_is_rigid(fixed) && (fixed->moves || !solved)) count_motion(contact);
  add_sides(contact, force);
  ct_contact_push_carrier(contact, force, contact->terms);
  if (!solved || paid || ct_start_gap_fades(&fixed->start_rule))
    ct_contact_store_points(contact, now->next_memory);
  ct_contact_store(contact, now->next_memory);
  return CT_OK;
}

double ct_contact_own_energy(const ct_contact *contact)
{
  return contact->solved ? contact->energy
                         : ct_side_potential(contact->gaps.side, contact->gaps.fixed->sides);
}

static void divide(const void *state, double part, double *memory)
{
  ct_contact_divide(state, part, memory);
}

static void find_energy(void *state, ct_interaction_energy *energy)
{
  ct_contact *contact = state;
  ct_contact_complete(contact);
  *energy = (ct_interaction_energy){.stored = ct_contact_own_energy(contact),
                                    .reserve = contact->reserve,
                                    .removal = contact->record.removal,
                                    .motion = contact->record.motion};
  memcpy(energy->reaction, contact->reaction, sizeof energy->reaction);
}

static ct_status find_springs(const void *state, ct_masses mass, double *omega2)
{
  const ct_contact *contact = state;
  return contact->fixed->partner->find_springs(contact, mass, omega2);
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
                                               .divide = divide,
                                               .find_springs = find_springs};
