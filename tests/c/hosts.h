/* Bodies with surfaces, obstacles and friction, and a host of its own that moves them. */
#ifndef HOSTS_H
#define HOSTS_H

#include "blocks.h"
#include "bodies.h"

static const ct_material STEEL = {.young = 2.1e5, .poisson = 0.3, .density = 7.8e-9},
                         SOFT = {.young = 900.0, .poisson = 0.0, .density = 1.0};

/* Two bodies, or one in contact with itself: meshes, surfaces and initial velocities for a host. */
typedef struct pair {
  int bodies;
  ct_mesh *mesh[2];
  int32_t *faces[2], face_count[2];
  double *velocity[2];
  ct_material material;
  int alone;               /* whether the one body meets only obstacles */
  int inside;              /* whether it is inside them at the start, and moves */
  double friction;         /* between the surfaces */
  int obstacles, side[2];  /* which surface meets each */
  ct_obstacle_def wall[2]; /* their faces and penalties are filled in later */
  double rub[2];           /* their friction */
} pair;

static inline pair pair_of(const ct_material *material, ct_mesh *a, double at_a, ct_mesh *b,
                           double at_b, int axis)
{
  pair p = {.bodies = 2, .mesh = {a, b}, .material = *material};
  for (int i = 0; i < 2; i++) {
    p.faces[i] = integers(8 * 6 * p.mesh[i]->element_count);
    p.velocity[i] = numbers(3 * p.mesh[i]->node_count);
    p.face_count[i] = ct_mesh_plane_faces(p.mesh[i], axis, i == 0 ? at_a : at_b, p.faces[i], NULL);
  }
  return p;
}

static inline void throw_body(pair *p, int body, double vx, double vy, double vz)
{
  for (int n = 0; n < p->mesh[body]->node_count; n++) {
    double *v = &p->velocity[body][3 * n];
    v[0] = vx, v[1] = vy, v[2] = vz;
  }
}

static inline void free_pair(pair *p)
{
  for (int i = 0; i < p->bodies; i++) {
    free_mesh(p->mesh[i]);
    free_all(p->faces[i], p->velocity[i]);
  }
}

/* Rods end to end, ν = 0, a distance apart. */
static inline pair rods(double apart)
{
  pair p = pair_of(&SOFT, box_mesh(CT_HEX8, -10 - apart, 0, 0, 10, 1, 1, 25, 1, 1), -apart,
                   box_mesh(CT_HEX8, 0, 0, 0, 10, 1, 1, 25, 1, 1), 0.0, 0);
  throw_body(&p, 0, 5, 0, 0);
  throw_body(&p, 1, -5, 0, 0);
  return p;
}

/* Two equal plates of the impact. */
static inline pair plates(double apart)
{
  pair p = pair_of(&STEEL, box_mesh(CT_HEX8, -4 - apart, 0, 0, 4, 2, 0.5, 8, 4, 1), -apart,
                   box_mesh(CT_HEX8, 0, 0, 0, 4, 2, 0.5, 8, 4, 1), 0.0, 0);
  throw_body(&p, 0, 5e4, 0, 0);
  throw_body(&p, 1, -5e4, 0, 0);
  return p;
}

/* Unlike blocks, one of which falls and slides on the other. */
static inline pair blocks(ct_brick_kind up, ct_brick_kind low, double apart, double along)
{
  ct_mesh *a = box_mesh(up, 0.1, 0.05, apart, 1, 0.9, 1, 3, 2, 3),
          *b = box_mesh(low, 0, 0, -1, 3, 1, 1, 7, 3, 3);
  distort_inside(a, 0.02);
  distort_inside(b, 0.02);
  pair p = pair_of(&SOFT, a, apart, b, 0.0, 2);
  throw_body(&p, 0, along, 0.1, fmin(-0.3, -0.25 * along));
  return p;
}

/* A strip bent to a hairpin whose upper layer flies at the lower one. */
static inline pair strip(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1, 0.4, 1, 40, 2, 2);
  pair p = {.bodies = 1, .mesh = {m}, .material = SOFT};
  p.faces[0] = integers(8 * 6 * m->element_count);
  p.velocity[0] = numbers(3 * m->node_count);
  bend_to_hairpin(m, 0.15, p.velocity[0]);
  p.face_count[0] = ct_mesh_outer_faces(m, p.faces[0], NULL);
  return p;
}

static inline void take_outer_faces(pair *p)
{
  for (int i = 0; i < p->bodies; i++)
    p->face_count[i] = ct_mesh_outer_faces(p->mesh[i], p->faces[i], NULL);
}

