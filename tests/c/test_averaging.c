/* Averaged mass: the force against matrices that are written down by themselves, waves against
 * their closed form, energy and momentum, contact, the bound, and what is promised of bits. */
#include "../../libcontact/src/step/stable.c"

#include "blocks.h"

static const ct_material STEEL = {2.1, 0.3, 0.7, CT_LINEAR};
static const ct_material ROD = {1.0, 0.0, 1.0, CT_LINEAR};
static const double PI = 3.14159265358979323846;

/* γ of cubes. */
static double eta_of(const ct_material *material, double h, double dt)
{
  double c1, c2;
  ct_material_speeds(material, &c1, &c2);
  return 0.5 * (1.0 - pow(c1 * dt / h, 2));
}

/* Add the averaging to a scene, with nodes apart. */
static void add_averaging(ct_scene *scene, const int32_t *apart, int32_t count)
{
  ct_averaging_def def = {COOKIE, .apart = apart, .apart_count = count};
  add_made(scene, ct_averaging_create_effect, &def);
}

static const ct_effect *averaging_of(const ct_problem *problem)
{
  for (int k = 0; k < problem->effect_count; k++)
    if (problem->effects[k]->kind == CT_EFFECT_AVERAGING) return problem->effects[k];
  return NULL;
}

/* M_L - M_C of a mesh of hex8 by Gauss' rule, shape (nodes, nodes), without the elements at
 * excluded nodes. */
static double *mass_difference(const ct_mesh *m, double density, const char *apart)
{
  const double g = sqrt(1.0 / 3.0);
  int n = m->node_count;
  double *D = numbers((int64_t)n * n);
  for (int e = 0; e < m->element_count; e++) {
    const int32_t *node = &m->elements[8 * e];
    double x[60], G[3][3], M[8][8] = {{0.0}};
    int alone = 0;
    for (int a = 0; a < 8; a++) alone |= apart != NULL && apart[node[a]];
    if (alone) continue;
    take_element(m, e, m->nodes, x);
    for (int q = 0; q < 8; q++) {
      double xi[3] = {q & 1 ? g : -g, q & 2 ? g : -g, q & 4 ? g : -g}, N[20];
      double J = brick_determinant(m->kind, (double (*)[3])x, xi, G);
      ct_brick_shape(CT_HEX8, xi, N);
      for (int a = 0; a < 8; a++)
        for (int b = 0; b < 8; b++) M[a][b] += density * J * N[a] * N[b];
    }
    for (int a = 0; a < 8; a++)
      for (int b = 0; b < 8; b++) {
        D[(int64_t)node[a] * n + node[a]] += M[a][b];
        D[(int64_t)node[a] * n + node[b]] -= M[a][b];
      }
  }
  return D;
}

/* The force for any forces of the others: γ (M_L - M_C) M_L⁻¹ f, free, fixed, and with excluded
 * nodes (eq:averaging-force, eq:averaged-modes, eq:averaged-element). */
static void force(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 1.5, 2, 2.5, 3, 4, 5);
  int n = m->node_count;
  char *apart = room(n, 1);
  int32_t *list = integers(n), count = ct_mesh_plane_nodes(m, 1, 2.0, list);
  for (int i = 0; i < count; i++) apart[list[i]] = 1;
  for (int alone = 0; alone < 2; alone++) {
    ct_scene *scene = new_scene_with("block", m, &STEEL, CT_KERNEL_AUTO, 0, 0, 0);
    ct_error e;
    add_support(scene, 0, m, 0, 0.0, "xz", 0.0);
    add_averaging(scene, list, alone ? count : 0);
    const ct_problem *p = build(scene, (ct_scene_time){.end = 1, .fraction = 0.6}, NULL, NULL);
    const ct_effect *effect = averaging_of(p);
    double *f = numbers(3 * n), *got = numbers(3 * n), off = 0.0, top = 0.0, sum[3] = {0.0},
           *D = mass_difference(m, STEEL.density, alone ? apart : NULL),
           eta = eta_of(&STEEL, 0.5, p->dt);
    void *scratch = NULL;
    for (int i = 0; i < 3 * n; i++) f[i] = uniform(1.0);
    need(effect->calls->create_scratch(effect, &scratch, &e), &e);
    ct_view view = {.total = f, .scratch = scratch, .dt = p->dt};
    need(effect->calls->force(effect, &view, got, &e), &e);
    for (int i = 0; i < 3 * n; i++) {
      double want = 0.0;
      for (int j = 0; j < n; j++)
        want +=
            eta * D[(int64_t)(i / 3) * n + j] * p->inverse_mass[3 * j + i % 3] * f[3 * j + i % 3];
      off = worst(off, got[i] - want);
      top = worst(top, want);
      sum[i % 3] += got[i];
    }
    tap_ok(top > 0.1 && off < 1e-14 * top, "force %s compared with Gauss' rule: off by %.2g",
           alone ? "with a face excluded" : "of all elements", off / top);
    // Round-off of 120 terms.
    tap_ok(largest(sum, 3) < 1e-13 * top, "it keeps momentum: %.2g", largest(sum, 3) / top);
    effect->calls->free_scratch(scratch);
    ct_scene_free(scene);
    free(f), free(got), free(D);
  }
  free(list), free(apart);
  ct_mesh_free(m);
}

