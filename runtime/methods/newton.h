/* Newton's method for the equations of an implicit step: size of its corrections, and when to stop. */
#pragma once

#include <float.h>
#include <math.h>

enum { LAG_MOST_CORRECTIONS = 25 };

/* Size of a correction. part: its largest component relative to the motion over the step; rounding: its size where
 * rounding is to be told. */
typedef struct lag_correction {
  double part, rounding;
} lag_correction;

/* Correction du of a velocity u, relative to the motion over a step of this length; at most 1. q: the coordinate. */
static inline double lag_relative_correction(double length, double du, double u, double q) {
  double scale = length * fabs(u) + 0x1p-10 * fabs(q);
  return du == 0.0 ? 0 : fmin(length * fabs(du) / scale, 1);
}

/* The matrix is refreshed while corrections are large. */
static inline int lag_newton_needs_matrix(int turn, lag_correction before) { return turn == 0 || before.part > 1e-3; }

/* Whether the next correction would be below rounding (a fresh matrix squares errors, an old one contracts them at
 * the same rate), or corrections have stopped shrinking because they are rounding. */
static inline int lag_newton_has_converged(lag_correction now, lag_correction before, int fresh, int turn) {
  double next = fresh ? 1000 * now.part * now.part : now.part * (now.part / before.part);
  if (now.part == 0.0 || (next <= DBL_EPSILON / 16 && (fresh || now.part < before.part))) return 1;
  return turn > 0 && now.rounding >= before.rounding / 2 && now.rounding <= 1e-8;
}