static inline void add_wall(pair *p, int side, ct_obstacle_shape shape, double x, double y,
                            double z, double radius, double friction)
{
  ct_obstacle_def *wall = &p->wall[p->obstacles];
  *wall = ct_obstacle_def_default();
  wall->shape = shape, wall->radius = radius;
  wall->point[0] = x, wall->point[1] = y, wall->point[2] = z;
  wall->axis[shape == CT_OBSTACLE_PLANE ? 2 : 1] = 1.0;
  p->side[p->obstacles] = side, p->rub[p->obstacles++] = friction;
}

/* A block that falls and slides on a plane, and is hit by a sphere from above. */
static inline pair thrown(double apart)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, apart, 1, 1, 1, 4, 4, 3);
  pair p = {.bodies = 1, .mesh = {m}, .material = SOFT, .alone = 1};
  distort_inside(m, 0.02);
  p.faces[0] = integers(8 * 6 * m->element_count);
  p.velocity[0] = numbers(3 * m->node_count);
  take_outer_faces(&p);
  throw_body(&p, 0, 0.6, 0.2, -0.5);
  add_wall(&p, 0, CT_OBSTACLE_PLANE, 0, 0, 0, 0, 0.3);
  add_wall(&p, 0, CT_OBSTACLE_SPHERE, 0.5, 0.4, 3.01 + apart, 2.0, 0.2);
  p.wall[1].velocity[2] = -0.6, p.wall[1].velocity[0] = 0.1;
  return p;
}

/* The same, inside the plane and the sphere at the start; the overlap with the plane is treated in
 * a given way. */
static inline pair sunk(ct_initial how)
{
  pair p = thrown(-0.02);
  p.inside = 1;
  p.wall[0].initial_penetration = how, p.wall[0].removal_time = 0.1;
  p.wall[1].point[2] = 2.96;
  return p;
}

/* The same with a sphere that is smaller than a face of the block and hits it off its points. */
static inline pair pierced(void)
{
  pair p = thrown(0.0);
  p.wall[1].radius = 0.06;
  p.wall[1].point[0] = 0.52, p.wall[1].point[1] = 0.37, p.wall[1].point[2] = 1.065;
  p.wall[1].velocity[0] = 0.4, p.rub[1] = 0.0;
  return p;
}

/* The same between a plane and a cylinder that comes by its amplitude, quadratic, without friction.
 */
static inline pair squeezed(void)
{
  static const double time[3] = {0.0, 0.1, 0.3}, value[3] = {0.0, 1.0, 0.5};
  ct_mesh *m = box_mesh(CT_HEX20, 0, 0, 0.001, 1, 1, 1, 2, 2, 2);
  pair p = {.bodies = 1, .mesh = {m}, .material = SOFT, .alone = 1};
  p.faces[0] = integers(8 * 6 * m->element_count);
  p.velocity[0] = numbers(3 * m->node_count);
  take_outer_faces(&p);
  throw_body(&p, 0, 0.1, 0.0, -0.3);
  add_wall(&p, 0, CT_OBSTACLE_PLANE, 0, 0, 0, 0, 0.0);
  add_wall(&p, 0, CT_OBSTACLE_CYLINDER, 0.5, 0, 2.502, 1.5, 0.0);
  p.wall[1].travel[2] = -0.05;
  p.wall[1].amplitude = (ct_amplitude){3, time, value};
  return p;
}

/* A block that slides on another, which lies on a plane. */
static inline pair stacked(void)
{
  ct_mesh *a = box_mesh(CT_HEX8, 0.1, 0.05, 0.005, 1, 0.9, 1, 3, 2, 3),
          *b = box_mesh(CT_HEX8, 0, 0, -0.5, 3, 1, 0.5, 7, 3, 2);
  pair p = pair_of(&SOFT, a, 0.005, b, 0.0, 2);
  take_outer_faces(&p);
  throw_body(&p, 0, 0.3, 0.1, -0.6);
  p.friction = 0.3;
  add_wall(&p, 1, CT_OBSTACLE_PLANE, 0, 0, -0.5, 0, 0.4);
  add_wall(&p, 0, CT_OBSTACLE_SPHERE, 0.6, 0.5, 3.008, 2.0, 0.0);
  p.wall[1].velocity[2] = -0.4;
  return p;
}

static inline pair rubbing(pair p, double friction)
{
  p.friction = friction;
  return p;
}

static inline double shortest_edge(const pair *p)
{
  double h = INFINITY;
  for (int i = 0; i < p->bodies; i++) h = fmin(h, ct_mesh_shortest_edge(p->mesh[i]));
  return h;
}

static inline ct_contact_options options_of(const pair *p, double beta)
{
  ct_contact_options options = ct_contact_options_default();
  double c1, c2;
  ct_material_speeds(&p->material, &c1, &c2);
  options.epsilon = ct_contact_penalty(beta, p->material.young, shortest_edge(p));
  options.travel_time = shortest_edge(p) / c1, options.restitution = 1.0;
  return options;
}

