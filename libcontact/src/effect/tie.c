/* Ties: surfaces of unlike meshes that are glued together. */
#include <libcontact/effect.h>
#include <libcontact/base.h>
#include <libcontact/search.h>

#include "../constraint/law.h"
#include "../gap/side.h"
#include "../shape/facets.h"
#include "../step/effect_internal.h"
#include "../step/piece.h"

#include <math.h>

/* A point of one surface, tied to a place on the other. */
typedef struct tie_point {
  const int32_t *own, *other; /* nodes of both faces among those of the effect */
  int own_count, other_count;
  const double *N; /* shape functions at the point ... */
  double N_bar[8]; /* ... and at the place where it is tied */
  double stiffness;
} tie_point;

typedef struct tie_data {
  ct_pool pool;
  ct_facets facets[2];
  int32_t *nodes, node_count; /* of both surfaces, ascending */
  int32_t *own[2];            /* those of the faces among them, shape (face_count, per) */
  tie_point *points;
  int64_t point_count, all; /* tied points, and all points */
  double farthest;          /* largest distance over which a point is tied */
} tie_data;

/* Rows of a state, three for each point, along x, y and z: all of them, or those of a piece. */
typedef struct tie_scratch {
  ct_pool pool;
  int64_t row_count, *number; /* and the number of each row among all */
  ct_constraint *rows;
  double *terms, *fine;    /* memory for sums: of each row, and of each component of each node */
  const ct_pieces *pieces; /* null: all rows */
} tie_scratch;

/* The row of a point along an axis, without gap and force. */
static ct_constraint row_of(const tie_point *p, int axis)
{
  ct_constraint row = {.enforcement = (ct_enforcement)CT_ENFORCE_TIE,
                       .own_count = p->own_count,
                       .other_count = p->other_count,
                       .own = p->own,
                       .other = p->other,
                       .own_shape = p->N,
                       .other_shape = p->N_bar,
                       .stiffness = p->stiffness};
  row.normal[axis] = 1.0;
  return row;
}

/* Whether the rows of a point are those of a piece, that of its face. */
static int is_mine(const ct_effect *effect, const ct_piece *piece, int64_t point)
{
  const tie_point *p = &((const tie_data *)effect->data)->points[point];
  int32_t nodes[8];
  for (int a = 0; a < p->own_count; a++) nodes[a] = effect->nodes[p->own[a]];
  return ct_piece_of_face(piece, p->own_count, nodes) == piece->def.number;
}

/* The rows of a piece; null: all rows. */
static void take_rows(const ct_effect *effect, const ct_piece *piece, tie_scratch *s)
{
  const tie_data *tie = effect->data;
  s->row_count = 0;
  for (int64_t r = 0; r < effect->constraint_count; r++) {
    if (piece != NULL && !is_mine(effect, piece, r / 3)) continue;
    s->number[s->row_count] = r;
    s->rows[s->row_count++] = row_of(&tie->points[r / 3], (int)(r % 3));
  }
}

static ct_status create_scratch(const ct_effect *effect, void **scratch, ct_error *error)
{
  const tie_data *tie = effect->data;
  tie_scratch *s = ct_allocate(1, sizeof *s);
  if (s == NULL) return CT_NO_MEMORY(error, "the effect tie");
  const size_t rows = 3 * (size_t)tie->point_count;
  s->rows = ct_pool_take(&s->pool, rows, sizeof *s->rows);
  s->number = ct_pool_take(&s->pool, rows, sizeof *s->number);
  s->terms = ct_pool_take(&s->pool, rows, sizeof *s->terms);
  s->fine = ct_pool_take(&s->pool, (size_t)tie->node_count, 3 * sizeof *s->fine);
  if (s->pool.failed) {
    ct_pool_free(s);
    return CT_NO_MEMORY(error, "the effect tie");
  }
  take_rows(effect, NULL, s);
  *scratch = s;
  return CT_OK;
}

