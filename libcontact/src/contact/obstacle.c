/* Rigid planes, spheres and cylinders in contact with the surface of a body. */
#include <libcontact/contact.h>

#include "../constraint/law.h"
#include "../base/amplitude.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

/* Data shared by all states: the obstacle with its own arrays and an axis of length 1, and the
 * surface, whose nodes are those of the interaction. */
typedef struct ct_obstacle {
  ct_interaction is;
  ct_obstacle_def given;
  double *time, *value; /* of the amplitude */
  ct_side_fixed side;
  ct_stations stations;
  double *springs; /* row sums of the stiffness with all points inside */
} ct_obstacle;

/* Memory, before the records of the points. */
typedef struct obstacle_record {
  double begun;    /* whether there was an earlier step */
  double place[3]; /* of the obstacle */
  double reaction[3];
  double work;
  double stored;  /* energy that all rows stored at the middle of the last step */
  double time;    /* of that step */
  double removal; /* work of fading start gaps */
  ct_account account;
  double late, late_depth; /* stations that were found inside after the start */
} obstacle_record;
enum { RECORD = sizeof(obstacle_record) / sizeof(double) };

static obstacle_record load(const double *memory)
{
  obstacle_record record;
  memcpy(&record, memory, sizeof record);
  return record;
}

static void free_obstacle(ct_interaction *interaction)
{
  ct_obstacle *d = (ct_obstacle *)interaction;
  ct_side_fixed_clear(&d->side);
  ct_stations_clear(&d->stations);
  ct_release(d->time);
  ct_release(d->value);
  ct_release(d->springs);
  ct_release(d);
}

static void close_state(void *state)
{
  ct_obstacle_state *s = state;
  if (s == NULL) return;
  ct_side_clear(&s->side[0]);
  ct_release(s->side[1].points);
  ct_release(s->terms);
  ct_release(s);
}

static ct_start_rule start_rule_of(const ct_obstacle_def *given)
{
  return (ct_start_rule){given->initial_penetration, given->removal_time, given->adjust};
}

/* The law of all points. */
static ct_constraint law_of(const ct_obstacle_def *given)
{
  return (ct_constraint){.enforcement = given->enforcement,
                         .stiffness = given->epsilon,
                         .dissipation = given->dissipation};
}

/* Number of points and stations. */
static int64_t points_of(const ct_obstacle *data)
{
  return data->side.point_count + data->stations.fixed.point_count;
}

/* The obstacle's position at a time. */
static void move_to(ct_obstacle_state *s, double time)
{
  ct_obstacle_motion(s->given, time, s->place);
  for (int c = 0; c < 3; c++) s->place[c] += s->given->point[c];
}

static ct_status open_state(const ct_interaction *interaction, void **state, ct_error *error)
{
  const ct_obstacle *data = (const ct_obstacle *)interaction;
  const ct_constraint law = law_of(&data->given);
  ct_obstacle_state *s = ct_allocate(1, sizeof *s);
  if (s != NULL) s->data = data, s->given = &data->given;
  if (s == NULL ||
      (s->terms = ct_allocate((size_t)(points_of(data) + data->side.search->node_count),
                              sizeof *s->terms)) == NULL ||
      ct_side_init(&s->side[0], &data->side, &law) != CT_OK ||
      ct_stations_open(s, &data->stations, &law) != CT_OK) {
    close_state(s);
    return CT_NO_MEMORY(error, "an obstacle");
  }
  move_to(s, 0.0);
  *state = s;
  return CT_OK;
}

/* Whether a small obstacle has passed a point, so that its normal points out of the body. */
static int has_passed(const ct_obstacle_state *s, int64_t i)
{
  double own[3];
  if (s->sides == 1) return 0;
  ct_side_area(&s->side[0], i, own);
  return ct_vector_dot(own, s->side[0].points[i].outward) > 0.0;
}