/* The tangential penalty over the normal one, as of a scene: not more than the usual explicit one.
 */
static inline double tangent_of(const pair *p, const ct_contact_options *options)
{
  return fmin(1.0, 4.0 * p->material.young / shortest_edge(p) / options->epsilon);
}

/* A contact of the surfaces of a pair over the nodes of a scene, in which the second body's come
 * after the first's; or over two arrays. */
static inline ct_contact *open_contact(const pair *p, const ct_contact_options *options,
                                       const double *reference, int one_array)
{
  ct_contact *contact = NULL;
  const ct_face_kind kind[2] = {ct_brick_face_kind(p->mesh[0]->kind),
                                ct_brick_face_kind(p->mesh[p->bodies - 1]->kind)};
  const int32_t first = p->mesh[0]->node_count,
                all = first + (p->bodies == 2 ? p->mesh[1]->node_count : 0),
                entries = p->bodies == 2 ? p->face_count[1] * ct_face_node_count(kind[1]) : 0;
  int32_t *faces = integers(entries);
  for (int32_t i = 0; i < entries; i++) faces[i] = p->faces[1][i] + (one_array ? first : 0);
  ct_surface a = {kind[0], one_array ? all : first, p->face_count[0], p->faces[0], reference},
             b = {kind[1], one_array ? all : all - first, p->face_count[1], faces,
                  one_array ? reference : reference + 3 * first};
  const ct_surface *other = p->alone ? NULL : p->bodies == 1 ? &a : &b;
  must(ct_contact_create, &a, other, options, &contact);
  free_all(faces);
  const double tangent = tangent_of(p, options);
  if (p->friction > 0.0) must(ct_contact_add_friction, contact, -1, p->friction, tangent);
  for (int k = 0; k < p->obstacles; k++) {
    ct_obstacle_def wall = p->wall[k];
    wall.epsilon = options->epsilon, wall.enforcement = options->enforcement;
    wall.travel_time = options->travel_time, wall.restitution = options->restitution;
    must(ct_contact_add_obstacle, contact, p->side[k], &wall);
    if (p->rub[k] > 0.0) must(ct_contact_add_friction, contact, k, p->rub[k], tangent);
  }
  return later_contact(contact);
}

/* The scene of a pair: bodies, contact, and obstacles, each with its friction after it. */
static inline ct_scene *scene_of_pair(const pair *p, const ct_contact_options *options)
{
  ct_scene *scene = new_scene();
  for (int i = 0; i < p->bodies; i++)
    add_moving_body(scene, i == 0 ? "a" : "b", p->mesh[i], &p->material, CT_KERNEL_AUTO,
                    p->velocity[i]);
  const int b = p->bodies - 1;
  ct_scene_contact contact =
      scene_contact(0, p->faces[0], p->face_count[0], b, p->faces[b], p->face_count[b]);
  contact.options = *options, contact.friction = p->friction,
  contact.tangent = tangent_of(p, options);
  if (!p->alone) must(ct_scene_add_contact, scene, &contact);
  for (int k = 0; k < p->obstacles; k++) {
    const int s = p->side[k];
    const ct_problem *joined = join_scene(scene);
    ct_effect *made = NULL;
    ct_obstacle_def wall = p->wall[k];
    ct_friction_def rub = ct_friction_def_default();
    wall.epsilon = options->epsilon, wall.enforcement = options->enforcement;
    wall.travel_time = options->travel_time, wall.restitution = options->restitution;
    wall.kind = ct_brick_face_kind(p->mesh[s]->kind), wall.face_count = p->face_count[s];
    const int entries = p->face_count[s] * ct_face_node_count(wall.kind);
    int32_t *faces = integers(entries);
    for (int i = 0; i < entries; i++) faces[i] = p->faces[s][i] + joined->bodies[s].first_node;
    wall.faces = faces;
    must(ct_obstacle_create_effect, &wall, joined, &made);
    must(ct_scene_add_effect, scene, made);
    free_all(faces);
    rub.on = made, rub.coefficient = p->rub[k], rub.tangent = tangent_of(p, options);
    if (p->rub[k] > 0.0) add_made(scene, ct_friction_create_effect, &rub);
  }
  return scene;
}

/* A host's own loop: bodies with all their arrays. */
typedef struct host {
  const pair *p;
  block solid[2];
  double *x[2], *u[2], *v[2], *f[2], *inverse_mass[2], *mass[2];
  ct_contact *contact;
  double dt;
} host;

