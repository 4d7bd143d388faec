/* Splines through tables: against closed forms and another program's digits. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/spline.h"

enum { MOST = 401 };

static void assert_near(long double x, long double expected, double tolerance) {
  if (!(fabsl(x - expected) <= tolerance)) fail_msg("%.18Lg, expected %.18Lg within %g", x, expected, tolerance);
}

typedef struct {
  Arena *arena;
  double row[MOST][3];
  Spline s;
} Curve;

static void fit(Curve *c, uint32_t n) {
  assert_true(spline_fit(c->arena, c->row, n));
  c->s = (Spline){n, (const double(*)[3])c->row, NULL};
}

/* n uneven places from a to b: gaps vary by a factor of 3. */
static void place(Curve *c, uint32_t n, double a, double b, double (*f)(double)) {
  for (uint32_t i = 0; i < n; i++) {
    double part = (double)i / (n - 1);
    c->row[i][0] = a + (b - a) * (part + 0.5 * sin(2 * 3.14159265358979 * part) / 6.283185307179586);
    c->row[i][1] = f(c->row[i][0]);
  }
  c->row[n - 1][0] = b;
  c->row[n - 1][1] = f(b);
}

static int setup(void **state) {
  static Curve c;
  c.arena = arena_new(NULL);
  *state = &c;
  return 0;
}

static int teardown(void **state) {
  arena_free(((Curve *)*state)->arena);
  return 0;
}

static double line(double x) { return 3 - 2 * x; }
static double parabola(double x) { return 1 + x - 3 * x * x; }
static double cubic(double x) { return ((0.5 * x - 2) * x + 1) * x + 1; }

/* What a polynomial of degree 1, 2, 3 gives through 2, 3, 4 and more rows comes back, up to the ends: the natural
 * spline would miss the ends of the cubic by 0.1. Rounding: values below 20, a few operations each. */
static void test_polynomials(void **state) {
  static const struct {
    double (*f)(double);
    uint32_t from;
  } cases[] = {{line, 2}, {parabola, 3}, {cubic, 4}};
  Curve *c = *state;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (uint32_t n = cases[k].from; n < 12; n++) {
      place(c, n, -1, 3, cases[k].f);
      fit(c, n);
      for (int i = 0; i <= 100; i++) {
        double x = -1 + 0.04 * i;
        assert_near(spline_at(&c->s, 0, x), cases[k].f(x), 4e-14);
      }
    }
}

/* SciPy 1.10, scipy.interpolate.CubicSpline(t, y), whose default ends are "not-a-knot" too. */
static void test_other_program(void **state) {
  static const double t[] = {0, 0.1, 0.25, 0.5, 0.8, 1.3, 1.5, 2.1}, y[] = {1, -0.5, 2, 0.25, 3, -1, 0.75, 1.5};
  static const double at[][2] = {
    {0.05, -0.41145572130468233}, {0.2, 1.222911442609365}, {0.4, 1.2210376132125733},
    {0.65, 1.3070111880660629}, {1.0, 1.9692191440241524}, {1.45, 0.055275692039601726}, {1.9, 5.224977801456226},
  };
  Curve *c = *state;
  for (int i = 0; i < 8; i++) c->row[i][0] = t[i], c->row[i][1] = y[i];
  fit(c, 8);
  for (size_t i = 0; i < sizeof at / sizeof *at; i++) assert_near(spline_at(&c->s, 0, at[i][0]), at[i][1], 2e-13);
  for (int i = 0; i < 8; i++) assert_near(spline_at(&c->s, 0, t[i]), y[i], 0); /* a row comes back as it is */
}

/* The largest error against sin on [0, 3], ends included. */
static double error_with(Curve *c, uint32_t n) {
  double worst = 0;
  place(c, n, 0, 3, sin);
  fit(c, n);
  for (int i = 0; i <= 3000; i++) worst = fmax(worst, fabs((double)spline_at(&c->s, 0, 0.001 * i) - sin(0.001 * i)));
  return worst;
}

/* Order 4, two-sided: 4.10 between these, 4.03 from 801 rows on (SciPy's errors give the same). The natural spline's
 * is 2. */
static void test_order(void **state) {
  double coarse = error_with(*state, 201), fine = error_with(*state, 401), order = log(coarse / fine) / log(2);
  assert_near(order, 4, 0.15);
}

/* Value, slope and second derivative go through each row without a jump: differences across it, against what the third
 * derivative makes of them. */
static void test_smooth(void **state) {
  Curve *c = *state;
  place(c, 9, 0, 3, exp);
  fit(c, 9);
  for (int i = 1; i < 8; i++) {
    long double x = c->row[i][0], h = 1e-4L, f[5];
    for (int k = 0; k < 5; k++) f[k] = spline_at(&c->s, 0, x + (k - 2) * h);
    assert_near((f[4] - 2 * f[3] + f[2]) / (h * h) - (f[2] - 2 * f[1] + f[0]) / (h * h), 0, 0.01);
    assert_near((f[3] - f[2]) / h - (f[2] - f[1]) / h, 0, 0.01);
    assert_near((f[3] - 2 * f[2] + f[1]) / (h * h), c->row[i][2], 0.01);
  }
}

static void test_outside(void **state) {
  Curve *c = *state;
  place(c, 7, -1, 2, cubic);
  fit(c, 7);
  assert_near(spline_at(&c->s, 0, -1e9), cubic(-1), 0);
  assert_near(spline_at(&c->s, 0, 2.0001), cubic(2), 0);
}

static void test_too_close(void **state) {
  Curve *c = *state;
  for (int i = 0; i < 4; i++) c->row[i][0] = i * 1e-9, c->row[i][1] = i % 2 ? 1e308 : -1e308;
  assert_false(spline_fit(c->arena, c->row, 4));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_polynomials), cmocka_unit_test(test_other_program), cmocka_unit_test(test_order),
    cmocka_unit_test(test_smooth),      cmocka_unit_test(test_outside),       cmocka_unit_test(test_too_close),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
