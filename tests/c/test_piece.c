/* States in pieces, each stepped by a thread: the bits of the whole state. */
#include "hosts.h"
#include "meeting.h"

#include <unistd.h>

enum { MOST_PIECES = 4, CUTS = 5 };
/* The sanitizers are slow: under them a run is cut into most pieces only. */
#ifdef CT_SHORT_LOOPS
enum { FEWEST = MOST_PIECES };
#else
enum { FEWEST = 1 };
#endif

/* One of the pieces: its thread, its state, and the whole one that it collects. */
typedef struct member {
  pthread_t thread;
  seat at;
  const ct_state *start;
  const int32_t *owners;
  const ct_piece_part *part;
  int64_t steps;
  ct_state *piece, *whole;
  ct_piece_counts counts;
  double poison; /* added to the velocity of the last node after half of the steps */
  ct_status status;
  ct_error error;
} member;

static void *run_member(void *user)
{
  member *m = user;
  ct_piece_def def = ct_piece_def_default();
  def.number = m->at.number, def.count = m->at.with->pieces;
  def.owners = m->owners, def.part = m->part;
  def.join = (ct_pieces){&m->at, add, take_largest};
  def.exchange = hand_over;
  m->piece = NULL;
  // Every other piece has no whole state.
  m->status = m->at.number % 2 == 0
                  ? ct_state_cut(m->start, &def, &m->piece, &m->error)
                  : ct_state_receive(m->start->problem, &def, &m->piece, &m->error);
  for (int half = 0; m->status == CT_OK && half < 2; half++) {
    m->status = ct_run(m->start->problem, m->piece, m->steps / 2, NULL, 0, &m->error);
    if (half == 0 && m->piece != NULL)
      m->piece->velocity[3 * m->piece->node_count - 1] += m->poison;
  }
  if (m->status == CT_OK) m->status = ct_state_collect(m->piece, m->whole, &m->error);
  if (m->piece != NULL) ct_piece_counts_of(m->piece, &m->counts, NULL);
  ct_state_free(m->piece);
  return NULL;
}

static void run_members(member *of, int count)
{
  for (int k = 0; k < count; k++)
    if (pthread_create(&of[k].thread, NULL, run_member, &of[k]) != 0) abort();
  for (int k = 0; k < count; k++) pthread_join(of[k].thread, NULL);
}

static int64_t all_elements(const ct_problem *problem)
{
  int64_t count = 0;
  for (int b = 0; b < problem->body_count; b++) count += problem->bodies[b].mesh->element_count;
  return count;
}

/* Cuts by coordinates, in runs of elements, one by one, at random, and nearly all for the last. */
static void cut_elements(const ct_problem *problem, int how, int pieces, int32_t *owners)
{
  const int64_t all = all_elements(problem);
  if (how == 0) must(ct_piece_bisect, problem, pieces, NULL, owners);
  for (int64_t k = 0; how > 0 && k < all; k++)
    owners[k] = how == 1   ? (int32_t)(pieces * k / all)
                : how == 2 ? (int32_t)(k % pieces)
                : how == 3 ? pick(pieces)
                           : (k == 0 ? 0 : pieces - 1);
}

static ct_state *copy_of(const ct_state *state)
{
  ct_state *copy = new_state(state->problem);
  must(ct_state_copy, state->problem, state, copy);
  return copy;
}

/* Energies and momenta at a state. */
static int same_ledger(const ct_problem *problem, ct_state *a, ct_state *b)
{
  ct_energy x, y;
  must(ct_energy_of, problem, a, &x);
  must(ct_energy_of, problem, b, &y);
  return memcmp(&x, &y, sizeof x) == 0;
}

/* The whole problem as a part of itself, whose nodes have the lowest of the pieces of their
 * elements. (eq:piece-owner) */
static void number_part(const ct_problem *problem, int pieces, const int32_t *owners, int32_t *at,
                        int32_t *owner)
{
  for (int32_t n = 0; n < problem->node_count; n++) at[n] = n, owner[n] = pieces - 1;
  for (int b = 0; b < problem->body_count; b++) {
    const ct_mesh *mesh = problem->bodies[b].mesh;
    const int per = ct_brick_node_count(mesh->kind);
    for (int64_t i = 0; i < (int64_t)per * mesh->element_count; i++) {
      int32_t *of = &owner[problem->bodies[b].first_node + mesh->elements[i]];
      if (owners[i / per] < *of) *of = owners[i / per];
    }
    owners += mesh->element_count;
  }
}

