/* A rigid obstacle that the points of a surface meet: where it is, and how it moves. */
#include "../constraint/law.h"
#include "../base/amplitude.h"
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/list.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "obstacle.h"

#include <math.h>
#include <string.h>

static void free_obstacle(ct_contact_fixed *fixed)
{
  ct_obstacle *data = (ct_obstacle *)fixed;
  ct_release(data->time);
  ct_release(data->value);
  ct_release(data->springs);
}

/* The law of all points. */
static ct_constraint law_of(const ct_obstacle_def *given)
{
  return (ct_constraint){.enforcement = given->enforcement,
                         .stiffness = given->epsilon,
                         .dissipation = given->dissipation,
                         .restitution = given->restitution,
                         .travel_time = given->travel_time};
}

static double distance(const ct_contact *contact, const double r[3], double n[3])
{
  const ct_obstacle *data = ct_obstacle_of(contact);
  return data->kind->gap(data->given.radius, contact->direction, r, n);
}

/* The obstacle's position at a time. */
static void place_at(const ct_obstacle_def *o, double time, double place[3])
{
  ct_obstacle_motion(o, time, place);
  for (int c = 0; c < 3; c++) place[c] += o->point[c];
}

/* Whether the obstacle is a plane: the direction of all points is its axis. */
static int is_plane(const ct_contact *contact)
{
  return ct_obstacle_of(contact)->given.shape == CT_OBSTACLE_PLANE;
}

static ct_status open_state(ct_contact *contact)
{
  const ct_obstacle_def *o = &ct_obstacle_of(contact)->given;
  memcpy(contact->direction, o->axis, sizeof o->axis);
  if (is_plane(contact)) contact->axis = contact->direction;
  place_at(o, 0.0, contact->place);
  if (contact->fixed->carrier != NULL) {
    contact->carried.weights =
        ct_allocate((size_t)contact->gaps.fixed->point_count, sizeof *contact->carried.weights);
    if (contact->carried.weights == NULL) return CT_ERROR_MEMORY;
  }
  return ct_stations_open(contact);
}

/* Velocity of an obstacle that a body carries near a place: that of its centre, of the closest
 * place of its axis, or of its plane. */
static void velocity_near(const ct_contact *contact, const double x[3], double velocity[3])
{
  const ct_obstacle *data = ct_obstacle_of(contact);
  double r[3], n[3], core[3];
  for (int c = 0; c < 3; c++) r[c] = x[c] - contact->place[c];
  const double depth = distance(contact, r, n) + (data->kind->is_round ? data->given.radius : 0.0);
  for (int c = 0; c < 3; c++) core[c] = x[c] - (depth > 0.0 ? depth * n[c] : 0.0);
  ct_carrier_velocity(&contact->carried, core, velocity);
}

static void find_came(const ct_contact *contact, const double x[3], double came[3])
{
  memcpy(came, contact->came, 3 * sizeof *came);
  if (contact->fixed->carrier == NULL) return;
  velocity_near(contact, x, came);
  for (int c = 0; c < 3; c++) came[c] *= contact->carried.before;
}

/* Largest speed of a node relative to the body that carries the obstacle. */
static double fastest_beside(const ct_contact *contact, const double *velocity)
{
  const ct_search *search = contact->gaps.side[0].search;
  double top = 0.0;
  for (int32_t i = 0; i < search->node_count; i++) {
    const double *v = &velocity[3 * (int64_t)ct_gaps_node(contact->gaps.fixed, 0, i)];
    double u[3];
    velocity_near(contact, &search->x[3 * (int64_t)i], u);
    for (int c = 0; c < 3; c++) u[c] = v[c] - u[c];
    top = ct_larger(ct_vector_dot(u, u), top);
  }
  return sqrt(top);
}

/* Largest distance from which a point may reach the obstacle in a step: the size of a face plus
 * twice the largest motion of a node relative to it. */
static double reach_of(const ct_contact *contact, double motion)
{
  return contact->gaps.side[0].search->size + 2.0 * motion;
}

