/* Unit tests of src/self_check/jet.c: Taylor coefficients of functions, and the bounds on their errors, against
 * derivatives by Cauchy's integral over the C library's complex functions: f^(k)(x) = k!/(N r^k) sum of f(x + r w^j)
 * w^(-jk), w = exp(2 pi i/N), which is exact but for rounding and terms r^N (L. Trefethen, J. Weideman, SIAM Review
 * 56, 2014, doi:10.1137/130932132). */
#include <complex.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "self_check/jet.h"

typedef long double complex Complex;

enum { PLACES = 128, DERIVATIVES = 5 };

typedef struct {
  const char *name; /* NULL: x^exponent */
  Complex (*f)(Complex);
  JetReal exponent;
  JetReal x, radius; /* of convergence */
} Case;

static Complex value_at(const Case *c, Complex x) { return c->name ? c->f(x) : cpowl(x, c->exponent); }

static void derivatives_of(const Case *c, JetReal d[DERIVATIVES]) {
  JetReal r = 0.6L * c->radius, factorial = 1;
  for (int k = 0; k < DERIVATIVES; k++) {
    Complex sum = 0;
    for (int j = 0; j < PLACES; j++) {
      JetReal turn = 2 * acosl(-1) * j / PLACES;
      sum += value_at(c, c->x + r * (cosl(turn) + I * sinl(turn))) * (cosl(k * turn) - I * sinl(k * turn));
    }
    d[k] = factorial * creall(sum) / (PLACES * powl(r, k));
    factorial *= k + 1;
  }
}

/* f along x + s + e1, where x is known to `error`. */
static Jet composed(const Case *c, JetReal error) {
  Jet x = {.planes = JET_PLANES}, y;
  x.c[0][0] = (Bounded){c->x, error};
  x.c[0][1].v = x.c[1][0].v = 1;
  if (c->name) assert_true(jet_function(&y, c->name, &x));
  else jet_power(&y, &x, c->exponent, c->exponent == 1 / 3.0L);
  return y;
}

static const Case cases[] = {
    {"sin", csinl, 0, 0.7L, 2},      {"cos", ccosl, 0, -1.3L, 2},
    {"tan", ctanl, 0, 1.2L, 0.37L},  {"tan", ctanl, 0, -0.4L, 1.1L},
    {"tanh", ctanhl, 0, 0.8L, 1.5L}, {"tanh", ctanhl, 0, -2.5L, 1.5L},
    {"asin", casinl, 0, 0.3L, 0.7L}, {"asin", casinl, 0, -0.97L, 0.03L},
    {"acos", cacosl, 0, 0.9L, 0.1L}, {"acos", cacosl, 0, -0.2L, 0.8L},
    {"atan", catanl, 0, 0.6L, 1.1L}, {"atan", catanl, 0, -2, 2},
    {"sinh", csinhl, 0, -1.1L, 2},   {"cosh", ccoshl, 0, 0.9L, 2},
    {"exp", cexpl, 0, 1.4L, 2},      {"log", clogl, 0, 0.2L, 0.2L},
    {"log", clogl, 0, 5, 5},         {NULL, NULL, 0.5L, 2, 2},
    {NULL, NULL, -1, 0.7L, 0.7L},    {NULL, NULL, 5, 1.3L, 1.3L},
    {NULL, NULL, -2.5L, 3, 3},       {NULL, NULL, 1 / 3.0L, 0.4L, 0.4L},
};

/* Coefficients of s^k are f^(k)/k!; of e1 s^k, f^(k+1)/k!. Rounding of the integral: about 1e-19 times (N/k)^k of
 * the largest value. */
static void coefficients_are_derivatives(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    JetReal d[DERIVATIVES];
    derivatives_of(&cases[i], d);
    Jet y = composed(&cases[i], 0);
    for (int p = 0; p < 2; p++)
      for (int k = 0; k < JET_ORDERS; k++) {
        JetReal want = d[k + p] / (k == 2 ? 2 : 1);
        if (!(fabsl(y.c[p][k].v - want) <= 1e-13L * fabsl(want) + 1e-15L))
          fail_msg("%s at %Lg: coefficient %d of plane %d is %.18Lg, not %.18Lg",
                   cases[i].name ? cases[i].name : "a power", cases[i].x, k, p, y.c[p][k].v, want);
      }
  }
}

/* An error of x makes one of f^(k) that is f^(k+1) times it, to first order; the bound is that, and no more than
 * what is of second order. */
static void bounds_are_the_next_derivative(void **state) {
  const JetReal error = 1e-9L;
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    JetReal d[DERIVATIVES];
    derivatives_of(&cases[i], d);
    Jet y = composed(&cases[i], error);
    for (int p = 0; p < 2; p++)
      for (int k = 0; k < JET_ORDERS; k++) {
        JetReal want = fabsl(d[k + p + 1]) * error / (k == 2 ? 2 : 1),
                curved = 1e3L * error * error * (1 + fabsl(d[4]) + fabsl(d[3])),
                rounding = 1e-17L * (1 + fabsl(y.c[p][k].v));
        if (!(y.c[p][k].e >= want * 0.999L) || !(y.c[p][k].e <= want * 1.001L + curved + rounding))
          fail_msg("%s at %Lg: the bound on coefficient %d of plane %d is %Lg, not %Lg",
                   cases[i].name ? cases[i].name : "a power", cases[i].x, k, p, y.c[p][k].e, want);
      }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(coefficients_are_derivatives),
                                     cmocka_unit_test(bounds_are_the_next_derivative)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
