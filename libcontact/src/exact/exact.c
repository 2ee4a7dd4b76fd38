/* Closed form of the impact of two thick plates (docs/theory/exact.rst).
 *
 * d = c1 = density = v0 = 1, stresses over Lambda. kappa = c1/c2, kappa2 = kappa^2, ell =
 * kappa^2 - 2 = Lambda/mu. p is the slowness along the face, q = p^2, gamma1 = sqrt(1 - q), gamma2
 * = sqrt(kappa^2 - q). All of them are elliptic functions of one variable u with modulus 1/kappa: p
 * = sn u, gamma1 = cn u, gamma2 = kappa dn u; K and iK' are the quarter periods and W = u - K. */
#include <libcontact/exact.h>
#include "../base/error.h"

#include "points.h"

#include <complex.h>
#include <float.h>
#include <math.h>

typedef double complex ct_complex;

static const double PI = 3.14159265358979323846;

/* The five fields of one face: s_x, s_y, s_xy, v_x, v_y, with y the depth below the face. */
enum { SX, SY, SXY, VX, VY, FIELDS };
enum { WAVE_P, WAVE_S, WAVES };
/* Two poles that nearly coincide are replaced by this many points on a circle around them. */
enum { CIRCLE = 24, POLES_MAX = CIRCLE + 2 };

/* A point of the torus. */
typedef struct ct_torus {
  ct_complex p, gamma1, gamma2, w; /* w = u - K */
} ct_torus;

/* A pole u = a of the integrands; they are even or odd, so that -a is one too. */
typedef struct ct_pole {
  ct_complex angle, sine, cosine; /* pi (a - K)/4K, its sine and cosine */
  ct_complex unit[4];             /* 1/theta of the four logarithms at the middle of the quarter */
  ct_complex residue[WAVES][FIELDS]; /* of F dp/du at u = a */
} ct_pole;

/* Data that depend on Poisson's ratio alone. */
typedef struct ct_plates {
  double nu, kappa, kappa2, ell, c_r;
  double modulus1;        /* sqrt(1 - 1/kappa^2) */
  double k, k1, scale;    /* the quarter periods K, K'; pi/4K */
  double nome, root_nome; /* exp(-pi K'/K) and its root */
  int poles;              /* the last is u = K, a pole of the dilatational wave alone */
  ct_complex w_r;         /* W of the Rayleigh pole */
  ct_pole pole[POLES_MAX];
  double infinity[FIELDS]; /* size of F at p = infinity; the shear wave has the opposite */
  ct_complex slope[WAVES][FIELDS];
  double origin[WAVES][FIELDS]; /* Im of the primitive at p = 0 */
} ct_plates;

static ct_complex square(ct_complex a) { return a * a; }

/* Carlson's R_F of (a^2, b^2, c^2) by duplication; the roots are given because their signs choose
 * the sheet. */
static ct_complex carlson_rf(ct_complex a, ct_complex b, ct_complex c)
{
  ct_complex x = square(a), y = square(b), z = square(c);
  const ct_complex mean0 = (x + y + z) / 3.0;
  double spread = 500.0 * fmax(cabs(mean0 - x), fmax(cabs(mean0 - y), cabs(mean0 - z)));
  ct_complex mean = mean0;
  double scale = 1.0;
  const ct_complex x0 = x, y0 = y;
  for (int i = 0; i < 600 && !(spread < cabs(mean)); i++) {
    const ct_complex lambda = a * b + (b * c + c * a);
    x = 0.25 * (x + lambda), y = 0.25 * (y + lambda), z = 0.25 * (z + lambda);
    mean = 0.25 * (mean + lambda);
    a = csqrt(x), b = csqrt(y), c = csqrt(z);
    spread *= 0.25, scale *= 0.25;
  }
  const ct_complex dx = scale * (mean0 - x0) / mean, dy = scale * (mean0 - y0) / mean,
                   dz = -(dx + dy);
  const ct_complex e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
  return (1.0 + e2 * (-0.1 + e2 / 24.0 - 3.0 * e3 / 44.0) + e3 / 14.0) / csqrt(mean);
}

