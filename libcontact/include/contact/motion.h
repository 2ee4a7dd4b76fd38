#ifndef CONTACT_MOTION_H
#define CONTACT_MOTION_H

#include <contact/history.h>
#include <contact/step.h>

CT_BEGIN_DECLS

/** Components of a set of nodes whose displacement follows a history. */
typedef struct ct_motion {
  /** Node numbers of the problem, shape (node_count). */
  const int32_t *nodes;
  /** Number of nodes. */
  int32_t node_count;
  /** Which of x, y, z are prescribed (0 or 1). */
  int fixed[3];
  /** Displacement that the history multiplies [length]. */
  double displacement[3];
  /** Factor in time; at least one point. A jump is made within one step. */
  ct_history history;
} ct_motion;

/**
 * The effect "support" of all motions together, :eq:`motion-force`: a force that takes its nodes to
 * their place at t_{n+1}, against all other forces and their own inertia. It stores nothing; its
 * work stands in the ledger. Arrays are copied. It must be the last effect of the problem but for
 * supports, as it has to see the forces of all others; so a problem has at most one.
 * ``CT_ERROR_ARGUMENT``: no nodes, a component that two motions, or a motion and a support, hold;
 * ``CT_INVALID``: a number is not finite.
 */
CT_API ct_status ct_motion_create_effect(const ct_motion *motions, int32_t motion_count,
                                         const ct_problem *problem, ct_effect **effect,
                                         ct_error *error);

CT_END_DECLS

#endif