/* Gap of one point, and the vector to the obstacle. Returns 0 if there is none. */
static int meet(const ct_obstacle_state *s, int64_t i, int first)
{
  const ct_obstacle_def *o = s->given;
  ct_point *point = &s->side[0].points[i];
  const int was = point->other >= 0;
  double r[3];
  ct_side_position(&s->side[0], i, s->place, r);
  point->row.gap = point->known = ct_obstacle_gap_of(o, o->axis, r, point->outward);
  point->status = point->row.gap < 0.0 ? CT_POINT_INSIDE : CT_POINT_OUTSIDE;
  point->other = 0;
  for (int c = 0; c < 3; c++) point->d[c] = -point->row.gap * point->outward[c];
  point->jumped = !first && !was && point->row.gap < 0.0;
  if (!has_passed(s, i)) return !isnan(point->d[0]);
  point->other = -1;
  if (point->row.gap < 0.0) point->status = CT_POINT_BURIED;
  point->row.gap = NAN;
  return 1;
}

/* Gaps of all points, with the nodes at their places and the obstacle where it is at a time. */
static ct_status meet_all(ct_obstacle_state *s, double time, int first, ct_error *error)
{
  move_to(s, time);
  for (int64_t i = 0; i < s->side[0].fixed->point_count; i++)
    if (!meet(s, i, first))
      return ct_fail(error, CT_ERROR_GEOMETRY, CT_NOWHERE,
                     "obstacle: a point of the surface is at its centre");
  return CT_OK;
}

/* The points begin with the start gaps of the reference shape (eq:initial-adjust). */
static ct_status begin(ct_obstacle_state *s, double time, ct_error *error)
{
  const ct_start_rule rule = start_rule_of(s->given);
  const ct_search *search = s->data->side.search;
  memcpy(s->side[0].search->x, search->x, 3 * (size_t)search->node_count * sizeof *search->x);
  ct_stations_forget(s);
  ct_status status = meet_all(s, time, 1, error);
  if (status == CT_OK) ct_stations_meet(s, search->size, 0.0, 1);
  for (int k = 0; k < s->sides; k++)
    for (ct_point *p = s->side[k].points; p < s->side[k].points + s->side[k].fixed->point_count;
         p++)
      p->start = p->row.force = p->force_size = p->admitted = p->stored = 0.0;
  s->admission = (ct_admission){.late = 0};
  if (status == CT_OK && ct_start_gap_counts(&rule)) ct_start_gap_begin(&rule, s->side, s->sides);
  ct_stations_forget(s);
  return status;
}

/* Current coordinates of the surface's nodes, and their motion since the last call. */
static ct_status place_nodes(const ct_surface_motion *now, ct_side *side, ct_error *error)
{
  for (int64_t i = 0; i < side->search->node_count; i++)
    for (int64_t c = 0; c < 3; c++) {
      const double last = side->search->x[3 * i + c];
      side->search->x[3 * i + c] = now->x[3 * i + c];
      if (side->moved != NULL) side->moved[3 * i + c] = side->search->x[3 * i + c] - last;
      if (!isfinite(side->search->x[3 * i + c]))
        return ct_fail(error, CT_INVALID, (ct_place){-1, -1, side->search->nodes[i]},
                       "obstacle: node %d is not at a finite place", (int)side->search->nodes[i]);
    }
  return CT_OK;
}

/* Force on the obstacle, and the work of its motion since the last step (eq:obstacle-work). */
static void count_motion(ct_obstacle_state *s, const obstacle_record *last)
{
  s->work = last->work;
  for (int c = 0; c < 3; c++) {
    int64_t count = 0;
    for (const ct_side *side = s->side; side < s->side + s->sides; side++)
      for (int64_t i = 0; i < side->fixed->point_count; i++)
        s->terms[count++] = -side->points[i].force[c];
    s->reaction[c] = ct_sum(s->terms, count);
    // -- Minus the mean force on the obstacle times its motion (eq:obstacle-work)
    if (last->begun != 0.0)
      s->work -= 0.5 * (s->reaction[c] + last->reaction[c]) * (s->place[c] - last->place[c]);
  }
}

/* Refuse an overlap at the start if that is asked for. */
static ct_status refuse(const ct_obstacle_state *s, const ct_start_rule *rule, ct_error *error)
{
  ct_penetration found;
  if (rule->initial_penetration != CT_INITIAL_REFUSE) return CT_OK;
  (void)ct_obstacle_depth(s, CT_AT_POINTS, &found, error);
  return ct_start_gap_refuse(rule, &found, "obstacle", 1, error);
}

