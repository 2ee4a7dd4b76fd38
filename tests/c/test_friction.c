/* Friction: the law of one patch, a block on an incline, momentum, rotation, mirror images, work,
 * restarts, the bound on the step. */
#include "../../libcontact/src/effect/contact.h"
#include "bodies.h"

static const ct_material SOFT = {.young = 4000.0, .poisson = 0.0, .density = 1.0};

/* A block of 1 x 1 x 0.4 with its lower face on z = -sink over a wide slab at rest. */
typedef struct incline {
  ct_mesh *slab, *block;
  ct_scene *scene;
  const ct_problem *problem;
  ct_stable_step stable;
  ct_state *state;
  int32_t friction; /* number of the friction effect */
} incline;

static incline new_incline(ct_brick_kind kind, const double g[3], double mu, double rho,
                           double beta, double vx, double pull, double period, int threads)
{
  incline t = {.slab = box_mesh(kind, -1, -1, -0.5, 6, 3, 0.5, 13, 4, 1), .friction = 2};
  double sink = -g[2] / (beta * SOFT.young / (kind == CT_HEX8 ? 1.0 / 3.0 : 0.4)) * 0.4;
  t.block = box_mesh(kind, 0, 0, -sink, 1, 1, 0.4, kind == CT_HEX8 ? 3 : 2, 2, 1);
  t.scene = new_scene();
  add_body(t.scene, "slab", t.slab, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(t.scene, "block", t.block, &SOFT, CT_KERNEL_AUTO, vx, 0, 0);
  add_support(t.scene, 0, t.slab, -1, 0.0, "xyz", 0.0);
  add_rough_contact(t.scene, 0, t.slab, 0.0, 1, t.block, -sink, 2, beta, mu, rho);
  add_weight(t.scene, (weight){.first = t.slab->node_count,
                               .g = {g[0], g[1], g[2]},
                               .damping = pull > 0.0 ? 10.0 : 0.0,
                               .pull = pull,
                               .period = period});
  set_threads(t.scene, threads);
  t.problem = build(t.scene, (ct_scene_time){.end = 1.0, .fraction = 0.4}, NULL, &t.stable);
  t.state = new_state(t.problem);
  return t;
}

static void free_incline(incline *t)
{
  close_run(t->state, t->scene, t->slab);
  ct_mesh_free(t->block);
}

/* Sum of one effect's force on the block. */
static void force_on_block(incline *t, int32_t effect, double sum[3])
{
  ct_error error;
  double *f = numbers(3 * (int64_t)t->problem->node_count);
  need(ct_state_force(t->problem, t->state, effect, f, &error), &error);
  sum[0] = sum[1] = sum[2] = 0.0;
  for (int32_t n = t->slab->node_count; n < t->problem->node_count; n++)
    for (int c = 0; c < 3; c++) sum[c] += f[3 * n + c];
  free(f);
}

/* Mean displacement along x or z of the block's lower face, each node weighted by its area. */
static double sole(const incline *t, int c)
{
  double sum = 0.0, area = 0.0, low = t->block->nodes[2];
  for (int32_t n = 0; n < t->block->node_count; n++) {
    const double *X = &t->block->nodes[3 * n];
    double share =
        (X[0] == 0.0 || X[0] == 1.0 ? 1.0 : 2.0) * (X[1] == 0.0 || X[1] == 1.0 ? 1.0 : 2.0);
    if (X[2] == low)
      sum += share * t->state->displacement[3 * (t->slab->node_count + n) + c], area += share;
  }
  return sum / area;
}

/* eq:friction-return. */
static void the_return(void)
{
  double s[3] = {3.0, 0.0, 4.0}, small[3] = {0.3, 0.0, 0.4};
  tap_close(ct_friction_return(2.0, s), 3.0, 1e-15,
            "a slip of 5 returns to the limit 2 and slides 3");
  tap_ok(fabs(s[0] - 1.2) < 1e-15 && s[1] == 0.0 && fabs(s[2] - 1.6) < 1e-15,
         "its direction stays");
  tap_ok(ct_friction_return(2.0, small) == 0.0 && small[0] == 0.3 && small[2] == 0.4,
         "a slip below the limit sticks and keeps its bits");
}

/* Below the angle of friction: a pull that grows and decays moves the lower face by the elastic
 * slip and no further, and it returns. (eq:friction-law) */
static void sticks(ct_brick_kind kind, const char *name)
{
  const double g[3] = {0.0, 0.0, -10.0}, beta = 1.0, rho = 0.5;
  incline t = new_incline(kind, g, 0.6, rho, beta, 0.0, 0.6, 3.0, 1);
  double slip = 0.0, overlap = 0.0, held, lost;
  ct_error error;
  while (t.state->time < 3.0) {
    advance(t.problem, t.state, 20);
    if (sole(&t, 0) > slip) slip = sole(&t, 0), overlap = -t.block->nodes[2] - sole(&t, 2);
  }
  need(ct_friction_energy(t.problem, t.state, t.friction, &held, &lost, &error), &error);
  // Tangential force over normal force is rho times slip over overlap. Lightly damped, so that only
  // the pull moves the block.
  tap_close(rho * slip / overlap, 0.06, 0.03 * 0.06,
            "%s, stick: the lower face moves by the elastic slip at the maximum of the pull", name);
  tap_ok(fabs(sole(&t, 0)) < 0.02 * slip && lost == 0.0,
         "%s, stick: it returns to %.2g of the slip, and no energy is dissipated (%.2g)", name,
         sole(&t, 0) / slip, lost);
  free_incline(&t);
}

/* Above it: a uniform acceleration g (sin a - mu cos a), over many borders of the slab's faces.
 * (eq:friction-law, eq:friction-components) */
static void slides(ct_brick_kind kind, double tolerance, const char *name)
{
  const double mu = 0.3, g[3] = {6.0, 0.0, -8.0}; // tan a = 0.75
  incline t = new_incline(kind, g, mu, 1.0, 1.0, 1.0, 0.0, 0.0, 1);
  double ratio = 0.0, normal[3], rub[3];
  while (t.state->time < 0.02) advance(t.problem, t.state, 1);
  ct_momentum from = momentum_of(t.problem, t.state, 1);
  while (t.state->time < 0.6) {
    advance(t.problem, t.state, 1);
    force_on_block(&t, 1, normal);
    force_on_block(&t, t.friction, rub);
    ratio = worst(ratio, rub[0] / (mu * normal[2]) + 1.0);
  }
  ct_momentum to = momentum_of(t.problem, t.state, 1);
  double dt = to.time - from.time, gain = to.p[0] - from.p[0], mass = 0.4,
         want = mass * dt * (g[0] + mu * g[2]);
  double way = 0.5 * (from.p[0] + to.p[0]) / mass * dt * 13.0 / 6.0;
  // Newton's second law along the slope and across it together: the friction is mu times the normal
  // force, also at the borders, where points change their face and others come and go. At the ends
  // of the sole the line to the closest point leans a little.
  tap_close(gain, want - mu * (to.p[2] - from.p[2]), 1e-3 * gain,
            "%s, slip: momentum grows by m (g sin a - mu N)", name);
  tap_close(gain / want, 1.0, 0.01,
            "%s, slip: the acceleration is g (sin a - mu cos a) within the block's own swing",
            name);
  tap_ok(ratio < tolerance && way > 1.5,
         "%s, slip: over %.2g borders of the slab's faces friction is mu times the normal force in "
         "every step (%.2g)",
         name, way, ratio);
  free_incline(&t);
}

/* The ledger of a block that is thrown along the slab and comes to rest. (eq:friction-dissipation)
 */
static void ledger(void)
{
  const double g[3] = {0.0, 0.0, -10.0};
  incline t = new_incline(CT_HEX8, g, 0.4, 1.0, 1.0, 2.0, 0.0, 0.0, 1);
  double start = energy_of(t.problem, t.state).kinetic, balance = 0.0, held, lost, work,
         share = 0.0, before = 0.0;
  int falls = 0;
  ct_error error;
  for (int k = 0; k < 40; k++) {
    while (t.state->time < 0.025 * (k + 1)) advance(t.problem, t.state, 1);
    balance = worst(balance, energy_of(t.problem, t.state).balance / start);
    need(ct_energy_work(t.problem, t.state, t.friction, &work, &error), &error);
    need(ct_friction_energy(t.problem, t.state, t.friction, &held, &lost, &error), &error);
    share = worst(share, (work + held + lost) / start);
    falls += lost < before;
    before = lost;
  }
  tap_ok(balance < 1e-12, "work balance %.2g of the kinetic energy", balance);
  tap_ok(
      share < 2e-3 && lost > 0.9 * start,
      "work of friction is minus the stored and dissipated energy, to %.2g; %.3f of the energy is "
      "dissipated",
      share, lost / start);
  tap_ok(falls == 0, "dissipated energy never decreases");
  tap_close(momentum_of(t.problem, t.state, 1).p[0], 0.0, 0.02 * 0.4 * 2.0,
            "the block has come to rest");
  free_incline(&t);
}

/* Two free bodies, one turning and sliding on the other: momentum and moment of momentum of the
 * friction forces. (eq:friction-couple, eq:friction-components, eq:friction-force) */
static void momentum(ct_brick_kind kind, const char *name)
{
  ct_mesh *a = box_mesh(kind, -1, -1, -0.5, 2, 2, 0.5, 3, 3, 1),
          *b = box_mesh(kind, -0.6, -0.5, -0.02, 1, 1.1, 0.6, 2, 2, 1);
  for (int n = 0; n < a->node_count; n++)
    a->nodes[3 * n + 2] += 0.02 * a->nodes[3 * n] * a->nodes[3 * n + 1];
  ct_scene *scene = new_scene();
  int32_t *fa = integers(8 * a->element_count), *fb = integers(8 * b->element_count);
  add_body(scene, "a", a, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "b", b, &SOFT, CT_KERNEL_AUTO, 0.7, -0.4, 0);
  // The top of a is warped; its faces have the numbers of the flat one.
  ct_mesh *flat = box_mesh(kind, -1, -1, -0.5, 2, 2, 0.5, 3, 3, 1);
  ct_scene_contact contact = {.body_a = 0,
                              .body_b = 1,
                              .face_count_a = ct_mesh_plane_faces(flat, 2, 0.0, fa, NULL),
                              .faces_a = fa,
                              .face_count_b = ct_mesh_plane_faces(b, 2, -0.02, fb, NULL),
                              .faces_b = fb,
                              .beta = 1.0,
                              .options = ct_contact_options_default(),
                              .friction = 0.5};
  contact.options.enforcement = CT_ENFORCE_PENALTY;
  contact.options.initial_penetration = CT_INITIAL_FORCE;
  ct_error error;
  need(ct_scene_add_contact(scene, &contact, &error), &error);
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.3}, NULL, NULL);
  ct_state *state = new_state(p);
  double linear = 0.0, angular = 0.0, *f = numbers(3 * (int64_t)p->node_count);
  int met = 0;
  for (int k = 0; k < 20; k++) {
    advance(p, state, 1);
    need(ct_state_force(p, state, 2, f, &error), &error);
    double sum[3] = {0}, moment[3] = {0};
    double size = 0.0;
    for (int n = 0; n < p->node_count; n++) {
      double x[3];
      for (int c = 0; c < 3; c++)
        x[c] = p->reference[3 * n + c] + state->displacement[3 * n + c], sum[c] += f[3 * n + c],
        size += fabs(f[3 * n + c]);
      for (int c = 0; c < 3; c++)
        moment[c] +=
            x[(c + 1) % 3] * f[3 * n + (c + 2) % 3] - x[(c + 2) % 3] * f[3 * n + (c + 1) % 3];
    }
    for (int c = 0; c < 3 && size > 0.0; c++)
      met += c == 0, linear = worst(linear, sum[c] / size),
                     angular = worst(angular, moment[c] / size);
  }
  tap_ok(met > 3 && linear < 1e-14, "%s: friction forces add up to zero (%.2g)", name, linear);
  tap_ok(angular < 1e-14, "%s: and so do their moments (%.2g)", name, angular);
  free(f), free(fa), free(fb);
  close_run(state, scene, a), ct_mesh_free(b), ct_mesh_free(flat);
}

