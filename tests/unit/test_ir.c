/* Unit tests of src/ir: programs against the expressions they were lowered from, the linear solvers
 * against elimination with full pivoting, the checker and the tidying pass. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "ir/passes.h"

typedef long double Real;

/* ---- the checker ---- */

static Slot load(Prog *p, uint32_t i) {
  return prog_ins(p, (Ins){.op = IR_LOAD, .array = ARR_Q, .index = i, .name = "q"});
}

/* A malformed program goes through no pass and says so; the accelerations of a short model go through those of short
 * programs, in order. */
static void test_passes(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  Slot x = load(p, 0), y = load(p, 1), sum = prog_op(p, IR_ADD, x, y), less = prog_op(p, IR_LT, x, y);
  prog_store(p, 0, 0, sum, "out");
  p->ins.at[sum].a = less; /* computes with a condition */
  Prog *q = passes_run(p, &(PassPlan){.every_step = 1}, NULL);
  assert_non_null(prog_verify(q));
  assert_string_equal(prog_verify(q), "after lowering: instruction 3 uses a later one");
  arena_free(a);

  a = arena_new(NULL);
  p = prog_new(a);
  StrBuf trace = strbuf(a);
  prog_store(p, 0, 0, prog_op(p, IR_MUL, load(p, 0), load(p, 1)), "out");
  passes_run(p, &(PassPlan){.nests_from = 1500, .every_step = 1}, &trace);
  const char *order[] = {"after lowering:", "after tidy:", "after factor:", "after product_cse:",
                         "after reassociate_fma:"},
             *at = sb_text(&trace);
  for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
    at = strstr(at, order[i]);
    assert_non_null(at);
  }
  assert_null(strstr(sb_text(&trace), "after find_nests:"));
  arena_free(a);
}

static void test_verify(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  Slot x = load(p, 0), y = load(p, 1), sum = prog_op(p, IR_ADD, x, y), less = prog_op(p, IR_LT, x, y);
  Slot chosen = prog_ins(p, (Ins){.op = IR_SELECT, .a = less, .b = sum, .c = x});
  prog_store(p, 0, 0, chosen, "out");
  assert_null(prog_verify(p));
  Ins good = p->ins.at[sum];
  p->ins.at[sum].a = chosen; /* uses a later one */
  assert_non_null(prog_verify(p));
  p->ins.at[sum] = good;
  p->ins.at[chosen].op = IR_MUL; /* computes with a condition */
  assert_non_null(prog_verify(p));
  p->ins.at[chosen] = (Ins){.op = IR_NOT, .a = x}; /* no condition */
  assert_non_null(prog_verify(p));
  p->ins.at[chosen] = (Ins){.op = IR_SOLVED, .a = x}; /* no solve */
  assert_non_null(prog_verify(p));
  p->ins.at[chosen] = (Ins){.op = IR_NEG, .a = x};
  assert_null(prog_verify(p));
  p->stores.at[0].slot = 1000; /* a store of nothing */
  assert_non_null(prog_verify(p));
  arena_free(a);
}

/* ---- value numbering and tidying ---- */

static void test_numbering(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  Slot x = load(p, 0), y = load(p, 1), one = prog_num(p, num_int(1)), two = prog_num(p, num_int(2));
  assert_int_equal(prog_num(p, num_int(0)), 0);
  assert_int_equal(load(p, 0), x);
  assert_int_equal(prog_op(p, IR_ADD, x, y), prog_op(p, IR_ADD, y, x));
  assert_int_equal(prog_op(p, IR_MUL, x, y), prog_op(p, IR_MUL, y, x));
  assert_int_not_equal(prog_op(p, IR_SUB, x, y), prog_op(p, IR_SUB, y, x));
  assert_int_not_equal(prog_op(p, IR_DIV, x, y), prog_op(p, IR_DIV, y, x));
  assert_int_equal(prog_op(p, IR_ADD, x, 0), x);
  assert_int_equal(prog_op(p, IR_MUL, x, 0), 0);
  assert_int_equal(prog_op(p, IR_MUL, one, x), x);
  assert_int_equal(prog_op(p, IR_DIV, x, one), x);
  assert_int_equal(prog_op(p, IR_DIV, 0, x), 0);
  Slot minus = prog_op(p, IR_SUB, 0, x);
  assert_int_equal(p->ins.at[minus].op, IR_NEG);
  assert_int_equal(prog_op(p, IR_NEG, minus, 0), x);
  Slot s = prog_ins(p, (Ins){.op = IR_FN1, .a = x, .text = "sin"}),
       c = prog_ins(p, (Ins){.op = IR_FN1, .a = x, .text = "cos"});
  assert_int_not_equal(s, c);
  assert_int_equal(prog_ins(p, (Ins){.op = IR_FN1, .a = x, .text = "sin"}), s);
  assert_int_not_equal(two, one);
  arena_free(a);
}

