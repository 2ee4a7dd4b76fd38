/* A short run of the fuzz target of what may be left out; `make fuzz` runs it for longer. */
#include "../fuzz/fuzz_savings.c"
#include "tap.h"

int main(void)
{
  enum { INPUTS = 100 };
  for (uint64_t i = 0; i < INPUTS; i++) {
    uint64_t seed = mixed((i + 1) * 0x9E3779B97F4A7C15u);
    LLVMFuzzerTestOneInput((const uint8_t *)&seed, sizeof seed);
  }
  tap_ok(total_built > INPUTS && total_orders > INPUTS / 2 && total_failures > 0 &&
             total_steps > 100 * INPUTS,
         "%lld pairs of runs of %lld random scenes, %lld of them numbered otherwise, %lld errors "
         "on the way, %lld steps: no bit differs",
         total_built, total_scenes, total_orders, total_failures, total_steps);
  return tap_done();
}
