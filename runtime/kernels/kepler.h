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

/* 1/(k(k + 1)), 1/((k + 1)(k + 2)) for k = 3, 5, ... */
#define LAG_LEVEL(k) {LAG_C(1.0)/((k)*((k) + 1)), LAG_C(1.0)/(((k) + 1)*((k) + 2))}
static const LAG_REAL lag_stumpff_level[][2] = {LAG_LEVEL(3),  LAG_LEVEL(5),  LAG_LEVEL(7),  LAG_LEVEL(9),
                                                LAG_LEVEL(11), LAG_LEVEL(13), LAG_LEVEL(15), LAG_LEVEL(17),
                                                LAG_LEVEL(19), LAG_LEVEL(21), LAG_LEVEL(23), LAG_LEVEL(25)};
#undef LAG_LEVEL

/* Bodies side by side: loops over them are short, so that compilers make vectors of them. A block has 4, or 8: two
 * vectors of 4 overlap in time. Functions of a block are called with a constant, and inline. */
enum { LAG_KEPLER_BLOCK = 4, LAG_KEPLER_LARGE = 8 };
#define LAG_EACH(k) for (int k = 0; k < block; k++)
typedef LAG_REAL lag_kepler_lanes[LAG_KEPLER_LARGE];
#if defined(__GNUC__)
#define LAG_KEPLER_INLINE static inline __attribute__((always_inline))
#else
#define LAG_KEPLER_INLINE static inline
#endif

/* G_k = s^k c_k(beta s^2), k = 0 ... 3, with Stumpff's c_k(x) = 1/k! - x/(k + 2)! + ...: at the arguments x divided
 * by 4^folds the series of c_2 and c_3, then their formulas for the fourfold argument. */
LAG_KEPLER_INLINE void lag_stumpff_block(int block, const lag_kepler_lanes beta, const lag_kepler_lanes s, int folds,
                                         lag_kepler_lanes G[4]) {
  lag_kepler_lanes x, c0, c1, c2, c3;
  LAG_REAL part = LAG_C(1.0);
  for (int i = 0; i < folds; i++) part *= LAG_C(0.25);
  LAG_EACH(k) x[k] = beta[k]*s[k]*s[k]*part, c2[k] = c3[k] = LAG_C(1.0);
  for (int i = LAG_STUMPFF_LEVELS - 1; i >= 0; i--) {
    const LAG_REAL l2 = lag_stumpff_level[i][0], l3 = lag_stumpff_level[i][1];
    LAG_EACH(k) c2[k] = LAG_C(1.0) - x[k]*l2*c2[k];
    LAG_EACH(k) c3[k] = LAG_C(1.0) - x[k]*l3*c3[k];
  }
  LAG_EACH(k) {
    c2[k] *= LAG_C(0.5), c3[k] *= LAG_OVER(1.0, 6.0);
    c1[k] = LAG_C(1.0) - x[k]*c3[k], c0[k] = LAG_C(1.0) - x[k]*c2[k];
  }
  for (int i = 0; i < folds; i++)
    LAG_EACH(k) {
      c3[k] = (c2[k] + c0[k]*c3[k])*LAG_C(0.25);
      c2[k] = c1[k]*c1[k]*LAG_C(0.5);
      c1[k] = c0[k]*c1[k];
      c0[k] = LAG_C(2.0)*c0[k]*c0[k] - LAG_C(1.0);
    }
  LAG_EACH(k) {
    const LAG_REAL s2 = s[k]*s[k];
    G[0][k] = c0[k], G[1][k] = s[k]*c1[k], G[2][k] = s2*c2[k], G[3][k] = s[k]*s2*c3[k];
  }
}

