/* Points of a surface as rows of the constraint problem, and their forces at the nodes. */
#include "heap.h"
#include "contact_internal.h"

#include <libcontact/base.h>

#include "../constraint/law.h"
#include "../base/error.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"

#include <math.h>
#include <stddef.h>

/* Parts of the energy of a point: of its row, if it is listed, and what it holds. */
static double lag_of(const ct_point *p) { return p->listed ? ct_law_lag(&p->row) : 0.0; }
static double start_of(const ct_point *p) { return p->listed ? ct_law_start(&p->row) : 0.0; }
CT_INLINE double above_zero(double x) { return x > 0.0 ? x : 0.0; }
static double reserve_of(const ct_point *p) { return above_zero(p->row.impact.reserve); }
static double debt_of(const ct_point *p) { return above_zero(-p->row.impact.reserve); }
static double stored_in(const ct_impact *m) { return m->stored + above_zero(m->reserve); }
static double stored_of(const ct_point *p) { return stored_in(&p->row.impact); }

static double left_of(const ct_point *p) { return ct_law_left(&p->row); }

/* The force of a point that presses (eq:impact-left). */
static double press_of(const ct_point *p)
{
  return p->listed ? above_zero(p->row.force - p->row.impact.release) : 0.0;
}

/* Whether the row of a point is listed: its force λ acts with λ N n on the point's own face and
 * with -λ N̄ n on the other (eq:constraint-force), if it meets one. */
CT_INLINE int is_listed(double reach, const ct_constraint *row)
{
  return row->gap <= reach || (!isnan(row->gap) && ct_law_may_release(row));
}

/* Motions of an obstacle along its one normal, in the last step and the next one. */
typedef struct along {
  double came, coming;
} along;

/* Complete the row of a point at an obstacle that a body carries: the force acts against the body
 * on its own line. */
static void row_on_carrier(const ct_contact *contact, const ct_side *side, ct_constraint *row)
{
  const ct_side *surface = &contact->gaps.side[0];
  const ct_point *p = (const ct_point *)(void *)((char *)row - offsetof(ct_point, row));
  const int64_t i = p - side->points;
  double *weights = contact->carried.weights[side == surface ? i : surface->fixed->point_count + i],
         r[3];
  ct_side_interpolate(surface->search, surface->search->x, ct_side_face(side, i), row->own_shape,
                      contact->carried.centre, r);
  ct_carrier_weigh(&contact->carried, r, weights);
  // -- The nodes of the body, with the weights at the point itself (eq:carrier-row)
  row->other_count = CT_CARRIER_NODES;
  row->other = contact->fixed->carrier->place;
  row->other_shape = weights;
}

/* Changes of the gap of a point that are not due to nodes: motion of an obstacle along the normal,
 * and growth of the start gap. */
CT_INLINE void shift_row(const ct_contact *contact, const ct_side *side, along m, int rigid,
                         ct_point *p)
{
  if (rigid && contact->axis == NULL) m.came = ct_vector_dot(p->row.normal, contact->came);
  if (rigid && contact->axis == NULL) m.coming = ct_vector_dot(p->row.normal, contact->coming);
  p->row.came = contact->part * (-p->closed - m.came);
  p->row.moved = -(p->start * side->closing) - m.coming;
}

/* List the rows of the points of a side; `alike`: their gaps change alike besides the motion of
 * nodes; `written`: as they did in the last step, in which all points were listed. Inlined for
 * each. */
