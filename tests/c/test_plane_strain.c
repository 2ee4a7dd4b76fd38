/* One layer of boxes in two dimensions: the same numbers as from bricks, and bricks if the layers
 * move apart. */
#include "blocks.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

static ct_mesh *layer(int axis, int along, int across)
{
  double size[3] = {1.3, 1.3, 1.3};
  int cells[3] = {along, along, along};
  cells[axis] = 1;
  cells[(axis + 1) % 3] = across;
  size[axis] = 0.07;
  return box_mesh(CT_HEX8, 0.1, -0.3, 0.2, size[0], size[1], size[2], cells[0], cells[1], cells[2]);
}

static block open_held(const ct_mesh *m, ct_solid_kernel kernel, int axis)
{
  ct_solid_body b = {.mesh = m, .material = STEEL, .kernel = kernel};
  b.fixed[axis] = 1;
  return open_body(b);
}

static ct_solid_kernel kernel_of(const ct_effect *effect)
{
  ct_solid_kernel kernel = CT_KERNEL_AUTO;
  ct_solid_body_plan(effect, 0, &kernel, NULL, NULL, NULL);
  return kernel;
}

/* A random displacement that is equal in both layers and zero along the axis. */
static double *plane_displacement(const ct_mesh *m, int axis)
{
  double *u = random_displacement(m, 1e-3), low[3], high[3];
  ct_mesh_bounds(m, low, high);
  for (int n = 0; n < m->node_count; n++) {
    u[3 * n + axis] = 0.0;
    for (int k = 0; k < n; k++) {
      int p = (axis + 1) % 3, q = (axis + 2) % 3;
      if (m->nodes[3 * n + p] == m->nodes[3 * k + p] && m->nodes[3 * n + q] == m->nodes[3 * k + q])
        memcpy(&u[3 * n], &u[3 * k], 3 * sizeof *u);
    }
  }
  return u;
}

static int64_t unlike(const double *f, const double *g, int64_t n)
{
  int64_t count = 0;
  for (int64_t i = 0; i < n; i++) count += !(f[i] == g[i]);
  return count;
}

/* In a layer in free flight no force is -0, which would change a velocity of -0 differently from
 * the +0 of bricks and of skipped elements. */
static void zeros(void)
{
  for (int axis = 0; axis < 3; axis++) {
    ct_mesh *m = layer(axis, 5, 4);
    int n = 3 * m->node_count, minus = 0;
    double *u = numbers(n), *f = numbers(n);
    block plane = open_held(m, CT_KERNEL_PLANE, axis);
    for (int i = 0; i < n; i++) u[i] = i % 3 == axis ? 0.0 : 0.7;
    block_force(&plane, u, f);
    for (int i = 0; i < n; i++) minus += f[i] != 0.0 || signbit(f[i]);
    tap_ok(minus == 0, "fixed along %c, in flight: %d of %d forces are not +0", "xyz"[axis], minus,
           n);
  }
}