/* The same for one body; of large arguments by sine and cosine, as each fold doubles rounding and more. */
static inline void lag_stumpff(LAG_REAL beta, LAG_REAL s, LAG_REAL G[4]) {
  const lag_kepler_lanes betas = {beta}, all = {s};
  LAG_REAL x = beta*s*s;
  lag_kepler_lanes of[4];
  int folds = 0;
  if (x > LAG_C(2.0)) {
    const LAG_REAL y = LAG_FN(sqrt)(x), c1 = LAG_FN(sin)(y)/y, half = LAG_FN(sin)(LAG_C(0.5)*y);
    G[0] = LAG_FN(cos)(y), G[1] = s*c1, G[2] = LAG_C(2.0)*half*half/beta, G[3] = s*(LAG_C(1.0) - c1)/beta;
    return;
  }
  for (; x*x > LAG_C(0.01) && folds < 600; folds++) x *= LAG_C(0.25);
  lag_stumpff_block(LAG_KEPLER_BLOCK, betas, all, folds, of);
  for (int k = 0; k < 4; k++) G[k] = of[k][0];
}

/* G at s + d, where |beta d^2| is at most 1e-4: addition theorems. */
static inline void lag_stumpff_near(LAG_REAL beta, LAG_REAL d, LAG_REAL G[4]) {
  const LAG_REAL x = beta*d*d, G0 = G[0], G1 = G[1], G2 = G[2];
  const LAG_REAL rest3 = LAG_OVER(1.0, 120.0) - x*(LAG_OVER(1.0, 5040.0) - x*LAG_OVER(1.0, 362880.0));
  const LAG_REAL rest2 = LAG_OVER(1.0, 24.0) - x*(LAG_OVER(1.0, 720.0) - x*LAG_OVER(1.0, 40320.0));
  const LAG_REAL c3 = LAG_OVER(1.0, 6.0) - x*rest3, c2 = LAG_C(0.5) - x*rest2;
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

/* Whether the terms that follow in the inverse series, some a^3 d and a x d, are rounding. */
static inline int lag_kepler_is_near(LAG_REAL beta, LAG_REAL s, LAG_REAL d, LAG_REAL a, LAG_REAL b) {
  const LAG_REAL small = sizeof s > 8 ? LAG_C(1e-18) : LAG_C(1e-8), x = beta*d*d;
  return x <= small && -x <= small && a*a <= small && b <= small && -b <= small && d*d <= LAG_C(1e-6)*s*s;
}

/* G at the universal variable s of the time h, s = int dt/r: the inverse series of h(s) to third order, from the start
 * and then from each estimate, within a bracket that doubles or halves where a step leaves it. Time grows with s. */
static inline void lag_kepler_solve(const lag_kepler_orbit *o, LAG_REAL h, LAG_REAL G[4]) {
  const LAG_REAL inverse = LAG_C(1.0)/o->r, u = h*inverse;
  const LAG_REAL turn1 = LAG_C(0.5)*o->eta*inverse*u, turn2 = o->zeta*inverse*LAG_OVER(1.0, 6.0)*u*u;
  const LAG_REAL part = LAG_C(1.0) - turn1 + (LAG_C(2.0)*turn1*turn1 - turn2);
  const LAG_REAL turned = o->beta*u*u, size = turned < LAG_C(0.0) ? -turned : turned;
  LAG_REAL s = part > LAG_C(0.5) && part < LAG_C(2.0) ? u*part : size > LAG_C(1.0) ? u/LAG_FN(sqrt)(size) : u;
  LAG_REAL low = LAG_C(0.0), high = LAG_C(0.0);
  lag_stumpff(o->beta, s, G);
  for (int turn = 0; turn < 200; turn++) {
    const LAG_REAL f = o->r*s + (o->eta*G[2] + o->zeta*G[3] - h);
    const LAG_REAL slope = LAG_C(1.0)/(o->r + (o->eta*G[1] + o->zeta*G[2])), d1 = -f*slope;
    const LAG_REAL a = LAG_C(0.5)*d1*slope*(o->eta*G[0] + o->zeta*G[1]);
    const LAG_REAL b = LAG_OVER(1.0, 6.0)*d1*d1*slope*(o->zeta*G[0] - o->beta*o->eta*G[1]);
    LAG_REAL d = d1*(LAG_C(1.0) - a + (LAG_C(2.0)*a*a - b));
    if (lag_kepler_is_near(o->beta, s, d, a, b)) {
      lag_stumpff_near(o->beta, d, G);
      return;
    }
    if ((h > LAG_C(0.0) ? f : -f) < LAG_C(0.0)) low = s;
    else high = s;
    const int open = !(high > LAG_C(0.0) || high < LAG_C(0.0));
    const LAG_REAL end = open ? LAG_C(2.0)*s : high;
    if (!((s + d - low)*h > LAG_C(0.0)) || !((end - s - d)*h > LAG_C(0.0))) {
      const LAG_REAL middle = open ? end : LAG_C(0.5)*(low + high);
      if (!(middle > s || middle < s)) return;
      d = middle - s;
    }
    const LAG_REAL moved = o->beta*d*d;
    const int near = moved < LAG_C(1e-4) && moved > -LAG_C(1e-4) && d*d < LAG_C(0.01)*s*s && sizeof h == 8;
    s += d;
    if (near) lag_stumpff_near(o->beta, d, G);
    else lag_stumpff(o->beta, s, G);
  }
}

/* Motions of a block: orbits at the start, universal variable s and its correction d, whether one correction suffices;
 * positions and velocities of the end less those of the start: f x + g v, df x + dg v. */
typedef struct lag_kepler_motions {
  lag_kepler_lanes r, eta, beta, zeta, s, d, G[4], f, g, df, dg;
  int easy[LAG_KEPLER_LARGE];
} lag_kepler_motions;

/* Orbits, and the first estimate of s; returns the folds of the largest argument of lag_stumpff_block. */
LAG_KEPLER_INLINE int lag_kepler_begin(int block, lag_kepler_motions *o, const LAG_REAL *mu, LAG_REAL h, int stride,
                                       const LAG_REAL *x, const LAG_REAL *v) {
  lag_kepler_lanes moved;
  LAG_REAL most = LAG_C(0.0);
  int folds = 0;
  LAG_EACH(k) {
    const LAG_REAL *const q = x + k, *const p = v + k;
    o->r[k] = q[0]*q[0] + q[stride]*q[stride] + q[2*stride]*q[2*stride];
    o->beta[k] = p[0]*p[0] + p[stride]*p[stride] + p[2*stride]*p[2*stride];
    o->eta[k] = q[0]*p[0] + q[stride]*p[stride] + q[2*stride]*p[2*stride];
  }
  LAG_EACH(k) o->r[k] = mu[k] > LAG_C(0.0) ? LAG_FN(sqrt)(o->r[k]) : LAG_C(1.0);
  LAG_EACH(k) {
    const LAG_REAL inverse = LAG_C(1.0)/o->r[k], u = h*inverse;
    o->beta[k] = LAG_C(2.0)*mu[k]*inverse - o->beta[k];
    o->zeta[k] = mu[k] - o->beta[k]*o->r[k];
    const LAG_REAL turn1 = LAG_C(0.5)*o->eta[k]*inverse*u, turn2 = o->zeta[k]*inverse*LAG_OVER(1.0, 6.0)*u*u;
    moved[k] = LAG_C(2.0)*turn1*turn1 - turn1 - turn2;
    o->s[k] = u + u*moved[k];
  }
  LAG_EACH(k) {
    const LAG_REAL x2 = o->beta[k]*o->s[k]*o->s[k], size = x2 < LAG_C(0.0) ? -x2 : x2;
    o->easy[k] = mu[k] > LAG_C(0.0) && moved[k]*moved[k] < LAG_C(0.25) && size < LAG_C(1.6);
    most = o->easy[k] && size > most ? size : most;
  }
  for (; most > LAG_C(0.1); folds++) most *= LAG_C(0.25);
  return folds;
}

LAG_KEPLER_INLINE void lag_kepler_correct(int block, lag_kepler_motions *o, LAG_REAL h) {
  lag_kepler_lanes a, b;
  LAG_EACH(k) {
    const LAG_REAL f = o->r[k]*o->s[k] + (o->eta[k]*o->G[2][k] + o->zeta[k]*o->G[3][k] - h);
    const LAG_REAL slope = LAG_C(1.0)/(o->r[k] + (o->eta[k]*o->G[1][k] + o->zeta[k]*o->G[2][k])), d1 = -f*slope;
    a[k] = LAG_C(0.5)*d1*slope*(o->eta[k]*o->G[0][k] + o->zeta[k]*o->G[1][k]);
    b[k] = LAG_OVER(1.0, 6.0)*d1*d1*slope*(o->zeta[k]*o->G[0][k] - o->beta[k]*o->eta[k]*o->G[1][k]);
    o->d[k] = d1*(LAG_C(1.0) - a[k] + (LAG_C(2.0)*a[k]*a[k] - b[k]));
  }
  LAG_EACH(k) o->easy[k] = o->easy[k] && lag_kepler_is_near(o->beta[k], o->s[k], o->d[k], a[k], b[k]);
}

static inline void lag_kepler_finish(lag_kepler_motions *o, int k, LAG_REAL mu, LAG_REAL h, const LAG_REAL G[4]) {
  const LAG_REAL r1 = o->r[k] + (o->eta[k]*G[1] + o->zeta[k]*G[2]);
  o->f[k] = -mu*G[2]/o->r[k], o->g[k] = h - mu*G[3], o->df[k] = -mu*G[1]/(o->r[k]*r1), o->dg[k] = -mu*G[2]/r1;
}

/* A motion that one correction does not find; an ellipse: for the time less whole periods. */
static inline void lag_kepler_far(lag_kepler_motions *o, int k, LAG_REAL mu, LAG_REAL h) {
  const lag_kepler_orbit of = {o->r[k], o->eta[k], o->beta[k], o->zeta[k]};
  LAG_REAL G[4] = {LAG_C(1.0), LAG_C(0.0), LAG_C(0.0), LAG_C(0.0)};
  if (mu > LAG_C(0.0) && of.beta > LAG_C(0.0)) {
    const LAG_REAL period = LAG_C(6.28318530717958647692528676655900577)*mu/(of.beta*LAG_FN(sqrt)(of.beta));
    h -= period*LAG_FN(floor)(h/period + LAG_C(0.5));
  }
  if (mu > LAG_C(0.0) && (h > LAG_C(0.0) || h < LAG_C(0.0))) lag_kepler_solve(&of, h, G);
  lag_kepler_finish(o, k, mu, h, G);
}

/* The motions of a block of bodies for the time h: y = {x, v, lost_x, lost_v}: components at strides of `stride`;
 * lost: rounding that sums have lost. mu = 0: a straight line. */
static inline void lag_kepler_drift(int block, const LAG_REAL *mu, LAG_REAL h, int stride, LAG_REAL *const y[4]) {
  LAG_REAL *const x = y[0], *const v = y[1], *const lost_x = y[2], *const lost_v = y[3];
  lag_kepler_motions o;
  const int folds = lag_kepler_begin(block, &o, mu, h, stride, x, v);
  lag_stumpff_block(block, o.beta, o.s, folds, o.G);
  lag_kepler_correct(block, &o, h);
  LAG_EACH(k) {
    LAG_REAL G[4] = {o.G[0][k], o.G[1][k], o.G[2][k], o.G[3][k]};
    lag_stumpff_near(o.beta[k], o.d[k], G);
    lag_kepler_finish(&o, k, mu[k], h, G);
  }
  LAG_EACH(k)
    if (!o.easy[k]) lag_kepler_far(&o, k, mu[k], h);
  for (int c = 0; c < 3*stride; c += stride)
    LAG_EACH(k) {
      const LAG_REAL q = x[c + k], p = v[c + k];
      x[c + k] = lag_compensated_sum(q, o.f[k]*q + o.g[k]*p, &lost_x[c + k]);
      v[c + k] = lag_compensated_sum(p, o.df[k]*q + o.dg[k]*p, &lost_v[c + k]);
    }
}

/* ---- end ---- */
#endif
