#ifndef CT_SRC_HOST_H
#define CT_SRC_HOST_H

#include "../base/memory.h"
#include "../constraint/solve.h"
#include "../contact/contact_internal.h"

/* An interaction of a host: first the contact itself, then obstacles and friction as they were
 * added. */
typedef struct ct_host_part {
  struct ct_host_part *next;
  ct_interaction *is;
  void *state;
  const struct ct_host_part *on; /* of friction: the part that it acts on */
  int side;             /* surface whose nodes it has, in order; -1: all nodes of the contact */
  int64_t memory;       /* begin of its memory in that of the host, from the first step on */
  double *force;        /* on its nodes, shape (node_count, 3) */
  double *x, *velocity; /* at them; null for friction, which has those of `on` */
} ct_host_part;

/* State of all parts after the steps so far, as doubles of a restart. */
typedef struct ct_host_record {
  double begun;        /* whether a step was taken */
  double before;       /* Δt of the last one */
  double time;         /* of the next one: */
  double since, count; /* that many steps of Δt after this time */
  double done;         /* work of the forces up to v_{n-1/2}, less that before t_0 */
  double work;         /* up to t_n */
  double unconverged;
} ct_host_record;

/* Memory of friction on an obstacle behind its own: its force on the obstacle, the obstacle's
 * position, and the work of its motion against this force. */
typedef struct ct_host_drag {
  double begun, force[3], place[3], work;
} ct_host_drag;

enum {
  CT_HOST_RECORD = sizeof(ct_host_record) / sizeof(double),
  CT_HOST_DRAG = sizeof(ct_host_drag) / sizeof(double)
};

/* The host of a contact. Arrays exist from the first step on; those at nodes have the contact's
 * numbering and the shape (node_count, 3). */
typedef struct ct_host {
  ct_pool pool;
  int open;
  int current; /* whether the forces belong to a step */
  ct_host_part contact;
  ct_solver *solver;                         /* null: all forces are explicit penalties */
  const ct_host_part **lists;                /* of each set of rows: the part that lists them */
  double *inverse_mass, *others, *increment; /* given: 1 / m, other forces, increments */
  double *force;                             /* sum of the forces of all parts */
  double *terms;                             /* of a sum */
  ct_interaction_energy energy;              /* of all parts without the contact */
  int64_t memory_count;
  double *memory, *next_memory; /* a record, and the memory of all parts */
  ct_host_record now;
} ct_host;

/* Whether a part is friction on an obstacle; number of doubles in the memory of a part. */
static inline int ct_host_has_drag(const ct_host_part *part)
{
  return part->on != NULL && part->side >= 0;
}

static inline int64_t ct_host_part_memory(const ct_host_part *part)
{
  return part->is->memory_count + (ct_host_has_drag(part) ? CT_HOST_DRAG : 0);
}

/* The host of a contact, created if there is none; null if out of memory. */
ct_host *ct_host_of(ct_contact *contact);

/* Motion of the nodes of a part in the step of the motion `now`. */
ct_surface_motion ct_host_motion(const ct_host *host, const ct_host_part *part,
                                 const ct_surface_motion *now);

/* Forces of all parts at t_n, after the rows are solved; and the energies, from `next_memory`. */
ct_status ct_host_find_forces(ct_host *host, const ct_surface_motion *now, ct_error *error);
void ct_host_sum_energy(ct_host *host);

/* Obstacle `number`; null: there is none. */
const ct_host_part *ct_host_obstacle(const ct_contact *contact, int32_t number);

/* ``CT_ERROR_ARGUMENT`` if the forces do not belong to a step. */
ct_status ct_host_check_current(const ct_contact *contact, ct_error *error);

/* The node of the host's arrays that is node `n` of a part; `side` becomes its surface. */
int32_t ct_host_node(const ct_contact *contact, const ct_host_part *part, int32_t n, int *side);

#endif
