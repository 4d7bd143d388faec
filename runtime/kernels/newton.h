/* newton.h: Newton's method for the equations of an implicit step: size of its corrections, and when to stop. Includes
 * scalar.h. */
#ifndef LAG_NEWTON_H
#define LAG_NEWTON_H

#include "kernels/scalar.h"

/* ---- newton ---- */

enum { LAG_MOST_CORRECTIONS = 25 };

/* Size of a correction. part: its largest component relative to the motion over the step; rounding: its size where
 * rounding is to be told. */
typedef struct lag_correction {
  LAG_REAL part, rounding;
} lag_correction;

/* Correction du of a velocity u, relative to the motion over a step of this length; at most 1. q: the coordinate. */
static inline LAG_REAL lag_relative_correction(LAG_REAL length, LAG_REAL du, LAG_REAL u, LAG_REAL q) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  const LAG_REAL scale = length*LAG_FN(fabs)(u) + LAG_C(0.0009765625)*LAG_FN(fabs)(q);
  const LAG_REAL size = length*LAG_FN(fabs)(du)/scale;
  return !(du < zero || du > zero || !(du - du >= zero)) ? zero : size < one ? size : one;
}

/* The matrix is refreshed while corrections are large. */
static inline int lag_newton_needs_matrix(int turn, lag_correction before) {
  return turn == 0 || before.part > LAG_C(1e-3);
}

/* Whether the next correction would be below rounding (a fresh matrix squares errors, an old one contracts them at
 * the same rate), or corrections have stopped shrinking because they are rounding, which is epsilon. */
static inline int lag_newton_has_converged(lag_correction now, lag_correction before, int fresh, int turn,
                                           LAG_REAL epsilon) {
  const LAG_REAL part = now.part, next = fresh ? LAG_C(1000.0)*part*part : part*(part/before.part);
  if (!(part > LAG_C(0.0)) || (next <= epsilon/LAG_C(16.0) && (fresh || part < before.part))) return 1;
  return turn > 0 && now.rounding >= before.rounding/LAG_C(2.0) && now.rounding <= LAG_C(1e-8);
}

/* ---- end ---- */
#endif
