/* Functions of `lagc header --with all`, model A in doubles, against the same model B in quadruple precision, at
 * states near the start: derivatives against central differences of accelerations, products J x against J^T x,
 * inverse against forward dynamics. HELD: arguments for inputs. Exit status 0 when all hold; prints the worst ratios
 * to the tolerances. */
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>

#include FILE_A
#include FILE_B

enum { NQ = a_NQ, NZ = a_NZ, NY = a_NY, NU = a_NU, NP = a_NP, STATES = 5 };
typedef __float128 quad;

static double worst[8];
static const char *const what[8] = {"J", "B", "P", "J x", "J x . w", "inverse of forward", "inverse", "mass"};
static void note(int k, double error, double size, double tolerance) {
  const double r = error <= tolerance * size ? error / (tolerance * size + 1e-300)
                   : error == error          ? error / (tolerance * size + 1e-300)
                                             : HUGE_VAL;
  if (r > worst[k]) worst[k] = r;
}

static double noise(void) {
  static unsigned x = 12345;
  x = x * 1664525u + 1013904223u;
  return (double)(x >> 8) / (1 << 23) - 1;
}

/* The rates in quadruple precision. */
static void rates(quad t, const quad *y, const b_params *p, const quad *u, quad *k) {
  for (int i = 0; i < NQ; i++) k[i] = y[NQ + i];
  CALL_B;
  (void)u;
}

/* Column of derivatives by central differences, of y, u or p. */
static void column(quad t, quad *y, b_params *p, quad *u, quad *x, quad size, quad *out) {
  quad k0[NY + 1], k1[NY + 1];
  const quad was = *x, h = size * 1e-11Q;
  *x = was + h;
  rates(t, y, p, u, k1);
  *x = was - h;
  rates(t, y, p, u, k0);
  *x = was;
  for (int i = 0; i < NY; i++) out[i] = (k1[i] - k0[i]) / (2 * h);
}

