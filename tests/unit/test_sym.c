/* Unit tests of the expression graph: laws of canonical form, derivatives, printing, substitution,
 * depth. Random expressions are judged by what they evaluate to, and that by the C library. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "slow.h"
#include "sym/diff.h"
#include "sym/print.h"

enum { NSYM = 6 };
static const char *const sym_names[NSYM] = {"x", "y", "a", "b", "t", "z"}; /* a and b are positive */

typedef struct {
  Arena *a;
  ExprGraph *g;
  SymId sym[NSYM];
  Expr pool[64];
  uint32_t n;
} Lab;

static Lab lab_new(void) {
  Lab l = {.a = arena_new(NULL)};
  Interner *names = interner_new(l.a);
  l.g = expr_graph(l.a, names);
  for (int i = 0; i < NSYM; i++) {
    SymKind kind = i == 2 || i == 3 ? SYM_PARAM : i == 4 ? SYM_TIME : i == 5 ? SYM_STATE : SYM_COORD;
    ExprSign sign = kind == SYM_PARAM ? SIGN_POSITIVE : SIGN_UNKNOWN;
    l.sym[i] = expr_declare(l.g, kind, (uint32_t)i, intern(names, sym_names[i]), sign);
    l.pool[l.n++] = expr_symbol(l.g, l.sym[i])->node;
  }
  return l;
}

static uint32_t below(uint32_t n) { return (uint32_t)uniform(0, (long double)n); }
static Expr any(const Lab *l) { return l->pool[below(l->n)]; }

/* One random operation on what is there. smooth: nothing that has a kink. */
static Expr random_step(Lab *l, int smooth) {
  ExprGraph *g = l->g;
  Expr x = any(l), y = any(l), z = any(l);
  static const ExprOp unary[] = {EX_SIN, EX_COS, EX_ATAN, EX_TANH, EX_SINH, EX_COSH,
                                 EX_EXP, EX_TAN, EX_ASIN, EX_ACOS, EX_LOG,  EX_CBRT};
  switch (below(smooth ? 12 : 16)) {
    case 0: case 1: return expr_add(g, x, y);
    case 2: return expr_sub(g, x, y);
    case 3: case 4: return expr_mul(g, x, y);
    case 5: return expr_div(g, x, y);
    case 6: return expr_scale(g, num_ratio((int64_t)below(9) - 4, 1 + (int64_t)below(3)), x);
    case 7: return expr_pow_num(g, x, num_ratio((int64_t)below(7) - 3, 1 + (int64_t)below(3)));
    case 8: return expr_fn(g, unary[below(sizeof unary / sizeof *unary)], x);
    case 9: { Expr n = expr_num(g, num_ratio((int64_t)below(9) - 4, 1 + (int64_t)below(4))); return expr_add(g, x, n); }
    case 10: return expr_fn2(g, below(2) ? EX_ATAN2 : EX_HYPOT, x, y);
    case 11: return expr_pow(g, x, y);
    case 12: return expr_fn2(g, below(2) ? EX_MIN : EX_MAX, x, y);
    case 13: return expr_fn(g, below(2) ? EX_ABS : EX_SIGN, x);
    default: { Expr c = expr_fn2(g, below(2) ? EX_LT : EX_LE, x, y); return expr_select(g, c, z, x); }
  }
}

static Expr random_expr(Lab *l, int steps, int smooth) {
  l->n = NSYM;
  for (int i = 0; i < steps; i++) l->pool[l->n++] = random_step(l, smooth);
  return l->pool[l->n - 1];
}

static void random_values(long double *v) {
  for (int i = 0; i < NSYM; i++) v[i + 1] = i == 2 || i == 3 ? uniform(0.2L, 1.5L) : uniform(-1.5L, 1.5L);
}

static long double value(Lab *l, Expr e, const long double *v) {
  long double x;
  expr_eval(l->g, &e, 1, v, &x);
  return x;
}

/* ---- laws ---- */

static void test_laws(void **state) {
  (void)state;
  Lab l = lab_new();
  ExprGraph *g = l.g;
  for (int i = 0; i < 400; i++) {
    random_expr(&l, 8, 0);
    Expr x = any(&l), y = any(&l), z = any(&l);
    assert_int_equal(expr_add(g, x, y), expr_add(g, y, x));
    assert_int_equal(expr_mul(g, x, y), expr_mul(g, y, x));
    Expr xy = expr_add(g, x, y), yz = expr_add(g, y, z);
    assert_int_equal(expr_add(g, xy, z), expr_add(g, x, yz));
    assert_int_equal(expr_sub(g, x, x), expr_int(g, 0));
    assert_int_equal(expr_sub(g, xy, y), x);
    Expr minus = expr_neg(g, x);
    assert_int_equal(expr_neg(g, minus), x);
    assert_int_equal(expr_add(g, x, x), expr_scale(g, num_int(2), x));
    assert_int_equal(expr_mul(g, x, x), expr_pow_num(g, x, num_int(2)));
    if (x != expr_int(g, 0)) assert_int_equal(expr_div(g, x, x), expr_int(g, 1));
    Expr s = expr_fn(g, EX_SIN, x), c = expr_fn(g, EX_COS, x);
    Expr s2 = expr_pow_num(g, s, num_int(2)), c2 = expr_pow_num(g, c, num_int(2));
    assert_int_equal(expr_add(g, s2, c2), expr_int(g, 1));
    assert_int_equal(expr_fn(g, EX_SIN, minus), expr_neg(g, s));
    assert_int_equal(expr_fn(g, EX_COS, minus), c);
  }
  arena_free(l.a);
}