/* u - K from p, gamma1, gamma2. */
static ct_complex torus_w(const ct_plates *e, ct_complex p, ct_complex gamma1, ct_complex gamma2)
{
  // (eq:exact-uniform)
  return -gamma1 * carlson_rf(e->modulus1 * p, e->modulus1, gamma2 / e->kappa);
}

/* theta1(z)/(2 q^(1/4)) and theta4(z) of nome q, given sin z. */
static void thetas(double q, ct_complex sine, ct_complex *theta1, ct_complex *theta4)
{
  const double q2 = q * q, q4 = q2 * q2, q6 = q4 * q2, q8 = q4 * q4;
  const ct_complex c2 = 1.0 - 2.0 * square(sine), c4 = 2.0 * square(c2) - 1.0,
                   c6 = c2 * (2.0 * c4 - 1.0);
  const ct_complex c8 = 2.0 * square(c4) - 1.0;
  const ct_complex d1 = 1.0 + 2.0 * c2, d2 = d1 + 2.0 * c4, d3 = d2 + 2.0 * c6;
  // (eq:exact-theta)
  *theta1 = sine * (1.0 - q2 * d1 + q6 * d2 - q6 * q6 * d3);
  *theta4 = 1.0 - 2.0 * (q * c2 - q4 * c4 + q8 * q * c6 - q8 * q8 * c8);
}

/* The four logarithms of a pole, combined for the fields that are even or odd in u and keep or
 * change their sign under u -> u + 2iK' (eq:exact-primitive); `unit` holds the reciprocal values
 * that fix the branch. */
typedef struct ct_logs {
  ct_complex even, odd, even_turned, odd_turned;
} ct_logs;

/* Data of a point for the sums over the poles: pi W/4K, its sine and cosine. */
typedef struct ct_angle {
  ct_complex angle, sine, cosine;
} ct_angle;

static ct_angle angle_of(const ct_plates *e, ct_complex w)
{
  const ct_complex z = e->scale * w;
  return (ct_angle){z, csin(z), ccos(z)};
}

/* theta1 and theta4 of u - a and of u + a. */
static void pole_thetas(const ct_plates *e, const ct_pole *a, const ct_angle *u,
                        ct_complex theta[4])
{
  const ct_complex sine = u->sine, cosine = u->cosine, near = u->angle - a->angle;
  const ct_complex sine_near = cabs(near) < 0.05 ? csin(near) : sine * a->cosine - cosine * a->sine;
  thetas(e->nome, sine_near, &theta[0], &theta[1]);
  thetas(e->nome, cosine * a->cosine - sine * a->sine, &theta[2], &theta[3]);
}

static ct_logs pole_logs(const ct_plates *e, const ct_pole *a, const ct_angle *u)
{
  ct_complex theta[4];
  pole_thetas(e, a, u, theta);
  for (int i = 0; i < 4; i++) theta[i] = clog(theta[i] * a->unit[i]);
  const ct_complex keep1 = theta[0] + theta[1], keep2 = theta[2] + theta[3];
  const ct_complex turn1 = theta[0] - theta[1], turn2 = theta[2] - theta[3];
  return (ct_logs){keep1 - keep2, keep1 + keep2, turn1 - turn2, turn1 + turn2};
}

/* theta3(pi u/4K) of the root of the nome and its logarithmic derivative in u, given sin and cos of
 * pi W/4K. */
static void theta3(const ct_plates *e, ct_complex sine, ct_complex cosine, ct_complex *value,
                   ct_complex *slope)
{
  const ct_complex c = -2.0 * sine * cosine, s = 1.0 - 2.0 * square(sine);
  ct_complex c0 = 1.0, s0 = 0.0, c1 = c, s1 = s, sum = 1.0, derivative = 0.0;
  double power = e->root_nome, ratio = power;
  for (int n = 1; n <= 6; n++) {
    sum += 2.0 * power * c1;
    derivative -= 4.0 * n * power * s1;
    const ct_complex c2 = 2.0 * c * c1 - c0, s2 = 2.0 * c * s1 - s0;
    c0 = c1, c1 = c2, s0 = s1, s1 = s2;
    ratio *= e->nome;
    power *= ratio;
  }
  *value = sum;
  *slope = e->scale * derivative / sum;
}

