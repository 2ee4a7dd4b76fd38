#include <libcontact/contact_effect.h>
#include <libcontact/scene.h>

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../effect/contact.h"
#include "../effect/solid.h"
#include "../mesh/mesh_internal.h"
#include "../step/effect_internal.h"
#include "../step/workspace.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Data that were added for one body and contact. */
typedef struct scene_body {
  ct_scene_body given; /* without its mesh and arrays */
  ct_mesh *mesh;
  double *velocities, *displacements; /* of each node, or null */
  ct_material *materials;             /* of each element, or null */
  int32_t stiffest;                   /* element of the stiffest of them */
} scene_body;

typedef struct scene_contact {
  ct_scene_contact given; /* without its faces */
  int32_t body[2], face_count[2], *faces[2];
  double epsilon;
} scene_contact;

struct ct_scene {
  ct_pool pool; /* all except meshes and effects */
  int32_t body_count, contact_count, support_count, added_count;
  ct_body *bodies;
  scene_body *parts;
  scene_contact *contacts;
  ct_support *supports;
  ct_effect **added; /* in addition to solid, contacts and supports */
  ct_optimisations optimisations;
  int joined;    /* the nodes are numbered, no body can be added */
  int unchanged; /* no build has changed the results of `start_body` */
  /* What `ct_scene_build` makes. */
  ct_problem problem;
  ct_effect **effects;
  double *reference, *mass, *inverse_mass, *velocity, *displacement;
};

/* A table of `count` rows with capacity for one more; unchanged if out of memory. */
static void *grow(ct_scene *scene, void *table, int32_t count, size_t size)
{
  if (count > 0 && (count & (count - 1)) != 0)
    return table; // the capacity doubles at powers of two
  void *larger = ct_pool_take(&scene->pool, count == 0 ? 1 : 2 * (size_t)count, size);
  if (larger != NULL && count > 0) memcpy(larger, table, (size_t)count * size);
  return larger != NULL ? larger : table;
}

/* Whether all allocations succeeded; if not, the next call may try again. */
static ct_status check_memory(ct_scene *scene, const char *what, ct_error *error)
{
  if (!scene->pool.failed) return CT_OK;
  scene->pool.failed = 0;
  return CT_NO_MEMORY(error, "%s", what);
}

ct_status ct_scene_create(ct_scene **scene, ct_error *error)
{
  if (scene == NULL) return CT_REFUSE_NULL(error);
  *scene = ct_allocate(1, sizeof **scene);
  if (*scene == NULL) return CT_NO_MEMORY(error, "a scene");
  (*scene)->optimisations = (ct_optimisations){1, 1, 1};
  return CT_OK;
}

ct_status ct_scene_set_optimisations(ct_scene *scene, const ct_optimisations *optimisations,
                                     ct_error *error)
{
  if (scene == NULL || optimisations == NULL) return CT_REFUSE_NULL(error);
  scene->optimisations = *optimisations;
  return CT_OK;
}

ct_status ct_scene_set_run_settings(ct_scene *scene, const ct_run_settings *settings,
                                    ct_error *error)
{
  if (scene == NULL || settings == NULL) return CT_REFUSE_NULL(error);
  if (settings->threads < 0 || settings->threads > CT_MOST_THREADS)
    return CT_REFUSE(error, "run settings: threads must be 0 (all processors) to %d, not %d",
                     (int)CT_MOST_THREADS, settings->threads);
  scene->problem.settings = *settings;
  return CT_OK;
}

/* Whether an effect was added, and not made by `ct_scene_build`. */
static int is_added(const ct_scene *scene, const ct_effect *effect)
{
  for (int32_t i = 0; i < scene->added_count; i++)
    if (scene->added[i] == effect) return 1;
  return 0;
}

/* Free the results of `ct_scene_build`. */
static void unbuild(ct_scene *scene)
{
  for (int32_t i = 0; i < scene->problem.effect_count; i++)
    if (!is_added(scene, scene->effects[i])) ct_effect_free(scene->effects[i]);
  ct_release(scene->effects);
  scene->effects = NULL;
  scene->problem.effects = NULL;
  scene->problem.effect_count = 0;
}

void ct_scene_free(ct_scene *scene)
{
  if (scene == NULL) return;
  unbuild(scene);
  for (int32_t i = 0; i < scene->added_count; i++) ct_effect_free(scene->added[i]);
  for (int32_t i = 0; i < scene->body_count; i++) {
    if (scene->joined) scene->parts[i].mesh->nodes = NULL; // the problem's
    ct_mesh_free(scene->parts[i].mesh);
  }
  ct_pool_free(scene);
}

/* A vector of each node, or null. */
static ct_status check_rows(const double *rows, const char *what, int32_t nodes, const char *name,
                            ct_error *error)
{
  const int64_t count = rows == NULL ? 0 : 3 * (int64_t)nodes;
  for (int64_t d = 0; d < count; d++)
    if (!isfinite(rows[d]))
      return ct_fail(error, CT_INVALID, (ct_place){-1, -1, d / 3},
                     "body %s: %s %c of node %d is not finite", name, what, "xyz"[d % 3],
                     (int)(d / 3));
  return CT_OK;
}

