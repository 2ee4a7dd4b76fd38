/* Bodies that begin displaced, turned, or under stress. */
#include "bodies.h"

static const ct_material BAR = {.young = 900.0, .poisson = 0.0, .density = 1.0};
static const ct_material SOFT = {.young = 900.0, .poisson = 0.3, .density = 2.0};

enum { CELLS = 40 };
static const double LENGTH = 10.0, STRETCH = 1e-2;

/* A free bar of CELLS cubes at a step of h / c, where linear elements move as exact waves do. */
static const ct_problem *free_bar(ct_scene *scene, ct_scene_body def)
{
  def.material = BAR;
  must(ct_scene_add_body, scene, &def, NULL);
  return build(scene, (ct_scene_time){.end = LENGTH / 30.0, .courant = 1.0}, NULL, NULL);
}

/* u0 = s x of the bar 0 ... L, continued as an even function about both ends. */
static double folded(double x)
{
  x = fmod(fabs(x), 2.0 * LENGTH);
  return STRETCH * (x < LENGTH ? x : 2.0 * LENGTH - x);
}

/* A stretched bar is released: u = (u0(x + c t) + u0(x - c t)) / 2 with the initial displacement u0
 * continued evenly about its free ends; energy is constant (eq:released-bar). */
static void released(void)
{
  const double h = LENGTH / CELLS;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, LENGTH, h, h, CELLS, 1, 1);
  ct_scene *scene = new_scene();
  double *u0 = numbers(3 * mesh->node_count), off = 0.0, lost = 0.0;
  for (int n = 0; n < mesh->node_count; n++) u0[3 * n] = STRETCH * mesh->nodes[3 * n];
  const ct_problem *p = free_bar(scene, (ct_scene_body){.mesh = mesh, .displacements = u0});
  ct_state *state = new_state(p);
  const ct_energy first = energy_of(p, state);
  tap_close(first.strain / (0.5 * 900.0 * STRETCH * STRETCH * LENGTH * h * h), 1.0, 1e-13,
            "a stretched bar begins with its strain energy");
  tap_ok(memcmp(state->displacement, u0, 3 * (size_t)mesh->node_count * sizeof *u0) == 0,
         "and with its displacement");
  while (state->step < 3 * CELLS) {
    advance(p, state, 1);
    const double ct = 30.0 * state->time;
    for (int n = 0; n < mesh->node_count; n++) {
      const double x = mesh->nodes[3 * n];
      off = worst(off, state->displacement[3 * n] - 0.5 * (folded(x + ct) + folded(x - ct)));
    }
    const ct_energy now = energy_of(p, state);
    lost = worst(lost, now.total / first.total - 1.0),
    lost = worst(lost, now.balance / first.total);
  }
  tap_close(off / (STRETCH * LENGTH), 0.0, 1e-12, "released, it moves as the exact waves do");
  tap_close(lost, 0.0, 1e-12, "its energy stays");
}

/* A bar under an initial stress E s moves as a bar that is stretched by s, with u less by s x
 * (eq:initial-stress-force); stored energies differ by the constant E s² V / 2
 * (eq:initial-stress-potential). */
static void stressed(void)
{
  const double h = LENGTH / CELLS;
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, LENGTH, h, h, CELLS, 1, 1);
  ct_scene *scene[2] = {new_scene(), new_scene()};
  double *u0 = numbers(3 * mesh->node_count), off = 0.0, apart = 0.0, stored;
  for (int n = 0; n < mesh->node_count; n++) u0[3 * n] = STRETCH * mesh->nodes[3 * n];
  const ct_problem *a = free_bar(scene[0], (ct_scene_body){.mesh = mesh, .displacements = u0}),
                   *b = free_bar(scene[1], (ct_scene_body){.mesh = mesh,
                                                           .initial_stress = {900.0 * STRETCH}});
  ct_state *one = new_state(a), *two = new_state(b);
  const double constant = 0.5 * 900.0 * STRETCH * STRETCH * LENGTH * h * h;
  for (int n = 0; n < 2 * CELLS; n++) {
    advance(a, one, 1), advance(b, two, 1);
    for (int d = 0; d < 3 * mesh->node_count; d++)
      off = worst(off, two->displacement[d] + u0[d] - one->displacement[d]);
    must(ct_energy_stored, b, two, 1, &stored);
    const ct_energy first = energy_of(a, one), second = energy_of(b, two);
    apart = worst(apart, (second.strain + stored + constant - first.strain) / constant);
    apart = worst(apart, second.balance / constant);
  }
  tap_close(off / (STRETCH * LENGTH), 0.0, 1e-12, "a bar under stress moves as a stretched one");
  tap_close(apart, 0.0, 1e-12, "with the same energy, but for that of the stress alone");
}

