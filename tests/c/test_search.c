/* The search: its tree of boxes, its boxes of faces, its nearest faces, compared with brute force
 * and with closed forms. */
#include "../../libcontact/src/search/nearest.c"
#include "../../libcontact/src/search/normal.c"
#include "bodies.h"

/* -- The tree
 * ----------------------------------------------------------------------------------------------------------
 */

static ct_bounds random_box(double spread, double size, int lattice)
{
  ct_bounds box;
  for (int c = 0; c < 3; c++) {
    double at = uniform(spread), width = fabs(uniform(size));
    if (lattice) at = floor(at), width = floor(width + 0.5);
    box.low[c] = at;
    box.high[c] = at + width;
  }
  return box;
}

static int meets(const ct_bounds *a, const ct_bounds *b)
{
  for (int c = 0; c < 3; c++)
    if (a->high[c] < b->low[c] || b->high[c] < a->low[c]) return 0;
  return 1;
}

typedef struct items {
  const ct_bounds *boxes;
  const double *point;
  double *extra; /* additional distance of an item beyond its box */
  int asked;
  int32_t first; /* the nearest, of equals the first */
  double best;
} items;

static double distance(const items *all, int32_t item)
{
  return ct_bounds_distance(&all->boxes[item], all->point) + all->extra[item];
}

static double visit_item(void *user, int32_t item)
{
  items *all = user;
  double d = distance(all, item);
  all->asked++;
  if (d < all->best || (d == all->best && item < all->first)) {
    all->best = d;
    all->first = item;
  }
  return all->best * all->best;
}

/* Query the tree for overlaps and nearest items, and compare with all boxes one by one; prints the
 * name of the case. */
static void against_all(const ct_box_tree *tree, const ct_bounds *boxes, double *extra, int count,
                        double spread, int lattice, const char *what)
{
  int32_t *found = integers(count);
  int wrong = 0, unlike = 0, asked = 0, queries = 300;
  for (int k = 0; k < queries; k++) {
    ct_bounds query = random_box(1.1 * spread, 0.4 * spread, lattice);
    int n = ct_box_tree_overlaps(tree, boxes, &query, found, count), next = 0;
    for (int i = 0; i < count; i++)
      if (meets(&boxes[i], &query)) {
        wrong += next >= n || found[next] != i;
        next++;
      }
    wrong += next != n;

    double point[3] = {uniform(1.2 * spread), uniform(1.2 * spread), uniform(1.2 * spread)};
    for (int c = 0; lattice && c < 3; c++) point[c] = floor(point[c]);
    items all = {boxes, point, extra, 0, -1, INFINITY}, tried = all;
    ct_box_tree_visit(tree, point, INFINITY, visit_item, NULL, &tried);
    asked += tried.asked;
    for (int i = 0; i < count; i++) visit_item(&all, i);
    unlike += tried.first != all.first || tried.best != all.best;
  }
  tap_ok(wrong == 0, "%s: overlaps are those of brute force over all %d boxes, ascending", what,
         count);
  tap_ok(unlike == 0,
         "%s: the nearest is the nearest of all, the first of equals (%.1f of %d examined)", what,
         (double)asked / queries, count);
}

static void random_boxes(int count, int lattice, const char *what)
{
  ct_bounds *boxes = room(count, sizeof *boxes);
  double *extra = numbers(count);
  ct_box_tree *tree = NULL;
  char name[100];
  must(ct_box_tree_create, count, &tree);
  for (int i = 0; i < count; i++) {
    boxes[i] = random_box(50.0, 4.0, lattice);
    extra[i] = lattice ? 0.0 : fabs(uniform(1.0));
  }
  ct_box_tree_build(tree, boxes);
  against_all(tree, boxes, extra, count, 50.0, lattice, what);

  // Boxes that move slightly, are enlarged, shrink: the tree follows.
  static const struct {
    const char *name;
    double scale;
  } MOVE[] = {{"moved", 1.0}, {"1e6 times as large", 1e6}, {"1e-9 times as large", 1e-9}};
  for (int m = 0; m < 3; m++) {
    ct_bounds *moved = room(count, sizeof *moved);
    for (int i = 0; i < count; i++)
      for (int c = 0; c < 3; c++) {
        double u = lattice ? 0.0 : uniform(0.5);
        moved[i].low[c] = MOVE[m].scale * (boxes[i].low[c] + u);
        moved[i].high[c] = MOVE[m].scale * (boxes[i].high[c] + u);
      }
    ct_box_tree_refit(tree, moved);
    snprintf(name, sizeof name, "%s, %s", what, MOVE[m].name);
    against_all(tree, moved, extra, count, 50.0 * MOVE[m].scale, lattice && MOVE[m].scale >= 1.0,
                name);
  }
  ct_box_tree_free(tree);
}

