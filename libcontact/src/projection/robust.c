#include "projection_internal.h"

#include "../vector.h"

#include <float.h>
#include <math.h>

/* As fmin and fmax, for numbers, without a call. */
static inline double least(double a, double b) { return b < a ? b : a; }
static inline double most(double a, double b) { return b > a ? b : a; }

/* Quadratic model q(s) = g.s + s.H s / 2 of f about an iterate, on the steps that stay in the trust region and on the face:
 * low <= s <= high and s_1 + s_2 <= sum. */
typedef struct model {
  double g[2], H[3], low[2], high[2], sum;
} model;

static double model_value(const model *q, const double s[2])
{
  double linear = q->g[0] * s[0] + q->g[1] * s[1];
  return linear + (0.5 * (q->H[0] * (s[0] * s[0]) + q->H[1] * (s[1] * s[1])) + q->H[2] * (s[0] * s[1]));
}

/* Keep s in `best` when it is lower; answers the lower value. */
static double model_keep(const model *q, const double s[2], double value, double best[2])
{
  double v = model_value(q, s);
  if (!(v < value)) return value;
  best[0] = s[0];
  best[1] = s[1];
  return v;
}

/* Lowest point of the model on the line s_axis = bound. */
static double model_side(const model *q, int axis, double bound, double value, double best[2])
{
  int other = 1 - axis;
  double low = q->low[other], high = least(q->high[other], q->sum - bound), s[2];
  if (!(low <= high)) return value;
  s[axis] = bound;
  // -- Root of the slope along a side, or its two ends (eq:robust-side)
  double slope = q->g[other] + q->H[2] * bound, curvature = q->H[other];
  if (curvature > 0) {
    s[other] = least(most(-slope / curvature, low), high);
    return model_keep(q, s, value, best);
  }
  s[other] = low;
  value = model_keep(q, s, value, best);
  s[other] = high;
  return model_keep(q, s, value, best);
}

/* The same on the slanted side of a triangle, s_1 + s_2 = sum, with u = (s_1 - s_2) / 2 along it. */
static double model_slant(const model *q, double value, double best[2])
{
  double half = 0.5 * q->sum;
  double low = most(q->low[0] - half, half - q->high[1]), high = least(q->high[0] - half, half - q->low[1]);
  if (!(low <= high)) return value;
  // -- Root of the slope along the slanted side, or its two ends (eq:robust-slant)
  double slope = (q->g[0] - q->g[1]) + half * (q->H[0] - q->H[1]), curvature = (q->H[0] + q->H[1]) - 2 * q->H[2];
  double u[2] = {low, high};
  if (curvature > 0) u[0] = u[1] = least(most(-slope / curvature, low), high);
  for (int i = 0; i < 2; i++) {
    double s[2] = {half + u[i], half - u[i]};
    value = model_keep(q, s, value, best);
  }
  return value;
}

/* Lowest point s of the model; answers q(s) <= 0. */
static double model_minimum(const model *q, double s[2])
{
  double determinant = q->H[0] * q->H[1] - q->H[2] * q->H[2];
  if (q->H[0] > 0 && determinant > 0) {
    // -- Newton's step where the model is convex and the step allowed (eq:projection-newton)
    s[0] = (q->H[2] * q->g[1] - q->H[1] * q->g[0]) / determinant;
    s[1] = (q->H[2] * q->g[0] - q->H[0] * q->g[1]) / determinant;
    if (s[0] >= q->low[0] && s[0] <= q->high[0] && s[1] >= q->low[1] && s[1] <= q->high[1] && s[0] + s[1] <= q->sum)
      return model_value(q, s);
  }
  // -- Otherwise the lowest point lies on a side (eq:robust-model)
  double value = 0;
  s[0] = s[1] = 0;
  for (int axis = 0; axis < 2; axis++) {
    value = model_side(q, axis, q->low[axis], value, s);
    value = model_side(q, axis, q->high[axis], value, s);
  }
  return q->sum < HUGE_VAL ? model_slant(q, value, s) : value;
}

/* The model of f about the iterate, limited to the face and to the trust region of half-width `radius`. */
static void model_about(model *q, const ct_iterate *at, int triangular, double radius)
{
  for (int a = 0; a < 2; a++) {
    q->g[a] = at->g[a];
    q->low[a] = most(triangular ? -at->xi[a] : -1 - at->xi[a], -radius);
    q->high[a] = least(1 - at->xi[a], radius);
  }
  for (int i = 0; i < 3; i++) q->H[i] = at->H[i];
  q->sum = triangular ? most(1 - (at->xi[0] + at->xi[1]), 0) : HUGE_VAL;
}

