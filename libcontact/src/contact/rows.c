/* Points of a surface as rows of the constraint problem, and their forces at the nodes. */
#include "heap.h"
#include "contact_internal.h"

#include <libcontact/base.h>

#include "../constraint/law.h"
#include "../base/error.h"
#include "../base/stream.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

/* Whether the row of a point is listed: its force λ acts with λ N n on the point's own face and
 * with -λ N̄ n on the other (eq:constraint-force). */
static int list_point(const ct_contact *contact, const ct_side *other, ct_point *point)
{
  ct_constraint *row = &point->row;
  if ((other != NULL && point->other < 0) || isnan(row->gap) || isnan(row->normal[0]) ||
      !(row->gap <= contact->reach || ct_law_may_release(row)))
    return 0;
  row->came = -point->closed;
  row->moved = -point->closing;
  if (other != NULL) {
    row->other_count = other->search->per;
    row->other = ct_side_row_nodes(other->fixed, point->other);
  } else {
    row->came -= ct_vector_dot(row->normal, contact->came);
    row->moved -= ct_vector_dot(row->normal, contact->coming);
  }
  return 1;
}

int64_t ct_contact_list_rows(ct_contact *contact, double dt, ct_constraint **rows)
{
  int64_t count = 0;
  for (int s = 0; s < contact->gaps.fixed->sides; s++) {
    const ct_side *side = &contact->gaps.side[s], *other = ct_contact_other(contact, s);
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
      p->listed = list_point(contact, other, p);
      if (p->listed) rows[count++] = &p->row;
      else ct_law_leave(&p->row, dt);
    }
  }
  return count;
}

void ct_side_take_rows(ct_side *side)
{
  for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++)
    // -- F = λ n (eq:constraint-force)
    for (int c = 0; c < 3; c++) p->force[c] = p->listed ? p->row.force * p->row.normal[c] : 0.0;
}

void ct_side_apply_penalty(ct_side *side)
{
  for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
    const double *n = p->row.normal, k = p->row.stiffness;
    int inside = p->other >= 0 && p->row.gap < 0.0,
        counted = inside && p->shift != 0.0 && !isnan(n[0]);
    // -- Force of the point, k d where it is inside
    for (int c = 0; c < 3; c++)
      p->force[c] = counted ? -k * p->row.gap * n[c]
                    // (eq:contact-force, eq:obstacle-force)
                    : inside && p->shift == 0.0 ? k * p->d[c]
                                                : 0.0;
  }
}

/* Energy of a point with the force F: ½ k g², written as ½ F · d, with a start gap as -½ |F| g. */
static double potential_of(const ct_point *p)
{
  const double *F = p->force;
  if (p->shift != 0.0) return -0.5 * sqrt(ct_vector_dot(F, F)) * p->row.gap;
  // -- One term of the potential (eq:contact-potential, eq:obstacle-potential)
  return 0.5 * ct_vector_dot(F, p->d);
}

double ct_side_potential(const ct_side *sides, int count)
{
  ct_stream sum = {.pieces = sides[0].pieces};
  while (ct_stream_again(&sum, 1))
    for (int s = 0; s < count; s++)
      for (const ct_point *p = sides[s].points; p < sides[s].points + sides[s].fixed->point_count;
           p++) {
        const double term = potential_of(p);
        ct_stream_add(&sum, &term, 1);
      }
  return ct_stream_sum(&sum);
}

/* Parts of the energy of a point: of its row, if it is listed, and what it holds. */
static double lag_of(const ct_point *p) { return p->listed ? ct_law_lag(&p->row) : 0.0; }
static double start_of(const ct_point *p) { return p->listed ? ct_law_start(&p->row) : 0.0; }
static double reserve_of(const ct_point *p) { return fmax(p->row.impact.reserve, 0.0); }
static double debt_of(const ct_point *p) { return fmax(-p->row.impact.reserve, 0.0); }
static double stored_of(const ct_point *p) { return p->row.impact.stored + reserve_of(p); }

