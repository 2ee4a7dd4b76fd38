#ifndef CT_SRC_SOLID_BELOW_H
#define CT_SRC_SOLID_BELOW_H

#include "../mesh/mass.h"
#include "kernel.h"

/* Test which elements of an undeformed, fully integrated body certainly have all eigenvalues of
 * M⁻¹K below a number: without the eigenvalues, eight elements at a time. */

/* The element whose eigenvalues have the largest sum: one of the stiffest. */
int32_t ct_solid_stiffest(const ct_solid_part *part, const ct_mass_shapes *at);

/* Bit l is 1 if all eigenvalues of element e + l, one per lane, are certainly below
 * `omega_squared`; components `fixed` do not move (eq:definite). */
unsigned ct_solid_below(const ct_solid_part *part, const ct_mass_shapes *at, int32_t e,
                        const int fixed[3], double omega_squared);

#endif
