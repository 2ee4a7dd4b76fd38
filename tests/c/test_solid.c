/* Internal forces: patch test, energy gradient, rigid motions, the batch kernels against the
 * readable form, frequencies. */
#include "blocks.h"

#include "../../libcontact/src/solid/below.h"

static const char *KIND[2] = {"hex8", "hex20"};
static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
static const ct_material SOFT = {1.0, 0.2, 1.0, CT_LINEAR};

/* A linear displacement on any mesh, which is freed, has its constant stress everywhere and no
 * force at inner nodes (eq:jacobian, eq:jacobian-gradient, eq:hooke, eq:internal-force). */
static void patch_test(ct_mesh *m)
{
  ct_brick_kind kind = m->kind;
  double G[3][3], lambda, mu, want[6], off[2] = {0, 0}, inner = 0.0, top, resultant[3] = {0};
  for (int i = 0; i < 9; i++) G[i / 3][i % 3] = uniform(1e-3);
  ct_material_lame(&STEEL, &lambda, &mu);
  double trace = G[0][0] + G[1][1] + G[2][2];
  for (int i = 0; i < 3; i++) {
    want[i] = lambda * trace + 2.0 * mu * G[i][i];
    want[3 + i] = mu * (G[i][(i + 1) % 3] + G[(i + 1) % 3][i]);
  }
  double *u = numbers(3 * m->node_count), *f = numbers(3 * m->node_count),
         *stress = numbers(6 * m->element_count);
  for (int n = 0; n < m->node_count; n++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) u[3 * n + i] += G[i][j] * m->nodes[3 * n + j];
  must(ct_solid_stress, m, &STEEL, u, stress);
  for (int el = 0; el < m->element_count; el++) {
    double x[60], v[60], xi[3] = {uniform(1.0), uniform(1.0), uniform(1.0)}, s[6];
    take_element(m, el, m->nodes, x);
    take_element(m, el, u, v);
    must(ct_solid_element_stress, kind, x, v, &STEEL, xi, s);
    off[0] = worst(off[0], largest_difference(&stress[6 * el], want, 6));
    off[1] = worst(off[1], largest_difference(s, want, 6));
  }
  tap_ok(off[0] < 1e-13 * largest(want, 6), "%s patch: stress at centres, off by %.2g", KIND[kind],
         off[0] / largest(want, 6));
  tap_ok(off[1] < 1e-13 * largest(want, 6), "%s patch: stress anywhere, off by %.2g", KIND[kind],
         off[1] / largest(want, 6));

  block solid = open_block(m, &STEEL, CT_KERNEL_GENERAL);
  double energy = block_force(&solid, u, f), density = 0.0, volume = 0.0;
  int32_t *outer = integers(8 * 6 * m->element_count), *is_outer = integers(m->node_count);
  int per_face = kind == CT_HEX8 ? 4 : 8, faces = ct_mesh_outer_faces(m, outer, NULL);
  for (int i = 0; i < faces * per_face; i++) is_outer[outer[i]] = 1;
  top = largest(f, 3 * m->node_count);
  for (int n = 0; n < m->node_count; n++)
    for (int c = 0; c < 3; c++) {
      if (!is_outer[n]) inner = worst(inner, f[3 * n + c]);
      resultant[c] += f[3 * n + c];
    }
  tap_ok(inner < 1e-12 * top, "%s patch: no force at inner nodes, at most %.2g of the largest",
         KIND[kind], inner / top);
  tap_ok(largest(resultant, 3) < 1e-12 * top, "%s patch: the sum of the forces is zero, %.2g",
         KIND[kind], largest(resultant, 3) / top);
  // Energy is half stress times strain times the volume (mass at density 1).
  double *mass = numbers(m->node_count);
  must(ct_mass_lumped, m, 1.0, CT_LUMP_DEFAULT, mass);
  for (int n = 0; n < m->node_count; n++) volume += mass[n];
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    density += 0.5 * want[i] * G[i][i] + 0.5 * want[3 + i] * (G[i][j] + G[j][i]);
  }
  tap_close(energy / (density * volume), 1.0, 1e-12, "%s patch: energy", KIND[kind]);
}

/* A distorted box, a ball, a shell and a cylinder. */
static void patches(ct_brick_kind kind)
{
  ct_ball ball = {{1, 2, 3}, {0, 1}, {1, 8}}, shell = {{1, 2, 3}, {0.5, 1}, {1, 8}};
  ct_cylinder cylinder = {{1, 2, 3}, 1, 0.5, {1, 8, 2}};
  ct_mesh *m[4] = {box_mesh(kind, 0, 0, 0, 1, 1, 1, 3, 3, 3), NULL, NULL, NULL};
  distort(m[0], kind == CT_HEX8 ? 0.08 : 0.03);
  turn_elements(m[0]);
  must(ct_mesh_create_ball, kind, &ball, &m[1]);
  must(ct_mesh_create_ball, kind, &shell, &m[2]);
  must(ct_mesh_create_cylinder, kind, &cylinder, &m[3]);
  for (int i = 0; i < 4; i++) patch_test(i > 0 ? later_mesh(m[i]) : m[i]);
}

