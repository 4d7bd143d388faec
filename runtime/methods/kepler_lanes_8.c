/* Bodies eight at a time (kepler_lanes.h), where the program finds AVX-512. */
#if defined(__GNUC__) && !defined(LAG_REAL) && defined(__x86_64__) && !(defined(__clang__) && !defined(__AVX512DQ__))
#ifndef __clang__
#pragma GCC target("avx512f,avx512dq")
#endif
#define LAG_LANES 8
#include "methods/kepler_moves.h"
KeplerMove *const lag_kepler_move_8 = kepler_move;
#else
#include "methods/kepler_lanes.h"
#include <stddef.h>
KeplerMove *const lag_kepler_move_8 = NULL;
#endif
