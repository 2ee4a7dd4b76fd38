#ifndef SPRINGS_H
#define SPRINGS_H

#include <libcontact/contact.h>

/* Bound of ω² with every point of a contact as a spring: (2 / Δt)² of its stable step. */
static inline ct_status springs_of(const ct_contact *contact, const double *mass_a,
                                   const double *mass_b, double *omega2)
{
  double dt = 0.0;
  if (omega2 != NULL) *omega2 = 0.0;
  ct_status status =
      ct_contact_update_stable_step(contact, mass_a, mass_b, omega2 == NULL ? NULL : &dt, NULL);
  if (status == CT_OK) *omega2 = 4.0 / (dt * dt);
  return status;
}

#endif
