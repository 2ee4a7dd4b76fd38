/* The parts of the constraint solver, on random rows, compared with matrices that this file
 * computes itself. The source is included, so that each part can be called alone. */
#include "../../libcontact/src/constraint/solve.c"
#include "../../libcontact/src/base/vector.h"
#include "../../libcontact/src/constraint/active.h"
#include "../../libcontact/src/constraint/matrix.h"
#include "../../libcontact/src/constraint/products.h"
#include "bodies.h"
#include "meeting.h"

enum { NODES = 9, ROWS = 16, PER = 8, DOFS = 3 * NODES };

/* Random rows on few nodes, with the matrices of the book. */
typedef struct rows {
  ct_solver *s;
  ct_constraint row[ROWS];
  int32_t own[ROWS][PER], other[ROWS][PER];
  double own_shape[ROWS][PER], other_shape[ROWS][PER];
  double G[ROWS][DOFS], A[DOFS], W[ROWS][ROWS];
} rows;

/* Some different nodes, ascending from a random one. */
static void take_nodes(int32_t count, int32_t *nodes, double *shape)
{
  int32_t first = pick(NODES);
  for (int32_t a = 0; a < count; a++) nodes[a] = (first + 2 * a) % NODES, shape[a] = uniform(1.0);
}

/* The nodes of a row: faces of three, four and eight nodes, or those of the row before. */
static void choose_nodes(rows *r, int j)
{
  static const int32_t own[] = {4, 4, 3, 8}, other[] = {4, 0, 3, 8};
  ct_constraint *c = &r->row[j];
  const int kind = pick(8) ? pick(2) : pick(4);
  c->own_count = own[kind], c->other_count = other[kind];
  take_nodes(c->own_count, r->own[j], r->own_shape[j]);
  take_nodes(c->other_count, r->other[j], r->other_shape[j]);
  c->own = r->own[j], c->other = r->other[j];
  c->own_shape = r->own_shape[j], c->other_shape = r->other_shape[j];
  if (j == 0 || pick(3) == 0 || c->own_count != c[-1].own_count ||
      c->other_count != c[-1].other_count)
    return;
  c->own = c[-1].own, c->other = c[-1].other;
}

/* Let four rows be the points of a 2 x 2 rule on a face, whose weights follow on each other. */
static void make_face(rows *r, int first, int32_t other)
{
  for (int j = first; j < first + 4; j++) {
    ct_constraint *c = &r->row[j];
    c->own_count = 4, c->other_count = other;
    take_nodes(4, r->own[j], r->own_shape[j]);
    take_nodes(other, r->other[j], r->other_shape[j]);
    c->own = r->own[first], c->other = r->other[first];
    c->own_shape = r->own_shape[j], c->other_shape = r->other_shape[j];
  }
  memcpy(&r->own_shape[first + 3][2], r->own_shape[first], 2 * sizeof(double));
}

/* The nodes of four points of a face at an obstacle; all faces have the weights of one rule, and
 * many a one the normals of the face before. */
static void choose_face(rows *r, int j)
{
  ct_constraint *c = &r->row[j];
  c->own_count = 4;
  take_nodes(4, r->own[j], r->own_shape[j]);
  for (int a = 0; j == 3 && a < 4; a++) r->own_shape[3][a] = r->own_shape[0][a ^ 2];
  c->own = r->own[j - j % 4], c->own_shape = r->own_shape[j % 4];
  if (j >= 4 && j / 4 % 2) memcpy(c->normal, c[-4].normal, sizeof c->normal);
}

