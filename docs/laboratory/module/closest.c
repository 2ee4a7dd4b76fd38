/* One face and its closest points, with the way of each method. */
#include "module.h"

enum { MOST_TRACED = 4096 };

static ct_face face;
static double path[MOST_TRACED][3];
static int path_count;

/* Kind 0 ... as ct_face_kind; coordinates of its nodes in `numbers`. */
EXPORT(set_face) void set_face(int kind)
{
  face.kind = (ct_face_kind)kind;
  int count = ct_face_node_count(face.kind);
  const double *x = numbers(3 * count);
  for (int i = 0; i < 3 * count; i++) face.node[i / 3][i % 3] = x[i];
}

static void trace(const double xi[2], double f, void *user)
{
  (void)user;
  if (path_count == MOST_TRACED) return;
  path[path_count][0] = xi[0], path[path_count][1] = xi[1], path[path_count][2] = f;
  path_count++;
}

/* Thirteen numbers: status, where, index, evaluations, iterations, certified, xi (2), point (3),
 * distance, signed distance. */
static void write(const ct_projection *from, double out[13])
{
  const double all[13] = {from->status,         from->where,     from->index,    from->evaluations,
                          from->iterations,     from->certified, from->xi[0],    from->xi[1],
                          from->point[0],       from->point[1],  from->point[2], from->distance,
                          from->signed_distance};
  for (int i = 0; i < 13; i++) out[i] = all[i];
}

/* The closest point of (x, y, z); a start that is not a number: the method's own. */
EXPORT(project)
const double *project(double x, double y, double z, int method, double tolerance, double xi_1,
                      double xi_2)
{
  ct_project_options options = ct_project_options_default();
  const double point[3] = {x, y, z};
  ct_projection out;
  double *result = numbers(32);
  options.method = (ct_method)method;
  options.tolerance = tolerance;
  options.use_start = xi_1 == xi_1 && xi_2 == xi_2;
  options.start[0] = xi_1, options.start[1] = xi_2;
  options.trace = trace;
  path_count = 0;
  if (result == NULL) return NULL;
  (void)ct_project(&face, point, &options, &out, &page_error);
  write(&out, result);
  return result;
}

EXPORT(path_length) int path_length(void) { return path_count; }

EXPORT(path_rows) const double *path_rows(void) { return &path[0][0]; }

/* Closest points of `count` points in `numbers`, shape (count, 3), with the default method: their
 * xi and distance take the place of the points. */
EXPORT(project_all) ct_status project_all(int count)
{
  double *rows = numbers(3 * count);
  for (int i = 0; i < count; i++) {
    ct_projection out;
    ct_status status = ct_project(&face, &rows[3 * i], NULL, &out, &page_error);
    if (status >= CT_ERROR_ARGUMENT) return status;
    rows[3 * i] = out.xi[0], rows[3 * i + 1] = out.xi[1], rows[3 * i + 2] = out.distance;
  }
  return CT_OK;
}

/* Points y of the face at `count` reference coordinates in `numbers`, shape (count, 3), of which
 * the third is not read; the points take their place. */
EXPORT(face_points) void face_points(int count)
{
  double *rows = numbers(3 * count);
  for (int i = 0; i < count; i++) {
    const double xi[2] = {rows[3 * i], rows[3 * i + 1]};
    ct_segment_point(&face, xi, &rows[3 * i]);
  }
}
