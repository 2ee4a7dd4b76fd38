/* Memory of a contact for its points, step by step by hand: all numbers that one step leaves for
 * the next go through the effect's memory here. */
#include "../../libcontact/src/effect/contact.h"
#include "patches.h"

/* The contact effect of two surfaces of one problem, evaluated step by step; only its memory is
 * passed from one step to the next. */
typedef struct hand {
  ct_effect *effect;
  patch a, b; /* both over the nodes of the problem */
  int nodes, first_b;
  double start; /* place of the second surface at the start: its displacement counts from there */
  double *reference, *mass, *u, *rest, *memory, *next, *force;
} hand;

/* A patch of the problem with all nodes, from one with its own. */
static patch joined(const patch *own, int first, int nodes, const double *reference)
{
  int entries = own->surface.face_count * ct_face_node_count(own->surface.kind);
  patch p = {own->surface, integers(entries), NULL};
  for (int i = 0; i < entries; i++) p.faces[i] = own->faces[i] + first;
  p.surface.faces = p.faces;
  p.surface.node_count = nodes;
  p.surface.reference = reference;
  return p;
}

static hand new_hand(const patch *a, const patch *b, const ct_contact_options *options)
{
  hand h = {.nodes = a->surface.node_count + b->surface.node_count,
            .first_b = a->surface.node_count};
  h.reference = numbers(3 * h.nodes);
  memcpy(h.reference, a->x, 3 * (size_t)h.first_b * sizeof(double));
  memcpy(h.reference + 3 * h.first_b, b->x, 3 * (size_t)b->surface.node_count * sizeof(double));
  h.a = joined(a, 0, h.nodes, h.reference);
  h.b = joined(b, h.first_b, h.nodes, h.reference);
  h.mass = numbers(h.nodes), h.u = numbers(3 * h.nodes), h.rest = numbers(3 * h.nodes),
  h.force = numbers(3 * h.nodes);
  for (int n = 0; n < h.nodes; n++) h.mass[n] = 1.0;
  const ct_problem problem = {.node_count = h.nodes, .reference = h.reference, .mass = h.mass};
  ct_contact_def def = ct_contact_def_default();
  def.a = &h.a.surface, def.b = &h.b.surface, def.options = *options;
  def.options.cookie = ct_contact_options_default().cookie; // some tests set all other members
  must(ct_contact_create_effect, &def, &problem, &h.effect);
  later_effect(h.effect);
  h.memory = numbers(h.effect->memory_count);
  h.next = numbers(h.effect->memory_count);
  return h;
}

/* One step with the second surface at the height z, with scratch space of its own as after a
 * restart: the force on that surface along z, and the energy. */
static double take(hand *h, double z, double time, double *energy, double *external)
{
  const ct_effect *effect = h->effect;
  void *scratch = NULL;
  for (int n = h->first_b; n < h->nodes; n++) h->u[3 * n + 2] = z - h->start;
  must(effect->calls->create_scratch, effect, &scratch);
  ct_view view = {.time = time,
                  .dt = 0.25,
                  .reference = h->reference,
                  .displacement = h->u,
                  .velocity = h->rest,
                  .memory = h->memory,
                  .next_memory = h->next,
                  .scratch = scratch};
  double *own = numbers(3 * effect->node_count), sum = 0.0, *keep = h->memory;
  must(effect->calls->force, effect, &view, own);
  must(effect->calls->energy, effect, &view, energy);
  if (external != NULL) must(effect->calls->constraints.external, effect, &view, external);
  memset(h->force, 0, 3 * (size_t)h->nodes * sizeof(double));
  for (int i = 0; i < effect->node_count; i++) {
    for (int c = 0; c < 3; c++) h->force[3 * effect->nodes[i] + c] = own[3 * i + c];
    if (effect->nodes[i] >= h->first_b) sum += own[3 * i + 2];
  }
  effect->calls->free_scratch(scratch);
  h->memory = h->next;
  h->next = keep;
  return sum;
}

/* Two squares with one gap everywhere, `start` at the start. */
static hand two_flat_patches(ct_contact_options options, double start)
{
  patch a = new_patch(CT_Q4, 2, 2, 0, 0, 2, 2, 1), b = new_patch(CT_Q4, 2, 2, 0, 0, 2, 2, 0);
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] += start;
  options.epsilon = EPSILON;
  options.enforcement = CT_ENFORCE_PENALTY;
  hand h = new_hand(&a, &b, &options);
  h.start = start;
  return h;
}

