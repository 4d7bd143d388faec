/* simplify and simplify_stable: mass matrices and forces derived from Lagrangians take the forms of
 * the textbooks, values stay what they were, and stable forms keep digits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>

#include "expr_text.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/print.h"
#include "sym/prove.h"
#include "sym/simplify.h"

static jmp_buf out_of_memory;

static Texts start(void) {
  Arena *a = arena_new(NULL);
  arena_guard(a, &out_of_memory);
  return texts(a, " m m1 m2 m3 l l1 l2 l3 g k M G R I1 I2 I3 ");
}

static void finish(Texts *t) { arena_free(expr_arena(t->g)); }

static const char *shown(Texts *t, Expr e) {
  StrBuf b = strbuf(expr_arena(t->g));
  expr_print(t->g, e, PRINT_TEXT, &b);
  return sb_text(&b);
}

/* The two have the same values at random states, to within rounding. */
static void assert_same_values(Texts *t, Expr a, Expr b) {
  long double symbols[64], bound_a, bound_b;
  uint32_t usable = 0;
  for (uint32_t seed = 0; seed < 10; seed++) {
    sample_state(t->g, seed, symbols);
    long double x = value_with_bound(t->g, a, symbols, NULL, &bound_a),
                y = value_with_bound(t->g, b, symbols, NULL, &bound_b);
    if (!isfinite(x) || !isfinite(y)) continue;
    usable++;
    if (fabsl(x - y) > 100 * (bound_a + bound_b) + LDBL_MIN)
      fail_msg("%s is %.18Lg, %s is %.18Lg", shown(t, a), x, shown(t, b), y);
  }
  assert_true(usable > 3);
}

/* Equal expressions are equal nodes, so a form is compared by its number. */
static void assert_form(Texts *t, Expr got, const char *want) {
  Expr e = text_expr(t, want);
  if (got != e) fail_msg("got %s, want %s", shown(t, got), shown(t, e));
}

static void assert_simplifies(const char *from, const char *to) {
  Texts t = start();
  Expr e = text_expr(&t, from), s = simplify(t.g, e);
  assert_same_values(&t, e, s);
  assert_form(&t, s, to);
  finish(&t);
}

static void angles_are_combined_where_it_shortens(void **state) {
  (void)state;
  assert_simplifies("cos(x)*cos(y) + sin(x)*sin(y)", "cos(x - y)");
  assert_simplifies("sin(x)*cos(y) + cos(x)*sin(y)", "sin(x + y)");
  assert_simplifies("cos(x)^2 - sin(x)^2", "cos(2*x)");
  assert_simplifies("m*(cos(x)*cos(y) + sin(x)*sin(y))*cos(z)^2", "m*cos(x - y)*cos(z)^2");
  assert_simplifies("m1 + m2 - m2*(cos(x)*cos(y) + sin(x)*sin(y))^2", "m1 + m2*sin(x - y)^2");
  assert_simplifies("(cos(x - y)*cos(y) - sin(x - y)*sin(y))*m", "m*cos(x)");
  assert_simplifies("m*(cos(x)*cos(y) + sin(x)*sin(y)) + m*sin(x)^2", "m*(cos(x - y) + sin(x)^2)");
  assert_simplifies("m*(cos(x)*cos(y) + sin(x)*sin(y)) + m*sin(y)^2", "m*(cos(x - y) + sin(y)^2)");
  assert_simplifies("m*(cos(x)*cos(y) + sin(x)*sin(y)) + m*sin(x + y)^2", "m*(cos(x - y) + sin(x + y)^2)");
  assert_simplifies("m*sin(x)*cos(y) + m - m*cos(x)^2", "m*sin(x)*(cos(y) + sin(x))");
  assert_simplifies("sin(x)^4 + 2*sin(x)^2*cos(x)^2 + cos(x)^4 + y - 1", "y");
  /* cos(2*x) is -1 + 2*cos(x)^2: asin of it turns its sign */
  assert_simplifies("sin(x) + sin(y)*cos(asin(cos(2*x)/2)) + cos(y)*sin(asin(cos(2*x)/2))",
                    "sin(x) + sin(y + asin(cos(2*x)/2))");
}

