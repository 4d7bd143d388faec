/* Dense elimination: kernels, orthonormal rows, inverses. Expected: matrices are made from their kernels and
 * inverses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/dense_matrix.h"

enum { MOST = 9 };

static uint64_t seed = 1;
static long double uniform(void) { /* in (-1, 1); Knuth's MMIX generator */
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (long double)(int64_t)(seed >> 11) / 4503599627370496.0L - 1;
}

/* The last of n columns is the sum of the others, each column k of size 10^(3 k mod 7). */
static void a_kernel_is_found(void **state) {
  (void)state;
  for (uint32_t n = 2; n <= MOST; n++) {
    Arena *a = arena_new(NULL);
    long double m[(MOST + 3) * MOST], was[(MOST + 3) * MOST];
    uint32_t rows = n + 3;
    for (uint32_t i = 0; i < rows; i++) {
      m[i * n + n - 1] = 0;
      for (uint32_t k = 0; k + 1 < n; k++) m[i * n + n - 1] += m[i * n + k] = uniform() * powl(10, 3 * k % 7);
    }
    memcpy(was, m, sizeof was);
    DenseRows null = dense_kernel(a, rows, n, m, 1e-11L);
    assert_int_equal(null.n, 1);
    /* 1e-19 by 1e6 of scale, and conditions of 1e3 */
    for (uint32_t k = 0; k + 1 < n; k++) assert_true(fabsl(null.at[k] / null.at[n - 1] + 1) < 1e-10L);
    arena_free(a);
  }
}

/* A column that is rounding beside the others counts as zero, and has no part in other vectors of the kernel: (2,
 * -1, 0) and (0, 0, 1). */
static void a_column_of_rounding_is_zero(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  long double m[] = {1, 2, 3e-17L, 2, 4, -1e-17L, 3, 6, 2e-17L};
  DenseRows null = dense_kernel(a, 3, 3, m, 1e-11L);
  assert_int_equal(null.n, 2);
  for (uint32_t k = 0; k < 2; k++) {
    const long double *x = null.at + 3 * k;
    assert_true(x[2] == 0 ? fabsl(x[0] / x[1] + 2) < 1e-18L : x[0] == 0 && x[1] == 0);
  }
  assert_true((null.at[2] == 0) != (null.at[5] == 0));
  arena_free(a);
}

static void rows_become_orthonormal(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  /* the second, third and fifth depend on others */
  long double rows[] = {1, 2, 3, 4, 2, 4, 6, 8, 0, 0, 0, 0, 1, 0, -1, 2, 3, 4, 5, 10};
  DenseRows o = dense_orthonormal(a, &(DenseRows){.n = 5, .width = 4, .at = rows}, 4);
  assert_int_equal(o.n, 2);
  for (uint32_t i = 0; i < 2; i++)
    for (uint32_t j = 0; j < 2; j++) {
      long double product = 0;
      for (uint32_t k = 0; k < 4; k++) product += o.at[4 * i + k] * o.at[4 * j + k];
      assert_true(fabsl(product - (i == j)) < 1e-18L);
    }
  for (uint32_t i = 0; i < 5; i++) {
    long double row[4], size = 0;
    memcpy(row, rows + 4 * i, sizeof row);
    for (uint32_t k = 0; k < 4; k++) size += row[k] * row[k];
    assert_true(size == 0 || dense_gram_schmidt(4, row, o.at, o.n) < 1e-17L);
  }
  arena_free(a);
}

static void an_inverse_is_one(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  for (uint32_t n = 1; n <= MOST; n++) {
    long double m[MOST * MOST], was[MOST * MOST], inverse[MOST * MOST];
    for (uint32_t i = 0; i < n * n; i++) m[i] = uniform();
    for (uint32_t i = 0; i < n; i++) m[i * n + i] = i % 2 ? 0 : m[i * n + i]; /* rows must be exchanged */
    if (n == 2) m[0] = 0;
    memcpy(was, m, sizeof was);
    assert_true(dense_invert(a, n, m, inverse));
    for (uint32_t i = 0; i < n; i++)
      for (uint32_t j = 0; j < n; j++) {
        long double product = 0;
        for (uint32_t k = 0; k < n; k++) product += was[i * n + k] * inverse[k * n + j];
        assert_true(fabsl(product - (i == j)) < 1e-15L); /* 1e-19 by conditions of 1e3 */
      }
  }
  long double singular[] = {1, 2, 2, 4}, inverse[4];
  assert_false(dense_invert(a, 2, singular, inverse));
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_kernel_is_found), cmocka_unit_test(a_column_of_rounding_is_zero),
      cmocka_unit_test(rows_become_orthonormal), cmocka_unit_test(an_inverse_is_one),
  };
  return cmocka_run_group_tests_name("dense", tests, NULL, NULL);
}
