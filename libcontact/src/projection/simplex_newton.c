#include "projection_internal.h"

ct_status ct_project_simplex_newton(const ct_patch *patch, const ct_project_options *options,
                                    ct_closest *closest)
{
  ct_project_options own = *options;
  // -- The simplex until its edge is an eighth of the half-width
  own.tolerance = 0.125; // (eq:simplex-newton)
  ct_status status = ct_project_simplex(patch, &own, closest);
  if (status != CT_OK) return status;
  // -- Newton from its lowest vertex
  int simplex_iterations = closest->iterations;
  own.tolerance = options->tolerance;
  own.use_start = 1;
  own.start[0] = closest->xi[0];
  own.start[1] = closest->xi[1];
  status = ct_project_newton(patch, &own, closest);
  closest->iterations += simplex_iterations;
  return status;
}
