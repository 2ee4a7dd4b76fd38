#ifndef CT_SRC_SOLID_SLEEP_H
#define CT_SRC_SOLID_SLEEP_H

#include "kernel.h"

/* Sleeping elements of one state. The sleeping part of a body moves as a whole, with one
 * displacement and one velocity, so its elements have no force (eq:sleep) and its nodes need not be
 * moved individually. A batch of elements becomes active when one of its nodes has another
 * displacement, and stays active until everything is examined again. */
typedef struct ct_sleep ct_sleep;

/* Scratch space of an effect of the kind CT_EFFECT_SOLID: element forces of all bodies, and the
 * sleeping elements; null if none may sleep. During an evaluation of the energy, the stored energy
 * of each of `body_count` bodies if its forces are linear (eq:stored-by-forces); else null. Of a
 * state that is a piece, the parts of the bodies in it, the size of one thread's ring for them, and
 * one bit per node of their elements. */
typedef struct ct_solid_scratch {
  double *values;
  ct_solid_part *parts;
  int64_t ring_stride;
  const uint64_t *touched;
  struct ct_part_call *calls; /* one per body, filled in each step */
  ct_sleep *sleep;
  const double *half_work;
  int32_t body_count;
} ct_solid_scratch;

enum {
  CT_ASLEEP, /* not computed, and its forces are not read */
  CT_BORDER, /* not computed, but one of its nodes is summed */
  CT_ACTIVE
};

ct_status ct_sleep_create(const ct_solid_part *parts, int32_t part_count, ct_sleep **out);

/* Null is allowed, here and below: then nothing sleeps. */
void ct_sleep_free(ct_sleep *sleep);

/* Nodes on which further effects act, so that they are always active. */
void ct_sleep_share(ct_sleep *sleep, int32_t count, const int32_t *nodes);

/* Find the batches that may sleep in a new state; `last_acceleration` are the accelerations of the
 * last evaluation, or null. All arrays are those of the problem. */
void ct_sleep_examine(ct_sleep *sleep, const double *displacement, const double *velocity,
                      const double *last_acceleration);

/* After a step: wake the batches reached by a difference of motion. */
void ct_sleep_wake(ct_sleep *sleep, double *displacement);

/* Move all nodes that are not active with their velocity, for a time. */
void ct_sleep_drift(ct_sleep *sleep, double time);

/* Write the displacement of the nodes that are not active. */
void ct_sleep_settle(const ct_sleep *sleep, double *displacement);

/* One bit per node of the problem: whether it is moved individually; null: all are. */
const uint64_t *ct_sleep_active(const ct_sleep *sleep);

/* One bit per node: whether one of its elements is computed; null: all are summed. */
const uint64_t *ct_sleep_summed(const ct_sleep *sleep);

/* States of the batches of part number `part`, CT_ASLEEP and so on; null: all are active. */
const uint8_t *ct_sleep_batches(const ct_sleep *sleep, int32_t part);

/* Whether everything was examined since the last evaluation of the force. */
int ct_sleep_examined(const ct_sleep *sleep);

/* Add the numbers of elements that are computed and skipped. */
void ct_sleep_count(const ct_sleep *sleep, int64_t updates[2]);

/* For each node of a part the batches of its elements. */
ct_status ct_sleep_prepare(ct_solid_part *part);

#endif
