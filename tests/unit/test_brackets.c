/* Poisson brackets of the charges that are found: structure constants of textbooks, by the names of the charges, and
 * Jacobi's identity. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "symmetry/poisson_brackets.h"
#include "sym/print.h"
#include "sym/prove.h"

typedef struct {
  Arena *arena;
  Eqns *e;
  FoundSymmetries found;
  Algebra algebra;
} Charges;

static Charges charges(const char *lag) {
  Charges c = {.arena = test_arena()};
  c.e = equations(c.arena, lag, NULL);
  assert_non_null(c.e);
  SearchLimit limit = search_limit(INFINITY);
  c.found = noether_find(c.e, &limit);
  c.algebra = brackets_find(c.e, &c.found, &limit);
  assert_null(c.algebra.why_not);
  assert_int_equal(c.algebra.by_value, 0);
  return c;
}

static uint32_t charge(const Charges *c, const char *name) {
  for (uint32_t k = 0; k < c->found.all.n; k++)
    if (strcmp(c->found.all.at[k].name, name) == 0) return k;
  fail_msg("no charge %s", name);
  return 0;
}

/* {a, b}; NULL: it is 0. */
static const Bracket *bracket(const Charges *c, uint32_t a, uint32_t b) {
  for (uint32_t k = 0; k < c->algebra.all.n; k++)
    if (c->algebra.all.at[k].a == a && c->algebra.all.at[k].b == b) return &c->algebra.all.at[k];
  return NULL;
}

/* The coefficient of charge k in {a, b}, or the constant for k = number of charges, at the values of the parameters. */
static long double constant(const Charges *c, uint32_t a, uint32_t b, uint32_t k) {
  const Bracket *x = a < b ? bracket(c, a, b) : bracket(c, b, a);
  long double value;
  if (!x) return 0;
  assert_non_null(x->c);
  Expr e = k < c->found.all.n ? x->c[k] : x->constant;
  test_rng = 5;
  expr_eval(c->e->g, &e, 1, random_point(c->e), &value);
  return a < b ? value : -value;
}

/* {a, b} = factor * to (NULL: factor alone), and nothing else. */
static void is(const Charges *c, const char *a, const char *b, long double factor, const char *to) {
  uint32_t n = c->found.all.n, one = charge(c, a), other = charge(c, b), only = to ? charge(c, to) : n;
  for (uint32_t k = 0; k <= n; k++) {
    long double expected = k == only ? factor : 0, got = constant(c, one, other, k);
    if (!(fabsl(got - expected) < 1e-15L))
      fail_msg("{%s, %s} has %Lg of charge %u, expected %Lg", a, b, got, k, expected);
  }
}

/* sum over cyclic (a, b, c) of {{a, b}, c}: each is a combination again, and all of them add up to 0. Sums of
 * products of a few small numbers, so 1e-15 is rounding. */
static void jacobi(const Charges *c) {
  uint32_t n = c->found.all.n, m = n + 1;
  long double *f = ARENA_ARRAY(c->arena, long double, (size_t)n * n * m);
  for (uint32_t a = 0; a < n; a++)
    for (uint32_t b = 0; b < n; b++)
      for (uint32_t k = 0; k < m; k++) f[((size_t)a * n + b) * m + k] = a == b ? 0 : constant(c, a, b, k);
  for (size_t a = 0; a < n; a++)
    for (size_t b = 0; b < a; b++)
      for (size_t d = 0; d < b; d++)
        for (size_t k = 0; k < m; k++) {
          long double sum = 0;
          for (size_t x = 0; x < n; x++)
            sum += f[(a * n + b) * m + x] * f[(x * n + d) * m + k] + f[(b * n + d) * m + x] * f[(x * n + a) * m + k] +
                   f[(d * n + a) * m + x] * f[(x * n + b) * m + k];
          if (!(fabsl(sum) < 1e-13L))
            fail_msg("Jacobi's identity of charges %zu, %zu, %zu is off by %Lg", a + 1, b + 1, d + 1, sum);
        }
}

/* --- textbooks --- */

static void rotations(void **state) {
  (void)state;
  Charges c = charges("model k\ncoord x, y, z\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*(x'^2 + y'^2 + z'^2) + "
                      "k/sqrt(x^2 + y^2 + z^2)\n");
  is(&c, "angular momentum about x", "angular momentum about y", 1, "angular momentum about z");
  is(&c, "angular momentum about y", "angular momentum about z", 1, "angular momentum about x");
  is(&c, "angular momentum about z", "angular momentum about x", 1, "angular momentum about y");
  is(&c, "energy", "angular momentum about x", 0, NULL);
  arena_free(c.arena);
}

/* Bargmann: boosts t p - m x and momenta have the mass for a bracket. {x, p} = 1. */
static void galilei(void **state) {
  (void)state;
  Charges c = charges("model f\ncoord x, y, z\nparam m = 2 > 0\nlagrangian = m/2*(x'^2 + y'^2 + z'^2)\n");
  is(&c, "momentum of x", "boost along x", 2, NULL);
  is(&c, "momentum of x", "boost along y", 0, NULL);
  is(&c, "energy", "boost along z", 1, "momentum of z");
  is(&c, "angular momentum about x", "boost along y", 1, "boost along z");
  is(&c, "angular momentum about z", "momentum of x", 1, "momentum of y");
  jacobi(&c);
  arena_free(c.arena);
}

/* Two bodies: the central mass is the sum. */
static void two_bodies(void **state) {
  (void)state;
  Charges c = charges("model n\ncoord x1, y1, x2, y2\nparam a = 2 > 0, b = 3 > 0, k = 1\nlagrangian = a/2*(x1'^2 + "
                      "y1'^2) + b/2*(x2'^2 + y2'^2) + k/hypot(x1 - x2, y1 - y2)\n");
  is(&c, "total momentum along x", "boost along x: the centre of mass moves uniformly", 5, NULL);
  jacobi(&c);
  arena_free(c.arena);
}

