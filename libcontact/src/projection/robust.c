#include "polynomial.h"

#include "../base/lanes.h"
#include "../base/vector.h"

#include <float.h>
#include <math.h>

/* As fmin and fmax, for numbers, without a call. */
static inline double least(double a, double b) { return b < a ? b : a; }
static inline double most(double a, double b) { return b > a ? b : a; }

static inline int is_triangular(const ct_patch *patch)
{
  return patch->kind == CT_T3 || patch->kind == CT_T6;
}

/* A step, where it leads, and the fall that the model promises. */
typedef struct step {
  double s[2], xi[2], fall;
} step;

/* Quadratic model q(s) = g.s + s.H s / 2 of f about an iterate, on the steps that stay in the trust
 * region and on the face: low <= s <= high and s_1 + s_2 <= sum. */
typedef struct model {
  double g[2], H[3], low[2], high[2], sum;
} model;

static double model_value(const model *q, const double s[2])
{
  double linear = q->g[0] * s[0] + q->g[1] * s[1];
  return linear +
         (0.5 * (q->H[0] * (s[0] * s[0]) + q->H[1] * (s[1] * s[1])) + q->H[2] * (s[0] * s[1]));
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

/* The same on the slanted side of a triangle, s_1 + s_2 = sum, with u = (s_1 - s_2) / 2 along it.
 */
static double model_slant(const model *q, double value, double best[2])
{
  double half = 0.5 * q->sum;
  double low = most(q->low[0] - half, half - q->high[1]),
         high = least(q->high[0] - half, half - q->low[1]);
  if (!(low <= high)) return value;
  // -- Root of the slope along the slanted side, or its two ends (eq:robust-slant)
  double slope = (q->g[0] - q->g[1]) + half * (q->H[0] - q->H[1]),
         curvature = (q->H[0] + q->H[1]) - 2 * q->H[2];
  double u[2] = {low, high};
  if (curvature > 0) u[0] = u[1] = least(most(-slope / curvature, low), high);
  for (int i = 0; i < 2; i++) {
    double s[2] = {half + u[i], half - u[i]};
    value = model_keep(q, s, value, best);
  }
  return value;
}

/* Lowest point s of the model on the boundary of the allowed steps; answers q(s) <= 0. */
static double model_minimum(const model *q, double s[2])
{
  // -- The lowest point lies on a side (eq:robust-model)
  double value = 0;
  s[0] = s[1] = 0;
  for (int axis = 0; axis < 2; axis++) {
    value = model_side(q, axis, q->low[axis], value, s);
    value = model_side(q, axis, q->high[axis], value, s);
  }
  return q->sum < HUGE_VAL ? model_slant(q, value, s) : value;
}

/* The model of f about the iterate, limited to the face and to the trust region of half-width
 * `radius`. */
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

/* Is xi on the face, and not on its boundary nor within rounding of it? */
static inline int is_inside(int triangular, const double xi[2])
{
  const double edge = 1 - 2 * DBL_EPSILON;
  if (!triangular) return most(fabs(xi[0]), fabs(xi[1])) <= edge;
  return least(xi[0], xi[1]) >= 2 * DBL_EPSILON && xi[0] + xi[1] <= edge;
}

/* Newton's step. Answers 0 when the model is not convex or the step not allowed. */
static inline int newton_step(const ct_iterate *at, int triangular, double radius, step *to)
{
  // -- Newton's step (eq:projection-newton)
  double determinant = at->H[0] * at->H[1] - at->H[2] * at->H[2], inverse = 1 / determinant;
  to->s[0] = (at->H[2] * at->g[1] - at->H[1] * at->g[0]) * inverse;
  to->s[1] = (at->H[2] * at->g[0] - at->H[0] * at->g[1]) * inverse;
  for (int a = 0; a < 2; a++) to->xi[a] = at->xi[a] + to->s[a];
  to->fall = -0.5 * (at->g[0] * to->s[0] + at->g[1] * to->s[1]);
  int convex = at->H[0] > 0 && determinant > 0;
  if (radius < HUGE_VAL)
    return convex && most(fabs(to->s[0]), fabs(to->s[1])) <= radius &&
           is_inside(triangular, to->xi);
  // -- A first guess is cut to the face, and good if f does not rise (eq:robust-guess)
  if (!is_inside(triangular, to->xi)) snap(triangular, to->xi);
  for (int a = 0; a < 2; a++) to->s[a] = to->xi[a] - at->xi[a];
  to->fall = 0;
  return convex;
}

/* The step to the lowest point of the model on the boundary of what is allowed. The iterate is a
 * copy, so that those of the loop stay in registers. */
static step bounded_step(ct_iterate at, int triangular, double radius)
{
  model q;
  step to;
  model_about(&q, &at, triangular, radius);
  to.fall = -model_minimum(&q, to.s);
  for (int a = 0; a < 2; a++) to.xi[a] = at.xi[a] + to.s[a];
  snap(triangular, to.xi);
  return to;
}

/* Does rounding of the gradient move the foot xi by less than the tolerance, along the directions
 * that the face leaves free? H and the tangents are those of the last look. */
static inline int resolved(const ct_patch *patch, const ct_iterate *look, const double xi[2],
                           double f, int triangular, double tolerance)
{
  const double *H = look->H;
  double low = triangular ? 0 : -1, rounding = 4 * DBL_EPSILON * (sqrt(f) + patch->size),
         length[2] = {sqrt(look->square[0]), sqrt(look->square[1])};
  int bound[2] = {xi[0] <= low || xi[0] >= 1, xi[1] <= low || xi[1] >= 1};
  if (bound[0] && bound[1]) return 1;
  // -- How far rounding moves the foot (eq:robust-resolved)
  for (int a = 0; a < 2; a++)
    if (bound[1 - a]) return rounding * length[a] <= tolerance * H[a];
  if (triangular && xi[0] + xi[1] >= 1)
    return rounding * (length[0] + length[1]) <= tolerance * ((H[0] + H[1]) - 2 * H[2]);
  double determinant = H[0] * H[1] - H[2] * H[2], twist = fabs(H[2]);
  double first = H[1] * length[0] + twist * length[1],
         second = H[0] * length[1] + twist * length[0];
  return rounding * most(first, second) <= tolerance * determinant;
}

/* Let the caller see an iterate. */
static void show(const ct_project_options *options, double x, double y, double f)
{
  double xi[2] = {x, y};
  options->trace(xi, f, options->user);
}

/* Where a descent has ended. */
typedef struct end {
  double xi[2], f, d[4];
  ct_status status;
} end;

/* The end at xi, where the last step from `at` leads. */
static inline void settle(const ct_patch *patch, const ct_iterate *at, const double xi[2],
                          double tolerance, end *out)
{
  out->xi[0] = xi[0], out->xi[1] = xi[1];
  out->f = ct_polynomial_value(patch, xi, out->d);
  out->status =
      resolved(patch, at, xi, out->f, is_triangular(patch), tolerance) ? CT_OK : CT_NOT_CERTIFIED;
}

static inline void stop_at(const ct_iterate *at, ct_status status, end *out)
{
  for (int a = 0; a < 2; a++) out->xi[a] = at->xi[a];
  for (int k = 0; k < 3; k++) out->d[k] = at->d[k];
  out->f = at->f;
  out->status = status;
}

/* Is the face so nearly plane, as seen from an iterate near its foot, that f has one valley only?
 * What is not linear is weighed by its second derivatives. */
static inline int is_mild(const ct_patch *patch, const ct_iterate *at)
{
  const double (*c)[4] = patch->c;
  double bent[4];
  for (int k = 0; k < 4; k++)
    bent[k] = 0.5 * (c[3][k] * c[3][k]) + ((c[4][k] * c[4][k] + c[5][k] * c[5][k]) +
                                           2 * (c[6][k] * c[6][k] + c[7][k] * c[7][k]));
  double area = at->square[0] * at->square[1] - at->square[2] * at->square[2],
         straight = area / most(at->square[0], at->square[1]);
  // -- Compare what is not linear with what is (eq:robust-mild)
  return ((bent[0] + bent[1]) + bent[2]) * (straight + 2 * at->f) <=
         CT_MILD * (straight * straight);
}

typedef enum verdict { TAKE, REFUSE, STOP } verdict;

/* Is a step taken that should make f fall by `fall`? `stalled` is the length of the last one that
 * rounding did not let judge. */
static inline verdict judge(const ct_patch *patch, double f, double f_trial, double fall,
                            double length, double *stalled)
{
  // -- Take the step if f falls, or, where rounding hides that, if the steps get shorter
  // (eq:robust-accept)
  if (f - f_trial >= 0.1 * fall) return TAKE;
  if (!(fall <= ct_patch_noise(patch, f))) return REFUSE;
  if (length > 0.5 * *stalled) return STOP;
  *stalled = length;
  return TAKE;
}

/* Descend from xi to a minimum of f on the face, sought to within the tolerance. Answers 0 when the
 * iterate of number `probe` shows that the face is not mild; then `out` is this iterate. */
CT_CLONES
static int descend(const ct_patch *patch, const ct_project_options *options, double sought,
                   const double xi[2], int probe, ct_foot *foot, end *out)
{
  int triangular = is_triangular(patch),
      limit = options->iteration_limit > 0 ? options->iteration_limit : 100;
  double half_width = ct_patch_half_width(patch->kind), tolerance = sought * half_width,
         small = 4 * DBL_EPSILON * half_width;
  double radius = half_width, before = half_width, stalled = HUGE_VAL;
  ct_iterate at, trial;
  step to;
  at.xi[0] = xi[0], at.xi[1] = xi[1];
  ct_polynomial_look(patch, &at);
  foot->evaluations++;
  for (int iteration = 0; iteration < limit; iteration++, foot->iterations++) {
    if (options->trace != NULL) show(options, at.xi[0], at.xi[1], at.f);
    if (iteration == probe && !is_mild(patch, &at)) {
      stop_at(&at, CT_NO_CONVERGENCE, out);
      return 0;
    }
    // -- Step to the lowest point of the model (eq:robust-model)
    if (!newton_step(&at, triangular, iteration < probe ? HUGE_VAL : radius, &to))
      to = bounded_step(at, triangular, radius);
    double length = most(fabs(to.s[0]), fabs(to.s[1])), square = length * length;
    // -- Done when the step is small, or the next one would be: then look at d only
    // (eq:robust-quadratic)
    if (iteration >= probe && (length <= tolerance ||
                               (square <= small && square * length <= small * (before * before)))) {
      settle(patch, &at, to.xi, length < radius ? options->tolerance * half_width : 0, out);
      return 1;
    }
    trial.xi[0] = to.xi[0], trial.xi[1] = to.xi[1];
    ct_polynomial_look(patch, &trial);
    foot->evaluations++;
    verdict taken = judge(patch, at.f, trial.f, to.fall, length, &stalled);
    if (taken == STOP) {
      stop_at(&at, CT_NOT_CERTIFIED, out);
      return 1;
    }
    // -- Widen or narrow the trust region
    if (taken == REFUSE) radius = 0.25 * length;
    else if (length >= radius) radius = least(2 * radius, 2 * half_width);
    if (taken == REFUSE) continue;
    before = length;
    at = trial;
  }
  stop_at(&at, CT_ITERATION_LIMIT, out);
  return limit > probe;
}

/* Sample points: the corners, the mid-sides, the centre. */
static const double QUADRILATERAL[9][2] = {{-1, -1}, {1, -1}, {1, 1},  {-1, 1}, {0, -1},
                                           {1, 0},   {0, 1},  {-1, 0}, {0, 0}};
static const double TRIANGLE[7][2] = {
    {0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}, {1.0 / 3, 1.0 / 3}};

/* Which samples are not higher than their neighbours: bit i for sample i. Corners see their two
 * mid-sides, mid-sides see two corners and two mid-sides, all see the centre. */
static inline unsigned valleys(const double f[9], int corners)
{
  const double *side = f + corners, centre = f[2 * corners];
  unsigned found = 0, lowest = 1;
  for (int j = 0; j < corners; j++) {
    int after = (j + 1) % corners, before = (j + corners - 1) % corners;
    double sides = least(side[j], side[before]),
           around = least(least(f[j], f[after]), least(side[after], side[before]));
    found |= (unsigned)(f[j] <= least(sides, centre)) << j |
             (unsigned)(side[j] <= least(around, centre)) << (corners + j);
    lowest &= (unsigned)(centre <= least(f[j], side[j]));
  }
  return found | lowest << (2 * corners);
}

/* Is the end `a` better than `b`: lower, or as low and nearer the centre? A mirror does not change
 * the answer. */
static int is_better(const end *a, const end *b)
{
  if (a->f != b->f) return a->f < b->f;
  double ra = a->xi[0] * a->xi[0] + a->xi[1] * a->xi[1],
         rb = b->xi[0] * b->xi[0] + b->xi[1] * b->xi[1];
  if (ra != rb) return ra < rb;
  for (int k = 0; k < 2; k++)
    if (fabs(a->xi[k]) != fabs(b->xi[k])) return fabs(a->xi[k]) < fabs(b->xi[k]);
  return a->status < b->status;
}

/* Descend from the samples with a bit in `from`, those of high number first; keep the best of the
 * ends. */
static void descend_from(unsigned from, const ct_patch *patch, const ct_project_options *options,
                         double sought, ct_foot *foot, end *best)
{
  for (int i = 8; i >= 0; i--) {
    end found;
    if (!(from >> i & 1)) continue;
    descend(patch, options, sought, is_triangular(patch) ? TRIANGLE[i] : QUADRILATERAL[i], -1, foot,
            &found);
    if (best->f == HUGE_VAL || is_better(&found, best)) *best = found;
  }
}

/* f at the nine sample points of a quadrilateral, where its polynomial is a sum of coefficients. */
static inline void sample_quadrilateral(const ct_patch *patch, double f[9])
{
  double d[9][4];
  for (int k = 0; k < 4; k++) {
    // -- Corners, mid-sides and centre (eq:robust-samples)
    double c0 = patch->c[0][k], twist = patch->c[3][k], right = patch->c[1][k], up = patch->c[2][k];
    double row = c0 + patch->c[5][k], column = c0 + patch->c[4][k],
           corner = c0 + (patch->c[4][k] + patch->c[5][k]);
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

/* f at the sample points; answers the lowest. */
static inline double sample(const ct_patch *patch, double f[9], ct_foot *foot)
{
  int triangular = is_triangular(patch), samples = triangular ? 7 : 9;
  double d[4], lowest;
  // -- Sample the face (eq:robust-samples)
  if (!triangular) sample_quadrilateral(patch, f);
  else
    for (int i = 0; i < samples; i++) f[i] = ct_polynomial_value(patch, TRIANGLE[i], d);
  foot->evaluations += samples;
  lowest = least(least(least(f[0], f[1]), least(f[2], f[3])), least(least(f[4], f[5]), f[6]));
  return triangular ? lowest : least(lowest, least(f[7], f[8]));
}

/* The search on a face that is not mild, where `probe` has come to. */
static void search_samples(const ct_patch *patch, const ct_project_options *options,
                           const end *probe, ct_foot *foot, end *best)
{
  int triangular = is_triangular(patch);
  double f[9], lowest = sample(patch, f, foot), sought = least(options->tolerance, CT_PROVABLE);
  // -- Go on from the given start unless a sample is lower (eq:robust-noise)
  if (options->use_start && probe->f <= lowest + ct_patch_noise(patch, lowest)) {
    descend(patch, options, options->tolerance, probe->xi, -1, foot, best);
    return;
  }
  // -- Else begin at every sample that is a valley; the lowest end wins, and of equal ones the one
  // nearer the centre
  unsigned valley = triangular ? valleys(f, 3) : valleys(f, 4), all = triangular ? 127 : 511;
  best->f = HUGE_VAL;
  descend_from(valley, patch, options, sought, foot, best);
  // -- Look again where the face may hide something (eq:robust-hidden)
  if (!ct_proof_at_sight(patch, best->xi, 2, foot))
    descend_from(all & ~valley, patch, options, sought, foot, best);
}

ct_status ct_project_robust(const ct_patch *patch, const ct_project_options *options, ct_foot *foot)
{
  double centre = ct_patch_centre(patch->kind), start[2] = {centre, centre};
  end best, probe;
  if (options->use_start) {
    for (int a = 0; a < 2; a++) start[a] = options->start[a];
    snap(is_triangular(patch), start);
  }
  // -- Search a mild face from one place, any other from many (eq:robust-mild)
  const end *found = &probe;
  if (!descend(patch, options, options->tolerance, start, options->use_start ? 0 : 1, foot,
               &probe)) {
    search_samples(patch, options, &probe, foot, &best);
    found = &best;
  }
  for (int a = 0; a < 2; a++) foot->xi[a] = found->xi[a];
  for (int k = 0; k < 3; k++) foot->d[k] = found->d[k];
  return found->status;
}