/* Few boxes, equal boxes, and distances from a box (eq:box-distance). */
static void special_boxes(void)
{
  ct_bounds one = {{0, 0, 0}, {1, 1, 1}}, touching = {{1, 1, 1}, {2, 2, 2}},
            apart = {{1.0000001, 0, 0}, {2, 1, 1}};
  double point[3] = {3, 0.5, 0.5}, zero[8] = {0};
  int32_t found[8];
  ct_box_tree *tree = NULL;
  must(ct_box_tree_create, 1, &tree);
  ct_box_tree_build(tree, &one);
  items all = {&one, point, zero, 0, -1, INFINITY};
  tap_ok(ct_box_tree_overlaps(tree, &one, &touching, found, 8) == 1 && found[0] == 0,
         "boxes that touch overlap");
  tap_ok(ct_box_tree_overlaps(tree, &one, &apart, found, 8) == 0,
         "boxes apart do not, by a ten-millionth");
  ct_box_tree_visit(tree, point, INFINITY, visit_item, NULL, &all);
  tap_ok(all.first == 0 && all.best == 2.0, "a tree of one item: distance 2");
  ct_box_tree_free(tree);

  ct_bounds same[8];
  for (int i = 0; i < 8; i++) same[i] = one;
  must(ct_box_tree_create, 8, &tree);
  ct_box_tree_build(tree, same);
  all = (items){same, point, zero, 0, -1, INFINITY};
  ct_box_tree_visit(tree, point, INFINITY, visit_item, NULL, &all);
  tap_ok(all.first == 0 && all.asked == 8,
         "of eight equal items all are examined and the first is returned");
  found[3] = 77;
  tap_ok(ct_box_tree_overlaps(tree, same, &one, found, 3) == 8 && found[3] == 77,
         "with a capacity of three, eight are counted and three written");
  ct_box_tree_free(tree);

  must(ct_box_tree_create, 0, &tree);
  ct_box_tree_build(tree, &one);
  all.asked = 0;
  ct_box_tree_visit(tree, point, INFINITY, visit_item, NULL, &all);
  tap_ok(ct_box_tree_overlaps(tree, &one, &one, found, 8) == 0 && all.asked == 0,
         "an empty tree finds nothing");
  ct_box_tree_free(tree);
  ct_box_tree_free(NULL);

  ct_bounds box = {{-1, -2, -3}, {1, 2, 3}};
  double inside[3] = {0.5, 1, -2}, corner[3] = {4, 6, 3 + 12}, face[3] = {0, -7, 0};
  tap_ok(ct_bounds_distance(&box, inside) == 0 && ct_bounds_distance(&box, corner) == 13 &&
             ct_bounds_distance(&box, face) == 5,
         "distance from a box: 0 inside, 13 = |(3, 4, 12)| off a corner, 5 off a face");
}

/* -- Boxes of curved faces
 * ---------------------------------------------------------------------------------------------- */

static void random_face(ct_face *face, ct_face_kind kind, double bend)
{
  static const double corner[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                      {0, -1},  {1, 0},  {0, 1}, {-1, 0}};
  static const double triangle[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  double axes[2][3] = {{1, uniform(0.5), uniform(0.5)}, {uniform(0.5), 1, uniform(0.5)}};
  face->kind = kind;
  for (int a = 0; a < ct_face_node_count(kind); a++)
    for (int c = 0; c < 3; c++) {
      const double *at = kind == CT_T3 || kind == CT_T6 ? triangle[a] : corner[a];
      face->node[a][c] = at[0] * axes[0][c] + at[1] * axes[1][c] + uniform(bend);
    }
}

static const struct {
  ct_face_kind kind;
  const char *name;
} KIND[] = {{CT_Q4, "Q4"}, {CT_Q8, "Q8"}, {CT_T3, "T3"}, {CT_T6, "T6"}};

/* The boxes of bent faces contain their points (eq:face-bounds, eq:oriented-box); ratio of the box
 * along the axes to the points' own box. */
static void face_boxes(int k)
{
  int out = 0, far = 0, wide = 0;
  double excess = 0.0;
  for (int trial = 0; trial < 300; trial++) {
    ct_face face;
    random_face(&face, KIND[k].kind, 0.4);
    ct_bounds box = ct_face_bounds(&face),
              seen = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    ct_oriented oriented;
    ct_oriented_init(&oriented, &face);
    double query[3] = {uniform(3.0), uniform(3.0), uniform(3.0)}, nearest = HUGE_VAL;
    for (int i = 0; i <= 20; i++)
      for (int j = 0; j <= 20; j++) {
        double xi[2] = {0.1 * i - 1.0, 0.1 * j - 1.0}, y[3], square = 0.0;
        if (KIND[k].kind == CT_T3 || KIND[k].kind == CT_T6)
          xi[0] = 0.05 * i, xi[1] = 0.05 * j * (1.0 - xi[0]);
        ct_segment_point(&face, xi, y);
        if (ct_oriented_square(&oriented, y) > 0.0) far++;
        for (int c = 0; c < 3; c++) {
          if (y[c] < box.low[c] - 1e-15 || y[c] > box.high[c] + 1e-15) out++;
          seen.low[c] = fmin(seen.low[c], y[c]);
          seen.high[c] = fmax(seen.high[c], y[c]);
          square += (y[c] - query[c]) * (y[c] - query[c]);
        }
        nearest = fmin(nearest, square);
      }
    if (ct_oriented_square(&oriented, query) > nearest) wide++;
    for (int c = 0; c < 3; c++)
      excess = fmax(excess, (box.high[c] - box.low[c]) / (seen.high[c] - seen.low[c]));
  }
  tap_ok(out == 0,
         "%s: the box of the control points contains 441 points of each of 300 bent faces (at most "
         "%.2f times as wide as they)",
         KIND[k].name, excess);
  tap_ok(far == 0 && wide == 0,
         "%s: the box along the face contains them too, and is never farther from a point than "
         "they are",
         KIND[k].name);
}

/* No place of a bent face is nearer than a distance beyond which it is said to be, and of the faces
 * that are farther by a tenth most are found to be (eq:hull-bound, with the directions of
 * eq:hull-step); `k` is a quadrilateral. */
static void beyond(int k)
{
  int wrong = 0, found = 0, trials = 1000;
  for (int trial = 0; trial < trials; trial++) {
    ct_face face;
    const double y[3] = {uniform(3.0), uniform(3.0), uniform(3.0)};
    double nearest = HUGE_VAL;
    random_face(&face, KIND[k].kind, 0.2);
    for (int i = 0; i < 441; i++) {
      double x[3], d[3];
      ct_segment_point(&face, (double[2]){0.1 * (i % 21) - 1.0, 0.1 * (i / 21) - 1.0}, x);
      for (int c = 0; c < 3; c++) d[c] = x[c] - y[c];
      nearest = fmin(nearest, sqrt(ct_vector_dot(d, d)));
    }
    wrong += ct_face_is_beyond(&face, y, nearest);
    found += ct_face_is_beyond(&face, y, 0.9 * nearest);
  }
  tap_ok(wrong == 0 && found > 0.8 * trials, "%s: %d of %d bent faces are beyond, %d are not",
         KIND[k].name, found, trials, wrong);
}

/* Control points (eq:control-points). A parabola through (-1, 0), (0, 1), (1, 0) has its own at 2:
 * the box is known. */
static void parabola(void)
{
  ct_face face = {CT_Q8,
                  {{-1, -1, 0},
                   {1, -1, 0},
                   {1, 1, 0},
                   {-1, 1, 0},
                   {0, -1, 1},
                   {1, 0, 0},
                   {0, 1, 1},
                   {-1, 0, 0}}};
  ct_bounds box = ct_face_bounds(&face);
  tap_close(box.high[2], 2.0, 1e-14,
            "a vault of height 1 is boxed to its control points, at height 2");
  tap_close(box.low[2], 0.0, 1e-14, "and to its closest points");
  tap_close(box.high[0], 1.0, 1e-14, "and not wider than its corners");

  // z = 3 - x^2 - y^2 has the coefficient 3 + 1 + 1 in the middle.
  ct_face dome = {CT_Q8,
                  {{-1, -1, 1},
                   {1, -1, 1},
                   {1, 1, 1},
                   {-1, 1, 1},
                   {0, -1, 2},
                   {1, 0, 2},
                   {0, 1, 2},
                   {-1, 0, 2}}};
  box = ct_face_bounds(&dome);
  tap_close(box.high[2], 5.0, 1e-13, "a dome is boxed to the control point in its middle");
  tap_close(box.low[2], 1.0, 1e-13, "and to its corners");
}

/* -- Nearest faces
 * -------------------------------------------------------------------------------------------------------
 */

/* A grid of n x n cells over [-1, 1]^2, lifted by a wave, of any kind of face. */
typedef struct patchwork {
  ct_surface surface;
  double *x;
  int32_t *faces;
} patchwork;

static void patchwork_make(patchwork *p, ct_face_kind kind, int n, double wave)
{
  static const int Q[8][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}};
  static const int T[2][6][2] = {{{0, 0}, {2, 0}, {2, 2}, {1, 0}, {2, 1}, {1, 1}},
                                 {{0, 0}, {2, 2}, {0, 2}, {1, 1}, {1, 2}, {0, 1}}};
  int m = 2 * n + 1, per = ct_face_node_count(kind), triangular = kind == CT_T3 || kind == CT_T6,
      count = (triangular ? 2 : 1) * n * n, f = 0;
  p->x = numbers(3 * m * m);
  p->faces = integers(count * per);
  for (int i = 0; i < m; i++)
    for (int j = 0; j < m; j++) {
      double *x = &p->x[3 * (i * m + j)];
      x[0] = (double)i / n - 1.0;
      x[1] = (double)j / n - 1.0;
      x[2] = wave * sin(3.0 * x[0]) * cos(2.0 * x[1]);
    }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      for (int t = 0; t < (triangular ? 2 : 1); t++, f++)
        for (int a = 0; a < per; a++) {
          const int *at = triangular ? T[t][a] : Q[a];
          p->faces[f * per + a] = (2 * i + at[0]) * m + 2 * j + at[1];
        }
  p->surface = (ct_surface){kind, m * m, count, p->faces, p->x};
}

