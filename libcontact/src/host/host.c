/* The contact of a host with its own time loop: the host's arrays as the motion of its surfaces,
 * and the steps of all interactions together. */
#include "host.h"

#include "../base/error.h"
#include "../constraint/law.h"
#include "../constraint/problem.h"

#include <math.h>
#include <string.h>

ct_status ct_contact_create(const ct_surface *a, const ct_surface *b,
                            const ct_contact_options *options, ct_contact **out, ct_error *error)
{
  ct_contact_fixed *fixed = NULL;
  if (a == NULL || options == NULL || out == NULL) return CT_REFUSE_NULL(error);
  const ct_surface *const surface[2] = {a, b == NULL ? a : b};
  ct_status status =
      ct_contact_fixed_create(surface, surface[1] == a ? 1 : 2, options, &fixed, error);
  if (status != CT_OK) return status;
  fixed->gaps.alone = b == NULL;
  if (fixed->gaps.alone) fixed->is.row_count = 0;
  status = ct_contact_open(fixed, out, error);
  if (status == CT_OK) {
    (*out)->own = fixed;
    ct_contact_fill(*out);
  } else ct_contact_fixed_free(fixed);
  return status;
}

ct_status ct_contact_update(ct_contact *contact, const double *xa, const double *xb,
                            ct_error *error)
{
  if (contact == NULL || xa == NULL || (xb == NULL && contact->fixed->gaps.sides == 2))
    return CT_REFUSE_NULL(error);
  const int sides = contact->fixed->gaps.sides;
  const double *const x[2] = {xa, xb};
  for (int s = 0; s < sides; s++) {
    const ct_search *search = contact->gaps.side[s].search;
    for (int32_t n = 0; n < search->node_count; n++)
      memcpy(&contact->gaps.side[s].moved[3 * (int64_t)n], &x[s][3 * (int64_t)search->nodes[n]],
             3 * sizeof(double));
  }
  ct_status status = ct_gaps_measure(&contact->gaps, contact->fixed->threads, error);
  if (status != CT_OK) return status;
  contact->solved = 0;
  if (contact->host != NULL) contact->host->current = 0;
  double top = 0.0;
  for (int s = 0; s < sides; s++) top = fmax(top, ct_side_apply_penalty(&contact->gaps.side[s]));
  return ct_contact_collect(contact, top, error);
}

/* Copy `width` numbers per node from the host's arrays, where there are any, to the contact's
 * numbering. */
static void gather(const ct_contact *contact, const double *const from[2], int width, double *to)
{
  for (int32_t n = 0; n < contact->fixed->is.node_count; n++) {
    int side;
    const int64_t node = ct_host_node(contact, n, &side);
    if (from[side] != NULL)
      memcpy(&to[width * (int64_t)n], &from[side][width * node], (size_t)width * sizeof *to);
  }
}

/* Free the memory of the first step. */
static void close_host(ct_host *h)
{
  ct_pool_free(h->solver);
  h->solver = NULL;
  ct_pool_empty(&h->pool);
  h->open = 0;
}

void ct_contact_free(ct_contact *contact)
{
  if (contact == NULL) return;
  ct_host *h = contact->host;
  if (h != NULL) close_host(h);
  for (ct_host_part *part = h == NULL ? NULL : h->contact.next, *next; part != NULL; part = next) {
    next = part->next;
    part->is->calls->close(part->state);
    part->is->calls->free(part->is);
    ct_release(part);
  }
  for (int s = 0; h != NULL && s < 2; s++) ct_release(h->owned[s]);
  ct_release(h);
  ct_contact_fixed *fixed = contact->own;
  ct_contact_close(contact);
  ct_contact_fixed_free(fixed);
}

/* Whether a part has a set of rows, or adds to those of another; that of the contact holds all
 * nodes, also without rows. */
static int has_set(const ct_host *h, const ct_host_part *part)
{
  return part == &h->contact || part->is->row_count > 0 || part->on != NULL;
}

