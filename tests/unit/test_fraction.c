/* common_denominator: numerators and denominators are what they are by construction. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mech/noether_fraction.h"

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

/* Rows in echelon form of a space with short whole rows: what is found are whole rows of that space, and about as short. */
static void test_members(void **state) {
  (void)state;
  enum { N = 12 };
  static const int64_t short_rows[2][N] = {{3, 1, -20173, 998877, 0, 27182, -31415, 5551, 7777, -12, 40487, 1},
                                           {7, 5, 10331, -14, 6021, 1602, 9109, -1380, 299, 667, 8854, -2}};
  Arena *arena = arena_new(NULL);
  long double x[2 * N];
  int64_t whole[2 * N];
  const int64_t det = short_rows[0][0] * short_rows[1][1] - short_rows[0][1] * short_rows[1][0]; /* columns 0 and 1 are pivots */
  for (int i = 0; i < N; i++) {
    int64_t a = short_rows[0][i], b = short_rows[1][i];
    x[i] = (long double)(a * short_rows[1][1] - b * short_rows[0][1]) / (long double)det;
    x[N + i] = (long double)(b * short_rows[0][0] - a * short_rows[1][0]) / (long double)det;
  }
  assert_int_equal(whole_members(arena, x, 2, N, whole), 2);
  assert_int_not_equal(whole[0] * whole[N + 1], whole[1] * whole[N]);
  for (int r = 0; r < 2; r++)
    for (int i = 0; i < N; i++) {
      const int64_t *w = whole + (size_t)r * N;
      int64_t left = w[0] * (short_rows[0][i] * short_rows[1][1] - short_rows[1][i] * short_rows[0][1]) + w[1] * (short_rows[1][i] * short_rows[0][0] - short_rows[0][i] * short_rows[1][0]);
      assert_int_equal(w[i] * det, left);
      assert_true(w[i] > -100000000 && w[i] < 100000000); /* a basis of the same lattice, a few times as long */
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

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_found), cmocka_unit_test(test_members), cmocka_unit_test(test_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
