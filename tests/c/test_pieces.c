/* A contact in pieces, each computed by a thread with the arrays of a host of its own: the bits of
 * one contact that has all faces. */
#include "hosts.h"
#include "meeting.h"

enum { MOST_PIECES = 3 };

/* One piece: its host, its faces, and what it got. */
typedef struct piece {
  pthread_t thread;
  host h;
  seat at;
  uint8_t *owned[2];
  int64_t steps;
  int bad; /* the step from which on it passes NaN; -1: none */
  ct_status status;
  ct_contact_balance balance;
  double reaction[3], work, dt[2], *traction;
  ct_error error;
} piece;

/* What is asked after the last step: a stable step, forces and tractions. */
static void ask(piece *q)
{
  const pair *p = q->h.p;
  double *mass[2];
  for (int i = 0; i < p->bodies; i++) {
    mass[i] = numbers(p->mesh[i]->node_count);
    for (int n = 0; n < p->mesh[i]->node_count; n++) mass[i][n] = q->h.mass[i][3 * n];
  }
  must(ct_contact_update_stable_step, q->h.contact, mass[0], mass[p->bodies - 1], &q->dt[0]);
  must(ct_contact_stable_step, q->h.contact, mass[0], mass[p->bodies - 1], &q->dt[1]);
  must(ct_contact_balance_of, q->h.contact, &q->balance);
  if (p->obstacles > 0) must(ct_contact_reaction, q->h.contact, 0, q->reaction, &q->work);
  q->traction = numbers(4 * p->mesh[0]->node_count);
  must(ct_contact_traction, q->h.contact, p->obstacles > 0 ? 2 + (p->side[0] != 0) : 0, q->traction,
       q->traction + 3 * p->mesh[0]->node_count);
  for (int i = 0; i < p->bodies; i++) free(mass[i]);
}

static void *run_piece(void *user)
{
  piece *q = user;
  const ct_pieces pieces = {&q->at, add, take_largest};
  q->status = CT_OK;
  if (q->at.with != NULL)
    q->status = ct_contact_set_pieces(q->h.contact, q->owned[0], q->owned[1], &pieces, &q->error);
  for (int64_t n = 0; q->status == CT_OK && n < q->steps; n++) {
    if (n == q->bad) q->h.v[0][3 * q->h.p->faces[0][0]] = NAN;
    q->status = try_host(&q->h, n, &q->error, NULL);
  }
  if (q->status == CT_OK) ask(q);
  return NULL;
}

/* How faces are given to pieces: in two halves, at random, all to the last piece. */
typedef enum cut { HALVES, RANDOM, LAST } cut;

static void open_pieces(piece *of, int count, const pair *p, const ct_contact_options *options,
                        cut how, int64_t steps, meeting *with)
{
  for (int k = 0; k < count; k++) {
    of[k] = (piece){.h = open_host(p, options, 0.9), .at = {with, k}, .steps = steps, .bad = -1};
    for (int s = 0; s < p->bodies; s++)
      of[k].owned[s] = calloc((size_t)p->face_count[s], sizeof *of[k].owned[s]);
  }
  for (int s = 0; s < p->bodies; s++)
    for (int f = 0; f < p->face_count[s]; f++) {
      int owner = how == HALVES ? count * f / p->face_count[s]
                  : how == LAST ? count - 1
                                : pick(count);
      of[owner].owned[s][f] = 1;
    }
}

static void run_pieces(piece *of, int count)
{
  for (int k = 0; k < count; k++)
    if (pthread_create(&of[k].thread, NULL, run_piece, &of[k]) != 0) abort();
  for (int k = 0; k < count; k++) pthread_join(of[k].thread, NULL);
}

static void close_pieces(piece *of, int count)
{
  for (int k = 0; k < count; k++) {
    close_host(&of[k].h);
    free_all(of[k].owned[0], of[k].owned[1], of[k].traction);
  }
}

