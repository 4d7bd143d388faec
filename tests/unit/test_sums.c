/* Quantified sums as nodes: accelerations and energies of the same text with its sums written out pair by pair, for
 * N = 3 .. 8; a trap whose motion is known; programs whose length does not know N; symmetries by one pair; and texts
 * that have no such form. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "ir/program_set.h"
#include "lower/lower.h"
#include "slow.h"
#include "self_check/self_check.h"
#include "sym/prove.h"

typedef long double Real;

#define BODIES "const N = %d\ncoord r[N]: vec2\nparam m[N] = 1 > 0, e[N] = 1, G = 2, soft = 0.3 > 0, K[N,N] = 0.2\n" \
  "kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))\nfunction pair(s) = 1/sqrt(s + soft^2)\n"
#define APART "dot(r[i] - r[j], r[i] - r[j])"

/* Sums over pairs, each with a potential of its own. */
static const char *const texts[] = {
    /* half sums, from below and from above */
    BODIES "potential = -sum(i in 1..N, sum(j in 1..i-1, G*m[i]*m[j]/sqrt(" APART " + soft^2)))",
    BODIES "potential = -sum(i in 1..N, sum(j in i+1..N, G*m[i]*m[j]*pair(" APART ")))",
    /* full sums, a table of couplings, a factor of the inner sum, a sign */
    BODIES "potential = 1/2*sum(i in 1..N, sum(j in 1..N, K[i,j]/2*" APART "))",
    BODIES "potential = sum(i in 1..N, -e[i]*sum(j in 1..i-1, e[j]*pair(" APART ")))",
    /* next neighbours of a lattice, with its boundary; indices that mix i and j */
    "const N = %d\ncoord u[N,N]\nparam k = 3, c[2*N] = 1\nkinetic = sum(i in 1..N, sum(j in 1..N, u[i,j]'^2/2))\n"
    "potential = sum(i in 1..N-1, sum(j in 1..N, k/2*(u[i+1,j] - u[i,j])^2)) +\n"
    "  sum(i in 1..N, sum(j in 2..N, k/4*(u[i,j] - u[i,j-1])^4)) + sum(i in 1..N, sum(j in 1..N, c[i+j]*cos(u[i,j])))",
    /* terms beside the inner sum, with velocities, numbers and conditions that it could not have */
    "const N = %d\ncoord x[N]\nlagrangian = sum(i in 1..N, i/2*x[i]'^2 - if(i < N, x[i+1]^2, 0) -\n"
    "  2*sum(j in i+1..N, cos(x[i] - x[j])) + x[i]/i)",
    /* a member by number beside running ones; the time; three components */
    "const N = %d\ncoord r[N]: vec3, x\nparam w = 2\nkinetic = x'^2/2 + sum(i in 1..N, dot(r[i]', r[i]')/2)\n"
    "potential = sum(i in 2..N, sum(j in 1..i-1, (1 + sin(w*t)/2)*exp(-" APART ") + x*r[i].x*r[1].y*r[j].z))",
    /* first order: vortices */
    "const N = %d\ncoord x[N], y[N]\nparam g[N] = 1\nlagrangian = sum(i in 1..N, g[i]*x[i]*y[i]') -\n"
    "  sum(i in 1..N, sum(j in 1..i-1, g[i]*g[j]*log((x[i] - x[j])^2 + (y[i] - y[j])^2)))",
    /* chains with ends, rings, squares that a sum has beside a factor, a family of parameters */
    "const N = %d\ncoord u[N], w\nparam k[N] = 2, al = 1/3, b = 1\nkinetic = w'^2 + sum(i in 1..N, u[i]'^2/2)\n"
    "potential = sum(i in 1..N-1, k[i]/2*(u[i+1] - u[i])^2 + al*(u[i+1] - u[i])^3) + b*(u[1] - u[N])^2*u[1]^2 +\n"
    "  w*sum(i in 2..N, 1 - cos(u[i] + w))^2",
    /* velocities of pairs, in L and in the dissipation: a full mass matrix */
    "const N = %d\ncoord x[N], y[N]\nparam m[N] = 1 > 0, c = 0.1\n"
    "kinetic = sum(i in 1..N, m[i]/2*(x[i]'^2 + y[i]'^2)) +\n"
    "  sum(i in 1..N, sum(j in 1..i-1, c*(x[i]'*x[j]' + y[i]'*y[j]')/(2 + (x[i] - x[j])^2)))\n"
    "dissipation = sum(i in 1..N, sum(j in 1..i-1, c/2*(x[i]' - x[j]')^2*exp(-(y[i] - y[j])^2)))",
    /* choices, corners, indices as numbers and in conditions */
    "const N = %d\ncoord x[N]\nparam k = 1\nlagrangian = sum(i in 1..N, i*x[i]'^2/2) -\n"
    "  sum(i in 1..N, sum(j in 1..i-1, if(abs(x[i] - x[j]) < k, (x[i] - x[j])^2, 3*abs(x[i] - x[j])))) -\n"
    "  sum(i in 1..N, sum(j in 1..N, if(i == j, i*cos(x[i]), x[i]*x[j]/(1 + (i - j)^2)))) -\n"
    "  sum(i in 1..N, max(x[i], 0)^2 - min(x[i], k)^3/i)",
    /* lets by index, of other lets, with a moved index; a let beside them */
    "const N = %d\ncoord x[N], y[N]\nparam k = 1\nlet a = k^2, c[i in 1..N] = cos(x[i])*a, e[i in 2..N] = c[i-1]*y[i]\n"
    "lagrangian = sum(i in 1..N, x[i]'^2 + y[i]'^2/2 + c[i]) - sum(i in 2..N, sum(j in 2..N, e[i]*c[j]*a))",
    /* neighbours: of vectors, in a box of two sides, of numbers beside others */
    BODIES "param cut = 1 > 0\npotential = sum(i in 1..N, sum(j in near(i, cut), e[i]*e[j]*(" APART " - cut^2)^2))",
    BODIES "param cut = 0.3 > 0, L = 2 > 0, W = 3 > 0\npotential = sum(i in 1..N, \n"
    "  -e[i]*sum(j in near(i, cut, (L, W), r), pair(image(r[i].x - r[j].x, L)^2 + image(r[i].y - r[j].y, W)^2)))",
    "const N = %d\ncoord x[N], y[N]\nparam cut = 1 > 0\nkinetic = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)\n"
    "potential = 2*sum(i in 1..N, sum(j in near(i, cut, y), i*x[i]*(y[i] - y[j])^2))",
    /* by a tree: what it is compared with are the pairs */
    BODIES "potential = sum(i in 1..N, e[i]/2*sum(j in 1..i-1, -e[j]/sqrt(2*" APART " + 2*soft^2), by tree(0.5)))",
    BODIES "potential = sum(i in 1..N-1, sum(j in i+1..N, i*j*m[i]*m[j]/norm(r[i] - r[j]), by tree(soft)))",
    /* conditions on the index divide the range: a ring, free ends, one member apart, an end within an end */
    "const N = %d\ncoord x[N], y[N]\nparam k[N] = 1\nlagrangian = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2) -\n"
    "  sum(i in 1..N, k[i]/2*(x[if(i < N, i+1, 1)] - x[i])^2 + if(i > 1, (y[i] - y[i-1])^4/4, y[1]^2)) -\n"
    "  sum(i in 1..N, if(not i == 2 and 2*i <= N + 3, i*cos(x[i]*y[N+1-i]), y[if(i == N, 2, if(i >= N-1, 1, i+2))]))",
    /* conditions in lets by index, of other lets; on the outer index of pairs, and beside the inner sum */
    "const N = %d\ncoord x[N], y[N]\nparam k[N] = 1\nlet d[i in 1..N] = x[i] - if(i > 1, x[i-1], 0)\n"
    "let e[i in 0..N] = if(i < N, y[i+1], 0) - if(i > 0, y[i], 0), \n"
    "  f[i in 1..N] = d[i]*if(i == 2, e[i], cos(e[i-1]))\n"
    "lagrangian = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2 - d[i]^2 - f[i]) -\n"
    "  sum(i in 0..N, e[i]^2 + e[if(i > 1, 0, N)]) -\n"
    "  sum(i in 1..N, sum(j in 1..i-1, if(i < N, k[i], 2*k[j])*cos(x[i] - x[j]) + d[i]*y[j])) -\n"
    "  sum(i in 1..N, if(i > 2, y[i-2], 3)*sum(j in 2..N, if(i != 3, x[i]^2, y[j])/i) + if(i > N-2, y[i]^3, x[i]))",
    /* a range that moves and grows; the first two rows are empty */
    "const N = %d\ncoord x[2*N]\nlagrangian = sum(i in 1..2*N, x[i]'^2/2) -\n"
    "  sum(i in 1..N, sum(j in i+1..2*i-2, cos(x[i] - 2*x[j])))",
    /* distances, which have no derivative for i = j, in sums over full rows; exp of one is 1 there */
    BODIES "potential = 1/2*sum(i in 1..N, e[i]*sum(j in 1..N, e[j]*norm(r[i] - r[j]))) +\n"
    "  sum(i in 1..N, sum(j in 1..N, exp(-norm(r[i] - r[j]))))\n"
    "for i in 1..N { force r[i] = -sum(j in 1..N, norm(r[i] - r[j])*(r[i] - r[j] + r[j]')) }",
    /* forces of families: full rows, rows that grow from nothing, a sum that is the same for all, indices as numbers */
    "const N = %d\ncoord x[N], y[N]\nparam k[N] = 1 > 0, c = 0.2\n"
    "kinetic = sum(i in 1..N, k[i]*x[i]'^2/2 + y[i]'^2)\n"
    "for i in 1..N {\n  force x[i] = k[i]/N*sum(j in 1..N, sin(x[j] - x[i])*(if(i <= j, 1, if(j < i, 3, 5)) + y[j]'))"
    " - c*x[i]'\n"
    "  force y[i] = sum(j in 1..i-1, i*x[j]^2/(1 + (i - j)^2)) + sum(j in 1..N, c*x[j]*k[j])\n}",
    /* of vectors with velocities, conditions on both indices, a let by index inside; two forces on one body */
    BODIES "let d[i in 1..N] = e[i]*r[i].x\nfor i in 1..N {\n"
    "  force r[i] = sum(j in 1..N, if(i == j, 0, if(i < 3, 1, soft))*(r[j]' - r[i]')/(1 + " APART ")^2)\n"
    "  force r[i] = e[i]*sum(j in i..N, d[j]*(r[i] - r[j]))\n"
    "  force r[i] = -sum(j in i-1..i+1, if(j > 0 and j <= N, j*d[i], 0))*(0, 1)\n}\n"
    "for i in 2..N-1 { force r[i] = sum(j in i-1..i+1, K[i,j]*r[j]) }",
    /* flows, and lets of families of which a force, a flow and an output read members */
    "const N = %d\ncoord x[N]\nstate z[N]\nparam w[N] = 1\nkinetic = sum(i in 1..N, x[i]'^2/2)\n"
    "let F[i in 1..N] = sum(j in 1..N, w[j]*sin(x[j] - z[i]))\nlet G[i in 1..N] = F[i]*w[i]\n"
    "for i in 1..N {\n  force x[i] = F[i] - sum(j in 1..N, G[j])*x[i]\n"
    "  flow z[i]' = w[i] + sum(j in i..N, sin(z[j] - z[i])*x[i])\n}\n"
    "observe f[i in 1..N] = sum(j in 1..N, (z[i]*x[j])^2)",
};

