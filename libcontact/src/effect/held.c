/* Prescribed components of nodes, for supports and motions. */
#include "held.h"

#include "../base/amplitude.h"
#include "../base/error.h"

#include <math.h>
#include <string.h>

/* Of motions, and of supports. */
static const char *const NAME[] = {"motion", "support"}, *const VALUE[] = {"displacement",
                                                                           "velocity"};

static ct_status check(const ct_motion *motion, int support, int32_t number, int32_t node_count,
                       ct_error *error)
{
  if (motion->nodes == NULL || motion->node_count < 1)
    return CT_REFUSE(error, "%s %d has no nodes", NAME[support], (int)number);
  if (!motion->fixed[0] && !motion->fixed[1] && !motion->fixed[2])
    return CT_REFUSE(error, "%s %d prescribes no component; at least one of x, y, z is needed",
                     NAME[support], (int)number);
  for (int c = 0; c < 3; c++)
    if (motion->fixed[c] && !isfinite(motion->displacement[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "%s %d: %s %c is not finite", NAME[support],
                     (int)number, VALUE[support], "xyz"[c]);
  for (int32_t i = 0; i < motion->node_count; i++)
    if (motion->nodes[i] < 0 || motion->nodes[i] >= node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, motion->nodes[i]},
                     "%s %d names node %d, there are nodes 0 to %d", NAME[support], (int)number,
                     (int)motion->nodes[i], (int)node_count - 1);
  return CT_OK;
}

/* Whether two motions move a component equally at all times. */
static int agree(const ct_motion *a, const ct_motion *b, int c)
{
  if (a->displacement[c] != b->displacement[c]) return 0;
  if (a->displacement[c] == 0.0) return 1;
  if (a->amplitude.count != b->amplitude.count) return 0;
  for (int32_t i = 0; i < a->amplitude.count; i++)
    if (a->amplitude.time[i] != b->amplitude.time[i] ||
        a->amplitude.value[i] != b->amplitude.value[i])
      return 0;
  return 1;
}

/* Enter one motion into a table over all nodes of the problem. Two motions may agree. */
static ct_status enter(const ct_motion *motions, int support, int32_t number, int32_t *holder,
                       ct_error *error)
{
  const ct_motion *motion = &motions[number];
  for (int32_t i = 0; i < motion->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int32_t *own = &holder[3 * (int64_t)motion->nodes[i] + c];
      if (!motion->fixed[c]) continue;
      const ct_motion *other = *own == 0 ? motion : &motions[*own - 1];
      if (other != motion && !agree(motion, other, c))
        return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, motion->nodes[i]},
                       "%s %d: %c of node %d is prescribed by %s %d already (%s %g, not %g)",
                       NAME[support], (int)number, "xyz"[c], (int)motion->nodes[i], NAME[support],
                       (int)*own - 1, VALUE[support], other->displacement[c],
                       motion->displacement[c]);
      *own = number + 1;
    }
  return CT_OK;
}

/* Keep the rows of nodes with a prescribed component. */
static void compress(ct_held *held, int32_t node_count, const int32_t *holder)
{
  static const int32_t none[3] = {0, 0, 0};
  for (int32_t n = 0; n < node_count; n++)
    held->node_count += memcmp(&holder[3 * (int64_t)n], none, sizeof none) != 0;
  held->holder = ct_pool_take(&held->pool, (size_t)held->node_count, sizeof none);
  if (held->node_count < node_count)
    held->nodes = ct_pool_take(&held->pool, (size_t)held->node_count, sizeof *held->nodes);
  for (int32_t n = 0, next = 0; !held->pool.failed && n < node_count; n++) {
    if (memcmp(&holder[3 * (int64_t)n], none, sizeof none) == 0) continue;
    memcpy(&held->holder[3 * (int64_t)next], &holder[3 * (int64_t)n], sizeof none);
    if (held->nodes != NULL) held->nodes[next] = n;
    next++;
  }
}

ct_status ct_held_fill(ct_held *held, ct_scene_part part, const ct_problem *problem,
                       const ct_motion *motions, int32_t count, ct_error *error)
{
  int support = part == CT_PART_SUPPORT;
  if (held->pool.failed) return CT_NO_MEMORY(error, "the %ss", NAME[support]);
  if (motions == NULL || count < 1)
    return CT_REFUSE(error, "%s: the list of %ss is empty", NAME[support], NAME[support]);
  int32_t *holder = ct_allocate((size_t)problem->node_count, 3 * sizeof *holder);
  held->motions = ct_pool_copy(&held->pool, motions, (size_t)count * sizeof *motions);
  held->mass = problem->mass;
  held->inverse_mass = problem->inverse_mass;
  held->pool.failed |= holder == NULL;
  ct_status status = CT_OK;
  for (int32_t i = 0; status == CT_OK && !held->pool.failed && i < count; i++) {
    ct_motion *own = &held->motions[i];
    status = check(&motions[i], support, i, problem->node_count, error);
    if (status == CT_OK) status = enter(motions, support, i, holder, error);
    if (status == CT_OK) status = ct_amplitude_copy(&held->pool, &own->amplitude, error);
    own->nodes = NULL;
    ct_blame(error, status, part, i);
  }
  if (status == CT_OK && !held->pool.failed) compress(held, problem->node_count, holder);
  ct_release(holder);
  return status == CT_OK && held->pool.failed ? CT_NO_MEMORY(error, "the %ss", NAME[support])
                                              : status;
}
