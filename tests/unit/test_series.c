/* Unit tests of src/ir/series: what a model costs in sums and instructions, that M is factored at order 0 only,
 * refusals; of factor_record_solve against elimination, and of prog_reassociate. That the coefficients are right is
 * tests/exec/run_taylor.sh. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"

typedef long double Real;

static Series *series_of(Arena *a, const char *lag, const char **why) {
  Eqns *e = equations(a, lag, NULL);
  assert_non_null(e);
  IrSystem system = lower_system(e);
  assert_null(prog_verify(system.p));
  Series *s = series_new(&system, why);
  if (!s) return NULL;
  assert_null(prog_verify(s->first));
  assert_null(prog_verify(s->next));
  return s;
}

static uint32_t count(const Prog *p, IrOp op) {
  uint32_t n = 0;
  for (Slot s = 1; s < p->ins.n; s++) n += p->ins.at[s].op == op;
  return n;
}

static uint32_t calls(const Prog *p) { return count(p, IR_FN1) + count(p, IR_FN2) + count(p, IR_SQRT); }

static const char double_pendulum[] =
  "model m\ncoord a, b\nparam g = 9.81\nlet x = sin(a)\nlet y = -cos(a)\nlet u = x + sin(b)\nlet v = y - cos(b)\n"
  "kinetic = (x'^2 + y'^2)/2 + (u'^2 + v'^2)/2\npotential = g*y + g*v\n";

/* Sums, counted by hand: sine and cosine of a, b and a - b (6), two squares of rates, each times sin(a - b), cos(a -
 * b) times each acceleration. M[0] is factored in `first`; `next` has neither pivots nor divisions nor functions. */
static void test_cost(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const char *why = NULL;
  Series *s = series_of(a, double_pendulum, &why);
  assert_non_null(s);
  assert_int_equal(s->sums, 12);
  assert_true(count(s->first, IR_PIVOT) > 0);
  assert_int_equal(count(s->next, IR_PIVOT), 0);
  assert_int_equal(count(s->next, IR_DIV), 0);
  assert_int_equal(calls(s->next), 0);
  assert_int_equal(s->columns % 4, 0);
  assert_false(s->uses_time);
  arena_free(a);

  a = arena_new(NULL); /* x^2 + y^2 (2), its root (1), r^3 (1), a quotient each (2) */
  s = series_of(a, "model m\ncoord x, y\nkinetic = (x'^2 + y'^2)/2\npotential = -1/sqrt(x^2 + y^2)\n", &why);
  assert_int_equal(s->sums, 6);
  arena_free(a);

  a = arena_new(NULL); /* linear: no sums at all, whatever the constants */
  s = series_of(a,
                "model m\ncoord x, y\nparam k = 3, m = 2 > 0\nkinetic = m/2*(x'^2 + y'^2)\npotential = k/2*(x - y)^2 + "
                "sin(k)*x\n",
                &why);
  assert_int_equal(s->sums, 0);
  arena_free(a);

  a = arena_new(NULL); /* equal products once, whatever factor they have; t is a column */
  s = series_of(a, "model m\nstate x, y\nflow x' = 3*x*y + t\nflow y' = (-x)*(2*y)\n", &why);
  assert_int_equal(s->sums, 1);
  assert_true(s->uses_time);
  arena_free(a);
}

/* What a chain of n links costs, in sums and instructions of `next`. */
static void chain_cost(uint32_t n, uint32_t *sums, uint32_t *instructions) {
  Arena *a = arena_new(NULL);
  const char *why = NULL;
  const char *lag = arena_printf(
      a,
      "model m\nconst N = %u\ncoord th[N]\nlet x[0] = 0, y[0] = 0\nlet x[i in 1..N] = x[i-1] + sin(th[i])\n"
      "let y[i in 1..N] = y[i-1] - cos(th[i])\nkinetic = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)\n"
      "potential = sum(i in 1..N, 9.81*y[i])\n",
      n);
  Series *s = series_of(a, lag, &why);
  assert_non_null(s);
  *sums = s->sums;
  *instructions = s->next->ins.n;
  arena_free(a);
}

/* Along a chain M is kept as a product, and so is its series: as many more for each link. */
static void test_growth(void **state) {
  (void)state;
  uint32_t s20, i20, s40, i40, s80, i80;
  chain_cost(20, &s20, &i20);
  chain_cost(40, &s40, &i40);
  chain_cost(80, &s80, &i80);
  assert_int_equal(s80 - s40, 2 * (s40 - s20));
  assert_true(s80 < 80 * 13);
  assert_true(i80 - i40 < 2 * (i40 - i20) + 40);
}

