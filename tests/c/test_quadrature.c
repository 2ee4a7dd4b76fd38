/* Quadrature rules against the closed-form integrals of monomials. */
#include <libcontact/shape.h>

#include "tap.h"

static double power(double x, int n) { return n == 0 ? 1 : x * power(x, n - 1); }

/* Integral of x^n over [-1, 1]. */
static double line(int n) { return n % 2 ? 0 : 2.0 / (n + 1); }

/* Integral of r^a s^b over the triangle: a! b! / (a + b + 2)!. */
static double triangle(int a, int b)
{
  double value = 1;
  for (int k = 1; k <= b; k++) value *= (double)k / (a + k);
  return value / ((a + b + 1.0) * (a + b + 2.0));
}

static double integrate(const ct_rule *rule, int a, int b, int c)
{
  double sum = 0;
  for (int p = 0; p < rule->count; p++)
    sum += rule->weight[p] * power(rule->xi[p][0], a) * power(rule->xi[p][1], b) *
           power(rule->xi[p][2], c);
  return sum;
}

static void gauss_legendre(int n)
{
  double x[10], w[10], error = 0, beyond = 0;
  int symmetric = 1, inside = 1;
  tap_ok(ct_gauss_legendre(n, x, w) == CT_OK, "%d Gauss points", n);
  for (int degree = 0; degree <= 2 * n; degree++) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += w[i] * power(x[i], degree);
    if (degree < 2 * n) error = fmax(error, fabs(sum - line(degree)));
    else beyond = fabs(sum - line(degree));
  }
  for (int i = 0; i < n; i++) {
    if (x[i] != -x[n - 1 - i] || w[i] != w[n - 1 - i]) symmetric = 0;
    if (fabs(x[i]) >= 1 || w[i] <= 0 || (i > 0 && x[i] <= x[i - 1])) inside = 0;
  }
  tap_close(error, 0, 1e-15, "%d Gauss points are exact to degree %d", n, 2 * n - 1);
  /* The remainder for x^(2n): the square of the norm of the monic Legendre polynomial. */
  double factor = 1;
  for (int k = 1; k <= n; k++) factor *= (double)k / (2 * k - 1);
  tap_close(beyond, 2 * factor * factor / (2 * n + 1), 1e-15,
            "%d Gauss points have the remainder of theory at degree %d", n, 2 * n);
  tap_ok(symmetric, "%d Gauss points are exactly antisymmetric", n);
  tap_ok(inside, "%d Gauss points ascend inside the interval with positive weights", n);
}

static void quadrilateral_rule(ct_face_kind kind, int points, int n)
{
  ct_rule rule;
  double error = 0;
  tap_ok(ct_rule_face(kind, points, &rule) == CT_OK && rule.count == n * n,
         "%d x %d points of a quadrilateral", n, n);
  for (int a = 0; a < 2 * n; a++)
    for (int b = 0; b < 2 * n; b++)
      error = fmax(error, fabs(integrate(&rule, a, b, 0) - line(a) * line(b)));
  tap_close(error, 0, 4e-15, "%d x %d points are exact to degree %d in each direction", n, n,
            2 * n - 1);
  int order = 1;
  for (int p = 0; p < rule.count; p++)
    order &=
        p % n == 0 || (rule.xi[p][0] > rule.xi[p - 1][0] && rule.xi[p][1] == rule.xi[p - 1][1]);
  tap_ok(order, "%d x %d points run with xi_1 fastest", n, n);
}

static void triangle_rule(ct_face_kind kind, int points, int count, int degree)
{
  ct_rule rule;
  double error = 0, beyond = 0;
  tap_ok(ct_rule_face(kind, points, &rule) == CT_OK && rule.count == count,
         "%d points of a triangle", count);
  for (int a = 0; a <= degree + 1; a++)
    for (int b = 0; a + b <= degree + 1; b++) {
      double off = fabs(integrate(&rule, a, b, 0) - triangle(a, b));
      if (a + b <= degree) error = fmax(error, off);
      else beyond = fmax(beyond, off);
    }
  tap_close(error, 0, 1e-15, "%d points are exact to degree %d", count, degree);
  tap_ok(beyond > 1e-6, "%d points are not exact to degree %d", count, degree + 1);
  int inside = 1;
  for (int p = 0; p < count; p++)
    inside &= rule.xi[p][0] > 0 && rule.xi[p][1] > 0 && rule.xi[p][0] + rule.xi[p][1] < 1 &&
              rule.weight[p] > 0;
  tap_ok(inside, "%d points lie inside with positive weights", count);
}

static void brick_rule(ct_brick_kind kind, int n)
{
  ct_rule rule;
  double error = 0;
  tap_ok(ct_rule_brick(kind, &rule) == CT_OK && rule.count == n * n * n, "%d^3 points of a brick",
         n);
  for (int a = 0; a < 2 * n; a++)
    for (int b = 0; b < 2 * n; b++)
      for (int c = 0; c < 2 * n; c++)
        error = fmax(error, fabs(integrate(&rule, a, b, c) - line(a) * line(b) * line(c)));
  tap_close(error, 0, 1e-14, "%d^3 points are exact to degree %d in each direction", n, 2 * n - 1);
  int order = 1;
  for (int p = 0; p < rule.count; p++) order &= p < n * n || rule.xi[p][2] > rule.xi[p - n * n][2];
  tap_ok(order && rule.xi[1][0] > rule.xi[0][0],
         "%d^3 points run with xi_1 fastest and xi_3 slowest", n);
}

int main(void)
{
  for (int n = 1; n <= 10; n++) gauss_legendre(n);
  for (int n = 1; n <= 5; n++) quadrilateral_rule(CT_Q4, n, n);
  quadrilateral_rule(CT_Q4, 0, 2);
  quadrilateral_rule(CT_Q8, 0, 3);
  triangle_rule(CT_T3, 1, 1, 1);
  triangle_rule(CT_T3, 0, 3, 2);
  triangle_rule(CT_T6, 0, 6, 4);
  triangle_rule(CT_T6, 7, 7, 5);
  brick_rule(CT_HEX8, 2);
  brick_rule(CT_HEX20, 3);
  double x[10], w[10];
  ct_rule rule;
  tap_ok(ct_gauss_legendre(0, x, w) == CT_ERROR_ARGUMENT &&
             ct_gauss_legendre(11, x, w) == CT_ERROR_ARGUMENT,
         "no rule with 0 or 11 points");
  tap_ok(ct_gauss_legendre(2, NULL, w) == CT_ERROR_ARGUMENT, "nowhere to put the nodes");
  tap_ok(ct_rule_face(CT_Q4, 6, &rule) == CT_ERROR_ARGUMENT && rule.count == 0, "no 6 x 6 points");
  tap_ok(ct_rule_face(CT_T6, 4, &rule) == CT_ERROR_ARGUMENT &&
             ct_rule_face((ct_face_kind)7, 0, &rule) == CT_ERROR_ARGUMENT,
         "no triangle with 4 points, no unknown face");
  tap_ok(ct_rule_brick((ct_brick_kind)7, &rule) == CT_ERROR_ARGUMENT &&
             ct_rule_brick(CT_HEX8, NULL) == CT_ERROR_ARGUMENT,
         "no unknown brick");
  return tap_done();
}
