#include "projection_internal.h"

#include <math.h>

/* Pieces of the face that a proof may look at, at first and if need be, and how often something closer may turn up. */
enum { FIRST = 500, BUDGET = 20000, RESTARTS = 20 };

ct_status ct_project_certified(const ct_patch *patch, const ct_project_options *options, ct_foot *foot)
{
  ct_project_options own = *options;
  int budget = FIRST;
  own.tolerance = fmin(own.tolerance, 1e-7);
  ct_project_robust(patch, &own, foot);
  for (int restart = 0; restart < RESTARTS; restart++) {
    // -- Show that nothing is closer (eq:certified-target)
    own.start[0] = foot->xi[0], own.start[1] = foot->xi[1];
    ct_outcome outcome = ct_proof_search(patch, options->tolerance, budget, own.start, foot);
    foot->certified = outcome == CT_PROVEN;
    if (outcome == CT_PROVEN) return CT_OK;
    // -- No proof: look for a way down along a narrow valley, else look longer (eq:valley-along)
    if (outcome == CT_GAVE_UP && !ct_follow_valley(patch, own.start, foot)) {
      if (budget == BUDGET) return CT_NOT_CERTIFIED;
      budget = BUDGET;
      continue;
    }
    // -- Something is closer: descend again, from there
    own.use_start = 1;
    ct_project_robust(patch, &own, foot);
  }
  return CT_NOT_CERTIFIED;
}
