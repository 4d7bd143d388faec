/* text -> Ast: the interface of the scanner, the token filter and the generated parser. */
#pragma once

#include "syntax/ast.h"

/* Parses a source and appends its statements to ast, those of included files too (paths relative to the including
 * file; a repeated include counts once, a cycle is an error). All errors go to ast->diags: after one the parser goes
 * on at the next statement. Returns 1 when there were none. */
int parse(Ast *ast, const Source *source);

/* Parses one expression, such as a value on the command line; 0 after an error. */
AstId parse_expression(Ast *ast, const Source *source);

/* `function f(x) = ...` of each function that functions.def defines by its text. */
const AstStmt *parse_composed(Ast *ast);

/* Advice for a word that begins statements in other languages or on paper ("damping"), but not here; or NULL. */
const char *parse_advice(const char *word);

/* Appends a listing of the whole Ast, one node a line, for `--dump=ast` and golden tests. */
void ast_dump(const Ast *ast, StrBuf *out);
