#include "threads.h"

#if defined(_OPENMP) && !defined(_WIN32)

#include <unistd.h>

/* The number of threads that this process may start. */
static int startable(int wanted)
{
  // The process in which OpenMP's threads were started; the only variable without an owner, like
  // these threads.
  static long begun;
  if (wanted <= 1) return wanted;
  long own = (long)getpid(), process;
#pragma omp atomic read
  process = begun;
  if (process == own) return wanted;
  if (process != 0) return 1;
#pragma omp atomic write
  begun = own;
  return wanted;
}

#else

static int startable(int wanted) { return wanted; }

#endif

int ct_threads_for(int wanted, int64_t count, int64_t least)
{
#ifdef CT_SHORT_LOOPS
  least = 1;
#endif
  if (count / least < wanted) wanted = (int)(count / least);
  return wanted < 2 ? 1 : startable(wanted);
}
