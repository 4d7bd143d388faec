/* lag_kkt.h: accelerations, or changes of a state, that obey constraints. Includes only <math.h>.
 *
 *   M x - A^T l = f        M[n*n] symmetric, A[m*n]
 *   A x         = g
 *
 * for any A, redundant or not, and any M that is regular on the kernel of A: x is unique then; of the multipliers l those
 * of least norm are given. A^T P = Q R is factored by Householder's reflections with exchange of columns, which are the
 * constraints, scaled to a like size so that it does not matter how each was written: what is left of a constraint beside
 * those before it decides whether it is counted (Golub & Van Loan, Matrix Computations, 4th ed. (2013), 5.4.2). In the
 * coordinates Q^T x the first r components follow from g, and the others from M without constraints (the null space method: Benzi, Golub,
 * Liesen, Acta Numerica 14 (2005) 1, section 6, DOI 10.1017/S0962492904000212); l is the least solution of R l = what M x - f is there,
 * by a second factorization where r < m.
 *
 * Near a position where constraints become dependent, a coarse rank is the right one for corrections of a state, whose right-hand
 * side is little more than rounding: what is 1e-16 there moves a position by 1e-16/s, where s is how independent the weakest
 * constraint still is, and that turns the directions which constraints allow by 1e-16/s^2.
 *
 * lagc copies the section below into what it emits, with LAG_ and lag_ replaced by the prefix of an emitted header. There
 * LAG_REAL may be a vector; LAG_LANE is the scalar that it is made of. */
#ifndef LAG_KKT_H
#define LAG_KKT_H

#include <math.h>

#ifndef LAG_REAL
#define LAG_REAL double
#endif
#ifndef LAG_LANE
#define LAG_LANE LAG_REAL
#endif
#ifndef LAG_FN
#define LAG_FN(f) f
#endif
#ifndef LAG_MASK
#define LAG_MASK int
#endif

/* ---- kkt ---- */
#ifdef LAG_LANES
#define LAG_LANE_FN(f) f
#else
#define LAG_LANE_FN(f) LAG_FN(f)
#endif

/* x := x - beta v (v.x): Householder's reflection by v[n]. */
static void lag_reflect(int n, const LAG_LANE *v, LAG_LANE beta, LAG_LANE *x, int stride) {
  LAG_LANE s = 0;
  for (int i = 0; i < n; i++) s += v[i]*x[i*stride];
  s *= beta;
  for (int i = 0; i < n; i++) x[i*stride] -= s*v[i];
}

/* v[n] becomes the vector of a reflection that leads what it was to (alpha, 0, ...). */
static LAG_LANE lag_reflector(int n, LAG_LANE *v, LAG_LANE *beta) {
  LAG_LANE size = 0, s = 0;
  for (int i = 0; i < n; i++) size = LAG_LANE_FN(fabs)(v[i]) > size ? LAG_LANE_FN(fabs)(v[i]) : size;
  *beta = 0;
  if (!(size > 0)) return 0;
  for (int i = 0; i < n; i++) s += v[i]/size*(v[i]/size);
  const LAG_LANE norm = size*LAG_LANE_FN(sqrt)(s), alpha = v[0] > 0 ? -norm : norm;
  v[0] -= alpha;
  *beta = -1/(alpha*v[0]);
  return alpha;
}

/* A P = R^T Q^T, row by row: row k of A[m*n] is left as [R^T | vector k], diag[k] and beta[k] beside it; order[m]: which row
 * stands where; scale[m]: what each was divided by. Returns the rank: a row of which less than eps^(2/3), or eps^(1/3) where it is
 * coarse, is independent of those before it does not count. */
