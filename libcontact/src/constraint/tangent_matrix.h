#ifndef CT_SRC_CONSTRAINT_TANGENT_MATRIX_H
#define CT_SRC_CONSTRAINT_TANGENT_MATRIX_H

#include "tangent_rows.h"

/* The products of the tangential rows with vectors (eq:slip-row). Four rows with the same nodes are
 * computed side by side, if their faces have four nodes. */

/* Numbers that are filled for a row: lever and weights of a row alone, each with a fourth
 * component; or its part of those of four rows, which are fewer: N_a, N̄_b, d and w_b. */
enum { CT_TANGENT_LANES = 4 + 4 * 8 };

/* Fill the lanes of the listed rows. */
void ct_tangent_fill(ct_tangent *tangent);

/* `out` = motion of each point relative to its partner, in the plane of contact, for a vector at
 * nodes. */
void ct_tangent_motion(const ct_tangent *tangent, const double *x, const ct_columns *out);

/* Clear the sums of forces at the nodes on which rows act. */
void ct_tangent_clear(const ct_tangent *tangent);

/* `moved` = motion of the nodes by the forces T, if it is not current. Returns 0 if they are not
 * finite. */
int ct_tangent_push(ct_solver *solver);

/* Write the sums of the forces T at nodes for those who have listed the rows. */
void ct_tangent_give(ct_solver *solver);

/* `image` = W times the forces T, if it is not current. Returns 0 if they are not finite. */
int ct_tangent_apply(ct_solver *solver);

/* The bound of each row of W becomes `scale`, to be widened (eq:slip-bound, eq:slip-bound-couples).
 * Returns 0 if it is not finite. */
int ct_tangent_bound(ct_solver *solver);

#endif
