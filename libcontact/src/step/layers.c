/* Layers of elements between two contacts: bodies of which each node is in one of them. */
#include "layers.h"

#include "../base/list.h"
#include "../base/memory.h"
#include "../base/vector.h"
#include "effect_internal.h"

#include <math.h>

/* Number of a set's nodes below one of the problem. */
static int32_t nodes_below(const ct_row_set *set, int32_t node)
{
  return set->nodes == NULL ? node : ct_lower_bound(set->nodes, set->node_count, node);
}

/* The end of a body's nodes. */
static int32_t end_of(const ct_body *body) { return body->first_node + body->mesh->node_count; }

/* Number of a set's nodes in a body. */
static int32_t nodes_in(const ct_row_set *set, const ct_body *body)
{
  return nodes_below(set, end_of(body)) - nodes_below(set, body->first_node);
}

/* Whether each node of a body is in one of two sets, and none in both. */
static int is_between(const ct_body *body, const ct_row_set *a, const ct_row_set *b)
{
  int32_t i = nodes_below(a, body->first_node), j = nodes_below(b, body->first_node);
  if (nodes_in(a, body) + nodes_in(b, body) != body->mesh->node_count) return 0;
  for (int32_t n = body->first_node; n < end_of(body); n++)
    if (i < a->node_count && a->nodes[i] == n) i++;
    else if (j < b->node_count && b->nodes[j] == n) j++;
    else return 0;
  return 1;
}

/* ρ c₁ of a body. */
static double impedance(const ct_body *body)
{
  double c1, c2;
  ct_material_speeds(&body->material, &c1, &c2);
  return body->material.density * c1;
}

/* Time in which a wave crosses a layer and comes back: twice the mean distance of the middles of
 * the nodes that its elements have in a set and in no set of these, over c₁ (eq:release-passed). */
static double return_time(const ct_body *body, const ct_row_set *set)
{
  const ct_mesh *mesh = body->mesh;
  double c1, c2, sum = 0.0;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double middle[2][3] = {{0.0}};
    int count[2] = {0};
    for (int a = 0; a < 8; a++) {
      const int32_t n = mesh->elements[8 * (size_t)e + (size_t)a], m = body->first_node + n;
      const int side = nodes_below(set, m + 1) > nodes_below(set, m);
      for (int c = 0; c < 3; c++) middle[side][c] += mesh->nodes[3 * (size_t)n + (size_t)c];
      count[side]++;
    }
    double d[3];
    for (int c = 0; c < 3; c++) d[c] = middle[0][c] / count[0] - middle[1][c] / count[1];
    sum += sqrt(ct_vector_dot(d, d));
  }
  ct_material_speeds(&body->material, &c1, &c2);
  // -- t_b = 2 h / c₁ (eq:release-passed)
  return 2.0 * sum / (mesh->element_count * c1);
}

/* Whether a body of a set moves freely at each of its nodes where the set acts on it. */
static int is_free(const ct_problem *problem, const ct_row_set *set, int32_t b)
{
  const ct_body *body = &problem->bodies[b];
  if (ct_problem_is_rigid(problem, b)) return 0;
  for (int32_t i = nodes_below(set, body->first_node), end = nodes_below(set, end_of(body));
       i < end; i++) {
    const size_t n = (size_t)(set->nodes == NULL ? i : set->nodes[i]);
    const double *inverse = &problem->inverse_mass[3 * n];
    if (inverse[0] + inverse[1] + inverse[2] == 0.0) return 0;
  }
  return 1;
}

/* Whether waves pass from body `b` into the other bodies of a set: these are about as heavy and
 * stiff (eq:release-passed). A wall and what is held reflect them. */
static int passes(const ct_problem *problem, const ct_row_set *set, int32_t b)
{
  int others = 0;
  for (int32_t o = 0; o < problem->body_count; o++) {
    if (o == b || nodes_in(set, &problem->bodies[o]) == 0) continue;
    // -- 2/3 <= ρ c₁ / ρ̄ c̄₁ <= 3/2 (eq:release-passed)
    const double part = impedance(&problem->bodies[o]) / impedance(&problem->bodies[b]);
    if (!(fmax(part, 1.0 / part) <= 1.5) || !is_free(problem, set, o)) return 0;
    others++;
  }
  return others > 0;
}

/* Write the layers between two sets, unless `layers` is null; returns their number. */
static int32_t find_layers(const ct_problem *problem, const ct_row_set *sets, int32_t count,
                           int32_t *beside, ct_layer *layers)
{
  int32_t found = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_body *body = &problem->bodies[b];
    int32_t own = 0;
    for (int32_t k = 0; k < count; k++)
      if (sets[k].most > 0 && nodes_in(&sets[k], body) > 0) beside[own++] = k;
    for (int32_t i = 0; i < own && !ct_problem_is_rigid(problem, b); i++)
      for (int32_t j = 0; j < i; j++) {
        const ct_row_set *one = &sets[beside[i]], *two = &sets[beside[j]];
        if (!is_between(body, one, two) || !passes(problem, one, b) || !passes(problem, two, b))
          continue;
        if (layers != NULL)
          layers[found] = (ct_layer){{beside[i], beside[j]}, return_time(body, one)};
        found++;
      }
  }
  return found;
}

/* Room for layers, and for what is told of each set in a step. */
static void take(ct_solver *s, int32_t layers)
{
  const size_t sets = (size_t)s->set_count;
  s->layer_count = layers;
  if (layers == 0) return;
  s->layers = ct_pool_take(&s->pool, (size_t)layers, sizeof *s->layers);
  s->pressed = ct_pool_take(&s->pool, sets, sizeof *s->pressed);
  s->back = ct_pool_take(&s->pool, sets, sizeof *s->back);
}

void ct_layers_find(const ct_problem *problem, const ct_row_set *sets, int32_t count, ct_solver *s)
{
  int32_t *beside = ct_pool_take(&s->pool, (size_t)count, sizeof *beside);
  if (beside == NULL) return;
  take(s, find_layers(problem, sets, count, beside, NULL));
  if (s->layer_count > 0 && !s->pool.failed) find_layers(problem, sets, count, beside, s->layers);
}

ct_status ct_layers_spread(const ct_piece *piece, ct_solver *s, ct_error *error)
{
  const int first = piece->def.number == 0;
  double count = first ? (double)s->layer_count : 0.0;
  ct_status status = ct_piece_collect(piece, &count, 1, error);
  if (status != CT_OK) return status;
  if (!first) take(s, (int32_t)count);
  status = ct_piece_agree(
      piece, s->pool.failed ? CT_NO_MEMORY(error, "layers between contacts") : CT_OK, error);
  for (int32_t i = 0; status == CT_OK && i < s->layer_count; i++) {
    ct_layer *own = &s->layers[i];
    double told[3] = {(double)own->sets[0], (double)own->sets[1], own->back};
    for (int k = 0; !first && k < 3; k++) told[k] = 0.0;
    status = ct_piece_collect(piece, told, 3, error);
    *own = (ct_layer){{(int32_t)told[0], (int32_t)told[1]}, told[2]};
  }
  return status;
}
