/* One step of a body that turns: from its angular momentum to its rotation. */
#include "rotation.h"

#include <float.h>
#include <math.h>

/* Newton's method needs 3 to 6 rounds for less than a quarter turn. */
enum { MOST_ROUNDS = 40 };

void ct_inertia_times(const ct_inertia *inertia, const double w[3], double out[3])
{
  const double *J = inertia->moment;
  // -- Θ = tr(J) I - J (eq:rigid-inertia)
  out[0] = ((J[1] + J[2]) * w[0] - J[3] * w[1]) - J[5] * w[2];
  out[1] = ((J[2] + J[0]) * w[1] - J[4] * w[2]) - J[3] * w[0];
  out[2] = ((J[0] + J[1]) * w[2] - J[5] * w[0]) - J[4] * w[1];
}

/* Solve A x = g for the free components; the fixed ones of x are 0. Changes A. */
static void solve_free(const int fixed[3], double A[3][3], const double g[3], double x[3])
{
  double right[3], minor[3][3];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      if (fixed[i] || fixed[j]) A[i][j] = i == j ? 1.0 : 0.0;
    right[i] = fixed[i] ? 0.0 : g[i];
  }
  for (int i = 0; i < 3; i++) ct_vector_cross(A[(i + 1) % 3], A[(i + 2) % 3], minor[i]);
  const double det = ct_vector_dot(A[0], minor[0]);
  for (int j = 0; j < 3; j++)
    x[j] = ((right[0] * minor[0][j] + right[1] * minor[1][j]) + right[2] * minor[2][j]) / det;
}

/* The matrix of Θ. */
static void matrix_of(const ct_inertia *inertia, double A[3][3])
{
  for (int j = 0; j < 3; j++) {
    const double unit[3] = {j == 0, j == 1, j == 2};
    double column[3];
    ct_inertia_times(inertia, unit, column);
    for (int i = 0; i < 3; i++) A[i][j] = column[i];
  }
}

void ct_inertia_solve(const ct_inertia *inertia, const double g[3], double w[3])
{
  double A[3][3];
  matrix_of(inertia, A);
  solve_free(inertia->fixed, A, g, w);
}

/* The residual of the equation of the rotation, and its derivative with respect to b. */
static void linearise(const ct_inertia *inertia, const double g[3], const double b[3], double a,
                      double residual[3], double A[3][3])
{
  double h[3], turned[3];
  ct_inertia_times(inertia, b, h);
  ct_vector_cross(b, h, turned);
  // -- 2 (a Θ b + b × Θ b) = g (eq:rigid-rotation)
  for (int c = 0; c < 3; c++) residual[c] = 2.0 * (a * h[c] + turned[c]) - g[c];
  matrix_of(inertia, A);
  for (int j = 0; j < 3; j++) {
    const double unit[3] = {j == 0, j == 1, j == 2}, column[3] = {A[0][j], A[1][j], A[2][j]};
    double first[3], second[3];
    ct_vector_cross(unit, h, first);
    ct_vector_cross(b, column, second);
    // -- Its derivative, 2 (a Θ - Θ b bᵀ / a + [b] Θ - [Θ b]) (eq:rigid-newton)
    for (int i = 0; i < 3; i++)
      A[i][j] = 2.0 * ((a * column[i] - h[i] * b[j] / a) + (first[i] + second[i]));
  }
}

int ct_rotation_find(const ct_inertia *inertia, const double g[3], double b[3], double *a)
{
  double half[3] = {0.5 * g[0], 0.5 * g[1], 0.5 * g[2]}, before = INFINITY;
  ct_inertia_solve(inertia, half, b);
  for (int round = 0; round < MOST_ROUNDS; round++) {
    double residual[3], A[3][3], change[3], square = ct_vector_dot(b, b);
    if (!(square < 1.0)) return 0;
    *a = sqrt(1.0 - square);
    if (square == 0.0) return 1;
    linearise(inertia, g, b, *a, residual, A);
    solve_free(inertia->fixed, A, residual, change);
    double size = sqrt(ct_vector_dot(change, change));
    // -- Round-off is reached where the change no longer decreases
    if (size <= 64.0 * DBL_EPSILON * sqrt(square) && !(size < 0.5 * before)) return 1;
    for (int c = 0; c < 3; c++) b[c] -= change[c];
    before = size;
  }
  return 0;
}
