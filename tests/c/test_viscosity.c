/* Bulk viscosity: closed form of a uniform compression, the kernel against the readable form, the
 * bound. */
#include "blocks.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
static const ct_material ROD = {1.0, 0.0, 1.0, CT_LINEAR};

/* Pressure over density at the closing speed x = l |D|: Q1 c1 x and a parabola that continues as
 * its tangent from the slope 0.06 c1 on. */
static double pressure(double linear, double quadratic, double c1, double x)
{
  double a = quadratic * quadratic, knee = a > 0.0 ? 0.03 * c1 / a : INFINITY;
  return linear * c1 * x + (x <= knee ? a * x * x : a * knee * knee + 2.0 * a * knee * (x - knee));
}

/* Forces of the effect on all nodes of a problem at a velocity. */
static void forces(const ct_effect *effect, const double *velocity, double *force)
{
  void *scratch = NULL;
  must(effect->calls->create_scratch, effect, &scratch);
  ct_view view = {.velocity = velocity, .scratch = scratch};
  must(effect->calls->force, effect, &view, force);
  effect->calls->free_scratch(scratch);
}

static double rate_of(const ct_effect *effect, const double *velocity)
{
  ct_view view = {.velocity = velocity};
  double rate = NAN;
  must(effect->calls->bounds.rate, effect, &view, &rate);
  return rate;
}

/* A scene of one mesh with viscosity; `effect` is created for its joined problem. */
static ct_effect *make(ct_scene *scene, const ct_mesh *m, const ct_material *material,
                       double linear, double quadratic)
{
  ct_effect *effect = NULL;
  ct_viscosity_def options = {COOKIE, .linear = linear, .quadratic = quadratic};
  add_body(scene, "block", m, material, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *joined = join_scene(scene);
  must(ct_viscosity_create_effect, &options, joined, &effect);
  return effect;
}

/* v = -D x / 3 on a distorted mesh of cubes: no force inside, and outside that of the pressure,
 * which closed form gives for a cube (eq:volume-rate, eq:bulk-viscosity, eq:element-length,
 * eq:viscous-force). */
static void uniform_compression(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 2, 2, 2, 4, 4, 4);
  ct_scene *scene = new_scene();
  ct_effect *effect = make(scene, m, &STEEL, 0.06, 1.2);
  int n = 3 * m->node_count;
  double *v = numbers(n), *f = numbers(n), D = 40.0, c1, c2, inner = 0.0, end = 0.0;
  for (int i = 0; i < n; i++) v[i] = -D / 3.0 * m->nodes[i];
  ct_material_speeds(&STEEL, &c1, &c2);
  forces(effect, v, f);
  double q = STEEL.density * (0.06 * c1 * 0.5 * D + 1.2 * 1.2 * 0.25 * D * D);
  for (int k = 0; k < m->node_count; k++) {
    double *x = &m->nodes[3 * k];
    if (x[0] == 2.0) end += f[3 * k];
    for (int c = 0; c < 3; c++)
      if (x[0] > 0 && x[0] < 2 && x[1] > 0 && x[1] < 2 && x[2] > 0 && x[2] < 2)
        inner = worst(inner, f[3 * k + c]);
  }
  tap_close(
      end / (4.0 * q), 1.0, 1e-12,
      "cubes compressed at one rate have the pressure rho l D (Q1 c1 + Q2^2 l D) on their faces");
  tap_ok(inner < 1e-13 * largest(f, n), "and no force on inner nodes: %.2g of the largest",
         inner / largest(f, n));
  for (int i = 0; i < n; i++) v[i] = -v[i];
  forces(effect, v, f);
  tap_ok(largest(f, n) == 0.0, "expansion causes no force");
  for (int k = 0; k < m->node_count; k++)
    for (int c = 0; c < 3; c++) v[3 * k + c] = 1e3 + c;
  forces(effect, v, f);
  tap_ok(largest(f, n) == 0.0, "a translation causes none, exactly");
  for (int k = 0; k < m->node_count; k++) {
    const double *x = &m->nodes[3 * k];
    double spin[3] = {-3 * x[1] + 7 * x[2], 3 * x[0] - 5 * x[2], 5 * x[1] - 7 * x[0]};
    memcpy(&v[3 * k], spin, sizeof spin);
  }
  forces(effect, v, f);
  tap_ok(largest(f, n) < 1e-13 * q,
         "a rotation causes no force except rounding, %.2g of the pressure", largest(f, n) / q);
  ct_effect_free(effect);
}

/* The forces of a distorted mesh against the formulas of one element, their work and resultant, and
 * mirror images (eq:volume-rate, eq:bulk-viscosity, eq:viscous-force). */
