#ifndef CT_SRC_CONTACT_INTERNAL_H
#define CT_SRC_CONTACT_INTERNAL_H

#include <libcontact/contact.h>
#include <libcontact/step.h>

#include "side.h"

#include <string.h>

/* What never changes of a contact; all states of an effect share it. */
typedef struct ct_contact_fixed {
  ct_contact_options options;
  double depth;    /* at the start points look as far, and are in contact down to here */
  double near;     /* how far points look afterwards (eq:contact-near) */
  double approach; /* the largest safe approach of the surfaces in a step (eq:tunnelling) */
  double skin;     /* how far beyond that candidates are listed */
  int sides;       /* 2, or 1 for the contact of a surface with itself */
  int one_array;   /* whether the nodes of both sides are numbered in one array of the host */
  int alone;       /* whether there is no contact, and the surface meets only a host's obstacles */
  ct_side_fixed side[2];
  int64_t point_count; /* of all sides */
  int32_t node_count;  /* of all sides, a node of both counted once */
  int32_t *nodes;      /* their numbers, ascending; with two arrays those of the second come after
                          the first array's */
  int32_t *place[2];   /* where the nodes of each side stand in `nodes` */
} ct_contact_fixed;

/* A contact now: of a host, or of one state. */
struct ct_contact {
  const ct_contact_fixed *fixed;
  ct_contact_fixed *own; /* the same, of a host's contact; else null */
  int threads;
  int begun;    /* whether the points have a status */
  int start;    /* whether this is t = 0 of a scene */
  int built;    /* whether the candidate lists exist; those of the start are not kept */
  double clear; /* not 0: when they were made, no two faces were nearer than what points look plus
                   this (eq:contact-clear) */
  ct_side side[2];
  double *terms;             /* room for sums, one number a point */
  int solved;                /* whether the forces are those of solved rows */
  double held;               /* energy of the constraints then */
  double stored;             /* what all rows stored in the middle of the last step */
  double time;               /* of that step */
  double work;               /* since t = 0 that has come in because start gaps fade */
  const double *velocity[2]; /* of the moment whose gaps were found last */
  struct ct_host *host;      /* of a host that calls ct_contact_step; else null */
};

/* A moment t_n of a contact. */
typedef struct ct_moment {
  double time;
  double before;             /* Δt of the step that led here; 0: none */
  double dt;                 /* of the coming step */
  const double *velocity[2]; /* v_{n-1/2} in the numbering of the host, of each side */
  int first;                 /* whether there was no moment before */
} ct_moment;

/* Begin: no point has met anything, the nodes stand at the reference shape, and start gaps are
 * those of this shape (eq:initial-adjust). */
ct_status ct_contact_begin(ct_contact *contact, const ct_moment *now, ct_error *error);

/* Gaps of the points at a moment, counted from their start gaps, at the coordinates that stand in
 * `moved` of the sides; and once the rows are solved, or for the explicit penalty at once, forces,
 * energies and forces at nodes. */
ct_status ct_contact_find_gaps(ct_contact *contact, const ct_moment *now, ct_error *error);
ct_status ct_contact_find_forces(ct_contact *contact, const ct_moment *now, ct_error *error);

/* List the rows of all points that may be active; answers how many. */
int64_t ct_contact_list_rows(ct_contact *contact, ct_constraint **rows);

/* Force on node `n` of a side. */
static inline double ct_side_force(const ct_side *side, int64_t n, int c)
{
  return side->force[3 * n + c] + side->force_fine[3 * n + c];
}

static inline int ct_contact_is_penalty(const ct_contact_fixed *fixed)
{
  return fixed->options.enforcement == CT_ENFORCE_PENALTY;
}

/* Nodes of the two faces of a point. */
static inline int32_t ct_contact_row_nodes(const ct_contact_fixed *fixed)
{
  return fixed->side[0].search->per + fixed->side[fixed->sides - 1].search->per;
}

void ct_host_free(struct ct_host *host);

/* The side that side `s` meets. */
static inline ct_side *ct_contact_other(ct_contact *contact, int s)
{
  return &contact->side[contact->fixed->sides - 1 - s];
}

/* Of `sides` surfaces. */
ct_status ct_contact_fixed_create(const ct_surface *const surface[2], int sides,
                                  const ct_contact_options *options, ct_contact_fixed **out,
                                  ct_error *error);
void ct_contact_fixed_free(ct_contact_fixed *fixed);
ct_status ct_contact_open(const ct_contact_fixed *fixed, ct_contact **out, ct_error *error);

/* Bring the candidates of all faces up to date; and whether it is sure without, since the surfaces
 * are too far from each other to touch (eq:contact-clear). */
ct_status ct_contact_list_candidates(ct_contact *contact, ct_error *error);
int ct_contact_is_separated(const ct_contact *contact);

/* How far points look now: as far as `depth` at the start, when it is not known how deep two
 * surfaces begin in each other or how far apart they are; afterwards a point that comes in has been
 * near before (eq:contact-near). */
double ct_contact_reach(const ct_contact *contact);

/* Closest points of all points, without forces, at the coordinates that stand in `moved` of the
 * sides; search for those of one side. */
ct_status ct_contact_measure(ct_contact *contact, ct_error *error);
void ct_pass_search(ct_contact *contact, int s);

