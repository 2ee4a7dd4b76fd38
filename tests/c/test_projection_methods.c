/* Each method on ordinary faces with a closed form, its order of convergence compared with theory,
 * its status, its budget. */
#include "faces.h"
#include "tap.h"

static int by_values(int m) { return m == CT_SIMPLEX || m == CT_NELDER_MEAD; }

static ct_project_options with(int method)
{
  ct_project_options options = ct_project_options_default();
  options.method = (ct_method)method;
  return options;
}

/* On z = (p x^2 + q y^2) / 2 the point at height g along the normal has its closest point below,
 * where f is convex (eq:projection-convex). */
static void paraboloid(ct_face_kind kind, double p, double q, const char *what)
{
  for (int m = 0; m < method_count(); m++) {
    double error = 0, gap = 0, normal = 0;
    int status = 1, exact = m == CT_ROBUST || m == CT_NEWTON;
    for (int trial = 0; trial < 200; trial++) {
      ct_face face = parabolic_face(kind, p, q);
      double xi[2], point[3], n[3], g = uniform(0.3);
      random_xi(kind, 0.02, xi);
      parabolic_point(p, q, xi, g, point, n);
      ct_project_options options = with(m);
      ct_projection out;
      ct_project(&face, point, &options, &out, NULL);
      status &= out.status == CT_OK || (by_values(m) && out.status == CT_ITERATION_LIMIT);
      status &= out.certified == (m == CT_CERTIFIED) && out.evaluations > 0;
      status &= out.where == CT_INTERIOR && out.index == -1;
      for (int k = 0; k < 3; k++) normal = worst(normal, out.normal[k] - n[k]);
      for (int a = 0; a < 2; a++) error = worst(error, out.xi[a] - xi[a]);
      gap = worst(worst(gap, out.signed_distance - g), out.distance - fabs(g));
    }
    tap_ok(status, "%s on a %s: %s succeeds", FACE_NAME[kind], what, METHOD_NAME[m]);
    tap_close(error, 0,
              by_values(m) ? 5e-8
              : exact      ? 1e-14
                           : 1e-10,
              "%s on a %s: %s finds the closest point", FACE_NAME[kind], what, METHOD_NAME[m]);
    tap_close(gap, 0, exact ? 1e-15 : 1e-14, "%s on a %s: %s gives the gap with its sign",
              FACE_NAME[kind], what, METHOD_NAME[m]);
    tap_close(normal, 0,
              by_values(m) ? 1e-7
              : exact      ? 1e-14
                           : 1e-10,
              "%s on a %s: %s gives the unit normal there", FACE_NAME[kind], what, METHOD_NAME[m]);
  }
}

/* The path of a method, as the trace shows it. */
typedef struct path {
  double xi[300][2], f[300];
  int count;
} path;

static void record(const double xi[2], double f, void *user)
{
  path *p = (path *)user;
  if (p->count >= 300) return;
  p->xi[p->count][0] = xi[0], p->xi[p->count][1] = xi[1], p->f[p->count++] = f;
}

static path walk(int method, const ct_face *face, const double point[3], const double start[2],
                 ct_projection *out)
{
  path p = {{{0}}, {0}, 0};
  ct_project_options options = with(method);
  options.trace = record, options.user = &p, options.use_start = 1, options.start[0] = start[0],
  options.start[1] = start[1];
  ct_project(face, point, &options, out, NULL);
  return p;
}

static double off(const path *p, int i) { return fmax(fabs(p->xi[i][0]), fabs(p->xi[i][1])); }

/* Orders of convergence: least squares (eq:projection-gauss-newton), sphere (eq:sphere-curvature,
 * eq:sphere-closest), torus (eq:torus-turn, eq:torus-closest), Newton (eq:projection-newton).
 * At the top of z = (p x^2 + q y^2) / 2 the curvatures are p and q, and a point at height g is
 * projected there. To first order least squares leaves g times the curvature of each error; the
 * sphere k = curvature in the direction of the point leaves an error too unless p = q; Newton and
 * the torus have an error of second order. */
