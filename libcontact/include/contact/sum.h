#ifndef CONTACT_SUM_H
#define CONTACT_SUM_H

#include <contact/status.h>

CT_BEGIN_DECLS

/**
 * Sum of `count` numbers, the same bits for any order of them and for any number of threads: every
 * partial sum is exact on a grid that the largest number fixes, :eq:`order-free-sum`. The error is
 * below count³ · 2⁻⁹⁸ of the largest number, before the one rounding of the result. NaN if one of
 * them is not finite or the sum would overflow.
 */
CT_API double ct_sum(const double *values, int64_t count);

CT_END_DECLS

#endif
