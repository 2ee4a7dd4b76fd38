#ifndef CT_SRC_CONTACT_INTERNAL_H
#define CT_SRC_CONTACT_INTERNAL_H

#include "side.h"

struct ct_contact {
  ct_contact_options options;
  double depth; /* deepest point that is in contact */
  double skin;  /* how far beyond the depth candidates are listed */
  int built;    /* whether the candidate lists exist */
  double clear; /* not 0: when they were made, no two faces were nearer than the depth plus this (eq:contact-clear) */
  int sides;    /* 2, or 1 for the contact of a surface with itself */
  int one_array; /* whether the nodes of both sides are numbered in one array of the host */
  ct_side side[2];
  double *terms; /* room for sums, three numbers a point */
};

/* The contact inside the scratch of a contact effect. */
const ct_contact *ct_contact_of_scratch(const void *scratch);

#endif
