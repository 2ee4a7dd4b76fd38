/* A fuzz target for the optimisations: any bytes are a scene, which runs without them and with one
 * thread, and beside that with random ones, threads, cuts of the series of steps and copies of
 * states. It aborts where two values differ.
 *
 * With libFuzzer it is a target; FUZZ_MAIN makes it a program: fuzz_optimisations SECONDS
 * FIRST_SEED [INPUTS]. */
#include <libcontact.h>

#include "../c/defs.h"
#include "dice.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Counts of the campaign. */
static long long total_scenes, total_built, total_runs, total_steps, total_failures, total_asleep;

enum { MOST_BODIES = 3, MOST_ROOMS = 64, MOST_SEGMENTS = 6 };

/* How a scene is run. */
typedef struct variant {
  ct_optimisations optimisations;
  int threads;
  int calm; /* whether a segment is one series without anything in between */
  dice d;   /* what only this run does */
} variant;

/* An effect of a user. */
typedef struct own_effect {
  const ct_problem *problem;
  double k, c, push, begin, fail_at;
  int32_t far;        /* a node that it reads beside its own, or -1 */
  int armed, pending; /* whether it may fail now, and whether it has not yet */
} own_effect;

typedef struct body {
  ct_mesh *plain, *mesh;           /* before nodes were moved, and after */
  int32_t *side[2], side_count[2]; /* faces at the lower and the upper end along x */
  double end;                      /* largest x */
  ct_box box;                      /* or no cells */
  int thin;                        /* an axis along which a box has one cell, or -1 */
} body;

typedef struct run {
  ct_scene *scene;
  const ct_problem *joined, *problem;
  ct_state *state, *back;
  int body_count;
  body bodies[MOST_BODIES];
  own_effect own;
  ct_status status;
  ct_error error;
  int plain;  /* boxes in flight, on few nodes of which something acts: most of them sleep */
  int large;  /* whether threads share the elements of each box; few steps */
  int spoilt; /* whether a host has made a number that is not finite */
  int stale;  /* whether a host has changed the state while forces stood, which the next step then
                 uses */
  void *rooms[MOST_ROOMS];
  int room_count;
} run;

static void *keep(run *r, size_t count, size_t size)
{
  demand(r->room_count < MOST_ROOMS, "room in the test");
  return r->rooms[r->room_count++] = room(count, size);
}

static uint64_t mixed(uint64_t x)
{
  x = stirred(x);
  return x ^ (x >> 31);
}

/* A random number that belongs to a place, whatever its number. */
static uint64_t of_place(const double x[3], uint64_t salt)
{
  for (int c = 0; c < 3; c++) {
    double positive = x[c] + 0.0;
    uint64_t bits;
    memcpy(&bits, &positive, sizeof bits);
    salt = mixed(salt + bits + 0x9E3779B97F4A7C15u);
  }
  return salt;
}

/* Likewise on (-1, 1). */
static double number_of_place(const double x[3], uint64_t salt)
{
  return (double)(of_place(x, salt) >> 12) / (double)(1ull << 51) - 1.0;
}

static uint64_t salt_of(dice *d)
{
  uint64_t salt = 1;
  for (int i = 0; i < 4; i++) salt = salt << 8 | roll(d);
  return salt;
}

/* -- Bodies -- */

/* A box with one long axis, so that there are rows of one to many cells. */
static ct_box any_box(dice *d, ct_brick_kind kind, double begin, int is_long, int most)
{
  ct_box box = {.origin = {begin, 0.0, 0.0}, .size = {1, 1, 1}, .cells = {1, 1, 1}};
  int axis = below(d, 3), flat = chance(d, 3), widest = most > 280 ? 30 : 9;
  box.cells[axis] = (is_long ? 30 : 1) + below(d, chance(d, 3)       ? 12
                                                  : kind == CT_HEX20 ? 20
                                                  : chance(d, 12)    ? 140
                                                                     : 70);
  for (int i = 1; i < 3; i++) {
    int left = most / (box.cells[0] * box.cells[1] * box.cells[2]);
    if (left > 1 && !(flat && i == 1))
      box.cells[(axis + i) % 3] = 1 + below(d, left < widest ? left : widest);
  }
  double h = chance(d, 2) ? 1.0 : between(d, 0.5, 1.5);
  for (int c = 0; c < 3; c++) {
    box.size[c] = h * box.cells[c] * (chance(d, 3) ? between(d, 0.6, 1.4) : 1.0);
    if (c > 0 && chance(d, 3)) box.origin[c] = 0.7 * real(d);
  }
  box.layers = (ct_layers)below(d, 3);
  return box;
}

