#ifndef CT_SRC_WORKSPACE_H
#define CT_SRC_WORKSPACE_H

#include <libcontact/observe.h>

#include "../base/grid.h"
#include "effect_internal.h"

/* The row of a problem's integrator. */
static inline const ct_scheme_facts *ct_scheme_of(const ct_problem *problem)
{
  return ct_integrator_facts(problem->integrator.scheme);
}

/* The time of the run's clock [seconds]; without a clock always 0. */
static inline double ct_run_seconds(const ct_problem *problem)
{
  return problem->settings.clock == NULL ? 0.0 : problem->settings.clock();
}

/* Number of nodes that are moved together, in one piece. */
enum { CT_MOVED = 256 };

/* Data of a state for steps that a restart does not need: forces at t_n and scratch space of the
 * effects. */
typedef struct ct_workspace {
  ct_pool pool;      /* its arrays */
  int64_t forces_at; /* the step of the forces below, or -1 */
  int starting;      /* v_{-1/2} is not known yet */
  double start_dt;   /* Δt of the problem at the first evaluation of the forces */
  int stage;         /* of the step, 0 or 1: the next one to be evaluated */
  int followed;  /* whether one stage, and nothing else, has moved the state since the forces were
                    computed: the sleeping elements are known (eq:wake) */
  int known;     /* whether the sleeping elements are those of these forces */
  int unchanged; /* an observer knows that the state is as its last call left it */
  int leapfrog;  /* whether the integrator is the leapfrog: no acceleration before */
  int seen;      /* whether an effect of a host may read all nodes */
  struct ct_piece *piece; /* of a state that is a piece; else null */
  struct ct_sleep *sleep; /* sleeping elements; the first effect's, null if none may sleep */
  double *total;          /* sum of all forces except reactions, shape (node_count, 3) */
  double **force; /* of each effect: on its own nodes; null for the first one (in `total`) and for
                     reactions */
  void **scratch; /* of each effect */
  double *memory, *next_memory; /* what the effects read and write: the state's memory and a block
                                   of the workspace, which take turns in a series of steps */
  int continued; /* whether `memory` is what the effects wrote in the last evaluation, within a
                    series of steps */
  int32_t shared_count; /* shared nodes, on which more than the first effect acts, ascending */
  int32_t *shared;
  double *shared_first; /* force of the first effect there, shape (shared_count, 3) */
  int32_t **places; /* for each effect, except reactions: how many of its nodes are below the first
                       one of each piece, and of all; for the first effect, of the shared nodes */
  double *last_acceleration; /* acceleration of the last evaluation, shape (node_count, 3); null if
                   the state stores it, and for the leapfrog */
  ct_grid *grids;            /* of the sums for the last row of the energy balance (ct_sum_grids) */
  double *addends;           /* memory for sums over the bodies, shape (3, body_count) */
  struct ct_constraints *constraints; /* null if there are none */
} ct_workspace;

/* A piece: the nodes first ... last - 1, among which are the shared nodes at the places
 * shared_first
 * ... shared_last - 1. */
typedef struct ct_moved {
  int32_t first, last, shared_first, shared_last;
} ct_moved;

static inline int32_t ct_moved_count(const ct_problem *problem)
{
  return (problem->node_count - 1) / CT_MOVED + 1;
}

static inline ct_moved ct_moved_piece(const ct_problem *problem, const ct_workspace *w, int32_t p)
{
  int32_t first = CT_MOVED * p, left = problem->node_count - first;
  return (ct_moved){first, left < CT_MOVED ? problem->node_count : first + CT_MOVED,
                    w->places[0][p], w->places[0][p + 1]};
}

/* A state of zeros without a workspace: all data of a restart, to be copied into and from. Free it
 * also if this fails. */
ct_status ct_state_allocate(const ct_problem *problem, ct_state **state, ct_error *error);

/* Give a state its workspace, unless it has one; then it can take steps and its energy can be
 * computed. */
ct_status ct_state_equip(ct_state *state, ct_error *error);

/* A new state with the initial displacement and velocity and their forces: the first part of
 * ct_state_create, for which any Δt of the problem will do, and sufficient for the stable step. */
ct_status ct_state_begin(const ct_problem *problem, ct_state **state, ct_error *error);

