#include "shape.h"
#include "../base/error.h"

#include <math.h>

/* Product of a rule with n points x, weights w, along each of `dimensions` axes, xi_1 fastest. */
static void product_rule(int dimensions, int n, const double *x, const double *w, ct_rule *rule)
{
  for (int k = 0; k < (dimensions == 3 ? n : 1); k++)
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        // -- Next point of the product rule
        double *xi = rule->xi[rule->count];
        xi[0] = x[i];
        xi[1] = x[j];
        xi[2] = dimensions == 3 ? x[k] : 0;
        // (eq:quadrature-product)
        rule->weight[rule->count++] = (w[i] * w[j]) * (dimensions == 3 ? w[k] : 1);
      }
}

/* Product of the Gauss-Legendre rule with two or three points. */
static void gauss_product(int dimensions, int n, ct_rule *rule)
{
  // -- Roots of the Legendre polynomials, and weights
  static const double NODE[2][3] = {
      {-0.577350269189625765, 0.577350269189625765}, // (eq:quadrature-gauss)
      {-0.774596669241483377, 0, 0.774596669241483377}};
  static const double WEIGHT[2][3] = {
      {1, 1}, {0.555555555555555556, 0.888888888888888889, 0.555555555555555556}};
  product_rule(dimensions, n, NODE[n - 2], WEIGHT[n - 2], rule);
}

/* Append the three points (a, a), (1 - 2a, a), (a, 1 - 2a) of a triangle, each with weight w. */
static void add_orbit(ct_rule *rule, double a, double w)
{
  for (int i = 0; i < 3; i++) {
    // -- Next point of the orbit (eq:quadrature-orbit)
    double *xi = rule->xi[rule->count];
    xi[0] = i == 1 ? 1 - 2 * a : a;
    xi[1] = i == 2 ? 1 - 2 * a : a;
    xi[2] = 0;
    rule->weight[rule->count++] = w;
  }
}

ct_status ct_rule_face(ct_face_kind kind, ct_rule *rule, ct_error *error)
{
  if (rule == NULL) return CT_REFUSE_NULL(error);
  rule->count = 0;
  if (kind == CT_Q4 || kind == CT_Q8) {
    gauss_product(2, kind == CT_Q4 ? 2 : 3, rule);
    return CT_OK;
  }
  // -- Symmetric rules of a triangle
  if (kind == CT_T3) {
    add_orbit(rule, 1.0 / 6, 1.0 / 6); // (eq:quadrature-triangle)
  } else if (kind == CT_T6) {
    double root = sqrt(38 - 44 * sqrt(0.4)), share = sqrt(213125 - 53320 * sqrt(10));
    add_orbit(rule, (8 - sqrt(10) + root) / 18, (620 + share) / 7440);
    add_orbit(rule, (8 - sqrt(10) - root) / 18, (620 - share) / 7440);
  }
  return rule->count > 0 ? CT_OK
                         : CT_REFUSE(error, "rule: there is no face of the kind %d", (int)kind);
}

ct_status ct_rule_lobatto(ct_face_kind kind, ct_rule *rule)
{
  static const double place[3] = {-1.0, 0.0, 1.0}, weight[3] = {1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0};
  if (rule == NULL) return CT_ERROR_ARGUMENT;
  rule->count = 0;
  if (ct_face_node_count(kind) == 0) return CT_ERROR_ARGUMENT;
  // -- Corners, middles of edges, centre
  if (kind == CT_T3 || kind == CT_T6) {
    add_orbit(rule, 0.0, 1.0 / 40); // (eq:quadrature-lobatto)
    add_orbit(rule, 0.5, 1.0 / 15);
    rule->xi[6][0] = rule->xi[6][1] = 1.0 / 3;
    rule->xi[6][2] = 0;
    rule->weight[rule->count++] = 9.0 / 40;
    return CT_OK;
  }
  product_rule(2, 3, place, weight, rule);
  return CT_OK;
}

ct_status ct_rule_brick(ct_brick_kind kind, ct_rule *rule)
{
  if (rule == NULL) return CT_ERROR_ARGUMENT;
  rule->count = 0;
  const ct_brick_facts *facts = ct_brick_facts_of(kind);
  if (facts == NULL) return CT_ERROR_ARGUMENT;
  gauss_product(3, facts->points, rule);
  return CT_OK;
}
