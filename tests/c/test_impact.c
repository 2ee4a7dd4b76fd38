/* Stored impact: the second row of a point that opens, one mass that bounces, and plates of few
 * layers, which lose nothing. */
#include "../../libcontact/src/constraint/law_rows.h"
#include "bodies.h"

static const ct_material SOFT = {.young = 1.0, .poisson = 0.0, .density = 1.0};

static double between(double low, double high)
{
  return 0.5 * (low + high) + uniform(0.5 * (high - low));
}

/* The ramp is a tangent of the hyperbola λ x / 2 = K: it touches it where all points that open move
 * alike, and its work is nowhere more than K (eq:release-ramp). */
static void tangent(void)
{
  double touch = 0.0, most = -1.0;
  for (int i = 0; i < 20000; i++) {
    const double K = pow(10.0, between(-12, 6)), D = pow(10.0, between(-6, 3)),
                 free = between(-3, 3) * sqrt(K * D);
    ct_constraint c = {.before = between(-1, 1) * sqrt(K * D), .impact.reserve = K};
    double force;
    const ct_ramp ramp = ct_law_release(&c, c.before + free, D, &force);
    const double x = free + D * force;
    touch = worst(touch, 0.5 * force * x / K - 1.0);
    for (int k = 0; k < 10; k++) {
      const double way = between(-4, 4) * x, own = fmax(-(c.before + way + ramp.b) / ramp.C, 0.0);
      most = fmax(most, 0.5 * own * way / K - 1.0);
    }
  }
  tap_ok(touch < 1e-12 && most < 1e-9,
         "20000 rows: the ramp touches the hyperbola, off by %.1e, and does at most K, %+.1e",
         touch, most);
}

/* The forces of the row of a mass and of its second row, whose sum moves both: the smaller active
 * set that fits. */
static void solve_both(const ct_ramp ramp[2], double free, double W, int rows, double force[2])
{
  double best = HUGE_VAL;
  for (int set = 0; set < 1 << rows; set++) {
    // C_i λ_i + W Σ λ = -(free + b_i) of the rows in the set
    double inverse = 1.0, load = 0.0, f[2] = {0.0, 0.0}, wrong = 0.0;
    for (int i = 0; i < rows; i++)
      if (set >> i & 1) inverse += W / ramp[i].C, load -= (free + ramp[i].b) / ramp[i].C;
    const double moved = free + W * load / inverse;
    for (int i = 0; i < rows; i++) {
      const double own = -(moved + ramp[i].b) / ramp[i].C;
      f[i] = set >> i & 1 ? own : 0.0;
      wrong = fmax(wrong, set >> i & 1 ? -own : own);
    }
    if (wrong < best) best = wrong, force[0] = f[0], force[1] = f[1];
  }
}

/* A mass that flies at a wall stops and leaves it: with e = 1 as fast as it came, and a restitution
 * of s leaves it √s of its speed (eq:impact-reserve, eq:release-time). Its energy with that of the
 * row grows in no step. */
static void bouncing_mass(double share, double k)
{
  const double m = 2.0, dt = 0.1, W = dt * dt / m, v = 3.0;
  double before = 1.0, g = before - dt * v, last = 0.5 * m * v * v, grown = 0.0, speed = 0.0;
  ct_constraint c = {.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                     .stiffness = k,
                     .dissipation = 0.15,
                     .restitution = share,
                     .travel_time = dt};
  for (int n = 0; n < 100; n++) {
    const double free = g + (g - before);
    double force[2] = {0.0, 0.0}, start;
    c.gap = g, c.before = before, c.after = free;
    c.dashpot = ct_law_dashpot(&c, W);
    ct_ramp ramp[2] = {ct_law_ramp(&c)};
    const int opens = ct_law_releases(&c, W, dt, -(free + ramp[0].b) / (ramp[0].C + W), 0, 0.0);
    if (opens) ramp[1] = ct_law_release(&c, free, W, &start);
    solve_both(ramp, free, W, opens ? 2 : 1, force);
    c.force = force[0] + force[1], c.impact.release = force[1];
    c.after = free + W * c.force;
    ct_law_settle(&c, dt, c.after - c.before, free + ramp[0].b < 0.0);
    speed = (c.after - g) / dt;
    const double total = 0.5 * m * speed * speed + ct_law_stored(&c) + c.impact.reserve;
    grown = fmax(grown, (total - last) / (0.5 * m * v * v));
    last = total, before = g, g = c.after;
  }
  tap_ok(fabs(speed / v - sqrt(share)) < 5e-3 && grown < 1e-13 && c.impact.reserve < 1e-3 * v,
         "k = %g, restitution %g: a mass leaves with %.6f of its speed, grows by %.1e", k, share,
         speed / v, grown);
}