/* Displacement of a place on a face along an axis. */
static double moved_by(const ct_effect *effect, const double *u, int32_t count,
                       const int32_t *place, const double *N, int axis)
{
  double terms[8] = {0.0};
  for (int32_t a = 0; a < count; a++)
    terms[a] = N[a] * u[3 * (int64_t)effect->nodes[place[a]] + axis];
  return ct_side_sum(count, terms);
}

static ct_status tie_list(const ct_effect *effect, const ct_view *view, ct_constraint **rows,
                          int64_t *count, ct_error *error)
{
  const tie_scratch *s = view->scratch;
  const double *u = view->displacement;
  (void)error;
  *count = s->row_count;
  for (int64_t r = 0; r < *count; r++) {
    ct_constraint *row = rows[r] = &s->rows[r];
    const int axis = (int)(r % 3);
    // -- Displacement of the point relative to the place where it is tied (eq:tie-gap)
    row->gap = moved_by(effect, u, row->own_count, row->own, row->own_shape, axis) -
               moved_by(effect, u, row->other_count, row->other, row->other_shape, axis);
    row->force = view->memory[s->number[r]];
  }
  if (*count > 0) rows[0]->dashpot = NAN; // tells the solver that forces are those of the memory
  return CT_OK;
}

/* Add a row's force at the nodes of one face. */
static void spread(const ct_grid *grid, double force, int32_t count, const int32_t *place,
                   const double *N, int axis, double *coarse, double *fine)
{
  for (int32_t a = 0; a < count; a++) {
    const int64_t to = 3 * (int64_t)place[a] + axis;
    ct_grid_add(grid, N[a] * force, &coarse[to], &fine[to]);
  }
}

static ct_status tie_force(const ct_effect *effect, const ct_view *view, double *force,
                           ct_error *error)
{
  const tie_scratch *s = view->scratch;
  const int64_t components = 3 * (int64_t)effect->node_count;
  double top = 0.0;
  ct_grid grid;
  for (int64_t r = 0; r < s->row_count; r++) {
    view->next_memory[s->number[r]] = s->rows[r].force;
    top = fmax(top, fabs(s->rows[r].force));
  }
  ct_pieces_largest(s->pieces, &top, 1);
  for (int64_t d = 0; d < components; d++) force[d] = s->fine[d] = 0.0;
  if (top == 0.0) return CT_OK;
  // Shape functions of quadratic faces are below 1 in size; the factor 2 is a margin.
  if (!ct_grid_init(&grid, 2.0 * top, 16 * effect->constraint_count))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE,
                   "the largest force of a tie, %g, is too large or not finite; the motion has "
                   "diverged",
                   top);
  for (int64_t r = 0; r < s->row_count; r++) {
    const ct_constraint *row = &s->rows[r];
    const int axis = (int)(r % 3);
    // -- N_a λ on the own face, -N̄_b λ on the other (eq:constraint-force)
    spread(&grid, row->force, row->own_count, row->own, row->own_shape, axis, force, s->fine);
    spread(&grid, -row->force, row->other_count, row->other, row->other_shape, axis, force,
           s->fine);
  }
  ct_pieces_sum(s->pieces, force, components);
  ct_pieces_sum(s->pieces, s->fine, components);
  for (int64_t d = 0; d < components; d++) force[d] += s->fine[d];
  return CT_OK;
}

static ct_status tie_energy(const ct_effect *effect, const ct_view *view, double *energy,
                            ct_error *error)
{
  const tie_scratch *s = view->scratch;
  (void)effect, (void)error;
  for (int64_t r = 0; r < s->row_count; r++)
    s->terms[r] = view->time == 0.0 ? ct_law_start(&s->rows[r]) : ct_law_energy(&s->rows[r]);
  *energy = ct_sum_over(s->pieces, s->terms, s->row_count);
  return CT_OK;
}

/* A piece has the rows of the points of its faces. */
static ct_status tie_cut(const ct_effect *effect, const struct ct_piece *piece, void *scratch,
                         ct_error *error)
{
  tie_scratch *s = scratch;
  (void)error;
  s->pieces = &piece->join;
  take_rows(effect, piece, s);
  return CT_OK;
}

