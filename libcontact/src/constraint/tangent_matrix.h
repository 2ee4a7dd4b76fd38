#ifndef CT_SRC_CONSTRAINT_TANGENT_MATRIX_H
#define CT_SRC_CONSTRAINT_TANGENT_MATRIX_H

#include "../base/lanes.h"
#include "tangent_rows.h"

/* The products of the tangential rows with vectors (eq:slip-row). Four rows with the same nodes are
 * computed side by side, if their faces have four nodes. */

/* Numbers that are filled for a row: lever and weights of a row alone, each with a fourth
 * component; or its part of those of four rows, which are fewer: N_a, N̄_b, d and w_b. */
enum { CT_TANGENT_LANES = 4 + 4 * 8 };

/* Where these begin for four rows, each four doubles; and for a row alone. */
enum {
  CT_TANGENT_OTHER = 4 * 4,
  CT_TANGENT_LEVER = 8 * 4,
  CT_TANGENT_WEIGHT = 11 * 4,
  CT_TANGENT_ALONE = 4
};

/* Four rows are those of a 2 x 2 rule. In the lanes the rows across the middle of the face stand
 * side by side, so that they are summed in pairs (eq:tree-sum). */
static const int CT_TANGENT_ROW[4] = {0, CT_ROWS ? 3 : 1, CT_ROWS ? 1 : 2, CT_ROWS ? 2 : 3};

/* Numbers of four rows in the order of the lanes, and back. */
#if CT_ROWS
#define CT_TANGENT_ACROSS(rows) CT_PICK(rows, rows, 0, 3, 1, 2)
#define CT_TANGENT_BACK(lanes) CT_PICK(lanes, lanes, 0, 2, 3, 1)
#else
#define CT_TANGENT_ACROSS(rows) (rows)
#define CT_TANGENT_BACK(lanes) (lanes)
#endif

/* Fill the lanes of the listed rows. Returns the largest e² of all (eq:slip-bound-couples). */
double ct_tangent_fill(const ct_tangent *tangent);

/* `out` = motion of each point relative to its partner, in the plane of contact, for a vector at
 * nodes; 0 in groups that do not press. */
void ct_tangent_motion(const ct_tangent *tangent, const double *x, const ct_columns *out);

/* Add to some components of the sums at nodes those of the other pieces. */
void ct_tangent_join(ct_solver *solver, int first, int some);

/* Clear the sums of forces at the nodes on which rows act. */
void ct_tangent_clear(const ct_tangent *tangent);

/* `moved` = motion of the nodes by the forces T, if it is not current. Returns 0 if they are not
 * finite. */
int ct_tangent_push(ct_solver *solver);

/* `drift` = this motion of all nodes of the solver, after the solution; of pieces and of rigid
 * bodies these are more than those of the rows. */
int ct_tangent_push_all(ct_solver *solver);

/* Write the sums of the forces T at nodes for those who have listed the rows. */
void ct_tangent_give(ct_solver *solver);

/* `image` = W times the forces T, if it is not current, as `ct_tangent_motion`. Returns 0 if they
 * are not finite. */
int ct_tangent_apply(ct_solver *solver);

/* The same in the groups that do not press, if gaps follow the forces; it is known if their motion
 * is not, which then was shortened. */
void ct_tangent_apply_rest(const ct_tangent *tangent);

/* The bound of each row of W becomes `scale`, to be widened (eq:slip-bound, eq:slip-bound-couples).
 * Returns 0 if it is not finite. */
int ct_tangent_bound(ct_solver *solver);

#endif
