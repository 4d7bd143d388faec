/* lag_kkt.h: accelerations, or changes of a state, under constraints. Includes lag_lanes.h.
 *
 *   M x - A^T l = f        M[n*n] symmetric, A[m*n]
 *   A x         = g
 *
 * for any A, of full rank or not, and any M that is regular on the kernel of A: x is then unique, and l the
 * multipliers of least norm (the sum of l_k^2, each in the unit of its constraint). Null space method (Benzi, Golub,
 * Liesen, Acta Numerica 14 (2005) 1, section 6, DOI 10.1017/S0962492904000212): A^T P = Q R by Householder
 * reflections with column pivoting (Golub & Van Loan, Matrix Computations, 4th ed. (2013), 5.4.2), where the part of
 * a constraint that is independent of those before it decides the rank. Rows and columns of the whole system are
 * scaled to about 1 first (lag_scales), so that units and factors of constraints do not matter. In the coordinates
 * Q^T x the first r components follow from g, the others from M without constraints; l is the least-norm solution of
 * R l = M x - f there, by a second factorization where r < m. Cheaper methods come first where they are as good:
 * Schur's complement where M is positive definite and the constraints are far from dependent; elimination within a
 * band for large systems.
 *
 * Near a position where constraints become dependent, a coarse rank is the right one for corrections of a state,
 * whose right-hand side is little more than rounding: with s the independence of the weakest constraint, a residual
 * of 1e-16 moves a position by 1e-16/s, and turns the directions which constraints allow by 1e-16/s^2.
 *
 * LAG_REAL may be a vector; LAG_LANE is its scalar. LAG_NO_BAND leaves the band out. */
#ifndef LAG_KKT_H
#define LAG_KKT_H

#include "lag_band.h"
#include "lag_lanes.h"

/* ---- kkt: front ---- */
static inline LAG_MASK lag_kkt(int n, int m, int coarse, LAG_REAL *w);

/* ---- listed: front ---- */
#ifndef LAG_NO_BAND
static inline LAG_MASK lag_kkt_listed(int n, int m, int coarse, const unsigned *at, int step, int count, LAG_REAL *w);
#endif

/* ---- kkt ---- */

/* The rounding unit DBL_EPSILON of LAG_LANE. */
static LAG_LANE lag_rounding(void) {
  const LAG_LANE third = (LAG_LANE)4/3 - 1;
  return LAG_LANE_FN(fabs)(3*third - 1);
}

/* x := x - beta v (v.x): Householder's reflection by v[n]. */
static void lag_reflect(int n, const LAG_LANE *v, LAG_LANE beta, LAG_LANE *x, int stride) {
  LAG_LANE s = 0;
  for (int i = 0; i < n; i++) s += v[i]*x[i*stride];
  s *= beta;
  for (int i = 0; i < n; i++) x[i*stride] -= s*v[i];
}

/* v[n] := the vector of the Householder reflection that maps v to (alpha, 0, ...), *beta its factor. Returns alpha. */
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

/* Elements of the rows of A and then of M, row-major, for lag_scales: row k has those from first[k] on, in the columns
 * col; diag: elements of M's diagonal; column j of A has elements at[down[j]] and on. first == 0: all are there. */
typedef struct lag_elements {
  int n, m;
  const int *first, *col, *row, *diag, *down, *at;
} lag_elements;

static int lag_row_from(const lag_elements *of, int k) { return of->first ? of->first[k] : k*of->n; }
static int lag_row_of(const lag_elements *of, int e) { return of->first ? of->row[e] : e/of->n; }
static int lag_column(const lag_elements *of, int k, int e) { return of->first ? of->col[e] : e - k*of->n; }
static int lag_diagonal(const lag_elements *of, int j) { return of->first ? of->diag[j] : (of->m + j)*of->n + j; }
static int lag_down_from(const lag_elements *of, int j) { return of->first ? of->down[j] : j*of->m; }
static int lag_down_at(const lag_elements *of, int j, int d) { return of->first ? of->at[d] : (d - j*of->m)*of->n + j; }

