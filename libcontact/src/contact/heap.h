#ifndef CT_SRC_HEAP_H
#define CT_SRC_HEAP_H

#include "../base/grid.h"
#include "../base/lanes.h"

#include <stddef.h>

/* Sums of forces at the nodes of one face, before they are added to those of all nodes. For each
 * component the values of all nodes lie side by side. The grid makes all sums exact, so partial
 * sums do not change the result (eq:order-free-sum). These functions are inlined with a known
 * `stride`, 4 or 8: at least the number of nodes of the face. */
typedef struct ct_heap {
  double *coarse_sum, *fine_sum; /* at all nodes, shape (any number, 3) */
  int32_t count;                 /* nodes of a face */
  const int32_t *node;           /* of this face; null: the heap is empty */
  double coarse[24], fine[24];
} ct_heap;

/* Add the sums of a heap to the nodes of its face, and begin with another face, or null. */
CT_INLINE void ct_heap_bring(int stride, ct_heap *heap, const int32_t *next)
{
  for (int a = 0; heap->node != NULL && a < heap->count; a++) {
    int64_t first = 3 * (int64_t)heap->node[a];
    for (int c = 0; c < 3; c++) {
      heap->coarse_sum[first + c] += heap->coarse[stride * c + a];
      heap->fine_sum[first + c] += heap->fine[stride * c + a];
    }
  }
  heap->node = next;
  for (int i = 0; i < 3 * stride; i++) heap->coarse[i] = heap->fine[i] = 0.0;
}

/* Add a force at a point of the face with the nodes `node`, whose weights N are finite. */
CT_INLINE void ct_heap_add(int stride, const ct_grid *grid, const int32_t *node, const double N[8],
                           const double force[3], ct_heap *heap)
{
  if (node != heap->node) ct_heap_bring(stride, heap, node);
  for (int c = 0; c < 3; c++)
#pragma omp simd
    for (int a = 0; a < stride; a++)
      ct_grid_add(grid, N[a] * force[c], &heap->coarse[stride * c + a],
                  &heap->fine[stride * c + a]);
}

#endif