/* --- range --- */

/* What is finite 800 units from the origin in a form is in it as it is built, and after simplify. */
static void quotients_are_finite_far_away(void **state) {
  (void)state;
  static const char *const forms[][2] = {
      {"sinh(x)/cosh(x)", "tanh(x)"},
      {"sinh(x)^3/cosh(x)^2", "sinh(x)*tanh(x)^2"},
      {"cosh(x)/sinh(x)", "1/tanh(x)"},
      {"sinh(x)/sqrt(cosh(x))", "tanh(x)*sqrt(cosh(x))"}, /* sinh(x) may be negative */
      {"k/(1 - tanh(x)^2)", "k*cosh(x)^2"},
      {"(1 - tanh(x)^2)/sqrt(1 - tanh(x)^2)", "1/cosh(x)"},
      {"(1 - tanh(x)^2)^2*cosh(x)*k", "k/cosh(x)^3"},
      {"k*y + k*y*sinh(x)^2", "k*y*cosh(x)^2"},
      {"k*cosh(x)^2 - k", "k*sinh(x)^2"},
      {"k*cosh(x)^2 - k*sinh(x)^2", "k"},
      {"exp(x)/exp(y)", "exp(x - y)"},
      {"exp(x)^2/exp(y)^3", "exp(x - y)^2/exp(y)"},
      {"exp(x)/(1 + exp(x))", "1/(1 + exp(-x))"},
      {"exp(x)/(1 + exp(x))^2", "1/((1 + exp(x))*(1 + exp(-x)))"},
      {"exp(x)^2/(k + exp(x))^2", "1/(1 + k*exp(-x))^2"},
      {"exp(x)/sqrt(1 + exp(x))", "sqrt(exp(x))/sqrt(1 + exp(-x))"},
      {"exp(x)*(k/(1 + exp(x)) + m)", "k/(1 + exp(-x)) + m*exp(x)"},
      {"exp(x)*(1 + 4*exp(x))/(1 + exp(x))^2", "1/((1 + exp(x))*(1 + exp(-x))) + 4/(1 + exp(-x))^2"},
      {"exp(-x^2)/(1 + exp(-x^2))", "exp(-x^2)/(1 + exp(-x^2))"},
  };
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    Texts t = start();
    assert_form(&t, text_expr(&t, forms[i][0]), forms[i][1]);
    finish(&t);
  }
  assert_simplifies("k*tanh(x) + k*tanh(x)*cosh(y)", "k*(1 + cosh(y))*tanh(x)");
  assert_simplifies("k*exp(x - y) + m*exp(x - y)", "(k + m)*exp(x - y)");
  assert_simplifies("k*x/hypot(x, y) + m*x/hypot(x, y)", "(k + m)*x/hypot(x, y)");
  assert_simplifies("l*(m + g)^(x + y) + M*(m + g)^(x + y)", "(l + M)*(m + g)^(x + y)");
}

static void what_is_short_stays(void **state) {
  (void)state;
  static const char *const stays[] = {
      "I1*cos(x)^2 + I2*sin(x)^2",
      "I1*sin(x)^2*sin(y)^2 + I2*sin(x)^2*cos(y)^2 + I3*cos(x)^2",
      "m*sin(x)*cos(x)",
      "m*(x' + y')^2*(z - x)^3",
      "M + m*sin(x)^2",
      "k*(sqrt(x^2 + y^2) - l)^2",
      "(x + y + z + m + l + g)^40",
      "x",
  };
  for (size_t i = 0; i < sizeof stays / sizeof *stays; i++) assert_simplifies(stays[i], stays[i]);
}

