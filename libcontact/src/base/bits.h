#ifndef CT_SRC_BITS_H
#define CT_SRC_BITS_H

#include <stddef.h>
#include <stdint.h>

/* One bit per node: node n is bit n % 64 of word n / 64. */

static inline int64_t ct_bits_words(int64_t count) { return (count + 63) / 64; }

static inline int ct_bits_get(const uint64_t *bits, int32_t n)
{
  return (int)(bits[n / 64] >> (n % 64) & 1u);
}

/* Bits first ... last - 1 of one word, counted from its lowest; 0 <= first < last <= 64. */
static inline uint64_t ct_bits_span(int first, int last)
{
  return (~(uint64_t)0 << first) & (~(uint64_t)0 >> (64 - last));
}

/* Set or clear the bits first ... last - 1. */
static inline void ct_bits_put(uint64_t *bits, int32_t first, int32_t last, int value)
{
  while (first < last) {
    int32_t word = first / 64, end = last < 64 * (word + 1) ? last : 64 * (word + 1);
    uint64_t span = ct_bits_span(first - 64 * word, end - 64 * word);
    bits[word] = value ? bits[word] | span : bits[word] & ~span;
    first = end;
  }
}

/* Set the bits first ... last - 1, which lie in one word, to their values in `word`. */
static inline void ct_bits_write(uint64_t *bits, int32_t first, int32_t last, uint64_t word)
{
  int32_t begin = first / 64 * 64;
  uint64_t span = ct_bits_span(first - begin, last - begin);
  bits[first / 64] = (bits[first / 64] & ~span) | (word & span);
}

/* End of the bits from `first` on that lie in its word, or `last` if that is less. */
static inline int32_t ct_bits_word_end(int32_t first, int32_t last)
{
  int32_t end = first / 64 * 64 + 64;
  return end < last ? end : last;
}

/* Number of zeros below the lowest set bit of a word that is not 0. */
static inline int32_t ct_bits_low_zeros(uint64_t word)
{
#if defined(__GNUC__)
  return __builtin_ctzll(word);
#else
  int32_t n = 0;
  for (; !(word & 1u); word >>= 1) n++;
  return n;
#endif
}

/* The first of n, n + 1, ... whose bit is `value`, or `last` if none below it is. */
static inline int32_t ct_bits_next(const uint64_t *bits, int32_t n, int32_t last, int value)
{
  while (n < last) {
    uint64_t left = (value ? bits[n / 64] : ~bits[n / 64]) >> (n % 64);
    if (left != 0) {
      n += ct_bits_low_zeros(left);
      return n < last ? n : last;
    }
    n += 64 - n % 64;
  }
  return last;
}

/* The next run of set bits among *first ... last - 1: sets *first to its begin and returns its end;
 * both are `last` if there is none. Null: all bits are set. */
static inline int32_t ct_bits_run(const uint64_t *bits, int32_t *first, int32_t last)
{
  if (bits == NULL) return last;
  *first = ct_bits_next(bits, *first, last, 1);
  return ct_bits_next(bits, *first, last, 0);
}

#endif
