#include <libcontact/shape.h>

#include <math.h>

/* Half of each Gauss-Legendre rule: the nodes x >= 0, ascending, and their weights. */
static const double NODE[10][5] = {
    {0},
    {0.577350269189625765},
    {0, 0.774596669241483377},
    {0.339981043584856265, 0.861136311594052575},
    {0, 0.538469310105683091, 0.906179845938663993},
    {0.238619186083196909, 0.661209386466264514, 0.932469514203152028},
    {0, 0.405845151377397167, 0.741531185599394440, 0.949107912342758525},
    {0.183434642495649805, 0.525532409916328986, 0.796666477413626740, 0.960289856497536232},
    {0, 0.324253423403808929, 0.613371432700590397, 0.836031107326635794, 0.968160239507626090},
    {0.148874338981631211, 0.433395394129247191, 0.679409568299024406, 0.865063366688984511,
     0.973906528517171720}};
static const double WEIGHT[10][5] = {
    {2},
    {1},
    {0.888888888888888889, 0.555555555555555556},
    {0.652145154862546143, 0.347854845137453857},
    {0.568888888888888889, 0.478628670499366468, 0.236926885056189088},
    {0.467913934572691047, 0.360761573048138608, 0.171324492379170345},
    {0.417959183673469388, 0.381830050505118945, 0.279705391489276668, 0.129484966168869693},
    {0.362683783378361983, 0.313706645877887287, 0.222381034453374471, 0.101228536290376259},
    {0.330239355001259763, 0.312347077040002840, 0.260610696402935462, 0.180648160694857404,
     0.0812743883615744120},
    {0.295524224714752870, 0.269266719309996355, 0.219086362515982044, 0.149451349150580593,
     0.0666713443086881376}};

ct_status ct_gauss_legendre(int n, double *x, double *w)
{
  if (n < 1 || n > 10 || x == NULL || w == NULL) return CT_ERROR_ARGUMENT;
  // -- Unfold the half rule about the origin (eq:quadrature-gauss)
  int half = n / 2, odd = n % 2;
  for (int i = 0; i < half + odd; i++) {
    x[half + i] = NODE[n - 1][i];
    w[half + i] = WEIGHT[n - 1][i];
  }
  for (int i = 0; i < half; i++) {
    x[i] = -x[n - 1 - i];
    w[i] = w[n - 1 - i];
  }
  return CT_OK;
}

/* Product of a rule with n points x, weights w, along each of `dimensions` axes, xi_1 fastest. */
static void product_rule(int dimensions, int n, const double *x, const double *w, ct_rule *rule)
{
  for (int k = 0; k < (dimensions == 3 ? n : 1); k++)
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        // -- Next point of the product rule (eq:quadrature-product)
        double *xi = rule->xi[rule->count];
        xi[0] = x[i];
        xi[1] = x[j];
        xi[2] = dimensions == 3 ? x[k] : 0;
        rule->weight[rule->count++] = (w[i] * w[j]) * (dimensions == 3 ? w[k] : 1);
      }
}

static void gauss_product(int dimensions, int n, ct_rule *rule)
{
  double x[10], w[10];
  ct_gauss_legendre(n, x, w);
  product_rule(dimensions, n, x, w, rule);
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

static void add_centroid(ct_rule *rule, double w)
{
  double *xi = rule->xi[rule->count];
  xi[0] = xi[1] = 1.0 / 3;
  xi[2] = 0;
  rule->weight[rule->count++] = w;
}

static ct_status triangle_rule(int points, ct_rule *rule)
{
  // -- Symmetric rules of a triangle (eq:quadrature-triangle)
  if (points == 1) {
    add_centroid(rule, 0.5);
  } else if (points == 3) {
    add_orbit(rule, 1.0 / 6, 1.0 / 6);
  } else if (points == 6) {
    double root = sqrt(38 - 44 * sqrt(0.4)), share = sqrt(213125 - 53320 * sqrt(10));
    add_orbit(rule, (8 - sqrt(10) + root) / 18, (620 + share) / 7440);
    add_orbit(rule, (8 - sqrt(10) - root) / 18, (620 - share) / 7440);
  } else if (points == 7) {
    add_centroid(rule, 9.0 / 80);
    add_orbit(rule, (6 - sqrt(15)) / 21, (155 - sqrt(15)) / 2400);
    add_orbit(rule, (6 + sqrt(15)) / 21, (155 + sqrt(15)) / 2400);
  } else {
    return CT_ERROR_ARGUMENT;
  }
  return CT_OK;
}

ct_status ct_rule_face(ct_face_kind kind, int points, ct_rule *rule)
{
  if (rule == NULL) return CT_ERROR_ARGUMENT;
  rule->count = 0;
  switch (kind) {
  case CT_T3:
    return triangle_rule(points == 0 ? 3 : points, rule);
  case CT_T6:
    return triangle_rule(points == 0 ? 6 : points, rule);
  case CT_Q4:
  case CT_Q8:
    if (points == 0) points = kind == CT_Q4 ? 2 : 3;
    if (points < 1 || points > 5) return CT_ERROR_ARGUMENT;
    gauss_product(2, points, rule);
    return CT_OK;
  }
  return CT_ERROR_ARGUMENT;
}

ct_status ct_rule_lobatto(ct_face_kind kind, ct_rule *rule)
{
  static const double place[3] = {-1.0, 0.0, 1.0}, weight[3] = {1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0};
  if (rule == NULL) return CT_ERROR_ARGUMENT;
  rule->count = 0;
  if (ct_face_node_count(kind) == 0) return CT_ERROR_ARGUMENT;
  // -- Corners, middles of edges, centre (eq:quadrature-lobatto)
  if (kind == CT_T3 || kind == CT_T6) {
    add_orbit(rule, 0.0, 1.0 / 40);
    add_orbit(rule, 0.5, 1.0 / 15);
    add_centroid(rule, 9.0 / 40);
    return CT_OK;
  }
  product_rule(2, 3, place, weight, rule);
  return CT_OK;
}

ct_status ct_rule_brick(ct_brick_kind kind, ct_rule *rule)
{
  if (rule == NULL) return CT_ERROR_ARGUMENT;
  rule->count = 0;
  if (ct_brick_node_count(kind) == 0) return CT_ERROR_ARGUMENT;
  gauss_product(3, kind == CT_HEX8 ? 2 : 3, rule);
  return CT_OK;
}
