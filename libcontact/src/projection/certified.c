#include "projection_internal.h"

#include <math.h>

/* Numbers of pieces of the face that a proof may examine, at first and if necessary; the largest
 * number of closer points that are followed; and the number of descents without a proof after which
 * no more pieces are examined. */
enum { FIRST = 500, BUDGET = 20000, RESTARTS = 20, WALKS = 2 };

/* Scale the face to about unit size if products of its lengths could otherwise overflow. */
static const ct_patch *in_range(const ct_patch *patch, ct_patch *scaled)
{
  int exponent;
  if (patch->size > 1e-20 && patch->size < 1e20) return patch;
  frexp(patch->size, &exponent);
  *scaled = *patch;
  scaled->size = ldexp(patch->size, -exponent);
  for (int j = 0; j < 8; j++)
    for (int k = 0; k < 3; k++) scaled->c[j][k] = ldexp(patch->c[j][k], -exponent);
  return scaled;
}

ct_status ct_project_certified(const ct_patch *patch, const ct_project_options *options,
                               ct_closest *closest)
{
  ct_project_options own = *options;
  ct_patch copy;
  const ct_patch *shown = in_range(patch, &copy);
  int budget = FIRST;
  own.tolerance = fmin(own.tolerance, 1e-7);
  ct_project_robust(patch, &own, closest);
  for (int restart = 0; restart < RESTARTS; restart++) {
    // -- Show that nothing is closer (eq:certified-target)
    own.start[0] = closest->xi[0], own.start[1] = closest->xi[1];
    ct_outcome outcome = ct_proof_search(shown, options->tolerance, budget, own.start, closest);
    closest->certified = outcome == CT_PROVEN;
    if (outcome == CT_PROVEN) return CT_OK;
    // -- No proof: descend along a narrow valley; otherwise, or without success, examine more
    // pieces (eq:valley-along)
    if (outcome == CT_GAVE_UP) {
      if (budget == BUDGET) return CT_NOT_CERTIFIED;
      int lower = ct_follow_valley(shown, own.start, closest);
      if (!lower || restart >= WALKS) budget = BUDGET;
      if (!lower) continue;
    }
    // -- A point is closer: descend again from it
    own.use_start = 1;
    ct_project_robust(patch, &own, closest);
  }
  return CT_NOT_CERTIFIED;
}
