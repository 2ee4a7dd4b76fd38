#ifndef CT_SRC_CONTACT_INTERNAL_H
#define CT_SRC_CONTACT_INTERNAL_H

#include <libcontact/contact_result.h>

#include "../base/vector.h"
#include "../gap/gaps.h"
#include "carrier.h"
#include "interaction.h"

#include <math.h>
#include <string.h>

struct ct_contact_fixed;

/* What the points of some surfaces meet: other surfaces, or an obstacle. */
typedef struct ct_partner_calls {
  const char *label; /* in errors */
  void (*free)(struct ct_contact_fixed *fixed);
  /* Allocate what a state needs beyond its sides; it is closed also if this fails. */
  ct_status (*open)(ct_contact *contact);
  /* Gaps of all points at the coordinates in `moved` of the surfaces. */
  ct_status (*measure)(ct_contact *contact, const ct_surface_motion *now, ct_error *error);
  /* Refuse a step in which surface and partner may have passed through each other. */
  ct_status (*check)(ct_contact *contact, const ct_surface_motion *now, ct_error *error);
  /* Signed distance of a place `r`, relative to the partner's position, and the unit normal there;
   * null for surfaces. */
  double (*distance)(const ct_contact *contact, const double r[3], double n[3]);
  /* Motion of the partner near a place since the last step; null for surfaces. */
  void (*find_came)(const ct_contact *contact, const double x[3], double came[3]);
  /* As of ct_interaction_calls. */
  ct_status (*find_springs)(const ct_contact *contact, ct_masses mass, double *omega2);
} ct_partner_calls;

/* Treatment of gaps and overlaps at the start. */
typedef struct ct_start_rule {
  ct_initial initial_penetration;
  double removal_time, adjust;
} ct_start_rule;

/* Constant data of a contact or an obstacle, shared by all states of an effect. */
typedef struct ct_contact_fixed {
  ct_interaction is;
  const ct_partner_calls *partner;
  ct_constraint law; /* of all points; its stiffness is the penalty of one side */
  ct_start_rule start_rule;
  int admits; /* whether points may be found inside after the start (eq:admitted) */
  int moves;  /* whether what the points meet is an obstacle that moves as prescribed */
  const ct_carrier *carrier; /* of an obstacle with mass; else null */
  int threads;
  double force_tolerance; /* of a host's steps */
  ct_gaps_fixed gaps;
  int one_array;  /* whether the nodes of both sides are numbered in one array of the host */
  int32_t *nodes; /* those of the interaction, a node of both sides counted once; with two arrays
                     those of the second follow those of the first; null: those of one surface */
} ct_contact_fixed;

/* Energy that the bodies have given to the points, and not got back; its largest value so far; and
 * the points that were found inside after the start and deep: their number, and the largest depth.
 */
typedef struct ct_admission {
  double received, most, late, late_depth;
} ct_admission;

/* What a contact stores from step to step besides its points, as doubles of a restart. */
typedef struct ct_contact_record {
  double begun;   /* whether there was an earlier step */
  double time;    /* of that step */
  double removal; /* work of fading start gaps since t = 0 */
  ct_admission admission;
  double reaction[3]; /* force of the bodies on an obstacle that moves, or of the explicit penalty
                       */
  double motion;      /* work of its motion since t = 0 */
} ct_contact_record;

/* What the rows of a side still have from the last step: whether all of its points were listed, and
 * with which changes of all gaps (eq:constraint-force). */
typedef struct ct_listing {
  int all;
  double came, moved;
} ct_listing;

/* State of a contact or an obstacle: of a host, or of one state. */
struct ct_contact {
  const ct_contact_fixed *fixed;
  ct_contact_fixed *own; /* the same of a host's contact; else null */
  ct_gaps gaps;
  int filled;     /* whether the points are set: from the first step on */
  int changed;    /* whether what the solver wrote to their rows is not what it finds there */
  double part;    /* of the time since the last step that the step before counts; 1, or less after a
                     step that was divided */
  double *terms;  /* memory for sums, one number per point and node */
  int solved;     /* whether the forces are those of solved rows */
  int complete;   /* whether what only results need of these rows is known: */
  double energy;  /* of the constraints */
  double reserve; /* the part of it that points hold until they open (eq:impact-reserve) */
  double left;    /* the most that a point of this piece leaves in this step (eq:impact-left) */
  ct_contact_record record;
  const double *memory;  /* of the last step; unchanged until the next one is computed */
  ct_listing listing[2]; /* of each side */
  /* Of an obstacle: its position, its motion since the last step and until the next one, and the
   * direction of its axis; the distance from which a point may reach it until then, and whether
   * all points are nearer; and what carries it. */
  double place[3], came[3], coming[3], direction[3], reach;
  int all_near;
  ct_carried carried;
  const double *axis;   /* direction of all forces, of a plane; else null */
  double reaction[3];   /* force on it; if it does not move, known with the energies */
  struct ct_host *host; /* of a host that calls ct_contact_step; else null */
};