static ct_status check_motion(const ct_scene_body *def, int32_t nodes, const char *name,
                              ct_error *error)
{
  for (int c = 0; c < 3; c++)
    if (!isfinite(def->velocity[c]))
      return ct_fail(error, CT_INVALID, CT_NOWHERE, "body %s: velocity %c is not finite", name,
                     "xyz"[c]);
  ct_status status = check_rows(def->velocities, "velocity", nodes, name, error);
  return status == CT_OK ? check_rows(def->displacements, "displacement", nodes, name, error)
                         : status;
}

static ct_status check_new_body(const ct_scene *scene, const ct_scene_body *def, const char *name,
                                ct_error *error)
{
  if (scene->joined)
    return CT_REFUSE(error, "body %s: add it before ct_scene_join; the bodies are joined already",
                     name);
  if ((int)def->lumping < CT_LUMP_DEFAULT || (int)def->lumping > CT_LUMP_HRZ)
    return CT_REFUSE(error, "body %s: there is no lumping %d", name, (int)def->lumping);
  if ((int)def->kernel < CT_KERNEL_AUTO || (int)def->kernel > CT_KERNEL_REDUCED)
    return CT_REFUSE(error, "body %s: there is no kernel %d", name, (int)def->kernel);
  if (!(def->hourglass >= 0.0) || !isfinite(def->hourglass))
    return CT_REFUSE(error,
                     "body %s: hourglass must be 0 (the default) or positive and finite, not %g",
                     name, def->hourglass);
  if (!(def->stiffness_damping >= 0.0) || !isfinite(def->stiffness_damping))
    return CT_REFUSE(error,
                     "body %s: stiffness_damping must be 0 (none) or positive and finite, not %g",
                     name, def->stiffness_damping);
  return def->materials != NULL ? CT_OK : ct_material_check(&def->material, error);
}

/* Copies of a body's mesh or box and velocities, and entries in the tables. */
static ct_status copy_body(ct_scene *scene, const ct_scene_body *def, const char *name,
                           scene_body *part, ct_error *error)
{
  ct_mesh source = def->mesh != NULL ? *def->mesh : (ct_mesh){.nodes = NULL};
  source.settings = &scene->problem.settings;
  ct_status status = def->mesh != NULL ? ct_mesh_create_copy(&source, &part->mesh, error)
                                       : ct_mesh_make_box(def->kind, &def->box, source.settings,
                                                          &part->mesh, error);
  if (status == CT_OK) part->mesh->settings = source.settings;
  if (status == CT_OK && def->mesh == NULL) status = ct_mesh_check_shapes(part->mesh, error);
  if (status == CT_OK) status = check_motion(def, part->mesh->node_count, name, error);
  if (status == CT_OK && def->materials != NULL)
    status = ct_materials_check(def->materials, part->mesh->element_count, &part->stiffest, error);
  if (status == CT_OK) {
    const size_t bytes = 3 * (size_t)part->mesh->node_count * sizeof(double);
    if (def->materials != NULL)
      part->materials = ct_pool_copy(&scene->pool, def->materials,
                                     (size_t)part->mesh->element_count * sizeof *def->materials);
    if (def->velocities != NULL)
      part->velocities = ct_pool_copy(&scene->pool, def->velocities, bytes);
    if (def->displacements != NULL)
      part->displacements = ct_pool_copy(&scene->pool, def->displacements, bytes);
    scene->bodies = grow(scene, scene->bodies, scene->body_count, sizeof *scene->bodies);
    scene->parts = grow(scene, scene->parts, scene->body_count, sizeof *scene->parts);
    status = check_memory(scene, "a body", error);
  }
  if (status != CT_OK) ct_mesh_free(part->mesh);
  return status;
}

ct_status ct_scene_add_body(ct_scene *scene, const ct_scene_body *def, int32_t *body,
                            ct_error *error)
{
  if (scene == NULL || def == NULL) return CT_REFUSE_NULL(error);
  scene_body part = {.given = *def};
  const char *name = def->name == NULL ? "" : def->name;
  ct_status status = check_new_body(scene, def, name, error);
  if (status == CT_OK) status = copy_body(scene, def, name, &part, error);
  if (status != CT_OK) {
    if (error != NULL) error->body = scene->body_count;
    return status;
  }
  ct_body *entry = &scene->bodies[scene->body_count];
  snprintf(entry->name, sizeof entry->name, "%s", name);
  entry->mesh = part.mesh;
  entry->material = part.materials != NULL ? part.materials[part.stiffest] : def->material;
  entry->materials = part.materials;
  memcpy(entry->initial_stress, def->initial_stress, sizeof entry->initial_stress);
  entry->first_node = 0;
  for (int32_t i = 0; i < scene->body_count; i++)
    entry->first_node += scene->bodies[i].mesh->node_count;
  scene->parts[scene->body_count] = part;
  if (body != NULL) *body = scene->body_count;
  scene->body_count++;
  return CT_OK;
}

static ct_status check_body(const ct_scene *scene, int32_t body, const char *what, ct_error *error)
{
  if (body >= 0 && body < scene->body_count) return CT_OK;
  return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body, -1, -1}, "%s: there is no body %d",
                 what, (int)body);
}

