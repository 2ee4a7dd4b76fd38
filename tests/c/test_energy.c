/* The balance of energy and momentum on small plates, with and without contact, with equal and
 * different plates. */
#include "bodies.h"

static const ct_material STEEL = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};

/* Half plates of the impact: symmetric planes at z = 0 and, for plane strain, at both faces y. */
static void plane_strain(ct_scene *scene, int32_t body, const ct_mesh *m, double thickness)
{
  add_support(scene, body, m, 2, 0.0, "z", 0.0);
  add_support(scene, body, m, 1, 0.0, "y", 0.0);
  add_support(scene, body, m, 1, thickness, "y", 0.0);
}

/* Change of each conserved quantity in a run, relative to its scale. */
typedef struct ledger {
  double total, balance, impulse, momentum, contact, solid_work, contact_work;
} ledger;

static ledger watch(const ct_problem *p, ct_state *state, int64_t steps, int64_t every)
{
  ledger worst_of = {0};
  ct_energy first = energy_of(p, state), now;
  ct_momentum start[2], m[2];
  double scale = 0.0, work;
  for (int b = 0; b < p->body_count; b++) start[b] = momentum_of(p, state, b);
  for (int n = 0; n < p->node_count; n++) {
    const double *v = &p->initial_velocity[3 * n];
    scale += p->mass[n] * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  for (int64_t done = 0; done < steps; done += every) {
    advance(p, state, every);
    now = energy_of(p, state);
    worst_of.total = worst(worst_of.total, (now.total - first.total) / first.total);
    worst_of.balance = worst(worst_of.balance, now.balance / first.kinetic);
    worst_of.contact = worst(worst_of.contact, now.contact / first.total);
    // For linear forces the work of the solid is minus its stored energy.
    must(ct_energy_work, p, state, 0, &work);
    worst_of.solid_work = worst(worst_of.solid_work, (work + now.strain) / first.total);
    double sum = 0.0, sum_start = 0.0;
    for (int b = 0; b < p->body_count; b++) {
      m[b] = momentum_of(p, state, b);
      for (int c = 0; c < 3; c++)
        worst_of.impulse =
            worst(worst_of.impulse,
                  (m[b].p[c] - start[b].p[c] - m[b].contact_impulse[c] - m[b].support_impulse[c]) /
                      scale);
      sum += m[b].p[0], sum_start += start[b].p[0];
    }
    worst_of.momentum = worst(worst_of.momentum, (sum - sum_start) / scale);
  }
  return worst_of;
}

/* One plate that hits a rigid plane: all forces are linear (eq:work-balance, eq:work-sum). */
static void reference_run(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 2.5, 0.125, 2.5, 20, 1, 20);
  ct_scene *scene = new_scene_with("right", m, &STEEL, CT_KERNEL_AUTO, -1000, 0, 0);
  plane_strain(scene, 0, m, 0.125);
  add_support(scene, 0, m, 0, 0.0, "x", 0.0);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 6e-7, .courant = 0.125}, &steps, NULL);
  ct_state *state = new_state(p);
  double kinetic = energy_of(p, state).kinetic, mass = 0.0;
  for (int n = 0; n < p->node_count; n++) mass += m->nodes[3 * n] > 0.0 ? p->mass[n] : 0.0;
  tap_close(kinetic / (0.5 * mass * 1e6), 1.0, 1e-12, "reference run: kinetic energy m v^2 / 2");
  ledger l = watch(p, state, steps / 10 * 10, 10);
  tap_ok(l.total < 1e-12, "reference run, %d steps: total energy constant to %.2g", (int)steps,
         l.total);
  tap_ok(l.balance < 1e-12, "reference run: work balance %.2g", l.balance);
  tap_ok(l.solid_work < 1e-12, "reference run: work of the solid is minus its energy, off by %.2g",
         l.solid_work);
  tap_ok(l.impulse < 1e-12,
         "reference run: change of momentum is the support's impulse, off by %.2g", l.impulse);
  ct_momentum now = momentum_of(p, state, 0);
  tap_ok(now.support_impulse[0] > 0.0 && now.contact_impulse[0] == 0.0,
         "reference run: the wall has an impulse, and there is no contact");
}