static int lag_rank(int n, int m, int coarse, LAG_LANE *A, LAG_LANE *diag, LAG_LANE *beta, LAG_LANE *scale, LAG_LANE *order) {
  const LAG_LANE third = (LAG_LANE)4/3 - 1, eps = LAG_LANE_FN(fabs)(3*third - 1);
  const LAG_LANE root = LAG_LANE_FN(cbrt)(eps), least = coarse ? root : root*root;
  int rank = 0;
  for (int j = 0; j < m; j++) {
    LAG_LANE *const row = A + j*n, size = 0;
    for (int i = 0; i < n; i++) size = LAG_LANE_FN(fabs)(row[i]) > size ? LAG_LANE_FN(fabs)(row[i]) : size;
    scale[j] = size > 0 ? size : 1;
    order[j] = (LAG_LANE)j;
    for (int i = 0; i < n; i++) row[i] /= scale[j];
  }
  for (int k = 0; k < m && k < n; k++) {
    LAG_LANE most = 0;
    int top = k;
    for (int j = k; j < m; j++) {
      LAG_LANE s = 0;
      for (int i = k; i < n; i++) s += A[j*n + i]*A[j*n + i];
      if (s > most) most = s, top = j;
    }
    if (!(most > least*least)) break;
    for (int i = 0; i < n && top != k; i++) {
      const LAG_LANE was = A[k*n + i];
      A[k*n + i] = A[top*n + i];
      A[top*n + i] = was;
    }
    const LAG_LANE was = order[k], scaled = scale[k];
    order[k] = order[top], order[top] = was;
    scale[k] = scale[top], scale[top] = scaled;
    diag[k] = lag_reflector(n - k, A + k*n + k, &beta[k]);
    for (int j = k + 1; j < m; j++) lag_reflect(n - k, A + k*n + k, beta[k], A + j*n + k, 1);
    rank++;
  }
  return rank;
}

/* The multipliers mu[m], in the order of rows, with R (scaled back) mu = s[r] and of least norm; S[m*r] is scratch. */
static void lag_multipliers(int n, int m, int r, const LAG_LANE *A, const LAG_LANE *diag, const LAG_LANE *scale,
                            LAG_LANE *s, LAG_LANE *mu, LAG_LANE *S) {
  if (r == m) {
    for (int i = r - 1; i >= 0; i--) {
      mu[i] = s[i];
      for (int j = i + 1; j < m; j++) mu[i] -= A[j*n + i]*mu[j];
      mu[i] /= diag[i];
    }
    for (int i = 0; i < m; i++) mu[i] /= scale[i];
    return;
  }
  LAG_LANE *const top = S + m*r, *const beta = top + r;
  for (int i = 0; i < r; i++)
    for (int j = 0; j < m; j++) S[i*m + j] = j < i ? 0 : (j == i ? diag[i] : A[j*n + i])*scale[j];
  for (int k = 0; k < r; k++) {
    top[k] = lag_reflector(m - k, S + k*m + k, &beta[k]);
    for (int i = k + 1; i < r; i++) lag_reflect(m - k, S + k*m + k, beta[k], S + i*m + k, 1);
  }
  for (int i = 0; i < r; i++) {
    mu[i] = s[i];
    for (int k = 0; k < i; k++) mu[i] -= S[i*m + k]*mu[k];
    mu[i] /= top[i];
  }
  for (int j = r; j < m; j++) mu[j] = 0;
  for (int k = r - 1; k >= 0; k--) lag_reflect(m - k, S + k*m + k, beta[k], mu + k, 1);
}

/* x[n], l[m] hold f and g, and become the solution; M and A are destroyed. w[m*m + 9*m] is scratch. Returns whether M is regular on
 * the kernel of A. */
