/* A printed formula, read again by the parser and compared with what it was printed from: a wrong sign or a missing
 * parenthesis is found before a user sees it. */
#pragma once

#include "model/model.h"
#include "sym/print.h"

/* Value of a node that the caller knows, given the text of the formula and the part [begin, end) of it; 0: none. */
typedef Expr (*KnownPart)(const void *data, const Ast *ast, const AstExpr *x, uint32_t begin, uint32_t end);

/* The expression that the text says, where names are those of symbols and definitions in `like`, or `known` has their
 * value (NULL: none is known). 0: it does not parse, or says something else. */
Expr printed_value(const Model *m, const char *text, Expr like, KnownPart known, const void *data);

/* Whether the text says e: the same expression, or one of equal values at random states. */
int printed_says(const Model *m, const char *text, Expr e);

/* Prints e and compares what was printed with e; LaTeX, by the same printer in another style, as text. A difference is
 * an internal error in the model's diags. */
void expr_print_checked(const Model *m, Expr e, PrintStyle style, StrBuf *out);
