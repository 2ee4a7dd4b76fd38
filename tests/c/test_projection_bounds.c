/* Each bound of the certificate by itself: compared with many samples of a piece of a face, none
 * may be too high, and on small pieces each must be close. */
#include "../../libcontact/src/projection/proof.c"

#include "faces.h"
#include "tap.h"

enum { SAMPLES = 17, CASES = 400 };

/* A random face with a point near it, a base on it, and a piece. */
typedef struct scene {
  ct_face face;
  ct_patch patch;
  double point[3];
  cell piece;
  base about;
  proof p;
} scene;

static void make(scene *s, ct_face_kind kind, double bend, double half)
{
  double xi[2];
  s->face = random_face(kind, bend);
  for (int k = 0; k < 3; k++) s->point[k] = uniform(1);
  ct_patch_init(&s->patch, kind, s->face.node, s->point);
  random_xi(kind, 0.3, xi);
  for (int a = 0; a < 2; a++) s->piece.centre[a] = xi[a], s->piece.half[a] = half;
  random_xi(kind, 0.1, xi);
  base_at(&s->patch, xi, &s->about);
  proof_about(&s->p, &s->patch, 1e-10, s->about.distance);
}

/* Sample i, j of a piece, its corners among them. */
static void sample_at(const cell *c, int triangular_, int i, int j, double xi[2])
{
  double x = 2.0 * i / (SAMPLES - 1) - 1, y = 2.0 * j / (SAMPLES - 1) - 1;
  if (triangular_) { // centroid, and a third of the legs
    double u = 0.5 * (x + 1), v = 0.5 * (y + 1) * (1 - u);
    x = 3 * u - 1, y = 3 * v - 1;
  }
  xi[0] = c->centre[0] + x * c->half[0], xi[1] = c->centre[1] + y * c->half[1];
}

static double lowest_in(const scene *s, const cell *c)
{
  double lowest = HUGE_VAL, xi[2], d[3];
  for (int i = 0; i < SAMPLES; i++)
    for (int j = 0; j < SAMPLES; j++) {
      sample_at(c, s->p.triangular, i, j, xi);
      lowest = fmin(lowest, value(&s->patch, xi, d));
    }
  return lowest;
}

/* The secant form is exact at the centre of a piece (eq:certified-secants, eq:certified-form) and
 * below f - f0 - g.s everywhere in it (eq:certified-spread). */
static void secants(ct_face_kind kind)
{
  double off = 0, above = 0;
  for (int trial = 0; trial < CASES; trial++) {
    scene s;
    form m;
    double d[3], xi[2];
    make(&s, kind, 0.3, 0.02);
    cell dot_ = {{s.piece.centre[0], s.piece.centre[1]}, {0, 0}};
    for (int wide = 0; wide < 2; wide++) {
      const cell *c = wide ? &s.piece : &dot_;
      secant_form(&s.p, &s.about, c, &m);
      for (int i = 0; i < (wide ? SAMPLES : 1); i += 4)
        for (int j = 0; j < (wide ? SAMPLES : 1); j += 4) {
          sample_at(c, s.p.triangular, i, j, xi);
          double x = xi[0] - s.about.xi[0], y = xi[1] - s.about.xi[1];
          double rest = value(&s.patch, xi, d) - s.about.f - (s.about.g[0] * x + s.about.g[1] * y);
          double squares = m.m11 * x * x + m.m22 * y * y;
          double low = squares + fmin(2 * m.low * x * y, 2 * m.high * x * y);
          if (!wide) off = worst(off, rest - low);
          above = fmax(above, low - rest);
        }
    }
  }
  tap_close(off, 0, 1e-11, "%s: the secant form is exact at the centre", FACE_NAME[kind]);
  tap_close(above, 0, 1e-12, "%s: and below f in the whole piece", FACE_NAME[kind]);
}

/* A form that is negative everywhere takes its lowest eigenvalue times the square of the half
 * diagonal from a piece (eq:certified-worst). */
