/* A certificate is never false: each proof is compared with dense samples of the face. */
#include "faces.h"
#include "tap.h"

#include <string.h>

/* Random faces of a kind. */
enum { TRIALS = 100 };

/* How many of `trials` are proved, how many proofs a grid refutes, and their cost. */
typedef struct score {
  int proven, refuted, disagree, evaluations;
} score;

static void check_certificates(const ct_face *face, const double point[3], int iteration_limit,
                               int cells, score *s)
{
  ct_project_options options = ct_project_options_default();
  options.method = CT_CERTIFIED;
  options.iteration_limit = iteration_limit;
  ct_projection out;
  ct_project(face, point, &options, &out, NULL);
  if (out.status == CT_INVALID) return;
  s->proven += out.certified;
  s->disagree += (out.status == CT_OK) != (out.certified == 1) ||
                 (out.status != CT_OK && out.status != CT_NOT_CERTIFIED);
  s->evaluations = out.evaluations > s->evaluations ? out.evaluations : s->evaluations;
  if (!out.certified) return;
  double lowest = sqrt(lowest_on_grid(face, point, cells)), size = 0;
  for (int i = 0; i < ct_face_node_count(face->kind); i++)
    for (int k = 0; k < 3; k++) size = fmax(size, fabs(face->node[i][k] - face->node[0][k]));
  s->refuted += out.distance > lowest + 1e-10 * fmax(lowest, size);
}

static void report(const score *s, int trials, int least, const char *kind, const char *what)
{
  tap_ok(s->refuted == 0 && s->disagree == 0, "%s, %s: %d certificates, none is false", kind, what,
         s->proven);
  tap_ok(s->proven >= least, "%s, %s: %d of %d certified", kind, what, s->proven, trials);
}

static void random_faces(ct_face_kind kind, double amount, double far, const char *what)
{
  const int trials = tap_times(TRIALS);
  score s = {0, 0, 0, 0}, cut = s;
  for (int trial = 0; trial < trials; trial++) {
    ct_face face = random_face(kind, amount);
    double point[3] = {uniform(far), uniform(far), uniform(far)};
    check_certificates(&face, point, 0, 64, &s);
    check_certificates(&face, point, 1, 64, &cut);
  }
  report(&s, trials, trials - trials / 100, FACE_NAME[kind], what);
  report(&cut, trials, 0, FACE_NAME[kind], "robust stopped after one iteration");
}

/* Several valleys, two of them equally deep in every third case. */
static void folded_faces(ct_face_kind kind)
{
  const int trials = tap_times(TRIALS);
  score s = {0, 0, 0, 0};
  for (int trial = 0; trial < trials; trial++) {
    double p = uniform(4), q = uniform(4), point[3] = {uniform(2), uniform(2), uniform(2)};
    ct_face face = parabolic_face(kind, p, q);
    if (trial % 3 == 0 && kind == CT_Q8) point[0] = 0;
    check_certificates(&face, point, 0, 96, &s);
  }
  report(&s, trials, trials - trials / 100, FACE_NAME[kind], "folded");
}

/* Two corners, an edge or two opposite edges in one place; quarter-point mid-sides; needles. */
static void degenerate_faces(void)
{
  const int trials = tap_times(TRIALS);
  score collapsed = {0, 0, 0, 0}, quarter = collapsed, needle = collapsed;
  for (int trial = 0; trial < trials; trial++) {
    ct_face face = random_face(CT_Q4, 0.4), crack = random_face(CT_Q8, 0.1),
            thin = random_face(trial % 2 ? CT_T6 : CT_Q8, 0.1);
    double point[3] = {uniform(1.5), uniform(1.5), uniform(1.5)};
    for (int k = 0; k < 3; k++) {
      face.node[trial % 4][k] = face.node[(trial + 1) % 4][k];
      crack.node[4][k] = 0.75 * crack.node[0][k] + 0.25 * crack.node[1][k];
      crack.node[7][k] = 0.75 * crack.node[0][k] + 0.25 * crack.node[3][k];
    }
    for (int i = 0; i < 8; i++) thin.node[i][1] *= 1e-5;
    check_certificates(&face, point, 0, 64, &collapsed);
    check_certificates(&crack, point, 0, 64, &quarter);
    check_certificates(&thin, point, 0, 64, &needle);
  }
  report(&collapsed, trials, trials - trials / 60, "Q4", "collapsed");
  report(&quarter, trials, trials - trials / 60, "Q8", "quarter-point");
  report(&needle, trials, trials - trials / 30, "Q8 and T6", "aspect 1e5");
  tap_ok(collapsed.evaluations < 20000 && quarter.evaluations < 20000, "the budget holds");
}

