#ifndef CT_SRC_CONSTRAINT_SOLVE_H
#define CT_SRC_CONSTRAINT_SOLVE_H

#include <libcontact/constraint.h>

#include "../base/memory.h"
#include "../base/pieces.h"
#include "law.h"

/* Rows of one effect; its nodes are ascending numbers of the problem. */
typedef struct ct_row_set {
  int64_t most;         /* most rows */
  int32_t node_count;   /* nodes of the effect ... */
  const int32_t *nodes; /* ... in the problem; null: all */
  int32_t row_nodes;    /* largest number of nodes of a row, both faces together */
  int64_t slips;        /* most rows, of any set, to which this effect adds friction */
  int foreign;          /* whether a host fills the rows, who may change their laws, and lists of
                           nodes in place */
} ct_row_set;

/* Vectors at nodes have a fourth component, so that they fill a register: 0, or the part along the
 * one normal of all rows. A row has at most 16 nodes. */
enum { CT_SOLVER_WIDE = 4, CT_ROW_NODES = 16 };

/* Tolerances of the forces: the default; and the largest one that is so tight that energy is not
 * looked at. With a looser one the solver ends only if no energy appears (eq:force-tolerance,
 * eq:energy-stop). */
static const double CT_SOLVER_USUAL = 1e-4, CT_SOLVER_TIGHT = 1e-10;

/* The tolerance that a caller gives, 0 being the default; and whether it is allowed. */
static inline double ct_solver_tolerance(double given)
{
  return given == 0.0 ? CT_SOLVER_USUAL : given;
}

static inline int ct_solver_accepts(double given)
{
  return given == 0.0 || (given >= 1e-12 && given <= 0.1);
}

/* Consecutive rows of G with the same nodes, which share the list of their places. A row is b_a n;
 * in G it has its normal and an unused number, then b_a of the nodes of its own face and of the
 * other, each filled up to whole quads. Behind the rows of a face that meets another one with four
 * nodes, or none, these numbers follow again, those of the four rows side by side. Faces at a plane
 * share their numbers. */
typedef struct ct_group {
  int64_t first, place;          /* of its numbers and of its nodes */
  const int32_t *nodes, *others; /* of both faces, as a row has them */
  int8_t own, other;             /* nodes */
  int16_t face; /* whether the rows are the four points of a 2 x 2 rule in their order */
  int32_t rows;
  int32_t alike; /* groups from this one on that have the same four numbers */
} ct_group;

struct ct_tangent;
struct ct_bodies;

/* A layer of elements between two sets, and the time in which a wave crosses it and comes back
 * (eq:release-passed). */
typedef struct ct_layer {
  int32_t sets[2];
  double back;
} ct_layer;

/* Memory to solve for the forces of all constraints of a problem together. Its nodes are those of
 * all effects, each once. */
