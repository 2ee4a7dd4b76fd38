/* Large displacement and rotation: closed forms in wide arithmetic, finite differences, rotations,
 * conservation, mirror images, the tangent's bound. */
#include "blocks.h"

static const char *KIND[2] = {"hex8", "hex20"};
static const char *const LAW[] = {"linear", "St. Venant-Kirchhoff", "neo-Hookean"};
typedef char every_law_has_its_name[sizeof LAW / sizeof LAW[0] == CT_LAW_COUNT ? 1 : -1];

static ct_material soft(ct_law law)
{
  ct_material m = {3.0, 0.3, 2.0, law};
  return m;
}

static long double determinant(long double A[3][3])
{
  return A[0][0] * (A[1][1] * A[2][2] - A[1][2] * A[2][1]) -
         A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
         A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]);
}

/* Energy density and Cauchy's stress xx yy zz xy yz zx from F as textbooks have them, with the left
 * tensor b = F Fᵀ, in wide arithmetic. A new law gets its cases here and in `stretched`. */
static long double textbook(const ct_material *m, double G[3][3], double stress[6])
{
  double la, mm;
  ct_material_lame(m, &la, &mm);
  long double lambda = la, mu = mm, F[3][3], b[3][3], sigma[3][3], trace = 0.0L, square = 0.0L;
  for (int i = 0; i < 9; i++)
    F[i / 3][i % 3] = (long double)G[i / 3][i % 3] + (i % 4 == 0 ? 1.0L : 0.0L);
  for (int i = 0; i < 9; i++)
    b[i / 3][i % 3] =
        F[i / 3][0] * F[i % 3][0] + F[i / 3][1] * F[i % 3][1] + F[i / 3][2] * F[i % 3][2];
  long double J = determinant(F), W = NAN;
  for (int i = 0; i < 3; i++) trace += b[i][i];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      long double one = i == j, bb = 0.0L;
      for (int k = 0; k < 3; k++) bb += b[i][k] * b[k][j];
      square += b[i][j] * b[i][j];
      switch (m->law) {
      case CT_ST_VENANT_KIRCHHOFF:
        sigma[i][j] = (0.5L * lambda * (trace - 3.0L) * b[i][j] + mu * (bb - b[i][j])) / J;
        break;
      case CT_NEO_HOOKEAN:
        sigma[i][j] = mu / J * (b[i][j] - one) + lambda * (J - 1.0L) * one;
        break;
      case CT_LINEAR:
      case CT_LAW_COUNT:
        sigma[i][j] = NAN;
      }
    }
  if (m->law == CT_NEO_HOOKEAN)
    W = 0.5L * mu * (trace - 3.0L) - mu * logl(J) + 0.5L * lambda * (J - 1.0L) * (J - 1.0L);
  else if (m->law == CT_ST_VENANT_KIRCHHOFF)
    W = 0.125L * lambda * (trace - 3.0L) * (trace - 3.0L) +
        0.25L * mu * (square - 2.0L * trace + 3.0L);
  for (int k = 0; k < 6; k++) stress[k] = (double)sigma[k % 3][k < 3 ? k : (k + 1) % 3];
  return W;
}

static ct_mesh *distorted(ct_brick_kind kind, int n)
{
  ct_mesh *m = box_mesh(kind, -0.3, 0.2, 1.0, 1, 1, 1, n, n, n);
  distort(m, (kind == CT_HEX8 ? 0.24 : 0.09) / n);
  return m;
}

static double volume_of(const ct_mesh *m)
{
  double *mass = numbers(m->node_count), volume = 0.0;
  must(ct_mass_lumped, m, 1.0, CT_LUMP_DEFAULT, mass);
  for (int n = 0; n < m->node_count; n++) volume += mass[n];
  return volume;
}

/* A homogeneous deformation, large, of a distorted mesh: one stress everywhere, no force inside
 * (eq:green-lagrange, eq:st-venant-kirchhoff, eq:neo-hookean-stress, eq:piola, eq:cauchy,
 * eq:large-energy). */
