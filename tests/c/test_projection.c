/* Projections compared with closed forms, optimality conditions, brute force, and mirrored, moved
 * and scaled copies. */
#include "faces.h"
#include "tap.h"

#include <float.h>
#include <string.h>

static const ct_method METHOD[3] = {CT_ROBUST, CT_NEWTON, CT_SIMPLEX};

static ct_project_options with(ct_method method)
{
  ct_project_options options = ct_project_options_default();
  options.method = method;
  return options;
}

/* A flat square or right triangle: the closest point (eq:projection-minimum) is the clamped one,
 * and its distance has the sign of eq:projection-signed. Points swept from deep inside to far
 * outside. */
static void flat_face_edges_and_vertices(ct_face_kind kind)
{
  static const double SWEEP[9] = {-3, -1.25, -1, -0.5, 0, 0.3, 0.75, 1, 2.5};
  double error = 0;
  int good = 1;
  for (int i = 0; i < 9; i++)
    for (int j = 0; j < 9; j++) {
      ct_face face = {kind, {{0}}};
      for (int k = 0; k < 8; k++)
        for (int a = 0; a < 2 && k < ct_face_node_count(kind); a++)
          face.node[k][a] = reference(kind, k)[a];
      double point[3] = {SWEEP[i], SWEEP[j], 0.5},
             x[2] = {fmin(fmax(point[0], -1), 1), fmin(fmax(point[1], -1), 1)};
      int edges = (x[0] == -1) + (x[0] == 1) + (x[1] == -1) + (x[1] == 1);
      if (triangular(kind)) {
        double over = 0.5 * (point[0] + point[1] - 1);
        x[0] = fmax(point[0], 0), x[1] = fmax(point[1], 0);
        if (x[0] + x[1] > 1) x[0] = fmin(fmax(point[0] - over, 0), 1), x[1] = 1 - x[0];
        edges = (x[0] == 0) + (x[1] == 0) + (x[0] + x[1] == 1);
      }
      double distance = sqrt((point[0] - x[0]) * (point[0] - x[0]) +
                             (point[1] - x[1]) * (point[1] - x[1]) + 0.25);
      ct_projection out;
      good &= ct_project(&face, point, NULL, &out, NULL) == CT_OK && (int)out.where == edges;
      for (int a = 0; a < 2; a++) error = worst(error, out.xi[a] - x[a]);
      error = worst(worst(error, out.signed_distance - distance), out.point[2]);
    }
  tap_ok(good, "%s: a swept point meets the interior, each edge and each corner", FACE_NAME[kind]);
  tap_close(error, 0, 1e-15, "%s: the closest point is the clamped point", FACE_NAME[kind]);
}

static void numbers_of_edges_and_corners(ct_face_kind kind)
{
  ct_face face = {kind, {{0}}};
  int corners = triangular(kind) ? 3 : 4, good = 1;
  double centre = triangular(kind) ? 1.0 / 3 : 0;
  for (int k = 0; k < ct_face_node_count(kind); k++)
    for (int a = 0; a < 2; a++) face.node[k][a] = reference(kind, k)[a];
  for (int i = 0; i < corners; i++) {
    const double *a = reference(kind, i), *b = reference(kind, (i + 1) % corners);
    double out_of_corner[3] = {a[0] + 2 * (a[0] - centre), a[1] + 2 * (a[1] - centre), 1};
    double middle[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])},
           direction[2] = {b[1] - a[1], a[0] - b[0]};
    double out_of_edge[3] = {middle[0] + direction[0], middle[1] + direction[1], 1};
    ct_projection out;
    ct_project(&face, out_of_corner, NULL, &out, NULL);
    good &= out.where == CT_VERTEX && out.index == i;
    ct_project(&face, out_of_edge, NULL, &out, NULL);
    good &= out.where == CT_EDGE && out.index == i;
    ct_project_options newton = with(CT_NEWTON);
    ct_project(&face, out_of_edge, &newton, &out, NULL);
    good &= out.where == CT_OUTSIDE && out.index == -1 && out.status == CT_OK;
  }
  tap_ok(good,
         "%s: edges and corners have the numbers of their nodes, unconstrained closest points are "
         "outside",
         FACE_NAME[kind]);
}

/* A random affine face. Its node coordinates are multiples of 1/64, so mid-sides lie exactly
 * halfway and edges are exactly straight. */
static ct_face affine_face(ct_face_kind kind)
{
  double column[2][3];
  for (int a = 0; a < 2; a++)
    for (int k = 0; k < 3; k++) column[a][k] = (a == k) + floor(uniform(24)) / 64;
  ct_face face = {kind, {{0}}};
  for (int i = 0; i < ct_face_node_count(kind); i++)
    for (int k = 0; k < 3; k++)
      face.node[i][k] = reference(kind, i)[0] * column[0][k] + reference(kind, i)[1] * column[1][k];
  return face;
}

/* A point at the height `height` over the edge from a to b, away from the face, perpendicular to
 * the edge up to rounding. Returns the position of its closest point on the edge, in extended
 * precision. */