/* Exponent of the element x, 1e9 for a zero. */
static LAG_LANE lag_element_size(LAG_LANE x) {
  int e;
  (void)LAG_LANE_FN(frexp)(x, &e);
  return (x < 0 || x > 0) && x - x == 0 ? (LAG_LANE)e - (LAG_LANE)0.5 : (LAG_LANE)1e9;
}

/* Leaves elements out of size that the scales found so far make far smaller than the others: they pass zero, as the
 * sine of an angle does, and would turn the scales of all. */
static void lag_leave_small(const lag_elements *of, const LAG_LANE *scale, LAG_LANE *size) {
  const LAG_LANE none = (LAG_LANE)1e9, far = (LAG_LANE)-12;
  for (int k = 0; k < of->m + of->n; k++)
    for (int e = lag_row_from(of, k); e < lag_row_from(of, k + 1); e++)
      if (size[e] + scale[k] + scale[of->m + lag_column(of, k, e)] < far) size[e] = none;
}

/* top[m + n] := the largest of each row of A and of each column of [M; A], -1e9 where all are zeros. */
static void lag_largest_sizes(const lag_elements *of, const LAG_LANE *size, LAG_LANE *top) {
  const LAG_LANE none = (LAG_LANE)1e9;
  for (int k = 0; k < of->m + of->n; k++) top[k] = -none;
  for (int k = 0; k < of->m + of->n; k++)
    for (int e = lag_row_from(of, k); e < lag_row_from(of, k + 1); e++) {
      LAG_LANE *const column = top + of->m + lag_column(of, k, e);
      if (size[e] < none && size[e] > top[k]) top[k] = size[e];
      if (size[e] < none && size[e] > *column) *column = size[e];
    }
}

/* Range of the sizes of rows and columns of A. */
static LAG_LANE lag_constraint_range(const lag_elements *of, const LAG_LANE *top, const LAG_LANE *size) {
  const LAG_LANE none = (LAG_LANE)1e9;
  LAG_LANE least = none, most = -none;
  for (int k = 0; k < of->m; k++)
    least = top[k] > -none && top[k] < least ? top[k] : least, most = top[k] > most ? top[k] : most;
  for (int j = 0; j < of->n; j++) {
    LAG_LANE column = -none;
    for (int d = lag_down_from(of, j); d < lag_down_from(of, j + 1); d++) {
      const LAG_LANE here = size[lag_down_at(of, j, d)];
      column = here < none && here > column ? here : column;
    }
    least = column > -none && column < least ? column : least;
  }
  return most - least;
}

/* Range of inertia, which goes with the square of a coordinate's unit; far where a coordinate without inertia stands
 * beside elements that another unit of it would make lose half of their digits (bits: exponent of the rounding). */
static LAG_LANE lag_inertia_range(const lag_elements *of, int bits, const LAG_LANE *size) {
  const LAG_LANE none = (LAG_LANE)1e9;
  LAG_LANE light = none, heavy = -none;
  for (int j = 0; j < of->n; j++) {
    const LAG_LANE here = size[lag_diagonal(of, j)];
    LAG_LANE beside = -none;
    light = here < light ? here : light, heavy = here < none && here > heavy ? here : heavy;
    for (int d = lag_down_from(of, j); d < lag_down_from(of, j + 1) && !(here < none); d++) {
      const int own = lag_down_at(of, j, d), k = lag_row_of(of, own);
      for (int e = lag_row_from(of, k); e < lag_row_from(of, k + 1) && size[own] < none; e++)
        if (e != own && size[e] < none && size[e] - size[own] > beside) beside = size[e] - size[own];
    }
    if (beside < (LAG_LANE)(bits/2) && beside > (LAG_LANE)bits) light = -none;
  }
  return heavy - light;
}