CT_INLINE int64_t list_points(int alike, int written, ct_contact *contact, const ct_side *side,
                              const along *m, double dt, ct_listing *next, ct_constraint **rows)
{
  const double reach = contact->reach, came = next->came, moved = next->moved;
  const int rigid = ct_contact_is_rigid(contact->fixed) && contact->fixed->carrier == NULL,
            folds = !ct_contact_is_rigid(contact->fixed) && contact->gaps.fixed->sides == 1;
  ct_constraint **to = rows;
  next->all = alike;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (ct_point *p = side->points + run.first, *end = side->points + run.end; p < end; p++) {
      for (; written && p < end && p->row.gap <= reach; p++) *to++ = &p->row; // most of them
      if (p == end) break;
      if (!is_listed(reach, &p->row)) {
        next->all = p->listed = 0;
        ct_law_leave(&p->row, dt);
        // On its own surface a point is without a partner only for a while, at a sharp fold.
        if (!folds) contact->left = fmax(contact->left, left_of(p));
        continue;
      }
      *to++ = &p->row;
      if (written) continue;
      p->listed = 1;
      if (alike) p->row.came = came, p->row.moved = moved;
      else shift_row(contact, side, *m, rigid, p);
    }
  return to - rows;
}

/* The same if all are listed, as they were: in this place, unless rows before them have moved them.
 */
static int64_t list_all(const ct_side *side, ct_constraint **rows)
{
  ct_constraint **to = rows;
  if (side->runs == NULL && *rows == &side->points->row) return side->fixed->point_count;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++) *to++ = &side->points[i].row;
  return to - rows;
}

int64_t ct_contact_list_rows(ct_contact *contact, double dt, ct_constraint **rows)
{
  const double *axis = contact->axis;
  const int carried = contact->fixed->carrier != NULL,
            rigid = ct_contact_is_rigid(contact->fixed) && !carried;
  const along m = {rigid && axis != NULL ? ct_vector_dot(axis, contact->came) : 0.0,
                   rigid && axis != NULL ? ct_vector_dot(axis, contact->coming) : 0.0};
  int64_t count = 0;
  int told =
      (contact->changed ? CT_ROWS_CHANGED : 0) | (axis != NULL && !carried ? CT_ROWS_STAY : 0);
  contact->left = 0.0;
  for (int s = 0; s < contact->gaps.fixed->sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    const ct_listing last = contact->listing[s];
    ct_listing *next = &contact->listing[s];
    ct_constraint **own = &rows[count];
    const int alike = !side->shifted && (!rigid || axis != NULL); // no start gaps
    next->came = -contact->part * m.came, next->moved = -m.coming;
    const int written = alike && last.all && last.came == next->came && last.moved == next->moved;
    if (written && contact->all_near) count += list_all(side, own);
    else if (written) count += list_points(1, 1, contact, side, &m, dt, next, own);
    else if (alike) count += list_points(1, 0, contact, side, &m, dt, next, own);
    else count += list_points(0, 0, contact, side, &m, dt, next, own);
    for (; carried && own < &rows[count]; own++) row_on_carrier(contact, side, *own);
    if (!(written && next->all)) told &= ~CT_ROWS_STAY;
  }
  if (count > 0) ct_rows_tell(rows[0], told);
  return count;
}

/* The larger one of a number and the components of a force. */
CT_INLINE double larger(double top, const double force[3])
{
  for (int c = 0; c < 3; c++) top = fabs(force[c]) > top ? fabs(force[c]) : top;
  return top;
}

double ct_side_take_rows(ct_side *side)
{
  double top = 0.0;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
      // -- F = λ n, 0 if the row is not listed (eq:constraint-force)
      for (int c = 0; c < 3; c++) p->force[c] = p->listed ? p->row.force * p->row.normal[c] : 0.0;
      top = larger(top, p->force);
    }
  return top;
}

/* Whether the gap of a point is not the length of its gap vector. */
static int is_counted(const ct_point *p) { return p->shift != 0.0 || p->jumped == CT_POINT_BESIDE; }

/* Force of a point with the explicit penalty: k d where it is inside. With a start gap it is
 * counted from there, along the normal. */
static void penalize(ct_point *p)
{
  const double *n = p->row.normal, k = p->row.stiffness;
  const int inside = p->row.gap < 0.0, counted = is_counted(p);
  for (int c = 0; c < 3; c++)
    // -- F = k d (eq:contact-force, eq:obstacle-force)
    p->force[c] = !inside ? 0.0 : counted ? -k * p->row.gap * n[c] : k * p->d[c];
}

