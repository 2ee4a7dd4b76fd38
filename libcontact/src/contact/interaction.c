#include "interaction.h"

ct_status ct_interaction_bound(const ct_interaction *interaction, const void *state, ct_masses mass,
                               double *omega2)
{
  *omega2 = 0.0;
  // -- Forces that follow from the next gaps leave the step as it is (eq:controlled-energy)
  return interaction->explicit ? interaction->calls->find_springs(state, mass, omega2) : CT_OK;
}
