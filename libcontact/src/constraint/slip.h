#ifndef CT_SRC_CONSTRAINT_SLIP_H
#define CT_SRC_CONSTRAINT_SLIP_H

#include <math.h>
#include <stdint.h>

/* Coulomb friction at a point in one step: a spring between the two surfaces, whose force stays in
 * a disc, and a reserve of energy that bounds what friction may give back (eq:slip-law). */

/* A vector at a point has a fourth component, 0, so that it fills a register. */
typedef struct ct_slip {
  /* Written by the effect that lists the row. */
  double mu;           /* coefficient of friction */
  double k;            /* stiffness of the tangential spring [force / length] */
  double lever[4];     /* d = ȳ - y, from the point to its partner */
  double weight[8][4]; /* w_b: the force T adds -(w_b · T) d on node b of the partner
                          (eq:slip-row) */
  double came[3];      /* motion of an obstacle since the last step, if it `moves` */
  double coming[3];    /* and until the next one */
  int moves;           /* whether the point meets an obstacle that moves */
  int stuck;           /* whether the point stuck in the last step; the solver replaces it */
  double e[3];         /* elastic slip e_n; the solver replaces it with e_{n+1} */
  double before[3];    /* e_{n-1}; the solver replaces it with e_n */
  double reserve;      /* R of the last step; the solver replaces it with that of this one */
  double force[4];     /* where the iteration begins; the solver replaces it with T, the force on
                          the point's own face */
  int64_t place;       /* of its row's nodes in the solver's list; the solver writes it */
  /* Written by the solver; all 0 if the point has no normal force. */
  double work; /* of T between the middles of two steps (eq:slip-work) */
  double lag;  /* correction of the leapfrog's energy at t_n by T (eq:slip-held) */
} ct_slip;

/* A point without a normal force: its spring is empty, as that of a new point. */
void ct_slip_open(ct_slip *slip);

/* The allowed forces of a step: |T| <= limit and T · c <= most (eq:slip-set). */
typedef struct ct_slip_set {
  double limit, most, c[3];
} ct_slip_set;

/* The factor of a force with the square `size2` that shortens it to a limit. */
static inline double ct_slip_part(double limit, double size2)
{
  const double size = sqrt(size2), most = size > limit ? size : limit;
  // 1 where the limit is larger; without a branch
  return limit / (most + (most == 0.0 ? 1.0 : 0.0));
}

/* The force of a set that is closest to `T`. */
void ct_slip_project(const ct_slip_set *set, double T[3]);

/* Energy S of the spring and the reserve at the middle of a step (eq:slip-store). */
double ct_slip_stored(const ct_slip *slip);

#endif
