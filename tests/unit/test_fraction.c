/* common_denominator and integer_rows: numerators and denominators are what they are by construction. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "symmetry/lattice_reduction.h"

static void test_found(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  static const int64_t denominators[] = {1, 2, 77, 14850, 123456791, 87178291199};
  static const int64_t top[] = {3, -20173, 998877, 0, 271828, -31415926, 1, 5551212, 777777777};
  enum { N = sizeof top / sizeof *top };
  for (size_t k = 0; k < sizeof denominators / sizeof *denominators; k++) {
    long double x[N];
    for (uint32_t i = 0; i < N; i++) x[i] = (long double)top[i] / (long double)denominators[k];
    assert_int_equal(common_denominator(arena, x, N), denominators[k]);
  }
  arena_free(arena);
}

static void test_none(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  const long double x[] = {1.41421356237309504880L, 1.73205080756887729353L, 2.23606797749978969641L, 0.5L};
  assert_int_equal(common_denominator(arena, x, 4), 0);
  arena_free(arena);
}

/* Short whole rows, hidden in combinations of them with random factors: they are found again, as short, and span the space. */
static void test_rows(void **state) {
  (void)state;
  enum { ROWS = 3, WIDTH = 12 };
  static const int64_t known[ROWS][WIDTH] = {{3, -20173, 998877, 0, 271828, -31415926, 1, 5551212, 0, 0, 0, 0},
                                             {0, 1, 7654321, -12, 900000, 2, 2, -87654321, 0, 0, 0, 0},
                                             {0, 0, 0, 0, 0, 0, 0, 0, 10, -7, 0, 123456789}};
  static const long double mix[ROWS][ROWS] = {{1.41421356237309504880L, -1.73205080756887729353L, 0.70710678L}, {0.5772156649L, 2.2360679774997896964L, -1}, {3.1415926L, 1, -0.57721L}};
  Arena *arena = arena_new(NULL);
  DenseRows space = {ROWS, WIDTH, ARENA_ARRAY(arena, long double, ROWS * WIDTH), 0}, back = space;
  int64_t to[ROWS * WIDTH];
  for (size_t i = 0; i < ROWS; i++)
    for (size_t j = 0; j < WIDTH; j++)
      for (size_t k = 0; k < ROWS; k++) space.at[i * WIDTH + j] += mix[i][k] * (long double)known[k][j];
  assert_int_equal(integer_rows(arena, &space, to), ROWS);
  back.at = ARENA_ARRAY(arena, long double, ROWS * WIDTH);
  for (size_t k = 0; k < ROWS * WIDTH; k++) {
    back.at[k] = (long double)to[k];
    assert_true(to[k] > -200000000 && to[k] < 200000000);
  }
  back = dense_orthonormal(arena, &back, WIDTH);
  assert_int_equal(back.n, ROWS);
  for (size_t i = 0; i < ROWS; i++) {
    long double row[WIDTH];
    for (size_t j = 0; j < WIDTH; j++) row[j] = (long double)known[i][j];
    assert_true(dense_gram_schmidt(WIDTH, row, back.at, back.n) < 1e-15L); /* whole numbers of nine digits */
  }
  arena_free(arena);
}

/* A space without any. */
static void test_no_rows(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  long double at[] = {1, 1.41421356237309504880L, 1.73205080756887729353L, 2.23606797749978969641L, 0.5L, 3.31662479035539984911L, 2.64575131106459059050L, 1};
  int64_t to[8];
  DenseRows space = {2, 4, at, 0};
  assert_int_equal(integer_rows(arena, &space, to), 0);
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_found), cmocka_unit_test(test_none), cmocka_unit_test(test_rows), cmocka_unit_test(test_no_rows)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
