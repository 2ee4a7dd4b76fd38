#ifndef CT_SRC_WORKSPACE_H
#define CT_SRC_WORKSPACE_H

#include <libcontact/step.h>

#include "../base/grid.h"
#include "effect_internal.h"

/* What a state needs to take a step and a restart does not: forces at t_n and scratch space of the
 * effects. */
typedef struct ct_workspace {
  ct_pool pool;      /* its arrays */
  int64_t forces_at; /* the step whose forces stand below, or -1 */
  int starting;      /* v_{-1/2} is not known yet */
  double start_dt;   /* Δt of the problem when the first forces were made */
  int stage;         /* of the step, 0 or 1: the next one whose forces are made */
  int followed;      /* whether the state was moved by one stage since the forces were made, and by
                        nothing else: what sleeps is known (eq:wake) */
  int known;         /* whether what sleeps is still what it was when these forces were made */
  int seen;          /* whether an effect of a host may look at all nodes */
  struct ct_sleep *sleep; /* which elements sleep; the first effect's, null where none may */
  double *total;          /* sum of all forces but reactions, shape (node_count, 3) */
  double **force; /* of each effect: on its own nodes; null for the first one (in `total`) and for
                     reactions */
  void **scratch; /* of each effect */
  double *next_memory;
  int32_t
      shared_count; /* shared nodes, those on which more than the first effect acts, ascending */
  int32_t *shared;
  double *shared_first; /* force of the first effect there, shape (shared_count, 3) */
  double *shared_velocity,
      *shared_work; /* v_{n-1/2} and the first effect's work there, before the step */
  double *past;     /* acceleration of the evaluation before, shape (node_count, 3), where the state
                       does not keep it; or null */
  double *pushed, *pushed_force; /* of the pushforward, shape (node_count, 3), or null */
  void *pushed_scratch;
  ct_grid *grids;  /* of the sums that a row of the ledger was made of last (ct_sum_grids) */
  double *addends; /* room for sums over the bodies, shape (3, body_count) */
  struct ct_constraints *constraints; /* null without any */
} ct_workspace;

/* A state of zeros without a workspace: all that a restart needs, to be copied into and from. It is
 * to be freed also when this fails. */
ct_status ct_state_allocate(const ct_problem *problem, ct_state **state, ct_error *error);

/* Give a state its workspace, unless it has one; then it can be stepped and asked for its energy.
 */
ct_status ct_state_equip(ct_state *state, ct_error *error);

/* A new state with the initial displacement and velocity and the forces of these: the beginning of
 * ct_state_create, for which any Δt of the problem will do, and enough to ask for the stable step.
 */
ct_status ct_state_begin(const ct_problem *problem, ct_state **state, ct_error *error);

/* The rest of ct_state_create, with the Δt that the problem has by now. */
ct_status ct_state_finish(const ct_problem *problem, ct_state *state, ct_error *error);

/* Make the forces at the state's time, unless they stand already. */
ct_status ct_workspace_forces(const ct_problem *problem, ct_state *state, ct_error *error);

/* Who is shown each state with its forces, before the state is moved. */
typedef struct ct_sampler {
  void (*take)(void *data, const ct_state *state);
  void *data;
} ct_sampler;

/* ct_step_many, with a sampler. */
ct_status ct_step_sampled(const ct_problem *problem, ct_state *state, int64_t count,
                          const ct_sampler *sampler, ct_error *error);

/* Begin a series of steps, in which nobody else changes the state; `unchanged` says that nobody has
 * since the forces that stand were made in the series before. */
void ct_series_begin(ct_state *state, int unchanged);

/* Steps within a series, as ct_step_many takes them; `sampler` may be null. */
ct_status ct_series_steps(const ct_problem *problem, ct_state *state, int64_t count,
                          const ct_sampler *sampler, ct_error *error);

/* End a series: its host may now read and change the state. */
void ct_series_end(ct_state *state);

/* Name the first node whose motion is out of the range of numbers (CT_ERROR_BLOWUP). */
ct_status ct_check_finite(const ct_problem *problem, const ct_state *state, ct_error *error);

/* The present stage as times: τΔt, cΔt, rΔt, lΔt (eq:stage). */
static inline ct_stage ct_stage_now(const ct_problem *problem, const ct_state *state)
{
  ct_stage stages[2];
  ct_integrator_stages(&problem->integrator, stages);
  ct_stage s = stages[state->workspace->stage];
  return (ct_stage){s.tau * problem->dt, s.c * problem->dt, s.r * problem->dt, s.l * problem->dt};
}

/* Acceleration of the evaluation before, shape (node_count, 3); null for an integrator without any
 * use for it. */
double *ct_stage_past(const ct_problem *problem, const ct_state *state);

/* Fails for a state whose last step ended after its first stage. */
ct_status ct_stage_check(const ct_state *state, ct_error *error);

/* What effect `k` is shown of a state. */
ct_view ct_workspace_view(const ct_problem *problem, const ct_state *state, int32_t k);

/* Velocity of one degree of freedom after a kick of this time (eq:leapfrog, eq:stage). */
static inline double ct_kick(double v, double dt, double inverse_mass, double force)
{
  return v + dt * inverse_mass * force;
}

/* Force of effect `k` on its i-th node, after ct_workspace_forces; that of a reaction is minus the
 * total on held degrees of freedom (eq:reaction). */
void ct_workspace_force_at(const ct_problem *problem, const ct_state *state, int32_t k, int32_t i,
                           double force[3]);

/* Work and impulses that count only the part of the first forces that comes after t = 0
 * (eq:leapfrog-start), from the forces that stand. */
void ct_state_start_ledgers(const ct_problem *problem, ct_state *state);

/* A bit a node at t = 0: the force of a constraint begins there, and with it all others
 * (eq:energy-start); null later on, and without constraints. */
const uint64_t *ct_workspace_begun(const ct_state *state);

/* Shortest edge of all bodies. */
double ct_problem_edge(const ct_problem *problem);

/* Whether the stiffness of all bodies stays what it is. */
int ct_problem_is_linear(const ct_problem *problem);

/* v_n at the nodes first ... end - 1, shape (end - first, 3), after ct_workspace_forces. */
void ct_mean_velocity(const ct_problem *problem, const ct_state *state, int32_t first, int32_t end,
                      double *velocity);

/* Share f of Δt by which the force at t_n completes the velocity there, v_n = v + f Δt a_n
 * (eq:stage-velocity). */
double ct_integrator_share(const ct_integrator *integrator);

/* Upper bound of the largest ω² of all bodies together, held as they are [1 / time²]
 * (eq:assembled-bound): Lanczos' method from a random start, which is the same in every call, with
 * a margin of 6 %; for one start in 10¹² it is too low. ``CT_ERROR_UNSUPPORTED``: a body is not
 * linear. */
ct_status ct_stable_assembled(const ct_problem *problem, ct_state *state, double *omega_squared,
                              ct_error *error);

/* Where effect `k` begins in the state's `work`, `impulse` and `memory`; behind the last effect:
 * how many numbers they have of all effects. */
typedef struct ct_starts {
  int64_t work, impulse, memory;
} ct_starts;
ct_starts ct_state_starts(const ct_problem *problem, int32_t k);

/* Largest stable Δt [time] for the sums `omega_squared` of ω² [1 / time²] and `rate` of the damping
 * rates [1 / time], eq:integrator-damped-bound. */
double ct_integrator_step(const ct_integrator *integrator, double omega_squared, double rate);

#endif
