/* Impact of two thick plates as a sum over Rayleigh-Lamb branches (docs/theory/exact.rst).
 *
 * d = c1 = density = v0 = 1, stresses over Lambda. xi is the wave number, omega the frequency of a
 * branch, xi1_squared = omega^2 - xi^2, xi2_squared = kappa^2 omega^2 - xi^2; a mode is u_x = -(xi
 * Phi cos(xi1 z) + Psi cos(xi2 z)) sin(xi x), u_z = -(Phi xi1 sin(xi1 z) - xi Psi sin(xi2 z)/xi2)
 * cos(xi x).
 */
#include <libcontact/exact.h>
#include <libcontact/series.h>

#include "../exact/points.h"
#include "../base/lanes.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_roots.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* Gauss points of a panel of wave numbers; number of modes that are summed together. */
enum { NODES = 6, BLOCK = 128 };

/* One mode: its wave number and frequency, and the amplitudes times the weight of the quadrature. A
 * and B belong to the functions divided by exp(|Im xi1|), exp(|Im xi2|), so that none overflows. */
typedef struct ct_mode {
  double xi, omega, xi1_squared, xi2_squared, a, b;
} ct_mode;

/* Modes in blocks for the sums; superfluous modes of a block have amplitude 0. */
typedef struct ct_mode_block {
  double xi[BLOCK], omega[BLOCK], xi1_squared[BLOCK], xi2_squared[BLOCK], a[BLOCK], b[BLOCK];
} ct_mode_block;

/* The modes of one Poisson's ratio and number of branches on a grid of wave numbers. */
typedef struct ct_series {
  double ell, kappa2;
  size_t count, blocks, capacity; /* modes; blocks in use and allocated */
  ct_mode_block *block;
} ct_series;

/* cos s, s sin s, sin(s)/s as functions of s^2, divided by exp(|Im s|); `unit` is 1 divided by
 * exp(2 |Im s|). */
typedef struct ct_trig {
  double c, s, sinc, unit;
} ct_trig;

static ct_trig trig(double square)
{
  const double r = sqrt(fabs(square));
  if (square >= 0.0) return (ct_trig){cos(r), r * sin(r), r > 0.0 ? sin(r) / r : 1.0, 1.0};
  const double unit = exp(-2.0 * r), even = 0.5 * (1.0 + unit), odd = -0.5 * expm1(-2.0 * r);
  return (ct_trig){even, -r * odd, odd / r, unit};
}

/* The Rayleigh-Lamb function of omega, divided by the exponentials of
 * `trig`. */
typedef struct ct_dispersion {
  double kappa2, xi;
} ct_dispersion;

static double dispersion(double omega, void *parameters)
{
  const ct_dispersion *d = parameters;
  const double xi2 = d->xi * d->xi, xi1_squared = (omega - d->xi) * (omega + d->xi),
               xi2_squared = d->kappa2 * omega * omega - xi2;
  const ct_trig a = trig(xi1_squared), b = trig(xi2_squared);
  const double e = xi2_squared - xi2;
  return e * e * a.c * b.sinc + 4.0 * xi2 * a.s * b.c; // (eq:series-dispersion)
}

/* The root in [low, high], which contains exactly one. */
static double branch_root(gsl_root_fsolver *solver, ct_dispersion *d, double low, double high)
{
  const double f_low = dispersion(low, d), f_high = dispersion(high, d);
  if ((f_low > 0.0) == (f_high > 0.0)) return fabs(f_low) < fabs(f_high) ? low : high;
  gsl_function f = {dispersion, d};
  gsl_root_fsolver_set(solver, &f, low, high);
  for (int i = 0; i < 60; i++) {
    if (gsl_root_fsolver_iterate(solver) != GSL_SUCCESS) break;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver), gsl_root_fsolver_x_upper(solver),
                               0.0, 4.0 * DBL_EPSILON) == GSL_SUCCESS)
      break;
  }
  return gsl_root_fsolver_root(solver);
}

/* (1 - sin(b) cos(b)/b)/b^2 as a function of b^2, with the exponentials of `t`. */
static double sine_energy(double xi2_squared, const ct_trig *t)
{
  if (fabs(xi2_squared) > 0.01) return (t->unit - t->sinc * t->c) / xi2_squared;
  const double series =
      2.0 / 3.0 -
      xi2_squared * (2.0 / 15.0 - xi2_squared * (4.0 / 315.0 - xi2_squared * 2.0 / 2835.0));
  return series * t->unit;
}

