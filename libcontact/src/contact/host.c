/* The contact of a host with its own time loop. */
#include "host.h"

#include "../base/error.h"

#include <math.h>

ct_status ct_contact_create(const ct_surface *a, const ct_surface *b,
                            const ct_contact_options *options, ct_contact **out, ct_error *error)
{
  ct_contact_fixed *fixed = NULL;
  if (a == NULL || options == NULL || out == NULL)
    return CT_REFUSE(error, "contact: null argument");
  const ct_surface *const surface[2] = {a, b == NULL ? a : b};
  ct_status status =
      ct_contact_fixed_create(surface, surface[1] == a ? 1 : 2, options, &fixed, error);
  if (status != CT_OK) return status;
  fixed->alone = b == NULL;
  status = ct_contact_open(fixed, out, error);
  if (status == CT_OK) (*out)->own = fixed;
  else ct_contact_fixed_free(fixed);
  return status;
}

/* The coordinates to which nodes move. */
static void take_coordinates(ct_contact *contact, const double *const x[2])
{
  for (int s = 0; s < contact->fixed->sides; s++) {
    const ct_search *search = contact->side[s].search;
    for (int32_t n = 0; n < search->node_count; n++)
      memcpy(&contact->side[s].moved[3 * (int64_t)n], &x[s][3 * (int64_t)search->nodes[n]],
             3 * sizeof(double));
  }
}

ct_status ct_contact_update(ct_contact *contact, const double *xa, const double *xb,
                            ct_error *error)
{
  if (contact == NULL || xa == NULL || (xb == NULL && contact->fixed->sides == 2))
    return CT_REFUSE(error, "contact: null argument");
  const int sides = contact->fixed->sides;
  take_coordinates(contact, (const double *const[2]){xa, xb});
  ct_status status = ct_contact_measure(contact, error);
  if (status != CT_OK) return status;
  contact->solved = 0;
  if (contact->host != NULL) contact->host->current = 0;
  for (int s = 0; s < sides; s++) ct_side_apply_penalty(&contact->side[s]);
  return ct_side_collect(contact->side, sides, 0, error);
}

/* Free the memory of the first step. */
static void close_host(ct_host *h)
{
  for (ct_host_part *part = h->parts; part != NULL; part = part->next) {
    if (part->scratch != NULL) part->effect->free_scratch(part->scratch);
    part->scratch = NULL;
  }
  ct_pool_free(h->solver);
  h->solver = NULL;
  ct_pool_empty(&h->pool);
  h->open = 0;
}

void ct_host_free(ct_host *h)
{
  if (h == NULL) return;
  close_host(h);
  for (ct_host_part *part = h->parts, *next; part != NULL; part = next) {
    next = part->next;
    ct_effect_free(part->effect);
    ct_release(part);
  }
  ct_release(h);
}

ct_host *ct_host_of(ct_contact *contact)
{
  if (contact->host == NULL) contact->host = ct_allocate(1, sizeof *contact->host);
  return contact->host;
}

/* Whether an obstacle's forces need the solver. */
static int has_rows(const ct_host_part *part) { return part->effect->phase == CT_PHASE_CONSTRAINT; }

/* The solver of all rows together: those of the contact and of each obstacle with rows. */
static ct_status open_solver(const ct_contact_fixed *fixed, ct_host *h)
{
  int64_t most = fixed->alone || ct_contact_is_penalty(fixed) ? 0 : fixed->point_count, all = most;
  int32_t count = 1;
  for (const ct_host_part *part = h->parts; part != NULL; part = part->next)
    if (has_rows(part)) count++, all += part->effect->constraint_count;
  ct_row_set *sets = ct_allocate((size_t)count, sizeof *sets);
  int32_t *number = ct_allocate((size_t)fixed->node_count, sizeof *number);
  ct_status status = sets != NULL && number != NULL ? CT_OK : CT_ERROR_MEMORY;
  if (status == CT_OK && all > 0) {
    int32_t next = 0;
    sets[next++] = (ct_row_set){most, fixed->node_count, NULL, ct_contact_row_nodes(fixed)};
    for (const ct_host_part *part = h->parts; part != NULL; part = part->next)
      if (has_rows(part))
        sets[next++] = (ct_row_set){part->effect->constraint_count, part->effect->node_count,
                                    fixed->place[part->side], part->effect->constraint_nodes};
    status = ct_solver_create(sets, count, fixed->node_count, number, &h->solver);
  }
  ct_release(sets);
  ct_release(number);
  return status;
}

