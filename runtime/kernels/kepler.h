/* kepler.h: motion r'' = -mu r/|r|^3 for a time h, in closed form by universal variables: one formula
 * for ellipses, parabolas and hyperbolas. J.M.A. Danby, Fundamentals of Celestial Mechanics, 2nd ed.
 * (1988), 6.9; H. Rein, D. Tamayo, MNRAS 452 (2015) 376, DOI 10.1093/mnras/stv1257, section 2. One
 * state, no lanes. */
#ifndef LAG_KEPLER_H
#define LAG_KEPLER_H

#include "kernels/compensated_sum.h"
#include "lag_math.h"

/* ---- kepler ---- */

/* Levels of the series below, the next of which is 2e-17 at x = 0.1. */
enum { LAG_STUMPFF_LEVELS = sizeof(LAG_REAL) > 8 ? 12 : 5 };

/* G_k = s^k c_k(beta s^2), k = 0 ... 3, with Stumpff's c_k(x) = 1/k! - x/(k + 2)! + ...: at the argument divided
 * by a power of 4 the series of c_2 and c_3, then their formulas for the fourfold argument. */
static inline void lag_stumpff(LAG_REAL beta, LAG_REAL s, LAG_REAL G[4]) {
#define LAG_LEVEL(k) {LAG_C(1.0)/((k)*((k) + 1)), LAG_C(1.0)/(((k) + 1)*((k) + 2))}
  static const LAG_REAL level[][2] = {LAG_LEVEL(3),  LAG_LEVEL(5),  LAG_LEVEL(7),  LAG_LEVEL(9),
                                      LAG_LEVEL(11), LAG_LEVEL(13), LAG_LEVEL(15), LAG_LEVEL(17),
                                      LAG_LEVEL(19), LAG_LEVEL(21), LAG_LEVEL(23), LAG_LEVEL(25)};
#undef LAG_LEVEL
  LAG_REAL x = beta*s*s, c0, c1, c2 = LAG_C(1.0), c3 = LAG_C(1.0);
  int folds = 0;
  for (; x*x > LAG_C(0.01); folds++) x *= LAG_C(0.25);
  for (int k = LAG_STUMPFF_LEVELS - 1; k >= 0; k--) {
    c2 = LAG_C(1.0) - x*level[k][0]*c2;
    c3 = LAG_C(1.0) - x*level[k][1]*c3;
  }
  c2 *= LAG_C(0.5), c3 *= LAG_OVER(1.0, 6.0);
  c1 = LAG_C(1.0) - x*c3, c0 = LAG_C(1.0) - x*c2;
  for (; folds > 0; folds--) {
    c3 = (c2 + c0*c3)*LAG_C(0.25);
    c2 = c1*c1*LAG_C(0.5);
    c1 = c0*c1;
    c0 = LAG_C(2.0)*c0*c0 - LAG_C(1.0);
  }
  G[0] = c0, G[1] = s*c1, G[2] = s*s*c2, G[3] = s*s*s*c3;
}

/* G at s + d, where |beta d^2| is at most 1e-4: addition theorems. */
static inline void lag_stumpff_near(LAG_REAL beta, LAG_REAL d, LAG_REAL G[4]) {
  const LAG_REAL x = beta*d*d, G0 = G[0], G1 = G[1], G2 = G[2];
  const LAG_REAL c3 = LAG_OVER(1.0, 6.0) - x*(LAG_OVER(1.0, 120.0) - x*(LAG_OVER(1.0, 5040.0) - x*LAG_OVER(1.0, 362880.0)));
  const LAG_REAL c2 = LAG_C(0.5) - x*(LAG_OVER(1.0, 24.0) - x*(LAG_OVER(1.0, 720.0) - x*LAG_OVER(1.0, 40320.0)));
  const LAG_REAL d1 = d*(LAG_C(1.0) - x*c3), d2 = d*d*c2, d3 = d*d*d*c3;
  G[3] += d*G2 + (G1*d2 + G0*d3);
  G[2] += G1*d1 + G0*d2;
  G[1] += G0*d1 - beta*G1*d2;
  G[0] -= beta*(G1*d1 + G0*d2);
}

/* A motion from distance r, with eta = r.v, beta = 2 mu/r - v^2, zeta = mu - beta r. */
typedef struct lag_kepler_orbit {
  LAG_REAL r, eta, beta, zeta;
} lag_kepler_orbit;

/* G at the universal variable s of the time h, s = int dt/r: the inverse series of h(s) to third order, from the start
 * and then from each estimate, within a bracket that halves where a step leaves it. Time grows with s. */
