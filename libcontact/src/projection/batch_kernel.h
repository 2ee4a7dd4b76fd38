/* A block of ct_project_batch, WIDTH pairs at a time. A source that includes this header defines
 * KERNEL, its name. */
#include "robust.h"

/* Write a row of numbers of a block if it is requested: NaN in lanes without a result. */
PART void put(double *rows, size_t row, int first, mask good, real a)
{
  if (rows != NULL) store(rows + 8 * row + (size_t)first, pick(good, a, every(NAN)));
}

/* The nodes, `per` to a face, and points of the pairs from lane `first` on. */
PART void load_pairs(int per, const double *nodes, const double *points, int first, real v[8][3],
                     real p[3])
{
  for (int k = 0; k < 3; k++) {
    p[k] = load(points + 8 * k + first);
    for (int i = 0; i < per; i++) v[i][k] = load(nodes + 8 * (3 * i + k) + first);
  }
}

/* Their polynomials; returns the lanes with valid ones. */
PART mask take_pairs(ct_face_kind kind, const double *nodes, const double *points, int first,
                     patches *patch)
{
  real v[8][3], p[3];
  load_pairs(ct_face_node_count(kind), nodes, points, first, v, p);
  patch->kind = kind;
  return patch_from((const real(*)[3])v, p, patch);
}

/* The search in the valid lanes. A start that is not finite is ignored. */
PART void search_pairs(const patches *patch, const double *start, int first, mask good,
                       const ct_project_options *options, counts *count, ends *found)
{
  real none = every(0), from[2] = {none, none};
  mask warm = none != none;
  ends other;
  if (start != NULL) {
    for (int a = 0; a < 2; a++) from[a] = load(start + 8 * a + first);
    warm = good & (absolute(from[0]) < HUGE_VAL) & (absolute(from[1]) < HUGE_VAL);
    if (any(warm)) search(patch, options, 1, from, warm, count, found);
  }
  mask cold = good & not(warm);
  if (!any(cold)) return;
  search(patch, options, 0, from, cold, count, &other);
  take(found, &other, sizeof other, cold);
}

/* The results, as ct_project returns them. */
PART void project_pairs(ct_face_kind kind, const double *nodes, const double *points,
                        const double *start, const ct_project_options *options,
                        const ct_batch_closest *closest, size_t block, int first)
{
  real n[3], none = every(0);
  patches patch;
  counts count = {none != none, none != none};
  ends found = {{none, none}, none, {none, none, none}, none};
  mask good = take_pairs(kind, nodes, points, first, &patch);
  search_pairs(&patch, start, first, good, options, &count, &found);
  // -- Neither without a normal nor beyond the range of numbers is there an answer
  good &= normal(&patch, found.xi, n) & (found.f < HUGE_VAL);
  // -- Distance, and its sign on the side of the normal (eq:projection-signed)
  real distance = root(found.f), side = pick(dot(found.d, n) <= 0, distance, -distance);
  put(closest->distance, block, first, good, distance);
  put(closest->signed_distance, block, first, good, side);
  for (size_t a = 0; a < 2; a++) put(closest->xi, 2 * block + a, first, good, found.xi[a]);
  for (size_t k = 0; k < 3; k++) put(closest->normal, 3 * block + k, first, good, n[k]);
  for (int l = 0; l < WIDTH; l++) {
    size_t at = 8 * block + (size_t)(first + l);
    int valid = whole(good, l) != 0;
    if (closest->status != NULL)
      closest->status[at] = valid ? (int32_t)lane(found.status, l) : CT_INVALID;
    if (closest->evaluations != NULL)
      closest->evaluations[at] = valid ? whole(count.evaluations, l) : 0;
  }
}

#if WIDTH > 1
__attribute__((target(TARGET)))
#endif
void KERNEL(ct_face_kind kind, const double *nodes, const double *points, const double *start,
            const ct_project_options *options, const ct_batch_closest *closest, size_t block)
{
  for (int first = 0; first < 8; first += WIDTH)
    project_pairs(kind, nodes, points, start, options, closest, block, first);
}