/* A gap, and how deep the surfaces are in contact there, counted from the start gap. */
typedef struct opening {
  double gap, depth;
} opening;

/* The start gap of points that open again, computed by hand from eq:initial-shift: it follows the
 * deeper one of the last two gaps, up to zero, and never goes back. (eq:initial-release) */
static void start_gap_opens(void)
{
  static const opening by_hand[] = {
      {-0.05, 0.0},  // begins with the start gap -0.05
      {-0.06, 0.01}, // pressed together by 0.01
      {-0.05, 0.0},    {-0.03, 0.0},
      {-0.05, 0.0}, // -0.03 for one step only: the start gap is -0.05 still
      {-0.06, 0.01},   {-0.03, 0.0},
      {-0.025, 0.0}, // opened for two steps: -0.03
      {-0.04, 0.01},   {0.02, 0.0},
      {-0.01, 0.0}, // out for one step, and -0.01 is the deeper one of the last two
      {-0.015, 0.005}, {0.01, 0.0},
      {0.02, 0.0}, // out for two steps: none is left
      {-0.02, 0.02},   {-0.001, 0.001}};
  hand h = two_flat_patches(ct_contact_options_default(), -0.05);
  double force = 0.0, energy = 0.0, stored;
  for (size_t i = 0; i < sizeof by_hand / sizeof by_hand[0]; i++) {
    double d = by_hand[i].depth;
    force = worst(force,
                  take(&h, by_hand[i].gap, 0.25 * (double)i, &stored, NULL) / (4.0 * EPSILON) - d);
    energy = worst(energy, stored / (2.0 * EPSILON) - d * d);
  }
  tap_ok(force < 1e-15 && energy < 1e-16,
         "start gaps of points that open again are those by hand (force off by %.2g, "
         "energy by %.2g)",
         force, energy);
  // Far away no face is near, and the start gap is gone.
  h = two_flat_patches((ct_contact_options){.method = CT_ROBUST,
                                            .tolerance = 1e-10,
                                            .threads = 1,
                                            .initial_penetration = CT_INITIAL_KEEP},
                       -0.05);
  static const opening away[] = {
      {-0.05, 0.0}, {50.0, 0.0}, {50.0, 0.0}, {0.02, 0.0}, {-0.03, 0.03}};
  force = 0.0;
  for (int i = 0; i < 5; i++)
    force = worst(force,
                  take(&h, away[i].gap, 0.25 * i, &stored, NULL) / (4.0 * EPSILON) - away[i].depth);
  tap_ok(force < 1e-15, "a start gap is gone once the surfaces were far apart (force off by %.2g)",
         force);
}

/* Gaps of one step after another, and the depths that are expected of them. */
typedef struct course {
  const char *what;
  double adjust;
  ct_initial initial;
  int count;
  opening step[12];
} course;

/* Gaps and overlaps within the distance `adjust` count as touching, computed by hand from
 * eq:initial-adjust: the start gap stays until the point has opened by more than this for two
 * steps. (eq:initial-facing, eq:initial-release) */
static void start_gaps_are_adjusted(void)
{
  static const course courses[] = {
      {"a gap within the distance",
       0.05,
       CT_INITIAL_KEEP,
       11,
       {{0.03, 0.0},
        {0.02, 0.01},
        {-0.01, 0.04},
        {0.07, 0.0},
        {0.07, 0.0},
        {0.025, 0.005},
        {0.09, 0.0},
        {0.02, 0.01}, // opened too little, or for one step
        {0.09, 0.0},
        {0.085, 0.0},
        {0.02, 0.0}}}, // opened by 0.055: gone
      {"an overlap within the distance",
       0.05,
       CT_INITIAL_FORCE,
       11,
       {{-0.03, 0.0},
        {-0.04, 0.01},
        {0.015, 0.0},
        {0.015, 0.0},
        {-0.035, 0.005}, // opened by less than the distance
        {0.03, 0.0},
        {0.03, 0.0},
        {-0.03, 0.01}, // by more: the start gap follows 0.05 behind, to -0.02
        {0.06, 0.0},
        {0.06, 0.0},
        {-0.01, 0.01}}},
      {"a gap beyond the distance",
       0.05,
       CT_INITIAL_KEEP,
       3,
       {{0.06, 0.0}, {0.04, 0.0}, {-0.01, 0.01}}},
      {"an overlap beyond the distance, pushed",
       0.05,
       CT_INITIAL_FORCE,
       2,
       {{-0.06, 0.06}, {-0.05, 0.05}}},
      {"an overlap beyond the distance, kept",
       0.05,
       CT_INITIAL_KEEP,
       3,
       {{-0.08, 0.0}, {-0.09, 0.01}, {-0.06, 0.0}}},
      {"no distance: a gap", 0.0, CT_INITIAL_KEEP, 3, {{0.03, 0.0}, {0.02, 0.0}, {-0.01, 0.01}}}};
  for (size_t k = 0; k < sizeof courses / sizeof courses[0]; k++) {
    const course *c = &courses[k];
    hand h = two_flat_patches((ct_contact_options){.method = CT_ROBUST,
                                                   .tolerance = 1e-10,
                                                   .threads = 1,
                                                   .initial_penetration = c->initial,
                                                   .adjust = c->adjust},
                              c->step[0].gap);
    double force = 0.0, energy = 0.0, stored;
    for (int i = 0; i < c->count; i++) {
      double d = c->step[i].depth;
      force = worst(force, take(&h, c->step[i].gap, 0.25 * i, &stored, NULL) / (4.0 * EPSILON) - d);
      energy = worst(energy, stored / (2.0 * EPSILON) - d * d);
    }
    tap_ok(force < 1e-15 && energy < 1e-16,
           "%s: forces and energy by hand (force off by %.2g, energy by %.2g)", c->what, force,
           energy);
  }
}