static void orders(void)
{
  double g = 0.4, point[3] = {0, 0, 0.4}, start[2] = {0.2, 0}, diagonal[2] = {0.15, 0.1};
  ct_projection out;
  ct_face cylinder = parabolic_face(CT_Q8, 0.8, 0), cup = parabolic_face(CT_Q8, 0.7, 0.7),
          saddle = parabolic_face(CT_Q8, 0.9, -0.6);
  path p = walk(CT_LEAST_SQUARES, &cylinder, point, start, &out);
  tap_close(p.xi[6][0] / p.xi[5][0], g * 0.8, 1e-6,
            "least squares leaves the gap times the curvature of each error");
  p = walk(CT_SPHERE, &cup, point, diagonal, &out);
  tap_ok(p.count < 8 && off(&p, 2) < 4 * off(&p, 1) * off(&p, 1),
         "the sphere is of second order on a cup (%d iterates)", p.count);
  p = walk(CT_SPHERE, &saddle, point, diagonal, &out);
  tap_ok(p.count > 10 && off(&p, 6) > 0.02 * off(&p, 5),
         "but of first order on a saddle (%d iterates)", p.count);
  p = walk(CT_TORUS, &saddle, point, diagonal, &out);
  tap_ok(p.count < 8 && off(&p, 2) < 4 * off(&p, 1) * off(&p, 1),
         "the torus is of second order on a saddle (%d iterates)", p.count);
  p = walk(CT_NEWTON, &saddle, point, diagonal, &out);
  tap_ok(p.count < 8 && off(&p, 2) < 4 * off(&p, 1) * off(&p, 1), "as is newton (%d iterates)",
         p.count);
  p = walk(CT_BROYDEN, &saddle, point, diagonal, &out);
  tap_ok(p.count < 14 && out.status == CT_OK, "broyden needs only one Hessian (%d iterates)",
         p.count);
  p = walk(CT_BFGS, &saddle, point, diagonal, &out);
  tap_ok(p.count < 16 && out.status == CT_OK, "bfgs needs none (%d iterates)", p.count);
  int falls = 1;
  for (int i = 1; i < p.count; i++) falls &= p.f[i] <= p.f[i - 1] * (1 + 1e-15);
  tap_ok(falls, "bfgs goes downhill only");
}

/* On a plane f is a parabola with round contours if the tangents are orthogonal and as long: then
 * each of these needs one step. */
static void one_step(void)
{
  ct_face flat = parabolic_face(CT_T3, 0, 0);
  double point[3] = {0.4, 0.25, 0.5};
  static const int METHOD[6] = {CT_NEWTON, CT_LEAST_SQUARES, CT_SPHERE,
                                CT_TORUS,  CT_BROYDEN,       CT_STEEPEST_DESCENT};
  for (int i = 0; i < 6; i++) {
    ct_project_options options = with(METHOD[i]);
    options.iteration_limit = 1;
    ct_projection out;
    ct_project(&flat, point, &options, &out, NULL);
    tap_close(fmax(fabs(out.xi[0] - 0.4), fabs(out.xi[1] - 0.25)), 0, 1e-15,
              "T3: %s needs one step", METHOD_NAME[METHOD[i]]);
  }
}

/* Frame, curvatures and step back of a local shape (eq:projection-frame, eq:projection-curvatures,
 * eq:projection-pull-back), and principal curvatures (eq:torus-principal). A sheared net on a
 * saddle, z = r x y: the principal directions are the diagonals and the tangents are not
 * orthogonal. */
static void sheared_and_twisted(void)
{
  ct_face face = parabolic_face(CT_Q8, 0, 0);
  double point[3] = {0, 0, 0.4}, start[2] = {0.1, 0.15}, diagonal[2] = {0.09, 0.15};
  for (int i = 0; i < 8; i++) {
    face.node[i][0] += 0.4 * face.node[i][1];
    face.node[i][2] = 0.8 * face.node[i][0] * face.node[i][1];
  }
  ct_projection out;
  path p = walk(CT_SPHERE, &face, point, diagonal, &out);
  tap_ok(p.count < 8 && off(&p, 2) < 4 * off(&p, 1) * off(&p, 1),
         "the sphere is of second order along a principal direction (%d iterates)", p.count);
  for (int i = 0; i < 8; i++) face.node[i][2] += 0.3 * face.node[i][0] * face.node[i][0];
  p = walk(CT_TORUS, &face, point, start, &out);
  tap_ok(p.count < 8 && off(&p, 2) < 4 * off(&p, 1) * off(&p, 1),
         "the torus in any direction (%d iterates)", p.count);
}

/* Along the axis of symmetry of a cylinder Broyden's method (eq:broyden-step, eq:broyden-update) is
 * the secant rule. */