/* What construction guarantees: arguments before nodes; sums and products flat, sorted, without zeros. */
static void test_canonical(void **state) {
  (void)state;
  Lab l = lab_new();
  ExprGraph *g = l.g;
  for (int i = 0; i < 300; i++) random_expr(&l, 20, 0);
  for (Expr e = 1; e <= expr_count(g); e++) {
    ExprOp op = expr_op(g, e);
    for (uint32_t k = 0; k < expr_nargs(g, e); k++) assert_true(expr_arg(g, e, k) < e);
    if (op != EX_SUM && op != EX_PROD) continue;
    Expr before = 0;
    for (uint32_t k = 0; k < expr_pairs(g, e, op); k++) {
      Num c;
      Expr x = expr_pair(g, e, op, k, &c);
      assert_true(x > before);
      assert_false(num_is_zero(c));
      /* (x^2*y)^(1/2) keeps the product it is a power of */
      if (expr_op(g, x) == op) assert_true(op == EX_PROD && !num_is_int(c));
      before = x;
    }
  }
  arena_free(l.a);
}

/* ---- evaluation ---- */

static void test_eval(void **state) {
  (void)state;
  Lab l = lab_new();
  ExprGraph *g = l.g;
  Expr x = l.pool[0], y = l.pool[1], a = l.pool[2];
  for (int i = 0; i < 200; i++) {
    long double v[NSYM + 1], X, Y, A;
    random_values(v);
    X = v[1], Y = v[2], A = v[3];
    struct { Expr e; long double want;
    } all[] = {
        {expr_fn(g, EX_SIN, x), sinl(X)},
        {expr_fn(g, EX_COS, x), cosl(X)},
        {expr_fn(g, EX_TAN, x), tanl(X)},
        {expr_fn(g, EX_ASIN, expr_fn(g, EX_SIN, y)), asinl(sinl(Y))},
        {expr_fn(g, EX_ACOS, expr_fn(g, EX_SIN, y)), acosl(sinl(Y))},
        {expr_fn(g, EX_ATAN, x), atanl(X)},
        {expr_fn(g, EX_SINH, x), sinhl(X)},
        {expr_fn(g, EX_COSH, x), coshl(X)},
        {expr_fn(g, EX_TANH, x), tanhl(X)},
        {expr_fn(g, EX_EXP, x), expl(X)},
        {expr_fn(g, EX_LOG, a), logl(A)},
        {expr_fn(g, EX_CBRT, x), cbrtl(X)},
        {expr_fn(g, EX_ABS, x), fabsl(X)},
        {expr_fn(g, EX_SIGN, x), X > 0 ? 1 : -1},
        {expr_fn2(g, EX_ATAN2, y, x), atan2l(Y, X)},
        {expr_fn2(g, EX_HYPOT, x, y), hypotl(X, Y)},
        {expr_fn2(g, EX_MIN, x, y), fminl(X, Y)},
        {expr_fn2(g, EX_MAX, x, y), fmaxl(X, Y)},
        {expr_select(g, expr_fn2(g, EX_LT, x, y), a, y), X < Y ? A : Y},
        {expr_select(g, expr_fn(g, EX_NOT, expr_fn2(g, EX_LE, x, y)), a, y), X <= Y ? Y : A},
        {expr_pow(g, a, y), powl(A, Y)},
        {expr_sqrt(g, a), sqrtl(A)},
        {expr_pow_num(g, x, num_int(-3)), 1 / (X * X * X)},
        {expr_pow_num(g, a, num_ratio(5, 3)), powl(A, 5.0L / 3)},
    };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
      long double got = value(&l, all[k].e, v);
      assert_true(fabsl(got - all[k].want) <= 1e-17L * (1 + fabsl(all[k].want)));
    }
  }
  arena_free(l.a);
}

/* ---- derivatives ---- */

