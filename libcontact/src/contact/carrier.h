#ifndef CT_SRC_CARRIER_H
#define CT_SRC_CARRIER_H

#include "interaction.h"

enum { CT_CARRIER_NODES = 8 };

/* What carries an obstacle with mass: nodes of a rigid body, with which every place of the body
 * moves by weights that are linear in the place (eq:carrier-weights). */
typedef struct ct_carrier {
  int32_t place[CT_CARRIER_NODES]; /* of the nodes, in the list of the interaction */
  double reference[CT_CARRIER_NODES][3];
  double point[CT_CARRIER_NODES];   /* weights of the obstacle's position */
  double dual[CT_CARRIER_NODES][3]; /* q of the reference shape */
} ct_carrier;

/* The same at a time. */
typedef struct ct_carried {
  double x[CT_CARRIER_NODES][3], velocity[CT_CARRIER_NODES][3];
  double centre[3];                 /* mean of x */
  double dual[CT_CARRIER_NODES][3]; /* q with the weights 1/8 + q · (x - c) */
  double turn[3][3];                /* from the reference shape: column i is where axis i points */
  double speed[3], gradient[3][3];  /* velocity at c, and its gradient */
  double before;                    /* Δt of the last step */
  double (*weights)[CT_CARRIER_NODES]; /* of the points that have rows */
} ct_carried;

/* Constant data of nodes with some reference coordinates that carry a point. Returns 0 if they lie
 * in a plane. */
int ct_carrier_init(ct_carrier *carrier, const double point[3]);

/* Position, turn and velocity of the carrier from those of its nodes, or in the reference shape if
 * `now` has no coordinates; and the position of the obstacle. */
void ct_carrier_move(const ct_carrier *carrier, const ct_surface_motion *now, ct_carried *state,
                     double place[3]);

/* Velocity of the carrier at a place, and weights at a place `r` relative to its centre. */
void ct_carrier_velocity(const ct_carried *state, const double x[3], double velocity[3]);
void ct_carrier_weigh(const ct_carried *state, const double r[3], double weights[CT_CARRIER_NODES]);

/* Add what acts against the forces on `count` nodes with the coordinates `x` to the nodes of the
 * carrier; `place` and `force` as in the interaction, `terms` has room for one number per node. */
void ct_carrier_react(const ct_carrier *carrier, const ct_carried *state, int32_t count,
                      const int32_t *place, const double *x, double *terms, double *force);

#endif
