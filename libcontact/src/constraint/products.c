/* Products with G, whose nodes lie side by side in the lanes of quads. */
#include "products.h"

#include "../base/lanes.h"

#include <math.h>
#include <stddef.h>

enum { WIDE = CT_SOLVER_WIDE, PARTS = CT_QUAD_PARTS, MOST_QUADS = 4, FOUR = 4 * PARTS };

/* What a product takes of a row: b_a n, of vectors at nodes; b_a, of their fourth components, which
 * are motions or forces along the one normal of all rows; or b_a n, and |b_a| of fourth components.
 */
typedef enum row_part { FULL, ALONG, BOUND } row_part;
static const int COMPONENTS[] = {[FULL] = 3, [ALONG] = 1, [BOUND] = 4};

/* |x| of each lane. */
#if defined(__GNUC__)
#define SIZE_OF(x) ((ct_quad)((ct_quad_bits)(x) & INT64_MAX))
#else
#define SIZE_OF(x) fabs(x)
#endif

/* Components of vectors at four nodes, as x, y and z of all, and their fourth components. */
CT_INLINE void turn_nodes(row_part part, const double *const at[4], ct_quad *out)
{
  double *v = (double *)out, unused[4];
  ct_turn(at, (double *const[4]){v, v + 4, v + 8, part == BOUND ? v + 12 : unused});
}

/* Fourth components of vectors at four nodes. */
CT_INLINE void take_fourth(const double *const at[4], ct_quad *out)
{
  const double fourth[4] = {at[0][3], at[1][3], at[2][3], at[3][3]};
  for (int i = 0; i < PARTS; i++) out[i] = ((const ct_quad *)fourth)[i];
}

/* The reverse of turn_nodes. */
CT_INLINE void turn_back(row_part part, const ct_quad *v, ct_quad *out)
{
  static const double none[4] = {0.0};
  const double *from = (const double *)v;
  double *to = (double *)out;
  ct_turn((const double *const[4]){from, from + 4, from + 8, part == BOUND ? from + 12 : none},
          (double *const[4]){to, to + WIDE, to + 2 * WIDE, to + 3 * WIDE});
}

/* Sums over the lanes of four quads: (0 + 1) + (2 + 3) of each. */
CT_INLINE void sum_lanes(const ct_quad *t, ct_quad *out)
{
#if CT_ROWS
  const ct_quad a = CT_PICK(t[0], t[1], 0, 4, 2, 6) + CT_PICK(t[0], t[1], 1, 5, 3, 7),
                b = CT_PICK(t[2], t[3], 0, 4, 2, 6) + CT_PICK(t[2], t[3], 1, 5, 3, 7);
  *out = CT_PICK(a, b, 0, 1, 4, 5) + CT_PICK(a, b, 2, 3, 6, 7);
#else
  for (int r = 0; r < 4; r++) {
    const double *own = (const double *)&t[PARTS * r];
    ((double *)out)[r] = (own[0] + own[1]) + (own[2] + own[3]);
  }
#endif
}

/* The node of a row in lane l of the quads of both faces, or -1. */
CT_INLINE int32_t node_in(int32_t own, int32_t other, int32_t l)
{
  const int32_t theirs = l - 4 * ct_quads_of(own);
  if (theirs < 0) return CT_LANE_NODE[l] < own ? CT_LANE_NODE[l] : -1;
  return CT_LANE_NODE[theirs] < other ? own + CT_LANE_NODE[theirs] : -1;
}

/* The vectors at the nodes of both faces: for each quad their components, or the fourth ones first.
 */
CT_INLINE void load_nodes(row_part part, int32_t own, int32_t other, const int32_t *place,
                          const double *x, ct_quad *at)
{
  for (int32_t q = 0; q < ct_quads_of(own) + ct_quads_of(other); q++) {
    const double *node[4];
    for (int32_t l = 0; l < 4; l++) {
      const int32_t a = node_in(own, other, 4 * q + l);
      node[l] = &x[a < 0 ? 0 : place[a]]; // times 0
    }
    if (part == ALONG) take_fourth(node, &at[FOUR * q]);
    else turn_nodes(part, node, &at[FOUR * q]);
  }
}

/* Σ over the lanes of some quads of four rows: b_a times the motion of the node along the normal,
 * or times its fourth component; or, for a BOUND, |b_a| times its fourth component. */
