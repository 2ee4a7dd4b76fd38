/* The threads that wheels bring (base/openmp.c), called as clang does: each index of a loop once,
 * for each team and schedule, from two callers at a time, and critical sections. */
#define CT_OWN_RUNTIME
#ifndef _OPENMP
#define _OPENMP 201511
#endif
#include "../../libcontact/src/base/openmp.c"
#include "tap.h"

enum { MOST = 203, LOOPS = 200, STATIC = 34 };

typedef struct loop {
  int32_t count, kind, chunk;
  int seen[MOST], sum;
} loop;

/* A loop as the compiler leaves it; `all` is its only captured variable. */
static void each(int32_t *thread, int32_t *bound, void *all, void *a, void *b, void *c, void *d,
                 void *e, void *f, void *g, void *h, void *i, void *j, void *k, void *l, void *m,
                 void *n, void *o)
{
  loop *of = all;
  int32_t is_last = 0, lower = 0, upper = of->count - 1, stride = 1;
  (void)bound, (void)a, (void)b, (void)c, (void)d, (void)e, (void)f, (void)g, (void)h;
  (void)i, (void)j, (void)k, (void)l, (void)m, (void)n, (void)o;
  __kmpc_for_static_init_4(NULL, *thread, of->kind, &is_last, &lower, &upper, &stride, 1,
                           of->chunk);
  for (; lower < of->count; lower += stride, upper += stride)
    for (int32_t at = lower; at <= upper && at < of->count; at++) of->seen[at]++;
  __kmpc_critical(NULL, *thread, NULL);
  of->sum += 1;
  __kmpc_end_critical(NULL, *thread, NULL);
}

/* Loops of all lengths, of a team of `wanted`; returns whether each index was met once. */
static int run(int wanted, int32_t kind, int32_t chunk, int *largest)
{
  int all = 1;
  for (int32_t count = 1; count < MOST; count++) {
    loop of = {.count = count, .kind = kind, .chunk = chunk};
    __kmpc_push_num_threads(NULL, 0, wanted);
    __kmpc_fork_call(NULL, 1, each, &of);
    for (int32_t at = 0; at < count; at++) all &= of.seen[at] == 1;
    if (of.sum > *largest) *largest = of.sum;
    all &= of.sum >= 1 && of.sum <= wanted;
  }
  return all;
}

static void *second(void *all)
{
  int largest = 0;
  for (int i = 0; i < LOOPS / 10; i++) *(int *)all &= run(3, STATIC, 0, &largest);
  return NULL;
}

int main(void)
{
  int runs = 1, chunks = 1, largest = 0, both[2] = {1, 1};
  pthread_t other;
  for (int wanted = 1; wanted <= 7; wanted++) {
    largest = 0;
    runs &= run(wanted, STATIC, 0, &largest) && largest == wanted;
    chunks &= run(wanted, CHUNKS, 1, &largest) && run(wanted, CHUNKS, 5, &largest);
  }
  tap_ok(runs, "each index in one run of one thread, in teams of 1 to 7");
  tap_ok(chunks, "in chunks of 1 and 5");
  if (pthread_create(&other, NULL, second, &both[1]) != 0) both[1] = 0;
  second(&both[0]);
  pthread_join(other, NULL);
  tap_ok(both[0] && both[1], "from two callers at a time");
  return tap_done();
}