/* Nodes and elements in any order, and perhaps the axes of half of the elements turned. */
static void renumber(dice *d, ct_mesh *m)
{
  int per = ct_brick_node_count(m->kind), turned = per == 8 && chance(d, 2);
  int32_t *old = room((size_t)m->node_count, sizeof *old),
          *now = room((size_t)m->node_count, sizeof *now);
  for (int32_t n = 0; n < m->node_count; n++) {
    int32_t k = below(d, n + 1);
    double x[3];
    memcpy(x, &m->nodes[3 * k], sizeof x);
    memcpy(&m->nodes[3 * k], &m->nodes[3 * n], sizeof x);
    memcpy(&m->nodes[3 * n], x, sizeof x);
    old[n] = n == k ? n : old[k];
    old[k] = n;
  }
  for (int32_t n = 0; n < m->node_count; n++) now[old[n]] = n;
  for (int32_t e = 0; e < m->element_count; e++) {
    int32_t element[20], *here = &m->elements[e * per],
                         *there = &m->elements[below(d, e + 1) * per];
    int by = turned && chance(d, 2);
    for (int a = 0; a < per; a++) element[a] = now[here[a]];
    memcpy(here, there, (size_t)per * sizeof *here);
    for (int a = 0; a < per; a++) there[a] = element[by ? a / 4 * 4 + (a + 1) % 4 : a];
  }
  free(old);
  free(now);
}

static void keep_sides(run *r, body *b, int all)
{
  double low[3], high[3];
  size_t size = 8 * 6 * (size_t)b->plain->element_count;
  extent(b->plain, low, high);
  for (int s = 0; s < 2; s++) {
    b->side[s] = keep(r, size, sizeof(int32_t));
    b->side_count[s] =
        all ? ct_mesh_outer_faces(b->plain, b->side[s], NULL)
            : ct_mesh_plane_faces(b->plain, 0, s ? high[0] : low[0], b->side[s], NULL);
  }
  b->end = high[0];
}

/* The plain mesh of a body: a part of a ring, or a box. */
static void mesh_ring(body *b, dice *d, ct_brick_kind kind, double begin)
{
  ct_error e;
  double outer = between(d, 1.0, 3.0);
  ct_ring shape = {{begin + outer, 0.0, 0.0},
                   {outer * between(d, 0.4, 0.8), outer},
                   1.0,
                   {1 + below(d, 2), 4 + below(d, kind == CT_HEX20 ? 3 : 20),
                    1 + below(d, kind == CT_HEX20 ? 1 : 2)}};
  demand(ct_mesh_create_ring(kind, &shape, &b->plain, &e) == CT_OK, "a ring");
}

static void mesh_box(run *r, dice *d, int number, ct_brick_kind kind, double begin)
{
  ct_error e;
  body *b = &r->bodies[number];
  int most = kind == CT_HEX20 ? 24 : r->large ? 3000 : 280;
  ct_box box = any_box(d, kind, begin, r->plain, most);
  // -- Meshes that match the body before, so that corners meet corners
  const ct_box *before = number > 0 ? &r->bodies[number - 1].box : &box;
  int matches = chance(d, 3) && before->cells[0] > 0 &&
                (kind == CT_HEX8 || before->cells[1] * before->cells[2] < 12);
  for (int c = 1; c < 3 && matches; c++)
    box.cells[c] = before->cells[c], box.size[c] = before->size[c],
    box.origin[c] = before->origin[c];
  while (matches && box.cells[0] > 1 && box.cells[0] * box.cells[1] * box.cells[2] > most)
    box.cells[0] = (box.cells[0] + 1) / 2;
  b->box = box;
  demand(ct_mesh_create_box(kind, &box, &b->plain, &e) == CT_OK, "a box");
  for (int c = 0; c < 3; c++)
    if (box.cells[c] == 1) b->thin = c;
}

/* A copy of the plain mesh whose nodes are moved by up to `amount`, the same ones in any numbering.
 */
static void move_nodes(body *b, double amount, uint64_t salt)
{
  ct_error e;
  demand(ct_mesh_create_copy(b->plain, &b->mesh, &e) == CT_OK, "a copy of a mesh");
  for (int32_t n = 0; n < b->mesh->node_count && amount > 0.0; n++)
    for (int c = 0; c < 3; c++)
      b->mesh->nodes[3 * n + c] +=
          amount * number_of_place(&b->plain->nodes[3 * n], salt + (uint64_t)c);
}

/* Velocities of single nodes, of a few or of all, around that of the body. */
static double *any_velocities(dice *d, const body *b, const double velocity[3], uint64_t salt)
{
  double *each = room((size_t)b->mesh->node_count, 3 * sizeof *each);
  uint64_t few = 1 + roll(d) % 40u;
  for (int32_t n = 0; n < b->mesh->node_count; n++) {
    const double *place = &b->plain->nodes[3 * n];
    int moved = of_place(place, salt) % few == 0;
    for (int c = 0; c < 3; c++)
      each[3 * n + c] =
          velocity[c] + (moved ? 0.02 * number_of_place(place, salt + 9 + (uint64_t)c) : 0.0);
  }
  return each;
}

static ct_solid_kernel any_kernel(const run *r, dice *d, ct_brick_kind kind, ct_law law, int bricks)
{
  ct_solid_kernel kernels[] = {CT_KERNEL_GENERAL, CT_KERNEL_BOX, CT_KERNEL_REDUCED},
                  kernel = !r->plain && chance(d, 3) ? kernels[below(d, 3)] : CT_KERNEL_AUTO;
  if (kernel == CT_KERNEL_BOX && (!bricks || law != CT_LINEAR)) return CT_KERNEL_GENERAL;
  if (kernel == CT_KERNEL_REDUCED && (kind != CT_HEX8 || law != CT_LINEAR))
    return CT_KERNEL_GENERAL;
  return kernel;
}