static double point_over_edge(const double *a, const double *b, const double *inside, double height,
                              double point[3])
{
  double along = uniform(0.3) + 0.5, t[3], m[3], tt = 0, mt = 0, mm = 0;
  for (int k = 0; k < 3; k++) t[k] = b[k] - a[k], m[k] = a[k] - inside[k], tt += t[k] * t[k];
  for (int k = 0; k < 3; k++) mt += m[k] * t[k];
  for (int k = 0; k < 3; k++) m[k] -= mt / tt * t[k], mm += m[k] * m[k];
  for (int k = 0; k < 3; k++) point[k] = a[k] + along * t[k] + height / sqrt(mm) * m[k];
  long double pt = 0, square = 0;
  for (int k = 0; k < 3; k++) {
    long double edge = (long double)b[k] - a[k];
    pt += ((long double)point[k] - a[k]) * edge, square += edge * edge;
  }
  return (double)(pt / square);
}

/* On a straight edge the closest point is known, and so is its displacement by rounding
 * (eq:robust-resolved). Close to the edge robust finds it to the tolerance and returns CT_OK. Far
 * away the rounding of the distance moves xi by more than the tolerance; then CT_OK would be wrong.
 */
static void status_on_an_edge(ct_face_kind kind)
{
  int corners = triangular(kind) ? 3 : 4, near_ok = 1, far_false = 0, far_beyond = 0, far_edge = 1;
  double near_error = 0, tolerance = 1e-10 * (triangular(kind) ? 0.5 : 1);
  for (int trial = 0; trial < 400; trial++) {
    ct_face face = affine_face(kind);
    int i = trial % corners, j = (i + 1) % corners, far = trial / corners % 2;
    double point[3], height = far ? 1e8 : pow(10, uniform(2)), error = 0,
                     part = point_over_edge(face.node[i], face.node[j],
                                            face.node[(i + 2) % corners], height, point);
    ct_projection out;
    ct_status status = ct_project(&face, point, NULL, &out, NULL);
    for (int a = 0; a < 2; a++)
      error = worst(error,
                    out.xi[a] - (1 - part) * reference(kind, i)[a] - part * reference(kind, j)[a]);
    if (!far)
      near_ok &= status == CT_OK && out.where == CT_EDGE, near_error = worst(near_error, error);
    else far_edge &= out.where == CT_EDGE && (status == CT_OK || status == CT_NOT_CERTIFIED);
    if (far && !(error <= tolerance)) far_beyond++, far_false += status == CT_OK;
  }
  tap_ok(near_ok, "%s: near an edge the status is ok", FACE_NAME[kind]);
  // The bound of the rounding, 4 epsilon (distance + size) / |t|, with a distance up to 100.
  tap_close(near_error, 0, 2e-13, "%s: and xi is right", FACE_NAME[kind]);
  tap_ok(far_edge && far_beyond > 100 && far_false == 0,
         "%s: far from an edge %d of 200 xi are not known to the tolerance, and %d say ok",
         FACE_NAME[kind], far_beyond, far_false);
}

/* High above the inside of an affine face the status changes from ok to "not certified" at the
 * height at which rounding moves the closest point by the tolerance (eq:robust-resolved). */
static void status_high_above(ct_face_kind kind)
{
  int wrong = 0;
  for (int trial = 0; trial < 200; trial++) {
    ct_face face = affine_face(kind);
    double y[3], g[2], H[3], n[3], length[2], t[2][3], move[2], xi[2] = {0.3, 0.2}, point[3];
    ct_segment_point(&face, xi, y);
    function_at(&face, y, xi, NULL, g, H);
    for (int a = 0; a < 2; a++) {
      length[a] = sqrt(0.5 * H[a]);
      for (int k = 0; k < 3; k++)
        t[a][k] = face.node[a + 1][k] - face.node[triangular(kind) ? 0 : a][k];
    }
    for (int k = 0; k < 3; k++)
      n[k] = t[0][(k + 1) % 3] * t[1][(k + 2) % 3] - t[0][(k + 2) % 3] * t[1][(k + 1) % 3];
    double norm = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), room = H[0] * H[1] - H[2] * H[2];
    move[0] = H[1] * length[0] + fabs(H[2]) * length[1];
    move[1] = H[0] * length[1] + fabs(H[2]) * length[0];
    double tolerance = 1e-10 * (triangular(kind) ? 0.5 : 1),
           height = tolerance * room / (4 * 2.220446049250313e-16 * fmax(move[0], move[1]));
    for (int high = 0; high < 2; high++) {
      for (int k = 0; k < 3; k++) point[k] = y[k] + (high ? 1.02 : 0.98) * height * n[k] / norm;
      ct_projection out;
      ct_project(&face, point, NULL, &out, NULL);
      wrong += out.status != (high ? CT_NOT_CERTIFIED : CT_OK);
    }
  }
  tap_ok(wrong == 0, "%s: high above, the status changes where rounding says", FACE_NAME[kind]);
}

/* f is a quartic along each axis: the five-point differences below have no truncation error. They
 * check the gradient (eq:projection-gradient), the Hessian (eq:projection-hessian), and the
 * derivatives of the patch (eq:projection-patch-derivatives). */
