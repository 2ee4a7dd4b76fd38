#ifndef CT_SRC_LIST_H
#define CT_SRC_LIST_H

#include <stdint.h>

/* Place of the first of `count` ascending numbers, none twice, that is not below `value`; `count`
 * if all are. Where they are consecutive it is known at once. */
static inline int32_t ct_lower_bound(const int32_t *list, int32_t count, int32_t value)
{
  if (count == 0 || value <= list[0]) return 0;
  if (value > list[count - 1]) return count;
  // list[0] + i <= list[i] <= list[count - 1] - (count - 1 - i)
  int32_t first = value - list[count - 1] + count - 1, last = value - list[0];
  if (first < 0) first = 0;
  if (last > count) last = count;
  while (first < last) {
    int32_t middle = first + (last - first) / 2;
    if (list[middle] < value) first = middle + 1;
    else last = middle;
  }
  return first;
}

/* Length of the row of consecutive numbers with which `count` ascending numbers, at least one,
 * begin. */
static inline int32_t ct_row_length(const int32_t *list, int32_t count)
{
  if (list[count - 1] - list[0] == count - 1) return count;
  int32_t length = 1;
  while (list[length] == list[0] + length) length++;
  return length;
}

#endif
