/* Steps of 4 runs at once, in vectors of 4 doubles: compiled for processors that have them, called where the program
 * finds one. Clang passes vectors as the file's flags say, whatever a function's target: it needs -mavx2. */
#if defined(__GNUC__) && !defined(LAG_REAL) && !(defined(__x86_64__) && defined(__clang__) && !defined(__AVX2__))
#if defined(__x86_64__) && !defined(__clang__)
#pragma GCC target("avx2")
#endif
#define LAG_LANES 4
#include "lanes/lane_kernels.h"

const LaneWidth lag_lane_width_4 = {4, kernels};
#else
#include "lanes/lane_kernel.h"
const LaneWidth lag_lane_width_4 = {4, NULL};
#endif