/* Two equal plates. */
static void contact_run(double beta, double courant, double fraction, double drift)
{
  ct_mesh *right = box_mesh(CT_HEX8, 0, 0, 0, 2.5, 0.125, 2.5, 20, 1, 20),
          *left = box_mesh(CT_HEX8, -2.5, 0, 0, 2.5, 0.125, 2.5, 20, 1, 20);
  ct_scene *scene = new_scene_with("right", right, &STEEL, CT_KERNEL_AUTO, -1000, 0, 0);
  add_body(scene, "left", left, &STEEL, CT_KERNEL_AUTO, 1000, 0, 0);
  plane_strain(scene, 0, right, 0.125);
  plane_strain(scene, 1, left, 0.125);
  add_contact(scene, 1, left, 0.0, 0, right, 0.0, 0, beta);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p =
      build(scene, (ct_scene_time){.end = 1e-6, .courant = courant, .fraction = fraction}, &steps,
            &stable);
  ct_state *state = new_state(p);
  ledger l = watch(p, state, steps / 5 * 5, 5);
  char name[80];
  snprintf(name, sizeof name, "contact run, beta = %g, Courant number %.3f", beta,
           p->dt / stable.dt_courant);
  tap_ok(l.total < drift && l.contact > 1e-3,
         "%s: total energy constant to %.2g, up to %.2g of it in the contact", name, l.total,
         l.contact);
  tap_ok(l.balance < 1e-12, "%s: work balance %.2g", name, l.balance);
  tap_ok(l.impulse < 1e-12 && l.momentum < 1e-13, "%s: impulse %.2g, total momentum %.2g", name,
         l.impulse, l.momentum);
}

/* A problem that begins in touch: two rods or plates that fly at each other, or a rod at a wall;
 * `lap` is how far they lie in each other. */
typedef struct touching {
  ct_mesh *mesh[2];
  ct_scene *scene;
  const ct_problem *problem;
  double moving; /* m v² / 2 of all nodes */
  double stored; /* of the overlap: k lap² / 2 of all points */
} touching;

static touching open_touching(ct_brick_kind kind, int plate, ct_enforcement enforcement,
                              ct_scheme scheme, double lap)
{
  double width = plate ? 1.0 : 0.25, beta = 4.0, edge = 0.25, v = 1000.0;
  int across = plate ? 4 : 1;
  touching t = {{box_mesh(kind, -1, 0, 0, 1, 0.25, width, 4, 1, across),
                 box_mesh(kind, -lap, 0, 0, 1, 0.25, width, 4, 1, across)},
                new_scene(),
                NULL,
                0.0,
                0.0};
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = enforcement;
  options.initial_penetration = lap > 0.0 ? CT_INITIAL_FORCE : options.initial_penetration;
  for (int b = 0; b < 2; b++)
    add_body(t.scene, b ? "right" : "left", t.mesh[b], &STEEL, CT_KERNEL_AUTO, b ? -v : v, 0, 0);
  add_contact_with(t.scene, 0, t.mesh[0], 0.0, 1, t.mesh[1], -lap, 0, beta, options, 0.0, 0.0);
  t.problem = build_by(scheme, t.scene, 1e-6, 0.8, NULL);
  for (int n = 0; n < t.problem->node_count; n++) t.moving += 0.5 * t.problem->mass[n] * v * v;
  // Half the penalty at the points of each side, whose weights sum to the area.
  t.stored = 0.5 * beta * STEEL.young / edge * lap * lap * 0.25 * width;
  return t;
}

/* At t = 0 the energy is that of the initial motion and of an overlap, whatever the contact does
 * next (eq:energy-start, eq:work-start). */