static void broyden_is_the_secant_rule(void)
{
  ct_face cylinder = parabolic_face(CT_Q8, 0.8, 0);
  double point[3] = {0.1, 0, 0.6}, start[2] = {0.7, 0}, g[2][2], off_rule = 0;
  ct_projection out;
  path p = walk(CT_BROYDEN, &cylinder, point, start, &out);
  for (int i = 1; i < 4; i++) {
    for (int j = 0; j < 2; j++) function_at(&cylinder, point, p.xi[i - 1 + j], NULL, g[j], NULL);
    double next = p.xi[i][0] - g[1][0] * (p.xi[i][0] - p.xi[i - 1][0]) / (g[1][0] - g[0][0]);
    off_rule = worst(off_rule, p.xi[i + 1][0] - next);
  }
  tap_close(off_rule, 0, 1e-12, "broyden in one dimension is the secant rule");
}

/* Rosenbrock-like valleys want the expansion and the contraction; a quadratic function of two
 * variables is no trouble for either simplex. */
static void nelder_mead_changes_its_form(void)
{
  ct_face narrow = parabolic_face(CT_Q8, 0, 0);
  for (int i = 0; i < 8; i++)
    narrow.node[i][1] = 0.02 * narrow.node[i][1] + 0.3 * narrow.node[i][0] * narrow.node[i][0];
  double xi[2] = {0.8, -0.3}, point[3] = {0.8, 0.02 * -0.3 + 0.3 * 0.64, 1e-5};
  ct_projection regular, changing;
  ct_project_options options = with(CT_NELDER_MEAD);
  ct_project(&narrow, point, &options, &changing, NULL);
  options = with(CT_SIMPLEX);
  ct_project(&narrow, point, &options, &regular, NULL);
  double e = fmax(fabs(changing.xi[0] - xi[0]), fabs(changing.xi[1] - xi[1]));
  tap_close(e, 0, 1e-8, "nelder_mead walks along a narrow bent valley (%d evaluations)",
            changing.evaluations);
  tap_ok(fabs(regular.xi[0] - xi[0]) > 1e-3, "the regular simplex is halved to nothing there");
}

/* f of the shape functions. */
static double value_at(const ct_face *face, const double point[3], const double xi[2])
{
  double y[3], f = 0;
  ct_segment_point(face, xi, y);
  for (int k = 0; k < 3; k++) f += (y[k] - point[k]) * (y[k] - point[k]);
  return f;
}

/* One iteration of Nelder and Mead on sorted vertices x with values f, from the equations of the
 * chapter: the line (eq:nelder-line), reflection (eq:nelder-reflection), expansion
 * (eq:nelder-expansion), contraction (eq:nelder-contraction), shrinking (eq:nelder-shrink). Returns
 * whether it shrinks. */
static int nelder_mead_iteration(const ct_face *face, const double point[3], double x[3][2],
                                 double f[3])
{
  static const double LAMBDA[3] = {-1, -2, 0.5};
  double trial[3][2], v[3];
  int keep = -1;
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < 2; a++)
      trial[i][a] = 0.5 * (x[0][a] + x[1][a]) * (1 - LAMBDA[i]) + LAMBDA[i] * x[2][a];
    v[i] = value_at(face, point, trial[i]);
  }
  if (v[0] < f[0]) keep = v[1] < f[0] ? 1 : 0;
  else if (v[0] <= f[1]) keep = 0;
  else {
    if (v[0] < f[2]) { // the image is the third vertex: the contraction starts from it
      f[2] = v[0];
      for (int a = 0; a < 2; a++) x[2][a] = trial[0][a];
      for (int a = 0; a < 2; a++) trial[2][a] = 0.25 * (x[0][a] + x[1][a]) + 0.5 * x[2][a];
      v[2] = value_at(face, point, trial[2]);
    }
    if (v[2] <= f[2]) keep = 2;
  }
  for (int i = 0; i < 3; i++)
    for (int a = 0; a < 2; a++) {
      if (keep < 0) x[i][a] = 0.5 * (x[i][a] + x[0][a]);
      else if (i == 2) x[i][a] = trial[keep][a];
    }
  for (int i = 0; i < 3; i++) f[i] = value_at(face, point, x[i]);
  return keep < 0;
}

