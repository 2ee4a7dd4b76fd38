/* Shared by several tests: meshes that are distorted, rotated or mirrored, forces
 * of a whole problem, eigenvalues. */
#ifndef BODIES_H
#define BODIES_H

#include <libcontact.h>

#include "../../libcontact/src/solid/element.h"
#include "uniform.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>
#include "defs.h"

#define SCHEME(scheme) ct_integrator_facts((ct_scheme)(scheme))->name
static const char *const ENFORCEMENT[] = {"penalty", "energy_controlled"};
enum { ENFORCEMENTS = CT_ENFORCE_COUNT };
typedef char every_enforcement_has_its_name
    [sizeof ENFORCEMENT / sizeof ENFORCEMENT[0] == CT_ENFORCE_COUNT ? 1 : -1];

/* One of 0 ... n - 1. */
static inline int pick(int n) { return (int)floor(0.5 * (uniform(1.0) + 1.0) * n); }

/* A random rotation, by a unit quaternion. */
static inline void random_rotation(double R[3][3])
{
  double q[4], n = 0.0;
  do {
    n = 0.0;
    for (int i = 0; i < 4; i++) q[i] = uniform(1.0), n += q[i] * q[i];
  } while (n > 1.0 || n < 0.1);
  for (int i = 0; i < 4; i++) q[i] /= sqrt(n);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                       {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                       {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  memcpy(R, rows, sizeof rows);
}

static inline double largest(const double *v, int64_t n)
{
  double top = 0.0;
  for (int64_t i = 0; i < n; i++) top = worst(top, v[i]);
  return top;
}

static inline double largest_difference(const double *v, const double *w, int64_t n)
{
  double top = 0.0;
  for (int64_t i = 0; i < n; i++) top = worst(top, v[i] - w[i]);
  return top;
}

/* End the program if a preparation, which is not the subject of the test, has failed. */
static inline void need(ct_status status, const ct_error *error)
{
  if (status == CT_OK) return;
  printf("Bail out! %s: %s\n", ct_status_name(status), error->text);
  exit(1);
}

/* Such a call of the library: its name and all arguments but the last one, the error. */
#define must(call, ...)                        \
  do {                                         \
    ct_error error_;                           \
    need(call(__VA_ARGS__, &error_), &error_); \
  } while (0)

/* What the functions below have made. After free_at_end(), which stands first in main, a test need
 * not free it: that happens when the program ends, the last first. */
static struct {
  int at_end;
  size_t count;
  struct {
    void *what;
    void (*free_one)(void *what);
  } *list;
} pending;

static inline void free_pending(void)
{
  while (pending.count > 0) {
    pending.count--;
    pending.list[pending.count].free_one(pending.list[pending.count].what);
  }
  free(pending.list);
  pending.list = NULL;
}

static inline void free_at_end(void) { pending.at_end = atexit(free_pending) == 0; }

static inline void *free_later(void *what, void (*free_one)(void *))
{
  size_t n = pending.count;
  if (!pending.at_end || what == NULL) return what;
  if ((n & (n - 1)) == 0)
    pending.list = realloc(pending.list, (n > 0 ? 2 * n : 1) * sizeof *pending.list);
  if (pending.list == NULL) abort();
  pending.list[n].what = what;
  pending.list[n].free_one = free_one;
  pending.count++;
  return what;
}

/* A thing that is freed now, and not later. */
static inline void *unlist(void *what)
{
  size_t i = pending.count;
  while (i > 0 && pending.list[i - 1].what != what) i--;
  if (i > 0) pending.list[i - 1].what = NULL;
  while (pending.count > 0 && pending.list[pending.count - 1].what == NULL) pending.count--;
  return what;
}

/* later_mesh(m) gives m, which is freed later; free_mesh(m) frees it now. The same for others. */
#define LATER(name)                                                              \
  static inline void free_##name(void *what) { ct_##name##_free(unlist(what)); } \
  static inline ct_##name *later_##name(ct_##name *what) { return free_later(what, free_##name); }
LATER(mesh)
LATER(scene)
LATER(state)
LATER(effect)
LATER(contact)
LATER(monitor)
LATER(probes)

static inline void *room(int64_t count, size_t size)
{
  void *memory = calloc((size_t)(count > 0 ? count : 1), size);
  if (memory == NULL) {
    printf("Bail out! no memory\n");
    exit(1);
  }
  return free_later(memory, free);
}

/* Free some of these. */
static inline void free_each(void *const *memory, size_t count)
{
  for (size_t i = 0; i < count; i++) free(unlist(memory[i]));
}
#define free_all(...) \
  free_each((void *[]){__VA_ARGS__}, sizeof((void *[]){__VA_ARGS__}) / sizeof(void *))

static inline double *numbers(int64_t count) { return room(count, sizeof(double)); }
static inline int32_t *integers(int64_t count) { return room(count, sizeof(int32_t)); }

static inline ct_mesh *mesh_of(ct_brick_kind kind, ct_box box)
{
  ct_mesh *mesh = NULL;
  must(ct_mesh_create_box, kind, &box, &mesh);
  return later_mesh(mesh);
}

static inline ct_mesh *copy_mesh(const ct_mesh *mesh)
{
  ct_mesh *copy = NULL;
  must(ct_mesh_create_copy, mesh, &copy);
  return later_mesh(copy);
}

static inline ct_mesh *box_mesh(ct_brick_kind kind, double x, double y, double z, double a,
                                double b, double c, int nx, int ny, int nz)
{
  return mesh_of(kind, (ct_box){.origin = {x, y, z}, .size = {a, b, c}, .cells = {nx, ny, nz}});
}

/* Move each node at random, up to `amount` in each direction; with `inside` those on the outside of
 * a box stay. */
static inline void shake(ct_mesh *mesh, double amount, int inside)
{
  double low[3], high[3];
  ct_mesh_bounds(mesh, low, high);
  for (int n = 0; n < mesh->node_count; n++) {
    int moves = 1;
    for (int c = 0; c < 3 && inside; c++) {
      double x = mesh->nodes[3 * n + c], margin = 1e-6 * (high[c] - low[c]);
      moves &= x > low[c] + margin && x < high[c] - margin;
    }
    for (int c = 0; moves && c < 3; c++) mesh->nodes[3 * n + c] += uniform(amount);
  }
}

/* The same, with decreasing amounts until no element is inverted. */
static inline void shake_regular(ct_mesh *mesh, double amount, int inside)
{
  size_t size = 3 * (size_t)mesh->node_count * sizeof(double);
  double *straight = room(1, size);
  memcpy(straight, mesh->nodes, size);
  for (shake(mesh, amount, inside); ct_mesh_check(mesh, NULL) != CT_OK;
       shake(mesh, amount *= 0.8, inside))
    memcpy(mesh->nodes, straight, size);
  free_all(straight);
}

/* Determinant of the Jacobian of a brick with the nodes `x` at a point, computed without the
 * library; J[d] is its column d. */
static inline double brick_determinant(ct_brick_kind kind, double (*x)[3], const double xi[3],
                                       double J[3][3])
{
  double dN[20][3];
  ct_brick_gradient(kind, xi, dN);
  memset(J, 0, 9 * sizeof J[0][0]);
  for (int a = 0; a < ct_brick_node_count(kind); a++)
    for (int d = 0; d < 3; d++)
      for (int c = 0; c < 3; c++) J[d][c] += dN[a][d] * x[a][c];
  return J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) -
         J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
         J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
}

static inline void distort(ct_mesh *mesh, double amount) { shake_regular(mesh, amount, 0); }

/* Nodes on the outside of a box stay. */
static inline void distort_inside(ct_mesh *mesh, double amount) { shake_regular(mesh, amount, 1); }

/* Bend a box [0, 1] x [0, .4] x [0, 1] to a hairpin: two layers of the length 1 and the thickness
 * .2, one above the other, joined by half a ring of the given middle radius; v: the velocity
 * (nodes, 3) of the upper layer, which flies at the lower one, along it. */
static inline void bend_to_hairpin(ct_mesh *m, double middle, double *v)
{
  const double arc = 3.14159265358979324 * middle;
  for (int n = 0; n < m->node_count; n++) {
    double *x = &m->nodes[3 * n], s = (2.0 + arc) * x[0],
           angle = fmin(fmax((s - 1.0) / middle, 0.0), arc / middle),
           radius = middle - 0.2 * (x[2] - 0.5);
    x[0] = (s < 1.0 ? s : s > 1.0 + arc ? 2.0 + arc - s : 1.0) + radius * sin(angle);
    x[2] = -radius * cos(angle);
    double share = x[2] > 0.0 ? 1.0 - fmin(fmax(x[0], 0.0), 1.0) : 0.0;
    v[3 * n] = 6.0 * share, v[3 * n + 2] = -6.0 * share;
  }
}

/* Local node of a brick at the given reference coordinates. */
static inline int local_node(ct_brick_kind kind, const double xi[3])
{
  for (int a = 0; a < ct_brick_node_count(kind); a++) {
    double at[3];
    ct_brick_reference(kind, a, at);
    if (at[0] == xi[0] && at[1] == xi[1] && at[2] == xi[2]) return a;
  }
  return -1;
}

/* Let the reference axes of each element point along other edges: a random one of the 24 rotations
 * of a cube. */
static inline void turn_elements(ct_mesh *mesh)
{
  static const int axes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  int per = ct_brick_node_count(mesh->kind);
  for (int e = 0; e < mesh->element_count; e++) {
    int32_t old[20];
    int order = pick(6), first = pick(2) ? 1 : -1, second = pick(2) ? 1 : -1,
        third = first * second * (order < 3 ? 1 : -1);
    int sign[3] = {first, second, third};
    memcpy(old, &mesh->elements[e * per], (size_t)per * sizeof *old);
    for (int a = 0; a < per; a++) {
      double at[3], from[3];
      ct_brick_reference(mesh->kind, a, at);
      for (int c = 0; c < 3; c++) from[c] = sign[c] * at[axes[order][c]];
      mesh->elements[e * per + a] = old[local_node(mesh->kind, from)];
    }
  }
}

/* The mirror image in the plane x[axis] = 0: node n is the image of node n, and the reference axis
 * is flipped, so elements stay valid. */
static inline ct_mesh *mirror_mesh(const ct_mesh *mesh, int axis)
{
  ct_mesh *image = copy_mesh(mesh);
  int per = ct_brick_node_count(mesh->kind);
  for (int n = 0; n < mesh->node_count; n++)
    image->nodes[3 * n + axis] = -mesh->nodes[3 * n + axis];
  for (int e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < per; a++) {
      double at[3];
      ct_brick_reference(mesh->kind, a, at);
      at[axis] = at[axis] == 0.0 ? 0.0 : -at[axis];
      image->elements[e * per + a] = mesh->elements[e * per + local_node(mesh->kind, at)];
    }
  return image;
}

/* Number of entries of w that are not the mirror image of v's, compared as values. */
static inline int64_t mirror_faults(const double *v, const double *w, int64_t nodes, int axis)
{
  int64_t faults = 0;
  for (int64_t i = 0; i < 3 * nodes; i++) faults += !(w[i] == (i % 3 == axis ? -v[i] : v[i]));
  return faults;
}

/* The same mesh with its nodes and elements in a random order; to[n] is the new number of node n.
 */
static inline ct_mesh *shuffle_mesh(const ct_mesh *m, int32_t *to)
{
  ct_mesh *out = copy_mesh(m);
  int per = ct_brick_node_count(m->kind);
  int32_t *at = integers(m->element_count);
  for (int32_t n = 0; n < m->node_count; n++) {
    int32_t k = pick(n + 1);
    to[n] = to[k];
    to[k] = n;
  }
  for (int32_t i = 0; i < m->element_count; i++) {
    int32_t k = pick(i + 1);
    at[i] = at[k];
    at[k] = i;
  }
  for (int32_t n = 0; n < m->node_count; n++) memcpy(&out->nodes[3 * to[n]], &m->nodes[3 * n], 24);
  for (int32_t i = 0; i < m->element_count; i++)
    for (int a = 0; a < per; a++) out->elements[per * at[i] + a] = to[m->elements[per * i + a]];
  free_all(at);
  return out;
}

/* Largest difference of vectors at nodes; those of `g` are at to[n] (null: at n). */
static inline double apart(const double *f, const double *g, const int32_t *to, int32_t nodes)
{
  double most = 0.0;
  for (int32_t n = 0; n < nodes; n++)
    for (int c = 0; c < 3; c++)
      most = worst(most, f[3 * n + c] - g[3 * (to == NULL ? n : to[n]) + c]);
  return most;
}

/* Values of one element's nodes from an array of shape (nodes, 3). */
static inline void take_element(const ct_mesh *mesh, int e, const double *from, double to[60])
{
  int per = ct_brick_node_count(mesh->kind);
  for (int a = 0; a < per; a++)
    memcpy(&to[3 * a], &from[3 * mesh->elements[e * per + a]], 3 * sizeof(double));
}

/* Forces of all effects of a problem at any displacement, without a state. */
typedef struct probe {
  const ct_problem *problem;
  void **scratch;
  double *memory, *next, *force;
} probe;

static inline probe probe_open(const ct_problem *problem)
{
  probe p = {problem, room(problem->effect_count, sizeof(void *)), NULL, NULL,
             numbers(3 * (int64_t)problem->node_count)};
  int64_t memory = 0;
  for (int k = 0; k < problem->effect_count; k++) {
    const ct_effect *effect = problem->effects[k];
    if (effect->calls->create_scratch != NULL)
      must(effect->calls->create_scratch, effect, &p.scratch[k]);
    memory += effect->memory_count;
  }
  p.memory = numbers(memory);
  p.next = numbers(memory);
  return p;
}

static inline void probe_close(probe *p)
{
  for (int k = 0; k < p->problem->effect_count; k++)
    if (p->scratch[k] != NULL) p->problem->effects[k]->calls->free_scratch(p->scratch[k]);
  free_all(p->scratch, p->memory, p->next, p->force);
}

/* Sum of the forces of all effects but reactions, shape (node_count, 3). */
static inline void probe_force(probe *p, const double *u, double *sum)
{
  int64_t memory = 0;
  memset(sum, 0, 3 * (size_t)p->problem->node_count * sizeof *sum);
  for (int k = 0; k < p->problem->effect_count; k++) {
    const ct_effect *effect = p->problem->effects[k];
    if (effect->phase == CT_PHASE_REACTION) continue;
    ct_view view = {.reference = p->problem->reference,
                    .displacement = u,
                    .velocity = u,
                    .memory = p->memory + memory,
                    .next_memory = p->next + memory,
                    .scratch = p->scratch[k]};
    for (int j = 0; j < k; j++)
      if (p->problem->effects[j] == effect->reads) view.read = p->scratch[j];
    must(effect->calls->force, effect, &view, p->force);
    for (int i = 0; i < effect->node_count; i++)
      for (int c = 0; c < 3; c++)
        sum[3 * (effect->nodes == NULL ? i : effect->nodes[i]) + c] += p->force[3 * i + c];
    memory += effect->memory_count;
  }
}

/* Largest eigenvalue of M⁻¹K about the displacement u0, by power iteration with the Rayleigh
 * quotient (at any time a lower bound). K is the difference of forces over a displacement of size
 * `small`; `component` 0 ... 2 uses only that direction. */
static inline double true_frequency(const ct_problem *problem, const double *u0, double small,
                                    int component, int iterations)
{
  int64_t n = 3 * (int64_t)problem->node_count;
  double *v = numbers(n), *u = numbers(n), *f0 = numbers(n), *f = numbers(n), quotient = 0.0;
  probe p = probe_open(problem);
  probe_force(&p, u0, f0);
  for (int64_t i = 0; i < n; i++)
    v[i] = problem->inverse_mass[i] > 0.0 && (component < 0 || i % 3 == component) ? uniform(1.0)
                                                                                   : 0.0;
  for (int k = 0; k < iterations; k++) {
    double top = largest(v, n), work = 0.0, mass = 0.0;
    for (int64_t i = 0; i < n; i++) u[i] = u0[i] + (v[i] *= 1.0 / top) * small;
    probe_force(&p, u, f);
    for (int64_t i = 0; i < n; i++) {
      double Kv = -(f[i] - f0[i]) / small;
      if (problem->inverse_mass[i] == 0.0 || (component >= 0 && i % 3 != component)) continue;
      work += v[i] * Kv;
      mass += v[i] * v[i] / problem->inverse_mass[i];
      v[i] = problem->inverse_mass[i] * Kv;
    }
    quotient = work / mass;
  }
  probe_close(&p);
  free_all(v, u, f0, f);
  return quotient;
}

/* Largest eigenvalue of a symmetric n x n matrix by Jacobi's rotations. */
static inline double jacobi_largest(int n, double *A)
{
  for (int sweep = 0; sweep < 60; sweep++) {
    double off = 0.0, on = 0.0;
    for (int p = 0; p < n; p++)
      for (int q = 0; q < n; q++) *(p == q ? &on : &off) += A[p * n + q] * A[p * n + q];
    if (off <= 1e-30 * on) break;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        if (A[p * n + q] == 0.0) continue;
        double theta = (A[q * n + q] - A[p * n + p]) / (2.0 * A[p * n + q]);
        double t = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(theta * theta + 1.0)),
               c = 1.0 / sqrt(t * t + 1.0), s = t * c;
        for (int k = 0; k < n; k++) {
          double a = A[k * n + p], b = A[k * n + q];
          A[k * n + p] = c * a - s * b;
          A[k * n + q] = s * a + c * b;
        }
        for (int k = 0; k < n; k++) {
          double a = A[p * n + k], b = A[q * n + k];
          A[p * n + k] = c * a - s * b;
          A[q * n + k] = s * a + c * b;
        }
      }
  }
  double top = A[0];
  for (int i = 1; i < n; i++) top = fmax(top, A[i * n + i]);
  return top;
}