static uint32_t count(const Prog *p, IrOp op) {
  uint32_t n = 0;
  for (Slot s = 1; s < p->ins.n; s++) n += p->ins.at[s].op == op;
  return n;
}

static void test_tidy(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  Slot x = load(p, 0), y = load(p, 1), z = load(p, 2);
  Slot dead = prog_op(p, IR_SQRT, z, 0);
  (void)dead;
  Slot d1 = prog_op(p, IR_DIV, x, y), d2 = prog_op(p, IR_DIV, z, y), two = prog_num(p, num_int(2)),
       d3 = prog_op(p, IR_DIV, x, two);
  Slot d4 = prog_op(p, IR_DIV, x, z);
  prog_store(p, 0, 0, d1, "a");
  prog_store(p, 0, 1, d2, "b");
  prog_store(p, 0, 2, d3, "c");
  prog_store(p, 0, 3, d4, "d");
  Prog *t = prog_tidy(p);
  assert_null(prog_verify(t));
  assert_int_equal(count(t, IR_SQRT), 0);
  assert_int_equal(count(t, IR_DIV), 3); /* 1/y, x/2 and x/z */
  assert_int_equal(count(t, IR_MUL), 2);
  Real q[3] = {3, 7, 5}, out[4], *outs[1] = {out};
  const Real *in[ARR_COUNT] = {[ARR_Q] = q};
  assert_int_equal(prog_eval(t, in, outs), 0);
  Real want[4] = {3.0L / 7, 5.0L / 7, 1.5L, 0.6L};
  for (int i = 0; i < 4; i++) assert_true(fabsl(out[i] - want[i]) < 1e-18L);
  OpCount c = prog_count(t);
  assert_int_equal(c.div, 3);
  assert_int_equal(c.mul, 2);
  assert_int_equal(ops_total(c), 5);
  arena_free(a);
}

/* The elements that are not zero. */
static SolveElements listed(Arena *a, const Slot *matrix, size_t count) {
  SolveElements list = {0};
  for (size_t j = 0; j < count; j++)
    if (matrix[j]) vec_push(a, &list, ((SolveElement){(uint32_t)j, matrix[j]}));
  return list;
}

/* Elimination of 2000 unknowns: n (n - 1) (2 n + 5)/6 products, as many sums, n (n + 1)/2 quotients, in all more
 * than 2^32. */
static void test_count_of_many(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  enum { N = 2000 };
  Slot *matrix = ARENA_ARRAY(a, Slot, (size_t)N * N); /* its corners: no band */
  matrix[N - 1] = matrix[(size_t)N * (N - 1)] = 1;
  vec_push(a, &p->solves, ((Solve){.n = N, .list = listed(a, matrix, (size_t)N * N)}));
  prog_ins(p, (Ins){.op = IR_SOLVE, .index = 0});
  OpCount c = prog_count(p);
  assert_true(c.mul == 2668665000u && c.add == c.mul && c.div == 2001000u);
  assert_true(ops_total(c) == 5339331000u);
  assert_int_equal(ops_as_int(ops_total(c)), INT32_MAX);
  /* three coupled in a row: exchanges widen the band by one above; 2 + 1 and 1 + 1 products below the pivots, 2 + 1
   * behind; a quotient a pivot and an unknown */
  const Slot chain[] = {1, 1, 0, 1, 1, 1, 0, 1, 1};
  c = solve_count(a, &(Solve){.n = 3, .list = listed(a, chain, 9)});
  assert_true(c.mul == 8 && c.add == 8 && c.div == 5);
  arena_free(a);
}

