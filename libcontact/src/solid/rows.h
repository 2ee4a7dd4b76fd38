#ifndef CT_SRC_SOLID_ROWS_H
#define CT_SRC_SOLID_ROWS_H

#include <libcontact/step.h>

#include "kernel.h"

/* Quiet regions of a body in the order of a lattice: a bit an element, so that a whole row is asked
 * at once. Each row of elements along x begins with a word of its own; bits behind its last element
 * are 0. */
typedef struct ct_rows {
  int32_t words, count; /* words of a row, rows */
  uint64_t *moving;     /* computed in this call */
  uint64_t
      *fresh; /* of those: its nodes had moved alike at the last look, so its forces are zero now */
  uint64_t *asleep;  /* not computed, and its nodes have one velocity (eq:quiet-asleep) */
  uint64_t *led;     /* of those: displacement and velocity are the leader's */
  uint64_t *reached; /* one of its nodes is summed in this call */
  uint64_t *awake;   /* it is in a batch with one that is not led, or is reached */
  int64_t computed;  /* elements in batches that are computed */
  int known;         /* whether a call has looked yet */
  int stands;        /* whether `reached` and ct_found stand from the call before */
  int led_stands;    /* whether that is so for `awake` and what is adrift */
  int leading;       /* whether there is a leader */
} ct_rows;

/* What a call of the force finds out about one body, for the loops over batches and nodes. */
typedef struct ct_found {
  uint8_t *computed; /* of each batch of the body */
  uint8_t *read;     /* of each batch: whether one of its nodes is summed */
  uint8_t *awake;    /* of each batch: room */
  uint64_t *changed; /* a bit a node of the problem: whether one of its elements is computed */
  uint64_t
      *adrift; /* a bit a node of the problem: whether the leader moves for it (eq:adrift-node) */
  int32_t node_count; /* of the problem */
} ct_found;

/* Room for a body; `rows` is all zero bytes before. CT_ERROR_MEMORY. */
ct_status ct_rows_create(const ct_solid_part *part, ct_rows *rows);

void ct_rows_free(ct_rows *rows);

/* In call number `call` of the force, find which elements are quiet (eq:quiet-batch), and all of
 * `found`; `leader` is that of this body, or null: none is wanted. */
void ct_rows_find(ct_rows *rows, const ct_solid_part *part, const ct_view *view, int32_t call,
                  ct_leader *leader, const ct_found *found);

#endif