/* The second body, of the modulus `young`, flies at the first, both with the speed v, or the first
 * one at rest. The share of the energy that both have at the end, and the largest growth of the
 * total. */
static double collide(ct_mesh *const m[2], const double v[2], int32_t *const faces[2],
                      const int32_t count[2], const ct_contact_options *options, double young,
                      ct_scene_time time, double *grown)
{
  const ct_material stuff = {.young = young, .poisson = 0.0, .density = 1.0};
  ct_scene *scene = new_scene_with("low", m[0], &SOFT, CT_KERNEL_AUTO, 0, 0, v[0]);
  add_body(scene, "high", m[1], &stuff, CT_KERNEL_AUTO, 0, 0, v[1]);
  ct_scene_contact contact = scene_contact(0, faces[0], count[0], 1, faces[1], count[1]);
  contact.options = *options;
  must(ct_scene_add_contact, scene, &contact);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, time, &steps, &stable);
  ct_state *state = new_state(p);
  const double start = energy_of(p, state).total;
  double last = start;
  for (int64_t i = 0; i < steps; i++) {
    advance(p, state, 1);
    const double now = energy_of(p, state).total;
    *grown = fmax(*grown, (now - last) / start);
    last = now;
  }
  const ct_energy end = energy_of(p, state);
  return (end.kinetic + end.strain) / start;
}

static ct_contact_options restituted(double share)
{
  ct_contact_options options = ct_contact_options_default();
  options.restitution = share;
  return options;
}

/* Some of the plates touch at t = 0 (eq:reserve-start). The energy of the motion that two plates of
 * n layers keep in an impact; the second one has the modulus `young`. */
static double unlike_plates(ct_brick_kind kind, int n, double young, double fraction, double phase,
                            ct_contact_options options, double *grown)
{
  const double h = 1.0 / n, v = 0.1, gap = 2 * v * phase * fraction * h;
  ct_mesh *m[2] = {box_mesh(kind, 0, 0, 0, 2 * h, 2 * h, 1, 2, 2, n),
                   box_mesh(kind, 0, 0, 1 + gap, 2 * h, 2 * h, 1, 2, 2, n)};
  int32_t *faces[2] = {integers(32), integers(32)},
          count[2] = {ct_mesh_plane_faces(m[0], 2, 1.0, faces[0], NULL),
                      ct_mesh_plane_faces(m[1], 2, 1.0 + gap, faces[1], NULL)};
  return collide(m, (double[2]){v, -v}, faces, count, &options, young,
                 (ct_scene_time){.end = 4.4, .fraction = fraction}, grown);
}

static double plates(ct_brick_kind kind, int n, double fraction, double phase, double share,
                     double *grown)
{
  return unlike_plates(kind, n, 1.0, fraction, phase, restituted(share), grown);
}

static void few_layers(void)
{
  static const int LAYERS[] = {1, 2, 4, 8};
  static const double LEAST[] = {0.98, 0.99, 0.995, 0.995}, PART[] = {0.3, 0.6, 0.9, 0.98};
  for (int i = 0; i < 4; i++) {
    double kept = 1.0, grown = 0.0, none = 0.0;
    for (int f = 0; f < 4; f++)
      for (int phase = 0; phase < 7; phase++)
        kept = fmin(kept, plates(CT_HEX8, LAYERS[i], PART[f], phase / 7.0, 1.0, &grown));
    const double lost = 1.0 - plates(CT_HEX8, LAYERS[i], 0.9, 0.4, 0.0, &none);
    tap_ok(kept >= LEAST[i] && grown < 1e-12 && lost > 0.25 / LAYERS[i],
           "plates of %d layers keep %.4f of their energy, worst of 28 impacts, grow by %.1e; with "
           "restitution 0 they lose %.3f",
           LAYERS[i], kept, grown, lost);
  }
}

