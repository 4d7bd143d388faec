/* coulomb.h: Coulomb's law at one contact or surface, and the step of Moreau's in which it acts. Includes scalar.h.
 *
 * Enters: a slip and its response to friction; a state. Leaves: friction by the law and the slip under it; the states
 * at the middle and at the end of the step. */
#ifndef LAG_COULOMB_H
#define LAG_COULOMB_H

#include "kernels/compensated_sum.h"

/* ---- friction ---- */

/* A number counts as larger, and as smaller, than none. */
static inline LAG_REAL lag_larger(LAG_REAL a, LAG_REAL b) { return LAG_SELECT(a >= b || !(b >= b), a, b); }
static inline LAG_REAL lag_smaller(LAG_REAL a, LAG_REAL b) { return LAG_SELECT(a <= b || !(b >= b), a, b); }
static inline int lag_is_number(LAG_REAL x) { return x - x >= LAG_C(0.0); }

/* Length of (a, b): C++ before 2011 has hypot of doubles only. */
static inline LAG_REAL lag_length_of(LAG_REAL a, LAG_REAL b) {
  const LAG_REAL x = LAG_FN(fabs)(a), y = LAG_FN(fabs)(b), most = lag_larger(x, y), part = lag_smaller(x, y)/most;
  return LAG_SELECT(most > LAG_C(0.0), most*LAG_FN(sqrt)(LAG_C(1.0) + part*part), most);
}

/* x := the point nearest to x[n] of a ball, n = 2, or an interval, n = 1. */
static inline void lag_into_ball(int n, const LAG_REAL *centre, LAG_REAL radius, LAG_REAL *x) {
  if (n == 1) {
    x[0] = lag_smaller(lag_larger(x[0], centre[0] - radius), centre[0] + radius);
    return;
  }
  const LAG_REAL far = lag_length_of(x[0] - centre[0], x[1] - centre[1]);
  for (int k = 0; k < n && far > radius; k++) x[k] = centre[k] + (x[k] - centre[k])*(radius/far);
}

/* Coulomb's law along n directions. response: of the slip to friction; friction drives the slip to the nearest point
 * of a ball about centre[n] if it is at most `holds`, or `turned` against a slip that turns round from before[n], else
 * it is that against it, and no more than `most`. */
typedef struct lag_coulomb {
  int n;
  LAG_REAL response, radius, holds, turned, most;
  const LAG_REAL *centre, *before;
} lag_coulomb;

/* slip[n]: now, under the friction x[n]. x := friction by the law; slip := what that leaves of it. */
static inline void lag_friction_turn(const lag_coulomb *of, LAG_REAL *slip, LAG_REAL *x) {
  const LAG_REAL origin[2] = {LAG_C(0.0), LAG_C(0.0)}, response = of->response;
  const int n = of->n;
  LAG_REAL to[2], size = LAG_C(0.0), back = LAG_C(0.0);
  for (int k = 0; k < n; k++) to[k] = slip[k] - response*x[k];
  lag_into_ball(n, of->centre, of->radius, to);
  for (int k = 0; k < n; k++) back += (to[k] - slip[k] + response*x[k])*of->before[k];
  for (int k = 0; k < n; k++) {
    x[k] += (to[k] - slip[k])/response;
    slip[k] = to[k];
  }
  if (n > 1) size = lag_length_of(x[0], x[1]);
  else size = LAG_FN(fabs)(x[0]);
  const LAG_REAL holds = LAG_SELECT(back > LAG_C(0.0), of->turned, of->holds);
  if (!(size > holds)) return;
  for (int k = 0; k < n; k++) to[k] = x[k];
  lag_into_ball(n, origin, lag_smaller(holds, of->most), x);
  for (int k = 0; k < n; k++) slip[k] += response*(x[k] - to[k]);
}

/* ---- mean ---- */

/* A step of Moreau's: states (q, v, z) at its begin, middle (with the velocities and states at which forces are taken)
 * and end; rates there, in the first turn, and sizes of their terms. is_explicit: forces depend on no velocity. */
typedef struct lag_kick {
  int nq, nz, is_explicit;
  LAG_REAL t, end, h, epsilon; /* times of the middle and of the end; rounding of LAG_REAL */
  const LAG_REAL *y;
  LAG_REAL *mid, *y1, *rate, *rate0, *size;
} lag_kick;

/* mid := y + part (y1 - y) for velocities and states. Returns its largest change, in units of rounding: of the largest
 * velocity, or of the state itself. */
static inline LAG_REAL lag_kick_mean(const lag_kick *s, LAG_REAL part) {
  const int nq = s->nq;
  const LAG_REAL *const y0 = s->y, *const y1 = s->y1;
  LAG_REAL most = LAG_C(0.0), fastest = LAG_C(0.0);
  for (int i = nq; i < 2*nq; i++) {
    const LAG_REAL v0 = LAG_FN(fabs)(y0[i]), v1 = LAG_FN(fabs)(y1[i]);
    fastest = lag_larger(fastest, lag_larger(LAG_FN(fabs)(s->h*s->size[i]), lag_larger(v0, v1)));
  }
  for (int i = nq; i < 2*nq + s->nz; i++) {
    const LAG_REAL next = y0[i] + part*(y1[i] - y0[i]), own = LAG_FN(fabs)(y0[i]) + LAG_FN(fabs)(y1[i]);
    const LAG_REAL size = LAG_SELECT(i < 2*nq, fastest, own), was = s->mid[i];
    if (next < was || next > was) most = lag_larger(most, LAG_FN(fabs)(next - was)/(s->epsilon*size));
    s->mid[i] = next;
  }
  return most;
}

/* mid := the state from which the step from y begins; lost[nq]: rounding that positions have lost. */
static inline void lag_kick_begin(const lag_kick *s, const LAG_REAL *lost) {
  const int nq = s->nq;
  for (int i = 0; i < 2*nq + s->nz; i++) s->mid[i] = s->y1[i] = s->y[i];
  for (int i = 0; i < nq; i++) s->mid[i] = s->y[i] + (lost[i] + s->h/LAG_C(2.0)*s->y[nq + i]);
}

/* out := the end of the step, with compensated sums. */
static inline void lag_kick_end(const lag_kick *s, LAG_REAL *lost, LAG_REAL *out) {
  const int nq = s->nq;
  for (int i = 0; i < 2*nq + s->nz; i++) {
    const LAG_REAL d = i < nq ? s->h/LAG_C(2.0)*(s->y[nq + i] + s->y1[nq + i]) : s->y1[i] - s->y[i];
    out[i] = lag_compensated_sum(s->y[i], d, &lost[i]);
  }
}

/* ---- end ---- */
#endif
