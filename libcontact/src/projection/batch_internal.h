#ifndef CT_SRC_BATCH_INTERNAL_H
#define CT_SRC_BATCH_INTERNAL_H

#include "projection_internal.h"

#include <libcontact/projection.h>

/* Compilers and machines that the kernels are written for; on others ct_project does all the work.
 */
#if defined(__GNUC__) && defined(__x86_64__)
#define CT_BATCH_KERNELS 1
#else
#define CT_BATCH_KERNELS 0
#endif

/* One block of quadrilaterals. The reference coordinates go to xi, shape (2, 8), the rest to the
 * feet. Answers a bit for each lane that is left to ct_project, and 256 times that bit for each
 * whose foot needs a proof that nothing is closer. */
typedef unsigned ct_batch_kernel(ct_face_kind kind, const double *nodes, const double *points,
                                 const double *start, const ct_project_options *options,
                                 double xi[16], const ct_batch_feet *feet, size_t block);

ct_batch_kernel ct_batch_quadrilaterals_4, ct_batch_quadrilaterals_8;

#endif
