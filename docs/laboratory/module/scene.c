/* A scene of a page: bodies first, then `join`, then what acts on them, then `start`. Each call
 * returns a ct_status. */
#include "module.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Sides are numbered as in ct_box_side; this one is the whole skin. */
enum { OUTER = 7 };

static ct_scene_body body;
/* The mesh of that body, until it is added. */
static ct_mesh *made;
static ct_contact_options options;
static double beta, friction, tangent;
/* A factor in time for loads, obstacles and gravity. */
static struct {
  double time[64], value[64];
  int32_t count;
} history;

static ct_amplitude amplitude(void)
{
  return (ct_amplitude){history.count, history.time, history.value};
}

static void clear(void)
{
  ct_probes_free(page.probes);
  ct_state_free(page.state);
  ct_scene_free(page.scene);
  ct_mesh_free(made);
  made = NULL;
  memset(&page, 0, sizeof page);
}

EXPORT(begin) ct_status begin(void)
{
  clear();
  return ct_scene_create(&page.scene, &page_error);
}

EXPORT(set_material) void set_material(double young, double poisson, double density, int law)
{
  body = (ct_scene_body){.material = {young, poisson, density, (ct_law)law}};
}

EXPORT(set_motion)
void set_motion(double vx, double vy, double vz, int kernel)
{
  body.velocity[0] = vx, body.velocity[1] = vy, body.velocity[2] = vz;
  body.kernel = (ct_solid_kernel)kernel;
}

EXPORT(set_history) ct_status set_history(int count)
{
  if (count > 64) return CT_ERROR_ARGUMENT;
  const double *rows = numbers(2 * count);
  for (int i = 0; i < count; i++) {
    history.time[i] = rows[2 * i];
    history.value[i] = rows[2 * i + 1];
  }
  history.count = count;
  return CT_OK;
}

/* Damping in proportion to stiffness, and the stress without displacement. */
EXPORT(set_state)
void set_state(double damping, double xx, double yy, double zz, double xy, double yz, double zx)
{
  const double stress[6] = {xx, yy, zz, xy, yz, zx};
  body.stiffness_damping = damping;
  memcpy(body.initial_stress, stress, sizeof stress);
}

/* Bit k of `symmetric`: graded to both ends of axis k. */
EXPORT(set_grading) void set_grading(double x, double y, double z, int symmetric)
{
  const double grading[3] = {x, y, z};
  memcpy(body.box.grading, grading, sizeof grading);
  for (int k = 0; k < 3; k++) body.box.symmetric[k] = symmetric >> k & 1;
}

EXPORT(mesh_box)
ct_status mesh_box(int kind, double x, double y, double z, double width, double depth,
                   double height, int nx, int ny, int nz, int layers)
{
  const ct_box box = {{x, y, z}, {width, depth, height}, {nx, ny, nz}, (ct_layers)layers, {0}, {0}};
  memcpy(&body.box, &box, offsetof(ct_box, grading));
  body.kind = (ct_brick_kind)kind;
  return ct_mesh_create_box(body.kind, &body.box, &made, &page_error);
}

EXPORT(mesh_ring)
ct_status mesh_ring(int kind, double x, double y, double z, double inner, double outer,
                    double width, int through, int around, int across)
{
  ct_ring ring = {{x, y, z}, {inner, outer}, width, {through, around, across}};
  return ct_mesh_create_ring((ct_brick_kind)kind, &ring, &made, &page_error);
}

EXPORT(mesh_cylinder)
ct_status mesh_cylinder(int kind, double x, double y, double z, double radius, double width,
                        int through, int around, int across)
{
  ct_cylinder cylinder = {{x, y, z}, radius, width, {through, around, across}};
  return ct_mesh_create_cylinder((ct_brick_kind)kind, &cylinder, &made, &page_error);
}

/* A ball, or with an inner radius above 0 a shell. */
EXPORT(mesh_ball)
ct_status mesh_ball(int kind, double x, double y, double z, double inner, double outer, int through,
                    int around)
{
  ct_ball ball = {{x, y, z}, {inner, outer}, {through, around}};
  return ct_mesh_create_ball((ct_brick_kind)kind, &ball, &made, &page_error);
}

