#include "secant.h"

/* The same within half-widths w, for a form that is positive across a valley and almost zero along
 * it. */
static int holds_in_valley(const form *m, const double g[2], const double w[2], double allowance)
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
  allowance -= 16 * DBL_EPSILON * (fabs(g[0]) + fabs(g[1])) * (w[0] + w[1]);
  if (!(across > 0 && allowance * across > SMALLEST)) return 0;
  // -- Lowest value along the valley and across it (eq:certified-valley)
  double fall = along > 0 && slope <= 2 * along * far ? 0.25 * slope * slope / along
                                                      : far * (slope - along * far);
  return (most(fall, 0) + 0.25 * steep * steep / across) * (1 + 1e-6) <= allowance;
}

/* Does the slope at the centre of the cell, with the form m, decrease f by at most `allowance`
 * anywhere in the cell? */
static int holds_in_cell(const proof *p, const base *b, const cell *c, const form *m,
                         double allowance)
{
  double low, high, w[2], twist = worst_twist(m);
  if (allowance < 0) return 0;
  reach(c, p->triangular, w);
  linear_range(p, c, b->g, 0, &low, &high);
  double g[2] = {w[0] > 0 ? b->g[0] : 0, w[1] > 0 ? b->g[1] : 0};
  if (is_positive(m, twist)) {
    if (allowance + low >= 0 || holds_parabola(m, twist, g, allowance)) return 1;
  } else {
    // -- The form at its worst (eq:certified-worst)
    double half = 0.5 * (m->m11 - m->m22),
           lowest = 0.5 * (m->m11 + m->m22) - sqrt(half * half + twist * twist);
    if (allowance + low + (w[0] * w[0] + w[1] * w[1]) * (lowest * (1 + 16 * DBL_EPSILON)) >= 0)
      return 1;
  }
  return holds_in_valley(m, g, w, allowance);
}

/* Is no point of the cell closer than the target, by an expansion about its centre? */
static int proven_from_centre(const proof *p, const base *b, const cell *c)
{
  form m;
  secant_form(p, b, c, &m);
  return holds_in_cell(p, b, c, &m, b->f - base_rounding(p, b) - p->target);
}

/* The same with all terms of f about the centre, for places where many points are almost equally
 * close. */
static int proven_by_series(const proof *p, const base *b, const cell *c)
{
  static const int POWER[8][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0}, {0, 2}, {2, 1}, {1, 2}};
  const double *part[8] = {b->d,   b->t1,  b->t2,          b->t12,
                           b->t11, b->t22, p->patch->c[6], p->patch->c[7]};
  double w[2], size[5][5], F[5][5] = {{0}}, all = 0, loss = 0;
  reach(c, p->triangular, w);
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 5; j++)
      size[i][j] = i > 0 ? size[i - 1][j] * w[0] : j > 0 ? size[0][j - 1] * w[1] : 1;
  for (int i = 0; i < 8; i++) {
    double half = i == 4 || i == 5 ? 0.5 : 1;
    all += half * sqrt(dot(part[i], part[i])) * size[POWER[i][0]][POWER[i][1]];
    // -- Coefficients of f (eq:certified-series)
    for (int j = 0; j <= i; j++) {
      double share = (j < i ? 2 : 1) * half * (j == 4 || j == 5 ? 0.5 : 1);
      F[POWER[i][0] + POWER[j][0]][POWER[i][1] + POWER[j][1]] += share * dot(part[i], part[j]);
    }
  }
  // -- Upper bound on the terms from the third order on (eq:certified-series-bound)
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 5; j++)
      if (i + j > 2)
        loss += (i % 2 == 0 && j % 2 == 0 ? most(-F[i][j], 0) : fabs(F[i][j])) * size[i][j];
  form m = {F[2][0], F[0][2], 0.5 * F[1][1], 0.5 * F[1][1]};
  return holds_in_cell(p, b, c, &m, b->f - p->target - loss - 256 * DBL_EPSILON * (all * all));
}

/* Cut a cell into four, or into two if it is a piece of an edge; returns their number. */
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