static void first_row(void)
{
  for (int e = 0; e < ENFORCEMENTS; e++)
    for (int k = 0; k < 4; k++) {
      double kinetic = 0.0, total = 0.0, balance = 0.0, work = 0.0, own;
      for (int scheme = 0; scheme < CT_SCHEME_COUNT; scheme++) {
        touching t = open_touching(k % 2 ? CT_HEX20 : CT_HEX8, k / 2, (ct_enforcement)e,
                                   (ct_scheme)scheme, 0.0);
        ct_state *state = new_state(t.problem);
        ct_energy first = energy_of(t.problem, state);
        kinetic = worst(kinetic, first.kinetic / t.moving - 1.0);
        total = worst(total, first.total / t.moving - 1.0);
        for (int i = 0; i < t.problem->effect_count; i++) {
          must(ct_energy_work, t.problem, state, i, &own);
          work = worst(work, own / t.moving);
        }
        for (int i = 0; i < 10; i++) {
          advance(t.problem, state, 1);
          balance = worst(balance, energy_of(t.problem, state).balance / t.moving);
        }
      }
      tap_ok(kinetic < 1e-12 && total < 1e-12 && work == 0.0 && balance < 1e-13,
             "first row, %s of %s that touch, %s, four integrators: kinetic energy off by %.1e, "
             "total by %.1e, balance then %.1e",
             k / 2 ? "plates" : "rods", k % 2 ? "hex20" : "hex8", ENFORCEMENT[(ct_enforcement)e],
             kinetic, total, balance);
    }
  touching t = open_touching(CT_HEX8, 0, CT_ENFORCE_ENERGY_CONTROLLED, CT_CENTRAL_DIFFERENCE, 1e-4);
  ct_state *state = new_state(t.problem);
  ct_energy first = energy_of(t.problem, state);
  tap_ok(fabs(first.kinetic / t.moving - 1.0) < 1e-12 &&
             fabs(first.contact - t.stored) < 1e-12 * t.moving && t.stored > 0.1 * t.moving,
         "rods that overlap: m v^2 / 2, and %.3g of it in the contact, as computed by hand",
         first.contact / t.moving);
}

/* A start that continues with a third of its step: its first row is that of a start. */
static void refined_start(void)
{
  touching t = open_touching(CT_HEX8, 1, CT_ENFORCE_ENERGY_CONTROLLED, CT_CENTRAL_DIFFERENCE, 0.0);
  ct_problem fine = *t.problem;
  double balance = 0.0;
  fine.dt /= 3.0;
  ct_state *start = new_state(t.problem), *state = new_state(&fine);
  must(ct_state_subdivide_step, &fine, start, state);
  for (int i = 0; i < 10; i++) {
    balance = worst(balance, energy_of(&fine, state).balance / t.moving);
    advance(&fine, state, 1);
  }
  tap_ok(balance < 1e-13, "a start that continues with a third of its step: work balance %.1e",
         balance);
  free_state(state);
}

/* The same at a wall, at rest, with a weight that presses: the total never rises from its first row
 * on. */
static void pressed_at_rest(void)
{
  for (int k = 0; k < 2; k++) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 3, 3);
    ct_scene *scene = new_scene();
    int32_t *faces = integers(400);
    add_body(scene, "block", m, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
    ct_obstacle_def o = {COOKIE,
                         .shape = CT_OBSTACLE_PLANE,
                         .axis = {0, 0, 1},
                         .epsilon = (k ? 4e3 : 4.0) * STEEL.young * 3.0,
                         .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                         .dissipation = 0.1,
                         .kind = CT_Q4,
                         .face_count = ct_mesh_plane_faces(m, 2, 0.0, faces, NULL),
                         .faces = faces};
    add_made(scene, ct_obstacle_create_effect, &o);
    ct_gravity_def gravity = {COOKIE, .acceleration = {0, 0, -9810}};
    add_made(scene, ct_gravity_create_effect, &gravity);
    const ct_problem *p = build_until(scene, 1e-5, 0.9);
    ct_state *state = new_state(p);
    double before = energy_of(p, state).total, rise = 0.0, top = 0.0;
    for (int i = 0; i < 60; i++) {
      advance(p, state, 1);
      ct_energy now = energy_of(p, state);
      rise = fmax(rise, now.total - before);
      before = now.total;
      top = fmax(top, fabs(now.kinetic));
    }
    // The forces are those of the law to the tolerance of the iteration, 1e-10.
    tap_ok(rise < 1e-11 * top,
           "a block at rest on a plane under its weight, %s penalty: the total rises by %.1e of "
           "the kinetic energy at most",
           k ? "stiff" : "soft", rise / top);
  }
}

