/* Enforcements: one point compared with a bisection of its law, many points with a dense solution;
 * the energy that never grows, momentum, and bits. */
#include "../../libcontact/src/constraint/law.h"
#include "../../libcontact/src/step/constraints.h"
#include "bodies.h"

#include <string.h>

static const ct_material SOFT = {.young = 900.0, .poisson = 0.0, .density = 1.0},
                         STEEL = {.young = 2.1e5, .poisson = 0.3, .density = 7.8e-9};
static const ct_enforcement IMPLICIT[] = {CT_ENFORCE_ENERGY_CONTROLLED};
enum { IMPLICITS = sizeof IMPLICIT / sizeof IMPLICIT[0] };
typedef char every_implicit_law_is_tested[(int)IMPLICITS == CT_ENFORCE_COUNT - 1 ? 1 : -1];

/* Without a reserve, which test_impact.c tests. */
static double impact = 0.0; // restitution of the contacts below
static ct_contact_rule rule = CT_POINTS_GAUSS;

static ct_contact_options options_of(ct_enforcement enforcement)
{
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = enforcement, options.restitution = impact, options.points = rule;
  return options;
}

/* The laws as the book writes them (eq:energy-controlled). */
static double law_of(const ct_constraint *c, double after)
{
  double k = c->stiffness, a = c->dashpot;
  switch (c->enforcement) {
  case CT_ENFORCE_ENERGY_CONTROLLED:
    return k * fmax(-0.5 * ((1.0 + a) * after + (1.0 - a) * fmin(c->before, 0.0)), 0.0);
  case CT_ENFORCE_PENALTY:
  case CT_ENFORCE_COUNT:
    break;
  }
  return NAN;
}

/* λ with λ = φ(free + W λ), by halving an interval: φ falls, so the difference does. */
static double bisect(const ct_constraint *c, double free, double W)
{
  double low = 0.0, high = law_of(c, free) + 1e-300;
  for (int i = 0; i < 2000; i++) {
    double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    if (law_of(c, free + W * middle) > middle) low = middle;
    else high = middle;
  }
  return 0.5 * (low + high);
}

/* The force of a row that is alone. */
static double alone(const ct_constraint *c, double free, double W)
{
  ct_ramp ramp = ct_law_ramp(c);
  return fmax(-(free + ramp.b) / (ramp.C + W), 0.0);
}

/* eq:energy-controlled, eq:ramp. */
static void one_point(void)
{
  double off = 0.0;
  int pressed = 0;
  for (int i = 0; i < 20000; i++) {
    ct_constraint c = {.enforcement = IMPLICIT[i % IMPLICITS],
                       .stiffness = pow(10.0, uniform(4.0)),
                       .dashpot = i % 7 == 0 ? 0.0 : pow(10.0, uniform(2.0)),
                       .gap = uniform(1.0),
                       .before = uniform(1.0)};
    double free = uniform(1.0), W = pow(10.0, uniform(4.0)), want = bisect(&c, free, W),
           scale = c.stiffness * (1.0 + c.dashpot);
    off = worst(off, (alone(&c, free, W) - want) * (1.0 + scale * W) / scale);
    pressed += want > 0.0;
  }
  tap_ok(off < 1e-12 && pressed > 5000,
         "one point: the ramp is the root of the law, off by %.1e (bisection), %d of 20000 press",
         off, pressed);
}

/* A bar of hex8 that flies against a wall, on the Doyen data. */
typedef struct bar {
  ct_mesh *mesh;
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
  ct_stable_step stable;
  int64_t steps;
} bar;

static bar open_bar(ct_enforcement enforcement, double dissipation, double beta, double fraction,
                    double place)
{
  bar b = {.mesh = box_mesh(CT_HEX8, place, 0, 0, 10, 0.2, 0.2, 50, 1, 1), .scene = new_scene()};
  ct_effect *effect = NULL;
  const ct_problem *joined;
  int32_t *faces = integers(400);
  add_body(b.scene, "bar", b.mesh, &SOFT, CT_KERNEL_AUTO, -10, 0, 0);
  must(ct_scene_join, b.scene, &joined);
  ct_obstacle_def o = {COOKIE,
                       .shape = CT_OBSTACLE_PLANE,
                       .axis = {1, 0, 0},
                       .epsilon = beta * 900.0 / 0.2,
                       .enforcement = enforcement,
                       .dissipation = dissipation,
                       .kind = CT_Q4,
                       .face_count = ct_mesh_plane_faces(b.mesh, 0, place, faces, NULL),
                       .faces = faces};
  must(ct_obstacle_create_effect, &o, joined, &effect);
  must(ct_scene_add_effect, b.scene, effect);
  b.problem =
      build(b.scene, (ct_scene_time){.end = 0.9, .fraction = fraction}, &b.steps, &b.stable);
  b.state = new_state(b.problem);
  return b;
}

