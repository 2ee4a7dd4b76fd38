/* The gaps of all points of two surfaces, or of one with itself. */
#include "gaps.h"

#include <math.h>

/* Forget the faces of the last update; a host may have called it for another state. */
static void forget_faces(ct_side *side)
{
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
      p->other = -1;
      p->jumped = CT_POINT_NO_JUMP;
      p->row.gap = NAN;
      p->xi[0] = p->xi[1] = 0.0;
      p->last_known = p->known;
      p->known = NAN;
      if (p->status != CT_POINT_BURIED) p->status = CT_POINT_NEW;
    }
}

ct_status ct_gaps_place(ct_gaps *gaps, ct_error *error)
{
  const int surfaces = ct_gaps_surfaces(gaps->fixed);
  // No node moves before all checks pass: after an error the motion still counts from the last good
  // call.
  for (int s = 0; s < surfaces; s++) {
    ct_status status = ct_search_check(gaps->side[s].search, NULL, gaps->side[s].moved, s, error);
    if (status != CT_OK) return status;
  }
  for (int s = 0; s < surfaces; s++) ct_side_place(&gaps->side[s]);
  return CT_OK;
}

ct_status ct_gaps_measure(ct_gaps *gaps, int threads, ct_error *error)
{
  const int sides = gaps->fixed->sides;
  ct_status status = ct_gaps_place(gaps, error);
  if (status != CT_OK) return status;
  if (!ct_gaps_mark_creases(gaps) && ct_gaps_are_separated(gaps)) {
    for (int s = 0; s < sides; s++) forget_faces(&gaps->side[s]);
    return CT_OK;
  }
  for (int s = 0; s < sides; s++) ct_search_box(gaps->side[s].search);
  status = ct_gaps_list_candidates(gaps, error);
  for (int s = 0; status == CT_OK && s < sides; s++) ct_pass_search(gaps, s, threads);
  if (status == CT_OK) gaps->begun = 1;
  return status;
}
