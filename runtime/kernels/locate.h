/* locate.h: the first time in a step at which functions change their signs. Includes <math.h> only.
 *
 * Enters: n functions g(t) of a step [a, b] (a > b allowed), by a callback; their signs just after a.
 * Leaves: the first change of sign that counts, of each function that has one there; signs behind it.
 *
 * A part of the step is resolved when the polynomial of degree 8 through nine values of g has no zero
 * there, or is monotonic; else it is halved: crossings are found one by one, however short the time
 * between them. Chebyshev coefficients bound the error of the polynomial: J.P. Boyd, Chebyshev and
 * Fourier Spectral Methods, 2nd ed. (2001), ch. 2.12; subdivision: J.P. Boyd, J. Eng. Math. 56 (2006)
 * 203, DOI 10.1007/s10665-006-9087-5.
 *
 * lagc copies the sections below into headers, with their prefix for LAG_ and lag_. LAG_REAL is a
 * scalar. The caller's memory alone; nothing is kept between calls. */
#ifndef LAG_LOCATE_H
#define LAG_LOCATE_H

#include "kernels/scalar.h"

/* ---- root ---- */

static inline LAG_REAL lag_modulus(LAG_REAL x) { return LAG_FN(fabs)(x); }
static inline LAG_REAL lag_larger_modulus(LAG_REAL a, LAG_REAL b) {
  return lag_modulus(a) < lag_modulus(b) ? lag_modulus(b) : lag_modulus(a);
}

/* The root of f in [a, b] (a > b allowed), where f(a) and f(b) differ in sign: the end of the last
 * bracket on b's side, so the sign has changed there. epsilon: rounding of LAG_REAL. At most one
 * evaluation more than bisection is spent: ITP method, with exponent 2, the authors' defaults,
 * I.F.D. Oliveira, R.H.C. Takahashi, ACM Trans. Math. Softw. 47 (2020) 5, DOI 10.1145/3423597. */
static inline LAG_REAL lag_root(LAG_REAL (*f)(void *context, LAG_REAL x), void *context, LAG_REAL a, LAG_REAL fa,
                                LAG_REAL b, LAG_REAL fb, LAG_REAL epsilon) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), two = LAG_C(2.0), width = lag_modulus(b - a);
  const LAG_REAL eps = two*epsilon*lag_larger_modulus(a, b), k1 = LAG_C(0.2)/width;
  LAG_REAL reach = eps; /* half the width that bisection would leave, twice: one evaluation more */
  int most = 61;
  if (!(fa < zero) && !(fa > zero)) return a;
  for (; eps > zero && reach < width; reach *= two) most++;
  for (; most >= 0 && lag_modulus(b - a) > eps; most--, reach /= two) {
    const LAG_REAL half = a + (b - a)/two, r = reach - lag_modulus(b - a)/two, x_f = (fb*a - fa*b)/(fb - fa);
    const LAG_REAL sigma = LAG_SELECT(half > x_f, one, -one), delta = k1*(b - a)*(b - a);
    const LAG_REAL x_t = LAG_SELECT(delta <= lag_modulus(half - x_f), x_f + sigma*delta, half);
    const int near = r > zero && lag_modulus(x_t - half) <= r;
    LAG_REAL x = LAG_SELECT(near, x_t, half - sigma*LAG_SELECT(r > zero, r, zero));
    if (!((x > a && x < b) || (x > b && x < a))) x = half;
    if (!((x > a && x < b) || (x > b && x < a))) break;
    const LAG_REAL fx = f(context, x);
    if (!(fx < zero) && !(fx > zero)) return x;
    if ((fx > zero) == (fb > zero)) b = x, fb = fx;
    else a = x, fa = fx;
  }
  return b;
}

/* ---- locate ---- */

