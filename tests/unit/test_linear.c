/* The linearisation of equations of motion against Jacobians from elsewhere: derived on paper, or by SymPy. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "mech/linearise.h"

typedef long double Real;
enum { MOST = 8 };

typedef struct {
  Eqns *e;
  const Real *v;
  Real dr[MOST][MOST], M[MOST][MOST]; /* as the emitted function would give them */
  uint32_t ndr;
} Moment;

static Real val(const Moment *s, const char *name) { return at(s->e, s->v, name); }

/* The values of dr and M at the point v; q'' are values of v like any other. */
static void linearise(Moment *s) {
  Eqns *e = s->e;
  Arena *a = e->m->arena;
  Partials dr = eqns_linearise(e);
  Prog *p = lower_linear(e, dr, BY_STATE);
  assert_null(prog_verify(p));
  Real *out0 = ARENA_ARRAY(a, Real, dr.n + 1), *out1 = ARENA_ARRAY(a, Real, e->mass.n + 1);
  assert_int_equal(run_prog(e, p, s->v, out0, out1), 0);
  for (int i = 0; i < MOST; i++)
    for (int j = 0; j < MOST; j++) s->dr[i][j] = s->M[i][j] = 0;
  for (uint32_t k = 0; k < dr.n; k++) s->dr[dr.at[k].row][dr.at[k].col] = out0[k];
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *x = &e->mass.at[k];
    s->M[x->row][x->col] = s->M[x->col][x->row] = out1[k];
  }
  s->ndr = dr.n;
}

static void close_to(Real got, Real want, const char *what) {
  if (!(fabsl(got - want) <= 1e-15L * (1 + fabsl(want)))) fail_msg("%s is %.18Lg, not %.18Lg", what, got, want);
}

static void compare(const char *lag, void (*by_hand)(const Moment *s, Real want[MOST][MOST])) {
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, lag, NULL);
  assert_non_null(e);
  for (int trial = 0; trial < 20; trial++) {
    Moment s = {.e = e, .v = random_point(e)};
    Real want[MOST][MOST] = {{0}};
    linearise(&s);
    by_hand(&s, want);
    for (int i = 0; i < MOST; i++)
      for (int j = 0; j < MOST; j++)
        close_to(s.dr[i][j], want[i][j], arena_printf(arena, "dr[%d][%d] of\n%s", i, j, lag));
  }
  arena_free(arena);
}

/* (M + m) x'' + m l cos th th'' = m l sin th th'^2 - k x;  m l cos th x'' + m l^2 th'' = -m g l sin th - c th' */
static void cart(const Moment *s, Real r[MOST][MOST]) {
  Real m = val(s, "m"), l = val(s, "l"), g = val(s, "g"), th = val(s, "th"), w = val(s, "th'");
  Real ax = val(s, "x''"), ath = val(s, "th''");
  r[0][0] = -val(s, "k");
  r[0][1] = m * l * cosl(th) * w * w + m * l * sinl(th) * ath;
  r[0][3] = 2 * m * l * sinl(th) * w;
  r[1][1] = -m * g * l * cosl(th) + m * l * sinl(th) * ax;
  r[1][3] = -val(s, "c");
}

static void test_cart(void **state) {
  (void)state;
  compare("model m\ncoord x, th\nparam M = 2, m = 0.7, l = 0.4, g = 9.81, k = 3, c = 0.2\n"
          "let px = x + l*sin(th)\nlet py = -l*cos(th)\n"
          "kinetic = M/2*x'^2 + m/2*(px'^2 + py'^2)\npotential = m*g*py + k/2*x^2\ndissipation = c/2*th'^2\n", cart);
}

/* m r'' = q B r' x e_z - k r: velocity-dependent, no work. */
static void magnet(const Moment *s, Real r[MOST][MOST]) {
  r[0][0] = r[1][1] = -val(s, "k");
  r[0][3] = val(s, "B");
  r[1][2] = -val(s, "B");
}

static void test_gyroscopic(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nparam m = 1.3, B = 0.7, k = 2\n"
          "lagrangian = m/2*(x'^2 + y'^2) + B/2*(x*y' - y*x') - k/2*(x^2 + y^2)\n", magnet);
}

/* J th'' = K i - mgl sin th;  i' = (U - R i - K th')/L */
static void motor(const Moment *s, Real r[MOST][MOST]) {
  r[0][0] = -val(s, "G") * cosl(val(s, "th"));
  r[0][2] = val(s, "K");
  r[1][1] = -val(s, "K") / val(s, "Li");
  r[1][2] = -val(s, "R") / val(s, "Li");
}

static void test_state(void **state) {
  (void)state;
  compare("model m\ncoord th\nstate i\nparam J = 0.2, K = 0.3, R = 1.5, Li = 0.5, U = 6, G = 2\n"
          "lagrangian = J/2*th'^2 + G*cos(th)\nforce th = K*i\nflow i' = (U - R*i - K*th')/Li\n", motor);
}

/* No coordinates at all: Lorenz (1963). */
static void lorenz(const Moment *s, Real r[MOST][MOST]) {
  r[0][0] = -10;
  r[0][1] = 10;
  r[1][0] = 28 - val(s, "z");
  r[1][1] = -1;
  r[1][2] = -val(s, "x");
  r[2][0] = val(s, "y");
  r[2][1] = val(s, "x");
  r[2][2] = -8.0L / 3;
}