/* Moves each scale to the best for the scales of the others; the largest move. */
static LAG_LANE lag_improve_scales(const lag_elements *of, const LAG_LANE *size, LAG_LANE *scale) {
  const LAG_LANE none = (LAG_LANE)1e9;
  const int m = of->m;
  LAG_LANE moved = 0;
  for (int k = 0; k < m + of->n; k++) {
    LAG_LANE sum = 0, weight = 0;
    for (int e = lag_row_from(of, k); e < lag_row_from(of, k + 1); e++) {
      /* diagonal: the scale enters twice */
      const int j = lag_column(of, k, e);
      const LAG_LANE here = size[e], twice = (LAG_LANE)(j == k - m ? 2 : 1), counts = (LAG_LANE)(j == k - m ? 16 : 1);
      if (here < none) sum += counts*twice*(here + (j == k - m ? 0 : scale[m + j])), weight += counts*twice*twice;
    }
    for (int d = k < m ? 0 : lag_down_from(of, k - m); k >= m && d < lag_down_from(of, k - m + 1); d++) {
      const int e = lag_down_at(of, k - m, d);
      if (size[e] < none) sum += size[e] + scale[lag_row_of(of, e)], weight += 1;
    }
    const LAG_LANE now = weight > 0 ? -sum/weight : 0, change = LAG_LANE_FN(fabs)(now - scale[k]);
    moved = change > moved ? change : moved;
    scale[k] = now;
  }
  return moved;
}

/* scale[m + n], powers of two, of the constraints and then of the coordinates: [M A^T; A 0], scaled by them, has
 * elements as near to 1 as least squares of their exponents allow (A. R. Curtis, J. K. Reid, IMA J. Appl. Math. 10
 * (1972) 118, DOI 10.1093/imamat/10.1.118). So ranks depend on no unit: another unit of a constraint or coordinate
 * changes its scale and nothing else. Elements that are rounding beside the largest of their row and column do not
 * count; inertia counts 16 times, so that a constraint that becomes dependent is seen to, and not scaled up. Where
 * ranges are small nothing is scaled, so nothing changes from call to call. size: lag_element_size of each element,
 * and top[m + n], are destroyed. */
static void lag_scales(const lag_elements *of, LAG_LANE *scale, LAG_LANE *top, LAG_LANE *size) {
  const int all = of->m + of->n;
  LAG_LANE moved = 1;
  int bits;
  (void)LAG_LANE_FN(frexp)(lag_rounding(), &bits);
  lag_largest_sizes(of, size, top);
  const int even = lag_constraint_range(of, top, size) <= 12 && lag_inertia_range(of, bits, size) <= 48;
  for (int k = 0; k < all; k++) scale[k] = even ? 1 : 0;
  if (even) return;
  for (int k = 0; k < all; k++)
    for (int e = lag_row_from(of, k); e < lag_row_from(of, k + 1); e++)
      if (2*size[e] < top[k] + top[of->m + lag_column(of, k, e)] + (LAG_LANE)(2*bits + 6)) size[e] = (LAG_LANE)1e9;
  for (int turn = 0, left = 0; turn < 40 && (moved > (LAG_LANE)0.1 || !left); turn++) {
    if (!(moved > (LAG_LANE)0.1)) lag_leave_small(of, scale, size), left = 1;
    moved = lag_improve_scales(of, size, scale);
  }
  for (int k = 0; k < all; k++)
    scale[k] = LAG_LANE_FN(ldexp)((LAG_LANE)1, (int)LAG_LANE_FN(floor)(scale[k] + (LAG_LANE)0.5));
}

/* QR factorization of A^T with column pivoting, A P = R^T Q^T, stored by rows: row k of A[m*n] becomes [R^T |
 * Householder vector k], with diag[k] and beta[k] beside it; order[m]: permutation of the rows; scale[m]: divisor of
 * each. Returns the rank: a row counts only if more than eps^(2/3) of it, or eps^(1/3) if coarse, is independent of
 * those before it. */
