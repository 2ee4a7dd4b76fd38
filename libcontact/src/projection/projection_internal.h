#ifndef CT_SRC_PROJECTION_INTERNAL_H
#define CT_SRC_PROJECTION_INTERNAL_H

#include <contact/projection.h>

/* A face as a polynomial, seen from the point that is projected:
 *   d(x, y) = y(x, y) - y_s = (c0 + c3 xy) + (c1 x + c2 y) + (c4 x^2 + c5 y^2) + xy (c6 x + c7 y).
 * A flip of xi_1 changes the signs of c1, c3, c7 and nothing else, so whatever is computed from c has mirrored bits. */
typedef struct ct_patch {
  ct_face_kind kind;
  double c[8][4]; /* three coordinates and a zero that fills the vector */
  double size;    /* largest |c1 ... c7|, a length of the face */
} ct_patch;

/* Where a method has ended. d = y(xi) - y_s. */
typedef struct ct_foot {
  double xi[2];
  double d[3];
  int evaluations, iterations;
} ct_foot;

/* One row of the table of methods. */
typedef ct_status ct_project_method(const ct_patch *, const ct_project_options *, ct_foot *);

/* Polynomial of the face as seen from `point`. Answers CT_INVALID when a number is not finite, all nodes coincide
 * or a length is beyond 1e+-70. */
ct_status ct_patch_init(ct_patch *patch, ct_face_kind kind, const double node[8][3], const double point[3]);

/* d at xi; answers f = d.d. */
double ct_patch_value(const ct_patch *patch, const double xi[2], double d[3]);

/* f, gradient (f,1  f,2) and Hessian (f,11  f,22  f,12) at xi, with d; answers f. */
double ct_patch_derivatives(const ct_patch *patch, const double xi[2], double d[3], double g[2], double H[3]);

/* Lengths of the tangents at xi. */
void ct_patch_tangent_lengths(const ct_patch *patch, const double xi[2], double length[2]);

/* Unit normal at xi along y,1 x y,2; at a collapsed corner that of the points just inside. Answers 0, with NaN, when there is none. */
int ct_patch_normal(const ct_patch *patch, const double xi[2], double n[3]);

/* Interior, edge, vertex or outside, each within `slack` (in xi), with the number of the edge or corner. */
ct_where ct_patch_where(ct_face_kind kind, const double xi[2], double slack, int *index);

/* Half-width of the reference face: 1 or 1/2. */
static inline double ct_patch_half_width(ct_face_kind kind) { return kind == CT_T3 || kind == CT_T6 ? 0.5 : 1; }

/* Centre of the reference face. */
static inline double ct_patch_centre(ct_face_kind kind) { return kind == CT_T3 || kind == CT_T6 ? 1.0 / 3 : 0; }

/* The methods. They read tolerance, use_start, start, iteration_limit and trace of the options, and add to the counts of the foot, which
 * the caller sets to zero. A contact kernel calls ct_patch_init, one of these with the last xi as start, and ct_patch_normal. */
ct_project_method ct_project_simplex, ct_project_newton, ct_project_robust;

#endif
