#ifndef CT_SRC_CONTACT_INITIAL_H
#define CT_SRC_CONTACT_INITIAL_H

#include <contact/contact.h>

/* Doubles of memory that a contact which shifts its gaps needs, a point and behind all points. */
enum { CT_INITIAL_POINT = 3, CT_INITIAL_END = 2 };

/* What the shifts are shown: the time t_n and Δt, whether this is the first step, the memory of the first point and how far apart
 * those of two points are, and what stands behind all points; to read and to write. */
typedef struct ct_initial_view {
  double time, dt;
  int first;
  int stride;
  const double *memory, *memory_end;
  double *next, *next_end;
} ct_initial_view;

/* Whether the gaps of a contact with these options count from a start gap. */
int ct_initial_shifts(const ct_contact_options *options);

/* Fail if any point is inside (eq:initial-shift). */
ct_status ct_initial_refuse(const ct_contact *contact, ct_error *error);

/* Count the gaps of all points from their start gaps, and their penalty forces with them. */
void ct_initial_shift(ct_contact *contact, const ct_initial_view *view);

/* Work that has come in since t = 0 because the shifts fade, once the forces of the points are known (eq:initial-work). */
double ct_initial_work(const ct_contact *contact, const ct_initial_view *view);

#endif