EXPORT(mesh_node_count) int mesh_node_count(void) { return made->node_count; }

EXPORT(mesh_nodes) const double *mesh_nodes(void) { return made->nodes; }

/* Add the body of this mesh. Where it is `displaced` and `turns`, displacements and then velocities
 * of all nodes, each of shape (node_count, 3), are in `numbers`. */
EXPORT(add_body) ct_status add_body(int displaced, int turns)
{
  const double *rows = numbers(0);
  body.mesh = body.box.cells[0] > 0 ? NULL : made;
  body.displacements = displaced ? rows : NULL;
  body.velocities = turns ? rows + (displaced ? 3 * (size_t)made->node_count : 0) : NULL;
  ct_status status = ct_scene_add_body(page.scene, &body, NULL, &page_error);
  ct_mesh_free(made);
  made = NULL;
  return status;
}

EXPORT(join) ct_status join(void) { return ct_scene_join(page.scene, &page.problem, &page_error); }

/* Smallest (side odd) or largest coordinate of a mesh along the axis of a side. */
static double place_of(const ct_mesh *mesh, int side)
{
  int axis = (side - 1) / 2;
  double sign = side % 2 ? 1.0 : -1.0, least = INFINITY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    least = fmin(least, sign * mesh->nodes[3 * i + axis]);
  return sign * least;
}

static int32_t faces_on(const ct_mesh *mesh, int side, int32_t *faces)
{
  if (side == OUTER) return ct_mesh_outer_faces(mesh, faces, NULL);
  return ct_mesh_plane_faces(mesh, (side - 1) / 2, place_of(mesh, side), faces, NULL);
}

/* Node numbers of the faces of a side, plus `first`; the caller frees them. */
static int32_t *faces_of(const ct_mesh *mesh, int side, int32_t first, int32_t *count)
{
  int32_t width = mesh->kind == CT_HEX20 ? 8 : 4;
  *count = faces_on(mesh, side, NULL);
  if (*count <= 0) return NULL;
  int32_t *faces = malloc((size_t)*count * (size_t)width * sizeof *faces);
  if (faces == NULL) return NULL;
  faces_on(mesh, side, faces);
  for (int32_t i = 0; i < *count * width; i++) faces[i] += first;
  return faces;
}

static ct_status refuse(const char *text)
{
  strncpy(page_error.text, text, sizeof page_error.text - 1);
  return page_error.code = CT_ERROR_ARGUMENT;
}

/* Law of the contacts and obstacles that follow; numbers below 0: the library's default. */
EXPORT(set_law)
void set_law(int enforcement, double factor, double epsilon, double dissipation, double restitution,
             double coefficient, double stiffness, int initial)
{
  options = ct_contact_options_default();
  options.epsilon = epsilon > 0.0 ? epsilon : 0.0;
  if (enforcement >= 0) options.enforcement = (ct_enforcement)enforcement;
  if (dissipation >= 0.0) options.dissipation = dissipation;
  if (restitution >= 0.0) options.restitution = restitution;
  if (initial >= 0) options.initial_penetration = (ct_initial)initial;
  beta = factor > 0.0 ? factor : 0.0;
  friction = coefficient > 0.0 ? coefficient : 0.0;
  tangent = stiffness > 0.0 ? stiffness : 0.0;
}

/* Closest-point method, positions of points, and the distance that counts as touching. */
EXPORT(set_search) void set_search(int method, int points, double adjust)
{
  if (method >= 0) options.method = (ct_method)method;
  if (points >= 0) options.points = (ct_contact_rule)points;
  if (adjust > 0.0) options.adjust = adjust;
}