double ct_side_apply_penalty(ct_side *side)
{
  double top = 0.0;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
      penalize(p);
      top = larger(top, p->force);
    }
  return top;
}

/* Energy of a point with the force F: ½ k g², written as ½ F · d, with a start gap as -½ |F| g. */
static double potential_of(const ct_point *p)
{
  const double *F = p->force;
  if (is_counted(p)) return -0.5 * sqrt(ct_vector_dot(F, F)) * p->row.gap;
  // -- One term of the potential (eq:contact-potential, eq:obstacle-potential)
  return 0.5 * ct_vector_dot(F, p->d);
}

double ct_side_potential(const ct_side *sides, int count)
{
  ct_stream sum = {.pieces = sides[0].pieces};
  while (ct_stream_again(&sum, 1))
    for (int s = 0; s < count; s++)
      for (ct_span run = {0}; ct_side_next(&sides[s], &run);)
        for (int64_t i = run.first; i < run.end; i++) {
          const double term = potential_of(&sides[s].points[i]);
          ct_stream_add(&sum, &term, 1);
        }
  return ct_stream_sum(&sum);
}

/* Σ of one part of the energy over all points. */
static double sum_energy(ct_contact *contact, double (*part)(const ct_point *point))
{
  int64_t some = 0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (const ct_point *p = side->points + run.first; p < side->points + run.end; p++) {
        contact->terms[some] = part(p);
        some += contact->terms[some] != 0.0;
      }
  }
  return ct_sum_over(contact->gaps.side[0].pieces, contact->terms, some);
}

/* The same of what the points stored and held at the middle of the last step, in its memory. */
static double sum_before(ct_contact *contact)
{
  const ct_point_record *record = (const ct_point_record *)(const void *)contact->memory;
  int64_t some = 0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (int64_t i = run.first; i < run.end; i++) {
        contact->terms[some] = stored_in(&record[i].impact);
        some += contact->terms[some] != 0.0;
      }
    record += side->fixed->point_count;
  }
  return ct_sum_over(contact->gaps.side[0].pieces, contact->terms, some);
}

/* Let the points that press take what others leave (eq:impact-left). Returns whether any do. */
static int take_left(ct_contact *contact)
{
  const double force = sum_energy(contact, press_of),
               left = force > 0.0 ? sum_energy(contact, left_of) : 0.0;
  if (!(left > 0.0)) return 0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (ct_point *p = side->points + run.first; p < side->points + run.end; p++)
        // -- K_j + L λ_j / Σ λ, and 0 for those that have left (eq:impact-left)
        p->row.impact.reserve += left * (press_of(p) / force) - left_of(p);
  }
  return 1;
}

/* Pay what points owe from what others hold, in the same proportion (eq:impact-debt). */
int ct_contact_pay_debts(ct_contact *contact, double debts)
{
  double largest[2] = {debts, contact->left};
  if (contact->fixed->law.restitution == 0.0) return 0;
  ct_pieces_largest(contact->gaps.side[0].pieces, largest, 2);
  const int taken = largest[1] > 0.0 && take_left(contact);
  const double debt = largest[0] > 0.0 ? sum_energy(contact, debt_of) : 0.0;
  const double held = debt > 0.0 ? sum_energy(contact, reserve_of) : 0.0;
  if (!(held > 0.0)) return taken;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (ct_point *p = side->points + run.first; p < side->points + run.end; p++)
        p->row.impact.reserve = ct_law_paid(p->row.impact.reserve, held, debt);
  }
  return 1;
}

void ct_contact_complete(ct_contact *contact)
{
  if (contact->complete || !contact->solved) return;
  contact->complete = 1;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) ct_side_take_rows(&contact->gaps.side[s]);
  if (ct_contact_is_rigid(contact->fixed) && !contact->fixed->moves) ct_contact_react(contact);
  contact->reserve = sum_energy(contact, reserve_of);
  if (contact->record.time == 0.0) {
    contact->energy = sum_energy(contact, start_of);
    return;
  }
  // -- What was stored in the step before belongs to the partners of then, so it is not computed
  // again (eq:controlled-energy)
  const double before = sum_before(contact), after = sum_energy(contact, stored_of);
  contact->energy = 0.5 * (before + after) + sum_energy(contact, lag_of);
}

