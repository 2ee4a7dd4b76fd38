#include <libcontact/problem.h>

#include "effect_internal.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../constraint/solve.h"

/* The first call that an effect's table lacks; null: none. */
static const char *missing_call(const ct_effect *effect)
{
  const ct_effect_calls *calls = effect->calls;
  if (calls->force == NULL && effect->phase != CT_PHASE_REACTION) return "force";
  if (calls->create_scratch == NULL && calls->free_scratch != NULL) return "create_scratch";
  if (calls->free_scratch == NULL && calls->create_scratch != NULL) return "free_scratch";
  if (calls->constraints.list == NULL && effect->phase == CT_PHASE_CONSTRAINT)
    return "constraints.list";
  return NULL;
}

ct_status ct_effect_check(const ct_effect *effect, ct_error *error)
{
  if (effect->label == NULL || effect->node_count < 0 || effect->memory_count < 0 ||
      effect->constraint_count < 0 || effect->constraint_nodes < 0 ||
      effect->constraint_nodes > CT_ROW_NODES)
    return CT_REFUSE(
        error,
        "effect %s: it needs a label, counts that are not negative, and at most %d nodes "
        "per constraint",
        effect->label == NULL ? "(null)" : effect->label, (int)CT_ROW_NODES);
  if ((int)effect->phase < CT_PHASE_STATE || effect->phase > CT_PHASE_REACTION)
    return CT_REFUSE(error, "effect %s: there is no phase %d", effect->label, (int)effect->phase);
  if (effect->calls == NULL)
    return CT_REFUSE(error, "effect %s: its table of calls is null", effect->label);
  const char *missing = missing_call(effect);
  if (missing != NULL)
    return CT_REFUSE(error, "effect %s: its calls lack %s", effect->label, missing);
  if (effect->phase == CT_PHASE_REACTION && effect->calls->force != NULL)
    return CT_REFUSE(error, "effect %s: a reaction has no force of its own", effect->label);
  for (int32_t i = 0; effect->nodes != NULL && i < effect->node_count; i++)
    if (effect->nodes[i] < 0 || (i > 0 && effect->nodes[i] <= effect->nodes[i - 1]))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, effect->nodes[i]},
                     "effect %s: its nodes must ascend from 0, but node %d stands at place %d",
                     effect->label, (int)effect->nodes[i], (int)i);
  return CT_OK;
}

ct_status ct_effect_check_nodes(const ct_effect *effect, int32_t node_count, ct_error *error)
{
  int32_t count = effect->node_count;
  if (count == 0 ||
      (effect->nodes == NULL ? count == node_count : effect->nodes[count - 1] < node_count))
    return CT_OK;
  return CT_REFUSE(error, "effect %s: its nodes must be among those of the problem, 0 to %d",
                   effect->label, (int)node_count - 1);
}

ct_status ct_effect_copy(const ct_effect *filled, ct_effect **effect, ct_error *error)
{
  if (filled == NULL || effect == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_effect_check(filled, error);
  if (status != CT_OK) return status;
  *effect = ct_allocate(1, sizeof **effect);
  if (*effect == NULL) return CT_NO_MEMORY(error, "effect %s", filled->label);
  **effect = *filled;
  return CT_OK;
}

ct_status ct_effect_finish(ct_status status, const ct_effect *filled, ct_effect **effect,
                           ct_error *error)
{
  if (status == CT_OK) status = ct_effect_copy(filled, effect, error);
  if (status != CT_OK && filled->calls->free_data != NULL) filled->calls->free_data(filled->data);
  return status;
}

ct_status ct_effect_check_def(const int32_t *cookie, const ct_problem *problem, ct_effect **effect,
                              const char *what, ct_error *error)
{
  if (cookie == NULL || problem == NULL || effect == NULL)
    return CT_REFUSE(error, "%s: a required argument is null", what);
  if (*cookie != CT_DEF_COOKIE)
    return CT_REFUSE(error, "%s: the definition does not start from ct_%s_def_default", what, what);
  return CT_OK;
}

void *ct_effect_begin(const void *def, const ct_problem *problem, ct_effect **effect,
                      const char *what, size_t size, ct_status *status, ct_error *error)
{
  *status = ct_effect_check_def(def, problem, effect, what, error); // begins with its cookie
  void *data = *status == CT_OK ? ct_allocate(1, size) : NULL;
  if (*status == CT_OK && data == NULL) *status = CT_NO_MEMORY(error, "the effect %s", what);
  return data;
}

ct_status ct_effect_create(const ct_effect *filled, ct_effect **effect, ct_error *error)
{
  if (filled != NULL && filled->kind != CT_EFFECT_USER)
    return CT_REFUSE(
        error, "effect: its kind is %d, one of the library's own, which only the library can make",
        (int)filled->kind);
  return ct_effect_copy(filled, effect, error);
}

void ct_effect_free(ct_effect *effect)
{
  if (effect == NULL) return;
  if (effect->calls->free_data != NULL) effect->calls->free_data(effect->data);
  ct_release(effect);
}

int ct_problem_is_rigid(const ct_problem *problem, int32_t body)
{
  const int32_t first = problem->bodies[body].first_node,
                count = problem->bodies[body].mesh->node_count;
  for (int32_t k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->kind == CT_EFFECT_RIGID &&
        ct_effect_below(effect, first + count) - ct_effect_below(effect, first) == count)
      return 1;
  }
  return 0;
}

int32_t ct_effect_body_of(const ct_problem *problem, int32_t node)
{
  int32_t body = 0;
  while (body + 1 < problem->body_count && problem->bodies[body + 1].first_node <= node) body++;
  return body;
}

ct_place ct_effect_place(const ct_problem *problem, int32_t node)
{
  int32_t body = ct_effect_body_of(problem, node);
  return (ct_place){body, -1, node - problem->bodies[body].first_node};
}

ct_status ct_effect_body_nodes(const ct_problem *problem, const int32_t *bodies, int32_t body_count,
                               const char *name, ct_pool *pool, int32_t **nodes,
                               int32_t *node_count, ct_error *error)
{
  if (bodies != NULL && body_count < 1)
    return CT_REFUSE(error, "%s: the list of bodies is empty", name);
  for (int32_t i = 0; bodies != NULL && i < body_count; i++)
    if (bodies[i] < 0 || bodies[i] >= problem->body_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){bodies[i], -1, -1},
                     "%s: there is no body %d", name, (int)bodies[i]);
  *node_count = 0;
  *nodes = ct_pool_take(pool, (size_t)problem->node_count, sizeof **nodes);
  if (*nodes == NULL) return CT_NO_MEMORY(error, "%s", name);
  for (int32_t b = 0; b < problem->body_count; b++) {
    int listed = bodies == NULL;
    for (int32_t i = 0; !listed && i < body_count; i++) listed = bodies[i] == b;
    const ct_body *body = &problem->bodies[b];
    for (int32_t n = 0; listed && n < body->mesh->node_count; n++)
      (*nodes)[(*node_count)++] = body->first_node + n;
  }
  return CT_OK;
}