/* The total of the ledger at every step: largest step up over the start, and what is left at the
 * end. */
static double largest_rise(const ct_problem *problem, ct_state *state, int64_t steps, double *left)
{
  double start = energy_of(problem, state).total, before = start, rise = 0.0;
  for (int64_t i = 0; i < steps; i++) {
    advance(problem, state, 1);
    double now = energy_of(problem, state).total;
    rise = fmax(rise, (now - before) / start);
    before = now;
  }
  *left = before / start;
  return rise;
}

/* eq:controlled-energy, eq:controlled-loss. */
static void energy_never_grows(void)
{
  static const double SHARE[] = {0.0, 0.2, 1.0}, LEAST[] = {0.98, 0.94, 0.75},
                      FRACTION[] = {0.1, 0.5, 0.9, 0.999};
  for (int s = 0; s < 3; s++) {
    double rise = 0.0, least = 1.0, left;
    for (double beta = 1e-2; beta < 2e4; beta *= 10.0)
      for (int f = 0; f < 4; f++) {
        bar b = open_bar(CT_ENFORCE_ENERGY_CONTROLLED, SHARE[s], beta, FRACTION[f], 0.05);
        rise = fmax(rise, largest_rise(b.problem, b.state, b.steps, &left));
        least = fmin(least, left);
      }
    tap_ok(rise < 2e-14 && least > LEAST[s],
           "dissipation %g, beta 0.01 ... 1e4, 0.1 ... 0.999 of the limit: the largest increase of "
           "the "
           "total in a step is %.1e, at least %.3f remains",
           SHARE[s], rise, least);
  }
  double left;
  bar b = open_bar(CT_ENFORCE_ENERGY_CONTROLLED, 0.0, 100.0, 0.9, 0.05),
      p = open_bar(CT_ENFORCE_PENALTY, 0.0, 100.0, 0.9, 0.05);
  tap_ok(b.stable.dt == b.stable.dt_without_contact &&
             p.stable.dt < 0.2 * p.stable.dt_without_contact,
         "a stiff penalty leaves the stable step as it is, an explicit one shortens it");
  largest_rise(p.problem, p.state, p.steps, &left);
  tap_ok(left > 1.1,
         "and feeds energy into the bar within its own limit: %.2f times the initial energy", left);
}

/* A bar that touches the wall at the start, or penetrates it: the first force is computed twice,
 * with the same result. */
static void start_in_touch(void)
{
  for (int e = 0; e < IMPLICITS; e++)
    for (int k = 0; k < 2; k++) {
      bar b = open_bar(IMPLICIT[e], 0.1, 4.0, 0.9, k ? -0.01 : 0.0),
          c = open_bar(IMPLICIT[e], 0.1, 4.0, 0.9, k ? -0.01 : 0.0);
      double start = energy_of(b.problem, b.state).kinetic, balance = 0.0, left;
      must(ct_state_copy, b.problem, b.state, c.state);
      for (int i = 0; i < 20; i++) {
        advance(b.problem, b.state, 1);
        advance(c.problem, c.state, 1);
        balance = worst(balance, energy_of(b.problem, b.state).balance / start);
      }
      int same = memcmp(b.state->velocity, c.state->velocity,
                        3 * (size_t)b.problem->node_count * sizeof(double)) == 0;
      double rise = largest_rise(b.problem, b.state, 20, &left);
      tap_ok(balance < 1e-14 && same && rise < 1e-14,
             "%s, %s: work balance %.1e, a copy of the start goes on with the same bits",
             ENFORCEMENT[IMPLICIT[e]], k ? "overlap at the start" : "touch at the start", balance);
    }
}

/* Two blocks of unlike meshes that meet askew. */
typedef struct pair {
  ct_mesh *mesh[2];
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
} pair;

