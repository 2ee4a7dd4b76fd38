#ifndef CT_SRC_CONSTRAINT_LAW_ROWS_H
#define CT_SRC_CONSTRAINT_LAW_ROWS_H

#include "../base/memory.h"
#include "law.h"

/* The numbers of rows side by side: read from the rows before a solution, and written back after
 * it. */

/* Memory for at most some rows, from a pool, which may fail; `rows` has a place for each. */
void ct_law_rows_create(ct_pool *pool, int64_t most, ct_constraint **rows, ct_law_rows *out);

/* Read the rows from `first` to `end` - 1, after those before. */
void ct_law_rows_read(ct_law_rows *to, ct_constraint *const *rows, int64_t first, int64_t end);

/* Put a row in the place of an earlier one. */
void ct_law_rows_move(ct_law_rows *rows, int64_t from, int64_t to);

/* Write what the solver has found. */
void ct_law_rows_write(const ct_law_rows *rows);

#endif
