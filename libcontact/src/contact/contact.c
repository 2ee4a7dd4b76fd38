/* The contact of two surfaces: both are slave once and master once (eq:contact-potential). */
#include <libcontact/contact.h>
#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/lanes.h"
#include "../base/memory.h"
#include "../base/stream.h"
#include "../base/vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

ct_contact_options ct_contact_options_default(void)
{
  return (ct_contact_options){.epsilon = 0.0,
                              .method = CT_ROBUST,
                              .tolerance = 1e-10,
                              .depth = 0.0,
                              .threads = 1,
                              .distant = 1,
                              .enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                              .dissipation = 0.1,
                              .initial = CT_INITIAL_KEEP};
}

double ct_contact_penalty(double beta, double young, double h) { return beta * young / h; }

void ct_contact_free(ct_contact *contact)
{
  if (contact == NULL) return;
  for (int s = 0; s < contact->sides; s++) ct_side_clear(&contact->side[s]);
  ct_release(contact->terms);
  ct_release(contact);
}

static ct_status check_options(const ct_contact_options *options, ct_error *error)
{
  if (!(options->epsilon > 0.0) || !isfinite(options->epsilon))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: the penalty must be positive, not %g", options->epsilon);
  if (!(options->tolerance > 0.0 && options->tolerance < 1.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: a tolerance of %g",
                   options->tolerance);
  if (!(options->depth >= 0.0) || !isfinite(options->depth) || options->threads < 1 ||
      options->threads > CT_MOST_THREADS)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: depth %g, %d threads",
                   options->depth, options->threads);
  if (options->initial < CT_INITIAL_PUSH || options->initial > CT_INITIAL_REMOVE ||
      (options->initial == CT_INITIAL_REMOVE && !(options->removal > 0.0)))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: initial penetration %d with removal in %g", (int)options->initial,
                   options->removal);
  if (!(options->adjust >= 0.0) || !isfinite(options->adjust))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: gaps and overlaps up to %g to be adjusted", options->adjust);
  if (options->points != CT_POINTS_GAUSS && options->points != CT_POINTS_LOBATTO)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: there is no rule of points %d",
                   (int)options->points);
  if (ct_method_name(options->method) == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: there is no search method %d",
                   (int)options->method);
  if (ct_enforcement_name(options->enforcement) == NULL ||
      !(options->dissipation >= 0.0 && options->dissipation <= 1.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                   "contact: enforcement %d with dissipation %g", (int)options->enforcement,
                   options->dissipation);
  return CT_OK;
}

/* Largest motion of a node since the last build of the candidate lists. */
static double motion(const ct_side *side)
{
  double top = 0.0;
  for (int64_t n = 0; n < side->search->node_count; n++) {
    double d[3];
    for (int c = 0; c < 3; c++) d[c] = side->search->x[3 * n + c] - side->x_built[3 * n + c];
    double square = ct_vector_dot(d, d);
    if (square > top) top = square;
  }
  return sqrt(top);
}

/* Leave out of a list of faces those that share a node with `face`, itself among them; answers how
 * many stay (eq:self-adjacent). */
static int32_t drop_adjacent(const ct_side *side, int32_t face, int32_t *list, int32_t count)
{
  int32_t kept = 0;
  for (int32_t i = 0; i < count; i++)
    if (!ct_search_adjacent(side->search, face, list[i])) list[kept++] = list[i];
  return kept;
}

static ct_bounds grown(const ct_bounds *box, double reach)
{
  ct_bounds larger = *box;
  for (int c = 0; c < 3; c++) {
    larger.low[c] -= reach;
    larger.high[c] += reach;
  }
  return larger;
}

/* List for each face of `side` the faces of `other` within the distance to which its list is to be
 * complete, and the skin. */
static ct_status list_candidates(ct_side *side, const ct_side *other, double skin, ct_error *error)
{
  int32_t count = 0;
  for (int32_t f = 0; f < side->search->face_count; f++) {
    ct_bounds box = grown(&side->search->boxes[f], side->listed[f] + skin);
    side->candidate_first[f] = count;
    int32_t found = ct_box_tree_overlaps(other->search->tree, other->search->boxes, &box,
                                         side->candidates + count, side->candidate_room - count);
    if (found > side->candidate_room - count) {
      int32_t room = 2 * (count + found) + 8 * side->search->face_count;
      int32_t *larger = ct_allocate((size_t)room, sizeof *larger);
      if (larger == NULL)
        return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for contact candidates");
      if (count > 0) memcpy(larger, side->candidates, (size_t)count * sizeof *larger);
      ct_release(side->candidates);
      side->candidates = larger;
      side->candidate_room = room;
      f--; // once more, with room
      continue;
    }
    count += side == other ? drop_adjacent(side, f, side->candidates + count, found) : found;
  }
  side->candidate_first[side->search->face_count] = count;
  return CT_OK;
}

