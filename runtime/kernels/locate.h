/* locate.h: the first time in a step at which functions of the motion change their signs. Includes only <math.h>.
 *
 * Enters: n functions g(t) of a step [a, b] (a > b allowed), by a callback; their signs just after a. Leaves: the time of
 * the first change of sign that counts, of each function that has one there; the signs after it.
 * A part of the step is resolved when the polynomial of degree 8 through nine values of g has no zero there, or is monotonic; otherwise it is halved. So
 * crossings are found one by one, however short the time between them. Chebyshev coefficients bound the error of the polynomial: J.P. Boyd, Chebyshev
 * and Fourier Spectral Methods, 2nd ed. (2001), ch. 2.12; the subdivision is J.P. Boyd, J. Eng. Math. 56 (2006) 203, DOI 10.1007/s10665-006-9087-5.
 *
 * The runtime's events are an instance, and measures take its roots. lagc copies the sections below into emitted headers with their prefix for LAG_
 * and lag_. One state: LAG_REAL is a scalar. The caller's memory alone; nothing is kept between calls but what lag_locator points to. */
#ifndef LAG_LOCATE_H
#define LAG_LOCATE_H

#include <math.h>

#ifndef LAG_REAL
#define LAG_REAL double
#endif
#ifndef LAG_FN
#define LAG_FN(f) f
#endif
#ifndef LAG_C
#define LAG_C(x) x
#endif

/* ---- root ---- */
static inline LAG_REAL lag_larger_of(LAG_REAL a, LAG_REAL b) { return a < b ? b : a; }

/* The root of f in [a, b] (a > b allowed), where f(a) and f(b) differ in sign. Returns the end of the last bracket on b's side, so the sign has
 * changed there. At most one evaluation more than bisection is spent. epsilon: rounding of LAG_REAL. ITP method, with exponent 2, the authors' defaults:
 * I.F.D. Oliveira, R.H.C. Takahashi, ACM Trans. Math. Softw. 47 (2020) 5, DOI 10.1145/3423597. */
static inline LAG_REAL lag_root(LAG_REAL (*f)(void *context, LAG_REAL x), void *context, LAG_REAL a, LAG_REAL fa, LAG_REAL b, LAG_REAL fb, LAG_REAL epsilon) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0), width = LAG_FN(fabs)(b - a), eps = two*epsilon*lag_larger_of(LAG_FN(fabs)(a), LAG_FN(fabs)(b)), k1 = LAG_C(0.2)/width;
  LAG_REAL reach = eps; /* half the width that bisection would have left, times the slack of one evaluation */
  int most = 61;
  if (!(fa < zero) && !(fa > zero)) return a;
  for (; eps > zero && reach < width; reach *= two) most++;
  for (; most >= 0 && LAG_FN(fabs)(b - a) > eps; most--, reach /= two) {
    const LAG_REAL half = a + (b - a)/two, r = reach - LAG_FN(fabs)(b - a)/two, x_f = (fb*a - fa*b)/(fb - fa);
    const LAG_REAL sigma = half > x_f ? LAG_C(1.0) : -LAG_C(1.0), delta = k1*(b - a)*(b - a);
    const LAG_REAL x_t = delta <= LAG_FN(fabs)(half - x_f) ? x_f + sigma*delta : half;
    LAG_REAL x = r > zero && LAG_FN(fabs)(x_t - half) <= r ? x_t : half - sigma*(r > zero ? r : zero);
    if (!((x > a && x < b) || (x > b && x < a))) x = half;
    if (!(x < a) && !(x > a)) break;
    if (!(x < b) && !(x > b)) break;
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
  LAG_LOCATE_UNSEEN = -2, /* direction: falling, also from a positive value that no sample has shown, as of a gap that closes */
  LAG_LOCATE_ROUGH = 12,  /* halvings where g is not resolved: 4096 parts a step, of nine values each */
  LAG_LOCATE_FINEST = 30  /* halvings where g is resolved, and touches zero */
};

