/* The search tree against looking at every box. */
#include "../../libcontact/src/search.h"
#include "bodies.h"

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
  double *extra; /* how much farther than its box an item is */
  int asked;
} items;

static double distance(void *user, int32_t item)
{
  items *all = user;
  all->asked++;
  return ct_bounds_distance(&all->boxes[item], all->point) + all->extra[item];
}

static ct_search *tree(int count, const ct_bounds *boxes)
{
  ct_search *search = NULL;
  ct_error e;
  need(ct_search_create(count, &search, &e), &e);
  ct_search_build(search, boxes);
  return search;
}

static void against_all(int count, int lattice, const char *what)
{
  ct_bounds *boxes = room(count, sizeof *boxes);
  double *extra = numbers(count);
  int32_t *found = integers(count);
  int wrong = 0, unlike = 0, asked = 0, queries = 300;
  for (int i = 0; i < count; i++) {
    boxes[i] = random_box(50.0, 4.0, lattice);
    extra[i] = lattice ? 0.0 : fabs(uniform(1.0));
  }
  ct_search *search = tree(count, boxes);
  for (int k = 0; k < queries; k++) {
    ct_bounds query = random_box(55.0, 20.0, lattice);
    int n = ct_search_overlaps(search, &query, found, count), next = 0;
    for (int i = 0; i < count; i++)
      if (meets(&boxes[i], &query)) {
        wrong += next >= n || found[next] != i;
        next++;
      }
    wrong += next != n;

    double point[3] = {uniform(60.0), uniform(60.0), uniform(60.0)}, best = INFINITY, got;
    for (int c = 0; lattice && c < 3; c++) point[c] = floor(point[c]);
    items all = {boxes, point, extra, 0};
    int32_t first = -1, item = ct_search_nearest(search, point, distance, &all, &got);
    asked += all.asked;
    for (int i = 0; i < count; i++) {
      double d = distance(&all, i);
      if (d < best) best = d, first = i;
    }
    unlike += item != first || got != best;
  }
  tap_ok(wrong == 0, "%s: overlaps are those found by looking at all %d boxes, ascending", what, count);
  tap_ok(unlike == 0, "%s: the nearest is the nearest of all, the first of equals (%.1f of %d looked at)", what, (double)asked / queries, count);
  ct_search_free(search);
  free(boxes);
  free(extra);
  free(found);
}

static void special_cases(void)
{
  ct_bounds one = {{0, 0, 0}, {1, 1, 1}}, touching = {{1, 1, 1}, {2, 2, 2}}, apart = {{1.0000001, 0, 0}, {2, 1, 1}};
  double point[3] = {3, 0.5, 0.5}, zero[8] = {0}, d = 0.0;
  int32_t found[8];
  ct_search *search = tree(1, &one);
  items all = {&one, point, zero, 0};
  tap_ok(ct_search_overlaps(search, &touching, found, 8) == 1 && found[0] == 0, "boxes that touch overlap");
  tap_ok(ct_search_overlaps(search, &apart, found, 8) == 0, "boxes apart do not");
  tap_ok(ct_search_nearest(search, point, distance, &all, &d) == 0 && d == 2.0, "a tree of one item: distance 2");
  ct_search_free(search);

  ct_bounds same[8];
  for (int i = 0; i < 8; i++) same[i] = one;
  search = tree(8, same);
  all.boxes = same;
  tap_ok(ct_search_nearest(search, point, distance, &all, &d) == 0 && d == 2.0, "of eight equal items the first is taken");
  found[3] = 77;
  tap_ok(ct_search_overlaps(search, &one, found, 3) == 8 && found[3] == 77, "with room for three, eight are counted and three written");
  ct_search_free(search);

  search = NULL;
  ct_error e;
  need(ct_search_create(0, &search, &e), &e);
  ct_search_build(search, &one);
  tap_ok(ct_search_overlaps(search, &one, found, 8) == 0 && ct_search_nearest(search, point, distance, &all, &d) == -1, "an empty tree finds nothing");
  ct_search_free(search);
  ct_search_free(NULL);

  ct_bounds box = {{-1, -2, -3}, {1, 2, 3}};
  double inside[3] = {0.5, 1, -2}, corner[3] = {4, 6, 3 + 12}, face[3] = {0, -7, 0};
  tap_ok(ct_bounds_distance(&box, inside) == 0 && ct_bounds_distance(&box, corner) == 13 && ct_bounds_distance(&box, face) == 5,
         "distance from a box: 0 inside, 13 = |(3, 4, 12)| off a corner, 5 off a face");
}

int main(void)
{
  against_all(1, 0, "one box");
  against_all(2, 0, "two boxes");
  against_all(17, 0, "seventeen boxes");
  against_all(4000, 0, "thousands of boxes");
  against_all(3000, 1, "boxes on a lattice, with ties and touching");
  special_cases();
  return tap_done();
}