static void parameters_are_factored(void **state) {
  (void)state;
  /* terms that share a factor need not stand side by side */
  assert_simplifies("k*cos(x) + m1*l1*cos(x) + m2*l1*cos(x) + m3*l1*cos(x) + m1*g*cos(x)",
                    "(k + m1*g + (m1 + m2 + m3)*l1)*cos(x)");
  assert_simplifies("m1*l1^2 + m2*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(x)", "(m1 + m2)*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(x)");
  assert_simplifies("m1*g*x + m2*g*x + m3*g*x + k*y", "(m1 + m2 + m3)*g*x + k*y");
  assert_simplifies("m*x'^2/2 + m*y'^2/2", "m/2*(x'^2 + y'^2)");
  assert_simplifies("k*(x - y) + k*x", "k*(2*x - y)");
  assert_simplifies("k*x^3*sin(y) + k*x^2*sin(y)", "k*x^2*(x + 1)*sin(y)");
  assert_simplifies("k*x^2*sin(y) + k*x^3*sin(y)^2", "k*x^2*sin(y)*(1 + x*sin(y))");
  assert_simplifies("k/x^2*sin(y) + k/x^3*sin(y)", "k*(1 + 1/x)*sin(y)/x^2");
}

static void fractions_are_cancelled(void **state) {
  (void)state;
  assert_simplifies("(m*x + m*y)/(x + y)", "m");
  assert_simplifies("m*(x^2/sqrt(x^2 + y^2)^3 + y^2/sqrt(x^2 + y^2)^3)", "m/sqrt(x^2 + y^2)");
  assert_simplifies("(m - m*cos(x)^2*cos(y)^2 - m*cos(x)^2*sin(y)^2)/sin(x)", "m*sin(x)");
  assert_simplifies("1/(x - y) + 1/(x + y) - 2*x/((x - y)*(x + y)) + g", "g");
}

/* --- mechanics --- */

typedef struct {
  Texts t;
  uint32_t n;
  Expr M[9], f[3]; /* as derived */
} System;

/* M and f from L, where `lets` are pairs (name, text) of coordinates of points; a name followed by
 * ' in L is the total time derivative. */
static System derive(const char *const *q, uint32_t n, const char *const (*lets)[2], uint32_t nlets, const char *L) {
  System s = {.t = start(), .n = n};
  ExprGraph *g = s.t.g;
  Expr seed[64] = {0};
  SymId qs[3], vs[3];
  static char names[8][16];
  for (uint32_t i = 0; i < n; i++) {
    char v[16];
    snprintf(v, sizeof v, "%s'", q[i]);
    qs[i] = text_symbol(&s.t, q[i]);
    vs[i] = text_symbol(&s.t, v);
    seed[qs[i]] = expr_symbol(g, vs[i])->node;
  }
  for (uint32_t i = 0; i < nlets; i++) {
    text_let(&s.t, lets[i][0], lets[i][1]);
    Expr let = s.t.lets[s.t.nlets - 1], rate;
    expr_tangent(g, &let, 1, (ExprSeeds){.at = seed, .n = 64}, "'", NULL, &rate);
    snprintf(names[i], sizeof names[i], "%s'", lets[i][0]);
    s.t.let_names[s.t.nlets] = names[i];
    s.t.lets[s.t.nlets++] = rate;
  }
  Expr lagrangian = text_expr(&s.t, L), p[3], dLdq[3], dp[3];
  expr_gradient(g, lagrangian, vs, n, p);
  expr_gradient(g, lagrangian, qs, n, dLdq);
  expr_tangent(g, p, n, (ExprSeeds){.at = seed, .n = 64}, "'", NULL, dp);
  for (uint32_t i = 0; i < n; i++) {
    s.f[i] = expr_sub(g, dLdq[i], dp[i]);
    for (uint32_t k = 0; k < n; k++) s.M[i * n + k] = expr_diff(g, p[i], vs[k]);
  }
  return s;
}

static void assert_entries(System *s, const char *const *M, const char *const *f) {
  for (uint32_t i = 0; i < s->n * s->n; i++) {
    Expr e = simplify(s->t.g, s->M[i]);
    assert_same_values(&s->t, s->M[i], e);
    assert_form(&s->t, e, M[i]);
  }
  for (uint32_t i = 0; i < s->n; i++) {
    Expr e = simplify(s->t.g, s->f[i]);
    assert_same_values(&s->t, s->f[i], e);
    assert_form(&s->t, e, f[i]);
  }
  finish(&s->t);
}

