/* Verdicts on expectations, and the edits that mend false ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "claims/expect.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"

typedef struct {
  Arena *arena;
  Sources *sources;
  Diags *diags;
  ExpectResults results;
} Judged;

static Judged judge_with(const char *text, const char *effect, int allow_numeric) {
  Judged j = {.arena = arena_new(NULL)};
  jmp_buf failed;
  assert_non_null(j.arena);
  if (setjmp(failed)) fail_msg("out of memory");
  arena_guard(j.arena, &failed);
  j.sources = sources_new(j.arena);
  j.diags = diags_new(j.arena, j.sources);
  Ast *ast = ast_new(j.arena, interner_new(j.arena), j.sources, j.diags);
  assert_true(parse(ast, source_add(j.sources, "m.lag", text, strlen(text))));
  ModelChoice choice = {.bare = 1, .also = effect ? intern(ast->names, effect) : NULL};
  Model *m = model_build(ast, &choice);
  if (!m) {
    StrBuf b = strbuf(j.arena);
    diags_print(j.diags, &b);
    fail_msg("%s", sb_text(&b));
  }
  Eqns *e = equations_of(m);
  assert_non_null(e);
  expects_check(e, choice.also, allow_numeric, &j.results);
  return j;
}

static ExpectVerdict verdict(const char *text) {
  Judged j = judge_with(text, NULL, 0);
  assert_int_equal(j.results.n, 1);
  ExpectVerdict v = j.results.at[0].verdict;
  assert_int_equal(j.diags->errors, v != EXPECT_PROVED);
  arena_free(j.arena);
  return v;
}

/* The false expectation's message ends in `edit`, and the caret is under `under`. */
static void mends(const char *text, const char *under, const char *edit) {
  Judged j = judge_with(text, NULL, 0);
  assert_int_equal(j.diags->errors, 1);
  const Diag *d = &j.diags->list.at[0];
  const char *colon = strstr(d->message, " is false: ");
  assert_string_equal(colon ? colon + 11 : d->message, edit);
  Place p = source_place(j.sources, d->span.begin);
  assert_string_equal(arena_strndup(j.arena, p.line_text + p.line_byte, d->span.end - d->span.begin), under);
  assert_non_null(d->help); /* both values, and where */
  arena_free(j.arena);
}

#define PENDULUM                                                        \
  "model p\ncoord th\nparam m = 1 > 0, l = 2 > 0, g = 9.81 > 0\n"       \
  "lagrangian = m/2*l^2*th'^2 + m*g*l*cos(th)\n"
#define PLANE                                                                   \
  "model p\ncoord x, y\nparam m = 1 > 0, k = 2 > 0, a = 3\n"                    \
  "let r = hypot(x, y)\nlagrangian = m/2*(x'^2 + y'^2) - k/2*(r - a)^2\n"

