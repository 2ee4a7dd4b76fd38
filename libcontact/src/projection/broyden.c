#include "projection_internal.h"

/* H approximates the Hessian; it is not symmetric after an update. */
typedef struct hessian {
  double H[2][2];
  int known;
} hessian;

/* The smallest change of H that explains the new gradient. */
static void broyden_update(hessian *learned, const double s[2], const double g[2])
{
  double square = s[0] * s[0] + s[1] * s[1];
  if (!(square > 0)) return;
  // -- Since H s = -g before the step, the residual is the new gradient (eq:broyden-update)
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) learned->H[a][b] += g[a] * s[b] / square;
}

/* The next step, after the last one, s. */
static int broyden_step(const ct_patch *patch, const ct_iterate *at, double s[2], void *memory)
{
  hessian *learned = memory, first = {{{at->H[0], at->H[2]}, {at->H[2], at->H[1]}}, 1};
  const double *g = at->g;
  (void)patch;
  // -- The first H is the true one
  if (learned->known) broyden_update(learned, s, g);
  else *learned = first;
  double (*H)[2] = learned->H, determinant = H[0][0] * H[1][1] - H[0][1] * H[1][0];
  // -- Newton's step with the Hessian that we have (eq:broyden-step)
  s[0] = (H[0][1] * g[1] - H[1][1] * g[0]) / determinant;
  s[1] = (H[1][0] * g[0] - H[0][0] * g[1]) / determinant;
  return 1;
}

ct_status ct_project_broyden(const ct_patch *patch, const ct_project_options *options,
                             ct_closest *closest)
{
  hessian learned = {{{0}}, 0};
  return ct_iterate_walk(patch, options, 200, 0, broyden_step, &learned, closest);
}
