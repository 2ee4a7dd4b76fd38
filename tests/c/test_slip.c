/* Friction at a point and in the constraint problem: the projection, a mass, random linear scenes,
 * a dense reference. The rows are included, so that each part can be called alone. */
#include "../../libcontact/src/constraint/law.h"
#include "../../libcontact/src/constraint/matrix.h"
#include "../../libcontact/src/constraint/tangent_lanes.c"
#include "../../libcontact/src/constraint/tangent_matrix.c"
#include "bodies.h"

/* The closest point of a disc cut by a half-plane, among many. (eq:slip-projection) */
static void projection(void)
{
  double off = 0.0, out = 0.0;
  for (int k = 0; k < 300; k++) {
    const double a = 3.14159265358979 * uniform(1.0), size = pow(10.0, uniform(1.0));
    ct_slip_set set = {.limit = pow(10.0, uniform(1.0)),
                       .most = k % 5 == 0 ? 0.0 : fabs(uniform(1.0))};
    if (k % 7 != 0) set.c[0] = cos(a), set.c[1] = sin(a);
    double T[3] = {size * uniform(3.0), size * uniform(3.0), 0.0}, P[3] = {T[0], T[1], 0.0};
    ct_slip_project(&set, P);
    const double own = hypot(P[0] - T[0], P[1] - T[1]);
    out = fmax(out, hypot(P[0], P[1]) / set.limit - 1.0);
    out = fmax(out, (ct_vector_dot(P, set.c) - set.most) / set.limit);
    for (int i = 0; i < 20000; i++) {
      const double r = set.limit * (i % 2 ? 1.0 : sqrt(fabs(uniform(1.0)))),
                   b = 3.14159265358979 * uniform(1.0);
      const double x[3] = {r * cos(b), r * sin(b), 0.0};
      if (ct_vector_dot(x, set.c) > set.most) continue;
      off = fmax(off, (own - hypot(x[0] - T[0], x[1] - T[1])) / (own + set.limit));
    }
  }
  tap_ok(off < 1e-14 && out < 1e-14, "a force is projected on the disc and its chord (%.1e, %.1e)",
         off, out);
}

enum { NODES = 9, ROWS = 6, DOFS = 3 * NODES };

/* One point with friction, its numbers in the order of slip.h. */
typedef struct point {
  double normal[3], k, e[3], before[3], force[3], reserve, stuck, image[3], opened, work, lag,
      lever[3], weight[8][3], sums[NODES][CT_SLIP_SUMS];
  ct_slips of;
  ct_slip slip;
} point;

static void open_point(point *p, const double normal[3], double mu)
{
  *p = (point){
      .slip.of = &p->of,
      .of = {.mu = mu, .stride = 1, .numbers = p->normal, .node_count = NODES, .sums = p->sums[0]}};
  memcpy(p->normal, normal, sizeof p->normal);
}

static double stored_of(const point *p)
{
  double stored;
  ct_slip_stored(&p->of, 1, &stored);
  return stored;
}

/* A linear scene: masses and springs, and rows with fixed entries. */
typedef struct linear {
  int rows;
  double mass[NODES], K[DOFS][DOFS], dt, load[DOFS];
  double own_shape[ROWS][4], other_shape[ROWS][4];
  int32_t own[ROWS][4], other[ROWS][4];
  ct_constraint row[ROWS];
  point slip[ROWS];
  ct_solver *s;
  double u[DOFS], last[DOFS], v[DOFS];
} linear;

static void random_unit(double n[3])
{
  double length = 0.0;
  for (int c = 0; c < 3; c++) n[c] = uniform(1.0);
  length = sqrt(ct_vector_dot(n, n));
  for (int c = 0; c < 3; c++) n[c] /= length;
}

static void open_solver(linear *t)
{
  const ct_row_set set = {t->rows, NODES, NULL, 8, t->rows, 0};
  int32_t place[NODES];
  ct_error e;
  need(ct_solver_create(&set, 1, NODES, place, &t->s), &e);
  t->s->fraction = 1.0;
  for (int j = 0; j < t->rows; j++) t->s->rows[j] = &t->row[j];
  t->s->first[1] = t->rows;
  for (int i = 0; i < NODES; i++)
    for (int c = 0; c < 3; c++) t->s->mobility[4 * i + c] = t->dt * t->dt / t->mass[i];
}

/* Springs between the nodes, and the stable step 2 / sqrt of their largest eigenvalue by row sums.
 */
static void join_nodes(linear *t, double fraction)
{
  double top = 0.0;
  for (int i = 0; i < NODES; i++)
    for (int j = 0; j < i; j++) {
      double d[3], k = pow(10.0, uniform(1.0));
      random_unit(d);
      if (pick(2)) continue;
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
          t->K[3 * i + a][3 * i + b] += k * d[a] * d[b],
              t->K[3 * j + a][3 * j + b] += k * d[a] * d[b];
          t->K[3 * i + a][3 * j + b] -= k * d[a] * d[b],
              t->K[3 * j + a][3 * i + b] -= k * d[a] * d[b];
        }
    }
  for (int i = 0; i < DOFS; i++) {
    double sum = 0.0;
    for (int j = 0; j < DOFS; j++) sum += fabs(t->K[i][j]) / sqrt(t->mass[i / 3] * t->mass[j / 3]);
    top = fmax(top, sum);
  }
  t->dt = fraction * 2.0 / sqrt(top);
}

