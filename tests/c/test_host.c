/* The contact of a host with its own time loop: forces against those of a scene, energy in loops of
 * its own. */
#include "../../libcontact/src/step/workspace.h"
#include "counting.h"
#include "hosts.h"

/* Difference of the host's values from those of a scene, and their largest size. */
typedef struct told {
  double energy, most, before, lost, reaction, top, work, traction, pressure;
} told;

static int presses(const ct_effect *effect)
{
  return effect->kind == CT_EFFECT_CONTACT || effect->kind == CT_EFFECT_FRICTION ||
         effect->kind == CT_EFFECT_OBSTACLE;
}

/* Forces of contacts, obstacles and friction of a scene. */
static void add_scene(const ct_problem *problem, const ct_state *state, double *force)
{
  memset(force, 0, 3 * (size_t)problem->node_count * sizeof *force);
  for (int32_t k = 0; k < problem->effect_count; k++)
    for (int32_t i = 0; presses(problem->effects[k]) && i < problem->effects[k]->node_count; i++)
      for (int c = 0; c < 3; c++)
        force[3 * ct_effect_node(problem->effects[k], i) + c] +=
            state->workspace->force[k][3 * i + c];
}

/* Force, work and tractions of obstacle `k` of a host and of effect `effect` of a scene. */
static void compare_obstacle(const ct_problem *problem, ct_state *state, const ct_contact *contact,
                             int32_t k, int32_t effect, told *so)
{
  const int32_t count = problem->node_count;
  double force[3], work, got[3], done, *t = numbers(4 * count), *u = numbers(4 * count);
  ct_error e;
  must(ct_obstacle_reaction, problem, state, effect, force, &work);
  need(ct_contact_reaction(contact, k, got, &done, NULL), &e);
  const int rubs = effect + 1 < problem->effect_count &&
                   problem->effects[effect + 1]->kind == CT_EFFECT_FRICTION;
  for (int c = 0; c < 3; c++) {
    for (int32_t i = 0; rubs && i < problem->effects[effect + 1]->node_count; i++)
      force[c] -= state->workspace->force[effect + 1][3 * i + c];
    so->reaction = worst(so->reaction, got[c] - force[c]);
    so->top = fmax(so->top, fabs(force[c]));
  }
  if (!rubs) so->work = worst(so->work, done - work);
  must(ct_obstacle_traction, problem, state, effect, t, t + 3 * count);
  // Nodes of a second surface have numbers of their own; those of the first come first.
  if (ct_contact_traction(contact, 2 + k, u, u + 3 * count, &e) != CT_OK) so->traction = INFINITY;
  const int32_t first = problem->bodies[0].mesh->node_count;
  for (int32_t d = 0; problem->effects[effect]->nodes[0] < first && d < 3 * first; d++) {
    so->traction = worst(so->traction, u[d] - t[d]);
    so->pressure = fmax(so->pressure, fabs(t[d]));
  }
}

static void compare(const ct_problem *problem, ct_state *state, const ct_contact *contact, told *so)
{
  ct_contact_balance balance;
  double energy = 0.0, lost = 0.0;
  ct_error e = {0};
  need(ct_contact_balance_of(contact, &balance, NULL), &e);
  for (int32_t k = 0, wall = 0; k < problem->effect_count; k++) {
    double held = 0.0, gone = 0.0;
    const ct_effect_kind kind = problem->effects[k]->kind;
    if (!presses(problem->effects[k])) continue;
    if (kind == CT_EFFECT_FRICTION) must(ct_friction_energy, problem, state, k, &held, &gone);
    else must(ct_energy_stored, problem, state, k, &held);
    if (kind == CT_EFFECT_OBSTACLE) compare_obstacle(problem, state, contact, wall++, k, so);
    energy += held, lost += gone;
  }
  so->energy = worst(so->energy, balance.energy - energy);
  so->energy = worst(so->energy, ct_contact_energy(contact) - balance.energy);
  // What an unlike first step has dissipated stays.
  if (so->most == 0.0) so->before = balance.friction - lost;
  so->lost = worst(so->lost, balance.friction - lost - so->before);
  so->most = fmax(so->most, energy);
}

/* In each step of a scene a host makes the same call with the scene's coordinates, velocities and
 * other forces, over one array of nodes and over two. (eq:host-step) */