/* lag_kkt.h by hand for M = diag(m1, m2) and one constraint: roots of M and S, each after a product that says how
 * small a pivot may be; 2 quotients each of L^-1 A^T, L^-1 f, twice L^-T, and twice 2 with S; products: S, A y,
 * twice the forces of the constraint, what is left. */
static void test_count_constrained(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  Slot x = load(p, 0);
  const Slot matrix[] = {x, 0, 0, x, x, x};
  OpCount c = solve_count(a, &(Solve){.n = 2, .m = 1, .list = listed(a, matrix, 6)});
  assert_true(c.sqrt == 3 && c.div == 2 + 2 + 4 + 4 && c.mul == 3 + 2 + 2 + 4 + 2 && c.add == 2 + 2 + 4 + 2 + 2);
  arena_free(a);
}

/* Bodies on rods, each held to the next: what lag_kkt.h did when it ran with a type of numbers that counts
 * operations (C++). */
static void test_count_along_a_chain(void **state) {
  (void)state;
  static const uint32_t did[][5] = {{40, 2230, 2230, 1178, 80}, {80, 7670, 7670, 3958, 160}};
  for (int k = 0; k < 2; k++) {
    Arena *a = arena_new(NULL);
    Prog *p = prog_new(a);
    uint32_t n = did[k][0];
    Slot x = load(p, 0), *all = ARENA_ARRAY(a, Slot, 2*n*n);
    for (uint32_t i = 0; i < n; i++) all[i*n + i] = all[n*n + i*n + i] = all[n*n + i*n + (i ? i - 1 : 0)] = x;
    OpCount c = solve_count(a, &(Solve){.n = n, .m = n, .list = listed(a, all, 2*n*n)});
    assert_true(c.add == did[k][1] && c.mul == did[k][2] && c.div == did[k][3] && c.sqrt == did[k][4]);
    arena_free(a);
  }
}

/* a*x - a*y and b*(a*x) + y*a share a factor; a*x + b*z none, and a product that is needed itself stays. */
static void test_factor(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Prog *p = prog_new(arena);
  Slot a = load(p, 0), b = load(p, 1), x = load(p, 2), y = load(p, 3), z = load(p, 4);
  Slot ax = prog_op(p, IR_MUL, a, x), ay = prog_op(p, IR_MUL, a, y), az = prog_op(p, IR_MUL, a, z),
       bz = prog_op(p, IR_MUL, b, z);
  Slot bx = prog_op(p, IR_MUL, b, x), abx = prog_op(p, IR_MUL, a, bx), by = prog_op(p, IR_MUL, b, y);
  prog_store(p, 0, 0, prog_op(p, IR_SUB, ax, ay), "a*(x - y)");
  prog_store(p, 0, 1, prog_op(p, IR_ADD, abx, az), "a*(b*x + z)");
  prog_store(p, 0, 2, prog_op(p, IR_ADD, bz, by), "b*z + b*y, of which the first is stored, too");
  prog_store(p, 0, 3, bz, "b*z");
  Prog *f = prog_factor(prog_tidy(p));
  assert_null(prog_verify(f));
  assert_int_equal(ops_total(prog_count(p)), 10);
  assert_int_equal(count(f, IR_MUL), 5);
  assert_int_equal(ops_total(prog_count(f)), 8);
  Real q[5] = {3, 7, 5, 11, 2}, out[4], *outs[1] = {out}, want[4] = {-18, 111, 91, 14};
  const Real *in[ARR_COUNT] = {[ARR_Q] = q};
  assert_int_equal(prog_eval(f, in, outs), 0);
  for (int i = 0; i < 4; i++) assert_true(out[i] == want[i]); /* small integers: exact */
  arena_free(arena);
}

/* s*b - c*d + e - named with s = sin a, the slowest: e begins, since a product in front would be rounded by itself,
 * s*b comes last, and a sum with a name stays one. */
