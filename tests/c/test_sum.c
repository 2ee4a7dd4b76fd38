/* Sums compared with exact integers and with an exact expansion; the same bits in any order. */
#include <libcontact/base.h>

#include "../../libcontact/src/base/stream.h"
#include "bodies.h"

#include <float.h>

enum { MOST = 3000 };

static int same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

static void shuffle(double *v, int n)
{
  for (int i = n - 1; i > 0; i--) {
    int j = pick(i + 1);
    double t = v[i];
    v[i] = v[j];
    v[j] = t;
  }
}

/* Exact sum as a list of numbers that do not overlap (Shewchuk's growing expansion); returns their
 * sum less `guess`. */
static double exact_minus(const double *v, int n, double guess)
{
  static double part[MOST + 1];
  int parts = 0;
  for (int i = -1; i < n; i++) {
    double x = i < 0 ? -guess : v[i];
    int kept = 0;
    for (int k = 0; k < parts; k++) {
      double y = part[k];
      if (fabs(x) < fabs(y)) {
        double t = x;
        x = y;
        y = t;
      }
      double high = x + y, low = y - (high - x);
      if (low != 0.0) part[kept++] = low;
      x = high;
    }
    part[kept++] = x;
    parts = kept;
  }
  double sum = 0.0;
  for (int k = 0; k < parts; k++) sum += part[k];
  return sum;
}

static void integers_are_exact(void)
{
  static double v[1000];
  int wrong = 0;
  for (int trial = 0; trial < 300; trial++) {
    int n = 1 + pick(1000), shift = pick(800) - 400;
    int64_t sum = 0;
    for (int i = 0; i < n; i++) {
      int64_t k =
          (int64_t)uniform(1125899906842624.0); // below 2^50, so that a thousand fit into 63 bits
      v[i] = ldexp((double)k, shift);
      sum += k;
    }
    wrong += !same(ct_sum(v, n), ldexp((double)sum, shift));
  }
  tap_ok(wrong == 0,
         "300 sums of up to 1000 integers times 2^k: the exact sum, rounded once (%d differ)",
         wrong);
}

/* Against lists of numbers that do not overlap (eq:order-free-sum). */
static void error_bound(void)
{
  static double v[MOST];
  double over = 0.0;
  for (int trial = 0; trial < 300; trial++) {
    int n = 2 + pick(MOST - 2), spread = 1 + pick(200);
    double top = 0.0;
    for (int i = 0; i < n; i++) {
      v[i] = ldexp(uniform(1.0), pick(spread));
      if (i % 2 && trial % 2)
        v[i] = -v[i - 1] * (1.0 + (pick(3) - 1) * DBL_EPSILON); // strong cancellation
      top = worst(top, v[i]);
    }
    double got = ct_sum(v, n),
           allowed = ldexp((double)n * n * n, -98) * top + 0.5 * DBL_EPSILON * fabs(got);
    over = worst(over, exact_minus(v, n, got) / allowed);
  }
  tap_ok(over <= 1.0,
         "300 sums with spread exponents and cancellation: error at most %.3g of count^3 2^-98 top "
         "+ ulp / 2",
         over);

  // Two numbers fix the grid and cancel, a thousand just below half the fine spacing are left and
  // lost: the worst case.
  double lost = ldexp(0.99, -78);
  for (int i = 0; i < 1025; i++) v[i] = lost;
  v[0] = 1.0;
  v[1] = -1.0;
  tap_close(ct_sum(v, 1025), 1023 * lost, 1025.0 * 1025.0 * ldexp(1025.0, -98),
            "numbers below the fine grid: off by no more than the bound");
}

static void order_does_not_matter(void)
{
  static double v[1000], negative[1000];
  int wrong = 0, odd = 0;
  for (int trial = 0; trial < 100; trial++) {
    int n = 1 + pick(1000);
    for (int i = 0; i < n; i++) v[i] = ldexp(uniform(1.0), pick(120) - 60);
    double sum = ct_sum(v, n);
    for (int k = 0; k < 10; k++) {
      shuffle(v, n);
      wrong += !same(ct_sum(v, n), sum);
    }
    for (int i = 0; i < n; i++) negative[i] = -v[i];
    odd += !same(ct_sum(negative, n), -sum);
  }
  tap_ok(wrong == 0, "1000 permutations: the same bits (%d differ)", wrong);
  tap_ok(odd == 0, "negated numbers: the negated bits (%d differ)", odd);

  // The ordinary sum does depend on the order, so the test above can see something.
  double left = 0.0, right = 0.0;
  for (int i = 0; i < 1000; i++) v[i] = ldexp(uniform(1.0), pick(40));
  for (int i = 0; i < 1000; i++) left += v[i], right += v[999 - i];
  tap_ok(left != right, "the plain sums of such numbers from left and from right differ");
}

/* Several sums at once over terms that come in pieces, some of them empty, or zero, or not finite:
 * the bits of ct_sum of all terms. */
