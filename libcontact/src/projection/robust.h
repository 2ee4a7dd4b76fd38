/* The robust search for the closest points, for as many pairs of face and point as there are lanes.
 * Lanes cannot take different branches: if one of them needs a step of its own, all compute it, and
 * the others keep their values. With width 1 this is an ordinary search. */
#include "secant.h"

/* Steps, their ends, and the decrease that the model predicts. */
typedef struct steps {
  real s[2], xi[2], fall;
} steps;

/* Quadratic model q(s) = g.s + s.H s / 2 of f about an iterate, on the steps that stay in the trust
 * region and on the face: low <= s <= high and s_1 + s_2 <= sum. */
typedef struct model {
  int triangular;
  real g[2], H[3], low[2], high[2], sum;
} model;

/* Ends of descents. */
typedef struct ends {
  real xi[2], f, d[3], status;
} ends;

/* Their costs. */
typedef struct counts {
  mask evaluations, iterations;
} counts;

/* Descents from closer points that a proof finds. */
enum { RESTARTS = 8 };

/* Sample points: the corners, the mid-sides, the centre. */
static const double QUADRILATERAL[9][2] = {{-1, -1}, {1, -1}, {1, 1},  {-1, 1}, {0, -1},
                                           {1, 0},   {0, 1},  {-1, 0}, {0, 0}};
static const double TRIANGLE[7][2] = {
    {0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}, {1.0 / 3, 1.0 / 3}};

PART real model_value(const model *q, const real s[2])
{
  // -- Value of the model (eq:robust-model)
  real linear = q->g[0] * s[0] + q->g[1] * s[1];
  return linear +
         (0.5 * (q->H[0] * (s[0] * s[0]) + q->H[1] * (s[1] * s[1])) + q->H[2] * (s[0] * s[1]));
}

/* Keep s in `best` if it is allowed and lower. */
PART void model_keep(const model *q, const real s[2], mask allowed, real *value, real best[2])
{
  real v = model_value(q, s);
  mask lower = allowed & (v < *value);
  *value = pick(lower, v, *value);
  for (int a = 0; a < 2; a++) best[a] = pick(lower, s[a], best[a]);
}

/* Lowest point of the model on the line s_axis = bound. */
PART void model_side(const model *q, int axis, real bound, real *value, real best[2])
{
  int other = 1 - axis;
  real low = q->low[other], high = least(q->high[other], q->sum - bound), s[2];
  mask open = low <= high;
  s[axis] = bound;
  // -- Root of the slope along a side, or its two ends (eq:robust-side)
  real slope = q->g[other] + q->H[2] * bound, curvature = q->H[other];
  mask up = curvature > 0, both = open & not(up);
  s[other] = pick(up, least(most(-slope / curvature, low), high), low);
  model_keep(q, s, open, value, best);
  if (!any(both)) return;
  s[other] = high;
  model_keep(q, s, both, value, best);
}

/* The same on the slanted side of a triangle, s_1 + s_2 = sum, with u = (s_1 - s_2) / 2 along it.
 */
PART void model_slant(const model *q, real *value, real best[2])
{
  real half = 0.5 * q->sum, low = most(q->low[0] - half, half - q->high[1]),
       high = least(q->high[0] - half, half - q->low[1]);
  // -- Root of the slope along the slanted side, or its two ends (eq:robust-slant)
  real slope = (q->g[0] - q->g[1]) + half * (q->H[0] - q->H[1]),
       curvature = (q->H[0] + q->H[1]) - 2 * q->H[2];
  real u = pick(curvature > 0, least(most(-slope / curvature, low), high), low);
  for (int end = 0; end < 2; end++) {
    real s[2] = {half + u, half - u};
    model_keep(q, s, low <= high, value, best);
    u = pick(curvature > 0, u, high);
  }
}