/* The equations of a text for n bodies; sums from so many pairs on are nodes. */
static Eqns *try_family(Arena *a, const char *text, int n, uint32_t from, const char **messages) {
  StrBuf b = strbuf(a);
  sb_puts(&b, "model m\n");
  sb_printf(&b, text, n);
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  parse(ast, source_add(sources, "test.lag", sb_text(&b), b.n));
  Model *m = ast->diags->errors ? NULL : model_build(ast, &(ModelChoice){.sums_from = from});
  Eqns *e = m ? equations_of(m) : NULL;
  StrBuf out = strbuf(a);
  diags_print(ast->diags, &out);
  *messages = sb_text(&out);
  return e;
}

static Eqns *family(Arena *a, const char *text, int n, uint32_t from) {
  const char *messages;
  Eqns *e = try_family(a, text, n, from, &messages);
  if (!e) fail_msg("%s", messages);
  return e;
}

/* Accelerations, rates, energy and its scale at a random state; the same random numbers for each call with one seed. */
static uint32_t values(const Eqns *e, uint64_t seed, Real *out) {
  Arena *a = e->m->arena;
  uint32_t n = e->n, nz = e->m->states.n;
  Real *state[3], t = 0.3L, *p = ARENA_ARRAY(a, Real, e->m->params.n + 1);
  const uint32_t size[3] = {n, n, nz};
  test_rng = seed;
  for (int k = 0; k < 3; k++) {
    state[k] = ARENA_ARRAY(a, Real, size[k] + 1);
    for (uint32_t i = 0; i < size[k]; i++) state[k][i] = uniform(-1, 1);
  }
  for (uint32_t i = 0; i < e->m->params.n; i++) p[e->m->params.at[i].place] = uniform(0.5L, 1);
  const Real *in[ARR_COUNT] = {0};
  in[ARR_T] = &t, in[ARR_Q] = state[0], in[ARR_V] = state[1], in[ARR_Z] = state[2], in[ARR_P] = p;
  assert_int_equal(prog_eval(lower_accel(e, 0), in, (Real *const[]){out, out + n}), 0);
  if (e->energy) assert_int_equal(prog_eval(lower_energy(e), in, (Real *const[]){out + n + nz}), 0);
  return n + nz + (e->energy ? 2 : 0);
}