/* Im of the primitives of the five integrands of one wave, without the part that is linear in p at
 * infinity. */
static void primitives(const ct_plates *e, int wave, const ct_torus *point, double out[FIELDS])
{
  // -- Sum the logarithms of the poles (eq:exact-primitive)
  const ct_angle angle = angle_of(e, point->w);
  ct_complex sum[FIELDS] = {0.0, 0.0, 0.0, 0.0, 0.0};
  const int poles = wave == WAVE_P ? e->poles : e->poles - 1;
  for (int j = 0; j < poles; j++) {
    const ct_logs l = pole_logs(e, &e->pole[j], &angle);
    const ct_complex *r = e->pole[j].residue[wave];
    sum[SX] += r[SX] * l.even;
    sum[SY] += r[SY] * l.even;
    sum[VX] += r[VX] * l.odd;
    sum[VY] += r[VY] * l.even_turned;
    sum[SXY] += r[SXY] * l.odd_turned;
  }
  // -- Add what is left at infinity (eq:exact-infinity)
  const double sign = wave == WAVE_P ? 1.0 : -1.0;
  const ct_complex g1 = point->gamma1, g2 = point->gamma2;
  ct_complex value, slope;
  theta3(e, angle.sine, angle.cosine, &value, &slope);
  const ct_complex u = point->w + e->k;
  for (int f = SX; f <= SY; f++)
    sum[f] += e->slope[wave][f] * u + sign * e->infinity[f] * e->kappa * slope;
  sum[SXY] += e->infinity[SXY] * (e->kappa2 - 1.0) / (g1 + g2);
  sum[VX] += sign * e->infinity[VX] * (clog(value) - clog(g1 + g2));
  sum[VY] += sign * e->infinity[VY] * 0.5 * I * (clog(point->p + I * g1) + clog(point->p + I * g2));
  for (int f = 0; f < FIELDS; f++) out[f] = cimag(sum[f]) - e->origin[wave][f];
}

/* Numerators N of F dp/du = N/R; the pole factor 1/gamma1 of the dilatational
 * wave is kept. */
static void numerators(const ct_plates *e, ct_complex p, ct_complex g1, ct_complex g2,
                       ct_complex n[WAVES][FIELDS])
{
  const ct_complex q = p * p, a = e->ell + 2.0 * square(g1), g = 2.0 / e->kappa * g2 / g1;
  const double h = 2.0 / e->kappa;
  // (eq:exact-kernels)
  n[WAVE_P][SX] = g * a * (e->ell + 2.0 * q);
  n[WAVE_P][SY] = g * a * a;
  n[WAVE_P][SXY] = -2.0 * h * p * g2 * a;
  n[WAVE_P][VX] = e->ell * g * p * a;
  n[WAVE_P][VY] = -e->ell * h * g2 * a;
  n[WAVE_S][SY] = 4.0 * h * q * g2 * g2;
  n[WAVE_S][SX] = -n[WAVE_S][SY];
  n[WAVE_S][SXY] = -n[WAVE_P][SXY];
  n[WAVE_S][VX] = -2.0 * e->ell * h * p * g2 * g2;
  n[WAVE_S][VY] = -2.0 * e->ell * h * q * g2;
}

/* kappa dR/du. */
static ct_complex rayleigh_slope(const ct_plates *e, ct_complex p, ct_complex g1, ct_complex g2)
{
  const ct_complex q = p * p, g = g1 * g2, a = e->ell + 2.0 * square(g1);
  return p * (8.0 * g * (g - a) - 4.0 * q * (g1 * g1 + g2 * g2)); // (eq:exact-residue)
}

/* Enter a pole at W = b with the weight `weight` on the numerators there. */
static void pole_add(ct_plates *e, ct_complex p, ct_complex g1, ct_complex g2, ct_complex b,
                     ct_complex weight)
{
  ct_pole *a = &e->pole[e->poles++];
  a->angle = e->scale * b;
  a->sine = csin(a->angle);
  a->cosine = ccos(a->angle);
  numerators(e, p, g1, g2, a->residue);
  for (int w = 0; w < WAVES; w++)
    for (int f = 0; f < FIELDS; f++) a->residue[w][f] *= weight;
}

