/* The tangential forces of a step: an accelerated projected gradient within the discs of all points
 * (eq:slip-problem, eq:slip-iteration). */
#include "tangent.h"

#include "../base/grid.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "law.h"
#include "matrix.h"
#include "slip.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS, MOST_ROUNDS = 1000, MOST_PASSES = 20 };

/* The iteration ends when the largest change of a force is below this fraction of the largest
 * force; a point sticks when its slip is below this many times that change. */
static const double TOLERANCE = 1e-4, STICK = 10.0;

/* The limits are computed again once if a normal force has changed by more than this fraction of
 * the largest. And normal forces are solved for again if tangential ones change them by more than
 * the second. */
static const double LIMIT_CHANGE = 0.01, COUPLING = 1e-10, LEAST = 1e-6;

/* One row with friction. */
typedef struct tangent_row {
  ct_constraint *row;
  ct_slip *slip;
  int32_t place[CT_ROW_NODES]; /* of its nodes in vectors at nodes */
  ct_slip_law law;
  ct_slip_set set;
  double scale;       /* 1 / D (eq:slip-bound) */
  double last[3];     /* D₋ */
  double q[WIDE];     /* D without friction + e_n + κ e_{n-1} */
  double T[WIDE];     /* the force */
  double at[WIDE];    /* where the gradient is evaluated (eq:slip-iteration) */
  double image[WIDE]; /* W times a force */
} tangent_row;

typedef struct ct_tangent {
  int64_t count;
  tangent_row *rows;
  int32_t node_count, *nodes; /* places of the nodes on which these rows act */
  int32_t most_row_count;     /* largest number of rows at a node */
  double *sums, *moved;       /* as of the solver, of the tangential forces */
  double *drift;              /* displacement increment without friction */
  double *terms;              /* three numbers per row */
  double *gap_free;           /* of active rows, without tangential forces */
  double *shift;              /* of these gaps by tangential forces */
  double top;                 /* the largest limit */
  double size;                /* the largest force, at least LEAST times this limit */
  double rate;                /* of the iteration */
  double tolerance;           /* of the forces */
  int most_rounds;
  int pass;
} ct_tangent;

void ct_tangent_create(ct_solver *s, int64_t most)
{
  ct_pool *pool = &s->pool;
  const size_t nodes = (size_t)s->node_count, rows = 2 * (size_t)s->most;
  ct_tangent *t = s->tangent = ct_pool_take(pool, 1, sizeof *t);
  if (t == NULL) return;
  t->most_rounds = MOST_ROUNDS;
  t->rows = ct_pool_take(pool, (size_t)most, sizeof *t->rows);
  t->nodes = ct_pool_take(pool, nodes, sizeof *t->nodes);
  double **vectors[] = {&t->sums, &t->moved, &t->drift};
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
    *vectors[i] = ct_pool_take(pool, nodes, WIDE * sizeof(double));
  t->terms = ct_pool_take(pool, (size_t)most, 3 * sizeof *t->terms);
  t->gap_free = ct_pool_take(pool, rows, sizeof *t->gap_free);
  t->shift = ct_pool_take(pool, rows, sizeof *t->shift);
}

/* Sum over the nodes of one face, paired so that a flipped face gives the same bits (eq:tree-sum).
 */
CT_INLINE void sum_face(int32_t count, const double *N, const int32_t *place, const double *x,
                        double out[WIDE])
{
  ct_quad t[8];
  const ct_quad none = {0.0};
  for (int i = 0; i < PARTS; i++) {
    for (int32_t a = 0; a < count; a++) t[a] = N[a] * ((const ct_quad *)&x[place[a]])[i];
    for (int32_t a = count; a < 8; a++) t[a] = none;
    ct_quad sum = (t[0] + t[1]) + (t[2] + t[3]);
    if (count > 4) sum += (t[4] + t[6]) + (t[5] + t[7]);
    ((ct_quad *)out)[i] = sum;
  }
}

