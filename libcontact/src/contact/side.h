#ifndef CT_SRC_CONTACT_SIDE_H
#define CT_SRC_CONTACT_SIDE_H

#include <libcontact/contact.h>
#include <libcontact/shape.h>

#include "../base/grid.h"
#include "../search/search_internal.h"

/* A method that compares distances places the closest point to the root of the rounding, as a part
 * of a face, and the gap of a point that touches is off by as much. */
static const double CT_CLOSEST_POINT_ERROR = 1e-6;

/* Status of a point since the last update (eq:point-status): unknown; outside, over `other`; in
 * contact with `other`; inside, but not in contact. */
typedef enum ct_point_status {
  CT_POINT_NEW,
  CT_POINT_OUTSIDE,
  CT_POINT_INSIDE,
  CT_POINT_BURIED
} ct_point_status;

/* One point of a side, as the last update left it. */
typedef struct ct_point {
  ct_constraint row; /* of the constraint problem. `gap` is the signed distance less `shift`; NaN
                        without `other` */
  int listed;        /* whether the row is listed in this step */
  int32_t other;     /* face of the other side, or -1 */
  ct_point_status status;
  double xi[2];      /* parameters of the closest point there */
  double N[8];       /* shape functions of the other face at xi */
  double d[3];       /* ȳ - y */
  double outward[3]; /* normal of the other side at the closest point, of any length */
  double known;   /* signed distance at the last update from the nearest place, in contact or not;
                     NaN: none was near */
  double start;   /* start gap that has not faded (eq:initial-adjust) */
  double shift;   /* start gap that the gap counts from, of either sign (eq:initial-shift) */
  double closed;  /* by how much the shift has grown since the step before */
  double closing; /* and by how much it grows until the next step */
  double last_known, last_start; /* what these were in the last step */
  double pressed;                /* size of the force then, where start gaps fade */
  double force[3];               /* on the point's own face */
} ct_point;

/* Whether a point has a force. */
static inline int ct_point_has_force(const ct_point *point)
{
  return point->force[0] != 0.0 || point->force[1] != 0.0 || point->force[2] != 0.0;
}

/* Signed distance of a point from the other side, whatever its gap counts from. */
static inline double ct_point_distance(const ct_point *point)
{
  return point->row.gap + point->shift;
}

/* What never changes of one surface: its topology and reference shape, its points on the faces. */
typedef struct ct_side_fixed {
  ct_search *search; /* at the reference shape */
  ct_rule rule;
  int on_edges;        /* whether the rule has points on edges and corners */
  double N[27][8];     /* shape functions at the points of a face */
  double dN[27][8][2]; /* and their derivatives */
  int64_t point_count;
  double *weight;     /* w J_ref, shape (face_count, rule.count) */
  int32_t *row_faces; /* nodes of the faces as places in an effect's list of nodes; null: they are
                         the surface's own numbers */
} ct_side_fixed;

/* One surface of a contact now: its shape and tree, its points and forces. */
typedef struct ct_side {
  const ct_side_fixed *fixed;
  ct_search *search;          /* shares the topology of the fixed one */
  ct_point *points;           /* shape (face_count, rule.count) */
  double *force, *force_fine; /* nodal forces: coarse and fine sums, shape (node_count, 3) */
  /* Of a side that meets another one, else null: */
  double *listed;  /* the candidates of a face are complete to this distance, shape (face_count)
                      (eq:skin) */
  double *x_built; /* coordinates at the last listing of candidates, shape (node_count, 3) */
  double *moved;   /* coordinates of the nodes before they are placed, and then how far they have
                      moved since the last update, shape (node_count, 3) */
  int32_t *candidate_first, *candidates; /* faces of the other side that may come near each face,
                                            until the next listing */
  int32_t candidate_room;
} ct_side;

/* Points by the Gauss rule, or with `on_edges` by one that has points at corners and on edges too.
 */
ct_status ct_side_fixed_init(ct_side_fixed *fixed, const ct_surface *surface, int body,
                             int on_edges, ct_error *error);
void ct_side_fixed_clear(ct_side_fixed *fixed);

/* Nodes of a face as rows number them. */
const int32_t *ct_side_row_nodes(const ct_side_fixed *fixed, int64_t face);

/* A side at the reference shape whose points are new. Their rows follow `law`, whose
 * stiffness is the penalty: each row has it times the point's weight. To be cleared also when this
 * fails. */
ct_status ct_side_init(ct_side *side, const ct_side_fixed *fixed, const ct_constraint *law);
void ct_side_clear(ct_side *side);

/* Room for what a side needs to meet another one: its tree, lists of candidates, motions. */
ct_status ct_side_equip(ct_side *side);

/* Sum over the nodes of a face, paired so that a flipped face gives the same bits (eq:tree-sum);
 * terms beyond `per` are 0. */
static inline double ct_side_sum(int per, const double t[8])
{
  double corners = (t[0] + t[1]) + (t[2] + t[3]);
  return per > 4 ? corners + ((t[4] + t[6]) + (t[5] + t[7])) : corners;
}

/* Σ_a N_a (x_a - origin) over the nodes of a face, paired so that a flipped face gives the same
 * bits (eq:tree-sum). */
void ct_side_interpolate(const ct_search *search, const double *x, int32_t face, const double N[8],
                         const double *origin, double out[3]);

/* Position of point `i`, seen from `origin` or, null, from 0. */
void ct_side_position(const ct_side *side, int64_t i, const double *origin, double y[3]);

/* Move the nodes to the coordinates in `moved`, and write there how far they have moved. */
void ct_side_place(ct_side *side);

/* Normal of its face at point `i`, of the length of the area element there. */
void ct_side_area(const ct_side *side, int64_t i, double normal[3]);

/* Unit direction in which a point is pushed: along the line to its closest point, or where the two
 * coincide the normal there. Returns 0 where there is none. */
int ct_side_direction(const ct_side *side, const ct_point *point, double n[3]);

/* List the rows of the points that may be active; answers how many (eq:constraint-force). `other`
 * is null for an obstacle, which has come by `came` since the step before and moves by `moved`;
 * points farther out than `reach` are left out. */
int64_t ct_side_list_rows(ct_side *side, const ct_side *other, double reach, const double came[3],
                          const double moved[3], ct_constraint **rows);

/* Forces of the points from their solved rows; or those of the explicit penalty. */
void ct_side_take_rows(ct_side *side);
void ct_side_apply_penalty(ct_side *side);

/* Energy of the explicit penalty, of the forces of some sides. */
double ct_side_potential(const ct_side *sides, int count);

/* Energy that the solved rows of some sides hold at t_n (eq:controlled-energy, eq:energy-start):
 * `before` is what all of them stored in the middle of the last step, which the effect remembers,
 * and `*after` becomes what they store in the middle of the coming one. `terms` is room for a
 * number each. */
double ct_side_rows_energy(const ct_side *sides, int count, double time, double before,
                           double *after, double *terms);

/* Nodal forces from those of the points: of an obstacle's one surface if `rigid`, else of both
 * sides, or of the one that is in contact with itself. */
ct_status ct_side_collect(ct_side *sides, int count, int rigid, ct_error *error);

/* Tractions and areas at the nodes of a side from its nodal forces, in the numbering of the host
 * (eq:recovered-traction). `other` is the side whose points push on this one, or null. */
ct_status ct_side_traction(const ct_side *side, const ct_side *other, double *traction,
                           double *area, ct_error *error);

#endif
