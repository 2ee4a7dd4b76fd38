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
   * Penalty at the gaps of the coming step, which can only take energy away,
   * :eq:`energy-controlled`. Leaves the stable step as it is.
   */
  CT_ENFORCE_ENERGY_CONTROLLED,
  /** Penalty on gap and acceleration of the gap in a ratio that leaves the stable step as it is,
     :eq:`bipenalty`. */
  CT_ENFORCE_BIPENALTY,
  /**
   * Forward increment Lagrange multipliers: no gap of the coming step is negative,
   * :eq:`forward-increment`. Leaves the stable step as it is.
   */
  CT_ENFORCE_LAGRANGE
} ct_enforcement;

/** Name of an enforcement, "penalty", "energy_controlled", "bipenalty" or "lagrange"; null for
 * another number. */
CT_API const char *ct_enforcement_name(ct_enforcement enforcement);

/**
 * One point that may press in a step, as an effect lists it. The gap is g = Σ_a b_a n·x_a + what
 * does not move with nodes, and a force λ of the point puts λ b_a n on node a,
 * :eq:`constraint-force`.
 */
typedef struct ct_constraint {
  /** How the force follows from the gaps. */
  ct_enforcement enforcement;
  /** Stiffness k of the point [force / length], > 0. */
  double stiffness;
  /** Share s of the stiffness that acts at the end of the step, 0 ... 1 (energy-controlled
   * penalty), :eq:`energy-controlled`. */
  double dissipation;
  /** Number of the point in its effect. */
  int64_t point;
  /** Nodes of the point's own face: `node` and `b` 0 ... own - 1. */
  int32_t own;
  /** Nodes of the face that it meets: `node` and `b` 8 ... 8 + other - 1; 0 for an obstacle. */
  int32_t other;
  /** Places of the nodes in the effect's list. */
  int32_t node[16];
  /** Factors b_a: shape functions, those of the other face with a minus sign. */
  double b[16];
  /** Direction n in which the point is pushed, of length 1. */
  double normal[3];
  /** Gap g_n [length]. */
  double gap;
  /** What the gap gains until the next step because an obstacle moves [length]. */
  double moved;
  /** Gap g_{n-1} of the step before, along the same direction [length]; written by the solver. */
  double before;
  /** Gap g_{n+1} of the next step, along the same direction [length]; written by the solver. */
  double after;
  /** Force λ [force]; what it was in the last step when the effect lists it, then written by the
   * solver. */
  double force;
} ct_constraint;

/**
 * Force λ that the law of a constraint asks for if the next gap is `after` [force]. Lagrange
 * multipliers follow no such law: NaN.
 */
CT_API double ct_enforcement_force(const ct_constraint *constraint, double after);

/**
 * Force λ of a constraint that is alone: g_{n+1} = `free` + `mobility` λ, with the gap `free`
 * [length] that comes without it and `mobility` [length / force], and the law holds for this gap,
 * :eq:`enforcement-solution`.
 */
CT_API double ct_enforcement_solve(const ct_constraint *constraint, double free, double mobility);

/**
 * Energy that the constraint holds at t_n [energy], so that the sum with what the bodies hold never
 * grows, :eq:`controlled-energy`. What it stored in the last step is computed from `before`, as if
 * it had met the same nodes then.
 */
CT_API double ct_enforcement_energy(const ct_constraint *constraint);

CT_END_DECLS

#endif
