/* A short run of the fuzz target of the optimisations; `make fuzz` runs it for longer. */
#include "../fuzz/fuzz_optimisations.c"
#include "tap.h"

int main(void)
{
  // In scene 243, a state that was ahead and begins anew skips other searches.
  enum { INPUTS = 40, FOUND = 243 };
  for (uint64_t i = 0; i <= INPUTS; i++) {
    uint64_t seed = stirred(((i < INPUTS ? i : FOUND) + 1) * 0x9E3779B97F4A7C15u);
    LLVMFuzzerTestOneInput((const uint8_t *)&seed, sizeof seed);
  }
  tap_ok(total_built > INPUTS / 2 && total_steps > 40 * INPUTS && total_asleep > 1000,
         "%lld pairs of runs of %lld random scenes, %lld errors on the way, %lld steps: no value "
         "differs, and %lld element forces were skipped",
         total_built, total_scenes, total_failures, total_steps, total_asleep);
  return tap_done();
}
