/* robust for LANES pairs of face and point side by side; batch4.c and batch8.c define LANES, TARGET
 * and KERNEL and include this. The arithmetic of each lane is that of robust.c and patch.c,
 * operation for operation; what is rare there is left to ct_project here. A vector is as wide as
 * the machine compares at once: of wider ones gcc splits up the comparisons into single lanes. */
#include "batch_internal.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

typedef double lanes __attribute__((vector_size(8 * LANES), may_alias));
typedef double loose __attribute__((vector_size(8 * LANES), may_alias, aligned(8)));
typedef int64_t mask __attribute__((vector_size(8 * LANES), may_alias));

/* A part of the kernel. It names the instruction set itself: gcc splits up vectors that a function
 * cannot have before it inlines. */
#define PART static inline __attribute__((always_inline, target(TARGET)))

/* A comparison answers with all bits or none of a lane; PICK chooses by that. */
#define PICK(m, a, b) ((lanes)(((m) & (mask)(a)) | (~(m) & (mask)(b))))
#define LEAST(a, b) PICK((b) < (a), b, a)
#define MOST(a, b) PICK((b) > (a), b, a)
#define SIZE(a) ((lanes)((mask)(a) & INT64_MAX))
#define DOT(a, b) (((a)[0] * (b)[0] + (a)[1] * (b)[1]) + (a)[2] * (b)[2])

/* Steps before a lane is left to ct_project. */
enum { STEPS = 12 };

/* The polynomials of LANES faces as seen from their points, see ct_patch. */
typedef struct patches {
  lanes c[8][3], size;
  mask good;
} patches;

/* As many iterates, with f and its derivatives there, and the products of the tangents. */
typedef struct iterates {
  lanes xi[2], f, g[2], H[3], square[3];
} iterates;

/* The models of f about the iterates, see robust.c. */
typedef struct models {
  lanes g[2], H[3], low[2], high[2];
} models;

/* Their search. Those in `hard` are left to ct_project; those in `rough` are not mild and want
 * samples; of those in `cold` it is to be seen whether the foot is the closest point, which is not
 * easy to see of those in `doubtful`. */
typedef struct searches {
  iterates at;
  lanes radius, before, tolerance, limit, evaluations;
  mask active, hard, rough, cold, doubtful;
} searches;

PART int any(const mask *m)
{
  int64_t all = 0;
  for (int l = 0; l < LANES; l++) all |= (*m)[l];
  return all != 0;
}

PART lanes *root(lanes *a)
{
  double *value = (double *)a;
#pragma omp simd
  for (int l = 0; l < LANES; l++) value[l] = sqrt(value[l]);
  return a;
}

PART void corners_to_patch(const lanes v[8], const lanes *p, lanes c[8][3], int k)
{
  // -- Corners (eq:projection-patch-q4)
  lanes all = ((v[0] - *p) + (v[1] - *p)) + ((v[2] - *p) + (v[3] - *p)),
        right = (v[1] - v[0]) + (v[2] - v[3]);
  lanes up = (v[3] - v[0]) + (v[2] - v[1]), twist = (v[0] - v[1]) + (v[2] - v[3]);
  c[0][k] = 0.25 * all, c[1][k] = 0.25 * right, c[2][k] = 0.25 * up, c[3][k] = 0.25 * twist;
  for (int j = 4; j < 8; j++) c[j][k] = 0 * *p;
}

PART void sides_to_patch(const lanes v[8], const lanes *p, lanes c[8][3], int k)
{
  // -- Mid-sides (eq:projection-patch-q8)
  lanes corners = c[0][k], right = c[1][k], up = c[2][k];
  c[0][k] = 0.5 * (((v[4] - *p) + (v[6] - *p)) + ((v[5] - *p) + (v[7] - *p))) - corners;
  c[1][k] = 0.5 * (v[5] - v[7]);
  c[2][k] = 0.5 * (v[6] - v[4]);
  c[4][k] = 0.25 * (((v[0] - v[4]) + (v[1] - v[4])) + ((v[2] - v[6]) + (v[3] - v[6])));
  c[5][k] = 0.25 * (((v[0] - v[7]) + (v[3] - v[7])) + ((v[1] - v[5]) + (v[2] - v[5])));
  c[6][k] = up - c[2][k];
  c[7][k] = right - c[1][k];
}