/* Scratch space, forces and memory of all parts; their memory begins behind that of the contact. */
static ct_status open_parts(const ct_contact_fixed *fixed, ct_host *h, ct_error *error)
{
  ct_status status = CT_OK;
  h->memory_count = CT_HOST_RECORD + ct_contact_fixed_memory(fixed);
  for (ct_host_part *part = h->parts; status == CT_OK && part != NULL; part = part->next) {
    part->memory = h->memory_count;
    h->memory_count += ct_host_part_memory(part);
    part->force = ct_pool_take(&h->pool, (size_t)part->effect->node_count, 3 * sizeof(double));
    status = part->effect->create_scratch(part->effect, &part->scratch, error);
  }
  return status;
}

/* Allocate for the steps of a contact. */
static ct_status open_host(ct_contact *contact, ct_error *error)
{
  const ct_contact_fixed *fixed = contact->fixed;
  const size_t nodes = (size_t)fixed->node_count;
  ct_host *h = ct_host_of(contact);
  if (h == NULL) return CT_NO_MEMORY(error, "the steps of a contact");
  if (h->open) return CT_OK;
  ct_status status = open_parts(fixed, h, error);
  double **arrays[] = {&h->force, &h->terms, &h->velocity[0], &h->velocity[1], &h->rest};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    if (i < 2 || h->parts != NULL) *arrays[i] = ct_pool_take(&h->pool, nodes, 3 * sizeof(double));
  h->memory = ct_pool_take(&h->pool, (size_t)h->memory_count, sizeof *h->memory);
  h->next_memory = ct_pool_take(&h->pool, (size_t)h->memory_count, sizeof *h->memory);
  if (h->pool.failed) status = CT_ERROR_MEMORY;
  if (status == CT_OK) status = open_solver(fixed, h);
  if (status != CT_OK) {
    close_host(h);
    return CT_NO_MEMORY(error, "the steps of a contact");
  }
  h->open = 1;
  return CT_OK;
}

/* A host's data of one surface. */
typedef struct side_prediction {
  const double *x, *velocity, *force, *inverse_mass, *increment;
} side_prediction;

/* Displacement increment of a component in the next step without the contact. */
static double increment_of(const ct_contact_prediction *p, const side_prediction *side, int64_t dof)
{
  if (side->increment != NULL) return side->increment[dof];
  double force = side->force == NULL ? 0.0 : side->force[dof];
  // -- Δt v_{n+1/2} = Δt (v_{n-1/2} + τ f / m) (eq:host-step)
  return p->dt * (side->velocity[dof] + p->kick * side->inverse_mass[dof] * force);
}

/* The surface of node `n` of a contact in the host's arrays, and the index of its components. */
static const side_prediction *find_node(const ct_contact_fixed *fixed,
                                        const side_prediction side[2], int32_t n, int64_t *dof)
{
  int32_t node = fixed->nodes[n], first = fixed->side[0].search->host_count,
          second = !fixed->one_array && node >= first;
  *dof = 3 * (int64_t)(second ? node - first : node);
  return &side[second];
}

