/* hold.h: Newton's method onto constraints, of positions or of velocities, each lane by itself. Enters: a state near
 * the constraints; leaves: one on them up to rounding. Holds: residuals that are 0 leave the state as it is, bit by
 * bit.
 *
 * An instance defines before it includes this text:
 *   LAG_HOLD_MODEL                   the first parameters of functions: the model, its state, the room of the instance
 *   LAG_HOLD_RESIDUALS(turn, g)      a status; g[n] := minus the residuals
 *   LAG_HOLD_CHANGE(g, d)           a status; d[nq] := the least change by which the constraints change by g
 *   LAG_HOLD_ROUNDING(x, d, left)    whether the part `left` of d is rounding of x
 *   LAG_HOLD_MET(done)               whether residuals that shrink no more are rounding; done: the correction is */
#ifndef LAG_HOLD_H
#define LAG_HOLD_H

#include "kernels/compensated_sum.h"

#ifndef LAG_HOLD_MODEL /* no instance: the text by itself */
#define LAG_HOLD_MODEL const void *model
#define LAG_HOLD_RESIDUALS(turn, g) ((void)model, (void)(turn), (void)(g), 0)
#define LAG_HOLD_CHANGE(g, d) ((void)(g), (void)(d), 0)
#define LAG_HOLD_ROUNDING(x, d, left) ((void)(x), (void)(d), (left) < LAG_C(0.0))
#define LAG_HOLD_MET(done) (done)
#endif

/* ---- hold ---- */

/* n constraints of x[nq]; lost[nq]: rounding that x has lost, or 0; scratch: minus the residuals, their sizes, the
 * last correction. */
typedef struct lag_held_level {
  int n, nq;
  LAG_REAL *x, *lost, *g, *size, *d;
} lag_held_level;

/* Adds the corrections of the lanes in `on`. */
static inline void lag_hold_move(const lag_held_level *w, LAG_MASK on) {
  for (int i = 0; i < w->nq; i++) {
    LAG_REAL rest = w->lost ? w->lost[i] : LAG_C(0.0);
    const LAG_REAL sum = lag_compensated_sum(w->x[i], w->d[i], &rest);
    w->x[i] = LAG_SELECT(on, sum, w->x[i]);
    if (w->lost) w->lost[i] = LAG_SELECT(on, rest, w->lost[i]);
  }
}

/* Sizes of the residuals. Returns their sum; *most, *least: of their ratios to those of the turn before. */
static inline LAG_REAL lag_hold_sizes(const lag_held_level *w, int turn, LAG_REAL *most, LAG_REAL *least) {
  const LAG_REAL zero = LAG_C(0.0);
  LAG_REAL sum = zero;
  *most = zero;
  *least = LAG_C(1.0);
  for (int k = 0; k < w->n; k++) {
    const LAG_REAL now = LAG_FN(fabs)(w->g[k]), part = turn ? LAG_SELECT(now > zero, now/w->size[k], zero) : zero;
    *most = LAG_SELECT(part > *most, part, *most);
    *least = LAG_SELECT(LAG_AND(now > zero, part < *least), part, *least);
    w->size[k] = now;
    sum += now;
  }
  return sum;
}

/* At most 20 corrections, and two that lead no nearer. *unmet: lanes that are not moved; then also those whose
 * constraints no small change satisfies. */
static inline int lag_hold_turns(LAG_HOLD_MODEL, const lag_held_level *w, LAG_MASK *unmet) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), half = LAG_C(0.5), strikes = LAG_C(3.0);
  LAG_REAL vain = zero, most, least;
  LAG_MASK on = LAG_NOT(*unmet);
  int status = 0;
  for (int turn = 0;; turn++) {
    LAG_TRY(LAG_HOLD_RESIDUALS(turn, w->g));
    const LAG_REAL sum = lag_hold_sizes(w, turn, &most, &least);
    *unmet = LAG_OR(*unmet, LAG_AND(on, LAG_NOT(sum >= zero)));
    on = LAG_AND(LAG_AND(on, sum > zero), LAG_NOT(LAG_FAILED(status)));
    if (turn && LAG_ANY(on)) {
      const LAG_MASK done = LAG_HOLD_ROUNDING(w->x, w->d, most), stops = LAG_AND(done, most < half);
      const LAG_MASK judged = LAG_AND(on, LAG_AND(LAG_NOT(stops), LAG_OR(done, LAG_NOT(least < half))));
      const LAG_MASK met = LAG_AND(judged, LAG_ANY(judged) ? LAG_HOLD_MET(done) : judged);
      vain = LAG_SELECT(LAG_AND(judged, LAG_NOT(met)), vain + one, vain);
      *unmet = LAG_OR(*unmet, LAG_AND(on, vain >= strikes));
      on = LAG_AND(LAG_AND(on, LAG_NOT(LAG_OR(stops, met))), vain < strikes);
    }
    if (!LAG_ANY(on)) return status;
    if (turn == 20) {
      *unmet = LAG_OR(*unmet, LAG_AND(on, LAG_NOT(LAG_HOLD_MET(on))));
      return status;
    }
    LAG_TRY(LAG_WHERE(on, LAG_HOLD_CHANGE(w->g, w->d)));
    lag_hold_move(w, on);
  }
}

/* ---- end ---- */
#endif