static void fill(rows *r)
{
  const ct_row_set half = {ROWS / 2, NODES, NULL, 2 * PER, 0, 0}, set[2] = {half, half};
  const int alike = pick(3) == 0, faces = pick(3) == 0; // as at a plane, at an obstacle
  int32_t place[NODES];
  ct_error e;
  need(ct_solver_create(set, 2, NODES, place, &r->s), &e);
  r->s->fraction = 1.0, r->s->tolerance = 1e-10;
  for (int i = 0; i < NODES; i++)
    for (int c = 0; c < 3; c++) {
      r->A[3 * i + c] = 1.0 + 0.5 * uniform(1.0);
      r->s->mobility[CT_SOLVER_WIDE * i + c] = r->A[3 * i + c];
      r->s->increment[CT_SOLVER_WIDE * i + c] = 0.2 * uniform(1.0);
      r->s->last_increment[CT_SOLVER_WIDE * i + c] = 0.2 * uniform(1.0);
    }
  for (int j = 0; j < ROWS; j++) {
    ct_constraint *c = &r->row[j];
    *c = (ct_constraint){.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                         .stiffness = pow(10.0, uniform(1.0)),
                         .dissipation = 0.15,
                         .gap = uniform(0.5),
                         .force = fmax(0.0, uniform(1.0))};
    if (!faces) choose_nodes(r, j);
    double length = 0.0;
    for (int k = 0; k < 3; k++) c->normal[k] = uniform(1.0), length += c->normal[k] * c->normal[k];
    for (int k = 0; k < 3; k++) c->normal[k] /= sqrt(length);
    if (j > 0 && alike) memcpy(c->normal, r->row[0].normal, sizeof c->normal);
    if (faces) choose_face(r, j);
    r->s->rows[j] = c;
  }
  for (int first = 0; first < ROWS; first += ROWS / 2)
    if (!faces && pick(2)) make_face(r, first, 4 * pick(2));
  r->s->first[1] = ROWS / 2, r->s->first[2] = ROWS;
}

/* G and W = G A Gᵀ of the active rows, from nodes, shape functions and normals. */
static void fill_dense(rows *r)
{
  memset(r->G, 0, sizeof r->G);
  for (int64_t j = 0; j < r->s->count; j++) {
    const ct_constraint *c = r->s->active[j];
    for (int k = 0; k < 3; k++) {
      for (int a = 0; a < c->own_count; a++)
        r->G[j][3 * c->own[a] + k] += c->own_shape[a] * c->normal[k];
      for (int a = 0; a < c->other_count; a++)
        r->G[j][3 * c->other[a] + k] -= c->other_shape[a] * c->normal[k];
    }
  }
  for (int64_t i = 0; i < r->s->count; i++)
    for (int64_t j = 0; j < r->s->count; j++) {
      r->W[i][j] = 0.0;
      for (int d = 0; d < DOFS; d++) r->W[i][j] += r->G[i][d] * r->A[d] * r->G[j][d];
    }
}

static void prepare(rows *r)
{
  fill(r);
  (void)ct_active_set_up(r->s, 0);
  fill_dense(r);
}

static void release(rows *r) { ct_pool_free(r->s); }

/* F of the forces (eq:constraint-function). */
static double function_of(const rows *r, const double *force)
{
  double F = 0.0;
  for (int64_t i = 0; i < r->s->count; i++) {
    F += force[i] * (0.5 * r->s->C[i] * force[i] + r->s->free[i] + r->s->b[i]);
    for (int64_t j = 0; j < r->s->count; j++) F += 0.5 * force[i] * r->W[i][j] * force[j];
  }
  return F;
}

/* The forces of a row on its nodes (eq:constraint-force), and the gaps that forces open
 * (eq:constraint-problem) with the gradient of F, here a difference of F itself
 * (eq:constraint-function). */