static void function_derivatives(ct_face_kind kind)
{
  double first = 0, second = 0;
  for (int trial = 0; trial < 50; trial++) {
    ct_face face = random_face(kind, 0.4);
    double point[3] = {uniform(1), uniform(1), uniform(1)}, xi[2] = {uniform(1), uniform(1)}, g[2],
           H[3];
    function_at(&face, point, xi, NULL, g, H);
    for (int a = 0; a < 2; a++) {
      double f[5], slope[5][2];
      for (int s = 0; s < 5; s++) {
        double x[2] = {xi[0], xi[1]};
        x[a] += 0.25 * (s - 2);
        function_at(&face, point, x, &f[s], slope[s], NULL);
      }
      first = worst(first, (f[0] - 8 * f[1] + 8 * f[3] - f[4]) / 3 - g[a]);
      second = worst(second, (-f[0] + 16 * f[1] - 30 * f[2] + 16 * f[3] - f[4]) / 0.75 - H[a]);
      second = worst(
          second,
          (slope[0][1 - a] - 8 * slope[1][1 - a] + 8 * slope[3][1 - a] - slope[4][1 - a]) / 3 -
              H[2]);
    }
  }
  tap_close(first, 0, 1e-12, "%s: gradient of f against differences", FACE_NAME[kind]);
  tap_close(second, 0, 1e-11, "%s: Hessian of f against differences", FACE_NAME[kind]);
}

/* Two evaluations of f (eq:projection-f): the shape functions here, and the polynomial inside the
 * methods, from the trace. */
typedef struct watch {
  const ct_face *face;
  const double *point;
  double off;
  int calls;
} watch;

static void compare_f(const double xi[2], double f, void *user)
{
  watch *w = (watch *)user;
  double y[3], other = 0;
  ct_segment_point(w->face, xi, y);
  for (int k = 0; k < 3; k++) other += (y[k] - w->point[k]) * (y[k] - w->point[k]);
  w->off = worst(w->off, (f - other) / (1 + other));
  w->calls++;
}

/* So the coefficients are right: eq:projection-patch, eq:projection-patch-q4,
 * eq:projection-patch-q8, eq:projection-patch-t6; and f is eq:projection-f. */
static void trace_shows_f(ct_face_kind kind)
{
  double off = 0;
  int calls = 0;
  for (int trial = 0; trial < 30; trial++) {
    ct_face face = random_face(kind, 0.3);
    double point[3] = {uniform(1), uniform(1), uniform(1)};
    for (int m = 0; m < 3; m++) {
      watch w = {&face, point, 0, 0};
      ct_project_options options = with(METHOD[m]);
      ct_projection out;
      options.trace = compare_f;
      options.user = &w;
      ct_project(&face, point, &options, &out, NULL);
      off = worst(off, w.off);
      calls += w.calls > 0;
    }
  }
  tap_ok(calls == 90, "%s: every method shows its iterates", FACE_NAME[kind]);
  tap_close(off, 0, 1e-14, "%s: the methods' f is that of the shape functions", FACE_NAME[kind]);
}

/* Brute force: no point of a fine grid on the face is closer, for points and faces of all sorts;
 * inside, the gap is perpendicular to the tangents (eq:projection-stationary), on the boundary f
 * does not decrease towards the inside. */
static void brute_force(ct_face_kind kind)
{
  const int cells = 48;
  double closer = 0, slope = 0;
  int bad = 0;
  for (int trial = 0; trial < 150; trial++) {
    ct_face face = random_face(kind, triangular(kind) ? 0.125 : 0.25);
    double point[3] = {uniform(1.5), uniform(1.5), uniform(1)}, g[2];
    ct_projection out;
    bad += ct_project(&face, point, NULL, &out, NULL) != CT_OK;
    closer = fmax(closer, out.distance - sqrt(lowest_on_grid(&face, point, cells)));
    /* Inside, the gradient vanishes; on the boundary it must not point inwards. */
    function_at(&face, point, out.xi, NULL, g, NULL);
    double inward[4] = {-g[0], -g[1], g[0], g[1]},
           room[4] = {1 - out.xi[0], 1 - out.xi[1], 1 + out.xi[0], 1 + out.xi[1]};
    for (int a = 0; a < 4 && !triangular(kind); a++)
      if (room[a] > 0) slope = fmax(slope, inward[a]);
  }
  tap_ok(bad == 0, "%s: robust succeeds on 150 distorted faces", FACE_NAME[kind]);
  tap_close(fmax(closer, 0), 0, 1e-13, "%s: no grid point is closer than its closest point",
            FACE_NAME[kind]);
  tap_close(slope, 0, 1e-12, "%s: no direction into the face decreases the distance",
            FACE_NAME[kind]);
}

/* Samples (eq:robust-samples) detect the valleys. Faces z = p x^2 + q y^2 + r x y, so strongly bent
 * that they have several valleys: the samples alone miss the lowest one in about 1 of 100 cases. */
static void folded_faces(ct_face_kind kind)
{
  const int cells = 60;
  int missed = 0;
  for (int trial = 0; trial < 400; trial++) {
    ct_face face = {kind, {{0}}};
    double p = uniform(2), q = uniform(2), r = uniform(1),
           point[3] = {uniform(2), uniform(2), uniform(2)};
    ct_projection out;
    for (int i = 0; i < ct_face_node_count(kind); i++) {
      double x = reference(kind, i)[0], y = reference(kind, i)[1];
      if (triangular(kind)) x = 2 * x - 0.7, y = 2 * y - 0.7;
      face.node[i][0] = x, face.node[i][1] = y, face.node[i][2] = p * x * x + q * y * y + r * x * y;
    }
    ct_project(&face, point, NULL, &out, NULL);
    missed += out.distance > sqrt(lowest_on_grid(&face, point, cells)) + 1e-12;
  }
  tap_ok(missed == 0, "%s: robust misses %d of 400 lowest valleys on folded faces", FACE_NAME[kind],
         missed);
}

/* Caps of a sphere of radius 1.2 to 3 with the point close to the centre: f is nearly constant, and
 * several minima compete. */
