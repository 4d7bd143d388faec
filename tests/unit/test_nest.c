/* Unit tests of src/ir/nest*.c: sums over pairs and sites as loops inside loops. What they compute is held against
 * formulas and against the program as it was; that there are loops, against the number of instructions that are
 * left. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "slow.h"

typedef long double Real;

/* A sum of n terms in 64 bits is off by n*2^-64 of the terms' sizes at most (Higham, Accuracy and Stability of
 * Numerical Algorithms, 2nd ed., section 4.2); the terms themselves take some 30 roundings. */
static Real bound(uint32_t terms, Real size) { return (Real)(terms + 30)*0x1p-64L*size; }

/* ---- models ---- */

/* What the functions of a model read, from values of its symbols. */
static void read_point(const Eqns *e, const Real *v, const Real **in) {
  Real *q = ARENA_ARRAY(e->m->arena, Real, e->n + 1), *w = ARENA_ARRAY(e->m->arena, Real, e->n + 1);
  Real *p = ARENA_ARRAY(e->m->arena, Real, e->m->params.n + 1);
  for (uint32_t i = 0; i < e->n; i++) q[i] = v[e->m->coords.at[i].q], w[i] = v[e->m->coords.at[i].v];
  for (uint32_t i = 0; i < e->m->params.n; i++) p[i] = v[e->m->params.at[i].sym];
  in[ARR_T] = &v[e->m->time], in[ARR_Q] = q, in[ARR_V] = w, in[ARR_P] = p;
}

/* How many instructions are left in all, bodies of nests included. */
static uint32_t instructions(const Prog *p) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < prog_parts(p); k++) n += prog_part(p, k)->ins.n;
  return n;
}

/* Compiles the model, whose M is diagonal, and compares accelerations and energy with the expressions they were made
 * from. Returns how many instructions are left; 0 where there are no nests. */
static uint32_t check_model(const char *lag, uint32_t terms) {
  Arena *a = arena_new(NULL);
  Eqns *e = equations(a, lag, NULL);
  assert_non_null(e);
  Prog *p = lower_accel(e, 0), *h = lower_energy(e);
  assert_null(prog_verify(p));
  assert_null(prog_verify(h));
  const Real *in[ARR_COUNT] = {0}, *v = random_point(e);
  Real *got = ARENA_ARRAY(a, Real, e->n), *f = ARENA_ARRAY(a, Real, e->n), *out[2] = {got, NULL}, energy[2],
       *out_h[1] = {energy}, size = 0;
  read_point(e, v, in);
  assert_int_equal(prog_eval(p, in, out), 0);
  expr_eval(e->g, e->f, e->n, v, f);
  for (uint32_t i = 0; i < e->n; i++) size = fmaxl(size, fabsl(f[i]));
  for (uint32_t i = 0; i < e->n; i++) {
    Expr M = eqns_mass(e, i, i);
    Real m;
    expr_eval(e->g, &M, 1, v, &m);
    if (!(fabsl(got[i] - f[i] / m) <= bound(terms, 100 * size)))
      fail_msg("%.200s\nacceleration %u: %Lg, not %Lg", lag, i, got[i], f[i] / m);
  }
  Real want[2];
  const Expr roots[2] = {e->energy_stable, e->energy_scale};
  expr_eval(e->g, roots, 2, v, want);
  assert_int_equal(prog_eval(h, in, out_h), 0);
  for (int k = 0; k < 2; k++) assert_true(fabsl(energy[k] - want[k]) <= bound(terms*terms, want[1]));
  uint32_t left = p->nests.n ? instructions(p) : 0;
  arena_free(a);
  return left;
}

#define BODIES                                                                                                       \
  "model m\nconst N = %d\ncoord r[N]: vec3\nparam m[N] = 1.3 > 0, G = 0.7, soft = 0.1, k = 0.3\n"                     \
  "kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))\n"