static void negative_forms(void)
{
  int early = 0, late = 0;
  scene s;
  make(&s, CT_Q8, 0.2, 0.1);
  s.about.g[0] = s.about.g[1] = 0;
  for (int trial = 0; trial < CASES; trial++) {
    double a = -1.5 + uniform(0.5), b = -1.5 + uniform(0.5), t = uniform(0.9),
           lowest = 0.5 * (a + b) - hypot(0.5 * (a - b), t), room = -lowest * 2 * 0.1 * 0.1;
    const form m = {a, b, t, t};
    early += holds_in_cell(&s.p, &s.about, &s.piece, &m, room * (1 - 1e-9));
    late += !holds_in_cell(&s.p, &s.about, &s.piece, &m, room * (1 + 1e-9));
  }
  tap_ok(early == 0 && late == 0, "a negative form at its worst");
}

/* The secant form of a piece, its entries and their changes as they are written (eq:certified-form,
 * eq:certified-spread); and what a slope adds to it (eq:certified-slope). */
static void entries(void)
{
  double off = 0, slope = 0;
  for (int trial = 0; trial < CASES; trial++) {
    scene s;
    form m, with_slope = {0, 0, 0, 0};
    slack rest = {0, {0, 0}};
    const double E1[2] = {1, 0};
    make(&s, CT_Q8, 0.5, 0.1);
    const base *b = &s.about;
    const double *c6 = s.patch.c[6], *c7 = s.patch.c[7], *t11 = b->t11, *t12 = b->t12,
                 *t22 = b->t22;
    double x = s.piece.centre[0] - b->xi[0], y = s.piece.centre[1] - b->xi[1], w = 0.1, a1[3],
           a2[3];
    double v = fabs(x) * w + fabs(y) * w + w * w;
    for (int k = 0; k < 3; k++) {
      a1[k] = b->t1[k] + t11[k] * x / 2 + t12[k] * y / 2 + c6[k] * x * y;
      a2[k] = b->t2[k] + t22[k] * y / 2 + t12[k] * x / 2 + c7[k] * x * y;
    }
    double M11 = dot(a1, a1) + dot(b->d, t11) + 2 * dot(b->d, c6) * y,
           M22 = dot(a2, a2) + dot(b->d, t22) + 2 * dot(b->d, c7) * x;
    double D11 = fabs(dot(a1, t11)) * w + fabs(dot(a1, t12) + 2 * dot(b->d, c6)) * w +
                 2 * fabs(dot(a1, c6)) * v,
           D22 = fabs(dot(a2, t22)) * w + fabs(dot(a2, t12) + 2 * dot(b->d, c7)) * w +
                 2 * fabs(dot(a2, c7)) * v,
           D12 = fabs(dot(a1, t22) + dot(a2, t12)) * w / 2 +
                 fabs(dot(a1, t12) + dot(a2, t11)) * w / 2 + fabs(dot(a1, c7) + dot(a2, c6)) * v;
    secant_form(&s.p, b, &s.piece, &m);
    off = worst(worst(off, m.m11 - (M11 - D11)), m.m22 - (M22 - D22));
    off = worst(off, 0.5 * (m.high - m.low) - D12);
    if (x < w) continue;
    // l = 0.7 z_1 has at most 0.7 (x + w) there
    linear_share(&s.p, &s.piece, b, 0.7, E1, &with_slope, &rest);
    slope = worst(slope, with_slope.m11 * (x + w) / 0.7 - 1);
  }
  tap_close(off, 0, 1e-11, "entries of the secant form");
  tap_close(slope, 0, 1e-12, "a slope is a parabola");
}

/* Positive forms (eq:certified-positive) and the lowest value of a parabola (eq:certified-parabola,
 * and so eq:certified-rest) against closed forms; a form turned to its axes (eq:certified-turned)
 * within a box (eq:certified-valley) against samples. */