/* Whether a piece has got the bits of the whole. */
static int is_alike(const piece *one, const piece *whole)
{
  const ct_contact_balance *a = &one->balance, *b = &whole->balance;
  return one->status == CT_OK && same_host(&one->h, &whole->h) && a->energy == b->energy &&
         a->work == b->work && a->removal == b->removal && a->friction == b->friction &&
         a->motion == b->motion && a->unconverged == b->unconverged && a->late == b->late &&
         a->late_depth == b->late_depth && one->dt[0] == whole->dt[0] &&
         one->dt[1] == whole->dt[1] && one->work == whole->work &&
         memcmp(one->reaction, whole->reaction, sizeof one->reaction) == 0 &&
         memcmp(one->traction, whole->traction,
                4 * (size_t)whole->h.p->mesh[0]->node_count * sizeof(double)) == 0;
}

/* Places, velocities and forces of whole runs in pieces have the bits of one contact.
 * (eq:order-free-sum) */
static void same_bits(pair p, const char *name, ct_enforcement enforcement, double end)
{
  ct_contact_options options = options_of(&p, enforcement == CT_ENFORCE_PENALTY ? 1.0 : 40.0);
  options.enforcement = enforcement;
  piece whole, of[MOST_PIECES];
  open_pieces(&whole, 1, &p, &options, HALVES, 0, NULL);
  whole.steps = (int64_t)(end / whole.h.dt) + 1;
  run_piece(&whole);
  int alike = 0, runs = 0;
  double calls = 0.0;
  for (int how = HALVES; how <= LAST; how++) {
    const int count = how == RANDOM ? MOST_PIECES : 2;
    meeting with = MEETING(count);
    open_pieces(of, count, &p, &options, (cut)how, whole.steps, &with);
    run_pieces(of, count);
    for (int k = 0; k < count; k++, runs++) alike += is_alike(&of[k], &whole);
    calls = (double)with.calls / (double)whole.steps;
    close_pieces(of, count);
    free(with.total);
  }
  tap_ok(
      whole.status == CT_OK && alike == runs && whole.balance.work != 0.0,
      "%s: %d steps in two and three pieces, %d of %d with the bits of the whole, %.0f exchanges a "
      "step",
      name, (int)whole.steps, alike, runs, calls);
  close_pieces(&whole, 1);
  free_pair(&p);
}

/* The same with a fast sphere, so that all points together would store more than the bodies have
 * given. (eq:admitted-store) */
static pair pressed(void)
{
  pair p = pierced();
  p.wall[1].radius = 0.3, p.wall[1].point[2] = 1.305;
  p.wall[1].velocity[0] = 4.0, p.wall[1].velocity[2] = -8.0;
  return p;
}

/* A piece that fails ends the step of all of them. */
static void one_fails(void)
{
  pair p = rods(0.0);
  const ct_contact_options options = options_of(&p, 40.0);
  meeting with = MEETING(2);
  piece of[2];
  open_pieces(of, 2, &p, &options, HALVES, 20, &with);
  of[1].bad = 10;
  run_pieces(of, 2);
  tap_ok(of[1].status == CT_INVALID && of[0].status == CT_INVALID &&
             strstr(of[0].error.text, "another piece") != NULL,
         "NaN in one piece: %s; and the other: %s", of[1].error.text, of[0].error.text);
  close_pieces(of, 2);
  free(with.total);
  free_pair(&p);
}

static int refuse(void *data, double *values, int64_t count)
{
  (void)data, (void)values, (void)count;
  return 1;
}

static int keep(void *data, double *values, int64_t count)
{
  (void)data, (void)values, (void)count;
  return 0;
}

