/* Equations of motion against formulas derived by hand, at random states. Every formula here was
 * written from the Lagrangian on paper, not from what the program prints. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"

typedef long double Real;

typedef struct {
  const Eqns *e;
  const Real *v;
} Moment;

static Real val(const Moment *s, const char *name) { return at(s->e, s->v, name); }

/* Accelerations and rates by hand: a[], z[]. */
typedef void (*ByHand)(const Moment *s, Real *a, Real *z);

static void compare(const char *lag, ByHand by_hand) {
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, lag, NULL);
  assert_non_null(e);
  Prog *p = lower_accel(e, 0);
  assert_null(prog_verify(p));
  for (int trial = 0; trial < 50; trial++) {
    Moment s = {e, random_point(e)};
    Real a[8] = {0}, z[8] = {0}, want_a[8] = {0}, want_z[8] = {0};
    assert_int_equal(run_prog(e, p, s.v, a, z), 0);
    by_hand(&s, want_a, want_z);
    for (uint32_t i = 0; i < e->n; i++)
      if (!(fabsl(a[i] - want_a[i]) <= 1e-14L * (1 + fabsl(want_a[i]))))
        fail_msg("%s\nacceleration %u: %Lg, by hand %Lg", lag, i, a[i], want_a[i]);
    for (uint32_t i = 0; i < e->m->states.n; i++)
      if (!(fabsl(z[i] - want_z[i]) <= 1e-14L * (1 + fabsl(want_z[i]))))
        fail_msg("%s\nrate %u: %Lg, by hand %Lg", lag, i, z[i], want_z[i]);
  }
  arena_free(arena);
}

/* ---- Lagrangians ---- */

static void pendulum(const Moment *s, Real *a, Real *z) {
  (void)z;
  a[0] = -val(s, "g") / val(s, "l") * sinl(val(s, "th"));
}

static void test_pendulum(void **state) {
  (void)state;
  compare("model m\ncoord th\nparam m = 1.5, l = 0.7, g = 9.81\nlagrangian = m*l^2*th'^2/2 + m*g*l*cos(th)\n",
          pendulum);
  compare("model m\ncoord th\nparam m = 1.5, l = 0.7, g = 9.81\nlet x = l*sin(th)\nlet y = -l*cos(th)\n"
          "kinetic = m/2*(x'^2 + y'^2)\npotential = m*g*y\n", pendulum);
}

/* (M + m) x'' + m l cos th th'' = m l sin th th'^2;  cos th x'' + l th'' = -g sin th */
static void cart(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real M = val(s, "M"), m = val(s, "m"), l = val(s, "l"), g = val(s, "g"), th = val(s, "th"), w = val(s, "th'");
  a[0] = m * sinl(th) * (l * w * w + g * cosl(th)) / (M + m * sinl(th) * sinl(th));
  a[1] = -(g * sinl(th) + cosl(th) * a[0]) / l;
}

static void test_cart(void **state) {
  (void)state;
  compare("model m\ncoord x, th\nparam M = 2 > 0, m = 1 > 0, l = 0.5 > 0, g = 9.81\nlet px = x + l*sin(th)\nlet py = "
          "-l*cos(th)\n"
          "lagrangian = M/2*x'^2 + m/2*(px'^2 + py'^2) - m*g*py\n",
          cart);
  compare("model m\ncoord x, th\nparam M = 2, m = 1, l = 0.5, g = 9.81\n" /* no signs: the other solver */
          "lagrangian = (M + m)/2*x'^2 + m*l*cos(th)*x'*th' + m*l^2/2*th'^2 + m*g*l*cos(th)\n", cart);
}

/* Polar Kepler: r'' = r ph'^2 - k/r^2, ph'' = -2 r' ph'/r */
static void kepler(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real r = val(s, "r"), rd = val(s, "r'"), w = val(s, "ph'");
  a[0] = r * w * w - val(s, "k") / (r * r);
  a[1] = -2 * rd * w / r;
}

static void test_kepler(void **state) {
  (void)state;
  compare("model m\ncoord r, ph\nparam k = 1.3, m = 2 > 0\nlagrangian = m/2*(r'^2 + r^2*ph'^2) + m*k/r\n", kepler);
}

/* A charge in a uniform field B along z: L = m/2 v^2 + q B/2 (x y' - y x'), so m x'' = q B y', m y'' = -q B x'. */
static void charge(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real w = val(s, "q") * val(s, "B") / val(s, "m");
  a[0] = w * val(s, "y'");
  a[1] = -w * val(s, "x'");
}

static void test_velocity_dependent_potential(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nparam m = 1.2, q = 0.7, B = 3\nlagrangian = m/2*(x'^2 + y'^2) + q*B/2*(x*y' - y*x')\n",
          charge);
}

/* The pivot moves up and down by A cos(w t): th'' = -(g - A w^2 cos(w t))/l sin th */
static void shaken(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real A = val(s, "A"), w = val(s, "w");
  a[0] = -(val(s, "g") - A * w * w * cosl(w * val(s, "t"))) / val(s, "l") * sinl(val(s, "th"));
}