/* Values of the nodes for the solver (eq:constraint-problem), from the leapfrog (eq:host-step). */
static void predict(const ct_contact_fixed *fixed, const ct_contact_prediction *p,
                    const side_prediction side[2], double before, ct_solver *solver)
{
  solver->share = p->kick / p->dt;
  for (int32_t n = 0; n < fixed->node_count; n++) {
    int64_t dof, own = CT_SOLVER_WIDE * (int64_t)n;
    const side_prediction *from = find_node(fixed, side, n, &dof);
    for (int c = 0; c < 3; c++, dof++, own++) {
      // -- Motion without the contact, that of a unit force, and the last one (eq:host-step)
      solver->increment[own] = increment_of(p, from, dof);
      solver->mobility[own] = p->dt * p->kick * from->inverse_mass[dof];
      solver->last_increment[own] = before * from->velocity[dof];
    }
  }
}

/* List the rows of the contact and of all obstacles. */
static ct_status list_rows(ct_contact *contact, const ct_contact_prediction *p, ct_error *error)
{
  const ct_host *h = contact->host;
  ct_solver *solver = h->solver;
  const int none = contact->fixed->alone || ct_contact_is_penalty(contact->fixed);
  int32_t set = 1;
  solver->first[set] = none ? 0 : ct_contact_list_rows(contact, solver->rows);
  for (const ct_host_part *part = h->parts; part != NULL; part = part->next) {
    int64_t count = 0;
    if (!has_rows(part)) continue;
    const ct_view view = ct_host_view(contact, part, p);
    ct_status status = part->effect->constraints->list(
        part->effect, &view, solver->rows + solver->first[set], &count, error);
    if (status != CT_OK) return status;
    solver->first[set + 1] = solver->first[set] + count;
    set++;
  }
  return CT_OK;
}

/* Solve for the forces of all points together. */
static ct_status solve(ct_contact *contact, const ct_contact_prediction *p,
                       const side_prediction side[2], const ct_moment *now, ct_error *error)
{
  ct_host *h = contact->host;
  ct_solver *solver = h->solver;
  if (solver == NULL) return CT_OK;
  ct_status status = list_rows(contact, p, error);
  if (status != CT_OK || solver->first[solver->set_count] == 0) return status;
  // -- Before t = 0 there was no step: g_{-1} = g_0 (eq:energy-start)
  double before = !now->first ? now->before : p->kick < p->dt ? 0.0 : p->dt;
  predict(contact->fixed, p, side, before, solver);
  if (!ct_solver_solve(solver))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                   "the contact forces stopped being finite at t = %g", now->time);
  h->now.unconverged += !solver->converged;
  return CT_OK;
}

/* Sum of all forces on the contact's nodes. */
static void add_forces(const ct_contact *contact, double *force)
{
  const ct_contact_fixed *fixed = contact->fixed;
  memset(force, 0, 3 * (size_t)fixed->node_count * sizeof *force);
  for (int s = 0; s < fixed->sides; s++)
    for (int32_t n = 0; n < contact->side[s].search->node_count; n++)
      for (int c = 0; c < 3; c++)
        force[3 * (int64_t)fixed->place[s][n] + c] += ct_side_force(&contact->side[s], n, c);
  for (const ct_host_part *part = contact->host->parts; part != NULL; part = part->next)
    for (int32_t n = 0; n < part->effect->node_count; n++) {
      int32_t node = part->side < 0 ? n : fixed->place[part->side][n];
      for (int c = 0; c < 3; c++) force[3 * (int64_t)node + c] += part->force[3 * (int64_t)n + c];
    }
}

