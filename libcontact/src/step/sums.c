/* Sums over nodes for a row of the energy balance: each array is read once for all of them. */
#include "sums.h"

#include "../base/bits.h"
#include "../base/lanes.h"
#include "../base/list.h"
#include "../base/stream.h"

#include <math.h>
#include <string.h>

typedef struct ct_range {
  int32_t first, end;
} ct_range;

/* Nodes that are computed side by side; pieces are padded to a multiple of them. */
enum { AT_ONCE = 4 / CT_QUAD_PARTS };
enum { KINETIC, WORK, HALF_WORK, MOMENTUM, BODY_SUMS = MOMENTUM + 6 };
enum { EFFECT_WORK, IMPULSE, EFFECT_SUMS = IMPULSE + 3 };

size_t ct_sum_grids(const ct_problem *problem)
{
  return (size_t)problem->body_count *
         (BODY_SUMS + EFFECT_SUMS * ((size_t)problem->effect_count - 1));
}

/* Nodes of a body: from its first one up to that of the next. */
static ct_range nodes_of(const ct_problem *problem, int32_t body)
{
  int is_last = body + 1 == problem->body_count;
  return (ct_range){problem->bodies[body].first_node,
                    is_last ? problem->node_count : problem->bodies[body + 1].first_node};
}

/* Place of the grids of the sums of effect `k` in a body; k = 0: of the body. */
static ct_grid *grids_of(const ct_problem *problem, const ct_state *state, int32_t k, int32_t body)
{
  size_t bodies = (size_t)problem->body_count, b = (size_t)body,
         own = k == 0 ? BODY_SUMS * b
                      : BODY_SUMS * bodies + EFFECT_SUMS * ((size_t)(k - 1) * bodies + b);
  return &state->workspace->grids[own];
}

/* Begin sums with the grids of the last row. */
static void begin(ct_stream *sums, int count, const ct_grid *grids)
{
  for (int i = 0; i < count; i++) sums[i] = (ct_stream){.grid = grids[i]};
}

/* Save their grids for the next row. */
static void keep(const ct_stream *sums, int count, ct_grid *grids)
{
  for (int i = 0; i < count; i++) grids[i] = sums[i].grid;
}

/* Arrays over a piece of nodes, shapes (count, 3); OWN is the first effect's force. */
enum { INVERSE_MASS, REFERENCE, DISPLACEMENT, VELOCITY, TOTAL, WORK_DONE, OWN, ARRAYS };

typedef struct piece {
  int64_t count;
  const double *mass, *array[ARRAYS];
  double middle[3 * AT_ONCE]; /* displacement about which the work is computed, of AT_ONCE nodes */
  double kick, share;         /* time from v_{n-1/2} to v_{n+1/2}, share of Δt to v_n */
  double (*term)[CT_PIECE];   /* results, one row per sum */
} piece;

/* Values at the nodes n ... n + AT_ONCE - 1, as stored. */
#define AT(array, n, i) (*(const ct_quad *)(const void *)&(array)[3 * (n) + AT_ONCE * (i)])

/* Place of a term of these nodes. */
#define TERM(term, n) (*(ct_quad *)(void *)&(term)[n])

/* A vector of four numbers from two others. */
#if defined(__clang__)
#define PICK(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#elif defined(__GNUC__)
typedef long long ct_places __attribute__((vector_size(32)));
#define PICK(a, b, i, j, k, l) __builtin_shuffle(a, b, (ct_places){i, j, k, l})
#endif

/* Their components, each for all of these nodes. */
CT_INLINE void split(const ct_quad v[3], ct_quad part[3])
{
#if defined(__GNUC__)
  ct_quad a = PICK(v[0], v[1], 0, 1, 6, 7), b = PICK(v[0], v[2], 2, 3, 4, 5),
          c = PICK(v[1], v[2], 0, 1, 6, 7);
  part[0] = PICK(a, b, 0, 5, 2, 7);
  part[1] = PICK(a, c, 1, 4, 3, 6);
  part[2] = PICK(b, c, 0, 5, 2, 7);
#else
  for (int i = 0; i < 3; i++) part[i] = v[i];
#endif
}

