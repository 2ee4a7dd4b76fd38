#ifndef CT_SRC_CONSTRAINT_TANGENT_LAWS_H
#define CT_SRC_CONSTRAINT_TANGENT_LAWS_H

#include "tangent_rows.h"

/* The laws of the listed rows (eq:slip-residual). Returns 0 if they are not finite. */
int ct_tangent_fix_laws(ct_solver *solver);

/* The sets of the listed rows without their limits (eq:slip-set). */
void ct_tangent_fix_chords(const ct_tangent *tangent);

#endif
