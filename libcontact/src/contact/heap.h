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
  double *coarse_sum, *fine_sum; /* at all nodes, shape (any number, 3), and one number more */
  int32_t count;                 /* nodes of a face */
  const int32_t *node;           /* of this face; null: the heap is empty */
  double coarse[24], fine[24];
} ct_heap;

/* Add the sums of one face with `count` nodes to those of all nodes. */
CT_INLINE void ct_heap_pour_nodes(int count, int stride, const ct_heap *heap, const int32_t *node,
                                  const double *coarse, const double *fine)
{
  for (int a = 0; a < count; a++) {
    int64_t first = 3 * (int64_t)node[a];
    for (int c = 0; c < 3; c++) {
      heap->coarse_sum[first + c] += coarse[stride * c + a];
      heap->fine_sum[first + c] += fine[stride * c + a];
    }
  }
}

/* The same for the faces of a heap. */
CT_INLINE void ct_heap_pour(int stride, const ct_heap *heap, const int32_t *node,
                            const double *coarse, const double *fine)
{
  if (heap->count == stride) ct_heap_pour_nodes(stride, stride, heap, node, coarse, fine);
  else ct_heap_pour_nodes(heap->count, stride, heap, node, coarse, fine);
}

/* Add the sums of a heap to the nodes of its face, and begin with another face, or null. */
CT_INLINE void ct_heap_bring(int stride, ct_heap *heap, const int32_t *next)
{
  if (heap->node != NULL) ct_heap_pour(stride, heap, heap->node, heap->coarse, heap->fine);
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

/* Add the forces at the four points of a 2 x 2 rule, of which all act on one face with `count`
 * nodes, past the heap, or with the sign -1 subtract them. Their fourth component is 0 and changes
 * nothing in the number behind a node's sums. Forces are summed first, paired across the middle, so
 * that a flipped or rotated face gives the same bits (eq:tree-sum). Each weight stands once in N,
 * or, with `times` = 4, for each component. */
CT_INLINE void ct_heap_add_four(int count, int times, const ct_grid *grid, const int32_t *node,
                                const double *const N[4], double sign, double (*const force)[4],
                                const ct_heap *heap)
{
  for (int a = 0; a < count; a++) {
    double *coarse = &heap->coarse_sum[3 * (int64_t)node[a]],
           *fine = &heap->fine_sum[3 * (int64_t)node[a]];
    const double *N0 = N[0] + times * a, *N1 = N[1] + times * a, *N2 = N[2] + times * a,
                 *N3 = N[3] + times * a;
#pragma omp simd
    for (int c = 0; c < 4; c++) {
      const int i = c % times;
      const double sum = sign * ((N0[i] * force[0][c] + N3[i] * force[3][c]) +
                                 (N1[i] * force[1][c] + N2[i] * force[2][c]));
      ct_grid_add(grid, sum, &coarse[c], &fine[c]);
    }
  }
}

#endif