/* The stresses of all elements, in batches of any size, against the readable form at the centres:
 * the same bits, and the same refusal of an element that is inverted. */
static void stresses(ct_brick_kind kind, ct_law law)
{
  static const int count[5] = {1, 7, 8, 9, 17};
  static const double centre[3] = {0.0, 0.0, 0.0};
  const ct_material material = {3.0, 0.3, 2.0, law};
  int64_t unlike = 0;
  ct_error e;
  for (int i = 0; i < 5; i++) {
    ct_mesh *m = box_mesh(kind, 0, 0, 0, count[i], 1, 1, count[i], 1, 1);
    distort(m, kind == CT_HEX8 ? 0.12 : 0.05);
    double *u = random_displacement(m, 0.05), *stress = numbers(6 * count[i]), x[60], v[60], s[6];
    must(ct_solid_stress, m, &material, u, stress);
    for (int el = 0; el < count[i]; el++) {
      take_element(m, el, m->nodes, x);
      take_element(m, el, u, v);
      must(ct_solid_element_stress, kind, x, v, &material, centre, s);
      unlike += memcmp(s, &stress[6 * el], sizeof s) != 0;
    }
    // The last element of the mesh, mirrored.
    for (int n = 0; n < m->node_count; n++)
      if (m->nodes[3 * n] > count[i] - 0.3) m->nodes[3 * n] -= 2.0;
    unlike += ct_solid_stress(m, &material, u, stress, &e) != CT_ERROR_GEOMETRY ||
              e.element != count[i] - 1;
  }
  tap_ok(unlike == 0, "%s, law %d: stresses in batches are the readable form's, to the last bit",
         KIND[kind], (int)law);
}

/* The force is minus the gradient of the energy. The energy is quadratic, so central differences
 * have no error but rounding (eq:internal-force, eq:solid-energy). */
static void energy_gradient(ct_brick_kind kind)
{
  int n = 3 * ct_brick_node_count(kind);
  double x[60], u[60], f[60], g[60], off = 0.0, top = 0.0, work = 0.0, energy, up, down;
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  distort(m, kind == CT_HEX8 ? 0.15 : 0.05);
  take_element(m, 0, m->nodes, x);
  for (int i = 0; i < n; i++) u[i] = uniform(1.0);
  must(ct_solid_element_force, kind, x, u, &SOFT, f, &energy);
  for (int i = 0; i < n; i++) {
    double keep = u[i], h = 0.5;
    u[i] = keep + h;
    must(ct_solid_element_force, kind, x, u, &SOFT, g, &up);
    u[i] = keep - h;
    must(ct_solid_element_force, kind, x, u, &SOFT, g, &down);
    u[i] = keep;
    off = worst(off, f[i] + (up - down) / (2.0 * h));
    top = worst(top, f[i]);
    work -= 0.5 * f[i] * u[i];
  }
  tap_ok(off < 1e-13 * top, "%s: force is minus the gradient of the energy, off by %.2g",
         KIND[kind], off / top);
  tap_close(work / energy, 1.0, 1e-13, "%s: energy is half the work", KIND[kind]);
}

static void rigid_motions(ct_brick_kind kind, ct_solid_kernel kernel, const char *name)
{
  ct_mesh *m = box_mesh(kind, 0.1, -0.7, 1.3, 1, 1, 1, 3, 3, 3);
  if (kernel == CT_KERNEL_GENERAL) distort(m, 0.03);
  block solid = open_block(m, &STEEL, kernel);
  double *u = numbers(3 * m->node_count), *f = numbers(3 * m->node_count),
         *g = numbers(3 * m->node_count), nonzero = 0.0, scale;
  for (int k = 0; k < 20; k++) {
    double t[3] = {uniform(1e3), uniform(1e-3), uniform(1.0)};
    for (int i = 0; i < 3 * m->node_count; i++) u[i] = t[i % 3];
    double energy = block_force(&solid, u, f);
    nonzero = worst(worst(nonzero, largest(f, 3 * m->node_count)), energy);
    reference_force(m, &STEEL, u, g);
    nonzero = worst(nonzero, largest(g, 3 * m->node_count));
  }
  tap_ok(nonzero == 0.0, "%s: a translation gives exactly no force and no energy (%g)", name,
         nonzero);

  // Small rotation u = w x X, against a stretch of the same size.
  double w[3] = {0.3, -0.5, 0.7};
  for (int n = 0; n < m->node_count; n++)
    for (int c = 0; c < 3; c++)
      u[3 * n + c] = w[(c + 1) % 3] * m->nodes[3 * n + (c + 2) % 3] -
                     w[(c + 2) % 3] * m->nodes[3 * n + (c + 1) % 3];
  block_force(&solid, u, f);
  block_force(&solid, m->nodes, g);
  scale = largest(g, 3 * m->node_count);
  tap_ok(largest(f, 3 * m->node_count) < 1e-14 * scale,
         "%s: a small rotation gives %.2g of a stretch's force", name,
         largest(f, 3 * m->node_count) / scale);
}