/* The solver of the rows of all parts together. */
static ct_status open_solver(const ct_contact_fixed *fixed, ct_host *h)
{
  int64_t all = 0;
  int32_t count = 0;
  for (const ct_host_part *part = &h->contact; part != NULL; part = part->next)
    all += part->is->row_count, count += has_set(h, part);
  if (all == 0) return CT_OK;
  ct_row_set *sets = ct_allocate((size_t)count, sizeof *sets);
  int32_t *number = ct_allocate((size_t)fixed->is.node_count, sizeof *number), next = 0;
  h->lists = ct_pool_take(&h->pool, (size_t)count, sizeof *h->lists);
  ct_status status = sets != NULL && number != NULL && h->lists != NULL ? CT_OK : CT_ERROR_MEMORY;
  for (const ct_host_part *part = &h->contact; status == CT_OK && part != NULL; part = part->next) {
    if (!has_set(h, part)) continue;
    h->lists[next] = part;
    sets[next++] = (ct_row_set){part->is->row_count, part->is->node_count, part->nodes,
                                part->is->row_nodes, part->is->slip_count, 0};
  }
  if (status == CT_OK)
    status = ct_solver_create(sets, count, fixed->is.node_count, number, &h->solver);
  if (status == CT_OK) {
    h->solver->pieces = h->pieces;
    h->solver->tolerance = ct_solver_tolerance(fixed->force_tolerance);
  }
  ct_release(sets);
  ct_release(number);
  return status;
}

/* Arrays and memory of all parts. */
static void open_parts(ct_host *h)
{
  h->memory_count = CT_HOST_RECORD;
  for (ct_host_part *part = &h->contact; part != NULL; part = part->next) {
    double **arrays[] = {&part->force, &part->x, &part->velocity};
    part->memory = h->memory_count;
    h->memory_count += part->is->memory_count;
    for (int i = 0; i < (part->on != NULL ? 1 : 3); i++)
      *arrays[i] = ct_pool_take(&h->pool, (size_t)part->is->node_count, 3 * sizeof(double));
    if (part != &h->contact && part->on == NULL)
      h->pool.failed |= ct_host_cut(h, part->surface, part->state, NULL) != CT_OK;
  }
}

