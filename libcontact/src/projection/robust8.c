/* The robust search in eight lanes, for machines with AVX-512. */
#include "projection_internal.h"

#if CT_BATCH_KERNELS
#define WIDTH 8
#define TARGET "avx512f"
#define KERNEL ct_batch_kernel_8
#define NEAR ct_near_kernel_8
#include "batch_kernel.h"
#include "near_kernel.h"
#endif
