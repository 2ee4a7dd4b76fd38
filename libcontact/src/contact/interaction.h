#ifndef CT_SRC_INTERACTION_H
#define CT_SRC_INTERACTION_H

#include <libcontact/constraint.h>

/* What an interaction sees of the bodies: the nodes of its surfaces at t_n. Arrays have a row for
 * each node of the interaction's list. */
typedef struct ct_surface_motion {
  double time;            /* t_n */
  double before;          /* Δt of the step that led here; 0: none */
  double dt;              /* of the next step; 0: not known yet */
  int threads;            /* results do not depend on it */
  int first;              /* whether nothing was stored yet; the interactions set it */
  const double *x;        /* x_n, shape (node_count, 3) */
  const double *velocity; /* v_{n-1/2}, shape (node_count, 3) */
  const double *memory;   /* what the interaction stored in the last step, shape (memory_count) */
  double *next_memory;    /* where it stores what the next step needs */
  int continued;          /* whether the state still has what it stored there, unchanged */
  void *on;               /* of friction: the state of the interaction that it acts on */
} ct_surface_motion;

/* Masses of the nodes of an interaction: node n has value[place[n]], or value[n] if `place` is
 * null. */
typedef struct ct_masses {
  const double *value;
  const int32_t *place;
} ct_masses;

static inline double ct_mass_at(ct_masses mass, int32_t n)
{
  return mass.value[mass.place == NULL ? n : mass.place[n]];
}

/* Energies of an interaction at t_n, and the force on an obstacle. */
typedef struct ct_interaction_energy {
  double stored;
  double reserve;     /* the part of it that points hold until they open (eq:impact-reserve) */
  double dissipated;  /* by friction since t = 0 */
  double removal;     /* work of fading start gaps since t = 0 */
  double motion;      /* work of a moving obstacle since t = 0 */
  double reaction[3]; /* force of the bodies on it */
} ct_interaction_energy;

struct ct_interaction;

/* What every interaction can do: a contact, an obstacle, and friction on one of them. A state
 * belongs to one time loop. */
typedef struct ct_interaction_calls {
  void (*free)(struct ct_interaction *interaction);
  ct_status (*open)(const struct ct_interaction *interaction, void **state, ct_error *error);
  void (*close)(void *state);
  /* Find the gaps of all points, from the memory of the last step; null for friction. */
  ct_status (*place)(void *state, const ct_surface_motion *now, ct_error *error);
  /* List the rows that may be active, after `place`; returns their number. Friction adds its law to
   * the rows of `on`, which are listed before. */
  int64_t (*list_rows)(void *state, const ct_surface_motion *now, ct_constraint **rows);
  /* Write the forces on the nodes, shape (node_count, 3), after the rows are solved, or for the
   * explicit penalty after `place`; and the memory for the next step. */
  ct_status (*find_forces)(void *state, const ct_surface_motion *now, double *force,
                           ct_error *error);
  /* Energies, after `find_forces`; in pieces they are asked for in all of them. */
  void (*find_energy)(void *state, ct_interaction_energy *energy);
  /* Count the work of the forces in `memory`, which held that of the last step, if the step is
   * divided to this part (eq:divided-work). Null for friction. */
  void (*divide)(const void *state, double part, double *memory);
  /* Bound of ω² of all points as springs (eq:contact-bound). Null for friction. */
  ct_status (*find_springs)(const void *state, ct_masses mass, double *omega2);
} ct_interaction_calls;

/* Constant data of an interaction: the first member of those of its kind. */
typedef struct ct_interaction {
  const ct_interaction_calls *calls;
  const int32_t *nodes; /* numbers in the arrays of the surfaces, ascending */
  int32_t node_count;
  const struct ct_interaction *on; /* of friction: the contact or obstacle that it acts on */
  int explicit;         /* whether forces follow from the gaps of now, which limits the step */
  int64_t row_count;    /* most rows; 0 if `explicit`, and for friction unless `on` is explicit */
  int32_t row_nodes;    /* most nodes of a row */
  int64_t slip_count;   /* of friction: most rows to which it adds its law */
  int64_t memory_count; /* doubles; it begins with the records of the points */
  int64_t point_memory; /* doubles of such a record */
  int64_t end_record;   /* end of the records of points in it, whose distance may be NaN */
  double flops, bytes;  /* of a call with all points active, without the iterations of the solver */
} ct_interaction;

/* Bound of ω² of the forces of an interaction that follow from the gaps of now. */
ct_status ct_interaction_bound(const ct_interaction *interaction, const void *state, ct_masses mass,
                               double *omega2);

#endif