PART void patches_init(patches *patch, int count, const double *nodes, const double *points,
                       int lane)
{
  lanes all = {0}, far = all;
  patch->size = far;
  for (int k = 0; k < 3; k++) {
    // -- Subtract the point first (eq:projection-shift)
    lanes v[8], p = *(const loose *)(const void *)&points[8 * k + lane];
    for (int i = 0; i < count; i++)
      v[i] = *(const loose *)(const void *)&nodes[8 * (3 * i + k) + lane];
    corners_to_patch(v, &p, patch->c, k);
    if (count == 8) sides_to_patch(v, &p, patch->c, k);
    for (int j = 0; j < 8; j++) {
      lanes size = SIZE(patch->c[j][k]);
      all += size;
      if (j > 0) patch->size = MOST(patch->size, size);
      else far = MOST(far, size);
    }
  }
  // A comparison does not see NaN, a sum does
  patch->good = (all < 1e72) & (patch->size > 1e-70) & (patch->size < 1e70) & (far < 1e70);
}

PART void value(const patches *patch, const lanes xi[2], lanes d[3], lanes *f)
{
  const lanes(*c)[3] = patch->c;
  lanes x = xi[0], y = xi[1], xx = x * x, yy = y * y, xy = x * y;
  for (int k = 0; k < 3; k++) {
    // -- Point of the patch (eq:projection-patch)
    lanes a = c[4][k] + c[6][k] * y, b = c[5][k] + c[7][k] * x;
    d[k] = ((c[0][k] + c[3][k] * xy) + (c[1][k] * x + c[2][k] * y)) + (a * xx + b * yy);
  }
  *f = DOT(d, d);
}

PART void tangents(const patches *patch, const lanes xi[2], lanes t1[3], lanes t2[3])
{
  const lanes(*c)[3] = patch->c;
  lanes x = xi[0], y = xi[1], xx = x * x, yy = y * y, two_x = 2 * x, two_y = 2 * y;
  for (int k = 0; k < 3; k++) {
    // -- Tangents of the patch (eq:projection-patch-derivatives)
    lanes a = c[4][k] + c[6][k] * y, b = c[5][k] + c[7][k] * x;
    t1[k] = (c[1][k] + c[3][k] * y) + (a * two_x + c[7][k] * yy);
    t2[k] = (c[2][k] + c[3][k] * x) + (b * two_y + c[6][k] * xx);
  }
}

PART void curves(const patches *patch, const lanes xi[2], lanes t11[3], lanes t22[3], lanes t12[3])
{
  const lanes(*c)[3] = patch->c;
  for (int k = 0; k < 3; k++) {
    // -- Second derivatives of the patch (eq:projection-patch-derivatives)
    t11[k] = 2 * (c[4][k] + c[6][k] * xi[1]);
    t22[k] = 2 * (c[5][k] + c[7][k] * xi[0]);
    t12[k] = c[3][k] + 2 * (c[6][k] * xi[0] + c[7][k] * xi[1]);
  }
}

/* f, gradient and Hessian at at->xi, see ct_polynomial_look. */
PART void look(const patches *patch, iterates *at)
{
  const lanes(*c)[3] = patch->c;
  lanes x = at->xi[0], y = at->xi[1], xx = x * x, yy = y * y, xy = x * y, two_x = 2 * x,
        two_y = 2 * y;
  lanes d[3], t1[3], t2[3], a[3], b[3], t12[3];
  for (int k = 0; k < 3; k++) {
    // -- Point, tangents, second derivatives 2 a, 2 b, t12 (eq:projection-patch,
    // eq:projection-patch-derivatives)
    a[k] = c[4][k] + c[6][k] * y, b[k] = c[5][k] + c[7][k] * x;
    d[k] = ((c[0][k] + c[3][k] * xy) + (c[1][k] * x + c[2][k] * y)) + (a[k] * xx + b[k] * yy);
    t1[k] = (c[1][k] + c[3][k] * y) + (a[k] * two_x + c[7][k] * yy);
    t2[k] = (c[2][k] + c[3][k] * x) + (b[k] * two_y + c[6][k] * xx);
    t12[k] = c[3][k] + (c[6][k] * two_x + c[7][k] * two_y);
  }
  // -- Gradient and Hessian (eq:projection-gradient, eq:projection-hessian)
  at->f = DOT(d, d);
  at->g[0] = 2 * DOT(d, t1);
  at->g[1] = 2 * DOT(d, t2);
  at->square[0] = DOT(t1, t1), at->square[1] = DOT(t2, t2), at->square[2] = DOT(t1, t2);
  at->H[0] = 2 * (at->square[0] + 2 * DOT(d, a));
  at->H[1] = 2 * (at->square[1] + 2 * DOT(d, b));
  at->H[2] = 2 * (at->square[2] + DOT(d, t12));
}