static void slopes(void)
{
  double off_force = 0.0, off_gap = 0.0, off_slope = 0.0;
  for (int trial = 0; trial < 50; trial++) {
    rows r;
    prepare(&r);
    const ct_solver *s = r.s;
    for (int d = 0; d < DOFS; d++) {
      double unit[CT_SOLVER_WIDE * NODES] = {0.0}, column[ROWS];
      unit[CT_SOLVER_WIDE * (d / 3) + d % 3] = 1.0;
      ct_matrix_times(s, s->count, unit, column);
      for (int64_t j = 0; j < s->count; j++) off_force = worst(off_force, column[j] - r.G[j][d]);
    }
    (void)find_gradient(r.s);
    for (int64_t j = 0; j < s->count; j++) {
      double gap = s->free[j], force[ROWS];
      for (int64_t k = 0; k < s->count; k++) gap += r.W[j][k] * s->force[k];
      off_gap = worst(off_gap, s->gradient[j] - s->b[j] - s->C[j] * s->force[j] - gap);
      memcpy(force, s->force, sizeof force);
      force[j] += 1e-3;
      double up = function_of(&r, force);
      force[j] -= 2e-3;
      off_slope = worst(off_slope, (up - function_of(&r, force)) / 2e-3 - s->gradient[j]);
    }
    release(&r);
  }
  tap_ok(off_force < 1e-14, "a row acts on its nodes with b_a n, off by %.1e", off_force);
  tap_ok(off_gap < 1e-12, "gaps are free + G A G^T lambda, off by %.1e", off_gap);
  tap_ok(off_slope < 1e-10, "the gradient is that of F, off by %.1e", off_slope);
}

/* D_j - C_j = Σ |b_ja| A_a Σ_k |b_ka|, worked out row by row with the largest A of a node
 * (eq:constraint-bound); a step takes min(r / D, λ) of each force and F does not rise
 * (eq:constraint-iteration). */
static void step(void)
{
  double off_bound = 0.0, off_step = 0.0, rise = -1.0;
  for (int trial = 0; trial < 50; trial++) {
    rows r;
    prepare(&r);
    ct_solver *s = r.s;
    double crowd[NODES] = {0.0}, before[ROWS];
    for (int64_t k = 0; k < s->count; k++) {
      const ct_constraint *c = s->active[k];
      for (int a = 0; a < c->own_count; a++) crowd[c->own[a]] += fabs(c->own_shape[a]);
      for (int a = 0; a < c->other_count; a++) crowd[c->other[a]] += fabs(c->other_shape[a]);
    }
    for (int64_t j = 0; j < s->count; j++) {
      const ct_constraint *c = s->active[j];
      double D = s->C[j];
      for (int a = 0; a < c->own_count; a++)
        D += fabs(c->own_shape[a]) * largest(&r.A[3 * c->own[a]], 3) * crowd[c->own[a]];
      for (int a = 0; a < c->other_count; a++)
        D += fabs(c->other_shape[a]) * largest(&r.A[3 * c->other[a]], 3) * crowd[c->other[a]];
      off_bound = worst(off_bound, s->scale[j] * D - 1.0);
    }
    (void)find_gradient(s);
    memcpy(before, s->force, sizeof before);
    double start = function_of(&r, before), taken[ROWS];
    for (int64_t j = 0; j < s->count; j++) taken[j] = fmin(s->gradient[j] * s->scale[j], before[j]);
    (void)step_down(s, 0.0);
    for (int64_t j = 0; j < s->count; j++)
      off_step = worst(off_step, before[j] - taken[j] - s->force[j]);
    rise = fmax(rise, function_of(&r, s->force) - start);
    release(&r);
  }
  tap_ok(off_bound < 1e-13, "D is the bound of the rows of W + C, off by %.1e", off_bound);
  tap_ok(off_step < 1e-14 && rise < 1e-14,
         "a step takes min(r / D, lambda) (off by %.1e), and F does not rise (%.1e)", off_step,
         rise);
}

/* Rows without a force are added if they promise a larger decrease than those with one
 * (eq:proportioning). */
static void release_of_rows(void)
{
  int wrong = 0, taken = 0, trials = 400;
  for (int trial = 0; trial < trials; trial++) {
    rows r;
    prepare(&r);
    ct_solver *s = r.s;
    double gain[2] = {0.0, 0.0}, small = pow(10.0, uniform(2.0) - 2.0);
    for (int64_t j = 0; j < s->count; j++) s->force[j] *= small;
    s->applied = 0;
    (void)find_gradient(s);
    for (int64_t j = 0; j < s->count; j++)
      gain[s->force[j] > 0.0] += s->gradient[j] * fmin(s->gradient[j] * s->scale[j], s->force[j]);
    double measures[MEASURES];
    descend_along(s, 0.0, measures);
    wrong += releases(s) != (gain[0] > gain[1]);
    taken += gain[0] > gain[1];
    release(&r);
  }
  tap_ok(wrong == 0 && taken > 40 && taken < trials - 40,
         "rows are added if they promise a larger decrease: %d of %d times, %d wrong", taken,
         trials, wrong);
}

