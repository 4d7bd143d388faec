/* Plans and samples of sweeps (runtime/sweep): random words against published ones, quantiles against mpmath, each
 * part of a hypercube once, and the values of runs in order. */
#include "test_rt_models.h"

#include <stdio.h>
#include <unistd.h>

#include "sweep/journal.h"
#include "sweep/sweep_grid.h"
#include "sweep/sampling.h"

/* Random123 (D. E. Shaw Research), known answers of philox4x32-10. */
static void test_philox(void **state) {
  (void)state;
  static const uint32_t rows[][10] = {{0, 0, 0, 0, 0, 0, 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8},
                                      {~0u, ~0u, ~0u, ~0u, ~0u, ~0u, 0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd},
                                      {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0,
                                       0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    uint32_t out[4];
    lag_philox(rows[i], rows[i] + 4, out);
    assert_memory_equal(out, rows[i] + 6, sizeof out);
  }
}

/* mpmath 1.2, 30 digits. Allowed: 8 roundings of the value, and of p where p is near 1. */
static void test_quantile(void **state) {
  (void)state;
  static const double rows[][2] = {{0.975, 1.959963984540054235525},      {1e-10, -6.361340902404056204695},
                                   {0.3, -0.5244005127080407840383},      {1e-300, -37.04709629936119923722},
                                   {0.5001, 0.0002506628300880350989207}, {0.5, 0}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    double x = lag_normal_quantile(rows[i][0]), slope = sqrt(2 * acos(-1)) * exp(x * x / 2),
           uncertain = rows[i][0] > 0.1 ? 3e-16 * slope : 0;
    assert_true(fabs(x - rows[i][1]) <= 2e-15 * fabs(x) + uncertain);
  }
}

/* One sample in each part, for sizes beside powers of 4, which the network of the order has. */
static void test_hypercube(void **state) {
  (void)state;
  static const int sizes[] = {1, 2, 3, 4, 5, 16, 17, 1000};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    for (uint32_t d = 0; d < 3; d++) {
      char seen[1000] = {0};
      for (int k = 0, n = sizes[i]; k < n; k++) {
        double u = lag_hypercube_at(7, (uint64_t)k, (uint64_t)n, d);
        assert_true(u > 0 && u < 1);
        int part = (int)(u * n);
        assert_int_equal(seen[part]++, 0);
      }
    }
}

/* Mean of n numbers: 1/2 within 4 deviations, 1/sqrt(12 n); dimensions and seeds are independent: correlation within
 * 4/sqrt(n). */
static void test_random(void **state) {
  (void)state;
  enum { N = 10000 };
  double mean = 0, dimensions = 0, seeds = 0;
  for (uint64_t i = 0; i < N; i++) {
    double u = lag_random_at(1, i, 0) - 0.5;
    mean += u / N;
    dimensions += 12 * u * (lag_random_at(1, i, 1) - 0.5) / N;
    seeds += 12 * u * (lag_random_at(2, i, 0) - 0.5) / N;
  }
  assert_true(fabs(mean) < 4 / sqrt(12. * N) && fabs(dimensions) < 4 / sqrt(N) && fabs(seeds) < 4 / sqrt(N));
}

static void expect_runs(int zip, long long samples, const char *const *words, long long runs, const double *values) {
  SweepPlan p = {.zip = zip, .seed = 1};
  char why[200] = "";
  double got[8];
  for (; *words; words++) assert_int_equal(lag_plan_add(&p, *words, why, sizeof why), 0);
  assert_int_equal(lag_plan_finish(&p, samples, why, sizeof why), 0);
  assert_int_equal(p.runs, runs);
  for (long long i = 0; i < runs && values; i++) {
    lag_plan_values(&p, i, got);
    for (int k = 0; k < p.n; k++) assert_true(fabs(got[k] - values[i * p.n + k]) <= 1e-15 * fabs(got[k]));
  }
  lag_plan_free(&p);
}

static void test_grids(void **state) {
  (void)state;
  expect_runs(0, 0, (const char *const[]){"a=1,2", "b=0..1:3", NULL}, 6,
              (const double[]){1, 0, 1, 0.5, 1, 1, 2, 0, 2, 0.5, 2, 1});
  expect_runs(1, 0, (const char *const[]){"a=1, 2, 5", "b=-1..1:3", NULL}, 3, (const double[]){1, -1, 2, 0, 5, 1});
  expect_runs(0, 0, (const char *const[]){"k=1e-3..1e3:log:4", NULL}, 4, (const double[]){1e-3, 1e-1, 10, 1e3});
  expect_runs(0, 10, (const char *const[]){"a=1,2", "g~normal(9.81, 0.01)", NULL}, 20, NULL);
}

/* The same samples at each place of the grid. */
static void test_samples(void **state) {
  (void)state;
  SweepPlan p = {.seed = 3, .sampling = SAMPLING_HYPERCUBE};
  char why[200];
  assert_int_equal(lag_plan_add(&p, "g~uniform(2, 4)", why, sizeof why) | lag_plan_add(&p, "a=1,2", why, sizeof why) |
                       lag_plan_finish(&p, 100, why, sizeof why),
                   0);
  for (long long i = 0; i < 100; i++) {
    double first[2], second[2];
    lag_plan_values(&p, i, first);
    lag_plan_values(&p, 100 + i, second);
    assert_true(first[0] == second[0] && first[0] > 2 && first[0] < 4 && first[1] == 1 && second[1] == 2);
  }
  lag_plan_free(&p);
}

static void test_refused(void **state) {
  (void)state;
  static const char *const words[] = {"a=1..0:3",       "a=0..1:0",        "a=0..1:2.5", "a=0..1:", "a=0..1:log:3",
                                      "a=0..1:log",     "a=1,,2",          "a=1,x",      "=1,2",    "a~normal(1)",
                                      "a~normal(1, 0)", "a~uniform(2, 1)", "a=0..1:1",   "a=..1:2"};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    SweepPlan p = {0};
    char why[200] = "";
    assert_int_equal(lag_plan_add(&p, words[i], why, sizeof why), -1);
    assert_true(why[0]);
    lag_plan_free(&p);
  }
}

