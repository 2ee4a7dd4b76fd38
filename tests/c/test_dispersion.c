/* Waves of a mesh against the equations of motion written by hand and against finite differences,
 * and the front of a step against runs. */
#include "bodies.h"

static const double PI = 3.14159265358979323846;
static const ct_material STEEL = {3.0, 0.3, 1.7, CT_LINEAR};
enum { SCHEMES = CT_SCHEME_COUNT, BRANCHES = 12 };

static ct_dispersion_def waves_of(ct_brick_kind kind, ct_mass_form mass)
{
  ct_dispersion_def def = ct_dispersion_def_default();
  def.kind = kind, def.mass = mass, def.material = STEEL;
  return def;
}

static int branches_of(ct_brick_kind kind) { return kind == CT_HEX20 ? 12 : 3; }

static void branches_at(const ct_dispersion_def *def, const double k[3], ct_branch out[BRANCHES])
{
  must(ct_dispersion, def, 1, k, out);
}

static double c_of(const ct_material *material, int wave)
{
  double c[2];
  ct_material_speeds(material, &c[0], &c[1]);
  return c[wave];
}

/* Forces on the nodes in the middle of a patch of 2 x 2 x 2 bricks that moves as a wave, by the
 * element force of the readable form. */
static void wave_residual(const ct_dispersion_def *def, const double k[3], const ct_branch *b,
                          double *off)
{
  const double *h = def->size;
  ct_mesh *mesh = box_mesh(def->kind, -h[0], -h[1], -h[2], 2 * h[0], 2 * h[1], 2 * h[2], 2, 2, 2);
  const int per = ct_brick_node_count(def->kind), n = 3 * mesh->node_count;
  double *u = numbers(n), *force = numbers(n), *mass = numbers(mesh->node_count);
  for (int a = 0; a < mesh->node_count; a++) {
    double *x = &mesh->nodes[3 * a], angle = k[0] * x[0] + k[1] * x[1] + k[2] * x[2] + 0.3;
    int family = 0;
    for (int d = 0; d < 3; d++)
      if (fabs(fabs(x[d]) - 0.5 * h[d]) < 0.1 * h[d]) family = 1 + d;
    for (int c = 0; c < 3; c++) u[3 * a + c] = b->shape[3 * family + c] * cos(angle);
  }
  must(ct_mass_lumped, mesh, def->material.density, CT_LUMP_DEFAULT, mass);
  for (int e = 0; e < mesh->element_count; e++) {
    double x[60], v[60], f[60];
    take_element(mesh, e, mesh->nodes, x), take_element(mesh, e, u, v);
    must(ct_solid_element_force, def->kind, x, v, &def->material, f, NULL);
    for (int i = 0; i < 3 * per; i++) force[3 * mesh->elements[e * per + i / 3] + i % 3] += f[i];
  }
  // Nodes in the middle have all their bricks: the one at 0 and the middles of the edges at it.
  for (int a = 0; a < mesh->node_count; a++) {
    int inside = 1;
    for (int d = 0; d < 3; d++) inside &= fabs(mesh->nodes[3 * a + d]) < 0.75 * h[d];
    for (int c = 0; inside && c < 3; c++)
      *off =
          worst(*off, (force[3 * a + c] + mass[a] * b->omega_mesh * b->omega_mesh * u[3 * a + c]) /
                          (def->material.young * (h[0] + h[1] + h[2])));
  }
}

/* eq:bloch-matrices, eq:bloch-cholesky, eq:jacobi-rotation: on the nodes of a real mesh. */
static void waves_solve_the_mesh(void)
{
  for (int kind = 0; kind < 2; kind++) {
    double off = 0.0;
    for (int i = 0; i < 20; i++) {
      ct_dispersion_def def = waves_of((ct_brick_kind)kind, CT_MASS_LUMPED);
      ct_branch b[BRANCHES];
      double k[3];
      for (int d = 0; d < 3; d++)
        def.size[d] = 1.5 + uniform(1.0), k[d] = uniform(PI) / def.size[d];
      branches_at(&def, k, b);
      for (int w = 0; w < branches_of(def.kind); w++) wave_residual(&def, k, &b[w], &off);
    }
    tap_close(off, 0.0, 1e-12,
              "hex%d: each wave satisfies the equations of motion at the nodes of a patch",
              kind ? 20 : 8);
  }
}

/* eq:group-velocity, eq:dispersion-slope, eq:dispersion-memory, eq:dispersion-quadratic: by
 * differences. */