/* The same of an obstacle that a body carries; all of its motion is that of nodes. */
static void move_carried(ct_contact *contact, const ct_surface_motion *now)
{
  const double *axis = ct_obstacle_of(contact)->given.axis;
  double v[3], turned[3];
  ct_carrier_move(contact->fixed->carrier, now, &contact->carried, contact->place);
  ct_carrier_velocity(&contact->carried, contact->place, v);
  for (int c = 0; c < 3; c++) {
    turned[c] = ct_vector_dot(contact->carried.turn[c], axis);
    contact->came[c] = now->before * v[c];
    contact->coming[c] = now->dt * v[c];
  }
  (void)ct_obstacle_axis(turned, contact->direction);
  ct_contact_direct(contact);
  contact->reach = reach_of(contact, now->dt * fastest_beside(contact, now->velocity));
}

/* Position of the obstacle, its motion in the last step and the next one, and its reach. */
static void move(ct_contact *contact, const ct_surface_motion *now)
{
  const ct_obstacle_def *o = &ct_obstacle_of(contact)->given;
  double last[3];
  if (contact->fixed->carrier != NULL) {
    move_carried(contact, now);
    return;
  }
  place_at(o, now->time, contact->place);
  place_at(o, now->first ? now->time : contact->record.time, last);
  ct_obstacle_motion(o, now->time + now->dt, contact->coming);
  for (int c = 0; c < 3; c++) {
    contact->came[c] = contact->place[c] - last[c];
    contact->coming[c] = (o->point[c] + contact->coming[c]) - contact->place[c];
  }
  const double fastest = ct_farthest(contact->gaps.side[0].search->node_count, now->velocity, NULL,
                                     (double[3]){0.0}),
               moved = sqrt(ct_vector_dot(contact->coming, contact->coming));
  contact->reach = reach_of(contact, now->dt * fastest + moved);
}

/* Whether a small obstacle has passed a point, so that its normal points out of the body. */
static int has_passed(const ct_contact *contact, int64_t i)
{
  double own[3];
  if (!contact->fixed->admits) return 0;
  ct_side_area(&contact->gaps.side[0], i, own);
  return ct_vector_dot(own, contact->gaps.side[0].points[i].outward) > 0.0;
}

/* Gap of one point, and the vector to the obstacle. Returns 0 if there is none. */
static int meet(const ct_contact *contact, int64_t i, int first)
{
  ct_point *point = &contact->gaps.side[0].points[i];
  const int was = point->other >= 0;
  double r[3];
  ct_side_position(&contact->gaps.side[0], i, contact->place, r);
  point->along = NAN;
  point->last_known = point->known;
  point->row.gap = point->known = distance(contact, r, point->outward);
  point->status = point->row.gap < 0.0 ? CT_POINT_INSIDE : CT_POINT_OUTSIDE;
  point->other = 0;
  for (int c = 0; c < 3; c++) {
    point->d[c] = -point->row.gap * point->outward[c];
    point->row.normal[c] = point->outward[c];
  }
  point->jumped = !first && !was && point->row.gap < 0.0 ? CT_POINT_JUMPED : CT_POINT_NO_JUMP;
  point->row.gap = ct_side_gap(&contact->gaps.side[0], point->row.gap);
  if (!has_passed(contact, i)) return !isnan(point->d[0]);
  point->other = -1;
  if (point->row.gap < 0.0) point->status = CT_POINT_BURIED;
  point->row.gap = NAN;
  return 1;
}

/* Gaps of the points of a face over a plane from the heights of its nodes. Inlined with a known
 * `per` and number of points. */
CT_INLINE void meet_face(int per, int points, const ct_side_fixed *side, const int32_t *node,
                         const double *height, double gap[32])
{
  for (int q = 0; q < points; q += 4 / CT_QUAD_PARTS) {
    ct_quad t[8];
    // -- g = Σ_a N_a a · r_a (eq:obstacle-gap)
    for (int a = 0; a < per; a++) t[a] = *(const ct_quad *)&side->across[a][q] * height[node[a]];
    ct_sum_face(per, t, (ct_quad *)&gap[q]);
  }
}

/* Store the gap of a point over a plane, measured and as it counts; unless it is plain, its status,
 * and its vector to the plane if that is wanted. */
