#ifndef CT_SRC_SEARCH_BOX_TREE_H
#define CT_SRC_SEARCH_BOX_TREE_H

#include "bounds.h"

#include <libcontact/base.h>

/* A tree of boxes over `count` items, with four children per node (eq:bounding-tree). The boxes of
 * the items belong to the caller and are exact; the tree stores them in single precision, relative
 * to its own middle and size, rounded outwards. */
typedef struct ct_box_tree ct_box_tree;

ct_status ct_box_tree_create(int32_t count, ct_box_tree **out, ct_error *error);
void ct_box_tree_free(ct_box_tree *tree);

/* Build the tree over the items' boxes. */
void ct_box_tree_build(ct_box_tree *tree, const ct_bounds *boxes);

/* Update the tree for the boxes of moved items, or rebuild it if queries have become too expensive
 * (eq:tree-cost). */
void ct_box_tree_refit(ct_box_tree *tree, const ct_bounds *boxes);

/* Cost of a query in the present tree, and number of builds. */
double ct_box_tree_cost(const ct_box_tree *tree);
int64_t ct_box_tree_builds(const ct_box_tree *tree);

/* Write the items whose boxes overlap `box`, ascending, to `items` (capacity `capacity`); returns
 * the number of overlaps. `boxes` are those of the last build or refit. */
int32_t ct_box_tree_overlaps(const ct_box_tree *tree, const ct_bounds *boxes, const ct_bounds *box,
                             int32_t *items, int32_t capacity);

/* Examine one item; returns the square of the smallest known distance. Or: a lower bound of the
 * square of its distance. */
typedef double ct_box_visit(void *user, int32_t item);

/* Visit each item that may be as near to the point as the nearest, and few others, near ones first.
 * `square`: the square of a known distance, or infinity. `bound`: null, or a better lower bound of
 * an item's distance than that of its box. Items that tie with the best to rounding are all
 * visited. */
void ct_box_tree_visit(const ct_box_tree *tree, const double point[3], double square,
                       ct_box_visit *visit, ct_box_visit *bound, void *user);

#endif
