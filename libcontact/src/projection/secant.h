#ifndef CT_SRC_SECANT_H
#define CT_SRC_SECANT_H

#include "polynomial.h"

/* Lower bounds of f on a piece of the face by the secant form, from a closest point or another
 * point of the face. Each lane has a face and a closest point; the piece is the same one. */

/* A product of six lengths of a face of size one must be larger than this; otherwise rounding is no
 * longer relative. */
static const double SMALLEST = 1e-290;

/* A piece of the reference face: a rectangle about its centre, with half-widths that may be zero;
 * or a triangle of the face's form about its centroid, with a third of its legs, negative when it
 * is turned by half a turn. */
typedef struct cell {
  double centre[2], half[2];
} cell;

/* The statement to be proved, and its rounding errors. */
typedef struct proof {
  const patches *patch;
  int triangular;
  real target;     /* f that no point of the face may fall below */
  real tangent[2]; /* bounds on |t1|, |t2| over the face */
  real curve[3];   /* bounds on |t11|, |t22|, |t12| */
  real twist[2];   /* of |t112|, |t122| */
  real rounding;   /* of d */
} proof;

/* The face about one of its points, and products of d there with the higher derivatives. */
typedef struct base {
  real xi[2], f, distance, d[3], g[2];
  real t1[3], t2[3], t11[3], t22[3], t12[3];
  real d11, d22, d12, d6, d7;
} base;

/* A quadratic form m11 s1^2 + m22 s2^2 + 2 m12 s1 s2 with m12 anywhere between two bounds. */
typedef struct form {
  real m11, m22, low, high;
} form;

/* Bound on the linear term: its largest negative value on the cell, and the gradient of the parts
 * with this sign. */
typedef struct slack {
  real loss, g[2];
} slack;

PART void base_at(const patches *patch, const real xi[2], base *b)
{
  b->xi[0] = xi[0], b->xi[1] = xi[1];
  b->f = value(patch, xi, b->d);
  b->distance = root(b->f);
  tangents(patch, xi, b->t1, b->t2);
  curves(patch, xi, b->t11, b->t22, b->t12);
  // -- Gradient (eq:projection-gradient)
  b->g[0] = 2 * dot(b->d, b->t1);
  b->g[1] = 2 * dot(b->d, b->t2);
  b->d11 = dot(b->d, b->t11), b->d22 = dot(b->d, b->t22), b->d12 = dot(b->d, b->t12);
  b->d6 = 2 * dot(b->d, patch->c[6]), b->d7 = 2 * dot(b->d, patch->c[7]);
}

/* Bounds over the face, and the target for a closest point at this distance. Returns the lanes in
 * which rounding leaves a margin for a proof. */
PART mask proof_about(proof *p, const patches *patch, double tolerance, real distance)
{
  real n[8], all = every(0);
  for (int j = 0; j < 8; j++)
    n[j] = (absolute(patch->c[j][0]) + absolute(patch->c[j][1])) + absolute(patch->c[j][2]),
    all += n[j];
  p->patch = patch;
  p->triangular = ct_is_triangular(patch->kind);
  // -- Bounds of the derivatives (eq:certified-derivatives)
  p->tangent[0] = (n[1] + n[3]) + (2 * (n[4] + n[6]) + n[7]),
  p->tangent[1] = (n[2] + n[3]) + (2 * (n[5] + n[7]) + n[6]);
  p->curve[0] = 2 * n[4] + 6 * n[6], p->curve[1] = 2 * n[5] + 6 * n[7],
  p->curve[2] = n[3] + 2 * (n[6] + n[7]);
  p->twist[0] = 2 * n[6], p->twist[1] = 2 * n[7];
  p->rounding = 64 * DBL_EPSILON * all;
  // -- The margin minus the rounding errors (eq:certified-target)
  double relative = 0.5 * fmin(fmax(tolerance, 1e-12), 1e-6);
  real margin = relative * most(distance, patch->size) - 2 * p->rounding,
       low = most(distance - margin, every(0));
  p->target = low * low;
  return margin > 0;
}

static inline cell whole_face(int triangular)
{
  double centre = triangular ? 1.0 / 3 : 0, half = triangular ? 1.0 / 3 : 1;
  cell whole = {{centre, centre}, {half, half}};
  return whole;
}

