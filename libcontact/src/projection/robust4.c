/* The robust search in four lanes, for machines with AVX2. */
#include "projection_internal.h"

#if CT_BATCH_KERNELS
#define WIDTH 4
#define TARGET "avx2"
#define KERNEL ct_batch_kernel_4
#define NEAR ct_near_kernel_4
#include "batch_kernel.h"
#include "near_kernel.h"
#endif