static void sort_vertices(double x[3][2], double f[3])
{
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < 2; i++)
      if (f[i + 1] < f[i]) {
        double t = f[i];
        f[i] = f[i + 1], f[i + 1] = t;
        for (int a = 0; a < 2; a++) t = x[i][a], x[i][a] = x[i + 1][a], x[i + 1][a] = t;
      }
}

static void nelder_mead_against_the_equations(void)
{
  double off = 0;
  int shrunk = 0;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = parabolic_face(CT_Q8, uniform(4), uniform(4));
    double point[3] = {uniform(1), uniform(1), uniform(3)}, start[2] = {uniform(0.5), uniform(0.5)},
           f[3];
    double x[3][2] = {{-0.5, -sqrt(3) / 6}, {0.5, -sqrt(3) / 6}, {0, sqrt(3) / 3}};
    for (int i = 0; i < 3; i++) {
      for (int a = 0; a < 2; a++) x[i][a] += start[a];
      f[i] = value_at(&face, point, x[i]);
    }
    ct_projection out;
    path p = walk(CT_NELDER_MEAD, &face, point, start, &out);
    for (int n = 0; n < 14 && n < p.count; n++) {
      sort_vertices(x, f);
      for (int a = 0; a < 2; a++) off = worst(off, p.xi[n][a] - x[0][a]);
      shrunk += nelder_mead_iteration(&face, point, x, f);
    }
  }
  tap_close(off, 0, 1e-12, "nelder_mead: 14 iterations as the equations say");
  tap_ok(shrunk > 0, "%d of them shrink", shrunk);
}

/* End of a line search along s (eq:projection-armijo, eq:projection-parabola). Returns the number
 * of trials. */
static int searched(const ct_face *face, const double point[3], const double xi[2],
                    const double g[2], const double s[2], double next[2])
{
  double part = 1, slope = g[0] * s[0] + g[1] * s[1], f0 = value_at(face, point, xi);
  for (int trial = 1;; trial++) {
    for (int a = 0; a < 2; a++) next[a] = xi[a] + part * s[a];
    double rise = value_at(face, point, next) - f0;
    if (rise <= 1e-4 * part * slope || trial == 40) return trial;
    part *= fmin(0.5, fmax(0.1, -0.5 * part * slope / (rise - part * slope)));
  }
}

/* Steepest descent (eq:steepest-length) and BFGS (eq:bfgs-step, eq:bfgs-update, eq:bfgs-scale) with
 * their line search, from the equations of the chapter: matrices in full. */
static void line_searches_against_the_equations(void)
{
  double off = 0;
  int shortened = 0;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = parabolic_face(CT_Q8, uniform(4), uniform(4));
    double point[3] = {uniform(1), uniform(1), uniform(3)}, start[2] = {uniform(0.9), uniform(0.9)};
    ct_projection out;
    for (int m = 0; m < 2; m++) {
      path p = walk(m == 0 ? CT_STEEPEST_DESCENT : CT_BFGS, &face, point, start, &out);
      double B[2][2] = {{0}}, before[2] = {0, 0}, g[2], H[3], next[2], s[2];
      for (int n = 0; n < 5 && n + 1 < p.count; n++) {
        function_at(&face, point, p.xi[n], NULL, g, H);
        double length = hypot(g[0], g[1]),
               bend = H[0] * g[0] * g[0] + 2 * H[2] * g[0] * g[1] + H[1] * g[1] * g[1];
        if (length < 1e-3) break;
        if (n == 0) B[0][0] = B[1][1] = 0.5 / length;
        if (n > 0 && m == 1) {
          double y[2] = {g[0] - before[0], g[1] - before[1]}, A[2][2], C[2][2];
          for (int a = 0; a < 2; a++) s[a] = p.xi[n][a] - p.xi[n - 1][a];
          double sy = s[0] * y[0] + s[1] * y[1];
          if (n == 1 && sy > 0) B[0][0] = B[1][1] = sy / (y[0] * y[0] + y[1] * y[1]);
          for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++) A[a][b] = (a == b) - s[a] * y[b] / sy;
          for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++) {
              C[a][b] = s[a] * s[b] / sy;
              for (int i = 0; i < 2; i++)
                for (int j = 0; j < 2; j++) C[a][b] += A[a][i] * B[i][j] * A[b][j];
            }
          for (int a = 0; a < 2 && sy > 0; a++)
            for (int b = 0; b < 2; b++) B[a][b] = C[a][b];
        }
        double step = bend > 0 ? fmin(length * length * length / bend, 1) : 1;
        for (int a = 0; a < 2; a++)
          s[a] = m == 0 ? -step * g[a] / length : -(B[a][0] * g[0] + B[a][1] * g[1]);
        shortened += searched(&face, point, p.xi[n], g, s, next) > 1;
        for (int a = 0; a < 2; a++)
          off = worst(off, (p.xi[n + 1][a] - next[a]) / (1 + fabs(next[a])));
        for (int a = 0; a < 2; a++) before[a] = g[a];
      }
    }
  }
  tap_close(off, 0, 1e-8, "steepest_descent and bfgs step as the equations say");
  tap_ok(shortened > 100, "their line search shortens %d steps", shortened);
}

