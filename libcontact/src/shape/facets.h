#ifndef CT_SRC_FACETS_H
#define CT_SRC_FACETS_H

#include "shape.h"
#include <libcontact/base.h>

#include "../base/memory.h"
#include "incidence.h"

/* Faces over which an effect integrates, and the sums of their nodal values at the nodes. */
typedef struct ct_facets {
  ct_face_kind kind;
  int per; /* nodes of a face */
  int32_t face_count, node_count;
  int32_t *faces;         /* node numbers of the problem, shape (face_count, per) */
  int32_t *nodes;         /* all of them once, ascending: those of `incidence` */
  ct_incidence incidence; /* places of the values of each node, in units of a node of a face */
  ct_rule rule;
  double N[9][8], dN[9][8][2];
} ct_facets;

/* Copy and check the faces: they exist, their nodes are below the number of nodes of the problem,
 * and each has an area at every Gauss point. Arrays are taken from the pool. `name` begins the text
 * of an error. */
ct_status ct_facets_create(ct_face_kind kind, int32_t face_count, const int32_t *faces,
                           int32_t node_count, const double *reference, const char *name,
                           ct_pool *pool, ct_facets *out, ct_error *error);

/* Coordinates of the nodes of a face, x + u (`u` may be null). */
void ct_facets_face(const ct_facets *facets, int32_t face, const double *x, const double *u,
                    ct_face *out);

/* Area vectors t1 x t2 at the Gauss points of a face, and their lengths. */
void ct_facets_areas(const ct_facets *facets, const ct_face *face, double area[25][3],
                     double length[25]);

/* Number of doubles for ct_facets_sum: one set for each node of each face, and temporary ones. */
size_t ct_facets_value_count(const ct_facets *facets, int components);

/* Sum values, shape (face_count, per, components), at the nodes: sums, shape (node_count,
 * components), independent of their order. */
void ct_facets_sum(const ct_facets *facets, int components, double *values, double *sums);

#endif