/* Minus the sum of a component of the forces of all points; at a plane, of their sizes. */
static double sum_against(const ct_contact *contact, int sizes, int c)
{
  int64_t count = 0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; ct_side_next(side, &run);)
      for (const ct_point *p = side->points + run.first; p < side->points + run.end; p++)
        contact->terms[count++] = sizes ? -p->row.force : -p->force[c];
  }
  return ct_sum_over(contact->gaps.side[0].pieces, contact->terms, count);
}

void ct_contact_react(ct_contact *contact)
{
  const int plane = contact->solved && contact->axis != NULL;
  const double size = plane ? sum_against(contact, 1, 0) : 0.0;
  for (int c = 0; c < 3; c++)
    // 0 without a sign where the axis has no component
    contact->reaction[c] = plane ? size * contact->axis[c] + 0.0 : sum_against(contact, 0, c);
}

void ct_contact_push_carrier(const ct_contact *contact, double *force, double *terms)
{
  const ct_search *search = contact->gaps.side[0].search;
  if (contact->fixed->carrier != NULL)
    ct_carrier_react(contact->fixed->carrier, &contact->carried, search->node_count,
                     contact->gaps.fixed->place[0], search->x, terms, force);
}

static ct_heap heap_of(const ct_side *side)
{
  return (ct_heap){side->force, side->force_fine, side->search->per, NULL, {0}, {0}};
}

static const int32_t *nodes_of(const ct_search *search, int32_t face)
{
  return &search->faces[(int64_t)face * search->per];
}

/* Force of a point, and a fourth component 0: of its row, or of the explicit penalty. */
CT_INLINE void force_of(const ct_point *p, int solved, double force[4])
{
#if CT_ROWS
  if (solved) {
    const double *normal = (const double *)((const char *)p + offsetof(ct_point, row.normal));
    const ct_quad axes = {1.0, 1.0, 1.0, 0.0}; // not the gap behind the normal
    *(ct_quad *)force = *(const ct_quad *)normal * p->row.force * axes;
    return;
  }
#endif
  // -- F = λ n (eq:constraint-force)
  for (int c = 0; c < 3; c++) force[c] = solved ? p->row.force * p->row.normal[c] : p->force[c];
  force[3] = 0.0;
}

CT_INLINE int has_force(const ct_point *p, int solved)
{
  return solved ? p->row.force > 0.0 : ct_point_has_force(p);
}

/* Add the forces of the points of a face with the nodes `node`, one by one, and what acts against
 * them on the `faces` of the other side, null if there is none. */
CT_INLINE void spread_points(int stride, const ct_grid *grid, int solved, const ct_side *side,
                             const ct_point *point, const int32_t *node, const int32_t *faces,
                             ct_heap *own, ct_heap *theirs)
{
  for (int q = 0; q < side->fixed->rule.count; q++, point++) {
    double force[4];
    if (!has_force(point, solved)) continue;
    force_of(point, solved, force);
    // -- N_a F on the own face, -N̄_b F on the other (eq:contact-force)
    ct_heap_add(stride, grid, node, side->fixed->N[q], force, own);
    if (faces == NULL) continue;
    for (int c = 0; c < 3; c++) force[c] = -force[c];
    ct_heap_add(stride, grid, &faces[(int64_t)point->other * theirs->count], point->N, force,
                theirs);
  }
}

/* The least force of the four points of a face. */
CT_INLINE double least_force(const ct_point *p)
{
  double least = p[0].row.force;
  for (int q = 1; q < 4; q++) least = least < p[q].row.force ? least : p[q].row.force;
  return least;
}

/* Whether four points have forces and meet one face. */
CT_INLINE int are_four(int solved, const ct_point *point)
{
  int four = !solved || least_force(point) > 0.0;
  for (int q = 0; four && q < 4; q++)
    four = (solved || has_force(&point[q], 0)) && point[q].other == point[0].other;
  return four;
}