/* Lowest point s of the model on the boundary of the allowed steps; returns q(s) <= 0. */
PART real model_minimum(const model *q, real s[2])
{
  // -- The lowest point lies on a side (eq:robust-model)
  real value = every(0);
  s[0] = s[1] = value;
  for (int axis = 0; axis < 2; axis++) {
    model_side(q, axis, q->low[axis], &value, s);
    model_side(q, axis, q->high[axis], &value, s);
  }
  if (q->triangular) model_slant(q, &value, s);
  return value;
}

/* The model of f about the iterate, limited to the face and to the trust region of half-width
 * `radius`. */
PART void model_about(model *q, const iterates *at, int triangular, real radius)
{
  double low = triangular ? 0 : -1;
  for (int a = 0; a < 2; a++) {
    q->g[a] = at->g[a];
    q->low[a] = most(low - at->xi[a], -radius);
    q->high[a] = least(1 - at->xi[a], radius);
  }
  for (int i = 0; i < 3; i++) q->H[i] = at->H[i];
  q->triangular = triangular;
  q->sum = triangular ? most(1 - (at->xi[0] + at->xi[1]), every(0)) : every(HUGE_VAL);
}

/* Move xi onto the face, and onto its boundary if only rounding separates them. */
PART void snap(int triangular, real xi[2])
{
  const double low = triangular ? 0 : -1, edge = 1 - 2 * DBL_EPSILON;
  for (int a = 0; a < 2; a++) {
    xi[a] = pick(xi[a] > edge, every(1), xi[a]);
    xi[a] = pick(xi[a] < low + 2 * DBL_EPSILON, every(low), xi[a]);
  }
  if (!triangular) return;
  mask beyond = xi[0] + xi[1] > edge, second = xi[1] > xi[0];
  real excess = most(0.5 * (xi[0] + xi[1] - 1), every(0)),
       small = most(least(xi[0], xi[1]) - excess, every(0)), large = 1 - small;
  xi[0] = pick(beyond, pick(second, small, large), xi[0]);
  xi[1] = pick(beyond, pick(second, large, small), xi[1]);
}

/* Is xi on the face, and not on its boundary nor within rounding of it? */
PART mask is_inside(int triangular, const real xi[2])
{
  const double edge = 1 - 2 * DBL_EPSILON;
  if (!triangular) return most(absolute(xi[0]), absolute(xi[1])) <= edge;
  return (least(xi[0], xi[1]) >= 2 * DBL_EPSILON) & (xi[0] + xi[1] <= edge);
}

/* Newton's step, cut to the face if it is a first guess. Returns the lanes in which the model is
 * convex and the step allowed. */
PART mask newton_step(const iterates *at, int triangular, int guess, real radius, steps *to)
{
  // -- Newton's step (eq:projection-newton)
  real determinant = at->H[0] * at->H[1] - at->H[2] * at->H[2], inverse = 1 / determinant;
  to->s[0] = (at->H[2] * at->g[1] - at->H[1] * at->g[0]) * inverse;
  to->s[1] = (at->H[2] * at->g[0] - at->H[0] * at->g[1]) * inverse;
  for (int a = 0; a < 2; a++) to->xi[a] = at->xi[a] + to->s[a];
  to->fall = -0.5 * (at->g[0] * to->s[0] + at->g[1] * to->s[1]);
  mask convex = (at->H[0] > 0) & (determinant > 0), inside = is_inside(triangular, to->xi);
  if (!guess) return convex & (most(absolute(to->s[0]), absolute(to->s[1])) <= radius) & inside;
  // -- A first guess is cut to the face, and good if f does not rise (eq:robust-guess)
  if (any(not(inside))) snap(triangular, to->xi);
  for (int a = 0; a < 2; a++) to->s[a] = to->xi[a] - at->xi[a];
  to->fall = every(0);
  return convex;
}

/* The steps to the lowest points of the models: Newton's if it is allowed, else the one to the
 * boundary of the allowed steps. */
