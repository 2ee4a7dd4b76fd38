#ifndef CT_SRC_EFFECT_SOLID_H
#define CT_SRC_EFFECT_SOLID_H

#include <libcontact/effect.h>

#include "../solid/part.h"

/* Data of an effect of the kind CT_EFFECT_SOLID. */
typedef struct ct_solid_data {
  int32_t part_count;
  ct_solid_part *parts;
  int64_t value_count, ring_stride; /* of all, and of one thread's ring */
  int64_t flops;                    /* of a step in which nothing sleeps */
  int64_t batch_count;
  int sleeps; /* whether elements of some part may sleep */
} ct_solid_data;

/* ct_solid_create_effect for meshes that have passed ct_mesh_check. */
ct_status ct_solid_create_checked(const ct_solid_def *def, ct_effect **effect, ct_error *error);

/* A bound of ω² for each node of a solid effect's bodies, shape (node_count), from the elements
 * around it, or from the blocks of a box (eq:filter-weight) [1 / time²]. */
ct_status ct_solid_nodes_omega2(const ct_effect *solid, double *omega2, ct_error *error);

#endif