static void centres_of_curvature(ct_face_kind kind)
{
  const int cells = 60;
  int missed = 0;
  for (int trial = 0; trial < 400; trial++) {
    ct_face face = {kind, {{0}}};
    double radius = 2.1 + uniform(0.9), point[3] = {uniform(0.01), uniform(0.01), uniform(0.01)};
    ct_projection out;
    for (int i = 0; i < ct_face_node_count(kind); i++) {
      double x = 0.5 * reference(kind, i)[0], y = 0.5 * reference(kind, i)[1];
      face.node[i][0] = x, face.node[i][1] = y,
      face.node[i][2] = sqrt(radius * radius - x * x - y * y);
    }
    ct_project(&face, point, NULL, &out, NULL);
    missed += out.distance > sqrt(lowest_on_grid(&face, point, cells)) * (1 + 1e-12);
  }
  tap_ok(missed == 0, "%s: robust misses %d of 400 closest points from near a centre of curvature",
         FACE_NAME[kind], missed);
}

/* Cost of robust: few evaluations on a nearly plane face, because it is mild (eq:robust-mild, from
 * eq:robust-bend and eq:robust-straight), the first guess is good (eq:robust-guess) and the end is
 * detected in time (eq:robust-quadratic); and a loose tolerance never costs more than a tight one.
 */
static void costs_in_looks(ct_face_kind kind)
{
  int most = 0, dearer = 0;
  for (int trial = 0; trial < 400; trial++) {
    ct_face plain = random_face(kind, triangular(kind) ? 0.01 : 0.03),
            bent = random_face(kind, triangular(kind) ? 0.2 : 0.5);
    double above[3] = {0.3 + uniform(0.2), 0.3 + uniform(0.2), uniform(0.3)},
           point[3] = {uniform(1.5), uniform(1.5), uniform(1)};
    ct_project_options tight = with(CT_ROBUST), loose = tight;
    ct_projection a, b;
    ct_project(&plain, above, &tight, &a, NULL);
    most = a.evaluations > most ? a.evaluations : most;
    loose.tolerance = 1e-2;
    for (int warm = 0; warm < 2; warm++) {
      tight.use_start = loose.use_start = warm;
      tight.start[0] = loose.start[0] = 0.25;
      ct_project(&bent, point, &tight, &a, NULL);
      ct_project(&bent, point, &loose, &b, NULL);
      dearer += b.evaluations > a.evaluations;
    }
  }
  tap_ok(most <= 5, "%s: a nearly plane face needs at most %d evaluations", FACE_NAME[kind], most);
  tap_ok(dearer == 0, "%s: a tolerance of 1e-2 costs more than 1e-10 on %d of 800 bent faces",
         FACE_NAME[kind], dearer);
}

/* The first iterates of a search. */
typedef struct first {
  double xi[20][2];
  int count;
} first;

static void look_at_first(const double xi[2], double f, void *user)
{
  first *p = (first *)user;
  (void)f;
  if (p->count < 20)
    for (int a = 0; a < 2; a++) p->xi[p->count][a] = xi[a];
  p->count++;
}

/* The first iterates of robust from a given start. */
static first robust_from(const ct_face *face, const double point[3], const double xi[2])
{
  first p = {{{0}}, 0};
  ct_project_options options = with(CT_ROBUST);
  ct_projection out;
  options.use_start = 1, options.trace = look_at_first, options.user = &p;
  for (int a = 0; a < 2; a++) options.start[a] = xi[a];
  ct_project(face, point, &options, &out, NULL);
  return p;
}

/* A search that meets no tolerance ends with the first step after which a quadratic method has
 * rounding alone (eq:robust-quadratic). */
static void last_step_of_robust(void)
{
  int searches = 0, early = 0, late = 0;
  for (int trial = 0; trial < 20000; trial++) {
    ct_face face = random_face(CT_Q8, 0.2);
    double point[3] = {uniform(0.8), uniform(0.8), uniform(0.3)}, before = HUGE_VAL;
    first p = {{{0}}, 0};
    ct_project_options options = with(CT_ROBUST);
    ct_projection out;
    options.tolerance = 1e-16;
    options.use_start = 1, options.trace = look_at_first, options.user = &p;
    ct_project(&face, point, &options, &out, NULL);
    if (p.count > 19 || out.where != CT_INTERIOR) continue;
    for (int a = 0; a < 2; a++) p.xi[p.count][a] = out.xi[a];
    for (int k = 0; k < p.count; k++) {
      double s = fmax(fabs(p.xi[k + 1][0] - p.xi[k][0]), fabs(p.xi[k + 1][1] - p.xi[k][1])),
             left = s * s * fmax(1, s / (before * before)) / (4 * DBL_EPSILON);
      early += k == p.count - 1 && left > 1 + 1e-6,
          late += k < p.count - 1 && s > 0 && left < 1 - 1e-6;
      before = s;
    }
    searches++;
  }
  tap_ok(searches > 500 && early == 0 && late == 0, "robust: %d searches, %d end early and %d late",
         searches, early, late);
}

/* On nearly plane faces, with points beside and beyond them, the first step of robust is the lowest
 * point of the model (eq:robust-model) in the trust region and on the face, be it inside, on a side
 * (eq:robust-side) or on the slanted side (eq:robust-slant). A fine grid of allowed steps has none
 * lower; and f falls by a tenth of the promise (eq:robust-accept). */