/* The least decrease that a line search accepts (eq:projection-armijo). On the square f = (x - a)^2
 * + ... bfgs steps by 1/2 first, which changes f by 1/4 - a, with the slope -a. The step is kept if
 * f decreases by a ten-thousandth of a, else it goes to the minimum of the parabola at a. */
static void least_fall(void)
{
  ct_face flat = parabolic_face(CT_Q4, 0, 0);
  static const double SHARE[3] = {-5e-5, 9e-5, 1.1e-4};
  for (int i = 0; i < 3; i++) {
    double a = 0.25 * (1 + SHARE[i]), point[3] = {a, 0, 0.1}, start[2] = {0, 0};
    ct_projection out;
    path p = walk(CT_BFGS, &flat, point, start, &out);
    tap_close(p.xi[1][0], SHARE[i] > 1e-4 ? 0.5 : 0.25, 1e-4,
              "bfgs %s a step on which f falls by %g of the slope",
              SHARE[i] > 1e-4 ? "takes" : "shortens", SHARE[i]);
  }
}

/* The simplex down to an eighth of its edge, then Newton (eq:simplex-newton). */
static void simplex_then_newton(void)
{
  int same = 1;
  for (int trial = 0; trial < 100; trial++) {
    ct_face face = random_face(CT_Q8, 0.2);
    double point[3] = {uniform(0.8), uniform(0.8), uniform(0.5)};
    ct_project_options first = with(CT_SIMPLEX), second = with(CT_NEWTON),
                       both = with(CT_SIMPLEX_NEWTON);
    ct_projection a, b, c;
    first.tolerance = 1.0 / 8, second.use_start = 1;
    ct_project(&face, point, &first, &a, NULL);
    for (int k = 0; k < 2; k++) second.start[k] = a.xi[k];
    ct_project(&face, point, &second, &b, NULL);
    ct_project(&face, point, &both, &c, NULL);
    same &=
        c.xi[0] == b.xi[0] && c.xi[1] == b.xi[1] && c.evaluations == a.evaluations + b.evaluations;
  }
  tap_ok(same, "simplex_newton is the simplex, then newton");
}

/* A method that converges linearly goes on until the rest is below the tolerance
 * (eq:projection-remainder): least squares with the rate 0.85. */
static void remainder_of_a_slow_method(void)
{
  ct_face cylinder = parabolic_face(CT_Q8, 0.85, 0);
  double point[3] = {0, 0, 1}, start[2] = {0.01, 0};
  ct_projection out;
  (void)walk(CT_LEAST_SQUARES, &cylinder, point, start, &out);
  tap_ok(fabs(out.xi[0]) > 1e-12, "least squares at the rate 0.85 ends");
  tap_close(out.xi[0], 0, 1.01e-10, "but not before the remainder is below the tolerance");
}

/* A trough has a saddle of f above the centre of curvature: a method that ends there must not
 * report success. */
static void saddles_are_no_answers(void)
{
  ct_face trough = parabolic_face(CT_Q8, 1, 0);
  double above[3] = {0, 0.25, 1.125};
  for (int m = 0; m < method_count(); m++) {
    ct_project_options options = with(m);
    ct_projection out;
    ct_project(&trough, above, &options, &out, NULL);
    int at_foot = fabs(fabs(out.xi[0]) - 0.5) < 1e-6;
    tap_ok(at_foot || (out.status != CT_OK && out.certified == 0), "trough: %s %s", METHOD_NAME[m],
           at_foot ? "finds a closest point" : "reports that it found none");
  }
}