static double f_at(const ct_face *face, const double point[3], double x, double y)
{
  double xi[2] = {x, y}, f;
  function_at(face, point, xi, &f, NULL, NULL);
  return f;
}

/* Lowest f over xi_1 at the given xi_2 = y, or (outer) over xi_2 of that: a grid, and the golden
 * section about its best place. */
static double on_row(const ct_face *face, const double point[3], double x, int outer);

static double golden(const ct_face *face, const double point[3], double y, int outer, int cells)
{
  const double part = 0.61803398874989485;
  double lowest = HUGE_VAL, place = 0;
  for (int i = 0; i <= cells; i++) {
    double x = 2.0 * i / cells - 1, f = outer ? on_row(face, point, x, 0) : f_at(face, point, x, y);
    if (f < lowest) lowest = f, place = x;
  }
  double a = fmax(place - 2.0 / cells, -1), b = fmin(place + 2.0 / cells, 1);
  for (int i = 0; i < 60; i++) {
    double u = b - part * (b - a), v = a + part * (b - a);
    double fu = outer ? on_row(face, point, u, 0) : f_at(face, point, u, y),
           fv = outer ? on_row(face, point, v, 0) : f_at(face, point, v, y);
    lowest = fmin(lowest, fmin(fu, fv));
    if (fu < fv) b = v;
    else a = u;
  }
  return lowest;
}

static double on_row(const ct_face *face, const double point[3], double x, int outer)
{
  return golden(face, point, x, outer, 32);
}

/* Long thin faces: a narrow valley that winds, and a search that is stopped in it. */
static void narrow_valleys(void)
{
  score s = {0, 0, 0, 0};
  int wrong = 0;
  for (int trial = 0; trial < 80; trial++) {
    ct_face face = random_face(trial % 2 ? CT_Q4 : CT_Q8, 0.2);
    double thin = pow(10, -3 - trial % 4),
           point[3] = {uniform(0.8), thin * uniform(1), thin * uniform(1)};
    for (int i = 0; i < 8; i++) face.node[i][1] *= thin, face.node[i][2] *= thin;
    double lowest = sqrt(golden(&face, point, 0, 1, 32));
    for (int limit = 0; limit < 3; limit++) {
      ct_project_options options = ct_project_options_default();
      ct_projection out;
      options.method = CT_CERTIFIED;
      options.iteration_limit = limit;
      ct_project(&face, point, &options, &out, NULL);
      s.proven += limit == 0 && out.certified;
      s.refuted += out.certified && out.distance > lowest + 1e-10;
      wrong += limit == 0 && !(out.distance <= lowest + 1e-10);
    }
  }
  report(&s, 80, 78, "Q4 and Q8", "1e3 to 1e6 times as long as wide");
  tap_ok(wrong <= 1,
         "the closest point lies on the floor of the valley: %d of 80 are farther than a search "
         "line by line",
         wrong);
}

/* On a cylinder all heights over the axis are equally near: a line of closest points, and a certain
 * distance. */
static void many_feet(void)
{
  ct_face collapsed = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {1, 1, 0}}};
  double behind[3] = {3, 3, 1};
  ct_project_options options = ct_project_options_default();
  options.method = CT_CERTIFIED;
  ct_projection out;
  tap_ok(ct_project(&collapsed, behind, &options, &out, NULL) == CT_OK && out.certified,
         "all points of a collapsed edge are closest, and the distance is proved");
  tap_close(out.distance, 3, 1e-14, "it is the distance from the corner");
  ct_face flat = parabolic_face(CT_T3, 0, 0);
  double above[3] = {0.25, 0.25, 1};
  ct_project(&flat, above, &options, &out, NULL);
  tap_ok(out.certified && out.evaluations < 20, "a plane needs no search (%d evaluations)",
         out.evaluations);
  double on[3] = {0.25, 0.25, 0};
  ct_project(&flat, on, &options, &out, NULL);
  tap_ok(out.certified && out.distance == 0, "nothing is closer than zero");
}