static void first_step_of_robust(ct_face_kind kind)
{
  const int cells = 100;
  int steps = 0, unkept = 0;
  double lower = 0, wide = triangular(kind) ? 0.5 : 1, low = triangular(kind) ? 0 : -1;
  for (int trial = 0; trial < 200; trial++) {
    ct_face face = random_face(kind, triangular(kind) ? 0.003 : 0.03);
    double point[3] = {uniform(2), uniform(2), uniform(0.3)}, xi[2], g[2], H[3], f[2];
    random_xi(kind, 0.02, xi);
    const first p = robust_from(&face, point, xi);
    if (p.count < 2) continue;
    function_at(&face, point, xi, &f[0], g, H);
    function_at(&face, point, p.xi[1], &f[1], NULL, NULL);
    double s[2] = {p.xi[1][0] - xi[0], p.xi[1][1] - xi[1]}, best = 0, taken = 0;
    for (int i = -1; i <= cells; i++)
      for (int j = 0; j <= cells; j++) {
        double x = i < 0 ? s[0] : wide * (2.0 * i / cells - 1),
               y = i < 0 ? s[1] : wide * (2.0 * j / cells - 1);
        double q = g[0] * x + g[1] * y + 0.5 * (H[0] * x * x + H[1] * y * y) + H[2] * x * y,
               u = xi[0] + x, v = xi[1] + y;
        if (i < 0) taken = q;
        if (u >= low && v >= low && u <= 1 && v <= 1 && (!triangular(kind) || u + v <= 1))
          best = fmin(best, q);
      }
    steps++;
    lower = fmax(lower, taken - best);
    unkept += f[0] - f[1] < -0.1 * taken;
  }
  tap_ok(steps > 150 && unkept == 0, "%s: f decreases as predicted in %d first steps of robust",
         FACE_NAME[kind], steps);
  tap_close(lower, 0, 1e-13, "%s: no allowed step has a lower model", FACE_NAME[kind]);
}

/* How far the model of f falls in a step. */
static double promise_of(const double g[2], const double H[3], double x, double y)
{
  return -(g[0] * x + g[1] * y + 0.5 * (H[0] * x * x + H[1] * y * y) + H[2] * x * y);
}

/* The allowed step on a quadrilateral with the lowest model, by grids that get finer about the
 * lowest so far. */
static void lowest_step(const double xi[2], const double g[2], const double H[3], double s[2])
{
  double middle[2] = {0, 0}, most = 0;
  s[0] = s[1] = 0;
  for (double half = 1; half > 1e-5; half *= 0.1) {
    for (int i = -20; i <= 20; i++)
      for (int j = -20; j <= 20; j++) {
        double x = middle[0] + half * i / 20, y = middle[1] + half * j / 20,
               far = fmax(fmax(fabs(x), fabs(y)), fmax(fabs(xi[0] + x), fabs(xi[1] + y))),
               promise = promise_of(g, H, x, y);
        if (far <= 1 && promise > most) most = promise, s[0] = x, s[1] = y;
      }
    middle[0] = s[0], middle[1] = s[1];
  }
}

/* On bent faces, where a search begins once more from its start, the first step is taken if f falls
 * by a tenth of what the model promises, and no other is (eq:robust-accept). */
static void steps_that_are_taken(void)
{
  int taken = 0, refused = 0, wrong = 0;
  for (int trial = 0; trial < 20000; trial++) {
    ct_face face = random_face(CT_Q8, 0.6);
    double point[3] = {uniform(1), uniform(1), uniform(1)}, xi[2], s[2], g[2], H[3], f[2];
    random_xi(CT_Q8, 0.02, xi);
    const first p = robust_from(&face, point, xi);
    if (p.count < 3 || memcmp(p.xi[0], p.xi[1], sizeof xi) != 0) continue;
    function_at(&face, point, xi, &f[0], g, H);
    for (int a = 0; a < 2; a++) s[a] = p.xi[2][a] - xi[a];
    int moved = s[0] != 0 || s[1] != 0;
    if (!moved) lowest_step(xi, g, H, s);
    double end[2] = {xi[0] + s[0], xi[1] + s[1]};
    function_at(&face, point, end, &f[1], NULL, NULL);
    double share = (f[0] - f[1]) / promise_of(g, H, s[0], s[1]);
    taken += moved && share < 0.14, refused += !moved && share > 0.03;
    wrong += (share > 0.102 && !moved) || (share < 0.098 && moved);
  }
  tap_ok(wrong == 0 && taken > 2 && refused > 2,
         "%d steps for which f falls by little are taken, %d refused, %d wrongly", taken, refused,
         wrong);
}

static int same_bits(const ct_projection *a, const ct_projection *b, const double xi_sign[2],
                     const double sign[3], double scale, const double shift[3])
{
  int same = a->status == b->status && a->where == b->where && a->evaluations == b->evaluations;
  for (int i = 0; i < 2; i++) same &= b->xi[i] == xi_sign[i] * a->xi[i];
  for (int k = 0; k < 3; k++) same &= b->normal[k] == sign[k] * a->normal[k];
  for (int k = 0; k < 3; k++) same &= shift[k] != 0 || b->point[k] == scale * sign[k] * a->point[k];
  return same && b->distance == scale * a->distance &&
         b->signed_distance == scale * a->signed_distance;
}

/* A copy with mirrored axis and flipped xi, and one scaled by a power of two: exact operations on
 * any numbers. */