/* A standing wave of a bar between its free ends: u_n = cos(ω n Δt) cos(k x), with the frequency of
 * eq:averaged-dispersion (eq:averaged-gamma, eq:averaged-modes). */
static double wave_error(int cells, int mode, double courant)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, cells, 1, 1, cells, 1, 1);
  int n = m->node_count;
  double *v = numbers(3 * n), off = 0.0, k = PI * mode / cells, s = pow(sin(0.5 * k), 2);
  for (int i = 0; i < n; i++) v[3 * i] = cos(k * m->nodes[3 * i]);
  ct_scene *scene = new_scene();
  add_moving_body(scene, "bar", m, &ROD, CT_KERNEL_AUTO, v);
  add_support(scene, 0, m, -1, 0.0, "yz", 0.0);
  add_averaging(scene, NULL, 0);
  const ct_problem *p =
      build(scene, (ct_scene_time){.end = 1e3, .dt = courant, .keep_dt = 1}, NULL, NULL);
  ct_state *state = new_state(p);
  double omega =
      2.0 / courant * asin(courant * sqrt(s * (1.0 + (1.0 - courant * courant) * s / 3.0)));
  for (int step = 1; step <= 60; step++) {
    advance(p, state, 1);
    // u_1 = Δt v_0: the amplitude follows.
    double a = courant / sin(omega * courant) * sin(omega * step * courant);
    for (int i = 0; i < n; i++) off = worst(off, state->displacement[3 * i] - a * v[3 * i]);
  }
  free(v);
  close_run(state, scene, m);
  return off * sin(omega * courant) / courant;
}

static void waves(void)
{
  static const double courant[3] = {0.1, 0.5, 0.95};
  double off = 0.0;
  for (int c = 0; c < 3; c++)
    for (int mode = 1; mode <= 16; mode++) off = worst(off, wave_error(16, mode, courant[c]));
  tap_close(off, 0.0, 1e-12, "standing waves of a bar have the closed form's frequency");
  // The error of the speed is of fourth order in kh, twice that of the lumped mass.
  double error[2];
  for (int i = 0; i < 2; i++) {
    ct_dispersion_def def = ct_dispersion_def_default();
    ct_branch b[12];
    double q = 0.4 / (1 + i), wave[3] = {0.0, q, 0.0};
    ct_error e;
    def.mass = CT_MASS_AVERAGED, def.step = 0.5, def.material = ROD;
    need(ct_dispersion(&def, 1, wave, b, &e), &e);
    error[i] = b[2].omega / q - 1.0;
  }
  tap_close(log2(fabs(error[0] / error[1])), 4.0, 0.05, "order of the phase error");
}

/* The Bloch problem against closed forms, in any direction, and its group velocity
 * (eq:averaged-symbol). */
