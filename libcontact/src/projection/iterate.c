#include "polynomial.h"

#include "../base/vector.h"

#include <math.h>

double ct_iterate_value(const ct_patch *patch, const double xi[2], ct_closest *closest)
{
  double d[3];
  closest->evaluations++;
  return value(patch, xi, d);
}

void ct_iterate_evaluate(const ct_patch *patch, ct_iterate *at, ct_closest *closest)
{
  evaluate(patch, at);
  closest->evaluations++;
}

void ct_iterate_visit(const ct_patch *patch, const ct_project_options *options, ct_iterate *at,
                      ct_closest *closest)
{
  ct_iterate_evaluate(patch, at, closest);
  if (options->trace != NULL) options->trace(at->xi, at->f, options->user);
}

void ct_iterate_start(const ct_patch *patch, const ct_project_options *options, double xi[2])
{
  double centre = ct_patch_centre(patch->kind);
  for (int a = 0; a < 2; a++) xi[a] = options->use_start ? options->start[a] : centre;
}

/* Are the steps so small, and shrinking so fast, that the sum of all later ones is below the
 * tolerance? `before` is the size of the last step and becomes that of s. */
static int is_done(const double s[2], double tolerance, double *before)
{
  double length = fmax(fabs(s[0]), fabs(s[1])), last = *before;
  *before = length;
  // -- Sum of the later steps, if each shrinks like the last (eq:projection-remainder)
  return length <= tolerance && (length == 0 || length * length <= tolerance * (last - length));
}

double ct_newton_step(const ct_iterate *at, double s[2])
{
  const double *g = at->g, *H = at->H;
  double determinant = H[0] * H[1] - H[2] * H[2];
  // -- Solve for the step (eq:projection-newton)
  s[0] = (H[2] * g[1] - H[1] * g[0]) / determinant;
  s[1] = (H[2] * g[0] - H[0] * g[1]) / determinant;
  return determinant;
}

ct_status ct_iterate_status(const ct_patch *patch, const ct_project_options *options,
                            const ct_iterate *at, ct_closest *closest)
{
  double s[2], determinant = ct_newton_step(at, s),
               tolerance = options->tolerance * ct_patch_half_width(patch->kind);
  for (int a = 0; a < 2; a++) closest->xi[a] = at->xi[a];
  for (int k = 0; k < 3; k++) closest->d[k] = at->d[k];
  // -- A root is the closest point only where f is convex (eq:projection-convex)
  if (!(at->H[0] + at->H[1] > 0 && determinant > 0)) return CT_NO_CONVERGENCE;
  // -- Newton's step estimates the error (eq:projection-newton)
  if (fmax(fabs(s[0]), fabs(s[1])) <= tolerance) return CT_OK;
  double fall = -0.5 * (at->g[0] * s[0] + at->g[1] * s[1]);
  return fall <= noise(patch, at->f) ? CT_NOT_CERTIFIED : CT_NO_CONVERGENCE;
}

/* A lower point along s: the whole step or a part of it. Returns 0 if there is none. */
static int line_search(const ct_patch *patch, const ct_iterate *at, const double s[2],
                       ct_iterate *next, ct_closest *closest)
{
  double slope = at->g[0] * s[0] + at->g[1] * s[1], alpha = 1;
  if (!(slope < 0)) return 0;
  for (int trial = 0; trial < 40; trial++) {
    next->xi[0] = at->xi[0] + alpha * s[0];
    next->xi[1] = at->xi[1] + alpha * s[1];
    ct_iterate_evaluate(patch, next, closest);
    double rise = next->f - at->f;
    // -- Enough of the predicted decrease (eq:projection-armijo)
    if (rise <= 1e-4 * alpha * slope) return 1;
    // -- If rounding hides the decrease, the slope decides
    if (-alpha * slope <= noise(patch, at->f))
      return fabs(next->g[0] * s[0] + next->g[1] * s[1]) < -slope;
    // -- Lowest point of the parabola through the two values and the slope (eq:projection-parabola)
    double parabola = -0.5 * (slope * alpha) / (rise - slope * alpha);
    alpha *= fmin(fmax(parabola, 0.1), 0.5);
  }
  return 0;
}

