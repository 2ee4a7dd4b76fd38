/* A short run of the fuzz target of the whole library; `make fuzz` runs it for longer. */
#include "../fuzz/fuzz_api.c"
#include "tap.h"

int main(void)
{
  enum { INPUTS = 1000 };
  for (uint64_t i = 0; i < INPUTS; i++) {
    uint64_t mixed = (i + 1) * 0x9E3779B97F4A7C15u;
    LLVMFuzzerTestOneInput((const uint8_t *)&mixed, sizeof mixed);
  }
  tap_ok(total_calls > 10000 && total_built > 100 && total_steps > 500,
         "%lld calls, %lld scenes built of %lld, %lld steps: no contract violated", total_calls,
         total_built, total_scenes, total_steps);
  return tap_done();
}