static void add_body(run *r, dice *d, int number)
{
  body *b = &r->bodies[number];
  double gaps[] = {0.0, 0.0, 0.01, -0.01, 0.1, 0.3, 4.0};
  double begin = number == 0 ? 0.5 * real(d) : r->bodies[number - 1].end + gaps[below(d, 7)];
  ct_brick_kind kind = !r->plain && chance(d, 4) ? CT_HEX20 : CT_HEX8;
  int ring = !r->plain && chance(d, 8), mixed_up = chance(d, 5);
  b->thin = -1;
  if (ring) mesh_ring(b, d, kind, begin);
  else mesh_box(r, d, number, kind, begin);
  if (mixed_up) renumber(d, b->plain);
  keep_sides(r, b, ring || chance(d, 6));
  uint64_t salt = salt_of(d);
  double far = (kind == CT_HEX20 ? 0.03 : 0.15) * ct_mesh_shortest_edge(b->plain);
  double amount = !r->plain && chance(d, 3) ? between(d, 0.0, far) : 0.0;
  move_nodes(b, amount, salt);
  ct_material material = {between(d, 0.5, 3.0), chance(d, 5) ? 0.0 : between(d, 0.1, 0.4),
                          between(d, 0.5, 2.0),
                          (ct_law)(!r->plain && chance(d, 5) ? 1 + below(d, CT_LAW_COUNT - 1) : 0)};
  double zeros[] = {0.0, -0.0}, velocity[3];
  for (int c = 0; c < 3; c++) velocity[c] = chance(d, 3) ? zeros[below(d, 2)] : 0.08 * real(d);
  if (chance(d, 3))
    velocity[0] = (number % 2 ? -1.0 : 1.0) * between(d, 0.05, 0.4); // at each other
  ct_solid_kernel kernel =
      any_kernel(r, d, kind, material.law, !(amount > 0.0 || ring || mixed_up));
  ct_lumping lumping = chance(d, 5) ? CT_LUMP_HRZ : CT_LUMP_DEFAULT;
  ct_scene_body body = {.name = "body",
                        .mesh = b->mesh,
                        .material = material,
                        .lumping = lumping,
                        .kernel = kernel,
                        .velocity = {velocity[0], velocity[1], velocity[2]}};
  if (!r->plain && material.law == CT_LINEAR && chance(d, 8))
    body.stiffness_damping = between(d, 0.0, 0.02);
  double *each = !r->plain && chance(d, 6) ? any_velocities(d, b, velocity, salt) : NULL;
  body.velocities = each;
  r->status = ct_scene_add_body(r->scene, &body, NULL, &r->error);
  if (r->status == CT_OK) r->body_count++;
  free(each);
}

static void add_contact(run *r, dice *d)
{
  int a = below(d, r->body_count), self = chance(d, 16), b = self ? a : (a + 1) % r->body_count,
      flip = b < a;
  const body *first = &r->bodies[flip ? b : a], *second = &r->bodies[flip ? a : b];
  if (a == b && (!self || first->mesh->kind == CT_HEX20)) return;
  ct_scene_contact c = {.body_a = flip ? b : a,
                        .body_b = flip ? a : b,
                        .faces_a = first->side[1],
                        .face_count_a = first->side_count[1],
                        .faces_b = second->side[0],
                        .face_count_b = second->side_count[0],
                        .beta = between(d, 0.3, 2.0),
                        .options = ct_contact_options_default()};
  if (chance(d, 2)) c.options.enforcement = (ct_enforcement)below(d, CT_ENFORCE_COUNT);
  if (chance(d, 3)) c.options.points = CT_POINTS_LOBATTO;
  if (chance(d, 5))
    c.options.initial_penetration = chance(d, 2) ? CT_INITIAL_FORCE : CT_INITIAL_REMOVE;
  if (chance(d, 5)) c.options.adjust = 0.05;
  c.options.removal_time = c.options.initial_penetration == CT_INITIAL_REMOVE ? 3.0 : 0.0;
  if (chance(d, 3)) c.friction = between(d, 0.05, 0.6);
  if (chance(d, 2)) c.options.restitution = chance(d, 2) ? 0.0 : between(d, 0.0, 1.0);
  r->status = ct_scene_add_contact(r->scene, &c, &r->error);
}

/* Some nodes of a body in its own numbers: all, an end, or some here and there. */
static int32_t *any_nodes(run *r, dice *d, int number, int32_t *count)
{
  const ct_mesh *plain = r->bodies[number].plain;
  int32_t *nodes = keep(r, (size_t)plain->node_count, sizeof *nodes);
  double low[3], high[3];
  int how = r->plain ? 1 + below(d, 2) : below(d, 3), axis = below(d, 3), upper = below(d, 2);
  uint64_t salt = salt_of(d), few = r->plain ? 100 + roll(d) : 1 + roll(d) % 30u;
  extent(plain, low, high);
  *count = how == 1 ? ct_mesh_plane_nodes(plain, axis, upper ? high[axis] : low[axis], nodes) : 0;
  for (int32_t n = 0; how != 1 && n < plain->node_count; n++)
    if (how == 0 || of_place(&plain->nodes[3 * n], salt) % few == 0) nodes[(*count)++] = n;
  return nodes;
}