/* Along each axis, the forces of the bricks (eq:plane-modes, eq:plane-stress, eq:plane-force). */
static void forces(void)
{
  for (int axis = 0; axis < 3; axis++) {
    ct_mesh *m = layer(axis, 19, 23);
    int n = 3 * m->node_count;
    double *u = plane_displacement(m, axis), *f = numbers(n), *g = numbers(n), *h = numbers(n);
    block plane = open_held(m, CT_KERNEL_AUTO, axis), box = open_held(m, CT_KERNEL_BOX, axis);
    double own = block_force(&plane, u, f), want = block_force(&box, u, g),
           energy = reference_force(m, &STEEL, u, h);
    tap_ok(kernel_of(plane.effect) == CT_KERNEL_PLANE && kernel_of(box.effect) == CT_KERNEL_BOX,
           "fixed along %c: the plane kernel is chosen", "xyz"[axis]);
    tap_ok(unlike(f, g, n) == 0 && own == want,
           "%c: %d of %d forces differ from the bricks', energies %.17g and %.17g", "xyz"[axis],
           (int)unlike(f, g, n), n, own, want);
    tap_ok(largest_difference(f, h, n) < 1e-13 * largest(h, n) && fabs(own / energy - 1.0) < 1e-13,
           "%c: the readable form, off by %.2g and %.2g", "xyz"[axis],
           largest_difference(f, h, n) / largest(h, n), own / energy - 1.0);
    tap_ok(block_frequency(&plane) == block_frequency(&box), "%c: the same bound on the step",
           "xyz"[axis]);
    ct_view view = {.settings = &TWO, .displacement = u, .scratch = plane.scratch};
    must(plane.effect->calls->force, plane.effect, &view, h);
    tap_ok(memcmp(f, h, (size_t)n * sizeof *f) == 0, "%c: two threads, the same bits", "xyz"[axis]);
    // Part the layers at one node, or move one along the axis: the bricks take over, and give back.
    for (int how = 0; how < 2; how++) {
      double keep = u[3 * 77 + (axis + how) % 3];
      u[3 * 77 + (axis + how) % 3] += 1e-9;
      own = block_force(&plane, u, f);
      want = block_force(&box, u, g);
      tap_ok(memcmp(f, g, (size_t)n * sizeof *f) == 0 && own == want,
             "%c: layers that part are computed as bricks", "xyz"[axis]);
      u[3 * 77 + (axis + how) % 3] = keep;
    }
    // Both layers alike, but not at rest along the axis.
    double *w = numbers(n);
    memcpy(w, u, (size_t)n * sizeof *w);
    for (int k = 0; k < m->node_count; k++)
      w[3 * k + axis] = 1e-4 * m->nodes[3 * k + (axis + 1) % 3];
    own = block_force(&plane, w, f);
    want = block_force(&box, w, g);
    tap_ok(memcmp(f, g, (size_t)n * sizeof *f) == 0 && own == want,
           "%c: layers that shear along their thickness are, too", "xyz"[axis]);
    own = block_force(&plane, u, f);
    want = block_force(&box, u, g);
    tap_ok(unlike(f, g, n) == 0 && own == want, "%c: and as a plane again", "xyz"[axis]);
  }
}

/* More elements than the rings of forces have, with elements and nodes in any order, by any number
 * of threads. */
static void rings(void)
{
  static const ct_run_settings three = {.threads = 3};
  static const char *const ORDER[] = {"in rows", "elements in any order", "nodes in any order"};
  for (int order = 0; order < 3; order++)
    for (int axis = 1; axis < 3; axis++) {
      ct_mesh *m = layer(axis, 67, 37);
      int n = 3 * m->node_count;
      for (int i = m->element_count - 1; order == 1 && i > 0; i--) {
        int k = pick(i + 1);
        for (int a = 0; a < 8; a++) {
          int32_t keep = m->elements[8 * i + a];
          m->elements[8 * i + a] = m->elements[8 * k + a];
          m->elements[8 * k + a] = keep;
        }
      }
      int32_t *name = integers(m->node_count);
      double *at = numbers(n);
      memcpy(at, m->nodes, (size_t)n * sizeof *at);
      for (int i = 0; i < m->node_count; i++) name[i] = i;
      for (int i = m->node_count - 1; order == 2 && i > 0; i--) {
        int k = pick(i + 1);
        int32_t keep = name[i];
        name[i] = name[k];
        name[k] = keep;
      }
      for (int i = 0; i < m->node_count; i++)
        memcpy(&m->nodes[3 * name[i]], &at[3 * i], 3 * sizeof *at);
      for (int i = 0; i < 8 * m->element_count; i++) m->elements[i] = name[m->elements[i]];
      double *u = plane_displacement(m, axis), *f = numbers(n), *g = numbers(n);
      m->settings = &three;
      block plane = open_held(m, CT_KERNEL_PLANE, axis), box = open_held(m, CT_KERNEL_BOX, axis);
      block_force(&box, u, g);
      for (int threads = 1; threads < 6; threads += 2) {
        const ct_run_settings settings = {.threads = threads};
        ct_view view = {.settings = &settings, .displacement = u, .scratch = plane.scratch};
        memset(f, 0, (size_t)n * sizeof *f);
        must(plane.effect->calls->force, plane.effect, &view, f);
        tap_ok(unlike(f, g, n) == 0,
               "fixed along %c, %s, %d threads: %d of %d forces differ from the bricks'",
               "xyz"[axis], ORDER[order], threads, (int)unlike(f, g, n), n);
      }
    }
}

/* The mirror image of a displacement on the same lattice: node n gets that of the node on the other
 * side. */
