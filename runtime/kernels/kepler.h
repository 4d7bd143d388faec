/* kepler.h: motion r'' = -mu r/|r|^3 for a time h, in closed form by universal variables: one formula
 * for ellipses, parabolas and hyperbolas. J.M.A. Danby, Fundamentals of Celestial Mechanics, 2nd ed.
 * (1988), 6.9; H. Rein, D. Tamayo, MNRAS 452 (2015) 376, DOI 10.1093/mnras/stv1257, section 2. One
 * body, or one in each lane. */
#ifndef LAG_KEPLER_H
#define LAG_KEPLER_H

#include "kernels/compensated_sum.h"
#include "lag_math.h"

/* ---- kepler ---- */

#if defined(__GNUC__)
#define LAG_KEPLER_INLINE static inline __attribute__((always_inline))
#else
#define LAG_KEPLER_INLINE static inline
#endif

/* Terms of the series below; the next one is 2e-17 at x = 0.1. */
enum { LAG_STUMPFF_TERMS = sizeof(LAG_LANE) > 8 ? 13 : 7 };

/* 1/k! for k = 2, 4, ... and k = 3, 5, ... */
static const LAG_LANE lag_stumpff_term[][2] = {
    {LAG_COEF(1.0)/2, LAG_COEF(1.0)/6},
    {LAG_COEF(1.0)/24, LAG_COEF(1.0)/120},
    {LAG_COEF(1.0)/720, LAG_COEF(1.0)/5040},
    {LAG_COEF(1.0)/40320, LAG_COEF(1.0)/362880},
    {LAG_COEF(1.0)/3628800, LAG_COEF(1.0)/39916800},
    {LAG_COEF(1.0)/479001600, LAG_COEF(1.0)/LAG_COEF(6227020800.0)},
    {LAG_COEF(1.0)/LAG_COEF(87178291200.0), LAG_COEF(1.0)/LAG_COEF(1307674368000.0)},
    {LAG_COEF(1.0)/LAG_COEF(20922789888000.0), LAG_COEF(1.0)/LAG_COEF(355687428096000.0)},
    {LAG_COEF(1.0)/LAG_COEF(6402373705728000.0), LAG_COEF(1.0)/LAG_COEF(121645100408832000.0)},
    {LAG_COEF(1.0)/LAG_COEF(2432902008176640000.0), LAG_COEF(1.0)/LAG_COEF(51090942171709440000.0)},
    {LAG_COEF(1.0)/LAG_COEF(1124000727777607680000.0), LAG_COEF(1.0)/LAG_COEF(25852016738884976640000.0)},
    {LAG_COEF(1.0)/LAG_COEF(620448401733239439360000.0), LAG_COEF(1.0)/LAG_COEF(15511210043330985984000000.0)},
    {LAG_COEF(1.0)/LAG_COEF(403291461126605635584000000.0), LAG_COEF(1.0)/LAG_COEF(10888869450418352160768000000.0)}};

/* G_k = s^k c_k(beta s^2), k = 0 ... 3, with Stumpff's c_k(x) = 1/k! - x/(k + 2)! + ...: the series of c_2 and c_3 at
 * |x| <= 0.1; larger ones are divided by 4^folds before, and their formulas for the fourfold argument come after. */
