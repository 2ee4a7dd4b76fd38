#ifndef CT_SRC_SUMS_H
#define CT_SRC_SUMS_H

#include "workspace.h"

/* The sums over the nodes of one body for a row of the energy balance. */
typedef struct ct_body_sums {
  double kinetic;    /* ½ v_{n-1/2} · M v_{n+1/2} (eq:discrete-energy) */
  double work;       /* twice the first effect's work over Δt (eq:work-sum) */
  double half_work;  /* energy stored by linear solids (eq:stored-by-forces) */
  double p[3], L[3]; /* momenta */
  double largest;    /* finite component of a displacement */
} ct_body_sums;

/* Compute them in one pass, after ct_workspace_forces. */
void ct_sum_body(const ct_problem *problem, const ct_state *state, int32_t body,
                 ct_body_sums *sums);

/* The sums over the nodes of one effect other than the first in one body. */
typedef struct ct_effect_sums {
  double work;       /* twice its work over Δt (eq:work-sum) */
  double impulse[3]; /* over Δt (eq:impulse-balance) */
} ct_effect_sums;

/* Compute them in one pass, after ct_workspace_forces. */
void ct_sum_effect(const ct_problem *problem, const ct_state *state, int32_t k, int32_t body,
                   ct_effect_sums *sums);

/* Number of grids that a workspace keeps for these sums. They change no bit: if one of the last row
 * fits again, the terms are computed once, not twice. */
size_t ct_sum_grids(const ct_problem *problem);

#endif
