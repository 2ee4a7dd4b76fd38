#ifndef CT_SRC_FACETS_H
#define CT_SRC_FACETS_H

#include "shape.h"
#include <libcontact/base.h>

/* Faces on which an effect integrates, and the sums of their nodal values at the nodes. */
typedef struct ct_facets {
  ct_face_kind kind;
  int per; /* nodes of a face */
  int32_t face_count, node_count;
  int32_t *faces; /* node numbers of the problem, shape (face_count, per) */
  int32_t *nodes; /* all of them once, ascending */
  /* Where the values of each node stand: place[first[i]] ... place[first[i + 1] - 1], in units of a
   * node of a face. */
  int32_t *first, *place;
  int32_t most; /* the most places of a node */
  ct_rule rule;
  double N[9][8], dN[9][8][2];
} ct_facets;

/* Copy and check the faces: they exist, their nodes are those of a problem with so many nodes, and
 * each has an area at every Gauss point. `name` begins the words of an error. */
ct_status ct_facets_create(ct_face_kind kind, int32_t face_count, const int32_t *faces,
                           int32_t node_count, const double *reference, const char *name,
                           ct_facets **out, ct_error *error);

void ct_facets_free(ct_facets *facets);

/* Coordinates of the nodes of a face, x + u (`u` may be null). */
void ct_facets_face(const ct_facets *facets, int32_t face, const double *x, const double *u,
                    ct_face *out);

/* Sum values, shape (face_count, per, 3), at the nodes: sums, shape (node_count, 3), in an order
 * that does not matter. `terms` has room for `most` numbers. */
void ct_facets_sum(const ct_facets *facets, const double *values, double *terms, double *sums);

#endif
