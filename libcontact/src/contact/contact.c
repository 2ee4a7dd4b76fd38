/* The contact of two surfaces: both are slave once and master once (eq:contact-potential). */
#include <contact/contact.h>
#include <contact/sum.h>

#include "../error.h"
#include "../memory.h"
#include "../vector.h"
#include "contact_internal.h"

#include <math.h>
#include <string.h>

ct_contact_options ct_contact_options_default(void)
{
  return (ct_contact_options){.epsilon = 0.0, .method = CT_ROBUST, .tolerance = 1e-10, .depth = 0.0, .threads = 1};
}

double ct_contact_penalty(double beta, double young, double h) { return beta * young / h; }

void ct_contact_free(ct_contact *contact)
{
  if (contact == NULL) return;
  ct_side_clear(&contact->side[0]);
  ct_side_clear(&contact->side[1]);
  ct_release(contact->terms);
  ct_release(contact);
}

static ct_status check_options(const ct_contact_options *options, ct_error *error)
{
  if (!(options->epsilon > 0.0) || !isfinite(options->epsilon))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: the penalty must be positive, not %g", options->epsilon);
  if (!(options->tolerance > 0.0 && options->tolerance < 1.0))
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: a tolerance of %g", options->tolerance);
  if (!(options->depth >= 0.0) || !isfinite(options->depth) || options->threads < 1 || options->threads > CT_MOST_THREADS)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: depth %g, %d threads", options->depth, options->threads);
  if (ct_method_name(options->method) == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: there is no search method %d", (int)options->method);
  return CT_OK;
}

ct_status ct_contact_create(const ct_surface *a, const ct_surface *b, const ct_contact_options *options, ct_contact **out,
                            ct_error *error)
{
  if (a == NULL || b == NULL || options == NULL || out == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: null argument");
  ct_status status = check_options(options, error);
  if (status != CT_OK) return status;
  ct_contact *contact = ct_allocate(1, sizeof *contact);
  if (contact == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  contact->options = *options;
  status = ct_side_init(&contact->side[0], a, 0, error);
  if (status == CT_OK) status = ct_side_init(&contact->side[1], b, 1, error);
  if (status == CT_OK) {
    double size = fmax(contact->side[0].size, contact->side[1].size);
    contact->depth = options->depth > 0.0 ? options->depth : size;
    contact->skin = 0.5 * size;
    contact->terms = ct_allocate((size_t)ct_contact_point_count(contact), 3 * sizeof *contact->terms);
    if (contact->terms == NULL) status = ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for a contact");
  }
  if (status != CT_OK) {
    ct_contact_free(contact);
    return status;
  }
  *out = contact;
  return CT_OK;
}

/* Largest motion of a node since the last build of the candidate lists. */
static double motion(const ct_side *side)
{
  double top = 0.0;
  for (int64_t n = 0; n < side->node_count; n++) {
    double d[3];
    for (int c = 0; c < 3; c++) d[c] = side->x[3 * n + c] - side->x_built[3 * n + c];
    top = fmax(top, ct_vector_dot(d, d));
  }
  return sqrt(top);
}

/* List for each face of `side` the faces of `other` within `reach`. */
static ct_status list_candidates(ct_side *side, const ct_side *other, double reach, ct_error *error)
{
  int32_t count = 0;
  for (int32_t f = 0; f < side->face_count; f++) {
    ct_bounds box = side->boxes[f];
    for (int c = 0; c < 3; c++) {
      box.low[c] -= reach;
      box.high[c] += reach;
    }
    side->candidate_first[f] = count;
    int32_t found = ct_search_overlaps(other->search, &box, side->candidates + count, side->candidate_room - count);
    if (found > side->candidate_room - count) {
      int32_t room = 2 * (count + found) + 8 * side->face_count;
      int32_t *larger = ct_allocate((size_t)room, sizeof *larger);
      if (larger == NULL) return ct_fail(error, CT_ERROR_MEMORY, CT_NOWHERE, "no memory for contact candidates");
      if (count > 0) memcpy(larger, side->candidates, (size_t)count * sizeof *larger);
      ct_release(side->candidates);
      side->candidates = larger;
      side->candidate_room = room;
      f--; // once more, with room
      continue;
    }
    count += found;
  }
  side->candidate_first[side->face_count] = count;
  return CT_OK;
}

/* Build trees and candidate lists when the surfaces have moved by a part of the skin (eq:skin). */
static ct_status refresh_candidates(ct_contact *contact, ct_error *error)
{
  ct_side *a = &contact->side[0], *b = &contact->side[1];
  if (contact->built && motion(a) + motion(b) <= 0.25 * contact->skin) return CT_OK;
  for (int s = 0; s < 2; s++) {
    ct_side *side = &contact->side[s];
    ct_search_build(side->search, side->boxes);
    memcpy(side->x_built, side->x, 3 * (size_t)side->node_count * sizeof *side->x);
  }
  ct_status status = list_candidates(a, b, contact->depth + contact->skin, error);
  if (status == CT_OK) status = list_candidates(b, a, contact->depth + contact->skin, error);
  contact->built = status == CT_OK;
  return status;
}

/* Add the forces of one side's points to the nodes of both sides, in sums that do not depend on their order (eq:contact-force). */
static void spread(const ct_grid *grid, ct_side *side, ct_side *other)
{
  for (int64_t i = 0; i < (int64_t)side->face_count * side->rule.count; i++) {
    const ct_gauss_point *point = &side->points[i];
    if (!(point->gap < 0.0)) continue;
    const double *N = side->N[i % side->rule.count];
    for (int a = 0; a < side->per; a++) {
      int64_t node = 3 * (int64_t)side->faces[i / side->rule.count * side->per + a];
      for (int c = 0; c < 3; c++) ct_grid_add(grid, N[a] * point->force[c], &side->force[node + c], &side->force_fine[node + c]);
    }
    for (int a = 0; a < other->per; a++) {
      int64_t node = 3 * (int64_t)other->faces[(int64_t)point->other * other->per + a];
      for (int c = 0; c < 3; c++)
        ct_grid_add(grid, -(point->N[a] * point->force[c]), &other->force[node + c], &other->force_fine[node + c]);
    }
  }
}

static double largest_force(const ct_side *side)
{
  double top = 0.0;
  for (int64_t i = 0; i < (int64_t)side->face_count * side->rule.count; i++)
    for (int c = 0; c < 3; c++) top = fmax(top, fabs(side->points[i].force[c]));
  return top;
}

static ct_status collect_forces(ct_contact *contact, ct_error *error)
{
  ct_grid grid;
  double top = fmax(largest_force(&contact->side[0]), largest_force(&contact->side[1]));
  for (int s = 0; s < 2; s++) {
    size_t size = 3 * (size_t)contact->side[s].node_count * sizeof(double);
    memset(contact->side[s].force, 0, size);
    memset(contact->side[s].force_fine, 0, size);
  }
  if (top == 0.0) return CT_OK;
  // Shape functions of quadratic faces stay below 1 in size; a factor 2 is room enough.
  if (!ct_grid_init(&grid, 2.0 * top, 16 * ct_contact_point_count(contact)))
    return ct_fail(error, CT_ERROR_BLOWUP, CT_NOWHERE, "a contact force of %g", top);
  spread(&grid, &contact->side[0], &contact->side[1]);
  spread(&grid, &contact->side[1], &contact->side[0]);
  return CT_OK;
}

ct_status ct_contact_update(ct_contact *contact, const double *xa, const double *xb, ct_error *error)
{
  if (contact == NULL || xa == NULL || xb == NULL)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "contact: null argument");
  ct_status status = ct_side_move(&contact->side[0], xa, 0, error);
  if (status == CT_OK) status = ct_side_move(&contact->side[1], xb, 1, error);
  if (status == CT_OK) status = refresh_candidates(contact, error);
  if (status != CT_OK) return status;
  ct_pass_search(&contact->side[0], &contact->side[1], &contact->options, contact->depth);
  ct_pass_search(&contact->side[1], &contact->side[0], &contact->options, contact->depth);
  return collect_forces(contact, error);
}

ct_status ct_contact_add_force(const ct_contact *contact, double *fa, double *fb)
{
  if (contact == NULL || fa == NULL || fb == NULL) return CT_ERROR_ARGUMENT;
  for (int s = 0; s < 2; s++) {
    const ct_side *side = &contact->side[s];
    double *f = s == 0 ? fa : fb;
    for (int64_t n = 0; n < side->node_count; n++)
      for (int c = 0; c < 3; c++) f[3 * (int64_t)side->nodes[n] + c] += side->force[3 * n + c] + side->force_fine[3 * n + c];
  }
  return CT_OK;
}

double ct_contact_energy(const ct_contact *contact)
{
  if (contact == NULL) return NAN;
  int64_t count = 0;
  // -- Π = Σ ½ · ½ ε g² w J over the points inside, = ½ force · d (eq:contact-potential)
  for (int s = 0; s < 2; s++)
    for (int64_t i = 0; i < (int64_t)contact->side[s].face_count * contact->side[s].rule.count; i++)
      contact->terms[count++] = 0.5 * ct_vector_dot(contact->side[s].points[i].force, contact->side[s].points[i].d);
  return ct_sum(contact->terms, count);
}

ct_status ct_contact_resultant(const ct_contact *contact, double force_a[3], double moment_a[3], double force_b[3], double moment_b[3])
{
  if (contact == NULL || force_a == NULL || moment_a == NULL || force_b == NULL || moment_b == NULL) return CT_ERROR_ARGUMENT;
  for (int s = 0; s < 2; s++) {
    const ct_side *side = &contact->side[s];
    double *force = s == 0 ? force_a : force_b, *moment = s == 0 ? moment_a : moment_b;
    for (int c = 0; c < 3; c++) force[c] = moment[c] = 0.0;
    for (int64_t n = 0; n < side->node_count; n++) {
      double f[3], m[3];
      for (int c = 0; c < 3; c++) f[c] = side->force[3 * n + c] + side->force_fine[3 * n + c];
      ct_vector_cross(&side->x[3 * n], f, m);
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
  for (int s = 0; contact != NULL && s < 2; s++) count += (int64_t)contact->side[s].face_count * contact->side[s].rule.count;
  return count;
}

ct_status ct_contact_points(const ct_contact *contact, ct_contact_point *points)
{
  static const double zero[3] = {0.0, 0.0, 0.0};
  if (contact == NULL || points == NULL) return CT_ERROR_ARGUMENT;
  for (int s = 0; s < 2; s++) {
    const ct_side *side = &contact->side[s];
    for (int64_t i = 0; i < (int64_t)side->face_count * side->rule.count; i++, points++) {
      const ct_gauss_point *from = &side->points[i];
      int met = from->other >= 0;
      *points = (ct_contact_point){.side = s, .face = (int32_t)(i / side->rule.count), .gauss = (int32_t)(i % side->rule.count),
                                   .other = from->other, .gap = from->gap, .weight = side->weight[i]};
      ct_side_interpolate(side, points->face, side->N[points->gauss], zero, points->position);
      points->pressure = from->gap < 0.0 ? -contact->options.epsilon * from->gap : 0.0;
      for (int c = 0; c < 3; c++) points->closest[c] = met ? points->position[c] + from->d[c] : NAN;
      for (int c = 0; c < 2; c++) points->xi[c] = met ? from->xi[c] : NAN;
    }
  }
  return CT_OK;
}
