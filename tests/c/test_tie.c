/* Ties between unlike meshes. */
#include "bodies.h"

#include <libcontact/contact_effect.h>

#include "../../libcontact/src/constraint/law.h"

static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};
static const ct_material BAR = {.young = 1.0, .poisson = 0.0, .density = 1.0};

/* The definition of a tie between the faces of two bodies in the planes x = at_a and x = at_b of
 * their meshes. */
static ct_tie_def tie_of(const ct_mesh *a, double at_a, const ct_mesh *b, double at_b)
{
  const ct_mesh *mesh[2] = {a, b};
  const double at[2] = {at_a, at_b};
  ct_tie_def def = {COOKIE, .reach = 0.1};
  for (int s = 0; s < 2; s++) {
    const int per = ct_face_node_count(ct_brick_face_kind(mesh[s]->kind));
    int32_t *faces = integers(6 * 8 * mesh[s]->element_count);
    def.kind[s] = ct_brick_face_kind(mesh[s]->kind);
    def.face_count[s] = ct_mesh_plane_faces(mesh[s], 0, at[s], faces, NULL);
    for (int64_t i = 0; s == 1 && i < (int64_t)def.face_count[s] * per; i++)
      faces[i] += a->node_count;
    def.faces[s] = faces;
  }
  return def;
}

static void add_tie(ct_scene *scene, const ct_mesh *a, const ct_mesh *b, double at, double epsilon)
{
  ct_tie_def def = tie_of(a, at, b, at);
  def.epsilon = epsilon;
  add_made(scene, ct_tie_create_effect, &def);
}

/* A force of a row is -½ k (g_{n+1} + g_{n-1}), of either sign; its work is what its store ½ (Π_n +
 * Π_{n+1}) loses (eq:tie-force, eq:tie-store). */
static void law(void)
{
  double off = 0.0, made = 0.0, start = 0.0;
  for (int trial = 0; trial < 1000; trial++) {
    ct_constraint row = {.enforcement = (ct_enforcement)CT_ENFORCE_TIE,
                         .stiffness = pow(10.0, uniform(3.0)),
                         .before = uniform(1.0),
                         .gap = uniform(1.0),
                         .after = uniform(1.0)};
    const double k = row.stiffness, g0 = row.before, g1 = row.gap, g2 = row.after,
                 force = -0.5 * k * (g2 + g0), last = 0.25 * k * (g0 * g0 + g1 * g1);
    const ct_ramp ramp = ct_law_ramp(&row);
    off = worst(off, (-(g2 + ramp.b) / ramp.C - force) / k);
    off = worst(off, (ct_law_stored(&row) - 0.25 * k * (g1 * g1 + g2 * g2)) / k);
    start = worst(start, (ct_law_start(&row) - 0.5 * k * g1 * g1) / k);
    made = worst(made, (last - ct_law_stored(&row) - 0.5 * force * (g2 - g0)) / k);
    made = worst(made, ct_law_loss(&row, force, g2) / k);
  }
  // Some operations on numbers up to 1.
  tap_close(off, 0.0, 1e-15, "force and store of a row follow from its gaps");
  tap_close(start, 0.0, 1e-15, "at t = 0 the store is that of the gap");
  tap_close(made, 0.0, 1e-15, "the work of a row is what its store loses");
  tap_ok(ct_law_least((ct_enforcement)CT_ENFORCE_TIE) < 0.0 &&
             ct_law_least(CT_ENFORCE_ENERGY_CONTROLLED) == 0.0,
         "a tie pulls, a contact does not");
}

typedef struct glued {
  ct_mesh *a, *b;
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
} glued;