static void group_is_the_derivative(void)
{
  for (int scheme = 0; scheme < SCHEMES; scheme++) {
    double off = 0.0;
    for (int i = 0; i < 40; i++) {
      ct_dispersion_def def = waves_of((ct_brick_kind)(i / 2 % 2), (ct_mass_form)(i % 2));
      ct_branch b[BRANCHES], low[BRANCHES], high[BRANCHES];
      double k[3], small = 1e-5;
      def.integrator = ct_integrator_default((ct_scheme)scheme);
      def.step = 0.15 / c_of(&STEEL, 0);
      for (int d = 0; d < 3; d++) k[d] = 0.3 + d + uniform(0.3);
      branches_at(&def, k, b);
      for (int d = 0; d < 3; d++) {
        double l[3] = {k[0], k[1], k[2]}, h[3] = {k[0], k[1], k[2]};
        l[d] -= small, h[d] += small;
        branches_at(&def, l, low), branches_at(&def, h, high);
        for (int w = 0; w < branches_of(def.kind); w++) {
          double slope = (high[w].omega - low[w].omega) / (2.0 * small);
          // Near a crossing of branches the slope changes within the step.
          double apart = fmin(w > 0 ? b[w].omega - b[w - 1].omega : 1.0,
                              w + 1 < branches_of(def.kind) ? b[w + 1].omega - b[w].omega : 1.0);
          if (apart > 0.01) off = worst(off, b[w].group[d] - slope);
        }
      }
    }
    // The difference quotient: 1e-11 ω''', which is large where two branches or roots meet.
    tap_close(off, 0.0, 1e-6, "group velocity is the slope of ω: %s", SCHEME(scheme));
  }
}

static void symmetric(void)
{
  double off = 0.0;
  for (int i = 0; i < 40; i++) {
    ct_dispersion_def def = waves_of((ct_brick_kind)(i % 2), CT_MASS_LUMPED);
    ct_branch a[BRANCHES], b[BRANCHES];
    double k[3] = {uniform(PI), uniform(PI), uniform(PI)};
    double image[3] = {-k[1], k[2] + 2.0 * PI * (pick(3) - 1), k[0]};
    branches_at(&def, k, a), branches_at(&def, image, b);
    for (int w = 0; w < branches_of(def.kind); w++) off = worst(off, b[w].omega / a[w].omega - 1.0);
  }
  tap_close(off, 0.0, 1e-12, "cubes: mirrored, permuted, a period further, the same frequencies");
}

/* -- The front ------------------------------------------------------------------------------- */

/* A row of cubes that flies against a wall, or a wide layer in which two half-planes fly against
 * each other along its diagonal. */
typedef struct run {
  ct_brick_kind kind;
  int diagonal;
  ct_scheme scheme;
  double courant;
  int steps;
} run;

enum { WIDE = 56, LONG = 64, MOST_POINTS = 2 * LONG };

/* Stress along n of the elements on the line, over -ρ c1 v0, and their places; returns their
 * number. */
static int run_front(const run *r, double dt, double *distance, double *stress)
{
  const int wide = r->diagonal ? WIDE : 1, cells = r->diagonal ? WIDE : LONG,
            half = r->diagonal ? WIDE / 2 : 0;
  ct_mesh *mesh = box_mesh(r->kind, -half, -half, 0, cells, wide, 1, cells, wide, 1);
  const double n[3] = {r->diagonal ? sqrt(0.5) : 1.0, r->diagonal ? sqrt(0.5) : 0.0, 0.0};
  double *v = numbers(3 * (int64_t)mesh->node_count);
  for (int a = 0; a < mesh->node_count; a++) {
    double *x = &mesh->nodes[3 * a], s = r->diagonal ? x[0] + x[1] : x[0];
    for (int c = 0; c < 3; c++) v[3 * a + c] = s == 0.0 ? 0.0 : s > 0.0 ? -n[c] : n[c];
  }
  ct_scene *scene = new_scene();
  add_moving_body(scene, "body", mesh, &STEEL, CT_KERNEL_AUTO, v);
  if (!r->diagonal) {
    add_support(scene, 0, mesh, 0, 0.0, "x", 0.0);
    add_support(scene, 0, mesh, 1, 0.0, "y", 0.0), add_support(scene, 0, mesh, 1, 1.0, "y", 0.0);
  }
  add_support(scene, 0, mesh, 2, 0.0, "z", 0.0), add_support(scene, 0, mesh, 2, 1.0, "z", 0.0);
  int64_t steps;
  const ct_problem *problem = build(scene,
                                    (ct_scene_time){.end = r->steps * dt,
                                                    .dt = dt,
                                                    .keep_dt = 1,
                                                    .integrator = ct_integrator_default(r->scheme)},
                                    &steps, NULL);
  ct_state *state = new_state(problem);
  advance(problem, state, r->steps);
  double *all = numbers(6 * (int64_t)mesh->element_count);
  must(ct_solid_stress, mesh, &STEEL, state->displacement, all);
  int count = 0;
  for (int i = half; i < cells; i++)
    for (int next = 0; next < (r->diagonal && i + 1 < cells ? 2 : 1); next++) {
      const double *s = &all[6 * (r->diagonal ? i + cells * (i + next) : i)];
      double across = r->diagonal ? 0.5 * (s[0] + s[1]) + s[3] : s[0];
      distance[count] = r->diagonal ? (2 * (i - half) + 1 + next) * sqrt(0.5) : i + 0.5;
      stress[count++] = -across / (STEEL.density * c_of(&STEEL, 0));
    }
  return count;
}