static void test_explicit_time(void **state) {
  (void)state;
  compare("model m\ncoord th\nparam m = 1, l = 0.7, g = 9.81, A = 0.2, w = 3\nlet x = l*sin(th)\nlet y = A*cos(w*t) - "
          "l*cos(th)\n"
          "lagrangian = m/2*(x'^2 + y'^2) - m*g*y\n",
          shaken);
}

/* A mass that grows: L = (m0 + k t) x'^2/2, so x'' = -k x'/(m0 + k t). */
static void growing(const Moment *s, Real *a, Real *z) {
  (void)z;
  a[0] = -val(s, "k") * val(s, "x'") / (val(s, "m0") + val(s, "k") * val(s, "t"));
}

static void test_mass_in_time(void **state) {
  (void)state;
  compare("model m\ncoord x\nparam m0 = 2, k = 0.5\nlagrangian = (m0 + k*t)*x'^2/2\n", growing);
}

/* L = x' y' - w^2 x y is indefinite: x'' = -w^2 x, y'' = -w^2 y. */
static void indefinite(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real w = val(s, "w");
  a[0] = -w * w * val(s, "x");
  a[1] = -w * w * val(s, "y");
}

static void test_indefinite(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nparam w = 1.4\nlagrangian = x'*y' - w^2*x*y\n", indefinite);
}

static int definite(const char *lagrangian) {
  Arena *arena = arena_new(NULL);
  char lag[300];
  snprintf(lag, sizeof lag, "model m\ncoord x, y\nparam m = 2 > 0, b = 1.4\nlet u = x*y' - y*x'\nlagrangian = %s\n",
           lagrangian);
  Eqns *e = equations(arena, lag, NULL);
  assert_non_null(e);
  int is = e->definite_mass;
  arena_free(arena);
  return is;
}

/* Terms linear in velocities, of whatever sign, have no part in the mass matrix. */
static void test_definite(void **state) {
  (void)state;
  assert_true(definite("m/2*(x'^2 + y'^2) - x^2*y"));
  assert_true(definite("m/2*(x'^2 + y'^2) + b*(x*y' - y*x')"));
  assert_true(definite("m/2*(x'^2 + y'^2) - b*u - x^3*y'"));
  assert_false(definite("m/2*(x'^2 + y'^2) + b*x'*y'"));
  assert_true(definite("m/6*(x'^2 + x'*y' + y'^2)")); /* a rod's, between its ends */
  assert_true(definite("m/2*(x'^2 + y'^2) + 0.9*m*x'*y' + b*x'"));
  assert_true(definite("m*cosh(x)*(2*(x'^2 + y'^2) - 3*(x' + u)*y' + 2*(x' + u)^2)"));
  assert_false(definite("m/2*(x'^2 + y'^2) + 1.01*m*x'*y'"));
  assert_false(definite("m/2*(x'^2 + y'^2) - 1.01*m*x'*y'"));
  assert_false(definite("m/2*x'^2 + y'^2/2 + m/4*x'*y'")); /* not for m above 16 */
  assert_false(definite("b*(x'^2 + y'^2)"));
  assert_false(definite("sinh(b)*(x'^2 + x'*y' + y'^2)"));
  assert_false(definite("m/2*(x'^2 + y'^2) + b*u^2"));
  assert_false(definite("m/2*(x'^2 + y'^2) + b*x*y'^2"));
}

/* A relativistic particle in a constant force: (g^3) x'' = F/m, with c = 1. */
static void relativistic(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real v = val(s, "x'") / 4;
  a[0] = val(s, "F") / val(s, "m") * powl(1 - v * v, 1.5L);
}

static void test_not_quadratic(void **state) {
  (void)state;
  compare("model m\ncoord x\nparam m = 1.5, F = 0.4, c = 4\nlagrangian = -m*c^2*sqrt(1 - x'^2/c^2) + F*x\n",
          relativistic);
}

/* ---- forces ---- */

/* A force along a coordinate is what stands on the right of M q'' = f, with its own sign. */
static void pushed(const Moment *s, Real *a, Real *z) {
  (void)z;
  a[0] = (val(s, "F") - val(s, "k") * val(s, "x")) / val(s, "m");
}

static void test_force(void **state) {
  (void)state;
  compare("model m\ncoord x\nparam m = 2, k = 3, F = 0.6\nlagrangian = m/2*x'^2 - k/2*x^2\nforce x = F\n", pushed);
  compare("model m\ncoord x\nparam m = 2, k = 3, F = 0.6\nlagrangian = m/2*x'^2\nforce x = F/2\nforce x = F/2 - k*x\n",
          pushed);
}

/* A force (Fx, Fy) at the bob of a pendulum: Q = l (Fx cos th + Fy sin th). */
static void blown(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real l = val(s, "l"), th = val(s, "th");
  a[0] = (l * (val(s, "Fx") * cosl(th) + val(s, "Fy") * sinl(th)) - val(s, "m") * val(s, "g") * l * sinl(th)) /
         (val(s, "m") * l * l);
}