CT_CLONES
static void body_terms(const piece *of)
{
  double (*term)[CT_PIECE] = of->term;
  for (int64_t n = 0; n < of->count; n += AT_ONCE) {
    ct_quad product[3], work[3], half[3], v[3], x[3],
        P[3] = {{0.0}}, W[3] = {{0.0}}, H[3] = {{0.0}}, w[3] = {{0.0}}, r[3] = {{0.0}};
    for (int i = 0; i < 3; i++) {
      // -- v_{n+1/2} as far after v_n as v_{n-1/2} is before (eq:stage-velocity)
      ct_quad before = AT(of->array[VELOCITY], n, i), f = AT(of->array[OWN], n, i),
              u = AT(of->array[DISPLACEMENT], n, i),
              after = before +
                      of->kick * AT(of->array[INVERSE_MASS], n, i) * AT(of->array[TOTAL], n, i);
      // -- v⁻ v⁺ of each component (eq:discrete-energy)
      product[i] = before * after;
      // -- Σ f (v⁻ + v⁺) + f_n v_{n-1/2} (eq:work-sum, eq:stage-work)
      work[i] = AT(of->array[WORK_DONE], n, i) + 2.0 * of->share * f * before;
      // -- -f (u - middle) (eq:stored-by-forces)
      half[i] = f * (AT(of->middle, 0, i) - u);
      // -- v_n = ½ (v⁻ + v⁺), x_n
      v[i] = 0.5 * (before + after);
      x[i] = AT(of->array[REFERENCE], n, i) + u;
    }
    split(product, P);
    split(work, W);
    split(half, H);
    split(v, w);
    split(x, r);
    ct_quad m = *(const ct_quad *)(const void *)&of->mass[n];
    TERM(term[KINETIC], n) = 0.5 * m * ((P[0] + P[1]) + P[2]);
    TERM(term[WORK], n) = (W[0] + W[1]) + W[2];
    TERM(term[HALF_WORK], n) = 0.5 * ((H[0] + H[1]) + H[2]);
    // -- m v_n, and m x_n × v_n about the origin
    for (int c = 0; c < 3; c++) {
      int p = (c + 1) % 3, q = (c + 2) % 3;
      TERM(term[MOMENTUM + c], n) = m * w[c];
      TERM(term[MOMENTUM + 3 + c], n) = m * (r[p] * w[q] - r[q] * w[p]);
    }
  }
}

/* The terms of a piece; the remaining nodes are copied to memory for AT_ONCE of them. */
static void make_body_terms(const piece *of)
{
  double mass[AT_ONCE] = {0.0}, buffer[ARRAYS][3 * AT_ONCE] = {{0.0}};
  piece whole = *of, rest = *of;
  rest.count = of->count % AT_ONCE;
  whole.count -= rest.count;
  body_terms(&whole);
  if (rest.count == 0) return;
  memcpy(mass, &of->mass[whole.count], (size_t)rest.count * sizeof *mass);
  rest.mass = mass;
  for (int k = 0; k < ARRAYS; k++) {
    memcpy(buffer[k], &of->array[k][3 * whole.count], 3 * (size_t)rest.count * sizeof *buffer[k]);
    rest.array[k] = buffer[k];
  }
  double term[BODY_SUMS][CT_PIECE];
  rest.term = term;
  body_terms(&rest);
  for (int s = 0; s < BODY_SUMS; s++)
    memcpy(&of->term[s][whole.count], term[s], (size_t)rest.count * sizeof *term[s]);
}

/* If a force begins at t = 0 the kinetic energy is that of v_0. */
static void start_terms(const uint64_t *begun, int32_t first, const piece *of)
{
  for (int32_t n = 0; begun != NULL && n < (int32_t)of->count; n++) {
    double square[3];
    if (!ct_bits_get(begun, first + n)) continue;
    for (int64_t c = 0, d = 3 * (int64_t)n; c < 3; c++, d++) {
      double before = of->array[VELOCITY][d],
             after = ct_kick(before, of->kick, of->array[INVERSE_MASS][d], of->array[TOTAL][d]),
             middle = 0.5 * (before + after);
      square[c] = middle * middle; // v_0² (eq:energy-start)
    }
    of->term[KINETIC][n] = 0.5 * of->mass[n] * ((square[0] + square[1]) + square[2]);
  }
}

/* Middle of the displacements of a body, independent of the order of its nodes; returns the largest
 * component. */
static double middle_of(int64_t count, const double *u, double middle[3])
{
  double low[3], high[3], largest = -INFINITY;
  ct_extent(count, u, low, high);
  for (int c = 0; c < 3; c++) {
    middle[c] = 0.5 * (low[c] + high[c]);
    largest = fmax(largest, fmax(-low[c], high[c]));
  }
  return largest;
}

/* The first effect's force at the nodes first ... first + count - 1: `total` except at nodes where
 * others were added. */
