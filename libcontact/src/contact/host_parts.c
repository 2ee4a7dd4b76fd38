/* The obstacles and the friction of a host's contact: the effects of a scene with the host's data.
 */
#include "host.h"

#include "../base/error.h"
#include "../base/threads.h"

#include <math.h>

const ct_host_part *ct_host_obstacle(const ct_contact *contact, int32_t number)
{
  const ct_host_part *part = contact->host == NULL ? NULL : contact->host->parts;
  for (; part != NULL; part = part->next)
    if (part->effect->kind == CT_EFFECT_OBSTACLE && number-- == 0) break;
  return part;
}

/* Refuse to extend a contact that is null or has taken a step. */
static ct_status check_new(const ct_contact *contact, ct_error *error)
{
  if (contact == NULL) return CT_REFUSE(error, "contact: null argument");
  if (contact->host != NULL && contact->host->open)
    return CT_REFUSE(error, "contact: obstacles and friction must be added before the first step");
  return CT_OK;
}

/* Take ownership of an effect as the last part; out of memory, it is freed. */
static ct_status append(ct_contact *contact, ct_effect *effect, const ct_host_part *on, int side,
                        ct_error *error)
{
  ct_host *h = ct_host_of(contact);
  ct_host_part *part = h == NULL ? NULL : ct_allocate(1, sizeof *part);
  if (part == NULL) {
    ct_effect_free(effect);
    return CT_NO_MEMORY(error, "the steps of a contact");
  }
  *part = (ct_host_part){.effect = effect, .on = on, .side = side};
  ct_host_part **last = &h->parts;
  while (*last != NULL) last = &(*last)->next;
  *last = part;
  return CT_OK;
}

ct_status ct_contact_add_obstacle(ct_contact *contact, int32_t side,
                                  const ct_obstacle_def *obstacle, ct_error *error)
{
  ct_effect *effect = NULL;
  ct_status status = check_new(contact, error);
  if (status != CT_OK) return status;
  if (side < 0 || side >= contact->fixed->sides || obstacle == NULL)
    return CT_REFUSE(error, "contact: null argument, or there is no surface %d", (int)side);
  // The problem of the obstacle consists of the surface's nodes, in order.
  const ct_search *search = contact->fixed->side[side].search;
  const ct_problem nodes = {.node_count = search->node_count, .reference = search->x};
  ct_obstacle_def def = *obstacle;
  def.kind = search->kind, def.face_count = search->face_count, def.faces = search->faces;
  status = ct_obstacle_create_effect(&def, &nodes, &effect, error);
  return status == CT_OK ? append(contact, effect, NULL, side, error) : status;
}

ct_status ct_contact_add_friction(ct_contact *contact, int32_t on, double coefficient,
                                  double tangent, ct_error *error)
{
  ct_effect *effect = NULL;
  ct_friction_def def = ct_friction_def_default();
  ct_status status = check_new(contact, error);
  if (status != CT_OK) return status;
  const ct_host_part *obstacle = on < 0 ? NULL : ct_host_obstacle(contact, on);
  if (on < -1 || (on >= 0 && obstacle == NULL) || (on == -1 && contact->fixed->alone))
    return CT_REFUSE(error, "friction: there is no obstacle %d and no other surface", (int)on);
  const ct_host_part *part = contact->host == NULL ? NULL : contact->host->parts;
  for (; part != NULL; part = part->next)
    if (part->effect->kind == CT_EFFECT_FRICTION && part->on == obstacle)
      return CT_REFUSE(error, "friction: there is one already");
  def.coefficient = coefficient, def.tangent = tangent;
  if (obstacle != NULL) def.on = obstacle->effect;
  status = ct_friction_create(&def, obstacle == NULL ? contact->fixed : NULL, &effect, error);
  if (status != CT_OK) return status;
  return append(contact, effect, obstacle, obstacle == NULL ? -1 : obstacle->side, error);
}