/* Motion of the obstacle in the next step. */
static void next_motion(const ct_obstacle_state *s, const ct_surface_motion *now, double moved[3])
{
  ct_obstacle_motion(s->given, now->time + now->dt, moved);
  for (int c = 0; c < 3; c++) moved[c] = (s->given->point[c] + moved[c]) - s->place[c];
}

/* Largest distance from which a point may reach the obstacle in this step: the size of a face plus
 * twice the displacement of the fastest node. */
static double reach_of(const ct_obstacle_state *s, const ct_surface_motion *now,
                       const double moved[3])
{
  const ct_search *search = s->side[0].search;
  double top = 0.0;
  for (int64_t i = 0; i < search->node_count; i++)
    top = fmax(top, ct_vector_dot(&now->velocity[3 * i], &now->velocity[3 * i]));
  return search->size + 2.0 * (now->dt * sqrt(top) + sqrt(ct_vector_dot(moved, moved)));
}

/* Memory of the nodes' coordinates, behind the records; null for planes, which need none. */
static double *coordinates(const ct_obstacle *data, double *memory)
{
  return data->given.shape == CT_OBSTACLE_PLANE ? NULL
                                                : &memory[RECORD + CT_RECORD * points_of(data)];
}

/* The state after the last step. */
static void load_state(ct_obstacle_state *s, const double *memory)
{
  const obstacle_record last = load(memory);
  const ct_search *search = s->side[0].search;
  const double *next = ct_points_load(&s->side[0], 1, &memory[RECORD]);
  if (s->sides == 2) next = ct_points_load(&s->side[1], search->face_count, next);
  if (s->side[0].moved != NULL)
    memcpy(search->x, next, 3 * (size_t)search->node_count * sizeof *next);
  s->admission = (ct_admission){last.account, (int64_t)last.late, last.late_depth};
}

/* Gap of a point in the last step at its present place, as the solver computes it. */
static int find_before(const void *user, int k, int64_t i)
{
  const ct_obstacle_state *s = user;
  const ct_side *surface = &s->side[0];
  ct_point *p = &s->side[k].points[i];
  const int32_t face = k == 1 ? p->other : (int32_t)(i / surface->fixed->rule.count);
  double own[3];
  if (!ct_side_direction(&s->side[k], p, p->row.normal)) return 0;
  ct_side_interpolate(surface->search, surface->moved, face, p->row.own_shape, NULL, own);
  p->row.before = p->row.gap + p->closed -
                  (ct_vector_dot(p->row.normal, own) - ct_vector_dot(p->row.normal, s->came));
  return 1;
}

/* Measure the gaps from their start gaps. Points of a small obstacle, whose gaps are not linear in
 * the motion, store no more than the bodies have given. */
static void shift(ct_obstacle_state *s, const ct_start_rule *rule, const ct_surface_motion *now,
                  double last, double motion)
{
  const int counted = ct_start_gap_counts(rule);
  if (counted) ct_start_gap_shift(rule, s->side, s->sides, now, last);
  if (s->sides == 1) return;
  ct_admission_shift(s->side, s->sides, counted);
  if (!now->first && now->before > 0.0)
    ct_admission_bound(s->side, s->sides, &s->admission, 4.0 * motion, find_before, s, s->terms);
}

/* Gaps of the points at a time, measured from their start gaps. */
static ct_status place(void *state, const ct_surface_motion *motion, ct_error *error)
{
  ct_obstacle_state *s = state;
  const ct_start_rule rule = start_rule_of(s->given);
  const obstacle_record last = load(motion->memory);
  ct_surface_motion now = *motion;
  now.first = last.begun == 0.0;
  ct_status status = CT_OK;
  if (now.first) status = begin(s, now.time, error);
  else load_state(s, now.memory);
  for (int k = 0; k < s->sides; k++)
    for (int64_t i = 0; i < s->side[k].fixed->point_count; i++)
      s->side[k].points[i].last_known = s->side[k].points[i].known;
  if (status == CT_OK) status = place_nodes(&now, &s->side[0], error);
  if (status == CT_OK) status = meet_all(s, now.time, now.first, error);
  if (status != CT_OK) return status;
  double moved[3], nearer = 0.0;
  next_motion(s, &now, moved);
  for (int c = 0; c < 3; c++) s->came[c] = now.first ? 0.0 : s->place[c] - last.place[c];
  if (s->side[0].moved != NULL)
    nearer = ct_side_motion(&s->side[0]) + sqrt(ct_vector_dot(s->came, s->came));
  ct_stations_meet(s, reach_of(s, &now, moved),
                   3.0 * nearer + CT_CLOSEST_POINT_ERROR * s->side[0].search->size, now.first);
  if (now.before > 0.0 && !now.first) status = ct_stations_check(s, now.time, error);
  shift(s, &rule, &now, last.time, nearer);
  return status == CT_OK && now.first ? refuse(s, &rule, error) : status;
}

