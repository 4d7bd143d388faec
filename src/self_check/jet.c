/* Arithmetic and elementary functions of jets, each with a first-order bound on rounding. Functions f(x(s, e1, e2))
 * are composed from the derivatives f .. f'''' at the state (Faa di Bruno, truncated). Contract and sources: jet.h.
 * */
#include "self_check/jet.h"

#include <float.h>
#include <math.h>
#include <string.h>

const JetReal jet_unit = LDBL_EPSILON / 2;

/* --- values with their error --- */

static Bounded with_rounding(JetReal v, JetReal e) { return (Bounded){v, e + jet_unit * fabsl(v)}; }

Bounded bounded_add(Bounded x, Bounded y) { return with_rounding(x.v + y.v, x.e + y.e); }
Bounded bounded_sub(Bounded x, Bounded y) { return with_rounding(x.v - y.v, x.e + y.e); }
Bounded bounded_mul(Bounded x, Bounded y) {
  return with_rounding(x.v * y.v, fabsl(x.v) * y.e + x.e * fabsl(y.v) + x.e * y.e);
}

static Bounded bounded_div(Bounded x, Bounded y) {
  JetReal q = x.v / y.v;
  return with_rounding(q, (x.e + fabsl(q) * y.e) / fabsl(y.v));
}

static int is_zero(Bounded x) { return x.v == 0 && x.e == 0; }

/* sum += x y, skipping products of an exact 0 and a finite value, which are most. */
static void accumulate(Bounded *sum, Bounded x, Bounded y) {
  if ((is_zero(x) && isfinite(y.v)) || (is_zero(y) && isfinite(x.v))) return;
  *sum = bounded_add(*sum, bounded_mul(x, y));
}

/* --- arithmetic --- */

Jet jet_exact(JetReal v) { return (Jet){.c[0][0] = {v, 0}}; }
Jet jet_rounded(JetReal v) { return (Jet){.c[0][0] = {v, jet_unit * fabsl(v)}}; }

static int most_planes(const Jet *x, const Jet *y) { return x->planes > y->planes ? x->planes : y->planes; }

/* out = x + sign y, sign 1 or -1. */
static void add_signed(Jet *out, const Jet *x, const Jet *y, int sign) {
  Jet r = {.planes = most_planes(x, y)};
  for (int p = 0; p == 0 || p < r.planes; p++)
    for (int k = 0; k < JET_ORDERS; k++)
      r.c[p][k] = with_rounding(x->c[p][k].v + sign * y->c[p][k].v, x->c[p][k].e + y->c[p][k].e);
  *out = r;
}

void jet_add(Jet *out, const Jet *x, const Jet *y) { add_signed(out, x, y, 1); }
void jet_sub(Jet *out, const Jet *x, const Jet *y) { add_signed(out, x, y, -1); }

void jet_neg(Jet *out, const Jet *x) {
  Jet zero = jet_exact(0);
  add_signed(out, &zero, x, -1);
}

/* out += x y, truncated product of series in s. */
static void add_product(Bounded out[JET_ORDERS], const Bounded x[JET_ORDERS], const Bounded y[JET_ORDERS]) {
  for (int k = 0; k < JET_ORDERS; k++)
    for (int j = 0; j <= k; j++) accumulate(&out[k], x[j], y[k - j]);
}

static void scale(Jet *out, const Jet *x, Bounded by) {
  Jet r = {.planes = x->planes};
  if (!r.planes) r.c[0][0] = bounded_mul(x->c[0][0], by);
  for (int p = 0; p < r.planes; p++)
    for (int k = 0; k < JET_ORDERS; k++) accumulate(&r.c[p][k], x->c[p][k], by);
  *out = r;
}

void jet_mul(Jet *out, const Jet *x, const Jet *y) {
  if (!y->planes) {
    scale(out, x, y->c[0][0]);
  } else if (!x->planes) {
    scale(out, y, x->c[0][0]);
  } else {
    Jet r = {.planes = most_planes(x, y)};
    add_product(r.c[0], x->c[0], y->c[0]);
    for (int p = 1; p < r.planes; p++) {
      add_product(r.c[p], x->c[0], y->c[p]);
      add_product(r.c[p], x->c[p], y->c[0]);
    }
    *out = r;
  }
}

void jet_rate(Jet *out, const Jet *x) {
  Jet r = {.planes = x->planes};
  for (int p = 0; p < r.planes; p++)
    for (int k = 0; k + 1 < JET_ORDERS; k++) r.c[p][k] = bounded_mul((Bounded){k + 1, 0}, x->c[p][k + 1]);
  *out = r;
}

/* --- composition with functions, from their derivatives at the state --- */

enum { ROUNDINGS = 8 };
/* orders 0 .. JET_ORDERS + 1 of a function: the last bounds the error of the one before */
enum { DERIVATIVES = JET_ORDERS + 2 };

/* Derivative k of f with its error: the error of x propagated to second order (for x^2 at 0), plus ROUNDINGS. lost:
 * absolute error of f', f'', ... from cancellation where they are computed from f, as 1 - tanh^2 is. */
