/* Effect of an integrator's steps on an oscillation: the roots of its amplification matrix. */
#include "clock.h"

#include <complex.h>
#include <math.h>
#include <string.h>

typedef double complex ct_complex;

/* The amplification matrix of (u, Δt v, Δt² a⁻) minus the unit matrix, and its derivative by x =
 * Ω². */
typedef struct gain {
  double B[3][3], d[3][3];
} gain;

static gain stage_gain(const ct_stage *s, double x)
{
  // -- A stage of one oscillator (eq:dispersion-stage)
  return (gain){.B = {{-s->tau * s->r * x, s->tau, s->tau * s->l}, {-s->c * x}, {-x, 0.0, -1.0}},
                .d = {{-s->tau * s->r}, {-s->c}, {-1.0}}};
}

/* (1 + b)(1 + a) - 1: first a, then b. */
static gain after(const gain *b, const gain *a)
{
  gain out;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      out.B[i][j] = a->B[i][j] + b->B[i][j], out.d[i][j] = a->d[i][j] + b->d[i][j];
      for (int k = 0; k < 3; k++) {
        out.B[i][j] += b->B[i][k] * a->B[k][j];
        out.d[i][j] += b->d[i][k] * a->B[k][j] + b->B[i][k] * a->d[k][j];
      }
    }
  return out;
}

static gain step_gain(const ct_integrator *integrator, double x)
{
  ct_stage stage[2];
  gain all = {{{0.0}}, {{0.0}}};
  int count = ct_integrator_stages(integrator, stage);
  for (int s = 0; s < count; s++) {
    gain next = stage_gain(&stage[s], x);
    all = after(&next, &all);
  }
  return all;
}

/* The real root ρ <= 0 of the cubic that does not belong to a motion, and its derivative by x; 0 if
 * the step has no memory. */
static double memory_root(const gain *g, double *slope)
{
  const double (*B)[3] = g->B, (*d)[3] = g->d;
  *slope = 0.0;
  if (B[0][2] == 0.0) return 0.0;
  const double a = 1.0 + B[0][0], memory = B[0][2] * B[2][0];
  // (eq:dispersion-memory)
  const double I1 = a + 1.0, I2 = a - B[0][1] * B[1][0] - memory, I3 = -memory;
  const double d1 = d[0][0], d3 = -B[0][2] * d[2][0], d2 = d1 - B[0][1] * d[1][0] + d3;
  double low = -1.0 - fmax(fabs(I1), fmax(fabs(I2), fabs(I3))), high = 0.0;
  for (int i = 0; i < 120; i++) {
    double middle = 0.5 * (low + high);
    if (((middle - I1) * middle + I2) * middle - I3 < 0.0) low = middle;
    else high = middle;
  }
  *slope = ((d1 * high - d2) * high + d3) / ((3.0 * high - 2.0 * I1) * high + I2);
  return high;
}

ct_clock ct_clock_of(const ct_integrator *integrator, double Omega)
{
  if (Omega == 0.0) return (ct_clock){0.0, 0.0, 1.0};
  const gain g = step_gain(integrator, Omega * Omega);
  const double (*B)[3] = g.B, (*d)[3] = g.d;
  double z3_slope, z3 = memory_root(&g, &z3_slope);

  // -- The other two roots are 1 + m, m² - S m + D = 0 (eq:dispersion-quadratic)
  const double minor = B[0][0] * B[1][1] - B[0][1] * B[1][0] - B[0][2] * B[2][0];
  const double minor_slope = d[0][0] * B[1][1] + B[0][0] * d[1][1] - d[0][1] * B[1][0] -
                             B[0][1] * d[1][0] - B[0][2] * d[2][0];
  const double S = B[0][0] + B[1][1] - z3, D = minor - z3 - z3 * S;
  const double S_slope = d[0][0] + d[1][1] - z3_slope;
  const double D_slope = minor_slope - z3_slope - z3_slope * S - z3 * S_slope;
  const double inside = D - 0.25 * S * S;
  const double root = sqrt(fabs(inside));
  if (inside > 0.0) {
    const ct_complex m = 0.5 * S + root * I;
    const ct_complex slope =
        (S_slope * m - D_slope) / (2.0 * root * I) / (1.0 + m); // (eq:dispersion-slope)
    // Angle and damping (eq:dispersion-root)
    return (ct_clock){atan2(root, 1.0 + 0.5 * S), -0.5 * log1p(S + D), 2.0 * Omega * cimag(slope)};
  }
  // All roots are real: the largest dominates for long times.
  const double one = 1.0 + 0.5 * S + root, two = 1.0 + 0.5 * S - root;
  double last = fabs(one) > fabs(two) ? one : two;
  if (fabs(z3) > fabs(last)) last = z3;
  return (ct_clock){last < 0.0 ? acos(-1.0) : 0.0, -log(fabs(last)), 0.0};
}

static void multiply(double a[3][3], double b[3][3], double out[3][3])
{
  double c[3][3] = {{0.0}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++) c[i][j] += a[i][k] * b[k][j];
  memcpy(out, c, sizeof c);
}

double ct_clock_advance(const ct_integrator *integrator, double Omega, int64_t steps)
{
  gain g = step_gain(integrator, Omega * Omega);
  double power[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (int i = 0; i < 3; i++) g.B[i][i] += 1.0;
  for (; steps > 0; steps /= 2) {
    if (steps % 2) multiply(g.B, power, power);
    multiply(g.B, g.B, g.B);
  }
  return power[0][1];
}
