/* Points that are found inside after the start: they get a start gap, so that no energy appears. */
#include "../base/lanes.h"
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
    if (counted && !side->shifted) continue;
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
  if (fabs(p->row.gap) <= unsure(side)) p->row.gap = 0.0;
}

/* Count a point that was found inside, if it is deep. */
static void note(ct_admission *admission, double depth, double size)
{
  if (!(depth > DEEP * size)) return;
  admission->late += 1.0;
  admission->late_depth = fmax(admission->late_depth, depth);
}

/* Motions of the nodes of one face of a side since the last update; each component side by side, 0
 * beyond the last node. */
typedef struct face_motion {
  int32_t face; /* -1: none */
  double u[3][8];
} face_motion;

/* Motion of a place on a face since the last update, along n: Σ_a N_a n·u_a. The face is often that
 * of the point before. Inlined with a known `per`. */
CT_INLINE double motion_along(int per, const ct_side *side, int32_t face, const double *N,
                              const double n[3], face_motion *of)
{
  const int32_t *node = &side->search->faces[(int64_t)face * per];
  double t[8] = {0.0};
  for (int a = 0; of->face != face && a < per; a++)
    for (int c = 0; c < 3; c++) of->u[c][a] = side->moved[3 * (int64_t)node[a] + c];
  of->face = face;
  for (int a = 0; a < per; a += 4 / CT_QUAD_PARTS) {
    const ct_quad x = *(const ct_quad *)&of->u[0][a], y = *(const ct_quad *)&of->u[1][a],
                  z = *(const ct_quad *)&of->u[2][a];
    // -- N_a n·u_a
    *(ct_quad *)&t[a] = *(const ct_quad *)&N[a] * ((n[0] * x + n[1] * y) + n[2] * z);
  }
  return ct_side_sum(per, t);
}

/* Gaps of the points of side `s` in the last step at their present places, as the solver computes
 * them, where a point is near enough to store energy: these points claim it. Inlined with known
 * numbers of nodes of their own faces and those of the other side. */
CT_INLINE void find_before(int per, int theirs, ct_contact *contact, int s, double reach)
{
  const ct_side *side = &contact->gaps.side[s], *other = ct_contact_other(contact, s),
                *surface = &contact->gaps.side[ct_gaps_surface(contact->gaps.fixed, s)];
  face_motion on_own = {.face = -1}, on_other = {.face = -1};
  for (int64_t i = 0; i < side->fixed->point_count; i++) {
    ct_point *p = &side->points[i];
    ct_constraint *row = &p->row;
    const double *n = row->normal;
    p->claims = p->other >= 0 && row->gap < reach && !isnan(n[0]);
    if (!p->claims) continue;
    double motion = motion_along(per, surface, ct_side_face(side, i), row->own_shape, n, &on_own);
    if (other == NULL) motion -= ct_vector_dot(n, contact->came);
    else motion -= motion_along(theirs, other, p->other, p->N, n, &on_other);
    // -- g_{n-1} = g_n minus the motion along n since then (eq:admitted-store)
    row->before = row->gap + p->closed - motion;
  }
}

CT_CLONES
static void find_all_before(ct_contact *contact, int s, double reach)
{
  const ct_side *other = ct_contact_other(contact, s);
  const int per = contact->gaps.side[ct_gaps_surface(contact->gaps.fixed, s)].search->per;
  const int theirs = other == NULL ? per : other->search->per;
  if (per == 4 && theirs == 4) find_before(4, 4, contact, s, reach);
  else find_before(per, theirs, contact, s, reach);
}

/* Distance from which a point may store energy: four times the largest motion of both sides. */
static double reach_of(ct_contact *contact)
{
  const ct_side *other = ct_contact_other(contact, 0);
  return 4.0 * (ct_side_motion(contact->gaps.side) +
                (other != NULL ? ct_side_motion(other)
                               : sqrt(ct_vector_dot(contact->came, contact->came))));
}

void ct_admission_limit(ct_contact *contact)
{
  ct_side *sides = contact->gaps.side;
  ct_admission *admission = &contact->record.admission;
  const int count = contact->gaps.fixed->sides;
  const double size = fmax(sides[0].search->size, sides[count - 1].search->size),
               reach = reach_of(contact);
  int64_t some = 0;
  // -- Points that jumped; then the energy that each point claims to store
  for (int s = 0; s < count; s++) {
    find_all_before(contact, s, reach);
    for (int64_t i = 0; i < sides[s].fixed->point_count; i++) {
      ct_point *p = &sides[s].points[i];
      if (!p->claims) continue;
      if (p->jumped && p->row.gap < 0.0) {
        note(admission, -ct_point_distance(p), size);
        admit(&sides[s], p);
      }
      contact->terms[some] = ct_law_claim(&p->row);
      some += contact->terms[some] != 0.0;
    }
  }
  // -- All points together store at most what the bodies have given (eq:admitted-store)
  double all = (double)some;
  ct_pieces_sum(sides[0].pieces, &all, 1);
  if (!ct_law_keeps_account(contact->fixed->law.enforcement) || all == 0.0 ||
      !(ct_sum_over(sides[0].pieces, contact->terms, some) >
        admission->received + SLACK * admission->most))
    return;
  for (ct_side *side = sides; side < sides + count; side++)
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++)
      if (p->claims) admit(side, p);
}

void ct_admission_count(ct_contact *contact, int starting)
{
  const int controlled = ct_law_keeps_account(contact->fixed->law.enforcement);
  const ct_side *sides = contact->gaps.side;
  ct_admission *admission = &contact->record.admission;
  double *terms = contact->terms;
  int64_t some = 0;
  for (const ct_side *side = sides; side < sides + contact->gaps.fixed->sides; side++)
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
      const ct_constraint *row = &p->row;
      const int listed = p->other >= 0 && (p->listed || !contact->solved);
      if (!controlled) p->row.impact.stored = listed ? ct_law_claim(row) : 0.0;
      if (!listed || !controlled) continue;
      // -- Minus the work of the row (eq:admitted-account)
      double own = -0.5 * row->force * (row->after - row->before);
      terms[some] = own + (starting ? ct_law_claim(row) : 0.0);
      some += terms[some] != 0.0;
    }
  admission->received =
      ct_sum_over(sides[0].pieces, terms, some) + (starting ? 0.0 : admission->received);
  admission->most = fmax(admission->received, starting ? 0.0 : admission->most);
}
