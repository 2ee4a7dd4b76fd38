/* Closest points of many pairs of a face and a point, eight pairs at a time.
 * Threads: every call is safe at any time, also on the same face; a call writes only its output
 * arguments. */
#ifndef LIBCONTACT_BATCH_H
#define LIBCONTACT_BATCH_H

#include <libcontact/projection.h>

CT_BEGIN_DECLS

/**
 * Where ct_project_batch writes the closest points of a batch: arrays of (count + 7) / 8 blocks of
 * eight lanes. Outputs with a null pointer are not written. Where ct_project returns CT_INVALID for
 * a pair, the batch has NaN, too.
 */
typedef struct ct_batch_closest {
  /** Reference coordinates, shape (blocks, 2, 8). */
  double *xi;
  /** Distance of each point from its closest point [length], shape (blocks, 8). */
  double *distance;
  /** The distance with its sign, shape (blocks, 8). */
  double *signed_distance;
  /** Unit normals at the closest points, shape (blocks, 3, 8). */
  double *normal;
  /** The ct_status of each pair, shape (blocks, 8). */
  int32_t *status;
  /** Calls of f, shape (blocks, 8). */
  int32_t *evaluations;
} ct_batch_closest;

/**
 * Find the closest points of ``count`` pairs of a face and a point, eight pairs at a time, with the
 * results of CT_ROBUST. All faces are of one kind. Pair p is in lane p % 8 of block p / 8,
 * :eq:`batch-lanes`. ``nodes`` has the shape (blocks, nodes of the kind, 3, 8), ``points`` (blocks,
 * 3, 8), and ``start`` is null or has the shape (blocks, 2, 8). Fill the last block with copies of
 * any pair. A start that is not finite is ignored. Null ``options`` select the defaults; their
 * method, use_start, start and trace are not read.
 *
 * The processor computes eight pairs at once with AVX-512, four with AVX2, otherwise one; the
 * results are the same bit by bit. CT_ERROR_ARGUMENT: a null pointer, an unknown kind, a tolerance
 * that is not positive, or a negative limit; then no output is written. CT_OK otherwise; see the
 * status of each pair.
 */
CT_API ct_status ct_project_batch(ct_face_kind kind, size_t count, const double *nodes,
                                  const double *points, const double *start,
                                  const ct_project_options *options,
                                  const ct_batch_closest *closest, ct_error *error);

CT_END_DECLS

#endif