static void patch_test(ct_brick_kind kind, ct_law law)
{
  ct_mesh *m = distorted(kind, 3);
  turn_elements(m);
  ct_material material = soft(law);
  double G[3][3], want[6], off = 0.0, inner = 0.0, top;
  for (int i = 0; i < 9; i++) G[i / 3][i % 3] = uniform(0.35);
  double density = (double)textbook(&material, G, want);
  double *u = numbers(3 * m->node_count), *f = numbers(3 * m->node_count),
         *stress = numbers(6 * m->element_count);
  for (int n = 0; n < m->node_count; n++)
    for (int i = 0; i < 3; i++) {
      const double *X = &m->nodes[3 * n];
      u[3 * n + i] = 7.0 + (G[i][0] * X[0] + G[i][1] * X[1]) + G[i][2] * X[2];
    }
  must(ct_solid_stress, m, &material, u, stress);
  for (int el = 0; el < m->element_count; el++)
    off = worst(off, largest_difference(&stress[6 * el], want, 6));
  tap_ok(off < 1e-12 * largest(want, 6), "%s, %s patch: Cauchy's stress off by %.2g", KIND[kind],
         LAW[law], off / largest(want, 6));

  block solid = open_block(m, &material, CT_KERNEL_AUTO);
  double energy = block_force(&solid, u, f);
  int per_face = kind == CT_HEX8 ? 4 : 8, *is_outer = integers(m->node_count),
      *outer = integers(8 * 6 * m->element_count);
  int faces = ct_mesh_outer_faces(m, outer, NULL);
  for (int i = 0; i < faces * per_face; i++) is_outer[outer[i]] = 1;
  top = largest(f, 3 * m->node_count);
  for (int i = 0; i < 3 * m->node_count; i++)
    if (!is_outer[i / 3]) inner = worst(inner, f[i]);
  tap_ok(inner < 1e-12 * top, "%s, %s patch: no force at inner nodes, %.2g of the largest",
         KIND[kind], LAW[law], inner / top);
  tap_close(energy / (density * volume_of(m)), 1.0, 1e-12, "%s, %s patch: energy", KIND[kind],
            LAW[law]);
}

/* A rotation about a general axis. */
static void rotation(double angle, double Q[3][3])
{
  double n[3] = {2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0}, c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) Q[i][j] = (i == j ? c : 0.0) + (1.0 - c) * n[i] * n[j];
  for (int i = 0; i < 3; i++) {
    Q[i][(i + 1) % 3] -= s * n[(i + 2) % 3];
    Q[(i + 1) % 3][i] += s * n[(i + 2) % 3];
  }
}

/* A rotated stressed body keeps its energy, and its forces rotate with it (eq:green-lagrange,
 * eq:large-reference-stress). */
static void turned(ct_brick_kind kind, ct_law law)
{
  ct_mesh *m = distorted(kind, 2);
  ct_material material = soft(law);
  int n = 3 * m->node_count;
  double *u = random_displacement(m, 0.05), *v = numbers(n), *f = numbers(n), *g = numbers(n),
         off[2] = {0, 0};
  block solid = open_block(m, &material, CT_KERNEL_AUTO);
  double energy = block_force(&solid, u, f), top = largest(f, n);
  for (int k = 1; k <= 12; k++) {
    double Q[3][3];
    rotation(0.55 * k, Q);
    for (int a = 0; a < m->node_count; a++)
      for (int i = 0; i < 3; i++) {
        double x = 0.0;
        for (int j = 0; j < 3; j++) x += Q[i][j] * (m->nodes[3 * a + j] + u[3 * a + j]);
        v[3 * a + i] = x - m->nodes[3 * a + i];
      }
    off[0] = worst(off[0], block_force(&solid, v, g) / energy - 1.0);
    for (int a = 0; a < m->node_count; a++)
      for (int i = 0; i < 3; i++) {
        double want = Q[i][0] * f[3 * a] + Q[i][1] * f[3 * a + 1] + Q[i][2] * f[3 * a + 2];
        off[1] = worst(off[1], (want - g[3 * a + i]) / top);
      }
  }
  tap_ok(off[0] < 1e-12 && off[1] < 1e-12,
         "%s, %s: rotated twelve times, energy changes by %.2g, force by %.2g", KIND[kind],
         LAW[law], off[0], off[1]);
}

