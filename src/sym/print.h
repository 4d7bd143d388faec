/* Printing of expressions in textbook notation, as text or LaTeX, with the user's names. */
#pragma once

#include <string.h>

#include "base/strbuf.h"
#include "sym/expr.h"

typedef enum { PRINT_TEXT, PRINT_LATEX } PrintStyle;
/* The style that --format names. */
static inline PrintStyle print_style(const char *format) {
  return format && strcmp(format, "latex") == 0 ? PRINT_LATEX : PRINT_TEXT;
}

/* Appends e. Definitions appear by name. Text is .lag syntax and parses back. */
void expr_print(ExprGraph *g, Expr e, PrintStyle style, StrBuf *out);

/* The expression as text. */
const char *expr_text(ExprGraph *g, Expr e);

/* Appends a name: text as it is; LaTeX with Greek letters, subscripts and dots. */
void name_print(Name name, PrintStyle style, StrBuf *out);