ct_view ct_host_view(const ct_contact *contact, const ct_host_part *part,
                     const ct_contact_prediction *p)
{
  const ct_host *h = contact->host;
  const int side = part->side < 0 ? 0 : part->side;
  // The sides are at the host's present nodes, so the displacement is zero.
  return (ct_view){.time = h->now.time,
                   .threads = ct_threads(contact->threads),
                   .reference = contact->side[side].search->x,
                   .displacement = h->rest,
                   .dt = p->dt,
                   .c_dt = p->kick,
                   .r_dt = p->kick,
                   .velocity = h->velocity[side],
                   .memory = h->memory + part->memory,
                   .next_memory = h->next_memory + part->memory,
                   .scratch = part->scratch,
                   .read = part->on != NULL ? part->on->scratch : (const void *)contact};
}

static ct_host_drag load_drag(const double *memory, const ct_host_part *part)
{
  ct_host_drag drag;
  memcpy(&drag, memory + part->memory + part->effect->memory_count, sizeof drag);
  return drag;
}

/* Force of friction on an obstacle, and the work of the obstacle's motion against it
 * (eq:obstacle-work). */
static void count_drag(ct_host *h, const ct_host_part *part)
{
  const ct_obstacle_state *obstacle = part->on->scratch;
  const ct_host_drag last = load_drag(h->memory, part);
  ct_host_drag next = {.begun = 1.0, .work = last.work};
  memcpy(next.place, obstacle->place, sizeof next.place);
  for (int c = 0; c < 3; c++) {
    for (int32_t n = 0; n < part->effect->node_count; n++)
      h->terms[n] = -part->force[3 * (int64_t)n + c];
    next.force[c] = ct_sum(h->terms, part->effect->node_count);
    if (last.begun != 0.0)
      next.work -= 0.5 * (next.force[c] + last.force[c]) * (next.place[c] - last.place[c]);
  }
  memcpy(h->next_memory + part->memory + part->effect->memory_count, &next, sizeof next);
}

ct_status ct_host_find_forces(ct_contact *contact, const ct_contact_prediction *p, ct_error *error)
{
  ct_host *h = contact->host;
  for (ct_host_part *part = h->parts; part != NULL; part = part->next) {
    const ct_view view = ct_host_view(contact, part, p);
    ct_status status = part->effect->force(part->effect, &view, part->force, error);
    if (status != CT_OK) return status;
    if (part->on != NULL) count_drag(h, part);
  }
  return CT_OK;
}

/* Energy stored by an obstacle after the last step. */
static double held_by(const ct_host_part *part)
{
  const ct_view view = {.scratch = part->scratch};
  double energy = 0.0;
  return part->effect->energy(part->effect, &view, &energy, NULL) == CT_OK ? energy : NAN;
}

void ct_host_sum_parts(ct_host *host)
{
  host->held = host->friction = host->motion = host->removal = 0.0;
  for (const ct_host_part *part = host->parts; part != NULL; part = part->next) {
    double slip, lost;
    if (part->effect->kind == CT_EFFECT_OBSTACLE) {
      host->held += held_by(part);
      host->motion += ((const ct_obstacle_state *)part->scratch)->work;
      host->removal += ((const ct_obstacle_state *)part->scratch)->removal;
      continue;
    }
    ct_friction_sums(part->effect, part->scratch, &slip, &lost);
    host->held += slip;
    host->friction += lost;
    if (part->on != NULL) host->motion += load_drag(host->next_memory, part).work;
  }
}

ct_status ct_contact_reaction(const ct_contact *contact, int32_t obstacle, double force[3],
                              double *work, ct_error *error)
{
  const ct_host_part *part = contact == NULL ? NULL : ct_host_obstacle(contact, obstacle);
  if (part == NULL || force == NULL || work == NULL)
    return CT_REFUSE(error, "contact: null argument, or no obstacle %d", (int)obstacle);
  if (!contact->host->current)
    return CT_REFUSE(error, "contact: the last call was not a successful ct_contact_step");
  const ct_obstacle_state *state = part->scratch;
  memcpy(force, state->reaction, sizeof state->reaction);
  *work = state->work;
  for (const ct_host_part *rub = part->next; rub != NULL; rub = rub->next)
    if (rub->on == part) {
      const ct_host_drag drag = load_drag(contact->host->memory, rub);
      for (int c = 0; c < 3; c++) force[c] += drag.force[c];
      *work += drag.work;
    }
  return CT_OK;
}

