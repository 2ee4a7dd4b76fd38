#ifndef CT_SRC_LEDGER_H
#define CT_SRC_LEDGER_H

#include "workspace.h"

/* Work and impulses of the effects in a state (eq:work-balance, eq:impulse-balance). A stage whose
 * kick is `share` of the step contributes with the weight `share` (eq:stage-work). */

/* The impulses of all reactions at the nodes first ... last - 1, which have just been moved. */
void ct_ledger_reactions(const ct_problem *problem, ct_state *state, double share, int32_t first,
                         int32_t last);

/* Before the shared nodes of a piece are moved: write v⁻ to their places in `sum`, shape (last -
 * first, 3), and the first effect's work to `work`, one after another. */
void ct_ledger_keep(const ct_state *state, ct_moved piece, double *sum, double *work);

/* After they were moved with the work of all forces: that of the first effect's own ones, and v⁻ +
 * v⁺ in `sum`. */
void ct_ledger_correct(ct_state *state, double share, ct_moved piece, const double *work,
                       double *sum);

/* Work and impulses of the effects other than the first and the reactions in piece `p`, which has
 * just been moved, from v⁻ + v⁺ at its shared nodes. */
void ct_ledger_count(const ct_problem *problem, ct_state *state, double share, int32_t p,
                     const double *sum);

/* Add the impulses since the last call to the earlier ones, so that few small numbers are added to
 * a large one (eq:impulse-parts). */
void ct_ledger_fold(ct_state *state);

#endif