static Bounded derivative(const JetReal d[DERIVATIVES], int k, JetReal error, JetReal lost) {
  JetReal second = k + 2 < DERIVATIVES && error > 0 ? fabsl(d[k + 2]) * error * error / 2 : 0;
  return (Bounded){d[k], fabsl(d[k + 1]) * error + second + ROUNDINGS * jet_unit * fabsl(d[k]) + (k > 0 ? lost : 0)};
}

/* Taylor coefficients of g(x(s)), where g is derivative `first` of f. */
static void compose(Bounded out[JET_ORDERS], const JetReal d[DERIVATIVES], int first, const Bounded x[JET_ORDERS],
                    JetReal lost) {
  Bounded d1 = derivative(d, first + 1, x[0].e, lost);
  out[0] = derivative(d, first, x[0].e, lost);
  out[1] = bounded_mul(d1, x[1]);
  out[2] = bounded_mul(d1, x[2]);
  Bounded half = bounded_mul(derivative(d, first + 2, x[0].e, lost), (Bounded){0.5L, 0});
  accumulate(&out[2], half, bounded_mul(x[1], x[1]));
}

static void compose_jet(Jet *out, const Jet *x, const JetReal d[DERIVATIVES], JetReal lost) {
  Jet r = {.planes = x->planes};
  r.c[0][0] = derivative(d, 0, x->c[0][0].e, lost);
  if (r.planes && !isfinite(d[1])) r.c[0][0].e = NAN; /* no derivative here: no comparison */
  if (r.planes) compose(r.c[0], d, 0, x->c[0], lost);
  if (r.planes > 1) {
    Bounded slope[JET_ORDERS];
    compose(slope, d, 1, x->c[0], lost);
    for (int p = 1; p < r.planes; p++) add_product(r.c[p], slope, x->c[p]);
  }
  *out = r;
}

/* --- derivatives of elementary functions --- */

static void sine_derivatives(JetReal d[DERIVATIVES], JetReal f, JetReal df) {
  JetReal cycle[DERIVATIVES] = {f, df, -f, -df, f};
  memcpy(d, cycle, sizeof cycle);
}

/* tan (sign 1) and tanh (sign -1): f' = 1 + sign f^2 = slope, which the caller computes without cancellation. */
static void tangent_derivatives(JetReal d[DERIVATIVES], JetReal f, JetReal slope, int sign) {
  JetReal cycle[DERIVATIVES] = {f, slope, 2 * sign * f * slope, slope * (2 * sign + 6 * f * f),
                                slope * f * (16 + 24 * sign * f * f)};
  memcpy(d, cycle, sizeof cycle);
}

/* Derivatives of x^n at x, from its value f. */
static void power_derivatives(JetReal d[DERIVATIVES], JetReal f, JetReal x, JetReal n) {
  d[0] = f;
  for (int k = 1; k < DERIVATIVES; k++) d[k] = n - (k - 1) == 0 ? 0 : d[k - 1] * (n - (k - 1)) / x;
}

static void arc_sine(JetReal d[DERIVATIVES], JetReal x, JetReal value, int sign) {
  JetReal r = 1 / sqrtl((1 - x) * (1 + x)), r3 = r * r * r, r5 = r3 * r * r;
  JetReal cycle[DERIVATIVES] = {value, sign * r, sign * x * r3, sign * (1 + 2 * x * x) * r5,
                                sign * (9 * x + 6 * x * x * x) * r5 * r * r};
  memcpy(d, cycle, sizeof cycle);
}

static void arc_tangent(JetReal d[DERIVATIVES], JetReal x) {
  JetReal r = 1 / (1 + x * x);
  JetReal cycle[DERIVATIVES] = {atanl(x), r, -2 * x * r * r, (6 * x * x - 2) * r * r * r,
                                24 * x * (1 - x * x) * r * r * r * r};
  memcpy(d, cycle, sizeof cycle);
}

static void logarithm(JetReal d[DERIVATIVES], JetReal x) {
  JetReal cycle[DERIVATIVES] = {logl(x), 1 / x, -1 / (x * x), 2 / (x * x * x), -6 / (x * x * x * x)};
  memcpy(d, cycle, sizeof cycle);
}

static void absolute(JetReal d[DERIVATIVES], JetReal x) {
  JetReal cycle[DERIVATIVES] = {fabsl(x), x < 0 ? -1 : 1};
  memcpy(d, cycle, sizeof cycle);
}