static void forms(void)
{
  int positive = 1, parabola = 1, sound = 1, near = 1, lowest = 1, valleys_ = 0;
  for (int trial = 0; trial < 4000; trial++) {
    double a = uniform(2), b = uniform(2), t = uniform(1), g[2] = {uniform(1), uniform(1)};
    form m = {a, b, t, t};
    double twist = fabs(t), lower = 0.5 * (a + b) - hypot(0.5 * (a - b), t);
    if (fabs(lower) > 1e-6) positive &= is_positive(&m, twist) == (lower > 0);
    if (lower > 1e-3) {
      double plus = (b * g[0] * g[0] - 2 * t * g[0] * g[1] + a * g[1] * g[1]) / (a * b - t * t),
             minus = (b * g[0] * g[0] + 2 * t * g[0] * g[1] + a * g[1] * g[1]) / (a * b - t * t),
             drop = 0.25 * fmax(plus, minus);
      parabola &= holds_parabola(&m, twist, g, 1.001 * drop) == 1;
      parabola &= holds_parabola(&m, twist, g, 0.999 * drop) == 0;
      // In a wide piece a known form falls to its lowest point.
      const double wide[2] = {1e3, 1e3};
      lowest &= holds_in_valley(&m, g, wide, 0.25 * plus * (1 + 1e-5));
      lowest &= !holds_in_valley(&m, g, wide, 0.25 * plus * (1 - 1e-5));
    }
    double w[2] = {0.3, 0.2}, low = 0;
    for (int i = 0; i <= 60; i++)
      for (int j = 0; j <= 60; j++) {
        double x = w[0] * (i / 30.0 - 1), y = w[1] * (j / 30.0 - 1);
        low = fmin(low, g[0] * x + g[1] * y + a * x * x + b * y * y + 2 * t * x * y);
      }
    sound &= !holds_in_valley(&m, g, w, -0.999 * low);
    // A valley along an axis: the bound is the lowest value itself.
    form v = {2, fabs(b) - 0.5, 0, 0};
    double slope[2] = {g[0], g[1]}, far = w[1],
           floor_ = v.m22 > 0 && fabs(g[1]) <= 2 * v.m22 * far
                        ? 0.25 * g[1] * g[1] / v.m22
                        : fmax(far * (fabs(g[1]) - v.m22 * far), 0);
    double exact = 0.25 * g[0] * g[0] / 2 + floor_;
    if (v.m22 > 2) continue;
    near &= holds_in_valley(&v, slope, w, 1.001 * exact) == 1;
    near &= holds_in_valley(&v, slope, w, 0.999 * exact) == 0;
    valleys_++;
  }
  tap_ok(positive, "a form is positive where its lower eigenvalue is");
  tap_ok(lowest, "the lowest value of a form in its axes");
  tap_ok(parabola, "the lowest value of a parabola is that of the closed form");
  tap_ok(sound, "no bound in a valley is above the samples");
  tap_ok(near && valleys_ > 1000, "along the axes it is the lowest value (%d valleys)", valleys_);
}

typedef int prover(const proof *p, const base *b, const cell *c);

static int by_closest(const proof *p, const base *b, const cell *c)
{
  return proven_from_closest(p, b, c) != 0;
}

/* From the closest point (eq:certified-shares), from the centre of a piece
 * (eq:certified-worst) and by all terms of f (eq:certified-series, eq:certified-series-bound): no
 * proof of what samples refute; and on small pieces about a closest point, or about any centre, the
 * bound is near. */
static void provers(ct_face_kind kind)
{
  static prover *const WAY[3] = {by_closest, proven_from_centre, proven_by_series};
  static const char *const NAME[3] = {"from the closest point", "from the centre", "by the series"};
  for (int way = 0; way < 3; way++) {
    int lies = 0, missed = 0, proven = 0, tried = 0;
    for (int trial = 0; trial < CASES; trial++) {
      scene s;
      double half = ldexp(1, -(trial % 6));
      if (triangular(kind)) half /= 3;
      make(&s, kind, triangular(kind) ? 0.05 : 0.15, half);
      ct_projection out;
      ct_project_options options = ct_project_options_default();
      options.method = CT_CERTIFIED;
      ct_project(&s.face, s.point, &options, &out, NULL);
      if (out.status != CT_OK) continue;
      if (trial % 6 == 0 && way < 2)
        for (int a = 0; a < 2; a++) s.piece.centre[a] = triangular(kind) ? 1.0 / 3 : 0;
      if (way == 0) base_at(&s.patch, out.xi, &s.about);
      else base_at(&s.patch, s.piece.centre, &s.about);
      double lowest = lowest_in(&s, &s.piece);
      s.p.target = lowest * (1 + 1e-9) + 1e-9;
      lies += WAY[way](&s.p, &s.about, &s.piece);
      s.p.target = 0.5 * lowest;
      proven += WAY[way](&s.p, &s.about, &s.piece);
      // -- A small piece: from the closest point nearly all of f can be shown
      double step = 1e-3, gap = 2 * (fabs(s.about.g[0]) + fabs(s.about.g[1])) * step * step;
      cell small = {{s.about.xi[0], s.about.xi[1]}, {step, step}};
      gap += way == 0 ? 1e-12 : 40 * step * step;
      lowest = lowest_in(&s, &small);
      if (way == 0) { // on the face, with the closest point in it, perhaps on its edge
        if (triangular(kind) && out.where == CT_VERTEX) continue;
        if (triangular(kind) && out.where == CT_EDGE)
          for (int a = 0; a < 2; a++) {
            static const double INWARDS[3][2] = {{0, 1}, {-0.5, -0.5}, {1, 0}};
            small.centre[a] += step * INWARDS[out.index][a];
          }
        lowest = s.about.f;
        for (int a = 0; a < 2 && !triangular(kind); a++)
          small.centre[a] = fmin(fmax(small.centre[a], step - 1), 1 - step);
      }
      s.p.target = lowest - gap;
      tried++;
      missed += !WAY[way](&s.p, &s.about, &small);
    }
    tap_ok(lies == 0 && proven > 0, "%s, %s: %d bounds, none above the samples", FACE_NAME[kind],
           NAME[way], proven);
    tap_ok(missed <= tried / 50, "%s, %s: close on small pieces (%d of %d not)", FACE_NAME[kind],
           NAME[way], missed, tried);
  }
}