CT_INLINE void sum_quads(row_part part, int32_t first, int32_t count, const double *const row[4],
                         const ct_quad *at, ct_quad *out)
{
  for (int32_t q = first; q < first + count; q++) {
    ct_quad t[4 * PARTS], sum[PARTS];
    const ct_quad *x = &at[FOUR * q];
    for (int r = 0; r < 4; r++)
      for (int i = 0; i < PARTS; i++) {
        const double *n = row[r];
        const ct_quad b = ((const ct_quad *)&row[r][4 + 4 * q])[i];
        t[PARTS * r + i] =
            part == BOUND   ? SIZE_OF(b) * x[3 * PARTS + i]
            : part == ALONG ? x[i] * b
                            : ((n[0] * x[i] + n[1] * x[PARTS + i]) + n[2] * x[2 * PARTS + i]) * b;
      }
    sum_lanes(t, sum);
    for (int i = 0; i < PARTS; i++)
      if (q == first) out[i] = sum[i];
      else out[i] += sum[i];
  }
}

/* The same over both faces, of the first `rows` of four rows. */
CT_INLINE void sum_row(row_part part, int32_t mine, int32_t theirs, int32_t rows,
                       const double *const row[4], const ct_quad *at, double *out)
{
  const ct_quad none = {0.0};
  ct_quad sum[PARTS], more[PARTS];
  for (int i = 0; i < PARTS; i++) sum[i] = more[i] = none;
  sum_quads(part, 0, mine, row, at, sum);
  sum_quads(part, mine, theirs, row, at, more);
  for (int i = 0; theirs > 0 && i < PARTS; i++) sum[i] += more[i];
  for (int i = 0; i < 4 && i < rows; i++) out[i] = ((const double *)sum)[i];
}

/* Rows of G with the same nodes times a vector. Inlined for faces with four and eight nodes, so
 * that the vectors at the nodes stay in registers. */
CT_INLINE void times_rows(row_part part, int32_t own, int32_t other, int32_t rows,
                          const int32_t *place, const double *G, const double *x, double *out,
                          double *sizes)
{
  const int32_t mine = ct_quads_of(own), theirs = ct_quads_of(other),
                step = 4 * (1 + mine + theirs);
  ct_quad at[FOUR * MOST_QUADS];
  load_nodes(part, own, other, place, x, at);
  for (int32_t r = 0; r < rows; r += 4, G += 4 * step) {
    const double *row[4];
    for (int i = 0; i < 4; i++) row[i] = G + (r + i < rows ? i : 0) * step;
    sum_row(part == ALONG ? ALONG : FULL, mine, theirs, rows - r, row, at, out + r);
    if (part == BOUND) sum_row(BOUND, mine, theirs, rows - r, row, at, sizes + r);
  }
}

/* Σ over the nodes of both faces, paired as over lanes. */
CT_INLINE void sum_nodes(int32_t other, const ct_quad t[8], ct_quad *out)
{
  ct_quad sum = (t[0] + t[1]) + (t[2] + t[3]);
  if (other > 0) sum += (t[4] + t[5]) + (t[6] + t[7]);
  *out = sum;
}

/* The same of the four rows of a face, to the same bits, from their numbers side by side: nothing
 * is summed over lanes. */
CT_INLINE void times_face(row_part part, int32_t other, const int32_t *place, const double *G,
                          const double *x, double *out, double *sizes)
{
  const ct_quad *n = (const ct_quad *)&G[16 * (2 + other / 4)], *b = n + 4 * PARTS;
  for (int i = 0; i < PARTS; i++, n++, b++) {
    ct_quad t[8];
    for (int32_t a = 0; a < 4 + other; a++) {
      const double *v = &x[place[a]];
      const ct_quad w = b[PARTS * a];
      t[a] = part == ALONG ? w * v[3] : ((n[0] * v[0] + n[PARTS] * v[1]) + n[2 * PARTS] * v[2]) * w;
    }
    sum_nodes(other, t, (ct_quad *)out + i);
    if (part != BOUND) continue;
    for (int32_t a = 0; a < 4 + other; a++) t[a] = SIZE_OF(b[PARTS * a]) * x[place[a] + 3];
    sum_nodes(other, t, (ct_quad *)sizes + i);
  }
}

/* Whether a group is the four points of a face with four nodes over another one, or over none. */
CT_INLINE int are_four(const ct_group *g, int32_t other)
{
  return g->own == 4 && g->other == other && g->face && g->rows == 4;
}

/* Vectors of a product: at the nodes, and at the rows from those of a group on, of a BOUND two. */
typedef struct factors {
  const int32_t *places;
  const double *G, *x;
  double *out, *sizes, *end;
} factors;

/* The product of groups that are alike and follow on each other: most do, so that their numbers are
 * constants in a loop. Returns the group behind them. */