/* Force = - gradient of the energy, by central differences of fourth order; tangent = - gradient of
 * the force, by its largest eigenvalue (eq:large-force, eq:large-energy, eq:large-tangent,
 * eq:neo-hookean-exact). */
static void gradients(ct_brick_kind kind, ct_law law)
{
  int n = 3 * ct_brick_node_count(kind);
  ct_mesh *m = distorted(kind, 1);
  ct_material material = soft(law);
  double x[60], u[60], f[60], g[4][60], energy[4], *A = numbers(n * n), mass[20], off = 0.0,
                                                   top = 0.0, w, h = 2e-3;
  take_element(m, 0, m->nodes, x);
  for (int i = 0; i < n; i++) u[i] = uniform(kind == CT_HEX8 ? 0.1 : 0.04);
  must(ct_mass_element, kind, x, material.density, CT_LUMP_DEFAULT, mass);
  must(ct_solid_element_force, kind, x, u, &material, f, NULL);
  for (int i = 0; i < n; i++) {
    double keep = u[i];
    for (int k = 0; k < 4; k++) {
      u[i] = keep + h * (k < 2 ? k - 2 : k - 1);
      must(ct_solid_element_force, kind, x, u, &material, g[k], &energy[k]);
    }
    u[i] = keep;
    off = worst(off, f[i] + (energy[0] - energy[3] + 8.0 * (energy[2] - energy[1])) / (12.0 * h));
    top = worst(top, f[i]);
    for (int j = 0; j < n; j++)
      A[j * n + i] = -(g[0][j] - g[3][j] + 8.0 * (g[2][j] - g[1][j])) / (12.0 * h) /
                     sqrt(mass[i / 3] * mass[j / 3]);
  }
  tap_ok(off < 1e-8 * top, "%s, %s: force is minus the gradient of the energy, off by %.2g",
         KIND[kind], LAW[law], off / top);
  double skew = 0.0, size = largest(A, n * n);
  for (int i = 0; i < n * n; i++) skew = worst(skew, A[i] - A[i % n * n + i / n]);
  tap_ok(skew < 1e-7 * size, "%s, %s: the force has a potential, the tangent is symmetric to %.2g",
         KIND[kind], LAW[law], skew / size);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) A[j * n + i] = A[i * n + j];
  must(ct_solid_element_omega2_bound, kind, x, u, &material, mass, &w);
  tap_close(w / jacobi_largest(n, A), 1.0, 1e-7, "%s, %s: largest eigenvalue of the tangent",
            KIND[kind], LAW[law]);
}

/* For small displacements force and energy become the linear ones: the difference falls as the
 * displacement, and no digits are lost on the way (eq:volume-change, eq:neo-hookean-exact,
 * eq:log-excess). */
static void small_strain(ct_brick_kind kind, ct_law law)
{
  ct_mesh *m = distorted(kind, 2);
  ct_material material = soft(law), linear = soft(CT_LINEAR);
  int n = 3 * m->node_count;
  double *u = random_displacement(m, 0.1), *v = numbers(n), *f = numbers(n), *g = numbers(n);
  double off[4], energy_off[4], scale[4] = {1e-3, 1e-4, 1e-9, 1e-13};
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < n; k++) v[k] = scale[i] * u[k];
    block large = open_block(m, &material, CT_KERNEL_AUTO),
          small = open_block(m, &linear, CT_KERNEL_GENERAL);
    double W = block_force(&large, v, f), want = block_force(&small, v, g);
    off[i] = largest_difference(f, g, n) / largest(g, n);
    energy_off[i] = fabs(W / want - 1.0);
  }
  tap_ok(off[0] / off[1] > 8.0 && off[0] / off[1] < 12.0 && off[1] > 1e-7,
         "%s, %s: ten times smaller, ten times closer to the linear force (%.3g)", KIND[kind],
         LAW[law], off[0] / off[1]);
  tap_ok(off[2] < 1e-7 && energy_off[2] < 1e-7 && off[3] < 5e-11 && energy_off[3] < 5e-11,
         "%s, %s: tiny displacements, force off by %.2g, energy by %.2g", KIND[kind], LAW[law],
         off[3], energy_off[3]);
}

