#ifndef CT_SRC_CONSTRAINT_TANGENT_ROWS_H
#define CT_SRC_CONSTRAINT_TANGENT_ROWS_H

#include "slip.h"
#include "solve.h"

/* The rows of the tangential forces and their products (eq:slip-row). */

/* One row with friction. */
typedef struct ct_tangent_row {
  ct_constraint *row;
  ct_slip *slip;
  const int32_t *place; /* of its nodes in vectors at nodes */
  int32_t alike;        /* number of rows from this one on with the same nodes, at least 1 */
  ct_slip_law law;
  ct_slip_set set;
  double scale;                 /* 1 / D (eq:slip-bound) */
  double size[CT_ROW_NODES];    /* β of each node (eq:slip-bound) */
  double last[CT_SOLVER_WIDE];  /* D₋ */
  double q[CT_SOLVER_WIDE];     /* D without friction + e_n + κ e_{n-1} */
  double T[CT_SOLVER_WIDE];     /* the force */
  double at[CT_SOLVER_WIDE];    /* where the gradient is evaluated (eq:slip-iteration) */
  double next[CT_SOLVER_WIDE];  /* the force of the next round */
  double image[CT_SOLVER_WIDE]; /* W times a force */
} ct_tangent_row;

typedef struct ct_tangent {
  int64_t count;
  ct_tangent_row *rows;
  int32_t node_count, *nodes; /* places of the nodes on which these rows act */
  int32_t most_row_count;     /* largest number of rows at a node */
  double *sums, *moved;       /* as of the solver, of the tangential forces */
  double *drift;              /* displacement increment without friction */
  double *terms;              /* a number per row */
  double *shift;              /* of the gaps of active rows by tangential forces */
  int some;                   /* whether any piece has rows */
  int current;                /* whether `image` and `shift` are those of T */
  double top;                 /* the largest limit */
  double size;                /* the largest force, at least a small share of this limit */
  double rate;                /* of the iteration */
  double tolerance;           /* of the forces */
  int most_rounds;
} ct_tangent;

/* List the active rows with friction, and those with a given force, with the motion of the last
 * step and the force of the guess; the points of other rows are open. */
void ct_tangent_list(ct_solver *solver);

/* `image` = W times the forces T, or times those of `at`. Returns 0 if they are not finite. */
int ct_tangent_apply(ct_solver *solver, int at);

/* The bound D of each row of W (eq:slip-bound) becomes `scale`. Returns 0 if it is not finite. */
int ct_tangent_bound(ct_solver *solver);

/* `q` = motion of each point relative to its partner, in the plane of contact, for a vector at
 * nodes. */
void ct_tangent_motion(ct_tangent *tangent, const double *x);

#endif
