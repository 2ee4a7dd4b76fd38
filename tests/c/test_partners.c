/* Whatever the points of a surface meet, another surface or an obstacle of any shape and size, has
 * start gaps, penetration, the tunnelling check, the choice of points and a memory: one table of
 * partners, one test for all. A shape that is added is tested without a line here. */
#include "../../libcontact/src/contact/obstacle.h"
#include "patches.h"

enum { CELLS = 4 };
static const double OVERLAP = 0.02, REMOVAL = 0.5;

/* A partner beneath a square: with a radius, or another surface for the shape -1. */
typedef struct partner {
  int shape;
  double radius;
  char name[64];
} partner;

/* Settings of a run. */
typedef struct setting {
  ct_initial initial;
  double adjust;
  ct_contact_rule points;
} setting;

/* The square over a partner whose highest place is at the origin. */
typedef struct over {
  patch square, floor;
  ct_contact_fixed *fixed;
  ct_contact *state;
  double *x, *velocity, *memory, *next, *force, *start; /* of all nodes of the interaction */
} over;

static ct_interaction *obstacle_of(const partner *what, const ct_surface *surface, setting set)
{
  const ct_obstacle_kind *kind = ct_obstacle_kind_of((ct_obstacle_shape)what->shape);
  ct_obstacle_def def = ct_obstacle_def_default();
  ct_interaction *is = NULL;
  def.shape = (ct_obstacle_shape)what->shape;
  def.axis[kind->is_round ? 0 : 2] = 1.0;
  def.radius = what->radius, def.point[2] = -what->radius;
  def.epsilon = EPSILON, def.enforcement = CT_ENFORCE_PENALTY;
  def.initial_penetration = set.initial, def.removal_time = REMOVAL;
  def.adjust = set.adjust, def.points = set.points;
  must(ct_obstacle_create, &def, surface, NULL, &is);
  return is;
}

static ct_contact_fixed *contact_of(const over *o, setting set)
{
  const ct_surface *const surface[2] = {&o->square.surface, &o->floor.surface};
  ct_contact_options options = ct_contact_options_default();
  ct_contact_fixed *fixed = NULL;
  options.epsilon = EPSILON, options.enforcement = CT_ENFORCE_PENALTY;
  options.initial_penetration = set.initial, options.removal_time = REMOVAL;
  options.adjust = set.adjust, options.points = set.points;
  must(ct_contact_fixed_create, surface, 2, &options, &fixed);
  return fixed;
}

/* The square with its middle node `height` above the partner. */
static over open_over(const partner *what, setting set, double height)
{
  over o = {.square = new_patch(CT_Q4, CELLS, CELLS, -0.5, -0.5, 1, 1, 0),
            .floor = new_patch(CT_Q4, CELLS, CELLS, -0.5, -0.5, 1, 1, 1)};
  for (int n = 0; n < o.square.surface.node_count; n++) o.square.x[3 * n + 2] = height;
  o.fixed = what->shape < 0 ? contact_of(&o, set)
                            : (ct_contact_fixed *)obstacle_of(what, &o.square.surface, set);
  must(ct_contact_open, o.fixed, &o.state);
  const int all = 3 * o.fixed->is.node_count;
  o.x = numbers(all), o.velocity = numbers(all), o.force = numbers(all), o.start = numbers(all);
  o.memory = numbers(o.fixed->is.memory_count), o.next = numbers(o.fixed->is.memory_count);
  for (int s = 0; s < ct_gaps_surfaces(&o.fixed->gaps); s++) {
    const ct_search *search = o.fixed->gaps.side[s].search;
    for (int32_t n = 0; n < search->node_count; n++)
      memcpy(&o.start[3 * ct_gaps_node(&o.fixed->gaps, s, n)], &search->x[3 * n],
             3 * sizeof *o.start);
  }
  return o;
}

static void close_over(over *o)
{
  ct_contact_close(o->state);
  ct_contact_fixed_free(o->fixed);
}

/* One evaluation at a time with the square moved by `dz` from where it began, at the velocity `vz`;
 * returns the status of the gaps. */