static void copies_give_the_same_bits(ct_face_kind kind, ct_method method)
{
  static const int FLIP1[8] = {1, 0, 3, 2, 4, 7, 6, 5}, FLIP2[8] = {3, 2, 1, 0, 6, 5, 4, 7},
                   KEEP[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  int mirrored = 1, scaled = 1;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = random_face(kind, 0.3), copy = face;
    double point[3], other[3], zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    for (int k = 0; k < 3; k++) point[k] = uniform(1.3);
    ct_project_options options = with(method), flipped = options;
    ct_projection out, twin;
    options.use_start = flipped.use_start = trial % 2;
    for (int a = 0; a < 2; a++)
      options.start[a] = flipped.start[a] = triangular(kind) ? 0.25 : uniform(1);
    ct_project(&face, point, &options, &out, NULL);
    double power = ldexp(1, trial % 61 - 30);
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 3; k++) copy.node[i][k] = power * face.node[i][k];
    for (int k = 0; k < 3; k++) other[k] = power * point[k];
    ct_project(&copy, other, &options, &twin, NULL);
    scaled &= same_bits(&out, &twin, one, one, power, zero);
    if (triangular(kind)) continue;
    int axis = trial % 3, second = (trial / 3) % 2;
    const int *map = second ? FLIP2 : trial % 5 ? FLIP1 : KEEP;
    double xi_sign[2] = {map == FLIP1 ? -1 : 1, map == FLIP2 ? -1 : 1}, sign[3] = {1, 1, 1};
    if (map != KEEP) sign[axis] = -1;
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 3; k++) copy.node[i][k] = sign[k] * face.node[map[i]][k];
    for (int k = 0; k < 3; k++) other[k] = sign[k] * point[k];
    for (int a = 0; a < 2; a++) flipped.start[a] = xi_sign[a] * options.start[a];
    ct_project(&copy, other, &flipped, &twin, NULL);
    mirrored &= same_bits(&out, &twin, xi_sign, sign, 1, zero);
  }
  tap_ok(scaled, "%s %s: a copy scaled by a power of two gives the scaled bits", FACE_NAME[kind],
         METHOD_NAME[method]);
  if (!triangular(kind) && method != CT_SIMPLEX)
    tap_ok(mirrored, "%s %s: a mirrored copy gives the mirrored bits", FACE_NAME[kind],
           METHOD_NAME[method]);
}

/* A translation is exact if the numbers are short. */
static void moved_copies_give_the_same_bits(ct_face_kind kind, ct_method method)
{
  static const double SHIFT[3] = {64, -32, 128}, ONE[3] = {1, 1, 1};
  int moved = 1;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = random_face(kind, 0.3), copy;
    double point[3], other[3];
    for (int k = 0; k < 3; k++) {
      point[k] = floor(uniform(1.3) * 1048576) / 1048576;
      other[k] = point[k] + SHIFT[k];
      for (int i = 0; i < 8; i++) face.node[i][k] = floor(face.node[i][k] * 1048576) / 1048576;
    }
    copy = face;
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 3; k++) copy.node[i][k] += SHIFT[k];
    ct_project_options options = with(method);
    ct_projection out, twin;
    ct_project(&face, point, &options, &out, NULL);
    ct_project(&copy, other, &options, &twin, NULL);
    moved &= same_bits(&out, &twin, ONE, ONE, 1, SHIFT);
  }
  tap_ok(moved, "%s %s: a moved copy gives the same bits", FACE_NAME[kind], METHOD_NAME[method]);
}

static void newton_on_linear_triangles(void)
{
  int evaluations = 0;
  double error = 0;
  for (int trial = 0; trial < 100; trial++) {
    ct_face face = random_face(CT_T3, 0.3);
    double point[3] = {uniform(1), uniform(1), uniform(1)}, t[2][3], d[3], A = 0, B = 0, C = 0,
           u = 0, v = 0;
    for (int k = 0; k < 3; k++) {
      t[0][k] = face.node[1][k] - face.node[0][k], t[1][k] = face.node[2][k] - face.node[0][k],
      d[k] = point[k] - face.node[0][k];
      A += t[0][k] * t[0][k], B += t[0][k] * t[1][k], C += t[1][k] * t[1][k], u += t[0][k] * d[k],
          v += t[1][k] * d[k];
    }
    double xi[2] = {(u * C - v * B) / (A * C - B * B), (v * A - u * B) / (A * C - B * B)};
    ct_project_options options = with(CT_NEWTON);
    ct_projection out;
    ct_project(&face, point, &options, &out, NULL);
    evaluations = out.evaluations > evaluations ? out.evaluations : evaluations;
    for (int a = 0; a < 2; a++) error = worst(error, (out.xi[a] - xi[a]) / (1 + fabs(xi[a])));
  }
  tap_ok(evaluations == 2, "T3: newton converges in one step (the second evaluation confirms it)");
  tap_close(error, 0, 1e-12, "T3: newton solves the normal equations");
}

