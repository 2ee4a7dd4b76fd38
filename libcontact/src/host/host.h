#ifndef CT_SRC_HOST_H
#define CT_SRC_HOST_H

#include "../base/memory.h"
#include "../constraint/solve.h"
#include "../contact/contact_internal.h"

#include <string.h>

/* An interaction of a host: first the contact itself, then obstacles and friction as they were
 * added. */
typedef struct ct_host_part {
  struct ct_host_part *next;
  ct_interaction *is;
  void *state;
  const struct ct_host_part *on; /* of friction: the part that it acts on */
  int32_t surface;               /* of an obstacle */
  const int32_t *nodes;          /* in the numbering of the contact; null: all of them */
  int64_t memory;       /* begin of its memory in that of the host, from the first step on */
  double *force;        /* on its nodes, shape (node_count, 3) */
  double *x, *velocity; /* at them; null for friction, which has those of `on` */
  ct_interaction_energy energy; /* after a step */
} ct_host_part;

static inline int32_t ct_host_place(const ct_host_part *part, int32_t n)
{
  return part->nodes == NULL ? n : part->nodes[n];
}

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

enum { CT_HOST_RECORD = sizeof(ct_host_record) / sizeof(double) };

/* The host of a contact. Arrays exist from the first step on; those at nodes have the contact's
 * numbering and the shape (node_count, 3). */
typedef struct ct_host {
  ct_pool pool;
  const ct_pieces *pieces; /* null: one piece */
  ct_pieces given_pieces;
  uint8_t *owned[2]; /* of pieces: which faces of each surface are this piece's */
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

/* The host of a contact, created if there is none; null if out of memory. */
ct_host *ct_host_of(ct_contact *contact);

/* Motion of the nodes of a part in the step of the motion `now`. */
ct_surface_motion ct_host_motion(const ct_host *host, const ct_host_part *part,
                                 const ct_surface_motion *now);

/* Energies of all parts, after the forces are known. */
void ct_host_find_energy(ct_host *host);

/* ``CT_ERROR_ARGUMENT`` if the forces do not belong to a step. */
ct_status ct_host_check_current(const ct_contact *contact, ct_error *error);

/* ``CT_ERROR_ARGUMENT`` if a contact has taken a step, so that it can't be extended. */
ct_status ct_host_check_new(const ct_contact *contact, ct_error *error);

/* Give a contact of the host, itself or an obstacle at surface `s`, to the pieces. */
ct_status ct_host_cut(const ct_host *host, int s, ct_contact *of, ct_error *error);

/* The same status in all pieces: CT_OK if all have it; `*rows` becomes the largest of all. */
ct_status ct_host_agree(const ct_contact *contact, ct_status own, int64_t *rows, ct_error *error);

/* Allocate for the steps of a contact, unless that is done. */
ct_status ct_host_open(ct_contact *contact, ct_error *error);

/* The record of the last good step. */
static inline ct_host_record ct_host_record_of(const ct_host *host)
{
  ct_host_record record;
  memcpy(&record, host->memory, sizeof record);
  return record;
}

/* The node of the host's arrays that is node `n` of the contact; `side` becomes its surface. */
static inline int32_t ct_host_node(const ct_contact *contact, int32_t n, int *side)
{
  const ct_contact_fixed *fixed = contact->fixed;
  const int32_t node = fixed->nodes[n], first = fixed->gaps.side[0].search->host_count;
  *side = !fixed->one_array && node >= first;
  return *side == 1 ? node - first : node;
}

#endif
