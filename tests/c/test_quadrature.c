/* Quadrature rules against the closed-form integrals of monomials. */
#include "../../libcontact/src/shape/shape.h"

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

/* Roots and weights of eq:quadrature-gauss, and their products along two axes
 * (eq:quadrature-product). */
static void quadrilateral_rule(ct_face_kind kind, int n)
{
  ct_rule rule;
  double error = 0;
  tap_ok(ct_rule_face(kind, &rule, NULL) == CT_OK && rule.count == n * n,
         "%d x %d points of a quadrilateral", n, n);
  for (int a = 0; a < 2 * n; a++)
    for (int b = 0; b < 2 * n; b++)
      error = fmax(error, fabs(integrate(&rule, a, b, 0) - line(a) * line(b)));
  tap_close(error, 0, 4e-15, "%d x %d points are exact to degree %d in each direction", n, n,
            2 * n - 1);
  /* The remainder for x^(2n): the square of the norm of the monic Legendre polynomial. */
  double factor = 1;
  for (int k = 1; k <= n; k++) factor *= (double)k / (2 * k - 1);
  tap_close(fabs(integrate(&rule, 2 * n, 0, 0) - 2 * line(2 * n)),
            4 * factor * factor / (2 * n + 1), 2e-15,
            "%d x %d points have the remainder of theory at degree %d", n, n, 2 * n);
  int order = 1;
  for (int p = 0; p < rule.count; p++)
    order &=
        p % n == 0 || (rule.xi[p][0] > rule.xi[p - 1][0] && rule.xi[p][1] == rule.xi[p - 1][1]);
  tap_ok(order, "%d x %d points run with xi_1 fastest", n, n);
}

/* Orbits (eq:quadrature-orbit) with the places and weights of eq:quadrature-triangle. */
static void triangle_rule(ct_face_kind kind, int count, int degree)
{
  ct_rule rule;
  double error = 0, beyond = 0;
  tap_ok(ct_rule_face(kind, &rule, NULL) == CT_OK && rule.count == count, "%d points of a triangle",
         count);
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

/* Products along three axes (eq:quadrature-product). */
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

/* Points at corners, middles of edges and centre (eq:quadrature-lobatto): exact for degree 3. */
static void rule_with_ends(ct_face_kind kind)
{
  ct_rule rule;
  double error = 0, least = 1;
  int corners = 0;
  tap_ok(ct_rule_lobatto(kind, &rule) == CT_OK, "a rule with points at the ends");
  for (int a = 0; a <= 3; a++)
    for (int b = 0; a + b <= 3; b++)
      error = fmax(error, fabs(integrate(&rule, a, b, 0) -
                               (kind == CT_T3 ? triangle(a, b) : line(a) * line(b))));
  for (int p = 0; p < rule.count; p++) {
    double x = rule.xi[p][0], y = rule.xi[p][1];
    least = fmin(least, rule.weight[p]);
    corners += kind == CT_T3 ? (x + y == 0) + (x == 1) + (y == 1) : fabs(x * y) == 1;
  }
  tap_close(error, 0, 1e-15, "it is exact to degree 3");
  tap_ok(least > 0 && corners == (kind == CT_T3 ? 3 : 4),
         "weights are positive, corners are points");
}

int main(void)
{
  quadrilateral_rule(CT_Q4, 2);
  quadrilateral_rule(CT_Q8, 3);
  triangle_rule(CT_T3, 3, 2);
  triangle_rule(CT_T6, 6, 4);
  rule_with_ends(CT_Q4);
  rule_with_ends(CT_T3);
  brick_rule(CT_HEX8, 2);
  brick_rule(CT_HEX20, 3);
  ct_rule rule;
  tap_ok(ct_rule_face((ct_face_kind)7, &rule, NULL) == CT_ERROR_ARGUMENT && rule.count == 0,
         "an unknown face is refused");
  tap_ok(ct_rule_brick((ct_brick_kind)7, &rule) == CT_ERROR_ARGUMENT &&
             ct_rule_brick(CT_HEX8, NULL) == CT_ERROR_ARGUMENT,
         "an unknown brick is refused");
  return tap_done();
}
