#include "sym/simplify.h"
Expr simplify(ExprGraph *g, Expr e) { (void)g; return e; }
Expr simplify_stable(ExprGraph *g, Expr e) { (void)g; return e; }