/* The limit of any search by values (eq:simplex-floor). */
static void simplex_floor(void)
{
  ct_face face = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
  ct_project_options options = with(CT_SIMPLEX);
  for (double gap = 1e-6; gap < 2e6; gap *= 100) {
    double point[3] = {0.3125, -0.4, gap};
    ct_projection out;
    ct_project(&face, point, &options, &out, NULL);
    double error = fmax(fabs(out.xi[0] - point[0]), fabs(out.xi[1] - point[1])),
           floor_ = 4 * sqrt(2.2e-16) * gap;
    tap_close(error, 0, 1e-10 + floor_,
              "simplex at the gap %g: error within the tolerance and the floor", gap);
    tap_ok((out.status == CT_OK) == (floor_ < 1e-10) && out.evaluations < 1000,
           "simplex at the gap %g: the status reports it (%s after %d)", gap,
           ct_status_name(out.status), out.evaluations);
    tap_close(out.distance, gap, 4.5e-16 * gap + 1e-20 / gap,
              "simplex at the gap %g: the distance is still correct", gap);
  }
  double near[3] = {0.3, 0.3, 0.1};
  ct_projection out;
  options.iteration_limit = 10;
  tap_ok(ct_project(&face, near, &options, &out, NULL) == CT_ITERATION_LIMIT &&
             out.iterations == 10,
         "simplex respects its budget");
}

/* The closest point is the centroid of the first simplex (eq:simplex-start), so all three values
 * are equal: by hand, the first image is not lower and the second highest vertex is reflected too
 * (3 + 2 calls). No vertex may be the centre of fewer than 4 iterations before each of the 34
 * halvings down to 1e-10, and before the end. */
static void simplex_steps_by_hand(void)
{
  ct_face face = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
  double point[3] = {0, 0, 1e-6};
  ct_project_options options = with(CT_SIMPLEX);
  ct_projection out;
  options.iteration_limit = 1;
  ct_project(&face, point, &options, &out, NULL);
  tap_ok(out.evaluations == 5,
         "simplex reflects the second highest vertex when the highest does not improve");
  options.iteration_limit = 0;
  ct_project(&face, point, &options, &out, NULL);
  tap_ok(out.status == CT_OK && out.iterations >= 4 * 35 - 1,
         "simplex halves when a vertex has stayed 4 times (%d iterations)", out.iterations);
  // m = n (33 + n) / 20 (eq:simplex-age)
  tap_close(20 * ct_simplex_age(2), 70, 1e-13, "a vertex is old after 3.5 iterations");
  tap_close(20 * ct_simplex_age(7), 280, 1e-13, "and in seven dimensions after 14");
}

/* A stationary point is a minimum only where f is convex (eq:projection-convex), and far away
 * rounding hides whether f decreases (eq:robust-noise). */
static void hard_cases(void)
{
  /* A trough z = x^2 / 2: above the centre of curvature the closest point splits into x = +- sqrt(2
   * (z - 1)). */
  ct_face trough = {CT_Q8, {{0}}};
  for (int i = 0; i < 8; i++) {
    trough.node[i][0] = reference(CT_Q8, i)[0], trough.node[i][1] = reference(CT_Q8, i)[1];
    trough.node[i][2] = 0.5 * reference(CT_Q8, i)[0] * reference(CT_Q8, i)[0];
  }
  double above[3] = {0, 0.25, 1.125};
  ct_projection out;
  ct_project_options options = with(CT_ROBUST), newton = with(CT_NEWTON);
  tap_ok(ct_project(&trough, above, &options, &out, NULL) == CT_OK,
         "trough: robust leaves the saddle");
  tap_close(fabs(out.xi[0]), 0.5, 1e-14, "trough: to one of the two closest points");
  tap_ok(ct_project(&trough, above, &newton, &out, NULL) == CT_NO_CONVERGENCE,
         "trough: newton ends on the saddle and reports it");
  double beside[3] = {0.01, 0.25, 1.125};
  options.use_start = 1, options.start[0] = -0.5, options.start[1] = 0.25;
  ct_project(&trough, beside, &options, &out, NULL);
  double left = out.distance;
  options.use_start = 0;
  ct_project(&trough, beside, &options, &out, NULL);
  tap_ok(out.xi[0] > 0.5 && out.distance < left,
         "trough: without a start, the lower of two minima is found");

  /* A corner whose two mid-sides are at their quarter points has no gradient there for any point.
   */
  ct_face quarter = {CT_Q8,
                     {{-1, -1, 0},
                      {1, -1, 0},
                      {1, 1, 0},
                      {-1, 1, 0},
                      {-0.5, -1, 0},
                      {1, 0, 0},
                      {0, 1, 0},
                      {-1, -0.5, 0}}};
  double point[3] = {-0.9, -0.85, 0.5};
  options.use_start = 1, options.start[0] = options.start[1] = -1;
  tap_ok(ct_project(&quarter, point, &options, &out, NULL) == CT_OK,
         "quarter-point corner: robust leaves it");
  tap_close(out.distance, 0.5, 1e-15,
            "quarter-point corner: the gap is found from the corner itself");
  double behind[3] = {-2, -2, 0.5};
  tap_ok(ct_project(&quarter, behind, NULL, &out, NULL) == CT_OK && out.where == CT_VERTEX &&
             out.index == 0 && out.normal[2] == 1,
         "quarter-point corner: as a closest point it has the normal of its neighbourhood");

  /* Two corners in one place. */
  ct_face collapsed = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {1, 1, 0}}};
  double at[3] = {0.5, 0, -2};
  tap_ok(ct_project(&collapsed, at, NULL, &out, NULL) == CT_OK, "collapsed quadrilateral");
  tap_close(out.signed_distance, -2, 1e-15, "collapsed quadrilateral: gap");

  /* Offsets cost no digits, because the point is subtracted first. */
  ct_face away = {CT_Q4, {{1e6 - 1, -1, 0}, {1e6 + 1, -1, 0}, {1e6 + 1, 1, 0}, {1e6 - 1, 1, 0}}};
  double over[3] = {1e6 + 0.25, 0.5, 1e-9};
  ct_project(&away, over, NULL, &out, NULL);
  tap_close(out.signed_distance, 1e-9, 1e-24, "a gap of 1e-9 at an offset of 1e6");

  /* So far away that rounding hides the position of the closest point on the face: the search must
   * end. */
  ct_face tilted = {CT_T3, {{0, 0, 0}, {1, 0.3, 0.7}, {-0.2, 1, 0.1}}};
  double far[3] = {-0.67e9 + 0.24, -0.24e9 + 0.39, 1.06e9 + 0.24};
  ct_project(&tilted, far, NULL, &out, NULL);
  tap_ok(out.status == CT_NOT_CERTIFIED && out.evaluations < 50 && isfinite(out.distance),
         "a point 1e9 faces away ends in %d evaluations: %s", out.evaluations,
         ct_status_name(out.status));
}

