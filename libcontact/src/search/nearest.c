/* The nearest face of a surface for each point of a cloud. */
#include "search_internal.h"
#include "../base/error.h"

#include "../projection/projection_internal.h"
#include "../base/threads.h"
#include "../base/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A point, and its best result so far. */
typedef struct seeker {
  const ct_search *search;
  const double *point;
  ct_search_skip *skip;
  void *user;
  ct_project_options project;
  int32_t started; /* face that was tried before the tree */
  double bound;    /* square of a distance at which there is a face */
  int32_t face;
  double square;
  double d[3];           /* vector to the closest point */
  ct_projection closest; /* for a triangle only the parameters, until the end */
} seeker;

/* Nearer than the best, or equally near with a lower face number. */
static int is_better(const seeker *s, double square, int32_t face)
{
  return square < s->square || (square == s->square && face < s->face);
}

/* Try a face that is not excluded; returns the square of the smallest known distance. */
static double try_face(seeker *s, int32_t face)
{
  if (s->skip != NULL && s->skip(s->user, face)) return fmin(s->square, s->bound);
  ct_projection closest = {.status = CT_OK};
  double d[3], square;
  if (s->search->kind == CT_T3) {
    square = ct_search_triangle(s->search, face, s->point, closest.xi, d);
  } else {
    ct_face own;
    ct_search_face(s->search, face, &own);
    ct_project(&own, s->point, &s->project, &closest, NULL);
    square = closest.distance * closest.distance;
    for (int c = 0; c < 3; c++) d[c] = closest.point[c] - s->point[c];
  }
  if (square < HUGE_VAL && is_better(s, square, face)) {
    s->face = face;
    s->square = square;
    s->closest = closest;
    memcpy(s->d, d, sizeof d);
  }
  return s->square < s->bound ? s->square : s->bound;
}

static double visit(void *user, int32_t face)
{
  seeker *s = user;
  return face == s->started ? s->square < s->bound ? s->square : s->bound : try_face(s, face);
}

/* The box along the face is a better bound than that along the axes (eq:oriented-box). */
static double oriented_bound(void *user, int32_t face)
{
  const seeker *s = user;
  return ct_oriented_square(&s->search->oriented[face], s->point);
}

static void nothing(ct_nearest *out)
{
  *out = (ct_nearest){CT_INVALID, -1,  CT_OUTSIDE,     -1, {NAN, NAN}, {NAN, NAN, NAN},
                      NAN,        NAN, {NAN, NAN, NAN}};
}

/* The result of ct_project for the closest point on a triangle. */
static int finish_triangle(seeker *s)
{
  ct_face face;
  double u[3], v[3];
  ct_search_face(s->search, s->face, &face);
  for (int c = 0; c < 3; c++) {
    u[c] = face.node[1][c] - face.node[0][c];
    v[c] = face.node[2][c] - face.node[0][c];
    s->closest.point[c] = s->point[c] + s->d[c];
  }
  s->closest.distance = sqrt(s->square);
  s->closest.where = ct_patch_where(
      CT_T3, s->closest.xi, s->project.tolerance * ct_patch_half_width(CT_T3), &s->closest.index);
  return ct_vector_unit_normal(u, v, s->closest.normal);
}

/* The result from the best closest point: its sign is that of the mean normal (eq:pseudo-normal).
 */
static void finish(seeker *s, ct_nearest *out)
{
  if (s->face == INT32_MAX || (s->search->kind == CT_T3 && !finish_triangle(s))) {
    nothing(out);
    return;
  }
  const ct_projection *closest = &s->closest;
  *out = (ct_nearest){.status = closest->status,
                      .face = s->face,
                      .where = closest->where,
                      .index = closest->index,
                      .distance = closest->distance};
  double normal[3];
  (void)ct_search_normal(s->search, s->face, closest->where, closest->index, closest->xi,
                         closest->normal, normal);
  double length = sqrt(ct_vector_dot(normal, normal));
  for (int a = 0; a < 2; a++) out->xi[a] = closest->xi[a];
  for (int c = 0; c < 3; c++) {
    out->point[c] = closest->point[c];
    out->normal[c] = length > 0.0 ? normal[c] / length : closest->normal[c];
  }
  out->signed_distance =
      ct_vector_dot(s->d, out->normal) <= 0.0 ? closest->distance : -closest->distance;
}