static void dispersion(void)
{
  double off = 0.0, off_cell = 0.0, off_group = 0.0;
  for (int i = 0; i < 300; i++) {
    ct_dispersion_def def = ct_dispersion_def_default(), lumped, consistent;
    ct_branch b[12], l[12], c[12], at[2][12];
    double k[3], one[3] = {0.0}, c1, c2, courant = 0.5 + uniform(0.45);
    ct_error e;
    def.material = STEEL, def.mass = CT_MASS_AVERAGED;
    ct_material_speeds(&STEEL, &c1, &c2);
    def.step = courant / c1;
    for (int d = 0; d < 3; d++) k[d] = uniform(PI);
    one[i % 3] = k[0];
    need(ct_dispersion(&def, 1, one, b, &e), &e);
    double s = pow(sin(0.5 * k[0]), 2);
    double want =
        2.0 / def.step * asin(courant * sqrt(s * (1.0 + (1.0 - courant * courant) * s / 3.0)));
    off = worst(off, b[2].omega / want - 1.0);
    // Cubes in any direction: ω² of the lumped mass times 1 + γ (1 - m_C / m_L).
    lumped = consistent = def, lumped.mass = CT_MASS_LUMPED, consistent.mass = CT_MASS_CONSISTENT;
    need(ct_dispersion(&def, 1, k, b, &e), &e);
    need(ct_dispersion(&lumped, 1, k, l, &e), &e);
    need(ct_dispersion(&consistent, 1, k, c, &e), &e);
    double ratio = pow(l[2].omega_mesh / c[2].omega_mesh, 2), eta = eta_of(&STEEL, 1.0, def.step);
    for (int w = 0; w < 3; w++)
      off_cell =
          worst(off_cell, pow(b[w].omega_mesh / l[w].omega_mesh, 2) - (1.0 + eta * (1.0 - ratio)));
    // Bricks: the group velocity is the difference quotient.
    for (int d = 0; d < 3; d++) def.size[d] = 1.2 + uniform(0.2);
    need(ct_dispersion(&def, 1, k, b, &e), &e);
    for (int d = 0; d < 3; d++) {
      for (int side = 0; side < 2; side++) {
        double moved[3] = {k[0], k[1], k[2]};
        moved[d] += side ? 1e-5 : -1e-5;
        need(ct_dispersion(&def, 1, moved, at[side], &e), &e);
      }
      if (b[2].omega * def.step < 3.0)
        off_group =
            worst(off_group, ((at[1][2].omega - at[0][2].omega) / 2e-5 - b[2].group[d]) / c1);
    }
  }
  tap_close(off, 0.0, 1e-12, "the Bloch problem along an axis has the closed form");
  tap_close(off_cell, 0.0, 1e-12, "and in any direction of cubes the ratio of the two masses");
  // Second differences of a frequency whose slope is steep near the end of its band.
  tap_close(off_group, 0.0, 1e-5, "group velocity against differences");
}

/* Two blocks that collide, and their mirror images; `alone`: elements at the contact are excluded.
 */
static ct_scene *blocks_of(ct_mesh *a, ct_mesh *b, int axis, double dissipation, int alone)
{
  double v[2][3] = {{0.0}}, low[3], high[3], face[2];
  int32_t *list = integers(a->node_count + b->node_count), count = 0;
  ct_contact_options options = ct_contact_options_default();
  ct_scene *scene = new_scene();
  options.dissipation = dissipation;
  v[0][axis] = 0.02, v[1][axis] = -0.02;
  add_body(scene, "a", a, &STEEL, CT_KERNEL_AUTO, v[0][0], v[0][1], v[0][2]);
  add_body(scene, "b", b, &STEEL, CT_KERNEL_AUTO, v[1][0], v[1][1], v[1][2]);
  ct_mesh_bounds(a, low, high), face[0] = high[axis];
  ct_mesh_bounds(b, low, high), face[1] = low[axis];
  add_contact_with(scene, 0, a, face[0], 1, b, face[1], axis, 0.0, options, 0.0, 0.0);
  count = ct_mesh_plane_nodes(a, axis, face[0], list);
  int32_t more = ct_mesh_plane_nodes(b, axis, face[1], list + count);
  for (int32_t i = count; i < count + more; i++) list[i] += a->node_count;
  add_averaging(scene, list, alone ? count + more : 0);
  free(list);
  return scene;
}

