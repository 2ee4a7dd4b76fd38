#include "projection_internal.h"

#include "../base/vector.h"

#include <float.h>
#include <math.h>

/* A product of six lengths of a face of size one must be larger than this, or rounding is not
 * relative any more. */
static const double SMALLEST = 1e-290;

static inline double least(double a, double b) { return b < a ? b : a; }
static inline double most(double a, double b) { return b > a ? b : a; }

/* A piece of the reference face: a rectangle about its centre, with half-widths that may be zero;
 * or a triangle of the face's form about its centroid, with a third of its legs, negative when it
 * is turned by half a turn. */
typedef struct cell {
  double centre[2], half[2];
} cell;

/* What is to be shown, and how rounding may lie about it. */
typedef struct proof {
  const ct_patch *patch;
  int triangular;
  double target;     /* f that no point of the face may be below */
  double tangent[2]; /* bounds of |t1|, |t2| over the face */
  double curve[3];   /* bounds of |t11|, |t22|, |t12| */
  double twist[2];   /* of |t112|, |t122| */
  double rounding;   /* of d */
} proof;

/* The face about one of its points, and products of d there with the higher derivatives. */
typedef struct base {
  double xi[2], f, distance, d[3], g[2];
  double t1[4], t2[4], t11[4], t22[4], t12[4];
  double d11, d22, d12, d6, d7;
} base;

/* A quadratic form m11 s1^2 + m22 s2^2 + 2 m12 s1 s2 with m12 anywhere between two bounds. */
typedef struct form {
  double m11, m22, low, high;
} form;

static void base_at(const ct_patch *patch, const double xi[2], base *b)
{
  b->xi[0] = xi[0], b->xi[1] = xi[1];
  b->f = ct_patch_value(patch, xi, b->d);
  b->distance = sqrt(b->f);
  ct_patch_tangents(patch, xi, b->t1, b->t2);
  ct_patch_curves(patch, xi, b->t11, b->t22, b->t12);
  // -- Gradient (eq:projection-gradient)
  b->g[0] = 2 * ct_vector_dot(b->d, b->t1);
  b->g[1] = 2 * ct_vector_dot(b->d, b->t2);
  b->d11 = ct_vector_dot(b->d, b->t11), b->d22 = ct_vector_dot(b->d, b->t22),
  b->d12 = ct_vector_dot(b->d, b->t12);
  b->d6 = 2 * ct_vector_dot(b->d, patch->c[6]), b->d7 = 2 * ct_vector_dot(b->d, patch->c[7]);
}

/* How far the cell reaches from its centre. */
static void reach(const proof *p, const cell *c, double w[2])
{
  for (int a = 0; a < 2; a++) w[a] = p->triangular ? 2 * fabs(c->half[a]) : c->half[a];
}

