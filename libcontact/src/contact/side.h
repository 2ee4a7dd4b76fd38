#ifndef CT_SRC_CONTACT_SIDE_H
#define CT_SRC_CONTACT_SIDE_H

#include <contact/contact.h>
#include <contact/quadrature.h>

#include "../grid.h"
#include "../search.h"

/* One Gauss point of a side, as the last update left it. */
typedef struct ct_gauss_point {
  int32_t other;  /* face of the other side, or -1 */
  double xi[2];   /* parameters of the closest point there */
  double d[3];    /* ȳ - y */
  double gap;     /* signed distance; NaN without `other` */
  double N[8];    /* shape functions of the other face at xi */
  double force[3]; /* ½ ε w J d where the gap is negative, else 0 */
} ct_gauss_point;

/* One surface of a contact with everything that is fixed (topology, weights) and current (coordinates, points, forces). */
typedef struct ct_side {
  ct_face_kind kind;
  int per;   /* nodes of a face */
  int edges; /* corners of a face */
  int32_t face_count;
  int32_t host_count; /* nodes of the host's arrays */
  int32_t node_count; /* nodes of the surface */
  int32_t *nodes;     /* their numbers in the host's arrays, ascending, shape (node_count) */
  int32_t *faces;     /* numbers in `nodes`, shape (face_count, per) */
  int32_t *neighbour; /* face across each edge, -1 at the border, shape (face_count, edges) */
  int32_t *ring_first, *ring; /* faces around each node: ring[ring_first[n]] ... */
  ct_rule rule;
  double N[27][8];    /* shape functions at the Gauss points */
  double *weight;     /* w J_ref, shape (face_count, rule.count) */
  double size;        /* largest diagonal of a face's reference box */

  double *x;          /* current coordinates, shape (node_count, 3) */
  ct_bounds *boxes;   /* current boxes of the faces */
  ct_search *search;  /* tree over the boxes of the last build */
  double *x_built;    /* coordinates at the last build */
  int32_t *candidate_first, *candidates; /* faces of the other side that may come near each face, until the next build */
  int32_t candidate_room;

  ct_gauss_point *points; /* shape (face_count, rule.count) */
  double *force, *force_fine; /* nodal forces: coarse and fine sums, shape (node_count, 3) */
} ct_side;

ct_status ct_side_init(ct_side *side, const ct_surface *surface, int body, ct_error *error);
void ct_side_clear(ct_side *side);

/* Copy the host's coordinates; CT_INVALID when one is not finite. */
ct_status ct_side_move(ct_side *side, const double *host, int body, ct_error *error);

/* Current coordinates of a face, as ct_project wants them. */
void ct_side_face(const ct_side *side, int32_t face, ct_face *out);

/* Box that holds the whole curved face (eq:face-bounds). */
ct_bounds ct_face_bounds(const ct_face *face);

/* Whether the foot of a projection lies on the border of the surface, or the outward direction there: the normal of the face
 * inside it, the sum of the two normals on an edge, the sum weighted by angles at a corner (eq:pseudo-normal). */
int ct_side_normal(const ct_side *side, int32_t face, const ct_projection *foot, double normal[3]);

/* Σ_a N_a (x_a - origin), paired so that a flipped face gives the same bits (eq:tree-sum). */
void ct_side_interpolate(const ct_side *side, int32_t face, const double N[8], const double origin[3], double out[3]);

/* Find the closest points of all points of `side` on `other` and their forces (eq:contact-force). */
void ct_pass_search(ct_side *side, const ct_side *other, const ct_contact_options *options, double depth);

#endif