/* The gap of a row one step ago. */
static double before_by_hand(const rows *r, int j)
{
  const ct_constraint *c = &r->row[j];
  double gap = c->gap - c->came;
  for (int k = 0; k < 3; k++) {
    for (int a = 0; a < c->own_count; a++)
      gap -= c->own_shape[a] * c->normal[k] * r->s->last_increment[CT_SOLVER_WIDE * c->own[a] + k];
    for (int a = 0; a < c->other_count; a++)
      gap +=
          c->other_shape[a] * c->normal[k] * r->s->last_increment[CT_SOLVER_WIDE * c->other[a] + k];
  }
  return gap;
}

/* The rows that a step can close or that were inside before, and no others (eq:near-constraints).
 */
static void near_rows(void)
{
  int wrong = 0, left_out = 0, were_inside = 0;
  for (int trial = 0; trial < 100; trial++) {
    rows r;
    fill(&r);
    double most = 0.0, free[ROWS];
    for (int j = 0; j < ROWS; j++) {
      ct_constraint *c = &r.row[j];
      c->gap *= 6.0;
      free[j] = c->gap = fabs(c->gap) - 0.3;
      c->came = 1.5 * uniform(1.0); // moves the gap of one step ago alone
      for (int k = 0; k < 3; k++) {
        for (int a = 0; a < c->own_count; a++)
          free[j] +=
              c->own_shape[a] * c->normal[k] * r.s->increment[CT_SOLVER_WIDE * c->own[a] + k];
        for (int a = 0; a < c->other_count; a++)
          free[j] -=
              c->other_shape[a] * c->normal[k] * r.s->increment[CT_SOLVER_WIDE * c->other[a] + k];
      }
      most = fmax(most, fmax(fabs(free[j] - c->gap), -c->gap));
    }
    ct_matrix_fill(r.s);
    ct_active_choose(r.s, 0);
    for (int j = 0, next = 0; j < ROWS; j++) {
      int near = fmin(r.row[j].gap, free[j]) <= 2.0 * most, inside = before_by_hand(&r, j) < 0.0,
          listed = next < r.s->count && r.s->active[next] == &r.row[j];
      were_inside += inside && !near;
      near |= inside;
      wrong += near != listed;
      next += listed;
      left_out += !near;
    }
    release(&r);
  }
  tap_ok(wrong == 0 && left_out > 50 && were_inside > 10,
         "rows that have a force: %d only as they were inside, %d dropped, %d wrong", were_inside,
         left_out, wrong);
}

/* A mass at rest between two planes: the points of all or of one, in a solver or a piece of it. */
typedef struct squeezed {
  pthread_t thread;
  seat at;
  ct_pieces pieces;
  ct_solver *s;
  ct_constraint row[2];
  int first, end, solved;
} squeezed;

static const double MOBILITY = 0.5, FAR = 1.0, MOTION = 0.005;

/* The point of the lower plane holds energy, and opens. */
static void open_squeezed(squeezed *t)
{
  static const ct_row_set set = {2, 1, NULL, 2, 0, 0};
  static const int32_t node = 0;
  static const double one[CT_ROW_NODES] = {1.0};
  int32_t place[1];
  ct_error e;
  need(ct_solver_create(&set, 1, 1, place, &t->s), &e);
  for (int j = 0; j < 2; j++)
    t->row[j] = (ct_constraint){.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                                .stiffness = 100.0,
                                .dissipation = 0.15,
                                .restitution = 1.0,
                                .travel_time = 1.0,
                                .gap = j == 0 ? 0.0 : FAR,
                                .own_count = 1,
                                .own = &node,
                                .own_shape = one,
                                .normal = {0.0, 0.0, j == 0 ? 1.0 : -1.0}};
  t->row[0].force = 1.0;
  t->row[0].impact = (ct_impact){.reserve = 4.0, .pressed = 10.0};
  t->s->fraction = t->s->dt = 1.0, t->s->tolerance = 1e-10;
  for (int j = t->first; j < t->end; j++) t->s->rows[t->s->first[1]++] = &t->row[j];
  for (int c = 0; c < 3; c++) t->s->mobility[c] = MOBILITY;
  t->s->increment[2] = t->s->last_increment[2] = MOTION;
}

