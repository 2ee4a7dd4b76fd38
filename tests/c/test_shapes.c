/* Balls, shells and cylinders: counts, conformity, symmetry, volume and area against those of the
 * sphere, and what is refused. */
#include "bodies.h"

static const char *KIND[2] = {"hex8", "hex20"};
static const double PI = 3.14159265358979323846;

/* One shape; an inner radius makes a shell. */
typedef struct form {
  const char *name;
  int axes;
  double radius[2], width, centre[3];
} form;

static const form FORMS[3] = {{"ball", 3, {0.0, 1.3}, 0.0, {0, 0, 0}},
                              {"shell", 3, {0.7, 1.3}, 0.0, {0, 0, 0}},
                              {"cylinder", 2, {0.0, 1.3}, 0.9, {0, 0, 0}}};

static ct_status create(ct_brick_kind kind, const form *f, int layers, int around, int across,
                        ct_mesh **m, ct_error *e)
{
  const double *c = f->centre, *r = f->radius;
  ct_ball ball = {{c[0], c[1], c[2]}, {r[0], r[1]}, {layers, around}};
  ct_cylinder cylinder = {{c[0], c[1], c[2]}, r[1], f->width, {layers, around, across}};
  return f->axes == 3 ? ct_mesh_create_ball(kind, &ball, m, e)
                      : ct_mesh_create_cylinder(kind, &cylinder, m, e);
}

static ct_mesh *mesh_form(ct_brick_kind kind, const form *f, int layers, int n, int across)
{
  ct_mesh *m = NULL;
  must(create, kind, f, layers, 4 * n, across, &m);
  must(ct_mesh_check, m);
  return later_mesh(m);
}

/* Numbers of vertices and edges in closed form: of the square of n cells, of the surface of the
 * cube, of the cube. */
static void counts(ct_brick_kind kind, const form *f, int L, int n, int across)
{
  int hollow = f->radius[0] > 0.0, q = n + 1, vertices, edges, cells;
  if (f->axes == 3) {
    int on = 6 * n * n + 2, around = 12 * n * n;
    cells = 6 * n * n * L + (hollow ? 0 : n * n * n);
    vertices = hollow ? on * (L + 1) : q * q * q + on * L;
    edges = hollow ? around * (L + 1) + on * L : 3 * n * q * q + (around + on) * L;
  } else {
    int plane = q * q + 4 * n * L, lines = 2 * n * q + 8 * n * L;
    cells = (n * n + 4 * n * L) * across;
    vertices = plane * (across + 1), edges = lines * (across + 1) + plane * across;
  }
  ct_mesh *m = mesh_form(kind, f, L, n, across);
  tap_ok(m->element_count == cells && m->node_count == vertices + (kind == CT_HEX20 ? edges : 0),
         "%s of %s, %d layers, %d: %d elements, %d nodes", f->name, KIND[kind], L, 4 * n,
         (int)m->element_count, (int)m->node_count);
}

typedef struct side {
  int32_t sorted[4], nodes[8];
} side;

static int compare_sides(const void *a, const void *b)
{
  return memcmp(((const side *)a)->sorted, ((const side *)b)->sorted, sizeof((side *)0)->sorted);
}

static int compare_numbers(const void *a, const void *b)
{
  return *(const int32_t *)a - *(const int32_t *)b;
}

/* Sides of all elements, by their corners; the lists of corners are written here by hand from VTK's
 * numbers. */
static side *all_sides(const ct_mesh *m)
{
  static const int LIST[6][8] = {{0, 4, 7, 3, 16, 15, 19, 11}, {1, 2, 6, 5, 9, 18, 13, 17},
                                 {0, 1, 5, 4, 8, 17, 12, 16},  {3, 7, 6, 2, 19, 14, 18, 10},
                                 {0, 3, 2, 1, 11, 10, 9, 8},   {4, 5, 6, 7, 12, 13, 14, 15}};
  int per = ct_brick_node_count(m->kind), width = per == 20 ? 8 : 4;
  side *sides = room(6 * m->element_count, sizeof *sides);
  for (int e = 0; e < m->element_count; e++)
    for (int s = 0; s < 6; s++) {
      side *to = &sides[6 * e + s];
      for (int a = 0; a < width; a++) to->nodes[a] = m->elements[per * e + LIST[s][a]];
      memcpy(to->sorted, to->nodes, sizeof to->sorted);
      qsort(to->sorted, 4, sizeof *to->sorted, compare_numbers);
    }
  qsort(sides, (size_t)(6 * m->element_count), sizeof *sides, compare_sides);
  return sides;
}