/* Add the work of the forces over the whole kick, whose first part ends at t_n (eq:host-work). */
static void count_work(ct_contact *contact, const ct_contact_prediction *p,
                       const side_prediction side[2])
{
  const ct_contact_fixed *fixed = contact->fixed;
  ct_host *h = contact->host;
  double part[2];
  add_forces(contact, h->force);
  // -- The work of both parts of the kick
  for (int k = 0; k < 2; k++) {
    for (int32_t n = 0; n < fixed->node_count; n++) {
      int64_t dof, own = 3 * (int64_t)n;
      const side_prediction *from = find_node(fixed, side, n, &dof);
      for (int c = 0; c < 3; c++, dof++, own++) {
        double after =
            increment_of(p, from, dof) / p->dt + p->kick * from->inverse_mass[dof] * h->force[own];
        // Half of the kick times the velocity before it, or after it (eq:host-work)
        h->terms[own] = 0.5 * p->kick * h->force[own] * (k == 0 ? from->velocity[dof] : after);
      }
    }
    part[k] = ct_sum(h->terms, 3 * (int64_t)fixed->node_count);
  }
  // -- A whole kick began before t_0
  const int begun = h->now.begun != 0.0;
  if (!begun && !(p->kick < p->dt)) h->now.done = -part[0];
  h->now.work = begun ? h->now.done + part[0] : 0.0;
  h->now.done += part[0] + part[1];
}

/* Gaps at a time. A scene computes them twice at t = 0, and the iterations of the second call begin
 * at the closest points of the first; we do the same for equal bits. */
static ct_status find_gaps(ct_contact *contact, const side_prediction side[2], ct_moment now,
                           ct_error *error)
{
  const double *const x[2] = {side[0].x, side[1].x};
  ct_status status = CT_OK;
  if (now.first) {
    status = ct_contact_begin(contact, &now, error);
    take_coordinates(contact, x);
    if (status == CT_OK) status = ct_contact_find_gaps(contact, &now, error);
    now.first = 0;
  } else status = ct_contact_load(contact, contact->host->memory + CT_HOST_RECORD, error);
  if (status != CT_OK) return status;
  take_coordinates(contact, x);
  return ct_contact_find_gaps(contact, &now, error);
}

/* Velocities at the nodes of each surface, for its obstacles. */
static void take_velocities(const ct_contact *contact, const side_prediction side[2])
{
  const ct_host *h = contact->host;
  for (int s = 0; h->parts != NULL && s < contact->fixed->sides; s++) {
    const ct_search *search = contact->side[s].search;
    for (int32_t n = 0; n < search->node_count; n++)
      memcpy(&h->velocity[s][3 * (int64_t)n], &side[s].velocity[3 * (int64_t)search->nodes[n]],
             3 * sizeof(double));
  }
}

/* The next step begins with the memory of this one. */
static void end_step(ct_contact *contact, const ct_contact_prediction *p)
{
  ct_host *h = contact->host;
  double *memory = h->memory;
  // t_n = n Δt as in a scene, while all steps have one length
  if (p->dt != h->now.before) h->now.since = h->now.time, h->now.count = 0.0;
  h->now.begun = 1.0;
  h->now.before = p->dt;
  h->now.count += 1.0;
  h->now.time = h->now.since + h->now.count * p->dt;
  ct_host_sum_parts(h);
  ct_contact_store(contact, h->next_memory + CT_HOST_RECORD);
  memcpy(h->next_memory, &h->now, sizeof h->now);
  h->memory = h->next_memory;
  h->next_memory = memory;
  contact->begun = h->current = 1;
}

static ct_status take_step(ct_contact *contact, const ct_contact_prediction *p,
                           const side_prediction side[2], ct_error *error)
{
  ct_host *h = contact->host;
  memcpy(&h->now, h->memory, sizeof h->now);
  const ct_moment now = {.time = h->now.time,
                         .before = h->now.before,
                         .dt = p->dt,
                         .velocity = {side[0].velocity, side[1].velocity},
                         .first = h->now.begun == 0.0};
  take_velocities(contact, side);
  ct_status status = find_gaps(contact, side, now, error);
  if (status == CT_OK) h->current = 0;
  if (status == CT_OK) status = solve(contact, p, side, &now, error);
  if (status == CT_OK) status = ct_contact_find_forces(contact, &now, error);
  if (status == CT_OK) status = ct_host_find_forces(contact, p, error);
  if (status != CT_OK) return status;
  count_work(contact, p, side);
  end_step(contact, p);
  return CT_OK;
}