static void kernel(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 5, 4, 3, 5, 4, 3);
  distort(m, 0.15);
  turn_elements(m);
  ct_scene *scene = new_scene();
  ct_effect *effect = make(scene, m, &STEEL, 0.3, 2.0);
  int n = 3 * m->node_count, pressed = 0, steep = 0;
  double *v = random_displacement(m, 4e4), *f = numbers(n), *g = numbers(n), c1, c2, work = 0.0,
         resultant[3] = {0};
  ct_material_speeds(&STEEL, &c1, &c2);
  forces(effect, v, f);
  for (int el = 0; el < m->element_count; el++) {
    double x[60], w[60], B[20][3], V, g2, D = 0.0;
    take_element(m, el, m->nodes, x);
    take_element(m, el, v, w);
    must(ct_element_mean_gradients, x, B, &V, &g2);
    for (int i = 0; i < 24; i++) D += B[i / 3][i % 3] * w[i];
    double rate = sqrt(1.5 / g2) * fmax(-D, 0.0), q = STEEL.density * pressure(0.3, 2.0, c1, rate);
    pressed += q > 0.0;
    steep += 8.0 * rate > 0.06 * c1;
    for (int i = 0; i < 24; i++)
      g[3 * m->elements[8 * el + i / 3] + i % 3] += q * V * B[i / 3][i % 3];
  }
  for (int i = 0; i < n; i++) {
    work += f[i] * v[i];
    resultant[i % 3] += f[i];
  }
  tap_ok(steep > 2 && pressed > steep + 2 && pressed < m->element_count &&
             largest_difference(f, g, n) < 1e-13 * largest(g, n),
         "kernel against the readable form: off by %.2g, %d of %d elements pressed, %d of them "
         "beyond the parabola",
         largest_difference(f, g, n) / largest(g, n), pressed, m->element_count, steep);
  tap_ok(work < 0.0 && largest(resultant, 3) < 1e-13 * largest(f, n),
         "it removes energy, %.3g, and no momentum, %.2g", work, largest(resultant, 3));
  ct_effect_free(effect);
  for (int axis = 0; axis < 3; axis++) {
    ct_mesh *image = mirror_mesh(m, axis);
    ct_scene *a = new_scene(), *b = new_scene();
    ct_effect *right = make(a, m, &STEEL, 0.3, 2.0), *left = make(b, image, &STEEL, 0.3, 2.0);
    double *w = numbers(n);
    for (int i = 0; i < n; i++) w[i] = i % 3 == axis ? -v[i] : v[i];
    forces(right, v, f);
    forces(left, w, g);
    int64_t faults = mirror_faults(f, g, m->node_count, axis);
    tap_ok(faults == 0 && fabs(rate_of(right, v) / rate_of(left, w) - 1.0) < 1e-14,
           "mirrored in %c: %d of %d forces are not the mirrored bits", "xyz"[axis], (int)faults,
           n);
    ct_effect_free(right);
    ct_effect_free(left);
  }
}

/* Largest eigenvalue of M⁻¹C about a strong compression, where the force is smooth, by power
 * iteration; C from differences of forces. For a cube the bound has a closed form
 * (eq:viscous-bound). */
static void bound(void)
{
  static const double Q[3][2] = {{0.5, 0.0}, {0.5, 0.7}, {0.0, 0.7}};
  for (int k = 0; k < 3; k++) {
    ct_mesh *cube = box_mesh(CT_HEX8, 0, 0, 0, 2, 2, 2, 1, 1, 1);
    ct_scene *scene = new_scene();
    ct_effect *effect = make(scene, cube, &ROD, Q[k][0], Q[k][1]);
    double closed = 12.0 * (Q[k][0] + (Q[k][1] > 0.0 ? 0.06 : 0.0)) / 2.0;
    tap_close(rate_of(effect, cube->nodes) / closed, 1.0, 1e-12, "cube: the rate is 12 Q c1 / h");
    ct_effect_free(effect);
  }
  for (int part = 0; part < 2; part++) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 3, 3, 3, 3, 3, 3);
    distort(m, 0.1);
    ct_scene *scene = new_scene();
    ct_effect *effect = make(scene, m, &ROD, part == 0 ? 0.5 : 0.0, part == 0 ? 0.0 : 0.7);
    int n = 3 * m->node_count;
    double *v0 = numbers(n), *d = random_displacement(m, 1.0), *v = numbers(n), *f0 = numbers(n),
           *f = numbers(n), *mass = numbers(m->node_count), quotient = 0.0, small = 1e-5;
    must(ct_mass_lumped, m, ROD.density, CT_LUMP_DEFAULT, mass);
    for (int i = 0; i < n; i++) v0[i] = -m->nodes[i];
    forces(effect, v0, f0);
    for (int k = 0; k < 200; k++) {
      double top = largest(d, n), up = 0.0, down = 0.0;
      for (int i = 0; i < n; i++) v[i] = v0[i] + small * (d[i] /= top);
      forces(effect, v, f);
      for (int i = 0; i < n; i++) {
        double Cd = -(f[i] - f0[i]) / small;
        up += d[i] * Cd;
        down += mass[i / 3] * d[i] * d[i];
        d[i] = Cd / mass[i / 3];
      }
      quotient = up / down;
    }
    double rate = rate_of(effect, v0);
    tap_ok(rate >= quotient && rate < 3.0 * quotient,
           "%s part: the bound of the rate is %.3f of the largest eigenvalue of M^-1 C",
           part == 0 ? "linear" : "quadratic", rate / quotient);
    ct_effect_free(effect);
  }
}

