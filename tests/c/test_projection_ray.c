/* Lines and faces against closed forms: planes and parabolic cylinders, hits, misses, edges and
 * lines that touch. */
#include "../../libcontact/src/projection/ray.c"
#include "../../libcontact/src/shape/shape.h"
#include "faces.h"
#include "tap.h"

#include <libcontact/ray.h>

/* The result for one line. */
static ct_status ray(const ct_face *face, const double point[3], const double direction[3],
                     double tolerance, ct_ray_hit *out)
{
  ct_status status = ct_project_rays(face, 1, point, direction, tolerance, out, NULL);
  return status == CT_OK ? out->status : status;
}

/* Does the reference point lie on the face, within the slack? */
static int on_face(ct_face_kind kind, double x, double y, double slack)
{
  if (triangular(kind)) return x >= -slack && y >= -slack && x + y <= 1 + slack;
  return fabs(x) <= 1 + slack && fabs(y) <= 1 + slack;
}

/* What one look at a square of a bent face tells, against the rules written out: the components
 * across the line (eq:ray-across) with their bounds (eq:ray-bend), no root (eq:ray-empty,
 * eq:ray-mixed), or one at most (eq:ray-unique). */
static void squares(void)
{
  int unlike = 0, told[3] = {0, 0, 0};
  for (int trial = 0; trial < 20000; trial++) {
    ct_face face = random_face(CT_Q8, 0.3);
    double point[3] = {uniform(0.5), uniform(0.5), uniform(0.3)}, t[2][3], y[3], G[2], dG[2][2],
           A[3], R[2] = {0}, P[2][2], g[2], D[2][2], one = 0,
           e[3] = {uniform(0.5), uniform(0.5), 1 + uniform(0.5)};
    square q = {{uniform(0.7), uniform(0.7)}, ldexp(0.6, -(trial % 4))};
    int none = 0;
    ct_patch patch;
    ct_patch_init(&patch, CT_Q8, face.node, point);
    sight s = {.patch = &patch};
    sight_along(&s, e);
    ct_segment_point(&face, q.centre, y);
    ct_segment_tangents(&face, q.centre, t[0], t[1]);
    for (int i = 0; i < 2; i++) {
      const double *u = s.across[i];
      double c[8], d[3] = {y[0] - point[0], y[1] - point[1], y[2] - point[2]};
      g[i] = ct_vector_dot(u, d);
      for (int j = 0; j < 8; j++) c[j] = fabs(ct_vector_dot(u, patch.c[j]));
      A[0] = 2 * c[4] + 2 * c[6], A[1] = 2 * c[5] + 2 * c[7], A[2] = c[3] + 2 * c[6] + 2 * c[7];
      R[i] = (A[0] / 2 + A[1] / 2 + A[2]) * q.half * q.half;
      for (int a = 0; a < 2; a++) D[i][a] = ct_vector_dot(u, t[a]);
      none |= fabs(g[i]) > (fabs(D[i][0]) + fabs(D[i][1])) * q.half + R[i];
    }
    double determinant = D[0][0] * D[1][1] - D[0][1] * D[1][0];
    P[0][0] = D[1][1] / determinant, P[0][1] = -D[0][1] / determinant;
    P[1][0] = -D[1][0] / determinant, P[1][1] = D[0][0] / determinant;
    for (int a = 0; a < 2; a++) {
      double bend = fabs(P[a][0]) * R[0] + fabs(P[a][1]) * R[1];
      none |= fabs(P[a][0] * g[0] + P[a][1] * g[1]) > q.half + bend;
      one = fmax(one, 2 / q.half * bend);
    }
    square_class wanted = none ? NONE : one < 0.5 ? ONE_AT_MOST : UNKNOWN;
    unlike += classify(&s, &q, G, dG) != wanted;
    told[wanted]++;
  }
  tap_ok(unlike == 0, "%d squares without a root, %d with one at most, %d to be cut", told[0],
         told[1], told[2]);
}

/* On z = p x^2 / 2 (a plane for p = 0) the distance along the line solves a quadratic equation. So
 * the equations across the line (eq:ray-across), the bounds (eq:ray-bend), the squares without a
 * root (eq:ray-empty, eq:ray-mixed) or with at most one (eq:ray-unique), and Newton's step
 * (eq:ray-newton) lose no hit and invent none. */
