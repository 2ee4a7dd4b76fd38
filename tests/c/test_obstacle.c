/* Rigid obstacles: gaps against closed forms, forces against the energy, work of motion,
 * depth, friction. */
#include "../../libcontact/src/contact/obstacle.h"
#include "../../libcontact/src/effect/contact.h"
#include "bodies.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.0, .density = 1.0};

/* A box against an obstacle at one of its planes, with room for further effects. */
typedef struct against {
  ct_mesh *mesh;
  ct_scene *scene;
  const ct_problem *problem;
  ct_stable_step stable;
  ct_state *state;
} against;

static against begin(ct_mesh *mesh, const ct_material *material, double vx, double vy, double vz)
{
  against t = {.mesh = mesh, .scene = new_scene()};
  add_body(t.scene, "body", mesh, material, CT_KERNEL_AUTO, vx, vy, vz);
  return t;
}

/* Add an obstacle against the faces in x[axis] = at, or with axis -1 against all outer faces; with
 * friction if mu is not 0. */
static void add_obstacle(against *t, ct_obstacle_def o, int axis, double at, double mu)
{
  ct_effect *effect = NULL, *friction = NULL;
  int32_t *faces = integers(8 * 6 * t->mesh->element_count);
  const ct_problem *joined;
  must(ct_scene_join, t->scene, &joined);
  o.kind = ct_brick_face_kind(t->mesh->kind);
  o.face_count = axis < 0 ? ct_mesh_outer_faces(t->mesh, faces, NULL)
                          : ct_mesh_plane_faces(t->mesh, axis, at, faces, NULL);
  o.faces = faces;
  must(ct_obstacle_create_effect, &o, joined, &effect);
  must(ct_scene_add_effect, t->scene, effect);
  if (mu != 0.0) {
    ct_friction_def f = {COOKIE, .tangent = 1.0, .on = effect, .coefficient = mu};
    must(ct_friction_create_effect, &f, joined, &friction);
    must(ct_scene_add_effect, t->scene, friction);
  }
}

static void finish(against *t, double end, double fraction)
{
  t->problem = build(t->scene, (ct_scene_time){.end = end, .fraction = fraction}, NULL, &t->stable);
  t->state = new_state(t->problem);
}

/* Operations of a plane obstacle with the explicit penalty, counted by hand on Q4 faces per point
 * and node. */
static void operations(void)
{
  enum { NODES = 4, COMPONENTS = 3 };
  const int place = COMPONENTS * (2 * NODES + NODES - 1), gap = 3 + 2, force = 3 + 2 * 3;
  const int cut = 7, spread = NODES * COMPONENTS * (1 + cut), reaction = COMPONENTS * cut,
            node = 2 * COMPONENTS;
  for (int32_t n = 1; n < 20; n += 9) {
    against t =
        begin(box_mesh(CT_HEX8, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, n, n, n), &SOFT, 0.0, 0.0, 0.0);
    add_obstacle(&t,
                 (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0.0, 0.0, 1.0},
                                   .epsilon = 900.0},
                 2, 0.0, 0.0);
    finish(&t, 1.0, 0.5);
    double points = 4.0 * n * n, nodes = (n + 1.0) * (n + 1.0);
    double counted = (place + gap + force + spread + reaction) * points + node * nodes;
    tap_ok(fabs(t.problem->effects[1]->cost.flops / counted - 1.0) < 0.1,
           "%d faces: %g operations, %g by hand", (int)(n * n), t.problem->effects[1]->cost.flops,
           counted);
    tap_ok(t.problem->effects[1]->cost.bytes > 8.0 * (COMPONENTS * nodes * 4.0 + points),
           "and it reads its nodes and writes its points");
  }
}

/* The bound of the largest ω² for blocks of one element: each corner has a quarter of the face and
 * an eighth of the mass, and shape functions of linear faces add up to 1 (eq:obstacle-bound). A
 * small sphere adds the whole face, a large one nothing, however the block is turned about z
 * (eq:station-needed, eq:station-bound). */
static void stiffness(ct_obstacle_shape shape, double radius, double angle, double faces)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 1, 1, 1);
  for (double *x = mesh->nodes; x < mesh->nodes + 3 * mesh->node_count; x += 3) {
    const double X = x[0];
    x[0] = cos(angle) * X - sin(angle) * x[1];
    x[1] = sin(angle) * X + cos(angle) * x[1];
  }
  against t = begin(mesh, &SOFT, 0.0, 0.0, 0.0);
  add_obstacle(&t,
               (ct_obstacle_def){COOKIE, .shape = shape, .point = {0.5, 1.0, -radius},
                                 .axis = {0, 0, 1}, .radius = radius, .epsilon = 700.0},
               2, 0.0, 0.0);
  finish(&t, 1.0, 0.5);
  double omega2 = 0.0;
  const ct_effect *effect = t.problem->effects[1];
  ct_view view = {.time = 0.0};
  must(effect->calls->create_scratch, effect, &view.scratch);
  must(effect->calls->bounds.omega2, effect, &view, &omega2);
  effect->calls->free_scratch(view.scratch);
  tap_close(omega2 / (700.0 * 2.0 / (6.0 * SOFT.density / 8.0)), faces, 1e-14,
            "largest omega^2 of one face turned by %g, R = %g", angle, radius);
}