static void kernel_against_reference(ct_mesh *m, ct_solid_kernel kernel, const char *name)
{
  block solid = open_block(m, &STEEL, kernel);
  double *u = random_displacement(m, 1e-3), *f = numbers(3 * m->node_count),
         *g = numbers(3 * m->node_count);
  double energy = block_force(&solid, u, f), want = reference_force(m, &STEEL, u, g);
  ct_solid_kernel chosen = CT_KERNEL_AUTO;
  ct_solid_body_plan(solid.effect, 0, &chosen, NULL, NULL, NULL);
  double off = largest_difference(f, g, 3 * m->node_count) / largest(g, 3 * m->node_count);
  tap_ok(off < 1e-13 && chosen == kernel && fabs(energy / want - 1.0) < 1e-13,
         "%s, %d elements: force off by %.2g, energy by %.2g", name, m->element_count, off,
         fabs(energy / want - 1.0));
}

/* The kernels of distorted bricks and of boxes (eq:reference-stress, eq:brick-modes,
 * eq:brick20-gradient, eq:box-gradient, eq:box-moments, eq:box-stress, eq:box-force). */
static void kernels(void)
{
  static const int count[5] = {1, 7, 8, 9, 17};
  for (int i = 0; i < 5; i++) {
    ct_mesh *box = box_mesh(CT_HEX8, -1, 2, 0.5, count[i] * 0.3, 0.7, 1.1, count[i], 1, 1);
    kernel_against_reference(box, CT_KERNEL_BOX, "box kernel");
    ct_mesh *hex8 = box_mesh(CT_HEX8, -1, 2, 0.5, count[i], 1, 1, count[i], 1, 1);
    distort(hex8, 0.12);
    kernel_against_reference(hex8, CT_KERNEL_GENERAL, "hex8 kernel");
    ct_mesh *hex20 = box_mesh(CT_HEX20, -1, 2, 0.5, count[i], 1, 1, count[i], 1, 1);
    distort(hex20, 0.05);
    kernel_against_reference(hex20, CT_KERNEL_GENERAL, "hex20 kernel");
  }
  for (int kind = 0; kind < 2; kind++) {
    // Elements whose axes point anywhere meet a node in the same octant: the assembly must add them
    // one after another.
    ct_mesh *m = box_mesh((ct_brick_kind)kind, 0, 0, 0, 4, 3, 5, 4, 3, 5);
    distort(m, 0.05);
    turn_elements(m);
    kernel_against_reference(m, CT_KERNEL_GENERAL,
                             kind == 0 ? "hex8 kernel, rotated elements"
                                       : "hex20 kernel, rotated elements");
  }
  ct_mesh *three = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 5, 4, 3);
  kernel_against_reference(three, CT_KERNEL_BOX, "box kernel, a block of cells");
}

/* A mesh of many batches: nodes are summed while elements are still being computed, so each must
 * wait for its last element. The scratch contains the forces of another displacement before, and
 * elements are in their own order or in any. */
