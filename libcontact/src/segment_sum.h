#ifndef CT_SRC_SEGMENT_SUM_H
#define CT_SRC_SEGMENT_SUM_H

#include <contact/segment.h>

/* Sum over the nodes of weight[i * stride] times coordinate, in the tree that a flip of xi_1 or xi_2 (of quadrilaterals) and an
 * exchange of xi_1 and xi_2 (of triangles) maps onto itself, so that a mirrored face gives the mirrored bits. */
void ct_segment_sum(const ct_face *face, const double *weight, int stride, double sum[3]);

#endif
