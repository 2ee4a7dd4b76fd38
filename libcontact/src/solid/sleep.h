#ifndef CT_SRC_SOLID_SLEEP_H
#define CT_SRC_SOLID_SLEEP_H

#include "kernel.h"

/* Which elements sleep, in one state. The sleeping part of a body moves as a whole, with one
 * displacement and one velocity, so its elements have no force (eq:sleep) and its nodes need not be
 * moved one by one. A batch of elements wakes when one of its nodes has another displacement, and
 * stays active until everything is examined anew. */
typedef struct ct_sleep ct_sleep;

/* Scratch space of an effect of the kind CT_EFFECT_SOLID: element forces of all bodies, and which
 * elements sleep; null where none may. While the energy is asked for, what each of `body_count`
 * bodies stores if its forces are linear (eq:stored-by-forces); else null. */
typedef struct ct_solid_scratch {
  double *values;
  struct ct_part_call *calls; /* one a body, filled in each step */
  ct_sleep *sleep;
  const double *half_work;
  int32_t body_count;
} ct_solid_scratch;

enum {
  CT_ASLEEP, /* not computed, and nobody reads its forces */
  CT_BORDER, /* not computed, but a node of it is summed */
  CT_ACTIVE
};

ct_status ct_sleep_create(const ct_solid_part *parts, int32_t part_count, ct_sleep **out);

/* Null is allowed, here and below: then nothing ever sleeps. */
void ct_sleep_free(ct_sleep *sleep);

/* Nodes on which further effects act, so that they are always active. */
void ct_sleep_share(ct_sleep *sleep, int32_t count, const int32_t *nodes);

/* Find what may sleep in a state of which nothing is known; `past` are the accelerations of the
 * evaluation before, or null. All arrays are those of the problem. */
void ct_sleep_examine(ct_sleep *sleep, const double *displacement, const double *velocity,
                      const double *past);

/* After a step: wake the batches that a difference of motion has reached. */
void ct_sleep_wake(ct_sleep *sleep, double *displacement);

/* Move all nodes that are not active by their velocity, for a time. */
void ct_sleep_drift(ct_sleep *sleep, double time);

/* Write the displacement of the nodes that are not active, for others to read. */
void ct_sleep_settle(const ct_sleep *sleep, double *displacement);

/* A bit a node of the problem: whether it is moved one by one; null: all are. */
const uint64_t *ct_sleep_active(const ct_sleep *sleep);

/* A bit a node: whether one of its elements is computed; null: all are summed. */
const uint64_t *ct_sleep_summed(const ct_sleep *sleep);

/* What the batches of part number `part` are, CT_ASLEEP and so on; null: all are active. */
const uint8_t *ct_sleep_batches(const ct_sleep *sleep, int32_t part);

/* Whether everything was examined since the last call of the force. */
int ct_sleep_examined(const ct_sleep *sleep);

/* Add the elements that are computed, and those that are left out. */
void ct_sleep_count(const ct_sleep *sleep, int64_t updates[2]);

/* For each node of a part the batches of its elements. */
ct_status ct_sleep_prepare(ct_solid_part *part);

#endif
