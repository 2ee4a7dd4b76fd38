#include "projection_internal.h"
#include "../base/error.h"

/* The widest kernel for this machine. */
static ct_batch_kernel *widest_kernel(void)
{
#if CT_BATCH_KERNELS
  if (__builtin_cpu_supports("avx512f")) return ct_batch_kernel_8;
  if (__builtin_cpu_supports("avx2")) return ct_batch_kernel_4;
#endif
  return ct_batch_kernel_1;
}

ct_near_kernel *ct_widest_near_kernel(void)
{
#if CT_BATCH_KERNELS
  if (__builtin_cpu_supports("avx512f")) return ct_near_kernel_8;
  if (__builtin_cpu_supports("avx2")) return ct_near_kernel_4;
#endif
  return ct_near_kernel_1;
}

/* Prefetch the numbers of a block while the previous one is computed. */
static inline void fetch(const double *values, size_t count)
{
#if CT_BATCH_KERNELS
  for (size_t i = 0; i < count; i += 8) __builtin_prefetch(values + i);
#else
  (void)values, (void)count;
#endif
}

/* Number of blocks of eight lanes for the pairs. */
static size_t blocks_of(size_t count) { return (count + 7) / 8; }

ct_status ct_project_batch(ct_face_kind kind, size_t count, const double *nodes,
                           const double *points, const double *start,
                           const ct_project_options *options, const ct_batch_closest *closest,
                           ct_error *error)
{
  ct_project_options defaults = ct_project_options_default();
  if (options == NULL) options = &defaults;
  size_t per = (size_t)ct_face_node_count(kind);
  ct_status status = ct_check_options(options->cookie, "ct_project_options_default", error);
  if (status != CT_OK) return status;
  if (closest == NULL || (count > 0 && (nodes == NULL || points == NULL)))
    return CT_REFUSE_NULL(error);
  if (per == 0) return CT_REFUSE(error, "batch: there is no face of the kind %d", (int)kind);
  status = ct_check_search_limits("batch", options, error);
  if (status != CT_OK) return status;
  ct_batch_kernel *kernel = widest_kernel();
  for (size_t block = 0; block < blocks_of(count); block++) {
    const double *x = nodes + 24 * per * block, *p = points + 24 * block,
                 *from = start != NULL ? start + 16 * block : NULL;
    if (block + 1 < blocks_of(count)) fetch(x + 24 * per, 24 * per), fetch(p + 24, 24);
    kernel(kind, x, p, from, options, closest, block);
  }
  return CT_OK;
}
