/* Definitions of effects, filled in one place. */
#ifndef DEFS_H
#define DEFS_H

#include <libcontact/effect.h>

/* Value of the first member of each definition. */
#define COOKIE .cookie = ct_gravity_def_default().cookie

static inline ct_status create_solid(const ct_solid_body *bodies, int32_t count, ct_effect **effect,
                                     ct_error *error)
{
  ct_solid_def def = {COOKIE, .bodies = bodies, .body_count = count};
  return ct_solid_create_effect(&def, NULL, effect, error);
}

static inline ct_status create_support(const ct_support *supports, int32_t count,
                                       int32_t node_count, ct_effect **effect, ct_error *error)
{
  ct_support_def def = {COOKIE, .supports = supports, .support_count = count};
  ct_problem problem = {.node_count = node_count};
  return ct_support_create_effect(&def, &problem, effect, error);
}

static inline ct_status create_motion(const ct_motion *motions, int32_t count,
                                      const ct_problem *problem, ct_effect **effect,
                                      ct_error *error)
{
  ct_motion_def def = {COOKIE, .motions = motions, .motion_count = count};
  return ct_motion_create_effect(&def, problem, effect, error);
}

#endif
