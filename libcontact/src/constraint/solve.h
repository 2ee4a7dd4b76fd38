#ifndef CT_SRC_ENFORCEMENT_SOLVE_H
#define CT_SRC_ENFORCEMENT_SOLVE_H

#include <libcontact/step.h>

/* Room to find the forces of all constraints of a problem together. */
typedef struct ct_solver {
  int64_t room;         /* most constraints of all effects */
  ct_constraint *list;  /* those of one effect after those of another */
  ct_constraint *sizes; /* the same with sizes in the place of directions and factors */
  int64_t *first;       /* of each effect in `list`, shape (effect_count + 1) */
  int32_t **place;      /* of each effect with constraints or a path: the place of each of its nodes
                           among the solver's, or -1 */
  int32_t node_count;   /* nodes on which constraints can act, ascending */
  int32_t *nodes;
  double
      *way; /* u_{n+1} - u_n without the constraints, shape (node_count, 4) with a zero as fourth */
  double *mobility; /* how far a force moves a degree of freedom until t_{n+1}, likewise */
  double *past;     /* u_n - u_{n-1}, likewise */
  int32_t *entries; /* how many constraints act on each node */
  int32_t crowd;    /* the largest of these numbers */
  double *push;     /* sums of forces, likewise, and then the way that they add */
  int64_t count;    /* constraints that are near enough to press */
  int64_t *active;  /* their numbers in `list` */
  int32_t *slot;    /* places of their nodes, shape (room, 16) */
  int controlled;   /* whether all of them are energy-controlled */
  double *law;      /* then: their stiffness, dissipation and gap, shape (3, room) */
  double *free,
      *bound; /* their gaps at t_{n+1} without the constraints, and bounds of the rows of W */
  double *guess,
      *force;      /* from where the next round starts, and the forces that the last one gave */
  double *path;    /* ways of one effect's nodes; null when no effect takes any along a path */
  double *terms;   /* two numbers each */
  uint64_t *begun; /* a bit a node of the problem: a force of a constraint begins there at t = 0
                      (eq:energy-start) */
  int iterations;  /* of the last solution */
  int converged;   /* whether it met the tolerance */
} ct_solver;

/* Make room for a problem's constraints; `*out` stays null when no effect has any. */
ct_status ct_solver_create(const ct_problem *problem, ct_solver **out);
void ct_solver_free(const ct_problem *problem, ct_solver *solver);

/* List the constraints of all effects and find their forces, given the sum of all other forces
 * (eq:constraint-problem). */
ct_status ct_solver_solve(const ct_problem *problem, ct_state *state, ct_error *error);

#endif
