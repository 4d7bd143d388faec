/* sum(j in 1..i-1, f, by tree(theta)): a sum of 1/r, near bodies one by one and far ones by cells of a tree.
 *
 * In: the nodes of f and theta. Out: the sum itself, and a note of theta, by which `lower` makes the tree. */
#include "syntax/ast_build.h"

AstId ast_far(Ast *ast, Span span, Span op, AstTurns turns, AstId body, FarWay how) {
  AstId sum = ast_reduce(ast, AST_SUM, span, op, turns, body);
  Span where = {how.by.span.begin, span.end - 1};
  if (strcmp(how.by.name, "by") != 0 || strcmp(how.way.name, "tree") != 0)
    diag_error(ast->diags, where, "a sum is taken term by term, or by a tree" HELP
                                  "write `sum(j in 1..i-1, ..., by tree(0.5))`; smaller numbers are more accurate");
  else vec_push(ast->arena, &ast->fars, ((AstFar){.sum = sum, .theta = how.theta, .span = where}));
  return sum;
}
