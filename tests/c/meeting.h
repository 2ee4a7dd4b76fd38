/* Pieces of one model, each computed by a thread: how they exchange numbers. */
#ifndef MEETING_H
#define MEETING_H

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>

enum { MOST_SEATS = 8 };

/* Numbers that the pieces exchange, added in the order in which the threads happen to come. */
typedef struct meeting {
  pthread_mutex_t mutex;
  pthread_cond_t turn;
  int pieces, arrived, leaving;
  int64_t capacity, calls, numbers;
  double *total;
  const double *sent[MOST_SEATS];
  const int32_t *sent_count[MOST_SEATS];
} meeting;

/* The place of one piece. */
typedef struct seat {
  meeting *with;
  int number;
} seat;

#define MEETING(count) \
  {.mutex = PTHREAD_MUTEX_INITIALIZER, .turn = PTHREAD_COND_INITIALIZER, .pieces = (count)}

static inline int meet(meeting *m, int largest, double *values, int64_t count)
{
  pthread_mutex_lock(&m->mutex);
  while (m->leaving > 0) pthread_cond_wait(&m->turn, &m->mutex);
  if (m->arrived == 0) {
    m->calls++, m->numbers += count;
    if (count > m->capacity) m->total = realloc(m->total, (size_t)count * sizeof *m->total);
    m->capacity = count > m->capacity ? count : m->capacity;
    for (int64_t i = 0; i < count; i++) m->total[i] = values[i];
  } else
    for (int64_t i = 0; i < count; i++)
      m->total[i] = largest ? fmax(m->total[i], values[i]) : m->total[i] + values[i];
  if (++m->arrived == m->pieces) m->arrived = 0, m->leaving = m->pieces;
  else
    while (m->leaving == 0) pthread_cond_wait(&m->turn, &m->mutex);
  for (int64_t i = 0; i < count; i++) values[i] = m->total[i];
  m->leaving--;
  pthread_cond_broadcast(&m->turn);
  pthread_mutex_unlock(&m->mutex);
  return 0;
}

static inline int add(void *data, double *values, int64_t count)
{
  return meet(((const seat *)data)->with, 0, values, count);
}

static inline int take_largest(void *data, double *values, int64_t count)
{
  return meet(((const seat *)data)->with, 1, values, count);
}

/* Numbers from each piece to each other one. */
static inline int hand_over(void *data, const double *send, const int32_t *send_count,
                            double *receive, const int32_t *receive_count)
{
  const seat *own = data;
  meeting *m = own->with;
  m->sent[own->number] = send, m->sent_count[own->number] = send_count;
  meet(m, 0, NULL, 0);
  for (int from = 0; from < m->pieces; from++) {
    const double *there = m->sent[from];
    for (int to = 0; to < own->number; to++) there += m->sent_count[from][to];
    for (int32_t i = 0; i < receive_count[from]; i++) *receive++ = there[i];
  }
  meet(m, 0, NULL, 0);
  return 0;
}

#endif
