/* An allocator that counts allocated memory, and fails on request. */
#ifndef COUNTING_H
#define COUNTING_H

#include <libcontact/base.h>

#include <stdlib.h>
#include <string.h>

/* The size is stored before the block. */
enum { COUNTING_HEADER = 64 };

typedef struct counting {
  size_t held, peak;
  long calls, blocks;
  long last_call; /* the last call that gets memory; -1: all do */
} counting;

static counting counted = {.last_call = -1};

static void *counting_allocate(size_t size, void *context)
{
  counting *c = context;
  if (c->last_call >= 0 && c->calls >= c->last_call) return NULL;
  char *raw = malloc(size + COUNTING_HEADER);
  if (raw == NULL) return NULL;
  *(size_t *)(void *)raw = size;
  c->calls++;
  c->blocks++;
  c->held += size;
  if (c->held > c->peak) c->peak = c->held;
  return memset(raw + COUNTING_HEADER, 0x5a, size);
}

static void counting_release(void *memory, void *context)
{
  counting *c = context;
  char *raw = (char *)memory - COUNTING_HEADER;
  c->blocks--;
  c->held -= *(size_t *)(void *)raw;
  free(raw);
}

static const ct_allocator COUNTING = {counting_allocate, counting_release, &counted, 0};

#endif