/* Row j between four nodes and four others, or an obstacle. */
static void new_row(linear *t, int j, double spread, double mu)
{
  ct_constraint *c = &t->row[j];
  point *p = &t->slip[j];
  int perm[NODES];
  for (int i = 0; i < NODES; i++) perm[i] = i;
  for (int i = 0; i < NODES; i++) {
    int k = pick(NODES), m = perm[i];
    perm[i] = perm[k], perm[k] = m;
  }
  for (int a = 0; a < 4; a++) {
    t->own[j][a] = perm[a], t->other[j][a] = perm[4 + a];
    t->own_shape[j][a] = t->other_shape[j][a] = 0.25 + 0.2 * uniform(1.0);
  }
  *c = (ct_constraint){.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                       .own_count = 4,
                       .other_count = pick(10) < 7 ? 4 : 0,
                       .own = t->own[j],
                       .other = t->other[j],
                       .own_shape = t->own_shape[j],
                       .other_shape = t->other_shape[j],
                       .dissipation = 0.15,
                       .gap = pick(3) ? fabs(uniform(0.2)) : 0.0,
                       .slip = &p->slip};
  double n[3] = {spread * uniform(1.0), spread * uniform(1.0), 1.0 + spread * uniform(1.0)};
  double length = sqrt(ct_vector_dot(n, n));
  for (int k = 0; k < 3; k++) c->normal[k] = n[k] / length;
  open_point(p, c->normal, mu);
  for (int k = 0; k < 3; k++) p->lever[k] = 0.1 * c->normal[k];
  for (int b = 0; b < 4; b++)
    for (int k = 0; k < 3; k++) p->weight[b][k] = spread > 0.0 ? uniform(1.0) : 0.0;
}

/* Velocities of the nodes, and loads that press and shear the rows. */
static void load_rows(linear *t)
{
  for (int d = 0; d < DOFS; d++) t->v[d] = 0.3 * uniform(1.0), t->last[d] = -t->dt * t->v[d];
  for (int j = 0; j < t->rows; j++) {
    double press = 3.0 * fabs(uniform(1.0)), shear[3];
    for (int k = 0; k < 3; k++) shear[k] = uniform(1.5);
    for (int a = 0; a < 8; a++)
      for (int k = 0; k < 3; k++) {
        double N = a < 4                   ? t->own_shape[j][a]
                   : t->row[j].other_count ? -t->other_shape[j][a - 4]
                                           : 0.0;
        t->load[3 * (a < 4 ? t->own[j][a] : t->other[j][a - 4]) + k] -=
            N * (press * t->row[j].normal[k] + shear[k]);
      }
  }
}

/* A random scene with masses of 10^-decades to 10^decades, and stiffnesses relative to the inertia
 * of the points. */
static void new_linear(linear *t, double spread, double decades, double fraction, double mu)
{
  *t = (linear){.rows = 1 + pick(ROWS)};
  for (int i = 0; i < NODES; i++) t->mass[i] = pow(10.0, decades * uniform(1.0));
  join_nodes(t, fraction);
  for (int j = 0; j < t->rows; j++) new_row(t, j, spread, mu);
  open_solver(t);
  const double stiff = pow(10.0, 1.5 + 1.5 * uniform(1.0));
  for (int j = 0; j < t->rows; j++) {
    double own = 0.0;
    for (int a = 0; a < 4; a++) own = fmax(own, t->dt * t->dt / t->mass[t->own[j][a]]);
    t->row[j].stiffness = stiff * pow(10.0, 0.3 * uniform(1.0)) / own;
    t->slip[j].k = t->row[j].stiffness * (pick(2) ? 1.0 : 0.1);
  }
  load_rows(t);
}

/* Row j times increments of all nodes: along the normal, or in the plane. */
static void relative_motion(const linear *t, int j, const double *du, double out[3])
{
  const ct_constraint *c = &t->row[j];
  for (int k = 0; k < 3; k++) {
    out[k] = 0.0;
    for (int a = 0; a < 4; a++) out[k] += t->own_shape[j][a] * du[3 * t->own[j][a] + k];
    for (int b = 0; b < c->other_count; b++)
      out[k] -= t->other_shape[j][b] * du[3 * t->other[j][b] + k];
  }
}

static void tangential_motion(const linear *t, int j, const double *du, double out[3])
{
  const ct_constraint *c = &t->row[j];
  relative_motion(t, j, du, out);
  for (int b = 0; b < c->other_count; b++)
    for (int k = 0; k < 3; k++)
      out[k] -= t->slip[j].weight[b][k] * ct_vector_dot(t->slip[j].lever, &du[3 * t->other[j][b]]);
  ct_vector_make_tangential(c->normal, out);
}