/* Two blocks that are pressed together, as a problem whose forces can be computed at any
 * displacement, with memory. */
typedef struct pressed {
  ct_mesh *a, *b;
  ct_scene *scene;
  const ct_problem *problem;
  probe p;
  double *u, *f;
  int64_t memory;
} pressed;

static pressed new_pressed(double mu, double rho, double skew, int axis)
{
  pressed t = {.a = box_mesh(CT_HEX8, -1, -1, -1, 2, 2, 1, 2, 2, 1),
               .b = box_mesh(CT_HEX8, -0.9, -0.8, -0.01, 1.5, 1.6, 1, 2, 3, 1)};
  ct_mesh **mesh[2] = {&t.a, &t.b};
  for (int k = 0; k < 2; k++) {
    for (int n = 0; n < (*mesh[k])->node_count; n++) {
      double *X = &(*mesh[k])->nodes[3 * n], x = X[0];
      X[0] += skew * sin(3.0 * X[1] + 1.0);
      X[1] += skew * sin(2.0 * x + 0.5);
    }
    if (axis < 0) continue;
    ct_mesh *image = mirror_mesh(*mesh[k], axis);
    ct_mesh_free(*mesh[k]);
    *mesh[k] = image;
  }
  t.scene = new_scene();
  add_body(t.scene, "a", t.a, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(t.scene, "b", t.b, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_rough_contact(t.scene, 0, t.a, 0.0, 1, t.b, -0.01, 2, 1.0, mu, rho);
  t.problem = build(t.scene, (ct_scene_time){.end = 1.0, .fraction = 0.3}, NULL, NULL);
  t.p = probe_open(t.problem);
  t.u = numbers(3 * (int64_t)t.problem->node_count);
  t.f = numbers(3 * (int64_t)t.problem->node_count);
  for (int k = 0; k < t.problem->effect_count; k++) t.memory += t.problem->effects[k]->memory_count;
  return t;
}

/* Forces at t.u; their memory is kept. */
static void go(pressed *t)
{
  probe_force(&t->p, t->u, t->f);
  memcpy(t->p.memory, t->p.next, (size_t)t->memory * sizeof(double));
}

static void free_pressed(pressed *t)
{
  probe_close(&t->p);
  ct_scene_free(t->scene);
  ct_mesh_free(t->a), ct_mesh_free(t->b);
  free(t->u), free(t->f);
}

/* Move the nodes of b by (x, y, 0). */
static void shift(pressed *t, double x, double y)
{
  for (int n = t->a->node_count; n < t->problem->node_count; n++)
    t->u[3 * n] += x, t->u[3 * n + 1] += y;
}

static void pull_of(const pressed *t, double sum[3])
{
  sum[0] = sum[1] = sum[2] = 0.0;
  for (int n = t->a->node_count; n < t->problem->node_count; n++)
    for (int c = 0; c < 3; c++) sum[c] += t->f[3 * n + c];
}

/* Rigid blocks by hand: the slope in stick and the plateau in slip. Points of b have no border
 * near; of the points of a some see b, the rest nothing. (eq:friction-law, eq:friction-trial,
 * eq:friction-force) */
static void patch_law(void)
{
  pressed t = new_pressed(0.5, 0.8, 0.0, -1);
  double before[3], stuck[3], slip[3], turned[3];
  go(&t);
  pull_of(&t, before);
  double normal = before[2], k = normal / 0.01;
  shift(&t, 0.003, 0.0);
  go(&t);
  pull_of(&t, stuck);
  tap_close(stuck[0], -0.8 * k * 0.003, 1e-12 * normal, "stick: the force is rho k times the slip");
  shift(&t, -0.003, 0.0);
  go(&t);
  pull_of(&t, stuck);
  tap_ok(fabs(stuck[0]) < 1e-12 * normal, "stick: back at the start the force is zero again");
  for (int i = 0; i < 10; i++) shift(&t, 0.002, 0.0), go(&t);
  pull_of(&t, slip);
  tap_close(slip[0], -0.5 * normal, 1e-12 * normal,
            "slip: the force stays at mu times the normal force");
  for (int i = 0; i < 60; i++) shift(&t, 0.0, 0.001), go(&t);
  pull_of(&t, turned);
  tap_ok(fabs(turned[1] + 0.5 * turned[2]) < 1e-6 * turned[2] && fabs(turned[0]) < 0.01 * turned[2],
         "slip: the force turns with the motion");
  free_pressed(&t);
}

/* The stored slip rotates with the bodies: forces after a rigid rotation in steps are the rotated
 * forces. (eq:friction-trial) */
static void rotation(void)
{
  pressed t = new_pressed(0.5, 0.8, 0.0, -1);
  int count = t.problem->node_count;
  double *x0 = numbers(3 * count), *f0 = numbers(3 * count), off = 0.0, size = 0.0;
  go(&t);
  shift(&t, 0.004, -0.002);
  go(&t);
  // Without the solid, whose small strains feel a rotation.
  double *solid = numbers(3 * count);
  ct_error error;
  memcpy(x0, t.u, 3 * (size_t)count * sizeof *x0);
  for (int i = 0; i < 3 * count; i++) x0[i] += t.problem->reference[i];
  memcpy(f0, t.f, 3 * (size_t)count * sizeof *f0);
  ct_view view = {.reference = t.problem->reference,
                  .displacement = t.u,
                  .velocity = t.u,
                  .scratch = t.p.scratch[0]};
  need(t.problem->effects[0]->calls->force(t.problem->effects[0], &view, solid, &error), &error);
  for (int i = 0; i < 3 * count; i++) f0[i] -= solid[i], size = fmax(size, fabs(f0[i]));
  for (int step = 1; step <= 5; step++) {
    double a = 0.4 * step, c = cos(a), s = sin(a);
    for (int n = 0; n < count; n++) {
      const double *x = &x0[3 * n];
      double y[3] = {c * x[0] - s * x[2], x[1], s * x[0] + c * x[2]};
      for (int k = 0; k < 3; k++) t.u[3 * n + k] = y[k] - t.problem->reference[3 * n + k];
    }
    go(&t);
    need(t.problem->effects[0]->calls->force(t.problem->effects[0], &view, solid, &error), &error);
    for (int n = 0; n < count; n++) {
      const double *f = &f0[3 * n];
      double want[3] = {c * f[0] - s * f[2], f[1], s * f[0] + c * f[2]};
      for (int k = 0; k < 3; k++) off = worst(off, t.f[3 * n + k] - solid[3 * n + k] - want[k]);
    }
  }
  tap_ok(off < 1e-12 * size,
         "after rotations of 0.4 rad each the stored friction has rotated with the bodies (%.2g)",
         off / size);
  free(x0), free(f0), free(solid);
  free_pressed(&t);
}

static void mirrored(void)
{
  for (int axis = 0; axis < 2; axis++) {
    pressed t = new_pressed(0.5, 0.8, 0.1, -1), m = new_pressed(0.5, 0.8, 0.1, axis);
    int64_t faults = 0;
    for (int i = 0; i < 12; i++) {
      double x = 0.004 * cos(0.7 * i), y = 0.003 * sin(0.9 * i);
      shift(&t, x, y);
      shift(&m, axis == 0 ? -x : x, axis == 1 ? -y : y);
      go(&t);
      go(&m);
      faults += mirror_faults(t.f, m.f, t.problem->node_count, axis);
    }
    tap_ok(faults == 0 && largest(t.f, 3 * t.problem->node_count) > 0.0,
           "mirrored along %c: mirrored bits (%d off)", "xy"[axis], (int)faults);
    free_pressed(&t);
    free_pressed(&m);
  }
}

/* The bound lies above the largest eigenvalue of M⁻¹K of contact and friction in stick, by power
 * iteration. (eq:friction-bound) */
static void bound(double rho)
{
  pressed t = new_pressed(0.5, rho, 0.0, -1);
  int64_t n = 3 * (int64_t)t.problem->node_count;
  double *v = numbers(n), *f0 = numbers(n), quotient = 0.0, shares[2], rate;
  go(&t);
  probe_force(&t.p, t.u, f0);
  for (int64_t i = 0; i < n; i++) v[i] = i % 3 == 2 ? 0.0 : uniform(1.0);
  double *u0 = numbers(n), *solid = numbers(n), *solid0 = numbers(n);
  ct_error error;
  memcpy(u0, t.u, (size_t)n * sizeof *u0);
  ct_view view = {.reference = t.problem->reference,
                  .displacement = t.u,
                  .velocity = t.u,
                  .scratch = t.p.scratch[0]};
  need(t.problem->effects[0]->calls->force(t.problem->effects[0], &view, solid0, &error), &error);
  for (int k = 0; k < 60; k++) {
    double top = largest(v, n), work = 0.0, mass = 0.0;
    for (int64_t i = 0; i < n; i++) t.u[i] = u0[i] + (v[i] *= 1.0 / top) * 1e-6;
    probe_force(&t.p, t.u, t.f);
    need(t.problem->effects[0]->calls->force(t.problem->effects[0], &view, solid, &error), &error);
    for (int64_t i = 0; i < n; i++) {
      double Kv = i % 3 == 2 ? 0.0 : -((t.f[i] - solid[i]) - (f0[i] - solid0[i])) / 1e-6;
      work += v[i] * Kv;
      mass += v[i] * v[i] * t.problem->mass[i / 3];
      v[i] = Kv / t.problem->mass[i / 3];
    }
    quotient = work / mass;
  }
  ct_state *state = new_state(t.problem);
  for (int k = 0; k < 2; k++)
    need(ct_stable_contribution(t.problem, state, 1 + k, &shares[k], &rate, &error), &error);
  double facing = 0.0;
  const ct_contact *contact = ct_state_contact(t.problem, state, 1, &error);
  const ct_masses mass = {t.problem->mass, contact->fixed->nodes};
  need(ct_contact_find_springs(contact, 1, mass, &facing), &error);
  tap_close(shares[1] / facing, fmax(rho, 0.5), 1e-14,
            "rho = %g: its bound is the larger of rho and mu, times that of the facing points",
            rho);
  tap_ok(shares[1] <= fmax(rho, 0.5) * shares[0] * (1.0 + 1e-14),
         "rho = %g: and not above that of all points", rho);
  tap_ok(quotient > 0.3 * shares[1] && quotient <= shares[1],
         "rho = %g: tangential stiffness %.4g is below the bound %.4g, and not far", rho, quotient,
         shares[1]);
  ct_state_free(state);
  free(v), free(f0), free(u0), free(solid), free(solid0);
  free_pressed(&t);
}

/* Two equal cubes of n³ bricks, all outer faces in contact, touching or apart: points of sides and
 * backs do not count, so the bound is that of two flat faces, 2 ε A / m at every node, with m = ρ h
 * A / 2. (eq:friction-facing) */
static void closed_skins(int n, double apart)
{
  ct_mesh *low = box_mesh(CT_HEX8, 0, 0, -1, 1, 1, 1, n, n, n),
          *high = box_mesh(CT_HEX8, 0, 0, apart, 1, 1, 1, n, n, n);
  ct_scene *scene = new_scene_with("low", low, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "high", high, &SOFT, CT_KERNEL_AUTO, 0, 0, -1);
  int32_t outer[2][4 * 6 * 64];
  ct_scene_contact skins = {.body_a = 0,
                            .body_b = 1,
                            .faces_a = outer[0],
                            .faces_b = outer[1],
                            .beta = 1.0,
                            .friction = 0.3,
                            .tangent = 0.1,
                            .options = ct_contact_options_default()};
  skins.face_count_a = ct_mesh_outer_faces(low, outer[0], NULL);
  skins.face_count_b = ct_mesh_outer_faces(high, outer[1], NULL);
  ct_error error;
  need(ct_scene_add_contact(scene, &skins, &error), &error);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.9}, NULL, NULL);
  ct_state *state = new_state(problem);
  double omega2, rate;
  need(ct_stable_contribution(problem, state, 2, &omega2, &rate, &error), &error);
  // ε = E / h, and 2 ε A / m = 4 E / (ρ h²)
  tap_close(omega2 / (0.3 * 4.0 * SOFT.young * n * n), 1.0, 1e-12,
            "two closed cubes of %d bricks a side, %g apart: the bound of their flat faces", n,
            apart);
  close_run(state, scene, low);
  ct_mesh_free(high);
}

