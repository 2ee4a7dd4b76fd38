#ifndef CT_SRC_LEDGER_H
#define CT_SRC_LEDGER_H

#include "workspace.h"

/* Work and impulses of the effects in a state (eq:work-balance, eq:impulse-balance). A stage whose
 * kick is `share` of the step contributes with the weight `share` (eq:stage-work). */

/* Before the stage: save the values for the correction at the shared nodes. */
void ct_ledger_keep(ct_state *state);

/* The impulses of all reactions at the nodes first ... last - 1, which have just been moved. */
void ct_ledger_reactions(const ct_problem *problem, ct_state *state, double share, int32_t first,
                         int32_t last);

/* After the stage: work and impulse of the effects other than the first and the reactions, and the
 * first one's own work at shared nodes. */
void ct_ledger_count(const ct_problem *problem, ct_state *state, double share);

/* Add the impulses since the last call to the earlier ones, so that few small numbers are added to
 * a large one (eq:impulse-parts). */
void ct_ledger_fold(ct_state *state);

#endif
