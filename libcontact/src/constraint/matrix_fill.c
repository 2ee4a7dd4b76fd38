/* The matrix G of the constraint problem, filled from the listed rows. */
#include "bodies.h"
#include "law_rows.h"
#include "matrix.h"
#include "products.h"

#include "../base/lanes.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Rows that are read at a time: they stay in a cache. */
enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS, ROWS = 64 };

/* The lanes of the bits of a quad. */
#if defined(__GNUC__)
#define LANE(bits, l) (bits)[l]
#else
#define LANE(bits, l) (bits)
#endif

/* Places of the nodes of a face in vectors at nodes. */
CT_INLINE void find_places(int32_t count, const int32_t *node, const int32_t *number,
                           int32_t *restrict place)
{
  for (int32_t a = 0; a < count; a++) place[a] = WIDE * number[node[a]];
}

/* Numbers b_a of the nodes of one face; lanes without a node are 0. */
CT_INLINE void fill_face(int32_t count, double sign, const double *N, double *b)
{
  const int32_t whole = count < 4 ? 0 : 4;
  // -- b_a = N_a on the own face, -N̄_a on the other (eq:constraint-force)
  for (int i = 0; whole > 0 && i < PARTS; i++) ((ct_quad *)b)[i] = sign * ((const ct_quad *)N)[i];
  for (int32_t l = whole; l < 4 * ct_quads_of(count); l++)
    b[l] = CT_LANE_NODE[l] < count ? sign * N[CT_LANE_NODE[l]] : 0.0;
}

/* The normal of a row; the number behind it, the gap, has no meaning in G. */
CT_INLINE const ct_quad *normal_of(const ct_constraint *c)
{
  return (const ct_quad *)(const void *)((const char *)c + offsetof(ct_constraint, normal));
}

/* What differs between the groups: bits of normals from that of the first row of all; and the nodes
 * and points of a group, or where they begin, from those of the last step. */
typedef struct changes {
  ct_quad_bits normal;
  int nodes, begin;
} changes;

/* Numbers of one row, and what differs; `again`: those of the own face are there already. */
CT_INLINE void fill_row(const ct_solver *s, int again, int32_t own, int32_t other,
                        const ct_constraint *c, double *row, changes *d)
{
  const ct_quad *head = (const ct_quad *)s->G;
  for (int i = 0; i < PARTS; i++) ((ct_quad *)row)[i] = normal_of(c)[i];
  for (int i = 0; i < PARTS && i < 3; i++) d->normal |= ((const ct_quad *)row)[i] != head[i];
  if (!again) fill_face(own, 1.0, c->own_shape, row + 4);
  fill_face(other, -1.0, c->other_shape, row + 4 + 4 * ct_quads_of(own));
}

/* The numbers of four rows with some quads of nodes side by side, behind them; `again` as above. */
CT_INLINE void turn_rows(int again, int32_t quads, double *G)
{
  const int32_t step = 4 * (1 + quads);
  for (int32_t q = 0; q < 1 + quads; q += again ? 2 : 1) {
    const double *from[4];
    double *to[4];
    for (int r = 0; r < 4; r++) from[r] = G + r * step + 4 * q, to[r] = G + 4 * (step + 4 * q + r);
    ct_turn(from, to);
  }
}

/* Whether four rows at an obstacle have the normals and weights of the four rows before them, which
 * are a group: all faces at a plane share one block of G, which stays in a cache. */
CT_INLINE int repeats(const ct_group *before, ct_constraint *const *row)
{
  int same = before->own == 4 && before->other == 0 && before->rows == 4;
  for (int r = 0; r < 4 && same; r++)
    same = row[r]->own_shape == row[r - 4]->own_shape &&
           memcmp(row[r]->normal, row[r - 4]->normal, sizeof row[r]->normal) == 0;
  return same;
}

/* Fill one group, at most some rows with the nodes of the first, and with its numbers of nodes; and
 * begin the next one. */
