/* The closed form of the plate impact compared with its differential equations and with values from
 * other sources. */
#include <libcontact/exact.h>

#include "tap.h"

#include <stdlib.h>
#include <string.h>

enum { SIGMA_X, SIGMA_Z, TAU, V_X, V_Z };

static const double ratios[] = {0.01, 0.1,  0.2, 0.25, 0.263, 0.26308206488336,
                                0.3,  0.35, 0.4, 0.45, 0.49};
enum { RATIOS = sizeof ratios / sizeof *ratios };

static double uniform(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (double)(*seed >> 8) / 16777216.0;
}

static void at(double x, double z, double t, double nu, double f[5])
{
  if (ct_exact_plates(1, &x, &z, &t, nu, INFINITY, f, NULL, NULL) != CT_OK)
    for (int i = 0; i < 5; i++) f[i] = NAN;
}

/* Distance of (x, z) at time t to the nearest front, from the geometry alone; to the Rayleigh point
 * with the depth shortened like its wave's decay. The fields are analytic within this distance. */
static double front_distance(double x, double z, double t, double nu)
{
  double c2, c_r, least = fabs(x - t);
  ct_exact_speeds(nu, &c2, &c_r, NULL);
  for (int side = -1; side <= 1; side += 2) {
    const double y = 1.0 + side * z, r = hypot(x, y), closest = c2 * c2 * t;
    least = fmin(least, fmin(fabs(r - t), fabs(r - c2 * t)));
    if (x >= closest * 0.9) least = fmin(least, fabs(x * c2 + y * sqrt(1.0 - c2 * c2) - c2 * t));
    least = fmin(least, hypot(x - c_r * t, y * sqrt(1.0 - c_r * c_r / (c2 * c2))));
  }
  return least;
}

/* Tenth-order central difference of all fields along (dx, dz, dt). */
static void derivative(const double p[3], int axis, double h, double nu, double d[5])
{
  static const double weight[5] = {5.0 / 6, -5.0 / 21, 5.0 / 84, -5.0 / 504, 1.0 / 1260};
  for (int i = 0; i < 5; i++) d[i] = 0.0;
  for (int k = 1; k <= 5; k++) {
    double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]}, fa[5], fb[5];
    a[axis] += k * h;
    b[axis] -= k * h;
    at(a[0], a[1], a[2], nu, fa);
    at(b[0], b[1], b[2], nu, fb);
    for (int i = 0; i < 5; i++) d[i] += weight[k - 1] * (fa[i] - fb[i]) / h;
  }
}

/* Which waves of the upper face have passed: 0 none, 1 P, 2 P and head, 3 P and S. */
static int region(double x, double z, double t, double nu)
{
  double c2;
  ct_exact_speeds(nu, &c2, NULL, NULL);
  const double y = 1.0 - fabs(z), r = hypot(x, y);
  if (r >= t) return 0;
  if (r < c2 * t) return 3;
  return x >= c2 * r && x * c2 + y * sqrt(1.0 - c2 * c2) < c2 * t ? 2 : 1;
}

/* rho v,t = div sigma and d(sigma)/dt = C : grad v, in the units of the header: sigma carries
 * 1/Lambda. */
static void equations_hold(double nu)
{
  const double lambda = nu / (1.0 - nu), mu = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
  unsigned seed = 7;
  double worst = 0.0;
  int count[4] = {0, 0, 0, 0};
  for (int tries = 0; tries < 20000 && count[0] + count[1] + count[2] + count[3] < 160; tries++) {
    const double t = 0.2 + 1.7 * uniform(&seed),
                 p[3] = {1.1 * t * uniform(&seed), 2.0 * uniform(&seed) - 1.0, t};
    const double room =
        fmin(front_distance(p[0], p[1], t, nu), fmin(p[0], fmin(1.0 - fabs(p[1]), 2.0 - t)));
    const int where = region(p[0], p[1], t, nu);
    if (room < 0.04 || count[where] >= 40) continue;
    count[where]++;
    double dx[5], dz[5], dt[5];
    const double h = room / 30.0;
    derivative(p, 0, h, nu, dx);
    derivative(p, 1, h, nu, dz);
    derivative(p, 2, h, nu, dt);
    const double residual[5] = {dt[V_X] - lambda * (dx[SIGMA_X] + dz[TAU]),
                                dt[V_Z] - lambda * (dx[TAU] + dz[SIGMA_Z]),
                                lambda * dt[SIGMA_X] - dx[V_X] - lambda * dz[V_Z],
                                lambda * dt[SIGMA_Z] - dz[V_Z] - lambda * dx[V_X],
                                lambda * dt[TAU] - mu * (dz[V_X] + dx[V_Z])};
    for (int i = 0; i < 5; i++)
      worst = isnan(residual[i]) ? INFINITY : fmax(worst, fabs(residual[i]));
  }
  tap_ok(
      worst < 1e-7,
      "nu = %g: motion and Hooke's law at %d + %d + %d + %d points (undisturbed, P, head, S): %.1e",
      nu, count[0], count[1], count[2], count[3], worst);
  tap_ok(count[1] > 20 && count[3] > 20, "nu = %g: points in the regions", nu);
}

