#ifndef CT_SRC_SOLID_BLOCKS_H
#define CT_SRC_SOLID_BLOCKS_H

#include "kernel.h"

/* Bound on the largest eigenvalue of M⁻¹K of one body, undeformed, whose components `fixed` do not
 * move: by its blocks if it is a box of equal hex8 (eq:block-bound), else by its elements
 * (eq:element-bound). `box`: that box. */
ct_status ct_solid_part_omega2_bound(const ct_solid_part *part, const int fixed[3],
                                     ct_solid_box *box, double *omega_squared, ct_error *error);

/* Bound by blocks, for a part that is a box, on the largest eigenvalue of M⁻¹ A, where the A of an
 * element is `stiffness` K + `mass` M + `added`, shape (24, 24) (eq:joint-bound). */
ct_status ct_solid_joint_bound(const ct_solid_part *part, double stiffness, double mass,
                               const double *added, double *largest, ct_error *error);

/* For each node, shape (node_count): the largest eigenvalue of the elements around it, without
 * fixed components; in a box of equal hex8 the bound of the whole part, `omega_squared`. */
ct_status ct_solid_part_nodes_omega2(const ct_solid_part *part, double *omega2, ct_error *error);

#endif
