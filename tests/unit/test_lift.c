/* Mechanisms whose lets build on each other: their accelerations against textbook formulas and against a
 * dense solution of M q'' = f, and their cost against their length. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "slow.h"
#include "mech/elimination_order.h"
#include "mech/lagrange.h"

typedef long double Real;

/* Solves A x = b by elimination with partial pivoting; A and b are spoiled. */
static void solve(Real *A, Real *b, uint32_t n, Real *x) {
  for (uint32_t k = 0; k < n; k++) {
    uint32_t p = k;
    for (uint32_t i = k + 1; i < n; i++)
      if (fabsl(A[i * n + k]) > fabsl(A[p * n + k])) p = i;
    for (uint32_t j = 0; j < n; j++) { Real t = A[k * n + j]; A[k * n + j] = A[p * n + j]; A[p * n + j] = t; }
    Real t = b[k];
    b[k] = b[p];
    b[p] = t;
    for (uint32_t i = k + 1; i < n; i++) {
      Real f = A[i * n + k] / A[k * n + k];
      for (uint32_t j = k; j < n; j++) A[i * n + j] -= f * A[k * n + j];
      b[i] -= f * b[k];
    }
  }
  for (uint32_t i = n; i-- > 0;) {
    x[i] = b[i];
    for (uint32_t j = i + 1; j < n; j++) x[i] -= A[i * n + j] * x[j];
    x[i] /= A[i * n + i];
  }
}

static void dense_accelerations(Eqns *e, const Real *v, Real *x) {
  uint32_t n = e->n;
  Arena *a = e->m->arena;
  eqns_derive_mass(e);
  Real *A = ARENA_ARRAY(a, Real, n * n), *b = ARENA_ARRAY(a, Real, n);
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *m = &e->mass.at[k];
    Real value;
    expr_eval(e->g, &m->e, 1, v, &value);
    A[m->row * n + m->col] = A[m->col * n + m->row] = value;
  }
  expr_eval(e->g, e->f, n, v, b);
  solve(A, b, n, x);
}

/* Operations of the accelerations, which are checked at a few states. lifted: whether definitions must
 * take part in the solution. */
static uint32_t check(const char *lag, int lifted) {
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, lag, NULL);
  assert_non_null(e);
  assert_true(e->definite_mass);
  if ((e->system.ndefs > 0) != lifted) fail_msg("%s\n%u definitions in the solution", lag, e->system.ndefs);
  Prog *p = lower_accel(e, 0);
  assert_null(prog_verify(p));
  Real *got = ARENA_ARRAY(arena, Real, e->n), *want = ARENA_ARRAY(arena, Real, e->n);
  for (int trial = 0; trial < 5; trial++) {
    const Real *v = random_point(e);
    assert_int_equal(run_prog(e, p, v, got, NULL), 0);
    dense_accelerations(e, v, want);
    Real size = 0;
    for (uint32_t i = 0; i < e->n; i++) size = fmaxl(size, fabsl(want[i]));
    for (uint32_t i = 0; i < e->n; i++) /* 64 bits, and a condition of M up to 1e4 */
      if (!(fabsl(got[i] - want[i]) <= 1e-14L * size))
        fail_msg("%s\nacceleration %u: %Lg, dense %Lg", lag, i, got[i], want[i]);
  }
  uint32_t ops = (uint32_t)ops_total(prog_count(p));
  arena_free(arena);
  return ops;
}

/* --- chains --- */

#define CHAIN                                                                                      \
  "model m\nconst N = %d\ncoord th[N]\nparam m[N] = 1.3 > 0, l[N] = 0.7 > 0, g = 9.81 > 0\n" \
  "let x[0] = 0, y[0] = 0\nlet x[i in 1..N] = x[i-1] + l[i]*sin(th[i])\n"                       \
  "let y[i in 1..N] = y[i-1] - l[i]*cos(th[i])\n"

#define ENERGIES "kinetic = sum(i in 1..N, m[i]/2*(x[i]'^2 + y[i]'^2))\npotential = sum(i in 1..N, m[i]*g*y[i])\n"

/* M_ij = mu_ij l_i l_j cos(th_i - th_j), f_i = -sum_j mu_ij l_i l_j sin(th_i - th_j) th_j'^2 - mu_ii g l_i sin th_i,
 * with mu_ij the mass that hangs below both. */