/* Bring xi onto the face, and onto its boundary where only rounding is between. */
static void snap(int triangular, double xi[2])
{
  double low = triangular ? 0 : -1;
  for (int a = 0; a < 2; a++) {
    xi[a] = least(most(xi[a], low), 1);
    if (xi[a] > 1 - 2 * DBL_EPSILON) xi[a] = 1;
    if (xi[a] < low + 2 * DBL_EPSILON) xi[a] = low;
  }
  if (!triangular || xi[0] + xi[1] <= 1 - 2 * DBL_EPSILON) return;
  int large = xi[1] > xi[0];
  double excess = most(0.5 * (xi[0] + xi[1] - 1), 0);
  xi[1 - large] = most(xi[1 - large] - excess, 0);
  xi[large] = 1 - xi[1 - large];
}

/* Does rounding of the gradient move the foot by less than the tolerance, along the directions that the face leaves free? */
static int resolved(const ct_patch *patch, const ct_iterate *at, int triangular, double tolerance)
{
  double length[2], low = triangular ? 0 : -1, rounding = 4 * DBL_EPSILON * (sqrt(at->f) + patch->size);
  int bound[2] = {at->xi[0] <= low || at->xi[0] >= 1, at->xi[1] <= low || at->xi[1] >= 1};
  if (bound[0] && bound[1]) return 1;
  // -- No tangent is longer than 9 coefficients' vectors, 16 sizes (eq:robust-long)
  double most_H = most(at->H[0], at->H[1]) + fabs(at->H[2]);
  if (!triangular && !bound[0] && !bound[1] && 16 * patch->size * (rounding * most_H) <= tolerance * (at->H[0] * at->H[1] - at->H[2] * at->H[2])) return 1;
  ct_patch_tangent_lengths(patch, at->xi, length);
  // -- How far rounding moves the foot (eq:robust-resolved)
  for (int a = 0; a < 2; a++)
    if (bound[1 - a]) return rounding * length[a] <= tolerance * at->H[a];
  if (triangular && at->xi[0] + at->xi[1] >= 1)
    return rounding * (length[0] + length[1]) <= tolerance * ((at->H[0] + at->H[1]) - 2 * at->H[2]);
  double determinant = at->H[0] * at->H[1] - at->H[2] * at->H[2], twist = fabs(at->H[2]);
  double first = at->H[1] * length[0] + twist * length[1], second = at->H[0] * length[1] + twist * length[0];
  return rounding * most(first, second) <= tolerance * determinant;
}

/* The last step has been found: take it, and look at d only. */
static ct_status finish(const ct_patch *patch, ct_iterate *at, const ct_iterate *trial, double tolerance)
{
  at->xi[0] = trial->xi[0];
  at->xi[1] = trial->xi[1];
  at->f = ct_patch_value(patch, at->xi, at->d);
  return resolved(patch, at, patch->kind == CT_T3 || patch->kind == CT_T6, tolerance) ? CT_OK : CT_NOT_CERTIFIED;
}

/* Descend from the iterate `at`, looked at already, to a minimum of f on the face. */
static ct_status descend(const ct_patch *patch, const ct_project_options *options, ct_iterate *at, ct_foot *foot)
{
  int triangular = patch->kind == CT_T3 || patch->kind == CT_T6, limit = options->iteration_limit > 0 ? options->iteration_limit : 100;
  double half_width = ct_patch_half_width(patch->kind), tolerance = options->tolerance * half_width;
  double radius = half_width, before = half_width, stalled = HUGE_VAL;
  for (int iteration = 0; iteration < limit; iteration++, foot->iterations++) {
    if (options->trace != NULL) options->trace(at->xi, at->f, options->user);
    // -- Step to the lowest point of the model (eq:robust-model)
    model q;
    ct_iterate trial;
    double s[2];
    model_about(&q, at, triangular, radius);
    double predicted = -model_minimum(&q, s), length = most(fabs(s[0]), fabs(s[1]));
    for (int a = 0; a < 2; a++) trial.xi[a] = at->xi[a] + s[a];
    snap(triangular, trial.xi);
    // -- Done when the step is small, or the next one would be rounding (eq:robust-quadratic)
    double next = length * length * most(1, length / (before * before));
    if (length <= tolerance || next <= most(1e-3 * tolerance, DBL_EPSILON * half_width)) return finish(patch, at, &trial, length < radius ? tolerance : 0);
    ct_iterate_look(patch, &trial, foot);
    // -- Take the step if f falls, or, where rounding hides that, if the steps get shorter (eq:robust-accept)
    int accept = at->f - trial.f >= 0.1 * predicted;
    if (!accept && predicted <= ct_patch_noise(patch, at->f)) {
      if (length > 0.5 * stalled) return CT_NOT_CERTIFIED;
      stalled = length;
      accept = 1;
    }
    // -- Widen or narrow the trust region
    if (!accept) radius = 0.25 * length;
    else if (length >= radius) radius = least(2 * radius, 2 * half_width);
    if (!accept) continue;
    before = length;
    *at = trial;
  }
  return CT_ITERATION_LIMIT;
}

