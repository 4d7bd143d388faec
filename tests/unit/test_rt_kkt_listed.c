/* lag_kkt_listed: bodies in a row, each coupled to the next or not, in closed form: those coupled have the acceleration
 * of their forces over their masses. What the list leaves out holds NaN. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#define LAG_REAL double
#include "lag_kkt.h"

enum { N = 40, MOST = N, SIZE = 2 * N * N + 2 * MOST * N + MOST * MOST + 3 * N + 10 * MOST };

static double mass(int i) { return 1 + i % 7; }
static double force(int i) { return sin(i * i); }

/* Couplings 1..m, the last of them a copy of the first if `twice`; every `open`-th is open. */
static void solves(int m, int twice, int open, int banded) {
  unsigned at[4 * N];
  double *w = malloc(SIZE * sizeof *w), *A = w + N * N, *x = A + m * N, *l = x + N;
  int count = 0;
  for (int i = 0; i < SIZE; i++) w[i] = NAN;
  for (int i = 0; i < N; i++) {
    w[i * N + i] = mass(i);
    at[count++] = (unsigned)(i * N + i);
    x[i] = force(i);
  }
  for (int k = 0; k < m; k++) {
    int of = twice && k == m - 1 ? 0 : k, closed = !open || of % open != 1;
    A[k * N + of] = closed ? -1 : 0;
    A[k * N + of + 1] = closed ? 1 : 0;
    at[count++] = (unsigned)(N * N + k * N + of);
    at[count++] = (unsigned)(N * N + k * N + of + 1);
    l[k] = 0;
  }
  at[count++] = (unsigned)(N * N + m * N); /* behind the matrix, as of the right-hand side */
  assert_true(lag_kkt_listed(N, m, 0, at, 1, count, w));
  assert_int_equal(isnan(w[1]) != 0, banded); /* solved within a band, what is not listed is not read */
  for (int from = 0, end; from < N; from = end) {
    double f = force(from), all = mass(from), pressed = 0;
    for (end = from + 1; end < N && !(open && (end - 1) % open == 1); end++) f += force(end), all += mass(end);
    for (int i = from; i < end; i++) {
      assert_true(fabs(x[i] - f / all) < 1e-13); /* 40 forces of size 1 */
      pressed += force(i) - mass(i) * f / all;
      if (!twice && i + 1 < end) assert_true(fabs(l[i] - pressed) < 1e-12);
    }
  }
  for (int k = 0; k < m && open; k++)
    if (k % open == 1) assert_true(l[k] == 0);
  if (twice) assert_true(fabs(l[0] - l[m - 1]) < 1e-12); /* of least norm */
  free(w);
}

static void test_band(void **state) { (void)state, solves(N - 1, 0, 0, 1), solves(N - 1, 0, 5, 1); }
static void test_few_closed(void **state) { (void)state, solves(N - 1, 0, 2, 0), solves(N - 1, 0, 3, 1); }
static void test_dependent(void **state) { (void)state, solves(N, 1, 0, 0); }

/* Bodies in glued pairs, and a sum over all bodies with factors pair/N, twice if `twice`, that is to accelerate by 1:
 * with l its multiplier, a pair of mass m, force f and factor 2 a moves by (f + 2 a l)/m. The first body is without
 * mass if `light`, its pair held together by nothing but the sum: not by the band without the sum. */
static void holds_sums(int twice, int light, int banded) {
  enum { ALL = 100, PAIRS = ALL / 2 };
  const int m = PAIRS + 1 + twice, size = 2 * ALL * ALL + 2 * m * ALL + m * m + 3 * ALL + 10 * m;
  unsigned at[9 * ALL];
  double *w = malloc((size_t)size * sizeof *w), *A = w + ALL * ALL, *x = A + m * ALL, *l = x + ALL;
  double square = 0, along = 0;
  int count = 0;
  for (int i = 0; i < size; i++) w[i] = NAN;
  for (int i = 0; i < ALL; i++) {
    w[i * ALL + i] = light && i < 2 ? 0 : mass(i);
    at[count++] = (unsigned)(i * ALL + i);
    x[i] = light && i < 2 ? 0 : force(i);
  }
  for (int k = 0; k < PAIRS; k++) {
    A[k * ALL + 2 * k] = -1, A[k * ALL + 2 * k + 1] = 1, l[k] = 0;
    at[count++] = (unsigned)(ALL * ALL + k * ALL + 2 * k), at[count++] = (unsigned)(ALL * ALL + k * ALL + 2 * k + 1);
    const double a = 2. * (k + 1) / ALL, inertia = mass(2 * k) + mass(2 * k + 1), f = force(2 * k) + force(2 * k + 1);
    if (!light || k) square += a * a / inertia, along += a * f / inertia;
  }
  for (int k = PAIRS; k < m; k++) {
    l[k] = 1;
    for (int i = 0; i < ALL; i++)
      A[k * ALL + i] = (i / 2 + 1.) / ALL, at[count++] = (unsigned)(ALL * ALL + k * ALL + i);
  }
  assert_true(lag_kkt_listed(ALL, m, 0, at, 1, count, w));
  assert_int_equal(isnan(w[1]) != 0, banded);
  const double sum = light ? 0 : (1 - along) / square; /* the pair without mass moves freely, and does the sum's part */
  double done = 0;
  for (int i = 0; i < ALL; i++) {
    int k = i / 2;
    double a = 2. * (k + 1) / ALL, f = force(2 * k) + force(2 * k + 1), inertia = mass(2 * k) + mass(2 * k + 1);
    if (light && !k) continue;
    assert_true(fabs(x[i] - (f + a * sum) / inertia) < 1e-12); /* a pair's l: sums of 100 forces of size 1 */
    done += x[i] * a / 2;
  }
  if (light) assert_true(fabs(x[0] - x[1]) < 1e-12 && fabs(x[0] * 2 / ALL + done - 1) < 1e-12);
  for (int k = PAIRS; k < m; k++) assert_true(fabs(l[k] * (1 + twice) - sum) < 1e-11); /* of least norm */
  free(w);
}

