#include "projection_internal.h"

#include <math.h>

/* B approximates the inverse of the Hessian: (B11 B22 B12). */
static void bfgs_step(const double B[3], const double g[2], double s[2])
{
  // -- Step with the approximate inverse (eq:bfgs-step)
  s[0] = -(B[0] * g[0] + B[2] * g[1]);
  s[1] = -(B[2] * g[0] + B[1] * g[1]);
}

/* Teach B that the step s has changed the gradient by y. */
static void bfgs_update(double B[3], const double s[2], const double y[2], int first)
{
  double sy = s[0] * y[0] + s[1] * y[1], yy = y[0] * y[0] + y[1] * y[1];
  // -- Only a step along which f bends upwards can be learned from
  if (!(sy > 0 && sy < HUGE_VAL && yy > 0)) return;
  // -- Before the first lesson, give B the size of what was seen (eq:bfgs-scale)
  if (first) B[0] = B[1] = sy / yy, B[2] = 0;
  double z[2] = {B[0] * y[0] + B[2] * y[1], B[2] * y[0] + B[1] * y[1]},
         factor = 1 + (y[0] * z[0] + y[1] * z[1]) / sy;
  // -- Update of the inverse (eq:bfgs-update)
  B[0] += (factor * (s[0] * s[0]) - 2 * (s[0] * z[0])) / sy;
  B[1] += (factor * (s[1] * s[1]) - 2 * (s[1] * z[1])) / sy;
  B[2] += (factor * (s[0] * s[1]) - (s[0] * z[1] + s[1] * z[0])) / sy;
}

ct_status ct_project_bfgs(const ct_patch *patch, const ct_project_options *options, ct_foot *foot)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 200, done = 0;
  double half_width = ct_patch_half_width(patch->kind), tolerance = options->tolerance * half_width,
         before = 2 * tolerance, s[2];
  ct_iterate at, next;
  ct_iterate_start(patch, options, at.xi);
  ct_iterate_visit(patch, options, &at, foot);
  double first = 0.5 * half_width / sqrt(at.g[0] * at.g[0] + at.g[1] * at.g[1]),
         B[3] = {first, first, 0};
  for (; !done && foot->iterations < limit; foot->iterations++) {
    bfgs_step(B, at.g, s);
    if (!ct_line_search(patch, &at, s, &next, foot)) break;
    double y[2];
    for (int a = 0; a < 2; a++) s[a] = next.xi[a] - at.xi[a], y[a] = next.g[a] - at.g[a];
    bfgs_update(B, s, y, foot->iterations == 0);
    done = ct_iterate_done(s, tolerance, &before);
    at = next;
    if (options->trace != NULL) options->trace(at.xi, at.f, options->user);
  }
  ct_status verdict = ct_iterate_verdict(patch, options, &at, foot);
  return foot->iterations < limit || done ? verdict : CT_ITERATION_LIMIT;
}
