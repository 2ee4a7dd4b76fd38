/* What a host's contact stores from step to step, as doubles of a restart. */
#include "host.h"

#include "../base/error.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

int64_t ct_contact_save(const ct_contact *contact, double *memory)
{
  if (contact == NULL) return 0;
  const ct_host *h = contact->host;
  int64_t count = CT_HOST_RECORD + contact->fixed->is.memory_count;
  for (const ct_host_part *part = h == NULL ? NULL : h->contact.next; part != NULL;
       part = part->next)
    count += part->is->memory_count;
  if (memory != NULL && h != NULL && h->open)
    memcpy(memory, h->memory, (size_t)count * sizeof *memory);
  else if (memory != NULL) memset(memory, 0, (size_t)count * sizeof *memory);
  return count;
}

/* Whether all numbers are finite, except that the distance in the records of points, which end at
 * `records`, may be unknown. */
static int are_finite(const double *memory, int64_t records, int64_t count)
{
  const int64_t known = offsetof(ct_point_record, known) / sizeof(double);
  for (int64_t i = 0; i < count; i++)
    if (!isfinite(memory[i]) && !(i < records && i % CT_RECORD == known)) return 0;
  return 1;
}

/* Whether numbers are possible as the memory of a contact. */
static int is_memory(const ct_contact *contact, const double *memory, int64_t count)
{
  ct_host_record record;
  memcpy(&record, memory, sizeof record);
  if (record.begun != 1.0) {
    for (int64_t i = 0; i < count; i++)
      if (memory[i] != 0.0) return 0;
    return 1;
  }
  int finite = are_finite(memory, 0, CT_HOST_RECORD);
  for (const ct_host_part *part = &contact->host->contact; part != NULL; part = part->next)
    finite =
        finite && are_finite(memory + part->memory, part->is->end_record, part->is->memory_count);
  return finite && record.before > 0.0 && record.unconverged >= 0.0 && record.unconverged < 9e15 &&
         ct_contact_memory_begun(contact->fixed, memory + CT_HOST_RECORD);
}

ct_status ct_contact_restore(ct_contact *contact, const double *memory, int64_t count,
                             ct_error *error)
{
  if (contact == NULL || memory == NULL) return CT_REFUSE_NULL(error);
  ct_status status = ct_host_open(contact, error);
  if (status != CT_OK) return status;
  ct_host *h = contact->host;
  if (count != h->memory_count)
    return CT_REFUSE(
        error,
        "contact: %lld numbers were saved, but this contact restores %lld; it is another one",
        (long long)count, (long long)h->memory_count);
  if (!is_memory(contact, memory, count))
    return ct_fail(error, CT_INVALID, CT_NOWHERE,
                   "contact: these numbers were not written by ct_contact_save");
  memcpy(h->memory, memory, (size_t)count * sizeof *memory);
  h->current = 0;
  return CT_OK;
}