/* Distance from the centre, or for a cylinder from its axis. */
static double distance(const form *f, const double *x)
{
  return sqrt(x[0] * x[0] + x[1] * x[1] + (f->axes == 3 ? x[2] * x[2] : 0.0));
}

/* Each side belongs to one element on the surface, and inside to two, which share its mid-side
 * nodes; all nodes of the surface are on the spheres or in the flat ends. No two nodes are at the
 * same place, every node is used. */
static void conforming(ct_brick_kind kind, const form *f, int L, int n, int across)
{
  ct_mesh *m = mesh_form(kind, f, L, n, across);
  side *sides = all_sides(m);
  int width = kind == CT_HEX20 ? 8 : 4, per = ct_brick_node_count(kind), many = 0, unlike = 0,
      outer = 0, off = 0, unused = 0, count = 6 * m->element_count,
      *used = room(m->node_count, sizeof *used);
  double error = 0.0;
  for (int i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && compare_sides(&sides[i], &sides[next]) == 0;) next++;
    many += next - i > 2;
    for (int a = 4; a < width && next - i == 2; a++) {
      int shared = 0;
      for (int b = 4; b < width; b++) shared += sides[i].nodes[a] == sides[i + 1].nodes[b];
      unlike += shared != 1;
    }
    if (next - i > 1) continue;
    outer++;
    int flat = f->axes == 2, in = f->radius[0] > 0.0;
    for (int a = 0; a < width; a++)
      flat = flat && fabs(m->nodes[3 * sides[i].nodes[a] + 2]) == f->width / 2;
    for (int a = 0; a < width; a++)
      in = in && distance(f, &m->nodes[3 * sides[i].nodes[a]]) < 1.01 * f->radius[0];
    for (int a = 0; a < width && !flat; a++) {
      double r = distance(f, &m->nodes[3 * sides[i].nodes[a]]) / f->radius[!in] - 1.0;
      error = worst(error, r);
      off += fabs(r) > 4e-16;
    }
  }
  for (int i = 0; i < per * m->element_count; i++) used[m->elements[i]]++;
  for (int i = 0; i < m->node_count; i++) unused += used[i] == 0;
  int ends = f->axes == 2 ? 2 * (n * n + 4 * n * L) + 4 * n * across
                          : 6 * n * n * (f->radius[0] > 0.0 ? 2 : 1);
  tap_ok(many == 0 && unlike == 0 && unused == 0,
         "%s of %s: sides belong to one or two elements (%d to more), which share mid-side nodes "
         "(%d do not); %d nodes are unused",
         f->name, KIND[kind], many, unlike, unused);
  tap_ok(outer == ends && off == 0, "%s of %s: %d outer sides, whose nodes are on it, off by %.2g",
         f->name, KIND[kind], outer, error);
}

/* The nodes are the same set, bit by bit, under all permutations and signs of the axes; of those of
 * a cylinder z stays (eq:mesh-blocks). */
static int compare_points(const void *a, const void *b)
{
  const double *x = a, *y = b;
  for (int d = 0; d < 3; d++)
    if (x[d] != y[d]) return x[d] < y[d] ? -1 : 1;
  return 0;
}