void ct_search_point(const ct_search *search, const double point[3], int32_t start, double bound,
                     double tolerance, ct_search_skip *skip, void *user, ct_nearest *out)
{
  seeker s;
  s.search = search;
  s.point = point;
  s.skip = skip;
  s.user = user;
  s.project = ct_project_options_default();
  s.project.tolerance = tolerance;
  s.started = start;
  s.bound = bound;
  s.face = INT32_MAX;
  s.square = HUGE_VAL;
  for (int c = 0; c < 3; c++)
    if (!(fabs(point[c]) <= CT_LARGEST_LENGTH)) {
      nothing(out);
      return;
    }
  // -- Try the face to begin with, then every face whose box is not farther (eq:closest-face)
  if (start >= 0) bound = try_face(&s, start);
  ct_box_tree_visit(search->tree, point, bound, visit,
                    search->oriented != NULL ? oriented_bound : NULL, &s);
  finish(&s, out);
}

/* Points that one thread processes in order. */
enum { BLOCK = 1024 };

/* Square of the distance of a point from the closest point of another one: the nearest face is at
 * most as far. With a margin for the rounding of coordinates. */
static double bound_from(const double point[3], const ct_nearest *last)
{
  double square = 0.0, largest = 0.0;
  if (last->face < 0) return HUGE_VAL;
  for (int c = 0; c < 3; c++) {
    double d = point[c] - last->point[c];
    square += d * d;
    largest = fmax(largest, fabs(last->point[c]));
  }
  // -- The last closest point is a point of the surface (eq:warm-bound)
  double far = sqrt(square) + 64.0 * DBL_EPSILON * largest;
  return far * far;
}

static void ask_block(const ct_search *search, size_t first, size_t last, const double *points,
                      const int32_t *start, double tolerance, ct_nearest *out)
{
  for (size_t i = first; i < last; i++) {
    // -- Begin with the face that is given, or with the distance from the last closest point
    int32_t face = start != NULL ? start[i] : -1;
    double bound = face < 0 && i > first ? bound_from(&points[3 * i], &out[i - 1]) : HUGE_VAL;
    ct_search_point(search, &points[3 * i], face, bound, tolerance, NULL, NULL, &out[i]);
  }
}

ct_search_options ct_search_options_default(void)
{
  return (ct_search_options){CT_DEF_COOKIE, CT_SEARCH_TOLERANCE, 1};
}

ct_status ct_search_nearest(const ct_search *search, size_t count, const double *points,
                            const int32_t *start, const ct_search_options *options, ct_nearest *out,
                            ct_error *error)
{
  ct_search_options own = options != NULL ? *options : ct_search_options_default();
  ct_status status = ct_check_options(own.cookie, "ct_search_options_default", error);
  if (status != CT_OK) return status;
  if (search == NULL || (count > 0 && (points == NULL || out == NULL)))
    return CT_REFUSE_NULL(error);
  if (!(own.tolerance > 0.0 && own.tolerance < HUGE_VAL))
    return CT_REFUSE(error, "search: tolerance must be positive and finite, not %g", own.tolerance);
  if (own.threads < 1)
    return CT_REFUSE(error, "search: threads must be at least 1, not %d", own.threads);
  for (size_t i = 0; start != NULL && i < count; i++)
    if (start[i] < -1 || start[i] >= search->face_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, (int64_t)i},
                     "search: point %zu starts at face %d, there are faces -1 (none) to %d", i,
                     (int)start[i], (int)search->face_count - 1);
  int64_t blocks = (int64_t)((count + BLOCK - 1) / BLOCK);
#ifdef _OPENMP
  int threads = ct_threads_for(own.threads, blocks, 1);
#pragma omp parallel for num_threads(threads) schedule(static, 1) if (threads > 1)
#endif
  for (int64_t b = 0; b < blocks; b++) {
    size_t first = (size_t)b * BLOCK, last = first + BLOCK < count ? first + BLOCK : count;
    ask_block(search, first, last, points, start, own.tolerance, out);
  }
  return CT_OK;
}