static void like_the_scene(pair p, const char *name, ct_contact_options options, double end,
                           double bits)
{
  ct_scene *scene = scene_of_pair(&p, &options);
  ct_stable_step stable;
  int64_t steps;
  ct_error e;
  // The scene goes half a step back from t = 0: its start gaps do not fade yet, and a point that
  // touches already leaves.
  const double tolerance =
      bits > 0.0 ? 1e-10 : 0.0; // with the default one all bits are the scene's
  const int64_t from = p.inside || options.initial_penetration == CT_INITIAL_REMOVE;
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = end, .fraction = 0.9, .force_tolerance = tolerance},
            &steps, &stable);
  ct_state *state = new_state(problem);
  const int32_t count = problem->node_count, split = p.bodies == 2 ? 3 * p.mesh[0]->node_count : 0;
  ct_contact *contact[2];
  options.force_tolerance = tolerance;
  for (int i = 0; i < 2; i++) contact[i] = open_contact(&p, &options, problem->reference, i == 0);
  double *x = numbers(3 * count), *f = numbers(3 * count), *solid = numbers(3 * count),
         *want = numbers(3 * count), off[2] = {0.0, 0.0}, top = 0.0;
  told so = {0};
  for (int64_t n = 0; n < steps; n++) {
    must(ct_workspace_forces, problem, state);
    for (int32_t k = 0; k < count; k++) ct_workspace_force_at(problem, state, 0, k, &solid[3 * k]);
    const double *v = n == 0 ? problem->initial_velocity : state->velocity;
    for (int d = 0; d < 3 * count; d++) x[d] = problem->reference[d] + state->displacement[d];
    add_scene(problem, state, want);
    for (int d = 0; d < 3 * count; d++) top = fmax(top, fabs(want[d]));
    for (int i = 0; i < 2; i++) {
      int next = i == 0 ? 0 : split;
      ct_contact_prediction prediction = {.x_a = x,
                                          .x_b = x + next,
                                          .velocity_a = v,
                                          .velocity_b = v + next,
                                          .force_a = solid,
                                          .force_b = solid + next,
                                          .inverse_mass_a = problem->inverse_mass,
                                          .inverse_mass_b = problem->inverse_mass + next,
                                          .dt = problem->dt,
                                          .force_time = n == 0 ? 0.5 * problem->dt : problem->dt};
      must(ct_contact_step, contact[i], &prediction);
      memset(f, 0, 3 * (size_t)count * sizeof *f);
      need(ct_contact_add_force(contact[i], f, f + next, NULL), &e);
      for (int d = 0; d < 3 * count; d++)
        if (n >= from) off[i] = worst(off[i], f[d] - want[d]);
      if (n > from) compare(problem, state, contact[i], &so);
    }
    advance(problem, state, 1);
  }
  tap_ok(top > 0.0 && off[0] <= bits * top && off[1] <= bits * top,
         "%s: forces of %d steps are the scene's, off by %.1e, and over two arrays by %.1e of the "
         "largest (allowed %.0e)",
         name, (int)steps, off[0] / top, off[1] / top, bits);
  // Friction is solved to 1e-6, which begins with other forces in the first step.
  const double same = bits > 1e-6 ? 10.0 * bits : 1e-12;
  tap_ok(so.most > 0.0 && so.energy <= same * so.most && so.lost <= same * so.most,
         "%s: and so are the energy, off by %.1e, and what friction has dissipated, off by %.1e of "
         "it",
         name, so.energy / so.most, so.lost / so.most);
  if (p.obstacles > 0)
    tap_ok(so.top > 0.0 && so.reaction <= same * so.top && so.work <= same * so.most &&
               so.traction <= same * so.pressure,
           "%s: and the forces on obstacles, off by %.1e, work, %.1e, and tractions, %.1e", name,
           so.reaction / so.top, so.work / so.most, so.traction / so.pressure);
}

/* The energy of bodies and contact grows in no step, that of the bodies alone at no penalty, and
 * the bodies gain the work that the contact reports. (eq:host-work) */
static void never_grows(pair p, const char *name, double end, double allowed, double least)
{
  static const double BETA[] = {1.0, 10.0, 40.0, 100.0, 1000.0};
  double rise[2] = {-1.0, -1.0}, own = -1.0, balance = 0.0, left = 1.0, most = 0.0;
  int64_t steps = 0, unconverged = 0;
  for (int b = 0; b < 10; b++) {
    ct_contact_options options = options_of(&p, BETA[b % 5]);
    options.restitution = b / 5;
    host h = open_host(&p, &options, 0.9);
    ct_contact_balance now = {0};
    ct_error e = {0};
    double start = 0.0, lowest = INFINITY;
    for (steps = 0; (double)steps * h.dt < end; steps++) {
      double bodies = step_host(&h, steps);
      need(ct_contact_balance_of(h.contact, &now, NULL), &e);
      double total = bodies + now.energy - now.motion - now.removal;
      if (steps == 0) start = total;
      balance = worst(balance, (bodies - start - now.work) / start);
      // What a stiff contact has booked is the square of a gap (eq:energy-lent).
      if (b % 5 < 4) rise[b / 5] = fmax(rise[b / 5], (total - fmin(lowest, start)) / start);
      own = fmax(own, (total - fmax(now.energy, 0.0) - start) / start);
      lowest = fmin(lowest, total);
      left = fmin(left, total / start);
      most = fmax(most, now.energy / start);
    }
    unconverged += now.unconverged;
  }
  // Faces that turn a little make gaps that are not linear; lost energy hides it, held does not.
  tap_ok(rise[0] <= allowed && rise[1] <= fmax(allowed, 1e-9) && left > least && most > 1e-3 &&
             unconverged == 0,
         "%s, %d steps of 0.9 of its own, beta 1 ... 100: the energy never grows by more than %.1e "
         "(allowed %.0e), with restitution 1 by %.1e; %.3f stays, the contact stored up to %.3f",
         name, (int)steps, rise[0], allowed, rise[1], left, most);
  tap_ok(own <= allowed, "%s, beta 1 ... 1000: the bodies' own energy grows by %.1e", name, own);
  tap_ok(balance < 1e-11, "%s: bodies gain the work of the contact, off by %.1e", name, balance);
}

