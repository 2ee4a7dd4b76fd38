#include "batch_internal.h"

#include <math.h>

/* The widest kernel that this machine runs; null where there is none. */
static ct_batch_kernel *kernel_for(ct_face_kind kind)
{
#if CT_BATCH_KERNELS
  if (kind != CT_Q4 && kind != CT_Q8) return NULL;
  if (__builtin_cpu_supports("avx512f")) return ct_batch_quadrilaterals_8;
  if (__builtin_cpu_supports("avx2")) return ct_batch_quadrilaterals_4;
#else
  (void)kind;
#endif
  return NULL;
}

/* The face and the point of one lane. */
static void take_lane(ct_face_kind kind, const double *nodes, const double *points, int lane,
                      ct_face *face, double point[3])
{
  face->kind = kind;
  for (int i = 0; i < ct_face_node_count(kind); i++)
    for (int k = 0; k < 3; k++) face->node[i][k] = nodes[8 * (3 * i + k) + lane];
  for (int k = 0; k < 3; k++) point[k] = points[8 * k + lane];
}

/* Does the single search accept the foot of a lane, too? (eq:robust-hidden) */
static int is_closest(ct_face_kind kind, const double *nodes, const double *points,
                      const double xi[16], const ct_batch_feet *feet, size_t block, int lane)
{
  ct_face face;
  ct_patch patch;
  ct_foot foot = {{0, 0}, {0, 0, 0}, 0, 0, 0};
  double point[3], own[2] = {xi[lane], xi[8 + lane]};
  take_lane(kind, nodes, points, lane, &face, point);
  if (ct_patch_init(&patch, kind, (const double (*)[3])face.node, point) != CT_OK ||
      !ct_proof_at_sight(&patch, own, 2, &foot))
    return 0;
  if (feet->evaluations != NULL)
    feet->evaluations[8 * block + (size_t)lane] += foot.evaluations - 1;
  return 1;
}

/* One lane of a block, by ct_project. */
static void project_lane(ct_face_kind kind, const double *nodes, const double *points,
                         const double *start, const ct_project_options *options, double xi[16],
                         const ct_batch_feet *feet, size_t block, int lane)
{
  ct_face face = {kind, {{0}}};
  ct_project_options own = *options;
  ct_projection out;
  double point[3];
  take_lane(kind, nodes, points, lane, &face, point);
  own.method = CT_ROBUST;
  own.trace = NULL;
  own.use_start = start != NULL && fabs(start[lane]) < HUGE_VAL && fabs(start[8 + lane]) < HUGE_VAL;
  for (int a = 0; a < 2 && own.use_start; a++) own.start[a] = start[8 * a + lane];
  ct_project(&face, point, &own, &out);
  size_t at = 8 * block + (size_t)lane;
  if (feet->distance != NULL) feet->distance[at] = out.distance;
  if (feet->signed_distance != NULL) feet->signed_distance[at] = out.signed_distance;
  if (feet->status != NULL) feet->status[at] = (int32_t)out.status;
  if (feet->evaluations != NULL) feet->evaluations[at] = (int32_t)out.evaluations;
  for (int a = 0; a < 2; a++) xi[8 * a + lane] = out.xi[a];
  for (size_t k = 0; k < 3 && feet->normal != NULL; k++)
    feet->normal[8 * (3 * block + k) + (size_t)lane] = out.normal[k];
}

/* Ask for the numbers of a block, which come while the one before is computed. */
static inline void fetch(const double *values, size_t count)
{
#if CT_BATCH_KERNELS
  for (size_t i = 0; i < count; i += 8) __builtin_prefetch(values + i);
#else
  (void)values, (void)count;
#endif
}

size_t ct_batch_blocks(size_t count) { return (count + 7) / 8; }

void ct_batch_gather(size_t count, int per, const double *rows, const int32_t *number,
                     double *lanes)
{
  if (count == 0 || rows == NULL || lanes == NULL) return;
  size_t width = per > 0 ? (size_t)per : 0;
  for (size_t p = 0; p < 8 * ct_batch_blocks(count); p++)
    for (size_t i = 0; i < width; i++) {
      size_t place = (p < count ? p : count - 1) * width + i,
             row = number != NULL ? (size_t)number[place] : place;
      for (size_t k = 0; k < 3; k++)
        lanes[((p / 8 * width + i) * 3 + k) * 8 + p % 8] = rows[3 * row + k];
    }
}

ct_status ct_project_batch(ct_face_kind kind, size_t count, const double *nodes,
                           const double *points, const double *start,
                           const ct_project_options *options, const ct_batch_feet *feet)
{
  ct_project_options defaults = ct_project_options_default();
  if (options == NULL) options = &defaults;
  size_t per = (size_t)ct_face_node_count(kind);
  if (per == 0 || feet == NULL || !(options->tolerance > 0 && options->tolerance < HUGE_VAL) ||
      options->iteration_limit < 0)
    return CT_ERROR_ARGUMENT;
  if (count > 0 && (nodes == NULL || points == NULL)) return CT_ERROR_ARGUMENT;
  ct_batch_kernel *kernel = kernel_for(kind);
  for (size_t block = 0; block < ct_batch_blocks(count); block++) {
    const double *x = nodes + 24 * per * block, *p = points + 24 * block,
                 *from = start != NULL ? start + 16 * block : NULL;
    double xi[16];
    if (block + 1 < ct_batch_blocks(count)) fetch(x + 24 * per, 24 * per), fetch(p + 24, 24);
    unsigned hard = kernel != NULL ? kernel(kind, x, p, from, options, xi, feet, block) : 255;
    // -- Lanes in trouble, and triangles, one at a time
    for (int lane = 0; lane < 8 && hard != 0; lane++) {
      int alone = (int)(hard >> lane & 1), doubtful = (int)(hard >> lane >> 8 & 1);
      if (alone || (doubtful && !is_closest(kind, x, p, xi, feet, block, lane)))
        project_lane(kind, x, p, from, options, xi, feet, block, lane);
    }
    for (int i = 0; i < 16 && feet->xi != NULL; i++) feet->xi[16 * block + (size_t)i] = xi[i];
  }
  return CT_OK;
}
