/* Faces for the tests of projections. */
#ifndef FACES_H
#define FACES_H

#include "function.h"
#include "uniform.h"

#include <math.h>

static const char *const FACE_NAME[4] = {"Q4", "Q8", "T3", "T6"};

static const char *const METHOD_NAME[] = {
    "simplex", "nelder_mead", "newton",    "least_squares",  "steepest_descent", "broyden",
    "bfgs",    "robust",      "certified", "simplex_newton", "sphere",           "torus"};

/* Number of methods. */
static inline int method_count(void) { return (int)(sizeof METHOD_NAME / sizeof METHOD_NAME[0]); }

static inline int triangular(ct_face_kind kind) { return kind == CT_T3 || kind == CT_T6; }

static inline const double *reference(ct_face_kind kind, int i)
{
  static const double quadrilateral[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                             {0, -1},  {1, 0},  {0, 1}, {-1, 0}};
  static const double triangle[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  return triangular(kind) ? triangle[i] : quadrilateral[i];
}

/* A random point of the reference face, `margin` away from its edges. */
static inline void random_xi(ct_face_kind kind, double margin, double xi[2])
{
  do {
    xi[0] = uniform(1 - margin), xi[1] = uniform(1 - margin);
  } while (triangular(kind) && (xi[0] < margin || xi[1] < margin || xi[0] + xi[1] > 1 - margin));
}

/* A face with nodes at random distances from their reference positions. */
static inline ct_face random_face(ct_face_kind kind, double amount)
{
  ct_face face = {kind, {{0}}};
  for (int i = 0; i < ct_face_node_count(kind); i++) {
    for (int k = 0; k < 2; k++) face.node[i][k] = reference(kind, i)[k] + uniform(amount);
    face.node[i][2] = uniform(amount);
  }
  return face;
}

/* The face z = (p x^2 + q y^2) / 2 over its reference square or triangle. */
static inline ct_face parabolic_face(ct_face_kind kind, double p, double q)
{
  ct_face face = {kind, {{0}}};
  for (int i = 0; i < ct_face_node_count(kind); i++) {
    const double *x = reference(kind, i);
    face.node[i][0] = x[0], face.node[i][1] = x[1],
    face.node[i][2] = 0.5 * (p * x[0] * x[0] + q * x[1] * x[1]);
  }
  return face;
}

/* The point at the height g above the closest point xi of a parabolic face, and the normal there.
 */
static inline void parabolic_point(double p, double q, const double xi[2], double g,
                                   double point[3], double n[3])
{
  double length = sqrt(1 + p * p * xi[0] * xi[0] + q * q * xi[1] * xi[1]);
  n[0] = -p * xi[0] / length, n[1] = -q * xi[1] / length, n[2] = 1 / length;
  point[0] = xi[0] + g * n[0], point[1] = xi[1] + g * n[1];
  point[2] = 0.5 * (p * xi[0] * xi[0] + q * xi[1] * xi[1]) + g * n[2];
}

/* Lowest f on a grid over the face. */
static inline double lowest_on_grid(const ct_face *face, const double point[3], int cells)
{
  double lowest = HUGE_VAL, f;
  int three = triangular(face->kind);
  for (int i = 0; i <= cells; i++)
    for (int j = 0; j <= (three ? cells - i : cells); j++) {
      double xi[2] = {(double)i / cells, (double)j / cells};
      if (!three) xi[0] = 2 * xi[0] - 1, xi[1] = 2 * xi[1] - 1;
      function_at(face, point, xi, &f, NULL, NULL);
      lowest = fmin(lowest, f);
    }
  return lowest;
}

#endif