static void test_in_time(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Prog *p = prog_new(arena);
  Slot a = load(p, 0), b = load(p, 1), c = load(p, 2), d = load(p, 3), e = load(p, 4);
  Slot s = prog_ins(p, (Ins){.op = IR_FN1, .a = a, .text = "sin"});
  Slot sb = prog_op(p, IR_MUL, s, b), cd = prog_op(p, IR_MUL, c, d), named = prog_op(p, IR_ADD, b, d);
  prog_name(p, named, "named");
  Slot sum = prog_op(p, IR_SUB, sb, cd);
  sum = prog_op(p, IR_ADD, sum, e);
  sum = prog_op(p, IR_SUB, sum, named);
  prog_store(p, 0, 0, sum, "sum");
  Slot less = prog_op(p, IR_ADD, cd, sb); /* -(cd + sb) */
  prog_store(p, 0, 1, prog_op(p, IR_NEG, less, 0), "minus");
  Prog *t = prog_reassociate_fma(p);
  assert_null(prog_verify(t));
  assert_int_equal(ops_total(prog_count(t)), ops_total(prog_count(p)));
  const Ins *last = &t->ins.at[t->stores.at[0].slot];
  assert_int_equal(last->op, IR_ADD);
  assert_true(t->ins.at[last->b].op == IR_MUL && t->ins.at[t->ins.at[last->b].a].op == IR_FN1);
  int names = 0;
  for (Slot k = 1; k < t->ins.n; k++) names += t->ins.at[k].op == IR_ADD && t->ins.at[k].name != NULL;
  assert_int_equal(names, 1);
  Real q[5] = {0, 7, 5, 11, 2}, out[2], *outs[1] = {out}, want[2] = {-55 + 2 - 18, -55};
  const Real *in[ARR_COUNT] = {[ARR_Q] = q};
  assert_int_equal(prog_eval(t, in, outs), 0);
  for (int i = 0; i < 2; i++) assert_true(out[i] == want[i]);
  arena_free(arena);
}

/* a*b*x, a*b*y, a*a*b and a*b: three multiplications less with a*b made once; a product that is stored, x*y, is a
 * factor as it is. */
static void test_share(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Prog *p = prog_new(arena);
  Slot a = load(p, 0), b = load(p, 1), x = load(p, 2), y = load(p, 3), xy = prog_op(p, IR_MUL, x, y);
  Slot ax = prog_op(p, IR_MUL, a, x), by = prog_op(p, IR_MUL, b, y), aa = prog_op(p, IR_MUL, a, a);
  prog_store(p, 0, 0, prog_op(p, IR_MUL, ax, b), "a*x*b");
  prog_store(p, 0, 1, prog_op(p, IR_MUL, a, by), "a*(b*y)");
  prog_store(p, 0, 2, prog_op(p, IR_MUL, aa, b), "a*a*b");
  prog_store(p, 0, 3, prog_op(p, IR_MUL, a, b), "a*b");
  prog_store(p, 0, 4, xy, "x*y");
  prog_store(p, 0, 5, prog_op(p, IR_MUL, xy, b), "x*y*b");
  Prog *s = prog_product_cse(prog_tidy(p));
  assert_null(prog_verify(s));
  assert_int_equal(count(p, IR_MUL), 9);
  assert_int_equal(count(s, IR_MUL), 6);
  Real q[4] = {3, 7, 5, 11}, out[6], *outs[1] = {out}, want[6] = {105, 231, 63, 21, 55, 385};
  const Real *in[ARR_COUNT] = {[ARR_Q] = q};
  assert_int_equal(prog_eval(s, in, outs), 0);
  for (int i = 0; i < 6; i++) assert_true(out[i] == want[i]);
  arena_free(arena);
}