CT_INLINE void keep_gap(int plain, double gap, double counted, const double *wanted,
                        ct_point *point)
{
  point->row.gap = counted;
  if (plain) return;
  point->last_known = point->known;
  point->known = gap;
  point->status = gap < 0.0 ? CT_POINT_INSIDE : CT_POINT_OUTSIDE;
  point->other = 0;
  for (int c = 0; wanted != NULL && c < 3; c++) point->d[c] = -gap * wanted[c];
}

/* Gaps of the points of a face, inlined as `meet_face` for plain points and others. */
CT_INLINE void meet_points(int plain, int per, int points, const ct_side *side, const int32_t *node,
                           const double *height, const double *wanted, ct_point *point)
{
  double gap[32], counted[32];
  meet_face(per, points, side->fixed, node, height, gap);
#pragma omp simd
  for (int q = 0; q < points; q++) counted[q] = ct_side_gap(side, gap[q]);
  for (int q = 0; q < points; q++) keep_gap(plain, gap[q], counted[q], wanted, &point[q]);
}

/* Gaps of all points over a plane, inlined for plain points and others. */
CT_INLINE void meet_faces(int plain, const ct_contact *contact, const double *height,
                          const double *wanted)
{
  const ct_side *side = &contact->gaps.side[0];
  const ct_search *search = side->search;
  const int points = side->fixed->rule.count, per = search->per, four = per == 4 && points == 4;
  for (ct_span run = {0}; ct_side_next_faces(side, &run);)
    for (int64_t f = run.first; f < run.end; f++) {
      const int32_t *node = &search->faces[f * per];
      ct_point *point = &side->points[f * points];
      if (four) meet_points(plain, 4, 4, side, node, height, wanted, point);
      else meet_points(plain, per, points, side, node, height, wanted, point);
    }
}

/* The same: they are linear in the positions of the nodes, so none jumps. */
CT_CLONES
static void meet_plane(const ct_contact *contact, const double *height, int first)
{
  // The vectors are for start gaps and the explicit penalty.
  const double *wanted = first || contact->fixed->is.explicit ? contact->axis : NULL;
  if (!first && ct_contact_is_plain(contact)) meet_faces(1, contact, height, NULL);
  else meet_faces(0, contact, height, wanted);
}

/* Heights of all nodes over a plane. */
static void find_heights(const ct_contact *contact, double *height)
{
  const double *x = contact->gaps.side[0].search->x, *axis = contact->axis;
  const int64_t count = contact->gaps.side[0].search->node_count;
  for (int64_t n = 0; n < count; n++) {
    const double *at = &x[3 * n], *o = contact->place,
                 r[3] = {at[0] - o[0], at[1] - o[1], at[2] - o[2]};
    height[n] = ct_vector_dot(r, axis);
  }
}

static ct_status measure(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  const ct_side *surface = &contact->gaps.side[0];
  ct_status status = ct_gaps_place(&contact->gaps, error);
  if (status != CT_OK) return status;
  move(contact, now);
  if (is_plane(contact)) {
    find_heights(contact, contact->terms);
    // The weights of a face's nodes have sizes of at most 3 together.
    contact->all_near =
        4.0 * ct_largest(contact->terms, surface->search->node_count) < contact->reach;
    meet_plane(contact, contact->terms, now->first);
    return CT_OK;
  }
  for (ct_span run = {0}; ct_side_next(surface, &run);)
    for (int64_t i = run.first; i < run.end; i++)
      if (!meet(contact, i, now->first))
        return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE,
                       "obstacle: a point of the surface is at its centre");
  if (contact->gaps.fixed->sides == 1) return CT_OK;
  const double moved = ct_side_motion(surface) + sqrt(ct_vector_dot(contact->came, contact->came));
  ct_stations_meet(contact, 3.0 * moved + CT_CLOSEST_POINT_ERROR * surface->search->size,
                   now->first);
  return CT_OK;
}

/* The largest motion of a node relative to the obstacle since the last step. */
static double relative_motion(const ct_contact *contact, int32_t *node)
{
  const ct_side *surface = &contact->gaps.side[0];
  double top = -1.0;
  for (int32_t i = 0; i < surface->search->node_count; i++) {
    double d[3];
    find_came(contact, &surface->search->x[3 * (int64_t)i], d);
    for (int c = 0; c < 3; c++) d[c] = surface->moved[3 * (int64_t)i + c] - d[c];
    if (!(ct_vector_dot(d, d) > top)) continue;
    top = ct_vector_dot(d, d);
    *node = surface->search->nodes[i];
  }
  return sqrt(top);
}