static inline ct_scene *new_scene(void)
{
  ct_scene *scene = NULL;
  must(ct_scene_create, &scene);
  return later_scene(scene);
}

/* Add a body to a scene, which copies the mesh. */
static inline int32_t add_body(ct_scene *scene, const char *name, const ct_mesh *mesh,
                               const ct_material *material, ct_solid_kernel kernel, double vx,
                               double vy, double vz)
{
  ct_scene_body def = {.name = name,
                       .mesh = mesh,
                       .material = *material,
                       .kernel = kernel,
                       .velocity = {vx, vy, vz}};
  int32_t body = -1;
  must(ct_scene_add_body, scene, &def, &body);
  return body;
}

/* A scene with such a body as its first one. */
static inline ct_scene *new_scene_with(const char *name, const ct_mesh *mesh,
                                       const ct_material *material, ct_solid_kernel kernel,
                                       double vx, double vy, double vz)
{
  ct_scene *scene = new_scene();
  add_body(scene, name, mesh, material, kernel, vx, vy, vz);
  return scene;
}

/* A body whose nodes have individual velocities, shape (node_count, 3). */
static inline int32_t add_moving_body(ct_scene *scene, const char *name, const ct_mesh *mesh,
                                      const ct_material *material, ct_solid_kernel kernel,
                                      const double *velocities)
{
  ct_scene_body def = {.name = name,
                       .mesh = mesh,
                       .material = *material,
                       .kernel = kernel,
                       .velocities = velocities};
  int32_t body = -1;
  must(ct_scene_add_body, scene, &def, &body);
  return body;
}