static pair open_pair(ct_enforcement enforcement, ct_brick_kind kind, int mirrored, int swapped,
                      int threads, double beta)
{
  pair p = {.scene = new_scene()};
  ct_stable_step stable;
  int64_t steps;
  // All nine points of a small face meet one large face, as long as they are inside its borders.
  const int cells[2] = {3, rule == CT_POINTS_LOBATTO ? 1 : 2};
  ct_mesh *flat[2] = {box_mesh(kind, -1, 0, 0, 1, 1, 1, 2, 3, 3),
                      box_mesh(kind, 1e-4, 0.2, 0.1, 1, 0.9, 1, 2, cells[1], cells[1])};
  unsigned long long seed = random_seed;
  for (int b = 0; b < 2; b++) {
    ct_mesh *m = box_mesh(kind, b ? 1e-4 : -1, b ? 0.2 : 0, b ? 0.1 : 0, 1, b ? 0.9 : 1, 1, 2,
                          cells[b], cells[b]);
    for (int n = 0; n < m->node_count; n++)
      m->nodes[3 * n] += 5e-3 * m->nodes[3 * n + 1] * m->nodes[3 * n + 2];
    distort_inside(m, 0.03);
    p.mesh[b] = m;
    ct_mesh **both[] = {&p.mesh[b], &flat[b]};
    for (int k = 0; mirrored && k < 2; k++) {
      ct_mesh *image = mirror_mesh(*both[k], 1);
      *both[k] = image;
    }
  }
  random_seed = seed;
  for (int b = 0; b < 2; b++)
    add_body(p.scene, b ? "b" : "a", p.mesh[b], &STEEL, CT_KERNEL_AUTO, b ? -2000 : 1000,
             mirrored ? -100 * b : 100 * b, 0);
  int32_t *faces[2] = {integers(400), integers(400)}, count[2];
  for (int b = 0; b < 2; b++)
    count[b] = ct_mesh_plane_faces(flat[b], 0, b ? 1e-4 : 0.0, faces[b], NULL);
  int one = swapped ? 1 : 0, two = 1 - one;
  ct_scene_contact contact =
      scene_contact(one, faces[one], count[one], two, faces[two], count[two]);
  contact.beta = beta, contact.options = options_of(enforcement);
  must(ct_scene_add_contact, p.scene, &contact);
  set_threads(p.scene, threads);
  p.problem = build(p.scene, (ct_scene_time){.end = 1.0, .dt = kind == CT_HEX20 ? 1e-8 : 2e-8},
                    &steps, &stable);
  p.state = new_state(p.problem);
  return p;
}

/* Largest of the sum of the contact's nodal forces and of their moments, over the largest force
 * (and moment). */
static double imbalance(const pair *p)
{
  double *f = numbers(3 * (int64_t)p->problem->node_count), sum[3] = {0}, moment[3] = {0},
         top = 1e-300;
  must(ct_state_force, p->problem, p->state, 1, f);
  for (int64_t n = 0; n < p->problem->node_count; n++)
    for (int c = 0; c < 3; c++) {
      int a = (c + 1) % 3, b = (c + 2) % 3;
      const double *X = &p->problem->reference[3 * n], *u = &p->state->displacement[3 * n];
      sum[c] += f[3 * n + c];
      moment[c] += (X[a] + u[a]) * f[3 * n + b] - (X[b] + u[b]) * f[3 * n + a];
      top = fmax(top, fabs(f[3 * n + c]));
    }
  return fmax(largest(sum, 3), largest(moment, 3)) / top;
}

/* eq:constraint-force, eq:near-constraints. */
static void conservation(void)
{
  for (int e = 0; e < IMPLICITS; e++)
    for (int kind = 0; kind < 2; kind++) {
      pair p = open_pair(IMPLICIT[e], kind ? CT_HEX20 : CT_HEX8, 0, 0, 1, 4.0);
      double off = 0.0, balance = 0.0, top = energy_of(p.problem, p.state).kinetic;
      int64_t converged = 0, pressed = 0;
      for (int i = 0; i < 60; i++) {
        advance(p.problem, p.state, 1);
        ct_energy energy = energy_of(p.problem, p.state);
        balance = worst(balance, energy.balance);
        off = worst(off, imbalance(&p));
        converged += p.state->workspace->constraints->solver->converged;
        pressed += p.state->workspace->constraints->solver->count > 0;
      }
      balance /= top;
      tap_ok(off < 1e-12 && balance < 1e-12 && converged == 60 && p.state->unconverged == 0 &&
                 pressed > 10,
             "%s, %s: forces and moments sum to %.1e, work balance %.1e, %d of 60 steps converged, "
             "%d pressed",
             ENFORCEMENT[IMPLICIT[e]], kind ? "hex20" : "hex8", off, balance, (int)converged,
             (int)pressed);
    }
}

/* The set that row `c` is of. */
static int32_t set_of(const ct_solver *s, const ct_constraint *c)
{
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t j = s->first[k]; j < s->first[k + 1]; j++)
      if (s->rows[j] == c) return k;
  return -1;
}