/* Take over the iterates of some lanes. */
PART void take(iterates *at, const iterates *from, const mask *m)
{
  at->f = PICK(*m, from->f, at->f);
  for (int a = 0; a < 2; a++)
    at->xi[a] = PICK(*m, from->xi[a], at->xi[a]), at->g[a] = PICK(*m, from->g[a], at->g[a]);
  for (int i = 0; i < 3; i++)
    at->H[i] = PICK(*m, from->H[i], at->H[i]),
    at->square[i] = PICK(*m, from->square[i], at->square[i]);
}

/* f at corners, mid-sides and centre. */
PART void sample(const patches *patch, lanes f[9])
{
  lanes d[9][3];
  for (int k = 0; k < 3; k++) {
    // -- Corners, mid-sides and centre (eq:robust-samples)
    lanes c0 = patch->c[0][k], twist = patch->c[3][k], right = patch->c[1][k], up = patch->c[2][k];
    lanes row = c0 + patch->c[5][k], column = c0 + patch->c[4][k],
          corner = c0 + (patch->c[4][k] + patch->c[5][k]);
    lanes across = right + patch->c[7][k], along = up + patch->c[6][k];
    d[0][k] = (corner + twist) - (across + along);
    d[1][k] = (corner - twist) + (across - along);
    d[2][k] = (corner + twist) + (across + along);
    d[3][k] = (corner - twist) - (across - along);
    d[4][k] = row - up;
    d[5][k] = column + right;
    d[6][k] = row + up;
    d[7][k] = column - right;
    d[8][k] = c0;
  }
  for (int i = 0; i < 9; i++) f[i] = DOT(d[i], d[i]);
}

/* The only valley among the samples; with several the lane is hard. */
PART void choose_valley(const lanes f[9], lanes xi[2], mask *hard)
{
  static const double AT[9][2] = {{-1, -1}, {1, -1}, {1, 1},  {-1, 1}, {0, -1},
                                  {1, 0},   {0, 1},  {-1, 0}, {0, 0}};
  lanes found = {0};
  xi[0] = xi[1] = found;
  mask centre = f[8] <= f[0];
  for (int j = 1; j < 8; j++) centre &= f[8] <= f[j];
  found = PICK(centre, found + 1, found);
  for (int i = 0; i < 8; i++) {
    int j = i % 4, after = (j + 1) % 4, before = (j + 3) % 4;
    mask valley = (f[i] <= f[8]) & (f[i] <= f[4 + before]);
    if (i < 4) valley &= f[i] <= f[4 + j];
    else valley &= (f[i] <= f[j]) & (f[i] <= f[after]) & (f[i] <= f[4 + after]);
    found = PICK(valley, found + 1, found);
    for (int a = 0; a < 2; a++) xi[a] = PICK(valley, AT[i][a] + 0 * found, xi[a]);
  }
  *hard = found != 1;
}

/* Bring xi onto the face, and onto its edge where only rounding is between. */
PART void snap(lanes xi[2])
{
  for (int a = 0; a < 2; a++) {
    lanes one = 0 * xi[a] + 1;
    xi[a] = PICK(xi[a] > 1 - 2 * DBL_EPSILON, one, xi[a]);
    xi[a] = PICK(xi[a] < -1 + 2 * DBL_EPSILON, -one, xi[a]);
  }
}

/* Are the faces so nearly plane, as seen from iterates near their feet, that f has one valley only?
 */