/* The same as `spread_points` for such points, together. */
CT_INLINE void spread_four(int stride, const ct_grid *grid, int solved, double (*const N)[8][4],
                           const ct_point *point, const int32_t *node, const int32_t *faces,
                           ct_heap *own, ct_heap *theirs)
{
  const double *const own_N[4] = {N[0][0], N[1][0], N[2][0], N[3][0]};
  const double *const N_bar[4] = {point[0].N, point[1].N, point[2].N, point[3].N};
  const int own_count = stride == 4 ? 4 : own->count, count = stride == 4 ? 4 : theirs->count;
  double force[4][4];
  for (int q = 0; q < 4; q++) force_of(&point[q], solved, force[q]);
  ct_heap_add_four(own_count, 4, grid, node, own_N, 1.0, force, own);
  if (faces == NULL) return;
  ct_heap_add_four(count, 1, grid, &faces[(int64_t)point->other * count], N_bar, -1.0, force,
                   theirs);
}

CT_INLINE void spread_faces(int stride, const ct_grid *grid, int solved, ct_side *side,
                            ct_side *other)
{
  const ct_grid at = *grid; // which need not be read again after each number that is written
  const int points = side->fixed->rule.count;
  const int32_t *faces = other == NULL ? NULL : other->search->faces;
  ct_heap own = heap_of(side), theirs = heap_of(other == NULL ? side : other);
  double N[4][8][4]; // each one four times
  for (int q = 0; q < 4; q++)
    for (int a = 0; a < 8; a++)
      for (int c = 0; c < 4; c++) N[q][a][c] = side->fixed->N[q][a];
  for (ct_span run = {0}; ct_side_next_faces(side, &run);) {
    const ct_point *point = &side->points[run.first * points];
    const int32_t *node = nodes_of(side->search, (int32_t)run.first);
    for (; run.first < run.end; run.first++, point += points, node += own.count)
      if (points == 4 && are_four(solved, point))
        spread_four(stride, &at, solved, N, point, node, faces, &own, &theirs);
      else spread_points(stride, &at, solved, side, point, node, faces, &own, &theirs);
  }
  ct_heap_bring(stride, &own, NULL);
  ct_heap_bring(stride, &theirs, NULL);
}

/* Add the forces of one side's points to its nodes and, unless it is null, to those of the other
 * side, in sums that do not depend on their order (eq:contact-force). */
CT_CLONES
static void spread(const ct_grid *grid, int solved, ct_side *side, ct_side *other)
{
  const int four = side->search->per == 4 && (other == NULL || other->search->per == 4);
  if (four && solved) spread_faces(4, grid, 1, side, other);
  else spread_faces(8, grid, solved, side, other);
}

/* Add the forces of an obstacle's stations to the nodes of its surface. */
static void spread_stations(const ct_grid *grid, int solved, const ct_side *stations,
                            ct_side *surface)
{
  ct_heap heap = heap_of(surface);
  for (ct_span run = {0}; ct_side_next(stations, &run);)
    for (int64_t i = run.first; i < run.end; i++) {
      const ct_point *point = &stations->points[i];
      double force[4];
      if (!has_force(point, solved)) continue;
      force_of(point, solved, force);
      ct_heap_add(8, grid, nodes_of(surface->search, point->other), point->N, force, &heap);
    }
  ct_heap_bring(8, &heap, NULL);
}

/* Add terms to the sums at the nodes of a face with `per` nodes, coarse and fine ones in turn. */
CT_INLINE void push_terms(int stride, int per, const ct_grid *grid, const int32_t *node,
                          const double *term, double *sums)
{
  double cut[8][2];
#pragma omp simd
  for (int a = 0; a < stride; a++) ct_grid_cut(grid, term[a], &cut[a][0], &cut[a][1]);
  for (int a = 0; a < per; a++) ct_add_pair(cut[a], &sums[2 * (int64_t)node[a]]);
}

/* Sizes of the forces of a face's points, which have one direction, summed at its nodes: Σ N_a λ.
 * Inlined with a known `per` and number of points. */
