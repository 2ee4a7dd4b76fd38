/* The calls into which clang turns the library's parallel loops, on a few threads of our own: for
 * wheels, which bring no OpenMP runtime. A loop has a static schedule and at most ROOM captured
 * variables; all other loops fail to link or stay serial. The names are those of LLVM's runtime. */
#if defined(CT_OWN_RUNTIME) && defined(_OPENMP)

#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>

enum { ROOM = 16, CHUNKS = 33 };

/* A thread of a team as the compiler's number of a thread, which it passes on unchanged. */
#define MEMBER(team, me) ((int32_t)((team) << 16 | (me)))

typedef void body(int32_t *, int32_t *, void *, void *, void *, void *, void *, void *, void *,
                  void *, void *, void *, void *, void *, void *, void *, void *, void *);

/* One team at a time: a second caller has its loop for itself. */
static struct {
  pthread_mutex_t taken, lock, critical;
  pthread_cond_t begun, ended;
  body *loop;
  void *variables[ROOM];
  int started, team, running; /* threads: all and of this loop, with the caller; at work */
  unsigned long turn;
} pool = {PTHREAD_MUTEX_INITIALIZER,
          PTHREAD_MUTEX_INITIALIZER,
          PTHREAD_MUTEX_INITIALIZER,
          PTHREAD_COND_INITIALIZER,
          PTHREAD_COND_INITIALIZER,
          0,
          {0},
          1,
          0,
          0,
          0};

static void call(body *loop, void *const *v, int team, int me)
{
  int32_t member = MEMBER(team, me), bound = 0;
  loop(&member, &bound, v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10], v[11],
       v[12], v[13], v[14], v[15]);
}

static void *work(void *number)
{
  int me = (int)(intptr_t)number;
  unsigned long seen = 0; // a thread is started for a loop that it takes part in
  pthread_mutex_lock(&pool.lock);
  for (;;) {
    while (pool.turn == seen) pthread_cond_wait(&pool.begun, &pool.lock);
    seen = pool.turn;
    if (me >= pool.team) continue;
    pthread_mutex_unlock(&pool.lock);
    call(pool.loop, pool.variables, pool.team, me);
    pthread_mutex_lock(&pool.lock);
    if (--pool.running == 0) pthread_cond_signal(&pool.ended);
  }
  return 0;
}

/* Start what lacks of a team; returns how many there are. */
static int gather(int wanted)
{
  pthread_t thread;
  while (pool.started < wanted) {
    if (pthread_create(&thread, 0, work, (void *)(intptr_t)pool.started) != 0) return pool.started;
    pthread_detach(thread);
    pool.started++;
  }
  return wanted;
}

static __thread int wanted_next;

void __kmpc_push_num_threads(void *place, int32_t thread, int32_t wanted)
{
  (void)place, (void)thread;
  wanted_next = wanted;
}

void __kmpc_fork_call(void *place, int32_t count, body *loop, ...)
{
  void *variables[ROOM] = {0};
  va_list rest;
  (void)place;
  va_start(rest, loop);
  for (int i = 0; i < count; i++) variables[i] = va_arg(rest, void *);
  va_end(rest);
  if (pthread_mutex_trylock(&pool.taken) != 0) {
    call(loop, variables, 1, 0);
    return;
  }
  pthread_mutex_lock(&pool.lock);
  for (int i = 0; i < ROOM; i++) pool.variables[i] = variables[i];
  pool.loop = loop;
  pool.team = gather(wanted_next);
  pool.running = pool.team - 1;
  pool.turn++;
  pthread_cond_broadcast(&pool.begun);
  pthread_mutex_unlock(&pool.lock);
  call(loop, variables, pool.team, 0);
  pthread_mutex_lock(&pool.lock);
  while (pool.running > 0) pthread_cond_wait(&pool.ended, &pool.lock);
  pthread_mutex_unlock(&pool.lock);
  pthread_mutex_unlock(&pool.taken);
}

/* Outside a team, and in a loop too short for one. */
int32_t __kmpc_global_thread_num(void *place)
{
  (void)place;
  return MEMBER(1, 0);
}

void __kmpc_serialized_parallel(void *place, int32_t thread) { (void)place, (void)thread; }
void __kmpc_end_serialized_parallel(void *place, int32_t thread) { (void)place, (void)thread; }

/* The part of the indices lower ... upper of one thread: every so many chunks, or one run. */
static void take_share(int32_t thread, int32_t kind, int64_t chunk, int64_t *lower, int64_t *upper,
                       int64_t *stride)
{
  int64_t team = thread >> 16, me = thread & 0xffff, count = *upper - *lower + 1;
  *stride = kind == CHUNKS ? team * chunk : count;
  *upper = *lower + (kind == CHUNKS ? (me + 1) * chunk : (me + 1) * count / team) - 1;
  *lower += kind == CHUNKS ? me * chunk : me * count / team;
}

/* For each type of an index; the compiler cuts what lies behind the end. */
#define STATIC_INIT(name, index)                                                       \
  void name(void *place, int32_t thread, int32_t kind, int32_t *is_last, index *lower, \
            index *upper, index *stride, index step, index chunk)                      \
  {                                                                                    \
    int64_t first = (int64_t)*lower, last = (int64_t)*upper, next;                     \
    (void)place, (void)is_last, (void)step;                                            \
    take_share(thread, kind, (int64_t)chunk, &first, &last, &next);                    \
    *lower = (index)first, *upper = (index)last, *stride = (index)next;                \
  }
STATIC_INIT(__kmpc_for_static_init_4, int32_t)
STATIC_INIT(__kmpc_for_static_init_8, int64_t)
STATIC_INIT(__kmpc_for_static_init_4u, uint32_t)
STATIC_INIT(__kmpc_for_static_init_8u, uint64_t)
void __kmpc_for_static_fini(void *place, int32_t thread) { (void)place, (void)thread; }

/* One thread at a time: for sections, and for the results of a reduction, which the caller adds
 * when it is told 1. */
void __kmpc_critical(void *place, int32_t thread, void *name)
{
  (void)place, (void)thread, (void)name;
  pthread_mutex_lock(&pool.critical);
}

void __kmpc_end_critical(void *place, int32_t thread, void *name)
{
  (void)place, (void)thread, (void)name;
  pthread_mutex_unlock(&pool.critical);
}

int32_t __kmpc_reduce_nowait(void *place, int32_t thread, int32_t count, size_t size, void *data,
                             void (*reduce)(void *, void *), void *name)
{
  (void)count, (void)size, (void)data, (void)reduce;
  __kmpc_critical(place, thread, name);
  return 1;
}

void __kmpc_end_reduce_nowait(void *place, int32_t thread, void *name)
{
  __kmpc_end_critical(place, thread, name);
}

#else
typedef int ct_runtime_has_threads; /* no empty source */
#endif