EXPORT(add_contact) ct_status add_contact(int a, int side_a, int b, int side_b)
{
  const ct_mesh *meshes[2] = {page.problem->bodies[a].mesh, page.problem->bodies[b].mesh};
  int32_t count[2];
  int32_t *faces[2] = {faces_of(meshes[0], side_a, 0, &count[0]),
                       faces_of(meshes[1], side_b, 0, &count[1])};
  ct_scene_contact contact = {a,    b,       count[0], count[1], faces[0],     faces[1],
                              beta, options, friction, tangent,  CT_SIDE_NONE, CT_SIDE_NONE};
  ct_status status = faces[0] == NULL || faces[1] == NULL
                         ? refuse("a surface of the contact has no faces")
                         : ct_scene_add_contact(page.scene, &contact, &page_error);
  free(faces[0]);
  free(faces[1]);
  return status;
}

/* Nodes of a side of a body, in its own numbers: marked in `on`, shape (node_count). */
static int32_t mark_nodes(const ct_mesh *mesh, int side, uint8_t *on)
{
  int32_t faces = 0, count = 0, width = mesh->kind == CT_HEX20 ? 8 : 4;
  int32_t *list = faces_of(mesh, side, 0, &faces);
  if (list == NULL) return 0;
  for (int32_t i = 0; i < faces * width; i++) {
    count += !on[list[i]];
    on[list[i]] = 1;
  }
  free(list);
  return count;
}

/* Numbers of these nodes, ascending, plus `first`; the caller frees them. */
static int32_t *nodes_of(const ct_mesh *mesh, int side, int32_t first, int32_t *count)
{
  size_t n = (size_t)mesh->node_count;
  uint8_t *on = calloc(n, 1);
  int32_t *nodes = malloc(n * sizeof *nodes), k = 0;
  *count = 0;
  if (on != NULL && nodes != NULL) *count = mark_nodes(mesh, side, on);
  for (size_t i = 0; i < n && *count > 0; i++)
    if (on[i]) nodes[k++] = first + (int32_t)i;
  free(on);
  return nodes;
}

/* `fixed` has the bits 1, 2, 4 for x, y, z. */
EXPORT(add_support)
ct_status add_support(int number, int side, int fixed, double vx, double vy, double vz)
{
  int32_t count = 0;
  int32_t *nodes = nodes_of(page.problem->bodies[number].mesh, side, 0, &count);
  ct_scene_support support = {
      number, nodes, count, {fixed & 1, fixed >> 1 & 1, fixed >> 2 & 1}, {vx, vy, vz}};
  ct_status status = count == 0 ? refuse("the surface of the support has no nodes")
                                : ct_scene_add_support(page.scene, &support, &page_error);
  free(nodes);
  return status;
}

static ct_status take(ct_status status, ct_effect *effect)
{
  if (status != CT_OK) return status;
  return ct_scene_add_effect(page.scene, effect, &page_error);
}

/* Penalties of an obstacle, as the scene computes those of a contact. */
static void set_penalty(ct_obstacle_def *def, const ct_body *of)
{
  double edge = ct_mesh_shortest_edge(of->mesh), c1, c2;
  ct_material_speeds(&of->material, &c1, &c2);
  double modulus = of->material.density * c1 * c1;
  def->epsilon = options.epsilon;
  if (beta > 0.0) def->epsilon = ct_contact_penalty(beta, of->material.young, edge);
  else if (!(def->epsilon > 0.0))
    def->epsilon = ct_contact_penalty_default(options.enforcement, modulus, edge);
  def->travel_time = edge / c1;
}

static ct_status rub(ct_effect *obstacle, const ct_body *of, double epsilon)
{
  ct_friction_def def = ct_friction_def_default();
  ct_effect *effect = NULL;
  double edge = ct_mesh_shortest_edge(of->mesh), c1, c2;
  ct_material_speeds(&of->material, &c1, &c2);
  double most =
      ct_contact_penalty_default(CT_ENFORCE_PENALTY, of->material.density * c1 * c1, edge);
  def.on = obstacle;
  def.coefficient = friction;
  def.tangent = tangent > 0.0 ? tangent : fmin(1.0, most / epsilon);
  return take(ct_friction_create_effect(&def, page.problem, &effect, &page_error), effect);
}