/* eq:exact-sum, eq:exact-plane, eq:exact-face: the waves of the faces cancel the plane wave. */
static void faces_are_free(double nu)
{
  unsigned seed = 3;
  double worst = 0.0, plane = 0.0;
  for (int i = 0; i < 400; i++) {
    const double t = 1.99 * uniform(&seed), x = 1.2 * t * uniform(&seed),
                 z = 2.0 * uniform(&seed) - 1.0;
    double f[5], g[5], h[5];
    at(x, 1.0, t, nu, f);
    at(x, -1.0, t, nu, g);
    at(0.0, z, t, nu, h);
    worst = fmax(worst,
                 fmax(fmax(fabs(f[SIGMA_Z]), fabs(f[TAU])), fmax(fabs(g[SIGMA_Z]), fabs(g[TAU]))));
    plane = fmax(plane, fmax(fabs(h[V_X]), fabs(h[TAU])));
  }
  tap_ok(worst < 1e-12, "nu = %g: the faces are free of traction: %.1e", nu, worst);
  tap_ok(plane < 1e-12, "nu = %g: v_x and tau vanish on the plane of symmetry: %.1e", nu, plane);
}

/* eq:exact-plane. Across the plane front, away from the corner waves: [sigma] from [v] by the jump
 * condition; across the circles continuous. */
static void fronts_jump(double nu)
{
  const double lambda = nu / (1.0 - nu), e = 1e-11;
  double a[5], b[5], c2, worst = 0.0;
  at(0.7 * (1.0 + e), 0.1, 0.7, nu, a);
  at(0.7 * (1.0 - e), 0.1, 0.7, nu, b);
  tap_close(lambda * (b[SIGMA_X] - a[SIGMA_X]), -(b[V_X] - a[V_X]), 1e-12,
            "nu = %g: momentum across the plane front", nu);
  tap_close(b[SIGMA_Z] - a[SIGMA_Z], lambda * (b[SIGMA_X] - a[SIGMA_X]), 1e-12,
            "nu = %g: uniaxial strain behind it", nu);
  ct_exact_speeds(nu, &c2, NULL, NULL);
  for (int i = 1; i < 15; i++) {
    const double angle = 0.1 * i, t = 0.8;
    for (int wave = 0; wave < 2; wave++) {
      const double r = wave ? c2 * t : t, x = r * cos(angle), y = r * sin(angle);
      at(x * (1.0 + e), 1.0 - y * (1.0 + e), t, nu, a);
      at(x * (1.0 - e), 1.0 - y * (1.0 - e), t, nu, b);
      for (int k = 0; k < 5; k++) worst = fmax(worst, fabs(a[k] - b[k]));
    }
  }
  tap_ok(worst < 1e-3 * fmax(1.0, 0.1 / nu / nu), "nu = %g: the circular fronts are weak: %.1e", nu,
         worst);
}

/* On the plane front itself: behind it inside the plate; on the face the limit of the points of the
 * face behind it. */
static void on_the_front(double nu)
{
  double f[5], off = 0.0;
  at(0.7, 0.1, 0.7, nu, f);
  const double behind[5] = {-(1.0 - nu) / nu, -1.0, 0.0, 0.0, 0.0},
               ahead[5] = {0.0, 0.0, 0.0, -1.0, 0.0};
  for (int k = 0; k < 5; k++) off = fmax(off, fabs(f[k] - behind[k]) * nu);
  tap_ok(off < 1e-15, "nu = %g: on the plane front the state behind it: %.1e", nu, off);
  at(0.7, 1.0, 0.7, nu, f);
  off = 0.0;
  for (int k = 0; k < 5; k++) off = isnan(f[k]) ? INFINITY : fmax(off, fabs(f[k] - ahead[k]) * nu);
  tap_ok(off < 1e-14,
         "nu = %g: where the front meets the face all is continuous along the face: %.1e", nu, off);
}

