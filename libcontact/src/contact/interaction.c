#include "interaction.h"

ct_status ct_interaction_bound(const ct_interaction *interaction, const void *state, ct_masses mass,
                               double *omega2)
{
  const ct_interaction *on = interaction->on;
  *omega2 = 0.0;
  // -- Forces that follow from the next gaps leave the step as it is (eq:controlled-energy)
  if (on == NULL && !interaction->explicit) return CT_OK;
  ct_status status =
      (on == NULL ? interaction : on)->calls->find_springs(state, on != NULL, mass, omega2);
  *omega2 *= interaction->stiffness;
  return status;
}
