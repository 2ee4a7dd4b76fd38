#include "polynomial.h"

#include "../base/vector.h"

#include <math.h>

/* The face relative to a line: the two components across it, which vanish where the line meets the
 * face. */
typedef struct sight {
  const ct_patch *patch;
  double across[2][3], along[3]; /* unit vectors */
  double bend[2][3];             /* bounds on the second derivatives 11, 22, 12 of each component */
  double slack;                  /* distance beyond the face at which a hit is accepted, in xi */
} sight;

/* A square of the reference plane. */
typedef struct square {
  double centre[2], half;
} square;

/* The components across the line at xi, and their Jacobian. */
static void components_across(const sight *s, const double xi[2], double G[2], double dG[2][2])
{
  double d[3], t1[3], t2[3];
  value(s->patch, xi, d);
  tangents(s->patch, xi, t1, t2);
  for (int i = 0; i < 2; i++) {
    // -- Components across the line (eq:ray-across)
    G[i] = ct_vector_dot(s->across[i], d);
    dG[i][0] = ct_vector_dot(s->across[i], t1);
    dG[i][1] = ct_vector_dot(s->across[i], t2);
  }
}

/* Two unit vectors across the direction, and bounds on the second derivatives along them. Returns 0
 * for a direction of zero length. */
static int sight_along(sight *s, const double direction[3])
{
  double most = 0, check = 0, e[3], n[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++) most = fmax(most, fabs(direction[k])), check += 0 * direction[k];
  if (!(most > 0 && check == 0)) return 0;
  for (int k = 0; k < 3; k++) e[k] = direction[k] / most;
  double length = sqrt(ct_vector_dot(e, e));
  for (int k = 0; k < 3; k++) s->along[k] = e[k] / length;
  int least = fabs(e[0]) < fabs(e[1]) ? 0 : 1;
  n[fabs(e[2]) < fabs(e[least]) ? 2 : least] = 1;
  ct_vector_unit_normal(s->along, n, s->across[0]);
  ct_vector_unit_normal(s->along, s->across[0], s->across[1]);
  for (int i = 0; i < 2; i++) {
    double c[8];
    for (int j = 3; j < 8; j++) c[j] = fabs(ct_vector_dot(s->across[i], s->patch->c[j]));
    // -- Bounds of the second derivatives (eq:ray-bend)
    s->bend[i][0] = 2 * (c[4] + c[6]), s->bend[i][1] = 2 * (c[5] + c[7]),
    s->bend[i][2] = c[3] + 2 * (c[6] + c[7]);
  }
  return 1;
}

/* Result of one test of a square for roots. */
typedef enum square_class { NONE, ONE_AT_MOST, UNKNOWN } square_class;

static square_class classify(const sight *s, const square *q, double G[2], double dG[2][2])
{
  double w = q->half, spread[2];
  components_across(s, q->centre, G, dG);
  for (int i = 0; i < 2; i++) {
    const double *b = s->bend[i];
    // -- No root where a component cannot vanish (eq:ray-empty)
    spread[i] = 0.5 * (b[0] + b[1] + 2 * b[2]) * w * w;
    if (fabs(G[i]) > (fabs(dG[i][0]) + fabs(dG[i][1])) * w + spread[i]) return NONE;
  }
  double determinant = dG[0][0] * dG[1][1] - dG[0][1] * dG[1][0];
  if (!(fabs(determinant) > 0)) return UNKNOWN;
  double change = 0;
  for (int a = 0; a < 2; a++) {
    // -- The same for the components that Newton's step mixes (eq:ray-mixed)
    double p = (a == 0 ? dG[1][1] : -dG[1][0]) / determinant,
           r = (a == 0 ? -dG[0][1] : dG[0][0]) / determinant;
    double step = p * G[0] + r * G[1], bend = fabs(p) * spread[0] + fabs(r) * spread[1];
    if (fabs(step) > w + bend) return NONE;
    change = fmax(change, 2 * bend / w);
  }
  // -- At most one root where the Jacobian changes little (eq:ray-unique)
  return change < 0.5 ? ONE_AT_MOST : UNKNOWN;
}

