/* `network V(x, y) from "weights.json" layers 16, 16`: a dense network as declarations of the language. */
#pragma once

#include "syntax/ast.h"

/* The text that a network stands for: its weights as parameters V_w1, V_b1, ..., and the function V of sums over them.
 * NULL after an error in the statement or in its file, which is in ast->diags. from: the file with the statement. */
const char *network_text(Ast *ast, const AstStmt *s, const char *from);