static void tie_keep(const ct_effect *effect, const struct ct_piece *piece, int common,
                     double *memory)
{
  (void)common;
  for (int64_t r = 0; r < effect->constraint_count; r++)
    if (!is_mine(effect, piece, r / 3)) memory[r] = 0.0;
}

static const ct_effect_calls CALLS = {.force = tie_force,
                                      .energy = tie_energy,
                                      .create_scratch = create_scratch,
                                      .free_scratch = ct_pool_free,
                                      .free_data = ct_pool_free,
                                      .constraints = {.list = tie_list},
                                      .pieces = {tie_cut, tie_keep, .common = 1}};

/* The nodes of both surfaces, and those of their faces among them. */
static ct_status join_nodes(tie_data *tie, ct_error *error)
{
  const ct_facets *a = &tie->facets[0], *b = &tie->facets[1];
  tie->nodes =
      ct_pool_take(&tie->pool, (size_t)a->node_count + (size_t)b->node_count, sizeof *tie->nodes);
  for (int s = 0; s < 2; s++)
    tie->own[s] =
        ct_pool_take(&tie->pool, (size_t)tie->facets[s].face_count * (size_t)tie->facets[s].per,
                     sizeof(int32_t));
  if (tie->pool.failed) return CT_NO_MEMORY(error, "the effect tie");
  for (int32_t i = 0, j = 0; i < a->node_count || j < b->node_count;) {
    const int32_t first = i < a->node_count ? a->nodes[i] : INT32_MAX,
                  second = j < b->node_count ? b->nodes[j] : INT32_MAX;
    tie->nodes[tie->node_count++] = first < second ? first : second;
    i += first <= second, j += second <= first;
  }
  for (int s = 0; s < 2; s++)
    for (int64_t i = 0; i < (int64_t)tie->facets[s].face_count * tie->facets[s].per; i++)
      tie->own[s][i] = ct_lower_bound(tie->nodes, tie->node_count, tie->facets[s].faces[i]);
  return CT_OK;
}

/* Positions of all points of a surface. */
static void place_points(const ct_facets *of, const double *reference, double *x)
{
  for (int32_t f = 0; f < of->face_count; f++) {
    ct_face face;
    ct_facets_face(of, f, reference, NULL, &face);
    for (int q = 0; q < of->rule.count; q++)
      for (int c = 0; c < 3; c++, x++) {
        double terms[8] = {0.0};
        for (int a = 0; a < of->per; a++) terms[a] = of->N[q][a] * face.node[a][c];
        *x = ct_side_sum(of->per, terms);
      }
  }
}

/* Tie the points of surface `s` that are near enough to the places found on the other. */
static void take_points(tie_data *tie, int s, const ct_tie_def *def, const double *reference,
                        const ct_nearest *found)
{
  const ct_facets *of = &tie->facets[s], *other = &tie->facets[1 - s];
  for (int32_t f = 0; f < of->face_count; f++) {
    double area[25][3], J[25];
    ct_face face;
    ct_facets_face(of, f, reference, NULL, &face);
    ct_facets_areas(of, &face, area, J);
    for (int q = 0; q < of->rule.count; q++, found++) {
      if (found->face < 0 || !(found->distance <= def->reach)) continue;
      tie_point *p = &tie->points[tie->point_count++];
      *p = (tie_point){.own = &tie->own[s][(int64_t)f * of->per],
                       .other = &tie->own[1 - s][(int64_t)found->face * other->per],
                       .own_count = of->per,
                       .other_count = other->per,
                       .N = of->N[q]};
      ct_segment_shape(other->kind, found->xi, p->N_bar);
      // -- Half the weight, since both surfaces have points (eq:tie-stiffness)
      p->stiffness = 0.5 * def->epsilon * (of->rule.weight[q] * J[q]);
      tie->farthest = fmax(tie->farthest, found->distance);
    }
  }
}