/* The rest of ct_state_create, with the final Δt of the problem. */
ct_status ct_state_finish(const ct_problem *problem, ct_state *state, ct_error *error);

/* Compute the forces at the state's time, unless they are known. */
ct_status ct_workspace_forces(const ct_problem *problem, ct_state *state, ct_error *error);

/* The observers of a run. */
typedef struct ct_observers {
  const ct_observer *list;
  int32_t count;
} ct_observers;

/* Begin a series of steps, in which no other code changes the state; `unchanged` says that none has
 * since the last forces of the series before. */
void ct_series_begin(ct_state *state, int unchanged);

/* Steps within a series; `samplers` are the observers if one of them samples, else null. */
ct_status ct_series_steps(const ct_problem *problem, ct_state *state, int64_t count,
                          const ct_observers *samplers, ct_error *error);

/* End a series: its host may now read and change the state. */
void ct_series_end(ct_state *state);

/* The error of a run or of a check, with time and body; what a host's function left out is known
 * from the status. Returns `status`. */
ct_status ct_run_complete(const ct_problem *problem, const ct_state *state, ct_status status,
                          const ct_error *own, ct_error *error);

/* Report the first node whose motion is not finite (CT_ERROR_BLOWUP). */
ct_status ct_check_finite(const ct_problem *problem, const ct_state *state, ct_error *error);

/* The present stage as times: τΔt, cΔt, rΔt, lΔt (eq:stage). */
static inline ct_stage ct_stage_now(const ct_problem *problem, const ct_state *state)
{
  ct_stage stages[2];
  ct_integrator_stages(&problem->integrator, stages);
  ct_stage s = stages[state->workspace->stage];
  return (ct_stage){s.tau * problem->dt, s.c * problem->dt, s.r * problem->dt, s.l * problem->dt};
}

/* Acceleration of the last evaluation, shape (node_count, 3); null for the leapfrog. */
double *ct_stage_last_acceleration(const ct_problem *problem, const ct_state *state);

/* Fails for a state whose last step ended after its first stage. */
ct_status ct_stage_check(const ct_state *state, ct_error *error);

/* Number of the effect that effect `k` reads, an earlier one; -1: none. */
int32_t ct_workspace_read_by(const ct_problem *problem, int32_t k);

/* The view of a state for effect `k`. */
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

/* Work and impulses that include only the part of the first forces after t = 0 (eq:leapfrog-start),
 * from the known forces. */
void ct_state_start_ledgers(const ct_problem *problem, ct_state *state);

/* One bit per node at t = 0: a force of a constraint begins there, and all other forces with it
 * (eq:energy-start); null later, and without constraints. */
const uint64_t *ct_workspace_begun(const ct_state *state);

/* Shortest edge of all bodies. */
double ct_problem_edge(const ct_problem *problem);

/* Whether the stiffness of all bodies is constant. */
int ct_problem_is_linear(const ct_problem *problem);

/* v_n at the nodes first ... end - 1, shape (end - first, 3), after ct_workspace_forces. */
void ct_mean_velocity(const ct_problem *problem, const ct_state *state, int32_t first, int32_t end,
                      double *velocity);

/* Fraction f of Δt by which the force at t_n completes the velocity, v_n = v + f Δt a_n
 * (eq:stage-velocity). */
double ct_integrator_share(const ct_integrator *integrator);

/* Upper bound on the largest ω² of all bodies together with their supports [1 / time²]
 * (eq:assembled-bound): Lanczos' method from a random start, which is the same in every call, with
 * a margin of 6 %; for one start in 10¹² it is too low. ``CT_ERROR_UNSUPPORTED``: a body is not
 * linear. */
ct_status ct_stable_assembled(const ct_problem *problem, ct_state *state, double *omega_squared,
                              ct_error *error);

/* Begin of effect `k` in the state's `work`, `impulse` and `memory`; after the last effect: their
 * total numbers. */
typedef struct ct_starts {
  int64_t work, impulse, memory;
} ct_starts;
ct_starts ct_state_starts(const ct_problem *problem, int32_t k);

/* Largest stable Δt [time] for the sums `omega_squared` of ω² [1 / time²] and `rate` of the damping
 * rates [1 / time], eq:integrator-damped-bound. */
double ct_integrator_step(const ct_integrator *integrator, double omega_squared, double rate);

#endif