/* Meshes 1 : 7.3 along the contact, densities 2 : 1, different velocities (eq:work-balance,
 * eq:impulse-balance). */
static void unlike_plates(void)
{
  ct_material heavy = STEEL;
  heavy.density *= 2.0;
  ct_mesh *coarse = box_mesh(CT_HEX8, -2.5, 0, 0, 2.5, 0.25, 2.5, 10, 1, 10),
          *fine = box_mesh(CT_HEX8, 0, 0, 0, 2.5, 0.25, 2.5, 12, 1, 73);
  ct_scene *scene = new_scene_with("coarse", coarse, &heavy, CT_KERNEL_AUTO, 700, 0, 0);
  add_body(scene, "fine", fine, &STEEL, CT_KERNEL_AUTO, -1900, 0, 30);
  plane_strain(scene, 0, coarse, 0.25);
  plane_strain(scene, 1, fine, 0.25);
  add_contact(scene, 0, coarse, 0.0, 1, fine, 0.0, 0, 1.0);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 8e-7, .fraction = 0.7}, &steps, NULL);
  ct_state *state = new_state(p);
  ledger l = watch(p, state, steps / 10 * 10, 10);
  ct_momentum a = momentum_of(p, state, 0), b = momentum_of(p, state, 1);
  tap_ok(l.momentum < 1e-13, "unlike plates, %d steps: total p_x constant to %.2g of sum m |v|",
         (int)steps, l.momentum);
  tap_ok(l.impulse < 1e-12,
         "unlike plates: each change of momentum is contact plus support impulse, off by %.2g",
         l.impulse);
  tap_ok(l.balance < 1e-12 && l.total < 0.02,
         "unlike plates: work balance %.2g, total energy to %.2g", l.balance, l.total);
  tap_ok(a.contact_impulse[0] < 0.0 &&
             fabs(a.contact_impulse[0] + b.contact_impulse[0]) <
                 1e-12 * fabs(a.contact_impulse[0]) &&
             fabs(a.contact_impulse[0]) > 0.1 * fabs(a.p[0]),
         "unlike plates: the contact's impulses are opposite, %.3g and %.3g", a.contact_impulse[0],
         b.contact_impulse[0]);
}

/* Hands on: p = m v, L = X x m v of a flying block, and velocities at whole steps. */
static void flying_block(void)
{
  ct_material m = {2.0, 0.3, 0.5, CT_LINEAR};
  ct_mesh *box = box_mesh(CT_HEX8, 1, 2, 3, 1, 1, 2, 2, 2, 2);
  ct_scene *scene = new_scene_with("block", box, &m, CT_KERNEL_AUTO, 3, -1, 2);
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, &steps, NULL);
  ct_state *state = new_state(p);
  advance(p, state, steps);
  ct_momentum now = momentum_of(p, state, 0);
  // Mass 1; at t = 1 the centre is at (1.5, 2.5, 4) + (3, -1, 2) = (4.5, 1.5, 6): L = X x v =
  // (1.5*2 + 6*1, 6*3 - 4.5*2, -4.5 - 4.5).
  const double L[3] = {9.0, 9.0, -9.0}, v[3] = {3, -1, 2};
  double off = worst(largest_difference(now.p, v, 3), largest_difference(now.L, L, 3));
  tap_ok(off < 1e-13 && now.body == 0 && fabs(now.time - 1.0) < 1e-15,
         "a flying block of mass 1: p = v, L = X x v, off by %.2g", off);
  tap_close(energy_of(p, state).kinetic, 7.0, 1e-13, "its kinetic energy is 14 / 2");

  double *u = numbers(3 * p->node_count), stored = 1.0, work = 1.0;
  ct_error e = {0};
  must(ct_state_velocity, p, state, u);
  off = 0.0;
  for (int i = 0; i < 3 * p->node_count; i++) off = worst(off, u[i] - v[i % 3]);
  tap_ok(off < 1e-14, "velocity at whole steps");
  must(ct_energy_stored, p, state, 0, &stored);
  must(ct_energy_work, p, state, 0, &work);
  tap_ok(stored < 1e-25 && fabs(work) < 1e-13, "no stored energy and no work");
  tap_ok(ct_momentum_of(p, state, 1, &now, &e) == CT_ERROR_ARGUMENT &&
             ct_momentum_of(p, state, -1, &now, &e) == CT_ERROR_ARGUMENT,
         "there is no second body: %s", e.text);
  tap_ok(ct_energy_stored(p, state, 1, &stored, &e) == CT_ERROR_ARGUMENT &&
             ct_state_force(p, state, -1, u, &e) == CT_ERROR_ARGUMENT &&
             ct_energy_work(p, state, 0, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_energy_of(NULL, state, NULL, NULL) == CT_ERROR_ARGUMENT &&
             ct_state_velocity(p, NULL, u, NULL) == CT_ERROR_ARGUMENT,
         "effects that do not exist and null arguments are refused: %s", e.text);
}