static void test_border(void **state) { (void)state, holds_sums(0, 0, 1), holds_sums(1, 0, 0), holds_sums(0, 1, 0); }

/* A telescope without mass on a door: its length and angle follow the door, x = f/I, whatever in A passes 0. */
static void test_without_mass(void **state) {
  (void)state;
  const double inertia = 2, f = 3, arm = 0.3, length = 0.28;
  for (double unit = 1; unit < 1e7; unit *= 100) /* of the first constraint */
    for (double small = 1; small > 1e-18; small /= 2)
      for (int turned = 0; turned < 2; turned++) {
        double s = turned ? small * 0.7 : 0.6, c = sqrt(1 - s * s), e = turned ? 0.4 : small, x = f / inertia;
        double w[SIZE] = {inertia}, r0 = -e * x, r1 = arm * x, along = c * r0 + s * r1, across = c * r1 - s * r0;
        w[9] = e * unit, w[10] = c * unit, w[11] = -s * length * unit;
        w[12] = -arm, w[13] = s, w[14] = c * length;
        w[15] = f;
            assert_true(lag_kkt(3, 2, 1, w));
        double worst = unit > 100 ? 1e-3 : 1e-9; /* units far apart cost digits, by scales that a small part turns */
        assert_true(fabs(w[15] - x) < worst);
        assert_true(fabs(w[16] - along) < worst && fabs(w[17] - across / length) < worst);
      }
}

/* Scales by lists of elements are those of the full matrices: random sparse M and A of sizes far apart, some
 * coordinates without inertia. */
static void test_scales(void **state) {
  (void)state;
  enum { n = 12, m = 4, ROWS = m + n, ALL = ROWS * n };
  for (unsigned turn = 0, seed = 1; turn < 200; turn++) {
    double x[ROWS][n] = {{0}}, size[ALL], few[ALL], top[ROWS], scale[ROWS], listed[ROWS];
    int first[ROWS + 1], col[ALL], row[ALL], diag[n], down[n + 1], at[ALL], count = 0, below = 0;
    for (int k = 0; k < ROWS; k++)
      for (int j = 0; j < n; j++) {
        seed = seed * 1103515245u + 12345u;
        unsigned die = seed >> 16;
        double value = die % 5 ? 0 : ldexp(1, (int)(die / 5 % 80) - 40);
        if (k < m || j <= k - m) x[k][j] = value;
        if (k >= m && j < k - m) x[m + j][k - m] = value;
      }
    for (int k = 0; k < ROWS; k++) {
      first[k] = count;
      for (int j = 0; j < n; j++) {
        size[k * n + j] = lag_element_size(x[k][j]);
        if (x[k][j] == 0 && j != k - m) continue;
        if (j == k - m) diag[j] = count;
        row[count] = k, col[count] = j, few[count++] = size[k * n + j];
      }
    }
    first[ROWS] = count;
    for (int j = 0; j < n; j++) {
      down[j] = below;
      for (int e = 0; e < first[m]; e++)
        if (col[e] == j) at[below++] = e;
    }
    down[n] = below;
    const lag_elements all = {n, m, 0, 0, 0, 0, 0, 0}, some = {n, m, first, col, row, diag, down, at};
    lag_scales(&all, scale, top, size);
    lag_scales(&some, listed, top, few);
    assert_memory_equal(scale, listed, sizeof scale);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_band),
      cmocka_unit_test(test_border),
      cmocka_unit_test(test_few_closed),
      cmocka_unit_test(test_dependent),
      cmocka_unit_test(test_without_mass),
      cmocka_unit_test(test_scales),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
