/* Choices from bytes, and from pseudo-random numbers that the bytes begin when there are no more of
 * them. */
#ifndef DICE_H
#define DICE_H

#include <libcontact/mesh.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct dice {
  const uint8_t *data;
  size_t size;
  uint64_t seed;
  int wild;   /* whether impossible numbers may come */
  long calls; /* entry points of the library that were called */
} dice;

static inline void demand(int ok, const char *what)
{
  if (ok) return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

/* Bits that have little to do with each other, also from numbers that follow each other. */
static inline uint64_t stirred(uint64_t x)
{
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  return (x ^ (x >> 27)) * 0x94D049BB133111EBu;
}

static inline dice dice_open(const uint8_t *data, size_t size)
{
  dice d = {data, size, 88172645463325252u, 0, 0};
  for (size_t i = 0; i < size; i++) d.seed = (d.seed ^ data[i]) * 1099511628211u;
  d.seed |= 1;
  return d;
}

static inline unsigned roll(dice *d)
{
  if (d->size > 0) return d->size--, *d->data++;
  d->seed ^= d->seed << 13, d->seed ^= d->seed >> 7, d->seed ^= d->seed << 17;
  return (unsigned)(d->seed >> 32) & 255u;
}

/* One of 0 ... n - 1. */
static inline int below(dice *d, int n) { return (int)((roll(d) * 256u + roll(d)) % (unsigned)n); }

/* One time in n. */
static inline int chance(dice *d, int n) { return below(d, n) == 0; }

/* A number on (-1, 1), rarely an impossible one where those may come. */
static inline double real(dice *d)
{
  static const double strange[] = {0.0,   -0.0,   1.0,      -1.0,    1e-300, -1e-300,
                                   1e300, -1e300, 4.9e-324, 1.7e308, 1e-9,   1e9};
  if (d->wild && chance(d, 24)) {
    int k = below(d, 15);
    return k == 12   ? (double)NAN
           : k == 13 ? (double)INFINITY
           : k == 14 ? -(double)INFINITY
                     : strange[k];
  }
  return (double)(roll(d) * 256u + roll(d)) / 32768.0 - 1.0;
}

/* A number on (low, high), or a strange one. */
static inline double between(dice *d, double low, double high)
{
  double x = real(d);
  return fabs(x) <= 1.0 ? low + 0.5 * (x + 1.0) * (high - low) : x;
}

static inline void *room(size_t count, size_t size)
{
  void *memory = calloc(count > 0 ? count : 1, size);
  demand(memory != NULL, "memory for the test itself");
  return memory;
}

/* Smallest and largest coordinates of a mesh. */
static inline void extent(const ct_mesh *mesh, double low[3], double high[3])
{
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++) {
    if (i < 3) low[i] = high[i] = mesh->nodes[i];
    low[i % 3] = fmin(low[i % 3], mesh->nodes[i]);
    high[i % 3] = fmax(high[i % 3], mesh->nodes[i]);
  }
}

/* An answer with its error: a code that there is, the same in both, and a text that ends. */
static inline ct_status checked(dice *d, ct_status status, const ct_error *error)
{
  d->calls++;
  demand((int)status >= CT_OK && (int)status <= CT_ERROR_ENERGY, "a status that there is");
  demand(status == CT_OK || error == NULL || error->code == status,
         "the error has the code that is returned");
  demand(error == NULL || memchr(error->text, 0, sizeof error->text) != NULL,
         "the text of an error ends");
  demand(status == CT_OK || error == NULL || error->text[0] != 0, "an error has a text");
  return status;
}

#endif