static inline void lag_kepler_solve(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL G[4]) {
  const LAG_REAL small = sizeof h > 8 ? LAG_C(1e-18) : LAG_C(1e-8), inverse = LAG_C(1.0)/o->r, u = h*inverse;
  const LAG_REAL turn1 = LAG_C(0.5)*o->eta*inverse*u, turn2 = o->zeta*inverse*LAG_OVER(1.0, 6.0)*u*u;
  const LAG_REAL part = LAG_C(1.0) - turn1 + (LAG_C(2.0)*turn1*turn1 - turn2);
  LAG_REAL s = part > LAG_C(0.5) && part < LAG_C(2.0) ? u*part : u, low = LAG_C(0.0), high = LAG_C(0.0);
  lag_stumpff(o->beta, s, G);
  for (int turn = 0; turn < 200; turn++) {
    const LAG_REAL f = o->r*s + (o->eta*G[2] + o->zeta*G[3] - h);
    const LAG_REAL slope = LAG_C(1.0)/(o->r + (o->eta*G[1] + o->zeta*G[2])), d1 = -f*slope;
    const LAG_REAL a = LAG_C(0.5)*d1*slope*(o->eta*G[0] + o->zeta*G[1]);
    const LAG_REAL b = LAG_OVER(1.0, 6.0)*d1*d1*slope*(o->zeta*G[0] - o->beta*o->eta*G[1]);
    LAG_REAL d = d1*(LAG_C(1.0) - a + (LAG_C(2.0)*a*a - b));
    const LAG_REAL x = o->beta*d*d; /* the next terms are some a^3 d and a x d */
    if (x <= small && -x <= small && a*a <= small && b <= small && -b <= small && d*d <= LAG_C(1e-6)*s*s) {
      lag_stumpff_near(o->beta, d, G);
      return;
    }
    if ((h > LAG_C(0.0) ? f : -f) < LAG_C(0.0)) low = s;
    else high = s;
    const int open = !(high > LAG_C(0.0) || high < LAG_C(0.0));
    if (!((s + d - low)*h > LAG_C(0.0)) || (!open && !((high - s - d)*h > LAG_C(0.0)))) {
      const LAG_REAL middle = open ? LAG_C(2.0)*s : LAG_C(0.5)*(low + high);
      if (!(middle > s || middle < s)) return;
      d = middle - s;
    }
    const LAG_REAL moved = o->beta*d*d;
    s += d;
    if (moved < LAG_C(1e-4) && moved > -LAG_C(1e-4) && sizeof h == 8) lag_stumpff_near(o->beta, d, G);
    else lag_stumpff(o->beta, s, G);
  }
}

/* The motion of x[3], v[3]; lost_x, lost_v: rounding that their sums have lost. */
static inline void lag_kepler_drift(LAG_REAL mu, LAG_REAL h, LAG_REAL *x, LAG_REAL *v, LAG_REAL *lost_x,
                                    LAG_REAL *lost_v) {
  LAG_REAL r2 = LAG_C(0.0), v2 = LAG_C(0.0), eta = LAG_C(0.0), G[4] = {LAG_C(1.0), LAG_C(0.0), LAG_C(0.0), LAG_C(0.0)};
  for (int i = 0; i < 3; i++) r2 += x[i]*x[i], v2 += v[i]*v[i], eta += x[i]*v[i];
  const LAG_REAL r = LAG_FN(sqrt)(r2), beta = LAG_C(2.0)*mu/r - v2;
  const lag_kepler_orbit o = {r, eta, beta, mu - beta*r};
  if (beta > LAG_C(0.0)) {
    const LAG_REAL period = LAG_C(6.28318530717958647692528676655900577)*mu/(beta*LAG_FN(sqrt)(beta));
    if (h > period || h < -period) h -= period*LAG_FN(floor)(h/period);
  }
  if (h > LAG_C(0.0) || h < LAG_C(0.0)) lag_kepler_solve(&o, h, G);
  const LAG_REAL r1 = r + (eta*G[1] + o.zeta*G[2]), f = -mu*G[2]/r, g = h - mu*G[3];
  const LAG_REAL df = -mu*G[1]/(r*r1), dg = -mu*G[2]/r1;
  for (int i = 0; i < 3; i++) {
    const LAG_REAL dx = f*x[i] + g*v[i], dv = df*x[i] + dg*v[i];
    x[i] = lag_compensated_sum(x[i], dx, &lost_x[i]);
    v[i] = lag_compensated_sum(v[i], dv, &lost_v[i]);
  }
}

/* ---- end ---- */
#endif