/* In stick all points of a block on a slab have ρ times the bound of the contact: a step for which
 * this is too much is refused at the first evaluation, with the node. (eq:friction-room) */
static void too_stiff_for_the_step(void)
{
  const double g[3] = {0.0, 0.0, -10.0}, rho = 0.5;
  for (int k = 0; k < 2; k++) {
    incline t = new_incline(CT_HEX8, g, 0.6, rho, 1.0, 0.0, 0.0, 0.0, 1);
    ct_error error = {0};
    double rate, omega2, part = k == 0 ? 0.999 : 1.001;
    need(ct_stable_contribution(t.problem, t.state, t.friction, &omega2, &rate, &error), &error);
    ct_friction_set_room((ct_effect *)t.problem->effects[t.friction],
                         (ct_friction_room){.bound = part * rho / 0.6 * omega2});
    ct_status status = ct_run(t.problem, t.state, 100, NULL, 0, &error);
    if (k == 0)
      tap_ok(status == CT_ERROR_STEP && error.point >= 0 && strstr(error.text, "at most"),
             "points that are too stiff for the step: %s", error.text);
    else tap_ok(status == CT_OK, "a little less stiff: the step is taken");
    free_incline(&t);
  }
}

/* A restart in the middle of a slide, and two threads, give the same bits. */
static void same_bits(void)
{
  const double g[3] = {6.0, 1.0, -8.0};
  incline t = new_incline(CT_HEX8, g, 0.3, 1.0, 1.0, 0.5, 0.0, 0.0, 1),
          two = new_incline(CT_HEX8, g, 0.3, 1.0, 1.0, 0.5, 0.0, 0.0, 2);
  ct_state *other = new_state(t.problem);
  ct_error error;
  advance(t.problem, t.state, 150);
  need(ct_state_copy(t.problem, t.state, other, &error), &error);
  advance(t.problem, t.state, 150);
  advance(t.problem, other, 150);
  advance(two.problem, two.state, 300);
  size_t bytes = 3 * (size_t)t.problem->node_count * sizeof(double);
  tap_ok(memcmp(t.state->velocity, other->velocity, bytes) == 0 &&
             memcmp(t.state->memory, other->memory, (size_t)other->memory_count * sizeof(double)) ==
                 0,
         "a restart continues with the same bits");
  tap_ok(memcmp(t.state->velocity, two.state->velocity, bytes) == 0,
         "two threads give the same bits");
  ct_state_free(other);
  free_incline(&t);
  free_incline(&two);
}