/* A row of G over the degrees of freedom of the problem. */
static void fill_row(const ct_solver *s, int64_t r, double *row)
{
  const ct_constraint *c = s->active[r];
  const int32_t *place = &s->place[s->first_node[set_of(s, c)]];
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < c->own_count; a++)
      row[3 * s->nodes[place[c->own[a]]] + i] += c->own_shape[a] * c->normal[i];
    for (int a = 0; a < c->other_count; a++)
      row[3 * s->nodes[place[c->other[a]]] + i] -= c->other_shape[a] * c->normal[i];
  }
}

/* Difference of the solver's nodal forces from those of Gauss-Seidel with a dense matrix, iterated
 * from zero to the last digit; over the largest of them. */
static double off_dense(const ct_solver *s, int32_t nodes)
{
  int64_t n = s->count, dofs = 3 * (int64_t)nodes;
  double *G = numbers(n * dofs), *W = numbers(n * n), *force = numbers(n), *A = numbers(dofs),
         top = 0.0, off = 0.0;
  for (int64_t r = 0; r < n; r++) fill_row(s, r, &G[r * dofs]);
  for (int32_t i = 0; i < s->node_count; i++)
    for (int c = 0; c < 3; c++) A[3 * s->nodes[i] + c] = s->mobility[4 * i + c];
  for (int64_t r = 0; r < n; r++)
    for (int64_t k = 0; k < n; k++)
      for (int64_t d = 0; d < dofs; d++) W[r * n + k] += G[r * dofs + d] * A[d] * G[k * dofs + d];
  for (int sweep = 0; sweep < 20000; sweep++)
    for (int64_t r = 0; r < n; r++) {
      double gap = s->free[r];
      for (int64_t k = 0; k < n; k++) gap += k == r ? 0.0 : W[r * n + k] * force[k];
      force[r] = alone(s->active[r], gap, W[r * n + r]);
    }
  for (int64_t d = 0; d < dofs; d++) {
    double want = 0.0, got = 0.0;
    for (int64_t r = 0; r < n; r++)
      want += G[r * dofs + d] * force[r], got += G[r * dofs + d] * s->active[r]->force;
    top = fmax(top, fabs(want));
    off = worst(off, got - want);
  }
  return top > 0.0 ? off / top : 1.0;
}

/* How many active rows have a force. */
static int64_t with_force(const ct_solver *s)
{
  int64_t count = 0;
  for (int64_t r = 0; r < s->count; r++) count += s->active[r]->force > 0.0;
  return count;
}

/* Forces to a tolerance (eq:energy-stop). */
static void loosen(const pair *p, double tolerance)
{
  ((ct_problem *)p->problem)->force_tolerance = tolerance;
}

/* The forces of many points against a dense solution. (eq:constraint-problem, eq:constraint-force)
 */
static void many_points(void)
{
  for (int e = 0; e < IMPLICITS; e++) {
    pair p = open_pair(IMPLICIT[e], CT_HEX8, 0, 0, 1, 4.0);
    const ct_solver *s = p.state->workspace->constraints->solver;
    loosen(&p, 1e-10);
    for (int i = 0, found = 0; i < 40 && !found; i++) {
      advance(p.problem, p.state, 1);
      (void)energy_of(p.problem, p.state);
      found = with_force(s) >= 4;
    }
    double off = off_dense(s, p.problem->node_count);
    tap_ok(s->count >= 4 && off < 1e-8,
           "%s: forces at the nodes of %d points are those of a dense solution, off by %.1e",
           ENFORCEMENT[IMPLICIT[e]], (int)s->count, off);
  }
}

/* A block in a corner of three oblique walls, each an effect of its own: the nodes on its edges are
 * in the lists of two of them, that in the corner in all three. */