/* Node numbers of a body's own mesh, `per` of them per face; a support's nodes are single (`per`
 * 0). */
static ct_status check_nodes(const ct_scene *scene, int32_t body, const int32_t *nodes,
                             int64_t count, int per, const char *what, ct_error *error)
{
  int32_t limit = scene->parts[body].mesh->node_count;
  for (int64_t i = 0; i < count; i++)
    if (nodes[i] < 0 || nodes[i] >= limit)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){body, per > 0 ? i / per : -1, nodes[i]},
                     "%s: there is no node %d, body %s has nodes 0 to %d", what, (int)nodes[i],
                     scene->bodies[body].name, (int)limit - 1);
  return CT_OK;
}

/* The outer faces in a side of a body's mesh, with the body's own node numbers. */
static ct_status side_faces(ct_scene *scene, const ct_mesh *mesh, ct_box_side side, int32_t **faces,
                            int32_t *count, ct_error *error)
{
  double bound[2][3];
  int axis = ((int)side - 1) / 2, top = ((int)side - 1) % 2;
  ct_mesh_bounds(mesh, bound[0], bound[1]);
  *count = ct_mesh_plane_faces(mesh, axis, bound[top][axis], NULL, NULL);
  if (*count == 0)
    return CT_REFUSE(error, "contact: the body has no faces in its side %c_%s", "xyz"[axis],
                     top ? "max" : "min");
  size_t per = (size_t)ct_face_node_count(ct_brick_face_kind(mesh->kind));
  if (*count > 0) *faces = ct_pool_take(&scene->pool, (size_t)*count * per, sizeof **faces);
  if (*faces != NULL) *count = ct_mesh_plane_faces(mesh, axis, bound[top][axis], *faces, NULL);
  scene->pool.failed |= *count < 0;
  return check_memory(scene, "a contact", error);
}

/* Copy surface `s` of a contact: the listed faces, or a side. */
static ct_status copy_surface(ct_scene *scene, scene_contact *entry, int s, const int32_t *listed,
                              ct_box_side side, ct_error *error)
{
  int32_t body = entry->body[s], *count = &entry->face_count[s];
  ct_status status = check_body(scene, body, "contact", error);
  if (status != CT_OK) return status;
  const ct_mesh *mesh = scene->parts[body].mesh;
  int per = ct_face_node_count(ct_brick_face_kind(mesh->kind));
  if (listed == NULL && side >= CT_X_MIN && side <= CT_Z_MAX)
    status = side_faces(scene, mesh, side, &entry->faces[s], count, error);
  else if (listed == NULL || *count < 1 || side != CT_SIDE_NONE)
    status = CT_REFUSE(error, "contact: surface %d needs either a list of faces or a side", s);
  else status = check_nodes(scene, body, listed, (int64_t)*count * per, per, "contact", error);
  if (status != CT_OK) return status;
  size_t entries = (size_t)*count * (size_t)per;
  if (listed != NULL)
    entry->faces[s] = ct_pool_copy(&scene->pool, listed, entries * sizeof *listed);
  for (size_t i = 0; entry->faces[s] != NULL && i < entries; i++)
    entry->faces[s][i] += scene->bodies[body].first_node;
  return check_memory(scene, "a contact", error);
}

/* Surface `s` of a contact and surface `t` of another one: the place of a face of both in the
 * first, -1 or -2 as ct_mesh_common_face. */
static int32_t common_face(const ct_scene *scene, const scene_contact *a, int s,
                           const scene_contact *b, int t)
{
  if (a->body[s] != b->body[t]) return -1;
  int per = ct_face_node_count(ct_brick_face_kind(scene->parts[a->body[s]].mesh->kind));
  return ct_mesh_common_face(per, a->faces[s], a->face_count[s], b->faces[t], b->face_count[t]);
}

/* Write the element behind a face of a contact, its body and the middle of the face. */
static ct_status name_face(const ct_scene *scene, const scene_contact *c, int s, int32_t at,
                           char text[160], ct_error *error)
{
  const ct_body *body = &scene->bodies[c->body[s]];
  const ct_mesh *mesh = scene->parts[c->body[s]].mesh;
  const int per = ct_face_node_count(ct_brick_face_kind(mesh->kind));
  int32_t face[8], owner = -1;
  double x[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < per; k++) face[k] = c->faces[s][at * per + k] - body->first_node;
  for (int k = 0; k < 4; k++)
    for (int d = 0; d < 3; d++) x[d] += mesh->nodes[3 * (int64_t)face[k] + d] / 4.0;
  ct_status status = ct_mesh_face_owners(mesh, 1, face, &owner, error);
  snprintf(text, 160, "element %d of \"%s\" (face at %.4g, %.4g, %.4g)", (int)owner, body->name,
           x[0], x[1], x[2]);
  return status;
}

/* Refuse a contact that has faces of both surfaces in common with an earlier one: the force between
 * them would act twice. */
