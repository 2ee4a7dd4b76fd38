/* The list of the rows of the tangential forces. */
#include "tangent_rows.h"

#include "../base/lanes.h"
#include "../base/vector.h"
#include "bodies.h"
#include "law.h"
#include "matrix.h"
#include "tangent_matrix.h"

#include <math.h>
#include <string.h>

enum { WIDE = CT_SOLVER_WIDE };

/* Count the rows at each node and list the nodes on which any acts. */
static void count_nodes(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  double most = 0.0;
  for (const ct_tangent_group *g = t->groups; g < t->groups + t->group_count; g++)
    for (int32_t a = 0; a < g->own + g->other; a++) t->sums[g->place[a] + 3] += g->rows;
  ct_tangent_join(s, 3, 1);
  t->node_count = 0;
  for (int32_t n = 0; n < s->node_count; n++) {
    double *count = &t->sums[WIDE * (int64_t)n + 3];
    if (*count > 0.0) t->nodes[t->node_count++] = WIDE * n;
    most = *count > most ? *count : most;
    *count = 0.0;
  }
  t->most_row_count = (int32_t)most;
}

/* List the nodes of the rows, and the largest number of rows at one. */
static void list_nodes(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  ct_tangent_clear(t);
  for (int32_t k = 0; k < t->node_count; k++)
    for (int c = 0; c < WIDE; c++) t->moved[t->nodes[k] + c] = 0.0;
  if (!t->active) {
    count_nodes(s);
    return;
  }
  t->most_row_count = s->most_row_count;
  t->node_count = s->active_node_count;
  memcpy(t->nodes, s->active_nodes, (size_t)t->node_count * sizeof *t->nodes);
}

/* Whether the mobility of a node keeps the direction n. */
CT_INLINE int keeps(const double *A, const double n[3])
{
  const double along = (n[0] * n[0] * A[0] + n[1] * n[1] * A[1]) + n[2] * n[2] * A[2];
  for (int c = 0; c < 3; c++)
    if (n[c] != 0.0 && A[c] != along) return 0;
  return 1;
}

/* Whether tangential forces may change the gaps of active rows, and normal forces the motion in the
 * plane of contact: not if all have one normal, of obstacles, which each mobility keeps. */
static int are_coupled(const ct_solver *s)
{
  const ct_tangent *t = s->tangent;
  if (!s->along || s->bodies != NULL) return 1;
  for (const ct_tangent_group *g = t->groups; g < t->groups + t->group_count; g++)
    if (g->other > 0) return 1;
  for (int32_t k = 0; k < s->active_node_count; k++)
    if (!keeps(&s->mobility[s->active_nodes[k]], s->normal)) return 1;
  return 0;
}

/* Whether a row without a law has friction of its given force. */
static int is_given(const ct_constraint *c)
{
  return c->force > 0.0 && !ct_law_has_rows(c->enforcement);
}

/* The next active row, the number of listed ones, and whether these differ. */
typedef struct listing {
  int64_t active, count;
  int differ;
} listing;

/* List the rows of a group, of which all are active or perhaps not. */
CT_INLINE void list_group(int all, const ct_solver *s, ct_constraint *const *row, int32_t rows,
                          listing *of)
{
  ct_constraint *const *active = s->active, **list = s->tangent->rows;
  const int64_t count = s->point_count;
  listing l = *of;
  for (int32_t r = 0; r < rows; r++) {
    ct_constraint *c = row[r];
    const int is_active = all || (l.active < count && active[l.active] == c),
              rubs = c->slip != NULL && (is_active || is_given(c));
    l.active += is_active;
    l.differ |= rubs != is_active;
    if (rubs) list[l.count++] = c;
    else if (c->slip != NULL) ct_slip_open(c->slip);
  }
  *of = l;
}

/* List the rows, in groups with the same nodes. Returns whether they are not the active ones. */
static int list_rows(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const ct_group *g = s->every;
  ct_tangent_group *own = t->groups;
  listing of = {0};
  for (int32_t k = 0; k < s->set_count; k++)
    for (int64_t r = s->first[k]; r < s->first[k + 1]; r += g->rows, g++) {
      const int64_t first = of.count;
      if (s->every == s->groups) list_group(1, s, &s->rows[r], g->rows, &of);
      else list_group(0, s, &s->rows[r], g->rows, &of);
      if (of.count == first) continue;
      t->rows[first]->slip->of->place = &s->place[s->first_node[k]];
      *own++ = (ct_tangent_group){
          first, &s->entry_place[g->place], (int32_t)(of.count - first), g->own, g->other, 0, 1};
    }
  t->count = of.count;
  t->group_count = own - t->groups;
  return of.differ;
}

int64_t ct_tangent_run(const ct_tangent *t, int64_t j)
{
  const ct_slip *first = t->rows[j]->slip;
  int64_t count = t->one_run ? t->count - j : 1;
  while (j + count < t->count && t->rows[j + count]->slip->of == first->of &&
         t->rows[j + count]->slip->at == first->at + count)
    count++;
  return count;
}

