/* Points that are found inside after the start: they get a start gap, so that no energy appears. */
#include "../base/lanes.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "../constraint/law.h"
#include "contact_internal.h"

#include <libcontact/base.h>

#include <math.h>

/* Fraction of the energy in an account by which all points may exceed it: on curved faces the gap
 * is not linear in the motion of a step, so that some points store a little too much and others too
 * little. */
static const double SLACK = 1e-3;

/* Depth from which on such points are reported, as a fraction of the largest face. */
static const double DEEP = 0.01;

/* The present start gap of a point, without that of the start. */
static double later(const ct_side *side, const ct_point *p)
{
  double open = fmin(p->row.gap, p->last_known - p->shift);
  if (p->jumped == CT_POINT_BESIDE) return p->admitted;
  // -- Released as it opens (eq:initial-release)
  return open > p->admitted + ct_side_unsure(side) ? fmin(open, 0.0) : p->admitted;
}

void ct_admission_shift(ct_side *sides, int count, int counted)
{
  for (int s = 0; s < count; s++) {
    const ct_side *side = &sides[s];
    if (counted && !side->shifted) continue;
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
        if (!counted) p->shift = 0.0;
        if (p->admitted == 0.0) continue;
        p->admitted = p->other < 0 ? 0.0 : later(side, p);
        p->shift += p->admitted;
        p->row.gap -= p->admitted;
        if (fabs(p->row.gap) <= ct_side_unsure(side)) p->row.gap = 0.0;
      }
  }
}

double ct_side_motion(const ct_side *side)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  return ct_farthest(side->search->node_count, side->moved, NULL, zero);
}

/* Let a point store no more than in the last step. */
static void admit(ct_side *side, ct_point *p)
{
  // -- Its gap counts from the start gap with which it stores as much as before (eq:admitted)
  double rise = ct_law_raise(&p->row, p->row.impact.stored);
  if (!(rise > 0.0)) return;
  side->shifted = 1;
  p->admitted -= rise;
  p->shift -= rise;
  p->row.gap += rise;
  p->row.before += rise;
  if (fabs(p->row.gap) <= ct_side_unsure(side)) p->row.gap = 0.0;
}

/* Let the gap of a point beside an edge follow its motion along the normal, by its start gap. */
static void follow(ct_side *side, ct_point *p)
{
  const double along = p->row.gap + p->closed - p->row.before, others = p->shift - p->admitted,
               gap = p->last_known + along - p->shift;
  // -- From the depth of the nearest place to 0; 0 for a point that had none (eq:beside-gap)
  p->row.gap = fmax(fmin(0.0, gap), p->known);
  p->row.before = p->row.gap + p->closed - along;
  p->shift = p->known - p->row.gap;
  p->admitted = p->shift - others;
  side->shifted = 1;
}

/* Count a point that was found inside, if it is deep. */
static void note(ct_contact *contact, double depth)
{
  ct_admission *admission = &contact->record.admission;
  const ct_side *sides = contact->gaps.side;
  const double size =
      fmax(sides[0].search->size, sides[contact->gaps.fixed->sides - 1].search->size);
  if (!(depth > DEEP * size)) return;
  admission->late += 1.0;
  admission->late_depth = fmax(admission->late_depth, depth);
}

/* Limit what a point stores whose gap is not that of its motion. Rare: a clone is not inlined. */
CT_CLONES_RARE
static void take_jump(ct_contact *contact, ct_side *side, ct_point *p)
{
  if (p->jumped == CT_POINT_BESIDE) follow(side, p);
  if (!(p->row.gap < 0.0)) return;
  if (p->jumped == CT_POINT_JUMPED) note(contact, -ct_point_distance(p));
  admit(side, p);
}

/* Motion of a place on a face since the last update, Σ_a N_a u_a, in three of four components.
 * Inlined with a known `per`. */
CT_INLINE void motion_at(int per, const ct_side *side, int32_t face, const double *N,
                         double motion[4])
{
  const int32_t *node = &side->search->faces[(int64_t)face * per];
  for (int c = 0; c < 4; c += 4 / CT_QUAD_PARTS) {
    ct_quad t[8], sum;
    for (int a = 0; a < per; a++)
      t[a] = N[a] * *(const ct_quad *)&side->moved[3 * (int64_t)node[a] + c];
    ct_sum_face(per, t, &sum);
    *(ct_quad *)&motion[c] = sum;
  }
}

/* Motion of a point of side `s` along its normal since the last update, relative to the place that
 * it meets. */
CT_CLONES_RARE
static double motion_along(ct_contact *contact, int s, const ct_point *p)
{
  const ct_side *side = &contact->gaps.side[s], *other = ct_contact_other(contact, s),
                *surface = &contact->gaps.side[ct_gaps_surface(contact->gaps.fixed, s)];
  const int32_t face = ct_side_face(side, p - side->points);
  double own[4], back[4] = {0.0};
  if (surface->search->per == 4) motion_at(4, surface, face, p->row.own_shape, own);
  else motion_at(surface->search->per, surface, face, p->row.own_shape, own);
  if (other == NULL) {
    double at[3];
    ct_side_interpolate(surface->search, surface->search->x, face, p->row.own_shape, NULL, at);
    contact->fixed->partner->find_came(contact, at, back);
  } else if (other->search->per == 4) motion_at(4, other, p->other, p->N, back);
  else motion_at(other->search->per, other, p->other, p->N, back);
  for (int c = 0; c < 3; c++) own[c] -= back[c];
  return ct_vector_dot(p->row.normal, own);
}

