/* A short run of the fuzz target; `make fuzz` runs it for longer. */
#include "../fuzz/fuzz_project.c"
#include "tap.h"

int main(void)
{
  enum { INPUTS = 20000 };
  fuzz_random_inputs(INPUTS);
  tap_ok(1, "%d inputs, no promise broken", INPUTS);
  return tap_done();
}
