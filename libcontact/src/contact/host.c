/* The contact of a host with its own time loop. */
#include <libcontact/contact.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../constraint/solve.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* What the steps of a host's contact need besides. */
typedef struct ct_host {
  ct_pool pool;
  ct_solver *solver; /* null for the explicit penalty */
  double *force;     /* of the contact on its nodes, shape (node_count, 3) */
  double *terms;     /* of a sum, likewise */
  int begun;         /* whether a step was taken */
  double before;     /* Δt of the last one */
  double time;       /* of the coming one */
  double done;       /* work of the forces up to v_{n-1/2}, less that before t_0 */
  double work;       /* up to t_n */
  int64_t unconverged;
} host;

ct_status ct_contact_create(const ct_surface *a, const ct_surface *b,
                            const ct_contact_options *options, ct_contact **out, ct_error *error)
{
  ct_contact_fixed *fixed = NULL;
  if (a == NULL || b == NULL || options == NULL || out == NULL)
    return CT_REFUSE(error, "contact: null argument");
  const ct_surface *const surface[2] = {a, b};
  ct_status status = ct_contact_fixed_create(surface, a == b ? 1 : 2, options, &fixed, error);
  if (status != CT_OK) return status;
  status = ct_contact_open(fixed, out, error);
  if (status == CT_OK) (*out)->own = fixed;
  else ct_contact_fixed_free(fixed);
  return status;
}

/* The coordinates that nodes move to. */
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
  for (int s = 0; s < sides; s++) ct_side_apply_penalty(&contact->side[s]);
  return ct_side_collect(contact->side, sides, 0, error);
}

void ct_host_free(host *h)
{
  if (h != NULL) ct_pool_free(h->solver);
  ct_pool_free(h);
}

/* Make room for the steps of a contact. */
static ct_status open_host(const ct_contact_fixed *fixed, host **out)
{
  const ct_row_set set = {fixed->point_count, fixed->node_count, NULL};
  const size_t nodes = (size_t)fixed->node_count;
  host *h = ct_allocate(1, sizeof *h);
  if (h == NULL) return CT_ERROR_MEMORY;
  h->force = ct_pool_take(&h->pool, nodes, 3 * sizeof *h->force);
  h->terms = ct_pool_take(&h->pool, nodes, 3 * sizeof *h->terms);
  int32_t *number = ct_pool_take(&h->pool, nodes, sizeof *number);
  ct_status status = h->pool.failed ? CT_ERROR_MEMORY : CT_OK;
  if (status == CT_OK && !ct_contact_is_penalty(fixed))
    status = ct_solver_create(&set, 1, fixed->node_count, number, &h->solver);
  if (status == CT_OK) *out = h;
  else ct_host_free(h);
  return status;
}

/* What a host gives of one surface. */
typedef struct side_prediction {
  const double *x, *velocity, *force, *inverse_mass, *increment;
} side_prediction;

/* Displacement increment of a component in the coming step without the contact. */
static double increment_of(const ct_contact_prediction *p, const side_prediction *side, int64_t dof)
{
  if (side->increment != NULL) return side->increment[dof];
  double force = side->force == NULL ? 0.0 : side->force[dof];
  return p->dt * (side->velocity[dof] + p->kick * side->inverse_mass[dof] * force);
}

/* Node `n` of a contact in the host's arrays of one of the surfaces: where its numbers begin. */
static const side_prediction *find_node(const ct_contact_fixed *fixed,
                                        const side_prediction side[2], int32_t n, int64_t *dof)
{
  int32_t node = fixed->nodes[n], first = fixed->side[0].search->host_count,
          second = !fixed->one_array && node >= first;
  *dof = 3 * (int64_t)(second ? node - first : node);
  return &side[second];
}

/* What the solver wants of the nodes (eq:constraint-problem), of the leapfrog (eq:host-step). */
static void predict(const ct_contact_fixed *fixed, const ct_contact_prediction *p,
                    const side_prediction side[2], double before, ct_solver *solver)
{
  solver->share = p->kick / p->dt;
  for (int32_t n = 0; n < fixed->node_count; n++) {
    int64_t dof, own = CT_SOLVER_WIDE * (int64_t)n;
    const side_prediction *from = find_node(fixed, side, n, &dof);
    for (int c = 0; c < 3; c++, dof++, own++) {
      solver->increment[own] = increment_of(p, from, dof);
      solver->mobility[own] = p->dt * p->kick * from->inverse_mass[dof];
      solver->past[own] = before * from->velocity[dof];
    }
  }
}

/* Find the forces of all points together. */
static ct_status solve(ct_contact *contact, const ct_contact_prediction *p,
                       const side_prediction side[2], const ct_moment *now, ct_error *error)
{
  host *h = contact->host;
  ct_solver *solver = h->solver;
  if (solver == NULL) return CT_OK;
  solver->first[1] = ct_contact_list_rows(contact, solver->rows);
  if (solver->first[1] == 0) return CT_OK;
  // -- Before t = 0 there was no step: g_{-1} = g_0 (eq:energy-start)
  double before = !now->first ? now->before : p->kick < p->dt ? 0.0 : p->dt;
  predict(contact->fixed, p, side, before, solver);
  if (!ct_solver_solve(solver))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                   "the contact forces stopped being finite at t = %g", now->time);
  h->unconverged += !solver->converged;
  return CT_OK;
}