static void add_support(run *r, dice *d)
{
  ct_scene_support s = {.body = below(d, r->body_count)};
  s.nodes = any_nodes(r, d, s.body, &s.node_count);
  int axis = below(d, 3);
  for (int c = 0; c < 3; c++) {
    s.fixed[c] = c == axis || chance(d, 5);
    s.velocity[c] = s.fixed[c] && chance(d, 4) ? 0.05 * real(d) : 0.0;
  }
  // -- A plate that is held along its thickness is in plane strain
  int thin = r->bodies[s.body].thin, held = thin >= 0 && chance(d, 2);
  for (int c = 0; held && c < 3; c++) s.fixed[c] = c == thin, s.velocity[c] = 0.0;
  s.node_count = held ? r->bodies[s.body].plain->node_count : s.node_count;
  for (int32_t n = 0; held && n < s.node_count; n++) ((int32_t *)s.nodes)[n] = n;
  if (s.node_count == 0) return;
  r->status = ct_scene_add_support(r->scene, &s, &r->error);
}

/* -- Effects -- */

static ct_status own_force(const ct_effect *effect, const ct_view *view, double *force,
                           ct_error *error)
{
  own_effect *own = effect->data;
  if (own->armed && own->pending && view->time >= own->fail_at) {
    own->pending = 0;
    if (error != NULL)
      *error = (ct_error){.code = CT_ERROR_UNSUPPORTED, .text = "fails on purpose"};
    return CT_ERROR_UNSUPPORTED;
  }
  for (int32_t i = 0; i < effect->node_count; i++) {
    int64_t node = effect->nodes == NULL ? i : effect->nodes[i];
    for (int64_t c = 0; c < 3; c++) {
      double u = view->displacement[3 * node + c] -
                 (own->far < 0 ? 0.0 : view->displacement[3 * (int64_t)own->far + c]);
      double past = effect->memory_count > 0 && c == 0 ? 0.01 * view->memory[i] : 0.0;
      double a = own->push + past - own->k * u - own->c * view->velocity[3 * node + c];
      force[3 * i + c] = view->time < own->begin ? 0.0 : own->problem->mass[node] * a;
    }
    if (effect->memory_count > 0)
      view->next_memory[i] = 0.5 * view->memory[i] + view->displacement[3 * node + 1];
  }
  return CT_OK;
}

static ct_status own_frequency(const ct_effect *effect, const ct_view *view, double *omega_squared,
                               ct_error *error)
{
  (void)view, (void)error;
  *omega_squared = 4.0 * ((const own_effect *)effect->data)->k;
  return CT_OK;
}

static ct_status own_damping(const ct_effect *effect, const ct_view *view, double *rate,
                             ct_error *error)
{
  (void)view, (void)error;
  *rate = ((const own_effect *)effect->data)->c;
  return CT_OK;
}

/* The node of a body that has the smallest number of its place. */
static int32_t some_node(const run *r, int number, uint64_t salt)
{
  const ct_mesh *plain = r->bodies[number].plain;
  int32_t best = 0;
  for (int32_t n = 1; n < plain->node_count; n++)
    if (of_place(&plain->nodes[3 * n], salt) < of_place(&plain->nodes[3 * best], salt)) best = n;
  return r->joined->bodies[number].first_node + best;
}

static void add_own(run *r, dice *d)
{
  static const ct_effect_calls calls = {.force = own_force,
                                        .bounds = {.omega2 = own_frequency, .rate = own_damping}};
  int32_t count, number = below(d, r->body_count), *nodes = any_nodes(r, d, number, &count);
  own_effect *own = &r->own;
  double begin = chance(d, 3) ? between(d, 0.0, 5.0) : 0.0;
  *own = (own_effect){.problem = r->joined,
                      .k = chance(d, 2) ? 0.0 : between(d, 0.0, 0.1),
                      .c = chance(d, 2) ? 0.0 : between(d, 0.0, 0.1),
                      .push = chance(d, 3) ? 0.0 : 0.01 * real(d),
                      .begin = begin,
                      .fail_at = between(d, 0.1, 10.0),
                      .far = -1,
                      .pending = chance(d, 2)};
  uint64_t salt = salt_of(d);
  if (!r->plain && chance(d, 4)) own->far = some_node(r, below(d, r->body_count), salt);
  for (int32_t i = 0; i < count; i++) nodes[i] += r->joined->bodies[number].first_node;
  ct_effect filled = {.label = "own",
                      .calls = &calls,
                      .data = own,
                      .nodes = nodes,
                      .node_count = count},
            *effect;
  if (!r->plain && chance(d, 6)) filled.nodes = NULL, filled.node_count = r->joined->node_count;
  if (chance(d, 2)) filled.memory_count = filled.node_count;
  r->status = ct_effect_create(&filled, &effect, &r->error);
  if (r->status == CT_OK) r->status = ct_scene_add_effect(r->scene, effect, &r->error);
}

static ct_amplitude any_history(run *r, dice *d)
{
  int count = 1 + below(d, 3);
  double *time = keep(r, 4, sizeof *time), *value = keep(r, 4, sizeof *value);
  for (int i = 0; i < count; i++) {
    time[i] = i > 0          ? time[i - 1] + between(d, 0.3, 8.0)
              : chance(d, 2) ? 0.0
                             : between(d, 0.0, 5.0);
    value[i] = chance(d, 3) ? 0.0 : real(d);
  }
  return (ct_amplitude){count, time, value};
}

