/* A block that flies and rings, filled by hand as a host would: no scene, no contact, no support.
 * Prints steps, bytes and a hash, as one line of JSON. */
#include <libcontact/mesh.h>
#include <libcontact/solid.h>
#include <libcontact/step.h>
#include "../tests/c/defs.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t bytes_now;

void *__real_calloc(size_t count, size_t size);
void __real_free(void *memory);
void *__wrap_calloc(size_t count, size_t size);
void __wrap_free(void *memory);

void *__wrap_calloc(size_t count, size_t size)
{
  void *memory = __real_calloc(count, size);
  if (memory != NULL) bytes_now += malloc_usable_size(memory);
  return memory;
}

void __wrap_free(void *memory)
{
  if (memory != NULL) bytes_now -= malloc_usable_size(memory);
  __real_free(memory);
}

static ct_error error;

static void need(ct_status status)
{
  if (status == CT_OK) return;
  fprintf(stderr, "%s: %s\n", ct_status_name(status), error.text);
  exit(1);
}

static double *numbers(int32_t count) { return calloc((size_t)count, sizeof(double)); }

int main(int count, char **argument)
{
  ct_box box = {{0, 0, 0}, {1, 1, 1}, {16, 16, 16}, CT_LAYERS_Z};
  ct_mesh *mesh;
  ct_effect *solid;
  ct_state *state;
  need(ct_mesh_create_box(CT_HEX8, &box, &mesh, &error));
  ct_body body = {.name = "block",
                  .mesh = mesh,
                  .material = {.young = 2.1e5, .poisson = 0.3, .density = 7.8e-9}};
  ct_solid_body block = {.mesh = mesh, .material = body.material};
  int32_t n = mesh->node_count, steps = count > 1 ? atoi(argument[1]) : 10;
  double *mass = numbers(n), *inverse = numbers(3 * n), *velocity = numbers(3 * n);
  need(create_solid(&block, 1, &solid, &error));
  need(ct_mass_lumped(mesh, body.material.density, CT_LUMP_DEFAULT, mass, &error));
  for (int32_t d = 0; d < 3 * n; d++) {
    inverse[d] = 1.0 / mass[d / 3];
    velocity[d] = d % 3 == 0 ? 1000.0 * (mesh->nodes[d] - 0.5) + 300.0 : 0.0;
  }
  const ct_effect *const effects[1] = {solid};
  ct_problem problem = {.node_count = n,
                        .body_count = 1,
                        .bodies = &body,
                        .reference = mesh->nodes,
                        .mass = mass,
                        .inverse_mass = inverse,
                        .initial_velocity = velocity,
                        .effect_count = 1,
                        .effects = effects,
                        .dt = 5e-9,
                        .threads = 1};
  need(ct_state_create(&problem, &state, &error));
  size_t held = bytes_now;
  need(ct_step_many(&problem, state, steps, &error));
  uint64_t h = 14695981039346656037ull;
  const unsigned char *byte = (const unsigned char *)state->displacement;
  for (size_t i = 0; i < 24 * (size_t)n; i++) h = (h ^ byte[i]) * 1099511628211ull;
  printf("{\"steps\": %d, \"bytes\": %zu, \"hash\": \"%016llx\"}\n", (int)steps, held,
         (unsigned long long)h);
  ct_state_free(state);
  ct_effect_free(solid);
  ct_mesh_free(mesh);
  free(mass);
  free(inverse);
  free(velocity);
  return 0;
}