static void symmetric(ct_brick_kind kind, const form *f, int L, int n)
{
  static const int axes[6][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
  ct_mesh *m = mesh_form(kind, f, L, n, 3);
  size_t count = (size_t)m->node_count, size = 3 * sizeof(double);
  double *set = room(m->node_count, size), *image = room(m->node_count, size);
  memcpy(set, m->nodes, count * size);
  qsort(set, count, size, compare_points);
  int faults = 0, twins = 0;
  for (size_t i = 1; i < count; i++) twins += compare_points(&set[3 * i - 3], &set[3 * i]) == 0;
  for (int k = 0; k < (f->axes == 3 ? 48 : 16); k++) {
    for (size_t i = 0; i < count; i++)
      for (int d = 0; d < 3; d++)
        image[3 * i + (size_t)d] =
            (k >> d & 1 ? -1.0 : 1.0) * m->nodes[3 * i + (size_t)axes[k / 8][d]];
    qsort(image, count, size, compare_points);
    for (size_t i = 0; i < 3 * count; i++) faults += set[i] != image[i];
  }
  tap_ok(faults == 0 && twins == 0,
         "%s of %s, %d around: mirrored and turned nodes are the same, bit by bit (%d are not)",
         f->name, KIND[kind], 4 * n, faults);
}

/* Least det J of all elements on a lattice of points, over that at the element's centre. */
static double least_determinant(const ct_mesh *m)
{
  static const double centre[3] = {0, 0, 0};
  double least = INFINITY, J[3][3], x[60];
  for (int e = 0; e < m->element_count; e++) {
    take_element(m, e, m->nodes, x);
    double middle = brick_determinant(m->kind, (double (*)[3])x, centre, J);
    least = middle > 0.0 ? least : -INFINITY;
    for (int p = 0; p < 125; p++) {
      double xi[3] = {p % 5 / 2.0 - 1.0, p / 5 % 5 / 2.0 - 1.0, p / 25 / 2.0 - 1.0};
      least = fmin(least, brick_determinant(m->kind, (double (*)[3])x, xi, J) / middle);
    }
  }
  return least;
}

/* Volume and curved area by an own quadrature of the faces: 1/3 of the integral of x · n, and that
 * of |n|. Five Gauss points along each axis. */
static void volume_and_area(const ct_mesh *m, double *volume, double *area)
{
  static const double X[5] = {-0.90617984593866399280, -0.53846931010568309104, 0.0,
                              0.53846931010568309104, 0.90617984593866399280},
                      W[5] = {0.23692688505618908751, 0.47862867049936646804,
                              0.56888888888888888889, 0.47862867049936646804,
                              0.23692688505618908751};
  side *sides = all_sides(m);
  int width = m->kind == CT_HEX20 ? 8 : 4, count = 6 * m->element_count;
  ct_face_kind kind = ct_brick_face_kind(m->kind);
  *volume = *area = 0.0;
  for (int i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && compare_sides(&sides[i], &sides[next]) == 0;) next++;
    if (next - i > 1) continue;
    for (int q = 0; q < 25; q++) {
      double N[8], S[8], T[8], x[3] = {0}, t[2][3] = {{0}}, n[3], h = 1e-3, dot = 0, square = 0;
      // Differences of quadratic functions are their slopes.
      double at[2] = {X[q % 5], X[q / 5]};
      ct_segment_shape(kind, at, N);
      for (int k = 0; k < 2; k++) {
        double a[2] = {at[0] + (k == 0) * h, at[1] + (k == 1) * h},
               b[2] = {at[0] - (k == 0) * h, at[1] - (k == 1) * h};
        ct_segment_shape(kind, a, S);
        ct_segment_shape(kind, b, T);
        for (int v = 0; v < width; v++)
          for (int d = 0; d < 3; d++)
            t[k][d] += (S[v] - T[v]) / (2 * h) * m->nodes[3 * sides[i].nodes[v] + d];
      }
      for (int v = 0; v < width; v++)
        for (int d = 0; d < 3; d++) x[d] += N[v] * m->nodes[3 * sides[i].nodes[v] + d];
      for (int d = 0; d < 3; d++) {
        n[d] = t[0][(d + 1) % 3] * t[1][(d + 2) % 3] - t[0][(d + 2) % 3] * t[1][(d + 1) % 3];
        dot += x[d] * n[d], square += n[d] * n[d];
      }
      *volume += W[q % 5] * W[q / 5] * dot / 3.0;
      *area += W[q % 5] * W[q / 5] * sqrt(square);
    }
  }
}

/* Volume and area converge to those of the sphere or circle with the square of the size of the
 * elements for hex8 and with its fourth power for hex20; all determinants are positive. */
