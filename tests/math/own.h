/* The functions of lag_math.h as functions that another compiler can compile: own.c. By address: two compilers may
 * pass vectors in different ways. */
#ifndef OWN_H
#define OWN_H

#include "lag_math.h"

void own_sin(const LAG_REAL *x, LAG_REAL *y);
void own_cos(const LAG_REAL *x, LAG_REAL *y);
void own_exp(const LAG_REAL *x, LAG_REAL *y);
void own_log(const LAG_REAL *x, LAG_REAL *y);
void own_rsqrt(const LAG_REAL *x, LAG_REAL *y);

/* Of x[2] and x[4]. */
void own_sincos2(const LAG_REAL *x, LAG_REAL *s, LAG_REAL *c);
void own_sincos4(const LAG_REAL *x, LAG_REAL *s, LAG_REAL *c);

#endif