/* Corners from which f increases into the face, seldom the closest points: the slope
 * (eq:certified-slope) must not prove more than samples show, on pieces of all sizes. */
static void corners_with_a_slope(void)
{
  int lies = 0, lower = 0, proven = 0;
  for (int trial = 0; trial < 20000; trial++) {
    scene s;
    make(&s, CT_Q8, trial % 5 ? 0.6 : 0.2, ldexp(1, -(trial % 3)));
    for (int k = 0; k < 3; k++) s.point[k] *= 2;
    ct_patch_init(&s.patch, CT_Q8, s.face.node, s.point);
    proof_about(&s.p, &s.patch, 1e-10, 1);
    double xi[2] = {trial % 8 < 4 ? -1 : 1, trial % 2 ? -1 : 1};
    if (trial % 3 == 0) s.piece.centre[0] = s.piece.centre[1] = 0;
    base_at(&s.patch, xi, &s.about);
    if (s.about.g[0] * xi[0] > 0 || s.about.g[1] * xi[1] > 0) continue;
    double lowest = lowest_in(&s, &s.piece);
    s.p.target = s.about.f - 1e-6;
    lower += lowest < s.p.target;
    int claimed = proven_from_closest(&s.p, &s.about, &s.piece) != 0;
    proven += claimed;
    lies += claimed && lowest < s.p.target;
  }
  tap_ok(lies == 0 && lower > 100 && proven > 100,
         "from corners %d pieces are proved, none of the %d with a closer point", proven, lower);
}

/* Bounds of the derivatives over the face (eq:certified-derivatives): samples never exceed them,
 * and on faces with one coefficient alone they reach those of the tangents. */
static void derivative_bounds(void)
{
  int above = 0;
  double off = 0, target = 0;
  for (int trial = 0; trial < 107; trial++) {
    scene s;
    make(&s, CT_Q8, 0.4, 0.1);
    if (trial < 7)
      for (int j = 0; j < 8; j++)
        for (int k = 0; k < 3; k++) s.patch.c[j][k] = j == trial + 1 && k == 0;
    proof_about(&s.p, &s.patch, 1e-10, 1);
    double most_[2] = {0, 0};
    for (int i = 0; i < SAMPLES; i++)
      for (int j = 0; j < SAMPLES; j++) {
        double xi[2] = {2.0 * i / (SAMPLES - 1) - 1, 2.0 * j / (SAMPLES - 1) - 1};
        base b;
        base_at(&s.patch, xi, &b);
        most_[0] = fmax(most_[0], sqrt(dot(b.t1, b.t1)));
        most_[1] = fmax(most_[1], sqrt(dot(b.t2, b.t2)));
        above += sqrt(dot(b.t11, b.t11)) > s.p.curve[0] * (1 + 1e-12);
        above += sqrt(dot(b.t22, b.t22)) > s.p.curve[1] * (1 + 1e-12);
        above += sqrt(dot(b.t12, b.t12)) > s.p.curve[2] * (1 + 1e-12);
      }
    // d* - ½ τ max(d*, L) + 2 δ for τ = 1e-7 (eq:certified-target)
    double size = s.patch.size, far = trial % 2 ? 0.5 * size : 2 * size;
    proof_about(&s.p, &s.patch, 1e-7, far);
    double room = (far - sqrt(s.p.target) + 2 * s.p.rounding) / fmax(far, size);
    target = worst(target, room / 0.5e-7 - 1);
    for (int a = 0; a < 2; a++) {
      above += most_[a] > s.p.tangent[a] * (1 + 1e-12);
      if (trial < 7) off = worst(off, most_[a] - s.p.tangent[a]);
    }
  }
  tap_ok(above == 0, "no derivative exceeds its bound");
  tap_close(off, 0, 1e-15, "bounds of tangents are reached");
  tap_close(target, 0, 1e-6, "and the target is by half the tolerance nearer");
}

