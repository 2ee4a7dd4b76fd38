/* Phase and group velocity of waves in a mesh, and the front of a step as their sum. */
#include "bloch.h"
#include "clock.h"

#include "../base/error.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

enum { LARGEST_INDEX = 16, MOST_PLANES = 100000 };

ct_dispersion_def ct_dispersion_def_default(void)
{
  return (ct_dispersion_def){
      .cookie = CT_DEF_COOKIE, .size = {1.0, 1.0, 1.0}, .material = {.young = 1.0, .density = 1.0}};
}

static ct_status begin(const ct_dispersion_def *def, ct_bloch *bloch, ct_error *error)
{
  if (def == NULL) return CT_REFUSE(error, "dispersion: a required argument is null");
  if (def->cookie != CT_DEF_COOKIE)
    return CT_REFUSE(error, "dispersion: begin with ct_dispersion_def_default()");
  if (!(def->step >= 0.0 && def->step < HUGE_VAL))
    return CT_REFUSE(error, "dispersion: step must be 0 or positive and finite, not %g", def->step);
  ct_status status = ct_integrator_check(&def->integrator, error);
  return status == CT_OK ? ct_bloch_init(def, bloch, error) : status;
}

/* One wave with time steps. */
static ct_branch branch_of(const ct_dispersion_def *def, const ct_bloch *bloch,
                           const ct_bloch_wave *wave)
{
  ct_branch out = {.omega_mesh = sqrt(wave->omega2)};
  ct_clock clock = {0.0, 0.0, 1.0};
  if (def->step > 0.0) clock = ct_clock_of(&def->integrator, out.omega_mesh * def->step);
  out.omega = def->step > 0.0 ? clock.angle / def->step : out.omega_mesh;
  out.decay = def->step > 0.0 ? clock.damping / def->step : 0.0;
  // -- Space and time by the chain rule (eq:group-velocity)
  for (int d = 0; d < 3; d++)
    out.group[d] = clock.slope * (wave->slope[d] / (2.0 * out.omega_mesh));
  for (int i = 0; i < 3 * bloch->families; i++) out.shape[i] = sqrt(bloch->mass) * wave->shape[i];
  return out;
}

ct_status ct_dispersion(const ct_dispersion_def *def, size_t count, const double *wave,
                        ct_branch *branches, ct_error *error)
{
  ct_bloch bloch;
  ct_status status = begin(def, &bloch, error);
  if (status != CT_OK) return status;
  if (count > 0 && (wave == NULL || branches == NULL)) return CT_REFUSE_NULL(error);
  for (size_t i = 0; i < 3 * count; i++)
    if (!(fabs(wave[i]) < HUGE_VAL))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, (int64_t)(i / 3)},
                     "dispersion: the components of the wave vector must be finite, not %g",
                     wave[i]);
  const size_t n = 3 * (size_t)bloch.families;
  for (size_t i = 0; i < count; i++) {
    ct_bloch_wave found[CT_CELL_SIZE];
    ct_bloch_waves(&bloch, &wave[3 * i], found);
    for (size_t m = 0; m < n; m++) branches[n * i + m] = branch_of(def, &bloch, &found[m]);
  }
  return CT_OK;
}

/* A front: planes of nodes at whole multiples of `spacing` along the unit vector `normal`, those of
 * a family shifted by half a spacing if `half`. */
typedef struct front {
  const ct_dispersion_def *def;
  ct_bloch bloch;
  double time, normal[3], spacing, bar[20][3];
  int half[4];
  int64_t steps, planes; /* planes in a period of the sum */
} front;

static ct_status find_planes(front *f, const int32_t index[3], ct_error *error)
{
  int32_t divisor = 0;
  for (int d = 0; d < 3; d++) {
    if (index[d] > LARGEST_INDEX || index[d] < -LARGEST_INDEX)
      return CT_REFUSE(error, "dispersion: normal[%d] must be -%d to %d, not %d", d, LARGEST_INDEX,
                       LARGEST_INDEX, index[d]);
    for (int32_t a = index[d] < 0 ? -index[d] : index[d]; a != 0;) {
      int32_t rest = divisor % a;
      divisor = a, a = rest;
    }
  }
  if (divisor == 0)
    return CT_REFUSE(error, "dispersion: the normal is zero; it must have a direction");
  // -- Planes of nodes and where the families stand between them
  double length = 0.0;
  for (int d = 0; d < 3; d++) {
    const int reduced = index[d] / divisor;
    f->normal[d] = reduced / f->def->size[d];
    f->half[1 + d] = reduced % 2 != 0;
    length += f->normal[d] * f->normal[d];
  }
  f->spacing = 1.0 / sqrt(length); // (eq:front-planes)
  for (int d = 0; d < 3; d++) f->normal[d] *= f->spacing;
  return CT_OK;
}

/* A period such that no waves of neighbouring fronts arrive until then. */
static ct_status find_period(front *f, size_t count, const double *distance, ct_error *error)
{
  double c1, c2, farthest = 0.0;
  ct_material_speeds(&f->def->material, &c1, &c2);
  for (size_t i = 0; i < count; i++) {
    if (!(fabs(distance[i]) < HUGE_VAL))
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, -1, (int64_t)i},
                     "dispersion: distance must be finite, not %g", distance[i]);
    farthest = fmax(farthest, fabs(distance[i]));
  }
  const double quarter = (c1 * f->time + farthest) / f->spacing + 16.0;
  if (!(4.0 * quarter < (double)MOST_PLANES))
    return CT_REFUSE(
        error, "dispersion: the front and the distances are more than %d planes of nodes away",
        MOST_PLANES / 8);
  f->planes = 4 * (int64_t)ceil(quarter);
  return CT_OK;
}