LAG_KEPLER_INLINE void lag_stumpff_folded(int large, LAG_REAL beta, LAG_REAL s, LAG_REAL G[4]) {
  const LAG_REAL s2 = s*s, all = beta*s2, size = LAG_FN(fabs)(all);
  LAG_REAL x = all, part = LAG_C(1.0), c2 = LAG_C(0.0), c3 = c2;
  int folds = 0;
  for (; large && folds < 600 && LAG_ANY(size*part > LAG_C(0.1)); folds++) {
    x = LAG_SELECT(size*part > LAG_C(0.1), x*LAG_C(0.25), x);
    part *= LAG_C(0.25);
  }
  const LAG_REAL x2 = x*x;
  for (int i = LAG_STUMPFF_TERMS - 2; i > 0; i -= 2) { /* two terms at a time: half as many steps wait for others */
    c2 = (LAG_C(lag_stumpff_term[i][0]) - x*LAG_C(lag_stumpff_term[i + 1][0])) + x2*c2;
    c3 = (LAG_C(lag_stumpff_term[i][1]) - x*LAG_C(lag_stumpff_term[i + 1][1])) + x2*c3;
  }
  c2 = LAG_C(0.5) - x*c2, c3 = LAG_OVER(1.0, 6.0) - x*c3;
  LAG_REAL c1 = LAG_C(1.0) - x*c3, c0 = LAG_C(1.0) - x*c2;
  while (folds-- > 0) {
    part *= LAG_C(4.0);
    const LAG_MASK folded = size*part > LAG_C(0.1);
    c3 = LAG_SELECT(folded, (c2 + c0*c3)*LAG_C(0.25), c3);
    c2 = LAG_SELECT(folded, c1*c1*LAG_C(0.5), c2);
    c1 = LAG_SELECT(folded, c0*c1, c1);
    c0 = LAG_SELECT(folded, LAG_C(2.0)*c0*c0 - LAG_C(1.0), c0);
  }
  G[0] = c0, G[1] = s*c1, G[2] = s2*c2, G[3] = s*s2*c3;
}

/* G at s + d, where |beta d^2| is at most 1e-8, or 1e-4 if wide: addition theorems. */
LAG_KEPLER_INLINE void lag_stumpff_near(int wide, LAG_REAL beta, LAG_REAL d, LAG_REAL G[4]) {
  const LAG_REAL x = beta*d*d, G0 = G[0], G1 = G[1], G2 = G[2];
  LAG_REAL c3 = LAG_OVER(1.0, 6.0), c2 = LAG_C(0.5) - x*LAG_OVER(1.0, 24.0);
  if (wide) {
    c3 -= x*(LAG_OVER(1.0, 120.0) - x*(LAG_OVER(1.0, 5040.0) - x*LAG_OVER(1.0, 362880.0)));
    c2 += x*x*(LAG_OVER(1.0, 720.0) - x*LAG_OVER(1.0, 40320.0));
  }
  const LAG_REAL d1 = d*(LAG_C(1.0) - x*c3), d2 = d*d*c2, d3 = d*d*d*c3;
  G[3] += d*G2 + (G1*d2 + G0*d3);
  G[2] += G1*d1 + G0*d2;
  G[1] += G0*d1 - beta*G1*d2;
  G[0] -= beta*(G1*d1 + G0*d2);
}

/* A motion from distance r, with eta = r.v, beta = 2 mu/r - v^2, zeta = mu - beta r. Its position and velocity after
 * a time less those before: f x + g v, df x + dg v. */
typedef struct lag_kepler_orbit {
  LAG_REAL mu, r, inverse, eta, beta, zeta;
} lag_kepler_orbit;
typedef struct lag_kepler_motion {
  LAG_REAL f, g, df, dg;
} lag_kepler_motion;

LAG_KEPLER_INLINE lag_kepler_motion lag_kepler_moved(const lag_kepler_orbit *o, LAG_REAL h, const LAG_REAL G[4]) {
  const LAG_REAL end = LAG_C(1.0)/(o->r + (o->eta*G[1] + o->zeta*G[2])), turn = o->mu*G[2];
  const lag_kepler_motion m = {-turn*o->inverse, h - o->mu*G[3], -o->mu*G[1]*(o->inverse*end), -turn*end};
  return m;
}

/* Terms beyond the first, relative, of the inverse series of h(s) to third order, from s = 0. */
LAG_KEPLER_INLINE LAG_REAL lag_kepler_turn(const lag_kepler_orbit *o, LAG_REAL u) {
  const LAG_REAL part = o->inverse*u, turn = LAG_C(0.5)*o->eta*part;
  return LAG_C(2.0)*turn*turn - turn - o->zeta*LAG_OVER(1.0, 6.0)*u*part;
}