/* Whether the box of some face of `side` comes within `reach` of one of `other`; faces that share a
 * node do not count. */
static int anything_within(const ct_side *side, const ct_side *other, double reach)
{
  enum { ROOM = 64 };
  int32_t list[ROOM];
  for (int32_t f = 0; f < side->search->face_count; f++) {
    ct_bounds box = grown(&side->search->boxes[f], reach);
    int32_t found =
        ct_box_tree_overlaps(other->search->tree, other->search->boxes, &box, list, ROOM);
    if (found > ROOM || (side == other ? drop_adjacent(side, f, list, found) : found) > 0) return 1;
  }
  return 0;
}

/* Find how far the surfaces are from touching: what is free beyond the depth, twice the skin, four
 * times, ... while nothing is there. */
static void measure_clear(ct_contact *contact)
{
  enum { DOUBLINGS = 40 };
  const ct_side *a = &contact->side[0], *b = &contact->side[contact->sides - 1];
  contact->clear = 0.0;
  if (!contact->options.distant ||
      a->candidate_first[a->search->face_count] + b->candidate_first[b->search->face_count] > 0)
    return;
  contact->clear = contact->skin;
  for (int i = 0; i < DOUBLINGS && !anything_within(a, b, contact->near + 2.0 * contact->clear);
       i++)
    contact->clear *= 2.0;
}

/* Whether a point was in contact in the last update: however deep it is, it is not given up
 * (eq:held). */
static int holds(const ct_side *side)
{
  for (int64_t i = 0; i < ct_side_point_count(side); i++)
    if (side->points[i].history == CT_POINT_INSIDE) return 1;
  return 0;
}

/* Whether no point is in contact or can have come into the depth of a face since the lists were
 * made: the box of a linear face moves at most as far as its nodes, that of a quadratic one seven
 * times as far (eq:contact-clear). */
static int still_distant(const ct_contact *contact)
{
  if (!contact->built || !contact->begun || contact->clear == 0.0) return 0;
  const ct_side *a = &contact->side[0], *b = &contact->side[contact->sides - 1];
  double part =
      a->search->per > a->search->edges || b->search->per > b->search->edges ? 0.125 : 0.9;
  return motion(a) + motion(b) <= part * contact->clear && !holds(a) && !holds(b);
}

/* How deep a point was that was in contact in the last update, else 0. */
static double depth_of(const ct_gauss_point *point)
{
  return point->history == CT_POINT_INSIDE ? -point->known : 0.0;
}

/* Whether the lists reach as deep as every point that was in contact in the last update can have
 * come since, a step of `near` deeper (eq:passage). */
static int reaches_deepest(const ct_side *side, double near)
{
  for (int64_t i = 0; i < ct_side_point_count(side); i++)
    if (depth_of(&side->points[i]) > 0.0 &&
        depth_of(&side->points[i]) + near > side->listed[i / side->rule.count])
      return 0;
  return 1;
}

/* How far the list of each face has to reach: as far as points look, and deeper than its own points
 * in contact can come soon. */
static void set_reach(ct_side *side, double depth, double near)
{
  for (int32_t f = 0; f < side->search->face_count; f++) side->listed[f] = depth;
  for (int64_t i = 0; i < ct_side_point_count(side); i++) {
    double *listed = &side->listed[i / side->rule.count], deep = depth_of(&side->points[i]);
    if (deep > 0.0) *listed = fmax(*listed, 1.5 * (deep + near));
  }
}

/* How far points look now. At the start nobody knows how deep two surfaces begin in each other, or
 * how far apart they are; afterwards a point that comes in has been near before (eq:contact-near).
 */
static double look_depth(const ct_contact *contact)
{
  return contact->start || (!contact->begun && contact->sides == 2) ? contact->depth
                                                                    : contact->near;
}

