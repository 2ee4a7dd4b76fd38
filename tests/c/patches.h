/* Flat patches of faces, and contacts of two of them, for the tests of contact. */
#ifndef PATCHES_H
#define PATCHES_H

#include "bodies.h"

static const char *const KIND[4] = {"Q4", "Q8", "T3", "T6"};
static const double EPSILON = 1000.0;

/* A surface with its own arrays: the lattice of half cells over a rectangle; some kinds leave nodes
 * unused. */
typedef struct patch {
  ct_surface surface;
  int32_t *faces;
  double *x;
} patch;

/* A closed box as a surface with its own nodes. */
static inline patch new_box(const double low[3], const double size[3], const int cells[3])
{
  ct_mesh *m = box_mesh(CT_HEX8, low[0], low[1], low[2], size[0], size[1], size[2], cells[0],
                        cells[1], cells[2]);
  patch p = {{CT_Q4, m->node_count, 0, NULL, NULL},
             integers(4 * 6 * m->element_count),
             numbers(3 * m->node_count)};
  p.surface.face_count = ct_mesh_outer_faces(m, p.faces, NULL);
  memcpy(p.x, m->nodes, 3 * (size_t)m->node_count * sizeof *p.x);
  p.surface.faces = p.faces;
  p.surface.reference = p.x;
  free_mesh(m);
  return p;
}

static inline patch new_patch(ct_face_kind kind, int nx, int ny, double x0, double y0, double wx,
                              double wy, int up)
{
  static const int square[8][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}};
  static const int lower[6][2] = {{0, 0}, {2, 0}, {0, 2}, {1, 0}, {1, 1}, {0, 1}},
                   upper[6][2] = {{2, 2}, {0, 2}, {2, 0}, {1, 2}, {1, 1}, {2, 1}};
  static const int back4[8] = {0, 3, 2, 1, 7, 6, 5, 4}, back3[6] = {0, 2, 1, 5, 4, 3};
  int triangle = kind == CT_T3 || kind == CT_T6, per = ct_face_node_count(kind), row = 2 * nx + 1,
      count = nx * ny * (triangle ? 2 : 1);
  patch p = {{kind, row * (2 * ny + 1), count, NULL, NULL},
             integers(count * per),
             numbers(3 * row * (2 * ny + 1))};
  for (int n = 0; n < p.surface.node_count; n++) {
    p.x[3 * n] = x0 + wx * (n % row) / (2 * nx);
    p.x[3 * n + 1] = y0 + wy * (n / row) / (2 * ny);
  }
  for (int f = 0; f < count; f++) {
    int cell = triangle ? f / 2 : f, i = 2 * (cell % nx), j = 2 * (cell / nx);
    const int (*corner)[2] = triangle ? (f % 2 ? upper : lower) : square;
    for (int a = 0; a < per; a++) {
      int from = up ? a : triangle ? back3[a] : back4[a];
      p.faces[f * per + a] = i + corner[from][0] + row * (j + corner[from][1]);
    }
  }
  p.surface.faces = p.faces;
  p.surface.reference = p.x;
  return p;
}

static inline ct_contact *open_contact(const patch *a, const patch *b, ct_contact_options options)
{
  ct_contact *contact = NULL;
  if (options.epsilon == 0.0) options.epsilon = EPSILON;
  must(ct_contact_create, &a->surface, &b->surface, &options, &contact);
  return later_contact(contact);
}

static inline void update(ct_contact *contact, const patch *a, const patch *b)
{
  must(ct_contact_update, contact, a->x, b->x);
}

/* Both, with the default options. */
static inline ct_contact *updated_contact(const patch *a, const patch *b)
{
  ct_contact *contact = open_contact(a, b, ct_contact_options_default());
  update(contact, a, b);
  return contact;
}

/* Forces on both surfaces, from zero. */
static inline void forces(const ct_contact *contact, const patch *a, const patch *b, double *fa,
                          double *fb)
{
  ct_error e = {0};
  memset(fa, 0, 3 * (size_t)a->surface.node_count * sizeof *fa);
  memset(fb, 0, 3 * (size_t)b->surface.node_count * sizeof *fb);
  need(ct_contact_add_force(contact, fa, fb, NULL), &e);
}

static inline double total(const double *f, int nodes, int c)
{
  double sum = 0.0;
  for (int n = 0; n < nodes; n++) sum += f[3 * n + c];
  return sum;
}

/* Rotate a patch about the origin. */
static inline void turn(patch *p, double R[3][3])
{
  for (int n = 0; n < p->surface.node_count; n++) {
    const double x[3] = {p->x[3 * n], p->x[3 * n + 1], p->x[3 * n + 2]};
    for (int c = 0; c < 3; c++) p->x[3 * n + c] = R[c][0] * x[0] + R[c][1] * x[1] + R[c][2] * x[2];
  }
}

#endif