/* Correction d of s by the same series, of the time f too long: its first term and those beyond, relative. */
typedef struct lag_kepler_step {
  LAG_REAL f, a, b, d;
} lag_kepler_step;
LAG_KEPLER_INLINE lag_kepler_step lag_kepler_correction(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL s,
                                                        const LAG_REAL G[4]) {
  const LAG_REAL f = o->r*s + (o->eta*G[2] + o->zeta*G[3] - h);
  const LAG_REAL slope = LAG_C(1.0)/(o->r + (o->eta*G[1] + o->zeta*G[2])), d1 = -f*slope;
  const LAG_REAL a = LAG_C(0.5)*d1*slope*(o->eta*G[0] + o->zeta*G[1]);
  const LAG_REAL b = LAG_OVER(1.0, 6.0)*d1*d1*slope*(o->zeta*G[0] - o->beta*o->eta*G[1]);
  const lag_kepler_step step = {f, a, b, d1*(LAG_C(1.0) - a + (LAG_C(2.0)*a*a - b))};
  return step;
}

/* Whether the terms that follow in the inverse series, some a^3 d and a x d, are rounding: beta d^2, a^2 and b are
 * 1e-8, and d is 1e-3 s. One comparison: those of vectors wider than the processor's are made lane by lane. */
LAG_KEPLER_INLINE LAG_MASK lag_kepler_is_near(const lag_kepler_orbit *o, LAG_REAL s, const lag_kepler_step *c) {
  const LAG_REAL small = sizeof(LAG_LANE) > 8 ? LAG_C(1e18) : LAG_C(1e8), d2 = c->d*c->d, s2 = s*s;
  const LAG_REAL turn = LAG_FN(fabs)(o->beta*d2) + (c->a*c->a + LAG_FN(fabs)(c->b));
  return d2*LAG_C(1e6) + turn*small*s2 <= s2;
}

/* The first estimate of s for the time h, 0 where it is far from good; G there. */
LAG_KEPLER_INLINE LAG_REAL lag_kepler_estimate(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL G[4]) {
  const LAG_REAL u = h*o->inverse, moved = lag_kepler_turn(o, u), first = u + u*moved;
  const LAG_REAL rough = moved*moved*LAG_C(4.0) + LAG_FN(fabs)(o->beta*first*first)*LAG_C(0.625);
  const int large = LAG_ANY(LAG_NOT(rough < LAG_C(0.0625)));
  const LAG_REAL s = large ? LAG_SELECT(rough < LAG_C(1.0), first, LAG_C(0.0)) : first;
  lag_stumpff_folded(large, o->beta, s, G);
  return s;
}

/* G where one correction of the estimate ends; where it does not suffice. */
LAG_KEPLER_INLINE LAG_MASK lag_kepler_correct(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL s, LAG_REAL G[4]) {
  const lag_kepler_step c = lag_kepler_correction(o, h, s, G);
  lag_stumpff_near(0, o->beta, c.d, G);
  return LAG_NOT(lag_kepler_is_near(o, s, &c));
}

/* r, its inverse, and mu/r^3 of a body at x, y, z, rounded as models write it; 1, 1, 0 for one without mu: held is 1,
 * else 0. */
LAG_KEPLER_INLINE void lag_kepler_distance(LAG_REAL mu, LAG_REAL held, const LAG_REAL x[3], LAG_REAL r[3]) {
  const LAG_REAL r2 = held*(x[0]*x[0] + x[1]*x[1] + x[2]*x[2]) + (LAG_C(1.0) - held);
  r[0] = LAG_FN(sqrt)(r2);
  r[1] = LAG_C(1.0)/r[0];
  r[2] = mu/(r2*r[0]);
}