static int64_t list_rows(void *state, const ct_surface_motion *now, ct_constraint **rows)
{
  ct_obstacle_state *s = state;
  double moved[3];
  int64_t count = 0;
  next_motion(s, now, moved);
  const double reach = reach_of(s, now, moved);
  for (int k = 0; k < s->sides; k++)
    count += ct_side_list_rows(&s->side[k], NULL, reach, s->came, moved, &rows[count]);
  return count;
}

/* The memory for the next step. */
static void store_state(const ct_obstacle_state *s, double stored, double time, double *memory)
{
  obstacle_record next = {.begun = 1.0,
                          .work = s->work,
                          .stored = stored,
                          .time = time,
                          .removal = s->removal,
                          .account = s->admission.account,
                          .late = (double)s->admission.late,
                          .late_depth = s->admission.late_depth};
  memcpy(next.place, s->place, sizeof next.place);
  memcpy(next.reaction, s->reaction, sizeof next.reaction);
  memcpy(memory, &next, sizeof next);
  double *end = &memory[RECORD], *x = coordinates(s->data, memory);
  for (int k = 0; k < s->sides; k++) end = ct_points_store(&s->side[k], end);
  if (x != NULL)
    memcpy(x, s->side[0].search->x, 3 * (size_t)s->side[0].search->node_count * sizeof *x);
}

static ct_status find_forces(void *state, const ct_surface_motion *now, double *force,
                             ct_error *error)
{
  ct_obstacle_state *s = state;
  const int penalty = s->data->is.explicit;
  const ct_start_rule rule = start_rule_of(s->given);
  const obstacle_record last = load(now->memory);
  const int starting = last.begun == 0.0 || !(now->time > 0.0);
  double stored = 0.0;
  for (int k = 0; k < s->sides; k++)
    if (penalty) ct_side_apply_penalty(&s->side[k]);
    else ct_side_take_rows(&s->side[k]);
  if (!penalty)
    s->held = ct_side_rows_energy(s->side, s->sides, now->time, last.stored, &stored, s->terms);
  if (s->sides == 2)
    ct_admission_count(s->side, s->sides, &s->admission, !penalty, starting, s->terms);
  ct_status status = ct_side_collect(s->side, s->sides, 1, error);
  if (status != CT_OK) return status;
  for (int64_t d = 0; d < 3 * (int64_t)s->data->is.node_count; d++)
    force[d] = s->side[0].force[d] + s->side[0].force_fine[d];
  count_motion(s, &last);
  s->removal = last.removal;
  if (ct_start_gap_fades(&rule))
    s->removal += ct_start_gap_work(&rule, s->side, s->sides, now->time,
                                    last.begun != 0.0 ? last.time : now->time, s->terms);
  store_state(s, stored, now->time, now->next_memory);
  return CT_OK;
}

static void find_energy(const void *state, ct_interaction_energy *energy)
{
  const ct_obstacle_state *s = state;
  *energy = (ct_interaction_energy){
      .stored = s->data->is.explicit ? ct_side_potential(s->side, s->sides) : s->held,
      .motion = s->work,
      .removal = s->removal};
}

/* Add the row sums of the penalty's stiffness of a point to those of the nodes of its face. */
static void add_spring(const ct_obstacle *data, int64_t i, double *rows)
{
  const ct_side_fixed *side = &data->side;
  const ct_search *search = side->search;
  const double *N = side->N[i % side->rule.count];
  const int32_t *node = &search->faces[i / side->rule.count * search->per];
  double sum = 0.0;
  for (int a = 0; a < search->per; a++) sum += fabs(N[a]);
  // -- Row sums ε w J |N_i| Σ |N_j| (eq:obstacle-bound)
  for (int a = 0; a < search->per; a++)
    rows[node[a]] += data->given.epsilon * side->weight[i] * sum * fabs(N[a]);
}