/* Energy and forces of a contact at the displacement `u`, from the memory of the last step, which
 * stays. */
static double evaluate(hand *h, double *force)
{
  const ct_effect *effect = h->effect;
  void *scratch = NULL;
  double energy, *own = numbers(3 * effect->node_count);
  must(effect->calls->create_scratch, effect, &scratch);
  ct_view view = {.time = 1.0,
                  .reference = h->reference,
                  .displacement = h->u,
                  .velocity = h->rest,
                  .memory = h->memory,
                  .next_memory = h->next,
                  .scratch = scratch};
  must(effect->calls->force, effect, &view, own);
  must(effect->calls->energy, effect, &view, &energy);
  memset(force, 0, 3 * (size_t)h->nodes * sizeof *force);
  for (int i = 0; i < effect->node_count; i++)
    memcpy(&force[3 * effect->nodes[i]], &own[3 * i], 3 * sizeof *own);
  effect->calls->free_scratch(scratch);
  return energy;
}

/* Two warped patches on different meshes with overlaps and gaps, which are adjusted; then pressed
 * together. */
static hand two_warped_patches(ct_face_kind kind)
{
  patch a = new_patch(kind, 3, 3, 0, 0, 2, 2, 1),
        b = new_patch(kind, 4, 2, 0.13, 0.11, 1.7, 1.7, 0);
  for (int n = 0; n < a.surface.node_count; n++)
    a.x[3 * n + 2] = 0.03 * sin(4.0 * a.x[3 * n]) * cos(3.0 * a.x[3 * n + 1]);
  for (int n = 0; n < b.surface.node_count; n++)
    b.x[3 * n + 2] = 0.03 * cos(5.0 * b.x[3 * n] + 1.0);
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = EPSILON;
  options.enforcement = CT_ENFORCE_PENALTY;
  options.adjust = 0.2;
  hand h = new_hand(&a, &b, &options);
  return h;
}

/* With start gaps of both signs: no force at the start, then minus the gradient of one potential,
 * and both momenta. (eq:initial-shift) */