/* A Q8 or T6 face through points of a sphere, or of a cylinder, with the point near its centre: f
 * is nearly constant. */
static ct_face around(ct_face_kind kind, int sphere, double radius, double aside, double point[3])
{
  ct_face face = parabolic_face(kind, 0, 0);
  for (int i = 0; i < ct_face_node_count(kind); i++) {
    double *x = face.node[i];
    x[2] = sqrt(radius * radius - x[0] * x[0] - (sphere ? x[1] * x[1] : 0));
  }
  for (int k = 0; k < 3; k++) point[k] = uniform(aside);
  return face;
}

static void centres_of_curvature(void)
{
  const int trials = tap_times(TRIALS);
  score s = {0, 0, 0, 0};
  for (int trial = 0; trial < trials; trial++) {
    double point[3];
    ct_face face = around(trial % 2 ? CT_Q8 : CT_T6, trial % 4 < 2, 1.5 + fabs(uniform(2)),
                          pow(10, -1 - trial % 9), point);
    check_certificates(&face, point, 0, 64, &s);
  }
  report(&s, trials, trials - trials / 100, "Q8 and T6", "at the centre of curvature");
}

/* Near the surface a bound cannot give away any of the distance; one evaluation at the closest
 * point must suffice. */
static void near_the_surface(void)
{
  int certified = 0;
  long evaluations = 0, robust = 0;
  for (int trial = 0; trial < 400; trial++) {
    ct_face face = parabolic_face(CT_Q8, uniform(0.3), uniform(0.3));
    double xi[2] = {uniform(0.9), uniform(0.9)}, gap = pow(10, -3 - trial % 8),
           point[3] = {xi[0], xi[1], 0};
    for (int i = 0; i < 8; i++)
      for (int k = 0; k < 2; k++) face.node[i][k] += uniform(0.03);
    ct_project_options options = ct_project_options_default();
    ct_projection on, out;
    ct_project(&face, point, &options, &on, NULL);
    for (int k = 0; k < 3; k++) point[k] = on.point[k] + gap * on.normal[k];
    ct_project(&face, point, &options, &on, NULL);
    options.method = CT_CERTIFIED;
    ct_project(&face, point, &options, &out, NULL);
    certified += out.certified;
    evaluations += out.evaluations;
    robust += on.evaluations;
  }
  tap_ok(certified == 400, "%d of 400 points within 1e-3 to 1e-10 of the surface are certified",
         certified);
  tap_ok(evaluations <= robust + 440,
         "nearly all by one evaluation (%ld evaluations of certified, %ld of robust)", evaluations,
         robust);
}

/* The target (eq:certified-target). A closest point with the error `shift`: if it is proved all the
 * same, its distance must be that of the true one within half the tolerance. */
static void attack(const ct_face *face, const double point[3], double shift, int *proven, int *lies)
{
  ct_project_options options = ct_project_options_default();
  options.method = CT_CERTIFIED;
  ct_projection out;
  ct_patch patch;
  if (ct_project(face, point, &options, &out, NULL) != CT_OK ||
      ct_patch_init(&patch, face->kind, face->node, point) != CT_OK)
    return;
  double xi[2] = {out.xi[0] + uniform(shift), out.xi[1] + uniform(shift)},
         low = triangular(face->kind) ? 0 : -1;
  for (int a = 0; a < 2; a++) xi[a] = fmin(fmax(xi[a], low), 1);
  if (triangular(face->kind)) xi[1] = fmin(xi[1], 1 - xi[0]);
  double d[3], wrong = sqrt(ct_patch_value(&patch, xi, d));
  ct_closest count = {{0, 0}, {0, 0, 0}, 0, 0, 0};
  if (ct_proof_search(&patch, 1e-10, 2000, xi, &count) != CT_PROVEN) return;
  ++*proven;
  *lies += wrong > out.distance + 0.5e-10 * fmax(wrong, patch.size);
}

