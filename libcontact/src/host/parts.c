/* The obstacles and the friction of a host's contact. */
#include "host.h"

#include "../base/error.h"

#include <libcontact/base.h>

#include <string.h>

ct_host *ct_host_of(ct_contact *contact)
{
  if (contact->host != NULL) return contact->host;
  ct_host *h = contact->host = ct_allocate(1, sizeof *h);
  if (h != NULL) h->contact = (ct_host_part){.is = &contact->own->is, .state = contact, .side = -1};
  return h;
}

ct_status ct_host_check_current(const ct_contact *contact, ct_error *error)
{
  if (contact->host != NULL && contact->host->current) return CT_OK;
  return CT_REFUSE(error, "contact: the last call was not a successful ct_contact_step");
}

static int is_obstacle(const ct_host_part *part) { return part->is->on == NULL; }

const ct_host_part *ct_host_obstacle(const ct_contact *contact, int32_t number)
{
  const ct_host_part *part = contact->host == NULL ? NULL : contact->host->contact.next;
  for (; part != NULL; part = part->next)
    if (is_obstacle(part) && number-- == 0) break;
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

/* Take ownership of an interaction as the last part; out of memory, it is freed. */
static ct_status append(ct_contact *contact, ct_interaction *is, const ct_host_part *on, int side,
                        ct_error *error)
{
  ct_host *h = ct_host_of(contact);
  ct_host_part *part = h == NULL ? NULL : ct_allocate(1, sizeof *part), *last;
  void *state = NULL;
  if (part == NULL || is->calls->open(is, &state, error) != CT_OK) {
    ct_release(part);
    is->calls->free(is);
    return CT_NO_MEMORY(error, "the steps of a contact");
  }
  *part = (ct_host_part){.is = is, .state = state, .on = on, .side = side};
  for (last = &h->contact; last->next != NULL; last = last->next) continue;
  last->next = part;
  return CT_OK;
}

ct_status ct_contact_add_obstacle(ct_contact *contact, int32_t side,
                                  const ct_obstacle_def *obstacle, ct_error *error)
{
  ct_interaction *is = NULL;
  ct_status status = check_new(contact, error);
  if (status != CT_OK) return status;
  if (side < 0 || side >= contact->fixed->gaps.sides || obstacle == NULL)
    return CT_REFUSE(error, "contact: null argument, or there is no surface %d", (int)side);
  // The obstacle numbers the nodes of the surface in order.
  const ct_search *search = contact->fixed->gaps.side[side].search;
  const ct_surface surface = {search->kind, search->node_count, search->face_count, search->faces,
                              search->x};
  status = ct_obstacle_create(obstacle, &surface, &is, error);
  return status == CT_OK ? append(contact, is, NULL, side, error) : status;
}

ct_status ct_contact_add_friction(ct_contact *contact, int32_t on, double coefficient,
                                  double tangent, ct_error *error)
{
  ct_interaction *is = NULL;
  ct_status status = check_new(contact, error);
  if (status != CT_OK) return status;
  const ct_host *h = ct_host_of(contact);
  if (h == NULL) return CT_NO_MEMORY(error, "the steps of a contact");
  const ct_host_part *what = on < 0 ? &h->contact : ct_host_obstacle(contact, on);
  if (on < -1 || what == NULL || (on == -1 && contact->fixed->gaps.alone))
    return CT_REFUSE(error, "friction: there is no obstacle %d and no other surface", (int)on);
  for (const ct_host_part *part = h->contact.next; part != NULL; part = part->next)
    if (part->on == what) return CT_REFUSE(error, "friction: there is one already");
  status = ct_friction_create(coefficient, tangent, what->is, &is, error);
  return status == CT_OK ? append(contact, is, what, what->side, error) : status;
}

int32_t ct_host_node(const ct_contact *contact, const ct_host_part *part, int32_t n, int *side)
{
  const ct_contact_fixed *fixed = contact->fixed;
  *side = part->side;
  if (part->side >= 0) return fixed->gaps.side[part->side].search->nodes[n];
  const int32_t node = fixed->nodes[n], first = fixed->gaps.side[0].search->host_count;
  *side = !fixed->one_array && node >= first;
  return *side == 1 ? node - first : node;
}

ct_surface_motion ct_host_motion(const ct_host *h, const ct_host_part *part,
                                 const ct_surface_motion *now)
{
  const ct_host_part *at = part->on == NULL ? part : part->on;
  ct_surface_motion motion = *now;
  motion.x = at->x;
  motion.velocity = at->velocity;
  motion.memory = h->memory + part->memory;
  motion.next_memory = h->next_memory + part->memory;
  motion.on = part->on == NULL ? NULL : at->state;
  return motion;
}

static ct_host_drag load_drag(const double *memory, const ct_host_part *part)
{
  ct_host_drag drag;
  memcpy(&drag, memory + part->memory + part->is->memory_count, sizeof drag);
  return drag;
}

/* Force of friction on an obstacle, and the work of the obstacle's motion against it
 * (eq:obstacle-work). */
static void count_drag(ct_host *h, const ct_host_part *part)
{
  const ct_obstacle_state *obstacle = part->on->state;
  const ct_host_drag last = load_drag(h->memory, part);
  ct_host_drag next = {.begun = 1.0, .work = last.work};
  memcpy(next.place, obstacle->place, sizeof next.place);
  for (int c = 0; c < 3; c++) {
    for (int32_t n = 0; n < part->is->node_count; n++)
      h->terms[n] = -part->force[3 * (int64_t)n + c];
    next.force[c] = ct_sum(h->terms, part->is->node_count);
    if (last.begun != 0.0)
      next.work -= 0.5 * (next.force[c] + last.force[c]) * (next.place[c] - last.place[c]);
  }
  memcpy(h->next_memory + part->memory + part->is->memory_count, &next, sizeof next);
}

ct_status ct_host_find_forces(ct_host *h, const ct_surface_motion *now, ct_error *error)
{
  ct_status status = CT_OK;
  for (ct_host_part *part = &h->contact; status == CT_OK && part != NULL; part = part->next) {
    const ct_surface_motion motion = ct_host_motion(h, part, now);
    status = part->is->calls->find_forces(part->state, &motion, part->force, error);
    if (status == CT_OK && ct_host_has_drag(part)) count_drag(h, part);
  }
  return status;
}

void ct_host_sum_energy(ct_host *h)
{
  h->energy = (ct_interaction_energy){.stored = 0.0};
  for (const ct_host_part *part = h->contact.next; part != NULL; part = part->next) {
    ct_interaction_energy own;
    part->is->calls->find_energy(part->state, &own);
    h->energy.stored += own.stored;
    h->energy.dissipated += own.dissipated;
    h->energy.motion += own.motion;
    h->energy.removal += own.removal;
    if (ct_host_has_drag(part)) h->energy.motion += load_drag(h->next_memory, part).work;
  }
}

/* An obstacle with the forces of a step; null if there is none. */
static const ct_host_part *stepped(const ct_contact *contact, int32_t obstacle, const void *out,
                                   ct_status *status, ct_error *error)
{
  const ct_host_part *part = contact == NULL ? NULL : ct_host_obstacle(contact, obstacle);
  *status = part == NULL || out == NULL
                ? CT_REFUSE(error, "contact: null argument, or no obstacle %d", (int)obstacle)
                : ct_host_check_current(contact, error);
  return *status == CT_OK ? part : NULL;
}

ct_status ct_contact_reaction(const ct_contact *contact, int32_t obstacle, double force[3],
                              double *work, ct_error *error)
{
  ct_status status;
  const ct_host_part *part =
      stepped(contact, obstacle, force == NULL ? NULL : work, &status, error);
  if (part == NULL) return status;
  const ct_obstacle_state *state = part->state;
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
  ct_status status;
  const ct_host_part *part = stepped(contact, obstacle, out, &status, error);
  return part == NULL ? status : ct_obstacle_depth(part->state, at, out, error);
}

/* Tractions at an obstacle, which numbers the nodes of its surface in order. */
static ct_status obstacle_traction(const ct_contact *contact, const ct_host_part *part,
                                   double *traction, double *area, ct_error *error)
{
  const ct_search *search = contact->fixed->gaps.side[part->side].search;
  double *own = ct_allocate((size_t)search->node_count, 4 * sizeof *own),
         *own_area = own == NULL ? NULL : own + 3 * (int64_t)search->node_count;
  if (own == NULL) return CT_NO_MEMORY(error, "tractions");
  const ct_obstacle_state *obstacle = part->state;
  ct_status status =
      ct_side_traction(obstacle->side, ct_obstacle_stations(obstacle), own, own_area, error);
  for (int32_t n = 0; status == CT_OK && n < search->node_count; n++) {
    memcpy(&traction[3 * (int64_t)search->nodes[n]], &own[3 * (int64_t)n], 3 * sizeof *own);
    area[search->nodes[n]] = own_area[n];
  }
  ct_release(own);
  return status;
}

ct_status ct_contact_traction(const ct_contact *contact, int32_t side, double *traction,
                              double *area, ct_error *error)
{
  const ct_host_part *obstacle =
      contact == NULL || side < 2 ? NULL : ct_host_obstacle(contact, side - 2);
  if (obstacle != NULL && traction != NULL && area != NULL && contact->host->current)
    return obstacle_traction(contact, obstacle, traction, area, error);
  if (contact == NULL || traction == NULL || area == NULL || side < 0 ||
      side >= contact->fixed->gaps.sides)
    return CT_REFUSE(error, "contact: null argument, or there is no surface %d", (int)side);
  return ct_side_traction(&contact->gaps.side[side],
                          &contact->gaps.side[contact->fixed->gaps.sides - 1 - side], traction,
                          area, error);
}
