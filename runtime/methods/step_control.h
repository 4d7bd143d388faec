/* Step size control of adaptive methods: the norm of an error estimate, the first step, and a fast power. */
#pragma once

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "lag.h"

typedef struct lag_tolerance {
  double absolute, relative;
} lag_tolerance;

/* Options of adaptive steps, and the largest step that they allow; part of a method's saved state. */
typedef struct lag_step_limits {
  double h_option, h_max, atol;
  double fixed;          /* 1: every step has the size h_option */
  double t_begin, begun; /* start of the first step; 1: it is set */
} lag_step_limits;

/* The first options of an adaptive method, in this order. */
enum { LAG_OPT_STEP, LAG_OPT_MAX, LAG_OPT_ATOL, LAG_OPT_ADAPT, LAG_NADAPTIVE_OPTIONS };
extern const char *const lag_on_off[];
#define LAG_MAX_STEP_OPTION {"max_step", "largest step [s]; 0: a tenth of the scene's span, or the time since the start", 0, 0, HUGE_VAL, NULL}
#define LAG_ATOL_OPTION {"atol", "absolute tolerance [SI]; 0: the same number as the relative one", 0, 0, HUGE_VAL, NULL}

void lag_step_limits_init(lag_step_limits *l, const lag_problem *pb, const double *opt);

/* Before each step: notes the time of the first one. */
static inline void lag_step_limits_begin(lag_step_limits *l, double t) {
  if (l->begun == 0.0) {
    l->begun = 1;
    l->t_begin = t;
  }
}

/* Minimum and maximum of two numbers; b where a is NaN. */
static inline double lag_min(double a, double b) { return a < b ? a : b; }
static inline double lag_max(double a, double b) { return a > b ? a : b; }

/* Largest step: the option, or else the time covered so far; at most `longest` (0: no limit). Without limit where all steps have one size. */
static inline double lag_longest_step(const lag_step_limits *l, double t, double longest) {
  double seen = fabs(t - l->t_begin), most = l->h_max > 0 ? l->h_max : seen > 0 ? seen : HUGE_VAL;
  return l->fixed != 0.0 ? HUGE_VAL : longest > 0 ? lag_min(most, longest) : most;
}

/* x^p for a normal x > 0, with relative error 2e-4 for |p| <= 1/8 and 6e-4 for |p| <= 1, enough for a step size; pow would take a tenth of a short step's time.
 * log2(x) and 2^y are the exponent and a cubic in the fraction, fitted at Chebyshev points: errors 7e-4 binary orders and 8e-5. */
static inline double lag_rough_power(double x, double p) {
#ifdef LAG_REAL_IS_DOUBLE
  const uint64_t root = 0x3fe6a09e667f3bcd; /* the bits of sqrt(1/2): sqrt(1/2) <= 1 + u < sqrt(2) */
  const double whole = 6755399441055744.0;  /* 1.5 2^52: adding and subtracting this number rounds y to an integer */
  uint64_t bits;
  double u, two;

  memcpy(&bits, &x, sizeof bits);
  int64_t e = (int64_t)(bits - root) >> 52;
  bits -= (uint64_t)e << 52;
  memcpy(&u, &bits, sizeof u);
  u -= 1;
  double y = p * ((double)e + ((0.0005394920249608554 + 1.4462983444747144 * u) + u * u * (-0.7595145055376984 + 0.43966727293612035 * u)));
  double k = (y + whole) - whole, f = y - k;
  bits = (uint64_t)(int64_t)(k + 1023) << 52;
  memcpy(&two, &bits, sizeof two);
  return two * ((0.9999244814556045 + 0.6931210339915355 * f) + f * f * (0.24264008283279262 + 0.05592203564734233 * f));
#else
  return pow(x, p);
#endif
}

/* Weighted root mean square of x[n], with weights 1/(absolute + relative |y_i|). */
double lag_error_norm(const lag_problem *pb, const lag_tolerance *tol, const double *x, const double *y);

/* The first step to try from y, where f0 = f(t, y), for a method of this order; at most h_max (0: no limit). y1[n] and
 * f1[n] are scratch. E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), II.4
 * "starting step size": one Euler step measures the second derivative. */
double lag_first_step(lag_problem *pb, const lag_tolerance *tol, int order, double h_max, double t, const double *y,
                      const double *f0, double *y1, double *f1);
