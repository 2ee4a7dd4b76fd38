#ifndef CT_SRC_OBSTACLE_H
#define CT_SRC_OBSTACLE_H

#include "contact_internal.h"

/* What the shapes of obstacles differ in. */
typedef struct ct_obstacle_kind {
  const char *name, *direction; /* of its axis; null: it has none */
  int is_round;                 /* whether it has a radius, and stations if that is small */
  /* Signed distance of a place `r` relative to the obstacle, negative inside, and the unit normal
   * out of it (eq:obstacle-gap); NaN at the centre of a sphere and on the axis of a cylinder. */
  double (*gap)(double radius, const double axis[3], const double r[3], double n[3]);
} ct_obstacle_kind;

/* Constant data of an obstacle. Side 0 is the surface; side 1, if there is one, has the stations of
 * a sphere or cylinder that is smaller than the faces: places on its centre or axis, each with a
 * row at the closest place of the surface (eq:station-gap). In each point `d` leads to the closest
 * point of the obstacle; `other` of a point of the surface is 0, or -1 if the obstacle has passed
 * it; `other` and `xi` of a station are its closest place on the surface. */
typedef struct ct_obstacle {
  ct_contact_fixed contact;
  ct_obstacle_def given; /* with an axis of length 1 */
  const ct_obstacle_kind *kind;
  double *time, *value;   /* of the amplitude */
  double *springs;        /* row sums of the stiffness with all points inside */
  double station_spacing; /* along the axis; 0: one station */
  double station_area;    /* of a station: that of a mean face */
  ct_carrier carrier;     /* if a rigid body carries it */
} ct_obstacle;

static inline const ct_obstacle *ct_obstacle_of(const ct_contact *contact)
{
  return (const ct_obstacle *)contact->fixed;
}

/* The row of a shape, null if there is none. */
const ct_obstacle_kind *ct_obstacle_kind_of(ct_obstacle_shape shape);

/* Make the length of an axis 1; returns 0 if it has no direction. */
int ct_obstacle_axis(const double axis[3], double a[3]);

/* Position of the obstacle at a time, relative to `point` at t = 0 (eq:obstacle-motion). */
void ct_obstacle_motion(const ct_obstacle_def *obstacle, double time, double motion[3]);

/* Stations of an obstacle at its surface, none if it is large, and its largest safe approach; their
 * part of its row sums of stiffness at a node (eq:station-bound). */
ct_status ct_stations_init(ct_obstacle *obstacle, ct_error *error);
double ct_stations_springs(const ct_obstacle *obstacle);

/* The stations of a state: allocate; and find the gaps of those near the surface, which change by
 * at most `motion` in a step. */
ct_status ct_stations_open(ct_contact *contact);
void ct_stations_meet(ct_contact *contact, double motion, int first);

#endif