/* An effect of the library on the body of this number. */
static ct_status library_effect(run *r, dice *d, int32_t *number, ct_effect **effect)
{
  int what = r->plain ? 3 + below(d, 3) : below(d, 6), side = below(d, 2);
  const body *b = &r->bodies[*number];
  ct_face_kind kind = ct_brick_face_kind(b->mesh->kind);
  int32_t count = b->side_count[side], per = ct_face_node_count(kind),
          *faces = keep(r, (size_t)(count * per) + 1, sizeof *faces);
  for (int32_t i = 0; i < count * per; i++)
    faces[i] = b->side[side][i] + r->joined->bodies[*number].first_node;
  if (what == 0) {
    ct_gravity_def gravity = {COOKIE, {0.01 * real(d), 0.01 * real(d), 0.0}, number, 1, {0}};
    return ct_gravity_create_effect(&gravity, r->joined, effect, &r->error);
  }
  if (what == 1) {
    ct_damping_def damping = {COOKIE, between(d, 0.0, 0.05), 0, number, 1};
    return ct_damping_create_effect(&damping, r->joined, effect, &r->error);
  }
  if (what == 2) {
    ct_viscosity_def viscosity = {COOKIE, between(d, 0.01, 0.1), between(d, 0.0, 1.5), number, 1};
    return ct_viscosity_create_effect(&viscosity, r->joined, effect, &r->error);
  }
  if (what == 3) {
    ct_load_def load = {COOKIE,
                        .kind = kind,
                        .face_count = count,
                        .faces = faces,
                        .traction = {0.02 * real(d), 0.01 * real(d), 0.0},
                        .pressure = 0.02 * real(d),
                        .following = below(d, 2),
                        .amplitude = any_history(r, d)};
    return ct_load_create_effect(&load, r->joined, effect, &r->error);
  }
  if (what == 4) {
    ct_absorb_def absorb = {COOKIE, kind, count, faces};
    return ct_absorb_create_effect(&absorb, r->joined, effect, &r->error);
  }
  double sign = side ? 1.0 : -1.0, low[3], high[3];
  extent(b->plain, low, high);
  ct_obstacle_def o = {
      .cookie = ct_obstacle_def_default().cookie,
      .shape = CT_OBSTACLE_PLANE,
      .point = {(side ? high[0] : low[0]) + sign * 0.02 * (1.0 + real(d)), 0.3 * real(d), 0.0},
      .axis = {-sign, 0.0, 0.0},
      .radius = 5.0,
      .epsilon = between(d, 0.1, 1.0),
      .enforcement = (ct_enforcement)below(d, CT_ENFORCE_COUNT),
      .dissipation = 0.1,
      .kind = kind,
      .face_count = count,
      .faces = faces,
      .velocity = {-sign * 0.05, 0.0, 0.0}};
  if (chance(d, 3))
    o.shape = (ct_obstacle_shape)(1 + below(d, 2)), o.point[0] += 5.0 * sign, o.axis[0] = 0.0,
    o.axis[2] = 1.0;
  if (chance(d, 3)) o.amplitude = any_history(r, d), o.travel[0] = 0.1 * real(d);
  if (chance(d, 2)) o.travel_time = between(d, 0.1, 1.0);
  if (o.travel_time > 0.0) o.restitution = chance(d, 2) ? 1.0 : between(d, 0.0, 1.0);
  return ct_obstacle_create_effect(&o, r->joined, effect, &r->error);
}

static void add_effect(run *r, ct_effect *effect)
{
  if (r->status == CT_OK && effect != NULL)
    r->status = ct_scene_add_effect(r->scene, effect, &r->error);
}

static void add_effects(run *r, dice *d)
{
  ct_effect *effect = NULL;
  r->status = ct_scene_join(r->scene, &r->joined, &r->error);
  if (r->status == CT_OK && chance(d, 2)) add_own(r, d);
  for (int i = below(d, 3); i > 0 && r->status == CT_OK; i--) {
    int32_t number = below(d, r->body_count);
    effect = NULL;
    r->status = library_effect(r, d, &number, &effect);
    add_effect(r, effect);
  }
  if (r->status == CT_OK && !r->plain && chance(d, 12)) {
    ct_damping_def relaxation = {COOKIE, .relaxation = 1};
    effect = NULL;
    r->status = ct_damping_create_effect(&relaxation, r->joined, &effect, &r->error);
    add_effect(r, effect);
  }
  if (r->status == CT_OK && chance(d, 6)) {
    ct_motion motion = {.amplitude = any_history(r, d)};
    int number = below(d, r->body_count);
    int32_t *nodes = any_nodes(r, d, number, &motion.node_count);
    for (int32_t i = 0; i < motion.node_count; i++)
      nodes[i] += r->joined->bodies[number].first_node;
    motion.nodes = nodes;
    for (int c = 0; c < 3; c++)
      motion.fixed[c] = chance(d, 2), motion.displacement[c] = 0.1 * real(d);
    effect = NULL;
    r->status = create_motion(&motion, 1, r->joined, &effect, &r->error);
    add_effect(r, effect);
  }
}

/* -- Runs -- */