/* A host that saves and continues with another contact, or with the same one from an earlier time,
 * gets the same bits. */
static void restart(pair p, const char *name, ct_enforcement enforcement)
{
  enum { STEPS = 60 };
  ct_contact_options options = options_of(&p, enforcement == CT_ENFORCE_PENALTY ? 1.0 : 10.0);
  options.enforcement = enforcement;
  if (p.obstacles == 0) {
    options.initial_penetration = CT_INITIAL_REMOVE;
    options.removal_time = 0.2;
  }
  host whole = open_host(&p, &options, 0.9), parts = open_host(&p, &options, 0.9),
       spare = open_host(&p, &options, 0.9);
  const int64_t count = ct_contact_save(parts.contact, NULL);
  double *memory = numbers((int)count), *later = numbers((int)count);
  ct_contact_balance want, got;
  ct_error e;
  for (int64_t n = 0; n < 2 * STEPS; n++) step_host(&whole, n);
  for (int64_t n = 0; n < STEPS; n++) step_host(&parts, n);
  ct_contact_save(parts.contact, memory);
  ct_contact *first = parts.contact;
  parts.contact = spare.contact, spare.contact = first;
  must(ct_contact_restore, parts.contact, memory, count);
  ct_contact_save(parts.contact, later);
  const int alike = memcmp(memory, later, (size_t)count * sizeof *memory) == 0;
  for (int64_t n = STEPS; n < 2 * STEPS; n++) step_host(&parts, n);
  need(ct_contact_balance_of(whole.contact, &want, NULL), &e);
  need(ct_contact_balance_of(parts.contact, &got, NULL), &e);
  tap_ok(alike && same_host(&whole, &parts) && want.work != 0.0 && want.work == got.work &&
             want.energy == got.energy && want.friction == got.friction &&
             want.motion == got.motion && want.removal == got.removal,
         "%s: a restart of %d numbers in mid-run has the same bits", name, (int)count);
  // Once more from the beginning, by a contact that has gone on.
  host again = open_host(&p, &options, 0.9);
  ct_contact_save(again.contact, memory);
  first = again.contact, again.contact = parts.contact, parts.contact = first;
  must(ct_contact_restore, again.contact, memory, count);
  for (int64_t n = 0; n < 2 * STEPS; n++) step_host(&again, n);
  tap_ok(same_host(&whole, &again), "%s: a restart from the beginning has them, too", name);
}

/* A face of four free nodes over a fixed one: by symmetry one mass M = 4 m on the springs of all
 * eight points, K = ε A. */
typedef struct face {
  ct_surface surface;
  double x[12], v[12], f[12], inverse_mass[12], increment[12];
} face;

static const int32_t UP[4] = {0, 3, 2, 1}, DOWN[4] = {0, 1, 2, 3};

static face face_at(double z, double inverse_mass, const int32_t *nodes)
{
  static const double square[4][2] = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  face a = {.surface = {.kind = CT_Q4, .node_count = 4, .face_count = 1, .faces = nodes}};
  for (int n = 0; n < 4; n++) {
    a.x[3 * n] = square[n][0], a.x[3 * n + 1] = square[n][1], a.x[3 * n + 2] = z;
    for (int c = 0; c < 3; c++) a.inverse_mass[3 * n + c] = inverse_mass;
  }
  return a;
}

static ct_contact_prediction prediction_of(face *a, face *b, double dt, double kick)
{
  return (ct_contact_prediction){.x_a = a->x,
                                 .x_b = b->x,
                                 .velocity_a = a->v,
                                 .velocity_b = b->v,
                                 .force_a = a->f,
                                 .inverse_mass_a = a->inverse_mass,
                                 .inverse_mass_b = b->inverse_mass,
                                 .dt = dt,
                                 .force_time = kick};
}

static ct_contact *open_faces(face *a, face *b, ct_contact_options options)
{
  ct_contact *contact = NULL;
  a->surface.reference = a->x, b->surface.reference = b->x;
  must(ct_contact_create, &a->surface, &b->surface, &options, &contact);
  return later_contact(contact);
}

static ct_contact_options plain(void)
{
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 50.0;
  options.dissipation = options.restitution = 0.0;
  options.initial_penetration = CT_INITIAL_FORCE;
  return options;
}

/* Force on the upper face along z. */
static double lift(const ct_contact *contact)
{
  double fa[12] = {0}, fb[12] = {0}, sum = 0.0;
  ct_contact_add_force(contact, fa, fb, NULL);
  for (int n = 0; n < 4; n++) sum += fa[3 * n + 2];
  return sum;
}

