#ifndef CT_SRC_BATCH_INTERNAL_H
#define CT_SRC_BATCH_INTERNAL_H

#include "projection_internal.h"

#include <libcontact/projection.h>

/* Compilers and machines that have vectors of four and eight; others search for one pair at a time.
 */
#if defined(__GNUC__) && defined(__x86_64__)
#define CT_BATCH_KERNELS 1
#else
#define CT_BATCH_KERNELS 0
#endif

/* The closest points of block number `block`, which go to the closest points. */
typedef void ct_batch_kernel(ct_face_kind kind, const double *nodes, const double *points,
                             const double *start, const ct_project_options *options,
                             const ct_batch_closest *closest, size_t block);

/* The same search with one, four and eight lanes. */
ct_batch_kernel ct_batch_kernel_1, ct_batch_kernel_4, ct_batch_kernel_8;

#endif