static void budgets_copies_and_bad_input(int m)
{
  ct_project_options options = with(m), two = options;
  const char *name = METHOD_NAME[m];
  ct_projection out, twin;
  int scaled = 1, sane = 1;
  two.iteration_limit = 2;
  for (int trial = 0; trial < 200; trial++) {
    ct_face face = random_face((ct_face_kind)(trial % 4), 0.3), copy = face;
    double point[3], other[3], power = ldexp(1, 7 * trial % 401 - 200);
    for (int k = 0; k < 3; k++) point[k] = uniform(1.3), other[k] = power * point[k];
    for (int i = 0; i < 24; i++) copy.node[i / 3][i % 3] *= power;
    ct_project(&face, point, &options, &out, NULL);
    ct_project(&copy, other, &options, &twin, NULL);
    scaled &= out.status == twin.status && out.xi[0] == twin.xi[0] && out.xi[1] == twin.xi[1] &&
              twin.distance == power * out.distance;
    scaled &= out.evaluations == twin.evaluations && out.iterations == twin.iterations;
    ct_project(&face, point, &two, &out, NULL);
    sane &= out.distance == out.distance && out.evaluations < 4200;
    if (m != CT_ROBUST && m != CT_CERTIFIED && m != CT_SIMPLEX_NEWTON) sane &= out.iterations <= 2;
  }
  tap_ok(scaled, "%s: a copy scaled by a power of two gives the scaled bits", name);
  tap_ok(sane, "%s respects its budget", name);
  ct_face flat = parabolic_face(CT_Q4, 0, 0), line = flat;
  ct_face spoilt = flat;
  double point[3] = {0, 0.1, 1}, nowhere[3] = {0, NAN, 1}, far[3] = {0, 0, INFINITY};
  for (int i = 0; i < 4; i++) line.node[i][1] = 0;
  spoilt.node[2][1] = NAN;
  tap_ok(ct_project(&spoilt, point, &options, &out, NULL) == CT_INVALID && isnan(out.xi[0]) &&
             isnan(out.distance),
         "%s: NaN in a node", name);
  tap_ok(ct_project(&flat, far, &options, &out, NULL) == CT_INVALID && isnan(out.signed_distance),
         "%s: an infinite point", name);
  tap_ok(ct_project(&flat, nowhere, &options, &out, NULL) == CT_INVALID && isnan(out.xi[0]) &&
             isnan(out.distance) && isnan(out.normal[1]),
         "%s: NaN in the point", name);
  static const double HUGE_ONE[3] = {1e300, -1e300, 1.7e308},
                      TINY[4] = {0.0, 5e-324, 1e-310, 1e-300};
  int extreme = 1;
  for (int i = 0; i < 7; i++) {
    ct_face own = flat;
    double place[3] = {i < 3 ? HUGE_ONE[i] : 0.0, 0, 0};
    if (i < 3)
      extreme &= ct_project(&flat, place, &options, &out, NULL) == CT_INVALID,
          own.node[1][2] = HUGE_ONE[i];
    for (int k = 0; k < 12 && i >= 3; k++) own.node[k / 3][k % 3] *= TINY[i - 3];
    extreme &= ct_project(&own, point, &options, &out, NULL) == CT_INVALID;
  }
  tap_ok(extreme, "%s: numbers whose fourth powers overflow are invalid", name);
  ct_status status = ct_project(&line, point, &options, &out, NULL);
  tap_ok(status == CT_INVALID && isnan(out.distance), "%s: a face shrunk to a line", name);
}

int main(void)
{
  for (int k = 0; k < 4; k++) {
    ct_face_kind kind = (ct_face_kind)k;
    paraboloid(kind, 0, 0, "plane");
    if (kind != CT_Q8 && kind != CT_T6) continue;
    paraboloid(kind, 0.8, 0, "parabolic cylinder");
    paraboloid(kind, 0.9, 0.9, "nearly spherical cup");
    paraboloid(kind, 0.7, -0.6, "saddle");
  }
  orders();
  one_step();
  sheared_and_twisted();
  broyden_is_the_secant_rule();
  nelder_mead_changes_its_form();
  nelder_mead_against_the_equations();
  line_searches_against_the_equations();
  least_fall();
  simplex_then_newton();
  remainder_of_a_slow_method();
  saddles_are_no_answers();
  for (int m = 0; m < method_count(); m++) budgets_copies_and_bad_input(m);
  return tap_done();
}
