#ifndef CT_SRC_CONTACT_FRICTION_INTERNAL_H
#define CT_SRC_CONTACT_FRICTION_INTERNAL_H

#include "../base/lanes.h"
#include "../base/memory.h"
#include "../constraint/slip.h"
#include "contact_internal.h"

/* Constant data: friction acts on a contact or, if `rigid`, on an obstacle, with one or two sides.
 */
typedef struct ct_friction {
  ct_interaction is;
  double mu, rho;
  int rigid, sides, explicit;
  int quads;       /* whether the partners' faces have four nodes */
  int other_nodes; /* 4 or, if one may have others, 8; 0 at an obstacle that no body carries */
  const ct_side_fixed *side[2];
  int64_t points;
} ct_friction;

/* Memory of an elastic slip: its components along the tangents and the normal of the partner's
 * face, or at an obstacle along its axes, and its length (eq:friction-components). */
typedef struct ct_slip_memory {
  double part[3], length;
} ct_slip_memory;

/* Memory of friction for one point. */
typedef struct ct_slip_record {
  double other;    /* face of the other side plus one, 1 at an obstacle; 0: open */
  double place[2]; /* parameters of the closest point on that face */
  ct_slip_memory e, before;
  double reserve, stuck, image[3], opened;
  double force[3];
} ct_slip_record;

/* And behind all points: whether there was an earlier call, and what they stored at the middle of
 * its step and had dissipated by then; force of friction on an obstacle in it, and the work of its
 * motion against it. */
typedef struct ct_friction_tail {
  double begun, stored, lost, reaction[3], motion;
} ct_friction_tail;
enum {
  CT_FRICTION_RECORD = sizeof(ct_slip_record) / sizeof(double),
  CT_FRICTION_TAIL = sizeof(ct_friction_tail) / sizeof(double)
};

/* Axes of the partners' faces at the closest points of eight listed points, side by side: the
 * vectors a^i (eq:friction-components) and the unit normal a³; all 0 where the face has none. */
typedef struct ct_face_axes {
  double a[3][3][CT_BATCH];
} ct_face_axes;

typedef struct ct_friction_memory {
  ct_pool pool;
  const ct_friction *data;
  ct_slip *points; /* of all points; those of the listed ones are in use */
  ct_slips slips;  /* of the listed points, in this order */
  int64_t listed_count;
  struct ct_friction_point *listed; /* the points whose rows are listed in this step */
  ct_face_axes *axes;               /* of the listed points, from the list of rows to the forces */
  int has_axes;                     /* 0: those of space, at an obstacle that no body carries */
  const ct_pieces *pieces;          /* those of the sides */
  double *terms;                    /* one number per point or node */
  ct_friction_tail tail;
  double held, dissipated; /* at t_n */
} ct_friction_memory;

/* Data shared by the points of one call: the sides now. */
typedef struct ct_friction_call {
  const ct_friction *data;
  const ct_surface_motion *at;
  const ct_side *side[2];
  double
      most_face[2]; /* largest number of a partner of each side in a record; 0: none is recalled */
} ct_friction_call;

/* One listed point, of side `s`, the number `j` of all. */
typedef struct ct_friction_point {
  ct_point *point;
  int64_t j;
  int s;
} ct_friction_point;

static inline const ct_search *ct_friction_other(const ct_friction_call *now, int s)
{
  return now->side[now->data->sides - 1 - s]->search;
}

/* Give eight listed points, from one on, their friction in the next step. */
void ct_friction_prepare(const ct_friction_call *now, ct_friction_memory *state, int64_t first);

/* Store what the next step needs of eight listed points, from one on. */
void ct_friction_store(const ct_friction_call *now, ct_friction_memory *state, int64_t first);

/* The numbers of the listed points from one on: number `i` of the first. */
static inline double *ct_friction_numbers(const ct_friction_memory *state, int i, int64_t first)
{
  return &state->slips.numbers[state->slips.stride * i + first];
}

#endif