LATER(search)

static ct_search *search_of(const ct_surface *surface)
{
  ct_search *search = NULL;
  must(ct_search_create, surface, &search);
  return later_search(search);
}

/* Nearest distance by projecting on every face. */
static double by_all(const ct_surface *s, const double *x, const double point[3])
{
  double best = INFINITY;
  int per = ct_face_node_count(s->kind);
  for (int f = 0; f < s->face_count; f++) {
    ct_face face = {.kind = s->kind};
    ct_projection closest;
    for (int a = 0; a < per; a++)
      memcpy(face.node[a], &x[3 * s->faces[f * per + a]], sizeof face.node[a]);
    ct_project(&face, point, NULL, &closest, NULL);
    if (closest.distance < best) best = closest.distance;
  }
  return best;
}

static int same_bits(const ct_nearest *a, const ct_nearest *b, int count)
{
  int same = 1;
  for (int i = 0; i < count; i++)
    same &=
        a[i].status == b[i].status && a[i].face == b[i].face && a[i].where == b[i].where &&
        a[i].index == b[i].index && memcmp(a[i].xi, b[i].xi, sizeof a[i].xi) == 0 &&
        memcmp(a[i].point, b[i].point, sizeof a[i].point) == 0 &&
        memcmp(&a[i].distance, &b[i].distance, sizeof a[i].distance) == 0 &&
        memcmp(&a[i].signed_distance, &b[i].signed_distance, sizeof a[i].signed_distance) == 0 &&
        memcmp(a[i].normal, b[i].normal, sizeof a[i].normal) == 0;
  return same;
}

enum { CLOUD = 3000 };

/* Where a search starts from the last closest point it looks no farther than there (eq:warm-bound).
 */
static void last_point(void)
{
  const ct_nearest last = {.face = 3, .point = {2.0, -1.0, 5.0}}, none = {.face = -1};
  const double point[3] = {4.0, 2.0, -1.0};
  tap_close(bound_from(point, &last), 4.0 + 9.0 + 36.0, 1e-11, "no farther than the last point");
  tap_ok(bound_from(point, &none) == HUGE_VAL, "without one it looks anywhere");
}