/* Forces of row j on the nodes. */
static void push(const linear *t, int j, double *f)
{
  const ct_constraint *c = &t->row[j];
  const point *p = &t->slip[j];
  for (int k = 0; k < 3; k++) {
    for (int a = 0; a < 4; a++)
      f[3 * t->own[j][a] + k] += t->own_shape[j][a] * (c->force * c->normal[k] + p->force[k]);
    for (int b = 0; b < c->other_count; b++)
      f[3 * t->other[j][b] + k] -= t->other_shape[j][b] * (c->force * c->normal[k] + p->force[k]) +
                                   ct_vector_dot(p->weight[b], p->force) * p->lever[k];
  }
}

/* What the steps of linear scenes show. */
typedef struct account {
  double growth, friction, rounds;
  int steps, bad, releases;
} account;

/* Energies of a step: what points hold by slip before and after it, what springs and reserves of
 * normal forces gain, the work of obstacles, and that of friction. */
typedef struct ledger {
  double before, after, normals, obstacle, rub;
} ledger;

/* Give the solver the rows of a step: a few points have lost their partners, those at obstacles are
 * moved. */
static void list_rows(linear *t, int step, int randomly, const double moving[3], int *lost,
                      ledger *books)
{
  t->s->first[1] = 0;
  for (int j = 0; j < t->rows; j++) {
    ct_constraint *c = &t->row[j];
    point *p = &t->slip[j];
    lost[j] = step % 17 == 16 && pick(10) == 0;
    if (randomly) p->of.mu = pow(10.0, -0.5 + 2.5 * uniform(1.0));
    p->work = 0.0;
    if (c->other_count == 0)
      for (int k = 0; k < 3; k++)
        p->of.came[k] = p->of.coming[k], p->of.coming[k] = moving[k] * cos(0.3 * step),
        p->of.moves = 1;
    c->came = c->other_count ? 0.0 : -ct_vector_dot(c->normal, p->of.came);
    c->moved = c->other_count ? 0.0 : -ct_vector_dot(c->normal, p->of.coming);
    books->normals -= c->impact.reserve;
    if (lost[j]) ct_slip_open(&p->slip), books->normals -= c->impact.stored, ct_law_leave(c, t->dt);
    else t->s->rows[t->s->first[1]++] = c;
    books->before += stored_of(p);
  }
}

/* The energies of the rows in a step with the increments `dl` before it and `du` in it. */
static void account_rows(linear *t, const int *lost, const double *dl, const double *du,
                         ledger *books, int *releases)
{
  for (int j = 0; j < t->rows; j++) {
    ct_constraint *c = &t->row[j];
    point *p = &t->slip[j];
    double a[3], b[3];
    relative_motion(t, j, dl, a), relative_motion(t, j, du, b);
    const double last = c->gap - (ct_vector_dot(a, c->normal) + c->came),
                 g = c->gap + (ct_vector_dot(b, c->normal) + c->moved);
    if (!lost[j]) {
      books->normals += 0.25 * c->stiffness * (pow(fmin(g, 0.0), 2) - pow(fmin(last, 0.0), 2));
      books->obstacle += 0.5 * c->force * (c->moved + c->came);
      tangential_motion(t, j, dl, a), tangential_motion(t, j, du, b);
      for (int k = 0; k < 3 && !c->other_count; k++) {
        books->obstacle -= 0.5 * p->force[k] * (p->of.came[k] + p->of.coming[k]);
        a[k] -= p->of.came[k], b[k] -= p->of.coming[k];
      }
      books->rub += 0.5 * (ct_vector_dot(p->force, a) + ct_vector_dot(p->force, b));
    }
    books->after += stored_of(p), books->normals += c->impact.reserve;
    *releases += c->impact.release > 0.0;
    c->gap = g;
  }
}

/* Forces of the springs and loads, and for the solver the increments that they alone would give. */
static void predict(linear *t, double *f, double *dl)
{
  for (int d = 0; d < DOFS; d++) {
    f[d] = t->load[d];
    for (int i = 0; i < DOFS; i++) f[d] -= t->K[d][i] * t->u[i];
    dl[d] = t->u[d] - t->last[d];
    t->s->increment[4 * (d / 3) + d % 3] = t->dt * (t->v[d] + t->dt * f[d] / t->mass[d / 3]);
    t->s->last_increment[4 * (d / 3) + d % 3] = dl[d];
  }
}

/* Total energy of the bodies after a step; `kinetic` is a part of it. */
static double mechanical_energy(const linear *t, const double *next, double *kinetic)
{
  double E = 0.0;
  *kinetic = 0.0;
  for (int d = 0; d < DOFS; d++) {
    *kinetic += 0.5 * t->mass[d / 3] * t->v[d] * t->v[d];
    E -= 0.5 * t->load[d] * (t->u[d] + next[d]);
    for (int i = 0; i < DOFS; i++) E += 0.5 * t->u[d] * t->K[d][i] * next[i];
  }
  return E + *kinetic;
}