typedef struct ct_solver {
  ct_pool pool;
  int32_t set_count;
  int64_t most;         /* most rows of all sets */
  ct_constraint **rows; /* listed rows, set after set */
  int64_t *first;       /* of each set in `rows`, shape (set_count + 1) */
  int32_t node_count;
  int32_t *nodes;      /* their numbers in the problem */
  int32_t last_node;   /* the place of the largest of them */
  int32_t *first_node; /* of each set in `place`, shape (set_count + 1) */
  int32_t *place;      /* of the nodes of each set, set after set, among the solver's */
  double *increment;   /* u_{n+1} - u_n without the constraints, shape (node_count, 4) */
  double
      *mobility;   /* displacement of a degree of freedom by a unit force until t_{n+1}, likewise */
  double fraction; /* of the mobility in a step that does not begin at t = 0 */
  double dt;       /* of the next step */
  int starts;      /* whether there was no step before */
  int again;       /* whether the first step was already solved with v_0 */
  int read;        /* whether the listed rows were read for the solution that follows */
  int written;     /* whether the last solution has written to its rows, and none was read since */
  double *last_increment; /* u_n - u_{n-1}, likewise; at t = 0, Δt v_0 */
  double *sums;           /* of forces, likewise; 0 between two calls */
  double *moved;          /* displacement by these forces, likewise */
  int32_t *row_counts;    /* number of rows that act on each node */
  int32_t *told_counts;   /* the same when pieces have told each other last */
  int counted;            /* whether they, and the active nodes, are those of the groups */
  int foreign;            /* whether there is a set with foreign rows */
  int kept;               /* 1 if no listed row was dropped and none added; 2 if, besides, G, its
                             groups and nodes are those of the last step */
  int32_t most_row_count; /* the largest of these numbers */
  int32_t active_node_count;
  int32_t *active_nodes;   /* the nodes on which active rows act, as `entry_place` */
  int32_t *all_nodes;      /* all nodes, likewise */
  const ct_pieces *pieces; /* null: this solver has all rows */
  int32_t shared_count;
  int32_t *shared_nodes; /* the nodes on which active rows of several pieces act, likewise */
  int32_t own_shared_count, *own_shared; /* places in them of those with rows of this piece */
  double weight;                         /* the largest one of a node in a row, or 1 */
  int64_t group_count;
  ct_group *groups;       /* of the listed rows, and then of the active ones */
  ct_group *listed;       /* of the listed rows, while the active ones are chosen */
  const ct_group *every;  /* of the listed rows in this step: the former, if one was dropped */
  double *G;              /* the numbers of all rows */
  int along;              /* whether all rows have one normal; then vectors at nodes have their
                             part along it as the fourth component */
  double normal[3];       /* this normal */
  int32_t *entry_place;   /* begin of the places of their nodes in vectors at nodes */
  int64_t count;          /* active rows: of points, and then those of points that open */
  int64_t all_count;      /* those of all pieces */
  int64_t point_count;    /* active rows of points */
  int64_t *first_point;   /* of each set in the active rows, shape (set_count + 1) */
  int64_t *first_release; /* the same of points that open */
  ct_law_rows laws;       /* the numbers of these points */
  ct_constraint **active; /* the points of all active rows */
  int64_t dropped_count;
  int64_t *dropped; /* listed rows with a law that take no part in this step */
  int64_t *opened;  /* of each of the second rows: the row of its point */
  double *C, *b;    /* their laws: compliance, and offset of the next gap (eq:ramp) */
  double *free;     /* gaps at t_{n+1} without the constraints */
  double *force;    /* λ */
  double *least;    /* its least value: 0, or that of a tie (eq:tie-force) */
  double *gradient; /* g_{n+1} + b + C λ, the gradient of the function to be minimised */
  double *scale;    /* 1 / D, a bound of the rows of W + C (eq:constraint-bound), or 0 */
  double *bound, *bound_mobility; /* the bound of W, and the mobility with which it was computed */
  double *guide;                  /* gradient over D in rows with a force */
  double *direction;              /* direction of the search */
  double *image;                  /* (W + C) times it */
  double *terms;                  /* of a sum */
  double *after;                  /* next gaps with the present forces */
  double tolerance;           /* largest change of a force by a further step, as a fraction of the
                                 largest force; see CT_SOLVER_USUAL */
  int32_t layer_count;        /* layers of elements, ... */
  ct_layer *layers;           /* ... each of which passes the waves of two sets to the other */
  double *pressed;            /* of each set: its largest force of the last step */
  double *back;               /* of each set: that of its layer if the set behind it was pressed */
  struct ct_bodies *bodies;   /* null: no node belongs to a rigid body */
  struct ct_tangent *tangent; /* null: no friction */
  int applied;                /* whether `after` is W times the forces with which the solver begins
                               */
  int iterations;             /* of the last solution */
  int converged;              /* whether it met the tolerance */
  int judged;                 /* whether its energy was looked at last; then its next gaps and what
                                 the rows store are known */
} ct_solver;

/* Allocate for some sets of rows. `place`, one number per node of the problem, becomes the place of
 * each node among the solver's nodes, or -1. Free it with ct_pool_free, also if this fails. */
ct_status ct_solver_create(const ct_row_set *sets, int32_t count, int32_t problem_nodes,
                           int32_t *place, ct_solver **out);

/* Solve for the forces of the listed rows together (eq:constraint-problem), given `increment`,
 * `mobility` and `last_increment`. Returns 0 if they are not finite. */
int ct_solver_solve(ct_solver *solver);

/* Afterwards: write the motion of the nodes of rigid bodies by the forces of all rows, also
 * tangential ones, to `moved`. Returns 0 if these are not finite. */
int ct_solver_follow(ct_solver *solver);

#endif
