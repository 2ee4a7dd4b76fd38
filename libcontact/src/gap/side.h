#ifndef CT_SRC_SIDE_H
#define CT_SRC_SIDE_H

#include <libcontact/constraint.h>
#include <libcontact/shape.h>

#include "../base/grid.h"
#include "../base/pieces.h"
#include "../search/search_internal.h"

#include <float.h>

/* A method that compares distances finds the closest point to the root of the rounding, as a
 * fraction of a face; the gap of a touching point has the same error. */
static const double CT_CLOSEST_POINT_ERROR = 1e-6;

/* Status of a point since the last update (eq:point-status): unknown; outside, over `other`; in
 * contact with `other`; inside, but not in contact. */
typedef enum ct_point_status {
  CT_POINT_NEW,
  CT_POINT_OUTSIDE,
  CT_POINT_INSIDE,
  CT_POINT_BURIED
} ct_point_status;

/* Why the gap of a point inside is not that of its motion: it is where the motion since the last
 * update can't have brought it; or it belongs to a face beside an edge (eq:beside-edge). */
typedef enum ct_point_jump { CT_POINT_NO_JUMP, CT_POINT_JUMPED, CT_POINT_BESIDE } ct_point_jump;

/* One point of a side at the last update: seven lines of a cache. What a step of lasting contact
 * writes is in the third and the fourth, which begin with `row.gap`, and in the first half of the
 * fifth; the first two change only with the partner. */
typedef struct ct_point {
  double outward[3]; /* normal of the other side at the closest point, of any length */
  ct_constraint row; /* of the constraint problem. `gap` is the signed distance minus `shift`; NaN
                        without `other`, or without a direction */
  int32_t other;     /* face of the other side, or -1 */
  int listed;        /* whether the row is listed in this step */
  ct_point_status status;
  ct_point_jump jumped;
  double last_known; /* `known` of the last step */
  double xi[2];      /* parameters of the closest point on it, or 0 */
  double known;    /* signed distance at the last update from the nearest place, in contact or not;
                      NaN: none was near */
  double start;    /* start gap that does not fade (eq:initial-adjust) */
  double admitted; /* start gap since then, of a point that was found inside (eq:admitted) */
  double force_size; /* size of the force in the last step, if start gaps fade */
  double closed;     /* growth of the shift since the last step */
  double shift; /* start gap from which the gap is measured, of either sign (eq:initial-shift) */
  double N[8];  /* shape functions of the other face at xi */
  double d[3];  /* ȳ - y */
  double along; /* motion away from the closest point along the row's normal since the last
                   update; NaN: not computed */
  double last_start; /* `start` of the last step */
  double force[3];   /* on the point's own face; of solved rows for results only */
} ct_point;

/* Whether a point has a force. */
static inline int ct_point_has_force(const ct_point *point)
{
  return point->force[0] != 0.0 || point->force[1] != 0.0 || point->force[2] != 0.0;
}

/* Signed distance of a point from the other side, without start gap. */
static inline double ct_point_distance(const ct_point *point)
{
  return point->row.gap + point->shift;
}

/* Kinds of sides: a surface, whose points lie on its faces; or the stations of an obstacle, each of
 * which acts on face `other` of the surface (eq:station-gap). */
typedef enum ct_side_kind { CT_SIDE_SURFACE, CT_SIDE_STATIONS } ct_side_kind;

/* Constant data of one side: its topology and reference shape, and its points. Of stations only
 * kind and number of points. */
typedef struct ct_side_fixed {
  ct_side_kind kind;
  ct_search *search; /* at the reference shape */
  ct_rule rule;
  int on_edges;         /* whether the rule has points on edges and corners */
  double N[27][8];      /* shape functions at the points of a face */
  double across[8][32]; /* the same, those of one node side by side */
  double dN[27][8][2];  /* and their derivatives */
  int64_t point_count;
  double *weight;     /* w J_ref, shape (face_count, rule.count) */
  int32_t *row_faces; /* nodes of the faces as indices in an effect's list of nodes; null: the
                         surface's own numbers */
} ct_side_fixed;

/* Consecutive points first ... end - 1, the `number`-th such run. */
typedef struct ct_span {
  int64_t first, end;
  int32_t number;
} ct_span;

/* State of one side of a contact: its shape and tree, its points and forces. Stations have only
 * points, and the search of their surface. */