static void double_pendulum(void **state) {
  (void)state;
  const char *const q[] = {"th1", "th2"};
  const char *const lets[][2] = {
      {"x1", "l1*sin(th1)"}, {"y1", "-l1*cos(th1)"}, {"x2", "x1 + l2*sin(th2)"}, {"y2", "y1 - l2*cos(th2)"}};
  System s = derive(q, 2, lets, 4, "m1/2*(x1'^2 + y1'^2) + m2/2*(x2'^2 + y2'^2) - m1*g*y1 - m2*g*y2");
  const char *const M[] = {"(m1 + m2)*l1^2", "m2*l1*l2*cos(th1 - th2)", "m2*l1*l2*cos(th1 - th2)", "m2*l2^2"};
  const char *const f[] = {"-m2*l1*l2*sin(th1 - th2)*th2'^2 - (m1 + m2)*g*l1*sin(th1)",
                           "m2*l1*l2*sin(th1 - th2)*th1'^2 - m2*g*l2*sin(th2)"};
  assert_entries(&s, M, f);
}

/* The second angle measured from the first link, as on a robot's arm. */
static void double_pendulum_in_relative_angles(void **state) {
  (void)state;
  const char *const q[] = {"a", "b"};
  const char *const lets[][2] = {
      {"x1", "l1*sin(a)"}, {"y1", "-l1*cos(a)"}, {"x2", "x1 + l2*sin(a + b)"}, {"y2", "y1 - l2*cos(a + b)"}};
  System s = derive(q, 2, lets, 4, "m1/2*(x1'^2 + y1'^2) + m2/2*(x2'^2 + y2'^2) - m1*g*y1 - m2*g*y2");
  const char *const M[] = {"(m1 + m2)*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(b)", "m2*l2^2 + m2*l1*l2*cos(b)",
                           "m2*l2^2 + m2*l1*l2*cos(b)", "m2*l2^2"};
  const char *const f[] = {"m2*l1*l2*sin(b)*b'*(2*a' + b') - (m1 + m2)*g*l1*sin(a) - m2*g*l2*sin(a + b)",
                           "-m2*l1*l2*sin(b)*a'^2 - m2*g*l2*sin(a + b)"};
  assert_entries(&s, M, f);
}

static void triple_pendulum(void **state) {
  (void)state;
  const char *const q[] = {"a", "b", "c"};
  const char *const lets[][2] = {{"x1", "l1*sin(a)"},      {"y1", "-l1*cos(a)"},      {"x2", "x1 + l2*sin(b)"},
                                 {"y2", "y1 - l2*cos(b)"}, {"x3", "x2 + l3*sin(c)"}, {"y3", "y2 - l3*cos(c)"}};
  System s = derive(q, 3, lets, 6,
                    "m1/2*(x1'^2 + y1'^2) + m2/2*(x2'^2 + y2'^2) + m3/2*(x3'^2 + y3'^2) - m1*g*y1 - m2*g*y2 - m3*g*y3");
  const char *const M[] = {"(m1 + m2 + m3)*l1^2",        "(m2 + m3)*l1*l2*cos(a - b)", "m3*l1*l3*cos(a - c)",
                           "(m2 + m3)*l1*l2*cos(a - b)", "(m2 + m3)*l2^2",             "m3*l2*l3*cos(b - c)",
                           "m3*l1*l3*cos(a - c)",        "m3*l2*l3*cos(b - c)",        "m3*l3^2"};
  const char *const f[] = {
      "-(m2 + m3)*l1*l2*sin(a - b)*b'^2 - m3*l1*l3*sin(a - c)*c'^2 - (m1 + m2 + m3)*g*l1*sin(a)",
      "(m2 + m3)*l1*l2*sin(a - b)*a'^2 - m3*l2*l3*sin(b - c)*c'^2 - (m2 + m3)*g*l2*sin(b)",
      "m3*l1*l3*sin(a - c)*a'^2 + m3*l2*l3*sin(b - c)*b'^2 - m3*g*l3*sin(c)"};
  assert_entries(&s, M, f);
}