static void shared_nodes(void)
{
  for (int e = 0; e < IMPLICITS; e++) {
    ct_scene *scene = new_scene();
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 2, 3);
    int64_t steps;
    ct_stable_step stable;
    int32_t *faces = integers(100);
    add_body(scene, "block", m, &SOFT, CT_KERNEL_AUTO, -3, -4, -5);
    for (int wall = 0; wall < 3; wall++) {
      ct_obstacle_def o = ct_obstacle_def_default();
      for (int c = 0; c < 3; c++) o.axis[c] = c == wall ? 1.0 : 0.4, o.point[c] = 0.2;
      o.epsilon = 4000.0 + 1000.0 * wall, o.travel_time = 0.01;
      o.enforcement = IMPLICIT[e];
      o.kind = CT_Q4;
      o.face_count = ct_mesh_plane_faces(m, wall, 0.0, faces, NULL);
      o.faces = faces;
      add_made(scene, ct_obstacle_create_effect, &o);
    }
    const ct_problem *problem =
        build(scene, (ct_scene_time){.end = 0.1, .fraction = 0.5, .force_tolerance = 1e-10}, &steps,
              &stable);
    ct_state *state = new_state(problem);
    const ct_solver *s = state->workspace->constraints->solver;
    advance(problem, state, 1);
    (void)energy_of(problem, state);
    double off = off_dense(s, problem->node_count);
    int shared = s->first_node[3] - s->node_count;
    tap_ok(s->set_count == 3 && shared == 10 && with_force(s) > 2 && off < 1e-8,
           "%s: three walls share %d nodes; forces at the nodes of %d points are those of a dense "
           "solution, off by %.1e",
           ENFORCEMENT[IMPLICIT[e]], shared, (int)s->count, off);
  }
}

static int same(const pair *a, const pair *b)
{
  size_t size = 3 * (size_t)a->problem->node_count * sizeof(double);
  return memcmp(a->state->velocity, b->state->velocity, size) == 0 &&
         memcmp(a->state->displacement, b->state->displacement, size) == 0;
}

/* With a loose tolerance the energy rises no more than with the tight one, and both results agree
 * (eq:energy-stop). */
static void loose(void)
{
  ct_error error;
  ct_state *none = NULL;
  pair refused = open_pair(CT_ENFORCE_ENERGY_CONTROLLED, CT_HEX8, 0, 0, 1, 40.0);
  loosen(&refused, 0.2);
  tap_ok(ct_state_create(refused.problem, &none, &error) == CT_ERROR_ARGUMENT && none == NULL &&
             strstr(error.text, "force_tolerance") != NULL,
         "refused: %s", error.text);
  for (int kind = 0; kind < 2; kind++) {
    ct_brick_kind brick = kind ? CT_HEX20 : CT_HEX8;
    pair p[2];
    double rise[2] = {0.0, 0.0}, last[2], start = 0.0;
    for (int k = 0; k < 2; k++) {
      p[k] = open_pair(CT_ENFORCE_ENERGY_CONTROLLED, brick, 0, 0, 1, 40.0);
      loosen(&p[k], k == 1 ? 1e-3 : 1e-10);
      last[k] = start = energy_of(p[k].problem, p[k].state).total;
      for (int step = 0; step < 150; step++) {
        advance(p[k].problem, p[k].state, 1);
        double now = energy_of(p[k].problem, p[k].state).total;
        rise[k] = fmax(rise[k], (now - last[k]) / start);
        last[k] = now;
      }
    }
    double off = largest_difference(p[0].state->displacement, p[1].state->displacement,
                                    3 * p[0].problem->node_count) /
                 largest(p[0].state->displacement, 3 * p[0].problem->node_count);
    tap_ok(rise[1] <= rise[0] + 1e-7 && off < 1e-3 && off > 0.0,
           "%s, tolerance 0.001: energy rises by %.1e in a step (%.1e with the tight one), energy "
           "off by %.1e, displacements by %.1e",
           kind ? "hex20" : "hex8", rise[1], rise[0], last[1] / last[0] - 1.0, off);
  }
}

/* The bits with a restitution, a tolerance of the forces, and a rule of points. */
static void bits(double restitution, double tolerance, ct_contact_rule points)
{
  impact = restitution, rule = points;
  for (int e = 0; e < IMPLICITS; e++)
    for (int kind = 0; kind < 2; kind++) {
      ct_brick_kind brick = kind ? CT_HEX20 : CT_HEX8;
      pair p = open_pair(IMPLICIT[e], brick, 0, 0, 1, 4.0),
           threads = open_pair(IMPLICIT[e], brick, 0, 0, 3, 4.0),
           swapped = open_pair(IMPLICIT[e], brick, 0, 1, 1, 4.0),
           again = open_pair(IMPLICIT[e], brick, 0, 0, 1, 4.0),
           mirror = open_pair(IMPLICIT[e], brick, 1, 0, 1, 4.0),
           *all[] = {&p, &threads, &swapped, &again, &mirror};
      for (int i = 0; i < 5; i++) loosen(all[i], tolerance);
      advance(p.problem, p.state, 15);
      must(ct_state_copy, p.problem, p.state, again.state);
      advance(p.problem, p.state, 15);
      advance(again.problem, again.state, 15);
      advance(threads.problem, threads.state, 30);
      advance(swapped.problem, swapped.state, 30);
      advance(mirror.problem, mirror.state, 30);
      int64_t faults =
          mirror_faults(p.state->velocity, mirror.state->velocity, p.problem->node_count, 1);
      tap_ok(
          same(&p, &threads) && same(&p, &again) && same(&p, &swapped) && faults == 0,
          "%s, %s, restitution %g, tolerance %g, rule %d: the same bits with three threads (%d), "
          "after a restart (%d), with the names swapped (%d), mirrored (%d faults)",
          ENFORCEMENT[IMPLICIT[e]], kind ? "hex20" : "hex8", restitution, tolerance, (int)points,
          same(&p, &threads), same(&p, &again), same(&p, &swapped), (int)faults);
    }
  impact = 0.0, rule = CT_POINTS_GAUSS;
}