/* Take steps, and count the energy; `randomly`: the coefficient of friction is another one in each;
 * `rounds`: most of the iteration, which then stops early. (eq:slip-work, eq:slip-store,
 * eq:slip-guard, eq:slip-stick, eq:slip-loss, eq:impact-reserve) */
static void run_linear(linear *t, int steps, int rounds, int randomly, account *sum)
{
  double energy = 0.0, start = 0.0;
  ct_solver *s = t->s;
  if (rounds > 0) s->tangent->most_rounds = rounds;
  for (int d = 0; d < DOFS; d++)
    start += 0.5 * t->mass[d / 3] * t->v[d] * t->v[d] + 0.1 * fabs(t->load[d]);
  double moving[3] = {0.1 * t->dt * uniform(1.0), 0.1 * t->dt * uniform(1.0), 0.0};
  for (int step = 0; step < steps; step++) {
    double f[DOFS], fc[DOFS] = {0.0}, du[DOFS], dl[DOFS], next[DOFS];
    ledger books = {0};
    int lost[ROWS];
    list_rows(t, step, randomly, moving, lost, &books);
    predict(t, f, dl);
    if (!ct_solver_solve(s)) {
      sum->bad += 1000;
      return;
    }
    sum->rounds += s->iterations, sum->steps++, sum->bad += !s->converged;
    for (int j = 0; j < t->rows; j++)
      if (!lost[j]) push(t, j, fc);
    for (int d = 0; d < DOFS; d++) {
      t->v[d] += t->dt * (f[d] + fc[d]) / t->mass[d / 3];
      next[d] = t->u[d] + t->dt * t->v[d], du[d] = next[d] - t->u[d];
    }
    account_rows(t, lost, dl, du, &books, &sum->releases);
    double kinetic;
    const double E = mechanical_energy(t, next, &kinetic), slip = books.after - books.before,
                 gain = (E + books.obstacle - energy) + books.normals + slip;
    if (step > 0) {
      sum->growth = worst(sum->growth, fmax(gain, 0.0) / (start + kinetic));
      sum->friction = worst(sum->friction, fmax(books.rub + slip, 0.0) / start);
    }
    energy = E;
    memcpy(t->last, t->u, sizeof next), memcpy(t->u, next, sizeof next);
  }
}

/* Random scenes: how many, the decades of their masses, how far apart their normals are, the
 * tolerance of all forces, the most rounds (0: the usual number), whether the coefficient of
 * friction is another one in each step, and the restitution. */
typedef struct setting {
  int count;
  double decades, spread, tolerance;
  int rounds, randomly;
  double restitution;
  const char *name;
} setting;

static void scenes(setting of)
{
  account sum = {.steps = 0};
  for (int k = 0; k < of.count; k++) {
    linear t;
    new_linear(&t, of.spread, of.decades, 0.1 + 0.88 * fabs(uniform(1.0)),
               pow(10.0, 0.65 * uniform(1.0) - 0.35));
    t.s->tolerance = of.tolerance, t.s->dt = t.dt;
    for (int j = 0; j < t.rows && of.restitution > 0.0; j++)
      t.row[j].restitution = of.restitution,
      t.row[j].travel_time = t.dt * (1.0 + fabs(uniform(2.0)));
    run_linear(&t, 60, of.rounds, of.randomly, &sum);
    ct_pool_free(t.s);
  }
  tap_ok(sum.growth < 2e-12 && sum.friction < 1e-11,
         "%s, tolerance %.0e, normals %.1f apart, restitution %g: no step adds energy (%.1e, "
         "friction alone %.1e); %.1f rounds",
         of.name, of.tolerance, of.spread, of.restitution, sum.growth, sum.friction,
         sum.rounds / sum.steps);
  tap_ok((sum.releases > 0) == (of.restitution > 0.0), "%d points give their impact back",
         sum.releases);
  tap_ok(of.rounds > 0 && of.spread == 0.0 ? sum.bad > 0 : 50 * sum.bad < sum.steps,
         "and steps that do not converge are counted (%d of %d)", sum.bad, sum.steps);
}

/* What a row did in a step: its elastic slips one step before the last, the sum of its last slips
 * and its motion, its motion in the last step, and its reserve before. */
typedef struct trip {
  double earlier[3], whole[3], last[3], reserve;
} trip;

/* Motion of row j along its partner in the last step that was taken. */
static void last_motion(const linear *t, int j, double out[3])
{
  double du[DOFS];
  for (int d = 0; d < DOFS; d++) du[d] = t->u[d] - t->last[d];
  tangential_motion(t, j, du, out);
  for (int i = 0; i < 3 && t->row[j].other_count == 0; i++) out[i] -= t->slip[j].of.coming[i];
  ct_vector_make_tangential(t->row[j].normal, out);
}

/* The energy that row j loses in a step without dissipation, and a size for its rounding.
 * (eq:slip-loss, eq:slip-work) */