/* Fix the components in `which` ("x", "xyz", ...) of a body's nodes in a plane; `axis` -1: of all
 * its nodes. */
static inline void add_support(ct_scene *scene, int32_t body, const ct_mesh *mesh, int axis,
                               double value, const char *which, double velocity)
{
  int32_t *nodes = integers(mesh->node_count), count = mesh->node_count;
  for (int32_t i = 0; i < count; i++) nodes[i] = i;
  if (axis >= 0) count = ct_mesh_plane_nodes(mesh, axis, value, nodes);
  ct_scene_support support = {.body = body, .nodes = nodes, .node_count = count};
  for (int c = 0; c < 3; c++) {
    support.fixed[c] = strchr(which, "xyz"[c]) != NULL;
    support.velocity[c] = support.fixed[c] ? velocity : 0.0;
  }
  must(ct_scene_add_support, scene, &support);
  free_all(nodes);
}

/* The definition of a contact with the default options. */
static inline ct_scene_contact scene_contact(int32_t a, const int32_t *faces_a, int32_t count_a,
                                             int32_t b, const int32_t *faces_b, int32_t count_b)
{
  return (ct_scene_contact){.body_a = a,
                            .body_b = b,
                            .face_count_a = count_a,
                            .face_count_b = count_b,
                            .faces_a = faces_a,
                            .faces_b = faces_b,
                            .options = ct_contact_options_default()};
}

