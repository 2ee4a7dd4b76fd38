/* The run of a page's scene, and what the page reads of it. */
#include "module.h"

#include <stdlib.h>

enum { MOST_PROBES = 16 };

static ct_probe_def probes[MOST_PROBES];
static int32_t nodes[MOST_PROBES];
static int32_t on[MOST_PROBES][2];
static char names[MOST_PROBES][3];
static int32_t probe_count;

static ct_probe_def *next_probe(int every)
{
  if (probe_count == MOST_PROBES) return NULL;
  ct_probe_def *probe = &probes[probe_count];
  *probe = ct_probe_def_default();
  names[probe_count][0] = 'p';
  names[probe_count][1] = (char)('A' + probe_count);
  probe->name = names[probe_count++];
  probe->every = every;
  return probe;
}

EXPORT(clear_probes) void clear_probes(void)
{
  ct_probes_free(page.probes);
  page.probes = NULL;
  probe_count = 0;
}

/* Displacement and velocity of the node of a body that is nearest to a point at the start. */
EXPORT(probe_point) ct_status probe_point(int body, double x, double y, double z, int every)
{
  const ct_body *of = &page.problem->bodies[body];
  ct_probe_def *probe = next_probe(every);
  if (probe == NULL) return CT_ERROR_ARGUMENT;
  double least = 1e300;
  int32_t *node = &nodes[probe_count - 1];
  for (int32_t i = 0; i < of->mesh->node_count; i++) {
    const double *X = &of->mesh->nodes[3 * i];
    double r = (X[0] - x) * (X[0] - x) + (X[1] - y) * (X[1] - y) + (X[2] - z) * (X[2] - z);
    if (r >= least) continue;
    least = r;
    *node = of->first_node + i;
  }
  probe->nodes = node;
  probe->node_count = 1;
  probe->take[CT_QUANTITY_DISPLACEMENT] = probe->take[CT_QUANTITY_VELOCITY] = 1;
  return CT_OK;
}

/* The nodes of a body, ascending. */
static int32_t *all_nodes(const ct_body *of)
{
  int32_t *list = malloc((size_t)of->mesh->node_count * sizeof *list);
  for (int32_t i = 0; list != NULL && i < of->mesh->node_count; i++) list[i] = of->first_node + i;
  return list;
}

/* Force on a body of contact number `number` (`obstacle`: of this obstacle), its friction included.
 */
EXPORT(probe_force) ct_status probe_force(int body, int obstacle, int number, int every)
{
  ct_probe_def *probe = next_probe(every);
  if (probe == NULL) return CT_ERROR_ARGUMENT;
  int32_t *effect = on[probe_count - 1];
  ct_effect_kind kind = obstacle ? CT_EFFECT_OBSTACLE : CT_EFFECT_CONTACT;
  for (int32_t k = 0; k < page.problem->effect_count; k++) {
    if (page.problem->effects[k]->kind != kind || number-- > 0) continue;
    effect[0] = k;
    effect[1] = k + 1;
    probe->effect_count = 1;
    if (k + 1 < page.problem->effect_count)
      probe->effect_count += page.problem->effects[k + 1]->kind == CT_EFFECT_FRICTION;
    break;
  }
  if (probe->effect_count == 0) return CT_ERROR_ARGUMENT;
  probe->effects = effect;
  probe->nodes = all_nodes(&page.problem->bodies[body]);
  probe->node_count = page.problem->bodies[body].mesh->node_count;
  probe->take[CT_QUANTITY_FORCE] = 1;
  return CT_OK;
}

EXPORT(start_probes) ct_status start_probes(void)
{
  ct_status status = ct_probes_create(page.problem, probes, probe_count, &page.probes, &page_error);
  for (int32_t i = 0; i < probe_count; i++)
    if (probes[i].effects != NULL) free((void *)probes[i].nodes);
  return status;
}

/* Rows of a probe: their number, and where they are. */
EXPORT(probe_row_count) int probe_row_count(int probe)
{
  ct_probe_history history;
  if (ct_probes_history(page.probes, probe, &history, &page_error)) return 0;
  return (int)history.row_count;
}

EXPORT(probe_rows) const double *probe_rows(int probe)
{
  ct_probe_history history;
  if (ct_probes_history(page.probes, probe, &history, &page_error)) return NULL;
  return history.rows;
}

/* The row of the present state, which a run records only when the next step begins. */
EXPORT(sample_probes) ct_status sample_probes(void)
{
  if (page.probes == NULL) return CT_OK;
  return ct_probes_sample(page.probes, page.state, &page_error);
}

EXPORT(step_count) double step_count(void) { return (double)page.step_count; }

EXPORT(step_number) double step_number(void) { return (double)page.state->step; }

EXPORT(time_now) double time_now(void) { return page.state->time; }

EXPORT(time_step) double time_step(void) { return page.problem->dt; }