int jet_function(Jet *out, const char *name, const Jet *of) {
  JetReal x = of->c[0][0].v, d[DERIVATIVES] = {0}, inverse_cosh = 1 / coshl(x), inverse_cos = 1 / cosl(x);
  if (strcmp(name, "sin") == 0) sine_derivatives(d, sinl(x), cosl(x));
  else if (strcmp(name, "cos") == 0) sine_derivatives(d, cosl(x), -sinl(x));
  else if (strcmp(name, "tan") == 0) tangent_derivatives(d, tanl(x), inverse_cos * inverse_cos, 1);
  else if (strcmp(name, "tanh") == 0) tangent_derivatives(d, tanhl(x), inverse_cosh * inverse_cosh, -1);
  else if (strcmp(name, "asin") == 0) arc_sine(d, x, asinl(x), 1);
  else if (strcmp(name, "acos") == 0) arc_sine(d, x, acosl(x), -1);
  else if (strcmp(name, "atan") == 0) arc_tangent(d, x);
  else if (strcmp(name, "fabs") == 0) absolute(d, x);
  else if (strcmp(name, "sinh") == 0) for (int k = 0; k < DERIVATIVES; k++) d[k] = k % 2 ? coshl(x) : sinhl(x);
  else if (strcmp(name, "cosh") == 0) for (int k = 0; k < DERIVATIVES; k++) d[k] = k % 2 ? sinhl(x) : coshl(x);
  else if (strcmp(name, "exp") == 0) for (int k = 0; k < DERIVATIVES; k++) d[k] = expl(x);
  else if (strcmp(name, "log") == 0) logarithm(d, x);
  else return 0;
  compose_jet(out, of, d, strcmp(name, "tanh") == 0 ? ROUNDINGS * jet_unit : 0);
  return 1;
}

/* x^n; integer exponents up to 6 by multiplication, with at most 7 roundings. */
static JetReal power(JetReal x, JetReal n, int is_third) {
  JetReal product = 1;
  if (is_third) return powl(cbrtl(x), roundl(3 * n));
  if (n != floorl(n)) return x < 0 ? (JetReal)NAN : powl(x, n);
  if (fabsl(n) > 6) return powl(x, n);
  for (int k = (int)fabsl(n); k > 0; k--) product *= x;
  return n < 0 ? 1 / product : product;
}

void jet_power(Jet *out, const Jet *of, JetReal n, int is_third) {
  if (n == 2) {
    jet_mul(out, of, of);
    return;
  }
  JetReal x = of->c[0][0].v, d[DERIVATIVES] = {0};
  int whole = n == floorl(n);
  if (x == 0 && whole && n >= 0) { /* a polynomial at 0: only derivative n is not 0 */
    for (int k = 0; k < DERIVATIVES; k++) d[k] = n == k ? tgammal(n + 1) : 0;
  } else {
    power_derivatives(d, power(x, n, is_third), x, n);
  }
  compose_jet(out, of, d, 0);
}

void jet_div(Jet *out, const Jet *x, const Jet *y) {
  Jet inverse;
  if (!x->planes && !y->planes) {
    *out = (Jet){.c[0][0] = bounded_div(x->c[0][0], y->c[0][0])};
    return;
  }
  jet_power(&inverse, y, -1, 0);
  jet_mul(out, x, &inverse);
}

/* atan2(y0, x0) plus the angle from (x0, y0) to (x, y), which is 0 at the state, by atan. */
void jet_atan2(Jet *out, const Jet *y, const Jet *x) {
  Jet across, along, a, b, turned;
  Bounded y0 = y->c[0][0], x0 = x->c[0][0];
  JetReal square = x0.v * x0.v + y0.v * y0.v;
  Jet fixed_x = jet_exact(x0.v), fixed_y = jet_exact(y0.v);
  jet_mul(&a, y, &fixed_x);
  jet_mul(&b, x, &fixed_y);
  jet_sub(&across, &a, &b);
  jet_mul(&a, x, &fixed_x);
  jet_mul(&b, y, &fixed_y);
  jet_add(&along, &a, &b);
  jet_div(&turned, &across, &along);
  turned.c[0][0] = (Bounded){0, (fabsl(x0.v) * y0.e + fabsl(y0.v) * x0.e) / square};
  jet_function(out, "atan", &turned);
  out->c[0][0].v = atan2l(y0.v, x0.v);
  out->c[0][0].e += 2 * jet_unit * fabsl(out->c[0][0].v);
}

void jet_hypot(Jet *out, const Jet *x, const Jet *y) {
  Jet a, b;
  jet_mul(&a, x, x);
  jet_mul(&b, y, y);
  jet_add(&a, &a, &b);
  jet_power(out, &a, 0.5L, 0);
}

void jet_pow(Jet *out, const Jet *x, const Jet *y) {
  Jet log_x;
  if (!y->planes) {
    JetReal n = y->c[0][0].v;
    Jet value;
    jet_power(&value, x, n, 0);
    JetReal spread = y->c[0][0].e * fabsl(logl(fabsl(x->c[0][0].v))); /* error of the exponent */
    for (int p = 0; spread > 0 && p < JET_PLANES; p++)
      for (int k = 0; k < JET_ORDERS; k++) value.c[p][k].e += spread * fabsl(value.c[p][k].v) * 4;
    *out = value;
    return;
  }
  jet_function(&log_x, "log", x);
  jet_mul(&log_x, &log_x, y);
  jet_function(out, "exp", &log_x);
}