static int lag_rank(int n, int m, int coarse, LAG_LANE *A, LAG_LANE *diag, LAG_LANE *beta, LAG_LANE *scale,
                    LAG_LANE *order) {
  const LAG_LANE root = LAG_LANE_FN(cbrt)(lag_rounding()), least = coarse ? root : root*root;
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

/* mu[m] := the least-norm solution of R (scaled back) mu = s[r], in the order of rows; S[m*r] is scratch. */
static void lag_least_multipliers(int n, int m, int r, const LAG_LANE *A, const LAG_LANE *diag, const LAG_LANE *scale,
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

/* Index of the first, and of the last, element of x[n] that is not zero; none: n, and -1. */
static int lag_first(int n, const LAG_LANE *x) {
  int i = 0;
  while (i < n && !(x[i] < 0 || x[i] > 0)) i++;
  return i;
}

static int lag_last(int n, const LAG_LANE *x) {
  while (n > 0 && !(x[n - 1] < 0 || x[n - 1] > 0)) n--;
  return n - 1;
}

/* Cholesky's factorization within the envelope of M's lower triangle: L replaces M, row i begins at from[i]. Returns
 * whether each pivot is more than `least` of its diagonal element. */
static int lag_cholesky(int n, LAG_LANE *M, const LAG_LANE *from, LAG_LANE least) {
  for (int i = 0; i < n; i++) {
    const int begin = (int)from[i];
    for (int j = begin; j <= i; j++) {
      LAG_LANE s = M[i*n + j];
      const LAG_LANE was = s;
      for (int k = begin > (int)from[j] ? begin : (int)from[j]; k < j; k++) s -= M[i*n + k]*M[j*n + k];
      if (j == i && !(s > least*was)) return 0;
      M[i*n + j] = j == i ? LAG_LANE_FN(sqrt)(s) : s/M[j*n + j];
    }
  }
  return 1;
}

/* x := L^-1 x, where elements of x before `begin` are zero; and x := L^-T x. */
static void lag_forward(int n, const LAG_LANE *L, const LAG_LANE *from, int begin, LAG_LANE *x) {
  for (int i = begin; i < n; i++) {
    for (int k = (int)from[i] > begin ? (int)from[i] : begin; k < i; k++) x[i] -= L[i*n + k]*x[k];
    x[i] /= L[i*n + i];
  }
}

static void lag_backward(int n, const LAG_LANE *L, const LAG_LANE *from, LAG_LANE *x) {
  for (int i = n - 1; i >= 0; i--) {
    x[i] /= L[i*n + i];
    for (int k = (int)from[i]; k < i; k++) x[k] -= L[i*n + k]*x[i];
  }
}

/* L := Cholesky's factor of M, from[n]: where its rows begin. Returns whether M is positive definite by far. */
static int lag_factor_inertia(int n, const LAG_LANE *M, LAG_LANE *L, LAG_LANE *from) {
  for (int i = 0; i < n; i++) {
    if (!(M[i*n + i] > 0)) return 0;
    for (int j = 0; j <= i; j++) L[i*n + j] = M[i*n + j];
    from[i] = (LAG_LANE)lag_first(i, L + i*n);
  }
  return lag_cholesky(n, L, from, (LAG_LANE)1e-12);
}

/* Solves by Schur's complement S = A M^-1 A^T, with one step of refinement, if M is positive definite and the
 * constraints are far from dependent (a part of 1e-2 of each is independent of the others, so S has lost at most 4
 * digits). x and l hold f and g. Returns whether it has solved the system; M and A stay. w[n*n + m*n + m*m + 2*n +
 * 5*m] is scratch. The work follows the envelopes of M, L^-1 A^T and S: along a chain with coordinates in its order
 * it grows linearly. */
static int lag_schur(int n, int m, const LAG_LANE *M, const LAG_LANE *A, LAG_LANE *x, LAG_LANE *l, LAG_LANE *w) {
  LAG_LANE *const L = w, *const W = L + n*n, *const S = W + m*n, *const from = S + m*m, *const y = from + n;
  LAG_LANE *const begin = y + n, *const end = begin + m, *const row = end + m, *const mu = row + m,
                  *const rest = mu + m;
  if (m > n || !lag_factor_inertia(n, M, L, from)) return 0;
  for (int i = 0; i < n; i++) y[i] = x[i];
  for (int j = 0; j < m; j++) {
    for (int i = 0; i < n; i++) W[j*n + i] = A[j*n + i];
    begin[j] = (LAG_LANE)lag_first(n, W + j*n);
    lag_forward(n, L, from, (int)begin[j], W + j*n);
    end[j] = (LAG_LANE)lag_last(n, W + j*n);
    row[j] = (LAG_LANE)j;
    for (int k = j; k >= 0; k--) {
      LAG_LANE s = 0;
      const int a = (int)(begin[j] > begin[k] ? begin[j] : begin[k]), b = (int)(end[j] < end[k] ? end[j] : end[k]);
      for (int i = a; i <= b; i++) s += W[j*n + i]*W[k*n + i];
      S[j*m + k] = s;
      if (a <= b) row[j] = (LAG_LANE)k;
    }
  }
  if (!lag_cholesky(m, S, row, (LAG_LANE)1e-4)) return 0;
  lag_forward(n, L, from, 0, y);
  for (int j = 0; j < m; j++) {
    mu[j] = l[j];
    for (int i = (int)begin[j]; i <= (int)end[j]; i++) mu[j] -= W[j*n + i]*y[i];
    rest[j] = l[j];
    l[j] = 0;
  }
  for (int turn = 0; turn < 2; turn++) {
    lag_forward(m, S, row, 0, mu);
    lag_backward(m, S, row, mu);
    for (int j = 0; j < m; j++) {
      l[j] += mu[j];
      for (int i = (int)begin[j]; i <= (int)end[j]; i++) y[i] += mu[j]*W[j*n + i];
    }
    for (int i = 0; i < n; i++) x[i] = y[i];
    lag_backward(n, L, from, x);
    for (int j = 0; j < m && !turn; j++) {
      mu[j] = rest[j];
      for (int i = 0; i < n; i++) mu[j] -= A[j*n + i]*x[i];
    }
  }
  return 1;
}

/* Gaussian elimination with partial pivoting of the lower right block of M from row r: x and z := the solutions for
 * the right-hand sides x and z. Returns the largest |z| or |1/pivot|, a lower bound of the inverse, or -1 where a
 * pivot is 0. */
static LAG_LANE lag_eliminate(int n, int r, LAG_LANE *M, LAG_LANE *x, LAG_LANE *z) {
  LAG_LANE most = 0;
  for (int k = r; k < n; k++) {
    int top = k;
    for (int i = k + 1; i < n; i++)
      if (LAG_LANE_FN(fabs)(M[i*n + k]) > LAG_LANE_FN(fabs)(M[top*n + k])) top = i;
    if (!(LAG_LANE_FN(fabs)(M[top*n + k]) > 0)) return -1;
    for (int j = k; j < n + 2 && top != k; j++) {
      LAG_LANE *const upper = j < n    ? &M[k * n + j]
                              : j == n ? &x[k]
                                       : &z[k],
                      *const lower = j < n    ? &M[top * n + j]
                                     : j == n ? &x[top]
                                              : &z[top];
      const LAG_LANE was = *upper;
      *upper = *lower;
      *lower = was;
    }
    for (int i = k + 1; i < n; i++) {
      const LAG_LANE factor = M[i*n + k]/M[k*n + k];
      for (int j = k + 1; j < n; j++) M[i*n + j] -= factor*M[k*n + j];
      x[i] -= factor*x[k];
      z[i] -= factor*z[k];
    }
  }
  for (int k = n - 1; k >= r; k--) {
    for (int j = k + 1; j < n; j++) x[k] -= M[k*n + j]*x[j], z[k] -= M[k*n + j]*z[j];
    x[k] /= M[k*n + k];
    z[k] /= M[k*n + k];
    const LAG_LANE here = LAG_LANE_FN(fabs)(z[k]), pivot = 1/LAG_LANE_FN(fabs)(M[k*n + k]);
    most = here > most ? here : most;
    most = pivot > most ? pivot : most;
  }
  return most;
}

/* Whether M or A has an element that is not finite: then x and l become NaN. */
static int lag_pass_nan(int n, int m, const LAG_LANE *M, const LAG_LANE *A, LAG_LANE *x, LAG_LANE *l) {
  LAG_LANE any = 0;
  for (int i = 0; i < n*n + m*n; i++) any += (i < n*n ? M[i] : A[i - n*n])*0;
  for (int i = 0; i < n + m && !(any == 0); i++) *(i < n ? x + i : l + i - n) = any;
  return !(any == 0);
}

/* Multiplies coordinates by their units, in M, A and x; the largest element of M. */
static LAG_LANE lag_scale_columns(int n, int m, const LAG_LANE *unit, LAG_LANE *M, LAG_LANE *A, LAG_LANE *x) {
  LAG_LANE most = 0;
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      M[i*n + j] *= unit[i]*unit[j];
      most = LAG_LANE_FN(fabs)(M[i*n + j]) > most ? LAG_LANE_FN(fabs)(M[i*n + j]) : most;
    }
    for (int j = 0; j < m; j++) A[j*n + i] *= unit[i];
    x[i] *= unit[i];
  }
  return most;
}