/* Energy that the points of a state store at the middle of the next step, by the law as in the
 * book. */
static double stored_between_steps(const ct_solver *s)
{
  double sum = 0.0;
  for (int64_t j = 0; j < s->first[s->set_count]; j++) {
    const ct_constraint *c = s->rows[j];
    double here = fmin(c->gap, 0.0), next = fmin(c->after, 0.0);
    sum += 0.25 * c->stiffness * (here * here + next * next);
  }
  return sum;
}

/* The row of a point, which stays where it is, and a number of the face that it pressed on last. */
typedef struct met {
  const ct_constraint *row;
  int32_t face;
} met;

/* How many points meet another face than in the step before. */
static int changed_partners(const ct_solver *s, met *partner)
{
  int changed = 0;
  for (int64_t j = 0; j < s->first[s->set_count]; j++) {
    const ct_constraint *c = s->rows[j];
    int32_t now = c->force > 0.0 && c->other_count > 0 ? c->other[0] + c->other[2] + 1 : 0, k = 0;
    while (partner[k].row != NULL && partner[k].row != c) k++;
    changed += now > 0 && partner[k].face > 0 && now != partner[k].face;
    partner[k] = (met){c, now};
  }
  return changed;
}

/* Where a block slides: on a plane, on waves, on a rigid ball, off an edge. Or the legs of a strip
 * that is folded once meet. */
enum { PLANE, WAVES, BALL, EDGE, FOLD };

/* Two legs of the length 1, one above the other, joined by half a ring; the upper one flies at the
 * lower one, along it. */
static ct_scene *folded_scene(ct_brick_kind kind, ct_contact_options options)
{
  ct_scene *scene = new_scene();
  ct_mesh *m = box_mesh(kind, 0, 0, 0, 1, 0.4, 1, 12, 1, 1);
  int32_t *faces = integers(4000);
  options.depth = 0.05;
  double *v = numbers(3 * (int64_t)m->node_count);
  bend_to_hairpin(m, 0.11, v);
  add_moving_body(scene, "strip", m, &SOFT, CT_KERNEL_AUTO, v);
  int32_t count = ct_mesh_outer_faces(m, faces, NULL);
  ct_scene_contact contact = scene_contact(0, faces, count, 0, faces, count);
  contact.beta = 4.0, contact.options = options;
  must(ct_scene_add_contact, scene, &contact);
  return scene;
}

/* A block that is thrown onto a longer one and slides along it, plane or wavy, off its edge, or
 * over a rigid ball. */