static double size_of(const double *x, int n) {
  double most = 0;
  for (int i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
  return most > 0 ? most : 1;
}

/* Column j of J; a rate over the size of its variable is a derivative's usual size, where terms cancel. */
static void compare(int k, const double *J, const quad *d, const quad *rate, double size, int columns, int j) {
  double most = 0;
  for (int i = 0; i < NY; i++) most = fmax(most, fabs((double)rate[i]) / size);
  for (int i = 0; i < NY; i++) {
    double row = 0;
    for (int c = 0; c < columns; c++) row = fmax(row, fabs(J[i * columns + c]));
    note(k, fabs(J[i * columns + j] - (double)d[i]), row + fabs((double)d[i]) + most, 1e-12);
  }
}

static void at_state(double t, double *y, a_params *p, double *u) {
  static double J[NY * NY + 1], A[NY * NY + 1], B[NY * NU + 1], P[NY * NP + 1], x[NY + 1], w[NY + 1], jx[NY + 1],
      jw[NY + 1];
  quad yq[NY + 1], uq[NU + 1], d[NY + 1], rate[NY + 1];
  b_params pq;
  b_defaults(&pq);
  for (int i = 0; i < NY; i++) yq[i] = y[i], x[i] = noise(), w[i] = noise();
  for (int i = 0; i < NU; i++) uq[i] = u[i];
  for (int i = 0; i < NP; i++) *b_param(&pq, i) = *a_param(p, i);
#if HAS_JAC
  double *const q = y, *const v = y + NQ, *const z = y + 2 * NQ;
  (void)q, (void)v, (void)z;
  if (a_jac(ARGS, J) != a_OK || LINEARIZE != a_OK || a_jvp(ARGS, x, jx) != a_OK || a_vjp(ARGS, w, jw) != a_OK)
    worst[0] = HUGE_VAL;
  double left = 0, right = 0, sum = 0;
  rates(t, yq, &pq, uq, rate);
  for (int j = 0; j < NY; j++) {
    const double size = j < NQ ? size_of(y, NQ) : j < 2 * NQ ? size_of(y + NQ, NQ) : size_of(y + 2 * NQ, NZ);
    column(t, yq, &pq, uq, &yq[j], size, d);
    compare(0, J, d, rate, size, NY, j);
    compare(0, A, d, rate, size, NY, j);
  }
  double all = 0; /* multipliers carry rounding from row to row */
  for (int i = 0; i < NY * NY && CONSTRAINED; i++) all += fabs(J[i] * x[i % NY]);
  for (int i = 0; i < NY; i++) {
    double product = 0, terms = all;
    for (int j = 0; j < NY; j++)
      product += J[i * NY + j] * x[j], terms += fabs(J[i * NY + j] * x[j]), sum += fabs(w[i] * J[i * NY + j] * x[j]);
    note(3, fabs(product - jx[i]), terms, 1e-12);
    left += w[i] * jx[i];
    right += jw[i] * x[i];
  }
  note(4, fabs(left - right), sum, 1e-14);
#if a_NU > 0
  for (int j = 0; j < NU; j++) column(t, yq, &pq, uq, &uq[j], 1, d), compare(1, B, d, rate, 1, NU, j);
#endif
#if HAS_PARAMS
  if (a_dparams(ARGS, P) != a_OK) worst[2] = HUGE_VAL;
  for (int j = 0; j < NP; j++) {
    const double size = fabs(*a_param(p, j));
    column(t, yq, &pq, uq, b_param(&pq, j), size > 0 ? size : 1, d);
    compare(2, P, d, rate, size > 0 ? size : 1, NP, j);
  }
#endif
#endif
#if HAS_MASS
  static double M[NQ * NQ + 1], b[NQ + 1], a[NQ + 1], zd[NZ + 1], force[NQ + 1];
  double *const q1 = y, *const v1 = y + NQ, *const z1 = y + 2 * NQ;
  (void)zd, (void)z1;
  if (a_mass(ARGS1, M) != a_OK || a_bias(ARGS1, b) != a_OK || ACCEL1 != a_OK ||
      a_inverse_dynamics(ARGS1, a, force) != a_OK)
    worst[7] = HUGE_VAL;
  for (int turn = 0; turn < 2; turn++) {
    double size = 0; /* |M||q''| + |f| */
    for (int i = 0; i < NQ; i++) {
      double terms = fabs(b[i]);
      for (int j = 0; j < NQ; j++) terms += fabs(M[i * NQ + j] * a[j]);
      size = fmax(size, terms);
    }
    for (int i = 0; i < NQ; i++) {
      double f = b[i];
      for (int j = 0; j < NQ; j++) f += M[i * NQ + j] * a[j];
      for (int j = 0; j < NQ; j++) note(7, fabs(M[i * NQ + j] - M[j * NQ + i]), fabs(M[i * NQ + j]), 1e-16);
      if (!turn && !CONSTRAINED) note(5, fabs(force[i]), size, 1e-13);
      note(6, fabs(force[i] - f), size, 1e-13);
    }
    for (int i = 0; i < NQ; i++) a[i] *= 1 + noise();
    a_inverse_dynamics(ARGS1, a, force);
  }
#endif
}

int main(void) {
  a_params p;
  a_state s;
  double y[NY + 1], u[NU + 1];
  a_defaults(&p);
  (void)a_start(&p, &s);
#if a_NU > 0
  a_inputs(s.t, &p, u);
#endif
  for (int k = 0; k < STATES; k++) {
    a_gather(&s, y);
    const double sq = size_of(y, NQ), sv = size_of(y + NQ, NQ), sz = size_of(y + 2 * NQ, NZ);
    for (int i = 0; i < NY; i++) y[i] += 0.03 * noise() * (i < NQ ? sq : i < 2 * NQ ? sv : sz);
    for (int i = 0; i < NU; i++) u[i] += 0;
    at_state((double)s.t, y, &p, u);
  }
  int bad = 0;
  for (int k = 0; k < 8; k++) {
    if (worst[k] > 0) printf("%s: %.2g of the tolerance\n", what[k], worst[k]);
    bad |= !(worst[k] <= 1);
  }
  return bad;
}