/* A central difference; its own error is judged from two step sizes. */
static long double numeric(Lab *l, Expr e, SymId s, long double *v, long double *error) {
  long double d[2], x = v[s];
  for (int k = 0; k < 2; k++) {
    long double h = k ? 5e-6L : 1e-5L;
    v[s] = x + h;
    long double up = value(l, e, v);
    v[s] = x - h;
    d[k] = (up - value(l, e, v)) / (2 * h);
  }
  v[s] = x;
  *error = fabsl(d[0] - d[1]) + 1e-9L * (1 + fabsl(d[1]));
  return d[1];
}

static void test_derivatives(void **state) {
  (void)state;
  int judged = 0;
  for (int i = 0; i < 400; i++) {
    Lab l = lab_new();
    Expr e = random_expr(&l, 10, 1), grad[NSYM];
    expr_gradient(l.g, e, l.sym, NSYM, grad);
    for (int k = 0; k < NSYM; k++) {
      Expr forward = expr_diff(l.g, e, l.sym[k]);
      for (int trial = 0; trial < 3; trial++) {
        long double v[NSYM + 1], error;
        random_values(v);
        long double f = value(&l, forward, v), r = value(&l, grad[k], v), d = numeric(&l, e, l.sym[k], v, &error);
        if (!isfinite(f) || !isfinite(d) || !isfinite(r) || fabsl(d) > 1e6L || error > 1e-3L * (1 + fabsl(d))) continue;
        assert_true(fabsl(f - r) <= 1e-13L * (1 + fabsl(f)));
        assert_true(fabsl(f - d) <= 20 * error);
        judged++;
      }
    }
    arena_free(l.a);
  }
  assert_true(judged > 2000);
}

/* Definitions are looked through by both modes, and named. */
static void test_definitions(void **state) {
  (void)state;
  Lab l = lab_new();
  ExprGraph *g = l.g;
  Interner *names = interner_new(l.a);
  Expr chain = l.pool[0];
  for (int i = 0; i < 20; i++) {
    Expr s = expr_fn(g, EX_SIN, chain), prod = expr_mul(g, s, l.pool[1]), sum = expr_add(g, prod, l.pool[2]);
    chain = expr_def(g, intern(names, "c"), sum);
  }
  Expr grad[NSYM], flat = expr_expand_defs(g, chain);
  expr_gradient(g, chain, l.sym, NSYM, grad);
  long double v[NSYM + 1];
  random_values(v);
  assert_true(value(&l, flat, v) == value(&l, chain, v));
  for (int k = 0; k < 3; k++) {
    Expr d = expr_diff(g, flat, l.sym[k]), named = expr_diff(g, chain, l.sym[k]);
    long double want = value(&l, d, v);
    assert_true(fabsl(value(&l, grad[k], v) - want) <= 1e-15L * (1 + fabsl(want)));
    assert_true(fabsl(value(&l, named, v) - want) <= 1e-15L * (1 + fabsl(want)));
  }
  arena_free(l.a);
}

/* ---- substitution ---- */

static void test_substitute(void **state) {
  (void)state;
  int judged = 0;
  for (int i = 0; i < 300; i++) {
    Lab l = lab_new();
    Expr e = random_expr(&l, 12, 0), f = l.pool[NSYM + below(6)], with[NSYM + 1] = {0};
    with[l.sym[0]] = f;
    Expr s = expr_substitute(l.g, e, with, NSYM + 1, "");
    long double v[NSYM + 1], w[NSYM + 1];
    random_values(v);
    memcpy(w, v, sizeof v);
    w[1] = value(&l, f, v);
    long double want = value(&l, e, w), got = value(&l, s, v);
    if (isfinite(want) && isfinite(got) && fabsl(want) < 1e6L && isfinite(w[1])) {
      assert_true(fabsl(want - got) <= 1e-10L * (1 + fabsl(want)));
      judged++;
    }
    arena_free(l.a);
  }
  assert_true(judged > 100);
}

/* ---- printing ---- */

/* Text is .lag syntax: read back, it has the same value. */
/* What LaTeX reads, by hand. */
static void test_latex_names(void **state) {
  (void)state;
  static const char *const rows[][2] = {
      {"x", "x"}, {"th1", "\\theta_{1}"}, {"x_1", "x_{1}"}, {"x[3]", "x_{3}"}, {"mass", "\\mathrm{mass}"},
      {"x'", "\\dot{x}"}, {"drag.c", "c_{\\mathrm{drag}}"}, {"p_th1", "p_{\\theta_{1}}"}, {"x\u2081", "x_{1}"},
      {"\u03b8\u2081\u2080''", "\\ddot{\\theta}_{10}"}, {"\u00e9", "\\mathrm{\u00e9}"},
  };
  Arena *a = arena_new(NULL);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    StrBuf out = strbuf(a);
    name_print(rows[i][0], PRINT_LATEX, &out);
    assert_string_equal(sb_text(&out), rows[i][1]);
  }
  arena_free(a);
}

