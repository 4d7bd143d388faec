/* Splines through the rows of a table.
 *
 * One cubic an interval; value, slope and second derivative are continuous. End conditions "not a knot": the first
 * two intervals share one cubic, and so do the last two. So a cubic is reproduced exactly, and the error is of order
 * h^4 up to the ends (natural spline: h^2 there). Two rows give a straight line, three a parabola. C. de Boor, A
 * Practical Guide to Splines (Springer, 1978), chapter IV.
 *
 * Where the curve's derivatives are needed it is quintic, with four continuous derivatives, and the same end
 * conditions: the first three intervals share one quintic. Its second derivative has an error of order h^4, where a
 * cubic's has h^2. */
#pragma once

#include <stdint.h>

#include "base/arena.h"

/* row[i]: abscissa, value, second derivative. Abscissae increase. Outside them the value of the nearest row holds.
 * jet[i]: abscissa, value, first and second derivative of the quintic; NULL: the curve is the cubic. */
typedef struct {
  uint32_t n; /* at least 2 */
  const double (*row)[3];
  const double (*jet)[4];
} Spline;

enum { SPLINE_QUINTIC_ROWS = 6 }; /* a quintic needs as many */

/* Computes the second derivatives row[i][2] from n >= 1 abscissae and values. Returns 0 when one is not finite: rows
 * are too close, or values too far apart, for double precision. */
int spline_fit(Arena *a, double (*row)[3], uint32_t n);

/* Computes the derivatives of the quintic, jet[i][2] and jet[i][3], from n >= SPLINE_QUINTIC_ROWS abscissae and
 * values. Returns 0 as spline_fit. */
int spline_fit_quintic(Arena *a, double (*jet)[4], uint32_t n);

/* The value at x, by the formula that emitted code uses; of a quintic its derivative of this order, 0 to 2, which is
 * 0 outside the rows. */
long double spline_at(const Spline *s, int order, long double x);