/* On faces of eight nodes some points touch for less than τ, and are paid after that
 * (eq:release-time); others close again and again, and lose no share of it to their dashpot
 * (eq:impact-reserve). */
static void faces_of_eight_nodes(int n, double least)
{
  double kept = 1.0, grown = 0.0;
  for (int phase = 0; phase < 3; phase++)
    kept = fmin(kept, plates(CT_HEX20, n, 0.3, 0.1 + 0.4 * phase, 1.0, &grown));
  tap_ok(kept >= least && grown < 1e-12,
         "plates of %d layers of hex20 keep %.4f of their energy, worst of 3 impacts, grow by %.1e",
         n, kept, grown);
}

/* A soft plate on a stiff one, whose waves are ten times faster: its nodes swing on a spring of the
 * soft one's modulus (eq:travel-time), and it vibrates while they touch, which the dashpot does not
 * take away (eq:impact-reserve). */
static void soft_on_stiff(double fraction)
{
  double kept = 1.0, grown = 0.0;
  for (int phase = 0; phase < 3; phase++)
    kept = fmin(kept, unlike_plates(CT_HEX8, 2, 100.0, fraction, 0.1 + 0.4 * phase, restituted(1.0),
                                    &grown));
  tap_ok(kept >= 0.999 && grown < 1e-12,
         "a plate on a stiffer one, at %g of the step, keeps %.4f of the energy, worst of 3 "
         "impacts, grows by %.1e",
         fraction, kept, grown);
}

/* A host gives a travel time shorter than the step: plates that touch at t = 0, where forces are
 * solved for twice, make no energy (eq:reserve-start). */
static void short_travel_time(void)
{
  double grown = 0.0;
  ct_contact_options options = restituted(1.0);
  options.travel_time = 0.1;
  for (int f = 1; f < 4; f++) unlike_plates(CT_HEX8, 1, 1.0, 0.3 * f, 0.0, options, &grown);
  tap_ok(grown < 1e-12, "a travel time shorter than the step: plates grow by %.1e", grown);
}

/* A bar lands on a plate with an edge and turns over it: points lose their force while others still
 * press on their nodes, and are paid when these leave (eq:release-time). Without
 * the debts that they pay first (eq:release-debt) it gains 2.9e-5. */
static void tilted_bar(double angle)
{
  const double c = cos(angle), s = sin(angle);
  double grown = 0.0;
  ct_mesh *m[2] = {box_mesh(CT_HEX8, -4, -2, -2, 10, 4, 2, 10, 4, 2),
                   box_mesh(CT_HEX8, -1, -1, 0, 2, 2, 6, 2, 2, 6)};
  for (double *x = m[1]->nodes; x < m[1]->nodes + 3 * m[1]->node_count; x += 3) {
    const double y[2] = {c * x[0] + s * x[2], c * x[2] - s * x[0]};
    x[0] = y[0], x[2] = y[1] + s + 1e-3;
  }
  int32_t *faces[2] = {integers(400), integers(400)},
          count[2] = {ct_mesh_plane_faces(m[0], 2, 0.0, faces[0], NULL),
                      ct_mesh_outer_faces(m[1], faces[1], NULL)};
  const ct_contact_options options = restituted(1.0);
  const double kept = collide(m, (double[2]){0.0, -0.02}, faces, count, &options, 1.0,
                              (ct_scene_time){.end = 36.0, .fraction = 0.9}, &grown);
  tap_ok(kept >= 0.99 && grown < 1e-12,
         "a bar that lands on its edge, turned by %.2f, keeps %.4f of the energy, grows by %.1e",
         angle, kept, grown);
}

/* A block on or above a cylinder that may move, and its steps; `whole`: all of its skin may touch.
 */