/* Where the outermost passage through ½ is, and the largest value. */
static double half_height(int count, const double *distance, const double *stress, double *top)
{
  int i = count - 2;
  while (i > 0 && !(stress[i] >= 0.5)) i--;
  *top = largest(stress, count);
  return distance[i] +
         (stress[i] - 0.5) / (stress[i] - stress[i + 1]) * (distance[i + 1] - distance[i]);
}

static void front_of_a_run(const run *r)
{
  ct_dispersion_def def = waves_of(r->kind, CT_MASS_LUMPED);
  const int32_t normal[3] = {1, r->diagonal, 0};
  double s[MOST_POINTS], computed[MOST_POINTS], predicted[MOST_POINTS], c1 = c_of(&STEEL, 0),
                                                                        top[2];
  def.integrator = ct_integrator_default(r->scheme);
  def.step = r->courant / c1;
  int count = run_front(r, def.step, s, computed), near = 0;
  // The free sides of the layer disturb its diagonal later and farther out than this.
  const double reach = r->steps * r->courant + 6.0;
  while (near < count && s[near] < reach) near++;
  must(ct_dispersion_front, &def, normal, r->steps * def.step, (size_t)near, s, predicted);
  double at[2] = {half_height(near, s, computed, &top[0]),
                  half_height(near, s, predicted, &top[1])};
  tap_close(at[1], at[0], 1e-6,
            "hex%d, %s, %s, Courant %.2f: half height at %.3f elements, c1 t = %.2f",
            r->kind ? 20 : 8, r->diagonal ? "45°" : "axis", SCHEME(r->scheme), r->courant, at[0],
            r->steps * r->courant);
  tap_close(top[1], top[0], 1e-6, "... overshoot %.1f %%", 100.0 * (top[0] - 1.0));
  tap_close(largest_difference(computed, predicted, near), 0.0, 1e-6, "... and all stresses");
}

/* eq:front-planes, eq:front-start, eq:front-time, eq:front-stress, eq:front-sum: against runs. */
static void fronts(void)
{
  static const run RUNS[] = {{CT_HEX8, 0, CT_CENTRAL_DIFFERENCE, 0.125, 320},
                             {CT_HEX8, 0, CT_CENTRAL_DIFFERENCE, 0.7, 57},
                             {CT_HEX8, 0, CT_CHUNG_LEE, 0.6, 66},
                             {CT_HEX8, 0, CT_NOH_BATHE, 1.2, 33},
                             {CT_HEX8, 0, CT_TCHAMWA_WIELGOSZ, 0.6, 66},
                             {CT_HEX20, 0, CT_CENTRAL_DIFFERENCE, 0.2, 200},
                             {CT_HEX20, 0, CT_NOH_BATHE, 0.4, 100},
                             {CT_HEX20, 0, CT_CENTRAL_DIFFERENCE, 0.1, 400},
                             {CT_HEX8, 1, CT_CENTRAL_DIFFERENCE, 0.125, 128},
                             {CT_HEX8, 1, CT_CENTRAL_DIFFERENCE, 0.7, 23},
                             {CT_HEX8, 1, CT_CHUNG_LEE, 0.6, 27},
                             {CT_HEX8, 1, CT_TCHAMWA_WIELGOSZ, 0.6, 27},
                             {CT_HEX20, 1, CT_CENTRAL_DIFFERENCE, 0.2, 60},
                             {CT_HEX20, 1, CT_NOH_BATHE, 0.4, 30}};
  for (size_t i = 0; i < sizeof RUNS / sizeof RUNS[0]; i++) front_of_a_run(&RUNS[i]);
}