PART void is_mild(const patches *patch, const iterates *at, mask *mild)
{
  const lanes(*c)[3] = patch->c;
  lanes bent[3], straight = at->square[0] * at->square[1] - at->square[2] * at->square[2];
  for (int k = 0; k < 3; k++)
    bent[k] = 0.5 * (c[3][k] * c[3][k]) + ((c[4][k] * c[4][k] + c[5][k] * c[5][k]) +
                                           2 * (c[6][k] * c[6][k] + c[7][k] * c[7][k]));
  straight /= MOST(at->square[0], at->square[1]);
  // -- Compare what is not linear with what is (eq:robust-mild)
  *mild =
      ((bent[0] + bent[1]) + bent[2]) * (straight + 2 * at->f) <= CT_MILD * (straight * straight);
}

/* Begin at the given starts, or at the centres of the faces. */
PART void begin(const patches *patch, const double *start, int lane, double tolerance, searches *s)
{
  lanes zero = {0};
  s->at.xi[0] = s->at.xi[1] = zero;
  s->hard = ~patch->good;
  if (start != NULL) {
    for (int a = 0; a < 2; a++) s->at.xi[a] = *(const loose *)(const void *)&start[8 * a + lane];
    s->hard |= ~((SIZE(s->at.xi[0]) < HUGE_VAL) & (SIZE(s->at.xi[1]) < HUGE_VAL));
    snap(s->at.xi);
  }
  look(patch, &s->at);
  s->radius = s->before = s->evaluations = zero + 1;
  s->limit = s->tolerance = zero + tolerance;
  s->rough = s->cold = s->doubtful = zero != zero;
  s->active = ~s->hard;
}

/* The lanes that are not mild begin again: at the valley among the samples, or at the given start
 * if no sample is lower. */
PART void begin_again(const patches *patch, int warm, double tolerance, searches *s)
{
  lanes f[9], zero = {0}, lowest;
  iterates next;
  sample(patch, f);
  mask several, again = zero != zero, rough = s->rough;
  choose_valley(f, next.xi, &several);
  if (warm) {
    lowest = f[0];
    for (int i = 1; i < 9; i++) lowest = LEAST(lowest, f[i]);
    lanes length = lowest;
    root(&length);
    again = s->at.f <= lowest + 8 * DBL_EPSILON * (lowest + patch->size * length);
    for (int a = 0; a < 2; a++) next.xi[a] = PICK(again, s->at.xi[a], next.xi[a]);
  }
  s->cold = rough & ~again;
  s->hard |= s->cold & several;
  look(patch, &next);
  take(&s->at, &next, &rough);
  s->radius = PICK(rough, zero + 1, s->radius);
  s->before = PICK(rough, zero + 1, s->before);
  s->tolerance =
      PICK(s->cold, zero + (tolerance < CT_PROVABLE ? tolerance : CT_PROVABLE), s->tolerance);
  // Nine samples, the first look, and for the cold one at the end
  s->evaluations = PICK(rough, s->evaluations + 10, s->evaluations);
  s->evaluations = PICK(s->cold, s->evaluations + 1, s->evaluations);
  s->active = rough & ~s->hard;
}

PART void model_value(const models *q, const lanes s[2], lanes *v)
{
  lanes linear = q->g[0] * s[0] + q->g[1] * s[1];
  *v = linear +
       (0.5 * (q->H[0] * (s[0] * s[0]) + q->H[1] * (s[1] * s[1])) + q->H[2] * (s[0] * s[1]));
}

PART void model_keep(const models *q, const lanes s[2], const mask *allowed, lanes *best_value,
                     lanes best[2])
{
  lanes v;
  model_value(q, s, &v);
  mask lower = *allowed & (v < *best_value);
  *best_value = PICK(lower, v, *best_value);
  for (int a = 0; a < 2; a++) best[a] = PICK(lower, s[a], best[a]);
}

/* Lowest points of the models on the four sides of their regions (eq:robust-side). */
PART void model_sides(const models *q, lanes *best_value, lanes best[2])
{
  lanes s[2], zero = {0};
  *best_value = best[0] = best[1] = zero;
  for (int side = 0; side < 4; side++) {
    int axis = side / 2, other = 1 - axis;
    lanes bound = side % 2 ? q->high[axis] : q->low[axis], low = q->low[other],
          high = q->high[other];
    // -- Root of the slope along a side, or its two ends (eq:robust-side)
    lanes slope = q->g[other] + q->H[2] * bound, curvature = q->H[other],
          place = -slope / curvature;
    mask allowed = low <= high, up = curvature > 0;
    place = MOST(place, low);
    place = LEAST(place, high);
    s[axis] = bound;
    s[other] = PICK(up, place, low);
    model_keep(q, s, &allowed, best_value, best);
    allowed &= ~up;
    s[other] = high;
    model_keep(q, s, &allowed, best_value, best);
  }
}

