/* A host in forty lines: masses and springs slide over a fixed square with friction, to a wall. */
#include <libcontact/contact.h>
#include <stdio.h>

int main(void)
{
  const double ground[12] = {-3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0};
  const double no_motion[12] = {0}, X[12] = {0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0};
  const double inverse_mass[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, dt = 0.01;
  const double corner[3] = {2, 0, 0}, left[3] = {-1, 0, 0};
  const int32_t face[4] = {0, 1, 2, 3}; /* counter-clockwise from outside: down, and up */
  double x[12], v[12] = {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, f[12], g[12];
  ct_surface a = {CT_Q4, 4, 1, face, X}, b = {CT_Q4, 4, 1, face, ground};
  ct_contact_options options = ct_contact_options_default();
  ct_obstacle_def wall = ct_obstacle_def_plane(corner, left); /* x = 2 */
  ct_contact *contact = NULL;
  ct_error e;
  options.epsilon = wall.epsilon = 4000.0;
  options.travel_time = wall.travel_time = 0.14; /* h / c1 of masses 1 and springs 100 */
  int failed = ct_contact_create(&a, &b, &options, &contact, &e) != CT_OK ||
               ct_contact_add_obstacle(contact, 0, &wall, &e) != CT_OK ||
               ct_contact_add_friction(contact, -1, 0.2, 1.0, &e) != CT_OK;
  for (int n = 0; n < 12; n++) x[n] = X[n];
  for (int step = 0; step <= 400 && !failed; step++) {
    for (int n = 0; n < 12; n++) f[n] = n % 3 == 2 ? -1.0 : 0.0, g[n] = 0.0; /* weight */
    for (int n = 0; n < 2; n++) {                                            /* springs along x */
      double spring = 100.0 * (x[9 - 3 * n] - x[3 * n] - 1.0);
      f[3 * n] += spring, f[9 - 3 * n] -= spring;
    }
    ct_contact_prediction p = {.x_a = x, .x_b = ground, .dt = dt, .force_time = step ? dt : dt / 2};
    p.velocity_a = v, p.velocity_b = no_motion, p.force_a = f;
    p.inverse_mass_a = inverse_mass, p.inverse_mass_b = no_motion;
    failed = ct_contact_step(contact, &p, &e) != CT_OK ||
             ct_contact_add_force(contact, f, g, &e) != CT_OK;
    if (step % 100 == 0)
      printf("t = %.0f: x = %.2f, v = %5.2f\n", step * dt, x[9], (v[0] + v[9]) / 2);
    for (int n = 0; n < 12; n++) v[n] += p.force_time * inverse_mass[n] * f[n], x[n] += dt * v[n];
  }
  if (failed) puts(e.text);
  ct_contact_free(contact);
  return failed;
}
