#ifndef CT_SRC_LIST_H
#define CT_SRC_LIST_H

#include <stdint.h>

/* The first of `count` ascending numbers that is not below `value`; `count` if all are. */
static inline int32_t ct_lower_bound(const int32_t *list, int32_t count, int32_t value)
{
  int32_t first = 0, last = count;
  while (first < last) {
    int32_t middle = first + (last - first) / 2;
    if (list[middle] < value) first = middle + 1;
    else last = middle;
  }
  return first;
}

#endif