PART void model_about(models *q, const iterates *at, const lanes *radius)
{
  for (int a = 0; a < 2; a++) {
    q->g[a] = at->g[a];
    lanes low = -1 - at->xi[a], high = 1 - at->xi[a];
    q->low[a] = MOST(low, -*radius);
    q->high[a] = LEAST(high, *radius);
  }
  for (int i = 0; i < 3; i++) q->H[i] = at->H[i];
}

/* Steps to the lowest points of the models (eq:robust-model), or a first guess of them: the
 * lengths, where they lead, and the fall that each promises. */
PART void steps_from(const searches *s, int guess, lanes *length, lanes xi[2], lanes *fall)
{
  const iterates *at = &s->at;
  lanes determinant = at->H[0] * at->H[1] - at->H[2] * at->H[2], inverse = 1 / determinant, move[2],
        best[2], value;
  // -- Newton's step where the model is convex and the step allowed (eq:projection-newton)
  move[0] = (at->H[2] * at->g[1] - at->H[1] * at->g[0]) * inverse;
  move[1] = (at->H[2] * at->g[0] - at->H[0] * at->g[1]) * inverse;
  for (int a = 0; a < 2; a++) xi[a] = at->xi[a] + move[a];
  *fall = -0.5 * (at->g[0] * move[0] + at->g[1] * move[1]);
  if (guess) {
    // -- A first guess is cut to the face, and good if f does not rise (eq:robust-guess)
    snap(xi);
    for (int a = 0; a < 2; a++) move[a] = xi[a] - at->xi[a];
    *fall = *length = (lanes){0};
  }
  lanes across = SIZE(move[0]), along = SIZE(move[1]), x = SIZE(xi[0]), y = SIZE(xi[1]);
  *length = MOST(across, along);
  mask newton = (at->H[0] > 0) & (determinant > 0), rest;
  if (!guess) newton &= (*length <= s->radius) & (MOST(x, y) <= 1 - 2 * DBL_EPSILON);
  rest = s->active & ~newton;
  if (!any(&rest)) return;
  models q;
  model_about(&q, at, &s->radius);
  model_sides(&q, &value, best);
  *fall = PICK(newton, *fall, -value);
  for (int a = 0; a < 2; a++) move[a] = PICK(newton, move[a], best[a]), xi[a] = at->xi[a] + move[a];
  across = SIZE(move[0]), along = SIZE(move[1]);
  *length = MOST(across, along);
  snap(xi);
}

/* One step of every active lane: a first guess, or one that `may_end` the search. A lane whose f no
 * longer falls as promised, with a promise near rounding, becomes hard. */
PART void step(const patches *patch, int may_end, searches *s)
{
  iterates trial;
  lanes fall, length, zero = {0};
  steps_from(s, !may_end, &length, trial.xi, &fall);
  if (may_end) {
    // -- Done when the step is small, or the next one would be (eq:robust-quadratic)
    const double small = 4 * DBL_EPSILON;
    lanes square = length * length;
    mask done =
        s->active & ((length <= s->tolerance) |
                     ((square <= small) & (square * length <= small * (s->before * s->before))));
    for (int a = 0; a < 2; a++) s->at.xi[a] = PICK(done, trial.xi[a], s->at.xi[a]);
    s->limit = PICK(done & (length >= s->radius), zero, s->limit);
    s->active &= ~done;
    if (!any(&s->active)) return;
  }
  look(patch, &trial);
  s->evaluations = PICK(s->active, s->evaluations + 1, s->evaluations);
  // -- Take the step if f falls (eq:robust-accept)
  mask accept = s->at.f - trial.f >= 0.1 * fall, refuse = s->active & ~accept;
  if (any(&refuse)) {
    lanes noise = s->at.f;
    root(&noise);
    noise = 8 * DBL_EPSILON * (s->at.f + patch->size * noise);
    s->hard |= refuse & ~(fall > noise);
    s->active &= ~s->hard;
    s->radius = PICK(refuse, 0.25 * length, s->radius);
  }
  accept &= s->active;
  lanes wider = 2 * s->radius;
  s->radius = PICK(accept & (length >= s->radius), LEAST(wider, zero + 2), s->radius);
  s->before = PICK(accept, length, s->before);
  take(&s->at, &trial, &accept);
}