/* The mode at (xi, omega) with its projection on the initial velocity. */
static ct_mode mode_at(const ct_series *s, double xi, double omega, double weight, double *size)
{
  // -- Amplitudes from the free face
  ct_mode m = {xi,  omega, (omega - xi) * (omega + xi), s->kappa2 * omega * omega - xi * xi,
               0.0, 0.0};
  const ct_trig ta = trig(m.xi1_squared), tb = trig(m.xi2_squared);
  const double e = m.xi2_squared - xi * xi;
  // (eq:series-free)
  const double a1 = -e * tb.sinc, b1 = 2.0 * xi * ta.s, a2 = 2.0 * xi * tb.c, b2 = e * ta.c;
  const int first = fabs(xi * a1) + fabs(b1) > fabs(xi * a2) + fabs(b2);
  m.a = first ? a1 : a2;
  m.b = first ? b1 : b2;
  // -- Mean of u_x and kinetic energy (eq:series-projection)
  const double mean = -(xi * m.a * ta.sinc + m.b * tb.sinc);
  const double energy = // (eq:series-norm)
      0.5 * m.a * m.a *
          (xi * xi * (ta.unit + ta.sinc * ta.c) + (m.xi1_squared * ta.unit - ta.s * ta.c)) +
      0.5 * m.b * m.b * ((tb.unit + tb.sinc * tb.c) + xi * xi * sine_energy(m.xi2_squared, &tb)) +
      2.0 * xi * m.a * m.b * ta.c * tb.sinc;
  // -- Weight (eq:series-sum)
  const double factor = -2.0 / PI * weight * mean / (energy * xi);
  *size = fabs(factor) * sqrt(energy);
  m.a *= factor;
  m.b *= factor;
  return m;
}

static ct_status keep(ct_series *s, const ct_mode *mode)
{
  const size_t place = s->count % BLOCK;
  if (place == 0) {
    if (s->blocks == s->capacity) {
      const size_t capacity = 2 * s->capacity + 16;
      ct_mode_block *grown = realloc(s->block, capacity * sizeof *grown);
      if (grown == NULL) return CT_ERROR_MEMORY;
      s->block = grown;
      s->capacity = capacity;
    }
    s->block[s->blocks++] = (ct_mode_block){{0.0}, {0.0}, {0.0}, {0.0}, {0.0}, {0.0}};
    for (int i = 0; i < BLOCK; i++) s->block[s->blocks - 1].omega[i] = 1.0;
  }
  ct_mode_block *b = &s->block[s->blocks - 1];
  b->xi[place] = mode->xi, b->omega[place] = mode->omega, b->xi1_squared[place] = mode->xi1_squared;
  b->xi2_squared[place] = mode->xi2_squared, b->a[place] = mode->a, b->b[place] = mode->b;
  s->count++;
  return CT_OK;
}

/* Data for a wave number: solver, Rayleigh speed over c1, width of a panel, and the smallest mode
 * that is kept. */
typedef struct ct_branches {
  gsl_root_fsolver *solver;
  double c_r, width, least;
} ct_branches;

/* The modes of one wave number on the lowest `branches` branches. */
static ct_status wave_number(ct_series *s, const ct_branches *how, double xi, double weight,
                             size_t branches)
{
  ct_dispersion d = {s->kappa2, xi};
  const double kappa = sqrt(s->kappa2);
  double low = 0.5 * how->c_r * xi;
  size_t p = 0, q = 1;
  for (size_t n = 0; n < branches; n++) {
    // -- Bracket the branch between two modes of lubricated rigid walls (eq:series-interlace)
    const double wall_p = hypot(xi, (double)p * PI), wall_s = hypot(xi, (double)q * PI) / kappa;
    const double high = fmin(wall_p, wall_s);
    if (wall_p < wall_s) p++;
    else q++;
    // -- Find it and keep its mode
    const double omega = branch_root(how->solver, &d, low, high);
    double size;
    const ct_mode mode = mode_at(s, xi, omega, weight, &size);
    if (size > how->least && keep(s, &mode) != CT_OK) return CT_ERROR_MEMORY;
    low = high;
  }
  return CT_OK;
}

/* All wave numbers: all branches up to 3 xi_N + 60, then the lowest one only, the Rayleigh wave, up
 * to 4000. */
static ct_status tabulate(ct_series *s, size_t branches, const ct_branches *how,
                          const gsl_integration_glfixed_table *rule)
{
  // (eq:series-grid)
  const double all = 60.0 + 3.0 * PI * (double)branches / sqrt(s->kappa2 - 1.0),
               end = fmax(4000.0, all);
  for (size_t panel = 0; (double)panel * how->width < end; panel++) {
    const double left = (double)panel * how->width;
    for (size_t i = 0; i < NODES; i++) {
      double xi, weight;
      gsl_integration_glfixed_point(left, left + how->width, i, &xi, &weight, rule);
      const ct_status status = wave_number(s, how, xi, weight, left < all ? branches : 1);
      if (status != CT_OK) return status;
    }
  }
  return CT_OK;
}

