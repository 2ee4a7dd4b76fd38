/* Bodies of equal boxes in the order of a lattice: nothing is stored of an element. */
#include "lattice.h"

#include <string.h>

/* Number of the first corner of an element. */
static int32_t first_corner(const int32_t cells[3], int32_t e)
{
  int32_t i = e % cells[0], j = e / cells[0] % cells[1], k = e / cells[0] / cells[1];
  return i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
}

/* Steps from the first corner of an element to corner `a`. */
static int32_t corner_at(const int32_t step[3], int a)
{
  double xi[3];
  ct_brick_reference(CT_HEX8, a, xi);
  return (xi[0] > 0.0 ? step[0] : 0) + (xi[1] > 0.0 ? step[1] : 0) + (xi[2] > 0.0 ? step[2] : 0);
}

int ct_lattice_find(const ct_mesh *mesh, ct_solid_part *part)
{
  const int32_t *n = mesh->elements;
  if (mesh->kind != CT_HEX8 || n[0] != 0) return 0;
  // The first element tells how far nodes are apart along each axis; the smallest step is along a
  // row, the largest leads to the next layer.
  const int32_t step[3] = {n[1], n[3], n[4]};
  int axes[3] = {0, 1, 2};
  for (int i = 0; i < 3; i++) {
    int low = i % 2, swap = step[axes[low]] > step[axes[low + 1]], keep = axes[low];
    axes[low] = swap ? axes[low + 1] : keep;
    axes[low + 1] = swap ? keep : axes[low + 1];
  }
  int32_t row = step[axes[1]], layer = step[axes[2]];
  if (step[axes[0]] != 1 || row < 1 + CT_SHORTEST_ROW || layer < 2 * row || layer % row != 0 ||
      mesh->node_count % layer != 0)
    return 0;
  const int32_t cells[3] = {row - 1, layer / row - 1, mesh->node_count / layer - 1};
  if (cells[2] < 1 || (int64_t)cells[0] * cells[1] * cells[2] != mesh->element_count) return 0;
  int32_t corner[8];
  for (int a = 0; a < 8; a++) corner[a] = corner_at(step, a);
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 8; a++)
      if (n[8 * (int64_t)e + a] != first_corner(cells, e) + corner[a]) return 0;
  memcpy(part->cells, cells, sizeof cells);
  memcpy(part->axes, axes, sizeof axes);
  memcpy(part->corner, corner, sizeof corner);
  return 1;
}

/* Elements that may lie between the first and the last one of a node. */
static int64_t history(const ct_solid_part *part)
{
  return 1 + part->cells[0] + (int64_t)part->cells[0] * part->cells[1];
}

int64_t ct_lattice_prepare(ct_solid_part *part)
{
  // -- A power of two that holds what nodes still wait for and what is computed at once, half a
  // block at least (eq:lattice-ring)
  int64_t need = history(part) + 8 * (CT_BLOCK / 2), all = 8 * (int64_t)part->batch_count;
  part->ring = 8;
  while (part->ring < (need < all ? need : all)) part->ring *= 2;
  int64_t room = (part->ring - history(part)) / 8;
  part->block = part->ring >= all || room > CT_BLOCK ? CT_BLOCK : (int32_t)room;
  part->stride = part->ring + 8; // rows of the ring would fight for the same place in the cache
  return 24 * part->stride * part->rings;
}

int32_t ct_lattice_ready(const ct_solid_part *part, int32_t element)
{
  return element < part->mesh->element_count ? first_corner(part->cells, element)
                                             : part->mesh->node_count;
}

int32_t ct_lattice_begin(const ct_solid_part *part, int32_t first)
{
  int32_t row = part->cells[0] + 1, rows = part->cells[1] + 1;
  int64_t at = first % row + part->cells[0] * (first / row % rows +
                                               part->cells[1] * (int64_t)(first / row / rows));
  // At the end of a layer a node's number may be that of an element one row further on.
  at -= history(part) + part->cells[0];
  return at > 0 ? (int32_t)at : 0;
}

