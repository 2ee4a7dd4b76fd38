/* Loops over many pairs of a face and a point, one for each library, that differ in the call they
 * time and in nothing else: the same f and gradient, the same pairs, the same clock. Built as a
 * shared library by projection.py, with GSL where it is there; NLopt comes as a table of its
 * functions, found by Python in the wheel. Each loop answers the seconds that it took. */
#define _POSIX_C_SOURCE 199309L
#include <libcontact.h>

#include "../libcontact/src/projection/projection_internal.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>
#ifdef HAVE_GSL
#include <gsl/gsl_multimin.h>
#endif

#define EXPORT __attribute__((visibility("default")))

/* What every loop reads and writes; rows are pairs. */
typedef struct pairs {
  int64_t count;
  const ct_face *face;
  const double *point;
  double tolerance;
  double *xi, *distance;
  int32_t *evaluations, *status;
} pairs;

/* What f is asked of. The minimisers see f in units of the face size, so that their tolerances mean
 * the same on every face. */
typedef struct context {
  ct_patch patch;
  double scale;
  int evaluations;
} context;

static double seconds(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double dot(const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* f, and its gradient when g is not null. */
static double f_and_gradient(context *at, const double *xi, double *g)
{
  const double (*c)[3] = at->patch.c;
  double x = xi[0], y = xi[1], d[3];
  double f = at->scale * ct_patch_value(&at->patch, xi, d);
  at->evaluations++;
  if (g == NULL) return f;
  double t1[3], t2[3];
  for (int k = 0; k < 3; k++) {
    t1[k] = c[1][k] + c[3][k] * y + 2 * c[4][k] * x + y * (2 * c[6][k] * x + c[7][k] * y);
    t2[k] = c[2][k] + c[3][k] * x + 2 * c[5][k] * y + x * (c[6][k] * x + 2 * c[7][k] * y);
  }
  g[0] = 2 * at->scale * dot(d, t1);
  g[1] = 2 * at->scale * dot(d, t2);
  return f;
}

static void keep(const pairs *p, int64_t i, context *at, const double *xi, int status)
{
  double d[3];
  p->distance[i] = sqrt(ct_patch_value(&at->patch, xi, d));
  p->evaluations[i] = at->evaluations;
  p->status[i] = status;
  for (int a = 0; a < 2; a++) p->xi[2 * i + a] = xi[a];
}

/* Build the polynomial of pair i, as a user of a general minimiser would before he calls it. */
static int prepare(const pairs *p, int64_t i, context *at, double xi[2])
{
  at->evaluations = 0;
  xi[0] = xi[1] = ct_patch_centre(p->face[i].kind);
  p->xi[2 * i] = p->xi[2 * i + 1] = p->distance[i] = NAN;
  p->status[i] = CT_INVALID;
  if (ct_patch_init(&at->patch, p->face[i].kind, p->face[i].node, p->point + 3 * i) != CT_OK)
    return 0;
  at->scale = 1 / (at->patch.size * at->patch.size);
  return 1;
}

EXPORT double bench_ours(const pairs *p, int method)
{
  ct_project_options options = ct_project_options_default();
  options.method = (ct_method)method;
  options.tolerance = p->tolerance;
  double start = seconds();
  for (int64_t i = 0; i < p->count; i++) {
    ct_projection out;
    p->status[i] = (int32_t)ct_project(&p->face[i], p->point + 3 * i, &options, &out, NULL);
    p->distance[i] = out.distance;
    p->evaluations[i] = out.evaluations;
    for (int a = 0; a < 2; a++) p->xi[2 * i + a] = out.xi[a];
  }
  return seconds() - start;
}

/* `robust` one by one from the starts that the pairs' xi hold; they are not written. */
EXPORT double bench_warm(const pairs *p)
{
  ct_project_options options = ct_project_options_default();
  options.tolerance = p->tolerance;
  options.use_start = 1;
  double start = seconds();
  for (int64_t i = 0; i < p->count; i++) {
    ct_projection out;
    for (int a = 0; a < 2; a++) options.start[a] = p->xi[2 * i + a];
    ct_project(&p->face[i], p->point + 3 * i, &options, &out, NULL);
    p->distance[i] = out.distance;
  }
  return seconds() - start;
}

EXPORT double bench_batch(int kind, int64_t count, const double *nodes, const double *points,
                          const double *start, double tolerance, ct_batch_closest *closest)
{
  ct_project_options options = ct_project_options_default();
  options.tolerance = tolerance;
  double begin = seconds();
  ct_project_batch((ct_face_kind)kind, (size_t)count, nodes, points, start, &options, closest,
                   NULL);
  return seconds() - begin;
}

/* NLopt's functions by their place in the table that Python fills. */
typedef struct nlopt_table {
  void *(*create)(int, unsigned);
  void (*destroy)(void *);
  int (*set_min_objective)(void *, double (*)(unsigned, const double *, double *, void *), void *);
  int (*set_lower_bounds)(void *, const double *);
  int (*set_upper_bounds)(void *, const double *);
  int (*set_xtol_abs1)(void *, double);
  int (*set_maxeval)(void *, int);
  int (*set_initial_step1)(void *, double);
  int (*optimize)(void *, double *, double *);
} nlopt_table;

static double nlopt_f(unsigned n, const double *xi, double *g, void *at)
{
  (void)n;
  return f_and_gradient(at, xi, g);
}

/* One NLopt object for all pairs, within the box of the reference face. */
EXPORT double bench_nlopt(const pairs *p, const nlopt_table *nlopt, int algorithm)
{
  context at;
  void *solver = nlopt->create(algorithm, 2);
  nlopt->set_min_objective(solver, nlopt_f, &at);
  nlopt->set_xtol_abs1(solver, p->tolerance);
  nlopt->set_maxeval(solver, 2000);
  double start = seconds();
  for (int64_t i = 0; i < p->count; i++) {
    double xi[2], f, low = p->face[i].kind < CT_T3 ? -1 : 0, lower[2] = {low, low},
                     upper[2] = {1, 1};
    if (!prepare(p, i, &at, xi)) continue;
    nlopt->set_lower_bounds(solver, lower);
    nlopt->set_upper_bounds(solver, upper);
    nlopt->set_initial_step1(solver, 0.5 * ct_patch_half_width(p->face[i].kind));
    int end = nlopt->optimize(solver, xi, &f);
    keep(p, i, &at, xi, end > 0 && end != 5 ? CT_OK : CT_NO_CONVERGENCE);
  }
  double taken = seconds() - start;
  nlopt->destroy(solver);
  return taken;
}

#ifdef HAVE_GSL
static double gsl_f(const gsl_vector *x, void *at) { return f_and_gradient(at, x->data, NULL); }
static void gsl_df(const gsl_vector *x, void *at, gsl_vector *g)
{
  f_and_gradient(at, x->data, g->data);
}
static void gsl_fdf(const gsl_vector *x, void *at, double *f, gsl_vector *g)
{
  *f = f_and_gradient(at, x->data, g->data);
}

EXPORT double bench_gsl_nmsimplex2(const pairs *p)
{
  context at;
  gsl_multimin_function f = {gsl_f, 2, &at};
  gsl_multimin_fminimizer *solver =
      gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 2);
  gsl_vector *x = gsl_vector_alloc(2), *step = gsl_vector_alloc(2);
  double start = seconds();
  for (int64_t i = 0; i < p->count; i++) {
    if (!prepare(p, i, &at, x->data)) continue;
    double width = ct_patch_half_width(p->face[i].kind);
    int end = GSL_CONTINUE;
    gsl_vector_set_all(step, 0.5 * width);
    gsl_multimin_fminimizer_set(solver, &f, x, step);
    for (int k = 0; k < 1000 && end == GSL_CONTINUE; k++) {
      end = gsl_multimin_fminimizer_iterate(solver);
      if (end == GSL_SUCCESS)
        end = gsl_multimin_test_size(gsl_multimin_fminimizer_size(solver), p->tolerance * width);
    }
    keep(p, i, &at, gsl_multimin_fminimizer_x(solver)->data,
         end == GSL_SUCCESS ? CT_OK : CT_NO_CONVERGENCE);
  }
  double taken = seconds() - start;
  gsl_multimin_fminimizer_free(solver);
  gsl_vector_free(x);
  gsl_vector_free(step);
  return taken;
}

EXPORT double bench_gsl_bfgs2(const pairs *p)
{
  context at;
  gsl_multimin_function_fdf f = {gsl_f, gsl_df, gsl_fdf, 2, &at};
  gsl_multimin_fdfminimizer *solver =
      gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, 2);
  gsl_vector *x = gsl_vector_alloc(2);
  double start = seconds();
  for (int64_t i = 0; i < p->count; i++) {
    if (!prepare(p, i, &at, x->data)) continue;
    double width = ct_patch_half_width(p->face[i].kind);
    int end = GSL_CONTINUE;
    gsl_multimin_fdfminimizer_set(solver, &f, x, 0.1 * width, 0.1);
    for (int k = 0; k < 200 && end == GSL_CONTINUE; k++) {
      end = gsl_multimin_fdfminimizer_iterate(solver);
      if (end == GSL_SUCCESS)
        end = gsl_multimin_test_gradient(gsl_multimin_fdfminimizer_gradient(solver), p->tolerance);
    }
    keep(p, i, &at, gsl_multimin_fdfminimizer_x(solver)->data,
         end == GSL_SUCCESS ? CT_OK : CT_NO_CONVERGENCE);
  }
  double taken = seconds() - start;
  gsl_multimin_fdfminimizer_free(solver);
  gsl_vector_free(x);
  return taken;
}
#endif
