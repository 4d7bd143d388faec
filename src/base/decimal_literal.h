/* Decimal literals with more digits than a double has, for programs in long double or quadruple precision. */
#ifndef LAGC_BASE_DECIMAL_LITERAL_H
#define LAGC_BASE_DECIMAL_LITERAL_H

#include "base/arena.h"
#include "base/num.h"

/* x*pi^pi_power as a decimal literal, exact where it has at most 40 digits, else cut after 40. NULL where x is no exact
 * rational, its denominator is above 10^18, or pi_power is not -1, 0 or 1. */
const char *decimal_literal(Arena *a, Num x, int pi_power);

#endif
