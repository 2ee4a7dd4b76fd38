/* Queries of a const contact only read it: several threads may use one contact at the same time. */
#include "../../libcontact/src/contact/contact_internal.h"
#include "patches.h"
#include "springs.h"

/* All data that such a call might write: the trees, the boxes, the memory for sums. */
typedef struct seen {
  int64_t builds[2];
  double cost[2];
  ct_bounds *boxes[2];
  double *terms;
} seen;

static seen look(const ct_contact *contact)
{
  size_t points = (size_t)ct_contact_point_count(contact);
  seen s = {.terms = numbers((int64_t)points)};
  memcpy(s.terms, contact->terms, points * sizeof *s.terms);
  for (int i = 0; i < contact->fixed->gaps.sides; i++) {
    const ct_search *search = contact->gaps.side[i].search;
    s.builds[i] = ct_box_tree_builds(search->tree);
    s.cost[i] = ct_box_tree_cost(search->tree);
    s.boxes[i] = room(search->face_count, sizeof **s.boxes);
    memcpy(s.boxes[i], search->boxes, (size_t)search->face_count * sizeof **s.boxes);
  }
  return s;
}

/* Whether nothing has changed; frees both. */
static int same(const ct_contact *contact, seen *a, seen *b)
{
  int equal =
      memcmp(a->terms, b->terms, (size_t)ct_contact_point_count(contact) * sizeof *a->terms) == 0;
  for (int i = 0; i < contact->fixed->gaps.sides; i++) {
    equal &=
        a->builds[i] == b->builds[i] && memcmp(&a->cost[i], &b->cost[i], sizeof a->cost[i]) == 0;
    equal &= memcmp(a->boxes[i], b->boxes[i],
                    (size_t)contact->gaps.side[i].search->face_count * sizeof **a->boxes) == 0;
  }
  return equal;
}

/* Energy, bound of the frequency and penetration of a contact as it is. */
static void ask(const ct_contact *contact, const double *mass, double got[4])
{
  ct_penetration corners, edges;
  ct_error e = {0};
  got[0] = ct_contact_energy(contact);
  need(springs_of(contact, mass, mass, &got[1]), &e);
  need(ct_contact_penetration(contact, CT_AT_CORNERS, &corners, NULL), &e);
  need(ct_contact_penetration(contact, CT_AT_EDGES, &edges, NULL), &e);
  got[2] = corners.deepest;
  got[3] = edges.deepest;
}

int main(void)
{
  free_at_end();
  for (int kind = 0; kind < 4; kind++) {
    patch a = new_patch((ct_face_kind)kind, 5, 4, 0.0, 0.0, 1.0, 1.0, 1),
          b = new_patch((ct_face_kind)kind, 3, 3, 0.0, 0.0, 1.0, 1.0, 0);
    double mass[256], got[4], again[4];
    for (int i = 0; i < 256; i++) mass[i] = 1.0;
    ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
    seen before = look(contact);
    ask(contact, mass, got);
    seen after = look(contact);
    tap_ok(same(contact, &before, &after), "%s: before the first update nothing is written",
           KIND[kind]);
    // b moves towards a in steps that make no new lists of candidates, so that the trees are of an
    // older shape than the faces.
    for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = 0.01;
    update(contact, &a, &b);
    for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = -0.01;
    update(contact, &a, &b);
    for (int64_t i = 0; i < ct_contact_point_count(contact); i++) contact->terms[i] = NAN;
    before = look(contact);
    ask(contact, mass, got);
    after = look(contact);
    tap_ok(same(contact, &before, &after), "%s: nothing is written in contact either", KIND[kind]);
    ask(contact, mass, again);
    tap_ok(memcmp(got, again, sizeof got) == 0, "%s: and repeated queries have the same results",
           KIND[kind]);
    // Two surfaces of stiffness ε with weight ½ each, over the area 1: ½ ε g².
    tap_close(got[0], 0.5 * EPSILON * 1e-4, 1e-15,
              "%s: the energy of both surfaces, each with half the stiffness", KIND[kind]);
    tap_close(got[2], 0.01, 1e-15, "%s: the corners of b are inside by its displacement",
              KIND[kind]);
  }
  return tap_done();
}
