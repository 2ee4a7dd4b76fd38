#ifndef CT_SRC_SOLID_QUIET_H
#define CT_SRC_SOLID_QUIET_H

#include "rows.h"

/* Nodes first ... last of the problem, both included. */
typedef struct ct_node_range {
  int32_t first, last;
} ct_node_range;

/* What a call finds at a batch. */
enum {
  CT_BATCH_UNKNOWN, /* no call has looked yet */
  CT_BATCH_MOVING,  /* it is computed; whether it still moves is seen every eighth call, for what
                       moves will mostly go on to */
  CT_BATCH_FRESH,   /* it is computed; its nodes have moved alike and all its forces are zero */
  CT_BATCH_QUIET,   /* it is skipped: its forces stand from before */
  CT_BATCH_ASLEEP   /* the same, and its nodes have one velocity: it stays quiet until one of them
                       does more than drift (eq:quiet-asleep) */
};

/* What a state keeps to know which batches are quiet; null pointers where no body leaves anything
 * out. */
typedef struct ct_quiet {
  ct_rows *rows;  /* of each part that is a lattice: its elements; then `batch` tells only what is
                     computed */
  uint8_t *batch; /* of each batch of all parts: what this call finds */
  uint8_t *woken; /* of each batch: whether one of its nodes did more than drift in the last step */
  uint8_t *read;  /* of each batch: whether one of its nodes is summed in this call */
  uint64_t *changed; /* a bit a node: whether one of its elements is computed in this call */
  uint64_t *adrift;  /* a bit a node: whether a leader moves for it (eq:adrift-node) */
  uint64_t *seen;    /* of each part its words of the drifted nodes that `woken` was made of, part i
                        from word `first_node / 64 + i` on */
  uint8_t *kept;     /* of each part: whether `changed` and `read`, and twice whether `woken` and
                        `seen`, stand from the call before */
  int32_t call;      /* number of this call, modulo 8 */
  int32_t part_count;
} ct_quiet;

/* Values of `kept`, to be added. */
enum { CT_KEPT_READ = 1, CT_KEPT_WOKEN = 2 };

/* Room for what is known of the parts, which have `batch_count` batches and `node_count` nodes;
 * CT_ERROR_MEMORY, what is there is to be freed then, too. */
ct_status ct_quiet_create(const ct_solid_part *parts, int32_t part_count, int64_t batch_count,
                          int32_t node_count, ct_quiet *quiet);

/* Null pointers are allowed. */
void ct_quiet_free(ct_quiet *quiet);

/* Whether a batch is computed in this call. */
static inline int ct_quiet_computes(const ct_quiet *quiet, const ct_solid_part *part, int32_t b)
{
  uint8_t found = quiet->batch[part->first_batch + b];
  return part->cells[0] > 0 ? found != 0 : found < CT_BATCH_QUIET;
}

/* The end of the batches from b on, and before `last`, that are computed as b is, or left out as b
 * is; null: all are computed. */
static inline int32_t ct_quiet_run(const ct_quiet *quiet, const ct_solid_part *part, int32_t b,
                                   int32_t last)
{
  if (quiet == NULL) return last;
  int32_t end = b + 1;
  for (int first = ct_quiet_computes(quiet, part, b);
       end < last && ct_quiet_computes(quiet, part, end) == first;)
    end++;
  return end;
}

/* List the ranges of consecutive nodes of each batch of a part. */
ct_status ct_quiet_prepare(ct_solid_part *part);

/* Find the batches of part number `number` that are woken; `drifted` are bits of the problem, or
 * null: nobody knows. */
void ct_quiet_wake(ct_quiet *quiet, const ct_solid_part *part, int32_t number,
                   const uint64_t *drifted);

/* Find which of the batches first ... last - 1 are quiet (eq:quiet-batch); answers whether one of
 * them is from now on, or no longer. `displacement` and `velocity` are those of the problem;
 * without a velocity (null) no batch falls asleep. One that is asleep and not woken stays so. */
int ct_quiet_look(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last,
                  const double *displacement, const double *velocity);

/* Mark the nodes of all batches of a part that are not quiet, and the batches that have such nodes.
 */
void ct_quiet_mark(ct_quiet *quiet, const ct_solid_part *part);

/* After the batches first ... last - 1 were computed: those with any force can't be quiet in the
 * next call. */
void ct_quiet_confirm(ct_quiet *quiet, const ct_solid_part *part, int32_t first, int32_t last,
                      double *values);

#endif
