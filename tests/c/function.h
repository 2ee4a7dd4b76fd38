/* The function that a projection minimises, as the methods compute it. */
#ifndef FUNCTION_H
#define FUNCTION_H

#include "../../libcontact/src/projection/projection_internal.h"

#include <math.h>

/* Value f (eq:projection-f), gradient (f,1 f,2) and Hessian (f,11 f,22 f,12) at xi; each may be
 * null. */
static inline void function_at(const ct_face *face, const double point[3], const double xi[2],
                               double *f, double g[2], double H[3])
{
  ct_patch patch;
  ct_closest closest = {.evaluations = 0};
  ct_iterate at = {{xi[0], xi[1]}, NAN, {0}, {NAN, NAN}, {NAN, NAN, NAN}, {0}};
  if (ct_patch_init(&patch, face->kind, face->node, point) == CT_OK)
    ct_iterate_evaluate(&patch, &at, &closest);
  if (f != NULL) *f = at.f;
  for (int a = 0; a < 2 && g != NULL; a++) g[a] = at.g[a];
  for (int i = 0; i < 3 && H != NULL; i++) H[i] = at.H[i];
}

#endif