static ct_status check_shared(const ct_scene *scene, const scene_contact *c, ct_error *error)
{
  for (int32_t i = 0; i < scene->contact_count; i++)
    for (int turned = 0; turned < 2; turned++) {
      char first[160], second[160];
      const scene_contact *other = &scene->contacts[i];
      int32_t a = common_face(scene, c, 0, other, turned),
              b = a == -1 ? -1 : common_face(scene, c, 1, other, 1 - turned);
      if (a == -1 || b == -1) continue;
      if (a == -2 || b == -2) return CT_NO_MEMORY(error, "a contact");
      ct_status status = name_face(scene, c, 0, a, first, error);
      if (status == CT_OK) status = name_face(scene, c, 1, b, second, error);
      if (status != CT_OK) return status;
      return ct_fail(
          error, CT_ERROR_ARGUMENT, CT_NOWHERE,
          "contact[%d] has faces of both surfaces, too, and their force would act twice: "
          "%s and %s; leave one of the contacts out, or name surfaces without common "
          "faces",
          (int)i, first, second);
    }
  return CT_OK;
}

ct_status ct_scene_add_contact(ct_scene *scene, const ct_scene_contact *contact, ct_error *error)
{
  if (scene == NULL || contact == NULL) return CT_REFUSE_NULL(error);
  if (ct_check_options(contact->options.cookie, "ct_contact_options_default", error) != CT_OK)
    return CT_ERROR_ARGUMENT;
  if (!(contact->beta >= 0.0))
    return CT_REFUSE(error, "contact: beta must be 0 (the default) or positive, not %g",
                     contact->beta);
  if (!(contact->options.epsilon >= 0.0))
    return CT_REFUSE(error, "contact: epsilon must be 0 (the default) or positive, not %g",
                     contact->options.epsilon);
  if (contact->beta > 0.0 && contact->options.epsilon > 0.0)
    return CT_REFUSE(error, "contact: give beta or epsilon, not both (%g and %g)", contact->beta,
                     contact->options.epsilon);
  scene_contact entry = {.given = *contact,
                         .body = {contact->body_a, contact->body_b},
                         .face_count = {contact->face_count_a, contact->face_count_b}};
  ct_status status = copy_surface(scene, &entry, 0, contact->faces_a, contact->side_a, error);
  if (status == CT_OK)
    status = copy_surface(scene, &entry, 1, contact->faces_b, contact->side_b, error);
  if (status == CT_OK) status = check_shared(scene, &entry, error);
  if (status != CT_OK) return status;
  scene->contacts = grow(scene, scene->contacts, scene->contact_count, sizeof *scene->contacts);
  status = check_memory(scene, "a contact", error);
  if (status == CT_OK) scene->contacts[scene->contact_count++] = entry;
  return status;
}

ct_status ct_scene_add_support(ct_scene *scene, const ct_scene_support *support, ct_error *error)
{
  if (scene == NULL || support == NULL) return CT_REFUSE_NULL(error);
  if (support->nodes == NULL || support->node_count < 1)
    return CT_REFUSE(error, "support: its list of nodes is empty");
  int32_t count = support->node_count, body = support->body;
  ct_status status = check_body(scene, body, "support", error);
  if (status == CT_OK)
    status = check_nodes(scene, body, support->nodes, count, 0, "support", error);
  if (status != CT_OK) return status;
  scene->supports = grow(scene, scene->supports, scene->support_count, sizeof *scene->supports);
  int32_t *nodes = ct_pool_copy(&scene->pool, support->nodes, (size_t)count * sizeof *nodes);
  status = check_memory(scene, "a support", error);
  if (status != CT_OK) return status;
  for (int32_t i = 0; i < count; i++) nodes[i] += scene->bodies[body].first_node;
  ct_support *entry = &scene->supports[scene->support_count++];
  *entry = (ct_support){.nodes = nodes, .node_count = count};
  memcpy(entry->fixed, support->fixed, sizeof entry->fixed);
  memcpy(entry->velocity, support->velocity, sizeof entry->velocity);
  return CT_OK;
}

/* Values that the supports change and from which each build begins: 1 / m and the initial velocity
 * of all nodes of a body. */
static ct_status start_body(ct_scene *scene, int32_t i, ct_error *error)
{
  const scene_body *part = &scene->parts[i];
  size_t first = (size_t)scene->bodies[i].first_node, count = (size_t)part->mesh->node_count;
  for (size_t n = first; n < first + count; n++)
    if (!(scene->mass[n] > 0.0))
      return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){i, -1, (int64_t)(n - first)},
                     "node %d of body %s belongs to no element", (int)(n - first),
                     scene->bodies[i].name);
#ifdef _OPENMP
  int threads =
      ct_threads_for(ct_threads_of(part->mesh->settings), part->mesh->node_count, CT_LEAST_OF_MESH);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
#endif
  for (size_t n = first; n < first + count; n++)
    for (size_t c = 0, d = 3 * n; c < 3; c++, d++) {
      scene->inverse_mass[d] = 1.0 / scene->mass[n];
      scene->velocity[d] =
          part->velocities != NULL ? part->velocities[d - 3 * first] : part->given.velocity[c];
    }
  return CT_OK;
}