/* Lower bound of the quadratic part of f about the base, as seen from anywhere in the cell. */
static void secant_form(const proof *p, const base *b, const cell *c, form *m)
{
  const double *c6 = p->patch->c[6], *c7 = p->patch->c[7];
  double w[2], x = c->centre[0] - b->xi[0], y = c->centre[1] - b->xi[1], a1[4], a2[4];
  reach(p, c, w);
  double v = (fabs(x) * w[1] + fabs(y) * w[0]) + w[0] * w[1];
  for (int k = 0; k < 4; k++) {
    // -- Secants from the base to the centre of the cell (eq:certified-secants)
    a1[k] = (b->t1[k] + 0.5 * (x * b->t11[k] + y * b->t12[k])) + x * y * c6[k];
    a2[k] = (b->t2[k] + 0.5 * (y * b->t22[k] + x * b->t12[k])) + x * y * c7[k];
  }
  double a11 = ct_vector_dot(a1, b->t11), a12 = ct_vector_dot(a1, b->t12),
         a22 = ct_vector_dot(a1, b->t22);
  double b11 = ct_vector_dot(a2, b->t11), b12 = ct_vector_dot(a2, b->t12),
         b22 = ct_vector_dot(a2, b->t22);
  double a6 = ct_vector_dot(a1, c6), a7 = ct_vector_dot(a1, c7), b6 = ct_vector_dot(a2, c6),
         b7 = ct_vector_dot(a2, c7);
  // -- Form at the centre of the cell (eq:certified-form)
  m->m11 = ct_vector_dot(a1, a1) + (b->d11 + b->d6 * y);
  m->m22 = ct_vector_dot(a2, a2) + (b->d22 + b->d7 * x);
  double m12 = ct_vector_dot(a1, a2) + b->d12;
  // -- What it may lose elsewhere in the cell (eq:certified-spread), and to rounding
  // (eq:certified-rounding)
  const double *t = p->tangent, *h = p->curve, e = 256 * DBL_EPSILON;
  m->m11 -= (fabs(a11) * w[0] + fabs(a12 + b->d6) * w[1]) + 2 * fabs(a6) * v +
            e * (t[0] * t[0] + b->distance * h[0]);
  m->m22 -= (fabs(b22) * w[1] + fabs(b12 + b->d7) * w[0]) + 2 * fabs(b7) * v +
            e * (t[1] * t[1] + b->distance * h[1]);
  double spread = 0.5 * (fabs(a22 + b12) * w[1] + fabs(a12 + b11) * w[0]) + fabs(a7 + b6) * v +
                  e * (t[0] * t[1] + b->distance * h[2]);
  m->low = m12 - spread;
  m->high = m12 + spread;
  // -- A piece of an edge has steps along it only, so that any number will do for the other entry
  for (int a = 0; a < 2; a++) {
    if (w[a] > 0 || c->centre[a] != b->xi[a]) continue;
    if (a == 0) m->m11 = most(m->m11, t[0] * t[0]);
    else m->m22 = most(m->m22, t[1] * t[1]);
    m->low = m->high = 0;
  }
}

/* Least and largest value over the cell of a linear function that has the gradient g and the value
 * `middle` at its centre. */
static void linear_range(const proof *p, const cell *c, const double g[2], double middle,
                         double *low, double *high)
{
  double first = c->half[0] * g[0], second = c->half[1] * g[1];
  if (!p->triangular) {
    *low = middle - (fabs(first) + fabs(second));
    *high = middle + (fabs(first) + fabs(second));
    return;
  }
  double i = -first - second, j = 2 * first - second, k = 2 * second - first;
  *low = middle + least(i, least(j, k));
  *high = middle + most(i, most(j, k));
}

/* The most that the product s1 s2, which has the sign of `sign` (0: any), can take from the form,
 * for |2 s1 s2| = 1. */
static double worst_twist(const form *m, int sign)
{
  return sign > 0 ? most(-m->low, 0) : sign < 0 ? most(m->high, 0) : most(-m->low, m->high);
}

/* Is the form nowhere negative? */
static int is_positive(const form *m, double twist)
{
  // -- Positive on all steps that occur (eq:certified-positive)
  return m->m11 >= 0 && m->m22 >= 0 && m->m11 * m->m22 >= twist * twist * (1 + 16 * DBL_EPSILON);
}

/* Rounding of the value and the linear part about a base. */
static double base_rounding(const proof *p, const base *b)
{
  return 16 * DBL_EPSILON * b->distance * (b->distance + 4 * (p->tangent[0] + p->tangent[1]));
}

/* Does a parabola with the positive form m and the gradient g fall below its value at the base by
 * no more than `room`? */
static int holds_parabola(const form *m, double twist, const double g[2], double room)
{
  double g1 = fabs(g[0]), g2 = fabs(g[1]), product = m->m11 * m->m22;
  // -- The lowest value of a parabola that lies below f (eq:certified-parabola)
  double divisor = (product - twist * twist) * (1 - 1e-6) - 1e-9 * product, may = room * divisor;
  double drop =
      0.25 * ((m->m22 * g1) * g1 + 2 * (twist * g1) * g2 + (m->m11 * g2) * g2) * (1 + 1e-6);
  return divisor > 0 && may > SMALLEST && drop < HUGE_VAL && drop <= may;
}

