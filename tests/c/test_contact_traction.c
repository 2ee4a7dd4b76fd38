/* Tractions recovered at the nodes of contact surfaces: closed forms, the forces and moments of the
 * points, the area of a corner, the order of everything. */
#include "patches.h"

/* Tractions and areas of both surfaces of a contact; NaN where nothing was written. */
typedef struct recovered {
  double *traction[2], *area[2];
} recovered;

static recovered recover(const ct_contact *contact, const patch *a, const patch *b)
{
  recovered r;
  for (int s = 0; s < 2; s++) {
    int nodes = (s == 0 ? a : b)->surface.node_count;
    r.traction[s] = numbers(3 * nodes);
    r.area[s] = numbers(nodes);
    for (int i = 0; i < 4 * nodes; i++)
      *(i < nodes ? &r.area[s][i] : &r.traction[s][i - nodes]) = NAN;
    must(ct_contact_traction, contact, s, r.traction[s], r.area[s]);
  }
  return r;
}

/* Two equal squares pressed into each other: the traction is eps delta at every node, and the areas
 * are those of the square. (eq:recovered-traction) */
static void uniform_overlap(ct_face_kind kind)
{
  patch a = new_patch(kind, 3, 2, 0, 0, 1, 0.75, 1), b = new_patch(kind, 3, 2, 0, 0, 1, 0.75, 0);
  double off = 0.0, size[2] = {0.0, 0.0}, delta = 0.01;
  int written = 0, used = 0;
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = -delta;
  ct_contact *contact = updated_contact(&a, &b);
  recovered r = recover(contact, &a, &b);
  for (int s = 0; s < 2; s++)
    for (int n = 0; n < a.surface.node_count; n++) {
      if (isnan(r.area[s][n])) continue;
      written++;
      size[s] += r.area[s][n];
      for (int c = 0; c < 3; c++)
        off = worst(off, r.traction[s][3 * n + c] / (EPSILON * delta) -
                             (c == 2 ? (s == 0 ? -1.0 : 1.0) : 0.0));
    }
  int32_t *seen = integers(a.surface.node_count);
  for (int i = 0; i < a.surface.face_count * ct_face_node_count(kind); i++) {
    used += !seen[a.faces[i]];
    seen[a.faces[i]] = 1;
  }
  tap_ok(off < 1e-12 && written == 2 * used && fabs(size[0] / 0.75 - 1.0) < 1e-13 &&
             fabs(size[1] / 0.75 - 1.0) < 1e-13,
         "%s, matching meshes: eps delta at all %d nodes, off by %.2g; areas %.6g, %.6g",
         KIND[kind], written, off, size[0], size[1]);
}

/* Equal patches pressed into each other at a small angle: the pressure is linear, and so are the
 * tractions of all nodes within. (eq:recovered-weights) */
static void linear_overlap(ct_face_kind kind)
{
  patch a = new_patch(kind, 4, 3, 0, 0, 1, 0.75, 1), b = new_patch(kind, 4, 3, 0, 0, 1, 0.75, 0);
  const double tilt = 1e-6, delta = 0.01;
  double off = 0.0;
  int inner = 0;
  for (int n = 0; n < b.surface.node_count; n++)
    b.x[3 * n + 2] = -delta - tilt * (b.x[3 * n] + 2.0 * b.x[3 * n + 1]);
  ct_contact *contact = updated_contact(&a, &b);
  recovered r = recover(contact, &a, &b);
  for (int n = 0; n < a.surface.node_count; n++) {
    double x = a.x[3 * n], y = a.x[3 * n + 1];
    if (isnan(r.area[0][n]) || !(fabs(x - 0.5) < 0.49 && fabs(y - 0.375) < 0.365)) continue;
    inner++;
    off = worst(off, (-r.traction[0][3 * n + 2] / EPSILON - delta) / tilt - (x + 2.0 * y));
  }
  tap_ok(off < 1e-6 && inner >= 6, "%s: a linear pressure at %d nodes within, off by %.2g",
         KIND[kind], inner, off);
}

/* Warped patches that do not match, with straight edges if so wished. */
static void warped_pair(ct_face_kind ka, ct_face_kind kb, int straight, patch *a, patch *b)
{
  *a = new_patch(ka, 3, 2, -1, -1, 2, 2, 1);
  *b = new_patch(kb, 2, 2, -0.5, -0.5, 1, 1, 0);
  for (int s = 0; s < 2; s++) {
    patch *p = s == 0 ? a : b;
    int per = ct_face_node_count(p->surface.kind), corners = p->surface.kind < CT_T3 ? 4 : 3;
    for (int n = 0; n < p->surface.node_count; n++) {
      double *x = &p->x[3 * n];
      x[2] = s == 0 ? 0.05 * sin(2.0 * x[0] + 1.0) * cos(1.5 * x[1]) : 0.02 * x[0] * x[1] - 0.02;
      for (int c = 0; c < 3; c++) x[c] += uniform(0.02);
    }
    for (int f = 0; straight && f < p->surface.face_count; f++)
      for (int k = corners; k < per; k++)
        for (int c = 0; c < 3; c++)
          p->x[3 * p->faces[f * per + k] + c] =
              0.5 * (p->x[3 * p->faces[f * per + k - corners] + c] +
                     p->x[3 * p->faces[f * per + (k - corners + 1) % corners] + c]);
  }
}