static void release(ct_series *s)
{
  if (s == NULL) return;
  free(s->block);
  free(s);
}

/* Find the branches (eq:series-dispersion) and the weights of their modes (eq:series-sum) for
 * points up to x + t = reach: this sets the sampling of the integrand. */
static ct_status tabulated(double nu, size_t branches, double reach, ct_series **out,
                           ct_error *error)
{
  const double width = fmin(1.0, 4.0 / reach);
  ct_branches how = {NULL, 0.0, width, 3e-8 * width};
  double c2;
  if (ct_exact_speeds(nu, &c2, &how.c_r, error) != CT_OK)
    return CT_REFUSE(error, "nu = %g, Poisson's ratio must be in (0, 0.49]", nu);
  if (branches < 1 || branches > 1000)
    return CT_REFUSE(error, "branches = %zu, must be 1 to 1000", branches);
  ct_series *s = calloc(1, sizeof *s);
  gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(NODES);
  how.solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  ct_status status = s != NULL && rule != NULL && how.solver != NULL ? CT_OK : CT_ERROR_MEMORY;
  if (status == CT_OK) {
    const double ell = 2.0 * nu / (1.0 - 2.0 * nu);
    *s = (ct_series){ell, 2.0 + ell, 0, 0, 0, NULL};
    status = tabulate(s, branches, &how, rule);
  }
  if (how.solver != NULL) gsl_root_fsolver_free(how.solver);
  if (rule != NULL) gsl_integration_glfixed_table_free(rule);
  if (status != CT_OK) {
    release(s);
    return ct_fail(error, status, CT_NOWHERE, "no memory for %zu branches", branches);
  }
  *out = s;
  return CT_OK;
}

/* Sines and cosines of a block of angles, 0 <= angle < 1e6, written so that the compiler can
 * vectorise it: angle = k pi/2 + y with |y| <= pi/4 and Taylor's polynomials in y. */
CT_CLONES
static void waves(const double *angle, double *cosine, double *sine)
{
  const double shift = 6755399441055744.0; /* adding and subtracting it rounds to an integer */
  const double half_pi[3] = {1.57079632673412561417, 6.07710050630396597660e-11,
                             2.02226624879595063154e-21};
#pragma omp simd
  for (int i = 0; i < BLOCK; i++) {
    const double k = (angle[i] * (2.0 / PI) + shift) - shift, turns = (0.25 * k + shift) - shift;
    const double quarter = k - 4.0 * turns; /* -2, -1, 0, 1 or 2 */
    const double y = ((angle[i] - k * half_pi[0]) - k * half_pi[1]) - k * half_pi[2], y2 = y * y;
    const double s =
        y + y * y2 *
                (-1.0 / 6 +
                 y2 * (1.0 / 120 + y2 * (-1.0 / 5040 + y2 * (1.0 / 362880 +
                                                             y2 * (-1.0 / 39916800 +
                                                                   y2 * (1.0 / 6227020800.0 -
                                                                         y2 / 1307674368000.0))))));
    const double c =
        1.0 +
        y2 * (-0.5 + y2 * (1.0 / 24 +
                           y2 * (-1.0 / 720 +
                                 y2 * (1.0 / 40320 + y2 * (-1.0 / 3628800 +
                                                           y2 * (1.0 / 479001600 +
                                                                 y2 * (-1.0 / 87178291200.0 +
                                                                       y2 / 20922789888000.0)))))));
    const int odd = fabs(quarter) == 1.0;
    const double first = odd ? c : s, second = odd ? s : c;
    sine[i] = fabs(quarter - 0.5) > 1.0 ? -first : first;
    cosine[i] = fabs(quarter + 0.5) > 1.0 ? -second : second;
  }
}

/* cos(s z) and s sin(s z) over exp(|Im s|) for s = i r, 0 <= z <= 1; both underflow to 0 far from
 * the face. */
static void hyperbolic(double r, double z, double *c, double *s)
{
  *c = *s = 0.0;
  if (r * (1.0 - z) > 45.0) return;
  const double rise = exp(r * (z - 1.0)), fall = 2.0 * r * z > 45.0 ? 0.0 : exp(-r * (z + 1.0));
  *c = 0.5 * (rise + fall);
  *s = -0.5 * r * (rise - fall);
}

/* cos(s z) and s sin(s z) over exp(|Im s|) of a block of modes, given s^2. */
CT_CLONES
static void shapes(const double *square, double z, double *c, double *s)
{
  double root[BLOCK], angle[BLOCK];
  for (int i = 0; i < BLOCK; i++) {
    root[i] = sqrt(fabs(square[i]));
    angle[i] = root[i] * z;
  }
  waves(angle, c, s);
  for (int i = 0; i < BLOCK; i++) s[i] *= root[i];
  for (int i = 0; i < BLOCK; i++)
    if (square[i] < 0.0) hyperbolic(root[i], z, &c[i], &s[i]);
}