/* Motion of a point relative to its partner, in the plane of contact, for a vector at nodes. */
CT_INLINE void relative(int32_t own, int32_t other, const tangent_row *r, const double *x,
                        double out[WIDE])
{
  const ct_constraint *c = r->row;
  const ct_slip *slip = r->slip;
  const int32_t *place = r->place + own;
  double theirs[WIDE], turn[8], y[8] = {0.0};
  sum_face(own, c->own_shape, r->place, x, out);
  if (other > 0) {
    ct_quad t[8], none = {0.0};
    sum_face(other, c->other_shape, place, x, theirs);
    for (int32_t b = 0; b < other; b++) y[b] = ct_vector_dot(slip->lever, &x[place[b]]);
    memcpy(turn, y, sizeof turn);
    for (int i = 0; i < PARTS; i++) {
      for (int32_t b = 0; b < other; b++) t[b] = turn[b] * ((const ct_quad *)slip->weight[b])[i];
      for (int32_t b = other; b < 8; b++) t[b] = none;
      ct_quad sum = (t[0] + t[1]) + (t[2] + t[3]);
      if (other > 4) sum += (t[4] + t[6]) + (t[5] + t[7]);
      // -- Σ N_a x_a - Σ N̄_b x_b - Σ w_b (d · x_b) (eq:slip-row)
      ((ct_quad *)out)[i] -= ((const ct_quad *)theirs)[i] + sum;
    }
  }
  ct_vector_make_tangential(c->normal, out);
  out[3] = 0.0;
}

/* `image` of all rows from a vector at nodes. */
CT_CLONES
static void relative_rows(int64_t count, tangent_row *rows, const double *x)
{
  for (tangent_row *r = rows; r < rows + count; r++) {
    const int32_t own = r->row->own_count, other = r->row->other_count;
    if (own == 4 && other == 4) relative(4, 4, r, x, r->image);
    else if (own == 4 && other == 0) relative(4, 0, r, x, r->image);
    else relative(own, other, r, x, r->image);
  }
}

/* Add a row times a force to the sums at nodes, as multiples of the grid's spacing: these sums are
 * exact in any order (eq:order-free-sum). */
CT_INLINE void add_row(double coarse, int32_t own, int32_t other, const tangent_row *r,
                       const double *T, double *sums)
{
  const ct_constraint *c = r->row;
  const ct_slip *slip = r->slip;
  const ct_quad *force = (const ct_quad *)T, *lever = (const ct_quad *)slip->lever;
  for (int32_t a = 0; a < own; a++)
    for (int i = 0; i < PARTS; i++)
      // -- N_a T on the own face (eq:slip-row)
      ((ct_quad *)&sums[r->place[a]])[i] += (c->own_shape[a] * force[i] + coarse) - coarse;
  for (int32_t b = 0; b < other; b++) {
    const double turn = ct_vector_dot(slip->weight[b], T);
    for (int i = 0; i < PARTS; i++)
      // -- -(N̄_b T + (w_b · T) d) on the other
      ((ct_quad *)&sums[r->place[own + b]])[i] -=
          ((c->other_shape[b] * force[i] + turn * lever[i]) + coarse) - coarse;
  }
}

CT_CLONES
static void add_rows(double coarse, int64_t count, const tangent_row *rows, int at, double *sums)
{
  for (const tangent_row *r = rows; r < rows + count; r++) {
    const int32_t own = r->row->own_count, other = r->row->other_count;
    const double *T = at ? r->at : r->T;
    if (own == 4 && other == 4) add_row(coarse, 4, 4, r, T, sums);
    else if (own == 4 && other == 0) add_row(coarse, 4, 0, r, T, sums);
    else add_row(coarse, own, other, r, T, sums);
  }
}

/* The sums of all pieces. */
static void join_sums(ct_solver *s)
{
  if (s->pieces != NULL) ct_pieces_sum(s->pieces, s->tangent->sums, WIDE * (int64_t)s->node_count);
}

/* `image` = W times the forces, or times those of `at`. Returns 0 if they are not finite. */
static int apply(ct_solver *s, int at)
{
  ct_tangent *t = s->tangent;
  ct_grid grid;
  double top = 0.0;
  for (int64_t j = 0; j < t->count; j++) {
    const double *T = at ? t->rows[j].at : t->rows[j].T;
    for (int i = 0; i < 3; i++) top = fabs(T[i]) > top || isnan(T[i]) ? fabs(T[i]) : top;
  }
  ct_pieces_largest(s->pieces, &top, 1);
  // Shape functions of quadratic faces are below 1 in size; the factor 4 is a margin.
  if (!ct_grid_init(&grid, 4.0 * top, t->most_row_count)) return 0;
  add_rows(grid.coarse, t->count, t->rows, at, t->sums);
  join_sums(s);
  ct_matrix_move(t->node_count, t->nodes, s->mobility, t->sums, t->moved);
  relative_rows(t->count, t->rows, t->moved);
  s->iterations++;
  return 1;
}