/* `geometry` has a point, an axis, a velocity and a travel: twelve numbers in `numbers`. */
EXPORT(add_obstacle) ct_status add_obstacle(int number, int side, int shape, double radius)
{
  const ct_body *of = &page.problem->bodies[number];
  const double *geometry = numbers(12);
  ct_obstacle_def def = ct_obstacle_def_default();
  ct_effect *effect = NULL;
  int32_t *faces = faces_of(of->mesh, side, of->first_node, &def.face_count);
  if (faces == NULL) return refuse("the surface of the obstacle has no faces");
  for (int i = 0; i < 3; i++) {
    def.point[i] = geometry[i];
    def.axis[i] = geometry[3 + i];
    def.velocity[i] = geometry[6 + i];
    def.travel[i] = geometry[9 + i];
  }
  def.shape = (ct_obstacle_shape)shape;
  def.radius = radius;
  def.kind = ct_brick_face_kind(of->mesh->kind);
  def.faces = faces;
  def.amplitude = amplitude();
  def.enforcement = options.enforcement;
  def.dissipation = options.dissipation;
  def.restitution = options.restitution;
  def.points = options.points;
  def.initial_penetration = options.initial_penetration;
  def.adjust = options.adjust;
  set_penalty(&def, of);
  ct_status status =
      take(ct_obstacle_create_effect(&def, page.problem, &effect, &page_error), effect);
  free(faces);
  return status == CT_OK && friction > 0.0 ? rub(effect, of, def.epsilon) : status;
}

EXPORT(add_load)
ct_status add_load(int number, int side, double tx, double ty, double tz, double pressure,
                   int following)
{
  const ct_body *of = &page.problem->bodies[number];
  ct_load_def def = ct_load_def_default();
  ct_effect *effect = NULL;
  int32_t *faces = faces_of(of->mesh, side, of->first_node, &def.face_count);
  if (faces == NULL) return refuse("the surface of the load has no faces");
  def.kind = ct_brick_face_kind(of->mesh->kind);
  def.faces = faces;
  def.traction[0] = tx, def.traction[1] = ty, def.traction[2] = tz;
  def.pressure = pressure;
  def.following = following;
  def.amplitude = amplitude();
  ct_status status = take(ct_load_create_effect(&def, page.problem, &effect, &page_error), effect);
  free(faces);
  return status;
}

EXPORT(add_gravity) ct_status add_gravity(double x, double y, double z)
{
  ct_gravity_def def = ct_gravity_def_default();
  ct_effect *effect = NULL;
  def.acceleration[0] = x, def.acceleration[1] = y, def.acceleration[2] = z;
  def.amplitude = amplitude();
  return take(ct_gravity_create_effect(&def, page.problem, &effect, &page_error), effect);
}

/* The numbers of `count` bodies are in `numbers`, as integers; 0: all bodies. */
EXPORT(add_damping) ct_status add_damping(double rate, int count)
{
  ct_damping_def def = ct_damping_def_default();
  ct_effect *effect = NULL;
  def.rate = rate;
  def.bodies = count > 0 ? (const int32_t *)numbers(0) : NULL;
  def.body_count = count;
  return take(ct_damping_create_effect(&def, page.problem, &effect, &page_error), effect);
}

/* `how` the step is given: 0 courant, 1 fraction of the stable one, 2 itself. A parameter that is
 * not a number: that of the scheme. */
EXPORT(start)
ct_status start(double end, int how, double value, int scheme, double parameter)
{
  ct_scene_time time = {.end = end, .integrator = ct_integrator_default((ct_scheme)scheme)};
  *(how == 0 ? &time.courant : how == 1 ? &time.fraction : &time.dt) = value;
  if (!isnan(parameter)) time.integrator.parameter = parameter;
  return ct_scene_start(page.scene, &time, &page.problem, &page.step_count, &page.stable,
                        &page.state, &page_error);
}

/* Whether a scheme with this parameter (not a number: its own) is the leapfrog. */
EXPORT(is_leapfrog) int is_leapfrog(int scheme, double parameter)
{
  ct_integrator integrator = ct_integrator_default((ct_scheme)scheme);
  if (!isnan(parameter)) integrator.parameter = parameter;
  return ct_integrator_is_leapfrog(&integrator);
}