static const char *const pairs[] = {
    "potential = -sum(i in 1..N, sum(j in 1..i-1, G*m[i]*m[j]/sqrt(dot(r[i] - r[j], r[i] - r[j]) + soft^2)))\n",
    "potential = sum(i in 1..N, sum(j in i+1..N, G*m[i]*m[j]/sqrt(dot(r[j] - r[i], r[j] - r[i]) + soft^2))) + sum(i in "
    "1..N, k/2*dot(r[i], r[i]))\n",
    "potential = sum(i in 1..N, sum(j in 1..N, if(i < j, 4*k*(1/(1 + dot(r[i] - r[j], r[i] - r[j]))^6 - 1/(1 + "
    "dot(r[i] - r[j], r[i] - r[j]))^3), 0)))\n",
    "let mu[i in 1..N] = sqrt(G)*m[i]\npotential = -sum(i in 1..N, sum(j in 1..i-1, mu[i]*mu[j]/sqrt(dot(r[i] - r[j], "
    "r[i] - r[j]) + soft^2)))\n",
    "potential = sum(i in 1..N, sum(j in 1..i-1, exp(-norm(r[i] - r[j]))*k))\n",
    "let near[i in 1..N, j in 1..N] = dot(r[i] - r[j], r[i] - r[j])\n"
    "potential = sum(i in 1..N, sum(j in 1..i-1, if(near[i,j] < 1, k*(1 - near[i,j])^2, 0)))\n",
    /* components for themselves */
    "dissipation = sum(i in 1..N, sum(j in 1..i-1, k/2*dot(r[i]' - r[j]', r[i]' - r[j]')*sin(t)^2))\n"
    "potential = sum(i in 1..N, sum(j in 1..i-1, exp(-dot(r[i] - r[j], r[i] - r[j]))*k))\n",
};

/* The pairs, once, and a load and a store for each coordinate: no more than 12 instructions a body. */
static void test_pairs(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  for (size_t step = (size_t)depth(3, 2, 1), k = first_row(step); k < sizeof pairs / sizeof *pairs; k += step) {
    uint32_t n = 12, more = (uint32_t)slow(4, 1), few = check_model(arena_printf(a, BODIES "%s", n, pairs[k]), 2*n);
    uint32_t many = check_model(arena_printf(a, BODIES "%s", n + more, pairs[k]), 2*(n + more));
    if (!few || !many || many > few + 12 * more)
      fail_msg("%s%u and %u bodies leave %u and %u instructions", pairs[k], n, n + more, few, many);
  }
  arena_free(a);
}

/* Newton's law, from a text without families, whose pairs stand in another order and are written in other ways. */
static void test_by_hand(void **state) {
  (void)state;
  enum { N = 20 };
  Arena *a = arena_new(NULL);
  StrBuf b = strbuf(a), T = strbuf(a), V = strbuf(a);
  sb_puts(&b, "model m\nparam G = 0.7, e = 0.01\n");
  for (int i = 1; i <= N; i++) {
    sb_printf(&b, "param mass%d = %d > 0\ncoord x%d, y%d\n", i, i, i, i);
    sb_printf(&T, "%smass%d/2*(x%d'^2 + y%d'^2)", i > 1 ? " + " : "", i, i, i);
  }
  for (int d = N - 1; d > 0; d--)
    for (int i = 1; i + d <= N; i++) {
      int s = (i + d) % 2 ? i : i + d, t = 2*i + d - s;
      sb_printf(&V, " - mass%d*G*mass%d/sqrt((x%d - x%d)^2 + e + (y%d - y%d)^2)", s, t, t, s, t, s);
    }
  Eqns *e =
      equations(a, arena_printf(a, "%skinetic = %s\npotential = 0%s\n", sb_text(&b), sb_text(&T), sb_text(&V)), NULL);
  assert_non_null(e);
  Prog *p = lower_accel(e, 0);
  assert_true(p->nests.n > 0 && instructions(p) < 20*N);
  const Real *in[ARR_COUNT] = {0}, *v = random_point(e);
  Real got[2*N], *out[2] = {got, NULL};
  read_point(e, v, in);
  assert_int_equal(prog_eval(p, in, out), 0);
  for (int i = 0; i < N; i++) {
    Real want[2] = {0}, size = 0;
    for (int j = 0; j < N; j++) {
      Real dx = in[ARR_Q][2 * j] - in[ARR_Q][2 * i], dy = in[ARR_Q][2 * j + 1] - in[ARR_Q][2 * i + 1],
           d2 = dx * dx + dy * dy + 0.01L;
      want[0] += 0.7L*(j + 1)*dx/(d2*sqrtl(d2));
      want[1] += 0.7L*(j + 1)*dy/(d2*sqrtl(d2));
      size += 0.7L*(j + 1)/d2;
    }
    for (int k = 0; k < 2; k++) assert_true(fabsl(got[2*i + k] - want[k]) <= bound(N, size));
  }
  arena_free(a);
}