CT_INLINE void fill_group(const ct_solver *s, const int32_t *number, ct_constraint *const *row,
                          int64_t most, int32_t own, int32_t other, ct_group *g, changes *d)
{
  const int64_t step = 4 * (1 + ct_quads_of(own) + ct_quads_of(other));
  const int32_t *mine = row[0]->own, *theirs = row[0]->other;
  double *G = &s->G[g->first];
  int32_t rows = 0, *place = &s->entry_place[g->place];
  do {
    fill_row(s, 0, own, other, row[rows], G, d);
    G += step, rows++;
  } while (rows < most && row[rows]->own == mine && row[rows]->other == theirs &&
           row[rows]->own_count == own && row[rows]->other_count == other);
  const int face = own == 4 && rows == 4 && ct_rows_are_square(row);
  if (d->begin || g->nodes != mine || g->others != theirs || g->own != own || g->other != other ||
      g->rows != rows || g->face != face) {
    d->nodes = 1;
    g->nodes = mine, g->others = theirs;
    g->own = (int8_t)own, g->other = (int8_t)other, g->rows = rows, g->face = (int16_t)face;
    find_places(own, mine, number, place);
    find_places(other, theirs, number, place + own);
  }
  const int turned = face && (other == 4 || other == 0),
            again = g > s->groups && own == 4 && other == 0 && rows == 4 && repeats(g - 1, row);
  const int64_t next = again ? g->first : g->first + (turned ? 2 : 1) * rows * step;
  if (again) g->first = g[-1].first;
  else if (turned) turn_rows(0, 1 + other / 4, &s->G[g->first]);
  d->begin |= g[1].first != next || g[1].place != g->place + own + other;
  g[1].first = next;
  g[1].place = g->place + own + other;
}

/* The largest weight of a node in a row, or 1: only an obstacle that a rigid body carries may touch
 * far from the nodes of its rows. */
static double largest_weight(const ct_solver *s)
{
  double weight = 1.0;
  for (int64_t r = 0; s->bodies != NULL && r < s->first[s->set_count]; r++)
    for (int32_t b = 0; b < s->rows[r]->other_count; b++)
      weight = fmax(weight, fabs(s->rows[r]->other_shape[b]));
  return weight;
}

/* Whether all rows of all pieces have the normal of the first row, which is then stored, as is
 * their largest weight. */
static int have_one_normal(ct_solver *s, const ct_quad_bits *differ)
{
  const int some = (LANE(*differ, 0) | LANE(*differ, 1) | LANE(*differ, 2)) != 0;
  double most[8] = {some,      -HUGE_VAL, -HUGE_VAL, -HUGE_VAL,
                    -HUGE_VAL, -HUGE_VAL, -HUGE_VAL, largest_weight(s)};
  for (int c = 0; s->group_count > 0 && c < 3; c++) most[1 + c] = s->G[c], most[4 + c] = -s->G[c];
  ct_pieces_largest(s->pieces, most, 8);
  memcpy(s->normal, most + 1, sizeof s->normal);
  s->weight = most[7];
  return most[0] == 0.0 && most[1] == -most[4] && most[2] == -most[5] && most[3] == -most[6];
}

/* Fill a group of the last step if it is four points of a face, whose own weights stay, that still
 * meet the same other face; returns whether it is. */
CT_INLINE int fill_again(const ct_solver *s, ct_constraint *const *row, const ct_group *g,
                         changes *d)
{
  if (!g->face || g->other != 4) return 0;
  for (int32_t r = 0; r < 4; r++)
    if (row[r]->other != g->others) return 0;
  for (int32_t r = 0; r < 4; r++) fill_row(s, 1, 4, 4, row[r], &s->G[g->first + 12 * r], d);
  turn_rows(1, 2, &s->G[g->first]);
  return 1;
}

/* Fill the groups of a set's rows from row `r` on, and so many that no group is cut; `to` is the
 * next group, which has its places already, and `known` whether the rows are those of the last
 * step. Returns the row behind them. */
CT_INLINE int64_t fill_rows(const ct_solver *s, ct_rows_known known, int32_t set, int64_t r,
                            ct_group **to, changes *d)
{
  const int32_t *number = &s->place[s->first_node[set]];
  const int64_t end = s->first[set + 1], some = end - r < ROWS ? end : r + ROWS;
  ct_group *g = *to;
  const ct_group *last = &s->groups[s->group_count];
  for (ct_constraint *const *row = &s->rows[r]; r < some; row += g[-1].rows, r += g[-1].rows) {
    if (known && !d->nodes && fill_again(s, row, g, d)) { // all groups so far are those of then
      g++;
      continue;
    }
    d->begin |= g >= last; // the last step had no such group, and places may have been overwritten
    const int32_t own = row[0]->own_count, other = row[0]->other_count;
    // The four points of a face are a group although a station follows them on its nodes.
    const int64_t most = own == 4 && end - r > 4 ? 4 : end - r;
    if (own == 4 && other == 4) fill_group(s, number, row, most, 4, 4, g, d);
    else if (own == 4 && other == 0) fill_group(s, number, row, most, 4, 0, g, d);
    else fill_group(s, number, row, most, own, other, g, d);
    g++;
  }
  *to = g;
  return r;
}

