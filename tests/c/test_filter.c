/* The filter of recorded fields: fields that pass unchanged, the range of its factors on any mesh,
 * and data that it must not change. */
#include "bodies.h"

static const ct_material STEEL = {2.1, 0.3, 0.7, CT_LINEAR};
static const ct_material RUBBER = {0.1, 0.45, 0.2, CT_LINEAR};

static const ct_problem *at_half(ct_scene *scene) { return build_until(scene, 1.0, 0.5); }

LATER(filter)

static ct_filter *new_filter(const ct_problem *p, int passes)
{
  ct_filter *filter = NULL;
  must(ct_filter_create, p, passes, &filter);
  return later_filter(filter);
}

/* Filter a displacement in place. */
static void smooth(ct_filter *filter, ct_state *state, double *u)
{
  memcpy(state->displacement, u, 3 * (size_t)state->node_count * sizeof *u);
  must(ct_filter_apply, filter, state, u, NULL);
}

/* A uniaxial strain under the pressure that holds it passes as it is, on any mesh, with any number
 * of passes; and a second body sees nothing of the first (eq:filter-held). */
static void constant_strain(ct_brick_kind kind)
{
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 2, 1, 1, 4, 3, 2),
          *other = box_mesh(kind, 5, 0, 0, 1, 1, 1, 2, 2, 2);
  for (int i = 0; i < m->node_count; i++) m->nodes[3 * i] *= 0.6 + 0.2 * m->nodes[3 * i];
  distort_inside(m, 0.05);
  int n = m->node_count, all = n + other->node_count, faces = 0;
  int32_t *face = integers(8 * 6 * m->element_count);
  const double strain = 1e-3, c = STEEL.young * (1 - STEEL.poisson) /
                                  ((1 + STEEL.poisson) * (1 - 2 * STEEL.poisson));
  ct_scene *scene = new_scene_with("loaded", m, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  add_body(scene, "other", other, &RUBBER, CT_KERNEL_AUTO, 0, 0, 0);
  add_support(scene, 0, m, 0, 0.0, "x", 0.0);
  for (int axis = 1; axis < 3; axis++)
    for (int side = 0; side < 2; side++)
      add_support(scene, 0, m, axis, side, axis == 1 ? "y" : "z", 0.0);
  faces = ct_mesh_plane_faces(m, 0, 2.0, face, NULL);
  ct_load_def load = {COOKIE, .kind = kind == CT_HEX8 ? CT_Q4 : CT_Q8, .face_count = faces,
                      .faces = face, .traction = {c * strain, 0, 0}};
  add_made(scene, ct_load_create_effect, &load);
  const ct_problem *p = at_half(scene);
  ct_state *state = new_state(p);
  ct_filter *filter = new_filter(p, 8);
  double *u = numbers(3 * all), off = 0.0, apart = 0.0;
  for (int i = 0; i < n; i++) u[3 * i] = strain * m->nodes[3 * i];
  smooth(filter, state, u);
  for (int i = 0; i < 3 * n; i++) off = worst(off, u[i] - (i % 3 ? 0.0 : strain * m->nodes[i]));
  apart = largest(&u[3 * n], 3 * other->node_count);
  tap_ok(faces > 0 && off < 1e-13 * strain && apart == 0.0,
         "%s: constant strain passes: off by %.2g of it", kind == CT_HEX8 ? "hex8" : "hex20",
         off / strain);
}

/* The factor of the fastest mode of a mesh, by repeating the part that a pass subtracts
 * (eq:filter-weight, eq:filter-range). */
