/* A piece of a state: which nodes and elements it has, and what it exchanges with the others. */
#include "piece.h"

#include "../base/bits.h"
#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/list.h"
#include "effect_internal.h"
#include "workspace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ct_piece_def ct_piece_def_default(void) { return (ct_piece_def){.cookie = CT_DEF_COOKIE}; }

static ct_status no_exchange(ct_error *error)
{
  return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                 "the pieces could not exchange their numbers");
}

static int count_sum(void *data, double *values, int64_t count)
{
  ct_piece *piece = data;
  piece->counts.joins++;
  piece->counts.joined += count;
  return piece->def.join.sum(piece->def.join.data, values, count);
}

static int count_largest(void *data, double *values, int64_t count)
{
  ct_piece *piece = data;
  piece->counts.joins++;
  piece->counts.joined += count;
  return piece->def.join.largest(piece->def.join.data, values, count);
}

ct_status ct_piece_agree(const ct_piece *piece, ct_status own, ct_error *error)
{
  int64_t none = 0;
  return ct_piece_agree_on(piece, own, &none, error);
}

ct_status ct_piece_agree_on(const ct_piece *piece, ct_status own, int64_t *count, ct_error *error)
{
  return piece == NULL ? own : ct_pieces_agree(&piece->join, own, count, error);
}

ct_status ct_pieces_agree(const ct_pieces *join, ct_status own, int64_t *count, ct_error *error)
{
  double both[2] = {(double)own, (double)*count};
  ct_pieces_largest(join, both, 2);
  const double worst = both[0];
  *count = (int64_t)both[1];
  if (worst == 0.0) return CT_OK;
  if (!(worst > 0.0)) return no_exchange(error);
  if (own != CT_OK && error != NULL) error->code = (ct_status)worst;
  if (own != CT_OK) return (ct_status)worst;
  return ct_fail(error, (ct_status)worst, CT_NOWHERE, "the step failed in another piece");
}

ct_status ct_piece_refuse(const ct_state *state, ct_error *error)
{
  if (state->workspace == NULL || state->workspace->piece == NULL) return CT_OK;
  return CT_REFUSE(error, "the state is a piece; ct_state_collect gives the whole one");
}

ct_status ct_piece_local(const ct_effect *effect, const struct ct_piece *piece, void *scratch,
                         ct_error *error)
{
  (void)effect, (void)piece, (void)scratch, (void)error;
  return CT_OK;
}

/* The number of elements of all bodies. */
static int64_t element_count(const ct_problem *problem)
{
  int64_t count = 0;
  for (int32_t b = 0; b < problem->body_count; b++) count += problem->bodies[b].mesh->element_count;
  return count;
}

/* The nodes of an element in the numbers of its body; returns their number. */
static int nodes_of(const ct_mesh *mesh, int32_t e, const int32_t **nodes)
{
  const int per = ct_brick_node_count(mesh->kind);
  *nodes = &mesh->elements[(int64_t)per * e];
  return per;
}

ct_status ct_piece_check(const ct_piece_def *def, ct_error *error)
{
  if (def == NULL || def->cookie != CT_DEF_COOKIE || def->owners == NULL || def->join.sum == NULL ||
      def->join.largest == NULL || def->exchange == NULL ||
      (def->common == NULL && def->common_count != 0))
    return CT_REFUSE(error, "piece: an argument is null, or the definition lacks its default");
  return CT_OK;
}

/* A part of the whole problem, whose first piece has no part. */
static ct_status check_part(const ct_problem *problem, const ct_piece_def *def, ct_error *error)
{
  const ct_piece_part *part = def->part;
  if (part->nodes == NULL || part->owners == NULL || def->number == 0)
    return CT_REFUSE(error, "piece: a part needs its nodes and their owners, and the first piece "
                            "has the whole problem");
  for (int32_t n = 0; n < problem->node_count; n++)
    if (part->nodes[n] <= (n == 0 ? -1 : part->nodes[n - 1]) ||
        part->nodes[n] >= part->node_count || part->owners[n] < 0 || part->owners[n] >= def->count)
      return CT_REFUSE(error,
                       "piece: node %d of a part is node %d of %d, of piece %d; nodes must ascend, "
                       "and there are %d pieces",
                       (int)n, (int)part->nodes[n], (int)part->node_count, (int)part->owners[n],
                       (int)def->count);
  return CT_OK;
}