static void build(run *r, dice *d, const variant *v)
{
  ct_stable_step stable;
  int64_t steps;
  ct_scene_time time = {.end = between(d, 30.0, 60.0), .fraction = between(d, 0.4, 0.95)};
  if (chance(d, 2)) time.integrator = ct_integrator_default((ct_scheme)below(d, CT_SCHEME_COUNT));
  if (chance(d, 8)) time.assembled = 1;
  if (chance(d, 3)) time.force_tolerance = 1e-3;
  ct_optimisations optimisations = v->optimisations;
  optimisations.plane_strain = !chance(d, 4);
  if (r->status == CT_OK)
    r->status = ct_scene_set_optimisations(r->scene, &optimisations, &r->error);
  if (r->status == CT_OK)
    r->status = ct_scene_build(r->scene, &time, &r->problem, &steps, &stable, &r->error);
  if (r->status == CT_OK) r->status = ct_state_create(r->problem, &r->state, &r->error);
  if (r->status == CT_OK) r->status = ct_state_create(r->problem, &r->back, &r->error);
}

/* The same scene whenever the dice are the same. */
static void open_run(run *r, dice *d, variant *v)
{
  *r = (run){.own = {.far = -1}};
  demand(ct_scene_create(&r->scene, &r->error) == CT_OK, "an empty scene");
  r->status =
      ct_scene_set_run_settings(r->scene, &(ct_run_settings){.threads = v->threads}, &r->error);
  int bodies = 1 + below(d, MOST_BODIES);
  r->plain = chance(d, 3);
  r->large = chance(d, 6);
  for (int i = 0; i < bodies && r->status == CT_OK; i++) add_body(r, d, i);
  for (int i = below(d, 3); i > 0 && r->status == CT_OK; i--) add_contact(r, d);
  for (int i = below(d, 3); i > 0 && r->status == CT_OK; i--) add_support(r, d);
  if (r->status == CT_OK) add_effects(r, d);
  build(r, d, v);
  total_runs++;
}

static void close_run(run *r)
{
  ct_state_free(r->state);
  ct_state_free(r->back);
  ct_scene_free(r->scene);
  for (int i = 0; i < MOST_BODIES; i++) {
    ct_mesh_free(r->bodies[i].plain);
    ct_mesh_free(r->bodies[i].mesh);
  }
  for (int i = 0; i < r->room_count; i++) free(r->rooms[i]);
}

/* Ask for something that changes nothing. */
static void ask(run *r, dice *d)
{
  ct_error e;
  ct_energy energy;
  ct_momentum momentum;
  double omega, rate, *force;
  switch (below(d, 5)) {
  case 0:
    (void)ct_energy_of(r->problem, r->state, &energy, &e);
    break;
  case 1:
    (void)ct_momentum_of(r->problem, r->state, below(d, r->body_count), &momentum, &e);
    break;
  case 2:
    (void)ct_stable_contribution(r->problem, r->state, below(d, r->problem->effect_count), &omega,
                                 &rate, &e);
    break;
  case 3:
    (void)ct_energy_residual(r->problem, r->state, &rate, &e);
    break;
  default:
    force = room(3 * (size_t)r->problem->node_count, sizeof *force);
    (void)ct_state_force(r->problem, r->state, below(d, r->problem->effect_count), force, &e);
    free(force);
  }
}

/* Go on in a state of its own, new or used, or in the same. */
static void change_state(run *r, dice *d)
{
  ct_error e;
  ct_state *other = NULL;
  demand(ct_state_create(r->problem, &other, &e) == CT_OK, "another state");
  int pending = r->own.pending;
  r->own.pending = 0;
  if (chance(d, 2)) (void)ct_run(r->problem, other, 1 + below(d, 30), NULL, 0, &e);
  r->own.pending = pending;
  demand(ct_state_copy(r->problem, r->state, other, &e) == CT_OK, "a copy of a state");
  if (chance(d, 4)) {
    demand(ct_state_copy(r->problem, other, r->state, &e) == CT_OK, "a copy back");
    ct_state_free(other);
    return;
  }
  ct_state_free(r->state);
  r->state = other;
}

/* Steps that a watch looks at, which wants nothing but numbers. */
static ct_status watched_steps(run *r, int64_t count, int64_t every)
{
  ct_monitor *watch = NULL;
  ct_monitor_options options = ct_monitor_options_default();
  options.every = every;
  options.energy_limit = options.omega_limit = options.growth_limit = INFINITY;
  options.stable = r->problem->dt;
  ct_status status = ct_monitor_create(r->problem, r->state, &options, &watch, &r->error);
  if (status == CT_OK)
    status = ct_run(r->state->problem, r->state, count, (ct_observer[]){ct_monitor_observer(watch)},
                    1, &r->error);
  ct_monitor_free(watch);
  return status;
}