typedef struct lag_locator {
  int n;
  /* g[n] at time t; shaken: there, with t and the state changed in their last digits. Not 0: the search ends with this status. */
  int (*sample)(void *context, int shaken, LAG_REAL t, LAG_REAL *g);
  int (*direction)(void *context, int k); /* of the changes that count: 1 rising, -1 falling, 0 both, LAG_LOCATE_UNSEEN */
  void *context;
  LAG_REAL epsilon;      /* rounding of LAG_REAL */
  LAG_REAL nearest;      /* part of the step, 256^-n, at which functions whose signs are not known are looked at first */
  LAG_REAL *sign;        /* [n] just after a; 0: not known until |g| is more than noise, [n]. Leaves: after the part that was searched */
  const LAG_REAL *noise;
  LAG_REAL *root;        /* [n] changes only where a function has a crossing: its time */
  LAG_REAL *value;       /* [LAG_LOCATE_ROWS*n] row 0: g(a); leaves: the last values of the part that was searched */
} lag_locator;

static inline LAG_REAL lag_locate_sign(LAG_REAL g) { return g > LAG_C(0.0) ? LAG_C(1.0) : g < LAG_C(0.0) ? -LAG_C(1.0) : LAG_C(0.0); }

/* cos(pi m/8). */
static inline LAG_REAL lag_locate_cosine(int m) {
  static const LAG_REAL quarter[] = {LAG_C(1.0), LAG_C(0.923879532511286756128183189396788287), LAG_C(0.707106781186547524400844362104849039),
                                     LAG_C(0.382683432365089771728459984030398866), LAG_C(0.0)};
  m %= 2*LAG_DEGREE;
  m = m > LAG_DEGREE ? 2*LAG_DEGREE - m : m;
  return 2*m > LAG_DEGREE ? -quarter[LAG_DEGREE - m] : quarter[m];
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

/* root[k] := the zero of g + lift; the end of a step may be one. A change of sign at a pole is none: there g exceeds both samples beyond measure. */
static inline int lag_find_crossing(const lag_locator *l, int k, LAG_REAL lift, const LAG_REAL *t, const LAG_REAL *const *g, int *found) {
  const LAG_REAL zero = LAG_C(0.0), pole = LAG_C(100.0), ga = g[0][k] + lift, gb = g[1][k] + lift;
  lag_crossing c = {l, k, 0, lift};
  const LAG_REAL x = ga > zero || gb > zero ? lag_root(lag_crossing_value, &c, t[0], ga, t[1], gb, l->epsilon) : ga < zero ? t[1] : t[0];
  int is_pole = 0;
  if (l->direction(l->context, k) != LAG_LOCATE_UNSEEN && c.status == 0)
    is_pole = LAG_FN(fabs)(lag_crossing_value(&c, x)) > pole*lag_larger_of(LAG_FN(fabs)(ga), LAG_FN(fabs)(gb));
  if (is_pole) return c.status;
  l->root[k] = x;
  *found = 1;
  return c.status;
}

/* Compares two successive values of g, at times t[0] and t[1]: updates sign, and root of the functions that cross between them. */
static inline int lag_find_crossings(const lag_locator *l, const LAG_REAL *t, const LAG_REAL *const *g, int *found) {
  int status = 0;
  for (int k = 0; k < l->n && status == 0; k++) {
    const LAG_REAL now = lag_locate_sign(g[1][k]), was = l->sign[k];
    const int direction = l->direction(l->context, k), up = now > LAG_C(0.0);
    if (now*was < LAG_C(0.0)) {
      l->sign[k] = now;
      if (up ? direction >= 0 : direction <= 0) status = lag_find_crossing(l, k, LAG_C(0.0), t, g, found);
    } else if (was*was < LAG_C(1.0)) {
      l->sign[k] = LAG_FN(fabs)(g[1][k]) > l->noise[k] ? now : LAG_C(0.0);
      if (l->sign[k] < LAG_C(0.0) && direction == LAG_LOCATE_UNSEEN) status = lag_find_crossing(l, k, l->noise[k], t, g, found);
    }
  }
  return status;
}

/* --- parts of the step --- */

/* Time of sample j of the nine in a part of the step: at the Chebyshev extrema, both ends included. */
static inline LAG_REAL lag_locate_time(LAG_REAL ta, LAG_REAL tb, int j) {
  return j == 0 ? ta : j == LAG_DEGREE ? tb : ta + (tb - ta)*(LAG_C(0.5) - LAG_C(0.5)*lag_locate_cosine(j));
}

/* rounding[n] := that of the functions at t: their change when the state changes in its last digits. */
static inline int lag_locate_rounding(const lag_locator *l, LAG_REAL t, LAG_REAL *rounding) {
  LAG_REAL *const g = l->value + (LAG_LOCATE_ROWS - 1)*l->n;
  int status = l->sample(l->context, 0, t, rounding);
  if (status == 0) status = l->sample(l->context, 1, t, g);
  for (int k = 0; k < l->n && status == 0; k++) rounding[k] = LAG_C(4.0)*(LAG_FN(fabs)(g[k] - rounding[k]) + LAG_C(4.0)*l->epsilon*LAG_FN(fabs)(rounding[k]));
  return status;
}

/* Chebyshev coefficients of the polynomial through nine values (mirrored in time, which matters nowhere). */
static inline void lag_locate_coefficients(const LAG_REAL *value, int stride, LAG_REAL *c) {
  LAG_REAL even[LAG_DEGREE/2 + 1], odd[LAG_DEGREE/2];
  for (int j = 0; j < LAG_DEGREE/2; j++) {
    const LAG_REAL part = j ? LAG_C(1.0) : LAG_C(0.5), a = value[j*stride]*part, b = value[(LAG_DEGREE - j)*stride]*part;
    even[j] = a + b;
    odd[j] = a - b;
  }
  even[LAG_DEGREE/2] = value[LAG_DEGREE/2*stride];
  for (int k = 0; k <= LAG_DEGREE; k++) {
    LAG_REAL sum = k % 2 ? LAG_C(0.0) : even[LAG_DEGREE/2]*lag_locate_cosine(k*LAG_DEGREE/2);
    for (int j = 0; j < LAG_DEGREE/2; j++) sum += (k % 2 ? odd[j] : even[j])*lag_locate_cosine(j*k);
    c[k] = sum*(k % LAG_DEGREE ? LAG_C(0.25) : LAG_C(0.125));
  }
}

/* Whether the derivative of the polynomial has one sign throughout. */
static inline int lag_is_monotonic(const LAG_REAL *c, LAG_REAL error) {
  LAG_REAL d[LAG_DEGREE + 2], others = LAG_C(0.0);
  d[LAG_DEGREE + 1] = d[LAG_DEGREE] = LAG_C(0.0);
  for (int k = LAG_DEGREE; k >= 1; k--) d[k - 1] = (k < LAG_DEGREE ? d[k + 1] : LAG_C(0.0)) + LAG_C(2.0)*(LAG_REAL)k*c[k];
  for (int k = 1; k < LAG_DEGREE; k++) others += LAG_FN(fabs)(d[k]);
  return LAG_FN(fabs)(d[0]/LAG_C(2.0)) > others + LAG_C(2.0)*(LAG_REAL)LAG_DEGREE*error;
}

/* Halvings allowed to resolve one function in a part; 0: it is resolved. */
static inline int lag_locate_halvings(const LAG_REAL *value, int stride, LAG_REAL rounding) {
  const LAG_REAL rough = LAG_C(1e-3); /* of the range of g, in the last three coefficients */
  LAG_REAL c[LAG_DEGREE + 1], range = LAG_C(0.0);
  lag_locate_coefficients(value, stride, c);
  for (int k = 1; k <= LAG_DEGREE; k++) range += LAG_FN(fabs)(c[k]);
  const LAG_REAL error = LAG_FN(fabs)(c[LAG_DEGREE - 2]) + LAG_FN(fabs)(c[LAG_DEGREE - 1]) + LAG_FN(fabs)(c[LAG_DEGREE]);
  if (range <= rounding) return 0;
  if (error > rough*range && error > rounding) return LAG_FN(fabs)(c[0]) > LAG_C(4.0)*range ? 0 : LAG_LOCATE_ROUGH;
  return LAG_FN(fabs)(c[0]) > range + error || lag_is_monotonic(c, error) ? 0 : LAG_LOCATE_FINEST;
}

/* Samples 1 to 8 of a part; *most := halvings allowed. *known: rounding is known. */
static inline int lag_sample_part(const lag_locator *l, LAG_REAL ta, LAG_REAL tb, int *known, int *most) {
  LAG_REAL *const rounding = l->value + (LAG_DEGREE + 1)*l->n;
  int status = 0;
  for (int j = 1; j <= LAG_DEGREE && status == 0; j++) status = l->sample(l->context, 0, lag_locate_time(ta, tb, j), l->value + j*l->n);
  for (int turn = *known; turn < 2 && status == 0; turn++) {
    *most = 0;
    for (int k = 0; k < l->n; k++) {
      const int of_k = lag_locate_halvings(l->value + k, l->n, turn ? rounding[k] : LAG_C(0.0));
      *most = of_k > *most ? of_k : *most;
    }
    if (*most == 0 || turn) break;
    status = lag_locate_rounding(l, lag_locate_time(ta, tb, LAG_DEGREE/2), rounding);
    *known = 1;
  }
  return status;
}

/* Walks the samples of a resolved part until a crossing is found. Row 0 becomes the sample at its end. */
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

/* The first crossing in [a, b]; row 0 is the sample at a. Part i of 2^level equal parts follows part i - 1, or is half of an unresolved one. */
static inline int lag_search(const lag_locator *l, LAG_REAL a, LAG_REAL b, int *found) {
  LAG_REAL part = LAG_C(1.0); /* 2^-level */
  int level = 0, known = 0, status = 0;
  long i = 0;
  while (status == 0 && !*found && !(level == 0 && i == 1)) {
    const LAG_REAL ta = a + (b - a)*((LAG_REAL)i*part), tb = i + 1 == 1L << level ? b : a + (b - a)*((LAG_REAL)(i + 1)*part);
    const int long_enough = LAG_FN(fabs)(tb - ta) > LAG_C(64.0)*l->epsilon*lag_larger_of(LAG_FN(fabs)(ta), LAG_FN(fabs)(tb));
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

/* *to := end of the part of [a, b] to search first: after an event g may leave zero and return within a small part of the step. It is the first of
 * parts `nearest`, ..., 2^-16, 2^-8 at which a function whose sign was not known is back on its other side, else b. */
static inline int lag_first_part(const lag_locator *l, LAG_REAL a, LAG_REAL b, LAG_REAL *to) {
  LAG_REAL *const left = l->value + l->n, *const g = left + l->n;
  int status = 0, back = 0;
  for (int k = 0; k < l->n; k++) left[k] = LAG_C(0.0);
  for (LAG_REAL part = l->nearest; part < LAG_C(1.0) && status == 0 && !back; part *= LAG_C(256.0)) {
    *to = a + (b - a)*part;
    status = l->sample(l->context, 0, *to, g);
    for (int k = 0; k < l->n && status == 0; k++) {
      const int unknown = l->sign[k]*l->sign[k] < LAG_C(1.0) && LAG_FN(fabs)(g[k]) > l->noise[k];
      const LAG_REAL now = unknown ? lag_locate_sign(g[k]) : LAG_C(0.0);
      back |= now*left[k] < LAG_C(0.0);
      left[k] = left[k]*left[k] > LAG_C(0.0) ? left[k] : now;
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

/* ---- end ---- */
#endif