static double loss_of(const linear *t, int j, const trip *r, double *size)
{
  const point *p = &t->slip[j];
  double both[3], k4 = 0.25 * p->k, e2 = ct_vector_dot(p->e, p->e),
                  earlier2 = ct_vector_dot(r->earlier, r->earlier);
  for (int i = 0; i < 3; i++) both[i] = r->last[i] + (r->whole[i] - p->before[i]);
  const double W = 0.5 * ct_vector_dot(p->force, both);
  *size += k4 * (e2 + earlier2 + ct_vector_dot(p->before, p->before)) + r->reserve + fabs(W);
  return k4 * (earlier2 - e2) + r->reserve - W;
}

/* Springs that pay, in the steps of scenes. */
typedef struct payments {
  double unlike, loss;
  int small, large, wrong;
} payments;

/* A step without dissipation: elastic slips that do not follow from the force are the motion,
 * shortened by one factor, such that nothing is lost if it is below 1; and the points have slipped,
 * without a reserve, if they pay more than 1 %. Steps with points without a force do not count.
 * (eq:slip-paid) */
static void count_payments(const linear *t, const trip trips[ROWS], payments *sum)
{
  double factor = -1.0, loss = 0.0, size = 0.0;
  int stuck = 0, payers = 0;
  for (int j = 0; j < t->rows; j++) {
    const point *p = &t->slip[j];
    const trip *r = &trips[j];
    double off = 0.0, e = 0.0, whole = sqrt(ct_vector_dot(r->whole, r->whole));
    if (ct_vector_dot(p->force, p->force) == 0.0) return;
    loss += loss_of(t, j, r, &size);
    for (int i = 0; i < 3; i++) {
      off = fmax(off, fabs(p->e[i] + 2.0 * p->force[i] / p->k + r->earlier[i]));
      e = fmax(e, fabs(p->e[i]) + fabs(r->earlier[i]));
    }
    if (off <= 1e-9 * e) continue;
    const double own = sqrt(ct_vector_dot(p->e, p->e)) / whole;
    if (payers++ > 0) sum->unlike = worst(sum->unlike, own - factor);
    factor = own, stuck += p->stuck != 0.0, sum->wrong += p->reserve > 1e-12 * size;
    for (int i = 0; i < 3; i++)
      sum->unlike = worst(sum->unlike, (p->e[i] - own * r->whole[i]) / whole);
  }
  if (payers == 0 || factor > 1.0 - 1e-8) return;
  const int large = 1.0 - factor * factor > 0.01;
  sum->loss = worst(sum->loss, loss / size);
  sum->wrong += stuck != (large ? 0 : payers);
  sum->large += large, sum->small += !large;
}

/* Random scenes without dissipation, step by step. */
static void springs_pay(void)
{
  payments sum = {.small = 0};
  for (int k = 0; k < 200; k++) {
    linear t;
    account all = {.steps = 0};
    new_linear(&t, 1.0, 0.5, 0.9, 1.0);
    t.s->tolerance = 0.1;
    for (int j = 0; j < t.rows; j++) t.row[j].dissipation = 0.0;
    for (int step = 0; step < 60; step++) {
      trip trips[ROWS];
      for (int j = 0; j < t.rows; j++) {
        memcpy(trips[j].earlier, t.slip[j].before, sizeof trips[j].earlier);
        last_motion(&t, j, trips[j].last);
        trips[j].reserve = t.slip[j].reserve;
      }
      run_linear(&t, 1, 0, 0, &all);
      for (int j = 0; j < t.rows; j++) {
        last_motion(&t, j, trips[j].whole);
        for (int i = 0; i < 3; i++) trips[j].whole[i] += t.slip[j].before[i];
      }
      count_payments(&t, trips, &sum);
    }
    ct_pool_free(t.s);
  }
  tap_ok(sum.unlike < 1e-8 && sum.loss < 1e-11,
         "springs that pay are shortened by one factor (%.1e), and nothing is lost (%.1e)",
         sum.unlike, sum.loss);
  tap_ok(sum.wrong == 0 && sum.small > 5 && sum.large > 5,
         "and points that pay more than 1 %% have slipped (%d steps; %d with less; %d wrong)",
         sum.large, sum.small, sum.wrong);
}

/* The size of the entry of node `i` of the scene in row `j` without its couple, and with it. */
static double bare_entry(const linear *t, int j, int i)
{
  for (int a = 0; a < 4; a++) {
    if (t->own[j][a] == i) return fabs(t->own_shape[j][a]);
    if (t->row[j].other_count > 0 && t->other[j][a] == i) return fabs(t->other_shape[j][a]);
  }
  return 0.0;
}

static double entry(const linear *t, int j, int i)
{
  const point *p = &t->slip[j];
  for (int a = 0; a < 4; a++) {
    const double *w = p->weight[a],
                 couple = sqrt(ct_vector_dot(w, w) * ct_vector_dot(p->lever, p->lever));
    if (t->own[j][a] == i) return fabs(t->own_shape[j][a]);
    if (t->row[j].other_count > 0 && t->other[j][a] == i)
      return fabs(t->other_shape[j][a]) + couple;
  }
  return 0.0;
}