/* Take some steps, in one series or in many. */
static void take_steps(run *r, variant *v, int64_t count)
{
  int64_t end = r->state->step + count;
  r->status = CT_OK;
  if (v->calm) {
    r->own.armed = 1;
    r->status = ct_run(r->problem, r->state, count, NULL, 0, &r->error);
  }
  while (r->status == CT_OK && r->state->step < end) {
    int64_t left = end - r->state->step,
            part = chance(&v->d, 2) ? left : 1 + below(&v->d, (int)left);
    if (!r->own.pending && chance(&v->d, 4)) ask(r, &v->d);
    if (chance(&v->d, 5) && !r->stale) change_state(r, &v->d);
    int stale = r->stale;
    r->stale = 0;
    r->own.armed = 1;
    int how = below(&v->d, 4);
    // A look at the end would leave forces standing, before a host changes the state.
    int watched = how == 1 && !r->own.pending && !stale && part < left;
    r->status = how == 0 && part == 1 && !r->spoilt ? ct_step(r->problem, r->state, &r->error)
                : watched ? watched_steps(r, part, 1 + below(&v->d, 9))
                          : ct_run(r->problem, r->state, part, NULL, 0, &r->error);
    r->own.armed = 0;
  }
  r->own.armed = r->stale = 0;
  total_steps += count;
}

/* What a host may do to a state. The dice are the same in all runs. */
static void meddle(run *r, dice d)
{
  int how = chance(&d, 24) ? 6 : below(&d, 6), number = below(&d, r->body_count),
      axis = below(&d, 3);
  uint64_t salt = salt_of(&d), few = 1 + roll(&d) % 60u;
  double amount = 0.01 * real(&d);
  const ct_mesh *plain = r->bodies[number].plain;
  int32_t worst =
      how == 6 ? some_node(r, number, salt) - r->problem->bodies[number].first_node : -1;
  for (int32_t n = 0; n < plain->node_count; n++) {
    const double *x = &plain->nodes[3 * n];
    int64_t dof = 3 * ((int64_t)r->problem->bodies[number].first_node + n);
    int chosen = of_place(x, salt) % few == 0;
    double *u = &r->state->displacement[dof], *w = &r->state->velocity[dof];
    if (how == 0 && chosen) u[axis] += amount * number_of_place(x, salt + 1);
    if (how == 1 && chosen) w[axis] += amount;
    if (how == 2) u[0] = u[1] = u[2] = w[1] = w[2] = 0.0, w[0] = amount; // all alike again
    if (how == 3 && chosen) w[axis] = -0.0;
    if (how == 4) u[axis] += 1.0;
    if (how == 6 && n == worst)
      (amount > 0.0 ? u : w)[axis] = fabs(amount) > 0.005 ? NAN : INFINITY, r->spoilt = 1;
    if (how == 5 && chosen)
      w[axis] = nextafter(w[axis], 1.0); // which rounding may hide in the displacement
  }
}

/* -- Beside one another -- */

static void differ(const run *a, const char *what, int64_t i)
{
  fprintf(stderr, "broken promise: %s, entry %lld, step %lld\n", what, (long long)i,
          (long long)a->state->step);
  abort();
}

/* Equal values: the sign of a zero is no promise. */
static int same(double x, double y) { return x == y || (isnan(x) && isnan(y)); }

static void compare_numbers(const run *a, const void *x, const void *y, int64_t count,
                            const char *what)
{
  const double *p = x, *q = y;
  for (int64_t i = 0; i < count; i++) {
    if (same(p[i], q[i])) continue;
    fprintf(stderr, "%.17g beside %.17g\n", p[i], q[i]);
    differ(a, what, i);
  }
}

static void compare_states(const run *a, const run *b)
{
  const ct_state *s = a->state, *t = b->state;
  if (s->step != t->step) differ(a, "number of steps", t->step);
  compare_numbers(a, &s->time, &t->time, 1, "time");
  compare_numbers(a, s->displacement, t->displacement, 3 * (int64_t)s->node_count, "displacement");
  compare_numbers(a, s->velocity, t->velocity, 3 * (int64_t)s->node_count, "velocity");
  compare_numbers(a, &s->kinetic_start, &t->kinetic_start, 1, "kinetic energy at the start");
  compare_numbers(a, s->work, t->work, s->work_count, "work");
  compare_numbers(a, s->impulse, t->impulse, s->impulse_count, "impulse");
  compare_numbers(a, s->memory, t->memory, s->memory_count, "memory");
}

/* Forces at the nodes, energies and momenta. */
static void compare_ledgers(run *a, run *b)
{
  run *each[2] = {a, b};
  ct_energy energy[2];
  ct_momentum momentum[2];
  ct_error e;
  ct_status status[2];
  double *force[2], work[2], stored[2];
  for (int i = 0; i < 2; i++)
    status[i] = ct_energy_of(each[i]->problem, each[i]->state, &energy[i], &e);
  if (status[0] != status[1]) differ(a, "whether there is a ledger", status[1]);
  if (status[0] != CT_OK) return;
  for (int i = 0; i < 2; i++) force[i] = room(3 * (size_t)a->problem->node_count, sizeof(double));
  for (int32_t k = 0; k < a->problem->effect_count; k++) {
    for (int i = 0; i < 2; i++) {
      status[i] = ct_state_force(each[i]->problem, each[i]->state, k, force[i], &e);
      demand(ct_energy_work(each[i]->problem, each[i]->state, k, &work[i], &e) == CT_OK,
             "work of an effect");
      demand(ct_energy_stored(each[i]->problem, each[i]->state, k, &stored[i], &e) == CT_OK,
             "what an effect stores");
    }
    if (status[0] != status[1]) differ(a, "whether there is a force", k);
    if (status[0] == CT_OK)
      compare_numbers(a, force[0], force[1], 3 * (int64_t)a->problem->effects[k]->node_count,
                      "force of an effect");
    compare_numbers(a, &work[0], &work[1], 1, "work of an effect");
    compare_numbers(a, &stored[0], &stored[1], 1, "stored energy of an effect");
  }
  for (int i = 0; i < 2; i++) free(force[i]);
  compare_numbers(a, &energy[0], &energy[1], sizeof energy[0] / sizeof(double), "energy");
  for (int32_t k = 0; k < a->body_count; k++) {
    for (int i = 0; i < 2; i++)
      demand(ct_momentum_of(each[i]->problem, each[i]->state, k, &momentum[i], &e) == CT_OK,
             "momentum");
    compare_numbers(a, momentum[0].p, momentum[1].p, 6, "momentum");
    compare_numbers(a, momentum[0].contact_impulse, momentum[1].contact_impulse, 6,
                    "impulses on a body");
  }
}