/* λ = K ⟨-½ [g_{n+1} + min(g_{n-1}, 0)]⟩ with g_{n+1} = g_free + Δt kick λ / M. */
static double by_hand(double K, double free, double before, double mobility)
{
  return fmax(-0.5 * K * (free + fmin(before, 0.0)) / (1.0 + 0.5 * K * mobility), 0.0);
}

/* Steps of unlike lengths by hand, the first of them from v_0, with a load, over a wall that stands
 * or moves; the increments given or left to the library. (eq:host-step) */
static void steps_by_hand(double wall, int given)
{
  static const double DT[] = {0.01, 0.01, 0.02, 0.015, 0.015, 0.015};
  const double m = 0.5, M = 4 * m, K = 100.0, load = -3.0;
  face a = face_at(0.02, 1.0 / m, UP), b = face_at(0.0, 0.0, DOWN);
  ct_contact *contact = open_faces(&a, &b, plain());
  double off = 0.0, top = 0.0, g = 0.02, v = -2.0, last = 0.0;
  for (int n = 0; n < 4; n++) a.v[3 * n + 2] = v, b.v[3 * n + 2] = wall, a.f[3 * n + 2] = load / 4;
  for (int i = 0; i < 6; i++) {
    double dt = DT[i], kick = i == 0 ? 0.5 * dt : 0.5 * (dt + last),
           free = g + dt * (v - wall + kick * load / M),
           want = by_hand(K, free, g - last * (v - wall), dt * kick / M);
    ct_contact_prediction p = prediction_of(&a, &b, dt, kick);
    for (int n = 0; n < 4; n++) {
      a.increment[3 * n + 2] = dt * (v + kick * load / M);
      b.increment[3 * n + 2] = dt * wall;
    }
    if (given) p.increment_a = a.increment, p.increment_b = b.increment, p.force_a = NULL;
    must(ct_contact_step, contact, &p);
    off = worst(off, lift(contact) - want);
    top = fmax(top, want);
    v += kick * (load + want) / M;
    g += dt * (v - wall);
    for (int n = 0; n < 4; n++) {
      a.v[3 * n + 2] = v;
      a.x[3 * n + 2] += dt * v;
      b.x[3 * n + 2] += dt * wall;
    }
    last = dt;
  }
  tap_ok(top > 1.0 && off < 1e-12 * top,
         "six steps of unlike lengths over a wall with the velocity %g, increments %s: by hand, "
         "off by %.1e",
         wall, given ? "given" : "computed", off / top);
}