static void converges(ct_brick_kind kind, const form *f)
{
  double a = f->radius[0], b = f->radius[1], off[2][3], least = INFINITY,
         want[2] = {f->axes == 3 ? 4.0 / 3.0 * PI * (b * b * b - a * a * a) : PI * b * b * f->width,
                    f->axes == 3 ? 4.0 * PI * (a * a + b * b) : 2.0 * PI * b * (b + f->width)};
  for (int k = 0; k < 3; k++) {
    int n = 2 << k;
    ct_mesh *m = mesh_form(kind, f, n / 2, n, 2);
    double got[2], sum = 0.0, *mass = numbers(m->node_count);
    volume_and_area(m, &got[0], &got[1]);
    must(ct_mass_lumped, m, 1.0, CT_LUMP_DEFAULT, mass);
    for (int i = 0; i < m->node_count; i++) sum += mass[i];
    tap_close(sum / got[0], 1.0, 1e-8, "%s of %s, %d around: the elements fill the surface",
              f->name, KIND[kind], 4 * n);
    for (int i = 0; i < 2; i++) off[i][k] = fabs(got[i] / want[i] - 1.0);
    least = fmin(least, least_determinant(m));
  }
  double order = kind == CT_HEX8 ? 2.0 : 4.0;
  for (int i = 0; i < 2; i++) {
    double observed = log2(off[i][1] / off[i][2]);
    tap_close(observed, order, 0.2, "%s of %s: order of the %s, whose errors are %.2g, %.2g, %.2g",
              f->name, KIND[kind], i == 0 ? "volume" : "area", off[i][0], off[i][1], off[i][2]);
  }
  tap_ok(least > 0.1, "%s of %s: det J is at least %.3f of that at the centre", f->name, KIND[kind],
         least);
}

static double volume_of(ct_brick_kind kind, const form *f, int n)
{
  double volume, area;
  ct_mesh *m = mesh_form(kind, f, 1, n, 1);
  volume_and_area(m, &volume, &area);
  return volume;
}

/* With few cells the surfaces are polyhedra of known volume. */
static void polyhedra(void)
{
  const form ball = {"ball", 3, {0, 1}, 0, {0}}, disc = {"cylinder", 2, {0, 1}, 1, {0}};
  tap_close(volume_of(CT_HEX8, &ball, 1), 8.0 / (3.0 * sqrt(3.0)), 1e-12, "a cube in the sphere");
  // 24 bilinear patches: the mean of both triangulations of (1,0,0), (1,1,0), (1,1,1), (1,0,1),
  // each over its length.
  tap_close(volume_of(CT_HEX8, &ball, 2), 2.0 * (2.0 / sqrt(6.0) + 0.5 + 1.0 / (2.0 * sqrt(3.0))),
            1e-12, "24 faces in the sphere");
  tap_close(volume_of(CT_HEX8, &disc, 1), 2.0, 1e-12, "a square in the circle");
  tap_close(volume_of(CT_HEX8, &disc, 2), 2.0 * sqrt(2.0), 1e-12, "an octagon in the circle");
  tap_close(volume_of(CT_HEX20, &disc, 1), 2.0 + 8.0 / 3.0 * (sqrt(2.0) - 1.0), 1e-12,
            "four parabolas through eight points of the circle");
}

/* The corner of the core is at u = 1, where the other squares sum to 2 or 1 (eq:mesh-blocks). */
static void core_corners(void)
{
  for (int k = 0; k < 3; k += 2) {
    double at = FORMS[k].radius[1] * (k == 0 ? 0.4 : 0.45);
    int found = 0;
    ct_mesh *m = mesh_form(CT_HEX8, &FORMS[k], 2, 3, 1);
    for (int i = 0; i < m->node_count; i++) {
      const double *x = &m->nodes[3 * i];
      found += fabs(fabs(x[0]) - at) < 1e-15 && fabs(fabs(x[1]) - at) < 1e-15 &&
               (k == 2 || fabs(fabs(x[2]) - at) < 1e-15);
    }
    tap_ok(found == 8, "%s: the core has its 8 corners, %d", FORMS[k].name, found);
  }
}