enum {
  LAG_DEGREE = 8,
  LAG_LOCATE_ROWS = LAG_DEGREE + 3,
  LAG_LOCATE_UNSEEN = -2, /* falling, also from a positive value between samples, as a gap that closes */
  LAG_LOCATE_ROUGH = 12,  /* halvings where g is not resolved: 4096 parts a step, of nine values each */
  LAG_LOCATE_FINEST = 30  /* halvings where g is resolved, and touches zero */
};

typedef struct lag_locator {
  int n;
  /* g[n] at time t; shaken: with t and the state changed in their last digits. Not 0: the search ends. */
  int (*sample)(void *context, int shaken, LAG_REAL t, LAG_REAL *g);
  int (*direction)(void *context, int k); /* that counts: 1 rising, -1 falling, 0 both, LAG_LOCATE_UNSEEN */
  void *context;
  LAG_REAL epsilon;      /* rounding of LAG_REAL */
  LAG_REAL nearest;      /* part of the step, 256^-n, at which functions of unknown sign are looked at first */
  LAG_REAL *sign;        /* [n] just after a, 0: not known while |g| <= noise; leaves: behind the part searched */
  const LAG_REAL *noise; /* [n] */
  LAG_REAL *root;        /* [n] changes only where a function has a crossing: its time */
  LAG_REAL *value;       /* [LAG_LOCATE_ROWS*n] row 0: g(a); leaves: g at the end of the part searched */
} lag_locator;

static inline LAG_REAL lag_locate_sign(LAG_REAL g) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  return LAG_SELECT(g > zero, one, LAG_SELECT(g < zero, -one, zero));
}

/* cos(pi m/8). */
static inline LAG_REAL lag_locate_cosine(int m) {
  static const LAG_REAL quarter[] = {LAG_C(1.0), LAG_C(0.923879532511286756128183189396788287),
                                     LAG_C(0.707106781186547524400844362104849039),
                                     LAG_C(0.382683432365089771728459984030398866), LAG_C(0.0)};
  m %= 2*LAG_DEGREE;
  m = m > LAG_DEGREE ? 2*LAG_DEGREE - m : m;
  if (2*m > LAG_DEGREE) return -quarter[LAG_DEGREE - m];
  return quarter[m];
}

/* --- one crossing --- */

typedef struct lag_crossing {
  const lag_locator *of;
  int k, status;
  LAG_REAL lift; /* shift of g */
} lag_crossing;

static inline LAG_REAL lag_crossing_value(void *context, LAG_REAL t) {
  lag_crossing *const c = (lag_crossing *)context;
  LAG_REAL *const g = c->of->value + (LAG_LOCATE_ROWS - 1)*c->of->n;
  const int status = c->of->sample(c->of->context, 0, t, g);
  c->status = status ? status : c->status;
  return g[c->k] + c->lift;
}

/* root[k] := the zero of g + lift between times t[2] of values g[2]; the end of a step may be one. A
 * change of sign at a pole is none: there g exceeds both samples beyond measure. */
static inline int lag_find_crossing(const lag_locator *l, int k, LAG_REAL lift, const LAG_REAL *t,
                                    const LAG_REAL *const *g, int *found) {
  const LAG_REAL zero = LAG_C(0.0), pole = LAG_C(100.0), ga = g[0][k] + lift, gb = g[1][k] + lift;
  lag_crossing c = {l, k, 0, lift};
  LAG_REAL x = ga < zero ? t[1] : t[0];
  if (ga > zero || gb > zero) x = lag_root(lag_crossing_value, &c, t[0], ga, t[1], gb, l->epsilon);
  if (l->direction(l->context, k) != LAG_LOCATE_UNSEEN && c.status == 0)
    if (lag_modulus(lag_crossing_value(&c, x)) > pole*lag_larger_modulus(ga, gb)) return c.status;
  l->root[k] = x;
  *found = 1;
  return c.status;
}

