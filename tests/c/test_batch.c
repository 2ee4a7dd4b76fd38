/* Batches compared with ct_project, pair by pair and bit for bit, with one, four and eight lanes if
 * this machine has them, and with closed forms. */
#include <libcontact.h>

#include "faces.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

enum { PAIRS = 403, BLOCKS = 51, NAN_PAIR = 17, FLAT_PAIR = 18, HUGE_PAIR = 19 };

/* A batch: the rows of a host, the same in lanes, and memory for the closest points. */
typedef struct batch {
  ct_face_kind kind;
  int per;
  double rows[PAIRS * 24], point[PAIRS * 3];
  double nodes[BLOCKS * 192], points[BLOCKS * 24], start[BLOCKS * 16];
  double xi[BLOCKS * 16], distance[BLOCKS * 8], signed_distance[BLOCKS * 8], normal[BLOCKS * 24];
  int32_t status[BLOCKS * 8], evaluations[BLOCKS * 8];
} batch;

static ct_batch_closest closest_of(batch *b)
{
  ct_batch_closest closest = {b->xi,     b->distance, b->signed_distance,
                              b->normal, b->status,   b->evaluations};
  return closest;
}

/* Rows of the pairs, `per` of each, into lanes; the last block is filled with the last pair. */
static void gather(int per, const double *rows, double *lanes)
{
  for (int p = 0; p < 8 * BLOCKS; p++)
    for (int i = 0; i < 3 * per; i++)
      lanes[(p / 8 * 3 * per + i) * 8 + p % 8] = rows[3 * per * (p < PAIRS ? p : PAIRS - 1) + i];
}

/* Faces from plane to folded, points from on the face to far away, and three invalid pairs. */
static void fill(batch *b, ct_face_kind kind, double distortion)
{
  b->kind = kind;
  b->per = ct_face_node_count(kind);
  for (int p = 0; p < PAIRS; p++) {
    double *row = b->rows + 3 * b->per * p, reach = p % 5 == 0 ? 20 : 1.2;
    for (int i = 0; i < b->per; i++) {
      const double *x = reference(kind, i);
      for (int k = 0; k < 3; k++)
        row[3 * i + k] = (k < 2 ? x[k] : 0.2 * x[0] * x[0]) + uniform(distortion);
      if (p == FLAT_PAIR) row[3 * i] = row[3 * i + 1] = row[3 * i + 2] = 1;
    }
    for (int k = 0; k < 3; k++) b->point[3 * p + k] = uniform(reach);
  }
  b->rows[3 * b->per * NAN_PAIR + 4] = NAN;
  b->point[3 * HUGE_PAIR] = 1e200;
  gather(b->per, b->rows, b->nodes);
  gather(1, b->point, b->points);
}

static int same_bits(double a, double b)
{
  return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b)) || (a == 0 && b == 0);
}

/* The result of ct_project for pair p. */
static ct_projection alone(const batch *b, int p, const double *start,
                           const ct_project_options *options)
{
  ct_face face = {b->kind, {{0}}};
  ct_project_options own = *options;
  ct_projection out;
  memcpy(face.node, b->rows + 3 * b->per * p, sizeof(double) * 3 * (size_t)b->per);
  for (int a = 0; a < 2 && start != NULL; a++) own.start[a] = start[16 * (p / 8) + 8 * a + p % 8];
  own.use_start = start != NULL && fabs(own.start[0]) < HUGE_VAL && fabs(own.start[1]) < HUGE_VAL;
  ct_project(&face, b->point + 3 * p, &own, &out, NULL);
  return out;
}

/* Number of pairs that differ from ct_project in any bit of the result. */
static int differing(const batch *b, const double *start, const ct_project_options *options)
{
  int count = 0;
  for (int p = 0; p < PAIRS; p++) {
    ct_projection out = alone(b, p, start, options);
    int same = b->status[p] == (int32_t)out.status && b->evaluations[p] == out.evaluations;
    same &= same_bits(b->distance[p], out.distance) &&
            same_bits(b->signed_distance[p], out.signed_distance);
    for (int a = 0; a < 2; a++) same &= same_bits(b->xi[16 * (p / 8) + 8 * a + p % 8], out.xi[a]);
    for (int k = 0; k < 3; k++)
      same &= same_bits(b->normal[24 * (p / 8) + 8 * k + p % 8], out.normal[k]);
    count += !same;
  }
  return count;
}

