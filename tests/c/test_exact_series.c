/* The Rayleigh-Lamb series compared with the closed form, which shares no line with it, and with
 * mode theory. */
#include <libcontact/exact.h>
#include <libcontact/series.h>

#include "tap.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 100, SIGMA_X = 0, SIGMA_Z = 1, TAU = 2 };

/* Mean absolute difference of each field from the closed form on the line of Fig. 5: x = 0.4, t =
 * 0.56. */
static void line_difference(double nu, size_t branches, double mean[5])
{
  double x[POINTS], z[POINTS], t[POINTS], series[5 * POINTS], closed[5 * POINTS];
  for (int i = 0; i < POINTS; i++) x[i] = 0.4, z[i] = (i + 0.5) / POINTS, t[i] = 0.56;
  for (int k = 0; k < 5; k++) mean[k] = NAN;
  if (ct_exact_plates(POINTS, x, z, t, nu, INFINITY, closed, NULL, NULL) != CT_OK) return;
  if (ct_exact_plates_series(POINTS, x, z, t, nu, branches, series, NULL, NULL) != CT_OK) return;
  for (int k = 0; k < 5; k++) {
    mean[k] = 0.0;
    for (int i = 0; i < POINTS; i++)
      mean[k] += fabs(series[5 * i + k] - closed[5 * i + k]) / POINTS;
  }
}

/* Every factor of a mode: eq:series-boundary, eq:series-free, eq:series-dispersion,
 * eq:series-interlace, eq:series-projection, eq:series-norm, eq:series-sum, eq:series-fields,
 * eq:series-grid. */
static void sum_tends_to_the_closed_form(void)
{
  static const size_t branches[3] = {10, 50, 300};
  static const double expected[3] = {0.095, 0.020, 0.0026};
  double mean[3][5];
  for (int i = 0; i < 3; i++) {
    line_difference(0.3, branches[i], mean[i]);
    tap_close(mean[i][SIGMA_Z], expected[i], 0.1 * expected[i],
              "sigma_z of %zu branches, mean difference", branches[i]);
  }
  for (int k = 0; k < 5; k++)
    tap_ok(mean[1][k] < 0.3 * mean[0][k] && mean[2][k] < 0.25 * mean[1][k],
           "field %d: %.2e, %.2e, %.2e with 10, 50, 300 branches", k, mean[0][k], mean[1][k],
           mean[2][k]);
  static const double ratios[4] = {0.1, 0.26308, 0.4, 0.45};
  for (int i = 0; i < 4; i++) {
    double few[5], many[5];
    line_difference(ratios[i], 10, few);
    line_difference(ratios[i], 100, many);
    for (int k = 0; k < 5; k++)
      tap_ok(many[k] < 0.5 * few[k], "nu = %g, field %d: %.2e, %.2e with 10, 100 branches",
             ratios[i], k, few[k], many[k]);
  }
}

/* Each mode is free of traction, so every partial sum is; and it keeps the planes of symmetry. */
static void partial_sums_keep_the_conditions(void)
{
  double traction = 0.0, middle = 0.0, start = 0.0;
  for (int i = 0; i < 30; i++) {
    const double x[4] = {0.07 * i, 0.07 * i, 0.07 * i, 0.0}, z[4] = {1.0, -1.0, 0.0, 0.03 * i};
    const double t[4] = {0.9, 0.9, 1.9, 0.06 * i};
    double f[20];
    if (ct_exact_plates_series(4, x, z, t, 0.3, 20, f, NULL, NULL) != CT_OK) traction = INFINITY;
    for (int k = 0; k < 2; k++)
      traction = fmax(traction, fmax(fabs(f[5 * k + SIGMA_Z]), fabs(f[5 * k + TAU])));
    middle = fmax(middle, fmax(fabs(f[10 + TAU]), fabs(f[14])));
    start = fmax(start, fmax(fabs(f[15 + TAU]), fabs(f[18])));
  }
  tap_ok(traction < 1e-12, "20 branches: the faces are free of traction: %.1e", traction);
  tap_ok(middle < 1e-12, "20 branches: tau and v_z vanish at z = 0: %.1e", middle);
  tap_ok(start < 1e-12, "20 branches: tau and v_x vanish at x = 0: %.1e", start);
}

/* Negative heights are the mirror image, and a grid of wave numbers three times as fine, which one
 * more point far away asks for, changes a hundredth of what the missing branches do. */