/* How far the gap of two surfaces may be off because their coordinates are rounded. */
double ct_contact_rounding(const ct_contact *contact);

/* How far points look after the start, and how far two surfaces may come nearer in a step; and
 * refuse a step of length `dt` to `time` that may have brought them nearer than that, with
 * velocities in the numbering of the host (eq:tunnelling). */
ct_status ct_tunnelling_init(ct_contact_fixed *fixed);
ct_status ct_tunnelling_check(const ct_contact *contact, const double *const velocity[2], double dt,
                              double time, ct_error *error);

/* Whether the gaps of a contact with these options count from start gaps; and whether these fade.
 */
int ct_start_gap_counts(const ct_contact_options *options);
static inline int ct_start_gap_fades(const ct_contact_options *options)
{
  return options->initial_penetration == CT_INITIAL_REMOVE;
}

/* Fail if a point is inside by more than is adjusted (eq:initial-shift). */
ct_status ct_start_gap_refuse(const ct_contact *contact, ct_error *error);

/* What a contact effect remembers of a point from step to step, as doubles of a restart. */
typedef struct ct_point_record {
  double other;   /* face of the other side plus one, or 0 */
  double status;  /* a ct_point_status */
  double xi[2];   /* parameters of the closest point there */
  double known;   /* signed distance, NaN where none is known */
  double force;   /* of the row, where gaps of the coming step give it */
  double start;   /* start gap */
  double pressed; /* size of the point's force, where start gaps fade */
} ct_point_record;
enum { CT_RECORD = sizeof(ct_point_record) / sizeof(double) };

/* How many doubles a contact remembers, and whether they are of a step; make the contact what it
 * was after that step, and remember what it is now. */
int64_t ct_contact_fixed_memory(const ct_contact_fixed *fixed);
int ct_contact_memory_begun(const ct_contact_fixed *fixed, const double *memory);
ct_status ct_contact_load(ct_contact *contact, const double *memory, ct_error *error);
void ct_contact_store(const ct_contact *contact, double *memory);

/* Start gaps of all points from their distances on the undeformed shape (eq:initial-adjust). */
void ct_start_gap_begin(ct_contact *contact);

/* Count the gaps of all points from their start gaps. */
void ct_start_gap_shift(ct_contact *contact, const ct_moment *now);

/* Work that has come in since the time `last` of the last step because start gaps fade, once the
 * forces of the points are known (eq:initial-work). */
double ct_start_gap_work(ct_contact *contact, double time, double last);

/* Upper bound of the contact's part of the largest ω² [1 / time²] with every point taken as active
 * at its nearest face, whatever the enforcement (eq:contact-bound). `mass_a`, `mass_b`: nodal
 * masses in the host's numbering. If both surfaces were given with one array of reference
 * coordinates, a node of both gets the sum of its two rows. */
ct_status ct_contact_omega2_bound(const ct_contact *contact, const double *mass_a,
                                  const double *mass_b, double *omega2);

/* An obstacle of one state: its points, and where it is. In each point `d` leads to the nearest
 * point of the obstacle, `other` is 0 where the point is inside and -1 elsewhere. */
typedef struct ct_obstacle_state {
  ct_side side;
  double place[3];    /* the obstacle's point now */
  double reaction[3]; /* force of the bodies on it */
  double work;        /* of its motion since t = 0 */
  double held;        /* energy of the constraints */
  double *terms;      /* a number a point */
} ct_obstacle_state;

/* What friction needs of the effect that it acts on: what never changes of a contact, or the side
 * of an obstacle; and bounds of ω² with all points as springs, whatever the enforcement. `mass`:
 * of the nodes that the obstacle's surface numbers; null: the problem's. */
const ct_contact_fixed *ct_contact_fixed_of(const ct_effect *effect);
const ct_side_fixed *ct_obstacle_side(const ct_effect *effect);
ct_status ct_contact_springs(const ct_effect *effect, const void *scratch, double *omega2,
                             ct_error *error);
double ct_obstacle_springs(const ct_effect *effect, const double *mass);

/* The effect of friction on a contact, or, with a null one, on the obstacle `def->on`. A host's
 * contact is no effect; then `on` is null, and the view's `read` shows the contact. */
ct_status ct_friction_create(const ct_friction_def *def, const ct_contact_fixed *contact,
                             ct_effect **effect, ct_error *error);

/* The factor of those bounds for its own (eq:friction-bound); and its sums over all points, of the
 * last force (eq:friction-dissipation). */
double ct_friction_stiffness(const ct_effect *effect);
void ct_friction_sums(const ct_effect *effect, void *scratch, double *held, double *dissipated);

/* Where the obstacle is at a time, relative to t = 0's `point` (eq:obstacle-motion); and the signed
 * distance of a point from it at its place of t = 0, negative inside, with the unit normal `n` out
 * of it (eq:obstacle-gap), NaN in the centre of a sphere and on the axis of a cylinder. */
void ct_obstacle_motion(const ct_obstacle_def *obstacle, double time, double motion[3]);
double ct_obstacle_gap(const ct_obstacle_def *obstacle, const double point[3], double n[3]);

/* The return of an elastic slip, which is tangential, to the limit of Coulomb (eq:friction-return):
 * where it is longer than `limit` it is shortened to it. Answers by how much: the sliding of this
 * step, 0 in stick. */
double ct_friction_return(double limit, double slip[3]);

#endif
