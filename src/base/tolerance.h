/* Tolerances of computations in long double: written for its 64 bits of mantissa, larger in proportion to rounding
 * where it has fewer, the same where it has more, so that verdicts do not depend on the machine. Tolerances of 1e-13
 * and more are above the rounding of 53 bits, and stand bare. */
#pragma once

#include <float.h>

#define LONG_TOLERANCE(x) (LDBL_EPSILON > 0x1p-63L ? (x) * (LDBL_EPSILON / 0x1p-63L) : (x))
