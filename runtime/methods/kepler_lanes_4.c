/* Bodies four at a time (kepler_lanes.h), where the program finds AVX2. */
#if defined(__GNUC__) && !defined(LAG_REAL) && defined(__x86_64__) && !(defined(__clang__) && !defined(__AVX2__))
#ifndef __clang__
#pragma GCC target("avx2")
#endif
#define LAG_LANES 4
#include "methods/kepler_moves.h"
KeplerMove *const lag_kepler_move_4 = kepler_move;
#else
#include "methods/kepler_lanes.h"
#include <stddef.h>
KeplerMove *const lag_kepler_move_4 = NULL;
#endif