/* Distance of the cell's farthest point from its centre. */
static inline void reach(const cell *c, int triangular, double w[2])
{
  for (int a = 0; a < 2; a++) w[a] = triangular ? 2 * fabs(c->half[a]) : c->half[a];
}

/* Lower bound of the quadratic part of f about the base, for any point in the cell. */
PART void secant_form(const proof *p, const base *b, const cell *c, form *m)
{
  const real *c6 = p->patch->c[6], *c7 = p->patch->c[7];
  double w[2];
  real x = c->centre[0] - b->xi[0], y = c->centre[1] - b->xi[1], a1[3], a2[3];
  reach(c, p->triangular, w);
  real v = (absolute(x) * w[1] + absolute(y) * w[0]) + w[0] * w[1];
  for (int k = 0; k < 3; k++) {
    // -- Secants from the base to the centre of the cell (eq:certified-secants)
    a1[k] = (b->t1[k] + 0.5 * (x * b->t11[k] + y * b->t12[k])) + x * y * c6[k];
    a2[k] = (b->t2[k] + 0.5 * (y * b->t22[k] + x * b->t12[k])) + x * y * c7[k];
  }
  real a11 = dot(a1, b->t11), a12 = dot(a1, b->t12), a22 = dot(a1, b->t22);
  real b11 = dot(a2, b->t11), b12 = dot(a2, b->t12), b22 = dot(a2, b->t22);
  real a6 = dot(a1, c6), a7 = dot(a1, c7), b6 = dot(a2, c6), b7 = dot(a2, c7);
  // -- Form at the centre of the cell (eq:certified-form)
  m->m11 = dot(a1, a1) + (b->d11 + b->d6 * y);
  m->m22 = dot(a2, a2) + (b->d22 + b->d7 * x);
  real m12 = dot(a1, a2) + b->d12;
  // -- Possible loss elsewhere in the cell, and to rounding
  // (eq:certified-rounding)
  const real *t = p->tangent, *h = p->curve;
  const double e = 256 * DBL_EPSILON;
  const real hidden[3] = {e * (t[0] * t[0] + b->distance * h[0]),
                          e * (t[1] * t[1] + b->distance * h[1]),
                          e * (t[0] * t[1] + b->distance * h[2])};
  // (eq:certified-spread)
  m->m11 -=
      (absolute(a11) * w[0] + absolute(a12 + b->d6) * w[1]) + 2 * absolute(a6) * v + hidden[0];
  m->m22 -=
      (absolute(b22) * w[1] + absolute(b12 + b->d7) * w[0]) + 2 * absolute(b7) * v + hidden[1];
  real spread = 0.5 * (absolute(a22 + b12) * w[1] + absolute(a12 + b11) * w[0]) +
                absolute(a7 + b6) * v + hidden[2];
  m->low = m12 - spread;
  m->high = m12 + spread;
  // -- A piece of an edge has steps along it only, so that any number will do for the other entry
  for (int a = 0; a < 2; a++) {
    if (w[a] > 0) continue;
    mask edge = b->xi[a] == c->centre[a];
    if (a == 0) m->m11 = pick(edge, most(m->m11, t[0] * t[0]), m->m11);
    else m->m22 = pick(edge, most(m->m22, t[1] * t[1]), m->m22);
    m->low = pick(edge, every(0), m->low);
    m->high = pick(edge, every(0), m->high);
  }
}

/* Least and largest value over the cell of a linear function with the gradient g and the value
 * `middle` at its centre. */
PART void linear_range(const proof *p, const cell *c, const real g[2], real middle, real *low,
                       real *high)
{
  real first = c->half[0] * g[0], second = c->half[1] * g[1];
  if (!p->triangular) {
    *low = middle - (absolute(first) + absolute(second));
    *high = middle + (absolute(first) + absolute(second));
    return;
  }
  real i = -first - second, j = 2 * first - second, k = 2 * second - first;
  *low = middle + least(i, least(j, k));
  *high = middle + most(i, most(j, k));
}

/* Add one part of the linear term over the cell: a slope l in the direction e, which helps if it is
 * positive. */
