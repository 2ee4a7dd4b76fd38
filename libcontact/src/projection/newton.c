#include "projection_internal.h"

#include <math.h>

/* An iterate this far out, in reference coordinates, does not come back. */
static const double FAR = 1e3;

/* Newton's step on the stationarity conditions; answers 0 when the Hessian is singular. */
static int newton_step(const double g[2], const double H[3], double s[2])
{
  double determinant = H[0] * H[1] - H[2] * H[2];
  // -- Solve for the step (eq:projection-newton)
  s[0] = (H[2] * g[1] - H[1] * g[0]) / determinant;
  s[1] = (H[2] * g[0] - H[0] * g[1]) / determinant;
  return fabs(s[0]) < HUGE_VAL && fabs(s[1]) < HUGE_VAL;
}

ct_status ct_project_newton(const ct_patch *patch, const ct_project_options *options, ct_foot *foot)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 100;
  double tolerance = options->tolerance * ct_patch_half_width(patch->kind), g[2], H[3], s[2];
  double *xi = foot->xi, centre = ct_patch_centre(patch->kind);
  for (int a = 0; a < 2; a++) xi[a] = options->use_start ? options->start[a] : centre;
  for (foot->iterations = 0; foot->iterations < limit; foot->iterations++) {
    double f = ct_patch_derivatives(patch, xi, foot->d, g, H);
    foot->evaluations++;
    if (options->trace != NULL) options->trace(xi, f, options->user);
    if (!newton_step(g, H, s)) return CT_NO_CONVERGENCE;
    // -- A root is the closest point only where f is convex (eq:projection-convex)
    int minimum = H[0] + H[1] > 0 && H[0] * H[1] > H[2] * H[2];
    int done = fmax(fabs(s[0]), fabs(s[1])) <= tolerance;
    xi[0] += s[0];
    xi[1] += s[1];
    if (!done && fmax(fabs(xi[0]), fabs(xi[1])) < FAR) continue;
    ct_patch_value(patch, xi, foot->d);
    return done && minimum ? CT_OK : CT_NO_CONVERGENCE;
  }
  ct_patch_value(patch, xi, foot->d);
  return CT_ITERATION_LIMIT;
}
