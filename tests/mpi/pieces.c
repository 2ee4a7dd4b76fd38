/* Two blocks in contact with friction, on the processes of MPI: prints a hash of the whole state.
 * The same on any number of processes: mpirun -n N pieces STEPS. */
#include <libcontact.h>
#include <libcontact/mpi.h>

#include <stdio.h>
#include <stdlib.h>

static void need(ct_status status, const ct_error *error)
{
  if (status == CT_OK) return;
  fprintf(stderr, "%s\n", error->text);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

/* FNV-1a. */
static unsigned long long hash(unsigned long long h, const void *data, size_t bytes)
{
  const unsigned char *c = data;
  for (size_t i = 0; i < bytes; i++) h = (h ^ c[i]) * 1099511628211ull;
  return h;
}

static ct_scene *scene_of(void)
{
  ct_scene *scene;
  ct_error e;
  const ct_material material = {.young = 900.0, .poisson = 0.3, .density = 1.0};
  need(ct_scene_create(&scene, &e), &e);
  for (int i = 0; i < 2; i++) {
    ct_scene_body body = {.name = i == 0 ? "lower" : "upper",
                          .box = {.origin = {0.1 * i, 0.0, i == 0 ? -0.5 : 0.001},
                                  .size = {i == 0 ? 2.0 : 1.0, 1.0, 0.5},
                                  .cells = {i == 0 ? 14 : 9, 8, 4}},
                          .material = material,
                          .velocity = {0.3 * i, 0.0, -0.5 * i}};
    need(ct_scene_add_body(scene, &body, NULL, &e), &e);
  }
  ct_scene_contact contact = {.body_b = 1,
                              .options = ct_contact_options_default(),
                              .friction = 0.3,
                              .side_a = CT_Z_MAX,
                              .side_b = CT_Z_MIN};
  need(ct_scene_add_contact(scene, &contact, &e), &e);
  return scene;
}

/* The hash of a state and its energies. */
static void print_hash(const ct_problem *problem, ct_state *whole)
{
  ct_energy energy;
  ct_error e;
  need(ct_energy_of(problem, whole, &energy, &e), &e);
  unsigned long long h = 1469598103934665603ull;
  const size_t bytes = 3 * (size_t)problem->node_count * sizeof(double);
  h = hash(h, whole->displacement, bytes);
  h = hash(h, whole->velocity, bytes);
  h = hash(h, whole->memory, (size_t)whole->memory_count * sizeof(double));
  h = hash(h, &energy, sizeof energy);
  printf("%016llx contact %.6g\n", h, energy.contact);
}

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  const int64_t steps = argc > 1 ? atoi(argv[1]) : 40;
  ct_error e;
  ct_scene *scene = scene_of();
  const ct_problem *problem;
  ct_scene_time time = {.end = 1.0, .fraction = 0.5, .keep_dt = 1};
  int64_t count;
  ct_state *whole = NULL, *piece;
  ct_piece_def def = ct_piece_def_default();
  ct_mpi *mpi;
  need(ct_mpi_create(MPI_COMM_WORLD, &def, &mpi, &e), &e);
  // The first process has a whole state; the others build the problem with its step.
  if (def.number == 0) {
    need(ct_scene_start(scene, &time, &problem, &count, NULL, &whole, &e), &e);
    time.dt = problem->dt;
  }
  MPI_Bcast(&time.dt, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  time.fraction = 0.0;
  if (whole == NULL) need(ct_scene_build(scene, &time, &problem, &count, NULL, &e), &e);
  int64_t elements = 0;
  for (int b = 0; b < problem->body_count; b++) elements += problem->bodies[b].mesh->element_count;
  int32_t *owners = calloc((size_t)elements, sizeof *owners);
  need(ct_piece_bisect(problem, def.count, NULL, owners, &e), &e);
  def.owners = owners;
  if (whole != NULL) need(ct_state_cut(whole, &def, &piece, &e), &e);
  else need(ct_state_receive(problem, &def, &piece, &e), &e);
  need(ct_run(problem, piece, steps, NULL, 0, &e), &e);
  need(ct_state_collect(piece, whole, &e), &e);
  if (whole != NULL) print_hash(problem, whole);
  ct_state_free(piece);
  ct_mpi_free(mpi);
  ct_state_free(whole);
  ct_scene_free(scene);
  free(owners);
  MPI_Finalize();
  return 0;
}
