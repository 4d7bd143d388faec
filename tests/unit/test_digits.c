/* Digits of fractions and of multiples of pi: by mpmath with 80 digits, cut after 40. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/num.h"

static const struct {
  int64_t n, d;
  int pi_power;
  const char *digits;
} known[] = {
    {20, 1, 1, "62.83185307179586476925286766559005768394"},
    {1, 180, 1, "0.01745329251994329576923690768488612713442"},
    {22, 7, 0, "3.142857142857142857142857142857142857142"},
    {180, 1, -1, "57.29577951308232087679815481410517033240"},
    {INT64_C(9223372036854775807), 3, 0, "3074457345618258602.333333333333333333333"},
    {-1, 3, 0, "-0.3333333333333333333333333333333333333333"},
    {1, INT64_C(999999999999999989), 0, "1.000000000000000011000000000000000121e-18"},
    {INT64_C(123456789012345678), 1000003, 1, "387849777847.6367447926600019804147845936"},
    {1, 2, -1, "0.1591549430918953357688837633725143620344"},
    {5, 1, -1, "1.591549430918953357688837633725143620344"},
    {7, 1000000007, 1, "2.199114842119051372090490763662216673302e-8"},
    {1, 10, 0, "0.1"},
    {-123456789, 1000, 0, "-123456.789"},
    {100000, 1, 0, "100000.0"},
    {1, INT64_C(1000000000000000000), 0, "1.0e-18"},
    {0, 1, 0, "0.0"},
    {0, 1, 1, "0.0"},
    {1, 1024, 0, "0.0009765625"},
    {INT64_C(9223372036854775807), 1, 0, "9223372036854775807.0"},
};

static void digits_are_those_of_mpmath(void **state) {
  Arena *a = arena_new(NULL);
  (void)state;
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    assert_string_equal(decimal_literal(a, num_ratio(known[i].n, known[i].d), known[i].pi_power), known[i].digits);
  arena_free(a);
}

/* The double nearest to the digits is the number's own. */
static void digits_read_back(void **state) {
  Arena *a = arena_new(NULL);
  (void)state;
  for (int n = -50; n <= 50; n++)
    for (int d = 1; d <= 60; d++)
      assert_true(strtod(decimal_literal(a, num_ratio(n, d), 0), NULL) == (double)n / d);
  arena_free(a);
}

static void what_has_none_says_so(void **state) {
  Arena *a = arena_new(NULL);
  (void)state;
  assert_null(decimal_literal(a, num_double(sqrt(2)), 0));
  assert_null(decimal_literal(a, num_int(1), 2));
  assert_null(decimal_literal(a, num_int(1), -2));
  assert_null(decimal_literal(a, num_ratio(1, INT64_C(1000000000000000001)), 0));
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(digits_are_those_of_mpmath),
    cmocka_unit_test(digits_read_back),
    cmocka_unit_test(what_has_none_says_so),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