/* Sample points: the corners, the mid-sides, the centre. */
static const double QUADRILATERAL[9][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};
static const double TRIANGLE[7][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}, {1.0 / 3, 1.0 / 3}};

/* Which samples are not higher than their neighbours: bit i for sample i. Corners see their two mid-sides, mid-sides see two corners and two mid-sides, all see
 * the centre. */
static unsigned valleys(const double f[9], int corners)
{
  unsigned found = 0, centre = 1;
  for (int j = 0; j < corners; j++) {
    int after = (j + 1) % corners, before = (j + corners - 1) % corners;
    const double *side = f + corners, c = f[2 * corners];
    unsigned corner = (unsigned)(f[j] <= side[j]) & (unsigned)(f[j] <= side[before]) & (unsigned)(f[j] <= c);
    unsigned middle = (unsigned)(side[j] <= f[j]) & (unsigned)(side[j] <= f[after]) & (unsigned)(side[j] <= side[after]) &
                      (unsigned)(side[j] <= side[before]) & (unsigned)(side[j] <= c);
    centre &= (unsigned)!(f[j] < c) & (unsigned)!(side[j] < c);
    found |= corner << j | middle << (corners + j);
  }
  return found | centre << (2 * corners);
}

/* Is the face so nearly plane that no valley can hide between the samples? */
static int is_mild(const ct_patch *patch)
{
  double square[8];
  for (int j = 1; j < 8; j++) square[j] = ct_vector_dot(patch->c[j], patch->c[j]);
  // -- Compare what is not linear with what is (eq:robust-mild)
  return square[3] + ((square[4] + square[5]) + (square[6] + square[7])) <= 0.1 * least(square[1], square[2]);
}

/* Is the end `a` better than `b`: lower, or as low and nearer the centre? A mirror does not change the answer. */
static int is_better(const ct_iterate *a, ct_status end_a, const ct_iterate *b, ct_status end_b)
{
  if (a->f != b->f) return a->f < b->f;
  double ra = a->xi[0] * a->xi[0] + a->xi[1] * a->xi[1], rb = b->xi[0] * b->xi[0] + b->xi[1] * b->xi[1];
  if (ra != rb) return ra < rb;
  for (int k = 0; k < 2; k++)
    if (fabs(a->xi[k]) != fabs(b->xi[k])) return fabs(a->xi[k]) < fabs(b->xi[k]);
  return end_a < end_b;
}

/* A first guess of the floor of the valley at sample i of a quadrilateral: where the parabolas through the samples of its row and of its column are lowest. */
static void valley_floor(const double f[9], int i, double xi[2])
{
  // Samples at -1, 0, 1 along each axis, through every sample.
  static const int LINE[9][2][3] = {{{0, 4, 1}, {0, 7, 3}}, {{0, 4, 1}, {1, 5, 2}}, {{3, 6, 2}, {1, 5, 2}}, {{3, 6, 2}, {0, 7, 3}}, {{0, 4, 1}, {4, 8, 6}},
                                    {{7, 8, 5}, {1, 5, 2}}, {{3, 6, 2}, {4, 8, 6}}, {{7, 8, 5}, {0, 7, 3}}, {{7, 8, 5}, {4, 8, 6}}};
  for (int a = 0; a < 2; a++) {
    const int *line = LINE[i][a];
    // -- Lowest point of a parabola (eq:robust-parabola)
    double rise = 0.5 * (f[line[2]] - f[line[0]]), bend = (f[line[2]] - f[line[1]]) + (f[line[0]] - f[line[1]]);
    if (bend > 0) xi[a] = least(most(-rise / bend, -1), 1);
  }
}