/* What the linear term costs: the most that it falls below zero on the cell, and the gradient of
 * the shares that do so. */
typedef struct slack {
  double loss, g[2];
} slack;

/* Add what one part of the linear term does over the cell: a share lambda of the direction e, which
 * helps where it is positive. */
static void linear_share(const proof *p, const cell *c, const base *foot, double lambda,
                         const double e[2], form *m, slack *rest)
{
  double low, high, g[2] = {lambda * e[0], lambda * e[1]};
  linear_range(p, c, g, g[0] * (c->centre[0] - foot->xi[0]) + g[1] * (c->centre[1] - foot->xi[1]),
               &low, &high);
  if (!(low >= 0 && high > 0)) {
    rest->loss -= least(low, 0);
    for (int a = 0; a < 2; a++) rest->g[a] += g[a];
    return;
  }
  // -- A slope away from the foot is at least a parabola (eq:certified-slope)
  double share = lambda / (high / lambda) * (1 - 16 * DBL_EPSILON);
  m->m11 += share * (e[0] * e[0]);
  m->m22 += share * (e[1] * e[1]);
  m->low += share * (e[0] * e[1]);
  m->high += share * (e[0] * e[1]);
}

/* Is no point of the cell closer than the foot allows, as seen from the foot? */
static int proven_from_foot(const proof *p, const base *foot, const cell *c)
{
  static const double E1[2] = {1, 0}, E2[2] = {0, 1}, E3[2] = {-1, -1};
  form m;
  slack rest = {0, {0, 0}};
  double w[2], x = c->centre[0] - foot->xi[0], y = c->centre[1] - foot->xi[1];
  double room = foot->f - base_rounding(p, foot) - p->target;
  if (room < 0) return 0;
  reach(p, c, w);
  secant_form(p, foot, c, &m);
  // -- Shares of the slope along the sides of the face (eq:certified-shares)
  double slant = p->triangular ? most(0, -least(foot->g[0], foot->g[1])) : 0;
  if (slant > 0) linear_share(p, c, foot, slant, E3, &m, &rest);
  if (foot->g[0] + slant != 0) linear_share(p, c, foot, foot->g[0] + slant, E1, &m, &rest);
  if (foot->g[1] + slant != 0) linear_share(p, c, foot, foot->g[1] + slant, E2, &m, &rest);
  double twist = worst_twist(&m, fabs(x) < w[0] || fabs(y) < w[1] ? 0 : x * y > 0 ? 1 : -1);
  // The form of a plane face without curved sides is a sum of squares, whatever rounding shows of
  // it.
  int is_square = p->curve[0] + p->curve[1] + p->curve[2] == 0, positive = is_positive(&m, twist);
  if (rest.loss <= room) return is_square || positive;
  // -- What is left of the slope at the foot, against the form (eq:certified-rest)
  return positive && holds_parabola(&m, twist, rest.g, room);
}

/* The same within half-widths w, for a form that is positive across a valley and nearly nothing
 * along it. */
static int holds_in_valley(const form *m, const double g[2], const double w[2], double room)
{
  double M[3] = {m->m11, m->m22, 0.5 * (m->low + m->high)}, q[2], unused[2];
  ct_principal(M, q, unused);
  // -- Form and slope along and across (eq:certified-turned)
  double first = M[0] * q[0] + M[2] * q[1], second = M[2] * q[0] + M[1] * q[1];
  double lost = 0.5 * (m->high - m->low) + fabs(second * q[0] - first * q[1]) +
                32 * DBL_EPSILON * (fabs(M[0]) + fabs(M[1]) + 2 * fabs(M[2]));
  double across = first * q[0] + second * q[1] - lost,
         along = (M[0] * (q[1] * q[1]) + M[1] * (q[0] * q[0])) - 2 * M[2] * (q[0] * q[1]) - lost;
  double steep = g[0] * q[0] + g[1] * q[1], slope = fabs(g[1] * q[0] - g[0] * q[1]),
         far = fabs(q[1]) * w[0] + fabs(q[0]) * w[1];
  room -= 16 * DBL_EPSILON * (fabs(g[0]) + fabs(g[1])) * (w[0] + w[1]);
  if (!(across > 0 && room * across > SMALLEST)) return 0;
  // -- Lowest value along the valley and across it (eq:certified-valley)
  double fall = along > 0 && slope <= 2 * along * far ? 0.25 * slope * slope / along
                                                      : far * (slope - along * far);
  return (most(fall, 0) + 0.25 * steep * steep / across) * (1 + 1e-6) <= room;
}