static void mirror_field(const int cells[3], int axis, const double *from, double *to)
{
  int row = cells[0] + 1, sheet = row * (cells[1] + 1), nodes = sheet * (cells[2] + 1);
  for (int n = 0; n < nodes; n++) {
    int at[3] = {n % row, n % sheet / row, n / sheet};
    at[axis] = cells[axis] - at[axis];
    int image = at[0] + row * at[1] + sheet * at[2];
    for (int c = 0; c < 3; c++) to[3 * image + c] = c == axis ? -from[3 * n + c] : from[3 * n + c];
  }
}

static void mirrored(void)
{
  static const int cells[3] = {5, 1, 7};
  ct_mesh *m = box_mesh(CT_HEX8, 0.1, -0.3, 0.2, 1.3, 0.07, 1.3, cells[0], cells[1], cells[2]);
  int n = 3 * m->node_count;
  double *u = plane_displacement(m, 1), *v = numbers(n), *f = numbers(n), *g = numbers(n),
         *image = numbers(n);
  block plane = open_held(m, CT_KERNEL_PLANE, 1);
  block_force(&plane, u, f);
  for (int axis = 0; axis < 3; axis++) {
    mirror_field(cells, axis, u, v);
    // No minus zero along the axis: the layers would not be told to be at rest.
    for (int i = 0; i < n; i++) v[i] += 0.0;
    block_force(&plane, v, g);
    mirror_field(cells, axis, f, image);
    tap_ok(unlike(g, image, n) == 0, "mirrored in %c: %d of %d forces are not the mirrored bits",
           "xyz"[axis], (int)unlike(g, image, n), n);
  }
}

static void choice(void)
{
  ct_mesh *one = layer(1, 3, 4), *two = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 2, 3),
          *bent = layer(1, 3, 4);
  ct_error e = {0};
  bent->nodes[0] += 1e-3;
  block held = open_held(one, CT_KERNEL_AUTO, 1), wrong = open_held(one, CT_KERNEL_AUTO, 0),
        thick = open_held(two, CT_KERNEL_AUTO, 1), general = open_held(bent, CT_KERNEL_AUTO, 1);
  tap_ok(kernel_of(held.effect) == CT_KERNEL_PLANE,
         "one layer of boxes fixed along its thickness is a plane");
  tap_ok(kernel_of(wrong.effect) == CT_KERNEL_BOX, "fixed along another axis it is not");
  tap_ok(kernel_of(thick.effect) == CT_KERNEL_BOX, "two layers are not");
  tap_ok(kernel_of(general.effect) == CT_KERNEL_GENERAL, "elements of any shape are not");
  for (int moving = 0; moving < 2; moving++) {
    ct_scene *scene = new_scene_with("layer", one, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
    add_support(scene, 0, one, -1, 0.0, "y", moving ? 3.0 : 0.0);
    const ct_problem *p = build_until(scene, 1e-7, 0.9);
    tap_ok(kernel_of(p->effects[0]) == (moving ? CT_KERNEL_BOX : CT_KERNEL_PLANE),
           "of a scene: fixed %s",
           moving ? "and moving, it is computed as bricks" : "at rest, it is a plane");
  }
  double cost[2], bytes[2];
  block box = open_held(one, CT_KERNEL_BOX, 1);
  ct_solid_body_plan(held.effect, 0, NULL, &cost[0], &bytes[0], NULL);
  ct_solid_body_plan(box.effect, 0, NULL, &cost[1], &bytes[1], NULL);
  tap_ok(cost[1] > 2.0 * cost[0] && bytes[1] > 1.5 * bytes[0],
         "the plan: %.0f operations and %.0f bytes per element, %.0f and %.0f for bricks", cost[0],
         bytes[0], cost[1], bytes[1]);
  ct_solid_body b = {.mesh = one, .material = STEEL, .kernel = CT_KERNEL_PLANE};
  ct_effect *effect = NULL;
  tap_ok(create_solid(&b, 1, &effect, &e) == CT_ERROR_UNSUPPORTED && effect == NULL,
         "a plane that is not fixed is refused: %s", e.text);
}

int main(void)
{
  free_at_end();
  zeros();
  forces();
  rings();
  mirrored();
  choice();
  return tap_done();
}
