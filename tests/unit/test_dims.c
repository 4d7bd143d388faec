/* Dimensions with unknowns: what equations tell of them, rational exponents, contradictions. Expected dimensions
 * are worked out by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "model/dims.h"

typedef struct {
  Arena *a;
  Dims *d;
  Dim m, kg, s;
} Fixture;

static Fixture setup(void) {
  Fixture f = {.a = arena_new(NULL)};
  f.d = dims_new(f.a);
  f.m = dim_base(f.d, DIM_LENGTH);
  f.kg = dim_base(f.d, DIM_MASS);
  f.s = dim_base(f.d, DIM_TIME);
  return f;
}

static Dim power(Fixture *f, Dim x, int n, int d) { return dim_pow(f->d, x, num_ratio(n, d)); }

static Dim newton(Fixture *f) { return dim_mul(f->d, f->kg, dim_per_second(f->d, dim_per_second(f->d, f->m))); }

static Span at(uint32_t begin) { return (Span){begin, begin + 1}; }

static void test_algebra(void **state) {
  (void)state;
  Fixture f = setup();
  Dim n = newton(&f), joule = dim_mul(f.d, n, f.m);
  assert_int_equal(dim_div(f.d, joule, f.m), n);
  assert_int_equal(dim_div(f.d, joule, joule), DIM_NONE);
  assert_int_equal(dim_mul(f.d, power(&f, f.m, 1, 2), power(&f, f.m, 1, 2)), f.m);
  assert_int_equal(power(&f, power(&f, f.m, 7, 5), 5, 7), f.m);
  assert_int_equal(dim_mul(f.d, f.m, DIM_ANY), DIM_ANY);
  assert_int_equal(dim_pow(f.d, f.m, num_int(0)), DIM_NONE);
  assert_string_equal(dim_text(f.d, n), "N");
  assert_string_equal(dim_text(f.d, joule), "J");
  assert_string_equal(dim_text(f.d, DIM_NONE), "1");
  assert_string_equal(dim_text(f.d, dim_mul(f.d, f.kg, power(&f, f.m, 2, 1))), "kg*m^2");
  assert_string_equal(dim_text(f.d, dim_div(f.d, f.kg, power(&f, f.m, 3, 1))), "kg/m^3");
  assert_string_equal(dim_text(f.d, dim_mul(f.d, f.m, f.s)), "m*s");
  assert_string_equal(dim_text(f.d, DIM_ANY), "?");
  assert_string_equal(dim_text(f.d, power(&f, f.m, 1, 2)), "m^(1/2)");
  assert_string_equal(dim_text(f.d, dim_per_second(f.d, DIM_NONE)), "1/s");
  assert_string_equal(dim_text(f.d, dim_div(f.d, n, f.m)), "kg/s^2");
  dim_spell(f.d, dim_div(f.d, n, f.m), "N/m");
  assert_string_equal(dim_text(f.d, dim_div(f.d, n, f.m)), "N/m");
  arena_free(f.a);
}

/* k*x^2 is an energy: k in N/m. */
static void test_one_unknown(void **state) {
  (void)state;
  Fixture f = setup();
  Dim k = dim_unknown(f.d, "k"), joule = dim_mul(f.d, newton(&f), f.m), term = dim_mul(f.d, k, power(&f, f.m, 2, 1));
  assert_true(dim_is_open(f.d, term));
  assert_string_equal(dim_text(f.d, term), "m^2*unit(k)");
  assert_string_equal(dim_open_name(f.d, term), "k");
  assert_true(dim_equate(f.d, joule, term, at(7)));
  assert_false(dim_is_open(f.d, term));
  assert_int_equal(dim_resolved(f.d, k), dim_div(f.d, newton(&f), f.m));
  assert_true(dim_equate(f.d, joule, term, at(8)));
  assert_false(dim_equate(f.d, newton(&f), term, at(9)));
  DimCause c;
  assert_true(dim_cause(f.d, term, &c));
  assert_string_equal(c.name, "k");
  assert_int_equal(c.why.begin, 7);
  assert_false(dim_cause(f.d, joule, &c));
  arena_free(f.a);
}

/* a*b^2 = m, a^3/b = kg: exponents in sevenths. */
static void test_system(void **state) {
  (void)state;
  Fixture f = setup();
  Dim a = dim_unknown(f.d, "a"), b = dim_unknown(f.d, "b");
  Dim first = dim_mul(f.d, a, power(&f, b, 2, 1)), second = dim_div(f.d, power(&f, a, 3, 1), b);
  assert_true(dim_equate(f.d, first, f.m, at(1)));
  assert_true(dim_is_open(f.d, a));
  assert_true(dim_equate(f.d, second, f.kg, at(2)));
  assert_int_equal(dim_resolved(f.d, a), dim_mul(f.d, power(&f, f.m, 1, 7), power(&f, f.kg, 2, 7)));
  assert_int_equal(dim_resolved(f.d, b), dim_div(f.d, power(&f, f.m, 3, 7), power(&f, f.kg, 1, 7)));
  assert_int_equal(dim_resolved(f.d, first), f.m);
  assert_int_equal(dim_resolved(f.d, second), f.kg);
  arena_free(f.a);
}

/* x and x/s are never one, whatever x is; x and 1/x are, where x is a pure number. */
static void test_same_unknown(void **state) {
  (void)state;
  Fixture f = setup();
  Dim x = dim_unknown(f.d, "x");
  assert_false(dim_equate(f.d, x, dim_per_second(f.d, x), at(1)));
  assert_true(dim_is_open(f.d, x));
  assert_true(dim_equate(f.d, x, power(&f, x, -1, 1), at(1)));
  assert_int_equal(dim_resolved(f.d, x), DIM_NONE);
  arena_free(f.a);
}

/* function f(a, b) = a + b^2*c, called with lengths: the arguments' unknowns are replaced. That of b, the newest, is
 * found in terms of that of a. */
static void test_replace(void **state) {
  (void)state;
  Fixture f = setup();
  Dim c = dim_unknown(f.d, "c");
  uint32_t first = dim_unknowns(f.d);
  Dim a = dim_unknown(f.d, "a"), b = dim_unknown(f.d, "b"), result = dim_mul(f.d, power(&f, b, 2, 1), c);
  assert_true(dim_equate(f.d, a, result, at(1)));
  Dim with[2] = {dim_mul(f.d, power(&f, f.m, 2, 1), c), f.m};
  assert_int_equal(dim_replace(f.d, b, first, 2, with), f.m);
  assert_int_equal(dim_replace(f.d, dim_mul(f.d, result, f.s), first, 2, with), dim_mul(f.d, with[0], f.s));
  with[1] = DIM_ANY; /* a zero: what was found of b tells its dimension */
  assert_int_equal(dim_replace(f.d, b, first, 2, with), f.m);
  with[0] = DIM_ANY;
  assert_int_equal(dim_replace(f.d, result, first, 2, with), DIM_ANY);
  assert_int_equal(dim_replace(f.d, c, first, 2, with), c);
  arena_free(f.a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_algebra), cmocka_unit_test(test_one_unknown), cmocka_unit_test(test_system),
    cmocka_unit_test(test_same_unknown), cmocka_unit_test(test_replace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