/* Σ of one part of the energy over all points. */
static double sum_energy(ct_contact *contact, double (*part)(const ct_point *point))
{
  int64_t some = 0;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (const ct_point *p = side->points; p < side->points + side->fixed->point_count; p++) {
      contact->terms[some] = part(p);
      some += contact->terms[some] != 0.0;
    }
  }
  return ct_sum_over(contact->gaps.side[0].pieces, contact->terms, some);
}

/* Pay what points owe from what others hold, in the same proportion (eq:impact-debt). */
static void pay_debts(ct_contact *contact)
{
  const double debt = sum_energy(contact, debt_of);
  const double held = debt > 0.0 ? sum_energy(contact, reserve_of) : 0.0;
  if (!(held > 0.0)) return;
  // -- P = min(H, B), K ← K (1 - P / H) or K (1 - P / B) (eq:impact-debt)
  const double paid = fmin(debt, held), keep = 1.0 - paid / held, owe = 1.0 - paid / debt;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_point *p = side->points; p < side->points + side->fixed->point_count; p++)
      p->row.impact.reserve *= p->row.impact.reserve > 0.0 ? keep : owe;
  }
}

void ct_contact_count_energy(ct_contact *contact, double time)
{
  if (contact->fixed->law.restitution > 0.0) {
    pay_debts(contact);
    contact->reserve = sum_energy(contact, reserve_of);
  }
  const double before = contact->record.stored, after = sum_energy(contact, stored_of);
  // -- What was stored in the step before belongs to the partners of then, so it is not computed
  // again (eq:controlled-energy)
  contact->energy = time == 0.0 ? sum_energy(contact, start_of)
                                : 0.5 * (before + after) + sum_energy(contact, lag_of);
  contact->record.stored = after;
}

static ct_heap heap_of(const ct_side *side)
{
  return (ct_heap){side->force, side->force_fine, side->search->per, NULL, {0}, {0}};
}

static const int32_t *nodes_of(const ct_search *search, int32_t face)
{
  return &search->faces[(int64_t)face * search->per];
}

/* Add the forces of the points of a face, one by one, and what acts against them on the other side.
 */
CT_INLINE void spread_points(int stride, const ct_grid *grid, const ct_side *side, int32_t face,
                             const ct_side *other, ct_heap *own, ct_heap *theirs)
{
  const ct_point *point = &side->points[(int64_t)face * side->fixed->rule.count];
  for (int q = 0; q < side->fixed->rule.count; q++, point++) {
    if (!ct_point_has_force(point)) continue;
    // -- N_a F on the own face, -N̄_b F on the other (eq:contact-force)
    const double back[3] = {-point->force[0], -point->force[1], -point->force[2]};
    ct_heap_add(stride, grid, nodes_of(side->search, face), side->fixed->N[q], point->force, own);
    if (other != NULL)
      ct_heap_add(stride, grid, nodes_of(other->search, point->other), point->N, back, theirs);
  }
}

/* Whether the points of a face are the four of a 2 x 2 rule, have forces, and meet one face. */
CT_INLINE int are_four(const ct_side *side, const ct_point *point)
{
  int four = side->fixed->rule.count == 4;
  for (int q = 0; four && q < 4; q++)
    four = ct_point_has_force(&point[q]) && point[q].other == point[0].other;
  return four;
}

/* The same as `spread_points` for such points, together. */
CT_INLINE void spread_four(int stride, const ct_grid *grid, const ct_side *side, int32_t face,
                           const ct_side *other, ct_heap *own, ct_heap *theirs)
{
  const ct_point *point = &side->points[4 * (int64_t)face];
  const double *N[4], *N_bar[4], *force[4], *against[4];
  double back[4][3];
  for (int q = 0; q < 4; q++) {
    for (int c = 0; c < 3; c++) back[q][c] = -point[q].force[c];
    N[q] = side->fixed->N[q], N_bar[q] = point[q].N;
    force[q] = point[q].force, against[q] = back[q];
  }
  ct_heap_add_four(stride, grid, nodes_of(side->search, face), N, force, own);
  if (other != NULL)
    ct_heap_add_four(stride, grid, nodes_of(other->search, point->other), N_bar, against, theirs);
}