/* Nearest faces compared with brute force, for any start of the search (eq:warm-bound). */
static void nearest_faces(int k)
{
  patchwork p;
  patchwork_make(&p, KIND[k].kind, 7, 0.3);
  ct_search *search = search_of(&p.surface);
  double *points = numbers(3 * CLOUD), off = 0.0, closest = 0.0;
  ct_nearest *out = room(CLOUD, sizeof *out), *again = room(CLOUD, sizeof *again);
  int32_t *start = integers(CLOUD);
  for (int i = 0; i < CLOUD; i++)
    for (int c = 0; c < 3; c++) points[3 * i + c] = uniform(c == 2 ? 0.6 : 1.3);
  // Some points exactly on nodes and on edges, where faces tie.
  for (int i = 0; i < 100; i++) memcpy(&points[3 * i], &p.x[3 * p.faces[i]], 3 * sizeof *points);
  tap_ok(ct_search_nearest(search, CLOUD, points, NULL, NULL, out, NULL) == CT_OK,
         "%s: a cloud of %d points", KIND[k].name, CLOUD);
  for (int i = 0; i < CLOUD; i++) {
    ct_face face;
    double y[3];
    off = worst(off, out[i].distance - by_all(&p.surface, p.x, &points[3 * i]));
    if (out[i].face < 0) continue;
    ct_search_face(search, out[i].face, &face);
    ct_segment_point(&face, out[i].xi, y);
    for (int c = 0; c < 3; c++) closest = fmax(closest, fabs(y[c] - out[i].point[c]));
    start[i] = i % 3 == 0 ? -1 : (i * 37) % p.surface.face_count;
  }
  tap_close(off, 0.0, 1e-14, "%s: the distance is that of the nearest of all faces", KIND[k].name);
  tap_close(closest, 0.0, 1e-14, "%s: the closest point is the point of that face at xi",
            KIND[k].name);

  ct_search_options options = ct_search_options_default();
  ct_search_nearest(search, CLOUD, points, start, &options, again, NULL);
  tap_ok(same_bits(out, again, CLOUD), "%s: other starts, the same bits", KIND[k].name);
  options.threads = 3;
  ct_search_nearest(search, CLOUD, points, NULL, &options, again, NULL);
  tap_ok(same_bits(out, again, CLOUD), "%s: three threads, the same bits", KIND[k].name);
  double *moved = numbers(3 * p.surface.node_count);
  for (int i = 0; i < 3 * p.surface.node_count; i++) moved[i] = p.x[i] + uniform(1.0);
  must(ct_search_move, search, moved);
  must(ct_search_move, search, p.x);
  ct_search_nearest(search, CLOUD, points, NULL, NULL, again, NULL);
  tap_ok(ct_search_builds(search) > 1 && same_bits(out, again, CLOUD),
         "%s: after a large deformation and back (%d builds), the same bits", KIND[k].name,
         (int)ct_search_builds(search));
}

/* Triangles whose distance and sign are known: the unit cube. */
static const double CUBE[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int32_t CUBE_Q[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

/* eq:pseudo-normal. */
static void cube(ct_face_kind kind)
{
  int32_t faces[12][3];
  double off = 0.0, normal = 0.0;
  for (int f = 0; f < 6; f++) {
    const int32_t *q = CUBE_Q[f], split[2][3] = {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}};
    memcpy(faces[2 * f], split, sizeof split);
  }
  ct_surface surface = {kind, 8, kind == CT_T3 ? 12 : 6, kind == CT_T3 ? faces[0] : CUBE_Q[0],
                        CUBE[0]};
  ct_search *search = search_of(&surface);
  int signs = 0, found[3] = {0};
  for (int i = 0; i < 4000; i++) {
    // -- Outside: distance from the cube. Inside: the nearest of six planes.
    double point[3], outside = 0.0, inside = HUGE_VAL;
    for (int c = 0; c < 3; c++) {
      point[c] = 0.5 + uniform(i % 2 == 0 ? 0.5 : 1.5);
      double beyond = fmax(fmax(-point[c], point[c] - 1.0), 0.0);
      outside += beyond * beyond;
      inside = fmin(inside, fmin(point[c], 1.0 - point[c]));
    }
    double want = outside > 0.0 ? sqrt(outside) : -inside;
    ct_nearest got;
    ct_search_nearest(search, 1, point, NULL, NULL, &got, NULL);
    off = worst(off, got.signed_distance - want);
    signs += (got.signed_distance > 0.0) != (want > 0.0);
    if (got.where != CT_OUTSIDE) found[got.where]++;
    double length = sqrt(got.normal[0] * got.normal[0] + got.normal[1] * got.normal[1] +
                         got.normal[2] * got.normal[2]);
    normal = fmax(normal, fabs(length - 1.0));
  }
  const char *name = kind == CT_T3 ? "of triangles" : "of Q4 faces";
  tap_close(off, 0.0, 1e-14,
            "a cube %s: signed distances in closed form (%d closest points inside faces, %d on "
            "edges, %d on "
            "corners)",
            name, found[0], found[1], found[2]);
  tap_ok(signs == 0 && found[1] > 500 && found[2] > 500, "a cube %s: no sign is wrong at its folds",
         name);
  tap_close(normal, 0.0, 1e-14, "a cube %s: normals are unit vectors", name);

  double off_corner[3] = {2, 2, 2}, off_edge[3] = {0.5, 2, 2};
  ct_nearest a, b;
  ct_search_nearest(search, 1, off_corner, NULL, NULL, &a, NULL);
  ct_search_nearest(search, 1, off_edge, NULL, NULL, &b, NULL);
  // A corner weighs each side of the cube by a right angle, however its triangles cut it.
  for (int c = 0; c < 3; c++)
    tap_close(a.normal[c], 1.0 / sqrt(3.0), 1e-14, "a cube %s: the normal at the corner, %c", name,
              "xyz"[c]);
  tap_ok(b.normal[0] == 0.0 && fabs(b.normal[1] - sqrt(0.5)) < 1e-15 && b.where == CT_EDGE,
         "a cube %s: the normal at an edge", name);
}

/* The classic trap of signs: a spike, where the face found first points away from the point. */
static void spike(void)
{
  const double x[5][3] = {
      {0, 0, 1}, {0.05, 0.05, 0}, {-0.05, 0.05, 0}, {-0.05, -0.05, 0}, {0.05, -0.05, 0}};
  const int32_t faces[6][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 3, 2}, {1, 4, 3}};
  ct_surface surface = {CT_T3, 5, 6, faces[0], x[0]};
  ct_search *search = search_of(&surface);
  int wrong = 0;
  for (int i = 0; i < 500; i++) {
    double point[3] = {uniform(0.01), uniform(0.01), 1.0 + fabs(uniform(0.5)) + 0.02};
    ct_nearest got;
    ct_search_nearest(search, 1, point, NULL, NULL, &got, NULL);
    wrong += !(got.signed_distance > 0.0) || got.where != CT_VERTEX;
  }
  tap_ok(wrong == 0, "points above the tip of a needle are outside, whichever face is found");
}

