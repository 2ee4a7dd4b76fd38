/* The contact's part of the largest ω²: every point taken as active at its nearest face. */
#include <contact/contact.h>

#include "../memory.h"
#include "contact_internal.h"

#include <math.h>

/* The point whose nearest face is looked for, and what it has found: of equally near faces the first one. */
typedef struct seeker {
  const ct_side *other;
  double y[3];
  int32_t face;
  ct_projection best;
  double nearest;
} seeker;

static double face_distance(void *user, int32_t target)
{
  seeker *s = user;
  ct_projection foot;
  ct_face face;
  ct_side_face(s->other, target, &face);
  ct_status status = ct_project(&face, s->y, NULL, &foot);
  if (status == CT_INVALID || status >= CT_ERROR_ARGUMENT) return INFINITY;
  if (foot.distance < s->nearest || (foot.distance == s->nearest && target < s->face)) {
    s->face = target;
    s->nearest = foot.distance;
    s->best = foot;
  }
  return foot.distance;
}

/* Face and shape functions that a point would press on: those of the last update, or of the nearest face. */
static int32_t partner(const ct_side *side, const ct_side *other, int64_t i, double N[8])
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  if (side->points[i].other >= 0) {
    for (int a = 0; a < 8; a++) N[a] = side->points[i].N[a];
    return side->points[i].other;
  }
  seeker s = {.other = other, .nearest = INFINITY};
  double nearest;
  ct_side_interpolate(side, (int32_t)(i / side->rule.count), side->N[i % side->rule.count], zero, s.y);
  int32_t face = ct_search_nearest(other->search, s.y, face_distance, &s, &nearest);
  if (face >= 0 && isfinite(nearest)) ct_segment_shape(other->kind, s.best.xi, N);
  return isfinite(nearest) ? face : -1;
}

/* Row sums Σ_gp k |b_i| Σ_j |b_j| of the penalty stiffness of one pass (eq:contact-bound). */
static void add_rows(const ct_side *side, const ct_side *other, double epsilon, double *rows, double *other_rows)
{
  for (int64_t i = 0; i < (int64_t)side->face_count * side->rule.count; i++) {
    double N[8], k = 0.5 * epsilon * side->weight[i], sum = 0.0;
    const double *own = side->N[i % side->rule.count];
    int32_t face = partner(side, other, i, N);
    if (face < 0) continue;
    for (int a = 0; a < side->per; a++) sum += fabs(own[a]);
    for (int a = 0; a < other->per; a++) sum += fabs(N[a]);
    for (int a = 0; a < side->per; a++) rows[side->faces[i / side->rule.count * side->per + a]] += k * sum * fabs(own[a]);
    for (int a = 0; a < other->per; a++) other_rows[other->faces[(int64_t)face * other->per + a]] += k * sum * fabs(N[a]);
  }
}

static double largest_row(const ct_side *side, const double *rows, const double *mass)
{
  double top = 0.0;
  for (int32_t n = 0; n < side->node_count; n++) top = fmax(top, rows[n] / mass[side->nodes[n]]);
  return top;
}

ct_status ct_contact_frequency(const ct_contact *contact, const double *mass_a, const double *mass_b, double *omega_squared)
{
  if (contact == NULL || mass_a == NULL || mass_b == NULL || omega_squared == NULL) return CT_ERROR_ARGUMENT;
  const ct_side *a = &contact->side[0], *b = &contact->side[1];
  for (int s = 0; s < 2; s++)
    for (int32_t n = 0; n < contact->side[s].node_count; n++)
      if (!((s == 0 ? mass_a : mass_b)[contact->side[s].nodes[n]] > 0.0)) return CT_ERROR_ARGUMENT;
  double *rows_a = ct_allocate((size_t)a->node_count, sizeof *rows_a), *rows_b = ct_allocate((size_t)b->node_count, sizeof *rows_b);
  ct_status status = rows_a != NULL && rows_b != NULL ? CT_OK : CT_ERROR_MEMORY;
  if (status == CT_OK) {
    // Trees of the current shape, so that the call also works before the first update.
    ct_search_build(a->search, a->boxes);
    ct_search_build(b->search, b->boxes);
    add_rows(a, b, contact->options.epsilon, rows_a, rows_b);
    add_rows(b, a, contact->options.epsilon, rows_b, rows_a);
    *omega_squared = fmax(largest_row(a, rows_a, mass_a), largest_row(b, rows_b, mass_b));
  }
  ct_release(rows_a);
  ct_release(rows_b);
  return status;
}

ct_status ct_contact_stable_step(const ct_contact *contact, const double *mass_a, const double *mass_b, double *dt)
{
  double omega_squared;
  if (dt == NULL) return CT_ERROR_ARGUMENT;
  ct_status status = ct_contact_frequency(contact, mass_a, mass_b, &omega_squared);
  // -- Δt = 2 / ω (eq:step-bound)
  if (status == CT_OK) *dt = 2.0 / sqrt(omega_squared);
  return status;
}