/* Take the whole step s. Returns 0 if it leads too far out, from where no iterate returns, or is
 * not finite. */
static int full_step(const ct_patch *patch, const ct_iterate *at, const double s[2],
                     ct_iterate *next, ct_closest *closest)
{
  for (int a = 0; a < 2; a++) next->xi[a] = at->xi[a] + s[a];
  if (!(fabs(next->xi[0]) < CT_FAR && fabs(next->xi[1]) < CT_FAR)) return 0;
  ct_iterate_evaluate(patch, next, closest);
  return 1;
}

ct_status ct_iterate_walk(const ct_patch *patch, const ct_project_options *options,
                          int default_limit, int search_line, ct_step_rule *rule, void *memory,
                          ct_closest *closest)
{
  int limit = options->iteration_limit > 0 ? options->iteration_limit : default_limit, done = 0,
      moved = 1;
  double tolerance = options->tolerance * ct_patch_half_width(patch->kind), before = 2 * tolerance,
         s[2] = {0, 0};
  ct_iterate at, next;
  ct_iterate_start(patch, options, at.xi);
  ct_iterate_visit(patch, options, &at, closest);
  for (; !done && closest->iterations < limit; closest->iterations++) {
    moved = rule(patch, &at, s, memory) &&
            (search_line ? line_search : full_step)(patch, &at, s, &next, closest);
    if (!moved) break;
    for (int a = 0; a < 2 && search_line; a++) s[a] = next.xi[a] - at.xi[a];
    done = is_done(s, tolerance, &before);
    at = next;
    if (options->trace != NULL) options->trace(at.xi, at.f, options->user);
  }
  ct_status end = ct_iterate_status(patch, options, &at, closest);
  if (done || (!moved && search_line)) return end;
  return moved ? CT_ITERATION_LIMIT : CT_NO_CONVERGENCE;
}

/* The local shape of the face at an iterate. Returns 0 if there is no normal. */
static int local_at(const ct_patch *patch, const ct_iterate *at, ct_local *local)
{
  double t1[3], t2[3], t11[3], t22[3], t12[3], n[3], e2[3];
  tangents(patch, at->xi, t1, t2);
  curves(patch, at->xi, t11, t22, t12);
  if (!ct_vector_unit_normal(t1, t2, n)) return 0;
  // -- Orthonormal frame, the first axis along the first tangent (eq:projection-frame)
  double R11 = sqrt(dot(t1, t1)), e1[3] = {t1[0] / R11, t1[1] / R11, t1[2] / R11};
  ct_vector_cross(n, e1, e2);
  double R12 = dot(t2, e1), R22 = dot(t2, e2), ratio = R12 / R11;
  local->R[0] = R11, local->R[1] = R22, local->R[2] = R12;
  // -- Curvatures in this frame (eq:projection-curvatures)
  double b11 = dot(n, t11), b22 = dot(n, t22), b12 = dot(n, t12);
  local->kappa[0] = b11 / (R11 * R11);
  local->kappa[1] = (b22 - 2 * ratio * b12 + ratio * ratio * b11) / (R22 * R22);
  local->kappa[2] = (b12 - ratio * b11) / (R11 * R22);
  local->r[0] = -dot(at->d, e1), local->r[1] = -dot(at->d, e2), local->r[2] = -dot(at->d, n);
  return 1;
}

/* The step of xi to the closest point on the local shape, by a rule. */
static int local_step(const ct_patch *patch, const ct_iterate *at, double s[2], void *memory)
{
  ct_local_rule *const *rule = memory;
  ct_local local;
  double w[2];
  if (!local_at(patch, at, &local)) return 0;
  (*rule)(&local, w);
  // -- The step that moves by w in the tangent plane (eq:projection-pull-back)
  s[1] = w[1] / local.R[1];
  s[0] = (w[0] - local.R[2] * s[1]) / local.R[0];
  return 1;
}

ct_status ct_local_walk(const ct_patch *patch, const ct_project_options *options,
                        ct_local_rule *rule, ct_closest *closest)
{
  return ct_iterate_walk(patch, options, 200, 0, local_step, &rule, closest);
}