/* Is the triangular cell disjoint from the boundary of the face? */
static int is_inside(const cell *c)
{
  double far = c->half[0] > 0 ? c->half[0] : -2 * c->half[0];
  return c->centre[0] - far > DBL_EPSILON && c->centre[1] - far > DBL_EPSILON &&
         c->centre[0] + c->centre[1] + far < 1 - DBL_EPSILON;
}

typedef enum slope { OPEN, EMPTY, REDUCED } slope;

/* Does f increase or decrease throughout the cell along one axis? Then only the part on the
 * boundary of the face, if there is one, can contain the closest point. Returns EMPTY if no part is
 * left, REDUCED if the cell has become a piece of the boundary. */
static slope slope_in_cell(const proof *p, const base *b, cell *c)
{
  const double *t = p->tangent, *h = p->curve;
  double w[2], H[3] = {2 * (dot(b->t1, b->t1) + b->d11), 2 * (dot(b->t2, b->t2) + b->d22),
                       2 * (dot(b->t1, b->t2) + b->d12)};
  reach(c, p->triangular, w);
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

/* A point is better if it is closer, or equally close and nearer the centre; a mirror does not
 * change the result. */
static int is_better(const double a[2], double fa, const double b[2], double fb)
{
  double ra = a[0] * a[0] + a[1] * a[1], rb = b[0] * b[0] + b[1] * b[1];
  return fa < fb || (fa == fb && ra < rb);
}

/* Examine one cell that the closest point does not prove; store its parts that are still open.
 * Returns their number. A centre that is closer than the target replaces `closer` if it is better.
 */
static int open_parts(const proof *p, const base *closest, cell c, cell part[4], base *closer,
                      ct_closest *count)
{
  base b;
  int open = 0;
  base_at(p->patch, c.centre, &b);
  count->evaluations++;
  if (b.f < p->target) {
    if (is_better(b.xi, b.f, closer->xi, closer->f)) *closer = b;
    return 0;
  }
  if (proven_from_centre(p, &b, &c) || slope_in_cell(p, &b, &c) == EMPTY) return 0;
  int parts = divide(p->triangular, &c, part);
  for (int i = 0; i < parts; i++)
    if (!proven_from_closest(p, closest, &part[i])) part[open++] = part[i];
  return open;
}

ct_outcome ct_proof_by_cuts(const ct_patch *patch, double xi[2], ct_closest *count)
{
  enum { LEVELS = 24, CELLS = 32 };
  cell list[2][4 * CELLS];
  proof p;
  base closest, closer = {.f = HUGE_VAL};
  int open = 1;
  base_at(patch, xi, &closest);
  if (!proof_about(&p, patch, CT_PROVABLE, closest.distance)) return CT_GAVE_UP;
  list[0][0] = whole_face(p.triangular);
  // -- All cells of a level are examined, so that a mirror changes nothing
  for (int level = 0; level < LEVELS && open > 0 && open <= CELLS; level++) {
    const cell *now = list[level % 2];
    cell *next = list[1 - level % 2];
    int parts = 0;
    for (int i = 0; i < open; i++)
      parts += open_parts(&p, &closest, now[i], &next[parts], &closer, count);
    open = parts;
    if (!(closer.f < HUGE_VAL)) continue;
    xi[0] = closer.xi[0], xi[1] = closer.xi[1];
    return CT_CLOSER;
  }
  return open == 0 ? CT_PROVEN : CT_GAVE_UP;
}

/* A long thin face relative to the closest point: u = e.d along it, with e across d at the closest
 * point, and the rest v = d - u e. As f = u^2 + v^2, no point of a cell is closer if |u| alone, or
 * |v| alone, is too large; and |v| changes little although u changes fast (eq:certified-narrow). */
typedef struct narrow {
  ct_patch along, across; /* u, in the first coordinate, and v */
  proof proof;            /* of v */
  base closest;           /* of v */
} narrow;

static void narrow_about(const proof *p, const base *closest, narrow *n)
{
  const double *t = p->tangent[0] > p->tangent[1] ? closest->t1 : closest->t2;
  double e[3], share = closest->f > 0 ? dot(t, closest->d) / closest->f : 0;
  for (int k = 0; k < 3; k++) e[k] = t[k] - share * closest->d[k];
  double length = sqrt(dot(e, e));
  for (int k = 0; k < 3; k++) e[k] = length > 0 ? e[k] / length : 0;
  n->along = n->across = *p->patch;
  for (int j = 0; j < 8; j++) {
    // -- Parts along and across (eq:certified-narrow)
    double u = dot(p->patch->c[j], e);
    for (int k = 0; k < 3; k++) {
      n->along.c[j][k] = k == 0 ? u : 0;
      n->across.c[j][k] = p->patch->c[j][k] - u * e[k];
    }
  }
  proof_about(&n->proof, &n->across, 1, 0);
  n->proof.rounding = p->rounding;
  double floor_ = sqrt(p->target) + 2 * p->rounding;
  n->proof.target = floor_ * floor_;
  base_at(&n->across, closest->xi, &n->closest);
}

/* Is |u| too large throughout the cell? */
static int is_beyond(const proof *p, const narrow *n, const cell *c)
{
  double d[3], t1[3], t2[3], t11[3], t22[3], t12[3], w[2];
  const double (*a)[3] = n->along.c;
  reach(c, p->triangular, w);
  value(&n->along, c->centre, d);
  tangents(&n->along, c->centre, t1, t2);
  curves(&n->along, c->centre, t11, t22, t12);
  // -- All terms of u about the centre (eq:certified-beyond)
  double first = fabs(t1[0]) * w[0] + fabs(t2[0]) * w[1];
  double second = 0.5 * (fabs(t11[0]) * (w[0] * w[0]) + fabs(t22[0]) * (w[1] * w[1])) +
                  fabs(t12[0]) * (w[0] * w[1]);
  double third = (fabs(a[6][0]) * w[0] + fabs(a[7][0]) * w[1]) * (w[0] * w[1]);
  return fabs(d[0]) - (first + second + third) * (1 + 16 * DBL_EPSILON) >= sqrt(n->proof.target);
}

/* Is a cell of a long thin face proved? */
static int proven_narrow(const proof *p, const narrow *n, const cell *c)
{
  base b;
  if (is_beyond(p, n, c) || proven_from_closest(&n->proof, &n->closest, c)) return 1;
  base_at(&n->across, c->centre, &b);
  return proven_from_centre(&n->proof, &b, c);
}

ct_outcome ct_proof_search(const ct_patch *patch, double tolerance, int budget, double xi[2],
                           ct_closest *count)
{
  enum { DEPTH = 36, NARROW = 100 };
  cell stack[3 * DEPTH + 4];
  proof about, *p = &about;
  narrow thin;
  base at, b, *closest = &at;
  int size = 1, is_narrow = 0;
  base_at(patch, xi, closest);
  count->evaluations++;
  b = *closest;
  if (!proof_about(p, patch, tolerance, closest->distance)) return CT_GAVE_UP;
  if (!(p->target > 0)) return CT_PROVEN;
  stack[0] = whole_face(p->triangular);
  for (int cells = 0; size > 0; cells++) {
    cell c = stack[--size];
    slope sloping = OPEN;
    // -- A cell is done if the closest point or its own centre proves it (eq:certified-bound)
    if (proven_from_closest(p, closest, &c)) continue;
    if (cells > 0) {
      base_at(p->patch, c.centre, &b);
      count->evaluations++;
      if (b.f < p->target) {
        xi[0] = c.centre[0], xi[1] = c.centre[1];
        return CT_CLOSER;
      }
      if (proven_from_centre(p, &b, &c)) continue;
      sloping = slope_in_cell(p, &b, &c);
      if (sloping == EMPTY) continue;
    }
    // -- Many cells: look along and across the face as well (eq:certified-narrow)
    if (cells >= NARROW && !is_narrow) {
      narrow_about(p, closest, &thin);
      is_narrow = 1;
    }
    // A reduced cell is no longer the one about the base b, and is examined again.
    if (is_narrow &&
        ((sloping == OPEN && proven_by_series(p, &b, &c)) || proven_narrow(p, &thin, &c)))
      continue;
    if (cells >= budget || size + 4 > 3 * DEPTH + 4) return CT_GAVE_UP;
    if (sloping == REDUCED) stack[size++] = c;
    else size += divide(p->triangular, &c, stack + size);
  }
  return CT_PROVEN;
}
