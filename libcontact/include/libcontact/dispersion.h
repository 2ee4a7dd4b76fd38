/* Dispersion of waves in a mesh of equal bricks with time steps: frequency and group velocity for
 * every wave vector, and the front of a stress step as the sum of such waves.
 * Threads: every call is safe at any time. */
#ifndef LIBCONTACT_DISPERSION_H
#define LIBCONTACT_DISPERSION_H

#include <libcontact/problem.h>

CT_BEGIN_DECLS

/** Kind of mass matrix. */
typedef enum ct_mass_form {
  /** diagonal, as in a run by default: row sum for hex8, HRZ for hex20, :eq:`hrz` */
  CT_MASS_LUMPED = 0,
  /** consistent, :eq:`mass-consistent` */
  CT_MASS_CONSISTENT = 1
  /* 2 was the averaged mass, which is gone: the next form is 3. */
} ct_mass_form;

/** An infinite mesh of equal rectangular bricks with edges along x, y, z, and a method of time
 * integration. Start from `ct_dispersion_def_default`. */
typedef struct ct_dispersion_def {
  /** Set by `ct_dispersion_def_default`. */
  int32_t cookie;
  /** Kind of the bricks. */
  ct_brick_kind kind;
  /** Lengths of their edges [length], > 0. */
  double size[3];
  /** Their material; small strain is assumed for every law. */
  ct_material material;
  /** Their mass matrix. */
  ct_mass_form mass;
  /** The method of the time steps; not used if `step` is 0. */
  ct_integrator integrator;
  /** Time step Δt [time]; 0: continuous time. */
  double step;
} ct_dispersion_def;

/** One branch of waves at one wave vector; `ct_dispersion` writes all members. */
typedef struct ct_branch {
  /** Frequency ω_h of the mesh in continuous time [1 / time], :eq:`bloch-problem`. */
  double omega_mesh;
  /** Frequency ω with the time steps, 0 ... π/Δt [1 / time], :eq:`dispersion-root`. */
  double omega;
  /** Decay rate δ of the amplitude e^(-δt) due to the time steps [1 / time]; negative above the
   * stable step. */
  double decay;
  /** Group velocity ∂ω/∂k [length / time], :eq:`group-velocity`; NaN where ω_h = 0. */
  double group[3];
  /**
   * Displacement amplitudes φ, shape (nodes, 3): node a of every brick moves with φ_a e^(i(k·x_a -
   * ωt)). The nodes are the corner and, for hex20, the middles of the edges along x, y, z; rows of
   * hex8 beyond the first are 0. Scaled to φ·M(k)φ = mass of a brick, so that φ is a unit vector
   * for long waves; the sign is arbitrary.
   */
  double shape[12];
} ct_branch;

/** Cubes of hex8 with edge 1, E = ρ = 1, ν = 0, lumped mass, central difference, and continuous
 * time. */
CT_API ct_dispersion_def ct_dispersion_def_default(void);

/**
 * Compute all branches at `count` wave vectors `wave`, shape (count, 3) [1 / length]. `branches`
 * has shape (count, 3) for hex8 and (count, 12) for hex20, ascending in `omega_mesh`. Where two
 * branches have the same frequency, their shapes are any two orthogonal ones of that frequency.
 *
 * Errors: ``CT_ERROR_ARGUMENT`` for a null pointer, a definition without its cookie, sizes that are
 * not positive, an invalid material, mass form or integrator, a negative step, or a wave vector
 * that is not finite (`error` has its number in `point`). `branches` is not written then.
 */
CT_API ct_status ct_dispersion(const ct_dispersion_def *def, size_t count, const double *wave,
                               ct_branch *branches, ct_error *error);

/**
 * Stress behind a step front, as the sum of all waves of the mesh, :eq:`front-sum`: a half-space
 * with the velocity -v0 n hits a rigid wall at t = 0 in the plane of nodes n·x = 0. The waves
 * beyond the wall are the mirror image, point by point, so the solution needs no boundary for
 * normals along other directions than the axes, too.
 *
 * `normal` are the whole numbers (p, q, r) of a plane of nodes, n along (p/h_x, q/h_y, r/h_z): (1,
 * 0, 0) along x, (1, 1, 0) at 45° for cubes; each at most 16. `time` [time] must be a whole number
 * of steps unless `step` is 0. `distance` are positions s = n·x of element centres [length], shape
 * (count,). `stress` gets σ_nn there divided by -ρ c1 v0, shape (count,): without dispersion it is
 * 1 behind s = c1 t and 0 ahead of it.
 *
 * Errors: as for `ct_dispersion`; also for a normal that is zero or too large, a negative time, a
 * time between two steps, a distance that is not finite, or a front that has passed more than 12
 * 000 planes of nodes.
 */
CT_API ct_status ct_dispersion_front(const ct_dispersion_def *def, const int32_t normal[3],
                                     double time, size_t count, const double *distance,
                                     double *stress, ct_error *error);

CT_END_DECLS

#endif
