/* lag_support.h: functions that models of some kinds call: dense linear systems, curves through the rows of tables.
 * Includes lag_lanes.h. */
#ifndef LAG_SUPPORT_H
#define LAG_SUPPORT_H

#include "lag_lanes.h"

/* ---- solver: front ---- */
LAG_UNUSED static LAG_MASK lag_solve(int n, LAG_REAL *M, LAG_REAL *b);

/* ---- solver ---- */
/* M x = b by elimination with partial pivoting (Golub & Van Loan, Matrix Computations, 4th ed., algorithm 3.4.1):
 * M[n*n] row-major is destroyed, b becomes x. Rows are exchanged under a mask, so that each lane has its own pivots.
 * Returns whether M is regular, or has elements that are no numbers: then x has none. */
LAG_UNUSED static LAG_MASK lag_solve(int n, LAG_REAL *M, LAG_REAL *b) {
  LAG_MASK regular = LAG_C(0.0) == LAG_C(0.0);
  for (int k = 0; k < n; k++) {
    for (int i = k + 1; i < n; i++) { /* the largest element of column k is moved to row k */
      const LAG_REAL here = LAG_FN(fabs)(M[i*n + k]);
      const LAG_MASK larger = LAG_OR(here > LAG_FN(fabs)(M[k*n + k]), here != here);
      if (!LAG_ANY(larger)) continue;
      for (int j = k; j <= n; j++) {
        LAG_REAL *const upper = j < n ? &M[k*n + j] : &b[k], *const lower = j < n ? &M[i*n + j] : &b[i];
        const LAG_REAL was = *upper;
        *upper = LAG_SELECT(larger, *lower, was);
        *lower = LAG_SELECT(larger, was, *lower);
      }
    }
    regular = LAG_AND(regular, LAG_NOT(LAG_FN(fabs)(M[k*n + k]) <= LAG_C(0.0)));
    if (!LAG_ANY(regular)) break;
    for (int i = k + 1; i < n; i++) {
      const LAG_REAL factor = M[i*n + k]/M[k*n + k];
      for (int j = k + 1; j < n; j++) M[i*n + j] -= factor*M[k*n + j];
      b[i] -= factor*b[k];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    for (int j = k + 1; j < n; j++) b[k] -= M[k*n + j]*b[j];
    b[k] /= M[k*n + k];
  }
  return regular;
}

/* ---- interval ---- */
/* The interval of the first lane: of n rows of this width, which begin with a time. */
LAG_UNUSED static int lag_interval(LAG_REAL t, int n, int width, const LAG_LANE *row) {
  int k = 0;
  for (int end = n - 1; end - k > 1;) {
    const int mid = (k + end)/2;
    if (LAG_ANY(t < LAG_C(0.0) + row[width*mid])) end = mid;
    else k = mid;
  }
  return k;
}

/* ---- cubic: front ---- */
#define LAG_ROW(t, y, m) {(LAG_LANE)(t), (LAG_LANE)(y), (LAG_LANE)(m)}
LAG_UNUSED static LAG_REAL lag_spline(LAG_REAL t, int n, const LAG_LANE (*row)[3]);

/* ---- cubic ---- */
/* The cubic between two rows of time, value and second derivative; outside of them the nearest value. */
LAG_UNUSED static LAG_REAL lag_cubic(LAG_REAL t, const LAG_LANE *a, const LAG_LANE *b) {
  const LAG_LANE h = b[0] - a[0];
  const LAG_REAL part = (t - a[0])/h, zero = LAG_C(0.0), one = LAG_C(1.0);
  const LAG_REAL x = LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, one, part)), rest = one - x;
  return rest*a[1] + x*b[1]
       - x*rest*(h*h/(LAG_LANE)6)*((one + rest)*a[2] + (one + x)*b[2]);
}

/* The curve through n rows. Between the first and the last row it has two continuous derivatives. */
LAG_UNUSED static LAG_REAL lag_spline(LAG_REAL t, int n, const LAG_LANE (*row)[3]) {
  int k = lag_interval(t, n, 3, row[0]);
  LAG_REAL y = lag_cubic(t, row[k], row[k + 1]);
  for (k++; k < n - 1; k++) { /* lanes that are further on */
    const LAG_MASK later = t >= LAG_C(0.0) + row[k][0];
    if (!LAG_ANY(later)) break;
    y = LAG_SELECT(later, lag_cubic(t, row[k], row[k + 1]), y);
  }
  return y;
}

/* ---- quintic: front ---- */
#define LAG_JET(t, y, d, m) {(LAG_LANE)(t), (LAG_LANE)(y), (LAG_LANE)(d), (LAG_LANE)(m)}
LAG_UNUSED static LAG_REAL lag_curve(LAG_REAL t, int n, const LAG_LANE (*row)[4], int order);

/* ---- quintic ---- */
/* Derivative 0, 1 or 2 of the quintic between two rows of time, value, first and second derivative; outside of them
 * the nearest value, and 0. */
LAG_UNUSED static LAG_REAL lag_quintic(LAG_REAL t, int order, const LAG_LANE *a, const LAG_LANE *b) {
  const LAG_LANE h = b[0] - a[0], m = h*a[2], s = h*h*a[3], half = (LAG_LANE)1/(LAG_LANE)2;
  const LAG_LANE A = b[1] - a[1] - m - half*s, B = h*b[2] - m - s, C = h*h*b[3] - s;
  const LAG_LANE c3 = (LAG_LANE)10*A - (LAG_LANE)4*B + half*C, c4 = (LAG_LANE)7*B - (LAG_LANE)15*A - C;
  const LAG_LANE c5 = (LAG_LANE)6*A - (LAG_LANE)3*B + half*C;
  const LAG_REAL part = (t - a[0])/h, zero = LAG_C(0.0), one = LAG_C(1.0);
  const LAG_REAL x = LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, one, part));
  if (order == 0) return a[1] + x*(m + x*(half*s + x*(c3 + x*(c4 + x*c5))));
  const LAG_REAL d = order == 1 ? (m + x*(s + x*((LAG_LANE)3*c3 + x*((LAG_LANE)4*c4 + x*((LAG_LANE)5*c5)))))/h
                                : (s + x*((LAG_LANE)6*c3 + x*((LAG_LANE)12*c4 + x*((LAG_LANE)20*c5))))/(h*h);
  return LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, zero, d));
}

/* A derivative of the curve through n rows, which has four that are continuous. */
LAG_UNUSED static LAG_REAL lag_curve(LAG_REAL t, int n, const LAG_LANE (*row)[4], int order) {
  int k = lag_interval(t, n, 4, row[0]);
  LAG_REAL y = lag_quintic(t, order, row[k], row[k + 1]);
  for (k++; k < n - 1; k++) { /* lanes that are further on */
    const LAG_MASK later = t >= LAG_C(0.0) + row[k][0];
    if (!LAG_ANY(later)) break;
    y = LAG_SELECT(later, lag_quintic(t, order, row[k], row[k + 1]), y);
  }
  return y;
}

/* ---- end ---- */
#endif