static void large_mesh(ct_brick_kind kind, ct_solid_kernel kernel, int shuffled, const char *name)
{
  ct_mesh *m = kind == CT_HEX8 ? box_mesh(kind, 0, 0, 0, 12, 10, 11, 12, 10, 11)
                               : box_mesh(kind, 0, 0, 0, 9, 8, 8, 9, 8, 8);
  if (kernel == CT_KERNEL_GENERAL) distort(m, 0.03);
  int per = ct_brick_node_count(kind), n = 3 * m->node_count;
  for (int i = m->element_count - 1; shuffled && i > 0; i--) {
    int32_t keep[20], *a = &m->elements[i * per], *b = &m->elements[pick(i + 1) * per];
    memcpy(keep, a, (size_t)per * sizeof *a);
    memmove(a, b, (size_t)per * sizeof *a);
    memcpy(b, keep, (size_t)per * sizeof *a);
  }
  block solid = open_block(m, &STEEL, kernel);
  double *u = random_displacement(m, 1e-3), *before = random_displacement(m, 1e-3), *f = numbers(n),
         *g = numbers(n);
  block_force(&solid, before, f);
  double energy = block_force(&solid, u, f), want = reference_force(m, &STEEL, u, g),
         off = largest_difference(f, g, n) / largest(g, n);
  tap_ok(off < 1e-13 && fabs(energy / want - 1.0) < 1e-13,
         "%s, %d elements%s: force off by %.2g, energy by %.2g", name, m->element_count,
         shuffled ? " in any order" : "", off, fabs(energy / want - 1.0));
  ct_view view = {.settings = &TWO, .displacement = before, .scratch = solid.scratch};
  must(solid.effect->calls->force, solid.effect, &view, g);
  view.displacement = u;
  must(solid.effect->calls->force, solid.effect, &view, g);
  tap_ok(memcmp(f, g, (size_t)n * sizeof *f) == 0, "%s, %d elements%s: two threads, the same bits",
         name, m->element_count, shuffled ? " in any order" : "");
}

/* Five wedges of hexahedra around an axis: a node with five elements, which no lattice has. */
static void wheel(void)
{
  enum { SPOKES = 5 };
  ct_mesh m = {
      CT_HEX8, 2 * (2 * SPOKES + 1), SPOKES, numbers(6 * (2 * SPOKES + 1)), integers(8 * SPOKES),
      0};
  const double turn = 2.0 * 3.14159265358979323846 / (2 * SPOKES);
  for (int n = 0; n < m.node_count; n++) {
    int layer = n / (2 * SPOKES + 1), k = n % (2 * SPOKES + 1);
    double r = k == 0 ? 0.0 : k % 2 ? 1.0 : 1.3;
    m.nodes[3 * n] = r * cos(turn * k);
    m.nodes[3 * n + 1] = r * sin(turn * k);
    m.nodes[3 * n + 2] = layer;
  }
  for (int s = 0; s < SPOKES; s++) {
    int ring[4] = {0, 2 * s + 1, 2 * s + 2, 2 * ((s + 1) % SPOKES) + 1};
    for (int a = 0; a < 8; a++) m.elements[8 * s + a] = ring[a % 4] + a / 4 * (2 * SPOKES + 1);
  }
  ct_mesh *copy = copy_mesh(&m);
  kernel_against_reference(copy, CT_KERNEL_GENERAL, "hex8 kernel, five elements around an axis");
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  m->nodes[3 * 13] += 0.01;
  ct_solid_body b = {.mesh = m, .material = STEEL, .kernel = CT_KERNEL_BOX};
  ct_effect *effect = NULL;
  ct_error e = {0};
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_UNSUPPORTED && effect == NULL && e.body == 0,
         "the box kernel refuses another mesh: %s", e.text);
  b.kernel = CT_KERNEL_AUTO;
  must(create_solid, &b, 1, &effect);
  ct_solid_kernel chosen = CT_KERNEL_BOX;
  double flops = 0, bytes = 0;
  ct_solid_body_plan(effect, 0, &chosen, &flops, &bytes, NULL);
  tap_ok(chosen == CT_KERNEL_GENERAL && flops > 0 && bytes > 0,
         "the cheapest that fits a distorted mesh is the general one");
  tap_ok(ct_solid_body_plan(effect, 1, &chosen, NULL, NULL, NULL) == CT_ERROR_ARGUMENT,
         "there is no second block");
  ct_effect_free(effect);
  effect = NULL;
  b.first_node = 3;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_ARGUMENT,
         "a gap before the body is refused: %s", e.text);
  b.first_node = 0;
  b.material.poisson = 0.5;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_ARGUMENT && strstr(e.text, "Poisson") != NULL,
         "an incompressible body is refused: %s", e.text);
  b.material = STEEL;
  ct_mesh *q = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  b.mesh = q;
  b.lumping = CT_LUMP_ROW_SUM;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_UNSUPPORTED,
         "row-summed hex20 is refused: %s", e.text);
  tap_ok(create_solid(NULL, 1, &effect, NULL) == CT_ERROR_ARGUMENT &&
             create_solid(&b, 0, &effect, NULL) == CT_ERROR_ARGUMENT && effect == NULL,
         "no bodies are refused");

  double x[60], u[60] = {0}, f[60], s[6], w, mass[20], xi[3] = {0, 0, 0};
  take_element(m, 0, m->nodes, x);
  for (int c = 0; c < 3; c++) {
    double t = x[c];
    x[c] = x[12 + c];
    x[12 + c] = t;
  }
  for (int a = 0; a < 20; a++) mass[a] = 1.0;
  tap_ok(ct_solid_element_force(CT_HEX8, x, u, &STEEL, f, NULL, &e) == CT_ERROR_GEOMETRY &&
             e.point >= 0,
         "the force of a folded element is refused: %s", e.text);
  tap_ok(ct_solid_element_omega2_bound(CT_HEX8, x, NULL, &STEEL, mass, &w, &e) == CT_ERROR_GEOMETRY,
         "its frequency is refused, too");
  take_element(m, 0, m->nodes, x);
  mass[4] = 0.0;
  tap_ok(ct_solid_element_omega2_bound(CT_HEX8, x, NULL, &STEEL, mass, &w, &e) ==
                 CT_ERROR_ARGUMENT &&
             e.point == 4,
         "a node without mass is refused: %s", e.text);
  tap_ok(ct_solid_element_stress((ct_brick_kind)4, x, u, &STEEL, xi, s, NULL) ==
                 CT_ERROR_ARGUMENT &&
             ct_solid_element_force(CT_HEX8, NULL, u, &STEEL, f, NULL, NULL) == CT_ERROR_ARGUMENT,
         "an unknown element and a null pointer are refused");
}