/* s*a*a*b with s = sin x: what is there at the start is multiplied first. */
static void test_factors_in_time(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Prog *p = prog_new(arena);
  Slot x = load(p, 0), a = load(p, 1), b = load(p, 2);
  Slot s = prog_ins(p, (Ins){.op = IR_FN1, .a = x, .text = "sin"});
  Slot all = prog_op(p, IR_MUL, s, a);
  all = prog_op(p, IR_MUL, all, a);
  prog_store(p, 0, 0, prog_op(p, IR_MUL, all, b), "s*a*a*b");
  Prog *t = prog_reassociate_fma(p);
  assert_null(prog_verify(t));
  assert_int_equal(count(t, IR_MUL), 3);
  const Ins *last = &t->ins.at[t->stores.at[0].slot];
  assert_true(t->ins.at[last->a].op == IR_FN1 || t->ins.at[last->b].op == IR_FN1);
  arena_free(arena);
}

static uint32_t place(const Prog *p, IrOp op) {
  for (Slot k = 1; k < p->ins.n; k++)
    if (p->ins.at[k].op == op) return k;
  return 0;
}

/* 1/(x^9 - sin y) and z + 1, written with what is needed last in front: the powers, on which all waits, come first;
 * the sum, which nothing waits for, last; the sine when it is needed, or first of all where it is a call; the pivot
 * before its division. */
static void test_by_deadline(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Prog *p = prog_new(arena);
  Slot x = load(p, 0), y = load(p, 1), z = load(p, 2), one = prog_num(p, num_int(1));
  Slot sum = prog_op(p, IR_ADD, z, one), sine = prog_ins(p, (Ins){.op = IR_FN1, .a = y, .text = "sin"}), power = x;
  prog_title(p, "powers");
  for (int k = 0; k < 8; k++) power = prog_op(p, IR_MUL, power, x);
  Slot less = prog_op(p, IR_SUB, power, sine);
  prog_ins(p, (Ins){.op = IR_PIVOT, .a = less, .index = 1});
  prog_store(p, 0, 0, prog_op(p, IR_DIV, one, less), "1/(x^9 - sin y)");
  prog_store(p, 0, 1, sum, "z + 1");
  for (int calls_first = 0; calls_first < 2; calls_first++) {
    Prog *d = prog_schedule_by_path(p, calls_first);
    assert_null(prog_verify(d));
    assert_int_equal(ops_total(prog_count(d)), ops_total(prog_count(p)));
    assert_int_equal(place(d, IR_TITLE), 0);
    assert_int_equal(place(d, IR_ADD), d->ins.n - 1);
    assert_true((place(d, IR_FN1) < place(d, IR_MUL)) == calls_first);
    assert_true(place(d, IR_SUB) < place(d, IR_PIVOT) && place(d, IR_PIVOT) < place(d, IR_DIV));
    Real q[3] = {2, 0, 5}, out[2], *outs[1] = {out};
    const Real *in[ARR_COUNT] = {[ARR_Q] = q};
    assert_int_equal(prog_eval(d, in, outs), 0);
    assert_true(out[0] == 1 / 512.0L && out[1] == 6);
    q[0] = -2;
    assert_int_equal(prog_eval(d, in, outs), -1);
  }
  arena_free(arena);
}

/* A pivot that is zero, negative or not a number stops the program; one is checked once. */
static void test_pivot(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  for (uint32_t positive = 0; positive < 2; positive++) {
    Prog *p = prog_new(a);
    Slot x = load(p, 0);
    prog_ins(p, (Ins){.op = IR_PIVOT, .a = x, .index = positive});
    prog_ins(p, (Ins){.op = IR_PIVOT, .a = x, .index = positive});
    assert_int_equal(count(p, IR_PIVOT), 1);
    prog_store(p, 0, 0, x, "x");
    p = prog_tidy(p);
    const struct { Real x; int ok[2]; } cases[] = {{1, {1, 1}}, {0, {0, 0}}, {-1, {1, 0}}};
    for (size_t i = 0; i < 3; i++) {
      Real q[1] = {cases[i].x}, out[1], *outs[1] = {out};
      const Real *in[ARR_COUNT] = {[ARR_Q] = q};
      assert_int_equal(prog_eval(p, in, outs) == 0, cases[i].ok[positive]);
    }
  }
  arena_free(a);
}

/* ---- lowering ---- */