/* The skin of a brick of 20 nodes, as 6 Q8 faces or as 12 T6 faces with one further node in the
 * middle of each side. */
typedef struct skin {
  double x[26][3];
  int32_t faces[72];
  ct_surface surface;
} skin;

static void skin_make(skin *s, ct_face_kind kind, double corners, double middles)
{
  static const int T[2][6] = {{0, 1, 2, 4, 5, 8}, {0, 2, 3, 8, 6, 7}};
  int next = 0, triangular = kind == CT_T6;
  for (int a = 0; a < 20; a++) {
    ct_brick_reference(CT_HEX20, a, s->x[a]);
    for (int c = 0; c < 3; c++) s->x[a][c] += uniform(a < 8 ? corners : middles);
  }
  for (int side = 0; side < 6; side++) {
    int node[9];
    ct_face face = {.kind = CT_Q8};
    ct_brick_face(CT_HEX20, side, node);
    node[8] = 20 + side;
    for (int a = 0; a < 8; a++) memcpy(face.node[a], s->x[node[a]], sizeof face.node[a]);
    ct_segment_point(&face, (double[2]){0.0, 0.0}, s->x[node[8]]);
    for (int t = 0; t < (triangular ? 2 : 1); t++)
      for (int a = 0; a < (triangular ? 6 : 8); a++)
        s->faces[next++] = node[triangular ? T[t][a] : a];
  }
  s->surface = (ct_surface){kind, 26, triangular ? 12 : 6, s->faces, s->x[0]};
}

static double dot3(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether the brick is far from inverted everywhere, so that its skin does not cross itself. */
static int is_regular(skin *s)
{
  for (int i = 0; i < 125; i++) {
    double xi[3] = {0.5 * (i % 5) - 1.0, 0.5 * (i / 5 % 5) - 1.0, 0.5 * (i / 25) - 1.0}, J[3][3],
           lengths = 1.0;
    double det = brick_determinant(CT_HEX20, s->x, xi, J);
    for (int d = 0; d < 3; d++)
      lengths *= sqrt(J[d][0] * J[d][0] + J[d][1] * J[d][1] + J[d][2] * J[d][2]);
    if (!(det > 0.15 * lengths)) return 0;
  }
  // Two triangles of one side must not be folded onto each other.
  for (int f = 0; s->surface.kind == CT_T6 && f < 12; f += 2)
    for (int i = 0; i <= 8; i++) {
      double n[2][3], xi[2][2] = {{0.0, i / 8.0}, {i / 8.0, 0.0}};
      for (int t = 0; t < 2; t++) {
        ct_face face = {.kind = CT_T6};
        for (int a = 0; a < 6; a++)
          memcpy(face.node[a], s->x[s->faces[6 * (f + t) + a]], sizeof face.node[a]);
        if (ct_segment_normal(&face, xi[t], n[t]) != CT_OK) return 0;
      }
      if (!(dot3(n[0], n[1]) > 0.0)) return 0;
    }
  return 1;
}

/* Solid angle of a triangle seen from the origin. */
static double solid_angle(const double a[3], const double b[3], const double c[3])
{
  double u = sqrt(dot3(a, a)), v = sqrt(dot3(b, b)), w = sqrt(dot3(c, c));
  double volume = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]);
  return 2.0 * atan2(volume, u * v * w + dot3(a, b) * w + dot3(b, c) * u + dot3(c, a) * v);
}

/* How often a surface, cut into small triangles, winds around a point: 1 inside, 0 outside. */
static double winding(const ct_surface *s, const double point[3])
{
  enum { CUTS = 24 };
  double angle = 0.0;
  for (int f = 0; f < s->face_count; f++) {
    static double y[CUTS + 1][CUTS + 1][3];
    int per = ct_face_node_count(s->kind), triangular = s->kind == CT_T6;
    ct_face face = {.kind = s->kind};
    for (int a = 0; a < per; a++)
      for (int c = 0; c < 3; c++)
        face.node[a][c] = s->reference[3 * s->faces[f * per + a] + c] - point[c];
    for (int i = 0; i <= CUTS; i++)
      for (int j = 0; j <= CUTS - (triangular ? i : 0); j++) {
        double u = (double)i / CUTS, v = (double)j / CUTS,
               xi[2] = {triangular ? u : 2.0 * u - 1.0, triangular ? v : 2.0 * v - 1.0};
        ct_segment_point(&face, xi, y[i][j]);
      }
    for (int i = 0; i < CUTS; i++)
      for (int j = 0; j < CUTS - (triangular ? i : 0); j++) {
        angle += solid_angle(y[i][j], y[i + 1][j], y[i][j + 1]);
        if (!triangular || i + j + 1 < CUTS)
          angle += solid_angle(y[i + 1][j], y[i + 1][j + 1], y[i][j + 1]);
      }
  }
  return angle / (4.0 * 3.14159265358979323846);
}

