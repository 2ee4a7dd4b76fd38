/* The kernel of ct_project_batch for machines that have AVX2. */
#include "batch_internal.h"

#if CT_BATCH_KERNELS
#define LANES 4
#define TARGET "avx2"
#define KERNEL ct_batch_quadrilaterals_4
#include "batch_kernel.h"
#endif