static const char *const flows[] = {
    "x + y - a*x", "x*y^2/b - 3*x + 1/7", "(x - y)/(2 + sin(x)^2)", "sin(x + y) + cos(x - y) + sin(x)*cos(y)",
    "cos(x) - cos(y)", "sqrt(1 + x^2)*exp(-y)", "(1 + x^2)^(3/2) + (2 + y)^(-1/2) + (3 + x)^(2/5)",
    "x^7 - y^-3 + (x*y)^12", "atan2(y, x) + hypot(x, y)", "min(x, y)*max(x, a) + abs(x) + sign(y)",
    "if(x > y and not (x <= a) or y == 2, x, y^2)", "tan(x) + asin(x/2) + acos(y/2) + atan(x)",
    "sinh(x) + cosh(y) + tanh(x*y) + log(2 + x) + cbrt(y)", "(2 + x)^(y + a) + a^x", "2*x/3 - 5*y/7 + 0.1*x*y",
    "pi*x + 1e-30*y + 6.02e23", "l1*l2 + l3^2 - l2/(3 + l1)", "x/b + y/b + 1/b - (x*y)/b", "t*x + sin(2*t)", "-x - y",
    "1",
};

static void test_lower(void **state) {
  (void)state;
  enum { N = sizeof flows / sizeof *flows };
  Arena *a = arena_new(NULL);
  StrBuf lag = strbuf(a);
  sb_puts(
      &lag,
      "model m\nstate x, y\nparam a = 0.7, b = 1.3\nlet l1 = sin(x*y) + y\nlet l2 = l1^2 + x\nlet l3 = cos(l2)*l1\n");
  for (int i = 0; i < N; i++) sb_printf(&lag, "state s%d\nflow s%d' = %s\n", i, i, flows[i]);
  sb_puts(&lag, "flow x' = y\nflow y' = -x\n");
  Eqns *e = equations(a, sb_text(&lag), NULL);
  assert_non_null(e);
  Prog *p = lower_accel(e, 0);
  assert_null(prog_verify(p));
  for (int trial = 0; trial < 100; trial++) {
    const Real *v = random_point(e);
    Real out[N + 2], want[N + 2];
    assert_int_equal(run_prog(e, p, v, NULL, out), 0);
    expr_eval(e->g, e->flow, N + 2, v, want);
    for (int i = 0; i < N + 2; i++)
      if (!(fabsl(out[i] - want[i]) <= 1e-16L * (1 + fabsl(want[i]))))
        fail_msg("%s: %Lg, not %Lg", i < 2 ? "x, y" : flows[i - 2], out[i], want[i]);
  }
  arena_free(a);
}

/* ---- solving M q'' = f ---- */

/* Elimination with full pivoting; what is solved for is exact to the conditioning of the matrix. */
static void eliminate(Real *A, Real *b, uint32_t n, Real *x) {
  uint32_t perm[64];
  for (uint32_t i = 0; i < n; i++) perm[i] = i;
  for (uint32_t k = 0; k < n; k++) {
    uint32_t pr = k, pc = k;
    for (uint32_t i = k; i < n; i++)
      for (uint32_t j = k; j < n; j++)
        if (fabsl(A[i * n + j]) > fabsl(A[pr * n + pc])) pr = i, pc = j;
    for (uint32_t j = 0; j < n; j++) { Real t = A[k * n + j]; A[k * n + j] = A[pr * n + j]; A[pr * n + j] = t; }
    for (uint32_t i = 0; i < n; i++) { Real t = A[i * n + k]; A[i * n + k] = A[i * n + pc]; A[i * n + pc] = t; }
    Real t = b[k]; b[k] = b[pr]; b[pr] = t;
    uint32_t u = perm[k]; perm[k] = perm[pc]; perm[pc] = u;
    for (uint32_t i = k + 1; i < n; i++) {
      Real f = A[i * n + k] / A[k * n + k];
      for (uint32_t j = k; j < n; j++) A[i * n + j] -= f * A[k * n + j];
      b[i] -= f * b[k];
    }
  }
  for (uint32_t k = n; k-- > 0;) {
    for (uint32_t j = k + 1; j < n; j++) b[k] -= A[k * n + j] * b[j];
    b[k] /= A[k * n + k];
  }
  for (uint32_t k = 0; k < n; k++) x[perm[k]] = b[k];
}

