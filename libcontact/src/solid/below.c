/* Test whether all eigenvalues of M⁻¹K of an element lie below a number, eight elements at a time.
 */
#include "below.h"

#include "../base/threads.h"
#include "../mesh/mesh_internal.h"

#include <string.h>

enum { ENTRIES = 60 * 61 / 2 };

/* Row i of the lower half of a matrix. */
CT_INLINE ct_lanes *row(ct_lanes *S, int i) { return S + i * (i + 1) / 2; }

/* Gradients of the shape functions at a point times det J, and the weight of the point over det J,
 * so that dV ∂N_a/∂x_i ∂N_b/∂x_j = weight g[a][i] g[b][j]. */
CT_INLINE void point_gradients(const ct_mass_shapes *at, int per, int q, const ct_lanes *x,
                               ct_lanes (*g)[3], ct_lanes *weight)
{
  ct_lanes J[3][3], C[3][3], det;
  ct_lanes_jacobian(per, at->dN[q], x, J, &det);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int p = (i + 1) % 3, r = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
      C[i][j] = J[p][s] * J[r][t] - J[p][t] * J[r][s];
    }
  for (int a = 0; a < per; a++)
    for (int i = 0; i < 3; i++) {
      const double *d = at->dN[q][a];
      g[a][i] = (d[0] * C[i][0] + d[1] * C[i][1]) + d[2] * C[i][2];
    }
  *weight = at->rule.weight[q] / det;
}

/* Load the elements from `e` on, centre them, and compute their masses. */
CT_INLINE void begin(const ct_solid_part *part, const ct_mass_shapes *at, int per, int32_t e,
                     ct_lanes *x, ct_lanes *mass)
{
  ct_lanes total, density;
  ct_part_constant(part, CT_DENSITY, part->material.density, e / 8, e % 8, &density);
  ct_load_lanes(part->mesh, NULL, e / 8, per, part->mesh->nodes, e % 8, x);
  ct_mass_lanes(at, x, &density, mass, &total);
}

/* The sum of the eigenvalues of each element, the trace of M⁻¹K, without the factor λ + 4 μ that
 * elements of one material have in common. */
CT_INLINE void find_trace(const ct_solid_part *part, const ct_mass_shapes *at, int per, int32_t e,
                          ct_lanes *trace)
{
  ct_lanes x[3 * 20], mass[20], g[20][3], weight, lambda, mu;
  begin(part, at, per, e, x, mass);
  *trace = x[0] - x[0];
  for (int q = 0; q < at->rule.count; q++) {
    point_gradients(at, per, q, x, g, &weight);
    for (int a = 0; a < per; a++)
      *trace += weight * ((g[a][0] * g[a][0] + g[a][1] * g[a][1]) + g[a][2] * g[a][2]) / mass[a];
  }
  if (part->constants == NULL) return;
  ct_part_constant(part, CT_LAMBDA, 0.0, e / 8, e % 8, &lambda);
  ct_part_constant(part, CT_MU, 0.0, e / 8, e % 8, &mu);
  *trace *= lambda + 4.0 * mu;
}

CT_CLONES_RARE
static void traces(const ct_solid_part *part, const ct_mass_shapes *at, int32_t e, ct_lanes *trace)
{
  if (at->per == 8) find_trace(part, at, 8, e, trace);
  else find_trace(part, at, 20, e, trace);
}

/* The element with the largest trace in the groups first ... last - 1, and that trace. */
static int32_t stiffest_of(const ct_solid_part *part, const ct_mass_shapes *at, int32_t first,
                           int32_t last, double *trace_of)
{
  int32_t stiffest = 0, count = part->mesh->element_count;
  double largest = 0.0;
  for (int32_t g = first, e = first * CT_LANES_COUNT; g < last; g++, e += CT_LANES_COUNT) {
    ct_lanes sums;
    double trace[CT_LANES_COUNT];
    traces(part, at, e, &sums);
    memcpy(trace, &sums, sizeof trace);
    for (int32_t l = 0; l < CT_LANES_COUNT && e + l < count; l++)
      if (trace[l] > largest) largest = trace[l], stiffest = e + l;
  }
  *trace_of = largest;
  return stiffest;
}

