/* Identities whose truth hangs on domains, branches and far places: the verdict that mathematics has for each, and
 * why. "Proved" means for all states at which both sides have real values; a refutation shows one at which both are
 * defined and differ. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "claims/expect.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"

#define FREE                                                                         \
  "model m\ncoord x, y, z\nparam a = 2 > 0, b = 3 > 0, c = 1, k = 1, n = 2\n"         \
  "function lg(u) = log(u)\nfunction root(u) = sqrt(u)\nlet w = sqrt(y)*sqrt(y)\n"    \
  "lagrangian = x'^2/2 + y'^2/2 + z'^2/2 - x^2/2 - y\n"
#define ROD                                                            \
  "model m\ncoord x, y\nparam l = 2 > 0, g = 9.81 > 0, m = 1 > 0\n"     \
  "lagrangian = m*(x'^2 + y'^2)/2 - m*g*y\nconstraint rod: x^2 + y^2 = l^2\n"
#define SCALED_ROD                                                     \
  "model m\ncoord x, y\nparam l = 2 > 0, g = 9.81 > 0, m = 1 > 0\n"     \
  "lagrangian = m*(x'^2 + y'^2)/2 - m*g*y\nconstraint rod: 3e6*(x^2 + y^2) = 3e6*l^2\n"
#define SLED                                                                  \
  "model m\ncoord x, y, th\nparam m = 1 > 0, J = 1 > 0\n"                       \
  "lagrangian = m*(x'^2 + y'^2)/2 + J*th'^2/2\nconstraint edge: x'*sin(th) = y'*cos(th)\n"
#define LINKS                                                                                \
  "model m\ncoord x1, y1, x2, y2\nparam l1 = 1 > 0, l2 = 2 > 0, g = 9.81 > 0\n"              \
  "lagrangian = (x1'^2 + y1'^2)/2 + (x2'^2 + y2'^2)/2 - g*y1 - g*y2\n"                         \
  "constraint a: x1^2 + y1^2 = l1^2\nconstraint b: (x2 - x1)^2 + (y2 - y1)^2 = l2^2\n"
#define COUPLED                                                                   \
  "model m\ncoord x, y\nparam a = 2 > 0, b = 1 > 0, c = 0.3, k = 1 > 0\n"         \
  "lagrangian = x'^2/(2*(a + b)) + c*x'*y' + y'^2/2 - k*x^2/2\n"
#define HALF_LINE "model m\ncoord x\nlagrangian = x'^2/2 + log(x)\n"

typedef struct {
  const char *model, *claim, *why;
} Claim;

static const Claim is_true[] = {
    {FREE, "abs(x) + log(x) = x + log(x)", "log(x) has a value for x > 0 alone"},
    {FREE, "lg(x) + abs(x) = x + log(x)", "the same inside a function"},
    {FREE, "sqrt(x)*sqrt(x) = abs(x)", "x >= 0"},
    {FREE, "sqrt(x)^2 = x", "x >= 0, where the root has a value"},
    {FREE, "w = abs(y)", "y >= 0 inside the let"},
    {FREE, "root(x)^2 = abs(x)", "x >= 0 inside the function"},
    {FREE, "exp(log(x)) = abs(x)", "x > 0"},
    {FREE, "0*log(x) + abs(x) = x", "x > 0: the factor 0 does not give log a value"},
    {FREE, "abs(x - 3) + sqrt(x - 3) = x - 3 + sqrt(x - 3)", "x >= 3"},
    {FREE, "abs(3 - 2*x) + log(3 - 2*x) = 3 - 2*x + log(3 - 2*x)", "x < 3/2"},
    {FREE, "log(x*y) = log(x) + log(y)", "the right side needs x > 0 and y > 0"},
    {FREE, "log(x/y) = log(x) - log(y)", "x, y > 0"},
    {FREE, "log(a*b) = log(a) + log(b)", "a, b > 0 declared"},
    {FREE, "log(a^2/b) = 2*log(a) - log(b)", "a, b > 0 declared"},
    {FREE, "log(a^n) = n*log(a)", "a > 0 declared"},
    {FREE, "log(6) = log(2) + log(3)", "numbers"},
    {FREE, "log(x^2) = 2*log(x)", "the right side needs x > 0"},
    {FREE, "log(x^2) = 2*log(abs(x))", "both for x != 0"},
    {FREE, "log(sqrt(x)) = log(x)/2", "x > 0"},
    {FREE, "log(exp(x)*exp(y)) = x + y", "exp is positive"},
    {FREE, "log(exp(x)) = x", "for all x"},
    {FREE, "(a^n)^k = a^(n*k)", "a > 0 declared"},
    {FREE, "(a*b)^n = a^n*b^n", "a, b > 0 declared"},
    {FREE, "a^n*a^k = a^(n + k)", "a > 0 declared"},
    {FREE, "exp(n*log(a)) = a^n", "a > 0"},
    {FREE, "sqrt(a^2) = a", "a > 0 declared"},
    {FREE, "sqrt(x^2) = abs(x)", "for all x"},
    {FREE, "sqrt(x)*sqrt(y) = sqrt(x*y)", "the left side needs x, y >= 0"},
    {FREE, "sqrt(a*x) = sqrt(a)*sqrt(x)", "a > 0"},
    {FREE, "sqrt(x - 100)*sqrt(x + 100) = sqrt(x^2 - 10000)", "x >= 100"},
    {FREE, "min(a, b) + max(a, b) = a + b", "one is the other's rest"},
    {FREE, "min(x, y)*max(x, y) = x*y", "the same"},
    {FREE, "max(x, y) - min(x, y) = abs(x - y)", "either order"},
    {FREE, "max(x, 0) + min(x, 0) = x", "either sign"},
    {FREE, "max(x, -x) = abs(x)", "either sign"},
    {FREE, "min(min(x, y), z) = min(x, min(y, z))", "associative"},
    {FREE, "max(x, 1000) = if(x > 1000, x, 1000)", "the definition"},
    {FREE, "x*sign(x) = abs(x)", "0 at 0"},
    {FREE, "sign(x)^3 = sign(x)", "-1, 0, 1"},
    {FREE, "sign(x*y) = sign(x)*sign(y)", "signs multiply"},
    {FREE, "abs(x)*abs(y) = abs(x*y)", "sizes multiply"},
    {FREE, "abs(x)/abs(y) = abs(x/y)", "y != 0"},
    {FREE, "abs(x)/x = sign(x)", "x != 0, where the left side has a value"},
    {FREE, "if(x > 0, log(x), 0) + if(x <= 0, 1, 0) = if(x > 0, log(x), 1)", "log is asked for x > 0 alone"},
    {FREE, "if(x > 0, abs(x) + log(x), 0) = if(x > 0, x + log(x), 0)", "x > 0 in the branch"},
    {FREE, "if(x > 1000, 1, 0) + if(x <= 1000, 1, 0) = 1", "one of both"},
    {FREE, "if(x > 0 and x > -1, 1, 0) = if(x > 0, 1, 0)", "the second follows from the first"},
    {FREE, "x/x = 1", "x != 0, where the left side has a value"},
    {FREE, "(x^2 - 1)/(x - 1) = x + 1", "x != 1"},
    {FREE, "sqrt(1 + sinh(x)^2) = cosh(x)", "cosh is positive"},
    {FREE, "sqrt(exp(x)) = exp(x/2)", "exp is positive"},
    {FREE, "sqrt(1 - sin(x)^2) = abs(cos(x))", "the size, for all x"},
    {FREE, "tan(x)*cos(x) = sin(x)", "where tan has a value"},
    {FREE, "sqrt(x^2 + 2*x + 1) = abs(x + 1)", "a square"},
    {FREE, "cbrt(x^3) = x", "cube roots are real for all x"},
    {FREE, "(x^2)^(1/4) = sqrt(abs(x))", "for all x"},
    {FREE, "sqrt(x)^3/x = sqrt(x)", "x > 0"},
    {FREE, "sin(1e12*x) = 2*sin(5e11*x)*cos(5e11*x)", "an angle of many turns"},
    {FREE, "if(exp(-x^2) > 0, 1, 0) = 1", "also where exp underflows"},
    {FREE, "if(1 + exp(-x^2) > 1, 1, 0) = 1", "also where the sum is 1 to all digits"},
    {FREE, "abs(sin(pi)) + x = x", "pi is not the number that stands for it"},
    {FREE, "abs(x)' = if(x > 0, x', -x')", "abs has no derivative at 0"},
    {FREE, "abs(x)' = sign(x)*x'", "the same"},
    {HALF_LINE, "x'' = 1/abs(x)", "L has a value for x > 0 alone, and so has x''"},
    {ROD, "x^2 + y^2 = l^2", "the constraint"},
    {ROD, "x*x' + y*y' = 0", "its first rate"},
    {ROD, "(x^2 + y^2)' = 0", "the same"},
    {ROD, "(x^2 + y^2)'' = 0", "its second rate"},
    {ROD, "l = sqrt(x^2 + y^2)", "l > 0 declared"},
    {ROD, "l^2*(x'^2 + y'^2) = (x*y' - y*x')^2", "velocities are along the circle"},
    {ROD, "m*l^2*(x'^2 + y'^2) = m*g*l^2*y + 2*l^4*lambda(rod)*(-1)",
     "the force that holds the bob: with c = x^2 + y^2 - l^2"},
    {COUPLED, "x'' = -k*x/(1/(a + b) - c^2)", "Cramer's rule, where a row has a denominator"},
    {COUPLED, "y'' = c*k*x/(1/(a + b) - c^2)", "the same"},
    {SCALED_ROD, "x^2 + y^2 = l^2", "the factor of a constraint says nothing"},
    {SCALED_ROD, "x*x'' + y*y'' = -(x'^2 + y'^2)", "the same"},
    {LINKS, "(x2 - x1)*(x2' - x1') + (y2 - y1)*(y2' - y1') = 0", "the rate of one of two constraints"},
    {LINKS, "((x2 - x1)^2 + (y2 - y1)^2)'' = 0", "its second rate"},
    {LINKS, "abs(y1) = sqrt(l1^2 - x1^2)", "either side of the pivot"},
    {SLED, "x'*sin(th) - y'*cos(th) = 0", "a constraint on velocities"},
    {SLED, "x'^2 + y'^2 = (x'*cos(th) + y'*sin(th))^2", "velocities are along the edge"},
};

static const Claim is_false[] = {
  {FREE, "abs(x) = x", "x < 0"},
  {FREE, "abs(x) + log(y) = x + log(y)", "x < 0 < y"},
  {FREE, "sqrt(x^2) = x", "x < 0"},
  {FREE, "sqrt(y)*x = sqrt(y)*abs(x)", "x < 0 < y"},
  {FREE, "(x^2)^(n/2) = x^n", "x = -1, n = 1"},
  {FREE, "(x^n)^k = x^(n*k)", "x = -1, n = 2, k = 1/2 and others"},
  {FREE, "if(x > 1000, 1, 0) = 0", "past 1000"},
  {FREE, "if(x > 1e9, 1, 0) = 0", "past 1e9"},
  {FREE, "if(x < -1e7, 1, 0) = 0", "far to the other side"},
  {FREE, "if(x > 0 and x < 1e-5, 1, 0) = 0", "near 0"},
  {FREE, "if(x > 1e5 and y > 1e5, 1, 0) = 0", "both far"},
  {FREE, "if(x*y > 1e10, 1, 0) = 0", "together far"},
  {FREE, "if(a > 1e4, 1, 0) = 0", "a parameter is any that its sign allows"},
  {FREE, "if(x - y == 1, 1, 0) = 0", "along a line"},
  {FREE, "if(x >= 0, 1, 0) = if(x > 0, 1, 0)", "x = 0"},
  {FREE, "if(x > 0, 1, 0) + if(x < 0, 1, 0) = 1", "x = 0"},
  {FREE, "sign(x)^2 = 1", "x = 0"},
  {FREE, "min(x, 1e6) = x", "past 1e6"},
  {FREE, "max(x, -1e8) = x", "below -1e8"},
  {FREE, "min(t, 1e9) = t", "late"},
  {FREE, "min(a, b) = a", "b < a"},
  {FREE, "max(x, y) = (x + y)/2", "x != y"},
  {FREE, "if(x > y, x, y) = min(x, y)", "x != y"},
  {FREE, "x*sign(x) = x", "x < 0"},
  {FREE, "x/abs(x) = 1", "x < 0"},
  {FREE, "sign(x*y) = sign(x)", "y < 0"},
  {FREE, "abs(x)*y = abs(x*y)", "y < 0"},
  {FREE, "abs(x + y) = abs(x) + abs(y)", "x < 0 < y"},
  {FREE, "asin(sin(x)) = x", "past a quarter of a turn"},
  {FREE, "sin(acos(x)) = -sqrt(1 - x^2)", "x = 0"},
  {FREE, "acos(cos(x)) = abs(x)", "past half a turn"},
  {FREE, "atan(tan(x)) = x", "past a quarter of a turn"},
  {FREE, "atan2(sin(x), cos(x)) = x", "past half a turn"},
  {FREE, "log(x + y) = log(x) + log(y)", "x = y = 1"},
  {FREE, "log(a*b) = log(a)*log(b)", "a = b = 1"},
  {FREE, "log(a^n) = log(a)^n", "n = 2, a = 2"},
  {FREE, "log(abs(x)) = abs(log(abs(x)))", "abs(x) < 1"},
  {FREE, "sqrt(a + b) = sqrt(a) + sqrt(b)", "both > 0"},
  {FREE, "(a + b)^n = a^n + b^n", "n = 2"},
  {FREE, "(a^n)^k = a^(n + k)", "n = 2, k = 1"},
  {FREE, "exp(x*y) = exp(x)*exp(y)", "x = 1, y = 2"},
  {FREE, "exp(log(x)) = -x", "x > 0"},
  {FREE, "sqrt(1 + sinh(x)^2) = sinh(x)", "x = 0"},
  {FREE, "sqrt(1 - sin(x)^2) = cos(x)", "past a quarter of a turn"},
  {FREE, "sqrt(x^2 - 2*x + 1) = x - 1", "x < 1"},
  {FREE, "sqrt(x^2 + y^2) = x + y", "x = y = 1"},
  {FREE, "hypot(x, y) = abs(x) + abs(y)", "x = y = 1"},
  {FREE, "cbrt(x)^2 = x", "x = -1"},
  {FREE, "if(x > 0, sqrt(x), 0) = sqrt(abs(x))", "x < 0"},
  {FREE, "max(log(x), 0) = log(x)", "0 < x < 1"},
  {FREE, "tanh(x) = 1", "x = 0"},
  {FREE, "sin(x) = x - x^3/6", "x = 2"},
  {FREE, "cosh(x) = cosh(x) + 1e-15*x^2", "x = 1"},
  {FREE, "x = x*(1 + 1e-12)", "x = 1"},
  {FREE, "x + 1e-20 = x", "every x"},
  {FREE, "x''*1e-40 = 0", "x = 1"},
  {FREE, "x'' = -x + if(x > 1e8, 1, 0)", "far out"},
  {HALF_LINE, "x'' = x", "x = 2"},
  {ROD, "x^2 + y^2 = l^2*(1 + 1e-6)", "off by a part in a million"},
  {ROD, "x^2 + y^2 = l^2*(1 + 1e-14)", "off by less than a double shows at a glance"},
  {ROD, "x*x' - y*y' = 0", "at rest alone"},
  {ROD, "x*x'' + y*y'' = 0", "at rest alone"},
  {ROD, "l = -sqrt(x^2 + y^2)", "l > 0 declared"},
  {SCALED_ROD, "x^2 + y^2 = l^2*(1 + 1e-6)", "off by a part in a million"},
  {SCALED_ROD, "x*x'' + y*y'' + x'^2 + y'^2 = 1e-9*y", "off by little"},
  {LINKS, "(x2 - x1)*(x2' - x1') = (y2 - y1)*(y2' - y1')", "at rest alone"},
  {LINKS, "x1*x1' + y1*y1' = 1e-7*x2'", "off by little"},
  {LINKS, "y1 = sqrt(l1^2 - x1^2)", "below the pivot"},
  {SLED, "x'*sin(th) + y'*cos(th) = 0", "the other sign"},
};

/* True and beyond what the prover knows, about no state at all, or false where no state is tried: neither proved nor
 * refuted. */