static const char *const nets[] = {
    /* linear, hard, hard with dissipation and a hook at one corner */
    "potential = sum(i in 1..N, sum(j in 1..N-1, k/2*(u[i,j+1] - u[i,j])^2)) +\n"
    "            sum(i in 1..N-1, sum(j in 1..N, k/2*(u[i+1,j] - u[i,j])^2))\n",
    "let s[i in 1..N, j in 1..N] = if(j < N, u[i,j+1] - u[i,j], 0)\nlet d[i in 1..N, j in 1..N] = if(i < N, u[i+1,j] - "
    "u[i,j], 0)\n"
    "potential = sum(i in 1..N, sum(j in 1..N, k/2*(s[i,j]^2 + d[i,j]^2) + s[i,j]^4 + b*d[i,j]^4))\n",
    "potential = k*u[1,1]^2 + sum(i in 1..N, sum(j in 1..N-1, b/4*(u[i,j+1] - u[i,j])^4)) + sum(i in 1..N-1, sum(j in "
    "1..N, b/4*(u[i+1,j] - u[i,j])^4))\n"
    "dissipation = sum(i in 1..N, sum(j in 1..N, k*u[i,j]'^2))\n",
};

/* A load for each coordinate more, and what stands at corners and edges: 5 instructions for each place more on an
 * edge. */
static void test_nets(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const uint32_t small = (uint32_t)slow(20, 16), large = (uint32_t)slow(40, 24);
  for (size_t step = (size_t)depth(3, 2, 1), k = first_row(step); k < sizeof nets / sizeof *nets; k += step) {
    static const char text[] = "model m\nconst N = %d\ncoord u[N,N]\nparam m = 1.2 > 0, k = 1, b = 0.3\n"
                               "kinetic = sum(i in 1..N, sum(j in 1..N, m/2*u[i,j]'^2))\n%s";
    uint32_t few = check_model(arena_printf(a, text, small, nets[k]), 8),
             many = check_model(arena_printf(a, text, large, nets[k]), 8);
    if (!few || !many || many > few + (large*large - small*small) + 10*(large - small))
      fail_msg("%snets of %u and %u leave %u and %u instructions", nets[k], small, large, few, many);
  }
  arena_free(a);
}

/* A string, and a chain, are what they were: their loops have one level. */
static void test_left_alone(void **state) {
  (void)state;
  assert_int_equal(
      check_model("model m\nconst N = 400\ncoord u[N]\nparam k = 1, b = 0.3\nkinetic = sum(i in 1..N, u[i]'^2/2)\n"
                  "potential = sum(i in 1..N-1, k/2*(u[i+1] - u[i])^2 + b/4*(u[i+1] - u[i])^4)\n",
                  400),
      0);
  assert_int_equal(check_model("model m\nconst N = 8\ncoord u[N]\nkinetic = sum(i in 1..N, u[i]'^2/2)\n"
                               "potential = sum(i in 2..N, sum(j in 1..i-1, cos(u[i] - u[j])))\n", 8), 0); /* short */
}

/* ---- programs at random ---- */

static Slot load(Prog *p, IrArray array, uint32_t i) {
  return prog_ins(p, (Ins){.op = IR_LOAD, .array = array, .index = i, .name = "x"});
}

static Slot either_way(Prog *p, IrOp op, Slot a, Slot b) {
  return uniform(0, 1) < 0.5L ? prog_op(p, op, a, b) : prog_op(p, op, b, a);
}

typedef struct {
  Slot value;
  int minus;
} Term;

/* Sums over bodies of what pairs give; a pair is left out with probability `holes`, terms stand in any order, some
 * sums have a term of their own. */
