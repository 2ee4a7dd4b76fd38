#include "projection_internal.h"

#include <math.h>

ct_status ct_project_newton(const ct_patch *patch, const ct_project_options *options,
                            ct_closest *closest)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 100;
  double tolerance = options->tolerance * ct_patch_half_width(patch->kind), s[2];
  ct_status status = CT_ITERATION_LIMIT;
  ct_iterate at;
  ct_iterate_start(patch, options, at.xi);
  for (closest->iterations = 0; closest->iterations < limit; closest->iterations++) {
    ct_iterate_visit(patch, options, &at, closest);
    double determinant = ct_newton_step(&at, s);
    status = CT_NO_CONVERGENCE;
    if (!(fabs(s[0]) < HUGE_VAL && fabs(s[1]) < HUGE_VAL)) break;
    for (int a = 0; a < 2; a++) at.xi[a] += s[a];
    // -- A root is the closest point only where f is convex (eq:projection-convex)
    int minimum = at.H[0] + at.H[1] > 0 && determinant > 0;
    int done = fmax(fabs(s[0]), fabs(s[1])) <= tolerance;
    if (done && minimum) status = CT_OK;
    if (done || !(fmax(fabs(at.xi[0]), fabs(at.xi[1])) < CT_FAR)) break;
    status = CT_ITERATION_LIMIT;
  }
  for (int a = 0; a < 2; a++) closest->xi[a] = at.xi[a];
  ct_patch_value(patch, closest->xi, closest->d);
  return status;
}
