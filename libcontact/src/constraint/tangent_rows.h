#ifndef CT_SRC_CONSTRAINT_TANGENT_ROWS_H
#define CT_SRC_CONSTRAINT_TANGENT_ROWS_H

#include "../base/grid.h"
#include "slip.h"
#include "solve.h"

/* The rows of the tangential forces (eq:slip-row). Their numbers stand side by side, row after row,
 * one array for each component. */

enum { CT_TANGENT_CUT = 2 * CT_SOLVER_WIDE }; /* numbers of a node in `cut` */

/* A vector of each row. */
typedef struct ct_columns {
  double *x[3];
} ct_columns;

/* Consecutive rows with friction that have the same nodes. */
typedef struct ct_tangent_group {
  int64_t first;            /* row */
  const int32_t *place;     /* of the nodes in vectors at nodes */
  int32_t rows, own, other; /* numbers of rows, and of nodes of both faces */
  int8_t together;          /* whether they are four rows that are computed side by side */
  int8_t presses; /* whether a limit is or was above 0 in this step; other rows have no force */
} ct_tangent_group;

typedef struct ct_tangent {
  int64_t count;
  ct_constraint **rows;
  int64_t group_count;
  ct_tangent_group *groups;
  int32_t node_count, *nodes;   /* places of the nodes on which these rows act */
  int32_t most_row_count;       /* largest number of rows at a node */
  double *sums, *moved;         /* as of the solver, of the tangential forces */
  ct_grid grid;                 /* of the last forces whose motion was found, ... */
  double *cut;                  /* ... and their sums at `nodes`: four components of the coarse
                                   grid, and four of the fine one; else 0 */
  double *pressed;              /* motion of the nodes by the normal forces, if these have several
                                   directions and it matters */
  double *drift;                /* displacement increment without friction */
  double *lanes;                /* the numbers of four rows side by side, for each of them
                                   CT_TANGENT_LANES */
  double *size;                 /* β of the nodes of each row, CT_ROW_NODES (eq:slip-bound) */
  double *own[CT_SLIP_GIVEN];   /* memory for the numbers of the points, ... */
  double *given[CT_SLIP_GIVEN]; /* ... in use for T, and for others that do not stand side by side;
                                   the next nine refer to them */
  ct_columns normal;            /* unit normal */
  ct_columns e, e0;             /* elastic slips e_n and e_{n-1} */
  ct_columns T;                 /* the forces */
  ct_columns was_image;         /* W T of the last step */
  double *was_opened;           /* the gaps that its forces opened */
  double *k, *reserve, *stuck;  /* stiffness; R of the last step; 1 where the point stuck in it */
  ct_columns image;             /* W times the forces */
  double *opened;               /* the gaps that the forces open */
  ct_columns last;              /* motion D₋ of the last step */
  ct_columns end;               /* e_{n+1} */
  ct_columns q;                 /* D without friction + e_n + κ e_{n-1} */
  ct_columns slip;              /* the slip of the step (eq:slip-residual) */
  ct_columns T0, slip0;         /* forces and slips of the last round */
  ct_columns aim, next;         /* a force before and after its projection */
  ct_columns c;                 /* slip of the last step, of the sets (eq:slip-set) */
  double *limit, *most;         /* of the sets */
  double *C, *kappa;            /* of the laws (eq:slip-residual) */
  double *mu;                   /* coefficients of friction */
  double *zeta;                 /* damping ratios of the laws' dashpots, of rows that are not the
                                   active ones */
  double *work, *lag;           /* of the forces of this step, as of ct_slip */
  double *loss;                 /* S₋ - S₊ - W without the next reserve */
  double lost;                  /* their sum */
  double *wanted;               /* this reserve; -1 where the point sticks */
  double *scale;                /* 1 / D (eq:slip-bound) */
  double couple;                /* the largest e² of all rows (eq:slip-bound-couples) */
  double widening;              /* factor of the bounds for the couples (eq:slip-bound-couples) */
  double *terms;                /* a number per row */
  double *shift;                /* of the gaps of active rows by tangential forces */
  int some_move;                /* whether there are rows of obstacles that move */
  int one_run;                  /* whether the points of all rows stand side by side */
  int some;                     /* whether any piece has rows */
  int active;                   /* whether they are the active rows, in all pieces */
  int coupled;          /* whether normal and tangential forces change each other's motion */
  int pushed;           /* whether `cut` and `moved` are those of T */
  int current;          /* whether `image` is that of T */
  int allowed;          /* whether all forces are known to be in their sets */
  int shifted;          /* whether `shift` is that of T */
  double top;           /* the largest limit */
  double most_force;    /* a bound of the components of the forces, of all pieces */
  double size_of_force; /* the largest force, at least a small share of this limit */
  double lowest;        /* lower bound of the eigenvalues of D⁻¹ (W + C) */
  double tolerance;     /* of the forces */
  int most_rounds;
} ct_tangent;

/* Set a vector of row j, and read it. */
static inline void ct_columns_set(const ct_columns *of, int64_t j, const double v[3])
{
  for (int c = 0; c < 3; c++) of->x[c][j] = v[c];
}

static inline void ct_columns_get(const ct_columns *of, int64_t j, double v[3])
{
  for (int c = 0; c < 3; c++) v[c] = of->x[c][j];
}

/* The product of two vectors of row j. */
static inline double ct_columns_dot(const ct_columns *a, const ct_columns *b, int64_t j)
{
  return (a->x[0][j] * b->x[0][j] + a->x[1][j] * b->x[1][j]) + a->x[2][j] * b->x[2][j];
}

/* Number of rows from row j on whose points stand side by side. */
int64_t ct_tangent_run(const ct_tangent *tangent, int64_t j);

/* Take the motion of the obstacles, since the last step or until the next one, off that of the
 * points. */
void ct_tangent_take_off(const ct_tangent *tangent, int next, const ct_columns *motion);

/* List the active rows with friction, and those with a given force, with the force of the guess;
 * the points of other rows are open. */
void ct_tangent_list(ct_solver *solver);

/* Find the motion D₋ of the last step, along the present rows (eq:slip-set). */
void ct_tangent_find_last(ct_solver *solver);

#endif
