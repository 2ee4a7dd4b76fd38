#ifndef CT_SRC_SOLID_QUIET_H
#define CT_SRC_SOLID_QUIET_H

#include "kernel.h"

/* Nodes first ... last of the problem, both included. */
typedef struct ct_node_range {
  int32_t first, last;
} ct_node_range;

/* Most ranges that a batch has. */
enum { CT_MOST_RANGES = 8 * 20 };

/* What a call finds at a batch. */
enum {
  CT_BATCH_UNKNOWN, /* no call has looked yet */
  CT_BATCH_MOVING,  /* it is computed; whether it still moves is seen every eighth call, for what moves will mostly go on to */
  CT_BATCH_FRESH,   /* it is computed; its nodes have moved alike and all its forces are zero */
  CT_BATCH_QUIET,   /* it is skipped: its forces stand from before */
  CT_BATCH_ASLEEP   /* the same, and its nodes have one velocity: it stays quiet until one of them does more than drift (eq:quiet-asleep) */
};

/* What a state keeps to know which batches are quiet; null pointers where no body leaves anything out. */
typedef struct ct_quiet {
  uint8_t *batch;    /* of each batch of all parts: what this call finds */
  uint8_t *near;     /* of each batch: whether one of its nodes has the bit that was last asked for */
  uint64_t *changed; /* a bit a node: whether one of its elements is computed in this call */
  int32_t call;      /* number of this call, modulo 8 */
} ct_quiet;

/* List the ranges of consecutive nodes of each batch of a part. */
ct_status ct_quiet_prepare(ct_solid_part *part);

/* Find for each batch of a part whether one of its nodes has the bit `value`; `near` is 1 then, else 0. `bits` are those of the problem, which has
 * `node_count` nodes. */
void ct_quiet_near(ct_quiet *quiet, const ct_solid_part *part, const uint64_t *bits, int32_t node_count, int value);

/* Find whether a batch is quiet (eq:quiet-batch). `displacement` and `velocity` are those of the problem; without a
 * velocity (null) no batch falls asleep. One that is asleep and not near stays so. */
void ct_quiet_find(ct_quiet *quiet, const ct_solid_part *part, int32_t b, const double *displacement, const double *velocity);

/* Mark the nodes of all batches of a part that are not quiet. */
void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part);

/* After the batches first ... last - 1 were computed: those with any force can't be quiet in the next call. */
void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last, double *values);

#endif
