/* An effect of one's own: a spring of stiffness k from each node of a body to its place of t = 0.
 * The body of mass m and N nodes, which starts with the velocity 1, moves as a whole,
 * u = sin(omega t) / omega with omega^2 = N k / m; here omega = 1. */
#include <libcontact.h>
#include <stdio.h>

/* What the effect needs: the stiffness and the smallest mass of a node. */
typedef struct springs {
  double k, mass;
} springs;

static ct_status force_of(const ct_effect *effect, const ct_view *view, double *force, ct_error *e)
{
  const springs *s = effect->data;
  (void)e;
  for (int i = 0; i < 3 * effect->node_count; i++) force[i] = -s->k * view->displacement[i];
  return CT_OK;
}

static ct_status energy_of(const ct_effect *effect, const ct_view *view, double *energy,
                           ct_error *e)
{
  const springs *s = effect->data;
  (void)e;
  *energy = 0.0;
  for (int i = 0; i < 3 * effect->node_count; i++)
    *energy += 0.5 * s->k * view->displacement[i] * view->displacement[i];
  return CT_OK;
}

static ct_status bound_of(const ct_effect *effect, const ct_view *view, double *omega2, ct_error *e)
{
  const springs *s = effect->data;
  (void)view, (void)e;
  *omega2 = s->k / s->mass;
  return CT_OK;
}

static const ct_effect_calls SPRINGS = {
    .force = force_of, .energy = energy_of, .bounds = {.omega2 = bound_of}};

int main(void)
{
  ct_scene_body cube = {.material = {.young = 1, .density = 1}, .velocity = {1, 0, 0}};
  cube.box = (ct_box){.size = {1, 1, 1}, .cells = {1, 1, 1}};
  springs of_cube = {.k = 0.125, .mass = 0.125};
  ct_effect filled = {.label = "springs", .calls = &SPRINGS, .data = &of_cube, .node_count = 8};
  ct_effect *effect = NULL;
  ct_scene_time time = {.end = 1.5707963267948966, .fraction = 0.01};
  ct_scene *scene = NULL;
  const ct_problem *problem;
  ct_state *state = NULL;
  int64_t steps;
  double stored;
  ct_error e;
  int failed = ct_scene_create(&scene, &e) || ct_scene_add_body(scene, &cube, NULL, &e) ||
               ct_scene_join(scene, &problem, &e) || ct_effect_create(&filled, &effect, &e) ||
               ct_scene_add_effect(scene, effect, &e) ||
               ct_scene_build(scene, &time, &problem, &steps, NULL, &e) ||
               ct_state_create(problem, &state, &e) || ct_run(problem, state, steps, NULL, 0, &e) ||
               ct_energy_stored(problem, state, 1, &stored, &e);
  if (failed) puts(e.text);
  else printf("displacement %.3f, energy of the springs %.3f\n", state->displacement[0], stored);
  ct_state_free(state);
  ct_scene_free(scene);
  return failed;
}
