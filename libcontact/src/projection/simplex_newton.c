#include "projection_internal.h"

ct_status ct_project_simplex_newton(const ct_patch *patch, const ct_project_options *options,
                                    ct_foot *foot)
{
  ct_project_options own = *options;
  // -- The simplex until its edge is an eighth of the half-width (eq:simplex-newton)
  own.tolerance = 0.125;
  ct_status status = ct_project_simplex(patch, &own, foot);
  if (status != CT_OK) return status;
  // -- Newton from its lowest vertex
  int simplex_iterations = foot->iterations;
  own.tolerance = options->tolerance;
  own.use_start = 1;
  own.start[0] = foot->xi[0];
  own.start[1] = foot->xi[1];
  status = ct_project_newton(patch, &own, foot);
  foot->iterations += simplex_iterations;
  return status;
}
