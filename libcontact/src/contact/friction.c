/* Coulomb friction with stick on the points of a contact or of an obstacle: it adds a tangential
 * law to their rows, and applies the forces that the solver finds. */
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "friction_internal.h"

#include <math.h>
#include <string.h>

/* The sides now, and the tail of the memory. */
static ct_friction_call begin(ct_friction_memory *s, const ct_surface_motion *at)
{
  ct_friction_call now = {.data = s->data, .at = at};
  memcpy(&s->tail, &at->memory[CT_FRICTION_RECORD * s->data->points], sizeof s->tail);
  if (at->before == 0.0) s->tail = (ct_friction_tail){.begun = 0.0};
  for (int k = 0; k < s->data->sides; k++)
    now.side[k] = &((const ct_contact *)at->on)->gaps.side[k];
  // -- At t = 0 forces are solved for twice: the second time from those of the first
  for (int k = 0; k < s->data->sides && at->before != 0.0; k++)
    now.most_face[k] = s->data->rigid ? 1.0 : (double)ct_friction_other(&now, k)->face_count;
  s->pieces = now.side[0]->pieces;
  return now;
}

/* Force on an obstacle, and the work of its motion since the last call (eq:obstacle-work). */
static void count_motion(const ct_friction_call *now, const double *force, ct_friction_memory *s)
{
  const ct_contact *obstacle = now->at->on;
  const int32_t nodes = now->data->is.node_count;
  const int carried = obstacle->fixed->carrier != NULL;
  for (int c = 0; c < 3; c++) {
    const double last = s->tail.reaction[c];
    for (int32_t n = 0; n < nodes; n++) s->terms[n] = -force[3 * (int64_t)n + c];
    s->tail.reaction[c] = ct_sum(s->terms, nodes);
    if (!carried) s->tail.motion -= 0.5 * (s->tail.reaction[c] + last) * obstacle->came[c];
  }
}

/* Fewest points of a thread: a fraction of a millisecond. */
enum { LEAST_POINTS = 1024 };

/* List the points that have rows in this step; the last one also fills the rest of its batch.
 * Returns whether there are others. */
static int list_points(ct_friction_memory *s, const ct_friction_call *now)
{
  ct_friction_point *listed = s->listed;
  int64_t first = 0, count = 0, others = 0;
  for (int k = 0; k < s->data->sides; first += s->data->side[k++]->point_count) {
    for (ct_span run = {0}; ct_side_next(now->side[k], &run);)
      for (int64_t i = run.first; i < run.end; i++) {
        ct_point *point = &now->side[k]->points[i];
        if (point->listed) listed[count++] = (ct_friction_point){point, first + i, k};
        else point->row.slip = NULL, others++;
      }
  }
  s->listed_count = count;
  for (; count > 0 && count % CT_BATCH != 0; count++) listed[count] = listed[count - 1];
  return others > 0;
}

/* Points that are not listed store nothing. */
static void clear_memory(const ct_friction_memory *s, const ct_friction_call *now)
{
  int64_t first = 0;
  for (int k = 0; k < s->data->sides; first += s->data->side[k++]->point_count)
    for (ct_span run = {0}; ct_side_next(now->side[k], &run);)
      for (int64_t i = run.first; i < run.end; i++)
        if (!now->side[k]->points[i].listed)
          ct_clear(&now->at->next_memory[CT_FRICTION_RECORD * (first + i)], CT_FRICTION_RECORD);
}

/* Prepare the listed points for the solver, or afterwards store what it found. */
static void treat(ct_friction_memory *s, const ct_friction_call *now, int solved)
{
#ifdef _OPENMP
  const int threads = ct_threads_for(now->at->threads, s->listed_count, LEAST_POINTS);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (int64_t first = 0; first < s->listed_count; first += CT_BATCH) {
    if (solved) ct_friction_store(now, s, first);
    else ct_friction_prepare(now, s, first);
  }
}