PART steps next_step(const iterates *at, int triangular, int guess, real radius, mask active)
{
  steps to;
  model q;
  real s[2], xi[2];
  mask newton = newton_step(at, triangular, guess, radius, &to);
  if (!any(active & not(newton))) return to;
  model_about(&q, at, triangular, radius);
  to.fall = pick(newton, to.fall, -model_minimum(&q, s));
  for (int a = 0; a < 2; a++) xi[a] = at->xi[a] + s[a];
  snap(triangular, xi);
  for (int a = 0; a < 2; a++)
    to.s[a] = pick(newton, to.s[a], s[a]), to.xi[a] = pick(newton, to.xi[a], xi[a]);
  return to;
}

/* Does rounding of the gradient move the closest point xi by less than the tolerance, along the
 * directions that are free on the face? H and the tangents are those of the last evaluation. */
PART mask resolved(const patches *patch, const iterates *last, const real xi[2], real f,
                   real tolerance)
{
  int triangular = ct_is_triangular(patch->kind);
  const real *H = last->H;
  double low = triangular ? 0 : -1;
  real rounding = 4 * DBL_EPSILON * (root(f) + patch->size),
       length[2] = {root(last->square[0]), root(last->square[1])};
  // -- How far rounding moves the closest point (eq:robust-resolved)
  real twist = absolute(H[2]), first = H[1] * length[0] + twist * length[1],
       second = H[0] * length[1] + twist * length[0];
  real move = most(first, second), divisor = H[0] * H[1] - H[2] * H[2];
  if (triangular) {
    mask slant = xi[0] + xi[1] >= 1;
    move = pick(slant, length[0] + length[1], move);
    divisor = pick(slant, (H[0] + H[1]) - 2 * H[2], divisor);
  }
  mask bound[2];
  for (int a = 0; a < 2; a++) bound[a] = (xi[a] <= low) | (xi[a] >= 1);
  for (int a = 1; a >= 0; a--) {
    move = pick(bound[1 - a], length[a], move);
    divisor = pick(bound[1 - a], H[a], divisor);
  }
  return (bound[0] & bound[1]) | (rounding * move <= tolerance * divisor);
}

/* Is the face so nearly plane, relative to an iterate near its closest point, that f has only one
 * valley? Its nonlinear part is bounded by its second derivatives. */
PART mask is_mild(const patches *patch, const iterates *at)
{
  const real(*c)[3] = patch->c;
  real bent[3];
  // -- Bending of the face (eq:robust-bend)
  for (int k = 0; k < 3; k++) {
    bent[k] = 0.5 * (c[3][k] * c[3][k]);
    if (patch->kind == CT_Q4) continue;
    bent[k] +=
        (c[4][k] * c[4][k] + c[5][k] * c[5][k]) + 2 * (c[6][k] * c[6][k] + c[7][k] * c[7][k]);
  }
  // -- Relative to the tangents: the component of the shorter one perpendicular to the longer one
  // (eq:robust-straight)
  real area = at->square[0] * at->square[1] - at->square[2] * at->square[2],
       t2 = area / most(at->square[0], at->square[1]);
  // -- Compare the nonlinear part with the linear one (eq:robust-mild)
  return ((bent[0] + bent[1]) + bent[2]) * (t2 + 2 * at->f) <= CT_MILD * (t2 * t2);
}

/* Report an iterate to the caller's trace. */
RARE void show(const ct_project_options *options, real x, real y, real f)
{
  double xi[2] = {lane(x, 0), lane(y, 0)};
  options->trace(xi, lane(f, 0), options->user);
}

/* Copy some lanes of the numbers of a struct. */
PART void take(void *to, const void *from, size_t size, mask m)
{
  real *old = to;
  const real *new = from;
  for (size_t i = 0; i < size / sizeof(real); i++) old[i] = pick(m, new[i], old[i]);
}

/* State of a descent besides its iterate. `stalled` is the length of the last step whose decrease
 * was hidden by rounding, `resolution` the tolerance of the closest point once it has converged. */
typedef struct region {
  real radius, before, stalled, resolution, status;
  mask active, settled;
} region;

/* Treat the steps without the predicted decrease of f; returns the lanes that take them all the
 * same. A step whose decrease rounding hides is taken if steps become shorter; otherwise the
 * descent ends. */