/* Contact between the faces of two bodies in the planes x[axis] = at_a and at_b, with options
 * (`beta` and `faces` count, not `epsilon`) and friction. */
static inline ct_status add_contact_with(ct_scene *scene, int32_t a, const ct_mesh *mesh_a,
                                         double at_a, int32_t b, const ct_mesh *mesh_b, double at_b,
                                         int axis, double beta, ct_contact_options options,
                                         double friction, double tangent)
{
  int32_t *fa = integers(8 * 6 * mesh_a->element_count),
          *fb = integers(8 * 6 * mesh_b->element_count);
  ct_scene_contact contact =
      scene_contact(a, fa, ct_mesh_plane_faces(mesh_a, axis, at_a, fa, NULL), b, fb,
                    ct_mesh_plane_faces(mesh_b, axis, at_b, fb, NULL));
  contact.beta = beta, contact.options = options;
  contact.friction = friction, contact.tangent = tangent;
  ct_error error;
  ct_status status = ct_scene_add_contact(scene, &contact, &error);
  need(status, &error);
  free_all(fa, fb);
  return status;
}

/* The same with the explicit penalty and friction; an overlap at the start is pushed out, as a
 * load. */
static inline ct_status add_rough_contact(ct_scene *scene, int32_t a, const ct_mesh *mesh_a,
                                          double at_a, int32_t b, const ct_mesh *mesh_b,
                                          double at_b, int axis, double beta, double friction,
                                          double tangent)
{
  ct_contact_options options = ct_contact_options_default();
  options.enforcement = CT_ENFORCE_PENALTY;
  options.initial_penetration = CT_INITIAL_FORCE;
  return add_contact_with(scene, a, mesh_a, at_a, b, mesh_b, at_b, axis, beta, options, friction,
                          tangent);
}