static void test_point_force(void **state) {
  (void)state;
  compare("model m\ncoord th\nparam m = 1.2, l = 0.7, g = 9.81, Fx = 0.3, Fy = -0.8\nlet px = l*sin(th)\nlet py = "
          "-l*cos(th)\n"
          "lagrangian = m*l^2*th'^2/2 - m*g*py\nforce (px, py) = (Fx, Fy)\n",
          blown);
  compare("model m\ncoord th\nparam m = 1.2, l = 0.7, g = 9.81, Fx = 0.3, Fy = -0.8\n" /* gravity as a force, too */
          "lagrangian = m*l^2*th'^2/2\nforce (l*sin(th), -l*cos(th)) = (Fx, Fy - m*g)\n", blown);
}

/* Rayleigh: R = c/2 (x' - y')^2 takes -c (x' - y') from x and +c (x' - y') from y; another one adds. */
static void damped(const Moment *s, Real *a, Real *z) {
  (void)z;
  Real c = val(s, "c"), d = val(s, "d"), u = val(s, "x'"), v = val(s, "y'");
  a[0] = (-c * (u - v) - d * u * fabsl(u)) / val(s, "m");
  a[1] = c * (u - v) / val(s, "m");
}

static void test_dissipation(void **state) {
  (void)state;
  compare("model m\ncoord x, y\nparam m = 1.3, c = 0.4, d = 0.2\nlagrangian = m/2*(x'^2 + y'^2)\ndissipation = c/2*(x' "
          "- y')^2\n"
          "dissipation = d/3*abs(x')^3\n",
          damped);
}

/* ---- states ---- */

static void lorenz(const Moment *s, Real *a, Real *z) {
  (void)a;
  Real x = val(s, "x"), y = val(s, "y"), w = val(s, "w");
  z[0] = 10 * (y - x);
  z[1] = x * (28 - w) - y;
  z[2] = x * y - 8.0L / 3 * w;
}

static void test_states(void **state) {
  (void)state;
  compare("model m\nstate x, y, w\nparam s = 10, r = 28, b = 8/3\nflow x' = s*(y - x)\nflow y' = x*(r - w) - y\nflow "
          "w' = x*y - b*w\n",
          lorenz);
}

/* A momentum that contains a state takes the state's rate with it: L = z x' + x'^2/2 gives x'' = -z'. */
static void coupled(const Moment *s, Real *a, Real *z) {
  z[0] = -2 * val(s, "z") + val(s, "x'");
  a[0] = -z[0] - val(s, "x");
}

static void test_state_in_momentum(void **state) {
  (void)state;
  compare("model m\ncoord x\nstate z\nflow z' = -2*z + x'\nlagrangian = x'^2/2 + z*x' - x^2/2\n", coupled);
}

/* An input is a function of t that the model reads. */
static void driven(const Moment *s, Real *a, Real *z) {
  (void)z;
  a[0] = 3 * sinl(2 * val(s, "t")) * cosl(val(s, "x"));
}

static void test_input(void **state) {
  (void)state;
  compare("model m\ncoord x\ninput u = 3*sin(2*t)\nlagrangian = x'^2/2 + u*sin(x)\n", driven);
}

/* ---- energy ---- */

/* E = p q' - L by hand, for a Lagrangian with terms of degree 0, 1 and 2 in the velocities. */
static void test_energy(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, "model m\ncoord x, y\nparam m = 1.2, q = 0.7, B = 3, k = 2\n"
                             "lagrangian = m/2*(x'^2 + y'^2) + q*B/2*(x*y' - y*x') - k/2*(x^2 + y^2)\n", NULL);
  assert_non_null(e);
  assert_true(e->conserves_energy && e->constant_mass && e->autonomous && e->smooth);
  Prog *p = lower_energy(e);
  for (int trial = 0; trial < 20; trial++) {
    Moment s = {e, random_point(e)};
    Real out[2], u = val(&s, "x'"), v = val(&s, "y'"), x = val(&s, "x"), y = val(&s, "y");
    run_prog(e, p, s.v, out, NULL);
    Real pv = 1.2L * (u * u + v * v) + 1.05L * (x * v - y * u),
         L = 0.6L * (u * u + v * v) + 1.05L * (x * v - y * u) - (x * x + y * y);
    assert_true(fabsl(out[0] - (pv - L)) < 1e-15L);
    assert_true(fabsl(out[1] - (fabsl(pv) + fabsl(L))) < 1e-15L);
  }
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pendulum),      cmocka_unit_test(test_cart),
      cmocka_unit_test(test_kepler),        cmocka_unit_test(test_velocity_dependent_potential),
      cmocka_unit_test(test_explicit_time), cmocka_unit_test(test_mass_in_time),
      cmocka_unit_test(test_indefinite),    cmocka_unit_test(test_definite),
      cmocka_unit_test(test_not_quadratic), cmocka_unit_test(test_force),
      cmocka_unit_test(test_point_force),   cmocka_unit_test(test_dissipation),
      cmocka_unit_test(test_states),        cmocka_unit_test(test_state_in_momentum),
      cmocka_unit_test(test_input),         cmocka_unit_test(test_energy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
