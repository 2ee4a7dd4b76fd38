#ifndef CT_SRC_PROJECTION_INTERNAL_H
#define CT_SRC_PROJECTION_INTERNAL_H

#include <libcontact/batch.h>

/* A face as a polynomial relative to the point that is projected:
 *   d(x, y) = y(x, y) - y_s = (c0 + c3 xy) + (c1 x + c2 y) + (c4 x^2 + c5 y^2) + xy (c6 x + c7 y).
 * A flip of xi_1 only changes the signs of c1, c3, c7, so all quantities computed from c have
 * mirrored bits. */
typedef struct ct_patch {
  ct_face_kind kind;
  double c[8][3];
  double size; /* largest |c1 ... c7|, a length of the face */
} ct_patch;

/* End of a method. d = y(xi) - y_s. */
typedef struct ct_closest {
  double xi[2];
  double d[3];
  int evaluations, iterations, certified;
} ct_closest;

/* A point of the plane of xi with f and its derivatives there, and the squares of the two tangents.
 */
typedef struct ct_iterate {
  double xi[2], f, d[3], g[2], H[3], square[3];
} ct_iterate;

/* One row of the table of methods. */
typedef ct_status ct_project_method(const ct_patch *, const ct_project_options *, ct_closest *);

/* For robust: the limit of a mild face, and the accuracy of a closest point for the proof that no
 * point is closer. */
static const double CT_MILD = 0.2, CT_PROVABLE = 1e-10;

/* An iterate this far out, in reference coordinates, does not return. */
static const double CT_FAR = 1e3;

/* Polynomial of the face relative to `point`. Returns CT_INVALID if a number is not finite, all
 * nodes coincide or a length is beyond 1e+-70. */
ct_status ct_patch_init(ct_patch *patch, ct_face_kind kind, const double node[8][3],
                        const double point[3]);

/* d at xi; returns f = d.d. */
double ct_patch_value(const ct_patch *patch, const double xi[2], double d[3]);

/* Unit normal at xi along y,1 x y,2; at a collapsed corner that of the points just inside. Returns
 * 0, with NaN, if there is none. */
int ct_patch_normal(const ct_patch *patch, const double xi[2], double n[3]);

/* Interior, edge, vertex or outside, each within `slack` (in xi), with the number of the edge or
 * corner. */
ct_where ct_patch_where(ct_face_kind kind, const double xi[2], double slack, int *index);

static inline int ct_is_triangular(ct_face_kind kind) { return kind == CT_T3 || kind == CT_T6; }

/* Half-width of the reference face: 1 or 1/2. */
static inline double ct_patch_half_width(ct_face_kind kind)
{
  return ct_is_triangular(kind) ? 0.5 : 1;
}

/* Centre of the reference face. */
static inline double ct_patch_centre(ct_face_kind kind)
{
  return ct_is_triangular(kind) ? 1.0 / 3 : 0;
}

/* f alone, and f with its derivatives at at->xi; each counts one evaluation. */
double ct_iterate_value(const ct_patch *patch, const double xi[2], ct_closest *closest);
void ct_iterate_evaluate(const ct_patch *patch, ct_iterate *at, ct_closest *closest);

/* The same for an unconstrained method, which is also traced. */
void ct_iterate_visit(const ct_patch *patch, const ct_project_options *options, ct_iterate *at,
                      ct_closest *closest);

/* Start of an unconstrained method: the given one, or the centre of the face. */
void ct_iterate_start(const ct_patch *patch, const ct_project_options *options, double xi[2]);

/* Check the end of an unconstrained method, at an iterate that was evaluated: is it a minimum,
 * within the tolerance? */
ct_status ct_iterate_status(const ct_patch *patch, const ct_project_options *options,
                            const ct_iterate *at, ct_closest *closest);

/* Iterations for which a vertex stays before the simplex of n + 1 vertices turns about it. */
static inline double ct_simplex_age(int n)
{
  return 1.65 * n + 0.05 * n * n; // (eq:simplex-age)
}

/* The regular simplex whose edge is a half-width, with its centroid at the start, and f at its
 * vertices; a flip of xi_1 about the centroid maps it onto itself. */
void ct_regular_simplex(const ct_patch *patch, const ct_project_options *options, double x[3][2],
                        double f[3], ct_closest *closest);

/* Newton's step to the root of the linearised gradient; returns the determinant of the Hessian. */
double ct_newton_step(const ct_iterate *at, double s[2]);

/* A step of an unconstrained method from an iterate that was evaluated; s is the last step, or
 * zero, on input. Returns 0 if there is none. */