/* The largest stable step with contact (0), without it (1), and that of Courant number 1 (2). */
EXPORT(stable_step) double stable_step(int which)
{
  return which == 0   ? page.stable.dt
         : which == 1 ? page.stable.dt_without_contact
                      : page.stable.dt_courant;
}

EXPORT(advance) ct_status advance(int steps)
{
  ct_observer observer = {0};
  if (page.probes != NULL) observer = ct_probes_observer(page.probes);
  return ct_run(page.problem, page.state, steps, &observer, page.probes != NULL, &page_error);
}

/* Energies now: kinetic, strain, contact, external, total, balance, reserve. Null: not finite. */
EXPORT(energies) const double *energies(void)
{
  ct_energy e;
  double *out = numbers(7);
  if (out == NULL || ct_energy_of(page.problem, page.state, &e, &page_error)) return NULL;
  out[0] = e.kinetic, out[1] = e.strain, out[2] = e.contact, out[3] = e.external;
  out[4] = e.total, out[5] = e.balance, out[6] = e.reserve;
  return out;
}

EXPORT(element_updates) double element_updates(void)
{
  return (double)page.state->element_updates[0];
}

EXPORT(body_count) int body_count(void) { return page.problem->body_count; }

EXPORT(node_count) int node_count(int body)
{
  return body < 0 ? page.problem->node_count : page.problem->bodies[body].mesh->node_count;
}

EXPORT(first_node) int first_node(int body) { return page.problem->bodies[body].first_node; }

EXPORT(element_count) int element_count(int body)
{
  return page.problem->bodies[body].mesh->element_count;
}

EXPORT(element_nodes) int element_nodes(int body)
{
  return ct_brick_node_count(page.problem->bodies[body].mesh->kind);
}

EXPORT(elements) const int32_t *elements(int body)
{
  return page.problem->bodies[body].mesh->elements;
}

EXPORT(coordinates) const double *coordinates(void) { return page.problem->reference; }

EXPORT(displacement) const double *displacement(void) { return page.state->displacement; }

/* Velocity of all nodes now, shape (node_count, 3). */
EXPORT(velocity) const double *velocity(void)
{
  double *out = numbers(3 * page.problem->node_count);
  if (out == NULL || ct_state_velocity(page.problem, page.state, out, &page_error)) return NULL;
  return out;
}

/* Stress at the element centres of a body, shape (element_count, 6). */
EXPORT(stress) const double *stress(int body)
{
  const ct_body *of = &page.problem->bodies[body];
  double *out = numbers(6 * of->mesh->element_count);
  if (out == NULL) return NULL;
  const double *u = page.state->displacement + 3 * (size_t)of->first_node;
  if (ct_solid_stress(of->mesh, &of->material, u, out, &page_error)) return NULL;
  for (int32_t i = 0; i < 6 * of->mesh->element_count; i++) out[i] += of->initial_stress[i % 6];
  return out;
}

/* Corners of the outer faces of a body, shape (4, count), in the numbers of the body; and how many.
 */
EXPORT(skin) const int32_t *skin(int body)
{
  const ct_mesh *mesh = page.problem->bodies[body].mesh;
  int32_t width = mesh->kind == CT_HEX20 ? 8 : 4, count = ct_mesh_outer_faces(mesh, NULL, NULL);
  int32_t *out = (int32_t *)numbers(count * width);
  if (out == NULL) return NULL;
  ct_mesh_outer_faces(mesh, out, NULL);
  for (int32_t i = 0; width == 8 && i < count; i++)
    for (int k = 0; k < 4; k++) out[4 * i + k] = out[8 * i + k];
  return out;
}

EXPORT(skin_count) int skin_count(int body)
{
  return ct_mesh_outer_faces(page.problem->bodies[body].mesh, NULL, NULL);
}

/* Likewise from displacements without the short waves that the mesh cannot represent. */
EXPORT(filtered_stress) const double *filtered_stress(int body, int passes)
{
  const ct_body *of = &page.problem->bodies[body];
  ct_filter *filter = NULL;
  double *u = malloc(3 * (size_t)page.problem->node_count * sizeof *u);
  double *out = numbers(6 * of->mesh->element_count);
  ct_status status = ct_filter_create(page.problem, passes, &filter, &page_error);
  if (u == NULL || out == NULL) status = CT_ERROR_MEMORY;
  if (status == CT_OK) status = ct_filter_apply(filter, page.state, u, NULL, &page_error);
  if (status == CT_OK)
    status =
        ct_solid_stress(of->mesh, &of->material, u + 3 * (size_t)of->first_node, out, &page_error);
  ct_filter_free(filter);
  free(u);
  return status == CT_OK ? out : NULL;
}

/* The elements of these faces, in the same order. */
EXPORT(skin_owners) const int32_t *skin_owners(int body)
{
  const ct_mesh *mesh = page.problem->bodies[body].mesh;
  int32_t *out = (int32_t *)numbers(ct_mesh_outer_faces(mesh, NULL, NULL));
  if (out != NULL) ct_mesh_outer_faces(mesh, NULL, out);
  return out;
}