/* eq:exact-sum: the two faces change places. */
static void mirror_is_exact(double nu)
{
  unsigned seed = 11;
  int differ = 0;
  for (int i = 0; i < 500; i++) {
    const double t = 1.99 * uniform(&seed), x = t * uniform(&seed), z = uniform(&seed);
    double f[5], g[5];
    at(x, z, t, nu, f);
    at(x, -z, t, nu, g);
    differ += f[SIGMA_X] != g[SIGMA_X] || f[SIGMA_Z] != g[SIGMA_Z] || f[TAU] != -g[TAU] ||
              f[V_X] != g[V_X] || f[V_Z] != -g[V_Z];
  }
  tap_ok(differ == 0, "nu = %g: the same bits at -z", nu);
}

/* Rayleigh's equation, not squared (eq:exact-rayleigh-cubic); infinite velocity with its sign
 * (eq:exact-logarithm). */
static void rayleigh_speed(double nu)
{
  double c2, c_r;
  ct_exact_speeds(nu, &c2, &c_r, NULL);
  tap_close(c2 * c2, (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu)), 1e-15, "nu = %g: c2", nu);
  const double x = c_r * c_r / (c2 * c2);
  tap_close((2.0 - x) * (2.0 - x), 4.0 * sqrt(1.0 - x) * sqrt(1.0 - c_r * c_r), 1e-14,
            "nu = %g: Rayleigh's equation", nu);
  double f[5], below[5], above[5];
  at(0.7 * c_r, 1.0, 0.7, nu, f);
  at(0.7 * c_r * (1.0 - 1e-9), 1.0, 0.7, nu, below);
  at(0.7 * c_r * (1.0 + 1e-9), 1.0, 0.7, nu, above);
  tap_ok(isinf(f[V_Z]) && (f[V_Z] > 0.0) == (below[V_Z] > above[V_Z] - 10.0 && below[V_Z] > 0.0),
         "nu = %g: v_z is infinite at x = c_R t with the sign of its neighbours", nu);
  tap_close(f[SIGMA_X], below[SIGMA_X], 1e-9 / nu, "nu = %g: sigma_x there is the value behind",
            nu);
  tap_ok(fabs(above[SIGMA_X] - below[SIGMA_X]) > 1e-2, "nu = %g: sigma_x jumps there", nu);
}

/* Values by mpmath, 30 digits: Gauss-Legendre on the integrals of Cagniard in the plane of the
 * slowness. They need every term: eq:exact-kappa, eq:exact-cagniard, eq:exact-face, eq:exact-head,
 * eq:exact-uniform, eq:exact-periods, eq:exact-kernels, eq:exact-residue, eq:exact-theta,
 * eq:exact-primitive, eq:exact-infinity, eq:exact-alpha, eq:exact-linear; nu = 0.26308 also
 * eq:exact-circle. */
static void quadrature_values(void)
{
  static const double want[][9] = {
      {0.1, 0.7, 0.56, 0.3, -2.2001447356673078, -0.20827504601074665, -0.18473590978722257,
       -0.080962286780021347, 0.32713352656751316},
      {0.4, 0.8, 0.56, 0.3, -1.8419347724247435, -0.61581838186310733, -0.22509976533431811,
       -0.21896513085800257, 0.17871736427483631},
      {0.4, 0.95, 0.56, 0.3, -2.2650607404346452, 0.00021007742536547689, -0.0088291993433263476,
       0.14597960499611246, 0.48371111422631485},
      {0.05, 0.99, 0.56, 0.3, -1.7576060205639206, 0.00022497849635000626, -7.0043302656734859e-05,
       0.0010960323832887909, 0.35201896389036891},
      {0.6, -0.3, 1.7, 0.3, -1.838328255533382, 0.082716218378585324, 0.28962985039179118,
       -0.25371464350894268, -0.16409172967656524},
      {0.02, 0.0, 1.95, 0.3, -2.2164243313358538, 0.8216773074623106, 0, -0.00077664951413522519,
       0},
      {0.3, 0.9, 0.7, 0.01, -98.921851457573297, 0.044320364859764878, -0.054236042215950783,
       0.0012998166755966388, 0.0096544983444027226},
      {0.2, 0.4, 1.1, 0.1, -9.1227009919007997, -0.11498575885902039, -0.097132648945752645,
       0.0042028286869769801, 0.085833473010876155},
      {0.41, 0.98, 0.7, 0.25, -2.8977477188630698, -0.018927265432123464, -0.022657833658105225,
       0.08759662299891427, 0.39478615535678541},
      {0.377, 0.98, 0.7, 0.263, -2.5444310309866225, -0.050082604620542932, -0.091457146489304822,
       0.059660772645547075, 0.47855366618083583},
      {0.5, -0.6, 1.2, 0.26308206488336, -2.8255268973699761, 0.068876269618807412,
       0.17433764956600342, 0.089123880029006911, -0.40784799556244788},
      {0.9, 0.85, 1.3, 0.4, -0.89059252002872502, -0.21311748879384307, -0.092630694545848283,
       -0.1956174947526674, 0.55273664525370714},
      {0.1, 0.2, 1.8, 0.45, -0.35536365406046555, 0.33908321273152492, -0.016736767469932357,
       -0.085116170384637216, 0.23749437938347878},
      {0.2, 0.97, 0.9, 0.49, -0.22530966885499498, -0.011088170864727954, 0.00010391549919849275,
       0.096517098970130569, 1.5459895272863959},
  };
  for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
    const double *w = want[i];
    double f[5], off = 0.0;
    at(w[0], w[1], w[2], w[3], f);
    for (int k = 0; k < 5; k++)
      off = fmax(off, fabs(f[k] - w[4 + k]) / fmax(1.0, k == 0 ? 1.0 / w[3] : 1.0));
    tap_ok(off < 5e-13, "quadrature at x = %g, z = %g, t = %g, nu = %g: %.1e", w[0], w[1], w[2],
           w[3], off);
  }
}