/* Refit trees and list candidates when the surfaces have moved by a part of the skin (eq:skin). */
static ct_status refresh_candidates(ct_contact *contact, ct_error *error)
{
  ct_side *a = &contact->side[0], *b = &contact->side[contact->sides - 1];
  if (contact->built && contact->begun && reaches_deepest(a, contact->near) &&
      reaches_deepest(b, contact->near) && motion(a) + motion(b) <= 0.25 * contact->skin)
    return CT_OK;
  for (int s = 0; s < contact->sides; s++) {
    ct_side *side = &contact->side[s];
    ct_search_refit(side->search);
    memcpy(side->x_built, side->search->x,
           3 * (size_t)side->search->node_count * sizeof *side->search->x);
    set_reach(side, look_depth(contact), contact->near);
  }
  ct_status status = list_candidates(a, b, contact->skin, error);
  if (status == CT_OK && a != b) status = list_candidates(b, a, contact->skin, error);
  contact->built = status == CT_OK && contact->begun && !contact->start;
  if (contact->built) measure_clear(contact);
  return status;
}

/* A surface in contact with itself remembers its reference shape (eq:self-depth). */
static ct_status keep_reference(ct_side *side, ct_error *error)
{
  size_t size = 3 * (size_t)side->search->node_count * sizeof *side->reference;
  side->reference = ct_allocate(size, 1);
  if (side->reference == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  memcpy(side->reference, side->search->x, size);
  return CT_OK;
}

/* A contact of `sides` surfaces: two, or one with itself. */
static ct_status create(const ct_surface *const surface[2], int sides,
                        const ct_contact_options *options, ct_contact **out, ct_error *error)
{
  ct_status status = check_options(options, error);
  if (status != CT_OK) return status;
  ct_contact *contact = ct_allocate(1, sizeof *contact);
  if (contact == NULL)
    return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  double size = 0.0;
  contact->options = *options;
  contact->one_array = surface[0]->reference == surface[1]->reference;
  for (int s = 0; s < sides && status == CT_OK; s++) {
    status =
        ct_side_init(&contact->side[s], surface[s], s, options->points == CT_POINTS_LOBATTO, error);
    if (status != CT_OK) break;
    contact->sides = s + 1;
    size = fmax(size, contact->side[s].search->size);
  }
  if (status == CT_OK) {
    contact->depth = options->depth > 0.0 ? options->depth : size;
    if (options->adjust > contact->depth)
      status = ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE,
                       "contact: surfaces are searched for each other up to the depth %g only, so "
                       "adjust = %g is too much",
                       contact->depth, options->adjust);
  }
  if (status == CT_OK) {
    contact->terms = ct_allocate((size_t)ct_contact_point_count(contact), sizeof *contact->terms);
    if (contact->terms == NULL)
      status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  }
  if (status == CT_OK && sides == 1) status = keep_reference(&contact->side[0], error);
  if (status != CT_OK) {
    ct_contact_free(contact);
    return status;
  }
  ct_passage_init(contact);
  *out = contact;
  return CT_OK;
}