/* The largest increase of the energy in one of 300 steps: the contact law may dissipate energy when
 * a point closes or opens, and never adds any. */
static double energy_rise(int alone, double *balance)
{
  ct_mesh *a = box_mesh(CT_HEX8, 0, 0, 0, 2, 2, 2, 4, 4, 4),
          *b = box_mesh(CT_HEX8, 2.001, 0.3, 0.2, 2, 1.5, 1.5, 4, 3, 3);
  ct_scene *scene = blocks_of(a, b, 0, 0.0, alone);
  const ct_problem *p = build(scene, (ct_scene_time){.end = 60, .fraction = 0.7}, NULL, NULL);
  ct_state *state = new_state(p);
  double start = energy_of(p, state).total, rise = 0.0, last = start, contact = 0.0, least = 0.0;
  for (int i = 0; i < 300; i++) {
    advance(p, state, 1);
    ct_energy now = energy_of(p, state);
    rise = fmax(rise, (now.total - last) / start);
    last = now.total;
    *balance = worst(*balance, now.balance / start);
    contact = fmax(contact, now.contact);
  }
  for (int k = 0; k < p->effect_count; k++) {
    double stored;
    ct_error e;
    need(ct_energy_stored(p, state, k, &stored, &e), &e);
    if (p->effects[k]->kind == CT_EFFECT_AVERAGING) least = stored;
  }
  tap_ok(contact > 0.0 && least < -1e-6 * start,
         "the blocks meet, and the averaged mass has an effect: %.2g", least / start);
  ct_momentum momentum[2] = {momentum_of(p, state, 0), momentum_of(p, state, 1)};
  double sum = 0.0;
  for (int c = 0; c < 3; c++)
    sum = worst(sum, momentum[0].p[c] + momentum[1].p[c] -
                         (c == 0 ? 0.02 * STEEL.density * (8.0 - 4.5) : 0.0));
  tap_ok(sum < 1e-13 * 0.02 * STEEL.density * 8.0, "momentum is kept: %.2g", sum);
  close_run(state, scene, a);
  ct_mesh_free(b);
  return rise;
}

static void contact(void)
{
  double balance = 0.0, held = energy_rise(1, &balance), kept_in = energy_rise(0, &balance);
  // Round-off of a row of the ledger.
  tap_close(held, 0.0, 1e-13, "no energy appears in a contact whose elements are excluded");
  tap_ok(kept_in > 1e-5, "with them some would: %.2g", kept_in);
  tap_close(balance, 0.0, 1e-13, "work and energy balance in both");
}

/* Energy of a block with random vibrations, free or fixed, over 400 steps near the limit
 * (eq:averaged-energy, eq:averaged-support, eq:averaged-solve). */
static void energy(void)
{
  for (int held = 0; held < 2; held++) {
    ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 2, 1.5, 1, 5, 4, 3);
    double *v = random_displacement(m, 0.1), drift = 0.0;
    ct_scene *scene = new_scene();
    add_moving_body(scene, "block", m, &STEEL, CT_KERNEL_AUTO, v);
    if (held) add_support(scene, 0, m, 2, 0.0, "xz", 0.01);
    add_averaging(scene, NULL, 0);
    const ct_problem *p = build(scene, (ct_scene_time){.end = 100, .fraction = 0.99}, NULL, NULL);
    ct_state *state = new_state(p);
    ct_energy first = energy_of(p, state), now = first;
    for (int i = 0; i < 400; i++) {
      advance(p, state, 1);
      now = energy_of(p, state);
      drift = worst(drift, now.total / first.total - 1.0);
    }
    tap_ok(fabs(now.kinetic / first.kinetic - 1.0) > 0.1 && drift < 1e-13,
           "a vibrating block, %s, keeps its energy to %.2g", held ? "held" : "free", drift);
    free(v);
    close_run(state, scene, m);
  }
}