static ct_status check_step(ct_contact *contact, const ct_surface_motion *now, ct_error *error)
{
  const ct_search *search = contact->gaps.side[0].search;
  const double approach = contact->gaps.fixed->approach;
  int32_t node = 0;
  const double nearer = approach < INFINITY ? relative_motion(contact, &node) : 0.0;
  if (!(nearer > approach)) return CT_OK;
  // -- An obstacle that is farther away cannot have passed through the surface (eq:tunnelling)
  ct_bounds box;
  double middle[3], n[3], half = 0.0;
  ct_tunnelling_box(search, NULL, search->x, &box);
  for (int c = 0; c < 3; c++) {
    middle[c] = 0.5 * (box.low[c] + box.high[c]) - contact->place[c];
    half = hypot(half, 0.5 * (box.high[c] - box.low[c]));
  }
  if (distance(contact, middle, n) - half > nearer + search->size) return CT_OK;
  return ct_fail(error, CT_ERROR_STEP, (ct_place){-1, -1, node},
                 "obstacle: in the step to t = %g a node of its surface has moved by %g relative "
                 "to it, and the two may have passed through each other; not more than %g is safe. "
                 "Take a smaller step",
                 now->time, nearer, approach);
}

/* Add the row sums of the penalty's stiffness of a point to those of the nodes of its face. */
static void add_spring(const ct_obstacle *data, int64_t i, double *rows)
{
  const ct_side_fixed *side = &data->contact.gaps.side[0];
  const ct_search *search = side->search;
  const double *N = side->N[i % side->rule.count];
  const int32_t *node = &search->faces[i / side->rule.count * search->per];
  double sum = 0.0;
  for (int a = 0; a < search->per; a++) sum += fabs(N[a]);
  // -- Row sums ε w J |N_i| Σ |N_j| (eq:obstacle-bound)
  for (int a = 0; a < search->per; a++)
    rows[node[a]] += data->given.epsilon * side->weight[i] * sum * fabs(N[a]);
}

static ct_status find_springs(const ct_contact *contact, ct_masses mass, double *omega2)
{
  const ct_obstacle *data = ct_obstacle_of(contact);
  *omega2 = 0.0;
  for (int32_t n = 0; n < data->contact.is.node_count; n++)
    *omega2 = fmax(*omega2, data->springs[n] / ct_mass_at(mass, n));
  return CT_OK;
}

static const ct_partner_calls OBSTACLE = {.label = "obstacle",
                                          .free = free_obstacle,
                                          .open = open_state,
                                          .measure = measure,
                                          .check = check_step,
                                          .distance = distance,
                                          .find_came = find_came,
                                          .find_springs = find_springs};

static ct_status check(const ct_contact_fixed *fixed, const ct_obstacle_def *o,
                       const ct_surface *surface, ct_error *error)
{
  const ct_obstacle_kind *kind = ct_obstacle_kind_of(o->shape);
  double a[3];
  int per = ct_face_node_count(surface->kind);
  static const char *const NAME[3] = {"point", "velocity", "travel"};
  for (int i = 0; i < 9; i++) {
    const double *vector = i < 3 ? o->point : i < 6 ? o->velocity : o->travel;
    if (!isfinite(vector[i % 3]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "obstacle: %s %c must be finite, not %g",
                     NAME[i / 3], "xyz"[i % 3], vector[i % 3]);
  }
  if (kind == NULL) return CT_REFUSE(error, "obstacle: there is no shape %d", (int)o->shape);
  if (kind->direction != NULL && !ct_obstacle_axis(o->axis, a))
    return CT_REFUSE(error, "obstacle: the %s is zero; it must have a direction", kind->direction);
  if (kind->is_round && (!(o->radius > 0.0) || !isfinite(o->radius)))
    return CT_REFUSE(error, "obstacle: the radius must be positive, not %g", o->radius);
  if (o->amplitude.count == 0 &&
      (o->travel[0] != 0.0 || o->travel[1] != 0.0 || o->travel[2] != 0.0))
    return CT_REFUSE(error, "obstacle: travel needs an amplitude, which says when it is travelled");
  if (per == 0 || surface->face_count < 1 || surface->faces == NULL)
    return CT_REFUSE(error, "obstacle: the surface has no faces");
  for (int64_t i = 0; i < (int64_t)surface->face_count * per; i++)
    if (surface->faces[i] < 0 || surface->faces[i] >= surface->node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, i / per, surface->faces[i]},
                     "obstacle: face %d of the surface names node %d, there are nodes 0 to %d",
                     (int)(i / per), (int)surface->faces[i], (int)surface->node_count - 1);
  return ct_contact_check(fixed, o->epsilon, o->points, error);
}