/* Signed distance of a point from an obstacle at t = 0. */
static double gap_of(const ct_obstacle_def *o, const double p[3], double n[3])
{
  const ct_obstacle_kind *kind = ct_obstacle_kind_of(o->shape);
  ct_obstacle_def at = *o;
  if (kind->direction != NULL) (void)ct_obstacle_axis(o->axis, at.axis);
  const double r[3] = {p[0] - o->point[0], p[1] - o->point[1], p[2] - o->point[2]};
  return kind->gap(at.radius, at.axis, r, n);
}

/* eq:obstacle-gap, eq:obstacle-motion; shapes in the words of a scene. */
static void gaps(void)
{
  double n[3], p[3] = {3.0, 4.0, 7.0};
  ct_obstacle_def plane = ct_obstacle_def_plane((double[3]){0, 0, 1}, (double[3]){0, 0, 2}),
                  ball = ct_obstacle_def_sphere((double[3]){0, 0, 7}, 2.0),
                  pipe =
                      ct_obstacle_def_cylinder((double[3]){0, 0, 100}, (double[3]){0, 0, -3}, 6.0);
  tap_ok(gap_of(&plane, p, n) == 6.0 && n[2] == 1.0, "plane: height over it");
  p[2] = -1e6;
  tap_ok(gap_of(&plane, p, n) == -1e6 - 1.0 && n[2] == 1.0, "plane: a point deep inside is inside");
  p[2] = 7.0;
  tap_close(gap_of(&ball, p, n), 3.0, 1e-15, "sphere: outside");
  tap_ok(fabs(n[0] - 0.6) < 1e-15 && fabs(n[1] - 0.8) < 1e-15 && n[2] == 0.0,
         "sphere: normal away from the centre");
  tap_close(gap_of(&pipe, p, n), -1.0, 1e-15, "cylinder: inside, wherever along the axis");
  tap_ok(fabs(n[0] - 0.6) < 1e-15 && fabs(n[1] - 0.8) < 1e-15 && n[2] == 0.0,
         "cylinder: normal away from the axis");
  double time[2] = {1.0, 2.0}, value[2] = {0.0, 1.0}, m[3];
  ct_obstacle_def moving = {COOKIE, .velocity = {0, 1, 0}, .travel = {0, 0, 4},
                            .amplitude = {2, time, value}};
  const double at[5][3] = {{0.0, 0, 0}, {1.0, 1, 0}, {1.5, 1.5, 2}, {2.0, 2, 4}, {9.0, 9, 4}};
  int off = 0;
  for (int i = 0; i < 5; i++)
    ct_obstacle_motion(&moving, at[i][0], m),
        off += m[0] != 0.0 || m[1] != at[i][1] || m[2] != at[i][2];
  tap_ok(off == 0, "motion by a velocity and an amplitude (%d off)", off);
}

/* Force against central differences of the energy, on a distorted body that is partly inside.
 * (eq:obstacle-potential, eq:obstacle-force) */
static void gradient(ct_brick_kind kind, ct_obstacle_def o, const char *name)
{
  ct_mesh *mesh = box_mesh(kind, -0.5, -0.5, 0, 1, 1, 1, 2, 2, 1);
  distort_inside(mesh, 0.05);
  against t = begin(mesh, &SOFT, 0, 0, 0);
  o.epsilon = 100.0;
  add_obstacle(&t, o, 2, 0.0, 0.0);
  finish(&t, 1.0, 0.5);
  const ct_effect *e = t.problem->effects[1];
  int64_t n = 3 * (int64_t)t.problem->node_count;
  double *u = numbers(n), *f = numbers(n), *scrap = numbers(n), off = 0.0, above, below, h = 1e-6,
         *memory = numbers(e->memory_count), *next = numbers(e->memory_count);
  void *scratch;
  must(e->calls->create_scratch, e, &scratch);
  for (int64_t i = 0; i < n; i++) u[i] = uniform(0.05);
  ct_view view = {.reference = t.problem->reference,
                  .displacement = u,
                  .velocity = u,
                  .memory = memory,
                  .next_memory = next,
                  .scratch = scratch};
  must(e->calls->force, e, &view, f);
  double size = largest(f, 3 * e->node_count);
  for (int32_t i = 0; i < 3 * e->node_count; i++) {
    double *at = &u[3 * e->nodes[i / 3] + i % 3], was = *at;
    *at = was + h;
    must(e->calls->force, e, &view, scrap);
    must(e->calls->energy, e, &view, &above);
    *at = was - h;
    must(e->calls->force, e, &view, scrap);
    must(e->calls->energy, e, &view, &below);
    *at = was;
    off = worst(off, (above - below) / (2 * h) + f[i]);
  }
  tap_ok(size > 0.0 && off < 1e-8 * size, "%s: force is minus the gradient of the energy (%.2g)",
         name, off / size);
  e->calls->free_scratch(scratch);
}

