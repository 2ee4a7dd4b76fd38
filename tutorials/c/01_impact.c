/* Two equal bars of length L = 10, with E = rho = A = 1, meet at the velocities 0.1 and -0.1. They
 * press each other for 2 L / c = 20 and part with exchanged velocities, so the momentum of the
 * right one goes from -1 to 1. */
#include <libcontact.h>
#include <stdio.h>

int main(void)
{
  ct_scene_body left = {.material = {.young = 1, .density = 1}, .velocity = {0.1}};
  left.box = (ct_box){.size = {10, 1, 1}, .cells = {50, 1, 1}};
  ct_scene_body right = left;
  right.box.origin[0] = 10;
  right.velocity[0] = -0.1;
  ct_scene_contact contact = {.body_b = 1, .side_a = CT_X_MAX, .side_b = CT_X_MIN, .beta = 1};
  contact.options = ct_contact_options_default();
  ct_scene_time time = {.end = 25, .fraction = 0.9};
  ct_scene *scene = NULL;
  const ct_problem *problem;
  ct_state *state = NULL;
  int64_t steps;
  ct_momentum momentum;
  ct_error e;
  int failed = ct_scene_create(&scene, &e) || ct_scene_add_body(scene, &left, NULL, &e) ||
               ct_scene_add_body(scene, &right, NULL, &e) ||
               ct_scene_add_contact(scene, &contact, &e) ||
               ct_scene_build(scene, &time, &problem, &steps, NULL, &e) ||
               ct_state_create(problem, &state, &e) || ct_run(problem, state, steps, NULL, 0, &e) ||
               ct_momentum_of(problem, state, 1, &momentum, &e);
  if (failed) puts(e.text);
  else printf("t = %g: the momentum of the right bar is %.2f\n", state->time, momentum.p[0]);
  ct_state_free(state);
  ct_scene_free(scene);
  return failed;
}
