/* The kernel for hex20 elements of any shape, 3 x 3 x 3 Gauss points. */
#include "hex20_points.h"
#include "kernel.h"
#include "point.h"

CT_CLONES
void ct_solid_hex20_batches(const ct_solid_part *part, int32_t first, int32_t last,
                            const double *displacement, double *values)
{
  for (int32_t b = first; b < last; b++)
    for (int lane = 0; lane < CT_BATCH; lane += CT_LANES_COUNT) {
      ct_lanes x[3 * 20], u[3 * 20], P[27][3][3], J[3][3], H[3][3];
      ct_load_lanes(part->mesh, b, 20, part->mesh->nodes, lane, x);
      ct_load_lanes(part->mesh, b, 20, displacement, lane, u);
      for (int i = 0; i < 3; i++) {
        centre(&x[20 * i]);
        centre(&u[20 * i]);
      }
      for (int q = 0; q < 27; q++) {
        reference_gradient(part->gradients[q], x, J);
        reference_gradient(part->gradients[q], u, H);
        ct_point_stress(J, H, part->lambda, part->mu, P[q]);
      }
      for (int i = 0; i < 3; i++)
        for (int a = 0; a < 20; a++) nodal_force(P, part->gradients, a, i, &u[20 * i + a]);
      ct_store_lanes(u, 20, lane, 8, &values[480 * (int64_t)b]);
    }
}