/* A wall with a velocity meets a bar at rest: the same impact in another frame. Its work is
 * external, and the total is constant. (eq:obstacle-motion, eq:obstacle-work) */
static void moving_wall(int amplitude)
{
  double times[2] = {0.0, 2.0}, share[2] = {0.0, 1.0}, force[3], work, drift = 0.0, balance = 0.0;
  ct_obstacle_def o = {COOKIE,
                       .shape = CT_OBSTACLE_PLANE,
                       .axis = {1, 0, 0},
                       .epsilon = ct_contact_penalty(1.0, 900.0, 0.2),
                       .velocity = {amplitude ? 0.0 : 10.0, 0, 0},
                       .travel = {amplitude ? 20.0 : 0.0, 0, 0},
                       .amplitude = {amplitude ? 2 : 0, times, share}};
  against t = begin(box_mesh(CT_HEX8, 5, 0, 0, 10, 0.1, 0.1, 50, 1, 1), &SOFT, 0, 0, 0);
  add_obstacle(&t, o, 0, 5.0, 0.0);
  finish(&t, 1.5, 0.4);
  while (t.state->time < 1.5 - 1e-9) {
    advance(t.problem, t.state, 1);
    ct_energy e = energy_of(t.problem, t.state);
    drift = worst(drift, e.total), balance = worst(balance, e.balance);
  }
  ct_energy e = energy_of(t.problem, t.state);
  must(ct_obstacle_reaction, t.problem, t.state, 1, force, &work);
  // Mass 0.1 leaves with 20: 20 units of energy, and the wall at 10 has given an impulse of 2.
  tap_close(momentum_of(t.problem, t.state, 0).p[0] / 0.1, 20.0, 0.2,
            "%s: the bar leaves with twice the wall's velocity",
            amplitude ? "amplitude" : "velocity");
  tap_close(work, 20.0, 0.2, "the wall's work is its impulse times its velocity");
  tap_ok(e.external == work && drift < 0.005 * 20.0,
         "it counts as external, and the total is constant (%.2g)", drift / 20.0);
  tap_ok(balance < 1e-12 * 20.0, "work balance %.2g", balance / 20.0);
}

/* A plane whose velocity changes beneath a block, all of whose points stay near: with the rows of
 * the next gaps its work is all that the total gains. (eq:obstacle-work, eq:energy-controlled) */
static void shaken(double restitution)
{
  double times[5] = {0.0, 0.1, 0.2, 0.3, 0.5}, share[5] = {0.0, 0.1, 0.3, 0.8, 0.9};
  ct_obstacle_def o = {COOKIE,
                       .shape = CT_OBSTACLE_PLANE,
                       .axis = {0, 0, 1},
                       .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                       .initial_penetration = CT_INITIAL_KEEP,
                       .epsilon = ct_contact_penalty(1.0, 900.0, 0.5),
                       .restitution = restitution,
                       .travel_time = 0.5 / 30.0,
                       .travel = {0, 0, 0.1},
                       .amplitude = {5, times, share}};
  against t = begin(box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2), &SOFT, 0, 0, 0);
  double total = 0.0, growth = 0.0, most = 0.0;
  add_obstacle(&t, o, 2, 0.0, 0.0);
  finish(&t, 0.5, 0.5);
  while (t.state->time < 0.5 - 1e-9) {
    advance(t.problem, t.state, 8);
    const ct_energy e = energy_of(t.problem, t.state);
    growth = fmax(growth, e.total - total), most = fmax(most, e.kinetic);
    total = e.total;
  }
  tap_ok(most > 0.01 && growth < 1e-12 * most && (restitution == 0.0 || total > -1e-3 * most),
         "restitution %g: the total of a shaken block grows by %.2g and loses %.2g", restitution,
         growth / most, -total / most);
}