/* Size of the entry of node `a` of a row. */
static double entry_size(const tangent_row *r, int32_t a)
{
  const int32_t own = r->row->own_count;
  const double *d = r->slip->lever, *w = r->slip->weight[a < own ? 0 : a - own];
  if (a < own) return fabs(r->row->own_shape[a]);
  return fabs(r->row->other_shape[a - own]) + sqrt(ct_vector_dot(w, w) * ct_vector_dot(d, d));
}

/* Count the rows at each node and list the nodes on which any acts. */
static void list_nodes(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double most = 0.0;
  for (int64_t j = 0; j < t->count; j++) {
    const tangent_row *r = &t->rows[j];
    for (int32_t a = 0; a < r->row->own_count + r->row->other_count; a++) {
      double *count = &t->sums[r->place[a] + 3];
      if (*count == 0.0 && s->pieces == NULL) t->nodes[t->node_count++] = r->place[a];
      *count += 1.0;
    }
  }
  join_sums(s);
  for (int32_t n = 0; s->pieces != NULL && n < s->node_count; n++)
    t->nodes[t->node_count++] = WIDE * n;
  for (int32_t k = 0; k < t->node_count; k++) {
    most = fmax(most, t->sums[t->nodes[k] + 3]);
    t->sums[t->nodes[k] + 3] = 0.0;
  }
  t->most_row_count = (int32_t)most;
}

/* The bound D of each row of W (eq:slip-bound) becomes `scale`. Returns 0 if it is not finite. */
static int find_bound(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  ct_grid grid;
  double top = 1.0;
  for (int64_t j = 0; j < t->count; j++)
    for (int32_t a = 0; a < t->rows[j].row->own_count + t->rows[j].row->other_count; a++)
      top = fmax(top, entry_size(&t->rows[j], a));
  ct_pieces_largest(s->pieces, &top, 1);
  if (!ct_grid_init(&grid, top, t->most_row_count)) return 0;
  for (int64_t j = 0; j < t->count; j++)
    for (int32_t a = 0; a < t->rows[j].row->own_count + t->rows[j].row->other_count; a++)
      t->sums[t->rows[j].place[a] + 3] += (entry_size(&t->rows[j], a) + grid.coarse) - grid.coarse;
  join_sums(s);
  for (int32_t k = 0; k < t->node_count; k++) {
    const double *A = &s->mobility[t->nodes[k]];
    double *sum = &t->sums[t->nodes[k] + 3];
    t->moved[t->nodes[k] + 3] = *sum * fmax(fmax(A[0], A[1]), A[2]);
    *sum = 0.0;
  }
  for (int64_t j = 0; j < t->count; j++) {
    tangent_row *r = &t->rows[j];
    double face[2] = {0.0, 0.0};
    for (int32_t side = 0, a = 0; side < 2; side++) {
      const int32_t count = side == 0 ? r->row->own_count : r->row->other_count;
      double term[8] = {0.0};
      // -- β_a A_a Σ_k β_ka of one node (eq:slip-bound)
      for (int32_t b = 0; b < count; b++, a++)
        term[b] = entry_size(r, a) * t->moved[r->place[a] + 3];
      face[side] =
          ((term[0] + term[1]) + (term[2] + term[3])) + ((term[4] + term[6]) + (term[5] + term[7]));
    }
    r->scale = face[0] + face[1];
  }
  return 1;
}