/* Arcs around the equator are equal within 2 % (eq:mesh-spread). */
static void equal_arcs(void)
{
  const form disc = {"cylinder", 2, {0, 1}, 1, {0}};
  ct_mesh *m = mesh_form(CT_HEX8, &disc, 1, 16, 1);
  side *sides = all_sides(m);
  double least = INFINITY, most = 0.0;
  for (int i = 0; i < 6 * m->element_count; i++)
    for (int a = 0; a < 4; a++) {
      const double *x = &m->nodes[3 * sides[i].nodes[a]],
                   *y = &m->nodes[3 * sides[i].nodes[(a + 1) % 4]];
      if (x[2] != y[2] || fabs(hypot(x[0], x[1]) - 1) > 1e-9 || fabs(hypot(y[0], y[1]) - 1) > 1e-9)
        continue;
      double arc = fabs(remainder(atan2(y[1], y[0]) - atan2(x[1], x[0]), 2.0 * PI));
      least = fmin(least, arc), most = fmax(most, arc);
    }
  tap_ok(least > 0.98 * PI / 32 && most < 1.02 * PI / 32, "arcs are %.4f to %.4f of equal ones",
         least * 32 / PI, most * 32 / PI);
}

/* A centre moves all nodes, and a radius scales them. */
static void moved(ct_brick_kind kind)
{
  for (int k = 0; k < 3; k++) {
    form to = FORMS[k];
    for (int d = 0; d < 3; d++) to.centre[d] = 0.5 * d - 3.0;
    to.radius[0] *= 2.0, to.radius[1] *= 2.0, to.width *= 2.0;
    ct_mesh *a = mesh_form(kind, &FORMS[k], 2, 3, 2), *b = mesh_form(kind, &to, 2, 3, 2);
    double off = 0.0;
    for (int i = 0; i < 3 * a->node_count; i++)
      off = worst(off, b->nodes[i] - (2.0 * a->nodes[i] + to.centre[i % 3]));
    tap_ok(off == 0.0, "%s of %s: moved and twice as large", to.name, KIND[kind]);
  }
}

static void refused(ct_brick_kind kind, form f, int layers, int around, int across,
                    const char *word)
{
  ct_mesh *m = NULL;
  ct_error e = {0};
  tap_ok(create(kind, &f, layers, around, across, &m, &e) == CT_ERROR_ARGUMENT && m == NULL &&
             strstr(e.text, word) != NULL,
         "refused: %s", e.text);
}

int main(void)
{
  free_at_end();
  for (int kind = 0; kind < CT_BRICK_COUNT; kind++) {
    for (int k = 0; k < 3; k++) {
      counts((ct_brick_kind)kind, &FORMS[k], 1, 1, 1);
      counts((ct_brick_kind)kind, &FORMS[k], 3, 4, 5);
      conforming((ct_brick_kind)kind, &FORMS[k], 1, 1, 1);
      conforming((ct_brick_kind)kind, &FORMS[k], 3, 5, 2);
      symmetric((ct_brick_kind)kind, &FORMS[k], 3, 5);
      symmetric((ct_brick_kind)kind, &FORMS[k], 2, 6);
      converges((ct_brick_kind)kind, &FORMS[k]);
    }
    moved((ct_brick_kind)kind);
  }
  polyhedra();
  core_corners();
  equal_arcs();
  for (int k = 0; k < 3; k++) {
    form f = FORMS[k];
    refused((ct_brick_kind)5, f, 1, 4, 1, "kind 5");
    refused(CT_HEX8, f, 0, 4, 1, "radius must be 1 to");
    refused(CT_HEX8, f, 1, 6, 1, "multiple of 4");
    refused(CT_HEX8, f, 1, 0, 1, "multiple of 4");
    refused(CT_HEX8, f, 1000000, 1000000, 1, "too large");
    f.centre[1] = NAN;
    refused(CT_HEX8, f, 1, 4, 1, "centre y");
    f = FORMS[k], f.radius[1] = f.radius[0];
    refused(CT_HEX8, f, 1, 4, 1, "outer radius");
    f.radius[1] = INFINITY;
    refused(CT_HEX8, f, 1, 4, 1, "outer radius");
  }
  form f = FORMS[2];
  refused(CT_HEX8, f, 1, 4, 0, "across");
  f.width = 0.0;
  refused(CT_HEX8, f, 1, 4, 1, "width");
  f = FORMS[1], f.radius[0] = -0.5;
  refused(CT_HEX8, f, 1, 4, 1, "radius");
  ct_mesh *m = NULL;
  tap_ok(ct_mesh_create_ball(CT_HEX8, NULL, &m, NULL) == CT_ERROR_ARGUMENT &&
             ct_mesh_create_cylinder(CT_HEX8, NULL, &m, NULL) == CT_ERROR_ARGUMENT,
         "a null shape is refused");
  return tap_done();
}
