/* Obstacles with mass: the nodes of a rigid body that carry an obstacle. */
#include "carrier.h"

#include <libcontact/base.h>

#include "../base/vector.h"

#include <math.h>
#include <string.h>

enum { NODES = CT_CARRIER_NODES };

/* Σ_k a_k b_k over the nodes, in any order. */
static double sum_over(const double *a, int stride_a, const double *b, int stride_b)
{
  double term[NODES];
  for (int k = 0; k < NODES; k++) term[k] = a[stride_a * k] * (b == NULL ? 1.0 : b[stride_b * k]);
  return ct_sum(term, NODES);
}

/* Centre, and the vectors q_k = J⁻¹ (x_k - c) with J = Σ (x_k - c)(x_k - c)ᵀ. Returns 0 if all
 * nodes lie in a plane. */
static int find_dual(double x[NODES][3], double centre[3], double q[NODES][3])
{
  static const double FLAT = 1e-12;
  double r[NODES][3], J[3][3], inverse[3][3];
  for (int c = 0; c < 3; c++) {
    centre[c] = sum_over(&x[0][c], 3, NULL, 0) / (double)NODES;
    for (int k = 0; k < NODES; k++) r[k][c] = x[k][c] - centre[c];
  }
  for (int c = 0; c < 3; c++)
    for (int d = c; d < 3; d++) J[c][d] = J[d][c] = sum_over(&r[0][c], 3, &r[0][d], 3);
  for (int c = 0; c < 3; c++) ct_vector_cross(J[(c + 1) % 3], J[(c + 2) % 3], inverse[c]);
  const double det = ct_vector_dot(J[0], inverse[0]), size = J[0][0] + J[1][1] + J[2][2];
  for (int k = 0; k < NODES; k++)
    // -- q_k = J⁻¹ (x_k - c) (eq:carrier-weights)
    for (int c = 0; c < 3; c++) q[k][c] = ct_vector_dot(inverse[c], r[k]) / det;
  return det > FLAT * (size * size * size);
}

int ct_carrier_init(ct_carrier *carrier, const double point[3])
{
  double centre[3], r[3];
  const int solid = find_dual(carrier->reference, centre, carrier->dual);
  for (int c = 0; c < 3; c++) r[c] = point[c] - centre[c];
  for (int k = 0; k < NODES; k++)
    carrier->point[k] = 1.0 / (double)NODES + ct_vector_dot(carrier->dual[k], r);
  return solid;
}

void ct_carrier_move(const ct_carrier *carrier, const ct_surface_motion *now, ct_carried *state,
                     double place[3])
{
  for (int k = 0; k < NODES; k++) {
    const int64_t at = 3 * (int64_t)carrier->place[k];
    memcpy(state->x[k], now->x == NULL ? carrier->reference[k] : &now->x[at], sizeof state->x[k]);
    memcpy(state->velocity[k], &now->velocity[at], sizeof state->velocity[k]);
  }
  (void)find_dual(state->x, state->centre, state->dual);
  state->before = now->before;
  for (int c = 0; c < 3; c++) {
    double from[NODES];
    for (int k = 0; k < NODES; k++) from[k] = state->x[k][c] - state->centre[c];
    // -- Where the obstacle is, how the body has turned, and how it moves (eq:carrier-motion)
    place[c] = state->centre[c] + sum_over(from, 1, carrier->point, 1);
    state->speed[c] = sum_over(&state->velocity[0][c], 3, NULL, 0) / (double)NODES;
    for (int d = 0; d < 3; d++) {
      state->turn[c][d] = sum_over(from, 1, &carrier->dual[0][d], 3);
      state->gradient[c][d] = sum_over(&state->velocity[0][c], 3, &state->dual[0][d], 3);
    }
  }
}

void ct_carrier_velocity(const ct_carried *state, const double x[3], double velocity[3])
{
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = x[c] - state->centre[c];
  for (int c = 0; c < 3; c++) velocity[c] = state->speed[c] + ct_vector_dot(state->gradient[c], r);
}

void ct_carrier_weigh(const ct_carried *state, const double r[3], double weights[NODES])
{
  // -- w_k = 1/8 + q_k · (x - c) (eq:carrier-weights)
  for (int k = 0; k < NODES; k++)
    weights[k] = 1.0 / (double)NODES + ct_vector_dot(state->dual[k], r);
}

void ct_carrier_react(const ct_carrier *carrier, const ct_carried *state, int32_t count,
                      const int32_t *place, const double *x, double *terms, double *force)
{
  for (int c = 0; c < 3; c++) {
    double sum[4];
    for (int d = 0; d < 4; d++) {
      for (int32_t n = 0; n < count; n++)
        terms[n] = force[3 * (int64_t)place[n] + c] *
                   (d == 3 ? 1.0 : x[3 * (int64_t)n + d] - state->centre[d]);
      sum[d] = ct_sum(terms, count);
    }
    for (int k = 0; k < NODES; k++)
      // -- -Σ_a w_k(x_a) f_a (eq:carrier-force)
      force[3 * (int64_t)carrier->place[k] + c] -=
          sum[3] / (double)NODES + ct_vector_dot(state->dual[k], sum);
  }
}
