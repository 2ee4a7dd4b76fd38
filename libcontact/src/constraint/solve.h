#ifndef CT_SRC_CONSTRAINT_SOLVE_H
#define CT_SRC_CONSTRAINT_SOLVE_H

#include <libcontact/constraint.h>

/* Rows of one effect; its nodes are numbers of the problem, ascending. */
typedef struct ct_row_set {
  int64_t most;         /* rows that it can list */
  int32_t node_count;   /* nodes of the effect ... */
  const int32_t *nodes; /* ... in the problem; null: all */
} ct_row_set;

/* Two places of one node of the problem, which is in the lists of several effects. */
typedef struct ct_shared_node {
  int32_t first, copy;
} ct_shared_node;

/* Room to find the forces of all constraints of a problem together. Its nodes are those of one
 * effect after those of another; vectors at nodes have a fourth component, 0, so that they fill a
 * register. */
typedef struct ct_solver {
  int32_t set_count;
  int64_t most;         /* rows of all sets */
  ct_constraint **rows; /* those listed: of one set after those of another */
  int64_t *first;       /* of each set in `rows`, shape (set_count + 1) */
  int32_t *first_node;  /* of each set, shape (set_count + 1) */
  int32_t node_count;   /* of all sets */
  int32_t *nodes;       /* their numbers in the problem */
  int32_t shared_count; /* nodes that are in more than one set */
  ct_shared_node *shared;
  double *increment;      /* u_{n+1} - u_n without the constraints, shape (node_count, 4) */
  double *mobility;       /* how far a force moves a degree of freedom until t_{n+1}, likewise */
  double share;           /* of the mobility in a step that does not begin at t = 0 */
  double *past;           /* u_n - u_{n-1}, likewise */
  double *moved;          /* sums of forces, likewise, and then the displacement that they add */
  int32_t *entries;       /* how many rows act on each node */
  int32_t crowd;          /* the largest of these numbers */
  int64_t count;          /* rows that are near enough to be active */
  ct_constraint **active; /* these rows */
  int64_t *first_active;  /* of each set in `active`, shape (set_count + 1) */
  double *C, *b;          /* their laws: compliance, and what the next gap counts from (eq:ramp) */
  double *free;           /* gaps at t_{n+1} without the constraints */
  double *force;          /* λ */
  double *rest;           /* g_{n+1} + b + C λ, the slope of the function to be made least */
  double *scale;          /* D of the rows, which bounds W + C (eq:constraint-bound) */
  double *way;            /* direction of the search */
  double *answer;         /* (W + C) times it */
  double *terms;          /* of a sum */
  int iterations;         /* of the last solution */
  int converged;          /* whether it met the tolerance */
} ct_solver;

enum { CT_SOLVER_WIDE = 4 };

/* Make room for some sets of rows. `place` has room for a number for each of the problem's nodes,
 * and becomes the first place of each among the solver's nodes, or -1. To be freed also when this
 * fails. */
ct_status ct_solver_create(const ct_row_set *sets, int32_t count, int32_t problem_nodes,
                           int32_t *place, ct_solver **out);
void ct_solver_free(ct_solver *solver);

/* Find the forces of the listed rows together (eq:constraint-problem), given `increment`,
 * `mobility` and `past`, which are complete at the first places of nodes. Answers 0 when they are
 * not finite.
 */
int ct_solver_solve(ct_solver *solver);

#endif