/* Row sums of the penalty's stiffness with all points inside (eq:obstacle-bound). */
static ct_status sum_springs(ct_obstacle *data, ct_error *error)
{
  const ct_side_fixed *side = &data->contact.gaps.side[0];
  double *rows = data->springs = ct_allocate((size_t)side->search->node_count, sizeof *rows);
  if (rows == NULL) return CT_NO_MEMORY(error, "an obstacle");
  for (int64_t i = 0; i < side->point_count; i++) add_spring(data, i, rows);
  for (int32_t n = 0; n < side->search->node_count; n++) rows[n] += ct_stations_springs(data);
  return CT_OK;
}

/* Copy the caller's definition, and compute the constant data. */
static ct_status fill(ct_obstacle *data, const ct_obstacle_def *o, const ct_surface *surface,
                      ct_error *error)
{
  ct_contact_fixed *contact = &data->contact;
  size_t points = (size_t)o->amplitude.count;
  contact->threads = 1;
  contact->gaps.depth = HUGE_VAL;
  contact->gaps.sides = 1;
  data->given = *o;
  data->kind = ct_obstacle_kind_of(o->shape);
  if (data->kind->direction != NULL) (void)ct_obstacle_axis(o->axis, data->given.axis);
  data->given.faces = data->given.carrier = NULL; // the caller's
  data->given.amplitude.time = data->time =
      ct_duplicate(o->amplitude.time, points * sizeof(double));
  data->given.amplitude.value = data->value =
      ct_duplicate(o->amplitude.value, points * sizeof(double));
  if (!data->time || !data->value) return CT_NO_MEMORY(error, "an obstacle");
  ct_status status =
      ct_side_fixed_init(&contact->gaps.side[0], surface, 0, o->points == CT_POINTS_LOBATTO, error);
  if (status != CT_OK) return status;
  contact->gaps.point_count = contact->gaps.side[0].point_count;
  status = ct_stations_init(data, error);
  // Where gaps are linear in the motion, or change slowly, no point jumps.
  contact->admits = contact->gaps.sides == 2;
  contact->moves =
      points > 0 || o->velocity[0] != 0.0 || o->velocity[1] != 0.0 || o->velocity[2] != 0.0;
  return status == CT_OK ? sum_springs(data, error) : status;
}

ct_obstacle_def ct_obstacle_def_default(void)
{
  return (ct_obstacle_def){.cookie = CT_DEF_COOKIE,
                           .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                           .dissipation = 0.15,
                           .restitution = 1.0,
                           .initial_penetration = CT_INITIAL_KEEP};
}

static ct_obstacle_def shaped(ct_obstacle_shape shape, const double point[3], const double *axis,
                              double radius)
{
  ct_obstacle_def def = ct_obstacle_def_default();
  def.shape = shape, def.radius = radius;
  memcpy(def.point, point, sizeof def.point);
  if (axis != NULL) memcpy(def.axis, axis, sizeof def.axis);
  return def;
}

ct_obstacle_def ct_obstacle_def_plane(const double point[3], const double normal[3])
{
  return shaped(CT_OBSTACLE_PLANE, point, normal, 0.0);
}

ct_obstacle_def ct_obstacle_def_sphere(const double centre[3], double radius)
{
  return shaped(CT_OBSTACLE_SPHERE, centre, NULL, radius);
}

ct_obstacle_def ct_obstacle_def_cylinder(const double centre[3], const double axis[3],
                                         double radius)
{
  return shaped(CT_OBSTACLE_CYLINDER, centre, axis, radius);
}