static void *solve_squeezed(void *user)
{
  squeezed *t = user;
  open_squeezed(t);
  t->pieces = (ct_pieces){&t->at, add, take_largest};
  if (t->at.with != NULL) t->s->pieces = &t->pieces;
  t->solved = ct_solver_solve(t->s);
  ct_pool_free(t->s);
  return NULL;
}

/* The lower point throws the mass into the upper plane, which is 200 times farther away than the
 * mass would move alone: the upper point takes part and follows its law, also in another piece.
 * (eq:thrown-constraints, eq:energy-controlled) */
static void thrown_row(void)
{
  meeting with = MEETING(2);
  squeezed whole = {.end = 2}, part[2];
  solve_squeezed(&whole);
  const ct_constraint *low = &whole.row[0], *up = &whole.row[1];
  const double after = FAR - (MOTION + MOBILITY * (low->force - up->force)),
               law = -0.5 * up->stiffness * (1.0 + up->dashpot) * after;
  tap_ok(whole.solved && low->impact.release > 0.0 && after < 0.0 &&
             fabs(up->force - law) < 1e-8 * law,
         "a point that is thrown inside, %.1f times as far away as it would move, takes part "
         "(%.1e off its law)",
         FAR / MOTION, up->force / law - 1.0);
  for (int k = 0; k < 2; k++) {
    part[k] = (squeezed){.at = {&with, k}, .first = k, .end = k + 1};
    if (pthread_create(&part[k].thread, NULL, solve_squeezed, &part[k]) != 0) abort();
  }
  for (int k = 0; k < 2; k++) pthread_join(part[k].thread, NULL);
  tap_ok(part[0].solved && part[1].solved &&
             memcmp(&part[0].row[0].force, &low->force, sizeof low->force) == 0 &&
             memcmp(&part[1].row[1].force, &up->force, sizeof up->force) == 0,
         "and so it does if another piece throws it");
  free(with.total);
}

/* Sums at nodes do not depend on the order of rows: the four points of a face and a fifth on its
 * nodes, with a row of other nodes before or after that one. (eq:order-free-sum, eq:tree-sum) */
