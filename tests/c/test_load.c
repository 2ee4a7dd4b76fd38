/* Tractions and pressures. */
#include "bodies.h"

static const ct_material BAR = {.young = 900.0, .poisson = 0.0, .density = 1.0};

/* A scene of one body with a load on some of its faces. */
typedef struct loaded {
  ct_scene *scene;
  const ct_problem *problem;
  ct_effect *effect;
  ct_stable_step stable;
  int64_t steps;
} loaded;

static loaded load_faces(ct_scene *scene, ct_load_def load, int32_t *faces, int32_t count,
                         double end, double fraction)
{
  loaded l = {.scene = scene};
  const ct_problem *joined = join_scene(scene);
  load.faces = faces, load.face_count = count;
  load.kind = ct_brick_face_kind(joined->bodies[0].mesh->kind);
  must(ct_load_create_effect, &load, joined, &l.effect);
  must(ct_scene_add_effect, scene, l.effect);
  l.problem = build(scene, (ct_scene_time){.end = end, .fraction = fraction}, &l.steps, &l.stable);
  return l;
}

/* Force of the load on all nodes at a displacement (null: none), as the state would have it. */
static double *force_at(const loaded *l, const double *u)
{
  ct_state *state = new_state(l->problem);
  double *force = numbers(3 * (int64_t)l->problem->node_count),
         *own = numbers(3 * (int64_t)l->effect->node_count);
  ct_view view = {.time = 0.0,
                  .reference = l->problem->reference,
                  .displacement = u != NULL ? u : state->displacement,
                  .velocity = state->velocity};
  must(l->effect->calls->create_scratch, l->effect, &view.scratch);
  must(l->effect->calls->force, l->effect, &view, own);
  for (int32_t i = 0; i < l->effect->node_count; i++)
    memcpy(&force[3 * l->effect->nodes[i]], &own[3 * i], 3 * sizeof(double));
  l->effect->calls->free_scratch(view.scratch);
  return force;
}

/* The resultant is traction times area, less pressure times area along the normal
 * (eq:load-force). */
static void resultants(ct_brick_kind kind, const char *name)
{
  ct_mesh *mesh = box_mesh(kind, 0, 0, 0, 3, 2, 5, 2, 3, 4);
  distort_inside(mesh, 0.1);
  ct_scene *scene = new_scene_with("one", mesh, &BAR, CT_KERNEL_AUTO, 0, 0, 0);
  int32_t *faces = integers(8 * 6 * mesh->element_count),
          count = ct_mesh_plane_faces(mesh, 2, 5.0, faces, NULL);
  loaded l = load_faces(scene, (ct_load_def){COOKIE, .traction = {1.0, -2.0, 0.5}, .pressure = 7.0},
                        faces, count, 1e-3, 0.5);
  double *f = force_at(&l, NULL), sum[3] = {0.0}, moment = 0.0;
  for (int32_t n = 0; n < l.problem->node_count; n++)
    for (int c = 0; c < 3; c++)
      sum[c] += f[3 * n + c], moment += c == 2 ? f[3 * n + 2] * l.problem->reference[3 * n] : 0.0;
  tap_close(sum[0], 6.0, 1e-12, "%s: traction x area along x", name);
  tap_close(sum[1], -12.0, 1e-12, "%s: along y", name);
  tap_close(sum[2], 3.0 - 42.0, 1e-12, "%s: along z, minus the pressure", name);
  tap_close(moment, -39.0 * 1.5, 1e-11, "%s: the moment is that of the middle", name);
}

/* A pressure that follows, all around a body: no force and no moment, however the body is deformed;
 * and the bound of its stiffness is one (eq:load-force, eq:load-bound). */
