#ifndef CT_SRC_CONSTRAINT_LAW_ROWS_H
#define CT_SRC_CONSTRAINT_LAW_ROWS_H

#include "../base/lanes.h"
#include "../base/memory.h"
#include "law.h"

/* The numbers of rows side by side: read from the rows before a solution, and written back after
 * it. */

/* Memory for at most some rows, from a pool, which may fail; `rows` has a place for each. */
void ct_law_rows_create(ct_pool *pool, int64_t most, ct_constraint **rows, ct_law_rows *out);

/* How much of some rows is there already: nothing; their laws, if they are those read last; or all
 * but their gaps, if they also have what the last solution has written. */
typedef enum ct_rows_known { CT_ROWS_UNKNOWN, CT_ROWS_KNOWN, CT_ROWS_WRITTEN } ct_rows_known;

/* Read the rows from `first` to `end` - 1, after those before. */
void ct_law_rows_read(ct_law_rows *to, ct_constraint *const *rows, int64_t first, int64_t end,
                      ct_rows_known known);

/* Put a row in the place of an earlier one. */
void ct_law_rows_move(ct_law_rows *rows, int64_t from, int64_t to);

/* Write what the solver has found. */
void ct_law_rows_write(const ct_law_rows *rows);

/* One of many rows, as far as its law reads it. Loops over rows compute it side by side with
 * others, so what they call has no branches. */
CT_INLINE ct_constraint ct_law_row(const ct_law_rows *of, int64_t r)
{
  return (ct_constraint){.stiffness = of->stiffness[r],
                         .dissipation = of->dissipation[r],
                         .restitution = of->restitution[r],
                         .travel_time = of->travel_time[r],
                         .gap = of->gap[r],
                         .dashpot = of->dashpot[r],
                         .before = of->before[r],
                         .after = of->after[r],
                         .force = of->force[r],
                         .impact = {.reserve = of->reserve[r],
                                    .pressed = of->pressed[r],
                                    .idle = of->idle[r],
                                    .stored = of->stored[r],
                                    .release = of->release[r]}};
}

/* Travel times after which a contact counts as lasting: those of an impact of twenty layers
 * (eq:impact-reserve). */
static const double CT_LASTING = 40.0;

/* Whether the point closed less than so many travel times ago. */
CT_INLINE int ct_law_is_younger(const ct_constraint *c, double times)
{
  return (c->restitution > 0.0) & (c->impact.pressed < times * c->travel_time);
}

/* Whether the point closed less than τ = 1.5 h / c₁ ago (eq:release-time). */
CT_INLINE int ct_law_is_fresh(const ct_constraint *c) { return ct_law_is_younger(c, 1.5); }

#endif
