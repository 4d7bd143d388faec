/* Switches of an expression (abs, sign, min, max, comparisons), and the expression on one side of a switch. */
#pragma once

#include "sym/expr.h"

/* Switching function of the innermost switch of x that contains the symbol s (0: any symbol); 0: there is none. */
Expr switch_in(ExprGraph *g, Expr x, SymId s);

/* x where u > 0 (sign 1) or u < 0 (sign -1): each switch at u or a multiple of u becomes its branch. */
Expr on_side(ExprGraph *g, Expr x, Expr u, int sign);

/* Whether x is proved to be 0 on all sides of its switches. */
int zero_on_sides(ExprGraph *g, Expr x);
