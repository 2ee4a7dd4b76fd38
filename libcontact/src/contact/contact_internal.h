#ifndef CT_SRC_CONTACT_INTERNAL_H
#define CT_SRC_CONTACT_INTERNAL_H

#include "side.h"

struct ct_contact {
  ct_contact_options options;
  double depth;  /* at the start points look as far, and are in contact down to here */
  double near;   /* how far points look afterwards (eq:contact-near) */
  double room;   /* the surfaces may come nearer by this in a step (eq:passage) */
  int begun;     /* whether the points have a history */
  int start;     /* whether this is t = 0 of a scene */
  double skin;   /* how far beyond that candidates are listed */
  int built;     /* whether the candidate lists exist; those of the start are not kept */
  double clear;  /* not 0: when they were made, no two faces were nearer than what points look plus
                    this (eq:contact-clear) */
  int sides;     /* 2, or 1 for the contact of a surface with itself */
  int one_array; /* whether the nodes of both sides are numbered in one array of the host */
  ct_side side[2];
  double *terms; /* room for sums of calls that may write, one number a point */
};

/* Gaps of all points at given coordinates, with the forces of the explicit penalty; and nodal
 * forces from those of the points. */
ct_status ct_contact_measure(ct_contact *contact, const double *xa, const double *xb,
                             ct_error *error);
ct_status ct_contact_collect(ct_contact *contact, ct_error *error);

/* How far the gap of two surfaces may be off because their coordinates are rounded. */
double ct_contact_rounding(const ct_contact *contact);

/* Find how far two surfaces may come nearer in a step; and refuse a step of length `dt` to `time`
 * that may have brought them nearer than that, with velocities in the numbering of `nodes`
 * (eq:passage). */
void ct_passage_init(ct_contact *contact);
ct_status ct_passage_check(const ct_contact *contact, const int32_t *nodes, const double *velocity,
                           double dt, double time, ct_error *error);

/* Bound of ω² of a contact effect's points as springs, whatever the enforcement. */
ct_status ct_contact_spring_frequency(const ct_effect *effect, const void *scratch,
                                      double *omega_squared, ct_error *error);

/* The contact inside the scratch of a contact effect. */
const ct_contact *ct_contact_of_scratch(const void *scratch);

#endif
