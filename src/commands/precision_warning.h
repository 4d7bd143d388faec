/* Warning about numbers of a model that have fewer digits than --precision computes with. */
#ifndef LAGC_COMMANDS_PRECISION_WARNING_H
#define LAGC_COMMANDS_PRECISION_WARNING_H

#include "sym/expr.h"
#include "syntax/ast.h"

/* Warns of the first literal that was rounded to a double, or, where there is none, of the first such number in the model's graph. */
void precision_warn(const Ast *ast, const ExprGraph *g, const char *precision);

#endif