/* How far the sums that the solver gives for row j are from the forces of its point. */
static double sums_off(linear *t, int j)
{
  const point *p = &t->slip[j];
  const double normal = t->row[j].force;
  double f[DOFS] = {0.0}, off = 0.0;
  t->row[j].force = 0.0;
  push(t, j, f);
  t->row[j].force = normal;
  for (int d = 0; d < DOFS; d++)
    off = worst(off, f[d] - (p->sums[d / 3][d % 3] + p->sums[d / 3][3 + d % 3]));
  return off;
}

/* W T in row j: the motion by the tangential forces of all points. */
static void motion_by_forces(linear *t, int j, double out[3])
{
  double f[DOFS] = {0.0}, normal[ROWS];
  for (int q = 0; q < t->rows; q++) {
    normal[q] = t->row[q].force, t->row[q].force = 0.0;
    push(t, q, f);
    t->row[q].force = normal[q];
  }
  for (int d = 0; d < DOFS; d++) f[d] *= t->dt * t->dt / t->mass[d / 3];
  tangential_motion(t, j, f, out);
}

/* Forces and slips of one step satisfy the conditions of the minimum. (eq:slip-bound,
 * eq:slip-iteration, eq:slip-residual, eq:slip-set, eq:slip-row, eq:slip-start) */
static void solution(double spread)
{
  double off = 0.0, bound = 0.0, slope = 0.0, start = 0.0, given = 0.0;
  int slips = 0, sticks = 0;
  for (int k = 0; k < 60; k++) {
    linear t;
    account sum = {.steps = 0};
    new_linear(&t, spread, 0.5, 0.5, 0.3);
    run_linear(&t, 10 + k % 7, 0, 0, &sum);
    ct_tangent *of = t.s->tangent;
    for (int64_t r = 0; r < of->count && of->top > 0.0; r++) {
      const ct_constraint *row = of->rows[r];
      const int j = (int)(row - t.row);
      const point *p = &t.slip[j];
      ct_slip_set set = {.limit = of->limit[r], .most = of->most[r]};
      ct_columns_get(&of->c, r, set.c);
      double D = 0.0, du[DOFS], motion[3], slip[3], T[3], WT[3], size = 0.0;
      if (row->force == 0.0) continue;
      for (int i = 0; i < NODES; i++) {
        double all = 0.0;
        for (int64_t q = 0; q < of->count; q++) all += entry(&t, (int)(of->rows[q] - t.row), i);
        D += entry(&t, j, i) * t.dt * t.dt / t.mass[i] * all;
      }
      const double a = row->dissipation * sqrt(1.0 + 4.0 / (p->k * D)),
                   C = 2.0 / (p->k * (1.0 + a));
      bound = worst(bound, (D + C) * of->scale[r] - 1.0);
      // The last step has led from t.last to t.u, and e is that of its end.
      for (int d = 0; d < DOFS; d++) du[d] = t.u[d] - t.last[d];
      tangential_motion(&t, j, du, motion);
      for (int i = 0; i < 3 && row->other_count == 0; i++) motion[i] -= p->of.coming[i];
      ct_vector_make_tangential(row->normal, motion);
      for (int i = 0; i < 3; i++) {
        slip[i] = motion[i] - (p->e[i] - p->before[i]);
        T[i] = p->force[i] - slip[i] / (D + C);
        size = fmax(size, fabs(p->force[i]));
      }
      given = worst(given, sums_off(&t, j) / of->size_of_force);
      motion_by_forces(&t, j, WT);
      for (int i = 0; i < 3; i++)
        start = worst(start, (p->image[i] - WT[i]) / (D * of->size_of_force));
      ct_slip_project(&set, T);
      for (int i = 0; i < 3; i++) off = worst(off, (T[i] - p->force[i]) / of->size_of_force);
      slips += p->stuck == 0.0, sticks += p->stuck != 0.0;
      slope = worst(slope, fmax(ct_vector_dot(p->force, slip), 0.0) /
                               (of->size_of_force * of->size_of_force * D));
    }
    ct_pool_free(t.s);
  }
  tap_ok(off < 2e-3 && slips > 10 && sticks > 10,
         "normals %.1f apart: forces of %d sliding points and %d sticking ones are minimal (%.1e)",
         spread, slips, sticks, off);
  tap_ok(bound < 1e-12, "and the bound of each row is that of a dense matrix (%.1e)", bound);
  tap_ok(start < 1e-12, "each point stores its motion by all forces (%.1e)", start);
  tap_ok(given < 1e-15, "and gives its forces at the nodes (%.1e)", given);
  tap_ok(slope < 1e-3, "no slip is along its force (%.1e)", slope);
}

/* The widened bounds of the normal rows are at least those of the rows with their couples, and at
 * most 1.21 times as large. (eq:slip-bound-couples) */