/* Refuse values at a node of a surface that are not finite, and a negative inverse mass. */
static ct_status check_side(const ct_contact *contact, int s, const side_prediction *p,
                            ct_error *error)
{
  const ct_search *search = contact->fixed->side[s].search;
  const double *vectors[] = {p->velocity, p->inverse_mass, p->increment,
                             p->increment == NULL ? p->force : NULL};
  for (int32_t n = 0; n < search->node_count; n++)
    for (int64_t d = 3 * (int64_t)search->nodes[n], c = 0; c < 3; c++) {
      int fine = p->inverse_mass[d + c] >= 0.0;
      for (int v = 0; v < 4; v++)
        fine = fine && (vectors[v] == NULL || isfinite(vectors[v][d + c]));
      if (!fine)
        return ct_fail(error, CT_INVALID, (ct_place){s, -1, search->nodes[n]},
                       "contact: node %d of surface %d has a prediction that is not finite, or a "
                       "negative inverse mass",
                       (int)search->nodes[n], s);
    }
  return CT_OK;
}

/* The record of the last good step. */
static ct_host_record record_of(const ct_host *h)
{
  ct_host_record record;
  memcpy(&record, h->memory, sizeof record);
  return record;
}

/* Refuse times that are impossible for a leapfrog: a kick is the mean of the last step and the next
 * one, or the next one; in the first step it may be shorter. Other integrators pass increments. */
static ct_status check_times(const ct_contact *contact, const ct_contact_prediction *p,
                             ct_error *error)
{
  static const double SLACK = 1e-6;
  const ct_host_record last = record_of(contact->host);
  double mean = last.begun != 0.0 ? 0.5 * (last.before + p->dt) : p->dt,
         least = last.begun != 0.0 ? fmin(mean, p->dt) : 0.0, most = fmax(mean, p->dt);
  if (!(p->dt > 0.0 && isfinite(p->dt) && p->kick > 0.0 && isfinite(p->kick)))
    return CT_REFUSE(error, "contact: a step of %g in which forces act for %g", p->dt, p->kick);
  if (p->increment_a != NULL ||
      (p->kick >= (1.0 - SLACK) * least && p->kick <= (1.0 + SLACK) * most))
    return CT_OK;
  return CT_REFUSE(error,
                   "contact: in a step of %g after one of %g forces act for %g, not for %g; give "
                   "the increments if your step is no leapfrog",
                   p->dt, last.before, mean, p->kick);
}

ct_status ct_contact_step(ct_contact *contact, const ct_contact_prediction *p, ct_error *error)
{
  if (contact == NULL || p == NULL) return CT_REFUSE(error, "contact: null argument");
  const side_prediction a = {p->x_a, p->velocity_a, p->force_a, p->inverse_mass_a, p->increment_a},
                        b = {p->x_b, p->velocity_b, p->force_b, p->inverse_mass_b, p->increment_b},
                        side[2] = {a, contact->fixed->sides == 2 ? b : a};
  for (int s = 0; s < contact->fixed->sides; s++)
    if (side[s].x == NULL || side[s].velocity == NULL || side[s].inverse_mass == NULL)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){s, -1, -1},
                     "contact: surface %d lacks coordinates, velocities or inverse masses", s);
  ct_status status = open_host(contact, error);
  if (status == CT_OK) status = check_times(contact, p, error);
  for (int s = 0; status == CT_OK && s < contact->fixed->sides; s++)
    status = check_side(contact, s, &side[s], error);
  return status == CT_OK ? take_step(contact, p, side, error) : status;
}