/* Does the slope at the centre of the cell, with the form m, take no more than `room` anywhere in
 * the cell? */
static int holds_in_cell(const proof *p, const base *b, const cell *c, const form *m, double room)
{
  double low, high, w[2], twist = worst_twist(m, 0);
  if (room < 0) return 0;
  reach(p, c, w);
  linear_range(p, c, b->g, 0, &low, &high);
  double g[2] = {w[0] > 0 ? b->g[0] : 0, w[1] > 0 ? b->g[1] : 0};
  if (is_positive(m, twist)) {
    if (room + low >= 0 || holds_parabola(m, twist, g, room)) return 1;
  } else {
    // -- The form at its worst (eq:certified-worst)
    double half = 0.5 * (m->m11 - m->m22),
           lowest = 0.5 * (m->m11 + m->m22) - sqrt(half * half + twist * twist);
    if (room + low + (w[0] * w[0] + w[1] * w[1]) * (lowest * (1 + 16 * DBL_EPSILON)) >= 0) return 1;
  }
  return holds_in_valley(m, g, w, room);
}

/* Is no point of the cell closer than the target, as seen from its centre? */
static int proven_from_centre(const proof *p, const base *b, const cell *c)
{
  form m;
  secant_form(p, b, c, &m);
  return holds_in_cell(p, b, c, &m, b->f - base_rounding(p, b) - p->target);
}

/* The same with all terms of f about the centre, for places where many points are nearly as near.
 */
static int proven_by_series(const proof *p, const base *b, const cell *c)
{
  static const int POWER[8][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0}, {0, 2}, {2, 1}, {1, 2}};
  const double *part[8] = {b->d,   b->t1,  b->t2,          b->t12,
                           b->t11, b->t22, p->patch->c[6], p->patch->c[7]};
  double w[2], size[5][5], F[5][5] = {{0}}, all = 0, loss = 0;
  reach(p, c, w);
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 5; j++)
      size[i][j] = i > 0 ? size[i - 1][j] * w[0] : j > 0 ? size[0][j - 1] * w[1] : 1;
  for (int i = 0; i < 8; i++) {
    double half = i == 4 || i == 5 ? 0.5 : 1;
    all += half * sqrt(ct_vector_dot(part[i], part[i])) * size[POWER[i][0]][POWER[i][1]];
    // -- Coefficients of f (eq:certified-series)
    for (int j = 0; j <= i; j++) {
      double share = (j < i ? 2 : 1) * half * (j == 4 || j == 5 ? 0.5 : 1);
      F[POWER[i][0] + POWER[j][0]][POWER[i][1] + POWER[j][1]] +=
          share * ct_vector_dot(part[i], part[j]);
    }
  }
  // -- Terms from the third order on at their worst (eq:certified-series-bound)
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 5; j++)
      if (i + j > 2)
        loss += (i % 2 == 0 && j % 2 == 0 ? most(-F[i][j], 0) : fabs(F[i][j])) * size[i][j];
  form m = {F[2][0], F[0][2], 0.5 * F[1][1], 0.5 * F[1][1]};
  return holds_in_cell(p, b, c, &m, b->f - p->target - loss - 256 * DBL_EPSILON * (all * all));
}