/* x[n], l[m] hold f and g, and become the solution; NaN where M or A has an element that is not finite. M and A are
 * destroyed. w[n*n + m*n + m*m + 2*n + 9*m] is scratch. Returns whether M is regular on the kernel of A, by more
 * than rounding: pivots and the solution for an arbitrary right-hand side bound the inverse from below (J. D. Dixon,
 * SIAM J. Numer. Anal. 20 (1983) 812, DOI 10.1137/0720053); its norm times the rounding of M is to be below a
 * hundredth. */
static int lag_kkt_rows(int n, int m, int coarse, LAG_LANE *M, LAG_LANE *A, LAG_LANE *x, LAG_LANE *l, LAG_LANE *w) {
#ifdef LAG_BAND_LEAST
  const lag_entries whole = {0, 0, 0, 0, 0};
  if (n + m >= LAG_BAND_LEAST && lag_banded(n, m, M, A, &whole, x, l, w, n*n + m*n + m*m + 2*n + 9*m)) return 1;
#endif
  if (lag_schur(n, m, M, A, x, l, w)) return 1;
  if (lag_pass_nan(n, m, M, A, x, l)) return 1;
  LAG_LANE *const diag = w, *const beta = w + m, *const scale = w + 2*m, *const order = w + 3*m;
  LAG_LANE *const y = w + 4 * m, *const s = w + 5 * m, *const mu = w + 6 * m, *const S = w + 7 * m,
                  *const z = S + m * m + m, *const unit = z + n + m;
  const lag_elements all = {n, m, 0, 0, 0, 0, 0, 0};
  for (int e = 0; e < (m + n)*n; e++) unit[n + e] = lag_element_size(e < m*n ? A[e] : M[e - m*n]);
  lag_scales(&all, unit - m, z - m, unit + n);
  const LAG_LANE most = lag_scale_columns(n, m, unit, M, A, x);
  (void)lag_any_side(n, z);
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
  const LAG_LANE inverse = lag_eliminate(n, r, M, x, z);
  if (!(inverse >= 0 && inverse*most*(LAG_LANE)n*lag_rounding() < (LAG_LANE)0.01)) return 0;
  for (int i = 0; i < r; i++) {
    for (int k = r; k < n; k++) s[i] += M[i*n + k]*x[k];
    x[i] = y[i];
  }
  for (int k = r - 1; k >= 0; k--) lag_reflect(n - k, A + k*n + k, beta[k], x + k, 1);
  for (int i = 0; i < n; i++) x[i] *= unit[i];
  lag_least_multipliers(n, m, r, A, diag, scale, s, mu, S);
  for (int j = 0; j < m; j++) l[(int)order[j]] = mu[j];
  return 1;
}