ct_status ct_host_open(ct_contact *contact, ct_error *error)
{
  const ct_contact_fixed *fixed = contact->fixed;
  ct_host *h = ct_host_of(contact);
  if (h == NULL) return CT_NO_MEMORY(error, "the steps of a contact");
  if (h->open) return CT_OK;
  double **arrays[] = {&h->inverse_mass, &h->others, &h->increment, &h->force, &h->terms};
  open_parts(h);
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    *arrays[i] = ct_pool_take(&h->pool, (size_t)fixed->is.node_count, 3 * sizeof(double));
  h->memory = ct_pool_take(&h->pool, (size_t)h->memory_count, sizeof *h->memory);
  h->next_memory = ct_pool_take(&h->pool, (size_t)h->memory_count, sizeof *h->memory);
  if (h->pool.failed || open_solver(fixed, h) != CT_OK) {
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

/* The data of both surfaces in the contact's numbering, from which the step predicts the motion. */
static ct_prediction prepare(ct_contact *contact, const ct_contact_prediction *p,
                             const side_prediction side[2])
{
  const ct_contact_fixed *fixed = contact->fixed;
  ct_host *h = contact->host;
  const double *given[5][2];
  for (int s = 0; s < 2; s++) {
    given[0][s] = side[s].x, given[1][s] = side[s].velocity, given[2][s] = side[s].inverse_mass;
    given[3][s] = side[s].increment;
    given[4][s] = side[s].increment == NULL ? side[s].force : NULL;
  }
  const int64_t count = 3 * (int64_t)fixed->is.node_count;
  memset(h->others, 0, (size_t)count * sizeof *h->others);
  gather(contact, given[0], 3, h->contact.x);
  gather(contact, given[1], 3, h->contact.velocity);
  gather(contact, given[2], 3, h->inverse_mass);
  gather(contact, given[4], 3, h->others);
  ct_prediction to = {.tau = p->dt,
                      .force_time = p->force_time,
                      .whole = p->dt,
                      .velocity = h->contact.velocity,
                      .inverse_mass = h->inverse_mass,
                      .force = h->others};
  for (int64_t d = 0; d < count; d++) h->increment[d] = ct_prediction_increment(&to, d);
  gather(contact, given[3], 3, h->increment);
  to.increment = h->increment;
  return to;
}

/* A contact whose parts list their rows. */
typedef struct lister {
  ct_contact *contact;
  const ct_surface_motion *now;
} lister;

static ct_status list_rows(void *user, int32_t set, ct_constraint **rows, int64_t *count,
                           ct_error *error)
{
  const lister *from = user;
  const ct_host_part *part = from->contact->host->lists[set];
  (void)error;
  if (part->is->row_count == 0 && part->on == NULL) return CT_OK;
  const ct_surface_motion motion = ct_host_motion(from->contact->host, part, from->now);
  *count = part->is->calls->list_rows(part->state, &motion, rows);
  return CT_OK;
}

/* Forces of the parts whose forces are explicit, or of the others. */
static ct_status find_forces(ct_host *h, const ct_surface_motion *now, int explicit,
                             ct_error *error)
{
  ct_status status = CT_OK;
  for (ct_host_part *part = &h->contact; status == CT_OK && part != NULL; part = part->next) {
    const ct_surface_motion motion = ct_host_motion(h, part, now);
    if (part->is->explicit == explicit)
      status = part->is->calls->find_forces(part->state, &motion, part->force, error);
  }
  return status;
}

/* The explicit forces move the nodes of the solver, too. */
static void add_explicit(ct_host *h)
{
  ct_solver *s = h->solver;
  for (const ct_host_part *part = &h->contact; part != NULL; part = part->next)
    for (int32_t n = 0; part->is->explicit && n < part->is->node_count; n++)
      for (int64_t c = 0, at = CT_SOLVER_WIDE * (int64_t)s->place[ct_host_place(part, n)]; c < 3;
           c++)
        s->increment[at + c] += s->mobility[at + c] * part->force[3 * (int64_t)n + c];
}

/* Solve for the forces of all points together, if the status of `place` is CT_OK in all pieces. */
static ct_status solve(ct_contact *contact, ct_status status, ct_prediction *p,
                       const ct_surface_motion *now, ct_error *error)
{
  ct_host *h = contact->host;
  int64_t rows = 0;
  if (status == CT_OK && h->solver != NULL) {
    status = ct_rows_list_all(h->solver, list_rows, &(lister){contact, now}, error);
    rows = h->solver->first[h->solver->set_count];
  }
  status = ct_host_agree(contact, status, &rows, error);
  if (status != CT_OK || rows == 0) return status;
  // -- Before t = 0 there was no step: g_{-1} = g_0 (eq:energy-start)
  p->before = !now->first ? now->before : p->force_time < p->tau ? 0.0 : p->tau;
  ct_rows_predict(h->solver, p);
  add_explicit(h);
  status = ct_rows_solve(h->solver, now->time, error);
  if (status == CT_OK) h->now.unconverged += !h->solver->converged;
  return status;
}

/* Sum of the forces of all parts on the contact's nodes. */
static void add_forces(const ct_contact *contact, double *force)
{
  const ct_contact_fixed *fixed = contact->fixed;
  memset(force, 0, 3 * (size_t)fixed->is.node_count * sizeof *force);
  for (const ct_host_part *part = &contact->host->contact; part != NULL; part = part->next)
    for (int32_t n = 0; n < part->is->node_count; n++) {
      const int64_t node = ct_host_place(part, n);
      for (int c = 0; c < 3; c++) force[3 * node + c] += part->force[3 * (int64_t)n + c];
    }
}

/* Add the work of the forces over the whole kick, whose first part ends at t_n (eq:host-work). */
static void count_work(ct_contact *contact, const ct_prediction *p)
{
  ct_host *h = contact->host;
  const int64_t count = 3 * (int64_t)contact->fixed->is.node_count;
  double part[2];
  add_forces(contact, h->force);
  // -- The work of both parts of the kick
  for (int k = 0; k < 2; k++) {
    for (int64_t d = 0; d < count; d++) {
      double after =
          ct_prediction_increment(p, d) / p->tau + p->force_time * p->inverse_mass[d] * h->force[d];
      // Half of the kick times the velocity before it, or after it (eq:host-work)
      h->terms[d] = 0.5 * p->force_time * h->force[d] * (k == 0 ? p->velocity[d] : after);
    }
    part[k] = ct_sum(h->terms, count);
  }
  // -- A whole kick began before t_0
  const int begun = h->now.begun != 0.0;
  if (!begun && !(p->force_time < p->tau)) h->now.done = -part[0];
  h->now.work = begun ? h->now.done + part[0] : 0.0;
  h->now.done += part[0] + part[1];
}

/* Let the nodes of an obstacle's surface follow those of the contact. */
static void follow(ct_host_part *part, const ct_surface_motion *now)
{
  for (int32_t n = 0; n < part->is->node_count; n++) {
    const int64_t from = 3 * (int64_t)ct_host_place(part, n), to = 3 * (int64_t)n;
    memcpy(&part->x[to], &now->x[from], 3 * sizeof *part->x);
    memcpy(&part->velocity[to], &now->velocity[from], 3 * sizeof *part->velocity);
  }
}

/* Gaps of all parts. A scene computes those of a contact twice at t = 0, and the iterations of the
 * second call begin at the closest points of the first; we do the same for equal bits. */
static ct_status place(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  ct_host *h = contact->host;
  ct_surface_motion again = ct_host_motion(h, &h->contact, now);
  ct_status status = h->contact.is->calls->place(contact, &again, error);
  again.first = 0;
  if (status == CT_OK && now->first) status = ct_contact_find_gaps(contact, &again, error);
  if (status == CT_OK) h->current = 0;
  for (ct_host_part *part = h->contact.next; status == CT_OK && part != NULL; part = part->next) {
    if (part->on != NULL) continue;
    follow(part, now);
    const ct_surface_motion motion = ct_host_motion(h, part, now);
    status = part->is->calls->place(part->state, &motion, error);
  }
  return status;
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
  ct_host_find_energy(h);
  memcpy(h->next_memory, &h->now, sizeof h->now);
  h->memory = h->next_memory;
  h->next_memory = memory;
  contact->gaps.begun = h->current = 1;
}

static ct_status take_step(ct_contact *contact, const ct_contact_prediction *p,
                           const side_prediction side[2], ct_error *error)
{
  ct_host *h = contact->host;
  memcpy(&h->now, h->memory, sizeof h->now);
  ct_prediction prediction = prepare(contact, p, side);
  const ct_surface_motion now = {.time = h->now.time,
                                 .before = h->now.before,
                                 .dt = p->dt,
                                 .threads = contact->fixed->threads,
                                 .first = h->now.begun == 0.0,
                                 .x = h->contact.x,
                                 .velocity = h->contact.velocity};
  ct_status status = place(contact, &now, error);
  if (status == CT_OK) status = find_forces(h, &now, 1, error);
  status = solve(contact, status, &prediction, &now, error);
  if (status == CT_OK) status = find_forces(h, &now, 0, error);
  if (status != CT_OK) return status;
  count_work(contact, &prediction);
  end_step(contact, p);
  return CT_OK;
}

/* Refuse values at a node of a surface that are not finite, and a negative inverse mass. */
static ct_status check_side(const ct_contact *contact, int s, const side_prediction *p,
                            ct_error *error)
{
  const ct_search *search = contact->fixed->gaps.side[s].search;
  const double *vectors[] = {p->velocity, p->inverse_mass, p->increment,
                             p->increment == NULL ? p->force : NULL};
  static const char *const WHAT[] = {"velocity", "inverse mass", "increment", "force"};
  for (int32_t n = 0; n < search->node_count; n++)
    for (int v = 0; v < 4; v++)
      for (int c = 0; vectors[v] != NULL && c < 3; c++) {
        const double value = vectors[v][3 * (int64_t)search->nodes[n] + c];
        if (isfinite(value) && (v != 1 || value >= 0.0)) continue;
        return ct_fail(error, CT_INVALID, (ct_place){s, -1, search->nodes[n]},
                       "contact: %s %c of node %d of surface %d is %g, which is %s", WHAT[v],
                       "xyz"[c], (int)search->nodes[n], s, value,
                       isfinite(value) ? "negative" : "not finite");
      }
  return CT_OK;
}

/* Refuse times that are impossible for a leapfrog: a kick is the mean of the last step and the next
 * one, or the next one; in the first step it may be shorter. Other integrators pass increments. */
static ct_status check_times(const ct_contact *contact, const ct_contact_prediction *p,
                             ct_error *error)
{
  static const double SLACK = 1e-6;
  const ct_host_record last = ct_host_record_of(contact->host);
  double mean = last.begun != 0.0 ? 0.5 * (last.before + p->dt) : p->dt,
         least = last.begun != 0.0 ? fmin(mean, p->dt) : 0.0, most = fmax(mean, p->dt);
  if (!(p->dt > 0.0 && isfinite(p->dt)))
    return CT_REFUSE(error, "contact: dt must be positive and finite, not %g", p->dt);
  if (!(p->force_time > 0.0 && isfinite(p->force_time)))
    return CT_REFUSE(error, "contact: force_time must be positive and finite, not %g",
                     p->force_time);
  if (p->increment_a != NULL ||
      (p->force_time >= (1.0 - SLACK) * least && p->force_time <= (1.0 + SLACK) * most))
    return CT_OK;
  return CT_REFUSE(error,
                   "contact: in a leapfrog step of %g after one of %g, force_time is %g, not %g; "
                   "give the increments if your step is no leapfrog",
                   p->dt, last.before, mean, p->force_time);
}

/* Refuse a contact or an obstacle without a travel time. */
static ct_status check_travel(const ct_contact *contact, ct_error *error)
{
  ct_status status = CT_OK;
  for (const ct_host_part *part = &contact->host->contact; status == CT_OK && part != NULL;
       part = part->next) {
    if (part->is->on != NULL || part->is->row_count == 0) continue;
    const ct_contact_fixed *fixed = (const ct_contact_fixed *)part->is;
    status = ct_law_check_time(&fixed->law, fixed->partner->label, error);
  }
  return status;
}

ct_status ct_contact_step(ct_contact *contact, const ct_contact_prediction *p, ct_error *error)
{
  if (contact == NULL || p == NULL) return CT_REFUSE_NULL(error);
  const side_prediction a = {p->x_a, p->velocity_a, p->force_a, p->inverse_mass_a, p->increment_a},
                        b = {p->x_b, p->velocity_b, p->force_b, p->inverse_mass_b, p->increment_b},
                        side[2] = {a, contact->fixed->gaps.sides == 2 ? b : a};
  for (int s = 0; s < contact->fixed->gaps.sides; s++)
    if (side[s].x == NULL || side[s].velocity == NULL || side[s].inverse_mass == NULL)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){s, -1, -1},
                     "contact: the %s of surface %d are null",
                     side[s].x == NULL          ? "coordinates"
                     : side[s].velocity == NULL ? "velocities"
                                                : "inverse masses",
                     s);
  int64_t rows = 0;
  ct_status status = ct_host_open(contact, error);
  if (status == CT_OK) status = check_times(contact, p, error);
  if (status == CT_OK) status = check_travel(contact, error);
  for (int s = 0; status == CT_OK && s < contact->fixed->gaps.sides; s++)
    status = check_side(contact, s, &side[s], error);
  if (contact->host != NULL) status = ct_host_agree(contact, status, &rows, error);
  return status == CT_OK ? take_step(contact, p, side, error) : status;
}