static void check_textbook(const char *text, int N) {
  enum { MOST = 40 };
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, arena_printf(arena, text, N), NULL);
  assert_non_null(e);
  Prog *p = lower_accel(e, 0);
  assert_true(e->system.ndefs > 0);
  for (int trial = 0; trial < 20; trial++) {
    const Real *v = random_point(e), g = 9.81L, l = 0.7L, m = 1.3L;
    Real A[MOST * MOST], b[MOST], want[MOST], got[MOST], th[MOST], w[MOST];
    for (int i = 0; i < N; i++) {
      th[i] = v[e->m->coords.at[i].q];
      w[i] = v[e->m->coords.at[i].v];
    }
    for (int i = 0; i < N; i++) {
      b[i] = -m * (N - i) * g * l * sinl(th[i]);
      for (int j = 0; j < N; j++) {
        Real mu = m * (N - (i > j ? i : j));
        A[i * N + j] = mu * l * l * cosl(th[i] - th[j]);
        b[i] -= mu * l * l * sinl(th[i] - th[j]) * w[j] * w[j];
      }
    }
    solve(A, b, (uint32_t)N, want);
    assert_int_equal(run_prog(e, p, v, got, NULL), 0);
    for (int i = 0; i < N; i++) assert_true(fabsl(got[i] - want[i]) <= 1e-14L * (1 + fabsl(want[i])));
  }
  arena_free(arena);
}

static void test_textbook(void **state) {
  (void)state;
  check_textbook(CHAIN ENERGIES, 9);
}

/* A model text for a length. */
typedef const char *(*Writer)(Arena *a, int n);

/* The cost per link is bounded: twice the links cost at most twice the operations, and a constant. */
static void check_linear(Writer write) {
  Arena *a = arena_new(NULL);
  int more = slow(5, 2);
  uint32_t few = check(write(a, 10), 1), some = check(write(a, 10 + more), 1), many = check(write(a, 10 + 2*more), 1);
  if (many - some > some - few + 10)
    fail_msg("%s\n10 links, %d and %d more take %u, %u, %u operations", write(a, 10), more, 2 * more, few, some, many);
  arena_free(a);
}

static const char *family(Arena *a, int n) { return arena_printf(a, CHAIN ENERGIES, n); }

/* Other names, and the chain counted from its tip to its pivot. */
static const char *renamed(Arena *a, int n) {
  return arena_printf(
      a,
      "model m\nconst K = %d\ncoord alpha[K]\nparam mu = 1 > 0, g = 9.81 > 0\nlet east[K+1] = 0, north[K+1] = 0\n"
      "let east[k in 1..K] = east[k+1] + sin(alpha[k])\nlet north[k in 1..K] = north[k+1] - cos(alpha[k])\n"
      "lagrangian = sum(k in 1..K, mu/2*(east[k]'^2 + north[k]'^2) - mu*g*north[k])\n",
      n);
}

/* The same without families. */
static const char *by_hand(Arena *a, int n) {
  StrBuf b = strbuf(a), lagrangian = strbuf(a);
  sb_puts(&b, "model m\nparam m = 1 > 0, l = 1 > 0, g = 9.81 > 0\nlet p0 = 0, z0 = 0\n");
  for (int i = 1; i <= n; i++) {
    sb_printf(&b, "coord a%d\nlet p%d = p%d + l*sin(a%d)\nlet z%d = z%d - l*cos(a%d)\n", i, i, i - 1, i, i, i - 1, i);
    sb_printf(&lagrangian, "%sm/2*(p%d'^2 + z%d'^2) - m*g*z%d", i > 1 ? " + " : "lagrangian = ", i, i, i);
  }
  sb_printf(&b, "%s\n", sb_text(&lagrangian));
  return sb_text(&b);
}

/* Each angle measured from the link before: the direction is a chain of lets, too. */
static const char *relative(Arena *a, int n) {
  return arena_printf(
      a,
      "model m\nconst N = %d\ncoord th[N]\nparam m[N] = 1 > 0, I = 0.1 > 0, g = 9.81 > 0\nlet phi[0] = 0, x[0] = 0, "
      "y[0] = 0\n"
      "let phi[i in 1..N] = phi[i-1] + th[i]\nlet x[i in 1..N] = x[i-1] + sin(phi[i])\nlet y[i in 1..N] = y[i-1] - "
      "cos(phi[i])\n"
      "kinetic = sum(i in 1..N, m[i]/2*(x[i]'^2 + y[i]'^2) + I/2*phi[i]'^2)\npotential = sum(i in 1..N, m[i]*g*y[i])\n",
      n);
}

