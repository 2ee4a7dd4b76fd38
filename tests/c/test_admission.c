/* Points that are found inside after the start: no energy appears, whatever the options; and the
 * law that limits what a row claims to store. */
#include "../../libcontact/src/constraint/law.h"
#include "patches.h"

enum { NODES = 128 };

/* A patch that slides in a plane beside a held one, at a depth under it, and comes over it from the
 * side. */
typedef struct slide {
  patch held, moving;
  double x[NODES][3], v[NODES][3], none[NODES][3], rest[NODES][3], free[NODES][3];
  ct_contact *contact;
  double largest; /* kinetic energy, over that of the start */
  double pressed; /* largest force along z */
} slide;

static double kinetic(const slide *s)
{
  double sum = 0.0;
  for (int32_t n = 0; n < s->moving.surface.node_count; n++)
    for (int c = 0; c < 3; c++) sum += 0.5 * s->v[n][c] * s->v[n][c];
  return sum;
}

static void open_slide(slide *s, const ct_contact_options *options, double depth)
{
  *s = (slide){.held = new_patch(CT_Q4, 4, 3, 0.0, 0.0, 2.0, 1.5, 1),
               .moving = new_patch(CT_Q4, 3, 2, -1.6, 0.2, 1.5, 1.0, 0)};
  const int32_t count = s->moving.surface.node_count;
  for (int32_t n = 0; n < count; n++) {
    s->moving.x[3 * n + 2] = -depth;
    s->v[n][0] = 1.0;
    for (int c = 0; c < 3; c++) s->free[n][c] = 1.0, s->x[n][c] = s->moving.x[3 * n + c];
  }
  must(ct_contact_create, &s->moving.surface, &s->held.surface, options, &s->contact);
  later_contact(s->contact);
}

static void take_steps(slide *s, int first, int last)
{
  const double dt = 0.02;
  ct_error e;
  double start = kinetic(s);
  for (int step = first; step < last; step++) {
    double force[NODES][3] = {{0.0}}, other[NODES][3] = {{0.0}};
    const double kick = step == 0 ? 0.5 * dt : dt;
    const ct_contact_prediction p = {.x_a = s->x[0],
                                     .x_b = s->held.x,
                                     .velocity_a = s->v[0],
                                     .velocity_b = s->rest[0],
                                     .inverse_mass_a = s->free[0],
                                     .inverse_mass_b = s->none[0],
                                     .dt = dt,
                                     .force_time = kick};
    must(ct_contact_step, s->contact, &p);
    need(ct_contact_add_force(s->contact, force[0], other[0], NULL), &e);
    for (int32_t n = 0; n < s->moving.surface.node_count; n++)
      for (int c = 0; c < 3; c++) {
        s->v[n][c] += kick * force[n][c];
        s->x[n][c] += dt * s->v[n][c];
        if (c == 2) s->pressed = fmax(s->pressed, fabs(force[n][c]));
      }
    s->largest = fmax(s->largest, kinetic(s) / start);
  }
}

/* Points that come in over a border at a depth have no force, whatever the options: the patch
 * slides on. Pressed further in it is pushed back, from where it was found, and gets no more than
 * it had. (eq:admitted) */
static void comes_over_a_border(void)
{
  static const ct_initial INITIAL[] = {CT_INITIAL_KEEP, CT_INITIAL_FORCE, CT_INITIAL_REFUSE,
                                       CT_INITIAL_REMOVE};
  static const ct_enforcement LAWS[] = {CT_ENFORCE_ENERGY_CONTROLLED, CT_ENFORCE_PENALTY};
  for (int law = 0; law < 2; law++)
    for (int i = 0; i < 8; i++) {
      ct_contact_options options = ct_contact_options_default();
      options.epsilon = law == 0 ? 4000.0 : 40.0;
      options.enforcement = LAWS[law];
      options.initial_penetration = INITIAL[i % 4];
      options.removal_time = 0.1;
      options.restitution = 1.0, options.travel_time = 0.01;
      options.points = i < 4 ? CT_POINTS_GAUSS : CT_POINTS_LOBATTO;
      slide s;
      open_slide(&s, &options, 0.2);
      take_steps(&s, 0, 80);
      double appeared = s.pressed;
      for (int32_t n = 0; n < s.moving.surface.node_count; n++) s.v[n][2] = 0.5;
      s.largest = 0.0;
      take_steps(&s, 80, 110);
      double pushed = s.pressed;
      tap_ok(
          appeared < 1e-12 && pushed < 1e-12 && s.largest <= 1.0,
          "law %d, initial %d, rule %d: comes in from the side with a force of %g, opens with %g",
          law, i % 4, i / 4, appeared, pushed);
    }
}

/* Pressed further in, the same patch is pushed back from the depth at which it was found. */
static void pressed_further(void)
{
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = 4000.0, options.restitution = 1.0, options.travel_time = 0.01;
  slide s;
  open_slide(&s, &options, 0.1);
  take_steps(&s, 0, 80);
  for (int32_t n = 0; n < s.moving.surface.node_count; n++) s.v[n][2] = -0.5;
  s.largest = 0.0;
  take_steps(&s, 80, 100);
  double lowest = 0.0;
  for (int32_t n = 0; n < s.moving.surface.node_count; n++) lowest = fmin(lowest, s.x[n][2]);
  tap_ok(s.pressed > 0.0 && s.largest <= 1.0 + 1e-12 && lowest < -0.1,
         "pressed further in, it is pushed back with forces of up to %g, and its energy is at most "
         "%.3g of that of before",
         s.pressed, s.largest);
}

/* The raise of both gaps is the smallest with which a row claims at most what it may.
 * (eq:admitted-store) */
static void raises_are_least(void)
{
  double off = 0.0;
  int raised = 0, more = 0;
  for (int i = 0; i < 2000; i++) {
    ct_constraint row = {.enforcement = i % 4 ? CT_ENFORCE_ENERGY_CONTROLLED : CT_ENFORCE_PENALTY,
                         .stiffness = 1.0 + 0.5 * uniform(1.0),
                         .gap = uniform(1.0),
                         .before = uniform(1.0)};
    const double most = i % 3 ? 0.1 * (1.0 + uniform(1.0)) : 0.0, claim = ct_law_claim(&row),
                 raise = ct_law_raise(&row, most);
    // By hand: the mean of both parabolas, or the last one.
    const double deep = fmin(row.gap, 0.0), was = fmin(row.before, 0.0),
                 hand = i % 4 ? 0.25 * row.stiffness * (deep * deep + was * was)
                              : 0.5 * row.stiffness * deep * deep;
    off = fmax(off, fabs(claim - hand));
    if (claim <= most) {
      more += raise > 1e-12;
      continue;
    }
    raised++;
    row.gap += raise, row.before += raise;
    off = fmax(off, fabs(ct_law_claim(&row) - most));
    row.gap -= 1e-6, row.before -= 1e-6;
    more += !(ct_law_claim(&row) > most);
  }
  tap_ok(off < 1e-14 && more == 0 && raised > 500,
         "%d rows claim what they may after the least raise, off by %.1e, %d by more than needed",
         raised, off, more);
}

int main(void)
{
  free_at_end();
  comes_over_a_border();
  pressed_further();
  raises_are_least();
  return tap_done();
}