/* Closed curved surfaces: near corners the tangents, not the chords, determine the inside.
 * (eq:edge-direction, eq:pseudo-normal) */
static void curved_corners(ct_face_kind kind, double middles)
{
  int wrong = 0, corners = 0, asked = 0;
  for (int trial = 0; trial < 160; trial++) {
    skin s;
    skin_make(&s, kind, 0.1, middles);
    if (!is_regular(&s)) continue;
    ct_search *search = search_of(&s.surface);
    for (int i = 0; i < 12; i++) {
      const double *corner = s.x[pick(8)];
      double point[3], reach = 0.02 + fabs(uniform(0.2));
      ct_nearest got;
      for (int c = 0; c < 3; c++) point[c] = corner[c] + uniform(reach);
      ct_search_nearest(search, 1, point, NULL, NULL, &got, NULL);
      if (got.distance < 4e-3) continue; // the sag of the small triangles
      asked++;
      corners += got.where == CT_VERTEX;
      wrong += (winding(&s.surface, point) > 0.5) != (got.signed_distance < 0.0);
    }
  }
  tap_ok(wrong == 0 && corners > 100,
         "bricks of %s faces with bent edges: %d of %d points near corners have the wrong sign (%d "
         "closest points are corners)",
         kind == CT_Q8 ? "Q8" : "T6", wrong, asked, corners);
}

/* The tangents 4 x_m - 3 x_1 - x_2 of both edges at a corner of a random Q8 (eq:edge-direction). */
static void tangents_at_a_corner(void)
{
  static int32_t nodes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  double x[24], t[2][3], off = 0.0;
  for (int i = 0; i < 24; i++) x[i] = uniform(1.0);
  const ct_search search = {.per = 8, .edges = 4, .faces = nodes, .x = x};
  for (int back = 0; back < 2; back++) {
    edge_direction(&search, 0, 2, back, t[back]);
    for (int c = 0; c < 3; c++)
      off = worst(off, t[back][c] - (4.0 * x[3 * (back ? 5 : 6) + c] - 3.0 * x[6 + c] -
                                     x[3 * (back ? 1 : 3) + c]));
  }
  tap_close(off, 0.0, 1e-14, "tangents of edges at a corner");
}

/* Mid-side nodes at the quarter points: all tangents at the corner vanish, and its normal is still
 * that of the cube. (eq:edge-direction) */
static void quarter_point_corner(ct_face_kind kind)
{
  static const int MIDDLE[3] = {13, 14, 18}; // of the edges at node 6
  skin s;
  ct_nearest got;
  const double point[3] = {1.3, 1.2, 1.1};
  skin_make(&s, kind, 0.0, 0.0);
  for (int m = 0; m < 3; m++)
    for (int c = 0; c < 3; c++) s.x[MIDDLE[m]][c] = 0.5 * (1.0 + s.x[MIDDLE[m]][c]);
  ct_search *search = search_of(&s.surface);
  ct_search_nearest(search, 1, point, NULL, NULL, &got, NULL);
  double off = 0.0;
  for (int c = 0; c < 3; c++) off = worst(off, got.normal[c] - 1.0 / sqrt(3.0));
  tap_ok(got.where == CT_VERTEX && got.signed_distance > 0.0,
         "%s: a corner of quarter points is found", kind == CT_Q8 ? "Q8" : "T6");
  tap_close(off, 0.0, 1e-14, "%s: its normal is that of the cube", kind == CT_Q8 ? "Q8" : "T6");
}

/* A sphere of Q8 faces, refined: distances converge to those of the sphere. */
static double sphere_error(int n)
{
  static const int Q[8][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}};
  int m = 2 * n + 1, f = 0;
  double *x = numbers(3 * m * m), off = 0.0;
  int32_t *faces = integers(8 * n * n);
  for (int i = 0; i < m; i++)
    for (int j = 0; j < m; j++) {
      double u = (double)i / n - 1.0, v = (double)j / n - 1.0, r = sqrt(1.0 + u * u + v * v);
      double at[3] = {u / r, v / r, 1.0 / r};
      memcpy(&x[3 * (i * m + j)], at, sizeof at);
    }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++, f++)
      for (int a = 0; a < 8; a++) faces[8 * f + a] = (2 * i + Q[a][0]) * m + 2 * j + Q[a][1];
  ct_surface surface = {CT_Q8, m * m, n * n, faces, x};
  ct_search *search = search_of(&surface);
  for (int i = 0; i < 500; i++) {
    double point[3] = {uniform(0.4), uniform(0.4), 1.0}, scale = 1.2 + uniform(0.6), r = 0.0;
    for (int c = 0; c < 3; c++) point[c] *= scale;
    for (int c = 0; c < 3; c++) r += point[c] * point[c];
    ct_nearest got;
    ct_search_nearest(search, 1, point, NULL, NULL, &got, NULL);
    off = worst(off, got.signed_distance - (sqrt(r) - 1.0));
  }
  return off;
}

static void sphere(void)
{
  double coarse = sphere_error(4), fine = sphere_error(8);
  tap_ok(fine < coarse / 7.0,
         "Q8 faces on a sphere: signed distances from it fall from %.2g to %.2g as faces are "
         "halved, order %.1f",
         coarse, fine, log2(coarse / fine));
}

