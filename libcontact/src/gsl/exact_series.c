/* Impact of two thick plates as a sum over Rayleigh-Lamb branches (docs/theory/exact.rst).
 *
 * d = c1 = density = v0 = 1, stresses over Lambda. xi is the wave number, omega the frequency of a branch,
 * alpha2 = omega^2 - xi^2, beta2 = kappa^2 omega^2 - xi^2; a mode is
 *   u_x = -(xi A cos(alpha z) + B cos(beta z)) sin(xi x),
 *   u_z = -(A alpha sin(alpha z) - xi B sin(beta z)/beta) cos(xi x). */
#include <contact/exact.h>
#include <contact/exact_series.h>

#include "../error.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_roots.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* Gauss points of a panel of wave numbers. */
enum { NODES = 6 };

/* One mode: its place, the amplitudes times the weight of the quadrature. A and B are those of the functions divided
 * by exp(|Im alpha|), exp(|Im beta|), so that none overflows. */
typedef struct ct_mode {
  double xi, omega, alpha2, beta2, a, b;
} ct_mode;

struct ct_exact_series {
  double epsilon, kappa2, reach;
  size_t count, room;
  ct_mode *mode;
};

/* cos s, s sin s, sin(s)/s as functions of s^2, divided by exp(|Im s|); `unit` is 1 divided by exp(2 |Im s|). */
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

/* The Rayleigh-Lamb function of omega (eq:series-dispersion), divided by the exponentials of `trig`. */
typedef struct ct_dispersion {
  double kappa2, xi;
} ct_dispersion;

static double dispersion(double omega, void *parameters)
{
  const ct_dispersion *d = parameters;
  const double xi2 = d->xi * d->xi, alpha2 = (omega - d->xi) * (omega + d->xi), beta2 = d->kappa2 * omega * omega - xi2;
  const ct_trig a = trig(alpha2), b = trig(beta2);
  const double e = beta2 - xi2;
  return e * e * a.c * b.sinc + 4.0 * xi2 * a.s * b.c;
}

/* The root in [low, high], which holds exactly one. */
static double branch_root(gsl_root_fsolver *solver, ct_dispersion *d, double low, double high)
{
  const double f_low = dispersion(low, d), f_high = dispersion(high, d);
  if ((f_low > 0.0) == (f_high > 0.0)) return fabs(f_low) < fabs(f_high) ? low : high;
  gsl_function f = {dispersion, d};
  gsl_root_fsolver_set(solver, &f, low, high);
  for (int i = 0; i < 60; i++) {
    if (gsl_root_fsolver_iterate(solver) != GSL_SUCCESS) break;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver), gsl_root_fsolver_x_upper(solver), 0.0,
                               4.0 * DBL_EPSILON) == GSL_SUCCESS)
      break;
  }
  return gsl_root_fsolver_root(solver);
}

/* (1 - sin(b) cos(b)/b)/b^2 as a function of b^2, with the exponentials of `t`. */
static double sine_energy(double beta2, const ct_trig *t)
{
  if (fabs(beta2) > 0.01) return (t->unit - t->sinc * t->c) / beta2;
  const double series = 2.0 / 3.0 - beta2 * (2.0 / 15.0 - beta2 * (4.0 / 315.0 - beta2 * 2.0 / 2835.0));
  return series * t->unit;
}

/* The mode at (xi, omega) with its projection on the initial velocity (eq:series-projection). */
static ct_mode mode_at(const ct_exact_series *s, double xi, double omega, double weight, double *size)
{
  // -- Amplitudes from the free face (eq:series-boundary)
  ct_mode m = {xi, omega, (omega - xi) * (omega + xi), s->kappa2 * omega * omega - xi * xi, 0.0, 0.0};
  const ct_trig ta = trig(m.alpha2), tb = trig(m.beta2);
  const double e = m.beta2 - xi * xi;
  const double a1 = -e * tb.sinc, b1 = 2.0 * xi * ta.s, a2 = 2.0 * xi * tb.c, b2 = e * ta.c;
  const int first = fabs(xi * a1) + fabs(b1) > fabs(xi * a2) + fabs(b2);
  m.a = first ? a1 : a2;
  m.b = first ? b1 : b2;
  // -- Mean of u_x and kinetic energy (eq:series-norm)
  const double mean = -(xi * m.a * ta.sinc + m.b * tb.sinc);
  const double energy = 0.5 * m.a * m.a * (xi * xi * (ta.unit + ta.sinc * ta.c) + (m.alpha2 * ta.unit - ta.s * ta.c))
                        + 0.5 * m.b * m.b * ((tb.unit + tb.sinc * tb.c) + xi * xi * sine_energy(m.beta2, &tb))
                        + 2.0 * xi * m.a * m.b * ta.c * tb.sinc;
  // -- Weight (eq:series-sum)
  const double factor = -2.0 / PI * weight * mean / (energy * xi);
  *size = fabs(factor) * sqrt(energy);
  m.a *= factor;
  m.b *= factor;
  return m;
}