/* The same without friction. */
static inline ct_status add_contact(ct_scene *scene, int32_t a, const ct_mesh *mesh_a, double at_a,
                                    int32_t b, const ct_mesh *mesh_b, double at_b, int axis,
                                    double beta)
{
  return add_rough_contact(scene, a, mesh_a, at_a, b, mesh_b, at_b, axis, beta, 0.0, 0.0);
}

/* A weight m (g - c v) on all nodes from `first` on, as a host's effect, plus a pull along x that
 * grows and decays as sin² over a period. */
typedef struct weight {
  const ct_problem *problem;
  int32_t first;
  double g[3], damping, pull, period;
} weight;

static inline ct_status weight_force(const ct_effect *effect, const ct_view *view, double *force,
                                     ct_error *error)
{
  const weight *w = effect->data;
  double s = w->period > 0.0 && view->time < w->period
                 ? sin(3.14159265358979323846 * view->time / w->period)
                 : 0.0;
  (void)error;
  for (int32_t n = 0; n < effect->node_count; n++)
    for (int c = 0; c < 3; c++) {
      double pull = c == 0 ? w->pull * s * s : 0.0;
      force[3 * n + c] =
          n < w->first
              ? 0.0
              : w->problem->mass[n] * (w->g[c] - w->damping * view->velocity[3 * n + c] + pull);
    }
  return CT_OK;
}