/* The displacements at t = 0 of all bodies, if any body has some. */
static ct_status start_displacements(ct_scene *scene, size_t nodes, ct_error *error)
{
  for (int32_t i = 0; i < scene->body_count; i++) {
    const scene_body *part = &scene->parts[i];
    if (part->displacements == NULL) continue;
    if (scene->displacement == NULL)
      scene->displacement = ct_pool_take(&scene->pool, nodes, 3 * sizeof(double));
    if (scene->displacement != NULL)
      memcpy(&scene->displacement[3 * (size_t)scene->bodies[i].first_node], part->displacements,
             3 * (size_t)part->mesh->node_count * sizeof(double));
  }
  return check_memory(scene, "the displacements", error);
}

static ct_status join_bodies(ct_scene *scene, ct_error *error)
{
  ct_status status = CT_OK;
  const ct_body *last = &scene->bodies[scene->body_count - 1];
  size_t n = (size_t)last->first_node + (size_t)last->mesh->node_count;
  // Masses come first: lumping needs much temporary memory, and little is allocated before it.
  scene->mass = ct_pool_take(&scene->pool, n, sizeof(double));
  for (int32_t i = 0; status == CT_OK && scene->mass != NULL && i < scene->body_count; i++) {
    const ct_body *body = &scene->bodies[i];
    status =
        ct_mass_of_materials(body->mesh, body->material.density, body->materials,
                             scene->parts[i].given.lumping, &scene->mass[body->first_node], error);
    if (status != CT_OK && error != NULL) error->body = i;
  }
  double **arrays[] = {&scene->reference, &scene->inverse_mass, &scene->velocity};
  for (int i = 0; i < 3; i++) *arrays[i] = ct_pool_take(&scene->pool, n, 3 * sizeof(double));
  if (status == CT_OK) status = check_memory(scene, "the nodes", error);
  for (int32_t i = 0; status == CT_OK && i < scene->body_count; i++)
    status = start_body(scene, i, error);
  if (status == CT_OK) status = start_displacements(scene, n, error);
  if (status != CT_OK) return status;
  // From here on the bodies' meshes share the coordinates of the problem.
  for (int32_t i = 0; i < scene->body_count; i++) {
    ct_mesh *mesh = scene->parts[i].mesh;
    double *own = &scene->reference[3 * (size_t)scene->bodies[i].first_node];
    memcpy(own, mesh->nodes, 3 * (size_t)mesh->node_count * sizeof *own);
    ct_release(mesh->nodes);
    mesh->nodes = own;
  }
  scene->problem = (ct_problem){.node_count = (int32_t)n,
                                .body_count = scene->body_count,
                                .bodies = scene->bodies,
                                .reference = scene->reference,
                                .mass = scene->mass,
                                .inverse_mass = scene->inverse_mass,
                                .initial_velocity = scene->velocity,
                                .initial_displacement = scene->displacement,
                                .settings = scene->problem.settings};
  return CT_OK;
}

ct_status ct_scene_join(ct_scene *scene, const ct_problem **problem, ct_error *error)
{
  if (scene == NULL || problem == NULL) return CT_REFUSE_NULL(error);
  if (scene->body_count < 1) return CT_REFUSE(error, "scene: it has no bodies; add one first");
  ct_status status = CT_OK;
  if (!scene->joined) {
    status = join_bodies(scene, error);
    scene->joined = scene->unchanged = status == CT_OK;
  }
  *problem = &scene->problem;
  return status;
}

ct_status ct_scene_add_effect(ct_scene *scene, ct_effect *effect, ct_error *error)
{
  ct_status status = CT_OK;
  if (scene == NULL || effect == NULL) status = CT_REFUSE_NULL(error);
  else if (!scene->joined)
    status = CT_REFUSE(
        error, "effect %s: join the scene's bodies first, an effect is made for their nodes",
        effect->label);
  else if (is_added(scene, effect))
    return CT_REFUSE(error, "effect %s: the scene has it already", effect->label);
  else status = ct_effect_check_nodes(effect, scene->problem.node_count, error);
  if (status == CT_OK) {
    scene->added = grow(scene, scene->added, scene->added_count, sizeof(ct_effect *));
    status = check_memory(scene, "an effect", error);
  }
  if (status == CT_OK) scene->added[scene->added_count++] = effect;
  else ct_effect_free(effect);
  return status;
}

/* Whether supports hold all nodes of a body in a direction at velocity 0, after they were applied.
 */
static int body_is_fixed(const ct_scene *scene, int32_t body, int axis)
{
  size_t first = (size_t)scene->bodies[body].first_node,
         count = (size_t)scene->parts[body].mesh->node_count;
  for (size_t n = first; n < first + count; n++)
    if (scene->inverse_mass[3 * n + (size_t)axis] != 0.0 ||
        scene->velocity[3 * n + (size_t)axis] != 0.0)
      return 0;
  return 1;
}

/* Whether an added effect keeps a body rigid. */
static int is_rigid(const ct_scene *scene, int32_t body)
{
  const ct_problem added = {.bodies = scene->bodies,
                            .effect_count = scene->added_count,
                            .effects = (const ct_effect *const *)scene->added};
  return ct_problem_is_rigid(&added, body);
}

