#ifndef CT_SRC_EFFECT_INTERNAL_H
#define CT_SRC_EFFECT_INTERNAL_H

#include <libcontact/problem.h>

#include "../base/error.h"
#include "../base/list.h"
#include "../base/memory.h"

/* An effect on the heap, copied from a filled one, of any kind; hosts have ct_effect_create. */
ct_status ct_effect_copy(const ct_effect *filled, ct_effect **effect, ct_error *error);

/* Numbers of the nodes of some bodies of a problem, ascending, or of all bodies if `bodies` is
 * null; from a pool. */
ct_status ct_effect_body_nodes(const ct_problem *problem, const int32_t *bodies, int32_t body_count,
                               const char *name, ct_pool *pool, int32_t **nodes,
                               int32_t *node_count, ct_error *error);

/* The body of a node of the problem. */
int32_t ct_effect_body_of(const ct_problem *problem, int32_t node);

/* Place of a node: its body, and its number there. */
ct_place ct_effect_place(const ct_problem *problem, int32_t node);

/* ``CT_ERROR_ARGUMENT`` for a null argument of a factory, or a definition that does not start from
 * its default (shown by its cookie). */
ct_status ct_effect_check_def(const int32_t *cookie, const ct_problem *problem, ct_effect **effect,
                              const char *what, ct_error *error);

/* The beginning of a factory: check the definition and allocate the effect's data, of `size` bytes,
 * a struct that begins with a pool, so that `ct_pool_free` frees them. Null with `status`. */
void *ct_effect_begin(const void *def, const ct_problem *problem, ct_effect **effect,
                      const char *what, size_t size, ct_status *status, ct_error *error);

/* Whether surfaces touch in an effect: a contact, an obstacle or a tie. */
static inline int ct_effect_touches(const ct_effect *effect)
{
  return effect->kind == CT_EFFECT_CONTACT || effect->kind == CT_EFFECT_OBSTACLE ||
         effect->kind == CT_EFFECT_TIE;
}

/* Node of the problem that is the i-th of an effect. */
static inline int32_t ct_effect_node(const ct_effect *effect, int32_t i)
{
  return effect->nodes == NULL ? i : effect->nodes[i];
}

/* Number of nodes of an effect below a node of the problem. */
static inline int32_t ct_effect_below(const ct_effect *effect, int32_t node)
{
  int32_t count = effect->node_count;
  if (effect->nodes != NULL) return ct_lower_bound(effect->nodes, count, node);
  return count < node ? count : node;
}

/* Whether the nodes of an effect from the i-th up to the one before the end-th, at least one, have
 * consecutive numbers. */
static inline int ct_effect_is_row(const ct_effect *effect, int32_t i, int32_t end)
{
  return ct_effect_node(effect, end - 1) - ct_effect_node(effect, i) == end - 1 - i;
}

/* Check that the members of an effect are consistent and its nodes ascend. */
ct_status ct_effect_check(const ct_effect *effect, ct_error *error);

/* Check that an effect's nodes, which ascend, belong to a problem with so many nodes. */
ct_status ct_effect_check_nodes(const ct_effect *effect, int32_t node_count, ct_error *error);

/* The end of a factory: with CT_OK the effect on the heap, otherwise its data are freed. */
ct_status ct_effect_finish(ct_status status, const ct_effect *filled, ct_effect **effect,
                           ct_error *error);

#endif