static const double *first_force(const ct_workspace *w, int32_t first, int32_t count,
                                 double *buffer)
{
  const double *total = &w->total[3 * (int64_t)first];
  int32_t i = ct_lower_bound(w->shared, w->shared_count, first);
  if (i == w->shared_count || w->shared[i] >= first + count) return total;
  memcpy(buffer, total, 3 * (size_t)count * sizeof *buffer);
  for (; i < w->shared_count && w->shared[i] < first + count; i++)
    memcpy(&buffer[3 * (int64_t)(w->shared[i] - first)], &w->shared_first[3 * (int64_t)i],
           3 * sizeof *buffer);
  return buffer;
}

/* Set the pointers of a piece to its nodes. */
static void place(piece *p, const ct_problem *problem, const ct_state *state, int32_t first,
                  int32_t count, double *buffer)
{
  int64_t d = 3 * (int64_t)first;
  const double *array[ARRAYS] = {[INVERSE_MASS] = &problem->inverse_mass[d],
                                 [REFERENCE] = &problem->reference[d],
                                 [DISPLACEMENT] = &state->displacement[d],
                                 [VELOCITY] = &state->velocity[d],
                                 [TOTAL] = &state->workspace->total[d],
                                 [WORK_DONE] = &state->work[d],
                                 [OWN] = first_force(state->workspace, first, count, buffer)};
  p->count = count;
  p->mass = &problem->mass[first];
  memcpy(p->array, array, sizeof array);
}

void ct_sum_body(const ct_problem *problem, const ct_state *state, int32_t body, ct_body_sums *out)
{
  ct_range nodes = nodes_of(problem, body);
  ct_stream sums[BODY_SUMS];
  double term[BODY_SUMS][CT_PIECE], force[3 * CT_PIECE],
      share = ct_integrator_share(&problem->integrator);
  piece p = {.kick = 2.0 * share * problem->dt, .share = share, .term = term};
  double largest =
      middle_of(nodes.end - nodes.first, &state->displacement[3 * (int64_t)nodes.first], p.middle);
  for (int d = 3; d < 3 * AT_ONCE; d++) p.middle[d] = p.middle[d - 3];
  ct_grid *grids = grids_of(problem, state, 0, body);
  begin(sums, BODY_SUMS, grids);
  for (int32_t i, end; ct_stream_piece(sums, BODY_SUMS, nodes.end - nodes.first, &i, &end);) {
    place(&p, problem, state, nodes.first + i, end - i, force);
    make_body_terms(&p);
    start_terms(ct_workspace_begun(state), nodes.first + i, &p);
    for (int s = 0; s < BODY_SUMS; s++) ct_stream_add(&sums[s], term[s], end - i);
  }
  keep(sums, BODY_SUMS, grids);
  *out = (ct_body_sums){.kinetic = ct_stream_sum(&sums[KINETIC]),
                        .work = ct_stream_sum(&sums[WORK]),
                        .half_work = ct_stream_sum(&sums[HALF_WORK]),
                        .largest = largest};
  for (int c = 0; c < 3; c++) {
    out->p[c] = ct_stream_sum(&sums[MOMENTUM + c]);
    out->L[c] = ct_stream_sum(&sums[MOMENTUM + 3 + c]);
  }
}

/* Values of an array (node_count, 3) at the nodes i ... end - 1 of an effect: in place, or
 * gathered. */
static const double *at_nodes(const double *array, const ct_effect *effect, int32_t i, int32_t end,
                              double *buffer)
{
  int32_t first = ct_effect_node(effect, i);
  if (ct_effect_node(effect, end - 1) - first == end - 1 - i) return &array[3 * (int64_t)first];
  for (int32_t n = i; n < end; n++)
    memcpy(&buffer[3 * (int64_t)(n - i)], &array[3 * (int64_t)effect->nodes[n]],
           3 * sizeof *buffer);
  return buffer;
}

/* Forces of a reaction: minus all others on its degrees of freedom (eq:reaction). */
CT_CLONES
static void reaction_forces(int64_t count, const double *restrict inverse_mass,
                            const double *restrict total, double *restrict force)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++) force[d] = inverse_mass[d] == 0.0 ? -total[d] : 0.0;
}

/* Impulses and twice the work: those summed with the motion, or for a reaction, whose velocity is
 * constant, from the impulse; work null: a reaction. */
