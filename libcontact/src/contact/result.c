/* Results of a contact: the resultants of its forces, and its points. */
#include "../base/error.h"
#include "../constraint/slip.h"
#include "contact_internal.h"

ct_status ct_contact_resultant(const ct_contact *contact, double force_a[3], double moment_a[3],
                               double force_b[3], double moment_b[3], ct_error *error)
{
  if (contact == NULL || force_a == NULL || moment_a == NULL ||
      (contact->fixed->gaps.sides == 2 && (force_b == NULL || moment_b == NULL)))
    return CT_REFUSE_NULL(error);
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    double *force = s == 0 ? force_a : force_b, *moment = s == 0 ? moment_a : moment_b;
    for (int c = 0; c < 3; c++) force[c] = moment[c] = 0.0;
    for (int64_t n = 0; n < side->search->node_count; n++) {
      double f[3], m[3];
      for (int c = 0; c < 3; c++) f[c] = ct_side_force(side, n, c);
      ct_vector_cross(&side->search->x[3 * n], f, m);
      for (int c = 0; c < 3; c++) {
        force[c] += f[c];
        moment[c] += m[c];
      }
    }
  }
  return CT_OK;
}

ct_status ct_contact_friction(const ct_contact *contact, int32_t side, double *traction,
                              int32_t *slip, ct_error *error)
{
  if (contact == NULL || traction == NULL || slip == NULL) return CT_REFUSE_NULL(error);
  if (side < 0 || side >= contact->fixed->gaps.sides)
    return CT_REFUSE(error, "contact: there is no surface %d", (int)side);
  return ct_side_friction(&contact->gaps.side[side], ct_contact_acting(contact, side), traction,
                          slip, error);
}

int64_t ct_contact_point_count(const ct_contact *contact)
{
  int64_t count = 0;
  for (int s = 0; contact != NULL && s < contact->fixed->gaps.sides; s++)
    count += contact->fixed->gaps.side[s].point_count;
  return count;
}

ct_status ct_contact_points(const ct_contact *contact, ct_contact_point *points, ct_error *error)
{
  if (contact == NULL || points == NULL) return CT_REFUSE_NULL(error);
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (int64_t i = 0; i < side->fixed->point_count; i++, points++) {
      const ct_point *from = &side->points[i];
      int met = from->other >= 0;
      *points = (ct_contact_point){.side = s,
                                   .face = (int32_t)(i / side->fixed->rule.count),
                                   .point = (int32_t)(i % side->fixed->rule.count),
                                   .other = from->other,
                                   .gap = from->row.gap,
                                   .weight = side->fixed->weight[i],
                                   .start_gap = met ? from->shift : 0.0};
      ct_side_position(side, i, NULL, points->position);
      // No law has tension, so the pressure is the size of the force.
      points->raw_pressure =
          sqrt(ct_vector_dot(from->force, from->force)) / (0.5 * side->fixed->weight[i]);
      // -- Friction of the point (eq:slip-law)
      const ct_slip *slip = from->row.force > 0.0 ? from->row.slip : NULL;
      for (int c = 0; slip != NULL && c < 3; c++)
        points->friction[c] =
            *ct_slip_number(slip, CT_SLIP_FORCE + c) / (0.5 * side->fixed->weight[i]);
      points->slip = slip == NULL                                  ? CT_FRICTION_NONE
                     : *ct_slip_number(slip, CT_SLIP_STUCK) != 0.0 ? CT_FRICTION_STICKS
                                                                   : CT_FRICTION_SLIPS;
      for (int c = 0; c < 3; c++) points->closest[c] = met ? points->position[c] + from->d[c] : NAN;
      for (int c = 0; c < 2; c++) points->xi[c] = met ? from->xi[c] : NAN;
    }
  }
  return CT_OK;
}
