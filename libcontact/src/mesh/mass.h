#ifndef CT_SRC_MESH_MASS_H
#define CT_SRC_MESH_MASS_H

#include "batch.h"

/* Data shared by all elements: the shape functions and their derivatives at the points of the rule,
 * and whether the diagonal is scaled (eq:hrz). */
typedef struct ct_mass_shapes {
  int per, hrz;
  ct_rule rule;
  double N[27][20], dN[27][20][3];
} ct_mass_shapes;

ct_status ct_mass_tabulate(ct_brick_kind kind, ct_lumping lumping, ct_mass_shapes *out,
                           ct_error *error);

/* Lumped masses at the nodes of a batch of elements, and of each whole element, from its
 * coordinates x[component][node], which are centred in place, and its density. */
void ct_mass_lanes(const ct_mass_shapes *at, ct_lanes *x, const ct_lanes *density, ct_lanes *mass,
                   ct_lanes *total);

#endif