PART mask accept_hidden(const patches *patch, real f, real fall, real length, mask refused,
                        region *r)
{
  // -- Take the step if f falls, or, where rounding hides that, if the steps get shorter
  // (eq:robust-accept)
  mask hidden = refused & (fall <= noise(patch, f)), stop = hidden & (length > 0.5 * r->stalled),
       taken = hidden & not(stop);
  r->stalled = pick(taken, length, r->stalled);
  r->status = pick(stop, every(CT_NOT_CERTIFIED), r->status);
  r->active &= not(stop);
  r->radius = pick(refused & not(hidden), 0.25 * length, r->radius);
  return taken;
}

/* Descend from xi to minima of f on the faces, to within the tolerance, in the lanes that are
 * `active`. Returns the lanes in which the iterate of number `probe` shows that the face is not
 * mild; then `out` is this iterate. */
CLONED mask descend(const patches *patch, const ct_project_options *options, double sought,
                    const real xi[2], int probe, mask active, counts *count, ends *out)
{
  int triangular = ct_is_triangular(patch->kind),
      limit = options->iteration_limit > 0 ? options->iteration_limit : 100;
  double half_width = ct_patch_half_width(patch->kind), tolerance = sought * half_width,
         small = 4 * DBL_EPSILON * half_width;
  real wide = every(half_width), none = every(0);
  region r = {wide, wide, every(HUGE_VAL), none, every(CT_ITERATION_LIMIT), active, none != none};
  mask rough = r.settled;
  iterates at, trial;
  at.xi[0] = xi[0], at.xi[1] = xi[1];
  evaluate(patch, &at);
  count->evaluations += masked(active, 1);
  for (int i = 0; i < limit; i++) {
    if (WIDTH == 1 && options->trace != NULL) show(options, at.xi[0], at.xi[1], at.f);
    if (i == probe) {
      rough = r.active & not(is_mild(patch, &at));
      r.active &= not(rough);
      if (!any(r.active)) break;
    }
    // -- Step to the lowest point of the model (eq:robust-model)
    steps to = next_step(&at, triangular, i < probe, r.radius, r.active);
    real length = most(absolute(to.s[0]), absolute(to.s[1])), square = length * length;
    // -- Done if the step is small, or the next one would be: then evaluate d only
    if (i >= probe) {
      // (eq:robust-quadratic)
      mask done =
          r.active & ((length <= tolerance) |
                      ((square <= small) & (square * length <= small * (r.before * r.before))));
      for (int a = 0; a < 2; a++) at.xi[a] = pick(done, to.xi[a], at.xi[a]);
      r.resolution =
          pick(done & (length < r.radius), every(options->tolerance * half_width), r.resolution);
      r.settled |= done;
      r.active &= not(done);
      if (!any(r.active)) break;
    }
    trial.xi[0] = to.xi[0], trial.xi[1] = to.xi[1];
    evaluate(patch, &trial);
    count->evaluations += masked(r.active, 1);
    // -- Take the step if f falls, and widen the trust region, or narrow it (eq:robust-accept)
    mask taken = r.active & (at.f - trial.f >= 0.1 * to.fall), refused = r.active & not(taken);
    if (any(refused)) taken |= accept_hidden(patch, at.f, to.fall, length, refused, &r);
    r.radius = pick(taken & (length >= r.radius), least(2 * r.radius, 2 * wide), r.radius);
    r.before = pick(taken, length, r.before);
    take(&at, &trial, sizeof at, taken);
    count->iterations += masked(r.active, 1);
    if (!any(r.active)) break;
  }
  for (int a = 0; a < 2; a++) out->xi[a] = at.xi[a];
  out->f = value(patch, out->xi, out->d);
  mask good = resolved(patch, &at, out->xi, out->f, r.resolution);
  out->status = pick(r.settled, pick(good, every(CT_OK), every(CT_NOT_CERTIFIED)), r.status);
  return limit > probe ? rough : r.active;
}

