#ifndef CT_SRC_SOLID_BELOW_H
#define CT_SRC_SOLID_BELOW_H

#include "../mesh/mass.h"
#include "kernel.h"

/* Which elements of an undeformed body, integrated in full, surely have all eigenvalues of M⁻¹K
 * below a number: without the eigenvalues, eight elements at a time. */

/* The element whose eigenvalues have the largest sum: one of the stiffest. */
int32_t ct_solid_stiffest(const ct_solid_part *part, const ct_mass_shapes *at);

/* Bit l is 1 where all eigenvalues of element e + l, for as many as there are lanes, are surely
 * below `omega_squared`; components `held` do not move (eq:definite). */
unsigned ct_solid_below(const ct_solid_part *part, const ct_mass_shapes *at, int32_t e,
                        const int held[3], double omega_squared);

#endif