static ct_status check_def(const ct_problem *problem, const ct_piece_def *def, ct_error *error)
{
  if (def->count < 1 || def->number < 0 || def->number >= def->count)
    return CT_REFUSE(error, "piece: there is no piece %d of %d", (int)def->number, (int)def->count);
  for (int64_t e = 0; e < element_count(problem); e++)
    if (def->owners[e] < 0 || def->owners[e] >= def->count)
      return CT_REFUSE(error, "piece: element %lld belongs to piece %d; there are %d", (long long)e,
                       (int)def->owners[e], (int)def->count);
  for (int32_t i = 0; i < def->common_count; i++)
    if (def->common[i] < 0 || def->common[i] >= problem->node_count)
      return CT_REFUSE(error, "piece: there is no node %d", (int)def->common[i]);
  return def->part == NULL ? CT_OK : check_part(problem, def, error);
}

ct_status ct_piece_check_same(const ct_piece *piece, const ct_piece_def *def, ct_error *error)
{
  uint32_t hash = 2166136261u; // FNV-1a
  for (int64_t e = 0; e < element_count(piece->problem); e++)
    hash = (hash ^ (uint32_t)def->owners[e]) * 16777619u;
  for (int32_t i = 0; i < def->common_count; i++)
    hash = (hash ^ (uint32_t)def->common[i]) * 16777619u;
  double both[2] = {(double)hash, -(double)hash};
  ct_pieces_largest(&piece->join, both, 2);
  if (both[0] == -both[1]) return CT_OK;
  return isfinite(both[0]) ? CT_REFUSE(error, "piece: the processes have cut the model differently")
                           : no_exchange(error);
}

/* The piece of each node, the lowest of those of its elements. */
static void find_owners(ct_piece *piece, const int32_t *owners)
{
  const ct_problem *problem = piece->problem;
  for (int32_t n = 0; n < problem->node_count; n++) piece->owner[n] = piece->def.count - 1;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_mesh *mesh = problem->bodies[b].mesh;
    int32_t *owner = &piece->owner[problem->bodies[b].first_node];
    for (int32_t e = 0; e < mesh->element_count; e++, owners++) {
      const int32_t *nodes;
      // -- The lowest of the pieces of its elements (eq:piece-owner)
      for (int a = nodes_of(mesh, e, &nodes) - 1; a >= 0; a--)
        if (*owners < owner[nodes[a]]) owner[nodes[a]] = *owners;
    }
  }
}

/* A list of nodes to send or to receive, each as peer times the number of nodes plus node. */
typedef struct pairs {
  int64_t count, *list;
} pairs;

static void add_pair(const ct_piece *piece, pairs *to, int32_t peer, int32_t node)
{
  if (to->list != NULL) to->list[to->count] = (int64_t)peer * piece->problem->node_count + node;
  to->count++;
}

/* Node `n` is needed by a piece. */
static void need(const ct_piece *piece, int32_t n, int32_t by, pairs lists[2])
{
  const int32_t own = piece->def.number, from = piece->owner[n];
  if (from == by) return;
  if (from == own) add_pair(piece, &lists[0], by, n);
  if (by == own) add_pair(piece, &lists[1], from, n);
}

/* The pieces that compute an element, those of its nodes, need all of its nodes. */
static void need_element(const ct_piece *piece, int per, const int32_t *nodes, int32_t first,
                         pairs lists[2])
{
  for (int a = 0; a < per; a++) {
    const int32_t by = piece->owner[first + nodes[a]];
    for (int k = 0; k < per; k++) need(piece, first + nodes[k], by, lists);
  }
}