/* Whether a point is inside, or its face faces the obstacle. */
static int is_facing(const ct_obstacle_state *s, int64_t i)
{
  double own[3], r[3], n[3];
  ct_side_area(&s->side[0], i, own);
  ct_side_position(&s->side[0], i, s->place, r);
  return ct_obstacle_gap_of(s->given, s->given->axis, r, n) < 0.0 || ct_friction_facing(own, n);
}

static double largest_omega2(const ct_obstacle *data, const double *rows, ct_masses mass)
{
  double omega2 = 0.0;
  for (int32_t n = 0; n < data->is.node_count; n++)
    omega2 = fmax(omega2, rows[n] / ct_mass_at(mass, n));
  return omega2;
}

/* Stations have no friction. If no point faces the obstacle, all points count. */
static ct_status find_springs(const void *state, int facing, ct_masses mass, double *omega2)
{
  const ct_obstacle_state *s = state;
  const ct_obstacle *data = s->data;
  int found = 0;
  *omega2 = largest_omega2(data, data->springs, mass);
  if (!facing) return CT_OK;
  double *rows = ct_allocate((size_t)data->is.node_count, sizeof *rows);
  if (rows == NULL) return CT_ERROR_MEMORY;
  for (int64_t i = 0; i < data->side.point_count; i++)
    if (is_facing(s, i)) found = 1, add_spring(data, i, rows);
  if (found) *omega2 = largest_omega2(data, rows, mass);
  ct_release(rows);
  return CT_OK;
}

static const ct_interaction_calls CALLS = {.free = free_obstacle,
                                           .open = open_state,
                                           .close = close_state,
                                           .place = place,
                                           .list_rows = list_rows,
                                           .find_forces = find_forces,
                                           .find_energy = find_energy,
                                           .find_springs = find_springs};

static ct_status check(const ct_obstacle_def *o, const ct_surface *surface, ct_error *error)
{
  double a[3];
  int per = ct_face_node_count(surface->kind), finite = 1;
  for (int c = 0; c < 3; c++)
    finite = finite && isfinite(o->point[c]) && isfinite(o->velocity[c]) && isfinite(o->travel[c]);
  if (!finite)
    return ct_fail(error, CT_INVALID, CT_NOWHERE,
                   "obstacle: its point, velocity or travel is not finite");
  if ((int)o->shape < CT_OBSTACLE_PLANE || (int)o->shape > CT_OBSTACLE_CYLINDER)
    return CT_REFUSE(error, "obstacle: there is no shape %d", (int)o->shape);
  if (!(o->epsilon > 0.0) || !isfinite(o->epsilon))
    return CT_REFUSE(error, "obstacle: the penalty must be positive, not %g", o->epsilon);
  const ct_constraint law = law_of(o);
  const ct_start_rule rule = start_rule_of(o);
  ct_status status = ct_law_check(&law, "obstacle", error);
  if (status == CT_OK) status = ct_start_gap_check(&rule, "obstacle", error);
  if (status != CT_OK) return status;
  if (o->shape != CT_OBSTACLE_SPHERE && !ct_obstacle_axis(o->axis, a))
    return CT_REFUSE(error, "obstacle: the %s has no length",
                     o->shape == CT_OBSTACLE_PLANE ? "normal" : "axis");
  if (o->shape != CT_OBSTACLE_PLANE && (!(o->radius > 0.0) || !isfinite(o->radius)))
    return CT_REFUSE(error, "obstacle: the radius must be positive, not %g", o->radius);
  if (o->amplitude.count == 0 &&
      (o->travel[0] != 0.0 || o->travel[1] != 0.0 || o->travel[2] != 0.0))
    return CT_REFUSE(error, "obstacle: it has a travel, but no amplitude");
  if (per == 0 || surface->face_count < 1 || surface->faces == NULL)
    return CT_REFUSE(error, "obstacle: the surface has no faces");
  for (int64_t i = 0; i < (int64_t)surface->face_count * per; i++)
    if (surface->faces[i] < 0 || surface->faces[i] >= surface->node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, i / per, surface->faces[i]},
                     "obstacle: there is no node %d", (int)surface->faces[i]);
  return CT_OK;
}