/* l[m] := the first multipliers l[kept], each at its row; those of other rows are 0. */
static void lag_spread(int m, int kept, const LAG_LANE *row, LAG_LANE *l) {
  for (int j = m - 1, k = kept - 1; kept < m && j >= 0; j--) {
    const int here = k >= 0 && (int)row[k] == j;
    l[j] = here ? l[k] : 0;
    k -= here;
  }
}

/* The same without rows of A that are 0, as of contacts that are open: their multipliers are 0. */
static int lag_kkt_lane(int n, int m, int coarse, LAG_LANE *M, LAG_LANE *A, LAG_LANE *x, LAG_LANE *l, LAG_LANE *w) {
  LAG_LANE *const row = w + n*n + m*n + m*m + 2*n + 8*m; /* [m]; fewer rows need less scratch */
  int kept = 0;
  for (int j = 0; j < m; j++) {
    int i = 0;
    while (i < n && A[j*n + i] == 0) i++;
    if (i == n) continue;
    for (i = 0; i < n && kept < j; i++) A[kept*n + i] = A[j*n + i];
    l[kept] = l[j];
    row[kept++] = (LAG_LANE)j;
  }
  const int regular = lag_kkt_rows(n, kept, coarse, M, A, x, l, w);
  lag_spread(m, kept, row, l);
  return regular;
}

