/* Contacts, obstacles and friction as effects of a problem.
 * Threads: effects may be created at any time. An effect is constant, so several states may use it
 * at the same time; one call at a time per state. */
#ifndef LIBCONTACT_CONTACT_EFFECT_H
#define LIBCONTACT_CONTACT_EFFECT_H

#include <libcontact/contact_result.h>
#include <libcontact/step.h>

CT_BEGIN_DECLS

/** A contact as an effect of a problem. Start from `ct_contact_def_default`. */
typedef struct ct_contact_def {
  /** Written by `ct_contact_def_default`. */
  int32_t cookie;
  /** Two surfaces, whose nodes and reference coordinates are the problem's; the same pointer twice
   * for the contact of a surface with itself. */
  const ct_surface *a, *b;
  /** Options of the contact. */
  ct_contact_options options;
} ct_contact_def;

/** Default options; the caller must set the surfaces and the penalty. */
CT_API ct_contact_def ct_contact_def_default(void);

/** The effect of a contact. The problem's masses and coordinates are not copied. */
CT_API ct_status ct_contact_create_effect(const ct_contact_def *def, const ct_problem *problem,
                                          ct_effect **effect, ct_error *error);

/**
 * The contact of an effect at the state's time, for `ct_contact_points`, `ct_contact_resultant` and
 * other calls that read a contact. The state owns it; the next step changes it. Null, with `error`
 * written, if the effect is not a contact.
 */
CT_API const ct_contact *ct_state_contact(const ct_problem *problem, ct_state *state,
                                          int32_t effect, ct_error *error);

/**
 * The effect of one obstacle. It stores the energy of the penalty; the work of its motion counts as
 * external. ``CT_ERROR_ARGUMENT``: penalty or radius not positive, no axis, no faces, node out of
 * range, amplitude not ascending, travel without an amplitude.
 */
CT_API ct_status ct_obstacle_create_effect(const ct_obstacle_def *def, const ct_problem *problem,
                                           ct_effect **effect, ct_error *error);

/**
 * Force of the bodies on an obstacle at the state's time [force], and the work of its motion on the
 * bodies since t = 0 [energy], :eq:`obstacle-work`. ``CT_ERROR_ARGUMENT``: effect number `effect`
 * is not an obstacle.
 */
CT_API ct_status ct_obstacle_reaction(const ct_problem *problem, ct_state *state, int32_t effect,
                                      double force[3], double *work, ct_error *error);

/**
 * Penetration of a surface into an obstacle at the state's time, by true distances, as
 * `ct_contact_penetration`; `side` is 0, or -1 when nothing is inside. ``CT_ERROR_ARGUMENT``: null
 * argument, unknown place, or effect number `effect` is not an obstacle.
 */
CT_API ct_status ct_obstacle_penetration(const ct_problem *problem, ct_state *state, int32_t effect,
                                         ct_penetration_at at, ct_penetration *out,
                                         ct_error *error);

/**
 * Tractions of an obstacle at the nodes of its surface, at the state's time, as
 * `ct_contact_traction`; `traction` [stress] has the shape (node_count, 3) and `area` [area] the
 * shape (node_count) of the problem.
 */
CT_API ct_status ct_obstacle_traction(const ct_problem *problem, ct_state *state, int32_t effect,
                                      double *traction, double *area, ct_error *error);

/** Tractions of friction on an obstacle at the nodes of its surface, as `ct_contact_friction`, and
 * what friction does there; `slip` has the shape (node_count) of the problem. */
CT_API ct_status ct_obstacle_friction(const ct_problem *problem, ct_state *state, int32_t effect,
                                      double *traction, int32_t *slip, ct_error *error);

/**
 * Contact pressure at the nodes of a problem at the state's time [stress], shape (node_count),
 * :eq:`recovered-traction`: the sum of the magnitudes of the tractions of all contacts and
 * obstacles at a node; 0 elsewhere.
 */
CT_API ct_status ct_state_pressure(const ct_problem *problem, ct_state *state, double *pressure,
                                   ct_error *error);

/** Coulomb friction with stick on the points of a contact or of an obstacle. Start from
 * `ct_friction_def_default`. */
typedef struct ct_friction_def {
  /** Written by `ct_friction_def_default`. */
  int32_t cookie;
  /**
   * The effect that friction acts on: one of `ct_contact_create_effect` or
   * `ct_obstacle_create_effect`. It must outlive the friction and precede it in the problem's list.
   */
  const ct_effect *on;
  /** Coefficient μ of friction, > 0. */
  double coefficient;
  /** Stiffness of the tangential spring over that of the point's penalty, > 0, :eq:`slip-law`. It
   * does not limit the step. */
  double tangent;
} ct_friction_def;

/** `tangent` is 1; the caller must set `on` and `coefficient`. */
CT_API ct_friction_def ct_friction_def_default(void);

/**
 * The effect of friction: tangential forces in stick and in slip, solved for together with the
 * normal forces, :eq:`slip-problem`. It does not change the stable step. In the energy balance its
 * stored energy is 0, and its work counts as external: minus the sum of its stored and its
 * dissipated energy. ``CT_ERROR_ARGUMENT``: `on` is not a contact or an obstacle, μ or `tangent`
 * not positive.
 */
CT_API ct_status ct_friction_create_effect(const ct_friction_def *def, const ct_problem *problem,
                                           ct_effect **effect, ct_error *error);

/**
 * Energy that friction stores at the state's time, `stored`, :eq:`slip-held`, and the energy that
 * it has dissipated since t = 0 [energy], :eq:`friction-dissipation`.
 */
CT_API ct_status ct_friction_energy(const ct_problem *problem, ct_state *state, int32_t effect,
                                    double *stored, double *dissipated, ct_error *error);

CT_END_DECLS

#endif
