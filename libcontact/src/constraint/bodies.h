#ifndef CT_SRC_CONSTRAINT_BODIES_H
#define CT_SRC_CONSTRAINT_BODIES_H

#include "solve.h"

/* Rigid bodies among the solver's nodes. A force on one of their nodes moves all of them, so the
 * matrix A has a full block for each body (eq:rigid-mobility); their entries of `mobility` are 0.
 */
typedef struct ct_bodies {
  int32_t count;
  double (*translation)[3]; /* of each body by a unit force, and its turn by a unit moment in the
                               order xx yy zz xy yz zx */
  double (*rotation)[6];
  double *most;       /* bound of the former */
  int32_t *of;        /* body of each of the solver's nodes, or -1 */
  double *arm;        /* r of each of the solver's nodes, shape (node_count, 3) */
  int32_t *first;     /* begin of each body in `terms` */
  int32_t *filled;    /* number of its terms */
  double *terms;      /* memory, shape (6, node_count) */
  int32_t node_count; /* of the solver */
  double (*push)[6];  /* force and moment on each body, or bounds of their sizes */
  double (*sum)[6];   /* memory */
} ct_bodies;

/* Memory for `count` bodies, of which `of` lists the nodes, from the pool of the solver, which may
 * fail. */
ct_bodies *ct_bodies_create(ct_solver *solver, int32_t count, const int32_t *of);

/* The bounds of the mobilities of all bodies, once these are known. */
void ct_bodies_bound(ct_bodies *bodies);

/* Sum the forces at some places of nodes for each body, of vectors or, with a normal, of fourth
 * components along it. */
void ct_bodies_push(ct_bodies *bodies, int32_t count, const int32_t *place, const double *normal,
                    const double *sums);

/* Write the motion of the nodes of bodies by these forces; with a normal also along it. */
void ct_bodies_move(const ct_bodies *bodies, int32_t count, const int32_t *place,
                    const double *normal, double *moved);

/* The same for sizes, fourth components that are not negative. */
void ct_bodies_push_sizes(ct_bodies *bodies, int32_t count, const int32_t *place,
                          const double *sums);
void ct_bodies_move_sizes(const ct_bodies *bodies, int32_t count, const int32_t *place,
                          double *moved);

#endif
