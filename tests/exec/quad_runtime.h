/* Included before each file of the runtime, this compiles it for quadruple precision: `double` becomes __float128, after
 * the system's headers have had theirs. Literals keep the 16 digits of a double: only what is computed, or short, is exact. */
#ifndef QUAD_RUNTIME_H
#define QUAD_RUNTIME_H

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <quadmath.h>

typedef long double quad_shown; /* what printf takes */
#define double __float128
#undef isfinite
#undef isnan
#undef NAN
#undef HUGE_VAL
#undef DBL_EPSILON
#undef DBL_MIN
#define isfinite finiteq
#define isnan isnanq
#define NAN ((__float128)__builtin_nan(""))
#define HUGE_VAL HUGE_VALQ
#define DBL_EPSILON FLT128_EPSILON
#define DBL_MIN FLT128_MIN
#define fabs fabsq
#define sqrt sqrtq
#define cbrt cbrtq
#define pow powq
#define sin sinq
#define cos cosq
#define log logq
#define log2 log2q
#define exp expq
#define hypot hypotq
#define fmax fmaxq
#define fmin fminq
#define floor floorq
#define ceil ceilq
#define lround lroundq
#define nextafter nextafterq
#define ldexp ldexpq
#define frexp frexpq
#define copysign copysignq

#endif