/* The kinetic energy (v- . M v+) / 2 by hand, from two half-step velocities of the run itself
 * (eq:discrete-energy). */
static void discrete_kinetic(void)
{
  ct_material m = {2.0, 0.3, 0.5, CT_LINEAR};
  ct_mesh *box = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 2, 2, 1);
  ct_scene *scene = new_scene_with("block", box, &m, CT_KERNEL_AUTO, 1, 0, 0);
  add_support(scene, 0, box, 0, 0.0, "xyz", 0.0);
  const ct_problem *p = build_until(scene, 1.0, 0.9);
  ct_state *state = new_state(p);
  double off = 0.0, *before = numbers(3 * p->node_count);
  for (int k = 0; k < 50; k++) {
    double got = energy_of(p, state).kinetic, want = 0.0;
    memcpy(before, state->velocity, 3 * (size_t)p->node_count * sizeof *before);
    advance(p, state, 1);
    for (int i = 0; i < 3 * p->node_count; i++)
      want += 0.5 * p->mass[i / 3] * before[i] * state->velocity[i];
    off = worst(off, (got - want) / state->kinetic_start);
  }
  tap_ok(off < 1e-13, "kinetic energy is half of v- M v+, off by %.2g", off);
}

/* A block hangs on its base for 2 · 10⁵ steps. The impulse of its weight is m g t, that of the base
 * the rest of its momentum: to 10⁻¹⁴ of the whole, where a plain running sum is off by 10⁻¹²; and a
 * copy within a block of steps continues with the same bits (eq:impulse-parts, eq:impulse-balance).
 */
static void many_impulses(void)
{
  static const int64_t at[] = {1000, 25600, 25601, 102399, 200000};
  static const double g[3] = {0.3, 0.7, -9.81};
  ct_material m = {.young = 100.0, .poisson = 0.3, .density = 0.7};
  ct_mesh *box = box_mesh(CT_HEX8, 0, 0, 0, 2, 1, 1, 2, 1, 1);
  ct_scene *scene = new_scene_with("block", box, &m, CT_KERNEL_AUTO, 0, 0, 0);
  add_support(scene, 0, box, 2, 0.0, "xyz", 0.0);
  add_weight(scene, (weight){.g = {g[0], g[1], g[2]}});
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.7}, &steps, NULL);
  ct_state *state = new_state(p), *copy = new_state(p);
  double weighed = 0.0, balance = 0.0, mass = 0.0, impulse[3];
  int own = strcmp(p->effects[1]->label, "weight") == 0 ? 1 : 2;
  for (int n = 0; n < p->node_count; n++) mass += p->mass[n];
  const ct_momentum start = momentum_of(p, state, 0);
  for (int i = 0; i < 5; i++) {
    advance(p, state, at[i] - state->step);
    double t = (double)state->step * p->dt, unit = mass * 9.81 * t;
    const ct_momentum now = momentum_of(p, state, 0);
    must(ct_energy_impulse, p, state, own, impulse);
    for (int c = 0; c < 3; c++) {
      weighed = worst(weighed, (impulse[c] - mass * g[c] * t) / unit);
      balance =
          worst(balance, (now.p[c] - start.p[c] - impulse[c] - now.support_impulse[c]) / unit);
    }
    if (i == 0) must(ct_state_copy, p, state, copy);
  }
  tap_ok(weighed < 4e-14 && balance < 4e-14,
         "200000 steps: the impulse of a weight is m g t (off by %.2g), the momentum that of "
         "weight and base (%.2g)",
         weighed, balance);
  advance(p, copy, state->step - copy->step);
  tap_ok(memcmp(copy->impulse, state->impulse,
                (size_t)state->impulse_count * sizeof *state->impulse) == 0,
         "a copy continues with the same bits of its impulses");
}