static const ct_problem *on_a_cylinder(int whole, double radius, double gap, double speed,
                                       double moves, int64_t *steps)
{
  ct_scene *scene = new_scene();
  ct_mesh *m = box_mesh(CT_HEX8, -0.5, -0.5, 0, 1, 1, 1, 3, 3, 3);
  int32_t *faces = integers(400);
  add_body(scene, "block", m, &SOFT, CT_KERNEL_AUTO, 0.5 * speed, 0, -speed);
  ct_obstacle_def o = ct_obstacle_def_default();
  o.shape = CT_OBSTACLE_CYLINDER, o.radius = radius, o.epsilon = 120.0;
  o.restitution = 1.0, o.travel_time = 1.0 / 3, o.velocity[2] = moves;
  o.kind = CT_Q4, o.faces = faces;
  o.face_count =
      whole ? ct_mesh_outer_faces(m, faces, NULL) : ct_mesh_plane_faces(m, 2, 0.0, faces, NULL);
  const double point[3] = {0.21, 0.0, -radius - gap}, axis[3] = {0.3, 1.0, 0.0};
  memcpy(o.point, point, sizeof point), memcpy(o.axis, axis, sizeof axis);
  add_made(scene, ct_obstacle_create_effect, &o);
  ct_stable_step stable;
  return build(scene, (ct_scene_time){.end = 12.0, .fraction = 0.6}, steps, &stable);
}

/* The largest growth of its total. */
static double growth_on_a_cylinder(double radius, double gap, double speed, double moves)
{
  int64_t steps;
  const ct_problem *p = on_a_cylinder(1, radius, gap, speed, moves, &steps);
  ct_state *state = new_state(p);
  const double start = energy_of(p, state).total;
  double grown = 0.0;
  for (int64_t i = 0; i < steps; i++) {
    advance(p, state, 1);
    grown = fmax(grown, (energy_of(p, state).total - start) / start);
  }
  return grown;
}

/* What the solver has of its rows it reads anew where a debt was paid (eq:impact-debt), and where a
 * state was loaded: single steps, of which each is taken twice, give the bits of a run. */
static void rows_that_change(void)
{
  int wrong = 0;
  for (int i = 0; i < 2; i++) {
    int64_t steps;
    const ct_problem *p = on_a_cylinder(0, 0.02 * pow(1.3, 11 + 4 * i), 1e-3, 0.31, 0.0, &steps);
    ct_state *run = new_state(p), *single = new_state(p), *good = new_state(p);
    const size_t size = 3 * (size_t)p->node_count * sizeof(double);
    advance(p, run, steps);
    for (int64_t n = 0; n < steps; n++) {
      must(ct_state_copy, p, single, good);
      advance(p, single, 1);
      must(ct_state_copy, p, good, single);
      advance(p, single, 1);
    }
    wrong += memcmp(run->displacement, single->displacement, size) != 0;
  }
  tap_ok(wrong == 0, "single steps, each taken twice, give the bits of a run: %d of 2 differ",
         wrong);
}

/* A bar that falls to a floor, which its ends may touch, along a wall. The rows of the wall, which
 * all stay for a while, follow on those of the floor, which come and go. */
static const ct_problem *along_a_wall(int64_t *steps)
{
  ct_scene *scene = new_scene();
  ct_mesh *m = box_mesh(CT_HEX8, -1, 0, 0, 2, 0.3, 0.3, 6, 1, 1);
  add_body(scene, "bar", m, &SOFT, CT_KERNEL_AUTO, 0, -0.01, -0.3);
  for (int i = 0; i < 2; i++) {
    ct_obstacle_def o = ct_obstacle_def_default();
    int32_t *faces = integers(64), ends = 0;
    o.shape = CT_OBSTACLE_PLANE, o.kind = CT_Q4, o.faces = faces, o.epsilon = 120.0;
    o.restitution = 1.0, o.travel_time = 0.3;
    o.face_count = ct_mesh_plane_faces(m, 2 - i, 0.0, faces, NULL);
    for (int32_t f = 0; i == 0 && f < o.face_count; f++)
      if (fabs(m->nodes[3 * faces[4 * f]] + m->nodes[3 * faces[4 * f + 2]]) > 1.5)
        memmove(&faces[4 * ends++], &faces[4 * f], 4 * sizeof *faces);
    if (i == 0) o.face_count = ends;
    o.axis[0] = 0.0, o.axis[1] = i, o.axis[2] = 1 - i;
    o.point[1] = -0.02 * i, o.point[2] = -0.6 * (1 - i);
    add_made(scene, ct_obstacle_create_effect, &o);
  }
  ct_stable_step stable;
  return build(scene, (ct_scene_time){.end = 3.0, .fraction = 0.6}, steps, &stable);
}

/* What the solver keeps of rows from step to step changes no bit: two runs, of a bar that slopes to
 * the one side or the other, end as they do if one state takes their steps in turn. Then the rows
 * of both are as many, but others. */
