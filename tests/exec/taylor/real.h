/* The scalar of a test that is compiled for several: reading, printing, what it can tell apart. */
#ifndef TEST_TAYLOR_REAL_H
#define TEST_TAYLOR_REAL_H

#include <stdio.h>
#include <stdlib.h>

#include "lag_model.h"

typedef LAG_REAL Real;

#if defined(REAL_QUAD)
#define REAL_READ(text) strtoflt128(text, NULL)
#define REAL_EPSILON 1.93e-34L
#elif defined(REAL_LONG)
#define REAL_READ(text) strtold(text, NULL)
#define REAL_EPSILON 1.09e-19L
#else
#define REAL_READ(text) strtod(text, NULL)
#define REAL_EPSILON 2.23e-16L
#endif

static inline Real real_abs(Real x) { return x < 0 ? -x : x; }
static inline Real real_max(Real x, Real y) { return x > y ? x : y; }

#endif