#ifndef LAG_LANES
/* w = [M | A | f, becomes x | g, becomes l | scratch]. Returns whether M is regular on the kernel of A. */
static inline LAG_MASK lag_kkt(int n, int m, int coarse, LAG_REAL *w) {
  LAG_REAL *const A = w + n*n, *const x = A + m*n;
  return lag_kkt_lane(n, m, coarse, w, A, x, x + n, x + n + m);
}
#else
/* lag_kkt lane by lane: each has its own pivots and rank. */
static inline LAG_MASK lag_kkt(int n, int m, int coarse, LAG_REAL *w) {
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

/* ---- listed ---- */
#ifndef LAG_NO_BAND
/* lag_kkt for a large system: [M | A] in w holds its elements at rising positions at[step*k], k < count, alone; others
 * are taken for 0. Positions behind A do not count. Within a band the work follows their number. */
#ifndef LAG_LANES
static inline LAG_MASK lag_kkt_listed(int n, int m, int coarse, const unsigned *at, int step, int count, LAG_REAL *w) {
  LAG_REAL *const A = w + n*n, *const x = A + m*n, *const l = x + n, *const s = l + m;
  LAG_REAL *const number = s + n*n + m*n + m*m + 2*n + 7*m, *const row = number + m;
  int kept = 0;
  while (count > 0 && at[step*(count - 1)] >= (unsigned)(n*n + m*n)) count--;
  const lag_entries of = {at, step, count, number, row};
  for (int j = 0; j < m; j++) number[j] = -1;
  for (int k = 0; k < count; k++) {
    const int here = (int)at[step*k];
    if (here >= n*n && (w[here] < 0 || w[here] > 0)) number[(here - n*n)/n] = 1;
  }
  for (int j = 0; j < m; j++) {
    if (number[j] < 0) continue;
    l[kept] = l[j];
    row[kept] = (LAG_REAL)j;
    number[j] = (LAG_REAL)kept++;
  }
  const int solved =
      n + kept >= LAG_BAND_LEAST && lag_banded(n, kept, w, A, &of, x, l, s, n*n + m*n + m*m + 2*n + 7*m);
  lag_spread(m, kept, row, l);
  if (solved) return 1;
  for (int k = 0, i = 0; i < n*n + m*n; i++) {
    if (k < count && at[step*k] == (unsigned)i) k++;
    else w[i] = 0;
  }
  return lag_kkt(n, m, coarse, w);
}
#else
static inline LAG_MASK lag_kkt_listed(int n, int m, int coarse, const unsigned *at, int step, int count, LAG_REAL *w) {
  for (int k = 0, i = 0; i < n*n + m*n; i++) {
    if (k < count && at[step*k] == (unsigned)i) k++;
    else w[i] = LAG_C(0.0);
  }
  return lag_kkt(n, m, coarse, w);
}
#endif
#endif
/* ---- end ---- */
#endif