typedef struct ct_side {
  const ct_side_fixed *fixed;
  const ct_pieces *pieces; /* null: this side has all points */
  ct_span *runs;           /* of a side in pieces: the points of this piece; null: all are */
  int32_t run_count;
  ct_search *search; /* shares the topology of the fixed one */
  ct_point *points;  /* shape (face_count, rule.count) */
  int shifted;    /* whether a point may have a start gap now, or had one in the last step; ... */
  double nothing; /* ... if not, size of gaps that count as 0; else negative */
  double closing; /* growth of a shift until the next step, as a fraction of `start` */
  double *force, *force_fine; /* nodal forces: coarse sums, and behind them the fine ones, each of
                                 shape (node_count, 3), and one number more, 0 */
  double *moved; /* coordinates of the nodes before they are set, and afterwards their displacements
                    since the last update, shape (node_count, 3), and one number more */
  /* For a side opposite to another one, else null: */
  double *listed;  /* distance to which the candidates of a face are complete, shape (face_count)
                      (eq:skin) */
  double *x_built; /* coordinates at the last listing of candidates, shape (node_count, 3) */
  int32_t *candidate_first,
      *candidates; /* candidate faces of the other side for each face, until the next listing ... */
  int32_t *near_end; /* ... those within the skin of its box first: their end, shape (face_count) */
  int32_t *met;      /* the face that a point met at that time, or -1, ... */
  double *distant;   /* ... and a lower bound of its distance from the boxes of all others then, or
                        from all listed faces if a search has found none, shape (face_count,
                        rule.count) (eq:rival-distance, eq:clear-distance) */
  int32_t candidate_capacity;
  uint8_t *creased; /* whether a face across an edge faces this one, shape (face_count): for a
                       surface with itself, else null */
} ct_side;

/* Points by the Gauss rule, or with `on_edges` by a rule with points at corners and on edges. */
ct_status ct_side_fixed_init(ct_side_fixed *fixed, const ct_surface *surface, int body,
                             int on_edges, ct_error *error);
void ct_side_fixed_clear(ct_side_fixed *fixed);

/* Nodes of a face in the numbering of rows. */
const int32_t *ct_side_row_nodes(const ct_side_fixed *fixed, int64_t face);

/* Let the row of a point have the nodes of the face of another side that it meets. */
static inline void ct_side_meet(const ct_side *other, ct_point *point)
{
  point->row.other_count = other->search->per;
  point->row.other = ct_side_row_nodes(other->fixed, point->other);
}

/* Create a side at the reference shape, whose points are zeros. Clear it also if this fails. */
ct_status ct_side_init(ct_side *side, const ct_side_fixed *fixed);

/* Set its points to new ones; those of other pieces stay zeros, which take no memory. Their rows
 * follow `law`, whose stiffness is the penalty: each row has it times the point's weight. */
void ct_side_fill(ct_side *side, const ct_constraint *law);
void ct_side_clear(ct_side *side);

/* Allocate for contact with another side: tree, lists of candidates. */
ct_status ct_side_equip(ct_side *side);

/* Face of the surface on which point `i` acts. */
static inline int32_t ct_side_face(const ct_side *side, int64_t i)
{
  return side->fixed->kind == CT_SIDE_STATIONS ? side->points[i].other
                                               : (int32_t)(i / side->fixed->rule.count);
}

/* Give a side only some points, which no other piece has: those of the faces of a surface, shape
 * (face_count), or all stations or none. It has all others in name only. */
ct_status ct_side_divide(ct_side *side, const uint8_t *owned);

/* The next run of points that a side has, beginning with {0}; returns 0 after the last one. */
static inline int ct_side_next(const ct_side *side, ct_span *run)
{
  if (run->number == (side->runs == NULL ? 1 : side->run_count)) return 0;
  *run = side->runs == NULL ? (ct_span){0, side->fixed->point_count, 1} : side->runs[run->number];
  return 1;
}

/* The same as faces of a surface, whose runs end with them. */
static inline int ct_side_next_faces(const ct_side *side, ct_span *run)
{
  if (!ct_side_next(side, run)) return 0;
  run->first /= side->fixed->rule.count, run->end /= side->fixed->rule.count;
  return 1;
}

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

/* Position of point `i` relative to `origin` or, if null, to 0. */
void ct_side_position(const ct_side *side, int64_t i, const double *origin, double y[3]);

/* Error of the gaps of some sides by the rounding of their coordinates. */
double ct_side_rounding(const ct_side *sides, int count);

/* Move the nodes to the coordinates in `moved`, and replace these by the displacements. */
void ct_side_place(ct_side *side);

/* Normal of its face at point `i`, with the length of the area element. */
void ct_side_area(const ct_side *side, int64_t i, double normal[3]);

/* Depth of a place on a face of a side under another surface, which has a tree for its present
 * shape, and the place; negative or NaN if it is not inside. */
double ct_side_depth(const ct_side *side, const ct_search *other, int32_t face, const double xi[2],
                     double y[3]);

/* How much farther a place on a face may move than its nodes: Σ_a |N_a| at most (eq:gap-bound). */
static inline double ct_side_stretch(const ct_side *side)
{
  return side->search->per > side->search->edges ? 3.0 : 1.0;
}

/* Size of a change of a distance between two steps that may be rounding: the closest point of a
 * point at rest comes from another iteration. */
static inline double ct_side_unsure(const ct_side *side)
{
  return 16.0 * DBL_EPSILON * side->search->size;
}

/* A measured gap as it counts. */
static inline double ct_side_gap(const ct_side *side, double gap)
{
  return fabs(gap) <= side->nothing ? 0.0 : gap;
}

/* Distance below which a point and its closest point coincide: the gap vector has no direction. */
static inline double ct_side_coincident(const ct_side *side) { return 1e-12 * side->search->size; }

/* Set the unit direction of the force on a point whose gap has just been measured, `row.normal`:
 * along the line to its closest point, or the normal if the two coincide. The gap becomes NaN if
 * there is none. */
void ct_side_direct(const ct_side *side, ct_point *point);

#endif