/* Cut a cell into four, or into two if it is a piece of an edge; answers how many. */
static int divide(int triangular, const cell *c, cell part[4])
{
  static const double SQUARE[4][2] = {{-1, -1}, {1, 1}, {1, -1}, {-1, 1}},
                      TRIANGLE[4][2] = {{-1, -1}, {2, -1}, {-1, 2}, {0, 0}};
  int count = triangular || (c->half[0] > 0 && c->half[1] > 0) ? 4 : 2;
  for (int i = 0; i < count; i++)
    for (int a = 0; a < 2; a++) {
      double half = 0.5 * c->half[a];
      part[i].centre[a] = c->centre[a] + half * (triangular ? TRIANGLE[i][a] : SQUARE[i][a]);
      part[i].half[a] = triangular && i == 3 ? -half : half;
    }
  return count;
}

/* Does the triangular cell not touch the boundary of the face? */
static int is_inside(const cell *c)
{
  double leg = 3 * fabs(c->half[0]), before = c->half[0] > 0 ? leg / 3 : 2 * leg / 3,
         beyond = c->half[0] > 0 ? leg / 3 : 2 * leg / 3;
  return c->centre[0] - before > DBL_EPSILON && c->centre[1] - before > DBL_EPSILON &&
         c->centre[0] + c->centre[1] + beyond < 1 - DBL_EPSILON;
}

typedef enum slope { OPEN, EMPTY, REDUCED } slope;

/* Does f rise or fall throughout the cell along one axis? Then only the part on the boundary of the
 * face, if there is one, can hold the closest point. Answers EMPTY when no part is left; REDUCED
 * when the cell has become a piece of the boundary. */
static slope slope_in_cell(const proof *p, const base *b, cell *c)
{
  const double *t = p->tangent, *h = p->curve;
  double w[2], H[3] = {2 * (ct_vector_dot(b->t1, b->t1) + b->d11),
                       2 * (ct_vector_dot(b->t2, b->t2) + b->d22),
                       2 * (ct_vector_dot(b->t1, b->t2) + b->d12)};
  reach(p, c, w);
  int reduced = 0;
  double far = b->distance + t[0] * w[0] + t[1] * w[1];
  // -- Bounds of the third derivatives of f (eq:certified-third)
  double k111 = 6 * t[0] * h[0], k222 = 6 * t[1] * h[1];
  double k112 = 4 * t[0] * h[2] + 2 * t[1] * h[0] + 2 * far * p->twist[0],
         k122 = 4 * t[1] * h[2] + 2 * t[0] * h[1] + 2 * far * p->twist[1];
  double square[3] = {0.5 * (w[0] * w[0]), 0.5 * (w[1] * w[1]), w[0] * w[1]};
  // -- How much each slope changes over the cell (eq:certified-slopes)
  double change[2] = {(fabs(H[0]) * w[0] + fabs(H[2]) * w[1]) +
                          (k111 * square[0] + k112 * square[2] + k122 * square[1]),
                      (fabs(H[2]) * w[0] + fabs(H[1]) * w[1]) +
                          (k112 * square[0] + k122 * square[2] + k222 * square[1])};
  for (int a = 0; a < 2; a++) {
    double hidden = 2 * p->rounding * (t[a] + 4 * far) + 64 * DBL_EPSILON * change[a];
    if (!(fabs(b->g[a]) > change[a] + hidden)) continue;
    double side = c->centre[a] - (b->g[a] > 0 ? c->half[a] : -c->half[a]);
    if (p->triangular) {
      if (is_inside(c)) return EMPTY;
      continue;
    }
    if (fabs(side) < 1) return EMPTY;
    if (c->half[a] == 0) continue;
    c->centre[a] = side;
    c->half[a] = 0;
    reduced = 1;
  }
  return reduced ? REDUCED : OPEN;
}

/* Bounds over the face, and what must be shown of a foot at this distance. Answers 0 when rounding
 * leaves nothing to show it with. */