ct_status ct_contact_obstacle_penetration(const ct_contact *contact, int32_t obstacle,
                                          ct_penetration_at at, ct_penetration *out,
                                          ct_error *error)
{
  const ct_host_part *part = contact == NULL ? NULL : ct_host_obstacle(contact, obstacle);
  if (part == NULL || out == NULL)
    return CT_REFUSE(error, "contact: null argument, or no obstacle %d", (int)obstacle);
  if (!contact->host->current)
    return CT_REFUSE(error, "contact: the last call was not a successful ct_contact_step");
  return ct_obstacle_depth(part->scratch, at, out, error);
}

/* Node `n` of a part in the host's arrays: its surface, and its number there. */
static int32_t node_of(const ct_contact *contact, const ct_host_part *part, int32_t n, int *side)
{
  const ct_contact_fixed *fixed = contact->fixed;
  *side = part->side;
  if (part->side >= 0) return fixed->side[part->side].search->nodes[n];
  const int32_t node = fixed->nodes[n], first = fixed->side[0].search->host_count;
  *side = !fixed->one_array && node >= first;
  return *side == 1 ? node - first : node;
}

ct_status ct_host_add_force(const ct_contact *contact, double *const f[2], ct_error *error)
{
  const ct_host *h = contact->host;
  if (h->parts != NULL && contact->fixed->sides == 2 && contact->fixed->one_array && f[0] != f[1])
    return CT_REFUSE(error, "contact: two surfaces on one array of nodes need one array of forces");
  for (const ct_host_part *part = h->parts; part != NULL; part = part->next)
    for (int32_t n = 0; n < part->effect->node_count; n++) {
      int side;
      const int64_t dof = 3 * (int64_t)node_of(contact, part, n, &side);
      for (int c = 0; c < 3; c++) f[side][dof + c] += part->force[3 * (int64_t)n + c];
    }
  return CT_OK;
}

/* Bound of ω² of the springs on an obstacle's points; `mass` has the host's numbering. */
static ct_status obstacle_bound(const ct_contact *contact, const ct_host_part *part,
                                const double *mass, double *omega2)
{
  const ct_search *search = contact->fixed->side[part->side].search;
  double *own = ct_allocate((size_t)search->node_count, sizeof *own);
  if (own == NULL) return CT_ERROR_MEMORY;
  for (int32_t n = 0; n < search->node_count; n++) own[n] = mass[search->nodes[n]];
  *omega2 = ct_obstacle_springs(part->effect, own);
  ct_release(own);
  return CT_OK;
}

/* Bound of ω² of one part: friction as a scene's, an obstacle if its penalty is explicit. */
static ct_status part_bound(const ct_contact *contact, const ct_host_part *part,
                            const double *const mass[2], double *omega2)
{
  const int rubs = part->effect->kind == CT_EFFECT_FRICTION;
  const ct_host_part *obstacle = part->on != NULL ? part->on : part;
  ct_status status = CT_OK;
  *omega2 = 0.0;
  if (part->side < 0) status = ct_contact_facing_bound(contact, mass[0], mass[1], omega2);
  else if (rubs || part->effect->phase == CT_PHASE_STATE)
    status = obstacle_bound(contact, obstacle, mass[part->side], omega2);
  if (rubs) *omega2 *= ct_friction_stiffness(part->effect);
  return status;
}

ct_status ct_host_omega2_bound(const ct_contact *contact, const double *const mass[2],
                               double *omega2)
{
  *omega2 = 0.0;
  // -- Only forces that follow from gaps and slips of now limit the step (eq:controlled-energy)
  ct_status status = CT_OK;
  if (ct_contact_is_penalty(contact->fixed))
    status = ct_contact_omega2_bound(contact, mass[0], mass[1], omega2);
  const ct_host_part *part = contact->host == NULL ? NULL : contact->host->parts;
  for (; status == CT_OK && part != NULL; part = part->next) {
    double own;
    status = part_bound(contact, part, mass, &own);
    *omega2 += own;
  }
  return status;
}