/* Runs in 1 to 4 pieces, cut in five ways, have the bits of the whole run: state, energies, and the
 * state after further steps. (eq:piece-total, eq:piece-owner) */
static void same_bits(const char *name, const ct_problem *problem, int64_t steps)
{
  int32_t *owners = integers(all_elements(problem)), *at = integers(problem->node_count),
          *owner = integers(problem->node_count);
  const ct_piece_part part = {problem->node_count, at, owner};
  ct_state *start = new_state(problem), *end, *after;
  advance(problem, start, 7);
  end = copy_of(start);
  advance(problem, end, steps / 2 * 2);
  after = copy_of(end);
  advance(problem, after, 20);
  int alike = 0, runs = 0;
  double most = 0.0;
  for (int how = 0; how < CUTS; how++)
    for (int pieces = FEWEST; pieces <= MOST_PIECES; pieces++) {
      meeting with = MEETING(pieces);
      member of[MOST_PIECES];
      cut_elements(problem, how, pieces, owners);
      number_part(problem, pieces, owners, at, owner);
      for (int k = 0; k < pieces; k++)
        of[k] = (member){.at = {&with, k},
                         .start = start,
                         .owners = owners,
                         .part = k > 0 && how > 0 ? &part : NULL, // also of all nodes
                         .steps = steps,
                         .whole = k == 2 ? NULL : copy_of(start)}; // the third one gets none
      run_members(of, pieces);
      for (int k = 0; k < pieces; k++, runs++) {
        if (of[k].status != CT_OK) printf("# %s\n", of[k].error.text);
        int same = of[k].status == CT_OK && (of[k].whole == NULL || same_state(of[k].whole, end));
        if (same && k == 0) {
          same &= same_ledger(problem, of[k].whole, end);
          advance(problem, of[k].whole, 20);
          same &= same_state(of[k].whole, after);
        }
        alike += same;
        if (how == 0 && pieces == MOST_PIECES)
          most = fmax(most, (double)of[k].counts.elements / (double)all_elements(problem));
        free_state(of[k].whole);
      }
      free(with.total);
    }
  tap_ok(alike == runs && largest(end->velocity, 3 * (int64_t)problem->node_count) > 0.0,
         "%s: %d steps, %d of %d pieces with the bits of the whole; of four, one computes %.0f %% "
         "of the elements",
         name, (int)steps, alike, runs, 100.0 * most);
}

static ct_scene *scene_of(const pair *p, double beta, ct_enforcement enforcement)
{
  ct_contact_options options = options_of(p, beta);
  options.enforcement = enforcement;
  return scene_of_pair(p, &options);
}

/* Contact, friction and obstacles. */
static void touching(pair p, const char *name, ct_enforcement enforcement, double end)
{
  ct_scene *scene = scene_of(&p, enforcement == CT_ENFORCE_PENALTY ? 1.0 : 40.0, enforcement);
  int64_t steps;
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = end, .fraction = 0.9}, &steps, NULL);
  same_bits(name, problem, steps);
}

/* Contact, friction and obstacles, of which the first body is rigid. */
static void rigid(pair p, const char *name, ct_enforcement enforcement, double end)
{
  ct_scene *scene = scene_of(&p, enforcement == CT_ENFORCE_PENALTY ? 1.0 : 40.0, enforcement);
  ct_rigid_def def = ct_rigid_def_default();
  int64_t steps;
  def.bodies = &(ct_rigid){.body = 0}, def.body_count = 1;
  add_made(scene, ct_rigid_create_effect, &def);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = end, .fraction = 0.9}, &steps, NULL);
  same_bits(name, problem, steps);
}

