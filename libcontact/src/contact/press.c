/* Points of a surface as constraints, whose forces depend on the gaps of the coming step. */
#include "press.h"

#include <libcontact/base.h>

#include "../constraint/law.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* One point: λ b_a n on node a, with b = N on the point's own face and -N̄ on the other
 * (eq:constraint-force). */
static int list_point(const ct_press *p, int64_t i, const double moved[3], ct_constraint *c)
{
  const ct_gauss_point *point = &p->side->points[i];
  const int32_t *faces[2] = {
      &p->side->search->faces[i / p->side->rule.count * p->side->search->per], NULL};
  if (!(point->gap <= p->reach) || !ct_side_direction(p->side, point, c->normal)) return 0;
  c->enforcement = p->enforcement;
  c->dissipation = p->dissipation;
  c->stiffness = p->epsilon * p->side->weight[i];
  c->point = p->first + i;
  c->own = p->side->search->per;
  c->other = p->other != NULL ? p->other->search->per : 0;
  if (p->other != NULL) faces[1] = &p->other->search->faces[(int64_t)point->other * c->other];
  for (int32_t a = 0; a < c->own; a++) {
    c->node[a] = p->renumber ? p->side->search->nodes[faces[0][a]] : faces[0][a];
    c->b[a] = p->side->N[i % p->side->rule.count][a];
  }
  for (int32_t a = 0; a < c->other; a++) {
    c->node[8 + a] = p->renumber ? p->other->search->nodes[faces[1][a]] : faces[1][a];
    c->b[8 + a] = -point->N[a];
  }
  c->gap = point->gap;
  c->moved = -ct_vector_dot(c->normal, moved) - point->closing;
  c->force = p->last[(int64_t)p->stride * i];
  return 1;
}

int64_t ct_press_list(const ct_press *press, const double moved[3], ct_constraint *list)
{
  int64_t count = 0;
  for (int64_t i = 0; i < ct_side_point_count(press->side); i++)
    if (press->other == NULL || press->side->points[i].other >= 0)
      count += list_point(press, i, moved, &list[count]);
  return count;
}

void ct_press_apply(ct_side *side, int64_t first, const ct_constraint *list, int64_t count)
{
  int64_t points = ct_side_point_count(side);
  for (int64_t i = 0; i < points; i++)
    memset(side->points[i].force, 0, sizeof side->points[i].force);
  for (int64_t j = 0; j < count; j++) {
    int64_t i = list[j].point - first;
    if (i < 0 || i >= points) continue;
    for (int c = 0; c < 3; c++) side->points[i].force[c] = list[j].force * list[j].normal[c];
  }
}

void ct_press_remember(const ct_constraint *list, int64_t count, int64_t points, double *memory,
                       int stride)
{
  for (int64_t i = 0; i < points; i++) memory[stride * i] = 0.0;
  for (int64_t j = 0; j < count; j++) memory[stride * list[j].point] = list[j].force;
}

/* Σ of one part of the energy over all constraints. */
static double sum_energy(const ct_constraint *list, int64_t count,
                         double (*part)(const ct_constraint *c), double *terms)
{
  int64_t some = 0;
  for (int64_t j = 0; j < count; j++) {
    terms[some] = part(&list[j]);
    some += terms[some] != 0.0;
  }
  return ct_sum(terms, some);
}

double ct_press_energy(const ct_constraint *list, int64_t count, double time, double before,
                       double *after, double *terms)
{
  *after = sum_energy(list, count, ct_law_stored, terms);
  if (time == 0.0) return sum_energy(list, count, ct_law_start, terms);
  // -- What was stored in the step before belongs to the partners of then, so it is not computed
  // again (eq:controlled-energy)
  return 0.5 * (before + *after) + sum_energy(list, count, ct_law_lag, terms);
}