static void attacks(void)
{
  int proven = 0, lies = 0;
  for (int trial = 0; trial < 3000; trial++) {
    ct_face_kind kind = (ct_face_kind)(trial % 4);
    ct_face face = random_face(kind, 0.3);
    double point[3] = {uniform(1), uniform(1), uniform(1)}, thin = 1, scale = 1;
    if (trial % 6 == 1) face = parabolic_face(kind, uniform(4), uniform(4)), point[0] = 0;
    if (trial % 6 == 2)
      face = around(trial % 4 < 2 ? CT_Q8 : CT_T6, trial % 5 < 3, 1.5 + fabs(uniform(2)),
                    pow(10, -1 - trial % 9), point);
    if (trial % 6 == 3) thin = pow(10, uniform(6));
    if (trial % 6 == 4) scale = pow(10, uniform(60));
    if (trial % 6 == 5)
      for (int k = 0; k < 3; k++) face.node[1][k] = face.node[0][k];
    for (int k = 0; k < 3; k++) {
      double s = k == 1 ? scale * thin : scale;
      for (int i = 0; i < 8; i++) face.node[i][k] *= s;
      point[k] *= s;
    }
    attack(&face, point, pow(10, -trial % 13), &proven, &lies);
  }
  tap_ok(lies == 0 && proven > 300,
         "3000 closest points that are moved by 1 to 1e-12: %d are good enough to be proved, %d of "
         "them wrongly",
         proven, lies);
}

/* A face of a family: bent, folded, with coinciding nodes, on a line, stretched, or with mid-side
 * nodes near the quarter points. */
static ct_face face_of_family(int family, ct_face_kind kind)
{
  static const double amount[6] = {0.62, 1.0, 0.3, 0.5, 0.4, 0.2};
  ct_face face = random_face(kind, amount[family]);
  int n = ct_face_node_count(kind), corners = triangular(kind) ? 3 : 4;
  double along[3] = {uniform(1), uniform(1), uniform(1)}, small = pow(10, -6 + uniform(3)),
         large = pow(10, 3 + uniform(3)), quarter = 0.25 + uniform(0.15);
  int i = (int)(fabs(uniform(1)) * n), j = (int)(fabs(uniform(1)) * n);
  if (family == 2) memcpy(face.node[i], face.node[j], sizeof face.node[i]);
  for (int a = 0; a < n; a++) {
    double *x = face.node[a], s = x[0];
    for (int k = 0; family == 3 && k < 3; k++) x[k] = s * along[k] + small * x[k];
    if (family == 4) x[0] *= large;
    if (family != 5 || a < corners) continue;
    const double *b = face.node[a - corners], *c = face.node[(a - corners + 1) % corners];
    for (int k = 0; k < 3; k++) x[k] = b[k] + quarter * (c[k] - b[k]);
  }
  return face;
}

/* The robust search reports success only if nothing is closer; otherwise it says so. */
static void robust_is_right(void)
{
  enum { CASES = 24000 };
  int wrong = 0, ok = 0;
  for (int i = 0; i < CASES; i++) {
    ct_face face = face_of_family(i % 6, i / 6 % 3 == 0 ? CT_Q8 : CT_T6);
    ct_project_options options = ct_project_options_default();
    ct_projection robust, certified;
    double far = i % 2 ? 1.0 : 3.0, point[3] = {uniform(far), uniform(far), uniform(far)};
    if (ct_project(&face, point, &options, &robust, NULL) != CT_OK) continue;
    options.method = CT_CERTIFIED;
    ct_project(&face, point, &options, &certified, NULL);
    ok++;
    wrong += robust.distance > certified.distance * (1 + 1e-7);
  }
  tap_ok(wrong == 0 && ok > CASES / 2,
         "robust: of %d folded, collapsed and thin faces %d are ok, %d of them wrongly", CASES, ok,
         wrong);
}

int main(void)
{
  for (int k = 0; k < 4; k++) {
    ct_face_kind kind = (ct_face_kind)k;
    random_faces(kind, triangular(kind) ? 0.2 : 0.4, 1.5, "distorted");
    random_faces(kind, triangular(kind) ? 0.1 : 0.2, 1e3, "far away");
    if (kind == CT_Q8 || kind == CT_T6) folded_faces(kind);
  }
  degenerate_faces();
  narrow_valleys();
  many_feet();
  centres_of_curvature();
  near_the_surface();
  attacks();
  robust_is_right();
  return tap_done();
}