/* Successive values g[2] at times t[2]: updates sign, and root of functions that cross between them. */
static inline int lag_find_crossings(const lag_locator *l, const LAG_REAL *t, const LAG_REAL *const *g, int *found) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  int status = 0;
  for (int k = 0; k < l->n && status == 0; k++) {
    const LAG_REAL now = lag_locate_sign(g[1][k]), was = l->sign[k];
    const int direction = l->direction(l->context, k);
    if (now*was < zero) {
      l->sign[k] = now;
      if (now > zero ? direction >= 0 : direction <= 0) status = lag_find_crossing(l, k, zero, t, g, found);
    } else if (was*was < one) {
      l->sign[k] = lag_modulus(g[1][k]) > l->noise[k] ? now : zero;
      if (l->sign[k] < zero && direction == LAG_LOCATE_UNSEEN)
        status = lag_find_crossing(l, k, l->noise[k], t, g, found);
    }
  }
  return status;
}

/* --- parts of the step --- */

/* Time of sample j of the nine in a part of the step: at the Chebyshev extrema, with both ends. */
static inline LAG_REAL lag_locate_time(LAG_REAL ta, LAG_REAL tb, int j) {
  const LAG_REAL half = LAG_C(0.5);
  if (j == 0 || j == LAG_DEGREE) return j ? tb : ta;
  return ta + (tb - ta)*(half - half*lag_locate_cosine(j));
}

/* rounding[n] := that of the functions at t: their change with the last digits of the state. */
static inline int lag_locate_rounding(const lag_locator *l, LAG_REAL t, LAG_REAL *rounding) {
  const LAG_REAL four = LAG_C(4.0);
  LAG_REAL *const g = l->value + (LAG_LOCATE_ROWS - 1)*l->n;
  int status = l->sample(l->context, 0, t, rounding);
  if (status == 0) status = l->sample(l->context, 1, t, g);
  for (int k = 0; k < l->n && status == 0; k++)
    rounding[k] = four*(lag_modulus(g[k] - rounding[k]) + four*l->epsilon*lag_modulus(rounding[k]));
  return status;
}

/* Chebyshev coefficients of the polynomial through nine values, mirrored in time, which matters nowhere. */
static inline void lag_locate_coefficients(const LAG_REAL *value, int stride, LAG_REAL *c) {
  LAG_REAL even[LAG_DEGREE/2 + 1], odd[LAG_DEGREE/2];
  for (int j = 0; j < LAG_DEGREE/2; j++) {
    const LAG_REAL part = j ? LAG_C(1.0) : LAG_C(0.5);
    const LAG_REAL a = value[j*stride]*part, b = value[(LAG_DEGREE - j)*stride]*part;
    even[j] = a + b;
    odd[j] = a - b;
  }
  even[LAG_DEGREE/2] = value[LAG_DEGREE/2*stride];
  for (int k = 0; k <= LAG_DEGREE; k++) {
    LAG_REAL sum = LAG_SELECT(k % 2, LAG_C(0.0), even[LAG_DEGREE/2]*lag_locate_cosine(k*LAG_DEGREE/2));
    for (int j = 0; j < LAG_DEGREE/2; j++) sum += (k % 2 ? odd[j] : even[j])*lag_locate_cosine(j*k);
    c[k] = sum*(k % LAG_DEGREE ? LAG_C(0.25) : LAG_C(0.125));
  }
}

/* Whether the derivative of the polynomial has one sign throughout. */
static inline int lag_is_monotonic(const LAG_REAL *c, LAG_REAL error) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0);
  LAG_REAL d[LAG_DEGREE + 2], others = zero;
  d[LAG_DEGREE + 1] = d[LAG_DEGREE] = zero;
  for (int k = LAG_DEGREE; k >= 1; k--) d[k - 1] = (k < LAG_DEGREE ? d[k + 1] : zero) + two*(LAG_REAL)k*c[k];
  for (int k = 1; k < LAG_DEGREE; k++) others += lag_modulus(d[k]);
  return lag_modulus(d[0]/two) > others + two*(LAG_REAL)LAG_DEGREE*error;
}