/* Whether the points meet an obstacle. */
static inline int ct_contact_is_rigid(const ct_contact_fixed *fixed)
{
  return fixed->partner->distance != NULL;
}

/* Whether points are plain: at a plane, and without start gaps. Only their rows change from step to
 * step, and `known` and `status`, which follow from the gap, are not kept. */
static inline int ct_contact_is_plain(const ct_contact *contact)
{
  return contact->axis != NULL && !contact->fixed->is.explicit && !contact->gaps.side[0].shifted;
}

/* The side opposite to side `s`, null at an obstacle; and the side whose points act on side `s`
 * besides its own, if there is one. */
static inline ct_side *ct_contact_other(ct_contact *contact, int s)
{
  return ct_contact_is_rigid(contact->fixed)
             ? NULL
             : &contact->gaps.side[contact->fixed->gaps.sides - 1 - s];
}

static inline const ct_side *ct_contact_acting(const ct_contact *contact, int s)
{
  const int sides = contact->fixed->gaps.sides;
  return ct_contact_is_rigid(contact->fixed) && sides == 1 ? NULL
                                                           : &contact->gaps.side[sides - 1 - s];
}

/* The calls of contacts and obstacles. */
extern const ct_interaction_calls ct_contact_calls;

/* Check the penalty, the rule of points, the law and the start rule of constant data. */
ct_status ct_contact_check(const ct_contact_fixed *fixed, double epsilon, ct_contact_rule points,
                           ct_error *error);

/* Fill the interaction of constant data whose surfaces are known; `points` and `nodes` are flops of
 * a call per point and node (eq:round-flops). */
void ct_contact_describe(ct_contact_fixed *fixed, double points, double nodes);
void ct_contact_fixed_free(ct_contact_fixed *fixed);
ct_status ct_contact_open(const ct_contact_fixed *fixed, ct_contact **out, ct_error *error);
void ct_contact_close(void *state);

/* Set the points before the first step: those of this piece, which a state does not know when it is
 * opened. */
void ct_contact_fill(ct_contact *contact);

/* At a plane, let all points act along its axis. */
void ct_contact_direct(ct_contact *contact);

/* Gaps of the points at a time, measured from their start gaps. */
ct_status ct_contact_find_gaps(ct_contact *contact, const ct_surface_motion *now, ct_error *error);

/* Energy of the contact alone; of solved rows after ct_contact_complete. */
double ct_contact_own_energy(const ct_contact *contact);

/* The contact of `sides` surfaces. */
ct_status ct_contact_fixed_create(const ct_surface *const surface[2], int sides,
                                  const ct_contact_options *options, ct_contact_fixed **out,
                                  ct_error *error);

/* List the rows of the points that may be active in the next step, of the length dt; returns their
 * number (eq:constraint-force). */
int64_t ct_contact_list_rows(ct_contact *contact, double dt, ct_constraint **rows);

/* Forces of the points from their solved rows, or of the explicit penalty; return the size of the
 * largest component. */
double ct_side_take_rows(ct_side *side);
double ct_side_apply_penalty(ct_side *side);

/* Energy of the explicit penalty, of the forces of some sides. */
double ct_side_potential(const ct_side *sides, int count);

/* Let solved points that press take what those hold that have lost their partner (eq:impact-left).
 * And pay what points owe, `debt` at most, from what others hold (eq:impact-debt). Returns whether
 * any have changed. */
int ct_contact_pay_debts(ct_contact *contact, double debt);

/* Find what only results need of solved rows, unless it is known, in all pieces: their energy at
 * t_n (eq:controlled-energy, eq:energy-start), and what they hold of it (eq:impact-reserve); the
 * force on an obstacle that does not move; and the forces of the points. */
void ct_contact_complete(ct_contact *contact);

/* Find the force of the points on an obstacle. */
void ct_contact_react(ct_contact *contact);

/* Add to forces on the nodes of a surface what acts against them on the carrier of its obstacle, if
 * it has one. `terms` has room for a number per node. */
void ct_contact_push_carrier(const ct_contact *contact, double *force, double *terms);

/* Nodal forces of all surfaces from those of the points, of which no component exceeds `top`. */
ct_status ct_contact_collect(ct_contact *contact, double top, ct_error *error);

/* Force on node `n` of a side. */
static inline double ct_side_force(const ct_side *side, int64_t n, int c)
{
  return side->force[3 * n + c] + side->force_fine[3 * n + c];
}

/* Tractions and areas at the nodes of a side from its nodal forces, in the numbering of the host
 * (eq:recovered-traction). `other` is the side whose points act on this one, or null. */
