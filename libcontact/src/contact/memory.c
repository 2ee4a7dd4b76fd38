/* Memory of a contact from step to step, as doubles of a restart: a record of each point, one of
 * the whole, and the coordinates of the nodes of each surface, shape (node_count, 3). */
#include "contact_internal.h"

#include "../base/lanes.h"
#include "../constraint/law.h"

#include <stddef.h>

enum { WHOLE = sizeof(ct_contact_record) / sizeof(double) };

int64_t ct_contact_fixed_memory(const ct_contact_fixed *fixed)
{
  int64_t count = CT_RECORD * fixed->gaps.point_count + WHOLE;
  for (int s = 0; s < ct_gaps_surfaces(&fixed->gaps); s++)
    count += 3 * (int64_t)fixed->gaps.side[s].search->node_count;
  return count;
}

static ct_contact_record load_whole(const ct_contact_fixed *fixed, const double *memory)
{
  ct_contact_record record;
  memcpy(&record, &memory[CT_RECORD * fixed->gaps.point_count], sizeof record);
  return record;
}

int ct_contact_memory_begun(const ct_contact_fixed *fixed, const double *memory)
{
  return load_whole(fixed, memory).begun != 0.0;
}

/* Restore a point from its record. */
static void load_point(const double *memory, int32_t face_count, ct_point *point)
{
  ct_point_record record;
  memcpy(&record, memory, sizeof record);
  int buried = record.status == (double)CT_POINT_BURIED,
      met = !buried && record.other >= 1.0 && record.other <= (double)face_count;
  point->other = met ? (int32_t)record.other - 1 : -1;
  point->status = buried                                     ? CT_POINT_BURIED
                  : !met                                     ? CT_POINT_NEW
                  : record.status == (double)CT_POINT_INSIDE ? CT_POINT_INSIDE
                                                             : CT_POINT_OUTSIDE;
  memcpy(point->xi, record.xi, sizeof point->xi);
  point->known = record.known;
  point->row.force = record.force;
  point->start = record.start;
  point->force_size = record.force_size;
  point->admitted = record.admitted;
  point->row.impact = record.impact;
}

/* Restore the points of a side from their records, whose partners are `face_count` faces, of
 * another side unless that is null; return the place behind the records. */
static const double *load_points(ct_side *side, const ct_side *other, int32_t face_count,
                                 const double *memory)
{
  side->shifted = 1;
  for (ct_span run = {0}; ct_side_next(side, &run);)
    for (int64_t i = run.first; i < run.end; i++) {
      load_point(&memory[CT_RECORD * i], face_count, &side->points[i]);
      if (other != NULL && side->points[i].other >= 0) ct_side_meet(other, &side->points[i]);
    }
  return memory + CT_RECORD * side->fixed->point_count;
}

/* Number of faces of what the points of a side meet: 1 for an obstacle. */
static int32_t partner_count(ct_contact *contact, int s)
{
  const ct_side *side = &contact->gaps.side[s], *other = ct_contact_other(contact, s);
  if (other != NULL) return other->search->face_count;
  return side->fixed->kind == CT_SIDE_STATIONS ? side->search->face_count : 1;
}

ct_status ct_contact_load(ct_contact *contact, const double *memory, ct_error *error)
{
  contact->record = load_whole(contact->fixed, memory);
  contact->changed = 1;
  for (int s = 0; s < contact->gaps.fixed->sides; s++)
    memory = load_points(&contact->gaps.side[s], ct_contact_other(contact, s),
                         partner_count(contact, s), memory);
  contact->gaps.begun = 1;
  memory += WHOLE;
  for (int s = 0; s < ct_gaps_surfaces(contact->gaps.fixed); s++) {
    ct_search *search = contact->gaps.side[s].search;
    ct_status status = ct_search_check(search, NULL, memory, s, error);
    if (status != CT_OK) return status;
    memcpy(search->x, memory, 3 * (size_t)search->node_count * sizeof *memory);
    memory += 3 * (int64_t)search->node_count;
  }
  return CT_OK;
}

/* Copy four numbers. */
CT_INLINE void copy_four(const double *from, double *to)
{
  for (int i = 0; i < CT_QUAD_PARTS; i++) ((ct_quad *)to)[i] = ((const ct_quad *)from)[i];
}

/* A member between these, in points or in records, does not compile. */
#define FOLLOWS(type, member, first, count) \
  (offsetof(type, member) == offsetof(type, first) + (count) * sizeof(double))
