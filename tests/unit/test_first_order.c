/* Lagrangians that are linear in all velocities: rates against formulas derived by hand, at random states, and
 * against a linear system that the test fills and solves itself. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/dense_matrix.h"
#include "compile_text.h"
#include "mech/antisymmetric_solve.h"

typedef long double Real;

typedef struct {
  const Eqns *e;
  const Real *v;
} Moment;

static Real val(const Moment *s, const char *name) { return at(s->e, s->v, name); }

enum { MOST = 16, TRIALS = 50 };

/* Rates by hand, in the order of declaration; coordinates are positive where `positive`. The error allowed is that
 * of 50 operations, times how far a singular state may be: 1e3. */
static void compare(const char *lag, int positive, void (*by_hand)(const Moment *s, Real *z)) {
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, lag, NULL);
  assert_non_null(e);
  assert_true(e->m->first_order);
  assert_int_equal(e->m->coords.n, 0);
  Prog *p = lower_accel(e, 0);
  assert_null(prog_verify(p));
  for (int trial = 0; trial < TRIALS; trial++) {
    Real *point = random_point(e), z[MOST] = {0}, want[MOST] = {0};
    for (uint32_t i = 0; positive && i < e->m->states.n; i++)
      point[e->m->states.at[i].z] = 1.25L + 0.5L * point[e->m->states.at[i].z];
    Moment s = {e, point};
    assert_int_equal(run_prog(e, p, s.v, NULL, z), 0);
    by_hand(&s, want);
    for (uint32_t i = 0; i < e->m->states.n; i++)
      if (!(fabsl(z[i] - want[i]) <= 1e-14L * (1 + fabsl(want[i]))))
        fail_msg("%s\nrate %u: %Lg, by hand %Lg", lag, i, z[i], want[i]);
  }
  arena_free(arena);
}

/* ---- by hand ---- */

static void hunters(const Moment *s, Real *z) {
  Real x = val(s, "x"), y = val(s, "y");
  z[0] = x * (1 - y);
  z[1] = y * (x - 1);
}

static void test_lotka_volterra(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nlagrangian = -log(y)/x*x' - (x - log(x) + y - log(y))\n", 1, hunters);
  /* A total time derivative, here of log(x)*log(y), changes momenta and no motion. */
  compare("model m\ncoord x, y\nlagrangian = log(x)/y*y' - (x - log(x) + y - log(y))\n", 1, hunters);
  /* As lets, and as kinetic and potential energy. */
  compare("model m\ncoord x, y\nlet a = log(x)\nlet b = log(y)\nkinetic = (a*b' - b*a')/2\npotential = x - a + y - b\n",
          1, hunters);
}

/* q' = dH/dp, p' = -dH/dq + F(t): L = p q' - H. */
static void phase_space(const Moment *s, Real *z) {
  Real q = val(s, "q"), p = val(s, "p"), k = val(s, "k"), t = val(s, "t");
  z[0] = p * (1 + q * q);
  z[1] = -k * sinl(q) - q * p * p + cosl(t) - val(s, "c") * z[0];
}

static void test_phase_space(void **state) {
  (void)state;
  compare("model m\ncoord q, p\nparam k = 1.5, c = 0.3\ninput u = cos(t)\n"
          "lagrangian = p*q' - p^2*(1 + q^2)/2 + k*cos(q)\nforce q = u\ndissipation = c/2*q'^2\n", 0, phase_space);
}

/* theta depends on time: d/dt (B(t) x) enters. L = B x y' - k/2 (x^2 + y^2), B = 2 + sin t:
 * y: B x' + B' x = -k y, x: 0 = B y' - k x. */
static void growing_field(const Moment *s, Real *z) {
  Real x = val(s, "x"), y = val(s, "y"), k = val(s, "k"), B = 2 + sinl(val(s, "t")), dB = cosl(val(s, "t"));
  z[0] = -(k * y + dB * x) / B;
  z[1] = k * x / B;
}