/* List the rows with friction and a normal force, with their limits. */
static void list_rows(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  t->count = 0;
  t->top = 0.0;
  for (int32_t set = 0; set < s->set_count; set++)
    for (int64_t j = s->first[set]; j < s->first[set + 1]; j++) {
      ct_constraint *c = s->rows[j];
      if (c->slip == NULL) continue;
      if (!(c->force > 0.0)) {
        ct_slip_open(c->slip);
        continue;
      }
      tangent_row *r = &t->rows[t->count++];
      const int32_t *place = &s->place[s->first_node[set]];
      int32_t *out = r->place;
      double last[WIDE] = {0.0};
      r->row = c, r->slip = c->slip;
      for (int32_t a = 0; a < c->own_count; a++) *out++ = WIDE * place[c->own[a]];
      for (int32_t b = 0; b < c->other_count; b++) *out++ = WIDE * place[c->other[b]];
      // -- D₋: the motion of the last step, along the present row (eq:slip-set)
      if (!s->starts) relative(c->own_count, c->other_count, r, s->last_increment, last);
      for (int i = 0; i < 3; i++) r->last[i] = last[i] - c->slip->came[i];
      ct_vector_make_tangential(c->normal, r->last);
      r->set = ct_slip_set_of(c->slip, c->force, r->last);
      t->top = fmax(t->top, r->set.limit);
    }
  ct_pieces_largest(s->pieces, &t->top, 1);
}

/* The laws of the listed rows. Returns 0 if they are not finite. */
static int fix_laws(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double slowest = 1.0;
  list_nodes(s);
  if (!find_bound(s)) return 0;
  for (int64_t j = 0; j < t->count; j++) {
    tangent_row *r = &t->rows[j];
    const ct_constraint as_spring = {.stiffness = r->slip->k, .dissipation = r->row->dissipation};
    r->law = ct_slip_law_of(r->slip, ct_law_dashpot(&as_spring, r->scale / s->fraction));
    // -- 1 / D, with the compliance
    const double bound = r->scale + r->law.C;
    r->scale = 1.0 / bound;
    slowest = fmin(slowest, r->law.C / bound);
  }
  // -- The smallest eigenvalue of D⁻¹ (W + C) is at least that of D⁻¹ C (eq:slip-iteration)
  slowest = -slowest;
  ct_pieces_largest(s->pieces, &slowest, 1);
  const double root = sqrt(-slowest);
  t->rate = (1.0 - root) / (1.0 + root);
  return 1;
}

/* The iteration begins with the given forces, as far as they are allowed. */
static void start(ct_tangent *t)
{
  for (int64_t j = 0; j < t->count; j++) {
    tangent_row *r = &t->rows[j];
    for (int i = 0; i < 3; i++) r->T[i] = r->slip->force[i];
    r->T[3] = 0.0;
    ct_slip_project(&r->set, r->T);
    ct_vector_make_tangential(r->row->normal, r->T);
  }
}

/* Motion of the nodes without friction, with the present normal forces, and what follows for the
 * rows. Returns 0 if the forces are not finite. */
static int find_drift(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (s->count > 0 || s->pieces != NULL) {
    if (!ct_matrix_apply(s, s->force, s->image)) return 0;
    for (int32_t k = 0; k < s->active_node_count; k++)
      for (int32_t c = 0, at = s->active_nodes[k]; c < 3; c++)
        t->drift[at + c] = s->increment[at + c] + s->moved[at + c];
  }
  relative_rows(t->count, t->rows, t->drift);
  for (int64_t j = 0; j < t->count; j++) {
    tangent_row *r = &t->rows[j];
    const ct_slip *p = r->slip;
    for (int i = 0; i < 3; i++) r->q[i] = r->image[i] - p->coming[i];
    ct_vector_make_tangential(r->row->normal, r->q);
    // -- q = D + e_n + κ e_{n-1} without friction (eq:slip-residual)
    for (int i = 0; i < 3; i++) r->q[i] += p->e[i] + r->law.kappa * p->before[i];
  }
  return 1;
}

/* One round: the forces that follow from the gradient, and the next place of the gradient
 * (eq:slip-iteration). Writes the largest change of a force, and the largest force. */
static void take_round(ct_tangent *t, double *next, double size[2])
{
  double most = 0.0, top = LEAST * t->top;
  for (int64_t j = 0; j < t->count; j++, next += 3) {
    const tangent_row *r = &t->rows[j];
    for (int i = 0; i < 3; i++)
      // -- y - D⁻¹ ((W + C) y + q) (eq:slip-iteration)
      next[i] = r->at[i] - r->scale * ((r->image[i] + r->law.C * r->at[i]) + r->q[i]);
    ct_slip_project(&r->set, next);
    for (int i = 0; i < 3; i++) {
      const double change = fabs(next[i] - r->at[i]);
      most = change > most || isnan(change) ? change : most;
      top = fabs(next[i]) > top ? fabs(next[i]) : top;
    }
  }
  size[0] = most, size[1] = top;
}