static void refusals(void)
{
  pressed t = new_pressed(0.5, 1.0, 0.0, -1);
  ct_effect *effect = NULL;
  ct_error error;
  ct_friction_def none = {COOKIE, .tangent = 1.0, .coefficient = 0.3},
                  solid = {COOKIE, .tangent = 1.0, .on = t.problem->effects[0], .coefficient = 0.3},
                  negative = {COOKIE, .tangent = 1.0, .on = t.problem->effects[1],
                              .coefficient = -0.3};
  tap_ok(ct_friction_create_effect(&none, t.problem, &effect, &error) == CT_ERROR_ARGUMENT &&
             strstr(error.text, "add a contact"),
         "friction without contact: %s", error.text);
  tap_ok(ct_friction_create_effect(&solid, t.problem, &effect, &error) == CT_ERROR_ARGUMENT,
         "friction on a solid: %s", error.text);
  tap_ok(ct_friction_create_effect(&negative, t.problem, &effect, &error) == CT_ERROR_ARGUMENT,
         "a negative coefficient: %s", error.text);
  const ct_effect *swapped[3] = {t.problem->effects[0], t.problem->effects[2],
                                 t.problem->effects[1]};
  ct_problem wrong = *t.problem;
  wrong.effects = swapped;
  ct_state *state = NULL;
  tap_ok(ct_state_create(&wrong, &state, &error) == CT_ERROR_ARGUMENT,
         "friction before its contact: %s", error.text);
  free_pressed(&t);
  pressed smooth = new_pressed(0.0, 0.0, 0.0, -1);
  tap_ok(smooth.problem->effect_count == 2, "without a coefficient there is no effect of friction");
  free_pressed(&smooth);
}

int main(void)
{
  the_return();
  patch_law();
  sticks(CT_HEX8, "hex8");
  slides(CT_HEX8, 1e-3, "hex8");
  slides(CT_HEX20, 0.1, "hex20");
  ledger();
  momentum(CT_HEX8, "Q4");
  momentum(CT_HEX20, "Q8");
  rotation();
  mirrored();
  bound(1.0);
  bound(0.5);
  for (int n = 2; n <= 8; n += 3) closed_skins(n, 0.0);
  closed_skins(4, 7.0);
  too_stiff_for_the_step();
  same_bits();
  refusals();
  return tap_done();
}