/* A block that begins far below a plane is pushed out, at any depth. */
static void depth(void)
{
  against t = begin(box_mesh(CT_HEX8, 0, 0, -50, 1, 1, 1, 1, 1, 1), &SOFT, 0, 0, 0);
  double force[3], work;
  add_obstacle(
      &t, (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0, 0, 1}, .epsilon = 2.0},
      2, -50.0, 0.0);
  finish(&t, 1.0, 0.5);
  must(ct_obstacle_reaction, t.problem, t.state, 1, force, &work);
  tap_close(
      force[2], -100.0, 1e-12,
      "a face at a depth of 50, many blocks below the plane, has 50 times the penalty as pressure");
}

/* The three shapes, 0.02 deep in the lower face of a block of 1 with its middle at the origin. */
static ct_obstacle_def shape_beneath(int shape, ct_initial how)
{
  return (ct_obstacle_def){COOKIE,
                           .shape = (ct_obstacle_shape)shape,
                           .point = {0.0, 0.0, shape == 0 ? -0.48 : -3.48},
                           .axis = {shape == 2 ? 1.0 : 0.0, 0.0, shape == 2 ? 0.0 : 1.0},
                           .radius = 3.0,
                           .epsilon = 2e4,
                           .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                           .initial_penetration = how,
                           .removal_time = 0.2};
}

static ct_penetration inside(const against *t, ct_penetration_at at)
{
  ct_penetration found;
  must(ct_obstacle_penetration, t->problem, t->state, 1, at, &found);
  return found;
}

/* A block that overlaps an obstacle at the start: it stays at rest, is pushed with the energy of
 * the penalty, is refused, or is removed by work that counts. (eq:initial-shift, eq:initial-work)
 */
static void overlap(int shape, ct_initial how, const char *name)
{
  against t = begin(box_mesh(CT_HEX8, -0.5, -0.5, -0.5, 1, 1, 1, 4, 4, 3), &SOFT, 0, 0, 0);
  const ct_obstacle_def o = shape_beneath(shape, how);
  add_obstacle(&t, o, 2, -0.5, 0.0);
  ct_scene_time time = {.end = 0.4, .fraction = 0.8};
  ct_error error;
  int64_t steps;
  if (how == CT_INITIAL_REFUSE) {
    tap_ok(ct_scene_build(t.scene, &time, &t.problem, &steps, &t.stable, &error) ==
               CT_ERROR_GEOMETRY,
           "%s, refused: %s", name, error.text);
    return;
  }
  finish(&t, 0.4, 0.8);
  double stored = 0.0, most = 0.0, least = 0.0, n[3];
  const ct_interaction *is = ((const ct_touch *)t.problem->effects[1]->data)->is;
  const ct_side_fixed *side = &((const ct_contact_fixed *)is)->gaps.side[0];
  for (int64_t i = 0; i < side->point_count; i++) {
    double y[3];
    ct_side_interpolate(side->search, side->search->x, (int32_t)(i / side->rule.count),
                        side->N[i % side->rule.count], NULL, y);
    double gap = fmin(gap_of(&o, y, n), 0.0);
    least = fmin(least, gap);
    stored += 0.5 * o.epsilon * side->weight[i] * gap * gap;
  }
  ct_penetration points = inside(&t, CT_AT_POINTS), corners = inside(&t, CT_AT_CORNERS);
  tap_ok(fabs(points.deepest + least) < 1e-12 && points.side == 0 &&
             points.deepest <= corners.deepest + 1e-12 && fabs(corners.deepest - 0.02) < 1e-12,
         "%s: points are %.3g inside, corners %.3g", name, points.deepest, corners.deepest);
  ct_energy e = energy_of(t.problem, t.state);
  tap_close(e.total, how == CT_INITIAL_FORCE ? stored : 0.0, 1e-12 + 5e-4 * stored,
            "%s: the energy at the start", name);
  while (t.state->time < 0.4 - 1e-9) {
    advance(t.problem, t.state, 1);
    e = energy_of(t.problem, t.state);
    most = fmax(most, fabs(e.kinetic) + fabs(e.strain));
  }
  double deepest = inside(&t, CT_AT_POINTS).deepest;
  if (how == CT_INITIAL_KEEP)
    tap_ok(most == 0.0 && e.total == 0.0 && deepest == points.deepest, "%s: it stays at rest",
           name);
  if (how == CT_INITIAL_FORCE)
    tap_ok(e.kinetic + e.strain > 0.03 * stored && e.total < 1.001 * stored,
           "%s: it flies away with %.3g of it", name, (e.kinetic + e.strain) / stored);
  if (how == CT_INITIAL_REMOVE)
    tap_ok(deepest < 1e-3 && e.external > 0.0 && e.kinetic + e.strain < 1.002 * e.external &&
               fabs(e.balance) < 1e-9 * e.external,
           "%s: it is removed with the work %.3g, of which it has %.3g", name, e.external,
           (e.kinetic + e.strain) / e.external);
}