/* The orbit at x, v; without mu a straight line: r = 1 and eta = beta = zeta = 0. */
LAG_KEPLER_INLINE lag_kepler_orbit lag_kepler_orbit_at(LAG_REAL mu, LAG_REAL held, const LAG_REAL r[3],
                                                       const LAG_REAL x[3], const LAG_REAL v[3]) {
  const LAG_REAL eta = held*(x[0]*v[0] + x[1]*v[1] + x[2]*v[2]);
  const LAG_REAL beta = LAG_C(2.0)*mu*r[1] - held*(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
  const lag_kepler_orbit o = {mu, r[0], r[1], eta, beta, mu - beta*r[0]};
  return o;
}

/* ---- kepler: far ---- */

/* Motions of one body that one correction does not find. */
#ifndef LAG_LANES
/* Large arguments by sine and cosine, as each fold doubles rounding and more. */
static inline void lag_stumpff(LAG_REAL beta, LAG_REAL s, LAG_REAL G[4]) {
  const LAG_REAL x = beta*s*s;
  if (x > LAG_C(2.0)) {
    const LAG_REAL y = LAG_FN(sqrt)(x), c1 = LAG_FN(sin)(y)/y, half = LAG_FN(sin)(LAG_C(0.5)*y);
    G[0] = LAG_FN(cos)(y), G[1] = s*c1, G[2] = LAG_C(2.0)*half*half/beta, G[3] = s*(LAG_C(1.0) - c1)/beta;
    return;
  }
  lag_stumpff_folded(1, beta, s, G);
}

/* G at the universal variable s of the time h, s = int dt/r: the inverse series of h(s) to third order, from the start
 * and then from each estimate, within a bracket that doubles or halves where a step leaves it. Time grows with s. */
static inline void lag_kepler_solve(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL G[4]) {
  const LAG_REAL u = h*o->inverse, part = LAG_C(1.0) + lag_kepler_turn(o, u), size = LAG_FN(fabs)(o->beta*u*u);
  LAG_REAL s = part > LAG_C(0.5) && part < LAG_C(2.0) ? u*part : size > LAG_C(1.0) ? u/LAG_FN(sqrt)(size) : u;
  LAG_REAL low = LAG_C(0.0), high = LAG_C(0.0);
  lag_stumpff(o->beta, s, G);
  for (int turn = 0; turn < 200; turn++) {
    const lag_kepler_step c = lag_kepler_correction(o, h, s, G);
    LAG_REAL d = c.d;
    if (lag_kepler_is_near(o, s, &c)) {
      lag_stumpff_near(0, o->beta, d, G);
      return;
    }
    if ((h > LAG_C(0.0) ? c.f : -c.f) < LAG_C(0.0)) low = s;
    else high = s;
    const int open = !(high > LAG_C(0.0) || high < LAG_C(0.0));
    const LAG_REAL end = open ? LAG_C(2.0)*s : high;
    if (!((s + d - low)*h > LAG_C(0.0)) || !((end - s - d)*h > LAG_C(0.0))) {
      const LAG_REAL middle = open ? end : LAG_C(0.5)*(low + high);
      if (!(middle > s || middle < s)) return;
      d = middle - s;
    }
    const int near = LAG_FN(fabs)(o->beta*d*d) < LAG_C(1e-4) && d*d < LAG_C(0.01)*s*s && sizeof h == 8;
    s += d;
    if (near) lag_stumpff_near(1, o->beta, d, G);
    else lag_stumpff(o->beta, s, G);
  }
}

/* An ellipse: for the time less whole periods. */
static inline lag_kepler_motion lag_kepler_far(const lag_kepler_orbit *o, LAG_REAL h) {
  LAG_REAL G[4] = {LAG_C(1.0), LAG_C(0.0), LAG_C(0.0), LAG_C(0.0)};
  if (o->beta > LAG_C(0.0)) {
    const LAG_REAL period = LAG_C(6.28318530717958647692528676655900577)*o->mu/(o->beta*LAG_FN(sqrt)(o->beta));
    h -= period*LAG_FN(floor)(h/period + LAG_C(0.5));
  }
  if (h > LAG_C(0.0) || h < LAG_C(0.0)) lag_kepler_solve(o, h, G);
  return lag_kepler_moved(o, h, G);
}
#endif

/* ---- end ---- */
#endif
