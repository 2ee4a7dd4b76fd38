/* The kernel for hex8 elements of any shape, 2 x 2 x 2 Gauss points. */
#include "hex8_points.h"
#include "kernel.h"
#include "point.h"

CT_CLONES
void ct_solid_hex8_batches(const ct_solid_part *part, int32_t first, int32_t last,
                           const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes x[3 * 8], u[3 * 8], X[CT_MODES], U[CT_MODES], GX[3][3][4], GU[3][3][4], P[8][3][3];
      ct_load_lanes(part->mesh, b, 8, part->mesh->nodes, lane, x);
      ct_load_lanes(part->mesh, b, 8, displacement, lane, u);
      for (int i = 0; i < 3; i++) {
        ct_brick_modes(&x[8 * i], X);
        line_gradients(X, GX[i]);
        ct_brick_modes(&u[8 * i], U);
        line_gradients(U, GU[i]);
      }
      for (int q = 0; q < 8; q++) {
        int line[3] = {q >> 1, (q & 1) + 2 * (q >> 2), q & 3};
        ct_lanes J[3][3], H[3][3];
        for (int i = 0; i < 3; i++)
          for (int j = 0; j < 3; j++) {
            J[i][j] = GX[i][j][line[j]];
            H[i][j] = GU[i][j][line[j]];
          }
        ct_point_stress(J, H, part->lambda, part->mu, P[q]);
      }
      for (int i = 0; i < 3; i++) {
        ct_lanes F[CT_MODES];
        collect_modes(P, i, F);
        ct_brick_nodal(F, &u[8 * i]);
      }
      int64_t stride;
      double *to = ct_batch_values(part->ring, 8, values, b, &stride);
      ct_store_lanes(u, 8, lane, stride, to);
    }
}