static void rows_that_stay(void)
{
  int64_t steps;
  const ct_problem *p = along_a_wall(&steps);
  const size_t size = 3 * (size_t)p->node_count * sizeof(double);
  ct_state *run[2], *apart[2], *one = new_state(p);
  for (int i = 0; i < 2; i++) {
    apart[i] = new_state(p), run[i] = new_state(p);
    for (int32_t n = 0; n < p->node_count; n++) {
      const double slope = i == 0 ? 0.6 : -0.6, *x = &p->reference[3 * n];
      apart[i]->displacement[3 * n] = slope * x[2]; // no strain
      apart[i]->displacement[3 * n + 2] = -slope * x[0];
    }
    must(ct_state_copy, p, apart[i], run[i]);
    advance(p, run[i], steps);
  }
  for (int64_t n = 0; n < 2 * steps; n++) {
    must(ct_state_copy, p, apart[n % 2], one);
    advance(p, one, 1);
    must(ct_state_copy, p, one, apart[n % 2]);
  }
  for (int i = 0; i < 2; i++)
    tap_ok(memcmp(run[i]->displacement, apart[i]->displacement, size) == 0,
           "a run beside a wall has the bits of single steps between those of another");
}

/* At t = 0 forces are first solved for without the motion of the obstacle (eq:reserve-start); and
 * on a curved obstacle gaps are not linear, so points owe energy (eq:impact-debt). */
static void no_growth_on_obstacles(void)
{
  double leaving = 0.0, curved = 0.0;
  for (int i = 0; i < 3; i++) {
    const double radius = 0.02 * pow(3.0, i);
    leaving = fmax(leaving, growth_on_a_cylinder(radius, 0.0, 0.08, -0.12));
    curved = fmax(curved, growth_on_a_cylinder(radius, 1e-3, 0.32, 0.0));
  }
  tap_ok(leaving < 1e-12, "an obstacle that leaves at t = 0: the total grows by %.1e", leaving);
  tap_ok(curved < 1e-12, "cylinders of radius 0.02 ... 0.18: the total grows by %.1e", curved);
}

enum { MANY = 4003 };

/* A row in a random phase of an impact. */
static ct_constraint random_row(void)
{
  const double time[] = {0.0, 1.0, 1.5, 2.0, 40.0};
  return (ct_constraint){.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                         .stiffness = pow(10.0, uniform(3.0)),
                         .dissipation = 0.15 * pick(2),
                         .restitution = 0.5 * pick(3),
                         .travel_time = 1.0,
                         .gap = uniform(1.0),
                         .moved = uniform(1.0),
                         .came = uniform(1.0),
                         .before = uniform(1.0),
                         .after = uniform(1.0),
                         .force = pick(4) ? between(0.0, 2.0) : 0.0,
                         .impact = {.reserve = pick(4) ? between(-0.5, 1.0) : 0.0,
                                    .pressed = time[pick(5)] + pick(2) * between(0.0, 0.2),
                                    .idle = time[pick(5)] + pick(2) * between(0.0, 0.2),
                                    .stored = between(0.0, 1.0),
                                    .release = pick(2) ? between(0.0, 0.3) : 0.0}};
}

/* Numbers of rows that are computed together. */
typedef struct together {
  ct_constraint row[MANY], *place[MANY];
  double bound[MANY], alone[MANY], after[MANY], x[MANY];
  double C[MANY], b[MANY], opens[MANY], loss[MANY];
} together;

/* The rows one by one; returns how many differ from those computed together, in any bit. `opened`
 * counts those that open. */
static int differing(const together *t, const ct_constraint *start, double dt, int *opened)
{
  int wrong = 0;
  for (int r = 0; r < MANY; r++) {
    ct_constraint c = start[r];
    c.dashpot = ct_law_dashpot(&c, t->bound[r] / 0.5);
    const ct_ramp ramp = ct_law_ramp(&c);
    c.after = t->after[r];
    const int opens =
        t->bound[r] > 0.0 && ct_law_releases(&c, t->bound[r], dt, t->alone[r], 0, 0.0);
    const double loss = ct_law_loss(&c, c.force, t->after[r]);
    wrong += ramp.C != t->C[r] || ramp.b != t->b[r] || opens != (t->opens[r] != 0.0) ||
             loss != t->loss[r];
    ct_law_settle(&c, dt, t->x[r], t->alone[r] < 0.0);
    wrong += memcmp(&c, &t->row[r], sizeof c) != 0;
    *opened += opens;
  }
  return wrong;
}

