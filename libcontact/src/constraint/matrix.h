#ifndef CT_SRC_CONSTRAINT_MATRIX_H
#define CT_SRC_CONSTRAINT_MATRIX_H

#include "solve.h"

/* The matrix G of the listed rows, whose entries are b_a n (eq:constraint-force), and its products
 * with vectors. */

/* Whether four rows are the points of a 2 x 2 rule in their order: the first and the last are
 * opposite each other, unlike four of more points in a row. */
static inline int ct_rows_are_square(ct_constraint *const *row)
{
  const double *first = row[0]->own_shape, *last = row[3]->own_shape;
  // Their weights follow on each other; those of other points do not.
  return last - first == 24 && first[0] == last[2] && first[1] == last[3];
}

/* The groups of all listed rows, their numbers, and the places of their nodes, which become the
 * active ones. The rows of a few faces at a time are read once, for their laws, too. */
void ct_matrix_fill(ct_solver *solver);

/* Count the rows at each node, and list the nodes with rows; and the groups that are alike. */
void ct_matrix_count(ct_solver *solver);

/* Whether G may be that of the next step, too: over other faces the weights of a row change. */
int ct_matrix_stays(const ct_solver *solver);

/* Add a row of a group as the last active one. */
void ct_matrix_add(ct_solver *solver, const ct_group *of, int64_t row);

/* List the nodes on which the active rows act, after their groups are chosen. */
void ct_matrix_choose(ct_solver *solver);

/* `out` = G times a vector at nodes, of the first `count` rows. */
void ct_matrix_times(const ct_solver *solver, int64_t count, const double *x, double *out);

/* The same of the rows of a group, unless none of its nodes moves, which is returned as 0. */
int ct_matrix_times_group(const ct_solver *solver, const ct_group *of, const double *x,
                          double *out);

/* The same for a motion of the nodes, whose fourth components may be overwritten. */
void ct_matrix_motion(const ct_solver *solver, int64_t count, double *x, double *out);

/* `out` = W times forces of the active rows, whose bounds are known (eq:constraint-problem).
 * Returns 0 if they are not finite. */
int ct_matrix_apply(ct_solver *solver, const double *force, double *out);

/* `moved` = A Gᵀ times forces of the active rows, at their nodes or at all nodes of the solver; of
 * pieces these are more than the nodes of this piece's rows. Returns 0 if they are not finite. */
int ct_matrix_push(ct_solver *solver, const double *force);
int ct_matrix_push_all(ct_solver *solver, const double *force);

/* `total` = `moved` at the nodes of active rows, or plus this times a number. */
void ct_matrix_take(const ct_solver *solver, double *total);
void ct_matrix_follow(const ct_solver *solver, double share, double *total);

/* Add to some components of the sums at nodes those of the other pieces, for the nodes that active
 * rows of this one and of others share; `joined` is free until then, with as many numbers. */
void ct_matrix_join(const ct_solver *solver, int first, int some, double *sums, double *joined);

/* `moved` = A times the sums of forces at some places of nodes; the sums are then cleared. */
void ct_matrix_move(const ct_solver *solver, int32_t count, const int32_t *place, double *sums,
                    double *moved);

/* An upper bound of Σ_k |W_jk| of each active row j, over the rows k from those of a group on, the
 * first being 0 (eq:constraint-bound). Over all rows `gaps` becomes W times the present forces,
 * too, unless a rigid body moves nodes. Returns 0 if these numbers are not finite. */
int ct_matrix_bound(ct_solver *solver, int64_t from, double *gaps, double *out);

#endif