static void parabolic_cylinder(ct_face_kind kind, double p)
{
  ct_face face = parabolic_face(kind, p, 0);
  double error = 0, normal = 0;
  int wrong = 0, hits = 0, misses = 0, twice = 0;
  for (int trial = 0; trial < 2000; trial++) {
    double o[3] = {uniform(1.2), uniform(1.2), uniform(1)},
           e[3] = {uniform(1), uniform(1), uniform(1)}, way = HUGE_VAL;
    double length = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]),
           u[3] = {e[0] / length, e[1] / length, e[2] / length};
    double a = 0.5 * p * u[0] * u[0], b = p * o[0] * u[0] - u[2], c = 0.5 * p * o[0] * o[0] - o[2],
           root = b * b - 4 * a * c;
    if (root < 1e-4 || fabs(b) < 1e-2) continue;
    double q = -0.5 * (b + copysign(sqrt(root), b)), lambda[2] = {c / q, a != 0 ? q / a : HUGE_VAL};
    int close = 0, found = 0;
    for (int i = 0; i < 2; i++) {
      if (!(fabs(lambda[i]) < 1e6)) continue;
      double x = o[0] + lambda[i] * u[0], y = o[1] + lambda[i] * u[1];
      close |= on_face(kind, x, y, 1e-6) != on_face(kind, x, y, -1e-6);
      if (!on_face(kind, x, y, 0)) continue;
      found++;
      if (fabs(lambda[i]) < fabs(way)) way = lambda[i];
    }
    if (close || (found == 2 && fabs(fabs(lambda[0]) - fabs(lambda[1])) < 1e-6)) continue;
    ct_ray_hit out;
    ct_status status = ray(&face, o, e, 1e-10, &out);
    if (found == 0) {
      misses++;
      wrong += status != CT_NO_CONVERGENCE || !isnan(out.distance) || out.where != CT_OUTSIDE;
      continue;
    }
    hits++, twice += found == 2;
    wrong += status != CT_OK || out.where == CT_OUTSIDE;
    error = worst(error, out.distance - way);
    for (int k = 0; k < 3; k++) error = worst(error, out.point[k] - (o[k] + way * u[k]));
    for (int k = 0; k < 2; k++) error = worst(error, out.xi[k] - (o[k] + way * u[k]));
    double n = sqrt(1 + p * p * out.xi[0] * out.xi[0]);
    normal = worst(worst(normal, out.normal[0] + p * out.xi[0] / n), out.normal[2] - 1 / n);
  }
  tap_ok(wrong == 0 && hits > 80 && misses > 80,
         "%s, p = %g: %d hits (%d of them twice) and %d misses are distinguished", FACE_NAME[kind],
         p, hits, twice, misses);
  tap_close(error, 0, 1e-12, "%s, p = %g: the hits and their distances", FACE_NAME[kind], p);
  tap_close(normal, 0, 1e-13, "%s, p = %g: their normals", FACE_NAME[kind], p);
}

/* From a point at height g over the closest point, the line along the normal comes back to the
 * closest point. */
static void back_along_the_normal(ct_face_kind kind)
{
  double error = 0;
  int bad = 0;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face = random_face(kind, triangular(kind) ? 0.05 : 0.1);
    double xi[2], y[3], n[3], point[3], g = uniform(0.2);
    random_xi(kind, 0.05, xi);
    ct_segment_point(&face, xi, y);
    ct_segment_normal(&face, xi, n);
    for (int k = 0; k < 3; k++) point[k] = y[k] + g * n[k];
    ct_ray_hit out;
    bad += ray(&face, point, n, 1e-10, &out) != CT_OK;
    error = worst(error, out.distance + g);
    for (int a = 0; a < 2; a++) error = worst(error, out.xi[a] - xi[a]);
  }
  tap_ok(bad == 0, "%s: the line along the normal meets the face", FACE_NAME[kind]);
  tap_close(error, 0, 1e-13, "%s: at the closest point, after the gap", FACE_NAME[kind]);
}