/* Descend in all active lanes. Those that the iterate of number `probe` shows not to be mild become
 * rough. */
PART void descend(const patches *patch, int steps, int probe, searches *s)
{
  for (int i = 0; i < steps && any(&s->active); i++) {
    if (i == probe) {
      mask mild;
      is_mild(patch, &s->at, &mild);
      s->rough = s->active & ~mild;
      s->active &= mild;
    }
    step(patch, i >= probe, s);
  }
  s->hard |= s->active;
}

/* Does rounding of the gradient move the feet by less than the tolerance? (eq:robust-resolved) */
PART void resolved(const patches *patch, const iterates *at, const lanes *f, const lanes *tolerance,
                   mask *good)
{
  lanes distance = *f, length[2] = {at->square[0], at->square[1]}, limit[2];
  for (int a = 0; a < 2; a++) root(&length[a]);
  lanes rounding = 4 * DBL_EPSILON * (*root(&distance) + patch->size);
  mask bound[2];
  for (int a = 0; a < 2; a++) {
    bound[a] = (at->xi[a] <= -1) | (at->xi[a] >= 1);
    limit[a] = *tolerance * at->H[a];
  }
  lanes determinant = at->H[0] * at->H[1] - at->H[2] * at->H[2], twist = SIZE(at->H[2]);
  lanes first = at->H[1] * length[0] + twist * length[1],
        second = at->H[0] * length[1] + twist * length[0];
  // -- How far rounding moves the foot (eq:robust-resolved)
  lanes move = rounding * MOST(first, second), allowed = *tolerance * determinant;
  for (int a = 1; a >= 0; a--) {
    move = PICK(bound[1 - a], rounding * length[a], move);
    allowed = PICK(bound[1 - a], limit[a], allowed);
  }
  *good = (move <= allowed) | (bound[0] & bound[1]);
}

/* A quadratic form as in proof.c. */
typedef struct forms {
  lanes m11, m22, low, high;
} forms;

/* Bounds of the derivatives over the faces, as in proof.c, and what is to be shown. */
typedef struct proofs {
  lanes tangent[2], curve[3], margin, target;
} proofs;

PART void proof_about(const patches *patch, const lanes *distance, proofs *p)
{
  lanes n[8], all = 0 * *distance;
  for (int j = 0; j < 8; j++) {
    n[j] = (SIZE(patch->c[j][0]) + SIZE(patch->c[j][1])) + SIZE(patch->c[j][2]);
    all += n[j];
  }
  // -- Bounds of the derivatives (eq:certified-derivatives)
  p->tangent[0] = (n[1] + n[3]) + (2 * (n[4] + n[6]) + n[7]),
  p->tangent[1] = (n[2] + n[3]) + (2 * (n[5] + n[7]) + n[6]);
  p->curve[0] = 2 * n[4] + 6 * n[6], p->curve[1] = 2 * n[5] + 6 * n[7],
  p->curve[2] = n[3] + 2 * (n[6] + n[7]);
  // -- The margin, less what rounding may hide (eq:certified-target)
  lanes rounding = 64 * DBL_EPSILON * all;
  p->margin = 0.5 * 1e-10 * MOST(*distance, patch->size) - 2 * rounding;
  lanes low = *distance - p->margin;
  low = PICK(low > 0, low, 0 * all);
  p->target = low * low;
}

/* Lower bounds of the quadratic part of f about the feet, as seen from anywhere on the face; `at`
 * has d and the tangents at the feet. */