/* The rows of the explicit penalty are listed here, because its contact lists none. */
static int64_t list_rows(void *state, const ct_surface_motion *at, ct_constraint **rows)
{
  ct_friction_memory *s = state;
  const int64_t count = s->data->explicit ? ct_contact_list_rows(at->on, at->dt, rows) : 0;
  const ct_friction_call now = begin(s, at);
  const ct_contact *on = at->on;
  for (int c = 0; c < 3 && s->slips.moves; c++) {
    s->slips.came[c] = on->part * on->came[c];
    s->slips.coming[c] = on->coming[c];
  }
  ct_clear(s->slips.sums, CT_SLIP_SUMS * (size_t)s->slips.node_count);
  if (list_points(s, &now)) clear_memory(s, &now);
  treat(s, &now, 0);
  return count;
}

/* What friction stores and has dissipated at t_n (eq:slip-held, eq:friction-dissipation). */
static void count_energy(ct_friction_memory *s)
{
  ct_friction_tail *tail = &s->tail;
  const int64_t count = s->listed_count;
  ct_slip_stored(&s->slips, count, s->terms);
  const double before = tail->stored, after = ct_sum_over(s->pieces, s->terms, count),
               work = ct_sum_over(s->pieces, ct_friction_numbers(s, CT_SLIP_WORK, 0), count),
               lag = ct_sum_over(s->pieces, ct_friction_numbers(s, CT_SLIP_LAG, 0), count),
               lost = (before - after) - work;
  const int begun = tail->begun != 0.0;
  // -- The mean of the stores of two half steps (eq:slip-held)
  s->held = begun ? 0.5 * (before + after) + lag : 0.0;
  s->dissipated = begun ? tail->lost + 0.5 * lost : 0.0;
  tail->begun = 1.0;
  tail->stored = after;
  // -- S₋ - S₊ - W (eq:friction-dissipation)
  tail->lost += lost;
}

/* The forces at the nodes, of the sums of all pieces. */
CT_CLONES
static void add_sums(int32_t nodes, const double *sums, double *restrict force)
{
  for (int32_t n = 0; n < nodes; n++, sums += CT_SLIP_SUMS)
    for (int c = 0; c < 3; c++) force[3 * (int64_t)n + c] = sums[c] + sums[CT_SLIP_SUMS / 2 + c];
}

static ct_status find_forces(void *state, const ct_surface_motion *at, double *force,
                             ct_error *error)
{
  ct_friction_memory *s = state;
  const ct_friction *data = s->data;
  const ct_friction_call now = begin(s, at);
  treat(s, &now, 1);
  ct_pieces_sum(s->pieces, s->slips.sums, CT_SLIP_SUMS * (int64_t)s->slips.node_count);
  add_sums(s->slips.node_count, s->slips.sums, force);
  // What acts against them on a carrier follows from the forces on the surface, as in a contact.
  const ct_carrier *carrier = ((const ct_contact *)at->on)->fixed->carrier;
  for (int k = 0; carrier != NULL && k < CT_CARRIER_NODES; k++)
    memset(&force[3 * (int64_t)carrier->place[k]], 0, 3 * sizeof *force);
  count_energy(s);
  if (data->rigid) count_motion(&now, force, s);
  ct_contact_push_carrier(at->on, force, s->terms);
  memcpy(&at->next_memory[CT_FRICTION_RECORD * data->points], &s->tail, sizeof s->tail);
  (void)error;
  return CT_OK;
}

static void find_energy(void *state, ct_interaction_energy *energy)
{
  const ct_friction_memory *s = state;
  *energy = (ct_interaction_energy){
      .stored = s->held, .dissipated = s->dissipated, .motion = s->tail.motion};
  memcpy(energy->reaction, s->tail.reaction, sizeof energy->reaction);
}