static void pieces(void)
{
  static double v[4][1000];
  int wrong = 0, rounds = 0;
  for (int trial = 0; trial < 200; trial++) {
    int n = pick(1000);
    for (int i = 0; i < n; i++) {
      v[0][i] = ldexp(uniform(1.0), pick(120) - 60);
      v[1][i] = -0.0;
      v[2][i] = ldexp(uniform(1.0), pick(2 + trial) - trial);
      v[3][i] = i == n / 2 ? (trial % 2 ? NAN : INFINITY) : v[0][i];
    }
    ct_stream sums[4] = {{0}};
    while (ct_stream_again(sums, 4)) {
      rounds++;
      for (int first = 0, end; first < n; first = end) {
        end = first + pick(n - first + 1);
        for (int k = 0; k < 4; k++) ct_stream_add(&sums[k], &v[k][first], end - first);
      }
    }
    for (int k = 0; k < 4; k++) {
      double sum = ct_sum(v[k], n), got = ct_stream_sum(&sums[k]);
      wrong += !same(got, sum) && !(isnan(got) && isnan(sum));
    }
  }
  tap_ok(wrong == 0 && rounds > 350 && rounds <= 400,
         "200 lists that come in pieces, twice: the same bits (%d differ)", wrong);
}

/* Pieces of zeros are skipped: they change no sum, and other values among zeros are found. */
static void zeros(void)
{
  static double v[4 * CT_PIECE];
  int wrong = 0, lost = 0;
  for (int trial = 0; trial < 300; trial++) {
    int n = 1 + pick(4 * CT_PIECE), at = pick(n), kept = 0;
    double few[3], top = ldexp(1.0, pick(1600) - 800);
    for (int i = 0; i < n; i++) v[i] = pick(2) ? 0.0 : -0.0;
    // Two that cancel leave a small one, whose last bits show how fine the grids are.
    double large = top * uniform(1.0), three[3] = {large, -large, ldexp(top, -45) * uniform(1.0)};
    for (int i = 0; i < 3 && at + i < n; i++) few[kept++] = v[at + i] = three[i];
    // As the sum of a row of the ledger begins: with the grids of the one before.
    ct_stream sum = {.grid = {0}};
    for (int again = 0; again < 2; again++) {
      sum = (ct_stream){.grid = sum.grid};
      for (int32_t first, end; ct_stream_piece(&sum, 1, n, &first, &end);)
        ct_stream_add(&sum, end <= at || first >= at + 3 ? NULL : &v[first], end - first);
      double got = ct_stream_sum(&sum);
      wrong += fabs(exact_minus(few, kept, got)) > DBL_EPSILON * fabs(got) + ldexp(top, -70) ||
               !same(got, ct_sum(v, n));
    }
    lost += ct_is_zero(v, n);
    v[at] = NAN;
    lost += ct_is_zero(v, n) || !isnan(ct_sum(v, n));
    for (int i = 0; i < n; i++) v[i] = pick(2) ? 0.0 : -0.0;
    lost += !ct_is_zero(v, n);
  }
  tap_ok(wrong == 0 && lost == 0,
         "300 lists of zeros with a few numbers: their sum (%d wrong), and none is lost (%d)",
         wrong, lost);
}

/* The sum over nodes of m x · y, compared with the same terms written out. */
static void products(void)
{
  static double m[700], x[2100], y[2100], terms[700];
  int wrong = 0;
  for (int n = 0; n <= 700; n += 70) {
    for (int i = 0; i < n; i++) m[i] = 1.0 + uniform(0.5);
    for (int i = 0; i < 3 * n; i++) x[i] = uniform(1.0), y[i] = uniform(1.0);
    for (int with = 0; with < 2; with++) {
      for (int i = 0; i < n; i++) {
        const double *a = &x[3 * i], *b = &y[3 * i];
        terms[i] = (with ? m[i] : 1.0) * ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]);
      }
      wrong += !same(ct_sum_product(n, with ? m : NULL, x, y), ct_sum(terms, n));
    }
  }
  tap_ok(wrong == 0, "m x . y summed over nodes: the bits of the sum of its terms (%d differ)",
         wrong);
}

static void special_cases(void)
{
  double cancel[3] = {1e16, 1.0, -1e16}, bad[3] = {1.0, NAN, 2.0},
         endless[3] = {1.0, INFINITY, -INFINITY};
  double huge[2] = {DBL_MAX, DBL_MAX}, tiny[100], zeros[3] = {0.0, -0.0, 0.0}, one = -0.1;
  tap_ok(ct_sum(cancel, 3) == 1.0, "1e16 + 1 - 1e16 = 1");
  double nothing[3] = {0.0, NAN, 0.0};
  tap_ok(isnan(ct_sum(bad, 3)) && isnan(ct_sum(nothing, 3)) && isnan(ct_sum(&bad[1], 1)),
         "a NaN gives NaN, among numbers, among zeros, alone");
  tap_ok(isnan(ct_sum(endless, 3)), "infinities give NaN");
  tap_ok(isnan(ct_sum(huge, 2)), "overflow gives NaN");
  tap_ok(ct_sum(NULL, 0) == 0.0 && ct_sum(cancel, 0) == 0.0, "an empty sum is 0");
  tap_ok(ct_sum(zeros, 3) == 0.0, "zeros add up to 0");
  tap_ok(same(ct_sum(&one, 1), -0.1), "one number is its own sum");
  for (int i = 0; i < 100; i++) tiny[i] = ldexp(1.0, -1074);
  tap_ok(ct_sum(tiny, 100) == 100 * ldexp(1.0, -1074), "the smallest numbers are not lost");
}

int main(void)
{
  integers_are_exact();
  error_bound();
  order_does_not_matter();
  pieces();
  zeros();
  products();
  special_cases();
  return tap_done();
}