static ct_scene *sliding_scene(const ct_brick_kind kind[2], int ground, double dissipation)
{
  ct_scene *scene = new_scene();
  double length = ground == EDGE ? 1.2 : 3.0;
  int cells = ground == EDGE ? 3 : 7;
  ct_mesh *flat = box_mesh(kind[0], 0, 0, -1, length, 1, 1, cells, 3, 3),
          *low = box_mesh(kind[0], 0, 0, -1, length, 1, 1, cells, 3, 3),
          *up = box_mesh(kind[1], 0.1, 0.05, 0, 1, 0.9, 1, 3, 2, 3);
  int32_t *below = integers(4000), *above = integers(4000),
          count[2] = {ct_mesh_plane_faces(flat, 2, 0.0, below, NULL),
                      ct_mesh_plane_faces(up, 2, 0.0, above, NULL)};
  if (ground == EDGE)
    count[0] = ct_mesh_outer_faces(low, below, NULL),
    count[1] = ct_mesh_outer_faces(up, above, NULL);
  for (int n = 0; ground == WAVES && n < low->node_count; n++)
    low->nodes[3 * n + 2] +=
        0.03 * (1.0 + low->nodes[3 * n + 2]) * (cos(5.0 * low->nodes[3 * n]) - 1.0);
  ct_contact_options options = options_of(CT_ENFORCE_ENERGY_CONTROLLED);
  options.dissipation = dissipation;
  add_body(scene, "up", up, &SOFT, CT_KERNEL_AUTO, 9.0, 0, -1.5);
  if (ground != BALL) {
    add_body(scene, "low", low, &SOFT, CT_KERNEL_AUTO, 0, 0, 0);
    ct_scene_contact contact = scene_contact(0, above, count[1], 1, below, count[0]);
    contact.beta = 4.0, contact.options = options;
    must(ct_scene_add_contact, scene, &contact);
  } else {
    ct_obstacle_def o = {COOKIE,
                         .shape = CT_OBSTACLE_SPHERE,
                         .point = {0.9, 0.5, -2.0},
                         .radius = 2.0,
                         .epsilon = 4.0 * SOFT.young * 3.0,
                         .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                         .dissipation = dissipation,
                         .kind = kind[1] == CT_HEX20 ? CT_Q8 : CT_Q4,
                         .face_count = count[1],
                         .faces = above};
    add_made(scene, ct_obstacle_create_effect, &o);
  }
  return scene;
}

/* The total of the energy balance is the mean of the energies of bodies and points half a step
 * before and after; each of them is computed here, from displacements, velocities, forces of the
 * solid and gaps. So the stored energy of a point is counted once and is the same for both steps
 * that it belongs to, whatever the point meets. (eq:controlled-store, eq:controlled-energy) */
static void mean_of_half_steps(const char *name, const ct_brick_kind kind[2], int ground,
                               double dissipation)
{
  ct_contact_options options = options_of(CT_ENFORCE_ENERGY_CONTROLLED);
  options.dissipation = dissipation;
  ct_scene *scene =
      ground == FOLD ? folded_scene(kind[0], options) : sliding_scene(kind, ground, dissipation);
  int64_t steps;
  ct_stable_step stable;
  const ct_problem *p = build(scene, (ct_scene_time){.end = 0.1, .fraction = 0.5}, &steps, &stable);
  ct_state *state = new_state(p), *copy = new_state(p);
  const ct_solver *s = state->workspace->constraints->solver;
  int64_t n = 3 * (int64_t)p->node_count;
  met *partner = room(s->most + 1, sizeof *partner);
  double *u = numbers(n), *f = numbers(n), before = energy_of(p, state).total, scale = before,
         last = before, off = 0.0, most = 0.0;
  double stored = stored_between_steps(s), half = before;
  int changed = changed_partners(s, partner), same_bits = 1;
  for (int64_t i = 1; i <= steps; i++) {
    advance(p, state, 1);
    must(ct_state_copy, p, state, copy);
    double total = energy_of(p, state).total, bodies = 0.0;
    same_bits &= energy_of(p, copy).total == total;
    must(ct_state_force, p, state, 0, f);
    // ½ v·Mv + ½ u_{n-1}·K u_n, with K u_n = -f_n
    for (int64_t d = 0; d < n; d++)
      bodies += 0.5 * p->mass[d / 3] * state->velocity[d] * state->velocity[d] - 0.5 * u[d] * f[d];
    half = bodies + stored;
    if (i > 1) off = worst(off, (last - 0.5 * (before + half)) / scale);
    before = half;
    last = total;
    stored = stored_between_steps(s);
    most = fmax(most, stored / scale);
    changed += changed_partners(s, partner);
    memcpy(u, state->displacement, (size_t)n * sizeof *u);
  }
  tap_ok(off < 1e-13 && same_bits && most > 1e-4 && (ground == BALL || changed > 3),
         "%s, dissipation %g, %d steps, %d points on another face, up to %.1e stored: the total is "
         "the mean of two half steps, "
         "off by %.1e",
         name, dissipation, (int)steps, changed, most, off);
}

static void partners_change(void)
{
  static const ct_brick_kind linear[2] = {CT_HEX8, CT_HEX8}, quadratic[2] = {CT_HEX20, CT_HEX20},
                             mixed[2] = {CT_HEX8, CT_HEX20};
  static const double SHARE[] = {0.0, 0.1, 1.0};
  for (int i = 0; i < 3; i++) {
    mean_of_half_steps("hex8 that slides on hex8", linear, PLANE, SHARE[i]);
    mean_of_half_steps("hex8 on waves of hex8", linear, WAVES, SHARE[i]);
    mean_of_half_steps("hex20 on waves of hex20", quadratic, WAVES, SHARE[i]);
    mean_of_half_steps("hex20 that slides on hex8", mixed, PLANE, SHARE[i]);
    mean_of_half_steps("hex20 that slides off the edge of hex8", mixed, EDGE, SHARE[i]);
    mean_of_half_steps("hex20 on a rigid ball", quadratic, BALL, SHARE[i]);
    mean_of_half_steps("a fold", i == 1 ? quadratic : linear, FOLD, SHARE[i]);
  }
}