/* Where slopes empty a piece (eq:certified-third, eq:certified-slopes), a
 * component of the gradient has one sign at all samples; and they empty every small piece with a
 * slope. */
static void slopes(ct_face_kind kind)
{
  int lies = 0, emptied = 0, missed = 0;
  for (int trial = 0; trial < 16 * CASES; trial++) {
    scene s;
    make(&s, kind, trial % 2 ? 0.2 : 0.7, 0.3 * ldexp(1, -(trial % 6)));
    base_at(&s.patch, s.piece.centre, &s.about);
    cell c = s.piece;
    if (slope_in_cell(&s.p, &s.about, &c) == EMPTY) {
      int same[2] = {1, 1};
      emptied++;
      for (int i = 0; i < SAMPLES; i++)
        for (int j = 0; j < SAMPLES; j++) {
          double xi[2], g[2];
          sample_at(&s.piece, s.p.triangular, i, j, xi);
          function_at(&s.face, s.point, xi, NULL, g, NULL);
          for (int a = 0; a < 2; a++) same[a] &= g[a] * s.about.g[a] > 0;
        }
      lies += !same[0] && !same[1];
    }
    c = s.piece;
    c.half[0] = c.half[1] = 1e-4;
    if (fmax(fabs(s.about.g[0]), fabs(s.about.g[1])) > 0.02)
      missed += slope_in_cell(&s.p, &s.about, &c) != EMPTY;
  }
  tap_ok(lies == 0 && emptied > CASES, "%s: %d pieces emptied by slopes, none wrongly",
         FACE_NAME[kind], emptied);
  tap_ok(missed == 0, "%s: no small piece with a slope is left", FACE_NAME[kind]);
}

/* The target that all terms of f about the centre of a piece just prove, from products of the terms
 * of d (eq:certified-series, eq:certified-series-bound). */
static void series(void)
{
  int unlike = 0, compared = 0;
  for (int trial = 0; trial < CASES; trial++) {
    scene s;
    make(&s, CT_Q8, 0.7, 0.4);
    base_at(&s.patch, s.piece.centre, &s.about);
    const base *b = &s.about;
    const double *term[3][3] = {{b->d, b->t2, b->t22},
                                {b->t1, b->t12, s.patch.c[7]},
                                {b->t11, s.patch.c[6], NULL}},
                 share[3] = {1, 1, 0.5};
    double F[5][5] = {{0}}, loss = 0, low = 0, high = 100;
    for (int i = 0; i < 81; i++) {
      int a = i % 3, c = i / 3 % 3, k = i / 9 % 3, d = i / 27;
      if (a + c > 3 || k + d > 3 || term[a][c] == NULL || term[k][d] == NULL) continue;
      double own = (c == 0 ? share[a] : 1) * (a == 0 ? share[c] : 1),
             other = (d == 0 ? share[k] : 1) * (k == 0 ? share[d] : 1);
      F[a + k][c + d] += own * other * dot(term[a][c], term[k][d]);
    }
    for (int i = 0; i < 25; i++) {
      double x = F[i / 5][i % 5], size = pow(0.4, i / 5 + i % 5);
      if (i / 5 + i % 5 > 2) loss += (i / 5 % 2 + i % 5 % 2 > 0 ? fabs(x) : x < 0 ? -x : 0) * size;
    }
    form m = {F[2][0], F[0][2], 0.5 * F[1][1], 0.5 * F[1][1]};
    for (int i = 0; i < 60; i++) {
      double middle = 0.5 * (low + high);
      if (holds_in_cell(&s.p, b, &s.piece, &m, middle)) high = middle;
      else low = middle;
    }
    if (high < 1e-3) continue;
    for (int more = 0; more < 2; more++) {
      s.p.target = b->f - loss - high * (more ? 1 + 1e-6 : 1 - 1e-6);
      unlike += proven_by_series(&s.p, b, &s.piece) != more;
    }
    compared++;
  }
  tap_ok(unlike == 0 && compared > CASES / 2, "all terms of f prove what their products say: %d",
         compared);
}