CT_CLONES
static void effect_terms(int64_t count, double share, const double *restrict force,
                         const double *restrict v, const double *restrict since,
                         const double *restrict before, const double *restrict work,
                         double *restrict impulse, double *restrict done)
{
#pragma omp simd
  for (int64_t d = 0; d < count; d++) impulse[d] = before[d] + (since[d] + share * force[d]);
  if (work == NULL) {
#pragma omp simd
    for (int64_t d = 0; d < count; d++) done[d] = 2.0 * impulse[d] * v[d];
  } else {
#pragma omp simd
    for (int64_t d = 0; d < count; d++) done[d] = work[d] + 2.0 * share * force[d] * v[d];
  }
}

/* Sums and components of a piece, which is padded to a multiple of AT_ONCE. */
CT_CLONES
static void part_terms(int64_t count, const double *impulse, const double *done,
                       double term[EFFECT_SUMS][CT_PIECE])
{
  for (int64_t n = 0; n < count; n += AT_ONCE) {
    ct_quad whole[3], part[3] = {{0.0}};
    for (int i = 0; i < 3; i++) whole[i] = AT(done, n, i);
    split(whole, part);
    TERM(term[EFFECT_WORK], n) = (part[0] + part[1]) + part[2];
    for (int i = 0; i < 3; i++) whole[i] = AT(impulse, n, i);
    split(whole, part);
    for (int c = 0; c < 3; c++) TERM(term[IMPULSE + c], n) = part[c];
  }
}

/* Compute the terms of the nodes i ... end - 1 of effect `k`; returns 0 if the effect has done
 * nothing, so that all would be zero. */
static int make_effect_terms(const ct_problem *problem, const ct_state *state, int32_t k, int32_t i,
                             int32_t end, double term[EFFECT_SUMS][CT_PIECE])
{
  const ct_effect *effect = problem->effects[k];
  const ct_workspace *w = state->workspace;
  double buffers[3][3 * CT_PIECE], made[3 * CT_PIECE], impulse[3 * CT_PIECE], done[3 * CT_PIECE];
  ct_starts start = ct_state_starts(problem, k);
  int64_t d = 3 * (int64_t)i, count = 3 * (int64_t)(end - i);
  int is_reaction = effect->phase == CT_PHASE_REACTION;
  const double *since = state->impulse + start.impulse + d,
               *before = since + state->impulse_count / 2,
               *work = is_reaction ? NULL : state->work + start.work + d,
               *force =
                   is_reaction ? at_nodes(w->total, effect, i, end, buffers[2]) : w->force[k] + d;
  if (ct_is_zero(since, count) && ct_is_zero(before, count) && ct_is_zero(force, count) &&
      (is_reaction || ct_is_zero(work, count)))
    return 0;
  if (is_reaction) {
    reaction_forces(count, at_nodes(problem->inverse_mass, effect, i, end, buffers[1]), force,
                    made);
    force = made;
  }
  effect_terms(count, ct_integrator_share(&problem->integrator), force,
               at_nodes(state->velocity, effect, i, end, buffers[0]), since, before, work, impulse,
               done);
  for (int64_t left = count; left % (3 * AT_ONCE) != 0; left++) impulse[left] = done[left] = 0.0;
  part_terms(end - i, impulse, done, term);
  return 1;
}

/* Number of nodes of an effect below a node of the problem. */
static int32_t nodes_below(const ct_effect *effect, int32_t node)
{
  int32_t count = effect->node_count;
  if (effect->nodes != NULL) return ct_lower_bound(effect->nodes, count, node);
  return count < node ? count : node;
}

void ct_sum_effect(const ct_problem *problem, const ct_state *state, int32_t k, int32_t body,
                   ct_effect_sums *out)
{
  const ct_effect *effect = problem->effects[k];
  ct_range nodes = nodes_of(problem, body);
  int32_t first = nodes_below(effect, nodes.first), count = nodes_below(effect, nodes.end) - first;
  ct_stream sums[EFFECT_SUMS];
  double term[EFFECT_SUMS][CT_PIECE];
  ct_grid *grids = grids_of(problem, state, k, body);
  begin(sums, EFFECT_SUMS, grids);
  for (int32_t i, end; ct_stream_piece(sums, EFFECT_SUMS, count, &i, &end);) {
    int is_made = i < end && make_effect_terms(problem, state, k, first + i, first + end, term);
    for (int s = 0; s < EFFECT_SUMS; s++)
      ct_stream_add(&sums[s], is_made ? term[s] : NULL, end - i);
  }
  keep(sums, EFFECT_SUMS, grids);
  out->work = ct_stream_sum(&sums[EFFECT_WORK]);
  for (int c = 0; c < 3; c++) out->impulse[c] = ct_stream_sum(&sums[IMPULSE + c]);
}
