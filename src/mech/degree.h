/* The degree of a formula in all velocities together, seen through lets: A/2*w.x^2 is of degree 2 where w.x is linear. By Euler's theorem a part
 * of degree d of the Lagrangian is (d - 1) times itself in the energy, so that the energy keeps the names of what L is written with. */
#ifndef LAGC_DEGREE_H
#define LAGC_DEGREE_H

#include "sym/expr.h"

enum { NO_DEGREE = 255 };

/* 0 to 254, or NO_DEGREE: its terms have different degrees, or it is no sum of products and whole powers of what has one. Makes no node. */
uint8_t velocity_degree(ExprGraph *g, Arena *arena, Expr x);

#endif
