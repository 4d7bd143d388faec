#include "own.h"

void own_sin(const LAG_REAL *x, LAG_REAL *y) {
  LAG_REAL c;
  lag_sincos(*x, y, &c);
}

void own_cos(const LAG_REAL *x, LAG_REAL *y) {
  LAG_REAL s;
  lag_sincos(*x, &s, y);
}

void own_exp(const LAG_REAL *x, LAG_REAL *y) { *y = lag_exp(*x); }
void own_log(const LAG_REAL *x, LAG_REAL *y) { *y = lag_log(*x); }
void own_rsqrt(const LAG_REAL *x, LAG_REAL *y) { *y = lag_rsqrt(*x); }

void own_sincos2(const LAG_REAL *x, LAG_REAL *s, LAG_REAL *c) { lag_sincos2(x[0], &s[0], &c[0], x[1], &s[1], &c[1]); }
void own_sincos4(const LAG_REAL *x, LAG_REAL *s, LAG_REAL *c) {
  lag_sincos4(x[0], &s[0], &c[0], x[1], &s[1], &c[1], x[2], &s[2], &c[2], x[3], &s[3], &c[3]);
}
