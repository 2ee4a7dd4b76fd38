/* The obstacles and the friction of a host's contact, and the forces of all. */
#include "host.h"

#include "../base/error.h"

#include <libcontact/base.h>

#include <string.h>

ct_host *ct_host_of(ct_contact *contact)
{
  if (contact->host != NULL) return contact->host;
  ct_host *h = contact->host = ct_allocate(1, sizeof *h);
  if (h != NULL) h->contact = (ct_host_part){.is = &contact->own->is, .state = contact};
  return h;
}

ct_status ct_host_check_current(const ct_contact *contact, ct_error *error)
{
  if (contact->host != NULL && contact->host->current) return CT_OK;
  return CT_REFUSE(error, "contact: the last call was not a successful ct_contact_step");
}

static int is_obstacle(const ct_host_part *part) { return part->is->on == NULL; }

/* Obstacle `number`; null: there is none. */
static const ct_host_part *find_obstacle(const ct_contact *contact, int32_t number)
{
  const ct_host_part *part = contact->host == NULL ? NULL : contact->host->contact.next;
  for (; part != NULL; part = part->next)
    if (is_obstacle(part) && number-- == 0) break;
  return part;
}

ct_status ct_host_check_new(const ct_contact *contact, ct_error *error)
{
  if (contact->host != NULL && contact->host->open)
    return CT_REFUSE(error,
                     "contact: obstacles, friction and pieces must be given before the first step");
  return CT_OK;
}

/* Append a copy of a part, and take ownership of its interaction; out of memory, that is freed. */
static ct_status append(ct_contact *contact, ct_host_part made, ct_error *error)
{
  ct_host *h = ct_host_of(contact);
  ct_host_part *part = h == NULL ? NULL : ct_allocate(1, sizeof *part), *last;
  if (part == NULL || made.is->calls->open(made.is, &made.state, error) != CT_OK) {
    ct_release(part);
    made.is->calls->free(made.is);
    return CT_NO_MEMORY(error, "the steps of a contact");
  }
  *part = made;
  for (last = &h->contact; last->next != NULL; last = last->next) continue;
  last->next = part;
  return CT_OK;
}

/* An obstacle at a surface in the numbering of the contact. */
static ct_status create_obstacle(const ct_contact_fixed *fixed, int32_t side,
                                 const ct_obstacle_def *obstacle, ct_interaction **is,
                                 ct_error *error)
{
  const ct_search *search = fixed->gaps.side[side].search;
  double *x = ct_allocate((size_t)fixed->is.node_count, 3 * sizeof *x);
  if (x == NULL) return CT_NO_MEMORY(error, "an obstacle");
  for (int32_t n = 0; n < search->node_count; n++)
    memcpy(&x[3 * (int64_t)fixed->gaps.place[side][n]], &search->x[3 * (int64_t)n], 3 * sizeof *x);
  const ct_surface surface = {search->kind, fixed->is.node_count, search->face_count,
                              fixed->gaps.side[side].row_faces, x};
  ct_status status = ct_obstacle_create(obstacle, &surface, NULL, is, error);
  ct_release(x);
  return status;
}