static void fifth_point(void)
{
  static const ct_row_set set = {6, 8, NULL, 4, 0, 0};
  static const int32_t nodes[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  double shape[6][8], force[6], moved[2][CT_SOLVER_WIDE * 8];
  int differing = 0;
  for (int trial = 0; trial < 100; trial++) {
    ct_constraint row[6];
    for (int j = 0; j < 6; j++) {
      force[j] = 1.0 + uniform(1.0);
      for (int a = 0; a < 8; a++) shape[j][a] = a < 4 ? 0.25 + uniform(0.2) : 0.0;
      row[j] = (ct_constraint){.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                               .stiffness = 1.0,
                               .own_count = 4,
                               .own = nodes[j == 5],
                               .own_shape = shape[j],
                               .normal = {0.0, 0.6, 0.8}};
    }
    for (int last = 0; last < 2; last++) {
      ct_solver *s;
      int32_t place[8];
      ct_error e;
      need(ct_solver_create(&set, 1, 8, place, &s), &e);
      s->fraction = 1.0, s->first[1] = 6;
      for (int d = 0; d < CT_SOLVER_WIDE * 8; d++) s->mobility[d] = 1.0;
      for (int j = 0; j < 6; j++) s->rows[j] = &row[last || j < 4 ? j : 9 - j];
      double own[6];
      for (int j = 0; j < 6; j++) own[j] = force[s->rows[j] - row];
      if (!ct_active_set_up(s, 0) || !ct_matrix_push(s, own)) differing++;
      memcpy(moved[last], s->moved, sizeof moved[last]);
      ct_pool_free(s);
    }
    differing += memcmp(moved[0], moved[1], sizeof moved[0]) != 0;
  }
  tap_ok(differing == 0,
         "a fifth point on the nodes of a face: the same sums in any order (%d differ)", differing);
}

/* The whole solution: no force is negative, gradients vanish at points with a force and are not
 * negative elsewhere, and the number of rounds is small. */
static void solution(void)
{
  double off = 0.0, below = 0.0;
  int rounds = 0;
  for (int trial = 0; trial < 200; trial++) {
    rows r;
    fill(&r);
    if (!ct_solver_solve(r.s)) off = 1.0;
    fill_dense(&r);
    for (int64_t j = 0; j < r.s->count; j++) {
      double gradient = r.s->free[j] + r.s->b[j] + r.s->C[j] * r.s->force[j];
      for (int64_t k = 0; k < r.s->count; k++) gradient += r.W[j][k] * r.s->force[k];
      if (r.s->force[j] > 0.0) off = worst(off, gradient);
      else below = fmax(below, -gradient);
      below = fmax(below, -r.s->force[j]);
    }
    rounds = r.s->iterations > rounds ? r.s->iterations : rounds;
    release(&r);
  }
  tap_ok(off < 1e-8 && below < 1e-8 && rounds < 100,
         "the minimum: gradients of rows with a force %.1e, of others not below %.1e; at most %d "
         "rounds",
         off, -below, rounds);
}

/* ½ k ⟨-g⟩². */
static double spring(double k, double g) { return g < 0.0 ? 0.5 * k * g * g : 0.0; }

/* A loose solution: no step would move a force by more than the tolerance, and the rows of each set
 * lose energy, worked out from the gaps of the dense matrix (eq:energy-stop, eq:row-loss). */
static void loose_solution(double tolerance)
{
  double off = 0.0, gain = 0.0, loss_off = 0.0;
  int rounds = 0, not_converged = 0;
  for (int trial = 0; trial < 400; trial++) {
    rows r;
    fill(&r);
    ct_solver *s = r.s;
    s->tolerance = tolerance;
    if (!ct_solver_solve(s)) off = HUGE_VAL;
    fill_dense(&r);
    double top = 0.0, most = 0.0, loss[2] = {0.0, 0.0}, size[2] = {0.0, 0.0};
    for (int64_t j = 0; j < s->count; j++) {
      const ct_constraint *c = s->active[j];
      const int set = c - r.row >= ROWS / 2;
      double after = s->free[j], own;
      for (int64_t k = 0; k < s->count; k++) after += r.W[j][k] * s->force[k];
      most = fmax(most,
                  fabs(fmin((after + s->b[j] + s->C[j] * s->force[j]) * s->scale[j], s->force[j])));
      top = fmax(top, s->force[j]);
      own = 0.5 * (spring(c->stiffness, c->before) - spring(c->stiffness, after)) -
            0.5 * s->force[j] * (after - c->before);
      loss_off = worst(loss_off, ct_law_loss(c, s->force[j], after) - own);
      loss[set] += own;
      size[set] += s->force[j] * (fabs(after) + fabs(c->before));
    }
    not_converged += !s->converged;
    off = fmax(off, most - tolerance * top);
    for (int set = 0; set < 2; set++) gain = fmax(gain, -loss[set] - 1e-14 * size[set]);
    rounds = s->iterations > rounds ? s->iterations : rounds;
    release(&r);
  }
  tap_ok(off <= 1e-14 && gain <= 0.0 && loss_off < 1e-14 && not_converged == 0 && rounds < 100,
         "tolerance %g: residuals within it (%.1e above), no set gains energy (%.1e), losses off "
         "by %.1e, at most %d rounds",
         tolerance, off, gain, loss_off, rounds);
}

/* Ties take part however far their gaps are, between contacts that need not: their forces have any
 * sign and leave no gradient, and those of contacts are a minimum with them (eq:tie-force). */
static void ties(void)
{
  double off = 0.0, below = 0.0;
  int missing = 0, pulls = 0, contacts = 0;
  for (int trial = 0; trial < 200; trial++) {
    rows r;
    int tied = 0;
    fill(&r);
    ct_solver *s = r.s;
    for (int j = 0; j < ROWS; j += 2) {
      r.row[j].enforcement = (ct_enforcement)CT_ENFORCE_TIE;
      r.row[j].gap = 20.0 * uniform(1.0), r.row[j].force = uniform(1.0);
    }
    if (!ct_solver_solve(s)) off = HUGE_VAL;
    fill_dense(&r);
    for (int64_t j = 0; j < s->count; j++) {
      const int is_tie = (s->active[j] - r.row) % 2 == 0;
      double slope = s->free[j] + s->b[j] + s->C[j] * s->force[j];
      for (int64_t k = 0; k < s->count; k++) slope += r.W[j][k] * s->force[k];
      if (is_tie || s->force[j] > 0.0) off = worst(off, slope * s->scale[j]);
      else below = fmin(below, slope);
      tied += is_tie, contacts += !is_tie;
      pulls += is_tie && s->force[j] < 0.0;
      if (!is_tie) below = fmin(below, s->force[j]);
    }
    missing += tied != ROWS / 2;
    release(&r);
  }
  // The tolerance 1e-10 of forces up to 1e2.
  tap_ok(off < 1e-7 && below > -1e-7 && missing == 0 && pulls > 200 && contacts > 100,
         "ties leave no gradient (%.1e), contacts beside them are a minimum (%.1e); %d of %d pull",
         off, below, pulls, 200 * ROWS / 2);
}

/* Set up rows at obstacles again, as a further step does; returns whether their matrix was kept. */
static int set_up_again(rows *r)
{
  for (int i = 0; i < NODES; i++)
    for (int c = 0; c < 4; c++)
      r->s->mobility[CT_SOLVER_WIDE * i + c] = c < 3 ? r->A[3 * i + c] : 0.0;
  (void)ct_active_set_up(r->s, 0);
  return r->s->kept == 2;
}

/* Rows that have not changed keep their matrix; W and its bound are right whatever has changed, of
 * the points of a face only the normals. */
static void kept_rows(void)
{
  double off = 0.0, below = 0.0;
  int kept = 0;
  for (int i = 0; i < 250; i++) {
    rows r;
    double force[ROWS], out[ROWS];
    const int j = i % 5 == 2 ? pick(ROWS) : 4 + pick(ROWS - 4);
    fill(&r);
    make_face(&r, 0, 0);
    for (int k = 0; k < ROWS; k++) r.row[k].gap = -10.0;
    for (int k = 4; k < ROWS; k++) {
      r.row[k].own_count = 4, r.row[k].other_count = 0, r.row[k].own = r.own[k];
      take_nodes(4, r.own[k], r.own_shape[k]);
      r.row[k].own_shape = r.own_shape[k];
    }
    (void)set_up_again(&r);
    (void)set_up_again(&r);
    for (int d = 0; i % 5 == 1 && d < DOFS; d++) r.A[d] *= 4.0;
    for (int c = 0; i % 5 == 2 && c < 3; c++) r.row[j].normal[c] *= -1.0;
    if (i % 5 == 3) r.own_shape[j][pick(4)] += 1.0;
    if (i % 5 == 4) r.row[j].own = r.own[(j + 1) % ROWS];
    kept += set_up_again(&r);
    fill_dense(&r);
    for (int k = 0; k < ROWS; k++) force[k] = uniform(1.0);
    (void)ct_matrix_apply(r.s, force, out);
    for (int k = 0; k < ROWS; k++) {
      double sum = 0.0, sizes = 0.0;
      for (int l = 0; l < ROWS; l++) sum += r.W[k][l] * force[l], sizes += fabs(r.W[k][l]);
      off = worst(off, out[k] - sum);
      below = fmax(below, sizes - (1.0 / r.s->scale[k] - r.s->C[k]));
    }
    release(&r);
  }
  tap_ok(off < 1e-11 && below < 1e-11 && kept == 100,
         "W of rows that were kept or have changed (%.1e), below its bound (%.1e); %d kept", off,
         below, kept);
}

/* List other rows of each set, all, many or few, some over another face; or drop the last one, or
 * none. All have another normal and meet another place. */
static void list_others(rows *r, int drop, int none)
{
  int64_t *first = r->s->first, count = 0;
  const int many = 1 + pick(4);
  if (drop && first[2] > first[1]) first[2]--;
  for (int j = 0; j < ROWS; j++) {
    const int k = pick(ROWS);
    for (int c = 0; c < 3; c++) r->row[j].normal[c] = uniform(1.0);
    for (int b = 0; b < r->row[j].other_count; b++) r->other_shape[j][b] = uniform(1.0);
    if (drop || none) continue;
    if (r->row[k].other_count == r->row[j].other_count && pick(3) == 0)
      r->row[j].other = r->other[k];
    if (j == ROWS / 2) first[1] = count;
    if (pick(4) < many) r->s->rows[count++] = &r->row[j];
  }
  if (!drop && !none) first[2] = count;
}

/* Products of single rows that are not the same bits as theirs in `out`, of all rows. */
static int count_differing(const ct_solver *s, const double *x, const double *out)
{
  int differing = 0;
  for (const ct_group *g = s->groups; g < s->groups + s->group_count; g++)
    for (int32_t i = 0; i < g->rows; i++, out++) {
      ct_group one = *g;
      double own = 0.0;
      one.rows = 1, one.first += i * ct_group_numbers(g);
      (void)ct_matrix_times_group(s, &one, x, &own);
      differing += memcmp(&own, out, sizeof own) != 0;
    }
  return differing;
}

/* G and the numbers of rows at the nodes are those of the listed rows after each fill, although
 * groups with the nodes of the last step keep their places; and the rows of a face have the same
 * bits together as alone. */
static void changing_rows(void)
{
  double off = 0.0;
  int miscounted = 0, differing = 0;
  rows r;
  fill(&r);
  for (int step = 0; step < 3000; step++) {
    if (step % 100 == 99) release(&r), fill(&r);
    double x[CT_SOLVER_WIDE * NODES] = {0.0}, out[ROWS];
    int32_t counts[NODES] = {0};
    list_others(&r, step % 4 == 2, step % 4 == 3);
    for (int d = 0; d < DOFS; d++) x[CT_SOLVER_WIDE * (d / 3) + d % 3] = uniform(1.0);
    ct_matrix_fill(r.s);
    memcpy(r.s->first_point, r.s->first, 3 * sizeof *r.s->first); // none is dropped
    ct_matrix_times(r.s, r.s->first[2], x, out);
    differing += count_differing(r.s, x, out);
    for (int64_t i = 0; i < r.s->first[2]; i++) {
      const ct_constraint *c = r.s->rows[i];
      double gap = 0.0;
      for (int a = 0; a < c->own_count + c->other_count; a++) {
        const int b = a - c->own_count;
        const int32_t node = b < 0 ? c->own[a] : c->other[b];
        gap += (b < 0 ? c->own_shape[a] : -c->other_shape[b]) *
               ct_vector_dot(c->normal, &x[CT_SOLVER_WIDE * node]);
        counts[node]++;
      }
      off = worst(off, out[i] - gap);
    }
    miscounted += memcmp(counts, r.s->row_counts, sizeof counts) != 0;
  }
  release(&r);
  tap_ok(off < 1e-12 && miscounted == 0 && differing == 0,
         "G of rows that come and go (%.1e); wrong numbers at nodes %d times, %d differ alone", off,
         miscounted, differing);
}

int main(void)
{
  slopes();
  changing_rows();
  kept_rows();
  step();
  release_of_rows();
  near_rows();
  thrown_row();
  fifth_point();
  solution();
  loose_solution(1e-4);
  loose_solution(1e-2);
  ties();
  return tap_done();
}