/* In space, two angles a link. */
static const char *spatial(Arena *a, int n) {
  return arena_printf(
      a,
      "model m\nconst N = %d\ncoord th[N], ph[N]\nparam m = 1 > 0, I = 0.1 > 0, g = 9.81 > 0\nlet x[0] = 0, y[0] = 0, "
      "z[0] = 0\n"
      "let x[i in 1..N] = x[i-1] + sin(th[i])*cos(ph[i])\nlet y[i in 1..N] = y[i-1] + sin(th[i])*sin(ph[i])\n"
      "let z[i in 1..N] = z[i-1] - cos(th[i])\nkinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2 + z[i]'^2) + "
      "I/2*ph[i]'^2)\n"
      "potential = sum(i in 1..N, m*g*z[i])\n",
      n);
}

/* Every second link carries a branch of two. */
static const char *tree(Arena *a, int n) {
  StrBuf b = strbuf(a), lagrangian = strbuf(a);
  sb_puts(&b, "model m\nparam m = 1 > 0, g = 9.81 > 0\nlet x0 = 0, y0 = 0\n");
  for (int i = 1; i <= n; i++) {
    int parent = i % 4 == 0 ? i - 1 : i % 4 == 1 && i > 1 ? i - 3 : i - 1;
    sb_printf(&b, "coord a%d\nlet x%d = x%d + sin(a%d)\nlet y%d = y%d - cos(a%d)\n", i, i, parent, i, i, parent, i);
    sb_printf(&lagrangian, "%sm/2*(x%d'^2 + y%d'^2) - m*g*y%d", i > 1 ? " + " : "lagrangian = ", i, i, i);
  }
  sb_printf(&b, "%s\n", sb_text(&lagrangian));
  return sb_text(&b);
}

/* Speeds by way of a let that is not linear in velocities. */
static const char *squares(Arena *a, int n) {
  return arena_printf(a,
                      CHAIN "let v2[i in 1..N] = x[i]'^2 + y[i]'^2\nkinetic = sum(i in 1..N, m[i]/2*v2[i])\npotential "
                            "= sum(i in 1..N, m[i]*g*y[i])\n",
                      n);
}

/* Friction in the joints and a drive that depends on time. */
static const char *driven(Arena *a, int n) {
  return arena_printf(
      a,
      "model m\nconst N = %d\ncoord th[N]\nparam m = 1 > 0, g = 9.81 > 0\nlet x[0] = 0.1*sin(3*t), y[0] = 0\n"
      "let x[i in 1..N] = x[i-1] + sin(th[i])\nlet y[i in 1..N] = y[i-1] - cos(th[i])\n"
      "kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2))\npotential = sum(i in 1..N, m*g*y[i])\n"
      "dissipation = sum(i in 2..N, 0.1*(th[i]' - th[i-1]')^2)\nforce (x[N], y[N]) = (-x[N]', 2)\n",
      n);
}

/* A chain below a cart, whose velocity every term of the kinetic energy adds by itself; and a rotor that every link
 * drives. */
static const char *cart(Arena *a, int n) {
  return arena_printf(
      a,
      "model m\nconst N = %d\ncoord c, th[N], w\nparam m = 1 > 0, g = 9.81 > 0\nlet x[0] = 0, y[0] = 0\n"
      "let x[i in 1..N] = x[i-1] + sin(th[i])\nlet y[i in 1..N] = y[i-1] - cos(th[i])\n"
      "kinetic = m*c'^2 + m*w'^2 + sum(i in 1..N, m/2*((x[i]' + c')^2 + y[i]'^2) + 0.1*(w' + th[i]')^2)\n"
      "potential = sum(i in 1..N, m*g*y[i])\n",
      n);
}

static void test_chains(void **state) {
  (void)state;
  const Writer writers[] = {family, renamed, by_hand, relative, spatial, tree, squares, driven, cart};
  for (size_t step = (size_t)depth(4, 2, 1), i = first_row(step); i < sizeof writers / sizeof *writers; i += step)
    check_linear(writers[i]);
}

/* --- where it does not pay, or must not happen --- */

