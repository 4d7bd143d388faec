/* Steps of 8 runs at once, in vectors of 8 doubles: compiled for processors that have them, called where the program
 * finds one. Clang passes vectors as the file's flags say, whatever a function's target: it needs -mavx512f
 * -mavx512dq. */
#if defined(__GNUC__) && !defined(LAG_REAL) && defined(__x86_64__) && !(defined(__clang__) && !defined(__AVX512DQ__))
#ifndef __clang__
#pragma GCC target("avx512f,avx512dq")
#endif
#define LAG_LANES 8
#include "lanes/lane_kernels.h"

const LaneWidth lag_lane_width_8 = {8, kernels};
#else
#include "lanes/lane_kernel.h"
const LaneWidth lag_lane_width_8 = {8, NULL};
#endif