static void small_couples(void)
{
  double below = 0.0, off = 0.0, most = 1.0;
  int rows = 0;
  for (int k = 0; k < 60; k++) {
    linear t;
    account sum = {.steps = 0};
    new_linear(&t, 0.5, 0.5, 0.5, 0.3);
    for (int j = 0; j < t.rows; j++)
      for (int c = 0; c < 3; c++) t.slip[j].lever[c] *= 1e-3 * k;
    run_linear(&t, 10 + k % 7, 0, 0, &sum);
    const ct_tangent *of = t.s->tangent;
    for (int64_t r = 0; r < of->count && of->some && of->widening > 1.0; r++) {
      const int j = (int)(of->rows[r] - t.row);
      double D = 0.0, B = 0.0;
      for (int i = 0; i < NODES; i++) {
        double all = 0.0, bare = 0.0;
        for (int64_t q = 0; q < of->count; q++) {
          const int other = (int)(of->rows[q] - t.row);
          all += entry(&t, other, i), bare += bare_entry(&t, other, i);
        }
        D += entry(&t, j, i) * t.dt * t.dt / t.mass[i] * all;
        B += bare_entry(&t, j, i) * t.dt * t.dt / t.mass[i] * bare;
      }
      below = fmax(below, D / (of->widening * B) - 1.0);
      off = worst(off, (of->widening * B + of->C[r]) * of->scale[r] - 1.0);
      most = fmax(most, of->widening);
      rows++;
    }
    ct_pool_free(t.s);
  }
  tap_ok(rows > 50 && most > 1.1 && most <= 1.21 && below == 0.0 && off < 1e-12,
         "couples widen the bounds of %d rows, by up to %.2f, and enough (%.1e, %.1e)", rows, most,
         below, off);
}

/* Two warped faces turn together: no point slips. Without the couple it would. (eq:slip-row,
 * eq:friction-components) */
static void rotation(void)
{
  double off = 0.0, plain = 0.0;
  for (int k = 0; k < 20; k++) {
    double x[CT_SOLVER_WIDE * 8] = {0.0}, u[CT_SOLVER_WIDE * 8] = {0.0}, dN[8][2], t[2][3], n[3],
                              y[3] = {0.0}, closest[3] = {0.0}, omega[3], out[CT_SOLVER_WIDE];
    double own[8] = {0.0}, other[8] = {0.0}, size = 0.0;
    static const double CORNER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const double xi[2] = {uniform(0.9), uniform(0.9)}, depth = 0.1;
    point p;
    ct_face face = {.kind = CT_Q4};
    for (int a = 0; a < 4; a++) {
      for (int c = 0; c < 2; c++) x[4 * (4 + a) + c] = CORNER[a][c] + uniform(0.2);
      x[4 * (4 + a) + 2] = uniform(0.2);
      for (int c = 0; c < 3; c++) face.node[a][c] = x[4 * (4 + a) + c];
    }
    ct_segment_shape(CT_Q4, xi, other);
    ct_segment_gradient(CT_Q4, xi, dN);
    ct_segment_tangents(&face, xi, t[0], t[1]);
    ct_vector_unit_normal(t[0], t[1], n);
    open_point(&p, n, 1.0);
    const double m11 = ct_vector_dot(t[0], t[0]), m22 = ct_vector_dot(t[1], t[1]),
                 m12 = ct_vector_dot(t[0], t[1]), det = m11 * m22 - m12 * m12;
    for (int a = 0; a < 4; a++)
      for (int c = 0; c < 3; c++) {
        closest[c] += other[a] * face.node[a][c];
        p.weight[a][c] = (dN[a][0] * (m22 * t[0][c] - m12 * t[1][c]) +
                          dN[a][1] * (m11 * t[1][c] - m12 * t[0][c])) /
                         det;
      }
    // The point lies below, on a face whose corners are anywhere.
    for (int a = 0; a < 4; a++) own[a] = 0.25;
    for (int c = 0; c < 3; c++) {
      double sum = 0.0;
      p.lever[c] = depth * n[c], y[c] = closest[c] - p.lever[c];
      for (int a = 0; a < 3; a++) x[4 * a + c] = y[c] + uniform(1.0), sum += x[4 * a + c];
      x[4 * 3 + c] = 4.0 * y[c] - sum;
      omega[c] = uniform(1.0);
    }
    for (int i = 0; i < 8; i++) ct_vector_cross(omega, &x[4 * i], &u[4 * i]);
    ct_constraint row = {.own_count = 4, .other_count = 4, .own_shape = own, .other_shape = other};
    memcpy(row.normal, n, sizeof n);
    static const int32_t place[8] = {0, 4, 8, 12, 16, 20, 24, 28};
    row.slip = &p.slip;
    double couple[CT_TANGENT_LANES];
    fill_alone(&row, couple);
    relative(4, 4, &row, couple, place, u, out);
    for (int c = 0; c < 3; c++) off = worst(off, out[c]);
    memset(p.weight, 0, sizeof p.weight);
    fill_alone(&row, couple);
    relative(4, 4, &row, couple, place, u, out);
    for (int c = 0; c < 3; c++) size = worst(size, out[c]);
    plain = fmax(plain, size);
  }
  tap_ok(off < 1e-14 && plain > 0.01,
         "faces that turn together do not slip (%.1e; without the couple %.2g)", off, plain);
}

