/* Finds the first number that was rounded to a double and shows it: in the text with a caret, in the graph by its value. */
#include "commands/precision_warning.h"

#include <stdio.h>
#include <string.h>

/* Literals that are no 64-bit fraction were rounded to a double; those of up to SAFE characters lost nothing. */
static int warn_literal(const Ast *ast, const char *precision) {
  enum { SAFE = 17 };
  for (AstId i = 1; i < ast->exprs.n; i++) {
    const AstExpr *e = ast_expr(ast, i);
    if (e->kind != AST_NUM || num_is_exact(e->number) || e->span.end - e->span.begin <= SAFE) continue;
    diag_warning(ast->diags, e->span, "this number is rounded to 17 digits, fewer than --precision %s computes with", precision);
    diag_help(ast->diags, "if more digits matter, make it a parameter or a start, and give them as name=value");
    return 1;
  }
  return 0;
}

void precision_warn(const Ast *ast, const ExprGraph *g, const char *precision) {
  enum { SAFE = 15, ROOM = 32 };
  if (warn_literal(ast, precision)) return;
  for (Expr e = 1; e <= expr_count(g); e++) {
    char text[ROOM];
    if (!expr_is_num(g, e) || num_is_exact(expr_number(g, e))) continue;
    num_format_double(text, num_value(expr_number(g, e)));
    if (strspn(text, "-0.123456789") - (text[0] == '-') - (strchr(text, '.') != NULL) <= SAFE) continue;
    fprintf(stderr, "lagc: warning: --precision %s: a product of numbers of the model, %s, is rounded to 17 digits; if more digits matter, make them "
            "parameters\n", precision, text);
    return;
  }
}