/* Two bodies of unlike meshes, of which one moves, tied at the faces of their contact. */
static void tied(pair p, const char *name, double end)
{
  ct_scene *scene = new_scene();
  ct_tie_def def = ct_tie_def_default();
  int64_t steps;
  for (int i = 0; i < 2; i++) {
    add_moving_body(scene, i == 0 ? "a" : "b", p.mesh[i], &p.material, CT_KERNEL_AUTO,
                    p.velocity[i]);
    const int32_t first = i == 0 ? 0 : p.mesh[0]->node_count;
    def.kind[i] = ct_brick_face_kind(p.mesh[i]->kind);
    def.face_count[i] = p.face_count[i], def.faces[i] = p.faces[i];
    for (int k = 0; k < ct_face_node_count(def.kind[i]) * p.face_count[i]; k++)
      p.faces[i][k] += first;
  }
  def.epsilon = 40.0 * p.material.young, def.reach = 0.1;
  add_made(scene, ct_tie_create_effect, &def);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = end, .fraction = 0.9}, &steps, NULL);
  same_bits(name, problem, steps);
}

/* A body with everything that acts on nodes or elements. */
static void solid(const char *name, ct_brick_kind kind, ct_solid_kernel kernel, ct_law law,
                  ct_scheme scheme, int shuffled, int relaxes)
{
  const ct_material material = {.young = 900.0, .poisson = 0.3, .density = 1.0, .law = law};
  ct_mesh *straight = box_mesh(kind, 0, 0, 0, 4, 1, 1, kind == CT_HEX8 ? 17 : 7, 3, 2), *m;
  int32_t *to = integers(straight->node_count);
  if (kernel == CT_KERNEL_GENERAL) distort_inside(straight, 0.02);
  if (shuffled) m = shuffle_mesh(straight, to);
  else m = copy_mesh(straight);
  double *v = numbers(3 * m->node_count);
  for (int n = 0; n < m->node_count; n++) {
    const double *x = &m->nodes[3 * n];
    v[3 * n] = 1.0 + 0.3 * sin(2.0 * x[0]), v[3 * n + 1] = 0.2 * x[0], v[3 * n + 2] = -0.1 * x[1];
  }
  ct_scene *scene = new_scene();
  ct_scene_body def = {.name = "body",
                       .mesh = m,
                       .material = material,
                       .kernel = kernel,
                       .velocities = v,
                       .stiffness_damping =
                           law == CT_LINEAR && scheme == CT_CENTRAL_DIFFERENCE ? 1e-4 : 0.0};
  if (law == CT_LINEAR && kind == CT_HEX8) def.initial_stress[0] = 2.0;
  must(ct_scene_add_body, scene, &def, NULL);
  add_support(scene, 0, m, 0, 0.0, "yz", 0.25);
  ct_gravity_def gravity = ct_gravity_def_default();
  gravity.acceleration[2] = -9.81;
  add_made(scene, ct_gravity_create_effect, &gravity);
  ct_damping_def damping = ct_damping_def_default();
  damping.rate = relaxes ? 0.0 : 0.3, damping.relaxation = relaxes;
  add_made(scene, ct_damping_create_effect, &damping);
  int32_t *faces = integers(8 * 6 * m->element_count);
  ct_load_def load = ct_load_def_default();
  load.kind = ct_brick_face_kind(kind), load.faces = faces, load.following = 1;
  load.face_count = ct_mesh_plane_faces(m, 2, 1.0, faces, NULL), load.pressure = 3.0;
  add_made(scene, ct_load_create_effect, &load);
  ct_absorb_def absorb = ct_absorb_def_default();
  absorb.kind = load.kind, absorb.faces = faces;
  absorb.face_count = ct_mesh_plane_faces(m, 0, 4.0, faces, NULL);
  if (law == CT_LINEAR) add_made(scene, ct_absorb_create_effect, &absorb);
  ct_viscosity_def viscosity = ct_viscosity_def_default();
  viscosity.linear = 0.06, viscosity.quadratic = 1.2;
  if (kind == CT_HEX8 && law == CT_LINEAR) add_made(scene, ct_viscosity_create_effect, &viscosity);
  int64_t steps;
  const ct_problem *problem = build_by(scheme, scene, 0.2, 0.7, &steps);
  same_bits(name, problem, steps < 60 ? steps : 60);
}

/* Joins and messages of a piece that is alone. */
static int keep_all(void *data, double *values, int64_t count)
{
  (void)data, (void)values, (void)count;
  return 0;
}

static int send_none(void *data, const double *send, const int32_t *send_count, double *receive,
                     const int32_t *receive_count)
{
  (void)data, (void)send, (void)send_count, (void)receive, (void)receive_count;
  return 0;
}

