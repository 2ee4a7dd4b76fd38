#ifndef CT_SRC_CONTACT_INTERNAL_H
#define CT_SRC_CONTACT_INTERNAL_H

#include <libcontact/contact_result.h>

#include "../base/vector.h"
#include "../gap/gaps.h"
#include "interaction.h"

#include <math.h>
#include <string.h>

/* List the rows of the points that may be active; returns their number (eq:constraint-force).
 * `other` is null for an obstacle, which has moved by `came` since the last step and moves by
 * `moved`; points farther out than `reach` are skipped. */
int64_t ct_side_list_rows(ct_side *side, const ct_side *other, double reach, const double came[3],
                          const double moved[3], ct_constraint **rows);

/* Forces of the points from their solved rows, or of the explicit penalty. */
void ct_side_take_rows(ct_side *side);
void ct_side_apply_penalty(ct_side *side);

/* Energy of the explicit penalty, of the forces of some sides. */
double ct_side_potential(const ct_side *sides, int count);

/* Energy of the solved rows of some sides at t_n (eq:controlled-energy, eq:energy-start): `before`
 * is the energy that all of them stored at the middle of the last step, from the effect's memory,
 * and `*after` becomes that at the middle of the next one. `terms` has one number for each. */
double ct_side_rows_energy(const ct_side *sides, int count, double time, double before,
                           double *after, double *terms);

/* Nodal forces from those of the points: of an obstacle's surface, and of its stations if there are
 * any, if `rigid`; else of both sides, or of the one in contact with itself. */
ct_status ct_side_collect(ct_side *sides, int count, int rigid, ct_error *error);

/* Tractions and areas at the nodes of a side from its nodal forces, in the numbering of the host
 * (eq:recovered-traction). `other` is the side whose points act on this one, or null. */
ct_status ct_side_traction(const ct_side *side, const ct_side *other, double *traction,
                           double *area, ct_error *error);

/* Treatment of gaps and overlaps at the start, of a contact or an obstacle. */
typedef struct ct_start_rule {
  ct_initial initial_penetration;
  double removal_time, adjust;
} ct_start_rule;

/* Constant data of a contact, shared by all states of an effect. */
typedef struct ct_contact_fixed {
  ct_interaction is;
  ct_contact_options options;
  ct_start_rule start_rule; /* from the options */
  ct_gaps_fixed gaps;
  int one_array;      /* whether the nodes of both sides are numbered in one array of the host */
  int32_t node_count; /* of all sides, a node of both counted once */
  int32_t *nodes; /* their numbers, ascending; with two arrays those of the second follow those of
                     the first */
} ct_contact_fixed;

/* Energy that the bodies have given to the points of a contact or an obstacle, and not got back;
 * and its largest value so far. */
typedef struct ct_account {
  double received, most;
} ct_account;

/* The account, and the points that were found inside after the start and deep: their number and the
 * largest depth. */
typedef struct ct_admission {
  ct_account account;
  int64_t late;
  double late_depth;
} ct_admission;

/* State of a contact: of a host, or of one state. */
struct ct_contact {
  const ct_contact_fixed *fixed;
  ct_contact_fixed *own; /* the same of a host's contact; else null */
  ct_gaps gaps;
  double *terms; /* memory for sums, one number per point */
  int solved;    /* whether the forces are those of solved rows */
  double held;   /* energy of the constraints then */
  double stored; /* energy that all rows stored at the middle of the last step */
  ct_admission admission;
  double time;          /* of that step */
  double work;          /* work of fading start gaps since t = 0 */
  struct ct_host *host; /* of a host that calls ct_contact_step; else null */
};

/* Gaps of the points at a time, measured from their start gaps. */
ct_status ct_contact_find_gaps(ct_contact *contact, const ct_surface_motion *now, ct_error *error);

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
  return fixed->gaps.side[0].search->per + fixed->gaps.side[fixed->gaps.sides - 1].search->per;
}

/* The side opposite to side `s`. */
static inline ct_side *ct_contact_other(ct_contact *contact, int s)
{
  return &contact->gaps.side[contact->fixed->gaps.sides - 1 - s];
}

/* Of `sides` surfaces. */
ct_status ct_contact_fixed_create(const ct_surface *const surface[2], int sides,
                                  const ct_contact_options *options, ct_contact_fixed **out,
                                  ct_error *error);