/* sl(2) of an inverse square (de Alfaro, Fubini, Furlan 1976), of the scaling D = p x - 2 t E and the expansion
 * C = t p x - t^2 E - m x^2/2. dQ/dt = {Q, E} + (Q by t) = 0 gives {E, D} = -2 E and {E, C} = p x - 2 t E = D. */
static void inverse_square(void **state) {
  (void)state;
  Charges c = charges("model i\ncoord x\nparam m = 2 > 0, k = 3\nlagrangian = m/2*x'^2 - k/x^2\n");
  is(&c, "energy", "scaling", -2, "energy");
  is(&c, "energy", "expansion", 1, "scaling");
  is(&c, "scaling", "expansion", -2, "expansion");
  jacobi(&c);
  arena_free(c.arena);
}

/* Translations in a uniform field do not commute: {m x' - b y, m y' + b x} = -b (Landau & Lifshitz, Quantum
 * Mechanics, 112). */
static void magnetic(void **state) {
  (void)state;
  Charges c =
      charges("model b\ncoord x, y\nparam m = 2 > 0, b = 3\nlagrangian = m/2*(x'^2 + y'^2) + b/2*(x*y' - y*x')\n");
  is(&c, "magnetic translation along x", "magnetic translation along y", -3, NULL);
  is(&c, "energy", "magnetic translation along x", 0, NULL);
  jacobi(&c);
  arena_free(c.arena);
}

/* The algebra of a charge on a spring in a magnetic field closes, too. */
static void two_rates(void **state) {
  (void)state;
  Charges c = charges("model b\ncoord x, y\nparam m = 2 > 0, b = 3 > 0, k = 1 > 0\nlagrangian = m/2*(x'^2 + y'^2) + "
                      "b/2*(x*y' - y*x') - k/2*(x^2 + y^2)\n");
  assert_int_equal(c.found.all.n, 8);
  jacobi(&c);
  arena_free(c.arena);
}

static void oscillator(void **state) {
  (void)state;
  Charges c =
      charges("model o\ncoord x, y\nparam m = 2 > 0, k = 8 > 0\nlagrangian = m/2*(x'^2 + y'^2) - k/2*(x^2 + y^2)\n");
  assert_int_equal(c.found.all.n, 8);
  jacobi(&c);
  arena_free(c.arena);
}

static long double value_of(const Charges *c, const char *name) {
  test_rng = 5;
  for (SymId k = 1; k <= expr_symbol_count(c->e->g); k++)
    if (strcmp(expr_symbol(c->e->g, k)->name, name) == 0) return random_point(c->e)[k];
  return NAN;
}

/* z oscillates with w = sqrt(2/m) for itself, while L contains t: the energy in a moving frame, m k of it, turns cos
 * into sin with w m k. */
static void roots_of_numbers(void **state) {
  (void)state;
  Charges c = charges(
      "model r\ncoord x, z\nparam m = 2 > 0, k = 3 > 0, g = 1\nlagrangian = m/2*(x'^2 + z'^2) - g*cos(k*t)*x - z^2\n");
  uint32_t n = c.found.all.n, energy = charge(&c, "energy in a moving frame");
  for (uint32_t k = 0; k < c.algebra.all.n; k++) assert_non_null(c.algebra.all.at[k].c);
  long double got = 0;
  for (uint32_t i = n - 2; i < n; i++) got += fabsl(constant(&c, energy, n - 2, i));
  long double m = value_of(&c, "m"), k = value_of(&c, "k");
  assert_true(fabsl(got - sqrtl(2 * m) * k) < 1e-15L * got);
  arena_free(c.arena);
}

/* Momenta of vortices are coordinates of one another: the bracket of the two sums is the total circulation. L = G x
 * y' gives {x, y} = 1/G; Q along x is -G y, along y +G x, less their gauge, so {G y, -G x} = G {x, y} G. */
static void vortices(void **state) {
  (void)state;
  Charges c = charges("model v\ncoord x1, y1, x2, y2\nparam a = 1, b = 2\nlagrangian = a*(x1*y1' - y1*x1')/2 + "
                      "b*(x2*y2' - y2*x2')/2 + a*b*log((x1 - x2)^2 + (y1 - y2)^2)\n");
  long double value =
      constant(&c, charge(&c, "total momentum along x"), charge(&c, "total momentum along y"), c.found.all.n);
  assert_true(fabsl(fabsl(value) - 3) < 1e-15L);
  jacobi(&c);
  arena_free(c.arena);
}

static void refused(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  jmp_buf failed;
  if (setjmp(failed)) fail_msg("out of memory");
  arena_guard(a, &failed);
  Eqns *e = equations(a,
                      "model s\ncoord x, y, z\nparam g = 9.81, l = 1 > 0\nlagrangian = (x'^2 + y'^2 + z'^2)/2 - "
                      "g*z\nconstraint rod: x^2 + y^2 + z^2 = l^2\n",
                      NULL);
  SearchLimit limit = search_limit(INFINITY);
  FoundSymmetries found = noether_find(e, &limit);
  assert_non_null(brackets_find(e, &found, &limit).why_not);
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rotations),        cmocka_unit_test(galilei),  cmocka_unit_test(two_bodies),
      cmocka_unit_test(inverse_square),   cmocka_unit_test(magnetic), cmocka_unit_test(oscillator),
      cmocka_unit_test(vortices),         cmocka_unit_test(refused),  cmocka_unit_test(two_rates),
      cmocka_unit_test(roots_of_numbers),
  };
  return cmocka_run_group_tests_name("brackets", tests, NULL, NULL);
}
