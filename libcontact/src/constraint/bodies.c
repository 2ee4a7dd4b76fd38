/* Rigid bodies in the matrix of the constraints. */
#include "bodies.h"

#include "../base/vector.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE };

ct_bodies *ct_bodies_create(ct_solver *solver, int32_t count, const int32_t *of)
{
  ct_pool *pool = &solver->pool;
  const size_t nodes = (size_t)solver->node_count, bodies = (size_t)count;
  ct_bodies *b = ct_pool_take(pool, 1, sizeof *b);
  if (b == NULL) return NULL;
  b->count = count;
  b->node_count = solver->node_count;
  b->translation = ct_pool_take(pool, bodies, sizeof *b->translation);
  b->rotation = ct_pool_take(pool, bodies, sizeof *b->rotation);
  b->most = ct_pool_take(pool, bodies, sizeof *b->most);
  b->push = ct_pool_take(pool, bodies, sizeof *b->push);
  b->sum = ct_pool_take(pool, bodies, sizeof *b->sum);
  b->of = ct_pool_copy(pool, of, nodes * sizeof *of);
  b->arm = ct_pool_take(pool, nodes, 3 * sizeof *b->arm);
  b->first = ct_pool_take(pool, bodies + 1, sizeof *b->first);
  b->filled = ct_pool_take(pool, bodies, sizeof *b->filled);
  b->terms = ct_pool_take(pool, nodes, 6 * sizeof *b->terms);
  for (size_t n = 0; !pool->failed && n < nodes; n++)
    if (of[n] >= 0) b->first[of[n] + 1]++;
  for (int32_t k = 0; !pool->failed && k < count; k++) b->first[k + 1] += b->first[k];
  return b;
}

void ct_bodies_bound(ct_bodies *b)
{
  for (int32_t k = 0; k < b->count; k++) {
    const double *A = b->translation[k];
    b->most[k] = fmax(fmax(A[0], A[1]), A[2]);
  }
}

/* Sum the terms of each body, independent of their order. */
static void sum_terms(ct_bodies *b, int components)
{
  for (int32_t k = 0; k < b->count; k++)
    for (int c = 0; c < components; c++)
      b->push[k][c] = ct_sum(&b->terms[(int64_t)b->node_count * c + b->first[k]], b->filled[k]);
}

void ct_bodies_push(ct_bodies *b, int32_t count, const int32_t *place, const double *normal,
                    const double *sums)
{
  memset(b->filled, 0, (size_t)b->count * sizeof *b->filled);
  for (int32_t i = 0; i < count; i++) {
    const int32_t k = b->of[place[i] / WIDE];
    const double *sum = &sums[place[i]], *r = &b->arm[3 * (int64_t)(place[i] / WIDE)];
    if (k < 0) continue;
    double f[3], moment[3], *term = &b->terms[b->first[k] + b->filled[k]++];
    for (int c = 0; c < 3; c++) f[c] = normal == NULL ? sum[c] : sum[3] * normal[c];
    // -- Force and moment on the body (eq:rigid-mobility)
    ct_vector_cross(r, f, moment);
    for (int c = 0; c < 3; c++) {
      term[(int64_t)b->node_count * c] = f[c];
      term[(int64_t)b->node_count * (3 + c)] = moment[c];
    }
  }
  sum_terms(b, 6);
}

void ct_bodies_move(const ct_bodies *b, int32_t count, const int32_t *place, const double *normal,
                    double *moved)
{
  for (int32_t i = 0; i < count; i++) {
    const int32_t k = b->of[place[i] / WIDE];
    if (k < 0) continue;
    const double *R = b->rotation[k], *f = b->push[k], *m = f + 3;
    const double turn[3] = {(R[0] * m[0] + R[3] * m[1]) + R[5] * m[2],
                            (R[1] * m[1] + R[4] * m[2]) + R[3] * m[0],
                            (R[2] * m[2] + R[5] * m[0]) + R[4] * m[1]};
    double *to = &moved[place[i]];
    ct_vector_cross(turn, &b->arm[3 * (int64_t)(place[i] / WIDE)], to);
    // -- Its motion at the node, Δt² (F / M + (Θ⁻¹ T) × r) (eq:rigid-mobility)
    for (int c = 0; c < 3; c++) to[c] += b->translation[k][c] * f[c];
    to[3] = normal == NULL ? 0.0 : ct_vector_dot(normal, to);
  }
}

/* Bound η of what the turn of body `k` moves a node by a unit force on it: η² is the sum of
 * (r × e) · Θ⁻¹ (r × e) over the three axes e. */
static double turn_of(const ct_bodies *b, int32_t k, int32_t node)
{
  const double *r = &b->arm[3 * (int64_t)node], *R = b->rotation[k], x = r[0] * r[0],
               y = r[1] * r[1], z = r[2] * r[2];
  const double twice = (R[3] * (r[0] * r[1]) + R[4] * (r[1] * r[2])) + R[5] * (r[2] * r[0]);
  // -- η (eq:rigid-mobility-bound)
  return sqrt(((R[0] * (y + z) + R[1] * (z + x)) + R[2] * (x + y)) - 2.0 * twice);
}

void ct_bodies_push_sizes(ct_bodies *b, int32_t count, const int32_t *place, const double *sums)
{
  memset(b->filled, 0, (size_t)b->count * sizeof *b->filled);
  for (int32_t i = 0; i < count; i++) {
    const int32_t node = place[i] / WIDE, k = b->of[node];
    if (k < 0) continue;
    double *term = &b->terms[b->first[k] + b->filled[k]++];
    term[0] = sums[place[i] + 3];
    term[b->node_count] = turn_of(b, k, node) * sums[place[i] + 3];
  }
  sum_terms(b, 2);
}

void ct_bodies_move_sizes(const ct_bodies *b, int32_t count, const int32_t *place, double *moved)
{
  for (int32_t i = 0; i < count; i++) {
    const int32_t node = place[i] / WIDE, k = b->of[node];
    if (k < 0) continue;
    // -- No longer than Δt² (Σ |f| / M + η Σ η |f|) (eq:rigid-mobility-bound)
    moved[place[i] + 3] = b->most[k] * b->push[k][0] + turn_of(b, k, node) * b->push[k][1];
  }
}