/* Add a force at a place to a resultant: force, then moment about the origin. */
static void add(double sum[6], const double x[3], const double f[3])
{
  for (int c = 0; c < 3; c++) {
    sum[c] += f[c];
    sum[3 + c] += x[(c + 1) % 3] * f[(c + 2) % 3] - x[(c + 2) % 3] * f[(c + 1) % 3];
  }
}

/* Areas times tractions against the forces of all points, those of both passes.
 * (eq:recovered-traction) */
static void resultants(ct_face_kind ka, ct_face_kind kb, int straight)
{
  patch a, b;
  warped_pair(ka, kb, straight, &a, &b);
  ct_contact *contact = updated_contact(&a, &b);
  recovered r = recover(contact, &a, &b);
  int64_t count = ct_contact_point_count(contact);
  ct_contact_point *point = room(count, sizeof *point);
  double want[2][6] = {{0}}, found[2][6] = {{0}}, size = 0.0, force = 0.0, moment = 0.0;
  ct_contact_points(contact, point, NULL);
  for (int64_t i = 0; i < count; i++) {
    const ct_contact_point *p = &point[i];
    double f[3], back[3];
    if (!(p->raw_pressure > 0.0)) continue;
    // -- A point presses with half its weight, along its gap
    for (int c = 0; c < 3; c++) {
      f[c] = 0.5 * p->raw_pressure * p->weight * (p->closest[c] - p->position[c]) / -p->gap;
      back[c] = -f[c];
      size += fabs(f[c]);
    }
    add(want[p->side], p->position, f);
    add(want[1 - p->side], p->closest, back);
  }
  for (int s = 0; s < 2; s++) {
    const patch *p = s == 0 ? &a : &b;
    for (int n = 0; n < p->surface.node_count; n++) {
      double f[3];
      if (!(r.area[s][n] > 0.0)) continue;
      for (int c = 0; c < 3; c++) f[c] = r.area[s][n] * r.traction[s][3 * n + c];
      add(found[s], &p->x[3 * n], f);
    }
    force = worst(force, largest_difference(found[s], want[s], 3) / size);
    moment = worst(moment, largest_difference(&found[s][3], &want[s][3], 3) / size);
  }
  // Curved edges have their middles off the chords, by up to 0.03, and so the forces there.
  tap_ok(force < 1e-12 && moment < (straight ? 1e-12 : 0.03) && size > 0.0,
         "%s on %s, %s edges: force of the points, off by %.2g, and moment, %.2g", KIND[kb],
         KIND[ka], straight ? "straight" : "curved", force, moment);
}

/* A closed box stands on a patch, which is larger, in any direction: the box's walls carry nothing,
 * so the pressure at the edges of its bottom is that in the middle. At a node of the patch the
 * traction is the mean over the four faces around it, of which the box covers four, two or one.
 * (eq:recovered-traction) */