static Prog *random_pairs(Arena *a, uint32_t n, Real holes) {
  Prog *p = prog_new(a);
  Term *term = ARENA_ARRAY(a, Term, n*(n + 1));
  uint32_t *terms = ARENA_ARRAY(a, uint32_t, n);
  Slot shared = either_way(p, IR_MUL, load(p, ARR_P, n), load(p, ARR_P, n + 1));
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < i; j++) {
      if (uniform(0, 1) < holes) continue;
      Slot d = prog_op(p, IR_SUB, load(p, ARR_Q, 2 * j + 1), load(p, ARR_Q, 2 * i + 1)),
           m = either_way(p, IR_MUL, load(p, ARR_P, i), load(p, ARR_P, j));
      Slot square = prog_op(p, IR_MUL, d, d), below = either_way(p, IR_ADD, square, shared),
           over = prog_op(p, IR_DIV, m, below);
      Slot x = either_way(p, IR_MUL, over, d), y = either_way(p, IR_ADD, x, prog_op(p, IR_SQRT, below, 0));
      term[i*(n + 1) + terms[i]++] = (Term){x, 0};
      term[j*(n + 1) + terms[j]++] = (Term){y, 1};
    }
  for (uint32_t i = 0; i < n; i++) {
    Term *t = &term[i*(n + 1)];
    if (uniform(0, 1) < holes) t[terms[i]++] = (Term){prog_op(p, IR_MUL, shared, load(p, ARR_V, i)), 0};
    Slot sum = 0;
    for (uint32_t k = 0; k < terms[i]; k++) {
      uint32_t other = k + (uint32_t)(uniform(0, 1)*(Real)(terms[i] - k));
      Term x = t[other];
      t[other] = t[k];
      sum = prog_op(p, x.minus ? IR_SUB : IR_ADD, sum, x.value);
    }
    prog_store(p, 0, i, prog_op(p, IR_MUL, sum, load(p, ARR_P, i)), "");
  }
  return prog_tidy(p);
}

static void test_random(void **state) {
  (void)state;
  static const Real holes[] = {0, 0, 0.01L, 0.05L, 0.3L};
  uint32_t nested = 0, trials = (uint32_t)slow(60, 10);
  for (uint32_t trial = 0; trial < trials; trial++) {
    Arena *a = arena_new(NULL);
    uint32_t n = 10 + trial % 23;
    Real hole = holes[trial % 5];
    Prog *p = random_pairs(a, n, hole), *r = prog_find_nests(p, 100);
    assert_null(prog_verify(r));
    Real *x = ARENA_ARRAY(a, Real, 2*n + 2), *want = ARENA_ARRAY(a, Real, n), *got = ARENA_ARRAY(a, Real, n);
    for (uint32_t k = 0; k < 2*n + 2; k++) x[k] = uniform(0.5L, 2);
    const Real *in[ARR_COUNT] = {[ARR_Q] = x, [ARR_V] = x, [ARR_P] = x};
    assert_int_equal(prog_eval(p, in, &want), 0);
    assert_int_equal(prog_eval(r, in, &got), 0);
    for (uint32_t k = 0; k < n; k++) assert_true(fabsl(got[k] - want[k]) <= bound(n, 20*(Real)n));
    nested += r != p;
    if (hole == 0) assert_true(r->nests.n == 1 && instructions(r) < 10*n + 40);
    /* what is counted, with one more addition a sum */
    if (r != p) assert_true(ops_total(prog_count(r)) <= ops_total(prog_count(p)) + 3*n);
    arena_free(a);
  }
  assert_true(nested >= trials*3/5); /* all with few holes */
}

/* ---- the checker ---- */

static void test_verify(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Prog *r = prog_find_nests(random_pairs(a, 12, 0), 100);
  assert_int_equal(r->nests.n, 1);
  assert_null(prog_verify(r));
  Nest good = r->nests.at[0];
  Slot later = r->ins.n - 1;
  r->nests.at[0].outer = &later;
  assert_non_null(prog_verify(r));
  r->nests.at[0] = good;
  r->nests.at[0].n = 1; /* fewer places than the body loads from */
  assert_non_null(prog_verify(r));
  r->nests.at[0] = good;
  assert_null(prog_verify(r));
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pairs),      cmocka_unit_test(test_by_hand), cmocka_unit_test(test_nets),
      cmocka_unit_test(test_left_alone), cmocka_unit_test(test_random),  cmocka_unit_test(test_verify),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