static void start_gaps_have_a_potential(ct_face_kind kind, const char *name)
{
  hand h = two_warped_patches(kind);
  double *f = numbers(3 * h.nodes), *other = numbers(3 * h.nodes), stored, size = 0.0, off = 0.0,
         sum[3] = {0}, moment[3] = {0};
  double begin = fabs(take(&h, 0.0, 0.0, &stored, NULL));
  for (int i = 0; i < 3 * h.nodes; i++) begin = worst(begin, h.force[i]);
  tap_ok(begin == 0.0 && stored == 0.0,
         "%s: surfaces with overlaps and gaps, adjusted, begin without force and energy", name);
  for (int n = 0; n < h.nodes; n++) {
    double w = n < h.first_b ? 0.0 : -0.01;
    for (int c = 0; c < 3; c++)
      h.u[3 * n + c] = 0.001 * sin(7.0 * n + 2.0 * c) + (c == 2 ? w : 0.5 * w);
  }
  stored = evaluate(&h, f);
  for (int i = 0; i < 3 * h.nodes; i++) {
    const double step = 1e-6;
    double *u = &h.u[i], keep = *u;
    size = fmax(size, fabs(f[i]));
    *u = keep + step;
    double up = evaluate(&h, other);
    *u = keep - step;
    off = worst(off, f[i] + (up - evaluate(&h, other)) / (2.0 * step));
    *u = keep;
  }
  tap_ok(
      stored > 0.0 && off < 1e-9 * size,
      "%s: with start gaps of both signs forces are minus the gradient of the energy (off by %.2g)",
      name, off / size);
  for (int n = 0; n < h.nodes; n++)
    for (int c = 0; c < 3; c++) {
      int p = (c + 1) % 3, q = (c + 2) % 3;
      sum[c] += f[3 * n + c];
      moment[c] += (h.reference[3 * n + p] + h.u[3 * n + p]) * f[3 * n + q] -
                   (h.reference[3 * n + q] + h.u[3 * n + q]) * f[3 * n + p];
    }
  double lost = worst(worst(sum[0], sum[1]), sum[2]),
         turned = worst(worst(moment[0], moment[1]), moment[2]);
  tap_ok(lost < 1e-13 * size && turned < 1e-13 * size,
         "%s: with start gaps linear and angular momentum are conserved (%.2g, %.2g)", name,
         lost / size, turned / size);
}

/* A start gap that fades while the point opens: at T / 2 half of it is left, so a point that stands
 * at the start gap is pressed by the other half; where it has opened farther the start gap follows,
 * divided by what is left of the fade. The work is that of the trapezoid. (eq:initial-fade,
 * eq:initial-work) */
static void start_gap_fades(void)
{
  const double T = 2.0, g0 = -0.04, area = 4.0, half = 0.5,
               tail = 0.5 * (1.0 - sqrt(0.5)); // φ at T / 2 and 3 T / 4
  hand h = two_flat_patches((ct_contact_options){.method = CT_ROBUST,
                                                 .tolerance = 1e-10,
                                                 .threads = 1,
                                                 .initial_penetration = CT_INITIAL_REMOVE,
                                                 .removal_time = T},
                            g0);
  double off = 0.0, stored, work, F1 = EPSILON * area * (half * g0 - g0), F2, g2 = -0.01 / half;
  off = worst(off, take(&h, g0, 0.0, &stored, &work));
  off = worst(off, work);
  off = worst(off, take(&h, g0, 0.5 * T, &stored, &work) - F1);
  off = worst(off, work - 0.5 * F1 * g0 * (half - 1.0));
  // Twice at -0.01, above φ g0 = -0.02: the start gap becomes -0.01 / φ, and there is no force.
  double before = work;
  off = worst(off, take(&h, -0.01, 0.5 * T, &stored, &work));
  off = worst(off, take(&h, -0.01, 0.5 * T, &stored, &work));
  off = worst(off, work - before);
  // It fades on from there.
  F2 = EPSILON * area * (tail * g2 + 0.01);
  off = worst(off, take(&h, -0.01, 0.75 * T, &stored, &work) - F2);
  off = worst(off, work - before - 0.5 * F2 * g2 * (tail - half));
  tap_ok(off < 1e-16 * EPSILON * area,
         "a start gap that fades and opens: forces and work by hand, off by %.2g",
         off / (EPSILON * area));
}

/* A point is in contact at any depth if it came in from outside, and not in contact if it begins
 * deep. One that was outside and is at once deeper than the depth (which a run refuses,
 * eq:tunnelling) has no face near: no contact, and a new point afterwards, whose gap counts from
 * where it is found inside until it has opened (eq:admitted). The sign in the memory distinguishes
 * these cases. (eq:point-status) */
static void history_in_memory(void)
{
  static const double in[] = {0.1, -0.2, -0.5, -0.9, -0.4, -0.1, 0.05, -0.1},
                      deep[] = {-0.5, -0.2, -0.1, 0.05, -0.1},
                      leap[] = {0.1, -0.5, -0.1, 0.1, 0.1, -0.1};
  static const int count[3] = {8, 5, 6},
                   pressed[3][8] = {{0, 1, 1, 1, 1, 1, 0, 1}, {0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1}};
  static const double *const gaps[3] = {in, deep, leap};
  static const char *const what[3] = {"comes in from outside", "begins deep",
                                      "is outside, and then too deep at once"};
  for (int k = 0; k < 3; k++) {
    hand h = two_flat_patches(
        (ct_contact_options){.method = CT_ROBUST, .tolerance = 1e-10, .threads = 1, .depth = 0.3},
        gaps[k][0]);
    double off = 0.0, stored;
    for (int i = 0; i < count[k]; i++)
      off = worst(off, take(&h, gaps[k][i], 0.25 * i, &stored, NULL) / (4.0 * EPSILON) -
                           (pressed[k][i] ? -gaps[k][i] : 0.0));
    tap_ok(off < 1e-14,
           "a surface that %s, restarted in every step, has the force of its gap where it is in "
           "contact (off by %.2g)",
           what[k], off);
  }
}

