/* The kernel of ct_project_batch for machines that have AVX-512. */
#include "batch_internal.h"

#if CT_BATCH_KERNELS
#define LANES 8
#define TARGET "avx512f"
#define KERNEL ct_batch_quadrilaterals_8
#include "batch_kernel.h"
#endif