/* Halvings allowed to resolve one function in a part; 0: it is resolved. */
static inline int lag_locate_halvings(const LAG_REAL *value, int stride, LAG_REAL rounding) {
  const LAG_REAL rough = LAG_C(1e-3); /* of the range of g, in the last three coefficients */
  LAG_REAL c[LAG_DEGREE + 1], range = LAG_C(0.0);
  lag_locate_coefficients(value, stride, c);
  for (int k = 1; k <= LAG_DEGREE; k++) range += lag_modulus(c[k]);
  const LAG_REAL error = lag_modulus(c[LAG_DEGREE - 2]) + lag_modulus(c[LAG_DEGREE - 1]) + lag_modulus(c[LAG_DEGREE]);
  if (range <= rounding) return 0;
  if (error > rough*range && error > rounding) return lag_modulus(c[0]) > LAG_C(4.0)*range ? 0 : LAG_LOCATE_ROUGH;
  return lag_modulus(c[0]) > range + error || lag_is_monotonic(c, error) ? 0 : LAG_LOCATE_FINEST;
}

/* Samples 1 to 8 of a part; *most := halvings allowed. *known: rounding is known. */
static inline int lag_sample_part(const lag_locator *l, LAG_REAL ta, LAG_REAL tb, int *known, int *most) {
  LAG_REAL *const rounding = l->value + (LAG_DEGREE + 1)*l->n;
  int status = 0;
  for (int j = 1; j <= LAG_DEGREE && status == 0; j++)
    status = l->sample(l->context, 0, lag_locate_time(ta, tb, j), l->value + j*l->n);
  for (int turn = *known; turn < 2 && status == 0; turn++) {
    *most = 0;
    for (int k = 0; k < l->n; k++) {
      const LAG_REAL own = turn ? rounding[k] : LAG_C(0.0);
      const int of_k = lag_locate_halvings(l->value + k, l->n, lag_larger_modulus(own, l->noise[k]));
      *most = of_k > *most ? of_k : *most;
    }
    if (*most == 0 || turn) break;
    status = lag_locate_rounding(l, lag_locate_time(ta, tb, LAG_DEGREE/2), rounding);
    *known = 1;
  }
  return status;
}

/* Walks the samples of a resolved part until a crossing is found. Row 0 becomes the sample behind it. */
static inline int lag_scan_samples(const lag_locator *l, LAG_REAL ta, LAG_REAL tb, int *found) {
  int status = 0, j = 0;
  while (j < LAG_DEGREE && status == 0 && !*found) {
    const LAG_REAL t[] = {lag_locate_time(ta, tb, j), lag_locate_time(ta, tb, j + 1)};
    const LAG_REAL *const g[] = {l->value + j*l->n, l->value + (j + 1)*l->n};
    status = lag_find_crossings(l, t, g, found);
    j++;
  }
  for (int k = 0; k < l->n; k++) l->value[k] = l->value[j*l->n + k];
  return status;
}

/* The first crossing in [a, b]; row 0 is the sample at a. Part i of 2^level equal parts follows part
 * i - 1, or is half of an unresolved one. */
static inline int lag_search(const lag_locator *l, LAG_REAL a, LAG_REAL b, int *found) {
  LAG_REAL part = LAG_C(1.0); /* 2^-level */
  int level = 0, known = 0, status = 0;
  long i = 0;
  while (status == 0 && !*found && !(level == 0 && i == 1)) {
    const LAG_REAL ta = a + (b - a)*((LAG_REAL)i*part), end = a + (b - a)*((LAG_REAL)(i + 1)*part);
    const LAG_REAL tb = i + 1 == 1L << level ? b : end;
    const int long_enough = lag_modulus(tb - ta) > LAG_C(64.0)*l->epsilon*lag_larger_modulus(ta, tb);
    int most = 0;
    status = lag_sample_part(l, ta, tb, &known, &most);
    if (status == 0 && level < most && long_enough) {
      level++, part /= LAG_C(2.0), i *= 2;
      continue;
    }
    if (status == 0) status = lag_scan_samples(l, ta, tb, found);
    for (i++; level > 0 && i % 2 == 0; i /= 2) level--, part *= LAG_C(2.0);
  }
  return status;
}