/* Speed of the Rayleigh wave over c2, squared: the root in (0, 1) of the cubic. */
static double rayleigh_root(double kappa2)
{
  const double b = 24.0 - 16.0 / kappa2, c = 16.0 - 16.0 / kappa2;
  double low = 0.0, high = 1.0, x = 0.85;
  for (int i = 0; i < 100; i++) {
    const double value = ((x - 8.0) * x + b) * x - c; // (eq:exact-rayleigh-cubic)
    if (value > 0.0) high = x;
    else low = x;
    double next = x - value / ((3.0 * x - 16.0) * x + b);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (fabs(next - x) <= DBL_EPSILON * x) return next;
    x = next;
  }
  return x;
}

/* gamma1 at a zero of R on the sheet where gamma1 has the other sign, from its approximate value.
 */
static ct_complex polish_sheet(const ct_plates *e, ct_complex g)
{
  for (int i = 0; i < 4; i++) {
    const ct_complex s = g * g, g2 = csqrt(e->kappa2 - 1.0 + s), a = e->ell + 2.0 * s;
    const ct_complex value = a * a - 4.0 * (1.0 - s) * g * g2;
    const ct_complex slope = 8.0 * a * g + 8.0 * s * g2 - 4.0 * (1.0 - s) * (g2 + s / g2);
    g -= value / slope;
  }
  return g;
}

/* Poles on the sheet where gamma1 has the other sign, a = 2K - sn^-1(p): given gamma1 there with
 * its sign turned. */
static void other_sheet_add(ct_plates *e, ct_complex g, ct_complex weight)
{
  const ct_complex p = csqrt((1.0 - g) * (1.0 + g)), g2 = csqrt(e->kappa2 - 1.0 + g * g);
  const ct_complex b = -torus_w(e, p, g, g2);
  if (weight == 0.0) {
    // -- A simple zero of R (eq:exact-residue)
    pole_add(e, p, -g, g2, b, e->kappa / rayleigh_slope(e, p, -g, g2));
    return;
  }
  // -- A point of the circle round two close zeros (eq:exact-circle)
  const ct_complex a = e->ell + 2.0 * g * g, r = a * a - 4.0 * p * p * g * g2;
  pole_add(e, p, -g, g2, b, weight * e->kappa / (p * g2 * r));
}

/* The zeros of R (eq:exact-rayleigh-cubic) and the pole p = 1. */
static void plates_poles(ct_plates *e)
{
  // -- The Rayleigh wave
  const double x = rayleigh_root(e->kappa2), p = e->kappa / sqrt(x);
  e->c_r = 1.0 / p;
  e->poles = 0;
  const ct_complex g1 = -I * sqrt((p - 1.0) * (p + 1.0)), g2 = -I * p * sqrt(1.0 - x);
  e->w_r = creal(torus_w(e, p, g1, g2)) + I * e->k1;
  pole_add(e, p, g1, g2, e->w_r, e->kappa / rayleigh_slope(e, p, g1, g2));
  // -- The two zeros on the other sheet
  const double half = 4.0 - 0.5 * x, product = 16.0 * (1.0 - 1.0 / e->kappa2) / x;
  const ct_complex root = csqrt(half * half - product);
  const ct_complex ga = csqrt(1.0 - e->kappa2 / (half + root)),
                   gb = csqrt(1.0 - e->kappa2 / (half - root));
  const double apart = cabs(ga - gb);
  if (apart > 0.05) {
    other_sheet_add(e, polish_sheet(e, ga), 0.0);
    other_sheet_add(e, polish_sheet(e, gb), 0.0);
  } else {
    const ct_complex centre = 0.5 * (ga + gb);
    for (int i = 0; i < CIRCLE; i++) {
      const ct_complex arm = 0.1 * cexp(I * (2.0 * PI * (i + 0.5) / (double)CIRCLE));
      other_sheet_add(e, centre + arm, arm / (double)CIRCLE);
    }
  }
  // -- The front that runs along the face: u = K (eq:exact-residue)
  ct_pole *a = &e->pole[e->poles++];
  *a = (ct_pole){.sine = 0.0, .cosine = 1.0};
  a->residue[WAVE_P][SX] = -2.0 * e->kappa2 / e->ell;
  a->residue[WAVE_P][SY] = -2.0;
  a->residue[WAVE_P][VX] = -2.0;
}

