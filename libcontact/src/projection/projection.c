#include <libcontact/ray.h>

#include "projection_internal.h"
#include "../base/error.h"
#include "../base/vector.h"

#include <math.h>

static ct_project_method *const METHOD[] = {
    [CT_SIMPLEX] = ct_project_simplex,
    [CT_NELDER_MEAD] = ct_project_nelder_mead,
    [CT_NEWTON] = ct_project_newton,
    [CT_LEAST_SQUARES] = ct_project_least_squares,
    [CT_STEEPEST_DESCENT] = ct_project_steepest_descent,
    [CT_BROYDEN] = ct_project_broyden,
    [CT_BFGS] = ct_project_bfgs,
    [CT_ROBUST] = ct_project_robust,
    [CT_CERTIFIED] = ct_project_certified,
    [CT_SIMPLEX_NEWTON] = ct_project_simplex_newton,
    [CT_SPHERE] = ct_project_sphere,
    [CT_TORUS] = ct_project_torus,
};

int ct_method_exists(ct_method method)
{
  return (int)method >= 0 && (size_t)method < sizeof METHOD / sizeof METHOD[0];
}

ct_project_options ct_project_options_default(void)
{
  return (ct_project_options){.cookie = CT_DEF_COOKIE, .method = CT_ROBUST, .tolerance = 1e-10};
}

/* The result of an invalid input. */
static ct_status nothing(ct_projection *out, ct_status status)
{
  *out = (ct_projection){status, CT_OUTSIDE,     -1, 0, 0, 0, {NAN, NAN}, {NAN, NAN, NAN}, NAN,
                         NAN,    {NAN, NAN, NAN}};
  return status;
}

/* Check the method and the other options. */
static int are_possible(const ct_project_options *options)
{
  return options->cookie == CT_DEF_COOKIE && ct_method_exists(options->method) &&
         options->iteration_limit >= 0 && options->tolerance > 0 && options->tolerance < HUGE_VAL &&
         (!options->use_start ||
          (fabs(options->start[0]) < HUGE_VAL && fabs(options->start[1]) < HUGE_VAL));
}

ct_status ct_check_search_limits(const char *who, const ct_project_options *options,
                                 ct_error *error)
{
  if (!(options->tolerance > 0.0 && options->tolerance < HUGE_VAL))
    return CT_REFUSE(error, "%s: tolerance must be positive and finite, not %g", who,
                     options->tolerance);
  if (options->iteration_limit < 0)
    return CT_REFUSE(error, "%s: iteration_limit must not be negative, but is %d", who,
                     options->iteration_limit);
  return CT_OK;
}

/* The reason why a call is rejected. */
static ct_status refuse(const ct_face *face, const double *point, const ct_project_options *options,
                        ct_error *error)
{
  if (face == NULL || point == NULL)
    return CT_REFUSE(error, "projection: a required argument is null");
  if (ct_face_node_count(face->kind) == 0)
    return CT_REFUSE(error, "projection: there is no face of the kind %d", (int)face->kind);
  if (options->cookie != CT_DEF_COOKIE)
    return ct_check_options(options->cookie, "ct_project_options_default", error);
  if (!ct_method_exists(options->method))
    return CT_REFUSE(error, "projection: there is no method %d", (int)options->method);
  ct_status status = ct_check_search_limits("projection", options, error);
  return status != CT_OK ? status : CT_REFUSE(error, "projection: the start is not finite");
}