static ct_status evaluate(over *o, double time, double before, double dz, double vz, ct_error *e)
{
  const int32_t square = o->fixed->gaps.side[0].search->node_count;
  memcpy(o->x, o->start, 3 * (size_t)o->fixed->is.node_count * sizeof *o->x);
  memset(o->velocity, 0, 3 * (size_t)o->fixed->is.node_count * sizeof *o->x);
  for (int32_t n = 0; n < square; n++) {
    const int64_t z = 3 * (int64_t)ct_gaps_node(&o->fixed->gaps, 0, n) + 2;
    o->x[z] += dz, o->velocity[z] = vz;
  }
  const ct_surface_motion now = {.time = time,
                                 .before = before,
                                 .dt = 0.01,
                                 .threads = 1,
                                 .x = o->x,
                                 .velocity = o->velocity,
                                 .memory = o->memory,
                                 .next_memory = o->next};
  ct_status status = o->fixed->is.calls->place(o->state, &now, e);
  if (status != CT_OK) return status;
  need(o->fixed->is.calls->find_forces(o->state, &now, o->force, e), e);
  double *keep = o->memory;
  o->memory = o->next, o->next = keep;
  return CT_OK;
}

/* Force on the square away from the partner. */
static double push_of(const over *o)
{
  double sum = 0.0;
  for (int32_t n = 0; n < o->fixed->gaps.side[0].search->node_count; n++)
    sum += o->force[3 * (int64_t)ct_gaps_node(&o->fixed->gaps, 0, n) + 2];
  return sum;
}

static double depth_at(const over *o, ct_penetration_at at)
{
  ct_penetration found;
  must(ct_contact_penetration, o->state, at, &found);
  return found.deepest;
}

/* eq:initial-shift, eq:initial-fade, eq:initial-adjust. */
static void start_gaps(const partner *what)
{
  ct_error e;
  over o = open_over(what, (setting){CT_INITIAL_FORCE, 0.0, CT_POINTS_GAUSS}, -OVERLAP);
  must(evaluate, &o, 0.0, 0.0, 0.0, 0.0);
  const double pushed = push_of(&o);
  tap_ok(pushed > 0.0, "%s: an overlap that is not treated presses with %.3g", what->name, pushed);
  close_over(&o);

  o = open_over(what, (setting){CT_INITIAL_REFUSE, 0.0, CT_POINTS_GAUSS}, -OVERLAP);
  tap_ok(evaluate(&o, 0.0, 0.0, 0.0, 0.0, &e) == CT_ERROR_GEOMETRY &&
             strstr(e.text, "inside at the start") != NULL,
         "%s: or it is refused: %.60s ...", what->name, e.text);
  close_over(&o);

  o = open_over(what, (setting){CT_INITIAL_KEEP, 0.0, CT_POINTS_GAUSS}, -OVERLAP);
  must(evaluate, &o, 0.0, 0.0, 0.0, 0.0);
  const double kept = push_of(&o);
  must(evaluate, &o, 0.01, 0.01, -0.005, -0.5);
  tap_ok(kept == 0.0 && push_of(&o) > 0.0 && push_of(&o) < pushed,
         "%s: or it is kept, and presses with %.3g once it grows", what->name, push_of(&o));
  close_over(&o);

  o = open_over(what, (setting){CT_INITIAL_REMOVE, 0.0, CT_POINTS_GAUSS}, -OVERLAP);
  ct_interaction_energy energy;
  must(evaluate, &o, 0.0, 0.0, 0.0, 0.0);
  const double first = push_of(&o);
  must(evaluate, &o, REMOVAL, 0.01, 0.0, 0.0);
  o.fixed->is.calls->find_energy(o.state, &energy);
  tap_ok(first == 0.0 && fabs(push_of(&o) - pushed) < 1e-12 * pushed && energy.removal > 0.0,
         "%s: or it is removed with the work %.3g", what->name, energy.removal);
  close_over(&o);

  o = open_over(what, (setting){CT_INITIAL_KEEP, 0.01, CT_POINTS_LOBATTO}, 0.005);
  must(evaluate, &o, 0.0, 0.0, 0.0, 0.0);
  const double apart = push_of(&o);
  must(evaluate, &o, 0.01, 0.01, -0.001, -0.1);
  tap_ok(apart == 0.0 && push_of(&o) > 0.0, "%s: a gap that is adjusted counts as touching",
         what->name);
  close_over(&o);
}

