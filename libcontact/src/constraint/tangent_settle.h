#ifndef CT_SRC_CONSTRAINT_TANGENT_SETTLE_H
#define CT_SRC_CONSTRAINT_TANGENT_SETTLE_H

#include "solve.h"

/* Elastic slips and energies of all tangential rows, from their forces and slips; points stick only
 * if `may_stick` is 1, and not 0. Returns what they lose together (eq:slip-loss). */
double ct_tangent_settle(ct_solver *solver, double may_stick);

/* Shorten the elastic slips of the points that stick, so that their springs give back the energy
 * `gain` less (eq:slip-paid). Returns 0 if they have less. */
int ct_tangent_shorten_slips(ct_solver *solver, double gain);

#endif