static void forms(void **state) {
  (void)state;
  assert_int_equal(verdict(PENDULUM "expect th'' = -g/l*sin(th)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect l*th'' + g*sin(th) = 0\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect 0 = m*l^2*th'' + m*g*l*sin(th)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect th''^2 = (g/l*sin(th))^2\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "let h = l*sin(th)\nexpect h'' = l*cos(th)*th'' - l*sin(th)*th'^2\n"),
                   EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect energy = m/2*l^2*th'^2 - m*g*l*cos(th)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect -g*sin(th) = l*th''\n"), EXPECT_PROVED);
}

static void functions(void **state) {
  (void)state;
  assert_int_equal(verdict(PENDULUM "expect th'' = -g/l*cos(th)*tan(th)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect th'' = -2*g/l*sin(th/2)*cos(th/2)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect th'' = -2*g/l*tan(th/2)/(1 + tan(th/2)^2)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PENDULUM "expect th'' = -(sqrt(g)/sqrt(l))^2*sin(th)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PLANE "expect x'' = -k/m*(hypot(x, y) - a)*x/hypot(x, y)\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PLANE "expect x'' = -k/m*(1 - a/sqrt(x^2 + y^2))*x\n"), EXPECT_PROVED);
  assert_int_equal(verdict(PLANE "expect r*x'' = k/m*(a - r)*x\n"), EXPECT_PROVED);
}

/* Agreement near th = 0, or to many digits, is no agreement. */
static void almost_true(void **state) {
  (void)state;
  assert_int_equal(verdict(PENDULUM "expect th'' = -g/l*th\n"), EXPECT_REFUTED);
  assert_int_equal(verdict(PENDULUM "expect th'' = -g/l*(th - th^3/6)\n"), EXPECT_REFUTED);
  assert_int_equal(verdict(PENDULUM "expect th'' = -g/l*sin(th)*1.000000000001\n"), EXPECT_REFUTED);
  assert_int_equal(verdict(PENDULUM "expect th'' = -9.81/l*sin(th)\n"), EXPECT_REFUTED);
}

/* What the prover does not decide is not proved, however well it agrees. */
#define UNDECIDED PENDULUM "expect th'' = -g/l*sin(th) + asin(m/(m + l)) + acos(m/(m + l)) - pi/2\n"

static void undecided(void **state) {
  (void)state;
  Judged j = judge_with(UNDECIDED, NULL, 0);
  assert_int_equal(j.results.at[0].verdict, EXPECT_AGREES);
  assert_true(j.results.at[0].digits >= 15);
  assert_int_equal(j.diags->errors, 1);
  arena_free(j.arena);
  j = judge_with(UNDECIDED, NULL, 1);
  assert_int_equal(j.results.at[0].verdict, EXPECT_AGREES);
  assert_int_equal(j.diags->errors, 0);
  assert_int_equal(j.diags->list.n, 1);
  assert_int_equal(j.diags->list.at[0].severity, DIAG_WARNING);
  arena_free(j.arena);
}

static void edits(void **state) {
  (void)state;
  mends(PENDULUM "expect th'' = g/l*sin(th)\n", "g/l*sin(th)", "`g/l*sin(th)` should have the opposite sign");
  mends(PENDULUM "expect l*th'' - g*sin(th) = 0\n", "- g*sin(th)", "`g*sin(th)` should be added, not subtracted");
  mends(PENDULUM "expect l*th'' + g*cos(th) = 0\n", "cos(th)", "`cos(th)` should be `sin(th)`");
  mends(PENDULUM "expect l*th'' + 2*g*sin(th) = 0\n", "2", "the factor `2` should not be there");
  mends(PENDULUM "expect l*th'' + g*sin(2*th) = 0\n", "2*th", "`2*th` should be `th`");
  mends(PENDULUM "expect l^2*th'' + g*sin(th) = 0\n", "^2", "the exponent `2` should not be there");
  mends(PENDULUM "expect energy = m/3*l^2*th'^2 - m*g*l*cos(th)\n", "3", "`3` should be `2`");
  mends(PENDULUM "expect energy = m/2*l^2*th' - m*g*l*cos(th)\n", "th'", "`th'` should be `th'^2`");
  mends(PENDULUM "expect energy = m/2*l^2*th'^3 - m*g*l*cos(th)\n", "3", "the exponent `3` should be `2`");
  mends(PENDULUM "expect l*th'' + g*sin(th) + th' = 0\n", "+ th'", "the term `th'` should not be there");
  mends(PENDULUM "expect l*th'' + m*g*sin(th) = 0\n", "m", "the factor `m` should not be there");
  mends(PENDULUM "expect m*th'' + g*sin(th) = 0\n", "m", "`m` should be `l`");
  mends(PENDULUM "expect l*th'' + g*sin(th') = 0\n", "th'", "`th'` should be `th`");
  mends(PENDULUM "expect th'' = -g*l*sin(th)\n", "*l", "`l` should divide, not multiply");
  mends(PENDULUM "expect energy = m/2*l^2*th'^2\n", "m/2*l^2*th'^2", "`m/2*l^2*th'^2` lacks the term `-m*l*g*cos(th)`");
  mends(PENDULUM "expect th'' = -g*sin(th)\n", "-g*sin(th)", "`-g*sin(th)` lacks the divisor `l`");
  mends(PENDULUM "expect l*th'' + 3/4*g*sin(th) = 0\n", "3", "`3` should be `4`");
  mends(PENDULUM "expect l*th'' + g*th = 0\n", "th", "`th` should be `sin(th)`");
}

/* A term of another family of functions, and a sum as a factor. */
static void edits_elsewhere(void **state) {
  (void)state;
  mends(PLANE "expect x'' = -k/m*(1 + a/r)*x\n", "+ a/r", "`a/r` should be subtracted, not added");
  mends(PLANE "expect x'' = -k/m*(1 - a/r)*y\n", "y", "`y` should be `x`");
  mends(PLANE "expect r*x'' = k/m*(a - r)\n", "k/m*(a - r)", "`k/m*(a - r)` lacks the factor `x`");
  mends("model c\ncoord x, th\nparam M = 2 > 0, m = 1 > 0, l = 1 > 0\n"
        "lagrangian = (M + m)/2*x'^2 + m*l*x'*th'*cos(th) + m/2*l^2*th'^2\n"
        "expect x'' + m*l*cos(th)*th'' = m*l*sin(th)*th'^2\n",
        "x''", "`x''` lacks the factor `M + m`");
}

static void no_single_edit(void **state) {
  (void)state;
  Judged j = judge_with(PENDULUM "expect th'' = exp(th')*tan(l)\n", NULL, 0);
  assert_int_equal(j.results.at[0].verdict, EXPECT_REFUTED);
  assert_non_null(strstr(j.diags->list.at[0].message, "no single edit"));
  arena_free(j.arena);
}

static void states_and_flows(void **state) {
  (void)state;
  assert_int_equal(verdict("model z\nparam a = 2\nstate u, v\nflow u' = a*v\nflow v' = -u\n"
                           "expect u'*v' = -a*u*v\n"), EXPECT_PROVED);
  mends("model z\nparam a = 2\nstate u, v\nflow u' = a*v\nflow v' = -u\nexpect v' = u\n", "u",
        "`u` should have the opposite sign");
  /* A state that a coordinate feels: its rate is put in. */
  assert_int_equal(verdict("model z\ncoord x\nparam c = 2\nstate i\nflow i' = -x'\nlagrangian = x'^2/2 + c*i*x\n"
                           "expect x'' + i' = c*i - x'\n"), EXPECT_PROVED);
}

/* Inside an effect an expectation is about the model with it; outside of it, without. */
static void effects(void **state) {
  (void)state;
  const char *text = PENDULUM
    "expect th'' = -g/l*sin(th)\n"
    "effect drag { param c = 1\n dissipation = c/2*th'^2\n expect th'' = -g/l*sin(th) - c*th'/(m*l^2)\n }\n";
  for (int with = 0; with < 2; with++) {
    Judged j = judge_with(text, with ? "drag" : NULL, 0);
    assert_int_equal(j.results.n, 1);
    assert_int_equal(j.results.at[0].verdict, EXPECT_PROVED);
    arena_free(j.arena);
  }
}

/* Units are looked at when the expectation is read; an edit that would break them is still proposed
 * only if it is true. */
static void units(void **state) {
  (void)state;
  mends("model p\ncoord th [deg]\nparam m = 1 [kg] > 0, l = 2 [m] > 0, g = 9.81 [m/s^2] > 0\n"
        "lagrangian = m/2*l^2*th'^2 + m*g*l*cos(th)\nexpect th'' = -g/l*cos(th)\n",
        "cos(th)", "`cos(th)` should be `sin(th)`");
  mends("model p\ncoord x [m]\nparam m = 1 [kg] > 0\nlagrangian = m/2*x'^2 - x^2*3 [N/m]\nexpect m*x'' = -x*5 [N/m]\n",
        "5 [N/m]", "`5 [N/m]` should be `6 [N/m]`");
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(forms), cmocka_unit_test(functions), cmocka_unit_test(almost_true), cmocka_unit_test(undecided),
    cmocka_unit_test(edits), cmocka_unit_test(edits_elsewhere), cmocka_unit_test(no_single_edit),
    cmocka_unit_test(states_and_flows), cmocka_unit_test(effects), cmocka_unit_test(units),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