static int proof_about(proof *p, const ct_patch *patch, double tolerance, double distance)
{
  double n[8], all = 0;
  for (int j = 0; j < 8; j++)
    n[j] = (fabs(patch->c[j][0]) + fabs(patch->c[j][1])) + fabs(patch->c[j][2]), all += n[j];
  p->patch = patch;
  p->triangular = patch->kind == CT_T3 || patch->kind == CT_T6;
  // -- Bounds of the derivatives (eq:certified-derivatives)
  p->tangent[0] = (n[1] + n[3]) + (2 * (n[4] + n[6]) + n[7]),
  p->tangent[1] = (n[2] + n[3]) + (2 * (n[5] + n[7]) + n[6]);
  p->curve[0] = 2 * n[4] + 6 * n[6], p->curve[1] = 2 * n[5] + 6 * n[7],
  p->curve[2] = n[3] + 2 * (n[6] + n[7]);
  p->twist[0] = 2 * n[6], p->twist[1] = 2 * n[7];
  p->rounding = 64 * DBL_EPSILON * all;
  // -- The margin, less what rounding may hide (eq:certified-target)
  double margin =
      0.5 * least(most(tolerance, 1e-12), 1e-6) * most(distance, patch->size) - 2 * p->rounding;
  double floor_ = most(distance - margin, 0);
  p->target = floor_ * floor_;
  return margin > 0;
}

static cell whole_face(int triangular)
{
  double centre = triangular ? 1.0 / 3 : 0, half = triangular ? 1.0 / 3 : 1;
  cell whole = {{centre, centre}, {half, half}};
  return whole;
}

/* Is a cell done, after `depth` cuts at most? All parts are looked at whatever the others show, so
 * that a mirror changes nothing. */
static int proven_after_cuts(const proof *p, const base *foot, cell c, int depth, ct_foot *count)
{
  if (proven_from_foot(p, foot, &c)) return 1;
  base b;
  base_at(p->patch, c.centre, &b);
  count->evaluations++;
  if (b.f < p->target) return 0;
  if (proven_from_centre(p, &b, &c) || slope_in_cell(p, &b, &c) == EMPTY) return 1;
  if (depth == 0) return 0;
  cell part[4];
  int parts = divide(p->triangular, &c, part), all = 1;
  for (int i = 0; i < parts; i++) all &= proven_after_cuts(p, foot, part[i], depth - 1, count);
  return all;
}

int ct_proof_at_sight(const ct_patch *patch, const double xi[2], int depth, ct_foot *count)
{
  proof p;
  base foot;
  base_at(patch, xi, &foot);
  count->evaluations++;
  if (!proof_about(&p, patch, 1e-10, foot.distance)) return 0;
  return !(p.target > 0) || proven_after_cuts(&p, &foot, whole_face(p.triangular), depth, count);
}

/* What a long thin face looks like from the foot: u = e.d along it, with e across d at the foot,
 * and the rest v = d - u e. As f = u^2 + v^2, no point of a cell is closer where |u| alone, or |v|
 * alone, is too large; and |v| changes little although u changes fast (eq:certified-narrow). */
typedef struct narrow {
  ct_patch along, across; /* u, in the first coordinate, and v */
  proof proof;            /* of v */
  base foot;              /* of v */
} narrow;

static void narrow_about(const proof *p, const base *foot, narrow *n)
{
  const double *t = p->tangent[0] > p->tangent[1] ? foot->t1 : foot->t2;
  double e[3], share = foot->f > 0 ? ct_vector_dot(t, foot->d) / foot->f : 0;
  for (int k = 0; k < 3; k++) e[k] = t[k] - share * foot->d[k];
  double length = sqrt(ct_vector_dot(e, e));
  for (int k = 0; k < 3; k++) e[k] = length > 0 ? e[k] / length : 0;
  n->along = n->across = *p->patch;
  for (int j = 0; j < 8; j++) {
    // -- Parts along and across (eq:certified-narrow)
    double u = ct_vector_dot(p->patch->c[j], e);
    for (int k = 0; k < 3; k++) {
      n->along.c[j][k] = k == 0 ? u : 0;
      n->across.c[j][k] = p->patch->c[j][k] - u * e[k];
    }
  }
  proof_about(&n->proof, &n->across, 1, 0);
  n->proof.rounding = p->rounding;
  double floor_ = sqrt(p->target) + 2 * p->rounding;
  n->proof.target = floor_ * floor_;
  base_at(&n->across, foot->xi, &n->foot);
}