CT_INLINE void spread_faces(int stride, const ct_grid *grid, ct_side *side, ct_side *other)
{
  ct_heap own = heap_of(side), theirs = heap_of(other == NULL ? side : other);
  for (int32_t face = 0; face < side->search->face_count; face++)
    if (are_four(side, &side->points[(int64_t)face * side->fixed->rule.count]))
      spread_four(stride, grid, side, face, other, &own, &theirs);
    else spread_points(stride, grid, side, face, other, &own, &theirs);
  ct_heap_bring(stride, &own, NULL);
  ct_heap_bring(stride, &theirs, NULL);
}

/* Add the forces of one side's points to its nodes and, unless it is null, to those of the other
 * side, in sums that do not depend on their order (eq:contact-force). */
CT_CLONES
static void spread(const ct_grid *grid, ct_side *side, ct_side *other)
{
  if (side->search->per <= 4 && (other == NULL || other->search->per <= 4))
    spread_faces(4, grid, side, other);
  else spread_faces(8, grid, side, other);
}

/* Add the forces of an obstacle's stations to the nodes of its surface. */
static void spread_stations(const ct_grid *grid, const ct_side *stations, ct_side *surface)
{
  ct_heap heap = heap_of(surface);
  for (int64_t i = 0; i < stations->fixed->point_count; i++) {
    const ct_point *point = &stations->points[i];
    if (!ct_point_has_force(point)) continue;
    ct_heap_add(8, grid, nodes_of(surface->search, point->other), point->N, point->force, &heap);
  }
  ct_heap_bring(8, &heap, NULL);
}

static double largest_force(const ct_side *side)
{
  double top = 0.0;
  for (int64_t i = 0; i < side->fixed->point_count; i++)
    for (int c = 0; c < 3; c++) {
      double size = fabs(side->points[i].force[c]);
      if (size > top) top = size;
    }
  return top;
}

ct_status ct_contact_collect(ct_contact *contact, ct_error *error)
{
  const ct_gaps_fixed *fixed = contact->gaps.fixed;
  ct_side *sides = contact->gaps.side;
  ct_grid grid;
  double top = 0.0;
  for (int s = 0; s < fixed->sides; s++) top = fmax(top, largest_force(&sides[s]));
  for (int s = 0; s < ct_gaps_surfaces(fixed); s++) {
    size_t size = 3 * (size_t)sides[s].search->node_count * sizeof(double);
    memset(sides[s].force, 0, size);
    memset(sides[s].force_fine, 0, size);
  }
  ct_pieces_largest(sides[0].pieces, &top, 1);
  if (top == 0.0) return CT_OK;
  // Shape functions of quadratic faces are below 1 in size; the factor 2 is a margin.
  const int64_t terms = (ct_contact_is_rigid(contact->fixed) ? 8 : 16) * fixed->point_count;
  if (!ct_grid_init(&grid, 2.0 * top, terms))
    return ct_fail(
        error, CT_ERROR_BLOWUP, CT_NOWHERE,
        "the largest contact force, %g, is too large or not finite; the motion has diverged", top);
  for (int s = 0; s < fixed->sides; s++)
    if (sides[s].fixed->kind == CT_SIDE_STATIONS) spread_stations(&grid, &sides[s], &sides[0]);
    else spread(&grid, &sides[s], ct_contact_other(contact, s));
  for (int s = 0; s < ct_gaps_surfaces(fixed); s++) {
    ct_pieces_sum(sides[s].pieces, sides[s].force, 3 * (int64_t)sides[s].search->node_count);
    ct_pieces_sum(sides[s].pieces, sides[s].force_fine, 3 * (int64_t)sides[s].search->node_count);
  }
  return CT_OK;
}
