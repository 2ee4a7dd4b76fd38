#ifndef CT_SRC_LEDGER_H
#define CT_SRC_LEDGER_H

#include "workspace.h"

/* The work and impulses that a state keeps of its effects (eq:work-balance, eq:impulse-balance). In
 * a stage whose kick is `share` of the step they count `share` times (eq:stage-work). */

/* Before the stage: keep what the correction at the shared nodes needs. */
void ct_ledger_keep(ct_state *state);

/* The impulses of all reactions at the nodes first ... last - 1, which have just moved. */
void ct_ledger_reactions(const ct_problem *problem, ct_state *state, double share, int32_t first,
                         int32_t last);

/* After the stage: work and impulse of the effects beside the first and the reactions, and the
 * first one's own work at shared nodes. */
void ct_ledger_count(const ct_problem *problem, ct_state *state, double share);

/* Put the impulses since the last fold to those before, so that few numbers are added to a large
 * one (eq:impulse-parts). */
void ct_ledger_fold(ct_state *state);

#endif