static inline ct_status weight_damping(const ct_effect *effect, const ct_view *view, double *rate,
                                       ct_error *error)
{
  (void)view;
  (void)error;
  *rate = ((const weight *)effect->data)->damping;
  return CT_OK;
}

/* The bodies of a scene as a problem, on which effects are made. */
static inline const ct_problem *join_scene(ct_scene *scene)
{
  const ct_problem *joined = NULL;
  must(ct_scene_join, scene, &joined);
  return joined;
}

/* Add a host's effect to a scene. */
static inline void add_effect(ct_scene *scene, const ct_effect *filled)
{
  ct_effect *effect = NULL;
  join_scene(scene);
  must(ct_effect_create, filled, &effect);
  must(ct_scene_add_effect, scene, effect);
}

static inline void add_weight(ct_scene *scene, weight w)
{
  static const ct_effect_calls calls = {
      .force = weight_force, .free_data = free, .bounds = {.rate = weight_damping}};
  weight *own = unlist(room(1, sizeof *own)); // the effect frees it
  *own = w;
  must(ct_scene_join, scene, &own->problem);
  add_effect(scene, &(ct_effect){.label = "weight",
                                 .calls = &calls,
                                 .data = own,
                                 .node_count = own->problem->node_count});
}

/* Create an effect of the library from its definition with its factory, and add it to a scene. */
#define add_made(scene, create, def)                \
  do {                                              \
    ct_effect *made_ = NULL;                        \
    must(create, (def), join_scene(scene), &made_); \
    must(ct_scene_add_effect, (scene), made_);      \
  } while (0)