static void halves_and_grids_agree(void)
{
  enum { COUNT = 40 };
  double x[COUNT + 1] = {0}, up[COUNT + 1] = {0}, down[COUNT], t[COUNT + 1], f[5 * COUNT],
                   g[5 * COUNT], h[5 * COUNT + 5], exact[5 * COUNT];
  for (int i = 0; i < COUNT; i++) {
    x[i] = 0.05 + 0.1 * (i % 4), up[i] = 0.02 * i + 0.01, down[i] = -up[i],
    t[i] = 0.3 + 0.1 * (i % 3);
  }
  t[COUNT] = 12.0;
  ct_status status = ct_exact_plates_series(COUNT, x, up, t, 0.3, 40, f, NULL, NULL);
  if (status == CT_OK) status = ct_exact_plates_series(COUNT, x, down, t, 0.3, 40, g, NULL, NULL);
  if (status == CT_OK) status = ct_exact_plates_series(COUNT + 1, x, up, t, 0.3, 40, h, NULL, NULL);
  if (status == CT_OK)
    status = ct_exact_plates(COUNT, x, down, t, 0.3, INFINITY, exact, NULL, NULL);
  tap_ok(status == CT_OK, "the calls succeed");
  int differ = 0;
  double off = 0.0, odd = 0.0;
  for (int i = 0; i < 5 * COUNT; i++) {
    const double sign = i % 5 == 2 || i % 5 == 4 ? -1.0 : 1.0;
    differ += f[i] != sign * g[i];
    off = fmax(off, fabs(f[i] - h[i]));
    if (sign < 0.0) odd += fabs(g[i] - exact[i]) / (2 * COUNT);
  }
  tap_ok(differ == 0, "the same bits at -z");
  tap_ok(odd < 0.02,
         "tau and v_z below the middle plane, mean difference from the closed form %.1e", odd);
  tap_ok(off < 5e-4, "panels of 1 and 1/3: %.1e", off);
}

/* After many reflections at both faces: behind the front of the slow rod wave a plate comes to rest
 * at x = 0, and the mean force is that of the elementary theory, sigma_x = -rho c_p v0 with c_p the
 * speed of long waves in a plate. */
static void long_time_is_the_rod(void)
{
  const double nu = 0.3, lambda = nu / (1.0 - nu), mu = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
  const double speed = sqrt(4.0 * mu * (1.0 - mu));
  enum { HEIGHTS = 8, TIMES = 24 };
  double x[HEIGHTS * TIMES], z[HEIGHTS * TIMES], t[HEIGHTS * TIMES], f[5 * HEIGHTS * TIMES],
      mean = 0.0;
  for (int i = 0; i < HEIGHTS * TIMES; i++) {
    x[i] = 0.0;
    z[i] = (i % HEIGHTS + 0.5) / HEIGHTS;
    t[i] = 30.0 + 0.5 * (i / HEIGHTS);
  }
  const ct_status status = ct_exact_plates_series(HEIGHTS * TIMES, x, z, t, nu, 6, f, NULL, NULL);
  for (int i = 0; i < HEIGHTS * TIMES; i++) mean += f[5 * i + SIGMA_X] * lambda / (HEIGHTS * TIMES);
  tap_ok(status == CT_OK && fabs(mean + speed) < 0.005 * speed,
         "mean force at late times %.4f, elementary theory %.4f", mean, -speed);
}

static void bad_input_is_refused(void)
{
  ct_error error;
  size_t bad;
  double f[10];
  const double ok[2] = {0.1, 0.1},
               wrong[5][3] = {{-1, 0, 0.5}, {0.1, 2, 0.5}, {0.1, 0, -1}, {NAN, 0, 1}, {60, 0, 60}};
  for (int i = 0; i < 5; i++) {
    const double x[2] = {0.1, wrong[i][0]}, z[2] = {0.1, wrong[i][1]}, t[2] = {0.1, wrong[i][2]};
    tap_ok(ct_exact_plates_series(2, x, z, t, 0.3, 3, f, &bad, &error) == CT_ERROR_ARGUMENT &&
               bad == 1 && error.point == 1,
           "refused: %s", error.text);
  }
  tap_ok(ct_exact_plates_series(2, ok, ok, ok, 0.5, 3, f, &bad, &error) == CT_ERROR_ARGUMENT &&
             bad == 2 && strstr(error.text, "nu") != NULL,
         "refused: %s", error.text);
  tap_ok(ct_exact_plates_series(2, ok, ok, ok, 0.3, 0, f, &bad, &error) == CT_ERROR_ARGUMENT &&
             strstr(error.text, "branches") != NULL,
         "refused: %s", error.text);
}

int main(void)
{
  sum_tends_to_the_closed_form();
  partial_sums_keep_the_conditions();
  halves_and_grids_agree();
  long_time_is_the_rod();
  bad_input_is_refused();
  return tap_done();
}
