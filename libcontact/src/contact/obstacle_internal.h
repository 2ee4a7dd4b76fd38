#ifndef CT_SRC_OBSTACLE_INTERNAL_H
#define CT_SRC_OBSTACLE_INTERNAL_H

#include "side.h"

/* The points of an obstacle effect of one state, and where the obstacle is. In each point `d` leads
 * to the nearest point of the obstacle, `other` is 0 where the point is inside and -1 elsewhere. */
typedef struct ct_obstacle_points {
  ct_side side;
  double place[3];    /* the obstacle's point now */
  double reaction[3]; /* force of the bodies on it */
  double work;        /* of its motion since t = 0 */
  double epsilon;
  double held;   /* energy of the constraints */
  double *terms; /* three numbers a point */
} ct_obstacle_points;

/* Bound of ω² of an obstacle effect's points as springs, whatever the enforcement. */
ct_status ct_obstacle_spring_frequency(const ct_effect *effect, const void *scratch,
                                       double *omega_squared, ct_error *error);

const ct_obstacle_points *ct_obstacle_of_scratch(const void *scratch);

#endif