/* Row sums of the penalty's stiffness with all points inside (eq:obstacle-bound). */
static ct_status sum_springs(ct_obstacle *data, ct_error *error)
{
  const ct_search *search = data->side.search;
  double *rows = data->springs = ct_allocate((size_t)search->node_count, sizeof *rows);
  if (rows == NULL) return CT_NO_MEMORY(error, "an obstacle");
  for (int64_t i = 0; i < data->side.point_count; i++) add_spring(data, i, rows);
  for (int32_t n = 0; data->stations.fixed.point_count > 0 && n < search->node_count; n++)
    rows[n] += ct_stations_springs(&data->stations, search, data->given.epsilon);
  return CT_OK;
}

/* The obstacle as an interaction. Flops and bytes were counted at a plane (eq:round-flops). */
static void describe(ct_obstacle *data)
{
  const ct_search *search = data->side.search;
  const int64_t all = points_of(data), end = RECORD + CT_RECORD * all;
  const double points = (double)data->side.point_count, nodes = search->node_count;
  const int penalty = data->given.enforcement == CT_ENFORCE_PENALTY;
  data->is = (ct_interaction){
      .calls = &CALLS,
      .nodes = search->nodes,
      .node_count = search->node_count,
      .stiffness = 1.0,
      .explicit = penalty,
      .row_count = penalty ? 0 : all,
      .row_nodes = search->per,
      .memory_count =
          end + (data->given.shape == CT_OBSTACLE_PLANE ? 0 : 3 * (int64_t)search->node_count),
      .first_record = RECORD,
      .end_record = end,
      .flops = penalty ? 164.0 * points + 6.0 * nodes : 414.0 * points + 26.0 * nodes,
      .bytes = (2.0 * sizeof(ct_point) + 2.0 * sizeof(ct_point_record)) * points + 250.0 * nodes};
}

/* Copy the caller's definition, and compute the constant data. */
static ct_status fill(ct_obstacle *data, const ct_obstacle_def *o, const ct_surface *surface,
                      ct_error *error)
{
  size_t points = (size_t)o->amplitude.count;
  data->given = *o;
  if (o->shape != CT_OBSTACLE_SPHERE) (void)ct_obstacle_axis(o->axis, data->given.axis);
  data->given.faces = NULL; // the caller's
  data->given.amplitude.time = data->time =
      ct_duplicate(o->amplitude.time, points * sizeof(double));
  data->given.amplitude.value = data->value =
      ct_duplicate(o->amplitude.value, points * sizeof(double));
  if (!data->time || !data->value) return CT_NO_MEMORY(error, "an obstacle");
  ct_status status = ct_side_fixed_init(&data->side, surface, 0, 0, error);
  if (status == CT_OK) status = ct_stations_init(&data->stations, &data->given, &data->side, error);
  return status == CT_OK ? sum_springs(data, error) : status;
}

ct_obstacle_def ct_obstacle_def_default(void)
{
  return (ct_obstacle_def){.cookie = CT_DEF_COOKIE,
                           .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                           .dissipation = 0.15,
                           .initial_penetration = CT_INITIAL_KEEP};
}

const ct_side_fixed *ct_obstacle_side(const ct_interaction *obstacle)
{
  return &((const ct_obstacle *)obstacle)->side;
}

ct_status ct_obstacle_create(const ct_obstacle_def *def, const ct_surface *surface,
                             ct_interaction **out, ct_error *error)
{
  ct_status status = ct_check_options(def->cookie, "ct_obstacle_def_default", error);
  if (status == CT_OK) status = ct_amplitude_check(&def->amplitude, error);
  if (status == CT_OK) status = check(def, surface, error);
  if (status != CT_OK) return status;
  ct_obstacle *data = ct_allocate(1, sizeof *data);
  if (data == NULL) return CT_NO_MEMORY(error, "an obstacle");
  status = fill(data, def, surface, error);
  if (status == CT_OK) describe(data), *out = &data->is;
  else free_obstacle(&data->is);
  return status;
}