/* A front of long waves is an integral of Airy's function (eq:front-airy): no sum of modes. */
static void front_by_airy(void)
{
  static const double HALF = -0.409602956933; // ∫ Ai from here to infinity is ½
  for (int i = 0; i < 2; i++) {
    ct_dispersion_def def = waves_of(CT_HEX8, CT_MASS_LUMPED);
    const double c1 = c_of(&STEEL, 0), ratio = c_of(&STEEL, 1) / c1, courant = 0.5;
    const double L = i ? sqrt(0.5) : 1.0, travel = 1000.0;
    enum { POINTS = 80 };
    double s[POINTS], stress[POINTS], top;
    double C = i ? (7.0 - ratio * ratio - 4.0 * courant * courant) / 96.0
                 : (1.0 - courant * courant) / 24.0;
    double width = cbrt(3.0 * C * travel);
    def.step = courant / c1;
    for (int k = 0; k < POINTS; k++)
      s[k] = (i ? 0.0 : 0.5) + L * (floor((travel - 40.0 * L) / L) + k);
    must(ct_dispersion_front, &def, (int32_t[3]){1, i, 0}, travel / c1, POINTS, s, stress);
    tap_close(half_height(POINTS, s, stress, &top), travel + HALF * width, 0.1,
              "after 1000 elements %s the half height is %.2f elements behind",
              i ? "at 45°" : "along the axis", -HALF * width);
    tap_close(top, 1.2743, 0.02, "and the overshoot 27.4 %%");
  }
}

static void refusals(void)
{
  ct_branch b[BRANCHES] = {{.omega = -7.0}};
  ct_error error;
  double k[6] = {0.1, 0.0, 0.0, 0.0, NAN, 0.0}, s = 0.5, out = -7.0;
  const ct_dispersion_def good = waves_of(CT_HEX8, CT_MASS_LUMPED);
  ct_dispersion_def wrong[8] = {good, good, good, good, good, good, good, {0}};
  wrong[0].kind = (ct_brick_kind)7, wrong[1].size[1] = 0.0, wrong[2].material.poisson = 0.5;
  wrong[3].mass = (ct_mass_form)3, wrong[4].integrator.scheme = (ct_scheme)9, wrong[5].step = -1.0;
  wrong[6].size[2] = INFINITY;
  for (int i = 0; i < 8; i++)
    tap_ok(ct_dispersion(&wrong[i], 1, k, b, &error) == CT_ERROR_ARGUMENT && b[0].omega == -7.0,
           "refused: %s", error.text);
  tap_ok(ct_dispersion(&good, 2, k, b, &error) == CT_ERROR_ARGUMENT && error.point == 1 &&
             b[0].omega == -7.0,
         "refused at 1: %s", error.text);
  tap_ok(ct_dispersion(NULL, 1, k, b, &error) == CT_ERROR_ARGUMENT, "refused: %s", error.text);
  tap_ok(ct_dispersion(&good, 1, NULL, b, NULL) == CT_ERROR_ARGUMENT, "refused: no wave vectors");
  tap_ok(ct_dispersion(&good, 0, NULL, NULL, NULL) == CT_OK, "no wave vectors, no result");
  static const int32_t X[3] = {1, 0, 0}, ZERO[3] = {0, 0, 0}, FAR[3] = {1, 17, 0};
  ct_dispersion_def stepped = good;
  stepped.step = 0.1;
  double no = NAN, away = 1e6;
  struct {
    const ct_dispersion_def *def;
    const int32_t *normal;
    double time;
    const double *s;
  } bad[] = {{&good, ZERO, 1.0, &s}, {&good, FAR, 1.0, &s},   {&good, X, -1.0, &s},
             {&good, X, NAN, &s},    {&stepped, X, 0.25, &s}, {&good, X, 1.0, &no},
             {&good, X, 1.0, &away}, {&wrong[1], X, 1.0, &s}};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    tap_ok(ct_dispersion_front(bad[i].def, bad[i].normal, bad[i].time, 1, bad[i].s, &out, &error) ==
                   CT_ERROR_ARGUMENT &&
               out == -7.0,
           "refused: %s", error.text);
  tap_ok(ct_dispersion_front(&good, NULL, 1.0, 1, &s, &out, NULL) == CT_ERROR_ARGUMENT,
         "refused: no normal");
}

int main(void)
{
  free_at_end();
  waves_solve_the_mesh();
  group_is_the_derivative();
  symmetric();
  fronts();
  front_by_airy();
  refusals();
  return tap_done();
}