static ct_status make_solid(ct_scene *scene, ct_error *error)
{
  ct_solid_body *bodies = ct_allocate((size_t)scene->body_count, sizeof *bodies);
  if (bodies == NULL) return CT_NO_MEMORY(error, "the bodies");
  for (int32_t i = 0; i < scene->body_count; i++) {
    bodies[i] = (ct_solid_body){.mesh = scene->parts[i].mesh,
                                .material = scene->bodies[i].material,
                                .materials = scene->bodies[i].materials,
                                .kernel = is_rigid(scene, i) ? CT_KERNEL_RIGID
                                                             : scene->parts[i].given.kernel,
                                .first_node = scene->bodies[i].first_node,
                                .lumping = scene->parts[i].given.lumping,
                                .optimisations = &scene->optimisations,
                                .hourglass = scene->parts[i].given.hourglass};
    for (int axis = 0; axis < 3; axis++) bodies[i].fixed[axis] = body_is_fixed(scene, i, axis);
  }
  ct_solid_def def = ct_solid_def_default();
  def.bodies = bodies;
  def.body_count = scene->body_count;
  ct_status status = ct_solid_create_checked(&def, &scene->effects[0], error);
  ct_release(bodies);
  return status;
}

/* Create the damping in proportion to stiffness, if any body has it. */
static ct_status make_stiffness_damping(ct_scene *scene, ct_effect **effect, ct_error *error)
{
  double *coefficients = ct_allocate((size_t)scene->body_count, sizeof *coefficients), most = 0.0;
  if (coefficients == NULL) return CT_NO_MEMORY(error, "the damping");
  for (int32_t i = 0; i < scene->body_count; i++) {
    coefficients[i] = is_rigid(scene, i) ? 0.0 : scene->parts[i].given.stiffness_damping;
    most = fmax(most, coefficients[i]);
  }
  ct_stiffness_damping_def def = ct_stiffness_damping_def_default();
  def.solid = scene->effects[0];
  def.coefficients = coefficients;
  ct_status status =
      most > 0.0 ? ct_stiffness_damping_create_effect(&def, &scene->problem, effect, error) : CT_OK;
  ct_release(coefficients);
  return status;
}

/* Create the forces of initial stress, if any body has one. */
static ct_status make_initial_stress(ct_scene *scene, ct_effect **effect, ct_error *error)
{
  ct_initial_stress_def def = ct_initial_stress_def_default();
  def.solid = scene->effects[0];
  for (int32_t i = 0; i < scene->body_count; i++)
    for (int k = 0; k < 6; k++)
      if (scene->bodies[i].initial_stress[k] != 0.0)
        return ct_initial_stress_create_effect(&def, &scene->problem, effect, error);
  return CT_OK;
}

/* The shortest edge and the smallest constants among the materials of a contact's surfaces: E, ρ
 * c₁² and ρ. */
typedef struct softest {
  double edge, young, modulus, density;
} softest;

static void take_material(const ct_material *material, softest *s)
{
  double c1, c2;
  ct_material_speeds(material, &c1, &c2);
  s->young = fmin(s->young, material->young);
  s->modulus = fmin(s->modulus, material->density * c1 * c1);
  s->density = fmin(s->density, material->density);
}

/* Take the materials behind the faces of surface `s` of a contact, unless its body is rigid and the
 * other one is not (eq:rigid-penalty). */
static ct_status take_surface(const ct_scene *scene, const scene_contact *entry, int s,
                              softest *out, ct_error *error)
{
  const ct_body *body = &scene->bodies[entry->body[s]];
  if (is_rigid(scene, entry->body[s]) && !is_rigid(scene, entry->body[1 - s])) return CT_OK;
  const int32_t count = entry->face_count[s],
                entries = count * ct_face_node_count(ct_brick_face_kind(body->mesh->kind));
  out->edge = fmin(out->edge, ct_mesh_shortest_edge(body->mesh));
  if (body->materials == NULL) take_material(&body->material, out);
  if (body->materials == NULL) return CT_OK;
  int32_t *own = ct_allocate((size_t)entries, sizeof *own),
          *owner = ct_allocate((size_t)count, sizeof *owner);
  ct_status status = own != NULL && owner != NULL ? CT_OK : CT_NO_MEMORY(error, "a contact");
  for (int32_t i = 0; status == CT_OK && i < entries; i++)
    own[i] = entry->faces[s][i] - body->first_node;
  if (status == CT_OK) status = ct_mesh_face_owners(body->mesh, count, own, owner, error);
  for (int32_t f = 0; status == CT_OK && f < count; f++)
    if (owner[f] >= 0) take_material(&body->materials[owner[f]], out);
  ct_release(own);
  ct_release(owner);
  return status;
}

/* The default penalty of an enforcement (eq:penalty-default). */
static double usual_penalty(const softest *soft, ct_enforcement enforcement)
{
  return ct_contact_penalty_default(enforcement, soft->modulus, soft->edge);
}

/* The time in which a wave of the speed √(M / ρ) crosses the shortest edge, with the smaller
 * modulus and the smaller density of the two bodies (eq:travel-time). */