/* A node between two others: the cost is that of the fill-in. */
static void test_net(void **state) {
  (void)state;
  const char *net = "model m\nconst N = 5\ncoord a[N,N]\nparam m = 1 > 0\nlet x[i in 0..N, j in 0..N] = if(i < 1 or j "
                    "< 1, 0, (x[i-1,j] + x[i,j-1])/2 + sin(a[i,j]))\n"
                    "lagrangian = sum(i in 1..N, sum(j in 1..N, m/2*x[i,j]'^2 + m/2*a[i,j]'^2 - m*x[i,j]))\n";
  uint32_t ops = check(net, 1);
  assert_true(ops < 25 * 25 * 25 / 3); /* a dense factorization alone */
}

static void test_short_ones_stay_dense(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  check(family(a, 2), 0);
  check("model m\ncoord x, th\nparam M = 2 > 0, m = 1 > 0, l = 0.5 > 0, g = 9.81\nlet px = x + l*sin(th), py = "
        "-l*cos(th)\n"
        "lagrangian = M/2*x'^2 + m/2*(px'^2 + py'^2) - m*g*py\n",
        0);
  arena_free(a);
}

/* Pivots of an indefinite mass matrix may vanish: it is solved with pivoting. */
static void test_indefinite(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, "model m\nconst N = 30\ncoord a[N]\nlet x[0] = 0\nlet x[i in 1..N] = x[i-1] + sin(a[i])\n"
                             "lagrangian = sum(i in 2..N, x[i]'*x[i-1]') + a[1]'^2\n", NULL);
  assert_non_null(e);
  assert_false(e->definite_mass);
  assert_int_equal(e->system.ndefs, 0);
  arena_free(arena);
}

/* Where parameters declare no sign those of their values count, and a pivot tells when they are others. */
static void test_undeclared_signs(void **state) {
  (void)state;
  enum { N = 30 };
  Arena *arena = arena_new(NULL);
  const char *text = "model m\nconst N = %d\ncoord th[N]\nparam m[N] = 1.3, l = 0.7, g = 9.81\nlet x[0] = 0, y[0] = 0\n"
                     "let x[i in 1..N] = x[i-1] + l*sin(th[i])\nlet y[i in 1..N] = y[i-1] - l*cos(th[i])\n" ENERGIES;
  Eqns *e = equations(arena, arena_printf(arena, text, N), NULL);
  assert_non_null(e);
  assert_false(e->definite_mass);
  assert_true(e->system.ndefs > 0);
  Prog *p = lower_accel(e, 0);
  Real *v = random_point(e), got[N], want[N];
  for (uint32_t i = 0; i < e->m->params.n; i++) v[e->m->params.at[i].sym] = 1.5L;
  assert_int_equal(run_prog(e, p, v, got, NULL), 0);
  dense_accelerations(e, v, want);
  for (int i = 0; i < N; i++) assert_true(fabsl(got[i] - want[i]) <= 1e-14L * (1 + fabsl(want[i])) * N);
  v[e->m->params.at[N / 2].sym] = -100; /* a mass */
  assert_int_equal(run_prog(e, p, v, got, NULL), -1);
  arena_free(arena);
}

/* Inertia that couples neighbours, as elements of a rod do: what is zero stays out of the solution. */
static void test_consistent_mass(void **state) {
  (void)state;
  const char *text = "model m\nconst N = %d\ncoord x[N]\nparam m = 1 > 0, k = 2\n"
                     "kinetic = m/6*x[1]'^2 + sum(i in 2..N, m/6*(x[i-1]'^2 + x[i-1]'*x[i]' + x[i]'^2))\n"
                     "potential = sum(i in 2..N, k/2*(x[i] - x[i-1])^2)\n";
  Arena *arena = arena_new(NULL);
  uint32_t ops = check(arena_printf(arena, text, 40), 0);
  assert_true(ops < 15 * 40);
  arena_free(arena);
}

/* No mass matrix is made for a long chain, and it can still be had. */
static void test_long(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  uint32_t n = (uint32_t)slow(300, 100);
  Eqns *e = equations(arena, arena_printf(arena, CHAIN ENERGIES, n), NULL);
  assert_non_null(e);
  assert_false(e->mass_known);
  assert_int_equal(e->system.ndefs, 2*n);
  assert_true(arena_used(arena) < (size_t)100 << 20);
  eqns_derive_mass(e);
  assert_int_equal(e->mass.n, n*(n + 1)/2);
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_textbook), cmocka_unit_test(test_chains), cmocka_unit_test(test_net),
      cmocka_unit_test(test_short_ones_stay_dense), cmocka_unit_test(test_indefinite),
      cmocka_unit_test(test_undeclared_signs), cmocka_unit_test(test_consistent_mass), cmocka_unit_test(test_long),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