static int lag_kkt_lane(int n, int m, int coarse, LAG_LANE *M, LAG_LANE *A, LAG_LANE *x, LAG_LANE *l, LAG_LANE *w) {
  LAG_LANE *const diag = w, *const beta = w + m, *const scale = w + 2*m, *const order = w + 3*m;
  LAG_LANE *const y = w + 4*m, *const s = w + 5*m, *const mu = w + 6*m, *const S = w + 7*m;
  const int r = lag_rank(n, m, coarse, A, diag, beta, scale, order);
  for (int k = 0; k < r; k++) {
    y[k] = l[(int)order[k]]/scale[k];
    for (int i = 0; i < k; i++) y[k] -= A[k*n + i]*y[i];
    y[k] /= diag[k];
  }
  for (int k = 0; k < r; k++) {
    const LAG_LANE *const v = A + k*n + k;
    lag_reflect(n - k, v, beta[k], x + k, 1);
    for (int i = 0; i < n; i++) lag_reflect(n - k, v, beta[k], M + i*n + k, 1);
    for (int i = 0; i < n; i++) lag_reflect(n - k, v, beta[k], M + k*n + i, n);
  }
  for (int i = 0; i < r; i++) s[i] = -x[i];
  for (int i = 0; i < n; i++)
    for (int k = 0; k < r; k++) *(i < r ? &s[i] : &x[i]) += (i < r ? 1 : -1)*M[i*n + k]*y[k];
  for (int k = r; k < n; k++) { /* elimination with partial pivoting of what is left of M */
    int top = k;
    for (int i = k + 1; i < n; i++)
      if (LAG_LANE_FN(fabs)(M[i*n + k]) > LAG_LANE_FN(fabs)(M[top*n + k])) top = i;
    if (!(LAG_LANE_FN(fabs)(M[top*n + k]) > 0)) return 0;
    for (int j = k; j <= n && top != k; j++) {
      LAG_LANE *const upper = j < n ? &M[k*n + j] : &x[k], *const lower = j < n ? &M[top*n + j] : &x[top];
      const LAG_LANE was = *upper;
      *upper = *lower;
      *lower = was;
    }
    for (int i = k + 1; i < n; i++) {
      const LAG_LANE factor = M[i*n + k]/M[k*n + k];
      for (int j = k + 1; j < n; j++) M[i*n + j] -= factor*M[k*n + j];
      x[i] -= factor*x[k];
    }
  }
  for (int k = n - 1; k >= r; k--) {
    for (int j = k + 1; j < n; j++) x[k] -= M[k*n + j]*x[j];
    x[k] /= M[k*n + k];
  }
  for (int i = 0; i < r; i++) {
    for (int k = r; k < n; k++) s[i] += M[i*n + k]*x[k];
    x[i] = y[i];
  }
  for (int k = r - 1; k >= 0; k--) lag_reflect(n - k, A + k*n + k, beta[k], x + k, 1);
  lag_multipliers(n, m, r, A, diag, scale, s, mu, S);
  for (int j = 0; j < m; j++) l[(int)order[j]] = mu[j];
  return 1;
}

#ifndef LAG_LANES
/* w = [M | A | f, becomes x | g, becomes l | scratch]. Returns whether M is regular on the kernel of A. */
static LAG_MASK lag_kkt(int n, int m, int coarse, LAG_REAL *w) {
  LAG_REAL *const A = w + n*n, *const x = A + m*n;
  return lag_kkt_lane(n, m, coarse, w, A, x, x + n, x + n + m);
}
#else
/* The same, lane by lane: each has pivots, and a rank, of its own. */
static LAG_MASK lag_kkt(int n, int m, int coarse, LAG_REAL *w) {
  const int used = n*n + m*n + n + m;
  LAG_MASK regular;
  for (int k = 0; k < LAG_LANES; k++) {
    LAG_LANE *const M = (LAG_LANE *)(w + used), *const A = M + n*n, *const x = A + m*n;
    for (int i = 0; i < used; i++) M[i] = w[i][k];
    regular[k] = lag_kkt_lane(n, m, coarse, M, A, x, x + n, x + n + m) ? -1 : 0;
    for (int i = 0; i < n + m; i++) w[n*n + m*n + i][k] = x[i];
  }
  return regular;
}
#endif
/* ---- end ---- */
#endif
