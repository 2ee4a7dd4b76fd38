/* How stiff the points of friction may be in a step. */
#include "../base/error.h"
#include "contact_internal.h"

#include <math.h>

/* The largest ω² of the active points for which a step is stable. */
static double room_at(const ct_friction_room *room, double dt)
{
  const double rate = room->limit / dt;
  // -- Ω² (1 / Δt² - 1 / Δt_s²) less the largest effect of damping (eq:friction-room)
  return room->bound + room->fraction * fmax(rate * (rate - room->rate), 0.0);
}

ct_status ct_friction_check_rows(const ct_interaction *is, const ct_friction_room *room,
                                 const double *mass, const double *rows, double dt, ct_error *error)
{
  const double most = room_at(room, dt);
  for (int32_t n = 0; n < is->node_count; n++) {
    double over = rows[n] / mass[is->nodes[n]] - most;
    // -- 4 / Δt² must grow by what is too much (eq:friction-room)
    if (over > 1e-9 * most)
      return ct_fail(error, CT_ERROR_STEP, (ct_place){-1, -1, is->nodes[n]},
                     "friction: the points in contact at node %d are too stiff for the time step "
                     "%g, which may be %g at most",
                     (int)is->nodes[n], dt, 2.0 / sqrt(4.0 / (dt * dt) + over));
  }
  return CT_OK;
}
