/* A certificate is never false: whatever is proven is compared with dense samples of the face. */
#include "faces.h"
#include "tap.h"

/* How many of `trials` are proven, how many of the proofs a grid refutes, and what they cost. */
typedef struct score {
  int proven, refuted, disagree, evaluations;
} score;

static void judge(const ct_face *face, const double point[3], int iteration_limit, int cells, score *s)
{
  ct_project_options options = ct_project_options_default();
  options.method = CT_CERTIFIED;
  options.iteration_limit = iteration_limit;
  ct_projection out;
  ct_project(face, point, &options, &out);
  if (out.status == CT_INVALID) return;
  s->proven += out.certified;
  s->disagree += (out.status == CT_OK) != (out.certified == 1) || (out.status != CT_OK && out.status != CT_NOT_CERTIFIED);
  s->evaluations = out.evaluations > s->evaluations ? out.evaluations : s->evaluations;
  if (!out.certified) return;
  double lowest = sqrt(lowest_on_grid(face, point, cells)), size = 0;
  for (int i = 0; i < ct_face_node_count(face->kind); i++)
    for (int k = 0; k < 3; k++) size = fmax(size, fabs(face->node[i][k] - face->node[0][k]));
  s->refuted += out.distance > lowest + 1e-10 * fmax(lowest, size);
}

static void report(const score *s, int trials, int least, const char *kind, const char *what)
{
  tap_ok(s->refuted == 0 && s->disagree == 0, "%s, %s: %d certificates, none is false", kind, what, s->proven);
  tap_ok(s->proven >= least, "%s, %s: %d of %d certified", kind, what, s->proven, trials);
}

static void random_faces(ct_face_kind kind, double amount, double far, const char *what)
{
  score s = {0, 0, 0, 0}, cut = s;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = random_face(kind, amount);
    double point[3] = {uniform(far), uniform(far), uniform(far)};
    judge(&face, point, 0, 64, &s);
    judge(&face, point, 1, 64, &cut);
  }
  report(&s, 300, 297, FACE_NAME[kind], what);
  report(&cut, 300, 0, FACE_NAME[kind], "robust stopped after one iteration");
}

/* Several valleys, two of them as deep as each other in every third case. */
static void folded_faces(ct_face_kind kind)
{
  score s = {0, 0, 0, 0};
  for (int trial = 0; trial < 300; trial++) {
    double p = uniform(4), q = uniform(4), point[3] = {uniform(2), uniform(2), uniform(2)};
    ct_face face = parabolic_face(kind, p, q);
    if (trial % 3 == 0 && kind == CT_Q8) point[0] = 0;
    judge(&face, point, 0, 96, &s);
  }
  report(&s, 300, 297, FACE_NAME[kind], "folded");
}

/* Two corners, an edge or two opposite edges in one place; quarter-point mid-sides; needles. */
static void degenerate_faces(void)
{
  score collapsed = {0, 0, 0, 0}, quarter = collapsed, needle = collapsed;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = random_face(CT_Q4, 0.4), crack = random_face(CT_Q8, 0.1), thin = random_face(trial % 2 ? CT_T6 : CT_Q8, 0.1);
    double point[3] = {uniform(1.5), uniform(1.5), uniform(1.5)};
    for (int k = 0; k < 3; k++) {
      face.node[trial % 4][k] = face.node[(trial + 1) % 4][k];
      crack.node[4][k] = 0.75 * crack.node[0][k] + 0.25 * crack.node[1][k];
      crack.node[7][k] = 0.75 * crack.node[0][k] + 0.25 * crack.node[3][k];
    }
    for (int i = 0; i < 8; i++) thin.node[i][1] *= 1e-5;
    judge(&face, point, 0, 64, &collapsed);
    judge(&crack, point, 0, 64, &quarter);
    judge(&thin, point, 0, 64, &needle);
  }
  report(&collapsed, 300, 295, "Q4", "collapsed");
  report(&quarter, 300, 295, "Q8", "quarter-point");
  report(&needle, 300, 290, "Q8 and T6", "aspect 1e5");
  tap_ok(collapsed.evaluations < 20000 && quarter.evaluations < 20000, "the budget holds");
}

static double f_at(const ct_face *face, const double point[3], double x, double y)
{
  double xi[2] = {x, y}, f;
  ct_project_function(face, point, xi, &f, NULL, NULL);
  return f;
}

/* Lowest f over xi_1 at the given xi_2 = y, or (outer) over xi_2 of that: a grid, and the golden section about its best place. */
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
    double fu = outer ? on_row(face, point, u, 0) : f_at(face, point, u, y), fv = outer ? on_row(face, point, v, 0) : f_at(face, point, v, y);
    lowest = fmin(lowest, fmin(fu, fv));
    if (fu < fv) b = v;
    else a = u;
  }
  return lowest;
}

static double on_row(const ct_face *face, const double point[3], double x, int outer) { return golden(face, point, x, outer, 32); }

/* Long thin faces: a narrow valley that winds, and a search that is stopped on its way. */
static void narrow_valleys(void)
{
  score s = {0, 0, 0, 0};
  int wrong = 0;
  for (int trial = 0; trial < 80; trial++) {
    ct_face face = random_face(trial % 2 ? CT_Q4 : CT_Q8, 0.2);
    double thin = pow(10, -3 - trial % 4), point[3] = {uniform(0.8), thin * uniform(1), thin * uniform(1)};
    for (int i = 0; i < 8; i++) face.node[i][1] *= thin, face.node[i][2] *= thin;
    double lowest = sqrt(golden(&face, point, 0, 1, 32));
    for (int limit = 0; limit < 3; limit++) {
      ct_project_options options = ct_project_options_default();
      ct_projection out;
      options.method = CT_CERTIFIED;
      options.iteration_limit = limit;
      ct_project(&face, point, &options, &out);
      s.proven += limit == 0 && out.certified;
      s.refuted += out.certified && out.distance > lowest + 1e-10;
      wrong += limit == 0 && !(out.distance <= lowest + 1e-10);
    }
  }
  report(&s, 80, 78, "Q4 and Q8", "1e3 to 1e6 times as long as wide");
  tap_ok(wrong <= 1, "the foot lies on the floor of the valley: %d of 80 are farther than a search line by line", wrong);
}

/* On a cylinder every height over the axis is as near as every other: a line of feet, and a distance that is certain. */
static void many_feet(void)
{
  ct_face collapsed = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {1, 1, 0}}};
  double behind[3] = {3, 3, 1};
  ct_project_options options = ct_project_options_default();
  options.method = CT_CERTIFIED;
  ct_projection out;
  tap_ok(ct_project(&collapsed, behind, &options, &out) == CT_OK && out.certified, "the whole of a collapsed edge is the foot, and the distance is proven");
  tap_close(out.distance, 3, 1e-14, "it is the distance from the corner");
  ct_face flat = parabolic_face(CT_T3, 0, 0);
  double above[3] = {0.25, 0.25, 1};
  ct_project(&flat, above, &options, &out);
  tap_ok(out.certified && out.evaluations < 20, "a plane needs no search (%d evaluations)", out.evaluations);
  double on[3] = {0.25, 0.25, 0};
  ct_project(&flat, on, &options, &out);
  tap_ok(out.certified && out.distance == 0, "nothing is closer than zero");
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
  return tap_done();
}