static inline host open_host(const pair *p, const ct_contact_options *options, double fraction)
{
  host h = {.p = p};
  double omega2 = 0.0;
  ct_error e;
  double *reference = numbers(6 * (p->mesh[0]->node_count + p->mesh[p->bodies - 1]->node_count));
  for (int i = 0, n = 0; i < p->bodies; i++) {
    const ct_mesh *m = p->mesh[i];
    double **arrays[] = {&h.x[i], &h.u[i], &h.v[i], &h.f[i], &h.inverse_mass[i], &h.mass[i]};
    for (int k = 0; k < 6; k++) *arrays[k] = numbers(3 * m->node_count);
    must(ct_mass_lumped, m, p->material.density, CT_LUMP_HRZ, h.mass[i]);
    for (int d = 3 * m->node_count - 1; d >= 0; d--) {
      h.mass[i][d] = h.mass[i][d / 3];
      h.inverse_mass[i][d] = 1.0 / h.mass[i][d];
      h.x[i][d] = reference[n + d] = m->nodes[d];
      h.v[i][d] = p->velocity[i][d];
    }
    n += 3 * m->node_count;
    h.solid[i] = open_block(m, &p->material, CT_KERNEL_AUTO);
    omega2 = fmax(omega2, block_frequency(&h.solid[i]));
  }
  h.contact = open_contact(p, options, reference, 0);
  h.dt = fraction * 2.0 / sqrt(omega2);
  if (p->friction > 0.0 || p->obstacles > 0) {
    double dt, *mass = numbers(p->mesh[0]->node_count),
               *other = numbers(p->mesh[p->bodies - 1]->node_count);
    for (int n = 0; n < p->mesh[0]->node_count; n++) mass[n] = h.mass[0][3 * n];
    for (int n = 0; n < p->mesh[p->bodies - 1]->node_count; n++)
      other[n] = h.mass[p->bodies - 1][3 * n];
    need(ct_contact_stable_step(h.contact, mass, other, &dt, NULL), &e);
    h.dt = fraction / sqrt(omega2 / 4.0 + 1.0 / (dt * dt));
    free_all(mass, other);
  }
  free_all(reference);
  return h;
}

static inline void close_host(host *h)
{
  for (int i = 0; i < h->p->bodies; i++) {
    double *arrays[] = {h->x[i], h->u[i], h->v[i], h->f[i], h->inverse_mass[i], h->mass[i]};
    for (int k = 0; k < 6; k++) free_all(arrays[k]);
    close_block(&h->solid[i]);
  }
  free_contact(h->contact);
}

/* One step of the host; `bodies`, or null, becomes the energy of its bodies at t_n: strain, and the
 * product of both velocities, or at t_0 that of v_0. */
static inline ct_status try_host(host *h, int64_t n, ct_error *e, double *bodies)
{
  const double force_time = n == 0 ? 0.5 * h->dt : h->dt;
  double energy = 0.0;
  for (int i = 0; i < h->p->bodies; i++) energy += block_force(&h->solid[i], h->u[i], h->f[i]);
  ct_contact_prediction prediction = {.x_a = h->x[0],
                                      .x_b = h->x[1],
                                      .velocity_a = h->v[0],
                                      .velocity_b = h->v[1],
                                      .force_a = h->f[0],
                                      .force_b = h->f[1],
                                      .inverse_mass_a = h->inverse_mass[0],
                                      .inverse_mass_b = h->inverse_mass[1],
                                      .dt = h->dt,
                                      .force_time = force_time};
  ct_status status = ct_contact_step(h->contact, &prediction, e);
  if (status != CT_OK) return status;
  need(ct_contact_add_force(h->contact, h->f[0], h->f[1], NULL), e);
  for (int i = 0; i < h->p->bodies; i++)
    for (int d = 0; d < 3 * h->p->mesh[i]->node_count; d++) {
      double before = h->v[i][d];
      h->v[i][d] += force_time * h->inverse_mass[i][d] * h->f[i][d];
      energy += 0.5 * h->mass[i][d] * before * (n == 0 ? before : h->v[i][d]);
      h->u[i][d] += h->dt * h->v[i][d];
      h->x[i][d] = h->p->mesh[i]->nodes[d] + h->u[i][d];
    }
  if (bodies != NULL) *bodies = energy;
  return CT_OK;
}

static inline double step_host(host *h, int64_t n)
{
  double bodies;
  ct_error e;
  need(try_host(h, n, &e, &bodies), &e);
  return bodies;
}

static inline int same_host(const host *a, const host *b)
{
  int same = 1;
  for (int i = 0; i < a->p->bodies; i++) {
    const size_t size = 3 * (size_t)a->p->mesh[i]->node_count * sizeof(double);
    same = same && memcmp(a->x[i], b->x[i], size) == 0 && memcmp(a->v[i], b->v[i], size) == 0 &&
           memcmp(a->f[i], b->f[i], size) == 0;
  }
  return same;
}

#endif