/* A gap that is closed: a block that comes from 0.01 above a plane rebounds there. */
static void adjusted(void)
{
  against t = begin(box_mesh(CT_HEX8, 0, 0, 0.01, 1, 1, 1, 3, 3, 3), &SOFT, 0, 0, -0.2);
  add_obstacle(&t,
               (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0, 0, 1},
                                 .epsilon = 1e6, .adjust = 0.015,
                                 .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                                 .initial_penetration = CT_INITIAL_KEEP},
               2, 0.01, 0.0);
  finish(&t, 0.1, 0.8);
  double lowest = 1.0;
  while (t.state->time < 0.1 - 1e-9) {
    advance(t.problem, t.state, 1);
    for (int32_t n = 0; n < t.problem->node_count; n++)
      lowest = fmin(lowest, t.problem->reference[3 * n + 2] + t.state->displacement[3 * n + 2]);
  }
  tap_ok(lowest > 0.0095 && momentum_of(t.problem, t.state, 0).p[2] > 0.0,
         "a gap within adjust counts as closed: the block comes no nearer than %.4f", lowest);
}

/* A rigid sphere, or a cylinder along y, of radius R that comes down on a free plate of 4 x 4 x 1
 * elements of 0.25 x 0.25 x `thick`, near (x, y). Returns the momentum of the plate at the end. */
static double struck(ct_brick_kind kind, int shape, double radius, double speed, double x, double y,
                     double thick, const char *name)
{
  const ct_material steel = {.young = 1.0, .poisson = 0.3, .density = 1.0};
  against t = begin(box_mesh(kind, -0.5, -0.5, 0, 1, 1, thick, 4, 4, 1), &steel, 0, 0, 0);
  ct_obstacle_def o = {COOKIE,
                       .shape = (ct_obstacle_shape)shape,
                       .point = {x, y, thick + 1.05 * radius},
                       .axis = {0, 1, 0},
                       .radius = radius,
                       .epsilon = 40.0 * 1.35 / fmin(thick, 0.25),
                       .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                       .dissipation = 0.15,
                       .initial_penetration = CT_INITIAL_KEEP,
                       .velocity = {0, 0, -speed}};
  add_obstacle(&t, o, -1, 0.0, 0.0);
  // A thin plate must bend before it moves as a whole.
  const double last = (thick < 0.1 ? 15.0 : 1.5) * (thick + 2.0 * radius) / speed;
  finish(&t, last, 0.5);
  double most = 0.0, grown = 0.0, balance = 0.0;
  int64_t unconverged = 0;
  while (t.state->time < last - 1e-9 * last) {
    advance(t.problem, t.state, 1);
    ct_energy e = energy_of(t.problem, t.state);
    most = fmax(most, fmax(e.kinetic + e.strain, fabs(e.external)));
    grown = fmax(grown, e.kinetic + e.strain - e.external);
    balance = worst(balance, e.balance);
  }
  unconverged = t.state->unconverged;
  double p = momentum_of(t.problem, t.state, 0).p[2];
  tap_ok(most > 0.0 && grown <= 2e-3 * most && balance < 1e-9 * most && unconverged == 0,
         "%s: bodies gain %.1e over the work, balance %.1e", name, grown / most, balance / most);
  return p;
}

/* Small obstacles pass neither between the points of a face nor through a thin plate.
 * (eq:station-gap, eq:station-axis) */
static void small(void)
{
  static const double AT[4][2] = {{0.0, 0.0}, {0.125, 0.125}, {0.1, 0.06}, {0.03, -0.11}};
  for (int i = 0; i < 4; i++)
    for (int kind = 0; kind < 2; kind++) {
      double p = struck(kind ? CT_HEX20 : CT_HEX8, 1, 0.05, 0.01, AT[i][0], AT[i][1], 0.25,
                        "small sphere");
      tap_ok(p < -0.01 * 0.25 && p > -2.0 * 0.01 * 0.25,
             "a sphere of R = h/5 at (%g, %g) throws the plate away with %.2f of its speed",
             AT[i][0], AT[i][1], -p / (0.25 * 0.01));
    }
  for (int i = 0; i < 4; i++) {
    double p = struck(CT_HEX8, 2, 0.0125, 0.01, AT[i][0], 0.0, 0.25, "thin cylinder");
    tap_ok(p < -0.01 * 0.25, "a cylinder of R = h/20 as well, with %.2f", -p / (0.25 * 0.01));
    p = struck(CT_HEX8, 1, 0.0125, 0.1, AT[i][0], AT[i][1], 0.05, "thin plate");
    tap_ok(p < -0.1 * 0.05, "a sphere of R = h/20 a thin plate, with %.2f", -p / (0.05 * 0.1));
  }
  double left = struck(CT_HEX8, 1, 0.04, 0.02, 0.1, 0.07, 0.2, "a sphere"),
         right = struck(CT_HEX8, 1, 0.04, 0.02, -0.1, 0.07, 0.2, "its mirror image");
  tap_ok(left == right, "mirror images have the same bits (%.17g)", left);
}

