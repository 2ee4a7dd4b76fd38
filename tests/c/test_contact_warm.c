/* Which points are settled by the face of the last step alone. */
#include "../../libcontact/src/contact/warm.c"

#include "tap.h"

/* One point of eight, open, with nothing near (eq:warm-lanes): settled inside the face and nearer
 * than contact looks, not on an edge or a corner, nor beyond; nor where the box of another face is
 * as near. */
int main(void)
{
  static const double place[3] = {-1.0, 0.4, 1.0};
  ct_side_fixed fixed = {.rule.count = 1};
  ct_point none = {.other = -1};
  ct_side side = {.fixed = &fixed, .points = &none};
  const ct_pass p = {.side = &side, .project = ct_project_options_default(), .depth = 0.5};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 4; k++) {
        block b = {.xi = {[3] = place[i], [11] = place[j]}, .status = {[3] = CT_OK}};
        b.distance[3] = b.gap[3] = k % 2 ? 0.501 : 0.499;
        b.rival[3] = k / 2;
        tap_ok(is_settled(&p, &b, 3) == (i == 1 && j == 1 && k == 0),
               "closest point (%g, %g) at %g, %s", place[i], place[j], b.distance[3],
               k / 2 ? "with a rival" : "alone");
      }
  return tap_done();
}