static void test_explicit_time(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nparam k = 1.5\nlagrangian = (2 + sin(t))*x*y' - k/2*(x^2 + y^2)\n", 0, growing_field);
}

/* The guiding centre in the field B = (0, -Az', Ay') of the potential (0, Ay, Az), Ay = 2 x + x^2/4, Az = 3 x^2/20:
 * X' = (u B* + b x mu grad B)/B*_par, u' = -mu B*.grad B/B*_par with B* = B + u curl b (R. G. Littlejohn, J. Plasma
 * Phys. 29 (1983) 111). All depend on x alone. */
static void guiding_centre(const Moment *s, Real *z) {
  Real x = val(s, "x"), u = val(s, "u"), mu = val(s, "mu");
  Real By = -0.3L * x, Bz = 2 + x / 2, dBy = -0.3L, dBz = 0.5L;
  Real B = sqrtl(By * By + Bz * Bz), dB = (By * dBy + Bz * dBz) / B, by = By / B, bz = Bz / B;
  Real dby = dBy / B - by * dB / B, dbz = dBz / B - bz * dB / B;
  Real Sy = By - u * dbz, Sz = Bz + u * dby; /* curl (0, by, bz) = (0, -bz', by') */
  Real par = Sy * by + Sz * bz;
  z[0] = 0;
  z[1] = (u * Sy + mu * bz * dB) / par; /* b x (dB, 0, 0) = (0, bz dB, -by dB) */
  z[2] = (u * Sz - mu * by * dB) / par;
  z[3] = 0;
}

static void test_guiding_centre(void **state) {
  (void)state;
  compare("model m\ncoord x, y, z, u\nparam mu = 0.7\nlet Ay = 2*x + x^2/4\nlet Az = 3*x^2/20\nlet By = -3*x/10\nlet "
          "Bz = 2 + x/2\n"
          "let B = sqrt(By^2 + Bz^2)\nlagrangian = (Ay + u*By/B)*y' + (Az + u*Bz/B)*z' - u^2/2 - mu*B\n",
          0, guiding_centre);
}

/* A state beside coordinates, whose flow contains a velocity. x' = -dH/dy, y' = dH/dx with H = (x^2 + y^2)/2 + c x. */
static void beside(const Moment *s, Real *z) {
  z[0] = -val(s, "y");
  z[1] = val(s, "x") + val(s, "c");
  z[2] = z[0] - val(s, "c");
}

static void test_states_beside(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nstate c\nlagrangian = x*y' - (x^2 + y^2)/2 - c*x\nflow c' = x' - c\n", 0, beside);
}

/* ---- many coordinates: L = sum over i > j of w_ij q_i q_j' - sum a_i q_i^3/3, so omega_ij = w_ji - w_ij ---- */

static Real weight(uint32_t i, uint32_t j) { return sinl(1 + 3.7L * i + 1.3L * j * j); } /* no pattern */

static const char *coupled(Arena *a, uint32_t n, const char *sign, int banded) {
  StrBuf b = strbuf(a);
  sb_puts(&b, "model m\n");
  for (uint32_t i = 0; i < n; i++) sb_printf(&b, "coord q%u\n", i);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < i; j++)
      if (!banded || i == j + 1)
        sb_printf(&b, "param w%u_%u = %.17Lg%s\n", i, j, *sign ? 2 + weight(i, j) : weight(i, j), sign);
  sb_puts(&b, "lagrangian = 0");
  for (uint32_t i = 0; i < n; i++) {
    sb_printf(&b, " - %u*q%u^3/3", i + 1, i);
    for (uint32_t j = 0; j < i; j++)
      if (!banded || i == j + 1) sb_printf(&b, " + w%u_%u*q%u*q%u'", i, j, i, j);
  }
  sb_putc(&b, '\n');
  return sb_text(&b);
}