/* The closed form of the triangle (eq:triangle-inside, eq:triangle-edge) against the general
 * projection, needles included. */
static void triangles(void)
{
  double off = 0.0, at = 0.0;
  for (int i = 0; i < 20000; i++) {
    double x[9], thin = i % 4 == 0 ? 1e-6 : 1.0, point[3];
    for (int a = 0; a < 9; a++) x[a] = uniform(1.0);
    for (int c = 0; c < 3; c++) {
      x[6 + c] = thin == 1.0 ? x[6 + c] : 0.3 * x[c] + 0.7 * x[3 + c] + thin * x[6 + c];
      point[c] = uniform(1.5);
    }
    const int32_t nodes[3] = {0, 1, 2};
    ct_surface surface = {CT_T3, 3, 1, nodes, x};
    ct_search *search = search_of(&surface);
    double xi[2], d[3], square = ct_search_triangle(search, 0, point, xi, d), best = HUGE_VAL;
    ct_face face;
    ct_projection closest;
    ct_search_face(search, 0, &face);
    ct_project(&face, point, NULL, &closest, NULL);
    best = closest.distance;
    off = worst(off, sqrt(square) - best);
    double y[3];
    ct_segment_point(&face, xi, y);
    for (int c = 0; c < 3; c++) at = fmax(at, fabs(y[c] - point[c] - d[c]));
  }
  tap_close(off, 0.0, 1e-13,
            "the distance from a triangle in closed form is that of the general projection, "
            "needles of 1e6 included");
  tap_close(at, 0.0, 1e-15, "and its closest point is the point at xi");
}

/* -- What goes wrong
 * -------------------------------------------------------------------------------------------------------
 */

static ct_status try_create(ct_surface surface, ct_error *e)
{
  ct_search *search = NULL;
  ct_status status = ct_search_create(&surface, &search, e);
  ct_search_free(search);
  return status;
}

static void refused(void)
{
  patchwork p;
  patchwork_make(&p, CT_T3, 2, 0.1);
  ct_search *search = search_of(&p.surface);
  double point[3] = {0, 0, 1};
  ct_nearest out;
  int32_t start = p.surface.face_count;
  ct_search_options options = ct_search_options_default();
  tap_ok(ct_search_nearest(NULL, 1, point, NULL, NULL, &out, NULL) == CT_ERROR_ARGUMENT &&
             ct_search_nearest(search, 1, NULL, NULL, NULL, &out, NULL) == CT_ERROR_ARGUMENT &&
             ct_search_nearest(search, 1, point, NULL, NULL, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_search_nearest(search, 0, NULL, NULL, NULL, NULL, NULL) == CT_OK,
         "null pointers are refused, no points are fine");
  tap_ok(ct_search_nearest(search, 1, point, &start, NULL, &out, NULL) == CT_ERROR_ARGUMENT,
         "a start that is not a face is refused");
  options.tolerance = 0.0;
  tap_ok(ct_search_nearest(search, 1, point, NULL, &options, &out, NULL) == CT_ERROR_ARGUMENT,
         "a tolerance of 0 is refused");
  options = ct_search_options_default();
  options.threads = 0;
  tap_ok(ct_search_nearest(search, 1, point, NULL, &options, &out, NULL) == CT_ERROR_ARGUMENT,
         "0 threads are refused");

  double strange[][3] = {{NAN, 0, 0}, {0, INFINITY, 0}, {0, 0, 1e300}, {1e71, 0, 0}};
  for (int i = 0; i < 4; i++) {
    ct_search_nearest(search, 1, strange[i], NULL, NULL, &out, NULL);
    tap_ok(out.status == CT_INVALID && out.face == -1 && isnan(out.distance) && isnan(out.point[0]),
           "a point of (%g, %g, %g) has no result", strange[i][0], strange[i][1], strange[i][2]);
  }
  double far[3] = {3e20, 0, 0};
  ct_search_nearest(search, 1, far, NULL, NULL, &out, NULL);
  tap_ok(out.status == CT_OK && out.distance == 3e20, "a point 1e20 sizes away has one");
}

static void moves_refused(void)
{
  patchwork p;
  patchwork_make(&p, CT_T3, 2, 0.1);
  ct_search *search = search_of(&p.surface);
  ct_error e;
  double point[3] = {0, 0, 1}, *x = numbers(3 * p.surface.node_count);
  ct_nearest out;
  memcpy(x, p.x, 3 * (size_t)p.surface.node_count * sizeof *x);
  x[3 * p.faces[1] + 2] = NAN;
  tap_ok(ct_search_move(search, x, &e) == CT_INVALID && e.point == p.faces[1],
         "a node moved to NaN is refused and named: %s", e.text);
  ct_search_nearest(search, 1, point, NULL, NULL, &out, NULL);
  tap_ok(out.status == CT_OK && isfinite(out.distance), "and no node has moved");
  for (int i = 0; i < 3 * p.surface.node_count; i++) x[i] = 0.25;
  must(ct_search_move, search, x);
  ct_search_nearest(search, 1, point, NULL, NULL, &out, NULL);
  tap_ok(out.status == CT_INVALID,
         "a surface that has shrunk to a point has no nearest face with a normal");

  int32_t unknown[3] = {0, 1, 3}, twice[3] = {0, 1, 1}, three[3] = {0, 1, 2};
  double broken[9] = {0, 0, NAN, 1, 0, 0, 0, 1, 0};
  const struct {
    ct_surface surface;
    ct_status want;
    int element;
    const char *what;
  } bad[] = {{{CT_T3, 0, 0, p.faces, p.x}, CT_ERROR_ARGUMENT, -1, "an empty surface"},
             {{(ct_face_kind)9, 3, 1, p.faces, p.x}, CT_ERROR_ARGUMENT, -1, "an unknown kind"},
             {{CT_T3, 3, 1, unknown, p.x}, CT_ERROR_ARGUMENT, 0, "an unknown node"},
             {{CT_T3, 3, 1, twice, p.x}, CT_ERROR_GEOMETRY, 0, "a face without area"},
             {{CT_T3, 3, 1, three, broken}, CT_INVALID, -1, "NaN"}};
  for (int i = 0; i < 5; i++)
    tap_ok(try_create(bad[i].surface, &e) == bad[i].want && e.element == bad[i].element,
           "%s is refused: %s", bad[i].what, e.text);
  tap_ok(ct_search_create(NULL, NULL, NULL) == CT_ERROR_ARGUMENT && ct_search_builds(NULL) == 0 &&
             isnan(ct_search_cost(NULL)),
         "null pointers everywhere");
}

/* The same face many times, and many faces in one plane. */
static void repeated(void)
{
  int32_t faces[50][4];
  const double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int f = 0; f < 50; f++)
    for (int a = 0; a < 4; a++) faces[f][a] = a;
  ct_surface surface = {CT_Q4, 4, 50, faces[0], x[0]};
  ct_search *search = search_of(&surface);
  double points[6] = {0.3, 0.4, 2.0, 0.3, 0.4, -2.0};
  int32_t start[2] = {49, 7};
  ct_nearest out[2];
  ct_search_nearest(search, 2, points, start, NULL, out, NULL);
  tap_ok(out[0].face == 0 && out[1].face == 0 && out[0].signed_distance == 2.0 &&
             out[1].signed_distance == -2.0,
         "of fifty equal faces the first is returned, for any start");
}

