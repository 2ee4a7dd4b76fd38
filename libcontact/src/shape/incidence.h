#ifndef CT_SRC_INCIDENCE_H
#define CT_SRC_INCIDENCE_H

#include <libcontact/base.h>

#include "../base/memory.h"

/* The nodes of a list of faces, and for each node its places in the list. */
typedef struct ct_incidence {
  int32_t count;
  int32_t *nodes; /* ascending, shape (count) */
  /* Node number i is at place[first[i]] ... place[first[i + 1] - 1] of the list, ascending. */
  int32_t *first, *place;
  int32_t most; /* largest number of places of a node */
} ct_incidence;

/* From a list of `count` entries, which are numbers below `node_count`. `own`: null, or the entries
 * by their number in `nodes`. The arrays are taken from the pool. */
ct_status ct_incidence_init(ct_incidence *incidence, int64_t entries, const int32_t *faces,
                            int32_t node_count, int32_t *own, ct_pool *pool);

#endif