/* Let nodes of a rigid body carry the obstacle: they follow in the list of the surface's nodes. */
static ct_status carry(ct_obstacle *data, const ct_surface *surface, const int32_t *nodes,
                       ct_error *error)
{
  ct_carrier *carrier = &data->carrier;
  ct_contact_fixed *contact = &data->contact;
  ct_side_fixed *side = &contact->gaps.side[0];
  const ct_search *search = side->search;
  const int32_t own = search->node_count;
  const size_t entries = (size_t)search->face_count * (size_t)search->per;
  if (contact->moves)
    return CT_REFUSE(error, "obstacle: with a carrier it moves by its forces; leave velocity and "
                            "travel out, and give the velocity to the body");
  if (!ct_law_has_rows(contact->law.enforcement))
    return CT_REFUSE(error,
                     "obstacle: with a carrier it can't be enforced by the explicit penalty");
  contact->nodes = ct_allocate((size_t)own + CT_CARRIER_NODES, sizeof *contact->nodes);
  contact->gaps.place[0] = ct_allocate((size_t)own, sizeof *contact->gaps.place[0]);
  side->row_faces = ct_allocate(entries, sizeof *side->row_faces);
  if (!contact->nodes || !contact->gaps.place[0] || !side->row_faces)
    return CT_NO_MEMORY(error, "an obstacle");
  int32_t count = own;
  memcpy(contact->nodes, search->nodes, (size_t)own * sizeof *search->nodes);
  for (int k = 0; k < CT_CARRIER_NODES; k++) {
    const int32_t at = ct_lower_bound(contact->nodes, count, nodes[k]);
    memcpy(carrier->reference[k], &surface->reference[3 * (int64_t)nodes[k]],
           sizeof carrier->reference[k]);
    if (at < count && contact->nodes[at] == nodes[k]) continue; // the farthest one in two octants
    memmove(&contact->nodes[at + 1], &contact->nodes[at], (size_t)(count++ - at) * sizeof(int32_t));
    contact->nodes[at] = nodes[k];
  }
  contact->is.node_count = count;
  for (int k = 0; k < CT_CARRIER_NODES; k++)
    carrier->place[k] = ct_lower_bound(contact->nodes, count, nodes[k]);
  for (int32_t n = 0; n < own; n++)
    contact->gaps.place[0][n] = ct_lower_bound(contact->nodes, count, search->nodes[n]);
  for (size_t i = 0; i < entries; i++)
    side->row_faces[i] = contact->gaps.place[0][search->faces[i]];
  if (!ct_carrier_init(carrier, data->given.point))
    return CT_REFUSE(error, "obstacle: the body that carries it is flat");
  contact->carrier = carrier;
  return CT_OK;
}

ct_status ct_obstacle_create(const ct_obstacle_def *def, const ct_surface *surface,
                             const int32_t *carrier, ct_interaction **out, ct_error *error)
{
  ct_status status = ct_check_options(def->cookie, "ct_obstacle_def_default", error);
  if (status == CT_OK && carrier == NULL && def->carrier != NULL)
    return CT_REFUSE(error,
                     "obstacle: body %d can't carry it, because a host's contact knows no "
                     "rigid bodies",
                     (int)*def->carrier);
  if (status == CT_OK) status = ct_amplitude_check(&def->amplitude, error);
  if (status != CT_OK) return status;
  ct_obstacle *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return CT_NO_MEMORY(error, "an obstacle");
  data->contact.partner = &OBSTACLE;
  data->contact.law = law_of(def);
  data->contact.start_rule =
      (ct_start_rule){def->initial_penetration, def->removal_time, def->adjust};
  status = check(&data->contact, def, surface, error);
  if (status == CT_OK) status = fill(data, def, surface, error);
  if (status == CT_OK && carrier != NULL) status = carry(data, surface, carrier, error);
  if (status != CT_OK) {
    ct_contact_fixed_free(&data->contact);
    return status;
  }
  // -- Counted at a plane (eq:round-flops)
  const int penalty = !ct_law_has_rows(def->enforcement);
  ct_contact_describe(&data->contact, penalty ? 164.0 : 414.0, penalty ? 6.0 : 26.0);
  *out = &data->contact.is;
  return CT_OK;
}
