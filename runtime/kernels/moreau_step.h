/* moreau_step.h: velocities and states over a step of Moreau's time-stepping. Enters: positions at its middle; leaves:
 * velocities and states at its end, with contacts and dry friction. Forces are those at the mean velocity; of a step
 * with an impact the mean of those at both ends, since the mean of velocities that jump is none that occurs.
 *
 * An instance defines before it includes this text:
 *   LAG_MODEL, LAG_THE_MODEL         the first parameters of functions: the model; the same as arguments
 *   LAG_LAWS                    type of contacts and friction in a step, w
 *   LAG_KICK_RATES(t, y, w, k)  a status; rates k
 *   LAG_RESPONSES(s, w, turn)   a status; responses to contacts and friction, once y1 is known without them
 *   LAG_OBEY(s, w)              a status; s->y1 := velocities and states with contacts and friction
 *   LAG_STRUCK(w)               whether the step has an impact
 *   LAG_ENOUGH(w, epsilon)      change of velocities, in roundings, that is enough once it falls by less than half
 *   LAG_TERM_SIZE(w, i, rate)   size of the terms of rate i
 *   LAG_KICK_FAILS(t)           status of a step whose forces change too much */
#ifndef LAG_MOREAU_STEP_H
#define LAG_MOREAU_STEP_H

#include "kernels/impulses.h"

/* ---- kick ---- */

static inline int lag_moreau_kick(LAG_MODEL, const lag_kick *s, LAG_LAWS *w) {
  const int nq = s->nq, n = 2*nq + s->nz;
  LAG_REAL before = -LAG_C(1.0);
  int status = 0;
  for (int turn = 0; turn < 100; turn++) {
    LAG_TRY(LAG_KICK_RATES(s->t, s->mid, w, s->rate));
    for (int i = 0; i < n && turn == 0; i++) s->rate0[i] = s->rate[i];
    for (int i = nq; i < n; i++) {
      if (LAG_STRUCK(w)) s->rate[i] = (s->rate0[i] + s->rate[i])/LAG_C(2.0);
      s->y1[i] = s->y[i] + s->h*s->rate[i];
    }
    LAG_TRY(LAG_RESPONSES(s, w, turn));
    LAG_TRY(LAG_OBEY(s, w));
    if (s->is_explicit) return status;
    for (int i = nq; i < n; i++) s->size[i] = LAG_TERM_SIZE(w, i, s->rate[i]);
    const LAG_REAL most = lag_kick_mean(s, LAG_STRUCK(w) ? LAG_C(1.0) : LAG_C(0.5));
    const int agrees = turn > 0 && most <= LAG_ENOUGH(w, s->epsilon) && most >= before/LAG_C(2.0);
    if (most <= LAG_C(8.0) || agrees) return status;
    before = most;
  }
  return LAG_KICK_FAILS(s->t);
}

/* ---- end ---- */
#endif