/* Thin closed plates pressed into each other: the host's contact stores its history itself, the
 * effect in its memory, with a restart in each step. Both must agree. The host's energy has a
 * closed form (test_contact_geometry). */
static void same_as_the_host(void)
{
  const double low_a[3] = {0, 0, 0}, size_a[3] = {2, 2, 0.1}, low_b[3] = {0.63, 0.59, 0.1001},
               size_b[3] = {0.8, 0.8, 0.1};
  static const int cells_a[3] = {5, 5, 1}, cells_b[3] = {3, 3, 1};
  patch a = new_box(low_a, size_a, cells_a), b = new_box(low_b, size_b, cells_b);
  ct_contact_options options = ct_contact_options_default();
  options.epsilon = EPSILON;
  options.enforcement = CT_ENFORCE_PENALTY;
  ct_contact *contact = open_contact(&a, &b, options);
  hand h = new_hand(&a, &b, &options);
  double *fa = numbers(3 * a.surface.node_count), *fb = numbers(3 * b.surface.node_count),
         *z = numbers(b.surface.node_count), stored, deepest = 0.0;
  int different = 0;
  for (int n = 0; n < b.surface.node_count; n++) z[n] = b.x[3 * n + 2];
  for (int i = 0; i <= 120; i++) {
    double moved = -0.0025 * (i <= 60 ? i : 120 - i);
    for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = z[n] + moved;
    update(contact, &a, &b);
    forces(contact, &a, &b, fa, fb);
    take(&h, moved, 0.25 * i, &stored, NULL);
    different +=
        memcmp(fa, h.force, 3 * (size_t)h.first_b * sizeof *fa) != 0 ||
        memcmp(fb, h.force + 3 * h.first_b, 3 * (size_t)(h.nodes - h.first_b) * sizeof *fb) != 0;
    different += stored != ct_contact_energy(contact);
    deepest = fmax(deepest, stored);
  }
  tap_ok(different == 0 && deepest > 0.0,
         "thin plates, restarted in every step: forces and energy have the bits of a contact that "
         "keeps its history (%d differ)",
         different);
}

/* Two states of one effect share constant data only; definitions that do not start from their
 * default are refused. */