/* At the whole stable step a hard impact stays bounded: viscosity removes energy and never adds
 * any. */
static void stability(void)
{
  static const double coefficients[4][2] = {{0.06, 1.2}, {0.5, 0.0}, {2.0, 0.0}, {0.06, 4.0}};
  for (int k = 0; k < 4; k++) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 8, 3, 3, 8, 3, 3);
    distort_inside(m, 0.1);
    ct_scene *scene = new_scene_with("block", m, &STEEL, CT_KERNEL_AUTO, -1e5, 0, 0);
    add_support(scene, 0, m, 0, 0.0, "x", 0.0);
    const ct_problem *p;
    ct_viscosity_def options = {COOKIE, .linear = coefficients[k][0],
                                .quadratic = coefficients[k][1]};
    add_made(scene, ct_viscosity_create_effect, &options);
    int64_t steps;
    ct_stable_step stable;
    p = build(scene, (ct_scene_time){.end = 3e-5, .fraction = 1.0}, &steps, &stable);
    ct_state *state = new_state(p);
    double first = energy_of(p, state).kinetic, most = 0.0, work = 0.0, balance = 0.0;
    for (int i = 0; i < 60; i++) {
      advance(p, state, steps / 60);
      ct_energy energy = energy_of(p, state);
      most = fmax(most, energy.kinetic + energy.strain);
      balance = worst(balance, energy.balance / first);
    }
    must(ct_energy_work, p, state, 1, &work);
    tap_ok(most < 1.001 * first && work < 0.0 && balance < 1e-12,
           "Q1 = %g, Q2 = %g at the whole stable step (Courant number %.3f): energy at most %.6f "
           "of the first, %.3f removed, balance %.1g",
           options.linear, options.quadratic, stable.dt / stable.dt_courant, most / first,
           -work / first, balance);
  }
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1),
          *q = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene_with("brick", m, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "curved", q, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  ct_effect *effect = NULL;
  ct_error e;
  const ct_problem *joined = join_scene(scene);
  static const int32_t first[1] = {0}, twice[2] = {0, 0}, none[1] = {2};
  ct_viscosity_def options = {COOKIE, .linear = 0.06, .quadratic = 1.2};
  tap_ok(ct_viscosity_create_effect(&options, joined, &effect, &e) == CT_ERROR_UNSUPPORTED &&
             e.body == 1,
         "hex20 is refused: %s", e.text);
  ct_material large = STEEL;
  large.law = CT_NEO_HOOKEAN;
  ct_scene *turning = new_scene_with("brick", m, &large, CT_KERNEL_AUTO, 0, 0, 0);
  tap_ok(ct_viscosity_create_effect(&options, join_scene(turning), &effect, &e) ==
             CT_ERROR_UNSUPPORTED,
         "large strain is refused: %s", e.text);
  options.bodies = none, options.body_count = 1;
  tap_ok(ct_viscosity_create_effect(&options, joined, &effect, &e) == CT_ERROR_ARGUMENT,
         "an unknown body: %s", e.text);
  options.bodies = twice, options.body_count = 2;
  tap_ok(ct_viscosity_create_effect(&options, joined, &effect, &e) == CT_ERROR_ARGUMENT,
         "a body twice: %s", e.text);
  options.bodies = first, options.body_count = 1;
  options.linear = -1.0;
  tap_ok(ct_viscosity_create_effect(&options, joined, &effect, &e) == CT_ERROR_ARGUMENT,
         "a negative coefficient: %s", e.text);
  options.linear = options.quadratic = 0.0;
  tap_ok(ct_viscosity_create_effect(&options, joined, &effect, &e) == CT_ERROR_ARGUMENT &&
             effect == NULL,
         "no coefficient: %s", e.text);
  tap_ok(ct_viscosity_create_effect(NULL, joined, &effect, NULL) == CT_ERROR_ARGUMENT, "null");
  options.linear = 0.06;
  must(ct_viscosity_create_effect, &options, joined, &effect);
  tap_ok(effect->node_count == 8 && effect->nodes[7] == 7 && effect->calls->energy == NULL,
         "of one body only: its nodes, and no stored energy");
  ct_effect_free(effect);
}

int main(void)
{
  free_at_end();
  uniform_compression();
  kernel();
  bound();
  stability();
  refusals();
  return tap_done();
}
