/* dense_output.h: a state within a step. Enters: y = (q, v, z) and its rates at both ends; leaves: y
 * between. Needs no library. lag_hermite, dop853 and moreau of the runtime are instances; lagc copies
 * the sections below into headers whose steps end at events. */
#ifndef LAG_DENSE_OUTPUT_H
#define LAG_DENSE_OUTPUT_H

#include "kernels/scalar.h"

/* ---- ends ---- */

typedef struct lag_step_ends {
  LAG_REAL h;
  const LAG_REAL *y0, *f0, *y1, *f1; /* states and their rates */
} lag_step_ends;

/* ---- hermite ---- */

/* q at s of the step, 0 to 1, for coordinate i of nq, from (q, v, a) at both ends. */
static inline LAG_REAL lag_quintic(const lag_step_ends *e, LAG_REAL s, int i, int nq) {
  const LAG_REAL h = e->h, h2 = h*h, half = LAG_C(0.5), v0 = e->y0[nq + i], a0 = e->f0[nq + i];
  const LAG_REAL d = e->y1[i] - e->y0[i] - h*v0 - half*h2*a0; /* change of position beyond q0, v0, a0 */
  const LAG_REAL r = h*(e->y1[nq + i] - v0) - h2*a0;          /* change of velocity beyond a0, times h */
  const LAG_REAL f = h2*(e->f1[nq + i] - a0);                 /* change of acceleration, times h^2 */
  const LAG_REAL c3 = LAG_C(10.0)*d - LAG_C(4.0)*r + half*f, c4 = -LAG_C(15.0)*d + LAG_C(7.0)*r - f;
  const LAG_REAL c5 = LAG_C(6.0)*d - LAG_C(3.0)*r + half*f;
  return e->y0[i] + s*(h*v0 + s*(half*h2*a0 + s*(c3 + s*(c4 + s*c5))));
}

/* y[2*nq + nz] := the state at s of the step, 0 to 1: quintic for q, cubic for v and z (E. Hairer,
 * S. Norsett, G. Wanner, Solving Ordinary Differential Equations I, II.6, eq. 6.7). v is not the
 * derivative of q's quintic: that would magnify errors of q by 1/h. */
static inline void lag_hermite_within(const lag_step_ends *e, int nq, int nz, LAG_REAL s, LAG_REAL *y) {
  for (int i = 0; i < nq; i++) y[i] = lag_quintic(e, s, i, nq);
  for (int i = nq; i < 2*nq + nz; i++) {
    const LAG_REAL d = e->y1[i] - e->y0[i], r = LAG_C(1.0) - s;
    y[i] = e->y0[i] + s*(d + r*(r*(e->h*e->f0[i] - d) + s*(d - e->h*e->f1[i])));
  }
}

/* ---- contd8 ---- */

/* y[n] := the state at s of a step of dop853, of order 7, with the four highest terms high[4*row]:
 * HNW II.6, code dop853, function contd8. */
static inline void lag_contd8(const lag_step_ends *e, const LAG_REAL *high, int n, int row, LAG_REAL s, LAG_REAL *y) {
  const LAG_REAL r = LAG_C(1.0) - s;
  for (int i = 0; i < n; i++) {
    const LAG_REAL diff = e->y1[i] - e->y0[i], b = e->h*e->f0[i] - diff, c = diff - e->h*e->f1[i] - b;
    const LAG_REAL d = high[i] + s*(high[row + i] + r*(high[2*row + i] + s*high[3*row + i]));
    y[i] = e->y0[i] + s*(diff + r*(b + s*(c + r*e->h*d)));
  }
}

/* ---- parabola ---- */

/* y[2*nq + nz] := the state x after the begin of a step by moreau: the parabola through both ends;
 * about an impact, those with the acceleration of forces alone, f0, which meet in the middle. */
static inline void lag_parabola_within(const lag_step_ends *e, int struck, int nq, int nz, LAG_REAL x, LAG_REAL *y) {
  const LAG_REAL two = LAG_C(2.0), left = x - e->h;
  const int late = struck && x >= e->h/two;
  for (int i = 0; i < nq; i++) {
    const LAG_REAL v0 = e->y0[nq + i], v1 = e->y1[nq + i], a = struck ? e->f0[nq + i] : (v1 - v0)/e->h;
    y[i] = late ? e->y1[i] + left*(v1 + left/two*a) : e->y0[i] + x*(v0 + x/two*a);
    y[nq + i] = late ? v1 + left*a : v0 + x*a;
  }
  for (int i = 2*nq; i < 2*nq + nz; i++) y[i] = e->y0[i] + x/e->h*(e->y1[i] - e->y0[i]);
}

/* ---- end ---- */
#endif