/* An obstacle that moves too far in a step is refused, whatever its size. (eq:tunnelling) */
static void too_far(double radius)
{
  against t = begin(box_mesh(CT_HEX8, -0.5, -0.5, -0.25, 1, 1, 0.25, 4, 4, 1), &SOFT, 0, 0, 0);
  ct_error error = {0};
  add_obstacle(&t,
               (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_SPHERE, .radius = radius,
                                 .point = {0, 0, 1.01 * radius}, .velocity = {0, 0, -9e3},
                                 .epsilon = 100.0, .initial_penetration = CT_INITIAL_KEEP,
                                 .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
               -1, 0.0, 0.0);
  finish(&t, 1.0, 0.9);
  ct_status status = CT_OK;
  for (int i = 0; i < 3 && status == CT_OK; i++) status = ct_step(t.problem, t.state, &error);
  tap_ok(status == CT_ERROR_STEP, "R = %g: %s", radius, error.text);
}

/* A block that slides strikes a plane: as long as all points slip, friction is mu times the whole
 * normal force, also that with which a point gives back what its impact took, so the tangential
 * impulse is mu times the normal one, mu m (1 + e) v_n. (eq:slip-set, eq:release-ramp) */
static void gross_slip(double restitution, double least)
{
  const double mu = 0.2, vx = 3.0, vz = 0.3, mass = 0.3;
  against t = begin(box_mesh(CT_HEX8, 0, 0, 0.01, 1, 1, 0.3, 4, 3, 2), &SOFT, vx, 0, -vz);
  add_obstacle(&t,
               (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0, 0, 1},
                                 .epsilon = ct_contact_penalty(40.0, 900.0, 0.15),
                                 .dissipation = 0.15, .restitution = restitution,
                                 .travel_time = 0.15 / 30.0,
                                 .enforcement = CT_ENFORCE_ENERGY_CONTROLLED},
               2, 0.01, mu);
  finish(&t, 0.2, 0.9);
  while (t.state->time < 0.2) advance(t.problem, t.state, 1);
  const ct_momentum p = momentum_of(t.problem, t.state, 0);
  const double e = p.p[2] / (mass * vz), lost = mass * vx - p.p[0];
  tap_ok(e > least && e <= 1.0, "a sliding block strikes, restitution %g: e = %.3f", restitution,
         e);
  tap_close(lost, mu * mass * (1.0 + e) * vz, 1e-12,
            "restitution %g: it loses the momentum mu m (1 + e) v_n along the plane", restitution);
}

/* Mirrored scenes have mirrored bits, with friction on a moving sphere, large or small. The faces
 * of a mirrored mesh are numbered in another order. (eq:station-bound) */
static void mirrored(double radius)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0.05, 0.1, 0, 1, 1, 0.5, 3, 3, 1);
  distort(mesh, 0.03);
  ct_mesh *image = mirror_mesh(mesh, 0);
  against t[2] = {begin(mesh, &SOFT, 0.3, 0.1, 0.0), begin(image, &SOFT, -0.3, 0.1, 0.0)};
  for (int k = 0; k < 2; k++) {
    double sign = k == 0 ? 1.0 : -1.0;
    ct_obstacle_def o = {COOKIE,
                         .shape = CT_OBSTACLE_SPHERE,
                         .point = {sign * 0.4, 0.6, 0.1 - radius},
                         .radius = radius,
                         .epsilon = 500.0,
                         .velocity = {sign * 0.2, 0.0, 0.5}};
    add_obstacle(&t[k], o, -1, 0.0, 0.4);
    finish(&t[k], 0.5, 0.5);
    advance(t[k].problem, t[k].state, 40);
  }
  int64_t faults =
      mirror_faults(t[0].state->velocity, t[1].state->velocity, t[0].problem->node_count, 0);
  tap_ok(faults == 0 && fabs(t[0].state->velocity[2]) > 0.0,
         "sphere of %g, mirrored: mirrored bits (%d off)", radius, (int)faults);
}

/* A box that stands in a plane by `depth` has the traction of the explicit penalty at every node of
 * its face; of any shape, areas times tractions are the force on the obstacle, turned round. */