static void test_flow(void **state) {
  (void)state;
  compare("model m\nstate x, y, z\nflow x' = 10*(y - x)\nflow y' = x*(28 - z) - y\nflow z' = x*y - 8/3*z\n", lorenz);
}

/* m(1 + z) x'' = -m z' x' - k x with z' = -z/2, so f = m z x'/2 - k x: M depends on a state, p' on its flow. */
static void melting(const Moment *s, Real r[MOST][MOST]) {
  Real m = val(s, "m"), z = val(s, "z"), w = val(s, "x'");
  r[0][0] = -val(s, "k");
  r[0][1] = m * z / 2;
  r[0][2] = m * w / 2 - m * val(s, "x''");
  r[1][2] = -0.5L;
}

static void test_mass_of_a_state(void **state) {
  (void)state;
  compare("model m\ncoord x\nstate z\nparam m = 1.5, k = 3\nlagrangian = m/2*(1 + z)*x'^2 - k/2*x^2\nflow z' = -z/2\n",
          melting);
}

/* M = m gamma^3 for L = -m c^2 sqrt(1 - v^2/c^2), so dr/dv = -3 m gamma^5 v a/c^2: M depends on the velocity. */
static void relativistic(const Moment *s, Real r[MOST][MOST]) {
  Real m = val(s, "m"), c = val(s, "c"), v = val(s, "x'"), gamma = 1 / sqrtl(1 - v * v / (c * c));
  r[0][0] = -val(s, "k");
  r[0][1] = -3 * m * powl(gamma, 5) * v * val(s, "x''") / (c * c);
}

static void test_mass_of_a_velocity(void **state) {
  (void)state;
  compare("model m\ncoord x\nparam m = 1.5, k = 3, c = 4\nlagrangian = -m*c^2*sqrt(1 - x'^2/c^2) - k/2*x^2\n",
          relativistic);
}

/* A string of N masses: three entries a row, whatever N is. */
static void test_sparse(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, "model m\nconst N = 500\ncoord u[N]\nparam k = 2\nkinetic = sum(i in 1..N, u[i]'^2/2)\n"
                             "potential = sum(i in 0..N, k/2*(if(i < N, u[i+1], 0) - if(i > 0, u[i], 0))^2)\n", NULL);
  assert_non_null(e);
  Partials dr = eqns_linearise(e);
  assert_int_equal(dr.n, 3 * 500 - 2);
  for (uint32_t k = 1; k < dr.n; k++)
    assert_true(dr.at[k].row > dr.at[k - 1].row ||
                (dr.at[k].row == dr.at[k - 1].row && dr.at[k].col > dr.at[k - 1].col));
  arena_free(arena);
}

/* d(th1'', th2'')/d(th1, th2, th1', th2') of the double pendulum, by SymPy 1.11: Lagrange's equations of T - V,
 * solve() for the accelerations, diff() of them, N(..., 22) at th1 = 3/10, th2 = -7/10, th1' = 11/10, th2' = -2/5
 * with m1 = 3/2, m2 = 1/2, l1 = 3/4, l2 = 5/4, g = 9.81. */
static const Real sympy[2][4] = {
  {-10.09562666876147577352L, -1.926235478082926280214L, -0.2697430866873024591156L, 0.3025725724706835355417L},
  {0.8345030262565958025077L, -2.939720608803900024098L, 1.198187386983906800745L, -0.09808839515901907604203L},
};

static void test_double_pendulum(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Eqns *e =
      equations(arena,
                "model m\ncoord th1, th2\nparam m1 = 3/2, m2 = 1/2, l1 = 3/4, l2 = 5/4, g = 9.81\n"
                "let x1 = l1*sin(th1)\nlet y1 = -l1*cos(th1)\nlet x2 = x1 + l2*sin(th2)\nlet y2 = y1 - l2*cos(th2)\n"
                "kinetic = m1/2*(x1'^2 + y1'^2) + m2/2*(x2'^2 + y2'^2)\npotential = m1*g*y1 + m2*g*y2\n",
                NULL);
  assert_non_null(e);
  Real *v = random_point(e), acc[2];
  v[symbol_named(e, "th1")] = 0.3L;
  v[symbol_named(e, "th2")] = -0.7L;
  v[symbol_named(e, "th1'")] = 1.1L;
  v[symbol_named(e, "th2'")] = -0.4L;
  assert_int_equal(run_prog(e, lower_accel(e, 0), v, acc, NULL), 0);
  v[symbol_named(e, "th1''")] = acc[0];
  v[symbol_named(e, "th2''")] = acc[1];
  Moment s = {.e = e, .v = v};
  linearise(&s);
  Real det = s.M[0][0] * s.M[1][1] - s.M[0][1] * s.M[1][0];
  /* 1e-15: rounding of some tens of operations in extended precision, and of the solution */
  for (int j = 0; j < 4; j++) {
    close_to((s.M[1][1] * s.dr[0][j] - s.M[0][1] * s.dr[1][j]) / det, sympy[0][j], "a Jacobian's first row");
    close_to((s.M[0][0] * s.dr[1][j] - s.M[1][0] * s.dr[0][j]) / det, sympy[1][j], "a Jacobian's second row");
  }
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_cart),
    cmocka_unit_test(test_gyroscopic),
    cmocka_unit_test(test_state),
    cmocka_unit_test(test_flow),
    cmocka_unit_test(test_mass_of_a_state),
    cmocka_unit_test(test_mass_of_a_velocity),
    cmocka_unit_test(test_sparse),
    cmocka_unit_test(test_double_pendulum),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