/* The samples that are not higher than their neighbours. Neighbours of corners are their two
 * mid-sides, those of mid-sides two corners and two mid-sides; the centre is a neighbour of all. */
PART void valleys(const real f[9], int corners, mask valley[9])
{
  const real *side = f + corners, centre = f[2 * corners];
  mask lowest = centre == centre;
  for (int j = 0; j < corners; j++) {
    int after = (j + 1) % corners, before = (j + corners - 1) % corners;
    real sides = least(side[j], side[before]),
         around = least(least(f[j], f[after]), least(side[after], side[before]));
    valley[j] = f[j] <= least(sides, centre);
    valley[corners + j] = side[j] <= least(around, centre);
    lowest &= centre <= least(f[j], side[j]);
  }
  valley[2 * corners] = lowest;
}

/* The lanes in which the end `a` is better than `b`: lower, or equally low and nearer the centre. A
 * mirror does not change the result. */
PART mask is_better(const ends *a, const ends *b)
{
  real ra = a->xi[0] * a->xi[0] + a->xi[1] * a->xi[1],
       rb = b->xi[0] * b->xi[0] + b->xi[1] * b->xi[1];
  mask better = a->f < b->f, equal = a->f == b->f;
  better |= equal & (ra < rb), equal &= ra == rb;
  for (int k = 0; k < 2; k++) {
    real xa = absolute(a->xi[k]), xb = absolute(b->xi[k]);
    better |= equal & (xa < xb), equal &= xa == xb;
  }
  return better | (equal & (a->status < b->status));
}

/* Descend from the marked samples, each lane from its own, those with high numbers first; keep the
 * best end. */
RARE void descend_from(mask sample[9], const patches *patch, const ct_project_options *options,
                       double sought, counts *count, ends *best)
{
  const double (*at)[2] = ct_is_triangular(patch->kind) ? TRIANGLE : QUADRILATERAL;
  int samples = ct_is_triangular(patch->kind) ? 7 : 9;
  for (;;) {
    ends found;
    real xi[2] = {every(0), every(0)};
    mask active = xi[0] != xi[0];
    for (int i = samples - 1; i >= 0; i--) {
      mask mine = sample[i] & not(active);
      for (int a = 0; a < 2; a++) xi[a] = pick(mine, every(at[i][a]), xi[a]);
      active |= mine;
      sample[i] &= not(mine);
    }
    if (!any(active)) return;
    descend(patch, options, sought, xi, -1, active, count, &found);
    take(best, &found, sizeof found, active & ((best->f == HUGE_VAL) | is_better(&found, best)));
  }
}

/* f at the sample points; returns the lowest. */
PART real sample(const patches *patch, int samples, real f[9])
{
  const double (*at)[2] = samples == 9 ? QUADRILATERAL : TRIANGLE;
  real d[3], lowest = every(HUGE_VAL);
  for (int i = 0; i < samples; i++) {
    // -- Sample the face
    real xi[2] = {every(at[i][0]), every(at[i][1])};
    f[i] = value(patch, xi, d); // (eq:robust-samples)
    lowest = least(lowest, f[i]);
  }
  return lowest;
}

/* The face of one lane. */
RARE ct_patch face_of(const patches *patch, int l)
{
  ct_patch own = {.kind = patch->kind, .size = lane(patch->size, l)};
  for (int j = 0; j < 8; j++)
    for (int k = 0; k < 3; k++) own.c[j][k] = lane(patch->c[j][k], l);
  return own;
}

/* Prove by cuts of the face that no point in lane `l` is closer, and descend from each closer point
 * that this finds. Returns 0 without a proof. */