/* Sum eight runs of element forces that lie side by side; `step`: from one component to the next.
 */
CT_CLONES
static void gather_run(const double *const v[8], const int64_t step[8], int32_t count, double *f)
{
  for (int c = 0; c < 3; c++) {
    const double *a = v[0] + c * step[0], *b = v[1] + c * step[1], *d = v[2] + c * step[2],
                 *e = v[3] + c * step[3];
    const double *p = v[4] + c * step[4], *q = v[5] + c * step[5], *r = v[6] + c * step[6],
                 *s = v[7] + c * step[7];
    // -- Pair the octants along ξ, then η, then ζ (eq:tree-sum)
#pragma omp simd
    for (int32_t n = 0; n < count; n++)
      f[3 * n + c] = ((a[n] + b[n]) + (d[n] + e[n])) + ((p[n] + q[n]) + (r[n] + s[n]));
  }
}

/* First elements of the four rows of elements around a row of nodes, the positive way along the
 * second and the third axis last; -1: none. */
static void rows_around(const int32_t cells[3], int32_t line, int64_t row[4])
{
  int32_t j = line % (cells[1] + 1), k = line / (cells[1] + 1);
  for (int r = 0; r < 4; r++) {
    int32_t y = j - 1 + (r & 1), z = k - 1 + (r >> 1);
    row[r] = y >= 0 && y < cells[1] && z >= 0 && z < cells[2]
                 ? cells[0] * (y + (int64_t)cells[1] * z)
                 : -1;
  }
}

int32_t ct_lattice_batches(const ct_solid_part *part, int32_t node, int32_t batch[8])
{
  int32_t nodes = part->cells[0] + 1, i = node % nodes, count = 0;
  int64_t row[4];
  rows_around(part->cells, node / nodes, row);
  for (int r = 0; r < 4; r++) {
    if (row[r] >= 0 && i > 0) batch[count++] = (int32_t)((row[r] + i - 1) / 8);
    if (row[r] >= 0 && i < part->cells[0]) batch[count++] = (int32_t)((row[r] + i) / 8);
  }
  return count;
}

/* Sum at the i-th node of a row and those after it, `count` at most; answers for how many this was
 * done: rows of forces end at the ends of the ring, and at the ends of a row a node has fewer
 * elements. */
static int32_t gather_piece(const ct_solid_part *part, const double *values, const int64_t row[4],
                            int32_t i, int32_t count, double *f)
{
  enum { ZEROS = 256 };
  static const double zeros[ZEROS] = {0.0};
  static const int corner[8] = {6, 7, 5, 4, 2,
                                3, 1, 0}; // local number of the node in the element of each octant
  const double *v[8];
  int64_t step[8];
  int32_t nx = part->cells[0], run = i > 0 && i < nx ? (count < nx - i ? count : nx - i) : 1;
  run = run < ZEROS ? run : ZEROS;
  for (int o = 0; o < 8; o++) {
    int32_t along = i - 1 + (o >> part->axes[0] & 1);
    int64_t begin = row[(o >> part->axes[1] & 1) + 2 * (o >> part->axes[2] & 1)];
    int there = begin >= 0 && along >= 0 && along < nx;
    int64_t place = there ? (begin + along) & (part->ring - 1) : 0;
    v[o] = there ? values + 3 * corner[o] * part->stride + place : zeros;
    step[o] = there ? part->stride : 0;
    if (run > part->ring - place) run = (int32_t)(part->ring - place);
  }
  gather_run(v, step, run, f);
  return run;
}

void ct_lattice_gather(const ct_solid_part *part, const double *values, int32_t first, int32_t last,
                       double *f)
{
  int32_t nodes = part->cells[0] + 1, line = first / nodes, i = first - nodes * line;
  for (int32_t n = first; n < last; line++, i = 0) {
    int64_t row[4];
    int32_t end = last - n < nodes - i ? i + last - n : nodes;
    rows_around(part->cells, line, row);
    for (int32_t run; i < end; i += run, n += run)
      run = gather_piece(part, values, row, i, end - i, &f[3 * (int64_t)n]);
  }
}