typedef int ct_step_rule(const ct_patch *patch, const ct_iterate *at, double s[2], void *memory);

/* Take the steps of a rule from the start to the end, whole ones or with a line search. */
ct_status ct_iterate_walk(const ct_patch *patch, const ct_project_options *options,
                          int default_limit, int search_line, ct_step_rule *rule, void *memory,
                          ct_closest *closest);

/* The face to second order about a point y: an orthonormal frame e1, e2, n; tangents t1 = (R11, 0),
 * t2 = (R12, R22) in it, with R = {R11, R22, R12}; curvatures kappa11, kappa22, kappa12; and the
 * vector r from y to the given point. */
typedef struct ct_local {
  double R[3], kappa[3], r[3];
} ct_local;

/* The tangential vector w to the closest point on the local shape. */
typedef void ct_local_rule(const ct_local *local, double w[2]);

/* Take the steps of such a rule from the start to the end. */
ct_status ct_local_walk(const ct_patch *patch, const ct_project_options *options,
                        ct_local_rule *rule, ct_closest *closest);

/* Unit vector q across a valley of f, the direction in which f with the Hessian (f,11 f,22 f,12) is
 * most curved, and the curvatures across and along. */
void ct_principal(const double H[3], double q[2], double curvature[2]);

/* Descend along the floor of a narrow valley of f from xi, which becomes the end. Returns 0 if f
 * did not decrease. */
int ct_follow_valley(const ct_patch *patch, double xi[2], ct_closest *closest);

/* Result of the search for a proof. */
typedef enum ct_outcome { CT_PROVEN, CT_CLOSER, CT_GAVE_UP } ct_outcome;

/* Try to prove that no point of the face is closer than xi by more than the tolerance, examining at
 * most `budget` pieces of the face. After CT_CLOSER xi is a closer point. */
ct_outcome ct_proof_search(const ct_patch *patch, double tolerance, int budget, double xi[2],
                           ct_closest *count);

/* Try to prove with a few cuts of the face that no point is closer than xi, to the accuracy
 * CT_PROVABLE. After CT_CLOSER xi is a closer point. A mirrored face has the mirrored result. */
ct_outcome ct_proof_by_cuts(const ct_patch *patch, double xi[2], ct_closest *count);

/* Point where the line through the given point meets the face, nearest to the given point; and its
 * distance along the direction. CT_NO_CONVERGENCE if the line misses the face. */
ct_status ct_patch_ray(const ct_patch *patch, const double direction[3], double tolerance,
                       double xi[2], double *distance, int *evaluations);

/* Compilers and machines with vectors of four and eight; others search for one pair at a time. */
#if defined(__GNUC__) && defined(__x86_64__)
#define CT_BATCH_KERNELS 1
#else
#define CT_BATCH_KERNELS 0
#endif

/* The closest points of block number `block`, written to the results. */
typedef void ct_batch_kernel(ct_face_kind kind, const double *nodes, const double *points,
                             const double *start, const ct_project_options *options,
                             const ct_batch_closest *closest, size_t block);

/* The same search with one, four and eight lanes. */
ct_batch_kernel ct_batch_kernel_1, ct_batch_kernel_4, ct_batch_kernel_8;

/* Closest points of a block of eight pairs on quadrilaterals of four nodes, from starts near them
 * that are finite, as the robust search finds them: xi and normal of the lanes whose bits are
 * returned; the others need the search. */
typedef unsigned ct_near_kernel(const double *nodes, const double *points, const double *start,
                                const ct_project_options *options, double *xi, double *normal);
ct_near_kernel ct_near_kernel_1, ct_near_kernel_4, ct_near_kernel_8;

/* The widest of these kernels for this machine. */
ct_near_kernel *ct_widest_near_kernel(void);

/* The methods. They read tolerance, use_start, start, iteration_limit and trace of the options, and
 * add to the counts of the closest point, which the caller sets to zero. A contact kernel calls
 * ct_patch_init, one of these with the last xi as start, and ct_patch_normal. */
ct_project_method ct_project_simplex, ct_project_nelder_mead, ct_project_newton,
    ct_project_least_squares, ct_project_steepest_descent;
ct_project_method ct_project_broyden, ct_project_bfgs, ct_project_robust, ct_project_certified,
    ct_project_simplex_newton;
ct_project_method ct_project_sphere, ct_project_torus;

/* Whether a method has this number. */
int ct_method_exists(ct_method method);

/* Refuse a tolerance or an iteration limit that no search can use; `who` begins the text. */
ct_status ct_check_search_limits(const char *who, const ct_project_options *options,
                                 ct_error *error);

#endif