static void cart_pendulum(void **state) {
  (void)state;
  const char *const q[] = {"x", "th"};
  const char *const lets[][2] = {{"px", "x + l*sin(th)"}, {"py", "-l*cos(th)"}};
  System s = derive(q, 2, lets, 2, "M/2*x'^2 + m/2*(px'^2 + py'^2) - m*g*py");
  const char *const M[] = {"M + m", "m*l*cos(th)", "m*l*cos(th)", "m*l^2"};
  const char *const f[] = {"m*l*sin(th)*th'^2", "-m*g*l*sin(th)"};
  assert_entries(&s, M, f);
}

static void spherical_pendulum(void **state) {
  (void)state;
  const char *const q[] = {"th", "ph"};
  const char *const lets[][2] = {{"px", "l*sin(th)*cos(ph)"}, {"py", "l*sin(th)*sin(ph)"}, {"pz", "-l*cos(th)"}};
  System s = derive(q, 2, lets, 3, "m/2*(px'^2 + py'^2 + pz'^2) - m*g*pz");
  const char *const M[] = {"m*l^2", "0", "0", "m*l^2*sin(th)^2"};
  const char *const f[] = {"m*l^2*sin(th)*cos(th)*ph'^2 - m*g*l*sin(th)", "-2*m*l^2*sin(th)*cos(th)*th'*ph'"};
  assert_entries(&s, M, f);
}

static void kepler_in_polar_coordinates(void **state) {
  (void)state;
  const char *const q[] = {"r", "ph"};
  const char *const lets[][2] = {{"px", "r*cos(ph)"}, {"py", "r*sin(ph)"}};
  System s = derive(q, 2, lets, 2, "m/2*(px'^2 + py'^2) + G*M*m/sqrt(px^2 + py^2 + 0*r)");
  /* r is a coordinate of unknown sign: the distance is |r| */
  const char *const M[] = {"m", "0", "0", "m*r^2"};
  for (uint32_t i = 0; i < 4; i++) assert_form(&s.t, simplify(s.t.g, s.M[i]), M[i]);
  assert_form(&s.t, simplify(s.t.g, s.f[1]), "-2*m*r*r'*ph'");
  assert_same_values(&s.t, s.f[0], text_expr(&s.t, "m*r*ph'^2 - G*M*m*r/abs(r)^3"));
  assert_same_values(&s.t, s.f[0], simplify(s.t.g, s.f[0]));
  finish(&s.t);
  System plain = derive(q, 2, lets, 2, "m/2*(px'^2 + py'^2) + G*M*m/r");
  const char *const f[] = {"m*r*ph'^2 - G*M*m/r^2", "-2*m*r*r'*ph'"};
  assert_entries(&plain, M, f);
}

static void kepler_in_cartesian_coordinates(void **state) {
  (void)state;
  const char *const q[] = {"x", "y"};
  System s = derive(q, 2, NULL, 0, "m/2*(x'^2 + y'^2) + G*M*m/sqrt(x^2 + y^2)");
  const char *const M[] = {"m", "0", "0", "m"};
  const char *const f[] = {"-G*M*m*x/(x^2 + y^2)^(3/2)", "-G*M*m*y/(x^2 + y^2)^(3/2)"};
  assert_entries(&s, M, f);
}

