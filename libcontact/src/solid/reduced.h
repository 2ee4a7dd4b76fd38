#ifndef CT_SRC_SOLID_REDUCED_H
#define CT_SRC_SOLID_REDUCED_H

#include "kernel.h"

/* The default coefficient Q of the hourglass control, for which a cube bends as a beam does. */
static const double CT_HOURGLASS_DEFAULT = 1.0;

/* Forces of the batches first ... last - 1, like those of the other kernels. */
void ct_solid_reduced_batches(const ct_solid_part *part, int32_t first, int32_t last,
                              const double *displacement, double *values);

/* Energies of one batch: of the strain at the centre, and of the hourglass control. */
void ct_solid_reduced_energies(const ct_solid_part *part, int32_t batch, const double *displacement,
                               double strain[8], double hourglass[8]);

#endif