/* Of a bar of 24 x 3 x 3 elements in two halves, the first one has the 13 planes of nodes up to the
 * border, computes one layer of elements more, and receives one plane of 16. (eq:piece-owner) */
static void borders(const ct_problem *problem, const int32_t *owners)
{
  ct_piece_def def = ct_piece_def_default();
  ct_state *start = new_state(problem), *piece;
  ct_piece_counts c[2];
  def.count = 2, def.owners = owners, def.exchange = send_none;
  def.join = (ct_pieces){NULL, keep_all, keep_all};
  for (def.number = 0; def.number < 2; def.number++) {
    must(ct_state_cut, start, &def, &piece);
    must(ct_piece_counts_of, piece, &c[def.number]);
    ct_state_free(piece);
  }
  tap_ok(c[0].nodes == 13 * 16 && c[1].nodes == 12 * 16 && c[0].elements == 13 * 9 &&
             c[1].elements == 12 * 9 && c[0].own_elements == 12 * 9 && c[0].received == 16 &&
             c[1].received == 16 && c[0].sent == 16 && c[0].neighbours == 1,
         "two halves of a bar: %d and %d nodes, %d and %d elements, %d received", (int)c[0].nodes,
         (int)c[1].nodes, (int)c[0].elements, (int)c[1].elements, (int)c[0].received);
}

/* The cut by coordinates: each piece of a box has its part of the elements to within one, or of
 * their weights to within the largest; a bar is cut across. (eq:piece-bisection) */
static void bisection(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 8, 1, 1, 24, 3, 3);
  ct_scene *scene = new_scene_with("bar", m, &SOFT, CT_KERNEL_AUTO, 1, 0, 0);
  const ct_problem *problem = build_until(scene, 1.0, 0.9);
  const int64_t all = all_elements(problem);
  int32_t *owners = integers(all);
  double *weight = numbers(all), sum = 0.0, off = 0.0;
  int even = 1, across = 1;
  ct_error e;
  for (int64_t i = 0; i < all; i++) sum += weight[i] = 1.0 + 4.0 * (i % 7 == 0);
  for (int pieces = 1; pieces <= 5; pieces++)
    for (int weighted = 0; weighted < 2; weighted++) {
      double has[5] = {0.0};
      must(ct_piece_bisect, problem, pieces, weighted ? weight : NULL, owners);
      for (int64_t i = 0; i < all; i++) has[owners[i]] += weighted ? weight[i] : 1.0;
      for (int k = 0; k < pieces; k++) {
        if (!weighted) even &= fabs(has[k] - (double)all / pieces) <= 1.0;
        else off = worst(off, has[k] - sum / pieces);
      }
      for (int64_t i = 9; pieces == 2 && !weighted && i < all; i++)
        across &= owners[i] == (m->nodes[3 * m->elements[8 * i]] > 3.9);
    }
  tap_ok(even && across && off <= 5.0 * 2.0,
         "pieces of a bar, cut across: equal to within one element, weights to within %g", off);
  must(ct_piece_bisect, problem, 2, NULL, owners);
  borders(problem, owners);
  weight[3] = 0.0;
  tap_ok(ct_piece_bisect(problem, 2, weight, owners, &e) == CT_ERROR_ARGUMENT &&
             ct_piece_bisect(problem, 0, NULL, owners, &e) == CT_ERROR_ARGUMENT &&
             ct_piece_bisect(NULL, 2, NULL, owners, &e) == CT_ERROR_ARGUMENT,
         "a weight of 0, no pieces, null: %s", e.text);
}

/* The edges of a cube of n cells a side differ by rounding, which does not choose where it is cut:
 * across z, so that rows along x stay whole. (eq:piece-bisection) */
static void cubes(void)
{
  int across = 0;
  for (int n = 6; n <= 16; n += 2) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, n, n, n);
    ct_scene *scene = new_scene_with("cube", m, &SOFT, CT_KERNEL_AUTO, 1, 0, 0);
    const ct_problem *problem = build_until(scene, 1.0, 0.9);
    const int64_t all = all_elements(problem);
    int32_t *owners = integers(all), right = 1;
    must(ct_piece_bisect, problem, 2, NULL, owners);
    for (int64_t i = 0; i < all; i++)
      right &= owners[i] == (m->nodes[3 * m->elements[8 * i] + 2] > 0.5 - 1e-9);
    across += right;
  }
  tap_ok(across == 6, "%d of 6 cubes are cut across z", across);
}

