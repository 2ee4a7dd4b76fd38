/* The host of 05_host.c in two pieces, each with half of the faces: two threads stand for two
 * processes. Both get the bits of one contact that has all faces. */
#include <libcontact/contact.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { NODES = 6, ALL = 3 * NODES, FACES = 2, STEPS = 400 };
static const double X[ALL] = {0, 0, 0, 0.5, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 1, 0, 1, 1, 0},
                    GROUND[ALL] = {-3, -3, 0, 0, -3, 0, 3, -3, 0, -3, 3, 0, 0, 3, 0, 3, 3, 0};
static const int32_t DOWN[4 * FACES] = {0, 3, 4, 1, 1, 4, 5, 2},
                              UP[4 * FACES] = {0, 1, 4, 3, 1, 2, 5, 4};

/* The first piece that comes waits, the second one writes the sums, or the largest, for both. In
 * processes this is MPI_Allreduce with MPI_SUM and MPI_MAX. */
static pthread_mutex_t door = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t met = PTHREAD_COND_INITIALIZER;
static double *waiting;

static int combine(double *values, int64_t count, int is_sum)
{
  pthread_mutex_lock(&door);
  if (waiting == NULL)
    for (waiting = values; waiting == values;) pthread_cond_wait(&met, &door);
  else {
    for (int64_t i = 0; i < count; i++)
      waiting[i] = values[i] = is_sum                   ? waiting[i] + values[i]
                               : waiting[i] > values[i] ? waiting[i]
                                                        : values[i];
    waiting = NULL;
    pthread_cond_signal(&met);
  }
  pthread_mutex_unlock(&door);
  return 0;
}

static int sum(void *data, double *values, int64_t count)
{
  return (void)data, combine(values, count, 1);
}
static int largest(void *data, double *values, int64_t count)
{
  return (void)data, combine(values, count, 0);
}

/* A run of the host: all of it, or piece 0 or 1. */
typedef struct run {
  int piece; /* -1: all faces */
  int failed;
  double x[ALL], f[ALL]; /* at the end */
  ct_error e;
} run;

static ct_contact *open_contact(run *r)
{
  const ct_surface a = {CT_Q4, NODES, FACES, DOWN, X}, b = {CT_Q4, NODES, FACES, UP, GROUND};
  const uint8_t owned[FACES] = {r->piece == 0, r->piece == 1};
  const ct_pieces pieces = {NULL, sum, largest};
  ct_contact_options options = ct_contact_options_default();
  const double corner[3] = {2, 0, 0}, left[3] = {-1, 0, 0};
  ct_obstacle_def wall = ct_obstacle_def_plane(corner, left); /* x = 2 */
  ct_contact *contact = NULL;
  options.epsilon = wall.epsilon = 4000.0;
  options.travel_time = wall.travel_time = 0.14; /* h / c1 of masses 1 and springs 100 */
  r->failed =
      ct_contact_create(&a, &b, &options, &contact, &r->e) != CT_OK ||
      ct_contact_add_obstacle(contact, 0, &wall, &r->e) != CT_OK ||
      ct_contact_add_friction(contact, -1, 0.2, 1.0, &r->e) != CT_OK ||
      (r->piece >= 0 && ct_contact_set_pieces(contact, owned, owned, &pieces, &r->e) != CT_OK);
  return contact;
}

/* Every piece has all nodes of the surfaces and moves them; a distributed host would exchange those
 * of the others. */
static void *slide(void *user)
{
  run *r = user;
  const double no_motion[ALL] = {0}, dt = 0.01;
  double v[ALL], inverse_mass[ALL], g[ALL];
  ct_contact *contact = open_contact(r);
  memcpy(r->x, X, sizeof X);
  for (int d = 0; d < ALL; d++) v[d] = d % 3 == 0, inverse_mass[d] = 1.0;
  for (int step = 0; step <= STEPS && !r->failed; step++) {
    memset(g, 0, sizeof g);
    for (int d = 0; d < ALL; d++) r->f[d] = d % 3 == 2 ? -1.0 : 0.0; /* weight */
    for (int n = 0; n < NODES; n++) {                                /* springs along x */
      double spring = n % 3 == 2 ? 0.0 : 100.0 * (r->x[3 * n + 3] - r->x[3 * n] - 0.5);
      r->f[3 * n] += spring;
      if (n % 3 < 2) r->f[3 * n + 3] -= spring;
    }
    ct_contact_prediction p = {
        .x_a = r->x, .x_b = GROUND, .dt = dt, .force_time = step ? dt : dt / 2};
    p.velocity_a = v, p.velocity_b = no_motion, p.force_a = r->f;
    p.inverse_mass_a = inverse_mass, p.inverse_mass_b = no_motion;
    r->failed = ct_contact_step(contact, &p, &r->e) != CT_OK ||
                ct_contact_add_force(contact, r->f, g, &r->e) != CT_OK;
    for (int d = 0; d < ALL; d++) v[d] += p.force_time * r->f[d], r->x[d] += dt * v[d];
  }
  ct_contact_free(contact);
  return NULL;
}

int main(void)
{
  run whole = {.piece = -1}, half[2] = {{.piece = 0}, {.piece = 1}};
  pthread_t thread;
  slide(&whole);
  if (pthread_create(&thread, NULL, slide, &half[1]) != 0) return 1;
  slide(&half[0]);
  pthread_join(thread, NULL);
  for (int k = 0; k < 2; k++) {
    const run *h = &half[k];
    if (h->failed) puts(h->e.text);
    printf("piece %d: x = %.3f after %d steps, %s bits of the whole\n", k, h->x[6], STEPS,
           memcmp(h->x, whole.x, sizeof h->x) == 0 && memcmp(h->f, whole.f, sizeof h->f) == 0
               ? "the"
               : "not the");
  }
  return whole.failed || half[0].failed || half[1].failed;
}