/* Take the forces of a round, and extrapolate. */
static void extrapolate(ct_tangent *t, const double *next)
{
  for (int64_t j = 0; j < t->count; j++, next += 3)
    for (int i = 0; i < 3; i++) {
      tangent_row *r = &t->rows[j];
      // -- T + β (T - T of the last round) (eq:slip-iteration)
      r->at[i] = next[i] + t->rate * (next[i] - r->T[i]);
      r->T[i] = next[i];
    }
}

/* Solve for the tangential forces with the present normal ones. Forces that already meet twice
 * the tolerance are not changed. Returns the number of rounds that changed them; -1 if they are not
 * finite. */
static int iterate(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double tolerance = 2.0 * t->tolerance;
  for (int64_t j = 0; j < t->count; j++) memcpy(t->rows[j].at, t->rows[j].T, sizeof t->rows[j].at);
  for (int k = 0;; k++, tolerance = t->tolerance) {
    if (!apply(s, 1)) return -1;
    double size[2];
    take_round(t, t->terms, size);
    ct_pieces_largest(s->pieces, size, 2);
    if (!isfinite(size[0])) return -1;
    const int enough = size[0] <= tolerance * size[1];
    t->size = size[1];
    if (k == 0 && enough) return 0;
    extrapolate(t, t->terms);
    if (enough) return k + 1;
    if (k == t->most_rounds) return k + 1;
  }
}

/* The motion of the gaps of all active rows by the tangential forces, in `shift`; returns whether
 * it differs from the one with which the normals were solved for. -1: not finite. */
static int find_shift(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double most[2] = {0.0, 0.0};
  if (!apply(s, 0)) return -1;
  ct_matrix_times(s, s->count, t->moved, t->shift);
  for (int64_t r = 0; r < s->count; r++) {
    const double change = t->shift[r] - (s->free[r] - t->gap_free[r]);
    most[0] = fmax(most[0], fabs(change) * s->scale[r]);
    most[1] = fmax(most[1], s->force[r]);
  }
  ct_pieces_largest(s->pieces, most, 2);
  return most[0] > COUPLING * most[1];
}

/* Σ of one number of each row, independent of the order. */
static double sum_terms(ct_solver *s)
{
  return ct_sum_over(s->pieces, s->tangent->terms, s->tangent->count);
}

/* The factor of all forces with which friction dissipates whatever the iteration did
 * (eq:slip-guard). `image` is that of the forces. */
static double guard(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double sum[2];
  for (int k = 0; k < 2; k++) {
    for (int64_t j = 0; j < t->count; j++) {
      const tangent_row *r = &t->rows[j];
      t->terms[j] = k == 0 ? ct_vector_dot(r->T, r->image) + r->law.C * ct_vector_dot(r->T, r->T)
                           : ct_vector_dot(r->T, r->q);
    }
    sum[k] = sum_terms(s);
  }
  // -- θ = min(1, max(0, -T·q / T·(W + C) T)) (eq:slip-guard)
  return sum[0] + sum[1] > 0.0 && sum[0] > 0.0 ? fmax(-sum[1] / sum[0], 0.0) : 1.0;
}

/* Store the force of a row, and its elastic slip at the end of the step. */
static void store_row(const ct_tangent *t, tangent_row *r, double theta)
{
  ct_slip *p = r->slip;
  const double before = ct_slip_stored(p), most = STICK * t->tolerance * t->size / r->scale;
  double slip[3], motion[3];
  for (int i = 0; i < 3; i++) {
    p->force[i] = theta * r->T[i];
    // -- The slip of the step, and D₊ (eq:slip-residual)
    slip[i] = (theta * r->image[i] + r->law.C * p->force[i]) + r->q[i];
    motion[i] = theta * r->image[i] + (r->q[i] - (p->e[i] + r->law.kappa * p->before[i]));
  }
  // -- A point that slips less than the iteration resolves sticks (eq:slip-stick)
  p->stuck = ct_vector_dot(slip, slip) <= most * most;
  // -- R = -½ T · slip (eq:slip-store)
  p->reserve = p->stuck ? 0.0 : -0.5 * ct_vector_dot(p->force, slip);
  for (int i = 0; i < 3; i++) {
    const double e = p->e[i];
    p->e[i] = p->stuck ? e + motion[i] : -r->law.C * p->force[i] - r->law.kappa * p->before[i];
    p->before[i] = e;
  }
  const double after = ct_vector_dot(p->force, motion), last = ct_vector_dot(p->force, r->last);
  // -- ½ T · (D₊ + D₋) (eq:slip-work)
  p->work = 0.5 * (after + last);
  // -- ¼ T · (D₊ - D₋) (eq:slip-held)
  p->lag = 0.25 * (after - last);
  // What a point gains that does not stick exactly is taken from the reserves (eq:slip-stick)
  if (p->stuck) p->reserve = fmin((before - ct_slip_stored(p)) - p->work, 0.0);
}

