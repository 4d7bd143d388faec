/* Bodies two at a time (kepler_lanes.h): vectors that every processor of this kind has. */
#if defined(__GNUC__) && !defined(LAG_REAL) && \
    (defined(__x86_64__) || defined(__aarch64__) || defined(__wasm_simd128__))
#define LAG_LANES 2
#include "methods/kepler_moves.h"
KeplerMove *const lag_kepler_move_2 = kepler_move;
#else
#include "methods/kepler_lanes.h"
#include <stddef.h>
KeplerMove *const lag_kepler_move_2 = NULL;
#endif