/* A run of two blocks, mirrored along an axis, with a number of threads. */
static ct_state *contact_run(ct_scene **scene, ct_mesh *a, ct_mesh *b, int mirrored, int threads,
                             ct_optimisations fast, int64_t steps, ct_state *from)
{
  ct_error e;
  *scene = mirrored ? blocks_of(b, a, 0, 0.15, 1) : blocks_of(a, b, 0, 0.15, 1);
  need(ct_scene_set_optimisations(*scene, &fast, &e), &e);
  set_threads(*scene, threads);
  const ct_problem *p = build(*scene, (ct_scene_time){.end = 10, .dt = 0.07}, NULL, NULL);
  ct_state *state = new_state(p);
  if (from != NULL) need(ct_state_copy(p, from, state, &e), &e);
  advance(p, state, steps);
  return state;
}

static void bits(void)
{
  ct_mesh *a = box_mesh(CT_HEX8, -2.001, 0, 0, 2, 2, 2, 6, 4, 4),
          *b = box_mesh(CT_HEX8, 0.001, 0.3, 0.2, 2, 1.5, 1.5, 6, 3, 3);
  ct_mesh *mirrored[2] = {mirror_mesh(a, 0), mirror_mesh(b, 0)};
  ct_optimisations all = {1, 1, 1, 1}, none = {0, 0, 0, 0};
  ct_scene *scene[6];
  ct_state *one = contact_run(&scene[0], a, b, 0, 1, all, 60, NULL),
           *two = contact_run(&scene[1], a, b, 0, 2, all, 60, NULL),
           *half = contact_run(&scene[2], a, b, 0, 1, all, 23, NULL),
           *rest = contact_run(&scene[3], a, b, 0, 1, all, 37, half),
           *slow = contact_run(&scene[4], a, b, 0, 1, none, 60, NULL),
           *image = contact_run(&scene[5], mirrored[0], mirrored[1], 1, 1, all, 60, NULL);
  int n[2] = {a->node_count, b->node_count};
  int64_t faults = mirror_faults(one->displacement, image->displacement + 3 * n[1], n[0], 0) +
                   mirror_faults(one->displacement + 3 * n[0], image->displacement, n[1], 0);
  tap_ok(same_state(one, two), "two threads have the bits of one");
  tap_ok(same_state(one, rest), "so has a restart");
  tap_ok(largest_difference(one->displacement, slow->displacement, 3 * (n[0] + n[1])) == 0.0,
         "a run without sleeping has them, too");
  tap_ok(faults == 0, "the mirror image has the mirrored bits, but for %d", (int)faults);
  ct_state *states[6] = {one, two, half, rest, slow, image};
  for (int i = 0; i < 6; i++) ct_state_free(states[i]), ct_scene_free(scene[i]);
  ct_mesh_free(a), ct_mesh_free(b), ct_mesh_free(mirrored[0]), ct_mesh_free(mirrored[1]);
}

/* Status of a factory or a problem for a mesh of this kind. */
static ct_status refused(ct_mesh *m, ct_material material, int before, ct_scheme scheme,
                         ct_error *e)
{
  ct_scene *scene = new_scene_with("block", m, &material, CT_KERNEL_AUTO, 0, 0, 0);
  ct_averaging_def def = {COOKIE};
  ct_gravity_def gravity = {COOKIE, .acceleration = {1.0, 0.0, 0.0}};
  const ct_problem *joined, *problem;
  ct_effect *effect = NULL;
  int64_t steps;
  ct_scene_time time = {.end = 1.0, .fraction = 0.5};
  time.integrator = ct_integrator_default(scheme);
  need(ct_scene_join(scene, &joined, e), e);
  ct_status status = ct_averaging_create_effect(&def, joined, &effect, e);
  if (status == CT_OK) {
    need(ct_scene_add_effect(scene, effect, e), e);
    if (before) add_made(scene, ct_gravity_create_effect, &gravity);
    status = ct_scene_build(scene, &time, &problem, &steps, NULL, e);
  }
  ct_scene_free(scene);
  return status;
}