/* A batch of any size against the readable form (eq:large-reference-stress); the order of elements
 * in the mesh, and threads. */
static void kernels(ct_brick_kind kind, ct_law law)
{
  static const int count[6] = {1, 7, 8, 9, 17, 600};
  double off = 0.0, energy_off = 0.0;
  int same = 1;
  for (int i = 0; i < 6; i++) {
    ct_mesh *m = count[i] < 20 ? box_mesh(kind, 0, 0, 0, count[i], 1, 1, count[i], 1, 1)
                               : box_mesh(kind, 0, 0, 0, 10, 10, 6, 10, 10, 6);
    distort(m, kind == CT_HEX8 ? 0.12 : 0.05);
    ct_material material = soft(law);
    int n = 3 * m->node_count;
    double *u = random_displacement(m, kind == CT_HEX8 ? 0.1 : 0.03), *f = numbers(n),
           *g = numbers(n);
    block solid = open_block(m, &material, CT_KERNEL_AUTO);
    double energy = block_force(&solid, u, f), want = reference_force(m, &material, u, g);
    off = worst(off, largest_difference(f, g, n) / largest(g, n));
    energy_off = worst(energy_off, energy / want - 1.0);
    ct_view view = {.settings = &TWO, .displacement = u, .scratch = solid.scratch};
    must(solid.effect->calls->force, solid.effect, &view, g);
    same &= memcmp(f, g, (size_t)n * sizeof *f) == 0;
  }
  tap_ok(off < 1e-13 && energy_off < 1e-13,
         "%s, %s: kernels against the readable form, force off by %.2g, energy by %.2g", KIND[kind],
         LAW[law], off, energy_off);
  tap_ok(same, "%s, %s: two threads, the same bits", KIND[kind], LAW[law]);
}

static int64_t mirror_faults_of(ct_mesh *m, ct_law law)
{
  int64_t faults = 0;
  ct_material material = soft(law);
  int n = 3 * m->node_count;
  double *u = random_displacement(m, 0.03), *v = numbers(n), *f = numbers(n), *g = numbers(n);
  for (int axis = 0; axis < 3; axis++) {
    ct_mesh *image = mirror_mesh(m, axis);
    for (int i = 0; i < n; i++) v[i] = i % 3 == axis ? -u[i] : u[i];
    block here = open_block(m, &material, CT_KERNEL_AUTO),
          there = open_block(image, &material, CT_KERNEL_AUTO);
    double energy = block_force(&here, u, f);
    faults += energy != block_force(&there, v, g);
    faults += mirror_faults(f, g, m->node_count, axis);
  }
  return faults;
}

/* One body of many elements, and many of one: a sum over all would hide the last bits of an
 * element's energy. */
static void mirrored(ct_brick_kind kind, ct_law law)
{
  int64_t faults = mirror_faults_of(distorted(kind, 3), law);
  for (int k = 0; k < 20; k++) faults += mirror_faults_of(distorted(kind, 1), law);
  tap_ok(faults == 0, "%s, %s: mirror images have mirrored bits, %d faults", KIND[kind], LAW[law],
         (int)faults);
}

/* A ring is its own mirror image: mirrored displacements give mirrored forces, to the last bit,
 * also where it closes. */