ct_status ct_contact_balance_of(const ct_contact *contact, ct_contact_balance *out, ct_error *error)
{
  if (contact == NULL || out == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_host_check_current(contact, error);
  if (status != CT_OK) return status;
  const ct_host_record record = ct_host_record_of(contact->host);
  *out = (ct_contact_balance){.energy = ct_contact_energy(contact),
                              .work = record.work,
                              .removal = contact->record.removal + contact->host->energy.removal,
                              .unconverged = (int64_t)record.unconverged,
                              .friction = contact->host->energy.dissipated,
                              .motion = contact->host->energy.motion,
                              .late = (int64_t)contact->record.admission.late,
                              .late_depth = contact->record.admission.late_depth};
  return CT_OK;
}

double ct_contact_energy(const ct_contact *contact)
{
  if (contact == NULL) return NAN;
  double own = ct_contact_own_energy(contact);
  return contact->host != NULL && contact->host->current ? own + contact->host->energy.stored : own;
}

/* Masses in the contact's numbering; null with `status`. */
static double *take_masses(const ct_contact *contact, const double *const mass[2], const double *dt,
                           ct_status *status, ct_error *error)
{
  if (contact == NULL || mass[0] == NULL || (mass[1] == NULL && contact->fixed->gaps.sides == 2) ||
      dt == NULL) {
    *status = CT_REFUSE(error, "contact: a required argument is null");
    return NULL;
  }
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_search *search = contact->gaps.side[s].search;
    for (int32_t n = 0; n < search->node_count; n++)
      if (!(mass[s][search->nodes[n]] > 0.0)) {
        *status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){s, -1, search->nodes[n]},
                          "contact: the mass of node %d of surface %d is not positive",
                          (int)search->nodes[n], s);
        return NULL;
      }
  }
  double *own = ct_allocate((size_t)contact->fixed->is.node_count, sizeof *own);
  *status = own != NULL ? CT_OK : CT_NO_MEMORY(error, "a bound on the time step");
  if (own != NULL) gather(contact, mass, 1, own);
  return own;
}