typedef char
    members_follow_on_each_other[FOLLOWS(ct_point, force_size, known, 3) &&
                                         FOLLOWS(ct_point_record, force_size, known, 3) &&
                                         FOLLOWS(ct_point, row.impact.idle, row.force, 3) &&
                                         FOLLOWS(ct_point_record, impact.idle, force, 3)
                                     ? 1
                                     : -1];

/* Store a point; of a plain one only what differs from zero. */
CT_INLINE void store_point(int plain, const ct_point *point, ct_point_record *record)
{
  if (plain) {
    static const double none[4] = {0.0};
    copy_four(none, &record->other); // and status, xi
    copy_four(none, &record->known);
    record->other = 1.0;
    record->status = point->row.gap < 0.0 ? (double)CT_POINT_INSIDE : (double)CT_POINT_OUTSIDE;
    record->known = point->row.gap;
  } else {
    record->other = (double)point->other + 1.0;
    record->status = (double)(int)point->status;
    record->xi[0] = point->xi[0];
    record->xi[1] = point->xi[1];
    copy_four(&point->known, &record->known); // and start, admitted, force_size
  }
  copy_four(&point->row.force, &record->force); // and reserve, pressed, idle
  record->impact.stored = point->row.impact.stored;
  record->impact.release = point->row.impact.release;
}

/* Store the points of a side; returns the largest of some rows and of theirs. Inlined for plain
 * points and others. */
CT_INLINE ct_largest_row store_side(int plain, int64_t count, const ct_point *restrict point,
                                    ct_point_record *restrict record, ct_largest_row largest)
{
  double top = largest.force, least = -largest.debt;
  for (const ct_point *end = point + count; point < end; point++, record++) {
    store_point(plain, point, record);
    top = top > point->row.force ? top : point->row.force;
    least = least < point->row.impact.reserve ? least : point->row.impact.reserve;
  }
  return (ct_largest_row){.force = top, .debt = -least};
}

CT_CLONES
static ct_largest_row store_points(int plain, int64_t count, const ct_point *point,
                                   ct_point_record *record, ct_largest_row largest)
{
  return plain ? store_side(1, count, point, record, largest)
               : store_side(0, count, point, record, largest);
}

ct_largest_row ct_contact_store_points(const ct_contact *contact, double *memory)
{
  const int plain = ct_contact_is_plain(contact);
  ct_largest_row largest = {0.0, 0.0};
  for (int s = 0; s < contact->gaps.fixed->sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; ct_side_next(side, &run);)
      largest = store_points(plain, run.end - run.first, &side->points[run.first],
                             (ct_point_record *)(void *)&memory[CT_RECORD * run.first], largest);
    memory += CT_RECORD * side->fixed->point_count;
  }
  return largest;
}

void ct_contact_store(const ct_contact *contact, double *memory)
{
  memory += CT_RECORD * contact->fixed->gaps.point_count;
  memcpy(memory, &contact->record, sizeof contact->record);
  memory += WHOLE;
  for (int s = 0; s < ct_gaps_surfaces(contact->gaps.fixed); s++) {
    size_t count = 3 * (size_t)contact->gaps.side[s].search->node_count;
    memcpy(memory, contact->gaps.side[s].search->x, count * sizeof *memory);
    memory += count;
  }
}

/* The work of an obstacle's motion until one smaller step before, by the force whose part has acted
 * (eq:divided-work). */
static void divide_motion(const ct_contact *contact, double part, ct_contact_record *record)
{
  for (int c = 0; c < 3; c++)
    record->motion -= 0.5 * (1.0 - part) * contact->reaction[c] * contact->came[c];
}

void ct_contact_divide(const ct_contact *contact, double part, double *memory)
{
  ct_point_record *record = (ct_point_record *)(void *)memory;
  for (int s = 0; s < contact->gaps.fixed->sides; s++) {
    const ct_side *side = &contact->gaps.side[s];
    for (ct_span run = {0}; contact->solved && ct_side_next(side, &run);)
      for (int64_t i = run.first; i < run.end; i++)
        if (side->points[i].listed) ct_law_divide(&side->points[i].row, part, &record[i].impact);
    record += side->fixed->point_count;
  }
  if (contact->fixed->moves) divide_motion(contact, part, (ct_contact_record *)(void *)record);
}
