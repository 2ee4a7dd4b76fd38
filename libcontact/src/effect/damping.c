/* Damping proportional to mass. */
#include <libcontact/effect.h>

#include "../step/effect_internal.h"
#include "../step/piece.h"
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"

#include <math.h>
#include <string.h>

typedef struct damping_data {
  ct_pool pool;
  double rate;
  int32_t *nodes;
  const double *mass, *inverse_mass; /* of the problem */
} damping_data;

/* Forces of consecutive nodes, of four at a time. */
CT_CLONES
static void drag(int32_t count, double rate, const double *restrict mass,
                 const double *restrict velocity, double *restrict force)
{
  int32_t rows = CT_ROWS ? count / 4 * 4 : 0;
#if CT_ROWS
  for (int32_t i = 0; i < rows; i += 4) {
    ct_quad m[3];
    ct_thrice(&mass[i], m);
    for (int32_t k = 3 * i, j = 0; j < 3; j++, k += 4)
      *(ct_quad *)(void *)&force[k] = -(rate * m[j]) * *(const ct_quad *)(const void *)&velocity[k];
  }
#endif
  for (int32_t i = rows; i < count; i++) {
    double c = rate * mass[i];
    // -- Against the velocity half a step back (eq:damping-force)
    for (int k = 0; k < 3; k++) force[3 * i + k] = -c * velocity[3 * i + k];
  }
}

static ct_status damping_force(const ct_effect *effect, const ct_view *view, double *force,
                               ct_error *error)
{
  const damping_data *data = effect->data;
  // -- Longer steps would reverse the velocity (eq:damping-sign)
  if (data->rate * view->c_dt > 1.0 + 1e-9)
    return ct_fail(error, CT_ERROR_STEP, CT_NOWHERE,
                   "damping: the rate %g reverses velocities in a step of %g; at most %g is safe",
                   data->rate, view->c_dt, 1.0 / data->rate);
  for (int32_t i = 0, end; i < effect->node_count; i = end) {
    int64_t node = data->nodes[i];
    end = i + ct_row_length(&data->nodes[i], effect->node_count - i);
    drag(end - i, data->rate, &data->mass[node], &view->velocity[3 * node], &force[3 * (int64_t)i]);
  }
  return CT_OK;
}

/* Memory of relaxation: its rate, the number of steps since the sample (0: no sample yet), and the
 * sample's displacements and forces on the effect's nodes. */
enum { RATE, AGE, SAMPLE };

/* At one node, from the changes since the sample: -Δu · Δf and Δu · M Δu (eq:relaxation-rate). */
static void node_change(const ct_effect *effect, const ct_view *view, int32_t i, double *stiff,
                        double *mass)
{
  const damping_data *data = effect->data;
  const double *u0 = view->memory + SAMPLE, *f0 = u0 + 3 * (int64_t)effect->node_count;
  int64_t node = data->nodes[i], own = 3 * (int64_t)i;
  double work[3], square[3];
  for (int k = 0; k < 3; k++) {
    double free = data->inverse_mass[3 * node + k] == 0.0 ? 0.0 : 1.0;
    double du = free * (view->displacement[3 * node + k] - u0[own + k]);
    work[k] = -du * (view->total[3 * node + k] - f0[own + k]);
    square[k] = du * du;
  }
  *stiff = (work[0] + work[1]) + work[2];
  *mass = data->mass[node] * ((square[0] + square[1]) + square[2]);
}

/* ω² from the changes since the sample: -Δu · Δf / Δu · M Δu, or 0 if they show no stiffness
 * (eq:relaxation-rate). */
static double rayleigh(const ct_effect *effect, const ct_view *view)
{
  double stiff[CT_PIECE], mass[CT_PIECE];
  const ct_piece *piece = *(const ct_piece **)view->scratch;
  ct_stream sum = {.pieces = piece == NULL ? NULL : &piece->join}, sums[2] = {sum, sum};
  for (int32_t first, end; ct_stream_piece(sums, 2, effect->node_count, &first, &end);) {
    int32_t some = 0;
    for (int32_t i = first; i < end; i++) {
      if (piece != NULL && !ct_piece_owns(piece, effect->nodes[i])) continue;
      node_change(effect, view, i, &stiff[some], &mass[some]);
      some++;
    }
    ct_stream_add(&sums[0], stiff, some);
    ct_stream_add(&sums[1], mass, some);
  }
  double top = ct_stream_sum(&sums[0]), bottom = ct_stream_sum(&sums[1]);
  return top > 0.0 && bottom > 0.0 && isfinite(top / bottom) ? top / bottom : 0.0;
}

/* The fraction a of a step, from the rate that the last one found: contacts must know it before
 * their forces are. While the state is created the velocity is that of t = 0, and there is none. */
static ct_status relaxation_slow(const ct_effect *effect, const ct_view *view, double *fraction,
                                 ct_error *error)
{
  (void)effect, (void)error;
  *fraction = view->dt == 0.0 ? 0.0 : 0.5 * view->memory[RATE] * view->c_dt;
  return CT_OK;
}

