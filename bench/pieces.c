/* Two blocks of n^3 elements that hit each other, in pieces that are threads: for callgrind. The
 * arguments are n, the number of pieces, whether there is contact, the coefficient of friction and
 * the number of steps. */
#include "../tests/c/hosts.h"
#include "../tests/c/meeting.h"

typedef struct job {
  pthread_t thread;
  seat at;
  const ct_state *start;
  const int32_t *owners;
  int64_t steps;
  ct_piece_counts counts;
} job;

static void *work(void *user)
{
  job *own = user;
  ct_error e;
  ct_state *piece;
  ct_piece_def def = ct_piece_def_default();
  def.number = own->at.number, def.count = own->at.with->pieces;
  def.owners = own->owners;
  def.join = (ct_pieces){&own->at, add, take_largest};
  def.exchange = hand_over;
  need(ct_state_cut(own->start, &def, &piece, &e), &e);
  need(ct_run(own->start->problem, piece, own->steps, NULL, 0, &e), &e);
  need(ct_piece_counts_of(piece, &own->counts, &e), &e);
  ct_state_free(piece);
  return NULL;
}

int main(int argc, char **argv)
{
  if (argc < 6) return 1;
  const int n = atoi(argv[1]), pieces = atoi(argv[2]), contact = atoi(argv[3]);
  const ct_material material = {.young = 900.0, .poisson = 0.3, .density = 1.0};
  ct_mesh *low = box_mesh(CT_HEX8, 0, 0, -1, 1, 1, 1, n, n, n),
          *high = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, n, n, n);
  ct_scene *scene = new_scene();
  add_body(scene, "low", low, &material, CT_KERNEL_AUTO, 0, 0, 0.5);
  add_body(scene, "high", high, &material, CT_KERNEL_AUTO, 0, 0, -0.5);
  if (contact)
    add_contact_with(scene, 0, low, 0.0, 1, high, 0.0, 2, 0.0, ct_contact_options_default(),
                     atof(argv[4]), 0.0);
  const ct_problem *problem =
      build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.8}, NULL, NULL);
  ct_state *start = new_state(problem);
  int32_t *owners = integers(2 * n * n * n);
  ct_error e;
  need(ct_piece_bisect(problem, pieces, NULL, owners, &e), &e);
  meeting with = MEETING(pieces);
  job of[MOST_SEATS];
  for (int k = 0; k < pieces; k++)
    of[k] = (job){.at = {&with, k}, .start = start, .owners = owners, .steps = atoi(argv[5])};
  for (int k = 0; k < pieces; k++) pthread_create(&of[k].thread, NULL, work, &of[k]);
  for (int k = 0; k < pieces; k++) pthread_join(of[k].thread, NULL);
  int64_t elements = 0, received = 0;
  for (int k = 0; k < pieces; k++) {
    const ct_piece_counts *own = &of[k].counts;
    elements = own->elements > elements ? own->elements : elements;
    received = own->received > received ? own->received : received;
  }
  const ct_piece_counts *c = &of[0].counts;
  printf("%lld %lld %lld %lld %lld\n", (long long)c->joins, (long long)c->joined,
         (long long)c->exchanges, (long long)elements, (long long)received);
  free(owners);
  free(with.total);
  ct_mesh_free(high);
  close_run(start, scene, low);
  return 0;
}
