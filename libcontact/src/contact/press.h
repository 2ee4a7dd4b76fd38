#ifndef CT_SRC_CONTACT_PRESS_H
#define CT_SRC_CONTACT_PRESS_H

#include "side.h"

/* What all points of a side share when they are listed as constraints. */
typedef struct ct_press {
  const ct_side *side, *other; /* `other` is null for an obstacle */
  double epsilon; /* stiffness over weight: half the penalty where both sides have points */
  ct_enforcement enforcement;
  double dissipation;
  double reach;       /* points farther out than this are not listed */
  int64_t first;      /* number of the side's first point among the effect's */
  const double *last; /* forces of the last step, `stride` doubles apart */
  int stride;
  int renumber; /* whether the side's nodes are numbered by its `search->nodes` in the effect, or as
                   the effect's */
} ct_press;

/* List the points of a side that may press; answers how many (eq:constraint-force). */
int64_t ct_press_list(const ct_press *press, const double moved[3], ct_constraint *list);

/* The forces that the constraints of an effect have found, onto the points of a side, those `first`
 * ... of the effect. */
void ct_press_apply(ct_side *side, int64_t first, const ct_constraint *list, int64_t count);

/* Forces of solved constraints into the memory of the effect's `points` points, `stride` doubles
 * apart. */
void ct_press_remember(const ct_constraint *list, int64_t count, int64_t points, double *memory,
                       int stride);

/* Energy that the solved constraints of an effect hold at t_n (eq:controlled-energy,
 * eq:energy-start): `before` is what all of them stored in the middle of the last step, which the
 * effect remembers, and `*after` becomes what they store in the middle of the coming one. `terms`
 * is room for a number each. */
double ct_press_energy(const ct_constraint *list, int64_t count, double time, double before,
                       double *after, double *terms);

#endif
