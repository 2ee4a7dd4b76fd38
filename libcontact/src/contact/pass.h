#ifndef CT_SRC_CONTACT_PASS_H
#define CT_SRC_CONTACT_PASS_H

#include "contact_internal.h"

#include "../base/vector.h"

/* What one pass needs everywhere: the points of `side` look for the faces of `other`. */
typedef struct ct_pass {
  ct_side *side;
  const ct_side *other;
  ct_project_options project;
  double depth; /* how far points look */
  double deep;  /* how deep a point of a surface with itself may be in contact */
  int self;     /* whether the other side is the same surface */
  int first;    /* whether no point has a status yet */
} ct_pass;

/* Points that are settled at once. */
enum { CT_WARM = 8 };

/* Project the points first ... first + count - 1, eight at most, on the faces of the last step,
 * side by side, and settle those for which the search would find the same (eq:warm-lanes). Answers
 * with a bit for each. */
unsigned ct_pass_warm(const ct_pass *p, int64_t first, int count);

/* Unit normal of a point's own face; answers 0 when it has none. */
static inline int ct_pass_own_normal(const ct_pass *p, int64_t i, double own[3])
{
  ct_side_area(p->side, i, own);
  double length = sqrt(ct_vector_dot(own, own));
  for (int c = 0; c < 3; c++) own[c] /= length;
  return length > 0.0;
}

/* Whether a surface with the normal `normal` (of any length) looks at one with the unit normal
 * `own`, or across; not the same way (eq:far-side). */
static inline int ct_pass_looks_across(const double own[3], const double normal[3])
{
  return ct_vector_dot(own, normal) < 0.5 * sqrt(ct_vector_dot(normal, normal));
}

#endif