static ct_status keep(ct_exact_series *s, const ct_mode *mode)
{
  if (s->count == s->room) {
    const size_t room = 2 * s->room + 4096;
    ct_mode *grown = realloc(s->mode, room * sizeof *grown);
    if (grown == NULL) return CT_ERROR_MEMORY;
    s->mode = grown;
    s->room = room;
  }
  s->mode[s->count++] = *mode;
  return CT_OK;
}

/* What a wave number needs: solver, Rayleigh speed over c1, and the smallest mode worth keeping. */
typedef struct ct_branches {
  gsl_root_fsolver *solver;
  double c_r, least;
} ct_branches;

/* The modes of one wave number on the lowest `branches` branches. */
static ct_status wave_number(ct_exact_series *s, const ct_branches *how, double xi, double weight, size_t branches)
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

/* All wave numbers: `branches` of them up to 3 xi_N + 60, then the lowest alone, the Rayleigh wave, up to 4000 (eq:series-grid). */
static ct_status tabulate(ct_exact_series *s, size_t branches, const ct_branches *how,
                          const gsl_integration_glfixed_table *rule)
{
  const double width = fmin(1.0, 4.0 / s->reach);
  const double all = 60.0 + 3.0 * PI * (double)branches / sqrt(s->kappa2 - 1.0), end = fmax(4000.0, all);
  for (size_t panel = 0; (double)panel * width < end; panel++) {
    const double left = (double)panel * width;
    for (size_t i = 0; i < NODES; i++) {
      double xi, weight;
      gsl_integration_glfixed_point(left, left + width, i, &xi, &weight, rule);
      const ct_status status = wave_number(s, how, xi, weight, left < all ? branches : 1);
      if (status != CT_OK) return status;
    }
  }
  return CT_OK;
}

ct_status ct_exact_series_create(double nu, size_t branches, double reach, ct_exact_series **out, ct_error *error)
{
  if (out == NULL) return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "out is a null pointer");
  *out = NULL;
  ct_branches how = {NULL, 0.0, 1e-9};
  double c2;
  if (ct_exact_speeds(nu, &c2, &how.c_r) != CT_OK)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "nu = %g, Poisson's ratio must be in (0, 0.49]", nu);
  if (branches < 1 || branches > 10000)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "branches = %zu, must be 1 to 10000", branches);
  if (!(reach > 0.0 && reach <= 100.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "reach = %g, x + t must be at most 100", reach);
  ct_exact_series *s = malloc(sizeof *s);
  gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(NODES);
  how.solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  ct_status status = s != NULL && rule != NULL && how.solver != NULL ? CT_OK : CT_ERROR_MEMORY;
  if (status == CT_OK) {
    const double epsilon = 2.0 * nu / (1.0 - 2.0 * nu);
    *s = (ct_exact_series){epsilon, 2.0 + epsilon, reach, 0, 0, NULL};
    status = tabulate(s, branches, &how, rule);
  }
  if (how.solver != NULL) gsl_root_fsolver_free(how.solver);
  if (rule != NULL) gsl_integration_glfixed_table_free(rule);
  if (status != CT_OK) {
    ct_exact_series_free(s);
    return ct_fail(error, status, CT_NOWHERE, "no memory for %zu branches", branches);
  }
  *out = s;
  return CT_OK;
}

void ct_exact_series_free(ct_exact_series *series)
{
  if (series == NULL) return;
  free(series->mode);
  free(series);
}

/* cos(s z) and s sin(s z) over exp(|Im s|), 0 <= z <= 1, as functions of s^2. */
static void shape(double square, double z, double *c, double *s)
{
  const double r = sqrt(fabs(square));
  if (square >= 0.0) {
    *c = cos(r * z);
    *s = r * sin(r * z);
  } else {
    const double rise = exp(r * (z - 1.0)), fall = exp(-r * (z + 1.0));
    *c = 0.5 * (rise + fall);
    *s = -0.5 * r * (rise - fall);
  }
}

/* What x and t do to each mode: sin, cos of xi x times cos(omega t), sin(omega t)/omega. */
static void wave_factors(const ct_exact_series *s, double x, double t, double *factor)
{
  for (size_t i = 0; i < s->count; i++) {
    const ct_mode *m = &s->mode[i];
    const double sx = sin(m->xi * x), cx = cos(m->xi * x), ct = cos(m->omega * t), st = sin(m->omega * t) / m->omega;
    double *f = factor + 4 * i;
    f[0] = sx * ct, f[1] = cx * ct, f[2] = sx * st, f[3] = cx * st;
  }
}