/* The emitted rates satisfy omega q' = dH/dq, solved here by elimination with full pivoting. */
static void check_coupled(uint32_t n, const char *sign, int banded) {
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, coupled(arena, n, sign, banded), NULL);
  assert_non_null(e);
  Prog *p = lower_accel(e, 0);
  assert_null(prog_verify(p));
  for (int trial = 0; trial < 10; trial++) {
    Real *v = random_point(e), got[MOST] = {0}, A[MOST * MOST] = {0}, b[MOST];
    char name[32];
    assert_int_equal(run_prog(e, p, v, NULL, got), 0);
    for (uint32_t i = 0; i < n; i++) {
      Real q = v[e->m->states.at[i].z];
      b[i] = (i + 1) * q * q;
      for (uint32_t j = 0; j < i; j++) {
        if (banded && i != j + 1) continue;
        snprintf(name, sizeof name, "w%u_%u", i, j);
        A[i * n + j] = at(e, v, name); /* theta_j = w_ij q_i: omega_ij = dtheta_j/dq_i */
        A[j * n + i] = -A[i * n + j];
      }
    }
    assert_int_equal(dense_solve(e->m->arena, n, A, b, 0, NULL), n);
    for (uint32_t i = 0; i < n; i++) /* of either solver, by conditions below 1e4 */
      if (!(fabsl(got[i] - b[i]) <= 1e-14L * (1 + fabsl(b[i]))))
        fail_msg("%u coordinates, rate %u: %Lg, solved %Lg", n, i, got[i], b[i]);
  }
  arena_free(arena);
}

static void test_pfaffians(void **state) {
  (void)state;
  for (uint32_t n = 2; n <= ANTISYMMETRIC_MOST; n += 2) check_coupled(n, "", 0);
}

static void test_elimination(void **state) {
  (void)state;
  check_coupled(4, " > 0", 0);
  check_coupled(8, " > 0", 0);
  for (uint32_t n = 2; n <= MOST; n += 2) check_coupled(n, " > 0", 1); /* more than Pfaffians are for */
}

/* ---- what it is recognised by ---- */

static void test_recognised(void **state) {
  (void)state;
  static const struct {
    const char *text;
    int first, constant, closed, conserves;
  } models[] = {
    {"coord x, y\nlagrangian = x*y' - x^2 - y^2\n", 1, 1, 1, 1},
    {"coord x, y\nlagrangian = x^2*y' - x^2 - y^2\n", 1, 0, 1, 1},
    {"coord x, y\nlagrangian = exp(t)*x*y' - x^2 - y^2\n", 1, 0, 1, 0},
    {"coord x, y\nlagrangian = x*y' - x^2 - y^2\nforce x = -x'\n", 1, 1, 0, 0},
    {"coord x, y\nlagrangian = x*y' - x^2 - y^2 + t*x\n", 1, 1, 1, 0},
    {"coord x, y\nlagrangian = x'*y' - x^2 - y^2\n", 0, 0, 0, 1},
    {"coord x, y\nlagrangian = (x*y')^2/2 + x'^2/2 - x^2 - y^2\n", 0, 0, 0, 1},
    {"coord x, y\nlagrangian = sqrt(1 + x'^2 + y'^2)\n", 0, 0, 0, 1},
  };
  for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
    Arena *arena = arena_new(NULL);
    Eqns *e = equations(arena, arena_printf(arena, "model m\n%s", models[i].text), NULL);
    assert_non_null(e);
    assert_int_equal(e->first.n > 0, models[i].first);
    assert_int_equal(e->conserves_energy, models[i].conserves);
    if (models[i].first) {
      assert_int_equal(e->first.constant, models[i].constant);
      assert_int_equal(e->first.closed, models[i].closed);
    }
    arena_free(arena);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_lotka_volterra), cmocka_unit_test(test_phase_space),    cmocka_unit_test(test_explicit_time),
    cmocka_unit_test(test_guiding_centre), cmocka_unit_test(test_states_beside),  cmocka_unit_test(test_pfaffians),
    cmocka_unit_test(test_elimination),    cmocka_unit_test(test_recognised),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