void ct_contact_fixed_free(ct_contact_fixed *fixed);
ct_status ct_contact_open(const ct_contact_fixed *fixed, ct_contact **out, ct_error *error);
void ct_contact_close(void *state);

/* Energy of the contact alone, after forces are known. */
double ct_contact_own_energy(const ct_contact *contact);

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

/* Memory of a point of a contact or an obstacle from step to step, as doubles of a restart. */
typedef struct ct_point_record {
  double other;      /* face of the other side plus one, or 0 */
  double status;     /* a ct_point_status */
  double xi[2];      /* parameters of the closest point on it */
  double known;      /* signed distance, NaN if unknown */
  double force;      /* of the row, if it depends on the next gap */
  double start;      /* start gap */
  double force_size; /* size of the point's force, if start gaps fade */
  double admitted;   /* start gap of a point that was found inside */
  double stored;     /* energy of the row */
} ct_point_record;
enum { CT_RECORD = sizeof(ct_point_record) / sizeof(double) };

/* Restore the points of a side from their records, whose partners are `face_count` faces, and store
 * them; return the place behind the records. */
const double *ct_points_load(ct_side *side, int32_t face_count, const double *memory);
double *ct_points_store(const ct_side *side, double *memory);

/* Number of doubles that a contact stores, and whether they are of a step; restore the contact from
 * them, and save it. */
int64_t ct_contact_fixed_memory(const ct_contact_fixed *fixed);
int ct_contact_memory_begun(const ct_contact_fixed *fixed, const double *memory);
ct_status ct_contact_load(ct_contact *contact, const double *memory, ct_error *error);
void ct_contact_store(const ct_contact *contact, double *memory);

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
 * them more than the bodies have given (eq:admitted-store). `terms` has one number for each point.
 */
void ct_admission_shift(ct_side *sides, int count, int counted);
void ct_admission_limit(ct_contact *contact);

/* The same for the sides of a contact or an obstacle. `find_before` writes the gap of a point in
 * the last step, at its present place, to its row; it returns 0 if the point has no direction.
 * Points farther out than `reach` store nothing. */
typedef int ct_find_before(const void *user, int s, int64_t i);
void ct_admission_bound(ct_side *sides, int count, ct_admission *admission, double reach,
                        ct_find_before *find_before, const void *user, double *terms);

/* Largest displacement of a node since the last update. */
double ct_side_motion(const ct_side *side);

/* The account of the next step, once the rows are solved (eq:admitted-account). `solved`: whether
 * the forces are those of rows; `starting`: there was no earlier step. */
void ct_admission_count(ct_side *sides, int count, ct_admission *admission, int solved,
                        int starting, double *terms);

/* Upper bound of the contact's part of the largest ω² [1 / time²] with every point taken as active
 * at its nearest face, whatever the enforcement (eq:contact-bound); `mass`: of its nodes. If
 * `facing`, that of friction: with the points that face the other surface where the two touch. If
 * they are apart, those where they would touch (eq:friction-facing); 0 if no parts of a surface
 * face each other. */
ct_status ct_contact_find_springs(const void *state, int facing, ct_masses mass, double *omega2);

/* Constant data of the stations of a sphere or cylinder that is smaller than the faces: places on
 * its centre or axis, each with a row at the closest place of the surface (eq:station-gap). */
typedef struct ct_stations {
  ct_side_fixed
      fixed;       /* the stations as points without faces, so its rule has none; or no points */
  double spacing;  /* along the axis; 0: one station */
  double area;     /* of a station: that of a mean face */
  double approach; /* largest safe motion relative to the surface in a step */
} ct_stations;

/* An obstacle of one state: its points and its position. In each point `d` leads to the closest
 * point of the obstacle, and `other` is 0, or -1 if the obstacle has passed it. */
typedef struct ct_obstacle_state {
  const struct ct_obstacle *data;
  const ct_obstacle_def *given; /* with an axis of length 1 */
  const ct_stations *stations;
  int sides;
  ct_side side[2]; /* the surface; and the stations, with its `search`: `other` and `xi` are
                      their closest places on it */
  double place[3]; /* present point of the obstacle */
  double came[3];  /* its motion since the last step */
  ct_admission admission;
  double reaction[3]; /* force of the bodies on it */
  double work;        /* of its motion since t = 0 */
  double removal;     /* work of fading start gaps since t = 0 */
  double held;        /* energy of the constraints */
  double *terms;      /* one number per point */
} ct_obstacle_state;