/* The middle node is over the highest place of each partner: a corner, and a Lobatto point.
 * eq:unseen.
 */
static void penetration(const partner *what)
{
  for (int rule = CT_POINTS_GAUSS; rule <= CT_POINTS_LOBATTO; rule++) {
    over o = open_over(what, (setting){CT_INITIAL_FORCE, 0.0, (ct_contact_rule)rule}, -OVERLAP);
    must(evaluate, &o, 0.0, 0.0, 0.0, 0.0);
    const double points = depth_at(&o, CT_AT_POINTS), corners = depth_at(&o, CT_AT_CORNERS),
                 edges = depth_at(&o, CT_AT_EDGES);
    tap_ok(fabs(corners - OVERLAP) < 1e-12 && edges <= corners + 1e-12 && points > 0.0 &&
               (rule == CT_POINTS_GAUSS ? points <= corners + 1e-12
                                        : fabs(points - corners) < 1e-12) &&
               o.fixed->gaps.side[0].rule.count == (rule == CT_POINTS_GAUSS ? 4 : 9),
           "%s: with %s points it is %.4g deep at them, %.4g at corners, %.4g on edges", what->name,
           rule == CT_POINTS_GAUSS ? "Gauss" : "Lobatto", points, corners, edges);
    close_over(&o);
  }
}

/* A step in which the square moves through its partner is refused, with a half-space as the only
 * exception: nothing is behind it. eq:tunnelling. */
static void tunnelling(const partner *what)
{
  ct_error e = {0};
  over o = open_over(what, (setting){CT_INITIAL_KEEP, 0.0, CT_POINTS_GAUSS}, 0.1);
  const int open = !isfinite(o.fixed->gaps.approach);
  const double way = open ? 9.0 : 0.1 + 2.0 * fmax(what->radius, o.fixed->gaps.approach);
  must(evaluate, &o, 0.0, 0.0, 0.0, 0.0);
  must(evaluate, &o, 0.01, 0.01, -0.05, -5.0);
  ct_status status = evaluate(&o, 0.02, 0.01, -way - 0.05, -way / 0.01, &e);
  tap_ok(open ? status == CT_OK && push_of(&o) > 0.0
              : status == CT_ERROR_STEP && strstr(e.text, "passed through each other") != NULL,
         "%s: %s", what->name, open ? "it has no other side" : "a step through it is refused");
  close_over(&o);
}

/* Another state goes on from the memory with the same bits. */
static void memory(const partner *what)
{
  const setting set = {CT_INITIAL_REMOVE, 0.0, CT_POINTS_LOBATTO};
  over a = open_over(what, set, -OVERLAP), b = open_over(what, set, -OVERLAP);
  for (int n = 0; n < 3; n++) must(evaluate, &a, 0.01 * n, n > 0 ? 0.01 : 0.0, -0.002 * n, -0.2);
  memcpy(b.memory, a.memory, (size_t)a.fixed->is.memory_count * sizeof *a.memory);
  must(evaluate, &a, 0.03, 0.01, -0.006, -0.2);
  must(evaluate, &b, 0.03, 0.01, -0.006, -0.2);
  const size_t size = 3 * (size_t)a.fixed->is.node_count * sizeof *a.force;
  tap_ok(push_of(&a) > 0.0 && memcmp(a.force, b.force, size) == 0 &&
             memcmp(a.memory, b.memory, (size_t)a.fixed->is.memory_count * sizeof *a.memory) == 0,
         "%s: its memory has all that the next step needs", what->name);
  close_over(&a), close_over(&b);
}

static void all_of(partner what)
{
  start_gaps(&what);
  penetration(&what);
  tunnelling(&what);
  memory(&what);
}

int main(void)
{
  free_at_end();
  all_of((partner){-1, 0.0, "surface"});
  const ct_obstacle_kind *kind;
  for (int shape = 0; (kind = ct_obstacle_kind_of((ct_obstacle_shape)shape)) != NULL; shape++)
    for (int small = 0; small <= kind->is_round; small++) {
      partner what = {shape, !kind->is_round ? 0.0 : small ? 0.2 : 3.0, ""};
      snprintf(what.name, sizeof what.name, "%s%s", small ? "small " : "", kind->name);
      all_of(what);
    }
  return tap_done();
}
