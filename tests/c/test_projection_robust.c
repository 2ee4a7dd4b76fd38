/* Inner rules of the robust search. */
#include "../../libcontact/src/projection/robust.c"
#include "../../libcontact/src/shape/shape.h"

#include "faces.h"
#include "tap.h"

enum { CASES = 4000 };

/* What the robust search asks of a face before it looks at samples: whether it is mild
 * (eq:robust-bend, eq:robust-straight, eq:robust-mild); which of nine samples (eq:robust-samples)
 * are no higher than those beside them; and the rounding of f (eq:robust-noise). */
int main(void)
{
  int mild = 0, unlike = 0, wrong = 0;
  for (int trial = 0; trial < CASES; trial++) {
    iterates at;
    double point[3] = {uniform(0.7), uniform(0.7), uniform(0.7)}, t1[3], t2[3], d[3], B = 0, f[9];
    ct_face face = random_face(CT_Q8, 0.02 * (1 + trial % 8));
    ct_patch patch;
    ct_patch_init(&patch, CT_Q8, face.node, point);
    random_xi(CT_Q8, 0.3, at.xi);
    evaluate(&patch, &at);
    ct_segment_tangents(&face, at.xi, t1, t2);
    for (int j = 3; j < 8; j++) B += (j == 3 ? 0.5 : j < 6 ? 1 : 2) * dot(patch.c[j], patch.c[j]);
    double n[3] = {t1[1] * t2[2] - t1[2] * t2[1], t1[2] * t2[0] - t1[0] * t2[2],
                   t1[0] * t2[1] - t1[1] * t2[0]},
           short2 = dot(n, n) / fmax(dot(t1, t1), dot(t2, t2)),
           share = B * (short2 + 2 * value(&patch, at.xi, d)) / (0.2 * short2 * short2);
    if (fabs(share - 1) > 1e-9) unlike += (share < 1) != (is_mild(&patch, &at) != 0);
    mild += share < 1;
    mask valley[9];
    (void)sample(&patch, 9, f);
    valleys(f, 4, valley);
    for (int i = 0; i < 9; i++) {
      int lowest = f[i] == value(&patch, QUADRILATERAL[i], d);
      for (int j = 0; j < 9; j++)
        if (fmax(fabs(QUADRILATERAL[i][0] - QUADRILATERAL[j][0]),
                 fabs(QUADRILATERAL[i][1] - QUADRILATERAL[j][1])) < 1.5)
          lowest &= f[i] <= f[j];
      wrong += lowest != (valley[i] != 0);
    }
  }
  tap_ok(unlike == 0 && mild > CASES / 40, "%d of %d faces are mild, all as the rule says", mild,
         CASES);
  tap_ok(wrong == 0, "samples that are no higher than those beside them");
  const ct_patch large = {.size = 3};
  tap_close(noise(&large, 4) / DBL_EPSILON, 8 * (4 + 3 * 2), 1e-12, "rounding of f");
  return tap_done();
}
