/* hermite.h: a state within a step. Enters: y and f = y' at both ends; leaves: y between. Needs no library.
 *
 * For q three derivatives are known at each end (q, v, a): quintic. For v and z two: cubic (E. Hairer, S. Norsett, G. Wanner, Solving Ordinary
 * Differential Equations I, II.6, eq. 6.7). v is not the derivative of q's quintic: that would magnify errors of q by 1/h.
 *
 * The runtime's lag_hermite is an instance; lagc copies the section below into headers whose steps end at events. */
#ifndef LAG_HERMITE_H
#define LAG_HERMITE_H

#ifndef LAG_REAL
#define LAG_REAL double
#endif
#ifndef LAG_C
#define LAG_C(x) x
#endif

/* ---- hermite ---- */

typedef struct lag_step_ends {
  LAG_REAL h;
  const LAG_REAL *y0, *f0, *y1, *f1; /* q, v, z and their rates */
} lag_step_ends;

/* q at s of the step, 0 to 1, for coordinate i of nq. */
static inline LAG_REAL lag_quintic(const lag_step_ends *e, LAG_REAL s, int i, int nq) {
  const LAG_REAL h = e->h, h2 = h*h, half = LAG_C(0.5), v0 = e->y0[nq + i], a0 = e->f0[nq + i];
  const LAG_REAL d = e->y1[i] - e->y0[i] - h*v0 - half*h2*a0; /* change of position beyond q0, v0, a0 */
  const LAG_REAL r = h*(e->y1[nq + i] - v0) - h2*a0;          /* change of velocity beyond a0, times h */
  const LAG_REAL f = h2*(e->f1[nq + i] - a0);                 /* change of acceleration, times h^2 */
  const LAG_REAL c3 = LAG_C(10.0)*d - LAG_C(4.0)*r + half*f, c4 = -LAG_C(15.0)*d + LAG_C(7.0)*r - f, c5 = LAG_C(6.0)*d - LAG_C(3.0)*r + half*f;
  return e->y0[i] + s*(h*v0 + s*(half*h2*a0 + s*(c3 + s*(c4 + s*c5))));
}

/* y[2*nq + nz] := the state at s of the step, 0 to 1. */
static inline void lag_state_within(const lag_step_ends *e, int nq, int nz, LAG_REAL s, LAG_REAL *y) {
  for (int i = 0; i < nq; i++) y[i] = lag_quintic(e, s, i, nq);
  for (int i = nq; i < 2*nq + nz; i++) {
    const LAG_REAL d = e->y1[i] - e->y0[i], r = LAG_C(1.0) - s;
    y[i] = e->y0[i] + s*(d + r*(r*(e->h*e->f0[i] - d) + s*(d - e->h*e->f1[i])));
  }
}

/* ---- end ---- */
#endif
