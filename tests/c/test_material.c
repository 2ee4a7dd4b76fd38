/* Material constants against identities of elasticity and hand figures. */
#include "bodies.h"

#include <float.h>

static void refused(double young, double poisson, double density, const char *word)
{
  ct_material m = {young, poisson, density, CT_LINEAR};
  ct_error e = {0};
  ct_status status = ct_material_check(&m, &e);
  tap_ok(status == CT_ERROR_ARGUMENT && e.code == status && strstr(e.text, word) != NULL,
         "E %g, nu %g, rho %g is refused: %s", young, poisson, density, e.text);
}

/* Two constants and two speeds by hand, and against formulas that the library does not have
 * (eq:lame, eq:wave-speeds). */
static void constants(void)
{
  ct_material steel = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
  double lambda, mu, c1, c2, off[4] = {0};
  ct_material_lame(&steel, &lambda, &mu);
  ct_material_speeds(&steel, &c1, &c2);
  // By hand: 2.1e5 * 0.3 / (1.3 * 0.4) = 63000 / 0.52 and 2.1e5 / 2.6.
  tap_close(lambda, 63000.0 / 0.52, 1e-9, "steel: Lambda = 63000 / 0.52 MPa");
  tap_close(mu, 1050000.0 / 13.0, 1e-9, "steel: mu = 1050000 / 13 MPa");
  tap_close(c1 / c2, sqrt(3.5), 1e-14, "nu = 0.3: c1 / c2 = sqrt(3.5)");
  tap_close(c1, 6020.183e3, 1.0, "steel: c1 = sqrt(1.47e11 / 4056) = 6020.183 m/s");

  for (int i = 0; i < 1000; i++) {
    ct_material m = {exp(uniform(20.0)), -0.25 + uniform(0.74), exp(uniform(20.0)), CT_LINEAR};
    ct_material_lame(&m, &lambda, &mu);
    ct_material_speeds(&m, &c1, &c2);
    off[0] = worst(off[0], mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu) / m.young - 1.0);
    off[1] = worst(off[1], lambda / (2.0 * (lambda + mu)) - m.poisson);
    off[2] = worst(off[2], c1 * c1 * m.density /
                                   (m.young * (1.0 - m.poisson) /
                                    ((1.0 + m.poisson) * (1.0 - 2.0 * m.poisson))) -
                               1.0);
    off[3] = worst(off[3], c2 * c2 * 2.0 * (1.0 + m.poisson) * m.density / m.young - 1.0);
  }
  // Near nu = 1/2 and -1 the moduli are quotients of differences: a few digits fewer.
  tap_ok(off[0] < 1e-12, "E = mu (3 Lambda + 2 mu) / (Lambda + mu), off by %.2g", off[0]);
  tap_ok(off[1] < 1e-12, "nu = Lambda / 2 (Lambda + mu), off by %.2g", off[1]);
  tap_ok(off[2] < 1e-13, "rho c1^2 is the modulus of uniaxial strain, off by %.2g", off[2]);
  tap_ok(off[3] < 1e-13, "rho c2^2 is the shear modulus, off by %.2g", off[3]);

  ct_material none = {1.0, 0.0, 1.0, CT_LINEAR};
  ct_material_speeds(&none, &c1, &c2);
  tap_ok(c1 == 1.0, "nu = 0, E = rho = 1: c1 = 1, the bar's speed");
}

/* Both sides of each limit (eq:material-range). */
static void limits(void)
{
  ct_material steel = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
  tap_ok(ct_material_check(&steel, NULL) == CT_OK, "steel is accepted");
  tap_ok(ct_material_check(NULL, NULL) == CT_ERROR_ARGUMENT,
         "a null material is refused, also with a null error");
  refused(0.0, 0.3, 1.0, "Young");
  refused(-1.0, 0.3, 1.0, "Young");
  refused(NAN, 0.3, 1.0, "Young");
  refused(INFINITY, 0.3, 1.0, "Young");
  refused(1.0, 0.5, 1.0, "Poisson");
  refused(1.0, -1.0, 1.0, "Poisson");
  refused(1.0, NAN, 1.0, "Poisson");
  refused(1.0, 0.3, -7.8, "density");
  refused(1.0, 0.3, 0.0, "density");
  refused(1.0, 0.3, NAN, "density");
  refused(1.0, 0.3, INFINITY, "density");
  const ct_material least = {DBL_MIN, nextafter(-1.0, 0.0), DBL_MIN, CT_LINEAR},
                    most = {DBL_MAX, nextafter(0.5, 0.0), DBL_MAX, CT_LINEAR};
  tap_ok(ct_material_check(&least, NULL) == CT_OK && ct_material_check(&most, NULL) == CT_OK,
         "values just within the limits are accepted");
}

int main(void)
{
  constants();
  limits();
  return tap_done();
}
