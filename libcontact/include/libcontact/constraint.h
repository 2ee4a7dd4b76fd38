/* What can be chosen of the solver that keeps the gaps of all contacts of a step.
 * Threads: plain data. */
#ifndef LIBCONTACT_CONSTRAINT_H
#define LIBCONTACT_CONSTRAINT_H

#include <libcontact/base.h>

CT_BEGIN_DECLS

/** How contact keeps two bodies apart: which gap gives the force of a point in step n,
 * :doc:`/theory/enforcement`. */
typedef enum ct_enforcement {
  /** Explicit penalty k⟨-g_n⟩, :eq:`contact-penalty`. It limits the step, and can feed energy into
     the bodies. */
  CT_ENFORCE_PENALTY,
  /**
   * Penalty at the gaps of the steps before and after, which keeps energy while contact lasts and
   * never makes any, :eq:`energy-controlled`. Leaves the stable step as it is.
   */
  CT_ENFORCE_ENERGY_CONTROLLED,
  /** Penalty on gap and acceleration of the gap in a ratio that leaves the stable step as it is,
     :eq:`bipenalty`. */
  CT_ENFORCE_BIPENALTY
} ct_enforcement;

/**
 * One row of the constraint problem: a point that may have a contact force in the coming step. The
 * gap is g = Σ_a N_a n·x_a - Σ_b N̄_b n·x_b + what does not move with nodes; a force λ of the point
 * puts λ N_a n on node a of its own face and -λ N̄_b n on node b of the other,
 * :eq:`constraint-force`.
 */
typedef struct ct_constraint {
  /** How the force follows from the gaps. */
  ct_enforcement enforcement;
  /** Nodes of the point's own face, at most 8. */
  int32_t own_count;
  /** Nodes of the face that it meets, at most 8; 0 for an obstacle. */
  int32_t other_count;
  /** Nodes of its own face, as places in the effect's list of nodes, shape (own_count). */
  const int32_t *own;
  /** Nodes of the other face, likewise, shape (other_count). */
  const int32_t *other;
  /** Shape functions N_a, shape (own_count). */
  const double *own_shape;
  /** Shape functions N̄_b at the closest point, shape (other_count). */
  const double *other_shape;
  /** Stiffness k of the point [force / length], > 0. */
  double stiffness;
  /** Damping ratio ζ of the surface mode, 0 ... 1 (energy-controlled penalty),
   * :eq:`surface-damping`. */
  double dissipation;
  /** Direction n in which the point is pushed, of length 1. */
  double normal[3];
  /** Gap g_n [length]. */
  double gap;
  /** What the gap gains until the next step because an obstacle moves [length]. */
  double moved;
  /** What the gap has gained so since the step before [length]. */
  double came;
  /** Share a of the dashpot, :eq:`surface-damping`; written by the solver. */
  double dashpot;
  /** Gap g_{n-1} of the step before, along the same direction [length]; written by the solver. */
  double before;
  /** Gap g_{n+1} of the next step, along the same direction [length]; written by the solver. */
  double after;
  /** Force λ [force]; that of the last step when the effect lists the row, then written by the
   * solver. */
  double force;
} ct_constraint;

CT_END_DECLS

#endif
