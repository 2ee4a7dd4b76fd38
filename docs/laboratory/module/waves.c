/* Closed forms and waves of a mesh. */
#include "module.h"

/* The exact solution of the plates at `count` points in `numbers`, rows x, z, t and two unused
 * numbers: sigma_x, sigma_z, tau_xz, v_x, v_z take their place. */
EXPORT(exact_plates) ct_status exact_plates(int count, double poisson)
{
  double *rows = numbers(5 * count);
  for (int i = 0; i < count; i++) {
    double *row = &rows[5 * i], x = row[0], z = row[1], t = row[2];
    ct_status status = ct_exact_plates(1, &x, &z, &t, poisson, 1e300, row, NULL, &page_error);
    if (status != CT_OK) return status;
  }
  return CT_OK;
}

EXPORT(wave_speeds) const double *wave_speeds(double poisson)
{
  double *out = numbers(2);
  return ct_exact_speeds(poisson, &out[0], &out[1], &page_error) ? NULL : out;
}

static ct_dispersion_def mesh(int kind, double poisson, int scheme, double courant)
{
  ct_dispersion_def def = ct_dispersion_def_default();
  double c1, c2;
  def.kind = (ct_brick_kind)kind;
  def.material.poisson = poisson;
  def.integrator = ct_integrator_default((ct_scheme)scheme);
  ct_material_speeds(&def.material, &c1, &c2);
  def.step = courant / c1;
  return def;
}

/* Cubes with edge 1 and E = rho = 1, at a Courant number (0: continuous time). At `count` wave
 * vectors in `numbers`, shape (count, 3), the frequencies of the branches and their decay rates
 * take their place: rows of 6 (hex8) or 24 (hex20) numbers. */
EXPORT(dispersion)
ct_status dispersion(int kind, double poisson, int scheme, double courant, int count)
{
  int branches = kind == CT_HEX20 ? 12 : 3;
  ct_dispersion_def def = mesh(kind, poisson, scheme, courant);
  double *rows = numbers(2 * branches * count);
  for (int i = count - 1; i >= 0; i--) {
    ct_branch found[12];
    const double wave[3] = {rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]};
    ct_status status = ct_dispersion(&def, 1, wave, found, &page_error);
    if (status != CT_OK) return status;
    for (int b = 0; b < branches; b++) {
      rows[2 * (branches * i + b)] = found[b].omega;
      rows[2 * (branches * i + b) + 1] = found[b].decay;
    }
  }
  return CT_OK;
}

/* Stress behind a front along (p, q, r) after `steps` steps, or, with Courant number 0, at the time
 * `steps` / 16 over c1, at `count` distances in `numbers`; the stresses follow them. */
EXPORT(front)
ct_status front(int kind, double poisson, int scheme, double courant, int p, int q, int r,
                int steps, int count)
{
  ct_dispersion_def def = mesh(kind, poisson, scheme, courant);
  double *rows = numbers(2 * count), c1, c2;
  const int32_t normal[3] = {p, q, r};
  ct_material_speeds(&def.material, &c1, &c2);
  double time = def.step > 0.0 ? steps * def.step : steps / (16.0 * c1);
  return ct_dispersion_front(&def, normal, time, (size_t)count, rows, rows + count, &page_error);
}