/* d/dz of log theta1(z) + log theta4(z). */
static ct_complex theta_slope(const ct_plates *e, ct_complex z)
{
  ct_complex sum = ccos(z) / csin(z);
  double power = e->nome;
  for (int n = 1; n <= 26; n++, power *= e->nome)
    sum += 4.0 * power / (1.0 - power) * csin(2.0 * n * z);
  return sum;
}

/* The linear terms that make the derivative at p = 0 right, and the values there (eq:exact-alpha).
 */
static void plates_origin(ct_plates *e)
{
  // -- Slope of theta3 at u = 0, doubled
  double power = e->root_nome, ratio = power, value = 1.0, bend = 0.0;
  for (int n = 1; n <= 6; n++) {
    value += 2.0 * power;
    bend -= 8.0 * n * n * power;
    ratio *= e->nome;
    power *= ratio;
  }
  bend *= e->scale * e->scale / value;
  // -- Choose the slopes (eq:exact-alpha)
  ct_complex n[WAVES][FIELDS];
  numerators(e, 0.0, 1.0, e->kappa, n);
  for (int wave = 0; wave < WAVES; wave++)
    for (int f = SX; f <= SY; f++) {
      const double at_infinity = wave == WAVE_P ? e->infinity[f] : -e->infinity[f];
      e->slope[wave][f] =
          n[wave][f] / (e->kappa2 * e->kappa2) - at_infinity * (e->kappa * bend + 1.0);
    }
  for (int j = 0; j < e->poles; j++) {
    const ct_pole *a = &e->pole[j];
    const ct_complex s = 2.0 * e->scale * theta_slope(e, 0.25 * PI + a->angle);
    for (int wave = 0; wave < WAVES; wave++)
      for (int f = SX; f <= SY; f++) e->slope[wave][f] += a->residue[wave][f] * s;
  }
  // -- Values at p = 0
  const ct_torus zero = {0.0, 1.0, e->kappa, -e->k};
  for (int wave = 0; wave < WAVES; wave++) {
    double origin[FIELDS];
    for (int f = 0; f < FIELDS; f++) e->origin[wave][f] = 0.0;
    primitives(e, wave, &zero, origin);
    for (int f = 0; f < FIELDS; f++) e->origin[wave][f] = origin[f];
  }
}

static double mean_agm(double a, double b)
{
  for (int i = 0; i < 40 && fabs(a - b) > 4.0 * DBL_EPSILON * a; i++) {
    const double c = 0.5 * (a + b);
    b = sqrt(a * b);
    a = c;
  }
  return 0.5 * (a + b);
}

static void plates_init(ct_plates *e, double nu)
{
  e->nu = nu;
  // -- Ratio of the speeds (eq:exact-kappa)
  e->ell = 2.0 * nu / (1.0 - 2.0 * nu);
  e->kappa2 = 2.0 + e->ell;
  e->kappa = sqrt(e->kappa2);
  e->modulus1 = sqrt(1.0 - 1.0 / e->kappa2);
  // -- Periods of the torus (eq:exact-periods)
  e->k = 0.5 * PI / mean_agm(1.0, e->modulus1);
  e->k1 = 0.5 * PI / mean_agm(1.0, 1.0 / e->kappa);
  e->scale = 0.25 * PI / e->k;
  e->nome = exp(-PI * e->k1 / e->k);
  e->root_nome = sqrt(e->nome);
  plates_poles(e);
  // -- Branches of the logarithms: none is cut inside the quarter
  const ct_angle middle = angle_of(e, 0.5 * (I * e->k1 - e->k));
  for (int j = 0; j < e->poles; j++) {
    ct_complex theta[4];
    pole_thetas(e, &e->pole[j], &middle, theta);
    for (int i = 0; i < 4; i++) e->pole[j].unit[i] = 1.0 / theta[i];
  }
  // -- Behaviour at p = infinity (eq:exact-infinity)
  const double s = 1.0 / (e->kappa2 - 1.0);
  e->infinity[SX] = -4.0 * s;
  e->infinity[SY] = 4.0 * s;
  e->infinity[SXY] = 2.0 * s;
  e->infinity[VX] = 2.0 * e->ell * s;
  e->infinity[VY] = -2.0 * e->ell * s;
  plates_origin(e);
}