/* The first of equal ones. */
int32_t ct_solid_stiffest(const ct_solid_part *part, const ct_mass_shapes *at)
{
  int32_t stiffest = 0, count = part->mesh->element_count,
          groups = (count + CT_LANES_COUNT - 1) / CT_LANES_COUNT;
  double largest = 0.0;
  int threads = ct_threads_for(ct_threads_of(part->mesh->settings), count, CT_LEAST_OF_MESH);
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++) {
    double trace;
    int32_t e = stiffest_of(part, at, ct_share(groups, share, threads),
                            ct_share(groups, share + 1, threads), &trace);
#ifdef _OPENMP
#pragma omp critical
#endif
    if (trace > largest || (trace == largest && e < stiffest)) largest = trace, stiffest = e;
  }
  return stiffest;
}

/* S = ω² M - K, lower half: first the sums T_ab = ∫ ∂N_a/∂x_i ∂N_b/∂x_j dV in its place, then the
 * stiffness of these (eq:stiffness). */
CT_INLINE void fill(const ct_solid_part *part, const ct_mass_shapes *at, int per, int32_t e,
                    const int fixed[3], double omega_squared, ct_lanes *S)
{
  ct_lanes x[3 * 20], mass[20], g[20][3], weight, T[3][3], lambda, mu;
  begin(part, at, per, e, x, mass);
  ct_part_constant(part, CT_LAMBDA, part->lambda, e / 8, e % 8, &lambda);
  ct_part_constant(part, CT_MU, part->mu, e / 8, e % 8, &mu);
  for (int i = 0; i < 3 * per * (3 * per + 1) / 2; i++) S[i] = x[0] - x[0];
  for (int q = 0; q < at->rule.count; q++) {
    point_gradients(at, per, q, x, g, &weight);
    for (int i = 0; i < 3 * per; i++) {
      ct_lanes own = weight * g[i / 3][i % 3], *to = row(S, i);
      for (int j = 0; j <= i; j++) to[j] += own * g[j / 3][j % 3];
    }
  }
  for (int a = 0; a < per; a++)
    for (int b = 0; b <= a; b++) {
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          T[i][j] = a == b && j > i ? row(S, 3 * a + j)[3 * b + i] : row(S, 3 * a + i)[3 * b + j];
      ct_lanes trace = mu * ((T[0][0] + T[1][1]) + T[2][2]);
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < (a == b ? i + 1 : 3); j++) {
          ct_lanes K = lambda * T[i][j] + mu * T[j][i], *to = &row(S, 3 * a + i)[3 * b + j];
          if (i == j) K += trace;
          // A fixed component has no stiffness here, only its own mass.
          if (fixed[i] || fixed[j]) K = K - K;
          *to = -K;
          if (a == b && i == j) *to += omega_squared * mass[a];
        }
    }
}

/* Eliminate S = L D Lᵀ; bit l of the result is 1 if all pivots are positive, so that S is definite.
 */
CT_INLINE unsigned eliminate(int n, ct_lanes *S)
{
  unsigned definite = ~0u;
  ct_lanes column[60];
  for (int k = 0; k < n; k++) {
    double pivot[CT_LANES_COUNT];
    memcpy(pivot, &row(S, k)[k], sizeof pivot);
    // D_k > 0 (eq:definite)
    for (unsigned l = 0; l < CT_LANES_COUNT; l++) definite &= ~((unsigned)!(pivot[l] > 0.0) << l);
    ct_lanes inverse = 1.0 / row(S, k)[k];
    for (int i = k + 1; i < n; i++) {
      ct_lanes *own = row(S, i), factor = own[k] * inverse;
      column[i] = own[k];
      for (int j = k + 1; j <= i; j++) own[j] -= factor * column[j];
    }
  }
  return definite;
}

CT_CLONES_NODES
unsigned ct_solid_below(const ct_solid_part *part, const ct_mass_shapes *at, int32_t e,
                        const int fixed[3], double omega_squared)
{
  ct_lanes S[ENTRIES];
  if (at->per == 8) fill(part, at, 8, e, fixed, omega_squared, S);
  else fill(part, at, 20, e, fixed, omega_squared, S);
  return eliminate(3 * at->per, S);
}