CT_INLINE void push_face(int stride, int per, int points, const ct_grid *grid, const double (*N)[8],
                         const ct_point *p, const int32_t *node, double *sums)
{
  double term[8];
  if (points == 4 && least_force(p) > 0.0) {
#pragma omp simd
    for (int a = 0; a < stride; a++)
      // -- N_a λ of four points, as in ct_heap_add_four (eq:contact-force)
      term[a] = (N[0][a] * p[0].row.force + N[3][a] * p[3].row.force) +
                (N[1][a] * p[1].row.force + N[2][a] * p[2].row.force);
    push_terms(stride, per, grid, node, term, sums);
    return;
  }
  for (int q = 0; q < points; q++) {
    if (p[q].row.force == 0.0) continue;
    // -- N_a λ (eq:contact-force)
    for (int a = 0; a < stride; a++) term[a] = N[q][a] * p[q].row.force;
    push_terms(stride, per, grid, node, term, sums);
  }
}

/* The same for all faces; then the force on each node along the axis. */
CT_CLONES
static void push_plane(const ct_grid *grid, ct_side *side, const double axis[3])
{
  const int64_t count = side->search->node_count;
  const int per = side->search->per, points = side->fixed->rule.count;
  const ct_grid at = *grid; // as above
  const double (*N)[8] = side->fixed->N;
  double *sums = side->force_fine; // zeros, also afterwards
  for (ct_span run = {0}; ct_side_next_faces(side, &run);) {
    const ct_point *p = &side->points[run.first * points];
    const int32_t *node = nodes_of(side->search, (int32_t)run.first);
    for (; run.first < run.end; run.first++, p += points, node += per)
      if (per == 4 && points == 4) push_face(4, 4, 4, &at, N, p, node, sums);
      else push_face(8, per, points, &at, N, p, node, sums);
  }
  ct_pieces_sum(side->pieces, sums, 2 * count);
  for (int64_t n = 0; n < count; n++) {
    const double size = sums[2 * n] + sums[2 * n + 1];
    // -- F = λ n (eq:constraint-force)
    for (int c = 0; c < 3; c++) side->force[3 * n + c] = size * axis[c];
    sums[2 * n] = sums[2 * n + 1] = 0.0;
  }
}

ct_status ct_contact_collect(ct_contact *contact, double top, ct_error *error)
{
  const ct_gaps_fixed *fixed = contact->gaps.fixed;
  ct_side *sides = contact->gaps.side;
  const int plane = contact->solved && contact->axis != NULL;
  ct_grid grid;
  ct_pieces_largest(sides[0].pieces, &top, 1);
  for (int s = 0; s < ct_gaps_surfaces(fixed); s++) {
    const size_t size = (size_t)sides[s].search->node_count;
    if (!plane || top == 0.0) ct_clear(sides[s].force, (plane ? 3 : 6) * size + 1);
  }
  if (top == 0.0) return CT_OK;
  // Shape functions of quadratic faces are below 1 in size; the factor 2 is a margin.
  const int64_t terms = (ct_contact_is_rigid(contact->fixed) ? 8 : 16) * fixed->point_count;
  if (!ct_grid_init(&grid, 2.0 * top, terms))
    return ct_fail(
        error, CT_ERROR_BLOWUP, CT_NOWHERE,
        "the largest contact force, %g, is too large or not finite; the motion has diverged", top);
  if (plane) {
    push_plane(&grid, &sides[0], contact->axis);
    return CT_OK;
  }
  for (int s = 0; s < fixed->sides; s++)
    if (sides[s].fixed->kind == CT_SIDE_STATIONS)
      spread_stations(&grid, contact->solved, &sides[s], &sides[0]);
    else spread(&grid, contact->solved, &sides[s], ct_contact_other(contact, s));
  for (int s = 0; s < ct_gaps_surfaces(fixed); s++) // coarse and fine sums
    ct_pieces_sum(sides[s].pieces, sides[s].force, 6 * (int64_t)sides[s].search->node_count + 1);
  return CT_OK;
}