/* Share the reserves: their sum is not negative, and none of them may be. */
static void share_reserves(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double sum[2];
  for (int k = 0; k < 2; k++) {
    for (int64_t j = 0; j < t->count; j++) {
      const double R = t->rows[j].slip->reserve;
      t->terms[j] = k == 0 ? R : fmax(R, 0.0);
    }
    sum[k] = sum_terms(s);
  }
  const double part = sum[1] > 0.0 ? fmax(sum[0], 0.0) / sum[1] : 0.0;
  for (int64_t j = 0; j < t->count; j++) {
    double *R = &t->rows[j].slip->reserve;
    *R = fmax(*R, 0.0) * (sum[0] < sum[1] ? part : 1.0);
  }
}

/* Store the forces of all rows, and the gaps that they move. */
static void store(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const double theta = guard(s);
  for (int64_t j = 0; j < t->count; j++) store_row(t, &t->rows[j], theta);
  share_reserves(s);
  for (int64_t r = 0; r < s->point_count; r++)
    s->active[r]->after += theta * t->shift[r] - (s->free[r] - t->gap_free[r]);
}

/* Whether a normal force has changed so much that the limits must follow it. */
static int has_new_limits(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  double change = 0.0;
  for (int64_t j = 0; j < t->count; j++) {
    const tangent_row *r = &t->rows[j];
    change = fmax(change, fabs(r->slip->mu * r->row->force - r->set.limit));
  }
  ct_pieces_largest(s->pieces, &change, 1);
  return change > LIMIT_CHANGE * t->top;
}

/* The limits of the present normal forces. */
static void follow_limits(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  t->top = 0.0;
  for (int64_t j = 0; j < t->count; j++) {
    tangent_row *r = &t->rows[j];
    r->set.limit = r->slip->mu * r->row->force;
    ct_slip_project(&r->set, r->T);
    t->top = fmax(t->top, r->set.limit);
  }
  ct_pieces_largest(s->pieces, &t->top, 1);
}

/* The gaps that the normals close, with the tangential forces. */
static void shift_gaps(ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  for (int64_t r = 0; r < s->count; r++) s->free[r] = t->gap_free[r] + t->shift[r];
}

void ct_tangent_begin(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (t == NULL) return;
  t->pass = 0;
  t->tolerance = fmax(TOLERANCE, 0.1 * s->tolerance);
  for (int32_t k = 0; k < t->node_count; k++)
    memset(&t->moved[t->nodes[k]], 0, WIDE * sizeof *t->moved);
  t->node_count = 0;
  memcpy(t->gap_free, s->free, (size_t)s->count * sizeof *t->gap_free);
  memcpy(t->drift, s->increment, WIDE * (size_t)s->node_count * sizeof *t->drift);
}

int ct_tangent_solve(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  if (t == NULL) return 0;
  const int pass = t->pass, new_limits = pass == 1 && has_new_limits(s);
  if (pass == 0) {
    list_rows(s);
    if (t->top == 0.0) return 0;
    if (!fix_laws(s)) return -1;
    start(t);
  }
  if (new_limits) follow_limits(s);
  t->pass++;
  if (!find_drift(s)) return -1;
  const int rounds = iterate(s), coupled = rounds < 0 ? -1 : find_shift(s);
  if (coupled < 0) return -1;
  if (coupled && pass < MOST_PASSES) {
    shift_gaps(s);
    return 1;
  }
  s->converged = s->converged && !coupled && rounds <= t->most_rounds;
  store(s);
  return 0;
}