/* Masks with a gap or an overlap, and missing functions. */
static void refusals(void)
{
  pair p = rods(0.0);
  const ct_contact_options options = options_of(&p, 40.0);
  piece q;
  open_pieces(&q, 1, &p, &options, HALVES, 1, NULL);
  ct_pieces pieces = {NULL, keep, keep}, none = {NULL, NULL, keep};
  ct_contact *contact = q.h.contact;
  ct_error e = {0};
  tap_ok(ct_contact_set_pieces(NULL, q.owned[0], q.owned[1], &pieces, NULL) == CT_ERROR_ARGUMENT &&
             ct_contact_set_pieces(contact, NULL, q.owned[1], &pieces, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_set_pieces(contact, q.owned[0], NULL, &pieces, &e) == CT_ERROR_ARGUMENT &&
             ct_contact_set_pieces(contact, q.owned[0], q.owned[1], NULL, &e) ==
                 CT_ERROR_ARGUMENT &&
             ct_contact_set_pieces(contact, q.owned[0], q.owned[1], &none, &e) == CT_ERROR_ARGUMENT,
         "null arguments: %s", e.text);
  q.owned[1][0] = 0;
  tap_ok(ct_contact_set_pieces(contact, q.owned[0], q.owned[1], &pieces, &e) == CT_ERROR_ARGUMENT &&
             e.body == 1 && e.element == 0,
         "a face without a piece: %s", e.text);
  q.owned[1][0] = 1;
  pieces.sum = refuse;
  tap_ok(ct_contact_set_pieces(contact, q.owned[0], q.owned[1], &pieces, &e) ==
             CT_ERROR_UNSUPPORTED,
         "numbers that can't be added: %s", e.text);
  pieces.sum = keep;
  must(ct_contact_set_pieces, contact, q.owned[0], q.owned[1], &pieces);
  tap_ok(ct_contact_set_pieces(contact, q.owned[0], q.owned[1], &pieces, &e) == CT_ERROR_ARGUMENT,
         "twice: %s", e.text);
  need(try_host(&q.h, 0, &e, NULL), &e);
  close_pieces(&q, 1);
  open_pieces(&q, 1, &p, &options, HALVES, 1, NULL);
  pieces.largest = refuse;
  must(ct_contact_set_pieces, q.h.contact, q.owned[0], q.owned[1], &pieces);
  tap_ok(try_host(&q.h, 0, &e, NULL) == CT_ERROR_UNSUPPORTED, "numbers that can't be compared: %s",
         e.text);
  close_pieces(&q, 1);
  open_pieces(&q, 1, &p, &options, HALVES, 1, NULL);
  need(try_host(&q.h, 0, &e, NULL), &e);
  tap_ok(ct_contact_set_pieces(q.h.contact, q.owned[0], q.owned[1], &pieces, &e) ==
             CT_ERROR_ARGUMENT,
         "after a step: %s", e.text);
  close_pieces(&q, 1);
  free_pair(&p);
}

int main(void)
{
  const ct_enforcement solved = CT_ENFORCE_ENERGY_CONTROLLED, given = CT_ENFORCE_PENALTY;
  same_bits(rods(0.05), "rods", solved, 0.9);
  same_bits(plates(0.05), "plates", solved, 2e-6);
  same_bits(rubbing(blocks(CT_HEX8, CT_HEX20, 0.005, 0.3), 0.3), "unlike blocks", solved, 0.06);
  same_bits(rubbing(blocks(CT_HEX8, CT_HEX8, 0.005, 0.3), 0.3), "explicit blocks", given, 0.1);
  same_bits(rubbing(strip(), 0.3), "a strip", solved, 0.1);
  same_bits(blocks(CT_HEX8, CT_HEX8, 0.02, 6.0), "sliding blocks", solved, 0.3);
  // Points of the upper block lose their partner while they press (eq:impact-left).
  same_bits(blocks(CT_HEX20, CT_HEX8, 0.01, -4.0), "a block over a border", solved, 0.3);
  same_bits(blocks(CT_HEX20, CT_HEX8, -0.01, 0.3), "an overlap", solved, 0.06);
  same_bits(thrown(0.01), "a block, a plane and a sphere", solved, 0.1);
  same_bits(pierced(), "a block, a plane and a small sphere", solved, 0.1);
  same_bits(pressed(), "a block and a fast small sphere", solved, 0.1);
  same_bits(sunk(CT_INITIAL_REMOVE), "a block inside a plane and a sphere", solved, 0.1);
  same_bits(squeezed(), "a block, a plane and a cylinder", solved, 0.1);
  same_bits(stacked(), "two blocks, a plane and a sphere", solved, 0.06);
  one_fails();
  refusals();
  return tap_done();
}