ct_status ct_project(const ct_face *face, const double point[3], const ct_project_options *options,
                     ct_projection *out, ct_error *error)
{
  if (out == NULL) return CT_REFUSE_NULL(error);
  ct_project_options defaults = ct_project_options_default();
  if (options == NULL) options = &defaults;
  if (face == NULL || point == NULL || ct_face_node_count(face->kind) == 0 ||
      !are_possible(options))
    return nothing(out, refuse(face, point, options, error));
  ct_patch patch;
  if (ct_patch_init(&patch, face->kind, face->node, point) != CT_OK)
    return nothing(out, CT_INVALID);
  ct_closest closest = {.evaluations = 0};
  out->status = METHOD[options->method](&patch, options, &closest);
  // -- Neither without a normal nor beyond the range of numbers is there an answer
  double f = ct_vector_dot(closest.d, closest.d);
  if (!(f < HUGE_VAL) || !ct_patch_normal(&patch, closest.xi, out->normal))
    return nothing(out, CT_INVALID);
  out->where = ct_patch_where(face->kind, closest.xi,
                              options->tolerance * ct_patch_half_width(face->kind), &out->index);
  out->evaluations = closest.evaluations;
  out->iterations = closest.iterations;
  out->certified = closest.certified;
  // -- The closest point (eq:projection-minimum)
  for (int a = 0; a < 2; a++) out->xi[a] = closest.xi[a];
  for (int k = 0; k < 3; k++) out->point[k] = point[k] + closest.d[k];
  // -- Distance, and its sign on the side of the normal (eq:projection-signed)
  out->distance = sqrt(f);
  out->signed_distance =
      ct_vector_dot(closest.d, out->normal) <= 0 ? out->distance : -out->distance;
  return out->status;
}

ct_status ct_project_points(const ct_face *face, size_t count, const double *points,
                            const ct_project_options *options, const double *start,
                            ct_projection *out, ct_error *error)
{
  if (count == 0) return CT_OK;
  if (points == NULL || out == NULL) return CT_REFUSE_NULL(error);
  ct_project_options own = options != NULL ? *options : ct_project_options_default();
  ct_status first = CT_OK;
  for (size_t i = 0; i < count; i++) {
    if (start != NULL)
      own.use_start = 1, own.start[0] = start[2 * i], own.start[1] = start[2 * i + 1];
    ct_status status =
        ct_project(face, points + 3 * i, &own, &out[i], first == CT_OK ? error : NULL);
    if (first == CT_OK && status >= CT_ERROR_ARGUMENT) first = status;
  }
  return first;
}

static ct_status no_hit(ct_ray_hit *out, ct_status status, int evaluations)
{
  *out = (ct_ray_hit){status,     CT_OUTSIDE,      -1,  evaluations,
                      {NAN, NAN}, {NAN, NAN, NAN}, NAN, {NAN, NAN, NAN}};
  return status;
}

static ct_status project_ray(const ct_face *face, const double point[3], const double direction[3],
                             double tolerance, ct_ray_hit *out)
{
  if (face == NULL || point == NULL || direction == NULL || ct_face_node_count(face->kind) == 0 ||
      !(tolerance > 0 && tolerance < 1))
    return no_hit(out, CT_ERROR_ARGUMENT, 0);
  ct_patch patch;
  if (ct_patch_init(&patch, face->kind, face->node, point) != CT_OK)
    return no_hit(out, CT_INVALID, 0);
  double d[3];
  out->evaluations = 0;
  // -- Meet the face (eq:ray-hit)
  out->status =
      ct_patch_ray(&patch, direction, tolerance, out->xi, &out->distance, &out->evaluations);
  if (out->status != CT_OK && out->status != CT_NOT_CERTIFIED)
    return no_hit(out, out->status, out->evaluations);
  if (!ct_patch_normal(&patch, out->xi, out->normal))
    return no_hit(out, CT_INVALID, out->evaluations);
  out->where =
      ct_patch_where(face->kind, out->xi, tolerance * ct_patch_half_width(face->kind), &out->index);
  ct_patch_value(&patch, out->xi, d);
  for (int k = 0; k < 3; k++) out->point[k] = point[k] + d[k];
  return out->status;
}

ct_status ct_project_rays(const ct_face *face, size_t count, const double *points,
                          const double *directions, double tolerance, ct_ray_hit *out,
                          ct_error *error)
{
  if (count == 0) return CT_OK;
  if (points == NULL || directions == NULL || out == NULL) return CT_REFUSE_NULL(error);
  ct_status first = CT_OK;
  for (size_t i = 0; i < count; i++) {
    ct_status status = project_ray(face, points + 3 * i, directions + 3 * i, tolerance, &out[i]);
    if (first == CT_OK && status >= CT_ERROR_ARGUMENT) first = status;
  }
  return first == CT_OK
             ? CT_OK
             : CT_REFUSE(error, "ray: no face, an unknown kind, or tolerance %g", tolerance);
}