PART void secant_form(const patches *patch, const proofs *p, const lanes xi[2], const lanes d[3],
                      const lanes t1[3], const lanes t2[3], const lanes *distance, forms *m)
{
  const lanes(*c)[3] = patch->c;
  const double e = 256 * DBL_EPSILON;
  lanes x = -xi[0], y = -xi[1], t11[3], t22[3], t12[3], a1[3], a2[3], v = (SIZE(x) + SIZE(y)) + 1;
  curves(patch, xi, t11, t22, t12);
  for (int k = 0; k < 3; k++) {
    // -- Secants from the feet to the centres of the faces (eq:certified-secants)
    a1[k] = (t1[k] + 0.5 * (x * t11[k] + y * t12[k])) + x * y * c[6][k];
    a2[k] = (t2[k] + 0.5 * (y * t22[k] + x * t12[k])) + x * y * c[7][k];
  }
  lanes d6 = 2 * DOT(d, c[6]), d7 = 2 * DOT(d, c[7]);
  lanes a11 = DOT(a1, t11), a12 = DOT(a1, t12) + d6, b22 = DOT(a2, t22), b12 = DOT(a2, t12) + d7;
  lanes cross1 = DOT(a1, t22) + DOT(a2, t12), cross2 = DOT(a1, t12) + DOT(a2, t11);
  lanes a6 = DOT(a1, c[6]), b7 = DOT(a2, c[7]), cross3 = DOT(a1, c[7]) + DOT(a2, c[6]);
  // -- Form at the centres, and what it may lose elsewhere (eq:certified-form, eq:certified-spread,
  // eq:certified-rounding)
  m->m11 = DOT(a1, a1) + (DOT(d, t11) + d6 * y);
  m->m22 = DOT(a2, a2) + (DOT(d, t22) + d7 * x);
  m->m11 -= (SIZE(a11) + SIZE(a12)) + 2 * SIZE(a6) * v +
            e * (p->tangent[0] * p->tangent[0] + *distance * p->curve[0]);
  m->m22 -= (SIZE(b22) + SIZE(b12)) + 2 * SIZE(b7) * v +
            e * (p->tangent[1] * p->tangent[1] + *distance * p->curve[1]);
  lanes spread = 0.5 * (SIZE(cross1) + SIZE(cross2)) + SIZE(cross3) * v +
                 e * (p->tangent[0] * p->tangent[1] + *distance * p->curve[2]);
  lanes m12 = DOT(a1, a2) + DOT(d, t12);
  m->low = m12 - spread;
  m->high = m12 + spread;
}

/* What a slope does over the face: it makes the form steeper where it leads away from the foot,
 * else it counts as a loss. */
PART void slope_share(const lanes *slope, const lanes *offset, lanes *curvature, lanes *loss)
{
  lanes middle = *slope * *offset, low = middle - SIZE(*slope), high = middle + SIZE(*slope),
        fall = PICK(low < 0, low, 0 * low);
  mask helps = (low >= 0) & (high > 0);
  // -- A slope away from the foot is at least a parabola (eq:certified-slope)
  lanes share = *slope / (high / *slope) * (1 - 16 * DBL_EPSILON);
  *curvature = PICK(helps, *curvature + share, *curvature);
  *loss = PICK(helps, *loss, *loss - fall);
}

/* Is it seen from the feet alone that no point of the faces is closer? Where it is not, ct_project
 * may look closer. */
PART void prove(const patches *patch, const lanes xi[2], const lanes d[3], const lanes *f,
                const lanes t1[3], const lanes t2[3], mask *proven)
{
  lanes distance = *f, g[2] = {2 * DOT(d, t1), 2 * DOT(d, t2)}, offset[2] = {-xi[0], -xi[1]},
        zero = {0};
  proofs p;
  forms m;
  root(&distance);
  proof_about(patch, &distance, &p);
  secant_form(patch, &p, xi, d, t1, t2, &distance, &m);
  lanes loss = 16 * DBL_EPSILON * distance * (distance + 4 * (p.tangent[0] + p.tangent[1]));
  slope_share(&g[0], &offset[0], &m.m11, &loss);
  slope_share(&g[1], &offset[1], &m.m22, &loss);
  // -- Positive on all steps that occur (eq:certified-positive)
  mask corner = (SIZE(xi[0]) >= 1) & (SIZE(xi[1]) >= 1), same = xi[0] * xi[1] > 0;
  lanes below = -m.low, twist = MOST(below, m.high), up = PICK(below > 0, below, zero),
        down = PICK(m.high > 0, m.high, zero);
  twist = PICK(corner, PICK(same, up, down), twist);
  *proven = (*f - loss >= p.target) & (m.m11 >= 0) & (m.m22 >= 0) &
            (m.m11 * m.m22 >= twist * twist * (1 + 16 * DBL_EPSILON));
  *proven = (p.margin > 0) & (*proven | ~(p.target > 0));
}

