#ifndef CT_SRC_SEARCH_INTERNAL_H
#define CT_SRC_SEARCH_INTERNAL_H

#include <libcontact/search.h>

#include "../shape/shape.h"
#include "box_tree.h"
#include "../shape/incidence.h"

/* Default tolerance of a search. */
static const double CT_SEARCH_TOLERANCE = 1e-10;

/* A surface with its topology, its current shape and its tree. */
struct ct_search {
  ct_pool pool;
  ct_face_kind kind;
  int per;   /* nodes of a face */
  int edges; /* corners of a face */
  int32_t face_count;
  int32_t host_count;     /* nodes of the host's arrays */
  int32_t node_count;     /* nodes of the surface */
  int32_t *nodes;         /* their numbers in the host's arrays, ascending: those of `incidence` */
  int32_t *faces;         /* numbers in `nodes`, shape (face_count, per) */
  int32_t *neighbour;     /* face across each edge, -1 at the border, shape (face_count, edges) */
  ct_incidence incidence; /* of nodes in the list of faces: position / per is a face */
  double size;            /* largest distance of two nodes of a face in the reference shape */
  double *x;              /* current coordinates, shape (node_count, 3), and one number more */
  ct_bounds *boxes;       /* current boxes of the faces */
  /* For a surface that is searched, else null: */
  ct_oriented *oriented; /* boxes along the faces, of the last refit; null for T3, and where few
                            points are searched for at one shape */
  ct_box_tree *tree;     /* over the boxes of the last refit */
};

/* ct_search_create for surface number `body` of a host. The surface cannot be searched yet. */
ct_status ct_search_init(const ct_surface *surface, int body, ct_search **out, ct_error *error);

/* CT_INVALID if a coordinate of the surface's nodes is not finite or beyond 1e70. They are in `x`
 * at `nodes`, as numbered in the host's arrays, or in order if `nodes` is null. */
ct_status ct_search_check(const ct_search *search, const int32_t *nodes, const double *x, int body,
                          ct_error *error);

/* Compute the boxes of the faces at these coordinates. */
void ct_search_box(ct_search *search);

/* Update the tree for the boxes. */
void ct_search_refit(ct_search *search);

/* A surface with its own coordinates, which shares the topology of `search` and begins at its
 * coordinates, without boxes. Free it before `search`. */
ct_status ct_search_share(const ct_search *search, ct_search **out);

/* Create boxes, and allocate a tree, which is not built yet. */
ct_status ct_search_equip(ct_search *search);

/* Both, with the tree, so that a call may search a surface that is const to it. Free `*out` also if
 * this fails. */
ct_status ct_search_snapshot(const ct_search *search, ct_search **out);

/* Parameters of the middle of a face. */
static inline const double *ct_search_middle(const ct_search *search)
{
  static const double middle[2][2] = {{0.0, 0.0}, {1.0 / 3.0, 1.0 / 3.0}};
  return middle[search->edges == 3];
}

/* Present coordinates of a face, in the form for ct_project. */
void ct_search_face(const ct_search *search, int32_t face, ct_face *out);

/* Whether two faces have a node in common. */
int ct_search_adjacent(const ct_search *search, int32_t face, int32_t other);

/* Unit normal at the middle of a face. Returns 0 if it has none. */
int ct_search_middle_normal(const ct_search *search, int32_t face, double normal[3]);

/* Outward direction at a closest point on a face: the normal inside the face, the sum of the two
 * normals on an edge, the sum weighted by the angles between tangents at a corner
 * (eq:pseudo-normal). Returns 0 if the closest point lies on the border of the surface; existing
 * faces are summed all the same. */
int ct_search_normal(const ct_search *search, int32_t face, ct_where where, int index,
                     const double xi[2], const double own[3], double normal[3]);

/* Whether the distance increases from a closest point into each face that meets there, so that it
 * is a local minimum on the whole surface and not only on its face (eq:local-minimum). `d` points
 * from the point to the closest point. Inside a face this is always true. */
int ct_search_is_minimum(const ct_search *search, int32_t face, ct_where where, int index,
                         const double xi[2], const double d[3]);

/* Squared distance of a point from face `face`, a triangle with corners as nodes; with its
 * parameters and the vector to it (eq:triangle-inside). */
double ct_search_triangle(const ct_search *search, int32_t face, const double point[3],
                          double xi[2], double d[3]);

/* Whether a face is excluded from a query. */
typedef int ct_search_skip(void *user, int32_t face);

/* Nearest face of one point. `start`: -1 or a face to begin with. `bound`: the square of a distance
 * at which there is a face, or infinity. `skip`: null, or faces to exclude. */
void ct_search_point(const ct_search *search, const double point[3], int32_t start, double bound,
                     double tolerance, ct_search_skip *skip, void *user, ct_nearest *out);

#endif
