/* The contract of interactions: contact, obstacle and friction as tables of calls over the nodes of
 * surfaces, without a problem or a host; their effects give the same bits in another numbering. */
#include "../../libcontact/src/effect/contact.h"
#include "patches.h"

/* An interaction, its state, and its arrays at nodes. */
typedef struct touch {
  ct_interaction *is;
  void *state;
  double *x, *velocity, *memory, *next, *force;
} touch;

static touch open_touch(ct_interaction *is)
{
  touch t = {.is = is};
  must(is->calls->open, is, &t.state);
  t.x = numbers(3 * is->node_count), t.velocity = numbers(3 * is->node_count);
  t.force = numbers(3 * is->node_count);
  t.memory = numbers(is->memory_count), t.next = numbers(is->memory_count);
  return t;
}

static void close_touch(touch *t)
{
  t->is->calls->close(t->state);
  t->is->calls->free(t->is);
}

/* One evaluation at the coordinates `x` of all nodes. */
static void evaluate(touch *t, const double *x, const double *velocity, int step)
{
  for (int i = 0; i < 3 * t->is->node_count; i++) {
    t->x[i] = x[3 * t->is->nodes[i / 3] + i % 3];
    t->velocity[i] = velocity[3 * t->is->nodes[i / 3] + i % 3];
  }
  const ct_surface_motion now = {.time = 0.1 * step,
                                 .before = step > 0 ? 0.1 : 0.0,
                                 .dt = 0.1,
                                 .x = t->x,
                                 .velocity = t->velocity,
                                 .memory = t->memory,
                                 .next_memory = t->next};
  must(t->is->calls->place, t->state, &now);
  must(t->is->calls->find_forces, t->state, &now, t->force);
  double *keep = t->memory;
  t->memory = t->next, t->next = keep;
}

/* The effect of the same, whose view has all nodes. */
static void evaluate_effect(const ct_effect *effect, void *scratch, const double *X,
                            const double *u, const double *velocity, int step, double *memory[2],
                            double *force)
{
  const ct_view view = {.time = 0.1 * step,
                        .dt = 0.1,
                        .reference = X,
                        .displacement = u,
                        .velocity = velocity,
                        .memory = memory[step % 2],
                        .next_memory = memory[(step + 1) % 2],
                        .scratch = scratch};
  must(effect->calls->force, effect, &view, force);
}

/* A square slides under a plane. In the problem its nodes come after seven others. */
static void same_as_an_effect(void)
{
  enum { BEFORE = 7, STEPS = 6 };
  patch p = new_patch(CT_Q8, 3, 2, 0, 0, 3, 2, 1);
  const int own = p.surface.node_count, all = own + BEFORE;
  double *X = numbers(3 * all), *u = numbers(3 * all), *v = numbers(3 * all), *mass = numbers(all),
         *x = numbers(3 * all);
  int32_t *faces = integers(8 * p.surface.face_count);
  memcpy(&X[3 * BEFORE], p.x, 3 * (size_t)own * sizeof *X);
  for (int n = 0; n < all; n++) mass[n] = 1.0 + 0.1 * n;
  for (int i = 0; i < 8 * p.surface.face_count; i++) faces[i] = p.faces[i] + BEFORE;
  ct_obstacle_def def = ct_obstacle_def_default();
  def.axis[2] = -1.0, def.epsilon = EPSILON, def.enforcement = CT_ENFORCE_PENALTY;
  def.kind = CT_Q8, def.face_count = p.surface.face_count, def.faces = faces;
  const ct_problem problem = {.node_count = all, .reference = X, .mass = mass};
  const ct_surface surface = {CT_Q8, own, p.surface.face_count, p.faces, p.x};
  ct_interaction *is;
  ct_effect *effect;
  ct_error e;
  must(ct_obstacle_create, &def, &surface, NULL, &is);
  must(ct_obstacle_create_effect, &def, &problem, &effect);
  touch t = open_touch(is);
  void *scratch;
  double *memory[2], *force = numbers(3 * all), *moved = numbers(3 * all), top = 0.0;
  int off = 0;
  must(effect->calls->create_scratch, effect, &scratch);
  for (int i = 0; i < 2; i++) memory[i] = numbers(effect->memory_count);
  for (int step = 0; step < STEPS; step++) {
    for (int n = BEFORE; n < all; n++) {
      u[3 * n] = 0.01 * step, u[3 * n + 2] = 0.003 * step, v[3 * n] = 0.1;
      for (int c = 0; c < 3; c++) x[3 * n + c] = X[3 * n + c] + u[3 * n + c];
    }
    memcpy(moved, &x[3 * BEFORE], 3 * (size_t)own * sizeof *x);
    evaluate(&t, moved, &v[3 * BEFORE], step);
    evaluate_effect(effect, scratch, X, u, v, step, memory, force);
    off += memcmp(force, t.force, 3 * (size_t)is->node_count * sizeof *force) != 0;
    top = fmax(top, largest(t.force, 3 * is->node_count));
  }
  tap_ok(off == 0 && top > 0.0, "an obstacle has the bits of its effect");
  double omega2[2];
  const ct_view view = {.scratch = scratch};
  need(ct_interaction_bound(is, t.state, (ct_masses){&mass[BEFORE], is->nodes}, &omega2[0]), &e);
  must(effect->calls->bounds.omega2, effect, &view, &omega2[1]);
  tap_ok(omega2[0] == omega2[1] && omega2[0] > 0.0, "and its bound, in both numberings");
  effect->calls->free_scratch(scratch);
  ct_effect_free(effect);
  close_touch(&t);
}

int main(void)
{
  free_at_end();
  same_as_an_effect();
  return tap_done();
}
