/* Depth of a place of one surface under another. */
#include "side.h"

#include "../base/vector.h"

#include <math.h>

/* A place of one surface, and the other surface. */
typedef struct seeker {
  const ct_search *search;
  double own[3]; /* unit normal at the place */
} seeker;

/* Faces that point in the same direction as the place are far sides (eq:far-side). */
static int points_away(void *user, int32_t face)
{
  const seeker *s = user;
  double normal[3];
  return !ct_search_middle_normal(s->search, face, normal) ||
         !(ct_vector_dot(s->own, normal) < 0.5);
}

double ct_side_depth(const ct_side *side, const ct_search *other, int32_t face, const double xi[2],
                     double y[3])
{
  double N[8], normal[3];
  seeker s = {.search = other};
  ct_face mine;
  ct_nearest nearest;
  ct_segment_shape(side->search->kind, xi, N);
  ct_side_interpolate(side->search, side->search->x, face, N, NULL, y);
  ct_search_face(side->search, face, &mine);
  if (ct_segment_normal(&mine, xi, s.own) != CT_OK) return NAN;
  // The nearest face tells whether the place is inside; if it is a far side, the nearest other face
  // gives the depth.
  for (int k = 0; k < 2; k++) {
    ct_search_point(other, y, -1, HUGE_VAL, CT_SEARCH_TOLERANCE, k == 0 ? NULL : points_away, &s,
                    &nearest);
    if (nearest.face < 0 || !(nearest.signed_distance < 0.0)) return NAN;
    if (ct_vector_dot(s.own, nearest.normal) < 0.5) break;
  }
  if (!ct_search_normal(other, nearest.face, nearest.where, nearest.index, nearest.xi,
                        nearest.normal, normal))
    return NAN;
  return -nearest.signed_distance;
}