/* M^-1/2 K M^-1/2 of one element, K column by column from unit displacements, and its largest
 * eigenvalue by Jacobi's method. */
static double jacobi_frequency(ct_brick_kind kind, const double x[60], const ct_material *material,
                               const double mass[20])
{
  static double A[60 * 60];
  int n = 3 * ct_brick_node_count(kind);
  for (int j = 0; j < n; j++) {
    double u[60] = {0}, f[60];
    u[j] = 1.0;
    must(ct_solid_element_force, kind, x, u, material, f, NULL);
    for (int i = 0; i < n; i++) A[i * n + j] = -f[i] / sqrt(mass[i / 3] * mass[j / 3]);
  }
  return jacobi_largest(n, A);
}

static double element_frequency(const ct_mesh *m, const ct_material *material, double x[60],
                                double mass[20])
{
  double w;
  take_element(m, 0, m->nodes, x);
  must(ct_mass_element, m->kind, x, material->density, CT_LUMP_DEFAULT, mass);
  must(ct_solid_element_omega2_bound, m->kind, x, NULL, material, mass, &w);
  return w;
}

/* Closed forms for cubes, and Jacobi's method (eq:stiffness, eq:element-scaled, eq:householder,
 * eq:sturm). */
static void frequencies(void)
{
  static const double poisson[4] = {0.0, 0.3, 0.45, -0.4},
                      printed[2][2] = {{1.0, 0.7338}, {0.25, 0.27}};
  double x[60], mass[20], c1, c2;
  for (int kind = 0; kind < 2; kind++)
    for (int k = 0; k < 4; k++) {
      ct_material m = {3.0, poisson[k], 2.0, CT_LINEAR};
      ct_mesh *cube = box_mesh((ct_brick_kind)kind, 0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1);
      ct_material_speeds(&m, &c1, &c2);
      double w = element_frequency(cube, &m, x, mass), courant = 2.0 / sqrt(w) * c1 / 0.5;
      if (k < 2)
        tap_close(courant, printed[kind][k], kind == 0 ? 5e-5 : 5e-3,
                  "%s cube, nu = %g: critical c1 dt / h", KIND[kind], poisson[k]);
      if (kind == 0 && poisson[k] >= 0.0) {
        // The highest mode of the cube is its dilatation u = x: omega^2 = 12 K / (rho h^2), K = E /
        // 3 (1 - 2 nu).
        double bulk = m.young / (3.0 * (1.0 - 2.0 * m.poisson));
        tap_close(w / (12.0 * bulk / (m.density * 0.25)), 1.0, 1e-11,
                  "hex8 cube, nu = %g: omega^2 = 12 K / rho h^2", poisson[k]);
      }
      tap_close(w / jacobi_frequency((ct_brick_kind)kind, x, &m, mass), 1.0, 1e-11,
                "%s cube, nu = %g: Jacobi's largest eigenvalue", KIND[kind], poisson[k]);
    }
  double low = INFINITY, high = 0.0;
  for (int trial = 0; trial < 40; trial++) {
    ct_mesh *m = box_mesh((ct_brick_kind)(trial % 2), 0, 0, 0, exp(uniform(2.0)), 1,
                          exp(uniform(2.0)), 1, 1, 1);
    distort(m, 0.02);
    double w = element_frequency(m, &STEEL, x, mass),
           ratio = w / jacobi_frequency((ct_brick_kind)(trial % 2), x, &STEEL, mass);
    low = fmin(low, ratio);
    high = fmax(high, ratio);
  }
  tap_ok(low >= 1.0 - 1e-13 && high < 1.0 + 1e-11,
         "40 distorted elements: bound over Jacobi's eigenvalue in 1%+.2g ... 1%+.2g", low - 1.0,
         high - 1.0);
}

