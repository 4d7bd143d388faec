/* dop853 as one would write it by hand for one problem: number of equations, coefficients and right-hand side known
 * to the compiler, Hairer's step control (dop853.f: safety 0.9, factors from 1/3 to 6, no memory), nothing watched.
 * The coefficients are those of runtime/methods/tableau.c. */
#define lag_euler_tableau unused_euler
#define lag_rk4_tableau unused_rk4
#define lag_rk45_tableau unused_rk45
#define lag_dop853_tableau coefficients
#include "methods/tableau.c"

#include <string.h>

#include "methods.h"

#define INLINE static inline __attribute__((always_inline))

typedef int rhs(double t, const double *y, double *d, void *p);

INLINE void sum(int n, int count, const double *coef, double k[][BENCH_MOST], double *out) {
  for (int i = 0; i < n; i++) {
    double s = coef[0]*k[0][i];
#define TERM(j) if (j < count && coef[j] != 0.0) s += coef[j]*k[j][i];
    TERM(1) TERM(2) TERM(3) TERM(4) TERM(5) TERM(6) TERM(7) TERM(8) TERM(9) TERM(10) TERM(11)
    out[i] = s;
  }
}

INLINE double first_step(rhs *f, int n, double t, double tol, const double *y, double k[][BENCH_MOST]) {
  double d0 = 0, d1 = 0, d2 = 0, x[BENCH_MOST];
  for (int i = 0; i < n; i++) {
    double s = tol + tol*fabs(y[i]);
    d0 += y[i]/s*(y[i]/s), d1 += k[0][i]/s*(k[0][i]/s);
  }
  double h = d0 < 1e-10 || d1 < 1e-10 ? 1e-6 : fmin(0.01*sqrt(d0/d1), t);
  for (int i = 0; i < n; i++) x[i] = y[i] + h*k[0][i];
  f(h, x, k[1], NULL);
  for (int i = 0; i < n; i++) {
    double s = tol + tol*fabs(y[i]), e = (k[1][i] - k[0][i])/s;
    d2 += e*e;
  }
  return fmin(fmin(100*h, t), pow(0.01/fmax(sqrt(d1/n), sqrt(d2/n)/h), 1.0/8));
}

INLINE double integrate(rhs *f, int n, double t, double tol, double *y) {
  double k[13][BENCH_MOST], x[BENCH_MOST], fine[BENCH_MOST], coarse[BENCH_MOST], at = 0;
  double t0 = bench_now();
  f(0, y, k[0], NULL);
  double h = first_step(f, n, t, tol, y, k);
  int rejected = 0;
  while (at < t) {
    h = fmin(h, t - at);
    if (h < 1e-15*fabs(at)) return -1;
#define STAGE(s)                                                  \
    sum(n, s, coefficients.a[s], k, x);                           \
    for (int i = 0; i < n; i++) x[i] = y[i] + h*x[i];             \
    f(at + coefficients.c[s]*h, x, k[s], NULL);
    STAGE(1) STAGE(2) STAGE(3) STAGE(4) STAGE(5) STAGE(6) STAGE(7) STAGE(8) STAGE(9) STAGE(10) STAGE(11)
    sum(n, 12, coefficients.a[12], k, x);
    sum(n, 12, coefficients.errors[0], k, fine);
    sum(n, 12, coefficients.errors[1], k, coarse);
    double e = 0, e3 = 0;
    for (int i = 0; i < n; i++) {
      x[i] = y[i] + h*x[i];
      double s = 1/(tol + tol*fmax(fabs(y[i]), fabs(x[i])));
      e += fine[i]*s*(fine[i]*s), e3 += coarse[i]*s*(coarse[i]*s);
    }
    double both = e + 0.01*e3, err = both > 0 ? h*e/sqrt(n*both) : 0;
    double factor = fmin(3, fmax(1.0/6, pow(err, 1.0/8)/0.9));
    if (err <= 1) {
      at = h >= t - at ? t : at + h;
      memcpy(y, x, (size_t)n*sizeof *y);
      f(at, y, k[0], NULL);
      h /= rejected ? fmax(factor, 1) : factor;
    } else if (err > 1) {
      h /= factor;
    } else return -1;
    rejected = !(err <= 1);
  }
  return bench_now() - t0;
}

double peer_inlined(int problem, bench_rhs *f, int n, double t, double tol, double *y) {
  (void)f, (void)n;
  switch (problem) {
  case DOUBLE_PENDULUM: return integrate(by_hand_double_pendulum, 4, t, tol, y);
  case HENON_HEILES: return integrate(by_hand_henon_heiles, 4, t, tol, y);
  case KEPLER: return integrate(by_hand_kepler, 4, t, tol, y);
  case PLANETS: return integrate(by_hand_planets, 36, t, tol, y);
  case CHAIN_10: return integrate(by_hand_chain_10, 20, t, tol, y);
  case CHAIN_20: return integrate(by_hand_chain_20, 40, t, tol, y);
  case OSCILLATORS: return integrate(by_hand_oscillators, 4, t, tol, y);
  default: return -1;
  }
}

#ifdef BENCH_SYMPY
/* The same with what SymPy writes for the chains (sympy_peer.py); -1 for other problems. */
#define SYMPY_CHAIN(n)                                                                                         \
  int sympy_##n(double t, const double *q, const double *v, const double *z, const double *p, const double *u, \
                double *a, double *zd, double *w);                                                             \
  static int sympy_chain_##n(double t, const double *y, double *d, void *p) {                                  \
    double parameters[2 * n + 1];                                                                              \
    (void)p;                                                                                                   \
    for (int i = 0; i < 2 * n; i++) parameters[i] = 1;                                                         \
    parameters[2 * n] = 9.81;                                                                                  \
    memcpy(d, y + n, n * sizeof *d);                                                                           \
    return sympy_##n(t, y, y + n, NULL, parameters, NULL, d + n, NULL, NULL);                                  \
  }
SYMPY_CHAIN(10)
SYMPY_CHAIN(20)

double peer_sympy(int problem, bench_rhs *f, int n, double t, double tol, double *y) {
  (void)f, (void)n;
  switch (problem) {
  case CHAIN_10: return integrate(sympy_chain_10, 20, t, tol, y);
  case CHAIN_20: return integrate(sympy_chain_20, 40, t, tol, y);
  default: return -1;
  }
}
#endif