/* Rows that are computed together have the bits of single ones. */
static void rows_together(void)
{
  static together t;
  static ct_constraint start[MANY];
  ct_constraint *place[MANY];
  ct_law_rows rows = {0};
  ct_pool pool = {0};
  const double dt = 0.25;
  int opened = 0;
  for (int r = 0; r < MANY; r++) {
    t.row[r] = start[r] = random_row(), t.place[r] = &t.row[r];
    t.bound[r] = pick(8) ? pow(10.0, uniform(2.0)) : 0.0;
    t.alone[r] = uniform(1.0), t.after[r] = uniform(1.0), t.x[r] = uniform(1.0);
  }
  ct_law_rows_create(&pool, MANY, place, &rows);
  ct_law_rows_read(&rows, t.place, 0, MANY, 0);
  for (int r = 0; r < MANY; r++) rows.before[r] = t.row[r].before, rows.after[r] = t.after[r];
  ct_law_fix(&rows, t.bound, 0.5, t.C, t.b);
  ct_law_find_releases(&rows, t.bound, dt, t.alone, 0, NULL, t.opens);
  ct_law_losses(&rows, rows.force, t.after, t.loss);
  ct_law_settle_all(&rows, dt, t.x, t.alone, 0);
  ct_law_rows_write(&rows);
  const int wrong = differing(&t, start, dt, &opened);
  tap_ok(wrong == 0 && opened > 100, "%d rows together have the bits of single ones, %d open", MANY,
         opened);
  ct_pool_empty(&pool);
}

/* What the points of a block of hex20 hold that touches a plane at t = 0, half a step later. */
static double first_reserve(double tolerance, double beta)
{
  ct_scene *scene = new_scene();
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 2);
  int32_t *faces = integers(80);
  add_body(scene, "block", m, &SOFT, CT_KERNEL_AUTO, 0, 0, -0.02);
  ct_obstacle_def o = ct_obstacle_def_default();
  o.shape = CT_OBSTACLE_PLANE, o.epsilon = 2.0 * beta, o.axis[2] = 1.0;
  o.restitution = 1.0, o.travel_time = 0.5;
  o.kind = CT_Q8, o.face_count = ct_mesh_plane_faces(m, 2, 0.0, faces, NULL), o.faces = faces;
  add_made(scene, ct_obstacle_create_effect, &o);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p =
      build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.6, .force_tolerance = tolerance},
            &steps, &stable);
  ct_state *state = new_state(p);
  const double reserve = energy_of(p, state).reserve;
  return reserve;
}

/* The forces of t = 0 act for half a step, which the losses of rows do not know: they are tight,
 * whatever the tolerance (eq:reserve-start, eq:energy-stop). */
static void tight_start(void)
{
  double off = 0.0, least = HUGE_VAL;
  for (double beta = 1.0; beta < 200.0; beta *= 3.0) {
    const double tight = first_reserve(1e-10, beta);
    off = worst(off, first_reserve(1e-2, beta) / tight - 1.0), least = fmin(least, tight);
  }
  tap_ok(off < 1e-12 && least > 0.0,
         "a block that touches a plane at t = 0, tolerance 0.01: holds what it holds with 1e-10, "
         "off by %.1e",
         off);
}

/* A body that lands askew on a plane, or on another body, with friction; at `to` are the numbers of
 * their nodes in the order of the base meshes. */
typedef struct landing {
  ct_brick_kind kind;
  int on_plane;
  double friction;
} landing;

static void add_floor(ct_scene *scene, const landing *l, const ct_mesh *mesh)
{
  ct_effect *plane, *friction;
  int32_t *faces = integers(8 * 6 * mesh->element_count);
  const ct_problem *joined = join_scene(scene);
  ct_obstacle_def o = ct_obstacle_def_default();
  o.shape = CT_OBSTACLE_PLANE, o.epsilon = 80.0, o.axis[2] = 1.0, o.point[2] = 0.99;
  o.travel_time = 0.3;
  o.kind = l->kind == CT_HEX8 ? CT_Q4 : CT_Q8;
  o.face_count = ct_mesh_plane_faces(mesh, 2, 1.0, faces, NULL), o.faces = faces;
  must(ct_obstacle_create_effect, &o, joined, &plane);
  must(ct_scene_add_effect, scene, plane);
  if (l->friction > 0.0) {
    ct_friction_def f = ct_friction_def_default();
    f.on = plane, f.coefficient = l->friction;
    must(ct_friction_create_effect, &f, joined, &friction);
    must(ct_scene_add_effect, scene, friction);
  }
}