/* The bound of the elements is above the largest eigenvalue of the assembled mesh, and not far
 * (eq:element-bound). */
static void global_bound(ct_brick_kind kind, ct_solid_kernel kernel, const char *name)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 4, 4, 4, 4, 4, 4);
  if (kernel != CT_KERNEL_BOX) distort(m, kind == CT_HEX8 ? 0.1 : 0.04);
  block solid = open_block(m, &SOFT, kernel);
  const double bound = block_frequency(&solid),
               quotient = block_quotient(&solid, m, SOFT.density, (int[3]){0}, 400);
  tap_ok(bound >= quotient && bound < 2.0 * quotient,
         "%s: bound of omega^2 is %.4f of the mesh's own", name, bound / quotient);
}

/* The bound of a mesh is that of its worst element, at any place: equal elements may be skipped,
 * others not. */
static void worst_element(ct_brick_kind kind)
{
  double wrong = 0.0, x[60], mass[20];
  for (int thin = 0; thin < 9; thin++) {
    ct_mesh *m = box_mesh(kind, 0, 0, 0, 9, 1, 1, 9, 1, 1);
    // Cell number `thin` is half as long as the others.
    for (int n = 0; n < m->node_count; n++)
      m->nodes[3 * n] -= 0.5 * fmin(fmax(m->nodes[3 * n] - thin, 0.0), 1.0);
    block solid = open_block(m, &STEEL, CT_KERNEL_AUTO);
    double top = 0.0, w;
    for (int el = 0; el < 9; el++) {
      take_element(m, el, m->nodes, x);
      must(ct_mass_element, kind, x, STEEL.density, CT_LUMP_DEFAULT, mass);
      must(ct_solid_element_omega2_bound, kind, x, NULL, &STEEL, mass, &w);
      top = fmax(top, w);
    }
    wrong = worst(wrong, block_frequency(&solid) / top - 1.0);
  }
  tap_ok(
      wrong < 1e-12,
      "%s: the bound of nine cells is that of the thin one, first, last or between (off by %.2g)",
      KIND[kind], wrong);
}

/* The element matrix without fixed components, as a mass that hardly moves. */
static double held_frequency(const ct_mesh *m, int el, const int held[3])
{
  int n = 3 * ct_brick_node_count(m->kind);
  double *A = numbers(n * n), x[60], mass[20];
  take_element(m, el, m->nodes, x);
  must(ct_mass_element, m->kind, x, STEEL.density, CT_LUMP_DEFAULT, mass);
  for (int j = 0; j < n; j++) {
    double u[60] = {0}, f[60];
    u[j] = 1.0;
    must(ct_solid_element_force, m->kind, x, u, &STEEL, f, NULL);
    for (int i = 0; i < n; i++)
      if (!held[i % 3] && !held[j % 3]) A[i * n + j] = -f[i] / sqrt(mass[i / 3] * mass[j / 3]);
  }
  double top = jacobi_largest(n, A);
  return top;
}

/* Elements that certainly have no eigenvalue above a number, compared with Jacobi's eigenvalues
 * slightly below and above it; and the bound of the body is the largest of all. Elements grow along
 * x, so that a stiff one is first, and last (eq:definite). */
static void definite(ct_brick_kind kind)
{
  static const int HELD[3][3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 1}};
  static const ct_optimisations NONE = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 1, kind == CT_HEX8 ? 11 : 5, 1, 1);
    for (int n = 0; n < m->node_count; n++)
      m->nodes[3 * n] *= (k == 1 ? 0.3 : 1.0) + 0.2 * m->nodes[3 * n] * (k == 2 ? -1.0 : 1.0);
    distort(m, kind == CT_HEX8 ? 0.01 : 0.004);
    ct_solid_part part = {.mesh = m, .material = STEEL};
    ct_material_lame(&STEEL, &part.lambda, &part.mu);
    ct_mass_shapes at;
    must(ct_mass_tabulate, kind, CT_LUMP_DEFAULT, &at);
    double top = 0.0;
    int wrong = 0;
    for (int el = 0; el < m->element_count; el++) {
      double w = held_frequency(m, el, HELD[k]);
      int32_t first = el - el % CT_LANES_COUNT;
      for (int above = 0; above < 2; above++) {
        double limit = w * (above ? 1.0 + 1e-8 : 1.0 - 1e-8);
        wrong +=
            (int)(ct_solid_below(&part, &at, first, HELD[k], limit) >> (el - first) & 1) != above;
      }
      top = fmax(top, w);
    }
    tap_ok(wrong == 0, "%s: elements are reported below their frequency %d times wrongly",
           KIND[kind], wrong);
    block solid = open_body((ct_solid_body){.mesh = m,
                                            .material = STEEL,
                                            .optimisations = &NONE,
                                            .fixed = {HELD[k][0], HELD[k][1], HELD[k][2]}});
    tap_close(block_frequency(&solid) / top, 1.0, 1e-11,
              "%s: the bound of different elements, %d fixed", KIND[kind],
              HELD[k][0] + HELD[k][1] + HELD[k][2]);
  }
}

