/* A contact in pieces: each one computes the points of its own faces. */
#include "host.h"

#include "../base/error.h"

static ct_status no_exchange(ct_error *error)
{
  return ct_fail(error, CT_ERROR_UNSUPPORTED, CT_NOWHERE,
                 "contact: the pieces could not exchange their numbers");
}

/* Refuse masks in which a face has no piece or several; all pieces get the same answer. */
static ct_status check_masks(const ct_contact *contact, const uint8_t *const owned[2],
                             const ct_pieces *pieces, ct_error *error)
{
  ct_status status = CT_OK;
  for (int s = 0; status == CT_OK && s < contact->fixed->gaps.sides; s++) {
    const int32_t count = contact->fixed->gaps.side[s].search->face_count;
    double *owners = ct_allocate((size_t)count, sizeof *owners);
    if (owners == NULL) return CT_NO_MEMORY(error, "the pieces of a contact");
    for (int32_t f = 0; f < count; f++) owners[f] = owned[s][f] != 0;
    ct_pieces_sum(pieces, owners, count);
    if (!isfinite(owners[0])) status = no_exchange(error);
    for (int32_t f = count - 1; f >= 0; f--)
      if (isfinite(owners[f]) && owners[f] != 1.0)
        status = ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){s, f, -1},
                         "contact: face %d of surface %d is in %g pieces, not in one", (int)f, s,
                         owners[f]);
    ct_release(owners);
  }
  return status;
}

ct_status ct_contact_set_pieces(ct_contact *contact, const uint8_t *owned_a, const uint8_t *owned_b,
                                const ct_pieces *pieces, ct_error *error)
{
  const int sides = contact == NULL ? 0 : contact->fixed->gaps.sides;
  const uint8_t *const owned[2] = {owned_a, owned_b};
  if (contact == NULL || owned_a == NULL || (owned_b == NULL && sides == 2) || pieces == NULL ||
      pieces->sum == NULL || pieces->largest == NULL)
    return CT_REFUSE_NULL(error);
  ct_status status = ct_host_check_new(contact, error);
  if (status != CT_OK) return status;
  ct_host *h = ct_host_of(contact);
  if (h == NULL) return CT_NO_MEMORY(error, "the pieces of a contact");
  if (h->pieces != NULL)
    return CT_REFUSE(error, "contact: ct_contact_set_pieces was called before; it is called once");
  status = check_masks(contact, owned, pieces, error);
  for (int s = 0; status == CT_OK && s < sides; s++) {
    const size_t count = (size_t)contact->fixed->gaps.side[s].search->face_count;
    ct_release(h->owned[s]); // of a call that ran out of memory
    h->owned[s] = ct_duplicate(owned[s], count);
    if (h->owned[s] == NULL) return CT_NO_MEMORY(error, "the pieces of a contact");
  }
  if (status != CT_OK) return status;
  h->given_pieces = *pieces;
  h->pieces = &h->given_pieces;
  return ct_host_cut(h, 0, contact, error);
}

ct_status ct_host_cut(const ct_host *h, int s, ct_contact *of, ct_error *error)
{
  ct_status status = CT_OK;
  for (int k = 0; h->pieces != NULL && status == CT_OK && k < of->gaps.fixed->sides; k++) {
    of->gaps.side[k].pieces = h->pieces;
    // The stations are those of the piece with the first face.
    status = ct_side_divide(&of->gaps.side[k], h->owned[s + ct_gaps_surface(of->gaps.fixed, k)]);
  }
  return status == CT_OK ? status : CT_NO_MEMORY(error, "the pieces of a contact");
}

ct_status ct_host_agree(const ct_contact *contact, ct_status own, int64_t *rows, ct_error *error)
{
  double both[2] = {(double)own, (double)*rows};
  ct_pieces_largest(contact->host->pieces, both, 2);
  if (own != CT_OK || both[0] == 0.0) {
    *rows = (int64_t)both[1];
    return own;
  }
  if (!(both[0] > 0.0)) return no_exchange(error);
  return ct_fail(error, (ct_status)both[0], CT_NOWHERE,
                 "contact: the step failed in another piece");
}
