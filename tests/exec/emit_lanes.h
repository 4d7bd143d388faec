/* LAG_REAL as a vector of four doubles, for emitted C: what its macros ask of a vector type. */
#ifndef EMIT_LANES_H
#define EMIT_LANES_H

#include <math.h>

typedef double v4 __attribute__((vector_size(32)));
typedef long long m4 __attribute__((vector_size(32)));

static inline int any_lane(m4 m) { return m[0] || m[1] || m[2] || m[3]; }
static inline v4 choose(m4 m, v4 a, v4 b) { return (v4)((m & (m4)a) | (~m & (m4)b)); }

#define LANEWISE1(f) \
  static inline v4 lanes_##f(v4 x) { return (v4){f(x[0]), f(x[1]), f(x[2]), f(x[3])}; }
#define LANEWISE2(f) \
  static inline v4 lanes_##f(v4 x, v4 y) { return (v4){f(x[0], y[0]), f(x[1], y[1]), f(x[2], y[2]), f(x[3], y[3])}; }
LANEWISE1(sin) LANEWISE1(cos) LANEWISE1(tan) LANEWISE1(asin) LANEWISE1(acos) LANEWISE1(atan) LANEWISE1(sinh)
LANEWISE1(cosh) LANEWISE1(tanh) LANEWISE1(exp) LANEWISE1(log) LANEWISE1(cbrt) LANEWISE1(sqrt) LANEWISE1(fabs)
LANEWISE2(pow) LANEWISE2(atan2) LANEWISE2(hypot)

#define LAG_REAL v4
#define LAG_MASK m4
#define LAG_LANE double
#define LAG_FN(f) lanes_##f
#define LAG_C(x) ((v4){x, x, x, x})
#define LAG_SELECT(c, a, b) choose(c, a, b)
#define LAG_NOT(c) (~(c))
#define LAG_AND(a, b) ((a) & (b))
#define LAG_OR(a, b) ((a) | (b))
#define LAG_ANY(c) any_lane(c)

#endif