/* Two equal bars that meet are one bar at a wall, from the first step on. */
static void a_twin_is_a_wall(void)
{
  ct_mesh *left = box_mesh(CT_HEX8, -2, 0, 0, 2, 0.4, 0.4, 10, 2, 2),
          *right = box_mesh(CT_HEX8, 0, 0, 0, 2, 0.4, 0.4, 10, 2, 2);
  double off[2];
  for (int k = 0; k < 2; k++) {
    ct_scene *two = new_scene(), *one = new_scene();
    ct_stable_step stable;
    int64_t steps;
    add_body(two, "left", left, &SOFT, CT_KERNEL_AUTO, 1, 0, 0);
    add_body(two, "right", right, &SOFT, CT_KERNEL_AUTO, -1, 0, 0);
    add_contact_with(two, 0, left, 0.0, 1, right, 0.0, 0, k ? 4.0 : 1e12,
                     options_of(k ? CT_ENFORCE_PENALTY : CT_ENFORCE_ENERGY_CONTROLLED), 0.0, 0.0);
    add_body(one, "right", right, &SOFT, CT_KERNEL_AUTO, -1, 0, 0);
    add_support(one, 0, right, 0, 0.0, "x", 0.0);
    ct_scene_time time = {.end = 0.1, .dt = 0.9 * 0.2 / 30.0 * (k ? 0.4 : 1.0)};
    const ct_problem *p = build(two, time, &steps, &stable), *q = build(one, time, &steps, &stable);
    ct_state *s = new_state(p), *t = new_state(q);
    advance(p, s, steps);
    advance(q, t, steps);
    off[k] = largest_difference(s->velocity + 3 * left->node_count, t->velocity,
                                3 * (int64_t)right->node_count);
  }
  tap_ok(
      off[0] < 1e-11 && off[1] > 1e-2,
      "two equal bars with a very stiff penalty are a bar at a wall: velocities off by %.1e of 1 "
      "(explicit penalty %.2f)",
      off[0], off[1]);
}

static void refused(void)
{
  ct_contact_options options = ct_contact_options_default();
  ct_error error = {0};
  double x[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  int32_t face[4] = {0, 1, 2, 3};
  ct_surface surface = {CT_Q4, 4, 1, face, x};
  ct_contact *contact = NULL;
  options.epsilon = 1.0;
  options.dissipation = 1.5;
  tap_ok(ct_contact_create(&surface, &surface, &options, &contact, &error) == CT_ERROR_ARGUMENT &&
             strstr(error.text, "dissipation must be 0 to 1, not 1.5") != NULL,
         "refused: %s", error.text);
  options.dissipation = NAN;
  tap_ok(ct_contact_create(&surface, &surface, &options, &contact, &error) == CT_ERROR_ARGUMENT,
         "refused: %s", error.text);
  options = ct_contact_options_default(), options.epsilon = 1.0,
  options.enforcement = (ct_enforcement)9;
  tap_ok(ct_contact_create(&surface, &surface, &options, &contact, &error) == CT_ERROR_ARGUMENT &&
             strstr(error.text, "enforcement 9") != NULL,
         "refused: %s", error.text);
}

int main(void)
{
  free_at_end();
  one_point();
  for (int law = 0; law < CT_ENFORCE_COUNT; law++)
    tap_ok(ct_contact_penalty_default((ct_enforcement)law, 3.0, 2.0) > 0.0,
           "%s: it has a default penalty", ENFORCEMENT[law]);
  energy_never_grows();
  start_in_touch();
  conservation();
  many_points();
  shared_nodes();
  bits(0.0, 1e-10, CT_POINTS_GAUSS);
  bits(1.0, 1e-10, CT_POINTS_GAUSS);
  bits(1.0, 1e-10, CT_POINTS_LOBATTO);
  bits(1.0, 0.0, CT_POINTS_GAUSS);
  bits(0.5, 1e-2, CT_POINTS_GAUSS);
  loose();
  a_twin_is_a_wall();
  partners_change();
  refused();
  return tap_done();
}