/* A refused call changes nothing: the next call gives the force of a contact without that call. */
static void refusals(void)
{
  face a = face_at(-0.01, 2.0, UP), b = face_at(0.0, 0.0, DOWN);
  ct_contact *contact = open_faces(&a, &b, plain()), *other = open_faces(&a, &b, plain());
  ct_contact_prediction p = prediction_of(&a, &b, 0.01, 0.01), q = p;
  ct_contact_balance balance;
  ct_error e;
  tap_ok(ct_contact_balance_of(contact, &balance, NULL) == CT_ERROR_ARGUMENT,
         "no balance before the first step");
  tap_ok(ct_contact_step(NULL, &p, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_step(contact, NULL, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_balance_of(contact, NULL, NULL) == CT_ERROR_ARGUMENT,
         "null pointers are refused");
  q.velocity_b = NULL;
  tap_ok(ct_contact_step(contact, &q, &e) == CT_ERROR_ARGUMENT && e.body == 1 &&
             strstr(e.text, "velocities of surface 1") != NULL,
         "a missing array: %s", e.text);
  for (int k = 0; k < 4; k++) {
    static const double bad[] = {0.0, -1.0, NAN, INFINITY};
    q = prediction_of(&a, &b, bad[k], 0.01);
    ct_status status = ct_contact_step(contact, &q, &e);
    q = prediction_of(&a, &b, 0.01, bad[k]);
    tap_ok(status == CT_ERROR_ARGUMENT && ct_contact_step(contact, &q, &e) == CT_ERROR_ARGUMENT,
           "times of %g: %s", bad[k], e.text);
  }
  for (int i = 0; i < 3; i++) {
    double keep = b.x[5];
    b.x[5] = NAN;
    tap_ok(ct_contact_step(contact, &p, &e) == CT_INVALID && e.body == 1 && e.point == 1,
           "step %d: NaN is refused by surface and node: %s", i, e.text);
    b.x[5] = keep;
    must(ct_contact_step, contact, &p);
    must(ct_contact_step, other, &p);
    tap_ok(lift(contact) == lift(other) && lift(contact) > 0.1,
           "and the next call is not affected");
    for (int n = 0; n < 4; n++) a.v[3 * n + 2] += 0.01 * 2.0 * lift(contact) / 4;
    for (int n = 0; n < 4; n++) a.x[3 * n + 2] += 0.01 * a.v[3 * n + 2];
  }
  ct_contact_options options = plain();
  options.initial_penetration = CT_INITIAL_REFUSE;
  face c = face_at(-0.01, 2.0, UP);
  contact = open_faces(&c, &b, options);
  p = prediction_of(&c, &b, 0.01, 0.005);
  tap_ok(ct_contact_step(contact, &p, &e) == CT_ERROR_GEOMETRY, "an overlap is refused: %s",
         e.text);
  options.initial_penetration = CT_INITIAL_KEEP;
  contact = open_faces(&c, &b, options);
  must(ct_contact_update, contact, c.x, b.x);
  must(ct_contact_step, contact, &p);
  tap_ok(lift(contact) == 0.0, "or kept, also after an update, without force");
  for (int n = 0; n < 4; n++) c.v[3 * n + 2] = -1000.0, c.x[3 * n + 2] -= 10.0;
  tap_ok(ct_contact_step(contact, &p, &e) == CT_ERROR_ARGUMENT && strstr(e.text, "not 0.005"),
         "half a kick in the second step: %s", e.text);
  p.force_time = 0.01;
  tap_ok(ct_contact_step(contact, &p, &e) == CT_ERROR_STEP, "a leap: %s", e.text);
}

static ct_obstacle_def floor_below(void)
{
  ct_obstacle_def wall = ct_obstacle_def_default();
  wall.axis[2] = 1.0, wall.epsilon = 50.0, wall.restitution = 0.0;
  wall.initial_penetration = CT_INITIAL_FORCE;
  return wall;
}

/* Coordinates that move inside without a velocity make no force, and no energy (eq:admitted); with
 * the velocity of that motion they do. */
static void moved_inside(double velocity)
{
  face a = face_at(0.01, 2.0, UP), b = face_at(0.0, 0.0, DOWN);
  ct_contact *contact = open_faces(&a, &b, plain());
  for (int i = 0; i < 2; i++) {
    ct_contact_prediction p = prediction_of(&a, &b, 0.01, 0.01);
    for (int n = 0; n < 4; n++) a.v[3 * n + 2] = velocity, a.x[3 * n + 2] -= i == 0 ? 0.0 : 0.02;
    must(ct_contact_step, contact, &p);
  }
  const double energy = ct_contact_energy(contact), force = lift(contact);
  tap_ok(velocity == 0.0 ? force == 0.0 && energy == 0.0 : force > 0.1 && energy > 0.0,
         "0.02 further inside with the velocity %g: force %g, energy %g", velocity, force, energy);
}

/* Whether a text names a member and its value. */
static int names(const ct_error *e, const char *member, double value)
{
  char end[32];
  snprintf(end, sizeof end, "%g", value);
  return strstr(e->text, member) != NULL && strstr(e->text, end) != NULL;
}

/* Numbers in the arrays of a step, and in those of an update, that are refused with their array,
 * node and value; the surface meets a plane. */
static void refused_arrays(void)
{
  static const char *const WHAT[] = {"coordinate", "velocity", "inverse mass", "force",
                                     "increment"};
  static const double BAD[] = {NAN, INFINITY, -INFINITY, -2.0};
  face a = face_at(0.01, 2.0, UP);
  double *const array[] = {a.x, a.v, a.inverse_mass, a.f, a.increment};
  ct_contact_options options = plain();
  ct_obstacle_def wall = ct_obstacle_def_default();
  ct_contact *contact = NULL;
  ct_error e;
  a.surface.reference = a.x;
  must(ct_contact_create, &a.surface, NULL, &options, &contact);
  later_contact(contact);
  wall.axis[2] = 1.0, wall.epsilon = 50.0, wall.travel_time = 0.1;
  must(ct_contact_add_obstacle, contact, 0, &wall);
  for (int i = 0; i < 20; i++) {
    const int k = i / 4;
    const double keep = array[k][7], bad = BAD[i % 4];
    ct_contact_prediction p = prediction_of(&a, &a, 0.01, 0.01);
    if (k == 4) p.increment_a = a.increment, p.force_a = NULL;
    array[k][7] = bad;
    ct_status status = ct_contact_step(contact, &p, &e);
    const int fine = isfinite(bad) && k != 2;
    tap_ok(fine ? status == CT_OK
                : status == CT_INVALID && e.body == 0 && e.point == 2 && names(&e, WHAT[k], bad) &&
                      strstr(e.text, "node 2 ") != NULL,
           "%s %g: %s", WHAT[k], bad, fine ? "taken" : e.text);
    if (k == 0 && !fine)
      tap_ok(ct_contact_update(contact, a.x, NULL, &e) == CT_INVALID && names(&e, WHAT[k], bad),
             "and by an update: %s", e.text);
    array[k][7] = keep;
  }
}

/* Numbers of contacts, obstacles and friction that are refused. */
static void refused_numbers(void)
{
  static const double BAD[] = {0.0, -0.3, NAN, INFINITY};
  face a = face_at(-0.01, 2.0, UP), b = face_at(0.0, 0.0, DOWN);
  ct_contact *contact = open_faces(&a, &b, plain());
  ct_obstacle_def wall = floor_below();
  ct_error e;
  for (int k = 0; k < 4; k++) {
    tap_ok(ct_contact_add_friction(contact, -1, BAD[k], 1.0, &e) == CT_ERROR_ARGUMENT &&
               ct_contact_add_friction(contact, -1, 0.3, BAD[k], &e) == CT_ERROR_ARGUMENT,
           "friction: %s", e.text);
    ct_obstacle_def wrong = wall;
    wrong.epsilon = BAD[k];
    tap_ok(ct_contact_add_obstacle(contact, 0, &wrong, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
    wrong = wall, wrong.shape = CT_OBSTACLE_SPHERE, wrong.radius = BAD[k];
    tap_ok(ct_contact_add_obstacle(contact, 0, &wrong, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
    wrong = wall, wrong.velocity[1] = BAD[k];
    ct_contact *other = open_faces(&a, &b, plain());
    ct_status status = ct_contact_add_obstacle(other, 0, &wrong, &e);
    tap_ok(status == (isfinite(BAD[k]) ? CT_OK : CT_INVALID), "a velocity of %g: %s", BAD[k],
           status == CT_OK ? "" : e.text);
    for (int removal = 0; removal < 2; removal++) {
      const char *name = removal ? "removal_time" : "travel_time";
      ct_contact_options options = plain();
      ct_contact *made = NULL;
      wrong = wall;
      if (removal) {
        options.initial_penetration = wrong.initial_penetration = CT_INITIAL_REMOVE;
        options.removal_time = wrong.removal_time = BAD[k];
      } else options.travel_time = wrong.travel_time = BAD[k];
      status = ct_contact_add_obstacle(other, 0, &wrong, &e);
      const int told = names(&e, name, BAD[k]), fine = !removal && BAD[k] == 0.0;
      tap_ok(fine ? status == CT_OK
                  : status == CT_ERROR_ARGUMENT && told &&
                        ct_contact_create(&a.surface, &b.surface, &options, &made, &e) == status &&
                        names(&e, name, BAD[k]),
             "%s %g: %s", name, BAD[k], fine ? "none" : e.text);
      ct_contact_free(made);
    }
  }
}

/* Obstacles and friction that are refused. */
static void refused_parts(void)
{
  face a = face_at(-0.01, 2.0, UP), b = face_at(0.0, 0.0, DOWN);
  ct_contact *contact = open_faces(&a, &b, plain()), *alone = NULL;
  ct_contact_options options = plain();
  ct_obstacle_def wall = floor_below(), none = {0};
  ct_error e;
  double force[3], work;
  must(ct_contact_create, &a.surface, NULL, &options, &alone);
  later_contact(alone);
  const int32_t carrier = 7;
  wall.carrier = &carrier;
  tap_ok(ct_contact_add_obstacle(contact, 0, &wall, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "body 7") != NULL && strstr(e.text, "carr") != NULL,
         "a host has no bodies that carry obstacles: %s", e.text);
  wall.carrier = NULL;
  wall.shape = (ct_obstacle_shape)3;
  tap_ok(ct_contact_add_obstacle(contact, 0, &wall, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  wall.shape = CT_OBSTACLE_PLANE;
  tap_ok(ct_contact_add_obstacle(contact, 0, &none, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  tap_ok(ct_contact_add_obstacle(contact, 2, &wall, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_obstacle(contact, -1, &wall, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_obstacle(alone, 1, &wall, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_obstacle(contact, 0, NULL, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_obstacle(NULL, 0, &wall, &e) == CT_ERROR_ARGUMENT,
         "unknown surfaces: %s", e.text);
  tap_ok(strstr(e.text, "ct_contact_add_obstacle:") == e.text &&
             ct_contact_add_friction(NULL, -1, 0.3, 1.0, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "ct_contact_add_friction:") == e.text &&
             ct_contact_set_pieces(NULL, NULL, NULL, NULL, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "ct_contact_set_pieces:") == e.text,
         "a null contact is told by the function that was called: %s", e.text);
  tap_ok(ct_contact_add_friction(alone, -1, 0.3, 1.0, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_friction(contact, 0, 0.3, 1.0, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_friction(contact, -2, 0.3, 1.0, &e) == CT_ERROR_ARGUMENT &&
             strstr(e.text, "at -2; give the number of an obstacle, or -1"),
         "friction without a contact: %s", e.text);
  must(ct_contact_add_obstacle, contact, 0, &wall);
  must(ct_contact_add_friction, contact, 0, 0.3, 1.0);
  tap_ok(ct_contact_add_friction(contact, 0, 0.3, 1.0, &e) == CT_ERROR_ARGUMENT, "%s", e.text);
  tap_ok(ct_contact_reaction(contact, 0, force, &work, NULL) == CT_ERROR_ARGUMENT,
         "no reaction before the first step");
  ct_contact_prediction p = prediction_of(&a, &b, 0.01, 0.005);
  must(ct_contact_step, contact, &p);
  tap_ok(ct_contact_reaction(contact, 1, force, &work, NULL) == CT_ERROR_ARGUMENT &&
             ct_contact_reaction(contact, 0, NULL, &work, NULL) == CT_ERROR_ARGUMENT &&
             ct_contact_reaction(contact, 0, force, &work, NULL) == CT_OK && force[2] < 0.0,
         "and none of another obstacle");
  tap_ok(ct_contact_add_obstacle(contact, 0, &wall, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_add_friction(contact, -1, 0.3, 1.0, &e) == CT_ERROR_ARGUMENT,
         "%s", e.text);
}

/* Saved numbers that are refused. */
static void refused_memory(void)
{
  face a = face_at(-0.01, 2.0, UP), b = face_at(0.0, 0.0, DOWN);
  ct_contact *contact = open_faces(&a, &b, plain());
  ct_obstacle_def wall = floor_below();
  ct_error e;
  double memory[400];
  must(ct_contact_add_obstacle, contact, 0, &wall);
  must(ct_contact_add_friction, contact, 0, 0.3, 1.0);
  ct_contact_prediction p = prediction_of(&a, &b, 0.01, 0.005);
  must(ct_contact_step, contact, &p);
  const int64_t count = ct_contact_save(contact, memory);
  double at = lift(contact);
  int refused = 0, allowed = 0;
  for (int64_t i = 0; i < count; i++) {
    double keep = memory[i];
    memory[i] = NAN;
    if (ct_contact_restore(contact, memory, count, &e) == CT_INVALID) refused++;
    else allowed++;
    memory[i] = keep;
  }
  tap_ok(count < 400 && refused == count - 12 && allowed == 12,
         "NaN in %d of %d saved numbers is refused, except in distances of points: %s", refused,
         (int)count, e.text);
  tap_ok(ct_contact_restore(contact, memory, count - 1, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_restore(contact, NULL, count, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_restore(NULL, memory, count, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_save(NULL, memory) == 0,
         "another count of numbers: %s", e.text);
  must(ct_contact_restore, contact, memory, count);
  tap_ok(at > 0.0 &&
             ct_contact_balance_of(contact, &(ct_contact_balance){0}, NULL) == CT_ERROR_ARGUMENT,
         "after a restart there is no balance before the next step");
}

/* Nothing is allocated after the first call; one that fails for lack of memory can be repeated. */
static void memory(void)
{
  face a = face_at(0.05, 2.0, UP), b = face_at(0.0, 0.0, DOWN);
  ct_error e;
  ct_contact *contact = open_faces(&a, &b, plain());
  ct_obstacle_def wall = floor_below();
  for (int k = 0; k < 3; k++)
    for (int spare = 0; spare < 1000; spare++) {
      counted.last_call = counted.calls + spare;
      ct_status status = k == 0 ? ct_contact_add_obstacle(contact, 0, &wall, &e)
                                : ct_contact_add_friction(contact, k - 2, 0.3, 1.0, &e);
      if (status == CT_OK) break;
      if (status != CT_ERROR_MEMORY) need(status, &e);
    }
  counted.last_call = -1;
  ct_contact_prediction p = prediction_of(&a, &b, 0.01, 0.01);
  int failed = 0;
  for (;; failed++) {
    counted.last_call = counted.calls + failed;
    ct_status status = ct_contact_step(contact, &p, &e);
    counted.last_call = -1;
    if (status == CT_OK) break;
    if (status != CT_ERROR_MEMORY) failed = -1000;
  }
  tap_ok(failed > 20, "the first step fails %d times for lack of memory, and then succeeds",
         failed);
  long calls = counted.calls;
  for (int i = 0; i < 20; i++) {
    for (int n = 0; n < 4; n++) a.x[3 * n + 2] -= 0.005;
    must(ct_contact_step, contact, &p);
  }
  tap_ok(counted.calls == calls && lift(contact) > 0.0, "20 further steps allocate nothing");
}

/* Friction and obstacles, by the default law and by the explicit penalty. */
static void with_parts(void)
{
  for (int explicit_one = 0; explicit_one < 2; explicit_one++) {
    struct {
      pair p;
      const char *name;
      double end;
    } list[] = {
        {rubbing(rods(0.0), 0.3), "rods with friction", 0.9},
        {rubbing(plates(0.05), 0.3), "plates with friction", 2e-6},
        {rubbing(strip(), 0.3), "strip with friction", 0.1},
        {rubbing(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), 0.3), "blocks with friction", 0.2},
        {rubbing(blocks(CT_HEX8, CT_HEX20, 0.005, 0.3), 0.3), "unlike blocks with friction", 0.2},
        {thrown(0.01), "a block, a plane and a sphere", 0.2},
        {pierced(), "a block, a plane and a small sphere", 0.2},
        {sunk(CT_INITIAL_KEEP), "a block inside a plane and a sphere", 0.2},
        {squeezed(), "a block, a plane and a cylinder", 0.3},
        {stacked(), "two blocks, a plane and a sphere", 0.1}};
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
      if (explicit_one && i != 3 && i + 1 != sizeof list / sizeof list[0]) {
        continue;
      }
      ct_contact_options options = options_of(&list[i].p, explicit_one ? 1.0 : 40.0);
      if (explicit_one) options.enforcement = CT_ENFORCE_PENALTY;
      options.restitution = 0.0; // at t = 0 a scene does not see the coming motion
      // The forces of the first step, from which those of the next one are iterated, are not alike.
      like_the_scene(list[i].p, list[i].name, options, list[i].end,
                     list[i].p.inside ? 2e-4 : 1e-12);
    }
  }
}

int main(void)
{
  free_at_end();
  ct_set_allocator(&COUNTING, NULL);
  pair o = rods(-0.01), w = rods(0.01), t = rods(0.05);
  pair r = rods(0.0), q = plates(0.05), b = blocks(CT_HEX8, CT_HEX20, 0.005, 0.3), s = strip(),
       c = blocks(CT_HEX20, CT_HEX8, 0.005, 0.3);
  like_the_scene(r, "rods", options_of(&r, 10.0), 0.9, 0.0);
  like_the_scene(q, "plates", options_of(&q, 40.0), 2e-6, 0.0);
  like_the_scene(s, "strip", options_of(&s, 4.0), 0.2, 0.0);
  like_the_scene(b, "hex8 on hex20", options_of(&b, 40.0), 0.2, 0.0);
  like_the_scene(c, "hex20 on hex8", options_of(&c, 4.0), 0.2, 0.0);
  ct_contact_options removed = options_of(&o, 10.0), penalty = options_of(&t, 1.0);
  removed.initial_penetration = CT_INITIAL_REMOVE, removed.removal_time = 0.3;
  removed.restitution = 0.0; // at t = 0 a scene does not see the coming motion
  like_the_scene(o, "an overlap that is removed", removed, 0.9, 1e-12);
  removed.adjust = 0.02;
  like_the_scene(w, "a gap that is closed and removed", removed, 0.9, 1e-12);
  penalty.enforcement = CT_ENFORCE_PENALTY;
  like_the_scene(t, "explicit penalty", penalty, 0.9, 0.0);
  with_parts();
  never_grows(rods(0.05), "rods", 1.5, 1e-12, 0.9);
  never_grows(plates(0.05), "plates", 6e-6, 1e-12, 0.9);
  never_grows(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), "blocks", 0.3, 1e-12, 0.9);
  never_grows(blocks(CT_HEX20, CT_HEX8, 0.005, 0.3), "blocks of hex20 on hex8", 0.3, 1e-12, 0.9);
  never_grows(blocks(CT_HEX8, CT_HEX8, 0.02, 6.0), "sliding blocks", 0.3, 2e-3, 0.5);
  never_grows(strip(), "strip", 0.3, 2e-3, 0.9);
  never_grows(rubbing(rods(0.05), 0.3), "rods with friction", 0.9, 1e-12, 0.9);
  never_grows(rubbing(plates(0.05), 0.3), "plates with friction", 4e-6, 1e-12, 0.9);
  never_grows(rubbing(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), 0.3), "blocks with friction", 0.12,
              1e-12, 0.5);
  never_grows(rubbing(blocks(CT_HEX20, CT_HEX8, 0.005, 0.3), 0.3), "unlike blocks with friction",
              0.08, 1e-12, 0.5);
  never_grows(thrown(0.01), "a block, a plane and a sphere", 0.12, 1e-12, -1.0);
  never_grows(sunk(CT_INITIAL_KEEP), "a block in a plane and a sphere", 0.12, 1e-12, -1.0);
  never_grows(sunk(CT_INITIAL_REMOVE), "a block inside a plane and a sphere", 0.12, 2e-3, -1.0);
  never_grows(squeezed(), "a block, a plane and a cylinder", 0.2, 1e-12, -1.0);
  never_grows(stacked(), "two blocks, a plane and a sphere", 0.06, 1e-12, -1.0);
  restart(stacked(), "two blocks, a plane and a sphere", CT_ENFORCE_ENERGY_CONTROLLED);
  restart(thrown(0.0), "a block, a plane and a sphere", CT_ENFORCE_PENALTY);
  restart(pierced(), "a block, a plane and a small sphere", CT_ENFORCE_ENERGY_CONTROLLED);
  restart(sunk(CT_INITIAL_REMOVE), "a block inside a plane and a sphere",
          CT_ENFORCE_ENERGY_CONTROLLED);
  restart(squeezed(), "a block, a plane and a cylinder", CT_ENFORCE_ENERGY_CONTROLLED);
  restart(rubbing(strip(), 0.3), "strip", CT_ENFORCE_ENERGY_CONTROLLED);
  restart(blocks(CT_HEX20, CT_HEX8, -0.01, 0.3), "an overlap", CT_ENFORCE_ENERGY_CONTROLLED);
  for (int given = 0; given < 2; given++) {
    steps_by_hand(0.0, given);
    steps_by_hand(0.5, given);
  }
  refusals();
  moved_inside(0.0);
  moved_inside(-2.0);
  refused_arrays();
  refused_numbers();
  refused_parts();
  refused_memory();
  memory();
  return tap_done();
}