/* sqrt(c - p^2) for p in the first quadrant: the root in the fourth. */
static ct_complex gamma_root(double c, ct_complex gamma, double other)
{
  const ct_complex root = csqrt((c - other) + gamma * gamma);
  return cimag(root) > 0.0 ? conj(root) : root;
}

/* One Cagniard point: x/r, y/r, t/r, and (t^2 - c^2 r^2)/r^2 with c the slowness of the wave (1 or
 * kappa). */
typedef struct ct_cagniard {
  double cosine, sine, time, square;
} ct_cagniard;

static ct_torus cagniard_point(const ct_plates *e, int wave, const ct_cagniard *c)
{
  ct_torus point;
  ct_complex gamma;
  // -- Cagniard's points (eq:exact-cagniard)
  if (c->square >= 0.0) {
    const double root = sqrt(c->square);
    point.p = c->cosine * c->time + I * (c->sine * root);
    gamma = c->sine * c->time - I * (c->cosine * root);
  } else {
    const double root = sqrt(-c->square);
    point.p = c->cosine * c->time - c->sine * root;
    gamma = c->sine * c->time + c->cosine * root;
  }
  if (wave == WAVE_P) {
    point.gamma1 = gamma;
    point.gamma2 = gamma_root(e->kappa2, gamma, 1.0);
  } else {
    point.gamma2 = gamma;
    point.gamma1 = gamma_root(1.0, gamma, e->kappa2);
  }
  point.w = torus_w(e, point.p, point.gamma1, point.gamma2);
  return point;
}

/* On the face itself p is real, both waves have the same point, and the fronts are met from behind.
 */
static void face_point(const ct_plates *e, ct_torus *point)
{
  const double p = creal(point->p), p_r = 1.0 / e->c_r;
  if (p >= e->kappa) point->w = creal(point->w) + I * e->k1;
  if (fabs(p - p_r) <= 4.0 * DBL_EPSILON * p_r) point->w = e->w_r - 8.0 * DBL_EPSILON * e->k;
  if (p <= 1.0) point->w = I * DBL_MIN;
}

/* The waves that one free face sends to depth y (eq:exact-face). */
static void face_waves(const ct_plates *e, double x, double y, double t, double out[FIELDS])
{
  for (int f = 0; f < FIELDS; f++) out[f] = 0.0;
  // -- Directions and times over r; the corner itself is the limit r -> 0
  const double r = hypot(x, y), far = 1e100;
  ct_cagniard c = {0.0, 1.0, far, far * far};
  if (r > t / far) {
    c = (ct_cagniard){x / r, y / r, t / r, (((t - x) * (t + x) - y * y) / r) / r};
    if (c.square < 0.0) return;
  }
  ct_cagniard cs = c;
  cs.square = r > t / far ? (c.time - e->kappa) * (c.time + e->kappa) : c.square;
  // -- The dilatational wave (eq:exact-face)
  double part[FIELDS];
  ct_torus p = cagniard_point(e, WAVE_P, &c);
  if (c.sine == 0.0) face_point(e, &p);
  primitives(e, WAVE_P, &p, out);
  double linear_x = -c.cosine * sqrt(c.square), linear_y = c.sine * sqrt(c.square);
  // -- The shear wave, from the head wave on (eq:exact-head)
  int shear = cs.square >= 0.0;
  if (!shear && c.cosine * e->kappa > 1.0)
    shear = c.cosine * c.time - c.sine * sqrt(-cs.square) >= 1.0;
  if (shear) {
    const ct_torus s = c.sine == 0.0 ? p : cagniard_point(e, WAVE_S, &cs);
    primitives(e, WAVE_S, &s, part);
    for (int f = 0; f < FIELDS; f++) out[f] += part[f];
    if (cs.square >= 0.0) {
      const double difference = (e->kappa2 - 1.0) / (sqrt(c.square) + sqrt(cs.square));
      linear_x = -c.cosine * difference;
      linear_y = c.sine * difference;
    }
  }
  // -- The part that is linear in p, its two waves subtracted by hand (eq:exact-linear)
  out[SX] += e->infinity[SX] * linear_y;
  out[SY] += e->infinity[SY] * linear_y;
  out[SXY] += e->infinity[SXY] * 2.0 * linear_x;
  for (int f = 0; f < FIELDS; f++) out[f] /= PI;
  out[VX] = -out[VX];
  out[SXY] = -out[SXY];
}