static double travel_time(const softest *soft)
{
  // -- T = h √(ρ / (ρ c₁²)) of the node and spring that swing fastest (eq:travel-time)
  return soft->edge * sqrt(soft->density / soft->modulus);
}

/* ε = β E / h with the smaller modulus and the shorter edge of the two bodies (eq:penalty-factor),
 * or the default. */
static double penalty_of(const ct_scene_contact *contact, const softest *soft)
{
  if (contact->options.epsilon > 0.0) return contact->options.epsilon;
  if (!(contact->beta > 0.0)) return usual_penalty(soft, contact->options.enforcement);
  return ct_contact_penalty(contact->beta, soft->young, soft->edge);
}

/* Make a contact and its friction. */
static ct_status make_contact(ct_scene *scene, scene_contact *entry, ct_error *error)
{
  int32_t *next = &scene->problem.effect_count;
  ct_surface surface[2];
  for (int s = 0; s < 2; s++)
    surface[s] = (ct_surface){.kind = ct_brick_face_kind(scene->parts[entry->body[s]].mesh->kind),
                              .node_count = scene->problem.node_count,
                              .face_count = entry->face_count[s],
                              .faces = entry->faces[s],
                              .reference = scene->reference};
  // The same faces twice: the contact of a surface with itself.
  size_t bytes =
      (size_t)entry->face_count[0] * (size_t)ct_face_node_count(surface[0].kind) * sizeof(int32_t);
  int self = entry->body[0] == entry->body[1] && entry->face_count[0] == entry->face_count[1] &&
             memcmp(entry->faces[0], entry->faces[1], bytes) == 0;
  ct_contact_def def = ct_contact_def_default();
  def.a = &surface[0];
  def.b = &surface[self ? 0 : 1];
  def.options = entry->given.options;
  softest soft = {INFINITY, INFINITY, INFINITY, INFINITY};
  ct_status status = take_surface(scene, entry, 0, &soft, error);
  if (status == CT_OK) status = take_surface(scene, entry, 1, &soft, error);
  if (status != CT_OK) return status;
  def.options.epsilon = entry->epsilon = penalty_of(&entry->given, &soft);
  if (def.options.travel_time == 0.0) def.options.travel_time = travel_time(&soft);
  status = ct_contact_create_effect(&def, &scene->problem, &scene->effects[*next], error);
  // Surface 0 or 1 of the contact is one of our bodies.
  if (status != CT_OK && error != NULL && (error->body == 0 || error->body == 1))
    error->body = entry->body[error->body];
  if (status == CT_OK) (*next)++;
  if (status != CT_OK || entry->given.friction == 0.0) return status;
  ct_friction_def friction = ct_friction_def_default();
  friction.on = scene->effects[*next - 1];
  friction.coefficient = entry->given.friction;
  // -- A tenth of the normal stiffness by default if a body deforms: half the rounds (eq:slip-law)
  const int deforms = !is_rigid(scene, entry->body[0]) || !is_rigid(scene, entry->body[1]);
  const double usual = deforms ? usual_penalty(&soft, CT_ENFORCE_PENALTY) : INFINITY;
  friction.tangent =
      entry->given.tangent != 0.0 ? entry->given.tangent : fmin(1.0, usual / entry->epsilon);
  status = ct_friction_create_effect(&friction, &scene->problem, &scene->effects[*next], error);
  if (status == CT_OK) (*next)++;
  return status;
}

static ct_status make_supports(ct_scene *scene, ct_effect **effect, ct_error *error)
{
  ct_support_def def = ct_support_def_default();
  def.supports = scene->supports;
  def.support_count = scene->support_count;
  if (def.support_count == 0) return CT_OK;
  ct_status status = ct_support_create_effect(&def, &scene->problem, effect, error);
  return status == CT_OK ? ct_support_apply(*effect, scene->inverse_mass, scene->velocity, error)
                         : status;
}

static ct_status make_effects(ct_scene *scene, ct_error *error)
{
  int32_t *count = &scene->problem.effect_count;
  ct_effect *supports = NULL, *hourglass = NULL, *damping = NULL, *stress = NULL;
  scene->effects = ct_allocate(2 * (size_t)scene->contact_count + (size_t)scene->added_count + 5,
                               sizeof *scene->effects);
  if (scene->effects == NULL) return CT_NO_MEMORY(error, "the effects");
  // The kernels depend on the supports, so these are created first; they are the last effects.
  ct_status status = make_supports(scene, &supports, error);
  if (status == CT_OK) status = make_solid(scene, error);
  if (status == CT_OK) (*count)++;
  if (status == CT_OK) status = ct_solid_create_hourglass(scene->effects[0], &hourglass, error);
  if (hourglass != NULL) scene->effects[(*count)++] = hourglass;
  if (status == CT_OK) status = make_stiffness_damping(scene, &damping, error);
  if (damping != NULL) scene->effects[(*count)++] = damping;
  if (status == CT_OK) status = make_initial_stress(scene, &stress, error);
  if (stress != NULL) scene->effects[(*count)++] = stress;
  for (int32_t i = 0; status == CT_OK && i < scene->contact_count; i++)
    status = ct_blame(error, make_contact(scene, &scene->contacts[i], error), CT_PART_CONTACT, i);
  for (int32_t i = 0; status == CT_OK && i < scene->added_count; i++)
    scene->effects[(*count)++] = scene->added[i];
  if (supports != NULL) scene->effects[(*count)++] = supports;
  scene->problem.effects = (const ct_effect *const *)scene->effects;
  return status;
}

