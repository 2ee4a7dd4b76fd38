#ifndef CT_SRC_CONTACT_HOST_H
#define CT_SRC_CONTACT_HOST_H

#include "contact_internal.h"

#include "../base/memory.h"
#include "../constraint/solve.h"

/* An obstacle that a surface of a host touches, or friction: an effect as in a scene. */
typedef struct ct_host_part {
  struct ct_host_part *next;
  ct_effect *effect;
  void *scratch;
  const struct ct_host_part *on; /* of friction: its obstacle, or null for that of the surfaces */
  int side; /* surface on whose nodes the force of an obstacle and its friction acts, in order; -1:
               all nodes of the contact */
  int64_t memory; /* begin of its memory in that of the host, from the first step on */
  double *force;  /* shape (node_count of the effect, 3) */
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

/* Further data for the steps of a host's contact. Arrays exist from the first step on. */
typedef struct ct_host {
  ct_pool pool;
  int open;
  int current; /* whether the forces of the contact belong to a step */
  ct_host_part *parts;
  ct_solver *solver;   /* null: all forces are explicit penalties */
  double *force;       /* sum of all forces on the contact's nodes, shape (node_count, 3) */
  double *terms;       /* of a sum, likewise */
  double *velocity[2]; /* at the nodes of each surface, in order */
  double *rest;        /* zeros, likewise */
  double held, friction, motion,
      removal; /* energy stored by parts, energy dissipated by friction, work of moving
                  obstacles, and of their fading start gaps */
  int64_t memory_count;
  double *memory, *next_memory; /* a record, the contact's memory, that of the parts */
  ct_host_record now;
} ct_host;

/* Number of doubles in the memory of a part. */
static inline int64_t ct_host_part_memory(const ct_host_part *part)
{
  return part->effect->memory_count + (part->on != NULL ? CT_HOST_DRAG : 0);
}

/* The host of a contact, created if there is none; null if out of memory. */
ct_host *ct_host_of(ct_contact *contact);

/* Obstacle `number`; null: there is none. */
const ct_host_part *ct_host_obstacle(const ct_contact *contact, int32_t number);

/* The view of a part in the next step. */
ct_view ct_host_view(const ct_contact *contact, const ct_host_part *part,
                     const ct_contact_prediction *p);

/* Forces of all parts at t_n, after the rows are solved. */
ct_status ct_host_find_forces(ct_contact *contact, const ct_contact_prediction *p, ct_error *error);

/* Energy, dissipation and work of all parts after the forces of a step, from `next_memory`. */
void ct_host_sum_parts(ct_host *host);

/* Add the forces of all parts. */
ct_status ct_host_add_force(const ct_contact *contact, double *const f[2], ct_error *error);

/* Bound of ω² for the forces of a step: of friction and of explicit penalties (eq:contact-bound,
 * eq:friction-bound, eq:obstacle-bound). */
ct_status ct_host_omega2_bound(const ct_contact *contact, const double *const mass[2],
                               double *omega2);

#endif
