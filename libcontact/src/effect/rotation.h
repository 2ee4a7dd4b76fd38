#ifndef CT_SRC_ROTATION_H
#define CT_SRC_ROTATION_H

#include "../base/vector.h"

/* Moments of mass Σ m r rᵀ of a body in the order xx yy zz xy yz zx, and what it may turn about. */
typedef struct ct_inertia {
  double moment[6];
  int fixed[3]; /* whether it cannot turn about x, y, z */
} ct_inertia;

/* Θ w with Θ = tr(J) I - J of the moments J = Σ m r rᵀ (eq:rigid-inertia). */
void ct_inertia_times(const ct_inertia *inertia, const double w[3], double out[3]);

/* The w with the fixed components 0 whose Θ w has the free components of g. */
void ct_inertia_solve(const ct_inertia *inertia, const double g[3], double w[3]);

/* The turn by the unit quaternion (a, b) whose discrete angular momentum times Δt is g
 * (eq:rigid-rotation). Returns 0 if there is none: the turn of one step is too large. */
int ct_rotation_find(const ct_inertia *inertia, const double g[3], double b[3], double *a);

/* (R - I) r of this turn. */
static inline void ct_rotation_increment(const double b[3], double a, const double r[3],
                                         double out[3])
{
  double once[3], twice[3];
  ct_vector_cross(b, r, once);
  ct_vector_cross(b, once, twice);
  // -- (R - I) r = 2 a b × r + 2 b × (b × r) (eq:rigid-quaternion)
  for (int c = 0; c < 3; c++) out[c] = 2.0 * (a * once[c] + twice[c]);
}

#endif
