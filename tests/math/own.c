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
