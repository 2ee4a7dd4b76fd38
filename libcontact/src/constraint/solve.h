#ifndef CT_SRC_CONSTRAINT_SOLVE_H
#define CT_SRC_CONSTRAINT_SOLVE_H

#include <libcontact/constraint.h>

#include "../base/memory.h"

/* Rows of one effect; its nodes are numbers of the problem, ascending. */
typedef struct ct_row_set {
  int64_t most;         /* rows that it can list */
  int32_t node_count;   /* nodes of the effect ... */
  const int32_t *nodes; /* ... in the problem; null: all */
  int32_t row_nodes;    /* most nodes of a row, both faces together */
} ct_row_set;

/* Vectors at nodes have a fourth component, 0, so that they fill a register; a row has at most 16
 * nodes. */
enum { CT_SOLVER_WIDE = 4, CT_ROW_NODES = 16 };

/* Where the entries b_a n of a row of G stand: those of its own face, then those of the other; and
 * where the places of their nodes begin, which rows one after another with the same nodes share. */
typedef struct ct_entries {
  int64_t first, place;
  int32_t own, other;
  int32_t alike; /* how many rows from this one on have the same nodes, at least 1 */
} ct_entries;

/* Room to find the forces of all constraints of a problem together. Its nodes are those of all
 * effects, each of them once. */
typedef struct ct_solver {
  ct_pool pool;
  int32_t set_count;
  int64_t most;         /* rows of all sets */
  ct_constraint **rows; /* those listed: of one set after those of another */
  int64_t *first;       /* of each set in `rows`, shape (set_count + 1) */
  int32_t node_count;
  int32_t *nodes;      /* their numbers in the problem */
  int32_t *first_node; /* of each set in `place`, shape (set_count + 1) */
  int32_t *place;      /* of the nodes of one set after those of another, among the solver's */
  double *increment;   /* u_{n+1} - u_n without the constraints, shape (node_count, 4) */
  double *mobility;    /* how far a force moves a degree of freedom until t_{n+1}, likewise */
  double share;        /* of the mobility in a step that does not begin at t = 0 */
  double *past;        /* u_n - u_{n-1}, likewise */
  double *sums;        /* of forces, likewise; 0 between two uses */
  double *moved;       /* the displacement that they add, likewise */
  int32_t *crowd;      /* how many rows act on each node */
  int32_t most_crowd;  /* the largest of these numbers */
  int32_t touched_count;
  int32_t *touched;    /* the nodes on which active rows act, as `entry_place` */
  ct_entries *entries; /* of the listed rows, and then of those that are near enough to be active */
  double *G;           /* the entries, shape (any number, 4) */
  int32_t *entry_place;   /* where their nodes begin in vectors at nodes */
  int64_t count;          /* active rows */
  ct_constraint **active; /* these rows */
  double *C, *b;          /* their laws: compliance, and what the next gap counts from (eq:ramp) */
  double *free;           /* gaps at t_{n+1} without the constraints */
  double *force;          /* λ */
  double *rest;           /* g_{n+1} + b + C λ, the slope of the function to be made least */
  double *scale;          /* 1 / D, a bound of the rows of W + C (eq:constraint-bound), or 0 */
  double *guide;          /* the slope over D in the rows that are pressed */
  double *way;            /* direction of the search */
  double *answer;         /* (W + C) times it */
  double *terms;          /* of a sum */
  int iterations;         /* of the last solution */
  int converged;          /* whether it met the tolerance */
} ct_solver;

/* Make room for some sets of rows. `place` has room for a number for each of the problem's nodes,
 * and becomes the place of each among the solver's nodes, or -1. To be given back by ct_pool_free,
 * also when this fails. */
ct_status ct_solver_create(const ct_row_set *sets, int32_t count, int32_t problem_nodes,
                           int32_t *place, ct_solver **out);

/* Find the forces of the listed rows together (eq:constraint-problem), given `increment`,
 * `mobility` and `past`. Answers 0 when they are not finite. */
int ct_solver_solve(ct_solver *solver);

#endif