static void refusals(void)
{
  ct_mesh *box = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 3, 3),
          *fine = box_mesh(CT_HEX20, 0, 0, 0, 1, 1, 1, 2, 2, 2),
          *odd = box_mesh(CT_HEX8, 0, 0, 0, 1, 1, 1, 3, 3, 3);
  ct_material large = STEEL;
  ct_error e;
  large.law = CT_NEO_HOOKEAN;
  distort(odd, 0.02);
  tap_ok(refused(box, STEEL, 0, CT_CENTRAL_DIFFERENCE, &e) == CT_OK, "equal bricks are accepted");
  tap_ok(refused(odd, STEEL, 0, CT_CENTRAL_DIFFERENCE, &e) == CT_ERROR_UNSUPPORTED &&
             strstr(e.text, "block") != NULL && e.body == 0,
         "distorted bricks are refused: %s", e.text);
  tap_ok(refused(fine, STEEL, 0, CT_CENTRAL_DIFFERENCE, &e) == CT_ERROR_UNSUPPORTED, "nor hex20");
  tap_ok(refused(box, large, 0, CT_CENTRAL_DIFFERENCE, &e) == CT_ERROR_UNSUPPORTED,
         "large strain is refused");
  tap_ok(refused(box, STEEL, 1, CT_CENTRAL_DIFFERENCE, &e) == CT_ERROR_ARGUMENT,
         "a later effect of the phase state is refused: %s", e.text);
  tap_ok(refused(box, STEEL, 0, CT_NOH_BATHE, &e) == CT_ERROR_ARGUMENT,
         "another integrator is refused: %s", e.text);
  ct_dispersion_def wave[2] = {ct_dispersion_def_default(), ct_dispersion_def_default()};
  double k[3] = {0.1, 0.0, 0.0};
  ct_branch b[12];
  wave[0].kind = CT_HEX20, wave[1].integrator = ct_integrator_default(CT_CHUNG_LEE);
  for (int i = 0; i < 2; i++) {
    wave[i].mass = CT_MASS_AVERAGED;
    tap_ok(ct_dispersion(&wave[i], 1, k, b, &e) == CT_ERROR_ARGUMENT, "also for waves: %s", e.text);
  }
  ct_mesh_free(box), ct_mesh_free(fine), ct_mesh_free(odd);
}

/* Largest eigenvalue of P K with P = M⁺ + M⁺ γ D M⁺, by Cholesky and Jacobi. */
static double true_limit(const ct_problem *bare, const ct_mesh *m, double density, double eta)
{
  int n = 3 * bare->node_count, free_count = 0;
  int32_t *dof = integers(n);
  for (int i = 0; i < n; i++)
    if (bare->inverse_mass[i] > 0.0) dof[free_count++] = i;
  int f = free_count;
  double *D = mass_difference(m, density, NULL), *P = numbers((int64_t)f * f),
         *K = numbers((int64_t)f * f), *A = numbers((int64_t)f * f), *u = numbers(n),
         *g = numbers(n);
  probe one = probe_open(bare);
  for (int j = 0; j < f; j++) {
    u[dof[j]] = 1.0;
    probe_force(&one, u, g);
    u[dof[j]] = 0.0;
    for (int i = 0; i < f; i++) K[i * f + j] = -g[dof[i]];
  }
  probe_close(&one);
  for (int i = 0; i < f; i++)
    for (int j = 0; j < f; j++) {
      double w = bare->inverse_mass[dof[i]];
      if (dof[i] % 3 == dof[j] % 3)
        P[i * f + j] =
            (i == j ? w : 0.0) + eta * w * bare->inverse_mass[dof[j]] *
                                     D[(int64_t)(dof[i] / 3) * bare->node_count + dof[j] / 3];
    }
  for (int i = 0; i < f; i++) // P = L Lᵀ
    for (int j = 0; j <= i; j++) {
      double sum = P[i * f + j];
      for (int k = 0; k < j; k++) sum -= P[i * f + k] * P[j * f + k];
      P[i * f + j] = i == j ? sqrt(sum) : sum / P[j * f + j];
    }
  for (int pass = 0; pass < 2; pass++) { // A = Lᵀ K L
    for (int i = 0; i < f; i++)
      for (int j = 0; j < f; j++) {
        double sum = 0.0;
        for (int k = j; k < f; k++)
          sum += (pass ? A : K)[pass ? k * f + i : i * f + k] * P[k * f + j];
        (pass ? K : A)[pass ? j * f + i : i * f + j] = sum;
      }
  }
  double largest_value = jacobi_largest(f, K);
  free(D), free(P), free(K), free(A), free(u), free(g), free(dof);
  return largest_value;
}

