/* Laws of contact enforcement, and one row of the constraint problem of a step.
 * Threads: plain data. */
#ifndef LIBCONTACT_CONSTRAINT_H
#define LIBCONTACT_CONSTRAINT_H

#include <libcontact/base.h>

CT_BEGIN_DECLS

/** How the contact force of a point in step n follows from its gaps, :doc:`/theory/enforcement`. */
typedef enum ct_enforcement {
  /** Explicit penalty k⟨-g_n⟩, :eq:`contact-penalty`. It reduces the stable step and can add energy
     to the bodies. */
  CT_ENFORCE_PENALTY,
  /**
   * Penalty on the gaps of the previous and the next step, :eq:`energy-controlled`. Without
   * dissipation it conserves energy while contact lasts; it does not add any where gaps are linear
   * in the motion. The stable step does not change.
   */
  CT_ENFORCE_ENERGY_CONTROLLED,
  /** One past the largest number; it grows with later versions. The next law has the number 3,
     because 2 was the bipenalty of version 0.1. */
  CT_ENFORCE_COUNT
} ct_enforcement;

struct ct_slip;

/**
 * What a row stores from step to step besides its force, zero for a new row. The solver writes it;
 * the effect that lists the row keeps it, also in a restart file.
 */
typedef struct ct_impact {
  /** Energy K that closing took from the bodies and opening gives back, :eq:`impact-reserve`. */
  double reserve;
  /** Time from closing to the last step with a force [time]. */
  double pressed;
  /** Time since then [time]; 0 if that was long ago. */
  double idle;
  /** Energy of the row at the middle of the last step [energy], :eq:`controlled-store`. */
  double stored;
  /** Part of the force that gives back the reserve [force], :eq:`release-ramp`. */
  double release;
} ct_impact;

/**
 * One row of the constraint problem: a point that may have a contact force in the next step. Its
 * gap is g = Σ_a N_a n·x_a - Σ_b N̄_b n·x_b + terms that do not depend on the nodes. A force λ of
 * the point applies λ N_a n to node a of its own face and -λ N̄_b n to node b of the other,
 * :eq:`constraint-force`.
 */
typedef struct ct_constraint {
  /** How the force follows from the gaps. */
  ct_enforcement enforcement;
  /** Nodes of the point's own face, at most 8. */
  int32_t own_count;
  /** Nodes of the other face, at most 8; 0 for an obstacle. */
  int32_t other_count;
  /** Nodes of its own face, as indices into the effect's list of nodes, shape (own_count). */
  const int32_t *own;
  /** Nodes of the other face, as indices into the same list, shape (other_count). */
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
  /** Share of the energy lost at closing that comes back at opening, 0 ... 1,
   * :eq:`impact-reserve`. */
  double restitution;
  /** Travel time h / c₁ through an element at the surface [time]; > 0 if `restitution` is. */
  double travel_time;
  /** Unit vector n, the direction of the force on the point. */
  double normal[3];
  /** Gap g_n [length]. */
  double gap;
  /** Change of the gap until the next step due to the motion of an obstacle [length]. */
  double moved;
  /** The same change since the previous step [length]. */
  double came;
  /** Coefficient a of the dashpot [-], :eq:`surface-damping`; written by the solver. */
  double dashpot;
  /** Gap g_{n-1} of the previous step, along the same direction [length]; written by the solver. */
  double before;
  /** Gap g_{n+1} of the next step, along the same direction [length]; written by the solver. */
  double after;
  /** Force λ [force]. The effect that lists the row writes the force of the last step; the solver
   * replaces it with the new one. */
  double force;
  /** Memory of the last step; the solver replaces it, too. */
  ct_impact impact;
  /** Friction of the point, which only the library's own effects can add; null: none. */
  struct ct_slip *slip;
} ct_constraint;

CT_END_DECLS

#endif
