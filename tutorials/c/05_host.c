/* A host in forty lines: masses and springs slide over a fixed square with friction, to a wall. */
#include <contact.h>
#include <stdio.h>

int main(void)
{
  const double ground[4][3] = {{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}};
  const double no_motion[4][3] = {{0}}, X[4][3] = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  const double inverse_mass[4][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, dt = 0.01;
  const int32_t face[4] = {0, 1, 2, 3}; /* counter-clockwise from outside: down, and up */
  double x[4][3], v[4][3] = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, f[4][3], g[4][3];
  ct_surface a = {CT_Q4, 4, 1, face, X[0]}, b = {CT_Q4, 4, 1, face, ground[0]};
  ct_contact_options options = ct_contact_options_default();
  ct_obstacle_def wall = ct_obstacle_def_default();
  ct_contact *contact = NULL;
  ct_error e;
  options.epsilon = wall.epsilon = 4000.0;
  wall.point[0] = 2.0, wall.axis[0] = -1.0; /* the plane x = 2 */
  int failed = ct_contact_create(&a, &b, &options, &contact, &e) != CT_OK ||
               ct_contact_add_obstacle(contact, 0, &wall, &e) != CT_OK ||
               ct_contact_add_friction(contact, -1, 0.2, 1.0, &e) != CT_OK;
  for (int n = 0; n < 12; n++) x[0][n] = X[0][n];
  for (int step = 0; step <= 400 && !failed; step++) {
    for (int n = 0; n < 12; n++) f[0][n] = n % 3 == 2 ? -1.0 : 0.0, g[0][n] = 0.0; /* weight */
    for (int n = 0; n < 2; n++) { /* springs along x */
      double spring = 100.0 * (x[3 - n][0] - x[n][0] - 1.0);
      f[n][0] += spring, f[3 - n][0] -= spring;
    }
    ct_contact_prediction p = {
        .x_a = x[0], .x_b = ground[0], .dt = dt, .force_time = step ? dt : dt / 2};
    p.velocity_a = v[0], p.velocity_b = no_motion[0], p.force_a = f[0];
    p.inverse_mass_a = inverse_mass[0], p.inverse_mass_b = no_motion[0];
    failed = ct_contact_step(contact, &p, &e) != CT_OK ||
             ct_contact_add_force(contact, f[0], g[0], &e) != CT_OK;
    if (step % 100 == 0)
      printf("t = %.0f: x = %.2f, v = %5.2f\n", step * dt, x[3][0], (v[0][0] + v[3][0]) / 2);
    for (int n = 0; n < 12; n++)
      v[0][n] += p.force_time * inverse_mass[0][n] * f[0][n], x[0][n] += dt * v[0][n];
  }
  if (failed) puts(e.text);
  ct_contact_free(contact);
  return failed;
}
