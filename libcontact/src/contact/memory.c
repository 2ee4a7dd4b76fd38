/* Memory of a contact from step to step, as doubles of a restart: a record of each point, one of
 * the whole, and the coordinates of the nodes of each surface, shape (node_count, 3). */
#include "contact_internal.h"

/* The record of the whole, after those of the points. */
typedef struct tail_record {
  double begun;  /* whether there was an earlier step */
  double stored; /* energy that all rows stored at the middle of that step */
  double time;   /* of that step */
  double work;   /* work of fading start gaps since t = 0 */
  ct_account account;
  double late, late_depth; /* points that were found inside after the start */
} tail_record;
enum { TAIL = sizeof(tail_record) / sizeof(double) };

int64_t ct_contact_fixed_memory(const ct_contact_fixed *fixed)
{
  int64_t count = CT_RECORD * fixed->gaps.point_count + TAIL;
  for (int s = 0; s < fixed->gaps.sides; s++)
    count += 3 * (int64_t)fixed->gaps.side[s].search->node_count;
  return count;
}

static tail_record load_tail(const ct_contact_fixed *fixed, const double *memory)
{
  tail_record tail;
  memcpy(&tail, &memory[CT_RECORD * fixed->gaps.point_count], sizeof tail);
  return tail;
}

int ct_contact_memory_begun(const ct_contact_fixed *fixed, const double *memory)
{
  return load_tail(fixed, memory).begun != 0.0;
}

const double *ct_points_load(ct_side *side, int32_t face_count, const double *memory)
{
  for (int64_t i = 0; i < side->fixed->point_count; i++, memory += CT_RECORD) {
    ct_point *point = &side->points[i];
    ct_point_record record;
    memcpy(&record, memory, sizeof record);
    int buried = record.status == CT_POINT_BURIED,
        met = !buried && record.other >= 1.0 && record.other <= (double)face_count;
    point->other = met ? (int32_t)record.other - 1 : -1;
    point->status = buried                             ? CT_POINT_BURIED
                    : !met                             ? CT_POINT_NEW
                    : record.status == CT_POINT_INSIDE ? CT_POINT_INSIDE
                                                       : CT_POINT_OUTSIDE;
    memcpy(point->xi, record.xi, sizeof point->xi);
    point->known = record.known;
    point->row.force = record.force;
    point->start = record.start;
    point->force_size = record.force_size;
    point->admitted = record.admitted;
    point->stored = record.stored;
  }
  return memory;
}

ct_status ct_contact_load(ct_contact *contact, const double *memory, ct_error *error)
{
  const tail_record tail = load_tail(contact->fixed, memory);
  for (int s = 0; s < contact->fixed->gaps.sides; s++)
    memory = ct_points_load(&contact->gaps.side[s],
                            ct_contact_other(contact, s)->search->face_count, memory);
  contact->gaps.begun = 1;
  contact->stored = tail.stored;
  contact->time = tail.time;
  contact->work = tail.work;
  contact->admission.account = tail.account;
  contact->admission.late = (int64_t)tail.late;
  contact->admission.late_depth = tail.late_depth;
  memory += TAIL;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    ct_search *search = contact->gaps.side[s].search;
    ct_status status = ct_search_check(search, NULL, memory, s, error);
    if (status != CT_OK) return status;
    memcpy(search->x, memory, 3 * (size_t)search->node_count * sizeof *memory);
    memory += 3 * (int64_t)search->node_count;
  }
  return CT_OK;
}

double *ct_points_store(const ct_side *side, double *memory)
{
  for (int64_t i = 0; i < side->fixed->point_count; i++, memory += CT_RECORD) {
    const ct_point *point = &side->points[i];
    const ct_point_record record = {.other = (double)point->other + 1.0,
                                    .status = point->status,
                                    .xi = {point->xi[0], point->xi[1]},
                                    .known = point->known,
                                    .force = point->row.force,
                                    .start = point->start,
                                    .force_size = point->force_size,
                                    .admitted = point->admitted,
                                    .stored = point->stored};
    memcpy(memory, &record, sizeof record);
  }
  return memory;
}

void ct_contact_store(const ct_contact *contact, double *memory)
{
  for (int s = 0; s < contact->fixed->gaps.sides; s++)
    memory = ct_points_store(&contact->gaps.side[s], memory);
  const tail_record tail = {1.0,
                            contact->stored,
                            contact->time,
                            contact->work,
                            contact->admission.account,
                            (double)contact->admission.late,
                            contact->admission.late_depth};
  memcpy(memory, &tail, sizeof tail);
  memory += TAIL;
  for (int s = 0; s < contact->fixed->gaps.sides; s++) {
    size_t count = 3 * (size_t)contact->gaps.side[s].search->node_count;
    memcpy(memory, contact->gaps.side[s].search->x, count * sizeof *memory);
    memory += count;
  }
}
