#include "projection_internal.h"

/* Jacobian of the gradient, not symmetric once it is updated. */
typedef struct jacobian {
  double J[2][2];
  int known;
} jacobian;

/* The smallest change of the Jacobian that explains the new gradient. */
static void broyden_update(jacobian *B, const double s[2], const double g[2])
{
  double square = s[0] * s[0] + s[1] * s[1];
  if (!(square > 0)) return;
  // -- Since J s = -g before the step, what is left over is the new gradient (eq:broyden-update)
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) B->J[a][b] += g[a] * s[b] / square;
}

/* The next step, after the last one, s. */
static int broyden_step(const ct_patch *patch, const ct_iterate *at, double s[2], void *memory)
{
  jacobian *B = memory, first = {{{at->H[0], at->H[2]}, {at->H[2], at->H[1]}}, 1};
  const double *g = at->g;
  (void)patch;
  // -- The first Jacobian is the true one
  if (B->known) broyden_update(B, s, g);
  else *B = first;
  double (*J)[2] = B->J, determinant = J[0][0] * J[1][1] - J[0][1] * J[1][0];
  // -- Newton's step with the Jacobian that we have (eq:broyden-step)
  s[0] = (J[0][1] * g[1] - J[1][1] * g[0]) / determinant;
  s[1] = (J[1][0] * g[0] - J[0][0] * g[1]) / determinant;
  return 1;
}

ct_status ct_project_broyden(const ct_patch *patch, const ct_project_options *options,
                             ct_closest *closest)
{
  jacobian B = {{{0}}, 0};
  return ct_iterate_walk(patch, options, 200, 0, broyden_step, &B, closest);
}
