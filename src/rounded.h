/* Numbers that have fewer digits than --precision computes with. */
#ifndef LAGC_ROUNDED_H
#define LAGC_ROUNDED_H

#include "sym/expr.h"
#include "syntax/ast.h"

/* Warns of the first number of the text that was rounded to a double, or, where there is none, of one that the graph of its model has. */
void rounded_warn(const Ast *ast, const ExprGraph *g, const char *precision);

#endif