/* Chunks are read from memory: the file is there for other processes. */
static void test_journal(void **state) {
  (void)state;
  char path[100], why[4400];
  double row[2] = {1.5, -2}, got[2] = {0, 0};
  snprintf(path, sizeof path, "/tmp/test_journal.%ld", (long)getpid());
  Journal j = {.chunks = 3, .size = 2, .signature = 7};
  assert_int_equal(lag_journal_open(&j, path, 0, why, sizeof why), 0);
  assert_int_equal(lag_journal_put(&j, 1, row, 2), 0);
  assert_int_equal(lag_journal_flush(&j), 0);
  lag_journal_close(&j, 0);
  j = (Journal){.chunks = 3, .size = 2, .signature = 7};
  assert_int_equal(lag_journal_open(&j, path, 1, why, sizeof why), 0);
  assert_int_equal(truncate(path, 0), 0);
  assert_int_equal(lag_journal_get(&j, 1, got, 2), 0);
  assert_true(got[0] == row[0] && got[1] == row[1]);
  assert_int_equal(lag_journal_get(&j, 0, got, 2), -1);
  lag_journal_close(&j, 1);
}

/* The shortest of 15 and more digits that reads as the same number, by trying them; in all ranges of exponents, whole
 * numbers, hundredths, ends of decades, powers of two and their neighbours. */
static void test_number_text(void **state) {
  (void)state;
  static const double ends[] = {0,
                                -0.0,
                                1e15,
                                1e16,
                                1e17,
                                1e-4,
                                1e-5,
                                9.9999999999999995e22,
                                99999999999999.99,
                                0x1p-1074,
                                1.7976931348623157e308,
                                9007199254740993,
                                INFINITY};
  uint64_t r = 88172645463325252u;
  for (int i = 0; i < 4000; i++) {
    r ^= r << 13, r ^= r >> 7, r ^= r << 17;
    double x = (double)(int64_t)r * 0x1p-60;
    if (i % 4 == 0) memcpy(&x, &r, sizeof x);
    if (i % 4 == 1) x = (double)(r % 100000) / 100;
    if (i % 4 == 2) x = ldexp(1 + (double)(i % 3 - 1) * 0x1p-52, (int)(r % 120) - 60); /* nearer numbers below */
    if (i % 8 == 3) x *= pow(10, (double)(i % 38) - 19); /* within 128 bits and beyond */
    if (i < (int)(sizeof ends / sizeof *ends)) x = ends[i];
    char text[64], expected[64] = "";
    for (int digits = 15; digits < 18 && !(digits > 15 && strtod(expected, NULL) == x); digits++)
      snprintf(expected, sizeof expected, "%.*g", digits, x);
    if (!isnan(x)) assert_string_equal(lag_number_text(x, text), expected);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_philox),  cmocka_unit_test(test_quantile),    cmocka_unit_test(test_hypercube),
      cmocka_unit_test(test_random),  cmocka_unit_test(test_grids),       cmocka_unit_test(test_samples),
      cmocka_unit_test(test_refused), cmocka_unit_test(test_number_text), cmocka_unit_test(test_journal)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
