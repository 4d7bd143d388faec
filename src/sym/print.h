/* Printing of expressions in textbook notation, as text or LaTeX, with the user's names. */
#pragma once

#include "base/strbuf.h"
#include "sym/expr.h"

typedef enum { PRINT_TEXT, PRINT_LATEX } PrintStyle;

/* Appends e. Definitions appear by name. Text is .lag syntax and parses back. */
void expr_print(ExprGraph *g, Expr e, PrintStyle style, StrBuf *out);

/* The expression as text. */
const char *expr_text(ExprGraph *g, Expr e);

/* Appends a name: text as it is; LaTeX with Greek letters, subscripts and dots. */
void name_print(Name name, PrintStyle style, StrBuf *out);
