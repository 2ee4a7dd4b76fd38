#ifndef CT_SRC_CONTACT_SIDE_H
#define CT_SRC_CONTACT_SIDE_H

#include <libcontact/contact.h>
#include <libcontact/shape.h>

#include "../base/grid.h"
#include "../search/search_internal.h"

/* A method that compares distances places the closest point to the root of the rounding, as a part
 * of a face, and the gap of a point that touches is off by as much. */
static const double CT_CLOSEST_POINT_ERROR = 1e-6;

/* What is known of a point from the last update (eq:point-history): nothing; outside, over `other`;
 * in contact with `other`; inside, but not in contact. */
enum { CT_POINT_NEW, CT_POINT_OUTSIDE, CT_POINT_INSIDE, CT_POINT_BURIED };

/* One Gauss point of a side, as the last update left it. */
typedef struct ct_gauss_point {
  int32_t other;    /* face of the other side, or -1 */
  int32_t history;  /* CT_POINT_NEW, ... */
  double xi[2];     /* parameters of the closest point there */
  double d[3];      /* ȳ - y */
  double gap;       /* signed distance less `shift`; NaN without `other` */
  double known;     /* signed distance at the last update from the nearest place, in contact or not;
                       NaN: none was near */
  double normal[3]; /* outward normal of the other side at the foot, of any length */
  double N[8];      /* shape functions of the other face at xi */
  double shift;     /* start gap that `gap` counts from, of either sign (eq:initial-shift) */
  double closing;   /* by how much the shift grows until the next step */
  double force[3];  /* ½ ε w J d where the gap is negative, else 0; or what the enforcement makes of
                       the gap */
} ct_gauss_point;

/* Whether a point has a force. */
static inline int ct_point_presses(const ct_gauss_point *point)
{
  return point->force[0] != 0.0 || point->force[1] != 0.0 || point->force[2] != 0.0;
}

/* Signed distance of a point from the other side, whatever its gap counts from. */
static inline double ct_point_distance(const ct_gauss_point *point)
{
  return point->gap + point->shift;
}

/* One surface of a contact: its shape and tree, its weights, its points and forces. */
typedef struct ct_side {
  ct_search *search;
  ct_rule rule;
  int on_edges;        /* whether the rule has points on edges and corners */
  double N[27][8];     /* shape functions at the Gauss points */
  double dN[27][8][2]; /* and their derivatives */
  double *weight;      /* w J_ref, shape (face_count, rule.count) */
  double *listed;      /* the candidates of a face are complete to this distance, shape (face_count)
                          (eq:skin) */
  double *x_built;     /* coordinates at the last listing of candidates, shape (node_count, 3) */
  double *moved; /* how far the nodes have moved since the last update, shape (node_count, 3) */
  int32_t *candidate_first, *candidates; /* faces of the other side that may come near each face,
                                            until the next listing */
  int32_t candidate_room;
  double *reference; /* of a surface in contact with itself: its reference coordinates, shape
                        (node_count, 3); else null */

  ct_gauss_point *points;     /* shape (face_count, rule.count) */
  double *force, *force_fine; /* nodal forces: coarse and fine sums, shape (node_count, 3) */
} ct_side;

/* Points by the Gauss rule, or with `on_edges` by one that has points at corners and on edges too.
 */
ct_status ct_side_init(ct_side *side, const ct_surface *surface, int body, int on_edges,
                       ct_error *error);
void ct_side_clear(ct_side *side);

/* Number of Gauss points. */
int64_t ct_side_point_count(const ct_side *side);

/* Sum over the nodes of a face, paired so that a flipped face gives the same bits (eq:tree-sum);
 * terms beyond `per` are 0. */
static inline double ct_side_sum(int per, const double t[8])
{
  double corners = (t[0] + t[1]) + (t[2] + t[3]);
  return per > 4 ? corners + ((t[4] + t[6]) + (t[5] + t[7])) : corners;
}

/* Σ_a N_a (x_a - origin), paired so that a flipped face gives the same bits (eq:tree-sum). */
void ct_side_interpolate(const ct_side *side, int32_t face, const double N[8],
                         const double origin[3], double out[3]);

/* The same with reference coordinates, of a surface in contact with itself. */
void ct_side_interpolate_reference(const ct_side *side, int32_t face, const double N[8],
                                   const double origin[3], double out[3]);

/* Move the surface to the host's coordinates, which are good, and note how far its nodes have
 * moved. */
void ct_side_place(ct_side *side, const double *host);

/* How far a place of a face has moved since the last update. */
void ct_side_moved(const ct_side *side, int32_t face, const double N[8], double out[3]);

/* Normal of a face at its Gauss point q, of the length of the area element there. */
void ct_side_area(const ct_side *side, int32_t face, int q, double normal[3]);

/* Unit direction in which a point is pushed: along the line to its closest point, or where the two
 * coincide the normal there. Returns 0 where there is none. */
int ct_side_direction(const ct_side *side, const ct_gauss_point *point, double n[3]);

/* Add a force at a point of a face to the face's nodes, into sums that do not depend on their order
 * (eq:contact-force). */
static inline void ct_side_push(const ct_grid *grid, const ct_search *search, int64_t face,
                                const double N[8], const double force[3], double *coarse,
                                double *fine)
{
  for (int a = 0; a < search->per; a++) {
    int64_t node = 3 * (int64_t)search->faces[face * search->per + a];
    for (int c = 0; c < 3; c++)
      ct_grid_add(grid, N[a] * force[c], &coarse[node + c], &fine[node + c]);
  }
}

/* Find the closest points of all points of `side` on `other` and their forces (eq:contact-force).
 * Points look as far as `depth`, and a new one is in contact down to there; one of a surface with
 * itself is in contact down to `deep`; `first`: no point has a history yet. */
void ct_pass_search(ct_side *side, const ct_side *other, const ct_contact_options *options,
                    double depth, double deep, int first);

#endif
