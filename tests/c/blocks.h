/* The solid effect of one mesh by itself, and the readable form of its forces. */
#ifndef BLOCKS_H
#define BLOCKS_H

#include "bodies.h"
#include "defs.h"

/* The solid effect of one mesh, with the objects that its calls need. */
typedef struct block {
  ct_effect *effect;
  void *scratch;
} block;

static const ct_run_settings TWO = {.threads = 2};

static inline block open_body(ct_solid_body b)
{
  block solid = {NULL, NULL};
  must(create_solid, &b, 1, &solid.effect);
  later_effect(solid.effect);
  must(solid.effect->calls->create_scratch, solid.effect, &solid.scratch);
  free_later(solid.scratch, solid.effect->calls->free_scratch);
  return solid;
}

static inline block open_block(const ct_mesh *m, const ct_material *material,
                               ct_solid_kernel kernel)
{
  return open_body((ct_solid_body){.mesh = m, .material = *material, .kernel = kernel});
}

static inline void close_block(block *solid)
{
  solid->effect->calls->free_scratch(unlist(solid->scratch));
  free_effect(solid->effect);
}

/* Forces at the displacement u, and the energy. */
static inline double block_force(const block *solid, const double *u, double *f)
{
  ct_view view = {.displacement = u, .scratch = solid->scratch};
  double energy = NAN;
  must(solid->effect->calls->force, solid->effect, &view, f);
  must(solid->effect->calls->energy, solid->effect, &view, &energy);
  return energy;
}

static inline double block_frequency(const block *solid)
{
  ct_view view = {.scratch = solid->scratch};
  double omega_squared = NAN;
  must(solid->effect->calls->bounds.omega2, solid->effect, &view, &omega_squared);
  return omega_squared;
}

static inline double *random_displacement(const ct_mesh *m, double amount)
{
  double *u = numbers(3 * m->node_count);
  for (int i = 0; i < 3 * m->node_count; i++) u[i] = uniform(amount);
  return u;
}

/* Rayleigh's quotient of a mesh of which components are held, after many rounds of the power
 * method: a lower bound on the largest eigenvalue, which it finally reaches. */
static inline double block_quotient(const block *solid, const ct_mesh *m, double density,
                                    const int held[3], int rounds)
{
  int n = 3 * m->node_count;
  double *v = random_displacement(m, 1.0), *f = numbers(n), *mass = numbers(m->node_count),
         quotient = 0.0;
  must(ct_mass_lumped, m, density, CT_LUMP_DEFAULT, mass);
  for (int k = 0; k < rounds; k++) {
    double work = 0.0, kinetic = 0.0;
    for (int i = 0; i < n; i++) v[i] = held[i % 3] ? 0.0 : v[i];
    double top = largest(v, n);
    for (int i = 0; i < n; i++) v[i] /= top;
    block_force(solid, v, f);
    for (int i = 0; i < n; i++) {
      if (held[i % 3]) continue;
      work -= f[i] * v[i];
      kinetic += mass[i / 3] * v[i] * v[i];
      v[i] = -f[i] / mass[i / 3];
    }
    quotient = work / kinetic;
  }
  return quotient;
}

/* Forces and energy of all elements by the readable form, added up node by node. */
static inline double reference_force(const ct_mesh *m, const ct_material *material, const double *u,
                                     double *f)
{
  int per = ct_brick_node_count(m->kind);
  double total = 0.0;
  memset(f, 0, 3 * (size_t)m->node_count * sizeof *f);
  for (int el = 0; el < m->element_count; el++) {
    double x[60], v[60], g[60], energy;
    take_element(m, el, m->nodes, x);
    take_element(m, el, u, v);
    must(ct_solid_element_force, m->kind, x, v, material, g, &energy);
    for (int a = 0; a < per; a++)
      for (int c = 0; c < 3; c++) f[3 * m->elements[el * per + a] + c] += g[3 * a + c];
    total += energy;
  }
  return total;
}

#endif
