#ifndef CT_SRC_STEP_LAYERS_H
#define CT_SRC_STEP_LAYERS_H

#include <libcontact/problem.h>

#include "../constraint/solve.h"
#include "piece.h"

/* Find the bodies that are one layer of elements between two sets and pass waves on
 * (eq:release-passed); from the solver's pool, which may fail. */
void ct_layers_find(const ct_problem *problem, const ct_row_set *sets, int32_t count,
                    ct_solver *solver);

/* Give the layers of the whole problem, which the first piece has, to all pieces: a part of a body
 * may be one layer, or free, where the whole body is not. */
ct_status ct_layers_spread(const ct_piece *piece, ct_solver *solver, ct_error *error);

#endif