/* Write what is known of the feet; a lane without a normal becomes hard. */
PART void finish(const patches *patch, searches *s, double xi[16], const ct_batch_feet *feet,
                 size_t block, int lane)
{
  lanes d[3], f, t1[3], t2[3], n[3], zero = {0};
  value(patch, s->at.xi, d, &f);
  tangents(patch, s->at.xi, t1, t2);
  mask good;
  resolved(patch, &s->at, &f, &s->limit, &good);
  s->cold &= ~s->hard;
  if (any(&s->cold)) {
    // -- Look again where the face may hide something (eq:robust-hidden)
    mask proven;
    prove(patch, s->at.xi, d, &f, t1, t2, &proven);
    s->doubtful = s->cold & ~proven;
  }
  // -- Unit normal (eq:segment-normal)
  for (int k = 0; k < 3; k++)
    n[k] = t1[(k + 1) % 3] * t2[(k + 2) % 3] - t1[(k + 2) % 3] * t2[(k + 1) % 3];
  lanes square = DOT(n, n), norm = square;
  s->hard |= ~(square > 1e-28 * (DOT(t1, t1) * DOT(t2, t2)));
  root(&norm);
  for (int k = 0; k < 3; k++) n[k] /= norm;
  // -- Distance, and its sign on the side of the normal (eq:projection-signed)
  lanes distance = *root(&f), signed_distance = PICK(DOT(d, n) <= 0, distance, -distance),
        status = PICK(good, zero + CT_OK, zero + CT_NOT_CERTIFIED);
  if (feet->distance != NULL)
    *(loose *)(void *)&feet->distance[8 * block + (size_t)lane] = distance;
  if (feet->signed_distance != NULL)
    *(loose *)(void *)&feet->signed_distance[8 * block + (size_t)lane] = signed_distance;
  for (int a = 0; a < 2; a++) *(loose *)(void *)&xi[8 * a + lane] = s->at.xi[a];
  for (size_t k = 0; k < 3 && feet->normal != NULL; k++)
    *(loose *)(void *)&feet->normal[8 * (3 * block + k) + (size_t)lane] = n[k];
  for (int l = 0; l < LANES; l++) {
    if (feet->status != NULL) feet->status[8 * block + (size_t)(lane + l)] = (int32_t)status[l];
    if (feet->evaluations != NULL)
      feet->evaluations[8 * block + (size_t)(lane + l)] = (int32_t)s->evaluations[l];
  }
}

PART unsigned project_block(int count, const double *nodes, const double *points,
                            const double *start, const ct_project_options *options, double xi[16],
                            const ct_batch_feet *feet, size_t block)
{
  unsigned hard = 0;
  int steps = options->iteration_limit > 0 && options->iteration_limit < STEPS
                  ? options->iteration_limit
                  : STEPS;
  for (int lane = 0; lane < 8; lane += LANES) {
    patches patch;
    searches s;
    patches_init(&patch, count, nodes, points, lane);
    begin(&patch, start, lane, options->tolerance, &s);
    descend(&patch, steps, start != NULL ? 0 : 1, &s);
    if (any(&s.rough)) {
      begin_again(&patch, start != NULL, options->tolerance, &s);
      descend(&patch, steps, -1, &s);
    }
    finish(&patch, &s, xi, feet, block, lane);
    s.doubtful &= ~s.hard;
    for (int l = 0; l < LANES; l++)
      hard |= (s.hard[l] ? 1u << (lane + l) : 0) | (s.doubtful[l] ? 256u << (lane + l) : 0);
  }
  return hard;
}

__attribute__((target(TARGET))) unsigned KERNEL(ct_face_kind kind, const double *nodes,
                                                const double *points, const double *start,
                                                const ct_project_options *options, double xi[16],
                                                const ct_batch_feet *feet, size_t block)
{
  return kind == CT_Q4 ? project_block(4, nodes, points, start, options, xi, feet, block)
                       : project_block(8, nodes, points, start, options, xi, feet, block);
}