/* What differs between rows at obstacles and groups: anything, bits of normals, and of weights. */
typedef struct difference {
  uintptr_t some;
  ct_quad_bits normal, weight;
} difference;

/* Compare the rows of a group with its nodes and numbers. */
static void compare(const ct_group *g, ct_constraint *const *row, const double *G, difference *d)
{
  d->some |= (uintptr_t)((g->own ^ 4) | g->other);
  for (int32_t r = 0; r < g->rows; r++, G += 8) {
    const ct_constraint *c = row[r];
    for (int i = 0; i < PARTS && i < 3; i++)
      d->normal |= normal_of(c)[i] != ((const ct_quad *)G)[i];
    d->some |= ((uintptr_t)c->own ^ (uintptr_t)g->nodes) | (uintptr_t)c->other_count;
    for (int i = 0; i < PARTS; i++)
      d->weight |= ((const ct_quad *)c->own_shape)[i] != ((const ct_quad *)(G + 4))[i];
  }
}

CT_INLINE int are_equal(const difference *d)
{
  return !d->some &&
         (LANE(d->normal, 0) | LANE(d->normal, 1) | LANE(d->normal, 2) | LANE(d->weight, 0) |
          LANE(d->weight, 1) | LANE(d->weight, 2) | LANE(d->weight, 3)) == 0;
}

int ct_matrix_stays(const ct_solver *s)
{
  return s->kept && s->pieces == NULL && s->groups->other == 0;
}

/* What the effects tell of all listed rows. */
static int find_told(const ct_solver *s)
{
  int changed = 0, stay = CT_ROWS_STAY;
  for (int32_t k = 0; k < s->set_count; k++) {
    if (s->first[k] == s->first[k + 1]) continue;
    const int told = ct_rows_told(s->rows[s->first[k]]);
    changed |= told & CT_ROWS_CHANGED, stay &= told;
  }
  return changed | stay;
}

/* Whether the listed rows are those of the last step. The laws of the library's own rows stay. */
static int are_known(const ct_solver *s, int told)
{
  const int64_t count = s->first[s->set_count];
  return s->kept && count == s->laws.count &&
         ((told & CT_ROWS_STAY) ||
          memcmp(s->rows, s->laws.row, (size_t)count * sizeof *s->rows) == 0);
}

/* What of the rows must be read. */
static ct_rows_known find_known(const ct_solver *s, int told)
{
  if (!are_known(s, told)) return CT_ROWS_UNKNOWN;
  const int written = s->written && s->laws.one_law && s->laws.count > 0 &&
                      ct_law_has_rows(s->laws.row[0]->enforcement) && !(told & CT_ROWS_CHANGED);
  return written ? CT_ROWS_WRITTEN : CT_ROWS_KNOWN;
}

/* Read the rows for their laws as long as they are those of the last step, all at obstacles.
 * Returns whether all are: then G need not be filled. */
CT_INLINE int keep_rows(ct_solver *s, int told, ct_rows_known known)
{
  const ct_group *g = s->groups, *end = g + s->group_count;
  const size_t firsts = ((size_t)s->set_count + 1) * sizeof *s->first;
  const int stay = known && (told & CT_ROWS_STAY);
  if (!ct_matrix_stays(s) || memcmp(s->first, s->first_point, firsts) != 0) return 0;
  for (int64_t first = 0, r = 0; g < end; first = r) {
    difference d = {0};
    for (; g < end && (stay || r < first + ROWS); r += g->rows, g++)
      if (!stay) compare(g, &s->rows[r], &s->G[g->first], &d);
    if (!are_equal(&d)) return 0;
    ct_law_rows_read(&s->laws, s->rows, first, r, known);
  }
  return 1;
}

CT_CLONES
void ct_matrix_fill(ct_solver *s)
{
  const ct_solver of = *s; // whose members need not be read again after each number that is written
  const int told = find_told(s);
  const ct_rows_known known = find_known(s, told);
  if (keep_rows(s, told, known)) {
    s->kept = 2;
    return;
  }
  ct_group *g = s->groups;
  changes d = {.begin = !s->kept};
  g->first = g->place = s->laws.count = 0;
  for (int32_t k = 0; k < of.set_count; k++)
    for (int64_t r = of.first[k], end; r < of.first[k + 1]; r = end) {
      end = fill_rows(&of, known, k, r, &g, &d);
      ct_law_rows_read(&s->laws, of.rows, r, end, known);
    }
  d.nodes |= s->group_count != g - s->groups;
  s->group_count = g - s->groups;
  if (d.nodes) ct_matrix_count(s);
  s->kept = s->bodies == NULL && !s->foreign;
  s->along = have_one_normal(s, &d.normal);
}