PART void linear_share(const proof *p, const cell *c, const base *closest, real l,
                       const double e[2], form *m, slack *rest)
{
  real low, high, g[2] = {l * e[0], l * e[1]}, zero = every(0);
  linear_range(p, c, g,
               g[0] * (c->centre[0] - closest->xi[0]) + g[1] * (c->centre[1] - closest->xi[1]),
               &low, &high);
  mask helps = (low >= 0) & (high > 0);
  rest->loss -= pick(helps, zero, least(low, zero));
  for (int a = 0; a < 2; a++) rest->g[a] += pick(helps, zero, g[a]);
  if (!any(helps)) return;
  // -- A slope away from the closest point is at least a parabola (eq:certified-slope)
  real share = pick(helps, l / (high / l) * (1 - 16 * DBL_EPSILON), zero);
  m->m11 += share * (e[0] * e[0]);
  m->m22 += share * (e[1] * e[1]);
  m->low += share * (e[0] * e[1]);
  m->high += share * (e[0] * e[1]);
}

/* The largest decrease of the form by the product s1 s2 of either sign, for |2 s1 s2| = 1. */
PART real worst_twist(const form *m) { return most(-m->low, m->high); }

/* Is the form nowhere negative? */
PART mask is_positive(const form *m, real twist)
{
  // -- Positive on all steps that occur (eq:certified-positive)
  return (m->m11 >= 0) & (m->m22 >= 0) &
         (m->m11 * m->m22 >= twist * twist * (1 + 16 * DBL_EPSILON));
}

/* Rounding of the value and the linear part about a base. */
PART real base_rounding(const proof *p, const base *b)
{
  return 16 * DBL_EPSILON * b->distance * (b->distance + 4 * (p->tangent[0] + p->tangent[1]));
}

/* Does a parabola with the positive form m and the gradient g fall below its value at the base by
 * at most `allowance`? */
PART mask holds_parabola(const form *m, real twist, const real g[2], real allowance)
{
  real g1 = absolute(g[0]), g2 = absolute(g[1]), product = m->m11 * m->m22;
  // -- The lowest value of a parabola that lies below f
  real divisor = (product - twist * twist) * (1 - 1e-6) - 1e-9 * product, may = allowance * divisor;
  // (eq:certified-parabola, eq:certified-rest)
  real drop = 0.25 * ((m->m22 * g1) * g1 + 2 * (twist * g1) * g2 + (m->m11 * g2) * g2) * (1 + 1e-6);
  return (divisor > 0) & (may > SMALLEST) & (drop < HUGE_VAL) & (drop <= may);
}

/* Is no point of the cell closer than the closest point allows, by an expansion about the closest
 * point? */
PART mask proven_from_closest(const proof *p, const base *closest, const cell *c)
{
  static const double E1[2] = {1, 0}, E2[2] = {0, 1}, E3[2] = {-1, -1};
  form m;
  slack rest = {every(0), {every(0), every(0)}};
  double w[2];
  real x = c->centre[0] - closest->xi[0], y = c->centre[1] - closest->xi[1], zero = every(0);
  real allowance = closest->f - base_rounding(p, closest) - p->target;
  mask open = not(allowance < 0);
  if (!any(open)) return open;
  reach(c, p->triangular, w);
  secant_form(p, closest, c, &m);
  // -- Shares of the slope along the sides of the face (eq:certified-shares)
  real slant = p->triangular ? most(zero, -least(closest->g[0], closest->g[1])) : zero,
       first = closest->g[0] + slant, second = closest->g[1] + slant;
  if (any(slant > 0)) linear_share(p, c, closest, slant, E3, &m, &rest);
  if (any(first != 0)) linear_share(p, c, closest, first, E1, &m, &rest);
  if (any(second != 0)) linear_share(p, c, closest, second, E2, &m, &rest);
  // -- The sign that s1 s2 has throughout the cell, if it has one
  mask wide = absolute(x) >= w[0], corner = wide & (absolute(y) >= w[1]), same = x * y > 0;
  real sided = pick(same, most(-m.low, zero), most(m.high, zero)),
       twist = pick(corner, sided, worst_twist(&m));
  // The form of a plane face without curved sides is a sum of squares, also if rounding hides this.
  mask plane = p->curve[0] + p->curve[1] + p->curve[2] == 0, positive = is_positive(&m, twist),
       small = rest.loss <= allowance, proven = small & (plane | positive);
  // -- Remaining slope at the closest point, compared with the form
  mask left = positive & not(small);
  if (any(left)) proven |= left & holds_parabola(&m, twist, rest.g, allowance);
  return proven & open;
}

#endif