/* The slope at the centre that just empties a small piece, from the sums of the equations
 * (eq:certified-third, eq:certified-slopes, eq:certified-derivatives). */
static void least_slopes(ct_face_kind kind)
{
  int early = 0, late = 0;
  for (int trial = 0; trial < CASES; trial++) {
    scene s;
    make(&s, kind, 0.7, 0.02);
    base_at(&s.patch, s.piece.centre, &s.about);
    double n[8], H[3], w = s.p.triangular ? 0.04 : 0.02, D = s.about.distance;
    for (int j = 0; j < 8; j++)
      n[j] = fabs(s.patch.c[j][0]) + fabs(s.patch.c[j][1]) + fabs(s.patch.c[j][2]);
    function_at(&s.face, s.point, s.piece.centre, NULL, NULL, H);
    double t1 = n[1] + n[3] + 2 * (n[4] + n[6]) + n[7], t2 = n[2] + n[3] + 2 * (n[5] + n[7]) + n[6];
    double C11 = 2 * n[4] + 6 * n[6], C22 = 2 * n[5] + 6 * n[7], C12 = n[3] + 2 * (n[6] + n[7]);
    D += t1 * w + t2 * w;
    double f112 = 4 * t1 * C12 + 2 * t2 * C11 + 2 * D * 2 * n[6],
           f122 = 4 * t2 * C12 + 2 * t1 * C22 + 2 * D * 2 * n[7];
    double least[2] = {(fabs(H[0]) + fabs(H[2])) * w + (3 * t1 * C11 + f112 + 0.5 * f122) * w * w,
                       (fabs(H[2]) + fabs(H[1])) * w + (0.5 * f112 + f122 + 3 * t2 * C22) * w * w};
    for (int a = 0; a < 2; a++) {
      cell c = s.piece, d = s.piece;
      s.about.g[1 - a] = 0;
      s.about.g[a] = least[a] * (1 - 1e-9);
      early += slope_in_cell(&s.p, &s.about, &c) != OPEN;
      s.about.g[a] = least[a] * (1 + 1e-9);
      late += slope_in_cell(&s.p, &s.about, &d) == OPEN;
    }
  }
  tap_ok(early == 0 && late == 0, "%s: a piece is emptied from the least slope on",
         FACE_NAME[kind]);
}

/* Lower bound of |u| in a piece (eq:certified-beyond), its terms from u at nine points, which are
 * differences without an error as u is of second order in each coordinate. */
static double least_along(const narrow *n, const cell *c)
{
  double u[3][3], d[3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double xi[2] = {c->centre[0] + (i - 1) * c->half[0], c->centre[1] + (j - 1) * c->half[1]};
      value(&n->along, xi, d);
      u[i][j] = d[0];
    }
  double u1 = (u[2][1] - u[0][1]) / 2, u2 = (u[1][2] - u[1][0]) / 2;
  double u11 = (u[2][1] + u[0][1]) / 2 - u[1][1], u22 = (u[1][2] + u[1][0]) / 2 - u[1][1];
  double u12 = (u[2][2] - u[2][0] - u[0][2] + u[0][0]) / 4;
  double u112 = (u[2][2] + u[0][2] - u[2][0] - u[0][0]) / 4 - u2,
         u122 = (u[2][2] + u[2][0] - u[0][2] - u[0][0]) / 4 - u1;
  return fabs(u[1][1]) - (fabs(u1) + fabs(u2) + fabs(u11) + fabs(u22) + fabs(u12)) - fabs(u112) -
         fabs(u122);
}

/* Parts along and across a face add up to f (eq:certified-narrow); a piece that is beyond
 * (eq:certified-beyond) has no sample that is not, and small pieces are settled. */
