/* Closed parts of a surface whose faces point inwards. */
#include "search_internal.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* A part of a surface: faces that are connected by edges. */
typedef struct part {
  int32_t face; /* one of them */
  int closed;
  double volume;
  ct_bounds box;
} part;

/* The volume that one face contributes, relative to `origin` (eq:enclosed-volume). */
static double volume_of(const ct_search *search, int32_t f, const double origin[3])
{
  ct_face face;
  ct_rule rule;
  double sum = 0.0;
  ct_search_face(search, f, &face);
  (void)ct_rule_face(search->kind, &rule, NULL);
  for (int q = 0; q < rule.count; q++) {
    double x[3], t1[3], t2[3], n[3];
    ct_segment_point(&face, rule.xi[q], x);
    ct_segment_tangents(&face, rule.xi[q], t1, t2);
    ct_vector_cross(t1, t2, n);
    for (int c = 0; c < 3; c++) x[c] -= origin[c];
    // -- ⅓ ∫ x · n dA (eq:enclosed-volume)
    sum += rule.weight[q] * ct_vector_dot(x, n) / 3.0;
  }
  return sum;
}

/* Collect the part of face `first`, whose faces get its number. `list` has memory for all faces. */
static part collect(const ct_search *search, int32_t first, int32_t number, int32_t *number_of,
                    int32_t *list)
{
  part p = {.face = first, .closed = 1, .box = search->boxes[first]};
  int32_t count = 0;
  number_of[first] = number;
  list[count++] = first;
  for (int32_t next = 0; next < count; next++) {
    const int32_t f = list[next], *across = &search->neighbour[(int64_t)f * search->edges];
    p.volume += volume_of(search, f, search->boxes[first].low);
    if (f < p.face) p.face = f;
    for (int c = 0; c < 3; c++) {
      p.box.low[c] = fmin(p.box.low[c], search->boxes[f].low[c]);
      p.box.high[c] = fmax(p.box.high[c], search->boxes[f].high[c]);
    }
    for (int e = 0; e < search->edges; e++) {
      if (across[e] < 0) p.closed = 0;
      else if (number_of[across[e]] < 0) {
        number_of[across[e]] = number;
        list[count++] = across[e];
      }
    }
  }
  return p;
}

/* Whether one box lies within another one. */
static int is_within(const ct_bounds *a, const ct_bounds *b)
{
  for (int c = 0; c < 3; c++)
    if (a->low[c] < b->low[c] || a->high[c] > b->high[c]) return 0;
  return 1;
}

/* The first face of the parts that enclose a negative volume and are no cavity of another part. */
static int32_t first_inside_out(const part *parts, int32_t count)
{
  int32_t first = -1;
  for (int32_t k = 0; k < count; k++) {
    int bad = parts[k].closed && parts[k].volume < 0.0;
    for (int32_t j = 0; bad && j < count; j++)
      bad = !(parts[j].closed && parts[j].volume > 0.0 && is_within(&parts[k].box, &parts[j].box));
    if (bad && (first < 0 || parts[k].face < first)) first = parts[k].face;
  }
  return first;
}

ct_status ct_search_inside_out(const ct_search *search, int32_t *face, ct_error *error)
{
  if (search == NULL || face == NULL) return CT_REFUSE_NULL(error);
  const size_t count = (size_t)search->face_count;
  part *parts = ct_allocate(count, sizeof *parts);
  int32_t *number_of = ct_allocate(count, sizeof *number_of),
          *list = ct_allocate(count, sizeof *list), number = 0;
  const int given = parts != NULL && number_of != NULL && list != NULL;
  for (int32_t f = 0; given && f < search->face_count; f++) number_of[f] = -1;
  for (int32_t f = 0; given && f < search->face_count; f++)
    if (number_of[f] < 0) {
      parts[number] = collect(search, f, number, number_of, list);
      number++;
    }
  if (given) *face = first_inside_out(parts, number);
  ct_release(parts);
  ct_release(number_of);
  ct_release(list);
  return given ? CT_OK : CT_NO_MEMORY(error, "the parts of a surface");
}