static inline void set_threads(ct_scene *scene, int threads)
{
  must(ct_scene_set_run_settings, scene, &(ct_run_settings){.threads = threads});
}

/* `steps` and `stable` may be null. */
static inline const ct_problem *build(ct_scene *scene, ct_scene_time time, int64_t *steps,
                                      ct_stable_step *stable)
{
  const ct_problem *problem = NULL;
  int64_t count;
  must(ct_scene_build, scene, &time, &problem, &count, stable);
  if (steps != NULL) *steps = count;
  return problem;
}

static inline const ct_problem *build_until(ct_scene *scene, double end, double fraction)
{
  return build(scene, (ct_scene_time){.end = end, .fraction = fraction}, NULL, NULL);
}

/* The same with an integrator. */
static inline const ct_problem *build_by(ct_scheme scheme, ct_scene *scene, double end,
                                         double fraction, int64_t *steps)
{
  const ct_integrator integrator = ct_integrator_default(scheme);
  return build(scene, (ct_scene_time){.end = end, .fraction = fraction, .integrator = integrator},
               steps, NULL);
}

static inline ct_state *new_state(const ct_problem *problem)
{
  ct_state *state = NULL;
  must(ct_state_create, problem, &state);
  return later_state(state);
}

static inline void close_run(ct_state *state, ct_scene *scene, ct_mesh *mesh)
{
  free_state(state);
  free_scene(scene);
  free_mesh(mesh);
}

static inline void advance(const ct_problem *problem, ct_state *state, int64_t steps)
{
  must(ct_run, problem, state, steps, NULL, 0);
}

/* The arrays of a restart, bit for bit. */
static inline int same_state(const ct_state *x, const ct_state *y)
{
  size_t n = 3 * (size_t)x->node_count * sizeof(double);
  return x->step == y->step && x->time == y->time && x->kinetic_start == y->kinetic_start &&
         memcmp(x->displacement, y->displacement, n) == 0 &&
         memcmp(x->velocity, y->velocity, n) == 0 &&
         memcmp(x->work, y->work, (size_t)x->work_count * sizeof(double)) == 0 &&
         memcmp(x->impulse, y->impulse, (size_t)x->impulse_count * sizeof(double)) == 0 &&
         memcmp(x->memory, y->memory, (size_t)x->memory_count * sizeof(double)) == 0;
}

static inline ct_energy energy_of(const ct_problem *problem, ct_state *state)
{
  ct_energy energy = {0};
  must(ct_energy_of, problem, state, &energy);
  return energy;
}

static inline ct_momentum momentum_of(const ct_problem *problem, ct_state *state, int32_t body)
{
  ct_momentum momentum = {0};
  must(ct_momentum_of, problem, state, body, &momentum);
  return momentum;
}

#endif