static const Claim is_open[] = {
  {FREE, "if(x > 8e11 and x < 8.00001e11, 1, 0) = 0", "a narrow gap far out"},
  {FREE, "if(x == 5, 1, 0) = 0", "at one place"},
  {FREE, "if(abs(x - 5) < 1e-9, 1, 0) = 0", "a narrow gap"},
  {FREE, "if((x - 5)^2 < 1e-12, 1, 0) = 0", "the same, smooth"},
  {FREE, "if((x - 0.3)^2 < 1e-9, 1, 0) = 0", "the same, where values beside it are small"},
  {FREE, "max(log(x), -20) = log(x)", "x < exp(-20)"},
  {FREE, "asin(x) + acos(x) = pi/2", "-1 <= x <= 1"},
  {FREE, "atan(x) + atan(1/x) = pi/2*sign(x)", "x != 0"},
  {FREE, "if(cosh(x) >= 1, 1, 0) = 1", "also where cosh is 1 to all digits"},
  {FREE, "if(tanh(x) < 1, 1, 0) = 1", "also where tanh is 1 to all digits"},
  {FREE, "sqrt(-1 - x^2) = 7", "the left side has no value anywhere"},
  {FREE, "log(x - y) + log(y - x) = 3", "nor has this"},
};

static ExpectVerdict judge(const Claim *claim, char *state, size_t size) {
  Arena *arena = arena_new(NULL);
  jmp_buf failed;
  assert_non_null(arena);
  if (setjmp(failed)) fail_msg("out of memory");
  arena_guard(arena, &failed);
  Sources *sources = sources_new(arena);
  Diags *diags = diags_new(arena, sources);
  Ast *ast = ast_new(arena, interner_new(arena), sources, diags);
  const char *text = arena_printf(arena, "%sexpect %s\n", claim->model, claim->claim);
  ExpectResults results = {0};
  Model *m =
      parse(ast, source_add(sources, "m.lag", text, strlen(text))) ? model_build(ast, &(ModelChoice){.bare = 1}) : NULL;
  Eqns *e = m ? equations_of(m) : NULL;
  if (!e) {
    StrBuf b = strbuf(arena);
    diags_print(diags, &b);
    fail_msg("%s", sb_text(&b));
  }
  expects_check(e, NULL, 0, &results);
  assert_int_equal(results.n, 1);
  ExpectVerdict v = results.at[0].verdict;
  const Diag *d = diags->list.n ? &diags->list.at[diags->list.n - 1] : NULL;
  strncpy(state, d && d->help ? d->help : "", size - 1);
  arena_free(arena);
  return v;
}