/* The stations of an obstacle, null if it has none. */
static inline const ct_side *ct_obstacle_stations(const ct_obstacle_state *obstacle)
{
  return obstacle->sides == 2 ? &obstacle->side[1] : NULL;
}

/* Stations of an obstacle at a surface, none if it is large; their part of its row sums of
 * stiffness at a node (eq:station-bound). */
ct_status ct_stations_init(ct_stations *stations, const ct_obstacle_def *o,
                           const ct_side_fixed *surface, ct_error *error);
void ct_stations_clear(ct_stations *stations);
double ct_stations_springs(const ct_stations *stations, const ct_search *search, double epsilon);

/* The stations of a state: create them, let them forget their places, find the present gaps of
 * those nearer than `reach`, which change by at most `motion` in a step; and refuse a step in which
 * obstacle and surface may have passed through each other. */
ct_status ct_stations_open(ct_obstacle_state *s, const ct_stations *stations,
                           const ct_constraint *law);
void ct_stations_forget(ct_obstacle_state *s);
void ct_stations_meet(ct_obstacle_state *s, double reach, double motion, int first);
ct_status ct_stations_check(const ct_obstacle_state *s, double time, ct_error *error);

/* Signed distance and normal of a point `r` relative to an obstacle's position; `a` is its axis, of
 * length 1. And this axis; returns 0 if there is no direction. */
double ct_obstacle_gap_of(const ct_obstacle_def *o, const double a[3], const double r[3],
                          double n[3]);
int ct_obstacle_axis(const double axis[3], double a[3]);

/* Signed distance of a place from an obstacle in its present position, and the normal there; NaN as
 * in ct_obstacle_gap. */
double ct_obstacle_distance(const ct_obstacle_state *obstacle, const double y[3], double n[3]);

/* Depth of a surface inside an obstacle, as ct_contact_penetration. */
ct_status ct_obstacle_depth(const ct_obstacle_state *obstacle, ct_penetration_at at,
                            ct_penetration *out, ct_error *error);

/* A new obstacle at a surface, whose faces are not those of the definition; free it with its
 * call. */
ct_status ct_obstacle_create(const ct_obstacle_def *def, const ct_surface *surface,
                             ct_interaction **out, ct_error *error);

/* Friction on a contact or an obstacle, which must outlive it. Its state reads that of `on`. */
ct_status ct_friction_create(double coefficient, double tangent, const ct_interaction *on,
                             ct_interaction **out, ct_error *error);
extern const ct_interaction_calls ct_contact_calls;

/* The surface of an obstacle. */
const ct_side_fixed *ct_obstacle_side(const ct_interaction *obstacle);

/* ω² of the active points for which a step is stable: the bound at the start, and a fraction of
 * what a step shorter than the stable one leaves (eq:friction-room). */
typedef struct ct_friction_room {
  double bound;
  double limit; /* Ω of the integrator; 0: nothing is left */
  double rate;  /* Ω / Δt_s of the stable step */
  double fraction;
} ct_friction_room;

/* Let friction refuse steps in which the ω² of its active points exceeds the room; `mass` has the
 * numbering of its surfaces and must outlive it. Without this call it refuses none
 * (eq:friction-room). */
void ct_friction_limit(ct_interaction *friction, const double *mass, ct_friction_room room);

/* Whether the face of a point and the other surface face each other, for friction; normals of any
 * length, which is not 0. */
static inline int ct_friction_facing(const double own[3], const double other[3])
{
  const double lengths = sqrt(ct_vector_dot(own, own) * ct_vector_dot(other, other));
  return ct_vector_dot(own, other) / lengths < -0.25; // (eq:friction-facing)
}

/* Position of the obstacle at a time, relative to `point` at t = 0 (eq:obstacle-motion); and the
 * signed distance of a point from it in its position at t = 0, negative inside, with the unit
 * normal `n` out of it (eq:obstacle-gap), NaN at the centre of a sphere and on the axis of a
 * cylinder. */
void ct_obstacle_motion(const ct_obstacle_def *obstacle, double time, double motion[3]);
double ct_obstacle_gap(const ct_obstacle_def *obstacle, const double point[3], double n[3]);

/* Return a tangential elastic slip to Coulomb's limit (eq:friction-return): if it is longer than
 * `limit`, it is shortened to it. Returns the difference: the sliding of this step, 0 in stick. */
double ct_friction_return(double limit, double slip[3]);

#endif