static void box_on_patch(int turned)
{
  const double low[3] = {0, 0, -0.01}, size[3] = {1, 1, 0.5}, full = 0.01 * EPSILON;
  const int cells[3] = {4, 4, 1};
  patch a = new_patch(CT_Q4, 8, 8, -0.5, -0.5, 2, 2, 1), b = new_box(low, size, cells);
  double *x = numbers(3 * a.surface.node_count), *y = numbers(3 * b.surface.node_count),
         R[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  memcpy(x, a.x, 3 * (size_t)a.surface.node_count * sizeof *x);
  memcpy(y, b.x, 3 * (size_t)b.surface.node_count * sizeof *y);
  if (turned) {
    random_rotation(R);
    turn(&a, R);
    turn(&b, R);
  }
  ct_contact *contact = updated_contact(&a, &b);
  recovered r = recover(contact, &a, &b);
  double off[2] = {0.0, 0.0}, area = 0.0;
  for (int n = 0; n < b.surface.node_count; n++) {
    const double *t = &r.traction[1][3 * n], want = y[3 * n + 2] < 0.0 ? full : 0.0;
    for (int c = 0; c < 3; c++) off[1] = worst(off[1], (t[c] - want * R[c][2]) / full);
  }
  for (int n = 0; n < a.surface.node_count; n++) {
    if (isnan(r.area[0][n])) continue;
    double want = full;
    for (int c = 0; c < 2; c++) {
      double out = fabs(x[3 * n + c] - 0.5) - 0.5;
      want *= fabs(out) < 1e-12 ? 0.5 : out < 0.0;
    }
    area = worst(area, want > 0.0 ? r.area[0][n] / 0.0625 - 1.0 : r.area[0][n]);
    for (int c = 0; c < 3; c++)
      off[0] = worst(off[0], (r.traction[0][3 * n + c] + want * R[c][2]) / full);
  }
  tap_ok(off[0] < 1e-12 && off[1] < 1e-12 && area < 1e-12,
         "box on a larger patch%s: uniform to its edges, off by %.2g; the patch, %.2g; areas, %.2g",
         turned ? ", turned" : "", off[1], off[0], area);
}

/* A surface bends down at an angle, and only the flat part is in contact: the area of a node on the
 * bend is that which the force sees, half of it on either part. (eq:recovered-fraction) */
static void bend(double angle)
{
  patch a = new_patch(CT_Q4, 8, 4, -1, 0, 2, 1, 1), b = new_patch(CT_Q4, 4, 4, -1, 0, 1, 1, 0);
  for (int n = 0; n < a.surface.node_count; n++)
    if (a.x[3 * n] > 1e-9) a.x[3 * n + 2] = -tan(angle) * a.x[3 * n];
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = -0.01;
  ct_contact *contact = updated_contact(&a, &b);
  recovered r = recover(contact, &a, &b);
  double off = 0.0;
  int on_bend = 0;
  for (int n = 0; n < a.surface.node_count; n++) {
    if (isnan(r.area[0][n]) || a.x[3 * n] > 1e-9) continue;
    int bent = a.x[3 * n] > -1e-9;
    on_bend += bent;
    off = worst(off, r.traction[0][3 * n + 2] / (0.01 * EPSILON) + (bent ? 0.5 : 1.0));
  }
  tap_ok(off < 1e-12 && on_bend == 5, "bent by %.2g: half on the bend, off by %.2g", angle, off);
}

/* A round surface in a flat one, whose nodes with a force all have the area under their weights in
 * all faces around them, also in those without a point in contact. In cells of area 1 this is 1 for
 * a corner of linear faces; with mid-sides, 2/3 or 1/2 for a corner of quadrilaterals or triangles,
 * and 1/6 for a mid-side. (eq:recovered-traction, eq:recovered-weights) */
static void round_on_flat(ct_face_kind kind)
{
  int rim = 0, corners = kind == CT_Q4 || kind == CT_Q8 ? 4 : 3, per = ct_face_node_count(kind);
  double off = 0.0, corner = per == corners ? 1.0 : corners == 4 ? 2.0 / 3.0 : 0.5;
  for (int scene = 0; scene < 8; scene++) {
    patch a = new_patch(kind, 12, 12, -1, -1, 2, 2, 1), b = new_patch(kind, 7, 9, -1, -1, 2, 2, 0);
    const double centre[2] = {uniform(0.2), uniform(0.2)}, depth = 0.03 + uniform(0.02);
    for (int n = 0; n < b.surface.node_count; n++) {
      double *x = &b.x[3 * n], dx = x[0] - centre[0], dy = x[1] - centre[1];
      x[2] = 0.2 * (dx * dx + dy * dy) - depth;
    }
    ct_contact *contact = updated_contact(&a, &b);
    recovered r = recover(contact, &a, &b);
    for (int f = 0; f < a.surface.face_count; f++) {
      int with = 0;
      for (int k = 0; k < per; k++) {
        int n = a.faces[f * per + k];
        if (r.traction[0][3 * n + 2] == 0.0) continue;
        with++;
        off = worst(off, r.area[0][n] * 36.0 / (k < corners ? corner : 1.0 / 6.0) - 1.0);
      }
      rim += with > 0 && with < per;
    }
  }
  // The direction of the forces on the flat faces is vertical only to the angle of the round ones.
  tap_ok(off < 0.02 && rim > 8 * 12, "%s: a round surface in a flat one: whole areas, off by %.2g",
         KIND[kind], off);
}

/* A small patch in the middle of one large face, which is flat or warped, between the points of
 * that face: only the patch has points in contact, and the large face carries their force. */
static void between_points(double warp)
{
  patch a = new_patch(CT_Q4, 1, 1, 0, 0, 1, 1, 1),
        b = new_patch(CT_Q4, 2, 2, 0.4, 0.4, 0.2, 0.2, 0);
  for (int n = 0; n < b.surface.node_count; n++) b.x[3 * n + 2] = -0.01;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  for (int n = 0; n < a.surface.node_count; n++)
    a.x[3 * n + 2] = warp * (a.x[3 * n] - 0.5) * (a.x[3 * n + 1] - 0.5);
  update(contact, &a, &b);
  recovered r = recover(contact, &a, &b);
  double force = 0.0, size = 0.0;
  for (int n = 0; n < a.surface.node_count; n++) {
    if (isnan(r.area[0][n])) continue;
    size += r.area[0][n];
    force += r.area[0][n] * r.traction[0][3 * n + 2];
  }
  tap_close(force, -0.5 * EPSILON * 0.01 * 0.04, warp == 0.0 ? 1e-13 : 1e-3,
            "a patch between points of a face warped by %g: half its force", warp);
  tap_close(size, 1.0, 1e-14, "the face between whose points it is counts");
}

/* Tractions and areas of a pair, in one list: tractions of a and b, areas of a and b; 0 where
 * nothing was written. */
static double *all_of(const patch *a, const patch *b)
{
  const int na = a->surface.node_count, nb = b->surface.node_count;
  double *out = numbers(4 * (na + nb));
  ct_contact *contact = open_contact(a, b, ct_contact_options_default());
  update(contact, a, b);
  must(ct_contact_traction, contact, 0, out, out + 3 * (na + nb));
  must(ct_contact_traction, contact, 1, out + 3 * na, out + 3 * (na + nb) + na);
  return out;
}

/* Faces in the opposite order, and mirror images, for which (xi, eta) becomes (-xi, eta). */
static void bits(ct_face_kind kind)
{
  static const int flipped[8] = {1, 0, 3, 2, 4, 7, 6, 5};
  patch a, b;
  warped_pair(kind, kind, 0, &a, &b);
  const int nodes = a.surface.node_count + b.surface.node_count, per = ct_face_node_count(kind);
  double *f = all_of(&a, &b), *g;
  for (int i = 0, j = a.surface.face_count - 1; i < j; i++, j--)
    for (int k = 0; k < per; k++) {
      int32_t keep = a.faces[i * per + k];
      a.faces[i * per + k] = a.faces[j * per + k];
      a.faces[j * per + k] = keep;
    }
  g = all_of(&a, &b);
  tap_ok(memcmp(f, g, 4 * (size_t)nodes * sizeof *f) == 0 && largest(f, 3 * nodes) > 0.0,
         "%s: faces in the opposite order, the same bits", KIND[kind]);
  for (int s = 0; s < 2; s++) {
    patch *p = s == 0 ? &a : &b;
    for (int i = 0; i < p->surface.face_count; i++) {
      int32_t old[8];
      memcpy(old, &p->faces[i * per], (size_t)per * sizeof *old);
      for (int k = 0; k < per; k++) p->faces[i * per + k] = old[flipped[k]];
    }
    for (int n = 0; n < p->surface.node_count; n++) p->x[3 * n] *= -1.0;
  }
  g = all_of(&a, &b);
  int64_t faults = mirror_faults(f, g, nodes, 0) +
                   (memcmp(f + 3 * nodes, g + 3 * nodes, (size_t)nodes * sizeof *f) != 0);
  tap_ok(faults == 0, "%s: mirrored, the mirrored bits (%d are not)", KIND[kind], (int)faults);
}

static void refusals(void)
{
  patch a = new_patch(CT_Q4, 1, 1, 0, 0, 1, 1, 1), b = new_patch(CT_Q4, 1, 1, 0, 0, 1, 1, 0);
  double traction[27], area[9];
  ct_error e;
  ct_contact *contact = open_contact(&a, &b, ct_contact_options_default());
  tap_ok(ct_contact_traction(contact, 2, traction, area, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_traction(contact, -1, traction, area, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_traction(contact, 0, NULL, area, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_traction(contact, 0, traction, NULL, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_traction(NULL, 0, traction, area, &e) == CT_ERROR_ARGUMENT,
         "an unknown surface and null arguments are refused: %s", e.text);
}

int main(void)
{
  free_at_end();
  for (int k = 0; k < 4; k++) {
    uniform_overlap((ct_face_kind)k);
    linear_overlap((ct_face_kind)k);
    for (int other = 0; other < 4; other++) resultants((ct_face_kind)k, (ct_face_kind)other, 1);
    resultants((ct_face_kind)k, (ct_face_kind)k, 0);
    round_on_flat((ct_face_kind)k);
  }
  for (int turned = 0; turned < 2; turned++) box_on_patch(turned);
  for (int k = 1; k < 5; k++) bend(0.3 * k);
  between_points(0.0);
  between_points(0.3);
  bits(CT_Q4);
  bits(CT_Q8);
  refusals();
  return tap_done();
}