/* Strain energy of a body, element by element as the equations read, in a plain sum. */
static double strain_by_hand(const ct_body *body, const double *u)
{
  double sum = 0.0, x[60], v[60], force[60], energy;
  for (int el = 0; el < body->mesh->element_count; el++) {
    take_element(body->mesh, el, body->mesh->nodes, x);
    take_element(body->mesh, el, u + 3 * body->first_node, v);
    must(ct_solid_element_force, body->mesh->kind, x, v, &body->material, force, &energy);
    sum += energy;
  }
  return sum;
}

/* A row against sums by hand: over elements, over nodes, over effects. */
static void check_row(const ct_problem *p, ct_state *state, const ct_ledger *row, const char *what)
{
  double *v = numbers(3 * p->node_count), strain = 0.0, work = 0.0, stored = 0.0, off = 0.0,
         scale = row->energy.strain + row->energy.kinetic, size = 0.0;
  must(ct_state_velocity, p, state, v);
  for (int b = 0; b < p->body_count; b++) {
    const ct_body *own = &p->bodies[b];
    double hand[6] = {0.0};
    strain += strain_by_hand(own, state->displacement);
    for (int n = own->first_node; n < own->first_node + own->mesh->node_count; n++)
      for (int c = 0; c < 3; c++) {
        int i = 3 * n + (c + 1) % 3, j = 3 * n + (c + 2) % 3;
        double xi = p->reference[i] + state->displacement[i],
               xj = p->reference[j] + state->displacement[j];
        hand[c] += p->mass[n] * v[3 * n + c];
        hand[3 + c] += p->mass[n] * (xi * v[j] - xj * v[i]);
        size += p->mass[n] * (fabs(v[3 * n + c]) + fabs(xi * v[j]) + fabs(xj * v[i]));
      }
    off = worst(off, largest_difference(row->momentum[b].p, hand, 3));
    off = worst(off, largest_difference(row->momentum[b].L, hand + 3, 3));
  }
  for (int k = 0; k < p->effect_count; k++) {
    work += row->effects[k].work;
    stored += row->effects[k].stored;
  }
  // Round-off of sums of some thousand terms.
  tap_ok(off < 1e-13 * size, "%s: momenta are the sums over the nodes, off by %.2g", what,
         off / size);
  tap_ok(fabs(row->energy.strain - strain) < 1e-12 * scale && strain > 0.01 * scale,
         "%s: strain is the sum over the elements, off by %.2g", what,
         fabs(row->energy.strain - strain) / scale);
  tap_ok(fabs(row->energy.kinetic - state->kinetic_start - work - row->energy.balance) <
                 1e-13 * scale &&
             fabs(row->energy.kinetic + stored - row->energy.external - row->energy.total) <
                 1e-13 * scale,
         "%s: balance and total are those of the effects", what);
}

/* The row of a monitor, and the same state moved far away, whose strain is the same
 * (eq:stored-by-forces). */
