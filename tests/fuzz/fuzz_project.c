/* A fuzz target for every projection: any bytes are a face, a point and options. It aborts where a
 * promise is broken.
 *
 * `make fuzz` runs it with libFuzzer if the compiler has it. Else FUZZ_MAIN makes it a program that
 * takes the number of pseudo-random inputs. */
#include "../../libcontact/src/projection/projection_internal.h"

#include <libcontact/ray.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
void fuzz_random_inputs(long inputs);

/* Answers so far, by status. */
static long long answers[CT_ERROR_ARGUMENT + 1];

static void demand(int ok, const char *what)
{
  if (ok) return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

static int count_nan(const double *values, int count)
{
  int found = 0;
  for (int i = 0; i < count; i++) found += isnan(values[i]) != 0;
  return found;
}

/* Number of methods: all that exist. */
static int method_count(void)
{
  int count = 0;
  while (ct_method_exists((ct_method)count)) count++;
  return count;
}

static void check_projection(const ct_projection *p, const ct_project_options *options)
{
  double all[10];
  memcpy(all, p->xi, sizeof p->xi);
  memcpy(all + 2, p->point, sizeof p->point);
  memcpy(all + 5, p->normal, sizeof p->normal);
  all[8] = p->distance, all[9] = p->signed_distance;
  int nans = count_nan(all, 10), last = options->method == CT_CERTIFIED ? 120000 : 20000;
  demand(p->status >= CT_OK && p->status <= CT_ERROR_ARGUMENT, "a status of its own");
  demand(nans == 0 || nans == 10, "all numbers or none");
  demand((p->status != CT_INVALID && p->status != CT_ERROR_ARGUMENT) || nans == 10,
         "no numbers without an answer");
  demand((p->status != CT_OK && p->status != CT_NOT_CERTIFIED) || nans == 0,
         "numbers with an answer");
  demand(p->evaluations >= 0 && p->evaluations <= last && p->iterations <= last, "bounded work");
  demand(!p->certified || (options->method == CT_CERTIFIED && p->status == CT_OK),
         "certificates from certified alone");
  demand(nans > 0 || p->distance >= 0, "a distance that is not negative");
  demand(nans > 0 || (options->method != CT_ROBUST && options->method != CT_CERTIFIED) ||
             p->where != CT_OUTSIDE,
         "robust stays on the face");
}

/* Numbers from bytes: a mix of moderate ones, which reach deep, and raw ones. */
static double number(const uint8_t **data, size_t *size, int raw)
{
  double value = 0;
  if (raw && *size >= 8) {
    memcpy(&value, *data, 8);
    *data += 8, *size -= 8;
  } else if (*size >= 2) {
    value = ((double)(*data)[0] * 256 + (double)(*data)[1] - 32768) / 16384;
    *data += 2, *size -= 2;
  }
  return value;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  if (size < 3) return 0;
  int raw = data[0] % 4 == 0, flags = data[1];
  ct_face face = {(ct_face_kind)(data[0] / 4 % 5), {{0}}};
  ct_project_options options = ct_project_options_default();
  options.method = (ct_method)(data[2] % (method_count() + 1));
  data += 3, size -= 3;
  double point[3], direction[3];
  for (int k = 0; k < 3; k++) point[k] = number(&data, &size, raw);
  for (int i = 0; i < 24; i++) face.node[i / 3][i % 3] = number(&data, &size, raw);
  if (flags & 1)
    memcpy(face.node[flags / 16 % 4], face.node[(flags / 16 + 1) % 4], sizeof face.node[0]);
  if (flags & 2)
    options.use_start = 1, options.start[0] = number(&data, &size, raw),
    options.start[1] = number(&data, &size, raw);
  if (flags & 4) options.tolerance = ldexp(1, -(flags / 8));
  if (flags & 8) options.iteration_limit = flags / 16;
  ct_projection out;
  memset(&out, 0x7f, sizeof out);
  ct_status status = ct_project(&face, point, &options, &out, NULL);
  demand(status == out.status, "the status is returned and written");
  check_projection(&out, &options);
  answers[status]++;
  for (int k = 0; k < 3; k++) direction[k] = number(&data, &size, raw);
  ct_ray_hit hit;
  memset(&hit, 0x7f, sizeof hit);
  status = ct_project_rays(&face, 1, point, direction, 1e-10, &hit, NULL);
  demand(status == (hit.status < CT_ERROR_ARGUMENT ? CT_OK : hit.status) &&
             hit.evaluations <= 100000,
         "a ray ends");
  status = hit.status;
  demand((status == CT_OK || status == CT_NOT_CERTIFIED) == !isnan(hit.distance),
         "a ray has a distance if it hits");
  return 0;
}

/* Where there is no fuzzer: pseudo-random bytes; every other input changes only some bytes of the
 * last one. */
void fuzz_random_inputs(long inputs)
{
  unsigned long long seed = 88172645463325252ull;
  uint8_t bytes[300] = {0};
  for (long i = 0; i < inputs; i++) {
    for (size_t j = 0; j < sizeof bytes; j++) {
      seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
      if (i % 2 == 0 || seed % 16 == 0) bytes[j] = (uint8_t)(seed >> 32);
    }
    LLVMFuzzerTestOneInput(bytes, i % 8 == 0 ? (size_t)(seed >> 40) % sizeof bytes : sizeof bytes);
  }
}

#ifdef FUZZ_MAIN
int main(int count, char **argument)
{
  long inputs = count > 1 ? atol(argument[1]) : 1000000;
  fuzz_random_inputs(inputs);
  printf("%ld inputs, no promise broken\n", inputs);
  return 0;
}
#endif
