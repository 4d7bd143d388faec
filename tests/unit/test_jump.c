/* expr_jumps against what is known of functions: which of them are continuous, and by how much the others jump. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "expr_text.h"
#include "sym/jump.h"

typedef struct {
  Arena *arena;
  Texts t;
} Lab;

static Lab lab_new(void) {
  Lab l = {.arena = arena_new(NULL)};
  l.t = texts(l.arena, " a b ");
  return l;
}

static Expr read(Lab *l, const char *text) {
  const char *s = text;
  return text_sum(&l->t, &s);
}

/* if(0 < side, yes, no) */
static Expr branch(Lab *l, const char *side, const char *yes, const char *no) {
  Expr border = read(l, side), a = read(l, yes), b = read(l, no);
  Expr condition = expr_fn2(l->t.g, EX_LT, expr_int(l->t.g, 0), border);
  return expr_select(l->t.g, condition, a, b);
}

/* |jump| is `by` wherever it is met; 0: there is none. */
static void expect(Lab *l, Expr x, const char *what, long double by) {
  ExprJumps all = expr_jumps(l->t.g, x);
  if ((all.n > 0) != (by > 0)) fail_msg("%s: %u jumps", what, all.n);
  /* neighbouring states are 1e-11 apart, and slopes of these functions below 1e2 */
  for (uint32_t i = 0; i < all.n; i++)
    if (!(fabsl(fabsl(all.at[i].by) - by) < 1e-8L)) fail_msg("%s jumps by %Lg, not by %Lg", what, all.at[i].by, by);
}

static void test_continuous(void **state) {
  (void)state;
  static const char *const texts[] = {"abs(x)",
                                      "max(x, y)", "min(x, 1)*x'", "x*sign(x)", "(x - 1)*sign(x - 1)", "cbrt(x)",
                                      "acos(cos(x))", "asin(sin(x))", "1/x", "tan(x)", "log(abs(x))", "1/hypot(x, y)",
                                      "exp(-1/x^2)", "atan(1/x^2)", "abs(x)^0.125", "sign(a)*x",
                                      "sin(x)*atan2(sin(x), x^2 + 1)"};
  Lab l = lab_new();
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) expect(&l, read(&l, texts[i]), texts[i], 0);
  expect(&l, branch(&l, "x", "x^2", "0"), "if(x > 0, x^2, 0)", 0);
  expect(&l, branch(&l, "t - 1", "(t - 1)*x", "0"), "if(t > 1, (t - 1)*x, 0)", 0);
  expect(&l, branch(&l, "hypot(x, y) - b", "log(hypot(x, y)/b)", "0"), "a logarithm from its zero on", 0);
  Expr one = branch(&l, "x", "1", "0"), other = branch(&l, "x", "0", "1"), both = expr_add(l.t.g, one, other);
  expect(&l, both, "two that cancel", 0);
  arena_free(l.arena);
}

static void test_jumps(void **state) {
  (void)state;
  const long double pi = acosl(-1);
  const struct {
    const char *text;
    long double by;
  } cases[] = {{"sign(x)", 2},     {"3*sign(x' - y) + x^3", 6},    {"atan(tan(x))", pi},    {"atan(1/x)", pi},
               {"x/abs(x)", 2},    {"tanh(1/(x - y))", 2},         {"1/(1 + exp(1/x))", 1}, {"atan2(y, x)", 2 * pi},
               {"sign(t - 7)", 2}, {"0.000001*sign(x) + x", 2e-6L}};
  Lab l = lab_new();
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    expect(&l, read(&l, cases[i].text), cases[i].text, cases[i].by);
  expect(&l, branch(&l, "x - 1", "1", "0"), "if(x > 1, 1, 0)", 1);
  expect(&l, branch(&l, "x - 1000000", "1", "0"), "far away", 1);
  expect(&l, branch(&l, "1/1000000 - hypot(x, y)", "1", "0"), "a small ball", 1);
  expect(&l, branch(&l, "sin(t)", "1", "-1"), "a square wave", 2);
  arena_free(l.arena);
}

/* What is told of the place: the side is 0, and by its slope along the line. */
static void test_place(void **state) {
  (void)state;
  Lab l = lab_new();
  ExprJumps all = expr_jumps(l.t.g, branch(&l, "2*x - y - 3", "1", "0"));
  assert_int_equal(all.n, 1);
  const long double *s = all.at[0].symbols, x = s[text_symbol(&l.t, "x")], y = s[text_symbol(&l.t, "y")];
  assert_true(fabsl(2 * x - y - 3) < 1e-14L); /* a bisection's last bit, of doubles under valgrind */
  assert_true(fabsl(all.at[0].slope) > 0);
  arena_free(l.arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_continuous), cmocka_unit_test(test_jumps),
                                     cmocka_unit_test(test_place)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