/* *to := end of the part of [a, b] to search first, as after an event g may leave zero and return soon:
 * of the parts `nearest`, ..., 2^-16, 2^-8 the first at whose end a function of unknown sign is back on
 * its other side, else b. */
static inline int lag_first_part(const lag_locator *l, LAG_REAL a, LAG_REAL b, LAG_REAL *to) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  LAG_REAL *const left = l->value + l->n, *const g = left + l->n;
  int status = 0, back = 0;
  for (int k = 0; k < l->n; k++) left[k] = zero;
  for (LAG_REAL part = l->nearest; part < one && status == 0 && !back; part *= LAG_C(256.0)) {
    *to = a + (b - a)*part;
    status = l->sample(l->context, 0, *to, g);
    for (int k = 0; k < l->n && status == 0; k++) {
      const int unknown = l->sign[k]*l->sign[k] < one && lag_modulus(g[k]) > l->noise[k];
      const LAG_REAL now = unknown ? lag_locate_sign(g[k]) : zero;
      back |= now*left[k] < zero;
      left[k] = left[k]*left[k] > zero ? left[k] : now;
    }
  }
  *to = back ? *to : b;
  return status;
}

/* The first crossing in the step [a, b]; *found: there is one. */
static inline int lag_locate(const lag_locator *l, LAG_REAL a, LAG_REAL b, int *found) {
  LAG_REAL to = b;
  int unknown = 0, status = 0;
  *found = 0;
  for (int k = 0; k < l->n; k++) unknown |= l->sign[k]*l->sign[k] < LAG_C(1.0);
  if (unknown) status = lag_first_part(l, a, b, &to);
  if (status == 0) status = lag_search(l, a, to, found);
  if (status == 0 && !*found && (to < b || to > b)) status = lag_search(l, to, b, found);
  return status;
}

/* ---- series ---- */

/* Times of one event: the last interval, the first of those that become shorter, and how many of them in turn. */
typedef struct lag_series {
  LAG_REAL interval, flight, shorter;
} lag_series;

/* Time in which the event will fire for ever, dt after it fired last: the rest of the geometric series of its
 * intervals; HUGE_VAL: they do not become shorter. Others may fire between. rounding: of the time. */
static inline LAG_REAL lag_series_rest(lag_series *s, LAG_REAL dt, LAG_REAL rounding) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), before = s->interval;
  s->interval = dt;
  if (!(dt <= s->flight)) { /* the next interval begins a series */
    s->flight = (LAG_REAL)HUGE_VAL, s->shorter = zero;
    return s->flight;
  }
  if (!(s->flight < (LAG_REAL)HUGE_VAL)) s->flight = dt;
  s->shorter = dt < before + rounding ? s->shorter + one : zero;
  LAG_REAL ratio = s->shorter > zero ? LAG_FN(pow)(dt/s->flight, one/s->shorter) : one;
  if (dt/before > ratio && rounding < (one - ratio)*dt) ratio = dt/before;
  return ratio < one ? dt*ratio/(one - ratio) : (LAG_REAL)HUGE_VAL;
}

/* Whether `few` intervals in turn became shorter, and the rest of the series is next to nothing, in units of its first
 * interval, or time does not resolve it. */
static inline int lag_series_ends(const lag_series *s, LAG_REAL rest, LAG_REAL part, int few, LAG_REAL rounding) {
  return s->shorter >= (LAG_REAL)few && (rest <= part*s->flight || s->interval <= LAG_C(16.0)*rounding);
}

/* ---- end ---- */
#endif