/* Forces and energies of a mirrored body have the mirrored bits (eq:tree-sum). */
static void mirrored(ct_brick_kind kind, ct_solid_kernel kernel, const char *name)
{
  for (int axis = 0; axis < 3; axis++) {
    ct_mesh *m = box_mesh(kind, 0.13, -0.71, 0.37, 1, 1.1, 0.9, 4, 3, 5);
    if (kernel != CT_KERNEL_BOX) distort(m, 0.03);
    ct_mesh *image = mirror_mesh(m, axis);
    block right = open_block(m, &STEEL, kernel), left = open_block(image, &STEEL, kernel);
    double *u = random_displacement(m, 1e-3), *v = numbers(3 * m->node_count),
           *f = numbers(3 * m->node_count), *g = numbers(3 * m->node_count);
    for (int i = 0; i < 3 * m->node_count; i++) v[i] = i % 3 == axis ? -u[i] : u[i];
    double energy = block_force(&right, u, f), other = block_force(&left, v, g);
    int64_t faults = mirror_faults(f, g, m->node_count, axis);
    tap_ok(faults == 0 && energy == other,
           "%s mirrored in %c: %d of %d forces are not the mirrored bits", name, "xyz"[axis],
           (int)faults, 3 * m->node_count);
  }
}

/* Renumber the nodes at random; `to` has the new numbers. */
static ct_mesh *renumber(const ct_mesh *m, int32_t *to)
{
  ct_mesh *other = copy_mesh(m);
  for (int n = 0; n < m->node_count; n++) to[n] = n;
  for (int n = m->node_count - 1; n > 0; n--) {
    int k = pick(n + 1), keep = to[n];
    to[n] = to[k], to[k] = keep;
  }
  for (int n = 0; n < m->node_count; n++)
    memcpy(&other->nodes[3 * to[n]], &m->nodes[3 * n], 3 * sizeof *m->nodes);
  for (int i = 0; i < m->element_count * ct_brick_node_count(m->kind); i++)
    other->elements[i] = to[m->elements[i]];
  return other;
}

/* Batches with consecutive nodes are read differently from others; the bits are the same. */
static void rows(ct_brick_kind kind, ct_solid_kernel kernel, ct_law law, const char *name)
{
  ct_material material = {2.1e5, 0.3, 7.8e-9, law};
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 19, 3, 4, 19, 3, 4);
  if (kernel != CT_KERNEL_BOX) distort(m, 0.03);
  int32_t *to = integers(m->node_count), faults = 0, per = ct_brick_node_count(kind);
  // A batch whose first and last elements alone stand as in a row.
  for (int a = 0; a < per; a++) {
    int32_t keep = m->elements[per + a];
    m->elements[per + a] = m->elements[2 * per + a];
    m->elements[2 * per + a] = keep;
  }
  ct_mesh *other = renumber(m, to);
  block in_rows = open_block(m, &material, kernel), not = open_block(other, &material, kernel);
  double *u = random_displacement(m, 1e-3), *v = numbers(3 * m->node_count),
         *f = numbers(3 * m->node_count), *g = numbers(3 * m->node_count);
  for (int n = 0; n < m->node_count; n++) memcpy(&v[3 * to[n]], &u[3 * n], 3 * sizeof *u);
  double energy = block_force(&in_rows, u, f), same = block_force(&not, v, g);
  for (int n = 0; n < m->node_count; n++)
    faults += memcmp(&g[3 * to[n]], &f[3 * n], 3 * sizeof *f) != 0;
  tap_ok(faults == 0 && energy == same, "%s: other numbers of the nodes, the same bits (%d differ)",
         name, faults);
}

/* Bytes of rows by hand: the numbers of one element in eight; coordinates, displacement and force
 * of each node. */
