/* Sines and cosines of lag_math.h for simulators, which link them instead of compiling them once a model: a fifth of
 * their compilation. Without FMA, as models are compiled; those with it have their own. */
#include <math.h>

#define LAG_NO_FMA 1
#define lag_sincos inline_sincos
#define lag_sin inline_sin
#define lag_cos inline_cos
#ifdef __SSE2__ /* elsewhere lag_sincos2 is a macro of lag_math.h */
#define lag_sincos2 inline_sincos2
#endif
#include "lag_math.h"
#undef lag_sincos
#undef lag_sin
#undef lag_cos
#undef lag_sincos2

#if LAG_OWN
void lag_sincos(double x, double *s, double *c);
double lag_sin(double x);
double lag_cos(double x);
void lag_sincos2(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b);

void lag_sincos(double x, double *s, double *c) { inline_sincos(x, s, c); }
double lag_sin(double x) { return inline_sin(x); }
double lag_cos(double x) { return inline_cos(x); }
void lag_sincos2(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b) {
#ifdef LAG_SINCOS_2
  inline_sincos2(a, sin_a, cos_a, b, sin_b, cos_b);
#else
  inline_sincos(a, sin_a, cos_a);
  inline_sincos(b, sin_b, cos_b);
#endif
}
#endif