static ct_status find_steps(front *f, double time, ct_error *error)
{
  const double steps = f->def->step > 0.0 ? time / f->def->step : 0.0;
  if (!(time >= 0.0 && time < HUGE_VAL && steps < 1e15))
    return CT_REFUSE(
        error, "dispersion: time must be 0 or positive, and at most 1e15 steps, not %g", time);
  if (fabs(steps - nearbyint(steps)) > 1e-6)
    return CT_REFUSE(error,
                     "dispersion: time must be a whole number of steps, but %g is %.9g steps", time,
                     steps);
  f->time = time;
  f->steps = (int64_t)nearbyint(steps);
  return CT_OK;
}

/* Displacements of the families in all waves of one wave number, at the time of the front, from
 * the velocity 1 along the normal. */
static void displacements(const front *f, double k, double u[CT_CELL_SIZE])
{
  ct_bloch_wave wave[CT_CELL_SIZE];
  const int n = 3 * f->bloch.families;
  double vector[3], M[4][4], V[CT_CELL_SIZE] = {0.0};
  for (int d = 0; d < 3; d++) vector[d] = k * f->normal[d];
  ct_bloch_waves(&f->bloch, vector, wave);
  ct_bloch_mass(&f->bloch, vector, M);
  memset(u, 0, sizeof(double) * CT_CELL_SIZE);
  // -- Part of the step with this wave number in each family, times M (eq:front-start)
  for (int a = 0; a < f->bloch.families; a++)
    for (int b = 0; b < f->bloch.families; b++) {
      const double angle = 0.5 * k * f->spacing;
      const double jump = f->half[b] ? 1.0 / sin(angle) : cos(angle) / sin(angle);
      for (int i = 0; i < 3; i++) V[3 * a + i] += M[a][b] * jump * f->normal[i];
    }
  // -- Each wave has its part of the velocity and oscillates (eq:front-time)
  for (int m = 0; m < n; m++) {
    double omega = sqrt(wave[m].omega2), share = 0.0, step = f->def->step;
    for (int i = 0; i < n; i++) share += wave[m].shape[i] * V[i];
    share *= step > 0.0    ? step * ct_clock_advance(&f->def->integrator, omega * step, f->steps)
             : omega > 0.0 ? sin(omega * f->time) / omega
                           : f->time;
    for (int i = 0; i < n; i++) u[i] += share * wave[m].shape[i];
  }
}

/* The stress across the planes at element centres from displacements u sin(k s), without the factor
 * cos(k s). */
static double centre_stress(const front *f, double k, const double u[CT_CELL_SIZE])
{
  static const double CENTRE[3] = {0.0, 0.0, 0.0};
  double x[20][3], dN[20][3], lambda, mu, volume = 0.0, along = 0.0;
  memcpy(x, f->bloch.x, sizeof x);
  ct_element_gradients(f->def->kind, x, CENTRE, dN);
  ct_material_lame(&f->def->material, &lambda, &mu);
  for (int a = 0; a < f->bloch.per; a++) {
    double from[3];
    const double *v = &u[3 * f->bloch.family[a]];
    for (int d = 0; d < 3; d++) from[d] = x[a][d] - 0.5 * f->def->size[d];
    const double sine = sin(k * ct_vector_dot(f->normal, from));
    volume += sine * ct_vector_dot(v, dN[a]);
    along += sine * ct_vector_dot(f->normal, v) * ct_vector_dot(f->normal, dN[a]);
  }
  return lambda * volume + 2.0 * mu * along; // (eq:front-stress)
}

ct_status ct_dispersion_front(const ct_dispersion_def *def, const int32_t normal[3], double time,
                              size_t count, const double *distance, double *stress, ct_error *error)
{
  front f = {.def = def};
  ct_status status = begin(def, &f.bloch, error);
  if (status == CT_OK && (normal == NULL || (count > 0 && (distance == NULL || stress == NULL))))
    return CT_REFUSE_NULL(error);
  if (status == CT_OK) status = find_planes(&f, normal, error);
  if (status == CT_OK) status = find_steps(&f, time, error);
  if (status == CT_OK) status = find_period(&f, count, distance, error);
  if (status != CT_OK) return status;

  double c1, c2;
  ct_material_speeds(&def->material, &c1, &c2);
  for (size_t i = 0; i < count; i++) stress[i] = 0.0;
  // -- Add up the odd waves of the period (eq:front-sum)
  for (int64_t j = 1; j < f.planes / 2; j += 2) {
    const double k = 2.0 * acos(-1.0) * (double)j / ((double)f.planes * f.spacing);
    double u[CT_CELL_SIZE];
    displacements(&f, k, u);
    const double share =
        4.0 / (double)f.planes * centre_stress(&f, k, u) / (def->material.density * c1);
    for (size_t i = 0; i < count; i++) stress[i] += share * cos(k * distance[i]);
  }
  return CT_OK;
}
