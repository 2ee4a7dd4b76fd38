/* The contact's part of the largest ω²: every point taken as active at its nearest face. */
#include <libcontact/contact.h>

#include "../base/memory.h"
#include "contact_internal.h"

#include <math.h>

/* A surface in contact with itself, and the face of the point whose partner is looked for. */
typedef struct neighbourhood {
  const ct_search *search;
  int32_t face;
} neighbourhood;

static int is_adjacent(void *user, int32_t face)
{
  const neighbourhood *n = user;
  return ct_search_adjacent(n->search, n->face, face);
}

/* Face and shape functions that a point would press on: those of the last update, or of the nearest
 * face. */
static int32_t partner(const ct_side *side, const ct_side *other, const ct_search *now, int64_t i,
                       double N[8])
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  if (side->points[i].other >= 0) {
    for (int a = 0; a < 8; a++) N[a] = side->points[i].N[a];
    return side->points[i].other;
  }
  double y[3];
  ct_nearest nearest;
  neighbourhood near = {now, (int32_t)(i / side->rule.count)};
  ct_side_interpolate(side, near.face, side->N[i % side->rule.count], zero, y);
  ct_search_point(now, y, -1, HUGE_VAL, ct_search_options_default().tolerance,
                  side == other ? is_adjacent : NULL, &near, &nearest);
  if (nearest.face >= 0) ct_segment_shape(other->search->kind, nearest.xi, N);
  return nearest.face;
}

/* Row sums Σ_gp k |b_i| Σ_j |b_j| of the penalty stiffness of one pass (eq:contact-bound). */
static void add_rows(const ct_side *side, const ct_side *other, const ct_search *now,
                     double epsilon, double *rows, double *other_rows)
{
  for (int64_t i = 0; i < ct_side_point_count(side); i++) {
    double N[8], k = 0.5 * epsilon * side->weight[i], sum = 0.0;
    const double *own = side->N[i % side->rule.count];
    int32_t face = partner(side, other, now, i, N);
    if (face < 0) continue;
    for (int a = 0; a < side->search->per; a++) sum += fabs(own[a]);
    for (int a = 0; a < other->search->per; a++) sum += fabs(N[a]);
    for (int a = 0; a < side->search->per; a++)
      rows[side->search->faces[i / side->rule.count * side->search->per + a]] +=
          k * sum * fabs(own[a]);
    for (int a = 0; a < other->search->per; a++)
      other_rows[other->search->faces[(int64_t)face * other->search->per + a]] +=
          k * sum * fabs(N[a]);
  }
}

/* Two surfaces over one array of nodes: a node of both has one row, the sum of what each pass
 * found. Both lists of nodes ascend. */
static void join_rows(const ct_side *a, const ct_side *b, double *rows_a, double *rows_b)
{
  for (int32_t i = 0, j = 0; i < a->search->node_count && j < b->search->node_count;) {
    int32_t p = a->search->nodes[i], q = b->search->nodes[j];
    if (p == q) rows_a[i] = rows_b[j] = rows_a[i] + rows_b[j];
    i += p <= q;
    j += q <= p;
  }
}

static double largest_row(const ct_side *side, const double *rows, const double *mass)
{
  double top = 0.0;
  for (int32_t n = 0; n < side->search->node_count; n++)
    top = fmax(top, rows[n] / mass[side->search->nodes[n]]);
  return top;
}

ct_status ct_contact_frequency(const ct_contact *contact, const double *mass_a,
                               const double *mass_b, double *omega_squared)
{
  if (contact == NULL || mass_a == NULL || (mass_b == NULL && contact->sides == 2) ||
      omega_squared == NULL)
    return CT_ERROR_ARGUMENT;
  for (int s = 0; s < contact->sides; s++)
    for (int32_t n = 0; n < contact->side[s].search->node_count; n++)
      if (!((s == 0 ? mass_a : mass_b)[contact->side[s].search->nodes[n]] > 0.0))
        return CT_ERROR_ARGUMENT;
  double *rows[2] = {NULL, NULL};
  ct_search *now[2] = {NULL, NULL};
  ct_status status = CT_OK;
  for (int s = 0; s < contact->sides; s++) {
    rows[s] = ct_allocate((size_t)contact->side[s].search->node_count, sizeof *rows[s]);
    if (rows[s] == NULL) status = CT_ERROR_MEMORY;
    // Trees of the current shape, so that the call also works before the first update.
    if (status == CT_OK) status = ct_search_look(contact->side[s].search, &now[s]);
  }
  *omega_squared = 0.0;
  for (int s = 0, t = contact->sides - 1; s < contact->sides && status == CT_OK; s++, t--)
    add_rows(&contact->side[s], &contact->side[t], now[t], contact->options.epsilon, rows[s],
             rows[t]);
  if (status == CT_OK && contact->sides == 2 && contact->one_array)
    join_rows(&contact->side[0], &contact->side[1], rows[0], rows[1]);
  for (int s = 0; s < contact->sides && status == CT_OK; s++)
    *omega_squared =
        fmax(*omega_squared, largest_row(&contact->side[s], rows[s], s == 0 ? mass_a : mass_b));
  for (int s = 0; s < 2; s++) {
    ct_release(rows[s]);
    ct_search_leave(now[s]);
  }
  return status;
}

ct_status ct_contact_stable_step(const ct_contact *contact, const double *mass_a,
                                 const double *mass_b, double *dt)
{
  double omega_squared;
  if (dt == NULL) return CT_ERROR_ARGUMENT;
  ct_status status = ct_contact_frequency(contact, mass_a, mass_b, &omega_squared);
  // -- Δt = 2 / ω (eq:step-bound)
  if (status == CT_OK) *dt = 2.0 / sqrt(omega_squared);
  return status;
}