static void edges_and_touches(void)
{
  ct_face flat = parabolic_face(CT_Q4, 0, 0), cup = parabolic_face(CT_Q8, 1, 0.5);
  double corner[3] = {1, 1, 2}, edge[3] = {0.25, -1, -0.5}, beside[3] = {1.0001, 0, 1},
         down[3] = {0, 0, -8}, up[3] = {0, 0, 1};
  ct_ray_hit out;
  tap_ok(ray(&flat, corner, down, 1e-10, &out) == CT_OK && out.where == CT_VERTEX && out.index == 2,
         "a corner is hit");
  tap_close(out.distance, 2, 1e-15, "after its height");
  tap_ok(ray(&flat, edge, down, 1e-10, &out) == CT_OK && out.where == CT_EDGE && out.index == 0,
         "an edge is hit");
  tap_close(out.distance, -0.5, 1e-15, "behind the point");
  tap_ok(ray(&flat, beside, up, 1e-10, &out) == CT_NO_CONVERGENCE && isnan(out.xi[0]),
         "a line beside the face is a miss");
  ct_status parallel = ray(&flat, up, (double[3]){1, 2, 0}, 1e-10, &out);
  tap_ok(parallel == CT_NO_CONVERGENCE && out.evaluations < 10,
         "a line parallel to a plane misses it (%d evaluations)", out.evaluations);
  double below[3] = {-0.3, 0.1, 0}, along[3] = {1, 0, 0}, centre[3] = {-0.5, 0, 0},
         low[3] = {0, 0, -0.01};
  tap_ok(ray(&flat, below, along, 1e-10, &out) == CT_NOT_CERTIFIED && isfinite(out.distance),
         "a line in the face has no clear hit");
  ct_status touch = ray(&cup, centre, along, 1e-10, &out);
  tap_ok((touch == CT_NOT_CERTIFIED || touch == CT_OK) && fabs(out.xi[0]) < 1e-6,
         "a line that touches the bottom of a cup: %s", ct_status_name(touch));
  tap_ok(ray(&cup, low, along, 1e-10, &out) == CT_NO_CONVERGENCE, "a line below it misses");
}

static void bad_input(void)
{
  ct_face flat = parabolic_face(CT_Q4, 0, 0), odd = flat;
  double point[3] = {0, 0, 1}, up[3] = {0, 0, 1}, none[3] = {0, 0, 0}, nan[3] = {0, NAN, 1},
         infinite[3] = {0, INFINITY, 1}, long_[3] = {1e300, 0, -1e308};
  ct_ray_hit out;
  tap_ok(ray(&flat, point, none, 1e-10, &out) == CT_INVALID && isnan(out.distance),
         "a direction without length");
  tap_ok(ray(&flat, point, nan, 1e-10, &out) == CT_INVALID &&
             ray(&flat, nan, up, 1e-10, &out) == CT_INVALID,
         "NaN");
  tap_ok(ray(&flat, point, infinite, 1e-10, &out) == CT_INVALID, "an infinite direction");
  tap_ok(ray(&flat, point, long_, 1e-10, &out) == CT_OK && fabs(out.distance - 1) < 1e-15,
         "a very long direction is accepted");
  odd.kind = (ct_face_kind)9;
  tap_ok(ray(&odd, point, up, 1e-10, &out) == CT_ERROR_ARGUMENT &&
             ray(NULL, point, up, 1e-10, &out) == CT_ERROR_ARGUMENT,
         "no face");
  tap_ok(ray(&flat, point, up, 0, &out) == CT_ERROR_ARGUMENT &&
             ray(&flat, point, up, NAN, &out) == CT_ERROR_ARGUMENT,
         "no tolerance");
  tap_ok(ray(&flat, point, up, 1e-10, NULL) == CT_ERROR_ARGUMENT, "a null output");
  double points[6] = {0, 0, 1, 0.5, 0.5, -2}, ups[6] = {0, 0, 1, 0, 0, 1};
  ct_ray_hit two[2];
  tap_ok(ct_project_rays(&flat, 2, points, ups, 1e-10, two, NULL) == CT_OK &&
             two[0].distance == -1 && two[1].distance == 2,
         "two lines in one call");
}

int main(void)
{
  squares();
  for (int k = 0; k < 4; k++) {
    parabolic_cylinder((ct_face_kind)k, 0);
    if (k == CT_Q8 || k == CT_T6)
      parabolic_cylinder((ct_face_kind)k, 1.5), parabolic_cylinder((ct_face_kind)k, -0.7);
    back_along_the_normal((ct_face_kind)k);
  }
  edges_and_touches();
  bad_input();
  return tap_done();
}
