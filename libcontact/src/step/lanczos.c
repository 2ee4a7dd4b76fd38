/* The largest frequency of the assembled bodies: Lanczos' method with a bound on its error. */
#include <libcontact/problem.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/random.h"
#include "../base/stream.h"
#include "../base/tridiagonal.h"
#include "workspace.h"

#include <math.h>
#include <stdint.h>

/* Probability, over random starts, that the result is too small by more than the margin. */
static const double MARGIN = 0.06, DOUBT = 1e-12, SMALL = 1e-6;

/* Vectors with one number per degree of freedom, and the tridiagonal matrix. */
typedef struct lanczos {
  const ct_problem *problem;
  ct_view view;
  double scale; /* largest trial displacement */
  double *now, *before, *next, *u, *force;
  double *diagonal, *beside;
  int rounds;
  uint64_t seed;
} lanczos;

/* Uniform on (0, 1). */
static double uniform(uint64_t *seed) { return (ct_random_bits(seed) + 0.5) / 9007199254740992.0; }

static double dot(const lanczos *l, const double *x, const double *y)
{
  return ct_sum_product(l->problem->node_count, NULL, x, y);
}

/* A random direction, uniform on the sphere; fixed components are 0. */
static void start(lanczos *l)
{
  int64_t count = 3 * (int64_t)l->problem->node_count;
  for (int64_t d = 0; d < count; d++) {
    double r = sqrt(-2.0 * log(uniform(&l->seed))), angle = 6.283185307179586 * uniform(&l->seed);
    l->now[d] = l->problem->inverse_mass[d] > 0.0 ? r * cos(angle) : 0.0;
  }
  double length = sqrt(dot(l, l->now, l->now));
  for (int64_t d = 0; d < count && length > 0.0; d++) l->now[d] /= length;
}

/* next = A now with A = M^-1/2 K M^-1/2, by one evaluation of the solid's force
 * (eq:assembled-operator). */
static ct_status apply(lanczos *l, ct_error *error)
{
  const ct_effect *solid = l->problem->effects[0];
  const double *inverse_mass = l->problem->inverse_mass;
  int64_t count = 3 * (int64_t)l->problem->node_count;
  double top = 0.0;
  for (int64_t d = 0; d < count; d++)
    top = fmax(top, fabs(l->u[d] = sqrt(inverse_mass[d]) * l->now[d]));
  double scale = top > 0.0 ? l->scale / top : 0.0;
  for (int64_t d = 0; d < count; d++) l->u[d] *= scale;
  ct_status status = solid->calls->force(solid, &l->view, l->force, error);
  // -- M^-1/2 K M^-1/2 y from the force at M^-1/2 y (eq:assembled-operator)
  for (int64_t d = 0; d < count; d++)
    l->next[d] = scale > 0.0 ? -sqrt(inverse_mass[d]) * (l->force[d] / scale) : 0.0;
  return status;
}

/* Rounds of Lanczos' recurrence; `rounds` becomes their actual number (eq:assembled-rounds). */
static ct_status recur(lanczos *l, ct_error *error)
{
  int64_t count = 3 * (int64_t)l->problem->node_count;
  start(l);
  for (int k = 0; k < l->rounds; k++) {
    ct_status status = apply(l, error);
    if (status != CT_OK) return status;
    double a = l->diagonal[k] = dot(l, l->now, l->next), b = k > 0 ? l->beside[k - 1] : 0.0;
    for (int64_t d = 0; d < count; d++)
      l->next[d] = (l->next[d] - a * l->now[d]) - b * l->before[d];
    double length = l->beside[k] = sqrt(dot(l, l->next, l->next));
    if (!isfinite(length))
      return ct_fail(error, CT_INVALID, CT_NOWHERE,
                     "stable step: the stiffness of the bodies is not finite");
    // The remainder is zero: the eigenvalues so far are exact.
    if (!(length > 1e-12 * fabs(a))) {
      l->rounds = k + 1;
      break;
    }
    double *free = l->before;
    l->before = l->now, l->now = l->next, l->next = free;
    for (int64_t d = 0; d < count; d++) l->now[d] /= length;
  }
  return CT_OK;
}

/* Upper bound on the largest eigenvalue of the tridiagonal matrix. */
static double largest(const lanczos *l)
{
  double low = 0.0, high = ct_tridiagonal_reach(l->rounds, l->diagonal, l->beside);
  for (int k = 0; k < l->rounds; k++) low = fmax(low, l->diagonal[k]);
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (low + high);
    if (ct_tridiagonal_all_below(l->rounds, l->diagonal, l->beside, middle)) high = middle;
    else low = middle;
  }
  return high;
}

ct_status ct_stable_assembled(const ct_problem *problem, ct_state *state, double *omega_squared,
                              ct_error *error)
{
  // If the stiffness may change, no bound holds for all times.
  if (!ct_problem_is_linear(problem) || problem->effects[0]->kind != CT_EFFECT_SOLID)
    return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                   "stable step: the assembled bound needs the law \"linear\" in all bodies");
  const ct_effect *solid = problem->effects[0];
  size_t n = 3 * (size_t)problem->node_count;
  lanczos l = {.problem = problem,
               .view = ct_workspace_view(problem, state, 0),
               .scale = SMALL * ct_problem_edge(problem),
               .seed = 88172645463325252u};
  // -- As many rounds as the margin asks for (eq:assembled-rounds)
  l.rounds = (int)ceil(0.5 * (log(1.648 * sqrt((double)n) / DOUBT) / sqrt(MARGIN) + 1.0));
  ct_pool pool = {0};
  double **vectors[] = {&l.now, &l.before, &l.next, &l.u, &l.force};
  for (int i = 0; i < 5; i++) *vectors[i] = ct_pool_take(&pool, n, sizeof(double));
  l.diagonal = ct_pool_take(&pool, (size_t)l.rounds, sizeof(double));
  l.beside = ct_pool_take(&pool, (size_t)l.rounds, sizeof(double));
  void *scratch = NULL;
  ct_status status = pool.failed ? CT_NO_MEMORY(error, "the stable step") : CT_OK;
  if (status == CT_OK) status = solid->calls->create_scratch(solid, &scratch, error);
  l.view.displacement = l.u;
  l.view.scratch = scratch;
  if (status == CT_OK) status = recur(&l, error);
  // -- The largest eigenvalue found, and the margin (eq:assembled-bound)
  if (status == CT_OK) *omega_squared = largest(&l) / (1.0 - MARGIN);
  if (scratch != NULL) solid->calls->free_scratch(scratch);
  ct_pool_empty(&pool);
  return status;
}
