#ifndef CT_SRC_CONTACT_PASS_H
#define CT_SRC_CONTACT_PASS_H

#include "../projection/projection_internal.h"
#include "gaps.h"

#include "../base/vector.h"

/* Data of one pass: the points of `side` are projected on the faces of `other`. */
typedef struct ct_pass {
  ct_side *side;
  const ct_side *other;
  ct_project_options project;
  ct_near_kernel *near; /* for closest points that have moved little */
  double depth;         /* search distance of points */
  double skin;          /* additional distance to which candidates are listed */
  double since;         /* bound of the motion of points relative to places on faces since then */
  double deep;          /* largest depth of a point in contact on a surface with itself */
  double beside;        /* largest depth of a point beside an edge (eq:beside-edge) */
  int self;             /* whether the other side is the same surface */
  int first;            /* whether no point has a status yet */
} ct_pass;

/* Number of points that are processed together. */
enum { CT_WARM = 8 };

/* Project the points first ... first + count - 1, at most eight, on their faces of the last step,
 * side by side, and complete those for which the search would give the same result (eq:warm-lanes).
 * Returns one bit for each. */
unsigned ct_pass_warm(const ct_pass *p, int64_t first, int count);

/* Distance of a place now, in which nothing is that was farther when the candidates were listed. */
static inline double ct_pass_reached(const ct_pass *p, double reach)
{
  return (1.0 + 1e-9) * (reach + p->since);
}

/* Unit normal of a point's own face; returns 0 if it has none. */
static inline int ct_pass_own_normal(const ct_pass *p, int64_t i, double own[3])
{
  ct_side_area(p->side, i, own);
  double length = sqrt(ct_vector_dot(own, own));
  for (int c = 0; c < 3; c++) own[c] /= length;
  return length > 0.0;
}

/* Whether a surface with the normal `normal` (of any length) faces one with the unit normal `own`,
 * or is perpendicular to it (eq:far-side). */
static inline int ct_pass_faces_across(const double own[3], const double normal[3])
{
  // (eq:self-adjacent)
  return ct_vector_dot(own, normal) < 0.5 * sqrt(ct_vector_dot(normal, normal));
}

/* Whether a surface with the normal `normal` (of any length) faces one with the unit normal `own`,
 * and is not about perpendicular to it. */
static inline int ct_pass_opposes(const double own[3], const double normal[3])
{
  return ct_vector_dot(own, normal) < -0.25 * sqrt(ct_vector_dot(normal, normal));
}

#endif