/* Sum of the modes at height z >= 0 (eq:series-fields). */
static void sum_modes(const ct_exact_series *s, double z, const double *factor, double field[5])
{
  double sigma_x = 0.0, sigma_z = 0.0, tau = 0.0, v_x = 0.0, v_z = 0.0;
  for (size_t i = 0; i < s->count; i++) {
    const ct_mode *m = &s->mode[i];
    const double *f = factor + 4 * i;
    double ca, sa, cb, sb;
    shape(m->alpha2, z, &ca, &sa);
    shape(m->beta2, z, &cb, &sb);
    // -- Displacement of the mode and its derivatives over the thickness (eq:series-boundary)
    const double sinc = m->beta2 != 0.0 ? sb / m->beta2 : z;
    const double u = -(m->xi * m->a * ca + m->b * cb), w = m->xi * m->b * sinc - m->a * sa;
    const double divergence = -m->omega * m->omega * m->a * ca;
    const double w_z = m->xi * m->b * cb - m->alpha2 * m->a * ca, u_z = m->xi * m->a * sa + m->b * sb;
    // -- Velocity and Hooke's law
    v_x += u * f[0];
    v_z += w * f[1];
    sigma_x += (divergence + 2.0 / s->epsilon * m->xi * u) * f[3];
    sigma_z += (divergence + 2.0 / s->epsilon * w_z) * f[3];
    tau += (u_z - m->xi * w) / s->epsilon * f[2];
  }
  field[0] = sigma_x, field[1] = sigma_z, field[2] = tau, field[3] = v_x, field[4] = v_z;
}

/* Why a point can't be answered; null when it can. */
static const char *refusal(double x, double z, double t, double reach)
{
  if (isnan(x) || isnan(z) || isnan(t)) return "a coordinate is not a number";
  if (x < 0.0) return "x < 0 lies outside the plate";
  if (fabs(z) > 1.0) return "|z| > 1 lies outside the plate";
  if (t < 0.0) return "t < 0 is before the impact";
  if (x + t > reach) return "x + t is above the reach of the table of modes";
  return NULL;
}

ct_status ct_exact_series_fields(const ct_exact_series *series, size_t n, const double *x, const double *z,
                                 const double *t, double *fields, size_t *bad, ct_error *error)
{
  if (bad != NULL) *bad = n;
  if (series == NULL || (n > 0 && (x == NULL || z == NULL || t == NULL || fields == NULL)))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "series, x, z, t or fields is a null pointer");
  for (size_t i = 0; i < n; i++) {
    const char *reason = refusal(x[i], z[i], t[i], series->reach);
    if (reason == NULL) continue;
    if (bad != NULL) *bad = i;
    return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, (int64_t)i},
                   "point %zu (x = %g, z = %g, t = %g): %s", i, x[i], z[i], t[i], reason);
  }
  double *factor = malloc((4 * series->count + 1) * sizeof *factor);
  if (factor == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for the factors of the modes");
  for (size_t i = 0; i < n; i++) {
    if (i == 0 || x[i] != x[i - 1] || t[i] != t[i - 1]) wave_factors(series, x[i], t[i], factor);
    double *field = fields + 5 * i;
    sum_modes(series, fabs(z[i]), factor, field);
    if (z[i] < 0.0) field[2] = -field[2], field[4] = -field[4];
  }
  free(factor);
  return CT_OK;
}

ct_status ct_exact_plates_series(size_t n, const double *x, const double *z, const double *t, double nu,
                                 size_t branches, double *fields, size_t *bad, ct_error *error)
{
  if (bad != NULL) *bad = n;
  if (n > 0 && (x == NULL || z == NULL || t == NULL || fields == NULL))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "x, z, t or fields is a null pointer");
  double reach = 1.0;
  for (size_t i = 0; i < n; i++) {
    const char *reason = refusal(x[i], z[i], t[i], 100.0);
    if (reason != NULL) {
      if (bad != NULL) *bad = i;
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, (int64_t)i},
                     "point %zu (x = %g, z = %g, t = %g): %s", i, x[i], z[i], t[i], reason);
    }
    reach = fmax(reach, x[i] + t[i]);
  }
  ct_exact_series *series;
  ct_status status = ct_exact_series_create(nu, branches, reach, &series, error);
  if (status != CT_OK) return status;
  status = ct_exact_series_fields(series, n, x, z, t, fields, bad, error);
  ct_exact_series_free(series);
  return status;
}