/* eq:exact-linear: the remainder after the large terms of both waves cancel. */
static void corner_is_self_similar(void)
{
  double a[5], b[5];
  at(0.0, 1.0, 0.5, 0.3, a);
  for (int i = 1; i < 30; i += 4) {
    const double r = pow(10.0, -i);
    at(0.6 * r, 1.0 - 0.8 * r, 0.5, 0.3, b);
    double off = 0.0;
    for (int k = 0; k < 5; k++) off = fmax(off, fabs(a[k] - b[k]));
    if (i > 1)
      tap_ok(off < 4.0 * r + 1e-13, "at %g from the corner the fields tend to its own: %.1e", r,
             off);
  }
  at(0.0, 1.0, 0.0, 0.3, b);
  tap_ok(memcmp(a, b, sizeof a) == 0, "the corner at t = 0 has the values behind all fronts");
}

/* eq:exact-validity, and points outside the plate. */
static void bad_input_is_refused(void)
{
  ct_error error;
  size_t bad;
  double field[15];
  const struct {
    double x, z, t, length;
    const char *word;
  } wrong[] = {{-0.1, 0, 0.5, INFINITY, "x < 0"},       {0.1, 1.5, 0.5, INFINITY, "|z|"},
               {0.1, -1.0001, 0.5, INFINITY, "|z|"},    {0.1, 0, -1, INFINITY, "t < 0"},
               {0.1, 0, 2, INFINITY, "t >= 2"},         {1.5, 0, 0.5, 1, "2 length"},
               {NAN, 0, 0.5, INFINITY, "number"},       {0, NAN, 0.5, INFINITY, "number"},
               {0, 0, NAN, INFINITY, "number"},         {1.2, 0, 0.5, 1, "x > length"},
               {INFINITY, 0, 0.5, INFINITY, "2 length"}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    const double x[3] = {0.1, wrong[i].x, -1}, z[3] = {0, wrong[i].z, 0},
                 t[3] = {0.5, wrong[i].t, 0.5};
    field[0] = 77.0;
    const ct_status s = ct_exact_plates(3, x, z, t, 0.3, wrong[i].length, field, &bad, &error);
    tap_ok(s == CT_ERROR_ARGUMENT && bad == 1 && error.point == 1 &&
               strstr(error.text, wrong[i].word) != NULL && field[0] == 77.0,
           "refused: %s", error.text);
  }
  const double one = 0.1, nus[] = {0.0, -0.1, 0.495, 0.5, NAN};
  for (size_t i = 0; i < sizeof nus / sizeof *nus; i++)
    tap_ok(ct_exact_plates(1, &one, &one, &one, nus[i], INFINITY, field, &bad, &error) ==
                   CT_ERROR_ARGUMENT &&
               bad == 1 && strstr(error.text, "nu") != NULL &&
               ct_exact_speeds(nus[i], NULL, NULL, NULL) != CT_OK,
           "refused: nu = %g", nus[i]);
  tap_ok(ct_exact_plates(0, NULL, NULL, NULL, 0.3, INFINITY, NULL, NULL, NULL) == CT_OK,
         "no points are no error");
  tap_ok(ct_exact_plates(1, &one, &one, &one, 0.3, INFINITY, NULL, NULL, NULL) == CT_ERROR_ARGUMENT,
         "null fields are refused");
}

int main(void)
{
  for (int i = 0; i < RATIOS; i++) {
    equations_hold(ratios[i]);
    faces_are_free(ratios[i]);
    fronts_jump(ratios[i]);
    on_the_front(ratios[i]);
    mirror_is_exact(ratios[i]);
    rayleigh_speed(ratios[i]);
  }
  quadrature_values();
  corner_is_self_similar();
  bad_input_is_refused();
  return tap_done();
}