static void mirrored_ring(ct_brick_kind kind, ct_law law)
{
  ct_ring ring = {{0, 0, 0}, {1.0, 1.5}, 0.5, {2, 10, 2}};
  ct_mesh *m = NULL;
  must(ct_mesh_create_ring, kind, &ring, &m);
  ct_material material = soft(law);
  int n = 3 * m->node_count, faults = 0;
  double *u = random_displacement(m, 0.02), *v = numbers(n), *f = numbers(n), *g = numbers(n);
  block solid = open_block(m, &material, CT_KERNEL_AUTO);
  block_force(&solid, u, f);
  for (int axis = 0; axis < 3; axis++) {
    int *image = integers(m->node_count);
    for (int a = 0; a < m->node_count; a++) {
      image[a] = -1;
      for (int b = 0; b < m->node_count; b++) {
        int same = 1;
        for (int c = 0; c < 3; c++)
          same &= m->nodes[3 * b + c] == (c == axis ? -m->nodes[3 * a + c] : m->nodes[3 * a + c]);
        if (same) image[a] = b;
      }
      faults += image[a] < 0;
      for (int c = 0; image[a] >= 0 && c < 3; c++)
        v[3 * image[a] + c] = c == axis ? -u[3 * a + c] : u[3 * a + c];
    }
    block_force(&solid, v, g);
    for (int i = 0; faults == 0 && i < n; i++)
      faults += !(g[3 * image[i / 3] + i % 3] == (i % 3 == axis ? -f[i] : f[i]));
  }
  tap_ok(faults == 0, "%s, %s: a ring mirrors its forces to the last bit, %d faults", KIND[kind],
         LAW[law], faults);
  free_mesh(m);
}

/* The bound on ω² at a deformed state against the largest eigenvalue of the assembled tangent by
 * power iteration (eq:tangent-bound). */
