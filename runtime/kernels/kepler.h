/* kepler.h: motion r'' = -mu r/|r|^3 for a time h, in closed form by universal variables: one formula
 * for ellipses, parabolas and hyperbolas. J.M.A. Danby, Fundamentals of Celestial Mechanics, 2nd ed.
 * (1988), 6.9; H. Rein, D. Tamayo, MNRAS 452 (2015) 376, DOI 10.1093/mnras/stv1257, section 2. One
 * state, no lanes. */
#ifndef LAG_KEPLER_H
#define LAG_KEPLER_H

#include "kernels/compensated_sum.h"
#include "lag_math.h"

/* ---- kepler ---- */

/* G_k = s^k c_k(beta s^2), k = 0 ... 3, with Stumpff's c_k(x) = 1/k! - x/(k + 2)! + ...: at the argument divided
 * by a power of 4 the series of c_2 and c_3, then their formulas for the fourfold argument. */
static inline void lag_stumpff(LAG_REAL beta, LAG_REAL s, LAG_REAL G[4]) {
  LAG_REAL x = beta*s*s, c0, c1;
  int folds = 0;
  for (; x*x > LAG_C(0.01); folds++) x *= LAG_C(0.25);
  LAG_REAL c2 = LAG_C(1.0), c3 = LAG_C(1.0);
  for (int k = sizeof(LAG_REAL) > 8 ? 25 : 11; k > 1; k -= 2) { /* |x| <= 0.1: the next term is 2e-17 */
    c2 = LAG_C(1.0) - x*c2/(LAG_REAL)(k*(k + 1));
    c3 = LAG_C(1.0) - x*c3/(LAG_REAL)((k + 1)*(k + 2));
  }
  c2 *= LAG_C(0.5), c3 /= LAG_C(6.0);
  c1 = LAG_C(1.0) - x*c3, c0 = LAG_C(1.0) - x*c2;
  for (; folds > 0; folds--) {
    c3 = (c2 + c0*c3)*LAG_C(0.25);
    c2 = c1*c1*LAG_C(0.5);
    c1 = c0*c1;
    c0 = LAG_C(2.0)*c0*c0 - LAG_C(1.0);
  }
  G[0] = c0, G[1] = s*c1, G[2] = s*s*c2, G[3] = s*s*s*c3;
}

/* G at s + d, for a small d. */
static inline void lag_stumpff_near(LAG_REAL beta, LAG_REAL d, LAG_REAL G[4]) {
  const LAG_REAL half = LAG_C(0.5)*d, third = d/LAG_C(3.0), G0 = G[0], G1 = G[1], G2 = G[2];
  G[3] += d*(G2 + half*(G1 + third*G0));
  G[2] += d*(G1 + half*(G0 - third*beta*G1));
  G[1] += d*(G0 - half*beta*(G1 + third*G0));
  G[0] -= d*beta*(G1 + half*(G0 - third*beta*G1));
}

/* A motion from distance r, with eta = r.v, beta = 2 mu/r - v^2, zeta = mu - beta r. */
typedef struct lag_kepler_orbit {
  LAG_REAL mu, r, eta, beta, zeta;
} lag_kepler_orbit;

/* Universal variable s of the time h, int dt/r, and G there: Danby's iteration, of order 4, within a bracket that
 * halves where a step leaves it. Time grows with s. */
static inline void lag_kepler_solve(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL G[4]) {
  const LAG_REAL first = h/o->r, slope = o->eta/o->r, near = LAG_C(0.5)*first*slope, eps = sizeof h > 8 ? LAG_C(1e-9) : LAG_C(1e-5);
  LAG_REAL s = first*(near*near < LAG_C(0.25) ? LAG_C(1.0) - near : LAG_C(1.0)), low = LAG_C(0.0), high = LAG_C(0.0);
  for (int turn = 0; turn < 200; turn++) {
    lag_stumpff(o->beta, s, G);
    const LAG_REAL f = o->r*s + (o->eta*G[2] + o->zeta*G[3] - h), f1 = o->r + (o->eta*G[1] + o->zeta*G[2]);
    const LAG_REAL f2 = o->eta*G[0] + o->zeta*G[1], f3 = o->zeta*G[0] - o->beta*o->eta*G[1];
    const LAG_REAL ahead = h > LAG_C(0.0) ? f : -f;
    if (ahead < LAG_C(0.0)) low = s;
    else high = s;
    LAG_REAL d = -f/f1;
    d = -f/(f1 + LAG_C(0.5)*d*f2);
    d = -f/(f1 + d*(LAG_C(0.5)*f2 + d*f3/LAG_C(6.0)));
    LAG_REAL next = s + d;
    const int open = !(high > LAG_C(0.0) || high < LAG_C(0.0));
    const int leaves = !((next - low)*h > LAG_C(0.0)) || (!open && !((high - next)*h > LAG_C(0.0)));
    if (leaves && !(LAG_FN(fabs)(d) <= eps*LAG_FN(fabs)(s))) next = open ? LAG_C(2.0)*s : LAG_C(0.5)*(low + high), d = s;
    if (LAG_FN(fabs)(d) <= eps*LAG_FN(fabs)(s)) {
      lag_stumpff_near(o->beta, d, G);
      return;
    }
    s = next;
  }
}

/* The motion of x[n], v[n]; lost_x, lost_v: rounding that their sums have lost. */
static inline void lag_kepler_drift(int n, LAG_REAL mu, LAG_REAL h, LAG_REAL *x, LAG_REAL *v, LAG_REAL *lost_x,
                                    LAG_REAL *lost_v) {
  LAG_REAL r2 = LAG_C(0.0), v2 = LAG_C(0.0), eta = LAG_C(0.0), G[4] = {LAG_C(1.0), LAG_C(0.0), LAG_C(0.0), LAG_C(0.0)};
  for (int i = 0; i < n; i++) r2 += x[i]*x[i], v2 += v[i]*v[i], eta += x[i]*v[i];
  const LAG_REAL r = LAG_FN(sqrt)(r2), beta = LAG_C(2.0)*mu/r - v2;
  const lag_kepler_orbit o = {mu, r, eta, beta, mu - beta*r};
  if (beta > LAG_C(0.0)) {
    const LAG_REAL period = LAG_C(6.28318530717958647692528676655900577)*mu/(beta*LAG_FN(sqrt)(beta));
    if (h > period || h < -period) h -= period*LAG_FN(floor)(h/period);
  }
  if (h > LAG_C(0.0) || h < LAG_C(0.0)) lag_kepler_solve(&o, h, G);
  const LAG_REAL r1 = r + (eta*G[1] + o.zeta*G[2]), f = -mu*G[2]/r, g = h - mu*G[3];
  const LAG_REAL df = -mu*G[1]/(r*r1), dg = -mu*G[2]/r1;
  for (int i = 0; i < n; i++) {
    const LAG_REAL dx = f*x[i] + g*v[i], dv = df*x[i] + dg*v[i];
    x[i] = lag_compensated_sum(x[i], dx, &lost_x[i]);
    v[i] = lag_compensated_sum(v[i], dv, &lost_v[i]);
  }
}

/* ---- end ---- */
#endif
