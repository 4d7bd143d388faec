/* splitting.h: a step of kicks and drifts by a table of composition.h. Enters: time, q, v and
 * their accelerations; leaves: q, v and the accelerations one step later. Holds: sums over steps
 * of q and v are compensated; a drift advances t with q, so that a force with explicit time keeps
 * the order. The map is symplectic where the forces have a potential.
 *
 * An instance defines before it includes this text:
 *   LAG_MODEL                 the first parameters of functions: the model with its inputs
 *   LAG_FORCES(t, q, v, a)    a status; a[n] := accelerations at t, q, v */
#ifndef LAG_SPLITTING_H
#define LAG_SPLITTING_H

#include "kernels/compensated_sum.h"
#include "kernels/composition.h"

#ifndef LAG_MODEL /* no instance: the text by itself */
#define LAG_MODEL const void *model
#define LAG_FORCES(t, q, v, a) ((void)model, (void)(t), (void)(q), (void)(v), (void)(a), 0)
#endif

/* ---- splitting ---- */

typedef struct lag_splitting {
  int n;                        /* coordinates */
  const LAG_REAL *q, *v, *a;    /* positions, velocities and accelerations at the begin */
  const LAG_REAL *lost;         /* [2n] rounding that q and v have lost */
  LAG_REAL *q1, *v1, *a1;       /* the same at stages and at the end */
  LAG_REAL *lost1;              /* [2n] at the end */
  const LAG_REAL *rate;         /* rates of q: v1, or for a Hamiltonian T(p) + V(q) where LAG_FORCES leaves dT/dp */
  LAG_REAL *dq, *dv;            /* scratch: increments */
} lag_splitting;

/* A step h from t to t1. Accelerations do not depend on velocities: those of the last stage serve
 * until the last kick. */
static inline int lag_split(LAG_MODEL, const lag_splitting *s, const lag_composition *c, LAG_REAL t, LAG_REAL t1,
                            LAG_REAL h) {
  const int n = s->n;
  const LAG_REAL *a = s->a;
  LAG_REAL *const dq = s->dq, *const dv = s->dv, *const q1 = s->q1, *const v1 = s->v1, *const lost1 = s->lost1;
  LAG_LANE at = LAG_COEF(0.0);
  int status = 0;
  for (int i = 0; i < n; i++) dq[i] = dv[i] = LAG_C(0.0);
  for (int k = 0; k < c->stages; k++) {
    const LAG_REAL kick = c->kick[k]*h, drift = c->drift[k]*h;
    for (int i = 0; i < n; i++) {
      dv[i] += kick*a[i];
      v1[i] = s->v[i] + (s->lost[n + i] + dv[i]);
    }
    if (s->rate != v1) {
      for (int i = 0; i < n; i++) q1[i] = s->q[i] + (s->lost[i] + dq[i]);
      LAG_TRY(LAG_FORCES(t + at*h, q1, v1, s->a1));
    }
    for (int i = 0; i < n; i++) {
      dq[i] += drift*s->rate[i];
      q1[i] = s->q[i] + (s->lost[i] + dq[i]);
    }
    at += c->drift[k];
    if (k < c->stages - 1) LAG_TRY(LAG_FORCES(t + at*h, q1, v1, s->a1));
    a = s->a1;
  }
  for (int i = 0; i < 2*n; i++) lost1[i] = s->lost[i];
  for (int i = 0; i < n; i++) q1[i] = lag_compensated_sum(s->q[i], dq[i], &lost1[i]);
  LAG_TRY(LAG_FORCES(t1, q1, v1, s->a1));
  for (int i = 0; i < n; i++) {
    dv[i] += c->kick[c->stages]*h*s->a1[i];
    v1[i] = lag_compensated_sum(s->v[i], dv[i], &lost1[n + i]);
  }
  return status;
}

/* ---- end ---- */
#endif