/* Newton's method for the root that the square may contain; returns whether it does. */
static int polish(const sight *s, const square *q, double xi[2], int *evaluations)
{
  double G[2], dG[2][2], beyond = q->half * (1 + 1e-9) + s->slack;
  xi[0] = q->centre[0], xi[1] = q->centre[1];
  for (int i = 0; i < 20; i++) {
    components_across(s, xi, G, dG);
    ++*evaluations;
    double determinant = dG[0][0] * dG[1][1] - dG[0][1] * dG[1][0];
    // -- Newton's step across the line (eq:ray-newton)
    double x = (dG[0][1] * G[1] - dG[1][1] * G[0]) / determinant,
           y = (dG[1][0] * G[0] - dG[0][0] * G[1]) / determinant;
    xi[0] += x, xi[1] += y;
    if (!(fabs(xi[0] - q->centre[0]) <= 2 * beyond && fabs(xi[1] - q->centre[1]) <= 2 * beyond))
      return 0;
    if (fmax(fabs(x), fabs(y)) <= 1e-8) break;
  }
  return fabs(xi[0] - q->centre[0]) <= beyond && fabs(xi[1] - q->centre[1]) <= beyond;
}

/* Keep a root on the face if the line reaches it before the best one so far. */
static void keep(const sight *s, const double xi[2], double *best, double at[2])
{
  int index;
  double d[3];
  if (ct_patch_where(s->patch->kind, xi, s->slack, &index) == CT_OUTSIDE) return;
  ct_patch_value(s->patch, xi, d);
  double distance = ct_vector_dot(d, s->along);
  if (fabs(distance) < fabs(*best)) *best = distance, at[0] = xi[0], at[1] = xi[1];
}

ct_status ct_patch_ray(const ct_patch *patch, const double direction[3], double tolerance,
                       double xi[2], double *distance, int *evaluations)
{
  enum { BUDGET = 4000, DEPTH = 30 };
  static const double QUARTER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  int size = 1, touch = 0, triangular = ct_is_triangular(patch->kind);
  square stack[3 * DEPTH + 4];
  sight s = {.patch = patch, .slack = tolerance * ct_patch_half_width(patch->kind)};
  if (!sight_along(&s, direction)) return CT_INVALID;
  stack[0].centre[0] = stack[0].centre[1] = triangular ? 0.5 : 0;
  stack[0].half = (triangular ? 0.5 : 1) + s.slack;
  double smallest = ldexp(stack[0].half, -DEPTH), G[2], dG[2][2], root[2];
  *distance = HUGE_VAL;
  for (; size > 0 && *evaluations < BUDGET; ++*evaluations) {
    square q = stack[--size];
    if (triangular && q.centre[0] + q.centre[1] - 2 * q.half > 1 + s.slack) continue;
    square_class found = classify(&s, &q, G, dG);
    if (found == NONE) continue;
    if (found == ONE_AT_MOST) {
      if (polish(&s, &q, root, evaluations)) keep(&s, root, distance, xi);
      continue;
    }
    if (q.half <= smallest) {
      // -- Too small to cut: here the line touches the face without crossing it
      keep(&s, q.centre, distance, xi);
      touch = 1;
      continue;
    }
    for (int i = 0; i < 4; i++) {
      square *part = &stack[size++];
      part->half = 0.5 * q.half;
      for (int a = 0; a < 2; a++) part->centre[a] = q.centre[a] + part->half * QUARTER[i][a];
    }
  }
  if (*distance == HUGE_VAL) return size > 0 ? CT_ITERATION_LIMIT : CT_NO_CONVERGENCE;
  return size > 0 || touch ? CT_NOT_CERTIFIED : CT_OK;
}