/* Reported over true stable step of one box (eq:averaged-bound). */
static double reported(int cells, ct_solid_kernel kernel, double hourglass, double poisson,
                       int flat)
{
  ct_mesh *m =
      box_mesh(CT_HEX8, 0, 0, 0, cells, flat ? 1 : cells, cells, cells, flat ? 1 : cells, cells);
  ct_material material = {1.0, poisson, 1.0, CT_LINEAR};
  ct_scene *scene[2] = {new_scene(), new_scene()};
  const ct_problem *p[2];
  ct_stable_step stable[2];
  for (int s = 0; s < 2; s++) {
    ct_scene_body def = {.mesh = m, .material = material, .kernel = kernel, .hourglass = hourglass};
    ct_error e;
    need(ct_scene_add_body(scene[s], &def, NULL, &e), &e);
    if (flat) add_support(scene[s], 0, m, -1, 0.0, "y", 0.0);
    if (s == 1) add_averaging(scene[s], NULL, 0);
    p[s] = build(scene[s], (ct_scene_time){.end = 1e6, .fraction = 1.0}, NULL, &stable[s]);
  }
  double dt = stable[1].dt, low = 0.5 * dt, high = 2.0 * dt;
  for (int i = 0; i < 24; i++) { // the true limit, where γ is that of the step
    double middle = 0.5 * (low + high), eta = fmax(eta_of(&material, 1.0, middle), 0.0);
    if (middle * middle * true_limit(p[0], m, 1.0, eta) < 4.0) low = middle;
    else high = middle;
  }
  for (int s = 0; s < 2; s++) ct_scene_free(scene[s]);
  ct_mesh_free(m);
  return dt / low;
}

/* The step of sums of bounds on a mesh of cubes solves Δt = 4 / (F D + √(F²D² + 4 F ω̂²)) with
 * F = 1 + 26/27 η(Δt) (eq:averaged-bound). */
static void fixed_point(void)
{
  ct_mesh *m = box_mesh(CT_HEX8, 0, 0, 0, 3, 3, 3, 3, 3, 3);
  ct_scene *scene = new_scene();
  const ct_material material = {1.0, 0.25, 1.0, CT_LINEAR};
  add_body(scene, "block", m, &material, CT_KERNEL_AUTO, 0, 0, 0);
  add_averaging(scene, NULL, 0);
  const ct_problem *p = build(scene, (ct_scene_time){.end = 1.0, .fraction = 0.5}, NULL, NULL);
  for (double rate = 0.0; rate < 2.0; rate += 0.7) {
    const bounds sum = {.omega_squared = 5.0, .rate = rate};
    double dt = step_of(p, &sum), F = 1.0 + 26.0 / 27.0 * eta_of(&material, 1.0, dt);
    tap_close(dt / (4.0 / (F * rate + sqrt(F * F * rate * rate + 4.0 * F * 5.0))), 1.0, 1e-12,
              "step of averaged masses with the damping rate %g", rate);
  }
  ct_scene_free(scene);
  ct_mesh_free(m);
}

static void bound(void)
{
  static const double POISSON[3] = {0.0, 0.3, 0.45};
  for (int flat = 0; flat < 2; flat++)
    for (int i = 0; i < 3; i++)
      for (int reduced = 0; reduced < 2; reduced++) {
        double nu = POISSON[i], hourglass = 2.4 * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        double share = reported(flat ? 4 : 3, reduced ? CT_KERNEL_REDUCED : CT_KERNEL_AUTO,
                                reduced ? hourglass : 0.0, nu, flat);
        // The true limit is known to 1e-7.
        tap_ok(share < 1.0 + 1e-6 && share > (nu < 0.4 ? 0.95 : 0.92),
               "step over the true limit, %s %s nu %g: %.4f", flat ? "plate" : "cube",
               reduced ? "one point" : "full", nu, share);
      }
}

int main(void)
{
  force();
  waves();
  dispersion();
  energy();
  contact();
  bits();
  fixed_point();
  bound();
  refusals();
  return tap_done();
}