/* A load of traction -σ n on a side of a box. */
static void add_traction(ct_scene *scene, const ct_mesh *mesh, int axis, int top, const double *s)
{
  static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  const double size[3] = {2.0, 1.0, 3.0};
  int32_t *faces = integers(8 * 6 * mesh->element_count);
  ct_load_def def = {COOKIE, .kind = ct_brick_face_kind(mesh->kind), .faces = faces};
  def.face_count = ct_mesh_plane_faces(mesh, axis, top ? size[axis] : 0.0, faces, NULL);
  for (int c = 0; c < 3; c++) def.traction[c] = (top ? 1.0 : -1.0) * s[at[c][axis]];
  add_made(scene, ct_load_create_effect, &def);
}

/* Any uniform stress of a mesh with distorted elements is in equilibrium with the tractions σ n on
 * its faces, at every node (eq:initial-stress-force, eq:initial-strain). */
static void in_equilibrium(void)
{
  static const double s[6] = {3.0, -2.0, 1.0, 0.7, -0.4, 0.9};
  static const ct_solid_kernel kernel[3] = {CT_KERNEL_GENERAL, CT_KERNEL_REDUCED,
                                            CT_KERNEL_GENERAL};
  for (int k = 0; k < 3; k++) {
    ct_mesh *mesh = box_mesh(k == 2 ? CT_HEX20 : CT_HEX8, 0, 0, 0, 2, 1, 3, 4, 2, 3);
    ct_scene *scene = new_scene();
    distort_inside(mesh, 0.1);
    ct_scene_body def = {.mesh = mesh, .material = SOFT, .kernel = kernel[k]};
    memcpy(def.initial_stress, s, sizeof s);
    must(ct_scene_add_body, scene, &def, NULL);
    for (int side = 0; side < 6; side++) add_traction(scene, mesh, side / 2, side % 2, s);
    const ct_problem *p = build_until(scene, 1.0, 0.9);
    ct_state *state = new_state(p);
    double *force = numbers(3 * mesh->node_count), *sum = numbers(3 * mesh->node_count), most = 0.0;
    for (int i = 1; i < p->effect_count; i++) {
      if (p->effects[i]->kind == CT_EFFECT_HOURGLASS) continue;
      must(ct_state_force, p, state, i, force);
      most = fmax(most, largest(force, 3 * mesh->node_count));
      for (int d = 0; d < 3 * mesh->node_count; d++) sum[d] += force[d];
    }
    tap_close(largest(sum, 3 * mesh->node_count) / most, 0.0, 1e-13,
              "a uniform stress is in equilibrium with its tractions (%s)",
              ct_brick_facts_of(mesh->kind)->name);
  }
}

static void refusals(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  ct_error e = {0};
  double u[24] = {0.0};
  const ct_problem *p = NULL;
  const ct_scene_time time = {.end = 1.0, .fraction = 0.5};
  ct_scene_body def = {.name = "one", .mesh = mesh, .material = SOFT, .displacements = u};
  u[7] = NAN;
  tap_ok(ct_scene_add_body(scene, &def, NULL, &e) == CT_INVALID && e.point == 2, "%s", e.text);
  u[7] = 0.0;
  def.initial_stress[4] = INFINITY;
  must(ct_scene_add_body, scene, &def, NULL);
  tap_ok(ct_scene_build(scene, &time, &p, &(int64_t){0}, NULL, &e) == CT_INVALID, "%s", e.text);
  scene = new_scene();
  def.initial_stress[4] = 1.0;
  def.material.law = CT_NEO_HOOKEAN;
  must(ct_scene_add_body, scene, &def, NULL);
  tap_ok(ct_scene_build(scene, &time, &p, &(int64_t){0}, NULL, &e) == CT_ERROR_UNSUPPORTED, "%s",
         e.text);
}

int main(void)
{
  free_at_end();
  released();
  stressed();
  in_equilibrium();
  refusals();
  return tap_done();
}
