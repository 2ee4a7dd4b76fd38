/* Friction: the law of one patch, a block on an incline, momentum, rotation, mirror images, work,
 * the bound on the step. */
#include "../../libcontact/src/constraint/tangent_iterate.c"
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
                           double beta, double vx, double pull, double period)
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
  t.problem = build(t.scene, (ct_scene_time){.end = 1.0, .fraction = 0.4}, NULL, &t.stable);
  t.state = new_state(t.problem);
  return t;
}

/* Sum of one effect's force on the block. */
static void force_on_block(incline *t, int32_t effect, double sum[3])
{
  double *f = numbers(3 * (int64_t)t->problem->node_count);
  must(ct_state_force, t->problem, t->state, effect, f);
  sum[0] = sum[1] = sum[2] = 0.0;
  for (int32_t n = t->slab->node_count; n < t->problem->node_count; n++)
    for (int c = 0; c < 3; c++) sum[c] += f[3 * n + c];
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

/* Below the angle of friction: a pull that grows and decays moves the lower face by the elastic
 * slip and no further, and it returns. (eq:slip-residual) */
static void sticks(ct_brick_kind kind, const char *name)
{
  const double g[3] = {0.0, 0.0, -10.0}, beta = 1.0, rho = 0.5;
  incline t = new_incline(kind, g, 0.6, rho, beta, 0.0, 0.6, 3.0);
  double slip = 0.0, overlap = 0.0, held, lost, most = 0.0;
  while (t.state->time < 3.0) {
    advance(t.problem, t.state, 20);
    must(ct_friction_energy, t.problem, t.state, t.friction, &held, &lost);
    most = fmax(most, held);
    if (sole(&t, 0) > slip) slip = sole(&t, 0), overlap = -t.block->nodes[2] - sole(&t, 2);
  }
  // Tangential force over normal force is rho times slip over overlap. Lightly damped, so that only
  // the pull moves the block.
  tap_close(rho * slip / overlap, 0.06, 0.03 * 0.06,
            "%s, stick: the lower face moves by the elastic slip at the maximum of the pull", name);
  tap_ok(
      fabs(sole(&t, 0)) < 0.02 * slip && lost >= 0.0 && lost < 3.0 * most,
      "%s, stick: it returns to %.2g of the slip; the dashpot takes %.2g of what friction stores",
      name, sole(&t, 0) / slip, lost / most);
}

/* Above it: a uniform acceleration g (sin a - mu cos a), over many borders of the slab's faces.
 * (eq:slip-set, eq:friction-turn) */
static void slides(ct_brick_kind kind, double tolerance, const char *name)
{
  const double mu = 0.3, g[3] = {6.0, 0.0, -8.0}; // tan a = 0.75
  incline t = new_incline(kind, g, mu, 1.0, 1.0, 1.0, 0.0, 0.0);
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
}

/* The ledger of a block that is thrown along the slab and comes to rest. (eq:friction-dissipation,
 * eq:slip-held)
 */
static void ledger(void)
{
  const double g[3] = {0.0, 0.0, -10.0};
  incline t = new_incline(CT_HEX8, g, 0.4, 1.0, 1.0, 2.0, 0.0, 0.0);
  double start = energy_of(t.problem, t.state).kinetic, balance = 0.0, held, lost, work,
         share = 0.0, before = 0.0;
  int falls = 0;
  for (int k = 0; k < 40; k++) {
    while (t.state->time < 0.025 * (k + 1)) advance(t.problem, t.state, 1);
    balance = worst(balance, energy_of(t.problem, t.state).balance / start);
    must(ct_energy_work, t.problem, t.state, t.friction, &work);
    must(ct_friction_energy, t.problem, t.state, t.friction, &held, &lost);
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
}

/* Two free bodies, one turning and sliding on the other: momentum and moment of momentum of the
 * friction forces. (eq:slip-row, eq:friction-components) */
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
  ct_scene_contact contact = scene_contact(0, fa, ct_mesh_plane_faces(flat, 2, 0.0, fa, NULL), 1,
                                           fb, ct_mesh_plane_faces(b, 2, -0.02, fb, NULL));
  contact.beta = 1.0, contact.friction = 0.5;
  contact.options.enforcement = CT_ENFORCE_PENALTY;
  contact.options.initial_penetration = CT_INITIAL_FORCE;
  must(ct_scene_add_contact, scene, &contact);
  const ct_problem *p = build_until(scene, 1.0, 0.3);
  ct_state *state = new_state(p);
  double linear = 0.0, angular = 0.0, *f = numbers(3 * (int64_t)p->node_count);
  int met = 0;
  for (int k = 0; k < 20; k++) {
    advance(p, state, 1);
    must(ct_state_force, p, state, 2, f);
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
}

/* Two blocks that are pressed together: the upper one is driven, the lower one is free or stands on
 * a support. */
typedef struct pressed {
  ct_mesh *a, *b;
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
} pressed;

static ct_contact_rule rule = CT_POINTS_GAUSS;

static pressed new_pressed(double mu, double skew, int axis, ct_enforcement law)
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
    *mesh[k] = image;
  }
  t.scene = new_scene();
  add_body(t.scene, "a", t.a, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(t.scene, "b", t.b, &SOFT, CT_KERNEL_AUTO, axis == 0 ? -2.0 : 2.0, axis == 1 ? 1.0 : -1.0,
           -0.5);
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = law;
  options.initial_penetration = CT_INITIAL_FORCE;
  options.points = rule;
  add_contact_with(t.scene, 0, t.a, 0.0, 1, t.b, -0.01, 2, 1.0, options, mu, 1.0);
  t.problem = build_until(t.scene, 1.0, 0.7);
  t.state = new_state(t.problem);
  return t;
}

/* Mirrored scenes have mirrored bits. */
static void mirrored(ct_enforcement law, ct_contact_rule points)
{
  rule = points;
  for (int axis = 0; axis < 2; axis++) {
    pressed t = new_pressed(0.5, 0.1, -1, law), m = new_pressed(0.5, 0.1, axis, law);
    int64_t faults = 0;
    for (int i = 0; i < 30; i++) {
      advance(t.problem, t.state, 1);
      advance(m.problem, m.state, 1);
      faults += mirror_faults(t.state->velocity, m.state->velocity, t.problem->node_count, axis);
    }
    tap_ok(faults == 0, "mirrored along %c, rule %d: mirrored bits (%d off)", "xy"[axis],
           (int)points, (int)faults);
  }
  rule = CT_POINTS_GAUSS;
}

/* The step is that of the scene without friction. */
static void step_of_friction(void)
{
  pressed rough = new_pressed(0.5, 0.0, -1, CT_ENFORCE_ENERGY_CONTROLLED),
          smooth = new_pressed(0.0, 0.0, -1, CT_ENFORCE_ENERGY_CONTROLLED);
  tap_ok(rough.problem->dt == smooth.problem->dt,
         "friction leaves the stable step as it is (%g, %g)", rough.problem->dt,
         smooth.problem->dt);
}

static void refusals(void)
{
  pressed t = new_pressed(0.5, 0.0, -1, CT_ENFORCE_PENALTY);
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
  pressed smooth = new_pressed(0.0, 0.0, -1, CT_ENFORCE_PENALTY);
  tap_ok(smooth.problem->effect_count == 2, "without a coefficient there is no effect of friction");
}

/* Without bounds, the steps divide the error of one eigenvalue by the polynomial of Chebyshev that
 * has the bounds of all: T_k(z) / T_k(z_0), z = (θ - x) / δ. (eq:slip-chebyshev) */
static void chebyshev(void)
{
  double off = 0.0;
  for (double l = 0.1; l < 1.0; l += 0.2)
    for (double x = l; x <= 1.0; x += 0.05) {
      const ct_tangent t = {.lowest = l};
      const double scale = 1.0, z = (0.5 * (1.0 + l) - x) / (0.5 * (1.0 - l)),
                   z0 = (1.0 + l) / (1.0 - l);
      double rho = 0.0, T = 1.0, T0 = 0.0, slip0 = 0.0, aim;
      for (int k = 0; k < 20; k++) {
        const double slip = x * T, exact = cos((k + 1) * acos(fmax(z, -1.0)));
        aim_at(1, step_of(&t, k, &rho), &T, &slip, &scale, &T0, &slip0, &aim);
        T = aim;
        off = fmax(off, fabs(T - exact / cosh((k + 1) * acosh(z0))));
      }
    }
  tap_ok(off < 1e-12, "steps have the polynomials of Chebyshev, to %.0e", off);
}

/* Where one factor tells what the forces do, the iteration begins with the solution of
 * (w + C) T + q = 0; w is 0 to D - C, and this at a new point. (eq:slip-start) */
static void start(void)
{
  const double w[4] = {0.7, 2.0, -1.0, 0.3}, want[4] = {0.7, 1.5, 0.0, 1.5}, C = 0.25;
  double off = 0.0, T[3], q[3], image[3], aim[3];
  for (int k = 0; k < 4; k++) {
    double scale = 1.0 / (1.5 + C), c = C;
    ct_tangent t = {.count = 1, .C = &c, .scale = &scale};
    for (int i = 0; i < 3; i++) {
      T[i] = k == 3 ? 0.0 : 1.0 + i, q[i] = 0.5 - 0.7 * i, image[i] = w[k] * T[i];
      t.T.x[i] = &T[i], t.q.x[i] = &q[i], t.was_image.x[i] = &image[i], t.aim.x[i] = &aim[i];
    }
    start_at(&t);
    for (int i = 0; i < 3; i++)
      off = fmax(off, fabs((image[i] + want[k] * (aim[i] - T[i])) + C * aim[i] + q[i]));
  }
  tap_ok(off < 1e-14, "the iteration begins where one factor leads, to %.0e", off);
}

int main(void)
{
  free_at_end();
  chebyshev();
  start();
  sticks(CT_HEX8, "hex8");
  slides(CT_HEX8, 1e-3, "hex8");
  slides(CT_HEX20, 0.1, "hex20");
  ledger();
  momentum(CT_HEX8, "Q4");
  momentum(CT_HEX20, "Q8");
  mirrored(CT_ENFORCE_ENERGY_CONTROLLED, CT_POINTS_GAUSS);
  mirrored(CT_ENFORCE_ENERGY_CONTROLLED, CT_POINTS_LOBATTO);
  mirrored(CT_ENFORCE_PENALTY, CT_POINTS_GAUSS);
  step_of_friction();
  refusals();
  return tap_done();
}