/* Displacements and velocities of all nodes after the impact, in the order of their numbers, and
 * what contacts held at most over the energy at the start. */
static double *land(const landing *l, ct_mesh *const mesh[2], int32_t *count, double *held)
{
  ct_scene *scene = new_scene_with("top", mesh[0], &SOFT, CT_KERNEL_AUTO, 0.05, 0.02, -0.1);
  if (l->on_plane) add_floor(scene, l, mesh[0]);
  else {
    add_body(scene, "low", mesh[1], &SOFT, CT_KERNEL_AUTO, 0.0, 0.0, 0.05);
    add_contact_with(scene, 0, mesh[0], 1.0, 1, mesh[1], 0.99, 2, 40.0,
                     ct_contact_options_default(), l->friction, 1.0);
  }
  int64_t steps;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 4.0, .fraction = 0.8}, &steps, NULL);
  ct_state *state = new_state(p);
  const double start = energy_of(p, state).total;
  for (int64_t i = 0; i < steps; i++) {
    advance(p, state, 1);
    *held = fmax(*held, energy_of(p, state).reserve / start);
  }
  *count = p->node_count;
  const size_t size = 3 * (size_t)*count;
  double *motion = numbers(2 * (int64_t)size);
  memcpy(motion, state->displacement, size * sizeof *motion);
  memcpy(motion + size, state->velocity, size * sizeof *motion);
  return motion;
}

/* Numbers of nodes and elements of both bodies do not change the motion, by no bit, although points
 * hold energy and give it back. */
static void shuffled(landing l)
{
  ct_mesh *mesh[2] = {box_mesh(l.kind, 0, 0, 1, 1, 1, 2, 3, 3, 2),
                      box_mesh(l.kind, -0.13, -0.21, 0, 1.17, 1.31, 0.99, 4, 4, 2)},
          *other[2];
  int32_t count, *to = integers(mesh[0]->node_count + mesh[1]->node_count);
  double held = 0.0, *first = land(&l, mesh, &count, &held), off = 0.0;
  for (int turn = 0; turn < 3; turn++) {
    int32_t *own = to;
    for (int b = 0; b < 2; own += mesh[b++]->node_count) other[b] = shuffle_mesh(mesh[b], own);
    for (int32_t n = mesh[0]->node_count; n < count; n++) to[n] += mesh[0]->node_count;
    double *now = land(&l, other, &count, &held);
    off = fmax(off, apart(first, now, to, count));
    off = fmax(off, apart(first + 3 * (int64_t)count, now + 3 * (int64_t)count, to, count));
  }
  tap_ok(off == 0.0 && held > 0.01,
         "%s on a %s, friction %g: with shuffled numbers the same motion (off by %.1e), points "
         "held %.2f of the energy",
         l.kind == CT_HEX8 ? "hex8" : "hex20", l.on_plane ? "plane" : "body", l.friction, off,
         held);
}

int main(void)
{
  free_at_end();
  tangent();
  for (double k = 1e3; k < 2e7; k *= 10.0) bouncing_mass(1.0, k);
  bouncing_mass(0.25, 1e5);
  bouncing_mass(0.0, 1e5);
  few_layers();
  faces_of_eight_nodes(1, 0.995);
  faces_of_eight_nodes(4, 0.995);
  soft_on_stiff(0.3);
  soft_on_stiff(0.9);
  short_travel_time();
  tilted_bar(0.35);
  tilted_bar(0.785);
  no_growth_on_obstacles();
  rows_that_change();
  rows_that_stay();
  rows_together();
  tight_start();
  for (int i = 0; i < 8; i++)
    shuffled((landing){i & 1 ? CT_HEX20 : CT_HEX8, i >> 1 & 1, i >> 2 ? 0.3 : 0.0});
  return tap_done();
}
