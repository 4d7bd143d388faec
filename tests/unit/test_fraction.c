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

static void test_none(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  const long double x[] = {1.41421356237309504880L, 1.73205080756887729353L, 2.23606797749978969641L, 0.5L};
  assert_int_equal(common_denominator(arena, x, 4), 0);
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_found), cmocka_unit_test(test_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
