#ifndef LAGC_SIMPLIFY_H
#define LAGC_SIMPLIFY_H
#include "sym/expr.h"
Expr simplify(ExprGraph *g, Expr e);
Expr simplify_stable(ExprGraph *g, Expr e);
#endif