/* List the nodes to send and to receive; with null lists only count them. */
static void list_pairs(const ct_piece *piece, const uint64_t *common, pairs lists[2])
{
  const ct_problem *problem = piece->problem;
  lists[0].count = lists[1].count = 0;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_body *body = &problem->bodies[b];
    for (int32_t e = 0; e < body->mesh->element_count; e++) {
      const int32_t *nodes;
      const int per = nodes_of(body->mesh, e, &nodes);
      if (piece->mine[b][e] != 0) need_element(piece, per, nodes, body->first_node, lists);
    }
  }
  const int32_t end = problem->node_count;
  for (int32_t n = ct_bits_next(common, 0, end, 1); n < end;
       n = ct_bits_next(common, n + 1, end, 1))
    for (int32_t by = 0; by < piece->def.count; by++) need(piece, n, by, lists);
}

static int compare(const void *a, const void *b)
{
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

/* Sort one list and count its different pairs for each peer. */
static int32_t *take_list(ct_piece *piece, pairs *of, int32_t *counts, int64_t *nodes)
{
  const int64_t all = piece->problem->node_count;
  int64_t kept = 0;
  qsort(of->list, (size_t)of->count, sizeof *of->list, compare);
  for (int64_t i = 0; i < of->count; i++)
    if (i == 0 || of->list[i] != of->list[i - 1]) of->list[kept++] = of->list[i];
  int32_t *out = ct_pool_take(&piece->pool, (size_t)kept, sizeof *out);
  for (int64_t i = 0; out != NULL && i < kept; i++) {
    out[i] = (int32_t)(of->list[i] % all);
    counts[of->list[i] / all] += 3;
  }
  *nodes = kept;
  return out;
}

static void make_lists(ct_piece *piece, const uint64_t *common)
{
  pairs lists[2] = {{0, NULL}, {0, NULL}};
  list_pairs(piece, common, lists);
  for (int i = 0; i < 2; i++)
    lists[i].list = ct_allocate((size_t)lists[i].count, sizeof *lists[i].list);
  piece->pool.failed |= lists[0].list == NULL || lists[1].list == NULL;
  if (!piece->pool.failed) {
    list_pairs(piece, common, lists);
    piece->sent = take_list(piece, &lists[0], piece->send_count, &piece->counts.sent);
    piece->received = take_list(piece, &lists[1], piece->receive_count, &piece->counts.received);
    piece->send = ct_pool_take(&piece->pool, 3 * (size_t)piece->counts.sent, sizeof(double));
    piece->receive = ct_pool_take(&piece->pool, 3 * (size_t)piece->counts.received, sizeof(double));
  }
  for (int32_t p = 0; p < piece->def.count; p++)
    piece->counts.neighbours += piece->send_count[p] != 0;
  ct_release(lists[0].list);
  ct_release(lists[1].list);
}

/* The elements around own nodes, and their nodes. */
static void find_elements(ct_piece *piece, const int32_t *owners, uint8_t *mine)
{
  const ct_problem *problem = piece->problem;
  for (int32_t b = 0; b < problem->body_count; b++) {
    const ct_mesh *mesh = problem->bodies[b].mesh;
    const int32_t first = problem->bodies[b].first_node;
    piece->mine[b] = mine;
    for (int32_t e = 0; e < mesh->element_count; e++, mine++, owners++) {
      const int32_t *nodes;
      const int per = nodes_of(mesh, e, &nodes);
      for (int a = 0; *mine == 0 && a < per; a++)
        if (ct_piece_owns(piece, first + nodes[a])) *mine = *owners == piece->def.number ? 1 : 2;
      for (int a = 0; *mine != 0 && a < per; a++)
        ct_bits_put(piece->touched, first + nodes[a], first + nodes[a] + 1, 1);
      piece->counts.elements += *mine != 0;
      piece->counts.own_elements += *mine == 1;
    }
  }
  for (int32_t n = 0; n < problem->node_count; n++) piece->counts.nodes += ct_piece_owns(piece, n);
}

/* The nodes that all pieces need: those given, and those of contacts and obstacles. */
static void mark_common(const ct_piece *piece, const ct_piece_def *def, uint64_t *common)
{
  const ct_problem *problem = piece->problem;
  for (int32_t i = 0; i < def->common_count; i++)
    ct_bits_put(common, def->common[i], def->common[i] + 1, 1);
  for (int32_t k = 1; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    for (int32_t i = 0; effect->calls->pieces.common && i < effect->node_count; i++) {
      const int32_t node = ct_effect_node(effect, i);
      ct_bits_put(common, node, node + 1, 1);
    }
  }
}

/* The planes that divide the points of all contacts, obstacles and ties: by the places of their
 * nodes, so that faces that meet belong to one piece. */
static void divide_points(ct_piece *piece)
{
  const ct_problem *problem = piece->problem;
  int64_t count = 0;
  for (int32_t k = 0; k < problem->effect_count; k++)
    if (ct_effect_touches(problem->effects[k])) count += problem->effects[k]->node_count;
  double *places = ct_allocate((size_t)count, 3 * sizeof *places), *next = places;
  piece->planes = ct_pool_take(&piece->pool, (size_t)piece->def.count, sizeof *piece->planes);
  for (int32_t k = 0; places != NULL && k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    for (int32_t i = 0; ct_effect_touches(effect) && i < effect->node_count; i++, next += 3)
      memcpy(next, &problem->reference[3 * (int64_t)ct_effect_node(effect, i)], 3 * sizeof *next);
  }
  piece->pool.failed |= places == NULL || piece->pool.failed ||
                        ct_piece_divide(count, places, piece->def.count, piece->planes) != CT_OK;
  ct_release(places);
}

/* Space for the numbers of the nodes in the whole problem, those of effects to be asked for. */
static void take_numbers(ct_piece *piece, const ct_piece_part *part)
{
  const ct_problem *problem = piece->problem;
  const size_t effects = (size_t)problem->effect_count, nodes = (size_t)problem->node_count;
  piece->nodes = (ct_piece_numbers){.whole = problem->node_count, .count = problem->node_count};
  piece->effects = ct_pool_take(&piece->pool, effects, sizeof *piece->effects);
  if (part != NULL) {
    piece->nodes.whole = part->node_count;
    piece->nodes.at = ct_pool_copy(&piece->pool, part->nodes, nodes * sizeof *part->nodes);
  }
  for (size_t k = 0; piece->effects != NULL && k < effects; k++) {
    const ct_effect *effect = problem->effects[k];
    ct_piece_numbers *numbers = &piece->effects[k];
    *numbers = effect->nodes == NULL
                   ? piece->nodes
                   : (ct_piece_numbers){.whole = effect->node_count, .count = effect->node_count};
    if (part != NULL && effect->nodes != NULL)
      numbers->at = ct_pool_take(&piece->pool, (size_t)effect->node_count, sizeof *numbers->at);
  }
}

static void fill(ct_piece *piece, const ct_piece_def *def)
{
  const ct_problem *problem = piece->problem;
  ct_pool *pool = &piece->pool;
  const size_t nodes = (size_t)problem->node_count, pieces = (size_t)def->count,
               words = (size_t)ct_bits_words(problem->node_count);
  uint8_t *mine = ct_pool_take(pool, (size_t)element_count(problem), 1);
  uint64_t *common = ct_pool_take(pool, words, sizeof *common);
  piece->owner = ct_pool_take(pool, nodes, sizeof *piece->owner);
  piece->mine = ct_pool_take(pool, (size_t)problem->body_count, sizeof *piece->mine);
  piece->touched = ct_pool_take(pool, words, sizeof *piece->touched);
  piece->held = ct_pool_take(pool, words, sizeof *piece->held);
  piece->send_count = ct_pool_take(pool, pieces, sizeof *piece->send_count);
  piece->receive_count = ct_pool_take(pool, pieces, sizeof *piece->receive_count);
  take_numbers(piece, def->part);
  piece->passed = ct_pool_take(pool, CT_COLLECTED, sizeof *piece->passed);
  piece->halves = ct_pool_take(pool, CT_COLLECTED, 2 * sizeof *piece->halves);
  if (pool->failed) return;
  if (def->part == NULL) find_owners(piece, def->owners);
  else memcpy(piece->owner, def->part->owners, nodes * sizeof *piece->owner);
  find_elements(piece, def->owners, mine);
  mark_common(piece, def, common);
  for (size_t i = 0; i < words; i++) piece->held[i] = piece->touched[i] | common[i];
  make_lists(piece, common);
  divide_points(piece);
}

ct_status ct_piece_create(const ct_problem *problem, const ct_piece_def *def, ct_piece **out,
                          ct_error *error)
{
  ct_piece *piece = ct_allocate(1, sizeof *piece);
  if (piece == NULL) return CT_NO_MEMORY(error, "a piece");
  piece->problem = problem;
  piece->def = *def;
  piece->join = (ct_pieces){piece, count_sum, count_largest};
  piece->def.owners = piece->def.common = NULL;
  piece->def.part = NULL;
  ct_status status = check_def(problem, def, error);
  if (status == CT_OK) fill(piece, def);
  if (piece->pool.failed) status = CT_NO_MEMORY(error, "a piece");
  if (status == CT_OK) *out = piece;
  else ct_pool_free(piece);
  return status;
}

/* Copy the rows of `values` of the nodes for all peers to a list, or back; a peer has so many
 * numbers. Nodes with consecutive numbers are copied together. */
CT_CLONES_NODES
static void pass_rows(int32_t peers, const int32_t *counts, const int32_t *nodes, int back,
                      double *restrict values, double *restrict list)
{
  for (int32_t p = 0; p < peers; p++)
    for (int32_t left = counts[p] / 3, row; left > 0; left -= row, nodes += row) {
      double *restrict at = &values[3 * (int64_t)nodes[0]];
      row = ct_row_length(nodes, left);
#pragma omp simd
      for (int64_t d = 0; d < 3 * (int64_t)row; d++)
        if (back) at[d] = list[d];
        else list[d] = at[d];
      list += 3 * (int64_t)row;
    }
}

ct_status ct_piece_share(ct_piece *piece, double *values, ct_error *error)
{
  pass_rows(piece->def.count, piece->send_count, piece->sent, 0, values, piece->send);
  piece->counts.exchanges++;
  if (piece->def.exchange(piece->def.join.data, piece->send, piece->send_count, piece->receive,
                          piece->receive_count) != 0)
    return no_exchange(error);
  pass_rows(piece->def.count, piece->receive_count, piece->received, 1, values, piece->receive);
  return CT_OK;
}

ct_status ct_piece_collect(const ct_piece *piece, double *values, int64_t count, ct_error *error)
{
  double *half = piece->halves;
  ct_status status = CT_OK;
  for (int64_t first = 0, some; status == CT_OK && first < count; first += some) {
    some = count - first < CT_COLLECTED ? count - first : CT_COLLECTED;
    // -- Bits as two whole numbers, 0 in all pieces but one
    for (int64_t i = 0; i < some; i++) {
      uint64_t bits;
      memcpy(&bits, &values[first + i], sizeof bits);
      half[2 * i] = (double)(bits >> 32);
      half[2 * i + 1] = (double)(bits & 0xffffffffu);
    }
    ct_pieces_sum(&piece->join, half, 2 * some);
    if (!isfinite(half[0])) status = no_exchange(error);
    for (int64_t i = 0; status == CT_OK && i < some; i++) {
      const uint64_t bits = (uint64_t)half[2 * i] << 32 | (uint64_t)half[2 * i + 1];
      memcpy(&values[first + i], &bits, sizeof bits);
    }
  }
  return status;
}