static void batches_agree_with_single_pairs(batch *b, ct_face_kind kind, double distortion)
{
  ct_project_options options = ct_project_options_default();
  fill(b, kind, distortion);
  ct_batch_closest closest = closest_of(b);
  ct_status status = ct_project_batch(kind, PAIRS, b->nodes, b->points, NULL, NULL, &closest, NULL);
  tap_ok(status == CT_OK && differing(b, NULL, &options) == 0,
         "%s, distortion %g: cold, each pair has the bits of ct_project", FACE_NAME[kind],
         distortion);
  int invalid = b->status[NAN_PAIR] == CT_INVALID && b->status[FLAT_PAIR] == CT_INVALID &&
                b->status[HUGE_PAIR] == CT_INVALID;
  tap_ok(invalid && isnan(b->xi[16 * (NAN_PAIR / 8) + NAN_PAIR % 8]),
         "%s: NaN, a face of no size and 1e200 are reported for their pair alone", FACE_NAME[kind]);
  for (int i = 0; i < BLOCKS * 16; i++) b->start[i] = isnan(b->xi[i]) ? 0 : b->xi[i] + uniform(0.1);
  for (int i = 0; i < BLOCKS; i++) b->start[16 * i + 3] = NAN, b->start[16 * i + 12] = HUGE_VAL;
  status = ct_project_batch(kind, PAIRS, b->nodes, b->points, b->start, NULL, &closest, NULL);
  tap_ok(status == CT_OK && differing(b, b->start, &options) == 0,
         "%s, distortion %g: also with a start", FACE_NAME[kind], distortion);
  options.tolerance = 1e-3;
  options.iteration_limit = 2;
  ct_project_batch(kind, PAIRS, b->nodes, b->points, b->start, &options, &closest, NULL);
  tap_ok(differing(b, b->start, &options) == 0,
         "%s: tolerance and iteration limit are those of the options", FACE_NAME[kind]);
}

#if CT_BATCH_KERNELS
/* Hard faces: a collapsed side, points on a node, long and thin, tiny and huge. */
static void worsen(batch *b)
{
  for (int p = 0; p < PAIRS; p++) {
    double *row = b->rows + 3 * b->per * p, *point = b->point + 3 * p;
    double scale = p % 7 == 0 ? pow(10, uniform(60)) : 1, thin = p % 5 == 0 ? 1e-5 : 1;
    if (p % 3 == 0) memcpy(row + 3, row, 3 * sizeof(double));
    if (p % 4 == 0) memcpy(point, row + 6, 3 * sizeof(double));
    for (int i = 0; i < b->per; i++) row[3 * i + 1] *= thin;
    for (int i = 0; i < 3 * b->per; i++) row[i] *= scale;
    for (int k = 0; k < 3; k++) point[k] *= scale;
  }
  gather(b->per, b->rows, b->nodes);
  gather(1, b->point, b->points);
}

static void run(batch *b, ct_batch_kernel *kernel, const double *start)
{
  ct_project_options options = ct_project_options_default();
  ct_batch_closest closest = closest_of(b);
  for (size_t block = 0; block < BLOCKS; block++)
    kernel(b->kind, b->nodes + 24 * (size_t)b->per * block, b->points + 24 * block,
           start != NULL ? start + 16 * block : NULL, &options, &closest, block);
}

static int same_numbers(const double *a, const double *b, int count)
{
  int same = 1;
  for (int i = 0; i < count; i++)
    same &= memcmp(a + i, b + i, sizeof *a) == 0 || (isnan(a[i]) && isnan(b[i]));
  return same;
}

/* All numbers of all pairs with one lane and with several, the sign of zero included. */
static int same_feet(const batch *a, const batch *b)
{
  return same_numbers(a->xi, b->xi, BLOCKS * 16) &&
         same_numbers(a->distance, b->distance, BLOCKS * 8) &&
         same_numbers(a->signed_distance, b->signed_distance, BLOCKS * 8) &&
         same_numbers(a->normal, b->normal, BLOCKS * 24) &&
         memcmp(a->status, b->status, sizeof a->status) == 0 &&
         memcmp(a->evaluations, b->evaluations, sizeof a->evaluations) == 0;
}

static void widths_agree(batch *one, batch *many, ct_face_kind kind, ct_batch_kernel *kernel,
                         int runs, const char *name)
{
  if (!runs) {
    tap_skip("this machine has no %s", name);
    return;
  }
  int cold = 0, warm = 0;
  for (int round = 0; round < 8; round++) {
    fill(one, kind, round % 2 ? 0.6 : 0.1);
    if (round >= 4) worsen(one);
    memcpy(many, one, sizeof *one);
    run(one, ct_batch_kernel_1, NULL);
    run(many, kernel, NULL);
    cold += same_feet(one, many);
    for (int i = 0; i < BLOCKS * 16; i++) one->start[i] = one->xi[i] + uniform(0.1);
    run(one, ct_batch_kernel_1, one->start);
    run(many, kernel, one->start);
    warm += same_feet(one, many);
  }
  tap_ok(cold == 8, "%s, %s: the bits of one lane on ordinary and on hard faces", FACE_NAME[kind],
         name);
  tap_ok(warm == 8, "%s, %s: also with a start", FACE_NAME[kind], name);
}
#endif