ct_status ct_contact_create(const ct_surface *a, const ct_surface *b,
                            const ct_contact_options *options, ct_contact **out, ct_error *error)
{
  if (a == NULL || b == NULL || options == NULL || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: null argument");
  const ct_surface *surface[2] = {a, b};
  return create(surface, 2, options, out, error);
}

ct_status ct_contact_create_self(const ct_surface *surface, const ct_contact_options *options,
                                 ct_contact **out, ct_error *error)
{
  if (surface == NULL || options == NULL || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: null argument");
  const ct_surface *both[2] = {surface, surface};
  return create(both, 1, options, out, error);
}

/* Sums at the nodes of one face, before they come to those of the surface: three components a node.
 */
typedef struct heap {
  int32_t face; /* -1: nothing is in it */
  double coarse[24], fine[24];
} heap;

/* Bring what a heap holds to the nodes of its face, and begin with another face. These are inlined
 * with `per` known, 4 or as many as there may be. */
CT_INLINE void bring(int per, ct_side *side, heap *sums, int32_t next)
{
  const ct_search *search = side->search;
  for (int a = 0; sums->face >= 0 && a < search->per; a++) {
    int64_t node = 3 * (int64_t)search->faces[(int64_t)sums->face * search->per + a];
    for (int c = 0; c < 3; c++) {
      side->force[node + c] += sums->coarse[3 * a + c];
      side->force_fine[node + c] += sums->fine[3 * a + c];
    }
  }
  sums->face = next;
  for (int i = 0; i < 3 * per; i++) sums->coarse[i] = sums->fine[i] = 0.0;
}

/* Add a force at a point of `face` to its heap. The grid makes all sums exact, so it does not
 * matter that they are made by parts. */
CT_INLINE void push(int per, const ct_grid *grid, ct_side *side, int32_t face, const double N[8],
                    const double force[3], heap *sums)
{
  double x[24];
  if (face != sums->face) bring(per, side, sums, face);
  for (int a = 0; a < per; a++)
    for (int c = 0; c < 3; c++) x[3 * a + c] = N[a] * force[c];
#pragma omp simd
  for (int i = 0; i < 3 * per; i++) ct_grid_add(grid, x[i], &sums->coarse[i], &sums->fine[i]);
}

CT_INLINE void spread_faces(int per, const ct_grid *grid, ct_side *side, ct_side *other)
{
  heap own = {.face = -1}, theirs = {.face = -1};
  const ct_gauss_point *point = side->points;
  for (int32_t face = 0; face < side->search->face_count; face++)
    for (int q = 0; q < side->rule.count; q++, point++) {
      if (!ct_point_presses(point)) continue;
      const double back[3] = {-point->force[0], -point->force[1], -point->force[2]};
      push(per, grid, side, face, side->N[q], point->force, &own);
      push(per, grid, other, point->other, point->N, back, &theirs);
    }
  bring(per, side, &own, -1);
  bring(per, other, &theirs, -1);
}

/* Add the forces of one side's points to the nodes of both sides, in sums that do not depend on
 * their order (eq:contact-force). */
CT_CLONES
static void spread(const ct_grid *grid, ct_side *side, ct_side *other)
{
  if (side->search->per <= 4 && other->search->per <= 4) spread_faces(4, grid, side, other);
  else spread_faces(8, grid, side, other);
}

static double largest_force(const ct_side *side)
{
  double top = 0.0;
  for (int64_t i = 0; i < ct_side_point_count(side); i++)
    for (int c = 0; c < 3; c++) {
      double size = fabs(side->points[i].force[c]);
      if (size > top) top = size;
    }
  return top;
}

ct_status ct_contact_collect(ct_contact *contact, ct_error *error)
{
  ct_grid grid;
  double top = 0.0;
  for (int s = 0; s < contact->sides; s++) {
    top = fmax(top, largest_force(&contact->side[s]));
    size_t size = 3 * (size_t)contact->side[s].search->node_count * sizeof(double);
    memset(contact->side[s].force, 0, size);
    memset(contact->side[s].force_fine, 0, size);
  }
  if (top == 0.0) return CT_OK;
  // Shape functions of quadratic faces stay below 1 in size; a factor 2 is room enough.
  if (!ct_grid_init(&grid, 2.0 * top, 16 * ct_contact_point_count(contact)))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE, "a contact force of %g", top);
  for (int s = 0; s < contact->sides; s++)
    spread(&grid, &contact->side[s], &contact->side[contact->sides - 1 - s]);
  return CT_OK;
}

/* Gaps of all points, and the forces of the penalty. */
ct_status ct_contact_measure(ct_contact *contact, const double *xa, const double *xb,
                             ct_error *error)
{
  if (contact == NULL || xa == NULL || (xb == NULL && contact->sides == 2))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: null argument");
  const double *x[2] = {xa, xb};
  ct_status status = CT_OK;
  // Nothing moves before all is good: after a refusal, what moves counts from the last good call
  // still.
  for (int s = 0; s < contact->sides && status == CT_OK; s++)
    status = ct_search_check(contact->side[s].search, x[s], s, error);
  if (status != CT_OK) return status;
  for (int s = 0; s < contact->sides; s++) ct_side_place(&contact->side[s], x[s]);
  if (still_distant(contact)) {
    // No point has a face, as in the last call; a host may have set some since then, from an older
    // state.
    for (int s = 0; s < contact->sides; s++)
      for (int64_t i = 0; i < ct_side_point_count(&contact->side[s]); i++) {
        ct_gauss_point *point = &contact->side[s].points[i];
        point->other = -1;
        point->known = NAN;
        if (point->history != CT_POINT_BURIED) point->history = CT_POINT_NEW;
      }
    return CT_OK;
  }
  for (int s = 0; s < contact->sides; s++) ct_search_box(contact->side[s].search);
  status = refresh_candidates(contact, error);
  if (status != CT_OK) return status;
  for (int s = 0; s < contact->sides; s++)
    ct_pass_search(&contact->side[s], &contact->side[contact->sides - 1 - s], &contact->options,
                   look_depth(contact), contact->depth, !contact->begun);
  contact->begun = 1;
  return CT_OK;
}

ct_status ct_contact_update(ct_contact *contact, const double *xa, const double *xb,
                            ct_error *error)
{
  ct_status status = ct_contact_measure(contact, xa, xb, error);
  return status == CT_OK ? ct_contact_collect(contact, error) : status;
}

ct_status ct_contact_add_force(const ct_contact *contact, double *fa, double *fb)
{
  if (contact == NULL || fa == NULL || (fb == NULL && contact->sides == 2))
    return CT_ERROR_ARGUMENT;
  for (int s = 0; s < contact->sides; s++) {
    const ct_side *side = &contact->side[s];
    double *f = s == 0 ? fa : fb;
    for (int64_t n = 0; n < side->search->node_count; n++)
      for (int c = 0; c < 3; c++)
        f[3 * (int64_t)side->search->nodes[n] + c] +=
            side->force[3 * n + c] + side->force_fine[3 * n + c];
  }
  return CT_OK;
}

double ct_contact_energy(const ct_contact *contact)
{
  if (contact == NULL) return NAN;
  ct_stream sum = {0};
  double terms[27];
  // -- Π = Σ ½ · ½ ε g² w J over the points inside, = ½ force · d; with a start gap -½ |force| g
  // (eq:contact-potential)
  while (ct_stream_again(&sum, 1))
    for (int s = 0; s < contact->sides; s++)
      for (int32_t face = 0; face < contact->side[s].search->face_count; face++) {
        const ct_gauss_point *point =
            &contact->side[s].points[(int64_t)face * contact->side[s].rule.count];
        for (int q = 0; q < contact->side[s].rule.count; q++, point++) {
          const double *f = point->force;
          terms[q] = point->shift == 0.0 ? 0.5 * ct_vector_dot(f, point->d)
                                         : -0.5 * sqrt(ct_vector_dot(f, f)) * point->gap;
        }
        ct_stream_add(&sum, terms, contact->side[s].rule.count);
      }
  return ct_stream_sum(&sum);
}

ct_status ct_contact_resultant(const ct_contact *contact, double force_a[3], double moment_a[3],
                               double force_b[3], double moment_b[3])
{
  if (contact == NULL || force_a == NULL || moment_a == NULL ||
      (contact->sides == 2 && (force_b == NULL || moment_b == NULL)))
    return CT_ERROR_ARGUMENT;
  for (int s = 0; s < contact->sides; s++) {
    const ct_side *side = &contact->side[s];
    double *force = s == 0 ? force_a : force_b, *moment = s == 0 ? moment_a : moment_b;
    for (int c = 0; c < 3; c++) force[c] = moment[c] = 0.0;
    for (int64_t n = 0; n < side->search->node_count; n++) {
      double f[3], m[3];
      for (int c = 0; c < 3; c++) f[c] = side->force[3 * n + c] + side->force_fine[3 * n + c];
      ct_vector_cross(&side->search->x[3 * n], f, m);
      for (int c = 0; c < 3; c++) {
        force[c] += f[c];
        moment[c] += m[c];
      }
    }
  }
  return CT_OK;
}

int64_t ct_contact_point_count(const ct_contact *contact)
{
  int64_t count = 0;
  for (int s = 0; contact != NULL && s < contact->sides; s++)
    count += ct_side_point_count(&contact->side[s]);
  return count;
}

ct_status ct_contact_points(const ct_contact *contact, ct_contact_point *points)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  if (contact == NULL || points == NULL) return CT_ERROR_ARGUMENT;
  for (int s = 0; s < contact->sides; s++) {
    const ct_side *side = &contact->side[s];
    for (int64_t i = 0; i < ct_side_point_count(side); i++, points++) {
      const ct_gauss_point *from = &side->points[i];
      int met = from->other >= 0;
      *points = (ct_contact_point){.side = s,
                                   .face = (int32_t)(i / side->rule.count),
                                   .gauss = (int32_t)(i % side->rule.count),
                                   .other = from->other,
                                   .gap = from->gap,
                                   .weight = side->weight[i],
                                   .start_gap = met ? from->shift : 0.0};
      ct_side_interpolate(side, points->face, side->N[points->gauss], zero, points->position);
      // No law pulls, so the pressure is the size of the force.
      points->pressure = sqrt(ct_vector_dot(from->force, from->force)) / (0.5 * side->weight[i]);
      for (int c = 0; c < 3; c++) points->closest[c] = met ? points->position[c] + from->d[c] : NAN;
      for (int c = 0; c < 2; c++) points->xi[c] = met ? from->xi[c] : NAN;
    }
  }
  return CT_OK;
}