/* Random polynomials in sines, cosines and roots: nothing but the form may change. */
static void random_sums_keep_their_values(void **state) {
  (void)state;
  static const char *const factors[] = {"m1", "m2", "l^2", "1/l", "x'", "y'", "sin(x)", "cos(x)", "sin(y)", "cos(y)",
                                        "sin(x - y)", "cos(2*x + y)", "sin(x)^2", "cos(y)^3", "sqrt(z^2 + 1)",
                                        "1/(m1 + m2*sin(y)^2)", "tan(y)", "exp(-x)", "abs(z)", "3/7"};
  uint32_t seed = 5, changed = 0;
  for (int round = 0; round < 200; round++) {
    Texts t = start();
    Expr sum = expr_int(t.g, 0);
    for (int i = 0; i < 6; i++) {
      Expr product = expr_int(t.g, i % 2 ? 1 : -2);
      for (int k = 0; k < 4; k++) {
        seed = seed * 1664525u + 1013904223u;
        Expr f = text_expr(&t, factors[(seed >> 16) % (sizeof factors / sizeof *factors)]);
        product = expr_mul(t.g, product, f);
      }
      sum = expr_add(t.g, sum, product);
    }
    Expr s = simplify(t.g, sum);
    changed += s != sum;
    assert_same_values(&t, sum, s);
    assert_int_not_equal(prove_zero(t.g, expr_sub(t.g, sum, s), NULL), PROVED_NONZERO);
    assert_same_values(&t, sum, simplify_stable(t.g, sum));
    finish(&t);
  }
  assert_true(changed > 20);
}

static void results_do_not_depend_on_what_was_done_before(void **state) {
  (void)state;
  const char *text = "-m2*l1*l2*(sin(x)*cos(y) - cos(x)*sin(y))*y'^2 - m1*g*l1*sin(x) - m2*g*l1*sin(x)";
  Texts once = start(), twice = start();
  Expr a = simplify(once.g, text_expr(&once, text)), b = text_expr(&twice, text);
  simplify(twice.g, text_expr(&twice, "m1*cos(y)*cos(x) + m1*sin(x)*sin(y) + m2*g"));
  b = simplify(twice.g, b);
  assert_same_values(&twice, b, simplify(twice.g, b));
  assert_int_equal(b, simplify(twice.g, b));
  assert_string_equal(shown(&once, a), shown(&twice, b));
  finish(&once);
  finish(&twice);
}

/* --- stable forms --- */

static void assert_stable(const char *from, const char *to) {
  Texts t = start();
  Expr e = text_expr(&t, from), s = simplify_stable(t.g, e);
  assert_same_values(&t, e, s);
  assert_form(&t, s, to);
  finish(&t);
}

static void half_angles_and_differences_of_squares(void **state) {
  (void)state;
  assert_stable("m*g*l - m*g*l*cos(x)", "2*m*g*l*sin(x/2)^2");
  assert_stable("m*g*l*cos(x) - m*g*l + k*x^2", "k*x^2 - 2*m*g*l*sin(x/2)^2");
  assert_stable("(m + M)*g*(1 - cos(x - y))", "2*(m + M)*g*sin((x - y)/2)^2");
  assert_stable("m + M - (m + M)*cos(x)", "2*(m + M)*sin(x/2)^2");
  assert_stable("1 + cos(x)", "2*cos(x/2)^2");
  assert_stable("k*(cosh(x/l) - 1)", "2*k*sinh(x/(2*l))^2");
  assert_stable("cos(x)*cos(y) - cos(x)", "-2*cos(x)*sin(y/2)^2");
  assert_stable("1 - z^2", "(1 - z)*(1 + z)");
  assert_stable("x^2 - y^2", "(x - y)*(x + y)");
  assert_stable("4 - 9*z^2", "(2 - 3*z)*(2 + 3*z)");
  assert_stable("sqrt(R^2 - z^2) + exp(x)/(k*(1 - cos(y)))", "sqrt((R - z)*(R + z)) + exp(x)/(2*k*sin(y/2)^2)");
}

static void other_sums_stay(void **state) {
  (void)state;
  static const char *const stays[] = {"m*g*l - m*g*l1*cos(x)", "x^2 + y^2", "x^2 - y", "2 - z^2", "cos(x) - cos(y)",
                                      "x'^2 + y'^2 - z'^2", "cosh(x) + 1"};
  for (size_t i = 0; i < sizeof stays / sizeof *stays; i++) assert_stable(stays[i], stays[i]);
}