/* Project the points of surface `s` on the other one, and tie them. */
static ct_status tie_surface(tie_data *tie, int s, const ct_tie_def *def, const ct_problem *problem,
                             ct_error *error)
{
  const ct_facets *of = &tie->facets[s], *other = &tie->facets[1 - s];
  const size_t count = (size_t)of->face_count * (size_t)of->rule.count;
  const ct_surface surface = {other->kind, problem->node_count, other->face_count, other->faces,
                              problem->reference};
  double *x = ct_allocate(count, 3 * sizeof *x);
  ct_nearest *found = ct_allocate(count, sizeof *found);
  ct_search *search = NULL;
  ct_status status =
      x != NULL && found != NULL ? CT_OK : CT_NO_MEMORY(error, "the points of a tie");
  if (status == CT_OK) status = ct_search_create(&surface, &search, error);
  if (status == CT_OK) {
    place_points(of, problem->reference, x);
    status = ct_search_nearest(search, count, x, NULL, NULL, found, error);
  }
  if (status == CT_OK) take_points(tie, s, def, problem->reference, found);
  ct_search_free(search);
  ct_release(found);
  ct_release(x);
  return status;
}

static ct_status prepare(tie_data *tie, const ct_tie_def *def, const ct_problem *problem,
                         ct_error *error)
{
  if (!(def->epsilon > 0.0) || !isfinite(def->epsilon))
    return CT_REFUSE(error, "tie: epsilon must be positive and finite, not %g", def->epsilon);
  if (!(def->reach > 0.0) || !isfinite(def->reach))
    return CT_REFUSE(error, "tie: reach must be positive and finite, not %g", def->reach);
  for (int s = 0; s < 2; s++) {
    ct_status status =
        ct_facets_create(def->kind[s], def->face_count[s], def->faces[s], problem->node_count,
                         problem->reference, "tie", &tie->pool, &tie->facets[s], error);
    if (status != CT_OK) return status;
    tie->all += (int64_t)tie->facets[s].face_count * tie->facets[s].rule.count;
  }
  ct_status status = join_nodes(tie, error);
  tie->points = ct_pool_take(&tie->pool, (size_t)tie->all, sizeof *tie->points);
  if (status == CT_OK && tie->pool.failed) status = CT_NO_MEMORY(error, "the points of a tie");
  for (int s = 0; status == CT_OK && s < 2; s++) status = tie_surface(tie, s, def, problem, error);
  if (status == CT_OK && tie->point_count == 0)
    return CT_REFUSE(error,
                     "tie: no point of either surface is within %g of the other; move the bodies "
                     "together or give a larger reach",
                     def->reach);
  return status;
}

ct_tie_def ct_tie_def_default(void) { return (ct_tie_def){.cookie = CT_DEF_COOKIE}; }

ct_status ct_tie_create_effect(const ct_tie_def *def, const ct_problem *problem, ct_effect **effect,
                               ct_error *error)
{
  ct_status status;
  tie_data *tie = ct_effect_begin(def, problem, effect, "tie", sizeof *tie, &status, error);
  if (tie == NULL) return status;
  status = prepare(tie, def, problem, error);
  const int64_t rows = 3 * tie->point_count;
  ct_effect filled = {.kind = CT_EFFECT_TIE,
                      .phase = CT_PHASE_CONSTRAINT,
                      .label = "tie",
                      .calls = &CALLS,
                      .data = tie,
                      .nodes = tie->nodes,
                      .node_count = tie->node_count,
                      .constraint_nodes = tie->facets[0].per + tie->facets[1].per,
                      .constraint_count = rows,
                      .memory_count = rows,
                      .cost = {.flops = 100.0 * (double)rows, .bytes = 400.0 * (double)rows}};
  return ct_effect_finish(status, &filled, effect, error);
}

ct_status ct_tie_count(const ct_effect *effect, int64_t *tied, int64_t *points, double *farthest,
                       ct_error *error)
{
  if (effect == NULL || tied == NULL || points == NULL || farthest == NULL)
    return CT_REFUSE_NULL(error);
  if (effect->kind != CT_EFFECT_TIE) return CT_REFUSE(error, "effect %s: is no tie", effect->label);
  const tie_data *tie = effect->data;
  *tied = tie->point_count, *points = tie->all, *farthest = tie->farthest;
  return CT_OK;
}
