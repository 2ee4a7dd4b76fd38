#include "projection_internal.h"

/* Jacobian of the gradient, not symmetric once it is updated. */
typedef struct jacobian {
  double J[2][2];
} jacobian;

static void broyden_step(const jacobian *B, const double g[2], double s[2])
{
  const double (*J)[2] = B->J;
  double determinant = J[0][0] * J[1][1] - J[0][1] * J[1][0];
  // -- Newton's step with the Jacobian that we have (eq:broyden-step)
  s[0] = (J[0][1] * g[1] - J[1][1] * g[0]) / determinant;
  s[1] = (J[1][0] * g[0] - J[0][0] * g[1]) / determinant;
}

/* The smallest change of the Jacobian that explains the new gradient. */
static void broyden_update(jacobian *B, const double s[2], const double g[2])
{
  double square = s[0] * s[0] + s[1] * s[1];
  if (!(square > 0)) return;
  // -- Since J s = -g before the step, what is left over is the new gradient (eq:broyden-update)
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) B->J[a][b] += g[a] * s[b] / square;
}

ct_status ct_project_broyden(const ct_patch *patch, const ct_project_options *options,
                             ct_foot *foot)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : 200, done = 0, inside = 1;
  double tolerance = options->tolerance * ct_patch_half_width(patch->kind), before = 2 * tolerance,
         s[2];
  ct_iterate at;
  ct_iterate_start(patch, options, at.xi);
  ct_iterate_visit(patch, options, &at, foot);
  // -- The first Jacobian is the true one
  jacobian B = {{{at.H[0], at.H[2]}, {at.H[2], at.H[1]}}};
  while (!done && inside && foot->iterations < limit) {
    broyden_step(&B, at.g, s);
    inside = ct_iterate_step(at.xi, s);
    done = ct_iterate_done(s, tolerance, &before);
    ct_iterate_visit(patch, options, &at, foot);
    broyden_update(&B, s, at.g);
    foot->iterations++;
  }
  ct_status verdict = ct_iterate_verdict(patch, options, &at, foot);
  return done ? verdict : inside ? CT_ITERATION_LIMIT : CT_NO_CONVERGENCE;
}