static void test_print(void **state) {
  (void)state;
  int judged = 0;
  for (int i = 0; i < 300; i++) {
    Lab l = lab_new();
    Expr e = random_expr(&l, 9, 0);
    StrBuf lag = strbuf(l.a);
    sb_puts(&lag, "model m\ncoord x, y\nstate z\nparam a = 1 > 0, b = 1 > 0\nflow z' = 0\nlagrangian = x'^2 + "
                  "y'^2\nobserve o = ");
    expr_print(l.g, e, PRINT_TEXT, &lag);
    sb_puts(&lag, "\n");
    const char *zero[] = {"inf", "nan", "(0)", "/0"};
    int divided = 0; /* by a literal zero: no model gets so far */
    for (int k = 0; k < 4; k++) divided |= strstr(sb_text(&lag), zero[k]) != NULL;
    if (divided) {
      arena_free(l.a);
      continue;
    }
    Eqns *back = equations(l.a, sb_text(&lag), NULL);
    if (!back) fputs(sb_text(&lag), stderr);
    assert_non_null(back);
    for (int trial = 0; trial < 4; trial++) {
      long double v[NSYM + 1], *w = random_point(back), got;
      random_values(v);
      for (int k = 0; k < NSYM; k++) w[symbol_named(back, sym_names[k])] = v[k + 1];
      long double want = value(&l, e, v);
      Expr o = back->m->observes.at[0].value;
      expr_eval(back->g, &o, 1, w, &got);
      if (!isfinite(want) || fabsl(want) > 1e9L) continue;
      if (!(fabsl(want - got) <= 1e-11L * (1 + fabsl(want))))
        fprintf(stderr, "%s%Lg, not %Lg\n", sb_text(&lag), got, want);
      assert_true(fabsl(want - got) <= 1e-11L * (1 + fabsl(want)));
      judged++;
    }
    arena_free(l.a);
  }
  assert_true(judged > 500);
}

/* ---- depth ---- */

static void test_depth(void **state) {
  (void)state;
  const int deep = slow(200000, 50000);
  Lab l = lab_new();
  ExprGraph *g = l.g;
  Expr e = l.pool[0];
  for (int i = 0; i < deep; i++) e = expr_fn(g, EX_SIN, e);
  long double v[NSYM + 1] = {0, 1};
  long double x = 1;
  for (int i = 0; i < deep; i++) x = sinl(x);
  assert_true(value(&l, e, v) == x);
  assert_true(expr_contains_sym(g, e, l.sym[0]));
  assert_false(expr_contains_sym(g, e, l.sym[1]));
  Expr with[NSYM + 1] = {0};
  with[l.sym[0]] = l.pool[1];
  Expr s = expr_substitute(g, e, with, NSYM + 1, "");
  assert_true(expr_contains_sym(g, s, l.sym[1]) && !expr_contains_sym(g, s, l.sym[0]));
  StrBuf out = strbuf(l.a);
  expr_print(g, e, PRINT_TEXT, &out);
  assert_int_equal(out.n, 5 * (size_t)deep + 1);
  arena_free(l.a);
}

/* A chain of lets keeps its length under both modes of differentiation. */
static void test_long_chain(void **state) {
  (void)state;
  const int length = slow(30000, 10000);
  Lab l = lab_new();
  ExprGraph *g = l.g;
  Interner *names = interner_new(l.a);
  Expr e = l.pool[0];
  for (int i = 0; i < length; i++) {
    Expr s = expr_fn(g, EX_SIN, e), sum = expr_add(g, s, l.pool[1]);
    e = expr_def(g, intern(names, "c"), sum);
  }
  uint32_t before = expr_count(g);
  Expr d = expr_diff(g, e, l.sym[0]), grad[2];
  expr_gradient(g, e, l.sym, 2, grad);
  assert_true(expr_count(g) - before < 20 * (uint32_t)length);
  long double v[NSYM + 1] = {0, 0.5L, 0.25L}, x = 0.5L, dx = 1, dy = 0;
  for (int i = 0; i < length; i++) {
    dx *= cosl(x);
    dy = dy * cosl(x) + 1;
    x = sinl(x) + 0.25L;
  }
  assert_true(fabsl(value(&l, d, v) - dx) <= 1e-12L * fabsl(dx) + 1e-300L);
  assert_true(fabsl(value(&l, grad[1], v) - dy) <= 1e-12L * fabsl(dy));
  arena_free(l.a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_laws),        cmocka_unit_test(test_canonical),   cmocka_unit_test(test_eval),
      cmocka_unit_test(test_derivatives), cmocka_unit_test(test_definitions), cmocka_unit_test(test_substitute),
      cmocka_unit_test(test_latex_names), cmocka_unit_test(test_print),       cmocka_unit_test(test_depth),
      cmocka_unit_test(test_long_chain),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
