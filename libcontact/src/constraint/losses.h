#ifndef CT_SRC_CONSTRAINT_LOSSES_H
#define CT_SRC_CONSTRAINT_LOSSES_H

#include "solve.h"

/* Gaps at t_{n+1} of some rows, from the gradient. */
void ct_find_after(int64_t count, const double *gradient, const double *b, const double *C,
                   const double *force, double *after);

/* Whether the rows of each set together lose energy, to rounding: then the energy of the bodies and
 * of the rows does not grow, whatever the forces are (eq:energy-stop). Writes `after`, and what the
 * points store then. */
int ct_loses_energy(ct_solver *solver);

#endif