static void states_share(void)
{
  hand h = two_flat_patches(ct_contact_options_default(), 0.02);
  void *scratch[2] = {NULL, NULL};
  ct_error e;
  for (int k = 0; k < 2; k++) must(h.effect->calls->create_scratch, h.effect, &scratch[k]);
  const ct_contact *a = ct_touch_state(scratch[0]), *b = ct_touch_state(scratch[1]);
  int shared = a->fixed == b->fixed, own = a->own == NULL && b->own == NULL;
  for (int s = 0; s < 2; s++) {
    const ct_side *x = &a->gaps.side[s], *y = &b->gaps.side[s];
    shared &= x->search->faces == y->search->faces && x->search->nodes == y->search->nodes &&
              x->search->faces == a->fixed->gaps.side[s].search->faces &&
              x->points[0].row.own_shape == y->points[0].row.own_shape &&
              x->points[0].row.own == y->points[0].row.own;
    own &= x->search->x != y->search->x && x->search->boxes != y->search->boxes &&
           x->search->tree != y->search->tree && x->points != y->points &&
           x->search->x != a->fixed->gaps.side[s].search->x;
  }
  tap_ok(shared && own, "two states share topology, shape functions and weights; coordinates, "
                        "boxes, trees and points are their own");
  for (int k = 0; k < 2; k++) h.effect->calls->free_scratch(scratch[k]);
  const ct_problem problem = {.node_count = h.nodes, .reference = h.reference, .mass = h.mass};
  ct_effect *effect = NULL;
  ct_contact_def contact = ct_contact_def_default(), foreign;
  contact.a = &h.a.surface, contact.b = &h.b.surface, contact.options.epsilon = EPSILON;
  ct_obstacle_def obstacle = ct_obstacle_def_default();
  ct_friction_def friction = ct_friction_def_default();
  friction.on = h.effect, friction.coefficient = 0.3;
  contact.cookie++, obstacle.cookie++, friction.cookie++;
  tap_ok(ct_contact_create_effect(&contact, &problem, &effect, &e) == CT_ERROR_ARGUMENT &&
             ct_obstacle_create_effect(&obstacle, &problem, &effect, &e) == CT_ERROR_ARGUMENT &&
             ct_friction_create_effect(&friction, &problem, &effect, &e) == CT_ERROR_ARGUMENT &&
             effect == NULL,
         "definitions without their cookie are refused: %s", e.text);
  foreign = contact;
  foreign.cookie--;
  ct_surface elsewhere = h.b.surface;
  elsewhere.reference = h.u;
  foreign.b = &elsewhere;
  tap_ok(ct_contact_create_effect(&foreign, &problem, &effect, &e) == CT_ERROR_ARGUMENT &&
             effect == NULL,
         "a surface with other nodes than the problem's is refused: %s", e.text);
  contact.cookie--;
  tap_ok(ct_contact_create_effect(&contact, &problem, &effect, &e) == CT_ERROR_ARGUMENT &&
             effect == NULL && strstr(e.text, "travel_time") && strstr(e.text, "restitution 0"),
         "by default a contact needs its travel time: %s", e.text);
  contact.options.restitution = 0.0;
  tap_ok(ct_contact_create_effect(&contact, &problem, &effect, &e) == CT_OK,
         "but not with restitution 0");
  later_effect(effect);
  effect = NULL;
  friction.cookie--;
  ct_status status = ct_friction_create_effect(&friction, &problem, &effect, &e);
  tap_ok(status == CT_OK && effect->kind == CT_EFFECT_FRICTION, "with the cookie it is accepted");
  later_effect(effect);
}

/* A point is off the corner of a quadratic brick while nodes on the edges there move until the
 * faces are inverted. The point must not count as inside (eq:gap-bound). */
static void corner_turned_inside_out(void)
{
  enum { STEPS = 80 };
  double lowest = HUGE_VAL, energy = 0.0, x[60],
         corners[12] = {1.2, 1.15, 1.3, 1.2, 1.25, 1.3, 1.3, 1.25, 1.3, 1.3, 1.15, 1.3};
  int32_t outer[48], square[4] = {0, 1, 2, 3};
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 1, 1, 1);
  ct_surface brick = {CT_Q8, 20, ct_mesh_outer_faces(m, outer, NULL), outer, m->nodes},
             square_patch = {CT_Q4, 4, 1, square, corners};
  for (int edges = 1; edges < 8; edges++) {
    ct_contact *contact = NULL;
    ct_contact_options options = ct_contact_options_default();
    ct_contact_point point[4 + 6 * 9];
    options.epsilon = 1.0;
    must(ct_contact_create, &square_patch, &brick, &options, &contact);
    later_contact(contact);
    for (int step = 0; step <= STEPS; step++) {
      memcpy(x, m->nodes, sizeof x);
      // The middle of an edge along axis c at the corner (1, 1, 1) moves towards the corner, and
      // the edge folds over.
      for (int i = 0; i < 60; i++)
        if (edges >> i % 3 & 1 && m->nodes[i] == 0.5 &&
            m->nodes[i - i % 3 + (i % 3 + 1) % 3] == 1.0 &&
            m->nodes[i - i % 3 + (i % 3 + 2) % 3] == 1.0)
          x[i] += 0.5 * step / STEPS;
      must(ct_contact_update, contact, corners, x);
      ct_contact_points(contact, point, NULL);
      for (int i = 0; i < 4; i++) lowest = fmin(lowest, point[i].gap);
      energy = fmax(energy, ct_contact_energy(contact));
    }
  }
  tap_ok(lowest > 0.3 && energy == 0.0,
         "a point off an inverted corner stays outside: gap %g, energy %g", lowest, energy);
}

int main(void)
{
  free_at_end();
  start_gap_opens();
  start_gaps_are_adjusted();
  start_gaps_have_a_potential(CT_Q4, "Q4");
  start_gaps_have_a_potential(CT_Q8, "Q8");
  start_gaps_have_a_potential(CT_T3, "T3");
  start_gap_fades();
  history_in_memory();
  same_as_the_host();
  states_share();
  corner_turned_inside_out();
  return tap_done();
}
