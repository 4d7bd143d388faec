/* The degree of a formula in all velocities together, seen through lets: A/2*w.x^2 is of degree 2 where w.x is
 * linear. By Euler's theorem a part of L of degree d adds (d - 1) times itself to the energy, which so keeps the
 * names that L is written with. */
#pragma once

#include "sym/expr.h"

enum { NO_DEGREE = 255 };

/* 0 to 254; NO_DEGREE: terms of different degrees, or velocities outside sums, products and whole powers. Creates no
 * node. */
uint8_t velocity_degree(ExprGraph *g, Arena *arena, Expr x);

/* degrees[i] := that of term i of the sum x, all in one pass. */
void velocity_degrees(ExprGraph *g, Arena *arena, Expr x, uint8_t *degrees);

static inline int has_velocities(const ExprGraph *g, Expr x) { return (expr_kinds(g, x) & 1u << SYM_VEL) != 0; }

/* Whether x is linear in the n velocities, as Coriolis and magnetic terms are: no part of the mass matrix. */
int is_linear_in_velocities(ExprGraph *g, Expr x, uint32_t n);