/* Why a point is outside the validity of the closed form; null when it is inside. */
static const char *refusal(double x, double z, double t, double length)
{
  (void)z;
  // (eq:exact-validity)
  if (t >= 2.0) return "t >= 2: the waves of one free face have reached the other";
  if (t + x >= 2.0 * length) return "t + x >= 2 length: the waves of the far end have arrived";
  if (x > length) return "x > length lies outside the plate";
  return NULL;
}

/* v_y on the face itself at x = c_R t: infinite, with the sign of the residue. */
static double rayleigh_infinity(const ct_plates *e)
{
  const ct_pole *a = &e->pole[0];
  // (eq:exact-logarithm)
  return cimag(a->residue[WAVE_P][VY] + a->residue[WAVE_S][VY]) > 0.0 ? -INFINITY : INFINITY;
}

/* Sum of the plane wave and of the waves of both faces. */
static void plates_point(const ct_plates *e, double x, double z, double t, double out[FIELDS])
{
  double upper[FIELDS], lower[FIELDS];
  face_waves(e, x, 1.0 - z, t, upper);
  face_waves(e, x, 1.0 + z, t, lower);
  const int behind = x <= t;
  // The plane wave (eq:exact-plane) and the faces (eq:exact-sum)
  out[SX] = (behind ? -e->kappa2 / e->ell : 0.0) + (upper[SX] + lower[SX]);
  out[SY] = (behind ? -1.0 : 0.0) + (upper[SY] + lower[SY]);
  out[SXY] = lower[SXY] - upper[SXY];
  out[VX] = (behind ? 0.0 : -1.0) + (upper[VX] + lower[VX]);
  out[VY] = lower[VY] - upper[VY];
  if (fabs(z) == 1.0 && t > 0.0 && fabs(x - e->c_r * t) <= 4.0 * DBL_EPSILON * x)
    out[VY] = -z * rayleigh_infinity(e);
}

ct_status ct_exact_speeds(double nu, double *c2, double *c_r, ct_error *error)
{
  if (!(nu > 0.0 && nu <= 0.49))
    return CT_REFUSE(error, "nu = %g, Poisson's ratio must be in (0, 0.49]", nu);
  const double kappa2 = 2.0 + 2.0 * nu / (1.0 - 2.0 * nu);
  if (c2 != NULL) *c2 = sqrt(1.0 / kappa2);
  if (c_r != NULL) *c_r = sqrt(rayleigh_root(kappa2) / kappa2);
  return CT_OK;
}

ct_status ct_exact_plates(size_t n, const double *x, const double *z, const double *t, double nu,
                          double length, double *fields, size_t *bad, ct_error *error)
{
  if (bad != NULL) *bad = n;
  if (!(nu > 0.0 && nu <= 0.49))
    return CT_REFUSE(error, "nu = %g, Poisson's ratio must be in (0, 0.49]", nu);
  if (!(length > 0.0)) return CT_REFUSE(error, "length = %g, must be positive", length);
  ct_status status = ct_exact_check(n, x, z, t, fields, refusal, length, bad, error);
  if (status != CT_OK) return status;
  ct_plates e;
  plates_init(&e, nu);
  for (size_t i = 0; i < n; i++) plates_point(&e, x[i], z[i], t[i], fields + FIELDS * i);
  return CT_OK;
}