ct_status ct_side_traction(const ct_side *side, const ct_side *other, double *traction,
                           double *area, ct_error *error);

/* Tractions of friction at the nodes of a side, on the areas of ct_side_traction, and whether the
 * points at each node stick, in the numbering of the host (eq:recovered-friction). */
ct_status ct_side_friction(const ct_side *side, const ct_side *other, double *traction,
                           int32_t *slip, ct_error *error);

/* Refuse a rule with values out of range; `label` names the effect. */
ct_status ct_start_gap_check(const ct_start_rule *rule, const char *label, ct_error *error);

/* Whether gaps are measured from start gaps; and whether these fade. */
int ct_start_gap_counts(const ct_start_rule *rule);
static inline int ct_start_gap_fades(const ct_start_rule *rule)
{
  return rule->initial_penetration == CT_INITIAL_REMOVE;
}

/* Fail if a point of `sides` surfaces penetrates by more than is adjusted (eq:initial-shift). */
ct_status ct_start_gap_refuse(const ct_start_rule *rule, const ct_penetration *found,
                              const char *label, int sides, ct_error *error);

/* Memory of a point from step to step, as doubles of a restart. */
typedef struct ct_point_record {
  double other;      /* face of the other side plus one, or 0 */
  double status;     /* a ct_point_status */
  double xi[2];      /* parameters of the closest point on it */
  double known;      /* signed distance, NaN if unknown */
  double start;      /* start gap */
  double admitted;   /* start gap of a point that was found inside */
  double force_size; /* size of the point's force, if start gaps fade */
  double force;      /* of the row, if it depends on the next gap */
  ct_impact impact;  /* of the row */
} ct_point_record;
enum { CT_RECORD = sizeof(ct_point_record) / sizeof(double) };

/* Number of doubles that a contact stores, and whether they are of a step; restore the contact from
 * them, and save it. */
int64_t ct_contact_fixed_memory(const ct_contact_fixed *fixed);
int ct_contact_memory_begun(const ct_contact_fixed *fixed, const double *memory);
ct_status ct_contact_load(ct_contact *contact, const double *memory, ct_error *error);

/* Store the points, and what is not of a point. The first returns the largest force and the largest
 * debt of their rows. */
typedef struct ct_largest_row {
  double force, debt;
} ct_largest_row;
ct_largest_row ct_contact_store_points(const ct_contact *contact, double *memory);
void ct_contact_store(const ct_contact *contact, double *memory);

/* Count in a memory from before the step the work of the present forces on the change of velocity
 * by which the step is divided to this part (eq:divided-work). */
void ct_contact_divide(const ct_contact *contact, double part, double *memory);

/* Set the start gaps of all points of some sides from their distances on the undeformed shape
 * (eq:initial-adjust). */
void ct_start_gap_begin(const ct_start_rule *rule, ct_side *sides, int count);

/* Measure the gaps of all points from their start gaps. `last`: time of the last step. */
void ct_start_gap_shift(const ct_start_rule *rule, ct_side *sides, int count,
                        const ct_surface_motion *now, double last);

/* Work of fading start gaps since the time `last` of the last step, once the forces of the points
 * are known (eq:initial-work). `terms` has one number for each point. */
double ct_start_gap_work(const ct_start_rule *rule, ct_side *sides, int count, double time,
                         double last, double *terms);

/* Start gaps of points that were found inside after the start: release those that have opened, and
 * measure the gaps from them; let no point store more than it did, if it jumped, and not all of
 * them more than the bodies have given (eq:admitted-store). */
void ct_admission_shift(ct_side *sides, int count, int counted);
void ct_admission_limit(ct_contact *contact);

/* Largest displacement of a node since the last update. */
double ct_side_motion(const ct_side *side);

/* The account of the next step, once the forces are known (eq:admitted-account). `starting`: there
 * was no earlier step. */
void ct_admission_count(ct_contact *contact, int starting);

/* Upper bound of the contact's part of the largest ω² [1 / time²] with every point taken as active
 * at its nearest face, whatever the enforcement (eq:contact-bound); `mass`: of its nodes. */
ct_status ct_contact_find_springs(const ct_contact *contact, ct_masses mass, double *omega2);

/* A new obstacle at a surface, whose faces are not those of the definition; free it with its
 * call. */
ct_status ct_obstacle_create(const ct_obstacle_def *def, const ct_surface *surface,
                             const int32_t *carrier, ct_interaction **out, ct_error *error);

/* Friction on a contact or an obstacle, which must outlive it. Its state adds to the rows of that
 * of `on`. */
ct_status ct_friction_create(double coefficient, double tangent, const ct_interaction *on,
                             ct_interaction **out, ct_error *error);

#endif