/* n coordinates, coupled to `reach` neighbours; definite: as a sum of squares, otherwise with signs. */
static const char *coupled_model(Arena *a, int n, int reach, int definite) {
  StrBuf lag = strbuf(a);
  sb_puts(&lag, "model m\ncoord q1");
  for (int i = 2; i <= n; i++) sb_printf(&lag, ", q%d", i);
  sb_puts(&lag, "\nlagrangian = 0");
  for (int i = 1; i <= n; i++) {
    sb_printf(&lag, " %s q%d'^2*(2 + sin(q%d)^2)/%d - q%d^2*%d/3", definite || i % 2 ? "+" : "-", i, i, 1 + i % 3, i,
              i);
    for (int j = i + 1; j <= n && j <= i + reach; j++)
      sb_printf(&lag, definite ? " + (q%d' + cos(q%d)*q%d')^2/%d" : " + q%d'*cos(q%d)*q%d'/%d", i, i, j, 2 + j % 2);
  }
  sb_puts(&lag, "\n");
  return sb_text(&lag);
}

static void check_solution(int n, int reach, int definite) {
  Arena *a = arena_new(NULL);
  Eqns *e = equations(a, coupled_model(a, n, reach, definite), NULL);
  assert_non_null(e);
  assert_int_equal(e->definite_mass, definite);
  uint32_t N = (uint32_t)n;
  Prog *p = lower_accel(e, 0);
  assert_null(prog_verify(p));
  if (definite && n > 1 && n <= 12) assert_int_equal(p->solves.n, 0); /* straight-line LDL^T */
  if (!definite) assert_int_equal(p->solves.n, n > 2); /* a pair in the open, more by a loop with pivoting */
  Real *A = ARENA_ARRAY(a, Real, N * N), *b = ARENA_ARRAY(a, Real, N), *x = ARENA_ARRAY(a, Real, N),
       *got = ARENA_ARRAY(a, Real, N);
  for (int trial = 0; trial < 10; trial++) {
    const Real *v = random_point(e);
    for (uint32_t i = 0; i < N; i++)
      for (uint32_t j = 0; j < N; j++) {
        Expr m = eqns_mass(e, i, j);
        expr_eval(e->g, &m, 1, v, &A[i * N + j]);
      }
    expr_eval(e->g, e->f, N, v, b);
    eliminate(A, b, N, x);
    assert_int_equal(run_prog(e, p, v, got, NULL), 0);
    for (uint32_t i = 0; i < N; i++)
      if (!(fabsl(got[i] - x[i]) <= 1e-14L * (1 + fabsl(x[i]))))
        fail_msg("n = %d: q%u'' = %Lg, not %Lg", n, i + 1, got[i], x[i]);
  }
  arena_free(a);
}

static void test_solve_definite(void **state) {
  (void)state;
  for (int n = 1; n <= 8; n++) check_solution(n, n, 1);
  check_solution(9, 1, 1); /* banded */
  check_solution(6, 0, 1); /* diagonal */
  check_solution(16, 2, 1); /* too large for straight lines */
}

static void test_solve_indefinite(void **state) {
  (void)state;
  for (int n = 2; n <= 6; n++) check_solution(n, n, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_verify), cmocka_unit_test(test_numbering), cmocka_unit_test(test_tidy),
      cmocka_unit_test(test_passes), cmocka_unit_test(test_pivot), cmocka_unit_test(test_lower),
      cmocka_unit_test(test_solve_definite), cmocka_unit_test(test_solve_indefinite), cmocka_unit_test(test_factor),
      cmocka_unit_test(test_count_of_many), cmocka_unit_test(test_count_constrained),
      cmocka_unit_test(test_count_along_a_chain), cmocka_unit_test(test_in_time), cmocka_unit_test(test_share),
      cmocka_unit_test(test_factors_in_time), cmocka_unit_test(test_by_deadline),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