static void test_refusals(void **state) {
  (void)state;
  static const struct {
    const char *flow, *why; /* NULL: none */
  } cases[] = {
    {"abs(x)", "abs"}, {"sign(x)", "sign"}, {"min(x, 1)", "min"}, {"max(x, t)", "max"}, {"if(x > 0, x, 1)", "if"},
    {"abs(k)*x + if(k > 1, x, 0) + min(k, 2)", NULL}, {"x^k", NULL}, {"k^x", NULL}, {"if(t > 1, x, 0)", "if"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    Arena *a = arena_new(NULL);
    const char *why = NULL;
    Series *s = series_of(a, arena_printf(a, "model m\nstate x\nparam k = 2\nflow x' = %s\n", cases[i].flow), &why);
    if (!cases[i].why) assert_non_null(s);
    else {
      assert_null(s);
      assert_string_equal(why, cases[i].why);
    }
    arena_free(a);
  }
}

/* ---- solving again ---- */

/* A system's program with the solution for other right-hand sides, read from z and u, behind it: r of coordinates, s of
 * definitions. Compared with elimination of M = H + H C~ + C~^T H + C~^T H C~. */
static void check_again(const char *lag, int straight) {
  Arena *a = arena_new(NULL);
  Eqns *e = equations(a, lag, NULL);
  assert_non_null(e);
  IrSystem sys = lower_system(e);
  uint32_t n = sys.nq, total = n + sys.ndefs;
  assert_int_equal(sys.factored->straight, straight);
  Slot *b = ARENA_ARRAY(a, Slot, total), *s = ARENA_ARRAY(a, Slot, total), *x = ARENA_ARRAY(a, Slot, total);
  for (uint32_t v = 0; v < total; v++) {
    b[v] = prog_ins(sys.p, (Ins){.op = IR_LOAD, .array = ARR_Z, .index = v, .name = "b"});
    s[v] = v < n ? 0 : prog_ins(sys.p, (Ins){.op = IR_LOAD, .array = ARR_U, .index = v, .name = "s"});
  }
  Slot *r = ARENA_ARRAY(a, Slot, total);
  for (uint32_t v = 0; v < total; v++) r[v] = b[v];
  factor_record_solve(sys.p, sys.factored, b, s, x);
  /* what must vanish: rows of q: H u + C^T lambda - r, of w: w - C u - s; lambda = H u + C^T lambda - r by its own
   * row */
  Slot *lambda = ARENA_ARRAY(a, Slot, total), *row = ARENA_ARRAY(a, Slot, total);
  for (uint32_t v = total; v-- > 0;) {
    row[v] = prog_op(sys.p, IR_NEG, r[v], 0);
    for (uint32_t k = 0; k < sys.H.n; k++) {
      const IrSlotEntry *h = &sys.H.at[k];
      if (h->row == v) row[v] = prog_op(sys.p, IR_ADD, row[v], prog_op(sys.p, IR_MUL, h->slot, x[h->col]));
      if (h->col == v && h->row != v)
        row[v] = prog_op(sys.p, IR_ADD, row[v], prog_op(sys.p, IR_MUL, h->slot, x[h->row]));
    }
    for (uint32_t k = 0; k < sys.C.n; k++)
      if (sys.C.at[k].col == v)
        row[v] = prog_op(sys.p, IR_ADD, row[v], prog_op(sys.p, IR_MUL, sys.C.at[k].slot, lambda[sys.C.at[k].row]));
    lambda[v] = row[v];
    if (v < n) {
      prog_store(sys.p, 0, v, row[v], "residual");
      continue;
    }
    Slot w = prog_op(sys.p, IR_SUB, x[v], s[v]);
    for (uint32_t k = 0; k < sys.C.n; k++)
      if (sys.C.at[k].row == v)
        w = prog_op(sys.p, IR_SUB, w, prog_op(sys.p, IR_MUL, sys.C.at[k].slot, x[sys.C.at[k].col]));
    prog_store(sys.p, 0, v, w, "residual");
  }
  assert_null(prog_verify(sys.p));
  const Real *at = random_point(e);
  Real q[64], dq[64], z[64], u[64], p[64], t = 0.3L, out[64] = {0}, *outs[] = {out};
  for (uint32_t i = 0; i < n; i++) q[i] = at[e->m->coords.at[i].q], dq[i] = at[e->m->coords.at[i].v];
  for (uint32_t i = 0; i < e->m->params.n; i++) p[i] = at[e->m->params.at[i].sym];
  for (uint32_t v = 0; v < total; v++) z[v] = uniform(-1, 1), u[v] = uniform(-1, 1);
  const Real *in[ARR_COUNT] = {&t, q, dq, z, p, u};
  assert_int_equal(prog_eval(sys.p, in, outs), 0);
  for (uint32_t v = 0; v < total; v++)
    if (!(fabsl(out[v]) < 1e-15L)) fail_msg("row %u of %u: residual %Lg", v, total, out[v]);
  arena_free(a);
}

/* Blocks by loops, of which nothing accelerates the first. By hand: M = (0 1 0; 1 0 1; 0 1 1) and f = (-d, 0, 0)
 * give q'' = (-d, -d, d). */
static void test_rests(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const char *why;
  Series *s = series_of(
      a, "model rests\ncoord a, b, c, d, e, f\nlagrangian = a'*b' + b'*c' + c'^2/2 + d'*e' + e'*f' + f'^2/2 - d^2/2\n",
      &why);
  assert_non_null(s);
  assert_int_equal(count(s->next, IR_SOLVE), 1);
  Real q[] = {0.1L, 0.2L, 0.3L, 0.4L, 0.5L, 0.6L}, v[6] = {0}, none[1] = {0}, x[64] = {0}, c[64] = {0},
       *outs[] = {x, c};
  const Real *in[ARR_COUNT] = {none, q, v, none, none, none};
  assert_int_equal(prog_eval(s->first, in, outs), 0);
  for (int i = 0; i < 3; i++) assert_true(x[12 + i] == 0);
  for (int i = 3; i < 6; i++) assert_true(fabsl(x[12 + i] - (i < 5 ? -0.4L : 0.4L)) < 1e-18L);
  arena_free(a);
}

static void test_again(void **state) {
  (void)state;
  check_again(double_pendulum, 1);
  check_again("model m\nconst N = 5\ncoord th[N]\nlet x[0] = 0, y[0] = 0\nlet x[i in 1..N] = x[i-1] + sin(th[i])\n"
              "let y[i in 1..N] = y[i-1] - cos(th[i])\nkinetic = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)\npotential = "
              "sum(i in 1..N, y[i])\n",
              1);
  check_again("model m\ncoord x, y\nlagrangian = x'*y'*(2 + sin(x)) - x*y\n", 0); /* a pair by Cramer's rule */
  check_again("model m\ncoord x\nparam k = 2\nlagrangian = k*(1 + x^2)*x'^2/2\n", 0);
}

/* ---- balance ---- */

/* A sum whose terms come at different times: the last to come passes through one addition; values stay. */
static void test_balance(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *p = prog_new(a);
  Slot x[6];
  for (uint32_t i = 0; i < 6; i++) x[i] = prog_ins(p, (Ins){.op = IR_LOAD, .array = ARR_Q, .index = i, .name = "q"});
  Slot late = prog_op(p, IR_SUB, x[0], x[1]); /* ((((x0 - x1) + x2) - x3) + x4) - x5 */
  late = prog_op(p, IR_ADD, late, x[2]);
  late = prog_op(p, IR_SUB, late, x[3]);
  late = prog_op(p, IR_ADD, late, x[4]);
  late = prog_op(p, IR_SUB, late, x[5]);
  Slot minus = prog_op(p, IR_NEG, late, 0);
  prog_store(p, 0, 0, minus, "minus");
  prog_store(p, 0, 1, prog_op(p, IR_MUL, late, late), "square");
  uint32_t *ready = ARENA_ARRAY(a, uint32_t, p->ins.n);
  ready[x[0]] = 100;
  Prog *b = prog_reassociate(p, ready);
  assert_null(prog_verify(b));
  uint32_t through = 0; /* additions between x0 and the square */
  for (Slot s = 1; s < b->ins.n; s++)
    through += (b->ins.at[s].op == IR_ADD || b->ins.at[s].op == IR_SUB) &&
               (b->ins.at[b->ins.at[s].a].op == IR_LOAD && b->ins.at[b->ins.at[s].a].index == 0);
  for (Slot s = 1; s < b->ins.n; s++)
    through += (b->ins.at[s].op == IR_ADD || b->ins.at[s].op == IR_SUB) &&
               (b->ins.at[b->ins.at[s].b].op == IR_LOAD && b->ins.at[b->ins.at[s].b].index == 0);
  assert_int_equal(through, 1);
  assert_int_equal(count(b, IR_ADD) + count(b, IR_SUB), 5);
  Real q[6] = {1, 20, 300, 4000, 50000, 600000}, out[2], *outs[1] = {out};
  const Real *in[ARR_COUNT] = {[ARR_Q] = q};
  assert_int_equal(prog_eval(b, in, outs), 0);
  Real want = 1 - 20 + 300 - 4000 + 50000 - 600000;
  assert_true(out[0] == -want && out[1] == want * want);
  for (Slot s = 1; s < b->ins.n; s++) { /* the square's operand is the addition in which x0 stands */
    const Ins *i = &b->ins.at[s];
    if (i->op == IR_MUL)
      assert_true(b->ins.at[b->ins.at[i->a].a].index == 0 || b->ins.at[b->ins.at[i->a].b].index == 0);
  }
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_cost),  cmocka_unit_test(test_growth),  cmocka_unit_test(test_refusals),
    cmocka_unit_test(test_again), cmocka_unit_test(test_rests), cmocka_unit_test(test_balance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