/* Calls that need all nodes refuse a piece, and calls for pieces a whole state. */
static void refusals(void)
{
  pair p = rods(0.05);
  ct_scene *scene = scene_of(&p, 40.0, CT_ENFORCE_ENERGY_CONTROLLED);
  const ct_problem *problem = build_until(scene, 1.0, 0.9);
  int32_t *owners = integers(all_elements(problem));
  ct_state *start = new_state(problem), *piece = NULL;
  meeting with = MEETING(1);
  seat at = {&with, 0};
  ct_piece_def def = ct_piece_def_default(), bad;
  ct_piece_counts counts;
  ct_energy energy;
  ct_error e;
  def.count = 1, def.owners = owners, def.exchange = hand_over;
  def.join = (ct_pieces){&at, add, take_largest};
  bad = def, bad.exchange = NULL;
  tap_ok(ct_state_cut(start, &bad, &piece, &e) == CT_ERROR_ARGUMENT &&
             ct_state_cut(NULL, &def, &piece, &e) == CT_ERROR_ARGUMENT &&
             ct_state_receive(NULL, &def, &piece, &e) == CT_ERROR_ARGUMENT,
         "a missing function: %s", e.text);
  tap_ok(ct_state_receive(problem, &def, &piece, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  bad = def, bad.number = 1;
  tap_ok(ct_state_cut(start, &bad, &piece, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  owners[2] = 1;
  tap_ok(ct_state_cut(start, &def, &piece, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  owners[2] = 0;
  const int32_t twice[2] = {0, 0};
  const ct_piece_part part = {problem->node_count, twice, twice};
  bad = def, bad.part = &part;
  tap_ok(ct_state_cut(start, &bad, &piece, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  bad.number = 1, bad.count = 2;
  tap_ok(ct_state_cut(start, &bad, &piece, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  must(ct_state_cut, start, &def, &piece);
  tap_ok(ct_energy_of(problem, piece, &energy, &e) == CT_ERROR_ARGUMENT &&
             ct_stable(problem, piece, &(ct_stable_step){0}, &e) == CT_ERROR_ARGUMENT &&
             ct_state_cut(piece, &def, &piece, &e) == CT_ERROR_ARGUMENT,
         "the energy, the stable step, a cut of a piece: %s", e.text);
  tap_ok(ct_state_collect(start, piece, &e) == CT_ERROR_ARGUMENT &&
             ct_piece_counts_of(start, &counts, &e) == CT_ERROR_ARGUMENT,
         "a state that is no piece: %s", e.text);
  ct_state_free(piece);
  free(with.total);
}

/* A force of a host on each node, which depends on this node alone. */
static ct_status pull(const ct_effect *effect, const ct_view *view, double *force, ct_error *error)
{
  (void)error;
  for (int32_t d = 0; d < 3 * effect->node_count; d++) force[d] = -0.5 * view->displacement[d];
  return CT_OK;
}

/* Effects of a host that do not say how they are computed in pieces are refused by name: without
 * `cut`, or with memory and without `keep`. With `common` they have the bits of the whole. */
static void host_effects(void)
{
  static const ct_effect_calls silent = {.force = pull},
                               common = {.force = pull, .pieces = {.common = 1}};
  for (int kind = 0; kind < 3; kind++) {
    pair p = rods(0.05);
    ct_scene *scene = scene_of(&p, 40.0, CT_ENFORCE_ENERGY_CONTROLLED);
    add_effect(scene, &(ct_effect){.kind = CT_EFFECT_USER,
                                   .label = "pull",
                                   .calls = kind == 0 ? &silent : &common,
                                   .node_count = p.mesh[0]->node_count + p.mesh[1]->node_count,
                                   .memory_count = kind == 1});
    const ct_problem *problem = build_until(scene, 0.9, 0.9);
    int32_t *owners = integers(all_elements(problem));
    ct_state *start = new_state(problem), *piece = NULL;
    ct_piece_def def = ct_piece_def_default();
    ct_error e;
    def.count = 1, def.owners = owners, def.exchange = send_none;
    def.join = (ct_pieces){NULL, keep_all, keep_all};
    if (kind == 2) same_bits("rods with a host's effect", problem, 40);
    else
      tap_ok(ct_state_cut(start, &def, &piece, &e) == CT_ERROR_UNSUPPORTED && piece == NULL &&
                 strstr(e.text, "pull") != NULL,
             "%s: %s", kind == 0 ? "no cut" : "memory without keep", e.text);
  }
}

/* A problem with the step of another process needs no state; its other limits are checked. */
static void known_step(void)
{
  pair p = rods(0.05);
  ct_scene *scene = scene_of(&p, 40.0, CT_ENFORCE_ENERGY_CONTROLLED);
  ct_scene_time time = {.end = 1.0, .fraction = 0.9};
  ct_stable_step stable;
  int64_t steps, again;
  const ct_problem *problem = build(scene, time, &steps, NULL);
  const double dt = problem->dt, wrong[] = {INFINITY, 1e-300, NAN};
  ct_error e;
  time = (ct_scene_time){.end = 1.0, .dt = dt, .keep_dt = 1};
  must(ct_scene_build, scene, &time, &problem, &again, NULL);
  tap_ok(problem->dt == dt && again == steps, "a known step: %d steps", (int)again);
  time.dt = 10.0 * dt;
  tap_ok(ct_scene_build(scene, &time, &problem, &again, NULL, &e) == CT_OK &&
             ct_scene_build(scene, &time, &problem, &again, &stable, &e) == CT_ERROR_STEP,
         "a step that is too large is found with the stable one: %s", e.text);
  for (int i = 0; i < 3; i++) {
    time.dt = wrong[i];
    tap_ok(ct_scene_build(scene, &time, &problem, &again, NULL, &e) == CT_ERROR_ARGUMENT, "%s",
           e.text);
  }
}

/* Errors: the same status in all pieces. */
static void failures(void)
{
  pair p = rods(0.05);
  ct_scene *scene = scene_of(&p, 40.0, CT_ENFORCE_ENERGY_CONTROLLED);
  const ct_problem *problem = build_until(scene, 1.0, 0.9);
  int32_t *owners = integers(all_elements(problem)), *others = integers(all_elements(problem));
  ct_state *start = new_state(problem);
  static const char *const NAME[] = {"NaN in one piece", "two cuts", "an owner out of range"};
  cut_elements(problem, 0, 2, owners);
  for (int what = 0; what < 3; what++) {
    others[0] = what == 2 ? 2 : 0;
    meeting with = MEETING(2);
    member of[2];
    for (int k = 0; k < 2; k++)
      of[k] = (member){.at = {&with, k},
                       .start = start,
                       .owners = what > 0 && k == 1 ? others : owners,
                       .steps = 40,
                       .poison = what == 0 && k == 1 ? NAN : 0.0,
                       .whole = copy_of(start)};
    run_members(of, 2);
    tap_ok(of[0].status == of[1].status && of[0].status != CT_OK, "%s: %s; and the other: %s",
           NAME[what], of[1].error.text, of[0].error.text);
    free(with.total);
  }
}

/* The allocation of this thread that fails; 0: none. */
__extension__ static __thread int64_t failing;

static void *allocate(size_t size, void *context)
{
  (void)context;
  return failing > 0 && --failing == 0 ? NULL : malloc(size);
}

static void release(void *memory, void *context)
{
  (void)context;
  free(memory);
}

static void *run_short_of_memory(void *user)
{
  member *m = user;
  failing = (int64_t)m->poison;
  m->poison = 0.0;
  run_member(user);
  failing = 0;
  return NULL;
}

/* Wherever the memory of one piece ends while the state is cut, both end, and say why. */
static void memory(void)
{
  const ct_allocator own = {allocate, release, NULL, 0};
  must(ct_set_allocator, &own);
  pair p = blocks(CT_HEX8, CT_HEX8, 0.005, 0.3);
  ct_scene *scene = scene_of(&p, 40.0, CT_ENFORCE_ENERGY_CONTROLLED);
  const ct_problem *problem = build_until(scene, 1.0, 0.9);
  int32_t *owners = integers(all_elements(problem));
  ct_state *start = new_state(problem);
  int64_t faults = 0, wrong = 0;
  cut_elements(problem, 0, 2, owners);
  alarm(300); // a piece that waits for ever
  for (ct_status status = CT_ERROR_MEMORY; status != CT_OK; faults++) {
    meeting with = MEETING(2);
    member of[2];
    for (int k = 0; k < 2; k++) {
      of[k] = (member){.at = {&with, k},
                       .start = start,
                       .owners = owners,
                       .steps = 2,
                       .poison = k == 1 ? (double)faults + 1.0 : 0.0,
                       .whole = copy_of(start)};
      if (pthread_create(&of[k].thread, NULL, run_short_of_memory, &of[k]) != 0) abort();
    }
    for (int k = 0; k < 2; k++) pthread_join(of[k].thread, NULL);
    status = of[1].status;
    wrong += of[0].status != status || (status != CT_OK && status != CT_ERROR_MEMORY);
    for (int k = 0; k < 2; k++) free_state(of[k].whole);
    free(with.total);
  }
  alarm(0);
  tap_ok(faults > 50 && wrong == 0, "each of %d allocations fails in one piece: both end alike",
         (int)faults - 1);
  close_run(start, scene, NULL);
  free_all(owners);
  free_pair(&p);
  must(ct_set_allocator, NULL);
}

int main(void)
{
  const ct_enforcement solved = CT_ENFORCE_ENERGY_CONTROLLED, given = CT_ENFORCE_PENALTY;
  free_at_end();
  solid("boxes", CT_HEX8, CT_KERNEL_AUTO, CT_LINEAR, CT_CENTRAL_DIFFERENCE, 0, 0);
  solid("shuffled boxes", CT_HEX8, CT_KERNEL_AUTO, CT_LINEAR, CT_CHUNG_LEE, 1, 0);
  solid("bricks", CT_HEX8, CT_KERNEL_GENERAL, CT_LINEAR, CT_NOH_BATHE, 0, 0);
  solid("shuffled bricks", CT_HEX8, CT_KERNEL_GENERAL, CT_LINEAR, CT_TCHAMWA_WIELGOSZ, 1, 0);
  solid("reduced bricks", CT_HEX8, CT_KERNEL_REDUCED, CT_LINEAR, CT_CENTRAL_DIFFERENCE, 0, 0);
  solid("quadratic boxes", CT_HEX20, CT_KERNEL_AUTO, CT_LINEAR, CT_CENTRAL_DIFFERENCE, 0, 0);
  solid("quadratic bricks", CT_HEX20, CT_KERNEL_GENERAL, CT_LINEAR, CT_CENTRAL_DIFFERENCE, 1, 0);
  solid("large strain", CT_HEX8, CT_KERNEL_GENERAL, CT_NEO_HOOKEAN, CT_CENTRAL_DIFFERENCE, 0, 0);
  solid("bricks that relax", CT_HEX8, CT_KERNEL_GENERAL, CT_LINEAR, CT_CENTRAL_DIFFERENCE, 1, 1);
  touching(rods(0.05), "rods", solved, 0.9);
  touching(plates(0.05), "plates", solved, 2e-6);
  touching(rubbing(blocks(CT_HEX8, CT_HEX20, 0.005, 0.3), 0.3), "unlike blocks", solved, 0.06);
  touching(rubbing(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), 0.3), "explicit blocks", given, 0.1);
  touching(rubbing(strip(), 0.3), "a strip", solved, 0.1);
  touching(thrown(0.01), "a block, a plane and a sphere", solved, 0.1);
  touching(pierced(), "a block, a plane and a small sphere", solved, 0.1);
  touching(sunk(CT_INITIAL_REMOVE), "a block inside a plane and a sphere", solved, 0.1);
  touching(squeezed(), "a block, a plane and a cylinder", solved, 0.1);
  touching(stacked(), "two blocks, a plane and a sphere", solved, 0.06);
  rigid(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), "a rigid block", solved, 0.1);
  rigid(rubbing(blocks(CT_HEX8, CT_HEX20, 0.005, 0.3), 0.3), "a rigid block that rubs", solved,
        0.06);
  rigid(rubbing(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), 0.3), "and one by given penalty", given, 0.1);
  rigid(stacked(), "a rigid block on a block, a plane and a sphere", solved, 0.06);
  tied(blocks(CT_HEX8, CT_HEX20, 0.005, 0.3), "tied blocks", 0.06);
  bisection();
  cubes();
  refusals();
  host_effects();
  known_step();
  failures();
  memory();
  return tap_done();
}