/* Simplification may divide, and lose digits near x = 0 that the text has. */
static void quotients_keep_the_digits_of_their_text(void **state) {
  (void)state;
  static const char *const pairs[][2] = {{"sin(x)^2/(1 + cos(x))", "2*sin(x/2)^2"},
                                         {"(1 - cos(x)^2)/(1 + cos(x))", "2*sin(x/2)^2"},
                                         {"1 - cos(x)", "1 - cos(x)"}};
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    Texts t = start();
    Expr e = text_expr(&t, pairs[i][0]), s = simplify_stable_quotients(t.g, simplify(t.g, e), e);
    assert_same_values(&t, e, s);
    assert_form(&t, s, pairs[i][1]);
    finish(&t);
  }
}

static void definitions_keep_their_names(void **state) {
  (void)state;
  Texts t = start();
  text_let(&t, "V", "m*g*l*(1 - cos(x))");
  Expr e = text_expr(&t, "V + y^2"), s = simplify_stable(t.g, e);
  assert_non_null(strchr(shown(&t, s), 'V'));
  assert_int_not_equal(e, s);
  assert_same_values(&t, e, s);
  finish(&t);
}

/* Decimal digits that a value has in common with the exact one. */
static double digits(long double value, long double exact) {
  long double error = fabsl((value - exact) / exact);
  return error == 0 ? 19 : (double)-log10l(error);
}

/* The exact value is given by the caller from a series: it is not computed by the code under test. */
static void assert_gain(const char *text, const char *name, long double x, long double exact, double at_least) {
  Texts t = start();
  Expr e = text_expr(&t, text), both[2];
  both[0] = e;
  both[1] = simplify_stable(t.g, e);
  long double symbols[64], values[2];
  sample_state(t.g, 1, symbols);
  symbols[text_symbol(&t, name)] = x;
  expr_eval(t.g, both, 2, symbols, values);
  double before = digits(values[0], exact), after = digits(values[1], exact);
  if (after < 17 || after - before < at_least) fail_msg("%s: %.1f digits before, %.1f after", text, before, after);
  finish(&t);
}

static void stable_forms_keep_digits(void **state) {
  (void)state;
  const long double u = 1e-6L;
  /* 1 - cos u = u^2/2 - u^4/24 + ..., cosh u - 1 = u^2/2 + u^4/24 + ...: the next term is 1e-30 of it */
  assert_gain("1 - cos(x)", "x", u, u * u / 2 * (1 - u * u / 12), 9);
  assert_gain("cosh(x) - 1", "x", u, u * u / 2 * (1 + u * u / 12), 9);
  assert_gain("(R - R*cos(x))/R", "x", u, u * u / 2 * (1 - u * u / 12), 9);
  /* 1 - z^2 at z = 1 - h is h*(2 - h); z is exact, and z^2 loses the lower half of h^2 */
  const long double h = 0x1.2345678p-31L;
  assert_gain("1/(1 - z^2)", "z", 1 - h, 1 / (h * (2 - h)), 8);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(angles_are_combined_where_it_shortens),
      cmocka_unit_test(quotients_are_finite_far_away),
      cmocka_unit_test(what_is_short_stays),
      cmocka_unit_test(parameters_are_factored),
      cmocka_unit_test(fractions_are_cancelled),
      cmocka_unit_test(double_pendulum),
      cmocka_unit_test(double_pendulum_in_relative_angles),
      cmocka_unit_test(triple_pendulum),
      cmocka_unit_test(cart_pendulum),
      cmocka_unit_test(spherical_pendulum),
      cmocka_unit_test(kepler_in_polar_coordinates),
      cmocka_unit_test(kepler_in_cartesian_coordinates),
      cmocka_unit_test(random_sums_keep_their_values),
      cmocka_unit_test(results_do_not_depend_on_what_was_done_before),
      cmocka_unit_test(half_angles_and_differences_of_squares),
      cmocka_unit_test(other_sums_stay),
      cmocka_unit_test(quotients_keep_the_digits_of_their_text),
      cmocka_unit_test(definitions_keep_their_names),
      cmocka_unit_test(stable_forms_keep_digits),
  };
  if (setjmp(out_of_memory)) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