/* Descend from sample i; keep the end if it is better than the best so far. */
static void descend_from_sample(const ct_patch *patch, const ct_project_options *options, const double f[9], int i, ct_iterate *best, ct_status *status, ct_foot *foot)
{
  int triangular = patch->kind == CT_T3 || patch->kind == CT_T6;
  ct_iterate at;
  for (int a = 0; a < 2; a++) at.xi[a] = triangular ? TRIANGLE[i][a] : QUADRILATERAL[i][a];
  if (!triangular) valley_floor(f, i, at.xi);
  ct_iterate_look(patch, &at, foot);
  ct_status end = descend(patch, options, &at, foot);
  if (best->f < HUGE_VAL && !is_better(&at, end, best, *status)) return;
  *best = at;
  *status = end;
}

/* Descend from every sample that is a valley, and then from the others unless one look shows that nothing is closer; the lowest end wins, and of
 * equal ones the one nearer the centre. */
static ct_status descend_from_valleys(const ct_patch *patch, const ct_project_options *options, const double f[9], ct_iterate *best, ct_foot *foot)
{
  int corners = patch->kind == CT_T3 || patch->kind == CT_T6 ? 3 : 4;
  ct_status status = CT_NO_CONVERGENCE;
  best->f = HUGE_VAL;
  unsigned valley = corners == 4 ? valleys(f, 4) : valleys(f, 3);
  for (int i = 2 * corners; i >= 0; i--)
    if (valley >> i & 1) descend_from_sample(patch, options, f, i, best, &status, foot);
  // -- Look again where the face may hide something (eq:robust-hidden)
  if (is_mild(patch) || ct_proof_at_sight(patch, best->xi, 2, foot)) return status;
  for (int i = 2 * corners; i >= 0; i--)
    if (!(valley >> i & 1)) descend_from_sample(patch, options, f, i, best, &status, foot);
  return status;
}

/* f at the nine sample points of a quadrilateral, where its polynomial is a sum of coefficients. */
static void sample_quadrilateral(const ct_patch *patch, double f[9])
{
  double d[9][4];
  for (int k = 0; k < 4; k++) {
    // -- Corners, mid-sides and centre (eq:robust-samples)
    double c0 = patch->c[0][k], twist = patch->c[3][k], right = patch->c[1][k], up = patch->c[2][k];
    double row = c0 + patch->c[5][k], column = c0 + patch->c[4][k], corner = c0 + (patch->c[4][k] + patch->c[5][k]);
    double across = right + patch->c[7][k], along = up + patch->c[6][k];
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
  for (int i = 0; i < 9; i++) f[i] = ct_vector_dot(d[i], d[i]);
}

ct_status ct_project_robust(const ct_patch *patch, const ct_project_options *options, ct_foot *foot)
{
  int triangular = patch->kind == CT_T3 || patch->kind == CT_T6, samples = triangular ? 7 : 9;
  double f[9], d[3], lowest = HUGE_VAL;
  // -- Sample the face (eq:robust-samples)
  if (!triangular) sample_quadrilateral(patch, f);
  else
    for (int i = 0; i < samples; i++) f[i] = ct_patch_value(patch, TRIANGLE[i], d);
  for (int i = 0; i < samples; i++) lowest = least(lowest, f[i]);
  foot->evaluations += samples;
  ct_iterate at = {{0, 0}, HUGE_VAL, {0, 0, 0}, {0, 0}, {0, 0, 0}};
  if (options->use_start) {
    // -- Begin at the given start unless a sample is lower
    at.xi[0] = options->start[0];
    at.xi[1] = options->start[1];
    snap(triangular, at.xi);
    ct_iterate_look(patch, &at, foot);
  }
  ct_status status = at.f <= lowest + ct_patch_noise(patch, lowest) ? descend(patch, options, &at, foot) : descend_from_valleys(patch, options, f, &at, foot);
  for (int a = 0; a < 2; a++) foot->xi[a] = at.xi[a];
  for (int k = 0; k < 3; k++) foot->d[k] = at.d[k];
  return status;
}