/* Over z = x^2 / 2 the point at height g along the normal at (x, y). */
static void feet_on_a_parabolic_cylinder(batch *b)
{
  double want[PAIRS][3], error = 0;
  b->kind = CT_Q8, b->per = 8;
  for (int p = 0; p < PAIRS; p++) {
    double x = uniform(0.95), y = uniform(0.95), g = uniform(0.4), length = sqrt(1 + x * x);
    for (int i = 0; i < 8; i++) {
      double *node = b->rows + 24 * p + 3 * i;
      node[0] = reference(CT_Q8, i)[0], node[1] = reference(CT_Q8, i)[1],
      node[2] = 0.5 * node[0] * node[0];
    }
    b->point[3 * p] = x - g * x / length, b->point[3 * p + 1] = y,
                 b->point[3 * p + 2] = 0.5 * x * x + g / length;
    want[p][0] = x, want[p][1] = y, want[p][2] = g;
  }
  gather(8, b->rows, b->nodes);
  gather(1, b->point, b->points);
  ct_batch_closest closest = closest_of(b);
  ct_project_batch(CT_Q8, PAIRS, b->nodes, b->points, NULL, NULL, &closest, NULL);
  for (int p = 0; p < PAIRS; p++) {
    for (int a = 0; a < 2; a++)
      error = fmax(error, fabs(b->xi[16 * (p / 8) + 8 * a + p % 8] - want[p][a]));
    error = fmax(error, fabs(b->signed_distance[p] - want[p][2]));
  }
  tap_close(error, 0, 1e-14,
            "points stepped off a parabolic cylinder come back to their closest points");
}

static void impossible_arguments(batch *b)
{
  ct_project_options options = ct_project_options_default();
  ct_batch_closest closest = closest_of(b), none = {NULL, NULL, NULL, NULL, NULL, NULL};
  fill(b, CT_Q8, 0.6);
  b->status[0] = -7;
  int good = ct_project_batch((ct_face_kind)9, 8, b->nodes, b->points, NULL, NULL, &closest,
                              NULL) == CT_ERROR_ARGUMENT;
  good &=
      ct_project_batch(CT_Q8, 8, NULL, b->points, NULL, NULL, &closest, NULL) == CT_ERROR_ARGUMENT;
  good &=
      ct_project_batch(CT_Q8, 8, b->nodes, NULL, NULL, NULL, &closest, NULL) == CT_ERROR_ARGUMENT;
  good &=
      ct_project_batch(CT_Q8, 8, b->nodes, b->points, NULL, NULL, NULL, NULL) == CT_ERROR_ARGUMENT;
  options.tolerance = 0;
  good &= ct_project_batch(CT_Q8, 8, b->nodes, b->points, NULL, &options, &closest, NULL) ==
          CT_ERROR_ARGUMENT;
  options.tolerance = 1e-10, options.iteration_limit = -1;
  good &= ct_project_batch(CT_Q8, 8, b->nodes, b->points, NULL, &options, &closest, NULL) ==
          CT_ERROR_ARGUMENT;
  tap_ok(good && b->status[0] == -7, "invalid arguments are refused, and nothing is written");
  good = ct_project_batch(CT_Q8, 0, NULL, NULL, NULL, NULL, &closest, NULL) == CT_OK;
  good &= ct_project_batch(CT_Q8, PAIRS, b->nodes, b->points, NULL, NULL, &none, NULL) == CT_OK;
  tap_ok(good, "no pairs, and no arrays to write to, are allowed");
}

int main(void)
{
  batch *b = calloc(1, sizeof *b), *many = calloc(1, sizeof *many);
  if (b == NULL || many == NULL) return 1;
  for (int kind = 0; kind < 4; kind++) {
    batches_agree_with_single_pairs(b, (ct_face_kind)kind, 0.1);
    batches_agree_with_single_pairs(b, (ct_face_kind)kind, 0.6);
  }
#if CT_BATCH_KERNELS
  for (int kind = 0; kind < 4; kind++) {
    widths_agree(b, many, (ct_face_kind)kind, ct_batch_kernel_4,
                 __builtin_cpu_supports("avx2") != 0, "four lanes (AVX2)");
    widths_agree(b, many, (ct_face_kind)kind, ct_batch_kernel_8,
                 __builtin_cpu_supports("avx512f") != 0, "eight lanes (AVX-512)");
  }
#endif
  feet_on_a_parabolic_cylinder(b);
  impossible_arguments(b);
  free(b);
  free(many);
  return tap_done();
}