/* One step of four equal masses, each held by a spring along x, on a plane that moves along x. */
static void take_step(linear *t, double moves)
{
  double f[DOFS] = {0.0}, fc[DOFS] = {0.0};
  point *p = &t->slip[0];
  p->of.came[0] = p->of.coming[0], p->of.coming[0] = moves, p->of.moves = 1;
  for (int c = 0; c < 3; c++) p->force[c] = -p->k * p->e[c];
  for (int d = 0; d < DOFS; d++) {
    f[d] = t->load[d] - t->K[d][d] * t->u[d];
    t->s->last_increment[4 * (d / 3) + d % 3] = t->u[d] - t->last[d];
    t->s->increment[4 * (d / 3) + d % 3] = t->dt * (t->v[d] + t->dt * f[d] / t->mass[d / 3]);
  }
  t->s->first[1] = 1;
  if (!ct_solver_solve(t->s)) return;
  push(t, 0, fc);
  for (int d = 0; d < DOFS; d++) {
    t->last[d] = t->u[d];
    t->v[d] += t->dt * (f[d] + fc[d]) / t->mass[d / 3];
    t->u[d] += t->dt * t->v[d];
  }
  t->row[0].gap = t->row[0].after;
}

/* A plane that crawls drags the masses until friction is at its limit; when it has moved back by
 * twice the elastic slip and the springs' stretch, friction is at the other limit. A step's slip is
 * below what the iteration resolves. (eq:slip-stick, eq:slip-law) */
static void crawls(void)
{
  linear t = {.rows = 1, .dt = 0.1};
  const double mu = 0.5, k = 1000.0, spring = 100.0, limit = mu * 4.0, moves = 5e-6,
               way = limit / k + limit / (4.0 * spring);
  double most = 0.0, off = 0.0, forward, back;
  t.row[0] = (ct_constraint){.enforcement = CT_ENFORCE_ENERGY_CONTROLLED,
                             .own_count = 4,
                             .own = t.own[0],
                             .own_shape = t.own_shape[0],
                             .dissipation = 0.15,
                             .stiffness = k,
                             .gap = -4.0 / k,
                             .force = 4.0,
                             .normal = {0.0, 0.0, 1.0},
                             .slip = &t.slip[0].slip};
  open_point(&t.slip[0], t.row[0].normal, mu);
  t.slip[0].k = k;
  for (int i = 0; i < NODES; i++) t.mass[i] = 1.0;
  for (int a = 0; a < 4; a++) {
    t.own[0][a] = a, t.own_shape[0][a] = 0.25;
    t.K[3 * a][3 * a] = spring, t.load[3 * a + 2] = -1.0;
  }
  open_solver(&t);
  const int there = (int)(2.5 * way / moves);
  for (int step = 0; step < there; step++) {
    take_step(&t, moves);
    most = worst(most, fabs(t.slip[0].e[0]));
    if (step > there / 2) off = worst(off, t.slip[0].force[0] - limit);
  }
  forward = t.slip[0].force[0];
  for (int step = 0; step < (int)(2.0 * way / moves); step++) take_step(&t, -moves);
  back = t.slip[0].force[0];
  tap_ok(off < 3e-4 * limit && most < 1.01 * limit / k,
         "a crawling plane: friction is at its limit (off %.1e), the elastic slip not beyond %.3f "
         "of its own",
         off / limit, most * k / limit);
  tap_ok(forward > 0.999 * limit && back < -0.98 * limit,
         "and at the other one when it has moved back by twice the elastic ways (%.4f, %.4f)",
         forward / limit, back / limit);
  ct_pool_free(t.s);
}

int main(void)
{
  projection();
  rotation();
  solution(0.0);
  solution(0.5);
  for (int k = 0; k < 6; k++) {
    const double spread = 0.5 * (k % 3), e = k < 3 ? 0.0 : 1.0, tight = CT_SOLVER_TIGHT;
    scenes((setting){100, 0.5, spread, tight, 0, 0, e, "friction"});
    scenes((setting){100, 0.5, spread, tight, 0, 1, e, "any coefficient"});
    scenes((setting){100, 0.5, spread, tight, 12, 1, e, "twelve rounds"});
    scenes((setting){100, 0.5, spread, 1e-3, 0, 1, e, "any coefficient"});
    scenes((setting){100, 0.5, spread, 0.1, 0, 1, e, "any coefficient"});
  }
  springs_pay();
  crawls();
  // Releases throw points inside that were far away, in one of some hundred scenes
  // (eq:thrown-constraints)
  scenes((setting){1000, 1.5, 0.0, CT_SOLVER_TIGHT, 0, 1, 1.0, "unlike masses"});
  scenes((setting){1000, 1.5, 0.5, 0.1, 0, 1, 1.0, "unlike masses"});
  scenes((setting){1000, 2.0, 1.0, 1e-3, 0, 1, 1.0, "unlike masses"});
  small_couples();
  return tap_done();
}