/* The memory for the next step. */
static void find_rate(const ct_effect *effect, const ct_view *view)
{
  const damping_data *data = effect->data;
  double rate = view->memory[RATE], age = view->memory[AGE];
  // -- A new sample after the time 1 / ω = 2 / α (eq:relaxation-rate)
  int due = age == 0.0 || 0.5 * rate * view->dt * age >= 1.0 || rate == 0.0;
  if (due && age > 0.0) {
    double omega = sqrt(rayleigh(effect, view));
    if (omega > 0.0) rate = 2.0 * omega; // (eq:relaxation-rate)
  }
  view->next_memory[RATE] = rate;
  view->next_memory[AGE] = due ? 1.0 : age + 1.0;
  double *u = view->next_memory + SAMPLE, *f = u + 3 * (int64_t)effect->node_count;
  if (!due) memcpy(u, view->memory + SAMPLE, 6 * (size_t)effect->node_count * sizeof *u);
  for (int32_t i = 0; due && i < effect->node_count; i++)
    for (int k = 0; k < 3; k++) {
      u[3 * (int64_t)i + k] = view->displacement[3 * (int64_t)data->nodes[i] + k];
      f[3 * (int64_t)i + k] = view->total[3 * (int64_t)data->nodes[i] + k];
    }
}

static ct_status relaxation_force(const ct_effect *effect, const ct_view *view, double *force,
                                  ct_error *error)
{
  const damping_data *data = effect->data;
  double a = 0.0;
  relaxation_slow(effect, view, &a, error);
  if (view->dt != 0.0) find_rate(effect, view);
  for (int32_t i = 0; i < effect->node_count; i++)
    for (int k = 0; k < 3; k++) {
      int64_t dof = 3 * (int64_t)data->nodes[i] + k;
      double m = data->mass[data->nodes[i]], v = view->velocity[dof];
      // -- -α m (v_{n-1/2} + v_{n+1/2}) / 2, solved for the velocity after the step
      // (eq:relaxation-force)
      force[3 * (int64_t)i + k] =
          a == 0.0 || data->inverse_mass[dof] == 0.0
              ? 0.0
              : -a * (2.0 * m * v / view->c_dt + view->total[dof]) / (1.0 + a);
    }
  return CT_OK;
}

/* The scratch space of relaxation is the piece of its state, or null. */
static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  (void)effect;
  *scratch = ct_allocate(1, sizeof(const ct_piece *));
  return *scratch != NULL ? CT_OK : CT_NO_MEMORY(error, "relaxation");
}

static ct_status relaxation_cut(const ct_effect *effect, const struct ct_piece *piece,
                                void *scratch, ct_error *error)
{
  (void)effect, (void)error;
  *(const ct_piece **)scratch = piece;
  return CT_OK;
}

static void relaxation_keep(const ct_effect *effect, const struct ct_piece *piece, int common,
                            double *memory)
{
  double *u = memory + SAMPLE, *f = u + 3 * (int64_t)effect->node_count;
  if (!common) memory[RATE] = memory[AGE] = 0.0;
  for (int32_t i = 0; i < effect->node_count; i++) {
    if (ct_piece_owns(piece, effect->nodes[i])) continue;
    memset(&u[3 * (int64_t)i], 0, 3 * sizeof *u);
    memset(&f[3 * (int64_t)i], 0, 3 * sizeof *f);
  }
}

static ct_status damping_rate(const ct_effect *effect, const ct_view *view, double *rate,
                              ct_error *error)
{
  (void)view, (void)error;
  *rate = ((const damping_data *)effect->data)->rate;
  return CT_OK;
}

static const ct_effect_calls DAMPING = {.force = damping_force,
                                        .free_data = ct_pool_free,
                                        .bounds = {.rate = damping_rate},
                                        .pieces = {.cut = ct_piece_local}};
static const ct_effect_calls RELAXATION = {.force = relaxation_force,
                                           .create_scratch = create_scratch,
                                           .free_scratch = ct_release,
                                           .free_data = ct_pool_free,
                                           .constraints.slow = relaxation_slow,
                                           .pieces = {relaxation_cut, relaxation_keep, 0}};

ct_damping_def ct_damping_def_default(void) { return (ct_damping_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_damping_create_effect(const ct_damping_def *def, const ct_problem *problem,
                                   ct_effect **effect, ct_error *error)
{
  ct_status status;
  damping_data *data =
      ct_effect_begin(def, problem, effect, "damping", sizeof *data, &status, error);
  if (data == NULL) return status;
  int32_t count = 0;
  data->rate = def->rate;
  data->mass = problem->mass;
  data->inverse_mass = problem->inverse_mass;
  if (!(def->rate >= 0.0) || !isfinite(def->rate))
    status = ct_fail(error, CT_INVALID, CT_NOWHERE,
                     "damping: the rate must be 0 or positive and finite, not %g", def->rate);
  else if (def->relaxation && def->rate != 0.0)
    status =
        CT_REFUSE(error, "damping: relaxation chooses the rate by itself; leave rate at 0, not %g",
                  def->rate);
  else
    status = ct_effect_body_nodes(problem, def->bodies, def->body_count, "damping", &data->pool,
                                  &data->nodes, &count, error);
  ct_effect filled = {.kind = CT_EFFECT_DAMPING,
                      .label = "damping",
                      .calls = &DAMPING,
                      .data = data,
                      .nodes = data->nodes,
                      .node_count = count,
                      .cost = {.flops = 4.0 * count, .bytes = 60.0 * count}};
  if (def->relaxation) {
    filled.memory_count = SAMPLE + 6 * (int64_t)count;
    filled.phase = CT_PHASE_TOTAL;
    filled.calls = &RELAXATION;
  }
  return ct_effect_finish(status, &filled, effect, error);
}