static void narrow_faces(void)
{
  double off = 0;
  int lies = 0, beyond = 0, missed = 0, unlike = 0;
  for (int trial = 0; trial < CASES; trial++) {
    scene s;
    narrow n;
    make(&s, CT_Q8, 0.2, 0.2 * ldexp(1, -(trial % 5)));
    narrow_about(&s.p, &s.about, &n);
    double lowest = HUGE_VAL, middle = 0;
    for (int i = 0; i < SAMPLES; i++)
      for (int j = 0; j < SAMPLES; j++) {
        double xi[2], d[3], u[3], v[3];
        sample_at(&s.piece, 0, i, j, xi);
        double f = value(&s.patch, xi, d);
        off = worst(off, value(&n.along, xi, u) + value(&n.across, xi, v) - f);
        lowest = fmin(lowest, fabs(u[0]));
        if (i == SAMPLES / 2 && j == SAMPLES / 2) middle = fabs(u[0]);
      }
    n.proof.target = lowest * lowest * (1 + 1e-9) + 1e-12;
    lies += is_beyond(&s.p, &n, &s.piece);
    n.proof.target = 0.25 * lowest * lowest;
    beyond += is_beyond(&s.p, &n, &s.piece);
    double least = least_along(&n, &s.piece);
    for (int more = 0; more < 2 && least > 1e-3; more++) {
      n.proof.target = least * least * (more ? 1 + 1e-9 : 1 - 1e-9);
      unlike += is_beyond(&s.p, &n, &s.piece) != !more;
    }
    cell small = {{s.piece.centre[0], s.piece.centre[1]}, {1e-4, 1e-4}};
    n.proof.target = pow(fmax(middle - 1e-3, 0), 2);
    missed += middle > 1e-3 && !is_beyond(&s.p, &n, &small);
  }
  tap_close(off, 0, 1e-13, "the parts along and across add up to f");
  tap_ok(lies == 0 && beyond > CASES / 8, "%d pieces beyond, none wrongly", beyond);
  tap_ok(missed == 0, "small pieces are settled");
  tap_ok(unlike == 0, "and all from the bound of |u| on");
}

/* Curvatures across and along (eq:valley-curvatures); and the descent in a bent valley
 * (eq:valley-along, eq:valley-across) that is a thousand times steeper across. */
static void down_a_valley(void)
{
  double off = 0;
  for (int trial = 0; trial < 1000; trial++) {
    double H[3] = {uniform(1), uniform(1), uniform(1)}, q[2], k[2];
    ct_principal(H, q, k);
    off = worst(off, hypot(q[0], q[1]) - 1);
    off = worst(off, H[0] * q[0] + H[2] * q[1] - k[0] * q[0]);
    off = worst(off, H[2] * q[0] + H[1] * q[1] - k[0] * q[1]);
    off = worst(off, k[0] + k[1] - H[0] - H[1]);
  }
  tap_close(off, 0, 1e-12, "the direction across is an eigenvector");
  ct_face face = parabolic_face(CT_Q8, 0, 0);
  for (int i = 0; i < 8; i++)
    face.node[i][1] = 0.03 * face.node[i][1] + 0.02 * face.node[i][0] * face.node[i][0];
  double point[3] = {0.7, 0.02 * 0.49 + 0.03 * 0.2, 1e-3}, xi[2] = {-0.8, 0.1}, d[3];
  ct_patch patch;
  ct_closest count = {.evaluations = 0};
  ct_patch_init(&patch, CT_Q8, face.node, point);
  tap_ok(ct_follow_valley(&patch, xi, &count) == 1, "the descent in a valley");
  tap_close(fmax(fabs(xi[0] - 0.7), fabs(xi[1] - 0.2)), 0, 1e-6, "ends at its lowest point");
  tap_close(sqrt(value(&patch, xi, d)), 1e-3, 1e-9, "where the distance is the gap");
  tap_ok(count.evaluations < 30, "in %d evaluations", count.evaluations);
}

int main(void)
{
  static const ct_face_kind KIND[3] = {CT_Q4, CT_Q8, CT_T6};
  for (int k = 0; k < 3; k++) {
    secants(KIND[k]);
    provers(KIND[k]);
    slopes(KIND[k]);
    least_slopes(KIND[k]);
  }
  negative_forms();
  entries();
  series();
  derivative_bounds();
  corners_with_a_slope();
  forms();
  narrow_faces();
  down_a_valley();
  return tap_done();
}