/* Find where the numbers of the points are: the iteration changes T, and points that open from e_n
 * to `stuck`; the others are those of the points themselves if these stand side by side. */
static void place_numbers(ct_tangent *t, int opens)
{
  const int first = opens ? CT_SLIP_E : CT_SLIP_FORCE,
            end = opens ? CT_SLIP_IMAGE : CT_SLIP_RESERVE;
  const int64_t last = t->count - 1;
  // The rows of one ct_slips follow on each other, in the order of its points.
  t->one_run = last >= 0 && t->rows[last]->slip->of == t->rows[0]->slip->of &&
               t->rows[last]->slip->at - t->rows[0]->slip->at == last;
  for (int i = 0; i < CT_SLIP_GIVEN; i++) {
    const int shared = t->one_run && (i < first || i >= end);
    t->given[i] = shared ? ct_slip_number(t->rows[0]->slip, i) : t->own[i];
  }
  ct_columns *const vectors[] = {&t->normal, &t->e, &t->e0, &t->T, &t->was_image};
  static const int FIRST[] = {CT_SLIP_NORMAL, CT_SLIP_E, CT_SLIP_BEFORE, CT_SLIP_FORCE,
                              CT_SLIP_IMAGE};
  for (int v = 0; v < 5; v++) memcpy(vectors[v]->x, &t->given[FIRST[v]], sizeof vectors[v]->x);
  t->k = t->given[CT_SLIP_K], t->was_opened = t->given[CT_SLIP_OPENED];
  t->reserve = t->given[CT_SLIP_RESERVE], t->stuck = t->given[CT_SLIP_STUCK];
}

/* Read the numbers of the points of all rows. */
CT_CLONES
static void read_points(ct_tangent *t)
{
  for (int64_t j = 0, count; j < t->count; j += count) {
    const ct_slip *first = t->rows[j]->slip;
    count = ct_tangent_run(t, j);
    t->some_move |= first->of->moves;
    for (int i = 0; i < CT_SLIP_GIVEN; i++) {
      const double *from = ct_slip_number(first, i);
      double *to = &t->given[i][j];
      if (to == from) continue;
#pragma omp simd
      for (int64_t n = 0; n < count; n++) to[n] = from[n];
    }
    const double mu = first->of->mu;
    for (int64_t n = 0; n < count; n++) t->mu[j + n] = mu;
  }
}

/* Remove the normal parts of the forces. Returns the largest component. */
CT_CLONES
static double make_tangential(const ct_tangent *t)
{
  const double *n0 = t->normal.x[0], *n1 = t->normal.x[1], *n2 = t->normal.x[2];
  double *x = t->T.x[0], *y = t->T.x[1], *z = t->T.x[2], top = 0.0;
#pragma omp simd reduction(max : top)
  for (int64_t j = 0; j < t->count; j++) {
    const double along = (n0[j] * x[j] + n1[j] * y[j]) + n2[j] * z[j];
    x[j] -= along * n0[j], y[j] -= along * n1[j], z[j] -= along * n2[j];
    top = ct_larger(ct_larger(ct_larger(fabs(x[j]), fabs(y[j])), fabs(z[j])), top);
  }
  return top;
}

void ct_tangent_take_off(const ct_tangent *t, int next, const ct_columns *motion)
{
  for (int64_t j = 0; j < t->count && t->some_move; j++) {
    const ct_slips *of = t->rows[j]->slip->of;
    const double *way = next ? of->coming : of->came;
    double D[3];
    if (!of->moves) continue;
    ct_columns_get(motion, j, D);
    for (int i = 0; i < 3; i++) D[i] -= way[i];
    ct_vector_make_tangential(t->rows[j]->normal, D);
    ct_columns_set(motion, j, D);
  }
}

void ct_tangent_find_last(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  for (int c = 0; c < 3 && s->starts; c++)
    memset(t->last.x[c], 0, (size_t)t->count * sizeof(double));
  if (!s->starts) ct_tangent_motion(t, s->last_increment, &t->last);
  ct_tangent_take_off(t, 0, &t->last);
}

void ct_tangent_list(ct_solver *s)
{
  ct_tangent *t = s->tangent;
  const int differ = list_rows(s);
  t->some_move = 0;
  place_numbers(t, s->count > s->point_count);
  read_points(t);
  double facts[] = {t->count > 0, are_coupled(s), s->starts ? make_tangential(t) : 0.0, differ};
  ct_pieces_largest(s->pieces, facts, 4);
  t->some = facts[0] > 0.0, t->coupled = facts[1] > 0.0, t->most_force = facts[2];
  t->active = facts[3] == 0.0;
  if (!t->some) return;
  t->couple = ct_tangent_fill(t);
  list_nodes(s);
}