CT_INLINE const ct_group *times_like(row_part part, int turned, int32_t own, int32_t other,
                                     int32_t rows, const ct_group *e, factors *f)
{
  const int64_t left = (f->end - f->out) / rows;
  const ct_group *end = e + (left < e->alike ? left : e->alike);
  do {
    const int32_t *place = &f->places[e->place];
    const double *G = &f->G[e->first];
    if (turned) times_face(part, other, place, G, f->x, f->out, f->sizes);
    else times_rows(part, own, other, rows, place, G, f->x, f->out, f->sizes);
    f->out += rows, f->sizes += part == BOUND ? rows : 0, e++;
  } while (e < end);
  return e;
}

/* G times a vector at nodes. */
CT_INLINE void times_groups(row_part part, const ct_group *groups, int64_t count,
                            const int32_t *places, const double *G, const double *x, double *out,
                            double *sizes)
{
  factors f = {places, G, x, out, sizes, out + count};
  for (const ct_group *e = groups; f.out < f.end;)
    if (are_four(e, 4)) e = times_like(part, 1, 4, 4, 4, e, &f);
    else if (part != BOUND && are_four(e, 0)) e = times_like(part, 1, 4, 0, 4, e, &f);
    else if (part != BOUND && e->own == 4 && e->other == 4)
      e = times_like(part, 0, 4, 4, e->rows, e, &f);
    else if (e->own == 8 && e->other == 8) e = times_like(part, 0, 8, 8, e->rows, e, &f);
    else e = times_like(part, 0, e->own, e->other, e->rows, e, &f);
}

CT_CLONES
void ct_times_full(const ct_group *groups, int64_t count, const int32_t *places, const double *G,
                   const double *x, double *out)
{
  times_groups(FULL, groups, count, places, G, x, out, out);
}

CT_CLONES
void ct_times_along(const ct_group *groups, int64_t count, const int32_t *places, const double *G,
                    const double *x, double *out)
{
  times_groups(ALONG, groups, count, places, G, x, out, out);
}

CT_CLONES_NODES
void ct_times_bound(const ct_group *groups, int64_t count, const int32_t *places, const double *G,
                    const double *x, double *out, double *sizes)
{
  times_groups(BOUND, groups, count, places, G, x, out, sizes);
}

/* The components c of the forces of some rows r, in 4 c + r; of the four rows of a face from their
 * numbers side by side. */
CT_INLINE void resolve(int turned, int32_t rows, int32_t step, const double *G, const double *force,
                       double *out)
{
  const ct_quad *n = (const ct_quad *)&G[4 * step], *f = (const ct_quad *)force;
  for (int i = 0; turned && i < 3 * PARTS; i++) ((ct_quad *)out)[i] = n[i] * f[i % PARTS];
  for (int c = 0; c < 3; c++)
    for (int r = 0; !turned && r < rows; r++) out[4 * c + r] = G[r * step + c] * force[r];
}

/* One component of the force of a row at the nodes of a quad, whose numbers begin at `b`; or, as
 * the fourth, the size of a unit force. */
CT_INLINE void push(int size, const double *b, double force, ct_quad *out)
{
  const ct_quad N = *(const ct_quad *)b;
  if (size) *out = SIZE_OF(N);
  else *out = N * force;
}

/* Spacings of grids: of the sums of forces, and of sizes. */
typedef struct spacings {
  double force, size;
} spacings;

/* Add one row times its force to the sums of its nodes, or set these to four of them, as multiples
 * of the coarse grid's spacing: these sums are exact in any order (eq:order-free-sum). Four rows
 * are those of a 2 x 2 rule, summed first in pairs across the middle, so that a flipped or rotated
 * face gives the same bits (eq:tree-sum). */
CT_INLINE void add_row(row_part part, int turned, int32_t quads, int four, spacings grid,
                       int32_t step, const double *row, const double *force, ct_quad *sum)
{
  double resolved[12];
  const double *f = part == ALONG ? force : resolved;
  if (part != ALONG) resolve(turned, four ? 4 : 1, step, row, force, resolved);
  for (int32_t q = 0; q < quads; q++)
    for (int c = 0; c < COMPONENTS[part]; c++)
      for (int i = 0; i < PARTS; i++) {
        const double coarse = c == 3 ? grid.size : grid.force;
        ct_quad t[4];
        for (int r = 0; r < (four ? 4 : 1); r++)
          push(c == 3, row + r * step + 4 + 4 * q + i, c == 3 ? 0.0 : f[4 * c + r], &t[r]);
        ct_quad *to = &sum[FOUR * q + PARTS * c + i];
        if (four) *to = (((t[0] + t[3]) + (t[1] + t[2])) + coarse) - coarse;
        else *to += (t[0] + coarse) - coarse;
      }
}