/* Rounding in long doubles: sums of at most 64 terms of size about 1, in two orders, divided by masses above 1/2. */
static const Real ROUNDING = 1e-16L;

static void sums_and_pairs_agree(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
    for (int n = k == 6 || k == 12 ? 4 : 3; n <= 8; n += depth(6, 2, 1)) { /* 6 and 12 have no two pairs before */
      Arena *a = arena_new(NULL);
      Real out[2][300];
      Eqns *whole = family(a, texts[k], n, 1), *pairs = family(a, texts[k], n, UINT32_MAX);
      if (!whole->m->sums.n || pairs->m->sums.n) fail_msg("text %zu, N = %d: %u sums", k, n, whole->m->sums.n);
      uint32_t count = values(whole, (uint64_t)n, out[0]);
      assert_int_equal(values(pairs, (uint64_t)n, out[1]), count);
      for (uint32_t i = 0; i < count; i++)
        if (!(fabsl(out[0][i] - out[1][i]) <= ROUNDING * (1 + fabsl(out[1][i])) * n))
          fail_msg("text %zu, N = %d, value %u: %.18Lg and %.18Lg", k, n, i, out[0][i], out[1][i]);
      arena_free(a);
    }
}

/* Sums over neighbours are full sums with a choice, written by hand. */
static void neighbours_are_those_within_the_cut(void **state) {
  (void)state;
  static const char *const pairs[][2] = {
      {BODIES "param cut = 1 > 0\npotential = sum(i in 1..N, sum(j in near(i, cut), m[i]*e[j]/" APART "))",
       BODIES "param cut = 1 > 0\npotential = sum(i in 1..N, sum(j in 1..i-1,\n"
              "  if(norm(r[i] - r[j]) < cut, m[i]*e[j]/" APART ", 0)))"},
      {BODIES "param L = 3 > 0\npotential = sum(i in 1..N, sum(j in near(i, L/3, L), image(r[i].x - r[j].x, L)^3))",
       BODIES "param L = 3 > 0\nfunction back(d) = d - L*floor(d/L + 1/2)\n"
              "potential = sum(i in 1..N, sum(j in 1..i-1,\n"
              "  if(hypot(back(r[i].x - r[j].x), back(r[i].y - r[j].y)) < L/3,\n"
              "  back(r[i].x - r[j].x)^3, 0)))"}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
    for (uint64_t seed = 1; seed <= 3; seed++) {
      Arena *a = arena_new(NULL);
      Real out[2][300];
      uint32_t count = values(family(a, pairs[k][0], 8, 1), seed, out[0]);
      assert_int_equal(values(family(a, pairs[k][1], 8, UINT32_MAX), seed, out[1]), count);
      for (uint32_t i = 0; i < count; i++)
        if (!(fabsl(out[0][i] - out[1][i]) <= 1000 * ROUNDING * (1 + fabsl(out[1][i])))) /* quotients by squares */
          fail_msg("text %zu, value %u: %.18Lg and %.18Lg", k, i, out[0][i], out[1][i]);
      arena_free(a);
    }
}

/* --- random families --- */

static const char *one_of(const char *const *from, size_t n) { return from[(size_t)uniform(0, (Real)n - 0.001L)]; }

/* A random factor of terms over i (pairs: and j), of coordinates, velocities, parameters, lets and numbers. */
static const char *random_factor(Arena *a, int pairs) {
  static const char *const at[] = {"i", "i+1", "2*i", "N+2-i", "i+2", "3", "if(i < N-1, i+1, 1)",
                                 "if(i == 3 or i < 2, 2, 2*i-1)"},
                    *const of_pairs[] = {"i", "j", "j+1", "2*i", "i+j", "N+2-j", "3", "if(i < 3, i+2, N)"},
                    *const shapes[] = {"x[%s]*y[%s]", "cos(x[%s] - x[%s])", "(x[%s] - y[%s])^2", "exp(-x[%s]^2)*k[%s]",
                                       "abs(x[%s] - y[%s])", "max(x[%s], y[%s]/2)^2", "if(x[%s] < y[%s], x[1], y[2]^2)",
                                       "c[%s]*x[%s]", "1/(2 + (x[%s] + c[%s])^2)"};
  const char *first = pairs ? one_of(of_pairs, 8) : one_of(at, 8);
  const char *second = pairs ? one_of(of_pairs, 8) : one_of(at, 8);
  return arena_printf(a, one_of(shapes, 9), first, second);
}

/* A random sum over i, or over pairs; rows: over j, for each i. */
static const char *random_sum(Arena *a, int pairs, int rows) {
  static const char *const ranges[] = {"1..i-1", "i+1..N", "1..N", "2..i", "i..N"},
                    *const weights[] = {"", "i*", "k[i]*", "(i + 1/2)*w*", "-", "x[i]*", "if(i != 2, k[i], 3*w)*"};
  const char *f = random_factor(a, pairs), *g = random_factor(a, pairs), *weight = one_of(weights, pairs ? 6 : 7);
  if (!pairs) return arena_printf(a, "sum(i in 1..N, %s%s*(1 + %s))", weight, f, g);
  const char *sum = arena_printf(a, "%ssum(j in %s, %s + %s)", weight, one_of(ranges, 5), f, g);
  return rows ? sum : arena_printf(a, "sum(i in 1..N, %s)", sum);
}

/* Accelerations, energy and self-check of random families, and of the same texts written out. */
static void random_families_agree(void **state) {
  (void)state;
  uint32_t sums = 0;
  const int rounds = 200, step = depth(99, 5, 1); /* neither even nor threefold */
  for (int round = (int)first_row((size_t)step); round < rounds; round += step) {
    Arena *a = arena_new(NULL);
    Real out[2][300];
    test_rng = (uint64_t)round + 1;
    int n = 4 + round % 3;
    const char *pairs = random_sum(a, 1, 0), *single = random_sum(a, 0, 0), *beside = random_sum(a, round % 2, 0);
    const char *text = arena_printf(
        a,
        "const N = %%d, M = 2*N + 2\ncoord x[M], y[M]\nparam k[M] = 1 > 0, w = 1/3\n"
        "let c[i in 1..M] = w*sin(y[i]) + if(i > 3, x[i-3], w*y[1])\n"
        "kinetic = sum(i in 1..M, k[i]*(x[i]'^2 + y[i]'^2)/2) + sum(i in 1..N, w/9*x[i]'*x[i+1]')\n"
        "potential = %s + %s + %s\n"
        "dissipation = sum(i in 1..N, sum(j in 1..N, w/2*(x[i]' - y[j]')^2*(1 + c[i]^2)))\n"
        "for i in 1..N { force x[i] = %s\n force y[i+1] = %s - x[i]' }",
        pairs, single, beside, random_sum(a, 1, 1), random_sum(a, 1, 1));
    const char *messages;
    Eqns *whole = try_family(a, text, n, 1, &messages), *written = family(a, text, n, UINT32_MAX);
    if (!whole) fail_msg("%s\n%s", text, messages);
    sums += whole->m->sums.n;
    uint32_t count = values(whole, (uint64_t)round, out[0]);
    assert_int_equal(values(written, (uint64_t)round, out[1]), count);
    for (uint32_t i = 0; i < count; i++)
      if (!(fabsl(out[0][i] - out[1][i]) <= 100 * ROUNDING * (1 + fabsl(out[1][i])) * n))
        fail_msg("N = %d, value %u: %.18Lg and %.18Lg\n%s", n, i, out[0][i], out[1][i], text);
    arena_free(a);
  }
  assert_true(sums > 4 * (uint32_t)((rounds - 1)/step)); /* most texts have the form */
}

/* A program has as many instructions for 50 bodies as for 5, but for one load and one store of each component. */
static void programs_do_not_know_the_pairs(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  uint32_t parts[2], length[2];
  for (int k = 0; k < 2; k++) {
    const Prog *p = lower_accel(family(a, texts[0], k ? 50 : 5, 1), 0);
    parts[k] = prog_part(p, 1)->ins.n;
    length[k] = p->ins.n;
    assert_int_equal(prog_parts(p), 2);
  }
  assert_int_equal(parts[0], parts[1]);
  assert_true(length[1] < 10 * length[0] + 50);
  arena_free(a);
}

/* A ring and ends by conditions on the index: each sum stays one, over the parts of its range. */
static void conditions_divide_the_range(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const char *messages;
  Eqns *e = try_family(a, "const N = %d\ncoord x[N]\nlet unread[i in 1..N] = i*x[i]\n"
                          "lagrangian = sum(i in 1..N, x[i]'^2/2) -\n"
                          "  sum(i in 1..N, (x[if(i < N, i+1, 1)] - x[i])^2) -\n"
                          "  sum(i in 1..N, if(not i == 9 and i > 2, i*cos(x[i-2]), x[N+1-i])) -\n"
                          "  sum(i in 0..N, d[i]^2) - sum(i in 1..N, sum(j in 1..N, if(i < 4, x[i], 2*x[j])*x[i]))\n"
                          "let d[i in 0..N] = if(i < N, x[i+1], 0) - if(i > 0, x[i], 0)", 100, 8, &messages);
  assert_non_null(e);
  assert_string_equal(messages, "");
  /* 1..100; 1..99; 10..100; 1..99; 1..3 and 4..100 by pairs: all other parts have fewer than 8 terms */
  assert_int_equal(e->m->sums.n, 6);
  arena_free(a);
}

/* Two bodies on a spring: x'' of the first is -k (x1 - x2)/m1, by hand. */
static void a_spring_is_right(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Real out[4];
  Eqns *e = family(a, "const N = 2 + 0*%d\ncoord x[N]\nlagrangian = sum(i in 1..N, i*x[i]'^2/2) -\n"
                      "  sum(i in 1..N, sum(j in 1..i-1, 3/2*(x[i] - x[j])^2))", 0, 1);
  assert_int_equal(e->m->sums.n, 1); /* one pair has no second one to compare with: the kinetic energy alone */
  values(e, 7, out);
  test_rng = 7;
  Real x1 = uniform(-1, 1), x2 = uniform(-1, 1);
  assert_true(fabsl(out[0] + 3 * (x1 - x2)) < 1e-17L);
  assert_true(fabsl(out[1] - 3 * (x1 - x2) / 2) < 1e-17L);
  arena_free(a);
}

/* Time in a term of a sum is no symbol of a member, and yet seen: the energy changes. */
static void time_is_seen(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const char *text = BODIES "potential = sum(i in 1..N, sum(j in 1..i-1, G*cos(t)*e[i]*e[j]*pair(" APART ")))";
  for (uint32_t from = 1; from; from = from == 1 ? UINT32_MAX : 0) {
    Eqns *e = family(a, text, 8, from);
    assert_int_equal(e->m->sums.n > 1, from == 1);
    assert_false(e->autonomous);
  }
  arena_free(a);
}

/* Texts without the form: written out, and right as before. */
static void other_texts_are_written_out(void **state) {
  (void)state;
  static const char *const other[] = {
      "sum(i in 1..N, sum(j in 1..i-1, x[i]^i*x[j]))",                 /* an index in an exponent */
      "sum(i in 1..N, sum(j in 1..i-1, e[i]*x[j]))",                   /* lets that have their index as a number */
      "sum(i in 1..N, sum(j in 1..i-1, abs(x[i]' - x[j]')/9))",        /* a switch by velocities */
      "sum(i in 1..N, sum(j in 1..i-1, x[i]) + sum(j in 1..2, x[j]))", /* two sums inside */
      "sum(i in 1..N, (1 + sum(j in 1..i-1, x[i]*x[j]))^2)",           /* not linear in the inner sum */
      "sum(i in 1..N, sum(j in 1..i-1, far(x[i])*x[j]))",              /* a function that reads a member */
  };
  static const char *const reason[] = {
      "an index stands in an exponent", "a let has its index as a number", "runs locate each of its switches",
      "there are several sums inside", "it is not linear in the sum inside", "is written out",
  };
  for (size_t c = 0; c < 2 * (sizeof other / sizeof *other); c++) {
    size_t k = c / 2;
    int n = c % 2 ? 5 : 4; /* with 4 the member that `far` reads is x[i] of the first representative */
    Arena *a = arena_new(NULL);
    Real out[2][10];
    const char *text = arena_printf(a,
                                    "const N = %%d\ncoord x[N]\nparam k = 1\nlet e[i in 1..N] = i*x[i]^2\n"
                                    "function far(s) = s*x[4]\nlagrangian = sum(i in 1..N, x[i]'^2/2) - %s",
                                    other[k]);
    const char *messages;
    Eqns *whole = try_family(a, text, n, 1, &messages), *pairs = family(a, text, n, UINT32_MAX);
    assert_int_equal(whole->m->sums.n, 1); /* the kinetic energy */
    if (!strstr(messages, reason[k])) fail_msg("text %zu, N = %d: %s", k, n, messages);
    values(whole, 3, out[0]);
    values(pairs, 3, out[1]);
    for (int i = 0; i < n; i++) assert_true(fabsl(out[0][i] - out[1][i]) <= ROUNDING * (1 + fabsl(out[1][i])));
    arena_free(a);
  }
}

/* Second derivatives of the sums, as implicit, variational and Taylor methods need them, against the text by other
 * code: the self-check differentiates L by truncated series. */
static void second_derivatives_are_right(void **state) {
  (void)state;
  const size_t step = (size_t)depth(6, 2, 1);
  for (size_t k = 1 + first_row(step); k < sizeof texts / sizeof *texts; k += step) {
    Arena *a = arena_new(NULL);
    const char *messages;
    SelfCheck told;
    Eqns *e = try_family(a, texts[k], 5, 1, &messages);
    ProgramSet *u = unit_new(e, "test.lag", 0);
    unit_require(u, e, WANT_LINEAR | WANT_MASS | (e->n ? WANT_VARIATION : 0u) | (e->smooth ? WANT_TAYLOR : 0u));
    unit_add_scene(u, e);
    StrBuf out = strbuf(a);
    int agrees = self_check(e, u, 0, &told);
    diags_print(e->m->diags, &out);
    if (!agrees) fail_msg("text %zu: %s", k, sb_text(&out));
    assert_true(told.states > 0 && told.directions > 0);
    arena_free(a);
  }
}

/* 21945 pairs have no Taylor series, and a note says so. */
static void long_series_are_refused(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  StrBuf out = strbuf(a);
  Eqns *e = family(a, "const N = %d\ncoord x[N]\nlagrangian = sum(i in 1..N, x[i]'^2/2) -\n"
                      "  sum(i in 1..N, sum(j in 1..i-1, cos(x[i] - x[j])))", 210, 0);
  ProgramSet *u = unit_head(e, "test.lag", 0);
  unit_require(u, e, WANT_TAYLOR);
  diags_print(e->m->diags, &out);
  assert_null(u->taylor);
  assert_non_null(strstr(sb_text(&out), "no Taylor series: it would write out the 21945 terms"));
  arena_free(a);
}

/* The self-check compares them with the text, by a sample of their pairs; and notices a wrong body. */
static void the_text_is_compared(void **state) {
  (void)state;
  const char *const of[] = {texts[0], texts[sizeof texts / sizeof *texts - 3]}; /* the second has rows of a family */
  for (int k = 0; k < 2; k++) {
    Arena *a = arena_new(NULL);
    SelfCheck told;
    Eqns *e = family(a, of[k], 40, 1);
    ProgramSet *u = unit_new(e, "test.lag", 0);
    unit_add_scene(u, e);
    assert_true(self_check(e, u, 0, &told));
    assert_true(told.states > 0 && told.directions > 0);
    uint32_t nest = 0;
    while (k && u->accel->nests.at[nest].text_turns != 40) assert_true(++nest < u->accel->nests.n);
    IrSubscript *at = (IrSubscript *)u->accel->nests.at[nest].at;
    at[0].by_row--; /* a body is read at the wrong place */
    assert_false(self_check(e, u, 0, &told));
    arena_free(a);
  }
}

/* Shifts and rotations of all bodies, with 200 of them. */
static void one_pair_proves_a_symmetry(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const char *text = BODIES "potential = -sum(i in 1..N, sum(j in 1..i-1, G*m[i]*m[j]*pair(" APART ")))\n"
    "symmetry shift(s): for i in 1..N: r[i] -> r[i] + s*(1, 2)\n"
    "symmetry turn(s): for i in 1..N: r[i] -> (r[i].x*cos(s) - r[i].y*sin(s), r[i].x*sin(s) + r[i].y*cos(s))\n";
  text = arena_printf(a, "%s", text);
  StrBuf plain = strbuf(a); /* without the table of couplings, which has N^2 members */
  const char *table = strstr(text, ", K[N,N] = 0.2");
  sb_printf(&plain, "%.*s%s", (int)(table - text), text, table + strlen(", K[N,N] = 0.2"));
  Eqns *e = family(a, sb_text(&plain), 200, 0);
  assert_int_equal(e->ncharges, 3);
  for (uint32_t i = 0; i < e->ncharges; i++) assert_int_equal(e->charges[i].proof.drift, PROVED_ZERO);
  arena_free(a);
}

/* What is no symmetry is refused, and the remainder has the two half sums of the derivative by r[3].x. */
static void a_wrong_symmetry_is_refused(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  const char *messages;
  Eqns *e = try_family(a, "const N = %d\ncoord r[N]: vec2\nlagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2) -\n"
                          "  sum(i in 1..N, sum(j in 1..i-1, (r[i].x - r[j].x)^4 + 2*(r[i].y - r[j].y)^4))\n"
                          "symmetry odd(s): r[3] -> r[3] + s*(1, 0)\n", 6, 1, &messages);
  assert_null(e);
  assert_non_null(strstr(messages, "sum(i in 4..6, 4*(r[3].x - r[i].x)^3)"));
  assert_non_null(strstr(messages, "sum(j in 1..2, 4*(r[3].x - r[j].x)^3)"));
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_and_pairs_agree),
      cmocka_unit_test(neighbours_are_those_within_the_cut),
      cmocka_unit_test(random_families_agree),
      cmocka_unit_test(programs_do_not_know_the_pairs),
      cmocka_unit_test(conditions_divide_the_range),
      cmocka_unit_test(a_spring_is_right),
      cmocka_unit_test(time_is_seen),
      cmocka_unit_test(other_texts_are_written_out),
      cmocka_unit_test(second_derivatives_are_right),
      cmocka_unit_test(long_series_are_refused),
      cmocka_unit_test(the_text_is_compared),
      cmocka_unit_test(one_pair_proves_a_symmetry),
      cmocka_unit_test(a_wrong_symmetry_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