ct_status ct_contact_balance_of(const ct_contact *contact, ct_contact_balance *out, ct_error *error)
{
  if (contact == NULL || out == NULL) return CT_REFUSE(error, "contact: null argument");
  if (contact->host == NULL || !contact->host->current)
    return CT_REFUSE(error, "contact: the last call was not a successful ct_contact_step");
  const ct_host_record record = record_of(contact->host);
  *out = (ct_contact_balance){.energy = ct_contact_energy(contact),
                              .work = record.work,
                              .removal = contact->work + contact->host->removal,
                              .unconverged = (int64_t)record.unconverged,
                              .friction = contact->host->friction,
                              .motion = contact->host->motion,
                              .late = contact->admission.late,
                              .late_depth = contact->admission.late_depth};
  return CT_OK;
}

int64_t ct_contact_save(const ct_contact *contact, double *memory)
{
  if (contact == NULL) return 0;
  const ct_host *h = contact->host;
  int64_t count = CT_HOST_RECORD + ct_contact_fixed_memory(contact->fixed);
  for (const ct_host_part *part = h == NULL ? NULL : h->parts; part != NULL; part = part->next)
    count += ct_host_part_memory(part);
  if (memory != NULL && h != NULL && h->open)
    memcpy(memory, h->memory, (size_t)count * sizeof *memory);
  else if (memory != NULL) memset(memory, 0, (size_t)count * sizeof *memory);
  return count;
}

/* Whether the numbers before `end` are finite from `*from` on, except that the distance in the
 * records of points between `first` and `last` may be unknown; moves `*from` to `end`. */
static int are_finite(const double *memory, int64_t *from, int64_t first, int64_t last, int64_t end)
{
  const int64_t known = offsetof(ct_point_record, known) / sizeof(double);
  for (; *from < end; ++*from)
    if (!isfinite(memory[*from]) &&
        !(*from >= first && *from < last && (*from - first) % CT_RECORD == known))
      return 0;
  return 1;
}

/* Whether numbers are possible as the memory of a contact. */
static int is_memory(const ct_contact *contact, const double *memory, int64_t count)
{
  const ct_contact_fixed *fixed = contact->fixed;
  ct_host_record record;
  memcpy(&record, memory, sizeof record);
  if (record.begun != 1.0) {
    for (int64_t i = 0; i < count; i++)
      if (memory[i] != 0.0) return 0;
    return 1;
  }
  int64_t at = 0, first = CT_HOST_RECORD, last = first + CT_RECORD * fixed->point_count;
  int finite = are_finite(memory, &at, first, last, first + ct_contact_fixed_memory(fixed));
  for (const ct_host_part *part = contact->host->parts; finite && part != NULL; part = part->next) {
    if (part->effect->kind != CT_EFFECT_OBSTACLE) continue;
    ct_obstacle_records(part->effect, &first, &last);
    finite = are_finite(memory, &at, part->memory + first, part->memory + last,
                        part->memory + part->effect->memory_count);
  }
  return finite && are_finite(memory, &at, count, count, count) && record.before > 0.0 &&
         record.unconverged >= 0.0 && record.unconverged < 9e15 &&
         ct_contact_memory_begun(fixed, memory + CT_HOST_RECORD);
}

ct_status ct_contact_restore(ct_contact *contact, const double *memory, int64_t count,
                             ct_error *error)
{
  if (contact == NULL || memory == NULL) return CT_REFUSE(error, "contact: null argument");
  ct_status status = open_host(contact, error);
  if (status != CT_OK) return status;
  ct_host *h = contact->host;
  if (count != h->memory_count)
    return CT_REFUSE(error, "contact: %lld numbers of another contact; this one remembers %lld",
                     (long long)count, (long long)h->memory_count);
  if (!is_memory(contact, memory, count))
    return ct_fail(error, CT_INVALID, CT_NOWHERE,
                   "contact: these numbers were not written by ct_contact_save");
  memcpy(h->memory, memory, (size_t)count * sizeof *memory);
  h->current = 0;
  return CT_OK;
}
