/* The robust search for one pair. */
#define KERNEL ct_batch_kernel_1
#define NEAR ct_near_kernel_1
#include "batch_kernel.h"
#include "near_kernel.h"

ct_status ct_project_robust(const ct_patch *patch, const ct_project_options *options,
                            ct_closest *closest)
{
  counts count = {0, 0};
  ends found;
  search(patch, options, options->use_start, options->start, 1, &count, &found);
  for (int a = 0; a < 2; a++) closest->xi[a] = found.xi[a];
  for (int k = 0; k < 3; k++) closest->d[k] = found.d[k];
  closest->evaluations += count.evaluations;
  closest->iterations += count.iterations;
  return (ct_status)found.status;
}
