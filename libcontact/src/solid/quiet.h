#ifndef CT_SRC_SOLID_QUIET_H
#define CT_SRC_SOLID_QUIET_H

#include "kernel.h"

/* Nodes first ... last of the problem, both included. */
typedef struct ct_node_range {
  int32_t first, last;
} ct_node_range;

/* What the last call found at a batch. */
enum {
  CT_BATCH_MOVING,     /* it was computed */
  CT_BATCH_FRESH,      /* it was computed; its nodes have moved alike and all its forces are zero */
  CT_BATCH_QUIET,      /* it was skipped: its forces stand from before */
};

/* What a state keeps to know which batches are quiet; null pointers where no body leaves anything out. */
typedef struct ct_quiet {
  uint8_t *batch;    /* of each batch of all parts: what the last call found */
  uint64_t *changed; /* a bit a node: whether one of its elements was computed in this call */
} ct_quiet;

/* List the ranges of consecutive nodes of each batch of a part. */
ct_status ct_quiet_prepare(ct_solid_part *part);

/* Whether a batch can be skipped; if not, notes what it is now (eq:quiet-batch). `displacement` is that of the problem. */
int ct_quiet_skip(ct_quiet *quiet, const ct_solid_part *part, int32_t b, const double *displacement);

/* After the batches first ... last - 1 were computed: those with any force are no quiet ones. */
void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last, const double *values);

/* Mark the nodes of those of the batches first ... last - 1 that were computed in this call. */
void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last);

#endif