static const char *verdict_text(ExpectVerdict v) {
  return v == EXPECT_PROVED    ? "proved"
         : v == EXPECT_REFUTED ? "refuted"
         : v == EXPECT_AGREES  ? "not proved"
                               : "not decided";
}

static void check_all(const Claim *claims, size_t n, int (*is_right)(ExpectVerdict v, const char *state)) {
  char state[1000] = "", *all = test_malloc(100000);
  size_t used = 0;
  all[0] = 0;
  for (size_t i = 0; i < n; i++) {
    ExpectVerdict v = judge(&claims[i], state, sizeof state);
    if (!is_right(v, state) && used < 90000)
      used += (size_t)snprintf(all + used, 100000 - used, "%s is %s, but: %s (%s)\n", claims[i].claim, verdict_text(v),
                               claims[i].why, state);
  }
  if (used) fail_msg("%s", all);
  test_free(all);
}

static int proved(ExpectVerdict v, const char *state) { return state && v == EXPECT_PROVED; }
static int refuted(ExpectVerdict v, const char *state) {
  return v == EXPECT_REFUTED && strncmp(state, "the left side is ", 17) == 0 && strstr(state, " at ");
}
static int undecided(ExpectVerdict v, const char *state) {
  return state && (v == EXPECT_AGREES || v == EXPECT_UNKNOWN);
}

#define ALL(claims) claims, sizeof claims / sizeof *claims

static void true_claims(void **state) {
  (void)state;
  check_all(ALL(is_true), proved);
}

static void false_claims(void **state) {
  (void)state;
  check_all(ALL(is_false), refuted);
}

static void open_claims(void **state) {
  (void)state;
  check_all(ALL(is_open), undecided);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(true_claims), cmocka_unit_test(false_claims),
                                     cmocka_unit_test(open_claims)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