RARE int prove_lane(int l, const patches *patch, const ct_project_options *options, double sought,
                    counts *count, ends *best)
{
  ct_patch own = face_of(patch, l);
  ct_closest cuts = {{0, 0}, {0, 0, 0}, 0, 0, 0};
  ct_outcome outcome = CT_CLOSER;
  mask mine = masked(best->f == best->f, 0);
  set(&mine, l, whole(not(mine), l));
  for (int i = 0; i < RESTARTS && outcome == CT_CLOSER; i++) {
    ends found;
    double xi[2] = {lane(best->xi[0], l), lane(best->xi[1], l)};
    outcome = ct_proof_by_cuts(&own, xi, &cuts);
    if (outcome != CT_CLOSER) break;
    real from[2] = {every(xi[0]), every(xi[1])};
    descend(patch, options, sought, from, -1, mine, count, &found);
    take(best, &found, sizeof found, mine & is_better(&found, best));
  }
  set(&count->evaluations, l, whole(count->evaluations, l) + cuts.evaluations);
  return outcome == CT_PROVEN;
}

/* The wanted lanes in which it is proved that no point of the face is closer than the best end: by
 * the closest point at once, or else by cuts, one lane at a time. */
RARE mask proven_lanes(const patches *patch, const ct_project_options *options, double sought,
                       mask wanted, counts *count, ends *best)
{
  cell face = whole_face(ct_is_triangular(patch->kind));
  proof p;
  base closest;
  base_at(patch, best->xi, &closest);
  count->evaluations += masked(wanted, 1);
  mask possible = wanted & proof_about(&p, patch, CT_PROVABLE, closest.distance),
       proven = possible & (not(p.target > 0) | proven_from_closest(&p, &closest, &face)),
       doubtful = possible & not(proven);
  for (int l = 0; l < WIDTH && any(doubtful); l++)
    if (whole(doubtful, l) && prove_lane(l, patch, options, sought, count, best))
      set(&proven, l, whole(doubtful, l));
  return proven;
}

/* The search on faces that are not mild, from the iterate `probe`. */
RARE void search_samples(const patches *patch, const ct_project_options *options, int warm,
                         const ends *probe, mask rough, counts *count, ends *best)
{
  int corners = ct_is_triangular(patch->kind) ? 3 : 4, samples = 2 * corners + 1;
  real f[9], lowest = sample(patch, samples, f);
  double sought = fmin(options->tolerance, CT_PROVABLE);
  mask valley[9], from[9], again = rough & (lowest != lowest);
  count->evaluations += masked(rough, samples);
  // -- Go on from the given start unless a sample is lower (eq:robust-noise)
  if (warm) again = rough & (probe->f <= lowest + noise(patch, lowest));
  if (any(again)) descend(patch, options, options->tolerance, probe->xi, -1, again, count, best);
  mask cold = rough & not(again);
  if (!any(cold)) return;
  // -- Else begin at every sample that is a valley; the lowest end wins, and of equal ones the one
  // nearer the centre
  valleys(f, corners, valley);
  for (int i = 0; i < samples; i++) from[i] = cold & valley[i];
  best->f = pick(cold, every(HUGE_VAL), best->f);
  descend_from(from, patch, options, sought, count, best);
  // -- Search again in lanes without a proof (eq:certified-bound)
  mask hidden = cold & not(proven_lanes(patch, options, sought, cold, count, best));
  if (!any(hidden)) return;
  for (int i = 0; i < samples; i++) from[i] = hidden & not(valley[i]);
  descend_from(from, patch, options, sought, count, best);
  best->status = pick(hidden, every(CT_NOT_CERTIFIED), best->status);
}

/* The closest points in the lanes that are active, from the given starts where it is warm. */
PART void search(const patches *patch, const ct_project_options *options, int warm,
                 const real start[2], mask active, counts *count, ends *found)
{
  real centre = every(ct_patch_centre(patch->kind)), from[2] = {centre, centre};
  ends best;
  if (warm) {
    from[0] = start[0], from[1] = start[1];
    snap(ct_is_triangular(patch->kind), from);
  }
  // -- Search a mild face from one place, any other from many (eq:robust-mild)
  mask rough =
      descend(patch, options, options->tolerance, from, warm ? 0 : 1, active, count, found);
  if (!any(rough)) return;
  best = *found;
  search_samples(patch, options, warm, found, rough, count, &best);
  take(found, &best, sizeof best, rough);
}