/* Count the work of the forces: of the whole kick, of which the first part ends at t_n
 * (eq:host-work). */
static void count_work(ct_contact *contact, const ct_contact_prediction *p,
                       const side_prediction side[2])
{
  const ct_contact_fixed *fixed = contact->fixed;
  host *h = contact->host;
  double part[2];
  memset(h->force, 0, 3 * (size_t)fixed->node_count * sizeof *h->force);
  for (int s = 0; s < fixed->sides; s++)
    for (int32_t n = 0; n < contact->side[s].search->node_count; n++)
      for (int c = 0; c < 3; c++)
        h->force[3 * (int64_t)fixed->place[s][n] + c] += ct_side_force(&contact->side[s], n, c);
  for (int k = 0; k < 2; k++) {
    for (int32_t n = 0; n < fixed->node_count; n++) {
      int64_t dof, own = 3 * (int64_t)n;
      const side_prediction *from = find_node(fixed, side, n, &dof);
      for (int c = 0; c < 3; c++, dof++, own++) {
        double after =
            increment_of(p, from, dof) / p->dt + p->kick * from->inverse_mass[dof] * h->force[own];
        h->terms[own] = 0.5 * p->kick * h->force[own] * (k == 0 ? from->velocity[dof] : after);
      }
    }
    part[k] = ct_sum(h->terms, 3 * (int64_t)fixed->node_count);
  }
  // -- A kick that is whole has begun before t_0
  if (!h->begun && !(p->kick < p->dt)) h->done = -part[0];
  h->work = h->begun ? h->done + part[0] : 0.0;
  h->done += part[0] + part[1];
}

/* Gaps at a moment. A scene looks twice at t = 0, and the iterations of the second look begin at
 * the closest points of the first; so does this, for equal bits. */
static ct_status find_gaps(ct_contact *contact, const side_prediction side[2], ct_moment now,
                           ct_error *error)
{
  const double *const x[2] = {side[0].x, side[1].x};
  if (now.first) {
    ct_status status = ct_contact_begin(contact, &now, error);
    take_coordinates(contact, x);
    if (status == CT_OK) status = ct_contact_find_gaps(contact, &now, error);
    if (status != CT_OK) return status;
    now.first = 0;
  }
  take_coordinates(contact, x);
  return ct_contact_find_gaps(contact, &now, error);
}

static ct_status take_step(ct_contact *contact, const ct_contact_prediction *p,
                           const side_prediction side[2], ct_error *error)
{
  host *h = contact->host;
  const ct_moment now = {.time = h->time,
                         .before = h->before,
                         .dt = p->dt,
                         .velocity = {side[0].velocity, side[1].velocity},
                         .first = !h->begun};
  ct_status status = find_gaps(contact, side, now, error);
  if (status == CT_OK) status = solve(contact, p, side, &now, error);
  if (status == CT_OK) status = ct_contact_find_forces(contact, &now, error);
  if (status != CT_OK) return status;
  count_work(contact, p, side);
  contact->begun = h->begun = 1;
  h->before = p->dt;
  h->time += p->dt;
  return CT_OK;
}

/* Refuse what is not finite at a node of a surface, and a negative inverse mass. */
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

ct_status ct_contact_step(ct_contact *contact, const ct_contact_prediction *p, ct_error *error)
{
  if (contact == NULL || p == NULL) return CT_REFUSE(error, "contact: null argument");
  if (!(p->dt > 0.0 && isfinite(p->dt) && p->kick > 0.0 && isfinite(p->kick)))
    return CT_REFUSE(error, "contact: a step of %g in which forces act for %g", p->dt, p->kick);
  const side_prediction a = {p->x_a, p->velocity_a, p->force_a, p->inverse_mass_a, p->increment_a},
                        b = {p->x_b, p->velocity_b, p->force_b, p->inverse_mass_b, p->increment_b},
                        side[2] = {a, contact->fixed->sides == 2 ? b : a};
  for (int s = 0; s < contact->fixed->sides; s++)
    if (side[s].x == NULL || side[s].velocity == NULL || side[s].inverse_mass == NULL)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){s, -1, -1},
                     "contact: surface %d lacks coordinates, velocities or inverse masses", s);
  for (int s = 0; s < contact->fixed->sides; s++) {
    ct_status status = check_side(contact, s, &side[s], error);
    if (status != CT_OK) return status;
  }
  if (contact->host == NULL && open_host(contact->fixed, &contact->host) != CT_OK)
    return CT_NO_MEMORY(error, "the steps of a contact");
  return take_step(contact, p, side, error);
}

ct_status ct_contact_balance_of(const ct_contact *contact, ct_contact_balance *out)
{
  if (contact == NULL || out == NULL || contact->host == NULL || !contact->host->begun)
    return CT_ERROR_ARGUMENT;
  *out = (ct_contact_balance){.energy = ct_contact_energy(contact),
                              .work = contact->host->work,
                              .removal = contact->work,
                              .unconverged = contact->host->unconverged};
  return CT_OK;
}