static void one_row(ct_brick_kind kind, ct_solid_kernel kernel, ct_law law, const char *what)
{
  ct_material soft = STEEL;
  soft.law = law;
  ct_mesh *a = box_mesh(kind, -2.5, 0, 0, 2.5, 0.5, 2.5, 7, 2, 5),
          *b = box_mesh(kind, 0, 0, 0, 2.5, 0.5, 2.5, 5, 2, 9);
  ct_scene *scene = new_scene_with("a", a, &soft, kernel, 900, 30, 0);
  add_body(scene, "b", b, &STEEL, kernel, -1900, 0, 30);
  plane_strain(scene, 1, b, 0.5);
  add_contact(scene, 0, a, 0.0, 1, b, 0.0, 0, 1.0);
  const ct_problem *p = build_until(scene, 3e-7, 0.6);
  ct_state *state = new_state(p);
  ct_monitor_options options = ct_monitor_options_default();
  ct_monitor *monitor;
  must(ct_monitor_create, p, state, &options, &monitor);
  ct_observer at_end = ct_monitor_observer(monitor);
  at_end.last = 1;
  must(ct_run, state->problem, state, 12, &at_end, 1);
  check_row(p, state, ct_monitor_ledger(monitor), what);
  ct_energy energy = energy_of(p, state);
  tap_ok(memcmp(&energy, &ct_monitor_ledger(monitor)->energy, sizeof energy) == 0,
         "%s: the monitor's row has the bits of the state's energy", what);
  free_monitor(monitor);
}

/* Series of one step between checks: elements stay asleep, and wake if a host applies a force in
 * between. */
static void sleep_over_checks(int push)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 60, 1, 1, 120, 2, 2);
  ct_scene *scene = new_scene_with("bar", m, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_optimisations sleeping = {.sleep = 1};
  must(ct_scene_set_optimisations, scene, &sleeping);
  const ct_problem *p = build_until(scene, 1e-5, 0.9);
  ct_state *one = new_state(p), *other = new_state(p);
  one->velocity[0] = other->velocity[0] = 1000.0;
  ct_monitor_options options = ct_monitor_options_default();
  ct_monitor *monitor;
  must(ct_monitor_create, p, one, &options, &monitor);
  ct_observer at_end = ct_monitor_observer(monitor);
  at_end.last = 1;
  for (int i = 0; i < 20; i++) {
    if (push && i == 10) one->velocity[3 * (p->node_count - 1)] = 1000.0;
    must(ct_run, one->problem, one, 1, &at_end, 1);
  }
  advance(p, other, push ? 10 : 20);
  if (push) other->velocity[3 * (p->node_count - 1)] = 1000.0;
  if (push) advance(p, other, 10);
  double off = largest_difference(one->displacement, other->displacement, 3 * p->node_count);
  tap_ok(off == 0.0 && (one->displacement[3 * (p->node_count - 1)] != 0.0) == push,
         "checks after each step%s: the same values, off by %.2g",
         push ? ", and a force between two" : "", off);
  if (!push)
    tap_ok(one->element_updates[0] <= other->element_updates[0] + 480 &&
               one->element_updates[1] > 3 * one->element_updates[0],
           "checks after each step wake no element: %lld updates, %lld without checks",
           (long long)one->element_updates[0], (long long)other->element_updates[0]);
  free_monitor(monitor);
}

int main(void)
{
  free_at_end();
  reference_run();
  contact_run(4.0, 0.125, 0.0, 1e-3);
  contact_run(20.0, 0.125, 0.0, 1e-2);
  contact_run(20.0, 0.0, 1.0, 10.0);
  first_row();
  refined_start();
  pressed_at_rest();
  unlike_plates();
  flying_block();
  discrete_kinetic();
  many_impulses();
  one_row(CT_HEX8, CT_KERNEL_AUTO, CT_LINEAR, "row of hex8");
  one_row(CT_HEX20, CT_KERNEL_AUTO, CT_LINEAR, "row of hex20");
  one_row(CT_HEX8, CT_KERNEL_AUTO, CT_NEO_HOOKEAN, "row of two laws");
  for (int push = 0; push < 2; push++) sleep_over_checks(push);
  return tap_done();
}