static ct_status open_state(const ct_interaction *interaction, void **state, ct_error *error)
{
  const ct_friction *data = (const ct_friction *)interaction;
  ct_friction_memory *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_NO_MEMORY(error, "friction");
  const size_t nodes = (size_t)interaction->node_count;
  s->data = data;
  s->has_axes = !data->rigid || ((const ct_contact_fixed *)interaction->on)->carrier != NULL;
  const size_t points = (size_t)data->points, batches = points / CT_BATCH + 1;
  s->points = ct_pool_take(&s->pool, points, sizeof *s->points);
  s->listed = ct_pool_take(&s->pool, CT_BATCH * batches, sizeof *s->listed);
  s->axes = ct_pool_take(&s->pool, batches, sizeof *s->axes);
  s->terms = ct_pool_take(&s->pool, CT_BATCH * batches + nodes, sizeof *s->terms);
  for (size_t j = 0; j < points && !s->pool.failed; j++) s->points[j].of = &s->slips;
  // An odd number of batches apart, numbers of one point do not compete for places in a cache.
  s->slips = (ct_slips){.mu = data->mu,
                        .moves = data->rigid && ((const ct_contact_fixed *)interaction->on)->moves,
                        .node_count = interaction->node_count,
                        .stride = CT_BATCH * (int64_t)(batches | 1)};
  const size_t stride = (size_t)s->slips.stride;
  s->slips.numbers =
      ct_pool_take(&s->pool, stride * (size_t)ct_slip_count(data->other_nodes), sizeof(double));
  s->slips.sums = ct_pool_take(&s->pool, nodes, CT_SLIP_SUMS * sizeof(double));
  if (!s->pool.failed) {
    *state = s;
    return CT_OK;
  }
  ct_pool_free(s);
  return CT_NO_MEMORY(error, "friction");
}

static void free_friction(ct_interaction *interaction) { ct_release(interaction); }

static const ct_interaction_calls CALLS = {.free = free_friction,
                                           .open = open_state,
                                           .close = ct_pool_free,
                                           .list_rows = list_rows,
                                           .find_forces = find_forces,
                                           .find_energy = find_energy};

static ct_status check(double coefficient, double tangent, ct_error *error)
{
  if (!(coefficient > 0.0) || !isfinite(coefficient))
    return CT_REFUSE(error, "friction: the coefficient must be positive, not %g", coefficient);
  if (!(tangent > 0.0) || !isfinite(tangent))
    return CT_REFUSE(
        error,
        "friction: the ratio of the tangential to the normal penalty must be positive, not %g",
        tangent);
  return CT_OK;
}

/* Friction as an interaction. Flops and bytes were counted on two plane surfaces and on a plane. */
static ct_interaction describe(const ct_friction *data, const ct_interaction *on)
{
  double bytes = 2.0 * sizeof(double) * ct_slip_count(data->other_nodes) + sizeof(ct_point) +
                 2.0 * sizeof(ct_slip_record),
         points = (double)data->points;
  const int64_t rows = ((const ct_contact_fixed *)on)->gaps.point_count; // also of stations
  return (ct_interaction){.calls = &CALLS,
                          .nodes = on->nodes,
                          .node_count = on->node_count,
                          .on = on,
                          .row_count = data->explicit ? rows : 0,
                          .row_nodes = on->row_nodes,
                          .slip_count = rows,
                          .memory_count = CT_FRICTION_RECORD * data->points + CT_FRICTION_TAIL,
                          .point_memory = CT_FRICTION_RECORD,
                          .flops = (data->rigid ? 225.0 : 750.0) * points,
                          .bytes = bytes * points + 250.0 * on->node_count};
}

ct_status ct_friction_create(double coefficient, double tangent, const ct_interaction *on,
                             ct_interaction **out, ct_error *error)
{
  ct_status status = check(coefficient, tangent, error);
  if (status != CT_OK) return status;
  ct_friction *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return CT_NO_MEMORY(error, "friction");
  data->mu = coefficient;
  data->rho = tangent;
  const ct_contact_fixed *fixed = (const ct_contact_fixed *)on;
  data->rigid = ct_contact_is_rigid(fixed);
  data->explicit = on->explicit;
  data->sides = ct_gaps_surfaces(&fixed->gaps);
  data->quads = !data->rigid;
  for (int k = 0; k < data->sides; k++) {
    data->side[k] = &fixed->gaps.side[k];
    data->points += data->side[k]->point_count;
    data->quads &= data->side[k]->search->kind == CT_Q4;
  }
  data->other_nodes = data->rigid && fixed->carrier == NULL ? 0 : data->quads ? 4 : 8;
  data->is = describe(data, on);
  *out = &data->is;
  return CT_OK;
}
