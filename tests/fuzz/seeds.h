/* Runs the inputs of consecutive seeds, for programs without libFuzzer. Include it after
 * LLVMFuzzerTestOneInput. */
#ifndef SEEDS_H
#define SEEDS_H

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "dice.h"

static unsigned long long now_seed;

/* Tell the seed of an input that takes longer than a minute or breaks a promise. */
static void tell_seed(int number)
{
  char text[96];
  const char *what = number == SIGALRM ? "broken promise: an input ends," : "ended by a signal";
  int length = snprintf(text, sizeof text, "%s at seed %llu\n", what, now_seed);
  if (write(2, text, (size_t)length) < 0) _exit(99);
  _exit(98);
}

/* Inputs from `first` on, `most` of them, or as many as there is time for when that is negative;
 * answers how many. */
static long long run_seeds(double seconds, unsigned long long first, long long most)
{
  long long inputs = 0;
  time_t begin = time(NULL);
  signal(SIGALRM, tell_seed);
  signal(SIGABRT, tell_seed);
  for (now_seed = first; most < 0 ? difftime(time(NULL), begin) < seconds : inputs < most;
       now_seed++, inputs++) {
    uint8_t bytes[8];
    uint64_t seed = stirred((now_seed + 1) * 0x9E3779B97F4A7C15u);
    memcpy(bytes, &seed, sizeof bytes);
    alarm(60);
    LLVMFuzzerTestOneInput(bytes, sizeof bytes);
  }
  alarm(0);
  return inputs;
}

#endif
