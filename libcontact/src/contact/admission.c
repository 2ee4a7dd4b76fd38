/* Points that are found inside after the start: they get a start gap, so that no energy appears. */
#include "../base/vector.h"
#include "../constraint/law.h"
#include "contact_internal.h"

#include <libcontact/base.h>

#include <float.h>
#include <math.h>

/* Fraction of the energy in an account by which all points may exceed it: on curved faces the gap
 * is not linear in the motion of a step, so that some points store a little too much and others too
 * little. */
static const double SLACK = 1e-3;

/* Depth from which on such points are reported, as a fraction of the largest face. */
static const double DEEP = 0.01;

/* Change of a distance between two steps that may be rounding. */
static double unsure(const ct_side *side) { return 16.0 * DBL_EPSILON * side->search->size; }

/* Whether the work of a row is minus what it stores and loses: only then an account says something
 * (eq:contact-step-work). */
static int keeps_account(const ct_side *side)
{
  return side->points[0].row.enforcement == CT_ENFORCE_ENERGY_CONTROLLED;
}

/* The present start gap of a point, without that of the start. */
static double later(const ct_side *side, const ct_point *p)
{
  double open = fmin(p->row.gap, p->last_known - p->shift);
  // -- Released as it opens (eq:initial-release)
  return open > p->admitted + unsure(side) ? fmin(open, 0.0) : p->admitted;
}

void ct_admission_shift(ct_side *sides, int count, int counted)
{
  for (int s = 0; s < count; s++) {
    const ct_side *side = &sides[s];
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
      if (!counted) p->shift = 0.0;
      if (p->admitted == 0.0) continue;
      p->admitted = p->other < 0 ? 0.0 : later(side, p);
      p->shift += p->admitted;
      p->row.gap -= p->admitted;
      if (fabs(p->row.gap) <= unsure(side)) p->row.gap = 0.0;
    }
  }
}

double ct_side_motion(const ct_side *side)
{
  double top = 0.0;
  for (int64_t n = 0; n < side->search->node_count; n++)
    top = fmax(top, ct_vector_dot(&side->moved[3 * n], &side->moved[3 * n]));
  return sqrt(top);
}

/* Let a point store no more than in the last step. */
static void admit(const ct_side *side, ct_point *p)
{
  // -- Its gap counts from the start gap with which it stores as much as before (eq:admitted)
  double rise = ct_law_raise(&p->row, p->stored);
  if (!(rise > 0.0)) return;
  p->admitted -= rise;
  p->shift -= rise;
  p->row.gap += rise;
  p->row.before += rise;
  if (fabs(p->row.gap) <= unsure(side)) p->row.gap = 0.0;
}

/* Count a point that was found inside, if it is deep. */
static void note(ct_admission *admission, double depth, double size)
{
  if (!(depth > DEEP * size)) return;
  admission->late++;
  admission->late_depth = fmax(admission->late_depth, depth);
}

void ct_admission_bound(ct_side *sides, int count, ct_admission *admission, double reach,
                        ct_find_before *find_before, const void *user, double *terms)
{
  const double size = fmax(sides[0].search->size, sides[count - 1].search->size);
  int64_t some = 0;
  // -- Points that jumped; then the energy that each point claims to store
  for (int s = 0; s < count; s++)
    for (int64_t i = 0; i < sides[s].fixed->point_count; i++) {
      ct_point *p = &sides[s].points[i];
      p->claims = p->other >= 0 && p->row.gap < reach && find_before(user, s, i);
      if (!p->claims) continue;
      if (p->jumped && p->row.gap < 0.0) {
        note(admission, -ct_point_distance(p), size);
        admit(&sides[s], p);
      }
      terms[some] = ct_law_claim(&p->row);
      some += terms[some] != 0.0;
    }
  // -- All points together store at most what the bodies have given (eq:admitted-store)
  const ct_account *account = &admission->account;
  if (!keeps_account(sides) || some == 0 ||
      !(ct_sum(terms, some) > account->received + SLACK * account->most))
    return;
  for (const ct_side *side = sides; side < sides + count; side++)
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++)
      if (p->claims) admit(side, p);
}

/* Gap of a point of a contact in the last step at its present place, as the solver computes it. */
static int find_before(const void *user, int s, int64_t i)
{
  const ct_contact *contact = user;
  const ct_side *side = &contact->gaps.side[s],
                *other = &contact->gaps.side[contact->fixed->gaps.sides - 1 - s];
  const int32_t face = (int32_t)(i / side->fixed->rule.count);
  ct_point *p = &side->points[i];
  ct_constraint *row = &p->row;
  double own[3], theirs[3];
  if (!ct_side_direction(side, p, row->normal)) return 0;
  ct_side_interpolate(side->search, side->moved, face, row->own_shape, NULL, own);
  ct_side_interpolate(other->search, other->moved, p->other, p->N, NULL, theirs);
  row->before =
      row->gap + p->closed - (ct_vector_dot(row->normal, own) - ct_vector_dot(row->normal, theirs));
  return 1;
}

void ct_admission_limit(ct_contact *contact)
{
  double reach =
      ct_side_motion(&contact->gaps.side[0]) + ct_side_motion(ct_contact_other(contact, 0));
  ct_admission_bound(contact->gaps.side, contact->fixed->gaps.sides, &contact->admission,
                     4.0 * reach, find_before, contact, contact->terms);
}

void ct_admission_count(ct_side *sides, int count, ct_admission *admission, int solved,
                        int starting, double *terms)
{
  const int controlled = keeps_account(sides);
  int64_t some = 0;
  for (const ct_side *side = sides; side < sides + count; side++)
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
      const ct_constraint *row = &p->row;
      const int listed = p->other >= 0 && (p->listed || !solved);
      p->stored = !listed ? 0.0 : controlled ? ct_law_stored(row) : ct_law_claim(row);
      if (!listed || !controlled) continue;
      // -- Minus the work of the row (eq:admitted-account)
      double own = -0.5 * row->force * (row->after - row->before);
      terms[some] = own + (starting ? ct_law_claim(row) : 0.0);
      some += terms[some] != 0.0;
    }
  ct_account *account = &admission->account;
  account->received = ct_sum(terms, some) + (starting ? 0.0 : account->received);
  account->most = fmax(account->received, starting ? 0.0 : account->most);
}