/* Gap of a point of side `s` in the last step at its present place. */
CT_INLINE void find_before(ct_contact *contact, int s, ct_point *p)
{
  const double along = isnan(p->along) ? motion_along(contact, s, p) : p->along;
  // -- g_{n-1} = g_n minus the motion along n since then (eq:admitted-store)
  p->row.before = p->row.gap + p->closed - along;
}

/* Distance from which a point may store energy: four times the largest motion of both sides. */
static double reach_of(ct_contact *contact)
{
  const ct_side *other = ct_contact_other(contact, 0);
  return 4.0 * (ct_side_motion(contact->gaps.side) +
                (other != NULL ? ct_side_motion(other)
                               : sqrt(ct_vector_dot(contact->came, contact->came))));
}

/* Points whose claims are computed side by side. */
enum { CLAIMS = 64 };

/* The energy that `count` points of a side from one on claim to store, as terms of a sum; returns
 * their number, 0 if all are 0. Points that jumped store no more than in the last step. */
static int64_t list_claims(ct_contact *contact, int s, ct_point *p, int64_t count, double reach,
                           double *terms)
{
  ct_side *side = &contact->gaps.side[s];
  double k[CLAIMS], before[CLAIMS], gap[CLAIMS];
  if (count < 1) return 0;
  for (int64_t i = 0; i < count; i++, p++) {
    k[i] = p->row.stiffness;
    if (!(p->row.gap < reach)) {
      before[i] = gap[i] = 0.0;
      continue;
    }
    find_before(contact, s, p);
    if (p->jumped) take_jump(contact, side, p);
    before[i] = p->row.before, gap[i] = p->row.gap;
  }
  ct_law_claims(contact->fixed->law.enforcement, count, k, before, gap, terms);
  return ct_is_zero(terms, count) ? 0 : count;
}

void ct_admission_limit(ct_contact *contact)
{
  ct_side *sides = contact->gaps.side;
  ct_admission *admission = &contact->record.admission;
  const int count = contact->gaps.fixed->sides;
  const double reach = reach_of(contact), late = admission->late;
  int64_t some = 0;
  for (int s = 0; s < count; s++)
    for (ct_span run = {0}; ct_side_next(&sides[s], &run);)
      for (int64_t i = run.first; i < run.end; i += CLAIMS) {
        const int64_t next = run.end - i < CLAIMS ? run.end - i : CLAIMS;
        some += list_claims(contact, s, &sides[s].points[i], next, reach, &contact->terms[some]);
      }
  // -- All points together store at most what the bodies have given (eq:admitted-store)
  double both[2] = {(double)some, admission->late - late};
  ct_pieces_sum(sides[0].pieces, both, 2);
  const double all = both[0];
  admission->late = late + both[1];
  if (both[1] != 0.0) ct_pieces_largest(sides[0].pieces, &admission->late_depth, 1);
  if (!ct_law_keeps_account(contact->fixed->law.enforcement) || all == 0.0 ||
      !(ct_sum_over(sides[0].pieces, contact->terms, some) >
        admission->received + SLACK * admission->most))
    return;
  for (ct_side *side = sides; side < sides + count; side++)
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (ct_point *p = side->points + run.first; p < side->points + run.end; p++)
        if (p->row.gap < reach) admit(side, p);
}

/* The energy that the points of a side store with an explicit penalty. */
static void store_claims(const ct_side *side)
{
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (ct_point *p = side->points + run.first; p < side->points + run.end; p++)
      p->row.impact.stored = p->other >= 0 ? ct_law_claim(&p->row) : 0.0;
}

/* The energy that the bodies give to the points of a side, as terms of a sum; returns their number.
 * A row that is not listed has no force. */
static int64_t list_works(const ct_side *side, int starting, double *terms)
{
  int64_t some = 0;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (const ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
      const ct_constraint *row = &p->row;
      // -- Minus the work of the row (eq:admitted-account)
      terms[some] = -0.5 * row->force * (row->after - row->before);
      if (starting && p->listed) terms[some] += ct_law_claim(row);
      some++;
    }
  return some;
}

void ct_admission_count(ct_contact *contact, int starting)
{
  const int controlled = ct_law_keeps_account(contact->fixed->law.enforcement);
  const ct_side *sides = contact->gaps.side;
  ct_admission *admission = &contact->record.admission;
  int64_t some = 0;
  for (const ct_side *side = sides; side < sides + contact->gaps.fixed->sides; side++)
    if (controlled) some += list_works(side, starting, &contact->terms[some]);
    else store_claims(side);
  admission->received =
      ct_sum_over(sides[0].pieces, contact->terms, some) + (starting ? 0.0 : admission->received);
  admission->most = fmax(admission->received, starting ? 0.0 : admission->most);
}