/* Is |u| too large throughout the cell? */
static int is_beyond(const proof *p, const narrow *n, const cell *c)
{
  double d[3], t1[4], t2[4], t11[4], t22[4], t12[4], w[2];
  const double (*a)[4] = n->along.c;
  reach(p, c, w);
  ct_patch_value(&n->along, c->centre, d);
  ct_patch_tangents(&n->along, c->centre, t1, t2);
  ct_patch_curves(&n->along, c->centre, t11, t22, t12);
  // -- All terms of u about the centre (eq:certified-beyond)
  double first = fabs(t1[0]) * w[0] + fabs(t2[0]) * w[1];
  double second = 0.5 * (fabs(t11[0]) * (w[0] * w[0]) + fabs(t22[0]) * (w[1] * w[1])) +
                  fabs(t12[0]) * (w[0] * w[1]);
  double third = (fabs(a[6][0]) * w[0] + fabs(a[7][0]) * w[1]) * (w[0] * w[1]);
  return fabs(d[0]) - (first + second + third) * (1 + 16 * DBL_EPSILON) >= sqrt(n->proof.target);
}

/* Is a cell of a long thin face done? */
static int proven_narrow(const proof *p, const narrow *n, const cell *c)
{
  base b;
  if (is_beyond(p, n, c) || proven_from_foot(&n->proof, &n->foot, c)) return 1;
  base_at(&n->across, c->centre, &b);
  return proven_from_centre(&n->proof, &b, c);
}

ct_outcome ct_proof_search(const ct_patch *patch, double tolerance, int budget, double xi[2],
                           ct_foot *count)
{
  enum { DEPTH = 36, NARROW = 100 };
  cell stack[3 * DEPTH + 4];
  proof about, *p = &about;
  narrow thin;
  base at, *foot = &at;
  int size = 1, looks_narrow = 0;
  base_at(patch, xi, foot);
  count->evaluations++;
  if (!proof_about(p, patch, tolerance, foot->distance)) return CT_GAVE_UP;
  if (!(p->target > 0)) return CT_PROVEN;
  stack[0] = whole_face(p->triangular);
  for (int cells = 0; size > 0; cells++) {
    cell c = stack[--size];
    slope sloping = OPEN;
    // -- A cell is done if the foot, or its own centre, shows that it holds nothing closer
    // (eq:certified-bound)
    if (proven_from_foot(p, foot, &c)) continue;
    base b;
    if (cells > 0) {
      base_at(p->patch, c.centre, &b);
      count->evaluations++;
      if (b.f < p->target) {
        xi[0] = c.centre[0], xi[1] = c.centre[1];
        return CT_CLOSER;
      }
      if (proven_from_centre(p, &b, &c) || (sloping = slope_in_cell(p, &b, &c)) == EMPTY) continue;
    }
    // -- Many cells: look along and across the face as well (eq:certified-narrow)
    if (cells >= NARROW && !looks_narrow) {
      narrow_about(p, foot, &thin);
      looks_narrow = 1;
    }
    // A cell that has been reduced is no longer the one about the base b; it comes again.
    if (looks_narrow &&
        ((sloping == OPEN && proven_by_series(p, &b, &c)) || proven_narrow(p, &thin, &c)))
      continue;
    if (cells >= budget || size + 4 > 3 * DEPTH + 4) return CT_GAVE_UP;
    if (sloping == REDUCED) stack[size++] = c;
    else size += divide(p->triangular, &c, stack + size);
  }
  return CT_PROVEN;
}