/* Two blocks of different meshes that are glued together at x = 1 and move at random. */
static glued glue(ct_brick_kind kind_a, ct_brick_kind kind_b)
{
  glued g = {box_mesh(kind_a, 0, 0, 0, 1, 1, 1, 2, 2, 2),
             box_mesh(kind_b, 1, 0, 0, 1, 1, 1, 2, 3, 3), new_scene(), NULL, NULL};
  double *v[2] = {numbers(3 * g.a->node_count), numbers(3 * g.b->node_count)};
  random_seed = 88172645463325252ull;
  for (int64_t d = 0; d < 3 * (int64_t)g.a->node_count; d++) v[0][d] = uniform(0.3);
  for (int64_t d = 0; d < 3 * (int64_t)g.b->node_count; d++) v[1][d] = uniform(0.3);
  add_moving_body(g.scene, "a", g.a, &SOFT, CT_KERNEL_AUTO, v[0]);
  add_moving_body(g.scene, "b", g.b, &SOFT, CT_KERNEL_AUTO, v[1]);
  add_tie(g.scene, g.a, g.b, 1.0, 40.0 * 900.0 * 3.0);
  g.problem = build(g.scene, (ct_scene_time){.end = 3.0, .fraction = 0.9, .force_tolerance = 1e-12},
                    NULL, NULL);
  g.state = new_state(g.problem);
  return g;
}

/* Total energy, momentum and angular momentum of two glued blocks stay what they are
 * (eq:tie-gap, eq:tie-stiffness). Rounding adds up over some hundred steps; a force has the
 * tolerance 1e-12. The first step, in which bodies with different velocities collide, does not
 * count.
 */
static void books(ct_brick_kind kind_a, ct_brick_kind kind_b, const char *name)
{
  glued g = glue(kind_a, kind_b);
  double energy = 0.0, momentum = 0.0, balance = 0.0, stored = 0.0;
  advance(g.problem, g.state, 1);
  const ct_energy first = energy_of(g.problem, g.state);
  ct_momentum begin[2], now[2];
  for (int b = 0; b < 2; b++) begin[b] = momentum_of(g.problem, g.state, b);
  double exchanged = 0.0;
  for (int i = 0; i < 200; i++) {
    advance(g.problem, g.state, 1);
    const ct_energy e = energy_of(g.problem, g.state);
    for (int b = 0; b < 2; b++) now[b] = momentum_of(g.problem, g.state, b);
    energy = worst(energy, e.total / first.total - 1.0);
    balance = worst(balance, e.balance / first.total);
    stored = fmax(stored, e.total - e.kinetic - e.strain);
    for (int c = 0; c < 3; c++) {
      const double p = begin[0].p[c] + begin[1].p[c];
      momentum = worst(momentum, now[0].p[c] + now[1].p[c] - p);
      exchanged = worst(exchanged, now[0].p[c] - begin[0].p[c]);
    }
  }
  tap_close(energy, 0.0, 1e-10, "%s: the energy stays", name);
  tap_close(balance, 0.0, 1e-12, "%s: the work balance closes", name);
  tap_close(momentum, 0.0, 1e-13, "%s: the momentum stays", name);
  tap_ok(exchanged > 0.01 && stored > 1e-4 * first.total,
         "%s: the blocks exchange momentum (%.2g), the tie stores energy (%.2g of it)", name,
         exchanged, stored / first.total);
}

/* The stable step is that of the bodies, whatever the stiffness of the tie. */
static void step_of_the_bodies(void)
{
  double dt[2];
  for (int tied = 0; tied < 2; tied++) {
    ct_mesh *a = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 2, 2, 2),
            *b = box_mesh(CT_HEX8, 1, 0, 0, 1, 1, 1, 2, 3, 3);
    ct_scene *scene = new_scene_with("a", a, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
    ct_stable_step stable;
    add_body(scene, "b", b, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
    if (tied) add_tie(scene, a, b, 1.0, 1e9);
    build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.9}, NULL, &stable);
    dt[tied] = stable.dt;
  }
  tap_ok(dt[0] == dt[1] && dt[0] > 0.0, "the step is that of the bodies, %.3g", dt[0]);
}

/* A pulse of eight elements runs through the joint of 8 : 11 cells, as a P wave of a bar; what
 * stays behind in the first block was reflected. The first block of the same mesh as the second
 * keeps what its dispersion leaves behind. */