ct_status ct_contact_add_obstacle(ct_contact *contact, int32_t side,
                                  const ct_obstacle_def *obstacle, ct_error *error)
{
  ct_interaction *is = NULL;
  if (contact == NULL || obstacle == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_host_check_new(contact, error);
  if (status != CT_OK) return status;
  if (side < 0 || side >= contact->fixed->gaps.sides)
    return CT_REFUSE(error, "contact: there is no surface %d", (int)side);
  status = create_obstacle(contact->fixed, side, obstacle, &is, error);
  if (status != CT_OK) return status;
  return append(contact, (ct_host_part){.is = is, .nodes = is->nodes, .surface = side}, error);
}

ct_status ct_contact_add_friction(ct_contact *contact, int32_t on, double coefficient,
                                  double tangent, ct_error *error)
{
  ct_interaction *is = NULL;
  if (contact == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_host_check_new(contact, error);
  if (status != CT_OK) return status;
  const ct_host *h = ct_host_of(contact);
  if (h == NULL) return CT_NO_MEMORY(error, "the steps of a contact");
  const ct_host_part *what = on < 0 ? &h->contact : find_obstacle(contact, on);
  if (on < -1 || what == NULL || (on == -1 && contact->fixed->gaps.alone))
    return CT_REFUSE(error,
                     "friction: there is nothing to slide on at %d; give the number of an "
                     "obstacle, or -1 for the other surface",
                     (int)on);
  for (const ct_host_part *part = h->contact.next; part != NULL; part = part->next)
    if (part->on == what)
      return CT_REFUSE(error, "friction: it acts on obstacle %d already (-1: the other surface)",
                       (int)on);
  status = ct_friction_create(coefficient, tangent, what->is, &is, error);
  if (status != CT_OK) return status;
  return append(contact, (ct_host_part){.is = is, .nodes = what->nodes, .on = what}, error);
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

void ct_host_find_energy(ct_host *h)
{
  h->energy = (ct_interaction_energy){.stored = 0.0};
  h->contact.is->calls->find_energy(h->contact.state, &h->contact.energy);
  for (ct_host_part *part = h->contact.next; part != NULL; part = part->next) {
    part->is->calls->find_energy(part->state, &part->energy);
    h->energy.stored += part->energy.stored;
    h->energy.dissipated += part->energy.dissipated;
    h->energy.motion += part->energy.motion;
    h->energy.removal += part->energy.removal;
  }
}

/* Add the forces of obstacles and friction. */
static void add_parts(const ct_contact *contact, double *const f[2])
{
  for (const ct_host_part *part = contact->host->contact.next; part != NULL; part = part->next)
    for (int32_t n = 0; n < part->is->node_count; n++) {
      int side;
      const int64_t dof = 3 * (int64_t)ct_host_node(contact, ct_host_place(part, n), &side);
      for (int c = 0; c < 3; c++) f[side][dof + c] += part->force[3 * (int64_t)n + c];
    }
}

ct_status ct_contact_add_force(const ct_contact *contact, double *fa, double *fb, ct_error *error)
{
  if (contact == NULL || fa == NULL || (fb == NULL && contact->fixed->gaps.sides == 2))
    return CT_REFUSE_NULL(error);
  const int more = contact->host != NULL && contact->host->current;
  double *const f[2] = {fa, fb};
  if (more && contact->host->contact.next != NULL && contact->fixed->gaps.sides == 2 &&
      contact->fixed->one_array && fa != fb)
    return CT_REFUSE(error, "contact: two surfaces on one array of nodes need one array of forces");
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (int64_t n = 0; n < side->search->node_count; n++)
      for (int c = 0; c < 3; c++)
        f[s][3 * (int64_t)side->search->nodes[n] + c] += ct_side_force(side, n, c);
  }
  if (more) add_parts(contact, f);
  return CT_OK;
}

/* An obstacle with the forces of a step; null if there is none. */
static const ct_host_part *stepped(const ct_contact *contact, int32_t obstacle, const void *out,
                                   ct_status *status, ct_error *error)
{
  const ct_host_part *part = contact == NULL ? NULL : find_obstacle(contact, obstacle);
  if (contact == NULL || out == NULL)
    *status = CT_REFUSE(error, "contact: a required argument is null");
  else if (part == NULL)
    *status = CT_REFUSE(error, "contact: there is no obstacle %d", (int)obstacle);
  else *status = ct_host_check_current(contact, error);
  return *status == CT_OK ? part : NULL;
}

ct_status ct_contact_reaction(const ct_contact *contact, int32_t obstacle, double force[3],
                              double *work, ct_error *error)
{
  ct_status status;
  const ct_host_part *part =
      stepped(contact, obstacle, force == NULL ? NULL : work, &status, error);
  if (part == NULL) return status;
  memcpy(force, part->energy.reaction, sizeof part->energy.reaction);
  *work = part->energy.motion;
  for (const ct_host_part *rub = part->next; rub != NULL; rub = rub->next) {
    if (rub->on != part) continue;
    for (int c = 0; c < 3; c++) force[c] += rub->energy.reaction[c];
    *work += rub->energy.motion;
  }
  return CT_OK;
}

ct_status ct_contact_obstacle_penetration(const ct_contact *contact, int32_t obstacle,
                                          ct_penetration_at at, ct_penetration *out,
                                          ct_error *error)
{
  ct_status status;
  const ct_host_part *part = stepped(contact, obstacle, out, &status, error);
  return part == NULL ? status : ct_contact_penetration(part->state, at, out, error);
}

/* Tractions at an obstacle, which has the numbering of the contact. */
static ct_status obstacle_traction(const ct_contact *contact, const ct_host_part *part,
                                   double *traction, double *area, ct_error *error)
{
  const int32_t count = contact->fixed->is.node_count;
  const ct_contact *obstacle = part->state;
  double *own = ct_allocate((size_t)count, 4 * sizeof *own);
  if (own == NULL) return CT_NO_MEMORY(error, "tractions");
  double *own_area = own + 3 * (int64_t)count;
  ct_status status =
      ct_side_traction(obstacle->gaps.side, ct_contact_acting(obstacle, 0), own, own_area, error);
  for (int32_t n = 0; status == CT_OK && n < part->is->node_count; n++) {
    int side;
    const int64_t from = part->nodes[n], to = ct_host_node(contact, part->nodes[n], &side);
    memcpy(&traction[3 * to], &own[3 * from], 3 * sizeof *own);
    area[to] = own_area[from];
  }
  ct_release(own);
  return status;
}

ct_status ct_contact_traction(const ct_contact *contact, int32_t side, double *traction,
                              double *area, ct_error *error)
{
  const ct_host_part *obstacle =
      contact == NULL || side < 2 ? NULL : find_obstacle(contact, side - 2);
  if (obstacle != NULL && traction != NULL && area != NULL && contact->host->current)
    return obstacle_traction(contact, obstacle, traction, area, error);
  if (contact == NULL || traction == NULL || area == NULL) return CT_REFUSE_NULL(error);
  if (side < 0 || side >= contact->fixed->gaps.sides)
    return CT_REFUSE(error, "contact: there is no surface %d", (int)side);
  return ct_side_traction(&contact->gaps.side[side], ct_contact_acting(contact, side), traction,
                          area, error);
}
