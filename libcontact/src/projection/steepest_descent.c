#include "projection_internal.h"

#include <math.h>

/* The step along -g to the lowest point of the parabola that f is along it; where f bends down, a
 * half-width. */
static void steepest_step(const ct_iterate *at, double half_width, double s[2])
{
  const double *H = at->H;
  double slope = sqrt(at->g[0] * at->g[0] + at->g[1] * at->g[1]),
         e[2] = {at->g[0] / slope, at->g[1] / slope};
  double bend = H[0] * (e[0] * e[0]) + 2 * H[2] * (e[0] * e[1]) + H[1] * (e[1] * e[1]);
  // -- Length of the step, along a unit vector so that no product leaves the range of numbers
  // (eq:steepest-length)
  double length = bend > 0 ? fmin(slope / bend, half_width) : half_width;
  for (int a = 0; a < 2; a++) s[a] = -length * e[a];
}

ct_status ct_project_steepest_descent(const ct_patch *patch, const ct_project_options *options,
                                      ct_foot *foot)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 2000, done = 0;
  double half_width = ct_patch_half_width(patch->kind), tolerance = options->tolerance * half_width,
         before = 2 * tolerance, s[2];
  ct_iterate at, next;
  ct_iterate_start(patch, options, at.xi);
  ct_iterate_visit(patch, options, &at, foot);
  for (; !done && foot->iterations < limit; foot->iterations++) {
    if (at.g[0] == 0 && at.g[1] == 0) break;
    steepest_step(&at, half_width, s);
    if (!ct_line_search(patch, &at, s, &next, foot)) break;
    for (int a = 0; a < 2; a++) s[a] = next.xi[a] - at.xi[a];
    done = ct_iterate_done(s, tolerance, &before);
    at = next;
    if (options->trace != NULL) options->trace(at.xi, at.f, options->user);
  }
  ct_status verdict = ct_iterate_verdict(patch, options, &at, foot);
  return foot->iterations < limit || done ? verdict : CT_ITERATION_LIMIT;
}
