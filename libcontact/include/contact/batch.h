#ifndef CONTACT_BATCH_H
#define CONTACT_BATCH_H

#include <contact/projection.h>

CT_BEGIN_DECLS

/**
 * Where ct_project_batch writes the feet of a batch; arrays in lanes, of ct_batch_blocks(count)
 * blocks. A null pointer is not written. A pair that ct_project answers with CT_INVALID has NaN
 * here too.
 */
typedef struct ct_batch_feet {
  /** Reference coordinates, shape (blocks, 2, 8). */
  double *xi;
  /** Distance of each point from its foot [length], shape (blocks, 8). */
  double *distance;
  /** The distance with its sign, shape (blocks, 8). */
  double *signed_distance;
  /** Unit normals at the feet, shape (blocks, 3, 8). */
  double *normal;
  /** The ct_status of each pair, shape (blocks, 8). */
  int32_t *status;
  /** Calls of f, shape (blocks, 8). */
  int32_t *evaluations;
} ct_batch_feet;

/** Number of blocks of eight lanes that ``count`` pairs fill. */
CT_API size_t ct_batch_blocks(size_t count);

/**
 * Put rows of an array into lanes: row ``number[p * per + i]`` of ``rows``, shape (n, 3), goes to
 * the place (p / 8, i, k, p % 8) of ``lanes``, shape (blocks, per, 3, 8). Null ``number`` takes the
 * rows as they come, row p * per + i. The last block is filled up with its last pair.
 */
CT_API void ct_batch_gather(size_t count, int per, const double *rows, const int32_t *number,
                            double *lanes);

/**
 * The closest points of ``count`` pairs of a face and a point, eight side by side; the answers are
 * those of CT_ROBUST. All faces are of one kind. ``nodes``, shape (blocks, nodes of the kind, 3,
 * 8), ``points``, shape (blocks, 3, 8), and ``start``, null or of shape (blocks, 2, 8), are laid
 * out as ct_batch_gather does; a start that is not finite is none. Null ``options`` are the
 * defaults; method, use_start, start and trace of them are not read.
 *
 * Quadrilaterals run in lanes, and a lane in trouble (several valleys, a face that may hide
 * something, values lost in rounding, no foot after a dozen steps) is given to ct_project; so are
 * all triangles. CT_ERROR_ARGUMENT, with nothing written: a null pointer, an unknown kind, a
 * tolerance that is not positive or a negative limit. CT_OK otherwise; see the status of each pair.
 */
CT_API ct_status ct_project_batch(ct_face_kind kind, size_t count, const double *nodes,
                                  const double *points, const double *start,
                                  const ct_project_options *options, const ct_batch_feet *feet);

CT_END_DECLS

#endif
