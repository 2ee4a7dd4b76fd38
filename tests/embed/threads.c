/* A host with threads of its own: each has a state of the one problem, and a monitor over it; all
 * must end with the same bits. Then all ask one const contact at once. For `make threads`. */
#include <libcontact.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS = 4, STEPS = 60 };

typedef struct job {
  const ct_problem *problem;
  ct_state *state;
  ct_status status;
  ct_error error;
} job;

static void *work(void *argument)
{
  job *j = argument;
  ct_monitor *monitor = NULL;
  ct_monitor_options options = ct_monitor_options_default();
  ct_energy energy;
  options.every = 8;
  j->status = ct_state_create(j->problem, &j->state, &j->error);
  if (j->status == CT_OK)
    j->status = ct_monitor_create(j->problem, j->state, &options, &monitor, &j->error);
  if (j->status == CT_OK)
    j->status = ct_run(j->state->problem, j->state, STEPS,
                       (ct_observer[]){ct_monitor_observer(monitor)}, 1, &j->error);
  if (j->status == CT_OK) j->status = ct_energy_of(j->problem, j->state, &energy, &j->error);
  ct_monitor_free(monitor);
  return NULL;
}

/* What all threads ask of one contact. */
typedef struct question {
  const ct_contact *contact;
  const double *mass;
  ct_status status;
  double answer[3];
} question;

static void *ask(void *argument)
{
  question *q = argument;
  ct_penetration corners;
  q->answer[0] = ct_contact_energy(q->contact);
  q->status = ct_contact_update_stable_step(q->contact, q->mass, q->mass, &q->answer[1], NULL);
  if (q->status == CT_OK)
    q->status = ct_contact_penetration(q->contact, CT_AT_CORNERS, &corners, NULL);
  if (q->status == CT_OK) q->answer[2] = corners.deepest;
  return NULL;
}

static void need(ct_status status, const ct_error *error)
{
  if (status == CT_OK) return;
  fprintf(stderr, "%s: %s\n", ct_status_name(status), error->text);
  exit(1);
}

/* Two blocks of large deformation that collide with friction, under a certain enforcement. */
static ct_scene *make(ct_enforcement enforcement, const ct_problem **problem)
{
  static const ct_material soft = {2.0, 0.3, 1.0, CT_NEO_HOOKEAN};
  ct_scene *scene = NULL;
  ct_error e;
  int32_t faces[2][8 * 6 * 8];
  ct_scene_contact contact = {.body_a = 0,
                              .body_b = 1,
                              .beta = 1.0,
                              .options = ct_contact_options_default(),
                              .friction = 0.3};
  contact.options.enforcement = enforcement;
  need(ct_scene_create(&scene, &e), &e);
  for (int b = 0; b < 2; b++) {
    ct_box box = {
        .origin = {b == 0 ? -1.0 : 0.002, 0.1 * b, 0.0}, .size = {1, 1, 1}, .cells = {2, 2, 2}};
    double velocity[3] = {b == 0 ? 0.1 : -0.1, 0.01, 0.0};
    ct_mesh *mesh = NULL;
    need(ct_mesh_create_box(CT_HEX8, &box, &mesh, &e), &e);
    *(b == 0 ? &contact.face_count_a : &contact.face_count_b) =
        ct_mesh_plane_faces(mesh, 0, b == 0 ? 0.0 : 0.002, faces[b], NULL);
    ct_scene_body body = {.mesh = mesh, .material = soft};
    memcpy(body.velocity, velocity, sizeof velocity);
    need(ct_scene_add_body(scene, &body, NULL, &e), &e);
    ct_mesh_free(mesh);
  }
  contact.faces_a = faces[0], contact.faces_b = faces[1];
  need(ct_scene_add_contact(scene, &contact, &e), &e);
  ct_scene_time time = {.end = 10.0, .fraction = 0.5};
  ct_stable_step stable;
  int64_t steps;
  need(ct_scene_build(scene, &time, problem, &steps, &stable, &e), &e);
  return scene;
}

/* Ask the contact of a state from all threads; whether an answer differs. */
static int ask_together(const ct_problem *problem, ct_state *state)
{
  question asked[THREADS];
  pthread_t threads[THREADS];
  ct_error error;
  int32_t k = 0;
  int wrong = 0;
  while (k + 1 < problem->effect_count && problem->effects[k]->kind != CT_EFFECT_CONTACT) k++;
  const ct_contact *contact = ct_state_contact(problem, state, k, &error);
  need(contact == NULL ? CT_ERROR_ARGUMENT : CT_OK, &error);
  memset(asked, 0, sizeof asked);
  for (int i = 0; i < THREADS; i++) {
    asked[i].contact = contact;
    asked[i].mass = problem->mass;
    if (pthread_create(&threads[i], NULL, ask, &asked[i]) != 0) exit(1);
  }
  for (int i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
  for (int i = 0; i < THREADS; i++)
    wrong += asked[i].status != CT_OK ||
             memcmp(asked[i].answer, asked[0].answer, sizeof asked[0].answer) != 0;
  return wrong;
}

int main(void)
{
  int wrong = 0;
  for (int enforcement = 0; enforcement < CT_ENFORCE_COUNT; enforcement++) {
    const ct_problem *problem = NULL;
    ct_scene *scene = make((ct_enforcement)enforcement, &problem);
    job jobs[THREADS];
    pthread_t threads[THREADS];
    memset(jobs, 0, sizeof jobs);
    for (int i = 0; i < THREADS; i++) {
      jobs[i].problem = problem;
      if (pthread_create(&threads[i], NULL, work, &jobs[i]) != 0) return 1;
    }
    for (int i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
    for (int i = 0; i < THREADS; i++) {
      need(jobs[i].status, &jobs[i].error);
      size_t bytes = 3 * (size_t)problem->node_count * sizeof(double);
      wrong += memcmp(jobs[i].state->displacement, jobs[0].state->displacement, bytes) != 0 ||
               memcmp(jobs[i].state->velocity, jobs[0].state->velocity, bytes) != 0;
    }
    wrong += ask_together(problem, jobs[0].state);
    for (int i = 0; i < THREADS; i++) ct_state_free(jobs[i].state);
    ct_scene_free(scene);
    printf("enforcement %d: %d threads, %d steps each: %s\n", enforcement, THREADS, STEPS,
           wrong ? "OTHER BITS" : "the same bits");
  }
  return wrong != 0;
}
