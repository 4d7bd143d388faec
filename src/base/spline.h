/* Cubic splines through the rows of a table.
 *
 * One cubic an interval; value, slope and second derivative are continuous. End conditions "not a knot": the first two intervals share one cubic, and
 * so do the last two. So a cubic is reproduced exactly, and the error is of order h^4 up to the ends (natural spline: h^2 there). Two rows give a
 * straight line, three a parabola. C. de Boor, A Practical Guide to Splines (Springer, 1978), chapter IV. */
#pragma once

#include <stdint.h>

#include "base/arena.h"

/* row[i]: abscissa, value, second derivative. Abscissae increase. Outside them the value of the nearest row holds. */
typedef struct {
  uint32_t n; /* at least 2 */
  const double (*row)[3];
} Spline;

/* Computes the second derivatives row[i][2] from n >= 1 abscissae and values. Returns 0 when one is not finite: rows are
 * too close, or values too far apart, for double precision. */
int spline_fit(Arena *a, double (*row)[3], uint32_t n);

/* The value at x, by the formula that emitted code uses. */
long double spline_at(const Spline *s, long double x);
