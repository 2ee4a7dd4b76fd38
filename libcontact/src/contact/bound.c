/* The contact's part of the largest ω²: every point taken as active at its nearest face. */
#include <libcontact/contact.h>

#include "../base/memory.h"
#include "host.h"

#include <math.h>

/* A surface in contact with itself, and the face of the point whose partner is searched for. */
typedef struct neighbourhood {
  const ct_search *search;
  int32_t face;
} neighbourhood;

static int is_adjacent(void *user, int32_t face)
{
  const neighbourhood *n = user;
  return ct_search_adjacent(n->search, n->face, face);
}

/* Face and shape functions on which a point would act: those of the last update, or of the nearest
 * face. */
static int32_t partner(const ct_side *side, const ct_side *other, const ct_search *now, int64_t i,
                       double N[8])
{
  if (side->points[i].other >= 0) {
    for (int a = 0; a < 8; a++) N[a] = side->points[i].N[a];
    return side->points[i].other;
  }
  double y[3];
  ct_nearest nearest;
  neighbourhood near = {now, (int32_t)(i / side->fixed->rule.count)};
  ct_side_position(side, i, NULL, y);
  ct_search_point(now, y, -1, HUGE_VAL, CT_SEARCH_TOLERANCE, side == other ? is_adjacent : NULL,
                  &near, &nearest);
  if (nearest.face >= 0) ct_segment_shape(other->search->kind, nearest.xi, N);
  return nearest.face;
}

/* Row sums Σ_gp k |b_i| Σ_j |b_j| of the penalty stiffness of one pass (eq:contact-bound). */
static void add_rows(const ct_side *side, const ct_side *other, const ct_search *now,
                     double epsilon, double *rows, double *other_rows)
{
  for (int64_t i = 0; i < side->fixed->point_count; i++) {
    double N[8], k = 0.5 * epsilon * side->fixed->weight[i], sum = 0.0;
    const double *own = side->fixed->N[i % side->fixed->rule.count];
    int32_t face = partner(side, other, now, i, N);
    if (face < 0) continue;
    const int per = side->search->per, other_per = other->search->per;
    const int32_t *node = &side->search->faces[i / side->fixed->rule.count * per],
                  *other_node = &other->search->faces[(int64_t)face * other_per];
    for (int a = 0; a < per; a++) sum += fabs(own[a]);
    for (int a = 0; a < other_per; a++) sum += fabs(N[a]);
    // -- k |b_i| Σ |b_j| of one point (eq:contact-bound)
    for (int a = 0; a < per; a++) rows[node[a]] += k * sum * fabs(own[a]);
    for (int a = 0; a < other_per; a++) other_rows[other_node[a]] += k * sum * fabs(N[a]);
  }
}

/* Two surfaces over one array of nodes: a node of both has one row, the sum of both passes. Both
 * lists of nodes ascend. */
static void join_rows(const ct_side *a, const ct_side *b, double *rows_a, double *rows_b)
{
  for (int32_t i = 0, j = 0; i < a->search->node_count && j < b->search->node_count;) {
    int32_t p = a->search->nodes[i], q = b->search->nodes[j];
    if (p == q) rows_a[i] = rows_b[j] = rows_a[i] + rows_b[j];
    i += p <= q;
    j += q <= p;
  }
}

/* Rows of both passes, and their largest value over the mass. Trees are built for the current
 * shape, so that this also works before the first update. */
static ct_status find_rows(const ct_contact *contact, const double *const mass[2], double *rows[2],
                           ct_search *now[2], double *omega2)
{
  const int sides = contact->fixed->sides;
  for (int s = 0; s < sides; s++) {
    const ct_search *search = contact->side[s].search;
    rows[s] = ct_allocate((size_t)search->node_count, sizeof *rows[s]);
    if (rows[s] == NULL || ct_search_snapshot(search, &now[s]) != CT_OK) return CT_ERROR_MEMORY;
  }
  for (int s = 0, t = sides - 1; !contact->fixed->alone && s < sides; s++, t--)
    add_rows(&contact->side[s], &contact->side[t], now[t], contact->fixed->options.epsilon, rows[s],
             rows[t]);
  if (sides == 2 && contact->fixed->one_array)
    join_rows(&contact->side[0], &contact->side[1], rows[0], rows[1]);
  *omega2 = 0.0;
  for (int s = 0; s < sides; s++)
    for (int32_t n = 0; n < now[s]->node_count; n++) {
      double m = mass[s][now[s]->nodes[n]];
      if (!(m > 0.0)) return CT_ERROR_ARGUMENT;
      *omega2 = fmax(*omega2, rows[s][n] / m);
    }
  return CT_OK;
}

ct_status ct_contact_omega2_bound(const ct_contact *contact, const double *mass_a,
                                  const double *mass_b, double *omega2)
{
  const double *mass[2] = {mass_a, mass_b};
  double *rows[2] = {NULL, NULL};
  ct_search *now[2] = {NULL, NULL};
  if (contact == NULL || mass_a == NULL || (mass_b == NULL && contact->fixed->sides == 2) ||
      omega2 == NULL)
    return CT_ERROR_ARGUMENT;
  ct_status status = find_rows(contact, mass, rows, now, omega2);
  for (int s = 0; s < 2; s++) {
    ct_release(rows[s]);
    ct_search_free(now[s]);
  }
  return status;
}

ct_status ct_contact_stable_step(const ct_contact *contact, const double *mass_a,
                                 const double *mass_b, double *dt)
{
  const double *const mass[2] = {mass_a, mass_b};
  double omega2;
  if (dt == NULL) return CT_ERROR_ARGUMENT;
  ct_status status = ct_contact_omega2_bound(contact, mass_a, mass_b, &omega2);
  if (status == CT_OK) status = ct_host_omega2_bound(contact, mass, &omega2);
  // -- Δt = 2 / ω (eq:step-bound)
  if (status == CT_OK) *dt = 2.0 / sqrt(omega2);
  return status;
}