/* The step of a bound, whose masses are freed. */
static ct_status end_bound(double *mass, ct_status status, double omega2, double *dt,
                           ct_error *error)
{
  ct_release(mass);
  if (status != CT_OK)
    return ct_fail(error, status, CT_NOWHERE, "contact: no bound on the time step");
  // -- Δt = 2 / ω (eq:step-bound)
  *dt = 2.0 / sqrt(omega2);
  return CT_OK;
}

ct_status ct_contact_update_stable_step(const ct_contact *contact, const double *mass_a,
                                        const double *mass_b, double *dt, ct_error *error)
{
  double omega2 = 0.0;
  ct_status status;
  double *mass = take_masses(contact, (const double *const[2]){mass_a, mass_b}, dt, &status, error);
  if (mass == NULL) return status;
  status = ct_contact_find_springs(contact, (ct_masses){mass, NULL}, &omega2);
  return end_bound(mass, status, omega2, dt, error);
}

ct_status ct_contact_stable_step(const ct_contact *contact, const double *mass_a,
                                 const double *mass_b, double *dt, ct_error *error)
{
  double omega2 = 0.0;
  ct_status status;
  double *mass = take_masses(contact, (const double *const[2]){mass_a, mass_b}, dt, &status, error);
  if (mass == NULL) return status;
  status = ct_interaction_bound(&contact->fixed->is, contact, (ct_masses){mass, NULL}, &omega2);
  const ct_host_part *part = contact->host == NULL ? NULL : contact->host->contact.next;
  for (; status == CT_OK && part != NULL; part = part->next) {
    double bound;
    status = ct_interaction_bound(part->is, part->state, (ct_masses){mass, part->nodes}, &bound);
    if (status == CT_OK) omega2 += bound;
  }
  return end_bound(mass, status, omega2, dt, error);
}