/* The requested time step, before it is fitted to the end. */
static ct_status requested_step(const ct_scene_time *time, const ct_stable_step *stable, double *dt,
                                ct_error *error)
{
  int given = (time->courant > 0.0) + (time->fraction > 0.0) + (time->dt > 0.0);
  if (!(time->end > 0.0) || !isfinite(time->end))
    return CT_REFUSE(error, "time: end must be positive and finite, not %g", time->end);
  if (given != 1)
    return CT_REFUSE(error, "time: give exactly one of courant, fraction and dt, not %d of them",
                     given);
  *dt = time->courant > 0.0    ? time->courant * stable->dt_courant
        : time->fraction > 0.0 ? time->fraction * stable->dt
                               : time->dt;
  if (!(*dt <= stable->dt * (1.0 + 1e-12)))
    return ct_fail(
        error, CT_ERROR_STEP, CT_NOWHERE,
        "time step %g (Courant number %g) is above the stable step %g (Courant number %g)", *dt,
        *dt / stable->dt_courant, stable->dt, stable->dt / stable->dt_courant);
  if (isinf(*dt))
    return CT_REFUSE(error, "time: the stable step is infinite, so it has no fraction; give dt");
  if (!(time->end / *dt < 9e15))
    return CT_REFUSE(error, "time: the end is %g steps away; at most 9e15 can be counted",
                     time->end / *dt);
  return CT_OK;
}

/* Create the problem up to its time step, and a state of it at t = 0, which gives the stable step.
 */
static ct_status begin_problem(ct_scene *scene, const ct_scene_time *time, ct_stable_step *stable,
                               double *dt, ct_state **begun, ct_error *error)
{
  ct_problem *p = &scene->problem;
  const ct_problem *joined;
  ct_status status = ct_scene_join(scene, &joined, error);
  for (int32_t i = 0; status == CT_OK && !scene->unchanged && i < scene->body_count; i++)
    status = start_body(scene, i, error);
  scene->unchanged = 0;
  if (status == CT_OK) status = make_effects(scene, error);
  p->integrator = time->integrator;
  p->assembled = time->assembled;
  p->force_tolerance = time->force_tolerance;
  p->dt = DBL_MIN; // unknown yet, and any value will do
  if (begun == NULL) stable->dt = stable->dt_courant = INFINITY;
  else if (status == CT_OK) status = ct_state_begin(p, begun, error);
  if (status == CT_OK && begun != NULL) status = ct_stable(p, *begun, stable, error);
  return status == CT_OK ? ct_blame(error, requested_step(time, stable, dt, error), CT_PART_TIME, 0)
                         : status;
}

ct_status ct_scene_start(ct_scene *scene, const ct_scene_time *time, const ct_problem **problem,
                         int64_t *step_count, ct_stable_step *stable, ct_state **state,
                         ct_error *error)
{
  if (scene == NULL || time == NULL || problem == NULL || step_count == NULL)
    return CT_REFUSE_NULL(error);
  ct_problem *p = &scene->problem;
  double dt = 0.0;
  int64_t count = 0;
  ct_state *begun = NULL;
  ct_stable_step own;
  // A step of a run that began elsewhere needs no check, and so no state.
  const int known = time->keep_dt && time->dt > 0.0 && stable == NULL && state == NULL;
  if (stable == NULL) stable = &own;
  unbuild(scene);
  ct_status status = begin_problem(scene, time, stable, &dt, known ? NULL : &begun, error);
  if (status == CT_OK) {
    // -- The largest step not above the asked one that ends where the scene ends (eq:whole-steps)
    count = (int64_t)ceil(time->end / dt * (1.0 - 1e-9));
    p->dt = time->keep_dt && time->dt > 0.0 ? time->dt : time->end / (double)count;
    if (state != NULL) status = ct_state_finish(p, begun, error);
  }
  if (status == CT_OK && state != NULL) *state = begun;
  else ct_state_free(begun);
  if (status == CT_OK) *problem = p, *step_count = count;
  else unbuild(scene);
  return status;
}

ct_status ct_scene_build(ct_scene *scene, const ct_scene_time *time, const ct_problem **problem,
                         int64_t *step_count, ct_stable_step *stable, ct_error *error)
{
  return ct_scene_start(scene, time, problem, step_count, stable, NULL, error);
}

ct_status ct_scene_contact_epsilon(const ct_scene *scene, int32_t contact, double *epsilon,
                                   ct_error *error)
{
  if (scene == NULL || epsilon == NULL) return CT_REFUSE_NULL(error);
  if (contact < 0 || contact >= scene->contact_count)
    return CT_REFUSE(error, "scene: there is no contact %d", (int)contact);
  *epsilon = scene->contacts[contact].epsilon;
  return CT_OK;
}
