/* Closest points on quadrilaterals of four nodes from starts near them, WIDTH pairs at a time: the
 * steps of `descend` where all of them are Newton's. The other lanes are left to the search. A
 * source that includes this header defines NEAR, the kernel's name. */

/* Take Newton's steps with xi to a minimum of f in the lanes in which the face is mild and f falls
 * in each step, with the bits of `descend`; returns the lanes that arrive. */
PART mask arrive(const patches *patch, const ct_project_options *options, real xi[2])
{
  enum { STEPS = 6 };
  const double tolerance = options->tolerance, small = 4 * DBL_EPSILON;
  const real wide = every(1);
  iterates at, trial;
  at.xi[0] = xi[0], at.xi[1] = xi[1];
  evaluate(patch, &at);
  real before = every(HUGE_VAL);
  mask active = is_mild(patch, &at), settled = active & not(active);
  for (int i = 0; i < STEPS && any(active); i++) {
    steps to;
    active &= newton_step(&at, 0, 0, wide, &to);
    const real length = most(absolute(to.s[0]), absolute(to.s[1])), square = length * length;
    // -- Done if the step is small, or the next one would be (eq:robust-quadratic)
    const mask done =
        active & ((length <= tolerance) |
                  ((square <= small) & (square * length <= small * (before * before))));
    for (int a = 0; a < 2; a++) at.xi[a] = pick(done, to.xi[a], at.xi[a]);
    settled |= done;
    active &= not(done);
    if (!any(active)) break;
    trial.xi[0] = to.xi[0], trial.xi[1] = to.xi[1];
    evaluate(patch, &trial);
    // -- Take the step if f falls (eq:robust-accept)
    active &= at.f - trial.f >= 0.1 * to.fall;
    before = pick(active, length, before);
    take(&at, &trial, sizeof at, active);
  }
  for (int a = 0; a < 2; a++) xi[a] = at.xi[a];
  return settled;
}

/* The results of the pairs from lane `first` on; returns one bit for each lane that has them. */
PART unsigned near_pairs(const double *nodes, const double *points, const double *start,
                         const ct_project_options *options, double *xi, double *normal, int first)
{
  real v[8][3], p[3], n[3], at[2];
  patches patch;
  load_pairs(4, nodes, points, first, v, p);
  // Four times the polynomial has the same steps and normals, to the bit.
  corner_sums((const real(*)[3])v, p, patch.c);
  patch.kind = CT_Q4;
  for (int a = 0; a < 2; a++) at[a] = load(start + 8 * a + first);
  snap(0, at);
  mask good = arrive(&patch, options, at);
  good &= normal_at(&patch, at, n);
  for (int a = 0; a < 2; a++) store(xi + 8 * a + first, at[a]);
  for (int k = 0; k < 3; k++) store(normal + 8 * k + first, n[k]);
  return (unsigned)any(good) << first;
}

#if WIDTH > 1
__attribute__((target(TARGET)))
#endif
unsigned NEAR(const double *nodes, const double *points, const double *start,
              const ct_project_options *options, double *xi, double *normal)
{
  unsigned bits = 0;
  for (int first = 0; first < 8; first += WIDTH)
    bits |= near_pairs(nodes, points, start, options, xi, normal, first);
  return bits;
}
