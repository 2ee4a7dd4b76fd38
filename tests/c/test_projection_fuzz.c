/* A short run of the fuzz target; `make fuzz` runs it for longer. */
#include "../fuzz/fuzz_project.c"
#include "tap.h"

int main(void)
{
  enum { INPUTS = 20000 };
  fuzz_random_inputs(INPUTS);
  tap_ok(answers[CT_OK] > INPUTS / 4 && answers[CT_INVALID] > INPUTS / 100 &&
             answers[CT_ERROR_ARGUMENT] > INPUTS / 100,
         "%d inputs, no contract violated: %lld closest points found, %lld invalid, %lld refused",
         INPUTS, answers[CT_OK], answers[CT_INVALID], answers[CT_ERROR_ARGUMENT]);
  return tap_done();
}