/* Factors of x and t for each mode of a block: sin, cos of xi x times cos(omega t), sin(omega
 * t)/omega. */
typedef struct ct_wave_factors {
  double sin_cos[BLOCK], cos_cos[BLOCK], sin_sin[BLOCK], cos_sin[BLOCK];
} ct_wave_factors;

static void wave_factors(const ct_mode_block *m, double x, double t, ct_wave_factors *f)
{
  double angle[BLOCK], cx[BLOCK], sx[BLOCK], ct[BLOCK], st[BLOCK];
  for (int i = 0; i < BLOCK; i++) angle[i] = m->xi[i] * x;
  waves(angle, cx, sx);
  for (int i = 0; i < BLOCK; i++) angle[i] = m->omega[i] * t;
  waves(angle, ct, st);
  for (int i = 0; i < BLOCK; i++) {
    f->sin_cos[i] = sx[i] * ct[i];
    f->cos_cos[i] = cx[i] * ct[i];
    f->sin_sin[i] = sx[i] * st[i] / m->omega[i];
    f->cos_sin[i] = cx[i] * st[i] / m->omega[i];
  }
}

/* Add a block of modes at height z >= 0. */
CT_CLONES
static void add_modes(const ct_mode_block *m, const ct_wave_factors *f, double ell, double z,
                      double field[5])
{
  double ca[BLOCK], sa[BLOCK], cb[BLOCK], sb[BLOCK];
  shapes(m->xi1_squared, z, ca, sa);
  shapes(m->xi2_squared, z, cb, sb);
  double sum[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
  for (int i = 0; i < BLOCK; i++) {
    // -- Displacement of the mode and its derivatives over the thickness
    const double xi = m->xi[i], a = m->a[i], b = m->b[i];
    const double sinc = m->xi2_squared[i] != 0.0 ? sb[i] / m->xi2_squared[i] : z;
    // (eq:series-boundary)
    const double u = -(xi * a * ca[i] + b * cb[i]), w = xi * b * sinc - a * sa[i];
    const double divergence = -m->omega[i] * m->omega[i] * a * ca[i];
    const double w_z = xi * b * cb[i] - m->xi1_squared[i] * a * ca[i],
                 u_z = xi * a * sa[i] + b * sb[i];
    // -- Hooke's law and velocity (eq:series-fields)
    sum[0] += (divergence + 2.0 / ell * xi * u) * f->cos_sin[i];
    sum[1] += (divergence + 2.0 / ell * w_z) * f->cos_sin[i];
    sum[2] += (u_z - xi * w) / ell * f->sin_sin[i];
    sum[3] += u * f->sin_cos[i];
    sum[4] += w * f->cos_cos[i];
  }
  for (int k = 0; k < 5; k++) field[k] += sum[k];
}

/* The points first, ..., last - 1 have the same x and t: all modes at each. */
static void sum_line(const ct_series *s, size_t first, size_t last, const double *x,
                     const double *z, const double *t, double *fields)
{
  for (size_t i = 5 * first; i < 5 * last; i++) fields[i] = 0.0;
  for (size_t j = 0; j < s->blocks; j++) {
    ct_wave_factors factors;
    wave_factors(&s->block[j], x[first], t[first], &factors);
    for (size_t i = first; i < last; i++)
      add_modes(&s->block[j], &factors, s->ell, fabs(z[i]), fields + 5 * i);
  }
  // -- Shear stress and transversal velocity are odd in z
  for (size_t i = first; i < last; i++)
    if (z[i] < 0.0) fields[5 * i + 2] = -fields[5 * i + 2], fields[5 * i + 4] = -fields[5 * i + 4];
}

/* The reason why a point is outside the range; null if it is inside. */
static const char *refusal(double x, double z, double t, double reach)
{
  (void)z;
  return x + t > reach ? "x + t is above 100, the reach of the series" : NULL;
}

ct_status ct_exact_plates_series(size_t n, const double *x, const double *z, const double *t,
                                 double nu, size_t branches, double *fields, size_t *bad,
                                 ct_error *error)
{
  ct_status status = ct_exact_check(n, x, z, t, fields, refusal, 100.0, bad, error);
  if (status != CT_OK) return status;
  double reach = 1.0;
  for (size_t i = 0; i < n; i++) reach = fmax(reach, x[i] + t[i]);
  ct_series *s = NULL;
  status = tabulated(nu, branches, reach, &s, error);
  if (status != CT_OK) return status;
  for (size_t first = 0, last = 1; first < n; first = last++) {
    while (last < n && x[last] == x[first] && t[last] == t[first]) last++;
    sum_line(s, first, last, x, z, t, fields);
  }
  release(s);
  return CT_OK;
}