static void tangent_bound(ct_brick_kind kind, ct_law law)
{
  double least = INFINITY, most = 0.0, stiffer = 0.0;
  ct_mesh *m = distorted(kind, 2);
  ct_material material = soft(law);
  ct_scene *scene = new_scene_with("block", m, &material, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *problem = build_until(scene, 1.0, 0.5);
  ct_state *state = new_state(problem);
  double omega_squared[2], rate;
  must(ct_stable_contribution, problem, state, 0, &omega_squared[0], &rate);
  block solid = open_block(m, &material, CT_KERNEL_AUTO);
  for (int k = 0; k < 6; k++) {
    double Q[3][3], *u = random_displacement(m, 0.03), stretch = 0.7 + 0.16 * k;
    rotation(0.9 * k, Q);
    for (int a = 0; a < m->node_count; a++) {
      double y[3];
      for (int i = 0; i < 3; i++)
        y[i] = (i == 0 ? stretch : 1.0) * m->nodes[3 * a + i] + u[3 * a + i];
      for (int i = 0; i < 3; i++)
        u[3 * a + i] = Q[i][0] * y[0] + Q[i][1] * y[1] + Q[i][2] * y[2] - m->nodes[3 * a + i];
    }
    ct_view view = {.displacement = u, .scratch = solid.scratch};
    must(solid.effect->calls->bounds.omega2, solid.effect, &view, &omega_squared[1]);
    double real = true_frequency(problem, u, 1e-6, -1, 300);
    least = fmin(least, omega_squared[1] / real), most = fmax(most, omega_squared[1] / real);
    stiffer = fmax(stiffer, omega_squared[1] / omega_squared[0]);
  }
  tap_ok(least > 1.0 && most < 2.5,
         "%s, %s: bound over true eigenvalue of the tangent %.3f to %.3f", KIND[kind], LAW[law],
         least, most);
  tap_ok(stiffer > 1.2, "%s, %s: the tangent becomes stiffer, up to %.3g times", KIND[kind],
         LAW[law], stiffer);
}

/* An inverted element ends the run; the error has its number and its body's. */
static void inside_out(ct_brick_kind kind, ct_law law)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 21, 1, 1, 21, 1, 1);
  ct_material material = soft(law);
  ct_scene *scene = new_scene_with("first", m, &material, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "second", m, &material, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *problem = build_until(scene, 1.0, 0.5);
  for (int bad = 0; bad < 2; bad++) {
    ct_state *state = new_state(problem);
    ct_error e = {0};
    // Push the middle of the far end through the last element, or set it to NaN.
    for (int n = 0; n < m->node_count; n++)
      if (m->nodes[3 * n] > 20.9)
        state->displacement[3 * (m->node_count + n)] = bad == 0 ? -1.5 : NAN;
    ct_status status = ct_run(problem, state, 2, NULL, 0, &e);
    if (bad == 0)
      tap_ok(status == CT_ERROR_GEOMETRY && e.body == 1 && e.element == 20,
             "%s, %s: the error names an inverted element: %s", KIND[kind], LAW[law], e.text);
    else
      tap_ok(status == CT_ERROR_BLOWUP || status == CT_INVALID,
             "%s, %s: NaN in the displacement is an error: %s", KIND[kind], LAW[law], e.text);
  }
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_solid_body b = {.mesh = m, .material = soft(CT_NEO_HOOKEAN), .kernel = CT_KERNEL_BOX};
  ct_effect *effect = NULL;
  ct_error e = {0};
  double x[60], u[60], f[60], w, mass[8] = {1, 1, 1, 1, 1, 1, 1, 1};
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_UNSUPPORTED && effect == NULL,
         "the box kernel refuses large deformation: %s", e.text);
  b.material.law = (ct_law)7;
  b.kernel = CT_KERNEL_AUTO;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_ARGUMENT && strstr(e.text, "law") != NULL,
         "an unknown law is refused: %s", e.text);
  b.material.law = CT_NEO_HOOKEAN;
  take_element(m, 0, m->nodes, x);
  double flipped[24];
  for (int i = 0; i < 24; i++) u[i] = -2.0 * x[i], flipped[i] = -2.0 * m->nodes[i];
  tap_ok(ct_solid_element_force(CT_HEX8, x, u, &b.material, f, NULL, &e) == CT_ERROR_GEOMETRY &&
             e.point == 0,
         "a point mirrored through the origin is inverted: %s", e.text);
  tap_ok(ct_solid_stress(m, &b.material, flipped, f, &e) == CT_ERROR_GEOMETRY && e.element == 0,
         "and has no stress: %s", e.text);
  tap_ok(ct_solid_element_omega2_bound(CT_HEX8, x, u, &b.material, mass, &w, &e) ==
             CT_ERROR_GEOMETRY,
         "it has no tangent: %s", e.text);
  double linear[2];
  b.material.law = CT_LINEAR;
  must(ct_solid_element_omega2_bound, CT_HEX8, x, u, &b.material, mass, &linear[0]);
  must(ct_solid_element_omega2_bound, CT_HEX8, x, NULL, &b.material, mass, &linear[1]);
  tap_ok(linear[0] == linear[1], "the tangent of the linear law is its stiffness");
}

static void velocities(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_material material = soft(CT_LINEAR);
  ct_scene *scene = new_scene();
  double v[24];
  ct_scene_body block = {.mesh = m, .material = material, .velocity = {9, 9, 9}, .velocities = v};
  ct_error e = {0};
  for (int i = 0; i < 24; i++) v[i] = i;
  v[16] = NAN;
  tap_ok(ct_scene_add_body(scene, &block, NULL, &e) == CT_INVALID && e.body == 0 && e.point == 5,
         "a velocity that is NaN is refused: %s", e.text);
  v[16] = 16;
  must(ct_scene_add_body, scene, &block, NULL);
  const ct_problem *problem = join_scene(scene);
  tap_ok(memcmp(problem->initial_velocity, v, sizeof v) == 0, "each node starts with its velocity");
}

int main(void)
{
  free_at_end();
  for (int kind = 0; kind < 2; kind++)
    for (int l = CT_LINEAR + 1; l < CT_LAW_COUNT; l++) {
      const ct_brick_kind k = (ct_brick_kind)kind;
      const ct_law law = (ct_law)l;
      patch_test(k, law);
      turned(k, law);
      gradients(k, law);
      small_strain(k, law);
      kernels(k, law);
      mirrored(k, law);
      mirrored_ring(k, law);
      tangent_bound(k, law);
      inside_out(k, law);
    }
  refusals();
  velocities();
  return tap_done();
}