/* The cost of a tree (eq:tree-cost). The tree is kept while a surface moves as one, and rebuilt
 * when it is crumpled. */
static void rebuilding(void)
{
  patchwork p;
  patchwork_make(&p, CT_Q4, 20, 0.1);
  ct_search *search = search_of(&p.surface);
  double *x = numbers(3 * p.surface.node_count);
  for (int step = 1; step <= 100; step++) {
    for (int i = 0; i < p.surface.node_count; i++)
      for (int c = 0; c < 3; c++) x[3 * i + c] = (1.0 + 0.01 * step) * p.x[3 * i + c] + 0.3 * step;
    must(ct_search_move, search, x);
  }
  tap_ok(ct_search_builds(search) == 1 && fabs(ct_search_cost(search) - 1.0) < 1e-9,
         "a surface that flies and grows keeps its tree (cost %.2f)", ct_search_cost(search));
  for (int i = 0; i < p.surface.node_count; i++) {
    int j = (i * 601) % p.surface.node_count; // every node takes the place of another one
    memcpy(&x[3 * i], &p.x[3 * j], 3 * sizeof *x);
  }
  must(ct_search_move, search, x);
  tap_ok(ct_search_builds(search) == 2 && ct_search_cost(search) == 1.0,
         "a surface with shuffled nodes gets a new one");
}

/* Closed boxes of bilinear and of quadratic faces, as they are and with each face reversed, and
 * without one face. (eq:enclosed-volume) */
static void inside_out(ct_brick_kind kind, const char *name)
{
  ct_mesh *m = box_mesh(kind, 5, 6, 7, 1, 2, 3, 2, 2, 2);
  const int per = kind == CT_HEX8 ? 4 : 8;
  int32_t faces[8 * 24], turned[8 * 24], found[3] = {9, 9, 9};
  const int order[8] = {0, 3, 2, 1, 7, 6, 5, 4};
  const int32_t count = ct_mesh_outer_faces(m, faces, NULL);
  for (int32_t i = 0; i < count * per; i++) turned[i] = faces[i / per * per + order[i % per]];
  for (int k = 0; k < 3; k++) {
    const ct_surface surface = {kind == CT_HEX8 ? CT_Q4 : CT_Q8, m->node_count, count - (k == 2),
                                k == 0 ? faces : turned, m->nodes};
    ct_search *search = NULL;
    must(ct_search_create, &surface, &search);
    must(ct_search_inside_out, search, &found[k]);
    ct_search_free(search);
  }
  tap_ok(found[0] == -1 && found[1] == 0 && found[2] == -1,
         "%s: a closed box, inside out, and open: %d, %d, %d", name, (int)found[0], (int)found[1],
         (int)found[2]);
  tap_ok(ct_search_inside_out(NULL, found, NULL) == CT_ERROR_ARGUMENT, "no search is refused");
}

int main(void)
{
  free_at_end();
  random_boxes(1, 0, "one box");
  random_boxes(2, 0, "two boxes");
  random_boxes(5, 0, "five boxes");
  random_boxes(17, 0, "seventeen boxes");
  random_boxes(4000, 0, "thousands of boxes");
  random_boxes(3000, 1, "boxes on a lattice, with ties and touching");
  special_boxes();
  for (int k = 0; k < 4; k++) face_boxes(k);
  for (int k = 0; k < 2; k++) beyond(k);
  parabola();
  last_point();
  for (int k = 0; k < 4; k++) nearest_faces(k);
  tangents_at_a_corner();
  cube(CT_T3);
  cube(CT_Q4);
  spike();
  sphere();
  curved_corners(CT_Q8, 0.28);
  curved_corners(CT_T6, 0.22);
  quarter_point_corner(CT_Q8);
  quarter_point_corner(CT_T6);
  triangles();
  repeated();
  rebuilding();
  refused();
  moves_refused();
  inside_out(CT_HEX8, "Q4");
  inside_out(CT_HEX20, "Q8");
  return tap_done();
}