static double least_factor(const ct_mesh *m, int held)
{
  ct_scene *scene = new_scene_with("body", m, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
  if (held) add_support(scene, 0, m, 0, 0.0, "xz", 0.0);
  const ct_problem *p = at_half(scene);
  ct_state *state = new_state(p);
  ct_filter *filter = new_filter(p, 1);
  int n = 3 * m->node_count;
  double *u = numbers(n), *w = numbers(n), taken = 0.0;
  for (int i = 0; i < n; i++) u[i] = uniform(1.0);
  for (int round = 0; round < 300; round++) {
    double top = largest(u, n);
    for (int i = 0; i < n; i++) w[i] = u[i] /= top;
    smooth(filter, state, w);
    for (int i = 0; i < n; i++) u[i] -= w[i];
    taken = largest(u, n);
  }
  return 1.0 - taken;
}

static void range_of_factors(void)
{
  for (int kind = 0; kind < 2; kind++)
    for (int held = 0; held < 2; held++) {
      ct_mesh *m = box_mesh(kind ? CT_HEX20 : CT_HEX8, 0, 0, 0, 4, 1, 1, 5, 2, 2);
      double least = least_factor(m, held);
      // A box has the bound of its blocks, which is within a few percent; hex20 that of elements.
      tap_ok(least > -1e-9 && least < 0.1, "%s, a box%s: the fastest mode keeps %.3g",
             kind ? "hex20" : "hex8", held ? ", held" : "", least);
      for (int i = 0; i < m->node_count; i++) m->nodes[3 * i] *= 0.25 + 0.1875 * m->nodes[3 * i];
      least = least_factor(m, held);
      tap_ok(least > -1e-9 && least < 0.3, "%s, graded%s: the fastest mode keeps %.3g",
             kind ? "hex20" : "hex8", held ? ", held" : "", least);
      distort_inside(m, 0.05);
      least = least_factor(m, held);
      tap_ok(least > -1e-9 && least < 0.5, "%s, distorted%s: the fastest mode keeps %.3g",
             kind ? "hex20" : "hex8", held ? ", held" : "", least);
    }
}

/* Runs with and without a filter in each step. */
static void state_is_not_touched(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 3, 3),
          *other = box_mesh(CT_HEX8, 1.02, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene_with("left", m, &STEEL, CT_KERNEL_AUTO, 0.2, 0, 0);
  add_body(scene, "right", other, &RUBBER, CT_KERNEL_AUTO, 0, 0, 0);
  add_contact(scene, 0, m, 1.0, 1, other, 1.02, 0, 1.0);
  const ct_problem *p = at_half(scene);
  ct_state *state = new_state(p), *plain = new_state(p);
  ct_filter *filter = new_filter(p, 3);
  size_t bytes = 3 * (size_t)p->node_count * sizeof(double);
  double *u = numbers(3 * p->node_count), *v = numbers(3 * p->node_count), moved = 0.0;
  for (int i = 0; i < 40; i++) {
    must(ct_filter_apply, filter, state, u, v);
    moved = fmax(moved, largest_difference(u, state->displacement, 3 * p->node_count));
    must(ct_step, p, state);
    must(ct_step, p, plain);
  }
  tap_ok(moved > 1e-5 && memcmp(state->displacement, plain->displacement, bytes) == 0 &&
             memcmp(state->velocity, plain->velocity, bytes) == 0,
         "the bits of a run are those without the filter, which moves nodes by %.2g", moved);
}

/* Other numbers of nodes and elements give the same bits at each place, also of a body behind
 * another one. */
static void shuffled(void)
{
  ct_mesh *first = box_mesh(CT_HEX8, -2, 0, 0, 1, 1, 1, 4, 3, 2),
          *m = box_mesh(CT_HEX8, 0, 0, 0, 3, 1, 1, 9, 4, 3);
  distort_inside(first, 0.02);
  distort_inside(m, 0.05);
  int32_t n[2] = {first->node_count, m->node_count}, all = n[0] + n[1], *to = integers(all);
  ct_mesh *s[2] = {shuffle_mesh(first, to), shuffle_mesh(m, &to[n[0]])};
  for (int32_t i = n[0]; i < all; i++) to[i] += n[0];
  double *u = numbers(3 * all), *before = numbers(3 * all), *w = numbers(3 * all), off = 0.0;
  for (int32_t i = 0; i < 3 * all; i++) before[i] = uniform(1e-3);
  for (int k = 0; k < 2; k++) {
    ct_mesh *of[2] = {k ? s[0] : first, k ? s[1] : m};
    ct_scene *scene = new_scene_with("first", of[0], &RUBBER, CT_KERNEL_AUTO, 0, 0, 0);
    add_body(scene, "second", of[1], &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
    add_support(scene, 1, of[1], 0, 0.0, "xz", 0.0);
    const ct_problem *p = at_half(scene);
    ct_state *state = new_state(p);
    ct_filter *filter = new_filter(p, 3);
    for (int32_t i = 0; i < all; i++) memcpy(&(k ? w : u)[3 * (k ? to[i] : i)], &before[3 * i], 24);
    smooth(filter, state, k ? w : u);
  }
  off = apart(u, w, to, all);
  tap_ok(off == 0.0 && largest_difference(u, before, 3 * all) > 1e-4,
         "shuffled bodies: the same bits at each place (off by %.2g)", off);
}

static void refusals(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_material large = STEEL;
  large.law = CT_NEO_HOOKEAN;
  ct_scene *scene = new_scene_with("soft", m, &large, CT_KERNEL_AUTO, 0, 0, 0);
  ct_filter *filter = NULL;
  ct_error e;
  const ct_problem *p = at_half(scene);
  tap_ok(ct_filter_create(p, 1, &filter, &e) == CT_ERROR_UNSUPPORTED && filter == NULL,
         "a body that is not linear is refused: %s", e.text);
  tap_ok(ct_filter_create(p, 9, &filter, &e) == CT_ERROR_ARGUMENT, "nine passes are refused: %s",
         e.text);
  tap_ok(ct_filter_create(p, 0, &filter, &e) == CT_ERROR_ARGUMENT, "so are none");
  tap_ok(ct_filter_apply(NULL, NULL, NULL, NULL, &e) == CT_ERROR_ARGUMENT, "and a null filter: %s",
         e.text);
}

int main(void)
{
  free_at_end();
  constant_strain(CT_HEX8);
  constant_strain(CT_HEX20);
  range_of_factors();
  state_is_not_touched();
  shuffled();
  refusals();
  return tap_done();
}