static void tractions(ct_brick_kind kind)
{
  const double depth = 0.01, epsilon = 100.0;
  ct_mesh *mesh = box_mesh(kind, 0, 0, -depth, 1, 1, 1, 3, 2, 1);
  against t = begin(mesh, &SOFT, 0, 0, 0);
  ct_obstacle_def o = {COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0, 0, 1}, .epsilon = epsilon,
                       .enforcement = CT_ENFORCE_PENALTY};
  add_obstacle(&t, o, 2, -depth, 0.0);
  finish(&t, 1.0, 0.5);
  const ct_effect *e = t.problem->effects[1];
  int nodes = t.problem->node_count;
  double *traction = numbers(3 * nodes), *area = numbers(nodes), off = 0.0, sum[3] = {0},
         reaction[3], work;
  ct_error error;
  must(ct_obstacle_traction, t.problem, t.state, 1, traction, area);
  for (int i = 0; i < e->node_count; i++)
    off = worst(off, traction[3 * e->nodes[i] + 2] - epsilon * depth);
  double *pressure = numbers(nodes), elsewhere = 0.0;
  must(ct_state_pressure, t.problem, t.state, pressure);
  for (int i = 0; i < nodes; i++)
    if (mesh->nodes[3 * i + 2] == -depth) off = worst(off, pressure[i] - epsilon * depth);
    else elsewhere = worst(elsewhere, pressure[i]);
  tap_ok(elsewhere == 0.0 && off < 1e-13 * epsilon * depth,
         "%s in a plane: traction and pressure of the penalty, off by %.2g",
         kind == CT_HEX8 ? "hex8" : "hex20", off / (epsilon * depth));
  ct_state *shaken = NULL;
  must(ct_state_create, t.problem, &shaken);
  for (int i = 0; i < 3 * nodes; i++) shaken->displacement[i] = uniform(0.02);
  shaken->step++; // so that forces are computed anew
  must(ct_obstacle_traction, t.problem, shaken, 1, traction, area);
  must(ct_obstacle_reaction, t.problem, shaken, 1, reaction, &work);
  for (int i = 0; i < nodes; i++)
    for (int c = 0; c < 3; c++) sum[c] += area[i] * traction[3 * i + c];
  tap_ok(fabs(sum[2] + reaction[2]) < 1e-12 * sum[2] && largest(sum, 2) == 0.0,
         "%s, distorted: all of the force on the obstacle, off by %.2g",
         kind == CT_HEX8 ? "hex8" : "hex20", fabs(sum[2] + reaction[2]) / sum[2]);
  tap_ok(ct_obstacle_traction(t.problem, t.state, 0, traction, area, &error) == CT_ERROR_ARGUMENT &&
             ct_obstacle_traction(t.problem, t.state, 1, NULL, area, &error) == CT_ERROR_ARGUMENT,
         "refused: %s", error.text);
  free_state(shaken);
}

/* A box falls into a plane in any direction, to any depth: no traction of a node is larger than
 * that of the deepest point, also on walls, whose forces do not face them; and the force is kept.
 * (eq:recovered-fraction) */
static void bound(ct_brick_kind kind)
{
  const double epsilon = 100.0;
  ct_mesh *mesh = box_mesh(kind, -0.5, -0.5, -0.5, 1, 1, 1, 3, 2, 3);
  against t = begin(mesh, &SOFT, 0, 0, 0);
  ct_obstacle_def o = {COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0, 0, 1}, .epsilon = epsilon,
                       .enforcement = CT_ENFORCE_PENALTY};
  add_obstacle(&t, o, -1, 0.0, 0.0);
  finish(&t, 1.0, 0.5);
  int nodes = t.problem->node_count;
  double *traction = numbers(3 * nodes), *area = numbers(nodes), top = 0.0, lost = 0.0;
  for (int scene = 0; scene < 40; scene++) {
    double R[3][3], deepest = 0.0, force = 0.0, reaction[3], work, most = 0.0;
    const double height = 0.4 + uniform(0.35);
    ct_state *state = NULL;
    must(ct_state_create, t.problem, &state);
    random_rotation(R);
    state->step++; // so that forces are computed anew
    for (int i = 0; i < nodes; i++) {
      const double *x = &mesh->nodes[3 * i];
      for (int c = 0; c < 3; c++)
        state->displacement[3 * i + c] =
            R[c][0] * x[0] + R[c][1] * x[1] + R[c][2] * x[2] - x[c] + (c == 2 ? height : 0.0);
      deepest = fmax(deepest, -x[2] - state->displacement[3 * i + 2]);
    }
    must(ct_obstacle_traction, t.problem, state, 1, traction, area);
    must(ct_obstacle_reaction, t.problem, state, 1, reaction, &work);
    for (int i = 0; i < nodes; i++) {
      most = fmax(most, traction[3 * i + 2]);
      force += area[i] * traction[3 * i + 2];
    }
    if (deepest > 0.0) top = fmax(top, most / (epsilon * deepest));
    lost = worst(lost, (force + reaction[2]) / epsilon);
    free_state(state);
  }
  tap_ok(top <= 1.0 && top > 0.3 && lost < 1e-13,
         "%s in a plane in any direction: at most %.3g of the largest traction; force lost %.2g",
         kind == CT_HEX8 ? "hex8" : "hex20", top, lost);
}