/* Add the sums of the nodes of a group to those of all nodes. */
CT_INLINE void add_nodes(row_part part, int32_t own, int32_t other, const int32_t *place,
                         const ct_quad *sum, double *sums)
{
  for (int32_t q = 0; q < ct_quads_of(own) + ct_quads_of(other); q++) {
    const ct_quad none = {0.0};
    ct_quad node[4 * PARTS];
    const double *fourth = (const double *)&sum[FOUR * q];
    for (int i = 0; i < 4 * PARTS; i++) node[i] = none;
    if (part != ALONG) turn_back(part, &sum[FOUR * q], node);
    for (int32_t l = 0; l < 4; l++) {
      const int32_t a = node_in(own, other, 4 * q + l);
      if (a < 0) continue;
      const int32_t to = place[a];
      if (part == ALONG) sums[to + 3] += fourth[l];
      for (int i = 0; part != ALONG && i < PARTS; i++)
        ((ct_quad *)&sums[to])[i] += node[PARTS * l + i];
    }
  }
}

/* Add rows of G with the same nodes, times their forces, to the sums at the nodes. */
CT_INLINE void add_rows(row_part part, int turned, spacings grid, int32_t own, int32_t other,
                        int face, int32_t rows, const int32_t *place, const double *G,
                        const double *force, double *sums)
{
  const int32_t quads = ct_quads_of(own) + ct_quads_of(other), step = 4 * (1 + quads);
  const ct_quad none = {0.0};
  ct_quad sum[FOUR * MOST_QUADS];
  if (face && rows == 4) {
    add_row(part, turned, quads, 1, grid, step, G, force, sum);
  } else {
    for (int32_t i = 0; i < FOUR * quads; i++) sum[i] = none;
    for (int32_t r = 0; r < rows; r++)
      add_row(part, 0, quads, 0, grid, step, G + r * step, force + r, sum);
  }
  add_nodes(part, own, other, place, sum, sums);
}

/* Vectors of such sums: the forces from those of a group on, and at the nodes. */
typedef struct forces {
  const int32_t *places;
  const double *G, *force;
  double *sums;
  const ct_group *end;
} forces;

/* Add the rows of groups that are alike, as times_like. */
CT_INLINE const ct_group *add_like(row_part part, int turned, spacings grid, int32_t own,
                                   int32_t other, int face, int32_t rows, const ct_group *e,
                                   forces *f)
{
  const ct_group *end = f->end - e < e->alike ? f->end : e + e->alike;
  do {
    add_rows(part, turned, grid, own, other, face, rows, &f->places[e->place], &f->G[e->first],
             f->force, f->sums);
    f->force += rows, e++;
  } while (e < end);
  return e;
}

/* Gᵀ times the forces of rows. */
CT_INLINE void add_groups(row_part part, spacings grid, const ct_group *groups, int64_t count,
                          const int32_t *places, const double *G, const double *force,
                          double *restrict sums)
{
  forces f = {places, G, force, sums, groups + count};
  for (const ct_group *e = groups; e < f.end;)
    if (are_four(e, 4)) e = add_like(part, 1, grid, 4, 4, 1, 4, e, &f);
    else if (part != BOUND && are_four(e, 0)) e = add_like(part, 1, grid, 4, 0, 1, 4, e, &f);
    else if (part != BOUND && e->own == 4 && e->other == 4)
      e = add_like(part, 0, grid, 4, 4, e->face, e->rows, e, &f);
    else if (e->own == 8 && e->other == 8)
      e = add_like(part, 0, grid, 8, 8, e->face, e->rows, e, &f);
    else e = add_like(part, 0, grid, e->own, e->other, e->face, e->rows, e, &f);
}

CT_CLONES
void ct_add_full(double coarse, const ct_group *groups, int64_t count, const int32_t *places,
                 const double *G, const double *force, double *restrict sums)
{
  add_groups(FULL, (spacings){coarse, 0.0}, groups, count, places, G, force, sums);
}

CT_CLONES
void ct_add_along(double coarse, const ct_group *groups, int64_t count, const int32_t *places,
                  const double *G, const double *force, double *restrict sums)
{
  add_groups(ALONG, (spacings){coarse, 0.0}, groups, count, places, G, force, sums);
}

CT_CLONES_NODES
void ct_add_bound(double coarse, double sizes, const ct_group *groups, int64_t count,
                  const int32_t *places, const double *G, const double *force,
                  double *restrict sums)
{
  add_groups(BOUND, (spacings){coarse, sizes}, groups, count, places, G, force, sums);
}