static void closed_surface(ct_brick_kind kind, const char *name)
{
  ct_mesh *mesh = box_mesh(kind, 0, 0, 0, 1, 1, 1, 2, 2, 2);
  ct_scene *scene = new_scene_with("one", mesh, &BAR, CT_KERNEL_AUTO, 0, 0, 0);
  int32_t *faces = integers(8 * 6 * mesh->element_count),
          count = ct_mesh_outer_faces(mesh, faces, NULL);
  loaded l = load_faces(scene, (ct_load_def){COOKIE, .pressure = 3.0, .following = 1}, faces, count,
                        1e-3, 0.5);
  int64_t dofs = 3 * (int64_t)l.problem->node_count;
  double *u = numbers(dofs), force[3] = {0.0}, moment[3] = {0.0}, size = 0.0;
  for (int64_t d = 0; d < dofs; d++) u[d] = uniform(0.1);
  double *f = force_at(&l, u);
  for (int64_t n = 0; n < dofs / 3; n++)
    for (int c = 0; c < 3; c++) {
      int p = (c + 1) % 3, q = (c + 2) % 3;
      force[c] += f[3 * n + c], size += fabs(f[3 * n + c]);
      moment[c] += (l.problem->reference[3 * n + p] + u[3 * n + p]) * f[3 * n + q] -
                   (l.problem->reference[3 * n + q] + u[3 * n + q]) * f[3 * n + p];
    }
  tap_close(largest(force, 3) / size, 0.0, 1e-14, "%s: a pressure all around has no resultant",
            name);
  tap_close(largest(moment, 3) / size, 0.0, 1e-14, "%s: it has no moment", name);
  double bound = 0.0, worst_row = 0.0, unused;
  ct_state *state = new_state(l.problem);
  must(ct_stable_contribution, l.problem, state, 1, &bound, &unused);
  for (int trial = 0; trial < 20; trial++) {
    for (int64_t d = 0; d < dofs; d++) u[d] = 1e-6 * (uniform(1.0) > 0 ? 1 : -1);
    double *g = force_at(&l, u), *g0 = force_at(&l, NULL);
    for (int64_t d = 0; d < dofs; d++)
      worst_row = fmax(worst_row, fabs(g[d] - g0[d]) / l.problem->mass[d / 3] / (1e-6 * sqrt(3.0)));
  }
  tap_ok(worst_row <= bound && worst_row > 0.05 * bound,
         "%s: no small motion changes the force by more than the bound (%.3g of it)", name,
         worst_row / bound);
}

/* One face of a cube: the integral is its edge at each node, and the bound 8 p / (rho h^2)
 * (eq:load-bound). */
static void bound_of_a_cube(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1);
  ct_scene *scene = new_scene_with("cube", mesh, &BAR, CT_KERNEL_AUTO, 0, 0, 0);
  static const double time[2] = {0.0, 1.0}, value[2] = {0.5, -2.0};
  int32_t *faces = integers(8 * 6), count = ct_mesh_plane_faces(mesh, 2, 0.5, faces, NULL);
  ct_load_def def = {COOKIE, .pressure = 3.0, .following = 1, .amplitude = {2, time, value}};
  loaded l = load_faces(scene, def, faces, count, 1e-3, 0.5);
  ct_state *state = new_state(l.problem);
  double bound, unused;
  must(ct_stable_contribution, l.problem, state, 1, &bound, &unused);
  tap_close(bound / (8.0 * 3.0 * 2.0 / (1.0 * 0.25)), 1.0, 1e-11, "one face of a cube: the bound");
}

static void refusals(void)
{
  ct_mesh *mesh = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_scene *scene = new_scene();
  ct_effect *effect = NULL;
  ct_error e = {0};
  static const int32_t outside[4] = {0, 1, 2, 99}, flat[4] = {0, 1, 1, 0}, good[4] = {0, 1, 3, 2};
  add_body(scene, "one", mesh, &BAR, CT_KERNEL_AUTO, 0, 0, 0);
  const ct_problem *joined = join_scene(scene);
  ct_load_def bad = {COOKIE, .kind = CT_Q4, .face_count = 1, .faces = outside, .pressure = 1.0};
  tap_ok(ct_load_create_effect(&bad, joined, &effect, &e) == CT_ERROR_ARGUMENT && e.element == 0,
         "a node outside: %s", e.text);
  bad.faces = flat;
  tap_ok(ct_load_create_effect(&bad, joined, &effect, &e) == CT_ERROR_GEOMETRY && e.element == 0,
         "a face without area: %s", e.text);
  bad.faces = good, bad.traction[1] = INFINITY;
  tap_ok(ct_load_create_effect(&bad, joined, &effect, &e) == CT_INVALID, "an infinite traction: %s",
         e.text);
  bad.traction[1] = 0.0, bad.face_count = 0;
  tap_ok(ct_load_create_effect(&bad, joined, &effect, &e) == CT_ERROR_ARGUMENT && effect == NULL,
         "no faces: %s", e.text);
}

int main(void)
{
  free_at_end();
  resultants(CT_HEX8, "Q4");
  resultants(CT_HEX20, "Q8");
  closed_surface(CT_HEX8, "Q4");
  closed_surface(CT_HEX20, "Q8");
  bound_of_a_cube();
  refusals();
  return tap_done();
}