/* After an error: whether to go on from the state of the last segment. */
static int recover(run *a, run *b, dice *d)
{
  ct_error e;
  if (a->status == CT_ERROR_BLOWUP || b->status == CT_ERROR_BLOWUP || a->spoilt) {
    demand(a->status != CT_OK && b->status != CT_OK, "both blow up");
    return 0;
  }
  if (a->status != b->status) differ(a, "errors", b->status);
  compare_states(a, b);
  if (a->error.body != b->error.body || a->error.element != b->error.element ||
      a->error.point != b->error.point)
    differ(a, "places of errors", 0);
  if (a->status != CT_ERROR_UNSUPPORTED) return 0; // it would come again
  total_failures++;
  if (a->problem->integrator.scheme != CT_NOH_BATHE && chance(d, 2)) return 1;
  run *each[2] = {a, b};
  for (int i = 0; i < 2; i++)
    demand(ct_state_copy(each[i]->problem, each[i]->back, each[i]->state, &e) == CT_OK,
           "a copy of a good state");
  return 1;
}

/* Two runs of one scene beside each other. */
static void beside(dice scene, variant one, variant other)
{
  run a, b;
  ct_error e;
  dice d = scene, twin = scene;
  open_run(&a, &d, &one);
  open_run(&b, &twin, &other);
  if (a.status != b.status) {
    fprintf(stderr, "%s | %s\n", a.status ? a.error.text : "built",
            b.status ? b.error.text : "built");
    demand(0, "both scenes can be built, or none");
  }
  if (a.status == CT_OK) {
    total_built++;
    compare_numbers(&a, &a.problem->dt, &b.problem->dt, 1, "time step");
    for (int i = 1 + below(&d, MOST_SEGMENTS); i > 0; i--) {
      int64_t steps = 1 + below(&d, a.large ? 3 : chance(&d, 3) ? 5 : 40);
      demand(ct_state_copy(a.problem, a.state, a.back, &e) == CT_OK &&
                 ct_state_copy(b.problem, b.state, b.back, &e) == CT_OK,
             "a copy of a state");
      take_steps(&a, &one, steps);
      take_steps(&b, &other, steps);
      demand(!a.spoilt || a.status != CT_OK, "what is not finite is found");
      if ((a.status != CT_OK || b.status != CT_OK) && !recover(&a, &b, &d)) break;
      compare_states(&a, &b);
      int asked = !a.own.pending && chance(&d, 2);
      if (asked) compare_ledgers(&a, &b);
      if (chance(&d, 4)) {
        meddle(&a, d);
        meddle(&b, d);
        a.stale = b.stale = asked;
      }
      // Forces that stand are those from before the host changed the state; what is stored may be
      // made of both.
      if (!a.own.pending && !a.stale && chance(&d, 4)) compare_ledgers(&a, &b);
    }
  }
  if (b.state != NULL) total_asleep += b.state->element_updates[1];
  close_run(&a);
  close_run(&b);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  dice d = dice_open(data, size), scene = d;
  scene.seed = mixed(d.seed) | 1;
  total_scenes++;
  // What a run chooses comes after what the scene is made of; where bytes are given they are for
  // the scene.
  variant all = {.threads = 1, .calm = 1, .d = {.seed = mixed(d.seed + 1) | 1}},
          some = {.d = {.seed = mixed(d.seed + 2) | 1}};
  dice *own = &some.d;
  some.optimisations =
      (ct_optimisations){.sleep = !chance(own, 5), .shared_stiffness = below(own, 2)};
  some.threads = chance(own, 3) ? (int[]){2, 3, 8}[below(own, 3)] : 1;
  some.calm = chance(own, 4);
  beside(scene, all, some);
  return 0;
}

#ifdef FUZZ_MAIN
#include "seeds.h"

/* Inputs of consecutive seeds; prints the counts, or the seed of the input that failed. */
int main(int count, char **argument)
{
  unsigned long long first = count > 2 ? strtoull(argument[2], NULL, 10) : 1;
  long long most = count > 3 ? atoll(argument[3]) : -1;
  run_seeds(count > 1 ? atof(argument[1]) : 10.0, first, most);
  printf("seeds %llu to %llu: scenes %lld runs %lld pairs built %lld failures %lld steps %lld "
         "forces of elements left out %lld\n",
         first, now_seed - 1, total_scenes, total_runs, total_built, total_failures, total_steps,
         total_asleep);
  return 0;
}
#endif
