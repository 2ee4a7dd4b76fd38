#ifndef CT_SRC_RANDOM_H
#define CT_SRC_RANDOM_H

#include <stdint.h>

/* The next 53 random bits of a seed that is not zero (xorshift): the same numbers in every run. */
static inline double ct_random_bits(uint64_t *seed)
{
  *seed ^= *seed << 13, *seed ^= *seed >> 7, *seed ^= *seed << 17;
  return (double)(*seed >> 11);
}

#endif