static void bad_input(void)
{
  ct_face good = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, face = good;
  double point[3] = {0, 0, 1};
  ct_projection out;
  ct_project_options options = ct_project_options_default();
  ct_face dot = {CT_T6, {{0}}}, line = {CT_Q4, {{-1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}}};
  tap_ok(ct_project(&dot, point, NULL, &out, NULL) == CT_INVALID, "a face shrunk to a point");
  tap_ok(ct_project(&line, point, NULL, &out, NULL) == CT_INVALID, "a face shrunk to a line");
  tap_ok(ct_project(NULL, point, NULL, &out, NULL) == CT_ERROR_ARGUMENT && isnan(out.xi[1]),
         "no face");
  tap_ok(ct_project(&good, NULL, NULL, &out, NULL) == CT_ERROR_ARGUMENT &&
             ct_project(&good, point, NULL, NULL, NULL) == CT_ERROR_ARGUMENT,
         "null pointers");
  face.kind = (ct_face_kind)12;
  tap_ok(ct_project(&face, point, NULL, &out, NULL) == CT_ERROR_ARGUMENT, "an unknown kind");
  options.tolerance = 0;
  tap_ok(ct_project(&good, point, &options, &out, NULL) == CT_ERROR_ARGUMENT, "no tolerance");
  options.tolerance = NAN;
  tap_ok(ct_project(&good, point, &options, &out, NULL) == CT_ERROR_ARGUMENT,
         "a tolerance that is NaN");
  options = ct_project_options_default();
  options.method = (ct_method)77;
  tap_ok(ct_project(&good, point, &options, &out, NULL) == CT_ERROR_ARGUMENT &&
             !ct_method_exists(options.method) && ct_method_exists(CT_TORUS),
         "an unknown method");
  options.method = CT_ROBUST, options.use_start = 1, options.start[0] = NAN;
  tap_ok(ct_project(&good, point, &options, &out, NULL) == CT_ERROR_ARGUMENT,
         "a start that is NaN");
}

static void many_points_are_single_points(void)
{
  ct_face face = random_face(CT_Q8, 0.2);
  double points[20][3], start[20][2];
  ct_projection many[20], one;
  int same = 1;
  for (int i = 0; i < 20; i++) {
    for (int k = 0; k < 3; k++) points[i][k] = uniform(1);
    for (int a = 0; a < 2; a++) start[i][a] = uniform(1);
  }
  tap_ok(ct_project_points(&face, 20, &points[0][0], NULL, &start[0][0], many, NULL) == CT_OK,
         "20 points in one call");
  for (int i = 0; i < 20; i++) {
    ct_project_options options = ct_project_options_default();
    options.use_start = 1;
    for (int a = 0; a < 2; a++) options.start[a] = start[i][a];
    ct_project(&face, points[i], &options, &one, NULL);
    same &= one.xi[0] == many[i].xi[0] && one.distance == many[i].distance &&
            one.evaluations == many[i].evaluations;
  }
  tap_ok(same, "they equal those of single calls");
  tap_ok(ct_project_points(&face, 2, NULL, NULL, NULL, many, NULL) == CT_ERROR_ARGUMENT,
         "no points");
  tap_ok(ct_project_points(NULL, 2, &points[0][0], NULL, NULL, many, NULL) == CT_ERROR_ARGUMENT &&
             isnan(many[1].distance),
         "null faces are refused");
}

int main(void)
{
  for (int k = 0; k < 4; k++) {
    ct_face_kind kind = (ct_face_kind)k;
    flat_face_edges_and_vertices(kind);
    numbers_of_edges_and_corners(kind);
    status_on_an_edge(kind);
    status_high_above(kind);
    function_derivatives(kind);
    trace_shows_f(kind);
    brute_force(kind);
    if (kind == CT_Q8 || kind == CT_T6) folded_faces(kind), centres_of_curvature(kind);
    costs_in_looks(kind);
    first_step_of_robust(kind);
    for (int m = 0; m < 3; m++)
      copies_give_the_same_bits(kind, METHOD[m]), moved_copies_give_the_same_bits(kind, METHOD[m]);
  }
  steps_that_are_taken();
  last_step_of_robust();
  newton_on_linear_triangles();
  simplex_floor();
  simplex_steps_by_hand();
  hard_cases();
  bad_input();
  many_points_are_single_points();
  return tap_done();
}