static void bytes_of_rows(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 16, 8, 8, 16, 8, 8);
  distort(m, 0.03);
  block solid = open_block(m, &STEEL, CT_KERNEL_GENERAL);
  double bytes = 0.0;
  ct_solid_body_plan(solid.effect, 0, NULL, NULL, &bytes, NULL);
  tap_close(bytes / (4.0 + 72.0 * m->node_count / m->element_count), 1.0, 1e-15,
            "bytes of an element in rows");
}

/* All of this for hex20 boxes. */
static void box20(void)
{
  static const int count[5] = {1, 7, 8, 9, 17};
  rigid_motions(CT_HEX20, CT_KERNEL_BOX, "hex20 box kernel");
  for (int i = 0; i < 5; i++) {
    ct_mesh *m = box_mesh(CT_HEX20, -1, 2, 0.5, count[i] * 0.3, 0.7, 1.1, count[i], 1, 1);
    kernel_against_reference(m, CT_KERNEL_BOX, "hex20 box kernel");
  }
  for (int shuffled = 0; shuffled < 2; shuffled++)
    large_mesh(CT_HEX20, CT_KERNEL_BOX, shuffled, "hex20 box kernel");
  global_bound(CT_HEX20, CT_KERNEL_BOX, "hex20 box kernel");
  mirrored(CT_HEX20, CT_KERNEL_BOX, "hex20 box kernel");
}

/* Each kind of element has a general kernel for each law. */
static void has_kernel(ct_brick_kind kind, ct_law law)
{
  ct_error e = {0};
  ct_effect *effect = NULL;
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 1, 1, 2, 1, 1);
  ct_solid_body b = {.mesh = m, .material = STEEL, .kernel = CT_KERNEL_GENERAL};
  b.material.law = law;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_OK, "%s, law %d: a general kernel %s",
         ct_brick_facts_of(kind)->name, (int)law, e.text);
  ct_effect_free(effect);
}

int main(void)
{
  free_at_end();
  for (int kind = 0; kind < CT_BRICK_COUNT; kind++) {
    for (int law = 0; law < CT_LAW_COUNT; law++) has_kernel((ct_brick_kind)kind, (ct_law)law);
    patches((ct_brick_kind)kind);
    energy_gradient((ct_brick_kind)kind);
    for (int law = 0; law < CT_LAW_COUNT; law++) stresses((ct_brick_kind)kind, (ct_law)law);
  }
  rigid_motions(CT_HEX8, CT_KERNEL_BOX, "box kernel");
  rigid_motions(CT_HEX8, CT_KERNEL_GENERAL, "hex8 kernel");
  rigid_motions(CT_HEX20, CT_KERNEL_GENERAL, "hex20 kernel");
  kernels();
  for (int shuffled = 0; shuffled < 2; shuffled++) {
    large_mesh(CT_HEX8, CT_KERNEL_BOX, shuffled, "box kernel");
    large_mesh(CT_HEX8, CT_KERNEL_GENERAL, shuffled, "hex8 kernel");
    large_mesh(CT_HEX20, CT_KERNEL_GENERAL, shuffled, "hex20 kernel");
  }
  wheel();
  refusals();
  frequencies();
  worst_element(CT_HEX8);
  worst_element(CT_HEX20);
  global_bound(CT_HEX8, CT_KERNEL_BOX, "box kernel");
  global_bound(CT_HEX8, CT_KERNEL_GENERAL, "hex8 kernel");
  global_bound(CT_HEX20, CT_KERNEL_GENERAL, "hex20 kernel");
  global_bound(CT_HEX8, CT_KERNEL_REDUCED, "reduced kernel");
  mirrored(CT_HEX8, CT_KERNEL_BOX, "box kernel");
  mirrored(CT_HEX8, CT_KERNEL_GENERAL, "hex8 kernel");
  mirrored(CT_HEX20, CT_KERNEL_GENERAL, "hex20 kernel");
  mirrored(CT_HEX8, CT_KERNEL_REDUCED, "reduced kernel");
  box20();
  rows(CT_HEX8, CT_KERNEL_BOX, CT_LINEAR, "box kernel");
  rows(CT_HEX8, CT_KERNEL_GENERAL, CT_LINEAR, "hex8 kernel");
  rows(CT_HEX8, CT_KERNEL_REDUCED, CT_LINEAR, "reduced kernel");
  rows(CT_HEX8, CT_KERNEL_GENERAL, CT_NEO_HOOKEAN, "hex8 kernel, neo-Hookean");
  rows(CT_HEX20, CT_KERNEL_GENERAL, CT_LINEAR, "hex20 kernel");
  bytes_of_rows();
  definite(CT_HEX8);
  definite(CT_HEX20);
  return tap_done();
}
