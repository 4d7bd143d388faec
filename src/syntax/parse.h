/* text -> Ast. The only user of the generated scanner and parser. */
#ifndef LAGC_PARSE_H
#define LAGC_PARSE_H

#include "syntax/ast.h"

/* Parses a source and appends its statements to ast; `include` is followed (relative to the file
 * that names it; a file taken in twice counts once, a cycle is an error). Errors go to ast->diags,
 * all of them: after one the parser goes on at the next statement. Returns 1 when there were none. */
int parse(Ast *ast, const Source *source);

/* Parses one expression (a value on the command line); 0 when it is none. */
AstId parse_expression(Ast *ast, const Source *source);

/* What to write for a word that begins no statement here, but in other languages or on paper ("friction"); or NULL. */
const char *parse_advice(const char *word);

/* Appends a listing of the whole Ast, one node a line, for `--dump=ast` and golden tests. */
void ast_dump(const Ast *ast, StrBuf *out);

#endif
