/* Jet: truncated Taylor series of a number along a motion, and its change under two virtual displacements.
 *
 *   x(s, e1, e2) = sum over k < JET_ORDERS of (c[0][k] + e1 c[1][k] + e2 c[2][k]) s^k,   e1^2 = e2^2 = e1 e2 = 0
 *
 * s is the time since the state, e1 and e2 are the sizes of the displacements. Each coefficient carries a bound on
 * its own rounding error, to first order (running error analysis: N.J. Higham, Accuracy and Stability of Numerical
 * Algorithms, 2002, section 3.3, doi:10.1137/1.9780898718027). Taylor arithmetic: A. Griewank and A. Walther,
 * Evaluating Derivatives, 2008, chapter 13, doi:10.1137/1.9780898717761. Nothing here knows the expression graph. */
#pragma once

typedef long double JetReal;

enum { JET_ORDERS = 3, JET_PLANES = 3 };

/* Value and bound on its rounding error. */
typedef struct {
  JetReal v, e;
} Bounded;

typedef struct {
  Bounded c[JET_PLANES][JET_ORDERS];
  /* 0: constant; 1: varies along the motion only; JET_PLANES: displacements, too. All other coefficients are 0 */
  int planes;
} Jet;

/* Unit roundoff of JetReal. */
extern const JetReal jet_unit;

/* Constants: exact, or with the error of one rounding. */
Jet jet_exact(JetReal v);
Jet jet_rounded(JetReal v);

void jet_add(Jet *out, const Jet *x, const Jet *y); /* out may be x or y, here and below */
void jet_sub(Jet *out, const Jet *x, const Jet *y);
void jet_neg(Jet *out, const Jet *x);
void jet_mul(Jet *out, const Jet *x, const Jet *y);
void jet_div(Jet *out, const Jet *x, const Jet *y);

/* Time derivative along the motion; its highest order is unknown and set to 0. */
void jet_rate(Jet *out, const Jet *x);

/* x^exponent. is_third: a multiple of 1/3, a real root for negative x; other fractional powers of negative x are
 * NaN. */
void jet_power(Jet *out, const Jet *x, JetReal exponent, int is_third);

/* A function of the C library by its name: sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, log, fabs. 0:
 * unknown. */
int jet_function(Jet *out, const char *name, const Jet *x);
void jet_atan2(Jet *out, const Jet *y, const Jet *x);
void jet_hypot(Jet *out, const Jet *x, const Jet *y);
void jet_pow(Jet *out, const Jet *x, const Jet *y); /* a varying exponent: x > 0 */

/* x op y with propagated error bounds. */
Bounded bounded_add(Bounded x, Bounded y);
Bounded bounded_sub(Bounded x, Bounded y);
Bounded bounded_mul(Bounded x, Bounded y);