static double reflected(int cells_b)
{
  ct_mesh *a = box_mesh(CT_HEX8, 0, 0, 0, 3, 1, 1, 24, 8, 8),
          *b = box_mesh(CT_HEX8, 3, 0, 0, 3, 1, 1, 24, cells_b, cells_b);
  ct_scene *scene = new_scene();
  double *v = numbers(3 * a->node_count), *u = numbers(3 * a->node_count);
  for (int32_t n = 0; n < a->node_count; n++) {
    const double x = a->nodes[3 * n], s = 3.14159265358979 * (x - 1.0);
    // u = f(x - t), f = ∫ -1e-3 sin² on 1 < x < 2.
    if (x > 1.0 && x < 2.0) v[3 * n] = 1e-3 * sin(s) * sin(s);
    const double y = fmin(fmax(x, 1.0), 2.0) - 1.0;
    u[3 * n] = 1e-3 * (0.5 - (0.5 * y - sin(6.28318530717959 * y) / 12.5663706143592));
  }
  ct_scene_body first = {
      .name = "a", .mesh = a, .material = BAR, .velocities = v, .displacements = u};
  int32_t number;
  must(ct_scene_add_body, scene, &first, &number);
  add_body(scene, "b", b, &BAR, CT_KERNEL_AUTO, 0, 0, 0);
  add_tie(scene, a, b, 3.0, 40.0 * 11.0);
  int64_t steps;
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 2.8, .fraction = 0.9}, &steps, NULL);
  ct_state *state = new_state(problem);
  advance(problem, state, steps);
  double kinetic[2] = {0.0, 0.0};
  for (int32_t n = 0; n < problem->node_count; n++)
    for (int c = 0; c < 3; c++) {
      const double w = state->velocity[3 * n + c];
      kinetic[n >= a->node_count] += 0.5 * problem->mass[n] * w * w;
    }
  return kinetic[0] / (kinetic[0] + kinetic[1]);
}

static void wave(void)
{
  const double like = reflected(8), unlike = reflected(11);
  tap_ok(like < 0.01, "8 : 8 cells reflect %.2g of the energy", like);
  tap_ok(unlike < 0.01, "8 : 11 cells reflect %.2g of the energy", unlike);
}

/* Only points that are near are tied; what is asked wrongly is refused. */
static void refusals(void)
{
  ct_mesh *a = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 2, 2),
          *b = box_mesh(CT_HEX8, 1.05, 0, 0, 1, 2, 1, 1, 4, 2);
  ct_scene *scene = new_scene_with("a", a, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "b", b, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
  ct_effect *effect = NULL;
  ct_error e = {0};
  int64_t tied, points;
  double farthest;
  const ct_problem *joined = join_scene(scene);
  ct_tie_def def = tie_of(a, 1.0, b, 1.05);
  def.epsilon = 1e3;
  must(ct_tie_create_effect, &def, joined, &effect);
  must(ct_tie_count, effect, &tied, &points, &farthest);
  // 16 points of a, and the 16 of 32 of b that lie over it.
  tap_ok(tied == 32 && points == 48, "%d of %d points are tied", (int)tied, (int)points);
  tap_close(farthest, 0.05, 1e-14, "over the distance of the bodies");
  ct_effect_free(effect);
  effect = NULL;
  def.reach = 0.04;
  tap_ok(ct_tie_create_effect(&def, joined, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "too far: %s", e.text);
  def.reach = 0.0;
  tap_ok(ct_tie_create_effect(&def, joined, &effect, &e) == CT_ERROR_ARGUMENT, "reach: %s", e.text);
  def.reach = 0.1, def.epsilon = 0.0;
  tap_ok(ct_tie_create_effect(&def, joined, &effect, &e) == CT_ERROR_ARGUMENT, "stiffness: %s",
         e.text);
  def.epsilon = 1e3, def.face_count[1] = 0;
  tap_ok(ct_tie_create_effect(&def, joined, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "no faces: %s", e.text);
}

int main(void)
{
  free_at_end();
  law();
  books(CT_HEX8, CT_HEX8, "hex8");
  books(CT_HEX20, CT_HEX8, "hex20 and hex8");
  step_of_the_bodies();
  wave();
  refusals();
  return tap_done();
}