static void refusals(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  against t = begin(mesh, &SOFT, 0, 0, 0);
  const ct_problem *joined;
  ct_error error;
  ct_effect *effect = NULL;
  int32_t faces[4] = {0, 1, 3, 2}, outside[4] = {0, 1, 3, 88};
  double times[2] = {1.0, 0.0}, share[2] = {0.0, 1.0};
  must(ct_scene_join, t.scene, &joined);
  ct_obstacle_def good = {COOKIE,
                          .shape = CT_OBSTACLE_PLANE,
                          .axis = {0, 0, 1},
                          .epsilon = 1.0,
                          .kind = CT_Q4,
                          .face_count = 1,
                          .faces = faces};
  ct_obstacle_def bad[8] = {good, good, good, good, good, good, good, good};
  bad[0].epsilon = 0.0;
  bad[1].axis[2] = 0.0;
  bad[2].shape = CT_OBSTACLE_SPHERE;
  bad[3].faces = outside;
  bad[4].amplitude = (ct_amplitude){2, times, share};
  bad[5].point[1] = NAN;
  bad[6].axis[0] = NAN;
  bad[7].travel[2] = 1.0;
  for (int i = 0; i < 8; i++)
    tap_ok(ct_obstacle_create_effect(&bad[i], joined, &effect, &error) != CT_OK && effect == NULL,
           "refused: %s", error.text);
  // The middle of the one face stands in the centre of a sphere, where no direction leads out.
  against inner = begin(box_mesh(CT_HEX20, -0.5, -0.5, 0, 1, 1, 1, 1, 1, 1), &SOFT, 0, 0, 0);
  add_obstacle(
      &inner, (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_SPHERE, .radius = 1.0, .epsilon = 1.0},
      2, 0.0, 0.0);
  const ct_problem *problem;
  int64_t steps;
  ct_scene_time time = {.end = 1.0, .fraction = 0.5};
  tap_ok(ct_scene_build(inner.scene, &time, &problem, &steps, &inner.stable, &error) ==
             CT_ERROR_GEOMETRY,
         "refused: %s", error.text);
}

int main(void)
{
  free_at_end();
  operations();
  const double h = sqrt(2.5); // the diagonal of the face over the root of 2
  stiffness(CT_OBSTACLE_PLANE, 0.0, 0.0, 0.25);
  for (int i = 0; i < 2; i++) {
    stiffness(CT_OBSTACLE_SPHERE, 1.49 * h, 0.7 * i, 1.25);
    stiffness(CT_OBSTACLE_SPHERE, 1.51 * h, 0.7 * i, 0.25);
  }
  gaps();
  gradient(CT_HEX8, (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_PLANE, .axis = {0.1, 0.2, 1}},
           "plane, Q4");
  gradient(CT_HEX20,
           (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_SPHERE, .point = {0.1, 0, -0.9},
                             .radius = 1.0},
           "sphere, Q8");
  gradient(CT_HEX8,
           (ct_obstacle_def){COOKIE, .shape = CT_OBSTACLE_CYLINDER, .point = {0, 0.1, -0.95},
                             .axis = {1, 0.3, 0}, .radius = 1.0},
           "cylinder, Q4");
  moving_wall(0);
  moving_wall(1);
  shaken(0.0);
  shaken(1.0);
  depth();
  static const char *const NAMES[] = {"plane", "sphere", "cylinder"};
  for (int shape = 0; shape < 3; shape++)
    for (int how = CT_INITIAL_FORCE; how <= CT_INITIAL_REMOVE; how++)
      overlap(shape, (ct_initial)how, NAMES[shape]);
  adjusted();
  small();
  too_far(0.05);
  too_far(3.0);
  gross_slip(0.0, 0.3);
  gross_slip(1.0, 0.6);
  mirrored(2.0);
  mirrored(0.2);
  tractions(CT_HEX8);
  tractions(CT_HEX20);
  bound(CT_HEX8);
  bound(CT_HEX20);
  refusals();
  return tap_done();
}
